//! Arrays of a model file, whose length counts.

use serde::Deserialize;
use serde::de::{DeserializeOwned, Deserializer, Error};

/// An array of exactly `N` entries. TOML's own reading of an array leaves surplus entries unread.
pub(super) fn exactly<'de, D, T, const N: usize>(deserializer: D) -> Result<[T; N], D::Error>
where
    D: Deserializer<'de>,
    T: DeserializeOwned,
{
    let entries = Vec::<T>::deserialize(deserializer)?;
    entries.try_into().map_err(|entries: Vec<T>| wrong_length(entries.len(), N))
}

/// The same of rows of exactly `M` entries.
pub(super) fn rows_exactly<'de, D, T, const N: usize, const M: usize>(deserializer: D) -> Result<[[T; M]; N], D::Error>
where
    D: Deserializer<'de>,
    T: DeserializeOwned,
{
    let rows: [Vec<T>; N] = exactly(deserializer)?;
    let row = |row: Vec<T>| row.try_into().map_err(|row: Vec<T>| wrong_length(row.len(), M));
    let rows = rows.into_iter().map(row).collect::<Result<Vec<[T; M]>, D::Error>>()?;
    rows.try_into().map_err(|rows: Vec<[T; M]>| wrong_length(rows.len(), N))
}

fn wrong_length<E: Error>(found: usize, expected: usize) -> E {
    E::custom(format_args!("{found} entries, expected {expected}"))
}
