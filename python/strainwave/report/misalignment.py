"""The page of the study of document A, and the same in a few lines for a terminal."""

from __future__ import annotations

import textwrap
from collections.abc import Iterator
from math import degrees, hypot
from typing import Any

import numpy as np

from strainwave.diagnose.actuator_ramp import INPUT, LOOPS, OUTPUT
from strainwave.diagnose.inversion import COMBINE
from strainwave.report import misalignment_drawings as drawings
from strainwave.report import misalignment_figures as plots
from strainwave.report.misalignment_claims import Claim, arcmin, claims, frequency, microns, percent, silence
from strainwave.report.page import render
from strainwave.report.position_control import numbers
from strainwave.report.provenance import Provenance
from strainwave.studies import misalignment as study
from strainwave.studies.misalignment import MisalignmentStudy, Recovery, SweepLevels
from strainwave.typeset import ARCMIN_PER_RADIAN, fixed, number, quantity, uncertain

LETTERS_PER_LINE = 110  # on a terminal
MIN_TABLE_VALUE = 1e-3  # in the units of the table


def misalignment_report(found: MisalignmentStudy, provenance: Provenance | None = None) -> str:
    """The page of the study, as one HTML file that needs nothing else.

    Args:
        found: what the study found
        provenance: how the page came to be, if that is to be shown

    Returns:
        HTML; the same for the same arguments
    """
    from markupsafe import Markup

    law = found.law
    return render(
        "misalignment.html.jinja",
        {
            "title": found.gear_set.name,
            "note": found.gear_set.note,
            "setting": setting(found),
            "claims": claims(found),
            "cards": _cards(found),
            "drawings": [Markup(drawings.wave_generator(law.major_radius, law.minor_radius)), Markup(drawings.angles())],
            "scales": [number(times, 2) for times in drawings.scales(law.major_radius, law.minor_radius, study.USUAL_E1)],
            "eccentricity": microns(study.USUAL_E1),
            "pure_figure": plots.pure_figure(found.pure),
            "pure": found.pure,
            "fits": list(_fits(found)),
            "ramp_figure": plots.ramp_figure(found),
            "difference_figure": plots.difference_figure(found),
            "level_figure": plots.level_figure(found),
            "levels": [_level_table(each) for each in found.levels.values()],
            "spectrum_figure": plots.spectrum_figure(found),
            "flap_figure": plots.flap_figure(found),
            "largest_tilt": plots.tilt_words(study.SHOWN_TILTS[-1]),
            "passing_figure": plots.passing_figure(found),
            "silent": percent(silence(found), 1),
            "silent_rows": list(_silent_rows(found)),
            "recovery_figure": (
                plots.recovery_figure({each.column: each for each in found.recoveries if each.law.combine == study.USUAL})
            ),
            "recoveries": [_recovered(each) for each in found.recoveries],
            "injected": _injected(found),
            "trials": study.NOISE_TRIALS,
            "records": {plots.SEEN[column]: _noise(column, noise) for column, noise in study.RECORDS.items()},
            "measured": None if found.measured is None else found.measured.title,
            "measured_figure": "" if found.measured is None else plots.measured_figure(found, found.measured),
            "staged": {name: percent(abs(found.off_in_series(name))) for name in ("torque", "current")} if found.staged else {},
            "assumed_geometry": found.assumed_geometry,
            "numbers": list(numbers({"": found.gear_set})),
        },
        provenance,
    )


def summary(found: MisalignmentStudy) -> str:
    """Return the results of the study as lines of text."""
    lines = [*_ramp_lines(found), "", *_level_lines(found), "", *_recovery_lines(found), "", *_claim_lines(found)]
    return "\n".join(lines).replace("\N{NO-BREAK SPACE}", " ")  # what a terminal shows is also searched and copied


def setting(found: MisalignmentStudy) -> dict[str, str]:
    """Return the settings of the study in words."""
    ramp = found.ramp
    return {
        "Drive": found.gear_set.name,
        "Ramp": f"{number(degrees(ramp.stroke), 4)}° in {number(ramp.duration, 3)} s",
        "Ratio": f"{number(abs(float(ramp.drive.gear.kinematics.ratio)), 5)}",
        "Wave generator": f"{number(ramp.turning * 30.0 / np.pi, 3)} rpm, {number(frequency(found, 1.0), 3)} Hz",
        "Order 2": f"{number(frequency(found), 3)} Hz",
        "Position loop": f"gain {number(ramp.gain, 3)} /s, {number(ramp.gain / (2.0 * np.pi), 2)} Hz",
        "Steps": f"{quantity(ramp.dt, 's', 2)}",
    }


def _cards(found: MisalignmentStudy) -> list[dict[str, str]]:
    levels = found.levels[study.USUAL, OUTPUT]
    row = 1
    current = float(levels.column("e1", "current_swing")[row])
    nominal = float(np.abs(found.ramp.settled(found.straight)["current"]).max())
    recovery = next(each for each in found.recoveries if each.column == "current" and each.law.combine == study.USUAL)
    best = recovery.best
    return [
        {
            "eyebrow": "At the flap",
            "headline": f"±{arcmin(float(levels.column('e1', 'output_swing')[row]))}",
            "text": f"with the wave generator {microns(study.USUAL_E1)} off centre and the loop closed on the output; "
            f"±{arcmin(float(found.levels[study.USUAL, INPUT].column('e1', 'output_swing')[row]))} with the loop on the motor "
            "encoder.",
        },
        {
            "eyebrow": "In the motor current",
            "headline": f"±{quantity(current, 'A', 2)}",
            "text": f"of {quantity(nominal, 'A', 3)}, at orders 2, 4, … of the wave generator: {number(frequency(found), 3)} "
            "Hz and multiples. It grows in proportion to the misalignment.",
        },
        {
            "eyebrow": "From one ramp",
            "headline": f"{uncertain(best.size / study.M_PER_MICRON, best.half_widths[0] / study.M_PER_MICRON)} µm",
            "text": f"from the current, where {microns(hypot(*recovery.m))} were put in (95 %). Eccentricity and tilt times "
            "offset are one number, and the wave generator's own misalignment on its shaft is none.",
        },
    ]


def _fits(found: MisalignmentStudy) -> Iterator[dict[str, str]]:
    for combine, fit in found.pure.fits.items():
        determined = {name: microns(value) for name, value in fit.determined.items()}
        yield {
            "name": plots.WORDS[combine],
            "m": f"{determined['m_x']}, {determined['m_y']}",
            "c": determined.get("c_x", ""),
            "rms": arcmin(fit.rms),
            "explained": percent(fit.explained),
            "possible": "" if fit.possible else "not possible: the lobes would leave the teeth",
        }


def _level_table(levels: SweepLevels) -> dict[str, Any]:
    rows = []
    for sweep in study.BOTH_LOOPS:
        name = study.SWEEPS[sweep][0]
        for place, level in enumerate(levels.column(sweep, name)):
            shown = microns(level) if sweep == "e1" else f"{number(degrees(level), 2)}°"
            rows.append([f"{'e₁' if sweep == 'e1' else 'β₂'} = {shown}", *_row(levels, sweep, place)])
    return {"title": f"{plots.WORDS[levels.combine]}, loop on the {LOOPS[levels.loop]}", "rows": rows}


def _row(levels: SweepLevels, sweep: str, place: int) -> list[str]:
    def at(name: str) -> float:
        return float(levels.column(sweep, name)[place])

    return [
        _small(ARCMIN_PER_RADIAN * at("error_swing"), 3),
        _small(at("torque_swing"), 3),
        fixed(at("torque_peak"), 3),
        _small(1e3 * at("current_swing"), 3),
        fixed(at("current_peak"), 3),
        _small(ARCMIN_PER_RADIAN * at("output_swing"), 2),
    ]


def _small(value: float, digits: int) -> str:
    """A number of a column; of one that nobody would measure, that it is so small."""
    return number(value, digits) if value >= MIN_TABLE_VALUE or value == 0.0 else f"< {MIN_TABLE_VALUE:g}"


def _misfit(value: float) -> str:
    return number(value, 2) if value < 100.0 else "> 100"


def _silent_rows(found: MisalignmentStudy) -> Iterator[list[str]]:
    """Swings of the current at the largest level of each sweep, by `combine`."""
    names = {
        "e1": "e₁",
        "beta": "β₂ at h",
        "h": "h with β₂",
        "e2": "e₂ alone",
        "alpha": "α₂ alone",
        "e2 with e1": "e₂ with e₁",
    }
    for sweep, words in names.items():
        name, values, _ = study.SWEEPS[sweep]
        unit = f"{number(degrees(values[-1]), 2)}°" if name.endswith("tilt_x") else quantity(values[-1], "m", 2)
        swings = [float(found.levels[combine, OUTPUT].column(sweep, "current_swing")[-1]) for combine in COMBINE]
        yield [words, unit, *(_small(1e3 * each, 2) for each in swings)]


def _recovered(recovery: Recovery) -> dict[str, Any]:
    best = recovery.best
    x, y = recovery.m
    truth = hypot(x, y)
    sign = 1.0 if np.dot(best.m, recovery.m) >= 0.0 else -1.0
    way = degrees(np.arctan2(sign * best.m[1], sign * best.m[0]))
    return {
        "record": plots.SEEN[recovery.column],
        "combine": plots.WORDS[recovery.law.combine],
        "size": f"{uncertain(best.size / study.M_PER_MICRON, best.half_widths[0] / study.M_PER_MICRON)} µm",
        "truth": f"{number(truth / study.M_PER_MICRON, 4)} µm",
        "way": f"{uncertain(way, degrees(best.half_widths[1]))}°",
        "true_way": f"{number(degrees(np.arctan2(y, x)), 3)}°",
        "within": f"{recovery.within} of {len(recovery.trials)}",
        "hits": recovery.within,
        "trials": len(recovery.trials),
        "misfits": [_misfit(recovery.first[each].misfit) for each in COMBINE],
    }


def _injected(found: MisalignmentStudy) -> str:
    law = found.recoveries[0].law
    x, y = found.recoveries[0].m
    return (
        f"e₁ = {microns(law.housing_eccentricity)} at β₁ = {number(degrees(law.housing_direction), 3)}°, β₂ = "
        f"{number(degrees(law.housing_tilt_x), 2)}°, β₃ = {number(degrees(law.housing_tilt_y), 2)}°, h = "
        f"{quantity(law.offset, 'm', 2)}: m = ({number(x / study.M_PER_MICRON, 4)}, {number(y / study.M_PER_MICRON, 4)}) µm"
    )


def _noise(column: str, noise: float) -> str:
    return quantity(noise, "rad" if column == "transmission_error" else "A", 2)


# ---- Lines for a terminal --------------------------------------------------------------------------------------------


def _ramp_lines(found: MisalignmentStudy) -> Iterator[str]:
    words = setting(found)
    yield f"{words['Drive']}: {words['Ramp']}, wave generator at {words['Wave generator']}, order 2 at {words['Order 2']}"


def _level_lines(found: MisalignmentStudy) -> Iterator[str]:
    head = ["loop on the output sensor", "error [′]", "torque [N·m]", "peak [1]", "current [mA]", "peak [1]", "flap [′]"]
    rows = [head]
    for combine in COMBINE:
        levels = found.levels[combine, OUTPUT]
        for place, level in enumerate(levels.column("e1", "housing_eccentricity")):
            rows.append([f"e₁ = {microns(level)}, {plots.WORDS[combine]}", *_row(levels, "e1", place)])
    widths = [max(len(row[column]) for row in rows) for column in range(len(head))]
    for row in rows:
        cells = [f"{cell:>{width}}" for cell, width in zip(row[1:], widths[1:], strict=True)]
        yield "  ".join([f"{row[0]:{widths[0]}}", *cells]).rstrip()
    yield "Half swings of the error, and of the differences that it makes; each peak over that without misalignment."


def _recovery_lines(found: MisalignmentStudy) -> Iterator[str]:
    yield f"put in: {_injected(found)}"
    for each in map(_recovered, found.recoveries):
        yield (
            f"from {each['record']}, {each['combine']}: |m| = {each['size']} ({each['truth']}), towards {each['way']} "
            f"({each['true_way']}); truth within the ellipse of 95 % in {each['within']} records"
        )


def _claim_lines(found: MisalignmentStudy) -> Iterator[str]:
    for claim in claims(found):
        yield from _wrapped(claim)


def _wrapped(claim: Claim) -> Iterator[str]:
    yield from textwrap.wrap(f"{claim.verdict}: {claim.words}", LETTERS_PER_LINE)
    yield from textwrap.wrap(claim.answer, LETTERS_PER_LINE, initial_indent="  ", subsequent_indent="  ")
