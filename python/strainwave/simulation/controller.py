"""A run whose controller is a function of Python: called at instants, its result held between them."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from itertools import pairwise
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from strainwave import Drive, _core, arguments, control
from strainwave.files.gear_set import GearSet
from strainwave.files.ratings import drive_of, warn_of_ratings
from strainwave.messages import shortened
from strainwave.native import kernels
from strainwave.progress import Progress, by_count
from strainwave.simulation.excitation import ROOM_TEMPERATURE, TEMPERATURE_PLACE, Excitation
from strainwave.simulation.resolution import remedy, warn_of_bristles
from strainwave.simulation.run import Course, Run, check_meaning, recorded_of
from strainwave.simulation.scenario import Scenario
from strainwave.simulation.state import Initial, beginning_numbers
from strainwave.simulation.time_grid import check_acting

Array = NDArray[np.float64]

MAX_SIGNAL = 1e9  # SI: controllers hold what exceeds it; no signal of a joint does, and its square fits into a float


class Observation(NamedTuple):
    """Observation of a controller at an instant: the time, the command, and the drive through its sensors.

    Attributes:
        time: since the start of the run [s]
        command, command_rate: the command in its unit, and its rate
        input_angle, input_speed: of the input shaft [rad], [rad/s]
        output_angle, output_speed: of the output shaft [rad], [rad/s]
        current: of the motor [A]
        torque: transmitted by the gear, at the output [N.m]
        low, high: the least and the largest actuation that the motor can follow now, in its unit; ±1.8e308 if it has no limits

    >>> import strainwave as sw
    >>> drive = sw.Drive(load=sw.loads.Inertia(inertia=0.01))
    >>> def limited(seen):  # the drive turns its output against its input
    ...     voltage = -60.0 * (seen.command - seen.output_angle) - 0.02 * seen.input_speed
    ...     return min(max(voltage, seen.low), seen.high)
    >>> run = sw.simulate_controlled(drive, limited, sw.scenario.step(amplitude=0.2, duration=0.5), period=1e-3)
    >>> round(float(run["output_angle"][-1]), 3)
    0.198
    """

    time: float
    command: float
    command_rate: float
    input_angle: float
    input_speed: float
    output_angle: float
    output_speed: float
    current: float
    torque: float
    low: float
    high: float


def simulate_controlled(
    drive: Drive | GearSet,
    controller: Callable[[Observation], float],
    command: Scenario,
    dt: float = 2e-4,
    *,
    period: float,
    delay: float = 0.0,
    unit: str = "rad",
    sample: float | None = None,
    load_torque: Scenario | float = 0.0,
    temperature: Scenario | float = ROOM_TEMPERATURE,
    inputs: Mapping[str, Scenario | float] | None = None,
    initial: Initial | None = None,
    record: Sequence[str] | None = None,
    progress: Progress = None,
) -> Run:
    """Run a drive under a controller that is a function of Python.

    The controller is called at t = 0, period, 2 period … as a computer in a joint is. What it returns reaches the motor after
    `delay` and stays until the next result does; before the first it is 0. So this is what `sw.control.Sampled` does around a
    law of the package. What the controller remembers, such as an integral, is its own: an object with `__call__` is one.

    Args:
        drive: what is controlled, in open loop (`sw.control.OpenLoop`): then the motor takes the actuation
        controller: called with an `Observation`; returns the actuation, in the unit of the motor (voltage [V] of a DC motor,
            current [A], torque [N.m])
        command: what the controller is to do over time, in a unit of its choice
        period: time from one call to the next [s]
        delay: time from a call to its effect [s], at most `period`
        unit: of the command
        dt, sample, load_torque, temperature, inputs, initial, record, progress: as for `simulate`

    Returns:
        as `simulate`; the column `command` holds the command, the motor's columns what it made of the actuation

    Raises:
        ValueError: the drive has a controller of its own, `period` is not positive, `delay` lies outside of [0, period], the
            controller returns no finite number, and as `simulate`
        TypeError: the controller cannot be called or returns no number, and as `simulate`
        FloatingPointError, MemoryError: as `simulate`

    Warns:
        RuntimeWarning: steps cannot follow a shaft on its bristles; take a smaller `dt`
        RatingWarning: as `simulate`

    >>> import strainwave as sw
    >>> drive = sw.Drive(load=sw.loads.Inertia(inertia=0.01))
    >>> ratio = drive.gear.kinematics.ratio
    >>> def proportional(seen):
    ...     return 0.5 * (ratio * seen.command - seen.input_angle)
    >>> command = sw.scenario.step(amplitude=0.2, duration=0.5)
    >>> run = sw.simulate_controlled(drive, proportional, command, period=1e-3)
    >>> round(float(run["output_angle"][-1]), 2)
    0.2
    """
    model, drive = drive, drive_of(drive)
    if not isinstance(drive.control, control.OpenLoop):
        raise ValueError("the drive has a controller of its own; give drive.replace(control=sw.control.OpenLoop())")
    if not callable(controller):
        raise TypeError(f"controller = {shortened(controller)} must be a function of what it sees, which returns the actuation")
    dt, period = arguments.seconds("dt", dt), arguments.seconds("period", period)
    delay = arguments.number("delay", delay, "s", "[]", 0.0, period)
    interval = dt if sample is None else arguments.seconds("sample", sample)
    unit = arguments.text("unit", unit)
    recorded = recorded_of(drive, record)
    excitation = Excitation.of(drive, command, load_torque, temperature, inputs)
    state = beginning_numbers(drive, initial, _under(0.0, excitation.first()))
    actions = _actions(command.duration, period, delay)
    excitation.check_laid_out(dt)
    course = Course.of(drive, excitation, recorded, dt, interval, actions)
    longest = course.time_grid.longest
    course.check_steps(0.0, excitation.first()[TEMPERATURE_PLACE])
    inputs_of_steps = excitation.over(course.time_grid.instants)
    with by_count(progress, "simulating", len(inputs_of_steps)) as shown:
        outputs, state = _run(course, state, inputs_of_steps, actions, controller, shown)
    # the command at the samples, in place of the actuation, which the drive itself took
    commanded = np.append(inputs_of_steps[:1, 0, 0], inputs_of_steps[:, 2, 0])[course.time_grid.samples.view(np.bool_)]
    outputs[[name == "command" for name in recorded] + [False] * (len(outputs) - len(recorded))] = commanded
    check_meaning(course.time, recorded, outputs, remedy(longest))
    course.check_steps(course.largest_twist(outputs), excitation.first()[TEMPERATURE_PLACE])
    warn_of_bristles(drive, longest)
    how = f"exponential Runge-Kutta, steps of {longest:g} s, a controller called every {period:g} s"
    run = course.run(outputs, state, how, unit)
    warn_of_ratings(model, run)
    return run


def _run(
    course: Course,
    state: Array,
    inputs: Array,
    actions: Array,
    controller: Callable[[Observation], float],
    shown: Callable[[int], None] | None,
) -> tuple[Array, Array]:
    """The outputs, shape (channels, samples), and the state at the end, under the inputs of each step, shape (steps, 3, 6)."""
    drive, instants = course.drive, course.time_grid.instants
    steps, held, asked, acted = len(inputs), 0.0, 0.0, 0.0
    outputs, first = np.empty((0, 0)), 0
    after = np.clip(np.searchsorted(instants, actions), 1, len(instants) - 1)
    nearer = instants[after] - actions < actions - instants[after - 1]  # some actions coincide up to rounding
    kernels.prepare(drive, "simulate", steps)
    for number, (begin, end) in enumerate(pairwise([*np.where(nearer, after, after - 1).tolist(), steps])):
        if number % 2 == 1:
            held = asked
        else:
            before = _core.measured(drive, state, _under(acted, inputs[begin, 0]))  # what there is just before the instant
            time, (command, rate) = float(instants[begin]), inputs[begin, 0, :2].tolist()
            actuation = controller(Observation(time, command, rate, *before.tolist()))
            asked = arguments.number(f"what the controller returns at t = {time:g} s", actuation)
        if begin == end:
            continue
        acted = held
        if first == 0:
            outputs, first = course.beginning(state, _under(held, inputs[0, 0])), 1
        keep = course.time_grid.samples[begin + 1 : end + 1]
        stretch, acting = instants[begin : end + 1], _under(held, inputs[begin:end])
        method = _core.Method.exponential
        state = _core.simulate(drive, state, stretch, acting, keep, method, course.channels, outputs, first)
        first += int(np.count_nonzero(keep))
        if shown is not None:
            shown(end)
    kernels.note(drive, "simulate", steps)
    return outputs, state


def _actions(duration: float, period: float, delay: float) -> Array:
    """Return the instants at which the controller is called and at which its result arrives, in turns [s]."""
    check_acting(duration, period)
    calls = period * np.arange(int(duration / period) + 1)
    actions: Array = np.stack([calls, calls + delay], axis=1).ravel()
    return actions[actions < duration * (1.0 - 1e-12)]


def _under(actuation: float, inputs: Array) -> Array:
    """The same inputs, shape (..., 6), with an actuation that is held in place of the command."""
    acting = inputs.copy()
    acting[..., :2] = actuation, 0.0
    return acting
