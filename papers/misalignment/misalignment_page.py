"""The page of the study of the actuator paper, and the same in a few lines for a terminal."""

from __future__ import annotations

import textwrap
from collections.abc import Iterator
from math import degrees, hypot
from pathlib import Path
from typing import Any

import misalignment as study
import misalignment_drawings as drawings
import misalignment_figures as plots
import numpy as np
import strainwave as sw
from jinja2 import Environment, StrictUndefined
from misalignment import INPUT, OUTPUT, MisalignmentStudy, Recovery
from misalignment_claims import Claim, arcmin, claims, frequency, microns, percent, silence
from strainwave.diagnose import BOTH_LOOPS, COMBINE, LOBES, LOOPS, SWEEPS, level_lines, table_number
from strainwave.typeset import number, quantity, uncertain

LETTERS_PER_LINE = 110  # on a terminal


def write_page(found: MisalignmentStudy, folder: Path) -> None:
    """Write the page of the study as page.md, and its figures, into a folder."""
    drawn = {"wave-generator": drawings.wave_generator(), "angles": drawings.angles(), **plots.figures(found)}
    for name, figure in drawn.items():
        figure.savefig(folder / f"{name}.svg")
    (folder / "page.md").write_text(page(found), encoding="utf-8")


def page(found: MisalignmentStudy) -> str:
    """Return the page of the study in Markdown; its figures are files beside it."""
    environment = Environment(undefined=StrictUndefined, trim_blocks=True, lstrip_blocks=True)
    template = environment.from_string(Path(__file__).with_name("page.md.jinja").read_text(encoding="utf-8"))
    law = found.law
    return template.render(
        setting=setting(found),
        claims=claims(found),
        cards=_cards(found),
        scales=[number(times, 2) for times in drawings.scales(law.major_radius, law.minor_radius, study.USUAL_E1)],
        eccentricity=microns(study.USUAL_E1),
        pure=found.pure,
        fits=list(_fits(found)),
        levels={
            f"{LOBES[each.combine]}, loop on the {LOOPS[each.loop]}": [row for sweep in BOTH_LOOPS for row in each.cells(sweep)]
            for each in found.levels.values()
        },
        largest_tilt=plots.tilt_words(study.SHOWN_TILTS[-1]),
        silent=percent(silence(found), 1),
        silent_rows=list(_silent_rows(found)),
        recoveries=[_recovered(each) for each in found.recoveries],
        injected=_injected(found),
        records={plots.SEEN[column]: _noise(column, noise) for column, noise in study.RECORDS.items()},
        measured=None if found.measured is None else found.measured.title,
        staged={name: percent(abs(found.off_in_series(name))) for name in ("torque", "current")} if found.staged else {},
        assumed_geometry=found.assumed_geometry,
        listing=sw.listing(found.gear_set),
    )


def summary(found: MisalignmentStudy) -> str:
    """Return the results of the study as lines of text."""
    lines = [*_ramp_lines(found), "", *_level_lines(found), "", *_recovery_lines(found), "", *_claim_lines(found)]
    return "\n".join(lines)


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
            "name": LOBES[combine],
            "m": f"{determined['m_x']}, {determined['m_y']}",
            "c": determined.get("c_x", ""),
            "rms": arcmin(fit.rms),
            "explained": percent(fit.explained),
            "possible": "" if fit.possible else "not possible: the lobes would leave the teeth",
        }


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
        name, values, _ = SWEEPS[sweep]
        unit = f"{number(degrees(values[-1]), 2)}°" if name.endswith("tilt_x") else quantity(values[-1], "m", 2)
        swings = [float(found.levels[combine, OUTPUT].column(sweep, "current_swing")[-1]) for combine in COMBINE]
        yield [words, unit, *(table_number(1e3 * each, 2) for each in swings)]


def _recovered(recovery: Recovery) -> dict[str, Any]:
    best = recovery.best
    x, y = recovery.m
    truth = hypot(x, y)
    sign = 1.0 if np.dot(best.m, recovery.m) >= 0.0 else -1.0
    way = degrees(np.arctan2(sign * best.m[1], sign * best.m[0]))
    return {
        "record": plots.SEEN[recovery.column],
        "combine": LOBES[recovery.law.combine],
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
    yield from level_lines([found.levels[combine, OUTPUT] for combine in COMBINE])
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
