"""MAT files that claim more than they contain, nest without end or unpack to gigabytes end in one line."""

from __future__ import annotations

import re
import struct
import zlib
from contextlib import suppress
from pathlib import Path

import numpy as np
import pytest
from scipy.io import savemat
from strainwave.files.matlab_table import open_mat

HEAD = b"MATLAB 5.0 MAT-file, written by a test".ljust(124) + b"\x00\x01IM"
INTEGER, UNSIGNED, TEXT, REAL, MATRIX, PACKED = 5, 6, 1, 9, 14, 15
CELL, STRUCTURE, OBJECT, CHARACTERS, NUMBERS = 1, 2, 3, 4, 6


def element(kind: int, content: bytes, claim: int | None = None) -> bytes:
    return struct.pack("<2I", kind, len(content) if claim is None else claim) + content + bytes(-len(content) % 8)


def matrix(kind: int, shape: tuple[int, ...], *parts: bytes, name: bytes = b"") -> bytes:
    flags = element(UNSIGNED, struct.pack("<2I", kind, 0))
    return element(
        MATRIX, flags + element(INTEGER, struct.pack(f"<{len(shape)}i", *shape)) + element(TEXT, name) + b"".join(parts)
    )


def refused(path: Path, content: bytes, reason: str) -> None:
    path.write_bytes(content)
    with pytest.raises(ValueError, match=f"^{re.escape(str(path))}[^\n]*{reason}[^\n]*$"):
        open_mat(path)


SERIES = matrix(NUMBERS, (3, 1), element(REAL, struct.pack("<3d", 0.0, 0.5, 1.0)), name=b"t")


def test_elements_as_matlab_writes_them(tmp_path: Path) -> None:
    (tmp_path / "a.mat").write_bytes(HEAD + SERIES + matrix(CELL, (1, 1), SERIES, name=b"c"))
    found = open_mat(tmp_path / "a.mat")
    assert [label.name for label in found.labels] == ["t", "c"]
    assert [values.tolist() for values in found.columns] == [[0.0, 0.5, 1.0]] * 2


@pytest.mark.parametrize("is_packed", [False, True])
@pytest.mark.parametrize("kind", [CELL, STRUCTURE, OBJECT])
def test_arrays_in_arrays_without_end(tmp_path: Path, kind: int, is_packed: bool) -> None:
    """Built from within: each array is written around the one before."""
    inner = SERIES
    names = element(INTEGER, struct.pack("<i", 8)) + element(TEXT, b"a".ljust(8, b"\0"))
    for _ in range(1000):
        inner = matrix(
            kind, (1, 1), *([element(TEXT, b"kind")] if kind == OBJECT else []), *([names] if kind != CELL else []), inner
        )
    whole = element(PACKED, zlib.compress(inner)) if is_packed else inner
    refused(tmp_path / "a.mat", HEAD + whole, "nests structures more than 64 deep")


@pytest.mark.parametrize(
    ("content", "reason"),
    [
        (matrix(CELL, (10**9, 4)), "has an array of 0 parts where it claims 4000000000"),
        (matrix(CELL, (3, 1), SERIES), "has an array of 1 parts where it claims 3"),
        (matrix(CHARACTERS, (10**9, 4), element(4, b"")), "holds no series of numbers"),
        (matrix(NUMBERS, (10**9, 4), element(REAL, b"")), "has an array of 0 numbers where it claims 4000000000"),
        (matrix(NUMBERS, (-1, 4), element(REAL, b"")), "has an array of an unknown class or a negative size"),
        (matrix(NUMBERS, (1, 1), element(REAL, bytes(8), claim=2**31 - 1)), "an element claims 2147483647 bytes"),
        (matrix(STRUCTURE, (10**6, 1), element(INTEGER, struct.pack("<i", 1)), element(TEXT, b"abcdefgh")), "claims 8000000"),
        (element(PACKED, zlib.compress(bytes(100))), "cannot be read"),
        (matrix(NUMBERS, (1, 1), element(77, bytes(8))), "has numbers of the type 77"),
        (element(REAL, bytes(8)), "has an element of type 9 where a matrix stands"),
        (SERIES[:-8], "more than what contains it"),
    ],
)
def test_claims(tmp_path: Path, content: bytes, reason: str) -> None:
    refused(tmp_path / "a.mat", HEAD + content, reason)


def test_a_variable_that_unpacks_to_gigabytes(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("strainwave.files.budget.MIN_ALLOWED_BYTES", 2**20)
    packed = zlib.compress(element(MATRIX, bytes(2**22)))
    refused(tmp_path / "a.mat", HEAD + element(PACKED, packed), "a packed variable expands the file to")


@pytest.mark.parametrize(
    ("head", "reason"),
    [
        ((0, 2**30, 2**10, 0, 2), "claims 8796093022230 bytes, but has 54"),
        ((0, 10, 10, 0, 2), "claims 822 bytes, but has 54"),
        ((0, -1, 10, 0, 2), "has a matrix of an unknown type or a negative size"),
        ((90, 1, 1, 0, 2), "has a matrix of an unknown type or a negative size"),
    ],
)
def test_claims_of_version_4(tmp_path: Path, head: tuple[int, ...], reason: str) -> None:
    refused(tmp_path / "a.mat", struct.pack("<5i", *head) + b"t\0" + bytes(32), reason)


@pytest.mark.parametrize("is_packed", [False, True])
def test_any_byte_changed_ends_in_numbers_or_one_line(tmp_path: Path, is_packed: bool) -> None:
    path = tmp_path / "a.mat"
    cells = np.empty((1, 2), object)
    cells[0] = [np.arange(3.0), "arm"]
    savemat(path, {"data": {"t": np.arange(4.0), "c": cells}, "note": "arm"}, do_compression=is_packed)
    whole = path.read_bytes()
    random = np.random.default_rng(1)
    for place in random.integers(124, len(whole), 20):
        changed = bytearray(whole)
        changed[place] ^= 1 << random.integers(8)
        path.write_bytes(changed)
        with suppress(ValueError):
            assert open_mat(path).columns
