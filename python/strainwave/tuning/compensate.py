"""Compensation designed from a model of a drive, and judged on gears that it may be."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from strainwave import Drive, arguments, loads, typeset
from strainwave.drawing import marks
from strainwave.drawing.style import LIGHT, RUNS
from strainwave.files.gear_set import GearSet, gear_set_of
from strainwave.messages import listed, shortened
from strainwave.parameters import Parameter, every
from strainwave.presentation import Pictured, Reported, Row
from strainwave.progress import Progress, in_turn
from strainwave.simulation.run import simulate
from strainwave.tuning import goals
from strainwave.tuning.candidates import GEAR_EFFECTS, USUAL_SPEED, baseline, candidates, has_effect, too_steep
from strainwave.tuning.cascade import Plant, Setting
from strainwave.tuning.drawn import drawn_gears, is_phase, scales
from strainwave.tuning.goals import Goal
from strainwave.tuning.judging import AT_LIMIT, ConditionResult, Judged, OverCompensation, conditions, judged, over_compensation
from strainwave.tuning.loops import MIN_MODULUS, LoopMargins, Loops, margins_of, sharpest

if TYPE_CHECKING:
    from matplotlib.figure import Figure

Array = NDArray[np.float64]

SHARPNESS_SHARES = (1.0, 0.5, 0.25)  # of the largest sharpness that the margins allow; the best one is taken
OBSERVER_SHARES = (0.5, 0.0)  # bandwidth of its observer over that of its speed loop, likewise; 0 for none
MIN_SAMPLES = 100  # periods of a motion
MIN_MEMBERS = 3
MAX_MEMBERS = 10_000  # whose runs take hours
MIN_GAIN = 0.05  # relative: what gains less is not worth another part
CREEP_SPEED_SHARE = 0.01  # of the usual speed, for the goal `smooth`
USUAL_TRAVEL = 0.2  # rad of the output, for the goal `position`
GOAL_OF_OPTION = {"travel": "position", "torque": "torque"}  # the only goal that uses an option
SPEED_GOAL_TURNS = 8.0  # of the input, over which the speed is judged
TORQUE_SHARE = 0.2  # of the largest torque of the motor, times the ratio, for the goal `torque`
TORQUE_FREQUENCY = 1.0  # Hz, at which the torque goes to and fro
STOP_STIFFNESS_RATIO = 1.0  # of the stop over the gear at the torque that is wanted
CREEP_DURATION = 4.0  # s
MIN_BANDWIDTH_RATIO = 5.0  # of the position loop over the pace of the motion
MEASUREMENT_OF_EFFECT = {
    "friction": "a friction table or a log of motion determines it",
    "torsion": "a torsion loop determines it",
    "kinematic error": "a record of both encoders over whole turns of the output determines it",
}  # by the effect


@dataclass(frozen=True)
class Compensated(Pictured, Reported):
    """Result of `compensate`: the drive with its controller, and the figures of every candidate.

    Attributes:
        gear_set: the drive
        goal: what was to be reached
        tried: the tuned cascade with feed-forward and disturbance observer, then all compensations, best first, on the gears by
            which one was chosen
        baseline: the cascade, on as many gears drawn anew
        chosen: the controller of the fewest parts that gains about as much as the best, likewise; the cascade if none gains
        members: number of gears of each draw
        margins: of the loops of the chosen controller, linearised, without what learns and observers of friction
        over_compensation: cascade and chosen controller where the drive has less of an effect than the model, for each effect
        conditions: both at other speeds, load inertias and temperatures, on the gears drawn anew
        remarks: what was assumed

    >>> import strainwave as sw
    >>> found = sw.compensate("robot-joint", members=3, travel=0.05)  # doctest: +SKIP
    >>> found.chosen.candidate.effects, round(found.gain, 2), round(found.margins.modulus, 2)  # doctest: +SKIP
    (('torsion',), 0.47, 0.59)
    """

    gear_set: GearSet
    goal: Goal
    tried: tuple[Judged, ...]
    baseline: Judged
    chosen: Judged
    members: int
    margins: LoopMargins
    over_compensation: tuple[OverCompensation, ...]
    conditions: tuple[ConditionResult, ...]
    remarks: tuple[str, ...]

    @property
    def drive(self) -> Drive:
        """The drive under the controller chosen."""
        return self.chosen.candidate.drive

    @property
    def saved(self) -> GearSet:
        """The set with the motor as the controller sees it, and the controller chosen."""
        source = f"compensate, goal {self.goal.name}: {self.chosen.candidate.name}"
        return self.gear_set.with_parts(motor=self.drive.motor, control=self.drive.control, source=source)

    @property
    def is_compensated(self) -> bool:
        """True if a compensation was chosen."""
        return self.chosen is not self.baseline

    @property
    def gain(self) -> float:
        """Return the relative reduction of the goal's median figure against the baseline [1]."""
        before, after = (each.median(self.goal.judged_by) for each in (self.baseline, self.chosen))
        return 1.0 - after / before

    def model_of(self, effects: tuple[str, ...], setting: Setting) -> Judged | None:
        """Return the controller with the model of these effects alone, in the cascade of a setting; None if none was tried."""
        alike = (each for each in self.tried if each.candidate.is_plain and each.candidate.setting == setting)
        return next((each for each in alike if each.candidate.effects == effects), None)

    @property
    def verdict(self) -> str:
        """Gain of the compensation over the baseline in words, with a warning if the output does not settle."""
        return f"{self._gain_in_words}{self._unsettled}"

    @property
    def _unsettled(self) -> str:
        """A sentence on a controller under which the output does not settle, and the best one that does; else empty."""
        if self.chosen.settles:
            return ""
        figure, unit = self.goal.judged_by, self.goal.units[self.goal.judged_by]
        settling = min(
            (each for each in self.tried if each.settles and each.candidate != self.chosen.candidate),
            key=lambda each: each.median(figure),
            default=None,
        )
        other = "under none that was tried it does"
        if settling is not None:
            least = typeset.quantity(settling.median(figure), unit)
            other = f"the best of those tried under which it does is the {settling.candidate.name}, {figure} {least}"
        return f" At rest the output does not settle within {goals.REST_AFTER_MOTION:g} s; {other}."

    @property
    def _gain_in_words(self) -> str:
        """Gain of the compensation over the baseline, in one sentence."""
        figure, unit = self.goal.judged_by, self.goal.units[self.goal.judged_by]
        before = typeset.quantity(self.baseline.median(figure), unit)
        after = typeset.quantity(self.chosen.median(figure), unit)
        if not self.is_compensated:
            cascade = f"the {self.baseline.candidate.name}, whose {figure} is {before}"
            return (
                f"{self.gear_set.name}: no compensation gains over {cascade} in the median of {self.members} gears drawn anew."
            )
        return (
            f"{self.gear_set.name}: {self.chosen.candidate.name} brings the {figure} from {before} to {after} "
            f"(−{100.0 * self.gain:.0f} %), in the median of {self.members} gears drawn anew."
        )

    def _headline(self) -> str:
        return self.verdict

    def _rows(self) -> Iterator[Row]:
        figure, unit = self.goal.judged_by, self.goal.units[self.goal.judged_by]
        yield Row(f"{figure} of the cascade", self.baseline.median(figure), unit, note="median of the gears drawn")
        yield Row(f"{figure} with the controller", self.chosen.median(figure), unit, note="median")
        yield Row("and in 95 % of the gears below", self.chosen.upper(figure), unit)
        yield Row("controller", self.chosen.candidate.name)
        yield from self.margins._rows()
        for tried in self.tried:
            yield Row(tried.candidate.name, tried.median(figure), unit, note="median, when it was chosen")

    def plot(self) -> Figure:
        """Return a figure of the error of the output over time: of the cascade, and of the controller chosen."""
        from strainwave.drawing import marks

        with marks.new_figure(3.2) as figure:
            draw_errors(figure, self)
        return figure


def compensate(
    drive: GearSet | Drive | str | Path,
    *,
    goal: str = "position",
    period: float = 1e-3,
    delay: float = 0.0,
    encoder: str = "input",
    travel: float | None = None,
    speed: float | None = None,
    torque: float | None = None,
    members: int = 40,
    seed: int = 0,
    progress: Progress = None,
) -> Compensated:
    """Return the compensation that gains most over a tuned cascade, judged on gears that a drive may have.

    Args:
        drive: with motor and load: a set, a drive, or the name or path of a file
        goal: "position" (tracking of a motion to and fro), "speed" (ripple at constant speed), "smooth" (creeping) or "torque"
            (to and fro against a stop as stiff as the gear, in place of the load)
        period, delay: of the controller [s]
        encoder: "output" if the controller sees the output angle, too
        travel: of the output for the goal of position [rad]; 0.2 rad if not given
        speed: of the output [rad/s]; if not given, that of 20 rad/s of the input, for "smooth" a hundredth of it, for "torque"
            that of one motion a second
        torque: of the output for the goal of torque, from end to end [N.m]; a fifth of the largest one if not given
        members: number of drawn gears
        seed: of the draw
        progress: as of `sw.simulate`

    Returns:
        The controller chosen, its gain over the cascade, and the figures of all candidates. If no compensation gains, the
        cascade is chosen.

    Raises:
        TypeError: `drive` is no drive
        ValueError: it has no motor or no load, its motor cannot be given a torque, a number is out of its range, or the goal
            does not use a number that is given

    >>> import strainwave as sw
    >>> found = compensate("robot-joint", members=3, travel=0.02)
    >>> found.chosen.candidate.effects, found.gain > 0.3
    (('torsion',), True)
    """
    gear_set = gear_set_of(drive)
    arguments.one_of("encoder", encoder, ("input", "output"))
    arguments.whole("members", members, MIN_MEMBERS, MAX_MEMBERS)
    arguments.one_of("goal", goal, ("position", "speed", "smooth", "torque"))
    for name, value in (("travel", travel), ("torque", torque)):
        if value is not None and goal != GOAL_OF_OPTION[name]:
            raise ValueError(
                f"{name} = {shortened(value)} is not used by the goal {goal}, only by {GOAL_OF_OPTION[name]}; leave it out"
            )
    plant = Plant.read(gear_set, period, delay)
    travel = USUAL_TRAVEL if travel is None else travel
    if goal == "torque":  # against a spring to the ground, with the inertia of the load
        largest = plant.limit / plant.actuation_per_torque * abs(plant.ratio)
        torque = TORQUE_SHARE * largest if torque is None else arguments.number("torque", torque, "N.m", "(]", 0.0, largest)
        twist = float(np.abs(plant.drive.gear.twist(np.array([0.0, torque])))[-1])
        stop = loads.TorsionSpring(inertia=gear_set.load.inertia, stiffness=STOP_STIFFNESS_RATIO * torque / twist)
        gear_set = gear_set.with_parts(load=stop, source="goal torque: a stop in place of the load")
        plant = replace(plant, drive=plant.drive.replace(load=gear_set.load))
        travel = torque / gear_set.load.stiffness

    def goal_at(pace: float) -> Goal:
        return goal_of(goal, plant, travel, speed, pace)

    wanted = goal_at(1.0)
    if wanted.command.duration < MIN_SAMPLES * plant.period:
        raise ValueError(
            f"the motion lasts {wanted.command.duration:.3g} s, and {MIN_SAMPLES} periods of the controller are the least; "
            "take a lower speed, a longer travel or a shorter period"
        )
    draws, anew = (_drawn(gear_set, plant, members, each, known_load=goal == "torque") for each in (seed, seed + 1))
    with in_turn(progress) as turn:
        cascades = _cascades(plant, wanted, draws, encoder, turn)
        best, others = cascades[0], list[Judged]()
        for candidate in candidates(plant, [cascade.candidate.setting for cascade in cascades], wanted, draws):
            turn(candidate.name)
            others.append(judged(candidate, wanted, draws, plant))
        others.sort(key=lambda result: result.median(wanted.judged_by))
        chosen = _chosen(best, others, wanted)
        before = after = judged(best.candidate, wanted, anew, plant)
        if chosen is not best:  # the cascade in place of a controller that gains nothing on other gears
            again = judged(chosen.candidate, wanted, anew, plant)
            gains = again.median(wanted.judged_by) < (1.0 - MIN_GAIN) * before.median(wanted.judged_by)
            after = again if gains else before
        remarks = list(_remarks(gear_set, plant, wanted, best))
        if chosen is not best and after is before:
            remarks.append(f"on gears drawn anew the {chosen.candidate.name} gained nothing, so the cascade is kept")
        turn("other conditions")
        return Compensated(
            gear_set,
            wanted,
            (best, *others),
            before,
            after,
            members,
            Loops.of(plant, after.candidate.drive.control).margins(),
            tuple(over_compensation((before, after), wanted, plant)),
            tuple(conditions((before, after), goal_at, anew, plant)),
            tuple(remarks),
        )


def _cascades(plant: Plant, goal: Goal, draws: Mapping[str, Array], encoder: str, turn: Callable[[str], None]) -> list[Judged]:
    """Return the best cascade of each encoder that the controller sees, the better one first."""
    encoders = ("input", "output") if encoder == "output" else ("input",)
    cascades = [best_cascade(plant, goal, draws, each, turn) for each in encoders]
    cascades.sort(key=lambda cascade: cascade.upper(goal.judged_by))
    best = cascades[0]
    if best.failures == len(best.figures[goal.judged_by]):
        advice = ""
        if best.reason == AT_LIMIT:
            lower = " or ".join(["speed", *(name for name, user in GOAL_OF_OPTION.items() if user == goal.name)])
            advice = f"; the motor takes at most {plant.limit:g} {plant.effort_unit}: take a lower {lower}"
        raise ValueError(f"no run of the {best.candidate.name} came to its end: {best.reason}{advice}")
    return cascades


def _drawn(gear_set: GearSet, plant: Plant, members: int, seed: int, known_load: bool) -> dict[str, Array]:
    """Return numbers of drives under an ideal current loop; those of a load that is known are not drawn."""
    ideal = gear_set.with_parts(motor=plant.drive.motor, control=plant.drive.control, source="current loop")
    draws = drawn_gears(ideal, members, seed)
    return {path: values for path, values in draws.items() if not (known_load and path.startswith("load."))}


def best_cascade(
    plant: Plant, goal: Goal, draws: Mapping[str, Array], encoder: str, turn: Callable[[str], None] = lambda name: None
) -> Judged:
    """Return the cascade of which 95 % of the drawn gears stay below the least, of all settings of an encoder."""
    tried = []
    for observer_share in OBSERVER_SHARES:
        largest = sharpest(plant, encoder, observer_share)
        for share in SHARPNESS_SHARES:
            setting = replace(largest, sharpness=share * largest.sharpness)
            turn(f"cascade, {encoder} encoder, sharpness {setting.sharpness:.2g}, observer {observer_share:g}")
            tried.append(judged(baseline(plant, setting), goal, draws, plant))
    return min(tried, key=lambda found: found.upper(goal.judged_by))


def _chosen(best: Judged, others: Sequence[Judged], goal: Goal) -> Judged:
    """Return the controller of the fewest parts of those that gain about as much as the best; the baseline if none gains.

    Of controllers that are as good as the best within the scatter over the drawn gears, one that settles is preferred.
    """
    figure = goal.judged_by
    limit = (1.0 - MIN_GAIN) * best.median(figure)
    better = [each for each in others if each.median(figure) < limit and each.upper(figure) <= best.upper(figure)]
    if not better:
        return best
    best_of_all = min(better, key=lambda each: each.median(figure))
    better = [each for each in better if each.settles and each.is_as_good_as(best_of_all, figure)] or better
    enough = (1.0 + MIN_GAIN) * min(each.median(figure) for each in better)
    return min(
        (each for each in better if each.median(figure) <= enough), key=lambda each: (each.candidate.parts, each.median(figure))
    )


def goal_of(name: str, plant: Plant, travel: float, speed: float | None, pace: float = 1.0) -> Goal:
    """Return a goal by its name, at `pace` times its speed."""
    travel = arguments.number("travel", travel, "rad", low=0.0)
    usual = USUAL_SPEED / abs(plant.ratio) * (CREEP_SPEED_SHARE if name == "smooth" else 1.0)
    usual = np.pi * TORQUE_FREQUENCY * travel if name == "torque" else usual
    commanded = pace * (usual if speed is None else arguments.number("speed", speed, "rad/s", low=0.0))
    unit = plant.effort_unit
    if name == "position":
        return goals.position(travel, commanded, unit, plant.period)
    if name == "torque":
        load: Any = plant.drive.load
        return goals.torque(load.stiffness * travel, load.stiffness, commanded, unit, plant.period)
    if name == "speed":
        return goals.speed(commanded, SPEED_GOAL_TURNS * 2.0 * np.pi / abs(plant.ratio) / commanded, unit)
    return goals.smooth(commanded, CREEP_DURATION, unit)


def _of_the_drive(gear_set: GearSet, plant: Plant, goal: Goal) -> Iterator[str]:
    if type(gear_set.motor) is not type(plant.drive.motor):
        yield f"the current loop of the motor, a {type(gear_set.motor).__name__}, is taken as ideal"
    if not plant.drive.motor.inertia:
        yield (
            "the inertia of the motor is 0, and that of the load may contain it: with the true one, that of a data sheet, a "
            "faster cascade is possible, and a compensation gains less"
        )
    if goal.name == "torque":
        load: Any = gear_set.load
        highest = load.stiffness * float(goal.command.value(goal.command.duration))
        yield f"the load is a stop of {load.stiffness:.3g} N·m/rad, against which the torque goes from 0 to {highest:.3g} N·m"
    if cogging := getattr(gear_set.motor, "cogging_torque", 0.0):
        yield f"its cogging of {cogging:g} N·m is left out: a controller that sees the output learns its orders"


def _remarks(gear_set: GearSet, plant: Plant, goal: Goal, best: Judged) -> Iterator[str]:
    """Yield what was assumed, and what cannot be gained."""
    yield from _of_the_drive(gear_set, plant, goal)
    for effect in GEAR_EFFECTS:
        if not has_effect(plant.drive.gear, effect):
            remedy = MEASUREMENT_OF_EFFECT[effect]
            yield f"the gear has no {effect}: if it has in truth, it cannot be compensated by a model; {remedy}"
        elif too_steep(plant, effect):
            yield f"the {effect} is too steep to be fed forward: its slope times the ratio reaches 1"
        elif names := assumed_numbers(gear_set, effect):
            numbers = _all_of(gear_set, effect)
            unknown = any(is_phase(each.path) and gear_set.sources[f"gear.{each.path}"].assumed for each in numbers)
            spread = f"{'any phase and ' if unknown else ''}more or less of it by a factor of up to 1.3"
            yield f"{effect} is assumed ({names}), so the drawn gears have {spread}; {MEASUREMENT_OF_EFFECT[effect]}"
    margins = margins_of(plant, best.candidate.setting)
    bandwidth, modulus = margins.position.crossover, margins.modulus
    if modulus and bandwidth < MIN_BANDWIDTH_RATIO * goal.pace:
        yield (
            f"the position loop reaches {bandwidth:.3g} rad/s with period {plant.period:g} s and delay {plant.delay:g} s, and "
            f"the motion has {goal.pace:.3g} rad/s: a shorter period or delay would gain, too"
        )
    if modulus < MIN_MODULUS:
        yield f"the modulus margin of the cascade is {modulus:.2g}, and {MIN_MODULUS:g} is wanted: the gear has little damping"
    if best.failures:
        yield f"{best.failures} of the drawn gears did not run to their end under the cascade"


def assumed_numbers(gear_set: GearSet, effect: str) -> str:
    """Return the names of those numbers of an effect that are assumed; none if all are measured or published."""
    assumed = [each.path for each in numbers_of(gear_set, effect) if gear_set.sources[f"gear.{each.path}"].assumed]
    return listed(sorted({path.split("[")[0] for path in assumed}))


def numbers_of(gear_set: GearSet, effect: str) -> list[Parameter]:
    """Return the numbers that an effect has more or less of, those that are zero left out."""
    return [each for each in _all_of(gear_set, effect) if each.value and scales(each.path, each.unit)]


def _all_of(gear_set: GearSet, effect: str) -> list[Parameter]:
    begins = tuple(f"{part}." for part in GEAR_EFFECTS[effect])
    return [each for path, each in every(gear_set.gear).items() if path.startswith(begins)]


def draw_errors(canvas: Figure, compensated: Compensated) -> None:
    """Draw the error of the output over time, of the gear as it is stated; as a torque if that is the goal."""
    axes = canvas.add_subplot()
    command = compensated.goal.command
    name, unit = ("error of the torque", "N.m") if compensated.goal.name == "torque" else ("error of the output", "rad")
    runs = {"cascade": compensated.baseline} | ({"compensated": compensated.chosen} if compensated.is_compensated else {})
    for (label, result), (colour, line, width) in zip(runs.items(), (RUNS[1], RUNS[0]), strict=False):
        control: Any = result.candidate.drive.control
        sample = control.period * max(round(command.duration / control.period / 2000.0), 1)  # set-points are exact there
        run = simulate(result.candidate.drive, command, sample=sample)
        error = compensated.goal.per_angle * np.asarray(command.value(run.time) - run["output_angle"])
        marks.curve(axes, run.time, error, color=LIGHT[colour], linestyle=line, linewidth=width, label=label)
    marks.label_axes(axes, name, unit, "time", "s")
    marks.legend(canvas, axes)
