//! The floats that a network alone is tried with: every kind that there is.

use crate::samples::Scatter;

/// Zeros, subnormals, ends of the range, and the neighbourhood of the activation's seam.
const SPECIAL: [f32; 18] = [
    0.0,
    -0.0,
    f32::from_bits(1),
    f32::from_bits(0x8000_0001),
    f32::from_bits(0x007F_FFFF),
    f32::MIN_POSITIVE,
    -f32::MIN_POSITIVE,
    1.0,
    -1.0,
    1.0 - f32::EPSILON / 2.0,
    3.0,
    -3.0,
    f32::from_bits(0x403F_FFFF),
    f32::from_bits(0x4040_0001),
    1e19,
    -1e19,
    f32::MAX,
    f32::MIN,
];

/// An endless stream of finite pairs: all pairs of special values, then half any bits, half between −4 and 4.
#[derive(Clone, Debug, Default)]
pub struct Numbers {
    count: usize,
    scatter: Scatter,
}

impl Iterator for Numbers {
    type Item = [f32; 2];

    fn next(&mut self) -> Option<[f32; 2]> {
        let count = self.count;
        self.count += 1;
        let special = |at: usize| SPECIAL.get(at).copied();
        if let (Some(x), Some(t)) = (special(count / SPECIAL.len()), special(count % SPECIAL.len())) {
            return Some([x, t]);
        }
        let [x, t] = self.scatter.pair();
        Some(if count.is_multiple_of(2) { [any(x), any(t)] } else { [moderate(x), moderate(t)] })
    }
}

/// A finite float of any size, every bit pattern as likely.
const fn any(bits: u32) -> f32 {
    const EXPONENT: u32 = 0x7F80_0000;
    const HALF_OF_IT: u32 = 0x4000_0000;
    f32::from_bits(if bits & EXPONENT == EXPONENT { bits ^ HALF_OF_IT } else { bits })
}

fn moderate(bits: u32) -> f32 {
    (bits >> 8) as f32 * (1.0 / (1 << 21) as f32) - 4.0
}
