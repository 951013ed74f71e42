"""Predictive control of the position: a quadratic program each period, with limits that a state feedback does not have."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from strainwave import Drive, arguments
from strainwave.files.gear_set import GearSet
from strainwave.messages import shortened
from strainwave.simulation.controller import MAX_SIGNAL, Observation
from strainwave.simulation.scenario import Scenario
from strainwave.tuning.cascade import Plant
from strainwave.tuning.linear_plant import LinearPlant, optimal

Array = NDArray[np.float64]

SOLVER_TOLERANCE = 1e-4  # in efforts and in shares of a limit
RELATIVE_TOLERANCE = 1e-6  # of its largest gradient, which is some 10^4 where a limit acts
STEP_SIZE = 1.0  # rho of the solver, where it begins, and where it stays in C
MAX_ITERATIONS = 4000
MAX_TIME_ERROR_SHARE = 1e-6  # of the period, from one call to the next
LIMIT_ERROR = 1.0  # rad of the output: an error that is as bad as a limit exceeded by its own size
SOLVED, NEARLY_SOLVED = 1, 2  # by OSQP


@dataclass(frozen=True)
class Program:
    r"""A quadratic program whose data depend linearly on what is known at an instant.

    .. math:: \min_{x, s} \tfrac{1}{2} x^T P x + (Q p)^T x + \tfrac{1}{2} \mu s^T s, \quad |A x + R p - s| \le b

    with x the actuations of the horizon in efforts; A x + R p those actuations, then each sum of states that is limited, in
    limits, over the horizon; s what exceeds b, 0 for the actuations; p the measured states, the actuation before, the bias of
    the states, then angle and rate of the command at each instant after now.

    Attributes:
        cost, gradient: P, shape (horizon, horizon), and Q, shape (horizon, parameters)
        free: -P^-1 Q, of the solution without limits, shape (horizon, parameters)
        rows, shift: A, shape (m, horizon), and R, shape (m, parameters)
        bound: b, shape (m,)
        penalty: mu
    """

    cost: Array
    gradient: Array
    free: Array
    rows: Array
    shift: Array
    bound: Array
    penalty: float

    @property
    def horizon(self) -> int:
        """Number of actuations that are planned."""
        return len(self.cost)

    def solver(self) -> Any:
        """Return the solver."""
        try:
            import osqp
        except ImportError:
            raise ImportError("predictive control solves by osqp: pip install 'strainwave[predictive]'") from None
        from scipy import sparse

        solver = osqp.OSQP()
        limited = len(self.rows) - self.horizon
        exceeded = np.eye(len(self.rows), limited, -self.horizon) / np.sqrt(self.penalty)  # costs its square
        solver.setup(
            sparse.block_diag((sparse.triu(self.cost), sparse.eye(limited)), format="csc"),
            np.zeros(self.horizon + limited),
            sparse.csc_matrix(np.hstack((self.rows, -exceeded))),
            -self.bound,
            self.bound,
            verbose=False,
            warm_starting=True,
            eps_abs=SOLVER_TOLERANCE,
            eps_rel=RELATIVE_TOLERANCE,
            rho=STEP_SIZE,
            max_iter=MAX_ITERATIONS,
        )
        return solver


class PredictiveController:
    """Controller for `simulate_controlled` that predicts the motion; `predictive` makes one.

    Attributes:
        drive: with an ideal current loop and without a controller, for `simulate_controlled`
        period, delay: of the controller [s]
        gains: of the states and the actuation before, where no limit acts
        states: names of those states
        unsolved: number of periods since the begin in which the solver ran out of iterations
        bad_samples: number of calls since the begin with a signal that is not finite or larger than 1e9; its last good value
            replaces it

    >>> import strainwave as sw
    >>> gear = sw.Gear(stiffness=sw.stiffness.Linear(k=1e4), damping=5.0)
    >>> joint = sw.Drive(gear=gear, motor=sw.motor.TorqueSource(inertia=1e-4), load=sw.loads.Inertia(inertia=0.5))
    >>> controller = sw.tuning.mpc(joint, error=1e-3, effort=0.5)
    >>> run = sw.simulate_controlled(controller.drive, controller, sw.scenario.step(0.1, 0.05), period=controller.period)
    >>> controller.states, controller.unsolved
    (('input_angle', 'input_speed', 'transmission_error', 'output_speed'), 0)
    """

    def __init__(self, plant: Plant, program: Program, model: PredictiveModel, preview: Scenario | None, share: float) -> None:
        self.drive = plant.drive
        self.period, self.delay = plant.period, plant.delay
        self.gains, self.states = model.gains, model.linear.states
        self._ratio, self._effort = plant.ratio, model.effort
        self._program, self._model, self._preview, self._share = program, model, preview, share
        self.reset()

    def reset(self) -> None:
        """Forget the motion so far, and what the solver began with."""
        self._solver = self._program.solver()
        self.unsolved = self.bad_samples = 0
        self._good = Observation(*np.zeros(len(Observation._fields)).tolist())
        self._plan = np.zeros(self._program.horizon)
        self._bias = np.zeros(len(self.states))
        self._predicted = np.zeros(len(self.states) + 1)
        self._time: float | None = None

    def __call__(self, seen: Observation) -> float:
        """Return the actuation, in the unit of the motor of `drive`.

        Raises:
            ValueError: the last call was not a period before
        """
        if seen.time == 0.0:
            self.reset()
        late = 0.0 if self._time is None else seen.time - self._time - self.period
        if abs(late) > MAX_TIME_ERROR_SHARE * self.period:
            raise ValueError(
                f"the controller is called {self.period + late:g} s after the last call, and its design has a period of "
                f"{self.period:g} s; simulate it with period=controller.period, delay=controller.delay"
            )
        seen = self._held(seen)
        parameters = np.concatenate((self._measured(seen), self._bias, *self._commanded(seen)))
        self._plan = self._planned(parameters)
        actuation = float(self._plan[0]) * self._effort
        self._predicted = self._model.step @ parameters[: len(self._predicted)] + self._model.input * actuation
        self._time = seen.time
        return actuation

    def generate_c(self, folder: str | Path) -> Path:
        """Write the controller as C without heap: the solver by OSQP's own generator, and `predictive.h`, `predictive.c`.

        `predictive_step` returns the actuation, as a call of this object does. The caller gives it angle and rate of the
        command over the horizon. All is in double precision; the solver does not adapt its step size there.

        Args:
            folder: is made where there is none; files of these names are overwritten

        Returns:
            the folder

        Raises:
            OSError: the folder cannot be written
        """
        from strainwave.tuning.predictive_c import write_c

        solver = self._program.solver()
        path = Path(folder)
        path.mkdir(parents=True, exist_ok=True)
        generator = {"printing_enable": False, "profiling_enable": False, "interrupt_enable": False}
        solver.codegen(str(path), parameters="vectors", force_rewrite=True, compile=False, **generator)
        constants = {"ratio": self._ratio, "effort": self._effort, "share": self._share}
        program = self._program
        arrays = {"step": self._model.step, "input": self._model.input, "free_plan": program.free}
        arrays |= {name: getattr(program, name) for name in ("gradient", "rows", "shift", "bound")}
        write_c(path, self.states, self._program.horizon, constants, arrays)
        return path

    def _planned(self, parameters: Array) -> Array:
        """Return the actuations of the horizon in efforts. Where no limit acts, they need no solver."""
        program, shift = self._program, self._program.shift @ parameters
        free = program.free @ parameters
        if np.all(np.abs(program.rows @ free + shift) <= program.bound):
            return np.asarray(free)
        gradient = np.zeros(len(program.rows))
        gradient[: program.horizon] = program.gradient @ parameters
        self._solver.update(q=gradient, l=-program.bound - shift, u=program.bound - shift)
        solution = self._solver.solve(raise_error=False)
        if solution.info.status_val not in (SOLVED, NEARLY_SOLVED):
            self.unsolved += 1
            return np.append(self._plan[1:], self._plan[-1])
        limit = program.bound[0]
        return np.asarray(np.clip(solution.x[: program.horizon], -limit, limit))

    def _held(self, seen: Observation) -> Observation:
        """Return what is seen, with the last good value in place of each bad one."""
        held = Observation(*(value if abs(value) <= MAX_SIGNAL else good for value, good in zip(seen, self._good, strict=True)))
        self.bad_samples += held[:-2] != seen[:-2]  # no limits count as limits here
        self._good = held
        return held

    def _measured(self, seen: Observation) -> Array:
        """Return the states and the actuation before, after the bias of the states has been estimated from them."""
        values = {
            "input_angle": seen.input_angle,
            "input_speed": seen.input_speed,
            "output_speed": seen.output_speed,
            "transmission_error": seen.input_angle / self._ratio - seen.output_angle,
        }
        states = np.array([values[name] for name in self.states])
        if self._time is not None:
            self._bias += self._share * (states - self._predicted[:-1] - self._bias)
        return np.append(states, self._predicted[-1])

    def _commanded(self, seen: Observation) -> tuple[Array, Array]:
        """Return angle and rate of the command at the instants of the horizon."""
        ahead = self.period * np.arange(1, self._program.horizon + 1)
        if self._preview is None:
            return np.asarray(seen.command + seen.command_rate * ahead), np.full(len(ahead), seen.command_rate)
        time = np.minimum(seen.time + ahead, self._preview.duration)
        return np.asarray(self._preview.value(time)), np.asarray(self._preview.rate(time))


@dataclass(frozen=True)
class PredictiveModel:
    """The drive over one period, and what its controller weighs.

    Attributes:
        linear: in continuous time
        step, input: of the states and the actuation before, over a period
        weight: of the states, shape (n, n), in squares of the effort
        effort: of the motor
        value: cost of what is left after the horizon without limits, shape (n + 1, n + 1)
        gains: K of u = -K z that minimises it
        target_of_bias, target_of_rate: states and actuation at rest and in steady motion, per bias and per rate of the command
    """

    linear: LinearPlant
    step: Array
    input: Array
    weight: Array
    effort: float
    value: Array
    gains: Array
    target_of_bias: Array
    target_of_rate: Array

    @classmethod
    def of(cls, plant: Plant, linear: LinearPlant, weight: Array, effort: float) -> PredictiveModel:
        """"""
        step, driven = linear.held(plant.period, plant.delay).extended
        value, gains = optimal(step, driven, weight, effort)
        held = linear.held(plant.period)
        count = len(held.step)
        steady = np.zeros((count + 1, count + 1))
        steady[:count, :count], steady[:count, count], steady[count, :count] = (
            np.eye(count) - held.step,
            -held.now,
            linear.output,
        )
        of_bias: Array = np.asarray(np.linalg.solve(steady, np.eye(count + 1, count)), dtype=np.float64)
        moved = plant.period * plant.ratio * _unit(linear.states, "input_angle")
        return cls(linear, step, driven, weight, effort, value, gains, of_bias, -of_bias @ moved)


def mpc(
    drive: GearSet | Drive | str | Path,
    *,
    period: float = 1e-3,
    delay: float = 0.0,
    horizon: int = 40,
    error: float = 1e-4,
    effort: float | None = None,
    speed_error: float | None = None,
    speed_limit: float | None = None,
    torque_limit: float | None = None,
    bandwidth: float = 50.0,
    preview: Scenario | None = None,
) -> PredictiveController:
    r"""Return a predictive controller of the position, which keeps within limits of the motor, the input speed and the gear.

    .. math:: \min \sum_{k=1}^{N} \|z_k - z^*_k\|_Q^2 + \sum_{k=0}^{N-1} (u_k - u^*_k)^2 / u_0^2 + \|z_N - z^*_N\|_P^2, \quad
              |u_k| \le u_{max}, \; |\omega_k| \le \omega_{max}, \; |T_k| \le T_{max}

    over the next N = horizon periods, with the weights of `regulator` and P the cost of its regulator from there on: where no
    limit acts, it is that regulator. z* and u* are the steady motion along the command, with a bias of each state that is
    estimated from the difference of what was predicted and measured, first order with the bandwidth: friction, weight and
    other constant disturbances leave no error. The limits of speed and torque are soft, so that there always is a solution:
    exceeding one by its own size is as bad as an error of 1 rad.

    It measures angle and speed of both shafts. Its model is linear, with the secant of the spring to the torque limit. So the
    torque is kept as far as that predicts it: hysteresis, and stiffness times kinematic error, come on top. The solver is OSQP,
    which `pip install 'strainwave[predictive]'` installs.

    Source: RawlingsMayneDiehl2017, sections 1.3 (regulator as its end) and 1.5 (bias); StellatoBanjacGoulartBemporadBoyd2020.

    Args:
        drive: with motor and load: a set, a drive, or the name or path of a file
        period, delay: of the controller [s]
        horizon: periods that are planned, 1 to 500
        error: of the output angle [rad], as bad as the effort
        effort: of the motor, in what it takes [A] or [N.m]; a tenth of its limit if not given
        speed_error: of the output [rad/s]; its speed does not count if not given
        speed_limit: largest speed of the input [rad/s]
        torque_limit: largest torque of the gear, at the output [N.m]
        bandwidth: of the estimate of the bias [rad/s]; 0 for none
        preview: the command, if it is known beforehand; otherwise it is continued at its rate

    Returns:
        The controller, a function for `simulate_controlled`; its `drive` is the drive to simulate.

    Raises:
        ImportError: osqp is not installed
        TypeError: an argument is not of its kind
        ValueError: as `compensate`; or the states of the gear are more than angle and speed of both shafts

    >>> import strainwave as sw
    >>> gear = sw.Gear(stiffness=sw.stiffness.Linear(k=1e4), damping=5.0)
    >>> joint = sw.Drive(gear=gear, motor=sw.motor.TorqueSource(inertia=1e-4), load=sw.loads.Inertia(inertia=0.5))
    >>> controller = sw.tuning.mpc(joint, error=1e-3, effort=0.5, torque_limit=20.0)
    >>> run = sw.simulate_controlled(controller.drive, controller, sw.scenario.step(0.1, 0.5), period=controller.period)
    >>> bool(abs(run["output_angle"][-1] - 0.1) < 1e-5), bool(abs(run["torque"]).max() < 20.5)
    (True, True)
    """
    plant = Plant.read(drive, period, delay)
    horizon = arguments.whole("horizon", horizon, 1, 500)
    if preview is not None and not isinstance(preview, Scenario):
        raise TypeError(
            f"preview must be a scenario of the command, as sw.scenario.table(…) makes one, not {shortened(preview)}"
        )
    if preview is not None:
        preview.check_unit("preview", "rad")
    if torque_limit is not None:
        torque_limit = arguments.number("torque_limit", torque_limit, "N.m", low=0.0)
    linear = LinearPlant.of(plant, torque_limit).measured_by_encoders()
    size = 0.1 * plant.limit if effort is None else arguments.number("effort", effort, plant.effort_unit, low=0.0)
    bandwidth = arguments.number("bandwidth", bandwidth, "rad/s", "[)", 0.0)
    model = PredictiveModel.of(plant, linear, linear.cost(error, speed_error), size)
    program = _program(plant, model, _limits(linear, speed_limit, torque_limit), horizon, (LIMIT_ERROR / error) ** 2)
    return PredictiveController(plant, program, model, preview, -float(np.expm1(-bandwidth * plant.period)))


def _limits(linear: LinearPlant, speed_limit: float | None, torque_limit: float | None) -> list[Array]:
    """Return the sums of the states that are limited, each in its limit."""
    limits: list[Array] = []
    if speed_limit is not None:
        limit = arguments.number("speed_limit", speed_limit, "rad/s", low=0.0)
        limits.append(_unit(linear.states, "input_speed") / limit)
    if torque_limit is not None:
        limits.append(linear.torque / torque_limit)
    return limits


def _program(plant: Plant, model: PredictiveModel, limits: Sequence[Array], horizon: int, penalty: float) -> Program:
    """Return the program over a horizon, with sums of states that are limited to 1."""
    count, size = len(model.step), len(model.step) - 1
    parameters = count + size + 2 * horizon
    angle, rate = count + size, count + size + horizon  # where the command begins in the parameters
    free, forced = np.eye(count, parameters), np.zeros((count, horizon))  # z_k by the parameters and by the actuations
    base = np.append(plant.ratio * _unit(model.linear.states, "input_angle"), 0.0)
    cost, gradient = np.eye(horizon), np.zeros((horizon, parameters))
    whole = np.zeros((count, count))
    whole[:size, :size] = model.weight
    by_plan: list[Array] = [np.eye(horizon)]
    by_known: list[Array] = [np.zeros((horizon, parameters))]
    for k in range(horizon):
        free, forced = model.step @ free, model.step @ forced
        free[:size, count : count + size] += np.eye(size)
        forced[:, k] += model.input * model.effort
        target = np.zeros((count, parameters))
        target[:, count : count + size] = model.target_of_bias
        target[:, rate + k] = model.target_of_rate
        gradient[k] -= target[-1] / model.effort
        target[:, angle + k] = base
        by = model.value if k == horizon - 1 else whole
        cost += forced.T @ by @ forced
        gradient += forced.T @ by @ (free - target)
        by_plan += [(sum_of @ forced[:size])[np.newaxis] for sum_of in limits]
        by_known += [(sum_of @ free[:size])[np.newaxis] for sum_of in limits]
    rows, shift = np.vstack(by_plan), np.vstack(by_known)
    bound = np.ones(len(rows))
    bound[:horizon] = plant.limit / model.effort
    return Program(cost, gradient, -np.asarray(np.linalg.solve(cost, gradient), dtype=np.float64), rows, shift, bound, penalty)


def _unit(states: Sequence[str], name: str) -> Array:
    """Return the sum of the states that is one of them."""
    return np.array([float(each == name) for each in states])
