"""Draws that the standard generator lacks."""

import numpy as np


def log_uniform(rng, low, high):
    return float(np.exp(rng.uniform(np.log(low), np.log(high))))


def signed(rng, magnitude):
    return float(magnitude * rng.choice([-1.0, 1.0]))


def balanced(rng, options, count):
    """`count` options, each in its turn, every round in an order of its own."""
    rounds = -(-count // len(options))
    return [options[k] for _ in range(rounds) for k in rng.permutation(len(options))][:count]
