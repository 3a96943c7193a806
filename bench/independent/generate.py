#!/usr/bin/env python3
"""Simulates calibration campaigns of resonant accelerometers, to test `tempco` on physics that it was not written with.

    generate.py --class none|single|pair|outside --count N --seed S --out DIR

Each campaign, DIR/CLASS-NUMBER/, holds CSV files with the columns that tempco reads, and truth.json: what is hidden, and
how large. Nothing is shared with the product's own simulator: device, protocol, effects, rig and noise follow formulas of
their own. A campaign is the same whatever the count.

Conventions: times in s; angles in degrees of the dividing head, 0 being a horizontal input axis; accelerations in g;
biases in ug of reading. The "amplitude" of an effect is the one number that is tuned to the wanted signal-to-noise ratio;
everything else about the effect is drawn before and fixed.
"""

import argparse
from pathlib import Path

import numpy as np

from campaign import choose_hidden, simulate
from draws import balanced

CLASSES = ("none", "single", "pair", "outside")


def summary(folder, truth):
    hidden = ", ".join(f"{e['name']} ({e['description']}) snr {e['snr_static']:.2f}" for e in truth["effects"])
    return f"{folder}: {truth['lab']}, {truth['runs']} runs, {truth['rows']} rows, {hidden or 'nothing'}"


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--class", dest="campaign_class", choices=CLASSES, required=True)
    parser.add_argument("--count", type=int, required=True, help="campaigns of the class")
    parser.add_argument("--seed", type=int, required=True)
    parser.add_argument("--out", type=Path, required=True, help="folder that takes a folder for each campaign")
    args = parser.parse_args()
    class_index = CLASSES.index(args.campaign_class)
    lab_rng, rig_rng, hidden_rng = np.random.default_rng([args.seed, class_index]).spawn(3)
    labs = balanced(lab_rng, ["rich", "other", "scarce"], args.count)
    rigs = balanced(rig_rng, [True, False], args.count)
    hidden = choose_hidden(hidden_rng, args.campaign_class, args.count)
    for index, (factories, needs) in enumerate(hidden):
        rng = np.random.default_rng([args.seed, class_index, index])
        folder = args.out / f"{args.campaign_class}-{index}"
        truth = simulate(rng, args.campaign_class, labs[index], rigs[index], factories, needs, folder)
        print(summary(folder, truth), flush=True)


if __name__ == "__main__":
    main()
