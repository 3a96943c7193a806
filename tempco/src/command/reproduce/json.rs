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

#[cfg(test)]
mod tests {
    use super::*;
    use clap::Parser;
    use firmware_sim::scenario::Scenario;
    use trainer::reproduction::evolution::Quartiles;
    use trainer::reproduction::sweep::{Curve, Sweep};

    #[derive(Parser)]
    struct Line {
        #[command(flatten)]
        extent: Extent,
    }

    #[test]
    fn campaigns_are_told_row_by_row_and_method_by_method() {
        let extent = Line::parse_from(["x", "--seeds", "5", "--restarts", "2", "--passes", "20", "--seed", "9"]).extent;
        let points = (-40..=40).map(|step| f64::from(step) / 40.0).map(|a| [a, 2e-3 * a]).collect();
        let mut cells = ROWS.map(|row| Some(row.ifa_bp));
        cells[7] = Some(60.0);
        let column = Judgement {
            name: "raw".to_owned(),
            cells,
            residual_ug: 5.0,
            sweep: Sweep { curves: vec![Curve { temperature_c: 20.0, points }] },
            restarts_ug: vec![4.0, 6.0],
        };
        let shortfall = Shortfall {
            row: ROWS[7],
            found: 60.0,
            perfect: 50.0,
            campaigns: Quartiles { lower: 1.0, median: 2.0, upper: 3.0 },
            without: Some(("the rig".to_owned(), 3.0)),
        };
        let scenario = Scenario::preset("seed-a2").expect("a scenario");
        let judged = Judged {
            scenario,
            columns: vec![column],
            shortfalls: vec![shortfall],
            trained_on: Some("seed".to_owned()),
        };
        let value = json(&extent, &[], &[judged], &["a.csv".into()]);
        for (key, number) in [("seed", 9), ("seeds", 5), ("restarts", 2), ("passes", 20)] {
            assert_eq!(value[key], number, "{key}");
        }
        assert_eq!((&value["rates"], &value["claims"], &value["files"]), (&json!([]), &json!([]), &json!(["a.csv"])));
        let campaign = &value["campaigns"][0];
        assert_eq!((&campaign["campaign"], &campaign["trained_on"]), (&json!("seed-a2"), &json!("seed")));
        assert_eq!(campaign["rows"].as_array().map(Vec::len), Some(ROWS.len()));
        let row = json!({
            "table": 2, "data_set": 1, "run": "full-test-1", "figure": "bias variation, µg",
            "paper": { "raw": 39_152.0, "FA-BP": 89.431, "IFA-BP": 32.967 }, "measured": { "raw": 60.0 },
        });
        assert_eq!(campaign["rows"][7], row);
        let method = &campaign["methods"][0];
        assert_eq!(
            (&method["method"], &method["residual_ug"], &method["restarts_ug"]),
            (&json!("raw"), &json!(5.0), &json!([4.0, 6.0]))
        );
        let near = |key: &str, value: f64| (method[key].as_f64().expect("a number") / value - 1.0).abs() < 1e-9;
        assert!(near("at_half_g_ug", 1e3) && near("worst_slope_ppm", 2e3), "{method}");
        let above = json!({
            "table": 2, "data_set": 1, "figure": "bias variation, µg", "found": 60.0, "paper": 32.967,
            "perfect_static_map": 50.0, "perfect_static_map_quartiles": [1.0, 2.0, 3.0],
            "even_the_perfect_map_is_above": true, "without": { "what": "the rig", "leaves": 3.0 },
        });
        assert_eq!(campaign["above_the_paper"], json!([above]));
    }
}
