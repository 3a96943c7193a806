//! The 2-10-1 network (Huang et al. 2022, eq. 2).

use crate::activation::{sigmoid, slope};
use crate::real::Real;
use protocol::limits::HIDDEN;
use protocol::{Weights, crc32};

/// y = b + Σᵢ vᵢ σ(bᵢ + wᵢ₁ x + wᵢ₂ t), summed in the order of the units.
///
/// The paper's eq. (2) writes the threshold inside the sum over the inputs; that would add it twice.
#[derive(Clone, Copy, Debug)]
pub struct Network<R> {
    units: [Unit<R>; HIDDEN],
    bias: R,
}

#[derive(Clone, Copy, Debug)]
struct Unit<R> {
    x: R,
    t: R,
    bias: R,
    output: R,
}

impl<R: Real> Network<R> {
    /// The network of these weights.
    #[must_use]
    pub fn new(weights: &Weights) -> Self {
        let mut units = [Unit { x: R::ZERO, t: R::ZERO, bias: R::ZERO, output: R::ZERO }; HIDDEN];
        let rows = weights.input.iter().zip(&weights.bias).zip(&weights.output);
        for (unit, (([x, t], bias), output)) in units.iter_mut().zip(rows) {
            *unit =
                Unit { x: R::from_f32(*x), t: R::from_f32(*t), bias: R::from_f32(*bias), output: R::from_f32(*output) };
        }
        Self { units, bias: R::from_f32(weights.output_bias) }
    }

    /// The output at the scaled inputs `x` (frequency difference) and `t` (temperature).
    #[must_use]
    pub fn evaluate(&self, x: R, t: R) -> R {
        let mut sum = self.bias;
        for unit in &self.units {
            sum += unit.output * sigmoid(unit.bias + unit.x * x + unit.t * t);
        }
        sum
    }

    /// The output's derivatives by `x` and by `t`.
    #[must_use]
    pub fn gradient(&self, x: R, t: R) -> [R; 2] {
        let mut sum = [R::ZERO; 2];
        for unit in &self.units {
            let rise = unit.output * slope(unit.bias + unit.x * x + unit.t * t);
            sum[0] += rise * unit.x;
            sum[1] += rise * unit.t;
        }
        sum
    }

    /// Bounds of the output's derivative by `x` while the inputs stay within `x` and `t` (each lowest, highest).
    ///
    /// Interval arithmetic, unit by unit: the derivative is never outside, and the closer the ends, the tighter it is.
    #[must_use]
    pub fn slope_within(&self, x: [R; 2], t: [R; 2]) -> [R; 2] {
        let mut sum = [R::ZERO; 2];
        for unit in &self.units {
            let (by_x, by_t) = (ordered(x.map(|x| unit.x * x)), ordered(t.map(|t| unit.t * t)));
            let [low, high] = [unit.bias + by_x[0] + by_t[0], unit.bias + by_x[1] + by_t[1]];
            // The sigmoid is the steeper, the nearer its argument is to zero.
            let nearest = R::ZERO.between(low, high);
            let farthest = if -low > high { low } else { high };
            let rise = unit.output * unit.x;
            let [least, most] = ordered([rise * slope(nearest), rise * slope(farthest)]);
            sum[0] += least;
            sum[1] += most;
        }
        sum
    }
}

/// The smaller one first.
pub(crate) fn ordered<R: Real>([a, b]: [R; 2]) -> [R; 2] {
    if b < a { [b, a] } else { [a, b] }
}

impl Network<f32> {
    /// CRC-32 of the output's bits on a fixed 8 × 8 grid of inputs within ±1.75.
    ///
    /// The blob carries it. A processor with another rounding mode, flushed subnormals or a faulty
    /// build gets another number and refuses the calibration instead of giving other readings.
    /// `None` if an output is not finite.
    #[must_use]
    pub fn proof(&self) -> Option<u32> {
        let mut outputs = [[0_u8; 4]; 64];
        let mut grid = outputs.iter_mut();
        for i in 0..8_i8 {
            for j in 0..8_i8 {
                let (x, t) = (f32::from(i) * 0.5 - 1.75, f32::from(j) * 0.5 - 1.75);
                let y = self.evaluate(x, t);
                if !y.is_finite() {
                    return None;
                }
                if let Some(slot) = grid.next() {
                    *slot = y.to_bits().to_le_bytes();
                }
            }
        }
        Some(crc32(outputs.as_flattened()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn example() -> Weights {
        Weights::from_array(&core::array::from_fn(|i| libm::sinf((i as f32 + 1.0) * 1.7) * 0.8))
    }

    #[test]
    fn the_output_is_equation_2_written_out_by_hand() {
        let w = example();
        let (x, t) = (0.3_f64, -0.6_f64);
        let by_hand: f64 = (0..HIDDEN)
            .map(|i| {
                let u = f64::from(w.bias[i]) + f64::from(w.input[i][0]) * x + f64::from(w.input[i][1]) * t;
                let sigma = u * (27.0 + u * u) / (27.0 + 9.0 * u * u);
                f64::from(w.output[i]) * sigma
            })
            .sum::<f64>()
            + f64::from(w.output_bias);
        assert!((Network::<f64>::new(&w).evaluate(x, t) - by_hand).abs() < 1e-14);
    }

    #[test]
    fn the_gradient_is_the_numeric_one() {
        let network = Network::<f64>::new(&example());
        let (x, t, h) = (-0.2, 0.9, 1e-6);
        let [gx, gt] = network.gradient(x, t);
        assert!(((network.evaluate(x + h, t) - network.evaluate(x - h, t)) / (2.0 * h) - gx).abs() < 1e-9);
        assert!(((network.evaluate(x, t + h) - network.evaluate(x, t - h)) / (2.0 * h) - gt).abs() < 1e-9);
    }

    #[test]
    fn the_slope_is_never_outside_its_bounds_and_they_close_in_on_it() {
        let network = Network::<f64>::new(&example());
        let corners = |k: i32| (f64::from(k % 7) * 0.3 - 1.0, f64::from(k / 7) * 0.25 - 0.9);
        for (k, width) in (0..49).flat_map(|k| [1.0, 0.1, 1e-7].map(|width| (k, width))) {
            let (x, t) = corners(k);
            let [least, most] = network.slope_within([x, x + width], [t, t + width]);
            for (i, j) in (0..=4).flat_map(|i| (0..=4).map(move |j| (i, j))) {
                let [by_x, _] = network.gradient(x + width * f64::from(i) / 4.0, t + width * f64::from(j) / 4.0);
                assert!((least - 1e-12..=most + 1e-12).contains(&by_x), "{by_x} is outside {least} to {most}");
            }
            assert!(most - least < 20.0 * width, "{least} to {most} within {width}");
        }
    }

    #[test]
    fn the_proof_notices_one_bit_of_one_weight() {
        let proof = Network::new(&example()).proof();
        for i in 0..41 {
            let mut row = example().to_array();
            row[i] = f32::from_bits(row[i].to_bits() ^ (1 << 12));
            assert_ne!(Network::new(&Weights::from_array(&row)).proof(), proof, "weight {i}");
        }
    }
}
