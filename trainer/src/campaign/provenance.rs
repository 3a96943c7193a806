//! The hash that says which data a model came from.

use super::quantity::Quantity;
use super::run::{Row, Run};
use protocol::Sample;
use sha2::{Digest, Sha256};

/// The form of the hashed bytes. Another form needs another name: old models keep theirs.
const FORM: &[u8] = b"tempco campaign 1\0";
/// Bytes to gather before they are hashed.
const PORTION: usize = 1 << 16;

/// SHA-256 of the measured content: units, channels by name, and every run's name, kind and rows in order.
///
/// Folders, separators, comments, the order of columns and how a number was written do not matter.
pub(super) fn sha256(runs: &[Run], channels: &[String], quantity: &Quantity) -> [u8; 32] {
    let mut by_name: Vec<usize> = (0..channels.len()).collect();
    by_name.sort_unstable_by_key(|&position| channels.get(position));
    let mut hash = Sha256::new();
    let mut bytes = FORM.to_vec();
    put_text(&mut bytes, &quantity.signal_unit);
    put_text(&mut bytes, &quantity.reference_unit);
    put_count(&mut bytes, channels.len());
    for &position in &by_name {
        put_text(&mut bytes, &channels[position]);
    }
    put_count(&mut bytes, runs.len());
    for run in runs {
        put_text(&mut bytes, &run.name);
        put_text(&mut bytes, &run.kind);
        put_count(&mut bytes, run.rows.len());
        for row in &run.rows {
            put_row(&mut bytes, row, &by_name);
            if bytes.len() >= PORTION {
                hash.update(&bytes);
                bytes.clear();
            }
        }
    }
    hash.update(&bytes);
    hash.finalize().into()
}

fn put_row(bytes: &mut Vec<u8>, row: &Row, channels: &[usize]) {
    let sample = &row.sample;
    bytes.extend(sample.time_us.to_le_bytes());
    bytes.extend(sample.power_on_us.to_le_bytes());
    put_optional(bytes, sample.age_s.map(|age_s| u64::from(age_s).to_le_bytes()));
    bytes.extend(sample.delta_f_uhz.to_le_bytes());
    put_optional(bytes, sample.sum_f_uhz.map(u64::to_le_bytes));
    bytes.extend(sample.temperature_uc.to_le_bytes());
    for &position in channels {
        bytes.extend(sample.channels.get(position).copied().unwrap_or(Sample::NOT_MEASURED).to_le_bytes());
    }
    bytes.extend(row.reference_g.to_bits().to_le_bytes());
    put_optional(bytes, row.reference_sigma_g.map(|sigma_g| sigma_g.to_bits().to_le_bytes()));
}

fn put_optional(bytes: &mut Vec<u8>, value: Option<[u8; 8]>) {
    bytes.push(u8::from(value.is_some()));
    bytes.extend(value.iter().flatten());
}

/// A length before every text and list keeps different contents from becoming the same bytes.
fn put_text(bytes: &mut Vec<u8>, text: &str) {
    put_count(bytes, text.len());
    bytes.extend(text.as_bytes());
}

fn put_count(bytes: &mut Vec<u8>, count: usize) {
    bytes.extend((count as u64).to_le_bytes());
}
