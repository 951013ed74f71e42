r"""Modes of a gear in measured orders over the speed: lines through the peaks of orders, as far as these determine them.

Order q of the shaft has the frequency :math:`q \Omega`. A mode is a line over the speed in this plane (Campbell's diagram),

.. math:: q_i \Omega_i = \omega + s\, \Omega_i

with a point at each peak i of an order. A mode that stands against the lobes of the wave generator has the slope s = 0, one
with n waves that goes round freely has s = n and s = -n; lobes that hold it in part make slopes between. Two peaks determine a
line, and a third one shows whether it is one. The slope is stated as waves if it is a whole number. A peak on no line is not
stated: its order alone does not show whether it is that of one mode, of two, or of an order close by.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import combinations
from math import comb, isnan, nan, tau
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike, NDArray

from strainwave import arguments
from strainwave.drawing import marks
from strainwave.drawing.simple import Series
from strainwave.equality import ComparedByFields
from strainwave.files.recording import Recording
from strainwave.messages import listed, named
from strainwave.orders.bearing_candidates import BearingCandidates, bearing_candidates
from strainwave.orders.order_peaks import OrderPeak, peaks_of
from strainwave.orders.orders_over_speed import (
    OrderLine,
    OrdersOverSpeed,
    orders_over_speed,
    turning_of,
    uneven_orders,
    whole_orders,
)
from strainwave.orders.tracked_orders import PANEL_HEIGHT, OrderTracks, draw_orders
from strainwave.orders.turning import reach_of, smooth_speed
from strainwave.presentation import Pictured, Row
from strainwave.typeset import number, uncertain

if TYPE_CHECKING:
    from matplotlib.figure import Figure

Array = NDArray[np.float64]
Complex = NDArray[np.complex128]

STANDING_COLUMNS = ("vibration", "acceleration")  # of sensors that do not go round with the lobes
MAX_WHOLE, MAX_UNEVEN = 8, 5  # orders that are followed if none are named
MAX_BESIDE = 12  # orders that are none, those followed and those fitted beside them
LEAKING_SHARE = 0.2  # of the height of a peak, below which that of another order at the same speed may be its leakage
MIN_APART = 0.6  # of a whole order from one that is none, which a short stretch does not separate
MIN_STRETCHES = 12  # amplitudes of an order, for a peak and what passes by
MIN_ONE_WAY_SHARE = 0.95  # of the samples of a run-up
MIN_TURNS_IN_ALL = 60.0  # of the shaft, from which modes are looked for unasked
MIN_SPEED_RATIO = 1.3  # of the fastest to the slowest speed, from which orders pass a range of frequencies
MAX_SIGMAS = 2.5  # standard deviations between a peak and a line, and between dampings of one mode
MAX_SLOPE = 6.5  # of a line: waves of a ring beyond six have no amplitude at the mesh
MAX_FROM_WHOLE = 0.25  # of a slope, with twice its standard deviation, to be a whole number of waves
MAX_CHANCE = 0.05  # probability that peaks of different modes lie on such a line
MAX_BEND = 5e-4  # of the frequency, by which lines are not straight (assumed)
MIN_BREADTH = 0.03  # share of the speed by which the peaks of a line must differ
MIN_DAMPING_SIGMA = 0.01  # of the damping: forces are not quite constant along a peak (assumed)


@dataclass(frozen=True)
class RingMode:
    """A mode that orders meet: a line through their peaks.

    Attributes:
        frequency: where the line meets the speed 0 [rad/s]. It is the natural frequency of the gear at rest if the line is
            straight; lobes that hold a ring in part bend it
        frequency_sigma: its standard deviation [rad/s]
        slope: of the line, of frequency over speed [1], without sign; nan by a sensor that stands
        slope_sigma: its standard deviation [1]
        waves: the slope as a whole number; None if it is none, or by a sensor that stands
        damping: as a share of the critical one [1]
        damping_sigma: its standard deviation [1]
        peaks: of the orders that meet it
    """

    frequency: float
    frequency_sigma: float
    slope: float
    slope_sigma: float
    waves: int | None
    damping: float
    damping_sigma: float
    peaks: tuple[OrderPeak, ...]

    @property
    def orders(self) -> tuple[float, ...]:
        """Orders that meet it."""
        return tuple(sorted({peak.order for peak in self.peaks}))


@dataclass(frozen=True, eq=False)
class RingModes(ComparedByFields, Pictured):
    """Modes that several orders pass over the speed.

    Attributes:
        modes: the lowest frequency first
        orders: that were followed [1]
        speed: of the shaft in each stretch [rad/s], shape (k,)
        amplitude: of the orders [unit of the column], where the angle is 0 as of a cosine, shape (orders, k)
        fitted: of the peaks and what passes by, shape (orders, k)
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
    column: str
    unit: str
    bearing: BearingCandidates | None
    remarks: tuple[str, ...]

    def _headline(self) -> str:
        low, high = (number(float(end) * 30.0 / np.pi, 4) for end in (self.speed.min(), self.speed.max()))
        found = f"{len(self.modes)} mode{'s' * (len(self.modes) != 1)}" if self.modes else "no mode"
        return f"{found} in {self.column.replace('_', ' ')}, {low} to {high} 1/min"

    def _rows(self) -> Iterator[Row]:
        yield Row("orders followed", listed([number(q, 5) for q in self.orders]) or "none")
        for place, mode in enumerate(self.modes, 1):
            yield Row(f"mode {place}", words_of(mode))
        if self.bearing is not None:
            yield Row("bearing", self.bearing._headline())

    def plot(self) -> Figure:
        """Return a figure of the amplitude of each order over the speed, with the model and the peaks of modes."""
        return modes_figure(self)


def ring_modes(
    recordings: Recording | Sequence[Recording],
    column: str,
    *,
    angle: str = "input_angle",
    orders: ArrayLike | None = None,
) -> RingModes:
    """Return the modes that orders of a column pass over the speed, as far as peaks of several orders determine them.

    Two orders that meet a mode determine its line: frequency and waves. With one order alone the waves, and so the frequency,
    stay open, and a remark names the order. A sensor that stands, as an accelerometer, meets each order at its own frequency,
    whatever the waves: its lines have no slope.

    Args:
        recordings: one run-up or run-down, or several recordings, of which each may be at constant speed; with `time`, the
            angle and the column. The angle has the same zero in all of them, since phases are compared
        column: `output_angle` (the ratio need not be known), a torque, a current, or `vibration`
        angle: column of the angle of the wave generator
        orders: of the wave generator to follow [1], shape (n,); by default those that stand out, the eight strongest

    Returns:
        Modes with standard deviations. A peak takes part only if the speeds pass it from well below to well above; a line of
        two peaks is stated only if its slope is a whole number more exactly than chance would have it.

    Raises:
        TypeError: an argument is not of its kind
        ValueError: a column or the time is missing, the shaft does not turn, or the speeds are too few or too close

    Valid if what passes by a mode is smooth over the speed, and the speed changes slowly: a peak that is passed too fast is not
    stated, with a remark.

    >>> import numpy as np
    >>> import strainwave as sw
    >>> angle = np.linspace(0.0, 16.0 * np.pi, 400)
    >>> def receptance(frequency, natural=500.0, damping=0.03):
    ...     return 1.0 / (1.0 - (frequency / natural) ** 2 + 2j * damping * frequency / natural)
    >>> def at(speed):  # orders 3 and 4 of a mode with 2 waves
    ...     waves = (receptance((q + n) * speed) * np.exp(1j * q * angle) for q in (3, 4) for n in (2, -2))
    ...     columns = {"time": angle / speed, "input_angle": angle, "output_angle": angle / 100.0 + 1e-5 * np.real(sum(waves))}
    ...     return sw.Recording(columns, {"time": "s", "input_angle": "rad", "output_angle": "rad"})
    >>> found = sw.orders.ring_modes([at(speed) for speed in np.linspace(40.0, 330.0, 60)], "output_angle", orders=[3, 4])
    >>> [(mode.waves, round(mode.frequency), len(mode.peaks)) for mode in found.modes]
    [(2, 500, 3)]
    """
    turning, unit = turning_of(recordings, column, angle)
    uneven = uneven_orders(turning) if orders is None else []
    if orders is None:
        whole = [
            each.order for each in whole_orders(turning) if all(abs(each.order - line.order) > MIN_APART for line in uneven)
        ]
        followed = [*whole[:MAX_WHOLE], *(line.order for line in uneven[:MAX_UNEVEN])]
    else:
        followed = arguments.positive_series("orders", orders).tolist()
    spectrum = orders_over_speed(turning, followed, [line.order for line in uneven[MAX_UNEVEN:MAX_BESIDE]])
    remarks = [*(remark for each in turning for remark in each.remarks), *spectrum.remarks]
    peaks, curves, more = list[OrderPeak](), spectrum.amplitude, [_too_little(spectrum)]
    if not any(more):
        peaks, curves, more = _peaks(spectrum, {line.order: line.sigma for line in uneven})
    modes = modes_of_peaks(peaks, float(np.ptp(spectrum.speed)) if len(spectrum.speed) else 0.0, column in STANDING_COLUMNS)
    return RingModes(
        modes,
        tuple(spectrum.orders.tolist()),
        spectrum.speed,
        spectrum.amplitude,
        curves,
        column,
        unit,
        _bearing(uneven, float(np.median([each.per_input for each in turning]))) if uneven else None,
        tuple(dict.fromkeys(each for each in (*remarks, *more, *_alone(peaks, modes)) if each)),
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


def _bearing(uneven: Sequence[OrderLine], per_input: float) -> BearingCandidates:
    """Return the bearings that explain orders, whose outer ring stands or turns back with the output."""
    orders, sigmas = [line.order for line in uneven], [line.sigma for line in uneven]
    stands = bearing_candidates(orders, sigmas)
    if not per_input:
        return stands
    turns = bearing_candidates(orders, sigmas, outer_speed=-per_input)
    counts = {stands.balls, turns.balls}
    balls = counts.pop() if len(counts) == 1 else None
    remarks = tuple(dict.fromkeys((*stands.remarks, *turns.remarks)))
    chance = max(stands.chance, turns.chance)
    return replace(stands, candidates=(*stands.candidates, *turns.candidates), balls=balls, chance=chance, remarks=remarks)


def _too_little(spectrum: OrdersOverSpeed) -> str:
    """Return why amplitudes over the speed determine no peak; empty if they may."""
    if not len(spectrum.orders):
        return "no order stands out, so no mode is looked for"
    if len(spectrum.speed) < MIN_STRETCHES:
        few = f"{len(spectrum.speed)} stretches determine no mode: {MIN_STRETCHES} are needed"
        return f"{few}; run up slower, or record more speeds"
    if spectrum.speed.max() < MIN_SPEED_RATIO * spectrum.speed.min():
        return "the speed varies too little for orders to pass a mode; run up further"
    return ""


def _peaks(spectrum: OrdersOverSpeed, sigmas: dict[float, float]) -> tuple[list[OrderPeak], Complex, list[str]]:
    """Return the peaks of all orders, the curves of the fits, and remarks; `sigmas` are of orders that are no whole ones."""
    peaks, remarks = list[OrderPeak](), list[str]()
    curves = np.full(spectrum.amplitude.shape, complex("nan"))
    for place, order in enumerate(spectrum.orders.tolist()):
        found, curves[place], more = peaks_of(spectrum, place)
        peaks += [replace(each, order_sigma=sigmas.get(order, 0.0)) for each in found]
        remarks += more
    return [peak for peak in peaks if not any(_leaks(other, peak) for other in peaks)], curves, remarks


def _leaks(strong: OrderPeak, weak: OrderPeak) -> bool:
    """Return True if a peak may be that of another order at the same speed, which stretches do not quite separate."""
    apart = abs(strong.speed / weak.speed - 1.0)
    return weak.height < LEAKING_SHARE * strong.height and apart < strong.damping + weak.damping


# ---- Lines through peaks ---------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class _Line:
    """A line through peaks of several orders, each on its branch of the slope with this sign.

    `chance` is the probability that all peaks but the first two lie on the line of those by chance.
    """

    frequency: float
    slope: float
    covariance: Array
    peaks: tuple[OrderPeak, ...]
    chance: float = 1.0


def modes_of_peaks(peaks: Sequence[OrderPeak], speeds: float, stands: bool) -> tuple[RingMode, ...]:
    """Return the modes of lines through peaks, each peak in one: those of most peaks first, then the most exact ones.

    Args:
        peaks: of orders
        speeds: range of the speeds in which peaks were looked for [rad/s]
        stands: True by a sensor that stands
    """
    left, modes = list(peaks), list[RingMode]()
    while lines := [line for line in _lines(left, speeds, stands) if _is_stated(line, peaks, stands)]:
        best = max(lines, key=lambda line: (len(line.peaks), -line.covariance[1, 1]))
        modes.append(_mode(best, stands))
        left = [peak for peak in left if peak not in best.peaks]
    return tuple(sorted(modes, key=lambda mode: mode.frequency))


def _lines(peaks: Sequence[OrderPeak], speeds: float, stands: bool) -> Iterator[_Line]:
    """Yield the line through each two peaks of different orders that have one damping, with all peaks that lie on it."""
    for first, second in combinations(peaks, 2):
        if first.order == second.order or not _one_damping(first, second):
            continue
        for sign in (1.0,) if stands else (1.0, -1.0):
            line = _fitted([first, second], [1.0, sign], stands)
            if line is None or abs(line.slope) > MAX_SLOPE or line.frequency <= 0.0:
                continue
            on, signs, chance = [first, second], [1.0, sign], 1.0
            for peak in peaks:
                side = _side_of(line, peak)
                if peak not in on and side and all(_one_damping(peak, other) for other in (first, second)):
                    on.append(peak)
                    signs.append(side)
                    passed = peak.order * speeds  # rad/s; on either branch, above or below it
                    chance *= min(4.0 * _reach(line, peak, side) / passed, 1.0)
            whole = _fitted(on, signs, stands)
            yield replace(line if whole is None else whole, chance=chance)


def _one_damping(one: OrderPeak, other: OrderPeak) -> bool:
    sigma = np.hypot(np.hypot(one.damping_sigma, other.damping_sigma), MIN_DAMPING_SIGMA * one.damping)
    return bool(abs(one.damping - other.damping) < MAX_SIGMAS * sigma)


def _point(peak: OrderPeak, slope: float) -> tuple[float, float]:
    """Return the frequency of a peak [rad/s] and its standard deviation across a line of a slope."""
    across = np.hypot((peak.order - slope) * peak.speed_sigma, peak.order_sigma * peak.speed)
    frequency = peak.order * peak.speed
    return frequency, float(np.hypot(across, MAX_BEND * frequency))


def _side_of(line: _Line, peak: OrderPeak) -> float:
    """Return 1 or -1 if a peak lies on the branch of the slope with this sign; 0 on neither."""
    for sign in (1.0, -1.0):
        frequency = peak.order * peak.speed
        apart = abs(frequency - line.frequency - sign * line.slope * peak.speed)
        if apart < _reach(line, peak, sign) and apart < 0.01 * frequency:
            return sign
    return 0.0


def _reach(line: _Line, peak: OrderPeak, sign: float) -> float:
    """Return how far a peak may be from a branch to lie on it [rad/s]."""
    of = np.array([1.0, sign * peak.speed])
    return float(MAX_SIGMAS * np.sqrt(_point(peak, sign * line.slope)[1] ** 2 + of @ line.covariance @ of))


def _fitted(peaks: Sequence[OrderPeak], signs: Sequence[float], stands: bool) -> _Line | None:
    """Return the line of least squares through peaks; None if their speeds do not separate its two numbers."""
    slope = 0.0
    for _ in range(3):  # the deviations across depend a little on the slope
        points = [_point(peak, sign * slope) for peak, sign in zip(peaks, signs, strict=True)]
        scale = np.array([sigma for _, sigma in points])
        columns = np.stack([np.ones(len(peaks)), np.array(signs) * [peak.speed for peak in peaks]], axis=1)[
            :, : 1 if stands else 2
        ]
        if not stands and np.ptp(columns[:, 1]) < MIN_BREADTH * np.abs(columns[:, 1]).max():
            return None
        weighted = columns / scale[:, None]
        wanted = np.array([frequency for frequency, _ in points]) / scale
        values = np.linalg.lstsq(weighted, wanted, rcond=None)[0]
        left, free = wanted - weighted @ values, len(peaks) - columns.shape[1]
        slope = 0.0 if stands else float(values[1])
    covariance = np.zeros((2, 2))
    covariance[: columns.shape[1], : columns.shape[1]] = np.linalg.inv(weighted.T @ weighted)
    return _Line(float(values[0]), slope, covariance * max(1.0, float(left @ left) / max(free, 1)), tuple(peaks))


def _is_stated(line: _Line, peaks: Sequence[OrderPeak], stands: bool) -> bool:
    """Return True if peaks of different modes would not lie on such a line by chance.

    Of all pairs of peaks that have its damping, and all choices of further ones, so many lines are expected.
    """
    alike, count = sum(all(_one_damping(peak, other) for other in line.peaks[:2]) for peak in peaks), len(line.peaks)
    pairs = alike * (alike - 1) / 2
    if stands:
        sigma = float(np.sqrt(line.covariance[0, 0])) / line.frequency
        return pairs * 2.0 * MAX_SIGMAS * sigma < MAX_CHANCE
    reach = MAX_SIGMAS * float(np.sqrt(line.covariance[1, 1]))
    is_whole = abs(line.slope - round(line.slope)) < reach
    if not reach < MAX_FROM_WHOLE or not (is_whole or count > 2):
        return False
    expected = 2.0 * pairs * comb(max(alike - 2, 0), count - 2) * line.chance
    return expected * (2.0 * reach if is_whole else 1.0) < MAX_CHANCE


def _mode(line: _Line, stands: bool) -> RingMode:
    sigmas = np.sqrt(np.diag(line.covariance))
    weights = np.array([1.0 / peak.damping_sigma**2 for peak in line.peaks])
    damping = float(weights @ [peak.damping for peak in line.peaks] / weights.sum())
    slope, slope_sigma = (nan, nan) if stands else (abs(line.slope), float(sigmas[1]))
    is_whole = not stands and abs(slope - round(slope)) + 2.0 * slope_sigma < MAX_FROM_WHOLE
    waves = round(slope) if is_whole else None
    return RingMode(
        line.frequency,
        float(sigmas[0]),
        slope,
        slope_sigma,
        waves,
        damping,
        float(np.hypot(weights.sum() ** -0.5, MIN_DAMPING_SIGMA * damping)),
        line.peaks,
    )


def _alone(peaks: Sequence[OrderPeak], modes: Sequence[RingMode]) -> list[str]:
    """Return a remark on the orders with peaks through which no line is determined."""
    of_modes = [peak for mode in modes for peak in mode.peaks]
    alone = list(dict.fromkeys(number(peak.order, 5) for peak in peaks if peak not in of_modes))
    if not alone:
        return []
    return [f"{named('order', alone)} may pass a mode: no other order confirms it; record a second one that passes it"]


# ---- Words and picture -----------------------------------------------------------------------------------------------


def words_of(mode: RingMode) -> str:
    """Return a mode in words."""
    frequency = f"{uncertain(mode.frequency / tau, mode.frequency_sigma / tau)} Hz"
    if isnan(mode.slope):
        waves = ", waves not determined by a sensor that stands"
    elif mode.waves is None:
        slope = uncertain(mode.slope, mode.slope_sigma)
        waves = f", slope {slope} over the speed, no whole number of waves: the lobes hold it in part"
    else:
        waves = f", waves {mode.waves}" + (" (does not go round)" if mode.waves == 0 else "")
    orders = listed([number(order, 5) for order in mode.orders])
    return f"{frequency}{waves}, damping ratio {uncertain(mode.damping, mode.damping_sigma)}; peaks of orders {orders}"


def modes_figure(modes: RingModes) -> Figure:
    """Return the figure of a `RingModes`, as its `plot` describes it."""
    if not modes.orders:
        raise ValueError("no order was followed")
    with marks.new_figure(PANEL_HEIGHT, "Orders over the speed") as figure:
        draw_modes(figure, modes)
    return figure


def draw_modes(figure: Figure, modes: RingModes) -> None:
    """Draw the amplitude of each order over the speed, with the model and the peaks of modes."""
    along = np.argsort(modes.speed, kind="stable")
    tracks = OrderTracks(
        np.array(modes.orders), modes.speed[along], np.abs(modes.amplitude[:, along]), modes.column, modes.unit
    )
    confirmed = [peak for mode in modes.modes for peak in mode.peaks]
    peaks = [[peak.speed * 30.0 / np.pi for peak in confirmed if peak.order == order] for order in modes.orders]
    draw_orders(
        figure, tracks, Series("speed [1/min]", "1", tracks.speed * 30.0 / np.pi), peaks, np.abs(modes.fitted[:, along])
    )
