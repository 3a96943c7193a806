//! How a foreign table is to be understood: from the caller, and from the `campaign.toml` beside the data.

use super::error::{CampaignError, Facts, Place, quoted};
use super::limits::MAX_MANIFEST;
use super::mapping::is_there;
use super::quantity::Quantity;
use super::table::Table;
use super::text;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::path::Path;

/// The file beside the data that says how to read it.
const MANIFEST: &str = "campaign.toml";
/// Our names for the reference and for what a signal can be written as.
const REFERENCE: &str = "reference_g";
const SIGNALS: [&str; 3] = ["delta_f_hz", "f1_hz", "f2_hz"];

/// How the columns of a table are to be understood. The default understands the data contract's own names.
///
/// A mapping pairs one of our names with what stands for it in the table:
///
/// | text | meaning |
/// |---|---|
/// | `FreqDiff` | that column, already in our unit |
/// | `timestamp [ns] * 1e-9` | times a factor (`/` divides) |
/// | `T_kelvin - 273.15` | plus an offset |
/// | `Temp_F / 1.8 - 17.7778` | both, the factor first |
/// | `row * 0.5` | the row's number in its file, from 0: a clock for tables without one |
/// | `21.5` | the same number in every row |
///
/// `campaign.toml` holds the same as text, the mappings in a table `columns`; so does a model file.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct ReadOptions {
    /// Our name and what stands for it, as in `--map delta_f_hz=FreqDiff`.
    #[serde(rename = "columns", skip_serializing_if = "BTreeMap::is_empty")]
    pub map: BTreeMap<String, String>,
    /// A signal other than a frequency difference in Hz. `f1_hz` and `f2_hz` lose their meaning then.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub signal: Option<Measured>,
    /// A reference other than an acceleration in g.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub reference: Option<Measured>,
    /// The auxiliary channels to keep, in this order; `None` keeps every numeric column.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub channels: Option<Vec<String>>,
    /// Columns to leave unread.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub ignore: Vec<String>,
    /// The reference of every row, g, where a still sensor has no column for it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub constant_reference: Option<f64>,
}

/// How a campaign's files were read: what a model file keeps, so that later commands read others like them.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct ReadAs {
    /// What the caller gave.
    #[serde(skip_serializing_if = "ReadOptions::is_empty")]
    pub options: ReadOptions,
    /// What the `campaign.toml` beside the data said, if all files had the same.
    #[serde(skip_serializing_if = "ReadOptions::is_empty")]
    pub manifest: ReadOptions,
}

impl ReadAs {
    /// Whether nothing but the data contract's own names was needed.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.options.is_empty() && self.manifest.is_empty()
    }

    /// How a table is read: by what the caller gives now, else as the files before were by the caller's wish, else by the
    /// `campaign.toml` beside the table, else as by the one before. What the table has no column for is passed over, but
    /// not what the caller gives now.
    pub(super) fn for_table(&self, given: &ReadOptions, table: &Table) -> Result<Self, CampaignError> {
        Ok(Self {
            options: given.over(&self.options.fitting(table)),
            manifest: ReadOptions::beside(&table.file)?.over(&self.manifest.fitting(table)),
        })
    }

    /// Both as one.
    pub(super) fn merged(&self) -> ReadOptions {
        self.options.over(&self.manifest)
    }
}

/// A measured quantity: its column, which may carry a conversion like any mapping, and the unit after it.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Measured {
    /// The column.
    pub column: String,
    /// The unit, as reports shall write it.
    pub unit: String,
}

impl ReadOptions {
    /// Whether nothing is said.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        *self == Self::default()
    }

    /// What the `campaign.toml` beside `file` says, if there is one.
    fn beside(file: &Path) -> Result<Self, CampaignError> {
        let path = file.with_file_name(MANIFEST);
        if !path.is_file() {
            return Ok(Self::default());
        }
        let text = text::read_text(&path, MAX_MANIFEST)?;
        toml::from_str(&text).map_err(|error| not_understood(&path, &text, &error))
    }

    /// These options, and where they are silent those `below`.
    fn over(&self, below: &Self) -> Self {
        let mut below = below.clone();
        // Signal and reference can each be said in several ways: one of them above silences all below.
        if self.says_signal() {
            below.forget_signal();
        }
        if self.says_reference() {
            below.forget_reference();
        }
        let mut ignore = self.ignore.clone();
        ignore.extend(below.ignore.into_iter().filter(|name| !self.ignore.contains(name)));
        Self {
            map: below.map.into_iter().chain(self.map.clone()).collect(),
            signal: self.signal.clone().or(below.signal),
            reference: self.reference.clone().or(below.reference),
            channels: self.channels.clone().or(below.channels),
            ignore,
            constant_reference: self.constant_reference.or(below.constant_reference),
        }
    }

    /// These options without what `table` has no column for.
    fn fitting(&self, table: &Table) -> Self {
        let mut fitting = self.clone();
        fitting.map.retain(|name, text| is_there(table, name, text));
        fitting.signal = fitting.signal.filter(|signal| is_there(table, "delta_f_hz", &signal.column));
        fitting.reference = fitting.reference.filter(|reference| is_there(table, "reference_g", &reference.column));
        let has = |name: &String| table.header.contains(name) || fitting.map.contains_key(name);
        fitting.channels = fitting.channels.filter(|channels| channels.iter().all(has));
        let has_reference = table.header.iter().any(|name| name == "reference_g");
        fitting.constant_reference = fitting.constant_reference.filter(|_| !has_reference);
        fitting
    }

    fn says_signal(&self) -> bool {
        self.signal.is_some() || SIGNALS.iter().any(|name| self.map.contains_key(*name))
    }

    fn forget_signal(&mut self) {
        self.signal = None;
        self.map.retain(|name, _| !SIGNALS.contains(&name.as_str()));
    }

    fn says_reference(&self) -> bool {
        self.reference.is_some() || self.constant_reference.is_some() || self.map.contains_key(REFERENCE)
    }

    fn forget_reference(&mut self) {
        (self.reference, self.constant_reference) = (None, None);
        self.map.remove(REFERENCE);
    }

    /// Every name that is mapped, once, and what stands for it.
    pub(super) fn mappings(&self) -> BTreeMap<&str, &str> {
        let map = self.map.iter().map(|(name, text)| (name.as_str(), text.as_str()));
        let signal = self.signal.iter().map(|signal| ("delta_f_hz", signal.column.as_str()));
        let reference = self.reference.iter().map(|reference| ("reference_g", reference.column.as_str()));
        map.chain(signal).chain(reference).collect()
    }

    /// The units that result.
    pub(super) fn quantity(&self) -> Quantity {
        let usual = Quantity::default();
        Quantity {
            signal_unit: self.signal.as_ref().map_or(usual.signal_unit, |signal| signal.unit.clone()),
            reference_unit: self.reference.as_ref().map_or(usual.reference_unit, |reference| reference.unit.clone()),
        }
    }
}

fn not_understood(path: &Path, text: &str, error: &toml::de::Error) -> CampaignError {
    let line = text::line_at(text.as_bytes(), error.span().map_or(0, |span| span.start));
    let content = text.lines().nth(line as usize - 1).unwrap_or_default();
    // The parser's message often ends with what it expected.
    let (found, expected) = error.message().split_once(", expected ").unwrap_or((error.message(), "valid TOML"));
    let found = format!("{} ({found})", quoted(content.as_bytes()));
    CampaignError::Manifest(Facts::boxed(Place::file(path).line(line), found, expected))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn options(text: &str) -> ReadOptions {
        toml::from_str(text).unwrap_or_else(|error| panic!("{text}: {error}"))
    }

    #[test]
    fn one_way_to_say_the_signal_or_the_reference_silences_the_others_below_it() {
        let signal = "[signal]\ncolumn = 'v'\nunit = 'mV'\n";
        let reference = "[reference]\ncolumn = 'kg'\nunit = 'kg'\n";
        for (above, below, expected) in [
            (
                "[columns]\nf1_hz = 'a'",
                &format!("{signal}[columns]\ndelta_f_hz = 'd'\ntime_s = 't'")[..],
                "[columns]\nf1_hz = 'a'\ntime_s = 't'",
            ),
            (signal, "[columns]\nf1_hz = 'a'\nf2_hz = 'b'", signal),
            (
                "[columns]\nreference_g = 'r'",
                &format!("constant_reference = 1.0\n{reference}"),
                "[columns]\nreference_g = 'r'",
            ),
            (reference, "constant_reference = 1.0\n[columns]\nreference_g = 'r'", reference),
            ("constant_reference = 2.0", &format!("constant_reference = 1.0\n{reference}"), "constant_reference = 2.0"),
            ("channels = ['a']", &format!("{signal}{reference}"), &format!("channels = ['a']\n{signal}{reference}")),
            ("ignore = ['a']", "ignore = ['a', 'b']\nchannels = ['c']", "ignore = ['a', 'b']\nchannels = ['c']"),
        ] {
            assert_eq!(options(above).over(&options(below)), options(expected), "{above} over {below}");
        }
    }

    #[test]
    fn options_that_say_anything_are_not_empty() {
        let said = options("constant_reference = 0.0");
        assert!(ReadOptions::default().is_empty() && !said.is_empty() && ReadAs::default().is_empty());
        let by_caller = ReadAs { options: said.clone(), ..ReadAs::default() };
        assert!(!by_caller.is_empty() && !ReadAs { manifest: said, ..ReadAs::default() }.is_empty());
    }
}
