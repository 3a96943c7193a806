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
    /// The residual: one column.
    pub residual: &'a Columns,
    /// What may absorb it.
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
