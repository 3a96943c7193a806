//! The same results for other programs.

use super::campaigns::Judged;
use super::extent::Extent;
use serde_json::{Value, json};
use std::path::PathBuf;
use trainer::reproduction::claim::{CLAIMS, Claim, Outcome, Verdict};
use trainer::reproduction::judgement::Judgement;
use trainer::reproduction::paper::ROWS;
use trainer::reproduction::shortfall::Shortfall;
use trainer::reproduction::trial::{Share, Trial};

/// Everything.
pub fn json(extent: &Extent, trials: &[Trial], judged: &[Judged], files: &[PathBuf]) -> Value {
    let claims: Vec<Value> = CLAIMS.iter().map(|claim| self::claim(claim, trials)).collect();
    json!({
        "seed": extent.seed,
        "seeds": extent.seeds,
        "restarts": extent.restarts,
        "passes": extent.passes,
        "rates": trials.iter().map(rate).collect::<Vec<_>>(),
        "claims": if trials.is_empty() { Vec::new() } else { claims },
        "campaigns": judged.iter().map(campaign).collect::<Vec<_>>(),
        "files": files,
    })
}

fn rate(trial: &Trial) -> Value {
    json!({
        "function": trial.field.function.name,
        "half_width": trial.field.half_width,
        "search": trial.contender,
        "found_percent": trial.found().percent(),
        "found_95_percent_interval": trial.found().interval_percent(),
        "gathered_percent": trial.evolution.as_ref().map(|_| trial.gathered().percent()),
        "evaluations": trial.evaluations,
    })
}

fn claim(claim: &Claim, trials: &[Trial]) -> Value {
    let outcome = |outcome: &Outcome| {
        json!({
            "function": outcome.field.function.name,
            "half_width": outcome.field.half_width,
            "verdict": match outcome.verdict {
                Verdict::Holds => "holds",
                Verdict::Fails => "fails",
                Verdict::Open => "open",
            },
            "percent": outcome.share.percent(),
            "against_percent": outcome.against.map(Share::percent),
        })
    };
    let outcomes: Vec<Value> = claim.outcomes(trials).iter().map(outcome).collect();
    json!({ "source": claim.source, "statement": claim.statement, "outcomes": outcomes })
}

fn campaign(judged: &Judged) -> Value {
    json!({
        "campaign": judged.scenario.name,
        "trained_on": judged.trained_on.as_ref().unwrap_or(&judged.scenario.name),
        "rows": (0..ROWS.len()).map(|index| row(index, &judged.columns)).collect::<Vec<_>>(),
        "methods": judged.columns.iter().map(method).collect::<Vec<_>>(),
        "above_the_paper": judged.shortfalls.iter().map(shortfall).collect::<Vec<_>>(),
    })
}

fn row(index: usize, columns: &[Judgement]) -> Value {
    let row = ROWS[index];
    let measured = columns.iter().map(|column| (column.name.clone(), json!(column.cells[index])));
    json!({
        "table": row.table,
        "data_set": row.data_set,
        "run": row.run(),
        "figure": row.figure.name(),
        "paper": { "raw": row.raw, "FA-BP": row.fa_bp, "IFA-BP": row.ifa_bp },
        "measured": measured.collect::<serde_json::Map<_, _>>(),
    })
}

fn method(column: &Judgement) -> Value {
    json!({
        "method": column.name,
        "residual_ug": column.residual_ug,
        "at_half_g_ug": column.sweep.at_half_g_ug(),
        "worst_slope_ppm": column.sweep.worst_slope_ppm(),
        "restarts_ug": column.restarts_ug,
    })
}

fn shortfall(shortfall: &Shortfall) -> Value {
    let without = shortfall.without.as_ref().map(|(name, left)| json!({ "what": name, "leaves": left }));
    json!({
        "table": shortfall.row.table,
        "data_set": shortfall.row.data_set,
        "figure": shortfall.row.figure.name(),
        "found": shortfall.found,
        "paper": shortfall.row.ifa_bp,
        "perfect_static_map": shortfall.perfect,
        "perfect_static_map_quartiles": [shortfall.campaigns.lower, shortfall.campaigns.median, shortfall.campaigns.upper],
        "even_the_perfect_map_is_above": shortfall.even_the_perfect_map_is_above(),
        "without": without,
    })
}
