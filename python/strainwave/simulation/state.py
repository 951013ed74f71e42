"""The state of a drive: what a run goes on from, number by number, each with its name."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from functools import cached_property
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

from strainwave import Drive, _core, arguments
from strainwave.messages import listed, shortened
from strainwave.presentation import Presented, Row
from strainwave.simulation.signals import load_input, outputs

Array = NDArray[np.float64]
Known = tuple[list[int], Array]  # the numbers of quantities, and their values, shape (quantities, members)

INITIAL_QUANTITIES = {name: (number, unit) for number, (name, unit, _) in enumerate(_core.quantities)}


class State(Presented, Mapping[str, float]):
    """A drive at one instant: its continuous numbers, what its parts remember, and which way its shafts slip.

    A mapping of names to numbers. The numbers of a part have its name in front: ``state["friction_input.deflection"]``.
    Those of the drive itself are attributes, too: ``state.input_speed``. A state never changes; ``replace`` gives another.

    It belongs to drives whose parts have the same models. Whatever takes a state refuses that of another drive.

    >>> import strainwave as sw
    >>> rest = sw.Drive().rest()
    >>> rest.replace(input_speed=50.0)["input_speed"]
    50.0
    """

    __slots__ = ("__dict__", "drive", "numbers")
    drive: Drive
    numbers: Array  # (n,), in the order of the names; first what is continuous

    @classmethod
    def of(cls, drive: Drive, numbers: Array) -> State:
        """A state of `drive` with these numbers, which nobody changes any more."""
        state = object.__new__(cls)
        numbers.setflags(write=False)
        object.__setattr__(state, "drive", drive)
        object.__setattr__(state, "numbers", numbers)
        return state

    def __init__(self) -> None:
        raise TypeError("a state is made by a drive's rest(), by sw.analysis.equilibrium(...), or is the end of a run")

    def replace(self, changes: Mapping[str, float | str] | None = None, /, **named: float | str) -> State:
        """The same state with other numbers, by their names.

        Raises:
            TypeError: a value is not a number
            ValueError: a name is not that of a number of this state, or a value is not finite
        """
        from strainwave import arguments

        numbers = self.numbers.copy()
        for name, value in {**(changes or {}), **named}.items():
            place = self._place(name)
            numbers[place] = arguments.number(name, value, self._described[place][1])
        return State.of(self.drive, numbers)

    @property
    def units(self) -> dict[str, str]:
        """The unit of each number."""
        return {name: unit for name, unit, _ in self._described}

    @cached_property
    def _described(self) -> list[tuple[str, str, str]]:
        return _core.state(self.drive)[0]

    @cached_property
    def _places(self) -> dict[str, int]:
        return {name: place for place, (name, _, _) in enumerate(self._described)}

    def _place(self, name: str) -> int:
        from strainwave import arguments

        return self._places[arguments.one_of("the name of a number", name, tuple(self._places))]

    def __getitem__(self, name: str) -> float:
        if name not in self:
            raise KeyError(f"a state of this drive has no {shortened(name)}; it has {listed(self._places)}")
        return float(self.numbers[self._places[name]])

    def __contains__(self, name: object) -> bool:
        return isinstance(name, str) and name in self._places

    def __getattr__(self, name: str) -> float:
        if name.startswith("_") or name not in self._places:
            raise AttributeError(f"a state of this drive has no {name!r}")
        return float(self.numbers[self._places[name]])

    def __setattr__(self, name: str, value: Any) -> None:
        raise AttributeError(f"a state never changes; state.replace({name}=...) gives another")

    def __iter__(self) -> Iterator[str]:
        return iter(self._places)

    def __len__(self) -> int:
        return len(self.numbers)

    def __dir__(self) -> list[str]:
        return [*super().__dir__(), *(name for name in self._places if "." not in name)]

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, State):
            return NotImplemented
        return bool(np.array_equal(self.numbers, other.numbers)) and same_shape(self.drive, other.drive)

    def __hash__(self) -> int:
        return hash((tuple(_core.shape(self.drive).items()), tuple(self.numbers.tolist())))

    def _headline(self) -> str:
        return ", ".join(f"{name}={value:.6g}" for name, value in self.items() if value != 0.0)

    def _rows(self) -> Iterator[Row]:
        return (Row(name, value, self.units[name]) for name, value in self.items())

    def __reduce__(self) -> tuple[Any, ...]:
        return State.of, (self.drive, np.array(self.numbers))


class StateLayout:
    """Places of the numbers in a drive's state.

    Attributes:
        names: of the numbers, in order
        units: of each
        count: how many are continuous; those come first
        places: by each name, and by each part that has continuous numbers or none: a slice
    """

    def __init__(self, drive: Drive) -> None:
        described, self.count = _core.state(drive)
        self.names = [name for name, _, _ in described]
        self.units = {name: unit for name, unit, _ in described}
        owners = [part for _, _, part in described]
        self.places = {part: slice(0, 0) for part in _core.shape(drive)}
        for place, (name, part) in enumerate(zip(self.names, owners, strict=True)):
            self.places[name] = slice(place, place + 1)
            if part != name and owners.index(part) == place:
                self.places[part] = slice(place, place + owners.count(part))

    def friction(self) -> Array:
        """1 for each continuous number of friction, 0 for the others; shape (count, 1)."""
        mask = np.zeros((self.count, 1))
        for place in ("friction_input", "friction_mesh", "friction_output"):
            mask[self.places[place]] = 1.0
        return mask


def same_shape(one: Drive, other: Drive) -> bool:
    """True if states of one drive are states of another."""
    return one is other or _core.shape(one) == _core.shape(other)


def start_of(drive: Drive, state: object, name: str = "initial") -> State:
    """A state given as argument `name`, if it is one of this drive."""
    if not isinstance(state, State):
        raise TypeError(
            f"{name} = {shortened(state)} must be a state of a drive, as `end` of a run or sw.analysis.equilibrium(...) is one"
        )
    if not same_shape(drive, state.drive):
        mine, given = _core.shape(drive), _core.shape(state.drive)
        part = next(part for part in mine if mine[part] != given[part])
        counts = " with other numbers of elements" if mine[part][0] == given[part][0] else ""
        raise ValueError(
            f"{name} is a state of another drive: its {part} is {given[part][0]}{counts}, here it is {mine[part][0]}; "
            "begin with rest() of this drive"
        )
    return state if state.drive is drive else State.of(drive, state.numbers)


Initial: TypeAlias = State | Mapping[str, float | str]  # what a run begins with


def known(drive: Drive, initial: Mapping[str, ArrayLike] | None, members: int = 1) -> Known | None:
    """The quantities that `initial` names, as the core takes them; None for a start at rest.

    Where the load prescribes the motion of the output shaft a run never begins at rest, but where that motion does.
    """
    prescribed = load_input(drive) == "output_angle"
    if initial is None and not prescribed:
        return None
    if initial is not None:
        arguments.mapping("initial", initial, '{"output_angle": 0.3, "input_speed": 5.0}')
    values = {name: _value(str(name), value, members) for name, value in (initial or {}).items()}
    for name in values:
        arguments.one_of("the name of a quantity in initial", name, tuple(INITIAL_QUANTITIES))
    _check_together(drive, set(values), prescribed)
    rows = [np.broadcast_to(value, members) for value in values.values()]
    return [INITIAL_QUANTITIES[name][0] for name in values], np.array(rows, dtype=np.float64).reshape(len(rows), members)


def _value(name: str, value: ArrayLike, members: int) -> Array:
    if isinstance(value, str):
        value = arguments.number(f"initial {name}", value, INITIAL_QUANTITIES[name][1] if name in INITIAL_QUANTITIES else "")
    values = arguments.numbers(f"initial {name}", value)
    if values.shape not in ((), (members,)):
        each = "one value" if members == 1 else f"one value, or one for each of {members} members"
        raise ValueError(f"initial {name} must be {each}, not of shape {values.shape}")
    if not np.isfinite(values).all():
        raise ValueError(f"initial {name} must be finite")
    return values


def _check_together(drive: Drive, names: set[str], prescribed: bool) -> None:
    """Refuse quantities that contradict each other, or that this drive does not have."""
    names_given = names | ({"output_angle"} if prescribed else set())
    if prescribed and (inputs := names & {"output_angle", "output_speed"}):
        raise ValueError(f"initial {min(inputs)}: the load prescribes it; it is an input of the run")
    angles, twists = names_given & {"input_angle", "output_angle"}, names_given & {"twist", "torque"}
    if len(twists) == 2 or (len(angles) == 2 and twists):
        too_many = sorted(twists | (angles if len(angles) == 2 else set()))
        raise ValueError(f"initial: of {listed(too_many)} each follows from the others; leave one out")
    if "current" in names and ("current" not in outputs(drive) or getattr(drive.motor, "inductance", 0.0) == 0.0):
        raise ValueError("initial current: it follows at once from what this motor is given; leave it out")


def beginning_numbers(drive: Drive, initial: Initial | Mapping[str, ArrayLike] | None, inputs: Array) -> Array:
    """The numbers of the state that a single run begins in, under the inputs of its first instant."""
    if isinstance(initial, State):
        return start_of(drive, initial).numbers
    given = known(drive, initial)
    if given is None:
        return drive.rest().numbers
    numbers = _core.started(drive, given[0], given[1][:, 0].copy(), inputs)
    if not np.isfinite(numbers).all():
        raise ValueError(_core.no_beginning(bool(initial)))
    return numbers
