"""Files of the report of a result, by the type of the result."""

from __future__ import annotations

from collections.abc import Mapping
from functools import singledispatch

from strainwave.diagnose.diagnosis import Diagnosis
from strainwave.identification.identify import Identified
from strainwave.identification.joints import Joints
from strainwave.orders.measured import OrdersFound
from strainwave.orders.torque_ripple import Ripple
from strainwave.orders.two_encoders import TransmissionError
from strainwave.report.compensate import compensate_files
from strainwave.report.diagnose import diagnose_files
from strainwave.report.identify_files import identify_files
from strainwave.report.joints import joints_files
from strainwave.report.orders import orders_files
from strainwave.tuning.compensate import Compensated

Files = Mapping[str, str | bytes]


@singledispatch
def files_of(result: object) -> Files:
    """Return the files of the report of a result by their names, `report.html` the last.

    Raises:
        TypeError: there is no report of such a result
    """
    raise TypeError(f"there is no report of a {type(result).__name__}")


@files_of.register
def _(result: Identified) -> Files:
    return identify_files(result)


@files_of.register
def _(result: Joints) -> Files:
    return joints_files(result)


@files_of.register
def _(result: TransmissionError) -> Files:
    return orders_files([OrdersFound("transmission error", result, None, result.remarks)])


@files_of.register
def _(result: Ripple) -> Files:
    return orders_files([OrdersFound(f"ripple of {result.column}", None, result, result.remarks)])


@files_of.register
def _(result: Diagnosis) -> Files:
    return diagnose_files([result])


@files_of.register
def _(result: Compensated) -> Files:
    return compensate_files(result)
