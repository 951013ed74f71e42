"""A joint of another program: measured, identified, and under the firmware that compensates by what was identified."""

from __future__ import annotations

import shutil
import subprocess
from pathlib import Path

import numpy as np
import pytest
import strainwave as sw

from tests.evidence import independent_joint
from tests.evidence.rig import measured
from tests.support.cplusplus import compiler

pytestmark = pytest.mark.skipif(
    not (independent_joint.RIG / "joint.c").is_file(),
    reason=f"the joint of another program was not found: {independent_joint.RIG} (set STRAINWAVE_RIG)",
)
MAX_TORQUE_ERROR = 5e-3  # of the variation of the torque
MIN_SHARE_WITHIN_TWO_SIGMA = 0.95  # of the samples
LOG_SECONDS, LOG_RATE = 15, 500  # s, Hz
MAX_SHARE = 0.1  # of the error of the tuned cascade with constant feed-forward


FRICTION = {"Fc": 0.047, "Fs": 0.062, "viscous": 2.9e-4}  # of the joint
MORE = 1.3  # friction of the joint over that which was identified
MAX_SHARE_WITH_SCALE = 0.95  # of the error of the same candidate without an observer of the scale


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("joint")
    for name in independent_joint.FILES:
        shutil.copy(measured(3) / name, folder)
    log = (folder / "log_full.csv").read_text().splitlines(keepends=True)
    (folder / "log_full.csv").write_text("".join(log[: 1 + LOG_SECONDS * LOG_RATE]))
    return folder


@pytest.fixture(scope="module")
def identified(folder: Path) -> sw.Drive:
    return independent_joint.identify(folder)


@pytest.mark.slow("identification")
def test_the_firmware_takes_away_nine_tenths_of_the_error(identified: sw.Drive, tmp_path: Path) -> None:
    before = independent_joint.run(independent_joint.with_constants(identified, "input"), tmp_path, [])
    after = independent_joint.run(independent_joint.with_model(identified, "input"), tmp_path, [])
    assert before.reversals > 50
    for measure in ("rms", "largest", "at_reversals"):
        assert getattr(after, measure) < MAX_SHARE * getattr(before, measure), (measure, before, after)


@pytest.mark.slow("tuning")
def test_the_scale_of_friction_pays_in_a_joint_with_more_friction(identified: sw.Drive, tmp_path: Path) -> None:
    words = [f"{name}={MORE * value}" for name, value in FRICTION.items()]
    model = "model of friction, torsion and kinematic error"
    plain, scaled = (
        independent_joint.run(independent_joint.candidate(identified, model + observed), tmp_path, words)
        for observed in ("", ", scale of friction observed")
    )
    for measure in ("rms", "largest", "at_reversals"):
        assert getattr(scaled, measure) < MAX_SHARE_WITH_SCALE * getattr(plain, measure), (measure, plain, scaled)


@pytest.mark.slow("identification")
@pytest.mark.usefixtures("identified")
def test_the_identified_gear_measures_the_torque_of_the_output(folder: Path, tmp_path: Path) -> None:
    """The joint prints its true torque, along motions that were not identified."""
    subprocess.run([*compiler("gcc"), "-O2", independent_joint.RIG / "joint.c", "-lm", "-o", tmp_path / "joint"], check=True)
    printed = subprocess.run([tmp_path / "joint", "amplitude=.7", "end=12"], check=True, capture_output=True, text=True).stdout
    time, _, _, motor, _, link, _, torque, _ = np.loadtxt(printed.splitlines()).T
    zero = independent_joint.ENCODER_ZERO
    found = sw.analysis.output_torque(folder / "found" / "gear.toml", motor + zero, link - zero / 80.0, time=time)
    settled = time > independent_joint.START
    error = (found.torque - torque)[settled]
    assert np.sqrt(np.mean(error**2)) < MAX_TORQUE_ERROR * np.std(torque[settled])
    assert np.mean(np.abs(error) < 2.0 * found.sigma[settled]) > MIN_SHARE_WITHIN_TWO_SIGMA
