"""The faults of tests/evidence/broken_rooms.py can be put into the package as it is: each replaces one text of one file."""

from __future__ import annotations

import shutil
from pathlib import Path

from tests.evidence.broken_rooms import FAULTS, ROOT


def test_each_fault_changes_a_line_of_the_package(tmp_path: Path) -> None:
    for fault in FAULTS:
        copy = tmp_path / fault.file
        copy.parent.mkdir(parents=True, exist_ok=True)
        shutil.copy(ROOT / fault.file, copy)
        fault.put_into(tmp_path)
        assert copy.read_text(encoding="utf-8") != (ROOT / fault.file).read_text(encoding="utf-8")


def test_faults_are_in_at_least_ten_rooms() -> None:
    assert len({fault.room for fault in FAULTS}) >= 10
