//! How a foreign table is to be understood: from the caller, and from the `campaign.toml` beside the data.

use super::error::{CampaignError, Facts, Place, quoted};
use super::{Quantity, table};
use serde::Deserialize;
use std::collections::BTreeMap;
use std::path::Path;

/// The file beside the data that says how to read it.
const MANIFEST: &str = "campaign.toml";

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
/// Of two mappings to one name the later one counts.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ReadOptions {
    /// Our name and what stands for it, as in `--map delta_f_hz=FreqDiff`.
    pub map: Vec<(String, String)>,
    /// A signal other than a frequency difference in Hz. `f1_hz` and `f2_hz` lose their meaning then.
    pub signal: Option<Measured>,
    /// A reference other than an acceleration in g.
    pub reference: Option<Measured>,
    /// The auxiliary channels to keep, in this order; `None` keeps every numeric column.
    pub channels: Option<Vec<String>>,
    /// Columns to leave unread.
    pub ignore: Vec<String>,
    /// The reference of every row, g, where a still sensor has no column for it.
    pub constant_reference: Option<f64>,
}

/// A measured quantity: its column, which may carry a conversion like any mapping, and the unit after it.
#[derive(Clone, Debug, PartialEq, Eq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Measured {
    /// The column.
    pub column: String,
    /// The unit, as reports shall write it.
    pub unit: String,
}

/// `campaign.toml`: the same options as text.
#[derive(Default, Deserialize)]
#[serde(deny_unknown_fields, default)]
struct Manifest {
    columns: BTreeMap<String, String>,
    signal: Option<Measured>,
    reference: Option<Measured>,
    channels: Option<Vec<String>>,
    ignore: Vec<String>,
    constant_reference: Option<f64>,
}

impl ReadOptions {
    /// These options over those of the `campaign.toml` beside `file`, if there is one.
    pub(super) fn beside(&self, file: &Path) -> Result<Self, CampaignError> {
        let path = file.with_file_name(MANIFEST);
        if !path.is_file() {
            return Ok(self.clone());
        }
        let text = table::read_text(&path)?;
        let manifest = toml::from_str(&text).map_err(|error| not_understood(&path, &text, &error))?;
        Ok(self.over(manifest))
    }

    fn over(&self, below: Manifest) -> Self {
        Self {
            map: below.columns.into_iter().chain(self.map.iter().cloned()).collect(),
            signal: self.signal.clone().or(below.signal),
            reference: self.reference.clone().or(below.reference),
            channels: self.channels.clone().or(below.channels),
            ignore: self.ignore.iter().cloned().chain(below.ignore).collect(),
            constant_reference: self.constant_reference.or(below.constant_reference),
        }
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
    let line = table::line_at(text.as_bytes(), error.span().map_or(0, |span| span.start));
    let content = text.lines().nth(line as usize - 1).unwrap_or_default();
    // The parser's message often ends with what it expected.
    let (found, expected) = error.message().split_once(", expected ").unwrap_or((error.message(), "valid TOML"));
    let found = format!("{} ({found})", quoted(content.as_bytes()));
    CampaignError::Manifest(Facts::boxed(Place::file(path).line(line), found, expected))
}
