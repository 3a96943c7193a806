//! Every effect that might be missing, at every shape worth trying.

use super::case::Case;
use super::evidence::{difference, joined};
use super::instrument::Known;
use super::left::Left;
use super::sum_channel::is_told;
use super::whitening::Columns;
use crate::campaign::Campaign;
use crate::effect_choice::{EffectChoice, choose};
use crate::expression::Expression;
use crate::fit::effects::Chosen;
use firmware_core::effect::{self, About, Parameter, Role};
use nalgebra::DMatrix;
use rayon::prelude::*;
use std::borrow::Cow;

/// One effect at one shape.
pub(super) struct Candidate {
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

/// Amplitudes are tried at this share of their bound: formulas are linear in them.
const UNIT: f64 = 1e-3;
/// And those of formulas at this, g per unit.
const FORMULA_UNIT: f64 = 1e-6;
/// Shapes along one logarithmic axis.
const SHAPES: usize = 14;
/// Shapes along each of several axes.
const SHAPES_OF_SEVERAL: usize = 6;
/// How far 1 g moves a place, as shares of how far it moves one of the forks: less or more where what the fork meets follows
/// the temperature too.
const SHIFTS: [f64; 5] = [-1.7, -1.0, 0.0, 1.0, 1.7];
/// Most shifts to either side that are compared at one place, and the least level that a place is moved by, g.
const MOST_SHIFTS: f64 = 60.0;
const LEAST_G: f64 = 0.1;
/// Widths of an effect that sits at a place, °C.
const WIDTHS: [f64; 3] = [0.7, 2.0, 6.0];

impl Candidate {
    /// All of them. `shown` says which effects this campaign can show.
    pub fn all(case: &Case, shown: &[Chosen]) -> Vec<Self> {
        Self::all_within(case, shown, KEPT_BYTES)
    }

    /// All of them, of which the first are kept that have room in so many bytes.
    fn all_within(case: &Case, shown: &[Chosen], mut bytes: usize) -> Vec<Self> {
        let still = case.left(&Known::NONE);
        let shapes =
            shown.iter().flat_map(|effect| shapes(effect, case).into_iter().map(|values| (effect.clone(), values)));
        let mut all: Vec<Self> = shapes.map(|(effect, values)| Self::new(effect, values)).collect();
        let has_room = |candidate: &&mut Self| {
            let rest = bytes.checked_sub(candidate.bytes(case));
            bytes = rest.unwrap_or(0);
            rest.is_some()
        };
        let kept: Vec<&mut Self> = all.iter_mut().take_while(has_room).collect();
        kept.into_par_iter().for_each(|candidate| candidate.kept = Some(candidate.made(case, &still)));
        all
    }

    /// An effect that sits at a place, at that place and width, moved by the level in each way that its width tells apart.
    pub fn shifted(case: &Case, effect: &Chosen, values: &[f64]) -> Vec<Self> {
        let Some(shift) = effect.about.parameters.iter().position(|about| about.unit == "°C/g") else {
            return Vec::new();
        };
        let most_g = case.layout.cells().map(|cell| cell.level_g.abs()).fold(LEAST_G, f64::max);
        let most_c_per_g = SHIFTS.into_iter().fold(0.0, f64::max) * case.shift_c_per_g();
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

    /// What a unit of each amplitude (or the effect as it is) adds to the residual once compensated, µg.
    pub fn delta(&self, case: &Case) -> Cow<'_, Columns> {
        match &self.kept {
            Some(made) => Cow::Borrowed(&made.delta),
            None => Cow::Owned(self.made(case, &case.left(&Known::NONE)).delta),
        }
    }

    /// The same of the sum of the frequencies, mHz, where it is [told](Self::tells).
    pub fn sum(&self, case: &Case) -> Option<Cow<'_, Columns>> {
        match &self.kept {
            Some(made) => made.sum.as_ref().map(Cow::Borrowed),
            None if self.tells(case) => self.made(case, &case.left(&Known::NONE)).sum.map(Cow::Owned),
            None => None,
        }
    }

    /// Whether the sum of the frequencies is measured and the effect says what it does to it.
    pub fn tells(&self, case: &Case) -> bool {
        case.sum.is_some() && is_told(self.effect.about)
    }

    /// What its columns take.
    fn bytes(&self, case: &Case) -> usize {
        let numbers = case.layout.len() * self.amplitudes.len().max(1) * size_of::<f64>();
        let one = numbers + case.layout.stretches.len() * MATRIX_BYTES;
        if self.tells(case) { 2 * one } else { one }
    }

    fn made(&self, case: &Case, still: &Left) -> Made {
        let (mut columns, mut sums): (Vec<Columns>, Vec<Columns>) = (Vec::new(), Vec::new());
        for only in 0..self.amplitudes.len().max(1) {
            let mut values = self.values.clone();
            let others = self.amplitudes.iter().filter(|&&index| index != self.amplitudes[only]);
            others.for_each(|&index| values[index] = 0.0);
            let left = case.left(&Known::NONE.with(&self.effect, &values));
            columns.push(difference(&left.delta, &still.delta));
            let both = left.sum.as_ref().zip(still.sum.as_ref()).filter(|_| self.tells(case));
            sums.extend(both.map(|(moved, still)| difference(moved, still)));
        }
        let sum = (!sums.is_empty()).then(|| joined(&sums));
        Made { delta: joined(&columns), sum }
    }
}

/// The size at which the amplitude at `index` is tried.
fn unit(effect: &Chosen, index: usize) -> f64 {
    if effect.expression.is_some() { FORMULA_UNIT } else { effect.about.parameters[index].high * UNIT }
}

/// Indices of the amplitudes among an effect's parameters.
pub(super) fn amplitudes(about: &About) -> Vec<usize> {
    let parameters = about.parameters.iter().enumerate();
    parameters.filter(|(_, about)| about.role == Role::Amplitude).map(|(index, _)| index).collect()
}

/// The effects that the campaign has the signal and the channels for, and what channels that no effect follows might do.
pub(super) fn with_channels(campaign: &Campaign) -> Vec<Chosen> {
    let runs: Vec<_> = campaign.runs.iter().collect();
    let chosen = |about: &&About| choose(&EffectChoice::named(about.name), campaign, &runs).ok();
    let catalogue = effect::ALL.iter().filter(|about| about.is_on_device() && !about.takes_program());
    let mut found: Vec<Chosen> = catalogue.filter_map(chosen).collect();
    let program = effect::ALL.iter().find(|about| about.takes_program());
    for (about, channel) in program.into_iter().flat_map(|about| strangers(campaign).map(move |name| (about, name))) {
        let texts = FORMULAS.iter().map(|formula| formula.replace('#', channel));
        let parsed = texts.filter_map(|text| Expression::parse(&text, &campaign.channels).ok());
        found.extend(parsed.map(|expression| Chosen { expression: Some(expression), ..Chosen::of(about) }));
    }
    found
}

/// Whether the effect sits at a place.
pub(super) fn is_placed(about: &About) -> bool {
    about.parameters.iter().any(|parameter| parameter.role == Role::Location)
}

/// How a channel that no effect follows may act; `#` is its name.
const FORMULAS: [&str; 5] = ["#", "#^2", "# * temperature_c", "# * level_g", "# * temperature_rate"];

/// Channels that no effect of the catalogue follows.
fn strangers(campaign: &Campaign) -> impl Iterator<Item = &String> {
    let followed = |name: &&String| effect::ALL.iter().any(|about| about.channel == Some(name.as_str()));
    campaign.channels.iter().filter(move |name| !followed(name))
}

/// What a contender is called: the effect's name, or the formula.
pub(super) fn name_of(effect: &Chosen) -> &str {
    effect.expression.as_ref().map_or(effect.about.name, Expression::text)
}

fn shapes(effect: &Chosen, case: &Case) -> Vec<Vec<f64>> {
    let fork_c_per_g = case.shift_c_per_g();
    let searched = effect.about.parameters.iter().filter(|about| about.role == Role::Shape).count();
    let placed = is_placed(effect.about);
    let mut found = vec![Vec::new()];
    for about in effect.about.parameters {
        let choices = |before: &[f64]| match about.role {
            Role::Amplitude => vec![unit(effect, before.len())],
            Role::Shape if effect.expression.as_ref().is_some_and(|expression| expression.leaves_idle(about)) => {
                vec![about.start]
            }
            Role::Origin => vec![effect.origin],
            Role::Shape if placed => WIDTHS.to_vec(),
            Role::Shape => logarithmic(about, if searched > 1 { SHAPES_OF_SEVERAL } else { SHAPES }),
            Role::Location if about.unit == "°C" => places(case, width_c(effect.about, before)),
            Role::Location => SHIFTS.map(|share| (share * fork_c_per_g).clamp(about.low, about.high)).into(),
        };
        let extended = |before: Vec<f64>| {
            let next = choices(&before);
            next.into_iter().map(move |next| before.iter().copied().chain([next]).collect())
        };
        found = found.into_iter().flat_map(extended).collect();
    }
    found
}

fn logarithmic(about: &Parameter, count: usize) -> Vec<f64> {
    let part = |k: usize| (k as f64 + 0.5) / count as f64;
    (0..count).map(|k| about.low * (about.high / about.low).powf(part(k))).collect()
}

/// Places on the temperature axis, as dense as a feature of this width needs.
fn places(case: &Case, width_c: f64) -> Vec<f64> {
    let scale = &case.layout.scale;
    let (zero_c, half_c) = (f64::from(scale.temperature_zero_uc) * 1e-6, scale.temperature_half_span_c);
    let step_c = PLACE_STEP_C.max(width_c * PLACE_STEP);
    let count = (2.0 * half_c / step_c).ceil().clamp(1.0, 80.0) as usize;
    (0..=count).map(|k| zero_c - half_c + 2.0 * half_c * k as f64 / count as f64).collect()
}

/// The width among the parameters chosen so far.
fn width_c(about: &About, values: &[f64]) -> f64 {
    let mut pairs = about.parameters.iter().zip(values);
    pairs.find(|(about, _)| about.role == Role::Shape).map_or(0.0, |(_, value)| *value)
}

/// Least distance between places, °C, and as a share of the width.
const PLACE_STEP_C: f64 = 1.5;
const PLACE_STEP: f64 = 0.7;

#[cfg(test)]
mod tests {
    use super::super::{judge, yardstick};
    use super::*;
    use crate::campaign::{HoldOut, Quantity, Row, Run};
    use crate::model::Model;
    use crate::progress::Quiet;
    use crate::train::{TrainSettings, train};
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
        let yardstick = yardstick(&model, &campaign).unwrap();
        let campaign = yardstick.campaign(&campaign);
        let case = judge::case(&model, &campaign, &yardstick).unwrap();
        let shown = with_channels(&campaign);
        let noises = case.noises(&case.left(&Known::NONE), &case.stiff(&Known::NONE), None);
        let benches = case.benches(&case.left(&Known::NONE), &case.stiff(&Known::NONE), &noises).unwrap();
        let judged = |bytes: usize| {
            let all = Candidate::all_within(&case, &shown, bytes);
            let found = case.screen(&benches, &Known::NONE, &all).into_iter();
            let bits = |value: &f64| value.to_bits();
            let found = found.map(|one| (one.evidence.to_bits(), one.values.iter().map(bits).collect::<Vec<u64>>()));
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
        let yardstick = yardstick(&model, &campaign).unwrap();
        let campaign = yardstick.campaign(&campaign);
        let case = judge::case(&model, &campaign, &yardstick).unwrap();
        let all = Candidate::all(&case, &with_channels(&campaign));
        // Of a run of two cells the matrix is more than the numbers in it.
        let bytes = |columns: &Columns| size_of_val(columns.as_slice()) + numbers(columns) * size_of::<f64>();
        let total: usize = kept(&all).map(|made| bytes(&made.delta) + made.sum.as_ref().map_or(0, bytes)).sum();
        let (count, of) = (kept(&all).count(), all.len());
        assert!(total <= KEPT_BYTES && total > KEPT_BYTES / 2 && count < of, "{total} {count} of {of}");
    }
}
