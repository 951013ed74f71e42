"""Commanded against measured angles of one axis: lost motion and positioning error."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from strainwave.identification.kinds.kind import Kind
from strainwave.identification.reading.mapping import FileMapping
from strainwave.identification.reading.names import Side
from strainwave.identification.reading.recognise import Recognised
from strainwave.identification.reading.roles import Column, ColumnRoles, commanded, measured, names_of, pair
from strainwave.identification.results.file_result import FileEstimate, FileResult
from strainwave.identification.results.gear_so_far import GearSoFar
from strainwave.orders.positioning import Positioning, positioning
from strainwave.questions import QuestionError

MIN_INPUT_ORDER = 0.5  # of the input's turn: slower errors are named by the axis alone
OTHER_QUANTITIES = ("torque", "current", "voltage", "speed", "vibration")


class PositioningSteps(Kind):
    """Angles that were commanded, and those that a dial, a guide or an encoder of the axis shows."""

    needs = "a commanded and a measured angle, or an angle and its error"

    def recognises(self, columns: Sequence[Column], mapping: FileMapping) -> bool:
        """True for a commanded and a measured angle, or an angle with its error, without what drove it."""
        angles, others = measured(columns, "angle"), measured(columns, *OTHER_QUANTITIES)  # type: ignore[arg-type]
        pairs = len(commanded(columns, "angle")) + len(measured(columns, "twist"))
        return len(angles) <= 1 and pairs + len(angles) == 2 and not others and pairs > 0

    def roles(self, columns: Sequence[Column], mapping: FileMapping) -> ColumnRoles:
        wanted, error = commanded(columns, "angle"), measured(columns, "twist")
        reached = measured(columns, "angle")
        if len(wanted) == 1 and len(reached) == 1:
            by_channel = {"command": wanted[0], "output_angle": reached[0]}
        elif len(error) == 1 and len([*wanted, *reached]) == 1:
            by_channel = {"command": [*wanted, *reached][0], "twist": error[0]}
        else:
            raise QuestionError(f"{self.title} needs {self.needs}; it has {names_of(columns)}")
        side = mapping.side or by_channel["command"].channel.side or "output"
        return ColumnRoles(self.name, by_channel, side, (f"its columns are {pair(*by_channel.values())}: {self.title}",))

    def fit(self, file: Recognised, known: GearSoFar) -> tuple[FileResult, GearSoFar]:
        """Return lost motion and the errors of ISO 230-2; the gear keeps its numbers."""
        errors, ratio = positioning_of(file), abs(known.gear_set.gear.kinematics.ratio)
        estimates = [FileEstimate("lost_motion", "rad", errors.lost_motion, errors.lost_motion_sigma, "")]
        estimates += [
            FileEstimate(f"positioning_error of order {order:g}", "rad", size, sigma, "")
            for order, size, sigma in errors.orders
        ]
        stated = tuple(each for each in estimates if np.isfinite(each.value))
        remarks = (*file.remarks, *positioning_words(errors, file.side, ratio), *errors.remarks)
        how = "steps to and fro" if errors.targets else "error over the angle, from one side"
        return FileResult(file.path.name, file, how, stated, remarks), known


def positioning_of(file: Recognised) -> Positioning:
    """Return the positioning of a file; raises as `positioning`."""
    wanted = file.recording["command"]
    reached = file.recording["output_angle"] if "output_angle" in file.recording else wanted + file.recording["twist"]
    return positioning(wanted, reached)


def positioning_words(found: Positioning, side: Side | None, ratio: float | None) -> Iterator[str]:
    """Yield the errors of ISO 230-2 and the orders over the angle of a side in words; of the output those of the input too."""
    named = {
        "lost motion, mean of all targets": found.lost_motion,
        "largest reversal value B": found.reversal,
        "bidirectional systematic deviation E": found.systematic,
        "mean bidirectional deviation M": found.mean_deviation,
        "unidirectional repeatability, largest 4 s": found.one_way_repeatability,
        "bidirectional repeatability R": found.repeatability,
        "bidirectional accuracy A": found.accuracy,
    }
    for name, value in named.items():
        if np.isfinite(value):
            scatter = f" ± {3600.0 * np.degrees(found.lost_motion_sigma):.2g} arcsec" if value is found.lost_motion else ""
            yield f"{name}: {_in_degrees(value)}{scatter}"
    for order, size, sigma in found.orders:
        is_fast = side == "output" and ratio and order >= MIN_INPUT_ORDER * ratio
        of_input = f", {order / ratio:g} of the input" if is_fast and ratio else ""
        size_in_words = f"{_in_degrees(size)} ± {3600.0 * np.degrees(sigma):.2g} arcsec"
        yield f"order {order:g} per turn of the {'input' if side == 'input' else 'axis'}{of_input}: {size_in_words}"
    if found.targets:
        yield (
            f"{found.targets} targets were approached from both sides; {found.within} rows lie within the lost motion behind a "
            "reversal, and are left out"
        )


def _in_degrees(angle: float) -> str:
    degrees = float(np.degrees(angle))
    return f"{degrees:.4g} deg ({3600.0 * degrees:.4g} arcsec)"
