//! A run as a list of straight segments: the form in which the twin plays it.
//!
//! Apart from the kinds of run so that the twin knows one thing only, and a new kind is a new way to write segments.

use crate::twin::position::Position;
use crate::twin::rig::Rig;
use crate::twin::truth::Truth;

/// A stretch of time in which everything stands still, except the chamber's set point, which may go straight.
#[derive(Clone, Debug, PartialEq)]
pub struct Segment {
    /// How long it lasts, s.
    pub duration_s: f64,
    /// Set point of the chamber at its beginning, °C.
    pub from_c: f64,
    /// Set point of the chamber at its end, °C.
    pub to_c: f64,
    /// Pose of the device.
    pub position: Position,
    /// Counts the poses: it changes whenever the rig moves.
    pub pose: usize,
    /// Counts the temperature nodes: it changes whenever the chamber is sent elsewhere.
    pub node: usize,
    /// Whether the device is powered.
    pub powered: bool,
    /// Whether samples are kept.
    pub recorded: bool,
    /// Supply voltage, V.
    pub supply_v: f64,
    /// Vibration, mean square, g².
    pub vibration_g2: f64,
    /// Air pressure, Pa.
    pub pressure_pa: f64,
    /// Relative humidity, percent.
    pub humidity_pct: f64,
}

impl Segment {
    /// How many steps it takes.
    #[must_use]
    pub fn steps(&self, step_s: f64) -> u64 {
        (self.duration_s / step_s).round() as u64
    }

    /// The set point after `passed` of its time, a fraction, °C.
    #[must_use]
    pub fn setpoint_c(&self, passed: f64) -> f64 {
        self.from_c + (self.to_c - self.from_c) * passed
    }
}

/// The most parts that the runs of a scenario may have.
pub(crate) const MAX_SEGMENTS: usize = 1_000_000;

/// Writes segments one after the other; what is not said stays as it was.
#[derive(Clone, Debug)]
pub struct Programme {
    segments: Vec<Segment>,
    now: Segment,
    mount_rotation_deg: f64,
}

impl Programme {
    /// At room temperature, powered, input axis level, nominal supply and air, nothing recorded yet.
    #[must_use]
    pub fn new(truth: &Truth, rig: &Rig, mount_rotation_deg: f64) -> Self {
        let now = Segment {
            duration_s: 0.0,
            from_c: rig.room_c,
            to_c: rig.room_c,
            position: Position::tumble(0.0).mounted(mount_rotation_deg),
            pose: 0,
            node: 0,
            powered: true,
            recorded: false,
            supply_v: truth.supply_v,
            vibration_g2: 0.0,
            pressure_pa: rig.pressure_pa,
            humidity_pct: rig.humidity_pct,
        };
        Self { segments: Vec::new(), now, mount_rotation_deg }
    }

    /// The chamber's set point now, °C.
    #[must_use]
    pub fn setpoint_c(&self) -> f64 {
        self.now.to_c
    }

    /// The supply now, V.
    #[must_use]
    pub fn supply_v(&self) -> f64 {
        self.now.supply_v
    }

    /// Moves the device. A pose counts as new even where the rig comes back: it never comes back exactly.
    pub fn turn_to(&mut self, position: Position) -> &mut Self {
        self.now.position = position.mounted(self.mount_rotation_deg);
        self.now.pose += 1;
        self
    }

    /// Sends the chamber to another node.
    pub fn send_to(&mut self, temperature_c: f64) -> &mut Self {
        self.now.node += 1;
        self.step_to(temperature_c)
    }

    /// Sends the chamber elsewhere while recording goes on: what differs from soak to soak can't leap with a set point.
    pub fn step_to(&mut self, temperature_c: f64) -> &mut Self {
        self.now.from_c = temperature_c;
        self.now.to_c = temperature_c;
        self
    }

    /// Changes power, supply or air.
    pub fn set(&mut self, change: impl FnOnce(&mut Segment)) -> &mut Self {
        change(&mut self.now);
        self
    }

    /// Waits without recording.
    pub fn wait(&mut self, duration_s: f64) -> &mut Self {
        self.push(duration_s, false)
    }

    /// Records.
    pub fn record(&mut self, duration_s: f64) -> &mut Self {
        self.push(duration_s, true)
    }

    /// Records while the set point goes straight to another temperature.
    pub fn record_towards(&mut self, temperature_c: f64, duration_s: f64) -> &mut Self {
        self.now.to_c = temperature_c;
        self.record(duration_s);
        self.now.from_c = temperature_c;
        self
    }

    /// The finished list.
    #[must_use]
    pub fn segments(self) -> Vec<Segment> {
        self.segments
    }

    fn push(&mut self, duration_s: f64, recorded: bool) -> &mut Self {
        // A programme that is longer is refused: one part too many shows that.
        if duration_s > 0.0 && self.segments.len() <= MAX_SEGMENTS {
            self.segments.push(Segment { duration_s, recorded, ..self.now.clone() });
        }
        self
    }
}
