"""Wrong assumptions about an independent joint fail a check, right ones none; all: `python -m tests.evidence.assumptions`."""

from __future__ import annotations

import shutil
from collections.abc import Mapping
from pathlib import Path

import pytest

from tests.evidence import assumptions
from tests.evidence.rig import RIG
from tests.support.thinned import thin

pytestmark = pytest.mark.skipif(
    not (RIG / "measure.py").is_file() or shutil.which("cc") is None,
    reason=f"no independent joint: {RIG} (set STRAINWAVE_RIG), or no cc",
)
SLOW = ("log_full", "two_loads", "all files")  # both encoders: the gear between them is fitted, too
Seed = tuple[Path, Mapping[str, float]]


def is_fast(case: assumptions.Case) -> bool:
    return not any(word in name for word in SLOW for name in (*case.files, case.name))


@pytest.fixture(scope="module")
def seed(tmp_path_factory: pytest.TempPathFactory) -> Seed:
    folder = tmp_path_factory.mktemp("joint")
    truth = assumptions.made(folder, 3)
    return thin(folder, every=3), truth


@pytest.mark.slow("identification")
@pytest.mark.parametrize("case", [*filter(is_fast, assumptions.wrong())], ids=lambda case: f"{case.kind}, {case.name}")
def test_a_wrong_assumption_fails_a_check(seed: Seed, case: assumptions.Case) -> None:
    assert assumptions.verdict(case, *seed).failed


@pytest.mark.slow("identification")
@pytest.mark.parametrize("case", [*filter(is_fast, assumptions.right())], ids=lambda case: case.name)
def test_a_right_assumption_fails_none(seed: Seed, case: assumptions.Case) -> None:
    found = assumptions.verdict(case, *seed)
    assert found.failed == (), found.message
