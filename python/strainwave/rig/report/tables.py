"""The tables of a torsion test's report, in print."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from math import degrees, floor, isfinite, log10
from typing import Any, NamedTuple

import numpy as np

from strainwave.rig.analysis.analysis import DEFINITIONS, Definition, LoopAnalysis, table
from strainwave.rig.analysis.comparison import ComparedQuantity, Comparison
from strainwave.rig.analysis.regimes import NAMES, RegimeName
from strainwave.rig.analysis.result import Result
from strainwave.rig.analysis.stiffness import SOFT_COMPLIANCE_RATIO, closure_of_secants, soft_parts, words_on_band
from strainwave.rig.bench.setup import Camera, Rig, Value
from strainwave.rig.bench.torque import Budget
from strainwave.rig.reading.evaluation import Evaluation, budgets
from strainwave.rig.report.figures import angle_unit, comparison_figure, loop_figure, stiffness_figure
from strainwave.rig.virtual.printed import PEAK_TORQUE, TABLE_2
from strainwave.rig.vision.angle import Angles
from strainwave.typeset import ARCMIN_PER_RADIAN, ARCSEC_PER_DEGREE, ZERO_CELSIUS, fixed, number, uncertain

OF_REGIMES = tuple(name.replace("_", " ") for name in NAMES)  # how remarks on one regime begin
BAND = (0.1, 0.2)  # N.m: where the torsional stiffness article saw its soft spot
TITLES: dict[Definition, str] = {
    "softest": "Stiffness of the softest straight stretch of each regime",
    "regression": "Stiffness by regression: one straight line through each regime",
    "secant": "Stiffness by secant: peak torque over the angle from zero torque to the peak",
}
DEFAULT_DIGITS = 4  # of a value whose uncertainty is not known
MAX_DIGITS = 6  # of a value, however small its uncertainty


class Stated(NamedTuple):
    """A number in print.

    Attributes:
        value: rounded to what its interval allows
        interval: both ends, empty if the uncertainty is not known
    """

    value: str
    interval: str

    def __str__(self) -> str:
        return f"{self.value} ({self.interval})" if self.interval else self.value


def stated(found: Result | None, scale: float = 1.0) -> Stated:
    """A number times a scale, rounded to the second digit of half its interval.

    >>> str(stated(Result(4.5123, "N.m/rad", 0.04, 0.02, 4.4247, 4.5999)))
    '4.512 (4.425 to 4.600)'
    >>> str(stated(Result(0.30634, "J", float("nan"), 0.0, float("nan"), float("nan"))))
    '0.3063'
    >>> str(stated(None))
    '—'
    """
    if found is None or not isfinite(found.value):
        return Stated("—", "")
    value, low, high = (scale * each for each in (found.value, found.low, found.high))
    if not (isfinite(high - low) and high > low):
        return Stated(
            number(value, DEFAULT_DIGITS),
            f"{number(low, DEFAULT_DIGITS)} to {number(high, DEFAULT_DIGITS)}" if high > low else "",
        )
    places = 1 - floor(log10(0.5 * (high - low)))
    most = MAX_DIGITS - 1 - floor(log10(max(abs(low), abs(high))))
    if not -3 <= min(places, most) <= MAX_DIGITS:
        return Stated(number(value, MAX_DIGITS), f"{number(low, MAX_DIGITS)} to {number(high, MAX_DIGITS)}")
    texts = [fixed(each, min(places, most)) for each in (value, low, high)]
    return Stated(texts[0], f"{texts[1]} to {texts[2]}" if texts[1] != texts[2] else f"± {number(0.5 * (high - low), 1)}")


def sentence(words: str) -> str:
    """Words as a sentence in print: signs and units set as such.

    >>> sentence("soft from -0.1 N.m on")
    'Soft from −0.1 N·m on.'
    >>> sentence("step-005.png: is empty")
    'step-005.png: is empty.'
    """
    signed = re.sub(r"(?<![\w.])-(?=\d)", "−", words.replace("N.m", "N·m"))
    first = signed[0] if re.match(r"\S+\.[A-Za-z]+:", signed) else signed[0].upper()  # a file's name stays as it is
    return f"{first}{signed[1:]}."


def ratio_of(found: Evaluation) -> float | None:
    """Turns of the input for one of the output, where the loops were measured at the input and the gear is known."""
    if found.gear_set is None or any(loop.side != "input" for loop in found.loops):
        return None
    return abs(float(found.gear_set.gear.kinematics.ratio))


# ---- The torsional stiffness article's Table 2 ------------------------------------------------------------------------


def stiffness_table(found: Evaluation, definition: Definition) -> dict[str, Any]:
    unit, scale = angle_unit(found.loops[0])
    ratio = ratio_of(found)
    rows = []
    for label, row in zip(found.labels, table(found.analyses, definition), strict=True):
        cells = [stated(getattr(row, name)) for name in NAMES]
        cells.append(stated(row.hysteresis, scale))
        if ratio is not None:
            cells.append(stated(row.hysteresis, ARCMIN_PER_RADIAN / ratio))
        rows.append((label, cells))
    heads = [f"{name.replace('_', ' ').capitalize()} [N·m/rad]" for name in NAMES]
    heads.append(f"Total hysteresis [{unit}]")
    if ratio is not None:
        heads.append("At the output [′]")
    return {"title": TITLES[definition], "text": DEFINITIONS[definition], "heads": heads, "rows": rows}


def document_rows() -> Iterator[list[str]]:
    """The torsional stiffness article's own table, how far it is from closed, and under which reading it is."""
    for position, (*slopes, width) in TABLE_2.items():
        gap = f"{degrees(closure_of_secants(slopes, PEAK_TORQUE)):+.2f}°".replace("-", "−")
        parts = [fixed(each, 3) for each in soft_parts(slopes, float(np.radians(width)), PEAK_TORQUE)]
        yield [f"{position}°", *(fixed(each, 2) for each in slopes), fixed(width, 1), gap, *parts]


# ---- Loops -----------------------------------------------------------------------------------------------------------


def loop_part(found: Evaluation, place: int) -> dict[str, Any]:
    analysis = found.analyses[place]
    ratio = ratio_of(found)
    low, high = analysis.peaks
    reaches_band = analysis.loop.side == "input" and max(map(abs, analysis.peaks)) >= BAND[0]
    names: tuple[RegimeName, ...] = ("negative_loading", "positive_loading") if reaches_band else ()
    loading = [analysis.stiffness(name) for name in names]
    own_remarks = [
        remark
        for remark in analysis.remarks  # the others hold for all of the test
        if remark.startswith(OF_REGIMES) or any(remark not in each.remarks for each in found.analyses)
    ]
    return {
        "label": found.labels[place],
        "span": f"{len(analysis.loop)} points from {fixed(low, 3)} to {fixed(high, 3)} N·m",
        "figure": loop_figure(analysis, found.labels[place], f"loop-{place}", ratio),
        "stiffness_figure": stiffness_figure(analysis, found.labels[place], f"stiffness-{place}"),
        "rows": list(_width_rows(analysis, ratio)),
        "ratio": ratio,
        "soft": [
            (
                spot.regime.replace("_", " "),
                f"{fixed(spot.low, 3)} to {fixed(spot.high, 3)} N·m{'' if spot.bounded else ', where the regime ends'}",
                f"{fixed(spot.multiple, 2)} (at least {fixed(spot.at_least, 2)})",
            )
            for spot in analysis.soft_spots
        ],
        "band": [sentence(words_on_band(each, *BAND)) for each in loading if each is not None],
        "remarks": [sentence(remark) for remark in own_remarks],
    }


def _width_rows(analysis: LoopAnalysis, ratio: float | None) -> Iterator[tuple[str, str, Stated, Stated, str]]:
    """Yield for each width its name, its definition, its value at the loaded shaft and at the output, and the unit."""
    unit, scale = angle_unit(analysis.loop)

    def angle(name: str, words: str, found: Result | None) -> tuple[str, str, Stated, Stated, str]:
        at_output = stated(found, ARCMIN_PER_RADIAN / ratio) if ratio else Stated("", "")
        return name, words, stated(found, scale), at_output, unit

    wide, rated = analysis.hysteresis, analysis.rated_torque
    words = "widest separation of the branches at equal torque, as the torsional stiffness article has it"
    if wide is None:
        yield angle("Hysteresis", words, None)
    else:
        yield angle("Hysteresis", f"{words}, here at {number(round(wide.torque, 4), 3)} N·m", wide.width)
    yield angle("Width at zero torque", "separation of the branches after the peaks of this cycle", analysis.width_at_zero)
    words = "separation at zero torque after rated torque, as catalogues have it"
    level = "; rated torque is not known"
    if rated is not None:
        words += "" if analysis.hysteresis_loss else f"; rated torque, {number(rated, 4)} N·m, was not the peak"
        level = f"; ±{number(0.04 * rated, 3)} N·m"
    else:
        words += level
    yield angle("Hysteresis loss", words, analysis.hysteresis_loss)
    words = (
        "whole angle of the cycle between plus and minus 4 % of rated torque, as makers measure it"
        if analysis.whole_angle
        else "mean separation at plus and minus 4 % of rated torque in this larger cycle"
    )
    yield angle("Lost motion", words + level, analysis.lost_motion)
    if analysis.torque_width is not None:
        words = f"widest separation at equal angle, here at {fixed(scale * analysis.torque_width[1], 2)}{unit}"
        yield "Width in torque", words, Stated(number(analysis.torque_width[0], 4), ""), Stated("", ""), "N·m"
    yield "Energy lost", "area of the loop, in a cycle", stated(analysis.area, 1e3), Stated("", ""), "mJ"
    yield angle("Closure error", "angle at the end of the cycle less that at its beginning, at equal torque", analysis.closure)
    if analysis.drift is not None:
        yield angle("Drift", "movement of the middle of the loop from cycle to cycle", analysis.drift)


# ---- Comparison of loops, and with the catalogue ----------------------------------------------------------------------


def comparison_part(found: Evaluation, comparison: Comparison) -> dict[str, Any]:
    what = {"position": "Positions of the flexspline", "unit": "Units"}[comparison.by]
    return {
        "by": comparison.by,
        "title": what,
        "groups": comparison.quantities[0].groups if comparison.quantities else (),
        "rows": [_compared(each, found) for each in comparison.quantities],
        "figure": comparison_figure(found, comparison),
        "remarks": [sentence(each) for each in comparison.remarks],
    }


def _compared(each: ComparedQuantity, found: Evaluation) -> dict[str, Any]:
    unit, scale = _in_print(each.unit, found)
    verdict, word = {
        True: ("they differ", "differ"),
        False: ("no difference shown", "agree"),
        None: ("not known", "undecided"),
    }[each.significant]
    basis = "repeats" if not np.isnan(each.by_repeats) else "stated errors"
    probability = "—"
    if not np.isnan(each.probability):
        probability = f"{'< 0.0001' if each.probability < 1e-4 else number(each.probability, 2)}, by {basis}"
    spread = scale * each.spread

    def to_spread(value: float) -> str:  # the third digit of the spread of the means, which separates them
        return fixed(value, min(max(2 - floor(log10(spread)), 0), 6)) if spread > 0.0 else number(value, 4)

    return {
        "name": f"{each.name[0].upper()}{each.name[1:]} [{unit}]",
        "means": [to_spread(scale * mean) for mean in each.means],
        "spread": f"{number(scale * each.spread, 2)} ({number(100.0 * each.relative, 2)} %)",
        "probability": probability,
        "verdict": verdict,
        "word": word,
    }


def _in_print(unit: str, found: Evaluation) -> tuple[str, float]:
    """The unit that a quantity is printed in, and the factor to it."""
    if unit == "rad":
        return angle_unit(found.loops[0])
    return ("mJ", 1e3) if unit == "J" else (unit.replace(".", "·"), 1.0)


def catalogue_rows(found: Evaluation) -> Iterator[dict[str, Any]]:
    for label, analysis in zip(found.labels, found.analyses, strict=True):
        for check in analysis.catalogue:
            unit, scale = _in_print(check.unit, found)
            verdict, word = {
                True: ("within the spread", "agree"),
                False: ("beyond the spread", "differ"),
                None: ("", "undecided"),
            }[check.within]
            yield {
                "label": label,
                "name": check.name,
                "measured": stated(check.measured, scale),
                "stated": number(scale * check.stated, 4)
                + ("" if check.spread is None else f" ± {number(100.0 * check.spread, 2)} %"),
                "share": "—"
                if check.measured is None or not check.stated
                else f"{number(100.0 * check.measured.value / check.stated, 3)} %",
                "unit": unit,
                "verdict": verdict,
                "word": word,
                "why": check.why.replace("N.m", "N·m"),
            }


# ---- Uncertainty and sources -----------------------------------------------------------------------------------------


def budget_parts(found: Evaluation) -> Iterator[tuple[str, list[dict[str, Any]]]]:
    """The budgets of each loop; nothing of one whose rig is not known."""
    for label, analysis in zip(found.labels, found.analyses, strict=True):
        if made := budgets(found, analysis):
            yield label, [_budget(each) for each in made]


def _budget(budget: Budget) -> dict[str, Any]:
    unit, scale = ("°", degrees(1.0)) if budget.unit == "rad" else (budget.unit.replace(".", "·"), 1.0)
    if budget.unit == "N.m":
        unit, scale = "mN·m", 1e3
    return {
        "name": f"{budget.quantity[0].upper()}{budget.quantity[1:]}",
        "value": number(scale * budget.value, 4),
        "sigma": number(scale * budget.sigma, 2),
        "relative": f"{number(100.0 * budget.sigma / abs(budget.value), 2)} %" if budget.value else "",
        "unit": unit,
        "parts": [
            (each.name, number(scale * each.sigma, 2), f"{fixed(100.0 * budget.share(each), 1)} %", each.kind)
            for each in budget.contributions
        ],
    }


ARTICLE = "the torsional stiffness article, “Harmonic Drive Torsional Stiffness: Measurement and Hysteresis Analysis”"
SOURCES = {
    "Form of the table, rig, cycle of five steps": f"{ARTICLE}, Tables 1 and 2; corrected by its errata 1 to 13",
    "Torque of a couple: m is the total of both pans of a pair": "the torsional stiffness article; its erratum 7",
    "Angle from two markers by atan2, followed from photograph to photograph": "erratum 1 of that article",
    "Centres of the markers: circle, or ellipse, fitted by distance to sub-pixel edges": "erratum 2 of that article",
    "Regression with errors in torque and angle": "York2004",
    "Differences between groups of repeated loops": "Welch1951",
    f"Soft spot: local compliance beyond {number(SOFT_COMPLIANCE_RATIO)} times that of the regime's regression, "
    "by more than chance": "a definition of this package; the torsional stiffness article gives none",
    "Hysteresis loss, lost motion": "catalogues: at zero torque after ± rated torque, and at ± 4 % of rated torque",
    "Uncertainty: the squares of independent contributions add up": "GUM (JCGM 100:2008), Eq. 10",
}


class RigRow(NamedTuple):
    """A number of the rig, ready to print."""

    name: str
    value: str
    unit: str
    source: str


def rig_rows(rig: Rig) -> Iterator[RigRow]:
    """Yield every number of a rig with its standard deviation and its source, in the units of the workshop."""
    yield RigRow("Loaded shaft", rig.side, "", "the other shaft and the circular spline are held")
    yield _row("Radius of the disk", rig.disk_radius, 1e3, "mm")
    yield _row("Gravity", rig.gravity, 1.0, "m/s²")
    if rig.cord == "wound":
        yield RigRow("Cords", "wound on the rim", "", "the arm is the disk's radius at every angle")
    else:
        arm = "the arm is r cos(angle − angle at which the cord is tangent)"
        yield RigRow("Cords", "from a fixed point of the rim", "", arm)
        yield _row("Angle at which the cord is tangent", rig.cord_tangent, degrees(1.0), "°")
    yield _row("Friction of the pulleys, whatever the load", rig.pulley_torque, 1e3, "mN·m at the disk")
    yield _row("Friction of the pulleys, share of the torque", rig.pulley_share, 1e2, "%")
    yield _row("Compliance of coupling and frame", rig.compliance, 1e3, "mrad/(N·m)")
    for masses in rig.masses:
        yield _row(f"{masses.count} masses of", Value(masses.mass, masses.sigma, masses.source), 1e3, "g each")
    for name, length in (("Diameter of the markers", rig.markers_diameter), ("Distance of the markers", rig.markers_distance)):
        if length is not None:
            yield _row(name, length, 1e3, "mm")
    yield from _camera(rig.camera)


def _row(name: str, given: Value, scale: float, unit: str) -> RigRow:
    value = uncertain(scale * given.value, scale * given.sigma) if given.sigma > 0.0 else number(scale * given.value)
    return RigRow(name, value, unit, given.source)


def _camera(camera: Camera) -> Iterator[RigRow]:
    def source(*keys: str) -> str:
        return "; ".join(dict.fromkeys(camera.sources[key] for key in keys if key in camera.sources))

    if camera == Camera(sources=camera.sources):
        words = "taken to look straight at the target, through a lens without distortion, at square pixels"
        yield RigRow("Camera", "not calibrated", "", words)
        return
    yield RigRow("Width of a pixel over its height", number(camera.aspect), "", source("aspect"))
    yield RigRow("Tilt of the camera", number(degrees(camera.tilt), 4), "°", source("tilt"))
    if camera.tilt:
        direction = number(degrees(camera.tilt_direction), 4)
        yield RigRow("Direction in which the target recedes", direction, "°", source("tilt_direction"))
    if camera.distance is not None:
        yield RigRow("Distance of the target", number(camera.distance, 5), "px", source("distance"))
    if camera.centre is not None:
        centre = ", ".join(number(each, 5) for each in camera.centre)
        yield RigRow("Centre of distortion and perspective", centre, "px", source("centre[0]", "centre[1]"))
    if any(camera.radial):
        radial = ", ".join(number(each, 4) for each in camera.radial)
        yield RigRow("Distortion of the lens, k₁, k₂", radial, "px⁻², px⁻⁴", source("radial[0]", "radial[1]"))


# ---- Photographs -----------------------------------------------------------------------------------------------------


def photographs(angles: Sequence[Angles]) -> Iterator[dict[str, str]]:
    """Yield every photograph of a test with its angle, the worst of its two markers, and its warnings."""
    columns = ("angle", "sigma", "residual", "contrast", "blur", "arc")
    for each in angles:
        angle_of = {frame.name: (angle, sigma) for frame, angle, sigma in zip(each.useful, each.angle, each.sigma, strict=True)}
        for frame in each.frames:
            remark = "; ".join([*([f"of no use: {frame.fault}"] if frame.fault else []), *frame.warnings])
            cells = ["—"] * len(columns)
            if frame.markers is not None:
                angle, sigma = (degrees(number) for number in angle_of[frame.name])
                cells = [
                    fixed(angle, 4),
                    fixed(ARCSEC_PER_DEGREE * sigma, 1),
                    fixed(max(marker.residual for marker in frame.markers), 3),
                    fixed(min(marker.contrast for marker in frame.markers), 2),
                    fixed(max(marker.blur for marker in frame.markers), 2),
                    f"{fixed(100.0 * min(marker.arc for marker in frame.markers), 0)} %",
                ]
            row = dict(zip(columns, cells, strict=True))
            yield {"name": frame.name, **row, "remark": remark, "sha256": frame.sha256}


def centre_words(angles: Sequence[Angles]) -> Iterator[str]:
    """Yield the point about which the disk turned, for each position and unit."""
    for each in angles:
        words = "the turn is too small to determine the point about which the disk turned."
        if each.centre is not None:
            x, y, rms = each.centre
            words = f"the disk turned about ({fixed(x, 1)}, {fixed(y, 1)}) px; "
            words += f"the markers keep to circles about it within {fixed(rms, 3)} px rms."
        yield f"With {each.reference} at 0: {words}"


# ---- Steps -----------------------------------------------------------------------------------------------------------


def step_rows(found: Evaluation) -> Iterator[list[str]]:
    """Every step with its masses, time and temperature."""
    for step in found.steps:
        yield [
            str(step.number),
            f"{f'{step.unit}, ' if step.unit else ''}{degrees(step.position):.6g}°",
            fixed(1e3 * step.mass_positive, 1) if step.torque is None else "—",
            fixed(1e3 * step.mass_negative, 1) if step.torque is None else "—",
            "" if step.time is None else fixed(step.time, 0),
            "" if step.temperature is None else fixed(step.temperature - ZERO_CELSIUS, 1),
            step.image or "angle read otherwise",
        ]
