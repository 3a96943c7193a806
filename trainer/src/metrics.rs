//! Figures of merit, each with its definition.

pub mod allan;
pub mod allan_model;
pub mod full_temperature;
pub mod input_axis;
pub mod levels;
pub mod stability;
pub mod states;
pub mod zero_bias;

/// Mean of the values; zero of none.
#[must_use]
pub fn mean(values: &[f64]) -> f64 {
    if values.is_empty() { 0.0 } else { values.iter().sum::<f64>() / values.len() as f64 }
}

/// Sample standard deviation (divisor n − 1); zero of fewer than two values.
#[must_use]
pub fn standard_deviation(values: &[f64]) -> f64 {
    if values.len() < 2 {
        return 0.0;
    }
    let mean = mean(values);
    let squares: f64 = values.iter().map(|value| (value - mean).powi(2)).sum();
    (squares / (values.len() - 1) as f64).sqrt()
}

/// Slope of the least-squares line through (x, y); zero where x does not vary.
#[must_use]
pub fn line_slope(points: &[(f64, f64)]) -> f64 {
    let xs: Vec<f64> = points.iter().map(|point| point.0).collect();
    let ys: Vec<f64> = points.iter().map(|point| point.1).collect();
    let (x_mean, y_mean) = (mean(&xs), mean(&ys));
    let spread: f64 = xs.iter().map(|x| (x - x_mean).powi(2)).sum();
    let product: f64 = points.iter().map(|(x, y)| (x - x_mean) * (y - y_mean)).sum();
    if spread > 0.0 { product / spread } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn two_values_deviate_by_half_their_distance_times_root_two_and_fewer_by_nothing() {
        assert!((standard_deviation(&[1.0, 3.0]) - std::f64::consts::SQRT_2).abs() < 1e-12);
        assert_eq!((standard_deviation(&[5.0]), standard_deviation(&[]), mean(&[])), (0.0, 0.0, 0.0));
    }

    #[test]
    fn a_slope_keeps_its_digits_far_from_zero_and_is_none_without_a_spread() {
        let line = |x_offset: f64, y_offset: f64| -> Vec<(f64, f64)> {
            (0..=100).map(f64::from).map(|k| (x_offset + k, y_offset + 3.0 * k)).collect()
        };
        for far in [2.0_f64.powi(46), -(2.0_f64.powi(46))] {
            assert!((line_slope(&line(far, 0.0)) - 3.0).abs() < 1e-9);
            assert!((line_slope(&line(0.0, 16.0 * far)) - 3.0).abs() < 1e-9);
        }
        assert_eq!((line_slope(&[(1.0, 2.0), (1.0, 3.0)]), line_slope(&[])), (0.0, 0.0));
    }
}
