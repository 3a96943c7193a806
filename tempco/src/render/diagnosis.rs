//! A diagnosis as text for people: the verdict in a sentence, then what it rests on.

use crate::table::Table;
use firmware_core::effect::{About, about};
use std::fmt::Write;
use trainer::diagnose::{
    Dependence, Diagnosis, Estimate, Finding, Judged, LEAST_DELTA_BIC, Noise, Unexplained, Unobservable, Verdict,
};

/// The whole diagnosis; `all` lists every effect that was judged.
pub fn text(diagnosis: &Diagnosis, all: bool) -> String {
    let mut text = short(diagnosis);
    if all {
        text += &candidates(&diagnosis.candidates);
    }
    text += &dependences(&diagnosis.dependences);
    text += &noise(&diagnosis.noise);
    text += &unobservable(&diagnosis.unobservable);
    text
}

/// The verdict and what is missing, without what it rests on.
pub fn short(diagnosis: &Diagnosis) -> String {
    format!("{}\n{}", verdict(diagnosis), findings(&diagnosis.findings))
}

/// The first finding that an instrument can take out.
pub fn first_to_add(diagnosis: &Diagnosis) -> Option<&str> {
    let on_device = |name: &&str| about(name).is_some_and(About::is_on_device);
    diagnosis.findings.iter().map(|finding| finding.effect.as_str()).find(on_device)
}

/// How far the residual falls with the findings, and where to.
fn falls(diagnosis: &Diagnosis, with: &str) -> String {
    let Diagnosis { residual_ug, residual_after_ug, predictable_ug, predictable_after_ug, .. } = diagnosis;
    let verb = if residual_after_ug < residual_ug { "falls" } else { "goes" };
    // A run's own offset can be larger than all that a model can do about the rest.
    let predictable = if predictable_ug == residual_ug {
        String::new()
    } else {
        format!(
            ";\nwithout what is new in every run (offset, mounting, initial states of effects with a memory) from \
             {predictable_ug:.2} to {predictable_after_ug:.2} µg"
        )
    };
    format!(
        "{with}, the held-out residual {verb} from {residual_ug:.2} to {residual_after_ug:.2} µg{predictable}: {:.0} % of \
         what exceeds the noise.\nNoise from sample to sample is {:.2} µg.",
        diagnosis.explainable * 100.0,
        diagnosis.noise_floor_ug
    )
}

/// The answer in a sentence or two.
pub fn verdict(diagnosis: &Diagnosis) -> String {
    let Diagnosis { verdict, findings, residual_ug, noise_floor_ug, .. } = diagnosis;
    let found: Vec<&str> = findings.iter().map(|finding| finding.effect.as_str()).collect();
    let with = match (verdict, found.len()) {
        (Verdict::Ambiguous, 1) => "With the first named",
        (Verdict::Ambiguous, _) => "With the first named of each",
        (_, 1) => "With it",
        _ => "With them",
    };
    let falls = falls(diagnosis, with);
    let mut text = match verdict {
        Verdict::NothingMissing => format!(
            "Nothing is missing that this campaign could show: the held-out residual of {residual_ug:.2} µg is noise.\n\
             Noise from sample to sample is {noise_floor_ug:.2} µg."
        ),
        Verdict::Unexplained if found.is_empty() => {
            format!("Something is missing that no known effect explains; the held-out residual is {residual_ug:.2} µg.")
        }
        Verdict::Unexplained => format!("More is missing than {}.\n{falls}", list(&found, "and")),
        Verdict::Missing => format!("Missing: {}.\n{falls}", list(&found, "and")),
        Verdict::Ambiguous => {
            format!("Missing: {}; this campaign can't tell which.\n{falls}", alternatives(findings))
        }
    };
    if let Some(unexplained) = &diagnosis.unexplained {
        let _ = write!(text, "\n{}", structure(unexplained));
    }
    text
}

/// `thermal-lag or thermal-gradient, and aging`
fn alternatives(findings: &[Finding]) -> String {
    let each = findings.iter().map(|finding| {
        let names: Vec<&str> =
            std::iter::once(&finding.effect).chain(&finding.confounded_with).map(String::as_str).collect();
        list(&names, "or")
    });
    each.collect::<Vec<_>>().join(", and ")
}

fn list(names: &[&str], joint: &str) -> String {
    match names {
        [all @ .., last] if !all.is_empty() => format!("{} {joint} {last}", all.join(", ")),
        _ => names.concat(),
    }
}

fn structure(unexplained: &Unexplained) -> String {
    let Unexplained { depends_on, period_s, formula, residual_ug } = unexplained;
    let mut text = format!("Unexplained: {residual_ug:.2} µg");
    if !depends_on.is_empty() {
        let _ = write!(text, " that follow {}", depends_on.join(", "));
    }
    if let Some(period_s) = period_s {
        let _ = write!(text, ", with a period of {period_s:.0} s");
    }
    if let Some(formula) = formula {
        let _ = write!(text, "; described by {formula}");
    }
    text + "."
}

fn findings(findings: &[Finding]) -> String {
    if findings.is_empty() {
        return String::new();
    }
    let mut table = Table::new(["effect, in the order to add", "held-out before µg", "after µg", "ΔBIC"]);
    for finding in findings {
        table.row([
            finding.effect.clone(),
            format!("{:.2}", finding.residual_before_ug),
            format!("{:.2}", finding.residual_after_ug),
            format!("{:.0}", finding.delta_bic),
        ]);
    }
    let definition = format!(
        "  ΔBIC = twice the log likelihood ratio, less ln n for each parameter; an effect needs {LEAST_DELTA_BIC:.0}"
    );
    let each: String = findings.iter().map(explained).collect();
    format!("\n{table}{definition}\n{each}")
}

/// What the effect is, how large, and with what it could be confused.
fn explained(finding: &Finding) -> String {
    let mut text = format!("\n{}\n", finding.effect);
    let about = about(&finding.effect);
    if let Some(about) = about {
        let _ = writeln!(text, "  {}\n  {}", about.summary, about.equation);
    }
    let parameters = parameters(finding);
    if !parameters.is_empty() {
        let _ = writeln!(text, "  {}", parameters.join(", "));
    }
    if !finding.confounded_with.is_empty() {
        let names: Vec<&str> = finding.confounded_with.iter().map(String::as_str).collect();
        let _ = writeln!(text, "  Would explain the same: {}.", list(&names, "or"));
    }
    if let Some(experiment) = &finding.separate_by {
        let _ = writeln!(text, "  To tell them apart: {experiment}");
    }
    if about.is_some_and(|about| !about.is_on_device()) {
        let _ = writeln!(text, "  No instrument can predict it: it can be known, not compensated.");
    }
    text
}

/// The parameters in the effect's own order, each with its uncertainty and unit.
pub fn parameters(finding: &Finding) -> Vec<String> {
    ordered(finding, about(&finding.effect)).into_iter().map(parameter).collect()
}

/// The parameters in the effect's own order, with their units.
fn ordered<'a>(finding: &'a Finding, about: Option<&About>) -> Vec<(&'a String, &'a Estimate, &'static str)> {
    let known = about.map_or(&[][..], |about| about.parameters);
    let place = |name: &str| known.iter().position(|parameter| parameter.name == name);
    let unit = |name: &str| place(name).map_or("", |place| known[place].unit);
    let mut all: Vec<_> = finding.parameters.iter().map(|(name, estimate)| (name, estimate, unit(name))).collect();
    all.sort_by_key(|(name, ..)| place(name).unwrap_or(known.len()));
    all
}

fn parameter((name, estimate, unit): (&String, &Estimate, &str)) -> String {
    format!("{name} = {} {unit}", with_sigma(*estimate)).trim_end().to_owned()
}

/// Two digits of the uncertainty, and as many of the value.
fn with_sigma(Estimate { value, sigma }: Estimate) -> String {
    let exponent = |number: f64| number.abs().log10().floor() as i32;
    if !(value.is_finite() && sigma.is_finite() && sigma > 0.0) {
        return format!("{value:.4e}");
    }
    let top = exponent(value.abs().max(sigma));
    let scale = if (-3..6).contains(&top) { 0 } else { top };
    let decimals = (1 + scale - exponent(sigma)).clamp(0, 12) as usize;
    let [value, sigma] = [value, sigma].map(|number| format!("{:.decimals$}", number * 10.0_f64.powi(-scale)));
    if scale == 0 { format!("{value} ± {sigma}") } else { format!("({value} ± {sigma})e{scale}") }
}

fn dependences(dependences: &[Dependence]) -> String {
    if dependences.is_empty() {
        return String::new();
    }
    let mut table = Table::new(["residual that follows", "before µg", "by chance", "after µg", "by chance"]);
    for Dependence { on, before_ug, after_ug, chance_before, chance_after } in dependences {
        let number = |ug: &f64| format!("{ug:.2}");
        table.row([on.clone(), number(before_ug), chance(*chance_before), number(after_ug), chance(*chance_after)]);
    }
    format!("\n{table}")
}

fn chance(probability: f64) -> String {
    if probability < 1e-4 { "< 0.0001".to_owned() } else { format!("{probability:.4}") }
}

fn noise(noise: &Noise) -> String {
    let Noise {
        sample_ug,
        flicker_ug,
        wander_ug,
        walk_ug_per_sqrt_h,
        node_ug,
        position_ug,
        pose_ug,
        turn_ug,
        mounting_ug,
        run_ug,
    } = noise;
    let parts = [
        (flicker_ug, "µg flicker"),
        (wander_ug, "µg wander within hours"),
        (walk_ug_per_sqrt_h, "µg/√h walk"),
        (node_ug, "µg from node to node"),
        (position_ug, "µg per g of tilt from position to position"),
        (pose_ug, "µg from position to position"),
        (turn_ug, "µg per g of tilt within hours"),
        (mounting_ug, "µg per g of tilt from mounting to mounting"),
        (run_ug, "µg from run to run"),
    ];
    let parts = parts.iter().filter(|(size, _)| **size >= 0.005).map(|(size, what)| format!(", {size:.2} {what}"));
    format!("\nNoise used: {sample_ug:.2} µg from sample to sample{}.\n", parts.collect::<String>())
}

/// Every effect that was judged, and what came of it.
fn candidates(all: &[Judged]) -> String {
    let mut table = Table::new(["effect", "ΔBIC", "held-out ratio"]);
    for one in all {
        let ratio = one.held_out_ratio.map_or_else(|| "-".to_owned(), |ratio| format!("{ratio:.3}"));
        table.row([one.effect.clone(), format!("{:.0}", one.delta_bic), ratio]);
    }
    let words = std::iter::once("what came of it".to_owned()).chain(all.iter().map(|one| one.outcome.reason()));
    let lines: String =
        table.to_string().lines().zip(words).map(|(line, words)| format!("{line}  {words}\n")).collect();
    format!(
        "\nEvery effect that was judged\n{lines}  held-out ratio = residual of what was left out with the effect over that \
         without it, what is each run's own aside\n"
    )
}

/// One line a reason: many effects lack the same thing.
fn unobservable(all: &[Unobservable]) -> String {
    if all.is_empty() {
        return String::new();
    }
    let mut reasons: Vec<(&str, Vec<&str>)> = Vec::new();
    for Unobservable { effect, why } in all {
        match reasons.iter_mut().find(|(reason, _)| reason == why) {
            Some((_, effects)) => effects.push(effect),
            None => reasons.push((why, vec![effect])),
        }
    }
    let lines = reasons.iter().map(|(why, effects)| format!("  {}: {why}\n", effects.join(", ")));
    format!("\nWhat this campaign can't show:\n{}", lines.collect::<String>())
}

#[cfg(test)]
mod tests {
    use super::*;
    use trainer::diagnose::Outcome;

    #[test]
    fn a_value_has_the_digits_that_its_uncertainty_allows() {
        for (value, sigma, text) in [
            (44.8321, 0.4162, "44.83 ± 0.42"),
            (-1234.6, 87.0, "-1235 ± 87"),
            (1.2345e-6, 3.21e-8, "(1.234 ± 0.032)e-6"),
            (0.001_234, 0.5, "0.00 ± 0.50"),
            (2.5, 0.0, "2.5000e0"),
        ] {
            assert_eq!(with_sigma(Estimate { value, sigma }), text);
        }
    }

    #[test]
    fn every_effect_that_was_judged_has_its_line_and_its_reason() {
        let one = |effect: &str, delta_bic, held_out_ratio, outcome| Judged {
            effect: effect.to_owned(),
            delta_bic,
            held_out_ratio,
            outcome,
        };
        let text = candidates(&[
            one("thermal-lag", 812.4, Some(0.2), Outcome::Found),
            one("thermal-gradient", 90.0, None, Outcome::ExplainedBy("thermal-lag".to_owned())),
        ]);
        assert!(text.contains("\n  thermal-lag        812           0.200  found\n"), "{text}");
        assert!(
            text.contains("\n  thermal-gradient    90               -  explains the same as thermal-lag\n"),
            "{text}"
        );
    }

    #[test]
    fn effects_that_lack_the_same_share_a_line() {
        let one = |effect: &str, why: &str| Unobservable { effect: effect.to_owned(), why: why.to_owned() };
        let all = [one("aging", "3 days"), one("humidity", "no humidity_pct"), one("warm-up", "3 days")];
        let text = unobservable(&all);
        assert!(text.ends_with("  aging, warm-up: 3 days\n  humidity: no humidity_pct\n"), "{text}");
    }
}
