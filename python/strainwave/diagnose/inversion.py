"""Inversion of the orders of a column: misalignment m = e1 + h beta of the wave generator, with its covariance.

The orders of a column over what the drive answers per kinematic error are the orders of the error. `Misalignment` predicts
these from m, and from the place c_x of the generator on its shaft if the lobe further out carries. Least squares invert this.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import count
from typing import Any

import numpy as np
from numpy.typing import NDArray

from strainwave import kinematic_error
from strainwave.diagnose.actuator_ramp import ERROR_PATH, ActuatorRamp
from strainwave.diagnose.detection import CONFIDENCE_LEVEL, false_alarm_of
from strainwave.files.recording import Recording
from strainwave.orders.order_spectrum import order_amplitudes, order_spectrum
from strainwave.presentation import Presented
from strainwave.statistics.scale import student

Array = NDArray[np.float64]
Complex = NDArray[np.complex128]

COMBINE = ("single", "mean", "max")
M_PER_MICRON = 1e-6  # m
ERROR_ORDERS = (1.0, 2.0, 3.0, 4.0)
NOISE_LINES = 14  # the nearest ones, from which the noise of an order is estimated
SPECTRUM_MARGIN = 0.5  # order, by which the spectrum goes on beyond the highest one
MIN_NOISE_ORDER = 0.5  # below it lines contain the trend
HANN_NOISE_POWER = 1.5  # power of noise in a line through a Hann window over that without
PROBE_AMPLITUDE = 2e-5  # rad, of each order of the error with which a drive is run
SLOPE_STEP = 1e-8  # m, by which slopes of the orders are taken
TILT_STEP = 1e-5  # rad, by which the eccentricity per tilt is taken
MAX_RADIUS_SHARE = 0.4  # of the minor radius [1]: bound of m and c_x
INITIAL_SHARES = (
    (1.0, 0.0),
    (1.1, 0.4),
    (1.1, -0.4),
    (1.6, 0.8),
    (1.6, -0.8),
)  # initial m over a first estimate, and c_x over m
GOOD_MISFIT = 2.0  # no further start is tried
RECORDED_COLUMNS = ("input_angle", "transmission_error", "current")
CORRECTION_RUNS = 2  # with the estimate; each corrects it


@dataclass(frozen=True)
class MeasuredOrders:
    """Orders of a column, or of the kinematic error.

    Attributes:
        values: amplitude and phase of each order as a sine of the input angle [unit], shape (4,)
        noise: standard deviation of the real and of the imaginary part of each [unit], shape (4,)
        degrees: of freedom of the noise of an order
    """

    values: Complex
    noise: Array
    degrees: int

    def over(self, gain: Complex) -> MeasuredOrders:
        """Return the orders of the error that makes these, from the answer per error of each order."""
        return MeasuredOrders(self.values / gain, self.noise / np.abs(gain), self.degrees)

    @property
    def false_alarm(self) -> float:
        """Probability that noise alone makes an order as large as the largest one."""
        evidence = float(np.max(np.abs(self.values) ** 2 / (2.0 * self.noise**2)))
        return false_alarm_of(evidence, 2, self.degrees, len(ERROR_ORDERS))


@dataclass(frozen=True)
class MisalignmentEstimate(Presented):
    """Misalignment that the orders of a column determine.

    Attributes:
        column: from which it was estimated
        combine: way in which the lobes share, as assumed
        m: estimate [m]; if the lobe further out carries, or both alike, m and -m make the same orders
        covariance: of m [m^2], shape (2, 2)
        degrees: of freedom of the noise
        misfit: mean square of the residual over that of noise; about 1 if `combine` is right
        c_x: place of the generator on its shaft along the major axis [m], if the lobe further out carries
        c_x_sigma: its standard deviation [m]; nan if it is not estimated

    >>> import numpy as np
    >>> found = MisalignmentEstimate("current", "single", (3e-6, 4e-6), 1e-14 * np.eye(2), 40, 1.1)
    >>> round(1e6 * found.size, 1), round(1e6 * found.half_widths[0], 1), found.contains((3.1e-6, 4e-6))  # um
    (5.0, 0.2, True)
    """

    column: str
    combine: str
    m: tuple[float, float]
    covariance: Array
    degrees: int
    misfit: float
    c_x: float = 0.0
    c_x_sigma: float = np.nan

    @property
    def size(self) -> float:
        """Length of m [m]."""
        return float(np.hypot(*self.m))

    @property
    def direction(self) -> float:
        """Direction of m [rad]."""
        return float(np.arctan2(self.m[1], self.m[0]))

    @property
    def reach(self) -> float:
        """Half axes of the ellipse of 95 % confidence over standard deviations."""
        from scipy.stats import f

        return float(np.sqrt(2.0 * f.ppf(CONFIDENCE_LEVEL, 2, self.degrees)))

    @property
    def interval_factor(self) -> float:
        """Half width of an interval of 95 % over a standard deviation."""
        return student(CONFIDENCE_LEVEL, self.degrees)

    @property
    def half_widths(self) -> tuple[float, float]:
        """Half of the intervals of 95 % of the size [m] and of the direction [rad], each by itself."""
        along = np.array(self.m) / max(self.size, 1e-12)
        across = np.array([-along[1], along[0]])
        size, way = (self.interval_factor * float(np.sqrt(each @ self.covariance @ each)) for each in (along, across))
        return size, way / max(self.size, 1e-12)

    def contains(self, m: tuple[float, float]) -> bool:
        """True if a vector lies in the ellipse of 95 % confidence, or its opposite does where both make the same orders."""
        signs = (1.0,) if self.combine == "single" else (1.0, -1.0)
        gaps = [np.array(self.m) - sign * np.array(m) for sign in signs]
        return bool(min(float(gap @ np.linalg.solve(self.covariance, gap)) for gap in gaps) <= self.reach**2)


# ---- Orders of a column, and what the drive answers per error -----------------------------------------------------------


def phasors(recording: Recording, column: str) -> Complex:
    """Return amplitude and phase of each order of a column, shape (4,)."""
    orders = order_amplitudes(recording, column, ERROR_ORDERS)
    return _sines(orders.amplitude, orders.phase)


def measured_orders(recording: Recording, column: str) -> MeasuredOrders:
    """Return the orders of a column, and their noise.

    Lines between the orders have noise alone, except the next ones of an order, which contain half of it. Those near an order
    determine its noise. They come from a spectrum through a Hann window. It adds half to the power of noise, and the powers of
    neighbouring lines correlate by 4/9, of next ones by 1/36. So two lines determine it about as well as one without a window.
    """
    orders = order_amplitudes(recording, column, ERROR_ORDERS)
    spectrum = order_spectrum(recording, column, ERROR_ORDERS[-1] + SPECTRUM_MARGIN)
    line = np.rint(spectrum["order"] * orders.revolutions)
    apart, quiet = _noise_lines(line, orders.revolutions)
    if not quiet.any():
        highest = ERROR_ORDERS[-1] + SPECTRUM_MARGIN
        needed = next(k for k in count(1) if _noise_lines(np.arange(1.0, highest * k + 1e-9), k)[1].any())
        raise ValueError(
            f"the ramp has {orders.revolutions:g} whole revolutions of the input after the run-in; the noise of orders "
            f"{ERROR_ORDERS[0]:g} to {ERROR_ORDERS[-1]:g} needs {needed} or more: record a longer stroke"
        )
    near = np.argsort(np.where(quiet, apart, np.inf), axis=1, kind="stable")[:, : min(NOISE_LINES, int(quiet.sum()))]
    noise = np.sqrt(np.mean(spectrum["amplitude"][near] ** 2, axis=1) / (2.0 * HANN_NOISE_POWER))
    degrees = round(2.0 * near.shape[1] / (1.0 + 2.0 * (4.0 / 9.0 + 1.0 / 36.0)))
    return MeasuredOrders(_sines(orders.amplitude, orders.phase), np.maximum(noise, np.finfo(float).tiny), degrees)


def _noise_lines(line: Array, revolutions: float) -> tuple[Array, NDArray[np.bool_]]:
    """Return the distance of each line from each order [lines], shape (4, n), and True for lines of noise alone, shape (n,)."""
    apart = np.abs(line - revolutions * np.array(ERROR_ORDERS)[:, np.newaxis])
    return apart, (apart.min(axis=0) > 1) & (line > MIN_NOISE_ORDER * revolutions)


def less_run(recording: Recording, run: Recording, column: str) -> Recording:
    """Return a column of a record less that of a run at the same input angle."""
    angle = recording.values("input_angle", "rad")
    turned, values = run["input_angle"], run[column]
    sense = np.sign(turned[-1] - turned[0])
    difference = recording.values(column, run.unit(column)) - np.interp(sense * angle, sense * turned, values)
    return Recording({"input_angle": angle, column: difference}, {"input_angle": "rad", column: run.unit(column)})


def runs_with_probe(
    ramp: ActuatorRamp, changes: Sequence[Mapping[str, float]], record: Sequence[str]
) -> list[tuple[Recording, Recording]]:
    """Return two runs of each drive after the run-in: without error, and with a small error of all orders.

    The drives differ from the nominal one by numbers. Its kinematic error and the noise of its sensors are left out.
    """
    law = kinematic_error.Fourier(order=ERROR_ORDERS, amplitude=[0.0] * len(ERROR_ORDERS), phase=[0.0] * len(ERROR_ORDERS))
    quiet = ramp.without_noise().with_error(law)
    paths = [f"{ERROR_PATH}.amplitude[{place}]" for place in range(len(ERROR_ORDERS))]
    members = [{**change, **dict.fromkeys(paths, size)} for change in changes for size in (0.0, PROBE_AMPLITUDE)]
    runs = quiet.many(members, record)
    settled = [quiet.settled(runs.member(place)) for place in range(len(members))]
    return list(zip(settled[0::2], settled[1::2], strict=True))


def answer_per_error(straight: Recording, probed: Recording, column: str) -> Complex:
    """Return the answer of a column per error at each order, from runs without and with the probe [unit / rad], shape (4,)."""
    return np.asarray((phasors(probed, column) - phasors(straight, column)) / PROBE_AMPLITUDE)


# ---- Orders of the law --------------------------------------------------------------------------------------------------


def harmonics(law: Any) -> Complex:
    """Return the orders of a law over a revolution [rad], shape (4,)."""
    orders = law.harmonics(int(ERROR_ORDERS[-1]))
    return _sines(np.array(orders.amplitude), np.array(orders.phase))


def displaced(law: Any, m: tuple[float, float], c_x: float = 0.0) -> Any:
    """Return the law with the shaft at m [m] in the housing and the generator c_x [m] off the shaft along its major axis.

    >>> import strainwave as sw
    >>> law, _ = sw.diagnose.wave_generator(sw.load("tilt-actuator-lumped"))
    >>> moved = sw.diagnose.displaced(law, (3e-6, 4e-6), c_x=-2e-6)
    >>> round(1e6 * moved.housing_eccentricity, 3), round(1e6 * moved.generator_eccentricity, 3)  # um
    (5.0, 2.0)
    """
    x, y = m
    return law.replace(
        housing_eccentricity=float(np.hypot(x, y)),
        housing_direction=float(np.arctan2(y, x)),
        generator_eccentricity=abs(c_x),
        generator_direction=0.0 if c_x >= 0.0 else np.pi,
    )


def tilted(law: Any, m: tuple[float, float]) -> Any:
    """Return the law with the tilt of the housing that is equivalent to m [m] in first order."""
    names = ("housing_tilt_x", "housing_tilt_y")
    straight = law.replace(housing_eccentricity=0.0, **dict.fromkeys(names, 0.0))
    ways = np.array([straight.replace(**{name: TILT_STEP}).eccentricity for name in names]).T / TILT_STEP
    angles = np.linalg.solve(ways, np.array(m))
    return straight.replace(**dict(zip(names, angles.tolist(), strict=True)))


def stacked(values: Complex) -> Array:
    """Return real parts, then imaginary parts, along the last axis."""
    return np.concatenate([values.real, values.imag], axis=-1)


def _sines(amplitude: Array, phase: Array) -> Complex:
    return np.asarray(amplitude * np.exp(1j * phase))


def _at(law: Any, point: Array) -> Complex:
    """Return the orders at a point: m, and c_x if it has three numbers [m]."""
    x, y, *c_x = point.tolist()
    return harmonics(displaced(law, (x, y), *c_x))


# ---- Least squares ------------------------------------------------------------------------------------------------------


def inverted(error: MeasuredOrders, law: Any, *, with_offset: bool = False) -> tuple[Array, float]:
    """Return the point by least squares, each order weighted by its noise, and the mean square of the residual over the noise.

    Args:
        with_offset: fit c_x too, if the lobe further out carries. With m it moves the error from orders 2 and 4 to 1 and 3

    Returns:
        m, and c_x if it is fitted [m], shape (2,) or (3,); misfit.
    """
    first, misfit = _least_squares(error, law, _initial_m(error.values, law), M_PER_MICRON)
    if not with_offset or law.combine != "max":
        return first, misfit
    unit = max(float(np.hypot(*first)), 0.1 * M_PER_MICRON)
    point, misfit = np.append(first, 0.0), np.inf
    for larger, share in INITIAL_SHARES:
        tried, left = _least_squares(error, law, larger * np.append(first, share * unit), unit)
        if left < misfit:
            point, misfit = tried, left
        if misfit < GOOD_MISFIT:
            break
    return point, misfit


def _least_squares(error: MeasuredOrders, law: Any, start: Array, unit: float) -> tuple[Array, float]:
    from scipy.optimize import least_squares

    def residual(point: Array) -> Array:
        return stacked((_at(law, M_PER_MICRON * point) - error.values) / error.noise)

    far = MAX_RADIUS_SHARE * float(law.minor_radius) / M_PER_MICRON
    begin = np.clip(start / M_PER_MICRON, -0.9 * far, 0.9 * far)
    scale = max(float(np.abs(begin).max()), 1.0) if len(start) == 2 else unit / M_PER_MICRON
    best: Any = least_squares(residual, begin, bounds=(-far, far), x_scale=scale)
    return M_PER_MICRON * best.x, 2.0 * float(best.cost) / (2 * len(ERROR_ORDERS) - len(start))


def _initial_m(values: Complex, law: Any) -> Array:
    """Return m by the first order that the law has, whose size grows with m or its square, and whose phase turns with it."""
    place = 0 if law.combine == "single" else 1
    ratio = values[place] / harmonics(displaced(law, (M_PER_MICRON, 0.0)))[place]
    size = M_PER_MICRON * float(np.sqrt(abs(ratio)) if law.combine == "mean" else abs(ratio))
    way = -float(np.angle(ratio)) / ERROR_ORDERS[place]
    return size * np.array([np.cos(way), np.sin(way)])


def slopes(law: Any, point: Array) -> Array:
    """Return the slopes of all orders, real parts then imaginary parts, over the point [rad/m], shape (8, 2) or (8, 3)."""
    steps = SLOPE_STEP * np.eye(len(point))
    ways = [stacked(_at(law, point + step) - _at(law, point - step)) / (2.0 * SLOPE_STEP) for step in steps]
    return np.array(ways).T


def to_point(error: MeasuredOrders, law: Any, point: Array) -> Array:
    """Return the matrix that gives the change of the point by a small change of the orders, shape (2, 8) or (3, 8)."""
    sigma = np.tile(error.noise, 2)
    return np.asarray(np.linalg.pinv(slopes(law, point) / sigma[:, None]) / sigma)


def covariance_by(matrix: Array, noise: Array) -> Array:
    """Return the covariance of a point by the noise of the orders [m^2], with the matrix of `to_point`."""
    return np.asarray((matrix * np.tile(noise, 2) ** 2) @ matrix.T)


@dataclass(frozen=True)
class RecoveryModel(Presented):
    """A drive with two runs that determine its response to a kinematic error, without noise of its sensors.

    Attributes:
        ramp: the run
        straight: recording without any error, after the run-in
        probed: the same with an error of every order

    >>> import numpy as np
    >>> import strainwave as sw
    >>> ramp = sw.diagnose.ActuatorRamp.of(sw.load("tilt-actuator-lumped"), stroke=np.radians(60.0), duration=3.0)
    >>> model = sw.diagnose.RecoveryModel.of(ramp)
    >>> [round(float(size)) for size in np.abs(model.gain("current"))]  # A/rad, at orders 1 to 4
    [173, 454, 857, 1299]
    """

    ramp: ActuatorRamp
    straight: Recording
    probed: Recording

    @classmethod
    def of(cls, ramp: ActuatorRamp) -> RecoveryModel:
        """Run a drive without error and with a small one of all orders."""
        ((straight, probed),) = runs_with_probe(ramp, [{}], RECORDED_COLUMNS)
        return cls(ramp.without_noise(), straight, probed)

    def gain(self, column: str) -> Complex:
        """Return the answer over the error at each order [unit of the column / rad], shape (4,)."""
        return answer_per_error(self.straight, self.probed, column)

    def run(self, points: Sequence[tuple[float, float]], law: Any) -> list[Recording]:
        """Return runs with the shaft at some places m [m], after the run-in."""
        changes = [
            {
                f"{ERROR_PATH}.housing_eccentricity": float(np.hypot(*m)),
                f"{ERROR_PATH}.housing_direction": float(np.arctan2(m[1], m[0])),
            }
            for m in points
        ]
        runs = self.ramp.with_error(law).many(changes, RECORDED_COLUMNS)
        return [self.ramp.settled(runs.member(place)) for place in range(len(points))]


def recover(recording: Recording, column: str, model: RecoveryModel, law: Any) -> dict[str, MisalignmentEstimate]:
    """Return the misalignment that a record determines, for each way in which the lobes may share.

    Args:
        recording: with input_angle and the column, after the run-in
        column: from which m is estimated
        model: of the drive
        law: `Misalignment`, whose dimensions are kept

    Returns:
        Estimates by `combine`.

    >>> import numpy as np
    >>> import strainwave as sw
    >>> ramp = sw.diagnose.ActuatorRamp.of(sw.load("tilt-actuator-lumped"), stroke=np.radians(60.0), duration=3.0)
    >>> law, _ = sw.diagnose.wave_generator(ramp.drive)
    >>> record = ramp.settled(ramp.with_error(law.replace(housing_eccentricity=14e-6)).run())
    >>> model = sw.diagnose.RecoveryModel.of(ramp)
    >>> found = sw.diagnose.recover(record, "current", model, law)
    >>> min(found, key=lambda combine: found[combine].misfit)  # the lobe further out carries
    'max'
    """
    error = measured_orders(less_run(recording, model.straight, column), column).over(model.gain(column))
    estimates = {}
    for combine in COMBINE:
        own = law.replace(combine=combine)
        point, misfit = inverted(error, own)
        covariance = covariance_by(to_point(error, own, point), error.noise)
        m = (float(point[0]), float(point[1]))
        estimates[combine] = MisalignmentEstimate(column, combine, m, covariance, error.degrees, misfit)
    return estimates


def refined(
    estimates: Sequence[MisalignmentEstimate], recordings: Sequence[Recording], model: RecoveryModel, law: Any
) -> list[MisalignmentEstimate]:
    """Return the estimates for a drive whose answer depends on the size of the error: each is run, and corrected by the rest.

    Hysteresis and friction answer a small error otherwise than a large one. The corrections shrink by how far the answer to the
    probe is from that to the error itself, some per cent. Between the orders noise alone is left.

    Args:
        estimates: of `recover`, with one `combine`
        recordings: that determined each
        model: of the drive
        law: `Misalignment` with that `combine`

    >>> import numpy as np
    >>> import strainwave as sw
    >>> ramp = sw.diagnose.ActuatorRamp.of(sw.load("tilt-actuator-lumped"), stroke=np.radians(60.0), duration=3.0)
    >>> law, _ = sw.diagnose.wave_generator(ramp.drive)
    >>> record = ramp.settled(ramp.with_error(law.replace(housing_eccentricity=14e-6)).run())
    >>> model = sw.diagnose.RecoveryModel.of(ramp)
    >>> found = sw.diagnose.recover(record, "current", model, law)
    >>> best, = sw.diagnose.refined([found["max"]], [record], model, law)
    >>> round(1e6 * best.size, 1), best.contains((14e-6, 0.0))  # um
    (14.0, True)
    """
    best = list(estimates)
    for _ in range(CORRECTION_RUNS):
        runs = model.run([each.m for each in best], law)
        best = [corrected(*each, model, law) for each in zip(best, recordings, runs, strict=True)]
    return best


def corrected(
    estimate: MisalignmentEstimate, recording: Recording, run: Recording, model: RecoveryModel, law: Any
) -> MisalignmentEstimate:
    """Return the estimate, corrected in one step by the difference of the record from a run with it.

    Args:
        estimate: to correct
        recording: that determined it, or another of the same misalignment
        run: of the model with the estimate
        model: of the drive
        law: `Misalignment` with the `combine` of the estimate

    >>> import numpy as np
    >>> import strainwave as sw
    >>> ramp = sw.diagnose.ActuatorRamp.of(sw.load("tilt-actuator-lumped"), stroke=np.radians(60.0), duration=3.0)
    >>> law, _ = sw.diagnose.wave_generator(ramp.drive)
    >>> record = ramp.settled(ramp.with_error(law.replace(housing_eccentricity=14e-6)).run())
    >>> model = sw.diagnose.RecoveryModel.of(ramp)
    >>> first = sw.diagnose.recover(record, "current", model, law)["max"]
    >>> (run,) = model.run([first.m], law)
    >>> round(1e6 * sw.diagnose.corrected(first, record, run, model, law).size, 1)  # um
    14.0
    """
    column, point = estimate.column, np.array(estimate.m)
    error = measured_orders(less_run(recording, run, column), column).over(model.gain(column))
    matrix = to_point(error, law, point)
    step = matrix @ stacked(error.values)
    rest = (stacked(error.values) - slopes(law, point) @ step) / np.tile(error.noise, 2)
    misfit = float(rest @ rest) / (2 * len(ERROR_ORDERS) - 2)
    m = (float(point[0] + step[0]), float(point[1] + step[1]))
    covariance = covariance_by(matrix, error.noise)
    return MisalignmentEstimate(column, estimate.combine, m, covariance, error.degrees, misfit)
