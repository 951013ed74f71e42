"""Loops drawn with the letters of a terminal."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, strategies as st
from strainwave.report.terminal_plot import DOTS, loop_lines

LOOP = np.radians([0.0, -4.6, -58.9, -54.7, 0.0]), np.array([0.36, 0.0, -0.36, 0.0, 0.36])


@given(st.integers(36, 200), st.sampled_from(["utf-8", "ascii", "latin-1"]))
def test_no_line_is_wider_than_the_terminal_and_all_can_be_encoded(width: int, letters: str) -> None:
    lines = loop_lines(*LOOP, width, letters)
    assert lines
    assert max(map(len, lines)) <= width
    "\n".join(lines).encode(letters)


def test_a_narrow_terminal_gets_no_plot() -> None:
    assert loop_lines(*LOOP, 35) == []


def test_the_last_point_is_marked_where_it_lies() -> None:
    lines = loop_lines(np.radians([0.0, -60.0]), np.array([0.4, -0.4]), 50, rows=8)
    assert lines[1][-1] in map(chr, range(0x2801, 0x2900))
    assert len(lines[1]) == len(lines[-3])  # it reaches the end of the axis
    assert "●" in lines[8]
    assert lines[8].index("●") == lines[8].index("┤") + 1
    assert lines[-2].split() == ["−60", "0"]


@given(st.lists(st.tuples(st.floats(-1e6, 1e6), st.floats(-1e6, 1e6)), min_size=1, max_size=30))
def test_any_points_are_drawn(points: list[tuple[float, float]]) -> None:
    angle, torque = np.array(points).T
    lines = loop_lines(angle, torque, 60)
    assert sum(line.count("●") for line in lines) == 1


def test_the_dots_of_a_letter_are_eight_bits() -> None:
    assert sum(bit for column in DOTS for bit in column) == 0xFF


@pytest.mark.parametrize("angle", [0.0, 1.0])
def test_a_single_point_is_a_plot(angle: float) -> None:
    assert any("●" in line for line in loop_lines(np.array([angle]), np.array([0.36]), 60))
