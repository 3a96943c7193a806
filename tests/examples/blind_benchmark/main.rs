//! The blind benchmark: hides effects in simulated campaigns, lets `diagnose` name them, and counts how often it is right.
//!
//! ```text
//! cargo run --release -p tests --example blind_benchmark -- --count 40 --verbose
//! cargo run --release -p tests --example blind_benchmark -- --only single:7 --verbose --save /tmp/one
//! ```
//!
//! The diagnosis sees what a laboratory would hand over: the table and a model trained on it. `--help` lists the options.

mod after_add;
mod case;
mod judge;
mod options;
mod outcomes;
mod record;
mod report;
mod save;
mod visible;

use case::Case;
use options::{Class, Options, Protocol};
use record::Record;
use std::io::Write;
use std::time::Instant;
use trainer::campaign::HoldOut;
use trainer::diagnose::{Diagnosis, diagnose};
use trainer::model::Model;
use trainer::progress::Quiet;
use trainer::train::{TrainSettings, train};

fn main() {
    let options = match Options::parse(std::env::args().skip(1)) {
        Ok(options) => options,
        Err(message) => {
            eprintln!("{message}\n\n{}", options::HELP);
            std::process::exit(2);
        }
    };
    if options.help {
        println!("{}", options::HELP);
        return;
    }
    let mut records = Vec::new();
    for &protocol in &options.protocols {
        println!("\n# Protocol `{}`, seed {}", protocol.name(), options.seed);
        let from = records.len();
        for &class in &options.classes {
            for index in options.indices() {
                records.push(one(&options, protocol, class, index));
                save::results(&options, &records);
            }
        }
        report::print(&records[from..]);
    }
}

/// Measures, trains and diagnoses one campaign.
fn one(options: &Options, protocol: Protocol, class: Class, index: usize) -> Record {
    let record = match Case::measure(options, protocol, class, index) {
        Ok(case) => {
            save::campaign(options, &case);
            diagnosed(options, &case)
        }
        Err(reason) => Record::skipped(protocol, class, index, reason),
    };
    if options.verbose {
        println!("{record}");
        // Whoever watches a run of an hour through a pipe wants to see each line when it is there.
        let _ = std::io::stdout().flush();
    }
    record
}

fn diagnosed(options: &Options, case: &Case) -> Record {
    let model = match model(options, case) {
        Ok(model) => model,
        Err(error) => return Record::failed(case, 0.0, format!("training: {error}")),
    };
    let (seconds, result) = timed(|| diagnose(&model, &case.campaign, &Quiet));
    match result {
        Err(error) => Record::failed(case, seconds, error.to_string()),
        Ok(diagnosis) => judged(options, case, seconds, diagnosis),
    }
}

fn judged(options: &Options, case: &Case, seconds: f64, diagnosis: Diagnosis) -> Record {
    let hidden: Vec<&str> = case.hidden.iter().map(|hidden| hidden.name.as_str()).collect();
    let judgement = judge::judge(&diagnosis, &hidden, case.rig.then_some("turn-on"));
    let after_add = options.after_add.then(|| after_add::compared(options, case, &diagnosis)).flatten();
    Record::judged(case, seconds, diagnosis, judgement, after_add)
}

/// The default model of the default split; few restarts, because the diagnosis starts from any of them.
fn model(options: &Options, case: &Case) -> Result<Model, String> {
    let split = case.campaign.split(&HoldOut::LastOfEachKind).map_err(|error| error.to_string())?;
    let settings = TrainSettings { restarts: options.restarts, ..TrainSettings::new(case.seed) };
    Ok(train(&case.campaign, &split, &settings, &Quiet).map_err(|error| error.to_string())?.model)
}

#[expect(clippy::disallowed_methods, reason = "a benchmark reads the clock")]
fn timed<T>(work: impl FnOnce() -> T) -> (f64, T) {
    let start = Instant::now();
    let result = work();
    (start.elapsed().as_secs_f64(), result)
}
