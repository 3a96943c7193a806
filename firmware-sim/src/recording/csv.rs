//! A recording as comma-separated text: one header, one line a sample, units in the names.

use std::io::{self, Write};

use super::{Column, RecordedRun, Row};

/// Frequencies to 1 µHz, temperatures to 1 µ°C, times to 1 µs, accelerations to 1 ng.
pub(super) fn write(out: &mut impl Write, columns: &[Column], runs: &[RecordedRun]) -> io::Result<()> {
    let mut out = io::BufWriter::new(out);
    write!(out, "run,kind,time_s,temperature_c,delta_f_hz,reference_g")?;
    for column in columns {
        write!(out, ",{}", column.name())?;
    }
    writeln!(out)?;
    for run in runs {
        for row in &run.rows {
            let Row { time_s, temperature_c, delta_f_hz, reference_g, .. } = row;
            write!(out, "{},{},{time_s},", quoted(&run.name), run.kind)?;
            write!(out, "{temperature_c:.6},{delta_f_hz:.6},{reference_g:.9}")?;
            for column in columns {
                column.write(row, &mut out)?;
            }
            writeln!(out)?;
        }
    }
    out.flush()
}

/// A name as a CSV field: quoted only where it must be.
fn quoted(name: &str) -> String {
    if name.contains([',', '"', '\n', '\r']) { format!("\"{}\"", name.replace('"', "\"\"")) } else { name.into() }
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
    fn write(self, row: &Row, out: &mut impl Write) -> io::Result<()> {
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
    fn a_name_is_quoted_only_where_it_must_be() {
        assert_eq!((quoted("full-1"), quoted("a,\"b\"")), ("full-1".into(), "\"a,\"\"b\"\"\"".into()));
    }

    #[test]
    fn headers_are_the_names_that_scenarios_use() {
        for column in [Column::PowerOnS, Column::F1Hz, Column::VibrationG2, Column::ReferenceSigmaG] {
            assert_eq!(toml::Value::try_from(column).unwrap().as_str(), Some(column.name()));
        }
    }
}
