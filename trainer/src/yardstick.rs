//! What a campaign is measured with: training and diagnosis work in units of its own size, so that they find the same
//! whatever the units are and whichever way round the sensor was wired.
//!
//! Bounds, tolerances and first steps are made for ±1 g. A reference within a factor of two of that is left as it is;
//! any other is scaled to it, and the answer is scaled back. Where the reference never varies, what the reading does
//! over the campaign takes its place.

pub(crate) use crate::units::STILL;

use crate::campaign::{Campaign, Row};
use crate::effect_choice::EffectChoice;
use crate::model::{Model, reach};
use crate::units::{DRIFT_G, ORDINARY_G, exponent, units_per_g};
use firmware_core::effect::{self, About};
use std::borrow::Cow;

/// From the campaign's units to those of the work, and back.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Yardstick {
    /// Of a reference: this times the campaign's number.
    factor: f64,
    /// What 1 g of gravity is in the units of the work; none where the reference is no acceleration.
    pub gravity: Option<f64>,
    /// Whether the signal's sign is turned.
    turned: bool,
}

impl Yardstick {
    /// For a diagnosis of `model`; none if numbers aren't finite.
    pub fn of_model(model: &Model, campaign: &Campaign) -> Option<Self> {
        let expressions: Vec<&str> = model.effects.iter().filter_map(|effect| effect.expression.as_deref()).collect();
        Self::new(campaign, Some(reach(model)), &expressions)
    }

    /// For training: signals rise with references, and mostly lie above zero, as far as that is a matter of sign.
    pub fn of_training(
        campaign: &Campaign,
        scale_factor_hz_per_g: Option<f64>,
        effects: &[EffectChoice],
    ) -> Option<Self> {
        let reach = scale_factor_hz_per_g.map(|stated| half_span(campaign, signal) / stated.abs());
        let expressions: Vec<&str> = effects.iter().filter_map(|choice| choice.expression.as_deref()).collect();
        let mut yardstick = Self::new(campaign, reach, &expressions)?;
        if expressions.is_empty() {
            let rises = scale_factor_hz_per_g.unwrap_or_else(|| covariance(campaign)) >= 0.0;
            let is_above = middle(campaign, signal) >= 0.0;
            let (turned, negated) = match (rises, is_above) {
                (true, true) => (false, false),
                (true, false) => (true, true),
                (false, true) => (false, true),
                (false, false) => (true, false),
            };
            yardstick.turned = turned;
            yardstick.factor *= if negated { -1.0 } else { 1.0 };
        }
        Some(yardstick)
    }

    /// `reach` is how far the reading goes to either side.
    fn new(campaign: &Campaign, reach: Option<f64>, expressions: &[&str]) -> Option<Self> {
        let per_g = units_per_g(&campaign.quantity.reference_unit);
        let half = half_span(campaign, |row| row.reference_g);
        let factor = if expressions.iter().any(|text| reads_level(text)) {
            // A formula of the level is made for the campaign's own units.
            1.0
        } else if let Some(reach) = reach.filter(|reach| *reach > 0.0 && half <= STILL * reach) {
            DRIFT_G / reach
        } else {
            match per_g {
                Some(per_g) if ORDINARY_G.contains(&(half / per_g)) => per_g.recip(),
                // Nothing to measure with.
                _ if half == 0.0 => 1.0,
                _ => half.recip(),
            }
        };
        let usable = |factor: f64| factor.is_finite() && factor > 0.0 && factor.recip().is_finite();
        usable(factor).then_some(Self { factor, gravity: per_g.map(|per_g| per_g * factor), turned: false })
    }

    /// The campaign in the units of the work.
    pub fn campaign<'a>(&self, campaign: &'a Campaign) -> Cow<'a, Campaign> {
        if self.factor.to_bits() == 1.0_f64.to_bits() && !self.turned {
            return Cow::Borrowed(campaign);
        }
        let mut scaled = campaign.clone();
        for row in scaled.runs.iter_mut().flat_map(|run| &mut run.rows) {
            row.reference_g = self.reference(row.reference_g);
            row.reference_sigma_g = row.reference_sigma_g.map(|sigma| sigma * self.factor.abs());
            if self.turned {
                row.sample.delta_f_uhz = row.sample.delta_f_uhz.saturating_neg();
            }
        }
        Cow::Owned(scaled)
    }

    /// The same for what is in g, whatever the campaign's unit; none of what is no acceleration.
    pub fn of_g(&self) -> Option<Self> {
        Some(Self { factor: self.gravity?, ..*self })
    }

    /// A reference in the units of the work.
    pub fn reference(&self, value: f64) -> f64 {
        // Adding zero turns −0 into 0.
        value * self.factor + 0.0
    }

    /// What a reading of the campaign's units is multiplied with.
    pub fn factor(&self) -> f64 {
        self.factor
    }

    /// Whether the signal's sign is turned.
    pub fn is_turned(&self) -> bool {
        self.turned
    }

    /// A size in the campaign's units.
    pub fn outside(&self, size: f64) -> f64 {
        size / self.factor.abs()
    }

    /// A size in the units of the work.
    pub fn inside(&self, size: f64) -> f64 {
        size * self.factor.abs()
    }

    /// An effect's coefficients in the units of the work.
    pub fn coefficients_inside(&self, about: &About, values: &[f64]) -> Vec<f64> {
        self.converted(about, values, self.factor)
    }

    /// And back.
    pub fn coefficients_outside(&self, about: &About, values: &[f64]) -> Vec<f64> {
        self.converted(about, values, self.factor.recip())
    }

    /// One coefficient, or its uncertainty, in the units of the work.
    pub fn coefficient_inside(&self, about: &About, name: &str, value: f64) -> f64 {
        value * self.factor.powi(exponent(about, name))
    }

    /// And back.
    pub fn coefficient_outside(&self, about: &About, name: &str, value: f64) -> f64 {
        value * self.factor.recip().powi(exponent(about, name))
    }

    fn converted(&self, about: &About, values: &[f64], factor: f64) -> Vec<f64> {
        let pairs = about.parameters.iter().zip(values);
        pairs.map(|(parameter, value)| value * factor.powi(exponent(about, parameter.name)) + 0.0).collect()
    }

    /// A scale factor in the units of the work.
    pub fn scale_factor_inside(&self, stated: f64) -> f64 {
        let sign = if self.turned { -1.0 } else { 1.0 };
        sign * stated / self.factor
    }

    /// Choices whose starts are of the units of the work, in the campaign's.
    pub fn choices_outside(&self, choices: &[EffectChoice]) -> Vec<EffectChoice> {
        self.choices(choices, Self::coefficients_outside)
    }

    /// The other way round.
    pub fn choices_inside(&self, choices: &[EffectChoice]) -> Vec<EffectChoice> {
        self.choices(choices, Self::coefficients_inside)
    }

    fn choices(&self, choices: &[EffectChoice], of: fn(&Self, &About, &[f64]) -> Vec<f64>) -> Vec<EffectChoice> {
        let converted = |choice: &EffectChoice| {
            let about = effect::about(&choice.name);
            let start = choice.start.as_ref().zip(about).map(|(start, about)| of(self, about, start));
            EffectChoice { start: start.or_else(|| choice.start.clone()), ..choice.clone() }
        };
        choices.iter().map(converted).collect()
    }
}

fn signal(row: &Row) -> f64 {
    row.sample.delta_f_uhz as f64 * 1e-6
}

fn ends(campaign: &Campaign, of: impl Fn(&Row) -> f64) -> (f64, f64) {
    campaign
        .rows()
        .map(of)
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), value| (low.min(value), high.max(value)))
}

/// Half of what a column spans; without an overflow.
fn half_span(campaign: &Campaign, of: impl Fn(&Row) -> f64) -> f64 {
    let (low, high) = ends(campaign, of);
    high / 2.0 - low / 2.0
}

fn middle(campaign: &Campaign, of: impl Fn(&Row) -> f64) -> f64 {
    let (low, high) = ends(campaign, of);
    high / 2.0 + low / 2.0
}

/// Of reference and signal, in units of their spans: its sign says whether one rises with the other.
fn covariance(campaign: &Campaign) -> f64 {
    let of_reference = |row: &Row| row.reference_g;
    let (middle_g, middle_hz) = (middle(campaign, of_reference), middle(campaign, signal));
    let (half_g, half_hz) = (half_span(campaign, of_reference), half_span(campaign, signal));
    if !(half_g > 0.0 && half_hz > 0.0) {
        return 0.0;
    }
    let pair = |row: &Row| [(of_reference(row) - middle_g) / half_g, (signal(row) - middle_hz) / half_hz];
    let count = campaign.row_count().max(1) as f64;
    let [mean_g, mean_hz] =
        campaign.rows().map(pair).fold([0.0; 2], |sum, pair| [0, 1].map(|i| sum[i] + pair[i] / count));
    campaign.rows().map(pair).map(|[a, b]| (a - mean_g) * (b - mean_hz)).sum()
}

/// Whether a formula is made for the units of the reference.
fn reads_level(text: &str) -> bool {
    text.contains("level_g")
}
