"""Gear sets of Harmonic Drive, from the maker's tables and the rules of docs/reference/catalogue.md for assumed figures."""

from __future__ import annotations

import tomllib
from collections.abc import Mapping
from functools import cache
from pathlib import Path
from typing import Any, NamedTuple

from strainwave.files import typical_gear as typical
from strainwave.files.typical_gear import rounded

TABLES_FILE = Path(__file__).parents[1] / "catalogue" / "harmonic-drive.toml"
TOP_RATIO_COLUMN = 80  # the tables of stiffness have one column for it and all above
CSG_OVER_STANDARD = 1.3  # ratings of the high-torque class over those of the standard class, as HFUC
STANDARD_CLASS = "CSF and HFUC are both the standard class"
SHARED_BY_CSG = "HFUC and CSG share it in the other sizes"
HOLLOW_SHAFT_NOTE = "The input inertia is that of the hollow-shaft wave generator, larger than that of a CSG gear of this size."


class ListedGear(NamedTuple):
    """A gear of the tables."""

    series: str
    size: int
    ratio: int

    @property
    def label(self) -> str:
        return f"{self.series}-{self.size}-{self.ratio}"

    @property
    def ratio_column(self) -> str:
        return f"{self.ratio}" if self.ratio < TOP_RATIO_COLUMN else "> 50"

    @property
    def is_borrowed(self) -> bool:
        """True if no table of stiffness or inertia lists the series in this size."""
        return self.series == "HFUC" and self.size in _tables()["hfuc_sizes_in_no_table"]

    def remark(self, table: str, figure: str) -> str:
        """Return the remark of a table on a figure of the gear, after a semicolon; empty if there is none."""
        remarks = _tables()[table]["remarks"].get(figure, {})
        return "".join(f"; {text}" for text, labels in remarks.items() if self.label in labels)


@cache
def gears() -> dict[str, ListedGear]:
    """Return the gears by the names of their sets: those with ratings, and HFUC at the sizes and ratios of CSG."""
    rated = {ListedGear(*key) for key in _figures("ratings")}
    listed = rated | {gear._replace(series="HFUC") for gear in rated if gear.series == "CSG"}
    return {gear.label.lower(): gear for gear in listed}


def document(name: str) -> dict[str, Any]:
    """Return the content of a set, as a gear file has it.

    >>> document("hfuc-25-100")["stiffness"]["k2"]["value"]
    50000.0
    """
    gear = gears()[name]
    ratings, note = _ratings(gear)
    tables = {table: _entries(table, keys, gear) for table, keys in _numbers(gear).items()}
    content = {"name": gear.label, "maker": _tables()["maker"], **tables, "ratings": ratings}
    return content | {"note": note} if note else content


def _numbers(gear: ListedGear) -> dict[str, dict[str, Any]]:
    """Return the numbers of a gear, each with its unit, and the words of its models, by table and key."""
    k1, k2, k3, t1, t2 = _torsional_stiffness(gear).values()
    divided = typical.Divided.of(k1, t1, t2, typical.hysteresis_loss(gear.ratio))
    breakaway = rounded(divided.breakaway[0], 5)
    held = len(divided.breakaway) * breakaway
    elements = [rounded(element, 4) for element in divided.stiffness]
    amplitude = rounded(0.25 * typical.transmission_accuracy(gear.size, gear.ratio), 4)
    dry = rounded(typical.EXACT_STARTING_TORQUE * gear.size**3 / gear.ratio, 4)
    viscous = rounded(typical.EXACT_VISCOUS_FRICTION * (gear.size / 20) ** 3, 4)
    inertia, _ = _inertia(gear)
    return {
        "kinematics": {
            "model": "strain_wave",
            "flexspline_teeth": (2 * gear.ratio, "1"),
            "circular_spline_teeth": (2 * gear.ratio + 2, "1"),
            "fixed": "circular_spline",
        },
        "stiffness": {
            "model": "three_segment",
            "k1": (rounded(k1 * (1.0 - held / t1), 6), "N.m/rad"),
            "k2": (k2, "N.m/rad"),
            "k3": (k3, "N.m/rad"),
            "t1": (round(t1 - held, 8), "N.m"),
            "t2": (round(t2 - held, 8), "N.m"),
        },
        "hysteresis": {
            "model": "maxwell_slip",
            "stiffness": (elements, "N.m/rad"),
            "breakaway": ([breakaway] * len(elements), "N.m"),
        },
        "kinematic_error": {
            "model": "fourier", "order": ([2.0], "1"), "amplitude": ([amplitude], "rad"), "phase": ([0.0], "rad"),
        },
        "friction_input": {
            "model": "coulomb", "coulomb": (dry, "N.m"), "breakaway": (dry, "N.m"), "viscous": (viscous, "N.m.s/rad"),
        },
        "friction_output": {"model": "viscous", "viscous": (0.0, "N.m.s/rad")},
        "gear": {
            "damping": (rounded(typical.damping(k1, gear.ratio, inertia), 4), "N.m.s/rad"),
            "input_inertia": (inertia, "kg.m2"),
        },
    }  # fmt: skip


def _entries(table: str, keys: Mapping[str, Any], gear: ListedGear) -> dict[str, Any]:
    """Return a table of a set, with the source of each number."""
    loss = typical.hysteresis_loss(gear.ratio) / typical.RAD_PER_ARCMIN
    words = {
        **{figure: _spring_source(gear, figure, value) for figure, value in _torsional_stiffness(gear).items()},
        "inertia": _inertia(gear)[1],
        "ratio": gear.ratio,
        "column": gear.ratio_column,
        "loss": loss,
        "half_loss": 0.5 * loss,
        "accuracy": typical.transmission_accuracy(gear.size, gear.ratio) / typical.RAD_PER_ARCMIN,
        "cha_size": "40 and 50, hence 45" if gear.size == 45 else gear.size,  # CHA has none of size 45
    }
    sources: Mapping[str, str] = _tables()["sources"]
    spread = {"spread": typical.UNITS_SPREAD} if table == "stiffness" else {}
    entries: dict[str, Any] = {}
    for key, number in keys.items():
        if isinstance(number, str):
            entries[key] = number
        else:
            value, unit = number
            entries[key] = _entry(value, unit, sources[f"{table}.{key}"].format(**words)) | spread
    return entries


def _torsional_stiffness(gear: ListedGear) -> dict[str, float]:
    return _figures("torsional_stiffness")[min(gear.ratio, TOP_RATIO_COLUMN), gear.size]


def _spring_source(gear: ListedGear, figure: str, value: float) -> str:
    """Return the source of a figure of the whole gear; it states the figures that the set has no number equal to."""
    is_torque = figure.startswith("T")
    stated = {"K1": f" = {value / 1e3:g}e3 N.m/rad", "T1": f" = {value:g} N.m", "T2": f" = {value:g} N.m"}.get(figure, "")
    where = f"size {gear.size}" if is_torque else f"size {gear.size}, ratio {gear.ratio_column}"
    if gear.is_borrowed:
        return f"assumed: {'torque' if is_torque else 'stiffness'} {figure}{stated} of CSG {where}; {SHARED_BY_CSG}"
    in_table = f"{_tables()['torsional_stiffness']['source']}{', torque' if is_torque else ''} {figure}{stated}"
    of_series = "SHG " if gear.series == "SHG" else ""
    return f"{in_table}, {of_series}{where}{gear.remark('torsional_stiffness', figure)}"


def _inertia(gear: ListedGear) -> tuple[float, str]:
    """The inertia of the wave generator [kg.m2], and its source."""
    is_hollow, source = gear.series == "SHG", _tables()["wave_generator"]["source"]
    inertia = _figures("wave_generator")["SHG" if is_hollow else "CSG", gear.size]["inertia"]
    if gear.is_borrowed:
        return inertia, f"assumed: wave generator of CSG size {gear.size}; {SHARED_BY_CSG}"
    if is_hollow:
        return inertia, f"{source}, SHG size {gear.size} (hollow-shaft wave generator)"
    return inertia, f"{source} of the wave generator, size {gear.size}"


def _ratings(gear: ListedGear) -> tuple[dict[str, Any], str]:
    """The ratings of a gear, and the note of its set."""
    published = _figures("ratings").get(gear)
    if published is None:
        return _assumed_ratings(gear)
    table = _tables()["ratings"]
    ratings = {}
    for name, value in published.items():
        source = f"{table['source']}, {table['words'][name]}, {gear.label}{gear.remark('ratings', name)}"
        ratings[name] = _entry(value, "rpm" if name.endswith("speed") else "N.m", source)
    notes = [HOLLOW_SHAFT_NOTE] if gear.series == "SHG" else []
    return ratings, " ".join(notes + [text for text, labels in table["notes"].items() if gear.label in labels])


def _assumed_ratings(gear: ListedGear) -> tuple[dict[str, Any], str]:
    """The ratings of an HFUC gear of which no table has any, and the note of its set."""
    donor = gear._replace(series="CSG")
    peak, ends = _figures("ratings")[donor]["peak_torque"], _figures("csf").get((gear.size, gear.ratio), {})
    peak_source = (
        f"assumed: limit for repeated peak torque of {donor.label}, {peak:g} N.m, over {CSG_OVER_STANDARD:g}; CSG is rated 30 "
        "% above the standard class"
    )
    ratings = {"peak_torque": _entry(rounded(peak / CSG_OVER_STANDARD, 3), "N.m", peak_source)}
    for name, value in ends.items():
        of_csf = f"CSF-{gear.size}-{gear.ratio}" if name == "ratcheting_torque" else f"CSF size {gear.size}"
        ratings[name] = _entry(value, "N.m", f"assumed: that of {of_csf}, {_tables()['csf']['source']}; {STANDARD_CLASS}")
    shared = (
        f"The tables do not list HFUC size {gear.size} at all: stiffness and wave generator inertia are assumed to be those of "
        f"CSG size {gear.size}."
        if gear.is_borrowed
        else "Stiffness and wave generator inertia are common to HFUC and CSG gears of one size."
    )
    return ratings, (
        "Without published ratings: the tables at hand give none for this size and ratio. Peak torque is assumed from CSG"
        f"{', ratcheting and buckling torque from CSF' if ends else ''}. {shared}"
    )


@cache
def _tables() -> Mapping[str, Any]:
    return tomllib.loads(TABLES_FILE.read_text("utf-8"))


@cache
def _figures(table: str) -> dict[tuple[Any, ...], dict[str, float]]:
    """Return the figures of each row of a table by the series, size and ratio that the row has."""
    columns, rows = _tables()[table]["columns"], _tables()[table]["rows"]
    keys = sum(column in ("series", "size", "ratio") for column in columns)
    return {tuple(row[:keys]): dict(zip(columns[keys:], map(float, row[keys:]), strict=True)) for row in rows}


def _entry(value: Any, unit: str, source: str) -> dict[str, Any]:
    return {"value": value, "unit": unit, "source": source}
