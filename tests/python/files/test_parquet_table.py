"""Parquet files whose few bytes claim many values are refused before Arrow allocates them."""

from __future__ import annotations

import re
from contextlib import suppress
from pathlib import Path

import numpy as np
import pyarrow
import pytest
from pyarrow import parquet
from strainwave import Recording
from strainwave.files.parquet_table import read_columns


def write(path: Path, table: pyarrow.Table, **options: object) -> None:
    parquet.write_table(table, path, **options)


@pytest.mark.parametrize("packing", ["none", "zstd", "gzip", "snappy"])
@pytest.mark.parametrize("dictionary", [True, False])
@pytest.mark.parametrize("version", ["1.0", "2.0"])
def test_columns_of_several_pages_are_read_back(tmp_path: Path, packing: str, dictionary: bool, version: str) -> None:
    values = np.random.default_rng(1).integers(0, 50, 5000).astype(float)
    table = pyarrow.table({"q [1]": values, "note": ["x"] * 5000})
    options = {"compression": packing, "use_dictionary": dictionary, "data_page_version": version, "data_page_size": 1000}
    write(tmp_path / "a.parquet", table, row_group_size=2000, write_page_checksum=True, **options)
    assert Recording.read(tmp_path / "a.parquet", {"q": "q"})["q"].tolist() == values.tolist()


@pytest.mark.parametrize("allowed", [100_000, 1_000_000])
def test_equal_values_without_end(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, allowed: int) -> None:
    write(tmp_path / "a.parquet", pyarrow.table({"q [1]": np.zeros(100_000)}), compression="zstd")
    assert (tmp_path / "a.parquet").stat().st_size < 2000
    monkeypatch.setattr("strainwave.files.budget.MIN_ALLOWED_BYTES", allowed)
    if allowed > 800_000:
        assert len(Recording.read(tmp_path / "a.parquet", {"q": "q"})) == 100_000
    else:
        with pytest.raises(ValueError, match=r"a\.parquet: column q \[1\] expands the file to 1 MB"):
            Recording.read(tmp_path / "a.parquet", {"q": "q"})


def test_a_page_that_claims_gigabytes(tmp_path: Path) -> None:
    """The header of a page, in the compact protocol of Thrift: field 2 is its size unpacked, an integer."""
    path = tmp_path / "a.parquet"
    write(path, pyarrow.table({"q": np.arange(3000.0)}), compression="zstd", use_dictionary=False, write_statistics=False)
    whole = path.read_bytes()
    header = re.compile(rb"\x15\x00\x15(?:[\x80-\xff]*[\x00-\x7f])\x15").search(whole)
    assert header is not None
    size = b"\xfe\xff\xff\xff\x0f"  # 2^31 - 1
    length = len(header[0]) - 4
    changed = whole[: header.start() + 3] + size + whole[header.start() + 3 + length :]
    path.write_bytes(changed.replace(whole[-8:], (int.from_bytes(whole[-8:-4], "little")).to_bytes(4, "little") + b"PAR1"))
    with pytest.raises(ValueError, match=rf"^{re.escape(str(path))}: a page of column q expands the file to 2148 MB"):
        read_columns(path)


def test_what_is_nested_is_refused_before_it_is_read(tmp_path: Path) -> None:
    write(tmp_path / "a.parquet", pyarrow.table({"t [s]": [0.0, 1.0], "q [1]": [[1.0], [2.0]]}))
    with pytest.raises(ValueError, match=r'column "q \[1\]" holds list<element: double>, not numbers'):
        Recording.read(tmp_path / "a.parquet", {"q": "q"})


def test_any_byte_of_the_footer_changed_ends_in_numbers_or_one_line(tmp_path: Path) -> None:
    """Arrow ends the process if it is asked for the description of a column with a wrong histogram of levels."""
    path = tmp_path / "a.parquet"
    write(path, pyarrow.table({"q [1]": np.arange(60.0)}), compression="zstd")
    whole = path.read_bytes()
    random = np.random.default_rng(1)
    for place in random.integers(whole.rindex(b"schema") - 40, len(whole), 40):
        changed = bytearray(whole)
        changed[place] ^= 1 << random.integers(8)
        path.write_bytes(changed)
        with suppress(ValueError):
            assert len(read_columns(path)) >= 0
