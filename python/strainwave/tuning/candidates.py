"""Compensations that a drive may have: each effect of its gear alone, all of them, and what learns."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import combinations
from typing import Any

from strainwave import Compensation, Drive, Gear, compensation
from strainwave.tuning.cascade import Plant, bare, model_of, observer_of, tuned_law

EFFECTS = {
    "friction": ("friction_input", "friction_mesh", "friction_output"),
    "torsion": ("stiffness", "hysteresis", "softening"),
    "kinematic error": ("kinematic_error",),
}  # parts of a gear, by the effect that they have on its motion
MAX_ORDERS = 4  # that an AdaptiveFourier holds
MAX_SHARE_OF_LIMIT = 0.9  # of the frequency at which the position loop lags by 90 degrees, up to which waves are learnt


@dataclass(frozen=True)
class Candidate:
    """A controller with a compensation.

    Attributes:
        name: what it takes away
        effects: the effects of the gear that its model has
        law: that is sampled
        drive: under this controller
        parts: number of effects and of what observes or learns
        is_plain: True if it has a model and a disturbance observer, and position by the input encoder
    """

    name: str
    effects: tuple[str, ...]
    law: Any
    drive: Drive
    parts: int = 0
    is_plain: bool = False


def baseline(plant: Plant, sharpness: float, feedback: str) -> Candidate:
    """Return the tuned cascade with feed-forward of inertia, weight and Coulomb and viscous friction, and an observer."""
    law = tuned_law(plant, sharpness, feedback=feedback)
    added = _compensation(plant, bare(plant.drive.gear), sharpness)
    return Candidate("cascade with feed-forward and disturbance observer", (), law, plant.controlled(law, added))


def candidates(plant: Plant, sharpness: float, *, has_output_encoder: bool) -> Iterator[Candidate]:
    """Yield the cascade with models of each choice of effects that the gear has, and with what observes or learns."""
    present = [effect for effect in EFFECTS if _has(plant.drive.gear, effect)]
    choices = [each for count in range(1, len(present) + 1) for each in combinations(present, count)]
    for effects in choices:
        yield _with_model(plant, sharpness, effects)
        if "friction" in effects:
            yield _with_model(plant, sharpness, effects, scaling=True)
    if not has_output_encoder:
        return
    for effects in choices:
        yield _with_model(plant, sharpness, effects, feedback="output")
    orders = [float(order) for order in getattr(plant.drive.gear.kinematic_error, "order", ())]
    for effects in [(), *choices]:
        if orders and "kinematic error" not in effects:
            yield _with_model(plant, sharpness, effects, orders=orders[:MAX_ORDERS])


def _with_model(
    plant: Plant,
    sharpness: float,
    effects: tuple[str, ...],
    *,
    feedback: str = "input",
    scaling: bool = False,
    orders: list[float] | None = None,
) -> Candidate:
    law = tuned_law(plant, sharpness, feedback=feedback, friction="friction" not in effects)
    gear = with_effects(plant.drive.gear, effects)
    added = _compensation(plant, gear, sharpness)
    name = f"model of {_and(effects)}" if effects else "no model"
    if feedback == "output":
        name += ", position by the output encoder"
    if scaling:
        added = added.replace(
            observer=compensation.FrictionScale(gain=_scale_gain(plant, law), position_gain=law.position_gain)
        )
        name += ", scale of friction observed in place of the disturbance"
    if orders:
        lag = 1.0 / law.position_gain
        learner = compensation.AdaptiveFourier(
            order=orders, gain=0.2 * law.position_gain, lag=0.0, fastest=MAX_SHARE_OF_LIMIT / lag, limit=2e-3
        )
        added = added.replace(learning=learner)
        name += f", orders {_and([f'{order:g}' for order in orders])} learnt"
    is_plain = feedback == "input" and not scaling and not orders
    return Candidate(name, effects, law, plant.controlled(law, added), len(effects) + scaling + bool(orders), is_plain)


def _compensation(plant: Plant, gear: Gear, sharpness: float) -> Compensation:
    return Compensation(
        feedforward=model_of(plant, gear),
        observer=observer_of(plant, sharpness),
        actuation_per_torque=plant.actuation_per_torque,
    )


def _scale_gain(plant: Plant, law: Any) -> float:
    """Return the gain at which the scale follows in about a second of motion at full friction."""
    friction = max(law.limit / plant.actuation_per_torque / 20.0, 1e-3)
    error = friction / (law.speed_proportional / plant.actuation_per_torque)
    return float(1.0 / (friction * error))


def with_effects(gear: Gear, effects: tuple[str, ...]) -> Gear:
    """Return a gear of which only some effects are known."""
    parts = {part: getattr(gear, part) for effect in effects for part in EFFECTS[effect]}
    return bare(gear).replace(**parts)


def _has(gear: Gear, effect: str) -> bool:
    """True if a gear has an effect at all."""
    plain = bare(gear)
    return any(getattr(gear, part) != getattr(plain, part) for part in EFFECTS[effect])


def _and(names: tuple[str, ...] | list[str]) -> str:
    *first, last = names
    return f"{', '.join(first)} and {last}" if first else last
