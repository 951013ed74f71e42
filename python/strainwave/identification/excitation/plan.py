"""A plan of the next measurements: those that determine chosen parameters best within the limits of the gear."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, fields, replace
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from strainwave import Drive, Gear, arguments, typeset
from strainwave.files.gear_set import GearSet
from strainwave.identification.excitation import candidates as possible
from strainwave.identification.excitation.candidates import (
    CandidateMeasurement,
    Criterion,
    Limits,
    Noise,
    Resolution,
    best,
    covariance_of,
)
from strainwave.identification.fitting.fit import Fit
from strainwave.identification.results.file_result import is_uncertain
from strainwave.messages import listed, shortened
from strainwave.parameters import Parameter, every, parameters as chosen, unknown as unknown_path
from strainwave.presentation import Pictured, Presented, Row, counted
from strainwave.progress import Progress, in_turn
from strainwave.simulation.scenario import Scenario
from strainwave.simulation.signals import outputs
from strainwave.statistics.determined_sum import DeterminedSum, sum_by_information

if TYPE_CHECKING:
    from matplotlib.figure import Figure

Array = NDArray[np.float64]
EXPERIMENT_KINDS = ("friction", "torsion", "motion")
USUAL_DURATIONS = {"friction": 20.0, "torsion": 300.0}  # s: to settle and be averaged; of a slow loop (assumed)
PARTS_IN_A_LOOP = ("stiffness", "hysteresis", "friction_input")  # that a torsion loop may depend on
MAX_MEASUREMENTS = 5000  # of a plan: beyond, comparing them takes minutes
MAX_SPEED, MAX_TORQUE = 1e6, 1e9  # rad/s at the input and N.m at the output: no gear reaches them
MIN_SPEED_SHARE = 1e-3  # of the largest speed: the lowest that is held steady, if it is not given
SAMPLE_TIME = 2e-3  # s, of a run
MAX_RELATIVE_SIGMA = 0.1  # of a parameter; if it is known less well, the reason is given
MAX_CORRELATION = 0.9  # of estimates that are determined separately
MIN_GAIN = 0.1  # of the standard deviation of a wanted parameter; a plan that takes off less gains little
PARTS_OF_WORD = {"friction": ("friction_input",), "torsion": ("stiffness", "hysteresis")}  # by the experiment
LOOP_RATINGS = ("rated_torque",)  # to which a loop goes, unless a person gives another torque
TORQUE_RATINGS = ("peak_torque", "momentary_torque", "ratcheting_torque", "buckling_torque")  # that no loop may exceed

Known = GearSet | Fit | Mapping[str, float]


@dataclass(frozen=True)
class PlannedMeasurement(Presented):
    """One measurement of a plan.

    Attributes:
        kind: friction, torsion or motion
        words: the measurement in words
        settings: the same as numbers and words, with units in the names
        repeats: count of repeats
        duration: of all repeats [s]
        determines: parameters, and sums of those it does not separate, that these repeats determine by themselves
    """

    kind: str
    words: str
    settings: Mapping[str, float | str]
    repeats: int
    duration: float
    determines: tuple[DeterminedSum, ...] = ()


@dataclass(frozen=True)
class Expectation(Presented):
    """Uncertainty of a parameter before and after a plan.

    Attributes:
        path, unit, value: the parameter in the model; not a number if the measurements so far do not determine it
        before, after: standard deviation, in its unit; infinite where it is not known
        wanted: True if the plan was made for it
        why: the limit of its uncertainty, if that exceeds 10 %; else empty
    """

    path: str
    unit: str
    value: float
    before: float
    after: float
    wanted: bool
    why: str

    @property
    def gain(self) -> float:
        """Relative reduction of the standard deviation by the plan [1]; 1 if only the plan determines the parameter."""
        if not np.isfinite(self.after):
            return 0.0
        return 1.0 - self.after / self.before if np.isfinite(self.before) else 1.0


@dataclass(frozen=True)
class ExperimentPlan(Pictured):
    """Measurements to make, and the uncertainty of each parameter after them.

    Attributes:
        steps: the measurements
        expectations: of each parameter that is not known
        notes: assumptions of the numbers
        reason: why there are no measurements, if there are none

    >>> step = PlannedMeasurement("friction", "hold 10 rad/s at the input", {"input_speed_rad_s": 10.0}, 3, 60.0)
    >>> plan = ExperimentPlan((step,), (Expectation("gear.damping", "N.m.s/rad", 2.0, np.inf, 0.5, True, ""),), ())
    >>> plan.duration, plan["gear.damping"].after
    (60.0, 0.5)
    """

    _title: ClassVar[str] = "Plan"
    steps: tuple[PlannedMeasurement, ...]
    expectations: tuple[Expectation, ...]
    notes: tuple[str, ...]
    reason: str = "no measurement within the limits adds information"

    @property
    def duration(self) -> float:
        """Time of all measurements [s]."""
        return sum(step.duration for step in self.steps)

    def __getitem__(self, path: str) -> Expectation:
        """Return the expectation of a parameter by its path."""
        for each in self.expectations:
            if each.path == path:
                return each
        raise KeyError(f"{path} is none of {listed(each.path for each in self.expectations)}")

    def _headline(self) -> str:
        if not self.steps:
            return self.reason
        duration = f"{counted(len(self.steps), 'measurement')}, {self.duration / 60.0:.3g} min"
        wanted = [each for each in self.expectations if each.wanted]
        gains = not wanted or any(each.gain >= MIN_GAIN for each in wanted)
        return duration if gains else f"{duration}; gains less than {100.0 * MIN_GAIN:.0f} % for all that is wanted"

    def _rows(self) -> Iterator[Row]:
        for number, step in enumerate(self.steps, start=1):
            alone = f"; determines by itself {', '.join(map(str, step.determines))}" if step.determines else ""
            yield Row(f"measurement {number}", f"{step.repeats} x {step.words}{alone}")
        for each in self.expectations:
            before = "unknown" if np.isinf(each.before) else f"± {typeset.number(each.before, 3)}"
            if np.isinf(each.after):
                yield Row(each.path, each.value, each.unit, note="stays unknown")
            elif np.isnan(each.value):
                yield Row(each.path, f"± {typeset.number(each.after, 2)}", note=f"was {before}")
            else:
                yield Row(each.path, each.value, each.unit, each.after, f"was {before}")

    def _remarks(self) -> Iterator[str]:
        for each in self.expectations:
            if self.steps and each.wanted and np.isfinite(each.after) and each.gain < MIN_GAIN:
                known = f"known to ± {typeset.quantity(each.before, each.unit)} before"
                yield f"{each.path}: {known}; the plan reduces that by {100.0 * each.gain:.2g} % only"
        yield from (f"{each.path}: {each.why}" for each in self.expectations if each.why)
        yield from self.notes

    def plot(self) -> Figure:
        """Return a figure of the standard deviation of each parameter over its value, or of each share, before and after.

        Raises:
            ValueError: no parameter has a finite one after them
        """
        from strainwave.drawing.simple import bars_figure

        of_shares = all(each.unit == "1" for each in self.expectations)
        sizes = {each.path: 1.0 if of_shares else abs(each.value) for each in self.expectations}
        determined = [each for each in self.expectations if sizes[each.path] > 0.0 and np.isfinite(each.after)]
        if not determined:
            raise ValueError("the plan determines no parameter, so there is nothing to draw")
        before = [100.0 * each.before / sizes[each.path] if np.isfinite(each.before) else np.nan for each in determined]
        after = [100.0 * each.after / sizes[each.path] for each in determined]
        names = [each.path for each in determined]
        bars = ({"before": before} if np.isfinite(before).any() else {}) | {"after": after}
        return bars_figure(f"Standard deviation {'of each share' if of_shares else 'over the value'}", names, bars, "%")


def too_short(budget: float, cost: NDArray[np.float64]) -> dict[str, str]:
    """Return the reason of a plan without measurements if the time is enough for none, as an argument of `ExperimentPlan`."""
    if budget >= cost.min():
        return {}
    return {"reason": f"no measurement fits in {budget / 60.0:.3g} min; the shortest takes {cost.min() / 60.0:.3g} min"}


def plan_experiments(
    model: GearSet | Drive | Gear,
    wanted: Sequence[str],
    *,
    experiments: Sequence[str] = ("friction", "torsion"),
    time: float = 1800.0,
    criterion: Criterion = "A",
    unknown: Sequence[str] | None = None,
    known: Known | None = None,
    speed_limit: float | None = None,
    lowest_speed: float | None = None,
    torque_limit: float | None = None,
    noise: Noise | None = None,
    resolution: Mapping[str, float] | None = None,
    durations: Mapping[str, float] | None = None,
    commands: Mapping[str, Scenario] | None = None,
    sample: float = SAMPLE_TIME,
    progress: Progress = None,
) -> ExperimentPlan:
    """Return the measurements that determine chosen parameters best in a given time.

    Each possible measurement has a Fisher information: the derivatives of what the model predicts for it over its noise, less
    what the unknowns of the measurement take of it. Measurements are added by gain over duration, then exchanged one by one, as
    long as that makes the criterion smaller. The information is that at the numbers of the model: the better these are, the
    better the plan, so plan anew after each measurement. The noise is taken to be white, and the kind of model to be right.

    Args:
        model: a set, whose spreads, uncertainties and ratings count; a drive, for motion too; or a gear
        wanted: paths of the parameters to know, as "gear.friction_input.coulomb" of a set or a drive, "friction_input.coulomb"
            of a gear; or parts, by their path or name; "friction" is the one at the input, "torsion" spring and hysteresis
        experiments: what can be made: "friction" (steady speeds), "torsion" (loops at either side), "motion" (runs of the
            drive)
        time: what all measurements may take together [s]
        criterion: "A", the sum of the relative variances of the wanted parameters; "D", the determinant of their covariance
        unknown: paths of what else is not known; if not given, the other numbers of the parts of the wanted ones, and with
            torsion loops spring, hysteresis and friction at the input
        known: what is known before: a set, a fit, or standard deviations by path; of a set as model its own, if not given
        speed_limit: of the input [rad/s]; with ratings of a set the smaller counts
        lowest_speed: that can be held steady [rad/s]; a thousandth of the limit if not given
        torque_limit: at the output [N.m]; with the ratings of a set that no loop may exceed the smaller counts. Without it,
            the rated torque of a set
        noise: standard deviations: "friction" of the torque at one speed, at the input [N.m]; "torsion" and "input_torsion" of
            a sample of a loop at the output and at the input [N.m]; of a sample of each column of a log by its name, which
            also names the columns recorded, "input_angle" and "current" if none. If not given, 1 % of the largest value,
            and no less than the resolution
        resolution: smallest differences that the sensors resolve: "torque" [N.m] and "angle" [rad] at the output,
            "input_torque" [N.m] and "input_angle" [rad] at the input. Loops whose amplitude is less than 20 of them are not
            planned. If not given, 0.2 % of the torque limit, 1e-5 rad at the output and 1e-4 rad at the input (assumed)
        durations: of one "friction" speed one way and one "torsion" loop [s]; 20 s and 300 s if not given
        commands: for motion, by name: from rest, what the drive's control takes; shares of them are tried
        sample: distance of the samples of a run [s]
        progress: as of `sw.simulate`

    Returns:
        The measurements with their settings and durations [s], and the standard deviation of each parameter before and after
        them.

    Raises:
        TypeError: an argument is not of its kind
        ValueError: an unknown path or kind of experiment, no limit where one is needed, time for too many measurements,
            motion without drive or commands

    >>> import strainwave as sw
    >>> gear = sw.Gear(friction_input=sw.friction.Coulomb(coulomb=0.02, breakaway=0.02, viscous=3e-4))
    >>> plan = plan_experiments(gear, ["friction_input.viscous"], unknown=["friction_input.coulomb"], experiments=["friction"],
    ...     speed_limit=100.0, lowest_speed=1.0, noise={"friction": 1e-3}, time=80.0)
    >>> [round(step.settings["input_speed_rad_s"], 9) for step in plan.steps]
    [1.0, 100.0]
    >>> f"{plan['friction_input.viscous'].after:.3g}"  # 1e-3 N.m / 99 rad/s
    '1.01e-05'
    """
    kinds = [arguments.one_of("experiments", each, EXPERIMENT_KINDS) for each in arguments.names("experiments", experiments)]
    arguments.one_of("criterion", criterion, ("A", "D"))
    whole = _whole(model, "motion" in kinds)
    budget = arguments.seconds("time", time)
    unknowns = _unknowns(whole, wanted, unknown, kinds)
    scale = _scale(unknowns)
    limits = _limits(model, kinds, speed_limit, lowest_speed, torque_limit)
    noise = _noise(noise or {}, whole)
    sensors = _resolution(resolution or {}, whole, limits)
    paths = [each.path for each in unknowns]
    lasting = {
        kind: arguments.seconds(f"durations: {kind}", (durations or {}).get(kind, usual))
        for kind, usual in USUAL_DURATIONS.items()
    }
    gear, of_gear = (whole.gear, [path.removeprefix("gear.") for path in paths]) if isinstance(whole, Drive) else (whole, paths)
    measurements: list[CandidateMeasurement] = []
    with in_turn(progress, len(kinds)) as turn:
        if "friction" in kinds:
            turn("friction")
            measurements += possible.friction(gear, of_gear, limits, noise, sensors, lasting["friction"])
        if "torsion" in kinds:
            turn("torsion")
            measurements += possible.torsion(gear, of_gear, limits, noise, sensors, lasting["torsion"])
        if "motion" in kinds:
            turn("motion")
            if not isinstance(whole, Drive) or not commands:
                raise ValueError('motion needs a drive, and commands for it, as commands={"chirp": sw.scenario.chirp(…)}')
            measurements += possible.motion(whole, paths, limits, noise, commands, arguments.seconds("sample", sample))
    if not measurements and kinds == ["torsion"]:
        raise ValueError(
            f"no loop up to {limits.torque:g} N.m has {possible.MIN_STEPS:g} times the resolution of its sensors; give a finer "
            "resolution, or a higher torque_limit"
        )
    if not measurements:
        raise ValueError("none of the commands keeps the limits; give smaller ones, or other experiments")
    information = np.stack([each.information for each in measurements]) * np.outer(scale, scale)
    before = _information_before(model, known, unknowns, scale)
    asked = {each.path for each in _named("wanted", whole, wanted)}
    everything = before + information.sum(axis=0)
    reach = np.isfinite(np.diag(covariance_of(everything)))  # a parameter that nothing determines must not stop the rest
    places = [place for place, each in enumerate(unknowns) if each.path in asked and reach[place]]
    cost = np.array([each.duration for each in measurements])
    if budget > MAX_MEASUREMENTS * cost.min():
        raise ValueError(
            f"time = {budget:g} s is enough for more than {MAX_MEASUREMENTS} measurements of {cost.min():g} s; give less time, "
            "or longer durations"
        )
    chosen_places = best(information, cost, budget, before, places, criterion) if places else []
    after = before + information[chosen_places].sum(axis=0)
    expectations = _expectations(unknowns, scale, before, after, everything, asked, kinds)
    taken = [(measurements[place], often) for place, often in sorted(Counter(chosen_places).items())]
    steps = tuple(
        PlannedMeasurement(
            each.kind, each.words, each.settings, often, often * each.duration,
            tuple(_determined(often * each.information, unknowns)),
        )
        for each, often in taken
    )  # fmt: skip
    notes = _notes(kinds, limits, noise, sensors, resolution or {})
    return ExperimentPlan(steps, expectations, notes, **too_short(budget, cost))


def _whole(model: object, moves: bool) -> Any:
    """Return the drive of a set that has or needs one; else its gear in a drive, so that paths begin as in its sources."""
    if isinstance(model, GearSet):
        return model.drive if moves or (model.motor is not None and model.load is not None) else Drive(gear=model.gear)
    if isinstance(model, Drive | Gear):
        return model
    raise TypeError(f"model must be a GearSet, a Drive or a Gear, not {shortened(model)}")


def _unknowns(whole: Any, wanted: Sequence[str], unknown: Sequence[str] | None, kinds: Sequence[str]) -> list[Parameter]:
    named = _named("wanted", whole, wanted)
    if not named:
        raise ValueError("wanted must name at least one parameter")
    if unknown is None:
        gear = "gear." if isinstance(whole, Drive) else ""
        in_loop = [f"{gear}{part}." for part in PARTS_IN_A_LOOP] if "torsion" in kinds else []
        inside = {each.path.rpartition(".")[0] + "." for each in named if "." in each.path.removeprefix(gear)}
        others = {path for path in every(whole) if path.startswith((*inside, *in_loop))}
    else:
        others = {each.path for each in _named("unknown", whole, unknown)}
    paths = others | {each.path for each in named}
    return [each for path, each in every(whole).items() if path in paths]


def _named(name: str, whole: Any, paths: Sequence[str]) -> list[Parameter]:
    """Return the parameters that an argument names by themselves, by their sequence or by their part."""
    wanted: list[str] = []
    for path in arguments.names(name, paths):
        for place in _places(path, whole):
            wanted += [each for each in every(whole) if each.startswith(f"{place}.")] or [place]
    return chosen(name, whole, wanted)


def _places(path: str, whole: Any) -> list[str]:
    """Return the paths that a word names: itself, the parts of an experiment, or the one part of this name."""
    known = every(whole)
    parts = [each for each in dict.fromkeys(number.rpartition(".")[0] for number in known) if each]
    if path in (*known, *parts) or path in {number.split("[")[0] for number in known}:
        return [path]
    names = PARTS_OF_WORD.get(path, (path,))
    own = [part for part in parts if part.rpartition(".")[2] in names]
    if not own or (path not in PARTS_OF_WORD and len(own) > 1):
        raise ValueError(f"{unknown_path(path, known)}; its parts are {', '.join(parts)}")
    return own


def _noise(noise: Mapping[str, float], whole: Any) -> dict[str, float]:
    """Return the standard deviations that are given, by names that are known."""
    arguments.mapping("noise", noise, '{"friction": 1e-3}')
    names = ["friction", "torsion", "input_torsion", *(outputs(whole) if isinstance(whole, Drive) else ())]
    for name in noise:
        if name not in names:
            raise ValueError(f"noise: {name} is none of {listed(names)}")
    return {name: arguments.number(f"noise: {name}", sigma, low=0.0) for name, sigma in noise.items()}


def _resolution(given: Mapping[str, float], whole: Any, limits: Limits) -> Resolution:
    """Return the resolution of the sensors: that which is given, else that of usual ones."""
    arguments.mapping("resolution", given, '{"angle": 1e-5}')
    gear = whole.gear if isinstance(whole, Drive) else whole
    usual = Resolution.usual(limits.torque, float(gear.kinematics.ratio))
    for name in given:
        if name not in (names := [field.name for field in fields(usual)]):
            raise ValueError(f"resolution: {name} is none of {listed(names)}")
    return replace(usual, **{name: arguments.number(f"resolution: {name}", value, low=0.0) for name, value in given.items()})


def _limits(model: object, kinds: Sequence[str], speed: float | None, lowest: float | None, torque: float | None) -> Limits:
    """Return the limits that are given, or those of the ratings if they are smaller."""
    ratings = model.ratings if isinstance(model, GearSet) else {}
    speeds = [] if speed is None else [arguments.number("speed_limit", speed, "rad/s", "(]", 0.0, MAX_SPEED)]
    torques = [] if torque is None else [arguments.number("torque_limit", torque, "N.m", "(]", 0.0, MAX_TORQUE)]
    steady = ("maximum_input_speed", "average_input_speed")  # a table runs at each speed for long
    speeds += [ratings[name].to("rad/s").value for name in steady if name in ratings]
    allowed = TORQUE_RATINGS if torques else (*LOOP_RATINGS, *TORQUE_RATINGS)
    torques += [ratings[name].to("N.m").value for name in allowed if name in ratings]
    if "friction" in kinds and not speeds:
        raise ValueError("speed_limit is needed for friction: the model has no rating of the input speed")
    if "torsion" in kinds and not torques:
        raise ValueError("torque_limit is needed for torsion: the model has no rating of the torque")
    highest = min(speeds, default=np.inf)
    if lowest is not None:
        lowest = arguments.number("lowest_speed", lowest, "rad/s", low=0.0, high=highest)
    return Limits(highest, min(torques, default=np.inf), MIN_SPEED_SHARE * highest if lowest is None else lowest)


def _information_before(model: object, known: Known | None, unknowns: Sequence[Parameter], scale: Array) -> Array:
    """Return the information before the plan, in relative units, shape (p, p)."""
    source = model if known is None and isinstance(model, GearSet) else known
    before = np.zeros((len(unknowns), len(unknowns)))
    if isinstance(source, Fit):
        return _of_fit(source, unknowns, scale)
    if source is not None and not isinstance(source, GearSet):
        paths = [each.path for each in unknowns]
        for path in source:
            if path not in paths:
                raise ValueError(f"known: {path} is none of the unknown parameters, {listed(paths)}")
    for place, each in enumerate(unknowns):
        if isinstance(source, GearSet):
            entry = source.sources.get(_in_gear(each.path))
            sigma = None if entry is None else entry.sigma(each.value)
        else:
            sigma = (source or {}).get(each.path)
        if sigma is not None and sigma != 0.0:
            before[place, place] = (scale[place] / arguments.number(f"known: {each.path}", sigma, low=0.0)) ** 2
    return before


def _in_gear(path: str) -> str:
    """Return the path of a number in a set: that of a gear alone begins inside the gear."""
    return path if path.split(".")[0] in ("gear", "motor", "load", "control", "sensors", "thermal", "meter") else f"gear.{path}"


def _of_fit(fit: Fit, unknowns: Sequence[Parameter], scale: Array) -> Array:
    """Return the information of a fit, with its correlations; what it did not determine is not known."""
    before = np.zeros((len(unknowns), len(unknowns)))
    rows = {_in_gear(each.path): row for row, each in enumerate(fit.estimates) if np.isfinite(each.sigma) and each.sigma > 0.0}
    pairs = [(place, rows[_in_gear(each.path)]) for place, each in enumerate(unknowns) if _in_gear(each.path) in rows]
    if pairs:
        here, there = (np.array(side) for side in zip(*pairs, strict=True))
        covariance = fit.covariance[np.ix_(there, there)] / np.outer(scale[here], scale[here])
        before[np.ix_(here, here)] = np.linalg.inv(covariance)
    return before


def _determined(information: Array, unknowns: Sequence[Parameter]) -> Iterator[DeterminedSum]:
    """Yield what data of an information determine to half its value: parameters, then sums of those not separated."""
    sums = {each.paths: each for place in range(len(unknowns)) if (each := _sum(information, place, unknowns)) is not None}
    determined: set[str] = set()
    for paths, each in sorted(sums.items(), key=lambda item: len(item[0])):
        if determined.isdisjoint(paths) and not is_uncertain(each.value, each.sigma):
            determined.update(paths)
            yield each


def _sum(information: Array, place: int, unknowns: Sequence[Parameter]) -> DeterminedSum | None:
    values, paths = np.array([each.value for each in unknowns]), [each.path for each in unknowns]
    return sum_by_information(information, place, values, paths, unknowns[place].unit)


def _scale(unknowns: Sequence[Parameter]) -> Array:
    """Return the size of each parameter, shape (p,); 1 if it is 0."""
    return np.array([abs(each.value) or 1.0 for each in unknowns])


def _expectations(
    unknowns: Sequence[Parameter],
    scale: Array,
    before: Array,
    after: Array,
    everything: Array,
    wanted: set[str],
    kinds: Sequence[str],
) -> tuple[Expectation, ...]:
    covariance = covariance_of(after)
    sigma_before, sigma_after = (np.sqrt(np.diag(each)) for each in (covariance_of(before), covariance))
    reasons = _reasons(unknowns, covariance, everything / np.outer(scale, scale), kinds)
    return tuple(
        Expectation(
            each.path,
            each.unit,
            each.value,
            float(sigma_before[place] * scale[place]),
            float(sigma_after[place] * scale[place]),
            each.path in wanted,
            reasons[place] if sigma_after[place] > MAX_RELATIVE_SIGMA else "",
        )
        for place, each in enumerate(unknowns)
    )


def _reasons(unknowns: Sequence[Parameter], covariance: Array, everything: Array, kinds: Sequence[str]) -> list[str]:
    """Return what limits the uncertainty of each parameter.

    Args:
        unknowns: the parameters
        covariance: of them after the plan, in relative units
        everything: information of all measurements that could be made
        kinds: of these measurements
    """
    scale, paths = _scale(unknowns), [each.path for each in unknowns]
    reach = np.diag(covariance_of(everything * np.outer(scale, scale)))
    sigma = np.sqrt(np.diag(covariance))
    with np.errstate(invalid="ignore"):
        related = np.abs(covariance) / np.outer(sigma, sigma)
    reasons = []
    for place in range(len(paths)):
        if everything[place, place] == 0.0:
            reasons.append(f"nothing that {listed(kinds)} measures depends on it; it needs another kind of experiment")
        elif np.isinf(reach[place]):
            both = _sum(everything, place, unknowns)
            joint = "" if both is None or len(both.paths) == 1 else both.with_others
            reasons.append(joint or f"{listed(kinds)} hardly depend on it")
        elif np.isinf(sigma[place]):
            reasons.append(
                "the plan has no measurement that determines it: it does not matter for what is wanted, or time is short"
            )
        elif correlated := [
            path for other, path in enumerate(paths) if other != place and related[place, other] > MAX_CORRELATION
        ]:
            reasons.append(f"correlated with {listed(correlated)}; more time, or knowledge of these, reduces its uncertainty")
        else:
            reasons.append("limited by the noise; more time reduces its uncertainty")
    return reasons


def _notes(
    kinds: Sequence[str], limits: Limits, noise: Noise, resolution: Resolution, given: Mapping[str, float]
) -> tuple[str, ...]:
    notes = []
    if "friction" in kinds:
        notes.append(f"input speed from {limits.lowest_speed:.4g} to {limits.speed:.4g} rad/s")
    if "torsion" in kinds:
        notes.append(f"output torque to {limits.torque:.4g} N.m")
    if "torsion" in kinds and not given:
        notes.append(
            f"resolution assumed: {resolution.torque:.3g} N.m and {resolution.angle:.3g} rad at the output, "
            f"{resolution.input_torque:.3g} N.m and {resolution.input_angle:.3g} rad at the input; loops of less than "
            f"{possible.MIN_STEPS:g} times as much are left out; give resolution of your sensors"
        )
    if not noise:
        notes.append("noise assumed: 1 % of the largest value of each channel; give noise for standard deviations that count")
    return tuple(notes)
