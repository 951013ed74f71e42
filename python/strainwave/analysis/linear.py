r"""The linear view of a drive: how it answers signals so small that it does not change.

.. math:: \dot x = A x + B u, \qquad y = C x + D u

with x, u and y the deviations of the motion, the inputs and the outputs. The derivatives are exact to rounding (dual numbers).
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from math import tau
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from strainwave import Drive, Gear, _core, arguments, control, friction, motor, sensor
from strainwave.analysis.steady import OVERFLOW_REASON, QUASI_STATIC_TIME, averaged, constant_inputs, equilibrium
from strainwave.equality import ComparedByFields
from strainwave.files.units import ratio_of_units
from strainwave.presentation import Pictured, Row, counted
from strainwave.simulation.excitation import ROOM_TEMPERATURE
from strainwave.simulation.signals import TWIST_CHANNEL, check_continuous, command_unit, outputs, units
from strainwave.simulation.state import State, StateLayout, start_of
from strainwave.simulation.time_grid import room_for

if TYPE_CHECKING:
    from matplotlib.figure import Figure

Array = NDArray[np.float64]
Complex = NDArray[np.complex128]

MIN_GROWTH_SHARE = 1e-9  # of a pole that grows: its real part over its size; below it is 0 but for rounding
MIN_RELATIVE_POLE = 1e-6  # over the largest; a smaller one is 0 but for rounding
DRAWN_FREQUENCIES = 600  # of a Bode diagram
HOLDING_TORQUE = 1e30  # N.m: more than any torque that turns an input
DAMPING_UNITS = ("N.m.s/rad", "N.s/m")  # units of what damps a body within the gear
LINEAR_INPUTS = ("command", "command_rate", "load_torque", "temperature")
_INPUT_COLUMNS = [0, 1, 2, 4]  # of these among the inputs that the core knows; nothing depends on the rates of the others


def continuous(drive: Drive) -> tuple[Drive, tuple[str, ...]]:
    """Return a drive without what has no linear model, and a note on each part that was left out.

    A sampled controller becomes its law, a sensor with noise, steps or counts the one within it. Energy is not measured, and
    the drive does not warm up.

    >>> import strainwave as sw
    >>> law = sw.control.PID(proportional=2.0, derivative=0.05)
    >>> plain, notes = continuous(sw.Drive(control=sw.control.Sampled(law=law, period=1e-3, delay=2e-4)))
    >>> plain.control == law, notes
    (True, ('control: sampling every 0.001 s with a delay of 0.0002 s is left out, as is a compensation',))
    """
    parts = {name: (part, note) for name, part, note in _replaced(drive)}
    plain = drive.replace(**{name: part for name, (part, _) in parts.items()})
    return plain, tuple(note for _, note in parts.values())


def _replaced(drive: Drive) -> Iterator[tuple[str, Any, str]]:
    sampled = drive.control
    if isinstance(sampled, control.Sampled):
        times = f"sampling every {sampled.period:g} s with a delay of {sampled.delay:g} s"
        yield "control", sampled.law, f"control: {times} is left out, as is a compensation"
    whole = {field["name"]: getattr(drive.sensors, field["name"]) for field in drive.sensors.fields}
    smooth = dict(whole)
    for name, part in whole.items():
        while isinstance(part, (sensor.Noisy, sensor.Quantised)):
            part = part.law
        smooth[name] = sensor.Ideal() if isinstance(part, sensor.Encoder | sensor.SineCosineEncoder) else part
    if changed := [name for name, part in whole.items() if smooth[name] is not part]:
        yield (
            "sensors",
            drive.sensors.replace(**smooth),
            f"sensors.{', sensors.'.join(changed)}: noise, steps and counts are left out",
        )
    for name, left_out in (("meter", "energy is not measured"), ("thermal", "the drive does not warm up")):
        if not isinstance(getattr(drive, name), kind := type(getattr(Drive(), name))):
            yield name, kind(), f"{name}: {left_out}"


def state_within(plain: Drive, state: State) -> State:
    """Return the state of a drive as that of the same drive by `continuous`; what it lacks has its value at rest."""
    numbers = {name.replace("control.law.", "control."): value for name, value in state.items()}
    numbers |= {name.replace(".law.", "."): value for name, value in numbers.items() if name.startswith("sensors.")}
    rest = plain.rest()
    return rest.replace({name: numbers[name] for name in rest if name in numbers})


@dataclass(frozen=True, eq=False)
class Linearisation(ComparedByFields, Pictured):
    """Linear model of a drive about a state: matrices A, B, C, D for n states, 4 inputs and m outputs.

    Unpacks to the four matrices, which have no names: ``control.StateSpace(*linear, **linear.labels)`` of python-control keeps
    those of states, inputs and outputs. `command_rate` is the rate of `command`: whoever feeds a command from elsewhere feeds
    both; `response` does.

    Args:
        A: of the states [unit of the row / s / unit of the column], shape (n, n)
        B: of the inputs, shape (n, 4)
        C: of the outputs by the states, shape (m, n)
        D: of the outputs by the inputs, shape (m, 4)
        states: names; a part's own states begin with its place, as in "motor.current"
        inputs: names
        outputs: names, those of a recording's columns
        units: unit of each name
        notes: on each part of the drive that has no linear model, and was left out

    >>> import strainwave as sw
    >>> linear = sw.linearise(sw.Drive(control=sw.control.PID(proportional=2.0, derivative=0.05)))
    >>> linear.eigenfrequencies.round(1), linear.damping_ratios.round(2)  # rad/s; two real poles, and the spring of the gear
    (array([  21. ,  440.4, 1040.6, 1040.6]), array([1.  , 1.  , 0.02, 0.02]))
    """

    A: Array
    B: Array
    C: Array
    D: Array
    states: tuple[str, ...]
    inputs: tuple[str, ...]
    outputs: tuple[str, ...]
    units: dict[str, str]
    notes: tuple[str, ...] = ()

    def __iter__(self) -> Iterator[Array]:
        return iter((self.A, self.B, self.C, self.D))

    @property
    def labels(self) -> dict[str, list[str]]:
        """The names of states, inputs and outputs, as python-control takes them."""
        return {"states": list(self.states), "inputs": list(self.inputs), "outputs": list(self.outputs)}

    @cached_property
    def _eigen(self) -> tuple[Complex, Complex]:
        poles, modes = np.linalg.eig(self.A)
        order = np.lexsort((poles.imag, np.abs(poles)))
        return poles[order].astype(np.complex128), modes[:, order].astype(np.complex128)

    @property
    def poles(self) -> Complex:
        """Eigenvalues of A [rad/s], slowest first, shape (n,). One with a positive real part: the state is not stable."""
        return self._eigen[0]

    @property
    def modes(self) -> Complex:
        """Return the mode shapes of the states: column k belongs to pole k, of length 1, shape (n, n)."""
        return self._eigen[1]

    @property
    def eigenfrequencies(self) -> Array:
        """Return the undamped natural frequency of each pole, its distance from 0 [rad/s], shape (n,)."""
        return np.asarray(np.abs(self.poles))

    @property
    def damping_ratios(self) -> Array:
        """Return the damping ratio of each pole, shape (n,): 1 aperiodic, 0 undamped, below 0 unstable; NaN for a pole at 0."""
        size = self.eigenfrequencies
        return np.asarray(np.divide(-self.poles.real, size, out=np.full(len(size), np.nan), where=size > 0.0))

    def plot(self, frequency: ArrayLike | None = None, output: str = "output_angle", input: str = "command") -> Figure:
        """Return the Bode diagram of an output over an input: magnitude [unit of the output / of the input], phase [deg].

        Args:
            frequency: of the sine [Hz], shape (k,); from a tenth of the slowest to ten times the fastest pole if not given
            output, input: names, as for `response`

        Raises:
            ValueError: as `response`; `frequency` is not positive, or not given and no pole differs from 0
        """
        from strainwave.analysis.plots import Response, bode_figure

        if frequency is None:
            size = self.eigenfrequencies
            size = size[size > MIN_RELATIVE_POLE * size.max(initial=0.0)] / tau
            if not size.size:
                raise ValueError("frequency must be given: all poles are 0")
            frequency = np.geomspace(0.1 * size.min(), 10.0 * size.max(), DRAWN_FREQUENCIES)
        frequencies = np.atleast_1d(arguments.numbers("frequency", frequency))
        if frequencies.size == 0 or frequencies.min() <= 0.0:
            raise ValueError("frequency must have one positive number [Hz] or more; the axis is logarithmic")
        response = self.response(frequencies, output, input)
        title = f"Linear response of {output.replace('_', ' ')} to {input.replace('_', ' ')}"
        return bode_figure([Response("", frequencies, response)], ratio_of_units(self.units[output], self.units[input]), title)

    def response(self, frequency: ArrayLike, output: str = "output_angle", input: str = "command") -> Complex:
        """Amplitude and phase of an output over those of an input that is a sine.

        Args:
            frequency: of the sine [Hz], shape (k,) or a number
            output: name of the output
            input: name of the input; "command" moves its rate along

        Returns:
            Transfer function at 2 pi i `frequency` [unit of the output / unit of the input], of the shape of `frequency`.

        Raises:
            ValueError: there is no such input or output, or a frequency is not finite or that of an undamped pole

        >>> import numpy as np
        >>> import strainwave as sw
        >>> linear = sw.linearise(sw.Drive(control=sw.control.PID(proportional=2.0, derivative=0.05)))
        >>> abs(linear.response([1.0, 10.0])).round(2)  # gain of the position loop at 1 Hz and at 10 Hz
        array([0.97, 0.59])
        """
        frequencies = arguments.numbers("frequency", frequency)
        if not np.isfinite(frequencies).all():
            raise ValueError(f"frequency = {frequencies[~np.isfinite(frequencies)][0]} Hz must be finite")
        row, column = _place(output, self.outputs, "output"), _place(input, self.inputs, "input")
        each = 64.0 * len(self.A) ** 2
        try:
            with np.errstate(over="ignore", invalid="ignore"), room_for("frequencies", frequencies.size, each, "take fewer"):
                at: Complex = np.asarray(tau * 1j * frequencies[..., None], dtype=np.complex128)
                answer = self._transferred(at, row, column)
        except np.linalg.LinAlgError:
            answer = np.full(frequencies.shape, np.inf, dtype=np.complex128)
        if not np.isfinite(answer).all():
            raise ValueError("frequency is that of a pole without damping: the response has no bound there")
        return answer

    def _transferred(self, at: Complex, row: int, column: int) -> Complex:
        """The transfer function at s, shape (…, 1), of the input in a column to the output in a row."""
        b, d = self.B[:, column] + 0.0 * at, self.D[row, column] + 0.0 * at
        if self.inputs[column] == "command":
            rate = self.inputs.index("command_rate")
            b, d = b + at * self.B[:, rate], d + at * self.D[row, rate]
        states = np.linalg.solve(at[..., None] * np.eye(len(self.A)) - self.A, b[..., None])[..., 0]
        return np.asarray(states @ self.C[row] + d[..., 0])

    def _headline(self) -> str:
        unstable = int((self.poles.real > MIN_GROWTH_SHARE * np.abs(self.poles)).sum())
        verdict = counted(unstable, "unstable pole") if unstable else "stable"
        kinds = (("state", self.states), ("input", self.inputs), ("output", self.outputs))
        return f"{', '.join(counted(len(names), kind) for kind, names in kinds)}, {verdict}"

    def _rows(self) -> Iterator[Row]:
        seen = [
            each for each in zip(self.poles, self.eigenfrequencies, self.damping_ratios, strict=True) if each[0].imag >= 0.0
        ]
        for number, (pole, frequency, damping) in enumerate(seen, start=1):
            kind = "vibration" if pole.imag else "real pole"
            yield Row(f"frequency of mode {number}", float(frequency), "rad/s", note=kind)
            yield Row(f"damping ratio of mode {number}", float(damping), "1")

    def _remarks(self) -> Iterator[str]:
        return iter(self.notes)


def linearise(
    drive: Drive,
    state: State | None = None,
    *,
    command: float = 0.0,
    command_rate: float = 0.0,
    load_torque: float = 0.0,
    temperature: float = ROOM_TEMPERATURE,
) -> Linearisation:
    """Return the linear model of a drive about a state.

    Small means: so small that nothing else changes. A side that sticks does not move, and its states drop out; so does what
    nothing depends on. Friction and hysteresis with memory answer each reversal with their initial stiffness, and what they
    lose by sliding is of second order: this view knows none of it; `frequency_response` at amplitude does. Where a slope
    differs between the senses of motion, it is the mean of both, after a small movement to and fro: the first harmonic that a
    vanishing vibration sees. A drive that runs is seen without its kinematic error, as `equilibrium` sees it. Sampling, noise
    and steps of sensors, a meter and warming have no linear model: they are left out, and `notes` of the result names them.

    Args:
        drive: the drive
        state: where; `equilibrium` under the same inputs if not given
        command: output angle [rad] of a drive under position control, voltage [V] of one in open loop
        command_rate: rate of the command [1/s], for a state of a drive that follows one
        load_torque: torque that holds the output back [N.m], besides the load's own
        temperature: of the gear [K]

    Returns:
        Matrices with the names of their rows and columns.

    Raises:
        TypeError: an argument is not of its kind
        ValueError: an input is not finite, `temperature` is not positive, no state is given and there is no equilibrium, or
            torques grow beyond all numbers

    >>> import strainwave as sw
    >>> drive = sw.Drive(control=sw.control.PID(proportional=2.0, derivative=0.05))
    >>> linear = sw.linearise(drive)
    >>> linear.states
    ('input_angle', 'input_speed', 'transmission_error', 'output_speed')
    >>> [matrix.shape for matrix in linear]
    [(4, 4), (4, 4), (16, 4), (16, 4)]
    >>> round(float(abs(linear.response(0.0))), 12)  # it follows its command
    1.0
    """
    drive, notes = continuous(given := arguments.drive(drive))
    check_continuous(drive, "linearise")
    inputs = constant_inputs(command, load_torque, temperature, command_rate)
    if state is None:
        state = equilibrium(drive, command=command, load_torque=load_torque, temperature=temperature)
    elif notes:
        state = state_within(drive, start_of(given, state, "state"))
    state = State.of(drive, _core.consistent(drive, start_of(drive, state, "state").numbers))
    if state.input_speed != 0.0:
        drive = averaged(drive)
    slopes = [_core.differentiate_rates(drive, _vibrating(state, drive, inputs, sense), inputs)[1] for sense in (1.0, -1.0)]
    if not all(np.isfinite(each).all() for each in slopes):
        raise ValueError(f"the drive cannot be linearised: {OVERFLOW_REASON}")
    layout = StateLayout(drive)
    count = layout.count
    shown = outputs(drive)
    rows = [*range(count), *(count + each.channel for each in shown.values())]
    by_numbers, by_inputs = np.split((0.5 * slopes[0].T + 0.5 * slopes[1].T)[rows], [count], axis=1)
    by_inputs = by_inputs[:, _INPUT_COLUMNS]
    kept = _moving(state, layout)
    tied = np.eye(layout.count)
    if state.output_slip_direction == 0.0:  # while the output sticks, the transmission error goes with the input
        tied[layout.places["transmission_error"], layout.places["input_angle"]] = 1.0 / state.drive.gear.kinematics.ratio
    by_numbers = by_numbers @ tied
    while dead := [place for place in kept if not _matters(place, by_numbers, kept)]:
        kept = [place for place in kept if place not in dead]
    (a, c), (b, d) = np.split(by_numbers[:, kept], [count]), np.split(by_inputs, [count])
    of_inputs = {"command_rate": f"{command_unit(drive)}/s", "load_torque": "N.m", "temperature": "K"}
    all_units = layout.units | units(drive, shown.values()) | of_inputs
    states = tuple(layout.names[place] for place in kept)
    chosen = {name: all_units[name] for name in (*states, *LINEAR_INPUTS, *shown)}
    return Linearisation(a[kept], b[kept], c, d, states, LINEAR_INPUTS, tuple(shown), chosen, notes)


def modes(drive: Drive) -> dict[str, Array]:
    """Return the natural frequencies of the free, undamped shafts on the spring of the gear.

    Spring and hysteresis have their stiffness at rest. The kinematic error is left out, for its slope changes the ratio with
    the input angle. What the load does is kept, its damping too. Two inertias on a spring of stiffness k at the output
    vibrate at sqrt(k (1 / J_out + 1 / (i^2 J_in))), with the input held at sqrt(k / J_out).

    Args:
        drive: the drive; of motor and controller, only the inertia of the motor matters

    Returns:
        "free" and "input held": eigenfrequencies [rad/s], increasing, each of shape (n,)

    Raises:
        TypeError: it is no drive
        ValueError: the load prescribes or brakes the motion of the output shaft

    >>> import strainwave as sw
    >>> gear = sw.Gear(kinematics=sw.kinematics.PlainRatio(reduction=100.0), stiffness=sw.stiffness.Linear(k=150.0))
    >>> drive = sw.Drive(gear=gear, motor=sw.motor.DC(inertia=0.0012), load=sw.loads.Inertia(inertia=0.005))
    >>> {name: found.round(6).tolist() for name, found in modes(drive).items()}
    {'free': [173.241161], 'input held': [173.205081]}
    """
    arguments.drive(drive)
    same = ("kinematics", "stiffness", "hysteresis", "input_inertia", "softening", "structure", "stiffness_variation")
    gear = Gear(**{name: getattr(drive.gear, name) for name in same})
    damped = [field["name"] for field in gear.structure.fields if field["unit"] in DAMPING_UNITS]
    undamped: Any = gear.structure.replace(dict.fromkeys(damped, 0.0))
    if shares := getattr(getattr(undamped, "ring", None), "damping", ()):
        undamped = undamped.replace(ring=undamped.ring.replace(damping=[0.0] * len(shares)))
    gear = gear.replace(structure=undamped)
    bare = Drive(gear=gear, motor=motor.TorqueSource(inertia=drive.motor.inertia), load=drive.load)
    held = bare.replace(gear=gear.replace(friction_input=friction.Coulomb(coulomb=HOLDING_TORQUE, breakaway=HOLDING_TORQUE)))
    return {"free": _frequencies(bare), "input held": _frequencies(held)}


def _frequencies(drive: Drive) -> Array:
    """Return the frequencies of the pairs of poles that vibrate [rad/s]."""
    poles = linearise(drive, drive.rest()).poles
    return np.asarray(np.sort(poles.imag[poles.imag > 0.0]))


def _vibrating(state: State, drive: Drive, inputs: Array, sense: float) -> Array:
    """`state` as a vibration finds it that is too small to change it and just passes in one `sense`, not for the first time."""
    twist = _core.now(drive, state.numbers, inputs)[TWIST_CHANNEL].item()
    little, ratio = 1e-12 * max(abs(twist), 1e-3), abs(drive.gear.kinematics.ratio)
    at_rest = state.input_speed == state.output_speed == 0.0

    def passing(numbers: Array, way: float) -> Array:
        """The same with the speeds of what rests but does not stick, `way` times a little within `QUASI_STATIC_TIME`."""
        speed = way * little / QUASI_STATIC_TIME
        return (
            State.of(drive, numbers)
            .replace(
                input_speed=state.input_speed or (ratio * speed if state.input_slip_direction else 0.0),
                output_speed=state.output_speed or (speed if state.output_slip_direction else 0.0),
            )
            .numbers
        )

    numbers = state.numbers
    for way in (1.0, -2.0, 1.0):
        twist += way * little
        numbers = _core.advance_hysteresis(drive, numbers, twist)
        if at_rest:
            numbers = _core.relaxed(drive, passing(numbers, way), inputs, QUASI_STATIC_TIME)
    return passing(_core.advance_hysteresis(drive, numbers, twist - 0.5 * sense * little), sense)


def _moving(state: State, layout: StateLayout) -> list[int]:
    """The places of what moves: all but the numbers of a shaft that sticks."""
    stuck = set[str]()
    if state.input_slip_direction == 0.0:
        stuck |= {"input_angle", "input_speed", "friction_input", "friction_mesh"}
    if state.output_slip_direction == 0.0:
        stuck |= {"output_speed", "friction_output", "transmission_error"}
    return [place for place, name in enumerate(layout.names[: layout.count]) if name.partition(".")[0] not in stuck]


def _matters(place: int, by_numbers: Array, kept: list[int]) -> bool:
    """True if another number or an output depends on a number."""
    others = [row for row in kept if row != place]
    return bool(by_numbers[others, place].any() or by_numbers[by_numbers.shape[1] :, place].any())


def _place(name: str, names: tuple[str, ...], kind: str) -> int:
    return names.index(arguments.one_of(kind, name, names))
