//! The course of a diagnosis: from noise and candidates through one finding after the other to the verdict.

use super::DiagnoseError;
use super::answer::{Dependence, Diagnosis, Estimate, Finding, Noise, Unexplained, Verdict};
use super::candidate::{Candidate, name_of, with_channels};
use super::case::{Case, Noises};
use super::evidence::{Score, compressed};
use super::instrument::{Instrument, Known};
use super::layout::Layout;
use super::left::Held;
use super::noise_search::first_guess;
use super::observable::{Screening, unobservable};
use super::search::{Contender, Found, LOWERED};
use super::separation::separate;
use super::sum_channel::SumChannel;
use super::telltale::Telltale;
use super::whitening::{FLICKER, MOUNTING, NODE, NoiseModel, POSE, POSITION, RUN, TURN, WALK, WANDER};
use crate::campaign::Campaign;
use crate::effect_choice::{EffectChoice, choose};
use crate::fit::dataset::InputScale;
use crate::model::Model;
use crate::progress::Progress;
use crate::yardstick::Yardstick;
use firmware_core::effect::Role;
use nalgebra::DVector;
use std::collections::BTreeMap;

/// Evidence that an effect must have: twice the logarithm of the likelihood ratio beyond its parameters' price.
const ENOUGH: f64 = 25.0;
/// Effects with less are compared with structures that no effect has before they are believed.
const WEAK: f64 = 400.0;
/// Most findings.
const MOST_FINDINGS: usize = 4;
/// Effects whose evidence differs by less are confounded; and by less than this share, as no formula is exact.
const CONFOUNDED: f64 = 10.0;
const CONFOUNDED_SHARE: f64 = 0.1;
/// Wander within a run beyond so many times the sample noise is no noise of a resonator: something causes it.
const STRUCTURE: f64 = 1.0;
/// And beyond this share of what a rig does per g across the input axis, if nobody wrote down how it stood.
const UNSEEN: f64 = 0.5;
/// Evidence of an effect beyond its physical bounds that tells of something unknown: formulas are not exact.
const SURELY_STRAINED: f64 = 100.0;
/// Steps of the last fit of all findings together.
const LAST_STEPS: usize = 12;

/// In the units of `yardstick`, as `campaign` is.
pub(super) fn judge(
    model: &Model,
    campaign: &Campaign,
    yardstick: &Yardstick,
    progress: &dyn Progress,
) -> Result<Diagnosis, DiagnoseError> {
    let mut case = case(model, campaign, yardstick)?;
    let mut start = in_model(model, campaign, yardstick)?;
    case.layout.remember(&start);
    if !start.effects.is_empty() {
        // What retraining would make of the effects that the model has is not missing.
        let noises = case.noises(&case.left(&start), &case.loose(&start), None);
        let benches = case.benches(&case.left(&start), &case.stiff(&start), &noises).ok_or(DiagnoseError::NoNoise)?;
        (start, _) = case.refit(&case.bare, &start, &benches, LAST_STEPS);
        case.layout.remember(&start);
    }
    let shown = with_channels(campaign);
    let candidates = Candidate::all(&case, &shown);
    let noises = case.noises(&case.left(&start), &case.loose(&start), None);
    let screening = Screening::new(&case, &start, candidates, &noises).ok_or(DiagnoseError::NoNoise)?;
    let mut found = search(&mut case, &start, &screening.visible, noises, progress)?;
    if let Some(foreseen) = foreseen(&mut case, &start, &found, &screening.visible) {
        found = foreseen;
    }
    let mut diagnosis = answer(&case, campaign, &start, found);
    diagnosis.unobservable = unobservable(campaign, &screening, &start);
    Ok(diagnosis)
}

/// Where a joint fit of these effects should begin: as a diagnosis of the static `model` would fit them, one beside
/// the other. Effects that say nothing keep the start that they have. In the units of `yardstick`, as `campaign` is.
pub(super) fn starts(
    model: &Model,
    campaign: &Campaign,
    yardstick: &Yardstick,
    choices: &[EffectChoice],
) -> Option<Vec<EffectChoice>> {
    let case = case(model, campaign, yardstick).ok()?;
    let runs: Vec<_> = campaign.runs.iter().collect();
    let mut known = Known::NONE;
    let mut noises = case.noises(&case.left(&known), &case.stiff(&known), None);
    let mut started = Vec::new();
    for choice in choices {
        let chosen = choose(choice, campaign, &runs).ok()?;
        let start = choice.start.clone().or_else(|| {
            let candidates = Candidate::all(&case, std::slice::from_ref(&chosen));
            let found = case.missing(&known, &candidates, &noises)?;
            noises = found.winner.noises.unwrap_or(noises);
            Some(found.winner.values)
        });
        if let Some(values) = &start {
            known = known.with(&chosen, values);
        }
        started.push(EffectChoice { start, ..choice.clone() });
    }
    Some(started)
}

/// Model and measurements before the judge.
pub(super) fn case<'a>(
    model: &Model,
    campaign: &'a Campaign,
    yardstick: &Yardstick,
) -> Result<Case<'a>, DiagnoseError> {
    let instrument = Instrument::new(model, yardstick);
    let max_gap_us = model.domain.max_gap_us;
    let layout = Layout::new(campaign, scale(model), max_gap_us, instrument.reach_g(), yardstick.gravity);
    let sample_ug = instrument.sample_ug(&layout).ok_or(DiagnoseError::NoNoise)?;
    let ug_per_c = instrument.ug_per_c(&layout);
    if !instrument.scale_factor_hz_per_g(&layout).is_finite() {
        return Err(DiagnoseError::Numbers(FLAT));
    }
    if !(sample_ug.is_finite() && ug_per_c.is_finite()) {
        return Err(DiagnoseError::Numbers(ABSURD));
    }
    let freedom = compressed(&layout, &first_guess(sample_ug, ug_per_c), &instrument.freedom(&layout));
    let sum = SumChannel::new(&layout);
    let bare = Held::new(&layout, &instrument, sum.as_ref(), &Known::NONE);
    Ok(Case { layout, instrument, freedom, sum, bare, sample_ug, ug_per_c })
}

/// A model without a slope explains every signal equally badly.
const FLAT: &str = "the model reads the same whatever the signal is: train it on a reference that varies, or state the \
                    scale factor";
const ABSURD: &str = "the residual is not a finite number: look at the campaign's extremes with `tempco inspect`";

/// From integers to the model's inputs.
pub(super) fn scale(model: &Model) -> InputScale {
    InputScale {
        delta_f_zero_uhz: model.scaling.delta_f_zero_uhz,
        delta_f_half_span_hz: f64::from(model.scaling.delta_f_gain_per_hz).recip(),
        temperature_zero_uc: model.scaling.temperature_zero_uc,
        temperature_half_span_c: f64::from(model.scaling.temperature_gain_per_c).recip(),
    }
}

/// The effects that the model has already.
pub(super) fn in_model(model: &Model, campaign: &Campaign, yardstick: &Yardstick) -> Result<Known, DiagnoseError> {
    let runs: Vec<_> = campaign.runs.iter().collect();
    let mut known = Known::NONE;
    for (choice, effect) in EffectChoice::of(model).iter().zip(&model.effects) {
        let chosen = choose(choice, campaign, &runs)?;
        let value = |name: &str, start: f64| effect.parameters.get(name).copied().unwrap_or(start);
        let values: Vec<f64> = chosen.about.parameters.iter().map(|about| value(about.name, about.start)).collect();
        known = known.with(&chosen, &yardstick.coefficients_inside(chosen.about, &values));
    }
    Ok(known)
}

/// What was found, one after the other.
struct Findings {
    known: Known,
    steps: Vec<Found>,
    /// The noise with all of them.
    noises: Noises,
    /// Most evidence of what would have to leave its physical bounds, at the end.
    strained: f64,
    /// A channel's course that explains what no effect does.
    formula: Option<Contender>,
}

fn search(
    case: &mut Case,
    start: &Known,
    candidates: &[Candidate],
    noises: Noises,
    progress: &dyn Progress,
) -> Result<Findings, DiagnoseError> {
    let mut found =
        Findings { known: start.clone(), steps: Vec::new(), noises, strained: f64::NEG_INFINITY, formula: None };
    let mut dropped: Vec<String> = Vec::new();
    while found.steps.len() < MOST_FINDINGS {
        if progress.cancelled() {
            return Err(DiagnoseError::Cancelled);
        }
        let Some(next) = case.missing(&found.known, candidates, &found.noises) else { break };
        if next.winner.evidence < ENOUGH || dropped.iter().any(|name| name == name_of(&next.winner.effect)) {
            found.strained = next.strained;
            found.noises = next.noises;
            break;
        }
        if next.winner.effect.expression.is_some() {
            // No effect that anybody knows follows this channel: it is described, not explained.
            found.formula = Some(next.winner);
            break;
        }
        let noises = next.winner.noises.unwrap_or(found.noises);
        let known = found.known.with(&next.winner.effect, &next.winner.values);
        let is_stranger = |case: &Case, known, noises| case.strangest(known, noises) > next.winner.evidence;
        if next.winner.evidence < WEAK
            && is_stranger(case, &found.known, &next.noises)
            && is_stranger(&case.remembering(&known), &known, &noises)
        {
            // Something that no known effect does is more likely, with this one too: it merely resembles it.
            found.noises = next.noises;
            break;
        }
        case.layout.remember(&known);
        let benches = case.benches(&case.left(&known), &case.stiff(&known), &noises).ok_or(DiagnoseError::NoNoise)?;
        (found.known, _) = case.refit(&case.bare, &known, &benches, LAST_STEPS);
        found.noises = noises;
        case.layout.remember(&found.known);
        found.steps.push(next);
        dropped.extend(prune(case, start, &mut found).ok_or(DiagnoseError::NoNoise)?);
    }
    Ok(found)
}

/// Takes out again what later findings have made superfluous: an effect that merely resembled them came first.
fn prune(case: &mut Case, start: &Known, found: &mut Findings) -> Option<Vec<String>> {
    let mut dropped = Vec::new();
    // The last finding is as good as it was a moment ago; where it is alone, there is nothing to ask.
    while found.steps.len() > 1 {
        let deviance = |known: &Known| {
            let benches = case.benches(&case.left(known), &case.stiff(known), &found.noises)?;
            let (known, left) = case.refit(&case.bare, known, &benches, LAST_STEPS);
            let value = case.benches(&left, &case.stiff(&known), &found.noises)?.deviance();
            Some((value, known))
        };
        let (with, _) = deviance(&found.known)?;
        let least = |step: usize| {
            let (without, known) = deviance(&found.known.without(start.effects.len() + step))?;
            let price = case.price() * found.steps[step].winner.effect.free().count() as f64;
            Some((without - with - price, step, known))
        };
        let all: Vec<_> = (0..found.steps.len() - 1).map(least).collect::<Option<_>>()?;
        let (evidence, step, known) = all.into_iter().min_by(|a, b| a.0.total_cmp(&b.0))?;
        if evidence >= ENOUGH {
            break;
        }
        dropped.push(name_of(&found.steps.remove(step).winner.effect).to_owned());
        found.known = known;
        case.layout.remember(&found.known);
        let (left, freedom) = (case.left(&found.known), case.adapting(&found.known, &found.noises));
        found.noises = case.noises(&left, &freedom, Some(&found.noises));
    }
    Some(dropped)
}

/// Where a large wander hides what likelihood could say, and it named nothing or something weak: the effect that halves
/// the residual of what was left out, if there is one.
fn foreseen(case: &mut Case, start: &Known, found: &Findings, candidates: &[Candidate]) -> Option<Findings> {
    let weak = found.steps.first().is_none_or(|step| step.winner.evidence < WEAK) && found.formula.is_none();
    if !weak || !is_structured(case, &found.noises.delta) {
        return None;
    }
    let step = case.foreseen(start, candidates, &found.noises)?;
    let known = start.with(&step.winner.effect, &step.winner.values);
    case.layout.remember(&known);
    let noises = case.noises(&case.left(&known), &case.adapting(&known, &found.noises), Some(&found.noises));
    Some(Findings { known, steps: vec![step], noises, strained: f64::NEG_INFINITY, formula: None })
}

fn answer(case: &Case, campaign: &Campaign, start: &Known, mut found: Findings) -> Diagnosis {
    let structured = is_structured(case, &found.noises.delta);
    let foreseeable_ug = |known: &Known| case.held_out(known, &found.noises).structure_ug();
    let [before_ug, mut after_ug] = [start, &found.known].map(foreseeable_ug);
    // Where structure remains, what merely resembles its cause does not foretell other runs.
    if structured && after_ug > LOWERED * before_ug {
        found.known = start.clone();
        found.steps.clear();
        after_ug = before_ug;
    }
    let telltales = case.telltales(&found.known, &found.noises, &campaign.channels);
    let unexplained =
        structured || found.strained > SURELY_STRAINED || found.formula.is_some() || !telltales.is_empty();
    let dependences = case.dependences(start, &found.known, &found.noises, &campaign.channels);
    // Foretold as well as the noise without the findings allows.
    let residual_ug = case.held_out(start, found.steps.first().map_or(&found.noises, |step| &step.noises)).residual_ug;
    let findings = findings(case, start, &found, residual_ug);
    let residual_after_ug = findings.last().map_or(residual_ug, |finding| finding.residual_after_ug);
    let verdict = match (findings.is_empty(), unexplained) {
        (true, true) => Verdict::Unexplained,
        (true, false) => Verdict::NothingMissing,
        _ if findings.iter().any(|finding| !finding.confounded_with.is_empty()) => Verdict::Ambiguous,
        _ => Verdict::Missing,
    };
    Diagnosis {
        verdict,
        residual_ug,
        residual_after_ug,
        noise_floor_ug: case.sample_ug,
        foreseeable_ug: before_ug,
        foreseeable_after_ug: after_ug,
        explainable: explainable(before_ug, after_ug, &found.noises.delta),
        findings,
        unobservable: Vec::new(),
        unexplained: unexplained
            .then(|| unexplained_rest(&found, structure_ug(&found.noises.delta), &telltales, &dependences, campaign)),
        dependences,
        noise: noise(&found.noises.delta),
    }
}

/// Whether something causes the wander within runs.
fn is_structured(case: &Case, noise: &NoiseModel) -> bool {
    let rig_ug = noise.parts[POSITION].hypot(noise.parts[TURN]);
    let unseen_ug = if case.layout.may_turn_unseen() { UNSEEN * rig_ug } else { 0.0 };
    structure_ug(noise) > f64::max(STRUCTURE * case.sample_ug, unseen_ug)
}

/// Wander within a run, µg RMS over an hour.
fn structure_ug(noise: &NoiseModel) -> f64 {
    let [flicker, wander, walk] = [FLICKER, WANDER, WALK].map(|part| noise.parts[part]);
    (2.0 * flicker.powi(2) + wander.powi(2) + (walk * 60.0).powi(2)).sqrt()
}

fn findings(case: &Case, start: &Known, found: &Findings, mut residual_ug: f64) -> Vec<Finding> {
    let sigmas = case.sigmas(&found.known, &found.noises);
    let mut known = start.clone();
    let mut findings = Vec::new();
    for (index, step) in found.steps.iter().enumerate() {
        let at = start.effects.len() + index;
        known = known.with(&found.known.effects[at], &found.known.coefficients.values[at]);
        let after_ug = case.held_out(&known, &found.noises).residual_ug;
        let name = step.winner.effect.about.name;
        let confounded_with = confounded(step);
        findings.push(Finding {
            effect: name.to_owned(),
            residual_before_ug: residual_ug,
            residual_after_ug: after_ug,
            evidence: step.winner.evidence,
            parameters: parameters(&found.known, &sigmas, at),
            separate_by: confounded_with.first().map(|other| separate(name, other)),
            confounded_with,
        });
        residual_ug = after_ug;
    }
    findings
}

fn confounded(step: &Found) -> Vec<String> {
    let enough = step.winner.evidence - CONFOUNDED.max(CONFOUNDED_SHARE * step.winner.evidence);
    let close = |rival: &&Contender| rival.evidence > enough && rival.evidence > 0.0;
    step.rivals.iter().filter(close).map(|rival| rival.effect.about.name.to_owned()).collect()
}

fn parameters(known: &Known, sigmas: &[Vec<f64>], at: usize) -> BTreeMap<String, Estimate> {
    let (effect, values) = (&known.effects[at], &known.coefficients.values[at]);
    let each = effect.about.parameters.iter().zip(values).zip(&sigmas[at]);
    each.filter(|((about, _), _)| about.role != Role::Origin)
        .map(|((about, value), sigma)| (about.name.to_owned(), Estimate { value: *value, sigma: *sigma }))
        .collect()
}

/// Share of the square above what no model can remove; what is new in every run is not in it.
fn explainable(before_ug: f64, after_ug: f64, noise: &NoiseModel) -> f64 {
    let parts = [POSITION, NODE, FLICKER, WANDER, POSE, TURN].map(|part| noise.parts[part].powi(2));
    let floor = (noise.sample.powi(2) + parts.iter().sum::<f64>()).min(after_ug.powi(2));
    let excess = before_ug.powi(2) - floor;
    if excess > 0.0 { ((before_ug.powi(2) - after_ug.powi(2)) / excess).clamp(0.0, 1.0) } else { 0.0 }
}

fn noise(noise: &NoiseModel) -> Noise {
    Noise {
        sample_ug: noise.sample,
        flicker_ug: noise.parts[FLICKER],
        wander_ug: noise.parts[WANDER],
        walk_ug_per_sqrt_h: noise.parts[WALK] * 60.0,
        node_ug: noise.parts[NODE],
        position_ug: noise.parts[POSITION],
        pose_ug: noise.parts[POSE],
        mounting_ug: noise.parts[MOUNTING],
        turn_ug: noise.parts[TURN],
        run_ug: noise.parts[RUN],
    }
}

impl Case<'_> {
    /// Standard uncertainties of all coefficients, effect by effect.
    fn sigmas(&self, known: &Known, noises: &Noises) -> Vec<Vec<f64>> {
        let parameters = known.coefficients.to_parameters(&known.effects);
        let left = self.left(known);
        let covariance = self.benches(&left, &self.stiff(known), noises).and_then(|benches| {
            let (delta, sum) = self.tangents(&self.bare, known, &left);
            let normal = benches.normal(&delta, sum.as_ref());
            // Where the data say nothing of a parameter, its bounds do.
            Score { right: DVector::zeros(normal.nrows()), normal }.covariance()
        });
        let sigma = |i: usize| covariance.as_ref().map_or(0.0, |covariance| covariance[(i, i)].max(0.0).sqrt());
        // One sigma up or down in the optimiser's parameters, seen in the coefficients' own units: at a bound, one is nothing.
        let moved = |sign: f64| {
            known.at(&parameters.iter().enumerate().map(|(i, value)| value + sign * sigma(i)).collect::<Vec<_>>())
        };
        let away = |moved: &[f64], here: &[f64]| moved.iter().zip(here).map(|(a, b)| (a - b).abs()).collect::<Vec<_>>();
        let [up, down] = [moved(1.0), moved(-1.0)].map(|moved| moved.coefficients.values);
        let larger = |((up, down), here): ((&Vec<f64>, &Vec<f64>), &Vec<f64>)| {
            away(up, here).into_iter().zip(away(down, here)).map(|(up, down)| up.max(down)).collect()
        };
        up.iter().zip(&down).zip(&known.coefficients.values).map(larger).collect()
    }
}

/// What is left that nothing explains: what it follows, the surest sign first.
fn unexplained_rest(
    found: &Findings,
    structure_ug: f64,
    telltales: &[Telltale],
    dependences: &[Dependence],
    campaign: &Campaign,
) -> Unexplained {
    let surely = dependences.iter().filter(|one| one.chance_after < SURELY && one.after_ug > 0.0);
    let mut sizes: Vec<(f64, &String)> = surely.map(|one| (one.after_ug, &one.on)).collect();
    sizes.sort_by(|a, b| b.0.total_cmp(&a.0));
    let formula = found.formula.as_ref().map(|formula| name_of(&formula.effect).to_owned());
    let is_followed = |index: usize| found.formula.as_ref().is_some_and(|formula| formula.effect.follows(index));
    let followed = campaign.channels.iter().enumerate().filter(|(index, _)| is_followed(*index)).map(|(_, name)| name);
    let told = telltales.iter().flat_map(|telltale| &telltale.depends_on);
    let mut depends_on: Vec<String> = Vec::new();
    for name in followed.chain(told).chain(sizes.into_iter().map(|(_, name)| name)) {
        if !depends_on.contains(name) {
            depends_on.push(name.clone());
        }
    }
    if depends_on.is_empty() {
        depends_on.push("time_s".to_owned());
    }
    let largest_ug = telltales.iter().map(|telltale| telltale.size_ug).fold(0.0, f64::max);
    Unexplained {
        depends_on,
        period_s: telltales.iter().find_map(|telltale| telltale.period_s),
        formula,
        residual_ug: structure_ug.max(largest_ug),
    }
}

/// A dependence less likely by chance than this is one.
const SURELY: f64 = 1e-4;
