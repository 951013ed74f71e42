"""Torsion loops measured by others, as the rig analyses them: regimes, widths and areas.

Torque over deflection of printed cycloidal gears, output locked: JelmerV, Anti-Backlash-Cycloidal-Actuator (CC BY-SA 4.0),
digitised from its figures. No public loop of a strain wave gear is known to us. Each begins and ends near zero torque, in the
middle of a branch. Run with `-s` to read the numbers.
"""

from __future__ import annotations

import os
from pathlib import Path

import numpy as np
import pytest
from strainwave.rig import Loop, LoopAnalysis, analyse
from strainwave.rig.analysis.regimes import NAMES

FOLDER = Path(os.environ.get("STRAINWAVE_DATA", Path(__file__).parents[3] / "shared" / "data")) / "cycloidal-loops"
LOOPS = sorted(path.name for path in FOLDER.glob("torque-displacement_of_*.csv"))
PLAY = [name for name in LOOPS if "_ax0_" in name]  # to 4 N.m; the others to 25 or 40 N.m

pytestmark = pytest.mark.skipif(not FOLDER.is_dir(), reason=f"measured data not found: {FOLDER} (set STRAINWAVE_DATA)")


def points(name: str) -> tuple[np.ndarray, np.ndarray]:
    """Angle [rad] and torque [N.m]."""
    torque, angle = np.loadtxt(FOLDER / name, delimiter=",", skiprows=1).T
    return np.radians(angle), torque


def analysed(name: str) -> LoopAnalysis:
    return analyse(Loop(*points(name), side="output", name=name.removesuffix(".csv")))


def polygon(angle: np.ndarray, torque: np.ndarray) -> float:
    """Area by triangles from the first point."""
    across = [(angle[i] - angle[0]) * (torque[i + 1] - torque[0]) - (angle[i + 1] - angle[0]) * (torque[i] - torque[0])
              for i in range(1, len(angle) - 1)]  # fmt: skip
    return 0.5 * abs(float(np.sum(across)))


def scanned(angle: np.ndarray, torque: np.ndarray, level: float) -> float:
    """Width at a torque: the polygon's crossings of a level, the outermost two."""
    closed_angle, closed_torque = np.append(angle, angle[0]), np.append(torque, torque[0])
    below, above = closed_torque[:-1] - level, closed_torque[1:] - level
    rows = np.flatnonzero(below * above < 0.0)
    share = below[rows] / (below[rows] - above[rows])
    crossings = closed_angle[rows] + share * np.diff(closed_angle)[rows]
    return float(np.ptp(crossings))


@pytest.mark.parametrize("name", LOOPS)
def test_a_measured_loop_has_four_regimes_and_the_area_of_its_polygon(name: str) -> None:
    angle, torque = points(name)
    found = analysed(name)
    assert tuple(each.name for each in found.stiffnesses) == NAMES
    assert found.cut.closed
    assert len(found.cut.cycle) == len(angle)
    assert found.area is not None
    assert found.hysteresis is not None
    print(f"\n{name}: {np.degrees(found.hysteresis.width.value):.3f} degrees, {found.area}")
    assert found.area.value == pytest.approx(polygon(angle, torque), rel=0.02)


@pytest.mark.parametrize("name", LOOPS)
def test_its_width_is_that_of_the_polygon_at_levels_of_torque(name: str) -> None:
    """Where each branch passes a level once; near zero torque, where the record begins and ends, the end counts."""
    angle, torque = points(name)
    found = analysed(name)
    assert found.hysteresis is not None
    width, (low, high) = found.hysteresis.width.value, found.peaks
    levels = np.linspace(low, high, 200)[10:-10]
    widest = max(scanned(angle, torque, level) for level in levels)
    assert width == pytest.approx(widest, rel=0.1)
    assert width >= (1.0 - 1e-9) * scanned(angle, torque, found.hysteresis.torque) - 3.0 * found.hysteresis.width.sigma


@pytest.mark.parametrize("name", PLAY)
def test_play_tests_are_stiff_unloading_and_soft_loading(name: str) -> None:
    found = analysed(name)
    stiff = [each.secant.value for each in found.stiffnesses[::2] if each.secant is not None]
    soft = [each.secant.value for each in found.stiffnesses[1::2] if each.secant is not None]
    assert min(stiff) > 2.0 * max(soft)
    assert found.closure is not None
    assert abs(found.closure.value) < 0.2 * abs(found.width_at_zero.value)  # type: ignore[union-attr]
