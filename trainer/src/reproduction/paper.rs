//! The paper's tables: which figure of which recording, and the numbers that it prints.

use crate::metrics::full_temperature::FullTemperature;
use crate::metrics::zero_bias::ZeroBias;

/// One row of Table 1 or 2 for one of its test data sets.
#[derive(Clone, Copy, Debug)]
pub struct PaperRow {
    /// The table.
    pub table: u8,
    /// The paper's test data set.
    pub data_set: u8,
    /// The figure of merit.
    pub figure: Figure,
    /// Printed for the raw output.
    pub raw: f64,
    /// Printed for the FA-BP network.
    pub fa_bp: f64,
    /// Printed for the IFA-BP network.
    pub ifa_bp: f64,
}

/// A figure of merit of the paper's tables.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Figure {
    /// Zero-bias stability after 30 min, µg.
    After30Min,
    /// Zero-bias stability after 20 min, µg.
    After20Min,
    /// Zero-start zero-bias stability, µg.
    FromStart,
    /// Variation of the scale factor at full temperature, ppm.
    ScaleFactorVariation,
    /// Variation of the bias at full temperature, µg.
    BiasVariation,
}

impl Figure {
    /// What it is called, with its unit.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::After30Min => "zero bias after 30 min, µg",
            Self::After20Min => "zero bias after 20 min, µg",
            Self::FromStart => "zero bias from the start, µg",
            Self::ScaleFactorVariation => "scale factor variation, ppm",
            Self::BiasVariation => "bias variation, µg",
        }
    }

    /// Its value, from the metric that holds it.
    #[must_use]
    pub fn of(self, zero_bias: Option<&ZeroBias>, full_temperature: Option<&FullTemperature>) -> Option<f64> {
        match self {
            Self::After30Min => Some(zero_bias?.after_30_min_ug),
            Self::After20Min => Some(zero_bias?.after_20_min_ug),
            Self::FromStart => Some(zero_bias?.from_start_ug),
            Self::ScaleFactorVariation => Some(full_temperature?.scale_factor_variation_ppm),
            Self::BiasVariation => Some(full_temperature?.bias_variation_ug),
        }
    }
}

impl PaperRow {
    /// The run that stands for its test data set in the simulated campaigns.
    #[must_use]
    pub const fn run(&self) -> &'static str {
        match (self.table, self.data_set) {
            (1, 1) => "zero-test-1",
            (1, _) => "zero-test-2",
            (_, 1) => "full-test-1",
            _ => "full-test-2",
        }
    }
}

/// The runs that no training sees: the paper's test data sets.
pub const TEST_RUNS: [&str; 4] = ["zero-test-1", "zero-test-2", "full-test-1", "full-test-2"];

use Figure::{After20Min, After30Min, BiasVariation, FromStart, ScaleFactorVariation};

/// Tables 1 and 2.
pub const ROWS: [PaperRow; 10] = [
    row(1, 1, After30Min, [186.47, 15.867, 7.7562]),
    row(1, 1, After20Min, [231.63, 16.902, 9.6671]),
    row(1, 1, FromStart, [283.05, 24.848, 11.868]),
    row(1, 2, After30Min, [109.56, 14.476, 7.4809]),
    row(1, 2, After20Min, [136.38, 19.417, 10.127]),
    row(1, 2, FromStart, [227.98, 25.907, 12.750]),
    row(2, 1, ScaleFactorVariation, [20_600.0, 578.77, 214.86]),
    row(2, 1, BiasVariation, [39_152.0, 89.431, 32.967]),
    row(2, 2, ScaleFactorVariation, [2153.2, 107.59, 30.806]),
    row(2, 2, BiasVariation, [32_873.0, 103.57, 36.556]),
];

const fn row(table: u8, data_set: u8, figure: Figure, [raw, fa_bp, ifa_bp]: [f64; 3]) -> PaperRow {
    PaperRow { table, data_set, figure, raw, fa_bp, ifa_bp }
}

/// How far apart the scale factors of Table 2's two data sets are at some temperature node, relative to their size.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Contradiction {
    /// At least so far in the raw output, ppm.
    pub raw_ppm: f64,
    /// At most so far in the output of the IFA-BP network, ppm.
    pub compensated_ppm: f64,
}

/// Temperature nodes of a full-temperature experiment.
const NODES: f64 = 6.0;

/// What Table 2 says of one model for two data sets of one device.
///
/// Let dᵢ be the difference of the two data sets' K1 at node i, each over its own mean, so that the dᵢ add up to zero.
/// Standard deviations obey the triangle inequality. So the raw dᵢ scatter by at least the difference of the two
/// printed variations; their range is at least twice their root mean square (Popoviciu), and whatever the ratio of the
/// means, one node differs by at least half the range. The compensated dᵢ scatter by at most the sum of the two printed
/// variations, and of six numbers with that scatter none is further off than 5/√6 times it.
#[must_use]
pub fn contradiction() -> Contradiction {
    let rows = || ROWS.iter().filter(|row| row.figure == ScaleFactorVariation);
    let raw = rows().map(|row| row.raw);
    let range = raw.clone().fold(0.0, f64::max) - raw.fold(f64::MAX, f64::min);
    let sum: f64 = rows().map(|row| row.ifa_bp).sum();
    Contradiction {
        raw_ppm: range * ((NODES - 1.0) / NODES).sqrt(),
        compensated_ppm: sum * (NODES - 1.0) / NODES.sqrt(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::metrics::standard_deviation;

    #[test]
    fn the_bounds_hold_for_any_six_nodes() {
        // The tightest cases: half of the nodes on each side, and one node alone.
        let halves = [1.0, 1.0, 1.0, -1.0, -1.0, -1.0];
        let range_over_deviation = 2.0 / standard_deviation(&halves);
        assert!((range_over_deviation / 2.0 - (5.0_f64 / 6.0).sqrt()).abs() < 1e-12);
        let alone = [5.0, -1.0, -1.0, -1.0, -1.0, -1.0];
        assert!((5.0 / standard_deviation(&alone) - 5.0 / 6.0_f64.sqrt()).abs() < 1e-12);
    }

    #[test]
    fn table_2_brings_seventeen_milli_g_to_half_a_milli_g() {
        let Contradiction { raw_ppm, compensated_ppm } = contradiction();
        assert!((raw_ppm - 16_840.0).abs() < 10.0 && (compensated_ppm - 501.0).abs() < 1.0);
    }
}
