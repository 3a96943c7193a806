//! What `add` and `remove` are about: an effect, of the catalogue or one's own, and a campaign.

use crate::data::Reading;
use crate::failure::Failure;
use clap::Args;
use std::path::PathBuf;
use trainer::campaign::Campaign;
use trainer::train::EffectChoice;

/// `EFFECT DATA…`, or `--expression TEXT DATA…`.
#[derive(Args)]
pub struct Subject {
    /// Effect (`tempco effects` lists them), then the campaign: CSV files, or folders of them. With --expression the campaign alone
    #[arg(required = true, value_name = "EFFECT DATA")]
    words: Vec<PathBuf>,

    /// An effect of one's own: what the bias is proportional to (`tempco effects expression` lists what it may read)
    #[arg(long, value_name = "TEXT", allow_hyphen_values = true)]
    expression: Option<String>,

    #[command(flatten)]
    reading: Reading,
}

impl Subject {
    /// The effect, to be searched from scratch.
    pub fn effect(&self) -> EffectChoice {
        match (&self.expression, self.words.first()) {
            (Some(text), _) => EffectChoice::expression(text),
            (None, first) => EffectChoice::named(&first.map(|word| word.to_string_lossy()).unwrap_or_default()),
        }
    }

    /// The campaign.
    pub fn read(&self) -> Result<Campaign, Failure> {
        let files = self.words.get(usize::from(self.expression.is_none())..).unwrap_or_default();
        if files.is_empty() {
            return Err(Failure::new("an effect and a campaign are needed, one of them is missing")
                .help("write the effect first and the campaign after it, or --expression TEXT and the campaign"));
        }
        self.reading.read(files)
    }
}
