//! Where the device keeps what: read from the linker's own `memory.x`.

use crate::failure::Failure;

/// The linker script that the firmware is linked with.
const MEMORY_X: &str = include_str!("../../memory.x");

/// Origin and length of both slots for calibrations.
pub fn calibration() -> Result<(u32, u32), Failure> {
    region("CALIBRATION")
}

/// Origin and length of the record of who the sensor is.
pub fn identity() -> Result<(u32, u32), Failure> {
    region("IDENTITY")
}

fn region(name: &str) -> Result<(u32, u32), Failure> {
    named(name).ok_or_else(|| Failure::new(format_args!("memory.x names no {name} region")))
}

fn named(region: &str) -> Option<(u32, u32)> {
    let line = MEMORY_X.lines().find(|line| line.trim_start().starts_with(region))?;
    let field = |name: &str| {
        let (_, rest) = line.split_once(name)?;
        let text = rest.trim_start().strip_prefix('=')?.trim_start();
        number(text.split([',', ' ', '/']).next()?.trim())
    };
    Some((field("ORIGIN")?, field("LENGTH")?))
}

fn number(text: &str) -> Option<u32> {
    if let Some(hex) = text.strip_prefix("0x") {
        return u32::from_str_radix(&hex.replace('_', ""), 16).ok();
    }
    match text.strip_suffix('K') {
        Some(kilo) => kilo.parse::<u32>().ok()?.checked_mul(1024),
        None => text.parse().ok(),
    }
}

#[cfg(test)]
mod tests {
    use super::named;

    #[test]
    fn the_linker_script_names_the_last_sectors_of_the_flash() {
        assert_eq!(named("CALIBRATION"), Some((0x080C_0000, 256 * 1024)));
        assert_eq!(named("IDENTITY"), Some((0x080A_0000, 128 * 1024)));
        assert_eq!(named("NOTHING"), None);
    }
}
