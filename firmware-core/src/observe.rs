//! From raw integers to the numbers that formulas use.

use crate::network::{Network, ordered};
use crate::real::Real;
use protocol::limits::MAX_CHANNELS;
use protocol::{Sample, Scaling, Status};

/// Everything that a formula may look at, of one instant.
#[derive(Clone, Copy, Debug)]
pub struct Observation<R> {
    /// Frequency difference from the calibration's zero, Hz. Subtracted as integers.
    pub delta_f_offset_hz: R,
    /// Frequency difference, Hz.
    pub delta_f_hz: R,
    /// Temperature from the calibration's zero, °C. Subtracted as integers.
    pub temperature_offset_c: R,
    /// Temperature, °C.
    pub temperature_c: R,
    /// Time since power-on, s.
    pub power_on_s: R,
    /// Calendar age, days; zero where it is unknown.
    pub age_days: R,
    /// Auxiliary channels in their units.
    pub channels: [R; MAX_CHANNELS],
}

impl<R: Real> Observation<R> {
    /// What `sample` shows, measured from the zeros of `scaling`.
    #[must_use]
    pub fn new(sample: &Sample, scaling: &Scaling) -> Self {
        let delta_f_offset_uhz = sample.delta_f_uhz.saturating_sub(scaling.delta_f_zero_uhz);
        let temperature_offset_uc = i64::from(sample.temperature_uc) - i64::from(scaling.temperature_zero_uc);
        let microseconds = i64::try_from(sample.power_on_us).unwrap_or(i64::MAX);
        Self {
            delta_f_offset_hz: R::from_micro(delta_f_offset_uhz),
            delta_f_hz: R::from_micro(sample.delta_f_uhz),
            temperature_offset_c: R::from_micro(temperature_offset_uc),
            temperature_c: R::from_micro(i64::from(sample.temperature_uc)),
            power_on_s: R::from_micro(microseconds),
            age_days: R::from_i64(i64::from(sample.age_s.unwrap_or(0))) * (R::ONE / R::from_f32(86_400.0)),
            channels: sample.channels.map(R::from_micro),
        }
    }
}

/// The input gains and the first-order instrument of a [`Scaling`].
#[derive(Clone, Copy, Debug)]
pub struct Scale<R> {
    x_per_hz: R,
    t_per_c: R,
    line_g: [R; 4],
    output_g: R,
}

impl<R: Real> Scale<R> {
    /// Reads the scaling.
    #[must_use]
    pub fn new(scaling: &Scaling) -> Self {
        Self {
            x_per_hz: R::from_f32(scaling.delta_f_gain_per_hz),
            t_per_c: R::from_f32(scaling.temperature_gain_per_c),
            line_g: scaling.line_g.map(R::from_f32),
            output_g: R::from_f32(scaling.output_g),
        }
    }

    /// The network's inputs (x, t) at these offsets from the zeros.
    pub fn inputs(&self, delta_f_offset_hz: R, temperature_offset_c: R) -> [R; 2] {
        [delta_f_offset_hz * self.x_per_hz, temperature_offset_c * self.t_per_c]
    }

    /// The static reading in g: the first-order instrument and the network's share.
    pub fn reading_g(&self, x: R, t: R, network: R) -> R {
        let [constant, by_x, by_t, by_xt] = self.line_g;
        constant + by_x * x + by_t * t + by_xt * (x * t) + self.output_g * network
    }

    /// Bounds of the static reading's derivative by x, g, while the inputs stay within these (each lowest, highest).
    pub fn slope_within(&self, network: &Network<R>, x: [R; 2], t: [R; 2]) -> [R; 2] {
        let [_, by_x, _, by_xt] = self.line_g;
        let [least, most] = ordered(t.map(|t| by_x + by_xt * t));
        let [low, high] = ordered(network.slope_within(x, t).map(|slope| self.output_g * slope));
        [least + low, most + high]
    }
}

/// Keeps time between samples.
#[derive(Clone, Copy, Debug)]
pub struct Clock {
    max_gap_us: u64,
    last: Option<Sample>,
    /// From the sample before the last to the last.
    last_gap_us: u64,
}

/// A longest gap of more than an hour and eleven minutes has no room in a calibration: it stands for any.
const ANY_GAP_US: u64 = u32::MAX as u64;
/// So many times the interval before make an interval a pause.
const PAUSE: u64 = 3;

/// What happened since the previous sample.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Step {
    /// There is none, or it is too long ago: start anew.
    Anew,
    /// Time stood still or ran backwards: keep the state.
    Held,
    /// So many µs went by.
    Forward(u64),
    /// So many µs went by, many more than between the samples before: nobody looked.
    Paused(u64),
}

impl Clock {
    /// A clock that calls samples more than `max_gap_us` apart unrelated; with the largest value none that comes later.
    #[must_use]
    pub const fn new(max_gap_us: u32) -> Self {
        Self { max_gap_us: max_gap_us as u64, last: None, last_gap_us: u64::MAX }
    }

    /// Forgets the previous sample.
    pub const fn restart(&mut self) {
        self.last = None;
    }

    /// The sample that time is measured from.
    pub const fn last(&self) -> Option<&Sample> {
        self.last.as_ref()
    }

    /// The step from the last sample to this one, and what to flag. [`Clock::pass`] takes it.
    pub fn step(&self, sample: &Sample) -> (Step, Status) {
        let Some(last) = &self.last else {
            return (Step::Anew, Status::empty());
        };
        let gap_us = sample.time_us.abs_diff(last.time_us);
        let forward = sample.time_us > last.time_us;
        let related = forward && self.max_gap_us == ANY_GAP_US;
        match (forward, gap_us > self.max_gap_us && !related) {
            (true, false) if gap_us / PAUSE > self.last_gap_us => (Step::Paused(gap_us), Status::empty()),
            (true, false) => (Step::Forward(gap_us), Status::empty()),
            (true, true) => (Step::Anew, Status::STALE),
            (false, false) => (Step::Held, Status::TIME_REVERSED),
            // The clock itself was set back: waiting for it to catch up would take for ever.
            (false, true) => (Step::Anew, Status::TIME_REVERSED),
        }
    }

    /// Measures from this sample on, which is `step` from the last.
    pub fn pass(&mut self, sample: &Sample, step: Step) {
        self.last_gap_us = match step {
            // A sample out of order: the later of the two remains the one to measure from.
            Step::Held => return,
            Step::Forward(gap_us) | Step::Paused(gap_us) => gap_us,
            Step::Anew => u64::MAX,
        };
        self.last = Some(*sample);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn with_the_largest_gap_whatever_comes_later_is_a_pause_and_a_clock_set_back_still_starts_anew() {
        let mut clock = Clock::new(u32::MAX);
        let hour_us = 3_600_000_000;
        let table = [
            (100 * hour_us, Step::Anew, Status::empty()),
            (100 * hour_us + 1000, Step::Forward(1000), Status::empty()),
            (103 * hour_us + 1000, Step::Paused(3 * hour_us), Status::empty()),
            (102 * hour_us + 1000, Step::Held, Status::TIME_REVERSED),
            (hour_us, Step::Anew, Status::TIME_REVERSED),
        ];
        for (time_us, step, status) in table {
            let sample = Sample::from_difference(time_us, 0, 0);
            assert_eq!(clock.step(&sample), (step, status), "at {time_us} µs");
            clock.pass(&sample, step);
        }
    }

    #[test]
    fn the_clock_tells_samples_pauses_and_beginnings_apart() {
        let mut clock = Clock::new(100);
        let table = [
            (1000, Step::Anew, Status::empty()),
            // Nothing to compare the first interval with.
            (1020, Step::Forward(20), Status::empty()),
            (1021, Step::Forward(1), Status::empty()),
            (1024, Step::Forward(3), Status::empty()),
            (1036, Step::Paused(12), Status::empty()),
            // A slower pace is a pause once.
            (1048, Step::Forward(12), Status::empty()),
            (1048, Step::Held, Status::TIME_REVERSED),
            (1040, Step::Held, Status::TIME_REVERSED),
            (1100, Step::Paused(52), Status::empty()),
            (1201, Step::Anew, Status::STALE),
            (1301, Step::Forward(100), Status::empty()),
            (1000, Step::Anew, Status::TIME_REVERSED),
            (1090, Step::Forward(90), Status::empty()),
        ];
        for (time_us, step, status) in table {
            let sample = Sample::from_difference(time_us, 0, 0);
            assert_eq!(clock.step(&sample), (step, status), "at {time_us} µs");
            clock.pass(&sample, step);
        }
        clock.restart();
        assert_eq!(clock.step(&Sample::from_difference(1091, 0, 0)).0, Step::Anew);
    }

    fn scaling() -> Scaling {
        Scaling {
            delta_f_zero_uhz: 1_000_000,
            delta_f_gain_per_hz: 2.0,
            temperature_zero_uc: 5_000_000,
            temperature_gain_per_c: 4.0,
            line_g: [1.0, 10.0, 100.0, 1000.0],
            output_g: 0.5,
        }
    }

    #[test]
    fn a_sample_is_seen_in_its_units_and_from_the_zeros_of_the_scaling() {
        let mut sample = Sample::from_difference(0, 3_500_000, 20_000_000);
        (sample.power_on_us, sample.age_s, sample.channels[1]) = (7_000_000, Some(2 * 86_400), -1_500_000);
        let seen: Observation<f64> = Observation::new(&sample, &scaling());
        assert_eq!((seen.delta_f_offset_hz, seen.delta_f_hz), (2.5, 3.5));
        assert_eq!((seen.temperature_offset_c, seen.temperature_c), (15.0, 20.0));
        assert_eq!((seen.power_on_s, seen.channels[1]), (7.0, -1.5));
        assert!((seen.age_days - 2.0).abs() < 1e-12);
    }

    #[test]
    fn the_first_order_instrument_and_the_network_add_up() {
        let scale: Scale<f64> = Scale::new(&scaling());
        assert_eq!(scale.inputs(3.0, 5.0), [6.0, 20.0]);
        assert_eq!(scale.reading_g(2.0, 3.0, 8.0), 1.0 + 20.0 + 300.0 + 6000.0 + 4.0);
    }
}
