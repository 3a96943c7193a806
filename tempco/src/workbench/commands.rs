//! Every action as the command line that does the same.

use super::session::{Entry, Measured};
use crate::command::train::Training;
use crate::data::{HeldOut, quoted};
use std::path::Path;
use trainer::train::EffectChoice;

pub fn simulate(scenario: &str, seed: u64, output: &Path) -> String {
    format!("tempco simulate {scenario} --blind --effects-at-most 1 --seed {seed} -o {}", word(output))
}

pub fn inspect(data: &str) -> String {
    format!("tempco inspect {data}")
}

pub fn train(measured: &Measured, training: &Training, output: &Path) -> String {
    let hold_out = hold_out(&measured.held_out).into_iter().chain(training.words());
    let options: String = hold_out.map(|word| format!(" {word}")).collect();
    format!("tempco train {}{options} -o {}", measured.data.command_line(), word(output))
}

pub fn compare(file: &Path, data: &str) -> String {
    format!("tempco compare {} {data}", word(file))
}

pub fn diagnose(file: &Path, data: &str) -> String {
    format!("tempco diagnose {} {data}", word(file))
}

/// `add` or `remove`.
pub fn change(verb: &str, entry: &Entry, effect: &EffectChoice, data: &str, output: &Path) -> String {
    let what = match &effect.expression {
        Some(text) => format!("--expression \"{text}\""),
        None => effect.name.clone(),
    };
    format!("tempco {verb} {} {what} {data} -o {}", word(&entry.file), word(output))
}

pub fn export(file: &Path, output: &Path) -> String {
    format!("tempco export {} -o {}", word(file), word(output))
}

pub fn verify(file: &Path, data: &str) -> String {
    format!("tempco verify {} {data}", word(file))
}

pub fn plan(file: &Path, data: &str, output: &Path) -> String {
    format!("tempco plan {} {data} -o {}", word(file), word(output))
}

pub fn reveal(envelope: &Path, campaign: &Path) -> String {
    format!("tempco reveal {} {}", word(envelope), word(campaign))
}

fn hold_out(held_out: &HeldOut) -> Option<String> {
    held_out.hold_out.as_ref().map(|names| format!("--hold-out {}", quoted(&names.join(","))))
}

fn word(path: &Path) -> String {
    quoted(&path.display().to_string())
}
