//! What a table may be at most, so that no file takes all memory or all time; `docs/data.md` states it.

/// Bytes of a file: ten million rows of a hundred characters.
pub(super) const MAX_FILE: u64 = 1 << 30;
/// Bytes of a `campaign.toml`.
pub(super) const MAX_MANIFEST: u64 = 1 << 20;
/// Bytes of a record, line breaks within quotes included.
pub(super) const MAX_RECORD: usize = 1 << 20;
/// Columns of a table, read or not.
pub(super) const MAX_COLUMNS: usize = 1000;
/// Bytes of a name: of a column, a run or a kind.
pub(super) const MAX_NAME: usize = 200;
/// No instrument has been on for longer, µs (ten years): a time beyond it is that of a calendar.
pub(super) const MAX_UPTIME_US: u64 = 10 * 366 * 86_400 * 1_000_000;

/// A count of bytes for people.
pub(super) fn bytes(count: u64) -> String {
    match count {
        0..1_024 => format!("{count} bytes"),
        1_024..1_048_576 => format!("{:.0} KiB", count as f64 / 1_024.0),
        1_048_576..1_073_741_824 => format!("{:.0} MiB", count as f64 / 1_048_576.0),
        _ => format!("{:.1} GiB", count as f64 / 1_073_741_824.0),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bytes_are_counted_in_the_largest_unit_that_they_fill() {
        for (count, text) in [
            (0, "0 bytes"),
            (1_023, "1023 bytes"),
            (1_024, "1 KiB"),
            (1_048_575, "1024 KiB"),
            (1_048_576, "1 MiB"),
            (MAX_FILE - 1, "1024 MiB"),
            (MAX_FILE, "1.0 GiB"),
            (3 << 29, "1.5 GiB"),
            (MAX_MANIFEST, "1 MiB"),
            (MAX_RECORD as u64, "1 MiB"),
        ] {
            assert_eq!(bytes(count), text);
        }
        assert_eq!(MAX_UPTIME_US, 316_224_000_000_000, "3660 days");
    }
}
