//! Options that several commands share: which measurements, which runs.

mod columns;

use crate::failure::Failure;
use crate::shell;
use crate::terminal::remark;
use clap::Args;
use clap::builder::RangedU64ValueParser;
use columns::Columns;
use std::path::PathBuf;
use trainer::campaign::{Campaign, HoldOut, Measured, ReadAs, ReadOptions};
use trainer::model::Model;
use trainer::train::TrainSettings;

/// Where the measurements are, and how to read them.
#[derive(Args, Clone)]
pub struct Data {
    /// Campaign: CSV files, or folders of them
    #[arg(required = true, value_name = "DATA")]
    pub files: Vec<PathBuf>,

    #[command(flatten)]
    pub reading: Reading,
}

/// How to read measurements.
#[derive(Args, Clone, Default)]
pub struct Reading {
    /// Reads a column under another name, with a factor and an offset if need be: `delta_f_hz=FreqDiff`, `time_s=t_ms*0.001`
    #[arg(long, value_name = "NAME=COLUMN")]
    pub map: Vec<String>,

    /// Column of the signal, when it is not a frequency difference
    #[arg(long, value_name = "COLUMN", requires = "signal_unit")]
    pub signal: Option<String>,

    /// Unit of the signal
    #[arg(long, value_name = "UNIT", requires = "signal")]
    pub signal_unit: Option<String>,

    /// Column of the reference, when it is not an acceleration in g
    #[arg(long, value_name = "COLUMN", requires = "reference_unit")]
    pub reference: Option<String>,

    /// Unit of the reference
    #[arg(long, value_name = "UNIT", requires = "reference")]
    pub reference_unit: Option<String>,

    /// Reference of every row, for a sensor that lies still and has no column for it
    #[arg(long, value_name = "G", allow_negative_numbers = true)]
    pub constant_reference: Option<f64>,

    /// Keeps only these auxiliary channels, in this order. May be repeated; a name that has a comma stands in double quotes,
    /// as in a CSV file: `--channels '"supply, V",pressure_kpa'`
    #[arg(long, value_name = "COLUMN,…")]
    pub channels: Option<Vec<Columns>>,

    /// Leaves these columns unread. May be repeated, and quoted like `--channels`
    #[arg(long, value_name = "COLUMN,…")]
    pub ignore: Vec<Columns>,
}

impl Data {
    pub fn read(&self) -> Result<Campaign, Failure> {
        self.reading.read(&self.files, &ReadAs::default())
    }

    /// Reads as the model's campaign was read, unless the options say otherwise.
    pub fn read_for(&self, model: &Model) -> Result<Campaign, Failure> {
        self.reading.read_for(&self.files, model)
    }

    /// The same on a command line, to be typed again.
    pub fn command_line(&self) -> String {
        let files = self.files.iter().map(|file| shell::path(file));
        files.chain(self.reading.words()).collect::<Vec<_>>().join(" ")
    }
}

impl Reading {
    pub fn read(&self, files: &[PathBuf], before: &ReadAs) -> Result<Campaign, Failure> {
        Ok(Campaign::read_like(files, &self.options()?, before)?)
    }

    /// Reads as the model's campaign was read, and says so.
    pub fn read_for(&self, files: &[PathBuf], model: &Model) -> Result<Campaign, Failure> {
        let before = &model.provenance.read_as;
        let campaign = self.read(files, before)?;
        check_units(model, &campaign)?;
        let given: Vec<String> = self.words().collect();
        let in_force: Vec<String> = spelt(&campaign.read_as).filter(|words| !given.contains(words)).collect();
        let kept: Vec<String> = spelt(before).filter(|words| in_force.contains(words)).collect();
        if !kept.is_empty() {
            remark!("Read as the model's campaign was: {}", kept.join(" "));
        }
        Ok(campaign)
    }

    fn options(&self) -> Result<ReadOptions, Failure> {
        let mut options = ReadOptions {
            signal: measured(self.signal.as_ref(), self.signal_unit.as_ref()),
            reference: measured(self.reference.as_ref(), self.reference_unit.as_ref()),
            channels: self.channels.as_deref().map(Columns::names),
            ignore: Columns::names(&self.ignore),
            constant_reference: self.constant_reference,
            ..ReadOptions::default()
        };
        for pair in &self.map {
            let (name, column) = pair.split_once('=').ok_or_else(|| {
                Failure::new(format_args!("--map {pair}: expected NAME=COLUMN"))
                    .help("write the name that tempco uses first, as in --map delta_f_hz=FreqDiff")
            })?;
            options.map.insert(name.trim().to_owned(), column.trim().to_owned());
        }
        Ok(options)
    }

    /// The options that were given, as they are typed.
    fn words(&self) -> impl Iterator<Item = String> {
        let maps = self.map.iter().map(|pair| shell::option("--map", pair));
        // A mapping that can't be read is typed again as it was.
        let unmapped = Self { map: Vec::new(), ..self.clone() };
        maps.chain(words(&unmapped.options().unwrap_or_default()))
    }
}

/// A model of one quantity says nothing about another.
fn check_units(model: &Model, campaign: &Campaign) -> Result<(), Failure> {
    let (units, quantity) = (&model.units, &campaign.quantity);
    if (&units.signal, &units.reference) == (&quantity.signal_unit, &quantity.reference_unit) {
        return Ok(());
    }
    let text = |signal: &str, reference: &str| format!("a signal in {signal} and a reference in {reference}");
    let (model, found) = (text(&units.signal, &units.reference), text(&quantity.signal_unit, &quantity.reference_unit));
    Err(Failure::new(format_args!("the model is of {model}, the campaign of {found}")).help(format_args!(
        "name the columns and convert where needed: --signal \"COLUMN*1\" --signal-unit {} --reference \"COLUMN*1\" --reference-unit {}",
        units.signal, units.reference
    )))
}

fn spelt(read_as: &ReadAs) -> impl Iterator<Item = String> {
    [&read_as.options, &read_as.manifest].into_iter().flat_map(words)
}

/// Options as they are typed.
fn words(options: &ReadOptions) -> impl Iterator<Item = String> + use<> {
    let list = |names: &[String]| (!names.is_empty()).then(|| columns::typed(names));
    let (signal, reference) = (options.signal.as_ref(), options.reference.as_ref());
    let one = [
        ("--signal", signal.map(|signal| signal.column.clone())),
        ("--signal-unit", signal.map(|signal| signal.unit.clone())),
        ("--reference", reference.map(|reference| reference.column.clone())),
        ("--reference-unit", reference.map(|reference| reference.unit.clone())),
        ("--constant-reference", options.constant_reference.map(|g| g.to_string())),
        ("--channels", options.channels.as_deref().and_then(list)),
        ("--ignore", list(&options.ignore)),
    ];
    let maps: Vec<_> = options.map.iter().map(|(name, text)| ("--map", Some(format!("{name}={text}")))).collect();
    maps.into_iter().chain(one).filter_map(|(name, value)| Some(shell::option(name, &value?)))
}

fn measured(column: Option<&String>, unit: Option<&String>) -> Option<Measured> {
    Some(Measured { column: column?.clone(), unit: unit?.clone() })
}

/// Seeds that fit into every file that names one.
pub fn seeds() -> RangedU64ValueParser {
    RangedU64ValueParser::new().range(..=TrainSettings::LARGEST_SEED)
}

/// Numbers of restarts that somebody could wait for.
pub fn restarts() -> RangedU64ValueParser<usize> {
    RangedU64ValueParser::new().range(1..=TrainSettings::MOST_RESTARTS as u64)
}

/// Which runs to keep from training.
#[derive(Args, Clone, Default)]
pub struct HeldOut {
    /// Runs to keep from training, or `none`; without it the last run of each kind that has two or more. May be repeated; a
    /// name that has a comma stands alone
    #[arg(long, value_name = "RUN,…")]
    pub hold_out: Option<Vec<String>>,
}

impl HeldOut {
    /// Where a run of exactly this name exists it is meant, else the list that the text is.
    pub fn choice(&self, campaign: &Campaign) -> HoldOut {
        match &self.hold_out {
            None => HoldOut::LastOfEachKind,
            Some(texts) if texts.as_slice() == ["none"] => HoldOut::None,
            Some(texts) => HoldOut::Named(texts.iter().flat_map(|text| named(text, campaign)).collect()),
        }
    }

    /// The option as it is typed, of texts that are names.
    pub fn words(&self, campaign: &Campaign) -> Vec<String> {
        let Some(names) = &self.hold_out else { return Vec::new() };
        if campaign.runs.iter().any(|run| run.name.contains(',')) {
            return names.iter().map(|name| shell::option("--hold-out", name)).collect();
        }
        vec![shell::option("--hold-out", &names.join(","))]
    }
}

fn named(text: &str, campaign: &Campaign) -> Vec<String> {
    if campaign.runs.iter().any(|run| run.name == text) {
        return vec![text.to_owned()];
    }
    text.split(',').map(str::to_owned).collect()
}
