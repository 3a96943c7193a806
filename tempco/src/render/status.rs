//! The flags of a reading in words.

use protocol::Status;

/// What each flag says, in the order of their bits.
const WORDS: [(Status, &str); 9] = [
    (Status::UNCALIBRATED, "uncalibrated"),
    (Status::TEMPERATURE_OUTSIDE, "temperature outside the calibrated range"),
    (Status::FREQUENCY_OUTSIDE, "frequency outside the calibrated range"),
    (Status::STALE, "stale"),
    (Status::TIME_REVERSED, "time ran backwards"),
    (Status::THERMOMETER_FAULT, "thermometer fault"),
    (Status::RESONATOR_FAULT, "resonator fault"),
    (Status::CHANNEL_MISSING, "a channel is missing"),
    (Status::SETTLING, "settling"),
];

/// Every raised flag, or "good".
pub fn words(status: Status) -> String {
    let raised = WORDS.iter().filter(|(flag, _)| status.contains(*flag)).map(|(_, words)| *words);
    let unknown = (!Status::all().contains(status)).then_some("a flag that this version doesn't know");
    let words: Vec<&str> = raised.chain(unknown).collect();
    if words.is_empty() { "good".to_owned() } else { words.join(", ") }
}

/// The names of the raised flags, for programs.
pub fn names(status: Status) -> Vec<String> {
    status.iter_names().map(|(name, _)| name.to_lowercase().replace('_', "-")).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_flag_has_its_words() {
        for (name, flag) in Status::all().iter_names() {
            assert!(!["good", ""].contains(&words(flag).as_str()), "{name}");
        }
        assert_eq!(words(Status::empty()), "good");
        assert_eq!(words(Status::STALE | Status::RESONATOR_FAULT), "stale, resonator fault");
        assert_eq!(words(Status::from_bits_retain(1 << 15)), "a flag that this version doesn't know");
        assert_eq!(names(Status::STALE | Status::RESONATOR_FAULT), ["stale", "resonator-fault"]);
    }
}
