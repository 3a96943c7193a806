//! Every effect that might be missing, at every shape worth trying.

use super::shapes::{shapes, unit, width_c};
use crate::diagnose::cells::{Columns, difference, joined};
use crate::diagnose::forward::{CellResiduals, EffectSet, amplitudes};
use crate::diagnose::problem::Problem;
use crate::diagnose::thresholds::{LEAST_LEVEL_G, MOST_SHIFTS, PLACE_STEP, SHIFTS};
use crate::fit::effects::Chosen;
use nalgebra::DMatrix;
use rayon::prelude::*;
use std::borrow::Cow;

/// One effect at one shape.
pub struct Candidate {
    /// The effect.
    pub effect: Chosen,
    /// Coefficients with every amplitude at its unit.
    pub values: Vec<f64>,
    /// Indices of the amplitudes; none if the effect comes in one size.
    pub amplitudes: Vec<usize>,
    /// Its columns, if there was room to keep them; they are made anew whenever they are asked for otherwise.
    kept: Option<Made>,
}

/// A candidate's columns.
struct Made {
    /// What a unit of each amplitude (or the effect as it is) adds to the residual once compensated, µg.
    delta: Columns,
    /// The same of the sum of the frequencies, mHz, where it is measured and the effect says what it does to it.
    sum: Option<Columns>,
}

/// Columns of all candidates together are kept up to so many bytes: they would grow with runs × candidates.
const KEPT_BYTES: usize = 256 << 20;
/// What a matrix takes beside its numbers: itself, and what the allocator needs.
const MATRIX_BYTES: usize = size_of::<DMatrix<f64>>() + 16;

impl Candidate {
    /// All of them. `shown` says which effects this campaign can show.
    pub fn all(problem: &Problem, shown: &[Chosen]) -> Vec<Self> {
        Self::all_within(problem, shown, KEPT_BYTES)
    }

    /// All of them, of which the first are kept that have room in so many bytes.
    fn all_within(problem: &Problem, shown: &[Chosen], mut bytes: usize) -> Vec<Self> {
        let map_alone = problem.forward.residuals(&EffectSet::NONE);
        let shapes =
            shown.iter().flat_map(|effect| shapes(effect, problem).into_iter().map(|values| (effect.clone(), values)));
        let mut all: Vec<Self> = shapes.map(|(effect, values)| Self::new(effect, values)).collect();
        let has_room = |candidate: &&mut Self| {
            let rest = bytes.checked_sub(candidate.bytes(problem));
            bytes = rest.unwrap_or(0);
            rest.is_some()
        };
        let kept: Vec<&mut Self> = all.iter_mut().take_while(has_room).collect();
        kept.into_par_iter().for_each(|candidate| candidate.kept = Some(candidate.made(problem, &map_alone)));
        all
    }

    /// An effect that sits at a place, at that place and width, moved by the level in each way that its width tells apart.
    pub fn shifted(problem: &Problem, effect: &Chosen, values: &[f64]) -> Vec<Self> {
        let Some(shift) = effect.about.parameters.iter().position(|about| about.unit == "°C/g") else {
            return Vec::new();
        };
        let most_g = problem.cells().iter().map(|cell| cell.level_g.abs()).fold(LEAST_LEVEL_G, f64::max);
        let most_c_per_g = SHIFTS.into_iter().fold(0.0, f64::max) * problem.forward.shift_c_per_g();
        let step_c_per_g = width_c(effect.about, values) * PLACE_STEP / most_g;
        let count = (most_c_per_g / step_c_per_g).ceil().clamp(1.0, MOST_SHIFTS);
        let at = |k: i32| {
            let mut values = values.to_vec();
            amplitudes(effect.about).into_iter().for_each(|index| values[index] = unit(effect, index));
            let about = &effect.about.parameters[shift];
            values[shift] = (f64::from(k) / count * most_c_per_g).clamp(about.low, about.high);
            Self::new(effect.clone(), values)
        };
        (-count as i32..=count as i32).map(at).collect()
    }

    fn new(effect: Chosen, values: Vec<f64>) -> Self {
        let amplitudes = amplitudes(effect.about);
        Self { effect, values, amplitudes, kept: None }
    }

    /// What a unit of each amplitude (or the effect as it is) adds to the residual once compensated, µg: of each run
    /// cells × amplitudes (or × 1).
    pub fn delta(&self, problem: &Problem) -> Cow<'_, Columns> {
        match &self.kept {
            Some(made) => Cow::Borrowed(&made.delta),
            None => Cow::Owned(self.made(problem, &problem.forward.residuals(&EffectSet::NONE)).delta),
        }
    }

    /// The same of the sum of the frequencies, mHz, where it is [predicted](Self::predicts_sum); of the same shape.
    pub fn sum(&self, problem: &Problem) -> Option<Cow<'_, Columns>> {
        match &self.kept {
            Some(made) => made.sum.as_ref().map(Cow::Borrowed),
            None if self.predicts_sum(problem) => {
                self.made(problem, &problem.forward.residuals(&EffectSet::NONE)).sum.map(Cow::Owned)
            }
            None => None,
        }
    }

    /// Whether the sum of the frequencies is measured and the effect says what it does to it.
    pub fn predicts_sum(&self, problem: &Problem) -> bool {
        problem.forward.sum.is_some() && self.effect.about.sum_response.is_predicted()
    }

    /// What its columns take.
    fn bytes(&self, problem: &Problem) -> usize {
        let numbers = problem.cells().len() * self.amplitudes.len().max(1) * size_of::<f64>();
        let one = numbers + problem.cells().runs.len() * MATRIX_BYTES;
        if self.predicts_sum(problem) { 2 * one } else { one }
    }

    fn made(&self, problem: &Problem, map_alone: &CellResiduals) -> Made {
        let (mut columns, mut sums): (Vec<Columns>, Vec<Columns>) = (Vec::new(), Vec::new());
        for only in 0..self.amplitudes.len().max(1) {
            let mut values = self.values.clone();
            let others = self.amplitudes.iter().filter(|&&index| index != self.amplitudes[only]);
            others.for_each(|&index| values[index] = 0.0);
            let residuals = problem.forward.residuals(&EffectSet::NONE.with(&self.effect, &values));
            columns.push(difference(&residuals.delta, &map_alone.delta));
            let both = residuals.sum.as_ref().zip(map_alone.sum.as_ref()).filter(|_| self.predicts_sum(problem));
            sums.extend(both.map(|(moved, map)| difference(moved, map)));
        }
        let sum = (!sums.is_empty()).then(|| joined(&sums));
        Made { delta: joined(&columns), sum }
    }
}

#[cfg(test)]
mod tests {
    use super::super::catalogue::with_channels;
    use super::super::screening::screen;
    use super::*;
    use crate::campaign::{Campaign, HoldOut, Quantity, Row, Run};
    use crate::diagnose::problem::{self, GlsPair, estimate, initial_states};
    use crate::model::Model;
    use crate::progress::Quiet;
    use crate::train::{TrainSettings, train};
    use crate::yardstick::Yardstick;
    use protocol::Sample;
    use std::path::PathBuf;

    /// Two forks that warm up and are turned, run by run; a lag of two samples.
    fn campaign(runs: u64, rows: u64) -> Campaign {
        let row = |run: u64, k: u64| {
            let celsius = |k: u64| -10.0 + ((run * 7 + k) % 60) as f64;
            let (level_g, warm_c) = (f64::sin((k / 2 + run) as f64), celsius(k + 58) - 20.0);
            let noise_hz = ((run * 131 + k * 37) % 23) as f64 * 1e-4;
            let difference_hz = 76.0 + 420.0 * level_g + 0.3 * warm_c + noise_hz;
            let (f1_hz, f2_hz) =
                (40_000.0 - 2.4 * warm_c + difference_hz / 2.0, 40_000.0 - 2.4 * warm_c - difference_hz / 2.0);
            let [f1_uhz, f2_uhz] = [f1_hz, f2_hz].map(|hz| (hz * 1e6) as u64);
            let sample = Sample::from_pair(k * 60_000_000, f1_uhz, f2_uhz, (celsius(k) * 1e6) as i32);
            Row { sample, reference_g: level_g, reference_sigma_g: None }
        };
        let run = |number: u64| Run {
            name: format!("r{number}"),
            kind: "ramp".to_owned(),
            source: PathBuf::new(),
            rows: (0..rows).map(|k| row(number, k)).collect(),
        };
        Campaign::new((0..runs).map(run).collect(), Vec::new(), Quantity::default())
    }

    fn model(campaign: &Campaign) -> Model {
        let split = campaign.split(&HoldOut::None).unwrap();
        train(campaign, &split, &TrainSettings { restarts: 1, ..TrainSettings::new(1) }, &Quiet).unwrap().model
    }

    fn kept(candidates: &[Candidate]) -> impl Iterator<Item = &Made> {
        candidates.iter().filter_map(|candidate| candidate.kept.as_ref())
    }

    fn numbers(columns: &Columns) -> usize {
        columns.iter().map(DMatrix::len).sum()
    }

    #[test]
    fn what_is_not_kept_is_judged_as_what_is_to_the_last_bit() {
        let campaign = campaign(6, 40);
        let model = model(&campaign);
        let yardstick = Yardstick::of_model(&model, &campaign).unwrap();
        let campaign = yardstick.campaign(&campaign);
        let problem = problem::problem(&model, &campaign, &yardstick).unwrap();
        let shown = with_channels(&campaign);
        let (residuals, nuisance) =
            (problem.forward.residuals(&EffectSet::NONE), problem::fixed(&problem, &EffectSet::NONE));
        let noises = estimate(&problem, &residuals, &nuisance, &initial_states(&problem, &EffectSet::NONE));
        let gls = GlsPair::new(&problem, &residuals, &nuisance, &noises).unwrap();
        let judged = |bytes: usize| {
            let all = Candidate::all_within(&problem, &shown, bytes);
            let found = screen(&problem, &gls, &EffectSet::NONE, &all).into_iter();
            let bits = |value: &f64| value.to_bits();
            let found = found.map(|one| (one.delta_bic.to_bits(), one.values.iter().map(bits).collect::<Vec<u64>>()));
            (kept(&all).count(), all.len(), found.collect::<Vec<_>>())
        };
        let [(none, _, without), (some, _, partly), (all, count, with)] = [0, 200_000, usize::MAX].map(judged);
        assert!(none == 0 && 0 < some && some < count && all == count, "{none} {some} {all} {count}");
        assert!(with.len() > 5, "{} candidates", with.len());
        assert_eq!(without, with);
        assert_eq!(partly, with);
    }

    #[test]
    fn however_many_runs_there_are_no_more_is_kept_than_there_is_room_for() {
        let model = model(&campaign(6, 40));
        let campaign = campaign(8000, 4);
        let yardstick = Yardstick::of_model(&model, &campaign).unwrap();
        let campaign = yardstick.campaign(&campaign);
        let problem = problem::problem(&model, &campaign, &yardstick).unwrap();
        let all = Candidate::all(&problem, &with_channels(&campaign));
        // Of a run of two cells the matrix is more than the numbers in it.
        let bytes = |columns: &Columns| size_of_val(columns.as_slice()) + numbers(columns) * size_of::<f64>();
        let total: usize = kept(&all).map(|made| bytes(&made.delta) + made.sum.as_ref().map_or(0, bytes)).sum();
        let (count, of) = (kept(&all).count(), all.len());
        assert!(total <= KEPT_BYTES && total > KEPT_BYTES / 2 && count < of, "{total} {count} of {of}");
    }
}
