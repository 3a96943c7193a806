//! A compensation model: a text file that a person can diff.

#[cfg(test)]
mod example;
mod fitted_effect;
mod read;
mod slope;

pub use fitted_effect::ModelEffect;
pub use slope::SlopeOf;

use crate::campaign::ReadAs;
use crate::expression::ExpressionError;
use firmware_core::{Compensator, LoadError, Network};
use protocol::limits::{HIDDEN, MAX_BLOB, MAX_CHANNELS, MAX_NAME, MAX_TERMS};
use protocol::{Blob, Domain, Scaling, Term, Timing, Weights};
use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};
use std::path::PathBuf;
use thiserror::Error;

/// Everything that training found, and how.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Model {
    /// Version of this file's format.
    pub format: u32,
    /// Serial number of the sensor; empty fits any.
    #[serde(default)]
    pub serial: String,
    /// Where it came from.
    pub provenance: Provenance,
    /// Units of signal and reference.
    pub units: Units,
    /// From integers to the network and from the network to the reading.
    pub scaling: ModelScaling,
    /// Where the calibration was made.
    pub domain: ModelDomain,
    /// The 41 weights.
    pub network: ModelNetwork,
    /// Auxiliary channels used by the effects, in the device's order.
    #[serde(default)]
    pub channels: Vec<String>,
    /// Physical effects beside the network, in the order in which they were added.
    #[serde(default, rename = "effect")]
    pub effects: Vec<ModelEffect>,
}

/// How a model was made. Same campaign, same settings, same seed: same bytes.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Provenance {
    /// The program and its version.
    pub made_by: String,
    /// SHA-256 of the campaign's contents.
    pub campaign: String,
    /// Training method.
    pub method: String,
    /// Seed of every random number.
    pub seed: u64,
    /// Trainings from different starting weights, of which the best was kept.
    pub restarts: usize,
    /// Runs that the model learnt from.
    pub training_runs: Vec<String>,
    /// Runs that it never saw.
    pub held_out_runs: Vec<String>,
    /// RMS residual on the training runs, reference unit.
    pub training_residual: f64,
    /// Scale factor that was stated, signal unit per reference unit, for a campaign whose reference never varies.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub scale_factor_hz_per_g: Option<f64>,
    /// How the campaign's files were read; later commands read theirs in the same way.
    #[serde(default, skip_serializing_if = "ReadAs::is_empty")]
    pub read_as: ReadAs,
}

/// Units of the measured quantities.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Units {
    /// Of the signal, usually Hz.
    pub signal: String,
    /// Of the reference, usually g.
    pub reference: String,
}

/// See [`Scaling`].
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ModelScaling {
    /// Frequency difference at x = 0, µHz.
    pub delta_f_zero_uhz: i64,
    /// x per Hz.
    pub delta_f_gain_per_hz: f32,
    /// Temperature at t = 0, µ°C.
    pub temperature_zero_uc: i32,
    /// t per °C.
    pub temperature_gain_per_c: f32,
    /// Constant, x, t, x·t of the first-order instrument, g.
    #[serde(deserialize_with = "read::exactly")]
    pub line_g: [f32; 4],
    /// g per unit of network output.
    pub output_g: f32,
}

/// See [`Domain`].
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ModelDomain {
    /// Lowest and highest frequency difference, µHz.
    #[serde(deserialize_with = "read::exactly")]
    pub delta_f_uhz: [i64; 2],
    /// Lowest and highest temperature, µ°C.
    #[serde(deserialize_with = "read::exactly")]
    pub temperature_uc: [i32; 2],
    /// Longest gap between samples across which memories are carried, µs; [`u32::MAX`] means any.
    pub max_gap_us: u32,
}

/// The network's weights by unit.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ModelNetwork {
    /// [x, t] weights of each hidden unit.
    #[serde(deserialize_with = "read::rows_exactly")]
    pub input: [[f32; 2]; HIDDEN],
    /// Threshold of each hidden unit.
    #[serde(deserialize_with = "read::exactly")]
    pub bias: [f32; HIDDEN],
    /// Output weight of each hidden unit.
    #[serde(deserialize_with = "read::exactly")]
    pub output: [f32; HIDDEN],
    /// Threshold of the output.
    pub output_bias: f32,
}

/// Why there is no model.
#[derive(Debug, Error)]
pub enum ModelError {
    /// The file can't be read.
    #[error("{path}: {source}", path = path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// What the system said.
        source: std::io::Error,
    },
    /// The text is no model.
    #[error("{path}: not a model file: {source}", path = path.display())]
    Syntax {
        /// The file.
        path: PathBuf,
        /// Line and column are in its text.
        source: Box<toml::de::Error>,
    },
    /// Another version wrote it.
    #[error("{path}:{line}: model format {found}, this version reads {supported}", path = path.display())]
    Format {
        /// The file.
        path: PathBuf,
        /// The line.
        line: usize,
        /// Found.
        found: i64,
        /// Understood.
        supported: u32,
    },
    /// A coefficient makes no physical sense.
    #[error(
        "{path}:{line}: effect `{effect}`: {parameter} = {value} is outside {low} to {high}",
        path = path.display(), low = bounds.0, high = bounds.1
    )]
    Bound {
        /// The file.
        path: PathBuf,
        /// The line.
        line: usize,
        /// The effect.
        effect: String,
        /// The coefficient.
        parameter: &'static str,
        /// Its value.
        value: f64,
        /// The least and the greatest value that it can have.
        bounds: (f64, f64),
    },
    /// The text is a model that no device can run.
    #[error("{path}: the model can't be used: {source}", path = path.display())]
    Unusable {
        /// The file.
        path: PathBuf,
        /// Why.
        source: Box<DeviceLimit>,
    },
    /// The model doesn't fit a device.
    #[error("the model can't be put on a device: {0}")]
    Device(#[from] DeviceLimit),
}

/// What a device can't hold.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum DeviceLimit {
    /// An effect unknown to this version.
    #[error("there is no effect named `{0}`; `tempco effects` lists them")]
    UnknownEffect(String),
    /// A coefficient is missing or surplus.
    #[error("effect `{effect}` takes the coefficients {expected}, the model has {found}")]
    Coefficients {
        /// The effect.
        effect: String,
        /// In the model.
        found: String,
        /// Needed.
        expected: String,
    },
    /// An effect's channel is not among the model's.
    #[error("effect `{effect}` needs a channel that the model's `channels` do not list")]
    Channel {
        /// The effect.
        effect: String,
    },
    /// An effect of the user's own doesn't say what it depends on, or another one does.
    #[error("effect `{effect}` {wrong}")]
    Expression {
        /// The effect.
        effect: String,
        /// What is wrong.
        wrong: &'static str,
    },
    /// An expression is wrong for the model's channels.
    #[error(transparent)]
    Text(#[from] ExpressionError),
    /// Too many of something.
    #[error("{what}: at most {most}")]
    TooMany {
        /// Of what.
        what: &'static str,
        /// The limit.
        most: usize,
    },
    /// It was told a scale factor and reads with another one.
    #[error(
        "its slope is not the one of the scale factor that was stated when it was trained (`scale_factor_hz_per_g`)"
    )]
    ScaleFactor,
    /// The core refuses it.
    #[error("{0}")]
    Load(LoadError),
}

impl Model {
    /// The format that this version reads and writes.
    pub const FORMAT: u32 = 1;

    /// The model as text.
    ///
    /// # Panics
    /// Never: every field has a TOML form.
    #[must_use]
    pub fn to_text(&self) -> String {
        toml::to_string(self).expect("every field of a model has a TOML form")
    }

    /// First bytes of the SHA-256 of the model file: what a device reports as its calibration.
    #[must_use]
    pub fn fingerprint(&self) -> [u8; 8] {
        let digest: [u8; 32] = Sha256::digest(self.to_text()).into();
        let [a, b, c, d, e, f, g, h, ..] = digest;
        [a, b, c, d, e, f, g, h]
    }

    /// The weights in the core's order.
    #[must_use]
    pub fn weights(&self) -> Weights {
        let ModelNetwork { input, bias, output, output_bias } = self.network;
        Weights { input, bias, output, output_bias }
    }

    /// The model as a device stores it.
    ///
    /// # Errors
    /// [`DeviceLimit`] if it doesn't fit or the core refuses it.
    pub fn to_blob(&self) -> Result<Blob, DeviceLimit> {
        let weights = self.weights();
        let proof = Network::new(&weights).proof().ok_or(DeviceLimit::Load(LoadError::Number))?;
        let blob = Blob {
            serial: short_name(&self.serial)?,
            provenance: self.fingerprint(),
            proof,
            scaling: self.scaling.to_wire(),
            weights,
            domain: self.domain.to_wire(),
            timing: Timing { max_gap_us: self.domain.max_gap_us },
            channels: self.wire_channels()?,
            terms: self.wire_terms()?,
        };
        Compensator::load(&blob).map_err(DeviceLimit::Load)?;
        if slope::agrees_with_what_was_stated(self) { Ok(blob) } else { Err(DeviceLimit::ScaleFactor) }
    }

    /// The bytes of [`Model::to_blob`].
    ///
    /// # Errors
    /// [`DeviceLimit`] if it doesn't fit or the core refuses it.
    pub fn to_bytes(&self) -> Result<Vec<u8>, DeviceLimit> {
        let mut buffer = [0; MAX_BLOB];
        let too_large = |_| DeviceLimit::TooMany { what: "bytes in a blob", most: MAX_BLOB };
        Ok(self.to_blob()?.to_bytes(&mut buffer).map_err(too_large)?.to_vec())
    }

    fn wire_channels(&self) -> Result<heapless::Vec<heapless::String<MAX_NAME>, MAX_CHANNELS>, DeviceLimit> {
        let mut channels = heapless::Vec::new();
        for name in &self.channels {
            channels
                .push(short_name(name)?)
                .map_err(|_| DeviceLimit::TooMany { what: "auxiliary channels", most: MAX_CHANNELS })?;
        }
        Ok(channels)
    }

    fn wire_terms(&self) -> Result<heapless::Vec<Term, MAX_TERMS>, DeviceLimit> {
        let mut terms = heapless::Vec::new();
        for effect in &self.effects {
            terms
                .push(effect.to_term(&self.channels)?)
                .map_err(|_| DeviceLimit::TooMany { what: "effects", most: MAX_TERMS })?;
        }
        Ok(terms)
    }
}

impl ModelScaling {
    /// The form that the core takes.
    #[must_use]
    pub const fn to_wire(self) -> Scaling {
        Scaling {
            delta_f_zero_uhz: self.delta_f_zero_uhz,
            delta_f_gain_per_hz: self.delta_f_gain_per_hz,
            temperature_zero_uc: self.temperature_zero_uc,
            temperature_gain_per_c: self.temperature_gain_per_c,
            line_g: self.line_g,
            output_g: self.output_g,
        }
    }
}

impl ModelDomain {
    const fn to_wire(self) -> Domain {
        let ([f_low, f_high], [t_low, t_high]) = (self.delta_f_uhz, self.temperature_uc);
        Domain { delta_f_uhz: (f_low, f_high), temperature_uc: (t_low, t_high) }
    }
}

fn short_name(name: &str) -> Result<heapless::String<MAX_NAME>, DeviceLimit> {
    heapless::String::try_from(name).map_err(|_| DeviceLimit::TooMany { what: "letters in a name", most: MAX_NAME })
}
