"""Order tracks: amplitudes of known orders over the speed, and what cannot be followed."""

from __future__ import annotations

import numpy as np
import pytest
import strainwave as sw
from matplotlib.figure import Figure

UNITS = {"time": "s", "input_angle": "rad", "torque": "N.m"}


def run_up(step: float = 1e-3) -> sw.Recording:
    """A torque of orders 2 and 4, the first of which grows with the square of the speed."""
    time = np.arange(0.0, 20.0, step)
    angle, speed = 20.0 * time + 5.0 * time**2, 20.0 + 10.0 * time
    torque = 1e-4 * speed**2 * np.sin(2.0 * angle) + 0.5 * np.cos(4.0 * angle) + 0.01 * angle
    return sw.Recording({"time": time, "input_angle": angle, "torque": torque}, UNITS)


def test_amplitudes_over_the_speed_are_those_of_a_closed_form() -> None:
    tracks = sw.orders.order_tracks(run_up(), "torque", [2.0, 4.0])
    assert (np.diff(tracks.speed) >= 0.0).all()
    inside = tracks.speed > 40.0  # a stretch of two turns spans a wide share of the lowest speeds
    np.testing.assert_allclose(tracks.amplitude[0, inside], 1e-4 * tracks.speed[inside] ** 2, rtol=0.02)
    np.testing.assert_allclose(tracks.amplitude[1, inside], 0.5, rtol=0.02)
    assert tracks.unit == "N.m"


def test_several_recordings_are_one_track() -> None:
    whole = run_up()
    parts = [whole.between(0.0, 9.0), whole.between(9.0, 20.0)]
    tracks = sw.orders.order_tracks(parts[::-1], "torque", [2.0])
    assert tracks.speed[0] < 50.0 < 150.0 < tracks.speed[-1]


def test_an_order_between_samples_is_left_out_and_named() -> None:
    tracks = sw.orders.order_tracks(run_up(), "torque", [2.0, 500.0])
    assert tracks.order.tolist() == [2.0]
    assert any("500" in remark for remark in tracks.remarks)
    with pytest.raises(ValueError, match="no order can be followed"):
        sw.orders.order_tracks(run_up(), "torque", [500.0])


def test_critical_speeds_are_drawn() -> None:
    tracks = sw.orders.order_tracks(run_up(), "torque", [2.0, 4.0])
    figure = tracks.plot(eigenfrequencies=[200.0])
    assert isinstance(figure, Figure)
    dashed = [line.get_xdata() for axes in figure.axes for line in axes.lines if line.get_linestyle() == "--"]
    assert [float(x[0]) for x in dashed] == [100.0, 50.0]
    with pytest.raises(ValueError, match="eigenfrequencies = -1"):
        tracks.plot(eigenfrequencies=[-1.0])
