//! What a model's coefficients can be, in the model's own units.

use super::Model;
use crate::units::{DRIFT_G, ORDINARY_G, exponent, units_per_g};
use firmware_core::effect::{About, Parameter};
use firmware_core::{Network, Scale};

/// A model tells the size of its campaign within this factor.
const UNSURE: f64 = 2.0;
/// The bounds of a coefficient of `model` in the model's own units.
pub(super) fn bounds_of(model: &Model, about: &About, parameter: &Parameter) -> (f64, f64) {
    let power = -exponent(about, parameter.name);
    let widest = factors_of(model).map(|factor| factor.powi(power)).into_iter().fold(0.0, f64::max);
    (parameter.low * widest, parameter.high * widest)
}

/// How far a model's reading goes to either side over what it was trained on.
pub(crate) fn reach(model: &Model) -> f64 {
    let (network, scale) = (Network::<f64>::new(&model.weights()), Scale::new(&model.scaling.to_wire()));
    let reading = |x: f64| scale.reading_g(x, 0.0, network.evaluate(x, 0.0));
    (reading(1.0) - reading(-1.0)).abs() / 2.0
}

/// What training multiplied references with to make `model`, as far as the model tells: the least and the greatest.
/// Its coefficients were bounded in the units of the work.
fn factors_of(model: &Model) -> [f64; 2] {
    let reach = reach(model);
    let about = |factor: f64| [factor / UNSURE, factor * UNSURE];
    if model.provenance.scale_factor_hz_per_g.is_some() {
        return about(DRIFT_G / reach);
    }
    match units_per_g(&model.units.reference) {
        Some(per_g) if ORDINARY_G.contains(&(reach / per_g)) => [per_g.recip(); 2],
        _ => about(reach.recip()),
    }
}
