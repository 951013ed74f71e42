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
from strainwave.diagnose.actuator_ramp import ERROR, RUN_IN, ActuatorRamp, geometry
from strainwave.diagnose.reaction import CurrentPerError, current_per_error
from strainwave.diagnose.recovery import (
    COMBINE,
    MICRON,
    ORDERS,
    PROBE,
    SMALL,
    Recovered,
    Seen,
    beside,
    harmonics,
    look,
    none_and_probe,
    placed,
    solved,
)
from strainwave.files.gear_set import GearSet
from strainwave.files.recording import Recording
from strainwave.messages import listed
from strainwave.orders.order_spectrum import order_amplitudes
from strainwave.parameters import every
from strainwave.tuning.drawn import drawn_gears

Array = NDArray[np.float64]
Complex = NDArray[np.complex128]

SHARES_OF_TILT = 11  # between eccentricity alone and tilt alone, at which the region of m is evaluated
POSSIBLE_DRIVES = 64  # drawn: determines a standard deviation to 9 %
TREND_DEGREES = 2  # of the polynomial of the current over the angle, by which a record chooses among the drawn drives
MAX_TREND_SIGMA = 4.0  # a trend further from those of the drawn drives contradicts the set
REFERENCE_ERROR = np.radians(1.0 / 60.0)  # rad: amplitude of an error that a run has to show, or it is insensitive
REFERENCE_ORDER = 2.0  # at which strain wave gears have most of their error
FALSE_ALARM, DETECTION = 1e-3, 0.9  # probabilities that define what a record resolves
MAX_MISFIT_RATIO = 4.0  # a way of sharing whose misfit is larger than the least by this factor is not named as possible
LOBES = {
    "single": "one lobe carries",
    "mean": "both lobes share the load",
    "max": "the lobe further out carries",
}
MAX_MISFIT = 8.0  # mean square of the residual of the orders over that of noise and model; by chance 1 record in 10^4 has more
MIN_RELATIVE_ORDER = 0.01  # of the largest order of a law: smaller ones are those of rounding
STARTS = ((1.0, 0.0), (1.1, 0.4), (1.1, -0.4), (1.6, 0.8), (1.6, -0.8))  # initial m over a first estimate, and c_x over m
GOOD_MISFIT = 2.0  # no further start is tried
PENALTY_PER_PARAMETER = 6.0  # of a sum of squares: chance alone gains as much in 1 of 70 records
SMALL_TILT = 1e-5  # rad: by which the eccentricity per tilt is taken
SILENT = "e2 and alpha alone change no harmonic and are not identifiable from this record"


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
class Geometry:
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
        doubts: contradictions between record and set
    """

    estimate: Recovered
    tilt_shift: Array
    noise_covariance: Array
    others: Mapping[str, tuple[Recovered, Recovered]]
    amplitude: float
    detected: bool
    sensitivity: Sensitivity
    parts: CurrentPerError
    height: float
    doubts: tuple[str, ...]

    @property
    def ends(self) -> tuple[Recovered, Recovered]:
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
        """Return the equivalence class of geometries, or why there is none."""
        lines = [f"{each}." for each in self.doubts]
        if self.condition == "insensitive":
            return " ".join([*lines, f"{self.sensitivity.words()}."])
        if self.condition != "misaligned":
            arcmin = 60.0 * np.degrees(self.sensitivity.least_error)
            lines.append(f"No misalignment shown; errors below {arcmin:.2g} arcmin at order 2 would not be ({SILENT}).")
            return " ".join(lines)
        lines.append(f"{in_words(*self.ends, self.height)}; {SILENT}.")
        lines += [f"Not excluded: {in_words(*each, self.height)}." for each in self.others.values()]
        return " ".join(lines)


def in_words(eccentricity: Recovered, tilt: Recovered, height: float) -> str:
    """Return the geometries that make the same harmonics, from the estimates as an eccentricity and as a tilt."""
    size, turn = eccentricity.half_widths
    direction = float(np.degrees(eccentricity.direction)) % 360.0
    way = f"{_between(direction, float(np.degrees(turn)))} deg"
    way += f" (or {(direction + 180.0) % 360.0:.0f} deg, which makes the same)"
    angles = (float(np.degrees(np.arctan2(value, height))) for value in (tilt.size, tilt.half_widths[0]))
    return (
        f"a housing eccentricity of {_between(eccentricity.size / MICRON, size / MICRON)} um at {way}, or a tilt of "
        f"the housing of {_between(*angles)} deg at h = {1e3 * height:g} mm, or any sum of both equal to m = e1 + h beta "
        f"(95 %, if {LOBES[eccentricity.combine]})"
    )


def _between(value: float, half: float) -> str:
    """Return value and half width, with one significant digit of the half width, two if it begins with 1."""
    first = int(np.floor(np.log10(max(half, 1e-9))))
    places = max(0, -first + (half < 2.0 * 10.0**first))
    return f"{value:.{places}f} ± {half:.{places}f}"


def as_tilt(estimate: Recovered, tilt_shift: Array) -> Recovered:
    """Return the estimate less the shift that a tilt makes in second order."""
    return replace(estimate, m=(estimate.m[0] - float(tilt_shift[0]), estimate.m[1] - float(tilt_shift[1])))


@dataclass(frozen=True)
class PossibleDrives:
    """Drives that a set may be, in one run: current per error, current without error, and trend of the current.

    Attributes:
        ramp: run, with the nominal drive
        straight: recording of the nominal drive without error, after the run-in
        nominal: current per error of the nominal drive [A/rad], shape (4,)
        gains: current per error of each drawn drive [A/rad], shape (members, 4)
        ripple: orders of the current of each drawn drive without error, less those of the nominal one [A], shape (members, 4)
        trends: polynomial of the current over the angle, of each drawn drive [A], shape (members, 3)
        parts: current per error of the nominal drive, separated
        law: `Misalignment` of the drive, straight
    """

    ramp: ActuatorRamp
    straight: Recording
    nominal: Complex
    gains: Complex
    ripple: Complex
    trends: Array
    parts: CurrentPerError
    law: Any

    @classmethod
    def of(cls, gear_set: GearSet | Drive, ramp: ActuatorRamp, members: int = POSSIBLE_DRIVES, seed: int = 0) -> PossibleDrives:
        """Run the nominal drive and drawn ones, each without error and with a small error of all orders.

        Args:
            gear_set: the drive with the sources and spreads of its numbers; those of a bare `Drive` count as assumed
            ramp: the run, of that drive
            members: how many drives are drawn
            seed: of the draws
        """
        changes = drawn_changes(gear_set, ramp, members, seed)
        both = [
            {**change, **{f"{ERROR}.amplitude[{place}]": size for place in range(len(ORDERS))}}
            for change in ({}, *changes)
            for size in (0.0, PROBE)
        ]
        quiet = ramp.without_noise()
        runs = quiet.with_error(none_and_probe()).many(both, ["current"])
        settled = [quiet.settled(runs.member(place)) for place in range(len(both))]
        lines = np.array([_lines(run) for run in settled])
        none, probe = lines[0::2], lines[1::2]
        gains = (probe - none) / PROBE
        trends = np.array([trend(run)[0] for run in settled[2::2]])
        law, _ = geometry(ramp.drive)
        return cls(ramp, settled[0], gains[0], gains[1:], none[1:] - none[0], trends, current_per_error(ramp), law)

    def like(self, recording: Recording) -> tuple[Complex, Complex, Array]:
        """Return gains and ripple of the drives whose current has the trend of a record, and how far the trend is off.

        Gain and ripple of each drawn drive are moved along their regression over the trend, to the trend of the record.

        Returns:
            Gains, shape (members, 4); ripple, shape (members, 4); distance of the trend of the record from the mean of the
            drawn drives, in standard deviations, shape (3,).
        """
        here, sigma = trend(recording)
        chance = np.random.default_rng(0)
        seen = self.trends + sigma * chance.standard_normal(self.trends.shape)
        scale = np.maximum(seen.std(axis=0, ddof=1), 1e-9)
        off = (here - seen.mean(axis=0)) / scale
        design = np.column_stack([np.ones(len(seen)), (seen - here) / scale])
        relative = np.log(self.gains / self.nominal)
        gains = self.nominal * np.exp(_moved(design, relative))
        return gains, _moved(design, self.ripple), off

    def gain_of_size(self, law: Any) -> Complex:
        """Return the current per error of the nominal drive with a misalignment, over that with a small error, shape (4,).

        The torque through the gear swings with the error, so that the reaction has a part with its square. Orders that the law
        does not have are not changed.
        """
        quiet = self.ramp.without_noise().with_error(law)
        run = quiet.settled(quiet.many([{f"{ERROR}.housing_eccentricity": law.housing_eccentricity}], ["current"]).member(0))
        orders = harmonics(law)
        has = np.abs(orders) > MIN_RELATIVE_ORDER * np.abs(orders).max()
        ratio = (_lines(run) - _lines(self.straight)) / np.where(has, orders, 1.0) / self.nominal
        return np.where(has, ratio, 1.0 + 0.0j)


def _moved(design: Array, values: Complex) -> Complex:
    """Return values of drawn drives, moved to where all columns of the design but the first are zero.

    What is left of the regression is enlarged by the degrees of freedom that it took.
    """
    found, *_ = np.linalg.lstsq(design.astype(complex), values, rcond=1e-6)
    rest = values - design @ found
    members, terms = design.shape
    moved: Complex = found[0] + rest * np.sqrt((members - 1.0) / (members - terms))
    return moved


def drawn_changes(gear_set: GearSet | Drive, ramp: ActuatorRamp, members: int, seed: int) -> list[dict[str, float]]:
    """Return what each of some drives that a set may be changes of the nominal one; their kinematic errors are not drawn."""
    whole = GearSet.of(gear_set, name="drive", source="assumed") if isinstance(gear_set, Drive) else gear_set
    own = every(ramp.drive)
    draws = {
        path: values for path, values in drawn_gears(whole, members, seed).items() if not path.startswith(ERROR) and path in own
    }
    return [{path: float(values[member]) for path, values in draws.items()} for member in range(members)]


def trend(recording: Recording) -> tuple[Array, Array]:
    """Return the polynomial of the current over the angle, in Legendre's terms [A], and its standard deviations by noise.

    The orders are fitted with it, so that none changes the polynomial of a record that has no whole number of revolutions.
    """
    angle, current = recording.values("input_angle", "rad"), recording.values("current", "A")
    terms = np.polynomial.legendre.legvander(2.0 * (angle - angle.min()) / np.ptp(angle) - 1.0, TREND_DEGREES)
    waves = [wave(order * angle) for order in ORDERS for wave in (np.sin, np.cos)]
    design = np.column_stack([terms, *waves])
    found: Any = np.linalg.lstsq(design, current, rcond=None)[0]
    white = float(np.std(np.diff(current - design @ found)) / np.sqrt(2.0))
    covariance: Any = np.linalg.inv(design.T @ design)
    kept = TREND_DEGREES + 1
    return found[:kept], white * np.sqrt(np.diag(covariance)[:kept])


def ramp_of(recording: Recording, drive: Drive) -> ActuatorRamp:
    """Return the ramp of a record that begins with it: its duration, and the stroke of its speed.

    Raises:
        ValueError: the input turns against the sense of a ramp to positive output angles, or `ActuatorRamp` refuses the ramp
    """
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
    reference_error: float = REFERENCE_ERROR,
) -> Geometry:
    """Estimate m = e1 + h beta from the current of a ramp.

    Args:
        recording: time, input_angle and current of a ramp, from its beginning; the angle has the zero of the model
        gear_set: the drive with the sources and spreads of its numbers; those of a bare `Drive` count as assumed
        ramp: the run; by default the duration and the speed of the record, without load besides that of the drive
        drives: of the set in that ramp, if several records of one ramp are diagnosed
        reference_error: amplitude of the error at the output that a run has to show, or it is insensitive [rad]

    Raises:
        ValueError: a column is missing, or the record is no ramp that the drive follows
    """
    drive = gear_set if isinstance(gear_set, Drive) else gear_set.drive
    known = drives or PossibleDrives.of(gear_set, ramp or ramp_of(recording, drive))
    begin = float(recording.values("time", "s")[0])
    settled = recording.between(begin + known.ramp.duration * RUN_IN, begin + known.ramp.duration)
    gains, ripple, off = known.like(settled)
    seen = look(beside(settled, known.straight, "current"), "current")
    masked = Seen(seen.at - ripple.mean(axis=0), np.hypot(seen.noise, _spread(ripple)), seen.degrees)
    found = {combine: _estimate(masked, seen.noise, ripple, gains, known.law.replace(combine=combine)) for combine in COMBINE}
    teeth_part = 0.5 * float(known.law.major_radius - known.law.minor_radius)
    possible = {combine: each for combine, each in found.items() if each.estimate.size < teeth_part} or found
    best = min(possible, key=lambda combine: found[combine].penalised)
    limit = MAX_MISFIT_RATIO * max(found[best].estimate.misfit, 1.0)
    for combine in [each for each in possible if found[each].estimate.misfit < limit]:
        law = known.law.replace(combine=combine)
        larger = gains * known.gain_of_size(placed(law, found[combine].estimate.m, found[combine].c_x))
        found[combine] = possible[combine] = _estimate(masked, seen.noise, ripple, larger, law)
    others = {
        combine: (each.estimate, as_tilt(each.estimate, each.tilt_shift))
        for combine, each in possible.items()
        if combine != best and each.estimate.misfit < limit and not found[best].estimate.contains(each.estimate.m)
    }
    return Geometry(
        found[best].estimate,
        found[best].tilt_shift,
        found[best].of_noise,
        others,
        float(np.abs(masked.at).max()),
        _detected(masked),
        _sensitivity(masked, gains, known.parts, reference_error),
        known.parts,
        float(known.law.offset),
        (*_doubts(off), *_doubts_of_fit(found[best].estimate)),
    )


@dataclass(frozen=True)
class _Estimate:
    estimate: Recovered
    c_x: float
    tilt_shift: Array
    of_noise: Array

    @property
    def penalised(self) -> float:
        """Sum of squares of the residual, and a penalty of each parameter: of two ways that fit, the simpler one is taken."""
        parameters = 3 if self.estimate.combine == "max" else 2
        return self.estimate.misfit * (2 * len(ORDERS) - parameters) + PENALTY_PER_PARAMETER * parameters


def _estimate(masked: Seen, noise: Array, ripple: Complex, gains: Complex, law: Any) -> _Estimate:
    """Return m with the covariance of noise and model, the shift of a tilt, and the covariance of noise alone."""
    gain = np.exp(np.log(gains / gains[0]).mean(axis=0)) * gains[0]
    model_noise = np.abs(masked.at) * _spread(gains / gain - 1.0)
    weights = Seen(masked.at, np.hypot(masked.noise, model_noise), masked.degrees)
    first = solved(masked.at / gain, weights, gain, "current", law)
    point, misfit = _with_offset(first, masked.at / gain, weights.noise / np.abs(gain), law)
    m, c_x = (float(point[0]), float(point[1])), float(point[2])
    slopes = _slopes(law, point)
    sigma = np.concatenate([weights.noise / np.abs(gain)] * 2)
    to_m = (np.linalg.pinv(slopes / sigma[:, None]) / sigma)[:2]
    of_noise: Array = (to_m * np.concatenate([noise / np.abs(gain)] * 2) ** 2) @ to_m.T
    points = _stacked((masked.at + ripple.mean(axis=0) - ripple) / gains) @ to_m.T
    members = len(gains)
    of_model: Array = np.cov(points.T) * (1.0 + 1.0 / members)
    degrees = members - 2 - TREND_DEGREES
    if np.trace(of_noise) > np.trace(of_model):
        degrees = min(degrees, masked.degrees)
    shift: Array = to_m @ _stacked(harmonics(tilted(placed(law, (0.0, 0.0), c_x), m)) - harmonics(placed(law, m, c_x)))
    estimate = Recovered("current", law.combine, m, of_noise + of_model, degrees, misfit)
    return _Estimate(estimate, c_x, shift, of_noise)


def _with_offset(first: Recovered, asked: Complex, sigma: Array, law: Any) -> tuple[Array, float]:
    """Return m and the place c_x of the generator on its shaft [m], shape (3,), and the misfit.

    Where the lobe further out carries, c_x beside m moves the error from orders 2 and 4 to orders 1 and 3. Else it is zero.
    """
    start = np.array([*first.m, 0.0])
    if law.combine != "max":
        return start, first.misfit
    from scipy.optimize import least_squares

    def gap(point: Array) -> Array:
        return _stacked((_harmonics_at(law, MICRON * point) - asked) / sigma)

    unit = max(first.size / MICRON, 0.1)
    far = 0.4 * float(law.minor_radius) / MICRON
    freedom = 2 * len(ORDERS) - 3
    best: Any = None
    for larger, share in STARTS:
        begin = np.clip(np.array([*(larger * start[:2] / MICRON), share * larger * unit]), -0.9 * far, 0.9 * far)
        fit: Any = least_squares(gap, begin, bounds=(-far, far), x_scale=unit)
        best = fit if best is None or fit.cost < best.cost else best
        if 2.0 * best.cost / freedom < GOOD_MISFIT:
            break
    return MICRON * best.x, 2.0 * float(best.cost) / freedom


def _harmonics_at(law: Any, point: Array) -> Complex:
    x, y, c_x = (float(each) for each in point)
    return harmonics(placed(law, (x, y), c_x))


def _slopes(law: Any, point: Array) -> Array:
    """Return the slopes of all orders over m, and over c_x where the lobe further out carries, shape (8, 2) or (8, 3)."""
    steps = SMALL * np.eye(3)[: 3 if law.combine == "max" else 2]
    sides = [(_harmonics_at(law, point + step), _harmonics_at(law, point - step)) for step in steps]
    return np.array([_stacked(after - before) / (2.0 * SMALL) for after, before in sides]).T


def _stacked(values: Complex) -> Array:
    """Return real parts, then imaginary parts, along the last axis."""
    return np.concatenate([values.real, values.imag], axis=-1)


def tilted(law: Any, m: tuple[float, float]) -> Any:
    """Return the law with the tilt of the housing that is equivalent to m [m] in first order."""
    names = ("housing_tilt_x", "housing_tilt_y")
    straight = law.replace(housing_eccentricity=0.0, **dict.fromkeys(names, 0.0))
    ways = np.array([straight.replace(**{name: SMALL_TILT}).eccentricity for name in names]).T / SMALL_TILT
    angles = np.linalg.solve(ways, np.array(m))
    return straight.replace(**dict(zip(names, angles.tolist(), strict=True)))


def _spread(values: Complex) -> Array:
    """Return the standard deviation of the real and of the imaginary part, taken together, of each column."""
    return np.asarray(np.std(values, axis=0, ddof=1) / np.sqrt(2.0), dtype=float)


def _detected(seen: Seen) -> bool:
    """Return True if noise alone makes order lines as large with a probability below `FALSE_ALARM`."""
    from scipy.stats import f

    each = np.abs(seen.at) ** 2 / (2.0 * seen.noise**2)
    return bool(each.max() > f.isf(FALSE_ALARM / len(ORDERS), 2, seen.degrees))


def _sensitivity(masked: Seen, gains: Complex, parts: CurrentPerError, error: float) -> Sensitivity:
    place = ORDERS.index(REFERENCE_ORDER)
    current = error * float(np.abs(gains[:, place].mean()))
    resolved = least_amplitude() * float(masked.noise[place])
    per_torque = error * abs(complex(parts.per_torque[place]))
    return Sensitivity(error, REFERENCE_ORDER, current, resolved, parts.torque, resolved / per_torque)


def least_amplitude() -> float:
    """Return the amplitude that is detected with probability `DETECTION`, in standard deviations of an order line.

    The size of a line of noise is that of Rayleigh, with a signal that of Rice.

    >>> round(least_amplitude(), 2)
    4.88
    """
    from scipy.optimize import brentq
    from scipy.stats import ncx2

    threshold = -2.0 * np.log(FALSE_ALARM)
    return float(brentq(lambda amplitude: ncx2.sf(threshold, 2, amplitude**2) - DETECTION, 0.1, 20.0))


def _doubts(off: Array) -> list[str]:
    names = ("mean", "slope over the angle", "curvature over the angle")
    far = [f"{name} by {size:.1f}" for name, size in zip(names, off, strict=True) if abs(size) > MAX_TREND_SIGMA]
    if not far:
        return []
    return [
        f"The current contradicts the drives of this set: {listed(far)} standard deviations from theirs. The interval does not "
        "count; check load, friction and torque constant first"
    ]


def _doubts_of_fit(estimate: Recovered) -> list[str]:
    if estimate.misfit < MAX_MISFIT:
        return []
    return [
        "The orders 1 to 4 do not have the ratios of a misalignment: the mean square of their residual is "
        f"{estimate.misfit:.3g} times that of noise and model. Errors of teeth, a ripple of friction or of the motor, or an e2 "
        "beside m explain such orders"
    ]


def _lines(run: Recording) -> Complex:
    found = order_amplitudes(run, "current", ORDERS)
    values: Complex = found.amplitude * np.exp(1j * found.phase)
    return values
