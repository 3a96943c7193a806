"""The protocol: what a laboratory does run by run, and which columns it records."""

from dataclasses import dataclass

import numpy as np

from draws import log_uniform

AUXILIARY_COLUMNS = ("supply_v", "vibration_g2", "pressure_pa", "humidity_pct")


@dataclass(frozen=True)
class Segment:
    """A stretch of a run: the chamber heads for `target_c`, everything else is held."""
    duration_s: float
    target_c: float
    angle_deg: float = 0.0
    rate_k_per_min: float = 4.0
    density: float = 1.0  # samples per time, relative to the run's other segments
    supply_v: float = 0.0  # deviation from the nominal supply
    vibration_g2: float = 0.0
    pressure_pa: float = 0.0  # deviation from the weather
    humidity_pct: float = 0.0  # deviation from the room


@dataclass(frozen=True)
class RunPlan:
    kind: str
    start_c: float
    segments: list


@dataclass(frozen=True)
class Lab:
    """What one laboratory does and records."""
    name: str
    dates_span_days: float
    cross: bool
    power_column: bool
    frequency_style: str  # f1f2 | delta_sum | delta
    auxiliary: frozenset  # of supply_v, vibration_g2, pressure_pa, humidity_pct
    file_per_run: bool
    sigma_column: bool
    plans: list
    intervals_s: list
    finer: int = 1  # steps of what happens for each row that is written
    gap_s: float = 0.0  # without rows after each turn of the head


def full_run(rng, descending):
    """Soaked temperature nodes, four states at each: +1, -1, +0, -0 g in an order of its own."""
    nodes_c = np.linspace(-40, 60, int(rng.choice([5, 6, 6, 9])))
    nodes_c = nodes_c[::-1] if descending else nodes_c
    soak_s = rng.uniform(1200, 3600)
    segments = []
    for node_c in nodes_c:
        segments.append(Segment(soak_s + 900, node_c, 0.0))
        segments += [Segment(150, node_c, angle, density=3) for angle in rng.permutation([0.0, 90.0, 180.0, 270.0])]
    return RunPlan("full", float(nodes_c[0]), segments)


def ramp_run(rng, angle_deg):
    """Up and down (or down and up) at one rate, with a hold at the turning point."""
    rate = log_uniform(rng, 0.35, 3.0)
    cold, hot = rng.uniform(-40, -15), rng.uniform(40, 60)
    first, last = (cold, hot) if rng.random() < 0.5 else (hot, cold)
    travel_s = 60 * (hot - cold) / rate
    hold_s = rng.uniform(600, 2400)
    return RunPlan("ramp", first, [
        Segment(600, first, angle_deg), Segment(travel_s, last, angle_deg, rate), Segment(hold_s, last, angle_deg),
        Segment(travel_s, first, angle_deg, rate), Segment(hold_s, first, angle_deg)])


def zero_run(rng):
    temp_c = float(rng.choice([-20.0, 23.0, 25.0, 50.0])) + rng.normal(0, 1)
    drift_k = rng.uniform(-0.7, 0.7)
    duration_s = rng.uniform(3600, 6600)
    return RunPlan("zero", temp_c, [Segment(duration_s, temp_c + drift_k, 0.0, 60 * abs(drift_k) / duration_s)])


def tumble_run(rng, positions):
    temp_c = float(rng.choice([-35.0, -10.0, 25.0, 25.0, 55.0]))
    angles = (rng.uniform(0, 20) + np.arange(positions) * 360.0 / positions) % 360.0
    if rng.random() < 0.6:
        angles = rng.permutation(angles)
    dwell_s = max(60.0, 1100.0 / positions) * rng.uniform(1.0, 2.0)
    return RunPlan("tumble", temp_c, [Segment(dwell_s, temp_c, float(angle)) for angle in angles])


def soak_run(rng):
    """A temperature step, then hours of nothing: where slow relaxations show."""
    before, after = rng.permutation([rng.uniform(-35, 0), rng.uniform(35, 60)])
    angle_deg = float(rng.choice([0.0, 30.0, 90.0]))
    return RunPlan("soak", float(before), [
        Segment(900, before, angle_deg), Segment(rng.uniform(3, 7) * 3600, after, angle_deg)])


def sweep_run(rng, column):
    """One auxiliary quantity in steps while the chamber stays; three poses, so that bias and scale factor both show."""
    levels = {
        "supply_v": rng.permutation([0.0, 0.08, 0.16, -0.08, -0.16, 0.0]),
        "vibration_g2": rng.permutation([0.0, 1.0, 4.0, 9.0, 16.0, 0.0]),
        "pressure_pa": rng.permutation([0.0, -1e4, -2e4, -4e4, 3e3, 0.0]),
        "humidity_pct": np.array([0.0, 40.0, -15.0]),
    }[column]
    dwell_s = 6 * 3600.0 if column == "humidity_pct" else 400.0
    poses = (0.0,) if column == "humidity_pct" else (0.0, 90.0, 210.0)
    temp_c = float(rng.choice([0.0, 25.0, 45.0]))
    segments = [Segment(dwell_s, temp_c, pose, **{column: float(level)}) for pose in poses for level in levels]
    return RunPlan("static", temp_c, segments)


def draw_plans(rng, run_count, auxiliary):
    """The compulsory runs, then a draw among the kinds, in a mixed order."""
    plans = [full_run(rng, False), full_run(rng, True), ramp_run(rng, 0.0), ramp_run(rng, 0.0), ramp_run(rng, 40.0),
             zero_run(rng), zero_run(rng), tumble_run(rng, 24), tumble_run(rng, 12), soak_run(rng)]
    plans += [sweep_run(rng, column) for column in sorted(auxiliary)]
    extra = [lambda: full_run(rng, rng.random() < 0.5),
             lambda: ramp_run(rng, float(rng.choice([0.0, 90.0, 200.0, 270.0]))),
             lambda: zero_run(rng),
             lambda: tumble_run(rng, int(rng.choice([4, 6, 8, 12, 24]))),
             lambda: soak_run(rng)]
    while len(plans) < run_count:
        plans.append(extra[rng.integers(len(extra))]())
    return [plans[k] for k in rng.permutation(len(plans))]


def draw_rich_lab(rng, needs):
    auxiliary = needs_auxiliary(needs) | optional_auxiliary(rng, 0.35)
    plans = draw_plans(rng, int(rng.integers(20, 29)), auxiliary)
    rows = 20_600 / len(plans)
    intervals_s = [max(1.0, sum(s.duration_s * s.density for s in plan.segments) / rows) for plan in plans]
    styles = ["f1f2", "delta_sum"] if "sum" in needs else ["f1f2", "delta_sum", "delta"]
    return Lab("rich", rng.uniform(60, 150), True, True, str(rng.choice(styles)), auxiliary, False,
               rng.random() < 0.7, plans, intervals_s)


def draw_other_lab(rng, needs):
    """Fewer runs, one file each, a fixed sampling interval per kind of run, often fewer columns."""
    auxiliary = needs_auxiliary(needs) | optional_auxiliary(rng, 0.15)
    plans = draw_plans(rng, int(rng.integers(12, 21)), auxiliary)
    quick_s, slow_s = rng.uniform(1, 3), rng.uniform(8, 20)
    intervals_s = [quick_s if plan.kind in ("zero", "tumble") else slow_s for plan in plans]
    styles = ["f1f2", "delta_sum"] if "sum" in needs else ["f1f2", "delta_sum", "delta", "delta"]
    return Lab("other", rng.uniform(60, 150), "cross" in needs or rng.random() < 0.5, rng.random() < 0.5,
               str(rng.choice(styles)), auxiliary, True, rng.random() < 0.3, plans, intervals_s)


def draw_scarce_lab(rng, needs):
    """One kind of run, one interval for all, seconds missing after each turn of the head: what many people have."""
    auxiliary = needs_auxiliary(needs)
    kinds = {
        "ramps only": lambda: ramp_run(rng, float(rng.choice([0.0, 20.0, 90.0, 160.0, 200.0, 270.0, 340.0]))),
        "nodes only": lambda: full_run(rng, rng.random() < 0.5),
        "three levels": lambda: levels_run(rng, (0.0, 90.0, 270.0)),
        "turned on ramps": lambda: levels_run(rng, (0.0, 90.0, 180.0, 270.0, 45.0, 225.0)),
    }
    kind = kinds[str(rng.choice(list(kinds)))]
    plans = [kind() for _ in range(int(rng.integers(4, 9)))] + [sweep_run(rng, column) for column in sorted(auxiliary)]
    duration_s = sum(segment.duration_s for plan in plans for segment in plan.segments)
    interval_s = max(log_uniform(rng, 0.1, 60), duration_s / 40_000)
    styles = ["f1f2", "delta_sum"] if "sum" in needs else ["f1f2", "delta"]
    return Lab("scarce", rng.uniform(3, 60), "cross" in needs, rng.random() < 0.5, str(rng.choice(styles)), auxiliary,
               rng.random() < 0.5, False, plans, [interval_s] * len(plans), finer=4 if interval_s > 4 else 1,
               gap_s=float(rng.choice([0.0, 10.0, 30.0])))


def levels_run(rng, angles_deg):
    """A loop of the chamber without a pause, the head turned all the while."""
    rate, dwell_s = log_uniform(rng, 0.35, 3.0), rng.uniform(60, 300)
    cold, hot = rng.uniform(-40, -15), rng.uniform(40, 60)
    first, last = (cold, hot) if rng.random() < 0.5 else (hot, cold)
    steps = int(np.ceil(60 * (hot - cold) / rate / dwell_s))
    turns = [float(angles_deg[k % len(angles_deg)]) for k in range(2 * steps)]
    there = [Segment(dwell_s, last, angle, rate) for angle in turns[:steps]]
    back = [Segment(dwell_s, first, angle, rate) for angle in turns[steps:]]
    return RunPlan("loop", first, [Segment(dwell_s, first, turns[-1]), *there, *back])


def needs_auxiliary(needs):
    return frozenset(needs) & frozenset(AUXILIARY_COLUMNS)


def optional_auxiliary(rng, probability):
    return frozenset(column for column in AUXILIARY_COLUMNS if rng.random() < probability)
