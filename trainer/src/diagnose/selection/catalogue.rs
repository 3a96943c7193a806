//! Which effects a campaign could show at all: the catalogue's, and courses of channels that no effect follows.

use crate::campaign::Campaign;
use crate::effect_choice::{EffectChoice, choose};
use crate::expression::Expression;
use crate::fit::effects::Chosen;
use firmware_core::effect::{self, About};

/// The effects that the campaign has the signal and the channels for, and what channels that no effect follows might do.
pub fn with_channels(campaign: &Campaign) -> Vec<Chosen> {
    let runs: Vec<_> = campaign.runs.iter().collect();
    let chosen = |about: &&About| choose(&EffectChoice::named(about.name), campaign, &runs).ok();
    let catalogue = effect::ALL.iter().filter(|about| about.is_on_device() && !about.takes_program());
    let mut found: Vec<Chosen> = catalogue.filter_map(chosen).collect();
    let program = effect::ALL.iter().find(|about| about.takes_program());
    for (about, channel) in program.into_iter().flat_map(|about| strangers(campaign).map(move |name| (about, name))) {
        let texts = FORMULAS.iter().map(|formula| formula.replace('#', channel));
        let parsed = texts.filter_map(|text| Expression::parse(&text, &campaign.channels).ok());
        found.extend(parsed.map(|expression| Chosen { expression: Some(expression), ..Chosen::of(about) }));
    }
    found
}

/// How a channel that no effect follows may act; `#` is its name.
const FORMULAS: [&str; 5] = ["#", "#^2", "# * temperature_c", "# * level_g", "# * temperature_rate"];

/// Channels that no effect of the catalogue follows.
fn strangers(campaign: &Campaign) -> impl Iterator<Item = &String> {
    let followed = |name: &&String| effect::ALL.iter().any(|about| about.channel == Some(name.as_str()));
    campaign.channels.iter().filter(move |name| !followed(name))
}
