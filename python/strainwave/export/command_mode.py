"""Commands of exported drives between two instants at which a host sets them: held, or followed."""

from __future__ import annotations

from typing import Literal, get_args

from strainwave import Drive, arguments
from strainwave.simulation.signals import command_unit

Command = Literal["followed", "held"]
COMMAND_MODES: tuple[Command, ...] = get_args(Command)
TRAJECTORIES = ("rad", "rad/s")  # units of commands that are one


def command_mode(drive: Drive, given: Command | None) -> Command:
    """Return whether a command is held or followed; by default followed if it is a trajectory, which a controller takes.

    Raises:
        TypeError, ValueError: `given` is neither

    >>> command_mode(Drive(), None)
    'held'
    """
    if given is not None:
        arguments.one_of("command", given, COMMAND_MODES)
        return given
    return "followed" if command_unit(drive) in TRAJECTORIES else "held"
