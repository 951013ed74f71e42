"""A kind of measurement is one class and one line: what a stranger adds is recognised, fitted, drawn, ranked and reported."""

from __future__ import annotations

import re
import sys
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest
import strainwave as sw
from strainwave.identification import kinds
from strainwave.identification.identify import identify
from strainwave.identification.kinds import Listed
from strainwave.identification.kinds.kind import rank, table_of
from strainwave.identification.reading.recognise import recognise
from strainwave.report.identify import identify_report

PAGE = Path(__file__).resolve().parents[4] / "docs" / "contributing" / "add-a-kind-of-file.md"


@pytest.fixture
def added(monkeypatch: pytest.MonkeyPatch) -> None:
    """The line of the list, and the module of the class, which is that of the page for contributors."""
    module = ModuleType("strainwave.identification.kinds.weighing")
    (code,) = re.findall(r"^```python\n(.*?)^```$", PAGE.read_text(encoding="utf-8"), re.MULTILINE | re.DOTALL)
    exec(compile(code, str(PAGE), "exec"), vars(module))
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
    assert table_of(rank(found.start_set, recognise(file(tmp_path))))[1].startswith("a sine")
    assert identify("hfuc-20-80", {"weighing": file(tmp_path)}).parameters == found.parameters
