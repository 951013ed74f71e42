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
RATING_WORDS = {
    "rated_torque": "rated torque at 2000 rpm",
    "average_torque": "limit for average torque",
    "peak_torque": "limit for repeated peak torque",
    "momentary_torque": "limit for momentary peak torque",
    "maximum_input_speed": "maximum input speed",
    "average_input_speed": "limit for average input speed",
}
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
    inertia, inertia_source = _inertia(gear)
    damping = typical.damping(_torsional_stiffness(gear)["K1"], gear.ratio, inertia)
    ratings, note = _ratings(gear)
    content = {
        "name": gear.label,
        "maker": _tables()["maker"],
        "kinematics": _kinematics(gear),
        **_torsion(gear),
        "kinematic_error": _kinematic_error(gear),
        **_friction(gear),
        "gear": {
            "damping": _entry(
                rounded(damping, 4),
                "N.m.s/rad",
                "assumed: 2 % of critical for the wave generator swinging against a held output, "
                "0.04 sqrt(K1 x ratio^2 x input_inertia)",
            ),
            "input_inertia": _entry(inertia, "kg.m2", inertia_source),
        },
        "ratings": ratings,
    }
    return content | {"note": note} if note else content


def _kinematics(gear: ListedGear) -> dict[str, Any]:
    teeth, rule = 2 * gear.ratio, f"ratio {gear.ratio} with the circular spline fixed: z_f = 2 x ratio"
    return {
        "model": "strain_wave",
        "flexspline_teeth": _entry(teeth, "1", rule),
        "circular_spline_teeth": _entry(teeth + 2, "1", "two teeth more than the flexspline"),
        "fixed": "circular_spline",
    }


def _torsion(gear: ListedGear) -> dict[str, Any]:
    """The tables of stiffness and hysteresis: the figures of the whole gear, divided between both."""
    k1, k2, k3, t1, t2 = _torsional_stiffness(gear).values()
    bound = typical.hysteresis_loss(gear.ratio)
    divided = typical.Divided.of(k1, t1, t2, bound)
    breakaway = rounded(divided.breakaway[0], 5)
    held = len(divided.breakaway) * breakaway
    width = f"{0.5 * bound / typical.RAD_PER_ARCMIN:.3g} arcmin"
    of_k1 = _spring_source(gear, "K1", f" = {k1 / 1e3:g}e3 N.m/rad")
    spring = {
        "k1": (
            rounded(k1 * (1.0 - held / t1), 6),
            f"{of_k1}; the spring's part K1 (1 - F/T1), with F the sum of the hysteresis breakaways",
        ),
        "k2": (k2, _spring_source(gear, "K2")),
        "k3": (k3, _spring_source(gear, "K3")),
        "t1": (round(t1 - held, 8), f"{_spring_source(gear, 'T1', f' = {t1:g} N.m')}; the spring's part T1 - F"),
        "t2": (round(t2 - held, 8), f"{_spring_source(gear, 'T2', f' = {t2:g} N.m')}; the spring's part T2 - F"),
    }
    units = {key: "N.m/rad" if key.startswith("k") else "N.m" for key in spring}
    entries = {key: _entry(value, units[key], source) for key, (value, source) in spring.items()}
    hysteresis = {
        "model": "maxwell_slip",
        "stiffness": _entry(
            [rounded(element, 4) for element in divided.stiffness],
            "N.m/rad",
            "assumed: 2/3, 1/3 and 1/6 of k1, so that all elements slip well below T1; at a reversal the gear is at first "
            "13/6 k1 stiff",
        ),
        "breakaway": _entry(
            [breakaway] * len(divided.breakaway),
            "N.m",
            f"assumed: k1 x {width} / 6 each: loop {width} wide at zero torque, half the bound on hysteresis loss "
            f"(< {bound / typical.RAD_PER_ARCMIN:.3g} arcmin)",
        ),
    }
    spread = {"spread": typical.UNITS_SPREAD}
    stiffness = {"model": "three_segment"} | {key: entry | spread for key, entry in entries.items()}
    return {"stiffness": stiffness, "hysteresis": hysteresis}


def _torsional_stiffness(gear: ListedGear) -> dict[str, float]:
    return _figures("torsional_stiffness")[min(gear.ratio, TOP_RATIO_COLUMN), gear.size]


def _spring_source(gear: ListedGear, figure: str, value: str = "") -> str:
    is_torque = figure.startswith("T")
    where = f"size {gear.size}" if is_torque else f"size {gear.size}, ratio {gear.ratio_column}"
    if gear.is_borrowed:
        return f"assumed: {'torque' if is_torque else 'stiffness'} {figure}{value} of CSG {where}; {SHARED_BY_CSG}"
    document_place = f"{_tables()['torsional_stiffness']['source']}{', torque' if is_torque else ''} {figure}{value}"
    of_series = "SHG " if gear.series == "SHG" else ""
    return f"{document_place}, {of_series}{where}{gear.remark('torsional_stiffness', figure)}"


def _kinematic_error(gear: ListedGear) -> dict[str, Any]:
    bound = typical.transmission_accuracy(gear.size, gear.ratio)
    sizes = "40 and 50, hence 45" if gear.size == 45 else gear.size  # CHA has none of size 45
    amplitude_source = (
        f"assumed: peak to peak half the bound on transmission accuracy (< {bound / typical.RAD_PER_ARCMIN:.3g} arcmin, CHA "
        f"engineering data, size {sizes}, ratio {gear.ratio_column})"
    )
    return {
        "model": "fourier",
        "order": _entry([2.0], "1", "assumed: the two lobes of the wave generator; the catalogue gives no spectrum"),
        "amplitude": _entry([rounded(0.25 * bound, 4)], "rad", amplitude_source),
        "phase": _entry([0.0], "rad", "assumed: the wave generator angle counts from a zero of the error"),
    }


def _friction(gear: ListedGear) -> dict[str, Any]:
    dry = rounded(typical.EXACT_STARTING_TORQUE * gear.size**3 / gear.ratio, 4)
    viscous = rounded(typical.EXACT_VISCOUS_FRICTION * (gear.size / 20) ** 3, 4)
    breakaway_source = "starting torque ~ size^3 / ratio through the catalogue figures of CSF-17-100 and CSF-25-50"
    viscous_source = "~ size^3 through the no-load running torque of CPL-20-160 at 3500 rpm, 20 degC"
    output_source = "none; no-load backdriving torque = ratio x starting torque, so the friction is at the input"
    return {
        "friction_input": {
            "model": "coulomb",
            "coulomb": _entry(dry, "N.m", "assumed: equal to breakaway; no measurement at hand tells the two apart"),
            "breakaway": _entry(dry, "N.m", f"assumed: {breakaway_source}"),
            "viscous": _entry(viscous, "N.m.s/rad", f"assumed: {viscous_source}"),
        },
        "friction_output": {"model": "viscous", "viscous": _entry(0.0, "N.m.s/rad", f"assumed: {output_source}")},
    }


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
        source = f"{table['source']}, {RATING_WORDS[name]}, {gear.label}{gear.remark('ratings', name)}"
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
