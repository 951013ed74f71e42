"""Friction tables: the law at the input from torques at constant speeds."""

from __future__ import annotations

import warnings
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any, get_args

import numpy as np
from numpy.typing import NDArray

from strainwave import friction
from strainwave._core import Gear, PassivityWarning
from strainwave.equality import ComparedByFields
from strainwave.identification.experiments.friction_table import FrictionTable
from strainwave.identification.fitting.fit import Fit, fit

Array = NDArray[np.float64]

FOLDS = 20  # a table is cut into at most so many parts, each predicted once from the others
KINETIC = ("coulomb", "viscous")
FALLING = ("coulomb", "breakaway", "stribeck_speed", "viscous")

Law = friction.Viscous | friction.Coulomb | friction.Stribeck | friction.LuGre  # what a table of torque over speed can tell


@dataclass(frozen=True, eq=False)
class FrictionCandidate(ComparedByFields):
    """One set of free parameters fitted to a friction table.

    Attributes:
        name: what it describes
        fit: the fit to the whole table
        held_out: torque at each speed as predicted without the measurements near it [N.m], shape (n,)
        error: rms of measured less `held_out` [N.m]
    """

    name: str
    fit: Fit
    held_out: Array
    error: float

    @property
    def coulomb(self) -> float:
        """Coulomb torque found [N.m]."""
        return self.fit.estimates[0].value

    @property
    def viscous(self) -> float:
        """Viscous friction found [N.m.s/rad]."""
        return self.fit.estimates[-1].value


def fit_friction(table: FrictionTable, gear: Gear) -> list[FrictionCandidate]:
    """Fits the input friction of a gear to a table, with and without a fall of torque at low speed.

    The law of `gear.friction_input` is kept; a purely viscous one becomes Coulomb's, and Coulomb's becomes Stribeck's if the
    table shows a fall from breakaway. A table that shows none gives a law without one; of Coulomb's law, whose steady torque
    does not depend on breakaway, the ratio of breakaway to Coulomb torque is kept. Bristles are damped so little that they
    dissipate.

    Args:
        table: measured torque over speed
        gear: the gear to start from

    Returns:
        candidates, best first by the error of predictions from the rest of the table; the simpler one unless the other is
        better by more than 5 %

    Raises:
        ValueError: fewer than four speeds, or a law of the gear that depends on more than speed
    """
    if not isinstance(gear.friction_input, Law):
        names = [law.name for law in get_args(Law)]
        raise ValueError(
            f"a friction table cannot be fitted to {gear.friction_input.name} friction; "
            f"it can to {', '.join(names[:-1])} or {names[-1]}, so start from a gear with one of these at the input"
        )
    speeds = len(np.unique(table.speed))
    if speeds < 4:
        raise ValueError(f"a friction table needs at least 4 speeds, one of them to validate; this one has {speeds}")
    candidates = [_straight(table, gear, gear.friction_input)]
    straight = candidates[0].fit.gear.friction_input
    if speeds > len(FALLING) + 1:
        falling = _falling(table, gear, straight)
        estimates = {estimate.path.rpartition(".")[2]: estimate.value for estimate in falling.fit.estimates}
        if estimates["breakaway"] > estimates["coulomb"]:  # else the torque rises from rest on, and a line says as much
            candidates.append(falling)
    best = min(candidate.error for candidate in candidates)
    return sorted(candidates, key=lambda c: (c.error > 1.05 * best, len(c.fit.estimates)))


def dissipating(law: Any) -> Any:
    """The law, with bristles damped half as much as dissipates in every motion, where they were damped more than that."""
    if not isinstance(law, friction.LuGre) or law.breakaway <= law.coulomb or law.damping_fading > 0.0:
        return law
    most = law.viscous * law.coulomb / (law.breakaway - law.coulomb)
    return law if law.bristle_damping <= most else law.replace(bristle_damping=0.5 * most)


def _straight(table: FrictionTable, gear: Gear, known: Law) -> FrictionCandidate:
    """Coulomb and viscous friction, written into the law of the gear."""
    line = np.polynomial.polynomial.polyfit(np.abs(table.speed), np.abs(table.torque), 1)
    coulomb, viscous = max(float(line[0]), 1e-3 * float(np.abs(table.torque).max())), max(float(line[1]), 0.0)
    start = gear.replace(friction_input=friction.Coulomb(coulomb=coulomb, breakaway=coulomb, viscous=viscous))
    candidate = _candidate("Coulomb and viscous", table, start, KINETIC)
    law = friction.Coulomb(coulomb=coulomb, breakaway=coulomb) if isinstance(known, friction.Viscous) else known
    ratio = law.breakaway / law.coulomb if isinstance(law, friction.Coulomb) and law.coulomb > 0.0 else 1.0
    found = {"coulomb": candidate.coulomb, "breakaway": ratio * candidate.coulomb, "viscous": candidate.viscous}
    with warnings.catch_warnings(action="ignore", category=PassivityWarning):
        written = dissipating(law.replace(**found))
    return replace(candidate, fit=replace(candidate.fit, model=gear.replace(friction_input=written)))


def _falling(table: FrictionTable, gear: Gear, straight: Any) -> FrictionCandidate:
    """Stribeck's fall, in the law of the gear or, where that has none, in Stribeck's."""
    speed = np.abs(table.speed[table.speed != 0.0])
    middle = float(np.sqrt(speed.min() * speed.max()))
    falling = {"breakaway": 1.5 * straight.coulomb, "stribeck_speed": middle}
    with warnings.catch_warnings(action="ignore", category=PassivityWarning):  # what is tried on the way need not be passive
        if isinstance(straight, friction.Coulomb):
            law = friction.Stribeck(coulomb=straight.coulomb, viscous=straight.viscous, **falling)
        else:
            law = straight.replace(**falling)
        candidate = _candidate("with a fall at low speed", table, gear.replace(friction_input=law), FALLING)
        found = candidate.fit.gear.replace(friction_input=dissipating(candidate.fit.gear.friction_input))
    return replace(candidate, fit=replace(candidate.fit, model=found))


def _candidate(name: str, table: FrictionTable, start: Gear, free: Sequence[str]) -> FrictionCandidate:
    paths = [f"friction_input.{parameter}" for parameter in free]
    fold = np.argsort(np.argsort(table.speed, kind="stable")) % min(FOLDS, len(table.speed))
    held_out = np.empty(len(table.speed))
    for part in np.unique(fold):
        left_out = fold == part
        held_out[left_out] = fit(start, table, paths, training=~left_out).predicted[0, left_out]
    return FrictionCandidate(name, fit(start, table, paths), held_out, float(np.sqrt(np.mean((table.torque - held_out) ** 2))))
