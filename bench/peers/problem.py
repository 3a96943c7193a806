"""The common problem: noisy samples of a known map, and the network that is to learn it."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np

SAMPLES = 2160
TRUTH_SAMPLES = 20_000
NOISE_G = 5e-6
SEED = 20260711
HIDDEN = 10
WEIGHTS = 4 * HIDDEN + 1
# tempco reads instruments, not unit squares: Hz per unit of x1, degrees per unit of x2.
HZ_PER_UNIT = 80.0
CELSIUS_PER_UNIT = 60.0


def truth_g(x):
    """A resonant accelerometer's inverse map in scaled inputs: a line and what temperature does to it."""
    x1, x2 = x.T
    line = 0.9 * x1 + 0.05 * x2 + 0.02 * x1 * x2
    return line + 0.03 * x2**2 + 0.005 * np.tanh(3 * x2) * x1 + 0.002 * np.sin(4 * x2)


@dataclass
class Problem:
    """Scattered samples for training, and noise-free ones that no training sees.

    Networks learn `y`: what a bilinear form leaves of the samples, in units of its own size. tempco has that form beside
    its network; the peers get the same help.
    """

    x: np.ndarray
    y_g: np.ndarray
    fresh_x: np.ndarray
    fresh_y_g: np.ndarray

    def __post_init__(self):
        self.line = np.linalg.lstsq(bilinear(self.x), self.y_g)[0]
        departure_g = self.y_g - bilinear(self.x) @ self.line
        self.unit_g = rms(departure_g)
        self.y = departure_g / self.unit_g
        self.noise_g = rms(self.y_g - truth_g(self.x))

    @classmethod
    def make(cls):
        random = np.random.default_rng(SEED)
        x = random.uniform(-1.0, 1.0, (SAMPLES, 2))
        y_g = truth_g(x) + NOISE_G * random.standard_normal(SAMPLES)
        fresh = random.uniform(-1.0, 1.0, (TRUTH_SAMPLES, 2))
        return cls(x, y_g, fresh, truth_g(fresh))

    def off_truth_g(self, predict):
        """Root mean square error of a trained network where nobody trained."""
        output_g = predict(self.fresh_x) * self.unit_g + bilinear(self.fresh_x) @ self.line
        return rms(output_g - self.fresh_y_g)

    def write(self, folder: Path):
        """The same samples as campaigns: one to train on, one that holds the truth."""
        paths = folder / "samples.csv", folder / "truth.csv"
        write_campaign(paths[0], self.x, self.y_g)
        write_campaign(paths[1], self.fresh_x, self.fresh_y_g)
        return paths


def bilinear(x):
    return np.column_stack([np.ones(len(x)), x, x[:, 0] * x[:, 1]])


def write_campaign(path, x, y_g):
    time_s = np.arange(len(x))
    columns = np.column_stack([time_s, HZ_PER_UNIT * x[:, 0], CELSIUS_PER_UNIT * x[:, 1], y_g])
    header = "time_s,delta_f_hz,temperature_c,reference_g"
    np.savetxt(path, columns, "%.10f", ",", header=header, comments="")


def rms(values):
    return float(np.sqrt(np.mean(values**2)))


class Network:
    """2-10-1, tanh and linear, all 41 weights in one vector: 10 x w1, 10 x w2, 10 thresholds, 10 outputs, one constant."""

    def __init__(self, x):
        self.x = x

    def hidden(self, weights):
        w1, w2, threshold = weights[: 3 * HIDDEN].reshape(3, HIDDEN)
        return np.tanh(np.outer(self.x[:, 0], w1) + np.outer(self.x[:, 1], w2) + threshold)

    def output(self, weights):
        return self.hidden(weights) @ weights[3 * HIDDEN : -1] + weights[-1]

    def jacobian(self, weights):
        hidden = self.hidden(weights)
        back = (1 - hidden**2) * weights[3 * HIDDEN : -1]
        inputs = [back * self.x[:, [0]], back * self.x[:, [1]], back]
        return np.hstack([*inputs, hidden, np.ones((len(self.x), 1))])


def predictor(weights):
    return lambda x: Network(x).output(weights)


def random_start(random):
    """Standard normal."""
    return random.normal(0.0, 1.0, WEIGHTS)


def bent_start(random, problem):
    """As tempco starts: hidden units are steepest within the domain, and output weights fit as well as they can."""
    w1, w2 = random.uniform(-2.5, 2.5, (2, HIDDEN))
    x1, x2 = random.uniform(-1.0, 1.0, (2, HIDDEN))
    weights = np.concatenate([w1, w2, -(w1 * x1 + w2 * x2), np.zeros(HIDDEN + 1)])
    columns = np.column_stack([Network(problem.x).hidden(weights), np.ones(len(problem.x))])
    weights[3 * HIDDEN :] = np.linalg.lstsq(columns, problem.y)[0]
    return weights
