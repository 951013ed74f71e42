"""Ranges of speed, torque, angle and temperature over which a file determines a gear."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from strainwave.files.identified_tables import RANGES
from strainwave.files.recording import Recording
from strainwave.identification.candidates.motion_candidate import nuisances_of
from strainwave.identification.experiments.drive_log import DrivenLog
from strainwave.identification.experiments.motion_log import MotionLog, transmitted_torque
from strainwave.identification.reading.recognise import Recognised
from strainwave.identification.results.combined_parameter import drive_of
from strainwave.identification.results.file_result import GRAVITY_PATH, LOAD_INERTIA, FileResult

Array = NDArray[np.float64]


def measured_range(result: FileResult, ratio: float) -> dict[str, tuple[float, float]]:
    """Return the smallest and largest value of each of `RANGES` in a file, in its unit; without those that it does not contain.

    The torque of a log is that which its model transmits along the motion, between both encoders if there are two; it is not
    known if the log determines neither gravity nor inertia of the load.

    Args:
        result: of the file
        ratio: of the gear: speed of the input over that of the output
    """
    if result.recognised is None:
        return {}
    found = dict(_of_recording(result.recognised, ratio))
    drive = drive_of(result)
    if result.fit is not None and drive is not None and isinstance(log := result.fit.parts[0].experiment, MotionLog):
        known = log.motion.known
        found |= {"input_speed": log.motion.speed[known], "output_angle": log.motion.output_angle(ratio)[known]}
        if not result.is_in_current and _has_load(result):
            found["output_torque"] = transmitted_torque(log, drive)[known]
    if result.between is not None and not result.is_in_current:
        between = result.between.parts[0]
        assert isinstance(between.experiment, DrivenLog)
        found["output_torque"] = between.experiment.gear_torque(between.model, nuisances_of(result.between))
    return {name: (float(values.min()), float(values.max())) for name in RANGES if len(values := found.get(name, np.empty(0)))}


def _has_load(result: FileResult) -> bool:
    """True if a log determines gravity or inertia of its load."""
    return any(each.path in (LOAD_INERTIA, GRAVITY_PATH) and not each.why for each in result.estimates)


def _of_recording(file: Recognised, ratio: float) -> Iterator[tuple[str, Array]]:
    """Yield the series that the columns of a file are, by their names."""
    recording, of_output = file.recording, abs(ratio) if file.side == "output" else 1.0
    factors = {"input_speed": 1.0, "output_speed": ratio, "speed": of_output}
    yield from (
        ("input_speed", factor * _values(recording, name, "rad/s")) for name, factor in factors.items() if name in recording
    )
    if file.kind == "torsion" and "torque" in recording:
        yield "output_torque", _values(recording, "torque", "N.m") * (abs(ratio) if file.side == "input" else 1.0)
    for name in ("output_angle", "temperature"):
        if name in recording:
            yield name, _values(recording, name, RANGES[name])


def _values(recording: Recording, name: str, unit: str) -> Array:
    values = recording.values(name, unit)
    return values[np.isfinite(values)]
