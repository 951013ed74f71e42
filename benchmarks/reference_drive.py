"""The reference drive: a position-controlled joint with every nonlinearity of a strain wave gear.

DC motor, LuGre friction at the input, kinematic error of ten orders, cubic stiffness with viscous damping and a
Maxwell-slip hysteresis of eight elements, a pendulum at the output, PD control with a voltage limit. It is stiff (the
bristle of the input friction relaxes at up to 3.8e5 1/s), it has kinks (each Maxwell element slips and sticks, the
voltage saturates) and it remembers: the properties that decide which integrator a simulation of such a gear needs.

The equations are written once, over a `Maths`: the functions that floats, Numba, NumPy arrays, CasADi and JAX symbols
have under different names. All peers therefore solve the same problem, to the last term. (strainwave brings its own
equations; for JAX the Maxwell elements are rearranged into a vector.)

States: current [A], input angle [rad], input speed [rad/s], output angle [rad], output speed [rad/s], bristle
deflection [rad]; then, where the solver has no return map, the displacement of each Maxwell element [rad].
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

# motor
RESISTANCE = 0.5  # ohm
INDUCTANCE = 5e-4  # H
MOTOR_CONSTANT = 0.1  # N.m/A and V.s/rad
INPUT_INERTIA = 1e-4  # kg.m2

# gear
RATIO = 100.0  # input turns per output turn, same sense
ERROR_PHASE = (0.3, 0.7, 1.1, 2.1, 0.2, 0.9, 1.7, 2.6, 0.5, 1.3)  # rad, orders 1 to 10 of the input angle
ERROR_AMPLITUDE = tuple(2e-4 if order == 2 else 2e-5 / order for order in range(1, 11))  # rad at the output
STIFFNESS_LINEAR = 1.2e4  # N.m/rad
STIFFNESS_CUBIC = 1e9  # N.m/rad3
DAMPING = 10.0  # N.m.s/rad
ELEMENT_STIFFNESS = 3e3 / 8  # N.m/rad, of each Maxwell element
ELEMENT_LIMIT = tuple(5e-5 * 1.6**j for j in range(8))  # rad, displacement at which an element slips

# input friction (LuGre)
BRISTLE_STIFFNESS = 50.0  # N.m/rad
BRISTLE_DAMPING = 0.02  # N.m.s/rad
VISCOUS_INPUT = 5e-5  # N.m.s/rad
COULOMB = 0.03  # N.m
BREAKAWAY = 0.045  # N.m
STRIBECK_SPEED = 2.0  # rad/s

# load
OUTPUT_INERTIA = 0.5  # kg.m2
VISCOUS_OUTPUT = 0.5  # N.m.s/rad
GRAVITY_TORQUE = 15.0  # N.m, with the pendulum horizontal

# control, and the commanded output angle  SLOPE t + AMPLITUDE sin(2 pi FREQUENCY t)
PROPORTIONAL = 2.0  # V/rad, of the input angle
DERIVATIVE = 0.05  # V.s/rad
VOLTAGE_LIMIT = 48.0  # V
COMMAND_SLOPE = 0.3  # rad/s
COMMAND_AMPLITUDE = 0.2  # rad
COMMAND_FREQUENCY = 2.0  # Hz

DURATION = 5.0  # s
SAMPLE = 1e-3  # s

ELEMENTS = len(ELEMENT_LIMIT)
_SINE = tuple(a * math.cos(p) for a, p in zip(ERROR_AMPLITUDE, ERROR_PHASE, strict=True))
_COSINE = tuple(a * math.sin(p) for a, p in zip(ERROR_AMPLITUDE, ERROR_PHASE, strict=True))
_ORDERS = len(ERROR_AMPLITUDE)

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Maths:
    """The functions that one kind of number is calculated with, and how a function of such numbers is compiled."""

    sin: Callable[[Any], Any]
    cos: Callable[[Any], Any]
    exp: Callable[[Any], Any]
    absolute: Callable[[Any], Any]
    minimum: Callable[[Any, Any], Any]
    maximum: Callable[[Any, Any], Any]
    where: Callable[[Any, Any, Any], Any]
    compile: Callable[[Callable[..., Any]], Callable[..., Any]]


def _where(condition: Any, then: Any, otherwise: Any) -> Any:
    return then if condition else otherwise


def _as_written(function: Callable[..., Any]) -> Callable[..., Any]:
    return function


PYTHON = Maths(math.sin, math.cos, math.exp, abs, min, max, _where, _as_written)
NUMPY = Maths(np.sin, np.cos, np.exp, np.abs, np.minimum, np.maximum, np.where, _as_written)


def numba_maths(**options: Any) -> Maths:
    """Floats compiled by Numba; `options` are those of `numba.njit`."""
    import numba

    jit = numba.njit(**options)
    return Maths(math.sin, math.cos, math.exp, abs, min, max, jit(_where), jit)


def clip(maths: Maths) -> Callable[..., Any]:
    """(value, limit) -> value within +-limit."""
    minimum, maximum = maths.minimum, maths.maximum

    @maths.compile
    def clip(value: Any, limit: Any) -> Any:
        return minimum(maximum(value, -limit), limit)

    return clip


def deflection(maths: Maths) -> Callable[..., Any]:
    """(input_angle, output_angle) -> twist at the output [rad] and its slope over the input angle.

    The sines of the ten orders come from one sine and cosine by the addition theorem.
    """
    sin, cos = maths.sin, maths.cos

    @maths.compile
    def deflection(input_angle: Any, output_angle: Any) -> Any:
        sine, cosine = sin(input_angle), cos(input_angle)
        s, c, error, slope = sine, cosine, 0.0, 0.0
        for n in range(_ORDERS):
            error = error + _SINE[n] * s + _COSINE[n] * c
            slope = slope + (n + 1) * (_SINE[n] * c - _COSINE[n] * s)
            s, c = s * cosine + c * sine, c * cosine - s * sine
        return input_angle / RATIO + error - output_angle, 1.0 / RATIO + slope

    return deflection


def stribeck_torque(maths: Maths) -> Callable[..., Any]:
    """(speed) -> torque at which the input friction slides steadily, without its viscous part [N.m]."""
    exp = maths.exp

    @maths.compile
    def stribeck_torque(speed: Any) -> Any:
        ratio = speed / STRIBECK_SPEED
        return COULOMB + (BREAKAWAY - COULOMB) * exp(-ratio * ratio)

    return stribeck_torque


def bristle_decay(maths: Maths) -> Callable[..., Any]:
    """(input_speed) -> rate at which the LuGre bristle forgets [1/s]: stiffness |speed| / Stribeck torque."""
    absolute, sliding = maths.absolute, stribeck_torque(maths)

    @maths.compile
    def bristle_decay(speed: Any) -> Any:
        return BRISTLE_STIFFNESS * absolute(speed) / sliding(speed)

    return bristle_decay


@dataclass(frozen=True)
class Tracking:
    """What the drive is to follow, and how hard it tries; the reference drive's own unless given."""

    proportional: float = PROPORTIONAL  # V/rad, of the input angle
    derivative: float = DERIVATIVE  # V.s/rad
    slope: float = COMMAND_SLOPE  # rad/s
    amplitude: float = COMMAND_AMPLITUDE  # rad
    frequency: float = COMMAND_FREQUENCY  # Hz


OWN_TRACKING = Tracking()


def voltage(maths: Maths, tracking: Tracking = OWN_TRACKING) -> Callable[..., Any]:
    """(time, input_angle, input_speed) -> motor voltage [V]."""
    sin, cos, limit = maths.sin, maths.cos, clip(maths)
    proportional, derivative, slope = tracking.proportional, tracking.derivative, tracking.slope
    amplitude, pulsation = tracking.amplitude, 2.0 * math.pi * tracking.frequency

    @maths.compile
    def voltage(time: Any, angle: Any, speed: Any) -> Any:
        phase = pulsation * time
        command = slope * time + amplitude * sin(phase)
        command_speed = slope + amplitude * pulsation * cos(phase)
        demand = proportional * (RATIO * command - angle) + derivative * (RATIO * command_speed - speed)
        return limit(demand, VOLTAGE_LIMIT)

    return voltage


def transmitted_torque(maths: Maths) -> Callable[..., Any]:
    """(twist, twist_rate, hysteresis) -> torque through the gear, at the output [N.m]."""

    @maths.compile
    def transmitted_torque(twist: Any, twist_rate: Any, hysteresis: Any) -> Any:
        return (STIFFNESS_LINEAR + STIFFNESS_CUBIC * twist * twist) * twist + DAMPING * twist_rate + hysteresis

    return transmitted_torque


def motion(maths: Maths) -> Callable[..., Any]:
    """(time, state, slope, torque, output_inertia) -> rates of the first six states, as a tuple."""
    sin, decay, drive_voltage = maths.sin, bristle_decay(maths), voltage(maths)

    @maths.compile
    def motion(time: Any, state: Any, slope: Any, torque: Any, output_inertia: Any) -> Any:
        current, input_angle, input_speed = state[0], state[1], state[2]
        output_angle, output_speed, bristle = state[3], state[4], state[5]
        bristle_rate = input_speed - decay(input_speed) * bristle
        friction = BRISTLE_STIFFNESS * bristle + BRISTLE_DAMPING * bristle_rate + VISCOUS_INPUT * input_speed
        drop = drive_voltage(time, input_angle, input_speed) - RESISTANCE * current - MOTOR_CONSTANT * input_speed
        load = GRAVITY_TORQUE * sin(output_angle) + VISCOUS_OUTPUT * output_speed
        return (
            drop / INDUCTANCE,
            input_speed,
            (MOTOR_CONSTANT * current - friction - slope * torque) / INPUT_INERTIA,
            output_speed,
            (torque - load) / output_inertia,
            bristle_rate,
        )

    return motion


def right_hand_side(maths: Maths) -> Callable[..., Any]:
    """(time, state, rates, output_inertia) -> None: fills the rates of all 14 states; Maxwell elements are ODE states."""
    absolute, where = maths.absolute, maths.where
    twist_and_slope, gear_torque, move = deflection(maths), transmitted_torque(maths), motion(maths)

    @maths.compile
    def right_hand_side(time: Any, state: Any, rates: Any, output_inertia: Any = OUTPUT_INERTIA) -> None:
        twist, slope = twist_and_slope(state[1], state[3])
        twist_rate = slope * state[2] - state[4]
        hysteresis = 0.0
        for j in range(ELEMENTS):
            element = state[6 + j]
            hysteresis = hysteresis + ELEMENT_STIFFNESS * element
            loading_rate = where(element * twist_rate > 0.0, 0.0, twist_rate)
            rates[6 + j] = where(absolute(element) >= ELEMENT_LIMIT[j], loading_rate, twist_rate)
        moved = move(time, state, slope, gear_torque(twist, twist_rate, hysteresis), output_inertia)
        for i in range(6):
            rates[i] = moved[i]

    return right_hand_side


def initial_state() -> Array:
    """At rest, untwisted, at input angle zero; shape (14,)."""
    state = np.zeros(6 + ELEMENTS)
    state[3] = math.fsum(_COSINE)
    return state


def sample_times() -> Array:
    """Times at which the solutions are compared [s], shape (5001,)."""
    return SAMPLE * np.arange(round(DURATION / SAMPLE) + 1, dtype=np.float64)


def output_inertias(members: int) -> Array:
    """Of the members of an ensemble [kg.m2], shape (members,): the drive's own, then from 0.8 to 1.2 times that."""
    return OUTPUT_INERTIA * np.append(1.0, np.linspace(0.8, 1.2, members - 1))


def state_scale() -> Array:
    """Size of each of the 14 states [its unit]: absolute tolerance of a solver = relative tolerance x this."""
    return np.array([0.1, 1.0, 10.0, 0.01, 0.1, 1e-4] + [1e-4] * ELEMENTS)


def output_and_torque(states: Array) -> Array:
    """Output angle [rad] and transmitted torque [N.m], shape (n, 2), of a history of the 14 states, shape (14, n)."""
    twist, slope = deflection(NUMPY)(states[1], states[3])
    limit = np.array(ELEMENT_LIMIT)[:, None]
    hysteresis = ELEMENT_STIFFNESS * np.clip(states[6:], -limit, limit).sum(axis=0)
    torque = transmitted_torque(NUMPY)(twist, slope * states[2] - states[4], hysteresis)
    return np.column_stack([states[3], torque])
