"""A spring that is stiffer in one sense: closed forms, the period of its free vibration, and what surrounds it."""

from __future__ import annotations

import math

import numpy as np
import pytest
import strainwave as sw
from strainwave.export.elements import GearElements
from strainwave.stiffness import Asymmetric, Backlash, Cubic, Linear, MultiCompliance, ThreeSegment

from tests.support.strategies import made

K, FACTOR, ARM = 1e4, 0.64, 0.5
SPRING = Asymmetric(law=Linear(k=K), negative_factor=FACTOR)


def test_each_sense_is_a_line_of_its_own_through_zero() -> None:
    twist = np.array([-1e-3, -1e-4, 0.0, 1e-4, 1e-3])
    assert SPRING.torque(twist) == pytest.approx([-6.4, -0.64, 0.0, 1.0, 10.0], rel=1e-15)
    assert SPRING.tangent(twist).tolist() == [6400.0, 6400.0, K, K, K]
    assert SPRING.energy(twist) == pytest.approx([3.2e-3, 3.2e-5, 0.0, 5e-5, 5e-3], rel=1e-15)
    assert SPRING.twist([-6.4, 0.0, 10.0]) == pytest.approx([-1e-3, 0.0, 1e-3], rel=1e-15)


def test_knees_stay_at_their_twists() -> None:
    law = ThreeSegment(k1=8e3, k2=11e3, k3=14e3, t1=1.0, t2=4.0)
    spring = Asymmetric(law=law, negative_factor=2.0)
    assert spring.twist([-2.0, -8.0]) == pytest.approx([-law.twist(1.0), -law.twist(4.0)], rel=1e-15)


def test_factor_1_is_the_spring_itself_and_none_below_0_is_taken() -> None:
    law = Cubic(a1=1e4, a3=1e9)
    spring, twist = Asymmetric(law=law, negative_factor=1.0), np.linspace(-1e-3, 1e-3, 7)
    for verb in ("torque", "tangent", "energy"):
        assert getattr(spring, verb)(twist).tolist() == getattr(law, verb)(twist).tolist()
    with pytest.raises(ValueError, match=r"asymmetric\.negative_factor = 0 "):
        Asymmetric(law=law, negative_factor=0.0)


def test_its_bound_is_that_of_its_spring() -> None:
    spring = Asymmetric(law=made(MultiCompliance), negative_factor=0.5)
    with pytest.raises(ValueError, match=r"asymmetric: twist = .* lies outside of \[-0\.01315"):
        spring.torque(1.0)


def test_half_a_period_belongs_to_each_sense() -> None:
    """An arm on the spring with the input held: pi sqrt(J) (1/sqrt(k) + 1/sqrt(f k)), whatever the amplitude is."""
    gear = sw.Gear(kinematics=sw.kinematics.PlainRatio(reduction=100.0), stiffness=SPRING)
    motor = sw.motor.TorqueSource(inertia=1e6)  # as heavy as a wall
    drive = sw.Drive(gear=gear, motor=motor, load=sw.loads.Inertia(inertia=ARM), meter=sw.meter.EnergyMeter())
    period = math.pi * math.sqrt(ARM / K) * (1.0 + 1.0 / math.sqrt(FACTOR))
    start = drive.rest().replace(output_speed=-0.05)
    run = sw.simulate_adaptively(drive, sw.scenario.constant(0.0, 4.0 * period), 1e-10, initial=start, sample=1e-5)
    upwards = np.flatnonzero((run["twist"][:-1] < 0.0) & (run["twist"][1:] >= 0.0))
    share = run["twist"][upwards] / (run["twist"][upwards] - run["twist"][upwards + 1])
    crossings = run.time[upwards] + 1e-5 * share
    assert np.diff(crossings) == pytest.approx(period, rel=1e-5)  # an adaptive step reaches over the kink
    assert run["twist"].max() / -run["twist"].min() == pytest.approx(math.sqrt(FACTOR), rel=1e-5)  # equal energies


def test_play_may_lie_before_it_and_an_export_takes_the_mean() -> None:
    spring = Backlash(law=SPRING, clearance=2e-4)
    assert spring.torque([-1.1e-3, 0.0, 1.1e-3]) == pytest.approx([-6.4, 0.0, 10.0], rel=1e-14)
    (mean,) = GearElements.of(sw.Gear(stiffness=SPRING), 1e-4, 10.0, 200.0).springs
    assert mean.linear == pytest.approx(0.5 * (K + FACTOR * K), rel=1e-15)
