//! Where a report's numbers come from.

use crate::campaign::Campaign;
use crate::model::{Model, ModelEffect, Provenance};
use serde::Serialize;
use sha2::{Digest, Sha256};
use std::path::Path;

/// Everything that it takes to make the same report again.
#[derive(Clone, Debug, Serialize)]
pub struct Origin {
    /// The program and version that made the report.
    pub reported_by: String,
    /// What a device reports as its calibration: the first bytes of the SHA-256 of the model file.
    pub fingerprint: String,
    /// Serial number of the sensor; empty fits any.
    pub serial: String,
    /// How the model was made.
    pub model: Provenance,
    /// The effects beside the network.
    pub effects: Vec<ModelEffect>,
    /// SHA-256 of the measured content, whatever the files are called.
    pub campaign: String,
    /// Whether that is the campaign that the model was trained on.
    pub same_campaign: bool,
    /// Rows measured.
    pub rows: usize,
    /// The files.
    pub files: Vec<DataFile>,
}

/// A data file.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct DataFile {
    /// Its name without its folder.
    pub name: String,
    /// SHA-256 of its bytes.
    pub sha256: String,
}

impl DataFile {
    /// Reads a file for its checksum.
    ///
    /// # Errors
    /// What the system says.
    pub fn read(path: &Path) -> std::io::Result<Self> {
        let name = path.file_name().unwrap_or(path.as_os_str()).to_string_lossy().into_owned();
        Ok(Self { name, sha256: hex(&Sha256::digest(std::fs::read(path)?)) })
    }

    /// Every file that a campaign was read from.
    ///
    /// # Errors
    /// What the system says, for the first file that it could not read.
    pub fn all_of(campaign: &Campaign) -> std::io::Result<Vec<Self>> {
        let mut paths: Vec<&Path> = campaign.runs.iter().map(|run| run.source.as_path()).collect();
        paths.sort_unstable();
        paths.dedup();
        paths.into_iter().map(Self::read).collect()
    }
}

/// The origin of a report on a model from a campaign.
#[must_use]
pub fn origin(model: &Model, campaign: &Campaign) -> Origin {
    Origin {
        reported_by: concat!("tempco ", env!("CARGO_PKG_VERSION")).to_owned(),
        fingerprint: hex(&model.fingerprint()),
        serial: model.serial.clone(),
        model: model.provenance.clone(),
        effects: model.effects.clone(),
        campaign: campaign.hash(),
        same_campaign: model.provenance.campaign == campaign.hash(),
        rows: campaign.row_count(),
        files: Vec::new(),
    }
}

fn hex(bytes: &[u8]) -> String {
    bytes.iter().map(|byte| format!("{byte:02x}")).collect()
}
