//! The paper's claims with what the seeds say, in words.

use std::fmt::Write;
use trainer::reproduction::claim::{CLAIMS, Claim, Measure, Outcome, Verdict};
use trainer::reproduction::trial::{Share, Trial};

/// All claims.
pub fn text(trials: &[Trial]) -> String {
    let mut text = String::from("\nWhat the paper says of the two, counted on these seeds\n");
    for claim in CLAIMS.iter().filter(|claim| !claim.source.is_empty()) {
        text += &one(claim, trials);
    }
    text += "\nWhat it leaves out\n";
    for claim in CLAIMS.iter().filter(|claim| claim.source.is_empty()) {
        text += &one(claim, trials);
    }
    text
}

fn one(claim: &Claim, trials: &[Trial]) -> String {
    let outcomes = claim.outcomes(trials);
    let source = if claim.source.is_empty() { String::new() } else { format!("{}: ", claim.source) };
    let mut text = format!("  {source}{}\n", claim.statement);
    for function in ["Schaffer", "Rastrigin"] {
        let here: Vec<&Outcome> = outcomes.iter().filter(|outcome| outcome.field.function.name == function).collect();
        if !here.is_empty() {
            let _ = writeln!(text, "    {function:9}  {}", verdicts(&claim.measure, &here));
        }
    }
    text
}

/// The domains grouped by verdict: "holds on |x| ≤ 1 (99.8 %); fails on |x| ≤ 2 (59 %), 5 (1 %)".
fn verdicts(measure: &Measure, outcomes: &[&Outcome]) -> String {
    let group = |verdict: Verdict| {
        let domains: Vec<String> =
            outcomes.iter().filter(|outcome| outcome.verdict == verdict).map(|outcome| domain(outcome)).collect();
        (!domains.is_empty()).then(|| format!("{} |x| ≤ {}", words(measure, verdict), domains.join(", ")))
    };
    let groups: Vec<String> = [Verdict::Holds, Verdict::Open, Verdict::Fails].into_iter().filter_map(group).collect();
    groups.join("; ")
}

const fn words(measure: &Measure, verdict: Verdict) -> &'static str {
    match (measure, verdict) {
        (Measure::FindsMore(..), Verdict::Fails) => "the opposite holds for",
        (Measure::FindsMore(..), Verdict::Open) => "no difference to be seen for",
        (_, Verdict::Holds) => "holds for",
        (_, Verdict::Open) => "as often as not for",
        (_, Verdict::Fails) => "does not hold for",
    }
}

fn domain(outcome: &Outcome) -> String {
    let against = outcome.against.map(|share| format!(" against {}", percent(share))).unwrap_or_default();
    format!("{} ({}{against} %)", outcome.field.half_width, percent(outcome.share))
}

/// In per cent, with a decimal where it matters.
pub fn percent(share: Share) -> String {
    let value = share.percent();
    if value > 0.0 && value < 9.95 { format!("{value:.1}") } else { format!("{value:.0}") }
}

#[cfg(test)]
mod tests {
    use super::*;
    use trainer::reproduction::contender::{Contender, FIELDS};
    use trainer::reproduction::trial::trial;

    #[test]
    fn a_share_has_a_decimal_below_ten_per_cent_and_none_above_or_of_nothing() {
        for (hits, text) in [(0, "0"), (1, "0.1"), (99, "9.9"), (100, "10"), (555, "56"), (1000, "100")] {
            assert_eq!(percent(Share { hits, of: 1000 }), text);
        }
        assert_eq!(percent(Share { hits: 995, of: 10_000 }), "10");
    }

    #[test]
    fn claims_of_the_paper_come_first_and_each_speaks_of_its_own_functions() {
        let trials = |contender| FIELDS.map(|field| trial(contender, field, 3, 1).expect("a field with extent"));
        let trials: Vec<Trial> = Contender::ALL.into_iter().flat_map(trials).collect();
        let text = text(&trials);
        let (theirs, open) = text.split_once("\nWhat it leaves out\n").expect("two parts");
        assert!(theirs.starts_with("\nWhat the paper says of the two, counted on these seeds\n"), "{text}");
        for claim in CLAIMS {
            let part = if claim.source.is_empty() { open } else { theirs };
            let source = if claim.source.is_empty() { String::new() } else { format!("{}: ", claim.source) };
            let heading = format!("  {source}{}\n", claim.statement);
            let (_, rest) = part.split_once(&heading).unwrap_or_else(|| panic!("{heading}{text}"));
            let functions: Vec<&str> = rest
                .lines()
                .take_while(|line| line.starts_with("    "))
                .map(|line| line.split_whitespace().next().unwrap_or_default())
                .collect();
            let expected = if claim.function.is_empty() { vec!["Schaffer", "Rastrigin"] } else { vec![claim.function] };
            assert_eq!(functions, expected, "{heading}{text}");
            assert_eq!(text.matches(&heading).count(), 1, "{text}");
        }
    }

    #[test]
    fn domains_stand_together_by_what_the_seeds_say_of_them() {
        let of = |index: usize, verdict: Verdict, hits: usize, against: Option<usize>| {
            let share = |hits| Share { hits, of: 100 };
            Outcome { field: FIELDS[index], verdict, share: share(hits), against: against.map(share) }
        };
        let outcomes = [
            of(0, Verdict::Fails, 3, Some(40)),
            of(1, Verdict::Holds, 90, Some(20)),
            of(2, Verdict::Open, 50, Some(51)),
            of(3, Verdict::Holds, 80, Some(7)),
        ];
        let outcomes: Vec<&Outcome> = outcomes.iter().collect();
        let (more, other) = (
            Measure::FindsMore(Contender::IfaPrinted, Contender::FaPrinted),
            CLAIMS.iter().map(|claim| &claim.measure).find(|measure| !matches!(measure, Measure::FindsMore(..))),
        );
        assert_eq!(
            verdicts(&more, &outcomes),
            "holds for |x| ≤ 2 (90 against 20 %), 10 (80 against 7.0 %); no difference to be seen for |x| ≤ 5 (50 \
             against 51 %); the opposite holds for |x| ≤ 1 (3.0 against 40 %)"
        );
        let alone = of(0, Verdict::Fails, 3, None);
        assert_eq!(verdicts(other.expect("a claim of one search"), &[&alone]), "does not hold for |x| ≤ 1 (3.0 %)");
    }
}
