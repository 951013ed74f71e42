"""The check of the shape of what a model leaves: a small one is a remark, a large one fails."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from strainwave.demo import torsion_rig
from strainwave.identification.checks.shape import MAX_SHARE_OF_SHAPE, NAME, has_small_shape, judged_shape
from strainwave.report.identify import identify_report

from tests.evidence import shapes

ANGLE = np.linspace(0.0, 200.0, 4000)
NOISE = 0.1 * np.random.default_rng(5).normal(size=len(ANGLE))


def judged(size: float):  # type: ignore[no-untyped-def]
    wave = size * np.sqrt(2.0) * np.sin(ANGLE)
    return judged_shape(NOISE + wave, {"the turn": np.mod(ANGLE, 2.0 * np.pi), "the speed": np.cos(ANGLE)}, 1.0, "A", "log.csv")


def test_white_residuals_pass_without_a_remark() -> None:
    (check,), remarks = judged(0.0)
    assert (check.name, check.value, check.failed, remarks) == (NAME, 0.0, False, ())


def test_a_small_shape_is_a_remark_with_its_size() -> None:
    (check,), (remark,) = judged(0.05)
    assert has_small_shape(check)
    assert remark.startswith("the residual has a shape over the turn: RMS ")
    assert remark.endswith(f"{100.0 * check.value:.2g} % of the signal")
    assert check.value == pytest.approx(0.05, abs=0.005)


def test_a_large_shape_fails() -> None:
    (check,), remarks = judged(0.35)
    assert check.failed
    assert check.limit == MAX_SHARE_OF_SHAPE
    assert "over the turn" in check.message
    assert not remarks


def test_few_samples_have_no_check() -> None:
    assert judged_shape(NOISE[:20], {"the speed": ANGLE[:20]}, 1.0, "A", "log.csv", ordered=True) == ((), ())


@pytest.mark.slow("identification")
def test_the_saw_tooth_of_the_torsion_article_stands_in_the_verdict() -> None:
    found = torsion_rig()
    (check,) = (each for each in found.checks if each.name == NAME)
    assert not check.failed
    assert check.value == pytest.approx(0.82, abs=0.05)  # N.m
    page = identify_report(found)
    assert "all 5 checks passed; the residual has a shape of RMS 0.824 N·m." in page.replace("\N{NO-BREAK SPACE}", " ")


@pytest.mark.slow("identification")
@pytest.mark.parametrize("draw", [shapes.table, shapes.loop, shapes.log])
def test_right_records_with_white_noise_have_no_shape(draw: Callable[[np.random.Generator], shapes.Drawn]) -> None:
    """A few of `python -m tests.evidence.shapes`, which draws 200 of each."""
    assert shapes.named(draw, 3) == (3, 0, 0)
