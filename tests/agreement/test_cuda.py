"""The headers as they are, compiled for a CUDA target; that takes NVRTC but no GPU."""

from __future__ import annotations

from typing import Any

import pytest
import strainwave as sw
from strainwave.native import device, nvrtc
from strainwave.native.compilers import CompileError

from tests.support.cplusplus import HEADERS, drives
from tests.support.strategies import made

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
pytestmark = pytest.mark.skipif(not nvrtc.is_installed(), reason="the package nvidia-cuda-nvrtc is not installed")
OPTIONS = ("--gpu-architecture=compute_90", f"--include-path={device.INCLUDE_FOLDER}")
# As much is checked as on the way to PTX, which takes a second a drive even if nothing is optimised, and minutes if all is.
INTERMEDIATE = ("-dlto", "--relocatable-device-code=true")
NOT_OPTIMISED = ("--device-debug",)


def kernels(scalar: str) -> list[str]:
    return [KERNEL.format(number=i, drive=drive, scalar=scalar) for i, drive in enumerate(drives(scalar))]


@pytest.mark.slow("physics")
@pytest.mark.parametrize("scalar", ["double", "float"])
def test_every_model_steps_in_a_cuda_kernel(scalar: str) -> None:
    assert nvrtc.compiled(HEADERS + "".join(kernels(scalar)), *OPTIONS, *INTERMEDIATE)[1] == ""


@pytest.mark.slow("physics")
@pytest.mark.parametrize("scalar", ["double", "float"])
def test_a_cuda_kernel_becomes_code_of_a_device(scalar: str) -> None:
    ptx, log = nvrtc.compiled(HEADERS + kernels(scalar)[0], *OPTIONS, *NOT_OPTIMISED)
    assert log == ""
    assert ".entry run_0(" in ptx


@pytest.mark.parametrize("scalar", ["double", "float"])
def test_an_ensemble_runs_in_a_cuda_kernel(scalar: Any) -> None:
    gear = sw.Gear(hysteresis=made(sw.hysteresis.MaxwellSlip), friction_input=made(sw.friction.LuGre))
    source = device.source(sw.Drive(gear=gear, load=sw.loads.Inertia(inertia=0.01)), scalar)
    assert nvrtc.compiled(source, *OPTIONS, *INTERMEDIATE)[1] == ""


FORGETFUL = """
template <class S> struct Forgetful { constexpr S torque(S speed) const { return speed * typename S::Unheard{}; } };
extern "C" __global__ void run(double* speed) { *speed = Forgetful<double>{}.torque(*speed); }
"""


@pytest.mark.parametrize("options", [INTERMEDIATE, NOT_OPTIMISED])
@pytest.mark.parametrize("source", ["strainwave::Unheard of;", FORGETFUL], ids=["at once", "in a template"])
def test_what_does_not_compile_is_told(source: str, options: tuple[str, ...]) -> None:
    with pytest.raises(CompileError, match="NVRTC reports") as raised:
        nvrtc.compiled(HEADERS + source, *OPTIONS, *options)
    assert "Unheard" in raised.value.output
