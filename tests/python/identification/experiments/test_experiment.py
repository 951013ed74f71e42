"""What experiments predict of a model, and how that changes with its numbers and with the unknowns of the measurement."""

from __future__ import annotations

from typing import Any, Literal

import numpy as np
import pytest
import strainwave as sw
from hypothesis import given, strategies as st
from numpy.typing import NDArray
from strainwave import _core
from strainwave.identification.experiments.drive_log import DriveLog
from strainwave.identification.experiments.torsion_loop import TorsionLoop

from tests.support.strategies import built, suited

Array = NDArray[np.float64]

HALF = 1.5e-3  # rad
ZERO = 0.3 * HALF  # off the middle, where a symmetric path meets its own turning points
TWIST = HALF * np.sin(np.linspace(0.2, 0.2 + 2.0 * np.pi, 97)) + ZERO
SPRING = sw.stiffness.Cubic(a1=1.5e4, a3=6e9)

every_hysteresis = pytest.mark.parametrize("kind", _core.families["hysteresis"].values(), ids=lambda kind: kind.name)
histories = st.sampled_from(["cyclic", "virgin"])


def loop(history: Literal["cyclic", "virgin"]) -> TorsionLoop:
    return TorsionLoop(TWIST, SPRING.torque(TWIST - ZERO), history)


@every_hysteresis
@given(data=st.data(), history=histories, zero=st.floats(-HALF, HALF))
def test_a_loop_is_predicted_from_twist_zero_on(
    kind: type[Any], data: st.DataObject, history: Literal["cyclic", "virgin"], zero: float
) -> None:
    gear = sw.Gear(stiffness=SPRING, hysteresis=suited(data.draw(built(kind)), sw.Gear().kinematics))
    path = np.tile(TWIST - zero, 2 if history == "cyclic" else 1)
    predicted, _ = loop(history).predict(gear, [], np.array([0.0, zero]))
    traced = gear.trace(path)[-len(TWIST) :]  # which begins at twist 0 too, by a way of its own
    assert predicted[0] == pytest.approx(traced, rel=1e-9, abs=1e-9 * np.abs(traced).max())


@every_hysteresis
@given(data=st.data(), history=histories)
def test_the_derivative_by_the_zero_of_the_twist_is_what_differences_show(
    kind: type[Any], data: st.DataObject, history: Literal["cyclic", "virgin"]
) -> None:
    gear, measured = sw.Gear(stiffness=SPRING, hysteresis=suited(data.draw(built(kind)), sw.Gear().kinematics)), loop(history)

    def difference(h: float) -> Array:
        up, down = (measured.predict(gear, [], np.array([0.0, ZERO + step]))[0][0] for step in (h, -h))
        return (up - down) / (2.0 * h)

    _, slopes = measured.predict(gear, [], np.array([0.0, ZERO]))
    coarse, fine = difference(2e-5 * HALF), difference(1e-5 * HALF)
    unsure = np.abs(coarse - fine)  # large where a corner lies between
    size = np.abs(fine).max()
    assert np.all(np.abs(slopes[1, 0] - fine) <= 1e-6 * size + unsure)
    assert np.mean(unsure < 1e-4 * size) > 0.9


FINE = np.linspace(0.0, 0.1, 2001)  # s: a row every 0.05 ms
LINES, JUMPS = st.lists(st.floats(-5.0, 5.0), min_size=2, max_size=6), st.lists(st.floats(0.0, 0.1), max_size=6)


def log_of(command: Array) -> DriveLog:
    columns = {"time": FINE, "command": command, "output_angle": np.sin(20.0 * FINE) ** 2}
    return DriveLog.of(sw.Recording(columns, {"time": "s", "command": "V", "output_angle": "rad"}), sw.Drive())


@given(lines=LINES, jumps=JUMPS)
def test_a_command_recorded_finer_than_the_steps_keeps_all_its_bends(lines: list[float], jumps: list[float]) -> None:
    command = np.interp(FINE, np.linspace(0.0, 0.1, len(lines)), lines) + sum(jump < FINE for jump in jumps)
    assert log_of(command).command.value(FINE) == pytest.approx(command, abs=1e-6 * max(float(np.ptp(command)), 1e-9))


@pytest.mark.parametrize(("frequency", "apart"), [(12.0, 2e-4), (24.0, 1e-4), (80.0, 5e-5)])
def test_of_a_command_recorded_finer_than_the_steps_no_more_rows_are_taken_than_its_bends_need(
    frequency: float, apart: float
) -> None:
    """A chord of a sine of amplitude A lies up to A w^2 h^2 / 8 beside it: for 1e-6 A a chord may be h = 2.8e-3 / w long."""
    knots = log_of(np.sin(frequency * FINE)).command.start
    assert np.median(np.diff(knots)) == pytest.approx(apart)


@given(duration=st.floats(1e-3, 0.1))
def test_the_beginning_of_a_log_has_the_command_that_the_log_has_there(duration: float) -> None:
    whole = log_of(np.sin(20.0 * FINE) + (FINE > 0.0301))
    early = whole.beginning(duration)
    time = FINE[early.command.duration >= FINE]
    assert early.command.duration == early.time[-1] <= duration
    assert early.command.value(time).tolist() == whole.command.value(time).tolist()


def test_a_log_is_stepped_for_a_drive_alone() -> None:
    with pytest.raises(TypeError, match=r"must be a drive, as sw\.Drive"):
        log_of(np.sin(FINE)).step(sw.Gear())  # type: ignore[arg-type]
