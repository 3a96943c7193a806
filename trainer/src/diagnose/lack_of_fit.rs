//! Lack of fit: structure that neither noise nor a known effect makes. Whoever sees it knows that something is missing,
//! not what.
//!
//! ```text
//! structure      what it is                                               made by            overrules an effect
//! the day        the same course every 24 h or tide, by the calendar      rivals_of_effects  yes
//! one run        its own course over temperature, unlike all other runs   rivals_of_effects  yes
//! an extremum    what the hottest or coldest moment so far left for good  running_extrema    yes
//! a period       whatever its phase                                       periodogram        yes
//! rectification  a kink at 0 g, where a smooth instrument has none        rectified          no
//! a quantity     a smooth function of the level, of time, of a channel    dependence         no
//! poses          a scatter between positions that no table explains       Scene::poses       no
//! ```
//!
//! Each is judged as an effect is: fitted, the noise estimated again with it, and its ΔBIC weighed. It must also be
//! of a size that matters, because no formula is exact. What overrules an effect is compared with it before the effect is
//! believed (`largest_alternative`, asked by `verdict`); those are few, as only the most striking are judged in full.

mod dependence;
mod periodogram;
mod structure;

pub(super) use dependence::dependences;

use super::cells::{Columns, generous, stacked, width};
use super::forward::{EffectSet, retraining};
use super::noise::{Component, InitialStates, NoiseModel};
use super::problem::{NoiseModels, Problem, constrained};
use super::regression::{Gls, Measured, Score};
use crate::diagnose::thresholds::{
    BENT, LEAST_EXTREMUM, LEAST_LACK_OF_FIT, LEAST_RECTIFIED, LEVEL_SCATTERS, MATTERS, STRUCTURE_TURNS,
    STRUCTURES_JUDGED,
};
use dependence::{TEMPERATURE, followed};
use nalgebra::DMatrix;
use periodogram::periodic;
use rayon::prelude::*;
use std::borrow::Cow;
pub(super) use structure::LackOfFit;
use structure::{Alternative, Course, levels, rectified, rivals_of_effects, running_extrema};

/// Everything that gives away something missing beside these effects, the surest first.
pub(super) fn lack_of_fit(
    problem: &Problem,
    known: &EffectSet,
    noises: &NoiseModels,
    channels: &[String],
) -> Vec<LackOfFit> {
    let (residual, nuisance) = (problem.forward.residuals(known).delta, constrained(problem, known, noises).delta);
    let scene = Scene { problem, initial: &noises.initial, noise: noises.delta, residual: &residual };
    let Some(map) = scene.free(&nuisance) else { return Vec::new() };
    let mut alternatives = rivals_of_effects(problem);
    let other = followed(problem, channels).into_iter().filter(|(name, _)| name != TEMPERATURE);
    alternatives.extend(other.map(|(name, columns)| Alternative {
        depends_on: vec![name],
        period_s: None,
        course: Course::All(columns),
    }));
    let mut found = scene.followed(&alternatives, &map);
    found.extend(scene.poses(&map));
    found.extend(periodic(problem, known, noises));
    found.retain(|one| one.delta_bic > LEAST_LACK_OF_FIT);
    let extrema = running_extrema(problem).into_par_iter().filter_map(|extremum| scene.judged(&extremum, &map));
    found.extend(extrema.filter(|one| one.delta_bic > LEAST_EXTREMUM).collect::<Vec<_>>());
    found.extend(scene.rectified().filter(|one| one.delta_bic > LEAST_RECTIFIED));
    found.retain(|one| matters(problem, one));
    found.sort_by(|a, b| b.delta_bic.total_cmp(&a.delta_bic));
    found
}

/// Largest ΔBIC of a structure of a size that matters, which no known effect has, where these effects are at work.
pub(super) fn largest_alternative(problem: &Problem, known: &EffectSet, noises: &NoiseModels) -> f64 {
    let (residual, nuisance) = (problem.forward.residuals(known).delta, constrained(problem, known, noises).delta);
    let scene = Scene { problem, initial: &noises.initial, noise: noises.delta, residual: &residual };
    let Some(map) = scene.free(&nuisance) else { return f64::NEG_INFINITY };
    let mut structures = rivals_of_effects(problem);
    structures.extend(running_extrema(problem));
    let all = scene.followed(&structures, &map).into_iter().chain(periodic(problem, known, noises));
    all.filter(|one| matters(problem, one)).map(|one| one.delta_bic).fold(f64::NEG_INFINITY, f64::max)
}

fn matters(problem: &Problem, found: &LackOfFit) -> bool {
    found.size_ug > MATTERS * problem.sample_ug
}

/// What stays the same while alternatives are compared.
struct Scene<'a> {
    problem: &'a Problem<'a>,
    initial: &'a InitialStates,
    noise: NoiseModel,
    residual: &'a Columns,
}

/// What may absorb a structure, and how likely that makes what was measured where there is none.
struct Free<'a> {
    columns: &'a Columns,
    deviance: f64,
}

impl Scene<'_> {
    fn measured<'m>(&'m self, residual: &'m Columns, nuisance: &'m Columns) -> Measured<'m> {
        Measured { cells: self.problem.cells(), initial: self.initial, residual, nuisance }
    }

    fn gls(&self, noise: &NoiseModel, residual: &Columns, nuisance: &Columns) -> Option<Gls> {
        self.measured(residual, nuisance).gls(noise)
    }

    fn free<'f>(&self, columns: &'f Columns) -> Option<Free<'f>> {
        let without = self.measured(self.residual, columns).noise(self.noise, false);
        Some(Free { columns, deviance: self.gls(&without, self.residual, columns)?.deviance })
    }

    /// The most striking alternatives, judged in full.
    fn followed(&self, alternatives: &[Alternative], free: &Free) -> Vec<LackOfFit> {
        let mut finalists: Vec<&Alternative> = Vec::new();
        for noise in [self.noise, self.noise.small()] {
            for alternative in self.screened(noise, alternatives, free) {
                if !finalists.iter().any(|other| std::ptr::eq(*other, alternative)) {
                    finalists.push(alternative);
                }
            }
        }
        finalists.into_par_iter().filter_map(|alternative| self.judged(alternative, free)).collect()
    }

    fn screened<'s>(&self, noise: NoiseModel, alternatives: &'s [Alternative], free: &Free) -> Vec<&'s Alternative> {
        let Some(gls) = self.gls(&noise, self.residual, free.columns) else { return Vec::new() };
        let everywhere = |alternative: &'s Alternative| match &alternative.course {
            Course::All(columns) => Some(columns),
            Course::One(..) => None,
        };
        let columns: Vec<&Columns> = alternatives.iter().filter_map(everywhere).collect();
        let cost = |alternative: &Alternative| self.problem.parameter_cost() * alternative.course.width() as f64;
        let mut of_all = gls.scores(&columns, |columns| Cow::Borrowed(*columns)).into_iter();
        let score = |alternative: &'s Alternative| match &alternative.course {
            Course::All(_) => of_all.next(),
            Course::One(run, columns) => Some(gls.score_in(*run, columns)),
        };
        let scores: Vec<Option<Score>> = alternatives.iter().map(score).collect();
        let scores =
            scores.into_iter().zip(alternatives).filter_map(|(score, alternative)| Some((score?, alternative)));
        let mut order: Vec<(f64, &Alternative)> =
            scores.map(|(score, alternative)| (score.gain() - cost(alternative), alternative)).collect();
        order.sort_by(|a, b| b.0.total_cmp(&a.0));
        order.into_iter().take(STRUCTURES_JUDGED).map(|(_, alternative)| alternative).collect()
    }

    /// Fits amplitudes and noise in turn, where a map that is free may absorb what it can.
    fn judged(&self, alternative: &Alternative, free: &Free) -> Option<LackOfFit> {
        let (nuisance, columns) = (free.columns, alternative.course.whole(self.problem.cells()));
        let widened = stacked(nuisance, &generous(&columns, self.problem.sample_ug));
        let (mut with, mut fitted, mut size_ug) = (self.noise, self.residual.clone(), 0.0);
        for _ in 0..STRUCTURE_TURNS {
            let gls = self.gls(&with, self.residual, nuisance)?;
            let score = gls.score(&columns);
            let amplitudes = DMatrix::from_column_slice(width(&columns), 1, score.amplitudes()?.as_slice());
            let course: Columns = columns.iter().map(|run| run * &amplitudes).collect();
            size_ug = self.problem.cells().rms(&gls.beyond(&course, nuisance));
            fitted = self.residual.iter().zip(&course).map(|(residual, course)| residual + course).collect();
            with = self.measured(&fitted, &widened).noise(with, false);
        }
        let gain = free.deviance - self.gls(&with, &fitted, nuisance)?.deviance;
        let delta_bic = gain - self.problem.parameter_cost() * width(&columns) as f64;
        Some(LackOfFit {
            depends_on: alternative.depends_on.clone(),
            period_s: alternative.period_s,
            delta_bic,
            size_ug,
        })
    }

    /// The kink, if it is more than levels that scatter about a smooth curve: a table's error is the same at every visit.
    fn rectified(&self) -> Option<LackOfFit> {
        let (kink, levels) = (rectified(self.problem), levels(self.problem));
        let course = kink.course.whole(self.problem.cells());
        // Only a smooth map may absorb it, not whatever a network may be bent to.
        let smooth = retraining::of_smooth_map(&self.problem.forward.map, self.problem.cells());
        let is_kink = |one: &LackOfFit| one.delta_bic > LEAST_RECTIFIED && one.size_ug > self.bent_ug();
        let found = self.judged(&kink, &self.free(&smooth)?).filter(is_kink)?;
        let deviances = |scatter: &f64| {
            let levels: Columns = levels.iter().map(|run| run * (scatter * self.problem.sample_ug)).collect();
            let gls = self.gls(&self.noise, self.residual, &stacked(&smooth, &levels))?;
            Some([gls.deviance, gls.deviance - gls.score(&course).gain()])
        };
        let tried: Vec<[f64; 2]> = LEVEL_SCATTERS.par_iter().filter_map(deviances).collect();
        let [without, with] = [0, 1].map(|side| tried.iter().map(|both| both[side]).fold(f64::INFINITY, f64::min));
        let delta_bic = without - with - self.problem.parameter_cost() * width(&course) as f64;
        Some(LackOfFit { delta_bic: found.delta_bic.min(delta_bic), ..found })
    }

    /// How far training may have been bent by what is new at every start and at every position, µg.
    fn bent_ug(&self) -> f64 {
        let parts = Component::ALL.into_iter().filter(|component| component.is_of_the_rig());
        let squares = parts.map(|component| self.noise[component].powi(2));
        BENT * (squares.sum::<f64>() / self.residual.len() as f64).sqrt()
    }

    /// Whether the noise is less likely without a scatter that every position has of its own.
    fn poses(&self, free: &Free) -> Option<LackOfFit> {
        let mut start = self.noise;
        start[Component::Pose] = 0.0;
        let without = self.measured(self.residual, free.columns).noise(start, false);
        let with = self.gls(&self.noise, self.residual, free.columns)?.deviance;
        let delta_bic =
            self.gls(&without, self.residual, free.columns)?.deviance - with - self.problem.parameter_cost();
        let depends_on = vec!["reference_g".to_owned(), "position".to_owned()];
        Some(LackOfFit { depends_on, period_s: None, delta_bic, size_ug: self.noise[Component::Pose] })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnose::example::{Gauss, Moment, Recipe, problem};
    use crate::diagnose::problem::{estimate, fixed, initial_states};
    use std::f64::consts::TAU;

    fn found(recipe: &Recipe) -> Vec<LackOfFit> {
        let campaign = recipe.campaign();
        let (problem, none) = (problem(&campaign), EffectSet::NONE);
        let residuals = problem.forward.residuals(&none);
        let noises = estimate(&problem, &residuals, &fixed(&problem, &none), &initial_states(&problem, &none));
        lack_of_fit(&problem, &none, &noises, &campaign.channels)
    }

    fn with(bias_g: &dyn Fn(&Moment) -> f64) -> Vec<LackOfFit> {
        found(&Recipe { bias_g, ..Recipe::default() })
    }

    fn named<'a>(found: &'a [LackOfFit], on: &[&str]) -> Option<&'a LackOfFit> {
        found.iter().find(|one| one.depends_on == on)
    }

    #[test]
    fn noise_lacks_nothing() {
        let (white, offsets) = (with(&|_| 0.0), with(&|moment| [70e-6, -40e-6, 20e-6, -60e-6][moment.run]));
        assert!(white.is_empty() && offsets.is_empty(), "{white:?} {offsets:?}");
    }

    #[test]
    fn a_kink_at_0_g_is_rectification() {
        let found = with(&|moment| 60e-6 * moment.level_g.abs());
        let kink = named(&found, &["reference_g"]).unwrap();
        assert!(kink.delta_bic > LEAST_RECTIFIED && kink.size_ug > 5.0, "{kink:?}");
    }

    #[test]
    fn a_run_with_a_course_over_temperature_of_its_own_is_an_odd_run() {
        let found = with(&|moment| if moment.run == 2 { 3e-6 * (moment.temperature_c - 20.0) } else { 0.0 });
        let odd = named(&found, &["run", "temperature_c"]).unwrap();
        assert!(odd.delta_bic > LEAST_LACK_OF_FIT && odd.size_ug > 10.0, "{odd:?}");
    }

    #[test]
    fn a_period_is_named_with_its_length_and_its_size() {
        let found = with(&|moment| 40e-6 * (TAU * moment.time_s / 310.0 + moment.run as f64).sin());
        let periodic = found.iter().find(|one| one.period_s.is_some()).unwrap();
        assert_eq!(periodic.depends_on, ["time_s"]);
        assert!((periodic.period_s.unwrap() / 310.0 - 1.0).abs() < 0.05, "{periodic:?}");
        // What a wander could be is not counted.
        assert!((5.0..36.0).contains(&periodic.size_ug), "{periodic:?}");
    }

    #[test]
    fn a_channels_course_is_named_after_the_channel() {
        let mut gauss = Gauss::new(11);
        let values: Vec<f64> = (0..64).map(|_| gauss.next()).collect();
        // New every ten minutes.
        let course = |moment: &Moment| values[(moment.run * 13 + (moment.time_s / 600.0) as usize) % values.len()];
        let bias_g = |moment: &Moment| 40e-6 * course(moment);
        let found = found(&Recipe { channel: Some(("stranger", &course)), bias_g: &bias_g, ..Recipe::default() });
        let channel = named(&found, &["stranger"]).unwrap();
        assert!(channel.delta_bic > LEAST_LACK_OF_FIT && (20.0..60.0).contains(&channel.size_ug), "{found:?}");
    }

    #[test]
    fn what_matters_is_half_the_noise_of_a_sample() {
        let campaign = Recipe::default().campaign();
        let problem = problem(&campaign);
        let of_size = |share: f64| LackOfFit {
            depends_on: Vec::new(),
            period_s: None,
            delta_bic: 1e3,
            size_ug: share * problem.sample_ug,
        };
        assert!(matters(&problem, &of_size(0.51)) && !matters(&problem, &of_size(0.49)));
    }
}
