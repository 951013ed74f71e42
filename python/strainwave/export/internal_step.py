"""Internal steps of exported drives: the default, and the longest that a drive allows."""

from __future__ import annotations

from inspect import signature

from strainwave import Drive, _core, arguments
from strainwave.simulation.excitation import ROOM_TEMPERATURE
from strainwave.simulation.resolution import FASTEST_ON_BRISTLES, MAX_STEP_PHASE, fine_enough, rounded_down
from strainwave.simulation.run import simulate

MIN_STEP = 1e-7  # s
DEFAULT_STEP = signature(simulate).parameters["dt"].default  # s
MAX_HALVINGS = 20  # of the step, for bristles


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
