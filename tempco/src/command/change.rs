//! What `add` and `remove` share: retrain a model with other effects, print the ladder of residuals.

use super::train::train_with_bar;
use crate::data::Data;
use crate::failure::{Answer, Failure};
use crate::render;
use crate::table::Table;
use std::path::Path;
use trainer::campaign::{Campaign, HoldOut, Split};
use trainer::compare::compare;
use trainer::model::{Model, Provenance};
use trainer::train::{EffectChoice, TrainSettings, Trained};

/// A model and the campaign to retrain it on.
pub struct Change {
    pub model: Model,
    campaign: Campaign,
    split: Split,
}

impl Change {
    /// Reads both, and holds out the runs that the model holds out.
    pub fn read(model: &Path, data: &Data) -> Result<Self, Failure> {
        let model = Model::read(model)?;
        let campaign = data.read()?;
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

    fn train(&self, effects: Vec<EffectChoice>, what: &str) -> Result<Trained, Failure> {
        let Provenance { seed, restarts, .. } = self.model.provenance.clone();
        let settings =
            TrainSettings { restarts, serial: self.model.serial.clone(), effects, ..TrainSettings::new(seed) };
        train_with_bar(&self.campaign, &self.split, &settings, what)
    }
}

/// Trains from the bare network up, one effect more on each rung, and writes the last model.
pub fn ladder(change: &Change, effects: &[EffectChoice], output: &Path, json: bool) -> Result<Answer, Failure> {
    let mut rungs = Vec::new();
    let mut top = None;
    for count in 0..=effects.len() {
        let name = count.checked_sub(1).map_or("network alone", |last| effects[last].name.as_str()).to_owned();
        let trained = change.train(effects[..count].to_vec(), &name)?;
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
            anstream::println!("  {}: {}", effect.name, values.join(", "));
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
