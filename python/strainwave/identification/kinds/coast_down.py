"""Run-downs of the input without the motor: friction over the inertia that turns."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from strainwave.files.recording import Recording
from strainwave.identification.kinds.friction_table import fit_table
from strainwave.identification.kinds.kind import Kind
from strainwave.identification.reading.mapping import FileMapping
from strainwave.identification.reading.names import Side
from strainwave.identification.reading.recognise import Recognised
from strainwave.identification.reading.roles import Column, ColumnRoles, first, measured, needed
from strainwave.identification.results.file_result import FileResult
from strainwave.identification.results.gear_so_far import GearSoFar, rotor_sigma
from strainwave.questions import Answer, QuestionError
from strainwave.statistics.linear_fit import solved

Array = NDArray[np.float64]

STRETCH_COUNT = 24  # stretches of a run-down, each with its mean speed and its slope
MIN_PARTS, MIN_ROWS_OF_PART = 6, 4
MIN_SPEED = 0.02  # of the first speed: below, the shaft comes to rest
MAX_RISE = 0.1  # of the first speed, by which it may rise after its largest: a shaft without a motor only slows down
MIN_FALL = 0.5  # of the largest speed
ROTOR_ASKED = "inertia of the rotor and what is fixed to it [kg.m2], without the wave generator"


class CoastDown(Kind):
    """A speed that falls while nothing drives the shaft."""

    needs = "time and a speed that falls"
    time = "needed"

    def recognises(self, columns: Sequence[Column], mapping: FileMapping) -> bool:
        """True for one speed that falls from its largest value, without what drives it."""
        speeds = measured(columns, "speed")
        is_alone = (
            len(speeds) == 1
            and measured(columns, "time")
            and not measured(columns, "angle", "vibration", "torque", "current", "voltage")
        )
        return bool(is_alone) and _falls(np.abs(speeds[0].si))

    def roles(self, columns: Sequence[Column], mapping: FileMapping) -> ColumnRoles:
        speed = needed(columns, "speed", self.title)
        side: Side = mapping.side or speed.channel.side or "input"
        why = f"{speed.name} falls, and nothing drives it: {self.title}"
        return ColumnRoles(self.name, {**first(columns, "time"), "speed": speed}, side, (why,))

    def fit(self, file: Recognised, known: GearSoFar) -> tuple[FileResult, GearSoFar]:
        """Fit the friction table of its slopes, by a given inertia.

        Raises:
            QuestionError: the inertia is not given, and the record determines friction over inertia alone
            ValueError: it does not slow down long enough
        """
        speed, slowing = _slopes(file.recording.time, file.recording.values("speed", "rad/s"))
        gear = known.gear_set.gear
        squared = gear.kinematics.ratio**2 if file.side == "output" else 1.0
        if "motor_inertia" not in file.constants:
            dry, viscous = solved(np.stack([np.ones_like(speed), np.abs(speed)], axis=1), np.abs(slowing)).tolist()
            question = (
                f"a run-down determines friction over inertia alone: Coulomb {dry:.4g} N·m and viscous {viscous:.4g} N·m·s/rad"
            )
            is_known = Answer("the inertia is known", {"constants": {"motor_inertia": 1e-4}}, {"motor_inertia": ROTOR_ASKED})
            raise QuestionError(f"{question} for each kg·m² that turns", [is_known])
        load = file.constants.get("load_inertia", 0.0) / gear.kinematics.ratio**2
        inertia = (file.constants["motor_inertia"] + gear.input_inertia + load) * squared
        table = Recording({"speed": speed, "torque": -inertia * slowing}, {"speed": "rad/s", "torque": "N.m"})
        turns = f"{inertia:.4g} kg·m² turn{' at the output' if file.side == 'output' else ''}: friction scales with them"
        remarks = (*file.remarks, f"motor_inertia with the gear's own, and load_inertia, {turns}")
        uncertain = rotor_sigma(file, known.gear_set) * squared / inertia  # of the wave generator: what is given is exact
        return fit_table(replace(file, remarks=remarks), table, uncertain, known)


def _falls(speed: Array) -> bool:
    """True if a speed falls from its largest value, without a rise."""
    fall = speed[int(np.argmax(speed)) :]
    rise = float(np.max(fall - np.minimum.accumulate(fall)))
    return bool(len(fall) > 1 and fall.min() < (1.0 - MIN_FALL) * fall[0] and rise < MAX_RISE * fall[0])


def _slopes(time: Array, speed: Array) -> tuple[Array, Array]:
    """Return mean speed [rad/s] and its slope [rad/s2] in parts of a run-down, until the shaft is at rest.

    Raises:
        ValueError: it slows down in too few rows
    """
    size = np.abs(speed)
    begin = int(np.argmax(size))
    resting = np.flatnonzero(size[begin:] < MIN_SPEED * size[begin])
    end = begin + int(resting[0]) if len(resting) else len(size)
    count = min(STRETCH_COUNT, (end - begin) // MIN_ROWS_OF_PART)
    if count < MIN_PARTS:
        raise ValueError(f"it slows down in {end - begin} rows; {MIN_PARTS * MIN_ROWS_OF_PART} are the least: record faster")
    parts = [np.arange(begin, end)[part] for part in np.array_split(np.arange(end - begin), count)]
    slopes = [float(np.polyfit(time[part] - time[part[0]], speed[part], 1)[0]) for part in parts]
    return np.array([speed[part].mean() for part in parts]), np.array(slopes)
