//! Whether a diagnosis is right.

use serde::Serialize;
use trainer::diagnose::{Diagnosis, Finding, Verdict};

/// Names in a set of more than this say nothing.
const HONEST: usize = 2;

/// What was right and what was wrong.
#[derive(Clone, Debug, Serialize)]
pub struct Judgement {
    /// In a word.
    pub outcome: Outcome,
    /// The first effect named.
    pub first: Option<String>,
    /// How many effects share the first place.
    pub set: usize,
    /// Every hidden effect is in a finding or in its set of at most two.
    pub all_found: bool,
    /// The first effect named is hidden; none is named where none is.
    pub named: bool,
    /// The first set has at most two names, and one of them is hidden.
    pub in_set: bool,
    /// Findings that stand for nothing hidden.
    pub additions: Vec<String>,
}

/// The answer in a word.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Outcome {
    /// The first name is right.
    Named,
    /// The right name shares the first place, with one other.
    InSet,
    /// It shares it with more.
    InLargerSet,
    /// Something else is named first.
    Wrong,
    /// Nothing is said to be missing.
    Nothing,
    /// Something is said to be missing, but not what.
    Unexplained,
}

/// Compares what was found with what is hidden. An effect `in_the_open` is neither right nor wrong to name.
pub fn judge(diagnosis: &Diagnosis, hidden: &[&str], in_the_open: Option<&str>) -> Judgement {
    let findings: Vec<&Finding> =
        diagnosis.findings.iter().filter(|finding| in_the_open != Some(finding.effect.as_str())).collect();
    let set = findings.first().map(|first| names(first)).unwrap_or_default();
    let first = set.first().copied();
    let named = first.map_or(hidden.is_empty(), |first| hidden.contains(&first));
    let in_first_set = set.iter().any(|name| hidden.contains(name));
    let (additions, found) = matched(&findings, hidden);
    Judgement {
        outcome: outcome(diagnosis.verdict, first.is_some() && named, in_first_set, set.len(), first.is_some()),
        first: first.map(str::to_owned),
        set: set.len(),
        all_found: found == hidden.len(),
        named,
        in_set: in_first_set && set.len() <= HONEST,
        additions,
    }
}

fn names(finding: &Finding) -> Vec<&str> {
    std::iter::once(&finding.effect).chain(&finding.confounded_with).map(String::as_str).collect()
}

fn outcome(verdict: Verdict, named: bool, in_first_set: bool, set: usize, any: bool) -> Outcome {
    match (verdict, any) {
        (_, true) if named => Outcome::Named,
        (_, true) if in_first_set && set <= HONEST => Outcome::InSet,
        (_, true) if in_first_set => Outcome::InLargerSet,
        (_, true) => Outcome::Wrong,
        (Verdict::Unexplained, false) => Outcome::Unexplained,
        (_, false) => Outcome::Nothing,
    }
}

/// Findings that stand for nothing hidden, and how many of the hidden effects have a finding. Each hidden effect
/// accounts for one finding: by name, or else as one of at most two.
fn matched(findings: &[&Finding], hidden: &[&str]) -> (Vec<String>, usize) {
    let mut left: Vec<&str> = hidden.to_vec();
    let mut take = |fits: &dyn Fn(&str) -> bool| match left.iter().position(|name| fits(name)) {
        Some(place) => {
            left.remove(place);
            true
        }
        None => false,
    };
    let by_name: Vec<bool> = findings.iter().map(|finding| take(&|name| finding.effect == name)).collect();
    let mut additions = Vec::new();
    for (finding, by_name) in findings.iter().zip(by_name) {
        let set = names(finding);
        let right = by_name || set.len() <= HONEST && take(&|name| set.contains(&name));
        if !right {
            additions.push(finding.effect.clone());
        }
    }
    (additions, hidden.len() - left.len())
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeMap;
    use trainer::diagnose::Noise;

    /// Each finding: its name, and what it is confounded with.
    fn diagnosis(verdict: Verdict, findings: &[(&str, &[&str])]) -> Diagnosis {
        let finding = |&(effect, others): &(&str, &[&str])| Finding {
            effect: effect.to_owned(),
            residual_before_ug: 20.0,
            residual_after_ug: 5.0,
            delta_bic: 100.0,
            parameters: BTreeMap::new(),
            confounded_with: others.iter().map(ToString::to_string).collect(),
            separate_by: None,
        };
        Diagnosis {
            verdict,
            residual_ug: 20.0,
            residual_after_ug: 5.0,
            noise_floor_ug: 5.0,
            predictable_ug: 10.0,
            predictable_after_ug: 5.0,
            explainable: 1.0,
            findings: findings.iter().map(finding).collect(),
            candidates: Vec::new(),
            unobservable: Vec::new(),
            unexplained: None,
            dependences: Vec::new(),
            noise: Noise {
                sample_ug: 5.0,
                flicker_ug: 0.0,
                wander_ug: 0.0,
                walk_ug_per_sqrt_h: 0.0,
                position_ug: 0.0,
                pose_ug: 0.0,
                turn_ug: 0.0,
                node_ug: 0.0,
                mounting_ug: 0.0,
                run_ug: 0.0,
            },
        }
    }

    #[test]
    fn one_hidden_effect_is_named_or_shares_a_set_or_is_missed() {
        type Case<'a> = (&'a [(&'a str, &'a [&'a str])], Outcome, bool, &'a [&'a str]);
        let table: [Case; 7] = [
            (&[("aging", &[])], Outcome::Named, true, &[]),
            (&[("aging", &["humidity", "pressure"])], Outcome::Named, false, &[]),
            (&[("humidity", &["aging"])], Outcome::InSet, true, &[]),
            (&[("humidity", &["aging", "pressure"])], Outcome::InLargerSet, false, &["humidity"]),
            (&[("humidity", &[])], Outcome::Wrong, false, &["humidity"]),
            (&[("humidity", &[]), ("aging", &[])], Outcome::Wrong, false, &["humidity"]),
            (&[("turn-on", &[]), ("aging", &[]), ("humidity", &["aging"])], Outcome::Named, true, &["humidity"]),
        ];
        for (findings, outcome, in_set, additions) in table {
            let judgement = judge(&diagnosis(Verdict::Missing, findings), &["aging"], Some("turn-on"));
            assert_eq!((judgement.outcome, judgement.in_set), (outcome, in_set), "{findings:?}");
            assert_eq!(judgement.additions, additions, "{findings:?}");
        }
    }

    #[test]
    fn both_of_a_pair_need_a_finding_each() {
        type Case<'a> = (&'a [(&'a str, &'a [&'a str])], bool);
        let table: [Case; 4] = [
            (&[("humidity", &[]), ("aging", &[])], true),
            (&[("aging", &[]), ("pressure", &["humidity"])], true),
            (&[("aging", &["humidity"])], false),
            (&[("aging", &[]), ("pressure", &["humidity", "warm-up"])], false),
        ];
        for (findings, all_found) in table {
            let judgement = judge(&diagnosis(Verdict::Missing, findings), &["aging", "humidity"], None);
            assert_eq!(judgement.all_found, all_found, "{findings:?}");
        }
    }

    #[test]
    fn where_nothing_is_found_the_verdict_says_whether_anything_is_there() {
        for (verdict, outcome) in
            [(Verdict::NothingMissing, Outcome::Nothing), (Verdict::Unexplained, Outcome::Unexplained)]
        {
            assert_eq!(judge(&diagnosis(verdict, &[]), &[], None).outcome, outcome);
        }
    }
}
