"""Initial state of a run: at rest, a state of another run, or a few known quantities from which the rest follows."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

from strainwave import Drive, _core, arguments
from strainwave.messages import listed
from strainwave.simulation.signals import load_input, outputs
from strainwave.simulation.state import State, start_of

Array = NDArray[np.float64]
Known = tuple[list[int], Array]  # the numbers of quantities, and their values, shape (quantities, members)
Initial: TypeAlias = State | Mapping[str, float | str]  # what a run begins with
QUANTITIES = {name: (number, unit) for number, (name, unit, _) in enumerate(_core.quantities)}


def known(drive: Drive, initial: Mapping[str, ArrayLike] | None, members: int = 1) -> Known | None:
    """The quantities that `initial` names, as the core takes them; None for a start at rest.

    Where the load prescribes the motion of the output shaft a run never begins at rest, but where that motion does.

    Raises:
        TypeError: it is no mapping, or a value is no number
        ValueError: a quantity is not known, not finite, or not one value for each member, or they contradict each other
    """
    prescribed = load_input(drive) == "output_angle"
    if initial is None and not prescribed:
        return None
    if initial is not None:
        arguments.mapping("initial", initial, '{"output_angle": 0.3, "input_speed": 5.0}')
    values = {name: _value(str(name), value, members) for name, value in (initial or {}).items()}
    for name in values:
        arguments.one_of("the name of a quantity in initial", name, tuple(QUANTITIES))
    _check_together(drive, set(values), prescribed)
    rows = [np.broadcast_to(value, members) for value in values.values()]
    return [QUANTITIES[name][0] for name in values], np.array(rows, dtype=np.float64).reshape(len(rows), members)


def _value(name: str, value: ArrayLike, members: int) -> Array:
    unit = QUANTITIES[name][1] if name in QUANTITIES else ""
    if isinstance(value, str):
        value = arguments.number(f"initial {name}", value, unit)
    given = arguments.numbers(f"initial {name}", value)
    if given.shape not in ((), (members,)):
        each = "one value" if members == 1 else f"one value, or one for each of {members} members"
        raise ValueError(f"initial {name} must be {each}, not of shape {given.shape}")
    if not np.isfinite(given).all():
        raise ValueError(f"initial {name} must be finite")
    return given


def _check_together(drive: Drive, names: set[str], prescribed: bool) -> None:
    """Refuse quantities that contradict each other, or that this drive does not have."""
    given = names | ({"output_angle"} if prescribed else set())
    if prescribed and (inputs := names & {"output_angle", "output_speed"}):
        raise ValueError(f"initial {min(inputs)}: the load prescribes it; it is an input of the run")
    angles, twists = given & {"input_angle", "output_angle"}, given & {"twist", "torque"}
    if len(twists) == 2 or (len(angles) == 2 and twists):
        too_many = sorted(twists | (angles if len(angles) == 2 else set()))
        raise ValueError(f"initial: of {listed(too_many)} each follows from the others; leave one out")
    if "current" in names and ("current" not in outputs(drive) or getattr(drive.motor, "inductance", 0.0) == 0.0):
        raise ValueError("initial current: it follows at once from what this motor is given; leave it out")


def beginning_numbers(drive: Drive, initial: Initial | Mapping[str, ArrayLike] | None, inputs: Array) -> Array:
    """The numbers of the state that a single run begins in, under the inputs of its first instant.

    Raises:
        TypeError: as `known`
        ValueError: `initial` is a state of another drive, there is no state that has these quantities, or as `known`
    """
    if isinstance(initial, State):
        return start_of(drive, initial).numbers
    given = known(drive, initial)
    if given is None:
        return drive.rest().numbers
    numbers = _core.started(drive, given[0], given[1][:, 0].copy(), inputs)
    if not np.isfinite(numbers).all():
        raise ValueError(_core.no_beginning(bool(initial)))
    return numbers
