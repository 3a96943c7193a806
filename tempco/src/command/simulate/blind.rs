//! `--blind`: hides effects in a campaign and puts the truth into an envelope beside it.

use super::measured::{simulate, written};
use crate::failure::Failure;
use crate::output::{Kind, Output, Prepared};
use crate::progress::spinner;
use crate::shell;
use clap::Args;
use firmware_sim::blind::{self, BlindError, BlindOptions};
use firmware_sim::scenario::Scenario;
use firmware_sim::seal::{CampaignDigest, seal};
use std::fmt;
use std::path::{Path, PathBuf};

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

/// Where a blind campaign and its truth are. Its `Display` says so, and not what is hidden.
pub struct Sealed {
    pub rows: usize,
    pub runs: usize,
    /// Of the scenario as it is known: that of the recording might tell.
    pub noise_floor_ug: f64,
    pub campaign: PathBuf,
    pub envelope: PathBuf,
}

impl fmt::Display for Sealed {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { rows, runs, noise_floor_ug, campaign, envelope } = self;
        let (campaign, typed, envelope) = (campaign.display(), shell::path(envelope), envelope.display());
        writeln!(f, "{rows} rows in {runs} runs written to {campaign}; noise floor {noise_floor_ug:.2} µg")?;
        write!(
            f,
            "What they hide is sealed in {envelope}; open it when you have made up your mind:  tempco reveal {typed}"
        )
    }
}

impl Blind {
    /// Hides one effect of the catalogue.
    pub const ONE: Self = Self { blind: true, effects_at_most: Some(1), nothing_possible: false, outside: false };

    /// Measures the blinded campaign, and writes it and its envelope.
    pub fn measure(
        &self,
        scenario: &Scenario,
        seed: u64,
        output: &Path,
        place: &dyn Fn(&Path, Kind) -> Output,
    ) -> Result<Sealed, Failure> {
        let envelope = output.with_extension("sealed");
        if envelope == *output {
            return Err(Failure::new(format_args!("{}: the campaign would overwrite its own truth", output.display()))
                .help("name the campaign something else than .sealed, as in -o campaign.csv"));
        }
        let (campaign, sealed) = (place(output, Kind::Campaign), place(&envelope, Kind::Seal));
        campaign.check()?;
        sealed.check()?;
        let spinner = spinner("choosing what to hide");
        let blinded = blind::blinded(scenario, seed, &self.options());
        spinner.finish_and_clear();
        let (blinded, truth) = blinded.map_err(failure)?;
        let recording = simulate(&blinded, seed)?;
        let table = written(&recording)?;
        let truth_sealed = seal(&truth, &CampaignDigest::of([&table]));
        // One without the other is worth nothing: they appear together.
        let both = [campaign.prepare(&table)?, sealed.prepare(truth_sealed.as_bytes())?];
        both.into_iter().try_for_each(Prepared::place)?;
        Ok(Sealed {
            rows: recording.rows(),
            runs: recording.runs.len(),
            noise_floor_ug: truth.noise_floor_ug,
            campaign: output.to_owned(),
            envelope,
        })
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
