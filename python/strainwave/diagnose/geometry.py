"""Misalignment of the wave generator from the motor current of a ramp: one vector m = e1 + h beta, its interval, and its class.

The order lines of the current over the current that the drive makes per error are the orders of the kinematic error. These
determine m. A set of numbers describes the drive, each with a spread. Drives drawn by these spreads, moved along their
regression to the mean and the trend of the recorded current, give the uncertainty of the model. Noise of the record adds to it.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from strainwave import Drive
from strainwave.diagnose.actuator_ramp import RUN_IN, ActuatorRamp
from strainwave.diagnose.detection import DETECTION_PROBABILITY, FALSE_ALARM, needed_signal_to_noise
from strainwave.diagnose.inversion import (
    COMBINE,
    ERROR_ORDERS,
    M_PER_MICRON,
    MeasuredOrders,
    MisalignmentEstimate,
    covariance_by,
    displaced,
    harmonics,
    inverted,
    less_run,
    measured_orders,
    stacked,
    tilted,
    to_point,
)
from strainwave.diagnose.possible_drives import TREND_DEGREES, CurrentPerError, PossibleDrives
from strainwave.diagnose.smallest_error import MAX_CATALOGUE_AMPLITUDE
from strainwave.files.gear_set import GearSet
from strainwave.files.recording import Recording
from strainwave.messages import listed
from strainwave.presentation import Presented

Array = NDArray[np.float64]
Complex = NDArray[np.complex128]

SHARES_OF_TILT = 11  # between eccentricity alone and tilt alone, at which the region of m is evaluated
MAX_TREND_SIGMA = 4.0  # a trend further from those of the drawn drives contradicts the set
REFERENCE_ORDER = 2.0  # at which strain wave gears have most of their error
MAX_MISFIT_RATIO = 4.0  # a way of sharing whose misfit is larger than the least by this factor is not named as possible
WORDS_OF_SHARING = {"single": "one lobe carries", "mean": "both lobes share the load", "max": "the lobe further out carries"}
MAX_MISFIT = 8.0  # mean square of the residual of the orders over that of noise and model; by chance 1 record in 10^4 has more
PENALTY_PER_PARAMETER = 6.0  # of a sum of squares: chance alone gains as much in 1 of 70 records
SILENT_PARAMETERS = "e2 and alpha alone change no harmonic and are not identifiable from this record"


@dataclass(frozen=True)
class Sensitivity:
    """Current that a reference error would make in a run, and the least current that the record shows.

    Attributes:
        error: amplitude of the reference error at the output [rad]
        order: of the reference error
        current: amplitude of the current that this error would make [A]
        resolved: amplitude that the record shows with probability 0.9 at a false-alarm probability of 0.001 [A]
        torque: mean torque through the gear, as the drive's model predicts it [N.m]
        needed_torque: torque through the gear by which the reference error would be shown [N.m]
    """

    error: float
    order: float
    current: float
    resolved: float
    torque: float
    needed_torque: float

    @property
    def sensitive(self) -> bool:
        """True if the record would show the reference error."""
        return self.current >= self.resolved

    @property
    def least_error(self) -> float:
        """Amplitude of the least error that the record shows [rad]."""
        return self.error * self.resolved / self.current if self.current > 0.0 else np.inf

    def words(self) -> str:
        """Return whether a run without finding would mean a healthy gear, with both currents."""
        arcmin = 60.0 * np.degrees(self.error)
        numbers = (
            f"an error of {arcmin:.3g} arcmin at order {self.order:g} would make {1e3 * self.current:.3g} mA, "
            f"and this record shows {1e3 * self.resolved:.3g} mA or more"
        )
        if self.sensitive:
            return f"sensitive: {numbers}"
        return (
            f"insensitive: {numbers}. The record does not determine whether the gear is healthy. Load the output with about "
            f"{self.needed_torque:.2g} N.m; the torque through the gear was {round(self.torque, 3):.2g} N.m"
        )


@dataclass(frozen=True)
class Geometry(Presented):
    """Misalignment that a record of the current determines.

    Attributes:
        estimate: m as an eccentricity, with the covariance of noise and of the model together
        tilt_shift: by how much a tilt alone would be less than `estimate`, as it makes the section longer, too [m], shape (2,)
        noise_covariance: of m by the noise of the record alone [m^2], shape (2, 2)
        others: estimates as eccentricity and as tilt, for the other ways in which the lobes may share that fit the record, too
        amplitude: of the largest order line [A]
        detected: True if the order lines are larger than noise makes them, at a false-alarm probability of 0.001
        sensitivity: of the run
        parts: current per error, separated into reaction and inertia
        height: h, distance of the section from the centre of tilt [m]
        contradictions: between record and set, in words
    """

    estimate: MisalignmentEstimate
    tilt_shift: Array
    noise_covariance: Array
    others: Mapping[str, tuple[MisalignmentEstimate, MisalignmentEstimate]]
    amplitude: float
    detected: bool
    sensitivity: Sensitivity
    parts: CurrentPerError
    height: float
    contradictions: tuple[str, ...]

    @property
    def ends(self) -> tuple[MisalignmentEstimate, MisalignmentEstimate]:
        """Estimates if all of m is an eccentricity, and if all of it is a tilt; every sum of both lies between."""
        return self.estimate, as_tilt(self.estimate, self.tilt_shift)

    @property
    def size_interval(self) -> tuple[float, float]:
        """Interval of 95 % of the size of m [m], for every geometry of the class."""
        ends = [(each.size - each.half_widths[0], each.size + each.half_widths[0]) for each in self.ends]
        return max(0.0, min(low for low, _ in ends)), max(high for _, high in ends)

    @property
    def tilt(self) -> float:
        """Tilt of the housing that is equivalent to m [rad]."""
        return float(np.arctan2(self.ends[1].size, self.height))

    def contains(self, m: tuple[float, float]) -> bool:
        """True if m or -m lies in the region of 95 % of any geometry of the class.

        Both make the same orders: where one lobe carries, an e2 beyond m determines which one.
        """
        points = [as_tilt(self.estimate, share * self.tilt_shift) for share in np.linspace(0.0, 1.0, SHARES_OF_TILT)]
        return any(point.contains(side) for point in points for side in (m, (-m[0], -m[1])))

    @property
    def condition(self) -> str:
        """Return "misaligned", "insensitive", or "no misalignment shown".

        A run that does not show the reference error may still show a larger one.
        """
        shown = self.detected and self.amplitude >= self.sensitivity.resolved
        if not (shown or self.sensitivity.sensitive):
            return "insensitive"
        return "misaligned" if self.detected else "no misalignment shown"

    def words(self) -> str:
        """Return the equivalence class of geometries in words, or the reason why there is none."""
        lines = [f"{each}." for each in self.contradictions]
        if self.condition == "insensitive":
            return " ".join([*lines, f"{self.sensitivity.words()}."])
        if self.condition != "misaligned":
            arcmin = 60.0 * np.degrees(self.sensitivity.least_error)
            lines.append(
                f"No misalignment shown; errors below {arcmin:.2g} arcmin at order 2 would not be ({SILENT_PARAMETERS})."
            )
            return " ".join(lines)
        lines.append(f"{in_words(*self.ends, self.height)}; {SILENT_PARAMETERS}.")
        lines += [f"Not excluded: {in_words(*each, self.height)}." for each in self.others.values()]
        return " ".join(lines)


def in_words(eccentricity: MisalignmentEstimate, tilt: MisalignmentEstimate, height: float) -> str:
    """Return the geometries that make the same harmonics, from the estimates as an eccentricity and as a tilt."""
    size, turn = eccentricity.half_widths
    direction = float(np.degrees(eccentricity.direction)) % 360.0
    has_offset = eccentricity.combine == "max"
    way = f"{_between(direction, float(np.degrees(turn)))} deg"
    way += f" (or {(direction + 180.0) % 360.0:.0f} deg{', with -c_x' if has_offset else ''}, which makes the same)"
    angles = (float(np.degrees(np.arctan2(value, height))) for value in (tilt.size, tilt.half_widths[0]))
    c_x = eccentricity.c_x / M_PER_MICRON, eccentricity.interval_factor * eccentricity.c_x_sigma / M_PER_MICRON
    generator = f", and the generator is c_x = {_between(*c_x)} um off its shaft along the major axis" if has_offset else ""
    return (
        f"a housing eccentricity of {_between(eccentricity.size / M_PER_MICRON, size / M_PER_MICRON)} um at {way}, or a tilt "
        f"of the housing of {_between(*angles)} deg at h = {1e3 * height:g} mm, or any sum of both equal to m = e1 + h beta"
        f"{generator} (95 %, if {WORDS_OF_SHARING[eccentricity.combine]})"
    )


def _between(value: float, half: float) -> str:
    """Return value and half width, with one significant digit of the half width, two if it begins with 1."""
    first = int(np.floor(np.log10(max(half, 1e-9))))
    places = max(0, -first + (half < 2.0 * 10.0**first))
    return f"{value:.{places}f} ± {half:.{places}f}"


def as_tilt(estimate: MisalignmentEstimate, tilt_shift: Array) -> MisalignmentEstimate:
    """Return the estimate less the shift that a tilt makes in second order."""
    return replace(estimate, m=(estimate.m[0] - float(tilt_shift[0]), estimate.m[1] - float(tilt_shift[1])))


def ramp_of(recording: Recording, drive: Drive) -> ActuatorRamp:
    """Return the ramp of a record that begins with it: its duration, and the stroke of its speed."""
    time = recording.values("time", "s")
    duration = float(time[-1] - time[0])
    angle = recording.values("input_angle", "rad")
    half = len(time) // 2
    speed = (angle[-1] - angle[half]) / (time[-1] - time[half]) / float(drive.gear.kinematics.ratio)
    if not speed > 0.0:
        raise ValueError(
            f"the output turns at {speed:.3g} rad/s in the record; the model runs ramps to positive angles: turn the signs of "
            "angle and current"
        )
    return ActuatorRamp.of(drive, float(speed) * duration, duration)


def misalignment_from_current(
    recording: Recording,
    gear_set: GearSet | Drive,
    *,
    ramp: ActuatorRamp | None = None,
    drives: PossibleDrives | None = None,
    reference_error: float = MAX_CATALOGUE_AMPLITUDE,
) -> Geometry:
    """Estimate m = e1 + h beta from the current of a ramp.

    Args:
        recording: time, input_angle and current of a ramp, from its beginning; the angle has the zero of the model
        gear_set: the drive with the sources and spreads of its numbers; those of a bare `Drive` count as assumed
        ramp: by default of the duration and the speed of the record, without load besides that of the drive
        drives: of the set in that ramp, if several records of one ramp are diagnosed
        reference_error: amplitude of the error at the output that a run has to show, or it is insensitive [rad]

    Raises:
        ValueError: a column is missing, or the record is no ramp that the drive follows
    """
    drive = gear_set if isinstance(gear_set, Drive) else gear_set.drive
    drives = drives or PossibleDrives.of(gear_set, ramp or ramp_of(recording, drive))
    begin, law = float(recording.values("time", "s")[0]), drives.law
    settled = recording.between(begin + drives.ramp.duration * RUN_IN, begin + drives.ramp.duration)
    gains, ripple, off = drives.like(settled)
    orders = measured_orders(less_run(settled, drives.straight, "current"), "current")
    measured = replace(orders, values=orders.values - ripple.mean(axis=0), noise=np.hypot(orders.noise, _spread(ripple)))
    estimates = {way: _estimate(measured, orders.noise, ripple, gains, law.replace(combine=way)) for way in COMBINE}
    teeth_part = 0.5 * float(law.major_radius - law.minor_radius)
    possible = {way: each for way, each in estimates.items() if each.estimate.size < teeth_part} or estimates
    best = min(possible, key=lambda way: estimates[way].penalised)
    limit = MAX_MISFIT_RATIO * max(estimates[best].estimate.misfit, 1.0)
    for way in [way for way in possible if estimates[way].estimate.misfit < limit]:
        first, shared = estimates[way].estimate, law.replace(combine=way)
        larger = gains * drives.gain_of_size(displaced(shared, first.m, first.c_x))
        estimates[way] = possible[way] = _estimate(measured, orders.noise, ripple, larger, shared)
    chosen = estimates[best]
    others = {
        way: (each.estimate, as_tilt(each.estimate, each.tilt_shift))
        for way, each in possible.items()
        if way != best and each.estimate.misfit < limit and not chosen.estimate.contains(each.estimate.m)
    }
    return Geometry(
        chosen.estimate,
        chosen.tilt_shift,
        chosen.of_noise,
        others,
        float(np.abs(measured.values).max()),
        measured.false_alarm < FALSE_ALARM,
        _sensitivity(measured, gains, drives.parts, reference_error),
        drives.parts,
        float(law.offset),
        _contradictions(off, chosen.estimate.misfit),
    )


@dataclass(frozen=True)
class _Estimate:
    """Estimate of one way of sharing, with what its words need.

    Attributes:
        estimate: with the covariance of noise and model
        tilt_shift: of m, if all of it is a tilt [m], shape (2,)
        of_noise: covariance of m by noise alone [m^2], shape (2, 2)
    """

    estimate: MisalignmentEstimate
    tilt_shift: Array
    of_noise: Array

    @property
    def penalised(self) -> float:
        """Sum of squares of the residual, and a penalty of each parameter: of two ways that fit, the simpler one is taken."""
        parameters = 3 if self.estimate.combine == "max" else 2
        return self.estimate.misfit * (2 * len(ERROR_ORDERS) - parameters) + PENALTY_PER_PARAMETER * parameters


def _estimate(measured: MeasuredOrders, noise: Array, ripple: Complex, gains: Complex, law: Any) -> _Estimate:
    """Return m with the covariance of noise and model, the shift of a tilt, and the covariance of noise alone."""
    gain = np.exp(np.log(gains / gains[0]).mean(axis=0)) * gains[0]
    model_noise = np.abs(measured.values) * _spread(gains / gain - 1.0)
    error = replace(measured, noise=np.hypot(measured.noise, model_noise)).over(gain)
    point, misfit = inverted(error, law, with_offset=True)
    matrix = to_point(error, law, point)
    of_noise = covariance_by(matrix, noise / np.abs(gain))
    points = stacked((measured.values + ripple.mean(axis=0) - ripple) / gains) @ matrix.T
    members = len(gains)
    of_model: Array = np.cov(points.T) * (1.0 + 1.0 / members)
    degrees = members - 2 - TREND_DEGREES
    if np.trace(of_noise[:2, :2]) > np.trace(of_model[:2, :2]):
        degrees = min(degrees, measured.degrees)
    x, y, *offset = point.tolist()
    bent = harmonics(tilted(displaced(law, (0.0, 0.0), *offset), (x, y))) - harmonics(displaced(law, (x, y), *offset))
    shift: Array = matrix[:2] @ stacked(bent)
    covariance = of_noise + of_model
    own = {"c_x": offset[0], "c_x_sigma": float(np.sqrt(covariance[2, 2]))} if offset else {}
    estimate = MisalignmentEstimate("current", law.combine, (x, y), covariance[:2, :2], degrees, misfit, **own)
    return _Estimate(estimate, shift, of_noise[:2, :2])


def _spread(values: Complex) -> Array:
    """Return the standard deviation of the real and of the imaginary part, taken together, of each column."""
    return np.asarray(np.std(values, axis=0, ddof=1) / np.sqrt(2.0), dtype=float)


def _sensitivity(measured: MeasuredOrders, gains: Complex, parts: CurrentPerError, error: float) -> Sensitivity:
    place = ERROR_ORDERS.index(REFERENCE_ORDER)
    current = error * float(np.abs(gains[:, place].mean()))
    needed = needed_signal_to_noise(DETECTION_PROBABILITY, FALSE_ALARM, measured.degrees, len(ERROR_ORDERS))
    resolved = needed * float(measured.noise[place])
    per_torque = error * abs(complex(parts.per_torque[place]))
    return Sensitivity(error, REFERENCE_ORDER, current, resolved, parts.torque, resolved / per_torque)


def _contradictions(off: Array, misfit: float) -> tuple[str, ...]:
    names = ("mean", "slope over the angle", "curvature over the angle")
    far = [f"{name} by {size:.1f}" for name, size in zip(names, off, strict=True) if abs(size) > MAX_TREND_SIGMA]
    contradictions = []
    if far:
        contradictions.append(
            f"The current contradicts the drives of this set: {listed(far)} standard deviations from theirs. The interval does "
            "not count; check load, friction and torque constant first"
        )
    if not misfit < MAX_MISFIT:
        contradictions.append(
            "The orders 1 to 4 do not have the ratios of a misalignment: the mean square of their residual is "
            f"{misfit:.3g} times that of noise and model. Errors of teeth, a ripple of friction or of the motor, or an e2 "
            "in addition to m explain such orders"
        )
    return tuple(contradictions)
