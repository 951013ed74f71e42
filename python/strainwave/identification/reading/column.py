"""A column of a file that seems to be a channel."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from strainwave.files.labels import Label
from strainwave.identification.reading.channels import Channel

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Column:
    """A column that seems to be a channel.

    Args:
        position: where it stands in the file, from 0
        label: what the file calls it
        channel: what it measures
        which: what else its name says, as the number of a joint
        robot: whether its name is that of a robot's joint channel
        said: whether a person said what it is
        neighbour: whether it is the angle of another joint than the one that is asked for
        regressor: whether it is a torque of which a share that is not known acts
        unit: its unit in the file; None where none is stated
        sure: whether its unit is stated, or its numbers tell it by themselves
        is_open: True if its unit is not stated, and its numbers leave others
        estimated: whether its name says that it is an estimate
        values: in SI units, once they are read
    """

    position: int
    label: Label
    channel: Channel
    which: str = ""
    robot: bool = False
    said: bool = False
    neighbour: bool = False
    regressor: bool = False
    unit: str | None = None
    sure: bool = True
    is_open: bool = False
    estimated: bool = False
    values: Array | None = None

    @property
    def own(self) -> bool:
        """Whether it is a channel of the joint that is asked for."""
        return not (self.neighbour or self.regressor)

    @property
    def si(self) -> Array:
        assert self.values is not None
        return self.values

    @property
    def name(self) -> str:
        return self.label.name
