//! Stability at rest. The literature calls seven different figures "zero-bias stability", twenty-fold apart;
//! each is printed with what it is.

use super::allan::AllanPoint;
use super::{line_slope, mean, standard_deviation};
use crate::campaign::Run;
use serde::Serialize;

/// One way to state it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct Definition {
    /// Short name.
    pub id: &'static str,
    /// What is computed.
    pub what: &'static str,
}

/// From 20 minutes after power-on, for an hour: standard deviation of the samples.
pub const Z1: Definition =
    Definition { id: "Z1", what: "standard deviation (1σ) of the samples from 20 to 80 min after power-on, at rest" };
/// The paper's, in its three variants.
pub const Z2: [Definition; 3] = [
    Definition {
        id: "Z2 from the start",
        what: "standard deviation (1σ) of all samples from power-on (Huang et al. 2022, Table 1)",
    },
    Definition { id: "Z2 after 20 min", what: "the same from 20 min after power-on to the end of the recording" },
    Definition { id: "Z2 after 30 min", what: "the same from 30 min after power-on to the end of the recording" },
];
/// Of means over ten seconds.
pub const Z3: Definition = Definition {
    id: "Z3 (1σ, 10 s)",
    what: "standard deviation (n − 1) of consecutive 10 s means from 20 min after power-on",
};
/// With the drift taken out.
pub const Z4: Definition = Definition {
    id: "Z4 (drift removed)",
    what: "standard deviation (1σ) from 20 min after power-on about the least-squares line over time",
};
/// The bottom of the Allan plot.
pub const Z6: Definition = Definition {
    id: "Z6 (Allan minimum)",
    what: "least overlapping Allan deviation of the recording: the in-run bias instability; divide by 0.664 for the \
           coefficient B",
};

/// Of one recording at rest.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Stability {
    /// By definition.
    pub figures: Vec<StabilityFigure>,
}

/// One figure.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct StabilityFigure {
    /// What it is.
    #[serde(flatten)]
    pub definition: Definition,
    /// Its value, µg.
    pub value_ug: f64,
}

/// Settled after this, s.
const SETTLED_S: f64 = 1200.0;
/// The window of [`Z1`], s.
const HOUR_S: f64 = 3600.0;
/// The block of [`Z3`], s.
const BLOCK_S: f64 = 10.0;
/// Fewer values than this have no standard deviation worth printing.
const LEAST: usize = 20;

/// The figures of `outputs_g`, one of each row of the run; those that the recording is too short for are absent.
#[must_use]
pub fn stability(run: &Run, outputs_g: &[f64], allan: Option<&[AllanPoint]>) -> Stability {
    let timed: Vec<(f64, f64)> = run
        .rows
        .iter()
        .zip(outputs_g)
        .map(|(row, output_g)| (row.sample.power_on_us as f64 * 1e-6, *output_g))
        .collect();
    let window = |from_s: f64, to_s: f64| -> Vec<(f64, f64)> {
        timed.iter().filter(|(time_s, _)| (from_s..to_s).contains(time_s)).copied().collect()
    };
    let last_s = timed.last().map_or(0.0, |(time_s, _)| *time_s);
    let settled = window(SETTLED_S, f64::INFINITY);
    let interval_s = run.sample_interval_s().unwrap_or(f64::INFINITY);
    let full_hour = last_s >= SETTLED_S + HOUR_S - 2.0 * interval_s;
    let candidates = [
        full_hour.then(|| (Z1, deviation_ug(&window(SETTLED_S, SETTLED_S + HOUR_S)))),
        Some((Z2[0], deviation_ug(&timed))),
        Some((Z2[1], deviation_ug(&settled))),
        Some((Z2[2], deviation_ug(&window(1800.0, f64::INFINITY)))),
        (interval_s <= BLOCK_S / 2.0).then(|| (Z3, deviation_ug(&blocks(&settled)))),
        Some((Z4, deviation_ug(&without_drift(&settled)))),
        allan.map(|points| (Z6, least_ug(points))),
    ];
    let figure =
        |(definition, value_ug): (Definition, Option<f64>)| Some(StabilityFigure { definition, value_ug: value_ug? });
    let figures = candidates.into_iter().flatten().filter_map(figure).collect();
    Stability { figures }
}

fn deviation_ug(values: &[(f64, f64)]) -> Option<f64> {
    let outputs: Vec<f64> = values.iter().map(|(_, output_g)| *output_g).collect();
    (outputs.len() >= LEAST).then(|| standard_deviation(&outputs) * 1e6)
}

fn blocks(values: &[(f64, f64)]) -> Vec<(f64, f64)> {
    let block = |value: &(f64, f64)| (value.0 / BLOCK_S).floor();
    values
        .chunk_by(|a, b| block(a) == block(b))
        .map(|part| (part[0].0, mean(&part.iter().map(|(_, output_g)| *output_g).collect::<Vec<_>>())))
        .collect()
}

fn without_drift(values: &[(f64, f64)]) -> Vec<(f64, f64)> {
    let slope = line_slope(values);
    values.iter().map(|(time_s, output_g)| (*time_s, output_g - slope * time_s)).collect()
}

fn least_ug(points: &[AllanPoint]) -> Option<f64> {
    points.iter().map(|point| point.deviation_ug).min_by(f64::total_cmp)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::campaign::Row;
    use protocol::Sample;
    use std::path::PathBuf;

    fn run(seconds: u64) -> Run {
        every(1, seconds)
    }

    /// So many rows, one every so many seconds.
    fn every(interval_s: u64, count: u64) -> Run {
        let row = |index: u64| Row {
            sample: Sample::from_difference(index * interval_s * 1_000_000, 0, 0),
            reference_g: 0.0,
            reference_sigma_g: None,
        };
        Run { name: "zero".into(), kind: "zero".into(), source: PathBuf::new(), rows: (0..count).map(row).collect() }
    }

    fn figure(stability: &Stability, id: &str) -> Option<f64> {
        stability.figures.iter().find(|figure| figure.definition.id == id).map(|figure| figure.value_ug)
    }

    #[test]
    fn the_definitions_differ_on_the_same_data_as_they_must() {
        // A drift of 1 µg/min under an alternation of ±5 µg.
        let run = run(6000);
        let outputs: Vec<f64> =
            (0..6000).map(|k| 1e-6 * (f64::from(k) / 60.0 + if k % 2 == 0 { 5.0 } else { -5.0 })).collect();
        let stability = stability(&run, &outputs, None);
        let of = |id: &str| figure(&stability, id).expect(id);
        let drift = |minutes: f64| minutes / 12.0_f64.sqrt();
        assert!((of("Z1") - (drift(60.0).powi(2) + 25.0).sqrt()).abs() < 0.05);
        assert!((of("Z2 from the start") - (drift(100.0).powi(2) + 25.0).sqrt()).abs() < 0.05);
        assert!((of("Z3 (1σ, 10 s)") - drift(80.0)).abs() < 0.1, "means of ten cancel the alternation");
        assert!((of("Z4 (drift removed)") - 5.0).abs() < 0.01, "only the alternation is left");
        assert_eq!(figure(&stability, "Z6 (Allan minimum)"), None);
    }

    #[test]
    fn an_hour_may_lack_two_samples_and_ten_seconds_need_two() {
        let has = |interval_s: u64, count: u64, id: &str| {
            let found = stability(&every(interval_s, count), &vec![0.0; count as usize], None);
            figure(&found, id).is_some()
        };
        // From 20 to 80 minutes are 4800 s.
        assert!(has(5, 959, "Z1") && !has(5, 958, "Z1") && has(1, 4799, "Z1") && !has(1, 4798, "Z1"));
        assert!(has(5, 900, "Z3 (1σ, 10 s)") && !has(6, 900, "Z3 (1σ, 10 s)"));
        // 20 values from 1200 s on.
        assert!(has(1, 1220, "Z2 after 20 min") && !has(1, 1219, "Z2 after 20 min"));
    }

    #[test]
    fn the_bottom_of_the_allan_plot_is_its_least_deviation() {
        let point = |deviation_ug: f64| AllanPoint { tau_s: 1.0, deviation_ug, relative_uncertainty: 0.1 };
        let found = stability(&run(30), &[0.0; 30], Some(&[4.0, 2.5, 3.0].map(point)));
        assert_eq!(figure(&found, "Z6 (Allan minimum)"), Some(2.5));
    }

    #[test]
    fn a_short_recording_has_no_figure_that_needs_a_long_one() {
        let stability = stability(&run(1210), &vec![0.0; 1210], None);
        assert_eq!(
            stability.figures.iter().map(|figure| figure.definition.id).collect::<Vec<_>>(),
            ["Z2 from the start"]
        );
    }
}
