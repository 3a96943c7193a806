//! Variance components: the noise of most restricted likelihood (REML; Patterson & Thompson 1971), found by a pattern
//! search over the logarithms of its parts.

use super::gls::Gls;
use crate::diagnose::cells::{Cells, Columns};
use crate::diagnose::noise::{Component, InitialStates, NoiseModel, deviance};
use crate::diagnose::thresholds::{COMPONENT_STEPS, FIRST_NOISE_TURNS, LEAST_COMPONENT, LEAST_ROUND, MOST_COMPONENT};

/// What the noise is estimated from: a residual and what may absorb it, in cells of which is known how much of the initial
/// states is left.
pub struct Measured<'a> {
    /// The cells.
    pub cells: &'a Cells<'a>,
    /// What is left of the initial states.
    pub initial: &'a InitialStates,
    /// The residual, µg or mHz: of each run cells × 1.
    pub residual: &'a Columns,
    /// What may absorb it, in the same unit: of each run cells × p.
    pub nuisance: &'a Columns,
}

impl Measured<'_> {
    /// The most likely noise of the residual, the nuisance used to the full; from `start`, or from a first guess when
    /// nothing is known (`coarse`).
    pub fn noise(&self, start: NoiseModel, coarse: bool) -> NoiseModel {
        let mut noise = start;
        for turn in 0..if coarse { FIRST_NOISE_TURNS } else { 1 } {
            let Some(gls) = self.gls(&noise) else { return noise };
            let adapted = gls.adapted(self.residual, self.nuisance);
            noise = self.search(&adapted, noise, if coarse && turn == 0 { 0 } else { 1 });
        }
        noise
    }

    /// The regression under this noise.
    pub fn gls(&self, noise: &NoiseModel) -> Option<Gls> {
        Gls::new(self.cells, self.initial, noise, self.residual, self.nuisance)
    }

    fn search(&self, residual: &Columns, start: NoiseModel, from: usize) -> NoiseModel {
        let deviance = |noise: &NoiseModel| deviance(self.cells, self.initial, noise, residual);
        let is_there = |component: &Component| match component {
            Component::Initial(place) => self.initial.remembers(*place),
            _ => true,
        };
        let components: Vec<Component> = Component::ALL.into_iter().filter(is_there).collect();
        let mut best = (start, deviance(&start));
        for step in &COMPONENT_STEPS[from..] {
            loop {
                let before = best.1;
                for component in &components {
                    best = improved(best, *component, *step, &deviance);
                }
                if before - best.1 < LEAST_ROUND.max(*step) {
                    break;
                }
            }
        }
        best.0
    }
}

fn improved(
    best: (NoiseModel, f64),
    component: Component,
    step: f64,
    deviance: &impl Fn(&NoiseModel) -> f64,
) -> (NoiseModel, f64) {
    for factor in [step, step.recip()] {
        let mut found = best;
        while let Some(next) = changed(&found.0, component, factor) {
            let value = deviance(&next);
            if value >= found.1 {
                break;
            }
            found = (next, value);
        }
        if found.1 < best.1 {
            return found;
        }
    }
    best
}

/// `None` at a bound, and for a part that is nothing at all: that is how a part is left out.
fn changed(noise: &NoiseModel, component: Component, factor: f64) -> Option<NoiseModel> {
    let size = noise[component];
    if size == 0.0 {
        return None;
    }
    let mut next = *noise;
    let unit = component.unit(noise.sample);
    next[component] = (size * factor).clamp(LEAST_COMPONENT * unit, MOST_COMPONENT * unit);
    (next[component] != size).then_some(next)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnose::example::{Gauss, Recipe, problem, white_noise};
    use nalgebra::DMatrix;

    const SAMPLE_UG: f64 = 5.0;
    const RUN_UG: f64 = 60.0;
    const POSITION_UG: f64 = 25.0;
    const WALK_UG_PER_SQRT_S: f64 = 0.4;

    /// A residual that is noise of these sizes and nothing else: of a sample, run, position and walk.
    fn simulated(cells: &Cells, [sample, run, position, walk]: [f64; 4]) -> Columns {
        let mut gauss = Gauss::new(5);
        let mut of = |cells: &[crate::diagnose::cells::Cell]| {
            let (offset, mut table, mut course) = (run * gauss.next(), 0.0, 0.0);
            let values = cells.iter().enumerate().map(|(index, cell)| {
                if cell.new_position {
                    table = position * gauss.next();
                }
                if index > 0 {
                    course += walk * cell.since_s.sqrt() * gauss.next();
                }
                offset + table * cell.cross_g + course + sample / cell.samples.sqrt() * gauss.next()
            });
            DMatrix::from_iterator(cells.len(), 1, values)
        };
        cells.runs.iter().map(|run| of(&run.cells)).collect()
    }

    fn found(sizes: [f64; 4], start: NoiseModel) -> NoiseModel {
        let campaign = Recipe { runs: 40, rows: 90, ..Recipe::default() }.campaign();
        let problem = problem(&campaign);
        let residual = simulated(problem.cells(), sizes);
        let nuisance: Columns = residual.iter().map(|run| DMatrix::zeros(run.nrows(), 0)).collect();
        let initial = InitialStates::default();
        Measured { cells: problem.cells(), initial: &initial, residual: &residual, nuisance: &nuisance }
            .noise(start, true)
    }

    #[test]
    fn the_components_that_a_residual_was_made_of_are_found_again() {
        let sizes = [SAMPLE_UG, RUN_UG, POSITION_UG, WALK_UG_PER_SQRT_S];
        let mut start = NoiseModel::first_guess(SAMPLE_UG, 0.0);
        // Within half an hour a wander of hours is a walk.
        (start[Component::Flicker], start[Component::Wander]) = (0.0, 0.0);
        let noise = found(sizes, start);
        // Forty values say a standard deviation to 11 %; the search ends within a factor of 1.2.
        for (component, size) in
            [(Component::Run, RUN_UG), (Component::Position, POSITION_UG), (Component::Walk, WALK_UG_PER_SQRT_S)]
        {
            let ratio = noise[component] / size;
            assert!((0.65..1.5).contains(&ratio), "{component:?}: {ratio}");
        }
        for absent in [Component::Node, Component::Pose] {
            assert!(noise[absent] < 1.5 * SAMPLE_UG, "{absent:?}: {}", noise[absent]);
        }
    }

    #[test]
    fn a_part_that_starts_at_nothing_stays_at_nothing() {
        let sizes = [SAMPLE_UG, RUN_UG, POSITION_UG, 0.0];
        let mut start = white_noise(SAMPLE_UG, 0.0);
        start[Component::Run] = SAMPLE_UG;
        let noise = found(sizes, start);
        assert!(noise[Component::Run] > 0.5 * RUN_UG, "{}", noise[Component::Run]);
        for component in Component::ALL.into_iter().filter(|component| *component != Component::Run) {
            assert_eq!(noise[component], 0.0, "{component:?}");
        }
    }

    #[test]
    fn no_part_is_searched_below_or_above_its_bounds() {
        let noise = found([SAMPLE_UG, 0.0, 0.0, 0.0], NoiseModel::first_guess(SAMPLE_UG, 0.0));
        for component in [Component::Run, Component::Position, Component::Walk, Component::Wander] {
            let least = LEAST_COMPONENT * component.unit(SAMPLE_UG);
            assert!(
                noise[component] >= least && noise[component] < 20.0 * least,
                "{component:?}: {}",
                noise[component]
            );
        }
    }
}
