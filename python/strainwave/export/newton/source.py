"""C++ source of an actuator: one text without includes, and its PTX."""

from __future__ import annotations

from functools import lru_cache
from importlib import resources

from strainwave import Drive, _core
from strainwave.export import cplusplus
from strainwave.native import nvrtc
from strainwave.native.static_type import in_words, static_type

OWN = resources.files("strainwave.export.newton")
TARGETS_BY_UNIT = {
    "rad": "position",
    "rad/s": "speed",
}  # target of a joint by the unit of the command; feedforward for other units
FIRST_STATE = 5  # numbers of a gear before those of its state, as in actuator.hpp
CUDA_ARCHITECTURE = "compute_75"  # virtual, of Turing and later; a driver compiles it for its GPU
MAX_REMEMBERED_TEXTS = 8  # texts of PTX, of some MB each


def source(drive: Drive, scalar: str, command: str, outputs: int, follows: bool) -> str:
    """Return the code of an actuator as one text that includes nothing.

    Args:
        drive: whose load prescribes the motion of the output
        scalar: "float" or "double"
        command: unit of its command
        outputs: number of outputs
        follows: whether a command without a rate moves in a line from call to call; else it is held
    """
    texts = {"drive.hpp": _drive_header(drive, scalar, command, outputs, follows)}
    return cplusplus.amalgamated(["actuator.hpp"], texts | {"actuator.hpp": OWN.joinpath("actuator.hpp").read_text("utf-8")})


def _drive_header(drive: Drive, scalar: str, command: str, outputs: int, follows: bool) -> str:
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
inline constexpr CommandIs command_is = CommandIs::{TARGETS_BY_UNIT.get(command, "feedforward")};
inline constexpr bool is_followed = {str(follows).lower()};

}}  // namespace actuator
"""


@lru_cache(maxsize=MAX_REMEMBERED_TEXTS)
def ptx(text: str, *options: str) -> str:
    """Return the PTX of an actuator.

    Args:
        text: source of the actuator
        options: of NVRTC, further ones

    Raises:
        CompileError: NVRTC reports an error
    """
    kernels = cplusplus.INCLUDING.sub("", OWN.joinpath("cuda.hpp").read_text("utf-8")).replace("#pragma once\n", "")
    return nvrtc.compiled(text + kernels, f"--gpu-architecture={CUDA_ARCHITECTURE}", *options)[0]
