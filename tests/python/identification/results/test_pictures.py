"""Figures of fits, files, identifications and predictions: the numbers of the results."""

from __future__ import annotations

import matplotlib.figure
import numpy as np
import pytest
import strainwave as sw
from strainwave.identification.results.pictures import Picture, amplitude_spectra, draw_measured, table_points

GEAR = sw.load("hfuc-25-100")
SPEED = np.linspace(2.0, 200.0, 30)
NOISE = np.random.default_rng(1).normal(0.0, 1e-3, 30)
DRIVE = sw.Drive(
    gear=GEAR,
    motor=sw.motor.DC(resistance=0.5, torque_constant=0.1, back_emf=0.1, inertia=1e-4),
    control=sw.control.PID(proportional=2.0, derivative=0.05),
    load=sw.loads.Inertia(inertia=0.5),
)
COULOMB_GEAR = sw.load("hfuc-25-100").replace(friction_input=sw.friction.Coulomb(coulomb=0.05, breakaway=0.05, viscous=3e-4))
FREE = ["friction_input.coulomb", "friction_input.viscous"]
BOTH_WAYS = np.array([-200.0, -80.0, -20.0, -5.0, 4.0, 15.0, 60.0, 120.0, 190.0, 250.0])
TORQUE_NOISE = 1e-3


def table(scale: float = 1.0) -> sw.Recording:
    torque = scale * GEAR.friction_input.steady(SPEED) + NOISE
    return sw.Recording({"speed": SPEED, "torque": torque}, {"speed": "rad/s", "torque": "N.m"})


@pytest.fixture(scope="module")
def log_fit() -> sw.identification.Fit:
    run = sw.simulate(DRIVE, sw.scenario.sine(0.1, 1.0, 2.0), sample=2e-3)
    hum = 0.05 * np.sin(2.0 * np.pi * 50.0 * run.time)
    columns = {name: run[name] for name in ("time", "command", "output_angle")} | {"current": run["current"] + hum}
    log = sw.Recording(columns, {"time": "s", "command": "rad", "output_angle": "rad", "current": "A"})
    start = DRIVE.replace({"load.inertia": 0.4})
    return sw.fit(start, log, ["load.inertia"], training=log.time < 1.5)


@pytest.mark.slow("identification")
def test_a_fit_of_a_log_has_measured_predicted_and_residual_of_each_channel(log_fit: sw.identification.Fit) -> None:
    figure = log_fit.plot()
    assert figure.get_suptitle() == "Measured and predicted output angle and current"
    angle, angle_left, current, current_left = figure.axes
    titles = [axes.get_title(loc="left") for axes in figure.axes]
    assert titles[0] == "output angle [mrad]"
    assert titles[2:] == ["current [A]", "measured − modelled [mA]"]
    measured, predicted = current.lines[:2]
    assert np.asarray(measured.get_ydata()) == pytest.approx(log_fit.experiment.measured[1])
    assert np.asarray(predicted.get_ydata()) == pytest.approx(log_fit.predicted[1])
    left = max(current_left.lines, key=lambda line: len(np.asarray(line.get_xdata())))
    assert np.asarray(left.get_ydata()) == pytest.approx(log_fit.residuals[1])
    for axes in (angle, angle_left, current, current_left):
        (held_out,) = [patch.get_extents() for patch in axes.patches]
        ends = axes.transData.inverted().transform(held_out.get_points())[:, 0]
        assert ends == pytest.approx([1.5, 2.0], abs=2e-3)


@pytest.mark.slow("identification")
def test_the_spectrum_of_a_residual_shows_what_the_model_lacks(log_fit: sw.identification.Fit) -> None:
    _, current = log_fit.plot_residual_spectrum().axes
    assert (current.get_title(loc="left"), current.get_xlabel()) == ("amplitude of current [A]", "frequency [Hz]")
    frequency, amplitude = (np.asarray(values) for values in current.lines[1].get_data())
    high = frequency > 20.0
    assert frequency[high][amplitude[high].argmax()] == pytest.approx(50.0, abs=0.5)
    assert amplitude[high].max() == pytest.approx(0.05, rel=0.1)


def test_uneven_time_is_put_on_an_even_clock() -> None:
    time = np.arange(0.0, 10.0, 0.01) + 1e-3 * np.sin(np.arange(1000))
    frequency, amplitude = amplitude_spectra(time, np.sin(2.0 * np.pi * 2.0 * time))
    assert frequency[amplitude.argmax()] == pytest.approx(2.0, abs=0.1)
    assert amplitude.max() == pytest.approx(1.0, rel=0.05)


def test_a_table_and_one_of_several_records_are_drawn_by_name() -> None:
    start = GEAR.replace(friction_input=GEAR.friction_input.replace(coulomb=0.05, breakaway=0.05))
    found = sw.fit(
        start, {"cold": table(1.2), "warm": table()}, ["friction_input.coulomb"], per_record=["friction_input.coulomb"]
    )
    figure = found.plot("warm")
    assert figure.get_suptitle() == "Measured and predicted torque, warm"
    points = figure.axes[0].lines[0]
    assert np.asarray(points.get_ydata()) == pytest.approx(table()["torque"])
    with pytest.raises(ValueError, match='no record "hot"; there are cold, warm'):
        found.plot("hot")
    with pytest.raises(ValueError, match="the record has no time: only a log has a spectrum"):
        found.plot_residual_spectrum()


@pytest.mark.slow("identification")
def test_an_identification_is_drawn_over_its_start_set() -> None:
    found = sw.identify("hfuc-25-100", {"friction": table(1.5)})
    figure = found.plot()
    (axes,) = figure.axes
    names = [label.get_text() for label in axes.get_yticklabels()]
    states = {each.path.removeprefix("gear."): each for each in found.states if each.state == "identified"}
    assert set(names) <= set(states)
    assert "friction_input.coulomb" in names
    (container,) = axes.containers
    ratios = np.asarray(container[0].get_xdata())
    assert ratios == pytest.approx([states[name].value / states[name].start for name in names])
    half = [1.96 * states[name].sigma / states[name].start for name in names]
    segments = np.array(container[2][0].get_segments())
    assert 0.5 * (segments[:, 1, 0] - segments[:, 0, 0]) == pytest.approx(half, rel=1e-3)
    assert axes.get_xlabel() == "value over that of HFUC-25-100"
    (file,) = found.files
    assert file.plot().get_suptitle() == f"Measured and modelled: {file.name}"
    stiff = sw.identify("hfuc-25-100", {"friction": table()})
    assert np.asarray(stiff.plot().axes[0].containers[0][0].get_xdata()) == pytest.approx(1.0, rel=0.05)


def test_a_prediction_is_drawn_with_its_error() -> None:
    saved = sw.identify("hfuc-25-100", {"friction": table()}).gear_set
    (found,) = sw.predict(saved, {"friction": table(1.3)})
    figure = found.plot()
    assert figure.get_suptitle().split(", ")[1].replace("\n", " ").startswith(f"predicted by {saved.name}"[:20])
    whole, left = figure.axes
    assert found.curves is not None
    assert np.sort(np.asarray(whole.lines[0].get_ydata())) == pytest.approx(np.sort(found.curves["torque"]))
    assert whole.get_title(loc="left") == "torque [N·m]"
    assert left.get_xlabel() == "input speed [rad/s]"


def test_a_table_under_several_loads_has_a_mark_for_each_and_one_over_the_speed_a_line() -> None:
    """A line through several torques at one speed would jump between them."""
    speed = np.array([10.0, 10.0, 20.0, 20.0])
    loaded, unloaded = np.array([0.1, 0.2, 0.11, 0.21]), np.array([0.1, 0.1, 0.11, 0.11])
    for modelled, style in ((loaded, "None"), (unloaded, "-")):
        curves = {"speed": speed, "torque": modelled, "modelled": modelled}
        axes = matplotlib.figure.Figure().subplots()
        table_points(axes, sw.Recording(curves, {"speed": "rad/s", "torque": "N.m", "modelled": "N.m"}))
        (model,) = [line for line in axes.lines if line.get_label() == "model"]
        assert model.get_linestyle() == style


def test_a_twist_is_drawn_over_the_unit_that_its_torque_has() -> None:
    twist = np.linspace(-1e-3, 1e-3, 50)
    columns = {"torque": 50.0 * twist / 1e-3, "twist": twist, "modelled": twist}
    units = {"torque": "A", "twist": "rad", "modelled": "rad"}
    axes = draw_measured(matplotlib.figure.Figure(), Picture(sw.Recording(columns, units), "loop", "twist, at the output"))
    assert (axes.get_xlabel(), axes.get_title()) == ("torque [A]", "twist, at the output [mrad]")


def noisy_table(seed: int) -> sw.Recording:
    torque = (
        0.05 * np.sign(BOTH_WAYS) + 3e-4 * BOTH_WAYS + TORQUE_NOISE * np.random.default_rng(seed).normal(size=len(BOTH_WAYS))
    )
    return sw.Recording({"speed": BOTH_WAYS, "torque": torque}, {"speed": "rad/s", "torque": "N.m"})


def test_a_line_is_as_uncertain_as_its_numbers_and_their_covariance_make_it() -> None:
    fit = sw.fit(COULOMB_GEAR, noisy_table(1), FREE)
    curves = fit.curves()[0]
    by_hand = np.stack([np.sign(BOTH_WAYS), BOTH_WAYS], axis=1)
    variance = np.array([row @ fit.covariance @ row for row in by_hand])
    np.testing.assert_allclose(curves["sigma"], np.sqrt(variance), rtol=1e-9)
    np.testing.assert_allclose(curves["modelled"], by_hand @ [each.value for each in fit.estimates], rtol=1e-9)
    np.testing.assert_array_equal(curves["torque"], noisy_table(1)["torque"])
    assert curves.names[:2] == ("speed", "torque")
    assert curves.unit("sigma") == "N.m"


def test_what_is_modelled_scatters_as_much_as_it_says_when_the_table_is_measured_again() -> None:
    every = [sw.fit(COULOMB_GEAR, noisy_table(seed), FREE).curves()[0] for seed in range(60)]
    scatter = np.std([each["modelled"] for each in every], axis=0)
    told = np.sqrt(np.mean([each["sigma"] ** 2 for each in every], axis=0))
    assert np.all(scatter < 1.5 * told)
    assert np.all(scatter > 0.6 * told)


def test_a_number_that_follows_another_moves_what_is_predicted_with_it() -> None:
    ties = {"friction_input.viscous": ("friction_input.coulomb", 6e-3)}
    fit = sw.fit(COULOMB_GEAR, noisy_table(2), FREE[:1], ties=ties)
    sigma = fit.estimates[0].sigma * np.abs(np.sign(BOTH_WAYS) + 6e-3 * BOTH_WAYS)
    np.testing.assert_allclose(fit.curves()[0]["sigma"], sigma, rtol=1e-9)


def test_what_the_data_do_not_tell_leaves_no_band() -> None:
    still = COULOMB_GEAR.replace(friction_output=sw.friction.Coulomb(coulomb=1.0, breakaway=1.0, viscous=0.0))
    fit = sw.fit(still, noisy_table(3), [*FREE, "friction_output.viscous"])
    assert "sigma" not in fit.curves()[0].names


def test_what_took_no_part_is_marked() -> None:
    training = BOTH_WAYS > 0.0
    marked = sw.fit(COULOMB_GEAR, noisy_table(4), FREE, training=training).curves()[0]["held_out"]
    np.testing.assert_array_equal(marked == 0.0, training)
