//! Vibration shifts the mean.
//!
//! The sensor's even nonlinearities, its suspension and the counter's gates turn an oscillation about
//! zero into a bias that follows its mean square: K_VR of IEEE 1293.

use super::{About, Coefficients, Effect, Moment, Parameter, Role, Signal, SoundLimit, SumResponse};
use crate::real::Real;

/// Number, names, formula, source.
pub const ABOUT: About = About {
    id: 13,
    name: "vibration-rectification",
    summary: "Nonlinearities turn vibration into a bias that follows the mean square of the vibration.",
    equation: "ΔB = K_VR·g²rms",
    source: "IEEE Std 1293, vibration rectification; US patent 12,000,858",
    parameters: &[Parameter {
        name: "kvr_g_per_g2",
        unit: "g/g²",
        role: Role::Amplitude,
        start: 0.0,
        low: -0.1,
        high: 0.1,
        typical: 20e-6,
        sound_limit: SoundLimit::Neither,
        follows_reference: 1,
    }],
    channel: Some("vibration_g2"),
    needs_frequency: false,
    sum_response: SumResponse::STRESS,
    needs: "a vibration_g2 column (mean square) and vibration of several strengths",
};

/// ΔB = K_VR·g²rms.
pub struct VibrationRectification;

impl<R: Real> Effect<R> for VibrationRectification {
    fn coefficients(&self) -> usize {
        ABOUT.parameters.len()
    }

    fn signal(&self) -> Signal {
        Signal::Channel
    }

    fn bias_g(&self, moment: &Moment<R>, &[kvr, ..]: &Coefficients<R>) -> R {
        kvr * moment.channel
    }
}

#[cfg(test)]
mod tests {
    use super::super::bench::{Bench, assert_near};
    use super::*;

    #[test]
    fn two_g_rms_are_80_ug() {
        let bench = Bench { channel: 4.0, ..Bench::REST };
        assert_near(bench.bias_g(&VibrationRectification, &[20e-6]), 80e-6);
    }
}
