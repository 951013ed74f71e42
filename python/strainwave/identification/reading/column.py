"""A column of a file that seems to be a channel."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from strainwave.files.labels import Label
from strainwave.files.units import measures
from strainwave.identification.reading.channels import Channel
from strainwave.messages import MAX_TEXT, one_line

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Column:
    """A column that seems to be a channel.

    Args:
        position: in the file, from 0
        label: its header in the file
        channel: what it measures
        which: the rest of its name, as the number of a joint
        robot: True if its name is that of a robot's joint channel
        by_user: True if a person named it
        neighbour: True for the angle of another joint than the one that is asked for
        regressor: True for a torque of which an unknown share acts
        unit: its unit in the file; None if none is stated
        sure: True if its unit is stated, or its numbers allow no other
        estimated: True if its name is that of an estimate
        raw: its numbers in the file, once they are read, nan in empty cells
        si: the same in SI units
    """

    position: int
    label: Label
    channel: Channel
    which: str = ""
    robot: bool = False
    by_user: bool = False
    neighbour: bool = False
    regressor: bool = False
    unit: str | None = None
    sure: bool = True
    estimated: bool = False
    raw: Array = field(default_factory=lambda: np.zeros(0))
    si: Array = field(default_factory=lambda: np.zeros(0))

    @property
    def own(self) -> bool:
        """True for a channel of the joint that is asked for."""
        return not (self.neighbour or self.regressor)

    @property
    def name(self) -> str:
        """Name in the file, as messages and reports show it: on one line, without characters that a terminal obeys."""
        return one_line(self.label.name)

    @property
    def reference(self) -> str:
        """Name in the file; its number from 1 if its name cannot be typed."""
        name = self.label.name
        return name if self.name == name and len(name) <= MAX_TEXT else str(self.position + 1)

    @property
    def at_joint(self) -> bool:
        """True if it is measured at the output by its name, or called like a channel of a robot's joint."""
        return self.channel.side == "output" or (self.robot and self.channel.side is None)

    @property
    def si_unit(self) -> str:
        """Unit of `si`: a command may be an angle or a voltage."""
        return "V" if self.channel.commanded and self.unit is not None and measures(self.unit, "V") else self.channel.unit
