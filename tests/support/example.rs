//! One calibration that uses every kind of memory, and samples that visit every corner.
//!
//! All numbers come from integers, so the example has the same bits on every machine.

use firmware_core::Network;
use protocol::limits::{MAX_BLOB, MAX_CHANNELS};
use protocol::{Blob, Domain, Sample, Scaling, Status, Term, Timing, Weights};

/// Serial number of the sensor that the example belongs to.
pub const SERIAL: &str = "EXAMPLE-1";

/// The example calibration.
#[must_use]
pub fn blob() -> Blob {
    let weights = Weights::from_array(&core::array::from_fn(|i| (i * 37 % 41) as f32 / 16.0 - 1.25));
    Blob {
        serial: SERIAL.try_into().expect("a short name"),
        provenance: *b"exampl-1",
        proof: proof(&weights),
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
        channels: [name("supply_v")].into_iter().collect(),
        terms: [
            term(1, &[35.0]),
            term(2, &[0.012, 5.0]),
            term(3, &[-0.004, 600.0]),
            term(4, &[0.000_02, 10.0]),
            term(5, &[0.000_3]),
            term(6, &[0.000_8, 5.0]),
        ]
        .into_iter()
        .collect(),
    }
}

/// The example with an effect of the user's own, whose program has every step that there is.
#[must_use]
pub fn with_expression() -> Blob {
    // e^(−power_on_s/600) · √|supply_v − level_g| + temperature_rate² + departure + temperature_c/delta_f_hz · age_days
    const PROGRAM: [u8; 26] = [
        0x06, 0x00, 0x00, 0x00, 0x16, 0x44, 0x13, 0x20, 0x24, 0x80, 0x05, 0x11, 0x21, 0x23, 0x12, 0x03, 0x22, 0x02,
        0x10, 0x10, 0x01, 0x04, 0x13, 0x07, 0x12, 0x10,
    ];
    let mut blob = blob();
    let program = PROGRAM.iter().copied().collect();
    blob.terms.push(Term { program, ..term(22, &[0.000_1, 35.0]) }).expect("room for one more");
    blob
}

/// The example as it is stored.
#[must_use]
pub fn blob_bytes() -> Vec<u8> {
    stored(&blob())
}

/// Any calibration as it is stored.
#[must_use]
pub fn stored(blob: &Blob) -> Vec<u8> {
    let mut buffer = [0; MAX_BLOB];
    blob.to_bytes(&mut buffer).expect("the example fits").to_vec()
}

/// What the blob of a network must carry as proof.
#[must_use]
pub fn proof(weights: &Weights) -> u32 {
    Network::new(weights).proof().expect("finite outputs")
}

/// One effect on channel 0.
#[must_use]
pub fn term(effect: u16, parameters: &[f32]) -> Term {
    Term { effect, channel: 0, parameters: parameters.iter().copied().collect(), program: heapless::Vec::new() }
}

fn name<const N: usize>(name: &str) -> heapless::String<N> {
    name.try_into().expect("a short name")
}

/// `count` samples of a slow temperature programme, with every special sample among them.
#[must_use]
pub fn samples(count: usize) -> Vec<Sample> {
    let ordinary = (0..count as u64).map(ordinary);
    let specials = specials();
    // Each special one follows a few ordinary ones, so that it meets memories that hold something.
    let mut samples: Vec<Sample> = ordinary.collect();
    let stride = (count / specials.len()).max(1);
    for (slot, special) in samples.iter_mut().skip(stride / 2).step_by(stride).zip(specials) {
        *slot = special;
    }
    samples
}

/// One second after the other, up and down the temperature range, at scattered accelerations.
fn ordinary(second: u64) -> Sample {
    let scatter = second.wrapping_mul(0x9E37_79B9_7F4A_7C15) >> 40;
    let phase = (second * 331_000 % 240_000_000) as i32;
    let temperature_uc = if phase < 120_000_000 { phase - 38_000_000 } else { 202_000_000 - phase };
    let delta_f_uhz = (scatter * 9) as i64 - 2_000_000;
    let mut sample = Sample::from_difference(second * 1_000_000, delta_f_uhz, temperature_uc);
    sample.sum_f_uhz = (!second.is_multiple_of(3)).then_some(82_400_000_000);
    sample.age_s = second.is_multiple_of(2).then_some(31_000_000 + second as u32);
    sample.channels = [0; MAX_CHANNELS];
    sample.channels[0] = 5_000_000 + (scatter % 100_000) as i64;
    sample
}

/// Samples at the ends of every field, of impossible times, and with every flag raised.
#[must_use]
pub fn specials() -> Vec<Sample> {
    let base = ordinary(500);
    let mut specials = Vec::new();
    for delta_f_uhz in [i64::MIN, i64::MIN + 1, -1, 0, 1, i64::MAX] {
        specials.push(Sample { delta_f_uhz, ..base });
    }
    for temperature_uc in [i32::MIN, -40_000_001, -40_000_000, 0, 85_000_000, 85_000_001, i32::MAX] {
        specials.push(Sample { temperature_uc, ..base });
    }
    for time_us in [0, 1, 499_999_999, 500_000_000, 500_000_001, 530_000_000, u64::MAX - 1, u64::MAX] {
        specials.push(Sample { time_us, ..base });
    }
    for power_on_us in [0, 1, i64::MAX as u64, u64::MAX] {
        specials.push(Sample { power_on_us, ..base });
    }
    for channel in [i64::MIN, 0, i64::MAX] {
        specials.push(Sample { channels: [channel; 8], ..base });
    }
    for (sum_f_uhz, age_s) in [(None, None), (Some(0), Some(0)), (Some(u64::MAX), Some(u32::MAX))] {
        specials.push(Sample { sum_f_uhz, age_s, ..base });
    }
    for bit in 0..16 {
        specials.push(Sample { faults: Status::from_bits_retain(1 << bit), ..base });
    }
    specials
}
