//! A compensation model: a text file that a person can diff.

mod arrays;
mod bounds;
mod error;
#[cfg(test)]
pub(crate) mod example;
mod fitted_effect;
mod parts;
mod read;
mod slope;

pub(crate) use bounds::reach;
pub use error::{DeviceLimit, ModelError};
pub use fitted_effect::ModelEffect;
pub use parts::{ModelDomain, ModelNetwork, ModelScaling, Units};
pub use slope::SlopeOf;

use crate::campaign::ReadAs;
use firmware_core::{Compensator, LoadError, Network};
use protocol::limits::{MAX_BLOB, MAX_CHANNELS, MAX_NAME, MAX_TERMS};
use protocol::{Blob, Term, Timing, Weights};
use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};

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

    /// What it makes of a change of its signal.
    #[must_use]
    pub fn slope(&self) -> SlopeOf<'_> {
        SlopeOf::new(&self.scaling, &self.domain, &self.weights())
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
        let stated = self.provenance.scale_factor_hz_per_g;
        if self.slope().agrees_with(stated) { Ok(blob) } else { Err(DeviceLimit::ScaleFactor) }
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

fn short_name(name: &str) -> Result<heapless::String<MAX_NAME>, DeviceLimit> {
    heapless::String::try_from(name).map_err(|_| DeviceLimit::TooMany { what: "letters in a name", most: MAX_NAME })
}
