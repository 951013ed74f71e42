"""The steady view of a drive: where nothing accelerates."""

from __future__ import annotations

import warnings
from dataclasses import dataclass
from functools import cached_property
from math import tau
from typing import Any

import numpy as np
from numpy.typing import NDArray

from strainwave import Drive, _core, arguments, kinematic_error, motor
from strainwave.equality import ComparedByFields
from strainwave.simulation.excitation import ROOM_TEMPERATURE, check_temperature
from strainwave.simulation.signals import TWIST_CHANNEL, actuation, check_continuous, command_unit, controls_position
from strainwave.simulation.state import State, StateLayout, start_of

Array = NDArray[np.float64]

QUASI_STATIC_TIME = 1e30  # s: of a motion that takes so long, friction depends on the path alone
_ROUNDING_SHARE = 1e-14  # of the terms that cancel [1]
MAX_ANGLE = 1e12  # rad of the input: beyond, where within a turn it stands is lost
_NEGLIGIBLE_RATE = 1e-12  # rad/s2, A/s: a term so small has no effect
OVERFLOW_REASON = "torques or their derivatives grow beyond all numbers; check the parameters and the inputs"
MAX_TIME_TO_REST, TIMES_TO_REST = 40.0, 8  # s, and instants at which a moving drive is looked at
_MAX_INPUT_SPEED = 1e9  # rad/s: a drive that exceeds it has no steady speed


def equilibrium(
    drive: Drive,
    *,
    command: float = 0.0,
    load_torque: float = 0.0,
    temperature: float = ROOM_TEMPERATURE,
    initial: State | None = None,
) -> State:
    """Return the state in which nothing accelerates under constant inputs: at rest if there is one, else in steady running.

    Friction and hysteresis hold a drive in many states at rest. The one returned is reached from `initial` by a slow motion of
    each shaft one way. A side whose set-valued friction holds it where it is sticks there; one that breaks away comes to rest
    where kinetic friction balances what drives it. Friction and hysteresis with memory remember the way.

    A drive in open loop or under speed control may run instead. Its state is that at the angles of `initial`, and without the
    kinematic error, which comes and goes with every turn; in open loop at the lowest speed, counted from rest, at which nothing
    accelerates.

    The poles of `linearise` show whether the state is stable.

    Args:
        command: output angle [rad] of a drive under position control, output speed [rad/s] under speed control, voltage [V] of
            one in open loop
        load_torque: torque that holds the output back [N.m], besides the load's own
        temperature: of the gear [K]
        initial: where the way begins, taken at rest; at rest, untwisted, if not given

    Returns:
        A state, for `simulate` to start from or `linearise` to look around in.

    Raises:
        TypeError: an argument is not of its kind
        ValueError: an input is not finite, `temperature` is not positive, there is no equilibrium, torques grow beyond all
            numbers, or a part has none: a sampled controller, a load that prescribes or brakes, a motor that accelerates,
            heating, a meter, noise, an encoder; the message gives the reason

    >>> import strainwave as sw
    >>> arm = sw.loads.Pendulum(inertia=0.1, gravity_torque=5.0)
    >>> held = sw.analysis.equilibrium(sw.Drive(load=arm), command=0.5)
    >>> held.input_speed, held.output_speed
    (0.0, 0.0)
    """
    check_continuous(arguments.drive(drive), "equilibrium")
    _check_uncounted(drive)
    inputs = constant_inputs(command, load_torque, temperature)
    begin = _at_rest(drive, (drive.rest() if initial is None else start_of(drive, initial)).numbers)
    balanced, numbers = drive, _resting(drive, begin, inputs)
    if numbers is None:
        try:
            balanced, numbers = averaged(drive), _running(averaged(drive), begin, inputs)
        except ValueError:
            if (numbers := _come_to_rest(drive, begin, inputs)) is None:
                raise
    balanced_state = State.of(drive, numbers)
    _check_prescribed(balanced, balanced_state.numbers, inputs)
    turns = round(balanced_state.input_angle / tau)
    return balanced_state.replace(input_angle=balanced_state.input_angle - tau * turns, turns=balanced_state.turns + turns)


def _check_uncounted(drive: Drive) -> None:
    """Refuse sensors that count or read in steps: between steps they show no change, so torques do not quite balance."""
    for field in drive.sensors.fields:
        sensor = getattr(drive.sensors, field["name"])
        steps = hasattr(sensor, "resolution")
        while hasattr(sensor, "law"):
            sensor = sensor.law
        if steps or hasattr(sensor, "counts"):
            raise ValueError(
                f"equilibrium needs sensors that do not count; sensors.{field['name']} does. Put sw.sensor.Ideal() in its place"
            )


def _check_prescribed(drive: Drive, state: Array, inputs: Array) -> None:
    """Refuse a motor that keeps accelerating the input shaft, whatever torque that takes."""
    if isinstance(drive.motor, motor.AccelerationSource):
        place = StateLayout(drive).places["input_speed"].start
        if not Rates.of(drive, state, inputs).vanishes([place], 1e-9):
            raise ValueError(_unsteady(drive, inputs, "the motor prescribes an acceleration that is not zero"))


def constant_inputs(command: float, load_torque: float, temperature: float, command_rate: float = 0.0) -> Array:
    """The inputs in the order of the core, shape (6,), if they make sense."""
    inputs = {"command": command, "command_rate": command_rate, "load_torque": load_torque, "temperature": temperature}
    units = {"load_torque": "N.m", "temperature": "K"}
    command, command_rate, load_torque, temperature = [
        arguments.number(*each, units.get(each[0], "")) for each in inputs.items()
    ]
    check_temperature(temperature)
    return np.array([command, command_rate, load_torque, 0.0, temperature, 0.0])


def averaged(drive: Drive) -> Drive:
    """The same drive without kinematic error, which is periodic: what is left of it over many turns."""
    gear = drive.gear.replace(kinematic_error=kinematic_error.Fourier(), kinematic_noise=kinematic_error.Stochastic())
    return drive.replace(gear=gear)


@dataclass(frozen=True, eq=False)
class Rates(ComparedByFields):
    """Rates of the n continuous numbers, what they and the outputs depend on, and the size of the terms a rate is the sum of.

    All to first order: of `by_numbers`, shape (n + channels, n), and `by_inputs` the first n rows are those of the rates.
    """

    rate: Array
    by_numbers: Array
    by_inputs: Array
    size: Array

    @classmethod
    @np.errstate(over="ignore", invalid="ignore")
    def of(cls, drive: Drive, state: Array, inputs: Array) -> Rates:
        values, slopes = _core.differentiate_rates(drive, state, inputs)
        count = len(slopes) - len(inputs)
        by_numbers, by_inputs = np.split(slopes.T, [count], axis=1)
        size = np.abs(by_numbers[:count]) @ np.abs(state[:count]) + np.abs(by_inputs[:count]) @ np.abs(inputs)
        layout = StateLayout(drive)
        places, sensing = layout.places, _sensing(layout)
        # A reading may be small because what it adds up cancels: then it is as exact as that is large.
        following = by_numbers[sensing][:, sensing]
        if sensing and np.isfinite(following).all():
            size += np.abs(by_numbers[:count, sensing]) @ np.abs(np.linalg.pinv(following)) @ size[sensing]
        # So may current and torque.
        for rows, columns in ((places["motor"], places["motor"]), (places["input_speed"], places["transmission_error"])):
            each = size[rows] / _positive(np.abs(np.diag(by_numbers[rows, columns])))
            size += np.abs(by_numbers[:count, columns]) @ each
        return cls(values[:count], by_numbers, by_inputs, size + _NEGLIGIBLE_RATE)

    @property
    def output(self) -> Array:
        """Return the derivatives of the outputs by the numbers, shape (channels, n)."""
        return self.by_numbers[len(self.rate) :]

    @property
    def finite(self) -> bool:
        """True if all of its numbers are finite: no torque overflows."""
        return all(bool(np.isfinite(each).all()) for each in (self.rate, self.by_numbers, self.by_inputs, self.size))

    def vanishes(self, rows: list[int], share: float) -> bool:
        """True if these rates are less than a share of the terms that add up to them."""
        return bool((np.abs(self.rate) <= share * self.size)[rows].all())


# At rest


def _at_rest(drive: Drive, state: Array) -> Array:
    """`state` without its speeds, every shaft that can stick sticking."""
    still = state.copy()
    layout = StateLayout(drive)
    for name in ("input_speed", "output_speed", "input_slip_direction", "output_slip_direction"):
        still[layout.places[name]] = 0.0
    still[_bodies(layout)[1]] = 0.0
    return _core.consistent(drive, still)


def _resting(drive: Drive, start: Array, inputs: Array) -> Array | None:
    """The equilibrium at rest, if there is one: shafts that stick are let go until those that still do hold."""
    sliding = start
    while True:
        slow = _Slow(drive, sliding, inputs)
        balance = _balance(slow, slow.guess())
        last = slow.moved(slow.guess() if balance is None else balance)
        freed, place = _core.break_away(drive, last, inputs), slow.layout.places
        if balance is None:
            freed = _pushed(drive, last, freed, inputs)
        directions = [place["input_slip_direction"].start, place["output_slip_direction"].start]
        if (freed[directions] == sliding[directions]).all():
            break
        sliding = sliding.copy()
        sliding[directions] = freed[directions]
    if balance is None:
        return None
    stopped = _at_rest(drive, _core.advance_hysteresis(drive, last, _core.now(drive, last, inputs)[TWIST_CHANNEL].item()))
    rates = Rates.of(drive, stopped, inputs)
    if abs(stopped[slow.layout.places["input_angle"].start]) > MAX_ANGLE:
        return None
    return stopped if rates.vanishes(slow.rows(rates), 1e-9) else None  # a way without end is none


def _come_to_rest(drive: Drive, start: Array, inputs: Array) -> Array | None:
    """The equilibrium where the drive comes to rest in time; none if it does not within `MAX_TIME_TO_REST`.

    A slow motion one way finds none if the load swings back, or if kinetic friction balances it at no angle nearby.
    """
    from strainwave.simulation.run import simulate
    from strainwave.simulation.scenario import constant

    command, load_torque, temperature = (float(inputs[place]) for place in (0, 2, 4))
    duration = MAX_TIME_TO_REST / TIMES_TO_REST
    held = constant(command, duration)
    now = State.of(drive, start)
    for _ in range(TIMES_TO_REST):
        try:
            with warnings.catch_warnings(action="ignore"):
                run = simulate(drive, held, sample=duration, initial=now, load_torque=load_torque, temperature=temperature)
                now = run.end
        except (ValueError, FloatingPointError):
            return None
        if (resting := _resting(drive, _at_rest(drive, now.numbers), inputs)) is not None:
            return resting
    return None


def _pushed(drive: Drive, state: Array, freed: Array, inputs: Array) -> Array:
    """`freed` with the shaft let go that an integral of the controller, growing on, pushes until it gives way.

    The input, if it sticks; else the output: that of a position loop stays away from its command while the input winds it up.
    """
    layout, pushed, rates = StateLayout(drive), freed.copy(), Rates.of(drive, state, inputs)
    control = layout.places["control"]
    push = np.sign(rates.output[actuation(drive).channel, control] @ rates.rate[control])
    for end, way in (("input", push), ("output", push * np.sign(drive.gear.kinematics.ratio))):
        if freed[layout.places[f"{end}_slip_direction"]] == 0.0:
            pushed[layout.places[f"{end}_slip_direction"]] = way
            break
    return pushed


@dataclass(frozen=True, eq=False)
class _Path(ComparedByFields):
    """A drive that moves from `start` under constant inputs."""

    drive: Drive
    start: Array
    inputs: Array

    @cached_property
    def layout(self) -> StateLayout:
        return StateLayout(self.drive)


class _Slow(_Path):
    """Slow motions, shafts that stick left where they are."""

    @property
    def free(self) -> tuple[bool, bool]:
        """Return True for the input, and for the output, if it may move."""
        places = self.layout.places
        return bool(self.start[places["input_slip_direction"]]), bool(self.start[places["output_slip_direction"]])

    def rows(self, rates: Rates) -> list[int]:
        """The rates that must vanish."""
        motor, (_, within) = range(self.layout.count)[self.layout.places["motor"]], _bodies(self.layout)
        wanted = [*motor, *within, *_needed(self.layout, rates)]
        speeds = [self.layout.places[f"{end}_speed"].start for end in ("input", "output")]
        return wanted + [speed for speed, free in zip(speeds, self.free, strict=True) if free]

    def guess(self) -> Array:
        """Return the initial numbers: the input at its command if it may move, else where it is."""
        numbers, places = self.start[: self.layout.count].copy(), self.layout.places
        if self.free[0] and controls_position(self.drive):
            ratio = self.drive.gear.kinematics.ratio
            at = self.start[places["input_angle"]] + tau * self.start[places["turns"]]
            turned = self.inputs[0] * ratio - at
            numbers[places["input_angle"]] += turned
            numbers[places["transmission_error"]] += 0.0 if self.free[1] else turned / ratio
        return numbers

    def moved(self, numbers: Array) -> Array:
        """Return the state in which friction and sensors have followed the angles; a rest of speed gives the direction."""
        places, count, friction = self.layout.places, self.layout.count, self.layout.friction()[:, 0]
        turned, wound = ((numbers - self.start[:count])[places[name]].item() for name in ("input_angle", "transmission_error"))
        moving = self.start.copy()
        moving[:count] = np.where(friction > 0.0, self.start[:count], numbers)
        moving[places["input_speed"]] = turned / QUASI_STATIC_TIME
        moving[places["output_speed"]] = (
            (turned / self.drive.gear.kinematics.ratio - wound) / QUASI_STATIC_TIME if self.free[1] else 0.0
        )
        return _settled(
            self.drive, _core.relaxed(self.drive, moving, self.inputs, QUASI_STATIC_TIME), self.inputs, _sensing(self.layout)
        )

    def directions(self, rates: Rates) -> Array:
        """Return the free motions in columns; the states of friction and of sensors go with the angles of their shafts."""
        places, count, friction = self.layout.places, self.layout.count, self.layout.friction()
        everything, inverse = np.eye(count), 1.0 / self.drive.gear.kinematics.ratio
        of_friction = friction * rates.by_numbers[:count]
        by_input, by_output = (of_friction[:, places[name]] for name in ("input_speed", "output_speed"))
        turn = everything[:, places["input_angle"]] + by_input + inverse * by_output
        wind = everything[:, places["transmission_error"]] - by_output
        angles = {
            (True, True): [turn, wind],
            (True, False): [turn + inverse * wind],
            (False, True): [wind],
            (False, False): [],
        }[self.free]
        within, _ = _bodies(self.layout)
        moves = np.hstack([everything[:, places["motor"]], everything[:, within], everything[:, places["control"]], *angles])
        return _followed(moves, rates, _sensing(self.layout))


# Running


def _running(drive: Drive, start: Array, inputs: Array) -> Array:
    """The steady running of a drive without kinematic error."""
    if controls_position(drive):
        raise ValueError(
            f"there is no equilibrium at command = {inputs[0]:g} rad, load_torque = {inputs[2]:g} N.m: "
            "motor, spring and friction together cannot hold the load at any angle near it"
        )
    steady = _Steady(drive, start, inputs)
    balance = _balance(steady, steady.at(steady.guess())[: steady.layout.count])
    if balance is None:
        raise ValueError(_unsteady(drive, inputs, "the torques do not balance at any speed"))
    state = steady.moved(balance)
    elsewhere = state.copy()
    elsewhere[steady.layout.places["input_angle"]] += 1.0
    rates = Rates.of(drive, elsewhere, inputs)
    if not rates.vanishes(steady.rows(rates), 1e-9):
        raise ValueError(_unsteady(drive, inputs, "load or friction depends on the angle that the drive turns through"))
    return _core.advance_hysteresis(drive, state, _core.now(drive, state, inputs)[TWIST_CHANNEL].item())


def _unsteady(drive: Drive, inputs: Array, why: str) -> str:
    command, load_torque = f"command = {inputs[0]:g} {command_unit(drive)}", f"load_torque = {inputs[2]:g} N.m"
    return f"the drive cannot rest at {command}, {load_torque}, nor run steadily: {why}"


class _Steady(_Path):
    """Running at constant speed, from the angles of `start`."""

    def rows(self, rates: Rates) -> list[int]:
        """The rates that must vanish; those of friction and of sensors have."""
        places = self.layout.places
        inner = [*_inner(self.layout), *_needed(self.layout, rates)]
        return [*inner, places["input_speed"].start, places["output_speed"].start]

    def at(self, speed: float) -> Array:
        """Running at an input speed [rad/s]."""
        numbers, places = self.start[: self.layout.count].copy(), self.layout.places
        numbers[places["input_speed"]] = speed
        numbers[places["output_speed"]] = speed / self.drive.gear.kinematics.ratio
        return self.moved(numbers)

    def surplus(self, speed: float) -> float:
        """Return the torque that accelerates the whole drive at a speed [N.m], at the input, with spring and motor settled."""
        drive, places, inputs = self.drive, self.layout.places, self.inputs
        state = _settled(drive, self.at(speed), inputs, [*_inner(self.layout), *_sensing(self.layout)])
        rates = Rates.of(drive, state, inputs)
        if not rates.finite:
            raise ValueError(_unsteady(drive, inputs, OVERFLOW_REASON))
        load: Any = drive.load  # one that has an inertia: `check_continuous`
        generator = 0.0 if _bodies(self.layout)[1] else drive.gear.input_inertia  # a body by itself has settled
        inertia = drive.motor.inertia + generator, load.inertia / drive.gear.kinematics.ratio
        of_input, of_output = (rates.rate[places[name]].item() for name in ("input_speed", "output_speed"))
        return float(inertia[0] * of_input + inertia[1] * of_output)

    def guess(self) -> float:
        """The speed that is commanded, if one is; else the lowest at which the whole drive does not accelerate."""
        from scipy.optimize import brentq

        if command_unit(self.drive) == "rad/s":
            return float(self.inputs[0] * self.drive.gear.kinematics.ratio)
        way = next((sense for sense in (1.0, -1.0) if sense * self.surplus(sense / QUASI_STATIC_TIME) > 0.0), 0.0)
        if way == 0.0:
            raise ValueError(_unsteady(self.drive, self.inputs, "friction holds it, but no balance was found"))
        low, high = way / QUASI_STATIC_TIME, 1e-3 * way
        while way * self.surplus(high) > 0.0:
            low, high = high, 2.0 * high
            if abs(high) > _MAX_INPUT_SPEED:
                raise ValueError(_unsteady(self.drive, self.inputs, "nothing limits its speed"))
        return float(brentq(self.surplus, low, high))

    def moved(self, numbers: Array) -> Array:
        """All transients of friction and of sensors gone."""
        state = self.start.copy()
        state[: self.layout.count] = numbers
        relaxed = _core.relaxed(self.drive, _core.consistent(self.drive, state), self.inputs, QUASI_STATIC_TIME)
        return _settled(self.drive, relaxed, self.inputs, _sensing(self.layout))

    def directions(self, rates: Rates) -> Array:
        """Return the free motions in columns; friction and sensors keep their rates."""
        places, count = self.layout.places, self.layout.count
        everything, friction = np.eye(count), np.flatnonzero(self.layout.friction()).tolist()
        run = everything[:, places["input_speed"]] + everything[:, places["output_speed"]] / self.drive.gear.kinematics.ratio
        inner = np.hstack([everything[:, _inner(self.layout)], everything[:, places["control"]]])
        moves = np.hstack([inner, everything[:, places["transmission_error"]], run])
        return _followed(_followed(moves, rates, friction), rates, _sensing(self.layout))


# Both


def _sensing(layout: StateLayout) -> list[int]:
    """Return the places of the sensors' numbers."""
    return [place for place, name in enumerate(layout.names[: layout.count]) if name.startswith("sensors.")]


def _bodies(layout: StateLayout) -> tuple[list[int], list[int]]:
    """Return the places of the displacements of the bodies within the gear, and those of their speeds."""
    places = range(layout.count)[layout.places["structure"]]
    speeds = [place for place in places if layout.names[place].endswith("_speed")]
    return [place for place in places if place not in speeds], speeds


def _inner(layout: StateLayout) -> list[int]:
    """Return the places of the numbers of the motor and of the bodies within the gear."""
    everything = range(layout.count)
    return [*everything[layout.places["motor"]], *everything[layout.places["structure"]]]


def _needed(layout: StateLayout, rates: Rates) -> list[int]:
    """Return the places of the controller's numbers that something else depends on."""
    control = layout.places["control"]
    others = np.delete(rates.by_numbers, control, axis=0)
    return [place for place in range(layout.count)[control] if others[:, place].any()]


def _settled(drive: Drive, state: Array, inputs: Array, places: list[int]) -> Array:
    """The same state with the numbers at `places` where their rates vanish, in which those of motors and sensors are linear."""
    settled = state.copy()
    if places and (rates := Rates.of(drive, state, inputs)).finite:
        settled[places] += _least(rates.by_numbers[places][:, places], -rates.rate[places])
    return settled


def _followed(moves: Array, rates: Rates, places: list[int]) -> Array:
    """The same moves, in columns, with the numbers at `places` moved so that their rates stay as they are."""
    if not places:
        return moves
    followed, count = moves.copy(), len(rates.rate)
    by_themselves, by_moves = rates.by_numbers[places][:, places], (rates.by_numbers[:count] @ moves)[places]
    for column, right in enumerate(by_moves.T):
        followed[places, column] = _least(by_themselves, -right)
    return followed


@np.errstate(over="ignore", invalid="ignore")
def _balance(path: _Slow | _Steady, guess: Array) -> Array | None:
    """The numbers at which the rates in question vanish to rounding, from `guess`; none if there are none.

    Newton's method, each step shortened until it comes closer. Directions that change nothing are not taken.
    """
    numbers = guess
    rates = Rates.of(path.drive, path.moved(numbers), path.inputs)
    if not rates.finite:
        raise ValueError(f"no equilibrium can be found: {OVERFLOW_REASON}")
    for _ in range(100):
        rows = path.rows(rates)
        if rates.vanishes(rows, 1e-15):
            break
        directions = path.directions(rates)
        by_directions = _product(rates.by_numbers[rows], directions)
        step = directions @ _least(by_directions, -rates.rate[rows])
        for share in 0.5 ** np.arange(40):
            trial = Rates.of(path.drive, path.moved(numbers + share * step), path.inputs)
            scale = np.maximum(rates.size, trial.size)
            if trial.finite and np.linalg.norm((trial.rate / scale)[rows]) < np.linalg.norm((rates.rate / scale)[rows]):
                break
        else:
            break
        numbers, rates = numbers + share * step, trial
    return numbers if rates.vanishes(path.rows(rates), 1e-10) else None


def _product(left: Array, right: Array) -> Array:
    """Return the product of two matrices, shapes (m, n) and (n, k); 0 if terms cancel to rounding: no dependence at all."""
    product: Array = left @ right
    return np.where(np.abs(product) > _ROUNDING_SHARE * (np.abs(left) @ np.abs(right)), product, 0.0)


def _least(matrix: Array, right: Array) -> Array:
    """The shortest of the best solutions, rows and unknowns brought to one size."""
    rows = _positive(np.abs(matrix).max(axis=1, initial=0.0))
    scaled, wanted = matrix / rows[:, None], right / rows
    changes = np.abs(scaled).max(axis=0, initial=0.0)
    if not (np.isfinite(scaled).all() and np.isfinite(wanted).all()):
        raise ValueError(f"no equilibrium can be found: {OVERFLOW_REASON}")
    solution = np.linalg.lstsq(scaled / _positive(changes), wanted, rcond=1e-13)[0]
    return np.where(changes > 0.0, solution / _positive(changes), 0.0)


def _positive(size: Array) -> Array:
    return np.where(size > 0.0, size, 1.0)
