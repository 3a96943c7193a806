//! What is easily taken for what, and the experiment that tells them apart.

use firmware_core::effect;

/// Two effects and the recording that separates them.
const PAIRS: &[(&str, &str, &str)] = &[
    (
        "thermal-lag",
        "thermal-gradient",
        "Ramp at two rates through temperatures where the bias has different slopes, and record f1 and f2: a lag moves their sum, a gradient does not.",
    ),
    (
        "thermal-lag",
        "stress-relaxation",
        "Ramp at 1 and 0.25 °C/min and soak for hours after a large step: a lag is over within minutes, creep is not.",
    ),
    (
        "thermal-gradient",
        "stress-relaxation",
        "Ramp at 1 and 0.25 °C/min and soak for hours after a large step: a gradient ends with the ramp, creep does not.",
    ),
    (
        "thermal-lag",
        "thermal-hysteresis",
        "Ramp the same range at 1 and 0.25 °C/min: the loop of a lag narrows with the rate, that of a hysteresis does not.",
    ),
    (
        "thermal-gradient",
        "thermal-hysteresis",
        "Ramp the same range at 1 and 0.25 °C/min: the loop of a gradient narrows with the rate, that of a hysteresis does not.",
    ),
    (
        "thermal-hysteresis",
        "stress-relaxation",
        "Visit the same nodes from below and from above with soaks of two hours and more: hysteresis stays, creep fades.",
    ),
    (
        "warm-up",
        "self-heating",
        "Cycle the power at three temperatures where the bias has different slopes, after 2 h and after 5 min off, and record f1 and f2: heat moves their sum.",
    ),
    (
        "warm-up",
        "stress-relaxation",
        "Cycle the power at constant temperature: electronics settle anew, creep does not notice.",
    ),
    (
        "self-heating",
        "stress-relaxation",
        "Cycle the power at constant temperature: heat comes anew, creep does not notice.",
    ),
    (
        "misalignment",
        "cross-axis",
        "Tumble in 24 positions in two mountings turned by 180° about the input axis, at two temperatures: the product of both axes belongs to cross-axis, a change with temperature to misalignment.",
    ),
    (
        "misalignment",
        "g-hysteresis",
        "Tumble in random order with a minute of rest: misalignment follows the position, g-hysteresis the position before.",
    ),
    (
        "aging",
        "humidity",
        "Step the humidity by tens of per cent and back, each held for days: ageing does not turn back.",
    ),
    (
        "scale-factor-aging",
        "reference-clock",
        "Record f1 and f2, or their sum: a clock moves the sum by 82 mHz per ppm; or count against a disciplined clock.",
    ),
    (
        "lock-in",
        "mode-crossing",
        "Tumble in 24 positions through a frequency difference of zero at two temperatures: lock-in sits at zero difference, a mode crossing at a temperature.",
    ),
];

/// The experiment that tells the two apart.
pub fn separate(one: &str, other: &str) -> String {
    let known = PAIRS.iter().find(|(a, b, _)| (*a == one && *b == other) || (*a == other && *b == one));
    known.map_or_else(|| needs(one, other), |(_, _, how)| (*how).to_owned())
}

fn needs(one: &str, other: &str) -> String {
    let of = |name: &str| effect::about(name).map_or("", |about| about.needs);
    format!("Record what shows {one} ({}) and, apart from it, what shows {other} ({}).", of(one), of(other))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_name_is_an_effect_and_order_does_not_matter() {
        for (one, other, how) in PAIRS {
            assert!(effect::about(one).is_some() && effect::about(other).is_some(), "{one}, {other}");
            assert_eq!(separate(other, one), *how);
        }
        assert!(separate("pressure", "aging").contains("pressure_pa"));
    }
}
