"""Progress of long calls: one argument, a bar after a second on a terminal, and nothing where nobody watches."""

from __future__ import annotations

import os
import pty
import subprocess
import sys
from math import isnan
from threading import Thread
from typing import Any

import pytest
import strainwave as sw
from strainwave.progress import by_count, in_turn, watched_by

LOOP = """
import time
from strainwave.progress import by_count
with by_count({}, "turning the [red]gear[/]", 30) as done:
    for step in range(30):
        if done is not None:
            done(step)
        time.sleep(0.08)
"""


def on_terminal(code: str) -> str:
    """What a program writes to standard error if that is a terminal."""
    reading, writing = pty.openpty()
    with subprocess.Popen([sys.executable, "-c", code], stderr=writing, env={**os.environ, "TERM": "xterm", "COLUMNS": "80"}):
        os.close(writing)
        written = b""
        while part := _read(reading):
            written += part
    os.close(reading)
    return written.decode()


def _read(terminal: int) -> bytes:
    try:
        return os.read(terminal, 4096)
    except OSError:  # the other end was closed
        return b""


@pytest.mark.slow("simulation")
def test_a_bar_appears_on_a_terminal_after_a_second_by_default() -> None:
    assert "turning the [red]gear[/]" in on_terminal(LOOP.format(None))  # a name from a file, as it is
    assert "turning the [red]gear[/]" in on_terminal(LOOP.format(True).replace("0.08", "0.01"))
    assert on_terminal(LOOP.format(None).replace("0.08", "0.001")) == ""
    assert on_terminal(LOOP.format(False)) == ""


def test_nothing_is_shown_where_nobody_watches(capfd: pytest.CaptureFixture[str]) -> None:
    with by_count(None, "simulating", 2) as done, in_turn(None) as turn:
        assert done is None
        turn("one.csv")
    assert capfd.readouterr() == ("", "")


def test_a_call_within_a_call_has_no_bar_of_its_own(capfd: pytest.CaptureFixture[str]) -> None:
    with in_turn(True) as turn:
        turn("outer")
        with by_count(True, "inner", 2) as done:
            assert done is None
    other = Thread(target=lambda: seen.append(_is_shown()))
    seen: list[bool] = []
    other.start()
    other.join()
    assert seen == [False]
    assert "inner" not in capfd.readouterr().err


def test_a_call_that_shows_nothing_silences_the_calls_within() -> None:
    with in_turn(False):
        assert not _is_shown()
    with in_turn(lambda stage, share: None):
        assert not _is_shown()


def test_a_watcher_hears_of_the_outermost_call_alone() -> None:
    stages: list[str] = []
    with watched_by(lambda stage, share: stages.append(stage)), in_turn(None) as outer:
        outer("a file")
        with in_turn(None) as inner:
            inner("a fit of it")
    assert stages == ["a file"]


def test_a_fit_tells_how_often_it_evaluated_the_model() -> None:
    gear, speed = sw.load("hfuc-25-100"), [1.0, 5.0, 20.0, 50.0]
    table = sw.Recording({"speed": speed, "torque": gear.friction_input.steady(speed)}, {"speed": "rad/s", "torque": "N.m"})
    stages: list[str] = []
    found = sw.fit(gear, table, ["friction_input.viscous"], progress=lambda stage, share: stages.append(stage))
    assert stages == [f"fitting, evaluation {number + 1}" for number in range(len(stages))]
    assert sw.fit(gear, table, ["friction_input.viscous"], progress=False) == found


def _is_shown() -> bool:
    with by_count(True, "simulating", 2) as done:
        return done is not None


def test_a_function_is_told_stages_and_shares() -> None:
    told: list[tuple[str, float]] = []
    with in_turn(lambda stage, share: told.append((stage, share)), 2) as turn:
        for name in ("one.csv", "two.csv", "report"):
            turn(name)
    assert told == [("one.csv", 0.0), ("two.csv", 0.5), ("report", 1.0)]
    with in_turn(lambda stage, share: told.append((stage, share))) as turn:
        turn("a count nobody knows")
    assert isnan(told[-1][1])


@pytest.mark.parametrize("progress", [1, "yes", [print]])
def test_what_is_no_progress_is_refused(progress: Any) -> None:
    with pytest.raises(TypeError, match=r"progress = .* must be True, False, None, or a function of a stage and a share"):
        sw.simulate(sw.load("position-drive"), sw.scenario.step(0.1, duration=0.01), progress=progress)
