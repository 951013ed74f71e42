"""Figures of the study of the actuator paper."""

from __future__ import annotations

from collections.abc import Mapping
from math import degrees
from typing import Any

import misalignment as study
import numpy as np
import strainwave as sw
from matplotlib.figure import Figure
from misalignment import INPUT, OUTPUT, MisalignmentStudy, Recovery
from numpy.typing import NDArray
from pure_error import PureError
from strainwave.diagnose import LOBES, LOOPS
from strainwave.typeset import ARCMIN_PER_RADIAN, number

Array = NDArray[np.float64]

FIGURE_WIDTH = 7.0  # inches, of a figure
DETAIL_TURNS = 2.0  # turns of the input that a detail shows
TILTED = (("tab:purple", ":"), ("tab:green", "--"), ("tab:orange", "-"))  # colour and line of each tilt shown
SHARING = {"single": ("tab:blue", "o"), "max": ("tab:orange", "s"), "mean": ("tab:green", "^")}
GAINS = (("tab:blue", "o"), ("tab:green", "s"), ("tab:purple", "^"), ("tab:orange", "D"))
SEEN = {"transmission_error": "two encoders", "current": "motor current"}


def figures(found: MisalignmentStudy) -> dict[str, Figure]:
    """Return all figures by their names."""
    usual = {each.column: each for each in found.recoveries if each.law.combine == study.USUAL}
    drawn = {
        "pure-error": pure_figure(found.pure),
        "ramp": ramp_figure(found),
        "differences": difference_figure(found),
        "levels": level_figure(found),
        "spectra": spectrum_figure(found),
        "flap": flap_figure(found),
        "passing": passing_figure(found),
        "recovery": recovery_figure(usual),
    }
    return drawn | ({} if found.measured is None else {"measured-ramp": measured_figure(found, found.measured)})


def tilt_words(tilt: float) -> str:
    """Return a tilt in degrees."""
    return f"{number(degrees(tilt), 2)}°" if tilt else "straight"


def pure_figure(pure: PureError) -> Figure:
    """Draw a measured curve and the law fitted to it, and what it leaves, over a turn of the input."""
    turn, figure = np.degrees(pure.angle), Figure((FIGURE_WIDTH, 5.0), layout="constrained")
    error, rest = figure.subplots(2, 1, sharex=True, height_ratios=(2.0, 1.0))
    measured = "measured" if pure.source else "curve, assumed"
    error.plot(turn, ARCMIN_PER_RADIAN * pure.curve, color="tab:blue", linewidth=2.6, alpha=0.6, label=measured)
    for kind in ("single", "max") if pure.best != "mean" else ("single", "mean", "max"):
        line: dict[str, Any] = {"linestyle": "-" if kind == pure.best else "--", "color": SHARING[kind][0]}
        if kind == "single":
            line["color"] = "tab:green"
        error.plot(turn, ARCMIN_PER_RADIAN * pure.fits[kind].curve, label=f"fitted, {LOBES[kind]}", **line)
        rest.plot(turn, ARCMIN_PER_RADIAN * (pure.curve - pure.fits[kind].curve), **line)
    rest.axhline(0.0, color="grey", linewidth=0.8)
    error.set_ylabel("pure kinematic error [arcmin]")
    rest.set(ylabel="curve − fitted [arcmin]", xlabel="input angle [°]", xticks=np.arange(0.0, 361.0, 60.0) + turn[0])
    error.legend()
    return figure


def ramp_figure(found: MisalignmentStudy) -> Figure:
    """Draw torque, current and error of the output over the ramp, straight and with the largest tilt shown."""
    figure = Figure((FIGURE_WIDTH, 6.0), layout="constrained")
    torque, current, error = figure.subplots(3, 1, sharex=True, height_ratios=(1.3, 1.3, 1.0))
    for tilt, colour in ((study.SHOWN_TILTS[-1], "tab:orange"), (0.0, "black")):
        run = found.shown[OUTPUT][tilt]
        style: dict[str, Any] = {"color": colour, "linewidth": 0.9, "label": f"tilt {tilt_words(tilt)}" if tilt else "straight"}
        torque.plot(run.time, run["torque"], **style)
        current.plot(run.time, run["current"], **style)
        error.plot(run.time, ARCMIN_PER_RADIAN * (run["output_angle"] - run["command"]), **style)
    torque.set_ylabel("torque at the output [N·m]")
    current.set_ylabel("motor current [A]")
    error.set(ylabel="output angle − command [arcmin]", xlabel="time [s]")
    torque.legend()
    return figure


def difference_figure(found: MisalignmentStudy) -> Figure:
    """Draw the paper's Figure 3.b, read both ways: differences of the torque, and the kinematic error, for three tilts."""
    ramp, runs, figure = found.ramp, found.shown[OUTPUT], Figure((FIGURE_WIDTH, 7.0), layout="constrained")
    whole, torque, error = figure.subplots(3, 1)
    for tilt, (colour, line) in zip(study.SHOWN_TILTS[::-1], TILTED[::-1], strict=True):
        there, run = study.difference(ramp, runs, tilt, "torque"), ramp.settled(runs[tilt])
        turns = run["input_angle"] / (2.0 * np.pi)
        last = _detail(turns)
        style: dict[str, Any] = {"color": colour, "linestyle": line, "label": f"tilt {tilt_words(tilt)}"}
        whole.plot(there.time, there["torque"], color=colour, linewidth=0.8)
        torque.plot(turns[last], there["torque"][last], **style)
        error.plot(turns[last], ARCMIN_PER_RADIAN * run["kinematic_error"][last], **style)
    whole.set(ylabel="difference of the torque [N·m]", xlabel="time [s]")
    torque.set(ylabel="difference of the torque,\nlast two turns [N·m]", xlabel="turns of the input")
    error.set(ylabel="pure kinematic error [arcmin],\nsame turns", xlabel="turns of the input")
    torque.legend()
    return figure


def _detail(turns: Array) -> NDArray[np.bool_]:
    way = np.abs(turns)
    chosen: NDArray[np.bool_] = way >= way[-1] - DETAIL_TURNS
    return chosen


def level_figure(found: MisalignmentStudy) -> Figure:
    """Draw half swings of torque and current over the size of m, for each way of sharing, by eccentricity and by tilt."""
    figure = Figure((FIGURE_WIDTH, 3.8), layout="constrained")
    panels = figure.subplots(1, 2)
    for axes, column, words in zip(panels, ("torque_swing", "current_swing"), ("torque [N·m]", "current [A]"), strict=True):
        for combine, (colour, marker) in SHARING.items():
            levels = found.levels[combine, OUTPUT]
            sizes = levels.column("e1", "housing_eccentricity") / study.M_PER_MICRON
            style: dict[str, Any] = {"color": colour, "marker": marker}
            axes.plot(sizes, levels.column("e1", column), label=LOBES[combine], markersize=4.0, **style)
            tilted = float(found.law.offset) * np.tan(levels.column("beta", "housing_tilt_x")) / study.M_PER_MICRON
            axes.plot(tilted, levels.column("beta", column), linestyle="", markerfacecolor="none", markersize=6.0, **style)
        axes.set(xscale="log", yscale="log", ylabel=f"half swing of {words}", xlabel="|m| [µm]")
    panels[0].legend()
    return figure


def spectrum_figure(found: MisalignmentStudy) -> Figure:
    """Draw orders of torque, current and output angle, straight and tilted."""
    names = {"torque": "torque [N·m]", "current": "motor current [A]", "output_angle": "output angle − command [arcmin]"}
    figure = Figure((FIGURE_WIDTH, 6.5), layout="constrained")
    panels = figure.subplots(3, 1, sharex=True)
    for axes, (column, words) in zip(panels, names.items(), strict=True):
        scale = ARCMIN_PER_RADIAN if column == "output_angle" else 1.0
        straight, tilted = found.spectra[column]
        label = f"tilt {tilt_words(study.SHOWN_TILT)}"
        axes.plot(tilted["order"], scale * tilted["amplitude"], color="tab:orange", linewidth=1.0, label=label)
        axes.plot(straight["order"], scale * straight["amplitude"], color="black", linewidth=0.9, label="straight")
        top = scale * float(max(tilted["amplitude"].max(), straight["amplitude"].max()))
        axes.set(yscale="log", ylim=(1e-5 * top, 2.0 * top), ylabel=f"amplitude,\n{words}")
    panels[-1].set(xlabel="order, per turn of the input", xticks=range(int(study.MAX_ORDER) + 1))
    panels[0].legend()
    return figure


def flap_figure(found: MisalignmentStudy) -> Figure:
    """Draw the change of the output by a tilt, with the loop on either shaft, and the simulated error."""
    largest, figure = study.SHOWN_TILTS[-1], Figure((FIGURE_WIDTH, 3.6), layout="constrained")
    axes = figure.subplots()
    run = found.ramp.settled(found.shown[OUTPUT][largest])
    turns, put_in = run["input_angle"] / (2.0 * np.pi), -ARCMIN_PER_RADIAN * run["kinematic_error"]
    last = _detail(turns)
    axes.plot(turns[last], put_in[last] - put_in[last].mean(), color="black", linewidth=0.9, label="the whole error, reversed")
    for side, colour, line in ((OUTPUT, "tab:orange", "-"), (INPUT, "tab:blue", "--")):
        there = study.difference(found.ramp, found.shown[side], largest, "output_angle")
        turned, moved = there["input_angle"] / (2.0 * np.pi), ARCMIN_PER_RADIAN * there["output_angle"]
        end = _detail(turned)
        label = f"loop on the {LOOPS[side]}"
        axes.plot(turned[end], moved[end] - moved[end].mean(), color=colour, linestyle=line, label=label)
    axes.set(ylabel="output angle, difference [arcmin]", xlabel="turns of the input")
    axes.legend()
    return figure


def passing_figure(found: MisalignmentStudy) -> Figure:
    """Draw the share of the error that the output has, over the frequency of the order, for each gain of the position loop."""
    figure = Figure((FIGURE_WIDTH, 5.8), layout="constrained")
    panels = figure.subplots(2, 1, sharex=True, sharey=True)
    for axes, side in zip(panels, (OUTPUT, INPUT), strict=True):
        table = found.passing[side].table
        for gain, (colour, marker) in zip(np.unique(table["position_gain"]), GAINS, strict=True):
            for order, line in ((2.0, "-"), (4.0, ":")):
                chosen = (table["position_gain"] == gain) & (table["order"] == order)
                frequency, share = table["frequency"][chosen], 100.0 * table["share"][chosen]
                place = np.argsort(frequency)
                label = f"position loop of {number(gain / (2.0 * np.pi), 2)} Hz" if order == 2.0 else None
                axes.plot(frequency[place], share[place], label=label, color=colour, marker=marker, linestyle=line)
        axes.set_ylabel(f"share [%], loop on the {LOOPS[side]}")
    swept = np.geomspace(table["frequency"].min(), table["frequency"].max(), 100)
    ideal = 100.0 * study.share_by_ideal_loop(swept, found.ramp.gain)
    label = f"ideal loop of {number(found.ramp.gain / (2.0 * np.pi), 2)} Hz, rigid gear"
    panels[0].plot(swept, ideal, color="black", linestyle="--", label=label)
    panels[1].set(xscale="log", ylim=(0.0, None), xlabel="frequency of the order [Hz]")
    panels[0].legend()
    return figure


def recovery_figure(recoveries: Mapping[str, Recovery]) -> Figure:
    """Draw the estimates of m from records with different noise, the ellipse of the first, and the true value."""
    figure = Figure((FIGURE_WIDTH, 3.8), layout="constrained")
    panels = figure.subplots(1, len(recoveries), squeeze=False)[0]
    for axes, (column, recovery) in zip(panels, recoveries.items(), strict=True):
        sign = 1.0 if np.dot(recovery.best.m, recovery.m) > 0.0 else -1.0
        points = sign * np.array([trial.m for trial in recovery.trials]) / study.M_PER_MICRON
        axes.plot(*points.T, "o", color="tab:blue", markersize=3.0, label="found, other noises")
        axes.plot(*_ellipse(recovery, sign) / study.M_PER_MICRON, color="tab:blue", label="95 % of the first record")
        truth = np.array(recovery.m) / study.M_PER_MICRON
        axes.plot(*truth, "+", color="tab:orange", markersize=9.0, markeredgewidth=1.5, label="put in")
        axes.set_aspect("equal", adjustable="datalim")
        axes.set(ylabel=f"{SEEN[column]}: m in y [µm]", xlabel="m in x [µm]")
    panels[0].legend()
    return figure


def _ellipse(recovery: Recovery, sign: float) -> Array:
    """The ellipse of 95 % confidence [m], shape (2, n)."""
    best = recovery.best
    way = np.linspace(0.0, 2.0 * np.pi, 181)
    root = np.linalg.cholesky(best.covariance)
    outline: Array = sign * np.array(best.m)[:, None] + best.reach * root @ np.array([np.cos(way), np.sin(way)])
    return outline


def measured_figure(found: MisalignmentStudy, measured: sw.Recording) -> Figure:
    """Draw a recording of a ramp on the simulated one."""
    names = {"torque": "torque at the output [N·m]", "current": "motor current [A]"}
    names |= {"output_angle": "output angle [rad]", "input_angle": "input angle [rad]"}
    there = [name for name in names if name in measured]
    figure = Figure((FIGURE_WIDTH, 1.0 + 2.0 * len(there)), layout="constrained")
    panels = figure.subplots(len(there), 1, sharex=True, squeeze=False)[:, 0]
    tilted = found.shown[OUTPUT][study.SHOWN_TILT]
    for axes, name in zip(panels, there, strict=True):
        axes.plot(measured.time, measured[name], color="tab:blue", linewidth=2.2, alpha=0.6, label="measured")
        label = f"simulated, tilt {tilt_words(study.SHOWN_TILT)}"
        axes.plot(tilted.time, tilted[name], color="tab:orange", linewidth=0.9, label=label)
        axes.plot(found.straight.time, found.straight[name], color="black", linewidth=0.9, label="simulated, straight")
        axes.set_ylabel(names[name])
    panels[-1].set_xlabel("time [s]")
    panels[0].legend()
    return figure
