"""Modes of a gear in measured orders over the speed: frequency, damping and waves, as far as orders determine them."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from math import isfinite, nan, tau
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike, NDArray

from strainwave import arguments
from strainwave.drawing import marks
from strainwave.drawing.style import LIGHT
from strainwave.equality import ComparedByFields
from strainwave.files.recording import Recording, check_recording
from strainwave.messages import listed
from strainwave.orders.bearing_candidates import BearingCandidates, bearing_candidates
from strainwave.orders.mode_fit import Fitted, Line, ModeProblem, selected
from strainwave.orders.orders_over_speed import (
    MAX_FOLLOWED,
    MAX_TURNS,
    OrdersOverSpeed,
    orders_over_speed,
    turning_one_way,
    uneven_orders,
    whole_orders,
)
from strainwave.orders.turning import reach_of, smooth_speed
from strainwave.presentation import Pictured, Row
from strainwave.typeset import number, uncertain

if TYPE_CHECKING:
    from matplotlib.figure import Figure

Array = NDArray[np.float64]
Complex = NDArray[np.complex128]

STANDING_COLUMNS = ("vibration", "acceleration")  # of sensors that do not go round with the lobes
MIN_STRETCHES = 12  # amplitudes of an order, for a peak of three unknowns and what passes by
MIN_SPEED_RATIO = 1.3  # of the fastest to the slowest speed, from which orders pass a range of frequencies
MIN_ONE_WAY_SHARE = 0.95  # of the samples of a run-up
MIN_TURNS_IN_ALL = 60.0  # of the shaft, from which modes are looked for unasked
PASSED_WIDTHS = 2.0  # half-power half widths on each side, that an order must pass
MIN_STRETCHES_IN_PEAK = 4  # within that reach, of all orders that pass the mode
MIN_SIGNIFICANCE_OF_ORDER = 10.0  # standard deviations of a coefficient, from which an order counts as passing a mode
SIDEBAND_WIDTHS = 3.0  # half widths of a peak, within which another order's peak lies at the same speed
MAX_SPLIT = 0.02  # of the frequency, between both lines of a ring that the lobes hold in part
MAX_FROM_WHOLE_WAVES = 0.08  # of a slope, with twice its standard deviation, to be that of a whole number of waves
MAX_ODDS = 10.0  # by which one number of waves must be more probable than each other
MAX_CANDIDATE_WAVES = 6
MAX_DAMPING_SIGMA = 0.5  # of the damping, over which it is not stated
MIN_DAMPING_SIGMA = 0.06  # of the damping: forces are not quite constant along a peak (measured on rings by finite elements)
MIN_DAMPING_SIGMA_OF_RUN_UP = 0.12  # of the damping, if the speed changes in a peak
MIN_ORDER_RATIO = 1.25  # of two orders that determine waves: peaks of closer ones fit several whole slopes
MIN_WIDTH_SIGMA = 0.05  # of the half width of a peak, in its frequency, for the same reason (assumed)
MIN_FREQUENCY_SIGMA = 2e-4  # of the frequency: clocks and speeds are not better
BALL_HARMONICS = (1, 2, 3, 4)  # of an order that is no whole one: a whole order beside them may be of the balls, too
BALL_SIDEBANDS = (-3, -1, 0, 1, 3)
MAX_BESIDE = 3  # orders that are no whole ones, fitted beside those that are followed
MAX_UNEVEN = 8  # orders that are no whole ones, for which a bearing is looked for
FIGURE_HEIGHT = 1.7  # inches of an order
MAX_DRAWN_ORDERS = 6


@dataclass(frozen=True)
class ModeCandidate:
    """A number of waves that a mode may have.

    Attributes:
        waves: of its shape [1]
        natural_frequency: with so many waves [rad/s]
        natural_frequency_sigma: its standard deviation [rad/s]
        critical_speeds: order and speed [rad/s] of each peak of an order that was followed
    """

    waves: int
    natural_frequency: float
    natural_frequency_sigma: float
    critical_speeds: tuple[tuple[float, float], ...]


@dataclass(frozen=True)
class RingMode:
    """A mode that orders pass.

    Attributes:
        waves: of its shape, if it is determined; None if several are not separable
        natural_frequency: [rad/s], of a shaft at rest; nan if the candidates differ in it
        natural_frequency_sigma: its standard deviation [rad/s]
        damping: as a share of the critical one [1]; nan if it is not determined
        damping_sigma: its standard deviation [1]
        slope: of its lines over the speed [1], without sign: the waves within their uncertainty; nan if not determined
        slope_sigma: its standard deviation [1]
        orders: that pass it
        candidates: numbers of waves, the most probable first; one if each other is less probable by 10 or more
        separated_by: what would separate the candidates; empty if there is one
    """

    waves: int | None
    natural_frequency: float
    natural_frequency_sigma: float
    damping: float
    damping_sigma: float
    slope: float
    slope_sigma: float
    orders: tuple[float, ...]
    candidates: tuple[ModeCandidate, ...]
    separated_by: str = ""


@dataclass(frozen=True, eq=False)
class RingModes(ComparedByFields, Pictured):
    """Modes that explain orders over the speed.

    Attributes:
        modes: the lowest frequency first
        orders: that were followed [1]
        speed: of the shaft in each stretch [rad/s], shape (k,)
        amplitude: of the orders [unit of the column], where the angle is 0 as of a cosine, shape (orders, k)
        fitted: of the model, shape (orders, k)
        noise: standard deviation of the amplitude of a stretch, shape (orders,)
        column: in which orders were followed
        unit: of the amplitudes
        bearing: balls that explain the orders that are no whole ones; None without such orders
        remarks: what is not determined, and why
    """

    modes: tuple[RingMode, ...]
    orders: tuple[float, ...]
    speed: Array
    amplitude: Complex
    fitted: Complex
    noise: Array
    column: str
    unit: str
    bearing: BearingCandidates | None
    remarks: tuple[str, ...]

    def _headline(self) -> str:
        low, high = (number(float(end) * 30.0 / np.pi, 4) for end in (self.speed.min(), self.speed.max()))
        found = f"{len(self.modes)} mode{'s' * (len(self.modes) != 1)}" if self.modes else "no mode"
        orders = f"orders {listed([number(q, 5) for q in self.orders])}" if self.orders else "no order"
        return f"{found} in {self.column.replace('_', ' ')}, {orders}, {low} to {high} 1/min"

    def _rows(self) -> Iterator[Row]:
        for place, mode in enumerate(self.modes, 1):
            yield Row(f"mode {place}", words_of(mode))
        for order, amplitude in zip(self.orders, np.abs(self.amplitude), strict=True):
            at = int(np.nanargmax(amplitude))
            where = f"largest at {number(float(self.speed[at]) * 30.0 / np.pi, 4)} 1/min"
            yield Row(f"order {number(order, 5)}", float(amplitude[at]), self.unit, note=where)
        if self.bearing is not None:
            yield Row("bearing", self.bearing._headline())

    def plot(self) -> Figure:
        """Return a figure of the amplitude of each order over the speed, with the model and the critical speeds."""
        return modes_figure(self)


def ring_modes(
    recordings: Recording | Sequence[Recording],
    column: str,
    *,
    angle: str = "input_angle",
    orders: ArrayLike | None = None,
) -> RingModes:
    """Return the modes, and the balls of a bearing, that explain the orders of a column over the speed.

    A mode of the ring with n waves is passed by order q of the wave generator at the speeds |q + n| Ω = ω and |q - n| Ω = ω,
    a mode that does not travel at q Ω = ω. So two orders that pass it separate frequency and waves; one order leaves several
    numbers of waves, each with its frequency. A sensor that stands, as an accelerometer, does not determine the waves.

    Args:
        recordings: one run-up or run-down, or several recordings, of which each may be at constant speed; with `time`, the
            angle and the column. The angle has the same zero in all of them, since phases are compared
        column: `output_angle` (the ratio need not be known), a torque, a current, or `vibration`
        angle: column of the angle of the wave generator
        orders: of the wave generator to follow [1], shape (n,); by default the ten strongest ones that stand out

    Returns:
        Modes with standard deviations that allow for correlated residuals. A mode is stated only if an order passes it from
        below to above, and if the amplitudes are more probable with it by a factor of 20 000.

    Raises:
        TypeError: an argument is not of its kind
        ValueError: a column or the time is missing, the shaft does not turn, or the speeds are too few or too close

    Valid if forces depend on the angle and, at most, on the speed squared, as does what passes by the modes; friction that
    changes an order along the speed otherwise is no part of the model.

    >>> import strainwave as sw
    >>> time = np.arange(0.0, 60.0, 2e-3)
    >>> speed = 20.0 + 2.5 * time
    >>> theta = 20.0 * time + 1.25 * time**2
    >>> def answer(passes, natural=500.0, damping=0.03):
    ...     ratio = passes * speed / natural
    ...     return 1.0 / (1.0 - ratio**2 + 2j * damping * ratio)
    >>> error = sum(np.real(1e-5 * (answer(q + 2) + answer(q - 2)) * np.exp(1j * q * theta)) for q in (2, 4))
    >>> noise = np.random.default_rng(1).normal(0.0, 1e-6, len(time))
    >>> columns = {"time": time, "input_angle": theta, "output_angle": theta / 100.0 + error + noise}
    >>> run_up = sw.Recording(columns, {"time": "s", "input_angle": "rad", "output_angle": "rad"})
    >>> found = sw.orders.ring_modes(run_up, "output_angle")
    >>> [(mode.waves, round(mode.natural_frequency, -1)) for mode in found.modes]
    [(2, 500.0)]
    """
    given = [recordings] if isinstance(recordings, Recording) else list(recordings)
    if not given:
        raise ValueError("recordings has none; give one run-up, or several at constant speeds")
    for recording in given:
        check_recording("recordings", recording)
    turning = [turning_one_way(each, arguments.text("column", column), arguments.text("angle", angle)) for each in given]
    uneven = uneven_orders(turning)[:MAX_UNEVEN] if orders is None else []
    if orders is None:
        near_balls = [h * line.order + m for line in uneven for h in BALL_HARMONICS for m in BALL_SIDEBANDS]
        whole = [line.order for line in whole_orders(turning)]
        followed = [order for order in whole if all(abs(order - other) > 1.0 / MAX_TURNS for other in near_balls)][
            :MAX_FOLLOWED
        ]
    else:
        followed = arguments.positive_series("orders", orders).tolist()
    spectrum = orders_over_speed(turning, followed, [line.order for line in uneven][:MAX_BESIDE])
    remarks = list(dict.fromkeys([*(remark for each in turning for remark in each.remarks), *spectrum.remarks]))
    bearing = bearing_candidates([line.order for line in uneven], [line.sigma for line in uneven]) if uneven else None
    problem = ModeProblem(spectrum, column in STANDING_COLUMNS)
    modes: tuple[RingMode, ...] = ()
    if why := _too_little(spectrum):
        fit = problem.fit((), problem.scale, np.ones(len(spectrum.orders))) if len(spectrum.orders) else None
        remarks.append(why)
    else:
        choice = selected(problem)
        fit = choice.best
        modes, more = _stated(problem, fit, choice.others)
        remarks += more
    return RingModes(
        modes,
        tuple(spectrum.orders.tolist()),
        spectrum.speed,
        spectrum.amplitude,
        spectrum.amplitude if fit is None else fit.amplitude,
        np.zeros(0) if fit is None else fit.noise,
        column,
        given[0].unit(column),
        bearing,
        tuple(remarks),
    )


def passes_frequencies(recordings: Sequence[Recording], angle: str) -> bool:
    """Return True if the shaft turns one way, far enough and at speeds that differ enough, for orders to pass a mode."""
    turns, speeds = 0.0, list[float]()
    for recording in recordings:
        turned, time = np.unwrap(recording.values(angle, "rad")), recording.time
        speed = smooth_speed(turned, reach_of(len(turned))) / max(float(np.median(np.diff(time))), 1e-300)
        if np.mean(np.sign(speed) == np.sign(speed[len(speed) // 2])) < MIN_ONE_WAY_SHARE:
            return False
        turns += float(np.ptp(turned)) / tau
        speeds += [float(each) for each in np.quantile(np.abs(speed), [0.05, 0.95])]
    return turns > MIN_TURNS_IN_ALL and max(speeds) > MIN_SPEED_RATIO * max(min(speeds), 1e-300)


def _too_little(spectrum: OrdersOverSpeed) -> str:
    """Return why amplitudes over the speed determine no mode; empty if they may."""
    if not len(spectrum.orders):
        return "no order stands out, so no mode is looked for"
    if len(spectrum.speed) < MIN_STRETCHES:
        needed = f"{MIN_STRETCHES} are needed; run up slower, or record more speeds"
        return f"{len(spectrum.speed)} stretches determine no mode: {needed}"
    if spectrum.speed.max() < MIN_SPEED_RATIO * spectrum.speed.min():
        return "the speed varies too little for orders to pass a mode; run up further"
    return ""


# ---- What is stated --------------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class _Passing:
    """A line of a fit that orders pass, with its standard deviations."""

    line: Line
    sigma: Array
    peaks: tuple[tuple[float, float], ...]
    rivals: tuple[Line, ...]

    @property
    def orders(self) -> tuple[float, ...]:
        """Orders that pass it."""
        return tuple(sorted({order for order, _ in self.peaks}))


def _stated(
    problem: ModeProblem, fit: Fitted, others: Sequence[Sequence[tuple[float, Line]]]
) -> tuple[tuple[RingMode, ...], list[str]]:
    """Return the modes of lines that orders pass, and remarks on those that they do not pass."""
    passings, remarks, beyond = list[_Passing](), list[str](), set[float]()
    for place, line in enumerate(fit.lines):
        met = [(q, _peak(line, q, of)) for of in (0, 1) for q in problem.spectrum.orders[line.acts[:, of]].tolist()]
        speed = problem.spectrum.speed
        passed = tuple((q, peak) for q, peak in met if _passes(speed, peak, line.damping))
        within = sum(_within(speed, peak, line.damping) for _, peak in passed)
        strong = _strong(problem, fit, place)
        passed = tuple((q, peak) for q, peak in passed if q in strong)
        if within < MIN_STRETCHES_IN_PEAK or not passed:
            beyond.update(q for q, _ in met)
            continue
        sigma = np.sqrt(np.diag(fit.covariance)[3 * place : 3 * place + 3])
        near = tuple(rival for lag, rival in others[place] if lag < np.log(MAX_ODDS))
        passings.append(_Passing(line, sigma, passed, near))
    if beyond:
        remarks.append(
            f"order{'s' * (len(beyond) > 1)} {listed([number(q, 5) for q in sorted(beyond)])} may come near a peak that is not "
            "passed from below to above: no mode is stated by it; run further"
        )
    modes = []
    for passing in passings:
        mode = None if _is_sideband(passing, passings) else _mode(problem, passing)
        if mode is None:
            at = listed([f"{number(q, 5)} at {number(peak * 30.0 / np.pi, 4)} 1/min" for q, peak in passing.peaks])
            remarks.append(f"a peak of order {at} is that of no mode that is determined")
        else:
            modes.append(mode)
    return tuple(sorted(_joined(modes), key=lambda mode: mode.candidates[0].natural_frequency)), remarks


def _is_sideband(passing: _Passing, passings: Sequence[_Passing]) -> bool:
    """Return True if one order alone has a peak, at a speed at which another order has one of another mode."""
    if len(passing.orders) > 1:
        return False
    reach = SIDEBAND_WIDTHS * passing.line.damping
    return any(
        abs(at / peak - 1.0) < reach + SIDEBAND_WIDTHS * other.line.damping
        for other in passings
        if other is not passing
        for _, at in other.peaks
        for _, peak in passing.peaks
    )


def _joined(modes: Sequence[RingMode]) -> list[RingMode]:
    """Return modes, those of nearly one frequency and the same waves as one whose uncertainty contains both."""
    kept = list[RingMode]()
    for mode in modes:
        twin = next((k for k, other in enumerate(kept) if _are_one(mode, other)), None)
        if twin is None:
            kept.append(mode)
        else:
            other = kept[twin]
            middle = 0.5 * (mode.natural_frequency + other.natural_frequency)
            apart = abs(mode.natural_frequency - other.natural_frequency)
            sigma = max(apart, mode.natural_frequency_sigma, other.natural_frequency_sigma)
            damping = 0.5 * (mode.damping + other.damping)
            damping_sigma = max(abs(mode.damping - other.damping), mode.damping_sigma, other.damping_sigma)
            candidate = replace(mode.candidates[0], natural_frequency=middle, natural_frequency_sigma=sigma)
            kept[twin] = replace(
                other, natural_frequency=middle, natural_frequency_sigma=sigma, damping=damping, damping_sigma=damping_sigma,
                orders=tuple(sorted({*mode.orders, *other.orders})), candidates=(candidate,),
            )  # fmt: skip
    return kept


def _are_one(mode: RingMode, other: RingMode) -> bool:
    """Return True for the same waves and nearly one frequency: a ring that the lobes hold in part has two such lines."""
    apart = abs(mode.natural_frequency / other.natural_frequency - 1.0)
    return bool(mode.waves is not None and mode.waves == other.waves and apart < MAX_SPLIT)


def _peak(line: Line, order: float, of: int) -> float:
    """Return the speed at which an order meets the first or second line of a mode [rad/s]; infinite if it never does."""
    gap = abs(order - (-line.slope if of else line.slope))
    return line.frequency / gap if gap > 0.0 else np.inf


def _passes(speed: Array, peak: float, damping: float) -> bool:
    """Return True if the speeds pass a peak from below to above, with one in it."""
    if not isfinite(peak):
        return False
    reach = PASSED_WIDTHS * damping
    return bool(speed.min() < peak * (1.0 - reach) and peak * (1.0 + reach) < speed.max() and _within(speed, peak, damping))


def _within(speed: Array, peak: float, damping: float) -> int:
    return int((np.abs(speed / peak - 1.0) < PASSED_WIDTHS * damping).sum())


def _strong(problem: ModeProblem, fit: Fitted, place: int) -> set[float]:
    """Return the orders with a coefficient of a mode that is significant by itself."""
    acts = fit.lines[place].acts
    size = np.where(acts, np.abs(fit.parts[:, place]) / np.maximum(fit.parts_sigma[:, place], 1e-300), 0.0)
    return set(problem.spectrum.orders[(size > MIN_SIGNIFICANCE_OF_ORDER).any(axis=1)].tolist())


def _mode(problem: ModeProblem, passing: _Passing) -> RingMode | None:
    """Return a mode as far as it is determined; None if its frequency is not."""
    line, sigma = passing.line, passing.sigma
    least = MIN_DAMPING_SIGMA_OF_RUN_UP if problem.varying else MIN_DAMPING_SIGMA
    damping, spread = line.damping, float(np.hypot(sigma[1], least))
    if not spread < MAX_DAMPING_SIGMA:
        damping = nan
    frequency_sigma = float(np.sqrt(sigma[0] ** 2 + MIN_FREQUENCY_SIGMA**2 + (MIN_WIDTH_SIGMA * line.damping) ** 2))
    slope, slope_sigma = abs(line.slope), float(sigma[2])
    whole = round(slope)
    from_whole = abs(slope - whole) + 2.0 * slope_sigma
    uncertainty = line.frequency * frequency_sigma
    candidate = _candidate(problem, 0 if problem.stands else whole, line.frequency, uncertainty)
    mode = RingMode(
        None, line.frequency, uncertainty, damping, damping * spread, nan, nan, passing.orders, (candidate,)
    )  # fmt: skip
    if problem.stands:
        why = "a sensor that stands sees each order at ω over its own order, whatever the waves: compare with an encoder"
        return replace(mode, separated_by=why)
    if len(passing.orders) > 1:
        apart = max(passing.orders) > MIN_ORDER_RATIO * min(passing.orders)
        is_whole = from_whole < MAX_FROM_WHOLE_WAVES and not passing.rivals and apart
        return replace(mode, waves=whole, slope=slope, slope_sigma=slope_sigma) if is_whole else None
    candidates = _candidates(problem, passing)  # the shape of one order's peak is no evidence of a slope
    if len(candidates) < 2 or problem.varying > 1:  # where ramps meet, an order against the other spline may leave a peak
        return None
    why = _separated_by(problem, passing, candidates)
    return replace(mode, natural_frequency=nan, natural_frequency_sigma=nan, candidates=candidates, separated_by=why)


def _candidate(problem: ModeProblem, waves: int, frequency: float, sigma: float) -> ModeCandidate:
    speeds = []
    for order in problem.spectrum.orders.tolist():
        gaps = {abs(order + waves), abs(order - waves)} - {0.0}
        speeds += [(order, frequency / gap) for gap in sorted(gaps)]
    return ModeCandidate(waves, frequency, sigma, tuple(speeds))


def _candidates(problem: ModeProblem, passing: _Passing) -> tuple[ModeCandidate, ...]:
    """Return the numbers of waves that the peak of one order leaves, each with the frequency at which it lies there."""
    line, sigma = passing.line, max(float(passing.sigma[0]), MIN_FREQUENCY_SIGMA)
    left: dict[int, tuple[float, float]] = {}
    for order, peak in passing.peaks:
        for slope in sorted(range(-MAX_CANDIDATE_WAVES, MAX_CANDIDATE_WAVES + 1), key=abs):
            gap = abs(order - slope)
            if gap < 0.5:
                continue
            frequency = gap * peak
            other = frequency / abs(order + slope) if abs(order + slope) > 0.0 else np.inf
            seen = any(abs(at / other - 1.0) < 3.0 * line.damping for _, at in passing.peaks)
            if slope == 0 or seen or not _passes(problem.spectrum.speed, other, line.damping):
                left.setdefault(abs(slope), (frequency, frequency * sigma))
    return tuple(_candidate(problem, waves, *of) for waves, of in left.items())


def _separated_by(problem: ModeProblem, passing: _Passing, candidates: Sequence[ModeCandidate]) -> str:
    """Return which run would separate candidates, in words."""
    top = float(problem.spectrum.speed.max())
    beyond = [
        (speed, order, each.waves)
        for each in candidates
        for order, speed in each.critical_speeds
        if speed > top and isfinite(speed) and order in passing.orders
    ]
    seen = listed([number(q, 5) for q in passing.orders])
    which = " or ".join(str(each.waves) for each in candidates)
    by = f"order {seen} alone passes it"
    text = f"waves {which} are not separable: {by}"
    if not beyond:
        return f"{text}; excite another order"
    speed, order, waves = min(beyond)
    run = f"run to {number(speed * 30.0 / np.pi * 1.05, 3)} 1/min"
    return f"{text}: {run}, where order {number(order, 5)} peaks with waves {waves} only"


def words_of(mode: RingMode) -> str:
    """Return a mode in words."""
    damping = (
        f", damping ratio {uncertain(mode.damping, mode.damping_sigma)}"
        if isfinite(mode.damping)
        else ", damping not determined"
    )
    passed = f"; passed by order{'s' * (len(mode.orders) > 1)} {listed([number(q, 5) for q in mode.orders])}"
    if isfinite(mode.natural_frequency):
        frequency = f"{uncertain(mode.natural_frequency / tau, mode.natural_frequency_sigma / tau)} Hz"
        waves = "" if mode.waves is None else f", waves {mode.waves}" + (" (does not travel)" if mode.waves == 0 else "")
    else:
        each = [f"{number(c.natural_frequency / tau, 4)} Hz with waves {c.waves}" for c in mode.candidates]
        frequency, waves = " or ".join(each), ""
    return f"{frequency}{waves}{damping}{passed}" + (f"; {mode.separated_by}" if mode.separated_by else "")


# ---- Picture ---------------------------------------------------------------------------------------------------------


def modes_figure(modes: RingModes) -> Figure:
    """Return the figure of a `RingModes`, as its `plot` describes it."""
    if not modes.orders:
        raise ValueError("no order was followed")
    with marks.new_figure(0.8 + FIGURE_HEIGHT * min(len(modes.orders), MAX_DRAWN_ORDERS), "Orders over the speed") as figure:
        draw_modes(figure, modes)
    return figure


def draw_modes(figure: Figure, modes: RingModes) -> None:
    """Draw the amplitude of each order over the speed, with the model and the critical speeds."""
    size = np.nanmax(np.abs(modes.amplitude), axis=1)
    drawn = sorted(np.argsort(-size)[:MAX_DRAWN_ORDERS].tolist(), key=lambda k: modes.orders[k])
    place = np.argsort(modes.speed, kind="stable")
    rpm = modes.speed[place] * 30.0 / np.pi
    panels = figure.subplots(len(drawn), 1, sharex=True, squeeze=False)[:, 0]
    for axes, k in zip(panels, drawn, strict=True):
        axes.plot(rpm, np.abs(modes.amplitude[k, place]), ".", color=LIGHT["measured"], markersize=3.0, label="measured")
        marks.curve(axes, rpm, np.abs(modes.fitted[k, place]), color=LIGHT["model"], linewidth=1.0, label="model")
        critical = [
            speed * 30.0 / np.pi
            for mode in modes.modes
            for order, speed in mode.candidates[0].critical_speeds
            if order == modes.orders[k]
        ]
        for speed in critical:
            if rpm[0] < speed < rpm[-1]:
                axes.axvline(speed, color=LIGHT["muted"], linestyle="--", linewidth=0.8)
        axes.set_ylim(bottom=0.0)
        marks.label_axes(axes, f"order {number(modes.orders[k], 5)}", modes.unit)
    marks.label_abscissa(panels[-1], "speed [1/min]", "1")
    marks.legend(figure, panels[0])
