//! The Kalman filter beside one that others wrote.

use super::components::NoiseModel;
use super::kalman::{State, pass};
use super::observation::{Kind, Observed};
use crate::campaign::Run;
use crate::diagnose::cells::{Cell, Groups, RunCells};
use adskalman::{KalmanFilterNoControl, ObservationModel, StateAndCovariance, TransitionModelLinearNoControl};
use nalgebra::{DMatrix, OMatrix, U1};
use std::path::PathBuf;

const CELLS: usize = 12;

/// Uneven in time and in weight; at one the temperature went astray.
fn cell(index: usize) -> Cell {
    let time_s = |index: usize| (index * index) as f64 * 7.0 + 3.0;
    let since_s = index.checked_sub(1).map_or(3.0, |last| time_s(index) - time_s(last));
    let unseen_c = if index == 5 { 0.01 } else { 0.0 };
    Cell { samples: 1.0 + (index % 3) as f64, unseen_c, ..Cell::plain(index, time_s(index), since_s) }
}

/// Another's filter, of one state that walks and is seen directly.
struct Walk {
    unit: OMatrix<f64, U1, U1>,
    gained: OMatrix<f64, U1, U1>,
    own: OMatrix<f64, U1, U1>,
}

impl TransitionModelLinearNoControl<f64, U1> for Walk {
    fn F(&self) -> &OMatrix<f64, U1, U1> {
        &self.unit
    }

    fn FT(&self) -> &OMatrix<f64, U1, U1> {
        &self.unit
    }

    fn Q(&self) -> &OMatrix<f64, U1, U1> {
        &self.gained
    }
}

impl ObservationModel<f64, U1, U1> for Walk {
    fn H(&self) -> &OMatrix<f64, U1, U1> {
        &self.unit
    }

    fn HT(&self) -> &OMatrix<f64, U1, U1> {
        &self.unit
    }

    fn R(&self) -> &OMatrix<f64, U1, U1> {
        &self.own
    }
}

#[test]
fn a_walk_seen_at_uneven_times_leaves_the_innovations_that_adskalman_finds() {
    let (noise, walk) = (NoiseModel::even(5.0, 900.0), 0.7_f64);
    let states = [State { kind: Kind::Walk, variance: walk * walk }];
    let run = Run { name: String::new(), kind: String::new(), source: PathBuf::new(), rows: Vec::new() };
    let cells = RunCells { run: &run, cells: (0..CELLS).map(cell).collect(), groups: Groups::default() };
    let values: Vec<f64> = (0..CELLS).map(|k| (k * 37 % 17) as f64 * 9.0 - 60.0).collect();
    let scalar = OMatrix::<f64, U1, U1>::new;
    // Nothing has been gained before the first cell.
    let mut estimate = StateAndCovariance::new(scalar(0.0), scalar(0.0));
    let worked = values.iter().enumerate().map(|(index, value)| {
        let seen = cell(index);
        let gained = if index == 0 { 0.0 } else { walk * walk * seen.since_s };
        let own = noise.sample.powi(2) / seen.samples + (noise.per_c * seen.unseen_c).powi(2);
        let model = Walk { unit: scalar(1.0), gained: scalar(gained), own: scalar(own) };
        let prior = model.predict(&estimate);
        let innovation = value - prior.state()[0];
        let variance = prior.covariance()[0] + own;
        estimate = KalmanFilterNoControl::new(&model, &model).step(&estimate, &scalar(*value)).unwrap();
        innovation / variance.sqrt()
    });
    let worked = DMatrix::from_iterator(CELLS, 1, worked);
    let column = DMatrix::from_column_slice(CELLS, 1, &values);
    let found = pass(&noise, &states, Observed { run: &cells, initial: &[] }).whitened(&column);
    assert!((&found - &worked).amax() < 1e-9, "{found} {worked}");
}
