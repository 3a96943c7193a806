//! Scale factor and bias over temperature (Huang et al. 2022, Table 2).

use super::states::{State, states};
use super::{line_slope, mean, standard_deviation};
use crate::campaign::Run;
use serde::Serialize;

/// What the figures mean.
pub const DEFINITION: &str = "K1 = (U(+1g) − U(−1g))/2 and B0 = (U(+0g) + U(−0g))/(U(+1g) − U(−1g))·g at each \
    temperature node (Huang et al. 2022, eq. 12, with the sign that yields the bias: as printed, with a minus, it \
    yields the tilt of the mounting); variation of scale factor = standard deviation over the nodes (n − 1) over \
    the mean; variation of bias = standard deviation over the nodes (n − 1); sensitivities are least-squares \
    slopes over the nodes.";

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
    /// Output per g, in the output's unit.
    pub scale_factor_per_g: f64,
    /// Bias, g.
    pub bias_g: f64,
}

/// States whose temperatures differ by less belong to one node, °C.
const SAME_NODE_C: f64 = 3.0;
/// How far a level may be from −1, 0 or +1 g and still count as it.
const LEVEL_TOLERANCE_G: f64 = 0.05;

/// The figures of `outputs`, one of each row of the run, in any unit; `None` unless at least two nodes
/// have the levels −1, 0 and +1 g.
#[must_use]
pub fn full_temperature(run: &Run, outputs: &[f64]) -> Option<FullTemperature> {
    let all = states(run);
    let same_node = |a: &State, b: &State| (a.temperature_c - b.temperature_c).abs() < SAME_NODE_C;
    let nodes: Vec<Node> = all.chunk_by(same_node).filter_map(|states| node(states, outputs)).collect();
    if nodes.len() < 2 {
        return None;
    }
    let scale_factors: Vec<f64> = nodes.iter().map(|node| node.scale_factor_per_g).collect();
    let biases: Vec<f64> = nodes.iter().map(|node| node.bias_g).collect();
    let over_temperature = |value: fn(&Node) -> f64| {
        line_slope(&nodes.iter().map(|node| (node.temperature_c, value(node))).collect::<Vec<_>>())
    };
    let mean_scale_factor = mean(&scale_factors);
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

fn node(states: &[State], outputs: &[f64]) -> Option<Node> {
    let at = |level_g: f64| {
        let means: Vec<f64> = states
            .iter()
            .filter(|state| (state.reference_g - level_g).abs() < LEVEL_TOLERANCE_G)
            .filter_map(|state| outputs.get(state.rows.clone()).map(mean))
            .collect();
        (!means.is_empty()).then(|| mean(&means))
    };
    let (plus, zero, minus) = (at(1.0)?, at(0.0)?, at(-1.0)?);
    let temperatures: Vec<f64> = states.iter().map(|state| state.temperature_c).collect();
    Some(Node {
        temperature_c: mean(&temperatures),
        scale_factor_per_g: (plus - minus) / 2.0,
        // The mean of the two zero states, twice, over the span.
        bias_g: 2.0 * zero / (plus - minus),
    })
}
