"""Firmware of a part of a drive: a controller, a law of the gear, or the whole drive."""

from __future__ import annotations

from collections.abc import Iterable
from contextlib import ExitStack
from dataclasses import dataclass
from datetime import UTC, datetime
from hashlib import sha256
from importlib import metadata
from pathlib import Path
from typing import Any

import numpy as np

from strainwave import Drive, Gear, arguments
from strainwave.export import cplusplus
from strainwave.export.exported import Form, comment_of
from strainwave.export.firmware import source
from strainwave.export.firmware.step import Member, step
from strainwave.export.host import checked_name
from strainwave.files import gear_file
from strainwave.files.gear_set import GearSet
from strainwave.files.ratings import drive_of
from strainwave.files.writing import making, write_all
from strainwave.native.static_type import SCALARS, Scalar
from strainwave.presentation import Presented

FLAGS = source.FLAGS
MAX_FLOAT = float(np.finfo(np.float32).max)
KEYWORDS = """
    S alignas alignof and and_eq asm auto bitand bitor bool break case catch char class compl concept const
    const_cast consteval constexpr constinit continue decltype default delete do double dynamic_cast else enum
    explicit export extern false float for friend goto if inline int long main mutable namespace new noexcept not
    not_eq nullptr operator or or_eq private protected public register reinterpret_cast requires restrict return
    short signed sizeof static static_assert static_cast std strainwave struct switch template this throw true try
    typedef typeid typename union unsigned using virtual void volatile while xor xor_eq
"""  # of C and C++, and names that the files use
RESERVED = frozenset(KEYWORDS.split())


@dataclass(frozen=True)
class Firmware(Presented):
    """A part of a drive that was written as firmware.

    Attributes:
        header: file with the step in C++ and all that it needs
        declarations: file with the declarations in C
        source: file with the C++ source of what the declarations declare
        example: program in C that calls the step from a timer
        inputs, state, outputs: names of the numbers of the structs in C, in their order
        scalar: type of all numbers
        period: time from one step to the next [s]; 0 if the time does not matter

    >>> import tempfile
    >>> import strainwave as sw
    >>> law = sw.control.PositionSpeed(position_gain=30.0, speed_proportional=0.1)
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     written = sw.export.firmware(sw.Drive(control=sw.control.Sampled(law=law)), folder)
    >>> written.header.name, written.outputs, written.period
    ('controller.hpp', ('voltage',), 0.001)
    """

    header: Path
    declarations: Path
    source: Path
    example: Path
    inputs: tuple[str, ...]
    state: tuple[str, ...]
    outputs: tuple[str, ...]
    scalar: Scalar
    period: float


def firmware(
    drive: Drive | GearSet | Gear,
    folder: str | Path,
    *,
    part: str = "control",
    name: str | None = None,
    scalar: Scalar = "float",
    period: float | None = None,
) -> Firmware:
    """Write a part of a drive as C++ for firmware: one header without includes, and two small files that give it to C.

    A step of the firmware returns the outputs at its instant, and moves the state on to the next. The code is that of the
    simulation, in double precision with the same numbers. A `delay` of a sampled controller models the time that its step takes
    on the microcontroller, so the firmware of the controller does not contain it.

    Args:
        drive: the drive, a set with one, or for a law of the gear the gear alone
        folder: where `<name>.hpp`, `<name>.h`, `<name>.cpp` and the example `<name>_main.c` are written; made if there is none
        part: "control", the sampled controller with its compensation; "drive", motor, gear, load and controller by the steps of
            `sw.simulate`; or a law of the gear: "gear.friction_input", "gear.friction_mesh", "gear.friction_output",
            "gear.stiffness", "gear.hysteresis", "gear.kinematic_error" or "gear.kinematic_noise"
        name: of the files, and prefix of all names in C; by default "controller", or the last word of the part
        scalar: "float" or "double"
        period: time between steps of the drive or of a friction [s]; by default that of a simulation, 0.2 ms or shorter. It
            must divide period and delay of a sampled controller in the drive. A controller as part has its own

    Returns:
        The paths of the files, and the names of inputs, state and outputs of a step.

    Raises:
        TypeError, ValueError: an argument is not of its kind, or a number of the part is too large for a float
        OSError: a file cannot be written

    >>> import tempfile
    >>> import strainwave as sw
    >>> law = sw.control.PositionSpeed(position_gain=30.0, speed_proportional=0.1, speed_integral=2.0)
    >>> drive = sw.Drive(control=sw.control.Sampled(law=law))
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     firmware(drive, folder).state[:4], firmware(drive, folder, part="gear.stiffness").outputs
    (('law_speed_integral', 'actuation', 'pending', 'until_sample'), ('torque', 'tangent'))
    """
    found = step(drive_with(drive, part), part, period)
    name = {"control": "controller"}.get(part, part.rpartition(".")[2]) if name is None else name
    checked_name(name, "C", reserved=RESERVED)
    arguments.one_of("scalar", scalar, SCALARS)
    if scalar == "float":
        _check_range(found.model)
    folder = Path(folder)
    about = comment_of(_provenance(drive), "// ")
    texts: dict[Path, str | bytes] = {folder / file: about + text for file, text in source.texts(found, name, scalar).items()}
    with ExitStack() as stack:
        stack.enter_context(making(folder))
        write_all(texts)
    header, declarations, own_source, example = texts
    return Firmware(
        header,
        declarations,
        own_source,
        example,
        tuple(_elements(found.inputs)),
        tuple(_elements(found.state)),
        tuple(_elements(found.outputs)),
        scalar,
        found.period,
    )


def _provenance(model: Drive | GearSet | Gear) -> list[str]:
    """Return lines that state what a file was written of, when and by what, and which numbers were identified."""
    made = f"Written on {datetime.now(UTC):%Y-%m-%d} by strainwave {metadata.version('strainwave')} (Apache-2.0)"
    if not isinstance(model, GearSet):
        return [f"{made} of a {'gear' if isinstance(model, Gear) else 'drive'} made in Python"]
    digest = sha256(gear_file.text(model).encode()).hexdigest()
    lines = [f"{made} of {model.name}", f"sha256 of its gear.toml, as strainwave writes it: {digest}"]
    return [*lines, *([f"numbers of {model.name}", *model.origins] if model.origins else [])]


def drive_with(model: Drive | GearSet | Gear, part: str) -> Drive:
    """Return the drive that a part is of; of a gear alone, a drive that has it."""
    if isinstance(part, str) and part.startswith("gear."):
        gear = model.gear if isinstance(model, GearSet) else model
        if isinstance(gear, Gear):
            return Drive(gear=gear)
    return drive_of(model)


def _check_range(model: Any) -> None:
    for path, value in cplusplus.numbers(model):
        if abs(value) > MAX_FLOAT:
            raise ValueError(f'{path} = {value:g} is too large for a float; give scalar="double", or a smaller number')


def _elements(members: Iterable[Member]) -> Iterable[str]:
    """Yield the names of the numbers of some members."""
    for each in members:
        yield from (f"{each.name}[{i}]" for i in range(len(each.start))) if each.is_array else [each.name]


FIRMWARE = Form(firmware, "a microcontroller", "one C++ header, an interface in C and an example", "firmware.md")
