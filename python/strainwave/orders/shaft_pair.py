"""The two shafts of a gear, and their ratio."""

from __future__ import annotations

from dataclasses import dataclass
from math import hypot

import numpy as np
from numpy.typing import NDArray

from strainwave import arguments
from strainwave.orders.turning import Evenly, direction, reach_of, smooth_speed

Array = NDArray[np.float64]

INDEPENDENT = 10.0  # samples, of what load leaves unexplained of a ratio (assumed)
WINDUP = 2e-3  # rad: standard deviation of what each load winds a gear up by, in the mean of a record (assumed)
TINY = 1e-9  # rad, less than any encoder tells
WINDUP_SPREAD = 0.2  # of the wind-up that load explains, which is no linear function of it (assumed)
SETTLED = 3.0  # standard deviations within which a whole ratio may lie
SWAPPED = 1.1  # times as far as the input no output of a gear turns
LOOSE = 0.02  # of the angle of the output, above which the error is none of a gear
SWING = 0.1  # rad of the output, above which gravity is told from a constant


@dataclass(frozen=True)
class Ratio:
    """The signed ratio of two shafts, input over output.

    Attributes:
        value: as the angles tell it; negative where the recorded angles run against each other
        sigma: its standard deviation
        used: with which the error was told: the nearest whole number, if the angles allow it, or what was given
        whole: whether that is a whole number within the uncertainty
    """

    value: float
    sigma: float
    used: float
    whole: bool


@dataclass(frozen=True)
class Pair:
    """Both shafts, and how they move."""

    record: Evenly
    input: Array
    output: Array

    def __post_init__(self) -> None:
        for name, angle in (("input_angle", self.input), ("output_angle", self.output)):
            if float(np.ptp(angle)) == 0.0:
                raise ValueError(f"{name} does not change; orders need a shaft that turns")

    @property
    def speed(self) -> Array:
        return smooth_speed(self.input, reach_of(len(self.input)))

    @property
    def fastest(self) -> float:
        """Of the input [rad per sample], but for one sample in a hundred."""
        return float(np.quantile(np.abs(self.speed), 0.99))

    @property
    def reverses(self) -> bool:
        sense = direction(self.speed)
        return bool(sense.any()) and float(np.mean(sense > 0.0)) not in (0.0, 1.0)


def ratio_of(pair: Pair, given: float | None) -> Ratio:
    """The ratio by regression: first the slope alone, then beside orders, direction, gravity and the output stage."""
    slope = float(np.polyfit(pair.input - pair.input.mean(), pair.output - pair.output.mean(), 1)[0])
    off = pair.output - slope * pair.input
    if slope == 0.0 or float(np.std(off)) > LOOSE * float(np.ptp(pair.output)):
        raise ValueError(
            f"input_angle and output_angle do not move together: {float(np.std(off)):.3g} rad of "
            f"{float(np.ptp(pair.output)):.3g} rad are left where one "
            "is a multiple of the other; check which columns they are, their units, and whether one wraps"
        )
    if abs(slope) > SWAPPED:
        raise ValueError(
            f"output_angle turns {abs(slope):.4g} times as far as input_angle: the two seem to be swapped; name "
            "them the other way round"
        )
    value, sigma = _slow_ratio(pair, 1.0 / slope)
    if given is not None:
        given = arguments.ratio("ratio", given)
        if abs(abs(given) - abs(value)) > max(SETTLED * sigma, LOOSE * abs(value)):
            raise ValueError(
                f"ratio = {given:g} is not that of the angles, {value:.5g} ± {sigma:.2g}; check the units of both, "
                "and on which side of the gear the encoders sit"
            )
        return Ratio(value, sigma, float(np.copysign(given, value)), float(given).is_integer())
    nearest = float(np.copysign(max(1.0, np.rint(abs(value))), value))
    whole = abs(nearest - value) <= max(SETTLED * sigma, 1e-9 * abs(value))
    return Ratio(value, sigma, nearest if whole else value, whole)


def _slow_ratio(pair: Pair, near: float) -> tuple[float, float]:
    """The ratio and its standard deviation by plain least squares, which the large slow motion decides, not the ripple.

    Beside it stand direction, speed, acceleration and gravity, each of which winds up by no more than gears do, since a
    motion may be such that they look like a ratio. What they leave lasts, so that few of the samples count as independent; and
    what load explains counts as uncertain by a fifth, as no gear is a linear spring.
    """
    acceleration = smooth_speed(pair.speed, reach_of(len(pair.speed)))
    wound = np.stack([acceleration, *loads_of(pair, near)], axis=1)
    wound -= wound.mean(axis=0)
    size = np.std(wound, axis=0)
    kept = size > 0.0
    turned = pair.input / near - float(np.mean(pair.input / near))
    columns = np.concatenate([turned[:, None], wound[:, kept] / size[kept]], axis=1)
    compared = pair.output - pair.output.mean()
    noise = compared - columns @ np.linalg.lstsq(columns, compared, rcond=1e-9)[0]
    weight = INDEPENDENT / len(compared) / max(float(np.mean(noise**2)), TINY**2)
    known = np.diag([0.0, *[WINDUP**-2.0] * int(kept.sum())])
    covariance = np.linalg.inv(weight * columns.T @ columns + known)
    found = covariance @ (weight * columns.T @ compared)
    unsure = WINDUP_SPREAD * float(np.std(columns[:, 1:] @ found[1:])) / float(np.std(turned))
    sigma = hypot(float(np.sqrt(covariance[0, 0])), unsure)
    share = float(found[0])
    return near / share, abs(near) * sigma / share**2


def loads_of(pair: Pair, ratio: float) -> list[Array]:
    """What load makes of the twist but for the inertia: direction, speed, and gravity over the output angle."""
    speed = pair.speed / ratio
    loads = [direction(speed), speed]
    if float(np.ptp(pair.output)) > SWING:
        loads += [np.sin(pair.output), np.cos(pair.output)]
    return loads


def ratio_remarks(told: Ratio, pair: Pair, given: float | None) -> list[str]:
    """What the sign of the ratio means, and whether its size is settled."""
    remarks = []
    size = abs(told.used)
    if told.whole and size >= 10.0:
        if told.used < 0.0:
            means = f"circular spline fixed, {2 * size:.0f} and {2 * size + 2:.0f} teeth"
            other = f"flexspline fixed, {2 * size - 2:.0f} and {2 * size:.0f} teeth"
        else:
            means = f"flexspline fixed, {2 * size - 2:.0f} and {2 * size:.0f} teeth"
            other = f"circular spline fixed, {2 * size:.0f} and {2 * size + 2:.0f} teeth"
        remarks.append(
            f"ratio {told.used:g} is that of a gear with {means}; if one encoder counts the other way round, {other}"
        )
    elif not told.whole:
        remarks.append(
            f"no whole ratio lies within {SETTLED:g} standard deviations of {told.value:.6g} ± {told.sigma:.2g}; it is used "
            "as it is; a belt before the gear, or a wrong scale of an encoder, would explain it"
        )
    if told.sigma > 0.3:
        remarks.append(f"the ratio is told to ± {told.sigma:.2g} only; more than one whole number is near; give --ratio")
    if given is not None and given * told.used < 0.0:
        remarks.append(
            f"ratio {given:g} is given, but the recorded angles run {'against' if told.used < 0 else 'with'} each other: one "
            "encoder counts the other way round. If it is that of the output, the error has the other sign"
        )
    return remarks
