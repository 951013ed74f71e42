"""The step of a drive as firmware compiles it: single precision, for size, without exceptions and run-time types."""

from __future__ import annotations

import subprocess
from collections.abc import Callable
from pathlib import Path

import pytest

from tests.cplusplus import HEADERS, INCLUDE, compilation, compiler, drives, zig

STEP = """
extern "C" void step_{number}(const {drive}* drive, {drive}::State* state,
                              const strainwave::Interval<float>* input, float dt) {{
    *state = strainwave::step(*drive, *state, *input, dt);
}}
"""
SOURCE = HEADERS + "".join(STEP.format(number=i, drive=drive) for i, drive in enumerate(drives("float")))

FIRMWARE = (
    *("-std=c++20", "-Os", "-ffreestanding", "-fno-exceptions", "-fno-rtti", "-fno-asynchronous-unwind-tables"),
    *("-ffp-contract=off", "-ffunction-sections", "-Wall", "-Wextra", "-Werror", "-Wdouble-promotion", f"-I{INCLUDE}"),
)
# A Cortex-M4, whose floating-point unit knows single precision only: double would call a routine by name.
CORTEX = ("-target", "thumb-linux-musleabihf", "-mcpu=cortex_m4+vfp4d16sp", "-fno-unwind-tables")
LIBM = {"cosf", "expf", "rintf", "sinf", "sincosf", "sqrtf"}


def printed(*command: str | Path) -> list[str]:
    return subprocess.run(command, capture_output=True, text=True, check=True).stdout.splitlines()


def undefined(program: Path) -> set[str]:
    """What an object file asks of others."""
    return {line.split()[0] for line in printed("nm", "--undefined-only", "--format=posix", program)}


@pytest.fixture(scope="module")
def program(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """An object file with a step function for each of the drives that hold every model between them."""
    folder = tmp_path_factory.mktemp("firmware")
    assert compilation(compiler("g++"), folder, {"firmware.cpp": SOURCE}, *FIRMWARE, "-fstack-usage") == (0, "")
    return folder / "firmware.o"


def test_a_step_asks_for_mathematics_and_nothing_else(program: Path) -> None:
    """No heap, no exception, no initialisation, not even a routine that copies."""
    assert undefined(program) <= LIBM


def test_a_step_on_a_microcontroller_is_in_single_precision_throughout(tmp_path: Path) -> None:
    """Clang copies a state by calling memcpy, which every freestanding environment has to provide."""
    assert compilation(zig(), tmp_path, {"firmware.cpp": SOURCE}, *CORTEX, *FIRMWARE) == (0, "")
    assert undefined(tmp_path / "firmware.o") <= LIBM | {"memcpy"}


def test_the_stack_of_a_step_is_known_and_small(program: Path, record_property: Callable[[str, object], None]) -> None:
    """The sum over all functions bounds the deepest chain of calls, as none calls itself."""
    frames = [line.rsplit("\t", 2) for line in program.with_suffix(".su").read_text().splitlines()]
    assert {kind for _, _, kind in frames} == {"static"}
    stack = sum(int(size) for _, size, _ in frames)
    record_property("stack_bytes_at_most", stack)
    assert 0 < stack < 32 * 1024


def test_the_code_of_a_step_fits_a_microcontroller(program: Path, record_property: Callable[[str, object], None]) -> None:
    symbols = [line.split() for line in printed("nm", "--print-size", "--defined-only", program) if len(line.split()) == 4]
    code = sum(int(size, 16) for _, size, kind, _ in symbols if kind in "tTwW")
    record_property("code_bytes_of_all_drives", code)
    assert code > 0
    assert not [name for *_, kind, name in symbols if kind in "bBdD"]  # no variable outlives a step
    assert code < 32 * 1024 * len(drives("float"))
