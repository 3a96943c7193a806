//! What retraining could add to a static map: polynomials, and the network's derivatives by its weights.

use crate::diagnose::thresholds::{MAP_POWERS, MAP_TANGENTS};
use crate::fit::network::{HIDDEN_SIZE, OUTPUT_SIZE};
use firmware_core::activation::{sigmoid, slope};
use protocol::Weights;
use protocol::limits::HIDDEN;

/// Values of all functions at scaled inputs, in units of the network's output, each at its expected size: polynomials and
/// the network's derivatives.
pub fn of_retraining(weights: &Weights, x: f64, t: f64) -> Vec<f64> {
    let mut values = polynomials(x, t);
    values.extend(derivatives(weights, x, t).map(|value| value * MAP_TANGENTS));
    values
}

/// The same where the slope is stated, not learnt: retraining can change the course over temperature only.
pub fn of_course(t: f64) -> Vec<f64> {
    chebyshev(MAP_POWERS.1, t)
}

/// Derivatives of the reading by the network's weights, each at its expected size.
fn derivatives(weights: &Weights, x: f64, t: f64) -> impl Iterator<Item = f64> {
    (0..HIDDEN).flat_map(move |unit| {
        let [wx, wt] = weights.input[unit].map(f64::from);
        let u = f64::from(weights.bias[unit]) + wx * x + wt * t;
        let rise = slope(u) * f64::from(weights.output[unit]) * HIDDEN_SIZE;
        [sigmoid(u) * OUTPUT_SIZE, rise * x, rise * t, rise]
    })
}

/// Chebyshev polynomials of both inputs.
pub fn polynomials(x: f64, t: f64) -> Vec<f64> {
    let (most_x, most_t, most) = MAP_POWERS;
    let (in_x, in_t) = (chebyshev(most_x, x), chebyshev(most_t, t));
    let pairs = (0..=most_x).flat_map(|i| (0..=most_t.min(most - i)).map(move |j| (i, j)));
    pairs.map(|(i, j)| in_x[i] * in_t[j]).collect()
}

fn chebyshev(most: usize, x: f64) -> Vec<f64> {
    let mut values = vec![1.0, x];
    for n in 2..=most {
        values.push(2.0 * x * values[n - 1] - values[n - 2]);
    }
    values
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnose::example::model;
    use firmware_core::Network;

    #[test]
    fn the_polynomials_are_chebyshevs_up_to_their_powers() {
        let angles = [(0.3_f64, 2.0_f64), (1.1, 0.7), (2.9, 1.6)];
        for (a, b) in angles {
            let found = polynomials(a.cos(), b.cos());
            let (most_x, most_t, most) = MAP_POWERS;
            let pairs = (0..=most_x).flat_map(|i| (0..=most_t).map(move |j| (i, j))).filter(|(i, j)| i + j <= most);
            let worked: Vec<f64> = pairs.map(|(i, j)| (i as f64 * a).cos() * (j as f64 * b).cos()).collect();
            assert_eq!(found.len(), worked.len());
            assert!(found.iter().zip(worked).all(|(a, b)| (a - b).abs() < 1e-12));
        }
    }

    #[test]
    fn the_derivatives_are_the_networks_derivatives_by_its_weights() {
        let mut weights = model().weights();
        weights.output = [0.5; HIDDEN];
        weights.input[3] = [-0.75, 1.5];
        weights.bias[3] = -0.25;
        let (x, t) = (0.4, -0.6);
        let found: Vec<f64> = derivatives(&weights, x, t).collect();
        assert_eq!(found.len(), 4 * HIDDEN);
        // A step that f32 holds exactly.
        let step = 1.0 / 1024.0_f32;
        for unit in [0, 3] {
            for (part, size) in [(0, OUTPUT_SIZE), (1, HIDDEN_SIZE), (2, HIDDEN_SIZE), (3, HIDDEN_SIZE)] {
                let output = |step: f32| {
                    let mut moved = weights;
                    match part {
                        0 => moved.output[unit] += step,
                        3 => moved.bias[unit] += step,
                        input => moved.input[unit][input - 1] += step,
                    }
                    Network::<f64>::new(&moved).evaluate(x, t)
                };
                let worked = (output(step) - output(-step)) / (2.0 * f64::from(step)) * size;
                let tangent = found[4 * unit + part];
                assert!((tangent - worked).abs() < 1e-5 * size, "{unit} {part}: {tangent} {worked}");
            }
        }
    }
}
