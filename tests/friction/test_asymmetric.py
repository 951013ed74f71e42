"""Friction larger one way than the other: levels by direction, stick and breakaway by the direction that it is pushed in."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
import strainwave as sw
from hypothesis import given, strategies as st
from strainwave import _core
from strainwave.friction import Asymmetric, Coulomb, LuGre, MaxwellSlipFriction, Stribeck, Viscous

from tests.support.strategies import built, log_uniform, made

shares = st.floats(-1.0, 1.0)
speeds = log_uniform(1e-3, 1e3)
MOTOR = sw.motor.TorqueSource(inertia=1e-3)


@given(speeds, shares, shares)
def test_each_direction_has_levels_of_its_own(speed: float, dry: float, viscous: float) -> None:
    law = Asymmetric(law=Coulomb(coulomb=0.3, breakaway=0.4, viscous=0.02), dry_asymmetry=dry, viscous_asymmetry=viscous)
    assert law.steady(speed) == pytest.approx(0.3 * (1.0 + dry) + 0.02 * (1.0 + viscous) * speed, rel=1e-12)
    assert -law.steady(-speed) == pytest.approx(0.3 * (1.0 - dry) + 0.02 * (1.0 - viscous) * speed, rel=1e-12)
    assert [law.hold(1.0), law.hold(-1.0)] == pytest.approx([0.4 * (1.0 + dry), 0.4 * (1.0 - dry)], rel=1e-12)


def test_one_number_scales_the_whole_curve() -> None:
    law = Asymmetric(law=Stribeck(coulomb=0.03, breakaway=0.05, stribeck_speed=2.0, viscous=1e-3), dry_asymmetry=0.2)
    assert law.viscous_asymmetry == 0.2
    speed = np.geomspace(0.01, 100.0, 20)
    assert -law.steady(speed) / law.steady(-speed) == pytest.approx(np.full(20, 1.2 / 0.8), rel=1e-12)


@given(st.sampled_from([kind for kind in _core.families["friction"].values() if kind.name in ("coulomb", "stribeck", "lugre",
       "maxwell_slip_friction", "viscous", "curved_viscous")]), st.data(), speeds)  # fmt: skip
def test_no_asymmetry_is_the_law_itself(kind: type[Any], data: st.DataObject, speed: float) -> None:
    law = data.draw(built(kind))
    same = Asymmetric(law=law)
    time, path = [0.0, 0.1, 0.2, 0.3], [speed, -speed, 0.3 * speed, -speed]
    assert same.trace(time, path).tolist() == law.trace(time, path).tolist()
    assert same.hold(-1.0) == law.hold(-1.0)


@pytest.mark.parametrize("law", [LuGre(coulomb=0.03, breakaway=0.05, stribeck_speed=2.0, bristle_stiffness=50.0,
                                       bristle_damping=0.0, viscous=1e-4),
                                 MaxwellSlipFriction(stiffness=[60.0, 20.0], share=[0.5, 0.5], coulomb=0.03,
                                                     stribeck_speed=2.0, attraction=0.3)])  # fmt: skip
@given(data=st.data(), asymmetry=st.floats(-0.9, 0.9))
def test_any_closed_path_of_a_bristle_takes_work(law: Any, data: st.DataObject, asymmetry: float) -> None:
    """From rest on, work taken less what the bristles can store at most is none; here also small motion about the reversal."""
    steps = np.array(data.draw(st.lists(st.floats(-3e-3, 3e-3), min_size=5, max_size=40)))
    path = np.append(0.0, np.cumsum(np.repeat(steps / 40.0, 40)))
    torque = Asymmetric(law=law, dry_asymmetry=asymmetry).quasistatic(path)
    work = np.cumsum(0.5 * (torque[1:] + torque[:-1]) * np.diff(path))
    assert work.min() >= -2e-3 * np.abs(torque).max() * np.abs(np.diff(path)).max() * len(path)


def driven(law: Any, torque: float) -> sw.Recording:
    """A free input under a constant motor torque."""
    gear = sw.Gear(
        kinematics=sw.kinematics.PlainRatio(reduction=1.0),
        stiffness=sw.stiffness.Linear(k=1e-9),
        damping=0.0,
        friction_input=law,
    )
    drive = sw.Drive(gear=gear, motor=MOTOR, control=sw.control.OpenLoop(), load=sw.loads.Inertia(inertia=1.0))
    return sw.simulate(drive, sw.scenario.constant(torque, duration=0.2), sample=0.05)


@pytest.mark.parametrize(("torque", "speed"), [(0.35, 0.0), (0.37, 10.0), (-0.24, 0.0), (-0.26, -16.0)])
def test_a_shaft_breaks_away_one_way_sooner_and_slides_with_that_way_s_friction(torque: float, speed: float) -> None:
    """Breakaway 0.36 and 0.24, Coulomb 0.32 and 0.18 (dry mean 0.25, static 0.3): J w' = T - F."""
    dry = 0.2
    law = Asymmetric(law=Coulomb(coulomb=0.25, breakaway=0.3), dry_asymmetry=dry)
    found = driven(law, torque)["input_speed"][-1]
    kinetic = 0.25 * (1.0 + dry * np.sign(torque))
    wanted = 0.0 if speed == 0.0 else (abs(torque) - kinetic) / 1e-3 * 0.2 * np.sign(torque)
    assert found == pytest.approx(wanted, rel=1e-6, abs=0.0)


def test_a_coast_stops_where_its_direction_s_friction_has_taken_its_energy() -> None:
    """Angle to the stop: J w0^2 / (2 F) with the F of the direction."""
    law = Asymmetric(law=Coulomb(coulomb=0.25), dry_asymmetry=0.4)
    gear = sw.Gear(
        kinematics=sw.kinematics.PlainRatio(reduction=1.0),
        stiffness=sw.stiffness.Linear(k=1e-9),
        damping=0.0,
        friction_input=law,
    )
    drive = sw.Drive(gear=gear, motor=MOTOR, control=sw.control.OpenLoop(), load=sw.loads.Inertia(inertia=1.0))
    for sense in (1.0, -1.0):
        start = {"input_speed": 20.0 * sense}
        run = sw.simulate(drive, sw.scenario.constant(0.0, duration=0.3), sample=0.1, initial=start)
        turned = run["input_angle"][-1] - run["input_angle"][0]
        assert turned == pytest.approx(sense * 1e-3 * 400.0 / (2.0 * 0.25 * (1.0 + 0.4 * sense)), rel=1e-6)
        assert run["input_speed"][-1] == 0.0


def test_an_efficiency_that_turns_round_cannot_be_asymmetric() -> None:
    with pytest.raises(TypeError, match=r"must be one of .*, not TorqueEffic"):
        Asymmetric(law=made(sw.friction.TorqueEfficiency))


def test_viscous_friction_alone_can_be_asymmetric() -> None:
    law = Asymmetric(law=Viscous(viscous=0.5), viscous_asymmetry=0.5)
    assert law.steady([2.0, -2.0]).tolist() == [1.5, -0.5]
    assert not law.set_valued
