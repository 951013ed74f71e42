"""What influences a loop, on measured data: torque level on printed cycloidal gears, temperature on a joint of a UR3.

Data and licences: README.md of the data. Run with `-s` to read the numbers.
"""

from __future__ import annotations

import csv
import os
from pathlib import Path

import numpy as np
import pytest
import strainwave as sw
from numpy.typing import NDArray
from strainwave.rig.influence.series import Series, analyse_series, figures_of
from strainwave.rig.influence.trend import Trend
from strainwave.rig.loop import Loop
from torsion_influences import JOINT_FRICTION_FALL_RATE

Array = NDArray[np.float64]

FOLDER = Path(os.environ.get("STRAINWAVE_DATA", Path(__file__).parents[3] / "shared" / "data"))
pytestmark = pytest.mark.skipif(not FOLDER.is_dir(), reason=f"measured data not found: {FOLDER} (set STRAINWAVE_DATA)")
BUILDS = ("Baseline", "Conic_Disk", "Split_Pinwheel")
MOVING = 0.1  # rad/s


@pytest.fixture(scope="module")
def loops() -> tuple[list[Loop], list[str]]:
    columns = {"twist": "deflection_deg", "torque": "motor_torque_output_side_Nm"}
    found, builds = [], []
    for build in BUILDS:
        for path in sorted((FOLDER / "cycloidal-loops").glob(f"torque-displacement_of_{build}_*")):
            read = sw.Recording.from_csv(path, columns=columns, units={"twist": "deg", "torque": "N.m"})
            found.append(Loop(read.values("twist", "rad"), read["torque"], side="output", name=path.name))
            builds.append(build)
    return found, builds


@pytest.fixture(scope="module")
def by_torque(loops: tuple[list[Loop], list[str]]) -> dict[str, Trend]:
    found, builds = loops
    torque = [0.5 * float(np.ptp(loop.torque)) for loop in found]
    trends = {each.quantity: each for each in analyse_series(Series({"torque_max": torque}, figures_of(found), builds))}
    for name, each in trends.items():
        print(f"\n{name} ~ torque^{each.slope.value:.3f} +- {each.slope.half_width:.3f}, p = {each.corrected:.2g}")
    return trends


@pytest.mark.slow("rig")
def test_area_and_width_grow_with_the_torque(by_torque: dict[str, Trend]) -> None:
    """As document T has it: 28 loops of +-4 and +-25 to 36 N.m, three builds."""
    for name in ("area", "width"):
        assert by_torque[name].points == 28
        assert by_torque[name].significant
        assert by_torque[name].shuffled < 0.01
        assert by_torque[name].interval[0] > 0.5
    assert by_torque["area"].interval[0] > by_torque["width"].interval[1]  # it also grows along the torque


@pytest.mark.slow("rig")
def test_the_slope_of_unloading_falls_with_the_torque(by_torque: dict[str, Trend]) -> None:
    """Against document T's first entry: friction within holds the shaft over more of a small loop than of a large one."""
    assert by_torque["high_stiffness"].significant
    assert by_torque["high_stiffness"].interval[1] < 0.0


@pytest.mark.slow("rig")
def test_areas_are_those_of_polygons(loops: tuple[list[Loop], list[str]]) -> None:
    """By Gauss's formula over all points of a loop."""
    for loop, area in zip(loops[0], figures_of(loops[0])["area"], strict=True):
        x, y = loop.angle, loop.torque
        polygon = 0.5 * abs(float(np.sum(x * np.roll(y, -1) - np.roll(x, -1) * y)))
        assert area == pytest.approx(polygon, rel=0.02), loop.name


def joint() -> tuple[Array, Array]:
    """Temperature [K] and friction current [A] of joint 3 in each cycle of work: half of what its sense of motion changes."""
    names = ("Current_J3", "Temperature_J3", "Speed_J3", "cycle ")
    with (FOLDER / "cobot-temperature" / "dataset_02052023.csv").open(encoding="utf-8") as file:
        rows = [[row[name].replace(",", ".") for name in names] for row in csv.DictReader(file, delimiter=";")]
    numbers = np.array([[float(cell) for cell in row] for row in rows if all(row)])
    current, celsius, speed, cycle = numbers[numbers[:, 1] > 0.0].T
    found = []
    for each in np.unique(cycle):
        ways = [(cycle == each) & (sign * speed > MOVING) for sign in (1.0, -1.0)]
        if min(way.sum() for way in ways) >= 4:
            friction = 0.5 * (current[ways[0]].mean() - current[ways[1]].mean())
            found.append((celsius[ways[0] | ways[1]].mean() + 273.15, friction))
    temperature, friction = np.array(found).T
    return temperature, friction


def test_friction_of_a_joint_falls_as_it_warms_up() -> None:
    """By 2.3 % per kelvin, 95 %: 0.8 to 3.9 %; the rate that stands in for a gear's that is not known."""
    temperature, friction = joint()
    (trend,) = analyse_series(Series({"temperature": temperature}, {"friction": friction}))
    relative = trend.slope.value / friction.mean()
    low, high = (end / friction.mean() for end in trend.interval)
    print(f"\n{trend.points} cycles: {100 * relative:.2f} % per kelvin, {100 * low:.2f} to {100 * high:.2f}")
    assert trend.significant
    assert trend.shuffled < 0.01
    assert low < relative < high < 0.0
    assert pytest.approx(-relative, rel=0.01) == JOINT_FRICTION_FALL_RATE
