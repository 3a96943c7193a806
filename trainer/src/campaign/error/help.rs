//! The way out of every refusal, in a sentence.

use super::{CampaignError, Column, Facts, Missing};

/// What no table can do without: to ignore it would only change the error.
const ESSENTIAL: [&str; 7] = ["time_s", "delta_f_hz", "f1_hz", "f2_hz", "temperature_c", "reference_g", "run"];

impl CampaignError {
    /// What to do about it.
    #[must_use]
    pub fn help(&self) -> String {
        match self {
            Self::MissingColumn { missing, .. } => missing_columns(missing),
            Self::MissingChannel { channel, nearest: Some(nearest), .. } => {
                format!("If {nearest:?} is the same quantity: --map \"{channel}={nearest}\".")
            }
            Self::MissingChannel { channel, nearest: None, .. } => {
                format!("Give a campaign that records {channel}, or a model without an effect that needs it.")
            }
            Self::TooManyChannels { fitting, .. } => {
                let names: Vec<String> = fitting.iter().map(|name| format!("{name:?}")).collect();
                format!("Select with `channels` in campaign.toml, for example channels = [{}].", names.join(", "))
            }
            Self::ChannelsDiffer { channel, .. } => {
                let ignore = ignore(channel);
                format!(
                    "Give every file a column of numbers {channel}, map one to that name, or leave it out: {ignore}."
                )
            }
            Self::UnknownRun { nearest: Some(nearest), .. } => format!("Did you mean --hold-out {nearest}?"),
            Self::DuplicateColumn(facts) => {
                format!("Rename one of them, or leave both out: {}.", ignore(column(facts).0))
            }
            Self::EmptyCell(facts) => or_ignore("Fill the cell or remove the row", facts),
            Self::NotANumber(facts) if facts.found.contains(',') => {
                "Write numbers with a decimal point instead of a comma, and without separators of thousands.".to_owned()
            }
            Self::NotANumber(facts) if column(facts).1 == "time_s" => {
                "Write time in seconds; rows at a fixed rate need no clock: --map \"time_s=row*0.1\".".to_owned()
            }
            Self::NotANumber(facts) => or_ignore("Correct the cell or remove the row", facts),
            Self::NotFinite(facts) => or_ignore("Remove the row (a gap in time is fine)", facts),
            Self::OutOfRange(facts) => out_of_range(facts),
            Self::ConstantColumn(facts) => constant_column(facts).to_owned(),
            Self::NotUtf8(facts) => {
                let file = facts.place.file.display();
                format!("Convert it: iconv -f WINDOWS-1252 -t UTF-8 \"{file}\" > converted.csv (or -f UTF-16).")
            }
            Self::Parquet(facts) => {
                let file = facts.place.file.display();
                format!(
                    "Convert it: duckdb -c \"COPY '{file}' TO 'converted.csv'\", or pandas' read_parquet and to_csv."
                )
            }
            other => plain(other).to_owned(),
        }
    }
}

/// Advice that is the same every time.
fn plain(error: &CampaignError) -> &'static str {
    use CampaignError as E;
    match error {
        E::NothingGiven(_) => "Name the files or the folder of the campaign.",
        E::FileNotFound(_) => "Check the path; a folder stands for all .csv files in it.",
        E::Unreadable(_) => "Check that the file may be read, and that no other program holds it.",
        E::NotAFile(_) => {
            "Name a file; what comes out of a pipe or device is written to one first: cat PIPE > converted.csv."
        }
        E::TooLarge(_) => "Divide it into several files, a run each, and name their folder.",
        E::TooLong(_) => {
            "Check the separator, the line breaks, and that every quote is closed; a table has a line of names and one line a row."
        }
        E::UnknownFileType(_) => "Export it as text: commas, semicolons or tabs, column names in the first line.",
        E::NoTables(_) => "Put the .csv files directly into this folder, or name the files one by one.",
        E::Manifest(_) => {
            "Correct the line; a mapping stands below [columns] and looks like delta_f_hz = \"FreqDiff\"."
        }
        E::Empty(_) => "Remove the file, or export it again.",
        E::NoHeader(_) => {
            "Name the columns in the first line, without #; if the file belongs to something else, name the others one by one."
        }
        E::HeaderOnly(_) => "Remove the file, or export it again with its rows.",
        E::HalfAPair(_) => "Map the other frequency as well, or leave this one out with `ignore` in campaign.toml.",
        E::BadMapping(_) => {
            "Write it like time_s=COLUMN*1e-9, temperature_c=COLUMN/1.8-17.7778, time_s=row*0.1 or temperature_c=21.5."
        }
        E::ReferenceTwice(_) => {
            "Remove the constant reference, or the column: ignore = [\"reference_g\"] in campaign.toml."
        }
        E::WrongCellCount(_) => {
            "Complete or remove the row; text that contains the separator needs quotes, and numbers need a decimal point."
        }
        E::Disagreement(_) => {
            "Check which columns are f1, f2, their difference and sum; `ignore` in campaign.toml leaves the wrong one out."
        }
        E::TimeNotIncreasing(_) => {
            "Sort the rows by time and leave out what is there twice; if a new recording begins here, name it in a column `run` or give it its own file."
        }
        E::RunTwice(_) => "Rename one of the two, or give the file only once.",
        E::KindContradiction(_) => "Give all rows of a run the same kind, or make two runs of it.",
        E::QuantitiesDiffer(_) => "Name the same units for all files; a conversion is column = \"load_lb*0.45359237\".",
        E::OneRun(_) => "Add a second run; or divide this one with a column `run` where the recording was interrupted.",
        E::TooFewRows(_) => "Record longer, or add runs.",
        E::ConstantReference(_) => {
            "Apply two accelerations or more (turn the sensor over), or state the slope that you know with --scale-factor."
        }
        E::TooCoarse(_) => "Read it in a smaller unit: --signal \"COLUMN*1e6\" --signal-unit uV for a column in V.",
        E::NothingLeft(_) => "Name fewer runs after --hold-out.",
        E::UnknownRun { .. } => "Name runs of this campaign after --hold-out, separated by commas.",
        // Everything else has advice of its own above.
        _ => "Correct the data at that place.",
    }
}

fn missing_columns(missing: &[Missing]) -> String {
    let map = match missing {
        [Missing { column, nearest: Some(nearest) }] if nearest == column => {
            format!("The table has {column} under that name: leave its mapping out")
        }
        [Missing { column, nearest: Some(nearest) }] => {
            format!("If {nearest:?} holds it, say so: --map \"{column}={nearest}\"")
        }
        [Missing { column, nearest: None }] => format!("Name what holds it: --map {column}=COLUMN"),
        several => {
            let maps = several.iter().map(|Missing { column, nearest }| {
                format!(" --map \"{column}={}\"", nearest.as_deref().unwrap_or("COLUMN"))
            });
            format!("Name what holds them, perhaps{}", maps.collect::<String>())
        }
    };
    let unlike = missing.iter().filter(|missing| missing.nearest.is_none());
    let otherwise = unlike.map(|missing| otherwise(&missing.column)).collect::<String>();
    format!("{map}{otherwise}.")
}

/// What can stand for a column that nobody recorded.
fn otherwise(column: &str) -> &'static str {
    match column {
        "time_s" => "; rows at a fixed rate need no clock: --map \"time_s=row*0.1\"",
        "delta_f_hz" => "; another quantity: --signal COLUMN --signal-unit UNIT",
        "reference_g" => "; a sensor that lies still may state constant_reference = 0.0 in campaign.toml",
        _ => "",
    }
}

fn out_of_range(facts: &Facts) -> String {
    match column(facts) {
        (name, meaning @ ("time_s" | "power_on_s")) if facts.found.starts_with('-') => {
            format!("Begin at another zero: --map \"{meaning}={name}+10\".")
        }
        (name, meaning @ ("time_s" | "power_on_s")) => {
            format!("Write it in seconds: --map \"{meaning}={name}*1e-6\" for microseconds, *1e-9 for nanoseconds.")
        }
        _ if facts.found.starts_with('-') => "Check the sign, and that the mapping names the right column.".to_owned(),
        (name, meaning) => format!("Check the unit; another one is a factor: --map \"{meaning}={name}*1e-3\"."),
    }
}

fn constant_column(facts: &Facts) -> &'static str {
    match column(facts) {
        (_, "temperature_c") => "Check that it is the sensor's thermometer; compensation needs runs over temperature.",
        _ => "Check that it is the signal's column, and that the sensor was running.",
    }
}

/// The advice, and that a column which nobody needs can be left out.
fn or_ignore(advice: &str, facts: &Facts) -> String {
    match column(facts) {
        (_, meaning) if ESSENTIAL.contains(&meaning) => format!("{advice}."),
        (name, _) => format!("{advice}; if nobody needs the column: {}.", ignore(name)),
    }
}

fn ignore(name: &str) -> String {
    format!("ignore = [{name:?}] in campaign.toml")
}

/// Name and meaning of the column.
fn column(facts: &Facts) -> (&str, &str) {
    facts.place.column.as_ref().map_or(("", ""), |Column { name, meaning, .. }| (name, meaning))
}

#[cfg(test)]
mod tests {
    use super::super::Place;
    use super::*;

    #[test]
    fn what_cant_be_read_has_advice_of_its_own() {
        let facts = || Facts::boxed(Place::campaign(), "this", "that");
        for (error, advice) in [
            (CampaignError::Unreadable(facts()), "may be read"),
            (CampaignError::NotAFile(facts()), "cat PIPE"),
            (CampaignError::TooLarge(facts()), "Divide it"),
            (CampaignError::TooLong(facts()), "separator"),
        ] {
            assert!(error.help().contains(advice), "{error:?}: {}", error.help());
        }
    }
}
