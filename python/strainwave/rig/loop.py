"""A torsion loop as a rig measured it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

import numpy as np
from numpy.typing import NDArray

from strainwave import arguments
from strainwave.equality import ComparedByFields
from strainwave.files.recording import Recording
from strainwave.messages import shortened
from strainwave.presentation import Pictured

if TYPE_CHECKING:
    from matplotlib.figure import Figure

Array = NDArray[np.float64]
# Sizes of all numbers of loops, rigs and steps in SI units, unless they are 0: beyond, products of a few overflow.
MIN_SIZE, MAX_SIZE = 1e-30, 1e12
Side = Literal["input", "output"]
COLUMNS: dict[Side, tuple[str, str]] = {"input": ("input_angle", "input_torque"), "output": ("twist", "torque")}


@dataclass(frozen=True, eq=False)
class Loop(ComparedByFields, Pictured):
    """Angle of a loaded shaft and the torque on it, the other shaft held, in the order measured.

    Args:
        angle: how far the shaft has turned from the reference [rad], shape (n,), n >= 2
        torque: torque on the shaft [N.m], shape (n,); positive torque turns towards positive angles
        side: the shaft that was loaded
        name: what was measured, one line
        angle_sigma: standard deviation of each angle by itself [rad], shape (n,)
        torque_sigma: standard deviation of each torque by itself [N.m], shape (n,)
        angle_scale: standard deviation of what all angles share, relative to the angle [1]
        torque_scale: standard deviation of what all torques share, relative to the torque [1]
        friction_sigma: standard deviation of the friction torque of the pulleys [N.m]: its error lowers all torques of forward
            motion and raises those of backward motion, and so widens or narrows the loop
        compliance_sigma: standard deviation of the rig's compliance [rad/(N.m)], whose error moves each angle in proportion to
            its torque
        time: when each was measured [s], shape (n,), or None
        temperature: of the gear [K], shape (n,), or None
        position: how far the flexspline was turned in its mount [rad]
        unit: which specimen
        input_friction: whether friction of the wave generator is in the torque; as at the input, the output held, if None
        remarks: what a reader of the result must know, in words
        corrections: changes of the readings since they were measured, in words

    Raises:
        ValueError: series differ in length, there are fewer than two points, or a number is not finite

    >>> loop = Loop([0.0, 0.1, 0.0], [0.0, 0.03, 0.0], side="input", name="example")
    >>> loop.recording()
    <Recording: "example": 3 samples; input_angle [rad], input_torque [N.m]>
    """

    angle: Array
    torque: Array
    side: Side
    name: str
    angle_sigma: Array
    torque_sigma: Array
    angle_scale: float = 0.0
    torque_scale: float = 0.0
    friction_sigma: float = 0.0
    compliance_sigma: float = 0.0
    time: Array | None = None
    temperature: Array | None = None
    position: float = 0.0
    unit: str = ""
    input_friction: bool = False
    remarks: tuple[str, ...] = ()
    corrections: tuple[str, ...] = ()

    def __init__(
        self,
        angle: Sequence[float] | Array,
        torque: Sequence[float] | Array,
        *,
        side: Side,
        name: str,
        angle_sigma: Sequence[float] | Array | float = 0.0,
        torque_sigma: Sequence[float] | Array | float = 0.0,
        angle_scale: float = 0.0,
        torque_scale: float = 0.0,
        friction_sigma: float = 0.0,
        compliance_sigma: float = 0.0,
        time: Sequence[float] | Array | None = None,
        temperature: Sequence[float] | Array | None = None,
        position: float = 0.0,
        unit: str = "",
        input_friction: bool | None = None,
        remarks: Sequence[str] = (),
        corrections: Sequence[str] = (),
    ) -> None:
        arguments.one_of("side", side, COLUMNS)
        n = len(arguments.numbers("angle", angle))
        if n < 2:
            raise ValueError(f"a loop needs two points or more, not {n}")
        sigmas = {"angle_sigma": angle_sigma, "torque_sigma": torque_sigma}
        series = {"angle": angle, "torque": torque, "time": time, "temperature": temperature}
        series |= {key: np.full(n, each) if np.ndim(each) == 0 else np.asarray(each) for key, each in sigmas.items()}
        for key, values in series.items():
            object.__setattr__(self, key, None if values is None else _series(key, values, n))
        shared = {"angle_scale": (angle_scale, "1"), "torque_scale": (torque_scale, "1")}
        shared |= {"friction_sigma": (friction_sigma, "N.m"), "compliance_sigma": (compliance_sigma, "rad/(N.m)")}
        for key, (each, of) in shared.items():
            object.__setattr__(self, key, not_negative(key, each, of))
        object.__setattr__(self, "position", signed("position", position, "rad"))
        for key, text in (("side", side), ("name", name), ("unit", unit)):
            object.__setattr__(self, key, arguments.text(key, text))
            if not text.isprintable():
                raise ValueError(f"{key} = {shortened(text)} must be one line of text")
        object.__setattr__(self, "input_friction", side == "input" if input_friction is None else bool(input_friction))
        object.__setattr__(self, "remarks", tuple(remarks))
        object.__setattr__(self, "corrections", tuple(corrections))

    def __len__(self) -> int:
        return len(self.angle)

    def recording(self) -> Recording:
        """The loop as `sw.identify` and `sw.fit` take it: input_angle and input_torque, or twist and torque [rad], [N.m]."""
        angle, torque = COLUMNS[self.side]
        columns, units = {angle: self.angle, torque: self.torque}, {angle: "rad", torque: "N.m"}
        if self.time is not None and np.all(np.diff(self.time) > 0.0):
            columns, units = {"time": self.time, **columns}, {"time": "s", **units}
        if self.temperature is not None:
            columns, units = {**columns, "temperature": self.temperature}, {**units, "temperature": "K"}
        return Recording(columns, units, self.name)

    def _headline(self) -> str:
        return f"{self.name or 'loop'} at the {self.side}, {len(self.angle)} points"

    def plot(self) -> Figure:
        """Return a figure of the angle over the torque."""
        from strainwave.drawing.simple import Series, points_figure

        title = f"Loop at the {self.side}{f', {self.name}' if self.name else ''}"
        return points_figure(title, Series("torque", "N.m", self.torque), Series("angle", "rad", self.angle))


def positive(name: str, value: object, unit: str = "") -> float:
    """Return a positive number of a test, from 1e-30 to 1e12, or refuse it."""
    return arguments.bare_number(name, value, unit, "[]", MIN_SIZE, MAX_SIZE)


def not_negative(name: str, value: object, unit: str = "") -> float:
    """Return a number of a test that is 0 or positive, or refuse it."""
    given = arguments.bare_number(name, value, unit, "[]", 0.0, MAX_SIZE)
    return given if given == 0.0 else positive(name, given, unit)


def signed(name: str, value: object, unit: str = "") -> float:
    """Return a number of a test of either sign, up to 1e12, or refuse it."""
    return arguments.bare_number(name, value, unit, "[]", -MAX_SIZE, MAX_SIZE)


def _series(name: str, values: Sequence[float] | Array, n: int) -> Array:
    array = arguments.numbers(name, values).copy()
    if array.shape != (n,):
        raise ValueError(f"{name} has shape {array.shape}; angle has {n} values, and {name} must have as many")
    if not np.all(np.isfinite(array)):
        row = int(np.flatnonzero(~np.isfinite(array))[0])
        raise ValueError(f"{name}[{row}] = {array[row]} must be finite")
    size = float(np.abs(array).max())
    if size and not MIN_SIZE <= size <= MAX_SIZE:
        raise ValueError(f"{name}: the largest is {size:g} in SI units; it must be 0 or lie in [{MIN_SIZE:g}, {MAX_SIZE:g}]")
    array.flags.writeable = False
    return array
