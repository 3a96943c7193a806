//! What a person should know of an effect, and a fit of its coefficients.

/// What a person should know of an effect. The device never links this.
#[derive(Clone, Copy, Debug)]
pub struct About {
    /// Its number on the wire. Released numbers keep their formula for ever.
    pub id: u16,
    /// Its name on the command line, in model files and in reports.
    pub name: &'static str,
    /// What happens, in a sentence or two of plain language.
    pub summary: &'static str,
    /// The formula.
    pub equation: &'static str,
    /// Where the formula comes from.
    pub source: &'static str,
    /// Its coefficients in order.
    pub parameters: &'static [Parameter],
    /// The auxiliary channel that it follows, if any.
    pub channel: Option<&'static str>,
    /// Whether only a signal that is a frequency can have it: what locks in, or is counted with a clock.
    pub needs_frequency: bool,
    /// What it does to the sum of the frequencies.
    pub sum_response: SumResponse,
    /// What a campaign must contain to show it.
    pub needs: &'static str,
}

impl About {
    /// Whether an instrument can take the effect out. One that is new at every start can be known, not predicted:
    /// it has no coefficients.
    #[must_use]
    pub const fn is_on_device(&self) -> bool {
        !self.parameters.is_empty()
    }

    /// Whether its formula is a user's own expression.
    #[must_use]
    pub fn takes_program(&self) -> bool {
        self.name == "expression"
    }
}

/// One coefficient of an effect.
#[derive(Clone, Copy, Debug)]
pub struct Parameter {
    /// Its name, with the unit at the end.
    pub name: &'static str,
    /// Its unit.
    pub unit: &'static str,
    /// How a fit treats it.
    pub role: Role,
    /// Where a fit starts.
    pub start: f64,
    /// The least value that makes physical sense.
    pub low: f64,
    /// The greatest value that makes physical sense.
    pub high: f64,
    /// What sensors of this kind have: a plan takes it where no measurement says better.
    pub typical: f64,
    /// At which of the bounds the formula has a limit that makes sense: a fit that ends there is none that was stopped.
    pub sound_limit: SoundLimit,
    /// With which power of the reference's unit it goes: 1 for what adds to the reading, −1 for what is multiplied with
    /// the square of a level, 0 for what has nothing to do with it.
    pub follows_reference: i32,
}

/// Bounds at which a formula has a limit that makes sense: a rate not smoothed, a drift that does not end.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SoundLimit {
    /// At neither: what ends there is something else.
    Neither,
    /// At the lower one.
    Low,
    /// At the upper one.
    High,
    /// At both.
    Both,
}

impl SoundLimit {
    /// Whether the lower bound is one.
    #[must_use]
    pub const fn is_low(self) -> bool {
        matches!(self, Self::Low | Self::Both)
    }

    /// Whether the upper bound is one.
    #[must_use]
    pub const fn is_high(self) -> bool {
        matches!(self, Self::High | Self::Both)
    }
}

/// What an effect does to the sum of the frequencies.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum SumResponse {
    /// What it does to temperature and difference predicts it: warmer resonators, another clock.
    Predicted,
    /// In proportion to its bias, by at most so many times what the difference moves.
    Free(f64),
}

impl SumResponse {
    /// Heat between the forks moves the sum by less than the difference.
    pub const GRADIENT: Self = Self::Free(2.0);
    /// Drive, charge and electronics move the sum ten times as much as the difference.
    pub const ELECTRONICS: Self = Self::Free(40.0);
    /// Stress of the package moves the sum up to a hundred times as much as the difference.
    pub const STRESS: Self = Self::Free(400.0);

    /// Whether the effect predicts the sum.
    #[must_use]
    pub const fn is_predicted(self) -> bool {
        matches!(self, Self::Predicted)
    }
}

/// How a fit treats a coefficient.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Role {
    /// The effect is proportional to it and vanishes with it.
    Amplitude,
    /// It shapes the effect: a time constant or a width, positive, searched on a logarithmic scale.
    Shape,
    /// Where the effect's channel counts from. A fit can't tell it from the bias: the channel's mean is taken.
    Origin,
    /// Where on an axis the effect sits: of either sign, searched on a linear scale.
    Location,
}
