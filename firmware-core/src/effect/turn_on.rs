//! Every power-on has a bias of its own.
//!
//! Charges, oscillator amplitudes and mechanical contacts settle a little differently at every start.
//! The offset is constant until the power goes, and drawn anew when it comes back.
//!
//! Nothing that the instrument measures foretells it, so there is no formula here and no instrument
//! computes it: what a device could subtract would be the offset of some other start. It matters on
//! the host, which must not take the offsets of a campaign's runs for a property of the sensor: they
//! are scatter, and their standard deviation is the figure. In use, the one remedy is to read the
//! sensor at a known level after every start and to subtract what it shows.

use super::{About, SumResponse};

/// Number, names, formula, source.
pub const ABOUT: About = About {
    id: 18,
    name: "turn-on",
    summary: "Every power-on brings a bias of its own that nothing foretells; it can be known as scatter, not compensated.",
    equation: "ΔB(run) ~ N(0, σ²)",
    source: "IEEE Std 1293, bias repeatability; Safran MS1000 data sheet",
    parameters: &[],
    channel: None,
    needs_frequency: false,
    sum_response: SumResponse::STRESS,
    needs: "ten or more power-ons at one temperature in one mounting",
};

#[cfg(test)]
mod tests {
    use super::ABOUT;

    #[test]
    fn no_instrument_claims_to_compute_it() {
        assert!(!ABOUT.is_on_device() && ABOUT.parameters.is_empty());
    }
}
