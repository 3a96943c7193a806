"""Files: a campaign's columns as CSV, under the names that tempco reads."""

import numpy as np

from protocol import AUXILIARY_COLUMNS


def columns_of(rng, lab, rig, noise, rec, frequencies):
    """Columns in order: name -> (format, values)."""
    f1_hz, f2_hz = frequencies
    thermometer_c = np.round(rec.temp_c + noise.thermometer_k * rng.normal(size=len(rec.run)), 4)
    columns = {"time_s": ("%.3f", rec.time_s), "temperature_c": ("%.4f", thermometer_c)}
    columns["reference_g"] = ("%.9f", rec.accel_g)
    if lab.frequency_style == "f1f2":
        columns |= {"f1_hz": ("%.6f", f1_hz), "f2_hz": ("%.6f", f2_hz)}
    else:
        columns["delta_f_hz"] = ("%.6f", f1_hz - f2_hz)
    if lab.frequency_style == "delta_sum":
        columns["sum_f_hz"] = ("%.6f", f1_hz + f2_hz)
    if lab.power_column:
        columns["power_on_s"] = ("%.3f", rec.power_on_s)
    columns["age_days"] = ("%.6f", rec.age_days)
    if lab.sigma_column and rig.position_arcsec:
        columns["reference_sigma_g"] = ("%.9f", np.maximum(np.abs(rec.cross_g) * rig.sigma_rad(), 1e-7))
    if lab.cross:
        columns["cross_g"] = ("%.9f", rec.cross_g)
    formats = {"supply_v": "%.5f", "vibration_g2": "%.6f", "pressure_pa": "%.1f", "humidity_pct": "%.3f"}
    return columns | {name: (formats[name], getattr(rec, name)) for name in AUXILIARY_COLUMNS if name in lab.auxiliary}


def write_campaign(folder, lab, columns, rec):
    """One file with a `run` column, or a file for each run without one."""
    names = [f"run-{index + 1:02d}" for index in range(len(rec.kind))]
    rows = zip(*([fmt % value for value in values] for fmt, values in columns.values()))
    lines = [(run, f"{rec.kind[run]},{','.join(row)}") for run, row in zip(rec.run.tolist(), rows)]
    header = "kind," + ",".join(columns)
    if not lab.file_per_run:
        text = "\n".join(["run," + header] + [f"{names[run]},{line}" for run, line in lines])
        (folder / "campaign.csv").write_text(text + "\n")
        return
    for index, name in enumerate(names):
        text = "\n".join([header] + [line for run, line in lines if run == index])
        (folder / f"{name}.csv").write_text(text + "\n")
