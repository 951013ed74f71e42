"""Command in, recording out: a drive run through time."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import partial
from typing import Any, Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

from strainwave import Drive, _core, arguments
from strainwave.files.gear_set import GearSet
from strainwave.files.ratings import drive_of, warn_of_ratings
from strainwave.files.recording import GENERATED_TITLE, Recording
from strainwave.messages import listed
from strainwave.native import kernels
from strainwave.progress import Progress, by_count
from strainwave.simulation import signals
from strainwave.simulation.excitation import ROOM_TEMPERATURE, TEMPERATURE_PLACE, Excitation
from strainwave.simulation.resolution import (
    FASTEST_ON_BRISTLES,
    LARGEST_OUTPUT,
    check_resolution,
    diverged,
    remedy,
    warn_of_bristles,
)
from strainwave.simulation.scenario import Scenario
from strainwave.simulation.signals import TWIST_CHANNEL, Output
from strainwave.simulation.state import Initial, State, beginning_numbers, known
from strainwave.simulation.threads import StepCounter, side_by_side
from strainwave.simulation.time_grid import (
    BYTES_PER_STEP,
    LONG_RUN,
    LONGER_STEPS,
    STEPS_PER_CHUNK,
    TimeGrid,
    check_instants,
    check_room,
    grid,
    room_for,
)

Array = NDArray[np.float64]
Method = Literal["exponential", "moreau_jean", "rosenbrock"]

METHOD_WORDS: dict[Method, str] = {
    "exponential": "exponential Runge-Kutta",
    "moreau_jean": "Moreau-Jean time-stepping",
    "rosenbrock": "Rosenbrock W-method",
}
SAMPLE_LESS = "sample less often, or record fewer outputs"
MAX_STEPS_PER_FIXED_STEP = 1000  # adaptive steps of bristles that are too fast for fixed ones
MAX_STEPS_OF_SHORT_RUN = 100_000  # adaptive steps


class Run(Recording):
    """Recording of a simulation, with its method and its end.

    Attributes:
        end: the state at the end, from which another simulation can start
        method: how steps were taken, in words

    >>> import strainwave as sw
    >>> drive = sw.Drive(load=sw.loads.Inertia(inertia=0.01))
    >>> run = sw.simulate(drive, sw.scenario.constant(5.0, duration=0.1))
    >>> further = sw.simulate(drive, sw.scenario.constant(0.0, duration=0.1), initial=run.end)
    >>> [round(float(each["output_speed"][0]), 3) for each in (run, further)], run.unit("output_speed")
    ([0.0, -1.066], 'rad/s')
    """

    end: State
    method: str

    def __init__(self, columns: Mapping[str, Array], units: Mapping[str, str], end: State, method: str) -> None:
        super().__init__(columns, units, title=f"{GENERATED_TITLE}: {method}")
        self._came_about(end, method)

    @classmethod
    def _made(
        cls,
        drive: Drive,
        time: Array,
        recorded: Mapping[str, Output],
        outputs: Array,
        end: State,
        method: str,
        unit: str | None = None,
    ) -> Run:
        """Make a run of checked outputs; a second check would take a quarter of a call."""
        units = signals.units(drive, recorded.values())
        if unit is not None and "command" in units:
            units["command"] = unit
        run = object.__new__(cls)
        run._hold(columns_of(time, recorded, outputs), units, f"{GENERATED_TITLE}: {method}")
        run._came_about(end, method)
        return run

    def __reduce__(self) -> tuple[Any, ...]:
        return Run, (dict(self.columns), dict(self.units), self.end, self.method)

    def _came_about(self, end: State, method: str) -> None:
        object.__setattr__(self, "end", end)
        object.__setattr__(self, "method", method)


def simulate(
    drive: Drive | GearSet,
    command: Scenario,
    dt: float | str = 2e-4,
    *,
    sample: float | str | None = None,
    load_torque: Scenario | float | str = 0.0,
    temperature: Scenario | float | str = ROOM_TEMPERATURE,
    inputs: Mapping[str, Scenario | float | str] | None = None,
    initial: Initial | None = None,
    record: Sequence[str] | None = None,
    method: Method | None = None,
    progress: Progress = None,
) -> Run:
    """Run a drive through a command and record its outputs.

    Steps end at every jump of the inputs. With set-valued friction they are cut at its events, located to rounding, so that
    sticking is exact. The end of a step determines its events: a side whose speed changes its sign and is back before the
    end is taken to slide on, one that sets off and stops before to stick on.

    Args:
        drive: what is commanded; of a gear set its drive
        command: output angle [rad] of a drive under position control; in open loop what its motor takes, as a voltage [V]
        dt: largest step [s] where steps are fixed
        sample: distance of samples in the recording [s]; `dt` if not given
        load_torque: torque that holds the output back [N.m], besides the load's own
        temperature: of the gear [K], for friction that depends on it
        inputs: those and other inputs that parts take, by name: {"output_angle": ...} where the load prescribes that [rad]
        method: "exponential", a Runge-Kutta method of fourth order that lets bristles relax exactly; "rosenbrock", a W-method
            of third order for shafts that rest on stiff bristles without turning round; "moreau_jean", time-stepping of second
            order that looks for no events, however many there are. If not given it is the first, unless a shaft vibrates on
            its bristles faster than steps of `dt` can follow: then steps are chosen as by `simulate_adaptively`, with its
            tolerances; at most a thousand for each of `dt`, or a hundred thousand if that is more.
        initial: where the drive begins; at rest, untwisted, if not given. A state, as `end` of another run of a drive with the
            same models; or some of input_angle, output_angle [rad], input_speed, output_speed [rad/s], twist [rad], torque
            [N.m], current [A], as in {"output_angle": 0.3, "input_speed": 5.0}. The rest follows: one angle or speed
            from the other; the twist as the one at which load and friction do not accelerate the output; bristles, motor and
            sensors as they are once they have settled
        record: the outputs to keep, by name; all, if not given
        progress: None shows a bar on a terminal after a second, True at once, False none; a function is called with a stage
            and the share done

    Returns:
        Recording with columns time [s], command, input_angle [rad], input_speed [rad/s], output_angle [rad], output_speed
        [rad/s], twist [rad], kinematic_error [rad], transmission_error [rad], torque [N.m], what the motor shows of itself (a
        DC motor current [A] and voltage [V]), friction_input [N.m], friction_mesh [N.m], friction_output [N.m], load_torque
        [N.m], temperature [K], or of these what `record` names, each of shape (n,); the first sample is at t = 0. Its `end` is
        the state at the end, its `method` describes the steps.

    Raises:
        TypeError: an argument is not of its kind
        ValueError: an input or output that the drive does not have, `dt`, `sample` or `temperature` is not positive, an input
            lasts another time than `command`, `method` is not known, or the drive leaves the range in which one of its parts is
            valid; the message names the part, the place and the time
        FloatingPointError: the trajectory diverged, or `dt` cannot follow the gear's vibration or its damping; the message
            gives the time and the remedy. Where bristles ask for adaptive steps, as `simulate_adaptively`
        MemoryError: the steps or the samples are too many; the message gives their size and the remedy

    Warns:
        RuntimeWarning: a `method` was asked for whose steps cannot follow a shaft on its bristles
        RatingWarning: a run of a gear set exceeded one of its ratings (`check_ratings`); one for each

    >>> import strainwave as sw
    >>> drive = sw.Drive(load=sw.loads.Inertia(inertia=0.01))
    >>> run = sw.simulate(drive, sw.scenario.step(amplitude=5.0, duration=0.1))
    >>> run.unit("output_angle"), len(run)
    ('rad', 501)
    >>> run.method
    'exponential Runge-Kutta, steps of 0.0002 s'
    """
    if method is not None:
        arguments.one_of("method", method, METHOD_WORDS)
    model, drive = drive, drive_of(drive)
    dt = arguments.seconds("dt", dt)
    interval = dt if sample is None else arguments.seconds("sample", sample)
    recorded = recorded_of(drive, record)
    excitation = Excitation.of(drive, command, load_torque, temperature, inputs)
    state = beginning_numbers(drive, initial, excitation.first())
    course = Course.of(drive, excitation, recorded, dt, interval, signals.instants(drive, state, command.duration))
    time_grid = course.time_grid
    if method is None and time_grid.longest * _core.bristle_frequency(drive) > FASTEST_ON_BRISTLES:
        run = simulate_adaptively(
            drive,
            command,
            sample=interval,
            load_torque=load_torque,
            temperature=temperature,
            inputs=inputs,
            initial=initial,
            record=record,
            max_steps=max(MAX_STEPS_OF_SHORT_RUN, MAX_STEPS_PER_FIXED_STEP * (len(time_grid.instants) - 1)),
            progress=progress,
        )
        warn_of_ratings(model, run)
        return run
    if method != "rosenbrock":  # whoever asks for it may want vibrations that a step cannot follow damped
        course.check_steps(0.0, excitation.first()[TEMPERATURE_PLACE])
    taken = method or "exponential"
    outputs, first, steps = course.beginning(state, excitation.first()), 1, len(time_grid.instants) - 1
    with kernels.prepared(drive, "simulate", steps), by_count(progress, "simulating", steps) as shown:
        for number, (instants, keep) in enumerate(time_grid.chunks()):
            report = None if shown is None else lambda done, n=number, show=shown: show(n * STEPS_PER_CHUNK + done)
            laid_out, steps_by = excitation.over(instants), _core.Method[taken]
            state = _core.simulate(drive, state, instants, laid_out, keep, steps_by, course.channels, outputs, first, report)
            first += int(np.count_nonzero(keep))
    check_meaning(course.time, recorded, outputs, remedy(time_grid.longest))
    if method != "rosenbrock":
        course.check_steps(course.largest_twist(outputs), excitation.first()[TEMPERATURE_PLACE])
    warn_of_bristles(drive, time_grid.longest)
    run = course.run(outputs, state, f"{_named(taken, drive)}, steps of {time_grid.longest:g} s")
    warn_of_ratings(model, run)
    return run


class Course(NamedTuple):
    """Arguments of a run with steps of its own choice, without its initial state: the steps, and the recorded outputs.

    Attributes:
        drive: what runs
        time_grid: steps and samples
        time: of the samples [s]
        recorded: the outputs that the recording has, by name
        channels: theirs, and that of the twist, which determines whether steps were short enough
    """

    drive: Drive
    time_grid: TimeGrid
    time: Array
    recorded: Mapping[str, Output]
    channels: list[int]

    @classmethod
    def of(
        cls, drive: Drive, excitation: Excitation, recorded: Mapping[str, Output], dt: float, interval: float, instants: Array
    ) -> Course:
        """Return the course with steps of at most `dt`, samples at `interval` and steps that also end at `instants` [s]."""
        channels = channels_of(recorded)
        duration = excitation.command.duration
        check_instants(duration, dt, LONGER_STEPS)
        check_room("steps", duration / dt, BYTES_PER_STEP, LONG_RUN)
        check_samples(duration, interval, len(channels))
        time_grid = excitation.time_grid(dt, interval, instants)
        return cls(drive, time_grid, time_grid.times, recorded, channels)

    def beginning(self, state: Array, first: Array) -> Array:
        """Room for the outputs, that of the start filled in, under the inputs `first`."""
        return beginning(self.drive, state, first, self.channels, len(self.time))

    def check_steps(self, twist: float, temperature: float) -> None:
        """Refuse steps that cannot follow the drive at a twist [rad], as warm as it begins at a temperature [K]."""
        check_resolution(self.drive, self.time_grid.longest, twist, temperature)

    def largest_twist(self, outputs: Array) -> float:
        return float(np.abs(outputs[self.channels.index(TWIST_CHANNEL)]).max())

    def run(self, outputs: Array, state: Array, method: str, unit: str | None = None) -> Run:
        """The run that ends in a state, with a unit of the command where it is not the drive's own."""
        end = _finite(State.of(self.drive, state), remedy(self.time_grid.longest))
        return Run._made(self.drive, self.time, self.recorded, outputs, end, method, unit)


def recorded_of(drive: Drive, record: Sequence[str] | None) -> Mapping[str, Output]:
    """The outputs that `record` names; all, if it is not given."""
    return signals.outputs(drive) if record is None else signals.chosen(drive, record)


def check_samples(duration: float, interval: float, columns: float) -> None:
    """Refuse samples that no memory holds, before a grid is laid out for them."""
    check_instants(duration, interval, SAMPLE_LESS)
    check_room("samples", duration / interval, 8.0 * columns, SAMPLE_LESS)


def channels_of(recorded: Mapping[str, Output]) -> list[int]:
    """Return the channels of the recorded outputs and of the twist, which determines whether steps were short enough."""
    channels = [output.channel for output in recorded.values()]
    return channels if TWIST_CHANNEL in channels else [*channels, TWIST_CHANNEL]


def beginning(drive: Drive, state: Array, first: Array, channels: Sequence[int], samples: int) -> Array:
    """Room for the outputs of a run, shape (channels, samples), that of the start filled in, under the inputs `first`.

    There each side slides or sticks as the friction of this drive has it, whatever drive the state comes from, and a sampled
    controller has acted if it was due.
    """
    with room_for("samples", samples, 8.0 * len(channels), SAMPLE_LESS):
        outputs = np.empty((len(channels), samples))
    outputs[:, 0] = _core.now(drive, _core.begin(drive, state, first), first)[list(channels), 0]
    return outputs


def _named(method: Method, drive: Drive) -> str:
    """A method in words, as it is where friction of the drive holds its place at rest or does not."""
    return METHOD_WORDS[method] + (", cut at events" if _core.has_events(drive) and method != "moreau_jean" else "")


def simulate_adaptively(
    drive: Drive | GearSet,
    command: Scenario,
    rtol: float = 1e-6,
    atol: float = 1e-12,
    *,
    sample: float = 1e-3,
    load_torque: Scenario | float | str = 0.0,
    temperature: Scenario | float | str = ROOM_TEMPERATURE,
    inputs: Mapping[str, Scenario | float | str] | None = None,
    initial: Initial | None = None,
    record: Sequence[str] | None = None,
    max_steps: int = 10_000_000,
    progress: Progress = None,
) -> Run:
    """Run a drive through a command in steps as long as a tolerance allows.

    The steps are those of `simulate`'s exponential method. Each ends where a side stops, breaks away or turns round; two of
    half the length estimate its error. Samples lie anywhere within steps: there a step of part of the length gives the state,
    as exactly as at the ends.

    Args:
        drive, command, load_torque, temperature, inputs, initial, record, progress: as
            for `simulate`
        rtol: error tolerated in each member of the motion (input angle within its turn, transmission error, both speeds,
            current, state of the controller, bristles) and in the torque, relative to the largest it has been so far
        atol: error tolerated besides, in the unit of each
        sample: distance of samples in the recording [s]
        max_steps: after how many the run gives up. One takes some microseconds; where friction chatters, or laws with many
            states stick and slip, up to a millisecond

    Returns:
        as `simulate`; `method` contains the counts of steps and of those given up for shorter ones

    Warns:
        RatingWarning: as `simulate`

    Raises:
        TypeError: as `simulate`
        ValueError: `rtol` lies outside of [1e-11, 1e-2], `atol` is not positive, `max_steps` lies below 1 or below what the
            duration takes in the longest steps, 5 ms each, and as `simulate`
        FloatingPointError: the trajectory diverged, no step keeps the tolerance, or more than `max_steps` would be needed; the
            message gives the time
        MemoryError: as `simulate`

    >>> import strainwave as sw
    >>> drive = sw.Drive(load=sw.loads.Inertia(inertia=0.01))
    >>> run = sw.simulate_adaptively(drive, sw.scenario.step(amplitude=5.0, duration=0.1), rtol=1e-8)
    >>> run.method.partition(":")[0]
    'exponential Runge-Kutta, adaptive, rtol 1e-08, atol 1e-12'
    """
    model, drive = drive, drive_of(drive)
    rtol = arguments.number("rtol", rtol, brackets="[]", low=1e-11, high=1e-2)
    atol = arguments.number("atol", atol, low=0.0)
    sample = arguments.seconds("sample", sample)
    max_steps = arguments.whole("max_steps", max_steps, 1)
    recorded = recorded_of(drive, record)
    excitation = Excitation.of(drive, command, load_torque, temperature, inputs)
    state = beginning_numbers(drive, initial, excitation.first())
    check_samples(command.duration, sample, len(recorded))
    samples = grid(sample, command.duration, max(1e-9 * sample, 4.0 * float(np.spacing(command.duration))))
    ends = excitation.ends(signals.instants(drive, state, command.duration), max_steps)
    excitation.check_temperature(ends)
    channels = [each.channel for each in recorded.values()]
    outputs = beginning(drive, state, excitation.first(), channels, len(samples))
    kernels.prepare(drive, "simulate_adaptively", len(ends))
    with by_count(progress, "simulating", len(ends) - 1) as shown:
        state, accepted, rejected = _core.simulate_adaptively(
            drive, state, *excitation.signals, ends, rtol, atol, max_steps, samples[1:], channels, outputs, 1, shown
        )
    kernels.note(drive, "simulate_adaptively", accepted + rejected)
    check_meaning(samples, recorded, outputs, "check the parameters")
    kept = f"adaptive, rtol {rtol:g}, atol {atol:g}: {accepted} steps, {rejected} given up"
    end = _finite(State.of(drive, state), "check the parameters")
    run = Run._made(drive, samples, recorded, outputs, end, f"{_named('exponential', drive)}, {kept}")
    warn_of_ratings(model, run)
    return run


def differentiate(
    drive: Drive,
    excitation: Excitation,
    numbers: Sequence[int],
    dt: float,
    samples: float | Array,
    initial: Mapping[str, float] | None = None,
) -> tuple[Recording, Array]:
    """A run and its derivatives, shape (numbers, columns without time, n), by parameters, exact to rounding (dual numbers).

    The parameters are places in `_core.parameters(drive)`. Samples are their interval, or all of them, from 0 on [s].
    """
    temperature = excitation.first()[TEMPERATURE_PLACE]
    beginning_numbers(drive, initial, excitation.first())  # refuses what is no beginning
    instants = signals.instants(drive, drive.rest().numbers, excitation.command.duration)
    excitation.check_laid_out(dt if isinstance(samples, np.ndarray) else min(dt, samples))
    time_grid = excitation.time_grid(dt, samples, instants)
    check_resolution(drive, time_grid.longest, 0.0, temperature)
    inputs = excitation.over(time_grid.instants)
    recorded = signals.outputs(drive)
    with room_for("samples", len(time_grid.times), 8.0 * len(recorded) * (1 + len(numbers)), "sample less often"):
        beginning, kept = known(drive, initial), time_grid.samples[1:]

        def run_by(group: list[int], counter: StepCounter) -> tuple[Array, Array]:
            return _core.differentiate(drive, beginning, time_grid.instants, inputs, kept, group, counter)

        groups = [list(numbers[first : first + _core.slopes]) for first in range(0, max(len(numbers), 1), _core.slopes)]
        with kernels.prepared(drive, "differentiate", len(groups) * len(kept)):
            runs = side_by_side([partial(run_by, group) for group in groups])
        outputs, slopes = runs[0][0], np.concatenate([by_numbers for _, by_numbers in runs])
    channels = [each.channel for each in recorded.values()]
    return recording(drive, time_grid, recorded, outputs[channels], temperature), slopes[:, channels]


def recording(
    drive: Drive, time_grid: TimeGrid, recorded: Mapping[str, Output], outputs: Array, temperature: float
) -> Recording:
    """Return the recording of a checked run that began at a temperature [K]; outputs (recorded, samples) contain the twist."""
    time = time_grid.times
    check_meaning(time, recorded, outputs, remedy(time_grid.longest))
    twist = float(np.abs(outputs[list(recorded).index("twist")]).max())
    check_resolution(drive, time_grid.longest, twist, temperature)
    units = signals.units(drive, recorded.values())
    return Recording(columns_of(time, recorded, outputs), units, title=GENERATED_TITLE)


def columns_of(time: Array, recorded: Mapping[str, Output], outputs: Array) -> dict[str, Array]:
    """The columns of a recording, which need not be copied as nobody can change them."""
    time.setflags(write=False)
    outputs.setflags(write=False)
    return {"time": time} | {name: outputs[i] for i, name in enumerate(recorded)}


def check_meaning(time: Array, recorded: Mapping[str, Output], outputs: Array, what_to_do: str) -> None:
    if not (outputs.max() <= LARGEST_OUTPUT and outputs.min() >= -LARGEST_OUTPUT):
        names = [*recorded, "twist"][: len(outputs)]
        raise FloatingPointError(diverged(time, names, outputs, what_to_do))


def _finite(end: State, what_to_do: str) -> State:
    """A state at the end of a run; what nobody recorded, as the state of a sensor, may have diverged alone."""
    if not np.isfinite(end.numbers).all():
        wrong = [name for name, number in zip(end, end.numbers, strict=True) if not np.isfinite(number)]
        raise FloatingPointError(f"the simulation diverged ({listed(wrong)} at the end); {what_to_do}")
    return end
