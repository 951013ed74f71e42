"""The gear as far as earlier files have determined it, and how it changes with each file."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from strainwave import kinematics
from strainwave.files.entries import Entry
from strainwave.files.gear_set import GearSet
from strainwave.files.recording import Recording
from strainwave.identification.candidates.friction import STEADY_NUMBERS
from strainwave.identification.reading.names import Side
from strainwave.identification.reading.recognise import Recognised
from strainwave.identification.results.file_result import FileEstimate, with_waves
from strainwave.messages import one_line
from strainwave.parameters import gear_numbers, plain
from strainwave.questions import TORQUE_CONSTANT, QuestionError

ROTOR_SIGMA = 0.05  # relative standard deviation of an inertia, if the data sheet contains none (assumed)
ERROR_AMPLITUDE = "gear.kinematic_error.amplitude"
EXACT_SPREAD = 1e-9  # relative standard deviation of a number that is stated as exact
START_SPREAD = 0.5  # relative standard deviation of a number of a set that states none (assumed)
MODULATING_LAWS = ("cyclic", "thermal")  # laws that vary another one
KINEMATICS_PATHS = "gear.kinematics."
SAME_TEETH = "that of the same teeth with the other spline fixed"
RATIO_TOLERANCE = 1e-9  # relative: two ratios that differ by less are one


@dataclass(frozen=True)
class GearSoFar:
    """The gear before a file is fitted.

    Attributes:
        gear_set: the set, with what earlier files have determined
        start: initial set of all files; `gear_set` if not given
        determined: parts of the gear that earlier files determine
        side: the side of the file that is fitted next, if a person gave it
        sigmas: standard deviation of the first number of friction and spring, by the file that determines the part
        determined_by: the file that determines each number, by its path in the gear set
    """

    gear_set: GearSet
    start: GearSet | None = None
    determined: frozenset[str] = frozenset()
    side: Side | None = None
    sigmas: Mapping[str, float] = field(default_factory=dict)
    determined_by: Mapping[str, str] = field(default_factory=dict)

    @property
    def initial(self) -> GearSet:
        """Initial set of all files."""
        return self.gear_set if self.start is None else self.start

    def prior(self, path: str, gear: Any) -> tuple[float, float] | None:
        """Return a number of the set before a file and its standard deviation, where it means the same in another gear.

        None if the set lacks it, has it as 0, or has it in another law, in which only steady friction means the same.
        """
        part, _, name = path.removeprefix("gear.").partition(".")
        own = {plain(each): (each, value) for each, (value, _) in gear_numbers(self.gear_set.gear).items()}
        if path not in own or own[path][1] == 0.0:
            return None
        if name and getattr(self.gear_set.gear, part).name != getattr(gear, part).name and name not in STEADY_NUMBERS:
            return None
        entry, value = self.gear_set.sources.get(own[path][0], Entry("not given")), own[path][1]
        stated = entry.sigma(value)
        return value, START_SPREAD * abs(value) if stated is None else max(stated, EXACT_SPREAD * abs(value))

    def knows_better(self, part: str, estimates: Sequence[FileEstimate]) -> bool:
        """True if an earlier file determines a part of the gear better than this one."""
        return part in self.determined and self.sigmas.get(part, np.inf) <= _first_sigma(part, estimates)

    def judged(self, part: str, estimates: Sequence[FileEstimate]) -> GearSoFar:
        """Return the same with the standard deviation of a part by a file."""
        return replace(self, sigmas={**self.sigmas, part: _first_sigma(part, estimates)})

    def with_fit(self, gear: Any, parts: Collection[str], estimates: Sequence[FileEstimate], name: str) -> GearSoFar:
        """Return the same with parts of a fitted gear, each number with its source.

        Args:
            gear: the fitted one
            parts: to take from it; one of which no number is identified stays as it was
            estimates: of the fit
            name: of the file
        """
        estimates = with_waves(estimates)
        states = {part: {each.state for each in estimates if is_of(each.path, {part})} for part in parts}
        laws = {part: getattr(gear, part) for part, of_part in states.items() if of_part != {"not identified"}}
        entries = {each.path: source_of(each, name) for each in estimates}
        return self._with_laws(laws, entries, {each.path for each in estimates if not each.why}, name)

    def with_parts(self, parts: Mapping[str, Any], sigmas: Mapping[str, float], name: str) -> GearSoFar:
        """Return the same with parts of the gear that a file determines.

        Args:
            parts: the new laws, by name
            sigmas: standard deviations of the numbers that the file determines, by path; infinite for one that it does not
            name: of the file
        """
        determined = {path for path, sigma in sigmas.items() if np.isfinite(sigma)}
        unknown = Entry(source=f"fitted but not identified: {one_line(name)} does not determine it")
        known = {path: Entry(source=f"identified from {one_line(name)}", uncertainty=sigmas[path]) for path in determined}
        return self._with_laws(parts, dict.fromkeys(sigmas, unknown) | known, determined, name)

    def with_sums(self, laws: Mapping[str, Any], entries: Mapping[str, Entry], name: str) -> GearSoFar:
        """Return the same with laws of which a file determines sums alone; a later file may determine their numbers."""
        return self._with_laws(laws, entries, (), name)

    def _with_laws(
        self, laws: Mapping[str, Any], entries: Mapping[str, Entry], determined: Collection[str], name: str
    ) -> GearSoFar:
        """Return the same with other laws; numbers without an entry keep their source if they keep their value."""
        before, values = self.gear_set.sources, gear_numbers(self.gear_set.gear)
        by_plain_path = {plain(each): each for each in before}
        gear = self.gear_set.gear.replace(**laws)
        numbers = gear_numbers(gear)
        sources = {path: entry for path, entry in before.items() if not is_of(path, laws)}
        determined_by = {path: file for path, file in self.determined_by.items() if not is_of(path, laws)}
        for path in (path for path in numbers if is_of(path, laws)):
            old = by_plain_path.get(plain(path), "")
            named = path if path in entries else plain(path)
            if named in entries:
                sources[path] = entries[named]
                determined_by |= {path: name} if named in determined else {}
            elif old and values.get(old) == numbers[path]:
                sources[path] = before[old]
                determined_by |= {path: self.determined_by[old]} if old in self.determined_by else {}
            else:
                sources[path] = _not_estimated(path, path in values, entries)
        own = {part for part in laws if any(is_of(path, {part}) for path in determined_by)}
        gear_set = replace(self.gear_set, gear=gear, sources=sources)
        return replace(self, gear_set=gear_set, determined=self.determined | own, determined_by=determined_by)

    def sliding(self) -> Any:
        """Return the friction of the input as it slides, without what modulates it over angle and temperature."""
        law: Any = self.gear_set.gear.friction_input
        while law.name in MODULATING_LAWS:
            law = law.law
        return law

    def with_sliding(self, law: Any, sigmas: Mapping[str, float], name: str) -> GearSoFar:
        """Return the same with another law of sliding inside what modulates it.

        Args:
            law: the new one
            sigmas: standard deviations of the numbers of the law that the file determines, by name
            name: of the file
        """
        outer: Any = self.gear_set.gear.friction_input
        depth, around = 0, list[Any]()
        while outer.name in MODULATING_LAWS:
            around.append(outer)
            outer, depth = outer.law, depth + 1
        for each in reversed(around):
            law = each.replace(law=law)
        named = {f"gear.friction_input.{'law.' * depth}{each}": sigma for each, sigma in sigmas.items()}
        return self.with_parts({"friction_input": law}, named, name)


def _not_estimated(path: str, was_there: bool, entries: Mapping[str, Entry]) -> Entry:
    """Return the source of a number that a fit changed without estimating it: breakaway is as uncertain as Coulomb's torque."""
    followed = entries.get(path.replace(".breakaway", ".coulomb"))
    why = "follows from the parameters fitted with it" if was_there else "set by the method of the fit"
    return Entry(
        source=f"assumed: {why}; no file determines it", uncertainty=None if followed is None else followed.uncertainty
    )


def is_of(path: str, parts: Collection[str]) -> bool:
    """True if a number of a gear set belongs to one of these parts of its gear.

    >>> is_of("gear.stiffness.k1", {"stiffness"}), is_of("gear.damping", {"damping"}), is_of("motor.inertia", {"inertia"})
    (True, True, False)
    """
    return path.startswith("gear.") and path.removeprefix("gear.").partition(".")[0] in parts


def compared_path(path: str, gear: Any) -> str:
    """Return the path by which estimates of a number of a gear by several files are compared: an amplitude by its order."""
    if path.startswith(f"{ERROR_AMPLITUDE}["):
        error: Any = gear.kinematic_error
        return f"{ERROR_AMPLITUDE} of order {error.order[int(path.partition('[')[2][:-1])]:g}"
    return plain(path)


def source_of(estimate: FileEstimate, name: str) -> Entry:
    """Return the source of an estimated number."""
    words = {"identified": "identified from {name}", "identified in combination": "identified in combination: {why}"}
    source = words.get(estimate.state, "fitted but not identified: {why}").format(name=one_line(name), why=estimate.why)
    return Entry(source=source, uncertainty=estimate.sigma if np.isfinite(estimate.sigma) else None)


def _first_sigma(part: str, estimates: Sequence[FileEstimate]) -> float:
    """Return the standard deviation of the first number of a part; infinite if the file does not determine it."""
    own = [each.sigma for each in estimates if each.path.startswith(f"gear.{part}.") and not each.why]
    return own[0] if own else np.inf


# ---- Torque constant and rotor ---------------------------------------------------------------------------------------


def torque_constant_of(file: Recognised, gear_set: GearSet) -> tuple[float, float] | None:
    """Return the torque constant [N.m/A] and its relative standard deviation [1]; None if it is not known.

    It is exact if a person gave it with the file, else as the set has it, and then common to all files with a current.
    """
    if "torque_constant" in file.constants:
        return file.constants["torque_constant"], 0.0
    value = getattr(gear_set.motor, "torque_constant", None)
    return (value, relative_sigma(gear_set, "motor.torque_constant", value)) if value else None


def relative_sigma(gear_set: GearSet, path: str, value: float) -> float:
    """Return the standard deviation of a number of a set over its value [1]; 0 if the set states none."""
    entry = gear_set.sources.get(path)
    return 0.0 if entry is None else (entry.sigma(value) or 0.0) / value


def rotor_sigma(file: Recognised, gear_set: GearSet) -> float:
    """Return the standard deviation of the inertia that turns at the input [kg.m2], which a log does not separate from a load.

    That of a motor is exact where a person gave it with the file.
    """
    motor = gear_set.motor if "motor_inertia" not in file.constants else None
    of_motor = 0.0 if motor is None else _sigma(gear_set, "motor.inertia", motor.inertia)
    return float(np.hypot(of_motor, _sigma(gear_set, "gear.input_inertia", gear_set.gear.input_inertia)))


def _sigma(gear_set: GearSet, path: str, value: float) -> float:
    stated = gear_set.sources.get(path, Entry("not given")).sigma(value)
    return ROTOR_SIGMA * value if stated is None else stated


def with_torque(file: Recognised, gear_set: GearSet) -> tuple[Recording, float]:
    """Return a recording with a torque, from the current of the motor if need be, and its relative uncertainty [1].

    If the recording contains the speed or angle of the output, the torque of the motor is referred to it, by the ratio.

    Raises:
        ValueError: the torque constant is needed, and not known
    """
    if "torque" in file.recording:
        return file.recording, 0.0
    constant = torque_constant_of(file, gear_set)
    if constant is None:
        raise QuestionError("it has the current alone", [TORQUE_CONSTANT])
    value, relative = constant
    counted = abs(gear_set.gear.kinematics.ratio) if file.side == "output" else 1.0
    return file.recording.with_column("torque", counted * value * file.recording["current"], "N.m"), relative


# ---- Ratio -----------------------------------------------------------------------------------------------------------


def with_ratio_of_all(start: GearSet, files: Sequence[Recognised]) -> GearSet:
    """Return the set with the ratio that a person gave with all files."""
    ratios = {file.constants.get("ratio") for file in files}
    if len(ratios) != 1 or (ratio := ratios.pop()) is None:
        return start
    other = geared(start.gear, ratio).kinematics
    return _with_kinematics(start, other, _source_of_ratio(start, other, "ratio given with the files"))


def with_ratio(known: GearSoFar, file: Recognised) -> GearSoFar:
    """Return the gear so far with the ratio that a person gave with this file."""
    if "ratio" not in file.constants:
        return known
    other = geared(known.gear_set.gear, file.constants["ratio"]).kinematics
    source = _source_of_ratio(known.gear_set, other, "ratio given with the file")
    return replace(known, gear_set=_with_kinematics(known.gear_set, other, source))


def with_kinematics(known: GearSoFar, of: GearSet) -> GearSoFar:
    """Return the gear so far with the ratio of a set."""
    return replace(known, gear_set=_with_kinematics(known.gear_set, of.gear.kinematics, of))


def _with_kinematics(gear_set: GearSet, other: Any, of: GearSet | str) -> GearSet:
    """Return the set with another ratio, whose source is that of a set, or as given."""
    if gear_set.gear.kinematics == other:
        return gear_set
    sources = {path: entry for path, entry in gear_set.sources.items() if not path.startswith(KINEMATICS_PATHS)}
    names = [f"{KINEMATICS_PATHS}{field['name']}" for field in other.fields if field["kind"] != "choice"]
    sources |= {name: Entry(of) if isinstance(of, str) else of.sources[name] for name in names}
    return replace(gear_set, gear=gear_set.gear.replace(kinematics=other), sources=sources)


def geared(gear: Any, ratio: float) -> Any:
    """Return the gear with another ratio; its output turns the same way as before.

    It is the same gear if its teeth give this ratio, too, with the other spline fixed. Else it is a strain wave gear if whole
    teeth give this ratio, or a plain ratio.
    """
    if abs(abs(ratio) - abs(gear.kinematics.ratio)) < RATIO_TOLERANCE * abs(ratio):
        return gear
    if (other := _other_spline_fixed(gear.kinematics)) is not None and abs(other.ratio - ratio) < RATIO_TOLERANCE * abs(ratio):
        return gear.replace(kinematics=other)
    size = abs(ratio)
    if abs(size - round(size)) > RATIO_TOLERANCE * size or round(size) < 2:
        return gear.replace(kinematics=kinematics.PlainRatio(reduction=size))
    is_backwards = ratio < 0.0 or gear.kinematics.ratio < 0.0
    teeth = 2 * round(size) - (0 if is_backwards else 2)  # two fewer on the flexspline
    fixed = "circular_spline" if is_backwards else "flexspline"
    strain_wave = kinematics.StrainWave(flexspline_teeth=teeth, circular_spline_teeth=teeth + 2, fixed=fixed)
    return gear.replace(kinematics=strain_wave)


def _other_spline_fixed(law: Any) -> Any:
    """Return the teeth of a strain wave gear with its other spline fixed; None for a plain ratio."""
    if not isinstance(law, kinematics.StrainWave):
        return None
    return law.replace(fixed="flexspline" if law.fixed == "circular_spline" else "circular_spline")


def _source_of_ratio(gear_set: GearSet, other: Any, given: str) -> str:
    """Return the source of a ratio that a person gave; it states if the teeth stay and the other spline is fixed."""
    if other != _other_spline_fixed(gear_set.gear.kinematics):
        return given
    return f"{given}: {SAME_TEETH}, the {other.fixed.replace('_', ' ')}"


def remark_on_ratio(known: GearSoFar, file: Recognised) -> str:
    """Return that the ratio given with a file is that of the teeth of the set with its other spline fixed; empty if not."""
    entry = known.gear_set.sources.get(f"{KINEMATICS_PATHS}flexspline_teeth")
    return entry.source if entry is not None and "ratio" in file.constants and SAME_TEETH in entry.source else ""
