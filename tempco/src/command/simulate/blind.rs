//! `--blind`: hides effects in a campaign and puts the truth into an envelope beside it.

use super::{simulate, write};
use crate::failure::Failure;
use crate::progress::spinner;
use clap::Args;
use firmware_sim::scenario::{BlindError, BlindOptions, Scenario};
use firmware_sim::seal::{CampaignDigest, seal};
use std::path::Path;

/// What may be hidden.
#[derive(Args)]
pub struct Blind {
    /// Hides one or more effects in the campaign; the truth goes into a sealed file beside it, for `tempco reveal`
    #[arg(long, conflicts_with = "print")]
    pub blind: bool,

    /// Most effects to hide [default: 2, or 1 with --outside]
    #[arg(long, value_name = "N", requires = "blind", value_parser = clap::value_parser!(u16).range(1..))]
    effects_at_most: Option<u16>,

    /// Makes "nothing is hidden" a possible truth too
    #[arg(long, requires = "blind")]
    nothing_possible: bool,

    /// Hides an effect that no catalogue knows
    #[arg(long, requires = "blind")]
    outside: bool,
}

impl Blind {
    /// Measures the blinded campaign, writes it and its envelope, and says where, but not what.
    pub fn measure(&self, scenario: &Scenario, seed: u64, output: &Path) -> Result<String, Failure> {
        let envelope = output.with_extension("sealed");
        if envelope == *output {
            return Err(Failure::new(format_args!("{}: the campaign would overwrite its own truth", output.display()))
                .help("name the campaign something else than .sealed, as in -o campaign.csv"));
        }
        let spinner = spinner("choosing what to hide");
        let blinded = scenario.blinded(seed, &self.options());
        spinner.finish_and_clear();
        let (blinded, truth) = blinded.map_err(failure)?;
        let recording = simulate(&blinded, seed)?;
        write(&recording, output)?;
        let io = |path: &Path, error: &std::io::Error| Failure::io(path, error);
        let campaign = std::fs::read(output).map_err(|error| io(output, &error))?;
        let sealed = seal(&truth, &CampaignDigest::of([campaign]));
        std::fs::write(&envelope, sealed).map_err(|error| io(&envelope, &error))?;
        Ok(format!(
            "{} rows in {} runs written to {}; noise floor {:.2} µg\nWhat they hide is sealed in {}; open it when you \
             have made up your mind:  tempco reveal {}",
            recording.rows(),
            recording.runs.len(),
            output.display(),
            // Of the scenario as it is known: that of the recording might tell.
            truth.noise_floor_ug,
            envelope.display(),
            envelope.display()
        ))
    }

    fn options(&self) -> BlindOptions {
        let mut options = if self.outside { BlindOptions::outside_the_catalogue() } else { BlindOptions::default() };
        if self.nothing_possible {
            options.at_least = 0;
        }
        if let Some(at_most) = self.effects_at_most {
            options.at_most = usize::from(at_most);
        }
        options
    }
}

fn failure(error: BlindError) -> Failure {
    match error {
        BlindError::TooFew { .. } => {
            Failure::new(error).help("--effects-at-most 1 asks for fewer; the scenario `rich` excites every effect")
        }
        _ => Failure::new(error),
    }
}
