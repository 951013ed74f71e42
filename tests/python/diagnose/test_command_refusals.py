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
        (
            recording(revolutions=400.0, rate=100.0),
            r"aliased: order 2 .* passes at .* Hz .* limit is 40 Hz, 0.8 of half .* slower",
        ),
        (recording(current=True), r"without current or torque: its columns are time, input_angle; .* record it"),
        (
            recording(input_angle=True),
            r"without an angle or a speed: its columns are time, current; .* record it",
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


def test_the_limit_of_aliasing_is_that_of_the_blind_search_at_the_usual_speed() -> None:
    """At 100 Hz order 2 may pass at 40 Hz: 20 revolutions of the input per second."""
    time = np.arange(0.0, 20.0, 0.01)
    noise = np.random.default_rng(1).normal(size=len(time))
    for speed, is_used in ((19.0, True), (21.0, False)):
        made = sw.Recording(
            {"time": time, "input_angle": tau * speed * time, "current": noise},
            {"time": "s", "input_angle": "rad", "current": "A"},
        )
        if is_used:
            run = usable(made, "log.csv")
            assert sw.orders.ripple(run.recording, run.column, angle=run.angle, side="input").highest > 2.0
        else:
            with pytest.raises(ValueError, match=r"passes at 42 Hz .* the limit is 40 Hz"):
                usable(made, "log.csv")


def both_angles(ratio: float, divided: float = 1.0) -> sw.Recording:
    """A motor and its output to and fro, with the motor angle divided by a number."""
    made = recording(revolutions=40.0)
    motor = made["input_angle"]
    return made.with_column("output_angle", motor / ratio, "rad").with_column("input_angle", motor / divided, "rad")


def test_a_ratio_that_is_not_that_of_both_angles_is_refused() -> None:
    assert usable(both_angles(150.0), "log.csv", ratio=150.0).per_input == 1.0
    with pytest.raises(ValueError, match=r"log.csv: ratio = 100 is not that of the angles, 150 .* check the units of both"):
        usable(both_angles(150.0), "log.csv", ratio=100.0)


def test_a_motor_angle_in_joint_units_is_multiplied_by_the_ratio() -> None:
    """Else order 2 of the input would be looked for at 2 per revolution of the output."""
    run = usable(both_angles(100.0, divided=100.0), "log.csv", ratio=100.0)
    assert run.side == "input"
    assert np.ptp(run.recording["input_angle"]) == pytest.approx(40.0 * tau, rel=1e-6)
    assert any("joint units" in remark for remark in run.remarks)
    blind = usable(both_angles(100.0, divided=100.0), "log.csv")
    assert blind.side == "output"
    assert np.isnan(blind.per_input)


def test_angles_that_do_not_move_together_are_a_remark() -> None:
    made = recording()
    other = made.with_column("output_angle", np.cos(3.0 * made["time"]), "rad")
    assert any("the ratio of both angles is not determined" in remark for remark in usable(other, "log.csv").remarks)


def test_a_speed_without_time_is_refused_with_the_name_of_the_file() -> None:
    made = sw.Recording({"input_speed": np.ones(100), "torque": np.ones(100)}, {"input_speed": "rad/s", "torque": "N.m"})
    with pytest.raises(ValueError, match=r"log.csv: input_speed gives an angle only over time: .* --constant rate=NUMBER"):
        usable(made, "log.csv")
