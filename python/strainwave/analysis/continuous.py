"""The drive that a linear view is of: continuous, of one temperature, without noise, steps and counts."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from strainwave import Drive, control, sensor
from strainwave.simulation.state import State


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
    smooth = {name: _smooth(part) for name, part in whole.items()}
    if changed := [name for name, part in whole.items() if smooth[name] is not part]:
        yield (
            "sensors",
            drive.sensors.replace(**smooth),
            f"sensors.{', sensors.'.join(changed)}: noise, steps and counts are left out",
        )
    for name, left_out in (("meter", "energy is not measured"), ("thermal", "the drive does not warm up")):
        if not isinstance(getattr(drive, name), kind := type(getattr(Drive(), name))):
            yield name, kind(), f"{name}: {left_out}"


def _smooth(part: Any) -> Any:
    """Return a sensor without noise, steps and counts."""
    while isinstance(part, (sensor.Noisy, sensor.Quantised)):
        part = part.law
    return sensor.Ideal() if isinstance(part, sensor.Encoder) else part


def state_within(plain: Drive, state: State) -> State:
    """Return the state of a drive as that of the same drive by `continuous`; what it lacks has its value at rest."""
    known = {name.replace("control.law.", "control."): value for name, value in state.items()}
    known |= {name.replace(".law.", "."): value for name, value in known.items() if name.startswith("sensors.")}
    rest = plain.rest()
    return rest.replace({name: known[name] for name in rest if name in known})
