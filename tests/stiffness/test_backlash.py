"""A spring behind play in closed form, its lost motion, free flight between its flanks, and what else takes a spring."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import strainwave as sw
from hypothesis import given, strategies as st
from numpy.typing import NDArray
from strainwave import _core
from strainwave.identification.experiments.torsion_loop import TorsionLoop
from strainwave.stiffness import Backlash, Cubic, Linear, MultiCompliance, ThreeSegment

from tests.support.strategies import built, log_uniform, made, signed

Array = NDArray[np.float64]

PLAY = 4e-4  # rad
K, RATIO, ROTOR, ARM = 1e4, 100.0, 1e-4, 0.5
STIFF = Linear(k=K)

plain = st.one_of([built(kind) for name, kind in _core.families["stiffness"].items() if name != "backlash"])
clearances = st.just(0.0) | log_uniform(1e-6, 1e-2)
torques = signed(log_uniform(1e-3, 1e2))


# The law


def test_of_a_linear_spring_everything_is_a_line_from_the_flank_on() -> None:
    spring = Backlash(law=STIFF, clearance=PLAY)
    twist = np.array([-5e-4, -2e-4, -1e-4, 0.0, 1e-4, 2e-4, 5e-4])
    beyond = np.array([-3e-4, 0.0, 0.0, 0.0, 0.0, 0.0, 3e-4])
    assert spring.torque(twist) == pytest.approx(K * beyond, abs=1e-15)
    assert spring.energy(twist) == pytest.approx(0.5 * K * beyond**2, abs=1e-18)
    assert spring.tangent(twist).tolist() == [K, K, 0.0, 0.0, 0.0, K, K]
    assert spring.twist([-3.0, 0.0, 3.0]) == pytest.approx([-5e-4, 0.0, 5e-4], rel=1e-15)


@given(plain, clearances, torques)
def test_beyond_the_play_it_is_the_spring_from_the_flank_on(law: Any, clearance: float, torque: float) -> None:
    """Up to the rounding of the twist, times what the spring makes of it."""
    spring = Backlash(law=law, clearance=clearance)
    own, flank = law.twist(torque), math.copysign(0.5 * clearance, torque)
    assert spring.twist(torque) == own + flank
    stiffness = max(law.tangent([own * (1.0 - 1e-9), own * (1.0 + 1e-9)]))
    rounding = 1e-14 * (abs(torque) + stiffness * (abs(own) + clearance))
    assert spring.torque(own + flank) == pytest.approx(torque, rel=0.0, abs=rounding)
    assert spring.energy(own + flank) == pytest.approx(law.energy(own), rel=1e-14, abs=rounding * (abs(own) + clearance))


@given(plain, log_uniform(1e-6, 1e-2), st.floats(-0.499, 0.499))
def test_within_the_play_there_is_nothing(law: Any, clearance: float, share: float) -> None:
    spring = Backlash(law=law, clearance=clearance)
    assert [getattr(spring, verb)(share * clearance) for verb in ("torque", "tangent", "energy")] == [0.0, 0.0, 0.0]
    assert spring.twist(0.0) == 0.0


@given(plain, torques)
def test_without_play_it_is_its_spring_to_the_last_digit(law: Any, torque: float) -> None:
    spring, twist = Backlash(law=law, clearance=0.0), law.twist(torque)
    assert spring.twist(torque) == twist
    for verb in ("torque", "tangent", "energy"):
        assert getattr(spring, verb)([twist, 0.0, -twist]).tolist() == getattr(law, verb)([twist, 0.0, -twist]).tolist()


def test_its_bound_is_that_of_its_spring_behind_half_the_play() -> None:
    law = made(MultiCompliance)
    bound = math.pi / (2.0 * 0.02 * 8000.0) + 1.0 / (100.0 * 1.5 * 2.0)
    spring = Backlash(law=law, clearance=PLAY)
    assert math.isfinite(spring.torque(bound + 0.49 * PLAY))
    for beyond in (bound + 0.51 * PLAY, -1.0):
        with pytest.raises(ValueError, match=r"backlash: twist = .* lies outside of \[-0\.01335081037") as caught:
            spring.torque(beyond)
        assert "a hardening of 0 leaves the twist unbounded" in str(caught.value)


def test_a_drive_that_twists_its_spring_too_far_is_told_so() -> None:
    drive = geared(Backlash(law=made(MultiCompliance), clearance=PLAY))
    with pytest.raises(ValueError, match=r"gear\.stiffness: twist = .* rad lies outside of \[-0\.01335"):
        sw.simulate(drive, OFF, 1e-6, initial=drive.rest().replace(output_speed=-10.0))


def test_the_ratio_of_its_spring_has_to_be_that_of_the_gear() -> None:
    spring = Backlash(law=made(MultiCompliance), clearance=PLAY)
    kinematics = sw.kinematics.PlainRatio(reduction=80.0)
    with pytest.raises(
        ValueError, match=r"^gear: stiffness\.reduction = 100 must be 80, the ratio of kinematics without its sign"
    ):
        sw.Gear(kinematics=kinematics, stiffness=spring)
    assert sw.Gear(kinematics=kinematics, stiffness=spring.replace(law=spring.law.replace(reduction=80.0)))


def test_a_law_within_a_law_within_a_law_is_refused() -> None:
    """Two plays in series are one."""
    with pytest.raises(TypeError, match=r"backlash.law must be one of Linear, .*, MultiCompliance, Asymmetric, not"):
        Backlash(law=Backlash(law=STIFF, clearance=PLAY), clearance=PLAY)  # type: ignore[arg-type]


@pytest.mark.parametrize("clearance", [-1e-4, math.nan, math.inf])
def test_what_is_no_play_is_refused(clearance: float) -> None:
    with pytest.raises(ValueError, match=r"backlash.clearance = "):
        Backlash(law=STIFF, clearance=clearance)


# In a gear


def geared(spring: Any, **parts: Any) -> sw.Drive:
    """A rotor and an arm on both sides of the play, and nothing else."""
    gear = sw.Gear(kinematics=sw.kinematics.PlainRatio(reduction=RATIO), stiffness=spring, **parts)
    motor, arm = sw.motor.TorqueSource(inertia=ROTOR), sw.loads.Inertia(inertia=ARM)
    return sw.Drive(gear=gear, motor=motor, load=arm, meter=sw.meter.EnergyMeter())


OFF = sw.scenario.constant(0.0, 0.05)


@pytest.mark.parametrize("law", [STIFF, ThreeSegment(k1=8e3, k2=11e3, k3=14e3, t1=1.0, t2=4.0), Cubic(a1=1e4, a3=1e9)])
def test_the_lost_motion_of_a_gear_is_longer_by_the_play(law: Any) -> None:
    """Between a torque and its opposite, at a locked input: 2 delta(T) + c."""
    gear = geared(Backlash(law=law, clearance=PLAY)).gear
    for torque in (0.01, 1.0, 10.0):
        there, back = gear.twist([torque, -torque])
        assert there - back == pytest.approx(2.0 * law.twist(torque) + PLAY, rel=1e-12)
    assert gear.trace([0.0, 2e-4, 3e-4, -3e-4]) == pytest.approx([0.0, 0.0, law.torque(1e-4), -law.torque(1e-4)], abs=1e-14)


def test_between_the_flanks_both_sides_fly_freely_and_a_flank_throws_them_back() -> None:
    """A cycle: twice across the play at the speed v, and twice half a period of two masses on the spring."""
    drive, speed = geared(Backlash(law=STIFF, clearance=PLAY)), 0.1
    start = drive.rest().replace(output_speed=-speed)
    run = sw.simulate_adaptively(drive, OFF, 1e-10, initial=start, sample=1e-5)
    first = 0.5 * PLAY / speed  # from the middle
    free = run.time < first
    assert np.count_nonzero(free) == 200
    assert not run["torque"][free].any()
    assert run["twist"][free] == pytest.approx(speed * run.time[free], rel=1e-12)
    assert run["output_speed"][free].tolist() == [-speed] * 200
    assert not run["input_speed"][free].any()

    frequency = math.sqrt(K * (1.0 / ARM + 1.0 / (ROTOR * RATIO**2)))
    blow, flight = math.pi / frequency, PLAY / speed
    time = np.mod(run.time - first, 2.0 * (blow + flight))
    sense = np.where(time < blow + flight, 1.0, -1.0)
    within = np.mod(time, blow + flight)
    twist = np.where(
        within < blow,
        0.5 * PLAY + speed / frequency * np.sin(frequency * within),
        0.5 * PLAY - speed * (within - blow),
    )
    after = run.time > first
    assert run["twist"][after] == pytest.approx((sense * twist)[after], abs=1e-8 * PLAY)
    assert run.time[-1] > 2.0 * (blow + flight)


def test_the_energy_of_a_rattling_drive_is_accounted_for_in_adaptive_steps() -> None:
    """To 1e-9, of a joint with friction and damping that a sine shakes from flank to flank."""
    drive = geared(
        Backlash(law=Cubic(a1=1e4, a3=1e9), clearance=PLAY),
        damping=2.0,
        friction_input=sw.friction.Coulomb(coulomb=0.01, breakaway=0.012, viscous=1e-5),
        friction_output=sw.friction.Viscous(viscous=0.5),
    )
    run = sw.simulate_adaptively(drive, sw.scenario.sine(0.3, 40.0, 0.1), 1e-9, sample=2e-4)
    assert np.abs(run["twist"]).max() > 0.5 * PLAY
    contact = np.sign(run["torque"] * (np.abs(run["twist"]) > 0.5 * PLAY))
    assert {-1.0, 0.0, 1.0} == set(contact.tolist())
    stored = sum(run[name] for name in run.names if name.startswith("stored_"))
    taken = sum(run[name] for name in run.names if name.startswith("energy_") and name != "energy_supplied")
    missing = run["energy_supplied"] - taken - (stored - stored[0])
    assert np.abs(missing).max() < 1e-9 * run["energy_supplied"].max()


# Whatever takes a spring takes this one


def test_a_gear_file_keeps_it(tmp_path: Path) -> None:
    gear = geared(Backlash(law=Cubic(a1=1e4, a3=1e9), clearance=PLAY)).gear
    sw.save(gear, tmp_path / "worn.toml", name="Worn joint", source="torsion loop")
    assert sw.load(tmp_path / "worn.toml") == gear
    text = (tmp_path / "worn.toml").read_text()
    assert 'model = "backlash"' in text
    assert "[stiffness.law]" in text


def test_a_run_can_begin_at_a_torque_behind_the_play() -> None:
    drive = geared(Backlash(law=STIFF, clearance=PLAY))
    for torque, twist in ((2.0, 4e-4), (-2.0, -4e-4), (0.0, 0.0)):
        run = sw.simulate(drive, OFF, 1e-4, initial={"torque": torque}, load_torque=torque)
        assert run["twist"][0] == pytest.approx(twist, rel=1e-12)
        assert run["torque"][0] == pytest.approx(torque, rel=1e-12)


def test_members_of_an_ensemble_have_plays_of_their_own() -> None:
    """Each as it is alone."""
    drive = geared(Backlash(law=STIFF, clearance=PLAY), damping=1.0)
    command, plays = sw.scenario.sine(0.3, 40.0, 0.05), [0.0, 1e-4, PLAY]
    many = sw.simulate_many(drive, command, {"gear.stiffness.clearance": plays}, dt=1e-4, record=["twist"])
    for number, clearance in enumerate(plays):
        alone = sw.simulate(
            drive.replace(gear=drive.gear.replace(stiffness=Backlash(law=STIFF, clearance=clearance))), command, 1e-4
        )
        assert many.member(number)["twist"] == pytest.approx(alone["twist"], rel=1e-12, abs=1e-16)


def test_derivatives_by_play_and_stiffness_are_those_of_the_closed_form() -> None:
    """Under a torque at rest the twist is c / 2 + T / K: sensitivities 1/2 and -T / K^2."""
    drive = geared(Backlash(law=STIFF, clearance=PLAY), damping=1e3)
    start = {"output_angle": 0.0, "torque": 2.0}
    paths = ["gear.stiffness.clearance", "gear.stiffness.law.k"]
    found = sw.analysis.derivatives(
        drive, sw.scenario.constant(2.0 / RATIO, 1e-3), paths, load_torque=2.0, initial=start, sample=1e-3
    )
    assert [found["twist", path][0] for path in paths] == pytest.approx([0.5, -2.0 / K**2], rel=1e-9)


def test_a_fit_finds_the_play_of_a_torsion_loop() -> None:
    truth = sw.Gear(stiffness=Backlash(law=Cubic(a1=1.2e4, a3=4e9), clearance=PLAY))
    twist = 1e-3 * np.sin(np.linspace(0.0, 4.0 * np.pi, 241))
    start = truth.replace(stiffness=Backlash(law=Cubic(a1=1e4, a3=1e9), clearance=1e-4))
    free = ["stiffness.clearance", "stiffness.law.a1", "stiffness.law.a3"]
    found = sw.fit(start, TorsionLoop(twist, truth.trace(twist)), free).gear.stiffness
    assert found.clearance == pytest.approx(PLAY, rel=1e-6)
    assert (found.law.a1, found.law.a3) == pytest.approx((1.2e4, 4e9), rel=1e-6)
