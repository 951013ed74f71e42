"""A gear in elements: exact where its laws are elements, else with the loss that is stated."""

from itertools import pairwise

import numpy as np
import pytest
import strainwave as sw
from hypothesis import given, strategies as st
from strainwave.export.elements import GearElements, Spring, friction_losses
from strainwave.tuning.loss import ExportLoss

from tests.support.strategies import made

hysteresis, stiffness = sw.hysteresis, sw.stiffness
MAX_TORQUE, MAX_SPEED = 40.0, 200.0

springs = st.one_of(
    st.builds(stiffness.Linear, k=st.floats(1e3, 1e5)),
    st.builds(stiffness.Cubic, a1=st.floats(1e3, 1e5), a3=st.floats(0.0, 1e10)),
    st.builds(stiffness.Piecewise, k1=st.floats(1e3, 1e5), k2=st.floats(0.0, 1e5), knee=st.floats(1e-4, 2e-3)),
)
slips = st.lists(st.tuples(st.floats(1e2, 1e4), st.floats(0.05, 1.0)), max_size=4).map(
    lambda pairs: hysteresis.MaxwellSlip(stiffness=[k for k, _ in pairs], breakaway=[f for _, f in pairs])
)


def elements(gear: sw.Gear) -> GearElements:
    return GearElements.of(gear, 1e-4, MAX_TORQUE, MAX_SPEED)


def torsion_losses(law) -> list[ExportLoss]:
    gear = sw.Gear(hysteresis=law)
    found = elements(gear)
    return list(found.torsion_losses(gear, float(gear.stiffness.twist(MAX_TORQUE))))


def friction_share(gear: sw.Gear) -> float:
    (loss,) = friction_losses(gear, MAX_SPEED, elements(gear).friction)
    return loss.rms_share


@pytest.mark.slow("export")
@given(spring=springs, slip=slips, clearance=st.floats(0.0, 1e-4))
def test_springs_and_maxwell_elements_are_exact(spring, slip, clearance):
    law = stiffness.Backlash(law=spring, clearance=clearance) if clearance > 1e-6 else spring
    gear = sw.Gear(stiffness=law, hysteresis=slip)
    path = np.random.default_rng(0).normal(0.0, 1e-3, 60).cumsum()
    wanted = np.asarray(law.torque(path)) + np.asarray(slip.trace(path))
    assert elements(gear).torque(path) == pytest.approx(wanted, rel=1e-9, abs=1e-9)


@pytest.mark.parametrize(
    "law",
    [
        hysteresis.FadingMemory(stiffness=4000.0, forgetting=2000.0),
        hysteresis.FadingMemory(stiffness=[4000.0, 8000.0], forgetting=[2000.0, 9000.0]),
        hysteresis.BoucWen(stiffness=4000.0, saturation=1.0),
    ],
)
def test_other_hysteresis_keeps_width_and_loss_of_the_loop(law):
    whole, half = np.split(np.array([loss.rms_share for loss in torsion_losses(law)]), 2)
    assert whole.max() < 0.01
    assert half.max() < 0.05


def test_the_loss_of_a_loop_is_that_of_its_area():
    law = hysteresis.FadingMemory(stiffness=4000.0, forgetting=2000.0)
    loss = [each for each in torsion_losses(law) if each.quantity == "loss per cycle"][1]
    gear = sw.Gear(hysteresis=law)
    twist = 0.5 * float(gear.stiffness.twist(MAX_TORQUE))
    assert loss.size == pytest.approx(area(law, twist), rel=1e-3)
    assert loss.largest == pytest.approx(abs(area(law, twist) - area(elements(gear), twist)), rel=0.01)


def area(law, twist: float) -> float:
    corners = [0.0, twist, -twist, twist, -twist, twist]
    path = np.concatenate([np.linspace(a, b, 2000) for a, b in pairwise(corners)])
    torque = np.asarray(law.trace(path) if hasattr(law, "trace") else law.torque(path))
    return abs(float(np.trapezoid(torque[6000:], path[6000:])))


@pytest.mark.slow("export")
@given(coulomb=st.floats(0.01, 0.1), viscous=st.floats(0.0, 1e-3), ratio=st.sampled_from([30.0, 100.0, 160.0]))
def test_dry_and_viscous_friction_of_all_places_add_at_the_input(coulomb, viscous, ratio):
    law = sw.friction.Coulomb(coulomb=coulomb, viscous=viscous)
    kinematics = sw.kinematics.PlainRatio(reduction=ratio)
    gear = sw.Gear(kinematics=kinematics, friction_input=law, friction_mesh=law, friction_output=law)
    found = elements(gear)
    speed = np.array([-150.0, -3.0, 2.5, 100.0])
    wanted = law.steady(speed) + 2.0 * law.steady(speed / ratio) / ratio
    assert found.friction(speed) == pytest.approx(np.asarray(wanted))
    assert friction_share(gear) < 1e-9


def test_a_stribeck_friction_has_the_loss_of_its_best_line():
    law = sw.friction.Stribeck(coulomb=0.05, breakaway=0.08, stribeck_speed=5.0, viscous=4e-4)
    gear = sw.Gear(friction_input=law)
    (loss,) = friction_losses(gear, MAX_SPEED, elements(gear).friction)
    speed = np.linspace(2.0, 200.0, 400)
    torque = np.asarray(law.steady(speed))
    line = np.polyval(np.polyfit(speed, torque, 1), speed)
    assert loss.rms == pytest.approx(float(np.sqrt(np.mean((torque - line) ** 2))), rel=1e-3)


def test_what_has_no_element_is_named_with_its_size():
    error = sw.kinematic_error.Fourier(order=[2], amplitude=[1e-4], phase=[0.0])
    (words,) = elements(sw.Gear(kinematic_error=error)).left_out
    assert words.startswith("kinematic error: 100 urad")
    assert "0.008 N.m" in words  # 2 * 1e-4 * 40 N.m


def test_modes_of_the_ring_have_no_element():
    ring = sw.ring.Modes(natural_frequency=[3000.0], waves=[2], damping=[0.02], mass=[0.3])
    stages = made(sw.structure.Staged)
    left_out = [
        elements(sw.Gear(structure=structure, input_inertia=1e-5)).left_out for structure in (stages, stages.replace(ring=ring))
    ]
    assert left_out[0] == ("stages of the compliance",)
    assert left_out[1] == ("stages of the compliance", "resonances of the flexspline's ring")


def test_a_gear_without_rating_needs_a_torque():
    with pytest.raises(ValueError, match="--max-torque NUMBER"):
        GearElements.of_set(sw.GearSet.of(sw.Gear(), name="bare", source="test"))


def test_a_spring_with_a_gap_has_no_torque_in_it():
    assert Spring(1e4, gap=1e-3).torque(np.array([-2e-3, -5e-4, 0.0, 1e-3, 3e-3])).tolist() == pytest.approx([-10, 0, 0, 0, 20])


def test_a_run_of_a_gear_of_elements_alone_loses_nothing():
    gear = sw.Gear(
        stiffness=stiffness.Cubic(a1=1.2e4, a3=1e9),
        hysteresis=hysteresis.MaxwellSlip(stiffness=[5e3, 2e3], breakaway=[0.5, 0.6]),
        damping=3.0,
        friction_input=sw.friction.Coulomb(coulomb=0.05, viscous=3e-4),
    )
    shares = {loss.quantity: loss.rms_share for loss in elements(gear).run_losses(gear)}
    assert len(shares) == 2
    assert max(shares.values()) < 1e-9


def test_a_kinematic_error_shows_in_the_loss_of_a_run():
    error = sw.kinematic_error.Fourier(order=[2], amplitude=[1e-4], phase=[0.0])
    gear = sw.Gear(stiffness=stiffness.Linear(k=1e4), damping=20.0, kinematic_error=error)
    loss = next(elements(gear).run_losses(gear))
    assert 0.5e-4 < loss.rms < 2e-4
