"""Measured beside modelled, and how uncertain what is modelled is."""

from __future__ import annotations

import numpy as np
import strainwave as sw
from strainwave.identification.results.curves import curves_of, curves_of_orders
from strainwave.orders.two_encoders import transmission_error

GEAR = sw.load("hfuc-25-100").replace(friction_input=sw.friction.Coulomb(coulomb=0.05, breakaway=0.05, viscous=3e-4))
FREE = ["friction_input.coulomb", "friction_input.viscous"]
SPEED = np.array([-200.0, -80.0, -20.0, -5.0, 4.0, 15.0, 60.0, 120.0, 190.0, 250.0])
NOISE = 1e-3


def table(seed: int) -> sw.Recording:
    torque = 0.05 * np.sign(SPEED) + 3e-4 * SPEED + NOISE * np.random.default_rng(seed).normal(size=len(SPEED))
    return sw.Recording({"speed": SPEED, "torque": torque}, {"speed": "rad/s", "torque": "N.m"})


def test_a_line_is_as_uncertain_as_its_numbers_and_their_covariance_make_it() -> None:
    fit = sw.fit(GEAR, table(1), FREE)
    curves = curves_of(fit)
    by_hand = np.stack([np.sign(SPEED), SPEED], axis=1)
    variance = np.array([row @ fit.covariance @ row for row in by_hand])
    np.testing.assert_allclose(curves["sigma"], np.sqrt(variance), rtol=1e-9)
    np.testing.assert_allclose(curves["modelled"], by_hand @ [each.value for each in fit.estimates], rtol=1e-9)
    np.testing.assert_array_equal(curves["torque"], table(1)["torque"])
    assert curves.names[:2] == ("speed", "torque")
    assert curves.unit("sigma") == "N.m"


def test_what_is_modelled_scatters_as_much_as_it_says_when_the_table_is_measured_again() -> None:
    every = [curves_of(sw.fit(GEAR, table(seed), FREE)) for seed in range(60)]
    scatter = np.std([each["modelled"] for each in every], axis=0)
    told = np.sqrt(np.mean([each["sigma"] ** 2 for each in every], axis=0))
    assert np.all(scatter < 1.5 * told)
    assert np.all(scatter > 0.6 * told)


def test_a_number_that_follows_another_moves_what_is_predicted_with_it() -> None:
    ties = {"friction_input.viscous": ("friction_input.coulomb", 6e-3)}
    fit = sw.fit(GEAR, table(2), FREE[:1], ties=ties)
    sigma = fit.estimates[0].sigma * np.abs(np.sign(SPEED) + 6e-3 * SPEED)
    np.testing.assert_allclose(curves_of(fit)["sigma"], sigma, rtol=1e-9)


def test_what_the_data_do_not_tell_leaves_no_band() -> None:
    still = GEAR.replace(friction_output=sw.friction.Coulomb(coulomb=1.0, breakaway=1.0, viscous=0.0))
    fit = sw.fit(still, table(3), [*FREE, "friction_output.viscous"])
    assert "sigma" not in curves_of(fit).names


def test_what_took_no_part_is_marked() -> None:
    training = SPEED > 0.0
    marked = curves_of(sw.fit(GEAR, table(4), FREE, training=training))["held_out"]
    np.testing.assert_array_equal(marked == 0.0, training)


def test_orders_are_as_uncertain_as_amplitude_and_phase_make_them() -> None:
    time = np.arange(0.0, 6.0, 0.004)
    angle = 30.0 * np.sin(0.5 * time) + 5.0 * np.sin(1.3 * time)
    noise = np.random.default_rng(0).normal(0.0, 1e-5, len(time))
    output = -angle / 100 - 2e-4 * np.sin(2 * angle + 0.4) + noise
    columns, units = {"time": time, "input_angle": angle, "output_angle": output}, {"time": "s"}
    found = transmission_error(sw.Recording(columns, units | dict.fromkeys(list(columns)[1:], "rad")), ratio=-100)
    curves = curves_of_orders(found)
    off = curves["modelled"] - 2e-4 * np.sin(2.0 * found.curves["input_angle"] + 0.4)
    (second,) = [each for each in found.orders if each.significant]
    phase = 2.0 * found.curves["input_angle"] + second.phase
    slopes = np.stack([np.sin(phase), second.amplitude * np.cos(phase)], axis=1)
    sigma = np.linalg.norm(slopes * [second.amplitude_sigma, second.phase_sigma], axis=1)
    np.testing.assert_allclose(curves["sigma"], sigma, rtol=1e-9)
    assert np.sqrt(np.mean(off**2)) < 3.0 * np.sqrt(np.mean(sigma**2))
    np.testing.assert_array_equal(curves["residual"], found.curves["residual"])
