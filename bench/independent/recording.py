"""The recording: true quantities, row after row, as chamber, dividing head and weather carry out a protocol."""

from dataclasses import dataclass, fields

import numpy as np

from lag import low_pass

SECONDS_PER_DAY = 86_400.0
MOST_OFTEN_S = 0.1


@dataclass(frozen=True)
class Recording:
    """All rows of a campaign, run after run. True quantities; what the sensors make of them is added on writing."""
    run: np.ndarray
    kind: list
    time_s: np.ndarray  # since the start of the run
    power_on_s: np.ndarray
    clock_s: np.ndarray  # since midnight of the campaign's first day
    temp_c: np.ndarray
    angle_deg: np.ndarray
    supply_v: np.ndarray
    vibration_g2: np.ndarray
    pressure_pa: np.ndarray
    humidity_pct: np.ndarray

    def of_rows(self, rows):
        """The same with some of its rows."""
        return Recording(**{
            one.name: value if one.name == "kind" else value[rows]
            for one in fields(self) for value in [getattr(self, one.name)]
        })

    @property
    def accel_g(self):
        return np.sin(np.radians(self.angle_deg))

    @property
    def cross_g(self):
        return np.cos(np.radians(self.angle_deg))

    @property
    def age_days(self):
        return self.clock_s / SECONDS_PER_DAY

    @property
    def run_starts(self):
        return np.flatnonzero(np.diff(self.run, prepend=-1))


def record(rng, lab):
    """What happens, run after run on several dates, each starting at some hour of the day; and which rows are written."""
    weather = dict(chamber_tau_s=rng.uniform(200, 600), ripple_k=rng.uniform(0.01, 0.05), ripple_s=rng.uniform(300, 900),
                   phase=rng.uniform(0, 2 * np.pi))
    runs, free_s = [], 0.0
    days = np.linspace(0, lab.dates_span_days, len(lab.plans)) + rng.uniform(-1, 1, len(lab.plans))
    for index, day in enumerate(days):
        start_s = max(np.floor(max(day, 0)) * SECONDS_PER_DAY + rng.uniform(6, 20) * 3600, free_s)
        runs.append(record_run(rng, lab, index, start_s, weather))
        free_s = runs[-1]["clock_s"][-1] + 10 * 3600
    joined = {key: np.concatenate([run[key] for run in runs]) for key in runs[0] if key != "kind"}
    written = joined.pop("written")
    return Recording(kind=[run["kind"] for run in runs], **joined), written


def record_run(rng, lab, index, start_s, weather):
    plan = lab.plans[index]
    time_s, owners, written = sample_times(plan, lab.intervals_s[index], lab.finer, lab.gap_s)
    temp_c = low_pass(time_s, chamber_setpoint(plan, time_s, owners), weather["chamber_tau_s"])
    temp_c = temp_c + weather["ripple_k"] * np.sin(2 * np.pi * time_s / weather["ripple_s"] + rng.uniform(0, 6.28))
    clock_s = start_s + time_s
    on_before_s = 0.0 if plan.kind == "zero" or not lab.power_column or rng.random() < 0.5 else rng.uniform(2, 10) * 3600

    def held(name):
        return np.array([getattr(segment, name) for segment in plan.segments])[owners]

    rows = len(time_s)
    return dict(
        written=written, run=np.full(rows, index), kind=plan.kind,
        time_s=time_s, power_on_s=time_s + on_before_s, clock_s=clock_s,
        temp_c=temp_c, angle_deg=held("angle_deg"),
        supply_v=3.3 + held("supply_v") + rng.normal(0, 5e-4, rows),
        vibration_g2=np.abs(held("vibration_g2") * (1 + rng.normal(0, 0.02, rows)) + rng.normal(0, 1e-4, rows)),
        pressure_pa=held("pressure_pa") + weather_pressure_pa(weather, clock_s),
        humidity_pct=held("humidity_pct") + weather_humidity_pct(weather, clock_s))


def sample_times(plan, interval_s, finer, gap_s):
    """Times, for each the index of its segment, and whether it is written: one of `finer`, and after each turn of the head
    none for `gap_s`."""
    times_s, owners, written, begin_s, angle_deg = [], [], [], 0.0, plan.segments[0].angle_deg
    for owner, segment in enumerate(plan.segments):
        step_s = max(MOST_OFTEN_S, interval_s / segment.density) / finer
        inside = np.arange(0.0, segment.duration_s, step_s)
        quiet_s = gap_s if segment.angle_deg != angle_deg else 0.0
        times_s.append(begin_s + inside)
        owners.append(np.full(len(inside), owner))
        since = np.arange(len(inside)) - int(np.ceil(quiet_s / step_s))
        written.append((since >= 0) & (since % finer == 0))
        begin_s, angle_deg = begin_s + step_s * len(inside), segment.angle_deg
    return np.concatenate(times_s), np.concatenate(owners), np.concatenate(written)


def chamber_setpoint(plan, times_s, owners):
    """The programmed temperature: each segment slews from where the last one ended."""
    setpoint_c = np.empty(len(times_s))
    here_c = plan.start_c
    for owner, segment in enumerate(plan.segments):
        rows = owners == owner
        since_s = times_s[rows] - times_s[rows][0]
        away_k = segment.target_c - here_c
        moved_k = np.minimum(abs(away_k), segment.rate_k_per_min / 60 * since_s)
        setpoint_c[rows] = here_c + np.sign(away_k) * moved_k
        here_c += np.sign(away_k) * min(abs(away_k), segment.rate_k_per_min / 60 * segment.duration_s)
    return setpoint_c


def weather_pressure_pa(weather, clock_s):
    days = clock_s / SECONDS_PER_DAY
    return 101_000 + 900 * np.sin(2 * np.pi * days / 5.3 + weather["phase"]) + 600 * np.sin(2 * np.pi * days / 13.1)


def weather_humidity_pct(weather, clock_s):
    days = clock_s / SECONDS_PER_DAY
    return 42 + 12 * np.sin(2 * np.pi * days / 97 + weather["phase"]) + 4 * np.sin(2 * np.pi * days / 3.7)
