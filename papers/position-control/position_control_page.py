"""The page of the position control article's experiments, its figures, and the same in a few lines for a terminal."""

from __future__ import annotations

from collections.abc import Iterator
from math import degrees, isfinite
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import position_control as study
import strainwave as sw
from jinja2 import Environment, StrictUndefined
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from position_control import FULL, SIMPLIFIED, CommandExperiment, MeasuredRun, PositionControl
from strainwave.typeset import number, quantity

MODELS: dict[str, dict[str, Any]] = {
    FULL: {"color": "tab:orange", "linestyle": "-", "linewidth": 2.6, "alpha": 0.6},
    SIMPLIFIED: {"color": "tab:green", "linestyle": "--", "linewidth": 1.1},
}
LEAST_OF_TABLE_4 = min(rms for rms, _, _ in study.TABLE_4.values())
FIGURE_WIDTH = 7.0  # inches, of a figure


class ExperimentRow(NamedTuple):
    """A row of the table of an experiment, ready to print."""

    label: str
    rms: str
    largest: str
    correlation: str
    settling: str


def write_page(found: PositionControl, folder: Path) -> None:
    """Write the page of the study as page.md, and its figures, into a folder."""
    figures = {each.name: experiment_figure(each) for each in found.experiments}
    figures |= {"friction": friction_figure(found), "pulses": pulse_figure(found), "control": control_figure(found)}
    if found.measured is not None:
        figures["measured"] = measured_figure(found.measured)
    for name, figure in figures.items():
        figure.savefig(folder / f"{name}.svg")
    (folder / "page.md").write_text(page(found), encoding="utf-8")


def page(found: PositionControl) -> str:
    """Return the page of the study in Markdown; its figures are files beside it."""
    environment = Environment(undefined=StrictUndefined, trim_blocks=True, lstrip_blocks=True)
    environment.filters["number"] = number
    template = environment.from_string(Path(__file__).with_name("page.md.jinja").read_text(encoding="utf-8"))
    return template.render(
        limits=_limits(found),
        experiments=[
            {
                "name": each.name,
                "title": each.title,
                "rows": rows(each),
                "current": quantity(each.between["current"].rms, "A"),
                "resolved": _resolved(each),
            }
            for each in found.experiments
        ],
        pulses=list(_pulses(found)),
        measured=None if found.measured is None else _measured(found.measured),
        sets={model: sw.listing(gear_set) for model, gear_set in found.sets.items()},
        study=study,
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
    yield "Table 4 of the article compares with measurements that were not published; it is not reproduced"


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
    return {"name": measured.recording.title, "rows": measured_rows(measured), "beyond": ends}


# ---- Figures ---------------------------------------------------------------------------------------------------------


def experiment_figure(experiment: CommandExperiment) -> Figure:
    """Draw command and response, their difference, the difference of the models, and the current, over time."""
    figure, runs = Figure((FIGURE_WIDTH, 7.5), layout="constrained"), experiment.runs
    first = runs[FULL]
    response, error, apart, current = figure.subplots(4, 1, sharex=True, height_ratios=(1.7, 1.1, 0.9, 1.1))
    response.plot(first.time, 1e3 * first["command"], color="black", linewidth=0.9, label="command")
    for model, run in runs.items():
        response.plot(run.time, 1e3 * run["output_angle"], label=f"{model} friction", **MODELS[model])
        error.plot(run.time, 1e3 * (run["output_angle"] - run["command"]), **MODELS[model])
        current.plot(run.time, run["current"], **MODELS[model])
    apart.plot(first.time, 1e3 * (first["output_angle"] - runs[SIMPLIFIED]["output_angle"]), color="black", linewidth=1.0)
    response.set_ylabel("output angle [mrad]")
    error.set_ylabel("response − command\n[mrad]")
    apart.set_ylabel("full − simplified\n[mrad]")
    current.set(ylabel="current [A]", xlabel="time [s]")
    response.legend()
    return figure


def measured_figure(measured: MeasuredRun) -> Figure:
    """Draw a measured output angle and those of the models, and how far they are apart, over time."""
    recording, figure = measured.recording, Figure((FIGURE_WIDTH, 4.5), layout="constrained")
    response, error = figure.subplots(2, 1, sharex=True, height_ratios=(1.7, 1.1))
    response.plot(recording.time, 1e3 * recording["command"], color="black", linewidth=0.9, label="command")
    response.plot(recording.time, 1e3 * recording["output_angle"], color="tab:blue", linewidth=2.6, alpha=0.6, label="measured")
    for model, run in measured.runs.items():
        response.plot(run.time, 1e3 * run["output_angle"], label=f"{model} friction", **MODELS[model])
        simulated = np.interp(recording.time, run.time, run["output_angle"])
        error.plot(recording.time, 1e3 * (simulated - recording["output_angle"]), **MODELS[model])
    response.set_ylabel("output angle [mrad]")
    error.set(ylabel="simulated − measured [mrad]", xlabel="time [s]")
    response.legend()
    return figure


def friction_figure(found: PositionControl) -> Figure:
    """Draw Coulomb friction over the motor angle: full, its average part, and the constant with the error of the fit."""
    law: Any = found.sets[FULL].gear.friction_input
    simplified: Any = found.sets[SIMPLIFIED].gear.friction_input
    band = 1e3 * (simplified.coulomb - study.FIT_ERROR), 1e3 * (simplified.coulomb + study.FIT_ERROR)
    angle = np.linspace(law.domain_start, law.domain_end, 3000)
    slow = law.replace(viscous=0.0).steady(np.full_like(angle, law.reference_speed), angle=angle)
    figure, axes = _figure(3.6)
    axes.axhspan(*band, facecolor="tab:green", alpha=0.15, linewidth=0.0)
    axes.plot(angle, 1e3 * slow, color="tab:orange", linewidth=0.7, label="full friction")
    parabola = (law.quadratic * angle + law.linear) * angle + law.constant
    axes.plot(angle, 1e3 * parabola, color="black", linewidth=1.4, label="its average part")
    axes.axhline(1e3 * simplified.coulomb, label="simplified friction ± error of the fit", **MODELS[SIMPLIFIED])
    _mark(axes, found.law_suffices_to)
    axes.set(ylabel="Coulomb friction of the motor [mN·m]", xlabel="motor angle [rad]")
    axes.legend()
    return figure


def pulse_figure(found: PositionControl) -> Figure:
    """Draw the excess of a pulse's stroke over that of the simplified model, over the stroke."""
    pulses = found.by_pulse[study.USUAL_VOLTAGE]
    stroke = pulses["stroke"]

    def share(name: str) -> Any:
        return 100.0 * (pulses[name] / stroke - 1.0)

    figure, axes = _figure(4.0)
    axes.fill_between(stroke, share("stronger"), share("weaker"), facecolor="tab:green", alpha=0.15, linewidth=0.0)
    axes.axhline(0.0, label="simplified friction ± error of the fit", **MODELS[SIMPLIFIED])
    axes.plot(stroke, share("full"), marker="o", markersize=3.0, label="full friction", **MODELS[FULL])
    axes.plot(stroke, share("without_periodic"), color="black", linewidth=1.0, label="its average part alone")
    axes.plot(stroke, share("averaged"), color="tab:purple", linestyle=":", label="constant averaged over the stroke")
    _mark(axes, found.pulse_suffices_to[study.USUAL_VOLTAGE])
    axes.set(xscale="log", ylabel="stroke beyond that of the simplified model [%]", xlabel="stroke of the motor [rad]")
    axes.legend()
    return figure


def control_figure(found: PositionControl) -> Figure:
    """Draw the difference of the output from the simplified model's under the controller, over the stroke."""
    moves = found.under_control
    figure, axes = _figure(4.2)
    for name, label, style in (
        ("output_angle", "full − simplified", {**MODELS[FULL], "marker": "o", "markersize": 3.0}),
        ("without_periodic", "its average part alone − simplified", {"color": "black", "linewidth": 1.0}),
        ("averaged", "full − constant averaged over the stroke", {"color": "tab:purple", "linestyle": ":"}),
        ("fit_error", "effect of the error of the fit", MODELS[SIMPLIFIED]),
    ):
        axes.plot(moves["stroke"], 1e3 * moves[name], label=label, **style)
    axes.axhline(1e3 * LEAST_OF_TABLE_4, color="tab:blue", linewidth=1.2, label="least error of the article's Table 4")
    labels = {"ylabel": "rms difference of the output angle [mrad]", "xlabel": "stroke of the motor [rad]"}
    axes.set(xscale="log", yscale="log", **labels)
    axes.legend()
    return figure


def _figure(height: float) -> tuple[Figure, Axes]:
    figure = Figure((FIGURE_WIDTH, height), layout="constrained")
    return figure, figure.subplots()


def _mark(axes: Axes, place: float) -> None:
    if isfinite(place):
        axes.axvline(place, color="grey", linestyle=":", linewidth=1.0)
