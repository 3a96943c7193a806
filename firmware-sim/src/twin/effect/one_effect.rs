//! One effect for its unit test: conditions by hand, no laboratory around it.

use super::{Effect, Setting, Switch};
use crate::twin::conditions::{Conditions, Input};
use crate::twin::position::Position;
use crate::twin::rig::Rig;
use crate::twin::static_map::StaticMap;
use crate::twin::truth::Truth;

/// One effect on the nominal device, at 25 °C and 0 g, switched on a moment ago.
pub(crate) struct OneEffect {
    pub effect: Box<dyn Effect>,
    pub now: Conditions,
    map: StaticMap,
}

/// What the effect does to the nominal device.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Seen {
    /// Reading of a perfect static compensation minus what is applied, µg.
    pub bias_ug: f64,
    /// Shift of the forks' mean frequency, Hz.
    pub mean_hz: f64,
    /// Shift of their difference, Hz.
    pub delta_hz: f64,
}

impl OneEffect {
    pub fn new(parameters: &impl Switch) -> Self {
        let (truth, rig) = (Truth::b(), Rig::default());
        let map = StaticMap::new(&truth);
        let mut effect = parameters.start(&Setting { truth: &truth, map: &map, rig: &rig, seed: 1 });
        effect.begin_run();
        let now = Conditions {
            time_s: 0.0,
            age_days: 0.0,
            power_on_s: Some(0.0),
            sensor_c: 25.0,
            sensor_before_c: 25.0,
            sensor_rate_c_per_s: 0.0,
            position: Position::tumble(0.0),
            applied_g: 0.0,
            pose: 0,
            supply_v: truth.supply_v,
            vibration_g2: 0.0,
            pressure_pa: rig.pressure_pa,
            humidity_pct: rig.humidity_pct,
        };
        Self { effect, now, map }
    }

    /// Turns the device; no time passes.
    pub fn apply(&mut self, angle_deg: f64) {
        self.now.position = Position::tumble(angle_deg);
        self.now.applied_g = self.now.position.input_g;
    }

    /// Lets time pass at constant temperature.
    pub fn pass(&mut self, seconds: f64) {
        self.ramp(0.0, seconds);
    }

    /// Lets the temperature change steadily, in steps of at most a second.
    pub fn ramp(&mut self, change_c: f64, seconds: f64) {
        let steps = seconds.ceil().max(1.0);
        for _ in 0..steps as u64 {
            let dt_s = seconds / steps;
            self.now.time_s += dt_s;
            self.now.age_days += dt_s / 86_400.0;
            self.now.power_on_s = self.now.power_on_s.map(|on_s| on_s + dt_s);
            self.now.sensor_before_c = self.now.sensor_c;
            self.now.sensor_c += change_c / steps;
            self.now.sensor_rate_c_per_s = change_c / seconds;
            self.effect.advance(&self.now, dt_s);
        }
    }

    /// What the effect does now.
    pub fn look(&self) -> Seen {
        let plain = Input::undisturbed(&self.now);
        let mut input = plain;
        self.effect.act(&self.now, &mut input);
        let (without, mut with) = (plain.forks(&self.map), input.forks(&self.map));
        self.effect.pull(&self.now, &mut with);
        let reading_g = self.map.acceleration_g(with.delta_hz(), self.now.sensor_c);
        let (shift1, shift2) = (with.f1_hz - without.f1_hz, with.f2_hz - without.f2_hz);
        Seen {
            bias_ug: (reading_g - self.now.applied_g) * 1e6,
            mean_hz: f64::midpoint(shift1, shift2),
            delta_hz: shift1 - shift2,
        }
    }
}
