//! A small model for tests.

use super::{Model, ModelDomain, ModelEffect, ModelNetwork, ModelScaling, Provenance, Units};
use crate::campaign::{ReadAs, ReadOptions};

/// A line, a little network, a lag; trained on a still sensor's recording.
pub fn model() -> Model {
    Model {
        format: Model::FORMAT,
        serial: "EXAMPLE-1".to_owned(),
        provenance: Provenance {
            made_by: "tempco".to_owned(),
            campaign: "00".to_owned(),
            method: "second-order".to_owned(),
            seed: 1,
            restarts: 3,
            training_runs: vec!["full-1".to_owned()],
            held_out_runs: vec!["full-2".to_owned()],
            training_residual: 5e-6,
            scale_factor_hz_per_g: Some(80.0),
            read_as: ReadAs {
                options: ReadOptions { constant_reference: Some(0.5), ..ReadOptions::default() },
                manifest: ReadOptions {
                    map: [("time_s".to_owned(), "t * 0.001".to_owned())].into(),
                    ..ReadOptions::default()
                },
            },
        },
        units: Units { signal: "Hz".to_owned(), reference: "g".to_owned() },
        scaling: ModelScaling {
            delta_f_zero_uhz: 76_000_000,
            delta_f_gain_per_hz: 0.0125,
            temperature_zero_uc: 25_000_000,
            temperature_gain_per_c: 0.016,
            line_g: [0.001, 1.0, -0.002, 0.0005],
            output_g: 0.003,
        },
        domain: ModelDomain {
            delta_f_uhz: [-4_000_000, 156_000_000],
            temperature_uc: [-40_000_000, 85_000_000],
            max_gap_us: 10_000_000,
        },
        network: ModelNetwork { input: [[0.25, -0.5]; 10], bias: [0.125; 10], output: [0.5; 10], output_bias: 0.0 },
        channels: Vec::new(),
        effects: vec![ModelEffect {
            name: "thermal-lag".to_owned(),
            channel: None,
            expression: None,
            parameters: [("tau_s".to_owned(), 40.0)].into(),
        }],
    }
}
