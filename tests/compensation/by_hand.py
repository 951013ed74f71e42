"""Compensators as a computer would run them, written by hand from their equations: around a PID with a limit."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any, Protocol

import numpy as np
import strainwave as sw
from numpy.typing import NDArray

Array = NDArray[np.float64]


@dataclass
class Instant:
    """Inputs of a compensator at an instant, and the sum of the requests before it."""

    seen: sw.simulation.Observation
    ratio: float
    period: float
    lead: float = 0.0
    lead_rate: float = 0.0
    torque: float = 0.0
    friction: float = 0.0
    torsion: float = 0.0

    @property
    def speed(self) -> float:
        """Input speed that the controller is to follow [rad/s]."""
        return self.ratio * self.seen.command_rate + self.lead_rate

    @property
    def error(self) -> float:
        """Of the output angle [rad]."""
        return self.seen.command - self.seen.output_angle


class Compensator(Protocol):
    """Adds its requests; learns from the torque [N.m] that the motor gave."""

    def add(self, now: Instant) -> None: ...
    def learn(self, now: Instant, motor_torque: float) -> None: ...


@dataclass
class LostMotionMap:
    law: sw.compensation.LostMotionMap
    angle: float | None = None
    sense: float = 0.0
    lead: float = 0.0

    def add(self, now: Instant) -> None:
        law, at = self.law, now.seen.command
        moved = 0.0 if self.angle is None else at - self.angle
        if moved != 0.0:
            self.sense = np.sign(moved) + (self.sense - np.sign(moved)) * np.exp(-abs(moved) / law.reach)
        forward, backward = (np.interp(at, law.angle, line) for line in (law.forward, law.backward))
        lead = float(0.5 * (1.0 + self.sense) * forward + 0.5 * (1.0 - self.sense) * backward)
        now.lead += now.ratio * lead
        now.torsion += now.ratio * lead
        now.lead_rate += 0.0 if self.angle is None else now.ratio * (lead - self.lead) / now.period
        self.angle, self.lead = at, lead

    def learn(self, now: Instant, motor_torque: float) -> None: ...


@dataclass
class AdaptiveFourier:
    law: sw.compensation.AdaptiveFourier
    waves: Array = field(default_factory=lambda: np.zeros((2, 4)))  # of sines and of cosines
    speed: float = 0.0

    def add(self, now: Instant) -> None:
        order = np.array(self.law.order)
        (sine, cosine), angle = self.waves[:, : order.size], order * now.seen.input_angle
        self.speed = now.speed  # before its own rate
        now.lead += now.ratio * float((sine * np.sin(angle) + cosine * np.cos(angle)).sum())
        rate = order * self.speed * (sine * np.cos(angle) - cosine * np.sin(angle))
        now.lead_rate += now.ratio * float(rate.sum())

    def learn(self, now: Instant, motor_torque: float) -> None:
        law, order = self.law, np.array(self.law.order)
        late = order * now.seen.input_angle - order * self.speed * law.lag
        step = (
            law.gain
            * now.period
            * now.error
            * (abs(order * self.speed) < law.max_frequency)
            * (abs(self.speed) >= law.min_speed)
        )
        self.waves[:, : order.size] += step * np.array([np.sin(late), np.cos(late)])
        self.waves = np.clip(self.waves, -law.limit, law.limit)


def hats(angle: float, cells: int = 32) -> Array:
    """Hat functions of equal cells of a turn."""
    apart = np.mod(angle * cells / (2.0 * np.pi) - np.arange(cells) + cells / 2, cells) - cells / 2
    return np.maximum(1.0 - np.abs(apart), 0.0)


@dataclass
class Repetitive:
    law: sw.compensation.Repetitive
    values: Array = field(default_factory=lambda: np.zeros(32))
    speed: float = 0.0

    def add(self, now: Instant) -> None:
        self.speed = now.speed
        place = now.seen.input_angle * 32 / (2.0 * np.pi)
        cell = int(np.floor(place))
        slope = (self.values[(cell + 1) % 32] - self.values[cell % 32]) * 32 / (2.0 * np.pi)
        now.lead += now.ratio * float(hats(now.seen.input_angle) @ self.values)
        now.lead_rate += now.ratio * float(slope) * self.speed

    def learn(self, now: Instant, motor_torque: float) -> None:
        law = self.law
        if not law.min_speed <= abs(self.speed) < law.max_speed:
            return
        even = 0.5 * (np.roll(self.values, 1) + np.roll(self.values, -1))
        moved = law.gain * now.error * hats(now.seen.input_angle - self.speed * law.lag)
        moved -= law.smoothing * hats(now.seen.input_angle) * (self.values - even)
        self.values = np.clip(self.values + now.period * moved, -law.limit, law.limit)


@dataclass
class IterativeLearning:
    law: sw.compensation.IterativeLearning
    tables: Array = field(default_factory=lambda: np.zeros((2, 32)))  # of forward and of backward motion
    angle: float | None = None
    sense: float = 0.0
    speed: float = 0.0

    @property
    def angles(self) -> Array:
        return np.linspace(self.law.low, self.law.high, 32)

    @property
    def shares(self) -> Array:
        """Shares of the forward and the backward table in the lead."""
        return 0.5 * (1.0 + np.array([self.sense, -self.sense]))

    def add(self, now: Instant) -> None:
        law, at, rate = self.law, now.seen.command, now.seen.command_rate
        self.speed = now.speed
        moved = 0.0 if self.angle is None else at - self.angle
        if moved != 0.0:
            self.sense = np.sign(moved) + (self.sense - np.sign(moved)) * np.exp(-abs(moved) / law.reach)
        self.angle = at
        forward, backward = (float(np.interp(at, self.angles, table)) for table in self.tables)
        now.lead += now.ratio * float(self.shares @ [forward, backward])
        cell = int(np.searchsorted(self.angles, at)) - 1
        if 0 <= cell < 31:
            slopes = np.diff(self.tables)[:, cell] / np.diff(self.angles)[cell]
            now.lead_rate += now.ratio * float(self.shares @ slopes) * rate
        now.lead_rate += now.ratio * 0.5 * (forward - backward) * (np.sign(rate) - self.sense) * abs(rate) / law.reach

    def learn(self, now: Instant, motor_torque: float) -> None:
        law, at = self.law, now.seen.command
        if not (law.low <= at <= law.high and law.min_speed <= abs(self.speed) < law.max_speed):
            return
        source = at - now.seen.command_rate * law.lag
        hat = np.array([np.interp(at, self.angles, row) for row in np.eye(32)])
        late = np.array([np.interp(source, self.angles, row) for row in np.eye(32)]) * (law.low <= source <= law.high)
        even = 0.5 * (
            np.pad(self.tables, ((0, 0), (1, 1)), mode="edge")[:, :-2]
            + np.pad(self.tables, ((0, 0), (1, 1)), mode="edge")[:, 2:]
        )
        width = (law.high - law.low) / 31
        rate = min(law.gain, abs(now.seen.command_rate) / width, 1.0 / now.period)
        moved = rate * late * now.error - law.smoothing * hat * (self.tables - even)
        self.tables = np.clip(self.tables + now.period * self.shares[:, None] * moved, -law.limit, law.limit)


@dataclass
class TwistIdentification:
    """A Kalman filter in its textbook form: of the numbers that are adapted, given the uncertainty of the others."""

    law: sw.compensation.TwistIdentification
    torsion: float = 0.0
    torsion_rate: float = 0.0
    ahead: float = 0.0
    speed: float = 0.0
    begun: bool = False
    time: float = 0.0

    def __post_init__(self) -> None:
        law = self.law
        self.prior = np.array([law.compliance_prior, law.offset_prior] + 2 * len(law.order) * [law.amplitude_prior])
        self.x, self.p = np.zeros(self.prior.size), np.diag(self.prior**2)
        self.mean, self.variance = np.zeros(self.prior.size), np.zeros(self.prior.size)

    def waves(self, angle: float) -> Array:
        """Sine and cosine of each order, one after the other."""
        order = np.array(self.law.order)
        return np.column_stack([np.sin(order * angle), np.cos(order * angle)]).ravel()

    def add(self, now: Instant) -> None:
        at, self.speed, self.ahead, torsion = now.seen.input_angle, now.speed, now.lead, now.torsion
        turned = np.array([[0.0, 1.0], [-1.0, 0.0]])  # a sin + b cos has the rate n (a cos - b sin)
        rates = np.repeat(self.law.order, 2) * self.speed * (self.x[2:].reshape(-1, 2) @ turned).ravel()
        now.lead += self.x[0] * torsion + now.ratio * float(self.x[2:] @ self.waves(at))
        now.lead_rate += self.x[0] * self.torsion_rate + now.ratio * float(rates @ self.waves(at))
        now.torsion += self.x[0] * torsion
        if self.begun:
            self.next_rate = (torsion - self.torsion) / now.period
        else:
            self.next_rate = 0.0
        self.torsion, self.begun = torsion, True

    def learn(self, now: Instant, motor_torque: float) -> None:
        law, dt = self.law, now.period
        self.torsion_rate = self.next_rate
        if abs(self.speed) < law.min_speed:
            return
        phi = np.array([self.torsion / now.ratio, 1.0, *self.waves(now.seen.input_angle)])
        z = (now.seen.input_angle - self.ahead) / now.ratio - now.seen.output_angle
        share = dt / (self.time + dt)
        apart = phi - self.mean
        self.mean, self.variance = self.mean + share * apart, (1.0 - share) * (self.variance + share * apart**2)
        self.variance[1] = 1.0
        self.time = min(self.time + dt, law.window)
        active = self.variance * self.prior**2 >= law.min_excitation * law.noise**2 * law.noise_time
        kept = np.where(active, np.sqrt(1.0 / (1.0 + 2.0 * dt / law.memory)), 1.0)
        self.x = kept * self.x
        e = z - phi @ self.x
        self.p = np.outer(kept, kept) * self.p + np.diag((1.0 - kept**2) * self.prior**2)
        cross = self.p @ phi
        inside = phi @ cross + law.noise**2 * law.noise_time / dt
        gain = active * cross / inside
        self.p += np.outer(gain, gain) * inside - np.outer(gain, cross) - np.outer(cross, gain)
        self.x = np.clip(self.x + gain * e, -law.limit * self.prior, law.limit * self.prior)


@dataclass
class DisturbanceObserver:
    law: sw.compensation.DisturbanceObserver
    filtered: float = 0.0
    expected: float = 0.0
    momentum: float = 0.0

    def add(self, now: Instant) -> None:
        law = self.law
        self.expected = now.torque
        self.momentum = law.bandwidth * law.inertia * (now.seen.input_speed - now.speed)
        now.torque += float(np.clip(self.filtered - self.momentum, -law.limit, law.limit))

    def learn(self, now: Instant, motor_torque: float) -> None:
        law = self.law
        torque = law.torque_constant * now.seen.current if law.torque_constant else motor_torque
        towards = torque - self.expected + self.momentum
        self.filtered = towards + float(np.exp(-law.bandwidth * now.period)) * (self.filtered - towards)


@dataclass
class FrictionScale:
    law: sw.compensation.FrictionScale
    scale: float = 1.0
    modelled: float = 0.0

    def add(self, now: Instant) -> None:
        self.modelled = now.friction
        now.torque += (self.scale - 1.0) * now.friction
        now.friction *= self.scale

    def learn(self, now: Instant, motor_torque: float) -> None:
        law = self.law
        if abs(now.speed) >= law.min_speed:
            error = now.speed - now.seen.input_speed
            error += law.position_gain * (now.ratio * now.seen.command + now.lead - now.seen.input_angle)
            moved = law.gain * self.modelled * error * now.period
            self.scale = float(np.clip(self.scale + moved, law.min_scale, law.max_scale))


@dataclass
class BristleObserver:
    """With a LuGre law of constant bristle damping."""

    law: sw.compensation.BristleObserver
    deflection: float = 0.0
    scale: float = 1.0
    torque: float = 0.0

    def reach(self, speed: float) -> float:
        """Deflection in steady sliding [rad]."""
        lugre: Any = self.law.friction
        excess = (lugre.breakaway - lugre.coulomb) * np.exp(-((speed / lugre.stribeck_speed) ** 2))
        return float((lugre.coulomb + excess) / lugre.bristle_stiffness)

    def add(self, now: Instant) -> None:
        lugre: Any = self.law.friction
        speed = now.seen.input_speed
        rate = speed - abs(speed) * self.deflection / self.reach(speed)
        self.torque = lugre.bristle_stiffness * self.deflection + lugre.bristle_damping * rate + lugre.viscous * speed
        supplied = self.law.friction_share * self.scale * self.torque
        now.torque += supplied - now.friction
        now.friction = supplied

    def learn(self, now: Instant, motor_torque: float) -> None:
        law = self.law
        error = now.speed - now.seen.input_speed
        error += law.position_gain * (now.ratio * now.seen.command + now.lead - now.seen.input_angle)
        bending = now.seen.input_speed + law.bristle_gain * error
        slid, reach = bending * now.period, self.reach(bending)
        steady = np.sign(bending) * reach
        self.deflection = float(steady + (self.deflection - steady) * np.exp(-abs(slid) / reach))
        if abs(now.speed) >= law.min_speed:
            moved = law.gain * law.friction_share * self.torque * error * now.period
            self.scale = float(np.clip(self.scale + moved, law.min_scale, law.max_scale))


@dataclass
class Dither:
    law: sw.compensation.Dither
    turns: float = 0.0

    def add(self, now: Instant) -> None:
        sense = np.sign(now.ratio * now.seen.command_rate)
        now.torque += float(sense * self.law.amplitude * np.sin(2.0 * np.pi * self.turns))
        self.turns += abs(sense) * self.law.frequency * now.period

    def learn(self, now: Instant, motor_torque: float) -> None: ...


@dataclass
class DryFriction:
    """A feed-forward of Coulomb's friction at the input of a rigid gear, and of nothing else."""

    coulomb: float
    presliding: float
    sense: float = 0.0

    def add(self, now: Instant) -> None:
        now.friction += self.coulomb * self.sense
        now.torque += self.coulomb * self.sense
        moved = now.ratio * now.seen.command_rate * now.period
        if moved != 0.0:
            self.sense = np.sign(moved) + (self.sense - np.sign(moved)) * np.exp(-abs(moved) / self.presliding)

    def learn(self, now: Instant, motor_torque: float) -> None: ...


@dataclass
class Compensated:
    """A PID with a limit, and what compensates around it.

    Attributes:
        law: the PID, on the input
        part: what is added, for the factors of torque and speed
        compensators: in the order in which they are asked
    """

    law: sw.control.PID
    part: sw.Compensation
    compensators: list[Any]
    ratio: float
    period: float

    def __call__(self, seen: sw.simulation.Observation) -> float:
        now = Instant(seen, self.ratio, self.period)
        for compensator in self.compensators:
            compensator.add(now)
        per_torque, per_speed = self.part.actuation_per_torque, self.part.actuation_per_speed
        asked = self.law.proportional * (self.ratio * seen.command + now.lead - seen.input_angle)
        asked += self.law.derivative * (now.speed - seen.input_speed)
        asked += per_torque * now.torque + per_speed * now.speed
        actuation = float(np.clip(asked, -self.law.limit, self.law.limit))
        for compensator in self.compensators:
            compensator.learn(now, (actuation - per_speed * seen.input_speed) / per_torque)
        return actuation
