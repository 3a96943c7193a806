//! What a sensor truly does, for judging. The trainer knows no simulator: whoever has one hands it over.

/// A sensor without noise, lag or memory, known exactly.
pub trait Truth: Sync {
    /// Frequency difference at an acceleration in g and a temperature in °C, Hz.
    fn delta_f_hz(&self, acceleration_g: f64, temperature_c: f64) -> f64;

    /// The acceleration at which that difference arises, g: what a perfect static compensation reads.
    fn acceleration_g(&self, delta_f_hz: f64, temperature_c: f64) -> f64;
}
