"""Torsion loops and branches: torque over twist with one side of the gear locked."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Sequence
from contextlib import suppress
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from strainwave import Gear
from strainwave.analysis.branches import turning_points
from strainwave.files.gear_set import GearSet
from strainwave.files.labels import Label
from strainwave.files.recording import Recording
from strainwave.files.units import base_exponents
from strainwave.identification.candidates.torsion import (
    InputFriction,
    Nothing,
    TorsionCandidate,
    fit_loop,
    held_out_blocks,
    plain_error,
)
from strainwave.identification.candidates.torsion.candidate import MIN_ERROR_SHARE, asymmetry_in_words
from strainwave.identification.candidates.torsion.losses.shares import loss_shares
from strainwave.identification.candidates.torsion.ranking import rank_loop
from strainwave.identification.candidates.torsion.spread import spread_by_models, spread_by_shape
from strainwave.identification.checks.sizes import clipping, hint_of_ratio, stiffness_of_loop
from strainwave.identification.checks.unexplained import MAX_CHANCE_OF_SHAPE, OVER_LOOP, explained, judged_shape
from strainwave.identification.experiments.loss_loop import LossLoop
from strainwave.identification.experiments.torsion_loop import TorsionLoop, at_input
from strainwave.identification.fitting.influence import influence
from strainwave.identification.fitting.unknowns import Estimate
from strainwave.identification.kinds.kind import Kind, Ranked, exceeded, thinned, unused
from strainwave.identification.reading.mapping import FileMapping
from strainwave.identification.reading.motion import turns_steadily
from strainwave.identification.reading.names import Channel
from strainwave.identification.reading.recognise import Recognised
from strainwave.identification.reading.roles import Column, ColumnRoles, first, measured, needed, pair
from strainwave.identification.results.file_result import ASSUMED_BY_RECORDER, FileResult, HeldOut
from strainwave.identification.results.gear_so_far import GearSoFar
from strainwave.identification.results.identifiability import JudgedFit
from strainwave.identification.results.pictures import Picture
from strainwave.questions import LOG_AT_RATE, Answer, QuestionError
from strainwave.statistics.determined_sum import DeterminedSum
from strainwave.statistics.residuals import shape
from strainwave.typeset import number, percent, quantity

Array = NDArray[np.float64]
MAX_ERROR_OF_RICHER = 0.8  # of the error of the model that is taken: a richer one that gains less is no remark

MIN_LOOP_ROWS = 4  # of a loop or branch
MIN_TURNING = 2.0 * np.pi  # rad: a shaft that runs on for longer is not twisted
MAX_TWIST = 0.3  # rad of a gear at the output
MIN_STIFFNESS_AT_OUTPUT = 2000.0  # N.m/rad: over the smallest ratio squared, 900, no gear of a catalogue is as stiff
MIN_CORRELATION_OF_SPRING = 0.9  # of torque and angle, if the torque alternates
MIN_INTERVAL_OF_STEPS = 1.0  # s between rows of a shaft that is loaded in steps; at such a rate a log shows no motion
MAX_OFF_COMPUTED = 0.02  # of a torque's standard deviation: hysteresis of any gear leaves more beside a multiple of the twist
SERIES_STIFFNESS = "series_stiffness"  # of a spring behind the gear
GAIN_PLACES = 360  # of the turn of the input at which a loop may begin
MIN_LOOPS_OF_SOURCES = 2  # that differ in load, side, rate or temperature separate sources of loss
LOSS_NAME, LOSS_TITLE = "all torsion loops", "the loss of a cycle by its source"
FRICTION_KINDS = {"friction", "effort"}  # kinds that determine the friction inside a loop at the input


class Torsion(Kind):
    """Twist and torque at the output, or angle and torque of the input with the output locked."""

    needs = "twist and torque, or input_angle and input_torque"
    time = "used"

    def recognises(self, columns: Sequence[Column], mapping: FileMapping) -> bool:
        """True for a twist and a torque, or for an angle and a torque if the angle may be a twist: a turning shaft is none.

        Raises:
            QuestionError: these may be samples of a log
        """
        angles, torques = measured(columns, "angle"), measured(columns, "torque")
        if measured(columns, "twist") and torques:
            return True
        if not angles or not torques:
            return False
        column, angle, torque = angles[0], angles[0].si, torques[0].si
        if (speeds := measured(columns, "speed")) and turns_steadily(angle, speeds[0].si):
            return False
        if _exceeds_twist(column, mapping):
            loop = [] if measured(columns, "speed") else [Answer("a torsion loop all the same", {"kind": "torsion"})]
            raise QuestionError(
                f"{column.name} moves by {np.ptp(angle):.3g} rad, by which no gear twists", [LOG_AT_RATE, *loop]
            )
        return bool(abs(angle[-1] - angle[0]) <= MIN_TURNING or turning_points(angle) or _is_spring(angle, torque))

    def roles(self, columns: Sequence[Column], mapping: FileMapping) -> ColumnRoles:
        torque = needed(columns, "torque", self.title)
        twist = _twist_of(columns)
        angle = twist or needed(columns, "angle", self.title)
        both, rows = pair(angle, torque), len(angle.si)
        if rows < MIN_LOOP_ROWS:
            raise QuestionError(f"{rows} rows of {both} are no torsion loop or branch; {MIN_LOOP_ROWS} are the least")
        turns = len(turning_points(angle.si))
        branch = "one branch of a torsion loop, which shows stiffness only"
        shape = f"a torsion loop with {turns} reversal{'s' if turns > 1 else ''}" if turns else branch
        why = f"its columns are {both}, {rows} rows: {shape}"
        side = mapping.side or torque.channel.side or angle.channel.side or ("output" if twist else None)
        conditions = {**first(columns, "time"), **first(columns, "temperature")}
        if side == "input":
            locked = "the output was locked, and the friction of the input is in the loop"
            of_input = f"angle and torque are those of the input: {locked}"
            return ColumnRoles(self.name, {**conditions, "input_angle": angle, "input_torque": torque}, side, (why, of_input))
        of_side = ["twist and torque are those of the output"]
        if side is None:
            of_side.append(_why_output(angle, torque))
        counted = f"{torque.name} is a torque of the motor, counted at the output: the friction of the input is in the loop"
        remarks: tuple[str, ...] = (counted,) if _is_of_motor(torque.name) else ()
        if side == "output" and (stiffness := _series_stiffness(angle.si, torque.si)):
            torque = replace(torque, si=float(np.copysign(1.0, stiffness)) * torque.si)
            remarks += (_computed(angle, torque, stiffness),)
            remarks += tuple(
                f"{current.name} is not used: the spring lies between the two angles, and would be taken for the gear's; for "
                "the friction of the gear write time, the angle of the motor and the current to a file of their own"
                for current in measured(columns, "current")
            )
        return ColumnRoles(self.name, {**conditions, "twist": angle, "torque": torque}, "output", (why, *of_side), remarks)

    def turn(self, file: Recognised, kinds: Collection[str]) -> tuple[str, int]:
        """Return its turn: loops at the output go first, as they separate hysteresis from friction."""
        if "input_angle" not in file.recording:
            return self.name, 0
        return ("torsion", 1) if FRICTION_KINDS & set(kinds) or "run" not in kinds else ("run", 1)

    def fit(self, file: Recognised, known: GearSoFar) -> tuple[FileResult, GearSoFar]:
        """Fit springs with Maxwell elements."""
        name, gear, start = file.path.name, known.gear_set.gear, known.initial
        loop = TorsionLoop.of(file.recording, gear)
        friction_measured = "friction_input" in known.determined
        training = held_out_blocks(len(loop.twist))
        best, *others = fits = fit_loop(loop, gear, training, friction_measured=friction_measured)
        odd = [each for each in others if not each.is_one_sided]
        in_series = loop.input_ratio is None and _series_stiffness(file.recording["twist"], file.recording["torque"])
        of_set = () if in_series else stiffness_of_loop(file.recording, best.fit, start, name)
        checks = [clipping(file.recording, name), *of_set]
        whole = explained(best.fit, name)
        shared, left = _shared(best, gear, loop, friction_measured), best.fit.residuals[0]
        varies = float(np.std(best.fit.experiment.measured))
        shaped = judged_shape(left, {OVER_LOOP: np.arange(float(len(left)))}, varies, "N.m", name, ordered=True)
        gain_sigma, by_models, by_shape = _gain_sigma(loop, gear), spread_by_models(best, others), spread_by_shape(best)
        by_gain = {estimate.path: _by_gain(estimate, gain_sigma) for estimate in best.fit.estimates}
        spread = {path: float(np.linalg.norm([by_models[path], by_shape[path], gain])) for path, gain in by_gain.items()}
        fitted = JudgedFit(best.fit, name, influence(best.fit), not whole.failed, shared, spread=spread)
        fit, estimates = fitted.with_set_before(known)
        result = FileResult(
            name, file, best.name, estimates,
            (
                *file.remarks, *_remarks(file.recording, loop, best, gear, friction_measured, start),
                *asymmetry_in_words(fits),
                *_of_error(gain_sigma, loop), *shaped.remarks, *_of_richer_model(best, odd, left),
            ),
            (*checks, *([] if any(check.failed for check in checks) else [whole, *shaped.checks])),
            pictures=(Picture(fit.curves()[0], "loop", "torque" + _place(loop)),),
            held_out=_held_out(best),
            candidates=tuple((each.name, each.error) for each in (best, *others)), fit=fit,
        )  # fmt: skip
        if in_series:
            assumed = {"series stiffness": f"{abs(in_series):.4g} N·m/rad, which the recorder assumed and did not measure"}
            unmeasured = tuple(
                replace(
                    each, path=each.path.replace("gear.stiffness.k", SERIES_STIFFNESS), sigma=np.inf, why=ASSUMED_BY_RECORDER,
                    in_combination=False,
                )
                for each in estimates
            )  # fmt: skip
            return replace(result, estimates=unmeasured, unchecked=assumed), known
        if whole.failed or known.knows_better("stiffness", estimates):
            return result, known
        # a loop at the input has friction inside, and an error of the table of friction becomes hysteresis
        parts = (
            {"stiffness"} if loop.input_ratio is not None and "hysteresis" in known.determined else {"stiffness", "hysteresis"}
        )
        if isinstance(best.dissipation, InputFriction):
            parts |= {"friction_input"}
        return result, known.with_fit(fit.gear, parts, estimates, name).judged("stiffness", estimates)

    def fit_together(self, files: Sequence[Recognised], known: GearSoFar) -> tuple[tuple[FileResult, ...], GearSoFar]:
        """Split the loss of all loops by its source."""
        gear, loops = known.gear_set.gear, list[Recording]()
        for file in files:
            with suppress(ValueError):  # a branch, or a loop of several amplitudes
                loops.append(lossy_loop(file, gear))
        if len(loops) < MIN_LOOPS_OF_SOURCES:
            return (), known
        try:
            shares = loss_shares(loops, gear)
        except ValueError as error:
            return (FileResult(LOSS_NAME, what=LOSS_TITLE, refused=str(error)),), known
        return (FileResult(LOSS_NAME, what=LOSS_TITLE, model=shares.in_words, remarks=shares.lines),), known

    def rank(self, file: Recognised, known: GearSoFar) -> tuple[Ranked, ...]:
        """Return all springs and hysteresis laws by their error on data held out."""
        ranking = rank_loop(TorsionLoop.of(file.recording, known.gear_set.gear), known.gear_set.gear)
        return tuple(
            Ranked(each.name, each.parameters, each.error, each.standard_error, "N.m", each.correlation, 1e6 * each.cost)
            for each in ranking
        )


def lossy_loop(file: Recognised, gear: Gear) -> Recording:
    """Return the loop of a file for `loss_shares`: at the input if its torque is the motor's, although counted at the output.

    Raises:
        ValueError: as `LossLoop.of`
    """
    ratio, recording = gear.kinematics.ratio, file.at_ratio(gear.kinematics.ratio).recording
    if "twist" in recording and _is_of_motor(file.columns["torque"]):
        at_input = recording.with_column("input_angle", ratio * recording.values("twist", "rad"), "rad")
        at_input = at_input.with_column("input_torque", recording.values("torque", "N.m") / ratio, "N.m")
        recording = at_input.select([name for name in at_input.names if name not in ("twist", "torque")])
    LossLoop.of(recording, gear)
    return recording


def _is_of_motor(name: str) -> bool:
    return "motor" in name.casefold()


def is_loaded_spring(columns: Sequence[Column], mapping: FileMapping) -> bool:
    """True for a spring that a rig loads, with time: a log has more rows in a second, turns, or is softer than any gear."""
    times, angles, torques = (measured(columns, quantity) for quantity in ("time", "angle", "torque"))
    if not times or len(angles) != 1 or len(torques) != 1 or measured(columns, "speed", "current", "voltage"):
        return False
    angle, torque = angles[0].si, torques[0].si
    if _exceeds_twist(angles[0], mapping):
        return False
    if in_steps(times[0].si, angle, torque):
        return True
    if not _is_spring(angle, torque) or np.ptp(angle) >= MAX_TWIST:
        return False
    # weight and inertia of no joint are as stiff as a gear
    return bool(np.cov(angle, torque)[0, 1] > MIN_STIFFNESS_AT_OUTPUT * np.var(angle))


def is_series_spring(columns: Sequence[Column]) -> bool:
    """True for the twist of a spring behind the gear and a torque computed from it, as of a series elastic actuator."""
    torques, twist = measured(columns, "torque"), _twist_of(columns)
    if twist is None or len(torques) != 1 or torques[0].channel.side == "input":
        return False
    return bool(_series_stiffness(twist.si, torques[0].si))


def _twist_of(columns: Sequence[Column]) -> Column | None:
    """Return the twist, or the difference of two angles; None if there is neither."""
    twists, angles = measured(columns, "twist"), measured(columns, "angle")
    if len(twists) == 1 or len(angles) != 2:
        return twists[0] if len(twists) == 1 else None
    first, second = angles
    name = f"{first.name} - {second.name}"
    return replace(first, label=Label(name, name, None), channel=Channel("twist"), si=first.si - second.si)


@np.errstate(all="ignore")
def _series_stiffness(twist: Array, torque: Array) -> float:
    """Return the stiffness of a spring that is softer than any gear, if a torque is a multiple of its twist; else zero."""
    rows = np.isfinite(twist) & np.isfinite(torque)
    if np.count_nonzero(rows) < MIN_LOOP_ROWS or not (np.ptp(twist[rows]) > 0.0 and np.ptp(torque[rows]) > 0.0):
        return 0.0
    covariance = np.cov(twist[rows], torque[rows])
    stiffness = float(covariance[0, 1] / covariance[0, 0])
    left = 1.0 - stiffness * covariance[0, 1] / covariance[1, 1]
    return stiffness if left < MAX_OFF_COMPUTED**2 and abs(stiffness) < MIN_STIFFNESS_AT_OUTPUT else 0.0


def _exceeds_twist(angle: Column, mapping: FileMapping) -> bool:
    """True for the angle of a joint that moves further than a gear twists."""
    return bool(np.ptp(angle.si) > MAX_TWIST and (angle.at_joint or mapping.side == "output"))


def in_steps(time: Array, angle: Array, torque: Array) -> bool:
    """True for a torque that alternates and follows the angle, in rows that are seconds apart."""
    is_slow = len(time) > 1 and float(np.median(np.diff(time))) >= MIN_INTERVAL_OF_STEPS
    return is_slow and float(np.ptp(angle)) <= MIN_TURNING and _is_spring(angle, torque)


@np.errstate(all="ignore")
def _is_spring(angle: Array, torque: Array) -> bool:
    """True if the torque alternates and follows the angle."""
    alternates = torque.min() < 0.0 < torque.max() and np.ptp(angle) > 0.0
    return bool(alternates and abs(np.corrcoef(angle, torque)[0, 1]) > MIN_CORRELATION_OF_SPRING)


def _why_output(angle: Column, torque: Column) -> str:
    """Return why a loop is one of the output, if its columns contain no side.

    Raises:
        QuestionError: it may be one of the input
    """
    stiffness = np.ptp(torque.si) / max(float(np.ptp(angle.si)), 1e-300)
    if stiffness > MIN_STIFFNESS_AT_OUTPUT:
        return f"its stiffness of {stiffness:.3g} N.m/rad is that of an output; at an input it is far smaller"
    ways = [
        Answer("the output was loaded with the input locked", {"side": "output"}),
        Answer("the motor was turned with the output locked", {"side": "input"}),
        Answer("the motor was moved to and fro at rest", {"kind": "presliding"}),
    ]
    raise QuestionError(f"{pair(angle, torque)} are a torsion loop or branch, but no side is stated", ways)


def _computed(twist: Column, torque: Column, stiffness: float) -> str:
    """Return in words that a torque which is a multiple of a twist checks nothing."""
    return (
        f"{torque.name} is {stiffness:.4g} N·m/rad times {twist.name}, as of a spring behind the gear whose torque is computed "
        f"from its twist: the record repeats the stiffness that was assumed, and checks neither it nor {torque.name}; a weight "
        "on a lever, a load cell, or the current of the motor in slow motion both ways does. The gear keeps its own spring, "
        "which is far stiffer: give a drive whose angles are those on both sides of the spring this stiffness instead"
    )


def _place(loop: TorsionLoop) -> str:
    return " at the output" if loop.input_ratio is None else ", referred to the output"


def _held_out(best: TorsionCandidate) -> HeldOut | None:
    rows = ~best.fit.training
    if not rows.any():
        return None
    error, varies = float(best.fit.rms(held_out=True)[0]), float(np.std(best.loop.torque[rows]))
    plain = plain_error(best.loop.twist, best.loop.torque, [rows])
    return HeldOut("blocks of the loop", "torque", "N.m", error, varies, plain, samples=int(rows.sum()))


def _remarks(
    recording: Recording, loop: TorsionLoop, best: TorsionCandidate, gear: Any, friction_measured: bool, start: GearSet
) -> Iterator[str]:
    yield f"valid up to {np.abs(loop.torque).max():.4g} N·m and {0.5 * np.ptp(loop.twist):.4g} rad either way at the output"
    yield from _of_friction(loop, best, gear, friction_measured)
    yield from thinned(loop.samples, len(loop.twist))
    yield from hint_of_ratio(best.fit, start.gear)
    used = ("input_angle", "input_torque") if at_input(recording) else ("twist", "torque")
    yield from unused(recording, (*used, "time", "temperature"))
    if isinstance(best.dissipation, Nothing):
        yield (
            "one branch only: it determines neither hysteresis nor zeros, so the hysteresis is kept, and the gear is taken to "
            "have been unloaded at the zeros of both axes"
        )
    yield from exceeded(start, Recording({"torque": loop.torque}, {"torque": "N.m"}))


def _of_richer_model(best: TorsionCandidate, others: Sequence[TorsionCandidate], left: Array) -> Iterator[str]:
    """Yield the richer model that predicts clearly better, if the simpler one that is taken leaves a significant shape."""
    repeats = shape(left, np.arange(float(len(left))), ordered=True)
    richer = min(
        (each for each in others if each.error < MAX_ERROR_OF_RICHER * best.error), key=lambda each: each.error, default=None
    )
    if repeats is None or repeats.chance > MAX_CHANCE_OF_SHAPE or richer is None:
        return
    yield (
        f"the residual has a shape along the loop, RMS {quantity(repeats.size, 'N.m')}: {richer.name} predicts better, with an "
        f"error on held-out data of {number(richer.error, 3)} N·m in place of {number(best.error, 3)} N·m. It is not taken, as "
        f"it gains less than {percent(MIN_ERROR_SHARE)} of the range of the torque. An element of the model that is taken may "
        "stand for several; --rank compares all models"
    )


def _of_friction(loop: TorsionLoop, best: TorsionCandidate, gear: Any, friction_measured: bool) -> Iterator[str]:
    """Yield what became of the friction inside a loop at the input."""
    if loop.input_ratio is None:
        return
    yield "measured at the input with the output locked: friction of the wave generator is inside the loop"
    held = 0.5 * float(np.ptp(loop.friction(gear)))
    together = "friction at the input was not measured: the loop determines the sum of friction and hysteresis only."
    if friction_measured:
        yield f"the friction measured at the input, ±{held:.3g} N·m at the output, is taken out of it"
    elif isinstance(best.dissipation, InputFriction):
        yield f"{together} Friction is fitted, and the hysteresis kept; give a friction table to separate them"
    elif held > 0.0:
        yield (
            f"{together} Friction is kept, ±{held:.3g} N·m at the output, and the rest is hysteresis; give a friction table to "
            "separate them"
        )
    else:
        yield "no friction at the input is known: all of it is fitted as hysteresis, of which a turning gear shows nothing"


def _gain_sigma(loop: TorsionLoop, gear: Gear) -> float:
    """Return the standard deviation of the gain of a loop at the input by the kinematic error over its travel [1].

    The output is locked, so the input sees the spring through 1 / i + slope of the error: both twist and torque, referred to
    the output, are off by that slope times i. Where the loop lies within the turn of the input is not known.
    """
    if loop.input_ratio is None:
        return 0.0
    travel = abs(loop.input_ratio) * float(np.ptp(loop.twist))
    begin = np.linspace(0.0, 2.0 * np.pi, GAIN_PLACES, endpoint=False)
    chords = (np.asarray(gear.kinematic_error.error(begin + travel)) - np.asarray(gear.kinematic_error.error(begin))) / travel
    return abs(loop.input_ratio) * float(np.sqrt(np.mean(chords**2)))


def _by_gain(estimate: Estimate, gain_sigma: float) -> float:
    """Return the standard deviation of an estimate by a gain that torque and twist share."""
    exponents = base_exponents(estimate.unit)[1]
    return abs(estimate.value * gain_sigma * (exponents.get("kg", 0) - exponents.get("rad", 0)))


def _of_error(gain_sigma: float, loop: TorsionLoop) -> Iterator[str]:
    if gain_sigma > 0.0 and loop.input_ratio is not None:
        yield (
            f"over {abs(loop.input_ratio) * np.ptp(loop.twist):.3g} rad of the input the kinematic error of the gear changes "
            f"the stiffness by {percent(2.0 * gain_sigma)}, which is part of ±; loops from other angles of the input average it"
        )


def _shared(best: TorsionCandidate, gear: Any, loop: TorsionLoop, friction_measured: bool) -> dict[str, str]:
    """Return the parameters that a loop determines only together with what was kept, by path, and how."""
    if loop.single_branch:
        why = "a single branch determines the torque of spring and hysteresis together, and the hysteresis was kept"
        return {f"gear.{estimate.path}": why for estimate in best.fit.estimates}
    if loop.input_ratio is None or friction_measured or not np.any(loop.friction(gear)):
        return {}
    ratio, breakaway = abs(loop.input_ratio), "friction_input.breakaway"
    held = 0.5 * float(np.ptp(loop.friction(gear)))  # at the output
    if isinstance(best.dissipation, InputFriction):
        elements = getattr(gear.hysteresis, "breakaway", ())
        kept = {f"hysteresis.breakaway[{place}]": (1.0 / ratio, f) for place, f in enumerate(elements)}
    else:
        kept = {breakaway: (ratio, held / ratio)}
    paths, factors = tuple(kept), tuple(factor for factor, _ in kept.values())
    rest = sum(factor * value for factor, value in kept.values())
    sums = (
        DeterminedSum((each.path, *paths), (1.0, *factors), each.value + rest, each.sigma, each.unit)
        for each in best.fit.estimates
        if each.path.startswith(("hysteresis.breakaway", breakaway))
    )
    return {f"gear.{each.paths[0]}": each.with_others for each in sums}
