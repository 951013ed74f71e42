"""Laws of control as a computer would run them, written by hand from their equations: callables of what they see."""

from __future__ import annotations

import numpy as np
import strainwave as sw

from tests.control.discrete import RATIO


def within(seen: sw.simulation.Observation, limit: float) -> tuple[float, float]:
    """The least and the largest actuation that law and motor allow."""
    return max(seen.low, -limit), min(seen.high, limit)


def advanced(error: float, asked: float, low: float, high: float) -> float:
    """The error as an integral takes it that feeds what is asked.

    What leads further beyond what is allowed fades over a twentieth of the range.
    """
    beyond = max(asked - high if error > 0.0 else low - asked, 0.0)
    return error * float(np.interp(beyond, [0.0, 0.05 * (high - low)], [1.0, 0.0]))


class PID:
    def __init__(self, law: sw.control.PID, period: float, ratio: float = RATIO) -> None:
        self.law, self.period, self.ratio, self.integral = law, period, ratio, 0.0

    def __call__(self, seen: sw.simulation.Observation) -> float:
        law = self.law
        on_output = law.feedback == "output"
        error = self.ratio * seen.command - (self.ratio * seen.output_angle if on_output else seen.input_angle)
        rate = self.ratio * seen.command_rate - (self.ratio * seen.output_speed if on_output else seen.input_speed)
        asked = law.proportional * error + law.integral * self.integral + law.derivative * rate
        low, high = within(seen, law.limit)
        self.integral += self.period * advanced(error, asked, low, high)
        return float(np.clip(asked, low, high))


class PI:
    def __init__(self, law: sw.control.PI, period: float, ratio: float = RATIO) -> None:
        self.law, self.period, self.ratio, self.integral = law, period, ratio, 0.0

    def __call__(self, seen: sw.simulation.Observation) -> float:
        law = self.law
        speed = self.ratio * seen.output_speed if law.feedback == "output" else seen.input_speed
        error = self.ratio * seen.command - speed
        asked = law.proportional * error + law.integral * self.integral
        low, high = within(seen, law.limit)
        self.integral += self.period * advanced(error, asked, low, high)
        return float(np.clip(asked, low, high))


class PositionSpeed:
    def __init__(self, law: sw.control.PositionSpeed, period: float, ratio: float = RATIO) -> None:
        self.law, self.period, self.ratio, self.integral = law, period, ratio, 0.0

    def __call__(self, seen: sw.simulation.Observation) -> float:
        law, commanded = self.law, self.ratio * seen.command_rate
        angle = self.ratio * seen.output_angle if law.feedback == "output" else seen.input_angle
        wanted = law.position_gain * (self.ratio * seen.command - angle) + law.speed_feedforward * commanded
        error = np.clip(wanted, -law.speed_limit, law.speed_limit) - seen.input_speed
        asked = law.speed_proportional * error + law.speed_integral * self.integral
        asked += law.viscous_feedforward * commanded + law.coulomb_feedforward * np.sign(commanded)
        low, high = within(seen, law.limit)
        self.integral += self.period * advanced(error, asked, low, high)
        return float(np.clip(asked, low, high))


class Cascade:
    def __init__(self, law: sw.control.Cascade, period: float, ratio: float = RATIO) -> None:
        self.law, self.period, self.ratio, self.speed, self.current = law, period, ratio, 0.0, 0.0

    def __call__(self, seen: sw.simulation.Observation) -> float:
        law, commanded = self.law, self.ratio * seen.command_rate
        angle = self.ratio * seen.output_angle if law.feedback == "output" else seen.input_angle
        wanted = law.position_gain * (self.ratio * seen.command - angle) + law.speed_feedforward * commanded
        speed_error = np.clip(wanted, -law.speed_limit, law.speed_limit) - seen.input_speed
        asked = law.speed_proportional * speed_error + law.speed_integral * self.speed
        asked += law.viscous_feedforward * commanded + law.coulomb_feedforward * np.sign(commanded)
        error = np.clip(asked, -law.current_limit, law.current_limit) - seen.current
        voltage = law.current_proportional * error + law.current_integral * self.current
        voltage += law.back_emf_feedforward * seen.input_speed
        low, high = within(seen, law.voltage_limit)
        self.speed += self.period * advanced(
            advanced(speed_error, asked, -law.current_limit, law.current_limit), voltage, low, high
        )
        self.current += self.period * advanced(error, voltage, low, high)
        return float(np.clip(voltage, low, high))


class LeadLag:
    """Each section is exact for what is held over a period."""

    def __init__(self, law: sw.control.LeadLag, period: float, ratio: float = RATIO) -> None:
        self.law, self.ratio, self.first, self.second = law, ratio, 0.0, 0.0
        self.kept = np.exp(-period / law.lead_denominator), np.exp(-period / law.lag_denominator)

    def __call__(self, seen: sw.simulation.Observation) -> float:
        law = self.law
        error = self.ratio * seen.command - (self.ratio * seen.output_angle if law.feedback == "output" else seen.input_angle)
        lead = self.first + law.lead_numerator / law.lead_denominator * (error - self.first)
        lag = self.second + law.lag_numerator / law.lag_denominator * (lead - self.second)
        self.first = error + self.kept[0] * (self.first - error)
        self.second = lead + self.kept[1] * (self.second - lead)
        return float(np.clip(law.gain * lag, *within(seen, law.limit)))


class StateFeedback:
    """It remembers nothing."""

    def __init__(self, law: sw.control.StateFeedback, _period: float = 0.0, ratio: float = RATIO) -> None:
        self.law, self.ratio = law, ratio

    def __call__(self, seen: sw.simulation.Observation) -> float:
        law = self.law
        asked = law.input_angle * (self.ratio * seen.command - seen.input_angle)
        asked += law.input_speed * (self.ratio * seen.command_rate - seen.input_speed)
        asked += law.output_angle * (seen.command - seen.output_angle) + law.output_speed * (
            seen.command_rate - seen.output_speed
        )
        asked -= law.current * seen.current + law.torque * seen.torque
        return float(np.clip(asked, *within(seen, law.limit)))


class StateSpace:
    """The recursion x + T (A x + B y + l (u - v)) with matrices of numpy."""

    def __init__(self, law: sw.control.StateSpace, period: float, ratio: float = RATIO) -> None:
        self.law, self.period, self.ratio = law, period, ratio
        states, inputs = len(law.C), len(law.D)
        self.a, self.b = np.reshape(law.A, (states, states)), np.reshape(law.B, (states, inputs))
        self.c, self.d, self.tracking = np.array(law.C), np.array(law.D), np.array(law.tracking or states * [0.0])
        self.x = np.zeros(states)

    def __call__(self, seen: sw.simulation.Observation) -> float:
        errors = [self.ratio * seen.command - seen.input_angle, self.ratio * seen.command_rate - seen.input_speed]
        errors += [seen.command - seen.output_angle, seen.command_rate - seen.output_speed]
        y = np.array([*errors, seen.current, seen.torque, seen.command, seen.command_rate])[: len(self.d)]
        asked = self.c @ self.x + self.d @ y
        limited = float(np.clip(asked, *within(seen, self.law.limit)))
        self.x = self.x + self.period * (self.a @ self.x + self.b @ y + self.tracking * (limited - asked))
        return limited


class Lags:
    """Derivatives of the commanded rate: two lags by forward differences."""

    def __init__(self, time: float, period: float) -> None:
        self.time, self.period = time, period
        self.rate, self.second = 0.0, 0.0

    def __call__(self, rate: float) -> tuple[float, float]:
        """Acceleration and jerk at this instant."""
        acceleration = (rate - self.rate) / self.time
        jerk = (acceleration - self.second) / self.time
        self.rate += self.period * acceleration
        self.second += self.period * jerk
        return acceleration, jerk


def error_of(law: sw.kinematic_error.Fourier, angle: float) -> tuple[float, float]:
    """Value and slope."""
    phase = np.array(law.order) * angle + np.array(law.phase)
    return float(np.sin(phase) @ law.amplitude), float(np.cos(phase) @ (np.array(law.amplitude) * law.order))


def bend_of(law: sw.kinematic_error.Fourier, angle: float) -> float:
    """Second derivative, as the laws take it: a difference of slopes."""
    return (error_of(law, angle + 1e-3)[1] - error_of(law, angle - 1e-3)[1]) / 2e-3


class FeedbackLinearisation:
    """Of a linear spring and a plain inertia: the chain of derivatives has no term of the load, and T'' is 0."""

    def __init__(self, law: sw.control.FeedbackLinearisation, period: float, ratio: float = RATIO) -> None:
        self.law, self.ratio, self.lags = law, ratio, Lags(law.reference_time, period)

    def __call__(self, seen: sw.simulation.Observation) -> float:
        law, w = self.law, self.law.bandwidth
        k, inertia = law.gear.stiffness.k, law.load.inertia
        error, slope = error_of(law.gear.kinematic_error, seen.input_angle)
        per_input = 1.0 / self.ratio - slope
        torque = k * (seen.input_angle / self.ratio - seen.output_angle - error)
        acceleration, jerk = torque / inertia, k * (per_input * seen.input_speed - seen.output_speed) / inertia
        wanted_acceleration, wanted_jerk = self.lags(seen.command_rate)
        snap = w**4 * (seen.command - seen.output_angle) + 4.0 * w**3 * (seen.command_rate - seen.output_speed)
        snap += 6.0 * w**2 * (wanted_acceleration - acceleration) + 4.0 * w * (wanted_jerk - jerk)
        bend = bend_of(law.gear.kinematic_error, seen.input_angle)
        needed = (inertia * snap / k + bend * seen.input_speed**2 + acceleration) / per_input
        asked = (law.motor_inertia + law.gear.input_inertia) * needed + per_input * torque
        asked = law.actuation_per_torque * asked + law.actuation_per_speed * seen.input_speed
        return float(np.clip(asked, *within(seen, law.limit)))


class KinematicErrorTracking:
    """Of a plain inertia."""

    def __init__(self, law: sw.control.KinematicErrorTracking, period: float, ratio: float = RATIO) -> None:
        self.law, self.ratio, self.lags = law, ratio, Lags(law.reference_time, period)

    def __call__(self, seen: sw.simulation.Observation) -> float:
        law, rotor = self.law, self.law.motor_inertia + self.law.gear.input_inertia
        error, slope = error_of(law.gear.kinematic_error, seen.input_angle)
        bend = bend_of(law.gear.kinematic_error, seen.input_angle)
        g = 1.0 / self.ratio - slope
        output = seen.output_angle if law.feedback == "output" else seen.input_angle / self.ratio - error
        reference = (seen.command_rate + law.bandwidth * (seen.command - output)) / g
        acceleration, _ = self.lags(seen.command_rate)
        rate = (acceleration + law.bandwidth * (seen.command_rate - g * seen.input_speed)) / g
        rate += reference * bend * seen.input_speed / g
        mass, half_slope = rotor + law.load.inertia * g**2, -law.load.inertia * g * bend
        asked = mass * rate + half_slope * seen.input_speed * reference - law.speed_gain * (seen.input_speed - reference)
        asked = law.actuation_per_torque * asked + law.actuation_per_speed * seen.input_speed
        return float(np.clip(asked, *within(seen, law.limit)))
