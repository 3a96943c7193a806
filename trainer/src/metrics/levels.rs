//! Which references are one level, whatever their unit.

/// References closer than this part of what all of them span are one level.
const PART_OF_SPAN: f64 = 0.005;
/// So many times what a reference usually changes from row to row is still one level: a measured reference has noise.
const STEPS: f64 = 10.0;

/// How far apart references of one level may be: relative to what these span and to how they scatter, because a
/// reference may be in g, in newtons or in ppm. `references` are in the order of recording.
#[must_use]
pub fn level_width(references: &[f64]) -> f64 {
    let mut steps: Vec<f64> = references.windows(2).map(|pair| (pair[1] - pair[0]).abs()).collect();
    let middle = steps.len() / 2;
    let usual = if steps.is_empty() { 0.0 } else { *steps.select_nth_unstable_by(middle, f64::total_cmp).1 };
    (PART_OF_SPAN * span(references)).max(STEPS * usual)
}

/// From the lowest to the highest; zero of none.
#[must_use]
pub fn span(values: &[f64]) -> f64 {
    let (low, high) = values.iter().fold((f64::MAX, f64::MIN), |(low, high), &value| (low.min(value), high.max(value)));
    if low <= high { high - low } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_width_follows_the_unit_and_the_noise() {
        let table: Vec<f64> = (0..240).map(|k| f64::from(k / 10).to_radians().sin()).collect();
        let width = level_width(&table);
        assert!((width - 0.005 * span(&table)).abs() < 1e-12);
        for unit in [1e3, 1e-6, -1.0] {
            let scaled: Vec<f64> = table.iter().map(|level| level * unit).collect();
            assert!((level_width(&scaled) / width / unit.abs() - 1.0).abs() < 1e-12);
        }
        let at_rest: Vec<f64> = (0..100).map(|k| f64::from(k * 17 % 41) * 1e-6).collect();
        assert!(level_width(&at_rest) > span(&at_rest), "noise is no level");
        // Steps of 1 to 5: the usual one is 3.
        assert!((level_width(&[0.0, 5.0, 9.0, 12.0, 14.0, 15.0]) - 30.0).abs() < 1e-12);
        assert_eq!((level_width(&[1.0; 9]), level_width(&[]), span(&[])), (0.0, 0.0, 0.0));
    }
}
