"""A kind of measurement is one class and one line: what a stranger adds is recognised, fitted, drawn, ranked and reported."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest
import strainwave as sw
from strainwave.identification import kinds
from strainwave.identification.identify import identify
from strainwave.identification.kinds import Listed
from strainwave.identification.kinds.kind import Kind, Ranked
from strainwave.identification.rank import rank, table_of
from strainwave.identification.reading.column import Column
from strainwave.identification.reading.mapping import FileMapping
from strainwave.identification.reading.recognise import Recognised, recognise
from strainwave.identification.reading.roles import ColumnRoles
from strainwave.identification.results.file_result import FileEstimate, FileResult, Picture
from strainwave.identification.results.gear_so_far import GearSoFar
from strainwave.report.identify import identify_report


class Weighing(Kind):
    """Angle and torque of a pendulum at rest: its gravity."""

    def recognises(self, columns: Sequence[Column], mapping: FileMapping) -> bool:
        return {"hold_angle", "hold_torque"} <= {column.name for column in columns}

    def roles(self, columns: Sequence[Column], mapping: FileMapping) -> ColumnRoles:
        found = {column.channel.quantity: column for column in columns}
        return ColumnRoles(self.name, dict(found), "output", ("a pendulum was held at several angles",))

    def fit(self, file: Recognised, known: GearSoFar) -> tuple[FileResult, GearSoFar]:
        angle, torque = file.recording["angle"], file.recording["torque"]
        gravity = float(np.sin(angle) @ torque / (np.sin(angle) @ np.sin(angle)))
        estimate = FileEstimate("load.gravity_torque", "N.m", gravity, 0.01, "")
        units = {"angle": "rad", "torque": "N.m", "modelled": "N.m"}
        curves = sw.Recording({"angle": angle, "torque": torque, "modelled": gravity * np.sin(angle)}, units)
        return FileResult(file.path.name, file, "a sine", (estimate,), pictures=(Picture(curves),)), known

    def rank(self, file: Recognised, known: GearSoFar) -> tuple[Ranked, ...]:
        return (Ranked("a sine", 1, 0.01, np.nan, "N.m", 1.0),)


@pytest.fixture
def added(monkeypatch: pytest.MonkeyPatch) -> None:
    """The line of the list, and the module of the class."""
    module = ModuleType("strainwave.identification.kinds.weighing")
    module.Weighing = Weighing  # type: ignore[attr-defined]
    monkeypatch.setitem(sys.modules, module.__name__, module)
    monkeypatch.setitem(kinds.KINDS, "weighing", Listed("a pendulum held at rest", "weighing.Weighing"))


def file(folder: Path) -> Path:
    angle = np.linspace(-1.5, 1.5, 7)
    columns = {"hold_angle": angle, "hold_torque": 25.0 * np.sin(angle)}
    path = folder / "held.csv"
    sw.Recording(columns, {"hold_angle": "rad", "hold_torque": "N.m"}).to_csv(path)
    return path


@pytest.mark.usefixtures("added")
def test_a_new_kind_needs_a_class_and_a_line(tmp_path: Path) -> None:
    found = identify("hfuc-20-80", [file(tmp_path)])
    (parameter,) = found.parameters
    assert parameter.estimate.value == pytest.approx(25.0)
    page = identify_report(found)
    for expected in ("a pendulum held at rest", "Gravity torque", "Measured against modelled, held.csv"):
        assert expected in page
    assert table_of(rank(found.start, recognise(file(tmp_path))))[1].startswith("a sine")
    assert identify("hfuc-20-80", {"weighing": file(tmp_path)}).parameters == found.parameters
