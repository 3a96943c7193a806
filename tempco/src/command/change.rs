//! What `add` and `remove` share: retrain a model with other effects, print the ladder of residuals.

use super::train::train_with_bar;
use crate::failure::{Answer, Failure};
use crate::render;
use crate::subject::Subject;
use crate::table::Table;
use std::path::Path;
use trainer::campaign::{Campaign, HoldOut, Split};
use trainer::compare::compare;
use trainer::model::{Model, Provenance};
use trainer::train::{EffectChoice, TrainSettings, check};

/// A model and the campaign to retrain it on.
pub struct Change {
    pub model: Model,
    campaign: Campaign,
    split: Split,
}

impl Change {
    /// Reads both, and holds out the runs that the model holds out.
    pub fn read(model: &Path, subject: &Subject) -> Result<Self, Failure> {
        let model = Model::read(model)?;
        let campaign = subject.read()?;
        let known = |name: &String| campaign.runs.iter().any(|run| run.name == *name);
        let names: Vec<String> = model.provenance.held_out_runs.iter().filter(|name| known(name)).cloned().collect();
        let choice = match names.as_slice() {
            [] if model.provenance.held_out_runs.is_empty() => HoldOut::None,
            [] => HoldOut::LastOfEachKind,
            _ => HoldOut::Named(names),
        };
        let split = campaign.split(&choice)?;
        Ok(Self { model, campaign, split })
    }

    fn settings(&self, effects: &[EffectChoice]) -> TrainSettings {
        let (Provenance { seed, restarts, .. }, serial) = (&self.model.provenance, self.model.serial.clone());
        TrainSettings { restarts: *restarts, serial, effects: effects.to_vec(), ..TrainSettings::new(*seed) }
    }
}

/// Trains from the bare network up, one effect more on each rung, and writes the last model.
pub fn ladder(change: &Change, effects: &[EffectChoice], output: &Path, json: bool) -> Result<Answer, Failure> {
    // What is misspelt should not be found out after minutes of training.
    check(&change.campaign, &change.split, &change.settings(effects))?;
    let mut rungs = Vec::new();
    let mut top = None;
    for count in 0..=effects.len() {
        let name = count.checked_sub(1).map_or("network alone", |last| effects[last].title()).to_owned();
        let trained = train_with_bar(&change.campaign, &change.split, &change.settings(&effects[..count]), &name)?;
        let comparison = compare(&trained.model, &change.campaign)?;
        rungs.push((name, comparison.residual_ug));
        top = Some((trained, comparison));
    }
    let (trained, comparison) = top.ok_or_else(|| Failure::new("nothing was trained"))?;
    trained.model.write(output)?;
    if json {
        let rung =
            |(name, residual_ug): &(String, f64)| serde_json::json!({ "effect": name, "residual_ug": residual_ug });
        let mut value = serde_json::json!(comparison);
        value["ladder"] = rungs.iter().map(rung).collect::<Vec<_>>().into();
        value["effects"] = serde_json::json!(trained.model.effects);
        anstream::println!("{value:#}");
    } else {
        let noise = comparison.noise_floor_ug.map(|noise_ug| ("noise from sample to sample", noise_ug));
        anstream::println!("{}", rungs_table(&rungs, noise));
        for effect in &trained.model.effects {
            let values: Vec<String> =
                effect.parameters.iter().map(|(name, value)| format!("{name} = {value:.4e}")).collect();
            anstream::println!("  {}: {}", effect.title(), values.join(", "));
        }
        anstream::println!("\n{}Model written to {}", render::comparison(&comparison), output.display());
    }
    Ok(Answer::Yes)
}

/// The residual on held-out runs, effect by effect, as figures and as bars.
pub fn rungs_table(rungs: &[(String, f64)], noise: Option<(&str, f64)>) -> Table {
    let highest = rungs.iter().map(|(_, residual_ug)| *residual_ug).fold(0.0, f64::max);
    let mut table = Table::new(["model", "held-out residual µg", ""]);
    let mut row = |name: &str, residual_ug: f64| {
        let bar = "█".repeat((residual_ug / highest * 40.0).round() as usize);
        table.row([name.to_owned(), format!("{residual_ug:.2}"), format!("{bar:<40}")]);
    };
    for (index, (name, residual_ug)) in rungs.iter().enumerate() {
        row(&if index == 0 { name.clone() } else { format!("+ {name}") }, *residual_ug);
    }
    if let Some((name, noise_ug)) = noise {
        row(name, noise_ug);
    }
    table
}
