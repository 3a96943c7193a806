//! The answer in a sentence.

use crate::compare::Comparison;
use serde::Serialize;

/// How good the model is.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Verdict {
    /// For a reader who reads nothing else.
    pub sentence: String,
    /// Residual of a straight line through the frequency difference, µg RMS.
    pub raw_ug: f64,
    /// Residual of the model, µg RMS.
    pub residual_ug: f64,
    /// Whether something speaks against using the model as it is.
    pub sound: bool,
}

/// A residual above this many times the noise is not noise alone.
const NOISE_ALONE: f64 = 1.2;
/// A slope further off than this is no scale factor, ppm.
const SLOPE_WORST_PPM: f64 = 1000.0;

/// The verdict on a comparison.
#[must_use]
pub fn verdict(comparison: &Comparison, raw_ug: f64) -> Verdict {
    let residual_ug = comparison.residual_ug;
    let slope_wrong = comparison.sensitivity_ppm.is_some_and(|slope| slope.worst > SLOPE_WORST_PPM);
    let sound = residual_ug < raw_ug && !slope_wrong;
    let seen = if comparison.held_out {
        "On runs that the training never saw"
    } else {
        "On the runs that the training saw (none was held out, so this says little about others)"
    };
    let change = if residual_ug < raw_ug {
        let factor = raw_ug / residual_ug;
        let times = if factor < 20.0 { format!("{factor:.1}") } else { format!("{factor:.0}") };
        format!(
            "{residual_ug:.1} µg RMS from the reference, {times} times less than the raw frequency ({raw_ug:.0} µg)"
        )
    } else {
        format!("{residual_ug:.1} µg RMS from the reference, no less than the raw frequency ({raw_ug:.1} µg)")
    };
    let rest = match comparison.noise_floor_ug {
        Some(noise_ug) if residual_ug <= NOISE_ALONE * noise_ug => {
            format!("; that is the noise from sample to sample ({noise_ug:.1} µg)")
        }
        Some(noise_ug) => {
            format!("; {:.1} times the noise from sample to sample ({noise_ug:.1} µg)", residual_ug / noise_ug)
        }
        None => String::new(),
    };
    let slope =
        if slope_wrong { " Between the recorded levels it does not measure acceleration: do not use it." } else { "" };
    Verdict {
        sentence: format!("{seen}, the compensated reading deviates by {change}{rest}.{slope}"),
        raw_ug,
        residual_ug,
        sound,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sensitivity::Sensitivity;

    fn comparison(residual_ug: f64, held_out: bool, worst: f64) -> Comparison {
        Comparison {
            residual_ug,
            noise_floor_ug: Some(5.0),
            held_out,
            sensitivity_ppm: Some(Sensitivity { rms: worst / 2.0, worst }),
            warnings: Vec::new(),
            runs: Vec::new(),
            figures: Vec::new(),
        }
    }

    #[test]
    fn the_sentence_says_how_much_better_and_how_far_from_the_noise() {
        let verdict = verdict(&comparison(8.0, true, 30.0), 25_000.0);
        assert!(verdict.sound);
        for part in ["never saw", "8.0 µg RMS", "3125 times less", "1.6 times the noise"] {
            assert!(verdict.sentence.contains(part), "{part}: {}", verdict.sentence);
        }
    }

    #[test]
    fn it_warns_of_a_model_that_is_no_better_or_no_accelerometer_or_only_knows_its_training() {
        assert!(!verdict(&comparison(30.0, true, 30.0), 20.0).sound);
        let classifier = verdict(&comparison(5.1, true, 90_000.0), 25_000.0);
        assert!(!classifier.sound && classifier.sentence.contains("do not use it"), "{}", classifier.sentence);
        let unchecked = verdict(&comparison(5.1, false, 30.0), 25_000.0).sentence;
        assert!(unchecked.contains("none was held out") && unchecked.contains("that is the noise"), "{unchecked}");
    }
}
