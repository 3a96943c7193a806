//! What is left that nothing explains.

use super::found::Findings;
use crate::campaign::Campaign;
use crate::diagnose::answer::{Dependence, Unexplained};
use crate::diagnose::forward::name_of;
use crate::diagnose::lack_of_fit::LackOfFit;
use crate::diagnose::noise::{Component, NoiseModel};
use crate::diagnose::problem::Problem;
use crate::diagnose::thresholds::{LEAST_CHANCE, STRUCTURE, UNSEEN_RIG};

/// Seconds in which a random walk is compared with the other parts of the wander.
const WALK_SQRT_S: f64 = 60.0;

/// Whether something causes the wander within runs.
pub fn is_structured(problem: &Problem, noise: &NoiseModel) -> bool {
    let rig_ug = noise[Component::Position].hypot(noise[Component::Turn]);
    let unseen_ug = if problem.cells().may_turn_unseen() { UNSEEN_RIG * rig_ug } else { 0.0 };
    wander_ug(noise) > f64::max(STRUCTURE * problem.sample_ug, unseen_ug)
}

/// Wander within a run, µg RMS over an hour.
fn wander_ug(noise: &NoiseModel) -> f64 {
    let [flicker, wander, walk] =
        [Component::Flicker, Component::Wander, Component::Walk].map(|component| noise[component]);
    (2.0 * flicker.powi(2) + wander.powi(2) + (walk * WALK_SQRT_S).powi(2)).sqrt()
}

/// Share of the square above what no model can remove; what is new in every run is not in it.
pub fn explainable(before_ug: f64, after_ug: f64, noise: &NoiseModel) -> f64 {
    let parts = Component::ALL.into_iter().filter(|component| component.scatters_within_runs());
    let parts = parts.map(|component| noise[component].powi(2));
    let floor = (noise.sample.powi(2) + parts.sum::<f64>()).min(after_ug.powi(2));
    let excess = before_ug.powi(2) - floor;
    if excess > 0.0 { ((before_ug.powi(2) - after_ug.powi(2)) / excess).clamp(0.0, 1.0) } else { 0.0 }
}

/// What the rest follows, the surest sign first. It is no larger than all that is left, `most_ug`: a structure is sized where it
/// is strongest, and a wander over an hour where few runs last so long.
pub fn unexplained_rest(
    found: &Findings,
    lack_of_fit: &[LackOfFit],
    dependences: &[Dependence],
    campaign: &Campaign,
    most_ug: f64,
) -> Unexplained {
    let surely = dependences.iter().filter(|one| one.chance_after < LEAST_CHANCE && one.after_ug > 0.0);
    let mut sizes: Vec<(f64, &String)> = surely.map(|one| (one.after_ug, &one.on)).collect();
    sizes.sort_by(|a, b| b.0.total_cmp(&a.0));
    let formula = found.formula.as_ref().map(|formula| name_of(&formula.effect).to_owned());
    let is_followed = |index: usize| found.formula.as_ref().is_some_and(|formula| formula.effect.follows(index));
    let followed = campaign.channels.iter().enumerate().filter(|(index, _)| is_followed(*index)).map(|(_, name)| name);
    let told = lack_of_fit.iter().flat_map(|one| &one.depends_on);
    let mut depends_on: Vec<String> = Vec::new();
    for name in followed.chain(told).chain(sizes.into_iter().map(|(_, name)| name)) {
        if !depends_on.contains(name) {
            depends_on.push(name.clone());
        }
    }
    if depends_on.is_empty() {
        depends_on.push("time_s".to_owned());
    }
    let largest_ug = lack_of_fit.iter().map(|one| one.size_ug).fold(0.0, f64::max);
    Unexplained {
        depends_on,
        period_s: lack_of_fit.iter().find_map(|one| one.period_s),
        formula,
        residual_ug: wander_ug(&found.noises.delta).max(largest_ug).min(most_ug),
    }
}
