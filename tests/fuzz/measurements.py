"""Measurements of no gear that there is: random tables, loops and logs, of any size."""

from __future__ import annotations

import warnings
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import strainwave as sw
from numpy.random import Generator
from numpy.typing import NDArray

from tests.fuzz.laws import Case, described, finite
from tests.fuzz.mutation import picked
from tests.support.strategies import made as usual_of

Array = NDArray[np.float64]
SCALES = (1e-300, 1e-150, 1e-30, 1e-9, 1e-3, *12 * (1.0,), 1e3, 1e9, 1e30, 1e150, 1e300)
SETS = ("hfuc-25-100", "csg-14-50", "shg-58-160")


def measurements_case(random: Generator, folder: Path) -> Case:
    """A gear of one to three measurements, or one fit."""
    start = _whole(picked(random, SETS))
    given = {
        name: made(random)
        for name, made in (("friction", _friction), ("torsion", _torsion), ("run", _log))
        if random.random() < {"friction": 0.6, "torsion": 0.4, "run": 0.15}[name]
    } or {"friction": _friction(random)}
    words = described({name: {column: one[column].tolist() for column in one.names} for name, one in given.items()}, 1000)
    if len(given) == 1 and "friction" in given and random.random() < 0.5:
        free = ["friction_input.coulomb", "friction_input.viscous"]
        gear = start.gear.replace(
            friction_input=picked(
                random, (sw.friction.Coulomb(), usual_of(sw.friction.Stribeck), usual_of(sw.friction.LuGre, viscous=5e-5))
            )
        )
        return Case(f"fit {words}", lambda: sw.fit(gear, given["friction"], free), _check_fit)
    return Case(f"identify {words}", lambda: sw.identify(start, given), lambda found: _check_identified(found, folder))


@cache
def _whole(name: str) -> sw.GearSet:
    """A set with motor and load, so that a log can be looked at."""
    start = sw.GearSet.read(name)
    rest = sw.GearSet.of(sw.Drive(load=sw.loads.Inertia(inertia=0.1)), name="rest", source="assumed")
    others = {path: entry for path, entry in rest.sources.items() if not path.startswith("gear.")}
    return start.replace(motor=rest.motor, control=rest.control, load=rest.load, sources=start.sources | others)


def _friction(random: Generator) -> sw.Recording:
    count = int(random.integers(1, 14))
    speed = picked(random, SCALES) * _series(random, count)
    torque = picked(random, SCALES) * (np.sign(speed) * random.uniform(0.0, 1.0) + random.normal() * _series(random, count))
    return sw.Recording({"speed": speed, "torque": torque}, {"speed": "rad/s", "torque": "N.m"})


def _torsion(random: Generator) -> sw.Recording:
    count = int(random.integers(1, 60))
    phase = np.linspace(0.0, random.uniform(0.1, 20.0), count)
    twist = picked(random, SCALES) * np.sin(phase)
    torque = picked(random, SCALES) * (
        np.sin(phase + random.uniform(-0.5, 1.0)) + 0.1 * random.normal() * _series(random, count)
    )
    if random.random() < 0.3:
        return sw.Recording({"input_angle": twist, "input_torque": torque}, {"input_angle": "rad", "input_torque": "N.m"})
    return sw.Recording({"twist": twist, "torque": torque}, {"twist": "rad", "torque": "N.m"})


def _log(random: Generator) -> sw.Recording:
    count = int(random.integers(2, 40))
    time = np.arange(count) * picked(random, (1e-3, 1e-3, 5e-3, 1e-9, 1e-300)) + picked(random, (0.0, 0.0, 10.0, 1e9))
    columns = {"time": time, "command": picked(random, SCALES) * _series(random, count)}
    units = {"time": "s", "command": "V"}
    for name, unit in (("input_angle", "rad"), ("output_angle", "rad"), ("current", "A"), ("input_speed", "rad/s")):
        if random.random() < 0.5:
            columns[name], units[name] = picked(random, SCALES) * _series(random, count), unit
    try:
        return sw.Recording(columns, units)
    except ValueError:  # time so large that it stands still
        return sw.Recording(columns | {"time": np.arange(float(count)) * 1e-3}, units)


def _series(random: Generator, count: int) -> Array:
    """Random numbers, or such with a pattern that a measurement may have."""
    match random.integers(6):
        case 0:
            return random.normal(size=count)
        case 1:
            return np.round(random.normal(size=count))
        case 2:
            return np.full(count, random.normal())
        case 3:
            return np.linspace(-1.0, 1.0, count)
        case 4:
            return 10.0 ** random.uniform(-12.0, 3.0, size=count)
        case _:
            return np.arange(1.0, count + 1.0)


def _check_fit(fit: sw.identification.Fit) -> None:
    _check_estimates(fit)
    str(fit)
    with warnings.catch_warnings(action="ignore"):
        assert fit.correlation.shape == fit.covariance.shape, "correlation of another shape"


def _check_estimates(fit: Any) -> None:
    assert finite([estimate.value for estimate in fit.estimates]), "an estimate that is not finite"
    assert not any(np.isnan(estimate.sigma) for estimate in fit.estimates), "a standard deviation that is not a number"
    assert finite(fit.predicted), "a prediction that is not finite"


def _check_identified(found: sw.identification.Identified, folder: Path) -> None:
    from strainwave.report.identify import identify_report

    for each in found.files:
        if each.fit is not None:
            _check_estimates(each.fit)
    found.accepted.save(folder / "mine.toml")
    assert sw.GearSet.read(folder / "mine.toml") == found.accepted, "a file holds the gear otherwise"
    report = identify_report(found)
    assert "nan" not in report.lower().split(), "not-a-number in the report"
