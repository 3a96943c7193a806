//! `tempco demo`: the whole path on a blind campaign, the truth revealed at the end.

use super::change::rungs_table;
use super::diagnose::diagnosed;
use super::simulate::{self, blind::Blind};
use super::train::{Simpler, train_with_bar};
use super::{export, reveal, verify};
use crate::data::seeds;
use crate::failure::{Answer, Failure};
use crate::output::{Force, Kind, Output, make_folder};
use crate::render::diagnosis;
use crate::shell;
use crate::table::Table;
use crate::terminal::say;
use clap::Args;
use firmware_sim::scenario::Scenario;
use firmware_sim::seal::SealedTruth;
use firmware_sim::twin::NoiseFloor;
use std::path::{Path, PathBuf};
use trainer::campaign::{Campaign, HoldOut, ReadOptions, Split};
use trainer::compare::compare;
use trainer::diagnose::Diagnosis;
use trainer::ladder::Rung;
use trainer::model::Model;
use trainer::residuals::arranged;
use trainer::train::{EffectChoice, TrainSettings, Trained};

/// Shows the whole path: measurements that hide an effect, training, diagnosis, cure, export, verification, the truth.
#[derive(Args)]
#[command(after_help = "Example:  tempco demo --output my-demo --seed 21")]
pub struct Demo {
    /// Folder for the files
    #[arg(short, long, value_name = "FOLDER", default_value = "tempco-demo")]
    output: PathBuf,

    /// Seed of every random number, and of what is hidden
    #[arg(long, default_value_t = SEED, value_parser = seeds())]
    seed: u64,

    #[command(flatten)]
    force: Force,
}

/// Hides an effect of three times the noise: plain to a diagnosis, invisible to a reader of the table.
pub const SEED: u64 = 18;

/// The scenario that excites every effect.
pub const SCENARIO: &str = "rich";

/// What was measured, and what is known of it.
pub struct Measured {
    pub data: PathBuf,
    pub envelope: PathBuf,
    pub campaign: Campaign,
    split: Split,
    /// What noise alone would leave on the held-out runs, as the simulation states it, µg.
    pub noise_ug: f64,
}

impl Demo {
    pub fn run(&self) -> Result<Answer, Failure> {
        make_folder(&self.output)?;
        for name in ["model.toml", "better.toml", "calibration.bin", "calibration.hex"] {
            self.place(name).check()?;
        }
        let place = |path: &Path, kind| Output::in_folder(path, kind, "--output", self.force);
        let measured = measured(&self.output, self.seed, &place)?;
        announce(&measured)?;
        let trained = self.train(&measured)?;
        let diagnosis = diagnosed(&trained.model, &measured.campaign)?;
        say!("3. Diagnosis\n{}", diagnosis::short(&diagnosis))?;
        let model = self.add(&measured, &trained, &diagnosis)?;
        let answer = self.deliver(&measured, &model)?;
        let truth = reveal::opened(&measured.envelope, &measured.data)?;
        say!("7. The truth\n{}\n{}\n", reveal::words(&truth, &measured.data), judged(&truth, &diagnosis))?;
        self.further(&measured.data)?;
        Ok(answer)
    }

    /// One of the files besides the campaign.
    fn place(&self, name: &str) -> Output {
        let path = self.output.join(name);
        let kind = if name.ends_with(".toml") { Kind::Model } else { export::kind(&path) };
        Output::in_folder(&path, kind, "--output", self.force)
    }

    fn settings(&self, effects: Vec<EffectChoice>) -> TrainSettings {
        TrainSettings { effects, ..TrainSettings::new(self.seed) }
    }

    /// Trains the network alone and prints what it leaves on the held-out runs, beside simpler models.
    fn train(&self, measured: &Measured) -> Result<Trained, Failure> {
        let Measured { campaign, split, noise_ug, .. } = measured;
        let trained = train_with_bar(campaign, split, &self.settings(Vec::new()), "training")?;
        self.place("model.toml").write(trained.model.to_text().as_bytes())?;
        let mut table = Table::new(["model", "held-out residual µg", "times the noise"]);
        let simpler = Simpler::all(&trained, campaign, split).into_iter().map(|one| (one.model, one.residual_ug));
        let network = ("network", compare(&trained.model, campaign)?.residual_ug);
        for (name, residual_ug) in simpler.chain([network]) {
            table.row([name.to_owned(), format!("{residual_ug:.2}"), format!("{:.2}", residual_ug / noise_ug)]);
        }
        say!("2. Models without the effect\n{table}")?;
        Ok(trained)
    }

    /// Adds the first finding, if there is one that an instrument can take out.
    fn add(&self, measured: &Measured, trained: &Trained, diagnosis: &Diagnosis) -> Result<Model, Failure> {
        let Measured { campaign, split, noise_ug, .. } = measured;
        let Some(effect) = diagnosis::first_to_add(diagnosis) else {
            say!("4. Nothing to add: the model stays as it is\n")?;
            return Ok(trained.model.clone());
        };
        let better = train_with_bar(campaign, split, &self.settings(vec![EffectChoice::named(effect)]), effect)?.model;
        self.place("better.toml").write(better.to_text().as_bytes())?;
        let rungs = [("network alone", &trained.model), (effect, &better)];
        let rung = |(name, model): (&str, &Model)| {
            Ok(Rung { effect: name.to_owned(), residual_ug: compare(model, campaign)?.residual_ug })
        };
        let rungs = rungs.into_iter().map(rung).collect::<Result<Vec<_>, Failure>>()?;
        let noise = ("noise alone, says the simulation", *noise_ug);
        say!("4. The model with the effect\n{}", rungs_table(&rungs, Some(noise)))?;
        Ok(better)
    }

    fn deliver(&self, measured: &Measured, model: &Model) -> Result<Answer, Failure> {
        let bytes = model.to_bytes()?;
        let mut address = String::new();
        for name in ["calibration.bin", "calibration.hex"] {
            let (content, where_to) = export::content(&self.output.join(name), &bytes)?;
            self.place(name).write(&content)?;
            address = where_to;
        }
        say!("5. Calibration exported: {} bytes{address}", bytes.len())?;
        let parity = verify::verify(&model.to_blob()?, &arranged(model, &measured.campaign)?)?;
        say!("6. Virtual instrument, over its own wire: {parity}\n")?;
        Ok(if parity.identical == parity.samples { Answer::Yes } else { Answer::No })
    }

    fn further(&self, data: &Path) -> Result<(), Failure> {
        let model = self.output.join("model.toml");
        say!("The files are in {}.", self.output.display())?;
        say!("Look closer:   tempco diagnose {} {}", shell::path(&model), shell::path(data))?;
        say!("Another seed:  tempco demo --seed {}", self.seed.wrapping_add(1))
    }
}

/// Measures the blind campaign into a folder, and seals the truth beside it.
pub fn measure(folder: &Path, seed: u64) -> Result<Measured, Failure> {
    measured(folder, seed, &Output::own)
}

fn measured(folder: &Path, seed: u64, place: &dyn Fn(&Path, Kind) -> Output) -> Result<Measured, Failure> {
    let scenario =
        Scenario::preset(SCENARIO).ok_or_else(|| Failure::new(format_args!("no scenario named {SCENARIO}")))?;
    let data = folder.join("campaign.csv");
    let envelope = Blind::ONE.measure(&scenario, seed, &data, place)?.envelope;
    let campaign = Campaign::read(std::slice::from_ref(&data), &ReadOptions::default())?;
    let split = campaign.split(&HoldOut::LastOfEachKind)?;
    let noise_ug = noise_ug(&scenario, seed, &held_out(&campaign, &split))?;
    Ok(Measured { data, envelope, campaign, split, noise_ug })
}

fn held_out<'a>(campaign: &'a Campaign, split: &Split) -> Vec<&'a str> {
    split.held_out.iter().map(|&index| campaign.runs[index].name.as_str()).collect()
}

fn announce(Measured { campaign, split, envelope, noise_ug, .. }: &Measured) -> Result<(), Failure> {
    let (rows, runs) = (campaign.row_count(), campaign.runs.len());
    say!("1. Measurements: {rows} rows in {runs} runs. They hide an effect;")?;
    say!("   what it is, is sealed in {} until the end.", envelope.display())?;
    say!("   held out, never seen by any training: {}", held_out(campaign, split).join(", "))?;
    say!("   noise alone would leave {noise_ug:.2} µg there, says the simulation\n")
}

/// The same campaign without what is hidden: its noise may be known.
fn noise_ug(scenario: &Scenario, seed: u64, names: &[&str]) -> Result<f64, Failure> {
    let recording = simulate::simulate(scenario, seed)?;
    let held_out = recording.runs.iter().filter(|run| names.contains(&run.name.as_str()));
    Ok(NoiseFloor::mean(held_out.flat_map(|run| &run.rows).map(|row| row.truth.floor)).noise_ug())
}

/// Whether the diagnosis was right, in a sentence or two.
pub fn judged(truth: &SealedTruth, diagnosis: &Diagnosis) -> String {
    let Some(hidden) = truth.hidden.first().map(|hidden| &hidden.name) else {
        return "There was nothing to find.".to_owned();
    };
    let Some((first, others)) = diagnosis.findings.split_first() else {
        return format!("The diagnosis did not name {hidden}.");
    };
    let mut text = if first.effect == *hidden {
        format!("The diagnosis was right: it named {hidden}.")
    } else if first.confounded_with.contains(hidden) {
        format!("The diagnosis was right to leave open whether it is {} or {hidden}.", first.effect)
    } else {
        format!("The diagnosis was wrong: it named {} first, not {hidden}.", first.effect)
    };
    let others: Vec<&str> = others.iter().map(|finding| finding.effect.as_str()).collect();
    if !others.is_empty() {
        text += &format!(" It also named {}.", others.join(", "));
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::command::example::diagnosis;
    use firmware_sim::seal::HiddenEffect;

    fn truth(hidden: &[&str]) -> SealedTruth {
        let effect = |name: &&str| HiddenEffect { name: (*name).to_owned(), influence_ug: 9.0, times_noise: 3.0 };
        let scenario = Scenario::preset(SCENARIO).expect("a scenario");
        SealedTruth { blind_seed: 1, noise_floor_ug: 3.0, hidden: hidden.iter().map(effect).collect(), scenario }
    }

    #[test]
    fn a_diagnosis_is_judged_by_what_was_hidden() {
        let judged = |hidden: &[&str], found: &[(&str, &[&str])]| judged(&truth(hidden), &diagnosis(found));
        assert_eq!(judged(&[], &[("aging", &[])]), "There was nothing to find.");
        assert_eq!(judged(&["aging"], &[]), "The diagnosis did not name aging.");
        assert_eq!(judged(&["aging"], &[("aging", &[])]), "The diagnosis was right: it named aging.");
        assert_eq!(
            judged(&["aging"], &[("warm-up", &["turn-on", "aging"])]),
            "The diagnosis was right to leave open whether it is warm-up or aging."
        );
        assert_eq!(
            judged(&["aging"], &[("warm-up", &[]), ("aging", &[]), ("turn-on", &[])]),
            "The diagnosis was wrong: it named warm-up first, not aging. It also named aging, turn-on."
        );
    }
}
