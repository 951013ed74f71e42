"""Inputs and outputs of a drive by name; its parts define them."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from types import MappingProxyType
from typing import Any

import numpy as np
from numpy.typing import NDArray

from strainwave import Drive, Gear, _core, arguments
from strainwave.messages import shortened
from strainwave.simulation.time_grid import check_acting

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Output:
    """A number that a drive shows of itself: what it means, the part that shows it, and its place among all."""

    name: str
    unit: str
    doc: str
    part: str
    channel: int

    @property
    def path(self) -> str:
        """The name with that of its part in front."""
        return f"{self.part}.{self.name}" if self.part else self.name


def outputs(drive: Drive) -> Mapping[str, Output]:
    """All that a drive shows of itself, by name.

    >>> from strainwave import motor
    >>> "voltage" in outputs(Drive()), "voltage" in outputs(Drive(motor=motor.CurrentSource()))
    (True, False)
    """
    return _outputs_with(drive.motor.name, drive.gear.structure.name, drive.thermal.name, drive.meter.name)


@cache
def _outputs_with(motor: str, structure: str, thermal: str, meter: str) -> Mapping[str, Output]:
    """Drives differ in what these parts show; whatever its numbers, a part shows the same."""
    parts = {"motor": motor, "structure": structure, "thermal": thermal, "meter": meter}
    models = {family: any_of(_core.families[family][name]) for family, name in parts.items()}
    gear = Gear(structure=models.pop("structure"), input_inertia=1.0)
    found = [Output(*each) for each in _core.outputs(Drive(gear=gear, **models))]
    return MappingProxyType({each.name: each for each in found})


def any_of(kind: Any) -> Any:
    """A model with the numbers that stand in its description, those that must be given too."""
    return kind(**{field["name"]: field["default"] for field in kind.fields if field["required"]})


TWIST_CHANNEL = outputs(Drive())["twist"].channel


def chosen(drive: Drive, record: Sequence[str]) -> Mapping[str, Output]:
    """The outputs that `record` names, in its order: each by its name, or with that of its part in front."""
    names = arguments.names("record", record)
    known = outputs(drive)
    paths = dict(known) | {each.path: each for each in known.values()}
    if not names or not set(names) <= set(paths):
        raise ValueError(f"record = {shortened(names)} must list outputs of this drive: {', '.join(known)}")
    return {paths[name].name: paths[name] for name in names}


def units(drive: Drive, of: Iterable[Output]) -> dict[str, str]:
    """The unit of the time and of some outputs."""
    return {"time": "s"} | {each.name: command_unit(drive) if each.name == "command" else each.unit for each in of}


def command_unit(drive: Drive) -> str:
    """The unit of what the controller of a drive takes.

    >>> from strainwave import control, motor
    >>> command_unit(Drive(control=control.PID())), command_unit(Drive(motor=motor.TorqueSource()))
    ('rad', 'N.m')
    """
    return _core.command_unit(drive)


def controls_position(drive: Drive) -> bool:
    """True if the command of a drive is an output angle."""
    return command_unit(drive) == "rad"


def actuation(drive: Drive) -> Output:
    """The output of the motor that is what the controller gives it."""
    return outputs(drive)[_core.actuation(drive)[0]]


def load_input(drive: Drive) -> str:
    """Return the name of the input of a drive's load.

    >>> from strainwave import loads
    >>> load_input(Drive()), load_input(Drive(load=loads.Prescribed()))
    ('load_torque', 'output_angle')
    """
    return _load_input_of(type(drive.load))  # type: ignore[arg-type] # a type is hashable


@cache
def _load_input_of(kind: type[Any]) -> str:
    """The input of a kind of load, whatever its numbers."""
    return _core.load_input(Drive(load=any_of(kind)))[0]


def instants(drive: Drive, state: Array, duration: float) -> Array:
    """Return the instants at which a sampled controller acts within `duration` [s]; none for a continuous one."""
    first, period, delay = _core.schedule(drive, state)
    if period == 0.0:
        return np.empty(0)
    check_acting(duration, period)
    # As multiples: a state that has been sampled at its begin acts at the very instants of one that has not.
    samples = period * (np.float64(first) / period + np.arange(int(max(duration - first, 0.0) / period) + 1))
    given = np.concatenate([[first - period + delay], samples + delay])
    acting = np.sort(np.concatenate([samples, given[given > 1e-9 * period]]))
    return np.asarray(acting[acting < duration])


def check_continuous(drive: Drive, what: str) -> None:
    """Refuse a drive that is not one system of differential equations, of which `what` is asked."""
    if _core.schedule(drive, drive.rest().numbers)[1] > 0.0:
        raise ValueError(
            f"{what} needs a controller that acts all the time; this one is sampled. "
            "Give drive.replace(control=drive.control.law)"
        )
    if load_input(drive) == "output_angle":
        raise ValueError(f"{what} needs an output shaft that torques move; the load of this drive prescribes its motion")
    if load_input(drive) != "load_torque":
        raise ValueError(f"{what} needs a load that does not brake; give another load")
    for part, why in (("meter", "counts no energy"), ("thermal", "is of one temperature, and this drive warms up")):
        if not isinstance(getattr(drive, part), kind := type(getattr(Drive(), part))):
            raise ValueError(f"{what} {why}; give drive.replace({part}=sw.{part}.{kind.__name__}())")
    if clocked := [name for name, _, _ in _core.state(drive)[0] if name.endswith(".clock")]:
        sensor = clocked[0].removesuffix(".clock")
        raise ValueError(f"{what} needs sensors without noise; {sensor} has some")
