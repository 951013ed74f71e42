"""A model of a joint along its motion, the parts of friction that may be added to it, and its waves over the angle.

Waves are a detent, the same in both directions, and dry friction that varies over the turn. Both are linear in the sine and
cosine of their orders: least squares chooses them among other terms in the full band. They are numbers of the gear, as
`friction.Cyclic` around its friction at the input. A fit in the pass band has the estimates by the full band as priors:
of many waves the pass band contains little.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from strainwave import Drive, _core, friction
from strainwave.equality import ComparedByFields
from strainwave.identification.candidates.steady_shapes import QUADRANTS
from strainwave.identification.experiments.motion_log import MotionLog, late, per_torque, turnover_speed
from strainwave.identification.fitting.fit import problem_of
from strainwave.identification.fitting.unknowns import plan
from strainwave.statistics.linear_fit import linear_fit, solved
from strainwave.statistics.residuals import autoregression, chance_of_gain, correlation_length, whitened

LOSSES = tuple(f"gear.friction_mesh.{name}" for name in QUADRANTS)
INPUT = "gear.friction_input."
WITHIN_CYCLIC = f"{INPUT}law."  # where friction stands that varies over the angle
SLOPE_STEP = 0.05  # relative change of a speed, by which a law of friction is differentiated
TRIED_BENDS = np.geomspace(3e-3, 3.0, 16)  # rad of the input, in which bristles bend
NEAR_THE_BEST_BEND = (TRIED_BENDS[1] / TRIED_BENDS[0]) ** np.array([-1 / 3, 0.0, 1 / 3])  # times the best of them
BREAKAWAY_FOLLOWS = {f"{INPUT}breakaway": f"{INPUT}coulomb"}
Array = NDArray[np.float64]
Rows = NDArray[np.bool_]

INPUT_ORDERS = (1.0, 2.0, 3.0, 4.0)  # of the input's turn
OUTPUT_ORDERS = (1.0, 2.0)  # of the output's turn
MIN_INPUT_TURNS = 2.0  # of a record that separates a wave over the input's turn from what varies over the output's
MIN_OUTPUT_TURNS = 3.0  # the same over the output's turn
MIN_OWN_SHARE = 0.5  # of a wave, that no other term of the model makes up [1]
MIN_SIZE = 0.05  # of the largest wave: turning over at a reversal makes smaller ones of it
BIAS_IN_FULL_BAND = 0.05  # of a wave: what numbers by the pass band and a smoothed angle make of it (assumed)
MAX_CHANCE_OF_WAVE = 1e-3  # probability with which noise alone makes as large a wave at any of the orders
NUMBERS_OF_WAVE = {  # of `friction.Cyclic`
    "friction": ("order", "amplitude", "phase"),
    "detent": ("detent_order", "detent_torque", "detent_phase"),
}


@dataclass(frozen=True, eq=False)
class MotionModel(ComparedByFields):
    """A model of a joint to be fitted to a log.

    Attributes:
        name: of its friction, with what was added
        log: as it is compared
        drive: from which a fit starts
        free: paths of the numbers that are fitted
        ties: numbers that follow others, by path
        one_speed: size of the speed at which alone friction was measured [rad/s]; 0 if the record has several. Only the sum of
            Coulomb and viscous friction is determined then
        of_full_band: paths of free numbers that the pass band of the log does not contain
    """

    name: str
    log: MotionLog
    drive: Drive
    free: tuple[str, ...]
    ties: Mapping[str, str]
    one_speed: float = 0.0
    of_full_band: tuple[str, ...] = ()

    @property
    def law(self) -> Any:
        """The friction at the input as it slides, without what varies it over the angle."""
        return sliding(self.drive)

    @property
    def paths(self) -> list[str]:
        """Paths of all numbers of the drive."""
        return [path for path, *_ in _core.parameters(self.drive)]

    def path_of(self, name: str) -> str:
        """Return the path of a number of the friction at the input as it slides."""
        return f"{WITHIN_CYCLIC if isinstance(self.drive.gear.friction_input, friction.Cyclic) else INPUT}{name}"

    def having(self, what: str, law: Any, *names: str) -> MotionModel:
        """Return the same with another law of friction at the input as it slides, and further numbers of it free."""
        drive, free = with_sliding(self.drive, law), map(self.path_of, names)
        return replace(self, name=f"{self.name}, {what}", drive=drive, free=(*self.free, *free))

    def varying_over_the_angle(self) -> MotionModel:
        """Return the same with friction at the input whose dry part may vary over the angle."""
        law: Any = self.drive.gear.friction_input
        if isinstance(law, friction.Cyclic):
            return self
        drive = self.drive.replace(gear=self.drive.gear.replace(friction_input=friction.Cyclic(law=law, viscous_share=0.0)))
        ties = {_within(path): _within(other) for path, other in self.ties.items()}
        return replace(self, drive=drive, free=tuple(map(_within, self.free)), ties=ties)


def sliding(drive: Drive) -> Any:
    """Return the friction at the input of a drive, without what varies it over the angle."""
    law: Any = drive.gear.friction_input
    return law.law if isinstance(law, friction.Cyclic) else law


def with_sliding(drive: Drive, law: Any) -> Drive:
    """Return the drive with another law of friction at the input as it slides, within what varies it over the angle."""
    outer: Any = drive.gear.friction_input
    whole = outer.replace(law=law) if isinstance(outer, friction.Cyclic) else law
    return drive.replace(gear=drive.gear.replace(friction_input=whole))


def slope_of(law: Any, speed: float) -> float:
    """Return the change of a law's friction with the speed [N.m.s/rad], at a speed [rad/s]."""
    return float(law.steady((1.0 + SLOPE_STEP) * speed) - law.steady((1.0 - SLOPE_STEP) * speed)) / (2.0 * SLOPE_STEP * speed)


def _within(path: str) -> str:
    """Return the path of a number of the friction at the input that now stands inside another law."""
    return path.replace(INPUT, WITHIN_CYCLIC) if path.startswith(INPUT) else path


def without(free: Sequence[str], name: str) -> tuple[str, ...]:
    """Return the paths but those of numbers whose names begin so."""
    return tuple(path for path in free if not path.rpartition(".")[2].startswith(name))


def with_delay(model: MotionModel, start: float = 0.0) -> MotionModel | None:
    """Return the model with a delay of the effort behind the motion, from the initial value of a fit [s]."""
    if model.log.delayed:
        return None
    log = model.log.with_delay()
    before = {each.name: each.start for each in model.log.nuisances} | {"delay": start}
    return replace(
        model, name=f"{model.name}, a delay", log=log.starting([before.get(each.name, 0.0) for each in log.nuisances])
    )


def with_curved_viscous_part(model: MotionModel) -> MotionModel | None:
    """Return the model with a viscous torque that is not linear in the speed."""
    law = model.law
    if not isinstance(law, friction.Coulomb) or model.one_speed:
        return None
    fastest = float(np.abs(model.log.motion.speed).max())
    curved = friction.CurvedViscous(
        coulomb=law.coulomb, breakaway=law.coulomb, viscous_torque=max(law.viscous * fastest, 1e-3 * law.coulomb, 1e-12),
        exponent=0.9, reference_speed=fastest,
    )  # fmt: skip
    return replace(model, free=without(model.free, "viscous")).having(
        "a curved viscous part", curved, "viscous_torque", "exponent"
    )


def with_friction_at_low_speed(model: MotionModel, share: float) -> MotionModel | None:
    """Return the model with a Stribeck torque that starts with a share of Coulomb's torque at rest [1]; a fit may turn it."""
    law = model.law
    if not isinstance(law, friction.Coulomb) or model.one_speed:
        return None
    falling = friction.Stribeck(coulomb=law.coulomb, breakaway=share * law.coulomb, stribeck_speed=3.0, viscous=law.viscous)
    ties = {path: other for path, other in model.ties.items() if path != model.path_of("breakaway")}
    return replace(model, ties=ties).having("another friction at low speed", falling, "breakaway", "stribeck_speed")


def with_loss_under_load(model: MotionModel) -> MotionModel | None:
    """Return the model with a loss under load, equal in all quadrants: four are not separable from inertia and gravity."""
    if LOSSES[0] in model.free:
        return None
    lossy = friction.LoadDependent(**dict.fromkeys(QUADRANTS, 0.02))
    return replace(
        model,
        name=f"{model.name}, a loss under load",
        drive=model.drive.replace(gear=model.drive.gear.replace(friction_mesh=lossy)),
        free=(*model.free, LOSSES[0]),
        ties={**model.ties, **dict.fromkeys(LOSSES[1:], LOSSES[0])},
    )


def bristled(drive: Drive, bend: float) -> Drive:
    """Return the drive with bristles that bend at reversals, where its friction at the input has a law with bristles.

    Args:
        drive: with friction that slides, of Coulomb or Stribeck
        bend: angle of the input in which they bend [rad]
    """
    law = sliding(drive)
    if not isinstance(law, friction.Coulomb | friction.Stribeck) or min(law.coulomb, law.breakaway) <= 0.0:
        return drive
    speed = law.stribeck_speed if isinstance(law, friction.Stribeck) else 1.0
    bristle = friction.LuGre(
        coulomb=law.coulomb, breakaway=law.breakaway, stribeck_speed=speed,
        bristle_stiffness=law.coulomb / bend, bristle_damping=0.0, viscous=max(law.viscous, 0.0),
    )  # fmt: skip
    return with_sliding(drive, bristle)


def best_bend(log: MotionLog, drive: Drive, nuisances: Array, rows: Rows) -> float | None:
    """Return the bend of bristles that explains most of some samples [rad]; None if the law of friction has no bristles."""
    if bristled(drive, TRIED_BENDS[0]) is drive:
        return None

    def error(bend: float) -> float:
        return float(np.mean(log.residual(bristled(drive, bend), nuisances)[rows] ** 2))

    coarse = min(TRIED_BENDS.tolist(), key=error)
    return float(min((coarse * NEAR_THE_BEST_BEND).tolist(), key=error))


# ---- Waves over the angle --------------------------------------------------------------------------------------------


@dataclass(frozen=True, order=True)
class Wave:
    """A torque over the angle of the input.

    Attributes:
        kind: "detent", the same in both directions of motion, or "friction", against the motion
        order: periods per turn of the input
    """

    kind: Literal["detent", "friction"]
    order: float

    def columns(self, angle: Array, sense: Array) -> Array:
        """Return its sine and cosine over the angle, of a sense of motion from -1 to 1 [1], shape (2, m)."""
        phase, factor = self.order * angle, sense if self.kind == "friction" else 1.0
        return np.stack([factor * np.sin(phase), factor * np.cos(phase)])


def with_ripple(model: MotionModel) -> MotionModel | None:
    """Return the model with the waves over the angle that its residual contains beyond chance; None if there are no more.

    Waves are added one by one, each time the one that explains most of the rest. A wave that other terms make up is not
    separable and takes no part.
    """
    whole = replace(model, log=model.log.sliding_in_full_band())
    _, base, left = _linear(whole)
    waves = _beyond_chance(base, left, _efforts(whole))
    largest = max(map(abs, (*waves.values(), *sizes_of_waves(model).values())), default=0.0)
    waves = {wave: waves[wave] for wave in sorted(waves) if abs(waves[wave]) > MIN_SIZE * largest}
    return _in_gear(model, waves) if waves else None


def by_full_band(model: MotionModel, trainings: Sequence[Rows]) -> list[dict[str, tuple[float, float]]]:
    """Return value and standard deviation of the numbers that the full band alone determines, by path, for each training.

    They follow by one step of Gauss and Newton from the numbers of the model.

    Args:
        model: with its waves in the gear
        trainings: samples of the grid that take part, shape (m,) each
    """
    if not model.of_full_band:
        return [{} for _ in trainings]
    whole = replace(model, log=model.log.sliding_in_full_band())
    paths, slopes, left = _linear(whole)
    white = _whitened(slopes, left)
    numbers = {path: value for path, value, *_ in _core.parameters(model.drive)}
    determined = []
    for rows in (training[whole.log.motion.rows] for training in trainings):
        step = linear_fit(white[rows, :-1], white[rows, -1])
        determined.append({
            path: (
                numbers[path] + change,
                float(np.hypot(sigma, BIAS_IN_FULL_BAND * (1.0 if "phase" in path else numbers[path]))),
            )
            for path, change, sigma in zip(paths, step.values.tolist(), step.sigma.tolist(), strict=False)
            if path in model.of_full_band and np.isfinite(sigma)
        })  # fmt: skip
    return determined


def is_one_wave(log: MotionLog) -> bool:
    """True if a log moves so little in one of both directions that a detent makes up friction over the angle of its order."""
    return bool(2.0 * np.sqrt(log.share_of_rarer_way * (1.0 - log.share_of_rarer_way)) < MIN_OWN_SHARE)


def sizes_of_waves(model: MotionModel) -> dict[Wave, float]:
    """Return the amplitude of each wave in the gear of a model [N.m]."""
    law: Any = model.drive.gear.friction_input
    if not isinstance(law, friction.Cyclic):
        return {}
    detents = {Wave("detent", order): size for order, size in zip(law.detent_order, law.detent_torque, strict=True)}
    level = model.law.coulomb
    return detents | {Wave("friction", order): level * size for order, size in zip(law.order, law.amplitude, strict=True)}


def _efforts(model: MotionModel) -> dict[Wave, Array]:
    """Return the effort of sine and cosine of further waves of 1 N.m at the samples compared, shape (n, 2) each.

    The record contains their turn often enough. Of a detent over the output's turn, gravity is the first.
    """
    log, ratio, known = model.log, abs(model.drive.gear.kinematics.ratio), sizes_of_waves(model)
    motion, delay, scale = log.motion, log.delay, per_torque(model.drive, log.effort)
    sense = np.tanh(motion.speed / turnover_speed(motion.speed))
    moved = np.ptp(motion.angle[motion.rows]) / (2.0 * np.pi)
    orders = [order for order in INPUT_ORDERS if moved >= MIN_INPUT_TURNS]
    orders += [order / ratio for order in OUTPUT_ORDERS if moved >= MIN_OUTPUT_TURNS * ratio]
    varies = not is_one_wave(log) and model.law.coulomb > 0.0
    efforts = {}
    for wave in (Wave(kind, order) for order in orders for kind in (("detent", "friction") if varies else ("detent",))):
        if wave not in known:
            series = scale * wave.columns(motion.angle, sense)
            series = late(series, delay, motion.step)[0] if log.delayed else series
            efforts[wave] = series[:, motion.rows].T
    return efforts


def _linear(model: MotionModel) -> tuple[list[str], Array, Array]:
    """Return the derivatives of the effort by the free numbers and nuisances, shape (n, unknowns), and its residual, (n,).

    The paths of the free numbers are the first, in the order of the derivatives.
    """
    problem = problem_of(plan(model.drive, [""], model.free, ties=model.ties), model.drive, [model.log], [None])
    ((predicted, slopes),) = problem.predict(problem.start())
    return [each.path for each in problem.plan.unknowns], slopes[:, 0].T, (model.log.measured - predicted)[0]


def _whitened(columns: Array, left: Array) -> Array:
    """Return columns and a residual, made white by the autoregression of what no column explains, shape (n, columns + 1).

    Slow errors of a model then hide no fast wave.
    """
    noise = autoregression(left - columns @ solved(columns, left))
    return whitened(np.column_stack([columns, left]), noise)


def _beyond_chance(base: Array, left: Array, pairs: Mapping[Wave, Array]) -> dict[Wave, complex]:
    """Return the waves beside the columns of a model that a residual contains beyond chance, with their sine and cosine.

    The one that explains most is the first.
    """
    if not pairs:
        return {}
    series = _whitened(np.column_stack([base, *pairs.values()]), left)
    columns, between, target = np.split(series, [base.shape[1], -1], axis=1)
    white = dict(zip(pairs, np.split(between, len(pairs), axis=1), strict=True))
    rest, chosen = (target - columns @ solved(columns, target))[:, 0], list[Wave]()
    while True:
        left_by = dict[Wave, Array]()
        for wave in (each for each in pairs if each not in chosen):
            own, size = white[wave] - columns @ solved(columns, white[wave]), np.linalg.norm(white[wave], axis=0)
            directions, shares, _ = np.linalg.svd(own / np.maximum(size, 1e-300), full_matrices=False)
            if shares[-1] > MIN_OWN_SHARE:
                left_by[wave] = rest - directions @ (directions.T @ rest)
        best = min(left_by, key=lambda wave: float(left_by[wave] @ left_by[wave]), default=None)
        if best is None:
            break
        freedom = (len(rest) - columns.shape[1] - 2) / correlation_length(left_by[best])
        gain = chance_of_gain(float(rest @ rest), float(left_by[best] @ left_by[best]), 2, freedom)
        if len(pairs) * gain > MAX_CHANCE_OF_WAVE:
            break
        chosen.append(best)
        columns, rest = np.column_stack([columns, white[best]]), left_by[best]
    sizes = solved(columns, target[:, 0])[base.shape[1] :].reshape(-1, 2)
    return {wave: complex(*size) for wave, size in zip(chosen, sizes.tolist(), strict=True)}


def _in_gear(model: MotionModel, sizes: Mapping[Wave, complex]) -> MotionModel:
    """Return the model with further waves in its gear, whose numbers are free.

    Args:
        model: before
        sizes: of sine and, imaginary, of cosine [N.m]
    """
    model = model.varying_over_the_angle()
    law: Any = model.drive.gear.friction_input
    free, of_full_band = list(model.free), list(model.of_full_band)
    for wave, size in sizes.items():
        order, amplitude, phase = NUMBERS_OF_WAVE[wave.kind]
        unit = model.law.coulomb if wave.kind == "friction" else 1.0
        more = {order: wave.order, amplitude: abs(size) / unit, phase: float(np.angle(size))}
        paths = [f"{INPUT}{name}[{len(getattr(law, name))}]" for name in (amplitude, phase)]
        law = law.replace(**{name: [*getattr(law, name), value] for name, value in more.items()})
        free += paths
        of_full_band += paths
    names = {"detent": "a detent", "friction": "friction over the angle"}
    added = " and ".join(names[kind] for kind in names if any(wave.kind == kind for wave in sizes))
    drive = model.drive.replace(gear=model.drive.gear.replace(friction_input=law))
    return replace(model, name=f"{model.name}, {added}", drive=drive, free=tuple(free), of_full_band=tuple(of_full_band))
