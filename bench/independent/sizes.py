"""Sizes: how large an effect is in the reading, and what a calibration that knows nothing of it leaves."""

import numpy as np

from device import UG_PER_G
from effects import State


def measure(scene, effects, rig_g=0.0):
    """Noise-free frequencies of the campaign with these effects."""
    rec = scene.rec
    state = State(rec.accel_g + rig_g, rec.temp_c, rec.temp_c, np.zeros(len(rec.run)))
    for effect in effects:
        if effect.disturb:
            effect.disturb(effect.amplitude, state)
    f1_hz, f2_hz = scene.device.frequencies(state.accel_g, state.fork1_c, state.fork2_c)
    f1_hz, f2_hz = f1_hz + state.common_hz, f2_hz + state.common_hz
    for effect in effects:
        if effect.distort:
            f1_hz, f2_hz = effect.distort(effect.amplitude, f1_hz, f2_hz)
    return f1_hz, f2_hz


class Ruler:
    """Sizes of effects: in the reading, and what a static map (and run offsets) leave of that."""

    def __init__(self, scene, white_ug):
        self.scene, self.white_ug = scene, white_ug
        self.clean = measure(scene, [])
        self.scale_hz_per_g = scene.device.scale_hz_per_g(scene.rec.accel_g, scene.rec.temp_c)
        self.map = self._orthonormal(self.map_columns())
        offsets = scene.rec.run[:, None] == np.arange(1, scene.rec.run.max() + 1)
        self.map_and_offsets = self._orthonormal(np.hstack([self.map_columns(), offsets]))

    def map_columns(self):
        """Chebyshev products x^0..3 T^0..6, x the frequency difference."""
        def scaled(values):
            return 2 * (values - values.min()) / np.ptp(values) - 1
        x = np.polynomial.chebyshev.chebvander(scaled(self.clean[0] - self.clean[1]), 3)
        temp = np.polynomial.chebyshev.chebvander(scaled(self.scene.rec.temp_c), 6)
        return (x[:, :, None] * temp[:, None, :]).reshape(len(x), -1)

    @staticmethod
    def _orthonormal(columns):
        u, weight, _ = np.linalg.svd(columns, full_matrices=False)
        return u[:, weight > 1e-9 * weight[0]]

    def reading_ug(self, frequencies):
        shift_hz = (frequencies[0] - frequencies[1]) - (self.clean[0] - self.clean[1])
        return UG_PER_G * shift_hz / self.scale_hz_per_g

    @staticmethod
    def _remains(values, basis):
        return rms(values - basis @ (basis.T @ values))

    def sizes(self, frequencies):
        reading_ug = self.reading_ug(frequencies)
        static_ug = self._remains(reading_ug, self.map_and_offsets)
        return {
            "size_rms_ug": rms(reading_ug), "residual_rms_ug": static_ug, "snr_static": static_ug / self.white_ug,
            "snr_map_only": self._remains(reading_ug, self.map) / self.white_ug,
            "snr_sum_f": self._sum_snr(frequencies),
        }

    def _sum_snr(self, frequencies):
        """The same for f1 + f2 against its own noise (as many Hz as that of f1 - f2): what a second channel would see."""
        shift_hz = sum(frequencies) - sum(self.clean)
        noise_hz = self.white_ug / UG_PER_G * np.mean(self.scale_hz_per_g)
        return self._remains(shift_hz, self.map) / noise_hz

    def snr(self, effect):
        sizes = self.sizes(measure(self.scene, [effect]))
        return sizes["snr_map_only" if effect.per_run else "snr_static"]


def rms(values):
    return float(np.sqrt(np.mean(np.square(values))))


def tune(effect, ruler, target_snr, sign):
    """The amplitude that gives the wanted ratio, within limits: fixed-point steps, as the two are nearly proportional."""
    amplitude = effect.start
    for _ in range(12):
        snr = ruler.snr(effect.with_amplitude(sign * amplitude))
        if abs(snr / target_snr - 1) < 0.01:
            break
        amplitude = float(np.clip(amplitude * np.clip(target_snr / max(snr, 1e-12), 1e-3, 1e3), *effect.limits))
    return effect.with_amplitude(sign * amplitude)
