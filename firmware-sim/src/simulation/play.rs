//! Plays runs: the one loop in which everything is stepped and sampled.

use super::error::SimulateError;
use super::ticker::Ticker;
use crate::recording::{RecordedRun, Row, RowTruth, micro};
use crate::scenario::Scenario;
use crate::scenario::programme::Segment;
use crate::scenario::timeline::PlannedRun;
use crate::twin::conditions::{Conditions, DAY_S, Forks, Input};
use crate::twin::effect::{Effect, Setting};
use crate::twin::noise::ForkNoise;
use crate::twin::noise_floor::{NoiseFloor, SampleAt};
use crate::twin::random::Random;
use crate::twin::rig_error::RigError;
use crate::twin::static_map::StaticMap;
use crate::twin::thermal::Thermal;
use crate::twin::thermometer;

/// The device in its laboratory, at one instant of its life.
pub(super) struct Twin<'a> {
    scenario: &'a Scenario,
    seed: u64,
    map: StaticMap,
    thermal: Thermal,
    effects: Vec<Box<dyn Effect>>,
    /// Time since the device was built, s.
    now_s: f64,
    runs: u64,
}

/// What exists only while a run is played.
struct Session<'a> {
    planned: &'a PlannedRun<'a>,
    rig: RigError,
    forks: [ForkNoise; 2],
    thermometer: Random,
    power_on_since_s: Option<f64>,
}

impl<'a> Twin<'a> {
    pub(super) fn new(scenario: &'a Scenario, seed: u64) -> Self {
        let map = StaticMap::new(&scenario.device);
        let setting = Setting { truth: &scenario.device, map: &map, rig: &scenario.rig, seed };
        let effects = scenario.effects.start(&setting);
        let thermal = Thermal::new(&scenario.device, &scenario.rig);
        Self { scenario, seed, map, thermal, effects, now_s: 0.0, runs: 0 }
    }

    /// Lets the device rest in the room, unpowered. The steps grow with the time passed, as everything then slows down.
    pub(super) fn rest_until(&mut self, then_s: f64) {
        let rest = self.resting();
        let began_s = self.now_s;
        while self.now_s < then_s {
            let dt_s = (0.02 * (self.now_s - began_s)).max(10.0).min(then_s - self.now_s);
            self.now_s += dt_s;
            self.advance(&rest, rest.from_c, None, rest.position.input_g, began_s, dt_s);
        }
        self.now_s = then_s.max(self.now_s);
    }

    /// Plays one run and returns what was recorded.
    pub(super) fn play(&mut self, planned: &PlannedRun, ticker: &mut Ticker) -> Result<RecordedRun, SimulateError> {
        let mut session = self.begin(planned);
        let (began_s, step_s) = (self.now_s, self.scenario.step_s);
        let mut run = RecordedRun { name: planned.name.clone(), kind: planned.run.kind.name().into(), rows: vec![] };
        let mut step = 0_u64;
        for segment in &planned.segments {
            let steps = segment.steps(step_s);
            let applied_g = session.rig.applied_g(&segment.position, segment.pose, segment.node);
            session.switch(segment.powered, self.now_s);
            for k in 1..=steps {
                step += 1;
                self.now_s = began_s + step as f64 * step_s;
                let setpoint_c = segment.setpoint_c((k as f64 - 0.5) / steps as f64);
                let now = self.advance(segment, setpoint_c, session.power_on_since_s, applied_g, began_s, step_s);
                if segment.recorded && segment.powered && k % planned.every == 0 {
                    run.rows.push(self.sample(&mut session, segment, &now));
                }
                ticker.pass(step_s)?;
            }
        }
        Ok(run)
    }

    fn begin<'p>(&mut self, planned: &'p PlannedRun<'p>) -> Session<'p> {
        let (noise, run) = (&self.scenario.noise, self.runs);
        self.runs += 1;
        self.effects.iter_mut().for_each(|effect| effect.begin_run());
        let common = &planned.run.common;
        self.thermal.set_self_heating(
            common.self_heating_k.unwrap_or(self.scenario.device.self_heating_k),
            common.self_heating_tau_s.unwrap_or(self.scenario.device.self_heating_tau_s),
        );
        let fork = |name: &str| ForkNoise::new(noise, Random::stream(self.seed, name, run));
        Session {
            planned,
            rig: RigError::new(&self.scenario.rig, self.seed, run),
            forks: [fork("fork 1"), fork("fork 2")],
            thermometer: Random::stream(self.seed, "thermometer", run),
            power_on_since_s: None,
        }
    }

    /// One step of everything that has a memory, and the conditions at its end.
    fn advance(
        &mut self,
        segment: &Segment,
        setpoint_c: f64,
        power_on_since_s: Option<f64>,
        applied_g: f64,
        began_s: f64,
        dt_s: f64,
    ) -> Conditions {
        let sensor_before_c = self.thermal.sensor_c();
        self.thermal.advance(setpoint_c, power_on_since_s.is_some(), dt_s);
        let sensor_c = self.thermal.sensor_c();
        let now = Conditions {
            time_s: self.now_s - began_s,
            age_days: self.now_s / DAY_S,
            power_on_s: power_on_since_s.map(|since_s| self.now_s - since_s),
            sensor_c,
            sensor_before_c,
            sensor_rate_c_per_s: (sensor_c - sensor_before_c) / dt_s,
            position: segment.position,
            applied_g,
            pose: segment.pose,
            supply_v: segment.supply_v,
            vibration_g2: segment.vibration_g2,
            pressure_pa: segment.pressure_pa,
            humidity_pct: segment.humidity_pct,
        };
        self.effects.iter_mut().for_each(|effect| effect.advance(&now, dt_s));
        now
    }

    /// One row: the signal path from what is applied to what the instrument shows.
    fn sample(&self, session: &mut Session, segment: &Segment, now: &Conditions) -> Row {
        let mut input = Input::undisturbed(now);
        self.effects.iter().for_each(|effect| effect.act(now, &mut input));
        let ideal = input.forks(&self.map);
        let noisy = self.with_noise(ideal, session, now);
        let (ideal, noisy) = (self.pulled(ideal, now), self.pulled(noisy, now));
        let wrong_hz = session.planned.run.common.bad_state.iter().map(|bad| bad.shift_hz(segment)).sum::<f64>();
        let counter = self.scenario.noise.counter();
        let f1_hz = micro(counter.read_hz(noisy.f1_hz + wrong_hz));
        let f2_hz = micro(counter.read_hz(noisy.f2_hz));
        Row {
            time_s: micro(now.time_s),
            power_on_s: micro(now.power_on_s.unwrap_or(0.0)),
            age_days: now.age_days,
            temperature_c: micro(thermometer::read_c(&self.scenario.noise, now.sensor_c, &mut session.thermometer)),
            f1_hz,
            f2_hz,
            delta_f_hz: micro(f1_hz - f2_hz),
            sum_f_hz: micro(f1_hz + f2_hz),
            reference_g: now.position.input_g,
            reference_sigma_g: self.scenario.rig.reference_sigma_g(now.position.tilt_g_per_rad),
            cross_g: now.position.cross_g,
            supply_v: now.supply_v,
            vibration_g2: now.vibration_g2,
            pressure_pa: now.pressure_pa,
            humidity_pct: now.humidity_pct,
            truth: self.truth(now, &input, ideal),
        }
    }

    fn with_noise(&self, ideal: Forks, session: &mut Session, now: &Conditions) -> Forks {
        let hz_per_g = self.map.scale_factor_hz_per_g(now.sensor_c) / std::f64::consts::SQRT_2;
        let [noise1_g, noise2_g] = session.forks.each_mut().map(|fork| fork.sample_g(now.time_s));
        Forks { f1_hz: ideal.f1_hz + hz_per_g * noise1_g, f2_hz: ideal.f2_hz + hz_per_g * noise2_g }
    }

    fn pulled(&self, mut forks: Forks, now: &Conditions) -> Forks {
        self.effects.iter().for_each(|effect| effect.pull(now, &mut forks));
        forks
    }

    fn truth(&self, now: &Conditions, input: &Input, ideal: Forks) -> RowTruth {
        let turn_on_ug = self.scenario.effects.turn_on.as_ref().map_or(0.0, |turn_on| turn_on.sigma_ug);
        let at = SampleAt {
            acceleration_g: now.position.input_g,
            temperature_c: now.sensor_c,
            tilt_g_per_rad: now.position.tilt_g_per_rad,
            time_s: now.time_s,
        };
        let floor = NoiseFloor::of_sample(&self.map, &self.scenario.noise, &self.scenario.rig, turn_on_ug, at);
        RowTruth {
            acceleration_g: now.applied_g,
            sensor_c: now.sensor_c,
            resonator_c: input.temperature_c,
            scale_factor_hz_per_g: self.map.scale_factor_hz_per_g(now.sensor_c),
            f1_hz: ideal.f1_hz,
            f2_hz: ideal.f2_hz,
            floor,
        }
    }

    /// The room between two runs.
    fn resting(&self) -> Segment {
        let mut programme = crate::scenario::programme::Programme::new(&self.scenario.device, &self.scenario.rig, 0.0);
        programme.set(|now| now.powered = false).wait(1.0);
        programme.segments().swap_remove(0)
    }
}

impl Session<'_> {
    /// Power comes on or goes off.
    fn switch(&mut self, powered: bool, now_s: f64) {
        self.power_on_since_s = match (powered, self.power_on_since_s) {
            (true, None) => Some(now_s),
            (true, since) => since,
            (false, _) => None,
        };
    }
}
