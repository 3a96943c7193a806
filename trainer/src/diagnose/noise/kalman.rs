//! The Kalman filter that tracks a noise of several parts and hands out what its past did not predict.
//!
//! What a filter does at a cell depends on cells and noise alone, so one pass serves every column:
//!
//! ```text
//!   P ← K P K + Q      v = hᵀPh + σ²/n      g = P h / v      P ← P − g (P h)ᵀ
//!   x ← K x            e = (y − hᵀx)        x ← x + g e      white value e/√v
//! ```

use super::components::NoiseModel;
use super::initial_state::{FORGOTTEN, PLACES};
use super::observation::{Kind, Lanes, Observed, Seen};
use nalgebra::DMatrix;

/// One part of the noise as a state of the filter.
#[derive(Clone, Copy)]
pub struct State {
    /// How it goes on from cell to cell.
    pub kind: Kind,
    /// Its variance at the start and in equilibrium; what it gains in a second, for a walk.
    pub variance: f64,
}

impl State {
    /// Makes up the number of states; it never does anything.
    const IDLE: Self = Self { kind: Kind::Constant, variance: 0.0 };
}

/// The filter's work at one cell of each of `L` runs, the same for every column.
struct Step<const N: usize, const L: usize> {
    seen: [[f64; L]; N],
    kept: [[f64; L]; N],
    gain: [[f64; L]; N],
    variance: [f64; L],
}

/// The states of `L` runs at once, and what is known of them: a run's next cell waits for its last one, another run's
/// doesn't.
struct Filter<'a, const N: usize, const L: usize> {
    noise: &'a NoiseModel,
    states: [State; N],
    /// The lower triangle; the upper one is not used.
    covariance: [[[f64; L]; N]; N],
}

impl<'a, const N: usize, const L: usize> Filter<'a, N, L> {
    fn new(noise: &'a NoiseModel, states: &[State]) -> Self {
        let mut all = [State::IDLE; N];
        all.iter_mut().zip(states).for_each(|(slot, state)| *slot = *state);
        let mut covariance = [[[0.0; L]; N]; N];
        for (index, state) in all.iter().enumerate() {
            covariance[index][index] = [if matches!(state.kind, Kind::Walk) { 0.0 } else { state.variance }; L];
        }
        Self { noise, states: all, covariance }
    }

    /// Moves on to these cells; a run that has ended has none.
    fn step(&mut self, cells: [Option<Seen>; L], first: bool) -> Step<N, L> {
        let cells = Lanes::new(self.noise, cells);
        let seen = self.states.map(|state| cells.seen(state.kind));
        let kept = if first { [[1.0; L]; N] } else { self.states.map(|state| cells.kept(state.kind)) };
        if !first {
            self.predict(&kept, cells.since_s);
        }
        let mut shared = [[0.0; L]; N];
        for row in 0..N {
            for column in 0..=row {
                for lane in 0..L {
                    let covariance = self.covariance[row][column][lane];
                    shared[row][lane] += covariance * seen[column][lane];
                    if column < row {
                        shared[column][lane] += covariance * seen[row][lane];
                    }
                }
            }
        }
        let mut variance = cells.own;
        for (shared, seen) in shared.iter().zip(&seen) {
            (0..L).for_each(|lane| variance[lane] += shared[lane] * seen[lane]);
        }
        let gain = shared.map(|shared| std::array::from_fn(|lane| shared[lane] / variance[lane]));
        for (row, gain) in gain.iter().enumerate() {
            for (covariance, shared) in self.covariance[row].iter_mut().zip(&shared).take(row + 1) {
                (0..L).for_each(|lane| covariance[lane] -= gain[lane] * shared[lane]);
            }
        }
        Step { seen, kept, gain, variance }
    }

    /// Moves the covariance on over `since_s`, in which so much of each state is kept.
    fn predict(&mut self, kept: &[[f64; L]; N], since_s: [f64; L]) {
        for (row, own) in kept.iter().enumerate() {
            for (covariance, other) in self.covariance[row].iter_mut().zip(kept).take(row + 1) {
                (0..L).for_each(|lane| covariance[lane] *= own[lane] * other[lane]);
            }
            let State { kind, variance } = self.states[row];
            let walks = matches!(kind, Kind::Walk);
            for lane in 0..L {
                let gained = if walks { since_s[lane] } else { 1.0 - own[lane] * own[lane] };
                self.covariance[row][row][lane] += variance * gained;
            }
        }
    }
}

impl<const N: usize, const L: usize> Step<N, L> {
    /// Turns values into what the past did not predict, and learns from it: of several columns of one run, or of one
    /// column of each run.
    fn innovate<const V: usize>(&self, states: &mut [[f64; V]; N], values: &mut [f64; V]) {
        let lane = |value: usize| if L == 1 { 0 } else { value };
        for (state, (kept, seen)) in states.iter_mut().zip(self.kept.iter().zip(&self.seen)) {
            for value in 0..V {
                state[value] *= kept[lane(value)];
                values[value] -= seen[lane(value)] * state[value];
            }
        }
        for (state, gain) in states.iter_mut().zip(&self.gain) {
            (0..V).for_each(|value| state[value] += gain[lane(value)] * values[value]);
        }
    }
}

/// One pass of the filter over a run, which serves every column.
pub trait Pass: Send + Sync {
    /// Columns with the noise's correlation taken out.
    fn whitened(&self, values: &DMatrix<f64>) -> DMatrix<f64>;

    /// Logarithm of the determinant of the noise's covariance.
    fn log_det(&self) -> f64;
}

/// Calls a function of the smallest size of filter that has room for so many states: its work goes with their square.
macro_rules! of_size {
    ($states:expr, $make:ident($($argument:expr),*)) => {
        match $states.len() {
            0..=4 => $make::<4>($($argument),*),
            5..=6 => $make::<6>($($argument),*),
            7..=8 => $make::<8>($($argument),*),
            9..=10 => $make::<10>($($argument),*),
            11..=12 => $make::<12>($($argument),*),
            13..=14 => $make::<14>($($argument),*),
            _ => $make::<MOST_STATES>($($argument),*),
        }
    };
}

/// The filter's pass over a run.
pub fn pass(noise: &NoiseModel, states: &[State], run: Observed) -> Box<dyn Pass> {
    of_size!(states, pass_of(noise, states, run))
}

fn pass_of<const N: usize>(noise: &NoiseModel, states: &[State], run: Observed) -> Box<dyn Pass> {
    Box::new(Steps::of(Filter::<N, 1>::new(noise, states), run))
}

/// So many runs are filtered at once.
pub const RUNS: usize = 4;

/// Minus twice the logarithm of the likelihood of one column of each of at most [`RUNS`] runs, but for a constant.
pub fn deviance(noise: &NoiseModel, states: &[State], runs: &[(Observed, &[f64])]) -> f64 {
    of_size!(states, deviance_of(noise, states, runs))
}

/// Most states: ten whatever is known, and the initial states of what is.
pub const MOST_STATES: usize = 10 + PLACES * FORGOTTEN.len();

/// So many variances are multiplied before their logarithm is taken.
const FACTORS: usize = 8;

fn deviance_of<const N: usize>(noise: &NoiseModel, states: &[State], runs: &[(Observed, &[f64])]) -> f64 {
    let mut filter = Filter::<N, RUNS>::new(noise, states);
    let longest = runs.iter().map(|(run, _)| run.len()).max().unwrap_or_default();
    let (mut states, mut squares, mut logarithms, mut product) = ([[0.0; RUNS]; N], 0.0, 0.0, 1.0);
    for index in 0..longest {
        let (mut cells, mut values) = ([None; RUNS], [0.0; RUNS]);
        for (lane, (run, column)) in runs.iter().enumerate() {
            cells[lane] = run.seen(index);
            values[lane] = column.get(index).copied().unwrap_or_default();
        }
        let step = filter.step(cells, index == 0);
        step.innovate(&mut states, &mut values);
        for (value, variance) in values.iter().zip(&step.variance) {
            squares += value * value / variance;
            product *= variance;
        }
        if (index + 1) % (FACTORS / RUNS) == 0 || index + 1 == longest {
            logarithms += f64::ln(product);
            product = 1.0;
        }
    }
    squares + logarithms
}

/// What the filter does at every cell of a run.
struct Steps<const N: usize>(Vec<Step<N, 1>>);

impl<const N: usize> Steps<N> {
    fn of(mut filter: Filter<N, 1>, run: Observed) -> Self {
        Self((0..run.len()).map(|index| filter.step([run.seen(index)], index == 0)).collect())
    }
}

impl<const N: usize> Pass for Steps<N> {
    fn whitened(&self, values: &DMatrix<f64>) -> DMatrix<f64> {
        let filtered = if values.ncols() == 1 { filtered::<N, 1> } else { filtered::<N, 4> };
        filtered(&self.0, values)
    }

    fn log_det(&self) -> f64 {
        self.0.iter().map(|step| step.variance[0].ln()).sum()
    }
}

/// Filters so many columns at once.
fn filtered<const N: usize, const LANES: usize>(steps: &[Step<N, 1>], values: &DMatrix<f64>) -> DMatrix<f64> {
    let (rows, width) = values.shape();
    let mut white = DMatrix::zeros(rows, width);
    let source = values.as_slice();
    for (chunk, target) in white.as_mut_slice().chunks_mut((rows * LANES).max(1)).enumerate() {
        let lanes = target.len() / rows.max(1);
        let start = chunk * rows * LANES;
        let mut states = [[0.0; LANES]; N];
        for (row, step) in steps.iter().enumerate() {
            let mut values = [0.0; LANES];
            for lane in 0..lanes {
                values[lane] = source[start + lane * rows + row];
            }
            step.innovate(&mut states, &mut values);
            let scale = step.variance[0].sqrt().recip();
            for lane in 0..lanes {
                target[lane * rows + row] = values[lane] * scale;
            }
        }
    }
    white
}

#[cfg(test)]
mod tests {
    use super::super::initial_state::Shares;
    use super::*;
    use crate::campaign::Run;
    use crate::diagnose::cells::{Cell, Groups, RunCells, SLOWEST};
    use crate::diagnose::thresholds::WANDER_TAUS_S;
    use nalgebra::DVector;
    use std::path::PathBuf;

    const CELLS: usize = 12;
    /// Uneven in time; moved twice, sent to another node once.
    fn cell(index: usize) -> Cell {
        let time_s = |index: usize| (index * index) as f64 * 7.0 + 3.0;
        let since_s = index.checked_sub(1).map_or(3.0, |last| time_s(index) - time_s(last));
        Cell {
            samples: 1.0 + (index % 3) as f64,
            cross_g: 0.5 + index as f64 / 20.0,
            unseen_c: if index == 5 { 0.01 } else { 0.0 },
            new_node: index == 6,
            new_position: index == 4 || index == 9,
            ..Cell::plain(index, time_s(index), since_s)
        }
    }

    /// What is left of the second effect's initial state.
    fn initial(index: usize) -> Shares {
        [FORGOTTEN, [(-(index as f64)).exp(), 0.0], FORGOTTEN, FORGOTTEN]
    }

    /// What two cells have in common of a part, as it is defined.
    fn shared(state: &State, a: usize, b: usize) -> f64 {
        let (first, last) = (a.min(b), a.max(b));
        let (one, other) = (cell(a), cell(b));
        let all_kept = |new: fn(&Cell) -> bool| if (first + 1..=last).any(|k| new(&cell(k))) { 0.0 } else { 1.0 };
        let across = one.cross_g * other.cross_g;
        state.variance
            * match state.kind {
                Kind::Constant => 1.0,
                Kind::Mounting => across,
                Kind::Position => across * all_kept(|cell| cell.new_position),
                Kind::Pose => all_kept(|cell| cell.new_position),
                Kind::Node => all_kept(|cell| cell.new_node),
                Kind::Turning => across * (-(one.time_s - other.time_s).abs() / WANDER_TAUS_S[SLOWEST]).exp(),
                Kind::Fading(which) => (-(one.time_s - other.time_s).abs() / WANDER_TAUS_S[which]).exp(),
                Kind::Walk => cell(first).time_s - cell(0).time_s,
                Kind::Initial(place, way) => initial(a)[place][way] * initial(b)[place][way],
            }
    }

    #[test]
    fn the_filter_has_the_likelihood_of_the_covariance_that_the_parts_add_up_to() {
        let noise = NoiseModel::even(5.0, 900.0);
        let kinds = [
            (Kind::Fading(0), 3.0),
            (Kind::Position, 20.0),
            (Kind::Constant, 150.0),
            (Kind::Walk, 0.1),
            (Kind::Node, 25.0),
            (Kind::Mounting, 40.0),
            (Kind::Pose, 12.0),
            (Kind::Fading(SLOWEST), 7.0),
            (Kind::Initial(1, 0), 60.0),
            (Kind::Fading(1), 4.0),
            (Kind::Turning, 30.0),
        ];
        let states = kinds.map(|(kind, sigma)| State { kind, variance: sigma * sigma });
        let run = Run { name: String::new(), kind: String::new(), source: PathBuf::new(), rows: Vec::new() };
        let cells = RunCells { run: &run, cells: (0..CELLS).map(cell).collect(), groups: Groups::default() };
        let shares: Vec<Shares> = (0..CELLS).map(initial).collect();
        let observed = Observed { run: &cells, initial: &shares };
        let values: Vec<f64> = (0..CELLS).map(|k| (k * 37 % 17) as f64 * 9.0 - 60.0).collect();
        let column = DVector::from_vec(values.clone());
        // Every size of filter, full or not.
        for count in 0..=states.len() {
            let states = &states[..count];
            let own = |k: usize| noise.sample.powi(2) / cell(k).samples + (noise.per_c * cell(k).unseen_c).powi(2);
            let covariance = DMatrix::from_fn(CELLS, CELLS, |a, b| {
                let white = if a == b { own(a) } else { 0.0 };
                white + states.iter().map(|state| shared(state, a, b)).sum::<f64>()
            });
            let factor = covariance.cholesky().unwrap();
            let worked = factor.determinant().ln() + column.dot(&factor.solve(&column));
            let found = deviance(&noise, states, &[(observed, &values)]);
            assert!((found - worked).abs() < 1e-8 * worked.abs(), "{count}: {found} {worked}");
            let pass = pass(&noise, states, observed);
            let white = pass.whitened(&DMatrix::from_column_slice(CELLS, 1, &values));
            assert!((white.norm_squared() + pass.log_det() - worked).abs() < 1e-8 * worked.abs(), "{count}");
        }
    }

    #[test]
    fn runs_of_any_length_may_be_filtered_together() {
        let noise = NoiseModel::even(5.0, 900.0);
        let kinds = [(Kind::Constant, 150.0), (Kind::Walk, 0.1), (Kind::Node, 25.0), (Kind::Mounting, 40.0)];
        let states = kinds.map(|(kind, sigma)| State { kind, variance: sigma * sigma });
        let run = Run { name: String::new(), kind: String::new(), source: PathBuf::new(), rows: Vec::new() };
        let of_length =
            |cells: usize| RunCells { run: &run, cells: (0..cells).map(cell).collect(), groups: Groups::default() };
        let lengths = [CELLS, 7, 1].map(of_length);
        let values: Vec<f64> = (0..CELLS).map(|k| (k * 37 % 17) as f64 * 9.0 - 60.0).collect();
        let observed = lengths.iter().map(|run| Observed { run, initial: &[] });
        let runs: Vec<(Observed, &[f64])> = observed.map(|run| (run, &values[..run.len()])).collect();
        let alone: f64 = runs.iter().map(|run| deviance(&noise, &states, &[*run])).sum();
        assert!((deviance(&noise, &states, &runs) / alone - 1.0).abs() < 1e-12);
    }
}
