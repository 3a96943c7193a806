"""The oracle: what a diagnosis could know at most, that knows the shape of what is hidden, and the noise."""

import numpy as np

from device import UG_PER_G
from noise import RELAXATION_S, slope_ug_per_k
from rig import RAD_PER_ARCSEC, indexings


class Oracle:
    """DeltaBIC of a shape of known form and unknown amplitude, in the frequency difference:

    |P W s|^2 - ln n, with W the whitening by the true noise (innovations of a Kalman filter), and P the projection off the
    map, the runs' offsets, and the rig's errors as far as their size lets them be free (ridge). The sum of the frequencies
    may tell more.
    """

    def __init__(self, ruler, noise, rig):
        rec = ruler.scene.rec
        self.filter = Whitening(noise, ruler.scene.device, rec)
        offsets = rec.run[:, None] == np.arange(rec.run.max() + 1)
        free = np.hstack([ruler.map_columns(), offsets])
        random_ug = np.hstack([np.zeros((len(rec.run), 0)), *rig_columns(rig, rec)])
        # A column of one standard deviation that is held to nothing with weight one: a Bayesian's prior, a ridge.
        held = np.hstack([np.zeros((random_ug.shape[1], free.shape[1])), np.eye(random_ug.shape[1])])
        self.nuisance = np.vstack([self.filter.of(np.hstack([free, random_ug])), held])

    def delta_bic(self, shape_ug, others_ug):
        white = self.filter.of(np.column_stack([shape_ug, *others_ug]))
        white = np.vstack([white, np.zeros((len(self.nuisance) - len(white), white.shape[1]))])
        shape, nuisance = white[:, 0], np.hstack([self.nuisance, white[:, 1:]])
        scale = np.linalg.norm(nuisance, axis=0)
        u, weight, _ = np.linalg.svd(nuisance / np.where(scale > 0, scale, 1), full_matrices=False)
        basis = u[:, weight > 1e-9 * weight[0]]
        left = shape - basis @ (basis.T @ shape)
        return float(left @ left - np.log(len(shape_ug)))


def rig_columns(rig, rec):
    """What the rig may do, ug, a column for each of its errors with a standard deviation of one: mountings, positions."""
    per_arcsec = RAD_PER_ARCSEC * UG_PER_G * rec.cross_g[:, None]
    if rig.mount_arcsec:
        yield rig.mount_arcsec * per_arcsec * (rec.run[:, None] == np.arange(rec.run.max() + 1))
    if rig.position_arcsec:
        each = indexings(rec)
        yield rig.position_arcsec * per_arcsec * (each[:, None] == np.arange(each[-1] + 1))


class Whitening:
    """Innovations over their standard deviation, for white noise beside relaxations and a random walk from each run's start."""

    def __init__(self, noise, device, rec):
        self.white_ug2 = noise.white_ug**2 + (noise.thermometer_k * slope_ug_per_k(device)) ** 2
        step_s = np.maximum(np.diff(rec.time_s, prepend=0.0), 0)
        relaxed = np.exp(-step_s[:, None] / RELAXATION_S)
        self.keep = np.hstack([relaxed, np.ones((len(step_s), 1))])
        self.push = np.hstack([noise.flicker_ug**2 * (1 - relaxed**2), noise.walk_ug_per_sqrt_s**2 * step_s[:, None]])
        self.begin = np.diag([noise.flicker_ug**2] * len(RELAXATION_S) + [0.0])
        self.starts = set(rec.run_starts.tolist())

    def of(self, columns):
        """Each column whitened."""
        columns = np.asarray(columns, dtype=float)
        out = np.empty_like(columns)
        for k, row in enumerate(columns):
            if k in self.starts:
                state, spread = np.zeros((self.keep.shape[1], columns.shape[1])), self.begin
            else:
                keep = self.keep[k]
                state, spread = keep[:, None] * state, keep[:, None] * spread * keep + np.diag(self.push[k])
            cross = spread.sum(axis=1)
            variance = cross.sum() + self.white_ug2
            innovation = row - state.sum(axis=0)
            out[k] = innovation / np.sqrt(variance)
            gain = cross / variance
            state, spread = state + np.outer(gain, innovation), spread - np.outer(gain, cross)
        return out
