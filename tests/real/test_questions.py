"""Every command that a question about a recording of others prints works on that recording."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

from tests.support.answers import outcomes

SHARED = Path(__file__).parents[3] / "shared"
ARMS = Path(os.environ.get("STRAINWAVE_DATA", SHARED / "data")) / "arms"
TRIALS = Path(os.environ.get("STRAINWAVE_TRIALS", SHARED / "trials"))

needs_arms = pytest.mark.skipif(not ARMS.is_dir(), reason=f"measured data not found: {ARMS} (set STRAINWAVE_DATA)")
needs_trials = pytest.mark.skipif(not TRIALS.is_dir(), reason=f"trials not found: {TRIALS} (set STRAINWAVE_TRIALS)")
OF_ORDERS = ("te_", "v_", "no_te", "enc2", "runup")  # beginnings of names of recordings for `strainwave orders`
ROBOTS = ("kinova-gen3/RunTrajectory1.csv", "icub/left-hip-pitch/idle.mat", "icub/right-knee/idle.mat", "kuka-kr300/FF_A.mat")

RECORDINGS = [each for each in sorted(TRIALS.rglob("*.*")) if each.suffix != ".md"]


def check(command: str, path: Path, folder: Path) -> None:
    for words, result in outcomes([*command.split(), str(path)], folder, most=2):
        assert result.returncode in (0, 3) or "record" in result.stderr, f"{words}: {result.stderr}"


@pytest.mark.slow("commands")
@needs_trials
@pytest.mark.parametrize("path", RECORDINGS, ids=lambda path: str(path.relative_to(TRIALS)))
def test_questions_of_trials(path: Path, tmp_path: Path) -> None:
    check("orders" if path.name.startswith(OF_ORDERS) else "identify csg-20-100", path, tmp_path)


@pytest.mark.slow("commands")
@needs_arms
@pytest.mark.parametrize("name", ROBOTS)
def test_questions_of_robots(name: str, tmp_path: Path) -> None:
    check("identify csg-20-100", ARMS / name, tmp_path)
