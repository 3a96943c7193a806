//! What is measured, and in which units.

/// What is measured. Resonant accelerometers come first; a load cell or a resistor is read in the same way.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Quantity {
    /// Unit of the signal; `Sample::delta_f_uhz` holds millionths of it.
    pub signal_unit: String,
    /// Unit of the reference.
    pub reference_unit: String,
}

impl Default for Quantity {
    fn default() -> Self {
        Self { signal_unit: "Hz".to_owned(), reference_unit: "g".to_owned() }
    }
}

impl Quantity {
    /// The signal's unit as a power of ten of a hertz; none where it is no frequency, or of an unknown prefix.
    #[must_use]
    pub fn power_of_hz(&self) -> Option<i32> {
        Some(match self.signal_unit.strip_suffix("Hz")? {
            "" => 0,
            "G" => 9,
            "M" => 6,
            "k" => 3,
            "m" => -3,
            "µ" | "μ" | "u" => -6,
            "n" => -9,
            _ => return None,
        })
    }

    /// Whether the signal is a frequency, of oscillators that lock and of a counter with a clock.
    #[must_use]
    pub fn is_frequency(&self) -> bool {
        self.signal_unit.ends_with("Hz")
    }
}
