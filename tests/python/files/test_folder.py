"""Folders that lead elsewhere, or never end."""

from __future__ import annotations

import os
from pathlib import Path

import pytest
from strainwave.files.folder import files_below, inside
from strainwave.files.tables import is_table_of_numbers


def test_links_are_named_and_not_followed(tmp_path: Path) -> None:
    folder = tmp_path / "folder"
    (folder / "below").mkdir(parents=True)
    for path in (folder / "b.CSV", folder / "below" / "a.csv", folder / "notes.md", tmp_path / "secret.csv"):
        path.touch()
    (folder / "link.csv").symlink_to("../secret.csv")
    (folder / "loop").symlink_to(".")
    (folder / "link.md").symlink_to("../secret.csv")
    os.mkfifo(folder / "fifo.csv")
    files, links = files_below(folder, {".csv"})
    assert files == [folder / "b.CSV", folder / "below" / "a.csv"]
    assert links == [folder / "link.csv", folder / "loop"]
    (tmp_path / "named").symlink_to("folder")
    assert len(files_below(tmp_path / "named", {".csv"}).files) == 2


def test_a_file_is_taken_for_what_it_contains(tmp_path: Path) -> None:
    (tmp_path / "run.t").write_text(" 0.1\t 2.5\n" * 9)
    (tmp_path / "notes.md").write_text("# Notes\n1 2\n")
    (tmp_path / "sheet.xlsx").write_text("1 2\n" * 9)
    assert files_below(tmp_path, {".csv"}, is_table_of_numbers).files == [tmp_path / "run.t"]


def test_a_folder_has_its_bounds(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "/".join("d" * 65)).mkdir(parents=True)
    (tmp_path / "/".join("d" * 65) / "a.csv").touch()
    with pytest.raises(ValueError, match="contains more than 20000 files, or is nested more than 64 deep; name the files"):
        files_below(tmp_path, {".csv"})
    monkeypatch.setattr("strainwave.files.folder.MAX_ENTRIES", 3)
    with pytest.raises(ValueError, match="contains more than 3 files"):
        files_below(tmp_path, {".csv"})


@pytest.mark.parametrize("name", ["../secret.png", "/etc/passwd", "link.png", "below/../../secret.png", "loop.png"])
def test_a_name_that_leads_out_of_the_folder_is_refused(tmp_path: Path, name: str) -> None:
    folder = tmp_path / "folder"
    (folder / "below").mkdir(parents=True)
    (folder / "link.png").symlink_to("../secret.png")
    (folder / "loop.png").symlink_to("loop.png")
    with pytest.raises(ValueError, match=r"does not lie in the folder .*; copy it there") as refused:
        inside(folder, name)
    assert "\n" not in str(refused.value)


def test_a_name_within_the_folder_is_a_path(tmp_path: Path) -> None:
    (tmp_path / "named").symlink_to(tmp_path)
    assert inside(tmp_path / "named", "a/b.png") == tmp_path / "named" / "a" / "b.png"
