"""C++ sources of an FMU: what belongs to one drive, and the files that all FMUs share."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from functools import partial
from hashlib import sha256
from importlib import resources
from math import isfinite
from sys import float_info

from strainwave import Drive, _core, structure
from strainwave.export import cplusplus
from strainwave.export.fmu import variables as names
from strainwave.export.fmu.variables import Variable
from strainwave.native.static_type import in_words, static_type

RUN_HEADERS = ("strainwave/kernel/assemble.hpp", "strainwave/kernel/run.hpp")
HEADERS_OF_VERSION = {
    2: ("fmi2FunctionTypes.h", "fmi2Functions.h", "fmi2TypesPlatform.h"),
    3: ("fmi3FunctionTypes.h", "fmi3Functions.h", "fmi3PlatformTypes.h"),
}
DIGEST_LENGTH = 32  # hexadecimal digits of a token


def sources(drive: Drive, found: list[Variable], version: int, exchanges: bool, follows: bool) -> tuple[dict[str, str], str]:
    """Return the source files of the FMU of a drive by their names, and the token that ties a binary to its description.

    Raises:
        ImportError: the package fmpy, which contains the headers of FMI, is not installed
    """
    folder = resources.files("strainwave.export.fmu")
    own = {name: folder.joinpath(name).read_text("utf-8") for name in (f"fmi{version}.cpp", "functions.hpp")}
    return drive_sources(drive, found, {**own, **_fmi_headers(version)}, exchanges, follows)


def drive_sources(
    drive: Drive, found: list[Variable], others: Mapping[str, str], exchanges: bool = False, follows: bool = False
) -> tuple[dict[str, str], str]:
    """Return the sources that step a drive with the others that use them, by their names, and a token that depends on all."""
    model = resources.files("strainwave.export.fmu").joinpath("model.hpp").read_text("utf-8")
    shared = {name: cplusplus.own_text(name) for name in ("contradictions.hpp", "stretches.hpp")}
    files = {"model.hpp": model, **shared, **others, **cplusplus.closure([*cplusplus.headers_of(drive), *RUN_HEADERS])}
    header = partial(_drive_header, drive, found, exchanges, follows)
    digest = sha256("\0".join([*files.values(), header("")]).encode()).hexdigest()[:DIGEST_LENGTH]
    token = f"{{{digest}}}"
    return {**files, "drive.hpp": header(token)}, token


def _fmi_headers(version: int) -> dict[str, str]:
    try:
        folder = resources.files("fmpy") / "c-code"
    except ModuleNotFoundError:
        raise ImportError(
            "an FMU needs the headers of FMI, which the package fmpy contains; `pip install 'strainwave[fmu]'`"
        ) from None
    return {name: (folder / name).read_text("utf-8") for name in HEADERS_OF_VERSION[version]}


def _drive_header(drive: Drive, found: list[Variable], exchanges: bool, follows: bool, token: str) -> str:
    """Return the header with the static type of a drive, its numbers and the names of its variables."""
    laws, shape, _ = _core.parts(drive)
    by_causality = {kind: [each for each in found if each.causality == kind] for kind in ("input", "output", "parameter")}
    inputs, outputs, parameters = by_causality.values()
    channels = [each.channel for each in names.recorded(drive, found).values()]
    initial = [f"strainwave::initial::{each}" for each in names.initial_names(drive)]
    states = names.continuous_states(drive)
    is_short = isinstance(drive.gear.structure, structure.Lumped)  # else to inline each stage of a step takes minutes
    lines = "".join(
        f"    {{{_text(each.name)}, {_text(each.unit)}, {each.start!r}, {_bound(each.low)}, {_bound(each.high)}}},\n"
        for each in parameters
    )
    return f"""// {in_words(drive)}
#pragma once
#define {"SW_INLINE_STEPS" if is_short else "SW_INLINE_RATES"}
{"".join(f"#include <{each}>{chr(10)}" for each in cplusplus.headers_of(drive))}#include <strainwave/initial_quantities.hpp>

namespace fmu {{

template <class S>
using Drive = {static_type(drive)};

inline constexpr bool exchanges = {str(exchanges).lower()};  // model exchange
inline constexpr bool is_followed = {str(follows).lower()};  // the command: it goes on at the rate of the last step
inline constexpr char token[] = {_text(token)};
inline constexpr int laws[] = {{{_listed([*laws, 0])}}};    // one more than there are,
inline constexpr int shape[] = {{{_listed([*shape, 0])}}};  // so that none is empty

inline constexpr unsigned first_input = {names.FIRST_INPUT}, first_output = {names.FIRST_OUTPUT};
inline constexpr unsigned first_parameter = {names.FIRST_PARAMETER}, first_state = {names.FIRST_STATE};
inline constexpr int state_count = {len(states)}, indicator_count = {int(names.has_events(drive))};
inline constexpr double state_nominals[] = {{{_listed(names.nominal(name) for name, _ in states)}}};
inline constexpr int output_count = {len(outputs)}, parameter_count = {len(parameters)};
inline constexpr const char* names[] = {{{_listed(_text(each.name) for each in inputs)}}};
inline constexpr double input_starts[] = {{{_listed(repr(each.start) for each in inputs)}}};
inline constexpr const char* output_names[] = {{{_listed(_text(each.name) for each in outputs)}}};
inline constexpr int channels[] = {{{_listed(channels)}}};
inline constexpr strainwave::initial::Quantity initial_quantities[] = {{{_listed(initial)}}};
inline constexpr int initial_count = {len(initial)}, own_parameters = 1 + initial_count;

struct Parameter {{
    const char* name;
    const char* unit;
    double start, low, high;
}};
inline constexpr Parameter parameters[] = {{
{lines}}};

}}  // namespace fmu
"""


def _listed(items: Iterable[object]) -> str:
    return ", ".join(str(each) for each in items)


def _text(text: str) -> str:
    escaped = text.replace("\\", "\\\\").replace('"', '\\"')
    return f'"{escaped}"'


def _bound(bound: float) -> str:
    return repr(bound if isfinite(bound) else float_info.max if bound > 0 else -float_info.max)
