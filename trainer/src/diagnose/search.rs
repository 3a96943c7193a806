//! Which effects are missing: forward selection, each step judged with everything else free to adapt.

use super::candidate::{Candidate, is_placed, name_of};
use super::case::{Benches, Case, Freedom, Noises};
use super::evidence::{Bench, Score, difference};
use super::instrument::Known;
use super::left::{Held, Left};
use super::sum_channel::{Response, is_told, response};
use crate::fit::effects::Chosen;
use firmware_core::effect::Role;
use rayon::prelude::*;
use std::ops::RangeInclusive;

/// How well one effect does.
#[derive(Clone, Debug)]
pub(super) struct Contender {
    /// The effect.
    pub effect: Chosen,
    /// Its fitted coefficients.
    pub values: Vec<f64>,
    /// Twice the gain in log likelihood, less what its parameters are worth.
    pub evidence: f64,
    /// The noise that it leaves, once it is estimated.
    pub noises: Option<Noises>,
}

impl Contender {
    fn is_same_effect(&self, other: &Self) -> bool {
        name_of(&self.effect) == name_of(&other.effect)
    }

    /// Whether one fit would end where the other does: what sits at a place has a valley for each width.
    fn is_same_start(&self, other: &Self) -> bool {
        let mut parameters = self.effect.about.parameters.iter().zip(self.values.iter().zip(&other.values));
        let mut width_differs = || parameters.any(|(about, (a, b))| about.role == Role::Shape && a != b);
        self.is_same_effect(other) && !(is_placed(self.effect.about) && width_differs())
    }

    /// Whether a shape was stopped by the bound of what makes physical sense, or sits where nothing was measured:
    /// then it is something else.
    pub fn is_strained(&self, range_c: &RangeInclusive<f64>) -> bool {
        let about = self.effect.about;
        let bad = |name: &str, side: Side| !GOOD_LIMITS.contains(&(about.name, name, side));
        about.parameters.iter().zip(&self.values).any(|(parameter, value)| match parameter.role {
            Role::Shape => {
                (*value < parameter.low * AT_BOUND && bad(parameter.name, Side::Low))
                    || (*value * AT_BOUND > parameter.high && bad(parameter.name, Side::High))
            }
            Role::Location if parameter.unit == "°C" => {
                let reach_c = self.reach_c_per_g();
                *value + reach_c < *range_c.start() || *value - reach_c > *range_c.end()
            }
            Role::Location | Role::Amplitude | Role::Origin => false,
        })
    }

    /// How far 1 g moves the place where the effect sits, °C.
    fn reach_c_per_g(&self) -> f64 {
        let pairs = self.effect.about.parameters.iter().zip(&self.values);
        pairs.filter(|(parameter, _)| parameter.unit == "°C/g").map(|(_, value)| value.abs()).sum()
    }

    /// The effect by itself.
    pub fn alone(&self) -> Known {
        Known::NONE.with(&self.effect, &self.values)
    }
}

/// One effect that was found.
#[derive(Clone, Debug)]
pub(super) struct Found {
    /// The winner.
    pub winner: Contender,
    /// The others in order.
    pub rivals: Vec<Contender>,
    /// Most evidence of an effect that would have to leave its physical bounds.
    pub strained: f64,
    /// The noise without it.
    pub noises: Noises,
}

/// So many effects go from the screening into the final, as judged by the noise as estimated and by a small one.
const FINALISTS: [usize; 2] = [4, 3];
/// How often a finalist's parameters and noise are fitted in turn.
const TURNS: usize = 2;
/// Steps of each fit of the parameters.
const REFINEMENTS: usize = 4;

/// So many effects are asked what they foretell.
const FORESEEN: usize = 8;
/// What was left out must be read with half the error, or no more than a resemblance was found.
const HALVED: f64 = 0.5;
/// Or what is foreseeable of it must be lowered to this share.
pub(super) const LOWERED: f64 = 0.9;
/// Nor must all of it and what is foreseeable both grow to this.
const WORSE: f64 = 1.1;
/// Share of the evidence that must hold for runs that were left out.
const FORETOLD: f64 = 0.25;
/// A shape this close to its bound, as a ratio, was stopped by it.
const AT_BOUND: f64 = 1.05;
/// Effects whose formula has a limit at a bound that makes sense: a rate not smoothed, a drift that does not end or that
/// slows down as diffusion does.
const GOOD_LIMITS: [(&str, &str, Side); 4] = [
    ("thermal-gradient", "tau_s", Side::Low),
    ("aging", "tau_days", Side::High),
    ("aging", "order", Side::High),
    ("aging", "order", Side::Low),
];

#[derive(Clone, Copy, PartialEq)]
enum Side {
    Low,
    High,
}

/// Everything that stays the same while contenders are compared.
struct Scene {
    held: Held,
    left: Left,
    freedom: Freedom,
    noises: Noises,
    deviance: f64,
}

/// The first of every effect.
fn best_of_each(order: Vec<Contender>) -> Vec<Contender> {
    let mut best: Vec<Contender> = Vec::new();
    for contender in order {
        if !best.iter().any(|other| other.is_same_effect(&contender)) {
            best.push(contender);
        }
    }
    best
}

impl Case<'_> {
    /// What each parameter costs: the logarithm of the number of cells, as of Schwarz 1978.
    pub fn price(&self) -> f64 {
        (self.layout.len() as f64).ln()
    }

    /// The effect that `known` misses most, if the candidates can say.
    pub fn missing(&self, known: &Known, candidates: &[Candidate], noises: &Noises) -> Option<Found> {
        let scene = self.scene(known, noises)?;
        let mut order: Vec<Contender> = self
            .finalists(&scene, known, candidates)?
            .into_par_iter()
            .filter_map(|contender| self.contend(&scene, known, contender))
            .collect();
        order.sort_by(|a, b| b.evidence.total_cmp(&a.evidence));
        let (strained, order): (Vec<_>, Vec<_>) =
            order.into_iter().partition(|contender: &Contender| contender.is_strained(&self.layout.range_c()));
        let mut order = best_of_each(order);
        let strained = strained.first().filter(|contender| self.foretells(known, contender).unwrap_or(false));
        let strained = strained.map_or(f64::NEG_INFINITY, |contender| contender.evidence);
        // An effect must foretell runs that its parameters were not fitted to.
        let winner = loop {
            let next = (!order.is_empty()).then(|| order.remove(0))?;
            if next.evidence < 0.0 || self.foretells(known, &next)? {
                break next;
            }
        };
        Some(Found { winner, rivals: order, strained, noises: scene.noises })
    }

    /// Whether runs that were left out are explained better with the effect than without, or are at least read with half
    /// the error, or with clearly less of what is foreseeable: the residual alone, as the sum of the frequencies
    /// has no held-out part of its own. Likelihood alone would not do: it weighs most where the noise is least, and there
    /// no formula is exact.
    fn foretells(&self, known: &Known, contender: &Contender) -> Option<bool> {
        let noises = contender.noises.as_ref()?;
        let with = known.with(&contender.effect, &contender.values);
        let case = self.remembering(&with);
        let fitted = |known: &Known| {
            Some(Bench::new(&case.layout, noises.delta, &case.left(known).delta, &case.recalling(known))?.deviance)
        };
        let gain = fitted(known)? - fitted(&with)?;
        let (before, after) = (case.held_out(known, noises), case.held_out(&with, noises));
        let all = after.residual_ug / before.residual_ug;
        let foreseeable = after.structure_ug() / before.structure_ug();
        let foretold = before.deviance - after.deviance > FORETOLD * gain.max(0.0);
        Some(all < HALVED || foreseeable < LOWERED || foretold && (all < WORSE || foreseeable < WORSE))
    }

    /// The effect with which what was left out is foretold far better than without, wherever a wander that large hides
    /// what likelihood could say. The noise is taken to be small, so that effects compete with effects and not with it.
    pub fn foreseen(&self, known: &Known, candidates: &[Candidate], noises: &Noises) -> Option<Found> {
        let (left, freedom, held) = (self.left(known), self.adapting(known, noises), self.held(known));
        let small = noises.small();
        let benches = self.benches(&left, &freedom, &small)?;
        let mut screened = self.screen(&benches, known, candidates);
        screened.retain(|contender| contender.effect.expression.is_none());
        screened.sort_by(|a, b| b.evidence.total_cmp(&a.evidence));
        let mut screened = best_of_each(screened);
        screened.truncate(FORESEEN);
        let before = self.held_out(known, &small);
        let tried = screened.into_par_iter().map(|contender| {
            let (own, _) = self.refit(&held, &contender.alone(), &benches, TURNS * REFINEMENTS);
            let values = own.coefficients.values.concat();
            let after = self.held_out(&known.with(&contender.effect, &values), &small);
            let ratio = after.structure_ug() / before.structure_ug();
            // Every part that was left out counts once, however many samples it has.
            let price = (before.parts as f64).ln() * contender.effect.free().count() as f64;
            let evidence = -2.0 * before.parts as f64 * ratio.ln() - price;
            (ratio, Contender { values, evidence, noises: Some(small), ..contender })
        });
        let mut tried: Vec<(f64, Contender)> = tried.collect();
        tried.retain(|(ratio, contender)| ratio.is_finite() && !contender.is_strained(&self.layout.range_c()));
        tried.sort_by(|a, b| a.0.total_cmp(&b.0));
        let (best, _) = tried.first()?;
        if *best > HALVED {
            return None;
        }
        let mut order = tried.into_iter().map(|(_, contender)| contender);
        let winner = order.next()?;
        Some(Found { winner, rivals: order.collect(), strained: f64::NEG_INFINITY, noises: *noises })
    }

    fn scene(&self, known: &Known, noises: &Noises) -> Option<Scene> {
        let (left, freedom, held) = (self.left(known), self.adapting(known, noises), self.held(known));
        let noises = self.noises(&left, &freedom, Some(noises));
        let deviance = self.benches(&left, &freedom, &noises)?.deviance();
        Some(Scene { held, left, freedom, noises, deviance })
    }

    fn finalists(&self, scene: &Scene, known: &Known, candidates: &[Candidate]) -> Option<Vec<Contender>> {
        let mut chosen: Vec<Contender> = Vec::new();
        for (noises, most) in [scene.noises, scene.noises.small()].iter().zip(FINALISTS) {
            let benches = self.benches(&scene.left, &scene.freedom, noises)?;
            let mut screened = self.screen(&benches, known, candidates);
            screened.sort_by(|a, b| b.evidence.total_cmp(&a.evidence));
            let names = best_of_each(screened.clone());
            let passes = |contender: &Contender| names.iter().take(most).any(|name| name.is_same_effect(contender));
            let is_new = |contender: &Contender| chosen.iter().all(|other| !other.is_same_start(contender));
            let next: Vec<Contender> = screened.into_iter().filter(|one| passes(one) && is_new(one)).collect();
            chosen.extend(next.into_iter().map(|contender| self.shifted(&benches, contender)));
        }
        Some(chosen)
    }

    /// Fits an effect's parameters and the noise in turn, and says how likely that makes what was measured.
    fn contend(&self, scene: &Scene, known: &Known, contender: Contender) -> Option<Contender> {
        let told = is_told(contender.effect.about);
        let (mut own, mut noises) = (contender.alone(), scene.noises);
        let mut case = self.remembering(&known.and(&own));
        for _ in 0..TURNS {
            let benches = case.benches(&scene.left, &scene.freedom, &noises)?;
            let mut left;
            (own, left) = case.refit(&scene.held, &own, &benches, REFINEMENTS);
            let mut freedom = case.widened(&scene.freedom, &scene.held, &own, &left);
            if !told {
                // The sum is as it was; its noise is known.
                (left.sum, freedom.sum) = (None, None);
            }
            let fitted = case.noises(&left, &freedom, Some(&noises));
            noises = Noises { delta: fitted.delta, sum: fitted.sum.or(noises.sum) };
        }
        case.layout.remember(&known.and(&own));
        // The noise was fitted with the parameters free: they settle under what it has become.
        let benches = case.benches(&scene.left, &scene.freedom, &noises)?;
        let (own, left) = case.refit(&scene.held, &own, &benches, REFINEMENTS);
        if told {
            // Difference and sum were free to ask for different sizes: what one size leaves is noise.
            noises = case.noises(&left, &scene.freedom, Some(&noises));
        }
        let mut deviance = case.benches(&left, &scene.freedom, &noises)?.deviance();
        if let Some((freed, with)) = case.freed(scene, &left, &own, &noises) {
            let value = case.benches(&freed, &scene.freedom, &with)?.deviance() + self.price();
            if value < deviance {
                (deviance, noises) = (value, with);
            }
        }
        let values = own.coefficients.values.concat();
        // Neither side may profit from a noise that was searched for longer.
        let without = case.benches(&scene.left, &scene.freedom, &noises)?.deviance().min(scene.deviance);
        let evidence = without - deviance - self.price() * contender.effect.free().count() as f64;
        Some(Contender { values, evidence, noises: Some(noises), ..contender })
    }

    /// What is left of the sum when an effect's share there is free within bounds, and the noise of that.
    fn freed(&self, scene: &Scene, left: &Left, own: &Known, noises: &Noises) -> Option<(Left, Noises)> {
        let Response::Free(most) = response(own.effects.first()?.about) else { return None };
        let sum = left.sum.as_ref()?;
        let bias = difference(&left.delta, &scene.left.delta);
        let bound = most * self.mhz_per_ug();
        let (mut noises, mut freed) = (*noises, left.clone());
        for _ in 0..TURNS {
            let bench = self.benches(left, &scene.freedom, &noises)?.sum?;
            let score = bench.score(&bias);
            let share = score.amplitudes()?[0].clamp(-bound, bound);
            freed.sum = Some(sum.iter().zip(&bias).map(|(sum, bias)| sum + bias * share).collect());
            let sum_only = Left { delta: Vec::new(), sum: freed.sum.clone() };
            noises.sum = self.sum_noise(&sum_only, &scene.freedom, Some(&noises));
        }
        Some((freed, noises))
    }

    /// The best shape of every effect on the grid, and the best place at every width.
    pub fn screen(&self, benches: &Benches, known: &Known, candidates: &[Candidate]) -> Vec<Contender> {
        let is_known =
            |candidate: &&Candidate| known.effects.iter().any(|one| name_of(one) == name_of(&candidate.effect));
        let candidates: Vec<&Candidate> = candidates.iter().filter(|candidate| !is_known(candidate)).collect();
        let told: Vec<&Candidate> = candidates.iter().copied().filter(|candidate| candidate.tells(self)).collect();
        let mut of_sums = benches
            .sum
            .iter()
            .flat_map(|bench| bench.scores(&told, |candidate| candidate.sum(self).unwrap_or_default()));
        let of_deltas = benches.delta.scores(&candidates, |candidate| candidate.delta(self));
        let mut best: Vec<Contender> = Vec::new();
        for (&candidate, mut score) in candidates.iter().zip(of_deltas) {
            if candidate.tells(self) {
                score = of_sums.next().iter().fold(score, Score::tied);
            }
            let contender = self.judged(candidate, &score);
            match best.iter_mut().find(|other| other.is_same_start(&contender)) {
                Some(other) if other.evidence >= contender.evidence => {}
                Some(other) => *other = contender,
                None => best.push(contender),
            }
        }
        best
    }

    /// The same, moved by the level as suits it best: the grid of places is too coarse for that.
    fn shifted(&self, benches: &Benches, contender: Contender) -> Contender {
        let candidates = Candidate::shifted(self, &contender.effect, &contender.values);
        let scores = benches.delta.scores(&candidates, |candidate| candidate.delta(self));
        let judged = candidates.iter().zip(scores).map(|(one, score)| self.judged(one, &score));
        judged.fold(contender, |best, next| if next.evidence > best.evidence { next } else { best })
    }

    fn judged(&self, candidate: &Candidate, score: &Score) -> Contender {
        let mut values = candidate.values.clone();
        let gain = if candidate.amplitudes.is_empty() {
            score.gain_as_is()
        } else {
            for (&index, amplitude) in candidate.amplitudes.iter().zip(score.amplitudes().iter().flatten()) {
                values[index] *= amplitude;
            }
            score.gain()
        };
        let evidence = gain - self.price() * candidate.effect.free().count() as f64;
        Contender { effect: candidate.effect.clone(), values, evidence, noises: None }
    }

    /// Size of the scale factor, mHz per µg: its sign is a matter of wiring.
    fn mhz_per_ug(&self) -> f64 {
        self.instrument.scale_factor_hz_per_g(&self.layout).abs() * 1e3 * 1e-6
    }
}
