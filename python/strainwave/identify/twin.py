"""The main job: measurements of a gear in, a validated model of that gear out."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from strainwave import _core
from strainwave._core import Gear
from strainwave.drives import PositionDrive
from strainwave.gear_set import NOT_GIVEN, Entry, GearSet
from strainwave.identify.experiment import DriveLog, FrictionTable, TorsionLoop, at_input
from strainwave.identify.fit import Estimate, Fit
from strainwave.identify.friction import fit_friction
from strainwave.identify.log import fit_log, free_parameters, prepared
from strainwave.identify.measurement import Kind
from strainwave.identify.torsion import fit_loop, kept_back
from strainwave.recording import Recording

Array = NDArray[np.float64]

UNTOLD = 0.5  # relative standard deviation above which a parameter counts as not identified
ENTANGLED = 0.98  # correlation above which two parameters cannot be told apart
CONTRADICTION = 3.0  # standard deviations


@dataclass(frozen=True)
class Evidence:
    """One measurement and what became of it.

    Attributes:
        kind: friction, torsion or log
        source: where the measurement came from
        recording: the measurement
        fit: the model fitted to it
        held_out: measured less predicted where the data were kept back, shape (channels, m)
        error: rms of `held_out`, shape (channels,), in the units of `fit.experiment`
        candidates: name and held-out error of every model tried, best first
        remarks: what the reader must know
    """

    kind: Kind
    source: str
    recording: Recording
    fit: Fit
    held_out: Array
    error: Array
    candidates: tuple[tuple[str, float], ...]
    remarks: tuple[str, ...] = ()


@dataclass(frozen=True)
class Verdict:
    """What is known of one parameter of the twin, and why.

    Attributes:
        path: where it stands, as "gear.stiffness.k1"
        unit: its unit
        start: value in the starting set; not-a-number where the set had none
        value: value in the twin
        sigma: standard deviation; not-a-number for one that was kept
        state: identified, not identified (though fitted), or kept from the starting set
        why: the reason, or the source
    """

    path: str
    unit: str
    start: float
    value: float
    sigma: float
    state: Literal["identified", "not identified", "kept"]
    why: str


@dataclass(frozen=True)
class Contradiction:
    """Two data sets that disagree beyond their uncertainty: shown side by side, never averaged.

    Attributes:
        path: the parameter
        unit: its unit
        earlier: value in the starting set
        known: where that came from, and how well it is known
        measured: value that the measurement gives
        sigma: its standard deviation
        distance: difference over the uncertainty of both [1]
        source: where the measurement came from
    """

    path: str
    unit: str
    earlier: float
    known: Entry
    measured: float
    sigma: float
    distance: float
    source: str

    @property
    def earlier_source(self) -> str:
        """Where the value in the starting set came from."""
        return self.known.source


@dataclass(frozen=True)
class Twin:
    """A model of one particular gear, with the evidence for it.

    Attributes:
        start: the set it started from
        gear_set: the twin
        evidence: the measurements used
        verdicts: every parameter of the gear
        contradictions: where measurement and starting set exclude each other
    """

    start: GearSet
    gear_set: GearSet
    evidence: tuple[Evidence, ...]
    verdicts: tuple[Verdict, ...]
    contradictions: tuple[Contradiction, ...]


def twin(
    start: GearSet,
    *,
    friction: Recording | None = None,
    torsion: Recording | None = None,
    log: Recording | None = None,
    sources: dict[Kind, str] | None = None,
    other_specimen: Collection[str] = (),
    progress: Callable[[str], None] = lambda stage: None,
) -> Twin:
    """Fits what each measurement can tell of a gear, validates on data kept back, and says what cannot be told.

    Args:
        start: the set to start from: a catalogue set, or a file of one's own
        friction: table with columns speed and torque, input side
        torsion: loop with columns twist and torque, or input_angle and input_torque with the output locked
        log: run of the drive from rest with columns time, command and measured outputs (input_angle, output_angle, current …);
            the start set must then have a motor and a load
        sources: where each measurement came from, for the record
        other_specimen: measurements of another specimen than the starting set describes; these contradict nothing in it
        progress: called with the name of each stage as it begins

    Returns:
        the twin with its evidence

    Raises:
        ValueError: no measurement, or one that cannot be used; says which and why

    >>> import numpy as np, strainwave as sw
    >>> speed = np.array([1.0, 2.0, 5.0, 10.0, 20.0, 50.0])
    >>> table = sw.Recording({"speed": speed, "torque": 0.02 + 3e-4 * speed}, {"speed": "rad/s", "torque": "N.m"})
    >>> found = sw.twin(sw.GearSet.read("hfuc-25-100"), friction=table)
    >>> round(found.gear_set.gear.friction_input.viscous, 9)
    0.0003
    """
    if friction is None and torsion is None and log is None:
        raise ValueError("a twin needs at least one measurement: a friction table, a torsion loop or a drive log")
    named = {"friction": "friction table", "torsion": "torsion loop", "log": "drive log"} | (sources or {})
    gear = start.gear
    evidence: list[Evidence] = []
    if friction is not None:
        progress("friction table")
        with _naming(named["friction"]):
            evidence.append(_from_friction(gear, friction, named["friction"]))
        gear = evidence[-1].fit.gear
    if torsion is not None:
        progress("torsion loop")
        with _naming(named["torsion"]):
            evidence.append(_from_torsion(gear, torsion, named["torsion"]))
        gear = evidence[-1].fit.gear
    if log is not None:
        progress("drive log")
        with _naming(named["log"]):
            evidence.append(_from_log(start.drive.replace(gear=gear), log, named["log"], {e.kind for e in evidence}))
        gear = evidence[-1].fit.gear
    verdicts = _verdicts(start, gear, evidence)
    found = replace(start, name=f"{start.name}, twin", gear=gear, sources=_sources(start, verdicts))
    return Twin(
        start,
        found,
        tuple(evidence),
        tuple(verdicts),
        tuple(_contradictions(start, [e for e in evidence if e.kind not in other_specimen])),
    )


@contextmanager
def _naming(source: str) -> Iterator[None]:
    """Puts the name of the measurement before whatever is wrong with it."""
    try:
        yield
    except ValueError as error:
        raise ValueError(f"{source}: {error}") from error


def _from_friction(gear: Gear, recording: Recording, source: str) -> Evidence:
    table = FrictionTable.of(recording)
    best, *others = fit_friction(table, gear)
    held_out = (table.torque - best.held_out)[np.newaxis]
    low, high = float(np.abs(table.speed).min()), float(np.abs(table.speed).max())
    remarks = [f"valid between {low:.4g} and {high:.4g} rad/s at the input; validated by leaving out speeds in turn"]
    if best.name == "Coulomb and viscous":
        remarks.append("no fall of torque towards low speed within this range: breakaway and Stribeck speed are not seen")
    return Evidence(
        "friction", source, recording, best.fit, held_out, np.array([best.error]),
        tuple((c.name, c.error) for c in (best, *others)), tuple(remarks),
    )  # fmt: skip


def _from_torsion(gear: Gear, recording: Recording, source: str) -> Evidence:
    loop = TorsionLoop.of(recording, gear)
    best, *others = fit_loop(loop, gear, kept_back(len(loop.twist)))
    remarks = [
        f"valid up to {np.abs(loop.torque).max():.4g} N·m and {0.5 * np.ptp(loop.twist):.4g} rad either way at the output"
    ]
    if at_input(recording):
        remarks.append("measured at the input with the output locked: friction of the wave generator is inside the loop")
    return Evidence(
        "torsion", source, recording, best.fit, best.fit.residuals[:, ~best.fit.training], best.fit.rms(held_out=True),
        tuple((c.name, c.error) for c in (best, *others)), tuple(remarks),
    )  # fmt: skip


def _from_log(drive: PositionDrive, recording: Recording, source: str, known: set[Kind]) -> Evidence:
    log = DriveLog.of(recording, drive)
    drive = prepared(log, drive)
    free = free_parameters(log, drive, friction_known="friction" in known, torsion_known="torsion" in known)
    found = fit_log(log, drive, free)
    both = {"input_angle", "output_angle"} <= set(log.channels)
    remarks = [
        "validated on the last 30 % of the record",
        "standard deviations take the parameters kept as right; where these are wrong, those fitted here are off by more",
    ]
    if not both:
        remarks.append("one encoder only: kinematic error and stiffness are not seen")
    name = ", ".join(path.removeprefix("gear.") for path in free) or "nothing free"
    return Evidence(
        "log", source, recording, found.fit, found.fit.residuals[:, ~found.fit.training], found.error,
        ((name, float(found.error[0])),), tuple(remarks),
    )  # fmt: skip


def _path(evidence: Evidence, estimate: Estimate) -> str:
    """Where an estimate stands in the gear; fits of a gear alone leave the first word out."""
    return estimate.path if evidence.kind == "log" else f"gear.{estimate.path}"


def _estimates(evidence: Sequence[Evidence]) -> dict[str, tuple[Evidence, int, Estimate]]:
    """The free parameters of all fits, the latest of each."""
    return {
        _path(e, estimate): (e, i, estimate)
        for e in evidence
        for i, estimate in enumerate(e.fit.estimates[: len(e.fit.estimates) - len(e.fit.experiment.nuisances)])
    }


def _parameters(gear: Gear) -> dict[str, tuple[float, str]]:
    return {f"gear.{path}": (value, unit) for path, value, unit, *_ in _core.parameters(gear)}


def _verdicts(start: GearSet, gear: Gear, evidence: Sequence[Evidence]) -> list[Verdict]:
    before, estimates = _parameters(start.gear), _estimates(evidence)
    verdicts = []
    for path, (value, unit) in _parameters(gear).items():
        # the elements of a fitted sequence are new ones: their places say nothing of the old
        known = path in before and not ("[" in path and path in estimates)
        earlier = before[path][0] if known else np.nan
        if path in estimates:
            e, index, estimate = estimates[path]
            reason = _why_not(e, index, estimate)
            state: Literal["identified", "not identified"] = "not identified" if reason else "identified"
            verdicts.append(Verdict(path, unit, earlier, value, estimate.sigma, state, reason or e.source))
        else:
            entry = start.sources.get(path)
            why = "no measurement given speaks of it" + (f"; {entry.source}" if entry is not None else "")
            if path not in before:
                why = "set by the method of the fit beside it"
            elif value != earlier:
                why = "follows from the parameters fitted beside it; no measurement given speaks of it"
            verdicts.append(Verdict(path, unit, earlier, value, np.nan, "kept", why))
    return verdicts


def _why_not(evidence: Evidence, index: int, estimate: Estimate) -> str:
    """Why the data do not tell a parameter; empty where they do."""
    if not np.isfinite(estimate.sigma):
        return f"{evidence.source} stays the same when it changes"
    if estimate.at_limit:
        return f"ended at the limit of what it may be; {evidence.source} pulls it beyond"
    if ".phase[" in estimate.path:
        if estimate.sigma > UNTOLD:
            return f"standard deviation is {estimate.sigma:.2g} rad"
    elif estimate.sigma > UNTOLD * abs(estimate.value):
        return "standard deviation exceeds half the value"
    correlation = np.abs(evidence.fit.correlation[index])
    correlation[index] = 0.0
    partner = int(np.nanargmax(correlation)) if np.isfinite(correlation).any() else index
    if correlation[partner] > ENTANGLED:
        other = evidence.fit.estimates[partner].path
        return f"cannot be told apart from {other}: correlation {evidence.fit.correlation[index, partner]:+.3f}"
    return ""


def _sources(start: GearSet, verdicts: Sequence[Verdict]) -> dict[str, Entry]:
    numbers = _parameters(
        start.gear
    )  # the rest of the drive, and counts of teeth, are no numbers of the gear that a fit can touch
    sources = {path: entry for path, entry in start.sources.items() if path not in numbers}
    for verdict in verdicts:
        if verdict.state == "kept" and verdict.value == verdict.start and verdict.path in start.sources:
            sources[verdict.path] = start.sources[verdict.path]
        elif verdict.state == "kept":
            sources[verdict.path] = Entry(source=f"assumed: {verdict.why}")
        else:
            prefix = "identified from " if verdict.state == "identified" else "fitted but not identified: "
            uncertainty = verdict.sigma if np.isfinite(verdict.sigma) else None
            sources[verdict.path] = Entry(source=prefix + verdict.why, uncertainty=uncertainty)
    return sources


def _contradictions(start: GearSet, evidence: Sequence[Evidence]) -> list[Contradiction]:
    """Identified parameters that a measured or published starting value excludes. Assumed values contradict nothing."""
    before, found = _parameters(start.gear), []
    for path, (e, index, estimate) in _estimates(evidence).items():
        if path in before and "[" not in path and not _why_not(e, index, estimate):
            found.append(_compared(path, *before[path], start.sources[path], estimate, e))
        elif path.startswith("gear.stiffness.") and index == 0 and path not in before:
            found.append(_compared_springs(start, estimate, e))
    return [contradiction for contradiction in found if contradiction is not None]


def _compared(
    path: str, earlier: float, unit: str, entry: Entry, estimate: Estimate, evidence: Evidence
) -> Contradiction | None:
    """The contradiction between an earlier value and an estimate, if there is one."""
    if entry.source.startswith("assumed") or entry.source == NOT_GIVEN:
        return None
    doubt = np.hypot(estimate.sigma, np.hypot((entry.spread or 0.0) * earlier, entry.uncertainty or 0.0))
    distance = abs(estimate.value - earlier) / doubt if doubt > 0.0 else np.inf
    if distance <= CONTRADICTION:
        return None
    return Contradiction(path, unit, earlier, entry, estimate.value, estimate.sigma, float(distance), evidence.source)


def _compared_springs(start: GearSet, estimate: Estimate, evidence: Evidence) -> Contradiction | None:
    """Springs of different kinds, compared by their stiffness at zero twist, if that is the first parameter of the earlier."""
    name = start.gear.stiffness.fields[0]["name"]
    earlier, first = start.gear.stiffness.tangent(0.0), f"gear.stiffness.{name}"
    if earlier != getattr(start.gear.stiffness, name):
        return None
    return _compared(f"gear.{estimate.path}", earlier, estimate.unit, start.sources[first], estimate, evidence)
