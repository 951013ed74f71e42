"""Later recordings compared with what a saved gear or drive predicts."""

from __future__ import annotations

import shlex
from collections.abc import Mapping, Sequence
from pathlib import Path

from strainwave import Drive
from strainwave._core import Gear
from strainwave.files.gear_set import GearSet
from strainwave.identification.identify import Mapped, check_arguments, not_used, raise_question, read_measurements
from strainwave.identification.kinds import kind_named
from strainwave.identification.kinds.kind import NOT_PREDICTED
from strainwave.identification.reading.recognise import Recognised
from strainwave.identification.reading.source import Measurement, MeasurementFiles, measurement_files
from strainwave.identification.results.file_result import FileResult
from strainwave.identification.results.gear_so_far import GearSoFar, with_ratio
from strainwave.identification.results.prediction import Prediction
from strainwave.progress import Progress, in_turn


def predict(
    gear: GearSet | Gear | Drive | str | Path,
    files: str | Path | Sequence[str | Path] | Mapping[str, Measurement] | MeasurementFiles,
    *,
    mapping: Mapped = None,
    progress: Progress = None,
) -> tuple[Prediction, ...]:
    """Compare later recordings of a joint with what its saved gear or drive predicts.

    Logs need a saved load, as the gear file of an identification from a log has it; tables of friction need the gear alone.

    Args:
        gear: the saved one: a gear set, the path of a gear file, a gear or a drive
        files: recordings in any format and order, as of `identify`
        mapping: what a person states of the files, as of `identify`
        progress: as of `sw.simulate`

    Returns:
        of each file the error, what the gear allows, and what changed; or why it cannot be predicted

    Raises:
        TypeError: as `identify`
        ValueError: no file, or none that can be predicted

    >>> import numpy as np
    >>> import strainwave as sw
    >>> gear = sw.Gear(friction_input=sw.friction.Coulomb(coulomb=0.05, viscous=3e-4))
    >>> speed = np.array([2.0, 5.0, 10.0, 20.0, 50.0, 100.0, 200.0])
    >>> torque = 1.2 * gear.friction_input.steady(speed) + 1e-4 * np.array([1, -1, 0, 1, -1, 1, 0])
    >>> table = sw.Recording({"speed": speed, "torque": torque}, {"speed": "rad/s", "torque": "N.m"})
    >>> (found,) = sw.predict(gear, {"friction": table})
    >>> [(each.name, round(each.value, 2)) for each in found.changed]
    [('dry friction', 1.2), ('viscous friction', 1.2)]
    """
    check_arguments(gear, files, mapping)
    gear_set, given = _gear_set(gear), str(gear) if isinstance(gear, str | Path) else "gear.toml"
    read, gear_set = read_measurements(measurement_files(files), mapping, gear_set)
    predictions, results = list[Prediction](), list[FileResult]()
    with in_turn(progress, len(read)) as turn:
        for file in read.values():
            turn(file.path.name if isinstance(file, Recognised) else file.name)
            result = _predicted(file, gear_set, given) if isinstance(file, Recognised) else file
            if isinstance(result, FileResult):
                results.append(result)
                kind = "" if result.recognised is None else result.recognised.kind
                result = Prediction(result.name, gear_set.name, kind, refused=result.refused)
            predictions.append(result)
    if all(each.refused for each in predictions):
        raise_question(results)
        raise ValueError(f"no file can be predicted: {'; '.join(f'{each.name}: {each.refused}' for each in predictions)}")
    return tuple(predictions)


def _gear_set(gear: GearSet | Gear | Drive | str | Path) -> GearSet:
    if isinstance(gear, GearSet):
        return gear
    return GearSet.read(gear) if isinstance(gear, str | Path) else GearSet.of(gear, name="the gear", source="given")


def _predicted(file: Recognised, gear_set: GearSet, given: str) -> Prediction | FileResult:
    """Return the comparison of a file, or why there is none; `given` names the gear in the command to use instead."""
    gear_set = with_ratio(GearSoFar(gear_set), file).gear_set
    try:
        return kind_named(file.kind).predict(file.at_ratio(gear_set.gear.kinematics.ratio), gear_set)
    except (ValueError, FloatingPointError) as error:
        if NOT_PREDICTED in str(error):
            words = ["strainwave", "identify", given, *map(str, file.parts or (file.path,)), *file.mapping.options]
            error = ValueError(f"{error}; its estimates are compared by: {shlex.join(words)}")
        return not_used(file.path, error, file)
