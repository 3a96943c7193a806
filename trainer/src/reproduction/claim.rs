//! What the paper says of its two searches, each claim with the measurement that decides it, field by field.
//!
//! Nothing here is an opinion written down beforehand: a verdict is what the seeds of this run say, and "open" when
//! they do not say enough.

use super::contender::{Contender, Field};
use super::trial::{Share, Trial};
use crate::fit::firefly::Generation;

/// A statement that can be counted.
#[derive(Clone, Copy, Debug)]
pub struct Claim {
    /// Where it is made; empty for a question that the paper leaves out.
    pub source: &'static str,
    /// The statement.
    pub statement: &'static str,
    /// The function that it is about; empty for both.
    pub function: &'static str,
    /// What decides it.
    pub measure: Measure,
}

/// What decides a claim on one field.
#[derive(Clone, Copy, Debug)]
pub enum Measure {
    /// More than half of this search's seeds end so.
    Typical(Contender, fn(&Field, &Generation) -> bool),
    /// The first finds the global minimum's basin in more seeds than the second.
    FindsMore(Contender, Contender),
    /// In more than half of the seeds the first one's swarm ends with the lower mean cost.
    EndsLower(Contender, Contender),
}

/// What the seeds say.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// The claim holds.
    Holds,
    /// Its opposite holds.
    Fails,
    /// Too close to tell with so many seeds.
    Open,
}

/// A claim's verdict on one field and the counts behind it.
#[derive(Clone, Copy, Debug)]
pub struct Outcome {
    /// The field.
    pub field: Field,
    /// The verdict.
    pub verdict: Verdict,
    /// Seeds that speak for the claim, or in which its first search succeeds.
    pub share: Share,
    /// Seeds in which its second search succeeds, where one is compared.
    pub against: Option<Share>,
}

use Contender::{FaPrinted, IfaPrinted, IfaRecommended, RandomPoints};

/// The claims of §2.2.3, then the questions that they raise.
pub const CLAIMS: [Claim; 9] = [
    Claim {
        source: "Figure 3a",
        statement: "the FA's best fitness converges to the global minimum of −1",
        function: "Schaffer",
        measure: Measure::Typical(FaPrinted, |field, end| field.function.found(end.best)),
    },
    Claim {
        source: "Figure 3a",
        statement: "its average fitness meanwhile stays around −0.45",
        function: "Schaffer",
        measure: Measure::Typical(FaPrinted, |field, end| {
            field.function.found(end.best) && (end.mean + 0.45).abs() < 0.1
        }),
    },
    Claim {
        source: "Figure 3b",
        statement: "the IFA's best and average fitness both converge to −1",
        function: "Schaffer",
        measure: Measure::Typical(IfaPrinted, |field, end| field.function.found(end.mean)),
    },
    Claim {
        source: "Figure 4",
        statement: "the FA falls to a local minimum and converges around 2",
        function: "Rastrigin",
        measure: Measure::Typical(FaPrinted, |_, end| (end.best - 2.0).abs() < 0.5),
    },
    Claim {
        source: "Figure 4",
        statement: "the IFA finally converges to the global minimum of 0",
        function: "Rastrigin",
        measure: Measure::Typical(IfaPrinted, |field, end| field.function.found(end.best)),
    },
    Claim {
        source: "§2.2.3",
        statement: "the IFA is better at leaving local minima: it finds the global one more often than the FA",
        function: "",
        measure: Measure::FindsMore(IfaPrinted, FaPrinted),
    },
    Claim {
        source: "§2.2.3",
        statement: "the IFA is more stable: its swarm ends with the lower average fitness",
        function: "",
        measure: Measure::EndsLower(IfaPrinted, FaPrinted),
    },
    Claim {
        source: "",
        statement: "the IFA as printed finds the global minimum more often than as many random points",
        function: "",
        measure: Measure::FindsMore(IfaPrinted, RandomPoints),
    },
    Claim {
        source: "",
        statement: "in units of the domain the IFA finds it more often than as printed",
        function: "",
        measure: Measure::FindsMore(IfaRecommended, IfaPrinted),
    },
];

/// A difference of so many standard deviations is no chance; eight fields are compared.
const DEVIATIONS: f64 = 3.0;

impl Claim {
    /// The verdict on each field for which the trials of the measure are there.
    #[must_use]
    pub fn outcomes(&self, trials: &[Trial]) -> Vec<Outcome> {
        let about = |trial: &&Trial| self.function.is_empty() || trial.field.function.name == self.function;
        let of = |contender| trials.iter().filter(about).filter(move |trial| trial.contender == contender);
        match self.measure {
            Measure::Typical(contender, ends) => {
                of(contender).map(|trial| typical(trial.field, trial.share(|end| ends(&trial.field, end)))).collect()
            }
            Measure::FindsMore(first, second) => of(first).zip(of(second)).map(|(a, b)| finds_more(a, b)).collect(),
            Measure::EndsLower(first, second) => of(first).zip(of(second)).map(|(a, b)| ends_lower(a, b)).collect(),
        }
    }
}

fn typical(field: Field, share: Share) -> Outcome {
    let [low, high] = share.interval_percent();
    let verdict = match () {
        () if low > 50.0 => Verdict::Holds,
        () if high < 50.0 => Verdict::Fails,
        () => Verdict::Open,
    };
    Outcome { field, verdict, share, against: None }
}

fn finds_more(first: &Trial, second: &Trial) -> Outcome {
    let (share, against) = (first.found(), second.found());
    let deviations = share.deviations_above(against);
    let verdict = match () {
        () if deviations > DEVIATIONS => Verdict::Holds,
        () if deviations < -DEVIATIONS => Verdict::Fails,
        () => Verdict::Open,
    };
    Outcome { field: first.field, verdict, share, against: Some(against) }
}

fn ends_lower(first: &Trial, second: &Trial) -> Outcome {
    let pairs = first.ends.iter().zip(&second.ends);
    let hits = pairs.filter(|(a, b)| a.mean < b.mean).count();
    typical(first.field, Share { hits, of: first.ends.len() })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::reproduction::contender::FIELDS;

    fn trial(contender: Contender, costs: &[f64]) -> Trial {
        let ends = costs.iter().map(|&cost| Generation { best: cost, mean: cost }).collect();
        Trial { contender, field: FIELDS[4], evaluations: 0.0, ends, evolution: None }
    }

    fn verdict(claim: &Claim, trials: &[Trial]) -> Verdict {
        claim.outcomes(trials)[0].verdict
    }

    #[test]
    fn verdicts_follow_the_counts_and_few_seeds_decide_nothing() {
        let (good, bad) = ([0.1; 200], [1.0; 200]);
        let pair = |ifa: &[f64], fa: &[f64]| vec![trial(FaPrinted, fa), trial(IfaPrinted, ifa)];
        let more_often = &CLAIMS[5];
        assert_eq!(verdict(more_often, &pair(&good, &bad)), Verdict::Holds);
        assert_eq!(verdict(more_often, &pair(&bad, &good)), Verdict::Fails);
        assert_eq!(verdict(more_often, &pair(&good, &good)), Verdict::Open);
        assert_eq!(verdict(more_often, &pair(&good[..3], &bad[..3])), Verdict::Open);
        let converges = &CLAIMS[4];
        assert_eq!(verdict(converges, &pair(&good, &bad)), Verdict::Holds);
        assert_eq!(verdict(converges, &pair(&bad, &bad)), Verdict::Fails);
        let more_stable = &CLAIMS[6];
        assert_eq!(verdict(more_stable, &pair(&good, &bad)), Verdict::Holds);
    }

    #[test]
    fn a_claim_about_one_function_is_not_asked_of_the_other() {
        let trials = [trial(FaPrinted, &[0.0]), trial(IfaPrinted, &[0.0])];
        for claim in CLAIMS {
            assert_eq!(claim.outcomes(&trials).is_empty(), claim.function == "Schaffer" || claim.source.is_empty());
        }
    }
}
