"""A joint of another program: measured, identified, and under the firmware that compensates by what was identified."""

from __future__ import annotations

import shutil
from pathlib import Path

import pytest

from tests.evidence import independent_joint
from tests.evidence.rig import measured

pytestmark = pytest.mark.skipif(
    not (independent_joint.RIG / "joint.c").is_file(),
    reason=f"the joint of another program was not found: {independent_joint.RIG} (set STRAINWAVE_RIG)",
)
LOG_SECONDS, LOG_RATE = 15, 500  # s, Hz
MAX_SHARE = 0.1  # of the error of the tuned cascade with constant feed-forward


@pytest.mark.slow("identification")
def test_the_firmware_takes_away_nine_tenths_of_the_error(tmp_path: Path) -> None:
    for name in independent_joint.FILES:
        shutil.copy(measured(3) / name, tmp_path)
    log = (tmp_path / "log_full.csv").read_text().splitlines(keepends=True)
    (tmp_path / "log_full.csv").write_text("".join(log[: 1 + LOG_SECONDS * LOG_RATE]))
    drive = independent_joint.identify(tmp_path)
    before = independent_joint.run(independent_joint.with_constants(drive, "input"), tmp_path, [])
    after = independent_joint.run(independent_joint.with_model(drive, "input"), tmp_path, [])
    assert before.reversals > 50
    for measure in ("rms", "largest", "at_reversals"):
        assert getattr(after, measure) < MAX_SHARE * getattr(before, measure), (measure, before, after)
