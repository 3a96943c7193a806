//! First-order lags, stepped exactly.
//!
//! Apart because a simple Euler step would shift every lag by half a time step, which at 1 s is 3 % of a 35 s time
//! constant: more than a fit's uncertainty.

/// One step of `τ·dy/dt = u − y` for an input that holds still: exact for any step.
#[must_use]
pub fn relax(y: f64, u: f64, dt_s: f64, tau_s: f64) -> f64 {
    u + (y - u) * (-dt_s / tau_s).exp()
}

/// One step of `τ·dy/dt = u − y` for an input that goes straight from `from` to `to`: exact for any step.
#[must_use]
pub fn follow(y: f64, from: f64, to: f64, dt_s: f64, tau_s: f64) -> f64 {
    let behind = tau_s * (to - from) / dt_s;
    to - behind + (y - from + behind) * (-dt_s / tau_s).exp()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_step_response_is_the_exponential_at_any_step_size() {
        for steps in [1, 7, 1000] {
            let y = (0..steps).fold(0.0, |y, _| relax(y, 1.0, 70.0 / f64::from(steps), 35.0));
            assert!((y - (1.0 - (-2.0_f64).exp())).abs() < 1e-12, "{steps} steps: {y}");
        }
    }

    #[test]
    fn behind_a_ramp_the_lag_is_rate_times_time_constant() {
        let mut y = 0.0;
        for second in 0..1000 {
            y = follow(y, f64::from(second) * 0.01, f64::from(second + 1) * 0.01, 1.0, 35.0);
        }
        assert!((10.0 - y - 0.35).abs() < 1e-9, "{y}");
    }
}
