"""Smooth part of a torque or current, which is no ripple: friction over speed, inertia, gravity, and what other joints add."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from math import nan, tau

import numpy as np
from numpy.typing import NDArray

from strainwave.files.recording import Recording
from strainwave.orders.turning import Evenly, direction, evenly_turning, reach_of, smooth_speed
from strainwave.statistics.linear_fit import order_waves, solved
from strainwave.statistics.scale import robust_sigma
from strainwave.statistics.spectrum import Floor, floor_of, taper

Array = NDArray[np.float64]
Complex = NDArray[np.complex128]

CONSTANT_SPEED_SPREAD = 1e-3  # relative spread of the speed [1], below which friction over speed is not determined
FRICTION_KNOTS = 6  # of the friction over speed, in each direction
TREND_PERIODS = 4  # of the angle in the slow trend over it, the longest 1.2 times the span
REST_SHARE = 0.05  # of a fast speed [1]: around it a sample counts half, since friction turns over at rest
MAX_RESIDUAL_SHARE = 0.98  # of the residual's square [1], that remains if a loss under load is taken for one
OUTLIER_SIGMA = 8.0  # robust standard deviations of the residual, beyond which a sample counts as a mistake
MIN_SENSE_SHARE = 0.02  # of the squared weight [1]: a direction with less has no amplitudes of its own
WAVE_ORDERS = (1.0, 2.0, 4.0)  # per revolution of the input, that a gear makes in the motion as well as in the torque
MIN_WAVE_PERIODS = 3.0  # of a wave in the record
MIN_GRAVITY_SPAN = 0.5  # rad: sine and cosine of a smaller motion are the trend
MAX_CONDITION = 1e10  # of squared columns [1], beyond which a direction does not count
MIN_LEFT_NOISE = 0.1  # share of the noise of a line [1], that columns leave
BOTH_SENSES = (1.0, -1.0)


@dataclass(frozen=True)
class Shaft:
    """A shaft that turns, evenly in time.

    Attributes:
        name: empty for the shaft whose gear is examined, else of another joint
        angle: of the shaft [rad], shape (n,)
        speed: of it [rad per sample], shape (n,)
        sense: 1 forward, -1 backward, shape (n,)
    """

    name: str
    angle: Array
    speed: Array
    sense: Array

    @classmethod
    def of(cls, name: str, angle: Array) -> Shaft:
        """Return the shaft with this angle [rad]."""
        speed = smooth_speed(angle, reach_of(len(angle)))
        return cls(name, angle, speed, direction(speed))

    @property
    def revolutions(self) -> float:
        """Revolutions from end to end."""
        return float(np.ptp(self.angle)) / tau

    @property
    def acceleration(self) -> Array:
        """Acceleration of the shaft [rad per sample squared], shape (n,)."""
        return smooth_speed(self.speed, reach_of(len(self.speed)))

    def reverses(self) -> bool:
        """True if it turns both ways."""
        return all(np.any(self.sense == sense) for sense in BOTH_SENSES)

    def quick(self, series: Array, lowest: float) -> tuple[Array, Array]:
        """Return what series contain of an order and higher ones, shape (n,) or (n, k), and the weight of each sample.

        Means over a period of the order at the usual speed are taken off twice: that leaves nothing of a cubic. Samples so near
        to a reversal or an end that the means contain it do not count; others as the speed.
        """
        from scipy.ndimage import maximum_filter1d, uniform_filter1d

        usual = float(np.median(np.abs(self.speed)))
        period = min(max(round(tau / (lowest * usual)), 1), len(self.angle)) if usual > 0.0 else len(self.angle)
        for _ in range(2):
            series = series - uniform_filter1d(series, period, axis=0)
        turned = np.diff(self.sense, prepend=-self.sense[0], append=-self.sense[-1]) != 0.0
        near = maximum_filter1d(turned, 2 * period + 1)
        return series, np.where(near[1:] | near[:-1], 0.0, np.abs(self.speed))

    def senses(self, weight: Array) -> list[float]:
        """Return the directions with enough weight for amplitudes of their own, the forward one first."""
        whole = float(weight @ weight)
        return [s for s in BOTH_SENSES if float(np.sum(weight[self.sense == s] ** 2)) > MIN_SENSE_SHARE * whole]


@dataclass(frozen=True, eq=False)
class FittedColumns:
    """Orthonormal columns that were fitted to a series, shape (n, k), and what they take of the lines of spectra."""

    basis: Array
    shares: dict[object, tuple[Array, Complex]] = field(default_factory=dict)

    def left(self, series: Array) -> Array:
        """Return series without what the columns take of them, shape (n,) or (n, m)."""
        return np.asarray(series - self.basis @ (self.basis.T @ series))

    def taken(self, spectrum: object, transform: Callable[[Array], Complex], squared: float) -> tuple[Array, Complex]:
        """Return the share of each line that the columns take [1], and by how much more of one phase than of the other.

        `transform` gives the amount of each line in a series; `squared` is the sum of the squared weight of the samples.
        """
        if spectrum not in self.shares:
            share: Array = np.zeros(1)
            turned: Complex = np.zeros(1, complex)
            for amount in map(transform, self.basis.T):
                share = share + np.abs(amount) ** 2 / squared
                turned = turned + amount**2 / squared
            self.shares[spectrum] = share, turned
        return self.shares[spectrum]


@dataclass(frozen=True)
class Moving:
    """A shaft, what drives it, and other joints that move, evenly in time.

    Attributes:
        shafts: the shaft itself, then those of other joints that move
        series: torque or current less its smooth part, shape (n,)
        smooth: the smooth part, shape (n,)
        load: smooth part without what turns over with the direction, shape (n,)
        weight: 0 at rest and at the ends, up to 1 elsewhere, shape (n,)
        outliers: number of samples that do not count
        basis: columns of which the smooth part is a sum, those of other joints last, shape (n, k)
        own_columns: number of those of the shaft itself, which swing with the orders of its gear
    """

    shafts: tuple[Shaft, ...]
    series: Array
    smooth: Array
    load: Array
    weight: Array
    outliers: int
    basis: Array
    own_columns: int

    @cached_property
    def fitted(self) -> FittedColumns:
        """The weighted columns of the shaft itself, orthonormal."""
        return FittedColumns(orthonormal(self.basis[:, : self.own_columns] * self.weight[:, None])[0])

    @property
    def own(self) -> Shaft:
        """Shaft whose gear is examined."""
        return self.shafts[0]


def moving(angle: Array, torque: Array, others: Mapping[str, Array] | None = None, per_input: float = nan) -> Moving:
    """Return the shaft with the torque less its smooth part.

    The smooth part is fitted by least squares over speed, direction, acceleration and angle. Of other joints it contains
    gravity over their angles and over the sums with this one, and their inertia. The measured angle swings at the orders of the
    gear, and with it speed and acceleration. If these orders are known, they are removed from the angle first: else friction
    and inertia would take the ripple for theirs.

    Args:
        angle: of the shaft [rad], shape (n,)
        torque: or current, shape (n,)
        others: angles of other joints that move [rad], by name
        per_input: revolutions of the input per revolution of the shaft; nan if it is not known
    """
    own = _without_waves(Shaft.of("", angle), per_input)
    angle = own.angle
    shafts = (own, *(Shaft.of(name, values) for name, values in (others or {}).items()))
    fast = float(np.quantile(np.abs(own.speed), 0.95)) or 1.0
    friction = _friction(own.speed / fast, own)
    rest = np.concatenate([_trend(angle), own.acceleration[:, None]], axis=1)
    coupling = np.concatenate([np.zeros((len(angle), 0)), *(_coupling(own, each) for each in shafts[1:])], axis=1)
    gate = own.speed**2 / (own.speed**2 + (REST_SHARE * fast) ** 2)
    weight = gate * taper(len(angle))
    rest = np.concatenate([rest, coupling], axis=1)
    smooth, turning = _fitted(torque, friction, rest, weight)
    if own.reverses():  # a share of the load is lost, one way and the other
        lossy = np.concatenate([friction, (own.sense * np.abs(smooth - turning))[:, None]], axis=1)
        other, otherwise = _fitted(torque, lossy, rest, weight)
        if np.sum((weight * (torque - other)) ** 2) < MAX_RESIDUAL_SHARE * np.sum((weight * (torque - smooth)) ** 2):
            friction, smooth, turning = lossy, other, otherwise
    left = torque - smooth
    wrong = _outliers(left, weight)
    if wrong.any():
        weight = np.where(wrong, 0.0, weight)
        smooth, turning = _fitted(torque, friction, rest, weight)
        left = torque - smooth
    basis = np.concatenate([friction, rest], axis=1)
    return Moving(shafts, left, smooth, smooth - turning, weight, int(wrong.sum()), basis, basis.shape[1] - coupling.shape[1])


def shaft_of(
    recording: Recording,
    column: str,
    angle: str,
    *,
    others: Mapping[str, str],
    rate: float | None,
    per_input: float,
    count: int,
) -> tuple[Evenly, Moving]:
    """Return the columns of a recording evenly in time, and its shaft with the smooth part; filled rows have no weight.

    Args:
        recording, column: a torque or current, with the angles, and `time` if it is known
        others: columns with the angles of other joints, by the name of the joint; those that rest are left out
        rate: samples per second of a recording without time [Hz]
        per_input: revolutions of the input per revolution of the shaft; nan if it is not known
    """
    record = evenly_turning(recording, [angle, *others.values()], [column], rate, count)
    columns = record.columns
    if float(np.ptp(columns[angle])) == 0.0:
        raise ValueError(f"{angle} does not change; orders need a shaft that turns: give the angle of one, or record a motion")
    if float(np.ptp(columns[column])) == 0.0:
        raise ValueError(f"{column} does not change; there is no ripple in it: give the column that was measured")
    moved = {joint: columns[name] for joint, name in others.items() if float(np.ptp(columns[name])) > 0.0}
    shaft = moving(columns[angle], columns[column], moved, per_input)
    return record, replace(shaft, weight=np.where(record.measured, shaft.weight, 0.0))


def orthonormal(columns: Array) -> tuple[Array, Array]:
    """Return orthonormal columns that span the columns, and the matrix that makes them of these, shapes (n, r) and (k, r)."""
    size = np.linalg.norm(columns, axis=0)
    size[size == 0.0] = 1.0
    values, vectors = np.linalg.eigh((columns.T @ columns) / np.outer(size, size))
    kept = values > values.max() / MAX_CONDITION
    made = vectors[:, kept] / np.sqrt(values[kept]) / size[:, None]
    return columns @ made, made


def floor_without(columns: Array, series: Array, weight: Array) -> Floor:
    """Return the floor of a series without columns, both multiplied by a weight of 1 or less.

    The columns take a share of the noise, too, at low frequencies most of it if the record is short. The floor contains this.
    """
    from scipy.fft import rfft

    basis, _ = orthonormal(columns)
    left = series - basis @ (basis.T @ series)
    taken = np.sum(np.abs(rfft(basis, axis=0)[1:]) ** 2, axis=1) / len(series)
    power = np.abs(rfft(left)[1:]) ** 2 / np.maximum(1.0 - taken, MIN_LEFT_NOISE)
    return floor_of(power / float(weight @ weight), len(series))


def _without_waves(own: Shaft, per_input: float) -> Shaft:
    """Return a shaft without the waves of a gear in its angle."""
    orders = [order * per_input for order in WAVE_ORDERS if order * per_input * own.revolutions >= MIN_WAVE_PERIODS]
    if not orders:
        return own
    waves = order_waves(own.angle, orders)
    quick, weight = own.quick(np.column_stack([waves, own.angle]), orders[0])
    weighed = weight[:, None] * quick
    return Shaft.of(own.name, own.angle - waves @ solved(weighed[:, :-1], weighed[:, -1]))


def _fitted(torque: Array, friction: Array, rest: Array, weight: Array) -> tuple[Array, Array]:
    """Return the smooth part, and the friction in it."""
    columns = np.concatenate([friction, rest], axis=1)
    coefficients = solved(columns * weight[:, None], torque * weight)
    return columns @ coefficients, friction @ coefficients[: friction.shape[1]]


def _friction(speed: Array, shaft: Shaft) -> Array:
    """Return columns piecewise linear over speed, odd in it and even; a constant is left to the load."""
    columns = [shaft.sense] if shaft.reverses() else []
    swift = np.abs(speed)
    knots = np.unique(np.quantile(swift, np.linspace(0.0, 0.9, FRICTION_KNOTS)))
    if float(np.ptp(swift)) > CONSTANT_SPEED_SPREAD * float(swift.max()):
        for knot in knots:
            above = np.maximum(swift - knot, 0.0)
            columns += [shaft.sense * above, above] if shaft.reverses() else [above]
    return np.stack(columns, axis=1) if columns else np.zeros((len(speed), 0))


def _trend(angle: Array) -> Array:
    """Return columns for a constant, gravity over a revolution, and what else varies slowly with the angle."""
    span = max(float(np.ptp(angle)), 1e-12)
    columns = [np.ones_like(angle)]
    for period in (1.2 * span / np.arange(1, TREND_PERIODS + 1)).tolist():
        columns += [np.sin(tau * (angle - angle[0]) / period), np.cos(tau * (angle - angle[0]) / period)]
    if span > MIN_GRAVITY_SPAN:
        columns += [np.sin(angle), np.cos(angle)]
    return np.stack(columns, axis=1)


def _coupling(own: Shaft, other: Shaft) -> Array:
    """Return columns for gravity over the angle of another joint and its sums with this one, and for its inertia."""
    angles = (other.angle, own.angle + other.angle, own.angle - other.angle)
    columns = [wave for angle in angles for wave in (np.sin(angle), np.cos(angle))]
    acceleration = other.acceleration
    inertia = [acceleration * factor for factor in (1.0, np.cos(other.angle), np.sin(other.angle))]
    return np.stack([*columns, *inertia, other.speed**2, own.speed * other.speed], axis=1)


def _outliers(left: Array, weight: Array) -> NDArray[np.bool_]:
    """Return samples far out of the bulk around them, compared with the median of five and with a cubic through four.

    A fast change is far from no median, and the peak of a line near a cubic.
    """
    from scipy.ndimage import convolve1d, median_filter

    swift = weight > 0.5  # elsewhere friction turns over
    outliers: NDArray[np.bool_] = swift.copy()
    for off in (left - median_filter(left, 5, mode="nearest"), convolve1d(left, np.array([1.0, -4.0, 6.0, -4.0, 1.0]) / 6.0)):
        bulk = float(robust_sigma(off[swift])) if swift.any() else 0.0
        outliers &= (np.abs(off) > OUTLIER_SIGMA * bulk) & (bulk > 0.0)
    return outliers
