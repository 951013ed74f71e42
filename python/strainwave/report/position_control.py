"""The page of the study of document P's experiments, and the same in a few lines for a terminal."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from math import degrees, isfinite
from operator import attrgetter
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from strainwave import Drive
from strainwave.drawing import marks
from strainwave.drawing.style import FIGURE_WIDTH, LIGHT
from strainwave.files.described import parameters, parts
from strainwave.files.entries import NOT_GIVEN
from strainwave.files.gear_set import GearSet
from strainwave.files.recording import Recording
from strainwave.report import figures
from strainwave.report.page import render
from strainwave.report.provenance import Provenance
from strainwave.studies import position_control as study
from strainwave.studies.position_control import FULL, SIMPLIFIED, CommandExperiment, MeasuredRun, PositionControl
from strainwave.typeset import number, quantity, unit

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

Array = NDArray[np.float64]

MODELS: dict[str, dict[str, Any]] = {
    FULL: {"color": LIGHT["model"], "linestyle": "-", "linewidth": 2.6, "alpha": 0.6},
    SIMPLIFIED: {"color": LIGHT["held-out"], "linestyle": "--", "linewidth": 1.1},
}
LEAST_OF_TABLE_4 = min(rms for rms, _, _ in study.TABLE_4.values())


class ExperimentRow(NamedTuple):
    """A row of the table of an experiment, ready to print."""

    label: str
    rms: str
    largest: str
    correlation: str
    settling: str


class PrintedNumber(NamedTuple):
    """A number of a set, ready to print."""

    path: str
    value: str
    unit: str
    model: str
    source: str
    assumed: bool


def position_control_report(found: PositionControl, provenance: Provenance | None = None) -> str:
    """The page of the study, as one HTML file that needs nothing else.

    Args:
        found: what the study found
        provenance: how the page came to be, if that is to be shown

    Returns:
        HTML; the same for the same arguments
    """
    return render(
        "position_control.html.jinja",
        {
            "limits": _limits(found),
            "experiments": [
                {
                    "name": each.name,
                    "title": each.title,
                    "figure": experiment_figure(each),
                    "rows": rows(each),
                    "current": quantity(each.between["current"].rms, "A"),
                    "resolved": _resolved(each),
                }
                for each in found.experiments
            ],
            "friction_figure": friction_figure(found),
            "pulse_figure": pulse_figure(found),
            "control_figure": control_figure(found),
            "pulses": list(_pulses(found)),
            "measured": None if found.measured is None else _measured(found.measured),
            "numbers": list(numbers(found.sets)),
            "notes": {model: gear_set.note for model, gear_set in found.sets.items()},
            "study": study,
            "degrees": degrees,
        },
        provenance,
    )


def summary(found: PositionControl) -> str:
    """Return the results of the study as lines of text."""
    head = ("output angle", "rms [mrad]", "largest [mrad]", "correlation", "settles in [ms]")
    table = [ExperimentRow(*head)]
    for each in found.experiments:
        table += [ExperimentRow(each.title, "", "", "", ""), *(row._replace(label=f"  {row.label}") for row in rows(each))]
    if found.measured is not None:
        title = found.measured.recording.title
        table += [
            ExperimentRow(title, "", "", "", ""),
            *(row._replace(label=f"  {row.label}") for row in measured_rows(found.measured)),
        ]
    widths = [max(len(row[column]) for row in table) for column in range(len(head))]
    lines = [_aligned(row, widths) for row in table]
    return "\n".join([*lines, *_answer(found)])


def _aligned(row: ExperimentRow, widths: list[int]) -> str:
    """The first cell to the left, the others to the right."""
    cells = zip(row[1:], widths[1:], strict=True)
    return "  ".join([f"{row.label:{widths[0]}}", *(f"{cell:>{width}}" for cell, width in cells)]).rstrip()


def _answer(found: PositionControl) -> Iterator[str]:
    limits = _limits(found)
    yield f"average friction suffices for the friction itself up to {limits['law']} of the motor"
    by_voltage = ", ".join(f"{angle} at {voltage} V" for voltage, angle, _ in limits["pulses"])
    yield f"for the stroke of a pulse in open loop up to {by_voltage}"
    largest = f"{limits['largest']} rms at most, {limits['times_less']} times less than the least error of Table 4"
    yield f"under the controller {limits['control']}: the output differs by {largest}"
    yield "Table 4 of document P compares with measurements that were not published; it is not reproduced"


def rows(experiment: CommandExperiment) -> list[ExperimentRow]:
    """Return the agreement of each model with the command, and of the models with each other."""
    found = [
        ExperimentRow(
            f"{model} − command", *_agreed(experiment.tracking[model]), settling=_settling(experiment.settling[model])
        )
        for model in (FULL, SIMPLIFIED)
    ]
    return [
        *found,
        ExperimentRow("full − simplified", *_agreed(experiment.between["output_angle"]), settling=_later(experiment)),
    ]


def measured_rows(measured: MeasuredRun) -> list[ExperimentRow]:
    """Return the agreement of each model with the measured run."""
    return [
        ExperimentRow(f"{model} − measured", *_agreed(agreement), settling="")
        for model, agreement in measured.agreement.items()
    ]


def _agreed(agreement: Any) -> tuple[str, str, str]:
    """Root mean square and largest in mrad, and the correlation."""
    sizes = (number(1e3 * size, 3) for size in (agreement.rms, agreement.largest))
    return (*sizes, number(agreement.correlation, 6))  # type: ignore[return-value] # two sizes and one more


def _settling(times: tuple[float, ...]) -> str:
    """The least and the greatest of several times, in ms."""
    if not times:
        return ""
    texts = [number(1e3 * time, 3) if isfinite(time) else "never" for time in (min(times), max(times))]
    return " to ".join(dict.fromkeys(texts))


def _later(experiment: CommandExperiment) -> str:
    """Return the largest difference in settling, full less simplified model, in ms."""
    pairs = zip(experiment.settling[FULL], experiment.settling[SIMPLIFIED], strict=True)
    differences = [full - simplified for full, simplified in pairs]
    return number(1e3 * max(differences, key=abs), 2) if differences else ""


def _limits(found: PositionControl) -> dict[str, Any]:
    def angle(stroke: float, digits: int = 3) -> str:
        return f"{number(stroke, digits)} rad"

    law: Any = found.sets[FULL].gear.friction_input
    moves = found.under_control
    differences = moves["output_angle"]
    control = found.control_suffices_to
    reach = f"{number(float(found.under_control['stroke'][-1]), 3)} rad"
    return {
        "law": angle(found.law_suffices_to),
        "law_degrees": _at_output(found, found.law_suffices_to),
        "pulses": [
            (number(voltage), angle(stroke, 2), _at_output(found, stroke))
            for voltage, stroke in found.pulse_suffices_to.items()
        ],
        "usual": angle(found.pulse_suffices_to[study.USUAL_VOLTAGE], 2),
        "usual_degrees": _at_output(found, found.pulse_suffices_to[study.USUAL_VOLTAGE]),
        "control": f"at all strokes up to {reach}" if control == np.inf else f"up to {angle(control)}",
        "unlimited": control == np.inf,
        "reach": reach,
        "current": quantity(float(moves["current"].max()), "A", 2),
        "current_share": number(100.0 * float((moves["current"] / moves["used"]).max()), 2),
        "least": quantity(float(law.constant - law.linear**2 / (4.0 * law.quadratic)), "N.m"),
        "least_at": f"{number(-law.linear / (2.0 * law.quadratic), 4)} rad",
        "back_at": f"{number(-law.linear / law.quadratic, 4)} rad",
        "largest": quantity(float(differences.max()), "rad"),
        "times_less": number(LEAST_OF_TABLE_4 / float(differences.max()), 2),
        "periodic": number(100.0 * _periodic_share(found), 2),
        "fit": angle(found.control_within_fit_to, 1),
        "stuck": quantity(_stuck(found), "rad"),
        "stopped": quantity(_static(found) * _yield(found), "rad", 2),
        "error": quantity(study.FIT_ERROR * _yield(found), "rad", 2),
    }


def _at_output(found: PositionControl, stroke: float) -> str:
    return f"{number(degrees(stroke / found.sets[FULL].gear.kinematics.ratio), 2)}°"


def _stuck(found: PositionControl) -> float:
    """Return the largest error at rest by dry friction at the output against the spring [rad]."""
    gear: Any = found.sets[SIMPLIFIED].gear
    return float(gear.friction_output.breakaway / gear.stiffness.k)


def _static(found: PositionControl) -> float:
    """The static friction of the motor [N.m]."""
    law: Any = found.sets[SIMPLIFIED].gear.friction_input
    return float(law.breakaway)


def _yield(found: PositionControl) -> float:
    """Return the compliance of the output to friction of the motor at rest, under the controller [rad/(N.m)]."""
    drive: Any = found.sets[SIMPLIFIED].drive
    stiffness = drive.control.proportional * drive.motor.torque_constant / drive.motor.resistance
    return float(1.0 / (stiffness * drive.gear.kinematics.ratio))


def _periodic_share(found: PositionControl) -> float:
    """Return the largest effect of the assumed periodic part on a pulse's stroke, over that of the error of the fit [1]."""
    pulses = found.by_pulse[study.USUAL_VOLTAGE]
    effect = pulses["full"] - pulses["without_periodic"]
    room = np.where(effect > 0.0, pulses["weaker"] - pulses["stroke"], pulses["stroke"] - pulses["stronger"])
    within = pulses["stroke"] < found.law_suffices_to
    return float((np.abs(effect) / room)[within].max())


def _pulses(found: PositionControl) -> Iterator[list[str]]:
    """Rows of the table of strokes by a pulse of the usual voltage."""
    pulses = found.by_pulse[study.USUAL_VOLTAGE]
    for row in range(len(pulses)):
        stroke = pulses["stroke"][row]
        shares = [100.0 * (pulses[name][row] / stroke - 1.0) for name in ("full", "without_periodic", "stronger", "weaker")]
        yield [number(stroke, 3), number(1e3 * pulses["width"][row], 3), *(number(share, 2) for share in shares)]


def _resolved(experiment: CommandExperiment) -> dict[str, str]:
    """Return the error of Table 4 and the difference of the two models."""
    published, apart = study.TABLE_4[experiment.name][0], experiment.between["output_angle"].rms
    return {
        "published": f"{number(1e3 * published)} mrad",
        "apart": f"{number(1e3 * apart, 2)} mrad",
        "ratio": number(published / apart, 2),
    }


def _measured(measured: MeasuredRun) -> dict[str, Any]:
    ends = None if measured.beyond is None else [number(end, 4) for end in measured.beyond]
    return {
        "name": measured.recording.title,
        "figure": measured_figure(measured),
        "rows": measured_rows(measured),
        "beyond": ends,
    }


# ---- Numbers and their sources ---------------------------------------------------------------------------------------


def numbers(sets: Mapping[str, GearSet]) -> Iterator[PrintedNumber]:
    """Every number that is given, once where both models have the same from the same source."""
    given = {model: {each.path: each for each in _of_set(model, gear_set)} for model, gear_set in sets.items()}
    for path in dict.fromkeys(path for entries in given.values() for path in entries):
        found = [entries[path] for entries in given.values() if path in entries]
        if len(found) == len(given) and len({each._replace(model="") for each in found}) == 1:
            yield found[0]._replace(model="both")
        else:
            yield from found


def _of_set(model: str, gear_set: GearSet) -> Iterator[PrintedNumber]:
    for part in parts(Drive()):
        if (chosen := getattr(gear_set, part.name)) is not None:
            yield from _of_part(model, gear_set, part.name, chosen)


def _of_part(model: str, gear_set: GearSet, path: str, part: Any) -> Iterator[PrintedNumber]:
    for field in parameters(part):
        place = f"{path}.{field.name}"
        several = field.kind == "sequence"
        entry = gear_set.sources.get(f"{place}[0]" if several else place)
        if entry is not None and entry.source != NOT_GIVEN and not entry.source.startswith("assumed: the default"):
            values = np.atleast_1d(attrgetter(place)(gear_set))
            source = entry.source.removeprefix("assumed: ")
            yield PrintedNumber(place, _values(values), unit(field.unit), model, source, entry.assumed)
    for inner in parts(part):
        yield from _of_part(model, gear_set, f"{path}.{inner.name}", getattr(part, inner.name))


def _values(values: Array) -> str:
    """A value, or how many there are and their range."""
    ends = [number(float(end)) for end in (values.min(), values.max())]
    if len(values) == 1:
        return ends[0]
    return f"{' to '.join(dict.fromkeys(ends))} ({len(values)} values)"


# ---- Figures ---------------------------------------------------------------------------------------------------------


def experiment_figure(experiment: CommandExperiment) -> str:
    """Command and response, their difference, the difference of the models, and the current, over time."""
    runs = experiment.runs
    first = runs[FULL]

    def draw(figure: Figure) -> None:
        response, error, apart, current = figure.subplots(4, 1, sharex=True, height_ratios=(1.7, 1.1, 0.9, 1.1))
        marks.curve(response, first.time, first["command"], color=LIGHT["ink"], linewidth=0.9, label="command")
        for model, run in runs.items():
            _draw_run(response, run, run["output_angle"], model)
            _draw_run(error, run, run["output_angle"] - run["command"], model)
            _draw_run(current, run, run["current"], model)
        difference = first["output_angle"] - runs[SIMPLIFIED]["output_angle"]
        marks.curve(apart, first.time, difference, color=LIGHT["ink"], linewidth=1.0)
        marks.label_axes(response, "output angle", "rad")
        marks.label_axes(error, "response − command", "rad")
        marks.label_axes(apart, "full − simplified, output angle", "rad")
        marks.label_axes(current, "current", "A", "time", "s")
        marks.legend(figure, response)

    title = f"{experiment.title}: output angle, its difference from the command, that of the models, and current over time"
    return figures.inline(draw, (FIGURE_WIDTH, 6.2), experiment.name, title)


def _draw_run(axes: Axes, run: Recording, values: Array, model: str) -> None:
    marks.curve(axes, run.time, values, label=f"{model} friction", **MODELS[model])


def measured_figure(measured: MeasuredRun) -> str:
    """A measured output angle and those of the models, and how far they are apart, over time."""
    recording = measured.recording

    def draw(figure: Figure) -> None:
        response, error = figure.subplots(2, 1, sharex=True, height_ratios=(1.7, 1.1))
        marks.curve(response, recording.time, recording["command"], color=LIGHT["ink"], linewidth=0.9, label="command")
        style: dict[str, Any] = {"color": LIGHT["measured"], "linewidth": 2.6, "alpha": 0.6, "label": "measured"}
        marks.curve(response, recording.time, recording["output_angle"], **style)
        for model, run in measured.runs.items():
            _draw_run(response, run, run["output_angle"], model)
            simulated = np.interp(recording.time, run.time, run["output_angle"])
            marks.curve(error, recording.time, simulated - recording["output_angle"], **MODELS[model])
        marks.label_axes(response, "output angle", "rad")
        marks.label_axes(error, "simulated − measured", "rad", "time", "s")
        marks.legend(figure, response)

    return figures.inline(draw, (FIGURE_WIDTH, 4.0), "measured", "Output angle measured and simulated, over time")


def friction_figure(found: PositionControl) -> str:
    """Coulomb friction over the motor angle: full, its average part, and the constant with the error of the fit."""
    law: Any = found.sets[FULL].gear.friction_input
    simplified: Any = found.sets[SIMPLIFIED].gear.friction_input
    band = simplified.coulomb - study.FIT_ERROR, simplified.coulomb + study.FIT_ERROR
    angle = np.linspace(law.domain_start, law.domain_end, 3000)
    parabola = (law.quadratic * angle + law.linear) * angle + law.constant

    def draw(figure: Figure) -> None:
        axes = figure.subplots()
        axes.axhspan(*band, facecolor=LIGHT["held-out"], alpha=0.15, linewidth=0.0)
        slow = law.replace(viscous=0.0).steady(np.full_like(angle, law.reference_speed), angle=angle)
        axes.plot(angle, slow, color=LIGHT["model"], linewidth=0.7, label="full friction")
        axes.plot(angle, parabola, color=LIGHT["ink"], linewidth=1.4, label="its average part")
        label = "simplified friction ± error of the fit"
        axes.axhline(simplified.coulomb, label=label, **MODELS[SIMPLIFIED])
        _mark(axes, found.law_suffices_to)
        marks.label_axes(axes, "Coulomb friction of the motor", "N.m", "motor angle", "rad")
        marks.legend(figure, axes)

    return figures.inline(draw, (FIGURE_WIDTH, 3.2), "friction", "Coulomb friction over the motor angle")


def pulse_figure(found: PositionControl) -> str:
    """Draw the excess of a pulse's stroke over that of the simplified model, over the stroke."""
    pulses = found.by_pulse[study.USUAL_VOLTAGE]
    stroke = pulses["stroke"]

    def share(name: str) -> Array:
        return 100.0 * (pulses[name] / stroke - 1.0)

    def draw(figure: Figure) -> None:
        axes = figure.subplots()
        axes.fill_between(stroke, share("stronger"), share("weaker"), facecolor=LIGHT["held-out"], alpha=0.15, linewidth=0.0)
        axes.axhline(0.0, label="simplified friction ± error of the fit", **MODELS[SIMPLIFIED])
        axes.plot(stroke, share("full"), marker="o", markersize=3.0, label="full friction", **MODELS[FULL])
        axes.plot(stroke, share("without_periodic"), color=LIGHT["ink"], linewidth=1.0, label="its average part alone")
        axes.plot(stroke, share("averaged"), color=LIGHT["earlier"], linestyle=":", label="constant averaged over the stroke")
        _over_strokes(axes)
        _mark(axes, found.pulse_suffices_to[study.USUAL_VOLTAGE])
        marks.label_axes(axes, "stroke beyond that of the simplified model", "%", "stroke of the motor", "rad")
        marks.legend(figure, axes)

    return figures.inline(draw, (FIGURE_WIDTH, 3.6), "pulses", "Stroke of a pulse in open loop, by model")


def control_figure(found: PositionControl) -> str:
    """Draw the difference of the output from the simplified model's under the controller, over the stroke."""
    moves = found.under_control

    def draw(figure: Figure) -> None:
        axes = figure.subplots()
        for name, label, style in (
            ("output_angle", "full − simplified", {**MODELS[FULL], "marker": "o", "markersize": 3.0}),
            ("without_periodic", "its average part alone − simplified", {"color": LIGHT["ink"], "linewidth": 1.0}),
            ("averaged", "full − constant averaged over the stroke", {"color": LIGHT["earlier"], "linestyle": ":"}),
            ("fit_error", "what the error of the fit leaves open", MODELS[SIMPLIFIED]),
        ):
            axes.plot(moves["stroke"], moves[name], label=label, **style)
        axes.axhline(LEAST_OF_TABLE_4, color=LIGHT["measured"], linewidth=1.2, label="least error of document P's Table 4")
        axes.set_yscale("log")
        _over_strokes(axes)
        marks.label_axes(axes, "rms difference of the output angle", "rad", "stroke of the motor", "rad")
        marks.legend(figure, axes)

    return figures.inline(
        draw, (FIGURE_WIDTH, 3.8), "control", "Difference of the models under the controller, over the stroke"
    )


def _over_strokes(axes: Axes) -> None:
    from matplotlib.ticker import NullFormatter

    axes.set_xscale("log")
    axes.xaxis.set_minor_formatter(NullFormatter())
    axes.yaxis.set_minor_formatter(NullFormatter())


def _mark(axes: Axes, place: float) -> None:
    if isfinite(place):
        axes.axvline(place, color=LIGHT["muted"], linestyle=":", linewidth=1.0)
