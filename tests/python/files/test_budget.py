"""Limits of reading a file."""

from __future__ import annotations

import tracemalloc
from pathlib import Path

import pytest
from strainwave.files.budget import RefusedFile, read_regular


def test_a_small_file_takes_little_memory(tmp_path: Path) -> None:
    (tmp_path / "a").write_bytes(b"0123")
    tracemalloc.start()
    assert read_regular(tmp_path / "a") == b"0123"
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert peak < 10**6


def test_a_large_file_is_refused_and_one_that_grows(tmp_path: Path) -> None:
    (tmp_path / "a").write_bytes(b"0123")
    with pytest.raises(RefusedFile, match="has more than 0 MB"):
        read_regular(tmp_path / "a", 3)
    with pytest.raises(RefusedFile, match="grows while it is read"):
        read_regular("/proc/self/status")
