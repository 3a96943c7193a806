//! A hand-made model, campaigns of a few runs and their problem, for the tests of these folders: what they were made of
//! is known to the last digit.

use super::forward::EffectSet;
use super::noise::{Component, NoiseModel};
use super::problem::{self, NoiseModels, Problem, initial_states};
use crate::campaign::{Campaign, Quantity, ReadAs, Row, Run};
use crate::effect_choice::{EffectChoice, choose};
use crate::fit::effects::{Chosen, contributions};
use crate::model::{Model, ModelDomain, ModelNetwork, ModelScaling, Provenance, Units};
use crate::yardstick::Yardstick;
use nalgebra::DMatrix;
use protocol::Sample;
use std::path::PathBuf;

/// Frequency difference at 0 g and 20 °C, Hz.
const ZERO_HZ: f64 = 76.0;
/// Of the frequency difference, Hz/g. Like all that follows a dyadic number, so that the model's `f32` hold it exactly.
pub const HZ_PER_G: f64 = 409.6;
/// What the reading follows the temperature by at a given frequency difference, g/°C.
pub const G_PER_C: f64 = 1.0 / 1024.0;
/// The sum of the frequencies at 20 °C, Hz,
const SUM_HZ: f64 = 80_000.0;
/// and its slope, Hz/°C.
pub const SUM_HZ_PER_C: f64 = -4.8;
/// Between rows, s.
pub const STEP_S: f64 = 20.0;
/// So long a level is applied, rows.
const ROWS_OF_LEVEL: usize = 6;
/// The levels of a tumble, g.
const LEVELS_G: [f64; 5] = [0.0, 1.0, -0.5, -1.0, 0.5];
/// Corners of a run's temperature: s from its beginning, and shares of the way from the coldest to the hottest.
const CORNERS: [(f64, f64); 6] = [(0.0, 0.0), (600.0, 0.0), (2400.0, 1.0), (3000.0, 1.0), (3900.0, 0.0), (4500.0, 0.0)];
/// Coldest and hottest, °C.
pub const RANGE_C: (f64, f64) = (-10.0, 50.0);

/// A model whose network puts out nothing: it reads a line.
pub fn model() -> Model {
    Model {
        format: Model::FORMAT,
        serial: String::new(),
        provenance: Provenance {
            made_by: "tempco".to_owned(),
            campaign: "00".to_owned(),
            method: "by hand".to_owned(),
            seed: 1,
            restarts: 1,
            training_runs: Vec::new(),
            held_out_runs: Vec::new(),
            training_residual: 5e-6,
            scale_factor_hz_per_g: None,
            read_as: ReadAs::default(),
        },
        units: Units { signal: "Hz".to_owned(), reference: "g".to_owned() },
        scaling: ModelScaling {
            delta_f_zero_uhz: 76_000_000,
            delta_f_gain_per_hz: 1.0 / 512.0,
            temperature_zero_uc: 20_000_000,
            temperature_gain_per_c: 1.0 / 32.0,
            line_g: [0.0, 1.25, 1.0 / 32.0, 0.0],
            output_g: 0.003,
        },
        domain: ModelDomain {
            delta_f_uhz: [-436_000_000, 588_000_000],
            temperature_uc: [-12_000_000, 52_000_000],
            max_gap_us: 600_000_000,
        },
        network: ModelNetwork { input: [[0.25, -0.5]; 10], bias: [0.125; 10], output: [0.0; 10], output_bias: 0.0 },
        channels: Vec::new(),
        effects: Vec::new(),
    }
}

/// One row as it is made.
#[derive(Clone, Copy, Debug)]
pub struct Moment {
    /// Index of its run.
    pub run: usize,
    /// Time from the run's beginning, s.
    pub time_s: f64,
    /// Thermometer, °C.
    pub temperature_c: f64,
    /// Applied, g.
    pub level_g: f64,
}

/// What something does at each moment.
pub type Course<'a> = &'a dyn Fn(&Moment) -> f64;

/// What a campaign is made of.
pub struct Recipe<'a> {
    /// Runs.
    pub runs: usize,
    /// Rows of each run, at most as many as its temperature has a course.
    pub rows: usize,
    /// White noise of a sample, µg.
    pub sigma_ug: f64,
    /// What is read too much, g.
    pub bias_g: &'a dyn Fn(&Moment) -> f64,
    /// Whether the sum of the frequencies is measured; its noise, mHz, is as large as that of the difference in µg.
    pub sum: bool,
    /// An auxiliary channel and its course.
    pub channel: Option<(&'static str, Course<'a>)>,
    /// Days from the start of one run to that of the next, of a sensor whose age is known.
    pub days_apart: Option<u32>,
}

impl Default for Recipe<'_> {
    fn default() -> Self {
        Self { runs: 4, rows: 225, sigma_ug: 5.0, bias_g: &|_| 0.0, sum: false, channel: None, days_apart: None }
    }
}

impl Recipe<'_> {
    /// The campaign.
    pub fn campaign(&self) -> Campaign {
        let mut noise = Gauss::new(1);
        let run = |run: usize, noise: &mut Gauss| Run {
            name: format!("r{run}"),
            kind: "ramp".to_owned(),
            source: PathBuf::new(),
            rows: (0..self.rows).map(|row| self.row(run, row, noise)).collect(),
        };
        let runs = (0..self.runs).map(|number| run(number, &mut noise)).collect();
        let channels = self.channel.iter().map(|(name, _)| (*name).to_owned()).collect();
        Campaign::new(runs, channels, Quantity::default())
    }

    fn row(&self, run: usize, row: usize, noise: &mut Gauss) -> Row {
        let time_s = row as f64 * STEP_S;
        let level_g = LEVELS_G[(row / ROWS_OF_LEVEL + run) % LEVELS_G.len()];
        let moment = Moment { run, time_s, temperature_c: temperature_c(run, time_s), level_g };
        let warmer_c = moment.temperature_c - 20.0;
        let reading_g = level_g + (self.bias_g)(&moment) + noise.next() * self.sigma_ug * 1e-6;
        let difference_hz = ZERO_HZ + (reading_g - warmer_c * G_PER_C) * HZ_PER_G;
        let sum_hz = SUM_HZ + SUM_HZ_PER_C * warmer_c + noise.next() * self.sigma_ug * 1e-3;
        let mut sample =
            Sample::from_difference((time_s * 1e6) as u64, uhz(difference_hz), uhz(moment.temperature_c) as i32);
        sample.sum_f_uhz = self.sum.then_some(uhz(sum_hz) as u64);
        sample.age_s = self.days_apart.map(|days| run as u32 * days * 86_400 + time_s as u32);
        if let Some((_, course)) = &self.channel {
            sample.channels[0] = uhz(course(&moment));
        }
        Row { sample, reference_g: level_g, reference_sigma_g: None }
    }
}

fn uhz(value: f64) -> i64 {
    (value * 1e6).round() as i64
}

/// Even runs begin cold, odd ones hot.
fn temperature_c(run: usize, time_s: f64) -> f64 {
    let way = CORNERS.windows(2).find(|pair| time_s <= pair[1].0).map_or(0.0, |pair| {
        let ((from_s, from), (to_s, to)) = (pair[0], pair[1]);
        from + (to - from) * (time_s - from_s) / (to_s - from_s)
    });
    let share = if run.is_multiple_of(2) { way } else { 1.0 - way };
    RANGE_C.0 + share * (RANGE_C.1 - RANGE_C.0)
}

/// An effect of the catalogue, as chosen for this campaign.
pub fn effect(name: &str, campaign: &Campaign) -> Chosen {
    let runs: Vec<&Run> = campaign.runs.iter().collect();
    choose(&EffectChoice::named(name), campaign, &runs).unwrap()
}

/// The campaign with effects at work in it that begin settled.
pub fn disturbed(mut campaign: Campaign, set: &EffectSet) -> Campaign {
    for run in &mut campaign.runs {
        let done = contributions(&run.rows, &set.effects, &set.coefficients, u32::MAX).unwrap();
        for (row, done) in run.rows.iter_mut().zip(done) {
            row.sample.delta_f_uhz += uhz(done.delta_f_hz + (done.bias_g - done.temperature_c * G_PER_C) * HZ_PER_G);
            row.sample.sum_f_uhz = row
                .sample
                .sum_f_uhz
                .map(|sum_uhz| sum_uhz.saturating_add_signed(uhz(done.temperature_c * SUM_HZ_PER_C)));
        }
    }
    campaign
}

/// A campaign with a bias after power-on (amplitude, g, and time constant, s), and that effect.
pub fn warmed_up(values: &[f64; 2]) -> (Campaign, EffectSet) {
    let still = Recipe::default().campaign();
    let truth = EffectSet::NONE.with(&effect("warm-up", &still), values);
    (disturbed(still, &truth), truth)
}

/// The campaign before the judge.
pub fn problem(campaign: &Campaign) -> Problem<'_> {
    let yardstick = Yardstick::of_model(&model(), campaign).unwrap();
    problem::problem(&model(), campaign, &yardstick).unwrap()
}

/// A noise that is white, of `sigma_ug`.
pub fn white(problem: &Problem, set: &EffectSet, sigma_ug: f64) -> NoiseModels {
    let sum = problem.forward.sum.as_ref().map(|channel| white_noise(sigma_ug, channel.per_c));
    NoiseModels { delta: white_noise(sigma_ug, problem.ug_per_c), sum, initial: initial_states(problem, set) }
}

/// The same of one column.
pub fn white_noise(sigma: f64, per_c: f64) -> NoiseModel {
    let mut noise = NoiseModel::even(sigma, per_c);
    Component::ALL.into_iter().for_each(|component| noise[component] = 0.0);
    noise
}

/// A matrix a run, one below the other.
pub fn dense(columns: &[DMatrix<f64>]) -> DMatrix<f64> {
    let (rows, width) = (columns.iter().map(DMatrix::nrows).sum(), columns[0].ncols());
    let mut all = DMatrix::zeros(rows, width);
    let mut next = 0;
    for run in columns {
        all.rows_mut(next, run.nrows()).copy_from(run);
        next += run.nrows();
    }
    all
}

/// Whether two matrices are equal but for this share of the largest value in either.
pub fn near(a: &DMatrix<f64>, b: &DMatrix<f64>, share: f64) -> bool {
    a.shape() == b.shape() && (a - b).amax() <= share * a.amax().max(b.amax())
}

/// Normal values of variance one, always the same (Box & Muller 1958).
pub struct Gauss {
    state: u64,
}

impl Gauss {
    /// Begins with this seed.
    pub fn new(seed: u64) -> Self {
        Self { state: seed }
    }

    /// The next value.
    pub fn next(&mut self) -> f64 {
        let (radius, angle) = (self.uniform(), self.uniform());
        (-2.0 * radius.ln()).sqrt() * (std::f64::consts::TAU * angle).cos()
    }

    /// Above 0 and below 1 (Steele, Lea & Flood 2014).
    fn uniform(&mut self) -> f64 {
        self.state = self.state.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut bits = self.state;
        bits = (bits ^ (bits >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        bits = (bits ^ (bits >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((bits ^ (bits >> 31)) >> 11) as f64 / (1_u64 << 53) as f64 + f64::EPSILON / 4.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_undisturbed_campaign_leaves_nothing_but_its_noise() {
        let campaign = Recipe::default().campaign();
        let problem = problem(&campaign);
        let residual = problem.forward.residuals(&EffectSet::NONE).delta;
        let rms_ug = problem.cells().rms(&residual);
        assert!(
            (4.0..5.5).contains(&rms_ug) && (4.3..5.7).contains(&problem.sample_ug),
            "{rms_ug} {}",
            problem.sample_ug
        );
        assert!((problem.ug_per_c / (G_PER_C * 1e6) - 1.0).abs() < 1e-6);
        assert!((problem.forward.scale_factor_hz_per_g() / HZ_PER_G - 1.0).abs() < 1e-6);
    }
}
