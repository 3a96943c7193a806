//! How good a compensation can be: the residual of a single sample behind a perfect static compensation.
//!
//! Apart from the noise because it is computed from the parameters alone: the simulation is tested against it.

use crate::twin::noise::Noise;
use crate::twin::rig::{ARCSEC, Rig};
use crate::twin::static_map::StaticMap;
use crate::twin::thermometer;
use crate::twin::truth::Truth;

/// The parts of the residual of one sample, each µg (1σ).
///
/// [`NoiseFloor::noise_ug`] is what no compensation removes. The setup parts are errors of the reference or change from
/// run to run; they are stated apart because they are not noise: they hold still for a pose, a node or a run.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct NoiseFloor {
    /// White noise N of one gate.
    pub white_ug: f64,
    /// Quantisation noise Q of one gate.
    pub quantization_ug: f64,
    /// Steps of the counter, both forks.
    pub counter_ug: f64,
    /// Noise and steps of the thermometer through the bias's temperature sensitivity.
    pub thermometer_ug: f64,
    /// Flicker noise B, all that a run can hold.
    pub flicker_ug: f64,
    /// Random walk K since the run began.
    pub random_walk_ug: f64,
    /// Ramp R since the run began.
    pub ramp_ug: f64,
    /// Setup: random error of the dividing head and its zero.
    pub table_ug: f64,
    /// Setup: tilt of the mounting.
    pub mount_ug: f64,
    /// Setup: scatter from node to node.
    pub node_ug: f64,
    /// Setup: bias that differs from turn-on to turn-on.
    pub turn_on_ug: f64,
}

/// The sample for which the floor is asked.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SampleAt {
    /// Acceleration, g.
    pub acceleration_g: f64,
    /// Temperature, °C.
    pub temperature_c: f64,
    /// Change of the input for a small turn of the rig, g/rad.
    pub tilt_g_per_rad: f64,
    /// Time since the run began, s.
    pub time_s: f64,
}

impl NoiseFloor {
    /// The floor of one sample.
    #[must_use]
    pub fn of_sample(map: &StaticMap, noise: &Noise, rig: &Rig, turn_on_ug: f64, at: SampleAt) -> Self {
        let delta_f_hz = map.delta_f_hz(at.acceleration_g, at.temperature_c);
        let ug_per_hz = map.slope_g_per_hz(delta_f_hz, at.temperature_c) * 1e6;
        let ug_per_k = map.slope_g_per_c(delta_f_hz, at.temperature_c).abs() * 1e6;
        let [step1_hz, step2_hz] =
            map.forks_hz(at.acceleration_g, at.temperature_c).map(|hz| noise.counter().step_hz(hz) / 12.0_f64.sqrt());
        let tilt_ug_per_arcsec = ARCSEC * at.tilt_g_per_rad.abs() * 1e6;
        Self {
            white_ug: noise.white_ug_sqrt_s / noise.gate_s.sqrt(),
            quantization_ug: noise.quantization_ug_s * std::f64::consts::SQRT_2 / noise.gate_s,
            counter_ug: step1_hz.hypot(step2_hz) * ug_per_hz,
            thermometer_ug: thermometer::sigma_k(noise) * ug_per_k,
            flicker_ug: noise.flicker_variance_ug2().sqrt(),
            random_walk_ug: noise.random_walk_ug_per_sqrt_s * at.time_s.sqrt(),
            ramp_ug: noise.ramp_ug_per_s * at.time_s,
            table_ug: rig.table_arcsec.hypot(rig.table_zero_arcsec) * tilt_ug_per_arcsec,
            mount_ug: rig.mount_arcsec * tilt_ug_per_arcsec,
            node_ug: rig.node_scatter_ug,
            turn_on_ug,
        }
    }

    /// All noise of device and instrument together, µg.
    #[must_use]
    pub fn noise_ug(&self) -> f64 {
        let Self { white_ug, quantization_ug, counter_ug, thermometer_ug, flicker_ug, random_walk_ug, ramp_ug, .. } =
            *self;
        root_sum([white_ug, quantization_ug, counter_ug, thermometer_ug, flicker_ug, random_walk_ug, ramp_ug])
    }

    /// All errors of the setup together, µg.
    #[must_use]
    pub fn setup_ug(&self) -> f64 {
        root_sum([self.table_ug, self.mount_ug, self.node_ug, self.turn_on_ug])
    }

    /// Noise and setup together, µg.
    #[must_use]
    pub fn total_ug(&self) -> f64 {
        self.noise_ug().hypot(self.setup_ug())
    }

    /// The root mean square of many floors, part by part.
    #[must_use]
    pub fn mean(floors: impl IntoIterator<Item = Self>) -> Self {
        let (mut sum, mut count) = ([0.0; PARTS], 0.0);
        for floor in floors {
            sum.iter_mut().zip(floor.parts()).for_each(|(sum, part)| *sum += part * part);
            count += 1.0;
        }
        Self::from_parts(sum.map(|sum| (sum / f64::max(count, 1.0)).sqrt()))
    }

    fn parts(&self) -> [f64; PARTS] {
        [
            self.white_ug,
            self.quantization_ug,
            self.counter_ug,
            self.thermometer_ug,
            self.flicker_ug,
            self.random_walk_ug,
            self.ramp_ug,
            self.table_ug,
            self.mount_ug,
            self.node_ug,
            self.turn_on_ug,
        ]
    }

    fn from_parts(parts: [f64; PARTS]) -> Self {
        let [
            white_ug,
            quantization_ug,
            counter_ug,
            thermometer_ug,
            flicker_ug,
            random_walk_ug,
            ramp_ug,
            table_ug,
            mount_ug,
            node_ug,
            turn_on_ug,
        ] = parts;
        Self {
            white_ug,
            quantization_ug,
            counter_ug,
            thermometer_ug,
            flicker_ug,
            random_walk_ug,
            ramp_ug,
            table_ug,
            mount_ug,
            node_ug,
            turn_on_ug,
        }
    }
}

const PARTS: usize = 11;

fn root_sum<const N: usize>(parts: [f64; N]) -> f64 {
    parts.iter().map(|part| part * part).sum::<f64>().sqrt()
}

/// Root mean square of the residual of a single sample behind a perfect static compensation, with a perfect rig, over a
/// run of `run_length_s` at 0 g and the reference temperature, µg.
#[must_use]
pub fn noise_floor_ug(truth: &Truth, noise: &Noise, run_length_s: f64) -> f64 {
    let at = SampleAt {
        acceleration_g: 0.0,
        temperature_c: truth.reference_temperature_c,
        tilt_g_per_rad: 1.0,
        time_s: run_length_s,
    };
    let end = NoiseFloor::of_sample(&StaticMap::new(truth), noise, &Rig::default(), 0.0, at);
    // Over a run, the walk's variance is half of that at the end, the ramp's square a third.
    let over_run = NoiseFloor {
        random_walk_ug: end.random_walk_ug / 2.0_f64.sqrt(),
        ramp_ug: end.ramp_ug / 3.0_f64.sqrt(),
        ..end
    };
    over_run.noise_ug()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_nominal_floor_is_the_worked_one() {
        let floor = noise_floor_ug(&Truth::b(), &Noise::default(), 3600.0);
        // Worked: 5.5 µg of scatter about the mean of an isothermal hour. Here the mean counts too: the flicker noise
        // that is slower than the hour, and where the random walk has gone.
        let worked = [4.0, 2.02, 1.84, 3.15, 0.04 * 1800.0_f64.sqrt()];
        assert!((floor - root_sum(worked)).abs() < 0.02, "{floor}");
    }

    #[test]
    fn the_counter_contributes_the_worked_two_micro_g() {
        let at = SampleAt { acceleration_g: 0.0, temperature_c: 25.0, tilt_g_per_rad: 1.0, time_s: 0.0 };
        let map = StaticMap::new(&Truth::b());
        let floor = NoiseFloor::of_sample(&map, &Noise::default(), &Rig::default(), 0.0, at);
        assert!((floor.counter_ug - 2.02).abs() < 0.01, "{}", floor.counter_ug);
        assert!((floor.thermometer_ug - 1.84).abs() < 0.01, "{}", floor.thermometer_ug); // 2.02 mK · 0.912 mg/K
    }

    #[test]
    fn parts_survive_averaging() {
        let floor = NoiseFloor { white_ug: 4.0, node_ug: 25.0, ..NoiseFloor::default() };
        let mean = NoiseFloor::mean([floor, floor]);
        assert_eq!((mean.noise_ug(), mean.setup_ug()), (4.0, 25.0));
    }
}
