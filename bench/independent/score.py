#!/usr/bin/env python3
"""Lets `tempco diagnose` name what campaigns hide, and counts how often it is right.

    score.py --tempco BINARY --work DIR ROOT

ROOT holds a folder for each campaign, with truth.json beside CSV files. The product gets copies of the CSV files alone,
below DIR, where its models stay too.

An effect is visible if an oracle that knows its shape and the noise has a DeltaBIC of at least 60 for it (oracle.py); a
campaign that hides another says nothing about the diagnosis. The last table tells how often an effect is named by what the
oracle knows: the power of the diagnosis.
"""

import argparse
import json
import re
import shutil
import subprocess
import time
from dataclasses import dataclass
from itertools import permutations
from pathlib import Path
from statistics import median

CLASSES = ["none", "single", "pair", "outside"]
# A set of more names than this says nothing.
HONEST = 2
# What the oracle must know of what should be named.
VISIBLE_DELTA_BIC = 60
# Limits of the rows of the last table.
STEPS = [-1e9, 10, 25, 60, 150, 500, 2e3, 1e4, 1e5, 1e12]


@dataclass
class Result:
    """What is hidden in a campaign, and the answer to it: None where the product failed."""

    name: str
    truth: dict
    seconds: float
    answer: dict | None
    message: str = ""

    @property
    def kind(self):
        return self.truth["class"]

    @property
    def real_rig(self):
        return self.truth["rig"]["turn_on_ug"] > 0

    @property
    def visible(self):
        """Whether everything hidden is."""
        return all(hidden["oracle_delta_bic"] >= VISIBLE_DELTA_BIC for hidden in self.truth["effects"])

    @property
    def right(self):
        return self.answer is not None and RIGHT[self.kind](self.truth["effects"], self.answer)

    @property
    def nothing_else(self):
        """Whether every finding is something hidden."""
        return self.answer is not None and all(
            any(meets(finding, hidden) for hidden in self.truth["effects"]) for finding in self.answer["findings"])

    def __str__(self):
        truth = ", ".join(map(measured, self.truth["effects"])) or "nothing"
        rig = f"{'real' if self.real_rig else 'perfect'} rig {self.truth['rig']['snr_static']:.2f}"
        said = f"FAILED: {self.message}" if self.answer is None else spoken(self.answer)
        return f"{self.name:11} {self.seconds:6.1f} s  {said}  | hides {truth}; {rig}"


def title(hidden):
    """What has no name in the product's list goes by its description."""
    return hidden["description"] if hidden["name"] == "outside" else hidden["name"]


def measured(hidden):
    """What is hidden, what a static map leaves of it in units of the noise, and what the oracle knows of it."""
    return f"{title(hidden)} {hidden['snr_static']:.2f} ({hidden['oracle_delta_bic']:.0f})"


def spoken(answer):
    findings = [f"{'~'.join(names(finding))} {finding['evidence']:.0f}" for finding in answer["findings"]]
    unexplained = answer["unexplained"]
    if unexplained:
        findings.append(f"unexplained, by {', '.join(unexplained['depends_on']) or 'no quantity'}")
    return f"{answer['verdict']:15}  {'; '.join(findings) or '-'}"


def names(finding):
    """The effect named, and those that would explain the same."""
    return [finding["effect"], *finding["confounded_with"]]


def meets(finding, hidden):
    """Whether it names what is hidden, or what can't be told from that, in a set small enough to say something."""
    named = names(finding)
    return len(named) <= HONEST and not {hidden["name"], *hidden["also_acceptable"]}.isdisjoint(named)


def nothing_said(_hidden, answer):
    return answer["verdict"] == "nothing-missing"


def first_named(hidden, answer):
    return bool(answer["findings"]) and meets(answer["findings"][0], hidden[0])


def all_named(hidden, answer):
    """Each by a finding of its own."""
    return any(all(map(meets, chosen, hidden)) for chosen in permutations(answer["findings"], len(hidden)))


def left_unexplained(_hidden, answer):
    return answer["verdict"] == "unexplained" and not answer["findings"]


RIGHT = {"none": nothing_said, "single": first_named, "pair": all_named, "outside": left_unexplained}
LABELS = {
    "none": "none: nothing said to be missing",
    "single": f"single, visible: named first, in a set of at most {HONEST}",
    "pair": "pair, both visible: both found",
    "outside": "outside, visible: unexplained, and nothing named",
}
ALONE = {"single": "single, visible: nothing named beside it", "pair": "pair, both visible: nothing named beside them"}


class Failure(Exception):
    """The product's message."""


def tempco(*arguments):
    done = subprocess.run([str(argument) for argument in arguments], capture_output=True, text=True)
    if done.returncode:
        raise Failure(f"{arguments[1]} ended with {done.returncode}: {' '.join(done.stderr.split())}")
    return done.stdout


def diagnosed(binary, work, campaign):
    """Trains and diagnoses on copies of the CSV files, so that the truth isn't beside them."""
    truth = json.loads((campaign / "truth.json").read_text())
    data, model = work / "data" / campaign.name, work / "models" / f"{campaign.name}.toml"
    shutil.rmtree(data, ignore_errors=True)
    data.mkdir(parents=True)
    model.parent.mkdir(parents=True, exist_ok=True)
    for file in campaign.glob("*.csv"):
        shutil.copy(file, data)
    seconds = 0.0
    try:
        tempco(binary, "train", data, "--seed", 1, "--restarts", 3, "-o", model)
        begin = time.monotonic()
        text = tempco(binary, "diagnose", model, data, "--json")
        seconds = time.monotonic() - begin
        return Result(campaign.name, truth, seconds, json.loads(text))
    except (Failure, OSError, json.JSONDecodeError) as failure:
        return Result(campaign.name, truth, seconds, None, str(failure))


def rate(results, kind, what="right"):
    counted = [getattr(result, what) for result in results if result.kind == kind and result.visible]
    return f"{sum(counted)}/{len(counted)}" if counted else "-"


def times(results):
    done = [result for result in results if result.answer]
    if not done:
        return "-", "-"
    longest = max(done, key=lambda result: result.seconds)
    middle = median(result.seconds for result in done), median(result.truth["rows"] for result in done)
    return f"{middle[0]:.1f} s, {middle[1]:.0f} rows", f"{longest.seconds:.1f} s, {longest.truth['rows']} rows"


def table(results):
    """Failed campaigns count as wrong answers as well."""
    columns = [results, [r for r in results if not r.real_rig], [r for r in results if r.real_rig]]
    rows = [[label, *(rate(column, kind) for column in columns)] for kind, label in LABELS.items()]
    rows += [[label, *(rate(column, kind, "nothing_else") for column in columns)] for kind, label in ALONE.items()]
    rows.append(["failed", *(f"{sum(r.answer is None for r in column)}/{len(column)}" for column in columns)])
    middle, longest = zip(*map(times, columns))
    rows += [["diagnosis, median", *middle], ["diagnosis, longest", *longest]]
    lines = [["", "all", "perfect rig", "real rig"], ["---"] * 4, *rows]
    return "\n".join(f"| {' | '.join(line)} |" for line in lines)


def power(results):
    """How often a single effect is named, by what the oracle knows of it."""
    lines = ["| oracle's DeltaBIC | campaigns | named first | alone | something else named |", "| --- " * 5 + "|"]
    single = [(r.truth["effects"][0]["oracle_delta_bic"], r) for r in results if r.kind == "single"]
    for low, high in zip(STEPS, STEPS[1:]):
        inside = [result for known, result in single if low <= known < high]
        if not inside:
            continue
        named = [result for result in inside if result.right]
        alone = [result for result in named if result.nothing_else]
        wrong = [result for result in inside if not result.nothing_else]
        title = f"below {high:g}" if low == STEPS[0] else f"from {low:g}"
        lines.append(f"| {title} | {len(inside)} | {len(named)} | {len(alone)} | {len(wrong)} |")
    return "\n".join(lines)


def in_order(campaign):
    """By class, then by number."""
    kind, number = re.fullmatch(r"(.*?)-?(\d*)", campaign.name).groups()
    return CLASSES.index(kind) if kind in CLASSES else len(CLASSES), kind, int(number or 0)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--tempco", type=Path, required=True, help="the product's binary")
    parser.add_argument("--work", type=Path, required=True, help="folder for copies and models")
    parser.add_argument("root", type=Path, help="folder of campaigns")
    args = parser.parse_args()
    results = []
    for campaign in sorted((path.parent for path in args.root.glob("*/truth.json")), key=in_order):
        results.append(diagnosed(args.tempco.resolve(), args.work, campaign))
        print(results[-1], flush=True)
    print("\n" + table(results))
    if any(result.kind == "single" for result in results):
        print("\n" + power(results))


if __name__ == "__main__":
    main()
