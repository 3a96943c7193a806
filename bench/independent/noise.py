"""The noise: of the reading, and of the thermometer."""

from dataclasses import dataclass

import numpy as np

from device import UG_PER_G
from draws import log_uniform


# Time constants of the relaxations that make 1/f noise, s.
RELAXATION_S = 20.0 * 4.0 ** np.arange(5)


@dataclass(frozen=True)
class Noise:
    white_ug: float  # 1 sigma of one 1-s gate
    flicker_ug: float  # 1 sigma of each relaxation process
    walk_ug_per_sqrt_s: float
    thermometer_k: float


def draw_noise(rng, device):
    white_ug = log_uniform(rng, 3, 40)
    quiet_k = 0.3 * white_ug / slope_ug_per_k(device)  # a thermometer fit for its purpose: below a third of the white noise
    return Noise(white_ug, white_ug * rng.uniform(0.05, 0.15), white_ug * log_uniform(rng, 5e-4, 4e-3),
                 min(rng.uniform(0.2e-3, 2e-3), quiet_k))


def slope_ug_per_k(device):
    """What the reading follows the thermometer by."""
    return UG_PER_G * abs(device.mismatch[0]) * device.f1_hz / (2 * device.f1_hz * device.s1_per_g)


def noise_ug(rng, noise, rec):
    """White, plus 1/f as five relaxation processes a factor of 4 apart, plus a random walk that restarts with the run."""
    step_s = np.diff(rec.time_s, prepend=0.0)
    keep = np.exp(-np.maximum(step_s, 0)[:, None] / RELAXATION_S)
    push = noise.flicker_ug * np.sqrt(1 - keep**2) * rng.normal(size=keep.shape)
    walk = noise.walk_ug_per_sqrt_s * np.sqrt(np.maximum(step_s, 0)) * rng.normal(size=len(step_s))
    out, first = np.empty(len(step_s)), set(rec.run_starts.tolist())
    for k in range(len(step_s)):
        if k in first:
            flicker, walked = noise.flicker_ug * rng.normal(size=len(RELAXATION_S)), 0.0
        flicker, walked = keep[k] * flicker + push[k], walked + walk[k]
        out[k] = flicker.sum() + walked
    return out + noise.white_ug * rng.normal(size=len(step_s))


def add_noise(rng, frequencies, scale_hz_per_g, reading_noise_ug, white_ug):
    """The noise of the difference goes half to each fork, with a white part of the same size that moves both."""
    half = 0.5 * scale_hz_per_g / UG_PER_G
    together = white_ug * rng.normal(size=len(half))
    return frequencies[0] + half * (together + reading_noise_ug), frequencies[1] + half * (together - reading_noise_ug)
