//! The reciprocal counter that turns a fork's oscillation into a number.
//!
//! Apart from the forks because its resolution depends on the gate and the clock only: it counts clock ticks over a
//! whole number of periods, so its step is `f / (f_clk·gate)`.

/// Counts whole ticks of a reference clock over the whole periods that fit into a gate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Counter {
    /// Reference clock, Hz; 0 means a counter without quantisation.
    pub clock_hz: f64,
    /// Gate time, s.
    pub gate_s: f64,
}

impl Counter {
    /// What the counter shows for a frequency, Hz.
    #[must_use]
    pub fn read_hz(&self, frequency_hz: f64) -> f64 {
        if self.clock_hz == 0.0 {
            return frequency_hz;
        }
        let periods = (frequency_hz * self.gate_s).floor().max(1.0);
        let ticks = (periods * self.clock_hz / frequency_hz).round();
        periods * self.clock_hz / ticks
    }

    /// One count at this frequency, Hz.
    #[must_use]
    pub fn step_hz(&self, frequency_hz: f64) -> f64 {
        if self.clock_hz == 0.0 { 0.0 } else { frequency_hz / (self.clock_hz * self.gate_s) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const COUNTER: Counter = Counter { clock_hz: 100e6, gate_s: 1.0 };

    #[test]
    fn its_step_is_the_worked_412_microhertz() {
        assert!((COUNTER.step_hz(41_200.0) - 0.412e-3).abs() < 1e-9);
    }

    #[test]
    fn its_error_is_uniform_over_one_step() {
        let steps: Vec<f64> = (0..20_000)
            .map(|i| 41_238.0 + f64::from(i) * 0.003_7)
            .map(|f| (COUNTER.read_hz(f) - f) / COUNTER.step_hz(f))
            .collect();
        let rms = (steps.iter().map(|x| x * x).sum::<f64>() / steps.len() as f64).sqrt();
        // The gate holds whole periods only, so the step varies by 1/41 000; half a step is exceeded by no more.
        assert!(steps.iter().all(|x| x.abs() < 0.500_1));
        assert!((rms - 12.0_f64.sqrt().recip()).abs() < 0.005, "{rms}");
    }

    #[test]
    fn without_a_clock_it_is_transparent() {
        let ideal = Counter { clock_hz: 0.0, gate_s: 1.0 };
        assert_eq!((ideal.read_hz(41_238.1), ideal.step_hz(41_238.1)), (41_238.1, 0.0));
    }
}
