"""Effects that the product's list lacks: the right answer is that something is missing which it can't name."""

import numpy as np

from device import UG_PER_G
from draws import log_uniform
from effects import Effect, bias_effect


def outside(description, shape_ug, per_run=False, **parameters):
    return bias_effect("outside", "ug", description, shape_ug, parameters=parameters, start=30, per_run=per_run)


def time_of_day(rng, scene):
    hour = rng.uniform(0, 24)
    return outside("sine of the time of day", np.sin(2 * np.pi * (scene.rec.clock_s / 3600 - hour) / 24), phase_hour=hour)


def undocumented_jump(rng, scene):
    """Somebody bumps the table in the middle of a run; the bias keeps the new value."""
    run = int(rng.integers(scene.rec.run.max() // 4, 3 * scene.rec.run.max() // 4))
    rows = np.flatnonzero(scene.rec.run == run)
    row = int(rows[int(rng.uniform(0.3, 0.7) * len(rows))])
    shape = np.where(np.arange(len(scene.rec.run)) >= row, 1.0, 0.0)
    return outside("jump at an undocumented event", shape, per_run=True, run=run + 1,
                   clock_s=float(scene.rec.clock_s[row]))


def overheated(rng, scene):
    """Permanent set: grows with the highest temperature ever seen beyond a threshold."""
    threshold_c = rng.uniform(30, 45)
    highest = scene.past.at_rows(np.maximum.accumulate(scene.past.temp_c))
    return outside("set after exceeding a maximum temperature", np.maximum(highest - threshold_c, 0) / 10, per_run=True,
                   threshold_c=threshold_c)


def random_telegraph(rng, scene):
    """A two-state trap with exponential dwell times: bursts, without any channel that shows them."""
    dwell_s = log_uniform(rng, 300, 3000)
    step_s = np.diff(scene.rec.clock_s, prepend=scene.rec.clock_s[0])
    flips = rng.random(len(step_s)) < 0.5 * -np.expm1(-2 * step_s / dwell_s)
    return outside("random telegraph", np.cumsum(flips) % 2 - 0.5, dwell_s=dwell_s)


def unrecorded_magnet(rng, scene):
    """A stray field with a direction of its own, present on some days only: turns with the pose, unrecorded."""
    strength = rng.uniform(0, 1, scene.rec.run.max() + 1)
    heading_deg = rng.uniform(0, 360)
    shape = strength[scene.rec.run] * np.sin(np.radians(2 * scene.rec.angle_deg + heading_deg))
    return outside("unrecorded field that turns with the pose", shape, heading_deg=heading_deg)


def dead_band(_rng, _scene):
    """Nothing moves below a breakaway acceleration d: the mass feels a - clip(a, -d, d)."""
    def disturb(band_ug, state):
        band_g = band_ug / UG_PER_G
        state.accel_g = state.accel_g - np.clip(state.accel_g, -band_g, band_g)
    return Effect("outside", "ug (half-width)", "dead band around 0 g", disturb=disturb, limits=(1e-3, 1e5), start=30,
                  positive=True)


def kink(_rng, scene):
    return outside("kink of the scale factor at 0 g", np.abs(scene.rec.accel_g))


def periodic_interference(rng, scene):
    period_s = log_uniform(rng, 250, 1500)
    return outside("periodic interference", np.sin(2 * np.pi * scene.rec.clock_s / period_s), period_s=period_s)


def frost(rng, scene):
    """On each cooling below the frost point a bias appears and decays hyperbolically, 1/(1 + t/t0), until it thaws."""
    frost_c, decay_s = rng.uniform(-15, 5), log_uniform(rng, 600, 4000)
    shape, since_s = np.zeros(len(scene.past.time_s)), 0.0
    for k in range(1, len(shape)):
        frozen = scene.past.temp_c[k] < frost_c
        since_s = since_s + scene.past.time_s[k] - scene.past.time_s[k - 1] if frozen else 0.0
        shape[k] = frozen / (1 + since_s / decay_s)
    return outside("hyperbolic decay since freezing", scene.past.at_rows(shape), frost_c=frost_c, decay_s=decay_s)


def stick_slip(rng, scene):
    """A joint slips while the temperature moves faster than a threshold, either way, and is still otherwise."""
    threshold = rng.uniform(0.4, 1.2) / 60
    rate = np.abs(scene.temp_rate_k_per_s())
    return outside("threshold in |dT/dt|", 1 / (1 + np.exp(-(rate - threshold) / (0.05 * threshold))),
                   threshold_k_per_min=60 * threshold)


def converter_ripple(rng, scene):
    """Integral nonlinearity of a converter: a ripple in temperature, too short for a smooth map."""
    period_k = rng.uniform(4, 9)
    return outside("ripple in temperature", np.sin(2 * np.pi * scene.rec.temp_c / period_k), period_k=period_k)


def dividing_head(rng, scene):
    order = int(rng.choice([5, 6, 7, 8]))
    shape = np.cos(np.radians(order * scene.rec.angle_deg))
    return outside("ripple in the angle of the dividing head", shape, order=order)


def rate_times_accel(rng, scene):
    settle_s = rng.uniform(5, 60)
    rate = scene.settled_temp_rate_k_per_s(settle_s) * 60
    return outside("scale factor follows dT/dt", rate * scene.rec.accel_g, settle_s=settle_s)


def ratchet(rng, scene):
    """Each reorientation leaves a little behind, of diminishing size: sqrt of the number of moves."""
    moves = np.cumsum(np.abs(np.diff(scene.rec.angle_deg, prepend=scene.rec.angle_deg[0])) > 1.0)
    shape = np.sqrt(moves)
    return outside("ratchet with each reorientation", shape - shape.mean(), per_run=True, moves=int(moves[-1]))


OUTSIDE = (time_of_day, undocumented_jump, overheated, random_telegraph, unrecorded_magnet, dead_band, kink,
           periodic_interference, frost, stick_slip, converter_ripple, dividing_head, rate_times_accel, ratchet)
