//! At both ends of the range the sensor is stiffer, or softer, than in the middle.
//!
//! An ideal pair of resonators already has s²/8 of it, and the proof mass's suspension adds its own: the
//! coefficient K3 of IEEE 1293.
//!
//! At 0 and ±1 g alone a³ = a, and nothing tells it from the scale factor. A function of the
//! acceleration alone is also what the network learns: the term earns its place where the network was
//! not trained, at the far ends.

use super::{About, Coefficients, Effect, Moment, Parameter, Role, SoundLimit, SumResponse};
use crate::real::Real;

/// Number, names, formula, source.
pub const ABOUT: About = About {
    id: 10,
    name: "third-order",
    summary: "The sensing element is stiffer at both ends of its range, which leaves a term in the cube of the acceleration.",
    equation: "ΔB = K3·a³",
    source: "IEEE Std 1293, K3; Zhang et al. on the nonlinearity of silicon resonant accelerometers",
    parameters: &[Parameter {
        name: "k3_g_per_g3",
        unit: "g/g³",
        role: Role::Amplitude,
        start: 0.0,
        low: -0.01,
        high: 0.01,
        typical: 0.5e-6,
        sound_limit: SoundLimit::Neither,
        follows_reference: -2,
    }],
    channel: None,
    needs_frequency: false,
    sum_response: SumResponse::STRESS,
    needs: "five or more levels of acceleration, as in a tumble, best beyond 1 g",
};

/// ΔB = K3·a³.
pub struct ThirdOrder;

impl<R: Real> Effect<R> for ThirdOrder {
    fn coefficients(&self) -> usize {
        ABOUT.parameters.len()
    }

    fn bias_g(&self, moment: &Moment<R>, &[k3, ..]: &Coefficients<R>) -> R {
        k3 * moment.level_g * moment.level_g * moment.level_g
    }
}

#[cfg(test)]
mod tests {
    use super::super::bench::{Bench, assert_near};
    use super::*;

    #[test]
    fn half_a_ug_per_cubic_g_is_32_mg_at_40_g_and_keeps_its_sign() {
        let at = |level_g| Bench { level_g, ..Bench::REST }.bias_g(&ThirdOrder, &[0.5e-6]);
        assert_near(at(40.0), 0.032);
        assert_near(at(-40.0), -0.032);
    }
}
