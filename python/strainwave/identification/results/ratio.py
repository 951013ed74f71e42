"""The ratio that a person gave with files, in a gear set."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

from strainwave import kinematics
from strainwave.files.entries import Entry
from strainwave.files.gear_set import GearSet
from strainwave.identification.reading.recognise import Recognised
from strainwave.identification.results.gear_so_far import GearSoFar

KINEMATICS = "gear.kinematics."
RATIO_TOLERANCE = 1e-9  # relative: two ratios that differ by less are one


def with_ratio_of_all(start: GearSet, files: Sequence[Recognised]) -> GearSet:
    """Return the set with the ratio that a person gave with all files."""
    ratios = {file.constants.get("ratio") for file in files}
    if len(ratios) != 1 or (ratio := ratios.pop()) is None:
        return start
    return _with_kinematics(start, _geared(start.gear, ratio).kinematics, "ratio given with the files")


def with_ratio(known: GearSoFar, file: Recognised) -> GearSoFar:
    """Return the gear so far with the ratio that a person gave with this file."""
    if "ratio" not in file.constants:
        return known
    geared = _geared(known.gear_set.gear, file.constants["ratio"])
    return replace(known, gear_set=_with_kinematics(known.gear_set, geared.kinematics, "ratio given with the file"))


def with_kinematics(known: GearSoFar, of: GearSet) -> GearSoFar:
    """Return the gear so far with the ratio of a set."""
    return replace(known, gear_set=_with_kinematics(known.gear_set, of.gear.kinematics, of))


def _with_kinematics(gear_set: GearSet, other: Any, of: GearSet | str) -> GearSet:
    """Return the set with another ratio, whose source is that of a set, or as given."""
    if gear_set.gear.kinematics == other:
        return gear_set
    sources = {path: entry for path, entry in gear_set.sources.items() if not path.startswith(KINEMATICS)}
    names = [f"{KINEMATICS}{field['name']}" for field in other.fields if field["kind"] != "choice"]
    sources |= {name: Entry(of) if isinstance(of, str) else of.sources[name] for name in names}
    return replace(gear_set, gear=gear_set.gear.replace(kinematics=other), sources=sources)


def _geared(gear: Any, ratio: float) -> Any:
    """Return the gear with another ratio; its output turns the same way as before."""
    if abs(abs(ratio) - abs(gear.kinematics.ratio)) < RATIO_TOLERANCE * abs(ratio):
        return gear
    return gear.replace(kinematics=_kinematics(ratio, gear.kinematics.ratio < 0.0))


def _kinematics(ratio: float, backwards: bool) -> Any:
    """Return a strain wave gear of this ratio, if whole teeth give it; else a plain ratio."""
    size = abs(ratio)
    if abs(size - round(size)) > RATIO_TOLERANCE * size or round(size) < 2:
        return kinematics.PlainRatio(reduction=size)
    turns = 2 * round(size)  # two teeth fewer on the flexspline
    if backwards or ratio < 0.0:
        return kinematics.StrainWave(flexspline_teeth=turns, circular_spline_teeth=turns + 2, fixed="circular_spline")
    return kinematics.StrainWave(flexspline_teeth=turns - 2, circular_spline_teeth=turns, fixed="flexspline")
