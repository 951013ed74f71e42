"""Many drives side by side: the same as one by one, whoever fails among them, wherever they run and whatever stops them."""

from __future__ import annotations

import hashlib
import json
import os
import platform
import re
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from functools import cache, partial
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow
import pytest
import strainwave as sw
from numpy.typing import NDArray
from pyarrow import dataset
from strainwave import _core
from strainwave.native import kernels
from strainwave.simulation import ensemble
from strainwave.simulation.ensemble import EnsembleWarning
from strainwave.simulation.signals import outputs

from tests.support.interrupts import ctrl_c
from tests.support.reference_drive import DRIVE, command
from tests.support.strategies import made

Array = NDArray[np.float64]

ROOT = Path(__file__).parents[3]
OUTPUTS = list(outputs(sw.Drive()))
STRIBECK = sw.friction.Stribeck(coulomb=0.03, breakaway=0.045, stribeck_speed=2.0, viscous=5e-5)
STICKING = DRIVE.replace(
    gear=DRIVE.gear.replace(friction_input=STRIBECK, friction_output=sw.friction.Coulomb(coulomb=3.0, breakaway=4.0))
)
DRIVES = {"smooth": DRIVE, "set-valued": STICKING}
ONE_OF_BOTH = DRIVE.replace(  # bristles at the input, stick at the output
    gear=DRIVE.gear.replace(friction_output=STRIBECK.replace(coulomb=3.0, breakaway=4.0, stribeck_speed=0.1))
)
SWING = sw.scenario.sine(0.02, 3.0, 0.2)  # small and slow enough for a set-valued side to stick at its turns
WARM = sw.scenario.constant(300.0, 0.2)
MEMBERS = 11  # a full pack, and one that is not

every_drive = pytest.mark.parametrize("drive", DRIVES.values(), ids=DRIVES)


def varied(members: int = MEMBERS) -> dict[str, Array]:
    """Numbers of both drives, another value for each member; of a list too."""
    share = np.linspace(0.8, 1.2, members)
    return {
        "load.inertia": 0.5 * share,
        "gear.friction_input.coulomb": 0.03 * share[::-1],
        "gear.hysteresis.stiffness[0]": 375.0 * share**2,
    }


def with_parameters(drive: sw.Drive, values: dict[str, float]) -> sw.Drive:
    """The same drive with other numbers at these paths."""
    numbers = {path: number for path, number, *_ in _core.parameters(drive)} | values
    return _core.with_numbers(drive, list(numbers.values()))


def member_of(drive: sw.Drive, parameters: dict[str, Array], member: int) -> sw.Drive:
    return with_parameters(drive, {path: float(values[member]) for path, values in parameters.items()})


def same_bits(one: sw.Ensemble, other: sw.Ensemble) -> bool:
    """Also of what is not a number."""
    return (
        dict(one.failures) == dict(other.failures)
        and np.array_equal(one.time, other.time)
        and list(one.columns) == list(other.columns)
        and all(np.array_equal(one[name], other[name], equal_nan=True) for name in one.columns)
        and list(one.parameters) == list(other.parameters)
        and all(np.array_equal(one.parameters[path], other.parameters[path]) for path in one.parameters)
        and one.units == other.units
    )


# What comes back


def test_columns_have_a_row_a_member_and_a_value_a_sample() -> None:
    runs = sw.simulate_many(DRIVE, command(0.0105), varied(), record=["torque", "command"], sample=1e-3)
    assert runs.time == pytest.approx([*(1e-3 * np.arange(11)), 0.0105], rel=1e-12)
    assert list(runs.columns) == ["torque", "command"]
    assert runs["torque"].shape == runs["command"].shape == (MEMBERS, 12)
    assert runs.units == {"torque": "N.m", "command": "rad"}
    assert len(runs) == MEMBERS
    assert {path: values.tolist() for path, values in runs.parameters.items()} == {
        path: values.tolist() for path, values in varied().items()
    }
    assert runs.failures == {}
    with pytest.raises(ValueError, match=r'^no column "twist" was recorded; there are torque, command$'):
        runs["twist"]


def test_input_angle_output_angle_and_torque_are_recorded_at_every_step_unless_told_otherwise() -> None:
    runs = sw.simulate_many(DRIVE, command(0.01), {"load.inertia": [0.5]})
    assert list(runs.columns) == ["input_angle", "output_angle", "torque"]
    assert runs["torque"].shape == (1, 51)
    voltage = sw.scenario.constant(5.0, 0.01)
    open_loop = DRIVE.replace(control=sw.control.OpenLoop())
    assert sw.simulate_many(open_loop, voltage, {"load.inertia": [0.5]}, record=["command"]).units == {"command": "V"}


@every_drive
def test_a_member_is_the_run_of_its_drive_alone_to_the_last_bit(drive: sw.Drive) -> None:
    others: dict[str, Any] = {"sample": 1e-3, "load_torque": 3.0, "temperature": sw.scenario.ramp(50.0, 0.2) + WARM}
    runs = sw.simulate_many(drive, SWING, varied(), 5e-4, record=OUTPUTS, **others)
    assert np.unique(runs["torque"][:, -1]).size == MEMBERS  # the parameters do change the runs
    for member in range(MEMBERS):
        alone = sw.simulate(member_of(drive, varied(), member), SWING, 5e-4, **others)
        one = runs.member(member)
        assert one.names == alone.names
        assert {name: one.unit(name) for name in one.names} == {name: alone.unit(name) for name in alone.names}
        for name in one.names:
            assert np.array_equal(one[name], alone[name]), (member, name)


@pytest.mark.parametrize("drive", [STICKING, ONE_OF_BOTH], ids=["both sides", "output"])
def test_the_swing_makes_the_set_valued_side_stick_and_slip(drive: sw.Drive) -> None:
    stuck = sw.simulate_many(drive, SWING, varied(), 5e-4, record=["output_speed"])["output_speed"] == 0.0
    assert np.all(np.count_nonzero(np.diff(stuck, axis=1), axis=1) >= 2)


# The same bits wherever it runs


@every_drive
def test_the_number_of_threads_changes_no_bit(drive: sw.Drive) -> None:
    one, two, three = (sw.simulate_many(drive, SWING, varied(43), 5e-4, threads=threads) for threads in (1, 2, 3))
    assert same_bits(one, two)
    assert same_bits(one, three)


FLAGS = {"baseline": set[str](), "avx2": {"avx2"}, "avx512": {"avx512f", "avx512dq", "avx512vl", "avx512bw"}}


def machine_flags() -> set[str]:
    """What Linux says of the processor, on the machines for which there is more than a baseline."""
    if platform.machine() != "x86_64" or not Path("/proc/cpuinfo").exists():
        return set()
    lines = Path("/proc/cpuinfo").read_text().splitlines()
    return set(next(line for line in lines if line.startswith("flags")).split())


def digest(*, by_kernel: bool) -> str:
    """Return the digest of many runs of a drive, by a kernel or by the general drive."""
    _core.forget_kernels(ONE_OF_BOTH)
    assert kernels.load(ONE_OF_BOTH, "simulate_many", compile_it=True) if by_kernel else True
    assert ("simulate_many" in _core.loaded_jobs(ONE_OF_BOTH)) == by_kernel
    many = sw.simulate_many(ONE_OF_BOTH, SWING, varied(), 5e-4, record=OUTPUTS)
    return hashlib.sha256(b"".join(value.tobytes() for value in many.columns.values())).hexdigest()


def script(code: str, **variables: str) -> subprocess.Popen[str]:
    """A Python of its own, in which `tests` can be imported."""
    return subprocess.Popen(
        [sys.executable, "-W", "ignore:lugre can create energy", "-c", code],
        cwd=ROOT,
        env=os.environ | variables,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )


general_digest = cache(partial(digest, by_kernel=False))


@pytest.mark.slow("simulation")
@pytest.mark.parametrize("instruction_set", FLAGS)
def test_a_kernel_of_each_instruction_set_gives_the_bits_of_the_general_drive(instruction_set: str) -> None:
    if missing := FLAGS[instruction_set] - machine_flags():
        pytest.skip(f"this machine has no {', '.join(sorted(missing))}")
    code = (
        "import json; from strainwave import _core; from tests.python.simulation.test_ensemble import digest; "
        "print(json.dumps([_core.instruction_set(), digest(by_kernel=True)]))"
    )
    printed, _ = script(code, STRAINWAVE_INSTRUCTION_SET=instruction_set).communicate(timeout=120)
    assert json.loads(printed) == [instruction_set, general_digest()]


def test_an_unknown_instruction_set_is_refused_with_those_that_run_here() -> None:
    code = "import strainwave as sw; sw.compile(sw.Drive(), ['simulate'])"
    process = script(code, STRAINWAVE_INSTRUCTION_SET="sse9")
    _, wrong = process.communicate(timeout=60)
    running = [name for name in reversed(FLAGS) if FLAGS[name] <= machine_flags()]
    assert process.returncode == 1
    assert wrong.splitlines()[-1] == (
        f"ValueError: STRAINWAVE_INSTRUCTION_SET = sse9 is not one that this machine has: {', '.join(running)}"
    )


# Refusals


@pytest.mark.parametrize(
    ("parameters", "others", "words"),
    [
        ({}, {}, r"^parameters must name at least one number that the members differ in$"),
        ({"load.inertai": [0.5]}, {}, r'^the model has no parameter "load\.inertai"; near it are load\.inertia,'),
        ({3: [0.5]}, {}, r'^the model has no parameter "3"; near it are '),
        ({"load.inertia": []}, {}, r"^load\.inertia must have one value a member, shape \(members,\), not \(0,\)$"),
        ({"load.inertia": 0.5}, {}, r"^load\.inertia must have one value a member, shape \(members,\), not \(\)$"),
        ({"load.inertia": [[0.5]]}, {}, r"^load\.inertia must have one value a member, shape \(members,\), not \(1, 1\)$"),
        (
            {"load.inertia": [0.5, 0.6], "gear.damping": [10.0]},
            {},
            r"^all parameters must have as many values as there are members: load\.inertia 2, gear\.damping 1$",
        ),
        ({"gear.damping": [10.0, -1.0]}, {}, r"^gear\.damping = -1 N\.m\.s/rad of member 1 must lie in \[0, inf\)$"),
        ({"gear.damping": [10.0, 9.0, np.nan]}, {}, r"^gear\.damping = nan N\.m\.s/rad of member 2 must lie in \[0, inf\)$"),
        ({"gear.damping": [np.inf]}, {}, r"^gear\.damping = inf N\.m\.s/rad of member 0 must lie in \[0, inf\)$"),
        ({"load.inertia": [0.0]}, {}, r"^load\.inertia = 0 kg\.m2 of member 0 must lie in \(0, inf\)$"),
        (
            {"load.inertia": [0.5]},
            {"record": ["torque", "torsion"]},
            r"^record = .*'torsion'.* must list outputs of this drive: comm",
        ),
        ({"load.inertia": [0.5]}, {"record": []}, r"^record = \[\] must list outputs of this drive: command, "),
        (
            {"load.inertia": np.broadcast_to(0.5, 10**9)},
            {},
            r"^load\.inertia has 1000000000 values; one call has at most 100000000",
        ),
        ({"load.inertia": [0.5]}, {"threads": 0}, r"^threads = 0 must be 1 or more$"),
        ({"load.inertia": [0.5]}, {"dt": -1.0}, r"^dt = -1\.0 s must lie in \(0, inf\)$"),
        ({"load.inertia": [0.5]}, {"temperature": -1.0}, r"^temperature = -1 K must lie in \(0, inf\)"),
    ],
)
def test_what_makes_no_sense_is_refused(parameters: dict[str, Any], others: dict[str, Any], words: str, tmp_path: Path) -> None:
    runs: tuple[Callable[[], object], ...] = (
        lambda: sw.simulate_many(DRIVE, command(0.01), parameters, **others),
        lambda: sw.simulation.simulate_to(tmp_path / "runs", DRIVE, command(0.01), parameters, **others),
    )
    for run in runs:
        with pytest.raises(ValueError, match=words):
            run()
    assert not (tmp_path / "runs").exists()


@pytest.mark.parametrize(
    ("parameters", "others", "words"),
    [
        (["load.inertia"], {}, r"^parameters must be a mapping, as in .*, not \['load\.inertia'\]$"),
        (None, {}, r"^parameters must be a mapping, as in .*, not None$"),
        ({"load.inertia": ["0.5", "0.6"]}, {}, r"^load\.inertia must hold numbers, not <U3$"),
        ({"load.inertia": [0.5, None]}, {}, r"^load\.inertia must hold numbers, not object$"),
        ({"load.inertia": [0.5]}, {"record": "torque"}, r"^record must be a list of names, not 'torque'$"),
        ({"load.inertia": [0.5]}, {"record": [["torque"]]}, r"^record must be a list of names, not \[\['torque'\]\]$"),
    ],
)
def test_what_is_of_the_wrong_kind_is_refused(parameters: Any, others: dict[str, Any], words: str) -> None:
    with pytest.raises(TypeError, match=words):
        sw.simulate_many(DRIVE, command(0.01), parameters, **others)


def test_outputs_may_be_listed_by_anything_that_goes_through_them() -> None:
    runs = sw.simulate_many(DRIVE, command(0.01), {"load.inertia": [0.5]}, record=(name for name in ("torque", "twist")))  # type: ignore[arg-type]
    assert list(runs.columns) == ["torque", "twist"]


def test_outputs_that_do_not_fit_into_memory_are_told_by_their_size(monkeypatch: pytest.MonkeyPatch) -> None:
    def exhausted(*arguments: object) -> None:
        raise MemoryError("std::bad_alloc")

    monkeypatch.setitem(ensemble.RUN_MEMBERS, "cpu", exhausted)
    with pytest.raises(MemoryError, match=r"^the outputs take 4e-06 GB; .*simulate_to"):  # 5 members, 100 samples, 8 bytes each
        sw.simulate_many(DRIVE, command(0.099), {"load.inertia": np.full(5, 0.5)}, record=["torque"], sample=1e-3)


# Members that fail

OUT_OF_DOMAIN = DRIVE.replace(
    gear=DRIVE.gear.replace(friction_input=sw.friction.PositionDependent(constant=0.03, domain_start=-50.0, domain_end=240.0))
)
RISE = command(0.1)
UNLIMITED = DRIVE.replace(control=DRIVE.control.replace(limit=1e30))
FAILING = {  # drive, path, a value that works, one that does not, how its reason begins
    "beyond its domain": (OUT_OF_DOMAIN, "gear.friction_input.domain_end", 50.0, 3.0, "gear.friction_input: angle = 3"),
    "too coarse a step at rest": (DRIVE, "gear.stiffness.a1", 1.2e4, 2e6, "dt = 0.0005 s is too coarse for this drive: "),
    "too coarse a step": (DRIVE, "gear.stiffness.a3", 1e9, 1e13, "dt = 0.0005 s is too coarse for this drive: "),
    "relation": (
        DRIVE.replace(gear=DRIVE.gear.replace(stiffness=made(sw.stiffness.ThreeSegment, t1=1.0, t2=20.0))),
        "gear.stiffness.t1",
        1.0,
        100.0,
        "three_segment: ",
    ),
    "diverged": (UNLIMITED, "control.integral", 1.0, 1e7, "the simulation diverged at t = "),
}
failing = pytest.mark.parametrize(("drive", "path", "good", "bad", "reason"), FAILING.values(), ids=FAILING)


@failing
def test_a_member_that_fails_is_told_and_disturbs_no_other(
    drive: sw.Drive, path: str, good: float, bad: float, reason: str, tmp_path: Path
) -> None:
    numbers, wrong = good * np.linspace(0.95, 1.05, 19), [3, 9, 18]  # in each of three packs one
    right = [member for member in range(19) if member not in wrong]
    undisturbed = sw.simulate_many(drive, RISE, {path: numbers[right]}, 5e-4)
    numbers[wrong] = bad
    arguments: tuple[Any, ...] = (drive, RISE, {path: numbers}, 5e-4)
    with pytest.warns(EnsembleWarning, match=rf"^3 of 19 members have no result; the first is member 3: {reason}") as told:
        runs = sw.simulate_many(*arguments)
    assert [warning.filename for warning in told] == [__file__]
    assert list(runs.failures) == wrong
    for name in runs.columns:
        assert np.array_equal(runs[name][right], undisturbed[name]), name
        assert np.isnan(runs[name][wrong]).all(), name
    with pytest.raises(ValueError, match=rf"^member 9 has no result: {reason}"):
        runs.member(9)
    with pytest.raises(ValueError, match=r"^member 19 is not among the 19 members, which count from 0$"):
        runs.member(19)
    with pytest.raises(TypeError, match=r"^member must be a whole number, not 9\.0$"):
        runs.member(9.0)  # type: ignore[arg-type]
    with pytest.warns(EnsembleWarning, match=r"^3 of 19 members have no result; the first is member 3: "):
        sw.simulation.simulate_to(tmp_path / "runs", *arguments)
    assert same_bits(sw.Ensemble.read(tmp_path / "runs"), runs)


@pytest.mark.parametrize("kind", FAILING)
def test_the_reason_is_that_of_the_member_alone(kind: str) -> None:
    drive, path, good, bad, _ = FAILING[kind]
    with pytest.warns(EnsembleWarning):
        reason = sw.simulate_many(drive, RISE, {path: [good, bad]}, 5e-4, record=OUTPUTS).failures[1]
    with pytest.raises((ValueError, FloatingPointError)) as alone:
        sw.simulate(with_parameters(drive, {path: bad}), RISE, 5e-4)
    assert str(alone.value) == reason


def test_a_member_of_which_nothing_that_is_recorded_diverged_is_told_too() -> None:
    drive, path, good, bad, _ = FAILING["diverged"]
    with pytest.warns(EnsembleWarning):
        runs = sw.simulate_many(drive, RISE, {path: [good, bad]}, 5e-4, record=["command"])
    said = "the simulation diverged; take a smaller dt (now 0.0005 s) or check the parameters"
    assert runs.failures == {1: said}
    isolated = DRIVE.replace(control=sw.control.OpenLoop(), motor=DRIVE.motor.replace(resistance=1e16))
    with pytest.warns(EnsembleWarning):  # of all outputs only the voltage is beyond all bounds
        runs = sw.simulate_many(isolated, RISE, {"control.gain": [1.0, 1e18]}, 5e-4, record=["torque"])
    assert runs.failures == {1: said}


# Progress and interruption


@pytest.mark.slow("simulation")
def test_progress_counts_the_steps_of_all_members(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    parameters = {"load.inertia": np.linspace(0.4, 0.6, 1200)}
    shares: list[float] = []
    others: dict[str, Any] = {"record": ["torque"], "sample": 1.0, "threads": 1}
    others["progress"] = lambda stage, share: shares.append(share)
    sw.simulate_many(DRIVE, command(2.0), parameters, **others)
    assert len(shares) >= 2
    assert shares == sorted(shares)
    assert 0.0 <= shares[0] < shares[-1] <= 1.0
    shares.clear()
    monkeypatch.setattr(ensemble, "PART_BYTES", 600 * 3 * 8)
    sw.simulation.simulate_to(tmp_path / "runs", DRIVE, command(2.0), parameters, **others)
    assert shares == sorted(shares)
    assert shares[0] < 0.5 <= shares[-1] <= 1.0


def test_a_progress_bar_changes_nothing() -> None:
    run = [sw.simulate_many(DRIVE, command(0.1), varied(), progress=wanted) for wanted in (True, False)]
    assert same_bits(*run)


def test_an_interrupt_ends_many_runs_on_their_way() -> None:
    with ctrl_c(), pytest.raises(KeyboardInterrupt):
        sw.simulate_many(DRIVE, command(10.0), {"load.inertia": np.full(100_000, 0.5)}, record=["torque"], sample=10.0)


# Files

INERTIA = np.linspace(0.4, 0.6, 40_000)
TO_FOLDER = """
import signal, sys
signal.signal(signal.SIGINT, signal.default_int_handler)
from strainwave.simulation import ensemble
from tests.python.simulation.test_ensemble import DRIVE, INERTIA, RISE
import strainwave as sw
ensemble.PART_BYTES = 1
sw.simulation.simulate_to(sys.argv[1], DRIVE, RISE, {"load.inertia": INERTIA}, threads=1)
"""


def stopped_half_way(folder: Path, how: signal.Signals) -> int:
    """A run to a folder in small parts, stopped when some are there; its exit status."""
    process = script(TO_FOLDER.replace("sys.argv[1]", repr(str(folder))))
    while len(list(folder.glob("members/part-*.parquet"))) < 5:
        assert process.poll() is None, process.communicate()
        time.sleep(0.01)
    process.send_signal(how)
    _, wrong = process.communicate(timeout=60)
    assert ("KeyboardInterrupt" in wrong) == (how == signal.SIGINT), wrong
    return process.returncode


@pytest.mark.slow("simulation")
@pytest.mark.parametrize("how", [signal.SIGINT, signal.SIGKILL])
def test_a_run_to_files_that_is_stopped_half_way_leaves_what_was_done(how: signal.Signals, tmp_path: Path) -> None:
    assert stopped_half_way(tmp_path / "runs", how) in (-how, 128 + how)
    runs = sw.Ensemble.read_partial(tmp_path / "runs")
    assert len(runs) == len(INERTIA)
    done = [member for member in range(len(INERTIA)) if member not in runs.failures]
    assert done == list(range(len(done)))
    assert 5 * 8 <= len(done) < len(INERTIA)
    alone = sw.simulate_many(DRIVE, RISE, {"load.inertia": INERTIA[: len(done)]})
    assert all(np.array_equal(runs[name][: len(done)], alone[name]) for name in alone.columns)
    if how == signal.SIGINT:  # which may clean up after itself
        assert not list((tmp_path / "runs").rglob(".*"))


@every_drive
def test_what_is_read_from_files_is_what_would_have_been_in_memory(
    drive: sw.Drive, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    arguments: dict[str, Any] = {"record": ["output_speed", "command"], "sample": 1e-3, "threads": 2}
    whole = sw.simulate_many(drive, SWING, varied(37), 5e-4, **arguments)
    monkeypatch.setattr(ensemble, "PART_BYTES", 1)
    assert sw.simulation.simulate_to(str(tmp_path), drive, SWING, varied(37), 5e-4, **arguments) == tmp_path
    assert [part.name for part in sorted((tmp_path / "samples").iterdir())] == [f"part-{i:06d}.parquet" for i in range(3)]
    assert same_bits(sw.Ensemble.read(tmp_path), whole)


def test_files_are_read_by_what_reads_folders_of_parquet(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(ensemble, "PART_BYTES", 1)
    sw.simulation.simulate_to(tmp_path, DRIVE, RISE, varied(20), record=["torque", "twist"], sample=1e-2, threads=1)
    whole = sw.simulate_many(DRIVE, RISE, varied(20), record=["torque", "twist"], sample=1e-2)
    samples = dataset.dataset(tmp_path / "samples").to_table()
    assert samples.schema.names == ["member", "time", "torque", "twist"]
    assert samples["member"].to_numpy().tolist() == np.repeat(np.arange(20), 11).tolist()
    assert samples["time"].to_numpy().tolist() == np.tile(whole.time, 20).tolist()
    assert np.array_equal(samples["twist"].to_numpy(), whole["twist"].ravel())
    units = {name: (samples.schema.field(name).metadata or {}).get(b"unit") for name in samples.schema.names}
    assert units == {"member": None, "time": b"s", "torque": b"N.m", "twist": b"rad"}
    members = dataset.dataset(tmp_path / "members").to_table()
    assert members.schema.names == ["member", *varied(), "failure"]
    assert members["gear.friction_input.coulomb"].to_numpy().tolist() == varied(20)["gear.friction_input.coulomb"].tolist()
    assert members["failure"].type == pyarrow.string()
    assert members["failure"].null_count == 20


def test_a_folder_that_is_not_empty_is_refused_and_left_alone(tmp_path: Path) -> None:
    (tmp_path / "notes.txt").write_text("mine")
    with pytest.raises(FileExistsError, match=r" is not empty; take another folder, or move what is there$"):
        sw.simulation.simulate_to(tmp_path, DRIVE, RISE, varied())
    assert [path.name for path in tmp_path.iterdir()] == ["notes.txt"]
    assert (tmp_path / "notes.txt").read_text() == "mine"


def test_a_folder_without_an_ensemble_is_refused(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match=r" holds no ensemble: there is no "):
        sw.Ensemble.read(tmp_path)


MEMORY = """
import tempfile
from strainwave.simulation import ensemble
from tests.python.simulation.test_ensemble import DRIVE, OUTPUTS, RISE, most_memory, varied
import strainwave as sw
from strainwave.simulation.signals import outputs
ensemble.PART_BYTES = 1 << 20
for members in (256, 2048):
    with tempfile.TemporaryDirectory() as folder:
        sw.simulation.simulate_to(folder + "/runs", DRIVE, RISE, varied(members), record=OUTPUTS, threads=1)
    print(most_memory())
"""


def most_memory() -> int:
    """The most that this process has held at once [B]. Linux counts in rusage what its parent held, too."""
    status = Path("/proc/self/status")
    if status.exists():
        (held,) = re.findall(r"^VmHWM:\s*(\d+) kB$", status.read_text(), re.MULTILINE)
        return 1024 * int(held)
    resource = pytest.importorskip("resource")
    return int(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss)  # macOS counts in bytes


@pytest.mark.slow("simulation")
def test_memory_does_not_grow_with_the_members() -> None:
    """In memory, the members that are more here would take 115 MB."""
    told, wrong = script(MEMORY).communicate(timeout=60)
    assert wrong == ""
    few, many = map(int, told.split())
    in_memory = (2048 - 256) * 501 * len(OUTPUTS) * 8
    assert many - few < 0.15 * in_memory


def test_parts_hold_whole_packs_for_every_thread(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setattr(ensemble, "PART_BYTES", 8 * 3 * 501 * 50)  # 50 members fit
    sw.simulation.simulate_to(tmp_path, DRIVE, RISE, varied(100), threads=3)
    counts = [len(dataset.dataset(part).to_table()) for part in sorted((tmp_path / "members").iterdir())]
    assert counts == [48, 48, 4]
