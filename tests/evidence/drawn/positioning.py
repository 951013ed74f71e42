"""Commanded and measured angles of an axis with a drawn play, in steps to and fro: its lost motion."""

from __future__ import annotations

import tempfile
from pathlib import Path

import numpy as np
from strainwave.identification.identify import identify

from tests.evidence.drawn.outcome import Outcome, compared

UNITS = {"deg": np.pi / 180.0, "arcmin": np.pi / 10_800.0, "rad": 1.0}
NAMES = (("commanded_{}", "measured_{}"), ("target [{}]", "actual [{}]"), ("setpoint angle [{}]", "angle [{}]"))


def outcome(seed: int) -> Outcome:
    """Return the outcome of a record of steps."""
    random = np.random.default_rng(seed)
    step, count = float(np.exp(random.uniform(np.log(1e-4), np.log(2e-2)))), int(random.integers(10, 80))
    play = step * float(random.uniform(0.3, 5.0))
    way = np.concatenate([np.arange(count), np.arange(count, 0, -1)])
    wanted = step * np.append(np.tile(way, int(random.integers(1, 5))), 0)
    reached, place = np.zeros_like(wanted), 0.0
    for row, each in enumerate(wanted):
        place = min(max(place, each - 0.5 * play), each + 0.5 * play)
        reached[row] = place
    length = step * count
    reached += play * float(random.uniform(0.0, 0.3)) * np.sin(2.0 * np.pi * wanted / length + float(random.uniform(0.0, 6.0)))
    reached += play * float(random.uniform(0.005, 0.1)) * random.standard_normal(len(wanted))
    unit = str(random.choice(list(UNITS)))
    names = [name.format(unit) for name in NAMES[int(random.integers(len(NAMES)))]]
    columns = {"step": np.arange(len(wanted)), names[0]: wanted / UNITS[unit], names[1]: reached / UNITS[unit]}
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder, "dial.csv")
        np.savetxt(path, np.stack(list(columns.values()), axis=1), "%.9g", ",", header=",".join(columns), comments="")
        try:
            found = identify("csg-20-100", [path])
        except ValueError as refused:
            return Outcome("refused", f"{', '.join(columns)}: {refused}")
    own = [each for file in found.files for each in file.estimates if each.path == "lost_motion"]
    if found.failed or not own:
        return Outcome("refused", "; ".join([*(each.message for each in found.failed), *found.files[0].remarks]))
    result = compared((each.path, each.value, each.sigma, play) for each in own)
    return Outcome(result.verdict, f"{count} steps of {step / play:.2g} plays, {len(wanted)} rows: {result.message}")
