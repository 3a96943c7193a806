"""The history: a recording and the days between its runs."""

from dataclasses import dataclass

import numpy as np

ROOM_C = 23.0


@dataclass(frozen=True)
class History:
    """Everything the device has gone through, the days between runs included: what an effect with a memory integrates."""
    time_s: np.ndarray
    temp_c: np.ndarray
    accel_g: np.ndarray
    humidity_pct: np.ndarray
    is_row: np.ndarray

    def at_rows(self, values):
        return values[self.is_row]


def history_of(rec, written):
    """What the device goes through; `written` says which rows of the recording are in the files.

    Between runs the device cools to the room in an hour and lies at 0 g; two hours before a run it is set for that.
    """
    columns = [rec.clock_s, rec.temp_c, rec.accel_g, rec.humidity_pct, written]
    pieces, starts = [], list(rec.run_starts) + [len(rec.run)]
    for begin, end in zip(starts, starts[1:]):
        if begin:
            pieces.append(storage_knots(columns, begin))
        pieces.append([column[begin:end] for column in columns])
    time_s, temp_c, accel_g, humidity_pct, is_row = (np.concatenate(parts) for parts in zip(*pieces))
    return History(time_s, temp_c, accel_g, humidity_pct, is_row.astype(bool))


def storage_knots(columns, begin):
    clock_s, temp_c, accel_g, humidity_pct, _ = columns
    last_s, next_s = clock_s[begin - 1], clock_s[begin]
    wet = [humidity_pct[begin - 1], *np.interp([0.3, 0.6], [0, 1], humidity_pct[[begin - 1, begin]]), humidity_pct[begin]]
    return [np.array([last_s + 60, last_s + 3660, next_s - 4 * 3600, next_s - 2 * 3600]),
            np.array([temp_c[begin - 1], ROOM_C, ROOM_C, temp_c[begin]]),
            np.array([0.0, 0.0, 0.0, accel_g[begin]]), np.array(wet), np.zeros(4)]
