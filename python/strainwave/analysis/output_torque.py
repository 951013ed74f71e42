"""Torque of the output by the angles of both shafts: the gear as a torque sensor."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike, NDArray

from strainwave import Drive, Gear, arguments, material, structure, typeset, variation
from strainwave.equality import ComparedByFields
from strainwave.files.gear_set import GearSet, gear_set_of
from strainwave.parameters import every
from strainwave.presentation import Pictured

if TYPE_CHECKING:
    from matplotlib.figure import Figure

Array = NDArray[np.float64]

TORQUE_NUMBERS = (
    "gear.stiffness.",
    "gear.hysteresis.",
    "gear.kinematic_error.",
    "gear.damping",
)  # numbers that the torque depends on


@dataclass(frozen=True, eq=False)
class OutputTorque(ComparedByFields, Pictured):
    """Torque of the output, as a gear transmits it.

    Attributes:
        torque: on the output, counted positive as it drives the output forward [N.m], shape (n,)
        sigma: its standard deviation by that of the numbers of the gear [N.m], shape (n,); not a number if the set has no
            covariance
        twist: of the gear, without its kinematic error [rad], shape (n,)

    >>> import numpy as np
    >>> import strainwave as sw
    >>> gear = sw.Gear(kinematics=sw.kinematics.PlainRatio(reduction=50.0), stiffness=sw.stiffness.Linear(k=1e4))
    >>> output = sw.analysis.output_torque(gear, np.array([0.0, 0.05, 0.1]), np.zeros(3))
    >>> output.torque.round(9), output.twist.round(9)
    (array([ 0., 10., 20.]), array([0.   , 0.001, 0.002]))
    """

    torque: Array
    sigma: Array
    twist: Array

    def _headline(self) -> str:
        low, high = (typeset.quantity(float(end), "N.m") for end in (self.torque.min(), self.torque.max()))
        return f"{len(self.torque)} samples, {low} to {high}"

    def plot(self) -> Figure:
        """Return a figure of the torque over the samples, with the band of 95 % by the covariance of the gear."""
        from strainwave.drawing.simple import Series, curve_figure

        place = np.arange(float(len(self.torque)))
        return curve_figure(
            "Torque of the output", Series("sample", "1", place), Series("torque", "N.m", self.torque), self.sigma
        )


def output_torque(
    gear: GearSet | Drive | Gear | str | Path,
    input_angle: ArrayLike,
    output_angle: ArrayLike,
    *,
    zero: float = 0.0,
    time: ArrayLike | None = None,
) -> OutputTorque:
    r"""Return the torque that a gear transmits to its output, by the angles of both shafts.

    .. math:: \delta = \theta_{in}/i - \theta_{out} - e(\theta_{in}) - \delta_0, \qquad
              T = T_{stiffness}(\delta) + T_{hysteresis}(\delta, \text{history}) + c\,\dot\delta

    The memory of the hysteresis is carried from sample to sample. It begins untwisted, with a straight way to the first sample;
    after a twist as wide as the loop, the beginning no longer matters. The standard deviation follows from the covariance of
    the gear's numbers. Noise of the angles, times the stiffness, comes on top, and so does a wrong zero.

    Args:
        gear: a set with its covariance, as `identify` writes it, a gear or a drive, or the name or path of a file
        input_angle, output_angle: of both shafts at the same instants [rad], shape (n,), not wrapped, with the zeros of the
            identified recording
        zero: input angle over the ratio less output angle, where the gear is untwisted and without kinematic error [rad]
        time: of the samples [s], shape (n,); without it the torque of the damping is left out

    Returns:
        Torque, its standard deviation and the twist at each sample.

    Raises:
        TypeError: `gear` is none of these
        ValueError: the angles are not finite or not equally many, the time does not increase, or the gear has stages or a
            stiffness that varies with the angle

    >>> import numpy as np
    >>> import strainwave as sw
    >>> push = np.concatenate([np.linspace(0.0, 1e-3, 50), np.linspace(1e-3, 0.0, 50)])  # rad of twist, to and back
    >>> found = output_torque("csg-20-100", -100.0 * push, np.zeros(100))
    >>> round(float(found.torque.max()), 1), round(float(found.torque[-1]), 2)  # the way back is lower by the hysteresis
    (21.4, -1.0)
    """
    gear_set = gear_set_of(gear)
    check_static(gear_set.gear, gear_set.name)
    angles = _angles(input_angle, output_angle)
    zero = arguments.number("zero", zero, "rad")
    instants = None if time is None else arguments.numbers("time", time)
    if instants is not None and (instants.shape != angles.shape[1:] or not (np.diff(instants) > 0.0).all()):
        raise ValueError("time must increase, with an instant for each angle")
    twist, torque = _transmitted(gear_set.gear, angles, zero, instants)
    return OutputTorque(torque, _sigma(gear_set, angles, zero, instants), twist)


def _angles(input_angle: ArrayLike, output_angle: ArrayLike) -> Array:
    """Return the angles of both shafts, shape (2, n)."""
    of_input = np.atleast_1d(arguments.numbers("input_angle", input_angle))
    of_output = np.atleast_1d(arguments.numbers("output_angle", output_angle))
    if of_input.ndim != 1 or of_input.shape != of_output.shape:
        raise ValueError(
            f"input_angle has the shape {of_input.shape} and output_angle {of_output.shape}; give both at the same instants"
        )
    angles = np.stack((of_input, of_output))
    if not np.isfinite(angles).all():
        raise ValueError("input_angle and output_angle must be finite; leave out samples without a reading")
    return angles


def check_static(gear: Gear, name: str) -> None:
    """"""
    for part, plain in (
        ("structure", structure.Lumped),
        ("stiffness_variation", variation.Constant),
        ("material", material.Elastic),
    ):
        if not isinstance(found := getattr(gear, part), plain):
            raise ValueError(
                f"{name}: {part} = {type(found).__name__} makes the torque depend on more than the twist; take the gear "
                "without it"
            )


def _transmitted(gear: Gear, angles: Array, zero: float, time: Array | None) -> tuple[Array, Array]:
    """Return the twist and the torque of a gear."""
    input_angle, output_angle = angles
    error = np.asarray(gear.kinematic_error.error(input_angle))
    twist = input_angle / gear.kinematics.ratio - output_angle - error - zero
    path = np.concatenate(([0.0], twist))
    torque = np.asarray(gear.stiffness.torque(twist) + gear.hysteresis.trace(path)[1:])
    if time is not None and len(time) > 1:
        torque = torque + gear.damping * np.gradient(twist, time)
    return twist, torque


def _sigma(gear_set: GearSet, angles: Array, zero: float, time: Array | None) -> Array:
    """Return the standard deviation of the torque: slopes over a standard deviation of each number, times the covariance."""
    if gear_set.covariance is None:
        return np.full(angles.shape[1], np.nan)
    chosen = [place for place, path in enumerate(gear_set.covariance.paths) if path.startswith(TORQUE_NUMBERS)]
    covariance = np.asarray(gear_set.covariance.array)[np.ix_(chosen, chosen)]
    drive, slopes = Drive(gear=gear_set.gear), np.zeros((len(chosen), angles.shape[1]))
    for row, (place, deviation) in enumerate(zip(chosen, np.sqrt(np.diag(covariance)), strict=True)):
        if deviation > 0.0:
            path = gear_set.covariance.paths[place]
            ends = [_moved(drive, path, sense * deviation) for sense in (1.0, -1.0)]
            torques = [_transmitted(each.gear, angles, zero, time)[1] for each, _ in ends]
            slopes[row] = (torques[0] - torques[1]) / (ends[0][1] - ends[1][1])
    return np.asarray(np.sqrt(np.einsum("in,ij,jn->n", slopes, covariance, slopes)))


def _moved(drive: Drive, path: str, by: float) -> tuple[Drive, float]:
    """Return a drive with a number moved, within its limits, and the number."""
    number = every(drive)[path]
    value = float(np.clip(number.value + by, number.low, number.high))
    return drive.replace({path: value}), value
