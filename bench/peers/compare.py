"""Runs everybody on the same samples, one after the other, and prints one table."""

import argparse
import json
import os
import platform
import resource
import subprocess
import time
import warnings
from datetime import date
from importlib.metadata import version
from pathlib import Path

import numpy as np

import peers
from problem import NOISE_G, SAMPLES, SEED, Problem

RESTARTS = 30
# A network has reached the noise when its residual is within five per cent of it.
REACHED = 1.05


class TimeUp(Exception):
    """The time for this peer is over."""


class Watch:
    """Times one peer and keeps the best of what it shows."""

    def __init__(self, target, cap_s):
        self.target = target
        self.cap_s = cap_s
        self.reached_s = None
        self.finals = []
        self.least = np.inf
        self.best = None

    def elapsed_s(self):
        return time.process_time() - self.begin_s

    def restarts(self):
        """The random numbers of every restart. The clock runs from here: libraries have been imported."""
        self.begin_s = time.process_time()
        for index in range(RESTARTS):
            self.finals.append(np.inf)
            yield np.random.default_rng([SEED, index])

    def saw(self, residual, keep):
        self.finals[-1] = min(self.finals[-1], residual)
        if self.reached_s is None and residual <= self.target:
            self.reached_s = self.elapsed_s()
        if residual < self.least:
            self.least, self.best = residual, keep()
        if self.elapsed_s() > self.cap_s:
            raise TimeUp


def run_peer(arguments, problem, target_g, peer):
    name, package, settings = peer.__doc__.split("|")
    watch = Watch(target_g / problem.unit_g, arguments.seconds)
    try:
        peer(problem, watch)
    except TimeUp:
        watch.finals.pop()
    elapsed_s = watch.elapsed_s()
    best_g = watch.least * problem.unit_g
    median_g = np.median(watch.finals) * problem.unit_g if watch.finals else None
    cells = [name, version(package), settings, str(len(watch.finals))]
    return cells + measured(elapsed_s, watch.reached_s, best_g, median_g, problem.off_truth_g(watch.best))


def run_tempco(arguments, paths, target_g, name, settings, train):
    """These are whole programs, timed from start to end with so many restarts."""
    reached_s = None
    for restarts in [1, 3, 10, RESTARTS]:
        elapsed_s, best_g, median_g, truth_g = train(arguments, paths, str(restarts))
        if reached_s is None and best_g <= target_g:
            reached_s = elapsed_s
    own_version = output(arguments.tempco, "--version").split()[1]
    return [name, own_version, settings, str(restarts)] + measured(elapsed_s, reached_s, best_g, median_g, truth_g)


def solver_alone(arguments, paths, restarts):
    printed, elapsed_s = timed(arguments.solver, *paths, restarts)
    finals_g = [[float(residual_ug) * 1e-6 for residual_ug in line.split()] for line in printed.splitlines()]
    best_g, truth_g = min(finals_g)
    return elapsed_s, best_g, np.median([final_g for final_g, _ in finals_g]), truth_g


def train_command(arguments, paths, restarts):
    model = arguments.work / "model.toml"
    options = ["--hold-out", "none", "--restarts", restarts, "--output", model, "--json"]
    trained, elapsed_s = timed(arguments.tempco, "train", paths[0], *options)
    median_g = np.median([restart["residual_ug"] for restart in json.loads(trained)["restarts"]]) * 1e-6
    compared = [json.loads(output(arguments.tempco, "compare", model, path, "--json")) for path in paths]
    best_g, truth_g = (comparison["residual_ug"] * 1e-6 for comparison in compared)
    return elapsed_s, best_g, median_g, truth_g


def timed(*command):
    """What a program prints, and the time that it keeps a processor busy."""
    begin_s = children_s()
    return output(*command), children_s() - begin_s


def children_s():
    usage = resource.getrusage(resource.RUSAGE_CHILDREN)
    return usage.ru_utime + usage.ru_stime


def output(*command):
    return subprocess.run(command, check=True, stdout=subprocess.PIPE, text=True).stdout


def measured(elapsed_s, reached_s, best_g, median_g, truth_g):
    reached = f"{reached_s:.1f}" if reached_s else "not reached"
    median = f"{median_g * 1e6:.2f}" if median_g else "none finished"
    return [f"{elapsed_s:.1f}", reached, f"{best_g * 1e6:.2f}", median, f"{truth_g * 1e6:.2f}"]


def machine():
    path = Path("/proc/cpuinfo")
    lines = path.read_text().splitlines() if path.exists() else []
    models = [line.split(":")[1].strip() for line in lines if line.startswith("model name")]
    load = f"{os.cpu_count()} cores, load {os.getloadavg()[0]:.1f}"
    versions = f"Python {platform.python_version()}, NumPy {version('numpy')}, torch {version('torch')}"
    return f"{date.today()}, {models[0] if models else platform.machine()}, {load}; one thread each; {versions}"


def show(cells):
    print("| " + " | ".join(cells) + " |", flush=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--tempco", type=Path, required=True)
    parser.add_argument("--solver", type=Path, required=True, help="the trainer's example `scattered`")
    parser.add_argument("--work", type=Path, required=True)
    parser.add_argument("--seconds", type=float, default=60.0, help="CPU time for each peer")
    arguments = parser.parse_args()
    warnings.simplefilter("ignore")
    problem = Problem.make()
    paths = problem.write(arguments.work)
    target_g = REACHED * problem.noise_g
    print(machine())
    print(f"{SAMPLES} samples, noise {NOISE_G * 1e6:.2f} ug ({problem.noise_g * 1e6:.3f} ug in these samples),")
    print(f"stopping residual {target_g * 1e6:.3f} ug; {RESTARTS} restarts or {arguments.seconds:.0f} s of CPU time\n")
    figures = ["CPU s", "s to stopping residual", "best ug", "median ug", "truth ug"]
    show(["peer", "version", "settings", "restarts", *figures])
    show(["---"] * 9)
    show(run_tempco(arguments, paths, target_g, "tempco's solver alone", "1000 iterations", solver_alone))
    show(run_tempco(arguments, paths, target_g, "tempco train", "defaults", train_command))
    for peer in peers.ALL:
        show(run_peer(arguments, problem, target_g, peer))


if __name__ == "__main__":
    main()
