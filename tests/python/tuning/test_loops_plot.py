"""Margins in a Bode diagram: each mark lies where its margin is read."""

from __future__ import annotations

from math import tau

import numpy as np
import pytest
import strainwave as sw


def test_marks_lie_at_a_gain_of_one_and_at_minus_half_a_turn() -> None:
    law = sw.cascade("robot-joint", period=1e-3)
    margins = sw.tuning.loop_margins(sw.load("robot-joint").replace(control=sw.control.Sampled(law=law, period=1e-3)))
    figure = margins.plot()
    magnitude, phase = figure.axes
    marks = {
        axes: {
            line.get_marker(): (float(np.asarray(line.get_xdata())[0]), float(np.asarray(line.get_ydata())[0]))
            for line in axes.lines
            if line.get_marker() in ("o", "^") and line.get_color() == axes.lines[1].get_color()
        }
        for axes in (magnitude, phase)
    }  # of the position loop
    position = margins.position
    assert marks[magnitude]["o"] == pytest.approx((position.phase_at / tau, 1.0), rel=1e-3)
    assert phase_of(marks[phase]["o"][1]) == pytest.approx(position.phase, rel=1e-3)
    assert marks[magnitude]["^"] == pytest.approx((position.gain_at / tau, 1.0 / position.gain), rel=1e-2)
    assert phase_of(marks[phase]["^"][1]) == pytest.approx(0.0, abs=0.02)
    assert [text.get_text() for text in figure.legends[0].get_texts()] == [
        f"speed loop: gain margin ∞, phase margin {np.degrees(margins.speed.phase):.0f}°",
        f"position loop: gain margin {position.gain:.1f}, phase margin {np.degrees(position.phase):.0f}°",
    ]


def phase_of(degrees: float) -> float:
    """Return the distance of an angle from half a turn [rad]."""
    return float(abs(np.angle(-np.exp(1j * np.radians(degrees)))))
