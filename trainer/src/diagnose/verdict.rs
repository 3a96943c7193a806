//! The selection driver: from noise and candidates through one finding after the other to the verdict.

mod findings;
mod found;
mod rest;

use super::answer::{Diagnosis, Outcome, Verdict};
use super::error::DiagnoseError;
use super::forward::{EffectSet, name_of};
use super::lack_of_fit::{dependences, lack_of_fit, largest_alternative};
use super::noise::reported;
use super::problem::{
    GlsPair, NoiseModels, Problem, carried, constrained, estimate, fit, fixed, free, in_model, initial_states, problem,
    refine, rescaled,
};
use super::selection::{
    Candidate, Found, HeldOut, Screening, Searched, as_it_is, held_out, inexact, is_worse, missing, most_predictive,
    predicted, reads_worse, unobservable, with_channels,
};
use super::thresholds::{JOINT_STEPS, LEAST_DELTA_BIC, LOWERED, MOST_FINDINGS, SURELY_AT_BOUND, WEAK_DELTA_BIC};
use crate::campaign::Campaign;
use crate::fit::effects::Chosen;
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
    unseen: &[bool],
    progress: &dyn Progress,
) -> Result<Diagnosis, DiagnoseError> {
    let in_model = in_model(model, campaign, yardstick)?;
    let mut problem = problem(model, campaign, yardstick)?;
    if unseen.contains(&true) && unseen.contains(&false) {
        problem.unseen = Some(unseen.to_vec());
    }
    let before = as_it_is(&problem, &in_model, unseen);
    let (problem, start) = settled(problem, in_model)?;
    let shown = with_channels(campaign);
    let noises = first_noises(&problem, &start);
    let screening = Screening::new(&problem, &start, Candidate::all(&problem, &shown), &noises);
    let screening = screening.ok_or(DiagnoseError::NoNoise)?;
    let unobservable = unobservable(campaign, &screening, &start);
    let driver = Driver { problem: &problem, start: &start, before, shown: &shown };
    let mut found = driver.search(screening.visible, noises, progress)?;
    if let Some(predictive) = driver.predictive(&found) {
        found = predictive;
    }
    Ok(Diagnosis { unobservable, ..driver.answer(campaign, found) })
}

/// The model's effects as retraining would make them, and the problem seen from there: that is not missing.
fn settled(problem: Problem, start: EffectSet) -> Result<(Problem, EffectSet), DiagnoseError> {
    if start.effects.is_empty() {
        return Ok((problem, start));
    }
    let noises = first_noises(&problem, &start);
    let (problem, start) = fitted(&problem, &start, &noises).ok_or(DiagnoseError::NoNoise)?;
    Ok((rescaled(problem, &start), start))
}

fn first_noises(problem: &Problem, set: &EffectSet) -> NoiseModels {
    estimate(problem, &problem.forward.residuals(set), &free(problem, set), &initial_states(problem, set))
}

/// The effects with their parameters fitted together, and the problem seen from there.
fn fitted<'a>(problem: &Problem<'a>, set: &EffectSet, noises: &NoiseModels) -> Option<(Problem<'a>, EffectSet)> {
    let mut set = set.clone();
    let mut around = carried(problem, &set, noises)?;
    for _ in 0..JOINT_TURNS {
        let gls = GlsPair::new(&around, &around.forward.residuals(&set), &fixed(&around, &set), noises)?;
        (set, _) = fit(&around, around.forward.no_effects(), &set, &gls, JOINT_STEPS);
        around = carried(problem, &set, noises)?;
    }
    Some((around, set))
}

/// How often parameters of all findings and the map are fitted in turn.
const JOINT_TURNS: usize = 2;

/// What stays the same while findings are looked for.
struct Driver<'a> {
    problem: &'a Problem<'a>,
    /// What the model has.
    start: &'a EffectSet,
    /// What the model reads wrong as it is where training never saw the run; none where it saw all.
    before: Option<HeldOut>,
    /// What the campaign has the channels for.
    shown: &'a [Chosen],
}

impl<'a> Driver<'a> {
    fn search(
        &self,
        mut candidates: Vec<Candidate>,
        noises: NoiseModels,
        progress: &dyn Progress,
    ) -> Result<Findings<'a>, DiagnoseError> {
        let mut found = Findings::nothing_yet(self.problem.clone(), self.start.clone(), noises);
        let mut dropped: Vec<String> = Vec::new();
        while found.steps.len() < MOST_FINDINGS {
            if progress.cancelled() {
                return Err(DiagnoseError::Cancelled);
            }
            let explained: Vec<_> =
                found.steps.iter().map(|step| (step.winner.alone(), step.winner.delta_bic)).collect();
            let searched = missing(&found.problem, &found.known, &explained, &candidates, &found.noises);
            let Searched { found: next, at_bound, noises, judged, best: _ } = searched.ok_or(DiagnoseError::NoNoise)?;
            found.trace(judged);
            let next = next.filter(|next| dropped.iter().all(|name| name != name_of(&next.winner.effect)));
            let Some(next) = next else {
                (found.at_bound, found.noises) = (at_bound, noises);
                break;
            };
            if next.winner.effect.expression.is_some() {
                // No effect that anybody knows follows this channel: it is described, not explained.
                found.formula = Some(next.winner);
                break;
            }
            if self.is_resemblance(&found.problem, &found.known, &next) {
                found.outcome_of(name_of(&next.winner.effect), &Outcome::Resembles);
                found.noises = noises;
                break;
            }
            let name = name_of(&next.winner.effect).to_owned();
            if !self.take(&mut found, next).ok_or(DiagnoseError::NoNoise)? {
                found.outcome_of(&name, &Outcome::NotPredictive);
                break;
            }
            dropped.extend(self.prune(&mut found).ok_or(DiagnoseError::NoNoise)?);
            candidates = self.candidates(&found.problem, &found.known, &found.noises).ok_or(DiagnoseError::NoNoise)?;
        }
        Ok(found)
    }

    /// What may still be missing beside these effects, as it looks from there.
    fn candidates(&self, problem: &Problem, known: &EffectSet, noises: &NoiseModels) -> Option<Vec<Candidate>> {
        Some(Screening::new(problem, known, Candidate::all(problem, self.shown), noises)?.visible)
    }

    /// The noise with the winner.
    fn noises_with(&self, known: &EffectSet, found: &Found) -> NoiseModels {
        let noises = found.winner.noises.as_ref().unwrap_or(&found.noises);
        noises.beside(&initial_states(self.problem, known))
    }

    /// Whether something that no known effect does is more likely, with this one too: it merely resembles it.
    fn is_resemblance(&self, problem: &Problem, known: &EffectSet, next: &Found) -> bool {
        let with = known.with(&next.winner.effect, &next.winner.values);
        let is_beaten = |problem: &Problem, set: &EffectSet, noises: &NoiseModels| {
            largest_alternative(problem, set, noises) > next.winner.delta_bic
        };
        let noises = self.noises_with(&with, next);
        next.winner.delta_bic < WEAK_DELTA_BIC
            && is_beaten(problem, known, &next.noises)
            && carried(self.problem, &with, &noises).is_none_or(|around| is_beaten(&around, &with, &noises))
    }

    /// Adds a finding and fits all of them together; says whether it stays: not where it reads worse what training never saw.
    fn take(&self, found: &mut Findings<'a>, next: Found) -> Option<bool> {
        let known = found.known.with(&next.winner.effect, &next.winner.values);
        let noises = self.noises_with(&known, &next);
        let (problem, known) = fitted(self.problem, &known, &noises)?;
        let [before, after] =
            [(&found.problem, &found.known), (&problem, &known)].map(|(problem, set)| predicted(problem, set, &noises));
        if is_worse(&before, &after) {
            return Some(false);
        }
        (found.problem, found.known) = (rescaled(problem, &known), known);
        found.noises = noises.of(&found.problem).beside(&initial_states(self.problem, &found.known));
        found.steps.push(next);
        Some(true)
    }

    /// Takes out again what later findings have made superfluous: an effect that merely resembled them came first.
    fn prune(&self, found: &mut Findings<'a>) -> Option<Vec<String>> {
        let mut dropped = Vec::new();
        while found.steps.len() > 1 {
            let (with, ..) = self.refitted(&found.known, &found.noises)?;
            let without = |step: usize| {
                let without = found.known.without(self.start.effects.len() + step);
                let (without, problem, known) = self.refitted(&without, &found.noises)?;
                let parameters = found.steps[step].winner.effect.free().count() as f64;
                Some((without - with - self.problem.parameter_cost() * parameters, problem, known))
            };
            let all: Vec<_> = (0..found.steps.len()).map(without).collect::<Option<_>>()?;
            let own: Vec<EffectSet> = found.known.each().skip(self.start.effects.len()).collect();
            let beyond = |step: usize| {
                let others = (0..own.len()).filter(|other| *other != step);
                let others: Vec<_> = others.map(|other| (own[other].clone(), all[other].0)).collect();
                all[step].0 - inexact(&found.problem, &others, &own[step])
            };
            let margins: Vec<f64> = (0..all.len()).map(beyond).collect();
            let (step, delta_bic) = margins.into_iter().enumerate().min_by(|a, b| a.1.total_cmp(&b.1))?;
            let (_, problem, known) = all.into_iter().nth(step)?;
            if delta_bic >= LEAST_DELTA_BIC {
                break;
            }
            dropped.push(name_of(&found.steps.remove(step).winner.effect).to_owned());
            (found.problem, found.known) = (rescaled(problem, &known), known);
            found.noises = self.refined(&found.problem, &found.known, &found.noises);
        }
        Some(dropped)
    }

    /// −2 log likelihood of these effects, map and parameters fitted, and the problem and the effects as fitted.
    fn refitted(&self, set: &EffectSet, noises: &NoiseModels) -> Option<(f64, Problem<'a>, EffectSet)> {
        let (around, set) = fitted(self.problem, set, noises)?;
        let gls = GlsPair::new(&around, &around.forward.residuals(&set), &fixed(&around, &set), noises)?;
        Some((gls.deviance(), around, set))
    }

    /// The noise beside these effects.
    fn refined(&self, problem: &Problem, set: &EffectSet, noises: &NoiseModels) -> NoiseModels {
        let noises = noises.beside(&initial_states(problem, set));
        let nuisance = constrained(problem, set, &noises);
        refine(problem, &problem.forward.residuals(set), &nuisance, &noises)
    }

    /// Where a large wander hides what likelihood could say, and it named nothing or something weak: the effect that
    /// halves the residual of what was left out, if there is one.
    fn predictive(&self, found: &Findings) -> Option<Findings<'a>> {
        let weak =
            found.steps.first().is_none_or(|step| step.winner.delta_bic < WEAK_DELTA_BIC) && found.formula.is_none();
        if !weak || !is_structured(&found.problem, &found.noises.delta) {
            return None;
        }
        let candidates = self.candidates(self.problem, self.start, &found.noises)?;
        let step = most_predictive(self.problem, self.start, &candidates, &found.noises)?;
        let known = self.start.with(&step.winner.effect, &step.winner.values);
        let problem = carried(self.problem, &known, &found.noises)?;
        let noises = self.refined(&problem, &known, &found.noises);
        let judged = found.judged.clone();
        Some(Findings { steps: vec![step], judged, ..Findings::nothing_yet(problem, known, noises) })
    }

    /// Takes all findings back: they do not hold for what was left out.
    fn forget_all(&self, found: &mut Findings<'a>) {
        (found.problem, found.known) = (self.problem.clone(), self.start.clone());
        let names: Vec<String> = found.steps.drain(..).map(|step| name_of(&step.winner.effect).to_owned()).collect();
        names.iter().for_each(|name| found.outcome_of(name, &Outcome::NotPredictive));
    }

    fn answer(&self, campaign: &Campaign, mut found: Findings<'a>) -> Diagnosis {
        let (problem, start) = (self.problem, self.start);
        let structured = is_structured(&found.problem, &found.noises.delta);
        // Where structure remains, what merely resembles its cause does not predict other runs.
        let structure_ug = |problem: &Problem, set: &EffectSet| held_out(problem, set, &found.noises).structure_ug();
        if structured
            && !found.steps.is_empty()
            && structure_ug(&found.problem, &found.known) > LOWERED * structure_ug(problem, start)
        {
            self.forget_all(&mut found);
        }
        // Predicted as well as the noise without the findings allows.
        let noises = found.steps.first().map_or(&found.noises, |step| &step.noises).beside(&found.noises.initial);
        let own = predicted(problem, start, &noises);
        let mut after = (!found.steps.is_empty()).then(|| predicted(&found.problem, &found.known, &found.noises));
        let misleads = after.as_ref().is_some_and(|after| reads_worse(&own, after));
        if misleads {
            self.forget_all(&mut found);
            after = None;
        }
        let before = self.before.as_ref().unwrap_or(&own);
        let (residual_ug, before_ug) = (before.residual_ug, before.structure_ug());
        // What training leaves will fall as much as what is predicted without training falls.
        let ratio = |after: &HeldOut| after.structure_ug() / own.structure_ug();
        let after_ug = after.as_ref().map_or(before_ug, |after| before_ug * ratio(after));
        let lack_of_fit = lack_of_fit(&found.problem, &found.known, &found.noises, &campaign.channels);
        let unexplained = misleads
            || structured
            || found.at_bound > SURELY_AT_BOUND
            || found.formula.is_some()
            || !lack_of_fit.is_empty();
        let dependences =
            dependences((problem, start), (&found.problem, &found.known), &found.noises, &campaign.channels);
        let findings = findings(problem, start, &found, residual_ug, [&own, after.as_ref().unwrap_or(&own)]);
        let residual_after_ug = findings.last().map_or(residual_ug, |finding| finding.residual_after_ug);
        let verdict = match (findings.is_empty(), unexplained) {
            (true, true) => Verdict::Unexplained,
            (true, false) => Verdict::NothingMissing,
            _ if findings.iter().any(|finding| !finding.confounded_with.is_empty()) => Verdict::Ambiguous,
            _ => Verdict::Missing,
        };
        Diagnosis {
            verdict,
            residual_ug,
            residual_after_ug,
            noise_floor_ug: problem.sample_ug,
            predictable_ug: before_ug,
            predictable_after_ug: after_ug,
            explainable: explainable(before_ug, after_ug, &found.noises.delta),
            findings,
            candidates: found.told(),
            unobservable: Vec::new(),
            unexplained: unexplained
                .then(|| unexplained_rest(&found, &lack_of_fit, &dependences, campaign, residual_after_ug)),
            dependences,
            noise: reported(&found.noises.delta),
        }
    }
}
