"""The linearisation against closed forms, differences, and what a simulation does close by."""

from __future__ import annotations

from math import sqrt, tau

import control
import numpy as np
import pytest
import strainwave as sw
from hypothesis import assume, given, settings, strategies as st
from numpy.typing import NDArray
from scipy.linalg import expm
from strainwave import _core
from strainwave.simulation import signals
from strainwave.simulation.state import StateLayout

from tests.support.geared import MOTOR, RATIO, K, geared, outputs
from tests.support.reference_drive import DRIVE
from tests.support.strategies import built, made, suited

DISC = sw.loads.Inertia(inertia=0.5)
NO_TORQUE = sw.motor.DC(torque_constant=0.0, back_emf=0.0, inertia=5e-4)


# Closed forms


@pytest.mark.parametrize(
    "kinematics", [sw.kinematics.PlainRatio(reduction=RATIO), sw.kinematics.StrainWave()], ids=["plain", "reversing"]
)
def test_two_inertias_on_a_spring_have_their_eigenfrequency(kinematics: object) -> None:
    """sqrt(k (1 / J_out + 1 / (i^2 J_in))), and the two turn against each other around the common centre."""
    drive = geared(DISC, motor=NO_TORQUE, damping=0.0, kinematics=kinematics)
    linear, ratio = sw.linearise(drive), drive.gear.kinematics.ratio
    assert linear.eigenfrequencies[-2:] == pytest.approx([sqrt(K * (1.0 / 0.5 + 1.0 / (ratio**2 * 5e-4)))] * 2, rel=1e-12)
    assert linear.damping_ratios[-2:] == pytest.approx([0.0, 0.0], abs=1e-12)
    assert linear.poles[:2] == pytest.approx([0.0, 0.0], abs=1e-6)
    mode = dict(zip(linear.states, linear.modes[:, -1], strict=True))
    assert mode["output_speed"] / mode["input_speed"] == pytest.approx(-ratio * 5e-4 / 0.5, rel=1e-9)


def test_damping_of_the_gear_damps_its_vibration() -> None:
    """2 zeta w = c (1 / J_out + 1 / (i^2 J_in))."""
    compliance = 1.0 / 0.5 + 1.0 / (RATIO**2 * 5e-4)
    linear = sw.linearise(geared(DISC, motor=NO_TORQUE, damping=5.0))
    assert linear.damping_ratios[-1] == pytest.approx(5.0 * compliance / (2.0 * sqrt(K * compliance)), rel=1e-10)


def test_a_motor_alone_has_its_two_poles() -> None:
    """L J s^2 + R J s + K_m K_b = 0; the load is negligible."""
    drive = geared(sw.loads.Inertia(inertia=1e-12))
    linear = sw.linearise(drive)
    inductance, inertia = MOTOR.inductance, MOTOR.inertia
    expected = np.roots([inductance * inertia, MOTOR.resistance * inertia, MOTOR.torque_constant * MOTOR.back_emf])
    for pole in expected:
        assert np.abs(linear.poles - pole).min() <= 1e-7 * abs(pole)


def test_a_load_sees_the_stiffness_of_controller_and_spring_in_series() -> None:
    """1 / K + R / (K_m k_p i^2): the gear's spring, and the controller's through the gear."""
    linear = sw.linearise(geared(DISC, sw.control.PID(proportional=2.0, derivative=0.05)))
    compliance = 1.0 / K + MOTOR.resistance / (MOTOR.torque_constant * 2.0 * RATIO**2)
    assert linear.response(0.0, input="load_torque") == pytest.approx(-compliance, rel=1e-10)
    assert linear.response(0.0) == pytest.approx(1.0, rel=1e-12)


def test_gravity_adds_to_the_spring_while_the_input_sticks() -> None:
    """J w^2 = k + m g l cos theta_out, and the states of the input are gone."""
    drive = geared(damping=0.0, friction_input=sw.friction.Coulomb(coulomb=5.0))
    start = drive.rest()
    state = sw.analysis.equilibrium(drive, initial=start.replace(input_angle=2.0))
    linear = sw.linearise(drive, state)
    assert linear.states == ("motor.current", "transmission_error", "output_speed")
    stiffness = K + 15.0 * np.cos(outputs(drive, state)["output_angle"])
    assert linear.eigenfrequencies[:2] == pytest.approx([sqrt(stiffness / 0.5)] * 2, rel=1e-12)


def test_the_motor_swings_against_an_output_that_sticks() -> None:
    """J_in w^2 = k / i^2: the transmission error goes with the input."""
    drive = geared(DISC, motor=NO_TORQUE, damping=0.0, friction_output=sw.friction.Coulomb(coulomb=50.0))
    linear = sw.linearise(drive)
    assert linear.states == ("input_angle", "input_speed")
    assert linear.eigenfrequencies == pytest.approx([sqrt(K / RATIO**2 / 5e-4)] * 2, rel=1e-12)
    assert linear.response(0.0, "twist", "load_torque") == 0.0


def test_where_both_sides_stick_nothing_moves() -> None:
    stuck = sw.friction.Coulomb(coulomb=50.0)
    linear = sw.linearise(geared(DISC, motor=NO_TORQUE, friction_input=stuck, friction_output=stuck))
    assert linear.states == ()
    assert [matrix.shape for matrix in linear] == [(0, 0), (0, 4), (16, 0), (16, 4)]
    assert linear.response([1.0, 2.0], "load_torque", "load_torque").tolist() == [1.0, 1.0]


FREQUENCIES = np.array([0.3, 3.0, 11.0, 40.0, 200.0])


@pytest.mark.parametrize("damping", [0.0, 5.0])
def test_transfer_functions_are_those_of_two_masses_and_a_motor(damping: float) -> None:
    """(R + L s) I + K_b s X = U, J_in s^2 X = K_m I - T / i, J_out s^2 Y = T - T_l, T = (k + c s) (X / i - Y)."""
    linear = sw.linearise(geared(DISC, damping=damping))
    for frequency in FREQUENCIES:
        s = tau * 1j * frequency
        spring = K + damping * s
        equations = np.array(
            [
                [MOTOR.resistance + MOTOR.inductance * s, MOTOR.back_emf * s, 0.0],
                [-MOTOR.torque_constant, MOTOR.inertia * s**2 + spring / RATIO**2, -spring / RATIO],
                [0.0, -spring / RATIO, 0.5 * s**2 + spring],
            ]
        )
        answers = np.linalg.inv(equations)
        for column, input_, sense in ((0, "command", 1.0), (2, "load_torque", -1.0)):
            for row, output in enumerate(("current", "input_angle", "output_angle")):
                expected = sense * answers[row, column]
                assert linear.response(frequency, output, input_) == pytest.approx(expected, rel=1e-9), (output, input_)


def test_a_command_moves_its_rate_along() -> None:
    """PD control of an ideal torque source: U = (k_p + k_d s) (i R - X)."""
    motor = sw.motor.DC(resistance=1.0, back_emf=0.0, torque_constant=1.0, inertia=1e-4)
    drive = geared(DISC, sw.control.PID(proportional=2.0, derivative=0.05), motor)
    linear = sw.linearise(drive)
    for frequency in FREQUENCIES:
        s = tau * 1j * frequency
        loop = linear.response(frequency, "voltage") + (2.0 + 0.05 * s) * linear.response(frequency, "input_angle")
        assert loop == pytest.approx((2.0 + 0.05 * s) * RATIO, rel=1e-9)


def test_laws_with_memory_answer_with_their_initial_stiffness() -> None:
    """Also one that has been loaded until it slipped: it turns back first."""
    free = geared(DISC, motor=NO_TORQUE, damping=0.0, friction_input=sw.friction.Coulomb(coulomb=50.0))
    laws = {
        sw.hysteresis.MaxwellSlip(stiffness=[3e3, 2e3], breakaway=[0.5, 100.0]): 5e3,
        sw.hysteresis.FadingMemory(stiffness=4e3, forgetting=1e3): 4e3,
    }
    for law, stiffness in laws.items():
        drive = free.replace(gear=free.gear.replace(hysteresis=law))
        for load_torque in (0.0, 8.0, -8.0):
            linear = sw.linearise(drive, load_torque=load_torque)
            assert linear.eigenfrequencies[-1] == pytest.approx(sqrt((K + stiffness) / 0.5), rel=1e-6), (law, load_torque)


@pytest.mark.parametrize("load_torque", [0.0, 3.0, -3.0])
def test_a_bristle_is_a_spring(load_torque: float) -> None:
    bristle = made(sw.friction.LuGre, coulomb=0.3, breakaway=0.3, bristle_stiffness=50.0, bristle_damping=0.0)
    drive = geared(sw.loads.Inertia(inertia=1e-12), motor=NO_TORQUE, damping=0.0, friction_input=bristle)
    linear = sw.linearise(drive, load_torque=load_torque)
    assert np.abs(linear.eigenfrequencies - sqrt(50.0 / 5e-4)).min() <= 1e-6 * sqrt(50.0 / 5e-4)


def test_a_drive_that_runs_is_seen_from_its_speed() -> None:
    """The pole of the speed is that of viscous friction and back electromotive force; the angle only follows."""
    motor, friction = MOTOR.replace(inductance=0.0), sw.friction.Coulomb(coulomb=0.1, breakaway=0.2, viscous=2e-3)
    drive = geared(DISC, motor=motor, stiffness=sw.stiffness.Linear(k=1e9), friction_input=friction)
    linear = sw.linearise(drive, command=12.0)
    inertia = MOTOR.inertia + 0.5 / RATIO**2
    assert linear.poles[0] == pytest.approx(0.0, abs=1e-9)
    assert linear.poles[1] == pytest.approx(-(0.1 * 0.12 / 0.5 + 2e-3) / inertia, rel=1e-4)


# Differences


PLACES = {
    "kinematics": ["gear.kinematics"],
    "kinematic_error": ["gear.kinematic_error"],
    "kinematic_noise": ["gear.kinematic_noise"],
    "stiffness": ["gear.stiffness"],
    "hysteresis": ["gear.hysteresis"],
    "friction": ["gear.friction_input", "gear.friction_mesh", "gear.friction_output"],
    "motor": ["motor"],
    "control": ["control"],
    "loads": ["load"],
}
EVERYWHERE = [
    pytest.param(place, model, id=f"{place}={name}")
    for family, places in PLACES.items()
    for place in places
    for name, model in _core.families[family].items()
]


def replaced(drive: sw.Drive, place: str, model: object) -> sw.Drive:
    part, _, member = place.partition(".")
    return drive.replace(**{part: getattr(drive, part).replace(**{member: model}) if member else model})


@pytest.mark.parametrize(("place", "model"), EVERYWHERE)
@settings(max_examples=4)
@given(data=st.data())
def test_derivatives_are_those_of_differences(place: str, model: object, data: st.DataObject) -> None:
    """Of every model in every place, by every number of the motion and every input; where a difference is trustworthy."""
    turning = DRIVE.replace(gear=DRIVE.gear.replace(input_inertia=1e-5))
    drive = replaced(turning, place, suited(data.draw(built(model)), turning.gear.kinematics))
    speed, error, sense = data.draw(st.tuples(st.floats(0.5, 5.0), st.floats(1e-5, 1e-4), st.sampled_from([1.0, -1.0])))
    elements = turning.gear.hysteresis  # each has two slopes where it begins to slip
    assume(all(abs(error - f / k) > 1e-7 for k, f in zip(elements.stiffness, elements.breakaway, strict=True)))
    at = drive.rest()
    given = {"motor.current": 0.3, "control.error_integral": 0.01}
    moving = at.replace(
        {name: value for name, value in given.items() if name in at},
        input_angle=0.4,
        input_speed=sense * speed,
        transmission_error=at.transmission_error - error,
        output_speed=sense * 0.02,
    )
    inputs = np.array([0.001, 0.02, 0.7, 0.0, 300.0, 0.0])
    state = _core.relaxed(drive, _core.consistent(drive, moving.numbers), inputs, 1e-4)
    values, slopes = _core.differentiate_rates(drive, state, inputs)
    layout = StateLayout(drive)
    count = layout.count
    size = np.abs(values) + np.abs([*state[:count], *inputs]) @ np.abs(slopes)

    def shifted(column: int, by: float) -> NDArray[np.float64]:
        numbers, acting = np.split(np.append(state[:count], inputs) + by * (np.arange(len(slopes)) == column), [count])
        return _core.differentiate_rates(drive, np.append(numbers, state[count:]), acting)[0]

    sound = 0
    for column, slope in enumerate(slopes):
        h = {layout.places["transmission_error"].start: 1e-8}.get(column, 1e-5)
        ahead, behind = (shifted(column, h) - values) / h, (values - shifted(column, -h)) / h
        wide, narrow = 0.5 * (ahead + behind), (shifted(column, 0.37 * h) - shifted(column, -0.37 * h)) / (0.74 * h)
        rounding = 1e-14 * size / h
        trusted = np.abs(wide - narrow) <= 1e-4 * np.abs(narrow) + rounding
        trusted &= np.abs(ahead - behind) <= 0.5 * np.abs(narrow) + 2.0 * rounding  # no kink between
        assert (np.abs(slope - narrow) <= 3e-4 * np.abs(narrow) + 3.0 * rounding)[trusted].all(), column
        sound += trusted.sum()
    assert sound >= 0.97 * slopes.size


# Close by


@pytest.mark.parametrize("command", [0.0, 0.3])
def test_a_small_step_is_followed_to_second_order(command: float) -> None:
    """exp of the matrices against a run; what the linearisation leaves out falls at least with the square of the step."""
    drive = geared(
        control=sw.control.PID(proportional=2.0, integral=1.0, derivative=0.05),
        stiffness=sw.stiffness.Cubic(a1=1e4, a3=1e10),
        friction_input=sw.friction.Viscous(viscous=1e-3),
        kinematic_error=sw.kinematic_error.Fourier(order=[2], amplitude=[2e-4], phase=[0.4]),
    )
    state = sw.analysis.equilibrium(drive, command=command)
    linear = sw.linearise(drive, state, command=command)
    at_rest, row = outputs(drive, state, command), linear.outputs.index("torque")
    n = len(linear.states)
    matrix = np.zeros((n + 1, n + 1))
    matrix[:n, :n], matrix[:n, n] = linear.A, linear.B[:, 0]
    left_out = []
    for size in (2e-4, 1e-4):
        run = sw.simulate(drive, sw.scenario.constant(command + size, 0.05), dt=1e-5, sample=1e-3, initial=state)
        states = np.array([(expm(matrix * t) @ np.append(np.zeros(n), size))[:n] for t in run["time"]])
        followed = at_rest["torque"] + states @ linear.C[row] + size * linear.D[row, 0]
        assert np.abs(run["torque"] - followed).max() <= 0.05 * np.ptp(run["torque"])
        left_out.append(np.abs(run["torque"] - followed).max())
    assert left_out[0] / left_out[1] > 3.5


def test_the_matrices_are_those_that_python_control_takes() -> None:
    linear = sw.linearise(DRIVE)
    system = control.StateSpace(*linear, **linear.labels)
    assert system.state_labels == list(linear.states)
    assert system.input_labels == list(linear.inputs)
    assert system.output_labels == list(linear.outputs)
    at = tau * 1j * 3.0
    answer = system["twist", "load_torque"](at)
    assert answer == pytest.approx(linear.response(3.0, "twist", "load_torque"), rel=1e-9)


# What it is made of


def test_rows_and_columns_have_names_and_units() -> None:
    linear = sw.linearise(DRIVE)
    assert linear.states == (
        "motor.current",
        "input_angle",
        "input_speed",
        "transmission_error",
        "output_speed",
        "friction_input.deflection",
    )
    assert linear.inputs == ("command", "command_rate", "load_torque", "temperature")
    assert linear.outputs == tuple(signals.outputs(sw.Drive()))
    a, b, c, d = linear
    assert (a.shape, b.shape, c.shape, d.shape) == ((6, 6), (6, 4), (16, 6), (16, 4))
    assert linear.units["motor.current"] == "A"
    assert (linear.units["command"], linear.units["command_rate"]) == ("rad", "rad/s")
    opened = sw.linearise(DRIVE.replace(control=sw.control.OpenLoop(), load=DISC))
    assert (opened.units["command"], opened.units["command_rate"]) == ("V", "V/s")


def test_a_modulated_law_names_the_states_of_the_law_it_holds() -> None:
    law = sw.friction.Thermal(law=sw.friction.Cyclic(law=made(sw.friction.LuGre, viscous=5e-5)), dry_fall=0.01)
    linear = sw.linearise(geared(control=sw.control.PID(), friction_output=law))
    assert "friction_output.deflection" in linear.states


def test_only_an_integral_that_counts_is_a_state() -> None:
    for integral in (0.0, 1.0):
        linear = sw.linearise(geared(control=sw.control.PID(proportional=2.0, integral=integral)))
        assert ("control.error_integral" in linear.states) == (integral > 0.0)


def test_warmth_is_an_input() -> None:
    """Of a steady speed: d omega / d T = -kappa b omega / (b + K_m K_b / R), referred to nothing else."""
    law = sw.friction.Thermal(law=sw.friction.Viscous(viscous=2e-3), viscous_fall=0.025)
    drive = geared(DISC, friction_input=law)
    linear = sw.linearise(drive, command=12.0)
    speed = sw.analysis.equilibrium(drive, command=12.0).input_speed
    slower = 0.025 * 2e-3 * speed / (2e-3 + 0.1 * 0.12 / 0.5)
    assert linear.response(1e-6, "input_speed", "temperature").real == pytest.approx(slower, rel=1e-6)


def test_what_is_not_there_is_refused() -> None:
    linear = sw.linearise(DRIVE)
    with pytest.raises(ValueError, match='output = "speed" must be one of command, input_angle'):
        linear.response(1.0, "speed")
    with pytest.raises(ValueError, match='input = "voltage" must be one of command, command_rate'):
        linear.response(1.0, input="voltage")
    with pytest.raises(ValueError, match="without damping"):
        sw.linearise(geared(DISC, motor=NO_TORQUE)).response(0.0, input="load_torque")
    for frequency in (5e-324, 1.79e308):
        with pytest.raises(ValueError, match=r"without damping|must be finite"):
            sw.linearise(geared(DISC, motor=NO_TORQUE)).response(frequency, input="load_torque")
    with pytest.raises(ValueError, match=r"^load_torque = inf N\.m must be finite"):
        sw.linearise(DRIVE, load_torque=float("inf"))


# The modes of the shafts alone

inertias = st.floats(1e-6, 1e-2)
stiffnesses = st.floats(10.0, 1e6)
ratios = st.floats(0.01, 400.0)
MOTORS = [sw.motor.DC, sw.motor.BrushlessDC, sw.motor.PMSM, sw.motor.TorqueSource, sw.motor.CurrentSource]


def in_closed_form(k: float, ratio: float, j_in: float, j_out: float, at_load: float = 0.0) -> tuple[list[float], list[float]]:
    """Free and with the input held, in closed form: the roots of J_in J_out w^4 - (...) w^2 + k k_load / i^2 = 0."""
    a, b, c = j_in * j_out, j_in * (k + at_load) + j_out * k / ratio**2, k * at_load / ratio**2
    fast = 0.5 * (b + sqrt(b * b - 4.0 * a * c)) / a
    slow = c / (a * fast)
    return [sqrt(w) for w in (slow, fast) if w > 0.0], [sqrt((k + at_load) / j_out)]


@given(stiffnesses, ratios, inertias, inertias, st.floats(0.01, 10.0), st.sampled_from(MOTORS), st.booleans())
def test_modes_of_random_two_inertia_drives(
    k: float, reduction: float, wave_generator: float, rotor: float, j_out: float, motor: type, reversing: bool
) -> None:
    """sqrt(k (1 / J_out + 1 / (i^2 J_in))) and sqrt(k / J_out), with the inertia of any motor, turning either way."""
    kinematics = sw.kinematics.StrainWave() if reversing else sw.kinematics.PlainRatio(reduction=reduction)
    gear = sw.Gear(kinematics=kinematics, stiffness=sw.stiffness.Linear(k=k), input_inertia=wave_generator)
    drive = sw.Drive(gear=gear, motor=motor(inertia=rotor), load=sw.loads.Inertia(inertia=j_out))
    j_in, ratio = wave_generator + rotor, kinematics.ratio
    found = sw.analysis.modes(drive)
    assert found["free"] == pytest.approx([sqrt(k * (1.0 / j_out + 1.0 / (ratio**2 * j_in)))], rel=1e-9)
    assert found["input held"] == pytest.approx([sqrt(k / j_out)], rel=1e-9)


@given(stiffnesses, st.floats(1.0, 400.0), inertias, st.floats(0.01, 10.0), st.floats(0.1, 1e4))
def test_modes_with_a_spring_at_the_load(k: float, reduction: float, j_in: float, j_out: float, at_load: float) -> None:
    """A torsion spring, a table of its slope, and gravity at the lowest point are one and the same at rest."""
    gear = sw.Gear(
        kinematics=sw.kinematics.PlainRatio(reduction=reduction), stiffness=sw.stiffness.Linear(k=k), input_inertia=j_in
    )
    free, held = in_closed_form(k, reduction, j_in, j_out, at_load)
    for load in (
        sw.loads.TorsionSpring(inertia=j_out, stiffness=at_load),
        sw.loads.Pendulum(inertia=j_out, gravity_torque=at_load),
        sw.loads.TorqueTable(inertia=j_out, angle=[-1.0, 1.0], held_torque=[-at_load, at_load]),
    ):
        found = sw.analysis.modes(sw.Drive(gear=gear, motor=sw.motor.TorqueSource(inertia=0.0), load=load))
        assert found["free"] == pytest.approx(free, rel=1e-6)
        assert found["input held"] == pytest.approx(held, rel=1e-9)


@pytest.mark.parametrize(
    ("stiffness", "k"),
    [
        (sw.stiffness.Cubic(a1=8000.0, a3=4e7), 8000.0),
        (sw.stiffness.Piecewise(k1=900.0, k2=400.0, knee=1e-3), 900.0),
        (sw.stiffness.ThreeSegment(k1=67e3, k2=110e3, k3=120e3, t1=29.0, t2=108.0), 67e3),
        (
            sw.stiffness.MultiCompliance(
                flexspline_stiffness=8000.0,
                flexspline_hardening=0.02,
                wave_generator_stiffness=2.0,
                wave_generator_hardening=1.5,
                reduction=100.0,
            ),
            5714.285714285714,  # 1 / (1 / 8000 + 1 / (100^2 2))
        ),
    ],
)
def test_modes_of_a_spring_that_bends_are_those_of_its_tangent_at_rest(stiffness: object, k: float) -> None:
    memory = sw.hysteresis.MaxwellSlip(stiffness=[1000.0, 600.0], breakaway=[0.5, 0.9])
    for hysteresis, added in ((sw.Gear().hysteresis, 0.0), (memory, 1600.0)):
        gear = sw.Gear(stiffness=stiffness, hysteresis=hysteresis, input_inertia=2e-5)
        drive = sw.Drive(gear=gear, motor=sw.motor.BrushlessDC(inertia=1e-4), load=sw.loads.Inertia(inertia=0.5))
        free, held = in_closed_form(k + added, 100.0, 1.2e-4, 0.5)
        assert sw.analysis.modes(drive)["free"] == pytest.approx(free, rel=1e-9)
        assert sw.analysis.modes(drive)["input held"] == pytest.approx(held, rel=1e-9)


def test_modes_are_those_of_the_shafts_whatever_damps_drives_or_disturbs_them() -> None:
    plain = sw.Drive(
        gear=sw.Gear(stiffness=sw.stiffness.Linear(k=1.2e4), input_inertia=2e-5),
        motor=sw.motor.PMSM(inertia=1e-4, cogging_torque=0.05),
        load=sw.loads.Inertia(inertia=0.5),
    )
    busy = plain.replace(
        gear=plain.gear.replace(
            damping=30.0,
            kinematic_error=sw.kinematic_error.Fourier(order=[2.0], amplitude=[1e-3], phase=[0.0]),
            kinematic_noise=sw.kinematic_error.Stochastic(amplitude=1e-5),
            friction_input=made(sw.friction.LuGre, viscous=5e-5),
            friction_mesh=made(sw.friction.LoadDependent),
            friction_output=sw.friction.Coulomb(coulomb=1.0),
        ),
        control=sw.control.Sampled(law=sw.control.Cascade(), period=1e-3),
        sensors=sw.Sensors(current=sw.sensor.Noisy(law=sw.sensor.Ideal(), amplitude=0.1, bandwidth=100.0)),
        thermal=made(sw.thermal.Heating),
        meter=sw.meter.EnergyMeter(),
    )
    free, held = in_closed_form(1.2e4, 100.0, 1.2e-4, 0.5)
    for drive in (plain, busy):
        assert sw.analysis.modes(drive)["free"] == pytest.approx(free, rel=1e-9)
        assert sw.analysis.modes(drive)["input held"] == pytest.approx(held, rel=1e-9)


@pytest.mark.parametrize(
    ("name", "free", "held"),
    [
        ("position-drive", 173.2411613907041, sqrt(150.0 / 0.005)),
        ("position-drive-full-friction", 173.2411613907041, sqrt(150.0 / 0.005)),
        ("position-drive-printed", sqrt(150.0 * (100.0**2 / 0.0012 + 1.0 / 0.005)), sqrt(150.0 / 0.005)),
        ("two-inertia-gear", 406.61201818605, 400.0),
        # 13/6 k1, spring and hysteresis; rotor and wave generator
        ("space-pointing-joint", sqrt(8697.01 * (1.0 / 5.0 + 1.0 / (1e4 * 4.33e-5))), sqrt(8697.01 / 5.0)),
    ],
)
def test_modes_of_the_drives_that_come_with_the_package(name: str, free: float, held: float) -> None:
    found = sw.analysis.modes(sw.load(name))
    assert found["free"] == pytest.approx([free], rel=1e-9)
    assert found["input held"] == pytest.approx([held], rel=1e-9)


def test_modes_of_the_robot_joint_whose_arm_swings() -> None:
    k = 26700.5 + 17.8e3 + 8.9e3 + 4.45e3
    free, held = in_closed_form(k, 100.0, 5.48e-5 + 0.413e-4, 4.0, 59.0)
    found = sw.analysis.modes(sw.load("robot-joint"))
    assert found["free"] == pytest.approx(free, rel=1e-9)
    assert found["input held"] == pytest.approx(held, rel=1e-9)


@pytest.mark.parametrize("load", [sw.loads.Prescribed(), sw.loads.Brake(inertia=0.1)])
def test_modes_need_an_output_shaft_that_is_free(load: object) -> None:
    with pytest.raises(ValueError, match=r"needs an output shaft that torques move|needs a load that does not brake"):
        sw.analysis.modes(sw.Drive(load=load))
    with pytest.raises(TypeError, match="drive"):
        sw.analysis.modes(sw.Gear())


@pytest.mark.parametrize("name", sw.catalogue("drives"))
def test_every_drive_of_the_catalogue_is_linearised_with_notes_on_what_is_left_out(name: str) -> None:
    drive = sw.load(name)
    assert isinstance(drive, sw.Drive)
    linear = sw.linearise(drive)
    assert np.isfinite(linear.poles).all()
    assert bool(linear.notes) == (
        isinstance(drive.control, sw.control.Sampled)
        or any(clock.endswith(".clock") for clock in drive.rest())
        or not isinstance(drive.meter, sw.meter.NoMeter)
    )


def test_a_state_of_the_whole_drive_is_taken_over() -> None:
    law = sw.control.PID(proportional=2.0, derivative=0.05)
    plain = sw.Drive(control=law, load=sw.loads.Pendulum(inertia=0.1, gravity_torque=5.0))
    whole = plain.replace(control=sw.control.Sampled(law=law, period=1e-3), meter=sw.meter.EnergyMeter())
    held = sw.analysis.equilibrium(plain, command=0.5)
    state = whole.rest().replace({name: value for name, value in held.items() if name in whole.rest()})
    expected, found = sw.linearise(plain, held, command=0.5), sw.linearise(whole, state, command=0.5)
    assert np.array_equal(found.A, expected.A)
    assert [note.partition(":")[0] for note in found.notes] == ["control", "meter"]


@pytest.mark.parametrize("amplitude", [0.0, 6e-5])
def test_a_load_that_swings_back_comes_to_rest(amplitude: float) -> None:
    """Its weight overcomes friction at the beginning, and the way to its rest goes over angles where friction differs."""
    coulomb = sw.friction.Coulomb(coulomb=0.05, breakaway=0.05, viscous=3e-4)
    drive = sw.Drive(
        gear=sw.load("hfuc-20-80").replace(
            friction_input=sw.friction.Cyclic(law=coulomb, order=[2.0], amplitude=[0.3], phase=[0.5]),
            kinematic_error=sw.kinematic_error.Fourier(order=[2.0], amplitude=[amplitude], phase=[0.3]),
        ),
        motor=sw.motor.CurrentSource(torque_constant=0.0755, inertia=1e-4),
        load=sw.loads.Pendulum(inertia=0.8, gravity_torque=11.0, gravity_phase=0.6),
    )
    state = sw.analysis.equilibrium(drive)
    run = sw.simulate(drive, sw.scenario.constant(0.0, 0.5), initial=state, sample=0.1)
    assert np.ptp(run["output_angle"]) < 1e-9
    assert np.isfinite(sw.linearise(drive).poles).all()
