"""Effects that are on the product's list, by formulas and with side effects that are not the product's."""

import numpy as np

from draws import log_uniform
from effects import Effect, bias_effect
from lag import low_pass


def thermal_lag(rng, scene):
    """T_r = (1-w) L_tau[T_s] + w L_(slow)[T_s]: one time constant, or a second and slower branch."""
    weight = float(rng.choice([0.0, rng.uniform(0.05, 0.25)]))
    ratio = rng.uniform(6, 20)

    def disturb(tau_s, state):
        quick = scene.filtered(scene.past.temp_c, tau_s)
        slow = scene.filtered(scene.past.temp_c, ratio * tau_s) if weight else quick
        lag_k = (1 - weight) * quick + weight * slow - scene.rec.temp_c
        state.fork1_c, state.fork2_c = state.fork1_c + lag_k, state.fork2_c + lag_k
    return Effect("thermal-lag", "s", "resonators behind the thermometer", {"slow_weight": weight, "slow_ratio": ratio},
                  disturb, limits=(0.05, 900), start=30, positive=True)


def thermal_gradient(rng, scene):
    """Forks apart by T1 - T2 = delta_tau L[dT/dt]: a bias by TCF f/K1 = tens of mg per K of difference."""
    settle_s = rng.uniform(3, 25)
    rate_k_per_s = scene.settled_temp_rate_k_per_s(settle_s)

    def disturb(delta_tau_s, state):
        state.fork1_c = state.fork1_c + 0.5 * delta_tau_s * rate_k_per_s
        state.fork2_c = state.fork2_c - 0.5 * delta_tau_s * rate_k_per_s
    return Effect("thermal-gradient", "s", "temperature difference between forks in a ramp", {"settle_s": settle_s},
                  disturb, limits=(1e-4, 20), start=0.2)


def warm_up(rng, scene):
    """(1-v)(1-e^(-t/tau)) + v(1-e^(-t/5tau)) since power-on: as heat in the forks or as electronics."""
    tau_s, slow = log_uniform(rng, 250, 1500), rng.uniform(0, 0.3)
    on_s = scene.rec.power_on_s
    left = (1 - slow) * np.exp(-on_s / tau_s) + slow * np.exp(-on_s / (5 * tau_s))
    parameters = {"tau_s": tau_s, "slow_weight": slow, "slow_ratio": 5}
    if rng.random() < 0.5:
        return bias_effect("warm-up", "ug", "turn-on settling of the electronics", left, parameters=parameters, start=100)

    def disturb(rise_k, state):
        heat_k = rise_k * (1 - left)
        state.fork1_c, state.fork2_c = state.fork1_c + heat_k, state.fork2_c + heat_k
    return Effect("warm-up", "K", "self-heating unseen by the thermometer", parameters, disturb, limits=(1e-5, 2),
                  start=0.2, positive=True)


def bouc_wen(temp_c, width_k, sharpness):
    """z' = T' (1 - |z|^n (1 + sgn(T' z))/2)/width: a rate-independent loop in -1..1, in steps of at most 0.25 K."""
    out, z = np.empty(len(temp_c)), 0.0
    for k, change_k in enumerate(np.diff(temp_c, prepend=temp_c[0])):
        pieces = max(1, int(np.ceil(abs(change_k) / 0.25)))
        for _ in range(pieces):
            opposing = 0.5 * (1 + np.sign(change_k * z))
            z += change_k / pieces / width_k * (1 - opposing * abs(z) ** sharpness)
        out[k] = z
    return out


def preisach(rng, temp_c, width_k):
    """Mean of 600 relays, up at centre + half-width and down at centre - half-width (a density, not a grid)."""
    centre_c = rng.uniform(-45, 65, 600)
    half_k = np.abs(rng.normal(0, width_k, 600)) + 0.2
    state, out = np.where(centre_c < temp_c[0], 1.0, -1.0), np.empty(len(temp_c))
    for k, here_c in enumerate(temp_c):
        state[here_c > centre_c + half_k] = 1.0
        state[here_c < centre_c - half_k] = -1.0
        out[k] = state.mean()
    return out


def thermal_hysteresis(rng, scene):
    width_k, temp_c = rng.uniform(3, 15), scene.past.temp_c
    if rng.random() < 0.5:
        sharpness = rng.uniform(1, 2.5)
        loop, parameters = bouc_wen(temp_c, width_k, sharpness), {"model": "bouc-wen", "sharpness": sharpness}
    else:
        loop, parameters = preisach(rng, temp_c, width_k), {"model": "preisach"}
    return bias_effect("thermal-hysteresis", "ug", "rate-independent loop in temperature", scene.past.at_rows(loop),
                       rng.uniform(0.02, 0.05), scene.device, parameters={"width_k": width_k, **parameters}, start=50)


def stress_relaxation(rng, scene):
    """q' = -q/tau(T) + T', so q = T - L_tau[T]; tau follows Arrhenius; two Prony terms, the second 8 times slower."""
    tau_s, energy_ev = log_uniform(rng, 1500, 20_000), rng.uniform(0.0, 0.5)
    past = scene.past
    middle_k = 273.15 + 0.5 * (past.temp_c[1:] + past.temp_c[:-1])
    arrhenius = np.exp(energy_ev / 8.617e-5 * (1 / middle_k - 1 / 298.15))
    weight = rng.uniform(0, 0.4)
    quick, slow = (past.temp_c - low_pass(past.time_s, past.temp_c, factor * tau_s * arrhenius) for factor in (1, 8))
    return bias_effect("stress-relaxation", "ug/K", "creep of the die attach",
                       past.at_rows((1 - weight) * quick + weight * slow), rng.uniform(0.02, 0.05), scene.device, start=5,
                       parameters={"tau_s_at_25c": tau_s, "energy_ev": energy_ev, "slow_weight": weight, "slow_ratio": 8})


def ageing_law(rng, age_days):
    """Linear, logarithmic or saturating, each 1 at 100 days."""
    law = str(rng.choice(["linear", "log", "exponential"]))
    constant_days = log_uniform(rng, 0.5, 10) if law == "log" else rng.uniform(15, 60)
    curve = {"linear": lambda d: d, "log": lambda d: np.log1p(d / constant_days),
             "exponential": lambda d: -np.expm1(-d / constant_days)}[law]
    return curve(age_days) / curve(100.0), {"law": law} | ({} if law == "linear" else {"constant_days": constant_days})


def aging(rng, scene):
    shape, parameters = ageing_law(rng, scene.rec.age_days)
    return bias_effect("aging", "ug/100 days", "ageing of the bias", shape, parameters=parameters, per_run=True, start=100)


def scale_factor_aging(rng, scene):
    shape, parameters = ageing_law(rng, scene.rec.age_days)

    def disturb(ppm, state):
        state.accel_g = state.accel_g * (1 + ppm * 1e-6 * shape)
    return Effect("scale-factor-aging", "ppm/100 days", "ageing of the scale factor", parameters, disturb, start=50,
                  per_run=True)


def cross_axis(rng, scene):
    """delta a_p + K_ip a_i a_p, in g and g/g^2."""
    share = rng.uniform(0.0, 0.6)
    shape = share * scene.rec.cross_g + (1 - share) * scene.rec.cross_g * scene.rec.accel_g
    return bias_effect("cross-axis", "ug", "cross-axis sensitivity and cross-coupling K_ip", shape,
                       parameters={"linear_share": share}, start=50)


def misalignment(rng, scene):
    """The input axis turned by psi: a cos psi + a_p sin psi, psi growing slightly with temperature."""
    growth_per_k = rng.uniform(-2e-3, 2e-3)
    turn = 1 + growth_per_k * (scene.rec.temp_c - 25)

    def disturb(psi_urad, state):
        psi = psi_urad * 1e-6 * turn
        state.accel_g = state.accel_g * np.cos(psi) + scene.rec.cross_g * np.sin(psi)
    return Effect("misalignment", "urad", "input axis not where the drawing says", {"growth_per_k": growth_per_k}, disturb,
                  limits=(0.1, 2e4), start=100)


def supply_voltage(rng, scene):
    """K_V dV + a quadratic part, and a scale-factor part."""
    change = (scene.rec.supply_v - 3.3) / 3.3 * 100
    square, scale = rng.uniform(-0.05, 0.05), rng.uniform(0, 0.5)
    shape = change + square * change**2 + scale * change * scene.rec.accel_g
    return bias_effect("supply-voltage", "ug/%", "sensitivity to the supply", shape, start=30,
                       parameters={"square_per_percent": square, "scale_share": scale})


def vibration_rectification(rng, scene):
    """K_VR g_rms^2, compressed at high level by the stops of the mass: v/(1 + v/v0)."""
    stop_g2 = log_uniform(rng, 60, 600)
    level = scene.rec.vibration_g2
    return bias_effect("vibration-rectification", "ug/g2", "rectified vibration", level / (1 + level / stop_g2),
                       parameters={"stop_g2": stop_g2}, start=20)


def pressure(rng, scene):
    return bias_effect("pressure", "ug/hPa", "bending of the lid", (scene.rec.pressure_pa - 101_000) / 100,
                       rng.uniform(0.02, 0.05), scene.device, start=0.3)


def humidity(rng, scene):
    """tau h' = RH - h, through the days between runs as well."""
    tau_s = rng.uniform(4, 30) * 3600
    return bias_effect("humidity", "ug/%RH", "swelling by moisture", scene.filtered(scene.past.humidity_pct, tau_s) - 42,
                       rng.uniform(0.02, 0.05), scene.device, parameters={"tau_s": tau_s}, start=5)


def mode_crossing(rng, scene):
    """Fork 1 meets a damped mode: second-order shift kappa^2 d/(d^2 + gamma^2), d = f1 - f_mode, moving with a."""
    at_c, half_width_k = rng.uniform(-25, 45), log_uniform(rng, 0.5, 4)
    mode_tcf, device = rng.uniform(100e-6, 400e-6), scene.device
    mode_hz = float(device.frequencies(0.0, at_c, at_c)[0])
    slope_hz_per_k = abs(device.e1_per_k / 2 - mode_tcf) * mode_hz
    gamma_hz = half_width_k * slope_hz_per_k

    def distort(kappa2_hz2, f1_hz, f2_hz):
        apart_hz = f1_hz - mode_hz * (1 + mode_tcf * (scene.rec.temp_c - at_c))
        return f1_hz + kappa2_hz2 * apart_hz / (apart_hz**2 + gamma_hz**2), f2_hz
    return Effect("mode-crossing", "Hz2", "a spurious mode crosses fork 1",
                  {"at_c_and_0_g": at_c, "half_width_k": half_width_k, "mode_tcf_per_k": mode_tcf, "gamma_hz": gamma_hz},
                  distort=distort, start=0.1, positive=True)


def lock_in(_rng, scene):
    """Adler: the forks pull each other, |df| -> sqrt(df^2 - f_L^2), and 0 inside the locked band."""
    def distort(lock2_hz2, f1_hz, f2_hz):
        apart_hz = f1_hz - f2_hz
        pulled_hz = np.sign(apart_hz) * np.sqrt(np.maximum(apart_hz**2 - lock2_hz2, 0))
        shift_hz = 0.5 * (pulled_hz - apart_hz)
        return f1_hz + shift_hz, f2_hz - shift_hz
    return Effect("lock-in", "Hz2 (locking range squared)", "mutual injection locking near f1 = f2", distort=distort,
                  limits=(1e-6, 100), start=0.1, positive=True)


def turn_on(rng, scene):
    offsets = rng.normal(0, 1, scene.rec.run.max() + 1)
    return bias_effect("turn-on", "ug (1 sigma)", "another bias at each power-on", offsets[scene.rec.run], start=100,
                       per_run=True)


def g_hysteresis(rng, scene):
    """Anelastic memory of acceleration: (1-w) L_tau[a] + w L_(10 tau)[a] - a."""
    tau_s, weight, past = log_uniform(rng, 30, 400), rng.uniform(0, 0.4), scene.past
    quick, slow = (scene.filtered(past.accel_g, factor * tau_s) for factor in (1, 10))
    return bias_effect("g-hysteresis", "ug/g", "the bias remembers earlier accelerations",
                       (1 - weight) * quick + weight * slow - scene.rec.accel_g,
                       parameters={"tau_s": tau_s, "slow_weight": weight, "slow_ratio": 10}, start=20)


def reference_clock(rng, scene):
    """The counter's clock is fast by y: both frequencies are read as f (1 - y)."""
    shape, parameters = ageing_law(rng, scene.rec.age_days)

    def distort(ppm, f1_hz, f2_hz):
        factor = 1 - ppm * 1e-6 * shape
        return f1_hz * factor, f2_hz * factor
    return Effect("reference-clock", "ppm/100 days", "drift of the reference clock", parameters, distort=distort,
                  limits=(0.01, 40), start=2, per_run=True)


# Name -> (factory, what the protocol must offer). second-order and third-order are on the product's list but not here: any
# static map takes them in, so that nothing remains to be diagnosed. Every device has them, with the mismatch of its forks.
LISTED = {
    "thermal-lag": (thermal_lag, ()),
    "thermal-gradient": (thermal_gradient, ()),
    "warm-up": (warm_up, ()),
    "thermal-hysteresis": (thermal_hysteresis, ()),
    "stress-relaxation": (stress_relaxation, ()),
    "aging": (aging, ()),
    "scale-factor-aging": (scale_factor_aging, ()),
    "cross-axis": (cross_axis, ("cross",)),
    "misalignment": (misalignment, ("cross",)),
    "supply-voltage": (supply_voltage, ("supply_v",)),
    "vibration-rectification": (vibration_rectification, ("vibration_g2",)),
    "pressure": (pressure, ("pressure_pa",)),
    "humidity": (humidity, ("humidity_pct",)),
    "mode-crossing": (mode_crossing, ()),
    "lock-in": (lock_in, ("zero-crossing",)),
    "turn-on": (turn_on, ("perfect-rig",)),
    "g-hysteresis": (g_hysteresis, ()),
    "reference-clock": (reference_clock, ("sum",)),
}

# What the data of a campaign cannot tell apart: an answer that names the other one is not wrong.
ALSO_ACCEPTABLE = {
    "misalignment": ["cross-axis"],
    "cross-axis": ["misalignment"],
    "turn-on": ["aging"],
    "aging": ["turn-on"],
    "scale-factor-aging": ["reference-clock"],
    "reference-clock": ["scale-factor-aging"],
    "warm-up": ["self-heating"],  # half of them are heat in the forks
}
