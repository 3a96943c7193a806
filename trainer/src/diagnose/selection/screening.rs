//! The grid of candidates, each by its score: nothing is fitted again.

use super::candidate::Candidate;
use super::contender::Contender;
use crate::diagnose::forward::{EffectSet, name_of};
use crate::diagnose::problem::{GlsPair, Problem};
use crate::diagnose::regression::Score;

/// The best shape of every effect on the grid, and the best place at every width.
pub fn screen(problem: &Problem, gls: &GlsPair, known: &EffectSet, candidates: &[Candidate]) -> Vec<Contender> {
    let is_known = |candidate: &&Candidate| known.effects.iter().any(|one| name_of(one) == name_of(&candidate.effect));
    let candidates: Vec<&Candidate> = candidates.iter().filter(|candidate| !is_known(candidate)).collect();
    let predicted: Vec<&Candidate> =
        candidates.iter().copied().filter(|candidate| candidate.predicts_sum(problem)).collect();
    let sums = gls.sum.iter();
    let mut of_sums =
        sums.flat_map(|gls| gls.scores(&predicted, |candidate| candidate.sum(problem).unwrap_or_default()));
    let of_deltas = gls.delta.scores(&candidates, |candidate| candidate.delta(problem));
    let mut best: Vec<Contender> = Vec::new();
    for (&candidate, mut score) in candidates.iter().zip(of_deltas) {
        if candidate.predicts_sum(problem) {
            score = of_sums.next().iter().fold(score, Score::tied);
        }
        let contender = judged(problem, candidate, &score);
        match best.iter_mut().find(|other| other.is_same_start(&contender)) {
            Some(other) if other.delta_bic >= contender.delta_bic => {}
            Some(other) => *other = contender,
            None => best.push(contender),
        }
    }
    best
}

/// The same effect, moved by the level as suits it best: the grid of places is too coarse for that.
pub fn shifted(problem: &Problem, gls: &GlsPair, contender: Contender) -> Contender {
    let candidates = Candidate::shifted(problem, &contender.effect, &contender.values);
    let scores = gls.delta.scores(&candidates, |candidate| candidate.delta(problem));
    let judged = candidates.iter().zip(scores).map(|(one, score)| judged(problem, one, &score));
    judged.fold(contender, |best, next| if next.delta_bic > best.delta_bic { next } else { best })
}

fn judged(problem: &Problem, candidate: &Candidate, score: &Score) -> Contender {
    let mut values = candidate.values.clone();
    let gain = if candidate.amplitudes.is_empty() {
        score.gain_as_is()
    } else {
        for (&index, amplitude) in candidate.amplitudes.iter().zip(score.amplitudes().iter().flatten()) {
            values[index] *= amplitude;
        }
        score.gain()
    };
    let delta_bic = gain - problem.parameter_cost() * candidate.effect.free().count() as f64;
    Contender { effect: candidate.effect.clone(), values, delta_bic, noises: None, determined: true }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnose::example::{Recipe, disturbed, effect, problem, warmed_up, white};
    use crate::diagnose::problem::fixed;

    #[test]
    fn each_effect_has_its_best_shape_and_amplitude_and_the_known_ones_are_left_out() {
        let (campaign, truth) = warmed_up(&[2e-4, 500.0]);
        let (problem, none) = (problem(&campaign), EffectSet::NONE);
        let shown = ["warm-up", "thermal-lag", "thermal-gradient"].map(|name| effect(name, &campaign));
        let candidates = Candidate::all(&problem, &shown);
        let (residuals, noises) = (problem.forward.residuals(&none), white(&problem, &none, 5.0));
        let gls = GlsPair::new(&problem, &residuals, &fixed(&problem, &none), &noises).unwrap();
        let found = screen(&problem, &gls, &none, &candidates);
        assert_eq!(found.len(), 3);
        let warm_up = found.iter().find(|one| one.effect.about.name == "warm-up").unwrap();
        // The nearest shapes of the grid are 1.9 times apart.
        assert!((0.7..1.4).contains(&(warm_up.values[1] / 500.0)), "{:?}", warm_up.values);
        assert!((warm_up.values[0] / 2e-4 - 1.0).abs() < 0.3, "{:?}", warm_up.values);
        assert!(found.iter().all(|one| one.delta_bic <= warm_up.delta_bic));
        // ΔBIC is the score's gain less what its parameters cost; what comes in one size is judged as it is.
        for (name, parameters) in [("warm-up", 2.0), ("thermal-lag", 1.0)] {
            let own = candidates.iter().filter(|one| one.effect.about.name == name);
            let gain = own.map(|one| {
                let score = gls.delta.score(&one.delta(&problem));
                if name == "thermal-lag" { score.gain_as_is() } else { score.gain() }
            });
            let worked = gain.fold(f64::NEG_INFINITY, f64::max) - parameters * problem.parameter_cost();
            let best = found.iter().find(|one| one.effect.about.name == name).unwrap().delta_bic;
            assert!((best - worked).abs() < 1e-6 * worked.abs(), "{name}: {best} {worked}");
        }
        let found = screen(&problem, &gls, &truth, &candidates);
        assert!(found.iter().all(|one| one.effect.about.name != "warm-up") && found.len() == 2);
    }

    #[test]
    fn what_the_level_moves_is_found_where_it_sits_and_never_gets_worse() {
        let still = Recipe::default().campaign();
        let truth = EffectSet::NONE.with(&effect("mode-crossing", &still), &[2e-4, 2.0, 20.0, 7.0]);
        let campaign = disturbed(still, &truth);
        let (problem, none) = (problem(&campaign), EffectSet::NONE);
        let noises = white(&problem, &none, 5.0);
        let gls = GlsPair::new(&problem, &problem.forward.residuals(&none), &fixed(&problem, &none), &noises).unwrap();
        let unmoved = Contender {
            effect: truth.effects[0].clone(),
            values: vec![1e-4, 2.0, 20.0, 0.0],
            delta_bic: f64::NEG_INFINITY,
            noises: None,
            determined: true,
        };
        let moved = shifted(&problem, &gls, unmoved.clone());
        assert!(
            (moved.values[3] - 7.0).abs() < 2.0 && (moved.values[0] / 2e-4 - 1.0).abs() < 0.3,
            "{:?}",
            moved.values
        );
        let unbeaten = Contender { delta_bic: f64::INFINITY, ..unmoved };
        assert_eq!(shifted(&problem, &gls, unbeaten.clone()).values, unbeaten.values);
    }
}
