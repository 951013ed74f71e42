"""The numbers that the page on identification states are those of the code."""

from __future__ import annotations

from pathlib import Path

import pytest
from strainwave.identification import twin
from strainwave.identification.evidence import explain, influence, plausible, verdict

PAGE = " ".join(Path(__file__).parents[4].joinpath("docs", "identify.md").read_text(encoding="utf-8").split())
NUMBERS = ("no", "one", "two", "three", "four", "five")


def percent(share: float) -> str:
    return f"{100.0 * share:g} %"


@pytest.mark.parametrize(
    "statement",
    [
        f"kept may move it by more than {percent(verdict.LEANING)}",
        f"it would move by more than {percent(verdict.SWAYED)} were a parameter",
        f"standard deviation exceeds half the value (of a phase: {verdict.UNTOLD:g} rad)",
        f"else {percent(influence.DOUBT)}, and {percent(influence.GUESSED)} where its source begins with",
        f"more than {NUMBERS[int(twin.CONTRADICTION)]} standard deviations away",
        f"more is left than {percent(explain.LEFT_IN_MOTION)} of an angle, a speed or a loop, "
        f"or {percent(explain.LEFT_IN_TORQUE)} of a friction torque or a current",
        f"the friction is more than {plausible.APART:g} times as large or small",
        f"the stiffness is more than {plausible.APART:g} times as large or small",
        f"{plausible.FEWEST} rows or more, and the change of speed explains half of what is left",
        "the spring of a loop carries less than a fifth of the torque",
    ],
)
def test_a_threshold_is_stated_as_it_is(statement: str) -> None:
    assert statement in PAGE


def test_thresholds_stated_in_words_are_those() -> None:
    assert explain.LEFT_IN_LOOP == explain.LEFT_IN_MOTION
    assert (verdict.UNTOLD, plausible.MOVING, plausible.ELASTIC) == (0.5, 0.5, 1.0 / 5.0)
