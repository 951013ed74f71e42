"""Report of orders: recordings together come first, and the terminal has what all of them share."""

from __future__ import annotations

import numpy as np
from strainwave.files.recording import Recording
from strainwave.orders.measured import OrdersFound, orders_found
from strainwave.orders.ring_modes import RingModes
from strainwave.report.orders import map_figure, orders_report, orders_summary

NONE = np.zeros((0, 1), complex)
MODES = RingModes((), (), np.array([10.0]), NONE, NONE, "output_angle", "rad", None, ())
EACH = [OrdersFound(f"speed_{place}.csv", None, None, ("deg is assumed", f"at speed {place}")) for place in range(12)]
TOGETHER = OrdersFound("12 recordings together", None, None, modes=MODES)


def test_recordings_together_are_first_on_the_page_and_alone_on_the_terminal() -> None:
    page = orders_report(EACH, None, TOGETHER)
    assert (
        page.index("<h2>12 recordings together</h2>") < page.index("<h2>speed_0.csv</h2>") < page.index("<h2>speed_11.csv</h2>")
    )
    assert orders_summary(EACH, TOGETHER).splitlines() == [
        "12 recordings together",
        "  over the speed: no mode is determined",
        "  note: of each recording: deg is assumed",
        "  note: the results of each recording are in report.html, with its other notes",
    ]


def test_recordings_by_themselves_have_their_lines_each() -> None:
    assert orders_summary(EACH[:2]).splitlines()[:3] == ["speed_0.csv", "  note: deg is assumed", "  note: at speed 0"]


def test_a_short_record_whose_speed_varies_has_no_map_over_time() -> None:
    """250 samples: less than 8 in each of 40 blocks."""
    time = np.linspace(0.0, 10.0, 250)
    angle = 2.0 * time + 0.4 * time**2
    torque = 0.3 * np.sin(2.0 * angle) + np.random.default_rng(0).normal(0.0, 0.01, 250)
    units = {"time": "s", "input_angle": "rad", "torque": "N.m"}
    found = orders_found(Recording({"time": time, "input_angle": angle, "torque": torque}, units))
    assert found.ripple is not None
    assert found.ripple.lines
    assert map_figure(found.ripple, "map") == ""
    assert "<h2>recording</h2>" in orders_report([found])
