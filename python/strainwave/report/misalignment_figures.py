"""Figures of the study of document A."""

from __future__ import annotations

from collections.abc import Mapping
from math import degrees
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from strainwave.diagnose.actuator_ramp import INPUT, LOOPS, OUTPUT
from strainwave.drawing import marks
from strainwave.drawing.style import FIGURE_WIDTH, LIGHT
from strainwave.files.recording import Recording
from strainwave.report import figures
from strainwave.studies import misalignment as study
from strainwave.studies.misalignment import MisalignmentStudy, Recovery
from strainwave.studies.pure_error import PureError
from strainwave.typeset import ARCMIN_PER_RADIAN, number, power_of_ten
from strainwave.typeset import unit as typeset_unit

if TYPE_CHECKING:
    from matplotlib.axis import Axis
    from matplotlib.figure import Figure

Array = NDArray[np.float64]

DETAIL_TURNS = 2.0  # turns of the input that a detail shows
STRAIGHT: dict[str, Any] = {"color": LIGHT["ink"], "linewidth": 1.0}
TILTED: tuple[dict[str, Any], ...] = (
    {"color": LIGHT["earlier"], "linestyle": ":", "linewidth": 1.2},
    {"color": LIGHT["held-out"], "linestyle": "--", "linewidth": 1.2},
    {"color": LIGHT["model"], "linestyle": "-", "linewidth": 1.2},
)
SHARING: dict[str, dict[str, Any]] = {
    "single": {"color": LIGHT["measured"], "marker": "o"},
    "max": {"color": LIGHT["model"], "marker": "s"},
    "mean": {"color": LIGHT["held-out"], "marker": "^"},
}
GAINS = (("measured", "o"), ("held-out", "s"), ("earlier", "^"), ("model", "D"))
WORDS = {"single": "one lobe carries", "mean": "both lobes share", "max": "the outer lobe carries"}
SEEN = {"transmission_error": "two encoders", "current": "motor current"}


def tilt_words(tilt: float) -> str:
    """A tilt in degrees."""
    return f"{number(degrees(tilt), 2)}°" if tilt else "straight"


def pure_figure(pure: PureError) -> str:
    """A measured curve and the law fitted to it, and what it leaves, over a turn of the input."""
    turn = np.degrees(pure.angle)
    kinds = ("single", "max") if pure.best != "mean" else ("single", "mean", "max")

    def draw(figure: Figure) -> None:
        error, rest = figure.subplots(2, 1, sharex=True, height_ratios=(2.0, 1.0))
        measured = "measured" if pure.source else "curve, assumed"
        error.plot(turn, ARCMIN_PER_RADIAN * pure.curve, color=LIGHT["measured"], linewidth=2.6, alpha=0.6, label=measured)
        for kind in kinds:
            style = {"color": SHARING[kind]["color"] if kind != "single" else LIGHT["held-out"]}
            line: dict[str, Any] = {"linestyle": "-" if kind == pure.best else "--", "linewidth": 1.2, **style}
            error.plot(turn, ARCMIN_PER_RADIAN * pure.fits[kind].curve, label=f"fitted, {WORDS[kind]}", **line)
            rest.plot(turn, ARCMIN_PER_RADIAN * (pure.curve - pure.fits[kind].curve), **line)
        rest.axhline(0.0, color=LIGHT["muted"], linewidth=0.8)
        marks.label_axes(error, "pure kinematic error [arcmin]", "1")
        marks.label_axes(rest, "curve − fitted [arcmin]", "1", "input angle [°]", "1")
        rest.set_xticks(np.arange(0.0, 361.0, 60.0) + turn[0])
        marks.legend(figure, error)

    return figures.inline(draw, (FIGURE_WIDTH, 4.0), "pure-error", "Pure kinematic error over a turn of the input")


def ramp_figure(found: MisalignmentStudy) -> str:
    """Torque, current and error of the output over the ramp, straight and with the largest tilt shown."""
    runs = found.shown[OUTPUT]
    largest = study.SHOWN_TILTS[-1]

    def draw(figure: Figure) -> None:
        axes = figure.subplots(3, 1, sharex=True, height_ratios=(1.3, 1.3, 1.0))
        for tilt, style in ((largest, {"color": LIGHT["model"], "linewidth": 0.9}), (0.0, STRAIGHT)):
            run = runs[tilt]
            label = f"tilt {tilt_words(tilt)}" if tilt else "straight"
            marks.curve(axes[0], run.time, run["torque"], label=label, **style)
            marks.curve(axes[1], run.time, run["current"], label=label, **style)
            marks.curve(axes[2], run.time, run["output_angle"] - run["command"], label=label, **style)
        marks.label_axes(axes[0], "torque at the output", "N.m")
        marks.label_axes(axes[1], "motor current", "A")
        marks.label_axes(axes[2], "output angle − command", "rad", "time", "s")
        marks.legend(figure, axes[0])

    return figures.inline(draw, (FIGURE_WIDTH, 5.0), "ramp", "Torque, current and error of the output over the ramp")


def difference_figure(found: MisalignmentStudy) -> str:
    """Document A's Figure 3.b, read both ways: differences of the torque, and the kinematic error, for three tilts."""
    ramp, runs = found.ramp, found.shown[OUTPUT]
    differences = {tilt: study.difference(ramp, runs, tilt, "torque") for tilt in study.SHOWN_TILTS}

    def draw(figure: Figure) -> None:
        whole, torque, error = figure.subplots(3, 1, height_ratios=(1.2, 1.2, 1.2))
        for tilt, style in reversed(list(zip(study.SHOWN_TILTS, TILTED, strict=True))):
            there = differences[tilt]
            marks.curve(whole, there.time, there["torque"], **{**style, "linestyle": "-", "linewidth": 0.8})
        for tilt, style in zip(study.SHOWN_TILTS, TILTED, strict=True):
            there, run = differences[tilt], ramp.settled(runs[tilt])
            turns = run["input_angle"] / (2.0 * np.pi)
            last = _detail(turns)
            torque.plot(turns[last], there["torque"][last], label=f"tilt {tilt_words(tilt)}", **style)
            error.plot(turns[last], ARCMIN_PER_RADIAN * run["kinematic_error"][last], **style)
        marks.label_axes(whole, "difference of the torque, whole ramp", "N.m", "time", "s")
        marks.label_axes(torque, "difference of the torque, last two turns", "N.m")
        marks.label_axes(error, "pure kinematic error [arcmin], same turns", "1", "turns of the input", "1")
        error.sharex(torque)
        marks.legend(figure, torque)

    title = "Differences of the torque and kinematic error, for three tilts of the input shaft"
    return figures.inline(draw, (FIGURE_WIDTH, 5.6), "differences", title)


def _detail(turns: Array) -> NDArray[np.bool_]:
    way = np.abs(turns)
    chosen: NDArray[np.bool_] = way >= way[-1] - DETAIL_TURNS
    return chosen


def level_figure(found: MisalignmentStudy) -> str:
    """Half swing of torque and current over the size of m, for each way of sharing, by eccentricity and by tilt."""

    def draw(figure: Figure) -> None:
        panels = figure.subplots(1, 2)
        for axes, column, unit in zip(panels, ("torque_swing", "current_swing"), ("N.m", "A"), strict=True):
            for combine, style in SHARING.items():
                levels = found.levels[combine, OUTPUT]
                sizes = levels.column("e1", "housing_eccentricity")
                line = {"linewidth": 1.1, "markersize": 4.0, **style}
                axes.plot(sizes / study.M_PER_MICRON, levels.column("e1", column), label=WORDS[combine], **line)
                tilted = float(found.law.offset) * np.tan(levels.column("beta", "housing_tilt_x"))
                hollow = {**style, "linestyle": "", "markerfacecolor": "none", "markersize": 6.0}
                axes.plot(tilted / study.M_PER_MICRON, levels.column("beta", column), **hollow)
            axes.set_xscale("log")
            axes.set_yscale("log")
            name = "half swing of torque" if unit == "N.m" else "half swing of current"
            marks.label_axes(axes, f"{name} [{unit.replace('.', '·')}]", "1", "|m| [µm]", "1")
            _plain(axes.xaxis)
            _decades(axes.yaxis)
        marks.legend(figure, panels[0])

    return figures.inline(draw, (FIGURE_WIDTH, 3.3), "levels", "Swing of torque and current over the misalignment")


def _plain(axis: Axis) -> None:
    """Plain numbers at 1, 2 and 5 of each decade of a logarithmic axis."""
    from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

    axis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
    axis.set_minor_formatter(NullFormatter())
    axis.set_major_formatter(FuncFormatter(lambda value, _: number(value, 3)))


def _decades(axis: Axis) -> None:
    """Plain numbers or powers of ten at the decades of a logarithmic axis."""
    from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

    def decade(value: float, _: float) -> str:
        power = round(float(np.log10(value)))
        return number(value) if abs(power) <= 2 else power_of_ten(power)

    axis.set_major_locator(LogLocator(numticks=6))
    axis.set_minor_formatter(NullFormatter())
    axis.set_major_formatter(FuncFormatter(decade))


def spectrum_figure(found: MisalignmentStudy) -> str:
    """Orders of torque, current and output angle, straight and tilted."""
    names = {
        "torque": ("torque", "N.m"),
        "current": ("motor current", "A"),
        "output_angle": ("output angle − command", "arcmin"),
    }

    def draw(figure: Figure) -> None:
        panels = figure.subplots(3, 1, sharex=True)
        for axes, (column, (words, unit)) in zip(panels, names.items(), strict=True):
            scale = ARCMIN_PER_RADIAN if unit == "arcmin" else 1.0
            straight, tilted = found.spectra[column]
            label = f"tilt {tilt_words(study.SHOWN_TILT)}"
            axes.plot(tilted["order"], scale * tilted["amplitude"], color=LIGHT["model"], linewidth=1.0, label=label)
            axes.plot(straight["order"], scale * straight["amplitude"], color=LIGHT["ink"], linewidth=0.9, label="straight")
            axes.set_yscale("log")
            top = scale * float(max(tilted["amplitude"].max(), straight["amplitude"].max()))
            axes.set_ylim(1e-5 * top, 2.0 * top)
            last = axes is panels[-1]
            text, of = ("order, per turn of the input", "1") if last else ("", "1")
            marks.label_axes(axes, f"amplitude, {words} [{typeset_unit(unit)}]", "1", text, of)
            _decades(axes.yaxis)
            axes.set_xticks(range(int(study.MAX_ORDER) + 1))
        marks.legend(figure, panels[0])

    return figures.inline(draw, (FIGURE_WIDTH, 5.2), "spectra", "Order spectra of torque, current and output angle")


def flap_figure(found: MisalignmentStudy) -> str:
    """Draw the change of the output by a tilt, with the loop on either shaft, and the simulated error."""
    largest = study.SHOWN_TILTS[-1]

    def draw(figure: Figure) -> None:
        axes = figure.subplots()
        run = found.ramp.settled(found.shown[OUTPUT][largest])
        turns = run["input_angle"] / (2.0 * np.pi)
        last = _detail(turns)
        put_in = -run["kinematic_error"]
        label = "the whole error, reversed"
        axes.plot(
            turns[last],
            ARCMIN_PER_RADIAN * (put_in - put_in[last].mean())[last],
            color=LIGHT["ink"],
            linewidth=0.9,
            label=label,
        )
        for side, colour, line in ((OUTPUT, "model", "-"), (INPUT, "measured", "--")):
            there = study.difference(found.ramp, found.shown[side], largest, "output_angle")
            turned, moved = there["input_angle"] / (2.0 * np.pi), ARCMIN_PER_RADIAN * there["output_angle"]
            end = _detail(turned)
            style: dict[str, Any] = {"color": LIGHT[colour], "linestyle": line, "label": f"loop on the {LOOPS[side]}"}
            axes.plot(turned[end], moved[end] - moved[end].mean(), **style)
        marks.label_axes(axes, "output angle, difference [arcmin]", "1", "turns of the input", "1")
        marks.legend(figure, axes)

    return figures.inline(draw, (FIGURE_WIDTH, 2.9), "flap", "Output angle with a tilt less that without, by loop")


def passing_figure(found: MisalignmentStudy) -> str:
    """The share of the error that the output has, over the frequency of the order, for each gain of the position loop."""

    def draw(figure: Figure) -> None:
        panels = figure.subplots(2, 1, sharex=True, sharey=True)
        for axes, side in zip(panels, (OUTPUT, INPUT), strict=True):
            table = found.passing[side].table
            for gain, (colour, marker) in zip(np.unique(table["position_gain"]), GAINS, strict=True):
                for order, line in ((2.0, "-"), (4.0, ":")):
                    chosen = (table["position_gain"] == gain) & (table["order"] == order)
                    bandwidth = number(gain / (2.0 * np.pi), 2)
                    label = f"position loop of {bandwidth} Hz" if order == 2.0 else ""
                    style: dict[str, Any] = {"color": LIGHT[colour], "marker": marker, "linestyle": line, "linewidth": 1.0}
                    frequency, share = table["frequency"][chosen], 100.0 * table["share"][chosen]
                    place = np.argsort(frequency)
                    axes.plot(frequency[place], share[place], label=label, markersize=4.0, **style)
            marks.label_axes(axes, f"share [%], loop on the {LOOPS[side]}", "1")
        swept = np.geomspace(table["frequency"].min(), table["frequency"].max(), 100)
        ideal = 100.0 * study.share_by_ideal_loop(swept, found.ramp.gain)
        label = f"ideal loop of {number(found.ramp.gain / (2.0 * np.pi), 2)} Hz, rigid gear"
        panels[0].plot(swept, ideal, color=LIGHT["ink"], linewidth=1.0, linestyle="--", label=label)
        panels[1].set_xscale("log")
        panels[1].set_ylim(0.0, None)
        panels[1].set_xlabel("frequency of the order [Hz]")
        _plain(panels[1].xaxis)
        marks.legend(figure, panels[0])

    return figures.inline(draw, (FIGURE_WIDTH, 4.6), "passing", "Share of the kinematic error that reaches the output")


def recovery_figure(recoveries: Mapping[str, Recovery]) -> str:
    """Draw the estimates of m from records with different noise, the ellipse of the first, and the true value."""

    def draw(figure: Figure) -> None:
        panels = figure.subplots(1, len(recoveries), squeeze=False)[0]
        for axes, (column, recovery) in zip(panels, recoveries.items(), strict=True):
            sign = 1.0 if np.dot(recovery.best.m, recovery.m) > 0.0 else -1.0
            points = sign * np.array([trial.m for trial in recovery.trials])
            x, y = points.T / study.M_PER_MICRON
            axes.plot(x, y, "o", color=LIGHT["measured"], markersize=3.0, label="found, other noises")
            outline = _ellipse(recovery, sign)
            axes.plot(*outline / study.M_PER_MICRON, color=LIGHT["measured"], linewidth=1.0, label="95 % of the first record")
            true_x, true_y = np.array(recovery.m) / study.M_PER_MICRON
            axes.plot(true_x, true_y, "+", color=LIGHT["model"], markersize=9.0, markeredgewidth=1.5, label="put in")
            axes.set_aspect("equal", adjustable="datalim")
            marks.label_axes(axes, f"{SEEN[column]}: m in y [µm]", "1", "m in x [µm]", "1")
            axes.locator_params(nbins=4)
        marks.legend(figure, panels[0])

    return figures.inline(draw, (FIGURE_WIDTH, 3.2), "recovery", "Misalignment recovered from records of a ramp")


def _ellipse(recovery: Recovery, sign: float) -> Array:
    """The ellipse of 95 % confidence [m], shape (2, n)."""
    best = recovery.best
    way = np.linspace(0.0, 2.0 * np.pi, 181)
    root = np.linalg.cholesky(best.covariance)
    outline: Array = sign * np.array(best.m)[:, None] + best.reach * root @ np.array([np.cos(way), np.sin(way)])
    return outline


def measured_figure(found: MisalignmentStudy, measured: Recording) -> str:
    """A recording of a ramp on the simulated one."""
    names = {
        "torque": ("torque at the output", "N.m"),
        "current": ("motor current", "A"),
        "output_angle": ("output angle", "rad"),
    }
    names["input_angle"] = ("input angle", "rad")
    there = [name for name in names if name in measured]

    def draw(figure: Figure) -> None:
        panels = figure.subplots(len(there), 1, sharex=True, squeeze=False)[:, 0]
        for axes, name in zip(panels, there, strict=True):
            style: dict[str, Any] = {"color": LIGHT["measured"], "linewidth": 2.2, "alpha": 0.6, "label": "measured"}
            marks.curve(axes, measured.time, measured[name], **style)
            tilted = found.shown[OUTPUT][study.SHOWN_TILT]
            label = f"simulated, tilt {tilt_words(study.SHOWN_TILT)}"
            marks.curve(axes, tilted.time, tilted[name], color=LIGHT["model"], linewidth=0.9, label=label)
            marks.curve(axes, found.straight.time, found.straight[name], label="simulated, straight", **STRAIGHT)
            last = name == there[-1]
            marks.label_axes(axes, *names[name], *(("time", "s") if last else ()))
        marks.legend(figure, panels[0])

    return figures.inline(draw, (FIGURE_WIDTH, 1.0 + 1.5 * len(there)), "measured-ramp", "Measured and simulated ramp")
