//! `tempco device provision --serial SN -o identity.hex`

use crate::failure::{Answer, Failure};
use crate::key::read_public;
use crate::output::{Force, Kind, Output};
use crate::terminal::say;
use crate::{hex, region};
use clap::Args;
use firmware_core::{FactoryKey, IdentityRecord};
use std::path::PathBuf;

/// Writes the record that tells an instrument who it is, and whose calibrations it takes.
///
/// An instrument that holds a key takes no calibration without its signature; the image must be built to check it
/// (`docs/firmware.md`).
#[derive(Args)]
#[command(
    after_help = "Example:  tempco device provision --serial SN-0042 --key factory.pub -o identity.hex && probe-rs download --binary-format hex identity.hex --chip STM32F405RGTx"
)]
pub struct Provision {
    /// Serial number: up to 24 letters, digits and signs, no blank
    #[arg(long, value_name = "SN")]
    serial: String,

    /// The factory's public key; without it the instrument takes unsigned calibrations
    #[arg(long, value_name = "FILE")]
    key: Option<PathBuf>,

    /// Where to write it: `.hex` gives Intel HEX at the address of `memory.x`, anything else the bare record
    #[arg(short, long, value_name = "FILE", default_value = "identity.hex")]
    output: PathBuf,

    #[command(flatten)]
    force: Force,
}

impl Provision {
    pub fn run(&self) -> Result<Answer, Failure> {
        let is_hex = self.output.extension().is_some_and(|extension| extension == "hex");
        let kind = if is_hex { Kind::IdentityHex } else { Kind::Identity };
        let output = Output::file(&self.output, kind, "-o", self.force).reading(&self.key);
        output.check()?;
        let record = identity(&self.serial, self.key.as_ref())?.to_bytes();
        let (address, _) = region::identity()?;
        let bytes = if is_hex { hex::text(&[(address, &record)])?.into_bytes() } else { record.to_vec() };
        output.write(&bytes)?;
        let place = if is_hex { format!(", for address {address:#010x}") } else { String::new() };
        say!("Identity of {} written to {}{place}", self.serial, self.output.display())?;
        Ok(Answer::Yes)
    }
}

/// The record of a sensor with this serial number and the factory's key in this file.
pub fn identity(serial: &str, key: Option<&PathBuf>) -> Result<IdentityRecord, Failure> {
    let mut record = IdentityRecord::new(serial);
    if record.serial != serial {
        return Err(Failure::new(format_args!("serial number `{serial}` does not fit the record"))
            .help("use up to 24 letters, digits and signs of ASCII, without blanks"));
    }
    if let Some(file) = key {
        record.key = FactoryKey::Asked(read_public(file)?);
    }
    Ok(record)
}
