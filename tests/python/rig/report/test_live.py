"""The display during a test: its lines, and loops in the letters of a terminal."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from io import StringIO

import numpy as np
import pytest
from hypothesis import given, strategies as st
from rich.console import Console
from strainwave.rig.bench.steps import Step
from strainwave.rig.report.live import DOTS, Terminal, live, loop_lines, point_line
from strainwave.rig.running.guide import Look, Point

POINTS = [
    Point("0001.png", 0.36, Look(0.0, 2e-5)),
    Point("0002.png", 0.0, Look(-0.08, 2e-5), ("blurred",)),
    Point("0003.png", -0.36, Look(np.nan, np.nan, "one marker is missing")),
    Point("0004.png", None, Look(-1.0, 2e-5)),
]
LOOP = np.radians([0.0, -4.6, -58.9, -54.7, 0.0]), np.array([0.36, 0.0, -0.36, 0.0, 0.36])


class Clock:
    def __init__(self) -> None:
        self.time = 0.0

    def now(self) -> float:
        return self.time

    def pause(self, seconds: float) -> None:
        self.time += seconds


def watched(terminal: bool, width: int = 80) -> tuple[str, list[Point]]:
    """What is shown of points that come two at a time, and then none."""
    text, clock = StringIO(), Clock()
    come: Iterator[Sequence[Point]] = iter([POINTS[:2], [], POINTS[2:]])
    console = Console(file=text, force_terminal=terminal, width=width, color_system=None, legacy_windows=False)
    points = live(console, lambda: next(come, []), idle=5.0, interval=1.0, now=clock.now, pause=clock.pause)
    assert clock.time == 2.0 + 5.0
    return text.getvalue(), points


def test_a_pipe_gets_a_line_for_each_photograph() -> None:
    text, points = watched(terminal=False, width=40)
    assert points == POINTS
    assert text.splitlines() == [point_line(point) for point in POINTS]
    assert text.splitlines()[1] == "0002.png  +0.000 N·m  −4.5837° ± 4.1″  DOUBTFUL: blurred"
    assert text.splitlines()[2] == "0003.png  −0.360 N·m  NO ANGLE: one marker is missing"
    assert text.splitlines()[3].startswith("0004.png  torque not known  −57.2958°")


def test_a_terminal_gets_the_loop_and_the_last_photographs() -> None:
    text, _ = watched(terminal=True)
    assert "waiting for photographs" in text
    assert "torque [N·m]" in text
    assert "0004.png" in text
    assert "●" in text


def test_a_narrow_terminal_still_gets_the_photographs() -> None:
    text, _ = watched(terminal=True, width=30)
    assert "torque [N·m]" not in text
    assert "0004.png" in text


def test_the_guide_says_what_to_do_and_shows_what_came_of_it() -> None:
    text, answers = StringIO(), iter(["", "t 20", "", ""])
    console = Console(file=text, force_terminal=True, width=80, color_system=None, legacy_windows=False)
    terminal = Terminal(
        console, 3, {number: f"lay on {number}" for number in (1, 2, 3)}, lambda step: 0.1 * step.number, lambda: next(answers)
    )
    turned = Step(3, 0.1, image="3.png", position=np.pi / 3.0, unit="A")
    steps = [Step(1, 0.3, image="1.png"), Step(2, 0.2, image="2.png"), turned]
    assert terminal.ask(steps[0], None) == ""
    assert terminal.ask(steps[1], steps[0]) == "t 20"
    terminal.seen(Look(0.1, 1e-5))
    terminal.done(steps[:1], {1: Look(0.0, 1e-5)})
    terminal.done(steps[:2], {1: Look(0.0, 1e-5), 2: Look(0.5, 1e-5)})
    terminal.ask(turned, steps[1])
    terminal.done(steps, {1: Look(0.0, 1e-5), 2: Look(0.5, 1e-5), 3: Look(0.0, 1e-5)})
    assert terminal.hint("no marker") == ""
    shown = text.getvalue()
    assert "Flexspline at 0°" in shown
    assert "Unit A, flexspline at 60°" in shown
    assert "Step 2 of 3: lay on 2" in shown
    assert "2.png  +0.200 N·m  +28.6479° ± 2.1″" in shown
    assert shown.count("torque [N·m]") == 1  # two points of one position are the first that make a loop
    assert "no marker" in shown


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
