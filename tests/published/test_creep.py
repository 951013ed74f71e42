"""Document P's drive at the edge of motion: what holds it, and how it sticks and slips when it creeps.

A mass on a spring that is drawn at constant speed v, with dry friction and damping: it sets off at the breakaway level. With z
its way from where it would slide steadily, J z'' + c z' + k z = 0 from z = -(F_s - F_c - c v) / k and z' = -v, until its speed
v + z' is zero again. If that never happens, it slides on. While it sticks z falls as v t, back to where it set off.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
import pytest
import strainwave as sw
from hypothesis import assume, given, settings, strategies as st
from numpy.typing import NDArray
from scipy.optimize import brentq

from tests.support.samples import sample

COULOMB, BREAKAWAY = 0.072, 1.0388 * 0.072  # N.m, Table 1 and the static friction
RESISTANCE, CONSTANT = 2.0, 0.05  # Ohm, N.m/A
LEVEL = RESISTANCE * BREAKAWAY / CONSTANT  # V
SET = sw.load("position-drive")
FULL = sw.load("position-drive-full-friction")


# What holds it


@pytest.mark.parametrize("drive", [SET, FULL], ids=["simplified", "full friction"])
@pytest.mark.parametrize("sense", [1.0, -1.0])
def test_nothing_of_the_drive_moves_below_its_breakaway_voltage(drive: sw.Drive, sense: float) -> None:
    """By no method, though its current rises: 2.991744 V, at angle 0 with the full friction as well."""
    assert pytest.approx(2.991744, rel=1e-15) == LEVEL
    opened = drive.replace(control=sw.control.OpenLoop())
    below = sw.scenario.constant(sense * 2.9917, 0.1)
    still = ["input_angle", "input_speed", "output_angle", "output_speed", "twist", "torque"]
    inertias = {"load.inertia": [0.005, 0.01]}
    runs = [
        sw.simulate(opened, below, dt=1e-3),
        sw.simulate(opened, below, method="moreau_jean"),
        sw.simulate_adaptively(opened, below, sample=1e-3),
        sw.simulate_many(opened, below, inertias, record=[*still, "current", "friction_input"]).member(1),
    ]
    for run in runs:
        assert not any(run[name].any() for name in still)
        assert run["current"][-1] == pytest.approx(sense * 2.9917 / RESISTANCE, rel=1e-12)
        assert abs(run["friction_input"][-1]) < BREAKAWAY


@pytest.mark.parametrize("over", [1e-6, 1e-3, 0.1])
def test_just_above_it_the_drive_sets_off_once_its_current_suffices(over: float) -> None:
    """i = (u / R) (1 - exp(-R t / L)) reaches the breakaway level at (L / R) ln(u / (u - u_b))."""
    voltage = LEVEL * (1.0 + over)
    set_off = 0.0027 / RESISTANCE * math.log(voltage / (voltage - LEVEL))
    opened = SET.replace(control=sw.control.OpenLoop())

    def moves(time: float) -> bool:
        run = sw.simulate(opened, sw.scenario.constant(voltage, time), dt=1e-4, sample=time)
        return bool(run["input_angle"][-1] > 0.0)

    assert not moves(set_off * (1.0 - 1e-6))
    assert moves(set_off + 1e-4)
    later = sw.simulate(opened, sw.scenario.constant(voltage, 1.0))
    assert later["input_speed"][-1] > 0.0
    assert later["output_angle"][-1] > 0.0


# Stick and slip


@dataclass(frozen=True)
class Creep:
    """The closed form."""

    inertia: float
    k: float
    damping: float  # all that damps
    level: float  # of kinetic friction
    breakaway: float
    speed: float
    lead: float = 0.0  # what a damper that is drawn along adds to the spring's torque at standstill

    @property
    def start(self) -> float:
        """z at which it sets off."""
        return -(self.breakaway - self.level - self.damping * self.speed) / self.k

    @property
    def first_breakaway(self) -> float:
        return (self.breakaway - self.lead) / (self.k * self.speed)

    def way(self, time: float | NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """z and its rate."""
        decay = 0.5 * self.damping / self.inertia
        w = math.sqrt(self.k / self.inertia - decay**2)
        a, b = self.start, (-self.speed + decay * self.start) / w
        fall, c, s = np.exp(-decay * time), np.cos(w * time), np.sin(w * time)
        return fall * (a * c + b * s), fall * ((b * w - decay * a) * c - (a * w + decay * b) * s)

    @property
    def slowest(self) -> float:
        """The least speed that it comes down to while it slides, in its first swing; negative where it sticks before."""
        period = 2.0 * math.pi / math.sqrt(self.k / self.inertia - 0.25 * (self.damping / self.inertia) ** 2)
        time = np.linspace(0.25 * period, 1.25 * period, 4001)
        return float((self.way(time)[1] + self.speed).min())

    @property
    def slipping(self) -> float:
        """How long it slips."""
        period = 2.0 * math.pi / math.sqrt(self.k / self.inertia - 0.25 * (self.damping / self.inertia) ** 2)
        time = np.linspace(0.0, 1.25 * period, 4001)[1:]
        down = np.flatnonzero(self.way(time)[1] + self.speed < 0.0)[0]
        return brentq(lambda t: float(self.way(t)[1]) + self.speed, time[down - 1], time[down], xtol=1e-16, rtol=1e-15)

    @property
    def sticking(self) -> float:
        return (float(self.way(self.slipping)[0]) - self.start) / self.speed

    @property
    def period(self) -> float:
        return self.slipping + self.sticking

    def critical(self) -> float:
        """The speed beyond which it slides on."""
        return brentq(lambda speed: replace(self, speed=speed).slowest, 0.01 * self.speed, 1e3 * self.speed)


def motor_creep(derivative: float, speed: float) -> Creep:
    """The motor under a PD controller: a spring K_m k_p / R and a damper K_m k_d / R to the command, and its own damping."""
    drawn = CONSTANT * derivative / RESISTANCE
    return Creep(
        inertia=0.0012,
        k=CONSTANT * 20.0 / RESISTANCE,
        damping=4e-4 + CONSTANT**2 / RESISTANCE + drawn,
        level=COULOMB,
        breakaway=BREAKAWAY,
        speed=speed,
        lead=drawn * speed,
    )


def load_creep(speed: float) -> Creep:
    """The load on the spring of the gear, drawn by a motor of constant speed."""
    return Creep(inertia=0.005, k=150.0, damping=1e-3, level=0.18, breakaway=0.186984, speed=speed)


def motor_run(creep: Creep, derivative: float, duration: float) -> sw.Recording:
    """The gear is so soft that the load stays out of it, and the current follows at once."""
    law = SET.control.replace(derivative=derivative)
    gear = SET.gear.replace(stiffness=sw.stiffness.Linear(k=1e-30), friction_output=sw.friction.Viscous())
    drive = SET.replace(gear=gear, motor=SET.motor.replace(inductance=0.0), control=law)
    return sw.simulate(drive, sw.scenario.ramp(creep.speed / 100.0, duration), sample=1e-3)


def load_run(creep: Creep, duration: float, dt: float = 2e-4) -> sw.Recording:
    gear = SET.gear.replace(
        stiffness=sw.stiffness.Linear(k=creep.k),
        friction_input=sw.friction.Viscous(),
        friction_output=sw.friction.Coulomb(coulomb=creep.level, breakaway=creep.breakaway, viscous=creep.damping),
    )
    drive = sw.Drive(gear=gear, motor=sw.motor.TorqueSource(inertia=1e30), load=sw.loads.Inertia(inertia=creep.inertia))
    start = {"input_speed": 100.0 * creep.speed, "output_speed": 0.0, "twist": 0.0}
    return sw.simulate(drive, sw.scenario.constant(0.0, duration), dt, sample=5.0 * dt, initial=start)


def plateaus(angle: NDArray[np.float64], speed: NDArray[np.float64]) -> NDArray[np.float64]:
    """Angles at which it sticks, in order."""
    still = speed == 0.0
    begins = np.flatnonzero(still[1:] & ~still[:-1]) + 1
    return angle[np.concatenate([[0], begins])] if still[0] else angle[begins]


@pytest.mark.parametrize(("derivative", "speed"), [(0.0, 0.02), (0.0, 0.1), (0.1, 0.05), (0.8, 0.01)])
def test_a_motor_that_creeps_sticks_and_slips_as_its_closed_form(derivative: float, speed: float) -> None:
    """Where it sticks after each slip, over some cycles, and how often."""
    creep = motor_creep(derivative, speed)
    duration = creep.first_breakaway + 4.5 * creep.period
    run = motor_run(creep, derivative, duration)
    found = plateaus(run["input_angle"], run["input_speed"])
    cycles = int((duration - creep.first_breakaway - creep.slipping) / creep.period) + 1
    assert len(found) == cycles + 1
    assert found == pytest.approx(speed * creep.period * np.arange(cycles + 1), rel=1e-7, abs=1e-12)
    moving = run.time[run["input_angle"] > 0.0][0]
    assert creep.first_breakaway < moving <= creep.first_breakaway + 2e-3


@pytest.mark.parametrize("speed", [1e-3, 5e-3, 0.02])
def test_a_load_that_is_drawn_slowly_sticks_and_slips_as_its_closed_form(speed: float) -> None:
    creep = load_creep(speed)
    duration = creep.first_breakaway + 6.5 * creep.period
    run = load_run(creep, duration)
    found = plateaus(run["output_angle"], run["output_speed"])
    cycles = int((duration - creep.first_breakaway - creep.slipping) / creep.period) + 1
    assert len(found) == cycles + 1
    assert found == pytest.approx(speed * creep.period * np.arange(cycles + 1), rel=1e-7, abs=1e-12)


@given(
    st.floats(1e-3, 1.0),
    st.floats(5.0, 300.0),
    st.floats(0.0, 0.3),
    st.floats(0.1, 5.0),
    st.floats(0.05, 1.0),
    st.floats(0.05, 0.9),
)
@settings(max_examples=sample(10, 25))
def test_whatever_is_drawn_slowly_sticks_and_slips_as_its_closed_form(
    inertia: float, w: float, damping_ratio: float, level: float, excess: float, share: float
) -> None:
    """Of any inertia, spring, damping and friction, at any share of its critical speed."""
    k = inertia * w * w
    creep = Creep(inertia, k, 2.0 * damping_ratio * inertia * w, level, (1.0 + excess) * level, excess * level / (k / w))
    scale = min(1.0, creep.critical() / creep.speed) if creep.slowest > 0.0 else 1.0
    creep = replace(creep, speed=share * scale * creep.speed)
    assume(creep.sticking > 0.2 / w)  # two samples
    duration = creep.first_breakaway + 3.5 * creep.period
    run = load_run(creep, duration, dt=0.02 / w)
    found = plateaus(run["output_angle"], run["output_speed"])
    cycles = int((duration - creep.first_breakaway - creep.slipping) / creep.period) + 1
    assert len(found) == cycles + 1
    assert found == pytest.approx(creep.speed * creep.period * np.arange(cycles + 1), rel=1e-6, abs=1e-12)


@pytest.mark.parametrize("derivative", [0.0, 0.1, 0.8])
def test_beyond_its_critical_speed_a_motor_slides_on(derivative: float) -> None:
    critical = motor_creep(derivative, 0.02).critical()
    for share, sticks in ((0.98, True), (1.02, False)):
        creep = motor_creep(derivative, share * critical)
        run = motor_run(creep, derivative, creep.first_breakaway + 3.0)
        assert (len(plateaus(run["input_angle"], run["input_speed"])) > 1) == sticks


def test_beyond_its_critical_speed_a_load_slides_on() -> None:
    """Some 0.1 rad/s: little damps it, so each swing is nearly as large as the one before."""
    critical = load_creep(0.02).critical()
    assert 0.05 < critical < 0.2
    for share, sticks in ((0.98, True), (1.02, False)):
        creep = load_creep(share * critical)
        run = load_run(creep, creep.first_breakaway + 1.0)
        assert (len(plateaus(run["output_angle"], run["output_speed"])) > 1) == sticks


@pytest.mark.slow("physics")
@pytest.mark.parametrize("drive", [SET, FULL], ids=["simplified", "full friction"])
def test_the_whole_drive_creeps_by_sticking_and_slipping(drive: sw.Drive) -> None:
    """At 0.1 mrad/s of the output both sides do; at 5 mrad/s the motor slides, and the load still does, at its own pace."""
    slow = sw.simulate(drive, sw.scenario.ramp(1e-4, 40.0), sample=1e-3)
    assert len(plateaus(slow["input_angle"], slow["input_speed"])) > 10
    assert len(plateaus(slow["output_angle"], slow["output_speed"])) > 10
    assert np.all(slow["input_speed"] >= 0.0)
    faster = sw.simulate(drive, sw.scenario.ramp(5e-3, 6.0), sample=1e-3).between(1.0, 6.0)
    assert np.all(faster["input_speed"] > 0.0)
    sticks = plateaus(faster["output_angle"], faster["output_speed"])
    period = (sticks[-1] - sticks[0]) / (len(sticks) - 1) / 5e-3
    assert period == pytest.approx(load_creep(5e-3).period, rel=0.01)
