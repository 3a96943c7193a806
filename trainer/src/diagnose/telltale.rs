//! Structure that neither noise nor a known effect makes: whoever sees it knows that something is missing, not what.
//!
//! ```text
//! the day          the same course every 24 h or tide, by the calendar
//! one run          its own course over temperature, unlike all other runs
//! a record         what the hottest or coldest moment so far left behind for good
//! a kink           at 0 g, where a smooth instrument has none
//! a quantity       a smooth function of the level, of time, of a channel
//! a period         whatever its phase (`period`)
//! poses            a scatter from position to position that no table explains
//! ```
//!
//! Each is judged as an effect is: fitted, the noise estimated again with it, and its evidence weighed. It must also be
//! of a size that matters, because no formula is exact.

use super::case::{Case, Noises, generous};
use super::dependence::TEMPERATURE;
use super::evidence::{Bench, Score, stacked, width};
use super::instrument::Known;
use super::noise_search::noise;
use super::suspect::{Course, Suspect};
use super::whitening::{Columns, MOUNTING, NoiseModel, POSE, POSITION, RUN, TURN};
use nalgebra::DMatrix;
use rayon::prelude::*;
use std::borrow::Cow;

/// What gives away that something is missing.
#[derive(Clone, Debug)]
pub(super) struct Telltale {
    /// The quantities that it depends on.
    pub depends_on: Vec<String>,
    /// Its period, if it has one.
    pub period_s: Option<f64>,
    /// Twice the gain in log likelihood, less what its amplitudes are worth.
    pub evidence: f64,
    /// Size of what the instrument can't absorb of it, in all samples, µg RMS.
    pub size_ug: f64,
}

/// Evidence that a structure must have; there are a hundred to choose from.
const ENOUGH: f64 = 30.0;
/// And what is asked by itself: the kink, of a smooth instrument;
const ENOUGH_OF_KINK: f64 = 10.0;
/// what the hottest and coldest moments left, of which a few nodes must tell: their scatter had evidence of 11 and 12 in
/// two rigs of a hundred.
const ENOUGH_OF_RECORD: f64 = 15.0;
/// And its size, in units of the noise of a sample.
const MATTERS: f64 = 0.5;
/// So many are judged in full, by the noise as estimated and by a small one.
const FINALISTS: usize = 3;
/// How often amplitudes and noise are fitted in turn.
const TURNS: usize = 2;
/// Scatters from level to level that are tried beside a kink, in units of the noise of a sample.
const SCATTERS: [f64; 9] = [0.0, 0.03, 0.1, 0.2, 0.4, 0.8, 1.6, 3.2, 6.4];
/// A network that was trained on runs with an offset each follows their mean by this share of its uncertainty.
const BENT: f64 = 0.5;

impl Case<'_> {
    /// Everything that gives away something missing beside these effects, the surest first.
    pub fn telltales(&self, known: &Known, noises: &Noises, channels: &[String]) -> Vec<Telltale> {
        let (left, freedom) = (self.left(known).delta, self.adapting(known, noises).delta);
        let scene = Scene { case: self, noise: noises.delta, left: &left };
        let Some(instrument) = scene.free(&freedom) else { return Vec::new() };
        let mut suspects = self.structures();
        let other = self.followed(channels).into_iter().filter(|(name, _)| name != TEMPERATURE);
        suspects.extend(other.map(|(name, columns)| Suspect {
            depends_on: vec![name],
            period_s: None,
            course: Course::All(columns),
        }));
        let mut found = scene.followed(&suspects, &instrument);
        found.extend(scene.poses(&instrument));
        found.extend(self.swing(known, noises));
        found.retain(|one| one.evidence > ENOUGH);
        let records = self.records().into_par_iter().filter_map(|record| scene.judged(&record, &instrument));
        found.extend(records.filter(|one| one.evidence > ENOUGH_OF_RECORD).collect::<Vec<_>>());
        found.extend(scene.kinked().filter(|one| one.evidence > ENOUGH_OF_KINK));
        found.retain(|one| self.matters(one));
        found.sort_by(|a, b| b.evidence.total_cmp(&a.evidence));
        found
    }

    /// Most evidence of a structure of a size that matters, which no known effect has, where these effects are at work.
    pub fn strangest(&self, known: &Known, noises: &Noises) -> f64 {
        let (left, freedom) = (self.left(known).delta, self.adapting(known, noises).delta);
        let scene = Scene { case: self, noise: noises.delta, left: &left };
        let Some(instrument) = scene.free(&freedom) else { return f64::NEG_INFINITY };
        let mut structures = self.structures();
        structures.extend(self.records());
        let all = scene.followed(&structures, &instrument).into_iter().chain(self.swing(known, noises));
        all.filter(|one| self.matters(one)).map(|one| one.evidence).fold(f64::NEG_INFINITY, f64::max)
    }

    fn matters(&self, telltale: &Telltale) -> bool {
        telltale.size_ug > MATTERS * self.sample_ug
    }
}

/// What stays the same while suspects are compared.
struct Scene<'a> {
    case: &'a Case<'a>,
    noise: NoiseModel,
    left: &'a Columns,
}

/// What may absorb a structure, and how likely that makes what was measured where there is none.
struct Free<'a> {
    columns: &'a Columns,
    deviance: f64,
}

impl Scene<'_> {
    fn bench(&self, noise: NoiseModel, left: &Columns, freedom: &Columns) -> Option<Bench> {
        Bench::new(&self.case.layout, noise, left, freedom)
    }

    fn free<'f>(&self, columns: &'f Columns) -> Option<Free<'f>> {
        let without = noise(&self.case.layout, self.left, columns, self.noise, false);
        Some(Free { columns, deviance: self.bench(without, self.left, columns)?.deviance })
    }

    /// The most striking suspects, judged in full.
    fn followed(&self, suspects: &[Suspect], free: &Free) -> Vec<Telltale> {
        let mut finalists: Vec<&Suspect> = Vec::new();
        for noise in [self.noise, self.noise.small()] {
            for suspect in self.screened(noise, suspects, free) {
                if !finalists.iter().any(|other| std::ptr::eq(*other, suspect)) {
                    finalists.push(suspect);
                }
            }
        }
        finalists.into_par_iter().filter_map(|suspect| self.judged(suspect, free)).collect()
    }

    fn screened<'s>(&self, noise: NoiseModel, suspects: &'s [Suspect], free: &Free) -> Vec<&'s Suspect> {
        let Some(bench) = self.bench(noise, self.left, free.columns) else { return Vec::new() };
        let everywhere = |suspect: &'s Suspect| match &suspect.course {
            Course::All(columns) => Some(columns),
            Course::One(..) => None,
        };
        let columns: Vec<&Columns> = suspects.iter().filter_map(everywhere).collect();
        let price = |suspect: &Suspect| self.case.price() * suspect.course.width() as f64;
        let mut of_all = bench.scores(&columns, |columns| Cow::Borrowed(*columns)).into_iter();
        let score = |suspect: &'s Suspect| match &suspect.course {
            Course::All(_) => of_all.next(),
            Course::One(run, columns) => Some(bench.score_in(*run, columns)),
        };
        let scores: Vec<Option<Score>> = suspects.iter().map(score).collect();
        let scores = scores.into_iter().zip(suspects).filter_map(|(score, suspect)| Some((score?, suspect)));
        let mut order: Vec<(f64, &Suspect)> =
            scores.map(|(score, suspect)| (score.gain() - price(suspect), suspect)).collect();
        order.sort_by(|a, b| b.0.total_cmp(&a.0));
        order.into_iter().take(FINALISTS).map(|(_, suspect)| suspect).collect()
    }

    /// Fits amplitudes and noise in turn, where an instrument of this freedom may absorb what it can.
    fn judged(&self, suspect: &Suspect, free: &Free) -> Option<Telltale> {
        let (freedom, columns) = (free.columns, suspect.course.whole(&self.case.layout));
        let widened = stacked(freedom, &generous(&columns, self.case.sample_ug));
        let (mut with, mut fitted, mut size_ug) = (self.noise, self.left.clone(), 0.0);
        for _ in 0..TURNS {
            let bench = self.bench(with, self.left, freedom)?;
            let score = bench.score(&columns);
            let amplitudes = DMatrix::from_column_slice(width(&columns), 1, score.amplitudes()?.as_slice());
            let course: Columns = columns.iter().map(|run| run * &amplitudes).collect();
            size_ug = self.case.rms_ug(&bench.beyond(&course, freedom));
            fitted = self.left.iter().zip(&course).map(|(left, course)| left + course).collect();
            with = noise(&self.case.layout, &fitted, &widened, with, false);
        }
        let gain = free.deviance - self.bench(with, &fitted, freedom)?.deviance;
        let evidence = gain - self.case.price() * width(&columns) as f64;
        Some(Telltale { depends_on: suspect.depends_on.clone(), period_s: suspect.period_s, evidence, size_ug })
    }

    /// The kink, if it is more than levels that scatter about a smooth curve: a table's error is the same at every visit.
    fn kinked(&self) -> Option<Telltale> {
        let (kink, levels) = (self.case.kink(), self.case.levels());
        let course = kink.course.whole(&self.case.layout);
        // Only a smooth instrument may absorb it, not whatever a network may be bent to.
        let smooth = self.case.instrument.smooth(&self.case.layout);
        let is_kink = |one: &Telltale| one.evidence > ENOUGH_OF_KINK && one.size_ug > self.bent_ug();
        let telltale = self.judged(&kink, &self.free(&smooth)?).filter(is_kink)?;
        let deviances = |scatter: &f64| {
            let levels: Columns = levels.iter().map(|run| run * (scatter * self.case.sample_ug)).collect();
            let bench = self.bench(self.noise, self.left, &stacked(&smooth, &levels))?;
            Some([bench.deviance, bench.deviance - bench.score(&course).gain()])
        };
        let tried: Vec<[f64; 2]> = SCATTERS.par_iter().filter_map(deviances).collect();
        let [without, with] = [0, 1].map(|side| tried.iter().map(|both| both[side]).fold(f64::INFINITY, f64::min));
        let evidence = without - with - self.case.price() * width(&course) as f64;
        Some(Telltale { evidence: telltale.evidence.min(evidence), ..telltale })
    }

    /// How far training may have been bent by what is new at every start and at every position, µg.
    fn bent_ug(&self) -> f64 {
        let squares = [RUN, MOUNTING, POSITION, TURN].map(|part| self.noise.parts[part].powi(2));
        BENT * (squares.iter().sum::<f64>() / self.left.len() as f64).sqrt()
    }

    /// Whether the noise is less likely without a scatter that every position has of its own.
    fn poses(&self, free: &Free) -> Option<Telltale> {
        let mut start = self.noise;
        start.parts[POSE] = 0.0;
        let without = noise(&self.case.layout, self.left, free.columns, start, false);
        let with = self.bench(self.noise, self.left, free.columns)?.deviance;
        let evidence = self.bench(without, self.left, free.columns)?.deviance - with - self.case.price();
        let depends_on = vec!["reference_g".to_owned(), "position".to_owned()];
        Some(Telltale { depends_on, period_s: None, evidence, size_ug: self.noise.parts[POSE] })
    }
}
