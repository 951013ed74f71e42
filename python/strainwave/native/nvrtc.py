"""NVRTC, the compiler of CUDA C++: by itself, as cuda-core needs a driver to compile PTX."""

from __future__ import annotations

import ctypes
from functools import cache
from importlib import metadata

from strainwave.native.compilers import CompileError

PACKAGE = "nvidia-cuda-nvrtc"
OPTIONS = ("--std=c++20", "--device-as-default-execution-space", "--fmad=false")  # no fusing: the numbers of the processor
MAX_MESSAGE_LENGTH = 200  # characters of a log, in a message


def is_installed() -> bool:
    """True if the package nvidia-cuda-nvrtc is installed."""
    try:
        metadata.distribution(PACKAGE)
    except metadata.PackageNotFoundError:
        return False
    return True


def compiled(source: str, *options: str) -> tuple[str, str]:
    """Return the PTX of CUDA C++, and the log of its compilation.

    Args:
        source: text
        options: of NVRTC, besides `OPTIONS`

    Raises:
        CompileError: NVRTC reports an error
    """
    library, program = _library(), ctypes.c_void_p()
    library.nvrtcCreateProgram(ctypes.byref(program), source.encode(), b"drive.cu", 0, None, None)
    try:
        encoded = [each.encode() for each in (*OPTIONS, *options)]
        status = library.nvrtcCompileProgram(program, len(encoded), (ctypes.c_char_p * len(encoded))(*encoded))
        log = _text(program, "ProgramLog")
        if status != 0:
            raise CompileError(f"NVRTC reports: {log[:MAX_MESSAGE_LENGTH]}", log)
        return _text(program, "PTX"), log
    finally:
        library.nvrtcDestroyProgram(ctypes.byref(program))


@cache
def _library() -> ctypes.CDLL:
    files = metadata.files(PACKAGE) or []
    return ctypes.CDLL(str(next(file.locate() for file in files if file.name.startswith(("libnvrtc.so", "nvrtc64")))))


def _text(program: ctypes.c_void_p, kind: str) -> str:
    size = ctypes.c_size_t()
    _library()[f"nvrtcGet{kind}Size"](program, ctypes.byref(size))
    text = ctypes.create_string_buffer(size.value + 1)
    _library()[f"nvrtcGet{kind}"](program, text)
    return text.value.decode()
