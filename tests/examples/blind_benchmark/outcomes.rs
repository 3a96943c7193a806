//! The rates that the benchmark is about, each with what it should be.

use crate::judge::{Judgement, Outcome};
use crate::record::Record;
use serde::Serialize;

/// How often something was so.
#[derive(Clone, Debug, Serialize)]
pub struct Rate {
    pub what: &'static str,
    pub yes: usize,
    pub of: usize,
    /// At least this, percent.
    pub target: Option<f64>,
}

impl Rate {
    pub fn percent(&self) -> f64 {
        100.0 * self.yes as f64 / self.of.max(1) as f64
    }

    pub fn is_met(&self) -> Option<bool> {
        self.target.filter(|_| self.of > 0).map(|target| self.percent() >= target)
    }
}

/// All rates of some campaigns. One whose diagnosis failed counts as not so.
pub fn rates(records: &[&Record]) -> Vec<Rate> {
    let visible = |class: &str| of_class(records, class).into_iter().filter(|r| r.is_visible()).collect::<Vec<_>>();
    let (none, single, pair, outside) =
        (of_class(records, "none"), visible("single"), visible("pair"), visible("outside"));
    let is = |outcome: Outcome| move |judgement: &Judgement| judgement.outcome == outcome;
    let mut rates = vec![
        rate("single, visible: named first", Some(97.0), &single, |j| j.named),
        rate("single, visible: in an honest set of at most two", Some(99.0), &single, |j| j.in_set),
        rate("single, visible: in a larger set", None, &single, is(Outcome::InLargerSet)),
        rate("single, visible: something else named", None, &single, is(Outcome::Wrong)),
        rate("single, visible: nothing said to be missing", None, &single, is(Outcome::Nothing)),
        rate("single, visible: unexplained", None, &single, is(Outcome::Unexplained)),
        rate("single, visible: no finding beyond the truth", None, &single, |j| j.additions.is_empty()),
        rate("pair, both visible: both found", Some(90.0), &pair, |j| j.all_found),
        rate("pair, both visible: no finding beyond the truth", None, &pair, |j| j.additions.is_empty()),
        rate("none: nothing said to be missing", Some(95.0), &none, is(Outcome::Nothing)),
        rate("outside, visible: unexplained and nothing misnamed", Some(95.0), &outside, is(Outcome::Unexplained)),
        rate("outside, visible: a known effect blamed", None, &outside, is(Outcome::Wrong)),
        faint(records),
        after_add(records),
    ];
    rates.retain(|rate| rate.of > 0);
    rates
}

pub fn of_class<'a>(records: &[&'a Record], class: &str) -> Vec<&'a Record> {
    records.iter().copied().filter(|record| record.class == class && record.skipped.is_none()).collect()
}

fn rate(what: &'static str, target: Option<f64>, records: &[&Record], so: impl Fn(&Judgement) -> bool) -> Rate {
    let yes = records.iter().filter(|record| record.judgement.as_ref().is_some_and(&so)).count();
    Rate { what, yes, of: records.len(), target }
}

/// What cannot be seen must not be named wrongly either.
fn faint(records: &[&Record]) -> Rate {
    let faint: Vec<&Record> = of_class(records, "single").into_iter().filter(|record| !record.is_visible()).collect();
    rate("single, not visible: something else named", None, &faint, |j| j.outcome == Outcome::Wrong)
}

/// Held-out residual with the findings against that with the truth.
const AS_GOOD: f64 = 1.05;

fn after_add(records: &[&Record]) -> Rate {
    let ratios: Vec<f64> = records
        .iter()
        .filter(|record| record.is_visible())
        .filter_map(|record| record.after_add.map(|after_add| after_add.ratio()))
        .collect();
    let yes = ratios.iter().filter(|ratio| **ratio <= AS_GOOD).count();
    let what = "visible: findings added, held-out residual ≤ 1.05 times the truth's";
    Rate { what, yes, of: ratios.len(), target: Some(95.0) }
}
