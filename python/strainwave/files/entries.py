"""Numbers, and where they come from."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass
from math import hypot

from strainwave import arguments
from strainwave.files.units import check as check_unit, convert
from strainwave.messages import shortened

NOT_GIVEN = "not given"
OPPOSITE = "of the log = -"  # in the source of a motor whose effort a log counts in the other sense


@dataclass(frozen=True)
class Entry:
    """Source of a number, with its spread and its standard deviation.

    Args:
        source: document, measurement or rule, one line of text; "not given" where a file leaves out the whole table
        spread: scatter of individual gears about the number, relative; None if not known
        uncertainty: standard deviation of the number, in its unit; None if not known

    Raises:
        ValueError: the source is no line of text, or a number is negative or not finite.

    >>> import strainwave as sw
    >>> entry = sw.files.Entry("maker's catalogue", spread=0.3)  # single gears scatter by 30 %
    >>> entry.sigma(31000.0), entry.assumed
    (9300.0, False)
    """

    source: str
    spread: float | None = None
    uncertainty: float | None = None

    @property
    def assumed(self) -> bool:
        """True if the number was neither measured nor published."""
        return self.source.startswith("assumed") or self.source == NOT_GIVEN

    def sigma(self, value: float) -> float | None:
        """Return the standard deviation of a value from this source; None if it states neither spread nor uncertainty."""
        stated = self.spread is not None or self.uncertainty is not None
        return hypot((self.spread or 0.0) * value, self.uncertainty or 0.0) if stated else None

    def __post_init__(self) -> None:
        check_line("source", self.source)
        for name in ("spread", "uncertainty"):
            if (number := getattr(self, name)) is not None:
                arguments.bare_number(name, number, brackets="[)", low=0.0)


@dataclass(frozen=True, kw_only=True)
class Quantity(Entry):
    """A number with its unit and its source.

    Args:
        value: the number, in `unit`
        unit: a unit that `strainwave.files.units.check` knows
        source, spread, uncertainty: as in `Entry`

    Raises:
        ValueError: the number is not finite, the unit is not known, or as in `Entry`.

    >>> Quantity(value=30.0, unit="rpm", source="measured on the rig").to("rad/s").value
    3.141592653589793
    """

    value: float
    unit: str

    def __post_init__(self) -> None:
        super().__post_init__()
        check_unit(self.unit)
        arguments.bare_number("value", self.value, self.unit)

    def to(self, unit: str) -> Quantity:
        """Return the quantity in another unit.

        Raises:
            ValueError: the unit is not known, or measures something else
        """
        if arguments.text("unit", unit) == self.unit:
            return self
        uncertainty = self.uncertainty
        if uncertainty is not None:  # a difference: the zeros of the units do not count
            uncertainty *= convert(1.0, self.unit, unit) - convert(0.0, self.unit, unit)
        return dataclasses.replace(self, value=convert(self.value, self.unit, unit), unit=unit, uncertainty=uncertainty)


def check_line(name: str, text: str) -> None:
    if not arguments.text(name, text).strip() or not text.isprintable():
        raise ValueError(f"{name} = {shortened(text)} must be one line of text")
