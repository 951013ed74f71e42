"""Inputs of an exported drive by its host program: a name, a command that is held or followed, and an internal step."""

from __future__ import annotations

import re
from inspect import signature
from typing import Literal, get_args

from strainwave import Drive, _core, arguments
from strainwave.messages import quoted
from strainwave.simulation.excitation import ROOM_TEMPERATURE
from strainwave.simulation.resolution import FASTEST_ON_BRISTLES, MAX_STEP_PHASE, fine_enough, rounded_down
from strainwave.simulation.run import simulate
from strainwave.simulation.signals import command_unit

MAX_NAME_LENGTH = 40  # characters
Command = Literal["followed", "held"]
COMMAND_MODES: tuple[Command, ...] = get_args(Command)
TRAJECTORIES = ("rad", "rad/s")  # units of commands that are one
MIN_STEP = 1e-7  # s
DEFAULT_STEP = signature(simulate).parameters["dt"].default  # s
MAX_HALVINGS = 20  # of the step, for bristles


def checked_name(name: object, program: str, *, hyphens: bool = False, reserved: frozenset[str] = frozenset()) -> str:
    """Return a name that another program takes.

    Args:
        name: given by the user
        program: or language, as a message names it
        hyphens: whether they may be in the name
        reserved: words of the language, which are no names

    Raises:
        TypeError, ValueError: it is none

    >>> checked_name("2 joints", "ROS")
    Traceback (most recent call last):
    ValueError: name = "2 joints" must be a name in ROS: letters, digits and underscores, 40 at most, the first a letter
    """
    text = arguments.text("name", name)
    pattern = r"[A-Za-z][A-Za-z0-9_-]*" if hyphens else r"[A-Za-z][A-Za-z0-9_]*"
    if re.fullmatch(pattern, text) and len(text) <= MAX_NAME_LENGTH and text not in reserved:
        return text
    letters = "letters, digits, underscores and hyphens" if hyphens else "letters, digits and underscores"
    words = ", and no word of the language" if reserved else ""
    raise ValueError(
        f"name = {quoted(text)} must be a name in {program}: {letters}, {MAX_NAME_LENGTH} at most, the first a letter{words}"
    )


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


def internal_step(drive: Drive, step: float | None, name: str = "step") -> float:
    """Return the internal step of an exported drive [s]: a given one that is short enough, or the default.

    Args:
        drive: that is exported
        step: given by the user [s]; None for the default
        name: of the argument

    Raises:
        TypeError, ValueError: the step is not a number in its range, or too coarse for the drive

    >>> internal_step(Drive(), 0.1)
    Traceback (most recent call last):
    ValueError: step = 0.1 s is too coarse: the drive is as fast as a vibration of 1.05e+03 rad/s; give 0.00095 s or less
    """
    if step is None:
        return default_step(drive)
    step = arguments.number(name, step, "s", low=MIN_STEP)
    fastest, bristles = _core.max_rate(drive, 0.0, ROOM_TEMPERATURE), _core.bristle_frequency(drive)
    longest = MAX_STEP_PHASE / fastest
    reason = f"the drive is as fast as a vibration of {fastest:.3g} rad/s"
    if bristles * longest > FASTEST_ON_BRISTLES:
        longest = FASTEST_ON_BRISTLES / bristles
        reason = f"a shaft vibrates on its bristles at {bristles:.3g} rad/s"
    if step <= longest:
        return step
    raise ValueError(f"{name} = {step:g} s is too coarse: {reason}; give {rounded_down(longest):g} s or less")


def default_step(drive: Drive) -> float:
    """Return the internal step of a drive [s]: 0.2 ms, or half, a quarter … where its vibrations need that.

    Raises:
        ValueError: its bristles need steps shorter than `MIN_STEP`

    >>> default_step(Drive())
    0.0002
    """
    step = float(fine_enough(drive, DEFAULT_STEP, MIN_STEP))
    stiffest = _core.bristle_frequency(drive)
    for _ in range(MAX_HALVINGS):
        if step * stiffest <= FASTEST_ON_BRISTLES:
            break
        step *= 0.5
    if step < MIN_STEP:
        raise ValueError(
            f"a shaft of this drive vibrates on its bristles at {stiffest:.3g} rad/s, which needs steps of "
            f"{FASTEST_ON_BRISTLES / stiffest:.2g} s; give step, or friction with softer bristles or with Coulomb's law"
        )
    return step
