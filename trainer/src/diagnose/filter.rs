//! The Kalman filter that tracks a noise of several parts and hands out what its past did not foretell.
//!
//! What a filter does at a cell depends on cells and noise alone, so one pass serves every column:
//!
//! ```text
//!   P ← K P K + Q      v = hᵀPh + σ²/n      g = P h / v      P ← P − g (P h)ᵀ
//!   x ← K x            e = (y − hᵀx)        x ← x + g e      white value e/√v
//! ```

use super::layout::{Cell, SLOWEST, Stretch};
use super::whitening::NoiseModel;
use nalgebra::DMatrix;

/// One part of the noise as a state of the filter.
#[derive(Clone, Copy)]
pub(super) struct State {
    /// How it goes on from cell to cell.
    pub kind: Kind,
    /// Its variance at the start and in equilibrium; what it gains in a second, for a walk.
    pub variance: f64,
}

impl State {
    /// Makes up the number of states; it never does anything.
    const IDLE: Self = Self { kind: Kind::Constant, variance: 0.0 };
}

/// How a part of the noise goes on from cell to cell, and how it shows.
#[derive(Clone, Copy)]
pub(super) enum Kind {
    /// The same throughout a run.
    Constant,
    /// Throughout a run, per g across the input axis.
    Mounting,
    /// New at every position, per g across the input axis.
    Position,
    /// New at every position.
    Pose,
    /// New at every soaked node.
    Node,
    /// Fades with one of the times of `layout::WANDER_TAUS_S`.
    Fading(usize),
    /// Fades within hours, per g across the input axis.
    Turning,
    /// A random walk.
    Walk,
    /// As much as is left of what effects brought along.
    Beginning,
}

impl Kind {
    /// How it shows in a cell.
    fn seen(self, cell: &Cell) -> f64 {
        match self {
            Self::Mounting | Self::Position | Self::Turning => cell.cross_g,
            Self::Beginning => cell.beginning,
            _ => 1.0,
        }
    }

    /// Which share of it is kept on the way to a cell.
    fn kept(self, cell: &Cell) -> f64 {
        match self {
            Self::Position | Self::Pose if cell.new_position => 0.0,
            Self::Node if cell.new_node => 0.0,
            Self::Fading(which) => cell.unfaded[which],
            Self::Turning => cell.unfaded[SLOWEST],
            _ => 1.0,
        }
    }
}

/// The filter's work at one cell, the same for every column.
struct Step<const N: usize> {
    seen: [f64; N],
    kept: [f64; N],
    gain: [f64; N],
    variance: f64,
}

/// The states and what is known of them.
struct Filter<'a, const N: usize> {
    noise: &'a NoiseModel,
    states: [State; N],
    covariance: [[f64; N]; N],
}

impl<'a, const N: usize> Filter<'a, N> {
    fn new(noise: &'a NoiseModel, states: &[State]) -> Self {
        let mut all = [State::IDLE; N];
        all.iter_mut().zip(states).for_each(|(slot, state)| *slot = *state);
        Self { noise, states: all, covariance: [[0.0; N]; N] }
    }

    fn steps(mut self, stretch: &Stretch) -> impl Iterator<Item = Step<N>> {
        stretch.cells.iter().enumerate().map(move |(index, cell)| self.step(cell, index == 0))
    }

    fn step(&mut self, cell: &Cell, first: bool) -> Step<N> {
        let kept = if first { self.begin() } else { self.predict(cell) };
        let seen = self.states.map(|state| state.kind.seen(cell));
        let mut shared = [0.0; N];
        for (shared, row) in shared.iter_mut().zip(&self.covariance) {
            *shared = row.iter().zip(&seen).map(|(covariance, seen)| covariance * seen).sum();
        }
        let own = self.noise.sample.powi(2) / cell.samples + (self.noise.per_c * cell.unseen_c).powi(2);
        let variance = own + shared.iter().zip(&seen).map(|(shared, seen)| shared * seen).sum::<f64>();
        let gain = shared.map(|shared| shared / variance);
        for (row, gain) in self.covariance.iter_mut().zip(&gain) {
            row.iter_mut().zip(&shared).for_each(|(covariance, shared)| *covariance -= gain * shared);
        }
        Step { seen, kept, gain, variance }
    }

    fn begin(&mut self) -> [f64; N] {
        for (index, state) in self.states.iter().enumerate() {
            self.covariance[index][index] = if matches!(state.kind, Kind::Walk) { 0.0 } else { state.variance };
        }
        [1.0; N]
    }

    /// Moves the covariance on to `cell`; returns which share of each state is kept.
    fn predict(&mut self, cell: &Cell) -> [f64; N] {
        let kept = self.states.map(|state| state.kind.kept(cell));
        for (row, own) in self.covariance.iter_mut().zip(&kept) {
            row.iter_mut().zip(&kept).for_each(|(covariance, other)| *covariance *= own * other);
        }
        for (index, (state, kept)) in self.states.iter().zip(&kept).enumerate() {
            let walks = matches!(state.kind, Kind::Walk);
            let gained = if walks { cell.since_s } else { 1.0 - kept * kept };
            self.covariance[index][index] += state.variance * gained;
        }
        kept
    }
}

impl<const N: usize> Step<N> {
    /// Turns values into what the past did not foretell, and learns from it.
    fn innovate<const LANES: usize>(&self, states: &mut [[f64; LANES]; N], values: &mut [f64; LANES]) {
        for (state, (kept, seen)) in states.iter_mut().zip(self.kept.iter().zip(&self.seen)) {
            for (state, value) in state.iter_mut().zip(values.iter_mut()) {
                *state *= kept;
                *value -= seen * *state;
            }
        }
        for (state, gain) in states.iter_mut().zip(&self.gain) {
            state.iter_mut().zip(values.iter()).for_each(|(state, value)| *state += gain * value);
        }
    }
}

/// One pass of the filter over a run, which serves every column.
pub(super) trait Pass: Send + Sync {
    /// Columns with the noise's correlation taken out.
    fn whitened(&self, values: &DMatrix<f64>) -> DMatrix<f64>;

    /// Logarithm of the determinant of the noise's covariance.
    fn log_det(&self) -> f64;
}

/// The filter's pass over a run.
pub(super) fn pass(noise: &NoiseModel, states: &[State], run: &Stretch) -> Box<dyn Pass> {
    match states.len() {
        0..=4 => Box::new(Steps::of(Filter::<4>::new(noise, states), run)),
        5..=6 => Box::new(Steps::of(Filter::<6>::new(noise, states), run)),
        7..=8 => Box::new(Steps::of(Filter::<8>::new(noise, states), run)),
        _ => Box::new(Steps::of(Filter::<MOST_STATES>::new(noise, states), run)),
    }
}

/// Minus twice the logarithm of the likelihood of one column of a run, but for a constant.
pub(super) fn deviance(noise: &NoiseModel, states: &[State], run: &Stretch, values: &[f64]) -> f64 {
    match states.len() {
        0..=4 => deviance_by(Filter::<4>::new(noise, states), run, values),
        5..=6 => deviance_by(Filter::<6>::new(noise, states), run, values),
        7..=8 => deviance_by(Filter::<8>::new(noise, states), run, values),
        _ => deviance_by(Filter::<MOST_STATES>::new(noise, states), run, values),
    }
}

/// Most states.
const MOST_STATES: usize = 11;

fn deviance_by<const N: usize>(filter: Filter<N>, run: &Stretch, values: &[f64]) -> f64 {
    let mut states = [[0.0]; N];
    let one = |(step, value): (Step<N>, &f64)| {
        let mut value = [*value];
        step.innovate(&mut states, &mut value);
        step.variance.ln() + value[0] * value[0] / step.variance
    };
    filter.steps(run).zip(values).map(one).sum()
}

/// What the filter does at every cell of a run.
struct Steps<const N: usize>(Vec<Step<N>>);

impl<const N: usize> Steps<N> {
    fn of(filter: Filter<N>, run: &Stretch) -> Self {
        Self(filter.steps(run).collect())
    }
}

impl<const N: usize> Pass for Steps<N> {
    fn whitened(&self, values: &DMatrix<f64>) -> DMatrix<f64> {
        let filtered = if values.ncols() == 1 { filtered::<N, 1> } else { filtered::<N, 4> };
        filtered(&self.0, values)
    }

    fn log_det(&self) -> f64 {
        self.0.iter().map(|step| step.variance.ln()).sum()
    }
}

/// Filters so many columns at once.
fn filtered<const N: usize, const LANES: usize>(steps: &[Step<N>], values: &DMatrix<f64>) -> DMatrix<f64> {
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
            let scale = step.variance.sqrt().recip();
            for lane in 0..lanes {
                target[lane * rows + row] = values[lane] * scale;
            }
        }
    }
    white
}

#[cfg(test)]
mod tests {
    use super::super::gathered::Gathered;
    use super::super::layout::WANDER_TAUS_S;
    use super::*;
    use crate::campaign::Run;
    use nalgebra::DVector;
    use std::path::PathBuf;

    const CELLS: usize = 12;
    /// Uneven in time; moved twice, sent to another node once.
    fn cell(index: usize) -> Cell {
        let time_s = |index: usize| (index * index) as f64 * 7.0 + 3.0;
        let since_s = index.checked_sub(1).map_or(3.0, |last| time_s(index) - time_s(last));
        Cell {
            rows: index..index + 1,
            samples: 1.0 + (index % 3) as f64,
            time_s: time_s(index),
            since_s,
            unfaded: WANDER_TAUS_S.map(|tau_s| (-since_s / tau_s).exp()),
            x: 0.0,
            t: 0.0,
            level_g: 0.0,
            cross_g: 0.5 + index as f64 / 20.0,
            unseen_c: if index == 5 { 0.01 } else { 0.0 },
            beginning: (-(index as f64)).exp(),
            new_node: index == 6,
            new_position: index == 4 || index == 9,
        }
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
                Kind::Beginning => one.beginning * other.beginning,
            }
    }

    #[test]
    fn the_filter_has_the_likelihood_of_the_covariance_that_the_parts_add_up_to() {
        let noise = NoiseModel { sample: 5.0, per_c: 900.0, parts: [0.0; super::super::whitening::PARTS] };
        let kinds = [
            (Kind::Fading(0), 3.0),
            (Kind::Position, 20.0),
            (Kind::Constant, 150.0),
            (Kind::Walk, 0.1),
            (Kind::Node, 25.0),
            (Kind::Mounting, 40.0),
            (Kind::Pose, 12.0),
            (Kind::Fading(SLOWEST), 7.0),
            (Kind::Beginning, 60.0),
            (Kind::Fading(1), 4.0),
            (Kind::Turning, 30.0),
        ];
        let states = kinds.map(|(kind, sigma)| State { kind, variance: sigma * sigma });
        let run = Run { name: String::new(), kind: String::new(), source: PathBuf::new(), rows: Vec::new() };
        let stretch = Stretch { run: &run, cells: (0..CELLS).map(cell).collect(), gathered: Gathered::default() };
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
            let found = deviance(&noise, states, &stretch, &values);
            assert!((found - worked).abs() < 1e-8 * worked.abs(), "{count}: {found} {worked}");
            let pass = pass(&noise, states, &stretch);
            let white = pass.whitened(&DMatrix::from_column_slice(CELLS, 1, &values));
            assert!((white.norm_squared() + pass.log_det() - worked).abs() < 1e-8 * worked.abs(), "{count}");
        }
    }
}
