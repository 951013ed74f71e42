"""Picture of a compensation: the error of the output over time, of the cascade and of the controller chosen."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from strainwave.drawing import marks
from strainwave.drawing.style import LIGHT, RUNS
from strainwave.simulation.run import simulate

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from strainwave.tuning.compensate import Compensated


def draw_errors(canvas: Figure, compensated: Compensated) -> None:
    """Draw the error of the output over time, of the gear as it is stated; as a torque if that is the goal."""
    axes = canvas.add_subplot()
    command = compensated.goal.command
    name, unit = ("error of the torque", "N.m") if compensated.goal.name == "torque" else ("error of the output", "rad")
    runs = {"cascade": compensated.baseline} | ({"compensated": compensated.chosen} if compensated.is_compensated else {})
    for (label, judged), (colour, line, width) in zip(runs.items(), (RUNS[1], RUNS[0]), strict=False):
        control: Any = judged.candidate.drive.control
        sample = control.period * max(round(command.duration / control.period / 2000.0), 1)  # set-points are exact there
        run = simulate(judged.candidate.drive, command, sample=sample)
        error = compensated.goal.per_angle * np.asarray(command.value(run.time) - run["output_angle"])
        marks.curve(axes, run.time, error, color=LIGHT[colour], linestyle=line, linewidth=width, label=label)
    marks.label_axes(axes, name, unit, "time", "s")
    marks.legend(canvas, axes)
