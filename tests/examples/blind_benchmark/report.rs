//! The tables that the benchmark prints.

use crate::outcomes::{Rate, of_class, rates};
use crate::record::Record;
use crate::visible;
use std::collections::BTreeMap;

/// Everything about the campaigns of one protocol.
pub fn print(records: &[Record]) {
    let all: Vec<&Record> = records.iter().collect();
    let (rig, clean): (Vec<&Record>, Vec<&Record>) = all.iter().copied().partition(|record| record.rig);
    println!("\n{}\n", visible::DEFINITION);
    for class in ["single", "outside"] {
        confusion(class, &of_class(&all, class));
    }
    additions(&all);
    set_sizes(&all);
    trouble(&all);
    println!("{:78} {:>16} {:>16} {:>16}", "rates", "all", "perfect rig", "real rig");
    let [of_clean, of_rig] = [&clean, &rig].map(|records| rates(records));
    for rate in rates(&all) {
        let same = |rates: &[Rate]| rates.iter().find(|other| other.what == rate.what).map(share).unwrap_or_default();
        let verdict = match (rate.target, rate.is_met()) {
            (Some(target), Some(met)) => format!("  ≥ {target:.0} % {}", if met { "met" } else { "MISSED" }),
            _ => String::new(),
        };
        println!("  {:76} {:>16} {:>16} {:>16}{verdict}", rate.what, share(&rate), same(&of_clean), same(&of_rig));
    }
    println!();
    figures(&all);
}

fn share(rate: &Rate) -> String {
    format!("{:.1} % {}/{}", rate.percent(), rate.yes, rate.of)
}

/// Truth against what was named first.
fn confusion(class: &str, records: &[&Record]) {
    if records.is_empty() {
        return;
    }
    println!("{class:25} {:>5} {:>8} {:>6} {:>7}   named first, where visible", "n", "visible", "named", "set ≤ 2");
    let mut truths: BTreeMap<&str, Vec<&Record>> = BTreeMap::new();
    for record in records {
        truths.entry(record.hidden.first().map_or("", |hidden| &hidden.name)).or_default().push(record);
    }
    for (truth, records) in truths {
        let visible: Vec<&Record> = records.iter().copied().filter(|record| record.is_visible()).collect();
        let count = |so: fn(&crate::judge::Judgement) -> bool| {
            visible.iter().filter(|record| record.judgement.as_ref().is_some_and(so)).count()
        };
        let (named, in_set) = (count(|judgement| judgement.named), count(|judgement| judgement.in_set));
        let first = counted(visible.iter().map(|record| first_word(record)));
        println!("  {truth:23} {:5} {:8} {named:6} {in_set:7}   {first}", records.len(), visible.len());
    }
    println!();
}

fn first_word(record: &Record) -> String {
    match &record.judgement {
        Some(judgement) => {
            judgement.first.clone().unwrap_or_else(|| format!("({:?})", judgement.outcome).to_lowercase())
        }
        None => "(error)".to_owned(),
    }
}

/// What was found without being there.
fn additions(records: &[&Record]) {
    for class in ["none", "single", "pair", "outside"] {
        let of_class = of_class(records, class);
        let judgements = of_class.iter().filter_map(|record| record.judgement.as_ref());
        let false_names = counted(judgements.flat_map(|judgement| judgement.additions.iter().cloned()));
        if !false_names.is_empty() {
            println!("found without being there, {class} ({} campaigns): {false_names}", of_class.len());
        }
    }
}

fn set_sizes(records: &[&Record]) {
    let sets = records.iter().filter_map(|record| record.judgement.as_ref()).map(|judgement| judgement.set);
    println!("names in the first place: {}\n", counted(sets.filter(|set| *set > 0).map(|set| format!("{set} names"))));
}

/// What could not be judged.
fn trouble(records: &[&Record]) {
    for record in records {
        if let Some(reason) = &record.skipped {
            println!("skipped {}:{}: {reason}", record.class, record.index);
        }
    }
    let errors = counted(records.iter().filter_map(|record| record.error.clone()));
    if !errors.is_empty() {
        println!("without a diagnosis: {errors}");
    }
}

/// Times, sizes, and how near the residual comes to the noise.
fn figures(records: &[&Record]) {
    let diagnosed: Vec<&&Record> = records.iter().filter(|record| record.diagnosis.is_some()).collect();
    let [seconds_middle, seconds_most] = middle_and_most(diagnosed.iter().map(|record| record.seconds));
    let [rows_middle, rows_most] = middle_and_most(diagnosed.iter().map(|record| record.rows as f64));
    println!(
        "diagnosis of {} campaigns: {seconds_middle:.1} s (median), {seconds_most:.1} s (longest); \
         rows {rows_middle:.0} (median), {rows_most:.0} (most)",
        diagnosed.len()
    );
    let left = |class: &str| {
        let ratio = |record: &&Record| {
            let diagnosis = record.diagnosis.as_ref()?;
            Some(diagnosis.residual_after_ug / diagnosis.noise_floor_ug)
        };
        middle_and_most(of_class(records, class).iter().filter_map(ratio))
    };
    for class in ["none", "single", "pair", "outside"] {
        let [middle, most] = left(class);
        if most > 0.0 {
            println!(
                "{class}: residual with the findings, times the noise floor: {middle:.3} (median), {most:.3} (worst)"
            );
        }
    }
}

fn middle_and_most(values: impl Iterator<Item = f64>) -> [f64; 2] {
    let mut values: Vec<f64> = values.collect();
    values.sort_by(f64::total_cmp);
    [values.get(values.len() / 2), values.last()].map(|value| value.copied().unwrap_or_default())
}

/// `thermal-lag 10, warm-up 2`, most frequent first.
fn counted(words: impl Iterator<Item = String>) -> String {
    let mut counts: BTreeMap<String, usize> = BTreeMap::new();
    for word in words {
        *counts.entry(word).or_default() += 1;
    }
    let mut counts: Vec<(String, usize)> = counts.into_iter().collect();
    counts.sort_by_key(|(_, count)| std::cmp::Reverse(*count));
    counts.iter().map(|(word, count)| format!("{word} {count}")).collect::<Vec<_>>().join(", ")
}
