"""Feed-forward of a model: fixed point, twist, torque and friction against closed forms and paths of other laws."""

from __future__ import annotations

import itertools
from typing import Any

import numpy as np
import pytest
import strainwave as sw
from hypothesis import assume, given, strategies as st
from numpy.typing import NDArray
from strainwave import _core
from strainwave.compensation import ModelFeedforward

from tests.support.each import each
from tests.support.strategies import models, suited

Array = NDArray[np.float64]

KINEMATICS = sw.kinematics.StrainWave(flexspline_teeth=200, circular_spline_teeth=202, fixed="circular_spline")
RATIO = KINEMATICS.ratio  # -100
PERIOD = 1e-3  # s
RIGID = sw.Gear(kinematics=KINEMATICS, stiffness=sw.stiffness.Linear(k=1e12))
NOTHING = sw.loads.Inertia(inertia=1e-9)
CONSTANT = sw.loads.TorqueTable(inertia=1e-9, angle=[0.0], held_torque=[8.0])  # N.m, at every angle
TURN = np.linspace(0.0, 2.0 * np.pi / abs(RATIO), 4001)  # of the input


def planned(law: ModelFeedforward, angle: Array, speed: Array | float = 0.0, ratio: float = RATIO) -> tuple[Array, ...]:
    """Lead, its rate, torque and friction along a motion."""
    return law.requests(angle, np.broadcast_to(speed, angle.shape).copy(), ratio, PERIOD)


# Kinematic error


def left(error: Any, rounds: int) -> Array:
    """Error of the output angle that is left along a turn of the input [rad]."""
    law = ModelFeedforward(gear=RIGID.replace(kinematic_error=error), load=NOTHING, rounds=rounds)
    angle = RATIO * TURN + planned(law, TURN)[0]
    return TURN - (angle / RATIO - error.error(angle))


@pytest.mark.parametrize(("rounds", "wanted"), [(0, 3.0e-4), (1, 9.2e-6), (2, 4.3e-7), (3, 2.2e-8)])
def test_rounds_of_the_fixed_point_leave_known_errors(rounds: int, wanted: float) -> None:
    """Numbers of physics.md, section 7, to the two digits given."""
    error = sw.kinematic_error.Fourier(order=[2.0], amplitude=[3e-4], phase=[0.0])
    assert np.abs(left(error, rounds)).max() == pytest.approx(wanted, abs=0.05 * 10.0 ** np.floor(np.log10(wanted)))


waves = st.lists(st.tuples(st.sampled_from([1.0, 2.0, 2.02, 3.0, 4.0]), st.floats(0.01, 1.0), st.floats(-3.0, 3.0)), min_size=1)


def wave_error(drawn: list[tuple[float, float, float]], contraction: float) -> sw.kinematic_error.Fourier:
    """An error whose |ratio| times the sum of order times amplitude is this."""
    order, weight, phase = (np.array(column) for column in zip(*drawn[:8], strict=True))
    amplitude = weight * contraction / (abs(RATIO) * (order * weight).sum())
    return sw.kinematic_error.Fourier(order=order.tolist(), amplitude=amplitude.tolist(), phase=phase.tolist())


@pytest.mark.slow("physics")
@given(waves, st.floats(0.01, 0.98))
def test_each_round_leaves_at_most_its_share_of_the_error(drawn: list[tuple[float, float, float]], contraction: float) -> None:
    error = wave_error(drawn, contraction)
    errors = [np.abs(left(error, rounds)) for rounds in range(6)]
    for before, after in itertools.pairwise(errors):
        assert (after <= contraction * before + 1e-15).all()


@pytest.mark.slow("physics")
@given(waves, st.floats(1.001, 10.0))
def test_an_error_that_does_not_converge_is_refused_unless_it_is_left_out(
    drawn: list[tuple[float, float, float]], contraction: float
) -> None:
    gear = RIGID.replace(kinematic_error=wave_error(drawn, contraction))
    with pytest.raises(ValueError, match=r"\|ratio\| times its steepest slope is .*, and must be less than 1; set rounds = 0"):
        ModelFeedforward(gear=gear)
    law = ModelFeedforward(gear=gear, load=NOTHING, rounds=0)
    assert planned(law, TURN)[0] == pytest.approx(np.zeros(TURN.size), abs=1e-15)


@pytest.mark.slow("physics")
@given(models("kinematic_error"))
def test_whatever_the_law_of_the_error_what_is_accepted_converges(error: Any) -> None:
    error = suited(error, KINEMATICS)
    assume(not hasattr(error, "law"))  # one under load follows the torque, which trace below does not
    try:
        ModelFeedforward(gear=RIGID.replace(kinematic_error=error))
    except ValueError:
        assume(False)
    assert abs(RATIO) * np.abs(error.slope(RATIO * TURN)).max() < 1.0
    largest = [np.abs(left(error, rounds)).max() for rounds in (1, 4, 8)]
    assert largest[2] <= largest[1] + 1e-15 <= largest[0] + 2e-15


@pytest.mark.parametrize("rounds", [0, 8])
def test_the_rate_of_the_lead_is_that_of_the_input_along_the_error(rounds: int) -> None:
    """Input speed = i r' / (1 - i e'(theta)), which the difference of two leads is in the middle between them."""
    error = sw.kinematic_error.Fourier(order=[1.0, 2.0], amplitude=[8e-4, 3e-4], phase=[0.3, -1.1])
    law = ModelFeedforward(gear=RIGID.replace(kinematic_error=error), load=NOTHING, rounds=rounds)
    speed = 0.3
    angle = speed * PERIOD * np.arange(500)
    lead, rate, *_ = planned(law, angle, speed)
    slope = error.slope(RATIO * angle + lead) if rounds else np.zeros(angle.size)
    assert rate == pytest.approx(RATIO * speed * (1.0 / (1.0 - RATIO * slope) - 1.0), abs=1e-6)
    difference = np.diff(lead) / PERIOD
    assert 0.5 * (rate[1:] + rate[:-1]) == pytest.approx(difference, abs=1e-4 * abs(RATIO * speed))


# Twist

COMPLIANCE = sw.stiffness.MultiCompliance(
    flexspline_stiffness=8e3,
    flexspline_hardening=0.02,
    wave_generator_stiffness=2.0,
    wave_generator_hardening=1.5,
    reduction=100.0,
)
SLIP = sw.hysteresis.MaxwellSlip(stiffness=[1000.0, 600.0, 300.0], breakaway=[0.5, 0.9, 0.9])
SPRINGS = [
    sw.stiffness.Linear(k=1e4),
    sw.stiffness.Piecewise(k1=8e3, k2=4e3, knee=5e-4),
    sw.stiffness.ThreeSegment(k1=8e3, k2=1e4, k3=1.3e4, t1=4.0, t2=9.0),
    sw.stiffness.Cubic(a1=1e4, a3=1e9),
    COMPLIANCE,
    sw.stiffness.TwoSided(law=sw.stiffness.Linear(k=1e4), negative_factor=0.8),
    sw.stiffness.Backlash(law=sw.stiffness.Linear(k=1e4), clearance=1e-4),
]
MEMORIES = [
    SLIP,
    sw.hysteresis.FadingMemory(stiffness=[3e3, 1e3], forgetting=[5e3, 2e3]),
    sw.hysteresis.BoucWen(stiffness=4e3, saturation=0.4, sharpness=1.5, shape=0.6),
    sw.hysteresis.Preisach(density=sw.hysteresis.PowerDensity(limit=3e-3, saturation=2.0, exponent=1.5)),
    sw.hysteresis.Regimes(positive_unloading=4e3, negative_loading=1e3, negative_unloading=4.5e3, positive_loading=1.5e3,
                          onset=0.05, lost_motion=1e-4),
    sw.hysteresis.FrictionalWindup(springs=COMPLIANCE, friction=0.3),
]  # fmt: skip


def twists(gear: sw.Gear, torque: Array) -> Array:
    """Twist [rad] that the feed-forward finds along a path of the torque carried [N.m]."""
    most = max(np.abs(torque).max(), 1e-3)
    load = sw.loads.TorqueTable(inertia=1e-12, angle=[-1.0, 1.0], held_torque=[-most, most])
    return planned(ModelFeedforward(gear=gear, load=load, rounds=0), torque / most)[0] / RATIO


def test_every_family_of_springs_and_memories_is_inverted_here() -> None:
    assert {type(law) for law in SPRINGS} == set(_core.families["stiffness"].values())
    assert {type(law) for law in MEMORIES} == set(_core.families["hysteresis"].values())


@pytest.mark.slow("physics")
@each(("spring", "memory"), itertools.product(SPRINGS, MEMORIES))
def test_the_twist_is_that_of_the_torque_over_ten_thousand_reversals(spring: Any, memory: Any) -> None:
    """The path of the gear itself, along these twists, is the torque that was asked for."""
    gear = sw.Gear(kinematics=KINEMATICS, stiffness=spring, hysteresis=memory)
    torque = 20.0 * np.random.default_rng(7).uniform(-1.0, 1.0, 10_000)
    assert np.abs(gear.trace(twists(gear, torque)) - torque).max() < 1e-9


@given(models("stiffness"), models("hysteresis"), st.integers(0, 2**32 - 1), st.floats(1e-5, 3e-3))
def test_of_any_gear_the_torque_of_its_twist_is_found_again(spring: Any, memory: Any, seed: int, reach: float) -> None:
    """Torques that the gear has along a random path; their twists need not be the same where the gear has play."""
    gear = sw.Gear(kinematics=KINEMATICS, stiffness=suited(spring, KINEMATICS), hysteresis=suited(memory, KINEMATICS))
    path = reach * np.random.default_rng(seed).uniform(-1.0, 1.0, 300)
    torque = gear.trace(path)
    assume(np.abs(torque).max() > 0.0)
    stiffest = np.abs(np.diff(torque) / np.diff(path)).max()
    found = gear.trace(twists(gear, torque))
    assert np.abs(found - torque).max() <= 1e-9 * np.abs(torque).max() + 1e-15 * stiffest


@given(st.integers(0, 2**32 - 1))
def test_of_maxwell_slip_and_a_spring_it_is_the_inverse_by_plays(seed: int) -> None:
    """Prandtl-Ishlinskii: a law of its own, exact."""
    gear = sw.Gear(kinematics=KINEMATICS, stiffness=sw.stiffness.Linear(k=500.0), hysteresis=SLIP)
    torque = 6.0 * np.append(0.0, np.random.default_rng(seed).uniform(-1.0, 1.0, 200))
    assert twists(gear, torque) == pytest.approx(SLIP.inverse(500.0).trace(torque), abs=1e-13)


# Torque


def test_rigid_and_without_friction_it_is_the_torque_of_inertia_and_load() -> None:
    """Accelerations are differences over a period, that of the first instant is nothing."""
    gear = RIGID.replace(input_inertia=3e-5)
    load = sw.loads.Pendulum(inertia=0.5, gravity_torque=15.0, gravity_phase=0.4)
    law = ModelFeedforward(gear=gear, load=load, motor_inertia=2e-5)
    time = PERIOD * np.arange(400)
    angle, speed = 0.7 * np.sin(9.0 * time), 6.3 * np.cos(9.0 * time)
    _, _, torque, friction = planned(law, angle, speed)
    acceleration = np.append(0.0, np.diff(speed) / PERIOD)
    wanted = 5e-5 * RATIO * acceleration + (0.5 * acceleration + 15.0 * np.sin(angle + 0.4)) / RATIO
    assert torque == pytest.approx(wanted, abs=1e-6)  # of the twist's acceleration at the first instants
    assert not friction.any()


def test_a_load_that_moves_the_output_itself_is_refused() -> None:
    with pytest.raises(ValueError, match="load must not be Prescribed"):
        ModelFeedforward(gear=RIGID, load=sw.loads.Prescribed())


# Friction

COULOMB = sw.friction.Coulomb(coulomb=0.02, breakaway=0.02, viscous=1e-3)
STRIBECK = sw.friction.Stribeck(coulomb=0.02, breakaway=0.03, stribeck_speed=2.0, viscous=1e-3)
LUGRE = sw.friction.LuGre(
    coulomb=0.02, breakaway=0.03, stribeck_speed=2.0, bristle_stiffness=5.0, bristle_damping=1e-4, viscous=1e-3
)
OUTPUT = sw.friction.Coulomb(coulomb=0.5, breakaway=0.7, viscous=0.3)
LOSS = {"driving_forward": 0.1, "driving_reverse": 0.12, "backdriving_forward": 0.2, "backdriving_reverse": 0.25}


@pytest.mark.parametrize("speed", [0.3, -0.3, 0.02])
@pytest.mark.parametrize("at_input", [COULOMB, STRIBECK, LUGRE], ids=lambda law: law.name)
def test_steady_sliding_costs_the_power_of_all_frictions_and_the_load(speed: float, at_input: Any) -> None:
    """tau omega_in = F_in omega_in + loss |T| |r'| + F_out r' + T_load r', along a kinematic error as well."""
    error = sw.kinematic_error.Fourier(order=[2.0], amplitude=[4e-4], phase=[0.3])
    gear = RIGID.replace(
        friction_input=at_input, friction_mesh=sw.friction.LoadDependent(**LOSS), friction_output=OUTPUT, kinematic_error=error
    )
    law = ModelFeedforward(gear=gear, load=CONSTANT, rounds=8)
    angle = speed * PERIOD * np.arange(2000)
    lead, rate, torque, friction = planned(law, angle, speed)
    input_speed = RATIO * speed / (1.0 - RATIO * error.slope(RATIO * angle + lead))
    assert rate == pytest.approx(input_speed - RATIO * speed, abs=1e-6)
    carried = 8.0 + OUTPUT.steady(speed)
    share = LOSS["driving_forward" if speed > 0.0 else "backdriving_reverse"]  # the load pulls backwards
    lost = at_input.steady(input_speed) * input_speed + share * carried * abs(speed) + OUTPUT.steady(speed) * speed
    settled = slice(1000, None)  # the bristle, or the sense of friction, has followed
    tolerance = 2e-3 if at_input is LUGRE else 1e-7  # the bristle lags behind a speed that varies with the error
    assert friction[settled] * input_speed[settled] == pytest.approx(lost[settled], rel=tolerance)
    power = lost + 8.0 * speed
    assert torque[settled] * input_speed[settled] == pytest.approx(power[settled], abs=tolerance * np.abs(lost).max())


def reversal(speed: float = 0.02) -> tuple[Array, Array]:
    """Output angle and speed of a motion that has gone far and turns back at once."""
    forth, back = np.full(500, speed), np.full(300, -speed)
    angle = PERIOD * np.cumsum(np.append(forth, back))
    return angle, np.append(forth, back)


@pytest.mark.parametrize("share", [1.0, 0.6, 0.0])
def test_set_valued_friction_turns_over_as_its_presliding_has_it(share: float) -> None:
    """From F to -F by 1 - 2 exp(-x / presliding) after a reversal, x the way of the input since then."""
    dry = sw.friction.Coulomb(coulomb=0.05, breakaway=0.05)
    law = ModelFeedforward(gear=RIGID.replace(friction_input=dry), load=NOTHING, presliding=0.03, friction_share=share)
    angle, speed = reversal()
    _, _, torque, friction = planned(law, angle, speed)
    way = abs(RATIO) * 0.02 * PERIOD * np.arange(300)  # at an instant: what was moved before it
    assert friction[500:] == pytest.approx(share * 0.05 * (1.0 - 2.0 * np.exp(-way / 0.03)), abs=1e-12 + 1e-9 * share)
    assert torque[502:] == pytest.approx(friction[502:], abs=1e-6)


def test_before_the_first_motion_there_is_no_set_valued_friction() -> None:
    law = ModelFeedforward(gear=RIGID.replace(friction_input=COULOMB), load=NOTHING)
    _, _, _, friction = planned(law, np.zeros(10))
    assert not friction.any()


def test_a_bristle_has_its_own_presliding() -> None:
    """z+ = z_s + (z - z_s) exp(-sigma_0 |v| T / G), F = sigma_0 z + sigma_1 z' + sigma_2 v; `presliding` does not matter."""
    angle, speed = reversal()
    found = []
    for presliding in (0.01, 1.0):
        law = ModelFeedforward(gear=RIGID.replace(friction_input=LUGRE), load=NOTHING, presliding=presliding)
        found.append(planned(law, angle, speed)[3])
    assert np.array_equal(*found)
    z, wanted = 0.0, []
    for v in RATIO * speed:
        level = 0.02 + 0.01 * np.exp(-((v / 2.0) ** 2))
        steady = np.sign(v) * level / 5.0
        z = steady + (z - steady) * np.exp(-5.0 * abs(v) * PERIOD / level)
        wanted.append(5.0 * z + 1e-4 * (v - 5.0 * abs(v) / level * z) + 1e-3 * v)
    assert found[0] == pytest.approx(np.array(wanted), abs=1e-12)


@given(models("friction"), st.floats(0.0, 1.0))
def test_a_share_of_any_friction_is_that_share(law: Any, share: float) -> None:
    gear = RIGID.replace(friction_input=suited(law, KINEMATICS))
    angle, speed = reversal()
    whole, part = (
        planned(ModelFeedforward(gear=gear, load=CONSTANT, friction_share=each), angle, speed) for each in (1.0, share)
    )
    assert part[3] == pytest.approx(share * whole[3], abs=1e-15 + 1e-12 * np.abs(whole[3]).max())
    rest = whole[2] - whole[3]
    assert part[2] - part[3] == pytest.approx(rest, abs=1e-12 * (1.0 + np.abs(whole[2]).max()))


# A plant that is the model

PLANT = sw.Gear(
    kinematics=KINEMATICS,
    kinematic_error=sw.kinematic_error.Fourier(order=[2.0, 4.0], amplitude=[3e-4, 0.8e-4], phase=[0.3, -1.1]),
    stiffness=sw.stiffness.Cubic(a1=8000.0, a3=4e7),
    hysteresis=sw.hysteresis.MaxwellSlip(stiffness=[1000.0, 600.0, 300.0, 100.0], breakaway=[0.5, 0.9, 0.9, 0.6]),
    damping=0.5,
    input_inertia=1e-4,
    friction_input=sw.friction.LuGre(
        coulomb=0.05, breakaway=0.07, stribeck_speed=3.0, bristle_stiffness=5.0, bristle_damping=2e-3, viscous=1e-3
    ),
)
ARM = sw.loads.Pendulum(inertia=0.05, gravity_torque=8.0)
MODEL = ModelFeedforward(gear=PLANT, load=ARM, motor_inertia=5e-5)


def tracking(period: float, feedforward: Any, command: sw.scenario.Scenario) -> float:
    """RMS of the error of the output, after half a second [rad]; of a loop on the input with double poles at -60 1/s."""
    inertia = 1.5e-4 + 0.05 / RATIO**2
    law = sw.control.PID(proportional=inertia * 3600.0, derivative=inertia * 120.0, limit=10.0)
    control = sw.control.Sampled(law=law, period=period, compensation=sw.Compensation(feedforward=feedforward))
    drive = sw.Drive(gear=PLANT, motor=sw.motor.TorqueSource(inertia=5e-5), load=ARM, control=control)
    run = sw.simulate(drive, command, 1e-4, sample=2e-3)
    error: Array = (run["command"] - run["output_angle"])[run.time > 0.5]
    return float(np.sqrt(np.mean(error**2)))


@pytest.mark.parametrize("amplitude", [0.3, 0.05])
def test_on_a_plant_that_is_the_model_the_error_is_that_of_the_period(amplitude: float) -> None:
    """Of first order: rates are differences over a period, and what is given is held for one. Reversals are among it."""
    command = sw.scenario.sine(amplitude, 0.5, 4.0)
    without = tracking(1e-3, sw.compensation.NoFeedforward(), command)
    errors = [tracking(period, MODEL, command) for period in (2e-3, 1e-3, 5e-4)]
    assert errors[1] < 0.04 * without
    for before, after in itertools.pairwise(errors):
        assert after < 0.6 * before


LEFT_OUT = {
    "kinematic_error": sw.kinematic_error.Fourier(),
    "hysteresis": sw.hysteresis.MaxwellSlip(),
    "stiffness": sw.stiffness.Linear(k=1e9),
    "friction_input": sw.friction.Viscous(),
}


@pytest.mark.parametrize("effect", list(LEFT_OUT))
def test_each_effect_that_is_left_out_of_the_model_is_left_in_the_error(effect: str) -> None:
    command = sw.scenario.sine(0.3, 0.5, 4.0)
    poorer = MODEL.replace(gear=PLANT.replace(**{effect: LEFT_OUT[effect]}))
    assert tracking(5e-4, poorer, command) > 1.5 * tracking(5e-4, MODEL, command)


@pytest.mark.parametrize(("reduction", "suits"), [(100.0, True), (100.05, True), (101.0, False), (50.0, False)])
def test_a_model_of_another_ratio_is_refused_where_a_drive_is_built(reduction: float, suits: bool) -> None:
    """Its lead would grow with the angle; rounding of a file is no other ratio."""
    geared = sw.Gear(kinematics=sw.kinematics.PlainRatio(reduction=100.0))
    other = sw.Gear(kinematics=sw.kinematics.PlainRatio(reduction=reduction))
    model = sw.compensation.ModelFeedforward(gear=other, load=sw.loads.Inertia(inertia=0.1))
    control = sw.control.Sampled(law=sw.control.PositionSpeed(), compensation=sw.Compensation(feedforward=model))
    parts = {"gear": geared, "motor": sw.motor.TorqueSource(inertia=1e-4), "load": sw.loads.Inertia(inertia=0.1)}
    if suits:
        assert sw.Drive(**parts, control=control).control == control
        return
    with pytest.raises(ValueError, match=f"the controller has the ratio {reduction:g}, and the gear of the drive 100: give"):
        sw.Drive(**parts, control=control)


def test_a_model_that_turns_the_other_way_is_refused() -> None:
    turned, fixed = (
        sw.Gear(kinematics=sw.kinematics.StrainWave(flexspline_teeth=200, circular_spline_teeth=202, fixed=spline))
        for spline in ("circular_spline", "flexspline")
    )
    model = sw.compensation.ModelFeedforward(gear=fixed, load=sw.loads.Inertia(inertia=0.1))
    control = sw.control.Sampled(law=sw.control.PositionSpeed(), compensation=sw.Compensation(feedforward=model))
    with pytest.raises(ValueError, match=r"has the ratio 101, and the gear of the drive -100"):
        sw.Drive(gear=turned, motor=sw.motor.TorqueSource(inertia=1e-4), load=sw.loads.Inertia(inertia=0.1), control=control)


@pytest.mark.parametrize("law", [sw.control.FeedbackLinearisation, sw.control.KinematicErrorTracking])
@pytest.mark.parametrize("sampled", [False, True])
def test_so_is_a_law_with_a_model_of_another_ratio(law: type, sampled: bool) -> None:
    gear = sw.Gear(kinematics=sw.kinematics.PlainRatio(reduction=100.0))
    control = law(gear=gear, load=sw.loads.Inertia(inertia=0.1), motor_inertia=1e-4)
    whole = sw.control.Sampled(law=control) if sampled else control
    parts = {"motor": sw.motor.TorqueSource(inertia=1e-4), "load": sw.loads.Inertia(inertia=0.1), "control": whole}
    assert sw.Drive(gear=gear, **parts).gear == gear
    with pytest.raises(ValueError, match="the controller has the ratio 100, and the gear of the drive 80: give"):
        sw.Drive(gear=gear.replace({"kinematics.reduction": 80.0}), **parts)
