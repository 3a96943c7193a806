//! Names of columns in one option: a row of a CSV file, which has quotes for a name with a comma.

use csv::{ReaderBuilder, Terminator, WriterBuilder};
use std::convert::Infallible;
use std::str::FromStr;

/// No argument can hold it, so a name may hold an end of line.
const END: Terminator = Terminator::Any(0);

/// What one option names.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Columns(Vec<String>);

impl Columns {
    /// Every name of an option that was given more than once.
    pub fn names(given: &[Self]) -> Vec<String> {
        given.iter().flat_map(|columns| columns.0.iter().cloned()).collect()
    }
}

impl FromStr for Columns {
    type Err = Infallible;

    /// Whatever it is: a name that no file has is refused by whoever looks for it.
    fn from_str(text: &str) -> Result<Self, Infallible> {
        let mut reader = ReaderBuilder::new().has_headers(false).terminator(END).from_reader(text.as_bytes());
        let row = reader.records().next().and_then(Result::ok).unwrap_or_default();
        let names: Vec<String> = row.iter().map(str::to_owned).collect();
        Ok(Self(if names.is_empty() { vec![String::new()] } else { names }))
    }
}

/// The option's value that names these columns.
pub fn typed(names: &[String]) -> String {
    let mut writer = WriterBuilder::new().terminator(END).from_writer(Vec::new());
    // A vector takes everything.
    let written = writer.write_record(names).ok().and_then(|()| writer.into_inner().ok()).unwrap_or_default();
    String::from_utf8_lossy(written.strip_suffix(b"\0").unwrap_or(&written)).into_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> Vec<String> {
        let Ok(columns) = text.parse::<Columns>();
        Columns::names(&[columns])
    }

    #[test]
    fn names_stand_between_commas_and_one_with_a_comma_in_quotes() {
        for (text, names) in [
            ("supply_v", vec!["supply_v"]),
            ("supply_v,pressure_kpa", vec!["supply_v", "pressure_kpa"]),
            ("\"supply, V\",p", vec!["supply, V", "p"]),
            ("\"a \"\"b\"\", c\"", vec!["a \"b\", c"]),
            ("5\" pipe,a b", vec!["5\" pipe", "a b"]),
            ("a\nb", vec!["a\nb"]),
            ("", vec![""]),
            ("a,", vec!["a", ""]),
        ] {
            assert_eq!(read(text), names, "{text}");
        }
    }

    #[test]
    fn what_is_typed_again_names_the_same_columns() {
        let nasty = ["a", "b,c", "\"d\"", "e\"f", "\"", ",", "", "g\nh", "\r\n", " i ", "#j", "ü'; touch PWNED"];
        let names = nasty.map(str::to_owned);
        assert_eq!(read(&typed(&names)), names);
        for name in names {
            assert_eq!(read(&typed(std::slice::from_ref(&name))), [name]);
        }
        assert_eq!(typed(&["supply_v".to_owned(), "b,c".to_owned()]), "supply_v,\"b,c\"");
    }
}
