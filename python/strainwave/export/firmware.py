"""Controllers as firmware: C++ with the laws and numbers of a sampled controller, and a header in C."""

from __future__ import annotations

import re
from collections.abc import Iterator
from contextlib import ExitStack
from dataclasses import dataclass
from importlib.metadata import version
from pathlib import Path
from typing import Literal, get_args

import numpy as np

from strainwave import Drive, _core, arguments
from strainwave.export import cplusplus
from strainwave.files.writing import making, write_all
from strainwave.messages import quoted, shortened
from strainwave.native.static_type import short_name, static_type
from strainwave.simulation.signals import actuation, command_unit

Scalar = Literal["float", "double"]
SCALARS: tuple[Scalar, ...] = get_args(Scalar)
FLAGS = "-std=c++20 -O2 -ffreestanding -ffp-contract=off -fno-exceptions -fno-rtti -I include"
MAX_NAME = 40  # letters
MAX_FLOAT = float(np.finfo(np.float32).max)
RESERVED = {*SCALARS, "int", "long", "short", "char", "void", "static", "const", "struct", "switch", "return", "main"}

# Inputs of a step, their units and meanings; from the third on the members of a control::Measurement, in its order.
INPUTS = (
    ("command", "", ""),
    ("command_rate", "", "time derivative of the command"),
    ("input_angle", "rad", "as measured; what the controller does not use may be 0"),
    ("input_speed", "rad/s", ""),
    ("output_angle", "rad", ""),
    ("output_speed", "rad/s", ""),
    ("current", "A", "of the motor"),
    ("torque", "N.m", "transmitted, at the output"),
    ("low", "", "least actuation that the motor can follow now"),
    ("high", "", "largest one"),
)
MEASURED = ", ".join(f"in->{name}" for name, *_ in INPUTS[2:-2])


@dataclass(frozen=True)
class Firmware:
    """A controller that was written as firmware.

    Args:
        header: file with the C declarations
        source: file with the C++ source
        include: folder of the headers that the source needs
        state: names of the numbers of the state, in the order of the C struct
    """

    header: Path
    source: Path
    include: Path
    state: tuple[str, ...]


def firmware(drive: Drive, folder: str | Path, *, name: str = "controller", scalar: Scalar = "float") -> Firmware:
    """Write the sampled controller of a drive as C++ source for firmware, with a header in C and the headers that it includes.

    A step of the firmware is an instant of the simulated controller, by the same code, in double precision with the same bits.
    `<name>_start` sets the state; `<name>_step` takes command and measurement, and returns the actuation at once. A `delay` of
    the controller models the time that this takes on the microcontroller, so the source does not contain it.

    Args:
        drive: with a `sw.control.Sampled`; its gear determines the ratio, its motor the unit of the actuation
        folder: where `<name>.h`, `<name>.cpp` and the folder `include` are written; made if it does not exist
        name: of the files, and prefix of all names in C
        scalar: "float" or "double"

    Raises:
        TypeError, ValueError: an argument is not of its kind, or a number of the controller is too large for a float
        OSError: a file cannot be written

    >>> import tempfile
    >>> import strainwave as sw
    >>> law = sw.control.PositionSpeed(position_gain=30.0, speed_proportional=0.1, speed_integral=2.0)
    >>> drive = sw.Drive(control=sw.control.Sampled(law=law))
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     firmware(drive, folder).state
    ('law_speed_integral', 'actuation', 'pending', 'until_sample')
    """
    control = arguments.drive(drive).control
    if not isinstance(control, _core.control.Sampled):
        raise TypeError(f"drive.control = {shortened(control)} must be sampled, as sw.control.Sampled(law=...) makes one")
    _check_name(arguments.text("name", name))
    arguments.one_of("scalar", scalar, SCALARS)
    if scalar == "float":
        _check_range(control)
    folder = Path(folder)
    written = Firmware(folder / f"{name}.h", folder / f"{name}.cpp", folder / "include", tuple(_elements(drive)))
    source = _source(drive, control, name, scalar)
    headers = cplusplus.closure(cplusplus.headers(source))
    texts: dict[Path, str | bytes] = {written.include / header: text for header, text in headers.items()}
    texts |= {written.header: _header(drive, control, name, scalar), written.source: source}
    with ExitStack() as stack:
        for each in sorted({path.parent for path in texts}):
            stack.enter_context(making(each))
        write_all(texts)
    return written


def _check_name(name: str) -> None:
    if not re.fullmatch(r"[A-Za-z][A-Za-z0-9_]*", name) or len(name) > MAX_NAME or name in RESERVED:
        allowed = f"letters, digits and underscores, {MAX_NAME} at most, the first a letter, and no word of the language"
        raise ValueError(f"name = {quoted(name)} must be a name in C: {allowed}")


def _check_range(control: _core.control.Sampled) -> None:
    for path, value in cplusplus.numbers(control):
        if abs(value) > MAX_FLOAT:
            raise ValueError(f'{path} = {value:g} is too large for a float; give scalar="double", or a smaller number')


def _state(drive: Drive) -> Iterator[tuple[str, int, str]]:
    """Yield the members of the state, each with its number of elements, 0 if it is none of an array, and its unit."""
    members: dict[str, tuple[int, str]] = {}
    for path, unit, part in _core.state(drive)[0]:
        if part == "control":
            member, bracket, _ = path.removeprefix("control.").replace(".", "_").partition("[")
            members[member] = (members.get(member, (0, ""))[0] + bool(bracket), unit)
    return ((member, size, unit) for member, (size, unit) in members.items())


def _elements(drive: Drive) -> Iterator[str]:
    """Yield the names of the numbers of the state."""
    for member, size, _ in _state(drive):
        yield from (f"{member}[{i}]" for i in range(size)) if size else [member]


def _header(drive: Drive, control: _core.control.Sampled, name: str, scalar: Scalar) -> str:
    """Return the declarations in C."""
    command, given = command_unit(drive), actuation(drive)
    units = {"command": command, "command_rate": f"{command}/s", "low": given.unit, "high": given.unit}
    inputs = "".join(
        f"    {scalar} {member};  /* {units.get(member, unit)}{meaning and f'; {meaning}'} */\n"
        for member, unit, meaning in INPUTS
    )
    state = "".join(
        f"    {scalar} {member}{f'[{size}]' if size else ''};  /* {unit} */\n" for member, size, unit in _state(drive)
    )
    return f"""/* Controller {short_name(control)}.

   Written by strainwave {version("strainwave")}. Compile its source, {name}.cpp, by GCC 12, Clang 14 or later, in this folder:

       c++ {FLAGS} -c {name}.cpp

   Call {name}_start once, then {name}_step every {control.period!r} s. Several motors: a state for each. */
#ifndef {name.upper()}_H
#define {name.upper()}_H
#ifdef __cplusplus
extern "C" {{
#endif

typedef struct {{
{inputs}}} {name}_inputs;

typedef struct {{
{state}}} {name}_state;

void {name}_start({name}_state* state);

/* Return the {given.name} of the motor [{given.unit}], within [low, high]. */
{scalar} {name}_step({name}_state* state, const {name}_inputs* in);

#ifdef __cplusplus
}}
#endif
#endif
"""


def _source(drive: Drive, control: _core.control.Sampled, name: str, scalar: Scalar) -> str:
    """Return the source in C++."""
    includes = "".join(f"#include <{header}>\n" for header in cplusplus.headers_of(control))
    numbers = "".join(f"    {line}\n" for line in cplusplus.assignments(control.replace(delay=0.0), "control"))
    return f"""// Controller {short_name(control)}; see {name}.h.
#include "{name}.h"

{includes}
namespace {{

using S = {scalar};
using Control = {static_type(control, "S")};

constexpr S ratio{{S({drive.gear.kinematics.ratio!r})}};
constexpr auto made = [] {{
    Control control{{}};
{numbers}    return control;
}};
constexpr auto control = made().compile();

using Discrete = decltype(control.initial_discrete());
using Numbers = strainwave::Flat<S, Discrete>;
static_assert(sizeof(Numbers) == sizeof({name}_state));

void store(const Discrete& x, {name}_state* state) {{ *state = __builtin_bit_cast({name}_state, strainwave::flattened<S>(x)); }}

}}  // namespace

extern "C" void {name}_start({name}_state* state) {{ store(control.initial_discrete(), state); }}

extern "C" S {name}_step({name}_state* state, const {name}_inputs* in) {{
    const strainwave::control::Command<S> command{{in->command, in->command_rate, ratio}};
    const strainwave::control::Measurement<S> measured{{{MEASURED}, {{in->low, in->high}}}};
    const Discrete x = strainwave::refilled(control.initial_discrete(), __builtin_bit_cast(Numbers, *state));
    const Discrete now = control.elapsed(control.sampled(x, x.until_sample, command, measured), control.period);
    store(now, state);
    return control.held(now);
}}
"""
