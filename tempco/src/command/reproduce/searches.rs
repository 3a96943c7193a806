//! Figures 3 and 4 as success rates: every search on every field, many seeds each.

use crate::failure::Failure;
use crate::progress::bar;
use crate::table::Table;
use trainer::reproduction::contender::{Contender, FIELDS};
use trainer::reproduction::trial::{Share, Trial, trial};

/// Searches everything, contender by contender.
pub fn search(seeds: u64, seed: u64) -> Result<Vec<Trial>, Failure> {
    let bar = bar((Contender::ALL.len() * FIELDS.len()) as u64, "searching");
    let mut trials = Vec::new();
    for contender in Contender::ALL {
        bar.set_message(contender.name());
        for field in FIELDS {
            trials.push(trial(contender, field, seeds, seed).map_err(Failure::new)?);
            bar.inc(1);
        }
    }
    bar.finish_and_clear();
    Ok(trials)
}

/// The rates as tables.
pub fn text(trials: &[Trial], seed: u64) -> String {
    let seeds = trials.first().map_or(0, |trial| trial.ends.len());
    let mut text = format!(
        "Figures 3 and 4: 10 fireflies, 50 generations, 2 dimensions, α0 = 0.25, β0 = γ = 1; {seeds} seeds of stream {seed}.\n\
         The paper states no domain. 95 % intervals are at most ±{:.1} % wide.\n",
        widest(trials)
    );
    for function in ["Schaffer", "Rastrigin"] {
        text +=
            &format!("\n{function}: seeds that end in the basin of the global minimum, % (with the whole swarm, %)\n");
        text += &table(function, trials).to_string();
    }
    text
}

/// Half the widest interval, %.
fn widest(trials: &[Trial]) -> f64 {
    let half = |trial: &Trial| {
        let [low, high] = trial.found().interval_percent();
        (high - low) / 2.0
    };
    trials.iter().map(half).fold(0.0, f64::max)
}

fn table(function: &str, trials: &[Trial]) -> Table {
    let domains = FIELDS.iter().filter(|field| field.function.name == function);
    let mut header = vec!["search".to_owned()];
    header.extend(domains.map(|field| format!("|x| ≤ {}", field.half_width)));
    header.push("evaluations".to_owned());
    let mut rows = vec![header];
    for contender in Contender::ALL {
        let here = |trial: &&Trial| trial.contender == contender && trial.field.function.name == function;
        let found: Vec<&Trial> = trials.iter().filter(here).collect();
        let mut row = vec![contender.name().to_owned()];
        row.extend(found.iter().map(|trial| cell(trial)));
        let evaluations: f64 = found.iter().map(|trial| trial.evaluations).sum();
        row.push(format!("{:.0}", evaluations / found.len() as f64));
        rows.push(row);
    }
    Table::of(rows)
}

fn cell(trial: &Trial) -> String {
    let gathered = match trial.evolution {
        Some(_) => format!("({})", percent(trial.gathered())),
        None => "(–)".to_owned(),
    };
    format!("{} {gathered:>7}", percent(trial.found()))
}

fn percent(share: Share) -> String {
    format!("{:.1}", share.percent())
}
