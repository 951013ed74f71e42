"""Files written to where they cannot be, or where something is: whole or not at all."""

from __future__ import annotations

import os
import re
import resource
import signal
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import strainwave as sw
from numpy.random import Generator
from strainwave.files import writing

from tests.fuzz.laws import Case, described
from tests.fuzz.mutation import TEXTS, picked

Snapshot = dict[str, bytes | str]
SUFFIXES = (".csv", ".parquet", ".toml", ".html", "", ".TOML", ".csv.gz")


def _recording() -> sw.Recording:
    time = np.arange(400.0)
    return sw.Recording({"time": time, "speed": np.sin(time)}, {"time": "s", "speed": "rad/s"}, "a run")


def _simulate(path: Any) -> Path:
    drive = sw.Drive(load=sw.loads.Inertia(inertia=0.1))
    return sw.simulation.simulate_to(
        path, drive, sw.scenario.constant(1.0, 0.05), {"load.inertia": [0.1, 0.2]}, 5e-4, threads=1
    )


def _page(path: Any) -> None:
    with writing.replacing(path) as file:
        file.write(b"<!doctype html>" + b"x" * 5000)


WRITERS: tuple[tuple[str, Callable[[Any], Any]], ...] = (
    ("to_csv", lambda path: _recording().to_csv(path)),
    ("to_parquet", lambda path: _recording().to_parquet(path)),
    ("GearSet.save", lambda path: sw.GearSet.read("hfuc-25-100").save(path)),
    ("save", lambda path: sw.save(sw.Gear(), path, name="mine", source="assumed")),
    ("report", _page),
    ("simulate_to", _simulate),
)  # fmt: skip


def files_case(random: Generator, folder: Path) -> Case:
    """One writer, one odd target; now and then on a disk that is full."""
    name, write = picked(random, WRITERS)
    target = _target(random, folder)
    room = int(random.integers(0, 2000)) if random.random() < 0.2 else None
    words = f"{name} to {described(target)}".replace(str(folder), "FOLDER") + ("" if room is None else f" with room for {room}")
    return Case(words, lambda: _whole_or_not(write, target, folder, room))


def _target(random: Generator, folder: Path) -> Any:
    suffix = picked(random, SUFFIXES)
    (folder / "full").mkdir()
    (folder / "full" / f"old{suffix}").write_text("old")
    (folder / f"old{suffix}").write_text("old")
    (folder / f"folder{suffix}").mkdir()
    (folder / f"loop{suffix}").symlink_to(folder / f"loop{suffix}")
    (folder / f"link{suffix}").symlink_to(folder / f"old{suffix}")
    (folder / f"dangling{suffix}").symlink_to(folder / "nowhere" / "x")
    names = (
        f"new{suffix}", f"old{suffix}", f"folder{suffix}", f"loop{suffix}", f"link{suffix}", f"dangling{suffix}", suffix, ".",
        "..", f"none/new{suffix}", f"old{suffix}/new{suffix}", f"loop{suffix}/new{suffix}", f"new{suffix}/", "full",
        f" {suffix}", f"é{suffix}", "n" * 300 + suffix, "n" * 240 + suffix, f"a\x00b{suffix}", f"a\nb{suffix}",
        f"a\x1b[31m{suffix}", f"\ud800{suffix}", f"x{picked(random, TEXTS)[:100]}{suffix}",
    )  # fmt: skip
    path = f"{folder}/{picked(random, names)}"
    if picked(random, (True, True, False)):
        return path
    return picked(random, (Path(path), path.encode(errors="surrogatepass"), 5, None, ["x"], 0, 1, 1.5, True))


def _whole_or_not(write: Callable[[Any], Any], target: Any, folder: Path, room: int | None) -> None:
    """Writes; where that is refused, what was there is as it was, and nothing is beside it."""
    before = _snapshot(folder)
    try:
        with _Room(room):
            write(target)
    except Exception:
        if room is None or write is not _simulate or not Path(target, "plan.parquet").exists():
            assert _snapshot(folder) == before, f"refused, but files changed: {_changed(before, _snapshot(folder))}"
        else:
            write(target)  # of an ensemble the plan stays, and it is taken up again
        raise
    leftovers = [name for name in _snapshot(folder) if re.search(r"\.[0-9a-f]{32}$", name)]
    assert not leftovers, f"left behind: {leftovers}"


class _Room:
    """So much may be written to one file, as if a disk was full."""

    def __init__(self, size: int | None) -> None:
        self.size = size

    def __enter__(self) -> None:
        if self.size is not None:
            signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
            resource.setrlimit(resource.RLIMIT_FSIZE, (self.size, resource.RLIM_INFINITY))

    def __exit__(self, *error: object) -> None:
        resource.setrlimit(resource.RLIMIT_FSIZE, (resource.RLIM_INFINITY, resource.RLIM_INFINITY))


def _snapshot(folder: Path) -> Snapshot:
    """All files with what they hold, links with where they lead, and folders."""
    found: Snapshot = {}
    for place, folders, files in os.walk(folder):
        for name in (*folders, *files):
            path = Path(place, name)
            key = str(path.relative_to(folder))
            found[key] = os.readlink(path) if path.is_symlink() else path.read_bytes() if path.is_file() else "folder"
    return found


def _changed(before: Snapshot, after: Snapshot) -> str:
    return described(sorted(name for name in before.keys() | after.keys() if before.get(name) != after.get(name)))
