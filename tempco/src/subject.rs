//! What `add` and `remove` are about: an effect, of the catalogue or one's own, and a campaign.

use crate::data::Reading;
use crate::failure::Failure;
use clap::Args;
use std::path::PathBuf;
use trainer::campaign::Campaign;
use trainer::model::Model;
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

    /// Scale factor in signal units per reference unit, in place of the one that the model was trained with
    #[arg(long, value_name = "HZ_PER_G", allow_negative_numbers = true)]
    pub scale_factor: Option<f64>,

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

    /// Where the campaign is.
    pub fn files(&self) -> &[PathBuf] {
        self.words.get(usize::from(self.expression.is_none())..).unwrap_or_default()
    }

    /// The campaign, read as the model's was, unless the options say otherwise.
    pub fn read_for(&self, model: &Model) -> Result<Campaign, Failure> {
        let files = self.files();
        if files.is_empty() {
            return Err(Failure::new("an effect and a campaign are needed, one of them is missing")
                .help("write the effect first and the campaign after it, or --expression TEXT and the campaign"));
        }
        self.reading.read_for(files, model)
    }
}
