//! Every action as the command line that does the same.

use super::entry::Entry;
use super::measured::Measured;
use crate::command::train::Training;
use crate::shell::{self, option, word};
use std::path::Path;
use trainer::train::EffectChoice;

pub fn simulate(scenario: &str, seed: u64, output: &Path) -> String {
    format!("tempco simulate {scenario} --blind --effects-at-most 1 --seed {seed} -o {}", shell::path(output))
}

pub fn inspect(data: &str) -> String {
    format!("tempco inspect {data}")
}

/// Without the model's place: see [`into`].
pub fn train(measured: &Measured, training: &Training) -> String {
    let hold_out = measured.held_out.words(&measured.campaign).into_iter().chain(training.words());
    let options: String = hold_out.map(|word| format!(" {word}")).collect();
    format!("tempco train {}{options}", measured.data.command_line())
}

pub fn compare(file: &Path, data: &str) -> String {
    format!("tempco compare {} {data}", shell::path(file))
}

pub fn diagnose(file: &Path, data: &str) -> String {
    format!("tempco diagnose {} {data}", shell::path(file))
}

/// `add` or `remove`, without the new model's place: see [`into`].
pub fn change(verb: &str, entry: &Entry, effect: &EffectChoice, data: &str) -> String {
    let what = effect.expression.as_ref().map_or_else(|| word(&effect.name), |text| option("--expression", text));
    format!("tempco {verb} {} {what} {data}", shell::path(&entry.file))
}

/// A command that writes there.
pub fn into(command: &str, output: &Path) -> String {
    format!("{command} -o {}", shell::path(output))
}

/// Both formats.
pub fn export(file: &Path, hex: &Path, bin: &Path) -> String {
    let command = format!("tempco export {}", shell::path(file));
    format!("{} && {}", into(&command, hex), into(&command, bin))
}

pub fn verify(file: &Path, data: &str) -> String {
    format!("tempco verify {} {data}", shell::path(file))
}

/// Without the folder: see [`into`].
pub fn plan(file: &Path, data: &str) -> String {
    format!("tempco plan {} {data}", shell::path(file))
}

/// A rehearsal of what was planned.
pub fn rehearse(scenario: &Path) -> String {
    format!("tempco simulate {} -o new.csv", shell::path(scenario))
}

pub fn reveal(envelope: &Path, campaign: &Path) -> String {
    format!("tempco reveal {} {}", shell::path(envelope), shell::path(campaign))
}
