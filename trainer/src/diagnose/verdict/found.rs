//! What has been found so far.

use crate::diagnose::answer::{Judged, Outcome};
use crate::diagnose::forward::{EffectSet, name_of};
use crate::diagnose::problem::{NoiseModels, Problem};
use crate::diagnose::selection::{Contender, Found};
use crate::diagnose::thresholds::LEAST_DELTA_BIC;

/// What was found, one after the other.
pub struct Findings<'a> {
    /// All effects, those that the model has first.
    pub known: EffectSet,
    /// The problem seen from where they are at work.
    pub problem: Problem<'a>,
    /// In the order in which they were found.
    pub steps: Vec<Found>,
    /// The noise with all of them.
    pub noises: NoiseModels,
    /// Largest ΔBIC of what would have to leave its physical bounds, at the end.
    pub at_bound: f64,
    /// A channel's course that explains what no effect does.
    pub formula: Option<Contender>,
    /// Every effect that was judged, and what came of it so far.
    pub judged: Vec<Judged>,
}

impl<'a> Findings<'a> {
    /// Nothing beside what is known.
    pub fn nothing_yet(problem: Problem<'a>, known: EffectSet, noises: NoiseModels) -> Self {
        Self {
            known,
            problem,
            steps: Vec::new(),
            noises,
            at_bound: f64::NEG_INFINITY,
            formula: None,
            judged: Vec::new(),
        }
    }

    /// Takes note of what came of each effect in another search: one that had a say before an effect was found, and has none
    /// beside it, explains the same.
    pub fn trace(&mut self, judged: Vec<Judged>) {
        let last = self.steps.last().map(|step| name_of(&step.winner.effect).to_owned());
        for next in judged {
            let Some(before) = self.judged.iter_mut().find(|one| one.effect == next.effect) else {
                self.judged.push(next);
                continue;
            };
            match &last {
                Some(last) if before.delta_bic >= LEAST_DELTA_BIC && next.delta_bic < LEAST_DELTA_BIC => {
                    before.outcome = Outcome::ExplainedBy(last.clone());
                }
                _ => *before = next,
            }
        }
        self.judged.sort_by(|a, b| b.delta_bic.total_cmp(&a.delta_bic));
    }

    /// Every effect with what came of it in the end: the findings were found, and what was found for a while was made
    /// superfluous by what came later.
    pub fn told(&self) -> Vec<Judged> {
        let is_finding = |one: &Judged| self.steps.iter().any(|step| name_of(&step.winner.effect) == one.effect);
        let in_the_end = |one: &Judged| match &one.outcome {
            _ if is_finding(one) => Outcome::Found,
            Outcome::Found => Outcome::Superfluous,
            other => other.clone(),
        };
        self.judged.iter().map(|one| Judged { outcome: in_the_end(one), ..one.clone() }).collect()
    }

    /// Corrects what came of an effect.
    pub fn outcome_of(&mut self, effect: &str, outcome: &Outcome) {
        self.judged.iter_mut().filter(|one| one.effect == effect).for_each(|one| one.outcome = outcome.clone());
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnose::example::{Recipe, effect, problem, white};

    fn judged(effect: &str, delta_bic: f64) -> Judged {
        let outcome = if delta_bic < LEAST_DELTA_BIC { Outcome::Weak } else { Outcome::NotPredictive };
        Judged { effect: effect.to_owned(), delta_bic, held_out_ratio: None, outcome }
    }

    #[test]
    fn what_has_no_say_beside_a_finding_is_explained_by_it_and_the_rest_is_told_as_it_is_last() {
        let campaign = Recipe::default().campaign();
        let problem = problem(&campaign);
        let noises = white(&problem, &EffectSet::NONE, 5.0);
        let mut found = Findings::nothing_yet(problem, EffectSet::NONE, noises.clone());
        found.trace(vec![judged("thermal-lag", 900.0), judged("thermal-gradient", 300.0), judged("warm-up", 3.0)]);
        found.outcome_of("thermal-lag", &Outcome::Found);
        let winner = Contender {
            effect: effect("thermal-lag", &campaign),
            values: vec![60.0],
            delta_bic: 900.0,
            noises: None,
            determined: true,
        };
        found.steps.push(Found { winner, rivals: Vec::new(), noises });
        found.trace(vec![judged("thermal-gradient", 4.0), judged("warm-up", 30.0), judged("aging", -5.0)]);
        let told: Vec<(&str, f64, &str)> =
            found.judged.iter().map(|one| (one.effect.as_str(), one.delta_bic, one.outcome.word())).collect();
        assert_eq!(
            told,
            [
                ("thermal-lag", 900.0, "found"),
                ("thermal-gradient", 300.0, "explained"),
                ("warm-up", 30.0, "not-predictive"),
                ("aging", -5.0, "weak")
            ]
        );
        assert_eq!(found.judged[1].outcome.reason(), "explains the same as thermal-lag");
        // What a later search finds again was dropped before, unless it is among the findings.
        found.outcome_of("warm-up", &Outcome::Found);
        let outcomes: Vec<&str> = found.told().iter().map(|one| one.outcome.word()).collect();
        assert_eq!(outcomes, ["found", "explained", "superfluous", "weak"]);
    }
}
