"""The rig: errors of the laboratory's equipment that no column records."""

from dataclasses import dataclass

import numpy as np

from device import UG_PER_G

RAD_PER_ARCSEC = np.pi / 648_000


@dataclass(frozen=True)
class Rig:
    """What the laboratory's equipment adds: zero everywhere for a perfect one."""
    turn_on_ug: float = 0.0
    position_arcsec: float = 0.0
    mount_arcsec: float = 0.0

    def sigma_rad(self):
        return RAD_PER_ARCSEC * np.hypot(self.position_arcsec, self.mount_arcsec)


def draw_rig(rng, real):
    return Rig(rng.uniform(20, 150), rng.uniform(5, 30), rng.uniform(5, 40)) if real else Rig()


def indexings(rec):
    """Of each row, how often the head was turned or the sensor mounted before."""
    return np.cumsum((np.diff(rec.angle_deg, prepend=np.inf) != 0) | (np.diff(rec.run, prepend=-1) != 0)) - 1


def rig_error_g(rng, rig, rec):
    """sin(angle + mount + position) - sin(angle), with another position at each indexing, and the run's turn-on offset."""
    runs = rec.run.max() + 1
    indexing = indexings(rec)
    tilt_rad = RAD_PER_ARCSEC * (rig.mount_arcsec * rng.normal(size=runs)[rec.run]
                                 + rig.position_arcsec * rng.normal(size=indexing[-1] + 1)[indexing])
    turned = np.sin(np.radians(rec.angle_deg) + tilt_rad) - rec.accel_g
    return turned + rig.turn_on_ug / UG_PER_G * rng.normal(size=runs)[rec.run]
