"""Lets selectors of PySINDy and SysIdentPy name the effect that a campaign hides, and counts how often they are right.

The folder holds campaigns as CSV and `truth.json`, which says what each hides, and their noise floor:
{"hidden": {"first": ["thermal-lag"], "second": []}, "noise_ug": 10.7}.
The selectors get every help: the polynomial is fitted before, candidates are what it can't follow, in units of the noise,
and the smallest amplitude worth naming is known.
"""

import argparse
import contextlib
import csv
import io
import json
import warnings
from collections import Counter
from importlib.metadata import version
from pathlib import Path

import numpy as np

# Amplitude in units of the noise; the weakest effects that `tempco simulate --blind` hides are half of it.
WEAKEST = 0.3
MOST_TERMS = 10
# PySINDy's penalty for each sample: candidates that look alike must not blow each other up.
RIDGE = 0.01
# Share of itself that a candidate must keep beside the polynomial; of others nothing can be known.
INDEPENDENT = 0.02
CLASSES = ["none", "single", "outside"]


class Campaign:
    """The columns of a campaign; a column that it lacks is constant."""

    def __init__(self, path):
        with path.open() as file:
            header, *rows = csv.reader(line for line in file if not line.startswith("#"))
        columns = dict(zip(header, zip(*rows)))
        names = np.array(columns.pop("run", ["run"] * len(rows)))
        columns.pop("kind", None)
        self.columns = {name: np.array(values, float) for name, values in columns.items()}
        starts = np.flatnonzero(names[1:] != names[:-1]) + 1
        self.runs = np.split(np.arange(len(rows)), starts)

    def __getitem__(self, name):
        return self.columns.get(name, np.zeros(sum(map(len, self.runs))))

    def each_run(self, follow, name, *settings):
        """What `follow` makes of a column, run by run."""
        return np.concatenate([follow(self["time_s"][run], self[name][run], *settings) for run in self.runs])


def low_pass(time_s, values, tau_s):
    followed, out = values[0], np.empty_like(values)
    for i, (step_s, value) in enumerate(zip(np.diff(time_s, prepend=time_s[0]), values)):
        followed += -np.expm1(-step_s / tau_s) * (value - followed)
        out[i] = followed
    return out


def behind(time_s, values, tau_s):
    """How far the values are ahead of what follows them: their filtered rate, but for a factor."""
    return values - low_pass(time_s, values, tau_s)


def play(time_s, values, width):
    followed, out = values[0], np.empty_like(values)
    for i, value in enumerate(values):
        followed = min(max(followed, value - width / 2), value + width / 2)
        out[i] = followed
    return out


def scaled(values):
    return (values - values.mean()) / (np.abs(values - values.mean()).max() or 1.0)


def polynomial(x, t):
    """Base in difference frequency and temperature, and its slope in temperature."""
    powers = [(i, j) for i in range(3) for j in range(4)]
    base = np.column_stack([x**i * t**j for i, j in powers])
    slope = np.column_stack([x**i * j * t ** max(j - 1, 0) for i, j in powers])
    return base, slope


def library(campaign, slope):
    """Candidate columns; each is the mark of all effects that it names."""
    f_hz, t_c, on_s, age_days = (campaign[c] for c in ["delta_f_hz", "temperature_c", "power_on_s", "age_days"])
    level = scaled(f_hz)
    rate = campaign.each_run(behind, "temperature_c", 35.0)
    candidates = {
        "thermal-lag": rate * slope,
        "thermal-gradient": rate,
        "warm-up": np.exp(-on_s / 600),
        "self-heating": np.exp(-on_s / 900) * slope,
        "thermal-hysteresis": campaign.each_run(play, "temperature_c", 10.0),
        "stress-relaxation": campaign.each_run(behind, "temperature_c", 7200.0),
        "aging": np.log1p(age_days),
        "aging, steadily": age_days,
        "scale-factor-aging/reference-clock": age_days * level,
        "second-order": level**2,
        "third-order": level**3,
        "g-hysteresis": campaign.each_run(behind, "delta_f_hz", 300.0),
        "lock-in": 1 / np.where(np.abs(f_hz) > 0.5, f_hz, np.copysign(0.5, f_hz)),
        "supply-voltage": campaign["supply_v"],
        "vibration-rectification": campaign["vibration_g2"],
        "misalignment/cross-axis": campaign["cross_g"],
        "cross-axis": campaign["cross_g"] * level,
        "pressure": campaign["pressure_pa"],
        "humidity": campaign.each_run(low_pass, "humidity_pct", 4 * 3600.0),
    }
    for at_c in range(-30, 60, 10):
        candidates[f"mode-crossing, at {at_c}"] = (t_c - at_c) / (1 + ((t_c - at_c) / 3) ** 2)
    return candidates


def effects(candidate):
    return set(candidate.split(",")[0].split("/"))


def prepare(path, noise_g):
    """What the polynomial leaves of the references, in units of the noise, and candidates beside the polynomial."""
    campaign = Campaign(path)
    x, t = scaled(campaign["delta_f_hz"]), scaled(campaign["temperature_c"])
    base, base_slope = polynomial(x, t)
    reference_g = campaign["reference_g"]
    coefficients = np.linalg.lstsq(base, reference_g)[0]
    residual_g = reference_g - base @ coefficients
    q = np.linalg.qr(base)[0]
    names, columns = [], []
    for name, column in library(campaign, base_slope @ coefficients).items():
        alone = column - q @ (q.T @ column)
        if column.std() > 0 and alone.std() > INDEPENDENT * column.std():
            names.append(name)
            columns.append(alone / alone.std())
    return names, np.column_stack(columns), residual_g / noise_g


def pysindy_stlsq(names, candidates, residual):
    """PySINDy STLSQ|pysindy"""
    from pysindy import STLSQ

    ridge = RIDGE * len(residual)
    amplitudes = np.abs(STLSQ(threshold=WEAKEST, alpha=ridge).fit(candidates, residual[:, None]).coef_[0])
    return [names[i] for i in np.argsort(-amplitudes) if amplitudes[i] > 0]


def sysidentpy_frols(names, candidates, residual):
    """SysIdentPy FROLS, BIC|sysidentpy"""
    from sysidentpy.basis_function import Polynomial
    from sysidentpy.model_structure_selection import FROLS
    from sysidentpy.parameter_estimation import LeastSquares

    selection = dict(order_selection=True, info_criteria="bic", n_info_values=min(MOST_TERMS, len(names)))
    terms = dict(basis_function=Polynomial(degree=1), model_type="NFIR", xlag=[[1]] * len(names), ylag=1)
    model = FROLS(**selection, **terms, estimator=LeastSquares())
    # It only takes inputs that are at least one sample old.
    model.fit(X=np.roll(candidates, -1, axis=0), y=residual[:, None])
    # 0 is the constant, 1000 the output, 2001 the first input one sample ago.
    return [names[code // 1000 - 2] for code in model.final_model[:, 0] if code >= 2000]


def judged(named, hidden):
    if not named:
        return "none named"
    return "right first" if effects(named[0]) & set(hidden) else "wrong named"


def kind(hidden):
    """What the twin knows and the catalogue doesn't begins with x-."""
    return "none" if not hidden else "outside" if hidden[0].startswith("x-") else "single"


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folder", type=Path)
    folder = parser.parse_args().folder
    warnings.simplefilter("ignore")
    tools = {tool: Counter() for tool in [pysindy_stlsq, sysidentpy_frols]}
    truth = json.loads((folder / "truth.json").read_text())
    for name, hidden in truth["hidden"].items():
        problem = prepare(folder / f"{name}.csv", truth["noise_ug"] * 1e-6)
        for tool, counts in tools.items():
            with contextlib.redirect_stdout(io.StringIO()):
                named = tool(*problem)
            counts[kind(hidden), judged(named, hidden)] += 1
            label = tool.__doc__.split("|")[0]
            print(f"{name} hides {', '.join(hidden) or 'nothing'}; {label} names {'; '.join(named[:3]) or 'none'}")
    answers = ["right first", "wrong named", "none named"]
    print("\n| tool | version | campaign hides | " + " | ".join(answers) + " |\n" + "|---" * 6 + "|")
    for tool, counts in tools.items():
        label, package = tool.__doc__.split("|")
        for hides in CLASSES:
            figures = [str(counts[hides, answer]) for answer in answers]
            print("| " + " | ".join([label, version(package), hides, *figures]) + " |")


if __name__ == "__main__":
    main()
