//! Forward selection: the effect that is missed most, each judged with everything else free to adapt.

use super::candidate::Candidate;
use super::contender::{Contender, Found, best_of_each};
use super::predictive::is_predictive;
use super::screening::{screen, shifted};
use crate::diagnose::cells::difference;
use crate::diagnose::forward::{CellResiduals, EffectSet, FixedEffects};
use crate::diagnose::problem::{
    GlsPair, NoiseModels, Nuisance, Problem, constrained, fit, initial_states, refine, sum_noise, widened,
};
use crate::diagnose::thresholds::{CONTENDER_STEPS, CONTENDER_TURNS, FINALISTS};
use firmware_core::effect::SumResponse;
use rayon::prelude::*;

/// Everything that stays the same while contenders are compared.
struct Scene<'a> {
    problem: &'a Problem<'a>,
    known: &'a EffectSet,
    fixed: FixedEffects,
    residuals: CellResiduals,
    nuisance: Nuisance,
    noises: NoiseModels,
    deviance: f64,
}

/// The effect that `known` misses most, if the candidates can say.
pub fn missing(problem: &Problem, known: &EffectSet, candidates: &[Candidate], noises: &NoiseModels) -> Option<Found> {
    let scene = Scene::new(problem, known, noises)?;
    let mut order: Vec<Contender> =
        scene.finalists(candidates)?.into_par_iter().filter_map(|contender| scene.contend(contender)).collect();
    order.sort_by(|a, b| b.delta_bic.total_cmp(&a.delta_bic));
    let (at_bound, order): (Vec<_>, Vec<_>) =
        order.into_iter().partition(|contender: &Contender| contender.is_at_bound(&problem.cells().range_c()));
    let mut order = best_of_each(order);
    let at_bound = at_bound.first().filter(|one| is_predictive(problem, known, one).unwrap_or(false));
    let at_bound = at_bound.map_or(f64::NEG_INFINITY, |contender| contender.delta_bic);
    // An effect must predict runs that its parameters were not fitted to.
    let winner = loop {
        let next = (!order.is_empty()).then(|| order.remove(0))?;
        if next.delta_bic < 0.0 || is_predictive(problem, known, &next)? {
            break next;
        }
    };
    Some(Found { winner, rivals: order, at_bound, noises: scene.noises })
}

impl<'a> Scene<'a> {
    fn new(problem: &'a Problem, known: &'a EffectSet, noises: &NoiseModels) -> Option<Self> {
        let (residuals, fixed) = (problem.forward.residuals(known), problem.forward.fixed(known));
        let nuisance = constrained(problem, known, noises);
        let noises = refine(problem, &residuals, &nuisance, noises);
        let deviance = GlsPair::new(problem, &residuals, &nuisance, &noises)?.deviance();
        Some(Self { problem, known, fixed, residuals, nuisance, noises, deviance })
    }

    /// The regression of what is left, under these noises.
    fn gls(&self, residuals: &CellResiduals, noises: &NoiseModels) -> Option<GlsPair> {
        GlsPair::new(self.problem, residuals, &self.nuisance, noises)
    }

    fn finalists(&self, candidates: &[Candidate]) -> Option<Vec<Contender>> {
        let mut chosen: Vec<Contender> = Vec::new();
        for (noises, most) in [self.noises.clone(), self.noises.small()].iter().zip(FINALISTS) {
            let gls = self.gls(&self.residuals, noises)?;
            let mut screened = screen(self.problem, &gls, self.known, candidates);
            screened.sort_by(|a, b| b.delta_bic.total_cmp(&a.delta_bic));
            let names = best_of_each(screened.clone());
            let passes = |contender: &Contender| names.iter().take(most).any(|name| name.is_same_effect(contender));
            let is_new = |contender: &Contender| chosen.iter().all(|other| !other.is_same_start(contender));
            let next: Vec<Contender> = screened.into_iter().filter(|one| passes(one) && is_new(one)).collect();
            chosen.extend(next.into_iter().map(|contender| shifted(self.problem, &gls, contender)));
        }
        Some(chosen)
    }

    /// Fits an effect's parameters and the noise in turn, and says how likely that makes what was measured.
    fn contend(&self, contender: Contender) -> Option<Contender> {
        let predicted = contender.effect.about.sum_response.is_predicted();
        let initial = |own: &EffectSet| initial_states(self.problem, &self.known.and(own));
        let mut own = contender.alone();
        let mut noises = self.noises.beside(&initial(&own));
        for _ in 0..CONTENDER_TURNS {
            let gls = self.gls(&self.residuals, &noises)?;
            let mut residuals;
            (own, residuals) = fit(self.problem, &self.fixed, &own, &gls, CONTENDER_STEPS);
            let mut nuisance = widened(self.problem, &self.nuisance, &self.fixed, &own, &residuals);
            if !predicted {
                // The sum is as it was; its noise is known.
                (residuals.sum, nuisance.sum) = (None, None);
            }
            let fitted = refine(self.problem, &residuals, &nuisance, &noises);
            noises = NoiseModels { sum: fitted.sum.or(noises.sum), ..fitted };
        }
        noises = noises.beside(&initial(&own));
        // The noise was fitted with the parameters free: they settle under what it has become.
        let (own, residuals) =
            fit(self.problem, &self.fixed, &own, &self.gls(&self.residuals, &noises)?, CONTENDER_STEPS);
        if predicted {
            // Difference and sum were free to ask for different sizes: what one size leaves is noise.
            noises = refine(self.problem, &residuals, &self.nuisance, &noises);
        }
        let mut deviance = self.gls(&residuals, &noises)?.deviance();
        if let Some((freed, with)) = self.freed(&residuals, &own, &noises) {
            let value = self.gls(&freed, &with)?.deviance() + self.problem.parameter_cost();
            if value < deviance {
                (deviance, noises) = (value, with);
            }
        }
        let values = own.coefficients.values.concat();
        // Neither side may profit from a noise that was searched for longer.
        let without = self.gls(&self.residuals, &noises)?.deviance().min(self.deviance);
        let cost = self.problem.parameter_cost() * contender.effect.free().count() as f64;
        Some(Contender { values, delta_bic: without - deviance - cost, noises: Some(noises), ..contender })
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
            noises.sum = sum_noise(self.problem, &sum_only, &self.nuisance, noises.sum, &noises.initial);
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
    use crate::diagnose::thresholds::LEAST_DELTA_BIC;

    const NAMES: [&str; 4] = ["warm-up", "thermal-gradient", "thermal-hysteresis", "mode-crossing"];

    fn found(campaign: &Campaign, known: &EffectSet) -> Option<Found> {
        let problem = problem(campaign);
        let shown = NAMES.map(|name| effect(name, campaign));
        let candidates = Candidate::all(&problem, &shown);
        let initial = initial_states(&problem, known);
        let noises = estimate(&problem, &problem.forward.residuals(known), &fixed(&problem, known), &initial);
        missing(&problem, known, &candidates, &noises)
    }

    fn with(name: &str, values: &[f64], sum: bool) -> (Campaign, EffectSet) {
        let still = Recipe { sum, ..Recipe::default() }.campaign();
        let truth = EffectSet::NONE.with(&effect(name, &still), values);
        (disturbed(still, &truth), truth)
    }

    #[test]
    fn the_effect_that_was_put_in_wins_with_its_values() {
        for (name, values) in
            [("warm-up", [2e-4, 500.0]), ("thermal-gradient", [5e-3, 60.0]), ("thermal-hysteresis", [1e-5, 8.0])]
        {
            let (campaign, _) = with(name, &values, false);
            let found = found(&campaign, &EffectSet::NONE).unwrap();
            let winner = &found.winner;
            assert_eq!(winner.effect.about.name, name);
            assert!(winner.delta_bic > LEAST_DELTA_BIC, "{name}: {}", winner.delta_bic);
            assert!(found.rivals.iter().all(|rival| rival.delta_bic < winner.delta_bic), "{name}");
            for (value, truth) in winner.values.iter().zip(values) {
                assert!((value / truth - 1.0).abs() < 0.15, "{name}: {value} {truth}");
            }
        }
    }

    #[test]
    fn on_noise_alone_nothing_is_worth_naming() {
        for sum in [false, true] {
            let campaign = Recipe { sum, ..Recipe::default() }.campaign();
            let best = found(&campaign, &EffectSet::NONE).map_or(f64::NEG_INFINITY, |found| found.winner.delta_bic);
            assert!(best < LEAST_DELTA_BIC, "{best}");
        }
    }

    #[test]
    fn what_is_known_is_not_missed() {
        let (campaign, truth) = with("warm-up", &[2e-4, 500.0], false);
        let best = found(&campaign, &truth);
        assert!(best.is_none_or(
            |found| found.winner.delta_bic < LEAST_DELTA_BIC && found.winner.effect.about.name != "warm-up"
        ));
    }
}
