"""What a whole gear obeys, whatever its laws: it stays finite, no friction drives it, and energy is neither made nor lost."""

from __future__ import annotations

import math
import warnings
from typing import Any

import numpy as np
import pytest
import strainwave as sw
from hypothesis import HealthCheck, assume, given, settings, strategies as st
from numpy.typing import NDArray
from strainwave import Drive, _core
from strainwave.friction import LuGre, MixedLubrication, PositionDependent
from strainwave.kinematic_error import Fourier, MicroSlip, Misalignment, Scaled, Stochastic, TemperatureDependent, ToothErrors
from strainwave.simulation.signals import outputs
from strainwave.simulation.state import beginning_numbers
from strainwave.stiffness import Cubic, Linear, MultiCompliance, Piecewise, ThreeSegment

from tests.support.samples import sample
from tests.support.strategies import SUITED, built, drives, gears, log_uniform, made, models, signed, suited, without_detent

Array = NDArray[np.float64]

DURATION, SAMPLE = 0.05, 5e-4  # s
ROOM = 293.15  # K
PLACES = ("friction_input", "friction_mesh", "friction_output")
FAMILIES = {
    "kinematics": "kinematics",
    "kinematic_error": "kinematic_error",
    "kinematic_noise": "kinematic_noise",
    "stiffness": "stiffness",
    "hysteresis": "hysteresis",
    **dict.fromkeys(PLACES, "friction"),
    "softening": "softening",
    "material": "material",
}
MANY_CELLS = pytest.mark.slow("physics")  # each look into a map takes long
EVERY_PART = [
    pytest.param(part, model, id=f"{part}={model.name}", marks=MANY_CELLS if model.name == "angle_speed_map" else ())
    for part, family in FAMILIES.items()
    for model in _core.families[family].values()
]

# A gear with an effect of every kind; each test changes one of them.
GEAR = sw.Gear(
    kinematic_error=Fourier(order=[2.0, 4.0], amplitude=[3e-4, 0.8e-4], phase=[0.3, -1.1]),
    stiffness=Cubic(a1=1.2e4, a3=1e9),
    hysteresis=sw.hysteresis.MaxwellSlip(stiffness=[2e3, 1e3], breakaway=[0.3, 0.6]),
    damping=5.0,
    friction_input=sw.friction.Stribeck(coulomb=0.02, breakaway=0.03, stribeck_speed=2.0, viscous=5e-5),
    friction_mesh=sw.friction.LoadDependent(
        driving_forward=0.1, driving_reverse=0.15, backdriving_forward=0.2, backdriving_reverse=0.25
    ),
    friction_output=sw.friction.Coulomb(coulomb=0.5, breakaway=0.7, viscous=0.1),
    input_inertia=2e-5,
)
DRIVE = Drive(
    gear=GEAR,
    motor=sw.motor.DC(resistance=0.5, inductance=5e-4, torque_constant=0.1, back_emf=0.1, inertia=1e-4),
    load=sw.loads.Pendulum(inertia=0.05, gravity_torque=2.0),
)
REVERSAL = sw.scenario.sine(12.0, 30.0, DURATION)  # V: both senses of motion, rest between them

commands = st.one_of(
    st.floats(-24.0, 24.0).map(lambda voltage: sw.scenario.constant(voltage, DURATION)),
    st.tuples(st.floats(-24.0, 24.0), st.floats(5.0, 100.0)).map(lambda drawn: sw.scenario.sine(*drawn, DURATION)),
)
loads = st.one_of(
    st.floats(-30.0, 30.0),
    st.tuples(st.floats(-30.0, 30.0), st.floats(5.0, 100.0)).map(lambda drawn: sw.scenario.sine(*drawn, DURATION)),
)
temperatures = st.floats(250.0, 350.0)


reducers = models("kinematics").filter(lambda kinematics: 1.0 <= abs(kinematics.ratio) <= 1e3)
reduced_gears = st.builds(
    lambda gear, kinematics: gear.replace(
        kinematics=kinematics, **{name: suited(getattr(gear, name), kinematics) for name in SUITED}
    ),
    gears,
    reducers,
)


def laws(part: str, model: Any) -> st.SearchStrategy[Any]:
    """A model for a part, of gears that reduce the speed."""
    return built(model).filter(lambda law: part != "kinematics" or 1.0 <= abs(law.ratio) <= 1e3)


def changed(part: str, law: Any) -> Drive:
    return DRIVE.replace(gear=GEAR.replace(**{part: suited(law, GEAR.kinematics)}))


def innermost(law: Any) -> Any:
    """The law that others modulate."""
    return innermost(law.law) if hasattr(law, "law") else law


def widened(law: Any) -> Any:
    """The same law; but for a curve over angle or speed that is so narrow that a single step passes it."""
    if isinstance(law, PositionDependent):
        begins_anew = {"quadratic": 0.0, "linear": 0.0} if law.outside == "periodic" else {}  # there the curve would jump
        return law.replace(domain_end=max(law.domain_end, law.domain_start + 0.1), **begins_anew)
    if isinstance(law, MixedLubrication):
        return law.replace(stribeck_speed=max(law.stribeck_speed, 0.1))
    return law.replace(law=widened(law.law)) if hasattr(law, "law") else law


def passive(law: Any) -> bool:
    """Whether a law of friction, and the one it modulates, says that it cannot create energy."""
    if hasattr(law, "law"):
        return passive(law.law)
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        if hasattr(law, "check"):
            law.check()
    return not caught


def steady(noise: Any) -> bool:
    """Whether a random error follows the angle alone."""
    return not noise.active or (isinstance(noise, Stochastic) and noise.load_sensitivity == noise.speed_sensitivity == 0.0)


def cannot_create_energy(gear: sw.Gear) -> bool:
    """A random error does work of its own where its amplitude changes with load and speed."""
    return steady(gear.kinematic_noise) and all(passive(getattr(gear, place)) for place in PLACES)


def resolved(drive: Drive, command: sw.scenario.Scenario, dt: float = 1e-4, **others: Any) -> sw.Recording:
    """A run at the first step of `dt` and an eighth of it that resolves it; none where it would take a smaller one.

    Nor where a part is not valid, or where the run of a gear that can create energy ends.
    """
    refusals = []
    for step in (dt, dt / 8.0):
        try:
            return sw.simulate(drive, command, step, **others)
        except FloatingPointError as error:
            refusals.append(str(error))
        except ValueError as error:
            assume("lies outside of" not in str(error))
            raise
    assume("too coarse" not in refusals[-1])
    assume(cannot_create_energy(drive.gear))
    raise AssertionError(refusals)


def at_temperature(law: Any, temperature: float) -> Any:
    """The error of a gear as it is by itself at a temperature [K]."""
    if isinstance(law, TemperatureDependent):
        return law.replace(temperature=temperature)
    return law.replace(law=at_temperature(law.law, temperature)) if hasattr(law, "law") else law


def along_run(law: Any, run: sw.Recording, verb: str) -> Array:
    """Value or slope of the deterministic error in a run, which is linear in the temperature."""
    at_room, warm = (at_temperature(law, kelvin) for kelvin in (ROOM, ROOM + 10.0))
    found: Array = getattr(at_room, verb)(run["input_angle"])
    if warm == at_room:
        return found
    return found + (run["temperature"] - ROOM) / 10.0 * (getattr(warm, verb)(run["input_angle"]) - found)


def error_slope(gear: sw.Gear, run: sw.Recording) -> Array:
    """Derivative of the kinematic error, noise included, by the input angle [rad/rad]."""
    slope = along_run(gear.kinematic_error, run, "slope")
    if not gear.kinematic_noise.active:
        return slope
    if steady(gear.kinematic_noise):
        return slope + gear.kinematic_noise.slope(run["input_angle"])
    torque = gear.stiffness.torque(run["transmission_error"] - along_run(gear.kinematic_error, run, "error"))
    places = zip(run["input_angle"].tolist(), torque.tolist(), run["input_speed"].tolist(), strict=True)
    return slope + np.array([gear.kinematic_noise.slope(angle, torque=t, speed=v) for angle, t, v in places])


def relief(gear: sw.Gear, run: sw.Recording) -> tuple[Array, Array]:
    """What load leaves of the error, and how the twist follows the gap between the shafts: delta + f(T(delta)) e = gap."""
    law, twist = gear.kinematic_error, run["twist"]
    if not isinstance(law, Scaled):
        return np.ones_like(twist), np.ones_like(twist)
    torque = gear.stiffness.torque(twist)
    depth, load = np.exp(-law.depth_sensitivity * law.insertion_depth), 1.0 + law.load_sensitivity * np.abs(torque)
    fall = -law.load_sensitivity * np.sign(torque) * depth / load**2 * gear.stiffness.tangent(twist)
    return 1.0 / load, 1.0 / (1.0 + along_run(law.law, run, "error") * fall)


def speeds(gear: sw.Gear, run: sw.Recording) -> dict[str, Array]:
    """How fast each place of friction moves [rad/s]."""
    left, followed = relief(gear, run)
    mesh = followed * run["input_speed"] * (1.0 / gear.kinematics.ratio - left * error_slope(gear, run))
    return dict(zip(PLACES, (run["input_speed"], mesh, run["output_speed"]), strict=True))


def has_memory(law: Any) -> bool:
    return has_memory(law.law) if hasattr(law, "law") else hasattr(law, "State")


def check_friction(gear: sw.Gear, run: sw.Recording) -> None:
    """Friction without memory never gives power, at no instant; up to how exactly a place's speed of zero can be told."""
    assume(np.abs(run["input_speed"]).max() < 1e9)  # a gear that creates energy runs away, to where no angle is known
    for place, speed in speeds(gear, run).items():
        law = getattr(gear, place)
        if not has_memory(law) and law == without_detent(law):  # a detent gives back what it takes
            power = run[place] * speed
            assert power.min() >= -1e-15 * np.abs(run[place]).max() * np.abs(speed).max()


# Rest

ROUNDING_SPEEDS = signed(log_uniform(1e-20, 1e-13))  # rad/s of the output, as the rate of a sine at its peak has them
STILL = np.array([0.0, 0.0, 0.0, 0.0, 293.15, 0.0])  # inputs


@pytest.mark.parametrize(("part", "model"), [each for each in EVERY_PART if each.values[0] in PLACES])
@settings(max_examples=sample(4, 10))
@given(data=st.data(), speed=ROUNDING_SPEEDS, angle=st.floats(-1.0, 1.0))
def test_a_speed_of_rounding_neither_bends_bristles_nor_winds_up_the_gear(
    part: str, model: Any, data: st.DataObject, speed: float, angle: float
) -> None:
    law = data.draw(laws(part, model))
    assume(getattr(innermost(law), "exponent", 1.0) >= 0.5)  # else a torque per power of the speed is one at this speed, too
    drive = changed(part, law)
    at_rest, moving = (beginning_numbers(drive, {"output_angle": angle, "output_speed": each}, STILL) for each in (0.0, speed))
    np.testing.assert_allclose(moving, at_rest, rtol=1e-9, atol=1e-9)


# Finite, and no friction drives


@pytest.mark.parametrize(("part", "model"), EVERY_PART)
@settings(max_examples=sample(4, 10))
@given(data=st.data())
def test_a_gear_with_any_law_at_any_place_stays_finite_and_no_friction_drives(
    part: str, model: Any, data: st.DataObject
) -> None:
    drive = changed(part, data.draw(laws(part, model)))
    run = resolved(drive, data.draw(commands), sample=SAMPLE, load_torque=data.draw(loads), temperature=data.draw(temperatures))
    assert all(np.isfinite(run[name]).all() for name in outputs(sw.Drive()))
    assert run["time"][-1] == DURATION
    check_friction(drive.gear, run)


@pytest.mark.slow("physics")
@settings(max_examples=sample(20, 60))
@given(reduced_gears, commands, loads, temperatures)
def test_any_gear_stays_finite_and_no_friction_drives(
    gear: sw.Gear, command: sw.scenario.Scenario, load: float | sw.scenario.Scenario, temperature: float
) -> None:
    run = resolved(DRIVE.replace(gear=gear), command, sample=SAMPLE, load_torque=load, temperature=temperature)
    assert all(np.isfinite(run[name]).all() for name in outputs(sw.Drive()))
    check_friction(gear, run)


# What goes in is stored or lost


def cumulated(power: Array, dt: float, kinks: Array) -> tuple[Array, Array]:
    """Integral of a power [J], at every second sample, and how far the trapezia over one and over two samples differ so far.

    Where a pair of samples holds a kink they may agree by chance: there the power is anything between its samples.
    """
    fine = 0.5 * dt * (power[:-2:2] + 2.0 * power[1:-1:2] + power[2::2])
    coarse = dt * (power[:-2:2] + power[2::2])
    spread = dt * np.abs(np.diff(power)).reshape(-1, 2).sum(axis=1)
    slack = np.where(kinks, spread, np.abs(fine - coarse))
    return np.append(0.0, np.cumsum(fine)), np.append(0.0, np.cumsum(slack))


def softened(softening: Any, temperature: Array) -> tuple[float, float]:
    """What spring and hysteresis are multiplied by, at one temperature [K]."""
    warmth = float(temperature[0]) - softening.reference_temperature
    return math.exp(-softening.stiffness_fall * warmth), math.exp(-softening.hysteresis_fall * warmth)


def balance(drive: Drive, run: sw.Recording) -> tuple[Array, Array, float]:
    """Energy [J] put in less stored and lost; how exactly the samples tell; and how much was put in to and fro."""
    gear, step = drive.gear, run["time"][1]
    moving = speeds(gear, run)
    put_in = drive.motor.torque_constant * run["current"] * run["input_speed"] - run["load_torque"] * run["output_speed"]
    twist_rate = moving["friction_mesh"] - relief(gear, run)[1] * run["output_speed"]
    lost = gear.damping * twist_rate**2 + sum(run[place] * moving[place] for place in PLACES)
    inertia = drive.motor.inertia + gear.input_inertia
    kept = 0.5 * (inertia * run["input_speed"] ** 2 + drive.load.inertia * run["output_speed"] ** 2)
    of_stiffness, of_hysteresis = softened(gear.softening, run["temperature"])
    kept += of_stiffness * gear.stiffness.energy(run["twist"]) + of_hysteresis * gear.hysteresis.work(run["twist"])
    kept += gear.material.work(run.time, run["twist"])
    turns = np.any([np.diff(np.sign(speed)) != 0.0 for speed in moving.values()], axis=0)
    kinks = turns.reshape(-1, 2).any(axis=1)  # a place stops, sets off or turns round
    supplied, slack_supplied = cumulated(put_in, step, kinks)
    taken, slack_taken = cumulated(lost, step, kinks)
    return supplied - taken - kept[::2] + kept[0], slack_supplied + slack_taken, float(np.abs(put_in).sum() * step)


@pytest.mark.parametrize(("part", "model"), EVERY_PART)
@settings(max_examples=3, suppress_health_check=[HealthCheck.filter_too_much])  # few bristles drawn are passive
@given(data=st.data())
def test_what_goes_into_a_gear_is_stored_or_lost(part: str, model: Any, data: st.DataObject) -> None:
    law = widened(data.draw(laws(part, model)))
    if isinstance(law, Stochastic):
        law = law.replace(amplitude=1e-4, load_sensitivity=0.0, speed_sensitivity=0.0)
    if isinstance(law, MicroSlip):  # what moves with the speed is in the balance of tests/meter
        law = law.replace(excitation=0.0)
    inner = innermost(law)
    if isinstance(inner, LuGre):  # the damping of one that keeps to no step is followed in first order only
        assume(inner.coulomb / inner.bristle_stiffness > 1e-6)
    drive = changed(part, law)
    assume(cannot_create_energy(drive.gear))
    # A curve as steep as 1e5 N.m/rad holds the input as a spring does that swings within 2e-4 s.
    dt = 2e-6 if isinstance(inner, PositionDependent) else 1e-5
    run = resolved(drive, REVERSAL, dt=dt, load_torque=3.0)
    missing, slack, turned_over = balance(drive, run)
    assume(slack[-1] < 0.05 * turned_over)  # the samples tell
    assert np.all(np.abs(missing) <= slack + 1e-5 * turned_over)


# Without friction and damping


def gap(spring: Any, error: Any, dt: float, steps: int) -> float:
    """How far the energy of the coasting gear strays from where it began, relative to it."""
    drive = Drive(
        gear=sw.Gear(stiffness=spring, kinematic_error=error),
        motor=sw.motor.DC(torque_constant=0.0, inertia=1.5e-4),
        load=sw.loads.Inertia(inertia=0.05),
    )
    rest = drive.rest()
    start = rest.replace(input_speed=50.0, output_speed=-0.2)
    run = sw.simulate(drive, sw.scenario.constant(0.0, dt * steps), dt, sample=100.0 * dt, initial=start)
    energy = 0.5 * (1.5e-4 * run["input_speed"] ** 2 + 0.05 * run["output_speed"] ** 2) + spring.energy(run["twist"])
    assert np.ptp(spring.energy(run["twist"])) > 1e-3 * energy[0]
    return float(np.abs(energy / energy[0] - 1.0).max())


SMOOTH_SPRINGS = (Linear(k=8000.0), Cubic(a1=8000.0, a3=4e9), made(MultiCompliance))
CORNERED_SPRINGS = (
    Piecewise(k1=8000.0, k2=4000.0, knee=2e-4),
    ThreeSegment(k1=8000.0, k2=11000.0, k3=14000.0, t1=1.0, t2=4.0),
)
ASSEMBLY = made(
    Misalignment,
    minor_radius=20e-3,
    offset=4e-3,
    housing_eccentricity=2e-4,
    housing_direction=0.4,
    housing_tilt_x=0.02,
    generator_eccentricity=1e-4,
    generator_direction=0.9,
)
SMOOTH_ERRORS = (
    Fourier(order=[2.0, 4.0], amplitude=[3e-4, 0.8e-4], phase=[0.3, -1.1]),
    Fourier(order=[1.0, 2.02], amplitude=[3e-4, 0.8e-4], phase=[0.3, -1.1]),
    ASSEMBLY.replace(combine="single"),
    ASSEMBLY.replace(combine="mean"),
    made(
        ToothErrors,
        first_lobe=0.7,
        flexspline_amplitude=[4e-6, 8e-6],
        flexspline_phase=[0.3, -1.1],
        circular_spline_amplitude=[2e-6, 8e-6],
        circular_spline_phase=[0.8, 0.0],
    ),
)
smooth_errors = pytest.mark.parametrize(
    "error", SMOOTH_ERRORS, ids=["whole orders", "broken order", "one lobe", "mean of lobes", "teeth"]
)


@smooth_errors
@pytest.mark.parametrize("spring", SMOOTH_SPRINGS, ids=lambda spring: spring.name)
def test_a_hundred_thousand_steps_of_a_conservative_gear_keep_its_energy(spring: Any, error: Any) -> None:
    assert gap(spring, error, 2e-5, 100_000) < 1e-10


@smooth_errors
@pytest.mark.parametrize("spring", SMOOTH_SPRINGS, ids=lambda spring: spring.name)
def test_the_energy_a_smooth_gear_loses_falls_with_the_fifth_power_of_the_step(spring: Any, error: Any) -> None:
    """Of the classical scheme, which loses dt^6 of an amplitude a step."""
    assert np.log2(gap(spring, error, 2e-4, 10_000) / gap(spring, error, 1e-4, 20_000)) == pytest.approx(5.0, abs=0.3)


@smooth_errors
@pytest.mark.parametrize("spring", CORNERED_SPRINGS, ids=lambda spring: spring.name)
def test_a_corner_of_the_spring_costs_accuracy_but_no_more_than_known(spring: Any, error: Any) -> None:
    """A step across it errs in third order, and a tenth of the step leaves far less."""
    fine, coarse = gap(spring, error, 1e-5, 100_000), gap(spring, error, 1e-4, 10_000)
    assert fine < 1e-6
    assert fine < coarse / 10.0


@pytest.mark.parametrize("spring", [*SMOOTH_SPRINGS, *CORNERED_SPRINGS], ids=lambda spring: spring.name)
def test_a_corner_of_the_error_costs_more(spring: Any) -> None:
    """Where the other lobe takes over, the slope of the error jumps, and the torque on the input with it."""
    error = ASSEMBLY.replace(combine="max")
    fine, coarse = gap(spring, error, 1e-5, 100_000), gap(spring, error, 1e-4, 10_000)
    assert fine < 1e-3
    assert fine < coarse / 2.0


# What sticks


@pytest.mark.parametrize("place", PLACES)
@pytest.mark.parametrize("law", [sw.friction.Coulomb(), GEAR.friction_mesh], ids=lambda law: law.name)
@pytest.mark.parametrize("load", [0.0, 1e-3, sw.scenario.sine(20.0, 20.0, DURATION)], ids=["no load", "small load", "load"])
def test_what_can_hold_nothing_without_load_lets_the_drive_rest_and_set_off(
    place: str, law: Any, load: float | sw.scenario.Scenario
) -> None:
    """At rest the hold is nothing, and what it balances is the rounding of a twist: that must not count as motion."""
    parts: dict[str, Any] = {**dict.fromkeys(PLACES, sw.friction.Viscous()), place: law}
    drive = DRIVE.replace(gear=GEAR.replace(**parts), load=sw.loads.Inertia(inertia=0.05))
    run = sw.simulate(drive, sw.scenario.constant(0.0, DURATION), 1e-4, load_torque=load)
    if load == 0.0:
        assert np.abs(run["input_speed"]).max() < 1e-12
    else:
        assert np.abs(run["output_speed"]).max() > 1e-6


@pytest.mark.parametrize("law", [sw.friction.Coulomb(), GEAR.friction_mesh], ids=lambda law: law.name)
@pytest.mark.parametrize("dt", [1e-4, 1e-5])
def test_an_output_that_breaks_away_takes_along_an_input_that_nothing_holds(law: Any, dt: float) -> None:
    """The margin of the input is nothing all the while that the output's is used up."""
    gear = GEAR.replace(friction_input=sw.friction.Viscous(), friction_mesh=law)
    drive = DRIVE.replace(gear=gear, load=sw.loads.Inertia(inertia=0.05))
    load = sw.scenario.sine(-20.0, 20.0, DURATION)
    run = sw.simulate(drive, sw.scenario.constant(0.0, DURATION), dt, load_torque=load)
    breakaway = math.asin(0.7 / 20.0) / (2.0 * math.pi * 20.0)
    stuck = run["time"] < breakaway
    assert not run["output_speed"][stuck].any()
    assert np.all(run["output_speed"][~stuck][1:20] > 0.0)
    assert np.abs(run["input_speed"]).max() > 1.0


@pytest.mark.slow("physics")
@given(backdriving=st.floats(0.5, 8.0), dt=st.floats(2e-6, 2e-5))
def test_an_output_whose_hold_ends_all_at_once_stops_nothing_else(backdriving: float, dt: float) -> None:
    """Its hold is of the sense it is pushed in: none one way, and large the other way up to that very moment."""
    one_way = sw.friction.LoadDependent(driving_reverse=0.08, backdriving_reverse=backdriving)
    run = sw.simulate(changed("friction_output", one_way), REVERSAL, dt, load_torque=3.0)
    moved = run["output_speed"] != 0.0
    assert np.any(~moved[:-1] & moved[1:])  # it was held, and set off
    assert np.abs(np.diff(run["input_speed"])).max() < 1e5 * dt  # rad/s2, of some 10 N.m on 1.2e-4 kg.m2


@pytest.mark.parametrize("place", PLACES)
@given(command=commands, load=loads, breakaway=st.floats(0.0, 1.0))
def test_what_sticks_holds_no_more_than_its_breakaway(
    place: str, command: sw.scenario.Scenario, load: float | sw.scenario.Scenario, breakaway: float
) -> None:
    law = sw.friction.Coulomb(coulomb=0.5 * breakaway, breakaway=breakaway)
    parts: dict[str, Any] = {**dict.fromkeys(PLACES, sw.friction.Viscous()), place: law}
    run = resolved(DRIVE.replace(gear=GEAR.replace(**parts)), command, load_torque=load)
    assert np.abs(run[place]).max() <= breakaway * (1.0 + 1e-14)


@pytest.mark.slow("physics")
@settings(max_examples=sample(10, 30))  # drawing a drive takes longer than the law
@given(drives, st.floats(0.0, 1e9))
def test_a_drive_is_never_slower_at_large_twists_than_at_rest(drive: Drive, twist: float) -> None:
    """Else a run away to them would be taken for one that its steps can follow."""
    assert _core.max_rate(drive, twist) >= _core.max_rate(drive, 0.0)
