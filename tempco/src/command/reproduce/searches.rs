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

#[cfg(test)]
mod tests {
    use super::*;
    use trainer::fit::firefly::Generation;

    /// So many of a hundred seeds find the minimum, and one gathers there.
    fn found(hits: usize) -> Trial {
        let field = FIELDS[0];
        let (minimum, away) = (field.function.minimum, field.function.minimum + 1e3);
        let end = |seed: usize| Generation {
            best: if seed < hits { minimum } else { away },
            mean: if seed == 0 { minimum } else { away },
        };
        let ends = (0..100).map(end).collect();
        Trial { contender: Contender::FaPrinted, field, evaluations: 510.4, ends, evolution: None }
    }

    #[test]
    fn the_widest_interval_is_that_of_the_share_nearest_to_a_half() {
        // Wilson's interval of 50 of 100 reaches from 40.4 to 59.6 %.
        let widest = widest(&[found(0), found(50), found(90)]);
        assert!((widest - 9.6).abs() < 0.05, "{widest}");
    }

    #[test]
    fn a_cell_says_what_share_found_it_and_what_share_gathered_there() {
        let alone = found(25);
        assert_eq!(cell(&alone), "25.0     (–)");
        let history = vec![vec![Generation { best: 1.0, mean: 1.0 }; 2]];
        let swarm = Trial { evolution: trainer::reproduction::evolution::Evolution::of(&history), ..alone.clone() };
        assert_eq!(cell(&swarm), "25.0   (1.0)");
        let text = text(&[alone], 7);
        assert!(text.contains("; 100 seeds of stream 7.") && text.contains("FA as printed"), "{text}");
        assert!(text.lines().any(|line| line.contains("FA as printed") && line.trim_end().ends_with("510")), "{text}");
    }
}
