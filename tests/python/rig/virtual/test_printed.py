"""The gears of document T's Table 2: their loops are closed, and have the slopes and the widths that are printed."""

from __future__ import annotations

import math

import numpy as np
import pytest
from strainwave.rig import Rig, Step, Value
from strainwave.rig.virtual.loading import Loading, load_by_steps
from strainwave.rig.virtual.printed import PEAK_TORQUE, TABLE_2, gear_of_regimes, peak_needed, printed_gear

BENCH = Rig("bench", "input", disk_radius=Value(0.1), gravity=Value(10.0))  # 1 kg is 1 N.m


def loop(position: int, levels: np.ndarray) -> Loading:
    """The cycle down and up through these falling torques, its first step again at its end."""
    torques = np.concatenate((levels, levels[-2::-1]))
    steps = [Step(n, max(each, 0.0), max(-each, 0.0)) for n, each in enumerate(torques, 1)]
    return load_by_steps(printed_gear(position), BENCH, steps)


@pytest.mark.parametrize("position", TABLE_2)
def test_a_row_closes_with_its_slopes_and_its_width(position: int) -> None:
    """Slopes where the regimes have them: unloading to zero, loading between 0.1 and 0.2 N.m. Width at zero torque."""
    *slopes, width = TABLE_2[position]
    found = loop(position, np.array([PEAK_TORQUE, 0.2, 0.1, 0.0, -0.1, -0.2, -PEAK_TORQUE]))
    assert found.angle[-1] == pytest.approx(0.0, abs=1e-9)
    slope = np.diff(found.applied) / np.diff(found.angle)
    assert slope[[1, 4, 7, 10]] == pytest.approx(slopes, rel=1e-6)
    assert math.degrees(found.angle[3] - found.angle[9]) == pytest.approx(width, rel=1e-6)


def test_row_0_is_the_published_loop() -> None:
    """Its vertices, but for the four knees: there, the short stiff pieces have the mean of both stiff slopes."""
    levels = np.array([0.36, 0.313458, 0.03, 0.0, -0.03, -0.321719, -0.36])
    found = loop(0, levels)
    expected = {0: 0.0, 3: -4.573499, 4: -4.940780, 5: -58.857716, 6: -59.326382, 9: -55.073499, 10: -54.706218, 11: -0.569804}
    for k, degrees in expected.items():
        at_knee = k in (4, 5, 10, 11)
        assert math.degrees(found.angle[k]) == pytest.approx(degrees, abs=0.025 if at_knee else 2e-6)
    area = abs(float(np.trapezoid(found.applied, found.angle)))
    assert area == pytest.approx(0.3063483432, rel=2e-3)


def test_a_loop_wider_than_its_torque_can_make_is_refused() -> None:
    with pytest.raises(ValueError, match=r"width = 1 rad asks for 0\.3\d+ N\.m at a loading stiffness of 0\.3 N\.m/rad"):
        gear_of_regimes(4.51, 0.31, 4.85, 0.30, width=1.0, peak=0.33)
    with pytest.raises(ValueError, match=r"position = 30 degrees must be 0, 60 or 120"):
        printed_gear(30)


@pytest.mark.parametrize("position", TABLE_2)
def test_a_loop_has_its_printed_width_from_the_peak_it_needs(position: int) -> None:
    """A peak at which the loop is just as wide as printed, and one below at which it is narrower."""
    needed, width = peak_needed(position), TABLE_2[position][-1]
    widths = []
    for peak in (1.001 * needed, 0.98 * needed):
        found = loop(position, np.array([peak, 0.0, -peak]))
        widths.append(math.degrees(found.angle[1] - found.angle[3]))
    assert widths[0] == pytest.approx(width, rel=1e-6)
    assert widths[1] < 0.99 * width
