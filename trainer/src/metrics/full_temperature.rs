//! Scale factor and bias over temperature (Huang et al. 2022, Table 2), by least squares over all levels of a node.

use super::input_axis::{InputAxis, carries_second_order};
use super::levels::span;
use super::states::{State, states};
use super::{line_slope, mean, standard_deviation};
use crate::campaign::Run;
use serde::Serialize;

/// What the figures mean.
pub const DEFINITION: &str = "scale factor K1 and bias B0 = K0 at each temperature node: least squares of U = K1·(K0 + a + \
    K2·a²) over the means of all its positions (IEEE Std 1293; without K2 where a node has two levels). Of +1, 0 and −1 g \
    that is K1 = (U(+1g) − U(−1g))/2 and B0 = (U(+0g) + U(−0g))/(U(+1g) − U(−1g))·g (Huang et al. 2022, eq. 12, with the \
    sign that yields the bias: as printed, with a minus, it yields the tilt of the mounting). Variation of scale factor = \
    standard deviation over the nodes (n − 1) over the mean; variation of bias = standard deviation over the nodes (n − \
    1); sensitivities are least-squares slopes over the nodes.";

/// Scale factor and bias of one run over its temperature nodes.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct FullTemperature {
    /// The nodes in the order of the run.
    pub nodes: Vec<Node>,
    /// Standard deviation of K1 over the nodes over its mean, ppm.
    pub scale_factor_variation_ppm: f64,
    /// Standard deviation of B0 over the nodes, µg.
    pub bias_variation_ug: f64,
    /// Slope of K1 over temperature, ppm/K.
    pub scale_factor_temperature_sensitivity_ppm_per_k: f64,
    /// Slope of B0 over temperature, µg/K.
    pub bias_temperature_sensitivity_ug_per_k: f64,
}

/// One temperature node.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Node {
    /// Mean temperature, °C.
    pub temperature_c: f64,
    /// Positions that were fitted.
    pub positions: usize,
    /// Scale factor K1: output per g, in the output's unit.
    pub scale_factor_per_g: f64,
    /// Its standard uncertainty; `None` where the fit leaves nothing over.
    pub scale_factor_sigma_per_g: Option<f64>,
    /// Bias K0, g.
    pub bias_g: f64,
    /// Its standard uncertainty, g.
    pub bias_sigma_g: Option<f64>,
    /// Second-order coefficient K2, g/g²; `None` where some node has only two levels.
    pub second_order_g_per_g2: Option<f64>,
}

/// States whose temperatures differ by less belong to one node, °C.
const SAME_NODE_C: f64 = 3.0;
/// A node whose levels span less than this part of what the run's levels span says nothing of the scale factor.
const LEAST_PART_OF_SPAN: f64 = 0.5;

/// The figures of `outputs`, one of each row of the run, in any unit; `None` unless at least two temperature nodes
/// have two levels or more.
#[must_use]
pub fn full_temperature(run: &Run, outputs: &[f64]) -> Option<FullTemperature> {
    let all = states(run);
    let least_span = LEAST_PART_OF_SPAN * span(&references(&all));
    let levels: Vec<&[State]> = soaked(&all).filter(|node| span(&references(node)) > least_span).collect();
    // One model equation for all nodes, or its change would look like a change of the sensor.
    let second_order = levels.iter().all(|node| carries_second_order(&references(node)));
    let nodes: Vec<Node> = levels.into_iter().filter_map(|states| node(states, outputs, second_order)).collect();
    let scale_factors: Vec<f64> = nodes.iter().map(|node| node.scale_factor_per_g).collect();
    let biases: Vec<f64> = nodes.iter().map(|node| node.bias_g).collect();
    let over_temperature = |value: fn(&Node) -> f64| {
        line_slope(&nodes.iter().map(|node| (node.temperature_c, value(node))).collect::<Vec<_>>())
    };
    let mean_scale_factor = mean(&scale_factors);
    if nodes.len() < 2 || mean_scale_factor == 0.0 {
        return None;
    }
    Some(FullTemperature {
        scale_factor_variation_ppm: standard_deviation(&scale_factors) / mean_scale_factor.abs() * 1e6,
        bias_variation_ug: standard_deviation(&biases) * 1e6,
        scale_factor_temperature_sensitivity_ppm_per_k: over_temperature(|node| node.scale_factor_per_g)
            / mean_scale_factor
            * 1e6,
        bias_temperature_sensitivity_ug_per_k: over_temperature(|node| node.bias_g) * 1e6,
        nodes,
    })
}

/// Consecutive states at one temperature. What creeps on from state to state is a ramp and no node.
fn soaked(all: &[State]) -> impl Iterator<Item = &[State]> {
    let same_node = |a: &State, b: &State| (a.temperature_c - b.temperature_c).abs() < SAME_NODE_C;
    all.chunk_by(same_node).filter(|states| span(&temperatures(states)) < SAME_NODE_C)
}

fn references(states: &[State]) -> Vec<f64> {
    states.iter().map(|state| state.reference_g).collect()
}

fn temperatures(states: &[State]) -> Vec<f64> {
    states.iter().map(|state| state.temperature_c).collect()
}

fn node(states: &[State], outputs: &[f64], second_order: bool) -> Option<Node> {
    let position = |state: &State| Some([state.reference_g, mean(outputs.get(state.rows.clone())?)]);
    let positions = states.iter().map(position).collect::<Option<Vec<_>>>()?;
    let fit = InputAxis::fit(&positions, second_order)?;
    Some(Node {
        temperature_c: mean(&temperatures(states)),
        positions: positions.len(),
        scale_factor_per_g: fit.k1,
        scale_factor_sigma_per_g: fit.sigma.map(|[k1, _]| k1),
        bias_g: fit.k0,
        bias_sigma_g: fit.sigma.map(|[_, k0]| k0),
        second_order_g_per_g2: fit.k2,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::campaign::Row;
    use protocol::Sample;
    use std::path::PathBuf;

    const NODES_C: [f64; 4] = [-40.0, 0.0, 25.0, 85.0];
    const ROWS: usize = 12;

    /// A run of `references` at each temperature, a dozen rows each.
    fn run(references: &[f64], temperatures_c: &[f64]) -> Run {
        let places = temperatures_c.iter().flat_map(|&c| references.iter().map(move |&reference| (c, reference)));
        let rows = places.flat_map(|place| [place; ROWS]).enumerate().map(|(index, (c, reference_g))| Row {
            sample: Sample::from_difference(index as u64 * 1_000_000, 0, (c * 1e6) as i32),
            reference_g,
            reference_sigma_g: None,
        });
        Run { name: "run".into(), kind: "full".into(), source: PathBuf::new(), rows: rows.collect() }
    }

    fn k1(c: f64) -> f64 {
        420.0 * (1.0 + 30e-6 * c)
    }

    fn k0(c: f64) -> f64 {
        2e-3 + 150e-6 * c
    }

    /// K1 and K0 over temperature with a second-order coefficient of 50 µg/g².
    fn outputs(run: &Run) -> Vec<f64> {
        let output = |row: &Row| {
            let (a, c) = (row.reference_g, f64::from(row.sample.temperature_uc) * 1e-6);
            k1(c) * (k0(c) + a + 50e-6 * a * a)
        };
        run.rows.iter().map(output).collect()
    }

    fn tumble(count: u32) -> Vec<f64> {
        (0..count).map(|k| (f64::from(k) * 360.0 / f64::from(count)).to_radians().cos()).collect()
    }

    #[test]
    fn every_position_of_a_tumble_counts_as_what_was_applied() {
        for references in [vec![1.0, 0.0, -1.0], vec![0.0, 1.0, 0.0, -1.0], tumble(8), tumble(24)] {
            let run = run(&references, &NODES_C);
            let figures = full_temperature(&run, &outputs(&run)).expect("four nodes");
            assert_eq!(figures.nodes.len(), NODES_C.len());
            for (node, c) in figures.nodes.iter().zip(NODES_C) {
                assert_eq!((node.temperature_c.round(), node.positions), (c, references.len()));
                assert!((node.scale_factor_per_g / k1(c) - 1.0).abs() < 1e-9, "{node:?}");
                assert!((node.bias_g - k0(c)).abs() < 1e-10, "{node:?}");
                assert!(node.second_order_g_per_g2.is_some_and(|k2| (k2 - 50e-6).abs() < 1e-9), "{node:?}");
            }
            let k1s = NODES_C.map(k1);
            let variation_ppm = standard_deviation(&k1s) / mean(&k1s) * 1e6;
            assert!((figures.scale_factor_variation_ppm - variation_ppm).abs() < 1e-3);
            let variation_ug = standard_deviation(&NODES_C.map(k0)) * 1e6;
            assert!((figures.bias_variation_ug - variation_ug).abs() < 1e-3);
            assert!((figures.scale_factor_temperature_sensitivity_ppm_per_k - 30.0).abs() < 0.05);
            assert!((figures.bias_temperature_sensitivity_ug_per_k - 150.0).abs() < 1e-4);
        }
    }

    #[test]
    fn two_levels_make_a_line_in_every_node() {
        let run = run(&[1.0, -1.0], &NODES_C);
        let figures = full_temperature(&run, &outputs(&run)).expect("four nodes");
        for (node, c) in figures.nodes.iter().zip(NODES_C) {
            assert!((node.scale_factor_per_g / k1(c) - 1.0).abs() < 1e-9);
            assert!((node.bias_g - k0(c) - 50e-6).abs() < 1e-9, "the curve is taken for bias");
            assert_eq!((node.second_order_g_per_g2, node.bias_sigma_g), (None, None));
        }
    }

    #[test]
    fn a_perfect_reading_of_a_tumble_varies_by_nothing() {
        let run = run(&tumble(24), &NODES_C);
        let perfect: Vec<f64> = run.rows.iter().map(|row| row.reference_g).collect();
        let figures = full_temperature(&run, &perfect).expect("four nodes");
        assert!(figures.scale_factor_variation_ppm < 1e-6 && figures.bias_variation_ug < 1e-6, "{figures:?}");
    }

    #[test]
    fn a_load_cell_in_newtons_and_a_resistor_in_ppm_have_the_same_figures() {
        let g = run(&tumble(24), &NODES_C);
        let expected = full_temperature(&g, &outputs(&g)).expect("four nodes");
        for unit in [1e3, 1e-6, -1.0] {
            let mut scaled = g.clone();
            scaled.rows.iter_mut().for_each(|row| row.reference_g *= unit);
            let found = full_temperature(&scaled, &outputs(&g)).expect("four nodes");
            let near = |found: f64, expected: f64| (found / expected - 1.0).abs() < 1e-6;
            assert!(near(found.scale_factor_variation_ppm, expected.scale_factor_variation_ppm), "{unit}");
            assert!(near(found.bias_variation_ug, expected.bias_variation_ug * unit.abs()), "{unit}");
            assert!(near(found.nodes[0].scale_factor_per_g, expected.nodes[0].scale_factor_per_g / unit), "{unit}");
        }
    }

    #[test]
    fn a_reference_with_noise_of_its_own_makes_no_more_nodes_and_no_other_figures() {
        let mut noisy = run(&tumble(8), &NODES_C);
        for (index, row) in noisy.rows.iter_mut().enumerate() {
            row.reference_g += ((index * 37 % 41) as f64 - 20.0) * 1e-6;
        }
        let figures = full_temperature(&noisy, &outputs(&noisy)).expect("four nodes");
        assert_eq!(figures.nodes.iter().map(|node| node.positions).collect::<Vec<_>>(), [8; 4]);
        assert!((figures.scale_factor_temperature_sensitivity_ppm_per_k - 30.0).abs() < 0.05);
    }

    #[test]
    fn two_nodes_have_figures_and_one_has_none() {
        let two = run(&[1.0, -1.0], &[-40.0, 85.0]);
        let figures = full_temperature(&two, &outputs(&two)).expect("two nodes");
        assert!((figures.bias_temperature_sensitivity_ug_per_k - 150.0).abs() < 1e-4);
        let one = run(&[1.0, -1.0], &[25.0]);
        assert_eq!(full_temperature(&one, &outputs(&one)), None);
        // K1 of +1 and −1: their mean divides nothing.
        let turned: Vec<f64> =
            two.rows.iter().map(|row| row.reference_g * f64::from(row.sample.temperature_uc)).collect();
        let signs: Vec<f64> =
            two.rows.iter().zip(turned).map(|(row, of)| row.reference_g.abs() * of.signum()).collect();
        assert_eq!(full_temperature(&two, &signs), None);
    }

    #[test]
    fn half_of_what_the_run_spans_is_not_enough_for_a_node() {
        let mut nodes = run(&[1.0, -1.0], &[-40.0, 85.0]);
        nodes.rows.extend(run(&[1.0, 0.0], &[25.0]).rows);
        assert_eq!(full_temperature(&nodes, &outputs(&nodes)).expect("two nodes").nodes.len(), 2);
        nodes.rows.extend(run(&[1.0, -0.01], &[0.0]).rows);
        assert_eq!(full_temperature(&nodes, &outputs(&nodes)).expect("three nodes").nodes.len(), 3);
    }

    #[test]
    fn a_ramp_and_a_dead_output_have_no_figures() {
        let creeping: Vec<f64> = (0..40).map(|k| f64::from(k) * 2.0).collect();
        let ramp = run(&tumble(8), &creeping);
        assert_eq!(full_temperature(&ramp, &outputs(&ramp)), None);
        let nodes = run(&tumble(8), &NODES_C);
        assert_eq!(full_temperature(&nodes, &vec![0.0; nodes.rows.len()]), None);
        assert_eq!(full_temperature(&run(&[0.0], &NODES_C), &vec![1.0; 4 * ROWS]), None);
    }
}
