"""Recordings that a diagnosis refuses: the reason contains what is wrong, its value, the limit and what to do."""

from __future__ import annotations

from math import tau

import numpy as np
import pytest
import strainwave as sw
from strainwave.diagnose.refusals import usable


def recording(revolutions: float = 20.0, rate: float = 500.0, duration: float = 20.0, **left_out: bool) -> sw.Recording:
    """A motor that turns to and fro over so many revolutions."""
    time = np.arange(0.0, duration, 1.0 / rate)
    angle = 0.5 * tau * revolutions * np.sin(tau * time / duration)
    current = 0.4 * np.sign(np.gradient(angle)) + np.random.default_rng(0).normal(0.0, 0.05, len(time))
    columns = {"time": time, "input_angle": angle, "current": current}
    units = {"time": "s", "input_angle": "rad", "current": "A"}
    kept = [name for name in columns if not left_out.get(name)]
    return sw.Recording({name: columns[name] for name in kept}, {name: units[name] for name in kept})


def test_a_usable_recording_keeps_its_columns() -> None:
    run = usable(recording(), "log.csv", ratio=-100.0)
    assert (run.column, run.angle, run.side, run.ratio, run.per_input) == ("current", "input_angle", "input", 100.0, 1.0)


@pytest.mark.parametrize(
    ("made", "reason"),
    [
        (
            recording(revolutions=1.5),
            r"log.csv: too short: the input turns 1.5 revolutions .* needs 3 or more; record",
        ),
        (recording(revolutions=1e-5), r"log.csv: at rest: input_angle moves by 6.28e-05 rad .* at least 0.001 rad .* motion"),
        (recording(revolutions=400.0, rate=100.0), r"aliased: order 2 .* passes at .* Hz .* limit is 50 Hz.* slower"),
        (recording(current=True), r"without current or torque: its columns are time, input_angle; .* --column current="),
        (
            recording(input_angle=True),
            r"without an angle or a speed: its columns are time, current; .* --column output_angle=",
        ),
    ],
)
def test_the_reason_contains_value_limit_and_remedy(made: sw.Recording, reason: str) -> None:
    with pytest.raises(ValueError, match=reason):
        usable(made, "log.csv")


def test_a_known_ratio_counts_the_revolutions_of_the_input() -> None:
    """0.1 revolutions of the output are 10 of the input at a ratio of 100, and 3 at the smallest ratio of makers."""
    fast = recording(revolutions=0.08)
    slow = sw.Recording(
        {"time": fast["time"], "output_angle": fast["input_angle"], "current": fast["current"]},
        {"time": "s", "output_angle": "rad", "current": "A"},
    )
    assert usable(slow, "log.csv", ratio=100.0).side == "output"
    with pytest.raises(ValueError, match=r"2.4 revolutions .* with the smallest ratio that makers offer, 30"):
        usable(slow, "log.csv")


def test_the_limit_of_aliasing_is_half_the_rate_at_the_usual_speed() -> None:
    """At 100 Hz order 2 may pass at 50 Hz: 25 revolutions of the input per second."""
    time = np.arange(0.0, 20.0, 0.01)
    noise = np.random.default_rng(1).normal(size=len(time))
    for speed, is_used in ((24.0, True), (26.0, False)):
        made = sw.Recording(
            {"time": time, "input_angle": tau * speed * time, "current": noise},
            {"time": "s", "input_angle": "rad", "current": "A"},
        )
        if is_used:
            assert usable(made, "log.csv").name == "log.csv"
        else:
            with pytest.raises(ValueError, match=r"passes at 52 Hz .* the limit is 50 Hz"):
                usable(made, "log.csv")
