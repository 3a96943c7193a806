//! A planned recording beside the measurements that exist: rows as this sensor would give them.

use crate::campaign::{Campaign, Row, Run};
use crate::diagnose::cells::{CROSS_CHANNEL, across_g};
use crate::diagnose::forward::StaticMap;
use crate::diagnose::problem::scale;
use crate::fit::dataset::InputScale;
use crate::metrics::mean;
use crate::model::Model;
use crate::yardstick::Yardstick;
use nalgebra::{DMatrix, DVector, SVD};
use protocol::limits::MAX_CHANNELS;

/// Steps of Newton's method; the map is nearly a line.
const STEPS: usize = 12;

/// Measurements and planned recording as one campaign. The measurements' channels come first and in their order.
pub fn joint(model: &Model, measured: &Campaign, planned: &Campaign, yardstick: &Yardstick) -> Campaign {
    let surplus = planned.channels.iter().filter(|name| !measured.channels.contains(name));
    let channels: Vec<String> = measured.channels.iter().chain(surplus).take(MAX_CHANNELS).cloned().collect();
    let sensor = Sensor::new(model, measured, yardstick);
    let gravity = yardstick.gravity.unwrap_or(1.0);
    let old = filled(measured, &channels, planned, gravity).into_iter();
    let new = filled(planned, &channels, measured, gravity).into_iter().map(|run| sensor.recorded(run));
    Campaign::new(old.chain(new).collect(), channels, measured.quantity.clone())
}

/// The runs with all channels; what a campaign lacks stood still, as `other` has it at the start.
fn filled(campaign: &Campaign, channels: &[String], other: &Campaign, gravity: f64) -> Vec<Run> {
    let place = |campaign: &Campaign, name: &str| campaign.channels.iter().position(|channel| channel == name);
    let row = |row: &Row| {
        let mut filled = [0; MAX_CHANNELS];
        for (slot, name) in filled.iter_mut().zip(channels) {
            *slot = match place(campaign, name) {
                Some(index) => row.sample.channels[index],
                None if name == CROSS_CHANNEL => (across_g(row.reference_g / gravity) * 1e6) as i64,
                None => {
                    place(other, name).and_then(|index| Some(other.rows().next()?.sample.channels[index])).unwrap_or(0)
                }
            };
        }
        let mut row = *row;
        row.sample.channels = filled;
        row
    };
    campaign.runs.iter().map(|run| Run { rows: run.rows.iter().map(row).collect(), ..run.clone() }).collect()
}

/// The sensor as its model and measurements have it.
struct Sensor {
    scale: InputScale,
    map: StaticMap,
    sum: Option<DVector<f64>>,
}

impl Sensor {
    fn new(model: &Model, measured: &Campaign, yardstick: &Yardstick) -> Self {
        let scale = scale(model);
        let sum = sum_map(measured, &scale);
        Self { scale, map: StaticMap::new(model, yardstick), sum }
    }

    /// The run with the frequencies that this sensor would have; their sum only if it was measured before.
    fn recorded(&self, mut run: Run) -> Run {
        for row in &mut run.rows {
            let [_, t] = self.scale.inputs(&row.sample);
            let x = self.input(row.reference_g, t);
            let away_hz = x * self.scale.delta_f_half_span_hz;
            row.sample.delta_f_uhz = self.scale.delta_f_zero_uhz.saturating_add((away_hz * 1e6).round() as i64);
            row.sample.sum_f_uhz = self.sum.as_ref().map(|sum| terms(x, t).dot(sum).round().max(0.0) as u64);
        }
        run
    }

    /// The scaled frequency difference at which the model reads `level_g`.
    fn input(&self, level_g: f64, t: f64) -> f64 {
        let reading_g = |x: f64| self.map.reading_g(x, t);
        let mut x = 0.0;
        for _ in 0..STEPS {
            let slope = (reading_g(x + 1e-3) - reading_g(x - 1e-3)) / 2e-3;
            let step = (level_g - reading_g(x)) / slope;
            x += if step.is_finite() { step.clamp(-1.0, 1.0) } else { 0.0 };
        }
        x
    }
}

/// Coefficients of a smooth map of the frequencies' sum, µHz; none unless every row has it.
fn sum_map(measured: &Campaign, scale: &InputScale) -> Option<DVector<f64>> {
    let sums: Vec<f64> =
        measured.rows().map(|row| row.sample.sum_f_uhz.map(|uhz| uhz as f64)).collect::<Option<_>>()?;
    let rows: Vec<DVector<f64>> =
        measured.rows().map(|row| scale.inputs(&row.sample)).map(|[x, t]| terms(x, t)).collect();
    let middle = mean(&sums);
    let design = DMatrix::from_fn(rows.len(), TERMS, |i, j| rows[i][j]);
    let target = DVector::from_iterator(rows.len(), sums.iter().map(|sum| sum - middle));
    let mut found = SVD::new(design, true, true).solve(&target, 1e-9).ok()?;
    found[0] += middle;
    Some(found)
}

const TERMS: usize = 6;

fn terms(x: f64, t: f64) -> DVector<f64> {
    DVector::from_column_slice(&[1.0, x, t, x * x, x * t, t * t])
}
