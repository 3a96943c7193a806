//! What the rig really applies: the pose that it believes in, and its own errors.

use crate::twin::position::Position;
use crate::twin::random::Random;
use crate::twin::rig::{ARCSEC, Rig};

/// The rig's errors in one run.
#[derive(Clone, Debug)]
pub(crate) struct RigError {
    rig: Rig,
    seed: u64,
    run: u64,
    mount_rad: f64,
    table_rad: f64,
    node_g: f64,
    drawn: Option<(usize, usize)>,
}

impl RigError {
    /// Draws what stays for the whole run.
    pub(crate) fn new(rig: &Rig, seed: u64, run: u64) -> Self {
        let mount_rad = rig.mount_arcsec * ARCSEC * Random::stream(seed, "mount", run).normal();
        Self { rig: rig.clone(), seed, run, mount_rad, table_rad: 0.0, node_g: 0.0, drawn: None }
    }

    /// What the input axis sees in the pose number `pose` at the node number `node`, g.
    pub(crate) fn applied_g(&mut self, position: &Position, pose: usize, node: usize) -> f64 {
        if self.drawn != Some((pose, node)) {
            self.table_rad = self.rig.table_arcsec * ARCSEC * self.draw("table", pose);
            self.node_g = self.rig.node_scatter_ug * 1e-6 * self.draw("node", node);
            self.drawn = Some((pose, node));
        }
        let angle_rad = self.mount_rad + self.table_rad + self.rig.table_zero_arcsec * ARCSEC;
        // The second order matters only where the first vanishes, and is then below 0.1 µg for a minute of arc.
        position.input_g + position.tilt_g_per_rad * angle_rad + self.node_g
    }

    fn draw(&self, purpose: &str, index: usize) -> f64 {
        Random::stream(self.seed, purpose, self.run << 32 | index as u64).normal()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn eight_arc_seconds_are_39_micro_g_at_0_g_and_nothing_at_1_g() {
        let rig = Rig { table_arcsec: 8.0, ..Rig::default() };
        let mut error = RigError::new(&rig, 1, 0);
        let level: Vec<f64> = (0..2000).map(|pose| error.applied_g(&Position::tumble(0.0), pose, 0) * 1e6).collect();
        let rms = (level.iter().map(|x| x * x).sum::<f64>() / 2000.0).sqrt();
        assert!((rms / 38.8 - 1.0).abs() < 0.06, "{rms}"); // 8″ · 4.848 µg/″; four standard errors
        assert_eq!(error.applied_g(&Position::tumble(90.0), 7, 0), 1.0);
    }

    #[test]
    fn a_mounting_tilt_cancels_between_plus_and_minus_zero() {
        let mut error = RigError::new(&Rig { mount_arcsec: 40.0, ..Rig::default() }, 1, 0);
        let [plus, minus] = [0.0, 180.0].map(|angle| error.applied_g(&Position::tumble(angle), 0, 0));
        assert!(plus != 0.0 && (plus + minus).abs() < 1e-15);
    }
}
