//! The command line of the benchmark.

use std::ops::Range;
use std::path::PathBuf;

pub const HELP: &str = "\
cargo run --release -p tests --example blind_benchmark -- [options]
  --count N         campaigns of each class [20]
  --seed S          seed of everything [1]
  --class C         none | single | pair | outside | all [all]; may be repeated
  --protocol P      rich | realistic | seed | all [rich]; may be repeated
  --only C:I        one campaign alone: class and index as --verbose prints them
  --effect NAME     singles and outside: hides nothing but this effect
  --denser F        records so many times as often: `rich` with 1.3 has more than 20,000 samples [1]
  --restarts N      restarts of a training [6]
  --after-add       trains with the found and with the true effects and compares their held-out residuals
  --save DIR        writes every campaign as CSV, and truth.json beside them
  --json FILE       writes every result, campaign by campaign
  --verbose         one line a campaign as it finishes
  --help            prints this";

/// What a campaign hides.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Class {
    /// Nothing.
    None,
    /// One effect of the catalogue.
    Single,
    /// Two of them.
    Pair,
    /// One that no catalogue knows.
    Outside,
}

impl Class {
    const ALL: [Self; 4] = [Self::None, Self::Single, Self::Pair, Self::Outside];

    pub const fn name(self) -> &'static str {
        match self {
            Self::None => "none",
            Self::Single => "single",
            Self::Pair => "pair",
            Self::Outside => "outside",
        }
    }
}

/// What the laboratory does.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Protocol {
    /// Everything that tells effects apart.
    Rich,
    /// A good static calibration.
    Realistic,
    /// The paper's campaign.
    Seed,
}

impl Protocol {
    const ALL: [Self; 3] = [Self::Rich, Self::Realistic, Self::Seed];

    pub const fn name(self) -> &'static str {
        match self {
            Self::Rich => "rich",
            Self::Realistic => "realistic",
            Self::Seed => "seed",
        }
    }
}

/// What to do.
#[derive(Clone, Debug)]
pub struct Options {
    pub count: usize,
    pub seed: u64,
    pub classes: Vec<Class>,
    pub protocols: Vec<Protocol>,
    pub only: Option<usize>,
    pub effect: Option<String>,
    pub denser: f64,
    pub restarts: usize,
    pub after_add: bool,
    pub save: Option<PathBuf>,
    pub json: Option<PathBuf>,
    pub verbose: bool,
    pub help: bool,
}

impl Options {
    pub fn parse(mut arguments: impl Iterator<Item = String>) -> Result<Self, String> {
        let mut options = Self {
            count: 20,
            seed: 1,
            classes: Vec::new(),
            protocols: Vec::new(),
            only: None,
            effect: None,
            denser: 1.0,
            restarts: 6,
            after_add: false,
            save: None,
            json: None,
            verbose: false,
            help: false,
        };
        while let Some(argument) = arguments.next() {
            match argument.as_str() {
                "--verbose" => options.verbose = true,
                "--help" | "-h" => options.help = true,
                "--after-add" => options.after_add = true,
                name => {
                    let value =
                        arguments.next().ok_or_else(|| format!("{name}: not an option, or its value is missing"))?;
                    options.set(name, &value)?;
                }
            }
        }
        if options.classes.is_empty() {
            options.classes = Class::ALL.to_vec();
        }
        if options.protocols.is_empty() {
            options.protocols = vec![Protocol::Rich];
        }
        Ok(options)
    }

    fn set(&mut self, name: &str, value: &str) -> Result<(), String> {
        match name {
            "--count" => self.count = number(name, value)?,
            "--seed" => self.seed = number(name, value)?,
            "--denser" => self.denser = number(name, value)?,
            "--restarts" => self.restarts = number(name, value)?,
            "--class" => self.classes.extend(chosen(value, &Class::ALL, Class::name)?),
            "--protocol" => self.protocols.extend(chosen(value, &Protocol::ALL, Protocol::name)?),
            "--only" => {
                let (class, index) = value.split_once(':').ok_or("--only: expected CLASS:INDEX, as in single:7")?;
                self.classes = chosen(class, &Class::ALL, Class::name)?;
                self.only = Some(number(name, index)?);
            }
            "--effect" => self.effect = Some(value.to_owned()),
            "--save" => self.save = Some(value.into()),
            "--json" => self.json = Some(value.into()),
            _ => return Err(format!("{name}: not an option")),
        }
        Ok(())
    }

    /// The campaigns of a class.
    pub fn indices(&self) -> Range<usize> {
        self.only.map_or(0..self.count, |index| index..index + 1)
    }
}

fn number<T: std::str::FromStr>(name: &str, value: &str) -> Result<T, String> {
    value.parse().map_err(|_| format!("{name} {value}: expected a number"))
}

fn chosen<T: Copy>(value: &str, all: &[T], name: fn(T) -> &'static str) -> Result<Vec<T>, String> {
    if value == "all" {
        return Ok(all.to_vec());
    }
    let names = || all.iter().map(|&one| name(one)).collect::<Vec<_>>().join(", ");
    let one =
        all.iter().find(|&&one| name(one) == value).ok_or_else(|| format!("{value}: expected {} or all", names()))?;
    Ok(vec![*one])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn help_is_no_mistake() {
        let parsed = |words: &[&str]| Options::parse(words.iter().map(|&word| word.to_owned()));
        assert!(parsed(&["--help"]).is_ok_and(|options| options.help));
        assert!(parsed(&["--count", "3", "-h"]).is_ok_and(|options| options.help));
        assert!(parsed(&["--count", "3"]).is_ok_and(|options| !options.help));
        assert!(parsed(&["--helpless"]).is_err());
    }
}
