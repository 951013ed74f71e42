"""The kinematic error of a gear from two encoders: ratio, orders, lost motion, what is elastic in it.

    transmission error = input angle / ratio - output angle = kinematic error + twist

Its orders of the input are regressed together with direction, gravity, inertia and losses of the output, through the output
stage where the record shows its resonance (`stage`). No simulation is run.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from math import hypot, inf, pi, tau
from typing import TYPE_CHECKING, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from strainwave import arguments, kinematic_error, typeset
from strainwave.drawing import marks
from strainwave.drawing.style import LIGHT
from strainwave.equality import ComparedByFields
from strainwave.files.recording import Recording, check_recording
from strainwave.files.units import convert
from strainwave.messages import named
from strainwave.orders.shaft_pair import Pair, Ratio, loads_of, ratio_of, ratio_remarks
from strainwave.orders.stage import MAX_FREQUENCY, Regressed, StageProblem
from strainwave.orders.turning import Evenly, beginning, direction, evenly, reach_of, smooth_speed, unwrapped
from strainwave.presentation import Pictured, Presented, Reported, Row, counted
from strainwave.simulation.run import Run

if TYPE_CHECKING:
    from matplotlib.figure import Figure

Array = NDArray[np.float64]
Shaft = Literal["input", "mesh", "output"]

MAX_DRAWN_TURNS = 6.0  # of the input: the error of a longer record is a band of one colour
ORDERS = (1.0, 2.0, 3.0, 4.0, 6.0, 8.0)  # of the input, looked for in every record
MESH_ORDERS = (1.0, 2.0, 4.0)  # of the wave generator seen from the spline that turns: 2 z_c / z_f and its like
OUTPUT_ORDERS = (1.0, 2.0)  # of the output: eccentricity of an encoder disc, gravity
MIN_ORDER_PERIODS = 3.0  # in the record: gravity, hysteresis and drift follow one or two periods of any wave
MIN_INPUT_TURNS = 1.0  # of the input: in less, an order is not separated from the next whole one
MAX_COMPARED = 2**16  # samples that are compared; of a longer record neighbours are averaged as far as orders allow
LOAD_UNITS = {"joint_torque": "N.m", "torque": "N.m", "current": "A"}  # columns that wind the gear up, the best first
WHY_AMPLITUDES_CHANGE = "they change with the speed, as by a vibration of the output that the record does not determine"
MAX_SPEED_RATIO = 1.5  # of a fast to a slow part of the record [1], up to which its amplitudes are those of one speed
MAX_HARMONICS = 16  # of `kinematic_error.Fourier`


@dataclass(frozen=True)
class MeasuredValue(Presented):
    """Value with its standard deviation, in a unit."""

    value: float
    sigma: float
    unit: str


@dataclass(frozen=True)
class ErrorOrder(Presented):
    """Order of the transmission error.

    Attributes:
        order: periods per revolution of the input [1]
        shaft: that it repeats with: the input; the input as the spline that turns sees it (`mesh`); or the output
        amplitude: at the output [rad], corrected for the output stage if the record determines it, else as measured
        phase: at the recorded input angle 0 [rad], as of a sine
        amplitude_sigma, phase_sigma: standard deviations
        false_alarm: probability that noise alone gives as much anywhere among the orders looked for
        significant: True if that is less than allowed
    """

    order: float
    shaft: Shaft
    amplitude: float
    phase: float
    amplitude_sigma: float
    phase_sigma: float
    false_alarm: float
    significant: bool


@dataclass(frozen=True, eq=False)
class TransmissionError(ComparedByFields, Pictured, Reported):
    """Ratio, kinematic error and lost motion of a gear from two encoders.

    Attributes:
        ratio: of the angles
        orders: all that the record determines, by shaft and order
        lost_motion: of the output, between forward and backward at one place: play, hysteresis, and the wind-up by friction of
            the output; None if the shaft never turns back
        windup: twist per torque or current, if the recording has one
        natural_frequency: of the output with the input held [Hz]; None if the record does not show it, or has no time
        damping_ratio: of that vibration [1]; None likewise
        noise: root mean square of the residual of orders, load and direction [rad]
        revolutions: of the input, end to end
        curves: time, input_angle, transmission_error, kinematic_error as found, residual, as compared
        remarks: what to know of these numbers, in words
        speeds: of the input, for which alone the amplitudes are measured, in words; empty if they are corrected for the output
            stage, or its vibration does not show
        vibrates: True if the amplitudes change with these speeds, so that they are not those of the gear alone

    >>> import numpy as np
    >>> import strainwave as sw
    >>> theta = 30.0 * np.sin(np.linspace(0.0, 6.0, 1000))
    >>> output = -theta / 100.0 - 3e-4 * np.sin(2 * theta) + np.random.default_rng(1).normal(0.0, 1e-5, len(theta))
    >>> columns = {"input_angle": theta, "output_angle": output}
    >>> found = sw.transmission_error(sw.Recording(columns, {"input_angle": "rad", "output_angle": "rad"}))
    >>> found.law.order, [round(1e6 * each) for each in found.law.amplitude], round(1e6 * found.noise)  # urad at the output
    ((2.0,), [300], 9)
    """

    ratio: Ratio
    orders: tuple[ErrorOrder, ...]
    lost_motion: MeasuredValue | None
    windup: MeasuredValue | None
    natural_frequency: MeasuredValue | None
    damping_ratio: MeasuredValue | None
    noise: float
    revolutions: float
    curves: Recording
    remarks: tuple[str, ...]
    speeds: str = ""
    vibrates: bool = False

    @property
    def law(self) -> kinematic_error.Fourier:
        """Law of the significant orders of the input and of the mesh, for the input angle as it was recorded."""
        lines = [line for line in self.orders if line.significant and line.shaft != "output"]
        lines = sorted(sorted(lines, key=lambda line: -line.amplitude)[:MAX_HARMONICS], key=lambda line: line.order)
        numbers = {name: [getattr(line, name) for line in lines] for name in ("order", "amplitude", "phase")}
        return kinematic_error.Fourier(**numbers)

    def _headline(self) -> str:
        orders = counted(sum(each.significant for each in self.orders), "significant order")
        noise = typeset.quantity(self.noise, "rad")
        return f"ratio {self.ratio.used:.6g}, {orders} over {self.revolutions:.3g} revolutions, noise {noise}"

    def _rows(self) -> Iterator[Row]:
        yield Row("ratio", self.ratio.used, "1", note="used")
        yield Row("ratio of the angles", self.ratio.value, "1", self.ratio.sigma)
        for each in sorted(self.orders, key=lambda order: -order.amplitude):
            significant = "significant" if each.significant else "not significant"
            note = f"phase {typeset.number(float(np.degrees(each.phase)), 3)}°, {significant}"
            yield Row(f"order {each.order:.5g} of the {each.shaft}", each.amplitude, "rad", each.amplitude_sigma, note)
        for name in ("lost_motion", "windup", "natural_frequency", "damping_ratio"):
            if (measured := getattr(self, name)) is not None:
                yield Row(name.replace("_", " "), measured.value, measured.unit, measured.sigma)
        yield Row("noise", self.noise, "rad", note="rms of the residual")

    def plot(self) -> Figure:
        """Return a figure of the error over the record, its kinematic part and the residual."""
        with marks.new_figure(3.8) as figure:
            draw_error(figure, self)
        return figure


def draw_error(figure: Figure, error: TransmissionError) -> None:
    """Draw the transmission error over the record, its orders and its residual."""
    curves = error.curves
    timed = "time" in curves
    x = curves["time"] if timed else curves["input_angle"] / tau
    turns = np.abs(curves["input_angle"] - curves["input_angle"][0]) / tau
    is_cut = bool(turns.max() > 2.0 * MAX_DRAWN_TURNS)
    first = turns <= MAX_DRAWN_TURNS if is_cut else np.ones(len(turns), bool)
    whole, residual = figure.subplots(2, 1, sharex=not is_cut, height_ratios=(2.0, 1.0))
    for name, colour, label in (
        ("transmission_error", "measured", "transmission error"),
        ("kinematic_error", "model", "kinematic error found"),
    ):
        marks.curve(whole, x[first], curves[name][first], color=LIGHT[colour], linewidth=0.9, label=label)
    marks.curve(residual, x, curves["residual"], color=LIGHT["ink"], linewidth=0.8)
    residual.axhline(0.0, color=LIGHT["muted"], linewidth=0.8)
    marks.label_axes(whole, f"at the output{f', first {MAX_DRAWN_TURNS:g} turns of the input' if is_cut else ''}", "rad")
    along = ("time", "s") if timed else ("revolutions of the input", "1")
    marks.label_axes(residual, "left by orders and loads", "rad", *along)
    marks.legend(figure, whole)


def transmission_error(
    recording: Recording,
    *,
    ratio: float | None = None,
    orders: ArrayLike = ORDERS,
    rate: float | None = None,
    false_alarm: float = 0.01,
    ratio_option: str = "ratio=…",
) -> TransmissionError:
    """Return ratio, kinematic error and lost motion of a gear from the angles of both shafts.

    Args:
        recording: with `input_angle` and `output_angle`, of any zero and sense, that may wrap at each revolution; with `time`,
            if the motion is not slow; and with `joint_torque`, `torque` or `current` for the wind-up
        ratio: input over output, if it is known; used with all its digits; by default of a simulation that of its drive. Its
            sign is that of the recorded angles, and a remark follows if that differs. If both angles are counted in joint
            units, the input angle is multiplied by it
        orders: of the input to look for [1], shape (n,)
        rate: samples per second of a recording without time [Hz]
        false_alarm: largest probability that noise makes any order significant
        ratio_option: with which a user gives the ratio, for remarks

    Returns:
        The orders with standard deviations that allow for coloured noise, and for a gear that is no linear spring. An order
        needs three periods in the record, and a whole turn of the input.

    Raises:
        TypeError: an argument is not of its kind
        ValueError: an angle is missing or does not turn, the two do not belong together, or the ratio given is not theirs

    Valid where the twist is small and the output stage close to linear. Each order is corrected for the vibration of the output
    with 10 % of its stiffness and 30 % of its damping uncertain, if the record determines it: by several speeds, or both ways.
    At one speed, one way, the vibration and other amplitudes predict the same: the amplitudes are those measured at that speed.

    >>> import strainwave as sw
    >>> time = np.arange(0.0, 20.0, 0.002)
    >>> theta = 30.0 * np.sin(0.5 * time)
    >>> noise = np.random.default_rng(1).normal(0.0, 1e-5, len(time))
    >>> output = -theta / 100.0 - 3e-4 * np.sin(2 * theta + 0.3) + noise
    >>> columns = {"time": time, "input_angle": theta, "output_angle": output}
    >>> found = sw.transmission_error(sw.Recording(columns, {"time": "s", "input_angle": "rad", "output_angle": "rad"}))
    >>> found.ratio.used, [(each.order, round(each.amplitude, 5)) for each in found.orders if each.significant]
    (-100.0, [(2.0, 0.0003)])
    """
    check_recording("recording", recording)
    wanted = np.unique(arguments.positive_series("orders", orders))
    false_alarm = arguments.probability("false_alarm", false_alarm)
    load = next((name for name in LOAD_UNITS if name in recording), None)
    if ratio is None and isinstance(recording, Run):
        ratio = recording.end.drive.gear.kinematics.ratio
    pair = _pair(recording, load, rate)
    pair, measured = ratio_of(pair, ratio)
    size = measured.used
    chosen, left_out = _chosen(pair, wanted, measured, ratio)
    chosen, loads, of_weight = _with_one_weight(chosen, loads_of(pair, size), 1.0 / abs(size), load)
    shapes = [wave(order * pair.input) for order, _ in chosen for wave in (np.sin, np.cos)]
    fit, every = _regressed(pair, size, shapes, loads, dynamic=pair.record.timed)
    error = sum((value * wave for value, wave in zip(fit.values, shapes, strict=False)), np.zeros(len(pair.input)))
    whole, place = pair.input / size - pair.output, len(shapes)  # of the direction, the first of the loads
    lost = MeasuredValue(2.0 * float(fit.values[place]), 2.0 * float(np.sqrt(fit.covariance[place, place])), "rad")
    frequency = damping = None
    if fit.stage is not None and pair.record.timed:
        hertz = fit.stage.frequency / (tau * pair.record.step * every)
        frequency = MeasuredValue(hertz, hertz * fit.spread[0], "Hz")
        damping = MeasuredValue(fit.stage.damping, fit.stage.damping * fit.spread[1], "1")
    speeds = _speeds_of_amplitudes(fit, pair) if chosen else ""
    vibrates = bool(speeds) and fit.vibrates and not _at_one_speed(pair)
    orders_of_error = tuple(each for each in _orders(chosen, fit, false_alarm) if not (vibrates and each.shaft == "mesh"))
    remarks = [*ratio_remarks(measured, ratio, ratio_option), *left_out, *of_weight]
    remarks += _stage_remarks(fit, pair, every, chosen, speeds)
    if vibrates and (hidden := [f"{order:.5g}" for order, shaft in chosen if shaft == "mesh"]):
        why = "orders of the input whose amplitudes change with the speed have side lines there"
        remarks.append(f"not determined: {named('order', hidden)}; {why}")
    if not pair.reverses:
        remarks.append("the shafts turn one way only: lost motion is not determined")
    return TransmissionError(
        ratio=measured,
        orders=orders_of_error,
        lost_motion=lost if pair.reverses else None,
        windup=_windup(pair, whole - error, load, recording),
        natural_frequency=frequency,
        damping_ratio=damping,
        noise=float(np.sqrt(np.mean(fit.residual**2))),
        revolutions=float(np.ptp(pair.input)) / tau,
        curves=_curves(pair, whole - whole.mean(), error, fit.residual, every),
        remarks=(*pair.record.remarks, *remarks),
        speeds=speeds,
        vibrates=vibrates,
    )


def _pair(recording: Recording, load: str | None, rate: float | None) -> Pair:
    """Return both shafts evenly in time, of a long record the beginning."""
    record = evenly(recording, ["input_angle", "output_angle", *([load] if load else [])], rate)
    record = beginning(record, MAX_COMPARED * _averaged(record, recording))
    angles = (
        unwrapped(name, convert(record.columns[name], recording.unit(name), "rad")) for name in ("input_angle", "output_angle")
    )
    return Pair(record, *angles)


def _chosen(pair: Pair, wanted: Array, ratio: Ratio, given: float | None) -> tuple[list[tuple[float, Shaft]], list[str]]:
    """Return the orders that the record determines, and remarks on those that it does not."""
    if ratio.in_joint_units and given is None:
        return [], ["orders of the input are not looked for: its angle is not known without the ratio"]
    turns_in, turns_out = float(np.ptp(pair.input)) / tau, float(np.ptp(pair.output)) / tau
    highest = MAX_FREQUENCY * tau / pair.fastest if pair.fastest > 0.0 else inf
    lowest = MIN_ORDER_PERIODS / turns_in if turns_in >= MIN_INPUT_TURNS else inf
    chosen: list[tuple[float, Shaft]] = [(float(order), "input") for order in wanted if lowest <= order < highest]
    remarks = []
    if missed := [f"{order:g}" for order in wanted if order >= highest]:
        remarks.append(f"the samples do not follow {named('order', missed)} at this speed; record faster, or turn slower")
    if missed := [f"{order:g}" for order in wanted if order < min(lowest, highest)]:
        remarks.append(
            f"not determined: {named('order', missed)}; an order needs {MIN_ORDER_PERIODS:g} periods and a whole turn of the "
            f"input, which turns {turns_in:.2g} revolutions"
        )
    if chosen and turns_out < MIN_ORDER_PERIODS:
        remarks.append(f"orders of the output need {MIN_ORDER_PERIODS:g} revolutions of it; the record has {turns_out:.3g}")
    slip = 1.0 / abs(ratio.used)
    if turns_in * slip >= 1.0:
        for order in MESH_ORDERS if ratio.of_strain_wave else ():
            mesh = order * (1.0 - 1.0 / ratio.used)
            if lowest <= mesh < highest and not any(abs(mesh - other) * turns_in < 1.0 for other, _ in chosen):
                chosen.append((mesh, "mesh"))
        chosen += [(order * slip, "output") for order in OUTPUT_ORDERS if order * turns_out >= MIN_ORDER_PERIODS * (1.0 - 1e-3)]
    elif chosen and ratio.of_strain_wave:
        near = 2.0 * (1.0 - 1.0 / ratio.used)
        remarks.append(
            f"the output turns {turns_out:.4g} of a revolution: orders 2 and {near:.4g}, of the wave generator against either "
            "spline, are separated after a whole one"
        )
    return chosen, remarks


def _with_one_weight(
    chosen: list[tuple[float, Shaft]], loads: list[Array], once: float, load: str | None
) -> tuple[list[tuple[float, Shaft]], list[Array], list[str]]:
    """Return orders and loads with one wave over the turn of the output: an order, or gravity if the load is known; and why."""
    if (once, "output") not in chosen:
        return chosen, loads, []
    if load is None:
        why = "order 1 of the output contains the wind-up by a weight there: one record does not separate them"
        return chosen, loads[:2], [why]
    why = "order 1 of the output is part of the wind-up by the load, from which one record does not separate it"
    return [each for each in chosen if each != (once, "output")], loads, [why]


def _regressed(
    pair: Pair, ratio: float, shapes: Sequence[Array], loads: Sequence[Array], *, dynamic: bool
) -> tuple[Regressed, int]:
    """Return the regression, and the number of neighbours averaged in each sample that is compared."""
    every = min(-(-len(pair.input) // MAX_COMPARED), _mean_of(pair.fastest))
    problem = StageProblem(
        angle=_means(pair.input / ratio, every),
        error=_means(pair.input / ratio - pair.output, every),
        orders=np.stack([_means(shape, every) for shape in shapes], axis=1)
        if shapes
        else np.zeros((len(pair.input) // every, 0)),
        loads=np.stack([_means(load, every) for load in loads], axis=1),
    )
    return problem.regress(dynamic=dynamic), every


def _means(series: Array, every: int) -> Array:
    """Return means of so many neighbours each; the rest at the end is left out."""
    return np.asarray(series[: len(series) // every * every].reshape(-1, every).mean(axis=1))


def _mean_of(fastest: float) -> int:
    """Return the number of neighbours to average that keeps the highest order at the fastest speed [rad per sample]."""
    return int(min(max(1.0, 2.0 * MAX_FREQUENCY * pi / (max(ORDERS) * fastest)), 1e9)) if fastest > 0.0 else 10**9


def _averaged(record: Evenly, recording: Recording) -> int:
    """Return the same of a record whose angle may still wrap."""
    steps = np.abs(np.diff(convert(record.columns["input_angle"], recording.unit("input_angle"), "rad")))
    return _mean_of(float(np.quantile(np.minimum(steps, np.abs(tau - steps)), 0.99)))


def _orders(chosen: Sequence[tuple[float, Shaft]], fit: Regressed, allowed: float) -> Iterator[ErrorOrder]:
    """Yield each order with its standard deviations and its significance."""
    for place, (order, shaft) in enumerate(chosen):
        own = slice(2 * place, 2 * place + 2)
        pair, covariance = fit.values[own], fit.covariance[own, own]
        sine, cosine = pair.tolist()
        amplitude, phase = hypot(sine, cosine), float(np.arctan2(cosine, sine))
        along = np.array([np.cos(phase), np.sin(phase)])
        across = np.array([-along[1], along[0]])
        sigmas = [float(np.sqrt(max(each @ covariance @ each, 0.0))) for each in (along, across)]
        square = float(pair @ np.asarray(np.linalg.pinv(covariance)) @ pair)
        single = (1.0 + square / fit.freedom) ** (-0.5 * fit.freedom)  # tail of F(2, freedom)
        alarm = min(1.0, len(chosen) * single)
        turn = sigmas[1] / amplitude if amplitude > 0.0 else inf
        yield ErrorOrder(order, shaft, amplitude, phase, sigmas[0], min(turn, pi / np.sqrt(3.0)), alarm, alarm < allowed)


def _windup(pair: Pair, twist: Array, load: str | None, recording: Recording) -> MeasuredValue | None:
    """Return the twist per torque or current, fitted with direction, speed and acceleration of the input."""
    if load is None or float(np.ptp(pair.record.columns[load])) == 0.0:
        return None
    unit, speed = LOAD_UNITS[load], pair.speed
    driven = convert(pair.record.columns[load], recording.unit(load), unit)
    loads = np.stack([driven, direction(speed), speed, smooth_speed(speed, reach_of(len(twist)))], axis=1)
    fit = StageProblem(np.zeros(len(twist)), twist, np.zeros((len(twist), 0)), loads).regress(dynamic=False)
    per_load = f"rad/({unit})" if "." in unit else f"rad/{unit}"
    return MeasuredValue(float(fit.values[0]), float(np.sqrt(fit.covariance[0, 0])), per_load)


def _at_one_speed(pair: Pair) -> bool:
    """True if every order passes at nearly one frequency."""
    slow, fast = np.quantile(np.abs(pair.speed), [0.1, 0.9]).tolist()
    return bool(fast <= MAX_SPEED_RATIO * slow)


def _speeds_of_amplitudes(fit: Regressed, pair: Pair) -> str:
    """Return the speeds of the input at which alone amplitudes are measured; empty if they are those of the gear."""
    one = _at_one_speed(pair)
    if fit.stage is not None or not pair.record.timed or not (fit.vibrates or one):
        return ""
    slow, usual, fast = np.quantile(np.abs(pair.speed), [0.05, 0.5, 0.95]) / pair.record.step * 30.0 / pi
    return f"{usual:.4g} 1/min of the input" if one else f"{slow:.4g} to {fast:.4g} 1/min of the input"


def _stage_remarks(fit: Regressed, pair: Pair, every: int, chosen: Sequence[tuple[float, Shaft]], speeds: str) -> list[str]:
    if fit.stage is not None:
        fastest = max((order for order, _ in chosen), default=0.0) * pair.fastest * every
        if fastest < 0.3 * fit.stage.frequency:
            return []
        return [
            "orders come near the natural frequency of the output, or pass it: their amplitudes are corrected for it, and less "
            "certain than those of a slow run"
        ]
    if not pair.record.timed:
        return ["without time nothing is known of vibration: amplitudes are those at the speeds of the record"]
    if not speeds:
        return []
    why, remedy = (
        ("one speed does not determine how the output vibrates", "if speeds from slow to fast are in one record, they are")
        if _at_one_speed(pair)
        else (WHY_AMPLITUDES_CHANGE, "those of a slow run are the gear's")
    )
    return [f"amplitudes are those measured at {speeds}: {why}, and they are not corrected for it; {remedy}"]


def _curves(pair: Pair, error: Array, orders: Array, residual: Array, every: int) -> Recording:
    series = {"input_angle": pair.input, "output_angle": pair.output, "transmission_error": error, "kinematic_error": orders}
    middle = np.arange(len(residual)) + 0.5 * (every - 1) / every
    columns = {"time": pair.record.start + pair.record.step * every * middle}
    columns |= {name: _means(values, every) for name, values in series.items()} | {"residual": residual}
    units = {name: "s" if name == "time" else "rad" for name in columns}
    if not pair.record.timed:
        del columns["time"], units["time"]
    return Recording(columns, units, "transmission error")
