r"""Orders: what repeats a number of times in each revolution of a shaft, found in a recording over its angle.

.. math:: x(\theta) = x_0 + s\,\theta + \sum_n A_n \sin(n \theta + \varphi_n)

An order need not be whole: the teeth of a gear give 2 z_c/z_f, a bearing gives those of its balls. In the domain of the angle
an order stays where it is while the speed changes, which a frequency does not.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import pairwise
from math import isclose, pi, tau
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from strainwave import _core, arguments, typeset
from strainwave.equality import ComparedByFields
from strainwave.files.recording import Recording, check_recording
from strainwave.messages import quoted
from strainwave.presentation import Pictured, Row, counted

if TYPE_CHECKING:
    from matplotlib.figure import Figure

Array = NDArray[np.float64]

MAX_ROUNDING = 1e-9  # by which a number of revolutions may be off
MAX_VALUE = 1e150  # of a value, so that its square is a number, too


@dataclass(frozen=True, eq=False)
class Orders(ComparedByFields, Pictured):
    """Orders of a shaft in a recorded column.

    Args:
        order: how often each repeats in a revolution, shape (n,)
        amplitude: of each [unit], shape (n,)
        phase: of each, where the shaft is at angle 0 [rad], as of a sine, shape (n,)
        mean: of the column over the revolutions used [unit]
        residual: root mean square of what is neither mean, drift nor one of these orders [unit]
        revolutions: whole ones that were used
        unit: of the column

    >>> import numpy as np
    >>> import strainwave as sw
    >>> theta = np.linspace(0.0, 20.0 * np.pi, 2000)
    >>> columns = {"input_angle": theta, "torque": 0.5 + 0.03 * np.sin(2 * theta) + 0.01 * np.sin(4 * theta)}
    >>> found = sw.orders.order_amplitudes(sw.Recording(columns, {"input_angle": "rad", "torque": "N.m"}), "torque", [2, 4])
    >>> found.amplitude.round(6), round(found.mean, 6), found.unit, found.revolutions
    (array([0.03, 0.01]), 0.5, 'N.m', 10)
    """

    order: Array
    amplitude: Array
    phase: Array
    mean: float
    residual: float
    revolutions: int
    unit: str

    def _headline(self) -> str:
        left = typeset.quantity(self.residual, self.unit)
        return f"{counted(len(self.order), 'order')} over {counted(self.revolutions, 'revolution')}, {left} rms left"

    def _rows(self) -> Iterator[Row]:
        for order, amplitude, phase in zip(self.order.tolist(), self.amplitude.tolist(), self.phase.tolist(), strict=True):
            yield Row(f"order {order:g}", amplitude, self.unit, note=f"phase {typeset.number(float(np.degrees(phase)), 4)}°")
        yield Row("mean", self.mean, self.unit)
        yield Row("left", self.residual, self.unit, note="rms")

    def plot(self) -> Figure:
        """Return a figure of the amplitude over the order."""
        from strainwave.drawing.simple import Series, stems_figure

        return stems_figure(
            "Orders of a revolution", Series("order", "1", self.order), Series("amplitude", self.unit, self.amplitude)
        )


class BearingOrders(NamedTuple):
    """Events in a bearing in each revolution of its inner ring.

    Attributes:
        cage: the cage goes round [1]
        outer_ring: a ball passes a point of the outer ring [1]
        inner_ring: a ball passes a point of the inner ring [1]
        ball: a ball turns about itself [1]; a fault of it meets a ring twice as often

    >>> import strainwave as sw
    >>> orders = sw.orders.bearing_orders(balls=9, ball_diameter=7.94, pitch_diameter=39.04)
    >>> round(30.0 * orders.outer_ring, 1)  # Hz of a fault of the outer ring, at 30 revolutions per second
    107.5
    """

    cage: float
    outer_ring: float
    inner_ring: float
    ball: float


def order_amplitudes(recording: Recording, column: str, order: ArrayLike, *, angle: str = "input_angle") -> Orders:
    """Return amplitude and phase of some orders in a column, each separately.

    The last whole revolutions of the recording are used, each sample weighted by the angle that it stands for. A constant and a
    drift that is linear in the angle are taken out. The drift follows from means of whole revolutions, so no whole order is
    mistaken for it. A signal made of these orders is recovered exactly, whatever its sampling and its speed. Whole orders that
    are not asked for do not leak into those that are, if the samples are dense.

    Args:
        recording: with a shaft that turns one way; `recording.between` takes a stretch of it
        column: in which the orders are looked for
        order: cycles in each revolution, positive and different, shape (n,) or a number
        angle: column with the angle of the shaft, in any unit of an angle

    Returns:
        The orders in the order given.

    Raises:
        TypeError: an argument is not of its kind
        ValueError: there is no such column, an order is not positive, the shaft turns back, samples are more than half a cycle
            apart, or there are fewer revolutions than two orders need to be resolved: 1 / |their difference|

    >>> import strainwave as sw
    >>> theta = np.linspace(0.0, 100 * np.pi, 5000)
    >>> ripple = 0.5 + 0.03 * np.sin(2 * theta + 0.4) + 0.01 * np.sin(2.02 * theta)
    >>> recording = sw.Recording({"input_angle": theta, "torque": ripple}, {"input_angle": "rad", "torque": "N.m"})
    >>> found = sw.orders.order_amplitudes(recording, "torque", [2, 2.02])
    >>> found.amplitude.round(9), found.phase.round(9)[0], found.revolutions
    (array([0.03, 0.01]), np.float64(0.4), 50)
    """
    wanted = np.atleast_1d(arguments.numbers("order", order))
    if wanted.ndim != 1 or not wanted.size:
        raise ValueError(f"order must be a number or one series of at least one; its shape is {wanted.shape}")
    for each in wanted:
        arguments.number("order", float(each), low=0.0)
    turned, values = _turned(recording, column, angle)
    revolutions = _revolutions(turned, angle)
    _check_separated(wanted, revolutions, angle)
    _check_sampled(turned, float(wanted.max()), angle)
    span = tau * revolutions
    whole = (turned[-1] - span, turned[-1]) if turned[-1] > turned[0] else (turned[-1], turned[-1] + span)
    middle, half = 0.5 * sum(whole), tau * (revolutions // 2)
    weights = _weights(turned, *whole)
    sines, cosines = np.sin(wanted[:, None] * turned), np.cos(wanted[:, None] * turned)
    explained = [np.ones_like(turned), *sines, *cosines]
    asked = [weights, *(weights * sines), *(weights * cosines)]
    if revolutions > 1:
        explained.append((turned - middle) / span)
        asked.append(_weights(turned, whole[1] - half, whole[1]) - _weights(turned, whole[0], whole[0] + half))
    model, test = np.array(explained), np.array(asked)
    coefficients = np.linalg.solve(test @ model.T, test @ values)
    in_phase, across = np.split(coefficients[1 : 2 * len(wanted) + 1], 2)
    rest = values - coefficients @ model
    return Orders(
        order=wanted.copy(),
        amplitude=np.hypot(in_phase, across),
        phase=np.arctan2(across, in_phase),
        mean=float(coefficients[0]),
        residual=float(np.sqrt(weights @ rest**2 / weights.sum())),
        revolutions=revolutions,
        unit=recording.unit(column),
    )


def order_spectrum(recording: Recording, column: str, highest: float, *, angle: str = "input_angle") -> Recording:
    """Return the amplitude of all orders in a column, up to the highest.

    The last whole revolutions are resampled over the angle. Mean and linear drift are taken out, and a Hann window is laid over
    the rest. An order that is a multiple of 1 / revolutions then shows its full amplitude, and half of it at both neighbours;
    one between two lines shows up to 15 % less. `order_amplitudes` gives those of known orders without a window.

    Args:
        recording: with a shaft that turns one way
        column: of which the spectrum is wanted
        highest: order [1], positive
        angle: column with the angle of the shaft, in any unit of an angle

    Returns:
        A recording with the columns `order` [1], multiples of 1 / revolutions, and `amplitude` [unit of the column].

    Raises:
        TypeError: an argument is not of its kind
        ValueError: as `order_amplitudes`; or `highest` is less than one line

    >>> import strainwave as sw
    >>> theta = np.linspace(0.0, 40 * np.pi, 4001)
    >>> units = {"input_angle": "rad", "torque": "N.m"}
    >>> turning = sw.Recording({"input_angle": theta, "torque": 0.03 * np.sin(2 * theta)}, units)
    >>> spectrum = sw.orders.order_spectrum(turning, "torque", highest=5.0)
    >>> largest = int(np.argmax(spectrum["amplitude"]))
    >>> float(spectrum["order"][largest]), float(spectrum["amplitude"][largest].round(6))
    (2.0, 0.03)
    """
    from scipy.interpolate import CubicSpline

    highest = arguments.number("highest", highest, low=0.0)
    turned, values = _turned(recording, column, angle)
    revolutions = _revolutions(turned, angle)
    _check_sampled(turned, highest, angle)
    lines = int(highest * revolutions * (1.0 + MAX_ROUNDING))
    if not lines:
        raise ValueError(f"highest = {highest:g} is less than the first line at 1/{revolutions}; give more, or record longer")
    moving = np.append(True, np.diff(turned) != 0.0)
    path = np.abs(turned[moving] - turned[0])
    count = max(len(path), 4 * lines)
    places = path[-1] - tau * revolutions * np.arange(count, 0, -1) / count
    series = CubicSpline(path, values[moving])(np.maximum(places, 0.0))
    along = np.linspace(-1.0, 1.0, count)
    series -= series.mean() + along * (along @ series) / (along @ along)
    amplitude = 4.0 / count * np.abs(np.fft.rfft(series * np.hanning(count + 1)[:-1]))[1 : lines + 1]
    order = np.arange(1, lines + 1) / revolutions
    title = f"orders of {angle} in {column}"
    return Recording({"order": order, "amplitude": amplitude}, {"order": "1", "amplitude": recording.unit(column)}, title)


def bearing_orders(
    balls: int, ball_diameter: float, pitch_diameter: float, contact_angle: float = 0.0, *, outer_speed: float = 0.0
) -> BearingOrders:
    r"""Return the orders of the faults of a ball bearing whose inner ring turns with the shaft.

    .. math:: f_c = \tfrac{1}{2} [1 - \gamma + r (1 + \gamma)], \quad
              f_o = \tfrac{z}{2} (1 - \gamma) |1 - r|, \quad
              f_i = \tfrac{z}{2} (1 + \gamma) |1 - r|, \quad
              f_b = \frac{1 - \gamma^2}{2 d / D} |1 - r|, \qquad \gamma = \frac{d}{D} \cos \alpha

    with z = balls, d = ball_diameter, D = pitch_diameter, alpha = contact_angle, r = outer_speed. This is a plain bearing:
    its balls roll without slip between two round rings. The inner ring of a wave generator is elliptic, and loads each ball
    twice while that ring passes it; so a fault's order comes with neighbours. The outer ring turns with the flexspline. With
    the circular spline fixed r = 1 / i, i the signed ratio; with the flexspline fixed r = 0. They differ by some 1 %.

    Source: RandallAntoni2011, eqs. (1) to (4), for an outer ring that stands; for one that turns by their relative motion.

    Args:
        balls: how many there are
        ball_diameter: [m], or any unit that both diameters have
        pitch_diameter: of the circle on which the centres of the balls lie
        contact_angle: [rad], 0 of a deep groove bearing
        outer_speed: speed of the outer ring over that of the inner [1]

    Returns:
        Orders [1]: events per revolution of the shaft. A frequency [Hz] is an order times the revolutions per second.

    Raises:
        TypeError: an argument is not of its kind
        ValueError: there are fewer than three balls, a diameter is not positive, the balls do not fit side by side on the
            circle, or the angle lies outside of [0, pi/2)

    >>> import strainwave as sw
    >>> bearing = sw.orders.bearing_orders(balls=9, ball_diameter=7.94, pitch_diameter=39.04)
    >>> round(bearing.outer_ring, 4), round(bearing.inner_ring, 4)
    (3.5848, 5.4152)
    """
    balls = arguments.whole("balls", balls, 3)
    pitch_diameter = arguments.number("pitch_diameter", pitch_diameter, "m", low=0.0)
    widest = pitch_diameter * float(np.sin(pi / balls))
    ball_diameter = arguments.number("ball_diameter", ball_diameter, "m", "(]", 0.0, widest)
    contact_angle = arguments.number("contact_angle", contact_angle, "rad", "[)", 0.0, pi / 2)
    outer_speed = arguments.number("outer_speed", outer_speed)
    return BearingOrders(*_core.bearing_orders(balls, ball_diameter, pitch_diameter, contact_angle, outer_speed))


def _turned(recording: Recording, column: str, angle: str) -> tuple[Array, Array]:
    """Return the angle [rad] and the values of the column, shape (n,). Raise ValueError if it turns back."""
    check_recording("recording", recording)
    turned, values = recording.values(arguments.text("angle", angle), "rad"), recording[arguments.text("column", column)]
    if (reached := float(np.abs(values).max())) > MAX_VALUE:
        raise ValueError(f"column {quoted(column)} reaches {reached:g}; values up to {MAX_VALUE:g} are allowed: check its unit")
    steps = np.diff(turned)
    sense = np.sign(steps)
    back = sense * sense[np.argmax(steps != 0.0)] < 0.0 if len(steps) else np.zeros(0, dtype=np.bool_)
    if back.any():
        row = int(np.argmax(back)) + 1
        where = f"t = {recording.time[row]:g} s" if "time" in recording else f"row {row}"
        raise ValueError(f"{angle} turns back at {where}; take a stretch that turns one way, as recording.between(start, stop)")
    return turned, values


def _revolutions(turned: Array, angle: str) -> int:
    """Return the whole revolutions that the shaft makes."""
    made = float(abs(turned[-1] - turned[0])) / tau
    whole = int(made * (1.0 + MAX_ROUNDING) + MAX_ROUNDING)
    if whole < 1:
        raise ValueError(f"{angle} makes {made:.3g} revolutions; orders need 1 or more: record longer")
    return whole


def _check_separated(wanted: Array, revolutions: int, angle: str) -> None:
    """Raise ValueError for orders that the revolutions do not separate from each other or from the mean."""
    for low, high in pairwise([0.0, *sorted(wanted.tolist())]):
        if isclose(high, low, rel_tol=MAX_ROUNDING):
            raise ValueError(f"order {high:g} is asked for twice; leave one out")
        needed = 1.0 / (high - low)
        if needed > revolutions * (1.0 + MAX_ROUNDING):
            two = f"orders {low:g} and {high:g}" if low else f"order {high:g} and the mean"
            raise ValueError(
                f"to resolve {two} takes {needed:.6g} revolutions of {angle}, the recording has {revolutions}; "
                "record longer, or leave one out"
            )


def _check_sampled(turned: Array, highest: float, angle: str) -> None:
    """Raise ValueError for an order of which a cycle has fewer than two samples."""
    steps = np.abs(np.diff(turned))
    row = int(np.argmax(steps))
    allowed = pi / highest
    if steps[row] >= allowed:
        raise ValueError(
            f"order {highest:g} needs samples less than {allowed:.3g} rad of {angle} apart; rows {row} and {row + 1} are "
            f"{steps[row]:.3g} rad apart; record faster, or turn slower"
        )


def _weights(turned: Array, low: float, high: float) -> Array:
    """Return how much of the angle from `low` to `high` lies nearer to each sample than to any other [rad], shape (n,)."""
    if turned[-1] < turned[0]:
        return _weights(turned[::-1], low, high)[::-1]
    borders = np.concatenate([turned[:1], 0.5 * (turned[1:] + turned[:-1]), turned[-1:]])
    within = np.clip(borders, low, high)
    return np.asarray(np.diff(within))
