"""Parameters that a fit determines only together, and its estimates if one that it kept is wrong."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from strainwave import arguments
from strainwave.equality import ComparedByFields
from strainwave.files.entries import Entry
from strainwave.identification.fitting.fit import Fit, solved_problem
from strainwave.identification.fitting.problem import MIN_NOISE
from strainwave.parameters import Parameter, every
from strainwave.presentation import Statement
from strainwave.statistics.determined_sum import sum_in_words
from strainwave.statistics.linear_fit import solved
from strainwave.statistics.residuals import correlation_length

Array = NDArray[np.float64]

MAX_EXPLAINED_SHARE = 0.3  # of the residuals' power: a kept parameter whose change explains more of it is wrong
MIN_SHARE_OF_LARGEST = 0.8  # of the largest share explained: which of such parameters explains a little more is chance
DESIGNED_PARTS = ("control.", "gear.kinematics.", "kinematics.")  # exact, as they are designed
REFERENCE_NAMES = (".reference_temperature", ".reference_speed")  # exact: the other numbers of a law are those there
SIGMA_IF_NOT_STATED = 0.1  # relative, of a kept value whose source states neither spread nor uncertainty
SIGMA_IF_ASSUMED = 0.5  # relative, of a kept value that is assumed
MAX_SIGMA_OF_DIRECTION = 0.1  # of a change in a direction; the data leave directions with a larger one open (assumed)
MIN_RELATIVE_CHANGE = 0.02  # of the largest change in a direction; a parameter that changes less takes no part
EXPONENT_TOLERANCE = 0.03  # relative, between an exponent and a ratio of small whole numbers
SIMPLE_EXPONENTS = sorted({sign * a / b for a in (1, 2, 3) for b in (1, 2, 3) for sign in (1, -1)})
MIN_SINGULAR_OF_DIRECTION = 1e-9  # of the largest singular value; directions with a smaller one change nothing


# ---- Parameters kept -------------------------------------------------------------------------------------------------


@dataclass(frozen=True, eq=False)
class InfluenceOfKept(ComparedByFields):
    """Change of the estimates of a fit with the parameters that it kept.

    Attributes:
        kept: the parameters kept whose value is not zero
        slopes: change of each estimate over the change of each of these, shape (estimates, kept)
        bounds: error of each of them that makes a residual as large as the noise, shape (kept,)
        shift_if_free: change of each of them if it were fitted, shape (kept,)
        explained_share: share of the residuals' power that this change explains, shape (kept,)
    """

    kept: tuple[Parameter, ...]
    slopes: Array
    bounds: Array
    shift_if_free: Array
    explained_share: Array

    @classmethod
    def none(cls, estimates: int) -> InfluenceOfKept:
        """Return that of a fit that explains nothing."""
        return cls((), np.zeros((estimates, 0)), *np.zeros((3, 0)))

    def suspects(self, known: Mapping[str, Entry], prefix: str = "") -> list[int]:
        """Return the places of kept parameters that the measurement contradicts, the least certain first.

        A change of such a parameter explains much of the residuals, is larger than its uncertainty allows, and leads to a
        possible value. Several that explain about as much are all returned: the data do not determine which is wrong.
        """
        uncertainties = np.array([uncertainty(each.value, known.get(prefix + each.path)) for each in self.kept])
        better = self.shift_if_free + [each.value for each in self.kept]
        possible = (better >= [each.low for each in self.kept]) & (better <= [each.high for each in self.kept])
        wrong = possible & (np.abs(self.shift_if_free) > uncertainties) & (self.explained_share > MAX_EXPLAINED_SHARE)
        least = MIN_SHARE_OF_LARGEST * float(np.max(self.explained_share, initial=0.0, where=wrong))
        strain = np.abs(self.shift_if_free) / np.maximum(uncertainties, 1e-300)
        return sorted(np.flatnonzero(wrong & (self.explained_share >= least)).tolist(), key=lambda place: strain[place])

    def shifts(self, estimate: int, known: Mapping[str, Entry], prefix: str = "") -> dict[str, float]:
        """Return the shift of an estimate by the standard deviation of each kept parameter, in its unit; largest first.

        Args:
            estimate: its place in the fit
            known: sources of the kept parameters, by `prefix` and path; without one, 10 % is taken
        """
        moved = {}
        for each, slope, bound in zip(self.kept, self.slopes[estimate].tolist(), self.bounds.tolist(), strict=True):
            before = uncertainty(each.value, known.get(prefix + each.path))
            # prior and measurement weigh by their variances
            moved[each.path] = abs(slope) * before / float(np.hypot(1.0, before / bound)) if before > 0.0 else 0.0
        return dict(sorted(moved.items(), key=lambda item: -item[1]))


def uncertainty(value: float, entry: Entry | None) -> float:
    """Return the standard deviation of a kept value by its source; else 10 % of it, and 50 % if it is assumed.

    >>> uncertainty(20.0, Entry("catalogue", spread=0.3)), uncertainty(20.0, None), uncertainty(20.0, Entry("assumed"))
    (6.0, 2.0, 10.0)
    """
    if entry is not None and (stated := entry.sigma(value)) is not None:
        return stated
    return (SIGMA_IF_ASSUMED if entry is not None and entry.assumed else SIGMA_IF_NOT_STATED) * abs(value)


def influence(found: Fit) -> InfluenceOfKept:
    """Return the change of the estimates of a fit with what it kept, to first order.

    At the minimum the gradient J'r of the least squares is zero, and stays so when a kept parameter changes: the estimates move
    by -(J'J)^-1 J'K, with J and K the derivatives of the weighted residuals by the free and by the kept parameters. The part of
    K that no change of the estimates makes up for remains in the residuals, and so bounds the kept parameter.
    """
    described = every(found.model)
    nuisances = len(found.experiment.nuisances)
    of_model = found.estimates[: len(found.estimates) - nuisances]
    free = [described[estimate.path] for estimate in of_model]
    own = {each.number for each in free}
    kept = tuple(
        each for each in described.values() if each.number not in own and each.value != 0.0 and not _is_exact(each.path)
    )
    unknowns = np.array([estimate.value for estimate in found.estimates[len(of_model) :]])
    numbers = [each.number for each in (*free, *kept)]
    _, slopes = found.experiment.predict(found.model, numbers, unknowns)
    residual = np.sqrt(np.mean(found.residuals[:, found.training] ** 2, axis=1))
    size = np.abs(found.experiment.measured).max(axis=1)
    weights = 1.0 / np.maximum(residual, MIN_NOISE * np.where(size > 0.0, size, 1.0))
    residuals = (found.residuals[:, found.training] * weights[:, np.newaxis]).ravel()
    columns = (slopes * weights[:, np.newaxis])[:, :, found.training].reshape(len(slopes), -1).T
    by_free = np.column_stack((columns[:, : len(free)], columns[:, len(numbers) :]))
    by_kept = columns[:, len(free) : len(numbers)]
    acting = np.any(by_kept, axis=0)
    moved = np.zeros((by_free.shape[1], len(kept)))
    moved[:, acting] = -solved(by_free, by_kept[:, acting])
    shown = by_kept + by_free @ moved
    power = np.sum(shown**2, axis=0)
    divisor = np.where(power > 0.0, power, 1.0)
    length = max(correlation_length(row) for row in found.residuals[:, found.training])
    bounds = np.where(power > 0.0, np.sqrt(length / divisor), np.inf)
    shift = np.where(power > 0.0, residuals @ shown / divisor, 0.0)
    explained = shift**2 * power / max(float(residuals @ residuals), 1e-300)
    return InfluenceOfKept(kept, moved, bounds, shift, explained)


def _is_exact(path: str) -> bool:
    return path.startswith(DESIGNED_PARTS) or path.endswith(REFERENCE_NAMES) or ".order[" in path


# ---- Series that a model lacks ---------------------------------------------------------------------------------------


def change_with(fit: Fit, series: Array) -> tuple[dict[str, float], Array]:
    """Return by how much the parameters of a fit change if shares of further series are fitted too, by path; and these shares.

    Args:
        fit: of one channel of one record
        series: added to its prediction, shape (series, n)
    """
    problem, x = solved_problem(fit)
    weights = problem.weights(x)
    weight = float(weights[0].rows.item())
    columns = np.hstack([problem.jacobian(x, weights), weight * series[:, problem.records[0].training].T])
    of_priors, right = problem.prior_rows()
    columns = np.vstack([columns, np.hstack([of_priors, np.zeros((len(of_priors), len(series)))])])
    left = np.concatenate([weight * problem.residuals(x)[0][0], right - of_priors @ x])
    change = solved(columns, left)
    paths = [unknown.path for unknown in problem.plan.unknowns]
    return dict(zip(paths, change.tolist(), strict=False)), change[len(x) :]


# ---- Combinations ----------------------------------------------------------------------------------------------------


@dataclass(frozen=True, eq=False)
class Combination(ComparedByFields, Statement):
    """Parameters that the data do not determine one by one.

    Attributes:
        paths: of the parameters, those first that change most
        open: relative change of each that the data leave open: they can change together by any multiple of it; the largest is 1
        relative: standard deviation of that change of all, infinite where nothing changes
        formula: of two parameters, that the data determine; empty for one, or for more
        value: of the formula
        sigma: its standard deviation
        unit: its unit; empty where parameters of different units multiply

    >>> import numpy as np
    >>> import strainwave as sw
    >>> drive = sw.Drive(load=sw.loads.Inertia(inertia=0.1))
    >>> voltage = sw.scenario.sine(5.0, frequency=2.0, duration=0.5)
    >>> run = sw.simulate(drive, voltage, sample=1e-2, record=["command", "input_angle"])
    >>> noise = 1e-2 * np.random.default_rng(0).normal(size=len(run))
    >>> log = run.with_column("input_angle", run["input_angle"] + noise, "rad")
    >>> (combination,) = sw.identification.combinations(sw.fit(drive, log, ["motor.inertia", "load.inertia"]))
    >>> combination.formula, round(1e6 * combination.value), round(1e6 * combination.sigma, 2)  # 1e-6 kg.m2
    ('motor.inertia + 0.0001 load.inertia', 20, 0.04)
    """

    paths: tuple[str, ...]
    open: tuple[float, ...]
    relative: float
    formula: str = ""
    value: float = np.nan
    sigma: float = np.nan
    unit: str = ""

    def _headline(self) -> str:
        if len(self.paths) == 1:
            spread = f": ± {100.0 * self.relative:.0f} %" if np.isfinite(self.relative) else ""
            return f"{self.paths[0]} is not determined{spread}"
        if self.formula:
            names = " and ".join(self.paths)
            return f"of {names} only {self.formula} is determined: {self.value:.4g} ± {self.sigma:.1g} {self.unit}".rstrip()
        changes = ", ".join(f"{path} by {100.0 * part:+.0f} %" for path, part in zip(self.paths, self.open, strict=True))
        return f"{len(self.paths)} parameters are determined only together: the prediction hardly changes with {changes}"


def combinations(found: Fit, *, max_relative_sigma: float = MAX_SIGMA_OF_DIRECTION) -> tuple[Combination, ...]:
    """Return the parameters of the model that a fit determines only in combination, the least known first.

    Directions in which the parameters can change, each relative to its size, without a change of what is predicted that the
    noise would not hide: eigenvectors of the second derivatives of the cost in logarithmic parameters, with the unknowns of the
    measurement fitted along. Of a direction in which two parameters change, the data determine what it leaves as it is: a sum
    or a difference where both have one unit, a product of powers where the exponents are near ratios of whole numbers up to 3.

    Args:
        found: result of `fit`; parameters that are 0 take no part
        max_relative_sigma: relative standard deviation above which a direction counts as open

    Returns:
        One combination for each open direction; none if the fit determines every parameter by itself.

    Raises:
        TypeError: `found` is no fit
        ValueError: `max_relative_sigma` is negative

    Valid near the estimates: to first order, sum and product of two parameters are not separated.

    Source: Gutenkunst et al., PLoS Computational Biology 3 (2007) 1871-1878.

    >>> import strainwave as sw
    >>> law = sw.friction.Coulomb(coulomb=0.02, breakaway=0.02, viscous=3e-4)
    >>> speed = np.linspace(1.0, 50.0, 60)
    >>> torque = law.steady(speed) + 1e-4 * np.random.default_rng(0).normal(size=60)
    >>> table = sw.Recording({"speed": speed, "torque": torque}, {"speed": "rad/s", "torque": "N.m"})
    >>> gear = sw.Gear(friction_input=law, damping=3.0)
    >>> for each in combinations(sw.fit(gear, table, ["friction_input.coulomb", "damping"])):
    ...     print(each)
    damping is not determined
    """
    limit = arguments.number("max_relative_sigma", max_relative_sigma, low=0.0)
    problem, best = solved_problem(found)
    weights = problem.weights(best)
    rows = problem.information(best, weights)
    count = len(found.plan.unknowns)
    estimates = found.estimates[:count]
    size = np.array([max(abs(value), abs(each.start)) for value, each in zip(best, estimates, strict=False)])
    chosen = [place for place in range(count) if best[place] != 0.0]
    if not chosen:
        return ()
    size = size[chosen]  # a fit may have gone far in an open direction: its beginning has a size too
    stated, naive = np.array([each.sigma for each in estimates]), problem.naive_sigma(best, weights)[:count]
    both = np.isfinite(stated) & np.isfinite(naive) & (naive > 0.0)
    wider = float(np.median(stated[both] / naive[both])) if both.any() else 1.0  # as residuals correlate
    directions, sigmas = _directions(rows, chosen, size, wider)
    open_ones = []
    for direction, sigma in zip(directions, sigmas, strict=True):
        if sigma > limit:
            order = [
                i for i in np.argsort(-np.abs(direction)) if abs(direction[i]) > MIN_RELATIVE_CHANGE * np.abs(direction).max()
            ]
            open_ones.append((order, direction / direction[order[0]], sigma))
    roots = (directions.T * np.where(sigmas <= limit, sigmas, 0.0)).T  # of the covariance of what is determined
    made = []
    for order, direction, sigma in open_ones:
        paths = tuple(estimates[chosen[i]].path for i in order)
        units = [estimates[chosen[i]].unit for i in order]
        values = best[[chosen[i] for i in order]]
        changes = direction[order]
        formula = _formula(paths, units, values, changes * size[order]) if len(order) == 2 else None
        if formula is None:
            made.append(Combination(paths, tuple(changes.tolist()), float(sigma)))
            continue
        words, value, slopes, unit = formula
        gradient = np.zeros(len(chosen))
        gradient[order] = slopes * size[order]
        deviation = float(np.linalg.norm(roots @ gradient))
        made.append(Combination(paths, tuple(changes.tolist()), float(sigma), words, value, deviation, unit))
    return tuple(made)


def _directions(rows: Array, chosen: list[int], size: Array, wider: float) -> tuple[Array, Array]:
    """Return directions of relative change, shape (k, k), and the standard deviation of each change, the largest first."""
    others = np.delete(rows, chosen, axis=1)
    columns = rows[:, chosen] * size
    length = np.linalg.norm(others, axis=0)
    if (length > 0.0).any():  # what the others can make up for is not determined
        basis = np.linalg.svd((others / np.where(length > 0.0, length, 1.0))[:, length > 0.0], full_matrices=False)[0]
        columns = columns - basis @ (basis.T @ columns)
    _, singular, directions = np.linalg.svd(columns, full_matrices=True)
    singular = np.append(singular, np.zeros(len(chosen) - len(singular)))
    dead = singular <= MIN_SINGULAR_OF_DIRECTION * singular.max(initial=0.0)
    with np.errstate(divide="ignore"):
        sigmas = np.where(dead, np.inf, wider / np.where(dead, 1.0, singular))
    order = np.argsort(-sigmas, kind="stable")
    return directions[order], sigmas[order]


def _formula(paths: tuple[str, ...], units: list[str], values: Array, moves: Array) -> tuple[str, float, Array, str] | None:
    """Return a formula of two parameters that stays the same when both move: words, value, derivatives, unit."""
    alike = abs(abs(moves[0] / moves[1]) - 1.0) < EXPONENT_TOLERANCE
    first = paths[0] <= paths[1] if alike else abs(moves[0]) <= abs(moves[1])  # the larger factor is 1, else by name
    if units[0] == units[1] and not first:
        swapped = _formula(paths[::-1], units[::-1], values[::-1], moves[::-1])
        return None if swapped is None else (*swapped[:2], swapped[2][::-1], swapped[3])
    power = -(moves[0] / values[0]) / (moves[1] / values[1])  # of the second, where the first has 1
    nearest = min(SIMPLE_EXPONENTS, key=lambda ratio: abs(ratio - power))
    whole = abs(nearest - power) <= EXPONENT_TOLERANCE * abs(nearest)
    if units[0] == units[1] and not (whole and nearest < 0.0):
        factor = -moves[0] / moves[1]
        words = sum_in_words(paths, (1.0, np.copysign(1.0, factor) if alike else factor))
        return words, float(values[0] + factor * values[1]), np.array([1.0, factor]), units[0]
    if not whole:
        return None
    value = float(abs(values[0]) * abs(values[1]) ** nearest)
    words = f"{paths[0]} {'*' if nearest > 0.0 else '/'} {paths[1]}" + ("" if abs(nearest) == 1.0 else f"^{abs(nearest):.3g}")
    return words, value, value * np.array([1.0, nearest]) / values, "1" if units[0] == units[1] and nearest == -1.0 else ""
