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
from strainwave.report.provenance import Provenance
from strainwave.report.results_json import results_json
from strainwave.report.rig import rig_report
from strainwave.report.rig_files import angle_files, loop_files, results
from strainwave.rig.reading.evaluation import Evaluation
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


@files_of.register
def _(result: Evaluation) -> Files:
    return evaluation_files(result, Provenance())


def evaluation_files(found: Evaluation, provenance: Provenance) -> dict[str, str | bytes]:
    """Return loops and angles of a test of torsion as tables, the numbers as JSON, and the page, by file name."""
    files: dict[str, str | bytes] = {**loop_files(found.measured), **angle_files(found.angles)}
    files["results.json"] = results_json(results(found, provenance.date))
    files["report.html"] = rig_report(found, provenance, list(files))
    return files
