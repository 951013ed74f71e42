"""A misalignment from a record of a ramp: order analysis, and what the model of the drive makes of an error at each order."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from strainwave import kinematic_error
from strainwave.diagnose.actuator_ramp import ERROR, ActuatorRamp
from strainwave.files.recording import Recording
from strainwave.orders.order_spectrum import order_amplitudes, order_spectrum

Array = NDArray[np.float64]
Complex = NDArray[np.complex128]

COMBINE = ("single", "mean", "max")
MICRON = 1e-6
ORDERS = (1.0, 2.0, 3.0, 4.0)
SEEN = ("input_angle", "transmission_error", "current")
NEIGHBOURS = 8  # lines on each side of an order, whose size tells the noise; but for the next, which has half of the order
HANN = 1.5  # power of noise in a line through a Hann window over that without
PROBE = 2e-5  # rad: amplitude of each order by which the model of the drive is probed
CORRECTIONS = 2
SMALL = 1e-8  # m: step by which the slopes of the orders are taken
CONFIDENCE = 0.95


@dataclass(frozen=True)
class Model:
    """A drive whose answer to a kinematic error is known at each order, from two runs without noise of its sensors.

    Attributes:
        ramp: what was run
        straight: recording without any error, after the run-in
        probed: the same with an error of every order
    """

    ramp: ActuatorRamp
    straight: Recording
    probed: Recording

    @classmethod
    def of(cls, ramp: ActuatorRamp) -> Model:
        """Runs a drive with an error of a few orders, small and of equal size, and without."""
        quiet = ramp.without_noise()
        changes = [{f"{ERROR}.amplitude[{place}]": size for place in range(len(ORDERS))} for size in (0.0, PROBE)]
        runs = quiet.with_error(none_and_probe()).many(changes, SEEN)
        return cls(quiet, *(quiet.settled(runs.member(place)) for place in (0, 1)))

    def gain(self, column: str) -> Complex:
        """Answer over error at each order [unit of the column / rad], shape (4,)."""
        none, probe = (order_amplitudes(run, column, ORDERS) for run in (self.straight, self.probed))
        answers: Complex = _sines(probe.amplitude, probe.phase) - _sines(none.amplitude, none.phase)
        return answers / PROBE

    def run(self, points: Sequence[tuple[float, float]], law: Any) -> list[Recording]:
        """Runs with the shaft at some places m [m], after the run-in."""
        changes = [
            {f"{ERROR}.housing_eccentricity": float(np.hypot(*m)), f"{ERROR}.housing_direction": float(np.arctan2(m[1], m[0]))}
            for m in points
        ]
        runs = self.ramp.with_error(law).many(changes, SEEN)
        return [self.ramp.settled(runs.member(place)) for place in range(len(points))]


@dataclass(frozen=True)
class Seen:
    """Orders of a record.

    Attributes:
        at: amplitude and phase of each order as a sine of the input angle [unit], shape (4,)
        noise: standard deviation of the real and of the imaginary part of each [unit], shape (4,)
        degrees: of freedom of the noise of an order
    """

    at: Complex
    noise: Array
    degrees: int


@dataclass(frozen=True)
class Recovered:
    """What a column tells of the misalignment.

    Attributes:
        column: in which it was looked for
        combine: how the lobes share, as assumed
        m: found [m]; where the lobe further out carries, and where two carry alike, m and -m are the same
        covariance: of m [m^2], shape (2, 2)
        degrees: of freedom of the noise
        misfit: mean square of what is left over the noise; about 1 where `combine` is right
    """

    column: str
    combine: str
    m: tuple[float, float]
    covariance: Array
    degrees: int
    misfit: float

    @property
    def size(self) -> float:
        """How large m is [m]."""
        return float(np.hypot(*self.m))

    @property
    def direction(self) -> float:
        """Where m points [rad]."""
        return float(np.arctan2(self.m[1], self.m[0]))

    @property
    def reach(self) -> float:
        """Half axes of the ellipse of 95 % confidence over standard deviations."""
        from scipy.stats import f

        return float(np.sqrt(2.0 * f.ppf(CONFIDENCE, 2, self.degrees)))

    @property
    def half_widths(self) -> tuple[float, float]:
        """Half of the intervals of 95 % of the size [m] and of the direction [rad], each by itself."""
        from scipy.stats import t

        along = np.array(self.m) / max(self.size, 1e-12)
        across = np.array([-along[1], along[0]])
        factor = float(t.ppf(0.5 + 0.5 * CONFIDENCE, self.degrees))
        deviations = [float(np.sqrt(way @ self.covariance @ way)) for way in (along, across)]
        return factor * deviations[0], factor * deviations[1] / max(self.size, 1e-12)

    def contains(self, m: tuple[float, float]) -> bool:
        """Whether a vector lies in the ellipse of 95 % confidence, or its opposite does where the two are the same."""
        signs = (1.0,) if self.combine == "single" else (1.0, -1.0)
        gaps = [np.array(self.m) - sign * np.array(m) for sign in signs]
        return bool(min(float(gap @ np.linalg.solve(self.covariance, gap)) for gap in gaps) <= self.reach**2)


def recover(recording: Recording, column: str, model: Model, law: Any) -> dict[str, Recovered]:
    """The misalignment that a record tells, for each way in which the lobes may share.

    Args:
        recording: with input_angle and the column, after the run-in
        column: in which to look
        model: of the drive
        law: `Misalignment`, whose dimensions are kept

    Returns:
        What was found, by `combine`.
    """
    gain = model.gain(column)
    seen = look(beside(recording, model.straight, column), column)
    return {each: solved(seen.at / gain, seen, gain, column, law.replace(combine=each)) for each in COMBINE}


def refined(found: Sequence[Recovered], recordings: Sequence[Recording], model: Model, law: Any) -> list[Recovered]:
    """The same, for drives whose answer depends on the size of the error: what was found is run, and corrected by the rest.

    Hysteresis and friction answer a small error otherwise than a large one. The corrections shrink by how far the answer to the
    probe is from that to the error itself, some per cent. What is left between the orders is noise alone.

    Args:
        found: what was found with one `combine`
        recordings: from which each was found
        model: of the drive
        law: `Misalignment` with that `combine`
    """
    best = list(found)
    for _ in range(CORRECTIONS):
        runs = model.run([each.m for each in best], law)
        best = [corrected(*each, model, law) for each in zip(best, recordings, runs, strict=True)]
    return best


def corrected(found: Recovered, recording: Recording, run: Recording, model: Model, law: Any) -> Recovered:
    """What was found, corrected in one step by how far the record is from a run with it."""
    gain = model.gain(found.column)
    seen = look(beside(recording, run, found.column), found.column)
    asked, sigma = seen.at / gain, seen.noise / np.abs(gain)
    slopes = slopes_of(law, found.m) / np.concatenate([sigma, sigma])[:, None]
    wanted = np.concatenate([(asked / sigma).real, (asked / sigma).imag])
    step, *_ = np.linalg.lstsq(slopes, wanted, rcond=None)
    covariance: Array = np.linalg.pinv(slopes.T @ slopes)
    misfit = float(np.sum((wanted - slopes @ step) ** 2)) / (2 * len(ORDERS) - 2)
    m = (float(found.m[0] + step[0]), float(found.m[1] + step[1]))
    return Recovered(found.column, found.combine, m, covariance, seen.degrees, misfit)


def slopes_of(law: Any, m: tuple[float, float]) -> Array:
    """Return the slopes of the real parts and of the imaginary parts of all orders over m [rad/m], shape (8, 2)."""
    place = np.array(m)
    ways = [
        (harmonics(placed(law, tuple(place + step))) - harmonics(placed(law, tuple(place - step)))) / (2.0 * SMALL)
        for step in SMALL * np.eye(2)
    ]
    return np.array([np.concatenate([way.real, way.imag]) for way in ways]).T


def beside(recording: Recording, run: Recording, column: str) -> Recording:
    """How far a column of a record is from that of a run at the same input angle."""
    angle = recording.values("input_angle", "rad")
    turned, there = run["input_angle"], run[column]
    sense = np.sign(turned[-1] - turned[0])
    difference = recording.values(column, run.unit(column)) - np.interp(sense * angle, sense * turned, there)
    return Recording({"input_angle": angle, column: difference}, {"input_angle": "rad", column: run.unit(column)})


def look(recording: Recording, column: str) -> Seen:
    """The orders of a column, and its noise.

    Lines between the orders have noise alone; those near an order tell how much of it the order has. They come from a spectrum
    through a Hann window. It adds half to the power of noise, and the powers of neighbouring lines correlate by 4/9, of next
    ones by 1/36, so that two lines tell about as much as one without a window.
    """
    there = order_amplitudes(recording, column, ORDERS)
    spectrum = order_spectrum(recording, column, ORDERS[-1] + 0.5)
    line = np.rint(spectrum["order"] * there.revolutions)
    reach = min(NEIGHBOURS, (there.revolutions - 2) // 2)
    apart = [np.abs(line - order * there.revolutions) for order in ORDERS]
    near = [spectrum["amplitude"][(distance > 1) & (distance <= reach)] for distance in apart]
    noise = np.sqrt(np.array([np.mean(lines**2) for lines in near]) / (2.0 * HANN))
    degrees = round(2.0 * len(near[0]) / (1.0 + 2.0 * (4.0 / 9.0 + 1.0 / 36.0)))
    return Seen(_sines(there.amplitude, there.phase), np.maximum(noise, np.finfo(float).tiny), degrees)


def placed(law: Any, m: tuple[float, float], c_x: float = 0.0) -> Any:
    """The law with the shaft at m [m] in the housing and the generator c_x [m] off the shaft along its major axis."""
    x, y = m
    return law.replace(
        housing_eccentricity=float(np.hypot(x, y)),
        housing_direction=float(np.arctan2(y, x)),
        generator_eccentricity=abs(c_x),
        generator_direction=0.0 if c_x >= 0.0 else np.pi,
    )


def none_and_probe() -> Any:
    """Return the law of an error of a few orders, of no size, whose amplitudes a run may set."""
    return kinematic_error.Fourier(order=ORDERS, amplitude=[0.0] * len(ORDERS), phase=[0.0] * len(ORDERS))


def harmonics(law: Any) -> Complex:
    """The orders of a law over a turn [rad], shape (4,)."""
    there = law.harmonics(int(ORDERS[-1]))
    return _sines(np.array(there.amplitude), np.array(there.phase))


def _sines(amplitude: Array, phase: Array) -> Complex:
    values: Complex = amplitude * np.exp(1j * phase)
    return values


def solved(asked: Complex, seen: Seen, gain: Complex, column: str, law: Any) -> Recovered:
    """m by least squares from an error at each order [rad], each weighed by its noise."""
    from scipy.optimize import least_squares

    sigma = seen.noise / np.abs(gain)

    def gap(point: Array) -> Array:
        rest = (harmonics(placed(law, (MICRON * float(point[0]), MICRON * float(point[1])))) - asked) / sigma
        return np.concatenate([rest.real, rest.imag])

    far = 0.4 * float(law.minor_radius) / MICRON
    begin = np.clip(np.array(_start(asked, law)) / MICRON, -0.9 * far, 0.9 * far)
    best: Any = least_squares(gap, begin, bounds=(-far, far), x_scale=max(float(np.abs(begin).max()), 1.0))
    covariance: Array = MICRON**2 * np.linalg.pinv(best.jac.T @ best.jac)
    m = (MICRON * float(best.x[0]), MICRON * float(best.x[1]))
    return Recovered(column, law.combine, m, covariance, seen.degrees, 2.0 * float(best.cost) / (2 * len(ORDERS) - 2))


def _start(asked: Complex, law: Any) -> tuple[float, float]:
    """m by the first order that the law has, whose size grows with m, or with its square, and whose phase turns with it."""
    place = 0 if law.combine == "single" else 1
    unit = harmonics(placed(law, (MICRON, 0.0)))[place]
    ratio = asked[place] / unit
    size = MICRON * float(np.sqrt(abs(ratio)) if law.combine == "mean" else abs(ratio))
    way = -float(np.angle(ratio)) / ORDERS[place]
    return size * float(np.cos(way)), size * float(np.sin(way))
