"""HDF5 files: data in other files are refused by name, links and references end, and claims are bounded."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from strainwave.files.hdf5_table import open_hdf5

h5py = pytest.importorskip("h5py")

TIME = np.arange(20) * 0.01


@pytest.fixture
def path(tmp_path: Path) -> Path:
    """An HDF5 file with a series."""
    with h5py.File(tmp_path / "log.h5", "w") as file:
        file["t"] = TIME
    return tmp_path / "log.h5"


def names(path: Path) -> list[str]:
    return [label.name for label in open_hdf5(path).labels]


def refused(path: Path, reason: str) -> None:
    with pytest.raises(ValueError, match=f"^{re.escape(str(path))}[^\n]*{re.escape(reason)}[^\n]*$"):
        open_hdf5(path)


def test_values_in_another_file(path: Path) -> None:
    (path.parent / "secret").write_bytes(bytes(160))
    with h5py.File(path, "a") as file:
        file.create_dataset("q", (20,), "u1", external=[(path.parent / "secret", 0, 20)])
    refused(path, "/q has its values in another file")


@pytest.mark.parametrize("through", ["q", "soft", "deep"])
def test_links_into_another_file(path: Path, through: str) -> None:
    with h5py.File(path.parent / "other.h5", "w") as file:
        file["data/q"] = TIME
    with h5py.File(path, "a") as file:
        file["q" if through == "q" else "#out"] = h5py.ExternalLink("other.h5", "/data/q" if through == "q" else "/data")
        if through == "soft":
            file["s"] = h5py.SoftLink("/#out/q")
        if through == "deep":
            file["g/s"] = h5py.SoftLink("/h")
            file["h"] = h5py.SoftLink("#out")
    refused(path, 'is a link into another file, "other.h5"')


def test_virtual_datasets(path: Path) -> None:
    with h5py.File(path.parent / "other.h5", "w") as file:
        file["q"] = TIME
    with h5py.File(path, "a") as file:
        layout = h5py.VirtualLayout((20,), "f8")
        layout[:] = h5py.VirtualSource("other.h5", "q", (20,))
        file.create_virtual_dataset("q", layout)
    refused(path, "/q")


def test_soft_links_are_followed_and_what_leads_nowhere_is_named(path: Path) -> None:
    with h5py.File(path, "a") as file:
        file["s"], file["gone"], file["self"] = h5py.SoftLink("t"), h5py.SoftLink("/nowhere/q"), h5py.SoftLink("/self")
        file["through"] = h5py.SoftLink("/t/q")
    assert names(path) == ["s", "t"]
    left_out = [f"{name} is left out: a link that leads nowhere" for name in ("gone", "self", "through")]
    assert [each.partition(";")[0] for each in open_hdf5(path).left_out] == left_out


def test_groups_and_references_that_contain_themselves(path: Path) -> None:
    with h5py.File(path, "a") as file:
        file["g/t"] = TIME
        file["g/again"] = file["g"]
        file["g/up"] = file["/"]
        cells = file.create_dataset("r", (100,), h5py.ref_dtype)
        cells[:] = np.array([cells.ref] * 100, h5py.ref_dtype)
    assert names(path) == ["g.t", "t"]
    assert {each.partition(" ")[0] for each in open_hdf5(path).left_out} == {"g.again", "g.up", "r"}


@pytest.mark.slow("files")
@pytest.mark.parametrize("is_alone", [False, True])
def test_references_that_multiply(path: Path, is_alone: bool) -> None:
    with h5py.File(path, "a") as file:
        file["#t"] = TIME
        if is_alone:
            del file["t"]
        target = file["#t"]
        for level in range(6):
            cells = file.create_dataset(f"#r{level}", (100,), h5py.ref_dtype)
            cells[:] = np.array([target.ref] * 100, h5py.ref_dtype)
            target = cells
        file["r"] = target
    refused(path, "has more than 100000 variables, cells or references")


@pytest.mark.parametrize(
    ("made", "reason"),
    [
        ({"shape": (10**10,), "chunks": (1000,), "dtype": "f8"}, "dataset /q expands the file to"),
        ({"shape": (10,), "maxshape": (None,), "chunks": (2**28,), "dtype": "f8"}, "a chunk of dataset /q expands the file to"),
        ({"shape": (10**11,), "chunks": (1000,), "dtype": h5py.ref_dtype}, "dataset /q expands the file to"),
    ],
)
def test_claims(path: Path, made: dict[str, Any], reason: str) -> None:
    with h5py.File(path, "a") as file:
        file.create_dataset("q", **made)
    refused(path, reason)


def test_what_is_no_series_is_not_read(path: Path) -> None:
    with h5py.File(path, "a") as file:
        file.create_dataset("film", (10**4, 10**4, 10**4), "f8", chunks=(1, 100, 100))
        file.create_dataset("picture", (10**6, 10**6), "f8", chunks=(100, 100))
        file.create_dataset("rows", (10**9,), [("a", "f8", (1000,))], chunks=(10,))
        file.create_dataset("texts", (10**9,), h5py.string_dtype(), chunks=(10,))
        file["none"] = h5py.Empty("f8")
        file["kind"] = np.dtype("f8")
    assert names(path) == ["t"]


def test_a_chunk_that_unpacks_to_more_than_it_claims(path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    import zlib

    monkeypatch.setattr("strainwave.files.budget.MIN_ALLOWED_BYTES", 2**20)
    with h5py.File(path, "a") as file:
        made = file.create_dataset("q", (20,), "f8", chunks=(20,), compression="gzip")
        made.id.write_direct_chunk((0,), zlib.compress(bytes(2**21)))
    refused(path, "a chunk of dataset /q unpacks to more than the 160 bytes that it claims")
    with h5py.File(path, "a") as file:
        del file["q"]
        file.create_dataset("q", data=np.random.default_rng(1).normal(size=20), chunks=(20,), compression="gzip", shuffle=True)
    assert names(path) == ["q", "t"]


def test_an_attribute_that_claims_much(path: Path) -> None:
    with h5py.File(path, "a") as file:
        file["t"].attrs["MATLAB_class"] = np.bytes_("x" * 60_000)
    assert names(path) == ["t"]


def test_a_text_of_matlab_whose_letters_are_no_whole_numbers(path: Path) -> None:
    with h5py.File(path, "a") as file:
        file["q"] = np.full(20, np.nan)
        file["q"].attrs["MATLAB_class"] = np.bytes_("char")
    assert names(path) == ["q", "t"]
