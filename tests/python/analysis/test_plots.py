"""Bode diagrams and sensitivities: the numbers of the result, with their units."""

from __future__ import annotations

import numpy as np
import pytest
import strainwave as sw
from strainwave.analysis.plots import MAX_BARS, phase_in_degrees
from strainwave.parameters import every

DRIVE = sw.Drive(
    load=sw.loads.Pendulum(inertia=0.1, gravity_torque=5.0), control=sw.control.PID(proportional=2.0, derivative=0.05)
)


def test_a_bode_diagram_has_magnitude_with_its_unit_and_phase() -> None:
    linear, frequency = sw.linearise(DRIVE), np.geomspace(0.1, 10.0, 30)
    figure = linear.plot(frequency, "output_angle", "load_torque")
    magnitude, phase = figure.axes
    assert magnitude.get_title(loc="left").endswith("rad/(N·m)]")
    assert (phase.get_title(loc="left"), phase.get_xlabel()) == ("phase [°]", "frequency [Hz]")
    assert figure.get_suptitle() == "Linear response of output angle to load torque"
    assert (magnitude.get_xscale(), magnitude.get_yscale()) == ("log", "log")
    response = linear.response(frequency, "output_angle", "load_torque")
    assert np.asarray(magnitude.lines[0].get_ydata()) == pytest.approx(np.abs(response))
    shown = np.asarray(phase.lines[0].get_ydata())
    assert np.exp(1j * np.radians(shown)) == pytest.approx(response / np.abs(response))


def test_frequencies_that_are_not_given_contain_all_poles() -> None:
    linear = sw.linearise(DRIVE)
    x = np.asarray(linear.plot().axes[0].lines[0].get_xdata())
    sizes = linear.eigenfrequencies[linear.eigenfrequencies > 1e-3] / (2.0 * np.pi)
    assert x[0] <= sizes.min()
    assert x[-1] >= sizes.max()
    with pytest.raises(ValueError, match="frequency must have one positive number"):
        linear.plot([0.0, 1.0])


def test_a_response_to_sines_states_their_amplitude() -> None:
    answer = sw.analysis.frequency_response(DRIVE, [1.0, 2.0, 4.0], amplitude=0.01)
    figure = answer.plot()
    assert figure.get_suptitle().replace("\N{NO-BREAK SPACE}", " ") == "Response of output angle to a command of 10 mrad"
    assert figure.axes[0].get_title(loc="left") == "magnitude"  # rad / rad
    assert np.asarray(figure.axes[0].lines[0].get_ydata()) == pytest.approx(np.abs(answer["output_angle"]))
    assert answer.plot("torque").axes[0].get_title(loc="left") == "magnitude [N·m/rad]"
    with pytest.raises(ValueError, match='no output "speed"; there are'):
        answer.plot("speed")


def test_the_phase_has_no_jump_and_begins_in_the_first_turn_backward() -> None:
    angles = np.linspace(0.5, -20.0, 200)
    shown = phase_in_degrees(np.exp(1j * angles))
    assert np.abs(np.diff(shown)).max() < 10.0
    assert -360.0 < shown[0] <= 1.0
    assert phase_in_degrees(np.array([1.0 + 1e-12j]))[0] == pytest.approx(0.0, abs=1e-6)


def test_bars_are_the_changes_by_one_percent_the_largest_first() -> None:
    paths = ["load.inertia", "load.gravity_torque", "motor.torque_constant", "gear.friction_input.viscous"]
    found = sw.analysis.derivatives(DRIVE, sw.scenario.sine(0.1, 1.0, 1.0), paths, sample=1e-3)
    (axes,) = found.plot("output_angle").axes
    effects = found.effects("output_angle")
    names = [label.get_text() for label in axes.get_yticklabels()]
    widths = [bar.get_width() for bar in axes.patches]  # type: ignore[attr-defined]
    assert widths == sorted(effects.values(), reverse=True)
    assert [effects[name] for name in names] == widths
    assert axes.get_xlabel() == "rms change by + 1 % [µrad]"
    inertia = found["output_angle", "load.inertia"] * 0.1 * 0.01
    assert effects["load.inertia"] == pytest.approx(np.sqrt(np.mean(inertia**2)))


def test_of_many_parameters_the_strongest_are_drawn() -> None:
    drive = DRIVE.replace(gear=sw.load("hfuc-25-100"))
    paths = [path for path in every(drive) if path.startswith(("gear.stiffness", "gear.hysteresis", "load."))]
    found = sw.analysis.derivatives(
        drive, sw.scenario.sine(0.1, 1.0, 0.1), [*paths, "gear.damping", "gear.input_inertia"], sample=1e-2
    )
    figure = found.plot()
    assert len(figure.axes[0].patches) == MAX_BARS < len(found.parameters)
    assert f"the {MAX_BARS} strongest of {len(found.parameters)} parameters" in " ".join(figure.get_suptitle().split())
