"""The step of a drive as firmware compiles it: single precision, for size, without exceptions and run-time types."""

from __future__ import annotations

import subprocess
from collections.abc import Callable
from pathlib import Path

import pytest

from tests.support.cplusplus import HEADERS, INCLUDE_FOLDER, compilation, compiled_before, compiler, drives, zig

STEP = """
using Drive{number} = {drive};
extern "C" void step_{number}(const Drive{number}* drive, Drive{number}::State* state,
                              strainwave::integrate::Steps<float, Drive{number}>* steps,
                              const strainwave::Interval<strainwave::Input<float>>* input, float dt) {{
    *state = strainwave::step(*drive, *state, *input, dt, *steps);
}}
"""
STEPS = {f"step_{i}.cpp": STEP.format(number=i, drive=drive) for i, drive in enumerate(drives("float"))}

FIRMWARE = (
    *("-std=c++20", "-Os", "-ffreestanding", "-fno-exceptions", "-fno-rtti", "-fno-asynchronous-unwind-tables"),
    *("-ffp-contract=off", "-ffunction-sections", "-Wall", "-Wextra", "-Werror", "-Wdouble-promotion", f"-I{INCLUDE_FOLDER}"),
)
# A Cortex-M4, whose floating-point unit knows single precision only: double would call a routine by name.
CORTEX = ("-target", "thumb-linux-musleabihf", "-mcpu=cortex_m4+vfp4d16sp", "-fno-unwind-tables")
# A memory of turning points, bodies within the gear, eight branches of its material, four sections of delay in each of six
# sensors: these states have half as many numbers again as those of a plain drive, or twice as many, and every stage of a step
# holds some. The charts of two splines' teeth are as large while a step arranges their waves.
LARGE = (
    *("hysteresis::Preisach", "structure::Staged", "material::GeneralisedMaxwell", "sensor::Delayed"),
    "kinematic_error::ToothErrors",
)
# Measured at most: 30 848 B of stack with three of these, 35 395 B of code with bodies.
STACK, STACK_OF_LARGE = 20 * 1024, 6 * 1024  # B; the former with laws that modulate others at all three places
CODE, CODE_OF_BODIES = 32 * 1024, 4 * 1024  # B; the latter for bodies within the gear, a bearing's balls and a material
LIBM = {"atanf", "cosf", "expf", "logf", "rintf", "sinf", "sincosf", "sqrtf"}


def printed(*command: str | Path) -> list[str]:
    return subprocess.run(command, capture_output=True, text=True, check=True).stdout.splitlines()


def undefined(folder: Path) -> set[str]:
    """What the object files in a folder ask of others."""
    lines = printed("nm", "--undefined-only", "--format=posix", "--quiet", *folder.glob("*.o"))
    return {line.split()[0] for line in lines if len(line.split()) > 1}


@pytest.fixture(scope="module")
def programs(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Object files with the step of one drive each; the drives hold every model between them."""
    folder = tmp_path_factory.mktemp("firmware")
    before = compiled_before(compiler("g++"), folder, HEADERS, *FIRMWARE)
    assert compilation(compiler("g++"), folder, STEPS, *FIRMWARE, *before, "-fstack-usage") == (0, "")
    assert len(list(folder.glob("*.o"))) == len(STEPS)
    return folder


@pytest.mark.slow("export")
def test_a_step_asks_for_mathematics_and_nothing_else(programs: Path) -> None:
    """No heap, no exception, no initialisation, not even a routine that copies."""
    assert undefined(programs) <= LIBM


@pytest.mark.slow("export")
def test_a_step_on_a_microcontroller_is_in_single_precision_throughout(tmp_path: Path) -> None:
    """Clang copies and clears a state by calling memcpy and memset, which every freestanding environment has to provide."""
    assert compilation(zig(), tmp_path, {"steps.cpp": HEADERS + "".join(STEPS.values())}, *CORTEX, *FIRMWARE) == (0, "")
    assert undefined(tmp_path) <= LIBM | {"memcpy", "memset"}


@pytest.mark.slow("export")
def test_the_stack_of_a_step_is_known_and_small(programs: Path, record_property: Callable[[str, object], None]) -> None:
    """The sum over all functions of a drive bounds the deepest chain of calls, as none calls itself."""
    for usage in programs.glob("*.su"):
        frames = [line.rsplit("\t", 2) for line in usage.read_text().splitlines()]
        assert {kind for _, _, kind in frames} <= {"static", "dynamic,bounded"}
        stack = sum(int(size) for _, size, _ in frames)
        record_property(f"stack_bytes_at_most_{usage.stem}", stack)
        large = sum(model in STEPS[f"{usage.stem}.cpp"] for model in LARGE)
        assert 0 < stack < STACK + large * STACK_OF_LARGE


@pytest.mark.slow("export")
def test_the_code_of_a_step_fits_a_microcontroller(programs: Path, record_property: Callable[[str, object], None]) -> None:
    for program in programs.glob("*.o"):
        symbols = [line.split() for line in printed("nm", "--print-size", "--defined-only", program) if len(line.split()) == 4]
        code = sum(int(size, 16) for _, size, kind, _ in symbols if kind in "tTwW")
        record_property(f"code_bytes_{program.stem}", code)
        bodies = "structure::Staged" in STEPS[f"{program.stem}.cpp"]
        assert 0 < code < CODE + bodies * CODE_OF_BODIES
        assert not [name for *_, kind, name in symbols if kind in "bBdD"]  # no variable outlives a step
