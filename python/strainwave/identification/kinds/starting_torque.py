"""Tables of the starting torque, as test engineers write it down: a row for each trial, with its temperature and load."""

from __future__ import annotations

from collections.abc import Sequence
from math import sqrt

import numpy as np
from numpy.typing import NDArray

from strainwave.files.units import convert
from strainwave.identification.checks.sizes import friction_at_rest
from strainwave.identification.kinds.at_rest import with_breakaway
from strainwave.identification.kinds.kind import Kind
from strainwave.identification.reading.mapping import FileMapping
from strainwave.identification.reading.names import is_at_rest
from strainwave.identification.reading.recognise import Recognised
from strainwave.identification.reading.roles import Column, ColumnRoles, channels, first, measured, needed
from strainwave.identification.results.file_result import BREAKAWAY_PATH, FileEstimate, FileResult
from strainwave.identification.results.gear_so_far import GearSoFar
from strainwave.statistics.linear_fit import linear_fit

Array = NDArray[np.float64]

UNITS_OF_TRIAL = {"temperature": "K", "load_torque": "N.m"}  # with which it changes, and their units


class StartingTorque(Kind):
    """A torque at which the shaft begins to turn, in each row, without its motion."""

    needs = "a starting torque"

    def recognises(self, columns: Sequence[Column], mapping: FileMapping) -> bool:
        """True for a torque of this name without a motion."""
        is_named = any(is_at_rest(each.label.name) for each in measured(columns, "torque"))
        return is_named and not measured(columns, "angle", "speed", "time", "twist")

    def roles(self, columns: Sequence[Column], mapping: FileMapping) -> ColumnRoles:
        torques = measured(columns, "torque")
        starting = [each for each in torques if is_at_rest(each.label.name)] or torques
        torque = needed(starting, "torque", self.title)
        loads = [each for each in torques if each not in starting]
        by_channel = channels({"torque": [torque], "load_torque": loads})
        side = mapping.side or torque.channel.side or "input"
        why = f"{torque.name} is the torque at which the {side} begins to turn, in each row: {self.title}"
        return ColumnRoles(self.name, {**by_channel, **first(columns, "temperature")}, side, (why,))

    def fit(self, file: Recognised, known: GearSoFar) -> tuple[FileResult, GearSoFar]:
        """Fit the breakaway torque without load, at the mean temperature, and how it changes with both.

        Raises:
            ValueError: too few rows, all alike, or it is the torque of the output
        """
        if file.side == "output":
            raise ValueError(
                "the starting torque of the output contains the loss of the mesh, and determines no parameter by itself: give "
                "that of the input, or a log of the joint, driven from its output"
            )
        name, torque = file.path.name, np.abs(file.recording.values("torque", "N.m"))
        conditions = {
            each: file.recording.values(each, unit) for each, unit in UNITS_OF_TRIAL.items() if each in file.recording
        }
        varying = {each: np.abs(values) for each, values in conditions.items() if np.ptp(values) > 0.0}
        if "temperature" in varying:
            varying["temperature"] = varying["temperature"] - varying["temperature"].mean()
        columns = np.stack([np.ones_like(torque), *varying.values()], axis=1)
        if len(torque) <= columns.shape[1]:
            raise ValueError(f"{len(torque)} rows show no scatter of a starting torque; {columns.shape[1] + 1} are the least")
        trend = linear_fit(columns, torque)
        if (steps := np.diff(np.unique(torque))).size == 0:
            raise ValueError(f"all {len(torque)} rows have the same torque, so its scatter is not seen: record more digits")
        rounding = float(steps.min()) / sqrt(12.0 * len(torque))  # of a digit, if rows agree to the last one
        (level, *slopes), (sigma, *of_slopes) = trend.values.tolist(), np.hypot(trend.sigma, rounding).tolist()
        estimate = FileEstimate(BREAKAWAY_PATH, "N.m", level, sigma, "").unless_uncertain()
        at = f" at {convert(conditions['temperature'].mean(), 'K', 'degC'):.3g} °C" if "temperature" in conditions else ""
        remarks = [
            f"{len(torque)} trials: {level:.4g} ± {sigma:.2g} N·m{at}{', without load' if 'load_torque' in varying else ''}"
        ]
        for each, slope, of_slope in zip(varying, slopes, of_slopes, strict=True):
            for_each = f"for each {UNITS_OF_TRIAL[each].replace('.', '·')} of {each.replace('_', ' ')}"
            remarks.append(f"it changes by {slope:.3g} ± {of_slope:.2g} N·m {for_each}; a table of friction determines the law")
        after, below = with_breakaway(known, estimate, name)
        checks = tuple(friction_at_rest(level, known.initial.gear, name))
        return FileResult(name, file, "starting torque", (estimate,), (*file.remarks, *remarks, *below), checks), after
