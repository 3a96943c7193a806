//! Blinding: a scenario in which something is hidden that only an envelope names.
//!
//! Apart from the scenario because it simulates: an effect's size is chosen by what it does to this very campaign.

use std::ops::ControlFlow;

use crate::scenario::Scenario;
use crate::seal::{HiddenEffect, SealedTruth};
use crate::simulation::{SimulateError, simulate};
use crate::twin::effect::Effects;
use crate::twin::random::Random;
use crate::twin::{Noise, StaticMap};

/// What may be hidden.
#[derive(Clone, Debug, PartialEq)]
pub struct BlindOptions {
    /// Names of the effects to choose from.
    pub candidates: Vec<String>,
    /// The fewest effects to hide; 0 makes "nothing is missing" a possible answer.
    pub at_least: usize,
    /// The most effects to hide.
    pub at_most: usize,
    /// The weakest influence, in units of the noise.
    pub weakest: f64,
    /// The strongest influence, in units of the noise.
    pub strongest: f64,
}

impl Default for BlindOptions {
    /// One or two effects out of the catalogue, half to thirty times the noise.
    fn default() -> Self {
        Self { candidates: names(|name| !outside(name)), at_least: 1, at_most: 2, weakest: 0.5, strongest: 30.0 }
    }
}

impl BlindOptions {
    /// Effects of which no catalogue entry exists, so that the honest answer is that something unknown is missing.
    #[must_use]
    pub fn outside_the_catalogue() -> Self {
        Self { candidates: names(outside), at_most: 1, ..Self::default() }
    }
}

fn names(keep: impl Fn(&str) -> bool) -> Vec<String> {
    Effects::NAMES.iter().filter(|name| keep(name)).map(ToString::to_string).collect()
}

fn outside(name: &str) -> bool {
    name.starts_with("x-")
}

/// Why nothing could be hidden.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum BlindError {
    /// A candidate that does not exist.
    #[error("there is no effect `{name}` to hide; the effects are {}", Effects::NAMES.join(", "))]
    NoSuchEffect {
        /// The name.
        name: String,
    },
    /// Too few candidates are excited by the scenario.
    #[error(
        "only {found} of the candidates show in this scenario with a size in the range, {wanted} were asked for; \
         add runs that excite them, or ask for fewer"
    )]
    TooFew {
        /// Effects that could be hidden.
        found: usize,
        /// Effects that were asked for.
        wanted: usize,
    },
    /// The scenario cannot be simulated.
    #[error(transparent)]
    Simulate(#[from] SimulateError),
}

/// How close the chosen size must come to the wanted one.
const SIZE_TOLERANCE: f64 = 0.05;
/// How often the size is corrected; a linear effect needs one correction.
const CORRECTIONS: usize = 6;

/// Hides effects in the scenario: which ones, how many, how strong and with what time constants, `seed` decides.
///
/// The blinded scenario is to be simulated and then forgotten; the truth is for [`crate::seal::seal`].
///
/// # Errors
/// If a candidate does not exist, or the scenario does not excite enough of them.
pub fn blinded(scenario: &Scenario, seed: u64, options: &BlindOptions) -> Result<(Scenario, SealedTruth), BlindError> {
    if let Some(name) = options.candidates.iter().find(|name| !Effects::NAMES.contains(&name.as_str())) {
        return Err(BlindError::NoSuchEffect { name: name.clone() });
    }
    let mut random = Random::stream(seed, "blind", 0);
    let noise_floor_ug = simulate(scenario, seed, &mut go_on)?.noise_floor_ug();
    let wanted = options.at_least + random.below(options.at_most.saturating_sub(options.at_least) + 1);
    let active = scenario.effects.active();
    let mut candidates: Vec<&String> =
        options.candidates.iter().filter(|name| !active.contains(&name.as_str())).collect();
    random.shuffle(&mut candidates);

    let mut blinded =
        Scenario { name: format!("{}-blind", scenario.name), description: String::new(), ..scenario.clone() };
    let mut hidden = Vec::new();
    for name in candidates {
        if hidden.len() == wanted {
            break;
        }
        let times_noise = random.log_between(options.weakest, options.strongest);
        if let Some((factor, influence_ug)) = sized(scenario, name, times_noise * noise_floor_ug, seed)? {
            blinded.effects.switch_on_varied(name, factor, seed);
            let times_noise = influence_ug / noise_floor_ug;
            hidden.push(HiddenEffect { name: name.clone(), influence_ug, times_noise });
        }
    }
    if hidden.len() < wanted {
        return Err(BlindError::TooFew { found: hidden.len(), wanted });
    }
    hidden.sort_by(|a, b| b.influence_ug.total_cmp(&a.influence_ug));
    let truth = SealedTruth { blind_seed: seed, noise_floor_ug, hidden, scenario: blinded.clone() };
    Ok((blinded, truth))
}

/// Scatter that one effect alone, its default times `factor`, leaves behind a perfect static compensation of this
/// campaign, µg. Its mean over the campaign does not count, as any calibration takes it up.
///
/// # Errors
/// If the scenario cannot be simulated.
pub fn influence_ug(scenario: &Scenario, effect: &str, factor: f64, seed: u64) -> Result<f64, SimulateError> {
    let mut alone = Scenario {
        noise: Noise::off(),
        rig: scenario.rig.without_errors(),
        effects: Effects::default(),
        ..scenario.clone()
    };
    alone.effects.switch_on_varied(effect, factor, seed);
    let map = StaticMap::new(&alone.device);
    let recording = simulate(&alone, seed, &mut go_on)?;
    let (mut count, mut sum, mut squares) = (0.0, 0.0, 0.0);
    for row in recording.runs.iter().flat_map(|run| &run.rows) {
        let off_ug = (map.acceleration_g(row.delta_f_hz, row.temperature_c) - row.reference_g) * 1e6;
        (count, sum, squares) = (count + 1.0, sum + off_ug, squares + off_ug * off_ug);
    }
    Ok((squares / count - (sum / count).powi(2)).max(0.0).sqrt())
}

/// The factor that gives an effect the wanted influence, and the influence reached; `None` if it cannot.
fn sized(scenario: &Scenario, effect: &str, wanted_ug: f64, seed: u64) -> Result<Option<(f64, f64)>, SimulateError> {
    let mut factor = 1.0;
    for _ in 0..CORRECTIONS {
        let reached_ug = influence_ug(scenario, effect, factor, seed)?;
        if (reached_ug / wanted_ug - 1.0).abs() < SIZE_TOLERANCE {
            return Ok(Some((factor, reached_ug)));
        }
        if reached_ug < NOT_EXCITED_UG {
            return Ok(None);
        }
        factor *= wanted_ug / reached_ug;
    }
    Ok(None)
}

/// Below the microhertz of the table an effect is not there.
const NOT_EXCITED_UG: f64 = 0.03;

fn go_on(_: f64) -> ControlFlow<()> {
    ControlFlow::Continue(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_rich_scenario_excites_every_effect() {
        let scenario = Scenario::preset("rich").unwrap();
        for name in Effects::NAMES {
            let influence_ug = influence_ug(&scenario, name, 1.0, 1).unwrap();
            assert!(influence_ug > NOT_EXCITED_UG, "{name}: {influence_ug} µg");
        }
    }

    #[test]
    fn what_is_hidden_is_as_strong_as_it_says_and_the_name_does_not_tell() {
        let scenario = Scenario::preset("clean").unwrap();
        for seed in 0..8 {
            let (blinded, truth) = blinded(&scenario, seed, &BlindOptions::default()).unwrap();
            assert_eq!((blinded.name.as_str(), blinded.description.as_str()), ("clean-blind", ""));
            assert!((1..=2).contains(&truth.hidden.len()), "seed {seed}");
            assert_eq!(blinded.effects.active().len(), truth.hidden.len());
            for hidden in &truth.hidden {
                // The range, and the tolerance of the size.
                assert!((0.47..=31.6).contains(&hidden.times_noise), "seed {seed}: {hidden:?}");
            }
        }
    }

    #[test]
    fn the_same_seed_hides_the_same_and_seeds_differ() {
        let scenario = Scenario::preset("clean").unwrap();
        let hide = |seed| blinded(&scenario, seed, &BlindOptions::default()).unwrap().1;
        assert_eq!(hide(3), hide(3));
        assert_ne!(hide(3).hidden, hide(4).hidden);
    }

    #[test]
    fn what_the_scenario_does_not_excite_is_not_hidden_in_it() {
        let scenario = Scenario::preset("clean").unwrap();
        let only = |name: &str| BlindOptions { candidates: vec![name.into()], at_most: 1, ..BlindOptions::default() };
        let error = blinded(&scenario, 1, &only("vibration-rectification")).unwrap_err();
        assert_eq!(error, BlindError::TooFew { found: 0, wanted: 1 });
        assert!(matches!(blinded(&scenario, 1, &only("gravity")), Err(BlindError::NoSuchEffect { .. })));
    }

    #[test]
    fn outside_the_catalogue_only_unknown_effects_are_hidden() {
        let scenario = Scenario::preset("clean").unwrap();
        let (_, truth) = blinded(&scenario, 5, &BlindOptions::outside_the_catalogue()).unwrap();
        assert!(truth.hidden.iter().all(|hidden| hidden.name.starts_with("x-")));
    }
}
