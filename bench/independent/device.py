"""The device: two forks, their frequencies under acceleration and temperature."""

from dataclasses import dataclass

import numpy as np

from draws import log_uniform, signed

UG_PER_G = 1e6


@dataclass(frozen=True)
class Device:
    """Two forks, pulled and pushed by one mass:  f_i = f_i0 sqrt(1 + e1 th + e2 th^2 +- m(th)/2 +- s_i (1 + k th) u(a)).

    th: temperature above 25 C; e1, e2: Young's modulus plus common package stress; m: mismatch of the forks, which makes
    the bias depend on temperature; s: relative stiffness per g; u = a + k2 a^2 + k3 a^3: nonlinearity of the levers.
    """
    f1_hz: float
    f2_hz: float
    s1_per_g: float
    s2_per_g: float
    e1_per_k: float
    e2_per_k2: float
    mismatch: tuple  # per K, per K^2, per K^3 on f^2
    scale_tc_per_k: float
    k2_per_g: float
    k3_per_g2: float

    def frequencies(self, accel_g, fork1_c, fork2_c):
        pulled = self._fork(self.f1_hz, +self.s1_per_g, +0.5, accel_g, fork1_c - 25.0)
        pushed = self._fork(self.f2_hz, -self.s2_per_g, -0.5, accel_g, fork2_c - 25.0)
        return pulled, pushed

    def _fork(self, f0_hz, s_per_g, side, accel_g, theta_k):
        lever = accel_g + self.k2_per_g * accel_g**2 + self.k3_per_g2 * accel_g**3
        common = self.e1_per_k * theta_k + self.e2_per_k2 * theta_k**2
        mismatch = sum(m * theta_k ** (k + 1) for k, m in enumerate(self.mismatch))
        return f0_hz * np.sqrt(1 + common + side * mismatch + s_per_g * (1 + self.scale_tc_per_k * theta_k) * lever)

    def scale_hz_per_g(self, accel_g, temp_c):
        """K1 = d(f1 - f2)/da, by a central difference of 1 mg."""
        above = np.subtract(*self.frequencies(accel_g + 5e-4, temp_c, temp_c))
        below = np.subtract(*self.frequencies(accel_g - 5e-4, temp_c, temp_c))
        return (above - below) / 1e-3


def draw_device(rng, crosses_zero):
    """A device of its own for each campaign; `crosses_zero` puts f1 = f2 inside +-1 g, where forks can lock."""
    f0_hz = log_uniform(rng, 18e3, 95e3)
    s_per_g = log_uniform(rng, 1e-3, 4e-3)
    scale_hz_per_g = f0_hz * s_per_g  # K1 = f0 s for two forks of stiffness s each
    offset_g = rng.uniform(-0.85, 0.85) if crosses_zero else signed(rng, rng.uniform(0.3, 1.6))
    fork_mismatch = rng.uniform(-0.025, 0.025)
    bias_slope_g_per_k = signed(rng, log_uniform(rng, 0.15e-3, 2.0e-3))
    to_f2 = 2 * scale_hz_per_g / f0_hz  # a bias b needs a relative mismatch 2 b K1/f0 between the squares of f
    return Device(
        f1_hz=f0_hz + 0.5 * offset_g * scale_hz_per_g,
        f2_hz=f0_hz - 0.5 * offset_g * scale_hz_per_g,
        s1_per_g=s_per_g * (1 + fork_mismatch / 2),
        s2_per_g=s_per_g * (1 - fork_mismatch / 2),
        e1_per_k=rng.uniform(-240e-6, -50e-6),
        e2_per_k2=rng.uniform(-80e-9, -30e-9),
        mismatch=(to_f2 * bias_slope_g_per_k, to_f2 * rng.uniform(-1e-6, 1e-6), to_f2 * rng.uniform(-4e-9, 4e-9)),
        scale_tc_per_k=rng.uniform(-60e-6, 60e-6),
        k2_per_g=rng.uniform(-15e-6, 15e-6),
        k3_per_g2=rng.uniform(-5e-6, 5e-6),
    )
