"""Drives with faults: a fault lists changes of numbers, which are made here to the numbers of a drive.

`prepared` puts laws in that the faults need, with neutral numbers. On a drive prepared so, faults are changes of numbers alone:
`changes` returns them, and one compiled drive runs at every severity.
"""

from __future__ import annotations

from cmath import phase as direction_of, rect
from collections.abc import Iterator, Mapping, Sequence
from functools import lru_cache
from math import isclose
from typing import Any, NamedTuple

from strainwave import Drive, _core
from strainwave.files.described import own_paths, parts
from strainwave.messages import listed

MAX_DRIVES_KEPT = 16  # whose places of numbers are kept
SAME_ORDER = 1e-9  # relative difference of two orders that are one
ERROR_PLACE = "gear.kinematic_error"
WITHOUT_EFFECT = ("constant", "ideal")  # laws that another may replace
LAW_REMEDIES = {
    "fourier": "its harmonics(), in place of the law that is there, are one",
    "encoder": "sensor.Encoder(counts=...) is one",
    "gain": "sensor.Gain() and sensor.Encoder(counts=...) have an offset",
}  # where the drive gets a law from that cannot be put in
NEUTRAL_NUMBERS: Mapping[str, Mapping[str, float]] = {
    "backlash": {"clearance": 0.0}
}  # required numbers of a law without effect

Fault = Any  # a model of `sw.fault`


class ModelChange(NamedTuple):
    """A change of the numbers called `quantity` under a part of a drive: its kind is scale, add, vector or wave.

    Attributes:
        place: path of the part
        quantity: name of the numbers; of a vector, its length; of a wave, its amplitude
        kind: scale, add, vector or wave
        value: factor, addend, length or amplitude
        law: name of a law that has such numbers, which can be put in
        direction: name of the direction of a vector, or of the phase of a wave
        phase: that direction or phase [rad]
        order: of a wave
    """

    place: str
    quantity: str
    kind: str
    value: float
    law: str
    direction: str
    phase: float
    order: float


def changes_of(drive: Drive, fault: Fault) -> list[ModelChange]:
    """Return the changes that a fault lists for a drive."""
    return _listed(fault, _facts(drive))


def _listed(fault: Fault, facts: Any) -> list[ModelChange]:
    if type(fault) not in _core.fault_families["fault"].values():
        raise TypeError(f"a fault must be a model of strainwave.fault, not {type(fault).__name__}")
    return [ModelChange(*change) for change in fault.changes(facts)]


def prepared(drive: Drive, faults: Sequence[Fault]) -> Drive:
    """Return the drive with every law that the faults need, at numbers that have no effect.

    Its trajectories are those of the drive. Waves that the faults add are there with amplitude 0. A law that is there already
    stays; one that holds another law is put around that which is there; a law without effect is replaced.

    Args:
        drive: a drive
        faults: in the order in which they act

    Raises:
        TypeError: something is no fault
        ValueError: a law cannot be put in, holds no more waves, or the drive has no number that the fault changes

    >>> import strainwave as sw
    >>> ready = prepared(sw.load("robot-joint"), [sw.fault.FlexsplineCrack(waves=1)])
    >>> ready.gear.stiffness_variation
    Periodic(order=(0.0, 2.02), amplitude=(0.0, 0.0), phase=(0.0, 0.0))
    """
    for fault in faults:
        listed_changes = changes_of(drive, fault)
        for change in listed_changes:
            if change.kind != "scale":
                drive = _with_law(drive, fault, change)
            if change.kind == "wave":
                drive = _with_wave(drive, fault, change)
        if not any(_has_effect(drive, change) for change in listed_changes):
            names = listed(sorted({change.place for change in listed_changes}))
            raise ValueError(
                f"{fault.name} changes nothing of this drive: what it changes is 0 or absent in {names}; give it numbers"
            )
    return drive


def changes(drive: Drive, faults: Sequence[Fault]) -> dict[str, float]:
    """Return the numbers of a prepared drive with the faults, by their paths. The paths are the same at every severity.

    Args:
        faults: in the order in which they act; each acts on the numbers that those before it leave

    >>> import strainwave as sw
    >>> numbers = changes(sw.load("position-drive"), [sw.fault.LubricationLoss(severity=0.5)])
    >>> round(numbers["gear.friction_input.coulomb"], 9)
    0.108
    """
    numbers = _Numbers(_places(drive))
    for fault in faults:
        for change in _listed(fault, numbers.places.facts):
            numbers.make(fault, change)
    return numbers.changed


def with_faults(drive: Drive, faults: Sequence[Fault]) -> Drive:
    """Return the drive with the faults.

    Args:
        drive: a drive
        faults: models of `sw.fault`, in the order in which they act

    Raises:
        TypeError: something is no fault
        ValueError: as `prepared` raises, or a number leaves its range

    >>> import strainwave as sw
    >>> drive = with_faults(sw.load("position-drive"), [sw.fault.LubricationLoss(severity=0.5)])
    >>> round(drive.gear.friction_input.coulomb, 9)
    0.108
    """
    ready = prepared(drive, faults)
    return ready.replace(changes(ready, faults))


def grown(fault: Fault, onset: Any, usage: float) -> Fault:
    """Return a fault at the severity that it has after a `usage`, counted in the unit of its onset.

    >>> import strainwave as sw
    >>> grown(sw.fault.LubricationLoss(), sw.onset.Growing(scale=1e6), 2.5e5).severity
    0.25
    """
    return fault.replace(severity=fault.severity * onset.share(usage))


def _facts(drive: Drive) -> Any:
    """Return what faults need to know of a drive."""
    kinematics = drive.gear.kinematics
    shaped = any(model.name == "misalignment" for _, model in _models(ERROR_PLACE, drive.gear.kinematic_error))
    facts: dict[str, Any] = {"ratio": kinematics.ratio, "error": "geometry" if shaped else "waves"}
    for name in ("flexspline_teeth", "circular_spline_teeth", "fixed"):
        if hasattr(kinematics, name):
            facts[name] = getattr(kinematics, name)
    return _core.fault.Facts(**facts)


def _models(path: str, model: Any) -> Iterator[tuple[str, Any]]:
    """Yield a model and all its parts, with their paths."""
    yield path, model
    for part in parts(model):
        yield from _models(f"{path}.{part.name}", getattr(model, part.name))


def _at(drive: Drive, place: str) -> Any:
    """Return the part at a path."""
    part: Any = drive
    for name in place.split("."):
        part = getattr(part, name)
    return part


def _holder(drive: Drive, change: ModelChange) -> str | None:
    """Return the path of the law that has the numbers of a change, or None."""
    for path, model in _models(change.place, _at(drive, change.place)):
        if model.name == change.law if change.kind == "wave" else hasattr(model, change.quantity):
            return path
    return None


# ---- Preparation -----------------------------------------------------------------------------------------------------


def _with_law(drive: Drive, fault: Fault, change: ModelChange) -> Drive:
    """Return the drive with a law that has the numbers of a change."""
    if _holder(drive, change) is not None:
        return drive
    owner, _, name = change.place.rpartition(".")
    present = _at(drive, change.place)
    whole = _put_in(_options(_at(drive, owner) if owner else drive, name), present, change.law)
    if whole is None:
        raise ValueError(
            f"{fault.name} needs a law {change.law} at {change.place}, where {present.name} is, which it can neither hold nor "
            "replace without a change of the healthy drive; give the drive such a law"
            + (f" ({LAW_REMEDIES[change.law]})" if change.law in LAW_REMEDIES else "")
            + ", or leave the fault out"
        )
    return drive.replace({change.place: whole})


def _options(owner: Any, name: str) -> Mapping[str, Any]:
    """Return the laws that a part may be, by name."""
    return next((part.options or {} for part in parts(owner) if part.name == name), {})


def _put_in(options: Mapping[str, Any], present: Any, law: str) -> Any:
    """Return the present law with another in its place, around it or within it, without effect; None if it does not fit."""
    kind = options.get(law)
    numbers = NEUTRAL_NUMBERS.get(law, {})
    if kind and type(present) in _options(kind, "law").values():
        return kind(law=present, **numbers)
    if kind and present.name in WITHOUT_EFFECT and not any(field["required"] for field in kind.fields):
        return kind()
    if not hasattr(present, "law"):
        return None
    inner = _put_in(_options(present, "law"), present.law, law)
    return inner if inner is None else present.replace(law=inner)


def _with_wave(drive: Drive, fault: Fault, change: ModelChange) -> Drive:
    """Return the drive with a wave of the order of a change, of amplitude 0 if it is new."""
    path = _holder(drive, change)
    assert path is not None
    law = _at(drive, path)
    if any(_same_order(order, change.order) for order in law.order):
        return drive
    longer = {
        name: (*getattr(law, name), value) for name, value in (("order", change.order), ("amplitude", 0.0), ("phase", 0.0))
    }
    try:
        whole = law.replace(**longer)
    except (TypeError, ValueError) as error:
        raise ValueError(
            f"{fault.name} adds order {change.order:g} to {path}, which already has {len(law.order)} waves and holds no more; "
            "give the fault fewer waves, or use fewer faults at this place"
        ) from error
    return drive.replace({path: whole})


def _same_order(one: float, other: float) -> bool:
    return isclose(one, other, rel_tol=SAME_ORDER)


def _has_effect(drive: Drive, change: ModelChange) -> bool:
    """True if the drive has a number that the change alters at some severity."""
    if change.kind == "scale":
        places = _places(drive)
        return any(places.values[path] != 0.0 for path in places.scaled(change))
    path = _holder(drive, change)
    if path is None:
        return False
    if change.kind == "wave" and hasattr(law := _at(drive, path), "law") and "friction" in change.place:
        return any(getattr(law.law, field["name"]) for field in law.law.fields if field["kind"] == "number")
    return True


def _paths_of(drive: Drive, change: ModelChange) -> Iterator[str]:
    """Yield the paths of all numbers that a scale or an addition changes."""
    for part, model in _models(change.place, _at(drive, change.place)):
        for path in own_paths(part, model):
            if path.rpartition(".")[2].partition("[")[0] == change.quantity:
                yield path


# ---- Numbers ---------------------------------------------------------------------------------------------------------


class _Places:
    """Places of the numbers of a drive, computed once for faults that act on it many times."""

    def __init__(self, drive: Drive) -> None:
        self.drive = drive
        self.facts = _facts(drive)
        self.values: dict[str, float] = {path: value for path, value, *_ in _core.parameters(drive)}
        self._scaled: dict[tuple[str, str], tuple[str, ...]] = {}
        self._held: dict[tuple[str, str, str, float], tuple[str, str]] = {}

    def scaled(self, change: ModelChange) -> tuple[str, ...]:
        """Return the paths of all numbers that a scale changes."""
        key = change.place, change.quantity
        if key not in self._scaled:
            self._scaled[key] = tuple(_paths_of(self.drive, change))
        return self._scaled[key]

    def held(self, fault: Fault, change: ModelChange) -> tuple[str, str]:
        """Return the paths of the number that a change adds to, and of its direction."""
        key = change.place, change.quantity, change.law, change.order
        if key not in self._held:
            self._held[key] = self._paths_in(fault, change)
        return self._held[key]

    def _paths_in(self, fault: Fault, change: ModelChange) -> tuple[str, str]:
        path = _holder(self.drive, change)
        if path is None:
            raise ValueError(
                f"the drive is not prepared for {fault.name}: {change.place} lacks {change.law}; call prepared first"
            )
        if change.kind != "wave":
            return f"{path}.{change.quantity}", f"{path}.{change.direction}"
        for i, order in enumerate(_at(self.drive, path).order):
            if _same_order(order, change.order):
                return f"{path}.{change.quantity}[{i}]", f"{path}.{change.direction}[{i}]"
        raise ValueError(
            f"the drive is not prepared for {fault.name}: {path} lacks order {change.order:g}; call prepared first"
        )


@lru_cache(maxsize=MAX_DRIVES_KEPT)
def _places(drive: Drive) -> _Places:
    return _Places(drive)


class _Numbers:
    """The numbers of a drive while faults change them."""

    def __init__(self, places: _Places) -> None:
        self.places = places
        self.changed: dict[str, float] = {}

    def make(self, fault: Fault, change: ModelChange) -> None:
        if change.kind == "scale":
            for path in self.places.scaled(change):
                self.changed[path] = self._value(path) * change.value
            return
        path, direction = self.places.held(fault, change)
        if change.kind == "add":
            self.changed[path] = self._value(path) + change.value
        else:
            self._add_vector(path, direction, change)

    def _add_vector(self, length: str, direction: str, change: ModelChange) -> None:
        value, angle = self._value(length), self._value(direction)
        if value == 0.0 and change.value > 0.0:
            value, angle = change.value, change.phase  # without the rounding of the sum
        elif change.value != 0.0:
            total = rect(value, angle) + rect(change.value, change.phase)
            value, angle = abs(total), direction_of(total)
        self.changed[length], self.changed[direction] = value, angle

    def _value(self, path: str) -> float:
        value = self.changed.get(path)
        return self.places.values[path] if value is None else value
