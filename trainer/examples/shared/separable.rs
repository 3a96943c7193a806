//! A campaign as the bare least-squares problem: no anchors, no noise model, every sample an equal witness.

// Each program that includes this file uses a part of it.
#![allow(dead_code)]

use protocol::limits::HIDDEN;
use rand_xoshiro::Xoshiro256PlusPlus;
use trainer::campaign::Campaign;
use trainer::fit::dataset::{Datum, InputScale};
use trainer::fit::neighbours::merged;
use trainer::fit::network::{Anchors, Fit, Group, NetworkProblem, Prior, ValueRow};
use trainer::fit::polynomial::Polynomial;
use trainer::fit::random::between;

/// Keeps coinciding units apart and biases nothing: a weight of 10 costs less than one sample's noise.
const PRIOR: Prior = Prior { output: 1e-10, hidden: 1e-10 };
/// Steepest start of a hidden unit, as in the trainer.
pub const STEEPEST_START: f64 = 2.5;

/// What is left of a campaign's references after a line, in units of its own size.
pub struct Departure {
    scale: InputScale,
    line: Polynomial,
    /// Its size, g.
    unit_g: f64,
    /// Samples that the rows stand for.
    samples: f64,
    group: Group,
    anchors: Anchors,
}

impl Departure {
    /// Of all runs of a campaign.
    pub fn of(campaign: &Campaign) -> Self {
        let scale = InputScale::of(&campaign.runs).expect("a campaign has rows");
        let data = merged(campaign.runs.iter().enumerate(), &scale);
        let line = Polynomial::fit_degrees(&data, 1, 1);
        let departure_g = |datum: &Datum| datum.reference_g - line.evaluate(datum.x, datum.t);
        let samples: f64 = data.iter().map(|datum| datum.weight).sum();
        let squares: f64 = data.iter().map(|datum| datum.weight * departure_g(datum).powi(2)).sum();
        let unit_g = (squares / samples).sqrt();
        let row = |datum: &Datum| ValueRow {
            x: datum.x,
            t: datum.t,
            y: departure_g(datum) / unit_g,
            weight: datum.weight,
            samples: datum.weight,
        };
        let group = Group { rows: data.iter().map(row).collect(), offset_variance: 0.0 };
        Self { scale, line, unit_g, samples, group, anchors: Anchors::default() }
    }

    /// The problem in the 30 hidden weights.
    pub fn problem(&self) -> NetworkProblem<'_, Vec<Group>> {
        NetworkProblem::new(vec![self.group.clone()], &self.anchors, PRIOR)
    }

    /// Root mean square over the samples of a fit of this cost, g.
    pub fn residual_g(&self, cost: f64) -> f64 {
        (2.0 * cost / self.samples).sqrt() * self.unit_g
    }

    /// The cost of a fit with this root mean square over the samples, but for priors.
    pub fn cost(&self, residual_g: f64) -> f64 {
        0.5 * self.samples * (residual_g / self.unit_g).powi(2)
    }

    /// Root mean square of a fit over the samples of any campaign, g.
    pub fn residual_on_g(&self, fit: &Fit, campaign: &Campaign) -> f64 {
        let squares = campaign.rows().map(|row| {
            let [x, t] = self.scale.inputs(&row.sample);
            let reading_g = self.line.evaluate(x, t) + self.unit_g * fit.evaluate(x, t);
            (reading_g - row.reference_g).powi(2)
        });
        (squares.sum::<f64>() / campaign.row_count() as f64).sqrt()
    }
}

/// Units whose steepest place lies within the domain, in random directions, as in the trainer.
pub fn random_start(random: &mut Xoshiro256PlusPlus) -> Vec<f64> {
    let mut hidden = Vec::with_capacity(3 * HIDDEN);
    for _ in 0..HIDDEN {
        let [wx, wt] = [0; 2].map(|_| between(random, -STEEPEST_START, STEEPEST_START));
        let [x, t] = [0; 2].map(|_| between(random, -1.0, 1.0));
        hidden.extend([wx, wt, -(wx * x + wt * t)]);
    }
    hidden
}
