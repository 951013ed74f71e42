"""Both shafts of a gear, and their ratio."""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import hypot

import numpy as np
from numpy.typing import NDArray

from strainwave import arguments
from strainwave.messages import as_option
from strainwave.orders.comb import STRAIN_WAVE_RATIOS
from strainwave.orders.turning import Evenly, direction, reach_of, smooth_speed
from strainwave.presentation import Presented
from strainwave.statistics.linear_fit import normal_inverse, solved

Array = NDArray[np.float64]

INDEPENDENT_SAMPLES = 10.0  # of what load leaves unexplained of a ratio (assumed)
WINDUP_SIGMA = 2e-3  # rad: standard deviation of what each load winds a gear up by, in the mean of a record (assumed)
MIN_ENCODER_NOISE = 1e-9  # rad, less than that of any encoder
WINDUP_SPREAD = 0.2  # of the wind-up that load explains, which is no linear function of it (assumed)
RATIO_SIGMA = 3.0  # standard deviations, within which a ratio agrees with the angles
MAX_SLOPE = 1.1  # turns of the output per turn of the input
MAX_ERROR_SHARE = 0.02  # of the angle of the output [1], above which the error is none of a gear
MAX_RATIO_OFF = 0.02  # relative: a ratio given that is further from the angles is not theirs
MIN_GRAVITY_SWING = 0.1  # rad of the output, above which gravity is separated from a constant


@dataclass(frozen=True)
class Ratio(Presented):
    """Signed ratio of two shafts, input over output.

    Attributes:
        value: of the angles; negative if the recorded angles run against each other
        sigma: its standard deviation
        used: of the error: the ratio given, else the nearest whole number within the uncertainty, else that of the angles
        whole: True if the ratio used is whole, and given or the only whole number within the uncertainty
        in_joint_units: True if the recorded input angle is already divided by the ratio; the value is then that of the input
            angle times the ratio given, or without one near 1
    """

    value: float
    sigma: float
    used: float
    whole: bool
    in_joint_units: bool = False

    @property
    def of_strain_wave(self) -> bool:
        """True if a strain wave gear may have the ratio used."""
        return abs(self.used) in STRAIN_WAVE_RATIOS


@dataclass(frozen=True)
class Pair:
    """Angles of both shafts [rad], evenly in time, shape (n,) each."""

    record: Evenly
    input: Array
    output: Array

    def __post_init__(self) -> None:
        for name, angle in (("input_angle", self.input), ("output_angle", self.output)):
            if float(np.ptp(angle)) == 0.0:
                raise ValueError(f"{name} does not change; orders need a shaft that turns: give its angle, or record a motion")

    @property
    def speed(self) -> Array:
        return smooth_speed(self.input, reach_of(len(self.input)))

    @property
    def fastest(self) -> float:
        """Speed of the input [rad per sample] that one sample in a hundred exceeds."""
        return float(np.quantile(np.abs(self.speed), 0.99))

    @property
    def reverses(self) -> bool:
        sense = direction(self.speed)
        return bool(sense.any()) and float(np.mean(sense > 0.0)) not in (0.0, 1.0)


def ratio_of(pair: Pair, given: float | None) -> tuple[Pair, Ratio]:
    """Return the pair with the angle of the input shaft itself, and the ratio.

    The angles have a ratio near 1 if the controller divides the motor angle by the ratio. With a ratio given it is multiplied
    by it again. A ratio given is used with all its digits.
    """
    slope = float(np.polyfit(pair.input - pair.input.mean(), pair.output - pair.output.mean(), 1)[0])
    off = pair.output - slope * pair.input
    if slope == 0.0 or float(np.std(off)) > MAX_ERROR_SHARE * float(np.ptp(pair.output)):
        raise ValueError(
            f"input_angle and output_angle do not move together: {float(np.std(off)):.3g} rad of "
            f"{float(np.ptp(pair.output)):.3g} rad are left if one is a multiple of the other; check which columns they are, "
            "their units, and whether one wraps"
        )
    if abs(slope) > MAX_SLOPE:
        raise ValueError(
            f"output_angle turns {abs(slope):.4g} times as far as input_angle: the two seem to be swapped; name them the other "
            f"way, with {as_option('column', 'input_angle', 'NAME')} and {as_option('column', 'output_angle', 'NAME')}"
        )
    value, sigma = _slow_ratio(pair, 1.0 / slope)
    in_joint_units = _agree(1.0, value, sigma)
    if given is None:
        nearest = float(np.copysign(max(1.0, np.rint(abs(value))), value))
        near = abs(nearest - value) <= max(RATIO_SIGMA * sigma, 1e-9 * abs(value))
        only = near and RATIO_SIGMA * sigma < 0.5
        return pair, Ratio(value, sigma, nearest if near else value, only, in_joint_units)
    size = abs(arguments.ratio("ratio", given))
    in_joint_units = in_joint_units and not _agree(size, value, sigma)
    if in_joint_units:
        pair, value, sigma = replace(pair, input=size * pair.input), size * value, size * sigma
    if not _agree(size, value, sigma):
        raise ValueError(
            f"ratio = {given:.9g} is not that of the angles, {value:.5g} ± {sigma:.2g}; check the units of both, "
            "and on which side of the gear the encoders sit"
        )
    return pair, Ratio(value, sigma, float(np.copysign(size, value)), size.is_integer(), in_joint_units)


def _agree(size: float, value: float, sigma: float) -> bool:
    """True if a ratio may be that of the angles."""
    return abs(size - abs(value)) <= max(RATIO_SIGMA * sigma, MAX_RATIO_OFF * abs(value))


def _slow_ratio(pair: Pair, near: float) -> tuple[float, float]:
    """Return the ratio and its standard deviation by plain least squares, in which the large slow motion outweighs the ripple.

    Direction, speed, acceleration and gravity are fitted too, each with a wind-up no larger than that of gears, since some
    motions make them look like a ratio. Their residual is strongly correlated, so few of the samples count as independent. The
    part that load explains is uncertain by a fifth, as no gear is a linear spring.
    """
    acceleration = smooth_speed(pair.speed, reach_of(len(pair.speed)))
    wound = np.stack([acceleration, *loads_of(pair, near)], axis=1)
    wound -= wound.mean(axis=0)
    size = np.std(wound, axis=0)
    kept = size > 0.0
    turned = pair.input / near - float(np.mean(pair.input / near))
    columns = np.concatenate([turned[:, None], wound[:, kept] / size[kept]], axis=1)
    compared = pair.output - pair.output.mean()
    noise = compared - columns @ solved(columns, compared)
    weight = INDEPENDENT_SAMPLES / len(compared) / max(float(np.mean(noise**2)), MIN_ENCODER_NOISE**2)
    prior = np.diag([0.0, *[1.0 / WINDUP_SIGMA] * int(kept.sum())])
    covariance = normal_inverse(np.concatenate([np.sqrt(weight) * columns, prior]))
    coefficients = covariance @ (weight * columns.T @ compared)
    unsure = WINDUP_SPREAD * float(np.std(columns[:, 1:] @ coefficients[1:])) / float(np.std(turned))
    sigma = hypot(float(np.sqrt(covariance[0, 0])), unsure)
    share = float(coefficients[0])
    return near / share, abs(near) * sigma / share**2


def loads_of(pair: Pair, ratio: float) -> list[Array]:
    """Return the columns of the load without inertia: direction, speed, and gravity over the output angle."""
    speed = pair.speed / ratio
    loads = [direction(speed), speed]
    if float(np.ptp(pair.output)) > MIN_GRAVITY_SWING:
        loads += [np.sin(pair.output), np.cos(pair.output)]
    return loads


def ratio_remarks(ratio: Ratio, given: float | None, option: str) -> list[str]:
    """Return what to know of a ratio: whether it is settled, what its sign means, and what to give."""
    remarks = _found_remarks(ratio, option) if given is None else _given_remarks(ratio, given)
    if not (ratio.whole and ratio.of_strain_wave):
        return remarks
    size = abs(ratio.used)
    circular = f"circular spline fixed, {2 * size:.0f} and {2 * size + 2:.0f} teeth"
    flexspline = f"flexspline fixed, {2 * size - 2:.0f} and {2 * size:.0f} teeth"
    means, other = (circular, flexspline) if ratio.used < 0.0 else (flexspline, circular)
    remarks.append(
        f"a strain wave gear of ratio {ratio.used:g} has its {means}; if one encoder counts the other way round, its {other}"
    )
    return remarks


def _found_remarks(ratio: Ratio, option: str) -> list[str]:
    measured = f"{ratio.value:.6g} ± {ratio.sigma:.2g}"
    if ratio.in_joint_units:
        return [
            f"the ratio of the angles is {measured}: both are counted in joint units, and the motor angle is already "
            f"divided by the ratio; give the ratio, with {option}, for orders of the input"
        ]
    if ratio.whole:
        return []
    if ratio.used != ratio.value:
        return [
            f"the angles determine the ratio to {measured} only, and {ratio.used:g} is assumed; give the ratio, with {option}: "
            "it need not be whole"
        ]
    return [
        f"no whole ratio lies within {RATIO_SIGMA:g} standard deviations of {measured}; it is used as it is; a gear that is no "
        f"strain wave gear, a belt before the gear, or a wrong scale of an encoder would explain it; {option} gives the ratio"
    ]


def _given_remarks(ratio: Ratio, given: float) -> list[str]:
    remarks = []
    if ratio.in_joint_units:
        remarks.append(
            f"the ratio of the angles is {ratio.value / abs(ratio.used):.5g} ± {ratio.sigma / abs(ratio.used):.2g}: both are "
            f"counted in joint units; the motor angle is multiplied by the ratio given, {abs(given):.9g}"
        )
    if abs(ratio.used - ratio.value) > RATIO_SIGMA * ratio.sigma:
        remarks.append(
            f"ratio {abs(given):.9g} is used as given, but the angles give {abs(ratio.value):.6g} ± {ratio.sigma:.2g}; check "
            "the scale of both encoders"
        )
    if given * ratio.used < 0.0:
        remarks.append(
            f"ratio {given:.9g} is given, but the recorded angles run {'against' if ratio.used < 0 else 'with'} each other: "
            "one encoder counts the other way round. If it is that of the output, the error has the other sign"
        )
    return remarks
