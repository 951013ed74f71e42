"""A motor whose rotor is a flywheel: its speed is given, and its currents alone change."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
import strainwave as sw
from numpy.typing import NDArray
from strainwave import _core
from strainwave.simulation import signals
from strainwave.simulation.state import State

from tests.support.geared import RATIO, geared

Array = NDArray[np.float64]
HEAVY = 1e12  # kg.m2: no torque of these tests changes its speed by more than rounding does


def flywheel(motor: Any, **parts: Any) -> sw.Drive:
    """The motor in open loop on a gear that transmits nothing as long as the speed stays what it is."""
    load = parts.pop("load", sw.loads.Inertia(inertia=0.1))
    return geared(motor=motor.replace(inertia=HEAVY), load=load, damping=0.0, **parts)


def turning(drive: sw.Drive, speed: float, numbers: Mapping[str, float] | None = None) -> State:
    """The state at rest, but that both shafts turn."""
    return drive.rest().replace(numbers or {}, input_speed=speed, output_speed=speed / RATIO)


def course(motor: Any, voltage: float, speed: float, duration: float, dt: float = 2e-5, **numbers: float) -> sw.Run:
    """Currents after a voltage has been switched on at a speed, from none or from these."""
    drive = flywheel(motor)
    start = turning(drive, speed, {f"motor.{name}": value for name, value in numbers.items()})
    return sw.simulate(drive, sw.scenario.constant(voltage, duration), dt, initial=start)


def settled(motor: Any, voltage: float, speed: float, **numbers: float) -> dict[str, float]:
    """What the motor shows once its currents have settled."""
    run = course(motor, voltage, speed, 40.0 * slowest(motor), slowest(motor) / 40.0, **numbers)
    return {name: float(run[name][-1]) for name in run.names}


def slowest(motor: Any) -> float:
    """The largest electric time constant [s]."""
    names = {"inductance", "direct_inductance", "quadrature_inductance"}
    return max(getattr(motor, name) for name in names if hasattr(motor, name)) / motor.resistance


def instant(drive: sw.Drive, state: State, *inputs: float) -> tuple[dict[str, float], dict[str, float], dict[str, float]]:
    """Rates of the numbers of a state, outputs, and how fast the outputs change with those numbers alone.

    Under command, input of the load and temperature, all constant.
    """
    command, load, temperature = (*inputs, *(0.0, 0.0, 293.15)[len(inputs) :])
    values, slopes = _core.differentiate_rates(drive, state.numbers, np.array([command, 0.0, load, 0.0, temperature, 0.0]))
    count = len(slopes) - 6
    names = [name for name, _, _ in _core.state(drive)[0][:count]]
    rates, changes = values[:count], values[:count] @ slopes[:count]
    shown = {name: count + each.channel for name, each in signals.outputs(drive).items()}
    return (
        dict(zip(names, rates.tolist(), strict=True)),
        {name: float(values[place]) for name, place in shown.items()},
        {name: float(changes[place]) for name, place in shown.items()},
    )


def torque_of(
    motor: Any, speed: float, numbers: Mapping[str, float] | None = None, command: float = 0.0, angle: float = 0.0
) -> float:
    """The torque [N.m] that accelerates the rotor while the gear transmits none."""
    drive = geared(motor=motor.replace(inertia=1.0), load=sw.loads.Inertia(inertia=0.1), damping=0.0)
    placed = {"input_angle": angle, "transmission_error": 0.0} | dict(numbers or {})
    rates, shown, _ = instant(drive, turning(drive, speed, placed), command)
    assert shown["torque"] == 0.0
    return rates["input_speed"]
