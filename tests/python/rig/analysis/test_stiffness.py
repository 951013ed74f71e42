"""Stiffness by every definition, document T's table among them, and how often the intervals hold the truth."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from strainwave.rig import Loop, LoopAnalysis, Result, analyse, closure_of_secants, soft_parts, table, words_on_band
from strainwave.rig.analysis.analysis import DEFINITIONS
from strainwave.rig.analysis.lines import fit_segments
from strainwave.rig.analysis.regimes import NAMES

from tests.python.rig.loops import PEAK, TABLE, loop_of_table, quarters, refined, vertices
from tests.support.samples import sample

HALF_A_DIGIT = 0.005  # N.m/rad: what document T's table leaves open
LOW, HIGH = 0.1, 0.2


@pytest.mark.parametrize("position", TABLE)
@pytest.mark.parametrize("step", [0.02, 0.36 / 7])
def test_the_softest_stretches_are_document_ts_row(position: float, step: float) -> None:
    """Also from points as far apart as the rig's masses, seven steps to the peak."""
    (row,) = table([analyse(loop_of_table(position, step, angle_sigma=1e-4))])
    for name, stated in zip(NAMES, TABLE[position][:4], strict=True):
        assert getattr(row, name).value == pytest.approx(stated, abs=HALF_A_DIGIT)
    assert row.hysteresis is not None
    assert np.degrees(row.hysteresis.value) == pytest.approx(TABLE[position][4], abs=0.1)
    assert row.position == pytest.approx(np.radians(position))


def test_the_other_definitions_do_not_give_document_ts_loading_rows() -> None:
    """Over the quarter: the secant from the corners of the loop, and the line through all points between the two."""
    found = analyse(loop_of_table())
    loading = found.stiffness("negative_loading")
    assert loading is not None
    assert loading.secant is not None
    assert loading.secant.value == pytest.approx(0.36 / np.radians(59.326382 - 4.573499), rel=1e-6)  # 0.3767
    assert 0.31 < loading.regression.value < loading.secant.value
    assert loading.share == pytest.approx((0.321719 - 0.03) / 0.36, rel=1e-5)  # .29 of .36 N.m
    assert [end.value for end in loading.stretch] == pytest.approx([-0.321719, -0.03], abs=1e-6)
    assert any("is not one straight line" in remark for remark in found.remarks)


@pytest.mark.parametrize("name", ["positive_unloading", "negative_unloading"])
def test_where_a_regime_is_one_line_all_definitions_agree(name: str) -> None:
    found = analyse(loop_of_table(angle_sigma=1e-4)).stiffness(name)  # type: ignore[arg-type]
    assert found is not None
    assert found.secant is not None
    assert found.whole
    assert found.secant.value == pytest.approx(found.regression.value, rel=1e-9)
    assert found.secant.value == pytest.approx(found.softest.value, rel=1e-9)


def test_document_ts_rows_read_as_secants_do_not_close() -> None:
    gaps = [float(np.degrees(closure_of_secants(row[:4], PEAK))) for row in TABLE.values()]
    assert gaps == pytest.approx([1.90, -7.61, -2.82], abs=0.005)
    parts = np.array([soft_parts(row[:4], float(np.radians(row[4])), PEAK) for row in TABLE.values()])
    assert parts == pytest.approx(np.array([[0.292, 0.283], [0.286, 0.323], [0.294, 0.309]]), abs=5e-4)  # erratum E-T4


def test_secants_of_a_closed_loop_close() -> None:
    found = analyse(Loop(*vertices(TABLE[60.0]), side="input", name="corners"))
    secants = [each.secant.value for each in found.stiffnesses if each.secant is not None]
    assert closure_of_secants(secants, PEAK) == pytest.approx(0.0, abs=1e-9)


@pytest.mark.parametrize("wrong", [[4.51, 0.31, 4.85], [4.51, 0.31, 4.85, 0.0], [[4.51, 0.31], [4.85, 0.30]]])
def test_four_positive_stiffnesses_make_a_cycle(wrong: list[float]) -> None:
    with pytest.raises(ValueError, match="must be four positive numbers"):
        closure_of_secants(wrong, PEAK)


def test_knees_are_found_where_they_are() -> None:
    torque = np.linspace(0.0, 1.0, 41)
    angle = torque / 5.0 + np.maximum(torque - 0.33, 0.0) * 3.0 - np.maximum(torque - 0.81, 0.0) * 2.5
    found = fit_segments(torque, angle, np.full(41, 1e-3), np.zeros(41))
    assert found.knees == pytest.approx([0.33, 0.81], abs=1e-9)
    assert found.compliances == pytest.approx([0.2, 3.2, 0.7], abs=1e-9)
    assert found.stretch(found.softest) == pytest.approx((0.33, 0.81))


def test_a_knee_beside_two_points_lies_anywhere_between_its_neighbours() -> None:
    torque = np.array([0.0, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6])
    angle = 3.0 * np.maximum(torque - 0.04, 0.0)
    found = fit_segments(torque, angle, np.full(7, 1e-4), np.zeros(7))
    if len(found.knees):
        (knee,) = found.knee_results
        assert knee.low <= 0.04 <= knee.high or knee.low <= 0.1 <= knee.high
    assert found.compliances[found.softest] == pytest.approx(3.0, rel=1e-3)


def test_a_knee_that_one_point_tells_is_found_beside_a_sharp_one_between_two_points() -> None:
    """The first point, at 0.029 N.m, lies on the stiff stretch, which ends at 0.03: it must not bend the soft one."""
    torque = np.arange(0.029, 0.36, 0.03)
    angle = torque / 4.85 + np.maximum(torque - 0.03, 0.0) * 3.0 - np.maximum(torque - 0.3221, 0.0) * 3.0
    found = fit_segments(torque, angle, np.full(12, 1e-4), np.zeros(12))
    assert len(found.knees) == 2
    assert found.compliances[found.softest] == pytest.approx(1.0 / 4.85 + 3.0, rel=1e-9)


@pytest.mark.slow("rig")
def test_noise_alone_makes_no_knees() -> None:
    torque = np.linspace(0.0, 1.0, 15)
    random = np.random.default_rng(3)
    knees = [
        len(fit_segments(torque, torque + 0.01 * random.normal(size=15), np.full(15, 0.01), np.zeros(15)).knees)
        for _ in range(200)
    ]
    assert np.mean(np.array(knees) > 0) < 0.05


STIFF = dict(zip(NAMES, (2.0, 0.5, 2.0, 0.5), strict=True))
WIDTH = PEAK / 0.5 - PEAK / 2.0
SPREAD = {"angle_sigma": 2e-3, "torque_sigma": 1e-3}
SHARED = {"angle_scale": 0.01, "torque_scale": 0.02}


def measured(random: np.random.Generator, angle: np.ndarray, torque: np.ndarray) -> LoopAnalysis:
    """A loop as a rig with these errors reads it."""
    read = angle + SPREAD["angle_sigma"] * random.normal(size=len(angle))
    read *= 1.0 + SHARED["angle_scale"] * random.normal()
    laid = torque + SPREAD["torque_sigma"] * random.normal(size=len(torque))
    laid *= 1.0 + SHARED["torque_scale"] * random.normal()
    return analyse(Loop(read, laid, side="input", name="noisy", **SPREAD, **SHARED))  # type: ignore[arg-type]


def coverage(found: list[Result], truth: float) -> float:
    return float(np.mean([each.low <= truth <= each.high for each in found]))


def limits(trials: int) -> tuple[float, float]:
    """Three standard deviations of a share of 95 % about it; intervals so wide that all trials hold the truth are beyond."""
    margin = 3.0 * np.sqrt(0.95 * 0.05 / trials)
    return 0.95 - margin, min(0.95 + margin, 1.0)


@pytest.mark.slow("rig")
def test_intervals_of_a_plain_loop_hold_the_truth_in_95_of_100() -> None:
    """Loops of straight regimes; shared errors of 2.2 % among theirs."""
    random = np.random.default_rng(7)
    angle, torque = quarters(2.0, 0.5, PEAK, 7)
    found = [measured(random, angle, torque) for _ in range(sample(100, 300))]
    low, high = limits(len(found))
    for name in NAMES:
        for definition in DEFINITIONS:
            results = [result for each in found if (result := each.stiffness_by(name, definition)) is not None]
            assert low < coverage(results, STIFF[name]) < high, (name, definition)
    widths = [each.width_at_zero for each in found if each.width_at_zero is not None]
    areas = [each.area for each in found if each.area is not None]
    assert low < coverage(widths, WIDTH) < high
    assert low < coverage(areas, WIDTH * PEAK) < high
    closures = [each.closure for each in found if each.closure is not None]
    assert coverage(closures, 0.0) > low


@pytest.mark.slow("rig")
def test_intervals_of_document_ts_loop_hold_the_truth_in_95_of_100() -> None:
    """The softest stretch and its knees, of regimes that are not one line."""
    random = np.random.default_rng(8)
    angle, torque = refined(*vertices(TABLE[0.0]), 0.02)
    found = [measured(random, angle, torque) for _ in range(sample(60, 120))]
    low, high = limits(len(found))
    soft = [each.stiffness("negative_loading") for each in found]
    assert low < coverage([each.softest for each in soft if each is not None], 0.31) < high
    knees = [each.stretch[0] for each in soft if each is not None and len(each.segments.knees) == 2]
    assert len(knees) > 0.95 * len(found)
    assert coverage(knees, -0.321719) > low


@pytest.mark.slow("rig")
def test_scatter_stands_in_for_errors_that_are_not_stated() -> None:
    random = np.random.default_rng(9)
    angle, torque = quarters(2.0, 0.5, PEAK, 7)
    found = [
        analyse(Loop(angle + 2e-3 * random.normal(size=len(angle)), torque, side="input", name="noisy"))
        for _ in range(sample(60, 120))
    ]
    low, high = limits(len(found))
    assert not any(each.errors_stated for each in found)
    results = [result for each in found if (result := each.stiffness_by("negative_loading", "regression")) is not None]
    assert low < coverage(results, 0.5) < high
    widths = [each.width_at_zero for each in found if each.width_at_zero is not None]
    assert low < coverage(widths, WIDTH) < high


def test_errors_of_the_rig_are_shared_by_all_stiffnesses() -> None:
    angle, torque = quarters(2.0, 0.5, PEAK, 7)
    shared = {"angle_scale": 0.003, "torque_scale": 0.004, "compliance_sigma": 0.02}
    found = analyse(Loop(angle, torque, side="input", name="exact", angle_sigma=1e-9, **shared))  # type: ignore[arg-type]
    for name in NAMES:
        for definition in DEFINITIONS:
            result = found.stiffness_by(name, definition)
            assert result is not None
            assert result.shared == pytest.approx(STIFF[name] * np.hypot(0.005, STIFF[name] * 0.02), rel=1e-6)


def with_friction(angle: np.ndarray, torque: np.ndarray, error: float) -> Loop:
    """A loop from +peak over -peak back as read where the pulleys' friction is wrong: each point by how it was reached."""
    turn = int(np.argmin(torque))
    forward = np.arange(len(torque)) > turn
    forward[0] = True
    read = torque + np.where(forward, error, -error)
    return Loop(angle, read, side="input", name="pulleys", angle_sigma=1e-5, friction_sigma=abs(error))


@pytest.mark.parametrize(
    "polygon", [quarters(2.0, 0.5, PEAK, 7), refined(*vertices(TABLE[60.0]), 0.02)], ids=["straight", "document T"]
)
def test_a_secant_errs_by_the_friction_of_the_pulleys_as_stated(polygon: tuple[np.ndarray, np.ndarray]) -> None:
    """To first order: the peak of unloading was reached the other way than the rest, so the errors of both ends add up."""
    small = 1e-6
    right, wrong = (analyse(with_friction(*polygon, error)) for error in (0.0, small))
    for one, other in zip(right.stiffnesses, wrong.stiffnesses, strict=True):
        assert one.secant is not None
        assert other.secant is not None
        error = abs(1.0 / other.secant.value - 1.0 / one.secant.value)
        assert other.secant.shared / other.secant.value**2 == pytest.approx(error, rel=1e-3, abs=1e-10)


@pytest.mark.slow("rig")
def test_lines_of_unloading_do_not_lean_on_the_peak_that_was_reached_the_other_way() -> None:
    random = np.random.default_rng(10)
    angle, torque = quarters(2.0, 0.5, PEAK, 7)
    found = []
    for _ in range(sample(60, 150)):
        read = with_friction(angle + 1e-5 * random.normal(size=len(angle)), torque, 1e-3 * random.normal())
        found.append(analyse(replace(read, friction_sigma=1e-3)))
    for definition in DEFINITIONS:
        results = [result for each in found if (result := each.stiffness_by("positive_unloading", definition)) is not None]
        assert len(results) == len(found)
        assert coverage(results, 2.0) > limits(len(found))[0], definition


@pytest.mark.slow("rig")
def test_the_soft_stretch_is_found_wherever_the_points_lie_between_its_knees() -> None:
    """Knees at 0.03 and between 0.30 and 0.34 N.m, points every 0.03: some lie nearer to a knee than a stretch may be short."""
    random, stiff, soft = np.random.default_rng(0), 1.0 / 4.68, 1.0 / 0.31
    deviations = []
    for _ in range(100):
        torque = np.arange(random.uniform(0.002, 0.0299), 0.361, 0.03)
        angle = torque * stiff + (np.maximum(torque - 0.03, 0.0) - np.maximum(torque - random.uniform(0.30, 0.34), 0.0)) * (
            soft - stiff
        )
        found = fit_segments(torque, angle + 3e-5 * random.normal(size=len(torque)), np.full(len(torque), 3e-5), 0.0 * torque)
        error = found.compliances[found.softest] - soft
        assert abs(error) < 1e-3 * soft
        deviations.append(error / found.compliance_sigmas[found.softest])
    assert 0.85 < np.mean(np.abs(deviations) < 2.0) < 1.0


def test_a_stretch_that_misses_points_by_more_than_their_errors_errs_by_more() -> None:
    """Three points cannot tell a knee: the sigma of the slope is the scatter over the root of the sum of squares, 1/2."""
    torque, off = np.array([0.0, 0.5, 1.0]), 1e-2
    found = fit_segments(torque, torque + off * np.array([1.0, -2.0, 1.0]), np.full(3, 1e-4), np.zeros(3))
    assert found.compliance_sigmas[0] == pytest.approx(off * np.sqrt(6.0) / np.sqrt(0.5), rel=1e-9)


def test_the_local_stiffness_follows_the_slopes() -> None:
    found = analyse(loop_of_table(step=0.004, angle_sigma=1e-5)).stiffness("negative_loading")
    assert found is not None
    local = found.local
    inside = (local.torque > -0.29) & (local.torque < -0.06)
    assert local.stiffness[inside] == pytest.approx(0.31, rel=1e-9)
    assert local.stiffness[-1] == pytest.approx(0.5 * (4.51 + 4.85), rel=1e-9)
    assert np.all(local.low <= local.stiffness)
    assert np.all(local.stiffness <= local.high)
    assert np.all(np.diff(local.torque) > 0.0)


def test_a_level_quarter_has_no_stiffness_to_divide_by() -> None:
    loop = Loop([1.0, 1.0, 1.0, 0.0, -1.0, -1.0, -1.0, 0.0, 1.0], [1, 0.5, 0, 0, -1, -0.5, 0, 0, 1], side="output", name="play")
    found = analyse(loop)
    unloading = found.stiffness("positive_unloading")
    assert unloading is None or unloading.secant is None or unloading.secant.value > 0.0


def test_loading_as_stiff_as_unloading_has_no_softer_part() -> None:
    with pytest.raises(ValueError, match=r"loading of 4 and 5 N\.m/rad must be softer than unloading, 5 N\.m/rad in the mean"):
        soft_parts([5.0, 4.0, 5.0, 5.0], 0.1, 0.36)


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
