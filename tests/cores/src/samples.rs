//! An endless stream of samples, from integers alone, so that every machine makes the same one.

use protocol::limits::MAX_CHANNELS;
use protocol::{Sample, Status};

/// Numbers that look random and are the same everywhere (SplitMix64).
#[derive(Clone, Debug, Default)]
pub(crate) struct Scatter(u64);

impl Scatter {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mixed = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        let mixed = (mixed ^ (mixed >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        mixed ^ (mixed >> 31)
    }

    pub(crate) fn pair(&mut self) -> [u32; 2] {
        let bits = self.next();
        [bits as u32, (bits >> 32) as u32]
    }

    /// Between −`size` and `size`.
    fn around_zero(&mut self, size: u32) -> i32 {
        let [bits, _] = self.pair();
        (bits % (2 * size + 1)).wrapping_sub(size).cast_signed()
    }
}

/// A walk over temperatures, accelerations and channels, a second a step, with pauses, gaps, repetitions, steps
/// back in time, faults, channels and ages that nobody measured; one in sixteen has a field at the end of its range.
#[derive(Clone, Debug)]
pub struct Samples {
    scatter: Scatter,
    count: u32,
    present: Sample,
}

/// Where the walk begins, with all channels measured.
fn first() -> Sample {
    Sample { channels: [0; MAX_CHANNELS], ..Sample::from_difference(0, 76_000_000, 25_000_000) }
}

impl Default for Samples {
    fn default() -> Self {
        Self { scatter: Scatter::default(), count: 0, present: first() }
    }
}

impl Samples {
    /// The stream without its oddities: what an instrument sees every day.
    pub fn ordinary() -> impl Iterator<Item = Sample> {
        let mut samples = Self::default();
        core::iter::repeat_with(move || {
            samples.walk();
            samples.count = samples.count.wrapping_add(1);
            samples.present
        })
    }

    fn walk(&mut self) {
        let scatter = &mut self.scatter;
        let sample = &mut self.present;
        let passed_us = match self.count % 97 {
            13 => 0,
            41 => 6_000_000,
            61 => 30_000_000,
            _ => 1_000_000,
        };
        sample.time_us += passed_us;
        sample.power_on_us = sample.time_us % 5_000_000_000;
        let age = (self.count % 59 > 2).then_some(10_000_000_u32.wrapping_add(self.count.wrapping_mul(40_000)));
        sample.age_s = age;
        sample.temperature_uc = within(sample.temperature_uc + scatter.around_zero(800_000), -60_000_000, 110_000_000);
        // Half of the time it stands still.
        if self.count % 128 < 64 {
            let step_uhz = i64::from(scatter.around_zero(30_000_000));
            sample.delta_f_uhz = (sample.delta_f_uhz + step_uhz).clamp(-40_000_000, 190_000_000);
        }
        sample.sum_f_uhz = (!self.count.is_multiple_of(3)).then_some(82_400_000_000);
        for (index, channel) in (0..).zip(&mut sample.channels) {
            let last = if *channel == Sample::NOT_MEASURED { 5_000_000 * (index + 1) } else { *channel };
            *channel = (last + i64::from(scatter.around_zero(400_000))).clamp(-90_000_000, 90_000_000);
        }
    }

    /// The present sample with something unusual.
    fn oddity(&mut self) -> Sample {
        let [kind, which] = self.scatter.pair();
        let sample = self.present;
        let which = which as usize;
        match kind % 64 {
            0..16 => Sample { delta_f_uhz: pick(&[i64::MIN, i64::MIN + 1, -1, 0, 1, i64::MAX], which), ..sample },
            16..28 => {
                let ends = [i32::MIN, -40_000_001, -40_000_000, 0, 85_000_000, 85_000_001, i32::MAX];
                Sample { temperature_uc: pick(&ends, which), ..sample }
            }
            28..36 => Sample { power_on_us: pick(&[0, 1, i64::MAX.cast_unsigned(), u64::MAX], which), ..sample },
            36..44 => Sample { channels: [pick(&[Sample::NOT_MEASURED, 0, i64::MAX], which); MAX_CHANNELS], ..sample },
            44..48 => Sample { age_s: pick(&[None, Some(0), Some(u32::MAX)], which), ..sample },
            48..63 => Sample { faults: Status::from_bits_retain(1 << (which % 16)), ..sample },
            // Rare, because it costs the memories their past.
            _ => Sample { time_us: pick(&[0, sample.time_us.saturating_sub(2_000_000), u64::MAX], which), ..sample },
        }
    }
}

impl Iterator for Samples {
    type Item = Sample;

    fn next(&mut self) -> Option<Sample> {
        self.walk();
        self.count = self.count.wrapping_add(1);
        Some(if self.count.is_multiple_of(16) { self.oddity() } else { self.present })
    }
}

fn within(value: i32, low: i32, high: i32) -> i32 {
    value.clamp(low, high)
}

fn pick<T: Copy, const N: usize>(from: &[T; N], which: usize) -> T {
    from[which % N]
}
