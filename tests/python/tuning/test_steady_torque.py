"""Torque at constant speed: against the equations of the drive, as the feed-forward of a model solves them."""

from __future__ import annotations

import numpy as np
import pytest
import strainwave as sw
from strainwave.tuning.cascade import steady_torque

GEAR = sw.Gear(
    kinematics=sw.kinematics.StrainWave(flexspline_teeth=200, circular_spline_teeth=202, fixed="circular_spline"),
    kinematic_error=sw.kinematic_error.Scaled(
        law=sw.kinematic_error.Fourier(order=[1.0, 2.0], amplitude=[8e-5, 3e-4], phase=[0.4, 1.0]), load_sensitivity=0.01
    ),
    stiffness=sw.stiffness.Linear(k=1e9),
    friction_input=sw.friction.Coulomb(coulomb=0.03, viscous=2e-4),
    friction_mesh=sw.friction.LoadDependent(
        driving_forward=0.04, driving_reverse=0.05, backdriving_forward=0.06, backdriving_reverse=0.07
    ),
    friction_output=sw.friction.Stribeck(coulomb=1.0, breakaway=1.5, stribeck_speed=0.01),
)


@pytest.mark.parametrize("speed", [2.0, -2.0])
@pytest.mark.parametrize("load", [20.0, -20.0])
def test_it_is_what_a_model_feeds_forward_along_a_slow_motion(speed: float, load: float) -> None:
    ratio, period = GEAR.kinematics.ratio, 1e-3
    held = sw.loads.TorqueTable(inertia=1e-9, angle=[0.0], held_torque=[load])
    law = sw.compensation.ModelFeedforward(gear=GEAR, load=held, rounds=8)
    angle = speed / ratio * period * np.arange(3000)
    lead, lead_rate, torque, resisting = (
        each[1000:] for each in law.requests(angle, np.full(angle.size, speed / ratio), ratio, period)
    )
    at, turning = ratio * angle[1000:] + lead, speed + lead_rate
    found = steady_torque(GEAR, turning, at, load)
    assert found.friction == pytest.approx(resisting, rel=1e-6)
    assert found.reaction + load / ratio == pytest.approx(torque - resisting, rel=1e-6)


def test_a_law_that_is_not_symmetric_follows_the_sense_of_its_shaft() -> None:
    law = sw.friction.Asymmetric(law=sw.friction.Coulomb(coulomb=2.0), dry_asymmetry=0.5)
    forward, backward = float(law.steady(1.0)), float(law.steady(-1.0))
    assert forward != -backward
    gear = sw.Gear(kinematics=GEAR.kinematics, friction_output=law)
    assert steady_torque(gear, [10.0, -10.0]).friction == pytest.approx([-0.01 * backward, -0.01 * forward])
