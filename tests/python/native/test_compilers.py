"""Which compiler is taken, what it is asked, and that nothing of it outlives the one who waits."""

from __future__ import annotations

import ctypes
import os
import shutil
import signal
import time
from pathlib import Path
from uuid import uuid4

import pytest
from strainwave import _core
from strainwave.native import compilers
from strainwave.native.compilers import CompileError, Compiler, NoCompilerError, candidates, find_compiler, flags_for

from tests.python.native.conftest import Fake

EXPORTED = 'extern "C" __attribute__((visibility("default")))'
SOURCE = f"{EXPORTED} double answer(double a, double b) {{ return a * a + b; }}\n"
INSTRUCTION_SET = f"""
{EXPORTED} int answer() {{
#if defined(__AVX512F__) && defined(__AVX512DQ__) && defined(__AVX512VL__) && defined(__AVX512BW__)
    return 2;
#elif defined(__AVX512F__) || defined(__FMA__)
    return -1;
#elif defined(__AVX2__)
    return 1;
#else
    return 0;
#endif
}}
"""


def names() -> list[str]:
    return [compiler.name for compiler in candidates()]


def program(path: Path, text: str) -> Path:
    path.write_text(f"#!/bin/sh\n{text}\n")
    path.chmod(0o700)
    return path


def built(compiler: Compiler, folder: Path, source: str = SOURCE, instruction_set: str = "baseline") -> Path:
    """Builds a kernel under a name of its own, as a process loads each name once."""
    path = folder / f"{uuid4().hex}.cpp"
    path.write_text(source)
    return compiler.build(path, flags_for(instruction_set))


def test_the_compiler_of_the_environment_comes_first_and_zig_last(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    for name in ("c++", "g++", "clang++"):
        program(tmp_path / name, "true")
    program(tmp_path / "mine", "true")
    monkeypatch.setenv("PATH", str(tmp_path))
    monkeypatch.setattr(compilers, "zig_program", lambda: str(tmp_path / "mine"))
    assert names() == ["c++", "g++", "clang++", "zig c++"]
    monkeypatch.setenv("CXX", f"{tmp_path}/mine -m32")
    assert next(candidates()).command == (f"{tmp_path}/mine", "-m32")
    assert names() == ["mine", "c++", "g++", "clang++", "zig c++"]
    monkeypatch.setenv("CXX", "missing")
    assert names() == ["c++", "g++", "clang++", "zig c++"]


def test_two_names_of_one_compiler_are_one(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    (tmp_path / "c++").symlink_to(program(tmp_path / "g++", "true"))
    monkeypatch.setenv("PATH", str(tmp_path))
    monkeypatch.setattr(compilers, "zig_program", lambda: None)
    assert names() == ["c++"]


def test_an_update_gives_a_compiler_another_identity(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    path = program(tmp_path / "c++", "true")
    monkeypatch.setenv("PATH", str(tmp_path))
    first = next(candidates())
    assert next(candidates()) == first
    os.utime(path, (0.0, 0.0))
    assert next(candidates()) != first


@pytest.mark.parametrize(
    ("macros", "usable"),
    [
        ({"__GNUC__": 12, "__cplusplus": 202002}, True),
        ({"__GNUC__": 11, "__cplusplus": 202002}, False),
        ({"__GNUC__": 4, "__clang_major__": 14, "__cplusplus": 202002}, True),
        ({"__GNUC__": 4, "__clang_major__": 13, "__cplusplus": 202002}, False),
        ({"__GNUC__": 12, "__cplusplus": 201709}, False),
        ({"__cplusplus": 202002}, False),
        ({}, False),
    ],
)
def test_a_compiler_must_be_recent_by_its_own_answer(
    macros: dict[str, int], usable: bool, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    text = "; ".join(f"echo '#define {name} {value}{'L' * (name == '__cplusplus')}'" for name, value in macros.items())
    program(tmp_path / "g++", text or "exit 0")
    monkeypatch.setenv("PATH", str(tmp_path))
    monkeypatch.setattr(compilers, "zig_program", lambda: None)
    if usable:
        assert find_compiler().name == "g++"
    else:
        with pytest.raises(NoCompilerError, match=r"no C\+\+20 compiler"):
            find_compiler()


def test_a_compiler_is_asked_once(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setenv("CXX", str(program(tmp_path / "mine", f'echo asked >> {tmp_path}/log; exec {shutil.which("c++")} "$@"')))
    assert find_compiler() == find_compiler()
    assert (tmp_path / "log").read_text() == "asked\n"


@pytest.mark.parametrize("text", ["exit 1", "kill -SEGV $$", "", f'{shutil.which("c++")} "$@"; exit 1'])
def test_a_compiler_that_fails_its_check_is_passed_over(text: str, monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setenv("CXX", str(program(tmp_path / "mine", text)))
    assert find_compiler().name == "c++"


def test_no_shell_reads_the_environment(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setenv("CXX", f"c++ ;touch${{IFS}}{tmp_path}/made $(touch {tmp_path}/made)")
    find_compiler()
    assert not (tmp_path / "made").exists()


@pytest.fixture
def usable() -> list[Compiler]:
    """Every compiler of this machine that compiles C++20."""
    return [compiler for compiler in candidates() if compilers.compiles_cplusplus_20(compiler)]


def test_every_compiler_makes_kernels_that_round_each_product(usable: list[Compiler], tmp_path: Path) -> None:
    """The square of 1 + h is 1 + 2 h + h^2, whose last term only a contracted product would keep."""
    h = 2.0**-30
    for compiler in usable:
        made = ctypes.CDLL(str(built(compiler, tmp_path, SOURCE, _core.instruction_set())))
        made.answer.restype, made.answer.argtypes = ctypes.c_double, 2 * [ctypes.c_double]
        assert made.answer(1.0 + h, -(1.0 + 2.0 * h)) == 0.0, compiler.name


@pytest.mark.skipif(os.uname().machine != "x86_64", reason="instruction sets of another processor")
@pytest.mark.parametrize(("name", "answer"), [("baseline", 0), ("avx2", 1), ("avx512", 2)])
def test_every_compiler_uses_the_instruction_set_alone(name: str, answer: int, usable: list[Compiler], tmp_path: Path) -> None:
    for compiler in usable:
        made = ctypes.CDLL(str(built(compiler, tmp_path, INSTRUCTION_SET, name)))
        assert made.answer() == answer, compiler.name


def test_zig_builds_no_library_first(usable: list[Compiler], tmp_path: Path) -> None:
    pytest.importorskip("ziglang")
    built(usable[-1], tmp_path)
    assert sum(path.stat().st_size for path in tmp_path.rglob("*") if path.is_file()) < 5_000_000


def test_an_error_is_one_line_and_has_all_that_was_printed(tmp_path: Path) -> None:
    with pytest.raises(CompileError, match="compiled no kernel: 'x' was not declared in this scope") as failed:
        built(find_compiler(), tmp_path, "int f() { return x + y; }\n")
    assert "\n" not in str(failed.value)
    assert "'y' was not declared" in failed.value.output


def test_a_compiler_that_crashes_without_a_word_is_told_by_its_status(fake: Fake, tmp_path: Path) -> None:
    fake("kill -KILL $$")
    with pytest.raises(CompileError, match="fake-compiler compiled no kernel: exit status -9"):
        built(find_compiler(), tmp_path)


def test_temporary_files_lie_beside_the_source_and_errors_are_english(fake: Fake, tmp_path: Path) -> None:
    fake(f"echo $TMPDIR $LC_ALL > {tmp_path}/said")
    built(find_compiler(), tmp_path)
    assert (tmp_path / "said").read_text() == f"{tmp_path} C\n"


def ended(folder: Path) -> bool:
    """True if the process that the compiler started is not there any more, or soon will not be."""
    number = int((folder / "child").read_text())
    deadline = time.monotonic() + 10.0
    while time.monotonic() < deadline:
        try:
            os.kill(number, 0)
        except ProcessLookupError:
            return True
        if ") Z " in Path(f"/proc/{number}/stat").read_text():  # under any name: it may be killed before it is sleep
            return True
        time.sleep(0.01)
    return False


def test_ctrl_c_ends_the_compiler_and_all_that_it_started(fake: Fake, tmp_path: Path) -> None:
    started = "sleep 0.5"  # else the signal may come while Python has not returned the process yet
    fake(f"sleep 60 > {os.devnull} 2>&1 & echo $! > {tmp_path}/child; {started}; kill -INT $PPID; wait")
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    try:
        with pytest.raises(KeyboardInterrupt):
            built(find_compiler(), tmp_path)
    finally:
        signal.signal(signal.SIGINT, before)
    assert ended(tmp_path)


def test_a_compiler_that_hangs_is_ended(fake: Fake, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    fake(f"sleep 60 > {os.devnull} 2>&1 & echo $! > {tmp_path}/child; wait")
    monkeypatch.setattr(compilers, "MAX_COMPILE_SECONDS", 0.3)
    with pytest.raises(CompileError, match=r"fake-compiler was ended after 0\.3 s"):
        built(find_compiler(), tmp_path)
    assert ended(tmp_path)
