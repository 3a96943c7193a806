//! The optional columns.

use std::io::{self, Write};

use serde::{Deserialize, Serialize};

use super::row::Row;

/// The optional columns of a recording.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Column {
    /// `power_on_s`
    PowerOnS,
    /// `age_days`
    AgeDays,
    /// `f1_hz`
    F1Hz,
    /// `f2_hz`
    F2Hz,
    /// `sum_f_hz`
    SumFHz,
    /// `reference_sigma_g`
    ReferenceSigmaG,
    /// `cross_g`
    CrossG,
    /// `supply_v`
    SupplyV,
    /// `vibration_g2`
    #[serde(rename = "vibration_g2")]
    VibrationG2,
    /// `pressure_pa`
    PressurePa,
    /// `humidity_pct`
    HumidityPct,
}

impl Column {
    /// The column's header.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::PowerOnS => "power_on_s",
            Self::AgeDays => "age_days",
            Self::F1Hz => "f1_hz",
            Self::F2Hz => "f2_hz",
            Self::SumFHz => "sum_f_hz",
            Self::ReferenceSigmaG => "reference_sigma_g",
            Self::CrossG => "cross_g",
            Self::SupplyV => "supply_v",
            Self::VibrationG2 => "vibration_g2",
            Self::PressurePa => "pressure_pa",
            Self::HumidityPct => "humidity_pct",
        }
    }

    /// A comma and the value, with as many decimals as mean something.
    pub(super) fn write(self, row: &Row, out: &mut impl Write) -> io::Result<()> {
        match self {
            Self::PowerOnS => write!(out, ",{}", row.power_on_s),
            Self::AgeDays => write!(out, ",{:.6}", row.age_days),
            Self::F1Hz => write!(out, ",{:.6}", row.f1_hz),
            Self::F2Hz => write!(out, ",{:.6}", row.f2_hz),
            Self::SumFHz => write!(out, ",{:.6}", row.sum_f_hz),
            Self::ReferenceSigmaG => write!(out, ",{:.9}", row.reference_sigma_g),
            Self::CrossG => write!(out, ",{:.9}", row.cross_g),
            Self::SupplyV => write!(out, ",{:.6}", row.supply_v),
            Self::VibrationG2 => write!(out, ",{:.6}", row.vibration_g2),
            Self::PressurePa => write!(out, ",{:.1}", row.pressure_pa),
            Self::HumidityPct => write!(out, ",{:.3}", row.humidity_pct),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn headers_are_the_names_that_scenarios_use() {
        for column in [Column::PowerOnS, Column::F1Hz, Column::VibrationG2, Column::ReferenceSigmaG] {
            assert_eq!(toml::Value::try_from(column).unwrap().as_str(), Some(column.name()));
        }
    }
}
