//! `tempco export model.toml -o calibration.hex`

use crate::failure::{Answer, Failure};
use crate::key::SecretKey;
use crate::output::{Force, Kind, Output};
use crate::terminal::say;
use crate::{hex, region};
use clap::Args;
use firmware_core::storage::empty_slot;
use std::path::{Path, PathBuf};
use trainer::model::Model;

/// Writes the model as the device stores it.
#[derive(Args)]
#[command(
    after_help = "Example:  tempco export model.toml -o calibration.hex && probe-rs download --binary-format hex calibration.hex --chip STM32F405RGTx"
)]
pub struct Export {
    /// Model file
    model: PathBuf,

    /// Where to write it: `.hex` gives Intel HEX at the calibration address of `memory.x`, anything else the bare blob
    #[arg(short, long, value_name = "FILE", default_value = "calibration.bin")]
    output: PathBuf,

    /// Signs it with the factory's key: for instruments that take no other calibration (`tempco device keygen`)
    #[arg(long, value_name = "KEYFILE")]
    sign: Option<PathBuf>,

    #[command(flatten)]
    force: Force,
}

impl Export {
    pub fn run(&self) -> Result<Answer, Failure> {
        let output = Output::file(&self.output, kind(&self.output), "-o", self.force);
        let output = output.reading(std::iter::once(&self.model).chain(&self.sign));
        output.check()?;
        let mut bytes = Model::read(&self.model)?.to_bytes()?;
        if let Some(file) = &self.sign {
            bytes = SecretKey::read(file)?.sign(&bytes);
        }
        let (content, where_to) = content(&self.output, &bytes)?;
        output.write(&content)?;
        say!("{} bytes written to {}{where_to}", bytes.len(), self.output.display())?;
        Ok(Answer::Yes)
    }
}

/// Writes the blob in the format that the file's name asks for, and says where a device will find it.
pub fn write(path: &Path, bytes: &[u8]) -> Result<String, Failure> {
    let (content, where_to) = content(path, bytes)?;
    Output::own(path, kind(path)).write(&content)?;
    Ok(where_to)
}

fn is_hex(path: &Path) -> bool {
    path.extension().is_some_and(|extension| extension == "hex")
}

/// What the file's name asks for.
pub fn kind(path: &Path) -> Kind {
    if is_hex(path) { Kind::CalibrationHex } else { Kind::Calibration }
}

/// What the file will hold, and where a device will find it.
pub fn content(path: &Path, bytes: &[u8]) -> Result<(Vec<u8>, String), Failure> {
    if !is_hex(path) {
        return Ok((bytes.to_owned(), String::new()));
    }
    let (origin, length) = region::calibration()?;
    // The programmer erases what it writes to: a mark in the second slot takes away what was committed there.
    let (at, mark) = empty_slot();
    let text = hex::text(&[(origin, bytes), (origin + length / 2 + at, &mark)])?;
    Ok((text.into_bytes(), format!(", for address {origin:#010x}")))
}
