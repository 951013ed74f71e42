"""Integration in stretches within which all is smooth: what an expert makes of SciPy for drives that remember.

As long as the twist goes one way, the return map of the Maxwell elements is a function of the twist alone, and as long as a
friction slides one way, or sticks, it is smooth. A stretch ends where the first of its signals falls through zero; the elements
are brought up to there, and the integration starts afresh. Two reversals within one step of the solver are not seen.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from fixed_step import Function, advance, slope_and_torque, stage, trial
from reference_drive import (
    BREAKAWAY,
    ELEMENTS,
    INDUCTANCE,
    INPUT_INERTIA,
    MOTOR_CONSTANT,
    OUTPUT_INERTIA,
    RESISTANCE,
    VISCOUS_INPUT,
    VISCOUS_OUTPUT,
    Array,
    Maths,
    Tracking,
    deflection,
    initial_state,
    sample_times,
    state_scale,
    stribeck_torque,
    voltage,
)

STILL = 1e-12  # rad/s, at which a twist that runs back is told from one that rests
Mode = tuple[float, float]  # which way the twist goes, and which way the input slides: 0 where it sticks


@dataclass(frozen=True)
class Smooth:
    """A drive, smooth within a mode. All functions take (time, state, memory, mode); `memory` is that of `fixed_step`.

    states: how many; first: the mode it starts in; rates: of the states; signals: positive within a mode; switched: the mode
    after signal number `which`, its first argument, has fallen through zero, the state being brought to it.
    """

    states: int
    first: Mode
    rates: Function
    signals: tuple[Function, ...]
    switched: Function


def turning(maths: Maths) -> Function:
    """The signal that falls through zero where the twist turns round."""
    evaluate = deflection(maths)

    @maths.compile
    def turning(time: float, state: Any, memory: Any, mode: Mode) -> float:
        _, slope = evaluate(state[1], state[3])
        rate: float = slope * state[2] - state[4]
        return mode[0] * rate + STILL

    return turning


def reference_stretches(maths: Maths) -> Smooth:
    """The reference drive: smooth between the turns of its twist. Its load, let go, twists it first."""
    moved = stage(maths, trial(maths))

    @maths.compile
    def rates(time: float, state: Any, memory: Any, mode: Mode) -> Any:
        out = np.empty(6)
        out[0], out[1], out[2], out[3], out[4], out[5] = moved(time, state, memory)
        return out

    def switched(which: int, time: float, state: Array, memory: Array, mode: Mode) -> Mode:
        return -mode[0], mode[1]

    return Smooth(6, (1.0, 0.0), rates, (turning(maths),), switched)


def sticking_stretches(maths: Maths, tracking: Tracking) -> Smooth:
    """The same with Stribeck friction at the input, which sticks, and without gravity. Without the state of the bristle."""
    evaluate, sliding_torque, drive_voltage = (
        slope_and_torque(maths, trial(maths)),
        stribeck_torque(maths),
        voltage(maths, tracking),
    )

    @maths.compile
    def rates(time: float, state: Any, memory: Any, mode: Mode) -> Any:
        slope, torque = evaluate(state, memory)
        out, sliding = np.empty(5), mode[1]
        friction = sliding * sliding_torque(state[2]) + VISCOUS_INPUT * state[2]
        net = MOTOR_CONSTANT * state[0] - slope * torque - friction
        drop = drive_voltage(time, state[1], state[2]) - RESISTANCE * state[0] - MOTOR_CONSTANT * state[2]
        out[0] = drop / INDUCTANCE
        out[1] = state[2]
        out[2] = net / INPUT_INERTIA if sliding != 0.0 else 0.0
        out[3] = state[4]
        out[4] = (torque - VISCOUS_OUTPUT * state[4]) / memory[ELEMENTS + 1]
        return out

    @maths.compile
    def held(state: Any, memory: Any) -> Any:
        slope, torque = evaluate(state, memory)
        return MOTOR_CONSTANT * state[0] - slope * torque

    @maths.compile
    def slipping(time: float, state: Any, memory: Any, mode: Mode) -> Any:
        sliding = mode[1]
        return sliding * state[2] if sliding != 0.0 else BREAKAWAY - abs(held(state, memory))

    def switched(which: int, time: float, state: Array, memory: Array, mode: Mode) -> Mode:
        turn, sliding = mode
        if which == 0:
            return -turn, sliding
        state[2], load = 0.0, held(state, memory)
        sticks = sliding != 0.0 and abs(load) <= BREAKAWAY
        return turn, 0.0 if sticks else float(np.sign(load))

    return Smooth(5, (1.0, 0.0), rates, (turning(maths), slipping), switched)


@dataclass(frozen=True)
class Stretch:
    """One stretch of a drive: what the solver sees of it, which is smooth."""

    drive: Smooth
    memory: Array
    mode: Mode

    def rates(self, time: float, state: Array) -> Any:
        return self.drive.rates(time, state, self.memory, self.mode)

    def signal(self, which: int, time: float, state: Array) -> float:
        value: float = self.drive.signals[which](time, state, self.memory, self.mode)
        return value

    def signals(self, time: float, state: Array) -> list[float]:
        return [self.signal(which, time, state) for which in range(len(self.drive.signals))]


def solver(drive: Smooth, maths: Maths, method: str) -> Callable[[float], Array]:
    """Runs by a method of SciPy: relative tolerance -> output angle and torque at the samples, shape (5001, 2).

    Steps are taken one by one: `solve_ivp`, which does the same, spends half of its time on the bookkeeping of events.
    """
    from scipy import integrate

    method_class = getattr(integrate, method)
    start, samples, scale = initial_state()[: drive.states], sample_times(), state_scale()[: drive.states]
    at, catch_up, observe = deflection(maths), advance(maths), observed(maths)

    def solve(tolerance: float, times: Array = samples) -> Array:
        time, state, memory, mode = 0.0, start.copy(), np.zeros(ELEMENTS + 2), drive.first
        memory[ELEMENTS + 1] = OUTPUT_INERTIA
        pieces: list[Array] = []
        left = times
        while left.size:
            stretch = Stretch(drive, memory, mode)
            stepper = method_class(stretch.rates, time, state, times[-1], rtol=tolerance, atol=tolerance * scale)
            before, which = stretch.signals(time, state), None
            while which is None and left.size:
                if message := stepper.step():
                    raise RuntimeError(f"{method}: {message}")
                after = stretch.signals(stepper.t, stepper.y)
                time, state, which = first_fall(stretch, stepper, before, after)
                before = after
                if passed := int(np.searchsorted(left, time, side="right")):
                    pieces.append(observe(stepper.dense_output()(left[:passed]), memory))
                    left = left[passed:]
            if which is not None:
                catch_up(at(state[1], state[3])[0], memory)
                mode = drive.switched(which, time, state, memory, mode)
        return np.concatenate(pieces)

    solve(1e-3, samples[:100])  # compiles
    return solve


def first_fall(stretch: Stretch, stepper: Any, before: list[float], after: list[float]) -> tuple[float, Array, int | None]:
    """Time and state at which the first signal falls through zero within the last step, and which; else those of its end."""
    from scipy.optimize import brentq

    falls = [number for number, (old, new) in enumerate(zip(before, after, strict=True)) if old >= 0.0 > new]
    if not falls:
        return stepper.t, stepper.y, None
    within = stepper.dense_output()
    roots = [
        brentq(lambda t, which=which: stretch.signal(which, t, within(t)), stepper.t_old, stepper.t, xtol=1e-15)
        for which in falls
    ]
    time = min(roots)
    return time, within(time), falls[roots.index(time)]


def observed(maths: Maths) -> Function:
    """(states, memory) -> output angle and torque, shape (n, 2), of states of one stretch, shape (states, n)."""
    evaluate = slope_and_torque(maths, trial(maths))

    @maths.compile
    def observed(states: Any, memory: Any) -> Any:
        out = np.empty((states.shape[1], 2))
        for k in range(states.shape[1]):
            out[k, 0] = states[3, k]
            out[k, 1] = evaluate(states[:, k], memory)[1]
        return out

    return observed
