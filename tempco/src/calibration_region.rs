//! Where the device keeps its calibration: read from the linker's own `memory.x`.

/// The linker script that the firmware is linked with.
const MEMORY_X: &str = include_str!("../../memory.x");

/// Origin and length of the region `CALIBRATION`; `None` if the script doesn't name one.
pub fn calibration_region() -> Option<(u32, u32)> {
    let line = MEMORY_X.lines().find(|line| line.trim_start().starts_with("CALIBRATION"))?;
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
    #[test]
    fn the_linker_script_names_the_last_sector_of_the_flash() {
        assert_eq!(super::calibration_region(), Some((0x080E_0000, 128 * 1024)));
    }
}
