"""Kernels of drives: the same bits as the general drive, compiled when that pays, and done without where that fails."""

from __future__ import annotations

import os
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
import strainwave as sw
from numpy.typing import NDArray
from strainwave import _core
from strainwave.native import kernels
from strainwave.native.cache import KernelWarning, find_kernel, make_kernel
from strainwave.native.kernel import Kernel
from strainwave.native.static_type import in_words
from strainwave.simulation.excitation import Excitation
from strainwave.simulation.run import differentiate

from tests.support.reference_drive import DRIVE, command

Array = NDArray[np.float64]
STEP = 2e-4

# Laws within laws, a controller that samples, sensors that differ, and bodies within the gear.
NESTED = sw.Drive(
    gear=sw.Gear(
        stiffness=sw.stiffness.Backlash(law=sw.stiffness.Cubic(a1=1.2e4, a3=1e9), clearance=1e-5),
        hysteresis=sw.hysteresis.Preisach(density=sw.hysteresis.PowerDensity(limit=2e-3, saturation=3.0, exponent=2.0)),
        friction_input=sw.friction.Thermal(
            law=sw.friction.Cyclic(law=DRIVE.gear.friction_input, order=[2], amplitude=[0.2], phase=[0.0]), viscous_fall=0.02
        ),
        friction_output=sw.friction.Coulomb(coulomb=0.5, breakaway=0.7, viscous=0.1),
        kinematic_error=sw.kinematic_error.Scaled(law=DRIVE.gear.kinematic_error),
        damping=10.0,
    ),
    motor=sw.motor.DC(resistance=0.5, inductance=5e-4, torque_constant=0.1, back_emf=0.1, inertia=1e-4),
    control=sw.control.Sampled(law=sw.control.Cascade(), period=1e-3, delay=2e-4),
    load=sw.loads.Pendulum(inertia=0.5, gravity_torque=15.0),
    sensors=sw.Sensors(
        input_speed=sw.sensor.Noisy(law=sw.sensor.FirstOrder(time_constant=1e-3), amplitude=0.02, bandwidth=100.0, seed=7),
        output_angle=sw.sensor.Delayed(law=sw.sensor.Encoder(counts=8192), delay=2e-3),
    ),
    thermal=sw.thermal.Heating(winding_capacity=100.0, winding_resistance=1.0, gear_capacity=500.0, gear_resistance=1.0),
    meter=sw.meter.EnergyMeter(),
)


MOTION = np.column_stack([np.linspace(-40.0, 40.0, 50), np.linspace(-100.0, 100.0, 50), np.full(50, 30.0), np.full(50, 1e-3)])
ACTING = np.tile([0.0, 0.0, 2.0, 0.0, 300.0, 0.0], (50, 1))  # command, input of the load and temperature, with their rates

KEPT = os.environ["STRAINWAVE_KERNELS"]  # between runs of the tests


@pytest.fixture(autouse=True)
def _general_drive(monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    """Each test begins and ends without kernels, and with nothing counted; those compiled before are there."""
    monkeypatch.setenv("STRAINWAVE_KERNELS", KEPT)
    for drive in (DRIVE, NESTED):
        _core.forget_kernels(drive)
    kernels.forget_work()
    yield
    for drive in (DRIVE, NESTED):
        _core.forget_kernels(drive)


def results(drive: sw.Drive) -> dict[str, list[Array]]:
    """What each job gives."""
    asked, inertias = command(0.05), {"load.inertia": np.linspace(0.4, 0.6, 5)}
    numbers = [0, 3, 5, 7, 8]
    runs = [sw.simulate(drive, asked, STEP, method=method) for method in ("exponential", "rosenbrock", "moreau_jean")]
    many = sw.simulate_many(drive, asked, inertias, STEP, record=["torque", "output_angle"])
    recording, slopes = differentiate(drive, Excitation(asked), numbers, STEP, 1e-3)
    return {
        "simulate": [column for run in runs for column in run.columns.values()],
        "simulate_adaptively": [*sw.simulate_adaptively(drive, asked, 1e-6).columns.values()],
        "simulate_many": [*many.columns.values()],
        "differentiate": [*recording.columns.values(), slopes],
        "inverse_dynamics": [*_core.inverse_dynamics(drive, MOTION, ACTING, numbers)],
    }


@pytest.mark.slow("native")
@pytest.mark.parametrize("drive", [DRIVE, NESTED], ids=["reference", "nested"])
def test_a_kernel_gives_the_bits_of_the_general_drive(drive: sw.Drive) -> None:
    general = results(drive)
    if drive is DRIVE:  # one kernel a job, which other tests need, too
        for job in kernels.JOBS:
            kernels.load_or_raise(drive, job)
    else:
        kernel = Kernel(kernels.source(drive, kernels.JOBS), "all", in_words(drive))  # one source takes half the time of five
        kernels.use(drive, find_kernel(kernel) or make_kernel(kernel))
    assert _core.loaded_jobs(drive) == list(kernels.JOBS)
    for job, found in results(drive).items():
        assert len(found) == len(general[job])
        assert all(np.array_equal(one, other) for one, other in zip(found, general[job], strict=True)), job


def test_a_kernel_does_its_job_for_drives_of_the_same_laws_alone() -> None:
    kernels.load_or_raise(DRIVE, "simulate")
    assert _core.loaded_jobs(DRIVE.replace({"load.inertia": 0.7})) == ["simulate"]
    assert _core.loaded_jobs(DRIVE.replace(load=sw.loads.Inertia(inertia=0.5))) == []


@pytest.fixture
def asked(monkeypatch: pytest.MonkeyPatch) -> list[bool]:
    """Whether each load that `prepare` asks for may compile."""
    calls: list[bool] = []

    def load(drive: sw.Drive, job: kernels.Job, *, compile_it: bool) -> bool:
        calls.append(compile_it)
        return False

    monkeypatch.setattr(kernels, "load", load)
    return calls


@pytest.fixture
def step_seconds(monkeypatch: pytest.MonkeyPatch) -> float:
    """Return the typical time of a step [s] of every job; a compilation takes 1 s."""
    monkeypatch.setattr(kernels, "STEP_SECONDS", dict.fromkeys(kernels.JOBS, 1e-5))
    monkeypatch.setattr(kernels, "COMPILE_SECONDS", dict.fromkeys(kernels.JOBS, 1.0))
    return 1e-5


def steps_of(seconds: float, step_seconds: float) -> float:
    """Return the steps that take so long [s], and a little more."""
    return 1.001 * seconds / step_seconds


WORTH_IT = 1.0 / kernels.SAVED_SHARE  # s of the general drive, for a compilation of 1 s


def test_short_work_asks_for_no_kernel(asked: list[bool], step_seconds: float) -> None:
    kernels.prepare(DRIVE, "simulate", 0.99 * kernels.LOOK_UP_SECONDS / step_seconds)
    assert asked == []


def test_longer_work_looks_a_kernel_up_once_and_long_work_compiles_it(asked: list[bool], step_seconds: float) -> None:
    for _ in range(3):
        kernels.prepare(DRIVE, "simulate", steps_of(kernels.LOOK_UP_SECONDS, step_seconds))
    assert asked == [False]
    kernels.prepare(DRIVE, "simulate", steps_of(WORTH_IT, step_seconds))
    assert asked == [False, True]


def test_work_that_comes_in_many_pieces_is_long_work(asked: list[bool], step_seconds: float) -> None:
    pieces = 10
    for _ in range(pieces + 1):
        kernels.prepare(DRIVE, "differentiate", steps_of(WORTH_IT, step_seconds) / pieces)
        kernels.note(DRIVE, "differentiate", steps_of(WORTH_IT, step_seconds) / pieces)
    assert asked == [False, True, True]


def test_jobs_and_laws_are_counted_apart(asked: list[bool], step_seconds: float) -> None:
    steps = 0.6 * steps_of(WORTH_IT, step_seconds)
    for drive, job in ((DRIVE, "simulate"), (DRIVE, "simulate_many"), (NESTED, "simulate")):
        kernels.prepare(drive, job, steps)
        kernels.note(drive, job, steps)
    assert asked == [False] * 3


@pytest.mark.parametrize(("slowness", "compiled"), [(1.0, False), (3.0, True), (0.3, False)])
def test_measured_steps_decide_what_a_kernel_saves(
    slowness: float, compiled: bool, asked: list[bool], step_seconds: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    measured, ahead = kernels.TYPICAL_STEPS, 0.7 * steps_of(WORTH_IT, step_seconds)
    instants = iter([0.0, slowness * step_seconds * measured])
    monkeypatch.setattr(kernels, "_clock", lambda: next(instants))
    with kernels.prepared(DRIVE, "simulate", measured):
        pass
    kernels.prepare(DRIVE, "simulate", ahead)
    assert asked == [False] + [True] * compiled
    assert kernels.pays(DRIVE, "simulate", ahead) == compiled


def test_a_job_whose_kernel_compiles_for_longer_needs_more_work(monkeypatch: pytest.MonkeyPatch, step_seconds: float) -> None:
    steps = steps_of(WORTH_IT, step_seconds)
    assert kernels.pays(DRIVE, "simulate", steps)
    monkeypatch.setitem(kernels.COMPILE_SECONDS, "simulate", 1.1)
    assert not kernels.pays(DRIVE, "simulate", steps)


def test_an_ensemble_compiles_its_kernel_and_announces_it(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setitem(kernels.COMPILE_SECONDS, "simulate_many", 1e-3)
    monkeypatch.setattr(kernels, "LOOK_UP_SECONDS", 1e-4)
    inertias = {"load.inertia": np.linspace(0.4, 0.6, 5)}
    sw.simulate_many(DRIVE, command(0.05), inertias, STEP)
    assert _core.loaded_jobs(DRIVE) == ["simulate_many"]
    said = capsys.readouterr().err
    assert said in ("", "strainwave: compiling a kernel of this drive for simulate_many, once; it takes some seconds\n")


def test_a_file_that_cannot_be_loaded_is_done_without(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    broken = tmp_path / "kernel.so"
    broken.write_bytes(b"no shared object")
    monkeypatch.setattr("strainwave.native.cache.find_kernel", lambda kernel: broken)
    with pytest.warns(KernelWarning, match="cannot be loaded"):
        assert not kernels.load(DRIVE, "simulate", compile_it=False)
    assert _core.loaded_jobs(DRIVE) == []


def test_a_library_without_a_kernel_is_done_without(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("strainwave.native.cache.find_kernel", lambda kernel: Path(_core.__file__))
    with pytest.warns(KernelWarning, match="cannot be loaded"):
        assert not kernels.load(DRIVE, "simulate", compile_it=False)
    assert _core.loaded_jobs(DRIVE) == []


def test_a_process_that_began_before_an_update_of_the_package_uses_no_kernel(monkeypatch: pytest.MonkeyPatch) -> None:
    """Kernels of the headers that are there now would not fit the extension in use."""
    kernels.load_or_raise(DRIVE, "simulate")
    _core.forget_kernels(DRIVE)
    monkeypatch.setattr(kernels, "_CORE_IN_USE", (0, 0, 0))
    with pytest.warns(KernelWarning, match="restart the process"):
        assert not kernels.load(DRIVE, "simulate", compile_it=True)
    with pytest.raises(OSError, match="restart the process"):
        kernels.load_or_raise(DRIVE, "simulate")
    assert _core.loaded_jobs(DRIVE) == []


@pytest.mark.slow("native")
def test_an_ensemble_goes_on_by_its_kernel_if_that_is_forgotten_meanwhile() -> None:
    kernels.load_or_raise(DRIVE, "simulate_many")
    steps, members = 8000, 1000  # so many that progress is reported
    reports: list[int] = []

    def forget(done: int) -> None:
        reports.append(done)
        _core.forget_kernels(DRIVE)

    inputs = np.zeros((steps, 3, 6))
    inputs[..., 4] = 300.0
    inertia = np.full((1, members), _core.parts(DRIVE)[2][0])
    out = np.empty((1, members, 1))
    _core.simulate_many(
        DRIVE, [0], inertia, None, STEP * np.arange(steps + 1.0), inputs, np.zeros(steps, np.uint8), [5], np.inf, 2, out, forget
    )
    assert reports
    assert _core.loaded_jobs(DRIVE) == []
    assert np.isfinite(out).all()


def test_without_a_compiler_the_general_drive_goes_on_and_says_so_once(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setenv("STRAINWAVE_KERNELS", str(tmp_path / "kernels"))
    monkeypatch.setenv("PATH", str(tmp_path))
    monkeypatch.delenv("CXX", raising=False)
    monkeypatch.setattr("strainwave.native.compilers.zig_program", lambda: None)
    monkeypatch.setitem(kernels.COMPILE_SECONDS, "simulate_many", 1e-3)
    monkeypatch.setattr(kernels, "LOOK_UP_SECONDS", 1e-4)
    inertias = {"load.inertia": np.linspace(0.4, 0.6, 5)}
    with pytest.warns(KernelWarning, match=r"no C\+\+20 compiler"):
        first = sw.simulate_many(DRIVE, command(0.05), inertias, STEP)
    second = sw.simulate_many(DRIVE, command(0.05), inertias, STEP)  # a second warning would be an error
    assert np.array_equal(first["torque"], second["torque"])
    assert capsys.readouterr().err == ""  # nothing is announced
