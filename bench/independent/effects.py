"""What an effect is: it disturbs what the forks feel or distorts their frequencies, as much as its amplitude says."""

from dataclasses import dataclass, field, replace
from typing import Callable

import numpy as np

from device import UG_PER_G, Device
from history import History
from lag import low_pass
from recording import Recording


@dataclass
class State:
    """What the forks feel. Effects change it; the device then turns it into frequencies."""
    accel_g: np.ndarray
    fork1_c: np.ndarray
    fork2_c: np.ndarray
    common_hz: np.ndarray  # shift of both forks: package stress


@dataclass
class Effect:
    """An effect: `disturb(amplitude, state)` before the device, `distort(amplitude, f1, f2)` after it."""
    name: str
    unit: str  # of the amplitude
    description: str
    parameters: dict = field(default_factory=dict)
    disturb: Callable | None = None
    distort: Callable | None = None
    limits: tuple = (1e-9, 1e6)  # of |amplitude|: a g of bias, or what physics sets
    start: float = 1.0  # of the search for the amplitude
    per_run: bool = False  # (nearly) constant within a run: sized against the map alone, as run offsets would remove it
    positive: bool = False  # physics allows one sign only
    amplitude: float = 0.0

    def with_amplitude(self, amplitude):
        return replace(self, amplitude=amplitude)


def bias_effect(name, unit, description, shape_ug, common_ratio=None, device=None, **options):
    """An effect that adds amplitude * shape_ug to the reading.

    Package stress moves both forks as well: common shift = (shift of the difference) / common_ratio.
    """
    def disturb(amplitude, state):
        bias_g = amplitude * shape_ug / UG_PER_G
        state.accel_g = state.accel_g + bias_g
        if common_ratio is not None:
            state.common_hz = state.common_hz + bias_g * (device.f1_hz * device.s1_per_g) / common_ratio
    if common_ratio is not None:
        options.setdefault("parameters", {})["delta_over_mean_frequency"] = common_ratio
    return Effect(name, unit, description, disturb=disturb, **options)


@dataclass(frozen=True)
class Scene:
    """What a factory of effects may look at."""
    device: Device
    rec: Recording
    past: History

    def filtered(self, values, tau_s):
        return self.past.at_rows(low_pass(self.past.time_s, values, tau_s))

    def temp_rate_k_per_s(self):
        past = self.past
        return past.at_rows(np.gradient(past.temp_c, past.time_s))

    def settled_temp_rate_k_per_s(self, settle_s):
        """The rate behind a lag, without a derivative: (T - L[T])/settle = L[dT/dt]."""
        past = self.past
        return past.at_rows((past.temp_c - low_pass(past.time_s, past.temp_c, settle_s)) / settle_s)
