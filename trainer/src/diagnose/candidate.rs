//! Every effect that might be missing, at every shape worth trying.

use super::evidence::joined;
use super::instrument::{Deeds, Instrument, Known};
use super::layout::Layout;
use super::sum_channel::{Response, SumChannel, response};
use super::whitening::Columns;
use crate::campaign::Campaign;
use crate::fit::effects::Chosen;
use firmware_core::effect::{self, About, Parameter, Role};
use rayon::prelude::*;

/// One effect at one shape.
pub(super) struct Candidate {
    /// The effect.
    pub effect: Chosen,
    /// Coefficients with every amplitude at its unit.
    pub values: Vec<f64>,
    /// Indices of the amplitudes; none if the effect comes in one size.
    pub amplitudes: Vec<usize>,
    /// What a unit of each amplitude (or the effect as it is) adds to the residual once compensated, µg.
    pub columns: Columns,
    /// The same of the sum of the frequencies, mHz.
    pub sum: Option<Columns>,
}

/// Amplitudes are tried at this share of their bound: formulas are linear in them.
const UNIT: f64 = 1e-3;
/// Shapes along one logarithmic axis.
const SHAPES: usize = 14;
/// Shapes along each of several axes.
const SHAPES_OF_SEVERAL: usize = 6;
/// Widths of an effect that sits at a place, °C.
const WIDTHS: [f64; 3] = [0.7, 2.0, 6.0];

impl Candidate {
    /// All of them. `shown` says which effects this campaign can show.
    pub fn all(instrument: &Instrument, layout: &Layout, sum: Option<&SumChannel>, shown: &[Chosen]) -> Vec<Self> {
        let still = vec_of_rest(layout);
        let shapes: Vec<(Chosen, Vec<f64>)> =
            shown.iter().flat_map(|effect| shapes(effect, layout).into_iter().map(|values| (effect.clone(), values))).collect();
        let of = |(effect, values): (Chosen, Vec<f64>)| Self::new(instrument, layout, sum, &still, effect, values);
        shapes.into_par_iter().map(of).collect()
    }

    fn new(
        instrument: &Instrument,
        layout: &Layout,
        sum: Option<&SumChannel>,
        still: &Deeds,
        effect: Chosen,
        values: Vec<f64>,
    ) -> Self {
        let amplitudes = amplitudes(effect.about);
        let before = instrument.residual_ug(layout, &[still]);
        let sum_before = sum.map(|sum| sum.residual_under(layout, &[still]));
        let told = response(effect.about) == Response::Told;
        let (mut columns, mut sums): (Vec<Columns>, Vec<Columns>) = (Vec::new(), Vec::new());
        for only in 0..amplitudes.len().max(1) {
            let mut values = values.clone();
            amplitudes.iter().filter(|&&index| index != amplitudes[only]).for_each(|&index| values[index] = 0.0);
            let deeds = instrument.deeds(layout, &Known::NONE.with(&effect, &values));
            columns.push(difference(&instrument.residual_ug(layout, &[&deeds]), &before));
            if let (Some(sum), Some(before)) = (sum, &sum_before) {
                let after = if told { sum.residual_under(layout, &[&deeds]) } else { before.clone() };
                sums.push(difference(&after, before));
            }
        }
        let sum = (!sums.is_empty()).then(|| joined(&sums.iter().collect::<Vec<_>>()));
        Self { effect, values, amplitudes, columns: joined(&columns.iter().collect::<Vec<_>>()), sum }
    }
}

/// Indices of the amplitudes among an effect's parameters.
pub(super) fn amplitudes(about: &About) -> Vec<usize> {
    let parameters = about.parameters.iter().enumerate();
    parameters.filter(|(_, about)| about.role == Role::Amplitude).map(|(index, _)| index).collect()
}

/// The effects that the campaign has the channels for.
pub(super) fn with_channels(campaign: &Campaign) -> Vec<Chosen> {
    let chosen = |about: &'static About| {
        let Some(name) = about.channel else { return Some(Chosen::of(about)) };
        let channel = campaign.channels.iter().position(|channel| channel == name)?;
        let values: Vec<f64> = campaign.rows().map(|row| row.sample.channels[channel] as f64 * 1e-6).collect();
        Some(Chosen { channel, origin: crate::metrics::mean(&values), ..Chosen::of(about) })
    };
    effect::ALL.iter().filter(|about| about.is_on_device() && about.name != "expression").filter_map(|about| chosen(about)).collect()
}

fn shapes(effect: &Chosen, layout: &Layout) -> Vec<Vec<f64>> {
    let searched = effect.about.parameters.iter().filter(|about| about.role == Role::Shape).count();
    let placed = effect.about.parameters.iter().any(|about| about.role == Role::Location);
    let mut found = vec![Vec::new()];
    for about in effect.about.parameters {
        let choices: Vec<f64> = match about.role {
            Role::Amplitude => vec![about.high * UNIT],
            Role::Origin => vec![effect.origin],
            Role::Shape if placed => WIDTHS.to_vec(),
            Role::Shape => logarithmic(about, if searched > 1 { SHAPES_OF_SEVERAL } else { SHAPES }),
            Role::Location => places(about, layout, found.last().map_or(1.0, |values: &Vec<f64>| values[1])),
        };
        found = found.iter().flat_map(|values| choices.iter().map(move |choice| extended(values, *choice))).collect();
    }
    found
}

fn extended(values: &[f64], next: f64) -> Vec<f64> {
    values.iter().copied().chain([next]).collect()
}

fn logarithmic(about: &Parameter, count: usize) -> Vec<f64> {
    let part = |k: usize| (k as f64 + 0.5) / count as f64;
    (0..count).map(|k| about.low * (about.high / about.low).powf(part(k))).collect()
}

/// Places on the temperature axis as dense as the narrowest feature; other axes at three values.
fn places(about: &Parameter, layout: &Layout, _width: f64) -> Vec<f64> {
    if !about.unit.eq("°C") {
        return vec![0.4 * about.low, 0.0, 0.4 * about.high];
    }
    let zero_c = f64::from(layout.scale.temperature_zero_uc) * 1e-6;
    let half_c = layout.scale.temperature_half_span_c;
    let count = (2.0 * half_c / PLACE_STEP_C).ceil().clamp(1.0, 80.0) as usize;
    (0..=count).map(|k| zero_c - half_c + 2.0 * half_c * k as f64 / count as f64).collect()
}

/// Distance between places, °C.
const PLACE_STEP_C: f64 = 1.5;

fn vec_of_rest(layout: &Layout) -> Deeds {
    layout.stretches.iter().map(|stretch| vec![crate::fit::effects::Deed::default(); stretch.cells.len()]).collect()
}

fn difference(a: &Columns, b: &Columns) -> Columns {
    a.iter().zip(b).map(|(a, b)| a - b).collect()
}

