"""A record of two encoders: orders of the kinematic error."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from strainwave.identification.reading.recognise import Recognised
from strainwave.identification.results.curves import curves_of_orders
from strainwave.identification.results.file_result import FileEstimate, FileResult
from strainwave.identification.results.gear_so_far import GearSoFar
from strainwave.orders.two_encoders import TransmissionError, transmission_error


def encoders(file: Recognised, known: GearSoFar) -> tuple[FileResult, GearSoFar]:
    """Return the orders of a record of two encoders, and the gear with them."""
    found = transmission_error(file.recording)
    told = tuple(orders_of(found))
    remarks, curves = (*file.remarks, *found.remarks), curves_of_orders(found)
    finding = FileResult(file.path.name, file, "orders of the input", told, np.nan, remarks, curves=curves)
    return finding, with_error(known, found, file.path.name)


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
    """The orders of the kinematic error that stand out."""
    for each in found.orders:
        if each.shaft == "input" and each.significant:
            yield FileEstimate(
                f"gear.kinematic_error.amplitude of order {each.order:g}",
                "rad",
                each.amplitude,
                each.amplitude_sigma,
                "fourier",
            )
