"""Comparison of a measured loop with the figures of a catalogue: K1, K2, K3, hysteresis loss, lost motion."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from math import hypot, inf
from typing import Any

import numpy as np

from strainwave.files.gear_set import GearSet
from strainwave.messages import shortened
from strainwave.presentation import Statement
from strainwave.rig.analysis.cycle import Factors, cycle_to
from strainwave.rig.analysis.lost_motion import lost_motion, separation
from strainwave.rig.analysis.regimes import Branch, Segmented, segment
from strainwave.rig.analysis.result import Result, inverse, result
from strainwave.rig.analysis.stiffness import COMPLIANCE, UNIT, shared
from strainwave.rig.loop import Loop, Side


@dataclass(frozen=True)
class CatalogueCheck(Statement):
    """A figure of the catalogue and the measured one.

    Attributes:
        name: of the figure
        measured: on the loop; None where the loop does not reach
        stated: by the set, at the loaded shaft, in `unit`
        unit: of both
        spread: of units about the figure, relative; None if not known
        why: where the figure comes from, or why it was not measured
    """

    name: str
    measured: Result | None
    stated: float
    unit: str
    spread: float | None
    why: str

    @property
    def within(self) -> bool | None:
        """True if the measured figure lies within the spread and its own error; None if one of them is not known."""
        if self.measured is None or self.spread is None:
            return None
        error = 0.5 * (self.measured.high - self.measured.low)
        return abs(self.measured.value - self.stated) <= hypot(self.spread * self.stated, 0.0 if np.isnan(error) else error)

    def _headline(self) -> str:
        if self.measured is None:
            return f"{self.name}: {self.stated:.4g} {self.unit} in the set; {self.why}"
        share = f"{100.0 * self.measured.value / self.stated:.0f} % of the " if self.stated else "the set has "
        share += f"{self.stated:.4g} {self.unit}{' of the set' if self.stated else ''}"
        verdict = {True: ", within the spread of units", False: ", beyond the spread of units", None: ""}[self.within]
        return f"{self.name}: {self.measured}, {share}{verdict}"


def rated_torque_of(gear_set: GearSet, side: Side) -> float | None:
    """Rated torque of a set at the loaded shaft [N.m]; None where the set states none.

    >>> rated_torque_of(GearSet.read("csg-20-100"), "output"), rated_torque_of(GearSet.read("csg-20-100"), "input")
    (52.0, 0.52)
    """
    if "rated_torque" not in gear_set.ratings:
        return None
    return gear_set.ratings["rated_torque"].to("N.m").value / _factor(gear_set, side)


def check_catalogue(
    cut: Segmented,
    gear_set: GearSet,
    width_at_zero: Result | None,
    lost: Result | None,
    rated_torque: float | None,
    freedom: float = inf,
) -> tuple[tuple[CatalogueCheck, ...], tuple[str, ...]]:
    """Compare a loop with a gear set; the second result lists the figures that cannot be compared, with the reason.

    K1 is the secant of the loading branch from the middle of the loop to T1, K2 the slope from T1 to T2, K3 from T2 to the
    peak, the mean of both senses: what a first loading would show. The width of the set's own loop is that of its model under
    the same torques. While friction F of the wave generator is in the loop, K1 to K3 are not compared: the gear is at T1 where
    the loading branch is at T1 + F, and at the input F is as large as T1.
    """
    if cut.falling is None or cut.rising is None or not cut.closed:
        return (), ("the cycle is not complete: it is not compared with the catalogue",)
    stiffnesses, words = tuple(_stiffnesses(cut, gear_set, freedom)), tuple(_words(cut, gear_set))
    try:
        own = _own_loop(cut, gear_set)
    except ValueError as error:  # its friction holds all of the torque, or it has stages
        return stiffnesses, (*words, f"widths are not compared with those of the set's own loop: {error}")
    return (*stiffnesses, *_widths(own, width_at_zero, lost, rated_torque)), words


def _factor(gear_set: GearSet, side: Side) -> float:
    """Torque of the output over that of the loaded shaft."""
    return abs(float(gear_set.gear.kinematics.ratio)) if side == "input" else 1.0


def published(gear_set: GearSet, side: Side) -> dict[str, float] | None:
    """K1, K2, K3 [N.m/rad] and T1, T2 [N.m] of the whole gear at a shaft; None where its spring has no such knees.

    A set divides them between spring and hysteresis, which is undone here: T = t + F and K1 = k1 T1 / t1, with F the sum of
    the breakaways (docs/reference/catalogue.md).

    >>> {name: round(value, 1) for name, value in published(GearSet.read("csg-20-100"), "output").items()}
    {'K1': 16000.0, 'K2': 25000.0, 'K3': 29000.0, 'T1': 7.0, 'T2': 25.0}
    """
    spring: Any = gear_set.gear.stiffness
    held = getattr(gear_set.gear.hysteresis, "breakaway", None)
    if held is None or not all(hasattr(spring, name) for name in ("k1", "k2", "k3", "t1", "t2")):
        return None
    factor, slipping = _factor(gear_set, side), float(np.sum(held))
    stiffness = {"K1": spring.k1 * (1.0 + slipping / spring.t1), "K2": spring.k2, "K3": spring.k3}
    torque = {"T1": spring.t1 + slipping, "T2": spring.t2 + slipping}
    return {name: k / factor**2 for name, k in stiffness.items()} | {name: t / factor for name, t in torque.items()}


def _stiffnesses(cut: Segmented, gear_set: GearSet, freedom: float) -> Iterator[CatalogueCheck]:
    figures = published(gear_set, cut.loop.side)
    if figures is None or cut.falling is None or cut.rising is None:
        return
    peak = min(-cut.falling.low, cut.rising.high)
    ends = {"K1": (0.0, figures["T1"]), "K2": (figures["T1"], figures["T2"]), "K3": (figures["T2"], peak)}
    for name, (low, high) in ends.items():
        entry = gear_set.sources.get(f"gear.stiffness.{name.lower()}")
        reached = low < high <= peak
        comparable = reached and not cut.loop.input_friction
        measured = _loading(cut.falling, cut.rising, low, high, cut.loop, freedom) if comparable else None
        why = entry.source if entry is not None else ""
        if reached and not comparable:
            why = "friction of the wave generator is in the loop and shifts its torques; take it out by a table (--friction)"
        elif not reached:
            over = f"{low:.3g} N.m and beyond" if name == "K3" else f"{low:.3g} to {high:.3g} N.m"
            why = f"the loop ends at {peak:.3g} N.m, the figure is for {over}"
        yield CatalogueCheck(name, measured, figures[name], UNIT, None if entry is None else entry.spread, why)


def _loading(falling: Branch, rising: Branch, low: float, high: float, loop: Loop, freedom: float) -> Result | None:
    """Slope of the loading branches between two sizes of torque; from zero on, of the middle of the loop.

    What pulleys hold more than is thought shifts the torques of the two branches apart, which counts most from zero on.
    """

    def compliance_of(held: float) -> float:
        turned = _angle(rising, high + held) - _angle(falling, -high - held)
        if low > 0.0:  # else the middle of the loop is taken from both, and goes out
            turned -= _angle(rising, low + held) - _angle(falling, -low - held)
        return 0.5 * turned / (high - low)

    compliance = compliance_of(0.0)
    if compliance <= 0.0:
        return None
    of_angle = float(np.median(loop.angle_sigma)) / (high - low)  # four readings, halved
    of_torque = compliance * float(np.median(loop.torque_sigma)) / (high - low)  # each turned into angle by the slope
    error = hypot(of_angle, of_torque)
    of_pulleys = max(abs(compliance_of(sign * loop.friction_sigma) - compliance) for sign in (-1.0, 1.0))
    of_rig = hypot(shared(1.0 / compliance, loop) * compliance**2, of_pulleys)
    return inverse(result(compliance, COMPLIANCE, random=error, shared=of_rig, freedom=freedom), UNIT)


def _angle(branch: Branch, torque: float) -> float:
    return float(np.interp(torque, branch.torque, branch.angle))


def _own_loop(cut: Segmented, gear_set: GearSet) -> Segmented:
    """Return the loop of the set's model under the same peaks."""
    assert cut.falling is not None
    assert cut.rising is not None
    loop, peak = cut.loop, 0.5 * (cut.rising.high - cut.falling.low)
    if loop.side == "output" and loop.input_friction:
        raise ValueError("the loop was referred to the output with the friction of the wave generator in it")
    model = cycle_to(gear_set.gear, peak, side=loop.side, factors=Factors(friction=1.0 if loop.input_friction else 0.0))
    return segment(Loop(model.angle, model.torque, side=loop.side, name=gear_set.name))


def _widths(own: Segmented, at_zero: Result | None, lost: Result | None, rated: float | None) -> Iterator[CatalogueCheck]:
    """Compare widths with those of the set's own loop."""
    if own.falling is None or own.rising is None:
        return
    stated = separation(own.falling, own.rising, 0.0, own.loop)
    if at_zero is not None and stated is not None:
        why = f"model of the set after ±{float(own.loop.torque.max()):.3g} N.m"
        yield CatalogueCheck("width at zero torque", at_zero, stated.value, "rad", None, why)
    stated = None if rated is None else lost_motion(own.falling, own.rising, rated, own.loop)
    if lost is not None and stated is not None:
        why = "model of the set, mean width at ±4 % of rated torque"
        yield CatalogueCheck("lost motion", lost, stated.value, "rad", None, why)


def _words(cut: Segmented, gear_set: GearSet) -> Iterator[str]:
    if cut.loop.side == "input":
        yield ("the catalogue states the gear at the output, and its figures are divided by the ratio and its square")
    if published(gear_set, cut.loop.side) is None:
        yield f"{shortened(gear_set.name)} has no K1, K2 and K3 to compare with"
