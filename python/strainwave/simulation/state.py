"""The state of a drive: what a run goes on from, number by number, each with its name."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from strainwave import Drive, _core
from strainwave.messages import listed, shortened
from strainwave.presentation import Presented, Row

Array = NDArray[np.float64]


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
        found = np.zeros((self.count, 1))
        for place in ("friction_input", "friction_mesh", "friction_output"):
            found[self.places[place]] = 1.0
        return found


def same_shape(one: Drive, other: Drive) -> bool:
    """True if states of one drive are states of another."""
    return one is other or _core.shape(one) == _core.shape(other)


def start_of(drive: Drive, state: object, name: str = "initial") -> State:
    """A state given as argument `name`, if it is one of this drive.

    Raises:
        TypeError: it is no state
        ValueError: it is a state of a drive with other models
    """
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
