//! How much of an effect a campaign can show: what is left of it after a static map has taken up what it can.
//!
//! Apart from the diagnosis, and with none of its code: it decides what the diagnosis could have seen. What a static map
//! takes up of an effect that depends on acceleration and temperature alone is found by training one.

use crate::case::{read, simulated};
use firmware_sim::recording::Recording;
use firmware_sim::scenario::Scenario;
use firmware_sim::twin::Noise;
use firmware_sim::twin::StaticMap;
use firmware_sim::twin::effect::Effects;
use trainer::campaign::HoldOut;
use trainer::progress::Quiet;
use trainer::residuals::residuals;
use trainer::train::{TrainSettings, train};

pub const DEFINITION: &str = "\
visible = RMS over the rows of what one hidden effect alone, noise off, leaves behind a perfect static compensation, after
  least squares on a^i·T^j (i ≤ 3, j ≤ 4), which any static map takes up (of effects that depend on acceleration and
  temperature alone: behind a network trained on them, if that leaves less), and, on a real rig, on one
  offset and one tilt across the input axis a run, which turn-on and mounting take up;
  in σ, the noise of one 1 Hz sample (white, quantisation, counter, thermometer; no flicker, no walk).
  Real rig: turn-on 150 µg, table 8″, mounting 40″, 25 µg from node to node. Perfect rig: none of them.";

/// What is left of an effect, µg RMS over all rows.
#[derive(Clone, Copy, Debug)]
pub struct Visible {
    /// After a static map.
    pub static_ug: f64,
    /// After an offset of every run, too.
    pub within_runs_ug: f64,
    /// After a tilt of every mounting, too.
    pub within_mountings_ug: f64,
}

/// Highest powers of acceleration and temperature that a static map takes up.
const POWERS: [i32; 2] = [3, 4];

/// Effects that depend on acceleration and temperature alone: a network can bend itself to them.
const OF_THE_STATE: [&str; 3] = ["lock-in", "mode-crossing", "x-odd-quadratic"];

/// Measures what `effect` of the scenario does alone.
pub fn visible(scenario: &Scenario, effect: &str, seed: u64) -> Result<Visible, String> {
    let effects = alone(&scenario.effects, effect)?;
    let alone = Scenario { noise: Noise::off(), rig: scenario.rig.without_errors(), effects, ..scenario.clone() };
    let recording = simulated(&alone, seed)?;
    let map = StaticMap::new(&alone.device);
    let mut rest = Rest { off_ug: Vec::new(), basis: Vec::new() };
    let (mut readings, mut temperatures) = (Vec::new(), Vec::new());
    for row in recording.runs.iter().flat_map(|run| &run.rows) {
        let reading_g = map.acceleration_g(row.delta_f_hz, row.temperature_c);
        rest.off_ug.push((reading_g - row.reference_g) * 1e6);
        readings.push(reading_g);
        temperatures.push((row.temperature_c - 10.0) / 50.0);
    }
    for (i, j) in (0..=POWERS[0]).flat_map(|i| (0..=POWERS[1]).map(move |j| (i, j))) {
        rest.remove(readings.iter().zip(&temperatures).map(|(a, t)| a.powi(i) * t.powi(j)).collect());
    }
    if OF_THE_STATE.contains(&effect) {
        let trained = Rest { off_ug: trained(&alone, &recording, seed)?, basis: Vec::new() };
        rest = if trained.rms_ug() < rest.rms_ug() { trained } else { rest };
    }
    let static_ug = rest.rms_ug();
    remove_from_runs(&recording, &mut rest, |_| 1.0);
    let within_runs_ug = rest.rms_ug();
    remove_from_runs(&recording, &mut rest, |row| row.cross_g);
    Ok(Visible { static_ug, within_runs_ug, within_mountings_ug: rest.rms_ug() })
}

/// What a static model leaves of a recording without noise that was trained on one with the usual noise, µg.
fn trained(alone: &Scenario, recording: &Recording, seed: u64) -> Result<Vec<f64>, String> {
    let noisy = read(&simulated(&Scenario { noise: Noise::default(), ..alone.clone() }, seed)?)?;
    let split = noisy.split(&HoldOut::None).map_err(|error| error.to_string())?;
    let model = train(&noisy, &split, &TrainSettings::new(seed), &Quiet).map_err(|error| error.to_string())?.model;
    let still = read(recording)?;
    let left = residuals(&model, &still.runs).map_err(|error| error.to_string())?;
    Ok(left.runs.iter().flat_map(|run| &run.residuals_g).map(|residual_g| residual_g * 1e6).collect())
}

/// The same effects without all but one.
fn alone(effects: &Effects, name: &str) -> Result<Effects, String> {
    let mut table = toml::Table::try_from(effects).map_err(|error| error.to_string())?;
    table.retain(|other, _| other == name);
    table.try_into().map_err(|error| error.to_string())
}

/// Takes out of every run its own share of a quantity.
fn remove_from_runs(recording: &Recording, rest: &mut Rest, quantity: impl Fn(&firmware_sim::recording::Row) -> f64) {
    for run in &recording.runs {
        let of = |row| quantity(row);
        let column = recording.runs.iter().flat_map(|other| {
            let here = std::ptr::eq(run, other);
            other.rows.iter().map(move |row| if here { of(row) } else { 0.0 })
        });
        rest.remove(column.collect());
    }
}

/// A series and the directions that were taken out of it.
struct Rest {
    off_ug: Vec<f64>,
    basis: Vec<Vec<f64>>,
}

/// A direction that others explain to within rounding is none.
const INDEPENDENT: f64 = 1e-7;

impl Rest {
    /// Least squares by Gram and Schmidt, twice, because once loses digits.
    fn remove(&mut self, mut column: Vec<f64>) {
        let before = dot(&column, &column).sqrt();
        for direction in self.basis.iter().chain(&self.basis) {
            subtract(&mut column, direction);
        }
        let after = dot(&column, &column).sqrt();
        if after <= before * INDEPENDENT {
            return;
        }
        column.iter_mut().for_each(|value| *value /= after);
        subtract(&mut self.off_ug, &column);
        self.basis.push(column);
    }

    fn rms_ug(&self) -> f64 {
        (dot(&self.off_ug, &self.off_ug) / self.off_ug.len().max(1) as f64).sqrt()
    }
}

fn subtract(from: &mut [f64], direction: &[f64]) {
    let share = dot(from, direction);
    from.iter_mut().zip(direction).for_each(|(value, part)| *value -= share * part);
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_lies_along_a_direction_goes_and_the_rest_stays() {
        let off_ug = vec![5.0, 1.0, 1.0, 5.0];
        let mut rest = Rest { off_ug, basis: Vec::new() };
        rest.remove(vec![1.0; 4]);
        assert!((rest.rms_ug() - 2.0).abs() < 1e-12);
        // No new direction.
        rest.remove(vec![7.0; 4]);
        rest.remove(vec![1.0, 0.0, 0.0, -1.0]);
        assert!((rest.rms_ug() - 2.0).abs() < 1e-12 && rest.basis.len() == 2);
        rest.remove(vec![1.0, 0.0, 0.0, 0.0]);
        assert!(rest.rms_ug() < 1e-12 && rest.basis.len() == 3);
    }
}
