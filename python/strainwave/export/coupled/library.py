"""Shared library of the sources of a coupled drive, compiled on this machine."""

from __future__ import annotations

import sys
from collections.abc import Mapping, Sequence
from pathlib import Path
from tempfile import TemporaryDirectory

from strainwave.native.compilers import FLAGS, Compiler, find_compiler

SUFFIXES = {"linux": ".so", "darwin": ".dylib"}
LIBRARIES = "-Wl,--as-needed", "-Wl,-z,defs", "-lm", "-ldl"


def shared_library(sources: Mapping[str, str], main: str, flags: Sequence[str] = ()) -> bytes:
    """Return the shared library of C++ sources.

    Args:
        sources: texts by their names
        main: name of the one that is compiled; it includes the others
        flags: of the compiler, besides its own

    Raises:
        NoCompilerError: there is no compiler
        CompileError: the compiler reports an error
    """
    compiler = find_compiler()
    with TemporaryDirectory() as folder:
        for path, text in sources.items():
            target = Path(folder, path)
            target.parent.mkdir(parents=True, exist_ok=True)
            target.write_text(text, "utf-8")
        return compiler.build(Path(folder, main), (*FLAGS, f"-I{folder}", *flags), _libraries(compiler)).read_bytes()


def _libraries(compiler: Compiler) -> tuple[str, ...]:
    """Return the libraries to link; those of zig and of macOS find functions in what the process has loaded."""
    if sys.platform == "darwin":
        return ("-undefined", "dynamic_lookup")
    return () if compiler.name == "zig c++" else LIBRARIES
