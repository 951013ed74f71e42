"""A record of two encoders: orders of the kinematic error."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from strainwave.files.entries import Entry
from strainwave.identification.kinds.kind import Kind
from strainwave.identification.reading.column import Column
from strainwave.identification.reading.mapping import FileMapping
from strainwave.identification.reading.recognise import Recognised
from strainwave.identification.reading.roles import ColumnRoles, first, measured, names_of
from strainwave.identification.reading.sides import pair, sides_of_angles
from strainwave.identification.results.curves import curves_of_orders, picture_of_turn
from strainwave.identification.results.file_result import FileEstimate, FileResult, Picture
from strainwave.identification.results.gear_so_far import AMPLITUDE, GearSoFar
from strainwave.orders.two_encoders import WHY_AMPLITUDES_CHANGE, TransmissionError, transmission_error
from strainwave.questions import QuestionError


class TwoEncoders(Kind):
    """Angles of input and output, without torque or current."""

    needs = "two angles"
    time = "used"

    def recognises(self, columns: Sequence[Column], mapping: FileMapping) -> bool:
        """True for several angles without torque or current."""
        return len(measured(columns, "angle")) > 1 and not measured(columns, "torque", "current")

    def roles(self, columns: Sequence[Column], mapping: FileMapping) -> ColumnRoles:
        angles = measured(columns, "angle")
        if len(angles) != 2:
            raise QuestionError(f"a record of two encoders needs two angles; it has {names_of(columns)}")
        fast, slow, why_side = sides_of_angles(angles)
        why = f"its columns are {pair(*angles)}, and no torque or current: {self.title}"
        found = {**first(columns, "time"), "input_angle": fast, "output_angle": slow, **first(columns, "temperature")}
        return ColumnRoles(self.name, found, None, tuple(filter(None, (why, why_side))))

    def fit(self, file: Recognised, known: GearSoFar) -> tuple[FileResult, GearSoFar]:
        """Fit the orders of the kinematic error."""
        given = file.constants.get("ratio")
        found = transmission_error(file.recording, ratio=given, ratio_option="--constant ratio=NUMBER")
        name = file.path.name
        remarks, pictures = (*file.remarks, *found.remarks), (picture_of_turn(found), Picture(curves_of_orders(found)))
        result = FileResult(name, file, "orders of the input", tuple(orders_of(found)), remarks, pictures=pictures)
        return result, with_error(known, found, name)


def with_error(known: GearSoFar, found: TransmissionError, name: str) -> GearSoFar:
    """Return the set with a kinematic error, unless an earlier file determined it."""
    law = found.law
    if "kinematic_error" in known.determined or not law.order:
        return known
    by_order = {each.order: each for each in found.orders if each.significant and each.shaft != "output"}
    sigmas = {f"{AMPLITUDE}[{i}]": by_order[order].amplitude_sigma for i, order in enumerate(law.order)}
    sigmas |= {f"gear.kinematic_error.phase[{i}]": by_order[order].phase_sigma for i, order in enumerate(law.order)}
    if not found.vibrates:
        return known.with_parts({"kinematic_error": law}, sigmas, f"{name}, at {found.speeds}" if found.speeds else name)
    entries = {path: Entry(f"identified in combination: {_why(found)}", uncertainty=sigma) for path, sigma in sigmas.items()}
    return known.with_sums({"kinematic_error": law}, entries, name)


def orders_of(found: TransmissionError) -> Iterator[FileEstimate]:
    """Yield the orders of the kinematic error that stand out."""
    for each in found.orders:
        if each.shaft == "input" and each.significant:
            yield FileEstimate(
                f"{AMPLITUDE} of order {each.order:g}",
                "rad",
                each.amplitude,
                each.amplitude_sigma,
                "fourier",
                _why(found),
                in_combination=found.vibrates,
            )


def _why(found: TransmissionError) -> str:
    """Return why amplitudes are not those of the gear alone; empty if they are."""
    return f"amplitudes are those measured at {found.speeds}: {WHY_AMPLITUDES_CHANGE}" if found.vibrates else ""
