//! Courses that no known effect has, and that tell of something unknown where the residual follows one.

use crate::diagnose::cells::{Cell, Cells, Columns, RunCells, width};
use crate::diagnose::problem::Problem;
use crate::diagnose::thresholds::{LEAST_COURSE, LEAST_DAYS, LEVELS_PER_G, MOST_LEVELS};
use nalgebra::DMatrix;
use std::collections::BTreeSet;

/// What gives away that something is missing.
#[derive(Clone, Debug)]
pub struct LackOfFit {
    /// The quantities that it depends on.
    pub depends_on: Vec<String>,
    /// Its period, if it has one.
    pub period_s: Option<f64>,
    /// Twice the gain in log likelihood, less what its amplitudes are worth.
    pub delta_bic: f64,
    /// Size of what the instrument can't absorb of it, in all samples, µg RMS.
    pub size_ug: f64,
}

/// A structure to look for.
pub struct Alternative {
    /// The quantities that it depends on.
    pub depends_on: Vec<String>,
    /// Its period, if it has one.
    pub period_s: Option<f64>,
    /// Its course in the cells, each free to be of any size.
    pub course: Course,
}

/// Where a structure shows.
pub enum Course {
    /// In all runs.
    All(Columns),
    /// In one of them: there may be thousands, and most of a column for each would be zeros.
    One(usize, DMatrix<f64>),
}

impl Course {
    /// How many columns there are.
    pub fn width(&self) -> usize {
        match self {
            Self::All(columns) => width(columns),
            Self::One(_, columns) => columns.ncols(),
        }
    }

    /// With its zeros, µg per amplitude: of each run cells × [`width`](Self::width).
    pub fn whole(&self, cells: &Cells) -> Columns {
        let (run, own) = match self {
            Self::All(columns) => return columns.clone(),
            Self::One(run, own) => (*run, own),
        };
        let zeros = |run: &RunCells| DMatrix::zeros(run.cells.len(), own.ncols());
        let mut columns: Columns = cells.runs.iter().map(zeros).collect();
        columns[run].copy_from(own);
        columns
    }
}

/// The solar day and the moon's half day, s.
const DAYS_S: [f64; 2] = [86_400.0, 44_714.0];

/// Structures whose ΔBIC compares with that of effects: a kink's, weighed against a smooth instrument only, says
/// too how far training was bent by the very effect that is missing.
pub fn rivals_of_effects(problem: &Problem) -> Vec<Alternative> {
    let mut all = days(problem);
    all.extend(odd_runs(problem));
    all
}

/// Swings by the calendar: of the bias, or of a rig that leans, which shows across the input axis only.
fn days(problem: &Problem) -> Vec<Alternative> {
    let dated = problem.cells().runs.iter().all(|run| run.run.rows.iter().all(|row| row.sample.age_s.is_some()));
    let followed_s = |run: &RunCells| run.cells.last().map_or(0.0, |cell| cell.time_s);
    let followed_s: f64 = problem.cells().runs.iter().map(followed_s).sum();
    let periods = DAYS_S.into_iter().filter(|period_s| dated && followed_s > LEAST_DAYS * period_s);
    let periodic = |period_s: f64, leans: bool| Alternative {
        depends_on: vec!["time_s".to_owned()],
        period_s: Some(period_s),
        course: Course::All(problem.cells().columns(|_, run, cell| {
            let first = &run.run.rows[0].sample;
            let phase = (f64::from(first.age_s.unwrap_or(0)) + cell.time_s) / period_s * std::f64::consts::TAU;
            let size = problem.sample_ug * if leans { cell.cross_g } else { 1.0 };
            [phase.sin() * size, phase.cos() * size]
        })),
    };
    periods.flat_map(|period_s| [periodic(period_s, false), periodic(period_s, true)]).collect()
}

/// For each run, a course over temperature of its own.
fn odd_runs(problem: &Problem) -> Vec<Alternative> {
    let span = |run: &RunCells| {
        let each = || run.cells.iter().map(|cell| cell.t);
        each().fold(f64::MIN, f64::max) - each().fold(f64::MAX, f64::min)
    };
    let courses = problem.cells().runs.iter().enumerate().filter(|(_, run)| span(run) > LEAST_COURSE);
    courses
        .map(|(odd, run)| {
            let cells = run.cells.len().max(1) as f64;
            let middle = run.cells.iter().map(|cell| cell.t).sum::<f64>() / cells;
            let course = run.cells.iter().map(|cell| (cell.t - middle) * problem.sample_ug);
            Alternative {
                depends_on: vec!["run".to_owned(), "temperature_c".to_owned()],
                period_s: None,
                course: Course::One(odd, DMatrix::from_iterator(run.cells.len(), 1, course)),
            }
        })
        .collect()
}

/// What the hottest or coldest moment so far left behind for good.
pub fn running_extrema(problem: &Problem) -> Vec<Alternative> {
    let mut order: Vec<usize> = (0..problem.cells().runs.len()).collect();
    // Runs without a date come in the order of the files.
    order.sort_by_key(|run| problem.cells().runs[*run].run.rows.first().and_then(|row| row.sample.age_s));
    let extremum = |sign: f64| {
        let mut farthest = f64::NEG_INFINITY;
        let mut columns: Columns = vec![DMatrix::zeros(0, 1); order.len()];
        for run in &order {
            let cells = &problem.cells().runs[*run].cells;
            let so_far = cells.iter().map(|cell| {
                farthest = farthest.max(sign * cell.t);
                farthest * problem.sample_ug
            });
            columns[*run] = DMatrix::from_iterator(cells.len(), 1, so_far);
        }
        columns
    };
    let depends_on = || vec!["temperature_c".to_owned(), "time_s".to_owned()];
    let alternative =
        |sign| Alternative { depends_on: depends_on(), period_s: None, course: Course::All(extremum(sign)) };
    [1.0, -1.0].map(alternative).into()
}

/// An asymmetry of the two directions (IEEE Std 1293: K0', K1', K_oq).
pub fn rectified(problem: &Problem) -> Alternative {
    let of = |_: usize, _: &RunCells, cell: &Cell| [cell.level_g.abs(), cell.level_g * cell.level_g.abs()];
    let columns = problem.cells().columns(of).into_iter().map(|run| run * problem.sample_ug).collect();
    Alternative { depends_on: vec!["reference_g".to_owned()], period_s: None, course: Course::All(columns) }
}

/// For each level, one wherever it was applied: of each run cells × levels, without a unit.
pub fn levels(problem: &Problem) -> Columns {
    let level = |cell: &Cell, per_level: f64| (cell.level_g * per_level).round() as i64;
    let told_apart = |per_level: f64| -> Vec<i64> {
        problem.cells().iter().map(|cell| level(cell, per_level)).collect::<BTreeSet<_>>().into_iter().collect()
    };
    let mut per_level = LEVELS_PER_G;
    let mut distinct = told_apart(per_level);
    while distinct.len() > MOST_LEVELS {
        per_level /= 2.0;
        distinct = told_apart(per_level);
    }
    let of = |run: &RunCells| {
        let here = |row: usize, column: usize| level(&run.cells[row], per_level) == distinct[column];
        DMatrix::from_fn(run.cells.len(), distinct.len(), |row, column| f64::from(u8::from(here(row, column))))
    };
    problem.cells().runs.iter().map(of).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnose::example::{Recipe, dense, problem};

    fn whole(problem: &Problem, alternative: &Alternative) -> DMatrix<f64> {
        dense(&alternative.course.whole(problem.cells()))
    }

    #[test]
    fn a_kink_is_even_and_an_odd_square_and_levels_are_told_apart() {
        let campaign = Recipe::default().campaign();
        let problem = problem(&campaign);
        let (kink, levels) = (whole(&problem, &rectified(&problem)), dense(&levels(&problem)));
        assert_eq!(levels.ncols(), 5);
        for (row, cell) in problem.cells().iter().enumerate() {
            let worked =
                [cell.level_g.abs(), cell.level_g.signum() * cell.level_g.powi(2)].map(|v| v * problem.sample_ug);
            assert!((kink[(row, 0)] - worked[0]).abs() < 1e-12 && (kink[(row, 1)] - worked[1]).abs() < 1e-12);
            assert_eq!(levels.row(row).sum(), 1.0);
        }
        // −1, −0.5, 0, 0.5, 1 in order, each where it was applied.
        let applied = problem.cells().iter().filter(|cell| (cell.level_g + 1.0).abs() < 1e-6).count();
        assert_eq!(levels.column(0).sum(), applied as f64);
    }

    #[test]
    fn each_run_has_a_course_over_temperature_of_its_own_unless_it_has_none() {
        let soaked = Recipe { rows: 30, ..Recipe::default() }.campaign();
        assert!(odd_runs(&problem(&soaked)).is_empty());
        let campaign = Recipe::default().campaign();
        let problem = problem(&campaign);
        let odd = odd_runs(&problem);
        assert_eq!(odd.len(), 4);
        let course = whole(&problem, &odd[2]);
        let [before, own] =
            [0..2, 2..3].map(|runs| runs.map(|run: usize| problem.cells().runs[run].cells.len()).sum::<usize>());
        assert!(
            course.rows(0, before).amax() == 0.0
                && course.rows(before + own, course.nrows() - before - own).amax() == 0.0
        );
        let own = course.rows(before, own);
        assert!(own.mean().abs() < 1e-9 * own.amax() && own.amax() > 0.5 * problem.sample_ug);
    }

    #[test]
    fn an_extremum_only_grows_over_the_runs_in_the_order_of_their_dates() {
        let mut campaign = Recipe { days_apart: Some(1), ..Recipe::default() }.campaign();
        // Now the last run comes first.
        campaign.runs.rotate_right(1);
        let problem = problem(&campaign);
        let order = [1, 2, 3, 0];
        for (alternative, sign) in running_extrema(&problem).iter().zip([1.0, -1.0]) {
            let courses = alternative.course.whole(problem.cells());
            let mut farthest = f64::NEG_INFINITY;
            for run in order {
                for (cell, value) in problem.cells().runs[run].cells.iter().zip(courses[run].iter()) {
                    farthest = farthest.max(sign * cell.t);
                    assert!((value - farthest * problem.sample_ug).abs() < 1e-12);
                }
            }
        }
    }

    #[test]
    fn a_day_is_looked_for_where_the_calendar_is_known_and_followed_long_enough() {
        let days_in = |recipe: &Recipe| days(&problem(&recipe.campaign())).len();
        // Each run is followed for 75 minutes: 1.5 tides take 15 runs, 1.5 days 29.
        let few = Recipe { runs: 4, days_apart: Some(1), ..Recipe::default() };
        let some = Recipe { runs: 16, days_apart: Some(1), ..Recipe::default() };
        let many = Recipe { runs: 30, days_apart: Some(1), ..Recipe::default() };
        assert_eq!([&few, &some, &many].map(days_in), [0, 2, 4]);
        assert_eq!(days_in(&Recipe { days_apart: None, ..many }), 0);
    }
}
