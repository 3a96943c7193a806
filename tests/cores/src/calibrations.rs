//! Calibrations that together use every effect of the registry and every step of a user's own program, and scales
//! at the ends of what `f32` can be.

use firmware_core::Network;
use heapless::Vec;
use protocol::limits::{MAX_CHANNELS, MAX_PROGRAM, MAX_TERMS};
use protocol::{Blob, Domain, Scaling, Term, Timing, Weights};

/// An effect's number and typical coefficients.
type Row = (u16, &'static [f32]);

/// Every effect whose formula is the firmware's.
const EFFECTS: [Row; 20] = [
    (1, &[35.0]),
    (2, &[0.012, 5.0]),
    (3, &[140e-6, 600.0]),
    (4, &[10e-6, 4.0]),
    (5, &[10e-6]),
    (6, &[1e-3, 5.0]),
    (7, &[5e-6, 6000.0]),
    (8, &[1e-6, 30.0, 2.0]),
    (9, &[2.0]),
    (10, &[0.5e-6]),
    (11, &[1e-4, 2e-5]),
    (12, &[1e-4, 1e-6]),
    (13, &[2e-5]),
    (14, &[3e-7, 101_325.0]),
    (15, &[5e-6, 20.0, 45.0]),
    (16, &[3e-4, 2.0, 27.0, 4.0]),
    (17, &[2.0]),
    (19, &[20e-6, 200.0]),
    (20, &[0.5]),
    (21, &[0.2, 900.0]),
];

/// The number of the effect that takes a program.
const EXPRESSION: u16 = 22;

/// Programs of users' own effects; together they have every step that there is.
const PROGRAMS: [&[u8]; 6] = [
    // supply · rate
    &[0x80, 0x03, 0x12],
    // e^(−power_on_s/600) · √|channel 1 − level| + rate² + departure + temperature/delta_f · age
    &[
        0x06, 0x00, 0x00, 0x00, 0x16, 0x44, 0x13, 0x20, 0x24, 0x81, 0x05, 0x11, 0x21, 0x23, 0x12, 0x03, 0x22, 0x02,
        0x10, 0x10, 0x01, 0x04, 0x13, 0x07, 0x12, 0x10,
    ],
    // √channel 2, which is none where it is negative
    &[0x82, 0x23],
    // e^channel 3, which overflows
    &[0x83, 0x24],
    // level / departure, which is none at rest
    &[0x05, 0x02, 0x13],
    // channel 4 − channel 5 · channel 6 / channel 7
    &[0x84, 0x85, 0x86, 0x12, 0x87, 0x13, 0x11],
];

/// A calibration's name and how it is made.
pub type Named = (&'static str, fn() -> Blob);

/// Every calibration.
pub const ALL: [Named; 7] = [
    ("network", bare),
    ("effects 1 to 8", || with(effects(&EFFECTS[..8]))),
    ("effects 9 to 16", || with(effects(&EFFECTS[8..16]))),
    ("effects 17 to 21", || with(effects(&EFFECTS[16..]))),
    ("users' programs", || with(programs())),
    ("tiny numbers", tiny),
    ("huge numbers", huge),
];

/// A plausible calibration without effects.
#[must_use]
pub fn bare() -> Blob {
    let weights = Weights::from_array(&core::array::from_fn(|i| (i * 37 % 41) as f32 / 16.0 - 1.25));
    Blob {
        serial: heapless::String::new(),
        provenance: *b"on-cores",
        proof: Network::new(&weights).proof().unwrap_or(0),
        scaling: Scaling {
            delta_f_zero_uhz: 76_000_000,
            delta_f_gain_per_hz: 0.012_5,
            temperature_zero_uc: 25_000_000,
            temperature_gain_per_c: 0.016,
            line_g: [0.001, 1.0, -0.002, 0.000_5],
            output_g: 0.003,
        },
        weights,
        domain: Domain { delta_f_uhz: (-4_000_000, 156_000_000), temperature_uc: (-40_000_000, 85_000_000) },
        timing: Timing { max_gap_us: 10_000_000 },
        channels: channels(),
        terms: Vec::new(),
    }
}

/// The plausible calibration with these effects.
#[must_use]
pub fn with(terms: Vec<Term, MAX_TERMS>) -> Blob {
    Blob { terms, ..bare() }
}

/// Scales and weights where products are subnormal or vanish.
fn tiny() -> Blob {
    let mut blob = with(effects(&EFFECTS[..4]));
    blob.weights = Weights::from_array(&core::array::from_fn(|i| match i % 4 {
        0 => f32::from_bits(1 + i as u32),
        1 => -f32::MIN_POSITIVE * i as f32,
        2 => -0.0,
        _ => 1.5 - i as f32 / 16.0,
    }));
    blob.scaling.delta_f_gain_per_hz = f32::from_bits(0x0000_2000);
    blob.scaling.line_g = [0.0, 1.0, -f32::MIN_POSITIVE, f32::from_bits(3)];
    blob.scaling.output_g = 1e-30;
    proven(blob)
}

/// Scales and weights that saturate every unit, and overflow where the signal is at its ends.
fn huge() -> Blob {
    let mut blob = with(effects(&EFFECTS[..4]));
    blob.weights = Weights::from_array(&core::array::from_fn(|i| (i * 37 % 41) as f32 * 1e8 - 2e9));
    // Steps upward only: where the slope turns its sign, nothing is loaded.
    for (output, [by_x, _]) in blob.weights.output.iter_mut().zip(blob.weights.input) {
        *output = output.abs() * by_x.signum();
    }
    (blob.scaling.delta_f_gain_per_hz, blob.scaling.temperature_gain_per_c) = (1e18, 1e15);
    blob.scaling.line_g = [0.0, 1e-20, 1e-17, -1e-38];
    blob.scaling.output_g = 1e-10;
    proven(blob)
}

fn proven(mut blob: Blob) -> Blob {
    blob.proof = Network::new(&blob.weights).proof().unwrap_or(0);
    blob
}

fn effects(rows: &[Row]) -> Vec<Term, MAX_TERMS> {
    // Each on a channel of its own.
    let term = |(channel, (effect, parameters)): (u8, &Row)| term(*effect, channel, parameters, &[]);
    (0..).zip(rows).map(term).collect()
}

fn programs() -> Vec<Term, MAX_TERMS> {
    PROGRAMS.iter().map(|program| term(EXPRESSION, 0, &[1e-4, 35.0], program)).collect()
}

/// One effect with its coefficients.
#[must_use]
pub fn term(effect: u16, channel: u8, parameters: &[f32], program: &[u8]) -> Term {
    let program: Vec<u8, MAX_PROGRAM> = program.iter().copied().collect();
    Term { effect, channel, parameters: parameters.iter().copied().collect(), program }
}

fn channels<const N: usize>() -> Vec<heapless::String<N>, MAX_CHANNELS> {
    let names = ["supply_v", "cross_g", "vibration_g2", "pressure_pa", "humidity_pct", "a", "b", "c"];
    names.iter().filter_map(|name| (*name).try_into().ok()).collect()
}

#[cfg(test)]
mod tests {
    extern crate std;

    use super::*;
    use firmware_core::Compensator;
    use firmware_core::effect::{ALL as REGISTRY, About};
    use firmware_core::program::{Program, Step};

    #[test]
    fn every_effect_that_runs_on_a_device_is_among_them() {
        let used: Vec<u16, 64> =
            ALL.iter().flat_map(|(_, blob)| blob().terms.into_iter().map(|term| term.effect)).collect();
        let missing: std::vec::Vec<&str> = REGISTRY
            .iter()
            .filter(|about| about.is_on_device() && !used.contains(&about.id))
            .map(|about: &&About| about.name)
            .collect();
        assert!(missing.is_empty(), "give {missing:?} a row in EFFECTS");
    }

    #[test]
    fn every_step_of_a_program_is_among_them() {
        let mut used = [false; 256];
        for program in PROGRAMS {
            Program::new(program).expect("it is sound");
            let mut rest = program;
            while let Some((step, next)) = Step::next(rest) {
                used[usize::from(step.byte())] = true;
                rest = next;
            }
        }
        used[0] = true;
        let missing = (0..=u8::MAX).find(|byte| Step::next(&[*byte]).is_some() && !used[usize::from(*byte)]);
        assert_eq!(missing, None);
    }

    #[test]
    fn every_calibration_is_accepted() {
        for (name, blob) in ALL {
            assert!(Compensator::load(&blob()).is_ok(), "{name}");
        }
    }
}
