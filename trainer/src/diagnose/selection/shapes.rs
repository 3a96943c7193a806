//! The grid of shapes at which an effect is tried.

use crate::diagnose::forward::is_placed;
use crate::diagnose::problem::Problem;
use crate::diagnose::thresholds::{
    AMPLITUDE_UNIT, FORMULA_UNIT_G, PLACE_STEP, PLACE_STEP_C, SHAPES, SHAPES_OF_SEVERAL, SHIFTS, WIDTHS_C,
};
use crate::fit::effects::Chosen;
use firmware_core::effect::{About, Parameter, Role};

/// The size at which the amplitude at `index` is tried.
pub fn unit(effect: &Chosen, index: usize) -> f64 {
    if effect.expression.is_some() { FORMULA_UNIT_G } else { effect.about.parameters[index].high * AMPLITUDE_UNIT }
}

/// Coefficients of an effect at every shape worth trying, every amplitude at its unit.
pub fn shapes(effect: &Chosen, problem: &Problem) -> Vec<Vec<f64>> {
    let fork_c_per_g = problem.forward.shift_c_per_g();
    let searched = effect.about.parameters.iter().filter(|about| about.role == Role::Shape).count();
    let placed = is_placed(effect.about);
    let mut found = vec![Vec::new()];
    for about in effect.about.parameters {
        let choices = |before: &[f64]| match about.role {
            Role::Amplitude => vec![unit(effect, before.len())],
            Role::Shape if effect.expression.as_ref().is_some_and(|expression| expression.leaves_idle(about)) => {
                vec![about.start]
            }
            Role::Origin => vec![effect.origin],
            Role::Shape if placed => WIDTHS_C.to_vec(),
            Role::Shape => logarithmic(about, if searched > 1 { SHAPES_OF_SEVERAL } else { SHAPES }),
            Role::Location if about.unit == "°C" => places(problem, width_c(effect.about, before)),
            Role::Location => SHIFTS.map(|share| (share * fork_c_per_g).clamp(about.low, about.high)).into(),
        };
        let extended = |before: Vec<f64>| {
            let next = choices(&before);
            next.into_iter().map(move |next| before.iter().copied().chain([next]).collect())
        };
        found = found.into_iter().flat_map(extended).collect();
    }
    found
}

fn logarithmic(about: &Parameter, count: usize) -> Vec<f64> {
    let part = |k: usize| (k as f64 + 0.5) / count as f64;
    (0..count).map(|k| about.low * (about.high / about.low).powf(part(k))).collect()
}

/// Places on the temperature axis, as dense as a feature of this width needs.
fn places(problem: &Problem, width_c: f64) -> Vec<f64> {
    let scale = &problem.cells().scale;
    let (zero_c, half_c) = (f64::from(scale.temperature_zero_uc) * 1e-6, scale.temperature_half_span_c);
    let step_c = PLACE_STEP_C.max(width_c * PLACE_STEP);
    let count = (2.0 * half_c / step_c).ceil().clamp(1.0, 80.0) as usize;
    (0..=count).map(|k| zero_c - half_c + 2.0 * half_c * k as f64 / count as f64).collect()
}

/// The width among the parameters chosen so far.
pub fn width_c(about: &About, values: &[f64]) -> f64 {
    let mut pairs = about.parameters.iter().zip(values);
    pairs.find(|(about, _)| about.role == Role::Shape).map_or(0.0, |(_, value)| *value)
}
