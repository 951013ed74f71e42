"""What is known of each parameter of a twin, and why."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np

from strainwave import _core
from strainwave._core import Gear
from strainwave.equality import ComparedByFields
from strainwave.files.entries import Entry
from strainwave.files.gear_set import GearSet
from strainwave.identification.evidence.evidence import Evidence
from strainwave.identification.fitting.estimate import Estimate

UNTOLD = 0.5  # relative standard deviation above which a parameter counts as not identified
LEANING = 0.25  # of the value: by more than this it must not move with what is not known of a kept parameter
SWAYED = 0.05  # of the value: by more it must not move with a kept parameter that the measurement speaks against
TOLD = 0.02  # of the value: smaller influence of a kept parameter is not worth a word
MOST_TOLD = 3  # kept parameters named with an estimate
ENTANGLED = 0.98  # correlation above which two parameters are told in combination only

State = Literal["identified", "identified in combination", "not identified", "kept"]


@dataclass(frozen=True, eq=False)
class Verdict(ComparedByFields):
    """What is known of one parameter of the twin, and why.

    Attributes:
        path: where it stands, as "gear.stiffness.k1"
        unit: its unit
        start: value in the initial model; not-a-number where the set had none
        value: value in the twin
        sigma: standard deviation, with that of what other measurements of this twin told, the parameters kept taken as right
            but for those that it is told in combination with; not-a-number for one that was kept
        state: identified; identified in combination with another (each may be off, together they are not); not identified,
            though fitted; or kept from the initial model
        why: the reason, or the source
    """

    path: str
    unit: str
    start: float
    value: float
    sigma: float
    state: State
    why: str


def verdicts(start: GearSet, gear: Gear, evidence: Sequence[Evidence]) -> list[Verdict]:
    """One for every number of the gear."""
    before, estimates = numbers(start.gear), estimated(evidence)
    sources = known(start, evidence)
    found = []
    for path, (value, unit) in numbers(gear).items():
        # the elements of a fitted sequence are new ones: their places say nothing of the old
        same = path in before and not ("[" in path and path in estimates)
        earlier = before[path][0] if same else np.nan
        if path in estimates:
            e, index, _ = estimates[path]
            state, why = judged(e, index, sources)
            found.append(Verdict(path, unit, earlier, value, spread(e, index, sources, estimates), state, why))
        else:
            entry = start.sources.get(path)
            why = "no measurement given tells it" + (f"; {entry.source}" if entry is not None else "")
            if path not in before:
                why = "set by the method of the fit beside it"
            elif value != earlier:
                why = "follows from the parameters fitted beside it; no measurement given tells it"
            found.append(Verdict(path, unit, earlier, value, np.nan, "kept", why))
    return found


def numbers(gear: Gear) -> dict[str, tuple[float, str]]:
    """Value and unit of each number of a gear, by its path in a set."""
    return {f"gear.{path}": (value, unit) for path, value, unit, *_ in _core.parameters(gear)}


def estimated(evidence: Sequence[Evidence]) -> dict[str, tuple[Evidence, int, Estimate]]:
    """The free parameters of all fits, the latest of each."""
    return {
        e.path(estimate): (e, i, estimate)
        for e in evidence
        for i, estimate in enumerate(e.fit.estimates[: len(e.fit.estimates) - len(e.fit.experiment.nuisances)])
    }


def known(start: GearSet, evidence: Sequence[Evidence]) -> dict[str, Entry]:
    """What is known of each number: by the measurements of this twin, else by the initial model."""
    told = {
        path: Entry(source=e.source, uncertainty=estimate.sigma)
        for path, (e, _, estimate) in estimated(evidence).items()
        if np.isfinite(estimate.sigma)
    }
    for path, (e, _, estimate) in estimated(evidence).items():
        law, _, name = path.rpartition(".")
        if name == "coulomb" and f"{law}.breakaway" not in told and np.isfinite(estimate.sigma):  # which follows it
            told[f"{law}.breakaway"] = Entry(source=e.source, uncertainty=estimate.sigma)
    return {**start.sources, **told}


def spread(
    evidence: Evidence, index: int, sources: Mapping[str, Entry], told: Mapping[str, tuple[Evidence, int, Estimate]]
) -> float:
    """Standard deviation of an estimate: its own, and what comes from other measurements, or from what it is told with."""
    estimate = evidence.fit.estimates[index]
    shared = evidence.path(estimate) in evidence.shared
    doubts = evidence.influence.doubt(index, sources, evidence.prefix)
    others = [doubt for path, doubt in doubts.items() if shared or _is_told(evidence.prefix + path, told)]
    return float(np.linalg.norm([estimate.sigma, *others]))


def _is_told(path: str, told: Collection[str]) -> bool:
    """Whether a measurement of the twin tells a number; of breakaway also one that tells Coulomb's torque, which it follows."""
    return path in told or (path.endswith(".breakaway") and path.replace(".breakaway", ".coulomb") in told)


def judged(evidence: Evidence, index: int, sources: Mapping[str, Entry]) -> tuple[State, str]:
    """Whether the data tell a parameter, and why not, or from what."""
    estimate = evidence.fit.estimates[index]
    if why := _untold(evidence, index, estimate):
        return "not identified", why
    if why := evidence.shared.get(evidence.path(estimate), ""):
        return "identified in combination", why
    if why := _suspect(evidence, index, estimate, sources) or _leaning(evidence, index, estimate, sources, LEANING):
        return "not identified", why
    if why := _combination(evidence, index):
        return "identified in combination", why
    leaning = _leaning(evidence, index, estimate, sources, TOLD)
    return "identified", f"{evidence.source}; {leaning}" if leaning else evidence.source


def _untold(evidence: Evidence, index: int, estimate: Estimate) -> str:
    """Why the data do not tell a parameter; empty where they do."""
    if evidence.unexplained:
        return f"the model does not explain {evidence.source}"
    if not np.isfinite(estimate.sigma):
        return f"{evidence.source} stays the same when it changes"
    if estimate.at_limit:
        return f"ended at the limit of what it may be; {evidence.source} pulls it beyond"
    if ".phase[" in estimate.path:
        if estimate.sigma > UNTOLD:
            return f"standard deviation is {estimate.sigma:.2g} rad"
    elif estimate.sigma > UNTOLD * abs(estimate.value):
        together = _combination(evidence, index)
        return "standard deviation exceeds half the value" + (f"; {together}" if together else "")
    return ""


def _leaning(evidence: Evidence, index: int, estimate: Estimate, sources: Mapping[str, Entry], least: float) -> str:
    """The kept parameters that move an estimate by more than a share of it, as well as they are known; empty if none does."""
    size = 1.0 if ".phase[" in estimate.path else abs(estimate.value)
    doubts = evidence.influence.doubt(index, sources, evidence.prefix)
    told = [f"{path} by {100.0 * doubt / size:.2g} %" for path, doubt in doubts.items() if doubt > least * size]
    return f"what is not known of parameters kept may move it: {', '.join(told[:MOST_TOLD])}" if told else ""


def _suspect(evidence: Evidence, index: int, estimate: Estimate, sources: Mapping[str, Entry]) -> str:
    """The kept parameter that the measurement speaks against, if the estimate would move far were it right."""
    influence, size = evidence.influence, 1.0 if ".phase[" in estimate.path else abs(estimate.value)
    moved = {
        influence.kept[place].path: influence.slopes[index, place] * influence.pulls[place] / size
        for place in influence.suspects(sources, evidence.prefix)
    }
    path = max(moved, key=lambda path: abs(moved[path]), default="")
    if not path or abs(moved[path]) < SWAYED:
        return ""
    return f"it would move by {100.0 * moved[path]:+.2g} % were {path} what {evidence.source} pulls it to"


def _combination(evidence: Evidence, index: int) -> str:
    """With which other unknown the data tell a parameter only together, and what they do tell of the two."""
    fit = evidence.fit
    correlation, free = np.abs(fit.correlation[index]), len(fit.plan.unknowns)
    correlation[index] = 0.0
    correlation[free : free + len(fit.plan.tied)] = 0.0  # what follows another one is known as well
    if free <= index < free + len(fit.plan.tied):
        correlation[fit.plan.tied[index - free].unknown] = 0.0
    if not np.isfinite(correlation).any():
        return ""
    partner = int(np.nanargmax(correlation))
    if not correlation[partner] > ENTANGLED:
        return ""
    own, other = fit.estimates[index], fit.estimates[partner]
    weight = -fit.covariance[index, partner] / fit.covariance[partner, partner]
    sigma = own.sigma * np.sqrt(max(1.0 - correlation[partner] ** 2, 0.0))
    name, other_name = (each.path.rpartition(".")[2] for each in (own, other))
    sign, total = "+" if weight > 0.0 else "-", own.value + weight * other.value
    return (
        f"told together with {other.path}: {name} {sign} {abs(weight):.3g} {other_name} = {total:.5g} ± {sigma:.2g} {own.unit} "
        f"(correlation {fit.correlation[index, partner]:+.3f})"
    )
