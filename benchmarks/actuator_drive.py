"""The tilt actuator with the gear of document A in three stages: what its peers solve, written once over a `Maths`.

The ramp of 90 degrees in 5 s. A cascade closes on the output; the sensor of the current is a gain, that of the speed of first
order, that of the angle of second order; a brushless motor; the gear of Eq. 1, corrected, with its misalignment; an aerodynamic
load. Sensors are without noise, and the friction at the output is LuGre's: a solver that knows no stick can follow it, too. The
numbers are those of the set `tilt-actuator`; the equations are written down here, in the variables of the document.

States: current [A], input angle and speed, angle and speed of the wave generator [rad, rad/s], x2, y1, y2, each with its rate
[m, m/s], output angle and speed, bristle [rad], measured speed [rad/s], measured angle and its rate [rad, rad/s], the integrals
of the errors of speed and current [rad, A.s].
"""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import cache
from typing import TYPE_CHECKING, Any

import numpy as np
from reference_drive import DURATION, SAMPLE, Array, Maths, clip

if TYPE_CHECKING:
    import strainwave as sw

STROKE = math.pi / 2.0  # rad, in DURATION
BRISTLE_STIFFNESS, BRISTLE_DAMPING = 5e4, 5.0  # N.m/rad, N.m.s/rad: presliding of some 1e-4 rad, passive
STATES = 19


@cache
def drive(name: str = "tilt-actuator") -> Any:
    """A set without noise, and with friction that bends before it slides: a drive of the models that stand in the file."""
    import strainwave as sw

    stuck = sw.load(name)
    dry = stuck.gear.friction_output
    friction = sw.friction.LuGre(
        coulomb=dry.coulomb,
        breakaway=dry.breakaway,
        stribeck_speed=dry.stribeck_speed,
        viscous=dry.viscous,
        bristle_stiffness=BRISTLE_STIFFNESS,
        bristle_damping=BRISTLE_DAMPING,
    )
    return without_noise(stuck).replace(gear=stuck.gear.replace(friction_output=friction))


def without_noise(noisy: Any) -> Any:
    sensors = noisy.sensors
    quiet = {name: getattr(sensors, name).law for name in ("current", "input_speed", "output_angle")}
    return noisy.replace(sensors=sensors.replace(**quiet))


def command() -> sw.scenario.Scenario:
    import strainwave as sw

    return sw.scenario.ramp(STROKE / DURATION, DURATION)


def displacement(maths: Maths) -> Callable[..., Any]:
    """(angle of the wave generator) -> radial displacement of the lobe further out [m], and its slope [m/rad].

    Of a generator that sits well on its shaft, the shaft eccentric and tilted in the circular spline: physics of document A.
    """
    law = drive().gear.kinematic_error
    if law.generator_eccentricity or law.generator_tilt_x or law.generator_tilt_y or law.combine != "max":
        raise ValueError("actuator: the peers know the misalignment of the housing only, of the lobe further out")
    x, y = law.housing_tilt_x, law.housing_tilt_y
    tilted = np.array([[math.cos(x), 0.0, math.sin(x)], [0.0, 1.0, 0.0], [-math.sin(x), 0.0, math.cos(x)]]) @ np.array(
        [[1.0, 0.0, 0.0], [0.0, math.cos(y), math.sin(y)], [0.0, -math.sin(y), math.cos(y)]]
    )
    eccentric = law.housing_eccentricity * np.array([math.cos(law.housing_direction), math.sin(law.housing_direction)])
    back = np.linalg.inv(tilted[:2, :2])
    centre_x, centre_y = (float(each) for each in back @ (eccentric + law.offset * tilted[:2, 2]))
    (xx, xy), (yx, yy) = ((float(one), float(other)) for one, other in back)
    major, per_major2, per_minor2 = law.major_radius, law.major_radius**-2, law.minor_radius**-2
    sin, cos, where = maths.sin, maths.cos, maths.where

    @maths.compile
    def displacement(angle: Any) -> Any:
        s, c = sin(angle), cos(angle)
        ray_x, ray_y, turn_x, turn_y = xx * c + xy * s, yx * c + yy * s, xy * c - xx * s, yy * c - yx * s
        w1, w2 = c * ray_x + s * ray_y, c * ray_y - s * ray_x  # the ray in the axes of the ellipse
        d1, d2 = c * centre_x + s * centre_y, c * centre_y - s * centre_x  # the centre
        w1_slope, w2_slope = w2 + c * turn_x + s * turn_y, c * turn_y - s * turn_x - w1
        square = w1 * w1 * per_major2 + w2 * w2 * per_minor2
        square_slope = 2.0 * (w1 * w1_slope * per_major2 + w2 * w2_slope * per_minor2)
        mixed = w1 * d1 * per_major2 + w2 * d2 * per_minor2
        mixed_slope = (w1_slope * d1 + w1 * d2) * per_major2 + (w2_slope * d2 - w2 * d1) * per_minor2
        rest = d1 * d1 * per_major2 + d2 * d2 * per_minor2 - 1.0
        rest_slope = 2.0 * d1 * d2 * (per_major2 - per_minor2)
        root = (mixed * mixed - square * rest) ** 0.5
        root_slope = (mixed * mixed_slope - 0.5 * (square_slope * rest + square * rest_slope)) / root
        outer = where(mixed > 0.0, 1.0, -1.0)
        radius = (outer * mixed + root) / square
        slope = (outer * mixed_slope + root_slope - radius * square_slope) / square
        return radius - major, slope

    return displacement


def integral_rate(maths: Maths) -> Callable[..., Any]:
    """(asked, error, low, high) -> rate of an integral of `error` that feeds what is asked: it fades beyond the limits."""
    minimum, maximum, where = maths.minimum, maths.maximum, maths.where

    @maths.compile
    def integral_rate(asked: Any, error: Any, low: Any, high: Any) -> Any:
        faded = 0.05 * (high - low)
        above = minimum(maximum(asked - high, 0.0) / faded, 1.0)
        below = minimum(maximum(low - asked, 0.0) / faded, 1.0)
        return where(error > 0.0, error * (1.0 - above), error * (1.0 - below))

    return integral_rate


def control(maths: Maths) -> Callable[..., Any]:
    """(time, state) -> motor voltage [V], and the rates of both integrals."""
    law, motor, gear = drive().control, drive().motor, drive().gear
    ratio, limit, fade = gear.kinematics.ratio, clip(maths), integral_rate(maths)
    minimum, maximum = maths.minimum, maths.maximum
    position_gain, speed_limit, back_emf = law.position_gain, law.speed_limit, law.back_emf_feedforward
    proportional, integral, most_asked = law.speed_proportional, law.speed_integral, law.current_limit
    current_proportional, current_integral = law.current_proportional, law.current_integral
    constant, most_drop = motor.torque_constant, motor.resistance * motor.current_limit
    most = min(law.voltage_limit, motor.supply_voltage)
    commanded, forward = STROKE / DURATION, law.speed_feedforward * ratio * STROKE / DURATION

    @maths.compile
    def control(time: Any, state: Any) -> Any:
        wanted = limit(position_gain * ratio * (commanded * time - state[15]) + forward, speed_limit)
        speed_error = wanted - state[14]
        asked = proportional * speed_error + integral * state[17]
        current_error = limit(asked, most_asked) - state[0]
        voltage = current_proportional * current_error + current_integral * state[18] + back_emf * state[14]
        induced = constant * state[2]
        low, high = limit(induced - most_drop, most), limit(induced + most_drop, most)
        inner = fade(asked, speed_error, -most_asked, most_asked)
        return (
            minimum(maximum(voltage, low), high),
            fade(voltage, inner, low, high),
            fade(voltage, current_error, low, high),
        )

    return control


def friction(maths: Maths) -> Callable[..., Any]:
    """(output speed, bristle) -> torque against the output shaft [N.m], and rate of the bristle [rad/s]: LuGre's."""
    law = drive().gear.friction_output
    coulomb, excess, per_speed = law.coulomb, law.breakaway - law.coulomb, 1.0 / law.stribeck_speed
    stiffness, damping, viscous = law.bristle_stiffness, law.bristle_damping, law.viscous
    exp, absolute = maths.exp, maths.absolute

    @maths.compile
    def friction(speed: Any, bristle: Any) -> Any:
        share = speed * per_speed
        rate = speed - stiffness * absolute(speed) * bristle / (coulomb + excess * exp(-share * share))
        return stiffness * bristle + damping * rate + viscous * speed, rate

    return friction


def right_hand_side(maths: Maths) -> Callable[..., Any]:
    """(time, state, rates, load inertia) -> None: fills the rates of all states."""
    gear, motor, load, sensors = drive().gear, drive().motor, drive().load, drive().sensors
    stages, sin, absolute = gear.structure, maths.sin, maths.absolute
    radius, ratio, alpha_t = stages.pitch_radius, gear.kinematics.ratio, stages.pressure_angle
    s, c, lever = math.sin(alpha_t), math.cos(alpha_t), stages.pitch_radius / (ratio * math.tan(alpha_t))
    k_wg, c_wg, k_b, c_b = (
        stages.coupling_stiffness,
        stages.coupling_damping,
        stages.bearing_stiffness,
        stages.bearing_damping,
    )
    k_t, c_t, k_m, c_m = gear.stiffness.k / radius**2, gear.damping / radius**2, stages.mesh_stiffness, stages.mesh_damping
    k_cs, c_cs = stages.circular_spline_stiffness, stages.circular_spline_damping
    radial_mass, j_wg, j_in = stages.radial_mass, gear.input_inertia, motor.inertia
    tangential_mass, spline_mass = stages.flexspline_inertia / radius**2, stages.circular_spline_inertia / radius**2
    resistance, inductance, constant = motor.resistance, motor.inductance, motor.torque_constant
    pressure = 0.5 * load.density * load.area
    hinge = pressure * load.airspeed**2 * load.chord
    offset, slope_of_moment, neutral = load.moment_coefficient, load.moment_slope, load.neutral_angle
    drag = pressure * load.drag_coefficient * load.drag_radius**3
    lag, natural, twice = (
        sensors.input_speed.time_constant,
        sensors.output_angle.natural_frequency,
        2.0 * sensors.output_angle.damping_ratio,
    )
    lobe, voltages, output_friction = displacement(maths), control(maths), friction(maths)

    @maths.compile
    def right_hand_side(time: Any, state: Any, rates: Any, load_inertia: Any) -> None:
        error, slope = lobe(state[3])
        voltage, speed_wound, current_wound = voltages(time, state)
        coupling = k_wg * (state[1] - state[3]) + c_wg * (state[2] - state[4])
        bearing = k_b * (lever * state[3] + error - state[5]) + c_b * ((lever + slope) * state[4] - state[6])
        mesh = k_m * (state[5] * s - (state[7] + state[9]) * c) + c_m * (state[6] * s - (state[8] + state[10]) * c)
        torque = k_cs * (state[9] / radius - state[11]) + c_cs * (state[10] / radius - state[12])
        resisting, bristle_rate = output_friction(state[12], state[13])
        aerodynamic = hinge * (offset + slope_of_moment * sin(state[11] - neutral)) + drag * absolute(state[12]) * state[12]
        rates[0] = (voltage - resistance * state[0] - constant * state[2]) / inductance
        rates[1] = state[2]
        rates[2] = (constant * state[0] - coupling) / j_in
        rates[3] = state[4]
        rates[4] = (coupling - bearing * (lever + slope)) / j_wg
        rates[5] = state[6]
        rates[6] = (bearing - mesh * s) / radial_mass
        rates[7] = state[8]
        rates[8] = (mesh * c - k_t * state[7] - c_t * state[8]) / tangential_mass
        rates[9] = state[10]
        rates[10] = (mesh * c - torque / radius) / spline_mass
        rates[11] = state[12]
        rates[12] = (torque - resisting - aerodynamic) / load_inertia
        rates[13] = bristle_rate
        rates[14] = (state[2] - state[14]) / lag
        rates[15] = state[16]
        rates[16] = natural * (natural * (state[11] - state[15]) - twice * state[16])
        rates[17] = speed_wound
        rates[18] = current_wound

    return right_hand_side


def initial_state(maths: Maths) -> Array:
    """At rest, no part deformed, at the input angle zero."""
    stages = drive().gear.structure
    state = np.zeros(STATES)
    state[5] = displacement(maths)(0.0)[0]
    state[9] = state[5] * math.tan(stages.pressure_angle)
    state[11] = state[15] = state[9] / stages.pitch_radius
    return state


def load_inertias(members: int) -> Array:
    """Of the members of an ensemble [kg.m2]: the drive's own, then from 0.8 to 1.2 times that."""
    inertia: float = drive().load.inertia
    return inertia * np.append(1.0, np.linspace(0.8, 1.2, members - 1))


def sample_times() -> Array:
    return SAMPLE * np.arange(round(DURATION / SAMPLE) + 1, dtype=np.float64)


def state_scale() -> Array:
    """Size of each state: absolute tolerance of a solver = relative tolerance x this."""
    return np.array(
        [1.0, 1.0, 10.0, 1.0, 10.0, 1e-5, 1e-3, 1e-5, 1e-3, 1e-5, 1e-3, 0.01, 0.1, 1e-4, 10.0, 0.01, 0.1, 0.1, 1e-3]
    )


def output_and_torque(states: Array) -> Array:
    """Output angle [rad] and torque on the output shaft's coupling [N.m], shape (n, 2), of a history of the states."""
    stages = drive().gear.structure
    twisted, twisting = states[9] / stages.pitch_radius - states[11], states[10] / stages.pitch_radius - states[12]
    torque = stages.circular_spline_stiffness * twisted + stages.circular_spline_damping * twisting
    return np.column_stack([states[11], torque])
