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
    let unfit = effect::ALL.iter().filter(|about| !campaign.quantity.is_frequency() && about.needs_frequency);
    let unfit = unfit.map(|about| Unobservable {
        effect: about.name.to_owned(),
        why: format!("the signal is measured in {}: it is no frequency", campaign.quantity.signal_unit),
    });
    let all = no_channel.chain(unfit).chain(hidden).chain(known_only);
    // What the model has was seen when it was trained.
    all.filter(|one| !known.effects.iter().any(|effect| effect.about.name == one.effect)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnose::example::{Moment, Recipe, effect, problem, white};

    fn screened(recipe: &Recipe, names: &[&str]) -> (Vec<String>, Vec<(String, String)>) {
        let campaign = recipe.campaign();
        let (problem, none) = (problem(&campaign), EffectSet::NONE);
        let shown: Vec<_> = names.iter().map(|name| effect(name, &campaign)).collect();
        let candidates = Candidate::all(&problem, &shown);
        let screening = Screening::new(&problem, &none, candidates, &white(&problem, &none, 5.0)).unwrap();
        let mut visible: Vec<String> = screening.visible.iter().map(|one| one.effect.about.name.to_owned()).collect();
        visible.dedup();
        let hidden = unobservable(&campaign, &screening, &none);
        (visible, hidden.into_iter().map(|one| (one.effect, one.why)).collect())
    }

    fn why<'a>(hidden: &'a [(String, String)], name: &str) -> Option<&'a str> {
        hidden.iter().find(|(effect, _)| effect == name).map(|(_, why)| why.as_str())
    }

    #[test]
    fn without_a_ramp_nothing_shows_that_follows_the_rate() {
        let names = ["warm-up", "thermal-lag", "thermal-gradient"];
        // All of a run's first ten minutes are one soak.
        let (visible, hidden) = screened(&Recipe { rows: 30, ..Recipe::default() }, &names);
        assert_eq!(visible, ["warm-up"]);
        for name in ["thermal-lag", "thermal-gradient"] {
            let why = why(&hidden, name).unwrap();
            assert!(why.starts_with("nothing in this campaign excites it"), "{name}: {why}");
        }
        let (visible, hidden) = screened(&Recipe::default(), &names);
        assert_eq!(visible, names);
        assert!(names.iter().all(|name| why(&hidden, name).is_none()));
    }

    #[test]
    fn what_has_no_channel_or_no_variation_in_it_is_said() {
        let course = |_: &Moment| 5.0;
        let recipe = Recipe { channel: Some(("supply_v", &course)), ..Recipe::default() };
        let (visible, hidden) = screened(&recipe, &["supply-voltage", "warm-up"]);
        assert_eq!(visible, ["warm-up"]);
        assert!(why(&hidden, "supply-voltage").unwrap().starts_with("supply_v does not vary"), "{hidden:?}");
        let (_, hidden) = screened(&Recipe::default(), &["warm-up"]);
        assert_eq!(why(&hidden, "supply-voltage"), Some("no supply_v column"));
    }

    #[test]
    fn what_a_static_map_does_as_well_is_taken_up_by_it() {
        let (visible, hidden) = screened(&Recipe::default(), &["second-order", "warm-up"]);
        assert_eq!(visible, ["warm-up"]);
        assert!(why(&hidden, "second-order").unwrap().starts_with("the static calibration takes it up"), "{hidden:?}");
    }
}
