"""A log in several files is one log, where its time shows it."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from strainwave.identification.identify import identify
from strainwave.identification.reading.recognise import recognise
from strainwave.identification.reading.several_files import joined

from tests.evidence import arms


@pytest.fixture(scope="module")
def rows() -> np.ndarray:
    seen = arms.Recorder(rate=100.0)(arms.run((arms.Joint(),) * 3, arms.fourier(10.0, (1,), seed=1)))
    return np.column_stack([seen["time"], seen["q"][1], seen["dq"][1], seen["motor_torque"][1]])


def write(path: Path, rows: np.ndarray) -> Path:
    np.savetxt(path, rows, "%.9g" if rows[0, 0] < 1e6 else "%.6f", ",", header="time,q,dq,tau", comments="")
    return path


@pytest.mark.slow("identification")
@pytest.mark.parametrize(("epoch", "order"), [(0.0, (1, 0, 2)), (1.7e9, (2, 1, 0))])
def test_parts_in_any_order_give_the_whole(tmp_path: Path, rows: np.ndarray, epoch: float, order: tuple[int, ...]) -> None:
    rows = rows + np.array([epoch, 0.0, 0.0, 0.0])
    parts = [write(tmp_path / f"run_{place}.csv", part) for place, part in enumerate(np.array_split(rows, 3))]
    whole = identify("hfuc-25-100", [write(tmp_path / "whole.csv", rows)])
    found = identify("hfuc-25-100", [parts[place] for place in order])
    (finding,) = found.files
    assert finding.name == "run_0.csv"
    assert "run_1.csv, run_2.csv go on where it ends, and are joined to it" in finding.remarks
    for one, other in zip(found.parameters, whole.parameters, strict=True):
        assert one.estimate.path == other.estimate.path
        assert one.estimate.value == pytest.approx(other.estimate.value, rel=1e-4)
        assert one.estimate.sigma == pytest.approx(other.estimate.sigma, rel=0.01)


def test_what_does_not_go_on_stays_apart(tmp_path: Path, rows: np.ndarray) -> None:
    first, second = np.array_split(rows, 2)
    begun_anew = second - np.array([second[0, 0], 0.0, 0.0, 0.0])
    later = second + np.array([1.0, 0.0, 0.0, 0.0])
    elsewhere = second + np.array([0.0, 0.5, 0.0, 0.0])
    one = recognise(write(tmp_path / "one.csv", first))
    for other in (begun_anew, later, elsewhere):
        read = [one, recognise(write(tmp_path / "other.csv", other))]
        assert joined(read) == read
