"""Digests of what was read: of regular files and bags, and of nothing else."""

from __future__ import annotations

import hashlib
import os
from pathlib import Path

import pytest
from strainwave.files.budget import MAX_ALLOWED_BYTES
from strainwave.report.provenance import Provenance


def digests(*files: Path) -> list[str]:
    return list(Provenance.of(files, command="", date="").files.values())


def test_a_file_and_a_bag_have_their_digest(tmp_path: Path) -> None:
    (tmp_path / "secret").write_bytes(b"secret")
    bag = tmp_path / "bag"
    bag.mkdir()
    for name in ("b.db3", "a.yaml"):
        (bag / name).write_bytes(name.encode())
    (bag / "link.db3").symlink_to("../secret")
    (bag / "below").mkdir()
    assert digests(bag, bag / "b.db3") == [hashlib.sha256(b"a.yamlb.db3").hexdigest(), hashlib.sha256(b"b.db3").hexdigest()]
    with pytest.raises(FileNotFoundError):
        digests(tmp_path / "missing.csv")


def test_what_is_never_read_has_none(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "fifo.csv")
    with (tmp_path / "large.csv").open("wb") as file:
        file.truncate(MAX_ALLOWED_BYTES + 1)
    assert digests(tmp_path / "fifo.csv", Path("/dev/zero"), tmp_path / "large.csv") == ["", "", ""]
