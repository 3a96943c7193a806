//! The selection driver: from noise and candidates through one finding after the other to the verdict.

mod findings;
mod found;
mod rest;

use super::answer::{Diagnosis, Verdict};
use super::error::DiagnoseError;
use super::forward::{EffectSet, name_of};
use super::lack_of_fit::{dependences, lack_of_fit, largest_alternative};
use super::noise::reported;
use super::problem::{
    GlsPair, NoiseModels, Problem, constrained, estimate, fit, fixed, free, in_model, initial_states, problem, refine,
};
use super::selection::{Candidate, Found, Screening, held_out, missing, most_predictive, unobservable, with_channels};
use super::thresholds::{JOINT_STEPS, LEAST_DELTA_BIC, LOWERED, MOST_FINDINGS, SURELY_AT_BOUND, WEAK_DELTA_BIC};
use crate::campaign::Campaign;
use crate::model::Model;
use crate::progress::Progress;
use crate::yardstick::Yardstick;
use findings::findings;
use found::Findings;
use rest::{explainable, is_structured, unexplained_rest};

/// In the units of `yardstick`, as `campaign` is.
pub(super) fn judge(
    model: &Model,
    campaign: &Campaign,
    yardstick: &Yardstick,
    progress: &dyn Progress,
) -> Result<Diagnosis, DiagnoseError> {
    let problem = problem(model, campaign, yardstick)?;
    let start = settled(&problem, in_model(model, campaign, yardstick)?)?;
    let candidates = Candidate::all(&problem, &with_channels(campaign));
    let noises = first_noises(&problem, &start);
    let screening = Screening::new(&problem, &start, candidates, &noises).ok_or(DiagnoseError::NoNoise)?;
    let driver = Driver { problem: &problem, start: &start, candidates: &screening.visible };
    let mut found = driver.search(noises, progress)?;
    if let Some(predictive) = driver.predictive(&found) {
        found = predictive;
    }
    let mut diagnosis = driver.answer(campaign, found);
    diagnosis.unobservable = unobservable(campaign, &screening, &start);
    Ok(diagnosis)
}

/// The model's effects as retraining would make them: that is not missing.
fn settled(problem: &Problem, start: EffectSet) -> Result<EffectSet, DiagnoseError> {
    if start.effects.is_empty() {
        return Ok(start);
    }
    let noises = first_noises(problem, &start);
    fitted(problem, &start, &noises).ok_or(DiagnoseError::NoNoise)
}

fn first_noises(problem: &Problem, set: &EffectSet) -> NoiseModels {
    estimate(problem, &problem.forward.residuals(set), &free(problem, set), &initial_states(problem, set))
}

/// The effects with their parameters fitted together.
fn fitted(problem: &Problem, set: &EffectSet, noises: &NoiseModels) -> Option<EffectSet> {
    let gls = GlsPair::new(problem, &problem.forward.residuals(set), &fixed(problem, set), noises)?;
    Some(fit(problem, problem.forward.no_effects(), set, &gls, JOINT_STEPS).0)
}

/// What stays the same while findings are looked for.
struct Driver<'a> {
    problem: &'a Problem<'a>,
    /// What the model has.
    start: &'a EffectSet,
    candidates: &'a [Candidate],
}

impl Driver<'_> {
    fn search(&self, noises: NoiseModels, progress: &dyn Progress) -> Result<Findings, DiagnoseError> {
        let mut found = Findings::nothing_yet(self.start.clone(), noises);
        let mut dropped: Vec<String> = Vec::new();
        while found.steps.len() < MOST_FINDINGS {
            if progress.cancelled() {
                return Err(DiagnoseError::Cancelled);
            }
            let Some(next) = missing(self.problem, &found.known, self.candidates, &found.noises) else { break };
            if next.winner.delta_bic < LEAST_DELTA_BIC
                || dropped.iter().any(|name| name == name_of(&next.winner.effect))
            {
                found.at_bound = next.at_bound;
                found.noises = next.noises;
                break;
            }
            if next.winner.effect.expression.is_some() {
                // No effect that anybody knows follows this channel: it is described, not explained.
                found.formula = Some(next.winner);
                break;
            }
            if self.is_resemblance(&found.known, &next) {
                found.noises = next.noises;
                break;
            }
            self.take(&mut found, next).ok_or(DiagnoseError::NoNoise)?;
            dropped.extend(self.prune(&mut found).ok_or(DiagnoseError::NoNoise)?);
        }
        Ok(found)
    }

    /// The noise with the winner.
    fn noises_with(&self, known: &EffectSet, found: &Found) -> NoiseModels {
        let noises = found.winner.noises.as_ref().unwrap_or(&found.noises);
        noises.beside(&initial_states(self.problem, known))
    }

    /// Whether something that no known effect does is more likely, with this one too: it merely resembles it.
    fn is_resemblance(&self, known: &EffectSet, next: &Found) -> bool {
        let with = known.with(&next.winner.effect, &next.winner.values);
        let is_beaten = |set: &EffectSet, noises: &NoiseModels| {
            largest_alternative(self.problem, set, noises) > next.winner.delta_bic
        };
        next.winner.delta_bic < WEAK_DELTA_BIC
            && is_beaten(known, &next.noises)
            && is_beaten(&with, &self.noises_with(&with, next))
    }

    /// Adds a finding and fits all of them together.
    fn take(&self, found: &mut Findings, next: Found) -> Option<()> {
        let known = found.known.with(&next.winner.effect, &next.winner.values);
        let noises = self.noises_with(&known, &next);
        found.known = fitted(self.problem, &known, &noises)?;
        found.noises = noises.beside(&initial_states(self.problem, &found.known));
        found.steps.push(next);
        Some(())
    }

    /// Takes out again what later findings have made superfluous: an effect that merely resembled them came first.
    fn prune(&self, found: &mut Findings) -> Option<Vec<String>> {
        let mut dropped = Vec::new();
        // The last finding is as good as it was a moment ago; where it is alone, there is nothing to ask.
        while found.steps.len() > 1 {
            let (with, _) = self.refitted(&found.known, &found.noises)?;
            let least = |step: usize| {
                let without = found.known.without(self.start.effects.len() + step);
                let (without, known) = self.refitted(&without, &found.noises)?;
                let parameters = found.steps[step].winner.effect.free().count() as f64;
                Some((without - with - self.problem.parameter_cost() * parameters, step, known))
            };
            let all: Vec<_> = (0..found.steps.len() - 1).map(least).collect::<Option<_>>()?;
            let (delta_bic, step, known) = all.into_iter().min_by(|a, b| a.0.total_cmp(&b.0))?;
            if delta_bic >= LEAST_DELTA_BIC {
                break;
            }
            dropped.push(name_of(&found.steps.remove(step).winner.effect).to_owned());
            found.known = known;
            found.noises = self.refined(&found.known, &found.noises);
        }
        Some(dropped)
    }

    /// −2 log likelihood of these effects, their parameters fitted, and the effects as fitted.
    fn refitted(&self, set: &EffectSet, noises: &NoiseModels) -> Option<(f64, EffectSet)> {
        let (problem, forward) = (self.problem, &self.problem.forward);
        let gls = GlsPair::new(problem, &forward.residuals(set), &fixed(problem, set), noises)?;
        let (set, residuals) = fit(problem, forward.no_effects(), set, &gls, JOINT_STEPS);
        let deviance = GlsPair::new(problem, &residuals, &fixed(problem, &set), noises)?.deviance();
        Some((deviance, set))
    }

    /// The noise beside these effects.
    fn refined(&self, set: &EffectSet, noises: &NoiseModels) -> NoiseModels {
        let noises = noises.beside(&initial_states(self.problem, set));
        let nuisance = constrained(self.problem, set, &noises);
        refine(self.problem, &self.problem.forward.residuals(set), &nuisance, &noises)
    }

    /// Where a large wander hides what likelihood could say, and it named nothing or something weak: the effect that
    /// halves the residual of what was left out, if there is one.
    fn predictive(&self, found: &Findings) -> Option<Findings> {
        let weak =
            found.steps.first().is_none_or(|step| step.winner.delta_bic < WEAK_DELTA_BIC) && found.formula.is_none();
        if !weak || !is_structured(self.problem, &found.noises.delta) {
            return None;
        }
        let step = most_predictive(self.problem, self.start, self.candidates, &found.noises)?;
        let known = self.start.with(&step.winner.effect, &step.winner.values);
        let noises = self.refined(&known, &found.noises);
        Some(Findings { steps: vec![step], ..Findings::nothing_yet(known, noises) })
    }

    fn answer(&self, campaign: &Campaign, mut found: Findings) -> Diagnosis {
        let (problem, start) = (self.problem, self.start);
        let structured = is_structured(problem, &found.noises.delta);
        let predictable_ug = |set: &EffectSet| held_out(problem, set, &found.noises).structure_ug();
        let [before_ug, mut after_ug] = [start, &found.known].map(predictable_ug);
        // Where structure remains, what merely resembles its cause does not predict other runs.
        if structured && after_ug > LOWERED * before_ug {
            found.known = start.clone();
            found.steps.clear();
            after_ug = before_ug;
        }
        let lack_of_fit = lack_of_fit(problem, &found.known, &found.noises, &campaign.channels);
        let unexplained =
            structured || found.at_bound > SURELY_AT_BOUND || found.formula.is_some() || !lack_of_fit.is_empty();
        let dependences = dependences(problem, start, &found.known, &found.noises, &campaign.channels);
        // Predicted as well as the noise without the findings allows.
        let noises = found.steps.first().map_or(&found.noises, |step| &step.noises).beside(&found.noises.initial);
        let residual_ug = held_out(problem, start, &noises).residual_ug;
        let findings = findings(problem, start, &found, residual_ug);
        let verdict = match (findings.is_empty(), unexplained) {
            (true, true) => Verdict::Unexplained,
            (true, false) => Verdict::NothingMissing,
            _ if findings.iter().any(|finding| !finding.confounded_with.is_empty()) => Verdict::Ambiguous,
            _ => Verdict::Missing,
        };
        Diagnosis {
            verdict,
            residual_ug,
            residual_after_ug: findings.last().map_or(residual_ug, |finding| finding.residual_after_ug),
            noise_floor_ug: problem.sample_ug,
            predictable_ug: before_ug,
            predictable_after_ug: after_ug,
            explainable: explainable(before_ug, after_ug, &found.noises.delta),
            findings,
            unobservable: Vec::new(),
            unexplained: unexplained.then(|| unexplained_rest(&found, &lack_of_fit, &dependences, campaign)),
            dependences,
            noise: reported(&found.noises.delta),
        }
    }
}
