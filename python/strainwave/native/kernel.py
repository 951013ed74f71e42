"""A kernel: what is compiled for one drive and one job, and the key under which the result is stored."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from hashlib import sha256
from pathlib import Path

from strainwave import _core
from strainwave.native.compilers import Compiler, flags_for

INCLUDE_FOLDER = Path(_core.__file__).parent / "include"  # of the physics headers


@dataclass(frozen=True)
class Kernel:
    """The source of a kernel, and two texts that the list of kernels shows.

    Args:
        source: C++, which includes headers of the package and exports `extern "C"` functions
        job: what it does, as in `strainwave.native.kernels.JOBS`
        drive: its models in words
    """

    source: str
    job: str
    drive: str

    def key(self, compiler: Compiler) -> str:
        """Return the name under which the cache has what this compiler makes of it."""
        return _digest(self.shipped_key(), compiler.identity, *compiler.command, *compiler.link)

    def shipped_key(self, instruction_set: str = "") -> str:
        """Return the name under which the package has it, whatever compiler it was built by: all give the same numbers.

        Args:
            instruction_set: for which it is compiled; the one in use, if none is named
        """
        return _digest(self.source, headers_digest(), *flags_for(instruction_set or _core.instruction_set()))


@cache
def headers_digest() -> str:
    """Return the digest of the names and contents of all headers."""
    paths = sorted(INCLUDE_FOLDER.rglob("*.hpp"))
    return _digest(*(f"{path.relative_to(INCLUDE_FOLDER).as_posix()}\n{path.read_text('utf-8')}" for path in paths))


def _digest(*texts: str) -> str:
    return sha256("\0".join(texts).encode()).hexdigest()
