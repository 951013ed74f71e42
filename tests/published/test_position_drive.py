"""The drive of document P, with r = 1/100 (E-P1, E-P2), against numbers computed independently at high precision.

Its friction is the simplified model, of the motor side unless a test says otherwise.
"""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
import pytest
import strainwave as sw
from hypothesis import given, settings, strategies as st
from scipy.linalg import expm

from tests.support.samples import sample

COULOMB = 0.072  # N.m, s3 of Table 1
BREAKAWAY = 1.0388 * COULOMB
MOTOR_DAMPING, LOAD_DAMPING = 0.0004, 0.0010  # N.m.s/rad, Table 3

GEAR = sw.Gear(
    kinematics=sw.kinematics.PlainRatio(reduction=100.0),
    stiffness=sw.stiffness.Linear(k=150.0),
    friction_input=sw.friction.Coulomb(coulomb=COULOMB, breakaway=BREAKAWAY, viscous=MOTOR_DAMPING),
)
DRIVE = sw.Drive(
    gear=GEAR,
    motor=sw.motor.DC(resistance=2.0, inductance=0.0, torque_constant=0.05, back_emf=0.05, inertia=0.0012),
    load=sw.loads.Inertia(inertia=0.0050),
)
LINEAR = DRIVE.replace(
    gear=GEAR.replace(
        friction_input=sw.friction.Viscous(viscous=MOTOR_DAMPING),
        friction_output=sw.friction.Viscous(viscous=LOAD_DAMPING),
    )
)
OPEN_CIRCUIT = DRIVE.motor.replace(torque_constant=0.0)


def first(fulfilled: Callable[[float], bool], low: float, high: float) -> float:
    """Where in (low, high] something begins to hold that does not hold before, to the last digit: bisection."""
    assert not fulfilled(low)
    assert fulfilled(high)
    while low < (middle := 0.5 * (low + high)) < high:
        low, high = (low, middle) if fulfilled(middle) else (middle, high)
    return high


# The linear drive


def propagator(drive: sw.Drive, dt: float) -> np.ndarray:
    """The matrix of one step of a linear drive, over input angle, input speed, transmission error, output speed."""
    names = ("input_angle", "input_speed", "transmission_error", "output_speed")
    rest = drive.rest()
    after = [drive.step(rest.replace(**{name: 1.0}), dt=dt) for name in names]
    return np.array([[getattr(motion, name) for motion in after] for name in names])


def eigenfrequency(drive: sw.Drive) -> float:
    """The highest [rad/s]; the step is of order four, and short enough that its own error lies below 1e-11."""
    dt = 1e-5
    return float(np.abs(np.angle(np.linalg.eigvals(propagator(drive, dt)))).max() / dt)


def undamped(kinematics: object, input_inertia: float, output_inertia: float, k: float) -> sw.Drive:
    return sw.Drive(
        gear=sw.Gear(kinematics=kinematics, stiffness=sw.stiffness.Linear(k=k)),
        motor=sw.motor.DC(torque_constant=0.0, inertia=input_inertia),
        load=sw.loads.Inertia(inertia=output_inertia),
    )


def test_eigenfrequency_of_document_p() -> None:
    drive = undamped(GEAR.kinematics, 0.0012, 0.0050, 150.0)
    assert eigenfrequency(drive) == pytest.approx(173.2411613907041, rel=1e-10)


def test_a_ratio_as_printed_would_give_another_eigenfrequency() -> None:
    """E-P1: with r = 100 the load turns a hundred times the motor."""
    drive = undamped(sw.kinematics.PlainRatio(reduction=0.01), 0.0012, 0.0050, 150.0)
    dt = 1e-7
    turned = np.abs(np.angle(np.linalg.eigvals(propagator(drive, dt)))).max() / dt
    assert turned == pytest.approx(35355.8, abs=0.05)


def test_eigenfrequency_of_the_two_inertia_gear_free_and_with_its_input_locked() -> None:
    reversing = sw.kinematics.StrainWave(flexspline_teeth=200, circular_spline_teeth=202)
    assert eigenfrequency(undamped(reversing, 1.5e-4, 0.05, 8000.0)) == pytest.approx(406.61201818605, rel=1e-10)
    assert eigenfrequency(undamped(reversing, 1e30, 0.05, 8000.0)) == pytest.approx(400.0, rel=1e-10)


def test_step_response_of_the_linear_four_states() -> None:
    run = sw.simulate(LINEAR, sw.scenario.constant(12.0, 0.5), dt=1e-4)
    state = [run[name][-1] for name in ("input_angle", "input_speed", "output_angle", "output_speed")]
    known = [25.15915806045715, 90.36585048354819, 0.2515619529156611, 0.9170600091745092]
    assert state == pytest.approx(known, rel=1e-9)


def test_step_response_is_the_matrix_exponential_at_every_sample() -> None:
    """Document P's state-space form, its r = 1/100."""
    motor, load, k, r = 0.0012, 0.0050, 150.0, 0.01
    damping = MOTOR_DAMPING + 0.05 * 0.05 / 2.0
    system = np.zeros((5, 5))
    system[0, 1] = system[2, 3] = 1.0
    system[1] = [-r * r * k / motor, -damping / motor, r * k / motor, 0.0, 0.05 / 2.0 * 12.0 / motor]
    system[3] = [r * k / load, 0.0, -k / load, -LOAD_DAMPING / load, 0.0]
    run = sw.simulate(LINEAR, sw.scenario.constant(12.0, 0.5), dt=1e-4, sample=0.01)
    exact = np.stack([expm(system * time)[:4, 4] for time in run["time"]])
    for column, name in enumerate(("input_angle", "input_speed", "output_angle", "output_speed")):
        np.testing.assert_allclose(run[name], exact[:, column], rtol=0.0, atol=1e-9 * np.abs(exact[:, column]).max())


# Set-valued friction


def test_no_load_speed_and_current() -> None:
    """Without friction at the load; the gear is damped, which a steady state does not feel."""
    damped = DRIVE.replace(gear=GEAR.replace(damping=1.0))
    run = sw.simulate(damped, sw.scenario.constant(12.0, 30.0), dt=1e-3, sample=30.0)
    assert run["input_speed"][-1] == pytest.approx(138.1818181818, rel=1e-12)
    assert run["output_speed"][-1] == pytest.approx(1.381818181818, rel=1e-12)
    assert run["current"][-1] == pytest.approx(2.545454545455, rel=1e-12)


def driven(voltage: float) -> sw.Recording:
    return sw.simulate(DRIVE, sw.scenario.constant(voltage, 0.02), dt=1e-3)


def test_breakaway_voltage() -> None:
    threshold = first(lambda voltage: driven(voltage)["input_speed"].any(), 2.0, 4.0)
    assert threshold == pytest.approx(2.991744, rel=1e-15)


def test_below_breakaway_the_drive_stands_still_to_the_last_bit() -> None:
    run = driven(2.99174)
    for name in ("input_angle", "input_speed", "output_angle", "output_speed", "twist", "torque"):
        assert not run[name].any()
    assert np.ptp(run["current"]) == np.ptp(run["friction_input"]) == 0.0
    assert run["friction_input"][0] == pytest.approx(0.05 * 2.99174 / 2.0, rel=1e-15)
    state = DRIVE.rest()
    assert DRIVE.step(state, command=2.99174, dt=1e-3).replace(elapsed=0.0) == state


def coasting(duration: float) -> sw.Recording:
    """From 100 rad/s with the circuit open; the gear so soft that the load stays out of it."""
    drive = DRIVE.replace(gear=GEAR.replace(stiffness=sw.stiffness.Linear(k=1e-30)), motor=OPEN_CIRCUIT)
    rest = drive.rest()
    start = rest.replace(input_speed=100.0, input_slip_direction=1.0)
    return sw.simulate(drive, sw.scenario.constant(0.0, duration), dt=1e-3, sample=duration, initial=start)


def test_coasting_down_takes_its_time_and_angle() -> None:
    stop = first(lambda duration: coasting(duration)["input_speed"][-1] == 0.0, 1.3, 1.4)
    assert stop == pytest.approx(1.32549825684, rel=1e-11)
    assert coasting(2.0)["input_angle"][-1] == pytest.approx(61.4103137693, rel=1e-11)


def test_the_coulomb_oscillator_turns_at_its_peaks_and_sticks() -> None:
    """A mass on a spring to a wall, here an output of endless inertia, with dry friction at the mass."""
    stiction = sw.friction.Coulomb(coulomb=COULOMB, breakaway=COULOMB)
    oscillator = sw.Drive(
        gear=sw.Gear(
            kinematics=sw.kinematics.PlainRatio(reduction=1.0),
            stiffness=sw.stiffness.Linear(k=0.5),
            friction_input=stiction,
        ),
        motor=sw.motor.DC(torque_constant=0.0, inertia=0.0012),
        load=sw.loads.Inertia(inertia=1e30),
    )
    rest = oscillator.rest()
    start = rest.replace(input_angle=1.0, transmission_error=1.0)

    def after(duration: float) -> sw.Recording:
        return sw.simulate(oscillator, sw.scenario.constant(0.0, duration), dt=1e-4, sample=duration, initial=start)

    stuck = 0.4617179388582711
    peaks = [after(stuck * half_periods / 3.0)["input_angle"][-1] for half_periods in (1, 2, 3)]
    assert peaks == pytest.approx([-0.712, 0.424, -0.136], rel=1e-10)
    assert first(lambda time: after(time)["input_speed"][-1] == 0.0, 0.45, 0.47) == pytest.approx(stuck, rel=1e-10)
    assert after(1.0)["input_angle"][-1] == pytest.approx(-0.136, rel=1e-10)


# Further cases


@pytest.mark.parametrize("voltage", [12.0, -24.0, 4.0])
def test_no_load_speed_of_the_set_with_friction_at_its_load(voltage: float) -> None:
    """(K_m u / R - f_cm - f_cl / N) / (b_m + b_l / N^2 + K_m K_b / R)."""
    drive = sw.load("position-drive")
    drive = drive.replace(gear=drive.gear.replace(damping=1.0), control=sw.control.OpenLoop())
    run = sw.simulate(drive, sw.scenario.constant(voltage, 30.0), dt=1e-3, sample=30.0)
    torque = 0.05 * abs(voltage) / 2.0 - COULOMB - 0.18 / 100.0
    speed = math.copysign(torque / (MOTOR_DAMPING + LOAD_DAMPING / 1e4 + 0.05**2 / 2.0), voltage)
    assert run["input_speed"][-1] == pytest.approx(speed, rel=1e-11)
    assert run["current"][-1] == pytest.approx((voltage - 0.05 * speed) / 2.0, rel=1e-11)


@given(st.floats(1e-4, 1e-2), st.floats(0.01, 0.3), st.floats(1e-4, 5e-3), st.floats(5.0, 300.0))
@settings(max_examples=sample(10, 25))
def test_coasting_down_from_any_speed(inertia: float, level: float, viscous: float, speed: float) -> None:
    """It takes (J / b) ln(1 + b w / f), over an angle of (J w - f t) / b."""
    stop = inertia / viscous * math.log1p(viscous * speed / level)
    drive = DRIVE.replace(
        gear=GEAR.replace(
            stiffness=sw.stiffness.Linear(k=1e-30),
            friction_input=sw.friction.Coulomb(coulomb=level, breakaway=level, viscous=viscous),
        ),
        motor=OPEN_CIRCUIT.replace(inertia=inertia),
    )
    start = drive.rest().replace(input_speed=speed, input_slip_direction=1.0)

    def after(duration: float) -> sw.Recording:
        return sw.simulate(drive, sw.scenario.constant(0.0, duration), dt=stop / 500.0, sample=duration, initial=start)

    assert after(stop * (1.0 - 1e-9))["input_speed"][-1] > 0.0
    stopped = after(stop * (1.0 + 1e-9))
    assert stopped["input_speed"][-1] == 0.0
    assert stopped["input_angle"][-1] == pytest.approx((inertia * speed - level * stop) / viscous, rel=1e-9)


@given(st.floats(1e-4, 1e-2), st.floats(0.1, 10.0), st.floats(0.05, 0.45), st.floats(0.1, 10.0))
@settings(max_examples=sample(10, 25))
def test_a_coulomb_oscillator_of_any_numbers_loses_as_much_at_each_peak(
    inertia: float, k: float, share: float, start_angle: float
) -> None:
    """Peak n lies at (-1)^n (x_0 - 2 n F / k), half a period after the one before, until it is within F / k."""
    level = share * k * start_angle
    law = sw.friction.Coulomb(coulomb=level, breakaway=level)
    oscillator = sw.Drive(
        gear=sw.Gear(
            kinematics=sw.kinematics.PlainRatio(reduction=1.0), stiffness=sw.stiffness.Linear(k=k), friction_input=law
        ),
        motor=sw.motor.TorqueSource(inertia=inertia),
        load=sw.loads.Inertia(inertia=1e30),
    )
    half = math.pi * math.sqrt(inertia / k)
    peaks = [start_angle]
    while abs(peaks[-1]) > level / k:
        peaks.append(-peaks[-1] + math.copysign(2.0 * level / k, peaks[-1]))
    start = oscillator.rest().replace(input_angle=start_angle, transmission_error=start_angle)
    duration = len(peaks) * half
    run = sw.simulate(oscillator, sw.scenario.constant(0.0, duration), dt=half / 500.0, sample=half, initial=start)
    found = run["input_angle"][: len(peaks)]
    assert found == pytest.approx(peaks, abs=1e-9 * start_angle)
    assert run["input_speed"][-1] == 0.0


class Slider:
    """An output with dry friction, drawn at constant speed through a gear: the mass on a belt of every textbook.

    It sets off when the spring carries `breakaway`. With u = twist - coulomb / k, then u'' = -w² u, from u = a with u' = speed,
    a = (breakaway - coulomb) / k, until the output rests, where u' = speed again: at u = -a, after half a period and
    2 arctan(speed / (w a)) / w.
    """

    inertia, k, coulomb, breakaway, speed = 0.05, 800.0, 2.0, 3.2, 0.6
    w = math.sqrt(k / inertia)
    a = (breakaway - coulomb) / k
    first_breakaway = breakaway / (k * speed)
    slipping = (math.pi + 2.0 * math.atan2(speed, w * a)) / w
    sticking = 2.0 * a / speed
    period = slipping + sticking
    restick_torque = 2.0 * coulomb - breakaway

    def after(self, duration: float, method: str) -> sw.Recording:
        stiction = sw.friction.Coulomb(coulomb=self.coulomb, breakaway=self.breakaway)
        gear = GEAR.replace(
            stiffness=sw.stiffness.Linear(k=self.k), friction_input=sw.friction.Viscous(), friction_output=stiction
        )
        drive = sw.Drive(
            gear=gear,
            motor=sw.motor.DC(torque_constant=0.0, back_emf=0.0, inertia=1e30),
            load=sw.loads.Inertia(inertia=self.inertia),
        )
        rest = drive.rest()
        start = rest.replace(input_speed=100.0 * self.speed)
        still = sw.scenario.constant(0.0, duration)
        if method == "adaptive":
            return sw.simulate_adaptively(drive, still, rtol=1e-10, sample=duration, initial=start)
        return sw.simulate(drive, still, dt=1e-4, sample=duration, initial=start)


@pytest.mark.slow("physics")
@pytest.mark.parametrize("cycles", [0, 1, 4])
@pytest.mark.parametrize("method", ["fixed steps", "adaptive"])
def test_the_limit_cycle_of_stick_and_slip_has_its_closed_form(method: str, cycles: int) -> None:
    """When it sets off, when it sticks again, and what the spring carries there, in the first period and in later ones."""
    slider = Slider()
    breakaway = slider.first_breakaway + cycles * slider.period
    restick = breakaway + slider.slipping

    def moves(time: float) -> bool:
        return slider.after(time, method)["output_speed"][-1] != 0.0

    set_off = first(moves, breakaway - 0.2 * slider.sticking, breakaway + 0.5 * slider.slipping)
    assert set_off == pytest.approx(breakaway, rel=1e-9)
    stuck = first(lambda time: not moves(time), breakaway + 0.5 * slider.slipping, restick + 0.2 * slider.sticking)
    assert stuck == pytest.approx(restick, rel=1e-9)
    held = slider.after(stuck, method)
    assert held["torque"][-1] == pytest.approx(slider.restick_torque, rel=1e-9)
    assert held["friction_output"][-1] == pytest.approx(slider.restick_torque, rel=1e-9)
    assert held["output_angle"][-1] == pytest.approx(slider.speed * restick - slider.restick_torque / slider.k, rel=1e-9)


class Twins:
    """An input and an output that are equal but for the ratio, pushed by torques that rise evenly: all events come in pairs.

    Pushed apart, each is a mass on a spring of twice the stiffness whose other end recedes at `speed`: the slider above, with
    its stick and slip. Pushed the same way, or coasting, they move as one and leave the gear untwisted.
    """

    inertia, coulomb, breakaway, rate = 0.0012, 0.05, 0.081, 0.4  # at the input; N.m/s
    set_off = breakaway / rate

    def __init__(self, ratio: float, k: float = 0.5) -> None:
        self.ratio, self.k = ratio, k
        self.speed = self.rate / (2.0 * k)
        self.w = math.sqrt(2.0 * k / self.inertia)
        self.a = (self.breakaway - self.coulomb) / (2.0 * k)
        self.slipping = (math.pi + 2.0 * math.atan2(self.speed, self.w * self.a)) / self.w
        self.period = self.slipping + 2.0 * (self.breakaway - self.coulomb) / self.rate
        self.drive = sw.Drive(
            gear=sw.Gear(
                kinematics=sw.kinematics.PlainRatio(reduction=ratio),
                stiffness=sw.stiffness.Linear(k=self.k * ratio**2),
                friction_input=sw.friction.Coulomb(coulomb=self.coulomb, breakaway=self.breakaway),
                friction_output=sw.friction.Coulomb(coulomb=self.coulomb * ratio, breakaway=self.breakaway * ratio),
            ),
            motor=sw.motor.DC(resistance=1.0, torque_constant=1.0, back_emf=0.0, inertia=self.inertia),
            load=sw.loads.Inertia(inertia=self.inertia * ratio**2),
        )

    def pushes(self, duration: float, apart: bool) -> tuple[sw.scenario.Scenario, sw.scenario.Scenario]:
        """The motor's torque and the load's."""
        torque = sw.scenario.ramp(self.rate, duration)
        return torque, (self.ratio if apart else -self.ratio) * torque

    def pushed(self, duration: float, apart: bool, method: str, sample: float | None = None) -> sw.Recording:
        torque, load = self.pushes(duration, apart)
        if method == "adaptive":
            return sw.simulate_adaptively(self.drive, torque, rtol=1e-10, sample=sample or duration, load_torque=load)
        return sw.simulate(self.drive, torque, dt=1e-4, sample=sample or duration, load_torque=load)

    def apart(self, time: float) -> float:
        """The input angle in closed form; the output's is as far on the other side."""
        periods, s = divmod(max(time - self.set_off, 0.0), self.period)
        s = min(s, self.slipping)
        drawn = self.speed * (periods * self.period + s)
        return drawn + self.a * (1.0 - math.cos(self.w * s)) - self.speed / self.w * math.sin(self.w * s)

    def along(self, time: float) -> float:
        s = max(time - self.set_off, 0.0)
        return (0.5 * (self.breakaway - self.coulomb) * s**2 + self.rate * s**3 / 6.0) / self.inertia


twins = pytest.mark.parametrize("ratio", [1.0, 64.0, 100.0, 30.3])
by_either_method = pytest.mark.parametrize("method", ["fixed steps", "adaptive"])


@twins
@by_either_method
@pytest.mark.parametrize("apart", [True, False])
def test_two_sides_that_break_away_and_stop_at_one_instant_have_their_closed_form(
    ratio: float, method: str, apart: bool
) -> None:
    """Over three cycles of stick and slip; to the bit at one instant with a power of two, within rounding with other ratios."""
    pair = Twins(ratio)
    run = pair.pushed(pair.set_off + 2.9 * pair.period if apart else 0.5, apart, method, sample=1e-3)
    angle = np.array([(pair.apart if apart else pair.along)(time) for time in run["time"]])
    output = (-angle if apart else angle) / ratio
    within = 1e-8 * np.abs(angle).max()
    np.testing.assert_allclose(run["input_angle"], angle, rtol=0.0, atol=within)
    np.testing.assert_allclose(run["output_angle"], output, rtol=0.0, atol=within / abs(ratio))
    assert np.array_equal(run["input_speed"] == 0.0, run["output_speed"] == 0.0)
    assert np.count_nonzero(np.diff(run["input_speed"] == 0.0)) == (6 if apart else 1)


@twins
@by_either_method
@pytest.mark.parametrize("side", ["input", "output"])
def test_either_of_two_sides_that_break_away_at_one_instant_does_so(ratio: float, method: str, side: str) -> None:
    pair = Twins(ratio)
    set_off = first(lambda time: pair.pushed(time, True, method)[f"{side}_speed"][-1] != 0.0, 0.2, 0.205)
    assert set_off == pytest.approx(pair.set_off, rel=1e-9)


def test_pairs_of_events_in_a_pack_have_their_closed_forms() -> None:
    """Members with springs of their own, so that each stops when others slide."""
    stiffness = np.linspace(0.4, 0.6, 11)
    base, pairs = Twins(64.0), [Twins(64.0, k) for k in stiffness]
    torque, load = base.pushes(1.0, apart=True)
    springs = {"gear.stiffness.k": stiffness * 64.0**2}
    runs = sw.simulate_many(base.drive, torque, springs, 1e-4, sample=1e-3, load_torque=load)
    angles = np.array([[pair.apart(time) for time in runs.time] for pair in pairs])
    np.testing.assert_allclose(runs["input_angle"], angles, rtol=0.0, atol=1e-8 * angles.max())
    np.testing.assert_allclose(runs["output_angle"], -angles / 64.0, rtol=0.0, atol=1e-8 * angles.max() / 64.0)


@twins
@pytest.mark.parametrize("side", ["input", "output"])
def test_two_sides_that_coast_down_together_stop_at_one_instant(ratio: float, side: str) -> None:
    pair, speed = Twins(ratio), 20.0
    rest = pair.drive.rest()
    start = rest.replace(
        input_speed=speed,
        output_speed=speed / ratio,
        input_slip_direction=1.0,
        output_slip_direction=math.copysign(1.0, ratio),
    )

    def after(duration: float) -> sw.Recording:
        return sw.simulate(pair.drive, sw.scenario.constant(0.0, duration), dt=1e-3, sample=duration, initial=start)

    stop = first(lambda duration: after(duration)[f"{side}_speed"][-1] == 0.0, 0.4, 0.5)
    assert stop == pytest.approx(pair.inertia * speed / pair.coulomb, rel=1e-11)
    end = after(1.0)
    assert end["input_angle"][-1] == pytest.approx(pair.inertia * speed**2 / (2.0 * pair.coulomb), rel=1e-11)
    assert ratio * end["output_angle"][-1] == pytest.approx(end["input_angle"][-1], rel=1e-11)
    assert end["input_speed"][-1] == end["output_speed"][-1] == 0.0
