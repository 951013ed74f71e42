"""What the laws become where one of their effects vanishes: the simpler law, and as fast as theory says.

The limits of one law alone stand beside it: BoucWen of sharpness one and FadingMemory, Regimes without lost motion.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
import strainwave as sw
from hypothesis import assume, given, settings, strategies as st
from numpy.typing import NDArray
from strainwave.friction import (
    Coulomb,
    Cyclic,
    LoadDependent,
    LuGre,
    MaxwellSlipFriction,
    PositionDependent,
    Stribeck,
    Thermal,
    TorqueEfficiency,
    Viscous,
)
from strainwave.hysteresis import BoucWen, FadingMemory, MaxwellSlip, PowerDensity, Preisach
from strainwave.kinematic_error import Fourier, Misalignment, Stochastic
from strainwave.stiffness import Cubic, Linear, MultiCompliance, Piecewise, ThreeSegment

from tests.support.reference_drive import DRIVE, command
from tests.support.samples import sample
from tests.support.strategies import built, log_uniform, made, models, signed, suited

Array = NDArray[np.float64]

stiffnesses = log_uniform(1e2, 1e5)
torques = log_uniform(1e-2, 1e2)
twists = signed(log_uniform(1e-5, 1e-2))
speeds = signed(log_uniform(1e-3, 1e2))
shares = st.lists(st.floats(-1.0, 1.0), min_size=2, max_size=8)
frictions = models("friction")

STEADY_DRIVE = DRIVE.replace(control=sw.control.OpenLoop(), gear=DRIVE.gear.replace(friction_input=Viscous(viscous=1e-4)))


def is_bounded(law: Any) -> bool:
    return getattr(law, "outside", "") == "refuse" or (hasattr(law, "law") and is_bounded(law.law))


def in_a_drive(**parts: Any) -> Array:
    """What the drive with these parts of its gear does, back and forth."""
    drive = STEADY_DRIVE.replace(gear=STEADY_DRIVE.gear.replace(**parts))
    run = sw.simulate(drive, sw.scenario.sine(6.0, 10.0, 0.1), 1e-4)
    return np.stack([run[name] for name in run.names if name != "time"])


# Stiffness


@given(built(MultiCompliance), st.floats(0.001, 0.01))
def test_the_flexspline_hardens_with_the_square_and_the_wave_generator_in_proportion(
    spring: MultiCompliance, share: float
) -> None:
    """Of a small C T: arctan x = x (1 - x^2 / 3 ...), 1 - exp(-y) = y (1 - y / 2 ...)."""
    torque = 7.0
    flexed = MultiCompliance(
        flexspline_stiffness=spring.flexspline_stiffness,
        flexspline_hardening=share / torque,
        wave_generator_stiffness=spring.wave_generator_stiffness,
        wave_generator_hardening=0.0,
        reduction=spring.reduction,
    )
    waved = flexed.replace(flexspline_hardening=0.0, wave_generator_hardening=share / torque * spring.reduction)
    linear = Linear(k=flexed.tangent(0.0)).twist(torque)
    soft = torque / flexed.flexspline_stiffness
    missing = linear - flexed.twist(torque)
    assert missing == pytest.approx(soft * share**2 / 3.0, rel=share**2, abs=1e-14 * linear)
    missing = linear - waved.twist(torque)
    assert missing == pytest.approx((linear - soft) * share / 2.0, rel=share, abs=1e-14 * linear)


@given(stiffnesses, twists, log_uniform(1e-9, 1e-3))
def test_a_cubic_spring_departs_from_its_line_in_proportion(a1: float, twist: float, share: float) -> None:
    """a3 = share a1 / twist^2."""
    spring, line = Cubic(a1=a1, a3=share * a1 / twist**2), Linear(k=a1)
    assert spring.torque(twist) == pytest.approx(line.torque(twist) * (1.0 + share), rel=1e-15)
    assert spring.tangent(twist) == pytest.approx(a1 * (1.0 + 3.0 * share), rel=1e-15)
    assert spring.energy(twist) == pytest.approx(line.energy(twist) * (1.0 + 0.5 * share), rel=1e-15)
    torque = line.torque(twist)
    assert spring.twist(torque) == pytest.approx(twist * (1.0 - share), rel=3.0 * share**2 + 1e-15)


@given(stiffnesses, twists)
def test_a_cubic_spring_without_hardening_is_its_line_to_the_last_digit(a1: float, twist: float) -> None:
    spring, line = Cubic(a1=a1, a3=0.0), Linear(k=a1)
    for verb in ("torque", "twist", "tangent", "energy"):
        assert getattr(spring, verb)(twist) == getattr(line, verb)(twist)


@given(stiffnesses, torques, st.floats(1.0, 10.0), twists)
def test_three_equal_segments_are_one(k: float, t1: float, ratio: float, twist: float) -> None:
    spring, line = ThreeSegment(k1=k, k2=k, k3=k, t1=t1, t2=ratio * t1), Linear(k=k)
    assert spring.torque(twist) == pytest.approx(line.torque(twist), rel=1e-14)
    assert spring.twist(k * twist) == pytest.approx(line.twist(k * twist), rel=1e-14)
    assert spring.energy(twist) == pytest.approx(line.energy(twist), rel=1e-14)
    assert spring.tangent(twist) == k


@given(stiffnesses, log_uniform(1e-9, 1e-3), st.floats(0.0, 0.99), twists)
def test_a_small_increment_of_stiffness_bends_a_line_in_proportion(k1: float, share: float, place: float, twist: float) -> None:
    knee = place * abs(twist)
    spring, line = Piecewise(k1=k1, k2=share * k1, knee=knee), Linear(k=k1)
    assert spring.torque(twist) == pytest.approx(line.torque(twist) * (1.0 + share * (1.0 - place)), rel=1e-14)
    assert spring.energy(twist) == pytest.approx(line.energy(twist) * (1.0 + share * (1.0 - place) ** 2), rel=1e-14)


# Hysteresis


@given(stiffnesses, torques, st.floats(0.5, 1.0))
def test_a_sharper_knee_comes_closer_to_maxwell_slip_in_proportion(stiffness: float, saturation: float, shape: float) -> None:
    """On the virgin curve at the twist where the element begins to slip."""
    path = [0.0, saturation / stiffness]
    slip = MaxwellSlip(stiffness=stiffness, breakaway=saturation).trace(path)[-1]

    def gap(sharpness: float) -> float:
        law = BoucWen(stiffness=stiffness, saturation=saturation, sharpness=sharpness, shape=shape)
        return float(slip - law.trace(path)[-1])

    assert gap(1e4) / gap(1e5) == pytest.approx(10.0, rel=1e-2)
    assert 0.0 < gap(1e5) < 1e-4 * saturation


@given(stiffnesses, shares, log_uniform(1e-6, 1e-2))
def test_what_forgets_slowly_is_a_spring(stiffness: float, path: list[float], forgetting: float) -> None:
    """The torque is at most what it forgets along the way from the line: a share alpha of the path times the largest torque."""
    twist = np.append(0.0, path)
    torque = FadingMemory(stiffness=stiffness, forgetting=forgetting).trace(twist)
    travelled = float(np.abs(np.diff(twist)).sum())
    assert np.all(np.abs(torque - stiffness * twist) <= stiffness * forgetting * travelled)
    assume(abs(twist[1]) > 1e-3)
    lost = stiffness * twist[1] - torque[1]
    half = 0.5 * forgetting * abs(twist[1])
    assert lost == pytest.approx(stiffness * twist[1] * half, rel=half, abs=1e-14 * stiffness)


@given(stiffnesses, torques, shares)
def test_one_element_of_maxwell_slip_is_elastoplastic(stiffness: float, breakaway: float, path: list[float]) -> None:
    """A spring k (x - p) whose plastic twist p gives way only where the spring would carry more than F."""
    yields = breakaway / stiffness
    twist = 5.0 * yields * np.append(0.0, path)
    plastic, lost = np.zeros(len(twist)), np.zeros(len(twist))
    for i in range(1, len(twist)):
        plastic[i] = min(max(plastic[i - 1], twist[i] - yields), twist[i] + yields)
        lost[i] = lost[i - 1] + breakaway * abs(plastic[i] - plastic[i - 1])
    elastic = twist - plastic
    law = MaxwellSlip(stiffness=stiffness, breakaway=breakaway)
    np.testing.assert_allclose(law.trace(twist), stiffness * elastic, rtol=0.0, atol=1e-14 * breakaway)
    energy = breakaway * yields
    np.testing.assert_allclose(law.work(twist), 0.5 * stiffness * elastic**2 + lost, rtol=0.0, atol=1e-13 * energy)


@given(built(MaxwellSlip), shares)
def test_elements_that_never_slip_are_springs(law: MaxwellSlip, path: list[float]) -> None:
    twist = np.append(0.0, path)
    stuck = law.replace(breakaway=[3.0 * stiffness for stiffness in law.stiffness])
    assert stuck.trace(twist) == pytest.approx(sum(law.stiffness) * twist, rel=0.0, abs=1e-13 * sum(law.stiffness))


@given(log_uniform(1e-5, 1e-1), torques, shares, st.floats(1e-6, 1e-3))
def test_a_density_of_power_one_is_elastic_and_more_departs_from_it_in_proportion(
    limit: float, saturation: float, path: list[float], more: float
) -> None:
    twist = 1.5 * limit * np.append(0.0, path)

    def torque(exponent: float) -> Array:
        density = PowerDensity(limit=limit, saturation=saturation, exponent=exponent)
        return Preisach(density=density).trace(twist)

    spring = saturation * np.clip(twist / limit, -1.0, 1.0)
    np.testing.assert_allclose(torque(1.0), spring, rtol=0.0, atol=1e-14 * saturation * len(twist))
    once, twice = (torque(1.0 + excess) - spring for excess in (more, 2.0 * more))
    slack = 1e-13 + 100.0 * len(twist) * more**2  # (1 - u)^p by (1 - p): 1, -ln(1 - u), its square ...
    np.testing.assert_allclose(twice, 2.0 * once, rtol=0.0, atol=slack * saturation)


# Friction


@given(torques, torques, speeds, log_uniform(1e1, 1e6), st.floats(0.1, 30.0))
def test_a_stiff_bristle_follows_the_motion_with_a_path_as_short_as_it_is_stiff(
    coulomb: float, excess: float, speed: float, stiffness: float, paths: float
) -> None:
    """After a reversal, torque approaches the Stribeck curve by exp(-sigma_0 x / G) of the path x: here so many G / sigma_0."""
    law = LuGre(
        coulomb=coulomb,
        breakaway=coulomb + excess,
        stribeck_speed=1.0,
        bristle_stiffness=stiffness,
        bristle_damping=0.0,
        viscous=0.0,
    )
    level = Stribeck(coulomb=coulomb, breakaway=coulomb + excess, stribeck_speed=1.0, viscous=0.0).steady(speed)
    last = paths * abs(level) / stiffness / abs(speed)
    time = [0.0, 1e3 * last + 1e3 * abs(level) / stiffness / abs(speed)]
    before = law.trace(time, [-speed, -speed])[-1]
    assert before == pytest.approx(-level, rel=1e-13)
    bent = LuGre.State(deflection=before / stiffness)
    after = law.trace([0.0, last], [speed, speed], state=bent)[-1]
    assert after == pytest.approx(level * (1.0 - 2.0 * math.exp(-paths)), rel=0.0, abs=1e-13 * abs(level))


@given(log_uniform(1e3, 1e6), st.floats(0.02, 0.5))
def test_the_loop_of_a_stiff_bristle_loses_what_coulomb_friction_loses(stiffness: float, level: float) -> None:
    """Per cycle of amplitude X, 4 G X less 4 G^2 / sigma_0 tanh(X sigma_0 / G), as of any fading memory."""
    law = made(LuGre, coulomb=level, breakaway=level, bristle_stiffness=stiffness, bristle_damping=0.0)
    amplitude, points = 1.0, 4001
    swing = amplitude * np.cos(np.pi * np.linspace(0.0, 1.0, points))  # from one end to the other, dense at the ends
    back = FadingMemory(stiffness=stiffness, forgetting=stiffness / level)
    cycle = np.concatenate(([0.0], swing, -swing[1:], swing[1:]))
    work = back.work(cycle)
    reach = level / stiffness
    loss = 4.0 * level * (amplitude - reach * math.tanh(amplitude / reach))
    assert work[-1] - work[points] == pytest.approx(loss, rel=1e-12)
    time = np.arange(len(cycle), dtype=np.float64)
    end = law.trace(np.append(time, len(cycle)), np.append(np.diff(cycle), [0.0, 0.0]))[-1]
    assert end == pytest.approx(back.trace(cycle)[-1], rel=1e-9)


@pytest.mark.filterwarnings("ignore:the drive has bristles:RuntimeWarning")  # asked for
@pytest.mark.parametrize("stiffness", [1e3, 1e6, 1e9, 1e12, 1e20])
def test_the_stiffest_bristle_slides_in_a_drive_as_the_curve_has_it(stiffness: float) -> None:
    """It follows the speed within G / (sigma_0 v); one step of the integration is up to 1e18 times as long."""
    law = made(LuGre, bristle_stiffness=stiffness, bristle_damping=0.0, viscous=1e-4)
    drive = STEADY_DRIVE.replace(gear=STEADY_DRIVE.gear.replace(friction_input=law))
    run = sw.simulate(drive, sw.scenario.constant(6.0, 0.2), method="exponential").between(0.1, 0.2)
    np.testing.assert_allclose(run["friction_input"], law.steady(run["input_speed"]), rtol=1e-6)


@given(torques, torques, speeds, st.floats(1.0, 3.0), log_uniform(1.0, 1e9), st.floats(0.0, 30.0))
def test_a_strong_attraction_leaves_no_lag(
    coulomb: float, excess: float, speed: float, faster: float, attraction: float, times: float
) -> None:
    """A slipping element that meets another speed follows as exp(-C t / s): here so many s / C."""
    law = MaxwellSlipFriction(
        stiffness=[60.0, 10.0],
        share=[0.4, 0.6],
        coulomb=coulomb,
        breakaway=coulomb + excess,
        stribeck_speed=1.0,
        attraction=attraction,
        viscous=0.0,
    )
    slow, fast = law.steady(speed), law.steady(faster * speed)
    last = times * abs(fast) / attraction + 1e-12 * abs(fast) / attraction
    slipping = law.State(torque=[0.4 * slow, 0.6 * slow], slipping=[1.0, 1.0])
    torque = law.trace([0.0, last], 2 * [faster * speed], state=slipping)[-1]
    assert torque == pytest.approx(fast + (slow - fast) * math.exp(-times - 1e-12), rel=1e-12)


@given(st.floats(0.01, 0.5), speeds, signed(torques), log_uniform(1e-6, 1e-2), st.floats(0.0, 30.0))
def test_a_short_presliding_is_a_loss_proportional_to_load(
    loss: float, speed: float, load: float, presliding: float, paths: float
) -> None:
    law = TorqueEfficiency(average_loss=loss, difference_loss=0.0, presliding=presliding, viscous=0.0)
    equal = LoadDependent(driving_forward=loss, driving_reverse=loss, backdriving_forward=loss, backdriving_reverse=loss)
    level = equal.steady(speed, load=load)
    assert law.steady(speed, load=load) == pytest.approx(level, rel=1e-15)
    last = (paths + 1e-12) * presliding / abs(speed)
    opposite = law.State(engagement=-math.copysign(1.0, speed))
    torque = law.trace([0.0, last], [speed, speed], load=load, state=opposite)[-1]
    assert torque == pytest.approx(level * (1.0 - 2.0 * math.exp(-paths - 1e-12)), rel=0.0, abs=1e-13 * abs(level))


@given(st.floats(0.0, 2.0), speeds, signed(torques))
def test_equal_losses_in_all_quadrants_are_coulomb_friction_of_that_load(loss: float, speed: float, load: float) -> None:
    law = LoadDependent(driving_forward=loss, driving_reverse=loss, backdriving_forward=loss, backdriving_reverse=loss)
    coulomb = Coulomb(coulomb=loss * abs(load))
    assert law.steady(speed, load=load) == coulomb.steady(speed)
    assert law.hold(math.copysign(1.0, speed), load=load) == coulomb.hold(math.copysign(1.0, speed))


@given(torques, st.floats(1.0, 2.0), st.floats(0.0, 1.0), speeds, st.floats(-1e3, 1e3))
def test_friction_alike_at_every_angle_is_coulomb_friction(
    level: float, ratio: float, viscous: float, speed: float, angle: float
) -> None:
    law = flat(level, ratio, viscous)
    coulomb = Coulomb(coulomb=level, breakaway=ratio * level, viscous=viscous)
    assert law.steady(speed, angle=angle) == coulomb.steady(speed)
    assert law.hold(angle=angle) == pytest.approx(coulomb.hold(), rel=1e-15)


def flat(level: float, ratio: float, viscous: float) -> PositionDependent:
    return PositionDependent(
        constant=level, static_ratio=ratio, viscous=viscous, domain_start=0.0, domain_end=1.0, outside="clamp"
    )


@given(st.floats(0.0, 1.0), st.floats(0.0, 1.0), speeds)
def test_without_a_fall_stribeck_friction_is_coulomb_friction(coulomb: float, viscous: float, speed: float) -> None:
    law = Stribeck(coulomb=coulomb, breakaway=coulomb, stribeck_speed=2.0, viscous=viscous)
    assert law.steady(speed) == Coulomb(coulomb=coulomb, viscous=viscous).steady(speed)


@given(torques, torques, speeds, log_uniform(1e-4, 1e-2))
def test_friction_that_falls_slowly_is_its_breakaway_and_one_that_falls_at_once_is_coulomb_friction(
    coulomb: float, excess: float, speed: float, share: float
) -> None:
    """With the square of the speed's share of Stribeck's: exp(-s^2) = 1 - s^2 + s^4 / 2 ..."""
    slow = Stribeck(coulomb=coulomb, breakaway=coulomb + excess, stribeck_speed=abs(speed) / share, viscous=0.0)
    fallen = coulomb + excess - abs(slow.steady(speed))
    assert fallen == pytest.approx(excess * share**2, rel=share**2, abs=4e-16 * (coulomb + excess))
    quick = slow.replace(stribeck_speed=share * abs(speed))
    assert quick.steady(speed) == Coulomb(coulomb=coulomb).steady(speed)


@given(built(PositionDependent), st.floats(0.0, 1.0), speeds)
def test_within_its_domain_a_law_is_the_same_whatever_it_is_outside(law: PositionDependent, place: float, speed: float) -> None:
    angle = min(law.domain_start + place * (law.domain_end - law.domain_start), law.domain_end)
    inside = law.replace(outside="refuse")
    clamped, repeated = law.replace(outside="clamp"), law.replace(outside="periodic")
    assert clamped.steady(speed, angle=angle) == inside.steady(speed, angle=angle)
    assert clamped.hold(angle=angle) == inside.hold(angle=angle)
    if angle < law.domain_end:  # where the next period begins
        assert repeated.steady(speed, angle=angle) == inside.steady(speed, angle=angle)
        assert repeated.hold(angle=angle) == inside.hold(angle=angle)


@pytest.mark.parametrize("place", ["friction_input", "friction_mesh", "friction_output"])
def test_laws_that_are_coulomb_friction_are_so_in_a_drive(place: str) -> None:
    coulomb = in_a_drive(**{place: Coulomb(coulomb=0.02, breakaway=0.02, viscous=1e-4)})
    for law in (flat(0.02, 1.0, 1e-4), Stribeck(coulomb=0.02, breakaway=0.02, stribeck_speed=2.0, viscous=1e-4)):
        assert in_a_drive(**{place: law}).tolist() == coulomb.tolist()


contacts = st.fixed_dictionaries({"angle": st.floats(-1e3, 1e3), "load": signed(torques)})


@given(frictions.filter(lambda law: not hasattr(law, "law") and not is_bounded(law)), speeds, contacts, st.floats(250.0, 350.0))
def test_a_modulation_that_does_nothing_is_the_law_itself(
    law: Any, speed: float, contact: dict[str, float], temperature: float
) -> None:
    """Without harmonics, with harmonics of no amplitude, at the reference temperature, without a rate; and one in the other."""
    plain = Cyclic(law=law)
    still = Cyclic(law=law, order=[2.0], amplitude=[0.0], phase=[0.3])
    at_reference = Thermal(law=law, dry_fall=0.02, viscous_fall=0.03, reference_temperature=temperature)
    time = [0.0, 0.1, 0.15, 0.5]
    path = [speed, -speed, 0.5 * speed, speed]
    for modulated in (plain, still, at_reference, Thermal(law=law), at_reference.replace(law=plain)):
        at = contact | {"temperature": temperature}
        assert modulated.steady(speed, **at) == law.steady(speed, **at)
        assert modulated.hold(**at) == law.hold(**at)
        assert modulated.trace(time, path, **at).tolist() == law.trace(time, path, **at).tolist()
        assert modulated.set_valued == law.set_valued


@settings(max_examples=sample(5, 10))
@given(st.sampled_from(["friction_input", "friction_output"]))
def test_a_modulation_that_does_nothing_does_nothing_in_a_drive(place: str) -> None:
    law = Stribeck(coulomb=0.02, breakaway=0.03, stribeck_speed=2.0)
    plain = in_a_drive(**{place: law})
    for modulated in (Cyclic(law=law), Thermal(law=law, dry_fall=0.02, viscous_fall=0.03), Thermal(law=Cyclic(law=law))):
        assert in_a_drive(**{place: modulated}).tolist() == plain.tolist()


@given(torques, st.floats(0.0, 1.0), speeds, st.floats(-1e2, 1e2), st.floats(250.0, 350.0), st.floats(0.0, 0.9))
def test_modulations_multiply(
    level: float, viscous: float, speed: float, angle: float, temperature: float, amplitude: float
) -> None:
    dry_fall, viscous_fall, reference = 0.01, 0.03, 300.0
    cyclic = Cyclic(law=Coulomb(coulomb=level, viscous=viscous), order=[2.0], amplitude=[amplitude], phase=[0.4])
    law = Thermal(law=cyclic, dry_fall=dry_fall, viscous_fall=viscous_fall, reference_temperature=reference)
    factor = 1.0 + amplitude * math.sin(2.0 * angle + 0.4)
    dry = math.exp(-dry_fall * (temperature - reference)) * level * math.copysign(1.0, speed)
    wet = math.exp(-viscous_fall * (temperature - reference)) * viscous * speed
    at = {"angle": angle, "temperature": temperature}
    assert law.steady(speed, **at) == pytest.approx(factor * (dry + wet), rel=1e-12)
    assert law.hold(**at) == pytest.approx(factor * abs(dry), rel=1e-12)


@given(torques, st.floats(0.0, 1.0), speeds, st.floats(-1e2, 1e2), st.floats(0.0, 1.0), st.floats(0.0, 0.9))
def test_a_detent_is_the_same_both_ways_and_adds_to_what_holds_at_rest(
    level: float, viscous: float, speed: float, angle: float, share: float, depth: float
) -> None:
    wave, detent = {"order": 2.0, "amplitude": 0.1, "phase": 0.4}, depth * 0.9 * level
    plain = Cyclic(law=Coulomb(coulomb=level, viscous=viscous), **wave, viscous_share=share)
    law = plain.replace(detent_order=[3.0, 0.5], detent_torque=[0.7 * detent, 0.3 * detent], detent_phase=[0.2, -1.0])
    stored = detent * (0.7 * math.sin(3.0 * angle + 0.2) + 0.3 * math.sin(0.5 * angle - 1.0))
    factor = 0.1 * math.sin(2.0 * angle + 0.4)
    sliding = (1.0 + factor) * level * math.copysign(1.0, speed) + (1.0 + share * factor) * viscous * speed
    within = pytest.approx(0.0, abs=1e-12 * (level + viscous * abs(speed)))
    assert law.steady(speed, angle=angle) - sliding - stored == within
    forward, backward = law.hold([1.0, -1.0], angle=angle)
    assert forward - (1.0 + factor) * level - stored == within
    assert backward - (1.0 + factor) * level + stored == within


# Kinematic error


TURN = np.linspace(-math.pi, math.pi, 65)


@pytest.mark.parametrize(("combine", "order"), [("single", 1), ("mean", 2), ("max", 1)])
@given(st.floats(0.5, 2.0), st.floats(-math.pi, math.pi), st.floats(0.5, 2.0))
def test_a_smaller_misalignment_leaves_less_error(combine: str, order: int, size: float, direction: float, tilt: float) -> None:
    """In proportion where one lobe carries, with the square where both carry alike."""

    def largest(scale: float) -> float:
        law = made(
            Misalignment,
            offset=4e-3,
            housing_eccentricity=1e-4 * size * scale,
            housing_direction=direction,
            housing_tilt_x=0.002 * tilt * scale,
            combine=combine,
        )
        return float(np.abs(law.error(TURN)).max())

    assert math.log10(largest(0.1) / largest(0.01)) == pytest.approx(order, abs=0.02)
    assert largest(0.0) == 0.0


@given(models("kinematic_error"))
def test_an_error_beside_noise_of_no_amplitude_is_the_error_alone(error: Any) -> None:
    silent = Stochastic(amplitude=0.0, speed_sensitivity=10.0, seed=3)
    assert silent.error(TURN).tolist() == silent.slope(TURN).tolist() == len(TURN) * [0.0]
    gear = STEADY_DRIVE.gear
    drive = STEADY_DRIVE.replace(gear=gear.replace(kinematic_error=suited(error, gear.kinematics)))
    assert drive.replace(gear=drive.gear.replace(kinematic_noise=silent)).rest() == drive.rest()


def test_noise_and_harmonics_of_no_amplitude_do_nothing_in_a_drive() -> None:
    plain = in_a_drive(kinematic_error=Fourier())
    assert in_a_drive(kinematic_error=Fourier(), kinematic_noise=Stochastic(amplitude=0.0, seed=3)).tolist() == plain.tolist()
    zero = Fourier(order=[1.0, 2.02], amplitude=[0.0, 0.0], phase=[0.3, 0.4])
    assert in_a_drive(kinematic_error=zero).tolist() == plain.tolist()
    aligned = in_a_drive(kinematic_error=made(Misalignment))
    np.testing.assert_allclose(aligned, plain, rtol=0.0, atol=1e-12 * np.abs(plain).max())


@given(st.integers(0, 2**24 - 1), st.floats(1e-6, 1e-3), st.floats(1e-3, 1.0))
def test_noise_is_proportional_to_its_amplitude(seed: int, amplitude: float, share: float) -> None:
    whole = Stochastic(amplitude=amplitude, seed=seed)
    part = whole.replace(amplitude=share * amplitude)
    np.testing.assert_allclose(part.error(TURN), share * whole.error(TURN), rtol=1e-14)


@pytest.mark.parametrize(
    "effect",
    [
        {"kinematic_noise": Stochastic(amplitude=0.0, seed=1)},
        {"friction_input": Thermal(law=Cyclic(law=DRIVE.gear.friction_input), dry_fall=0.02, viscous_fall=0.03)},
        {"friction_output": Thermal(law=Cyclic(law=DRIVE.gear.friction_output), viscous_fall=0.03)},
    ],
    ids=lambda effect: "".join(effect),
)
def test_an_effect_taken_to_zero_leaves_the_reference_drive_as_it_is(effect: dict[str, Any]) -> None:
    plain = sw.simulate(DRIVE, command(0.2))
    rich = sw.simulate(DRIVE.replace(gear=DRIVE.gear.replace(**effect)), command(0.2))
    for name in plain.names:
        assert rich[name].tolist() == plain[name].tolist()
