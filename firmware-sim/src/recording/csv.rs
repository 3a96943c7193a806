//! A recording as comma-separated text: one header, one line a sample, units in the names.

use std::io::{self, Write};

use super::column::Column;
use super::row::{RecordedRun, Row};

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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_name_is_quoted_only_where_it_must_be() {
        assert_eq!((quoted("full-1"), quoted("a,\"b\"")), ("full-1".into(), "\"a,\"\"b\"\"\"".into()));
    }
}
