"""A plan of the next torsion loops: those that separate the sources of loss which the loops measured so far do not."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np
from numpy.typing import NDArray

from strainwave import arguments
from strainwave._core import Gear
from strainwave.files.recording import Recording
from strainwave.identification.candidates.torsion.losses import MAX_SHARE_SIGMA, FurtherLoops, further_loops
from strainwave.identification.excitation.candidates import score
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
    further = further_loops(loops, gear)
    names = [*further.sources]
    asked = [*arguments.names("wanted", wanted)]
    for name in asked:
        if name not in (ALL_SOURCES, *names):
            known = listed(map(quoted, (*names, ALL_SOURCES)))
            raise ValueError(f"wanted: {quoted(name)} is no source of these loops; they are {known}")
    chosen = names if ALL_SOURCES in asked else [name for name in names if name in asked]
    places = [names.index(name) for name in chosen]
    cost = np.array([_duration(loop, further.temperature) for loop in further.loops])
    budget = arguments.seconds("time", time)
    taken, covariance = _taken(further, places, cost, budget)
    steps = tuple(
        PlannedMeasurement("torsion", further.loops[place].words, _settings(further.loops[place]), 1, float(cost[place]))
        for place in taken
    )
    expectations = tuple(_expectations(further, covariance, chosen))
    is_open = _is_open(further, further.covariance, places)
    reason = too_short(budget, cost) if is_open else {"reason": NO_LOOP_NEEDED}
    return ExperimentPlan(steps, expectations, tuple(_notes(further)), **reason)


def _is_open(further: FurtherLoops, covariance: Array, wanted: Sequence[int]) -> bool:
    """True if noise leaves more open of a wanted share than the forms of the sources do."""
    return bool(np.any(np.sqrt(np.diag(covariance)[wanted]) > further.floors[wanted]))


def _taken(further: FurtherLoops, wanted: Sequence[int], cost: Array, budget: float) -> tuple[list[int], Array]:
    """Return the places of the loops by their gain for their time, and the covariance of the unknowns after them.

    The last one is that after which the forms of widths leave more of each share open than the noise does.
    """
    information = np.asarray(np.linalg.inv(further.covariance), float)
    taken, covariance, left = list[int](), further.covariance, budget
    while _is_open(further, covariance, wanted):
        affordable = np.flatnonzero(cost <= left)
        if not affordable.size:
            break
        gain = score(information, wanted, "A") - score(information + further.information[affordable], wanted, "A")
        place = int(affordable[np.argmax(gain / cost[affordable])])
        if place in taken:  # no other loop gains more than this one again
            break
        taken, left = [*taken, place], left - float(cost[place])
        information = information + further.information[place]
        covariance = np.asarray(np.linalg.inv(information), float)
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


def _expectations(further: FurtherLoops, covariance: Array, wanted: Sequence[str]) -> Iterator[Expectation]:
    """Yield the standard deviation of each share before and after loops with this covariance."""
    measured = {share.name: (share.share, share.sigma) for share in further.shares.shares}
    for place, name in enumerate(further.sources):
        value, before = measured.get(name, (np.nan, np.inf))
        value = value if before <= MAX_SHARE_SIGMA else np.nan  # the loops so far divide a sum in some way
        sigma, after = float(np.sqrt(covariance[place, place])), before
        if sigma < (1.0 - MIN_GAIN_OF_SHARE) * np.sqrt(further.covariance[place, place]):
            after = min(float(np.hypot(sigma, further.floors[place])), before)
        by_forms = further.floors[place] > MAX_SHARE_SIGMA
        short = "the loops depart from the forms of all sources" if by_forms else "these loops do not separate it in this time"
        why = "" if after <= MAX_SHARE_SIGMA else short
        yield Expectation(name, "1", value, before, after, name in wanted, why)


def _notes(further: FurtherLoops) -> Iterator[str]:
    yield f"shares of the loss of a cycle, {quantity(further.shares.loss, 'J')}, of the loop of {further.shares.loop}"
    forms = percent(float(further.floors.max()))
    yield f"a share is separated below ± {percent(MAX_SHARE_SIGMA)}; widths that depart from their forms leave ± {forms}"
    if any(loop.temperature > further.temperature for loop in further.loops):
        yield f"{WARMING_TIME / 60.0:.0f} min assumed until the gear is warmer throughout"
    yield from further.shares.remarks
