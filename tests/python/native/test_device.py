"""Ensembles on a GPU. Here the code of the device runs on the processor, thread after thread, in memory of the processor."""

from __future__ import annotations

import ctypes
import subprocess
from contextlib import ExitStack
from functools import cache
from pathlib import Path
from tempfile import mkdtemp
from typing import Any

import numpy as np
import pytest
import strainwave as sw
from strainwave.native import device
from strainwave.native.static_type import Scalar

from tests.support.cplusplus import compiler
from tests.support.strategies import made

ON_THE_PROCESSOR = """
#define __global__
static struct { int x; } blockIdx, blockDim{1}, threadIdx;
"""
PARAMETERS = (
    "const int* shape, const S* numbers, int number_count, const S* starts, int start_count, const double* instants, "
    "const double* inputs, const std::uint8_t* keep, std::size_t steps, double max_rate, const int* recorded, "
    "int recorded_count, S* out, double* tally, int members"
)
THREAD_AFTER_THREAD = f"""
extern "C" void run_all({PARAMETERS}) {{
    for (blockIdx.x = 0; blockIdx.x < members; ++blockIdx.x)
        {device.ENTRY}(shape, numbers, number_count, starts, start_count, instants, inputs, keep, steps, max_rate, recorded,
                       recorded_count, out, tally, members);
}}
"""
DRIVE = sw.Drive(
    gear=sw.Gear(
        kinematic_error=sw.kinematic_error.Fourier(order=[2.0], amplitude=[5e-4], phase=[0.3]),
        friction_input=made(sw.friction.LuGre),
        stiffness=sw.stiffness.Cubic(a1=5e3, a3=1e8),
    ),
    load=sw.loads.Inertia(inertia=0.01),
)
INERTIA = np.linspace(0.01, 0.02, 7)
STEP = sw.scenario.step(amplitude=5.0, duration=0.2)


@cache
def library(drive: sw.Drive, scalar: Scalar) -> ctypes.CDLL:
    """The code of the device, compiled for the processor."""
    folder = Path(mkdtemp())
    (folder / "device.cpp").write_text(ON_THE_PROCESSOR + device.source(drive, scalar) + THREAD_AFTER_THREAD)
    flags = "-std=c++20", "-O1", "-ffp-contract=off", "-shared", "-fPIC", "-w", f"-I{device.INCLUDE_FOLDER}"
    subprocess.run([*compiler("g++"), *flags, "device.cpp", "-o", "device.so"], cwd=folder, check=True)
    return ctypes.CDLL(str(folder / "device.so"))


class Processor:
    """The processor as a device with little memory, so that members need several launches."""

    memory = 1 << 15  # bytes
    launches = 0

    def __init__(self, stack: ExitStack, drive: sw.Drive, scalar: Scalar) -> None:
        self.stack, self.library = stack, library(drive, scalar)
        self.scalar = np.float32 if scalar == "float" else np.float64

    def free_bytes(self) -> int:
        return self.memory

    def empty(self, stack: ExitStack, count: int, scalar: Any) -> Any:
        return np.full(count, 7, scalar)

    def put(self, stack: ExitStack, values: Any, scalar: Any) -> Any:
        return np.ascontiguousarray(values, scalar)

    def get(self, buffer: Any, shape: tuple[int, ...], scalar: Any) -> Any:
        return buffer.reshape(shape)

    def launch(self, members: int, *arguments: Any) -> None:
        Processor.launches += 1
        kinds = {np.int32: ctypes.c_int32, np.uint64: ctypes.c_uint64, np.float64: ctypes.c_double}
        self.library.run_all(*(each.ctypes if isinstance(each, np.ndarray) else kinds[type(each)](each) for each in arguments))


@pytest.fixture(autouse=True)
def on_the_processor(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(device, "_Device", Processor)
    monkeypatch.setattr(Processor, "launches", 0)


def ensemble(backend: Any, **changed: Any) -> sw.Ensemble:
    parameters = changed.pop("parameters", {"load.inertia": INERTIA})
    return sw.simulate_many(DRIVE, STEP, parameters, sample=1e-3, backend=backend, **changed)


@pytest.mark.slow("native")
@pytest.mark.parametrize("initial", [None, {"input_speed": np.linspace(0.0, 3.0, 7)}])
def test_a_device_gives_the_numbers_of_the_processor_in_several_launches(initial: Any) -> None:
    assert ensemble("gpu", initial=initial) == ensemble("cpu", initial=initial)
    assert Processor.launches > 1


@pytest.mark.slow("native")
def test_single_precision_follows_to_its_digits() -> None:
    single, double = ensemble("gpu-float"), ensemble("cpu")
    for name, values in double.columns.items():
        assert np.abs(single[name] - values).max() <= 1e-4 * np.abs(values).max()
        assert not (single[name] == values).all()


def test_members_without_result_say_why_as_on_the_processor() -> None:
    """One is too stiff for the steps, one has no valid numbers together, and others are sound."""
    parameters = {"gear.stiffness.a1": np.array([5e3, 1e14, 4e3]), "motor.inertia": np.array([1e-4, 1e-4, 0.0])}
    parameters["gear.input_inertia"] = np.array([1e-5, 1e-5, 0.0])
    with pytest.warns(sw.simulation.EnsembleWarning):
        found = ensemble("gpu", parameters=parameters)
    with pytest.warns(sw.simulation.EnsembleWarning):
        expected = ensemble("cpu", parameters=parameters)
    assert set(expected.failures) == {1, 2}
    assert found == expected


def test_a_device_too_small_for_a_member_says_so(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(Processor, "memory", 1 << 10)
    with pytest.raises(ValueError, match="record fewer outputs, or sample less often"):
        ensemble("gpu")


def test_a_gpu_gives_the_numbers_of_the_processor(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.undo()
    try:
        found = ensemble("gpu")
    except OSError as error:
        pytest.skip(str(error))
    assert found == ensemble("cpu")


def test_without_a_gpu_one_line_says_what_to_do(monkeypatch: pytest.MonkeyPatch) -> None:
    def no_driver() -> None:
        raise RuntimeError("no driver")

    monkeypatch.undo()
    monkeypatch.setattr("cuda.core.Device", no_driver)
    with pytest.raises(
        OSError, match=r'no GPU that CUDA can use was found \(no driver\); run on the processor by backend="cpu"'
    ):
        ensemble("gpu")


def test_an_unknown_backend_is_refused() -> None:
    with pytest.raises(ValueError, match="backend"):
        ensemble("tpu")
