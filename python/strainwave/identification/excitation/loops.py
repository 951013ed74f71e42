"""A plan of the next torsion loops: those that separate the sources of loss which the loops measured so far do not."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np
from numpy.typing import NDArray

from strainwave import arguments
from strainwave._core import Gear
from strainwave.files.recording import Recording
from strainwave.identification.candidates.torsion.losses.fit import MAX_SHARE_SIGMA, LossFit, fit_losses
from strainwave.identification.candidates.torsion.losses.next_loops import options, with_bearing, with_rows
from strainwave.identification.candidates.torsion.losses.shares import LossShares, shares_of
from strainwave.identification.excitation.plan import (
    USUAL_DURATIONS,
    Expectation,
    ExperimentPlan,
    PlannedMeasurement,
    too_short,
)
from strainwave.identification.experiments.loss_loop import LossLoop
from strainwave.messages import listed, quoted
from strainwave.typeset import percent, quantity

Array = NDArray[np.float64]
CYCLES_OF_LOOP = 2.0  # of a loop: the first ends transients of bristles
MIN_GAIN_OF_SHARE = 1e-6  # relative, of a standard deviation: rounding below it
WARMING_TIME = 1800.0  # s until a gear has another temperature throughout (assumed)
ALL_SOURCES = "loss"
NO_LOOP_NEEDED = "no loop is needed: of each wanted share, noise leaves less open than the forms of the sources do"


def plan_loops(
    loops: Sequence[Recording], gear: Gear, wanted: Sequence[str] = (ALL_SOURCES,), *, time: float = 3600.0
) -> ExperimentPlan:
    """Return the torsion loops that separate sources of loss best in a given time, after loops that were measured.

    Each loop at another load, rate, temperature or side of the gear has a Fisher information about the shares of `loss_shares`.
    Loops are added by gain over duration, the best one first, until the noise leaves less open than the forms of the sources.

    Args:
        loops: that were measured, as of `loss_shares`
        gear: whose ratio refers loops at the input to the output
        wanted: names of sources, as `loss_shares` gives them; "loss" for all
        time: what all loops may take together [s]

    Returns:
        The loops, and the standard deviation of each share [1] before and after them. Without a loop at the input so far, that
        of the bearing is in units of the loss at the output, infinite before, and without a value.

    Raises:
        ValueError: no such source; else as `loss_shares`

    Valid near the shares that the loops determine: plan anew after each loop. Loops reach at most the torque of the largest one
    so far, at up to five times its rate, and 20 K warmer if loops at two temperatures are there. The noise of the torque is
    assumed to be that of the loops so far, at the input referred to the output. A load on one side, or another angle of the
    input, is not tried, nor a loop at the input of a gear with stages.

    Source: as `plan_experiments`.

    >>> import strainwave as sw
    >>> way = np.sin(np.linspace(0.5, 4.5, 801) * np.pi)
    >>> torque = 40.0 * way + (1.0 + 0.8 * np.abs(way)) * np.sign(np.gradient(way))
    >>> torque += 0.01 * np.random.default_rng(0).normal(size=801)
    >>> units = {"input_angle": "rad", "input_torque": "N.m"}
    >>> loop = sw.Recording({"input_angle": 0.1 * way, "input_torque": torque / 100.0}, units)
    >>> plan = plan_loops([loop], sw.load("hfuc-25-100"))
    >>> [step.settings["measured_at"] for step in plan.steps], round(plan["bearing, dry"].before, 1)
    (['output'], 0.7)
    """
    measured, budget = fit_losses(loops, gear), arguments.seconds("time", time)
    fit, shares = with_bearing(measured, gear), shares_of(measured)
    places = _places(wanted, fit.names)
    possible = [*options(fit, abs(gear.kinematics.ratio))]
    cost = np.array([_duration(loop, fit.widths.reference_temperature) for loop, _ in possible])
    taken, covariance = _taken(fit, [rows for _, rows in possible], places, cost, budget)
    steps = [
        PlannedMeasurement("torsion", possible[place][0].words, _settings(possible[place][0]), 1, float(cost[place]))
        for place in taken
    ]
    reason = too_short(budget, cost) if _is_open(fit, fit.covariance, places) else {"reason": NO_LOOP_NEEDED}
    notes = _notes(fit, shares, [loop for loop, _ in possible])
    return ExperimentPlan(tuple(steps), tuple(_expectations(fit, shares, covariance, places)), tuple(notes), **reason)


def _places(wanted: Sequence[str], names: Sequence[str]) -> list[int]:
    """Return the places of the sources that are wanted by their names.

    Raises:
        ValueError: no such source
    """
    asked = arguments.names("wanted", wanted)
    for name in asked:
        if name not in (ALL_SOURCES, *names):
            known = listed(map(quoted, (*names, ALL_SOURCES)))
            raise ValueError(f"wanted: {quoted(name)} is no source of these loops; they are {known}")
    return [place for place, name in enumerate(names) if ALL_SOURCES in asked or name in asked]


def _is_open(fit: LossFit, covariance: Array, wanted: Sequence[int]) -> bool:
    """True if noise leaves more open of a wanted share than the forms of the sources do."""
    return bool(np.any((fit.sigma_by_noise(covariance) > fit.floors)[wanted]))


def _taken(
    fit: LossFit, equations: Sequence[Array], wanted: Sequence[int], cost: Array, budget: float
) -> tuple[list[int], Array]:
    """Return the places of the loops by their gain for their time, and the covariance of the unknowns after them.

    The gain is that of the logarithm of the sum of the variances of the wanted shares. The last loop is that after which the
    forms of widths leave more of each share open than the noise does.
    """

    def score(after: Array) -> float:
        return float(np.log(np.sum(fit.sigma_by_noise(after)[wanted] ** 2)))

    taken, covariance, left = list[int](), fit.covariance, budget
    while _is_open(fit, covariance, wanted) and (affordable := np.flatnonzero(cost <= left)).size:
        gain = score(covariance) - np.array([score(with_rows(covariance, equations[int(place)])) for place in affordable])
        place = int(affordable[np.argmax(gain / cost[affordable])])
        if place in taken:  # no other loop gains more than this one again
            break
        taken, left = [*taken, place], left - float(cost[place])
        covariance = with_rows(covariance, equations[place])
    return taken, covariance


def _duration(loop: LossLoop, temperature: float) -> float:
    """Return the time of a loop [s], with that until the gear has its temperature."""
    travel = 2.0 * (loop.ends[1] - loop.ends[0])
    cycles = CYCLES_OF_LOOP * travel / loop.speed if loop.is_timed else USUAL_DURATIONS["torsion"]
    return cycles + (WARMING_TIME if loop.temperature > temperature else 0.0)


def _settings(loop: LossLoop) -> dict[str, float | str]:
    held = "output" if loop.ratio else "input"
    settings: dict[str, float | str] = {
        "torque_N_m": 0.5 * float(np.ptp(loop.torque)), "measured_at": "input" if loop.ratio else "output", "held": held,
    }  # fmt: skip
    if loop.is_timed:
        settings["twist_rate_rad_s"] = loop.speed
    if loop.is_warm:
        settings["temperature_K"] = loop.temperature
    return settings


def _expectations(fit: LossFit, shares: LossShares, covariance: Array, wanted: Sequence[int]) -> Iterator[Expectation]:
    """Yield the standard deviation of each share before and after loops with this covariance."""
    measured = {share.name: (share.share, share.sigma) for share in shares.shares}
    by_noise = zip(fit.sigma_by_noise(), fit.sigma_by_noise(covariance), fit.floors, strict=True)
    for place, (name, (first, sigma, floor)) in enumerate(zip(fit.names, by_noise, strict=True)):
        share, before = measured.get(name, (np.nan, np.inf))
        value = share if before <= MAX_SHARE_SIGMA else np.nan  # the loops so far divide a sum in some way
        after = min(float(np.hypot(sigma, floor)), before) if sigma < (1.0 - MIN_GAIN_OF_SHARE) * first else before
        by_forms = floor > MAX_SHARE_SIGMA
        short = "the loops depart from the forms of all sources" if by_forms else "these loops do not separate it in this time"
        why = "" if after <= MAX_SHARE_SIGMA else short
        yield Expectation(name, "1", value, before, after, place in wanted, why)


def _notes(fit: LossFit, shares: LossShares, possible: Sequence[LossLoop]) -> Iterator[str]:
    yield f"shares of the loss of a cycle, {quantity(shares.loss, 'J')}, of the loop of {shares.loop}"
    forms = percent(float(fit.floors.max()))
    yield f"a share is separated below ± {percent(MAX_SHARE_SIGMA)}; widths that depart from their forms leave ± {forms}"
    if any(loop.temperature > fit.widths.reference_temperature for loop in possible):
        yield f"{WARMING_TIME / 60.0:.0f} min assumed until the gear is warmer throughout"
    yield from shares.remarks
