//! The course of a diagnosis: from noise and candidates through one finding after the other to the verdict.

use super::answer::{Diagnosis, Estimate, Finding, Noise, Unobservable, Verdict};
use super::candidate::{Candidate, with_channels};
use super::case::{Case, Noises};
use super::evidence::compressed;
use super::instrument::{Instrument, Known};
use super::layout::Layout;
use super::noise_search::first_guess;
use super::search::Found;
use super::sum_channel::SumChannel;
use super::DiagnoseError;
use crate::campaign::Campaign;
use crate::fit::dataset::InputScale;
use crate::model::Model;
use crate::progress::Progress;

/// Evidence that an effect must have: twice the logarithm of the likelihood ratio beyond its parameters' price.
const ENOUGH: f64 = 15.0;
/// Most findings.
const MOST_FINDINGS: usize = 4;

pub(super) fn judge(model: &Model, campaign: &Campaign, progress: &dyn Progress) -> Result<Diagnosis, DiagnoseError> {
    let scale = InputScale {
        delta_f_zero_uhz: model.scaling.delta_f_zero_uhz,
        delta_f_half_span_hz: f64::from(model.scaling.delta_f_gain_per_hz).recip(),
        temperature_zero_uc: model.scaling.temperature_zero_uc,
        temperature_half_span_c: f64::from(model.scaling.temperature_gain_per_c).recip(),
    };
    let layout = Layout::new(campaign, scale, model.domain.max_gap_us);
    let instrument = Instrument::new(model);
    let sample_ug = instrument.sample_ug(&layout).ok_or(DiagnoseError::NoNoise)?;
    let ug_per_c = instrument.ug_per_c(&layout);
    let freedom = compressed(&layout, &first_guess(sample_ug, ug_per_c), &instrument.freedom(&layout));
    let sum = SumChannel::new(&layout);
    let mut case = Case { layout, instrument, freedom, sum, sample_ug, ug_per_c };
    let trace = std::env::var("TRACE").is_ok();
    let start = std::time::Instant::now();
    let shown = with_channels(campaign);
    let candidates = Candidate::all(&case.instrument, &case.layout, case.sum.as_ref(), &shown);
    if trace {
        eprintln!("{:?} cells {} candidates {} freedom {} sample {:.2}", start.elapsed(), case.layout.len(), candidates.len(), case.freedom[0].ncols(), sample_ug);
    }
    let mut known = Known::NONE;
    let mut noises = case.noises(&case.left(&known), &case.stiff(&known), None);
    if trace {
        eprintln!("{:?} noise {:.2?}", start.elapsed(), noises);
    }
    let mut found: Vec<Found> = Vec::new();
    while found.len() < MOST_FINDINGS {
        if progress.cancelled() {
            return Err(DiagnoseError::Cancelled);
        }
        let Some(next) = case.missing(&known, &candidates, &noises) else { break };
        if trace {
            eprintln!("{:?} evidence {:.1} noise {:.2?}", start.elapsed(), next.winner.evidence, next.winner.noises);
            for contender in std::iter::once(&next.winner).chain(&next.rivals).take(8) {
                eprintln!("    {:24} {:12.1} {:?}", contender.effect.about.name, contender.evidence, contender.values);
            }
        }
        if next.winner.evidence < ENOUGH {
            break;
        }
        known = known.with(&next.winner.effect, &next.winner.values);
        noises = next.winner.noises.unwrap_or(noises);
        let benches = case.benches(&case.left(&known), &case.stiff(&known), &noises).ok_or(DiagnoseError::NoNoise)?;
        known = case.refit(None, &known, &benches, 12);
        case.layout.remember(&known);
        if trace {
            eprintln!("   known {:?}", known.coefficients.values);
            let view = case.left(&known);
            let benches = case.benches(&view, &case.stiff(&known), &noises).unwrap();
            let inn = benches.delta.innovations();
            let mut all: Vec<(f64, usize, usize)> = Vec::new();
            for (run, values) in inn.iter().enumerate() {
                let chi: f64 = values.iter().map(|v| v * v).sum();
                eprint!("  {}:{:.0}/{}", case.layout.stretches[run].run.name, chi, values.len());
                all.extend(values.iter().enumerate().map(|(i, v)| (*v, run, i)));
            }
            eprintln!();
            all.sort_by(|a, b| b.0.abs().total_cmp(&a.0.abs()));
            for (v, run, i) in all.iter().take(25) {
                let cell = &case.layout.stretches[*run].cells[*i];
                let row = &case.layout.stretches[*run].run.rows[cell.rows.start];
                eprintln!("     {v:8.1} {} cell {i} time {:.0} ton {:.0} T {:.2} a {:.2} n {} e {:.1}", case.layout.stretches[*run].run.name, cell.time_s, row.sample.power_on_us as f64 * 1e-6, f64::from(row.sample.temperature_uc) * 1e-6, cell.level_g, cell.samples, view.delta[*run][(*i, 0)]);
            }
        }
        found.push(next);
    }
    let _ = (Estimate { value: 0.0, sigma: 0.0 }, Unobservable { effect: String::new(), why: String::new() });
    let findings: Vec<Finding> = found
        .iter()
        .map(|found| Finding {
            effect: found.winner.effect.about.name.to_owned(),
            residual_before_ug: 0.0,
            residual_after_ug: 0.0,
            evidence: found.winner.evidence,
            parameters: Default::default(),
            confounded_with: Vec::new(),
            separate_by: None,
        })
        .collect();
    let _: Option<Noises> = None;
    Ok(Diagnosis {
        verdict: if findings.is_empty() { Verdict::NothingMissing } else { Verdict::Missing },
        residual_ug: 0.0,
        residual_after_ug: 0.0,
        noise_floor_ug: sample_ug,
        explainable: 0.0,
        findings,
        unobservable: Vec::new(),
        unexplained: None,
        dependences: Vec::new(),
        noise: Noise { sample_ug, flicker_ug: 0.0, walk_ug_per_sqrt_h: 0.0, position_ug: 0.0, mounting_ug: 0.0, run_ug: 0.0 },
    })
}
