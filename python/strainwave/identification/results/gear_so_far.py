"""What is known of a gear before a file is fitted, and how it grows with each."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from strainwave.files.entries import Entry
from strainwave.files.gear_set import GearSet
from strainwave.files.recording import Recording
from strainwave.identification.evidence.verdict import numbers
from strainwave.identification.reading.names import Side
from strainwave.identification.reading.recognise import Recognised
from strainwave.identification.results.file_result import FileEstimate

ROTOR = 0.05  # relative standard deviation of an inertia of which a data sheet says none (assumed)
MODULATING = ("cyclic", "thermal")  # laws that vary another one


@dataclass(frozen=True)
class GearSoFar:
    """What is known before a file is fitted.

    Attributes:
        gear_set: the set, with what earlier files have told of it
        friction: the recording of a friction table, if one was given
        determined: parts of the gear that earlier files determine
        side: what a person says of the side of the file that is fitted next; None where nothing
        accept: whether files are used in spite of doubts about their sizes
        sigmas: standard deviation of the first number of friction and spring, as the file has it that tells the part
        determined_by: the file that told each number, by its path in the gear set
    """

    gear_set: GearSet
    friction: Recording | None = None
    determined: frozenset[str] = frozenset()
    side: Side | None = None
    accept: bool = False
    sigmas: Mapping[str, float] = field(default_factory=dict)
    determined_by: Mapping[str, str] = field(default_factory=dict)

    def knows_better(self, part: str, told: Sequence[FileEstimate]) -> bool:
        """Whether an earlier file tells a part of the gear better than this one."""
        return part in self.determined and self.sigmas.get(part, np.inf) <= _first_sigma(part, told)

    def judged(self, part: str, told: Sequence[FileEstimate]) -> GearSoFar:
        """The same, with how well a file tells a part."""
        return replace(self, sigmas={**self.sigmas, part: _first_sigma(part, told)})

    def with_parts(self, parts: Mapping[str, Any], sigmas: Mapping[str, float], name: str) -> GearSoFar:
        """The same, with parts of the gear that a file of this name tells."""
        gear = self.gear_set.gear.replace(**parts)
        sources = {path: entry for path, entry in self.gear_set.sources.items() if not is_of(path, parts)}
        determined_by = {path: file for path, file in self.determined_by.items() if not is_of(path, parts)}
        for path in (path for path in numbers(gear) if is_of(path, parts)):
            told = path in sigmas and np.isfinite(sigmas[path])
            sources[path] = Entry(source=f"identified from {name}", uncertainty=sigmas[path] if told else None)
            determined_by |= {path: name} if told else {}
        gear_set = replace(self.gear_set, gear=gear, sources=sources)
        return replace(self, gear_set=gear_set, determined=self.determined | set(parts), determined_by=determined_by)

    def sliding(self) -> Any:
        """The friction of the input as it slides, without what modulates it over angle and temperature."""
        law: Any = self.gear_set.gear.friction_input
        while law.name in MODULATING:
            law = law.law
        return law

    def with_sliding(self, law: Any, sigmas: Mapping[str, float], name: str) -> GearSoFar:
        """The same, with another law of sliding inside what modulates it.

        Args:
            law: the new one
            sigmas: standard deviations of the numbers of the law that the file tells, by name
            name: of the file
        """
        outer: Any = self.gear_set.gear.friction_input
        depth, around = 0, list[Any]()
        while outer.name in MODULATING:
            around.append(outer)
            outer, depth = outer.law, depth + 1
        for each in reversed(around):
            law = each.replace(law=law)
        return self.with_law(
            law, {f"gear.friction_input.{'law.' * depth}{each}": sigma for each, sigma in sigmas.items()}, name
        )

    def with_law(self, law: Any, sigmas: Mapping[str, float], name: str) -> GearSoFar:
        """The same, with another law of the input's friction; numbers that it takes over keep their source.

        Args:
            law: the new one
            sigmas: standard deviations of the numbers that the file tells, by path
            name: of the file
        """
        before, values = self.gear_set.sources, {path: value for path, (value, _) in numbers(self.gear_set.gear).items()}
        known = {plain(each): each for each in before}
        after = self.with_parts({"friction_input": law}, sigmas, name)
        sources, determined_by = dict(after.gear_set.sources), dict(after.determined_by)
        for path, (value, _) in numbers(after.gear_set.gear).items():
            if path.startswith("gear.friction_input.") and path not in sigmas:
                old = known.get(plain(path), "")
                kept = old and values.get(old) == value
                sources[path] = before[old] if kept else Entry(source=f"assumed beside what {name} tells")
                determined_by |= {path: self.determined_by[old]} if kept and old in self.determined_by else {}
        return replace(after, gear_set=replace(after.gear_set, sources=sources), determined_by=determined_by)


def is_of(path: str, parts: Collection[str]) -> bool:
    """Whether a number of a gear set belongs to one of these parts of its gear.

    >>> is_of("gear.stiffness.k1", {"stiffness"}), is_of("gear.damping", {"damping"}), is_of("motor.inertia", {"inertia"})
    (True, True, False)
    """
    return path.startswith("gear.") and path.removeprefix("gear.").partition(".")[0] in parts


def plain(path: str) -> str:
    """The path of a number without the laws that it stands inside.

    >>> plain("gear.friction_input.law.law.coulomb")
    'gear.friction_input.coulomb'
    """
    return ".".join(part for part in path.split(".") if part != "law")


def _first_sigma(part: str, told: Sequence[FileEstimate]) -> float:
    """Standard deviation of the first number of a part; infinite where the file does not tell it."""
    own = [each.sigma for each in told if each.path.startswith(f"gear.{part}.") and not each.why]
    return own[0] if own else np.inf


@dataclass(frozen=True)
class TorqueConstant:
    """The torque constant of the motor, which is common to all files that tell torque by a current.

    Attributes:
        value: [N.m/A]
        relative: its standard deviation over its value [1]
    """

    value: float
    relative: float

    @classmethod
    def of(cls, file: Recognised, gear_set: GearSet) -> TorqueConstant | None:
        """As a person gave it with the file, which is exact; else as the set has it; None if neither does."""
        if "torque_constant" in file.constants:
            return cls(file.constants["torque_constant"], 0.0)
        value = getattr(gear_set.motor, "torque_constant", None)
        if not value:
            return None
        entry = gear_set.sources.get("motor.torque_constant")
        relative = 0.0 if entry is None else entry.uncertainty / value if entry.uncertainty else entry.spread or 0.0
        return cls(value, float(relative))


def rotor_sigma(file: Recognised, gear_set: GearSet) -> float:
    """Standard deviation of the inertia that turns at the input [kg.m2]: what a log tells of a load is what is left beside it.

    That of a motor is exact where a person gave it with the file.
    """
    motor = gear_set.motor if "motor_inertia" not in file.constants else None
    of_motor = 0.0 if motor is None else _sigma(gear_set, "motor.inertia", motor.inertia)
    return float(np.hypot(of_motor, _sigma(gear_set, "gear.input_inertia", gear_set.gear.input_inertia)))


def _sigma(gear_set: GearSet, path: str, value: float) -> float:
    entry = gear_set.sources.get(path, Entry("not given"))
    if entry.uncertainty is not None:
        return entry.uncertainty
    return value * (ROTOR if entry.spread is None else entry.spread)


def with_torque(file: Recognised, gear_set: GearSet) -> tuple[Recording, float]:
    """A recording with a torque, where only the current of the motor was measured; and what is uncertain of all of it [1].

    Beside the speed or angle of the output the torque of the motor is counted there, by the ratio.

    Raises:
        ValueError: the torque constant is needed, and not known
    """
    if "torque" in file.recording:
        return file.recording, 0.0
    constant = TorqueConstant.of(file, gear_set)
    if constant is None:
        raise ValueError("it tells the current alone; give the torque constant of the motor, with --constant torque_constant=…")
    counted = abs(gear_set.gear.kinematics.ratio) if file.side == "output" else 1.0
    torque = counted * constant.value * file.recording["current"]
    return file.recording.with_column("torque", torque, "N.m"), constant.relative
