"""A record of two encoders: orders of the kinematic error."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from strainwave.identification.curves import curves_of_orders
from strainwave.identification.findings import Finding, Told
from strainwave.identification.known import Known
from strainwave.identification.orders.two_encoders import TransmissionError, transmission_error
from strainwave.identification.reading.recognise import Recognised


def encoders(file: Recognised, known: Known) -> tuple[Finding, Known]:
    """Return the orders of a record of two encoders, and the gear with them."""
    found = transmission_error(file.recording)
    told = tuple(orders_of(found))
    remarks, curves = (*file.remarks, *found.remarks), curves_of_orders(found)
    finding = Finding(file.path.name, file, "orders of the input", told, np.nan, remarks, curves=curves)
    return finding, with_error(known, found, file.path.name)


def with_error(known: Known, found: TransmissionError, name: str) -> Known:
    """Return the set with a kinematic error, unless an earlier file determined it."""
    law = found.law
    if "kinematic_error" in known.told or not law.order:
        return known
    by_order = {each.order: each for each in found.orders if each.significant and each.shaft != "output"}
    sigmas = {f"gear.kinematic_error.amplitude[{i}]": by_order[order].amplitude_sigma for i, order in enumerate(law.order)}
    sigmas |= {f"gear.kinematic_error.phase[{i}]": by_order[order].phase_sigma for i, order in enumerate(law.order)}
    return known.with_parts({"kinematic_error": law}, sigmas, name)


def orders_of(found: TransmissionError) -> Iterator[Told]:
    """The orders of the kinematic error that stand out."""
    for each in found.orders:
        if each.shaft == "input" and each.significant:
            yield Told(
                f"gear.kinematic_error.amplitude of order {each.order:g}",
                "rad",
                each.amplitude,
                each.amplitude_sigma,
                "fourier",
            )
