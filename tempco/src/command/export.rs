//! `tempco export model.toml -o calibration.hex`

use crate::calibration_region::calibration_region;
use crate::failure::{Answer, Failure};
use clap::Args;
use ihex::Record;
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
}

impl Export {
    pub fn run(&self) -> Result<Answer, Failure> {
        let bytes = Model::read(&self.model)?.to_bytes()?;
        let where_to = write(&self.output, &bytes)?;
        anstream::println!("{} bytes written to {}{where_to}", bytes.len(), self.output.display());
        Ok(Answer::Yes)
    }
}

/// Writes the blob in the format that the file's name asks for, and says where a device will find it.
pub fn write(path: &Path, bytes: &[u8]) -> Result<String, Failure> {
    if path.extension().is_some_and(|extension| extension == "hex") {
        let (origin, _) = calibration_region().ok_or_else(|| Failure::new("memory.x names no CALIBRATION region"))?;
        std::fs::write(path, hex(origin, bytes)?).map_err(|error| Failure::io(path, &error))?;
        Ok(format!(", for address {origin:#010x}"))
    } else {
        std::fs::write(path, bytes).map_err(|error| Failure::io(path, &error))?;
        Ok(String::new())
    }
}

fn hex(origin: u32, bytes: &[u8]) -> Result<String, Failure> {
    let mut records = vec![Record::ExtendedLinearAddress((origin >> 16) as u16)];
    for (index, line) in bytes.chunks(16).enumerate() {
        let offset = (origin as u16).wrapping_add((16 * index) as u16);
        records.push(Record::Data { offset, value: line.to_vec() });
    }
    records.push(Record::EndOfFile);
    ihex::create_object_file_representation(&records).map_err(Failure::new)
}
