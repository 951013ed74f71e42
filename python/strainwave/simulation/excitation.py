"""Inputs of a drive over time."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from numbers import Real

import numpy as np
from numpy.typing import NDArray

from strainwave import Drive, _core, arguments
from strainwave.messages import quoted, shortened
from strainwave.simulation.scenario import Scenario
from strainwave.simulation.signals import command_unit, load_input
from strainwave.simulation.time_grid import (
    BYTES_PER_INPUTS,
    BYTES_PER_STEP,
    LONG_RUN,
    LONGER_STEPS,
    NO_INSTANTS,
    TimeGrid,
    check_instants,
    check_room,
    grid,
    room_for,
)

Array = NDArray[np.float64]

ROOM_TEMPERATURE = 293.15  # K
TEMPERATURE_PLACE = 4  # among the inputs
MAX_ADAPTIVE_STEP = 5e-3  # s
PER_PERIOD = 5.0  # such steps in a period of an input, at the least
BYTES_PER_END = 40.0  # memory for an instant at which an adaptive step must end (measured)


@dataclass(frozen=True)
class Excitation:
    """Inputs of a drive: the command, the input of its load, and the temperature of the gear [K]."""

    command: Scenario
    load: Scenario | float = 0.0
    temperature: Scenario | float = ROOM_TEMPERATURE

    @classmethod
    def of(
        cls,
        drive: Drive,
        command: Scenario,
        load_torque: Scenario | float | str = 0.0,
        temperature: Scenario | float | str = ROOM_TEMPERATURE,
        inputs: Mapping[str, Scenario | float | str] | None = None,
    ) -> Excitation:
        """Return the excitation for the arguments of a user; `inputs` has those that the parts of the drive take, by name."""
        if not isinstance(command, Scenario):
            raise TypeError(f"command = {shortened(command)} must be a Scenario, as sw.scenario.constant(...) makes one")
        if inputs is not None:
            arguments.mapping("inputs", inputs, '{"output_angle": 0.1}')
        command.check_unit("command", command_unit(drive))
        load = load_input(drive)
        if load != "load_torque" and (isinstance(load_torque, Scenario) or load_torque != 0.0):
            raise ValueError(f"the load of this drive takes no load_torque, but {load}: give inputs={{{quoted(load)}: ...}}")
        given = {load: load_torque if load == "load_torque" else 0.0, "temperature": temperature}
        for name, signal in dict(inputs or {}).items():
            given[arguments.one_of("the name of an input", name, (load, "temperature"))] = signal
        signals: dict[str, Scenario | float] = {}
        for name, signal in given.items():
            if not isinstance(signal, Scenario | Real | str):
                raise TypeError(f"{name} = {shortened(signal)} must be a number or a Scenario")
            unit = "K" if name == "temperature" else _core.load_input(drive)[1]
            if not isinstance(signal, Scenario):
                signals[name] = arguments.number(name, signal, unit)
                continue
            signal.check_unit(name, unit)
            signals[name] = signal
            if signal.duration != command.duration:
                raise ValueError(f"{name} lasts {signal.duration} s, command {command.duration} s; both must last equally long")
        if not isinstance(signals["temperature"], Scenario):
            check_temperature(signals["temperature"])
        return cls(command, signals[load], signals["temperature"])

    @property
    def _scenarios(self) -> list[Scenario]:
        return [signal for signal in (self.command, self.load, self.temperature) if isinstance(signal, Scenario)]

    def time_grid(self, dt: float, samples: float | Array | None, instants: Array = NO_INSTANTS) -> TimeGrid:
        """The steps that follow it, and end at `instants`, at which a controller acts."""
        breaks = np.concatenate([*(signal.breaks for signal in self._scenarios), instants])
        return TimeGrid.through(self.command.duration, dt, dt if samples is None else samples, breaks)

    def check_laid_out(self, dt: float) -> None:
        """Refuse steps of `dt` [s] whose inputs, all laid out by `over`, take too much memory; before a grid is made."""
        check_instants(self.command.duration, dt, LONGER_STEPS)
        check_room("steps", self.command.duration / dt, BYTES_PER_STEP + BYTES_PER_INPUTS, LONG_RUN)

    def ends(self, instants: Array, most: int) -> Array:
        """Return the instants at which adaptive steps must end [s]; refuse what takes more than `most` steps.

        They are the jumps of the inputs, `instants`, at which a controller acts, and so many more that no step is as long as a
        period of an input.
        """
        duration = self.command.duration
        waves = [wave for signal in self._scenarios for wave in signal.waves]
        fastest = max((abs(w.frequency + t * w.sweep) for w in waves for t in (0.0, duration)), default=0.0)
        longest = 1.0 / max(1.0 / MAX_ADAPTIVE_STEP, PER_PERIOD * fastest)
        if duration > most * longest:
            raise ValueError(
                f"max_steps = {most} are too few for {duration:g} s: adaptive steps are {longest:.3g} s long at most, which "
                f"makes {duration / longest:.3g} steps; allow more, or make several runs, each from the end of the one before"
            )
        check_instants(duration, longest, LONGER_STEPS)
        check_room("steps", duration / longest + len(instants), BYTES_PER_END, LONG_RUN)
        regular = grid(longest, duration, 1e-9 * MAX_ADAPTIVE_STEP)
        ends = np.unique(np.concatenate([regular, instants, *(signal.breaks for signal in self._scenarios)]))
        if not len(instants):
            return ends
        apart = np.diff(ends) > 1e-9 * MAX_ADAPTIVE_STEP * (duration > MAX_ADAPTIVE_STEP)
        return np.asarray(ends[np.append(apart, True)])

    def check_temperature(self, ends: Array) -> None:
        """Refuse a temperature that is not positive, at eight places between all `ends`."""
        if isinstance(self.temperature, Scenario):
            between = ends[:-1] + np.diff(ends) * np.arange(8)[:, None] / 8
            check_temperature(float(min(self.temperature.value(between).min(), self.temperature.value_before(ends).min())))

    @cached_property
    def signals(self) -> tuple[_core.Signal, _core.Signal, _core.Signal]:
        """Command, input of the load and temperature."""
        return _signal(self.command), _signal(self.load), _signal(self.temperature)

    def first(self) -> Array:
        """Command, input of the load and temperature, each with its rate, at t = 0."""
        return self._first

    @cached_property
    def _first(self) -> Array:
        return np.asarray(_core.inputs(*self.signals, np.array([0.0, self.command.duration]))[0, 0])

    def over(self, instants: Array) -> Array:
        """The same at the start, middle and end of each step between these instants [s], shape (n, 3, 6)."""
        with room_for("steps", len(instants), BYTES_PER_STEP + BYTES_PER_INPUTS, LONG_RUN):
            inputs = _core.inputs(*self.signals, instants)
        if isinstance(self.temperature, Scenario):
            check_temperature(float(inputs[:, :, TEMPERATURE_PLACE].min()))
        return inputs


def _signal(value: Scenario | float) -> _core.Signal:
    if isinstance(value, Scenario):
        return value.signal
    return _core.Signal(np.zeros(1), np.array([value], dtype=np.float64), np.zeros(1), np.empty(0))


def check_temperature(lowest: float) -> None:
    if lowest <= 0.0:
        raise ValueError(f"temperature = {lowest:g} K must lie in (0, inf); 20 degC are 293.15 K")
