"""The response at amplitude: the linear one where it is small, closed forms where it is not."""

from __future__ import annotations

import re
import warnings
from math import pi, sqrt

import numpy as np
import pytest
import strainwave as sw
from strainwave.analysis.response import _change

from tests.support.geared import RATIO, K, geared
from tests.support.reference_drive import DRIVE
from tests.support.strategies import made

STUCK = sw.friction.Coulomb(coulomb=500.0)
DISC = sw.loads.Inertia(inertia=0.5)
PD = sw.control.PID(proportional=2.0, derivative=0.05)


@pytest.mark.parametrize("signal", ["command", "load_torque"])
def test_a_vanishing_sine_is_answered_as_the_linear_view_says(signal: str) -> None:
    """The difference, friction that drags behind a vibration, falls with the amplitude."""
    frequency = [5.0, 20.0]
    linear = sw.linearise(DRIVE)
    off = []
    for amplitude in (1e-6, 1e-7) if signal == "command" else (1e-3, 1e-4):
        answer = sw.analysis.frequency_response(DRIVE, frequency, amplitude, input=signal)
        errors = [np.abs(answer[name] / linear.response(frequency, name, signal) - 1.0) for name in ("output_angle", "twist")]
        off.append(np.max(errors))
    assert off[0] < 0.03
    assert off[1] < 0.2 * off[0]


@pytest.mark.parametrize(
    ("law", "loads", "amplitude", "tolerance"),
    [
        (sw.hysteresis.MaxwellSlip(stiffness=[3e3, 2e3], breakaway=[0.5, 100.0]), (0.0, 8.0), 1e-5, 1e-6),
        pytest.param(
            sw.hysteresis.FadingMemory(stiffness=4e3, forgetting=1e3),
            (0.0, 8.0),
            0.03,
            2e-3,
            marks=pytest.mark.slow("analysis"),
        ),
        (made(sw.hysteresis.BoucWen), (0.0,), 1e-5, 1e-6),
        (sw.hysteresis.Preisach(density=made(sw.hysteresis.PowerDensity)), (0.0, 8.0), 1e-5, 1e-3),
        (made(sw.hysteresis.Regimes), (8.0,), 1e-5, 1e-6),
    ],
    ids=["maxwell_slip", "fading_memory", "bouc_wen", "preisach", "regimes"],
)
def test_small_loops_of_every_hysteresis_are_those_of_the_linear_view(
    law: object, loads: tuple[float, ...], amplitude: float, tolerance: float
) -> None:
    """Also under a load that has wound it up, where it stays so: the fading memory forgets that load within some
    1 / forgetting, Bouc-Wen's creeps for thousands of periods; Regimes has a kink at rest, which shifts the mean."""
    drive = geared(DISC, friction_input=STUCK, damping=50.0, hysteresis=law)
    for load_torque in loads:
        answer = sw.analysis.frequency_response(
            drive, 5.0, amplitude, input="load_torque", load_torque=load_torque, max_periods=5000
        )
        linear = sw.linearise(drive, load_torque=load_torque).response(5.0, "twist", "load_torque")
        assert abs(answer["twist"][0] / linear - 1.0) < tolerance


def test_a_drive_that_runs_answers_around_its_speed() -> None:
    drive = geared(DISC, friction_input=sw.friction.Viscous(viscous=2e-3))
    answer = sw.analysis.frequency_response(drive, [1.0, 10.0], 1e-3, command=12.0)
    linear = sw.linearise(drive, command=12.0)
    for name in ("input_speed", "output_angle", "current"):
        assert answer[name] == pytest.approx(linear.response([1.0, 10.0], name), rel=1e-4), name
    speed = sw.analysis.equilibrium(drive, command=12.0).output_speed
    assert answer.drifts["output_angle"] == pytest.approx([speed, 0.1 * speed], rel=1e-6)


def test_a_saturated_voltage_is_a_square_wave() -> None:
    """First harmonic 4 / pi of the limit, all others sqrt(pi^2 / 8 - 1) of it."""
    control = sw.control.PID(proportional=1e9, limit=12.0)
    answer = sw.analysis.frequency_response(geared(DISC, control, friction_input=STUCK), 1.0, 0.5, dt=2e-5)
    assert 0.5 * answer["voltage"][0] == pytest.approx(4.0 / pi * 12.0, rel=1e-5)
    assert answer.distortions["voltage"][0] == pytest.approx(sqrt(pi**2 / 8.0 - 1.0), rel=2e-4)
    assert answer.responses["command"][0] == pytest.approx(1.0, rel=1e-12)
    assert answer.distortions["command"][0] == pytest.approx(0.0, abs=1e-9)


def test_a_slow_load_goes_round_the_loop_of_the_gear() -> None:
    """The first harmonic is that of the twist along the path of torque, as the gear has it when asked slowly."""
    memory = sw.hysteresis.MaxwellSlip(stiffness=[3e3, 2e3], breakaway=[0.5, 1.0])
    drive = geared(sw.loads.Inertia(inertia=1e-4), friction_input=STUCK, hysteresis=memory, damping=1.0)
    answer = sw.analysis.frequency_response(drive, 0.5, 8.0, input="load_torque", dt=5e-5)
    phase = np.linspace(0.0, 2.0 * pi, 20_001)
    twist = drive.gear.twist(8.0 * np.sin(np.append(phase, phase[1:])))[-20_000:]
    first = 2j * np.mean(twist * np.exp(-1j * phase[1:])) / 8.0
    assert answer["twist"][0] == pytest.approx(first, rel=1e-3)
    assert answer["twist"][0].imag == pytest.approx(first.imag, rel=1e-2)
    linear = sw.linearise(drive).response(0.5, "twist", "load_torque")
    assert abs(linear) == pytest.approx(1.0 / (K + 5e3), rel=1e-3)
    assert abs(first) > 1.1 * abs(linear)


def test_friction_holds_small_sines_and_lets_large_ones_pass() -> None:
    """Below breakaway nothing moves; far above, friction is a small matter."""
    dry = geared(DISC, PD, friction_input=sw.friction.Coulomb(coulomb=0.1, breakaway=0.12))
    smooth = geared(DISC, PD)
    breakaway = 0.12 / (2.0 * RATIO / 0.5 * 0.1)  # K_m k_p i r / R
    assert sw.analysis.frequency_response(dry, 0.1, 0.9 * breakaway)["input_angle"][0] == 0.0
    linear = sw.linearise(smooth).response(2.0)
    off = [
        abs(sw.analysis.frequency_response(dry, 2.0, amplitude)["output_angle"][0] / linear - 1.0) for amplitude in (0.05, 0.5)
    ]
    assert 0.01 < off[1] < 0.2 * off[0]


def test_each_frequency_has_its_answer_wherever_it_stands() -> None:
    both = sw.analysis.frequency_response(DRIVE, [3.0, 7.0], 1e-2)
    alone = sw.analysis.frequency_response(DRIVE, 7.0, 1e-2)
    assert both["torque"][1] == alone["torque"][0]
    assert both.periods[1] == alone.periods[0] > 1
    assert both.frequency.tolist() == [3.0, 7.0]


def test_what_does_not_become_periodic_says_so() -> None:
    """An undamped gear rings on and on, at a frequency of its own."""
    ringing = geared(
        DISC, motor=sw.motor.DC(torque_constant=0.0, back_emf=0.0, inertia=5e-4), damping=0.0, friction_input=STUCK
    )
    with pytest.raises(RuntimeError, match=r"at 3 Hz the motion is not periodic after 20 periods: .* tolerance = 1e-06"):
        sw.analysis.frequency_response(ringing, 3.0, 1.0, input="load_torque", max_periods=20)


def test_a_share_of_a_swing_of_nothing_is_infinite_in_silence() -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert _change(np.zeros(3), np.array([0.0, 10.0, 0.0])) == np.inf


def test_what_makes_no_sense_is_refused() -> None:
    with pytest.raises(ValueError, match=r"amplitude = 0.0 must lie in"):
        sw.analysis.frequency_response(DRIVE, 1.0, 0.0)
    with pytest.raises(ValueError, match="frequency must have one positive number"):
        sw.analysis.frequency_response(DRIVE, [], 0.1)
    for frequency in (-1.0, 0.0, 5e-324, float("nan"), 1e300):
        with pytest.raises(ValueError, match=rf"^frequency = {re.escape(str(frequency))} Hz must lie in \[1e-300, 1e\+30\]$"):
            sw.analysis.frequency_response(DRIVE, [1.0, frequency], 0.1)
    with pytest.raises(ValueError, match=r"^1e\+20 s are more than 1e\+08 steps of 0\.0002 s; take a higher frequency"):
        sw.analysis.frequency_response(DRIVE, 1e-20, 0.1)
    with pytest.raises(ValueError, match='input = "temperature" must be one of command, load_torque'):
        sw.analysis.frequency_response(DRIVE, 1.0, 0.1, input="temperature")
    with pytest.raises(ValueError, match=r"dt = 0.0 s must lie in"):
        sw.analysis.frequency_response(DRIVE, 1.0, 0.1, dt=0.0)
    with pytest.raises(ValueError, match=r"^no output \"speed\"; there are command, input_angle, "):
        sw.analysis.frequency_response(DRIVE, 5.0, 0.01)["speed"]
