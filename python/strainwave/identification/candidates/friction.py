"""Friction tables: the law of friction from torques at constant speeds."""

from __future__ import annotations

import warnings
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from time import perf_counter
from typing import Any, get_args

import numpy as np
from numpy.typing import NDArray

from strainwave import friction
from strainwave._core import Gear, PassivityWarning
from strainwave.equality import ComparedByFields
from strainwave.identification.candidates.steady_shapes import (
    QUADRANTS,
    Shape,
    alike,
    is_loaded,
    over_speed,
    under_load,
    with_conditions,
)
from strainwave.identification.experiments.friction_table import FrictionTable
from strainwave.identification.fitting.fit import EXACT_TOLERANCE, Fit, fit, problem_of
from strainwave.identification.fitting.unknowns import Estimate, plan
from strainwave.statistics.linear_fit import rms_left_out
from strainwave.statistics.residuals import chance_of_gain
from strainwave.statistics.scale import robust_sigma

Array = NDArray[np.float64]

MAX_FOLDS = 10  # parts of a table, each predicted from the others
TIMED_STEPS = 2_000  # of a law
MIN_OUTLIER_SIGMA = 6.0  # robust standard deviations off, beyond noise
MIN_ROWS_FOR_OUTLIERS = 12
MAX_OUTLIER_SHARE = 0.1  # of the rows
MAX_ERROR_LEFT = 0.5  # of the error, without the outliers
MAX_OUTLIER_PASSES = 3  # as outliers hide behind larger ones
MAX_ROUNDING = 1e-7  # of the largest torque: smaller errors are those of rounding and of the end of a fit
MAX_CHANCE_OF_NUMBERS = 0.01  # probability that chance explains as much as more numbers do
MAX_RELATIVE_SIGMA = 0.5  # of a number that a law determines
STEADY_NUMBERS = ("coulomb", "breakaway", "stribeck_speed", "viscous")  # mean the same in every law

Plain = (
    friction.Viscous
    | friction.Coulomb
    | friction.Stribeck
    | friction.LuGre
    | friction.MaxwellSlipFriction
    | friction.CurvedViscous
    | friction.MixedLubrication
    | friction.AngleSpeedMap
)  # laws that a table of torque over speed determines
Modulated = friction.Asymmetric | friction.Thermal | friction.Cyclic


@dataclass(frozen=True, eq=False)
class FrictionCandidate(ComparedByFields):
    """One law fitted to a friction table.

    Attributes:
        name: what it describes
        fit: the fit to the whole table
        held_out: torque at each speed as predicted without the measurements near it [N.m], shape (n,)
        error: rms of measured less `held_out` [N.m]
        error_sigma: standard error of `error` [N.m]
        information: Akaike's criterion, corrected for few samples (HurvichTsai1989) [1]; the least is best
        ties: numbers that follow a fitted one, and its path
    """

    name: str
    fit: Fit
    held_out: Array
    error: float
    error_sigma: float
    information: float
    ties: Mapping[str, str] = field(default_factory=dict)

    @property
    def law(self) -> Any:
        """Fitted law of friction at the input of the gear."""
        return self.fit.gear.friction_input

    @property
    def parameters(self) -> int:
        """Count of the fitted numbers, without those that follow another one."""
        return len(self.fit.plan.unknowns)

    @property
    def coulomb(self) -> float:
        """Fitted Coulomb torque [N.m]; of a map the mean of its slowest speed."""
        law = innermost(self.law)
        if isinstance(law, friction.AngleSpeedMap):
            return float(np.mean(law.level[: len(law.level) // len(law.speed)]))
        return self._found("coulomb")

    @property
    def viscous(self) -> float:
        """Fitted viscous coefficient [N.m.s/rad]; of a curved one, its chord to the reference speed; of a map 0."""
        if isinstance(innermost(self.law), friction.AngleSpeedMap):
            return 0.0
        if isinstance(innermost(self.law), friction.CurvedViscous):
            return self._found("viscous_torque") / float(innermost(self.law).reference_speed)
        return self._found("viscous")

    def estimate(self, other: Estimate) -> Estimate | None:
        """Return its estimate of the same name as one of another law; None without."""
        name = other.path.rpartition(".")[2]
        return next((each for each in self.fit.estimates if each.path.rpartition(".")[2] == name), None)

    def _found(self, name: str) -> float:
        return next(each.value for each in self.fit.estimates if each.path.rpartition(".")[2] == name)


def fit_friction(table: FrictionTable, gear: Gear) -> list[FrictionCandidate]:
    """Fit the friction of a gear to a table by every law that it can determine; return them by rank.

    Tried are Coulomb and viscous friction, a fall from breakaway, a curved viscous part, both, and each of them asymmetric
    where both directions were measured. Around the best of them what varies with the temperature, the load and the angle is
    tried, where the table has these columns. Bristles of the gear (LuGre, Maxwell slip) are kept, as a table does not show
    them, and damped so little that they dissipate; a curved viscous part leaves them out. Of Coulomb's law, whose steady torque
    does not depend on breakaway, the ratio of breakaway to Coulomb torque is kept.

    Args:
        table: measured torque over speed
        gear: the gear to start from

    Returns:
        candidates, best first: the one with fewest parameters whose error of predictions from the rest of the table lies within
        one standard error of the least, the difference taken sample by sample, or is larger by what may be chance; behind it
        the others by their error. The standard deviations of the first have inside how far laws that are about as likely stray
        from its numbers

    Raises:
        ValueError: fewer than four speeds, or a law of the gear that a table does not determine

    Warns:
        RuntimeWarning: rows that lie so far from all others that the fits leave them out, which halves the error or more; they
            are those that `fit.training` does not have
    """
    law_before = _known(gear.friction_input, table)
    if not isinstance(law_before, Plain):
        names = [law.name for law in get_args(Plain)]
        raise ValueError(
            f"a friction table cannot be fitted to {law_before.name} friction; "
            f"it can to {', '.join(names[:-1])} or {names[-1]}, so start from a gear with one of these at the input"
        )
    speeds = len(np.unique(table.speed))
    if speeds < 4:
        raise ValueError(
            f"a friction table needs at least 4 speeds, one of them to validate; this one has {speeds}: record more, both ways"
        )
    tried, trusted = _without_outliers(table, gear)
    _, best = _chosen(tried)
    others = sorted((candidate for _, candidate in tried if candidate is not best), key=lambda candidate: candidate.error)
    ranked = [best, *others]
    if not trusted.all():
        _warn(table, trusted, best)
        ranked = [_on_all(each, table, trusted) for each in ranked]
    ranked[0] = _widened_by_choice(*ranked)
    return [replace(each, fit=written(each, gear, table)) for each in ranked]


def innermost(law: Any) -> Any:
    """Return the law that others modulate."""
    return innermost(law.law) if isinstance(law, Modulated) else law


def cost_of(law: Any) -> float:
    """Return the time of one step of a law on this machine [µs], the least of five tries."""
    time, speed = np.linspace(0.0, 1.0, TIMED_STEPS), np.linspace(-1.0, 1.0, TIMED_STEPS)
    tries = []
    for _ in range(5):
        begun = perf_counter()
        law.trace(time, speed)
        tries.append(perf_counter() - begun)
    return 1e6 * min(tries) / TIMED_STEPS


def dissipating(law: Any) -> Any:
    """Return the law, with bristles damped half as much as dissipates in every motion, if they were damped more."""
    if not isinstance(law, friction.LuGre) or law.breakaway <= law.coulomb or law.damping_fading > 0.0:
        return law
    most = law.viscous * law.coulomb / (law.breakaway - law.coulomb)
    return law if law.bristle_damping <= most else law.replace(bristle_damping=0.5 * most)


def _known(law: Any, table: FrictionTable) -> Any:
    """Return the law that others modulate, as far as the table has what modulates it."""
    shown = isinstance(law, friction.Asymmetric)
    shown |= isinstance(law, friction.Thermal) and table.temperature is not None
    shown |= isinstance(law, friction.Cyclic) and table.angle is not None
    return _known(law.law, table) if shown else law


def outliers(off: Array) -> NDArray[np.bool_]:
    """Return which of the errors of predictions are outliers: few, and more standard deviations off than noise reaches.

    >>> outliers(np.array([0.1, -0.2, 0.1, 0.0, 0.2, -0.1, 5.0, 0.1, -0.1, 0.2, -0.2, 0.1])).nonzero()[0].tolist()
    [6]
    """
    size = np.abs(off)
    sigma = float(robust_sigma(size))
    far = size > MIN_OUTLIER_SIGMA * sigma
    return (
        far
        if len(off) >= MIN_ROWS_FOR_OUTLIERS and sigma > 0.0 and far.mean() <= MAX_OUTLIER_SHARE
        else np.zeros(len(off), bool)
    )


def _tried(table: FrictionTable, gear: Gear) -> list[tuple[Shape, FrictionCandidate]]:
    """Return every law that the table may determine, those over the speed first."""
    shapes = [*over_speed(table), *(under_load(table, gear.kinematics.ratio) if is_loaded(table) else ())]
    tried = [(shape, candidate) for shape in shapes if _falls(candidate := _candidate(shape, table, gear))]
    shape, best = _chosen(tried)
    mesh = shape.mesh and best.fit.gear.friction_mesh
    wider = with_conditions(table, replace(shape, law=best.law, mesh=mesh), best.fit.residuals[0])
    return [*tried, *((more, _candidate(more, table, gear)) for more in wider)]


def _without_outliers(table: FrictionTable, gear: Gear) -> tuple[list[tuple[Shape, FrictionCandidate]], NDArray[np.bool_]]:
    """Return every law fitted to the rows without outliers, and these rows; to all if that does not halve the error."""
    whole = tried = _tried(table, gear)
    everything = trusted = np.ones(len(table.speed), bool)
    for _ in range(MAX_OUTLIER_PASSES):
        _, best = _chosen(tried)
        kept = trusted.copy()
        kept[np.flatnonzero(trusted)[outliers(table.torque[trusted] - best.held_out)]] = False
        if np.array_equal(kept, trusted) or len(np.unique(table.speed[kept])) < 4:
            break
        tried, trusted = _tried(_rows(table, kept), gear), kept
    few = np.mean(~trusted) <= MAX_OUTLIER_SHARE
    better = _chosen(tried)[1].error <= MAX_ERROR_LEFT * _chosen(whole)[1].error
    return (tried, trusted) if few and better else (whole, everything)


def _rows(table: FrictionTable, kept: NDArray[np.bool_]) -> FrictionTable:
    columns = ((name, getattr(table, name)) for name in ("speed", "torque", "angle", "load", "temperature"))
    changed: dict[str, Any] = {name: values[kept] for name, values in columns if values is not None}
    return replace(table, **changed)


def _on_all(candidate: FrictionCandidate, table: FrictionTable, trusted: NDArray[np.bool_]) -> FrictionCandidate:
    """Return the candidate with the whole table, outliers included."""
    unknowns, ties = candidate.fit.plan.unknowns, candidate.ties
    whole = fit(candidate.fit.gear, table, [each.path for each in unknowns], ties=ties, training=trusted)
    held_out = whole.predicted[0].copy()
    held_out[trusted] = candidate.held_out
    return replace(candidate, fit=whole, held_out=held_out)


def _warn(table: FrictionTable, trusted: NDArray[np.bool_], best: FrictionCandidate) -> None:
    rows = np.flatnonzero(~trusted)
    named = "; ".join(f"row {row}, {table.torque[row]:.4g} N·m at {table.speed[row]:.4g} rad/s" for row in rows[:5])
    more = f"; and {len(rows) - 5} more" if len(rows) > 5 else ""
    warnings.warn(
        f"{len(rows)} of {len(trusted)} rows of the friction table lie more than {MIN_OUTLIER_SIGMA:g} standard deviations off "
        f"what the others predict, and were left out: {named}{more}. Without them the error of predictions is "
        f"{best.error:.3g} N·m. Measure them again, or take them out of the table",
        RuntimeWarning,
        stacklevel=3,
    )


def _falls(candidate: FrictionCandidate) -> bool:
    """False if a fall was tried but the torque rises from rest on, as by a law without one."""
    law = innermost(candidate.law)
    return "fall" not in candidate.name or bool(law.breakaway > law.coulomb)


def _chosen(tried: Sequence[tuple[Shape, FrictionCandidate]]) -> tuple[Shape, FrictionCandidate]:
    """Return the simplest within one standard error of the best (Breiman1984), compared sample by sample.

    Also one that chance may have made worse than the best (F test): of many laws tried some look better than they are.
    """
    best = min((candidate for _, candidate in tried), key=lambda candidate: candidate.error)
    squares, rounding = _squares(best), (MAX_ROUNDING * float(np.abs(best.fit.experiment.measured).max())) ** 2

    def as_good(candidate: FrictionCandidate) -> bool:
        worse = _squares(candidate) - squares
        within = bool(np.mean(worse) <= max(np.std(worse, ddof=1) / np.sqrt(len(worse)), rounding))
        more = best.parameters - candidate.parameters
        before, left = candidate.fit.residuals[0], best.fit.residuals[0]
        return within or (more > 0 and by_chance(before, left, more, best.parameters) > MAX_CHANCE_OF_NUMBERS)

    return min(((s, c) for s, c in tried if as_good(c)), key=lambda pair: (pair[1].parameters, pair[1].error))


def _widened_by_choice(best: FrictionCandidate, *others: FrictionCandidate) -> FrictionCandidate:
    """Return the best law, its numbers as uncertain as the choice among laws makes them (Buckland1997, eq. 9).

    Numbers that laws have in common differ between laws more than within one. Laws that determine a number count, by Akaike's
    weights; no standard deviation becomes smaller.
    """
    least = min(each.information for each in (best, *others))
    if not np.isfinite(least):
        return best

    def sigma(estimate: Estimate) -> float:
        alike = [(each.information, other) for each in others if (other := each.estimate(estimate)) is not None]
        counted = [
            (best.information, estimate),
            *((i, other) for i, other in alike if other.sigma < MAX_RELATIVE_SIGMA * abs(other.value)),
        ]
        weights = np.exp([0.5 * (least - information) for information, _ in counted])
        strays = [float(np.hypot(other.sigma, other.value - estimate.value)) for _, other in counted]
        return max(estimate.sigma, float(weights @ strays / weights.sum())) if np.any(weights) else estimate.sigma

    estimates = tuple(replace(each, sigma=sigma(each)) for each in best.fit.estimates)
    return replace(best, fit=replace(best.fit, estimates=estimates))


def _squares(candidate: FrictionCandidate) -> Array:
    squares: Array = (candidate.fit.experiment.measured[0] - candidate.held_out) ** 2
    return squares


def by_chance(before: Array, left: Array, more: int, unknowns: int) -> float:
    """Return the probability that `more` unknowns shrink white residuals as much by chance (F test), of `unknowns` in all."""
    return chance_of_gain(float(np.sum(before**2)), float(np.sum(left**2)), more, len(left) - unknowns)


def written(candidate: FrictionCandidate, gear: Gear, table: FrictionTable) -> Fit:
    """Return the fit with the law as the gear shall have it: with its bristles, and its ratio of breakaway without a fall."""
    law_before = _known(gear.friction_input, table)
    fell = any(estimate.path.endswith("breakaway") for estimate in candidate.fit.estimates)
    with warnings.catch_warnings(action="ignore", category=PassivityWarning):
        law, mesh = _kept(candidate.law, law_before, fell), _completed(candidate.fit)
        return replace(candidate.fit, model=gear.replace(friction_input=law, friction_mesh=mesh))


def _completed(found: Fit) -> Any:
    """Return the friction of the mesh; a quadrant without loads loses as much as the measured one that is most like it."""
    mesh: Any = found.gear.friction_mesh
    paths = [each.path for each in found.estimates]
    measured = [name for name in QUADRANTS if f"friction_mesh.{name}" in paths]
    return mesh.replace(**{name: getattr(mesh, alike(name, measured)) for name in QUADRANTS}) if measured else mesh


def _kept(found: Any, known: Plain, fell: bool) -> Any:
    """Return the law found, with the bristles of the gear if it has such; without a fall, with its ratio of breakaway."""
    if isinstance(found, Modulated):
        return found.replace(law=_kept(found.law, known, fell))
    ratio = known.breakaway / known.coulomb if isinstance(known, friction.Coulomb) and known.coulomb > 0.0 else 1.0
    law = found if fell or isinstance(found, friction.AngleSpeedMap) else found.replace(breakaway=ratio * found.coulomb)
    kinds = friction.Stribeck | friction.LuGre | friction.MaxwellSlipFriction | friction.MixedLubrication
    if isinstance(law, friction.Coulomb | friction.Stribeck) and isinstance(known, kinds):
        return dissipating(known.replace(**{name: getattr(law, name) for name in STEADY_NUMBERS if hasattr(law, name)}))
    return law


def parts_of(table: FrictionTable) -> list[NDArray[np.bool_]]:
    """Return the rows of each part of a table that is predicted from the others."""
    fold = np.argsort(np.argsort(table.speed, kind="stable")) % min(MAX_FOLDS, len(table.speed))
    return [fold == part for part in np.unique(fold)]


def plain_error(table: FrictionTable, trusted: NDArray[np.bool_]) -> float:
    """Return the error of Coulomb and viscous friction by least squares, where each part is predicted from the others [N.m].

    With both directions a zero error of the torque is among the unknowns, with loads a loss in proportion to them. Outliers are
    left out, as from the error of a candidate.
    """
    table = _rows(table, trusted)
    way = np.sign(table.speed)
    both_ways = [np.ones(len(way))] if np.ptp(way) else []
    loss = [] if table.load is None else [way * np.abs(table.load)]
    return rms_left_out(np.stack([way, table.speed, *both_ways, *loss], axis=1), table.torque, parts_of(table))


def _candidate(shape: Shape, table: FrictionTable, gear: Gear) -> FrictionCandidate:
    start = gear.replace(friction_input=shape.law, friction_mesh=shape.mesh or gear.friction_mesh)
    whole = fit(start, table, shape.paths, ties=shape.followers)
    held_out, asked = np.empty(len(table.speed)), plan(whole.gear, [""], shape.paths, ties=shape.followers)
    for left_out in parts_of(table):
        problem = problem_of(asked, whole.gear, [table], [~left_out])  # of one channel: its weight changes nothing
        x = problem.solve(problem.start(), problem.first_weights(), EXACT_TOLERANCE)
        ((predicted, _),) = problem.predict(x)
        held_out[left_out] = predicted[0, left_out]
    squares = (table.torque - held_out) ** 2
    error = float(np.sqrt(np.mean(squares)))
    spread = float(np.std(squares, ddof=1) / np.sqrt(len(squares)))
    return FrictionCandidate(
        shape.name, whole, held_out, error, 0.5 * spread / error if error > 0.0 else 0.0,
        information(whole.residuals[0], len(shape.paths)), shape.followers,
    )  # fmt: skip


def information(residual: Array, parameters: int) -> float:
    """Return Akaike's criterion of residuals of equal variance, corrected for few samples; infinite where there are too few."""
    n, unknowns = len(residual), parameters + 1
    if n <= unknowns + 1:
        return np.inf
    variance = max(float(np.mean(residual**2)), np.finfo(float).tiny)
    return float(n * np.log(variance) + 2.0 * unknowns * n / (n - unknowns - 1))
