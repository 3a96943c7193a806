"""Runs everybody on the same samples, one after the other, and prints one table."""

import argparse
import json
import platform
import subprocess
import sys
import time
import warnings
from datetime import date
from importlib.metadata import version
from pathlib import Path

import numpy as np

import peers
from problem import NOISE_G, SAMPLES, SEED, Problem, rms

RESTARTS = 30
CAP_S = 60.0
# A network has reached the noise when its residual is within five per cent of it.
REACHED = 1.05


class TimeUp(Exception):
    """The time for this peer is over."""


class Watch:
    """Times one peer and keeps the best of what it shows."""

    def __init__(self, target_g):
        self.target_g = target_g
        self.reached_s = None
        self.finals_g = []
        self.best_g = self.kept_g = np.inf
        self.best = None
        self.begin_s = time.perf_counter()

    def elapsed_s(self):
        return time.perf_counter() - self.begin_s

    def restarts(self):
        for index in range(RESTARTS):
            self.finals_g.append(np.inf)
            yield np.random.default_rng([SEED, index])

    def saw(self, residual_g, keep=None):
        self.finals_g[-1] = min(self.finals_g[-1], residual_g)
        self.best_g = min(self.best_g, residual_g)
        if self.reached_s is None and residual_g <= self.target_g:
            self.reached_s = self.elapsed_s()
        if keep and residual_g < self.kept_g:
            self.kept_g, self.best = residual_g, keep()
        if self.elapsed_s() > CAP_S:
            raise TimeUp


def run_peer(peer, problem, target_g):
    name, settings = peer.__doc__.split("|")
    watch = Watch(target_g)
    try:
        peer(problem, watch)
    except TimeUp:
        watch.finals_g[-1:] = []
    except ImportError as error:
        return [name, f"not run: {error.name} is not installed"]
    fresh_g = rms(watch.best(problem.fresh_x) - problem.fresh_y_g)
    median_g = np.median(watch.finals_g) if watch.finals_g else np.inf
    return row(name, settings, len(watch.finals_g), watch.elapsed_s(), watch.reached_s, watch.best_g, median_g, fresh_g)


def tempco(arguments, *command):
    """Wall time of the whole program: start, reading the file, training, writing the model."""
    begin_s = time.perf_counter()
    done = subprocess.run([arguments.tempco, *command, "--json"], check=True, capture_output=True, text=True)
    return json.loads(done.stdout), time.perf_counter() - begin_s


def run_tempco(arguments, problem, target_g):
    samples, truth = problem.write(arguments.work)
    model = str(arguments.work / "model.toml")
    reached_s = None
    for restarts in sorted({1, 3, 10, RESTARTS}):
        options = ["--hold-out", "none", "--restarts", str(restarts), "--output", model]
        trained, elapsed_s = tempco(arguments, "train", str(samples), *options)
        compared, _ = tempco(arguments, "compare", model, str(samples))
        best_g = compared["residual_ug"] * 1e-6
        if reached_s is None and best_g <= target_g:
            reached_s = elapsed_s
    fresh, _ = tempco(arguments, "compare", model, str(truth))
    median_g = np.median([restart["residual_ug"] for restart in trained["restarts"]]) * 1e-6
    fresh_g = fresh["residual_ug"] * 1e-6
    return row("tempco train", "defaults", restarts, elapsed_s, reached_s, best_g, median_g, fresh_g)


def row(name, settings, restarts, elapsed_s, reached_s, best_g, median_g, fresh_g):
    reached = f"{reached_s:.1f}" if reached_s else "not reached"
    median = f"{median_g * 1e6:.2f}" if np.isfinite(median_g) else "none finished"
    return [name, settings, str(restarts), f"{elapsed_s:.1f}", reached, f"{best_g * 1e6:.2f}", median, f"{fresh_g * 1e6:.2f}"]


def machine():
    models = [line.split(":")[1].strip() for line in cpuinfo() if line.startswith("model name")]
    packages = ["numpy", "scipy", "scikit-learn", "torch", "torch-levenberg-marquardt", "pyrenn"]
    versions = ", ".join(f"{package} {version(package)}" for package in packages)
    return f"{date.today()}, {models[0] if models else platform.machine()}, one thread; Python {platform.python_version()}, {versions}"


def cpuinfo():
    path = Path("/proc/cpuinfo")
    return path.read_text().splitlines() if path.exists() else []


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--tempco", type=Path, required=True)
    parser.add_argument("--work", type=Path, required=True)
    arguments = parser.parse_args()
    warnings.simplefilter("ignore")
    problem = Problem.make()
    target_g = REACHED * problem.noise_g
    print(machine())
    print(f"{SAMPLES} samples, noise {NOISE_G * 1e6:.2f} ug ({problem.noise_g * 1e6:.3f} ug in these samples, ")
    print(f"{REACHED} of it is {target_g * 1e6:.3f} ug); {RESTARTS} restarts or {CAP_S:.0f} s, whichever comes first\n")
    header = ["", "settings", "restarts", "s", f"s to {REACHED} x noise", "best ug", "median ug", "fresh ug"]
    print("| " + " | ".join(header) + " |")
    print("|" + "---|" * len(header), flush=True)
    for cells in [run_tempco(arguments, problem, target_g), *(run_peer(peer, problem, target_g) for peer in peers.ALL)]:
        print("| " + " | ".join(cells) + " |", flush=True)


if __name__ == "__main__":
    sys.exit(main())
