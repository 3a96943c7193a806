//! How the device lies in the field of gravity.

use crate::limit::{Fault, not_too_many, within};

/// One pose of the device on the rig, as the rig believes it to be.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Position {
    /// Angle of the tumble: the input axis sees its sine, degrees. Kept for finding a pose again.
    pub angle_deg: f64,
    /// Acceleration along the input axis, g.
    pub input_g: f64,
    /// Acceleration along the pendulous axis, g.
    pub cross_g: f64,
    /// Change of the input for a small turn of the rig, g/rad. Unlike `cross_g` it does not care how the device is
    /// mounted.
    pub tilt_g_per_rad: f64,
}

/// Beyond this a centrifuge is not a calibration rig but a launcher, g.
const CENTRIFUGE_MAX_G: f64 = 100.0;

impl Position {
    /// A pose of the dividing head: the input axis sees the sine, the pendulous axis the cosine.
    #[must_use]
    pub fn tumble(angle_deg: f64) -> Self {
        let (sine, cosine) = angle_deg.to_radians().sin_cos();
        let (sine, cosine) = (exact_zero(sine), exact_zero(cosine));
        Self { angle_deg, input_g: sine, cross_g: cosine, tilt_g_per_rad: cosine }
    }

    /// A level of acceleration: up to 1 g the dividing head makes it, beyond a centrifuge with gravity along the
    /// third axis.
    #[must_use]
    pub fn level(level_g: f64) -> Self {
        if level_g.abs() <= 1.0 {
            return Self { input_g: exact_zero(level_g), ..Self::tumble(level_g.asin().to_degrees()) };
        }
        Self { angle_deg: f64::NAN, input_g: level_g, cross_g: 0.0, tilt_g_per_rad: 0.0 }
    }

    /// The same pose with the device turned about its input axis by `rotation_deg`, 0 or 180.
    #[must_use]
    pub fn mounted(self, rotation_deg: f64) -> Self {
        Self { cross_g: exact_zero(self.cross_g * rotation_deg.to_radians().cos()), ..self }
    }
}

/// Rounds the 10⁻¹⁶ that sine and cosine leave at multiples of 90° to the zero that is meant, never a negative one.
fn exact_zero(value: f64) -> f64 {
    if value.abs() < 1e-12 { 0.0 } else { value }
}

/// `count` poses evenly around the circle, from 0°.
#[must_use]
pub fn around(count: u32) -> Vec<Position> {
    (0..count).map(|i| Position::tumble(360.0 * f64::from(i) / f64::from(count))).collect()
}

/// # Errors
/// Unless every angle lies within one turn and every level within the rig's reach.
pub(crate) fn check(positions_deg: &[f64], levels_g: &[f64]) -> Result<(), Fault> {
    not_too_many("positions_deg", positions_deg)?;
    not_too_many("levels_g", levels_g)?;
    positions_deg.iter().try_for_each(|angle| within("positions_deg", *angle, -360.0, 360.0))?;
    levels_g.iter().try_for_each(|level| within("levels_g", *level, -CENTRIFUGE_MAX_G, CENTRIFUGE_MAX_G))?;
    if positions_deg.is_empty() && levels_g.is_empty() {
        return Err(Fault::new("positions_deg", &"empty", "a list of angles, or `levels_g` a list of accelerations"));
    }
    Ok(())
}

/// The poses of the angles, then of the levels.
pub(crate) fn collect(positions_deg: &[f64], levels_g: &[f64]) -> Vec<Position> {
    let angles = positions_deg.iter().map(|angle| Position::tumble(*angle));
    angles.chain(levels_g.iter().map(|level| Position::level(*level))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_four_positions_are_plus_and_minus_zero_and_one() {
        let seen: Vec<(f64, f64)> = around(4).iter().map(|p| (p.input_g, p.cross_g)).collect();
        assert_eq!(seen, [(0.0, 1.0), (1.0, 0.0), (0.0, -1.0), (-1.0, 0.0)]);
    }

    #[test]
    fn turning_the_device_about_its_input_axis_reverses_the_cross_axis_only() {
        let (up, down) = (Position::tumble(30.0), Position::tumble(30.0).mounted(180.0));
        assert_eq!((down.input_g, down.cross_g, down.tilt_g_per_rad), (up.input_g, -up.cross_g, up.tilt_g_per_rad));
    }

    #[test]
    fn beyond_one_g_a_centrifuge_leaves_no_cross_axis() {
        let position = Position::level(20.0);
        assert_eq!((position.input_g, position.cross_g, position.tilt_g_per_rad), (20.0, 0.0, 0.0));
        assert!(check(&[], &[1000.0]).is_err() && check(&[], &[]).is_err());
    }
}
