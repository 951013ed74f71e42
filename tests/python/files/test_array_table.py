"""Series in files of NumPy, JSON and HDF5: what programs write is read back, and what no file should hold is refused."""

from __future__ import annotations

import json
import re
from pathlib import Path

import numpy as np
import pytest
from strainwave.files.array_table import ArrayTable
from strainwave.files.hdf5_table import open_hdf5
from strainwave.files.json_table import open_json
from strainwave.files.numpy_table import open_numpy
from strainwave.files.text_table import open_csv

TIME = np.arange(6) * 0.01
ANGLES = np.random.default_rng(1).normal(size=(6, 2))


def columns(table: ArrayTable) -> dict[str, list[float]]:
    return {label.name: values.tolist() for label, values in zip(table.labels, table.columns, strict=True)}


EXPECTED = {"t": TIME.tolist(), "q_1": ANGLES[:, 0].tolist(), "q_2": ANGLES[:, 1].tolist()}


def test_arrays_by_their_names(tmp_path: Path) -> None:
    np.savez_compressed(tmp_path / "a.npz", t=TIME, q=ANGLES.T, fs=100.0, note="arm", other=np.array([{}], object))
    found = open_numpy(tmp_path / "a.npz")
    assert columns(found) == EXPECTED
    assert found.singles == {"fs": 100.0}


def test_one_array_has_numbered_columns_and_a_structured_one_its_names(tmp_path: Path) -> None:
    np.save(tmp_path / "a.npy", ANGLES)
    assert columns(open_numpy(tmp_path / "a.npy")) == {"column_1": EXPECTED["q_1"], "column_2": EXPECTED["q_2"]}
    named = np.zeros(6, [("t", "f8"), ("q", "f8", 2)])
    named["t"], named["q"] = TIME, ANGLES
    np.save(tmp_path / "b.npy", named)
    assert columns(open_numpy(tmp_path / "b.npy")) == EXPECTED


def test_objects_are_not_loaded(tmp_path: Path) -> None:
    np.save(tmp_path / "a.npy", np.array([{"t": 1.0}], object), allow_pickle=True)
    with pytest.raises(ValueError, match=r"a\.npy holds no series.*; its array is left out: an array of Python objects"):
        open_numpy(tmp_path / "a.npy")


def test_lists_by_their_names(tmp_path: Path) -> None:
    (tmp_path / "a.json").write_text(json.dumps({"robot": "arm", "t": TIME.tolist(), "q": ANGLES.tolist(), "rate": 100}))
    found = open_json(tmp_path / "a.json")
    assert columns(found) == EXPECTED
    assert found.singles == {"rate": 100.0}


@pytest.mark.parametrize("lines", [True, False])
def test_a_row_for_each_sample(tmp_path: Path, lines: bool) -> None:
    rows = [{"t": t, "mode": "run", "q": q.tolist()} for t, q in zip(TIME, ANGLES, strict=True)]
    text = "\n".join(map(json.dumps, rows)) + '\n{"t": 0.06, "q": [0.' if lines else json.dumps({"samples": rows})
    (tmp_path / "a.json").write_text(text)
    assert columns(open_json(tmp_path / "a.json")) == EXPECTED


def test_a_broken_line_is_named(tmp_path: Path) -> None:
    (tmp_path / "a.jsonl").write_text('{"t": 0.0}\n{"t": \n{"t": 0.2}\n')
    with pytest.raises(ValueError, match=r"a\.jsonl line 2 is no JSON"):
        open_json(tmp_path / "a.jsonl")
    (tmp_path / "a.json").write_text("[1, 2")
    with pytest.raises(ValueError, match=r"a\.json line 1 is no JSON"):
        open_json(tmp_path / "a.json")


@pytest.mark.parametrize("text", ["3", "{}", "[]", '"text"', "null", '{"a": [1, [2]]}', "[[[1]]]", "NaN"])
def test_what_holds_no_series_is_refused(tmp_path: Path, text: str) -> None:
    (tmp_path / "a.json").write_text(text)
    with pytest.raises(ValueError, match=re.escape("holds no series of numbers")):
        open_json(tmp_path / "a.json")


def test_groups_of_hdf5(tmp_path: Path) -> None:
    h5py = pytest.importorskip("h5py")
    with h5py.File(tmp_path / "a.h5", "w") as file:
        file["arm/t"], file["arm/q"] = TIME, ANGLES
    assert columns(open_hdf5(tmp_path / "a.h5")) == {f"arm.{name}": values for name, values in EXPECTED.items()}


def test_comments_of_matlab_and_the_header_of_ros(tmp_path: Path) -> None:
    (tmp_path / "a.log").write_text("% arm 7\n% u in Nm\nt q1\n0.0 0.1\n0.1 0.2\n")
    assert [label.name for label in open_csv(tmp_path / "a.log").labels] == ["t", "q1"]
    (tmp_path / "b.csv").write_text("%time,field.name0,field.position0\n1,elbow,0.1\n2,elbow,0.2\n")
    found = open_csv(tmp_path / "b.csv")
    assert [label.name for label in found.labels] == ["time", "field.name0", "field.position0"]
    assert found.contents == ["numbers", "other", "numbers"]
