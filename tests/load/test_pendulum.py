"""A pendulum whose encoder counts from elsewhere than the lowest place."""

from __future__ import annotations

import numpy as np
import pytest
import strainwave as sw
from hypothesis import given, strategies as st

from tests.load.free import free, held, placed, run_of
from tests.support.geared import outputs

ARM = sw.loads.Pendulum(inertia=0.5, gravity_torque=15.0)


@given(angle=st.floats(-3.0, 3.0), phase=st.floats(-3.0, 3.0))
def test_its_torque_is_that_of_the_angle_from_hanging_down(angle: float, phase: float) -> None:
    drive = held(ARM.replace(gravity_phase=phase))
    torque = outputs(drive, placed(drive, angle, 0.0))["load_torque"]
    assert torque == pytest.approx(15.0 * np.sin(angle + phase), rel=1e-12, abs=1e-12)


def test_a_shifted_pendulum_swings_as_one_that_counts_from_hanging_down() -> None:
    plain, shifted = free(ARM), free(ARM.replace(gravity_phase=0.8))
    run = run_of(plain, 1.0, 1e-4, placed(plain, 0.5), sample=0.1)
    same = run_of(shifted, 1.0, 1e-4, placed(shifted, 0.5 - 0.8), sample=0.1)
    assert same["output_angle"] + 0.8 == pytest.approx(run["output_angle"], abs=1e-9)
