//! Claim: the solver finds the certified minima of NIST's nonlinear regression problems.
//!
//! Each problem comes with two starts, the first far from the solution, and with parameters certified
//! to eleven digits. `tests/certified/README.md` says where the files come from.
//!
//! `cargo test -p tests --test certified -- --nocapture` prints the table.

#[path = "certified/dual.rs"]
mod dual;
#[path = "certified/models.rs"]
mod models;

use dual::Dual;
use models::{Model, model};
use std::fmt::Write;
use std::ops::ControlFlow;
use std::path::Path;
use tests::workspace::{root, text};
use trainer::fit::levenberg_marquardt::{CAUTIOUS, Limits, Minimum, Problem, Quadratic, minimise};

/// Matching digits that every parameter of every problem must have from either start.
const LEAST_DIGITS: f64 = 9.0;
/// The values are certified to so many digits; more agreement means nothing.
const CERTIFIED_DIGITS: f64 = 11.0;
/// Ends where the gradient is rounding and nothing else. MGH10 follows a curved valley through fifty
/// orders of magnitude of its first parameter.
const LIMITS: Limits = Limits { iterations: 10_000, decrease: 1e-26, step: 0.0, damping: CAUTIOUS };

/// One data file.
struct Certified {
    name: String,
    starts: [Vec<f64>; 2],
    parameters: Vec<f64>,
    /// Half the certified sum of squares.
    cost: f64,
    /// Response first, then the predictors.
    rows: Vec<Vec<f64>>,
}

impl Certified {
    fn read(path: &Path) -> Self {
        let name = path.file_stem().and_then(|stem| stem.to_str()).expect("a file name").to_owned();
        let file = text(path);
        let (head, data) = file.rsplit_once("Data:").expect("a table after the last `Data:`");
        // "  b1 =   500   0.0001   2.3894212918E+02   2.7070075241E+00": starts, certified value, its deviation
        let lines = head.lines().filter(|line| line.trim_start().starts_with('b'));
        let columns: Vec<Vec<f64>> = lines.filter_map(|line| Some(numbers(line.split_once('=')?.1))).collect();
        let column = |k: usize| columns.iter().map(|row| row[k]).collect();
        let squares = head.lines().find_map(|line| line.strip_prefix("Residual Sum of Squares:"));
        Self {
            starts: [column(0), column(1)],
            parameters: column(2),
            cost: numbers(squares.expect("a certified sum of squares"))[0] / 2.0,
            rows: data.lines().skip(1).map(numbers).filter(|row| !row.is_empty()).collect(),
            name,
        }
    }

    /// Digits to which the worst parameter agrees: the negative logarithm of its relative error.
    fn digits(&self, found: &[f64]) -> f64 {
        let pairs = found.iter().zip(&self.parameters);
        let digits = pairs.map(|(found, certified)| -((found - certified) / certified).abs().log10());
        digits.fold(CERTIFIED_DIGITS, |least, digits| if digits.is_nan() { 0.0 } else { least.min(digits) })
    }
}

fn numbers(line: &str) -> Vec<f64> {
    line.split_whitespace().map(|word| word.parse().unwrap_or_else(|_| panic!("{word}: not a number"))).collect()
}

fn problems() -> Vec<Certified> {
    let folder = root().join("tests/certified").read_dir().expect("a folder of data files");
    let mut files: Vec<_> = folder.flatten().map(|entry| entry.path()).collect();
    files.retain(|file| file.extension().is_some_and(|extension| extension == "dat"));
    files.sort();
    files.iter().map(|file| Certified::read(file)).collect()
}

/// The data file as the solver wants it.
struct Regression<'a> {
    rows: &'a [Vec<f64>],
    model: Model,
    parameters: usize,
    /// Nelson's response is the logarithm of what the file holds.
    logarithmic: bool,
}

impl<'a> Regression<'a> {
    fn of(certified: &'a Certified) -> Self {
        Self {
            rows: &certified.rows,
            model: model(&certified.name),
            parameters: certified.parameters.len(),
            logarithmic: certified.name == "Nelson",
        }
    }

    fn residuals(&self, point: &[f64]) -> impl Iterator<Item = Dual> {
        let parameters: Vec<Dual> = point.iter().enumerate().map(|(i, value)| Dual::parameter(i, *value)).collect();
        self.rows.iter().map(move |row| {
            let response = if self.logarithmic { row[0].ln() } else { row[0] };
            (self.model)(&parameters, &row[1..]) - response
        })
    }
}

impl Problem for Regression<'_> {
    fn parameters(&self) -> usize {
        self.parameters
    }

    fn cost(&mut self, point: &[f64]) -> f64 {
        self.residuals(point).map(|residual| 0.5 * residual.value * residual.value).sum()
    }

    fn linearise(&mut self, point: &[f64], quadratic: &mut Quadratic) {
        quadratic.cost = self.cost(point);
        quadratic.gradient.fill(0.0);
        quadratic.hessian.fill(0.0);
        for Dual { value, slopes } in self.residuals(point) {
            for i in 0..self.parameters {
                quadratic.gradient[i] += slopes[i] * value;
                for j in 0..self.parameters {
                    quadratic.hessian[(i, j)] += slopes[i] * slopes[j];
                }
            }
        }
    }
}

fn solve(certified: &Certified, start: &[f64]) -> Minimum {
    minimise(&mut Regression::of(certified), start, &LIMITS, |_, _| ControlFlow::Continue(()))
}

#[test]
fn every_certified_minimum_is_found_from_both_starts() {
    let mut table =
        format!("{:10}{:>10}{:>10}{:>14}{:>14}\n", "", "digits 1", "digits 2", "iterations 1", "iterations 2");
    let mut least = f64::INFINITY;
    for certified in problems() {
        let minima = certified.starts.each_ref().map(|start| solve(&certified, start));
        let [first, second] = minima.each_ref().map(|minimum| certified.digits(&minimum.point));
        let [i, j] = minima.map(|minimum| minimum.iterations);
        writeln!(table, "{:10}{first:>10.1}{second:>10.1}{i:>14}{j:>14}", certified.name).expect("text grows");
        least = least.min(first).min(second);
    }
    println!("{table}");
    assert!(least >= LEAST_DIGITS, "a minimum was not found:\n{table}");
}

#[test]
fn the_models_and_data_give_the_certified_sums_of_squares() {
    for certified in problems() {
        // Lanczos1's sum is 1e-25: eleven digits of its parameters are not enough to compute it.
        let rounding = if certified.name == "Lanczos1" { 1e-20 } else { 1e-9 * certified.cost };
        let cost = Regression::of(&certified).cost(&certified.parameters);
        assert!((cost - certified.cost).abs() < rounding, "{}: {cost}, not {}", certified.name, certified.cost);
    }
}

#[test]
fn all_of_nists_problems_are_there() {
    assert_eq!(problems().len(), 27);
}
