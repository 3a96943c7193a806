//! What a campaign can show, and what not, and why.

use super::candidate::Candidate;
use crate::campaign::Campaign;
use crate::diagnose::answer::Unobservable;
use crate::diagnose::forward::EffectSet;
use crate::diagnose::problem::{GlsPair, NoiseModels, Problem, constrained};
use crate::diagnose::thresholds::{LEAST_LEFT, NOTHING_UG};
use firmware_core::effect::{self, About};

/// Candidates by whether the campaign can show them.
pub struct Screening {
    /// Those whose effect neither retraining nor the noise would swallow.
    pub visible: Vec<Candidate>,
    /// Names of effects with no visible candidate, and the reason.
    hidden: Vec<(&'static str, String)>,
}

impl Screening {
    /// Sorts the candidates; `None` if the noise makes no sense.
    pub fn new(problem: &Problem, known: &EffectSet, candidates: Vec<Candidate>, noises: &NoiseModels) -> Option<Self> {
        let (residuals, nuisance) = (problem.forward.residuals(known), constrained(problem, known, noises));
        let gls = GlsPair::new(problem, &residuals, &nuisance, &noises.small())?;
        let shares_left = gls.delta.shares_left(&candidates, |candidate| candidate.delta(problem));
        let (mut visible, mut seen, mut shares) = (Vec::new(), Vec::new(), Vec::new());
        for (candidate, (own, share)) in candidates.into_iter().zip(shares_left) {
            let about = candidate.effect.about;
            shares.push((about.id, own, share));
            if own > NOTHING_UG && share > LEAST_LEFT {
                seen.push(about.id);
                visible.push(candidate);
            }
        }
        let why = |about: &&'static About| {
            let own: Vec<_> = shares.iter().filter(|(id, ..)| *id == about.id).collect();
            let excited = own.iter().any(|(_, size, _)| *size > NOTHING_UG);
            (!own.is_empty() && !seen.contains(&about.id) && !about.takes_program())
                .then(|| (about.name, reason(about, excited)))
        };
        Some(Self { visible, hidden: effect::ALL.iter().filter_map(why).collect() })
    }
}

fn reason(about: &About, excited: bool) -> String {
    match (excited, about.channel) {
        (true, _) => {
            "the static calibration takes it up: it does the same at the same frequency difference and temperature"
                .to_owned()
        }
        (false, Some(channel)) => format!("{channel} does not vary; it takes {}", about.needs),
        (false, None) => format!("nothing in this campaign excites it; it takes {}", about.needs),
    }
}

/// What this campaign can't show.
pub fn unobservable(campaign: &Campaign, screening: &Screening, known: &EffectSet) -> Vec<Unobservable> {
    let missing_channel =
        |about: &&&About| about.channel.is_some_and(|name| !campaign.channels.iter().any(|channel| channel == name));
    let no_channel = effect::ALL.iter().filter(missing_channel).map(|about| Unobservable {
        effect: about.name.to_owned(),
        why: format!("no {} column", about.channel.unwrap_or_default()),
    });
    let known_only =
        effect::ALL.iter().filter(|about| !about.is_on_device() && !about.takes_program()).map(|about| Unobservable {
            effect: about.name.to_owned(),
            why: "it is new at every start and counts as noise from run to run".to_owned(),
        });
    let hidden =
        screening.hidden.iter().map(|(name, why)| Unobservable { effect: (*name).to_owned(), why: why.clone() });
    let unfit = effect::ALL.iter().filter(|about| !campaign.quantity.is_frequency() && about.needs_frequency());
    let unfit = unfit.map(|about| Unobservable {
        effect: about.name.to_owned(),
        why: format!("the signal is measured in {}: it is no frequency", campaign.quantity.signal_unit),
    });
    let all = no_channel.chain(unfit).chain(hidden).chain(known_only);
    // What the model has was seen when it was trained.
    all.filter(|one| !known.effects.iter().any(|effect| effect.about.name == one.effect)).collect()
}
