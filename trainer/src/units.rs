//! Units of acceleration, and how an effect's coefficients follow the unit of the reference.

use firmware_core::effect::About;

/// References that span less than this share of what the reading does are one and the same.
pub(crate) const STILL: f64 = 0.01;
/// What the reading of a sensor at rest is scaled to do, g: as such sensors do over temperature.
pub(crate) const DRIFT_G: f64 = 0.01;
/// A half span between these is left as it is, g.
pub(crate) const ORDINARY_G: std::ops::RangeInclusive<f64> = 0.5..=2.0;

/// How many of a unit are 1 g; none of what is no acceleration, or of an unknown name.
pub(crate) fn units_per_g(unit: &str) -> Option<f64> {
    const METRES_PER_S2: f64 = 9.806_65;
    Some(match unit {
        "g" | "g0" | "gn" => 1.0,
        "mg" => 1e3,
        "µg" | "μg" | "ug" => 1e6,
        "ng" => 1e9,
        "m/s2" | "m/s^2" | "m/s²" => METRES_PER_S2,
        "mm/s2" | "mm/s^2" | "mm/s²" => 1e3 * METRES_PER_S2,
        "Gal" | "gal" | "cm/s2" | "cm/s^2" | "cm/s²" => 1e2 * METRES_PER_S2,
        "mGal" | "mgal" => 1e5 * METRES_PER_S2,
        _ => return None,
    })
}

/// With which power of a factor on the reference a coefficient of this name is multiplied, so that the effect does the
/// same: what adds to the reading follows the reference, what is multiplied with powers of the level follows the rest.
pub(crate) fn exponent(about: &About, name: &str) -> i32 {
    let parameter = about.parameters.iter().find(|parameter| parameter.name == name);
    parameter.map_or(0, |parameter| parameter.follows_reference)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::campaign::Row;
    use crate::fit::effects::{Chosen, Coefficients, contributions};
    use firmware_core::effect::{ALL, Parameter, Role};
    use protocol::Sample;

    /// A course in which every effect does something; the reference in units of 1/`factor`.
    fn rows(factor: f64) -> Vec<Row> {
        let row = |k: i32| {
            let mut sample =
                Sample::from_difference(k as u64 * 7_000_000, 300_000 * i64::from(k), 20_000_000 + k * k * 9_000);
            sample.channels[0] = 1_000_000 + 30_000 * i64::from(k);
            sample.age_s = Some(86_400 * k as u32);
            Row { sample, reference_g: f64::from(k % 7 - 3) / 3.0 * factor, reference_sigma_g: None }
        };
        (0..40).map(row).collect()
    }

    #[test]
    fn every_effect_does_the_same_whatever_the_unit_of_the_reference() {
        for about in ALL.iter().filter(|about| about.is_on_device() && !about.takes_program()) {
            let value = |parameter: &Parameter| match parameter.role {
                Role::Amplitude => parameter.high * 0.3,
                _ => parameter.start,
            };
            let values: Vec<f64> = about.parameters.iter().map(value).collect();
            for factor in [1e3, -0.04] {
                let scaled =
                    |(about_p, value): (&Parameter, &f64)| value * f64::powi(factor, exponent(about, about_p.name));
                let other: Vec<f64> = about.parameters.iter().zip(&values).map(scaled).collect();
                let course = |values: Vec<f64>, factor| {
                    let coefficients = Coefficients { values: vec![values] };
                    contributions(&rows(factor), &[Chosen::of(about)], &coefficients, u32::MAX)
                        .expect("it can be computed")
                };
                let (here, there) = (course(values.clone(), 1.0), course(other, factor));
                assert!(
                    here.iter().any(|contribution| contribution.bias_g != 0.0 || !contribution.moves_nothing()),
                    "{} does nothing",
                    about.name
                );
                for (here, there) in here.iter().zip(&there) {
                    assert!((there.bias_g / factor - here.bias_g).abs() <= 1e-9 * here.bias_g.abs(), "{}", about.name);
                    assert!(
                        (there.delta_f_hz - here.delta_f_hz).abs() <= 1e-9 * here.delta_f_hz.abs(),
                        "{}",
                        about.name
                    );
                    assert!((there.temperature_c - here.temperature_c).abs() <= 1e-9, "{}", about.name);
                }
            }
            // Signs of references are turned in training.
            for parameter in about.parameters.iter().filter(|parameter| exponent(about, parameter.name) % 2 != 0) {
                assert!(parameter.low == -parameter.high, "{} {}", about.name, parameter.name);
            }
        }
    }
}
