//! What effects leave of the residual and of the sum of the frequencies.

use super::case::Case;
use super::instrument::{Contributions, Instrument, Known};
use super::layout::Layout;
use super::sum_channel::SumChannel;
use super::whitening::Columns;

/// What effects leave.
#[derive(Clone)]
pub(super) struct Left {
    /// Residual, µg.
    pub delta: Columns,
    /// Residual of the sum, mHz.
    pub sum: Option<Columns>,
}

/// Effects whose contributions don't change while others are fitted.
#[derive(Clone)]
pub(super) struct Held {
    contributions: Contributions,
    /// Of those that say what they do to the sum.
    told: Contributions,
    /// What they leave by themselves.
    left: Left,
}

impl Held {
    /// These effects.
    pub fn new(layout: &Layout, instrument: &Instrument, sum: Option<&SumChannel>, known: &Known) -> Self {
        let (contributions, told) =
            (instrument.contributions(layout, known), instrument.contributions(layout, &known.told()));
        let delta = instrument.residual_ug(layout, &contributions);
        let sum = sum.map(|channel| channel.residual_under(layout, &[&told]));
        Self { contributions, told, left: Left { delta, sum } }
    }
}

impl Case<'_> {
    /// These effects, to be held.
    pub fn held(&self, known: &Known) -> Held {
        Held::new(&self.layout, &self.instrument, self.sum.as_ref(), known)
    }

    /// What these effects leave.
    pub fn left(&self, known: &Known) -> Left {
        self.left_beside(&self.bare, known)
    }

    /// What these effects leave together with those that are held.
    pub fn left_beside(&self, held: &Held, known: &Known) -> Left {
        let own = self.instrument.contributions(&self.layout, known);
        let delta = self.instrument.residual_beside_ug(&self.layout, &held.contributions, &held.left.delta, &own);
        let told = known.told();
        let sum = match &self.sum {
            Some(channel) if !told.effects.is_empty() => {
                let all_told = told.effects.len() == known.effects.len();
                let own = if all_told { own } else { self.instrument.contributions(&self.layout, &told) };
                Some(channel.residual_under(&self.layout, &[&held.told, &own]))
            }
            _ => held.left.sum.clone(),
        };
        Left { delta, sum }
    }
}
