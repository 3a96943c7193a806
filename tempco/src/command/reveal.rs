//! `tempco reveal campaign.sealed`

use crate::failure::{Answer, Failure};
use crate::shell;
use crate::table::Table;
use crate::terminal::say;
use clap::Args;
use firmware_sim::seal::{CampaignDigest, HiddenEffect, SealError, SealedTruth, open};
use std::path::{Path, PathBuf};

/// Opens the envelope of a blind campaign: which effects it hides, and how much each of them matters.
#[derive(Args)]
#[command(after_help = "Example:  tempco reveal campaign.sealed")]
pub struct Reveal {
    /// Sealed truth, as `tempco simulate --blind` wrote it
    sealed: PathBuf,

    /// The campaign it belongs to [default: the file of the same name with the ending .csv]
    campaign: Option<PathBuf>,

    /// Prints one JSON object instead of text
    #[arg(long)]
    json: bool,
}

impl Reveal {
    pub fn run(&self) -> Result<Answer, Failure> {
        let campaign = self.campaign.clone().unwrap_or_else(|| self.sealed.with_extension("csv"));
        let truth = opened(&self.sealed, &campaign)?;
        if self.json {
            say!("{:#}", json(&truth))?;
        } else {
            say!("{}", words(&truth, &campaign))?;
        }
        Ok(Answer::Yes)
    }
}

/// Opens an envelope that belongs to this campaign.
pub fn opened(sealed: &Path, campaign: &Path) -> Result<SealedTruth, Failure> {
    let text = std::fs::read_to_string(sealed).map_err(|error| Failure::io(sealed, &error))?;
    let digest = CampaignDigest::of([std::fs::read(campaign).map_err(|error| {
        Failure::io(campaign, &error).help(format_args!(
            "name the campaign that the truth belongs to:  tempco reveal {} CAMPAIGN",
            shell::path(sealed)
        ))
    })?]);
    open(&text, &digest).map_err(|error| refused(sealed, campaign, &error))
}

fn refused(sealed: &Path, campaign: &Path, error: &SealError) -> Failure {
    let failure = Failure::new(format_args!("{}: {error}", sealed.display()));
    match error {
        SealError::OtherCampaign { .. } => failure.help(format_args!(
            "{} is another campaign, or was changed since; name the right one:  tempco reveal {} CAMPAIGN",
            campaign.display(),
            shell::path(sealed)
        )),
        SealError::NotSealed { .. } => failure.help("`tempco simulate --blind` writes one beside its campaign"),
        SealError::OtherVersion { .. } => failure.help("open it with the version that sealed it"),
        _ => failure.help("the same scenario and seed with `tempco simulate --blind` give campaign and truth again"),
    }
}

/// What was hidden, in words.
pub fn words(truth: &SealedTruth, campaign: &Path) -> String {
    let SealedTruth { blind_seed, noise_floor_ug, hidden, scenario } = truth;
    let name = scenario.name.trim_end_matches("-blind");
    let what = match hidden.len() {
        0 => "hides nothing".to_owned(),
        1 => "hides 1 effect".to_owned(),
        several => format!("hides {several} effects"),
    };
    let mut text = format!("{} (scenario {name}, seed {blind_seed}) {what}.\n", campaign.display());
    if !hidden.is_empty() {
        text += &format!("\n{}", table(truth));
        text += &format!(
            "  share = scatter that the effect alone leaves behind a perfect static compensation of this campaign; \
             noise {noise_floor_ug:.2} µg\n"
        );
    }
    let is_hidden = |name: &&&str| hidden.iter().any(|effect| effect.name == **name);
    let open: Vec<&str> = scenario.effects.active().iter().filter(|name| !is_hidden(name)).copied().collect();
    if !open.is_empty() {
        text += &format!("The scenario shows openly: {}.\n", open.join(", "));
    }
    text.trim_end().to_owned()
}

fn table(truth: &SealedTruth) -> Table {
    let mut table = Table::new(["effect", "share µg", "times the noise", "parameters"]);
    for hidden in &truth.hidden {
        let parameters: Vec<String> =
            parameters(truth, hidden).iter().map(|(name, value)| format!("{name} = {}", short(value))).collect();
        table.row([
            hidden.name.clone(),
            format!("{:.1}", hidden.influence_ug),
            format!("{:.2}", hidden.times_noise),
            parameters.join(", "),
        ]);
    }
    table
}

/// The parameters of a hidden effect, as a scenario writes them.
fn parameters(truth: &SealedTruth, hidden: &HiddenEffect) -> toml::Table {
    let all = toml::Table::try_from(&truth.scenario.effects).unwrap_or_default();
    all.get(&hidden.name).and_then(toml::Value::as_table).cloned().unwrap_or_default()
}

fn short(value: &toml::Value) -> String {
    match value.as_float() {
        Some(number) if number.abs() >= 1e-3 && number.abs() < 1e6 => {
            let decimals = (3 - number.abs().log10().floor() as i32).clamp(0, 6) as usize;
            let text = format!("{number:.decimals$}");
            if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').to_owned() } else { text }
        }
        Some(number) if number != 0.0 => format!("{number:.3e}"),
        _ => value.to_string(),
    }
}

/// The same for programs.
pub fn json(truth: &SealedTruth) -> serde_json::Value {
    let hidden: Vec<_> = truth
        .hidden
        .iter()
        .map(|hidden| {
            serde_json::json!({
                "effect": hidden.name,
                "share_ug": hidden.influence_ug,
                "times_noise": hidden.times_noise,
                "parameters": parameters(truth, hidden),
            })
        })
        .collect();
    serde_json::json!({
        "scenario": truth.scenario.name.trim_end_matches("-blind"),
        "seed": truth.blind_seed,
        "noise_floor_ug": truth.noise_floor_ug,
        "hidden": hidden,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use firmware_sim::scenario::Scenario;

    #[test]
    fn an_envelope_that_does_not_open_says_what_would() {
        let (sealed, campaign) = (Path::new("a b.sealed"), Path::new("c.csv"));
        let text = |error: SealError| refused(sealed, campaign, &error).to_string();
        let problem = String::new;
        for (error, help) in [
            (
                SealError::OtherCampaign { sealed_for: problem(), found: problem() },
                "c.csv is another campaign, or was changed since; name the right one:  tempco reveal 'a b.sealed' CAMPAIGN",
            ),
            (SealError::NotSealed { expected: "x" }, "`tempco simulate --blind` writes one beside its campaign"),
            (SealError::OtherVersion { problem: problem() }, "open it with the version that sealed it"),
            (SealError::Damaged, "the same scenario and seed with `tempco simulate --blind` give"),
            (SealError::Incomplete { missing: "x" }, "the same scenario and seed with `tempco simulate --blind` give"),
        ] {
            let text = text(error);
            assert!(text.contains("a b.sealed: ") && text.contains(help), "{text}");
        }
    }

    #[test]
    fn what_was_hidden_is_told_apart_from_what_the_scenario_shows() {
        let mut scenario = Scenario::preset("seed-a2").expect("a scenario");
        scenario.name += "-blind";
        let hidden = |name: &str| HiddenEffect { name: name.to_owned(), influence_ug: 12.34, times_noise: 2.468 };
        let truth = |hidden: Vec<HiddenEffect>| SealedTruth {
            blind_seed: 7,
            noise_floor_ug: 4.997,
            hidden,
            scenario: scenario.clone(),
        };
        let words = |hidden| words(&truth(hidden), Path::new("c.csv"));
        let none = words(Vec::new());
        assert_eq!(
            none,
            "c.csv (scenario seed-a2, seed 7) hides nothing.\nThe scenario shows openly: thermal-lag, warm-up, turn-on."
        );
        let one = words(vec![hidden("warm-up")]);
        let lines: Vec<&str> = one.lines().collect();
        assert_eq!((lines[0], lines[1]), ("c.csv (scenario seed-a2, seed 7) hides 1 effect.", ""));
        let row: Vec<&str> = lines[3].split_whitespace().collect();
        assert_eq!(
            row.join(" "),
            "warm-up 12.3 2.47 bias_ug = 140, self_heating_k = 0.0, self_heating_tau_s = 900, tau_s = 600",
            "{one}"
        );
        assert!(lines[4].starts_with("  share = ") && lines[4].ends_with("; noise 5.00 µg"), "{one}");
        assert_eq!(lines[5..], ["The scenario shows openly: thermal-lag, turn-on."]);
        let all = words(["thermal-lag", "warm-up", "turn-on"].map(hidden).to_vec());
        assert!(all.contains("hides 3 effects.") && !all.contains("openly"), "{all}");
        let value = json(&truth(vec![hidden("warm-up")]));
        let expected = serde_json::json!({
            "scenario": "seed-a2", "seed": 7, "noise_floor_ug": 4.997,
            "hidden": [{ "effect": "warm-up", "share_ug": 12.34, "times_noise": 2.468,
                "parameters": { "bias_ug": 140.0, "self_heating_k": 0.0, "self_heating_tau_s": 900.0, "tau_s": 600.0 } }],
        });
        assert_eq!(value, expected);
    }

    #[test]
    fn a_parameter_has_four_digits_and_no_zeros_behind_them() {
        for (value, text) in [
            (0.0, "0.0"),
            (35.0, "35"),
            (1234.56, "1235"),
            (100.0, "100"),
            (-0.012_345_6, "-0.01235"),
            (0.001, "0.001"),
            (0.000_999, "9.990e-4"),
            (-1e6, "-1.000e6"),
            (999_999.0, "999999"),
            (12.3, "12.3"),
        ] {
            assert_eq!(short(&toml::Value::Float(value)), text, "{value}");
        }
        assert_eq!(short(&toml::Value::Integer(5)), "5");
    }
}
