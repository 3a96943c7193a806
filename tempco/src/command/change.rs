//! What `add` and `remove` share: retrain a model with other effects, print the ladder of residuals.

use super::train::train_with_bar;
use crate::failure::Failure;
use crate::output::{Force, Kind, Output};
use crate::render;
use crate::subject::Subject;
use crate::table::Table;
use crate::terminal::say;
use clap::Args;
use std::path::{Path, PathBuf};
use trainer::campaign::{Campaign, Split};
use trainer::compare::{Comparison, compare};
use trainer::ladder::{BARE, Rung, doubts};
use trainer::model::Model;
use trainer::retrain;
use trainer::train::{EffectChoice, TrainSettings, Trained, check};

/// What to change, and where the result goes.
#[derive(Args)]
pub struct Request {
    /// Model file
    model: PathBuf,

    #[command(flatten)]
    subject: Subject,

    /// Where to write the new model
    #[arg(short, long, value_name = "FILE")]
    output: PathBuf,

    #[command(flatten)]
    force: Force,

    /// Prints one JSON object instead of text
    #[arg(long)]
    json: bool,
}

impl Request {
    /// Retrains the model with what `effects` makes of its effects and the one that is asked for, writes it and tells of it.
    pub fn carry_out(
        &self,
        effects: impl FnOnce(&Change, EffectChoice) -> Result<Vec<EffectChoice>, Failure>,
    ) -> Result<Ladder, Failure> {
        let output = Output::file(&self.output, Kind::Model, "-o", self.force);
        let output = output.reading(self.subject.files().iter().chain([&self.model]));
        output.check()?;
        let model = Model::read(&self.model)?;
        let campaign = self.subject.read_for(&model)?;
        let change = Change::of(&model, &campaign)?.scaled(self.subject.scale_factor);
        let effects = effects(&change, self.subject.effect())?;
        ladder(&change, &effects, &output, self.json)
    }

    /// The model as it was before.
    pub fn model(&self) -> &Path {
        &self.model
    }

    /// Whether the answer is for programs.
    pub const fn is_json(&self) -> bool {
        self.json
    }
}

/// A model and the campaign to retrain it on.
pub struct Change<'a> {
    model: &'a Model,
    campaign: &'a Campaign,
    split: Split,
    settings: TrainSettings,
}

/// What was trained from the bare network up.
pub struct Ladder {
    pub rungs: Vec<Rung>,
    pub model: Model,
    pub comparison: Comparison,
    /// What speaks against the effect on the last rung.
    pub doubts: Vec<String>,
}

impl<'a> Change<'a> {
    /// Holds out the runs that the model holds out.
    pub fn of(model: &'a Model, campaign: &'a Campaign) -> Result<Self, Failure> {
        Ok(Self { model, campaign, split: retrain::split(model, campaign)?, settings: retrain::settings(model) })
    }

    /// With this scale factor in place of the model's, if one is given.
    fn scaled(mut self, scale_factor_hz_per_g: Option<f64>) -> Self {
        self.settings.scale_factor_hz_per_g = scale_factor_hz_per_g.or(self.settings.scale_factor_hz_per_g);
        self
    }

    /// The model's effects and one more.
    pub fn with(&self, new: EffectChoice) -> Result<Vec<EffectChoice>, Failure> {
        let mut effects = EffectChoice::of(self.model);
        if effects.iter().any(|choice| choice.is_same(&new)) {
            return Err(Failure::new(format_args!("the model has the effect `{}` already", new.title())));
        }
        effects.push(new);
        Ok(effects)
    }

    /// The model's effects but for one.
    pub fn without(&self, unwanted: &EffectChoice) -> Result<Vec<EffectChoice>, Failure> {
        let mut effects = EffectChoice::of(self.model);
        let before = effects.len();
        effects.retain(|choice| !choice.is_same(unwanted));
        if effects.len() == before {
            let names: Vec<&str> = effects.iter().map(EffectChoice::title).collect();
            return Err(Failure::new(format_args!("the model has no effect `{}`", unwanted.title())).help(
                format_args!("it has: {}", if names.is_empty() { "none".to_owned() } else { names.join(", ") }),
            ));
        }
        Ok(effects)
    }

    /// Trains from the bare network up, one effect more on each rung, and tells of each as it is reached.
    pub fn climb(
        &self,
        effects: &[EffectChoice],
        train: impl Fn(&Split, &TrainSettings, &str) -> Result<Trained, Failure>,
        mut reached: impl FnMut(&Rung),
    ) -> Result<Ladder, Failure> {
        // What is misspelt should not be found out after minutes of training.
        check(self.campaign, &self.split, &self.settings(effects))?;
        let mut rungs = Vec::new();
        let mut top = None;
        for count in 0..=effects.len() {
            let effect = count.checked_sub(1).map_or(BARE, |last| effects[last].title()).to_owned();
            let model = train(&self.split, &self.settings(&effects[..count]), &effect)?.model;
            let comparison = compare(&model, self.campaign)?;
            let rung = Rung { effect, residual_ug: comparison.residual_ug };
            reached(&rung);
            rungs.push(rung);
            top = Some((model, comparison));
        }
        let (model, comparison) = top.ok_or_else(|| Failure::new("nothing was trained"))?;
        let doubts = doubts(&model, self.campaign, &rungs);
        Ok(Ladder { rungs, model, comparison, doubts })
    }

    fn settings(&self, effects: &[EffectChoice]) -> TrainSettings {
        TrainSettings { effects: effects.to_vec(), ..self.settings.clone() }
    }
}

/// Climbs with a progress bar, writes the model on the last rung, and prints the ladder.
fn ladder(change: &Change, effects: &[EffectChoice], output: &Output, json: bool) -> Result<Ladder, Failure> {
    let train =
        |split: &Split, settings: &TrainSettings, name: &str| train_with_bar(change.campaign, split, settings, name);
    let ladder = change.climb(effects, train, |_| ())?;
    let Ladder { rungs, model, comparison, doubts } = &ladder;
    output.write(model.to_text().as_bytes())?;
    if json {
        let mut value = serde_json::json!(comparison);
        value["ladder"] = serde_json::json!(rungs);
        value["effects"] = serde_json::json!(model.effects);
        value["doubts"] = serde_json::json!(doubts);
        say!("{value:#}")?;
    } else {
        let noise = comparison.noise_floor_ug.map(|noise_ug| ("noise from sample to sample", noise_ug));
        say!("{}", rungs_table(rungs, noise))?;
        for effect in &model.effects {
            let values: Vec<String> =
                effect.parameters.iter().map(|(name, value)| format!("{name} = {value:.4e}")).collect();
            say!("  {}: {}", effect.title(), values.join(", "))?;
        }
        say!("\n{}Model written to {}", render::comparison(comparison), output.path().display())?;
    }
    Ok(ladder)
}

/// The residual on held-out runs, effect by effect, as figures and as bars.
pub fn rungs_table(rungs: &[Rung], noise: Option<(&str, f64)>) -> Table {
    let highest = rungs.iter().map(|rung| rung.residual_ug).fold(0.0, f64::max);
    let mut table = Table::new(["model", "held-out residual µg", ""]);
    let mut row = |name: &str, residual_ug: f64| {
        let bar = "█".repeat((residual_ug / highest * 40.0).round() as usize);
        table.row([name.to_owned(), format!("{residual_ug:.2}"), format!("{bar:<40}")]);
    };
    for (index, Rung { effect, residual_ug }) in rungs.iter().enumerate() {
        row(&if index == 0 { effect.clone() } else { format!("+ {effect}") }, *residual_ug);
    }
    if let Some((name, noise_ug)) = noise {
        row(name, noise_ug);
    }
    table
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rungs_are_drawn_in_proportion_to_the_highest_and_only_effects_are_added() {
        let rung = |effect: &str, residual_ug: f64| Rung { effect: effect.to_owned(), residual_ug };
        let table = rungs_table(&[rung(BARE, 20.0), rung("thermal-lag", 10.0)], Some(("noise", 5.0))).to_string();
        let lines: Vec<(&str, usize)> =
            table.lines().skip(1).map(|line| (line.trim_matches([' ', '█']), line.matches('█').count())).collect();
        let [(bare, 40), (lag, 20), (noise, 10)] = lines[..] else { panic!("{table}") };
        assert!(bare.starts_with(BARE) && bare.ends_with(" 20.00"), "{table}");
        assert!(lag.starts_with("+ thermal-lag ") && lag.ends_with(" 10.00"), "{table}");
        assert!(noise.starts_with("noise ") && noise.ends_with(" 5.00"), "{table}");
    }
}
