//! One blind campaign: what is hidden, how much of it can be seen, and the table as a laboratory would hand it over.

use crate::options::{Class, Options, Protocol};
use crate::visible::{Visible, visible};
use firmware_sim::blind::{self, BlindError, BlindOptions};
use firmware_sim::recording::{Column, Recording};
use firmware_sim::scenario::Scenario;
use firmware_sim::seal::SealedTruth;
use firmware_sim::simulation;
use firmware_sim::twin::effect::Effects;
use firmware_sim::twin::random::Random;
use std::ops::ControlFlow;
use tempfile::TempDir;
use trainer::campaign::{Campaign, ReadOptions};

/// A campaign and its truth.
pub struct Case {
    pub class: Class,
    pub protocol: Protocol,
    pub index: usize,
    pub seed: u64,
    /// Whether rig and turn-on add their errors.
    pub rig: bool,
    pub hidden: Vec<Hidden>,
    /// All effects at work, with their parameters.
    pub effects: Effects,
    /// Standard deviation of the noise of one 1 Hz sample, µg.
    pub sample_ug: f64,
    /// All noise behind a perfect static compensation, µg.
    pub noise_floor_ug: f64,
    pub recording: Recording,
    pub campaign: Campaign,
}

/// A hidden effect.
pub struct Hidden {
    pub name: String,
    /// Its size as it was drawn, in units of the noise behind a perfect static compensation.
    pub times_noise: f64,
    pub visible: Visible,
}

/// The laboratory's errors in every second campaign; those of the scenario `realistic`.
const TURN_ON_UG: f64 = 150.0;
const TABLE_ARCSEC: f64 = 8.0;
const MOUNT_ARCSEC: f64 = 40.0;
const NODE_SCATTER_UG: f64 = 25.0;

impl Case {
    /// Measures campaign number `index` of a class. The error says why nothing could be hidden in it.
    pub fn measure(options: &Options, protocol: Protocol, class: Class, index: usize) -> Result<Self, String> {
        let (blind, round) = hiding(options, class, index);
        let rig = (index + round) % 2 == 1;
        let mut scenario = scenario(protocol, rig)?;
        scenario.run.iter_mut().for_each(|run| run.common.record_every_s /= options.denser);
        let (seed, blinded, truth) = blinded(&scenario, seed(options, protocol, class, index), &blind)?;
        let recording = simulated(&blinded, seed)?;
        let campaign = read(&recording)?;
        let hidden = hidden(&truth, seed)?;
        let sample_ug = sample_ug(&recording);
        let noise_floor_ug = truth.noise_floor_ug;
        let effects = truth.scenario.effects;
        Ok(Self { class, protocol, index, seed, rig, hidden, effects, sample_ug, noise_floor_ug, recording, campaign })
    }

    /// The part of a hidden effect that counts, in units of the noise of one sample.
    pub fn visible_sigma(&self, hidden: &Hidden) -> f64 {
        let Visible { static_ug, within_mountings_ug, .. } = hidden.visible;
        (if self.rig { within_mountings_ug } else { static_ug }) / self.sample_ug
    }
}

/// How often another seed is tried: an effect that isn't proportional to its parameter may miss the size asked for.
const ATTEMPTS: u64 = 3;

fn blinded(scenario: &Scenario, seed: u64, options: &BlindOptions) -> Result<(u64, Scenario, SealedTruth), String> {
    for seed in seed..seed + ATTEMPTS {
        match blind::blinded(scenario, seed, options) {
            Ok((blinded, truth)) => return Ok((seed, blinded, truth)),
            Err(BlindError::TooFew { .. }) => {}
            Err(error) => return Err(error.to_string()),
        }
    }
    Err(format!("{} not excited by this protocol", options.candidates.join(", ")))
}

/// What may be hidden in campaign number `index`, and how often the list of effects has been gone through before.
fn hiding(options: &Options, class: Class, index: usize) -> (BlindOptions, usize) {
    let catalogue = BlindOptions::default().candidates.into_iter().filter(|name| name != "turn-on").collect();
    let (candidates, count): (Vec<String>, usize) = match class {
        Class::None => (Vec::new(), 0),
        Class::Single => (catalogue, 1),
        Class::Pair => (catalogue, 2),
        Class::Outside => (BlindOptions::outside_the_catalogue().candidates, 1),
    };
    let blind = BlindOptions { candidates, at_least: count, at_most: count, ..BlindOptions::default() };
    if count != 1 {
        return (blind, 0);
    }
    let candidates = options.effect.clone().map_or(blind.candidates, |name| vec![name]);
    let (round, place) = (index / candidates.len(), index % candidates.len());
    (BlindOptions { candidates: vec![candidates[place].clone()], ..blind }, round)
}

fn seed(options: &Options, protocol: Protocol, class: Class, index: usize) -> u64 {
    let purpose = format!("blind benchmark {} {}", protocol.name(), class.name());
    // Short enough to type.
    Random::stream(options.seed, &purpose, index as u64).bits() % 1_000_000_000
}

/// The protocol alone: no effect but turn-on, no error but those of the rig.
fn scenario(protocol: Protocol, rig: bool) -> Result<Scenario, String> {
    let preset = Scenario::preset(protocol.name()).ok_or_else(|| format!("no scenario {}", protocol.name()))?;
    let mut scenario = Scenario { effects: Effects::default(), rig: preset.rig.without_errors(), ..preset };
    scenario.columns.retain(|column| *column != Column::ReferenceSigmaG);
    if rig {
        scenario.rig.table_arcsec = TABLE_ARCSEC;
        scenario.rig.mount_arcsec = MOUNT_ARCSEC;
        scenario.rig.node_scatter_ug = NODE_SCATTER_UG;
        scenario.effects.switch_on("turn-on", 1.0);
        if let Some(turn_on) = &mut scenario.effects.turn_on {
            turn_on.sigma_ug = TURN_ON_UG;
        }
        // A laboratory whose protocol records more than the frequency states its uncertainty too.
        if !scenario.columns.is_empty() {
            scenario.columns.push(Column::ReferenceSigmaG);
        }
    }
    Ok(scenario)
}

fn hidden(truth: &SealedTruth, seed: u64) -> Result<Vec<Hidden>, String> {
    let of = |hidden: &firmware_sim::seal::HiddenEffect| {
        let visible = visible(&truth.scenario, &hidden.name, seed)?;
        Ok(Hidden { name: hidden.name.clone(), times_noise: hidden.times_noise, visible })
    };
    truth.hidden.iter().map(of).collect()
}

pub fn simulated(scenario: &Scenario, seed: u64) -> Result<Recording, String> {
    simulation::simulate(scenario, seed, &mut |_| ControlFlow::Continue(())).map_err(|error| error.to_string())
}

/// Through a file, as a user's would come: rounding is part of the measurement.
pub fn read(recording: &Recording) -> Result<Campaign, String> {
    let folder = TempDir::new().map_err(|error| error.to_string())?;
    let path = folder.path().join("campaign.csv");
    let mut file = std::fs::File::create(&path).map_err(|error| error.to_string())?;
    recording.write_csv(&mut file).map_err(|error| error.to_string())?;
    Campaign::read(&[path], &ReadOptions::default()).map_err(|error| error.to_string())
}

/// White noise, quantisation, counter and thermometer of one sample, RMS over the campaign, µg.
fn sample_ug(recording: &Recording) -> f64 {
    let floor = recording.noise_floor();
    [floor.white_ug, floor.quantization_ug, floor.counter_ug, floor.thermometer_ug].into_iter().fold(0.0, f64::hypot)
}
