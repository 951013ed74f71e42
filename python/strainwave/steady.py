"""The steady view of a drive: where nothing accelerates."""

from __future__ import annotations

from dataclasses import dataclass
from math import tau
from typing import Any

import numpy as np
from numpy.typing import NDArray

from strainwave import _core, arguments, kinematic_error
from strainwave.drives import PositionDrive
from strainwave.equality import ComparedByFields
from strainwave.simulation import ROOM_TEMPERATURE, check_temperature

Array = NDArray[np.float64]
SLOWLY = 1e30  # s: of a motion that takes so long, friction sees the path alone
_NOTHING = 1e-12  # rad/s2, A/s: a term so small takes no part
OVERFLOW = "torques or their derivatives grow beyond all numbers; check the parameters and the inputs"
_FASTEST = 1e9  # rad/s at the input: what nothing has stopped by then, nothing will


def equilibrium(
    drive: PositionDrive,
    *,
    command: float = 0.0,
    load_torque: float = 0.0,
    temperature: float = ROOM_TEMPERATURE,
    start: _core.State | None = None,
) -> _core.State:
    """The state in which nothing accelerates under constant inputs: at rest if there is one, else in steady running.

    Friction and hysteresis hold a drive in many states at rest. The one returned is reached from `start` by a slow motion of
    each shaft one way. A side whose set-valued friction holds it where it is sticks there; one that breaks away comes to rest
    where kinetic friction balances what drives it. Friction and hysteresis with memory remember the way.

    A drive in open loop may run instead. Its state is that at the angles of `start`, at the lowest speed, counted from rest,
    at which nothing accelerates, and without the kinematic error, which comes and goes with every turn.

    Whether the state is stable, the poles of `linearise` tell.

    Args:
        command: output angle [rad] of a drive under position control, voltage [V] of one in open loop
        load_torque: torque that holds the output back [N.m], besides the load's own
        temperature: of the gear [K]
        start: where the way begins, taken at rest; at rest, untwisted, if not given

    Returns:
        A state, for `simulate` to start from or `linearise` to look around in.

    Raises:
        TypeError: an argument is not of its kind
        ValueError: an input is not finite, `temperature` is not positive, there is no equilibrium, or torques grow beyond all
            numbers; says why

    >>> import strainwave as sw
    >>> arm = sw.loads.Pendulum(inertia=0.1, gravity_torque=5.0)
    >>> held = sw.equilibrium(sw.drives.PositionDrive(load=arm), command=0.5)
    >>> held.continuous.input_speed, held.continuous.output_speed
    (0.0, 0.0)
    """
    arguments.drive(drive)
    inputs = constant_inputs(command, load_torque, temperature)
    begin = _at_rest(drive, drive.rest() if start is None else arguments.state("start", start))
    found = _resting(drive, begin, inputs) or _running(averaged(drive), begin, inputs)
    turns = round(found.continuous.input_angle / tau)
    motion = found.continuous.replace(input_angle=found.continuous.input_angle - tau * turns)
    return found.replace(continuous=motion, turns=found.turns + turns)


def constant_inputs(command: float, load_torque: float, temperature: float, command_rate: float = 0.0) -> Array:
    """The inputs in the order of the core, shape (4,), if they make sense."""
    inputs = {"command": command, "command_rate": command_rate, "load_torque": load_torque, "temperature": temperature}
    numbers = [arguments.number(name, value) for name, value in inputs.items()]
    check_temperature(temperature)
    return np.array(numbers)


def _controls_position(drive: PositionDrive) -> bool:
    return drive.control.command_unit == "rad"


def averaged(drive: PositionDrive) -> PositionDrive:
    """The same drive without kinematic error, which is periodic: what is left of it over many turns."""
    gear = drive.gear.replace(kinematic_error=kinematic_error.Fourier(), kinematic_noise=kinematic_error.Stochastic())
    return drive.replace(gear=gear)


# The motion as an array: what a solver moves


_MOTION = {field["name"]: np.shape(getattr(_core.ContinuousState(), field["name"])) for field in _core.ContinuousState.fields}
_ENDS = np.cumsum([int(np.prod(shape)) for shape in _MOTION.values()])
PLACE = {name: slice(end - int(np.prod(_MOTION[name])), end) for name, end in zip(_MOTION, _ENDS.tolist(), strict=True)}
N_MOTION = int(_ENDS[-1])


def numbers_of(state: _core.State) -> Array:
    """The numbers of the motion, shape (N_MOTION,), each member in its `PLACE`."""
    return np.concatenate([np.atleast_1d(getattr(state.continuous, name)) for name in PLACE])


def with_numbers(state: _core.State, numbers: Array) -> _core.State:
    """`state` with this motion."""
    members: dict[str, Any] = {
        name: numbers[place].tolist() if _MOTION[name] else numbers[place].item() for name, place in PLACE.items()
    }
    return state.replace(continuous=_core.ContinuousState(**members))


TWIST = [name for name, _, _ in _core.outputs].index("twist")
_FRICTION = np.zeros((N_MOTION, 1))
for _place in ("friction_input", "friction_mesh", "friction_output"):
    _FRICTION[PLACE[_place]] = 1.0


@dataclass(frozen=True, eq=False)
class Flow(ComparedByFields):
    """Rates of the motion, their derivatives, and the size of the terms that each rate is the sum of, to first order."""

    rate: Array
    by_motion: Array
    by_inputs: Array
    size: Array

    @classmethod
    @np.errstate(over="ignore", invalid="ignore")
    def of(cls, drive: PositionDrive, state: _core.State, inputs: Array) -> Flow:
        values, slopes = _core.differentiate_flow(drive, state, inputs)
        by_motion, by_inputs = np.split(slopes[:, :N_MOTION].T, [N_MOTION], axis=1)
        size = np.abs(by_motion) @ np.abs(numbers_of(state)) + np.abs(by_inputs) @ np.abs(inputs)
        return cls(values[:N_MOTION], by_motion, by_inputs, size + _NOTHING)

    @property
    def finite(self) -> bool:
        """Whether all of its numbers are: no torque is larger than a number can be."""
        return all(bool(np.isfinite(each).all()) for each in (self.rate, self.by_motion, self.by_inputs, self.size))

    def vanishes(self, rows: list[int], share: float) -> bool:
        """Whether these rates are less than a share of what they add up from."""
        return bool((np.abs(self.rate) <= share * self.size)[rows].all())


# At rest


def _at_rest(drive: PositionDrive, state: _core.State) -> _core.State:
    """`state` without its speeds, every side that can stick sticking."""
    motion = state.continuous.replace(input_speed=0.0, output_speed=0.0)
    return _core.consistent(drive, state.replace(continuous=motion, input_slip_direction=0.0, output_slip_direction=0.0))


def _resting(drive: PositionDrive, start: _core.State, inputs: Array) -> _core.State | None:
    """The equilibrium at rest, if there is one: sides that stick are let go until those that still do hold."""
    sliding = start
    while True:
        slow = _Slow(drive, sliding, inputs)
        found = _balance(slow, slow.guess())
        last = slow.moved(slow.guess() if found is None else found)
        freed = _core.break_away(drive, last, inputs)
        integral = Flow.of(drive, last, inputs).rate[PLACE["control"]].item()
        if found is None and freed.input_slip_direction == 0.0:  # the integral grows until the input gives way
            freed = freed.replace(input_slip_direction=float(np.sign(integral)))
        if (freed.input_slip_direction, freed.output_slip_direction) == (
            sliding.input_slip_direction,
            sliding.output_slip_direction,
        ):
            break
        sliding = sliding.replace(
            input_slip_direction=freed.input_slip_direction, output_slip_direction=freed.output_slip_direction
        )
    if found is None:
        return None
    stopped = _at_rest(drive, _core.advance_hysteresis(drive, last, _core.now(drive, last, inputs)[TWIST].item()))
    return stopped if Flow.of(drive, stopped, inputs).vanishes(slow.rows, 1e-9) else None  # a way without end is none


@dataclass(frozen=True, eq=False)
class _Slow(ComparedByFields):
    """Slow motions from `start`, sides that stick left where they are."""

    drive: PositionDrive
    start: _core.State
    inputs: Array

    @property
    def free(self) -> tuple[bool, bool]:
        """Whether input and output may move."""
        return self.start.input_slip_direction != 0.0, self.start.output_slip_direction != 0.0

    @property
    def rows(self) -> list[int]:
        """The rates that must vanish: not that of an integral which nobody asks for."""
        integrates = getattr(self.drive.control, "integral", 0.0) > 0.0
        wanted = {"motor": True, "control": integrates, "input_speed": self.free[0], "output_speed": self.free[1]}
        return [PLACE[name].start for name, want in wanted.items() if want]

    def guess(self) -> Array:
        """Where to begin: where the controller wants the input, if it may move; else here."""
        numbers = numbers_of(self.start)
        if self.free[0] and _controls_position(self.drive):
            ratio = self.drive.gear.kinematics.ratio
            turned = self.inputs[0] * ratio - tau * self.start.turns - self.start.continuous.input_angle
            numbers[PLACE["input_angle"]] += turned
            numbers[PLACE["transmission_error"]] += 0.0 if self.free[1] else turned / ratio
        return numbers

    def moved(self, numbers: Array) -> _core.State:
        """Friction has followed the angles; what is left of their speeds tells which way."""
        origin = numbers_of(self.start)
        turned, wound = ((numbers - origin)[PLACE[name]].item() for name in ("input_angle", "transmission_error"))
        moving = np.where(_FRICTION[:, 0] > 0.0, origin, numbers)
        moving[PLACE["input_speed"]] = turned / SLOWLY
        moving[PLACE["output_speed"]] = (turned / self.drive.gear.kinematics.ratio - wound) / SLOWLY if self.free[1] else 0.0
        return _core.aged(self.drive, with_numbers(self.start, moving), self.inputs, SLOWLY)

    def directions(self, flow: Flow) -> Array:
        """What may move, in columns; the states of friction go with the angles of their shafts."""
        everything, inverse = np.eye(N_MOTION), 1.0 / self.drive.gear.kinematics.ratio
        by_input, by_output = (_FRICTION * flow.by_motion[:, PLACE[name]] for name in ("input_speed", "output_speed"))
        turn = everything[:, PLACE["input_angle"]] + by_input + inverse * by_output
        wind = everything[:, PLACE["transmission_error"]] - by_output
        angles = {
            (True, True): [turn, wind],
            (True, False): [turn + inverse * wind],
            (False, True): [wind],
            (False, False): [],
        }[self.free]
        return np.hstack([everything[:, PLACE["motor"]], everything[:, PLACE["control"]], *angles])


# Running


def _running(drive: PositionDrive, start: _core.State, inputs: Array) -> _core.State:
    """The steady running of a drive without kinematic error."""
    if _controls_position(drive):
        raise ValueError(
            f"there is no equilibrium at command = {inputs[0]:g} rad, load_torque = {inputs[2]:g} N.m: "
            "motor, spring and friction together cannot hold the load at any angle near it"
        )
    steady = _Steady(drive, start, inputs)
    found = _balance(steady, numbers_of(steady.at(steady.guess())))
    if found is None:
        raise ValueError(_unsteady(inputs, "the torques do not balance at any speed"))
    state = steady.moved(found)
    motion = state.continuous
    elsewhere = Flow.of(drive, state.replace(continuous=motion.replace(input_angle=motion.input_angle + 1.0)), inputs)
    if not elsewhere.vanishes(steady.rows, 1e-9):
        raise ValueError(_unsteady(inputs, "load or friction depends on the angle that the drive turns through"))
    return _core.advance_hysteresis(drive, state, _core.now(drive, state, inputs)[TWIST].item())


def _unsteady(inputs: Array, why: str) -> str:
    return f"the drive cannot rest at command = {inputs[0]:g} V, load_torque = {inputs[2]:g} N.m, nor run steadily: {why}"


@dataclass(frozen=True, eq=False)
class _Steady(ComparedByFields):
    """Running at constant speed, from the angles of `start`."""

    drive: PositionDrive
    start: _core.State
    inputs: Array

    @property
    def rows(self) -> list[int]:
        """The rates that must vanish; that of friction has."""
        return [PLACE[name].start for name in ("motor", "input_speed", "output_speed")]

    def at(self, speed: float) -> _core.State:
        """Running at an input speed [rad/s]."""
        numbers = numbers_of(self.start)
        numbers[PLACE["input_speed"]] = speed
        numbers[PLACE["output_speed"]] = speed / self.drive.gear.kinematics.ratio
        return self.moved(numbers)

    def surplus(self, speed: float) -> float:
        """What is left to accelerate the whole drive at a speed, referred to the input [N.m]: spring and current settled."""
        drive = self.drive.replace(motor=self.drive.motor.replace(inductance=0.0))
        flow = Flow.of(drive, self.at(speed), self.inputs)
        if not flow.finite:
            raise ValueError(_unsteady(self.inputs, OVERFLOW))
        rate = flow.rate
        inertia = drive.motor.inertia + drive.gear.input_inertia, drive.load.inertia / drive.gear.kinematics.ratio
        return float(inertia[0] * rate[PLACE["input_speed"]].item() + inertia[1] * rate[PLACE["output_speed"]].item())

    def guess(self) -> float:
        """The lowest speed at which the whole drive does not accelerate."""
        from scipy.optimize import brentq

        way = next((sense for sense in (1.0, -1.0) if sense * self.surplus(sense / SLOWLY) > 0.0), 0.0)
        if way == 0.0:
            raise ValueError(_unsteady(self.inputs, "friction holds it, but no balance was found"))
        low, high = way / SLOWLY, 1e-3 * way
        while way * self.surplus(high) > 0.0:
            low, high = high, 2.0 * high
            if abs(high) > _FASTEST:
                raise ValueError(_unsteady(self.inputs, "nothing limits its speed"))
        return float(brentq(self.surplus, low, high))

    def moved(self, numbers: Array) -> _core.State:
        """All transients of friction gone."""
        return _core.aged(self.drive, _core.consistent(self.drive, with_numbers(self.start, numbers)), self.inputs, SLOWLY)

    def directions(self, flow: Flow) -> Array:
        """What may move, in columns; friction so that its rate stays as it is."""
        everything, friction = np.eye(N_MOTION), np.flatnonzero(_FRICTION)
        run = everything[:, PLACE["input_speed"]] + everything[:, PLACE["output_speed"]] / self.drive.gear.kinematics.ratio
        moves = np.hstack([everything[:, PLACE["motor"]], everything[:, PLACE["transmission_error"]], run])
        by_friction, by_moves = flow.by_motion[friction][:, friction], (flow.by_motion @ moves)[friction]
        for column, right in enumerate(by_moves.T):
            moves[friction, column] = _least(by_friction, -right)
        return moves


# Both


@np.errstate(over="ignore", invalid="ignore")
def _balance(path: _Slow | _Steady, guess: Array) -> Array | None:
    """The numbers at which the rates in question vanish to rounding, from `guess`; none if there are none.

    Newton's method, each step shortened until it comes closer. Directions that change nothing are not taken.
    """
    numbers, rows = guess, path.rows
    flow = Flow.of(path.drive, path.moved(numbers), path.inputs)
    if not flow.finite:
        raise ValueError(f"no equilibrium can be found: {OVERFLOW}")
    for _ in range(100):
        if flow.vanishes(rows, 1e-15):
            break
        directions = path.directions(flow)
        step = directions @ _least(flow.by_motion[rows] @ directions, -flow.rate[rows])
        for share in 0.5 ** np.arange(40):
            trial = Flow.of(path.drive, path.moved(numbers + share * step), path.inputs)
            scale = np.maximum(flow.size, trial.size)
            if trial.finite and np.linalg.norm((trial.rate / scale)[rows]) < np.linalg.norm((flow.rate / scale)[rows]):
                break
        else:
            break
        numbers, flow = numbers + share * step, trial
    return numbers if flow.vanishes(rows, 1e-10) else None


def _least(matrix: Array, right: Array) -> Array:
    """The shortest of the best solutions, rows and unknowns brought to one size."""
    rows = _positive(np.abs(matrix).max(axis=1, initial=0.0))
    scaled, wanted = matrix / rows[:, None], right / rows
    changes = np.abs(scaled).max(axis=0, initial=0.0)
    if not (np.isfinite(scaled).all() and np.isfinite(wanted).all()):
        raise ValueError(f"no equilibrium can be found: {OVERFLOW}")
    solution = np.linalg.lstsq(scaled / _positive(changes), wanted, rcond=1e-13)[0]
    return np.where(changes > 0.0, solution / _positive(changes), 0.0)


def _positive(size: Array) -> Array:
    return np.where(size > 0.0, size, 1.0)
