//! `tempco flash MODEL --to PORT`

use crate::digits::digits;
use crate::failure::{Answer, Failure};
use crate::key::SecretKey;
use crate::link::{AnyLink, PORTS, Port};
use crate::progress::spinner;
use crate::terminal::say;
use clap::Args;
use firmware_sim::link::{Kept, LinkError};
use protocol::{Blob, Refusal};
use std::path::{Path, PathBuf};
use trainer::model::Model;

/// Writes a calibration into an instrument over its line; the one before stays for `tempco device rollback`.
///
/// Exit code 1 if the instrument refuses it or can keep it until power-off only.
#[derive(Args)]
#[command(
    after_help = "Example:  tempco flash model.toml --to /dev/ttyUSB0\n          tempco flash model.toml --to tcp:127.0.0.1:7000"
)]
pub struct Flash {
    /// Model file, or an exported blob (`.bin`)
    model: PathBuf,

    #[arg(long, value_name = "PORT", help = format!("Where the instrument is: {PORTS}"))]
    to: Port,

    /// Signs it with the factory's key
    #[arg(long, value_name = "KEYFILE")]
    sign: Option<PathBuf>,

    /// Prints one JSON object instead of text
    #[arg(long)]
    json: bool,
}

impl Flash {
    pub fn run(&self) -> Result<Answer, Failure> {
        let bytes = self.bytes()?;
        let mut link = self.to.connect()?;
        let waiting = spinner("flashing");
        let outcome = link.upload(&bytes);
        waiting.finish_and_clear();
        let outcome = match outcome {
            Ok(kept) => Ok(kept),
            Err(LinkError::Refused(refusal)) => Err(refusal),
            Err(error) => return Err(error.into()),
        };
        if outcome.is_ok() {
            self.read_back(&mut link, &bytes)?;
        }
        self.print(&bytes, &outcome)?;
        Ok(if outcome == Ok(Kept::ForGood) { Answer::Yes } else { Answer::No })
    }

    fn bytes(&self) -> Result<Vec<u8>, Failure> {
        let bytes = stored(&self.model)?;
        Ok(match &self.sign {
            Some(file) => SecretKey::read(file)?.sign(&bytes),
            None => bytes,
        })
    }

    /// The instrument holds what was sent, to the byte.
    fn read_back(&self, link: &mut AnyLink, bytes: &[u8]) -> Result<(), Failure> {
        if link.read_calibration()? == bytes {
            return Ok(());
        }
        Err(Failure::new("the instrument took the calibration and reads back another one").help("write it again"))
    }

    fn print(&self, bytes: &[u8], outcome: &Result<Kept, Refusal>) -> Result<(), Failure> {
        let name = digits(&Blob::from_bytes(bytes)?.provenance);
        if self.json {
            let (kept, refusal) = match outcome {
                Ok(Kept::ForGood) => ("for-good", None),
                Ok(Kept::UntilPowerOff) => ("until-power-off", None),
                Err(refusal) => ("no", Some(refusal.to_string())),
            };
            let answer =
                serde_json::json!({ "calibration": name, "bytes": bytes.len(), "kept": kept, "refusal": refusal });
            say!("{answer:#}")?;
            return Ok(());
        }
        match outcome {
            Ok(Kept::ForGood) => {
                say!("Calibration {name}, {} bytes, is stored, in use, and reads back the same.", bytes.len())?;
            }
            Ok(Kept::UntilPowerOff) => say!(
                "Calibration {name} is in use, but the instrument could not store it: it runs from RAM until power-off."
            )?,
            Err(refusal) => say!("The instrument refused: {refusal}. Its calibration runs on.")?,
        }
        Ok(())
    }
}

/// What an instrument stores of a model, or of what `tempco export` wrote.
pub fn stored(file: &Path) -> Result<Vec<u8>, Failure> {
    match file.extension().and_then(|extension| extension.to_str()) {
        Some("bin") => std::fs::read(file).map_err(|error| Failure::io(file, &error)),
        Some("hex") => crate::hex::first_piece(file),
        _ => Ok(Model::read(file)?.to_bytes()?),
    }
}
