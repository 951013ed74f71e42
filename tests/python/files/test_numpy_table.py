"""Files of NumPy that claim more than they contain, or contain objects, end in one line."""

from __future__ import annotations

import io
import re
import struct
import zipfile
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from strainwave.files.numpy_table import open_numpy


def array(shape: str, kind: str = "'<f8'", content: bytes = b"") -> bytes:
    text = f"{{'descr': {kind}, 'fortran_order': False, 'shape': {shape}, }}\n".encode()
    return b"\x93NUMPY\x01\x00" + struct.pack("<H", len(text)) + text + content


def refused(path: Path, reason: str) -> None:
    with pytest.raises(ValueError, match=f"^{re.escape(str(path))}[^\n]*{reason}[^\n]*$"):
        open_numpy(path)


@pytest.mark.parametrize(
    ("content", "reason"),
    [
        (array("(10000000000,)"), "its array claims 80000000000 bytes, but has"),
        (array("(-1,)"), "damaged"),
        (array("(2,)", "[('a', '<f8', (1000000000,))]"), "damaged"),
        (array("(10000000000,)", "'|S0'"), "its array expands the file to"),
        (array("(" * 3000 + ")" * 3000), "cannot be read"),
        (array("(9,)", content=bytes(8)), "ends 64 bytes before its last number"),
        (array("(1,)", "'|O'", b"cos\nsystem\n(S'true'\ntR."), "an array of Python objects"),
    ],
)
def test_claims(tmp_path: Path, content: bytes, reason: str) -> None:
    (tmp_path / "a.npy").write_bytes(content)
    refused(tmp_path / "a.npy", reason)


def archive(path: Path, members: dict[str, bytes], packing: int = zipfile.ZIP_DEFLATED) -> None:
    with zipfile.ZipFile(path, "w", packing) as made:
        for name, content in members.items():
            made.writestr(name, content)


def test_objects_are_left_out_by_name_and_the_rest_is_read(tmp_path: Path) -> None:
    series = array("(3,)", content=np.arange(3.0).tobytes())
    archive(tmp_path / "a.npz", {"t.npy": series, "evil.npy": array("(1,)", "'|O'", b"."), "note.txt": b"x"})
    found = open_numpy(tmp_path / "a.npz")
    assert [label.name for label in found.labels] == ["t"]
    assert [each.partition(":")[0] for each in found.left_out] == ["evil is left out"]


def test_arrays_that_unpack_to_gigabytes(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("strainwave.files.budget.MIN_ALLOWED_BYTES", 2**20)
    content = array("(100000,)", content=bytes(800_000))
    archive(tmp_path / "a.npz", {"a.npy": content, "b.npy": content})
    refused(tmp_path / "a.npz", "b expands the file to 2 MB; a file of this size may expand to 1 MB")


def test_a_member_whose_size_is_a_claim(tmp_path: Path) -> None:
    buffer: Any = io.BytesIO()
    archive(buffer, {"a.npy": array("(10000000,)", content=bytes(80))})
    whole = bytearray(buffer.getvalue())
    struct.pack_into("<I", whole, whole.rindex(b"PK\x01\x02") + 24, 10**8)
    (tmp_path / "a.npz").write_bytes(whole)
    refused(tmp_path / "a.npz", "")


def test_members_packed_in_other_ways_are_refused(tmp_path: Path) -> None:
    archive(tmp_path / "a.npz", {"a.npy": array("(1,)", content=bytes(8))}, zipfile.ZIP_BZIP2)
    refused(tmp_path / "a.npz", "a.npy is packed in another way than NumPy does")


@pytest.mark.parametrize("order", ["C", "F"])
@pytest.mark.parametrize("kind", ["<f8", ">f8", "<i2", "|b1"])
def test_order_and_kind_of_numbers(tmp_path: Path, order: Any, kind: str) -> None:
    values = np.array(np.arange(12).reshape(6, 2) % 2, kind, order=order)
    np.save(tmp_path / "a.npy", values)
    assert [each.tolist() for each in open_numpy(tmp_path / "a.npy").columns] == values.T.astype(float).tolist()
