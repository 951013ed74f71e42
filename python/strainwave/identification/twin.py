"""The main job: measurements of a gear in, a validated model of that gear out."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, Literal

import numpy as np

from strainwave import Drive, arguments
from strainwave._core import Gear
from strainwave.equality import ComparedByFields
from strainwave.files.entries import Entry
from strainwave.files.gear_set import GearSet
from strainwave.files.ratings import RatingCheck, check_ratings
from strainwave.files.recording import Recording
from strainwave.identification.candidates.friction import fit_friction
from strainwave.identification.candidates.torsion import Friction, Nothing, TorsionCandidate, fit_loop, held_out_blocks
from strainwave.identification.dynamics.log import fit_log, free_parameters, prepared
from strainwave.identification.evidence.evidence import Doubt, Evidence
from strainwave.identification.evidence.explain import BETTER, allowed, causes, unexplained
from strainwave.identification.evidence.influence import Influence, influence
from strainwave.identification.evidence.plausible import doubts_of_loop, doubts_of_table, hint_of_ratio
from strainwave.identification.evidence.verdict import MOST_TOLD, Verdict, estimated, judged, known, numbers, verdicts
from strainwave.identification.experiments.drive_log import DriveLog
from strainwave.identification.experiments.friction_table import BESIDE, FrictionTable
from strainwave.identification.experiments.torsion_loop import TorsionLoop, at_input
from strainwave.identification.fitting.estimate import ONE_SIGMA, Estimate, student
from strainwave.identification.fitting.fit import Fit
from strainwave.identification.reading.measurement import Kind, read_measurement
from strainwave.messages import shortened
from strainwave.simulation.run import simulate

CONTRADICTION = 3.0  # standard deviations
SURE = 0.9973002039367398  # the share of a normal distribution within three
TRIED = 2  # likely causes of a bad fit that are fitted, best first
UNSURE = 1.2  # times the standard deviation within one law: what other laws say is then worth telling
NAMES: dict[Kind, str] = {"friction": "friction table", "torsion": "torsion loop", "log": "drive log"}
Measurement = Recording | str | Path


@dataclass(frozen=True)
class Contradiction:
    """Two data sets that disagree beyond their uncertainty: shown side by side, never averaged.

    Attributes:
        path: the parameter
        unit: its unit
        earlier: value in the initial model
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
        """Where the value in the initial model came from."""
        return self.known.source


@dataclass(frozen=True, eq=False)
class Twin(ComparedByFields):
    """A model of one particular gear, with the evidence for it.

    Attributes:
        start: the set it started from
        gear_set: the twin
        evidence: the measurements used
        verdicts: every parameter of the gear
        contradictions: where measurement and initial model exclude each other
        ratings: what the maker allows, beside what the gear went through in the measurements
    """

    start: GearSet
    gear_set: GearSet
    evidence: tuple[Evidence, ...]
    verdicts: tuple[Verdict, ...]
    contradictions: tuple[Contradiction, ...]
    ratings: tuple[RatingCheck, ...]

    @property
    def doubts(self) -> tuple[Doubt, ...]:
        """What speaks against the measurements as they were taken; to be settled before the twin is used."""
        return tuple(doubt for evidence in self.evidence for doubt in evidence.doubts)


def twin(
    start: GearSet | str | Path,
    *,
    friction: Measurement | None = None,
    torsion: Measurement | None = None,
    log: Measurement | None = None,
    side: Literal["input", "output"] | None = None,
    sources: dict[Kind, str] | None = None,
    progress: Callable[[str], None] = lambda stage: None,
) -> Twin:
    """Fits what each measurement can tell of a gear, validates on data held out, and says what cannot be told.

    A measurement may be a recording, or the path of a CSV or Parquet file.

    Args:
        start: the set to start from: a set, the name of one in the catalogue, or the path of a gear file
        friction: table with columns speed and torque
        torsion: loop, or a single loading branch, with columns twist and torque at the output, or input_angle and input_torque
            with the output locked
        log: run of the drive from rest with columns time, command and measured outputs (input_angle, output_angle, current …);
            the start set must then have a motor and a load
        side: where the friction table was measured; the input if not given, which is doubted if the gear it starts from speaks
            against it
        sources: where each measurement came from, for the record
        progress: called with the name of each stage as it begins

    Returns:
        the twin with its evidence; look at its `doubts` before it is used

    Raises:
        TypeError: a measurement is none
        ValueError: no measurement, or one that cannot be used; says which and why
        FloatingPointError: as `sw.fit`

    >>> import numpy as np, strainwave as sw
    >>> speed = np.array([1.0, 2.0, 5.0, 10.0, 20.0, 50.0])
    >>> table = sw.Recording({"speed": speed, "torque": 0.05 + 3e-4 * speed}, {"speed": "rad/s", "torque": "N.m"})
    >>> found = sw.twin("hfuc-25-100", friction=table)
    >>> round(found.gear_set.gear.friction_input.viscous, 9), found.doubts
    (0.0003, ())
    """
    given: dict[Kind, Measurement | None] = {"friction": friction, "torsion": torsion, "log": log}
    recordings = {kind: _recording(kind, measured) for kind, measured in given.items() if measured is not None}
    if not recordings:
        raise ValueError("a twin needs at least one measurement: a friction table, a torsion loop or a drive log")
    if side is not None:
        arguments.one_of("side", side, ("input", "output"))
    start = start if isinstance(start, GearSet) else GearSet.read(start)
    named = NAMES | {kind: Path(path).name for kind, path in given.items() if isinstance(path, str | Path)} | (sources or {})
    gear, evidence = start.gear, list[Evidence]()
    for kind in _order(recordings):
        progress(NAMES[kind])
        with _naming(named[kind]):
            evidence.append(_evidence(kind, recordings[kind], named[kind], start, gear, evidence, side))
        gear = evidence[-1].fit.gear
    found = verdicts(start, gear, evidence)
    return Twin(
        start,
        replace(start, name=f"{start.name}, twin", gear=gear, sources=_sources(start, found)),
        tuple(evidence),
        tuple(found),
        tuple(_contradictions(start, evidence)),
        tuple(check for each in evidence if not each.unexplained for check in check_ratings(start, _load(each))),
    )


def _recording(kind: Kind, given: Any) -> Recording:
    if isinstance(given, str | Path):
        return read_measurement(kind, given)
    if not isinstance(given, Recording):
        raise TypeError(f"{kind} must be a Recording or the path of a file, not {shortened(given)}")
    return given


def _order(recordings: dict[Kind, Recording]) -> list[Kind]:
    """What is needed to understand a measurement comes before it: friction before a loop that has it inside."""
    torsion = recordings.get("torsion")
    log_first = torsion is not None and at_input(torsion) and "friction" not in recordings
    order: list[Kind] = ["friction", "log", "torsion"] if log_first else ["friction", "torsion", "log"]
    return [kind for kind in order if kind in recordings]


@contextmanager
def _naming(source: str) -> Iterator[None]:
    """Puts the name of the measurement before whatever is wrong with it."""
    try:
        yield
    except ValueError as error:
        raise ValueError(f"{source}: {error}") from error


def _evidence(
    kind: Kind,
    recording: Recording,
    source: str,
    start: GearSet,
    gear: Gear,
    before: Sequence[Evidence],
    side: str | None,
) -> Evidence:
    """What a measurement says of the gear as it is known so far."""
    if kind == "friction":
        return _from_friction(gear, recording, source, side, start.gear)
    measured = {evidence.kind for evidence in before}
    if kind == "torsion":
        return _from_torsion(gear, recording, source, bool(measured & {"friction", "log"}), start.gear)
    return _from_log(start.drive.replace(gear=gear), recording, source, measured, known(start, before))


def _from_friction(gear: Gear, recording: Recording, source: str, side: str | None, start: Gear) -> Evidence:
    table = FrictionTable.of_output(recording, gear) if side == "output" else FrictionTable.of(recording)
    best, *others = fit_friction(table, gear)
    held_out = (table.torque - best.held_out)[np.newaxis]
    low, high = float(np.abs(table.speed).min()), float(np.abs(table.speed).max())
    remarks = [f"valid between {low:.4g} and {high:.4g} rad/s at the input; validated by leaving out speeds in turn"]
    if best.name == "Coulomb and viscous":
        remarks.append("no fall of torque towards low speed within this range: breakaway and Stribeck speed are not seen")
    within = np.sqrt(np.diag(best.fit.covariance)).tolist()
    unsure = [
        e.path.rpartition(".")[2] for e, sigma in zip(best.fit.estimates, within, strict=True) if e.sigma > UNSURE * sigma
    ]
    if unsure:
        remarks.append(
            f"other laws are about as likely: what they say of {', '.join(unsure)} is part of its standard deviation"
        )
    remarks += [*_thinned(table.samples, len(table.speed)), *_unused(recording, ("speed", "torque", *BESIDE))]
    if (left_out := int(np.sum(~best.fit.training))) > 0:
        remarks.append(f"{left_out} of {len(table.speed)} rows are outliers, and left out")
    doubts = [] if side == "input" else [*doubts_of_table(recording, best.fit, start, side)]
    doubts = doubts or [*_not_explained(best.fit)]
    return Evidence(
        "friction", source, recording, best.fit, held_out, np.array([best.error]),
        tuple((c.name, c.error) for c in (best, *others)), influence(best.fit), _shares(best.fit),
        _doubts(source, doubts), remarks=tuple(remarks),
    )  # fmt: skip


def _from_torsion(gear: Gear, recording: Recording, source: str, friction_measured: bool, start: Gear) -> Evidence:
    loop = TorsionLoop.of(recording, gear)
    best, *others = fit_loop(loop, gear, held_out_blocks(len(loop.twist)), friction_measured=friction_measured)
    remarks = [
        f"valid up to {np.abs(loop.torque).max():.4g} N·m and {0.5 * np.ptp(loop.twist):.4g} rad either way at the output"
    ]
    remarks += [*_of_friction(loop, best, gear, friction_measured), *_thinned(loop.samples, len(loop.twist))]
    remarks += hint_of_ratio(best.fit, start)
    remarks += _unused(recording, ("input_angle", "input_torque") if at_input(recording) else ("twist", "torque"))
    if isinstance(best.beside, Nothing):
        remarks.append(
            "one branch only: it tells neither hysteresis nor zeros, so the hysteresis is kept, and the gear is taken to have "
            "been unloaded at the zeros of both axes"
        )
    doubts = [*doubts_of_loop(recording, best.fit, start)] or [*_not_explained(best.fit)]
    return Evidence(
        "torsion", source, recording, best.fit, best.fit.residuals[:, ~best.fit.training], best.fit.rms(held_out=True),
        tuple((c.name, c.error) for c in (best, *others)), influence(best.fit), _shares(best.fit),
        _doubts(source, doubts), _shared(best, gear, loop, friction_measured), tuple(remarks),
    )  # fmt: skip


def _of_friction(loop: TorsionLoop, best: TorsionCandidate, gear: Gear, friction_measured: bool) -> Iterator[str]:
    """What a loop from the input has inside, and what became of it."""
    if loop.input_ratio is None:
        return
    yield "measured at the input with the output locked: friction of the wave generator is inside the loop"
    held = 0.5 * float(np.ptp(loop.friction(gear)))
    if friction_measured:
        yield f"the friction measured at the input, ±{held:.3g} N·m at the output, is taken out of it"
    elif isinstance(best.beside, Friction):
        yield (
            "friction at the input was not measured: the loop tells the sum of friction and hysteresis only. Friction is "
            "fitted, and the hysteresis kept; give a friction table to tell them apart"
        )
    elif held > 0.0:
        yield (
            "friction at the input was not measured: the loop tells the sum of friction and hysteresis only. Friction is "
            f"kept, ±{held:.3g} N·m at the output, and the rest is hysteresis; give a friction table to tell them apart"
        )
    else:
        yield "no friction at the input is known: all of it is fitted as hysteresis, of which a turning gear shows nothing"


def _shared(best: TorsionCandidate, gear: Gear, loop: TorsionLoop, friction_measured: bool) -> dict[str, str]:
    """Parameters that a loop tells only together with what was kept."""
    if loop.single_branch:
        why = "a single branch tells the torque of spring and hysteresis together, and the hysteresis was kept"
        return {f"gear.{estimate.path}": why for estimate in best.fit.estimates}
    if loop.input_ratio is None or friction_measured or not np.any(loop.friction(gear)):
        return {}
    ratio = abs(loop.input_ratio)
    if isinstance(best.beside, Friction):
        why = f"the loop tells {ratio:g} x friction_input.breakaway and the torque of the hysteresis, which was kept, together"
        return {"gear.friction_input.breakaway": why}
    why = f"the loop tells the torque of the hysteresis and {ratio:g} x friction_input.breakaway, which was kept, together"
    paths = [estimate.path for estimate in best.fit.estimates if estimate.path.startswith("hysteresis.breakaway")]
    return {f"gear.{path}": why for path in paths}


def _from_log(drive: Drive, recording: Recording, source: str, measured: set[Kind], sources: Mapping[str, Entry]) -> Evidence:
    log = DriveLog.of(recording, drive)
    drive = prepared(log, drive, friction_known="friction" in measured)
    free = free_parameters(log, drive, friction_known="friction" in measured, torsion_known="torsion" in measured)
    found = fit_log(log, drive, free)
    both = {"input_angle", "output_angle"} <= set(log.channels)
    remarks = ["validated on the last 30 % of the record", *_thinned(log.samples, len(log.time))]
    if log.time[-1] < 0.99 * np.ptp(recording.time):
        remarks.append(f"of its {np.ptp(recording.time):.4g} s the first {log.time[-1]:.4g} s are taken, to fit in little time")
    remarks += _unused(recording, ("time", "command", *log.channels))
    if not both:
        remarks.append("one encoder only: kinematic error and stiffness are not seen")
    name = ", ".join(path.removeprefix("gear.") for path in free) or "nothing free"
    doubts = [*_not_explained(found.fit)]
    of_kept = Influence.none(len(found.fit.estimates)) if doubts else influence(found.fit)
    if doubts:
        doubts = [_with_cause(doubts[0][0], found.fit, recording, drive, free)]
    elif wrong := of_kept.suspects(sources):
        remarks.append(_of_suspects(of_kept, wrong))
    return Evidence(
        "log", source, recording, found.fit, found.fit.residuals[:, ~found.fit.training], found.error,
        ((name, float(found.error[0])),), of_kept, _shares(found.fit),
        _doubts(source, doubts), remarks=tuple(remarks),
    )  # fmt: skip


def _of_suspects(of_kept: Influence, wrong: Sequence[int]) -> str:
    told = [
        f"{each.path} = {each.value:.4g} {each.unit} (about {each.value + of_kept.pulls[place]:.3g} {each.unit} would leave "
        f"{100.0 * of_kept.gains[place]:.0f} % less of the residuals' power)"
        for place in wrong[:MOST_TOLD]
        for each in [of_kept.kept[place]]
    ]
    return f"the log speaks against what was kept: {' or '.join(told)}. Measure them, or free one"


def _unused(recording: Recording, used: Collection[str]) -> Iterator[str]:
    """What was recorded too, and no fit uses."""
    if unused := [name for name in recording.names if name not in used]:
        yield f"not used: {', '.join(unused)}"


def _thinned(samples: int, taken: int) -> Iterator[str]:
    if samples > taken:
        yield f"of its {samples} samples {taken} were compared"


def _doubts(source: str, found: Sequence[tuple[str, str]]) -> tuple[Doubt, ...]:
    return tuple(Doubt(source, what, remedy) for what, remedy in found)


def _shares(found: Fit) -> dict[str, float]:
    """Channels of which the model leaves too much unexplained."""
    shares = zip(found.experiment.channels, unexplained(found).tolist(), allowed(found).tolist(), strict=True)
    return {name: share for name, share, most in shares if share > most}


def _not_explained(found: Fit) -> Iterator[tuple[str, str]]:
    if shares := _shares(found):
        told = ", ".join(f"{100.0 * share:.0f} % of the variation of {name}" for name, share in shares.items())
        yield (
            f"the model does not explain it: {told} is left. Nothing is identified from it",
            "look at the plot; see whether signs, units, sides, ratio and zeros are right",
        )


def _with_cause(what: str, found: Fit, recording: Recording, drive: Drive, free: list[str]) -> tuple[str, str]:
    """The doubt with the mistake that would explain it, if one does."""
    before = float(unexplained(found).max())
    for cause in causes(recording, drive)[:TRIED]:
        log = DriveLog.of(cause.recording, cause.drive)
        again = fit_log(log, prepared(log, cause.drive, friction_known=False), free).fit
        if not _shares(again):
            return f"{what}. {cause.what[0].upper()}{cause.what[1:]}: then it is explained", cause.remedy
        if float(unexplained(again).max()) < BETTER * before:
            return f"{what}. Perhaps {cause.what}: then less is left", cause.remedy
    return (
        what,
        "no single mistake in sign, unit, side or ratio explains it; look at the plot, and at what is known of the drive",
    )


def _load(evidence: Evidence) -> Recording:
    """What the gear went through in a measurement: torque at the output or, in a friction table, speed and torque at the input.

    Of a log, whose torque nobody measured, as the fitted drive has it.
    """
    experiment = evidence.fit.experiment
    if isinstance(experiment, DriveLog):
        model = evidence.fit.model
        run = simulate(model, experiment.command, experiment.step(model), sample=experiment.interval)
        return Recording(run.columns, run.units, evidence.source)
    assert isinstance(experiment, TorsionLoop | FrictionTable)
    columns = {"torque": experiment.torque}
    if isinstance(experiment, FrictionTable):
        columns["speed"] = experiment.speed
    return Recording(columns, {name: {"torque": "N.m", "speed": "rad/s"}[name] for name in columns}, evidence.source)


def _sources(start: GearSet, found: Sequence[Verdict]) -> dict[str, Entry]:
    # the rest of the drive, and counts of teeth, are no numbers of the gear that a fit can touch
    of_gear = numbers(start.gear)
    sources = {path: entry for path, entry in start.sources.items() if path not in of_gear}
    words = {"identified": "identified from", "identified in combination": "identified in combination:"}
    for verdict in found:
        if verdict.state == "kept" and verdict.value == verdict.start and verdict.path in start.sources:
            sources[verdict.path] = start.sources[verdict.path]
        elif verdict.state == "kept":
            sources[verdict.path] = Entry(source=f"assumed: {verdict.why}")
        else:
            prefix = words.get(verdict.state, "fitted but not identified:")
            uncertainty = verdict.sigma if np.isfinite(verdict.sigma) else None
            sources[verdict.path] = Entry(source=f"{prefix} {verdict.why}", uncertainty=uncertainty)
    return sources


def _contradictions(start: GearSet, evidence: Sequence[Evidence]) -> list[Contradiction]:
    """Identified parameters that a measured or published starting value excludes. Assumed values contradict nothing."""
    before, found, sources = numbers(start.gear), [], known(start, evidence)
    for path, (e, index, estimate) in estimated(evidence).items():
        if judged(e, index, sources)[0] != "identified":
            continue
        kept = float(np.linalg.norm([*e.influence.doubt(index, sources, e.prefix).values(), 0.0]))
        if path in before and "[" not in path:
            found.append(_compared(path, *before[path], start.sources[path], estimate, kept, e))
        elif path.startswith("gear.stiffness.") and index == 0 and path not in before:
            found.append(_compared_springs(start, estimate, kept, e))
    return [contradiction for contradiction in found if contradiction is not None]


def _compared(
    path: str, earlier: float, unit: str, entry: Entry, estimate: Estimate, kept: float, evidence: Evidence
) -> Contradiction | None:
    """The contradiction between an earlier value and an estimate, if there is one.

    `kept` is what the parameters kept add to the uncertainty of the estimate.
    """
    if entry.assumed:
        return None
    few = student(SURE, estimate.freedom) / student(ONE_SIGMA, estimate.freedom) / CONTRADICTION
    doubt = np.linalg.norm([few * estimate.sigma, kept, (entry.spread or 0.0) * earlier, entry.uncertainty or 0.0])
    distance = abs(estimate.value - earlier) / doubt if doubt > 0.0 else np.inf
    if distance <= CONTRADICTION:
        return None
    return Contradiction(path, unit, earlier, entry, estimate.value, estimate.sigma, float(distance), evidence.source)


def _compared_springs(start: GearSet, estimate: Estimate, kept: float, evidence: Evidence) -> Contradiction | None:
    """Springs of different kinds, compared by their stiffness at zero twist, if that is the first parameter of the earlier."""
    name = start.gear.stiffness.fields[0]["name"]
    earlier, first = start.gear.stiffness.tangent(0.0), f"gear.stiffness.{name}"
    if earlier != getattr(start.gear.stiffness, name):
        return None
    return _compared(f"gear.{estimate.path}", earlier, estimate.unit, start.sources[first], estimate, kept, evidence)
