"""A record of two encoders: orders of the kinematic error."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from strainwave.identification.kinds.kind import Kind
from strainwave.identification.reading.column import Column
from strainwave.identification.reading.kinds import ColumnRoles, encoder_roles
from strainwave.identification.reading.mapping import FileMapping
from strainwave.identification.reading.recognise import Recognised
from strainwave.identification.results.curves import curves_of_orders
from strainwave.identification.results.file_result import FileEstimate, FileResult, Picture
from strainwave.identification.results.gear_so_far import GearSoFar
from strainwave.orders.two_encoders import TransmissionError, transmission_error


class TwoEncoders(Kind):
    """Angles of input and output, without torque or current."""

    time = "used"

    def roles(self, columns: Sequence[Column], mapping: FileMapping) -> ColumnRoles:
        return encoder_roles(columns, mapping)

    def fit(self, file: Recognised, known: GearSoFar) -> tuple[FileResult, GearSoFar]:
        """Fit the orders of the kinematic error."""
        given = file.constants.get("ratio")
        found = transmission_error(file.recording, ratio=given, ratio_option="--constant ratio=…")
        name = file.path.name
        remarks, pictures = (*file.remarks, *found.remarks), (Picture(curves_of_orders(found)),)
        result = FileResult(name, file, "orders of the input", tuple(orders_of(found)), remarks, pictures=pictures)
        return result, with_error(known, found, name)


def with_error(known: GearSoFar, found: TransmissionError, name: str) -> GearSoFar:
    """Return the set with a kinematic error, unless an earlier file determined it."""
    law = found.law
    if "kinematic_error" in known.determined or not law.order:
        return known
    by_order = {each.order: each for each in found.orders if each.significant and each.shaft != "output"}
    sigmas = {f"gear.kinematic_error.amplitude[{i}]": by_order[order].amplitude_sigma for i, order in enumerate(law.order)}
    sigmas |= {f"gear.kinematic_error.phase[{i}]": by_order[order].phase_sigma for i, order in enumerate(law.order)}
    return known.with_parts({"kinematic_error": law}, sigmas, name)


def orders_of(found: TransmissionError) -> Iterator[FileEstimate]:
    """Yield the orders of the kinematic error that stand out."""
    for each in found.orders:
        if each.shaft == "input" and each.significant:
            yield FileEstimate(
                f"gear.kinematic_error.amplitude of order {each.order:g}",
                "rad",
                each.amplitude,
                each.amplitude_sigma,
                "fourier",
            )
