"""Choice of the model of a log by a fit to all but the last stretch, and the spread of its numbers."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from strainwave import Drive
from strainwave.files.recording import Recording
from strainwave.identification.candidates.leave_out import without_rows
from strainwave.identification.candidates.motion_candidate import MotionCandidate, nuisances_of
from strainwave.identification.candidates.motion_model import INPUT, slope_of
from strainwave.identification.candidates.plain import MIN_SLIDING_SPEED, held_out_residuals, moving, stretches
from strainwave.identification.candidates.ripple import by_full_band
from strainwave.identification.experiments.motion_log import FAST_QUANTILE
from strainwave.identification.fitting.fit import solved_problem
from strainwave.identification.results.file_result import HeldOut
from strainwave.identification.results.steady_friction import STEADY_FRICTION
from strainwave.parameters import plain
from strainwave.statistics.residuals import rms

Array = NDArray[np.float64]

JACKKNIFE_BLOCKS = 10  # of a log, each of which is left out once
MIN_COULOMB_DIFFERENCE = 0.1  # relative, from which another law of friction is named
OF_ALL_LAWS = (f"{INPUT}coulomb", f"{INPUT}viscous")  # numbers of friction that mean the same in each law
FAST_SHARE = 0.95  # of the rows: laws of friction are compared by their slope at the speed that they do not exceed
MAX_REFITS = 6  # further models that are fitted to all but the last stretch if the best one is not confirmed


def confirmed(
    best: MotionCandidate, others: Sequence[MotionCandidate], drive: Drive
) -> tuple[MotionCandidate, HeldOut, Recording]:
    """Return the best model that predicts the last 30 % of the motion no worse than plain least squares and than the mean.

    Models were compared by one step of Gauss and Newton, which may hide numbers that the rest of the motion does not determine.

    Returns:
        the model, of all tried the one with the smallest error if none is as good; its error and the smallest one of plain
        least squares, with terms of other joints or without; and its prediction, as `refit`
    """
    logs, tried = {tuple(each.log.regressors): each.log for each in (best, *others)}.values(), []
    of_plain = [(log, held_out_residuals(log, drive, stretches(log))) for log in logs]
    counted = [left for log, left in of_plain if not (log.regressors and beats_by_chance(left, best.residuals))]
    plain = min((rms(left[-1]) for left in counted), default=np.nan)
    for each in (best, *sorted(others, key=lambda other: other.error)[:MAX_REFITS]):
        held_out, predicted = refit(each)
        held_out = replace(held_out, plain=plain)
        tried.append((each, held_out, predicted))
        if not held_out.share_of_plain > held_out.max_share_of_plain and held_out.relative < 1.0:
            return tried[-1]
    return min(tried, key=lambda found: found[1].error)


def beats_by_chance(left: Sequence[Array], of_model: Sequence[Array]) -> bool:
    """True if residuals are smaller than those of a model in the last stretch, but not in all together."""
    return rms(left[-1]) < rms(of_model[-1]) and rms(np.concatenate(left)) > rms(np.concatenate(of_model))


def refit(best: MotionCandidate) -> tuple[HeldOut, Recording]:
    """Return the error on the last 30 % of the motion of the model fitted to what comes before, and its prediction of all.

    Returns:
        the error; and time, effort, `modelled` and `held_out` (1 in the stretch), as
        they are drawn, from the first motion to the last
    """
    log, last = best.log, best.folds[-1].stretch
    (waves,) = by_full_band(best.model, [~last])
    best = replace(best, priors={**best.priors, **waves})
    found = best.fitted_to(~last[log.motion.rows])
    residual = best.left(found.model, nuisances_of(found))
    left, rows = residual[last], moving(log)
    before = float(np.mean(log.recorded[rows & ~last]))
    (part,) = found.parts
    spread = float(np.std(log.measured[0, ~part.training])) if not part.training.all() else 0.0
    in_band = float(part.rms(held_out=True)[0]) / spread if spread > 0.0 else np.nan
    held_out = HeldOut(
        "last 30 % of the motion", log.effort, log.units[0],
        float(np.sqrt(np.mean(left**2))), float(np.sqrt(np.mean((log.recorded[last] - before) ** 2))),
        samples=int(last.sum()), in_band=in_band,
    )  # fmt: skip
    columns = {
        "time": log.motion.time,
        log.effort: log.recorded,
        "modelled": log.recorded - residual,
        "held_out": last.astype(float),
    }
    units = {"time": "s", log.effort: log.units[0], "modelled": log.units[0], "held_out": "1"}
    return held_out, Recording({name: values[rows] for name, values in columns.items()}, units)


def spread_by_blocks(best: MotionCandidate) -> dict[str, float]:
    """Return the standard deviations of the numbers of a fit by how they move without each block of the motion, by path.

    The jackknife (Quenouille1956, Tukey1958) over contiguous blocks: it takes no model of the noise, and sees what differs from
    one part of a record to another. A law that has no number of its own for low speed need not hold there: how far numbers move
    without the slow samples is part of their spread. Numbers at a limit have none.
    """
    problem, x = solved_problem(best.fit)
    rows, speed = np.arange(len(best.log.motion.rows)), np.abs(best.log.motion.speed)
    blocks = [(rows >= each[0]) & (rows <= each[-1]) for each in np.array_split(rows, JACKKNIFE_BLOCKS)]
    slow = speed[best.log.motion.rows] < MIN_SLIDING_SPEED * np.quantile(speed, FAST_QUANTILE)
    if best.model.path_of("stribeck_speed") in best.model.free:
        slow[:] = False
    values = np.array([x, *without_rows(problem, x, [slow, *blocks], ())]).T
    numbers = {plain(each.path): own for each, own in zip(problem.plan.unknowns, values, strict=False)}
    return {
        path: float(np.hypot(np.sqrt((JACKKNIFE_BLOCKS - 1) * np.var(own[2:])), own[1] - own[0]))
        for path, own in with_sum(numbers, best.model.one_speed).items()
    }


def with_sum(numbers: Mapping[str, Any], speed: float) -> dict[str, Any]:
    """Return numbers by their paths with the friction at the one speed of a record [rad/s], if it has one."""
    whole = dict(numbers)
    if speed:
        whole[STEADY_FRICTION] = whole[f"{INPUT}coulomb"] + speed * whole.get(f"{INPUT}viscous", 0.0)
    return whole


def spread_by_models(best: MotionCandidate, others: Sequence[MotionCandidate]) -> dict[str, float]:
    """Return how far numbers lie apart in models that predict as well, by path: the choice of a model is part of their spread.

    Of another law of friction that predicts the pass band better, its Coulomb torque and its slope at fast speeds are compared:
    its other numbers have another meaning, and a law that predicts worse has more freedom than the record needs.
    """
    values = _numbers(best)
    apart = dict.fromkeys(values, 0.0)
    for other in others:
        if not other.predicts_as_well_as(best):
            continue
        is_one_law = type(other.model.law) is type(best.model.law)
        own, error = other.comparable_errors(best)
        of_laws = OF_ALL_LAWS if own < error else ()
        for path, value in _numbers(other).items():
            if path in apart and (is_one_law or not path.startswith(INPUT) or path in of_laws):
                off = abs(value - values[path])
                turned = abs(np.remainder(off + np.pi, 2.0 * np.pi) - np.pi) if "phase" in path else off
                apart[path] = max(apart[path], float(turned))
    return apart


def _numbers(candidate: MotionCandidate) -> dict[str, float]:
    """Return the numbers that are free, and those of all laws of friction or that at the one speed of a record, by path."""
    model, law = candidate.model, candidate.model.law
    numbers = dict(zip(map(plain, model.free), candidate.values, strict=True))
    if model.one_speed:
        numbers[STEADY_FRICTION] = float(law.coulomb + model.one_speed * law.viscous)
        return numbers
    fast = float(np.quantile(np.abs(model.log.motion.speed[model.log.motion.rows]), FAST_SHARE))
    return {**numbers, OF_ALL_LAWS[0]: float(law.coulomb), OF_ALL_LAWS[1]: slope_of(law, fast)}


def other_laws(best: MotionCandidate, others: Sequence[MotionCandidate]) -> list[MotionCandidate]:
    """Return the models with another law of friction that predict as well with another Coulomb torque, the best of each law."""
    laws = {type(best.model.law): best}
    for other in sorted(others, key=lambda each: each.error):
        if other.predicts_as_well_as(best):
            laws.setdefault(type(other.model.law), other)
    coulomb = best.model.law.coulomb
    return [each for each in laws.values() if abs(each.model.law.coulomb - coulomb) > MIN_COULOMB_DIFFERENCE * coulomb]
