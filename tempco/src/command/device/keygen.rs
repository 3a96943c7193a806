//! `tempco device keygen -o factory`

use crate::digits::digits;
use crate::failure::{Answer, Failure};
use crate::key::{SecretKey, write_public};
use crate::terminal::say;
use clap::Args;
use std::path::PathBuf;

/// Makes the factory's pair of keys: one that signs calibrations, one that instruments hold.
#[derive(Args)]
#[command(
    after_help = "Example:  tempco device keygen -o factory\n          tempco device provision --serial SN-0042 --key factory.pub -o identity.hex\n          tempco export model.toml --sign factory.key -o calibration.hex"
)]
pub struct Keygen {
    /// Name of both files, without their endings `.key` (keep it secret) and `.pub`
    #[arg(short, long, value_name = "NAME", default_value = "factory")]
    output: PathBuf,

    /// Prints one JSON object instead of text
    #[arg(long)]
    json: bool,
}

impl Keygen {
    pub fn run(&self) -> Result<Answer, Failure> {
        let file = |ending: &str| PathBuf::from(format!("{}.{ending}", self.output.display()));
        // Both or none: a new secret key is no use to instruments that hold the old public one.
        for path in [file("key"), file("pub")] {
            if path.exists() || path.is_symlink() {
                return Err(Failure::new(format_args!("{}: there is a key of this name", path.display()))
                    .help("an existing key is never overwritten: choose another name, as in -o factory-2"));
            }
        }
        let key = SecretKey::generate()?;
        key.write(&file("key"))?;
        write_public(&file("pub"), &key.public())?;
        if self.json {
            say!("{:#}", serde_json::json!({ "key": digits(&key.public()) }))?;
        } else {
            let (secret, public) = (file("key"), file("pub"));
            say!("Key {}", digits(&key.public()))?;
            say!("  {} signs; keep it secret and safe", secret.display())?;
            say!("  {} goes into instruments: tempco device provision", public.display())?;
        }
        Ok(Answer::Yes)
    }
}
