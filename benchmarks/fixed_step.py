"""Fixed-step simulation of the reference drive with the return map of Maxwell-slip.

The memory holds the displacement of each element, the twist at which they hold and, last, the output's inertia. Within a
step the elements follow the twist, clipped to their limits; they are updated once, at the start of each step.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from reference_drive import (
    ELEMENT_LIMIT,
    ELEMENT_STIFFNESS,
    ELEMENTS,
    OUTPUT_INERTIA,
    Array,
    Maths,
    clip,
    deflection,
    initial_state,
    motion,
    transmitted_torque,
)

Function = Callable[..., Any]


def trial(maths: Maths) -> Function:
    """(twist, memory) -> hysteresis torque [N.m] at this twist; the memory stays."""
    limit = clip(maths)

    @maths.compile
    def trial(twist: Any, memory: Any) -> Any:
        increment, displacement = twist - memory[ELEMENTS], 0.0
        for j in range(ELEMENTS):
            displacement += limit(memory[j] + increment, ELEMENT_LIMIT[j])
        return ELEMENT_STIFFNESS * displacement

    return trial


def advance(maths: Maths) -> Function:
    """(twist, memory) -> hysteresis torque [N.m] at this twist, to which the memory follows."""
    limit = clip(maths)

    @maths.compile
    def advance(twist: Any, memory: Any) -> Any:
        increment, displacement = twist - memory[ELEMENTS], 0.0
        for j in range(ELEMENTS):
            memory[j] = limit(memory[j] + increment, ELEMENT_LIMIT[j])
            displacement += memory[j]
        memory[ELEMENTS] = twist
        return ELEMENT_STIFFNESS * displacement

    return advance


def slope_and_torque(maths: Maths, hysteresis: Function) -> Function:
    """(state, memory) -> slope of the twist over the input angle, and transmitted torque [N.m]."""
    twist_and_slope, gear_torque = deflection(maths), transmitted_torque(maths)

    @maths.compile
    def slope_and_torque(state: Any, memory: Any) -> Any:
        twist, slope = twist_and_slope(state[1], state[3])
        return slope, gear_torque(twist, slope * state[2] - state[4], hysteresis(twist, memory))

    return slope_and_torque


def stage(maths: Maths, hysteresis: Function) -> Function:
    """(time, state, memory) -> rates of the six states."""
    evaluate, move = slope_and_torque(maths, hysteresis), motion(maths)

    @maths.compile
    def stage(time: Any, state: Any, memory: Any) -> Any:
        slope, torque = evaluate(state, memory)
        return move(time, state, slope, torque, memory[ELEMENTS + 1])

    return stage


def ahead(maths: Maths) -> Function:
    """(state, duration, rates) -> state + duration x rates."""

    @maths.compile
    def ahead(y: Any, h: Any, k: Any) -> Any:
        return y[0] + h * k[0], y[1] + h * k[1], y[2] + h * k[2], y[3] + h * k[3], y[4] + h * k[4], y[5] + h * k[5]

    return ahead


def runge_kutta(maths: Maths) -> Function:
    """(time, step, state, memory) -> state one step later, by the classical Runge-Kutta method of order 4."""
    first, later, plus = stage(maths, advance(maths)), stage(maths, trial(maths)), ahead(maths)

    @maths.compile
    def runge_kutta(time: Any, step: Any, state: Any, memory: Any) -> Any:
        half = 0.5 * step
        k1 = first(time, state, memory)
        k2 = later(time + half, plus(state, half, k1), memory)
        k3 = later(time + half, plus(state, half, k2), memory)
        k4 = later(time + step, plus(state, step, k3), memory)
        return plus(state, step / 6.0, plus(plus(plus(k1, 2.0, k2), 2.0, k3), 1.0, k4))

    return runge_kutta


def simulation(maths: Maths, method: Callable[[Maths], Function]) -> Callable[..., Array]:
    """(sample, steps, count, output_inertia) -> samples of a run from rest, shape (count, 5).

    sample: time between samples [s]; steps: steps per sample; count: number of samples. Columns: input angle [rad],
    input speed [rad/s], output angle [rad], output speed [rad/s], transmitted torque [N.m].
    """
    one_step, evaluate = method(maths), slope_and_torque(maths, trial(maths))
    start = tuple(float(x) for x in initial_state()[:6])

    @maths.compile
    def simulation(sample: float, steps: int, count: int, output_inertia: float = OUTPUT_INERTIA) -> Any:
        state, memory, samples = start, np.zeros(ELEMENTS + 2), np.empty((count, 5))
        memory[ELEMENTS + 1] = output_inertia
        step = sample / steps
        for k in range(count):
            _, torque = evaluate(state, memory)
            samples[k, 0], samples[k, 1], samples[k, 2], samples[k, 3] = state[1], state[2], state[3], state[4]
            samples[k, 4] = torque
            if k < count - 1:
                for i in range(steps):
                    state = one_step(k * sample + i * step, step, state, memory)
        return samples

    return simulation
