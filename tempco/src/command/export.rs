//! `tempco export model.toml -o calibration.hex`

use crate::failure::{Answer, Failure};
use crate::key::SecretKey;
use crate::output::write_whole;
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
}

impl Export {
    pub fn run(&self) -> Result<Answer, Failure> {
        let mut bytes = Model::read(&self.model)?.to_bytes()?;
        if let Some(file) = &self.sign {
            bytes = SecretKey::read(file)?.sign(&bytes);
        }
        let where_to = write(&self.output, &bytes)?;
        anstream::println!("{} bytes written to {}{where_to}", bytes.len(), self.output.display());
        Ok(Answer::Yes)
    }
}

/// Writes the blob in the format that the file's name asks for, and says where a device will find it.
pub fn write(path: &Path, bytes: &[u8]) -> Result<String, Failure> {
    if path.extension().is_some_and(|extension| extension == "hex") {
        let (origin, length) = region::calibration()?;
        // The programmer erases what it writes to: a mark in the second slot takes away what was committed there.
        let (at, mark) = empty_slot();
        let text = hex::text(&[(origin, bytes), (origin + length / 2 + at, &mark)])?;
        write_whole(path, text.as_bytes())?;
        Ok(format!(", for address {origin:#010x}"))
    } else {
        write_whole(path, bytes)?;
        Ok(String::new())
    }
}
