//! Claim: the regression is that of the whole covariance, written out.

use super::*;
use crate::diagnose::example::{Gauss, Recipe, dense, near, problem, white_noise};
use crate::diagnose::noise::Component;
use crate::diagnose::problem::Problem;

const SAMPLE_UG: f64 = 5.0;

fn noise() -> NoiseModel {
    let mut noise = white_noise(SAMPLE_UG, 900.0);
    (noise[Component::Run], noise[Component::Mounting]) = (30.0, 12.0);
    noise
}

/// The covariance of that noise as it is defined: µg², a row and a column a cell.
fn covariance(cells: &Cells) -> DMatrix<f64> {
    let noise = noise();
    let all: Vec<(usize, _)> =
        cells.runs.iter().enumerate().flat_map(|(run, one)| one.cells.iter().map(move |cell| (run, cell))).collect();
    DMatrix::from_fn(all.len(), all.len(), |i, j| {
        let ((run, a), (other, b)) = (all[i], all[j]);
        let own = noise.sample.powi(2) / a.samples + (noise.per_c * a.unseen_c).powi(2);
        let shared = noise[Component::Run].powi(2) + noise[Component::Mounting].powi(2) * a.cross_g * b.cross_g;
        if i == j {
            own + shared
        } else if run == other {
            shared
        } else {
            0.0
        }
    })
}

fn random(cells: &Cells, width: usize, size: f64, seed: u64) -> Columns {
    let mut noise = Gauss::new(seed);
    let mut of = |rows: usize| DMatrix::from_fn(rows, width, |_, _| size * noise.next());
    cells.runs.iter().map(|run| of(run.cells.len())).collect()
}

/// Covariance of residuals with the nuisance in it, inverted.
fn weights(cells: &Cells, nuisance: &Columns) -> DMatrix<f64> {
    let nuisance = dense(nuisance);
    (covariance(cells) + &nuisance * nuisance.transpose()).cholesky().unwrap().inverse()
}

struct Case {
    residual: Columns,
    nuisance: Columns,
    columns: Columns,
}

/// Two runs of a few cells; a nuisance of `width` columns, none of which is small against the noise.
fn case(cells: &Cells, width: usize) -> Case {
    Case {
        residual: random(cells, 1, 40.0, 2),
        nuisance: random(cells, width, 25.0, 3),
        columns: random(cells, 2, 10.0, 4),
    }
}

fn with_cells(test: impl Fn(&Problem, &Case)) {
    let campaign = Recipe { runs: 2, rows: 48, ..Recipe::default() }.campaign();
    let problem = problem(&campaign);
    assert!((20..100).contains(&problem.cells().len()), "{}", problem.cells().len());
    for width in [0, 3] {
        test(&problem, &case(problem.cells(), width));
    }
}

fn gls(problem: &Problem, case: &Case) -> Gls {
    Gls::new(problem.cells(), &InitialStates::default(), &noise(), &case.residual, &case.nuisance).unwrap()
}

#[test]
fn score_and_deviance_are_those_of_the_covariance_written_out() {
    with_cells(|problem, case| {
        let gls = gls(problem, case);
        let (weights, y, c) = (weights(problem.cells(), &case.nuisance), dense(&case.residual), dense(&case.columns));
        let determinant = -2.0 * weights.clone().cholesky().unwrap().l().diagonal().map(f64::ln).sum();
        let worked = determinant + (y.transpose() * &weights * &y)[(0, 0)];
        assert!((gls.deviance / worked - 1.0).abs() < 1e-9, "{} {worked}", gls.deviance);
        let score = gls.score(&case.columns);
        assert!(near(&score.normal, &(c.transpose() * &weights * &c), 1e-9));
        let right = DMatrix::from_column_slice(2, 1, score.right.as_slice());
        assert!(near(&right, &(c.transpose() * &weights * &y), 1e-9));
    });
}

#[test]
fn a_gain_is_what_the_deviance_loses_once_the_columns_are_in_the_residual() {
    with_cells(|problem, case| {
        let (gls_without, score) = (gls(problem, case), gls(problem, case).score(&case.columns));
        let after = |amplitudes: &DMatrix<f64>| {
            let moved = case.residual.iter().zip(&case.columns).map(|(y, c)| y + c * amplitudes).collect();
            let case = Case { residual: moved, nuisance: case.nuisance.clone(), columns: Vec::new() };
            gls(problem, &case).deviance
        };
        let best = DMatrix::from_column_slice(2, 1, score.amplitudes().unwrap().as_slice());
        let gained = gls_without.deviance - after(&best);
        assert!((gained - score.gain()).abs() < 1e-6 && score.gain() > 0.0, "{gained} {}", score.gain());
        let gained = gls_without.deviance - after(&DMatrix::from_element(2, 1, 1.0));
        assert!((gained - score.gain_as_is()).abs() < 1e-6, "{gained} {}", score.gain_as_is());
        // No other amplitudes gain as much.
        assert!(gls_without.deviance - after(&(best * 1.1)) < score.gain());
    });
}

#[test]
fn what_the_nuisance_takes_is_its_posterior_mean() {
    with_cells(|problem, case| {
        let gls = gls(problem, case);
        let (weights, n) = (weights(problem.cells(), &case.nuisance), dense(&case.nuisance));
        for (found, of) in [
            (gls.adapted(&case.residual, &case.nuisance), &case.residual),
            (gls.beyond(&case.columns, &case.nuisance), &case.columns),
        ] {
            let of = dense(of);
            let worked = &of - &n * (n.transpose() * &weights * &of);
            assert!(near(&dense(&found), &worked, 1e-9));
        }
    });
}

#[test]
fn many_candidates_and_those_of_one_run_score_as_each_does_by_itself() {
    with_cells(|problem, case| {
        let gls = gls(problem, case);
        let candidates: Vec<Columns> =
            (0..70).map(|seed| random(problem.cells(), 1 + seed % 3, 10.0, seed as u64)).collect();
        let all = gls.scores(&candidates, Cow::Borrowed);
        let shares = gls.shares_left(&candidates, Cow::Borrowed);
        for ((candidate, score), (_, share)) in candidates.iter().zip(all).zip(shares) {
            let alone = gls.score(candidate);
            assert!(near(&score.normal, &alone.normal, 1e-9) && (score.right - alone.right).amax() < 1e-9);
            let white = gls.whitening.of(candidate);
            let of = |k: usize| (alone.normal[(k, k)] / product(&white, &white)[(k, k)]).sqrt();
            let worked = (0..width(candidate)).map(of).fold(0.0, f64::max);
            assert!((share - worked).abs() < 1e-9, "{share} {worked}");
        }
        let mut only = case.columns.clone();
        only[0].fill(0.0);
        let (whole, part) = (gls.score(&only), gls.score_in(1, &case.columns[1]));
        assert!(near(&whole.normal, &part.normal, 1e-9) && (whole.right - part.right).amax() < 1e-9);
    });
}

#[test]
fn a_nuisance_in_the_directions_that_data_tell_of_absorbs_the_same_in_fewer_columns() {
    with_cells(|problem, case| {
        // Each twice, and one of which the data say nothing.
        let faint: Columns = case.residual.iter().map(|run| run * 1e-6).collect();
        let twice = joined([&case.nuisance, &case.nuisance, &faint]);
        let directions = directions(problem.cells(), &noise(), &twice);
        let few: Columns = twice.iter().map(|run| run * &directions).collect();
        assert_eq!(width(&few), width(&case.nuisance));
        let with = |nuisance: &Columns| {
            Gls::new(problem.cells(), &InitialStates::default(), &noise(), &case.residual, nuisance).unwrap().deviance
        };
        assert!((with(&few) - with(&twice)).abs() < 2e-3, "{} {}", with(&few), with(&twice));
    });
}

#[test]
fn what_is_absorbed_again_and_again_is_what_fits_to_what_was_left_each_time_absorb() {
    with_cells(|problem, case| {
        let none = InitialStates::default();
        let mut residual = case.residual.clone();
        let gls = |residual: &Columns| Gls::new(problem.cells(), &none, &noise(), residual, &case.nuisance).unwrap();
        let thrice = gls(&residual).absorbed(3);
        if thrice.is_empty() {
            return;
        }
        let mut sum = thrice.clone() * 0.0;
        for _ in 0..3 {
            let once = gls(&residual).absorbed(1);
            residual.iter_mut().zip(&case.nuisance).for_each(|(run, nuisance)| *run -= nuisance * &once);
            sum += once;
        }
        assert!((&sum - &thrice).amax() < 1e-9 * thrice.amax(), "{sum} {thrice}");
        assert!((gls(&case.residual).absorbed(1) - &thrice).amax() > 1e-6 * thrice.amax());
    });
}

#[test]
fn a_residual_that_is_no_number_has_no_regression() {
    with_cells(|problem, case| {
        let mut residual = case.residual.clone();
        residual[0][(0, 0)] = f64::NAN;
        let none = InitialStates::default();
        assert!(Gls::new(problem.cells(), &none, &noise(), &residual, &case.nuisance).is_none());
    });
}
