"""What experiments predict of a model, and how that changes with its numbers and with the unknowns of the measurement."""

from __future__ import annotations

from typing import Any, Literal

import numpy as np
import pytest
import strainwave as sw
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray
from strainwave import _core
from strainwave.identify.experiment import TorsionLoop

from tests.strategies import built

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
    gear = sw.Gear(stiffness=SPRING, hysteresis=data.draw(built(kind)))
    path = np.tile(TWIST - zero, 2 if history == "cyclic" else 1)
    predicted, _ = loop(history).predict(gear, [], np.array([0.0, zero]))
    traced = gear.trace(path)[-len(TWIST) :]  # which begins at twist 0 too, by a way of its own
    assert predicted[0] == pytest.approx(traced, rel=1e-9, abs=1e-9 * np.abs(traced).max())


@every_hysteresis
@given(data=st.data(), history=histories)
def test_the_derivative_by_the_zero_of_the_twist_is_what_differences_show(
    kind: type[Any], data: st.DataObject, history: Literal["cyclic", "virgin"]
) -> None:
    gear, measured = sw.Gear(stiffness=SPRING, hysteresis=data.draw(built(kind))), loop(history)

    def difference(h: float) -> Array:
        up, down = (measured.predict(gear, [], np.array([0.0, ZERO + step]))[0][0] for step in (h, -h))
        return (up - down) / (2.0 * h)

    _, slopes = measured.predict(gear, [], np.array([0.0, ZERO]))
    coarse, fine = difference(2e-5 * HALF), difference(1e-5 * HALF)
    unsure = np.abs(coarse - fine)  # large where a corner lies between
    size = np.abs(fine).max()
    assert np.all(np.abs(slopes[1, 0] - fine) <= 1e-6 * size + unsure)
    assert np.mean(unsure < 1e-4 * size) > 0.9
