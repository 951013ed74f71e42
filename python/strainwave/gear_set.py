"""Gear sets: a gear with the source of each of its numbers, read from and written to TOML.

What a table of a gear file may hold is what its model describes; no parameter is named here. What is wrong in a file is
refused in one line with file, table and key. docs/gear-files.md shows the format.
"""

from __future__ import annotations

import difflib
import math
import os
import tomllib
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import MISSING, asdict, dataclass, field, fields, replace
from functools import cache, partial
from operator import attrgetter
from pathlib import Path
from types import MappingProxyType
from typing import TYPE_CHECKING, Annotated, Any, NamedTuple, get_type_hints, overload

from strainwave import _core
from strainwave._core import Gear
from strainwave.drives import PositionDrive
from strainwave.recording import _replacing
from strainwave.units import check as check_unit
from strainwave.units import convert

if TYPE_CHECKING:
    from pydantic import BaseModel

NOT_GIVEN = "not given"
CATALOGUE = Path(__file__).with_name("catalogue")

Described = dict[str, Any]  # one of a model's `fields`


@dataclass(frozen=True)
class Entry:
    """Where a number comes from, and how well it is known.

    Args:
        source: document, measurement or rule, one line of text; "not given" where a file leaves the number out
        spread: scatter of individual units about the number, relative; None if not known
        uncertainty: standard deviation of the number, in its unit; None if not known

    Raises:
        ValueError: the source is no line of text, or a number is negative or not finite.
    """

    source: str
    spread: float | None = None
    uncertainty: float | None = None

    def __post_init__(self) -> None:
        _check_line("source", self.source)
        for name in ("spread", "uncertainty"):
            number = getattr(self, name)
            if number is not None and not 0.0 <= number < math.inf:
                raise ValueError(f"{name} = {number} must lie in [0, inf)")


@dataclass(frozen=True, kw_only=True)
class Quantity(Entry):
    """A number with its unit and where it comes from.

    Args:
        value: the number, in `unit`
        unit: a unit that `strainwave.units.check` knows
        source, spread, uncertainty: as in `Entry`

    Raises:
        ValueError: the number is not finite, the unit is not known, or as `Entry`.

    >>> Quantity(value=52.0, unit="N.m", source="catalogue, rated torque").value
    52.0
    """

    value: float
    unit: str

    def __post_init__(self) -> None:
        super().__post_init__()
        check_unit(self.unit)
        if not math.isfinite(self.value):
            raise ValueError(f"value = {self.value} {self.unit} must be finite")


@dataclass(frozen=True)
class GearSet:
    """A gear, the source of each of its numbers, and whatever else is known of it.

    Args:
        name: what the gear is called, one line of text
        gear: its model
        sources: where each number of the gear, motor, control and load comes from, by path as "gear.stiffness.k1",
            "gear.hysteresis.stiffness[0]" or "motor.resistance"
        maker: who makes it
        note: what else is to be said
        ratings: what the maker allows, by name; not a part of the model
        motor, control, load: the rest of a drive, models of `sw.motor`, `sw.control` and `sw.loads`; None if not known

    Raises:
        ValueError: a number has no source, or a source no number
        TypeError: a model is of the wrong family

    >>> gear_set = GearSet.read("csg-20-100")
    >>> gear_set.gear.stiffness.k1, gear_set.sources["gear.stiffness.k1"].spread
    (16000.0, 0.3)
    >>> gear_set.ratings["rated_torque"].value
    52.0
    """

    name: str
    gear: Gear
    sources: Mapping[str, Entry] = field(repr=False, hash=False)
    maker: str = ""
    note: str = ""
    ratings: Mapping[str, Quantity] = field(default_factory=dict, repr=False, hash=False)
    motor: Any = None
    control: Any = None
    load: Any = None

    def __post_init__(self) -> None:
        _check_line("name", self.name)
        PositionDrive(gear=self.gear, **self._rest())  # refuses what is no such model
        paths = [place for table, model in self._models() for place, *_ in _numbers(table.path, model)]
        if bare := [path for path in paths if path not in self.sources]:
            raise ValueError(f"{self.name}: {bare[0]} has no source; give one, or read the set from a file that does")
        if extra := self.sources.keys() - set(paths):
            raise ValueError(f"{self.name}: sources name {min(extra)}, which is no number of its models")
        object.__setattr__(self, "sources", MappingProxyType(dict(self.sources)))
        object.__setattr__(self, "ratings", MappingProxyType(dict(self.ratings)))

    @classmethod
    def of(cls, model: Gear | PositionDrive, *, name: str, source: str, maker: str = "", note: str = "") -> GearSet:
        """A set in which every number has the same source.

        Args:
            model: a gear, or a drive with its gear
            name, maker, note: as in `GearSet`
            source: where the numbers come from

        >>> import strainwave as sw
        >>> GearSet.of(sw.Gear(damping=3.0), name="printed", source="assumed").sources["gear.damping"].source
        'assumed'
        """
        models = {part["name"]: getattr(model, part["name"]) for part in PositionDrive.fields if hasattr(model, part["name"])}
        models.setdefault("gear", model)
        drive = PositionDrive(**models)
        paths = (place for table in _tables() if table.root in models for place, *_ in _numbers(table.path, table.of(drive)))
        return cls(name=name, sources=dict.fromkeys(paths, Entry(source)), maker=maker, note=note, **models)
