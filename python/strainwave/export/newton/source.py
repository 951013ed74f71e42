"""C++ source of an actuator: one text without includes, and its PTX."""

from __future__ import annotations

import ctypes
from functools import lru_cache
from importlib import metadata, resources

from strainwave import Drive, _core
from strainwave.export import cplusplus
from strainwave.native.compilers import CompileError
from strainwave.native.static_type import in_words, static_type

OWN = resources.files("strainwave.export.newton")
COMMANDS = {"rad": "position", "rad/s": "speed"}  # target of a joint by the unit of the command; feedforward for other units
FIRST_STATE = 5  # numbers of a gear before those of its state, as in actuator.hpp
CUDA_ARCHITECTURE = "compute_75"  # virtual, of Turing and later; a driver compiles it for its GPU
CUDA_OPTIONS = (
    *("--std=c++20", "--device-as-default-execution-space", f"--gpu-architecture={CUDA_ARCHITECTURE}"),
    "--fmad=false",
)
MAX_REMEMBERED = 8  # texts of PTX, of some MB each


def source(drive: Drive, scalar: str, command: str, outputs: int) -> str:
    """Return the code of an actuator as one text that includes nothing.

    Args:
        drive: whose load prescribes the motion of the output
        scalar: "float" or "double"
        command: unit of its command
        outputs: number of outputs
    """
    texts = {"drive.hpp": _drive_header(drive, scalar, command, outputs)}
    texts |= {name: OWN.joinpath(name).read_text("utf-8") for name in ("actuator.hpp", "standard.hpp")}
    return cplusplus.amalgamated(["standard.hpp", "actuator.hpp"], texts)


def _drive_header(drive: Drive, scalar: str, command: str, outputs: int) -> str:
    """Return the header with the static type of a drive."""
    laws, shape, _ = _core.parts(drive)
    includes = "".join(f"#include <{each}>\n" for each in cplusplus.headers_of(drive))
    return f"""// {in_words(drive)}
#pragma once
{includes}
namespace actuator {{

using S = {scalar};

template <class S>
using Drive = {static_type(drive)};

inline constexpr int laws[] = {{{", ".join(map(str, [*laws, 0]))}}};    // one more than there are,
inline constexpr int shape[] = {{{", ".join(map(str, [*shape, 0]))}}};  // so that none is empty
inline constexpr int parameter_count = {len(_core.parameters(drive))}, output_count = {outputs};

enum class CommandIs {{ position, speed, feedforward }};
inline constexpr CommandIs command_is = CommandIs::{COMMANDS.get(command, "feedforward")};

}}  // namespace actuator
"""


def has_nvrtc() -> bool:
    """True if the package nvidia-cuda-nvrtc is installed, which compiles for GPUs without one."""
    try:
        metadata.distribution("nvidia-cuda-nvrtc")
    except metadata.PackageNotFoundError:
        return False
    return True


@lru_cache(maxsize=MAX_REMEMBERED)
def ptx(text: str, *options: str) -> str:
    """Return the PTX of an actuator, compiled by NVRTC itself: cuda-core needs a driver even to compile.

    Args:
        text: source of the actuator
        options: of NVRTC, further ones

    Raises:
        CompileError: NVRTC reports an error
    """
    kernels = cplusplus.INCLUDING.sub("", OWN.joinpath("cuda.hpp").read_text("utf-8")).replace("#pragma once\n", "")
    files = metadata.files("nvidia-cuda-nvrtc") or []
    library = ctypes.CDLL(str(next(file.locate() for file in files if file.name.startswith(("libnvrtc.so", "nvrtc64")))))
    program = ctypes.c_void_p()
    library.nvrtcCreateProgram(ctypes.byref(program), (text + kernels).encode(), b"drive.cu", 0, None, None)
    try:
        all_options = [each.encode() for each in (*CUDA_OPTIONS, *options)]
        result = library.nvrtcCompileProgram(program, len(all_options), (ctypes.c_char_p * len(all_options))(*all_options))
        if result:
            log = _text(library, program, "ProgramLog")
            raise CompileError(f"NVRTC reports: {log[:200]}", log)
        return _text(library, program, "PTX")
    finally:
        library.nvrtcDestroyProgram(ctypes.byref(program))


def _text(library: ctypes.CDLL, program: ctypes.c_void_p, kind: str) -> str:
    size = ctypes.c_size_t()
    library[f"nvrtcGet{kind}Size"](program, ctypes.byref(size))
    text = ctypes.create_string_buffer(size.value)
    library[f"nvrtcGet{kind}"](program, text)
    return text.value.decode()
