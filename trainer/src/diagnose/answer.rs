//! What a diagnosis says. Data; whoever shows it formats it.

use firmware_core::effect::{self, About};
use serde::ser::SerializeStruct;
use serde::{Serialize, Serializer};
use std::collections::BTreeMap;

/// Which physical effects a model lacks, as far as the measurements can tell.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Diagnosis {
    /// The answer in a word.
    pub verdict: Verdict,
    /// Residual of the model as it is, µg, on the runs that training never saw: what a comparison prints. Where it saw all
    /// runs, each is predicted from the others.
    pub residual_ug: f64,
    /// The same with all findings added, µg: it falls as much as a prediction of those runs from the others falls.
    pub residual_after_ug: f64,
    /// The same two without what is each run's own, µg: its offset, its mounting, and the initial states of
    /// effects with a memory. Nobody can predict that. Of fewer than three runs nothing is left out.
    pub predictable_ug: f64,
    /// With all findings added.
    pub predictable_after_ug: f64,
    /// Noise from sample to sample that no model could remove, µg.
    pub noise_floor_ug: f64,
    /// Share of the predictable residual's square above the noise that the findings remove, 0 to 1.
    pub explainable: f64,
    /// What is missing, in the order in which it should be added.
    pub findings: Vec<Finding>,
    /// Every effect that was judged, those that came nearest first, and what came of each.
    pub candidates: Vec<Judged>,
    /// What this campaign can't show.
    pub unobservable: Vec<Unobservable>,
    /// Structure that no known effect accounts for.
    pub unexplained: Option<Unexplained>,
    /// How much of the residual follows each quantity, before and after the findings.
    pub dependences: Vec<Dependence>,
    /// The noise that the judgement rests on.
    pub noise: Noise,
}

impl Diagnosis {
    /// In other units: sizes in µg, and the coefficients of effects.
    pub(super) fn converted(
        mut self,
        size: impl Fn(f64) -> f64,
        coefficient: impl Fn(&About, &str, f64) -> f64,
    ) -> Self {
        let Self {
            residual_ug,
            residual_after_ug,
            noise_floor_ug,
            predictable_ug,
            predictable_after_ug,
            findings,
            unexplained,
            dependences,
            noise,
            verdict: _,
            explainable: _,
            candidates: _,
            unobservable: _,
        } = &mut self;
        let mut sizes = vec![residual_ug, residual_after_ug, noise_floor_ug, predictable_ug, predictable_after_ug];
        for finding in findings {
            sizes.extend([&mut finding.residual_before_ug, &mut finding.residual_after_ug]);
            let Some(about) = effect::about(&finding.effect) else { continue };
            for (name, Estimate { value, sigma }) in &mut finding.parameters {
                *value = coefficient(about, name, *value);
                *sigma = coefficient(about, name, *sigma).abs();
            }
        }
        sizes.extend(unexplained.iter_mut().map(|rest| &mut rest.residual_ug));
        sizes.extend(dependences.iter_mut().flat_map(|one| [&mut one.before_ug, &mut one.after_ug]));
        let Noise {
            sample_ug,
            flicker_ug,
            wander_ug,
            walk_ug_per_sqrt_h,
            node_ug,
            position_ug,
            pose_ug,
            mounting_ug,
            turn_ug,
            run_ug,
        } = noise;
        sizes.extend([sample_ug, flicker_ug, wander_ug, walk_ug_per_sqrt_h, node_ug]);
        sizes.extend([position_ug, pose_ug, mounting_ug, turn_ug, run_ug]);
        sizes.into_iter().for_each(|one| *one = size(*one));
        self
    }
}

/// The answer in a word.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Verdict {
    /// The first finding is missing; nothing else explains the residual as well.
    Missing,
    /// Several effects explain the residual equally well; an experiment separates them.
    Ambiguous,
    /// The residual is noise.
    NothingMissing,
    /// There is structure, and no known effect is its cause.
    Unexplained,
}

/// An effect that was judged, and what came of it; it is written with the outcome in a word and in words.
#[derive(Clone, Debug, PartialEq)]
pub struct Judged {
    /// Its name, or the formula of a channel.
    pub effect: String,
    /// ΔBIC beside what was found before, fitted, or as screened where it was not fitted.
    pub delta_bic: f64,
    /// Residual of what was left out with the effect over that without it, what is each run's own aside; none where nobody
    /// asked.
    pub held_out_ratio: Option<f64>,
    /// What came of it.
    pub outcome: Outcome,
}

impl Serialize for Judged {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let Self { effect, delta_bic, held_out_ratio, outcome } = self;
        let mut fields = serializer.serialize_struct("Judged", 5)?;
        fields.serialize_field("effect", effect)?;
        fields.serialize_field("delta_bic", delta_bic)?;
        fields.serialize_field("held_out_ratio", held_out_ratio)?;
        fields.serialize_field("outcome", outcome.word())?;
        fields.serialize_field("reason", &outcome.reason())?;
        fields.end()
    }
}

/// What came of an effect that was judged.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Outcome {
    /// It is among the findings.
    Found,
    /// Its ΔBIC is too small.
    Weak,
    /// Others did better as screened; it was not fitted.
    NotFitted,
    /// It explains what this effect explains, which was found.
    ExplainedBy(String),
    /// It may be what this effect's formula lacks.
    WithinFormulaOf(String),
    /// A shape ended at the bound of what makes physical sense.
    AtBound,
    /// Its amplitude is no three standard uncertainties from nothing, or it remembers for less than a sample.
    Undetermined,
    /// It does not predict what was left out.
    NotPredictive,
    /// A structure that no effect makes is more likely.
    Resembles,
    /// What was found later explains it.
    Superfluous,
}

impl Outcome {
    /// The same in a word, for programs.
    #[must_use]
    pub const fn word(&self) -> &'static str {
        match self {
            Self::Found => "found",
            Self::Weak => "weak",
            Self::NotFitted => "not-fitted",
            Self::ExplainedBy(_) => "explained",
            Self::WithinFormulaOf(_) => "within-formula",
            Self::AtBound => "at-bound",
            Self::Undetermined => "undetermined",
            Self::NotPredictive => "not-predictive",
            Self::Resembles => "resembles",
            Self::Superfluous => "superfluous",
        }
    }

    /// The same in words.
    #[must_use]
    pub fn reason(&self) -> String {
        match self {
            Self::Found => "found".to_owned(),
            Self::Weak => "too weak".to_owned(),
            Self::NotFitted => "others explain more; not fitted".to_owned(),
            Self::ExplainedBy(effect) => format!("explains the same as {effect}"),
            Self::WithinFormulaOf(effect) => format!("no more than the formula of {effect} may lack"),
            Self::AtBound => "at the bound of its formula".to_owned(),
            Self::Undetermined => "its size is not determined".to_owned(),
            Self::NotPredictive => "reads what was left out no better".to_owned(),
            Self::Resembles => "merely resembles a structure without a name".to_owned(),
            Self::Superfluous => "superfluous beside what was found later".to_owned(),
        }
    }
}

/// One effect that is missing.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Finding {
    /// Its name.
    pub effect: String,
    /// Held-out residual before it is added, and after the findings before it are, µg.
    pub residual_before_ug: f64,
    /// Held-out residual after it is added, µg.
    pub residual_after_ug: f64,
    /// ΔBIC: twice the logarithm of the likelihood ratio with and without it, noise estimated anew, less k·ln n for its k
    /// parameters and n cells. `evidence` is another name of it, until 1.0.
    #[serde(flatten, serialize_with = "under_both_names")]
    pub delta_bic: f64,
    /// Its parameters.
    pub parameters: BTreeMap<String, Estimate>,
    /// Effects that would explain the same.
    pub confounded_with: Vec<String>,
    /// The experiment that would separate them.
    pub separate_by: Option<String>,
}

/// A value and its standard uncertainty.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Estimate {
    /// The value, in the unit that ends the parameter's name.
    pub value: f64,
    /// Its standard uncertainty.
    pub sigma: f64,
}

/// An effect that this campaign can't show.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Unobservable {
    /// Its name.
    pub effect: String,
    /// Why not.
    pub why: String,
}

/// Structure without a known cause.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Unexplained {
    /// What the residual depends on, strongest first.
    pub depends_on: Vec<String>,
    /// Its period, if it is periodic in time.
    pub period_s: Option<f64>,
    /// A formula that describes it, as `add --expression` takes it.
    pub formula: Option<String>,
    /// Size of the structure, µg RMS.
    pub residual_ug: f64,
}

/// How much of the residual follows one quantity.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Dependence {
    /// The quantity.
    pub on: String,
    /// RMS of the part that follows it, µg, noise deducted.
    pub before_ug: f64,
    /// The same with the findings added.
    pub after_ug: f64,
    /// Probability of as much by chance, before.
    pub chance_before: f64,
    /// And after.
    pub chance_after: f64,
}

/// Standard deviations of the noise, estimated after the findings.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Noise {
    /// From sample to sample, µg.
    pub sample_ug: f64,
    /// Wander within minutes, µg.
    pub flicker_ug: f64,
    /// Wander within hours, µg.
    pub wander_ug: f64,
    /// Random walk, µg per √h.
    pub walk_ug_per_sqrt_h: f64,
    /// From soaked node to soaked node, µg.
    pub node_ug: f64,
    /// Per g across the input axis, from position to position, µg: table.
    pub position_ug: f64,
    /// From position to position whatever lies across the input axis, µg: no table does that.
    pub pose_ug: f64,
    /// Per g across the input axis, from run to run, µg: mounting.
    pub mounting_ug: f64,
    /// Per g across the input axis, within hours, µg: a rig that stood in one of two ways at a level, nobody knows which.
    pub turn_ug: f64,
    /// From run to run, µg: turn-on.
    pub run_ug: f64,
}

fn under_both_names<S: Serializer>(delta_bic: &f64, serializer: S) -> Result<S::Ok, S::Error> {
    BTreeMap::from([("delta_bic", delta_bic), ("evidence", delta_bic)]).serialize(serializer)
}
