//! A model's quality as data: the answer, figures before and after, charts, and where everything came from.
//! Numbers only; whoever shows them decides how.

mod allan_chart;
mod chart;
mod maps;
mod merits;
mod order_chart;
mod origin;
mod raw_line;
mod residual_charts;
mod samples;
mod temperature_charts;
mod thin;
mod verdict;
mod zero_chart;

pub use chart::{Axis, AxisName, Chart, Layer, Scale, Tone};
pub use merits::Merit;
pub use origin::{DataFile, Origin};
pub use residual_charts::residual_charts;
pub use samples::{RunName, Sample, samples};
pub use verdict::Verdict;

use crate::campaign::{Campaign, Run};
use crate::compare::{Comparison, compare, unseen};
use crate::diagnose::Diagnosis;
use crate::ladder::Rung;
use crate::model::Model;
use crate::residuals::{ResidualError, Residuals, arranged, residuals};
use raw_line::RawLine;
use serde::Serialize;

/// Everything that a report shows.
#[derive(Clone, Debug, Serialize)]
pub struct Report {
    /// The answer in a sentence.
    pub verdict: Verdict,
    /// Figures as `compare` gives them.
    pub comparison: Comparison,
    /// Figures of merit before and after.
    pub merits: Vec<Merit>,
    /// The runs, as dots of the charts refer to them.
    pub runs: Vec<RunName>,
    /// The charts, section by section.
    pub sections: Vec<Section>,
    /// What each effect of the model is worth; empty unless somebody computed it.
    pub ladder: Vec<Rung>,
    /// What is missing; `None` unless somebody asked.
    pub diagnosis: Option<Diagnosis>,
    /// Where everything came from.
    pub origin: Origin,
}

/// Charts that answer one question.
#[derive(Clone, Debug, Serialize)]
pub struct Section {
    /// Its name in addresses.
    pub id: &'static str,
    /// Its heading.
    pub title: &'static str,
    /// Its charts.
    pub charts: Vec<Chart>,
}

/// A report on a model from a campaign. Ladder, diagnosis and data files are for the caller to add.
///
/// # Errors
/// [`ResidualError`] says which model or row is at fault.
pub fn report(model: &Model, campaign: &Campaign) -> Result<Report, ResidualError> {
    let comparison = compare(model, campaign)?;
    let origin = origin::origin(model, campaign);
    let campaign = arranged(model, campaign)?;
    let residuals = residuals(model, &campaign.runs)?;
    let line = RawLine::fit(model, &campaign);
    let held_out = |run: &&Run| unseen(model, &campaign, run);
    let counted = campaign.runs.iter().filter(|run| !comparison.held_out || held_out(run));
    let raw_ug = line.rms_g(counted) * 1e6;
    let runs: Vec<RunName> = campaign.runs.iter().map(|run| RunName::of(run, held_out(&run))).collect();
    Ok(Report {
        verdict: verdict::verdict(&comparison, raw_ug),
        merits: merits::merits(&comparison, raw_ug),
        sections: sections(&Drawn {
            model,
            campaign: &campaign,
            comparison: &comparison,
            residuals: &residuals,
            line: &line,
            runs: &runs,
        }),
        comparison,
        runs,
        ladder: Vec::new(),
        diagnosis: None,
        origin,
    })
}

/// What charts are drawn from.
struct Drawn<'a> {
    model: &'a Model,
    campaign: &'a Campaign,
    comparison: &'a Comparison,
    residuals: &'a Residuals<'a>,
    line: &'a RawLine,
    runs: &'a [RunName],
}

fn sections(from: &Drawn) -> Vec<Section> {
    let Drawn { model, campaign, comparison, residuals, line, runs } = from;
    let samples = samples(residuals);
    let mut temperature = temperature_charts::level_charts(model, comparison, residuals);
    temperature.extend(temperature_charts::node_charts(comparison));
    let mut dependence = residual_charts(runs, &samples);
    dependence.extend(order_chart::order_chart(runs, residuals));
    let rest = [zero_chart::zero_chart(runs, residuals, line), allan_chart::allan_chart(comparison)];
    let maps = [Some(maps::residual_map(model, runs, &samples)), maps::sensitivity_map(model, campaign)];
    let all = [
        ("over-temperature", "Over temperature", temperature),
        ("at-rest", "At rest", rest.into_iter().flatten().collect()),
        ("dependence", "What is left, and what it depends on", dependence),
        ("maps", "Where it holds", maps.into_iter().flatten().collect()),
    ];
    let section =
        |(id, title, charts): (_, _, Vec<Chart>)| (!charts.is_empty()).then_some(Section { id, title, charts });
    all.into_iter().filter_map(section).collect()
}
