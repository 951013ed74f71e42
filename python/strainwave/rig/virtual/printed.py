"""Gears whose loop is a row of a printed table: four stiffnesses and a width, but no points."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence

from strainwave import arguments, hysteresis, kinematics, stiffness
from strainwave._core import Gear
from strainwave.files.gear_set import GearSet
from strainwave.rig.bench.steps import Step

# The torsional stiffness article, Table 2: degrees of the flexspline in its mount: N.m/rad of positive unloading, negative
# loading, negative unloading and positive loading; width in degrees. All at the input of a gear 1:100, up to +-0.36 N.m.
TABLE_2 = {
    0: (4.51, 0.31, 4.85, 0.30, 50.5),
    60: (4.36, 0.29, 3.59, 0.33, 51.9),
    120: (4.19, 0.32, 5.08, 0.33, 49.4),
}
ARTICLE = "torsional-stiffness-article"  # the gears whose loops are the rows of the torsional stiffness article's Table 2
PEAK_TORQUE = 0.36  # N.m
SOFT_ONSET = 0.03  # N.m, assumed: torque at which the soft regimes begin, which the table does not state (its erratum 4)
NEGLIGIBLE_STIFFNESS = 1e-6  # N.m/rad, of the spring of a gear whose torque is all hysteresis


def printed_gear(position: int) -> Gear:
    """Return the gear of the torsional stiffness article with its flexspline at 0, 60 or 120 degrees, as Table 2 prints it.

    The printed stiffnesses are read as slopes between the knees of the loop (its erratum 4). The gear is 1:100.

    Raises:
        ValueError: no row of the table

    >>> round(math.degrees(printed_gear(60).hysteresis.lost_motion * 100.0), 9)
    51.9
    """
    if position not in TABLE_2:
        raise ValueError(
            f"position = {position} degrees must be 0, 60 or 120: the rows of the torsional stiffness article's Table 2"
        )
    *slopes, width = TABLE_2[position]
    return gear_of_regimes(*slopes, width=math.radians(width), peak=PEAK_TORQUE)


def peak_needed(position: int) -> float:
    """The torque at the input from which on the loop of a row of Table 2 has its printed width [N.m].

    >>> [round(peak_needed(position), 3) for position in TABLE_2]
    [0.322, 0.353, 0.339]
    """
    down, soft_down, up, soft_up, width = TABLE_2[position]
    return max(_needed(*pair, math.radians(width), SOFT_ONSET) for pair in ((soft_up, down), (soft_down, up)))


def _needed(loading: float, unloading: float, width: float, onset: float) -> float:
    """Return the torque at which a soft regime from the onset on has opened the loop to its width [N.m]."""
    return onset + width / (1.0 / loading - 1.0 / unloading)


def gear_of_regimes(
    positive_unloading: float,
    negative_loading: float,
    negative_unloading: float,
    positive_loading: float,
    *,
    width: float,
    peak: float,
    onset: float = SOFT_ONSET,
    ratio: float = 100.0,
) -> Gear:
    """The gear whose loop at the input, output held, has these stiffnesses in its four regimes and this width.

    Args:
        positive_unloading, negative_loading, negative_unloading, positive_loading: slopes at the input [N.m/rad]
        width: of the loop at zero torque [rad]
        peak: largest torque of the loop at the input [N.m]
        onset: torque at the input at which the soft regimes set in [N.m]
        ratio: of the gear, input over output angle [1]

    Raises:
        ValueError: a number out of its range; or the soft regimes take more torque than the peak has: no loop is so wide

    Source:
        the torsional stiffness article, Table 2, and erratum 4 of the torsional stiffness article

    >>> gear = gear_of_regimes(4.51, 0.31, 4.85, 0.30, width=math.radians(50.5), peak=0.36)
    >>> gear.hysteresis.positive_unloading, gear.hysteresis.onset
    (45100.0, 3.0)
    """
    width, ratio = arguments.number("width", width, "rad", brackets="[)", low=0.0), arguments.number("ratio", ratio, low=0.0)
    law = hysteresis.Regimes(
        positive_unloading=positive_unloading * ratio**2,
        negative_loading=negative_loading * ratio**2,
        negative_unloading=negative_unloading * ratio**2,
        positive_loading=positive_loading * ratio**2,
        onset=onset * ratio,
        lost_motion=width / ratio,
    )
    for loading, unloading in ((positive_loading, positive_unloading), (negative_loading, negative_unloading)):
        if (needed := _needed(loading, unloading, width, onset)) > peak:
            raise ValueError(
                f"width = {width:g} rad asks for {needed:.3g} N.m at a loading stiffness of {loading:g} N.m/rad; "
                f"the peak of {peak:g} N.m does not reach that"
            )
    return Gear(
        kinematics=kinematics.PlainRatio(reduction=ratio), stiffness=stiffness.Linear(k=NEGLIGIBLE_STIFFNESS), hysteresis=law
    )


def gear_named(name: str) -> Gear | Callable[[Step], Gear]:
    """The gear of a set or a gear file; or, of the torsional stiffness article, the gear for the position of each step.

    Raises:
        ValueError: there is no such gear
    """
    if name == ARTICLE:
        return lambda step: printed_gear(round(math.degrees(step.position)))
    return GearSet.read(name).gear


def narrower(positions: Sequence[float], peak: float) -> list[str]:
    """Return in words the rows of the article's Table 2 that do not reach their printed width under a peak torque [N.m].

    >>> narrower([0.0], 0.343)
    []
    >>> print(*narrower([math.radians(60.0)], 0.343))
    at 60 degrees the torsional stiffness article's loop has its 51.9 degrees from 0.353 N.m on; at 0.343 N.m it is narrower
    """
    return [
        f"at {place} degrees the torsional stiffness article's loop has its {TABLE_2[place][-1]:g} degrees from "
        f"{peak_needed(place):.3f} N.m on; at {peak:.3f} N.m it is narrower"
        for place in (round(math.degrees(position)) for position in positions)
        if peak_needed(place) > peak
    ]
