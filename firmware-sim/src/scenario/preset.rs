//! The built-in scenarios.

/// Name and text, in the order in which they are listed.
const PRESETS: [(&str, &str); 8] = [
    ("clean", include_str!("../../scenarios/clean.toml")),
    ("realistic", include_str!("../../scenarios/realistic.toml")),
    ("seed", include_str!("../../scenarios/seed.toml")),
    ("seed-a1", include_str!("../../scenarios/seed-a1.toml")),
    ("seed-a2", include_str!("../../scenarios/seed-a2.toml")),
    ("single-ramp", include_str!("../../scenarios/single-ramp.toml")),
    ("rich", include_str!("../../scenarios/rich.toml")),
    ("ageing", include_str!("../../scenarios/ageing.toml")),
];

pub(super) fn text(name: &str) -> Option<&'static str> {
    PRESETS.iter().find(|(preset, _)| *preset == name).map(|(_, text)| *text)
}

pub(super) fn names() -> impl Iterator<Item = &'static str> {
    PRESETS.iter().map(|(name, _)| *name)
}
