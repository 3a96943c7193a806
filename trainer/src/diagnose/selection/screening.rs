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
    Contender { effect: candidate.effect.clone(), values, delta_bic, noises: None }
}
