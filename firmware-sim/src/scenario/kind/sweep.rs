//! `supply`, `vibration`, `pressure`, `humidity`: one thing goes from value to value, in every pose, at every temperature.

use serde::{Deserialize, Serialize};

use crate::limit::{CHAMBER_C, Fault, LONGEST_S, each_within, up_to, within};
use crate::scenario::programme::{Programme, Segment};
use crate::twin::position::{self, Position};
use crate::twin::random::Random;

/// Declares a sweep: the name of its values and what they may be, where and how long by default, and how the laboratory
/// sets a value: `|segment, value, nominal supply|`.
macro_rules! sweep {
    (
        $(#[$about:meta])* $sweep:ident, $(#[$of:meta])* $values:ident within $min:literal to $max:literal,
        $default:expr, positions_deg: $positions_deg:expr, settle_s: $settle_s:literal, dwell_s: $dwell_s:literal,
        $set:expr
    ) => {
        $(#[$about])*
        #[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
        #[serde(default, deny_unknown_fields)]
        pub struct $sweep {
            $(#[$of])*
            pub $values: Vec<f64>,
            /// Temperatures at which all of it is done, °C.
            pub temperatures_c: Vec<f64>,
            /// Time at every temperature before recording, s.
            pub soak_s: f64,
            /// Poses in which all of it is done; the input axis sees the sine, degrees.
            pub positions_deg: Vec<f64>,
            /// Time at every value that is not kept, s.
            pub settle_s: f64,
            /// Time at every value that is recorded, s.
            pub dwell_s: f64,
        }

        impl Default for $sweep {
            fn default() -> Self {
                Self {
                    $values: $default.to_vec(),
                    temperatures_c: vec![25.0],
                    soak_s: 3600.0,
                    positions_deg: $positions_deg.to_vec(),
                    settle_s: $settle_s,
                    dwell_s: $dwell_s,
                }
            }
        }

        impl $sweep {
            pub(super) fn check(&self) -> Result<(), Fault> {
                each_within(stringify!($values), &self.$values, $min, $max)?;
                self.places().check()
            }

            pub(super) fn write(&self, programme: &mut Programme, _random: &mut Random) {
                self.places().sweep(programme, &self.$values, $set);
            }

            fn places(&self) -> Places<'_> {
                Places {
                    temperatures_c: &self.temperatures_c,
                    soak_s: self.soak_s,
                    positions_deg: &self.positions_deg,
                    settle_s: self.settle_s,
                    dwell_s: self.dwell_s,
                }
            }
        }
    };
}

sweep!(
    /// The supply goes from value to value.
    Supply,
    /// Deviations from the nominal supply, percent.
    offsets_pct within -50.0 to 50.0,
    [-5.0, -2.5, 0.0, 2.5, 5.0], positions_deg: [0.0, 90.0, 270.0], settle_s: 5.0, dwell_s: 20.0,
    |now, offset_pct, nominal_v| now.supply_v = nominal_v * (1.0 + offset_pct / 100.0)
);

sweep!(
    /// Random vibration along the input axis.
    Vibration,
    /// Levels, g rms.
    levels_g_rms within 0.0 to 100.0,
    [0.0, 2.0, 4.0, 6.0], positions_deg: [0.0, 90.0], settle_s: 5.0, dwell_s: 30.0,
    |now, level_g, _| now.vibration_g2 = level_g * level_g
);

sweep!(
    /// Bell jar: the air is pumped off and let in.
    Pressure,
    /// Pressures, Pa.
    pressures_pa within 0.0 to 1e6,
    [101_325.0, 90_000.0, 70_000.0, 50_000.0, 70_000.0, 101_325.0], positions_deg: [0.0], settle_s: 60.0, dwell_s: 120.0,
    |now, pressure_pa, _| now.pressure_pa = pressure_pa
);

sweep!(
    /// Climate chamber: the air gets damp and dry again, and stays long, as moisture takes its time.
    Humidity,
    /// Relative humidities, percent.
    humidities_pct within 0.0 to 100.0,
    [40.0, 85.0, 40.0], positions_deg: [0.0], settle_s: 0.0, dwell_s: 172_800.0,
    |now, humidity_pct, _| now.humidity_pct = humidity_pct
);

/// Where a sweep is carried out: at every temperature, in every pose.
struct Places<'a> {
    temperatures_c: &'a [f64],
    soak_s: f64,
    positions_deg: &'a [f64],
    settle_s: f64,
    dwell_s: f64,
}

impl Places<'_> {
    fn check(&self) -> Result<(), Fault> {
        each_within("temperatures_c", self.temperatures_c, CHAMBER_C.0, CHAMBER_C.1)?;
        within("soak_s", self.soak_s, 0.0, LONGEST_S)?;
        position::check(self.positions_deg, &[])?;
        within("settle_s", self.settle_s, 0.0, LONGEST_S)?;
        up_to("dwell_s", self.dwell_s, LONGEST_S)
    }

    fn sweep(&self, programme: &mut Programme, values: &[f64], set: fn(&mut Segment, f64, f64)) {
        let nominal_v = programme.supply_v();
        for temperature_c in self.temperatures_c {
            programme.turn_to(Position::tumble(0.0)).send_to(*temperature_c).wait(self.soak_s);
            for position in position::collect(self.positions_deg, &[]) {
                programme.turn_to(position);
                for value in values {
                    programme.set(|now| set(now, *value, nominal_v)).wait(self.settle_s).record(self.dwell_s);
                }
            }
        }
    }
}
