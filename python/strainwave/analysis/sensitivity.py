"""Derivatives of a run by the numbers of the drive."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from types import MappingProxyType
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from strainwave import Drive, arguments
from strainwave.equality import ComparedByFields
from strainwave.files.recording import Recording
from strainwave.messages import listed, quoted, shortened
from strainwave.parameters import parameters as chosen
from strainwave.presentation import Pictured, Row
from strainwave.simulation.excitation import ROOM_TEMPERATURE, Excitation
from strainwave.simulation.resolution import warn_of_bristles
from strainwave.simulation.run import differentiate
from strainwave.simulation.scenario import Scenario

if TYPE_CHECKING:
    from matplotlib.figure import Figure

Array = NDArray[np.float64]

# Numbers by which there is no derivative, by their path or its last name, and why.
NO_MEASURE = {
    "control.period": (WHEN := "it determines when something happens, not how much of it"),
    "control.delay": WHEN,
    "seed": "it selects the noise, not its size",
    "counts": (ROUNDING := "a reading that is rounded jumps, and derivatives ignore the rounding"),
    "resolution": ROUNDING,
}


@dataclass(frozen=True, eq=False)
class Derivatives(ComparedByFields, Pictured):
    """A run, and the derivatives of its outputs by some parameters.

    Attributes:
        run: the run itself
        parameters: paths of the parameters, each with its unit
        numbers: value of each parameter in the drive, by its path
        values: derivatives, shape (parameters, outputs, samples), in the order of `parameters` and of the run's columns without
            time; read-only

    >>> import strainwave as sw
    >>> drive = sw.Drive(load=sw.loads.Inertia(inertia=0.01))
    >>> found = sw.analysis.derivatives(drive, sw.scenario.step(amplitude=5.0, duration=0.1), ["load.inertia"], sample=1e-3)
    >>> round(1e6 * found.effects("output_angle")["load.inertia"], 1)  # urad of the output, rms, by 1 % more inertia
    19.0
    """

    run: Recording
    parameters: Mapping[str, str]
    numbers: Mapping[str, float]
    values: Array

    def effects(self, output: str, relative: float = 0.01) -> dict[str, float]:
        """Return the root mean square change of an output when each parameter grows by a share of its value.

        Args:
            output: its name
            relative: share of the value [1]; the change is linear in it

        Returns:
            changes [unit of the output], by the path of the parameter; 0 for a parameter that is 0

        >>> import strainwave as sw
        >>> drive = sw.Drive(load=sw.loads.Inertia(inertia=0.01))
        >>> found = sw.analysis.derivatives(drive, sw.scenario.step(amplitude=5.0, duration=0.1), ["load.inertia"], sample=1e-3)
        >>> change = found.effects("output_angle")["load.inertia"]
        >>> heavier = sw.simulate(drive.replace({"load.inertia": 0.0101}), sw.scenario.step(5.0, 0.1), sample=1e-3)
        >>> actual = np.sqrt(np.mean((heavier["output_angle"] - found.run["output_angle"]) ** 2))
        >>> bool(abs(change / actual - 1.0) < 0.02)
        True
        """
        relative = arguments.number("relative", relative)
        return {
            path: abs(relative * self.numbers[path]) * float(np.sqrt(np.mean(self[output, path] ** 2)))
            for path in self.parameters
        }

    def plot(self, output: str = "output_angle") -> Figure:
        """Return bars of what 1 % of each parameter changes of an output, as `effects`, the largest first.

        Raises:
            ValueError: there is no such output
            TypeError: the name is no text
        """
        from strainwave.analysis.plots import sensitivity_figure

        effects = self.effects(output)
        return sensitivity_figure(effects, self.run.unit(output), output.replace("_", " "), 1.0)

    def __getitem__(self, which: tuple[str, str]) -> Array:
        """Derivative of an output by a parameter, shape (samples,), in the unit of the one per unit of the other."""
        if not isinstance(which, tuple) or len(which) != 2:
            raise TypeError(f"an output and a parameter are wanted, not {shortened(which)}")
        output, path = arguments.names("an output and a parameter", which)
        outputs = [name for name in self.run.names if name != "time"]
        if output not in outputs:
            raise ValueError(f"no output {quoted(output)}; there are {listed(outputs)}")
        if path not in self.parameters:
            raise ValueError(f"no derivatives by {quoted(path)}; there are those by {listed(self.parameters)}")
        return np.asarray(self.values[list(self.parameters).index(path), outputs.index(output)])

    def __reduce__(self) -> tuple[type[Derivatives], tuple[object, ...]]:
        return Derivatives, (self.run, dict(self.parameters), dict(self.numbers), self.values)

    def _headline(self) -> str:
        return f"{len(self.run)} samples by {', '.join(self.parameters)}"

    def _rows(self) -> Iterator[Row]:
        for name in self.run.names:
            if name != "time":
                for path, change in self.effects(name).items():
                    yield Row(f"{name} by {path}", change, self.run.unit(name), note="rms, by + 1 %")


def derivatives(
    drive: Drive,
    command: Scenario,
    parameters: Sequence[str],
    dt: float = 2e-4,
    *,
    sample: float | None = None,
    load_torque: Scenario | float = 0.0,
    temperature: Scenario | float = ROOM_TEMPERATURE,
    inputs: Mapping[str, Scenario | float] | None = None,
    initial: Mapping[str, float] | None = None,
) -> Derivatives:
    """Run a drive through a command with the derivatives of all outputs by some of its parameters.

    They are those of the run as it is computed, exact to rounding: dual numbers go through steps, events and the memory of
    hysteresis. At a moment where the run itself is not smooth in a parameter they are those of one side. Up to four parameters
    cost some two and a half plain runs, eight some three, the next as much again, in a thread of their own where there is one.

    Args:
        drive: what is commanded
        command: as for `simulate`
        parameters: paths, as "gear.stiffness.a1"; that of a sequence, as "gear.kinematic_error.amplitude", is all its elements
        dt, sample, load_torque, temperature, inputs, initial: as for `simulate`; what follows from `initial` moves with the
            parameters

    Returns:
        The run and its derivatives. Those of one output by one parameter, ``found["output_angle", "load.inertia"]``, have shape
        (samples,) and the unit of the output over that of the parameter.

    Raises:
        TypeError, ValueError, FloatingPointError, MemoryError: as `simulate`; a path that the drive does not have, or a number
            by which there is no derivative: when a controller acts, which noise it is, how finely a reading is rounded

    Warns:
        RuntimeWarning: the drive has bristles too stiff for steps of `dt`

    >>> import strainwave as sw
    >>> drive = sw.Drive(load=sw.loads.Inertia(inertia=0.01))
    >>> found = sw.analysis.derivatives(drive, sw.scenario.step(amplitude=5.0, duration=0.1), ["load.inertia"], sample=1e-3)
    >>> found["output_angle", "load.inertia"].shape
    (101,)
    >>> dict(found.parameters)
    {'load.inertia': 'kg.m2'}
    """
    arguments.drive(drive)
    dt = arguments.seconds("dt", dt)
    places = chosen("parameters", drive, parameters)
    if not places:
        raise ValueError("parameters must name at least one number")
    interval = dt if sample is None else arguments.seconds("sample", sample)
    for each in places:
        if why := NO_MEASURE.get(each.path) or NO_MEASURE.get(each.path.rpartition(".")[2]):
            raise ValueError(f"there is no derivative by {each.path}: {why}")
    excitation = Excitation.of(drive, command, load_torque, temperature, inputs)
    run, values = differentiate(drive, excitation, [each.number for each in places], dt, interval, initial)
    warn_of_bristles(drive, min(dt, interval, command.duration))
    endless = [each.path for each, slopes in zip(places, values, strict=True) if not np.isfinite(slopes).all()]
    if endless:
        raise FloatingPointError(f"derivatives by {', '.join(endless)} are not finite, though the run is")
    values.setflags(write=False)
    units, numbers = {each.path: each.unit for each in places}, {each.path: each.value for each in places}
    return Derivatives(run, MappingProxyType(units), MappingProxyType(numbers), values)
