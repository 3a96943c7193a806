//! Forward selection: the effect that is missed most, each judged with everything else free to adapt.

use super::candidate::Candidate;
use super::contender::{Contender, Found, Searched, best_of_each};
use super::predictive::{Prediction, prediction};
use super::screening::{screen, shifted};
use super::uncertainty::is_determined;
use crate::diagnose::answer::{Judged, Outcome};
use crate::diagnose::cells::difference;
use crate::diagnose::forward::{CellResiduals, EffectSet, FixedEffects, amplitudes, name_of};
use crate::diagnose::problem::{
    GlsPair, NoiseModels, Nuisance, Problem, carried, constrained, fit, initial_states, refine, sum_noise, widened,
};
use crate::diagnose::thresholds::{CONTENDER_STEPS, CONTENDER_TURNS, FINALISTS, INEXACT, LEAST_DELTA_BIC};
use firmware_core::effect::SumResponse;
use rayon::prelude::*;
use std::borrow::Cow;

/// Everything that stays the same while contenders are compared.
struct Scene<'a> {
    problem: Cow<'a, Problem<'a>>,
    known: &'a EffectSet,
    fixed: FixedEffects,
    residuals: CellResiduals,
    nuisance: Nuisance,
    noises: NoiseModels,
    deviance: f64,
}

/// The effect that `known` misses most, if the candidates can say. `explained` are those that were found before, each with its
/// ΔBIC.
pub fn missing(
    problem: &Problem,
    known: &EffectSet,
    explained: &[(EffectSet, f64)],
    candidates: &[Candidate],
    noises: &NoiseModels,
) -> Option<Searched> {
    let scene = Scene::new(problem, known, noises)?;
    let (screened, finalists) = scene.finalists(candidates)?;
    let mut order: Vec<Contender> =
        finalists.into_par_iter().filter_map(|contender| scene.contend(contender)).collect();
    order.sort_by(|a, b| b.delta_bic.total_cmp(&a.delta_bic));
    let mut trace = Trace::new(&screened, &order);
    let (sound, others): (Vec<_>, Vec<_>) = order.into_iter().partition(|one: &Contender| one.determined);
    trace.strong(&others, &Outcome::Undetermined);
    let (at_bound, order): (Vec<_>, Vec<_>) =
        sound.into_iter().partition(|contender| contender.is_at_bound(&problem.cells().range_c()));
    trace.strong(&at_bound, &Outcome::AtBound);
    let mut order = best_of_each(order);
    let holds = |one: &&Contender| prediction(problem, known, one).is_some_and(|prediction| prediction.holds);
    let at_bound = at_bound.first().filter(holds).map_or(f64::NEG_INFINITY, |contender| contender.delta_bic);
    let (best, mut found) = (order.first().cloned(), None);
    while found.is_none() && order.first().is_some_and(|next| next.delta_bic >= LEAST_DELTA_BIC) {
        let winner = order.remove(0);
        // It must be more than others' formulas may lack, and predict runs that its parameters were not fitted to.
        if winner.delta_bic < LEAST_DELTA_BIC + inexact(problem, explained, &winner.alone()) {
            let known =
                explained.iter().flat_map(|(one, _)| one.effects.first()).map(|effect| name_of(effect).to_owned());
            trace.set(&winner, Outcome::WithinFormulaOf(known.collect::<Vec<_>>().join(" or ")), None);
            continue;
        }
        let Prediction { holds, ratio } = prediction(problem, known, &winner)?;
        trace.set(&winner, if holds { Outcome::Found } else { Outcome::NotPredictive }, Some(ratio));
        if holds {
            trace.strong(&order, &Outcome::ExplainedBy(name_of(&winner.effect).to_owned()));
            found = Some(Found { winner, rivals: std::mem::take(&mut order), noises: scene.noises.clone() });
        }
    }
    Some(Searched { found, best, at_bound, noises: scene.noises, judged: trace.judged })
}

/// What came of each effect in one search.
struct Trace {
    judged: Vec<Judged>,
}

impl Trace {
    fn new(screened: &[Contender], fitted: &[Contender]) -> Self {
        let is_fitted = |one: &&Contender| fitted.iter().any(|other| other.is_same_effect(one));
        let judged = best_of_each(fitted.to_vec()).iter().map(|one| one.judged(Outcome::Weak)).collect();
        let mut trace = Self { judged };
        let as_screened = |one: &Contender| {
            one.judged(if one.delta_bic < LEAST_DELTA_BIC { Outcome::Weak } else { Outcome::NotFitted })
        };
        trace.judged.extend(screened.iter().filter(|one| !is_fitted(one)).map(as_screened));
        trace
    }

    fn set(&mut self, contender: &Contender, outcome: Outcome, held_out_ratio: Option<f64>) {
        let name = name_of(&contender.effect);
        if let Some(one) = self.judged.iter_mut().find(|one| one.effect == name) {
            *one = Judged { held_out_ratio, ..contender.judged(outcome) };
        }
    }

    /// What came of those that had to be looked at; the others are weak, whatever else they are.
    fn strong(&mut self, contenders: &[Contender], outcome: &Outcome) {
        let strong = contenders.iter().rev().filter(|one| one.delta_bic >= LEAST_DELTA_BIC);
        strong.for_each(|one| self.set(one, outcome.clone(), None));
    }
}

/// ΔBIC that an effect may owe to formulas of others that are not exact: to the squared share of their amplitude, as far as
/// it does the same as they.
pub fn inexact(problem: &Problem, explained: &[(EffectSet, f64)], next: &EffectSet) -> f64 {
    let own = problem.forward.alone_ug(next);
    let of = |(one, delta_bic): &(EffectSet, f64)| {
        let correlation = problem.cells().correlation(&own, &problem.forward.alone_ug(one));
        delta_bic.max(0.0) * (INEXACT * correlation).powi(2)
    };
    explained.iter().map(of).sum()
}

impl<'a> Scene<'a> {
    fn new(problem: &'a Problem, known: &'a EffectSet, noises: &NoiseModels) -> Option<Self> {
        let (residuals, fixed) = (problem.forward.residuals(known), problem.forward.fixed(known));
        let nuisance = constrained(problem, known, noises);
        let noises = refine(problem, &residuals, &nuisance, noises);
        let mut scene =
            Self { problem: Cow::Borrowed(problem), known, fixed, residuals, nuisance, noises, deviance: 0.0 };
        scene.deviance = scene.deviance_without(&scene.noises)?;
        Some(scene)
    }

    /// −2 log likelihood without any effect more under these noises. The map takes up what it could, as it does beside each
    /// contender.
    fn deviance_without(&self, noises: &NoiseModels) -> Option<f64> {
        let here = self.around(&EffectSet::NONE, noises)?;
        Some(here.gls(&here.residuals, noises)?.deviance())
    }

    /// The same scene where an effect is at work.
    fn around(&self, own: &EffectSet, noises: &NoiseModels) -> Option<Self> {
        let problem = carried(&self.problem, &self.known.and(own), noises)?;
        let (residuals, fixed) = (problem.forward.residuals(self.known), problem.forward.fixed(self.known));
        let nuisance = constrained(&problem, self.known, &self.noises);
        let noises = self.noises.clone();
        Some(Self { problem: Cow::Owned(problem), residuals, fixed, nuisance, noises, ..*self })
    }

    /// The regression of what is left, under these noises.
    fn gls(&self, residuals: &CellResiduals, noises: &NoiseModels) -> Option<GlsPair> {
        GlsPair::new(&self.problem, residuals, &self.nuisance, noises)
    }

    /// Every effect as screened, and those that are fitted.
    fn finalists(&self, candidates: &[Candidate]) -> Option<(Vec<Contender>, Vec<Contender>)> {
        let (mut chosen, mut all): (Vec<Contender>, Vec<Contender>) = (Vec::new(), Vec::new());
        for (noises, most) in [self.noises.clone(), self.noises.small()].iter().zip(FINALISTS) {
            let gls = self.gls(&self.residuals, noises)?;
            let mut screened = screen(&self.problem, &gls, self.known, candidates);
            screened.sort_by(|a, b| b.delta_bic.total_cmp(&a.delta_bic));
            let names = best_of_each(screened.clone());
            all.extend(names.iter().cloned());
            let passes = |contender: &Contender| names.iter().take(most).any(|name| name.is_same_effect(contender));
            let is_new = |contender: &Contender| chosen.iter().all(|other| !other.is_same_start(contender));
            let next: Vec<Contender> = screened.into_iter().filter(|one| passes(one) && is_new(one)).collect();
            chosen.extend(next.into_iter().map(|contender| shifted(&self.problem, &gls, contender)));
        }
        chosen.retain(|contender| !amplitudes(contender.effect.about).is_empty());
        chosen.extend(self.of_one_size(candidates));
        Some((best_of_each(all), chosen))
    }

    /// Every effect that comes in one size, at the shape of the grid beside which the map fits best. It moves the map's
    /// inputs, so that its score beside a map that was trained with it inside says little.
    fn of_one_size(&self, candidates: &[Candidate]) -> Vec<Contender> {
        let is_new = |one: &&Candidate| self.known.effects.iter().all(|known| name_of(known) != name_of(&one.effect));
        let of_one_size = candidates.par_iter().filter(|one| one.amplitudes.is_empty()).filter(is_new);
        let judged = of_one_size.filter_map(|candidate| {
            let own = EffectSet::NONE.with(&candidate.effect, &candidate.values);
            let noises = self.noises.beside(&initial_states(&self.problem, &self.known.and(&own)));
            let here = self.around(&own, &noises)?;
            let residuals = here.problem.forward.residuals_beside(&here.fixed, &own);
            let delta_bic = self.deviance - here.gls(&residuals, &noises)?.deviance();
            Some(Contender {
                effect: candidate.effect.clone(),
                values: candidate.values.clone(),
                delta_bic,
                noises: None,
                determined: true,
            })
        });
        let mut order: Vec<Contender> = judged.collect();
        order.sort_by(|a, b| b.delta_bic.total_cmp(&a.delta_bic));
        best_of_each(order)
    }

    /// Fits an effect's parameters, the map and the noise in turn, and says how likely that makes what was measured.
    fn contend(&self, contender: Contender) -> Option<Contender> {
        let predicted = contender.effect.about.sum_response.is_predicted();
        let initial = |own: &EffectSet| initial_states(&self.problem, &self.known.and(own));
        let mut own = contender.alone();
        let mut noises = self.noises.beside(&initial(&own));
        let mut around: Option<Self> = None;
        for _ in 0..CONTENDER_TURNS {
            let scene = around.as_ref().unwrap_or(self);
            let gls = scene.gls(&scene.residuals, &noises)?;
            let mut residuals;
            (own, residuals) = fit(&scene.problem, &scene.fixed, &own, &gls, CONTENDER_STEPS);
            let mut nuisance = widened(&scene.problem, &scene.nuisance, &scene.fixed, &own, &residuals);
            if !predicted {
                // The sum is as it was; its noise is known.
                (residuals.sum, nuisance.sum) = (None, None);
            }
            let fitted = refine(&scene.problem, &residuals, &nuisance, &noises);
            noises = NoiseModels { sum: fitted.sum.or(noises.sum), ..fitted };
            around = Some(self.around(&own, &noises)?);
        }
        let scene = around.as_ref().unwrap_or(self);
        noises = noises.beside(&initial(&own));
        // The noise was fitted with the parameters free: they settle under what it has become.
        let gls = scene.gls(&scene.residuals, &noises)?;
        let (own, residuals) = fit(&scene.problem, &scene.fixed, &own, &gls, CONTENDER_STEPS);
        if predicted {
            // Difference and sum were free to ask for different sizes: what one size leaves is noise.
            noises = refine(&scene.problem, &residuals, &scene.nuisance, &noises);
        }
        let mut deviance = scene.gls(&residuals, &noises)?.deviance();
        if let Some((freed, with)) = scene.freed(&residuals, &own, &noises) {
            let value = scene.gls(&freed, &with)?.deviance() + self.problem.parameter_cost();
            if value < deviance {
                (deviance, noises) = (value, with);
            }
        }
        let values = own.coefficients.values.concat();
        let determined = is_determined(&scene.problem, &self.known.and(&own), &noises);
        // Neither side may profit from a noise that was searched for longer.
        let without = self.deviance_without(&noises)?.min(self.deviance);
        let cost = self.problem.parameter_cost() * contender.effect.free().count() as f64;
        Some(Contender { values, delta_bic: without - deviance - cost, noises: Some(noises), determined, ..contender })
    }

    /// What is left of the sum when an effect's share there is free within bounds, and the noise of that.
    fn freed(
        &self,
        residuals: &CellResiduals,
        own: &EffectSet,
        noises: &NoiseModels,
    ) -> Option<(CellResiduals, NoiseModels)> {
        let SumResponse::Free(most) = own.effects.first()?.about.sum_response else { return None };
        let sum = residuals.sum.as_ref()?;
        let bias = difference(&residuals.delta, &self.residuals.delta);
        let bound = most * self.problem.forward.mhz_per_ug();
        let (mut noises, mut freed) = (noises.clone(), residuals.clone());
        for _ in 0..CONTENDER_TURNS {
            let gls = self.gls(residuals, &noises)?.sum?;
            let score = gls.score(&bias);
            let share = score.amplitudes()?[0].clamp(-bound, bound);
            freed.sum = Some(sum.iter().zip(&bias).map(|(sum, bias)| sum + bias * share).collect());
            let sum_only = CellResiduals { delta: Vec::new(), sum: freed.sum.clone() };
            noises.sum = sum_noise(&self.problem, &sum_only, &self.nuisance, noises.sum, &noises.initial);
        }
        Some((freed, noises))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::campaign::Campaign;
    use crate::diagnose::example::{Recipe, disturbed, effect, problem};
    use crate::diagnose::problem::{estimate, fixed};

    const NAMES: [&str; 4] = ["warm-up", "thermal-gradient", "thermal-hysteresis", "mode-crossing"];

    fn searched(campaign: &Campaign, known: &EffectSet) -> Searched {
        let problem = problem(campaign);
        let shown = NAMES.map(|name| effect(name, campaign));
        let candidates = Candidate::all(&problem, &shown);
        let initial = initial_states(&problem, known);
        let noises = estimate(&problem, &problem.forward.residuals(known), &fixed(&problem, known), &initial);
        missing(&problem, known, &[], &candidates, &noises).unwrap()
    }

    fn with(name: &str, values: &[f64], sum: bool) -> (Campaign, EffectSet) {
        let still = Recipe { sum, ..Recipe::default() }.campaign();
        let truth = EffectSet::NONE.with(&effect(name, &still), values);
        (disturbed(still, &truth), truth)
    }

    #[test]
    fn the_effect_that_was_put_in_wins_with_its_values() {
        let mut explained = 0;
        for (name, values) in
            [("warm-up", [2e-4, 500.0]), ("thermal-gradient", [5e-3, 60.0]), ("thermal-hysteresis", [1e-5, 8.0])]
        {
            let (campaign, _) = with(name, &values, false);
            let Searched { found, judged, .. } = searched(&campaign, &EffectSet::NONE);
            let found = found.unwrap();
            let winner = &found.winner;
            assert_eq!(winner.effect.about.name, name);
            assert!(winner.delta_bic > LEAST_DELTA_BIC, "{name}: {}", winner.delta_bic);
            assert!(found.rivals.iter().all(|rival| rival.delta_bic < winner.delta_bic), "{name}");
            // Each effect is told once, the winner as found, and the others with why they are not.
            let outcome = |name: &str| -> Vec<&Outcome> {
                judged.iter().filter(|one| one.effect == name).map(|one| &one.outcome).collect()
            };
            assert_eq!(outcome(name), [&Outcome::Found]);
            assert!(judged.iter().all(|one| outcome(&one.effect).len() == 1) && judged.len() == NAMES.len());
            for one in judged.iter().filter(|one| one.effect != name) {
                let expected = match one.delta_bic >= LEAST_DELTA_BIC {
                    true if one.outcome == Outcome::NotFitted => continue,
                    true => Outcome::ExplainedBy(name.to_owned()),
                    false => Outcome::Weak,
                };
                assert_eq!(one.outcome, expected, "{judged:?}");
            }
            explained += judged.iter().filter(|one| one.outcome == Outcome::ExplainedBy(name.to_owned())).count();
            let ratio = judged.iter().find(|one| one.effect == name).unwrap().held_out_ratio.unwrap();
            assert!((0.0..0.9).contains(&ratio), "{ratio}");
            for (value, truth) in winner.values.iter().zip(values) {
                assert!((value / truth - 1.0).abs() < 0.15, "{name}: {value} {truth}");
            }
        }
        assert!(explained > 0);
    }

    #[test]
    fn on_noise_alone_nothing_is_worth_naming() {
        for sum in [false, true] {
            let campaign = Recipe { sum, ..Recipe::default() }.campaign();
            let searched = searched(&campaign, &EffectSet::NONE);
            assert!(searched.judged.iter().all(|one| one.outcome != Outcome::Found && one.held_out_ratio.is_none()));
            assert!(searched.found.is_none() && searched.best.is_none_or(|best| best.delta_bic < LEAST_DELTA_BIC));
        }
    }

    #[test]
    fn what_is_known_is_not_missed() {
        let (campaign, truth) = with("warm-up", &[2e-4, 500.0], false);
        let searched = searched(&campaign, &truth);
        assert!(searched.found.is_none() && searched.best.is_none_or(|best| best.effect.about.name != "warm-up"));
    }
}
