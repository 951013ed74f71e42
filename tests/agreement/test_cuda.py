"""The headers as they are, compiled for a CUDA target; that takes NVRTC but no GPU."""

from __future__ import annotations

import ctypes
from importlib import metadata
from typing import Any

import pytest
import strainwave as sw
from strainwave.native import device

from tests.cplusplus import HEADERS, drives
from tests.strategies import made

KERNEL = """
extern "C" __global__ void run_{number}(const {drive}* drive, {drive}::State* state,
                                        const strainwave::Interval<strainwave::Input<{scalar}>>* input,
                                        int members, int steps, {scalar} dt) {{
    const int i = blockIdx.x * blockDim.x + threadIdx.x;
    if (i >= members) return;
    auto x = state[i];
    for (int k = 0; k < steps; ++k) x = strainwave::step(drive[i], x, input[k], dt);
    state[i] = x;
}}
"""
OPTIONS = (
    "--std=c++20",
    "--device-as-default-execution-space",
    "--gpu-architecture=compute_90",
    f"--include-path={device.INCLUDE}",
)
# As much is checked as on the way to PTX, which takes a second a drive even if nothing is optimised, and minutes if all is.
INTERMEDIATE = ("-dlto", "--relocatable-device-code=true")
NOT_OPTIMISED = ("--device-debug",)


@pytest.fixture(scope="module")
def nvrtc() -> ctypes.CDLL:
    """The library of the package nvidia-cuda-nvrtc."""
    try:
        files = metadata.files("nvidia-cuda-nvrtc") or []
    except metadata.PackageNotFoundError:
        pytest.skip("the package nvidia-cuda-nvrtc is not installed")
    return ctypes.CDLL(str(next(file.locate() for file in files if file.name.startswith("libnvrtc.so"))))


def compilation(nvrtc: ctypes.CDLL, source: str, *further: str) -> tuple[int, str, str]:
    """What NVRTC makes of a source: its result (0 is success), its log and the PTX."""
    program, size = ctypes.c_void_p(), ctypes.c_size_t()
    assert nvrtc.nvrtcCreateProgram(ctypes.byref(program), source.encode(), b"kernels.cu", 0, None, None) == 0
    options = [option.encode() for option in (*OPTIONS, *further)]
    result = nvrtc.nvrtcCompileProgram(program, len(options), (ctypes.c_char_p * len(options))(*options))
    texts = []
    for kind in ("ProgramLog", "PTX"):
        nvrtc[f"nvrtcGet{kind}Size"](program, ctypes.byref(size))
        text = ctypes.create_string_buffer(size.value + 1)
        nvrtc[f"nvrtcGet{kind}"](program, text)
        texts.append(text.value.decode())
    nvrtc.nvrtcDestroyProgram(ctypes.byref(program))
    return result, *texts


def kernels(scalar: str) -> list[str]:
    return [KERNEL.format(number=i, drive=drive, scalar=scalar) for i, drive in enumerate(drives(scalar))]


@pytest.mark.parametrize("scalar", ["double", "float"])
def test_every_model_steps_in_a_cuda_kernel(nvrtc: ctypes.CDLL, scalar: str) -> None:
    assert compilation(nvrtc, HEADERS + "".join(kernels(scalar)), *INTERMEDIATE)[:2] == (0, "")


@pytest.mark.parametrize("scalar", ["double", "float"])
def test_a_cuda_kernel_becomes_code_of_a_device(nvrtc: ctypes.CDLL, scalar: str) -> None:
    result, log, ptx = compilation(nvrtc, HEADERS + kernels(scalar)[0], *NOT_OPTIMISED)
    assert (result, log) == (0, "")
    assert ".entry run_0(" in ptx


@pytest.mark.parametrize("scalar", ["double", "float"])
def test_an_ensemble_runs_in_a_cuda_kernel(nvrtc: ctypes.CDLL, scalar: Any) -> None:
    gear = sw.Gear(hysteresis=made(sw.hysteresis.MaxwellSlip), friction_input=made(sw.friction.LuGre))
    source = device.source(sw.Drive(gear=gear, load=sw.loads.Inertia(inertia=0.01)), scalar)
    assert compilation(nvrtc, source, *INTERMEDIATE)[:2] == (0, "")


FORGETFUL = """
template <class S> struct Forgetful { constexpr S torque(S speed) const { return speed * typename S::Unheard{}; } };
extern "C" __global__ void run(double* speed) { *speed = Forgetful<double>{}.torque(*speed); }
"""


@pytest.mark.parametrize("options", [INTERMEDIATE, NOT_OPTIMISED])
@pytest.mark.parametrize("source", ["strainwave::Unheard of;", FORGETFUL], ids=["at once", "in a template"])
def test_what_does_not_compile_is_told(nvrtc: ctypes.CDLL, source: str, options: tuple[str, ...]) -> None:
    result, log, _ = compilation(nvrtc, HEADERS + source, *options)
    assert result != 0
    assert "Unheard" in log
