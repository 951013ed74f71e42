"""The C++ compilers of this machine, and how one makes a shared object of a source."""

from __future__ import annotations

import os
import re
import shlex
import shutil
import subprocess
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cache
from importlib.util import find_spec
from pathlib import Path
from tempfile import TemporaryDirectory

from strainwave.messages import one_line
from strainwave.operating_system import kill_group

MAX_COMPILE_SECONDS = 300.0  # of one command; the largest kernel takes some 10 s alone on two cores
MAX_LIBRARY_SECONDS = 1200.0  # of one command that also builds a C library; zig takes 140 s of one core for that of Windows
MAX_CHECK_SECONDS = 30.0  # until a compiler has named its version
OLDEST = {"__clang_major__": 14, "__GNUC__": 12}  # versions that compile the headers; Clang has both macros
CPLUSPLUS_20 = 202002  # of __cplusplus
TEMPORARY_FOLDERS = ("TMPDIR", "ZIG_LOCAL_CACHE_DIR", "ZIG_GLOBAL_CACHE_DIR")  # environment variables

# Without contraction and without vectorised straight-line code (GCC fuses products there even so), every compiler and every
# instruction set gives the same numbers.
FLAGS = (
    *("-std=c++20", "-O3", "-ffp-contract=off", "-fno-tree-slp-vectorize", "-fno-math-errno", "-fno-trapping-math"),
    *("-fno-exceptions", "-fno-rtti", "-fvisibility=hidden", "-fPIC", "-Wno-psabi"),
)
FLAGS_OF_INSTRUCTION_SET = {
    "baseline": (),
    "avx2": ("-mavx2",),
    "avx512": ("-mavx512f", "-mavx512dq", "-mavx512vl", "-mavx512bw", "-mprefer-vector-width=512"),
}


class CompileError(ChildProcessError):
    """A source that a compiler refused, or at which it failed; `output` is all that the compiler printed."""

    def __init__(self, message: str, output: str = "") -> None:
        super().__init__(one_line(message))
        self.output = output


class NoCompilerError(ChildProcessError):
    """No compiler of this machine compiles C++20."""


@dataclass(frozen=True)
class Compiler:
    """A compiler: the commands that compile and that link, and what distinguishes it from its other versions."""

    name: str
    command: tuple[str, ...]
    link: tuple[str, ...]
    identity: str

    def build(self, source: Path, flags: Sequence[str], libraries: Sequence[str] = (), *, keep_cache: bool = False) -> Path:
        """Compile a source to a shared object in the same folder, which takes all temporary files, and return its path.

        Args:
            source: file in C++
            flags: of the compilation
            libraries: and other arguments of the linker
            keep_cache: let zig keep what it builds of a C library in its own cache, and allow the time that this takes

        Raises:
            CompileError: the compiler reports an error, crashes, or takes longer than `MAX_COMPILE_SECONDS`
        """
        temporary = TEMPORARY_FOLDERS[:-1] if keep_cache else TEMPORARY_FOLDERS
        seconds = MAX_LIBRARY_SECONDS if keep_cache else MAX_COMPILE_SECONDS
        unlinked, shared = source.with_suffix(".o"), source.with_suffix(".so")
        for command in (
            (*self.command, *flags, "-c", str(source), "-o", str(unlinked)),
            (*self.link, str(unlinked), *libraries, "-o", str(shared)),
        ):
            status, output = _run(command, seconds, str(source.parent), temporary)
            if status != 0:
                raise CompileError(f"{self.name} compiled no kernel: {_first_error(status, output)}", output)
        return shared


def flags_for(instruction_set: str) -> tuple[str, ...]:
    """Return the flags of every compiler for an instruction set."""
    return *FLAGS, *FLAGS_OF_INSTRUCTION_SET[instruction_set]


def candidates() -> Iterator[Compiler]:
    """Yield what may be a C++20 compiler, the first to be preferred; no process is started.

    First that of the environment variable CXX, then c++, g++ and clang++ of PATH, then Clang of the package ziglang.
    """
    seen = set()
    for words in (shlex.split(os.environ.get("CXX", "")), ["c++"], ["g++"], ["clang++"]):
        if words and (path := shutil.which(words[0])):
            identity = " ".join([_identity(path), *words[1:]])
            if identity not in seen:
                seen.add(identity)
                command = (path, *words[1:])
                yield Compiler(Path(words[0]).name, command, (*command, "-shared"), identity)
    if zig := zig_program():
        # The kernel finds its mathematics in what Python has loaded: to link with libraries, zig would build them first, for
        # 20 s and 57 MB. Its processor by default is that of the machine.
        yield Compiler("zig c++", (zig, "c++", "-mcpu=baseline"), (zig, "cc", "-shared", "-nostdlib", "-s"), _identity(zig))


def find_compiler() -> Compiler:
    """Return the first compiler of this machine that compiles C++20.

    Raises:
        NoCompilerError: there is none
    """
    for compiler in candidates():
        if compiles_cplusplus_20(compiler):
            return compiler
    raise NoCompilerError(
        "there is no C++20 compiler (g++ 12, clang++ 14 or later, or what CXX names); install one, or `pip install "
        "'strainwave[compiler]'`"
    )


@cache
def compiles_cplusplus_20(compiler: Compiler) -> bool:
    """True if the compiler is recent enough and has its standard library, by its own answer."""
    arguments = ("-std=c++20", "-dM", "-E", "-x", "c++", "-include", "concepts", os.devnull)
    try:
        with TemporaryDirectory() as folder:
            status, output = _run((*compiler.command, *arguments), MAX_CHECK_SECONDS, folder)
    except OSError:
        return False
    macros = dict(re.findall(r"^#define (\w+) (\d+)L?$", output, re.MULTILINE))
    oldest = next((int(macros[name]) >= version for name, version in OLDEST.items() if name in macros), False)
    return status == 0 and oldest and int(macros.get("__cplusplus", 0)) >= CPLUSPLUS_20


def zig_program() -> str | None:
    """Return the program of the package ziglang if it is installed."""
    found = find_spec("ziglang")
    folders = found.submodule_search_locations if found else None
    return shutil.which("zig", path=folders[0]) if folders else None


def _identity(path: str) -> str:
    """Return the name of a program with the size and time of its file, which an update changes."""
    real = os.path.realpath(path)
    found = os.stat(real)
    return f"{real} {found.st_size} {found.st_mtime_ns}"


def _run(command: Sequence[str], seconds: float, folder: str, temporary: Sequence[str] = TEMPORARY_FOLDERS) -> tuple[int, str]:
    """Return the exit status and the output of a command. Whatever ends the wait ends the processes of the command, too.

    Args:
        command: program and arguments
        seconds: after which it is ended
        folder: for temporary files, so that those of a killed command lie where they are cleared
        temporary: environment variables that name such folders
    """
    process = subprocess.Popen(
        command,
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        env={**os.environ, "LC_ALL": "C", **dict.fromkeys(temporary, folder)},
        process_group=0,  # a compiler starts others, which would outlive it
    )
    try:
        output, _ = process.communicate(timeout=seconds)
    except BaseException as error:
        kill_group(process.pid)
        process.communicate()
        if isinstance(error, subprocess.TimeoutExpired):
            raise CompileError(f"{command[0]} was ended after {seconds:g} s") from None
        raise
    return process.returncode, output.decode(errors="replace")


def _first_error(status: int, output: str) -> str:
    """Return the first error that a compiler printed, else its last line, else its exit status."""
    errors: list[str] = re.findall(r"\berror: (.+)", output)
    lines = output.split("\n")
    return next(iter(errors or [line for line in reversed(lines) if line.strip()]), f"exit status {status}")
