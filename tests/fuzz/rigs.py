"""Folders of torsion tests that are not as they should be."""

from __future__ import annotations

import os
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory

import strainwave as sw
from numpy.random import Generator
from strainwave.rig import TorsionTest, read_test, write_rig, write_steps
from strainwave.rig.bench.steps import COLUMNS, read_steps

from tests.fuzz.laws import Case, described, within_memory
from tests.fuzz.mutation import encoded, mutated

STEP_WORDS = (
    "../../secret.png", "/dev/zero", "fifo.png", "link.png", "a.png", "/etc/passwd", "nan", "1e300", "-1", "٣", "0", "1e-320",
    "1" * 5000, "mass_positive [g]", "torque [kN.m]", "image", "unit", "angle [deg]", "temperature [degC]", "time [s]",
    "position [deg]", *COLUMNS,
)  # fmt: skip
RIG_WORDS = (
    "value = nan",
    "value = 1e400", "value = 1e300", "value = 5e-324", "value = 0", "value = -1", 'unit = "furlong"', 'unit = "N"',
    "uncertainty = -1", "uncertainty = 1e300", "count = 0", "count = 1e9", "count = -1", "[camera]", "[[masses]]", "[loading]",
    'side = "x"', 'cord = "x"', "aspect = 0", "radial = [1e300, 1e300]", "9" * 400, "[" * 2000,
)  # fmt: skip


@cache
def _texts() -> tuple[str, str]:
    """Rig and steps as they should be."""
    rig = sw.rig.load("couple-rig")
    masses = (0.7, 0.35, 0.0, -0.35, -0.7, -0.35, 0.0, 0.35, 0.7)
    steps = [
        sw.rig.Step(n, max(m, 0.0), max(-m, 0.0), angle=m / 4.0, unit="A", image="a.png" if n == 1 else None, time=60.0 * n)
        for n, m in enumerate(masses, 1)
    ]
    with TemporaryDirectory() as folder:
        write_rig(rig, Path(folder, "rig.toml"))
        write_steps(steps, folder)
        return Path(folder, "rig.toml").read_text(encoding="utf-8"), Path(folder, "steps.csv").read_text(encoding="utf-8")


def rigs_case(random: Generator, folder: Path) -> Case:
    """A test of nine steps, read and analysed."""
    place = folder / "test"
    place.mkdir()
    rig, steps = _texts()
    in_rig = random.random() < 0.5
    changed = encoded(mutated(rig if in_rig else steps, random, RIG_WORDS if in_rig else STEP_WORDS), random)
    (place / "rig.toml").write_bytes(changed if in_rig else rig.encode())
    (place / "steps.csv").write_bytes(steps.encode() if in_rig else changed)
    (folder / "secret.png").write_bytes(b"secret")
    os.mkfifo(place / "fifo.png")
    (place / "link.png").symlink_to("../secret.png")

    def attempt() -> TorsionTest:
        read = read_test(place)
        for loop in read.loops:
            sw.rig.analyse(loop)
        return read

    def check(read: TorsionTest) -> None:
        assert all(not digest for name, digest in read.hashes.items() if name != "a.png"), "a digest of another file"
        write_steps(read.steps, folder / "again.csv")
        assert tuple(read_steps(folder / "again.csv")) == read.steps, "a file contains other steps"

    return Case(f"{'rig' if in_rig else 'steps'} {described(changed, 2000)}", within_memory(attempt), check)
