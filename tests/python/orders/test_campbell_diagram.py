"""Campbell diagrams: amplitudes of orders and vibrations at their frequencies, and lines where they belong."""

from __future__ import annotations

from math import tau

import numpy as np
import pytest
import strainwave as sw

TIME = np.arange(0.0, 40.0, 1e-3)
SPEED = 20.0 + 4.0 * TIME
ANGLE = 20.0 * TIME + 2.0 * TIME**2


def recording(speed: np.ndarray = SPEED, time: np.ndarray = TIME) -> sw.Recording:
    torque = 3.0 * np.sin(2.0 * ANGLE) + 0.5 * np.sin(tau * 80.0 * TIME)
    columns = {"time": time, "input_speed": speed, "torque": torque}
    return sw.Recording(columns, {"time": "s", "input_speed": "rad/s", "torque": "N.m"})


def test_an_order_follows_the_speed_and_a_vibration_does_not() -> None:
    found = sw.orders.campbell(recording(), "torque")
    assert found.amplitude.shape == (len(found.speed), len(found.frequency))
    for speed, spectrum in zip(found.speed[::20], found.amplitude[::20], strict=True):
        low = found.frequency < 70.0
        strongest = spectrum[low].argmax()
        assert found.frequency[strongest] == pytest.approx(2.0 * speed / tau, abs=2.0)  # a line is as wide as 2 / 0.5 s
        assert spectrum[strongest] == pytest.approx(3.0, rel=0.2)  # between two frequencies a Hann window loses 15 %
    at = np.abs(found.frequency - 80.0).argmin()
    assert found.amplitude[:, at] == pytest.approx(0.5, rel=0.05)


def test_a_run_down_has_the_diagram_of_the_run_up() -> None:
    up, down = sw.orders.campbell(recording(), "torque"), sw.orders.campbell(recording(SPEED[::-1].copy()), "torque")
    assert np.all(np.diff(down.speed) >= 0.0)
    assert down.speed == pytest.approx(up.speed, rel=0.01)
    assert down.amplitude.max() == up.amplitude.max()


def test_lines_of_orders_and_eigenfrequencies_stand_where_they_belong() -> None:
    figure = sw.orders.campbell(recording(), "torque").plot(orders=[1, 2.0], eigenfrequencies=[tau * 80.0])
    axes, bar = figure.axes
    level, first, second = axes.lines
    assert np.asarray(level.get_ydata()) == pytest.approx(80.0)
    for order, line in ((1.0, first), (2.0, second)):
        assert np.asarray(line.get_ydata()) == pytest.approx(order * np.asarray(line.get_xdata()) / tau)
    assert (axes.get_title(loc="left"), axes.get_xlabel()) == ("frequency [Hz]", "input speed [rad/s]")
    assert bar.get_xlabel() == "amplitude [N·m]"
    assert figure.get_suptitle() == "Campbell diagram of torque; dashed: eigenfrequency"
    assert [text.get_text().strip() for text in axes.texts] == ["80 Hz", "1", "2"]
    assert axes.get_ylim() == (0.0, 120.0)


def test_times_that_jitter_give_the_same_diagram() -> None:
    even, jittered = (
        sw.orders.campbell(recording(), "torque"),
        sw.orders.campbell(recording(time=TIME + 1e-4 * np.sin(TIME / 1e-3)), "torque"),
    )
    assert jittered.speed == pytest.approx(even.speed, rel=1e-3)
    assert jittered.amplitude.max() == pytest.approx(even.amplitude.max(), rel=0.02)


def test_what_makes_no_diagram_is_refused() -> None:
    run = recording()
    for make, message in (
        (
            lambda: sw.orders.campbell(run, "torque", stretch=0.01),
            "stretch = 0.01 s has 10 samples of 0.001 s; take 0.016 s or more",
        ),
        (
            lambda: sw.orders.campbell(run, "torque", stretch="10 ms"),  # type: ignore[arg-type]
            "stretch = 0.01 s has 10 samples of 0.001 s; take 0.016 s or more",
        ),
        (
            lambda: sw.orders.campbell(run, "torque", stretch=30.0),
            "has 2 stretches of 30 s, of 4 to 100000 allowed; take a shorter",
        ),
        (lambda: sw.orders.campbell(recording(np.full(len(TIME), 5.0)), "torque"), "input_speed does not change"),
        (lambda: sw.orders.campbell(run.with_column("torque", 0.0 * TIME, "N.m"), "torque"), "torque does not change"),
        (lambda: sw.orders.campbell(run, "current"), 'no column "current"'),
        (lambda: sw.orders.campbell(run, "torque").plot(orders=[0.0]), r"orders = 0.0 must lie in \(0, inf\)"),
    ):
        with pytest.raises(ValueError, match=message):
            make()
