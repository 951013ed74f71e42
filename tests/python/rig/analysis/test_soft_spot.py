"""A soft spot is found where there is one, and nowhere else."""

from __future__ import annotations

import numpy as np
import pytest
from strainwave.rig import Loop, LoopAnalysis, analyse, words_on_band

from tests.python.rig.loops import PEAK, TABLE, loop_of_table, quarters, refined
from tests.support.samples import sample

LOW, HIGH = 0.1, 0.2


def with_spot(depth: float, points: int = 36, noise: float = 0.0, seed: int = 0) -> Loop:
    """Straight regimes, of 2 and 0.5 N.m/rad; both loadings are `depth` times as soft between 0.1 and 0.2 N.m."""
    soft = 0.5 / depth
    legs = [
        (0.0, 2.0),
        *[(sign * to, k) for sign in (-1.0, 1.0) for to, k in ((LOW, 0.5), (HIGH, soft), (PEAK, 0.5), (0.0, 2.0))],
    ]
    angle, torque = [0.0], [PEAK]
    for to, k in legs[:-1]:
        angle.append(angle[-1] + (to - torque[-1]) / k)
        torque.append(to)
    path, steps = refined(np.array(angle), np.array(torque), PEAK / points)
    path = path + noise * np.random.default_rng(seed).normal(size=len(path))
    return Loop(path, steps, side="input", name="spot", angle_sigma=max(noise, 1e-5))


def words(found: LoopAnalysis) -> list[str]:
    return [words_on_band(each, LOW, HIGH) for each in found.stiffnesses]


def test_a_spot_is_found_where_it_is() -> None:
    found = analyse(with_spot(4.0))
    assert [spot.regime for spot in found.soft_spots] == ["negative_loading", "positive_loading"]
    for spot, (low, high) in zip(found.soft_spots, [(-HIGH, -LOW), (LOW, HIGH)], strict=True):
        assert spot.bounded
        assert (spot.low, spot.high) == (pytest.approx(low, abs=spot.width), pytest.approx(high, abs=spot.width))
        assert spot.at_least > 1.5
    said = words(found)
    assert "no soft spot" in said[0]
    assert ": soft spot, " in said[1]
    assert said[1].startswith("negative loading, -0.1 to -0.2 N.m")


def test_its_depth_is_that_of_the_local_slope_over_the_regression() -> None:
    (spot, _) = analyse(with_spot(4.0)).soft_spots
    found = analyse(with_spot(4.0)).stiffness("negative_loading")
    assert found is not None
    assert spot.multiple == pytest.approx(4.0 / 0.5 * found.regression.value, rel=1e-6)


@pytest.mark.parametrize("position", TABLE)
@pytest.mark.parametrize("step", [0.02, 0.36 / 7])
def test_document_ts_loops_have_none(position: float, step: float) -> None:
    """T speaks of a soft spot at ±(0.1 to 0.2) N.m; its table leaves no room for one beside the soft regime itself."""
    found = analyse(loop_of_table(position, step, angle_sigma=1e-4))
    assert not [spot for spot in found.soft_spots if spot.bounded]
    assert all("no soft spot" in each for each in words(found))


@pytest.mark.slow("rig")
def test_loops_without_a_spot_show_one_in_less_than_one_of_twenty_regimes() -> None:
    trials = sample(40, 100)
    shown = sum(len(analyse(with_spot(1.0, 18, noise=0.01, seed=seed)).soft_spots) for seed in range(trials))
    assert shown <= 4 * trials * 0.05


@pytest.mark.slow("rig")
def test_a_spot_in_noise_is_found_or_left_undecided() -> None:
    found = [analyse(with_spot(4.0, 36, noise=0.004, seed=seed)) for seed in range(sample(10, 20))]
    hits = [any(spot.regime == "negative_loading" for spot in each.soft_spots) for each in found]
    assert np.mean(hits) > 0.8
    loud = analyse(with_spot(2.0, 18, noise=0.05, seed=0))
    assert not loud.soft_spots
    assert any("undecided" in each for each in words(loud))


def test_torques_that_were_not_measured_have_no_soft_spot() -> None:
    found = analyse(with_spot(4.0))
    assert words_on_band(found.stiffnesses[0], 0.5, 0.6).endswith("no point was measured there")


def test_a_band_that_runs_to_the_end_of_its_regime_is_not_bounded() -> None:
    angle, torque = quarters(2.0, 0.5, PEAK, 36)
    n = len(torque)
    loading = (np.arange(n) > n // 4) & (np.arange(n) <= n // 2)  # negative: softer up to 0.1 N.m
    extra = np.where(loading, np.clip(-torque, 0.0, 0.1) / 0.25, 0.0)
    found = analyse(Loop(angle - np.maximum.accumulate(extra), torque, side="input", name="x", angle_sigma=1e-5))
    assert found.soft_spots
    assert [(spot.regime, spot.bounded) for spot in found.soft_spots] == [("negative_loading", False)]
    assert "where the regime ends" in str(found.soft_spots[0])
