"""Variables of an FMU with their units, ranges and value references, and its C++ sources."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from functools import partial
from hashlib import sha256
from importlib import resources
from math import inf, isfinite
from sys import float_info
from typing import Literal

from strainwave import Drive, _core, structure
from strainwave.export import cplusplus
from strainwave.export.host import MIN_STEP
from strainwave.files import units
from strainwave.native.static_type import in_words, static_type
from strainwave.simulation import signals
from strainwave.simulation.excitation import ROOM_TEMPERATURE

Causality = Literal["input", "output", "parameter", "local"]
FIRST_INPUT = 1  # value references; 0 is the time
FIRST_OUTPUT = 101
FIRST_PARAMETER = 1001
FIRST_STATE = 100_001  # then the derivatives, then the event indicator
STEP_NAME = "internal_step"
MAX_STEP = 0.1  # s
INITIAL = ("output_angle", "output_speed", "torque")  # quantities that a run can begin with; 0 has no effect
RATES = {"rad": "rad/s", "1": "1/s", "rad/s": "rad/s2"}
NOMINAL_ERROR = 1e-4  # rad, of the transmission error, whose twist makes the torque
SHOWN_BY = {"angle": "deg", "speed": "rpm", "twist": "arcmin", "error": "arcmin", "temperature": "degC"}  # by end of the name
RUN_HEADERS = ("strainwave/kernel/assemble.hpp", "strainwave/kernel/run.hpp")
HEADERS_OF_VERSION = {
    2: ("fmi2FunctionTypes.h", "fmi2Functions.h", "fmi2TypesPlatform.h"),
    3: ("fmi3FunctionTypes.h", "fmi3Functions.h", "fmi3PlatformTypes.h"),
}
DIGEST_LENGTH = 32  # hexadecimal digits of a token


@dataclass(frozen=True)
class Variable:
    """A variable of an FMU.

    Attributes:
        name: unique in the FMU
        reference: value reference
        causality: input, output, parameter, or local for a state, its derivative or an event indicator
        unit: in the spelling of Modelica and FMI
        description: one line
        start: value at the start; None for an output
        low, high: range, infinite without a bound
        display_unit: unit in which tools show it; empty for `unit`
    """

    name: str
    reference: int
    causality: Causality
    unit: str
    description: str
    start: float | None = None
    low: float = -inf
    high: float = inf
    display_unit: str = ""


def variables(drive: Drive, step: float) -> list[Variable]:
    """Return the variables of the FMU of a drive whose internal step is `step` [s]: inputs, outputs, parameters.

    >>> import strainwave as sw
    >>> [each.name for each in variables(sw.Drive(), 2e-4)][:4]
    ['command', 'command_rate', 'load_torque', 'load_torque_rate']
    """
    inputs = list(_inputs(drive))
    return [*inputs, *_outputs(drive, {each.name for each in inputs}), *_parameters(drive, step)]


def continuous_states(drive: Drive) -> list[tuple[str, str]]:
    """Return name and unit of each number of a drive that a solver integrates, in the order of the C++ state."""
    found = _core.state(drive)[0]
    moved = 1 + [name for name, _, _ in found].index("output_speed")
    memory = (i for i, (_, _, part) in enumerate(found) if i >= moved and part in ("control", "hysteresis", "held_twist"))
    return [(name, unit) for name, unit, _ in found[: next(memory)]]


def state_variables(drive: Drive) -> list[Variable]:
    """Return the variables that model exchange adds: states, their derivatives in the same order, and an event indicator."""
    states = continuous_states(drive)
    derivatives = [(f"der(state.{name})", RATES.get(unit, _per_second(unit))) for name, unit in states]
    listed = [*((f"state.{name}", unit) for name, unit in states), *derivatives, ("event_indicator", "1")]
    return [Variable(name, FIRST_STATE + i, "local", unit, "") for i, (name, unit) in enumerate(listed)]


def nominal(state: str) -> float:
    """Return the size of a continuous state that tolerances of a solver refer to, in its unit."""
    return NOMINAL_ERROR if state == "transmission_error" else 1.0


def _per_second(unit: str) -> str:
    """Return the unit of the rate of a quantity."""
    numerator, _, denominator = unit.partition("/")
    return units.check({"": f"{numerator}/s", "s": f"{numerator}/s2"}.get(denominator, f"{numerator}/({denominator}.s)"))


def has_events(drive: Drive) -> bool:
    """True if a shaft of the drive can stick."""
    rest = drive.rest()
    return not (rest.input_slip_direction and rest.output_slip_direction)


def recorded(drive: Drive, found: list[Variable]) -> Mapping[str, signals.Output]:
    """Return the outputs of a drive by the names that they have in its FMU."""
    outputs = [each for each in signals.outputs(drive).values() if each.name != "command"]
    names = [each.name for each in found if each.causality == "output"]
    return dict(zip(names, outputs, strict=True))


def _inputs(drive: Drive) -> Iterator[Variable]:
    """Yield what acts on a drive, in the order of the C++ struct `Input`: each with its rate."""
    load, load_unit, load_doc = _core.load_input(drive)
    pairs = (
        ("command", signals.command_unit(drive), "Command of the controller, or of the motor in open loop", 0.0, -inf),
        (load, load_unit, load_doc, 0.0, -inf),
        ("temperature", "K", "Temperature around the drive", ROOM_TEMPERATURE, 0.0),
    )
    for i, (name, unit, doc, start, low) in enumerate(pairs):
        place = FIRST_INPUT + 2 * i
        shown = _display_unit(name, unit)
        yield Variable(name, place, "input", unit, doc, start, low, display_unit=shown)
        rate = f"{name}_rate" if name != "output_angle" else "output_angle_rate"
        what = f"Rate of {name}: it runs on at this rate within a step; 0 if it is held"
        yield Variable(rate, place + 1, "input", RATES.get(unit, f"{unit}/s"), what, 0.0)


def _outputs(drive: Drive, inputs: set[str]) -> Iterator[Variable]:
    """Yield what a drive shows of itself; an output with the name of an input gets the prefix `drive_`."""
    shown = [each for each in signals.outputs(drive).values() if each.name != "command"]
    for i, each in enumerate(shown):
        name = f"drive_{each.name}" if each.name in inputs else each.name
        yield Variable(name, FIRST_OUTPUT + i, "output", each.unit, each.doc, display_unit=_display_unit(each.name, each.unit))


def _parameters(drive: Drive, step: float) -> Iterator[Variable]:
    """Yield the internal step, initial quantities, and the numbers of the drive, in the order of the C++ array."""
    own = [(STEP_NAME, step, "s", "Largest internal step; a communication step is cut into such steps", MIN_STEP, MAX_STEP)]
    fields = {name: (unit, doc) for name, unit, doc in _core.quantities}
    own += [
        (f"initial.{name}", 0.0, fields[name][0], f"{fields[name][1]} at the start; 0 has no effect", -inf, inf)
        for name in initial_names(drive)
    ]
    for i, (name, value, unit, doc, low, high) in enumerate([*own, *_core.parameters(drive)]):
        yield Variable(name, FIRST_PARAMETER + i, "parameter", unit, " ".join(doc.split()), value, low, high)


def initial_names(drive: Drive) -> tuple[str, ...]:
    """Return the quantities that the FMU of a drive can begin with."""
    return INITIAL[2:] if signals.load_input(drive) == "output_angle" else INITIAL


def _display_unit(name: str, unit: str) -> str:
    """Return the unit in which tools show an input or output."""
    if name == "command":
        return {"rad": "deg", "rad/s": "rpm"}.get(unit, "")
    return SHOWN_BY.get(name.rpartition("_")[2], "")


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
    channels = [each.channel for each in recorded(drive, found).values()]
    initial = [f"strainwave::initial::{each}" for each in initial_names(drive)]
    states = continuous_states(drive)
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

inline constexpr unsigned first_input = {FIRST_INPUT}, first_output = {FIRST_OUTPUT};
inline constexpr unsigned first_parameter = {FIRST_PARAMETER}, first_state = {FIRST_STATE};
inline constexpr int state_count = {len(states)}, indicator_count = {int(has_events(drive))};
inline constexpr double state_nominals[] = {{{_listed(nominal(name) for name, _ in states)}}};
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
