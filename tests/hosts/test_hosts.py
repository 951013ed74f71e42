"""Hosts take the files of a first command, and move a gear as `sw.simulate` does: `python -m tests.hosts` in short."""

from __future__ import annotations

from importlib.util import find_spec
from pathlib import Path

import pytest
import strainwave as sw

from tests.hosts.gears import ENDS
from tests.hosts.hosts import HOSTS, Compared, Host, outcome
from tests.hosts.robot import UR10E, robots

# Of the range, above what was measured: the laws that the host has no element for are in it.
MAX_SHARES = {
    "MuJoCo, MJCF": 2e-3,
    "MuJoCo, plugin": 1e-3,
    "FMPy, FMI 2 co-simulation": 2e-3,
    "FMPy, FMI 3 co-simulation": 2e-3,
    "ecos, FMI 2 co-simulation": 2e-3,
    "ecos, FMI 3 co-simulation": 2e-3,
    "firmware, double": 1e-12,
    "firmware, float": 1e-5,
    "Newton": 1e-4,
    "python-control": 2e-2,
    "BAM": 1e-9,
    "URDF, ROS 2": 1e-9,
}
NEEDS = {
    "MuJoCo": "mujoco",
    "FMPy": "fmpy",
    "ecos": "ecospy",
    "Newton": "newton",
    "python-control": "control",
    "URDF, ROS 2": "xacro",
}


# Of model exchange tests/python/export/test_fmu.py has solvers with both versions.
@pytest.mark.slow("export")
@pytest.mark.usefixtures("kept_builds")
@pytest.mark.parametrize("host", [host for host in HOSTS if "model exchange" not in host.name], ids=lambda host: host.name)
def test_a_gear_with_hysteresis_moves_as_simulated(host: Host, tmp_path: Path) -> None:
    for beginning, package in NEEDS.items():
        if host.name.startswith(beginning) and find_spec(package) is None:
            pytest.skip(f"{package} is not installed")
    name, inertia = next(iter(ENDS.items()))
    joint = sw.GearSet.read(name).with_parts(load=sw.loads.Inertia(inertia=inertia), source="test")
    found = outcome(host, joint, tmp_path / "host")
    assert found.works == "yes"
    assert isinstance(found.compared, Compared), found.compared
    assert found.compared.share < MAX_SHARES[host.name]


@pytest.mark.slow("export")
def test_six_gears_in_a_robot_carry_it_as_simulated(tmp_path: Path) -> None:
    """The twist of the elbow over 10 s with gravity, without the kinematic error, which MJCF leaves out."""
    pytest.importorskip("mujoco")
    found = list(robots(tmp_path))
    assert [each.works for _, _, each in found] == ["yes"] * (1 + UR10E.exists())
    for (_, _, each), largest in zip(reversed(found), (1e-2, 1e-4), strict=False):
        assert isinstance(each.compared, Compared)
        assert each.compared.share < largest
