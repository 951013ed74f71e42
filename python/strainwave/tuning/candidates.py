"""Compensations that a drive may have: each effect of its gear alone, all of them, and what learns."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import combinations
from typing import Any

import numpy as np
from numpy.typing import NDArray

from strainwave import Compensation, Drive, Gear, _core, compensation, stiffness
from strainwave.presentation import Presented
from strainwave.simulation.excitation import ROOM_TEMPERATURE
from strainwave.tuning.cascade import (
    RIGID_STIFFNESS,
    Plant,
    Setting,
    bare,
    line_of_friction,
    model_of,
    observer_of,
    speed_bandwidth,
    steady_torque,
    tuned_law,
)
from strainwave.tuning.goals import Goal
from strainwave.tuning.loops import Loops, sampled_cascade

Array = NDArray[np.float64]

GEAR_EFFECTS = {
    "friction": ("friction_input", "friction_mesh", "friction_output"),
    "torsion": ("stiffness", "hysteresis", "softening"),
    "kinematic error": ("kinematic_error",),
}  # parts of a gear, by the effect that they have on its motion
MAX_ORDERS = 4  # that an AdaptiveFourier holds
LEARNING_SHARE = 0.2  # rate of learning over the gain of the position loop
MAX_WAVE_SHARE = 0.9  # frequency of a wave that is learnt over the gain of the position loop, which lags by 45 degrees at 1
MAX_AMPLITUDE = 2e-3  # rad at the output, that is learnt
MIN_LEARNING_SPEED = 1.0  # rad/s of the input, below which nothing is learnt
MAX_TABLE_ORDER = 8  # that a Repetitive learns whole
TABLE_CELLS = 32  # of a Repetitive
MAX_SHARE_OF_PASS = 0.3  # of an error, that a cell learns while the input passes it
MAP_POINTS = 5  # of a map of lost motion
MAP_REACH_SHARES, MAP_REACHES = (1e-3, 1.0), 13  # over the travel, of which the best is taken
SCALE_TIME = 1.0  # s, in which the scale of friction follows
BRISTLE_SHARE = 0.9  # of the friction of the law, so that a gear with less is not over-compensated
BRISTLE_GAIN = 2.0  # of the error, that bends the bristles of a shaft at rest; larger ones swing with lags of the loop
USUAL_SPEED = 20.0  # rad/s of the input
MIN_FRICTION = 1e-6  # N.m
RANGE_OF_SPEED = (0.1, 100.0)  # rad/s of the input, over which friction is compared with a line
MAX_OFF_LINE = 0.01  # of the line
ANGLES_PER_TURN = 720  # of the input, at which the slope of an error is taken


@dataclass(frozen=True)
class ControllerCandidate(Presented):
    """A controller with a compensation.

    Attributes:
        name: what it compensates
        effects: the effects of the gear that its model has
        setting: of its cascade
        drive: under this controller
        parts: number of effects and of what observes or learns
        is_plain: True if it has a model alone, besides the cascade
    """

    name: str
    effects: tuple[str, ...]
    setting: Setting
    drive: Drive
    parts: int = 0
    is_plain: bool = False


def baseline(plant: Plant, setting: Setting) -> ControllerCandidate:
    """Return the cascade with feed-forward of inertia, weight, Coulomb and viscous friction, and the observer of a setting."""
    observed = " and disturbance observer" if setting.observer_share else ""
    encoder = ", position by the output encoder" if setting.feedback == "output" else ""
    added = _compensation(plant, (), setting)
    drive = plant.controlled(tuned_law(plant, setting), added)
    return ControllerCandidate(f"cascade with feed-forward{observed}{encoder}", (), setting, drive)


def candidates(
    plant: Plant, settings: Sequence[Setting], goal: Goal, draws: Mapping[str, Array]
) -> Iterator[ControllerCandidate]:
    """Yield the cascade of each setting with models of each choice of effects, and with what observes or learns.

    Waves over the input are learnt where the controller follows the input encoder and sees the output, so only if there are
    settings of both encoders. A map of lost motion is for a motion that turns back.
    For a motion that creeps, friction is also supplied by the measured motion.
    """
    gear = plant.drive.gear
    present = [effect for effect in GEAR_EFFECTS if has_effect(gear, effect) and not too_steep(plant, effect)]
    if is_line(plant.drive):  # which the cascade feeds forward, too
        present.remove("friction")
    choices = [each for count in range(1, len(present) + 1) for each in combinations(present, count)]
    orders = [float(order) for order in getattr(gear.kinematic_error, "order", ())][:MAX_ORDERS]
    sees_output = any(setting.feedback == "output" for setting in settings)
    for setting in settings:
        for effects in choices:
            yield _with_model(plant, setting, effects)
            if "friction" in effects:
                yield _with_scale(plant, setting, effects)
        if "torsion" in present and goal.pace and setting.feedback == "input":
            yield _with_map(plant, setting, goal)
        if goal.name == "smooth" and gear.friction_input != Gear().friction_input:
            yield from (_with_bristles(plant, setting, effects) for effects in [(), *choices] if "friction" not in effects)
        if sees_output and setting.feedback == "input" and orders:
            learners = list(_learners(plant, setting, orders, goal, draws))
            for effects in [(), *choices]:
                if "kinematic error" in effects:
                    continue
                for name, learner in learners:  # over the input
                    added = _compensation(plant, effects, setting).replace(learning=learner)
                    drive, name = (
                        plant.controlled(tuned_law(plant, setting), added),
                        f"{_name(effects, setting)}, {name} learnt",
                    )
                    yield ControllerCandidate(name, effects, setting, drive, len(effects) + 1)


def _with_model(plant: Plant, setting: Setting, effects: tuple[str, ...]) -> ControllerCandidate:
    added = _compensation(plant, effects, setting)
    drive = plant.controlled(tuned_law(plant, setting), added)
    return ControllerCandidate(_name(effects, setting), effects, setting, drive, len(effects), is_plain=True)


def _with_scale(plant: Plant, setting: Setting, effects: tuple[str, ...]) -> ControllerCandidate:
    """Return the same with an observer of the scale of friction in place of the integral and of one of the disturbance.

    An integral would supply the missing friction itself, and leave no error by which the scale moves. The scale follows in
    `SCALE_TIME` of motion at the usual speed.
    """
    law = tuned_law(plant, setting).replace(speed_integral=0.0)
    coulomb, viscous = line_of_friction(plant.drive.gear, plant.start_temperature)
    torque = max(coulomb + viscous * USUAL_SPEED, MIN_FRICTION)
    gain = speed_bandwidth(plant, setting) * plant.total_inertia / (torque**2 * SCALE_TIME)
    scale = compensation.FrictionScale(gain=gain, position_gain=law.position_gain)
    added = _compensation(plant, effects, setting).replace(observer=scale)
    name = f"{_name(effects, setting)}, scale of friction observed"
    return ControllerCandidate(name, effects, setting, plant.controlled(law, added), len(effects) + 1)


def _with_bristles(plant: Plant, setting: Setting, effects: tuple[str, ...]) -> ControllerCandidate:
    """Return the same with the friction at the input by the measured motion, in place of that of the model."""
    law, gear = tuned_law(plant, setting), plant.drive.gear
    bristles = compensation.BristleObserver(
        friction=gear.friction_input,
        friction_share=BRISTLE_SHARE,
        bristle_gain=BRISTLE_GAIN,
        position_gain=law.position_gain,
        temperature=plant.start_temperature,
    )
    added = _compensation(plant, effects, setting).replace(observer=bristles)
    name = f"{_name(effects, setting)}, friction by the measured motion"
    return ControllerCandidate(name, ("friction", *effects), setting, plant.controlled(law, added), len(effects) + 1)


def _with_map(plant: Plant, setting: Setting, goal: Goal) -> ControllerCandidate:
    """Return the cascade with a map of lost motion, and friction that the law feeds forward if no observer supplies it."""
    law, per_torque = tuned_law(plant, setting), plant.actuation_per_torque
    if not setting.observer_share:
        coulomb, viscous = (per_torque * each for each in line_of_friction(plant.drive.gear, plant.start_temperature))
        law = law.replace(coulomb_feedforward=coulomb, viscous_feedforward=viscous)
    added = Compensation(
        feedforward=lost_motion_map(plant, goal), observer=observer_of(plant, setting), actuation_per_torque=per_torque
    )
    return ControllerCandidate("map of lost motion", ("torsion",), setting, plant.controlled(law, added), 1)


def lost_motion_map(plant: Plant, goal: Goal) -> compensation.LostMotionMap:
    """Return the lead that torsion and friction of the output ask for along a motion to and fro, as a table over the angle.

    `reach` is that of the least squares of what the table leaves of the lead.
    """
    gear = with_effects(plant.drive.gear, ("torsion",), plant.start_temperature).replace(
        friction_output=plant.drive.gear.friction_output
    )
    model, count = model_of(plant, gear), round(2.0 * np.pi / goal.pace / plant.period)
    time = plant.period * np.arange(2 * count)
    angle, rate = goal.command.value(time), goal.command.rate(time)
    lead = model.requests(angle, rate, ratio=plant.ratio, period=plant.period)[0] / plant.ratio
    rising = rate > 0.0
    points = np.linspace(angle.min(), angle.max(), 2 * MAP_POINTS + 1)[1::2]  # away from the ends, where it turns back
    last = np.arange(2 * count) >= count
    leads = []
    for rows in (last & rising, last & ~rising):
        order = np.argsort(angle[rows])
        leads.append(np.interp(points, angle[rows][order], lead[rows][order]))
    forward, backward = leads
    reach = min(
        np.ptp(angle) * np.geomspace(*MAP_REACH_SHARES, MAP_REACHES),
        key=lambda each: np.sum((lead - _mapped(points, forward, backward, each, angle))[last] ** 2),
    )
    return compensation.LostMotionMap(
        angle=points.tolist(), forward=forward.tolist(), backward=backward.tolist(), reach=float(reach)
    )


def _mapped(points: Array, forward: Array, backward: Array, reach: float, angle: Array) -> Array:
    """Return the lead of a `LostMotionMap` along a motion."""
    above, below = np.interp(angle, points, forward), np.interp(angle, points, backward)
    sense, now = np.zeros(len(angle)), 0.0
    for k, moved in enumerate(np.diff(angle), 1):
        now = np.sign(moved) + (now - np.sign(moved)) * np.exp(-abs(moved) / reach) if moved else now
        sense[k] = now
    return np.asarray(0.5 * (above + below + sense * (above - below)))


def _learners(
    plant: Plant, setting: Setting, orders: list[float], goal: Goal, draws: Mapping[str, Array]
) -> Iterator[tuple[str, Any]]:
    """Yield what learns, with its name; nothing if the loop follows no order with a phase that is known."""
    law, speed = tuned_law(plant, setting), goal.speed * abs(plant.ratio)
    max_frequency = MAX_WAVE_SHARE * law.position_gain
    if speed < MIN_LEARNING_SPEED:
        return
    learnt, lag = learnable(plant, setting, orders, np.minimum(np.multiply(orders, speed), max_frequency), draws)
    if not learnt:
        return
    which = f"order {learnt[0]:g}" if len(learnt) == 1 else f"orders {_and([f'{order:g}' for order in learnt])}"
    gain = LEARNING_SHARE * law.position_gain
    yield (
        which,
        compensation.AdaptiveFourier(
            order=learnt, gain=gain, lag=lag, min_speed=MIN_LEARNING_SPEED, max_frequency=max_frequency, limit=MAX_AMPLITUDE
        ),
    )
    if all(order.is_integer() and order <= MAX_TABLE_ORDER for order in learnt):
        yield (
            "a turn of the input",
            compensation.Repetitive(
                gain=min(0.5 * TABLE_CELLS * gain, MAX_SHARE_OF_PASS * TABLE_CELLS * speed / (2.0 * np.pi)),
                lag=lag,
                min_speed=MIN_LEARNING_SPEED,
                max_speed=max_frequency / max(learnt),
                limit=MAX_AMPLITUDE,
            ),
        )


def learnable(
    plant: Plant, setting: Setting, orders: Sequence[float], frequency: Array, draws: Mapping[str, Array]
) -> tuple[list[float], float]:
    """Return those orders whose waves the loops of all drawn gears follow within 90 degrees of a lag, and this lag [s].

    The waves over the input have frequencies [rad/s]; draws are numbers of drawn gears, by path.
    """
    sampled = sampled_cascade(plant, setting)
    lag = float(-np.mean(np.angle(Loops.of(plant, sampled).following(frequency)) / frequency))
    within = np.ones(len(orders), dtype=bool)
    for k in range(len(next(iter(draws.values()), ()))):
        drawn = replace(plant, drive=plant.drive.replace({path: float(numbers[k]) for path, numbers in draws.items()}))
        follows = Loops.of(drawn, sampled).following(frequency) * np.exp(1j * frequency * lag)
        within &= follows.real > 0.0
    return [order for order, is_within in zip(orders, within, strict=True) if is_within], max(lag, 0.0)


def _name(effects: tuple[str, ...], setting: Setting) -> str:
    encoder = ", position by the output encoder" if setting.feedback == "output" else ""
    return (f"model of {_and(effects)}" if effects else "no model") + encoder


def _compensation(plant: Plant, effects: tuple[str, ...], setting: Setting) -> Compensation:
    """Return the feed-forward of a model that has some effects, and the observer of a setting."""
    return Compensation(
        feedforward=model_of(plant, with_effects(plant.drive.gear, effects, plant.start_temperature)),
        observer=observer_of(plant, setting),
        actuation_per_torque=plant.actuation_per_torque,
    )


def with_effects(gear: Gear, effects: tuple[str, ...], temperature: float = ROOM_TEMPERATURE) -> Gear:
    """Return a gear of which only some effects are known, and the line of its friction at a temperature [K]."""
    parts = {part: getattr(gear, part) for effect in effects for part in GEAR_EFFECTS[effect]}
    return bare(gear, temperature).replace(**parts)


def has_effect(gear: Gear, effect: str) -> bool:
    """True if a gear has an effect at all."""
    none = Gear()
    if effect == "friction":
        return any(line_of_friction(gear))
    if effect == "kinematic error":
        return steepest_error(gear) > 0.0
    return any(
        getattr(gear, part) != getattr(none.replace(stiffness=stiffness.Linear(k=RIGID_STIFFNESS)), part)
        for part in GEAR_EFFECTS[effect]
    )


def is_line(drive: Drive) -> bool:
    """True if the friction of a gear is Coulomb and viscous friction alone, which the cascade feeds forward, too."""
    if any(name.startswith("friction_") for name, *_ in _core.state(drive)[0]):  # bristles
        return False
    coulomb, viscous = line_of_friction(drive.gear)
    speed, turn = np.geomspace(*RANGE_OF_SPEED, 12), np.linspace(0.0, 2.0 * np.pi, 24, endpoint=False)
    for each in speed:
        line = coulomb + viscous * each
        if np.abs(steady_torque(drive.gear, float(each), turn).friction - line).max() > MAX_OFF_LINE * line:
            return False
    return bool(coulomb)


def too_steep(plant: Plant, effect: str) -> bool:
    """True for a kinematic error whose fixed point does not converge, so that it cannot be fed forward."""
    return effect == "kinematic error" and abs(plant.ratio) * steepest_error(plant.drive.gear) >= 1.0


def steepest_error(gear: Gear) -> float:
    """Return the largest slope of the kinematic error of a gear over a turn of the input [rad/rad]."""
    angle = np.linspace(0.0, 2.0 * np.pi, ANGLES_PER_TURN, endpoint=False)
    return float(np.abs(gear.kinematic_error.slope(angle)).max())


def _and(names: Sequence[str]) -> str:
    *first, last = names
    return f"{', '.join(first)} and {last}" if first else last
