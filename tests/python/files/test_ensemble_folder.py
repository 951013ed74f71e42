"""Ensembles in folders: whatever stops the writing, they are finished to the same bits; whatever is damaged is refused."""

from __future__ import annotations

import errno
import os
import random
import re
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow
import pytest
import strainwave as sw
from hypothesis import HealthCheck, given, settings, strategies as st
from pyarrow import parquet
from strainwave.files import writing
from strainwave.files.ensemble_folder import EnsembleFolder, fingerprint
from strainwave.files.writing import claiming
from strainwave.simulation import ensemble
from strainwave.simulation.ensemble import EnsembleWarning

from tests.python.simulation.test_ensemble import ROOT, same_bits

DRIVE = sw.Drive(load=sw.loads.Inertia(inertia=0.01))
COMMAND = sw.scenario.step(5.0, 0.004)
INERTIA = {"load.inertia": np.linspace(0.01, 0.02, 20)}
OTHERS: dict[str, Any] = {"sample": 1e-3, "record": ["torque"], "threads": 1}
PARTS = ["part-000000.parquet", "part-000001.parquet", "part-000002.parquet"]  # of 8, 8 and 4 members


@pytest.fixture(autouse=True)
def small_parts(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(ensemble, "PART_BYTES", 1)


def simulate(folder: Path) -> None:
    sw.simulation.simulate_to(folder, DRIVE, COMMAND, INERTIA, **OTHERS)


def whole() -> sw.Ensemble:
    return sw.simulate_many(DRIVE, COMMAND, INERTIA, **OTHERS)


@pytest.fixture(scope="module")
def written(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("written")
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(ensemble, "PART_BYTES", 1)
        simulate(folder)
    return folder


def contents(folder: Path) -> dict[str, bytes]:
    return {str(path.relative_to(folder)): path.read_bytes() for path in folder.rglob("*") if path.is_file()}


def refused(folder: Path, *words: str) -> None:
    """Reading ends in one line that contains the words."""
    with pytest.raises(ValueError, match=r"^[^\n]+$") as refusal:
        sw.Ensemble.read(folder)
    for word in words:
        assert word in str(refusal.value)


# What is damaged

damaged = st.sampled_from(["plan.parquet", *(f"{kind}/{part}" for kind in ("samples", "members") for part in PARTS)])


def with_bytes(path: Path, change: Callable[[bytes], bytes], check: Callable[[], None]) -> None:
    """Checks what happens while a file holds other bytes."""
    before = path.read_bytes()
    path.write_bytes(change(before))
    try:
        check()
    finally:
        path.write_bytes(before)


def whole_or_refused(folder: Path, name: str) -> None:
    """Reading gives what was written, to the last bit, or ends in one line that names the file."""
    try:
        read = sw.Ensemble.read(folder)
    except ValueError:
        refused(folder, name)
    else:
        assert same_bits(read, whole())


@pytest.mark.slow("files")
@settings(suppress_health_check=[HealthCheck.function_scoped_fixture], max_examples=200)
@given(name=damaged, place=st.floats(0.0, 1.0, exclude_max=True), bit=st.integers(0, 7))
def test_a_flipped_bit_changes_no_number_in_silence(name: str, place: float, bit: int, written: Path) -> None:
    """Some bits mean nothing, as those of statistics that nobody reads."""

    def flipped(data: bytes) -> bytes:
        where = int(place * len(data))
        return data[:where] + bytes([data[where] ^ 1 << bit]) + data[where + 1 :]

    with_bytes(written / name, flipped, lambda: whole_or_refused(written, name))


@settings(suppress_health_check=[HealthCheck.function_scoped_fixture], max_examples=50)
@given(name=damaged, share=st.floats(0.0, 1.0, exclude_max=True))
def test_a_file_that_was_cut_off_is_refused_by_its_name(name: str, share: float, written: Path) -> None:
    with_bytes(written / name, lambda data: data[: int(share * len(data))], lambda: refused(written, name))


def test_values_that_are_not_those_of_the_digest_are_refused(written: Path) -> None:
    """As a bit of the file's own description can make them: it says how pages are decoded, and has no checksum."""
    for name, column in (("samples/part-000001.parquet", "torque"), ("plan.parquet", "load.inertia")):
        table = parquet.read_table(written / name)
        place = table.schema.get_field_index(column)
        other = table.set_column(place, table.schema.field(place), [table[column].to_numpy() * (1.0 + 1e-15)])
        rewritten = pyarrow.BufferOutputStream()
        parquet.write_table(other, rewritten)
        with_bytes(
            written / name,
            lambda _, other=rewritten: other.getvalue().to_pybytes(),  # type: ignore[misc]
            lambda name=name: refused(written, f"{name} is damaged: its values are not those of its digest"),  # type: ignore[misc]
        )


def test_a_part_under_another_number_is_refused(written: Path, tmp_path: Path) -> None:
    for kind in ("samples", "members"):
        first, second = ((written / kind / name).read_bytes() for name in PARTS[:2])
        path = written / kind / PARTS[1]
        with_bytes(path, lambda _, other=first: other, lambda: refused(written, PARTS[1], "other members than 8 to 15"))  # type: ignore[misc]
        assert path.read_bytes() == second


def test_a_part_of_another_ensemble_is_refused(written: Path, tmp_path: Path) -> None:
    sw.simulation.simulate_to(tmp_path, DRIVE, 2.0 * COMMAND, INERTIA, **OTHERS)
    for kind in ("samples", "members"):
        other = (tmp_path / kind / PARTS[1]).read_bytes()
        with_bytes(
            written / kind / PARTS[1],
            lambda _, other=other: other,
            lambda: refused(written, PARTS[1], "another ensemble"),  # type: ignore[misc]
        )


def test_a_folder_that_is_named_like_a_column_adds_none(tmp_path: Path) -> None:
    simulate(tmp_path / "gain=3")
    assert same_bits(sw.Ensemble.read(tmp_path / "gain=3"), whole())


# What is missing


@pytest.mark.parametrize("kind", ["samples", "members"])
@pytest.mark.parametrize("part", range(3))
def test_a_part_that_is_missing_is_told_and_run_again(kind: str, part: int, tmp_path: Path) -> None:
    simulate(tmp_path)
    before = contents(tmp_path)
    (tmp_path / kind / PARTS[part]).unlink()
    count = (8, 8, 4)[part]
    refused(tmp_path, f"{tmp_path} holds {20 - count} of 20 members, without {PARTS[part]}: ", "simulate_to", "read_partial")
    partial = sw.Ensemble.read_partial(tmp_path)
    assert list(partial.failures) == list(range(20))[8 * part :][:count]
    assert set(partial.failures.values()) == {"it was not run, or its file is missing"}
    for member in set(range(20)) - set(partial.failures):
        assert partial.member(member) == whole().member(member)
    assert np.isnan(partial["torque"][list(partial.failures)]).all()
    assert np.array_equal(partial.parameters["load.inertia"], INERTIA["load.inertia"])
    simulate(tmp_path)
    assert contents(tmp_path) == before


def test_only_what_is_missing_is_run(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    simulate(tmp_path)
    (tmp_path / "samples" / PARTS[1]).unlink()
    ran: list[tuple[int, int]] = []
    run = ensemble._Plan.run

    def counted(plan: ensemble._Plan, first: int, last: int, shown: object) -> sw.Ensemble:
        ran.append((first, last))
        return run(plan, first, last, shown)

    monkeypatch.setattr(ensemble._Plan, "run", counted)
    simulate(tmp_path)
    simulate(tmp_path)
    assert ran == [(8, 16)]


def test_where_no_member_was_run_nothing_is_read(tmp_path: Path) -> None:
    simulate(tmp_path)
    for path in (tmp_path / "members").iterdir():
        path.unlink()
    refused(tmp_path, "holds 0 of 20 members")
    with pytest.raises(ValueError, match=r"^\S+ holds none of 20 members; call simulate_to again as before to run them$"):
        sw.Ensemble.read_partial(tmp_path)


def test_members_that_failed_are_told_by_the_run_that_finishes_too(tmp_path: Path) -> None:
    values = {"gear.stiffness.k": np.array([1e4] * 9 + [1e12])}
    arguments: tuple[Any, ...] = (tmp_path, DRIVE, COMMAND, values)
    words = r"^1 of 10 members have no result; the first is member 9: dt = 0\.0002 s is too coarse"
    with pytest.warns(EnsembleWarning, match=words):
        sw.simulation.simulate_to(*arguments, **OTHERS)
    (tmp_path / "samples" / PARTS[0]).unlink()
    assert set(sw.Ensemble.read_partial(tmp_path).failures) == set(range(8)) | {9}
    with pytest.warns(EnsembleWarning, match=words):
        sw.simulation.simulate_to(*arguments, **OTHERS)
    assert list(sw.Ensemble.read(tmp_path).failures) == [9]


# What stops the writing

RUN = """
import sys
from pathlib import Path
from strainwave.simulation import ensemble
from tests.python.files import test_ensemble_folder as test
ensemble.PART_BYTES = 1
test.simulate(Path(sys.argv[1]))
"""


def start(folder: Path) -> subprocess.Popen[bytes]:
    return subprocess.Popen([sys.executable, "-c", RUN, str(folder)], cwd=ROOT, stderr=subprocess.PIPE)


@pytest.mark.slow("files")
def test_a_run_that_is_killed_at_any_moment_is_finished_to_the_same_bits(tmp_path: Path, written: Path) -> None:
    """Killed after some of its calls that reach the disk, each time from where the last one was."""
    code = """
import os, random
left = int(sys.argv[2])
for name in ("fsync", "replace"):
    def dying(*arguments, real=getattr(os, name)):
        global left
        left -= 1
        if left == 0:
            os.kill(os.getpid(), 9)
        return real(*arguments)
    setattr(os, name, dying)
"""
    place = random.Random(1)
    for _ in range(4):
        arguments = [str(tmp_path), str(place.randint(1, 8))]
        first, last = RUN.rsplit("test.simulate", 1)
        killed = subprocess.run(
            [sys.executable, "-c", first + code + "test.simulate" + last, *arguments], cwd=ROOT, timeout=60, check=False
        )
        assert killed.returncode in (0, -signal.SIGKILL)
    simulate(tmp_path)
    assert contents(tmp_path) == contents(written)


@pytest.mark.slow("files")
def test_the_time_of_a_kill_does_not_matter(tmp_path: Path, written: Path) -> None:
    """By the clock, as it happens."""
    process = start(tmp_path)
    while not (tmp_path / "samples").exists() and process.poll() is None:
        time.sleep(1e-3)
    process.kill()
    process.communicate(timeout=60)
    simulate(tmp_path)
    assert contents(tmp_path) == contents(written)


@pytest.mark.parametrize("writes", range(7))
def test_a_run_whose_disk_is_full_names_the_file_and_is_finished_to_the_same_bits(
    writes: int, tmp_path: Path, written: Path
) -> None:
    folder, put = tmp_path / "new" / "runs", writing._Draft.put
    left = iter(range(writes))

    def full(draft: writing._Draft) -> None:
        if next(left, None) is None:
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
        put(draft)

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(writing._Draft, "put", full)
        with pytest.raises(OSError, match=r"^\S+\.parquet cannot be written: No space left on device$"):
            simulate(folder)
    assert folder.exists() == (writes > 0)
    assert (tmp_path / "new").exists() == (writes > 0)
    assert not list(tmp_path.rglob(".*"))
    simulate(folder)
    assert contents(folder) == contents(written)


@pytest.mark.slow("files")
def test_a_folder_that_another_process_writes_to_is_refused(tmp_path: Path) -> None:
    with claiming(tmp_path):
        process = start(tmp_path)
        _, wrong = process.communicate(timeout=60)
    said = f"BlockingIOError: {tmp_path} is being written by another process; wait until it ends"
    assert wrong.decode().splitlines()[-1] == said
    assert list(tmp_path.iterdir()) == []


# Another ensemble

CHANGED: dict[str, tuple[Any, ...]] = {  # what is asked for, and the words of the refusal
    "drive": ({"drive": DRIVE.replace(motor=DRIVE.motor.replace(resistance=2.0))}, "drive is sha256 "),
    "model": ({"drive": DRIVE.replace(load=sw.loads.Pendulum(inertia=0.01, gravity_torque=0.0))}, "drive is sha256 "),
    "command": ({"command": 2.0 * COMMAND}, "command is sha256 "),
    "load_torque": ({"load_torque": 1.0}, "load_torque is 0.0 there, 1.0 here"),
    "temperature": ({"temperature": 300}, "temperature is 293.15 there, 300.0 here"),
    "dt": ({"dt": 1e-4}, "dt is 0.0002 there, 0.0001 here"),
    "sample": ({"sample": 2e-3}, "sample is 0.001 there, 0.002 here"),
    "record": ({"record": ["twist"]}, 'record is ["torque"] there, ["twist"] here'),
    "values": ({"parameters": {"load.inertia": np.linspace(0.01, 0.03, 20)}}, "parameters is sha256 "),
    "path": ({"parameters": {"motor.inertia": np.linspace(0.01, 0.02, 20)}}, "parameters is sha256 "),
    "members": ({"parameters": {"load.inertia": np.linspace(0.01, 0.02, 19)}}, "members is 20 there, 19 here"),
}


@pytest.mark.parametrize(("changes", "words"), CHANGED.values(), ids=CHANGED)
def test_another_ensemble_in_the_folder_is_refused_by_what_differs(changes: dict[str, Any], words: str, written: Path) -> None:
    before = contents(written)
    asked = {"drive": DRIVE, "command": COMMAND, "parameters": INERTIA} | OTHERS | changes
    with pytest.raises(FileExistsError, match=r"^[^\n]* holds another ensemble: [^\n]*; take another folder$") as refusal:
        sw.simulation.simulate_to(written, **asked)
    assert words in str(refusal.value)
    assert contents(written) == before


def test_another_version_of_the_package_is_refused(written: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(ensemble, "version", lambda name: "99.0")
    with pytest.raises(FileExistsError, match=r'version is "\S+" there, "99\.0" here; take another folder$'):
        simulate(written)


def test_the_same_said_otherwise_is_the_same_ensemble(written: Path) -> None:
    before = contents(written)
    parameters = {"load.inertia": INERTIA["load.inertia"].tolist()}
    others = OTHERS | {"dt": np.float64(2e-4), "load_torque": 0, "record": ("torque",), "threads": 2}
    sw.simulation.simulate_to(str(written), DRIVE.replace(), sw.scenario.step(5.0, 0.004), parameters, **others)
    assert contents(written) == before


def test_a_damaged_plan_is_not_written_over(written: Path) -> None:
    def check() -> None:
        with pytest.raises(ValueError, match=re.escape(f"{written}/plan.parquet cannot be read: ")):
            simulate(written)

    with_bytes(written / "plan.parquet", lambda data: data[:100], check)


def test_the_folder_says_what_was_asked_for(written: Path) -> None:
    folder = EnsembleFolder.open(written)
    assert folder.asked["dt"] == "0.0002"
    assert folder.asked["record"] == '["torque"]'
    assert folder.units == {"torque": "N.m"}
    assert np.array_equal(folder.parameters["load.inertia"], INERTIA["load.inertia"])
    assert [(part.first, part.last) for part in folder.parts()] == [(0, 8), (8, 16), (16, 20)]


numbers = st.floats(allow_nan=False)


@given(one=st.lists(numbers), other=st.lists(numbers))
def test_fingerprints_are_equal_where_values_are(one: list[float], other: list[float]) -> None:
    kinds: list[Callable[[list[float]], object]] = [list, np.array, lambda values: {"values": values}]
    for kind in kinds:
        assert fingerprint(kind(one)) == fingerprint(kind(list(one)))
        assert (fingerprint(kind(one)) == fingerprint(kind(other))) == (
            list(map(float.hex, one)) == list(map(float.hex, other))
        )


def test_waves_of_a_command_are_told_apart() -> None:
    commands = [sw.scenario.sine(0.1, 1.0, 2.0), sw.scenario.sine(0.1, 1.5, 2.0), sw.scenario.sine(0.2, 1.0, 2.0)]
    assert len({fingerprint(command) for command in commands}) == 3
