"""The first-order lag, which chambers, stresses and moisture have in common."""

import numpy as np


def low_pass(time_s, values, tau_s):
    """tau dy/dt = u - y, integrated exactly for an input that is linear between samples; starts settled.

    With slope m over a step h:  y1 = u1 - m tau + (y0 - u0 + m tau) e^(-h/tau).  tau_s may be one value per step.
    """
    step_s = np.diff(time_s)
    tau_s = np.broadcast_to(tau_s, step_s.shape)
    lag = np.diff(values) / step_s * tau_s
    decay = np.exp(-step_s / tau_s)
    out = np.empty(len(values))
    out[0] = values[0]
    for k in range(len(step_s)):
        out[k + 1] = values[k + 1] - lag[k] + (out[k] - values[k] + lag[k]) * decay[k]
    return out
