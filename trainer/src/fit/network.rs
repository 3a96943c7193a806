//! The 2-10-1 network as a separable least-squares problem.
//!
//! Ten of its 41 weights and the first-order instrument beside it enter linearly. For given hidden
//! weights they follow from one small linear solve, so only the 30 hidden weights are searched
//! (variable projection, Golub & Pereyra 1973, in Kaufman's form). One pass over the rows fills one
//! Gram matrix from which cost, gradient and Gauss–Newton matrix all follow:
//!
//! ```text
//!   columns   A = [1 x t xt σ₁…σ₁₀]   y   D = [σ'ₖx σ'ₖt σ'ₖ]
//!   c  = (AᵀA)⁻¹Aᵀy                     the linear weights
//!   g  = −V(Dᵀy − DᵀAc)                V = diag of the output weights
//!   H  = V(DᵀD − DᵀA(AᵀA)⁻¹AᵀD)V
//! ```
//!
//! The rows of one run share an offset that no model can know (turn-on, mounting). It is treated as
//! what it is, a random effect: subtracting one rank-one term a run from the Gram matrix makes the
//! fit a generalised least-squares fit at no cost.
//!
//! Effects move inputs and targets of the rows with parameters of their own ([`Rows`]); their tangents
//! join D, with weight one instead of an output weight.
//!
//! Anchors ask softly for the values and slopes ∂y/∂x of a smooth instrument, which keeps an
//! accelerometer from becoming a classifier of the levels and nodes that it was trained on.

use super::levenberg_marquardt::{Problem, Quadratic};
use firmware_core::activation::{curvature, sigmoid, slope};
use nalgebra::{Cholesky, Const, Dyn, OMatrix, SMatrix, SVector};
use protocol::limits::HIDDEN;

/// Expected size of an output weight, in units of the departure from the line.
pub const OUTPUT_SIZE: f64 = 10.0;
/// Expected size of a hidden weight. A unit this steep bends over the whole domain: an instrument is
/// smooth until data insist on the contrary. `docs/decisions/0003-anchors.md` has the comparison.
pub const HIDDEN_SIZE: f64 = 1.0;
/// Hidden weights: input x, input t, threshold of each unit in turn.
pub const NONLINEAR: usize = 3 * HIDDEN;
/// Constant, x, t, x·t of the first-order instrument, then the output weights.
pub const LINEAR: usize = LINE + HIDDEN;
const LINE: usize = 4;
const TARGET: usize = LINEAR;
/// Columns that the cost alone needs.
const COST_COLUMNS: usize = LINEAR + 1;
const DERIVATIVES: usize = COST_COLUMNS;
const EXTRA: usize = DERIVATIVES + NONLINEAR;
const COLUMNS: usize = EXTRA + MOST_EXTRA;
/// Most parameters that effects may have together.
pub const MOST_EXTRA: usize = 16;

/// Asks for a value of the output.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ValueRow {
    /// Scaled frequency difference.
    pub x: f64,
    /// Scaled temperature.
    pub t: f64,
    /// The wanted output.
    pub y: f64,
    /// Weight of its squared residual.
    pub weight: f64,
    /// Samples that it stands for.
    pub samples: f64,
}

/// The rows of one run, whose residuals share an offset.
#[derive(Clone, Debug, PartialEq)]
pub struct Group {
    /// The rows.
    pub rows: Vec<ValueRow>,
    /// Variance of the shared offset in units of the variance of a row of weight one.
    pub offset_variance: f64,
}

/// Rows that may move with parameters of their own.
pub trait Rows {
    /// How many parameters.
    fn parameters(&self) -> usize;

    /// Moves the rows, and brings their tangents along if asked to.
    fn update(&mut self, parameters: &[f64], tangents: bool);

    /// The rows by run.
    fn groups(&self) -> &[Group];

    /// [`Tangent`]s of every row by every parameter: rows in order, parameters within.
    fn tangents(&self) -> &[Tangent];
}

/// By how much a row moves with a parameter.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Tangent {
    /// Of its scaled frequency difference.
    pub x: f64,
    /// Of its scaled temperature.
    pub t: f64,
    /// Of its wanted output.
    pub y: f64,
}

/// Rows that stay where they are.
impl Rows for Vec<Group> {
    fn parameters(&self) -> usize {
        0
    }

    fn update(&mut self, _: &[f64], _: bool) {}

    fn groups(&self) -> &[Group] {
        self
    }

    fn tangents(&self) -> &[Tangent] {
        &[]
    }
}

/// Asks for a slope of the output.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SlopeRow {
    /// Scaled frequency difference.
    pub x: f64,
    /// Scaled temperature.
    pub t: f64,
    /// The wanted ∂output/∂x.
    pub slope: f64,
    /// Weight of its squared residual.
    pub weight: f64,
}

/// What a smooth instrument would do, where the measurements leave it open.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Anchors {
    /// Values to stay near.
    pub values: Vec<ValueRow>,
    /// Slopes to stay near.
    pub slopes: Vec<SlopeRow>,
}

/// Gaussian priors of the weights: precision in units of a value row of weight one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Prior {
    /// Of each output weight.
    pub output: f64,
    /// Of each hidden weight.
    pub hidden: f64,
}

/// The network's share of one fit.
#[derive(Clone, Debug, PartialEq)]
pub struct Fit {
    /// Hidden weights, [x, t, threshold] of each unit.
    pub hidden: Vec<f64>,
    /// Constant, x, t, x·t.
    pub line: [f64; LINE],
    /// Output weights.
    pub output: [f64; HIDDEN],
}

impl Fit {
    /// The output at (x, t).
    #[must_use]
    pub fn evaluate(&self, x: f64, t: f64) -> f64 {
        let [constant, by_x, by_t, by_xt] = self.line;
        let units = self.hidden.as_chunks::<3>().0.iter().zip(&self.output);
        constant
            + by_x * x
            + by_t * t
            + by_xt * x * t
            + units.map(|([wx, wt, b], v)| v * sigmoid(b + wx * x + wt * t)).sum::<f64>()
    }
}

/// The separable problem: rows, anchors and priors.
///
/// Its parameters are the hidden weights, then the rows' own.
pub struct NetworkProblem<'a, R> {
    rows: R,
    anchors: &'a Anchors,
    prior: Prior,
    gram: Box<Gram>,
}

type Gram = [[f64; COLUMNS]; COLUMNS];
type LinearMatrix = SMatrix<f64, LINEAR, LINEAR>;
type LinearVector = SVector<f64, LINEAR>;

/// Relative ridge that keeps the linear solve positive definite when units coincide.
const JITTER: f64 = 1e-13;

impl<'a, R: Rows> NetworkProblem<'a, R> {
    /// The problem of these rows.
    #[must_use]
    pub fn new(rows: R, anchors: &'a Anchors, prior: Prior) -> Self {
        Self { rows, anchors, prior, gram: Box::new([[0.0; COLUMNS]; COLUMNS]) }
    }

    /// The rows, where they were moved to last.
    pub const fn rows(&self) -> &R {
        &self.rows
    }

    /// The whole network at these parameters.
    pub fn fit(&mut self, point: &[f64]) -> Option<Fit> {
        let (hidden, extra) = point.split_at_checked(NONLINEAR)?;
        self.rows.update(extra, false);
        self.fill(hidden, None);
        let (_, linear, _) = self.solve_linear()?;
        let mut fit = Fit { hidden: hidden.to_vec(), line: [0.0; LINE], output: [0.0; HIDDEN] };
        let (line, output) = linear.as_slice().split_at(LINE);
        fit.line.copy_from_slice(line);
        fit.output.copy_from_slice(output);
        Some(fit)
    }

    /// Fills the Gram matrix: what the cost needs, or with known linear weights all of it.
    fn fill(&mut self, hidden: &[f64], linear: Option<&LinearVector>) {
        let extra = self.rows.parameters();
        let used = if linear.is_some() { EXTRA + extra } else { COST_COLUMNS };
        self.gram.iter_mut().for_each(|row| row.fill(0.0));
        let mut columns = [0.0; COLUMNS];
        let mut tangents = self.rows.tangents().chunks_exact(extra.max(1));
        for group in self.rows.groups() {
            let (mut sum, mut weight) = ([0.0; COLUMNS], 0.0);
            for row in &group.rows {
                value_columns(row, hidden, &mut columns);
                if let (Some(linear), true) = (linear, extra > 0) {
                    extra_columns(row, hidden, linear, tangents.next().unwrap_or_default(), &mut columns);
                }
                accumulate(&mut self.gram, &columns[..used], row.weight);
                weight += row.weight;
                sum.iter_mut().zip(&columns).for_each(|(sum, column)| *sum += row.weight * column);
            }
            // (W⁻¹ + v·11ᵀ)⁻¹ = W − v/(1 + v·ΣW)·W11ᵀW
            accumulate(&mut self.gram, &sum[..used], -group.offset_variance / (1.0 + group.offset_variance * weight));
        }
        columns[EXTRA..].fill(0.0);
        for row in &self.anchors.values {
            value_columns(row, hidden, &mut columns);
            accumulate(&mut self.gram, &columns[..used], row.weight);
        }
        for row in &self.anchors.slopes {
            slope_columns(row, hidden, &mut columns);
            accumulate(&mut self.gram, &columns[..used], row.weight);
        }
        for unit in LINE..LINEAR {
            self.gram[unit][unit] += self.prior.output;
        }
    }

    /// Factor of AᵀA, the linear weights, and twice the cost without the hidden prior.
    fn solve_linear(&self) -> Option<(Cholesky<f64, Const<LINEAR>>, LinearVector, f64)> {
        let mut normal = LinearMatrix::zeros();
        let mut right = LinearVector::zeros();
        for i in 0..LINEAR {
            for j in i..LINEAR {
                normal[(i, j)] = self.gram[i][j];
                normal[(j, i)] = self.gram[i][j];
            }
            normal[(i, i)] *= 1.0 + JITTER;
            right[i] = self.gram[i][TARGET];
        }
        let factor = Cholesky::new(normal)?;
        let linear = factor.solve(&right);
        let squares = self.gram[TARGET][TARGET] - linear.dot(&right);
        (squares.is_finite() && linear.iter().all(|v| v.is_finite())).then_some((factor, linear, squares.max(0.0)))
    }

    fn hidden_cost(&self, hidden: &[f64]) -> f64 {
        0.5 * self.prior.hidden * hidden.iter().map(|w| w * w).sum::<f64>()
    }
}

impl<R: Rows> Problem for NetworkProblem<'_, R> {
    fn parameters(&self) -> usize {
        NONLINEAR + self.rows.parameters()
    }

    fn cost(&mut self, point: &[f64]) -> f64 {
        let (hidden, extra) = point.split_at(NONLINEAR);
        self.rows.update(extra, false);
        self.fill(hidden, None);
        self.solve_linear().map_or(f64::INFINITY, |(_, _, squares)| 0.5 * squares + self.hidden_cost(hidden))
    }

    fn linearise(&mut self, point: &[f64], quadratic: &mut Quadratic) {
        let (hidden, extra) = point.split_at(NONLINEAR);
        self.rows.update(extra, true);
        self.fill(hidden, None);
        let Some((factor, linear, squares)) = self.solve_linear() else {
            quadratic.cost = f64::INFINITY;
            return;
        };
        self.fill(hidden, Some(&linear));
        quadratic.cost = 0.5 * squares + self.hidden_cost(hidden);
        let parameters = NONLINEAR + extra.len();
        let cross = OMatrix::<f64, Const<LINEAR>, Dyn>::from_fn(parameters, |i, j| self.gram[i][DERIVATIVES + j]);
        let absorbed = cross.transpose() * factor.solve(&cross);
        let scale = |j: usize| if j < NONLINEAR { linear[LINE + j / 3] } else { 1.0 };
        for i in 0..parameters {
            let row = DERIVATIVES + i;
            let fitted: f64 = cross.column(i).dot(&linear);
            quadratic.gradient[i] = -scale(i) * (self.gram[TARGET][row] - fitted);
            for j in i..parameters {
                let value = scale(i) * scale(j) * (self.gram[row][DERIVATIVES + j] - absorbed[(i, j)]);
                quadratic.hessian[(i, j)] = value;
                quadratic.hessian[(j, i)] = value;
            }
        }
        for (i, weight) in hidden.iter().enumerate() {
            quadratic.gradient[i] += self.prior.hidden * weight;
            quadratic.hessian[(i, i)] += self.prior.hidden;
        }
    }
}

/// How the output follows each parameter of the row: the network's slopes times how the row moves,
/// less how its target moves.
fn extra_columns(
    row: &ValueRow,
    hidden: &[f64],
    linear: &LinearVector,
    tangents: &[Tangent],
    columns: &mut [f64; COLUMNS],
) {
    let (mut by_x, mut by_t) = (linear[1] + linear[3] * row.t, linear[2] + linear[3] * row.x);
    for (unit, [wx, wt, _]) in hidden.as_chunks::<3>().0.iter().enumerate() {
        let rise = linear[LINE + unit] * columns[DERIVATIVES + 3 * unit + 2];
        by_x += rise * wx;
        by_t += rise * wt;
    }
    for (column, tangent) in columns[EXTRA..].iter_mut().zip(tangents) {
        *column = by_x * tangent.x + by_t * tangent.t - tangent.y;
    }
}

fn value_columns(row: &ValueRow, hidden: &[f64], columns: &mut [f64; COLUMNS]) {
    let &ValueRow { x, t, y, .. } = row;
    columns[..LINE].copy_from_slice(&[1.0, x, t, x * t]);
    for (unit, [wx, wt, b]) in hidden.as_chunks::<3>().0.iter().enumerate() {
        let u = b + wx * x + wt * t;
        let rise = slope(u);
        columns[LINE + unit] = sigmoid(u);
        columns[DERIVATIVES + 3 * unit..][..3].copy_from_slice(&[rise * x, rise * t, rise]);
    }
    columns[TARGET] = y;
}

fn slope_columns(row: &SlopeRow, hidden: &[f64], columns: &mut [f64; COLUMNS]) {
    let &SlopeRow { x, t, .. } = row;
    columns[..LINE].copy_from_slice(&[0.0, 1.0, 0.0, t]);
    for (unit, [wx, wt, b]) in hidden.as_chunks::<3>().0.iter().enumerate() {
        let u = b + wx * x + wt * t;
        let (rise, bend) = (slope(u), wx * curvature(u));
        columns[LINE + unit] = wx * rise;
        columns[DERIVATIVES + 3 * unit..][..3].copy_from_slice(&[rise + bend * x, bend * t, bend]);
    }
    columns[TARGET] = row.slope;
}

/// Adds weight · columnsᵀcolumns to the upper triangle.
fn accumulate(gram: &mut Gram, columns: &[f64], weight: f64) {
    for (i, (row, column)) in gram.iter_mut().zip(columns).enumerate() {
        let factor = weight * column;
        for (slot, value) in row[i..].iter_mut().zip(&columns[i..]) {
            *slot += factor * value;
        }
    }
}
