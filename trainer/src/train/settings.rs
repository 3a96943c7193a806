//! What to train, and how.

mod backprop;

pub use backprop::{Backprop, Swarm};

use super::error::TrainError;
use crate::effect_choice::EffectChoice;
use protocol::limits::MAX_NAME;

/// How the weights are found.
#[derive(Clone, Debug, PartialEq)]
pub enum Method {
    /// Variable projection and Levenberg–Marquardt from random starts, with the slope held to the
    /// measured scale factor.
    SecondOrder,
    /// The paper's: gradient descent from the best of a firefly swarm.
    Backprop(Backprop),
}

impl Method {
    /// Its name on the command line and in model files.
    #[must_use]
    pub const fn name(&self) -> &'static str {
        match self {
            Self::SecondOrder => "second-order",
            Self::Backprop(Backprop { swarm: Swarm::Standard(_), .. }) => "fa-bp",
            Self::Backprop(Backprop { swarm: Swarm::Improved(_), .. }) => "ifa-bp",
        }
    }
}

/// What to train.
#[derive(Clone, Debug, PartialEq)]
pub struct TrainSettings {
    /// How.
    pub method: Method,
    /// Trainings from different starts; the one with the least cost is kept.
    pub restarts: usize,
    /// Seed of every random number.
    pub seed: u64,
    /// Scale factor, Hz/g, for a campaign whose reference never varies.
    pub scale_factor_hz_per_g: Option<f64>,
    /// Serial number of the sensor; empty fits any.
    pub serial: String,
    /// Physical effects beside the network; second-order method only.
    pub effects: Vec<EffectChoice>,
    /// What keeps the network smooth between the measurements; second-order method only.
    pub anchoring: Anchoring,
}

/// What keeps the network smooth where the measurements leave it open.
/// `docs/decisions/0003-anchors.md` compares them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Anchoring {
    /// Nothing but the priors of the weights.
    Nothing,
    /// Slopes: the scale factor that the campaign measured.
    Slopes,
    /// Values of the smooth instrument.
    Values,
    /// Both; the default.
    Both,
}

impl TrainSettings {
    /// The most restarts that are made; the best of so many is as good as any.
    pub const MOST_RESTARTS: usize = 10_000;
    /// The largest seed: numbers in a model file have a sign.
    pub const LARGEST_SEED: u64 = i64::MAX as u64;

    /// Refuses what no memory, no model file and no device has room for.
    ///
    /// # Errors
    /// The first such number or name.
    pub fn check(&self) -> Result<(), TrainError> {
        let Self { restarts, seed, serial, .. } = self;
        match *restarts {
            0 => return Err(TrainError::NoRestarts),
            found if found > Self::MOST_RESTARTS => {
                return Err(TrainError::TooManyRestarts { found, most: Self::MOST_RESTARTS });
            }
            _ => {}
        }
        if *seed > Self::LARGEST_SEED {
            return Err(TrainError::LargeSeed { found: *seed, most: Self::LARGEST_SEED });
        }
        if serial.len() > MAX_NAME {
            return Err(TrainError::LongSerial { found: serial.clone(), most: MAX_NAME });
        }
        Ok(())
    }

    /// The default method with 30 restarts, as many as the paper makes.
    #[must_use]
    pub const fn new(seed: u64) -> Self {
        Self {
            method: Method::SecondOrder,
            restarts: 30,
            seed,
            scale_factor_hz_per_g: None,
            serial: String::new(),
            effects: Vec::new(),
            anchoring: Anchoring::Both,
        }
    }
}
