"""Angles that begin anew with each revolution."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st
from hypothesis.extra.numpy import arrays
from numpy.typing import NDArray
from strainwave.identification.reading.motion import jumps, unwrapped

steps = arrays(np.float64, st.integers(5, 200), elements=st.floats(-0.24, 0.24))


@settings(deadline=None)
@given(steps, st.floats(0.0, 1.0), st.sampled_from([2.0 * np.pi, 360.0, 1.0, 16384.0]))
def test_what_was_wrapped_is_found_again(steps: NDArray[np.float64], zero: float, period: float) -> None:
    truth = period * np.cumsum(steps)
    wrapped = (truth + zero * period) % period
    found, wraps = unwrapped(wrapped, period)
    assert np.diff(found) == pytest.approx(np.diff(truth), abs=1e-9 * period)
    assert wraps == int((np.abs(np.diff(wrapped)) > 0.5 * period).sum())


@given(arrays(np.float64, 50, elements=st.floats(-1.0, 1.0)))
def test_what_does_not_wrap_stays_as_it_is(angle: NDArray[np.float64]) -> None:
    found, wraps = unwrapped(angle, 4.0)
    assert (found is angle, wraps) == (True, 0)


def test_a_shaft_too_fast_for_its_samples_is_refused() -> None:
    with pytest.raises(ValueError, match=r"do not show in which direction the shaft went; record it more often"):
        unwrapped(0.4 * np.arange(100) % 1.0, 1.0)


def test_an_outlier_and_a_fast_motion_are_no_jumps() -> None:
    time = np.arange(0.0, 4.0, 0.01)
    angle = np.sin(time)
    angle[100] += 0.5
    assert not len(jumps(angle, time))
    fast = np.where(time < 2.0, 0.0, 1.0 - np.exp(-(time - 2.0) / 0.02))  # a step of a fast drive
    assert not len(jumps(fast, time))
    angle[250:] += 0.5
    assert jumps(angle, time).tolist() == [250]
    assert jumps(angle, time, np.full(len(time), 20.0)).tolist() == []  # which the shaft may move in a row
