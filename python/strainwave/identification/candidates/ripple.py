"""Torque over the angle of a log: a detent, the same in both directions, and dry friction that varies over the turn.

Both are linear in the sine and cosine of their orders: least squares chooses them among other terms in the full band. They are
numbers of the gear, as `friction.Cyclic` around its friction at the input. A fit in the pass band of a log has the estimates by
the full band as priors: of many waves the pass band contains little.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from strainwave import _core, friction
from strainwave.identification.candidates.motion_model import INPUT, MotionModel
from strainwave.identification.experiments.motion_log import MotionLog, per_torque, turnover_speed
from strainwave.identification.fitting.fit import problem_of
from strainwave.identification.fitting.unknowns import plan
from strainwave.statistics.linear_fit import linear_fit, solved
from strainwave.statistics.residuals import autoregression, chance_of_gain, correlation_length, whitened

Array = NDArray[np.float64]
Rows = NDArray[np.bool_]

INPUT_ORDERS = (1.0, 2.0, 3.0, 4.0)  # of the input's turn
OUTPUT_ORDERS = (1.0, 2.0)  # of the output's turn
MIN_INPUT_TURNS = 2.0  # of a record that separates a wave over the input's turn from what varies over the output's
MIN_OUTPUT_TURNS = 3.0  # the same over the output's turn
MIN_OWN_SHARE = 0.5  # of a wave, that no other term of the model makes up [1]
MIN_SIZE = 0.05  # of the largest wave: turning over at a reversal makes smaller ones of it
BIAS_IN_FULL_BAND = 0.05  # of a wave: what numbers by the pass band and a smoothed angle make of it (assumed)
MAX_CHANCE = 1e-3  # probability with which noise alone makes as large a wave at any of the orders
NUMBERS = {  # of `friction.Cyclic`
    "friction": ("order", "amplitude", "phase"),
    "detent": ("detent_order", "detent_torque", "detent_phase"),
}


@dataclass(frozen=True, order=True)
class Wave:
    """A torque over the angle of the input.

    Attributes:
        kind: "detent", the same in both directions of motion, or "friction", against the motion
        order: periods per turn of the input
    """

    kind: Literal["detent", "friction"]
    order: float

    def columns(self, log: MotionLog) -> Array:
        """Return its sine and cosine at every instant of the grid [1], shape (2, m)."""
        motion = log.motion
        sense = np.tanh(motion.speed / turnover_speed(motion.speed)) if self.kind == "friction" else 1.0
        phase = self.order * motion.angle
        return np.stack([sense * np.sin(phase), sense * np.cos(phase)])


def with_ripple(model: MotionModel) -> MotionModel | None:
    """Return the model with the waves over the angle that its residual contains beyond chance; None if there are no more.

    Waves are added one by one, each time the one that explains most of the rest. A wave that other terms make up is not
    separable and takes no part.
    """
    whole = replace(model, log=model.log.sliding_in_full_band())
    _, base, left = _linear(whole)
    found = _beyond_chance(base, left, {wave: _effort(wave, whole)[:, whole.log.motion.rows].T for wave in _possible(whole)})
    largest = max(map(abs, (*found.values(), *sizes_of_waves(model).values())), default=0.0)
    found = {wave: found[wave] for wave in sorted(found) if abs(found[wave]) > MIN_SIZE * largest}
    return _in_gear(model, found) if found else None


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
            path: (numbers[path] + change, float(np.hypot(sigma, _bias_in_full_band(path, numbers[path]))))
            for path, change, sigma in zip(paths, step.values.tolist(), step.sigma.tolist(), strict=False)
            if path in model.of_full_band and np.isfinite(sigma)
        })  # fmt: skip
    return determined


def _bias_in_full_band(path: str, value: float) -> float:
    return BIAS_IN_FULL_BAND * (1.0 if "phase" in path else value)


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


def _possible(model: MotionModel) -> Iterator[Wave]:
    """Yield further waves whose turn the record contains often enough; of a detent over the output's turn, gravity is the
    first."""
    log, ratio, known = model.log, abs(model.drive.gear.kinematics.ratio), sizes_of_waves(model)
    moved = np.ptp(log.motion.angle[log.motion.rows]) / (2.0 * np.pi)
    orders = [order for order in INPUT_ORDERS if moved >= MIN_INPUT_TURNS]
    orders += [order / ratio for order in OUTPUT_ORDERS if moved >= MIN_OUTPUT_TURNS * ratio]
    varies = not is_one_wave(log) and model.law.coulomb > 0.0
    waves = [Wave(kind, order) for order in orders for kind in (("detent", "friction") if varies else ("detent",))]
    yield from (wave for wave in waves if wave not in known)


def _effort(wave: Wave, model: MotionModel) -> Array:
    """Return the effort of sine and cosine of a wave of 1 N.m on the grid of a log, shape (2, m)."""
    log = model.log
    series = per_torque(model.drive, log.effort) * wave.columns(log)
    return log.motion.late(series, log.delay)[0] if log.delayed else series


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
        found = dict[Wave, Array]()
        for wave in (each for each in pairs if each not in chosen):
            own, size = white[wave] - columns @ solved(columns, white[wave]), np.linalg.norm(white[wave], axis=0)
            directions, shares, _ = np.linalg.svd(own / np.maximum(size, 1e-300), full_matrices=False)
            if shares[-1] > MIN_OWN_SHARE:
                found[wave] = rest - directions @ (directions.T @ rest)
        best = min(found, key=lambda wave: float(found[wave] @ found[wave]), default=None)
        if best is None:
            break
        freedom = (len(rest) - columns.shape[1] - 2) / correlation_length(found[best])
        gain = chance_of_gain(float(rest @ rest), float(found[best] @ found[best]), 2, freedom)
        if len(pairs) * gain > MAX_CHANCE:
            break
        chosen.append(best)
        columns, rest = np.column_stack([columns, white[best]]), found[best]
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
        order, amplitude, phase = NUMBERS[wave.kind]
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
