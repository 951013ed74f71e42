"""Whether positions or units differ: against SciPy's tests, and how often chance is taken for a difference."""

from __future__ import annotations

import numpy as np
import pytest
from scipy import stats
from strainwave.rig import Loop, LoopAnalysis, analyse, compare
from strainwave.rig.analysis.comparison import by_chi_square, by_welch

from tests.python.rig.loops import PEAK, TABLE, loop_of_table, quarters
from tests.support.samples import sample


def test_welch_of_two_groups_is_welchs_t_test() -> None:
    random = np.random.default_rng(1)
    one, other = random.normal(size=5), 0.8 + 2.0 * random.normal(size=9)
    assert by_welch([one, other]) == pytest.approx(stats.ttest_ind(one, other, equal_var=False).pvalue)


def test_welch_of_equal_groups_is_near_the_usual_analysis_of_variance() -> None:
    random = np.random.default_rng(2)
    groups = [random.normal(size=400) + shift for shift in (0.0, 0.1, 0.15)]
    assert by_welch(groups) == pytest.approx(stats.f_oneway(*groups).pvalue, rel=0.1)


def test_chi_square_of_two_is_the_normal_difference() -> None:
    p = by_chi_square(np.array([1.0, 2.0]), np.array([0.3, 0.4]))
    assert p == pytest.approx(2.0 * stats.norm.sf(1.0 / 0.5))
    assert np.isnan(by_chi_square(np.array([1.0, 2.0]), np.array([0.3, 0.0])))


def test_what_was_not_repeated_has_no_scatter() -> None:
    assert np.isnan(by_welch([np.array([1.0]), np.array([2.0, 3.0])]))


def noisy(seed: int, unloading: float = 2.0, **more: object) -> LoopAnalysis:
    angle, torque = quarters(unloading, 0.5, PEAK, 7)
    angle = angle + 2e-3 * np.random.default_rng(seed).normal(size=len(angle))
    return analyse(Loop(angle, torque, side="input", name="noisy", angle_sigma=2e-3, torque_scale=0.05, **more))  # type: ignore[arg-type]


@pytest.mark.slow("rig")
def test_loops_of_one_gear_seldom_differ() -> None:
    """Nine loops in groups of three, whose shared error of 5 % must not hide anything nor count."""
    shown = 0
    for seed in range(0, 9 * sample(10, 20), 9):
        loops = [noisy(seed + i, position=float(i % 3)) for i in range(9)]
        shown += any(each.significant for each in compare(loops, definition="regression").quantities)
    assert shown <= sample(2, 3)  # 5 % of the tables, and two standard deviations more


def test_a_unit_that_is_stiffer_is_told() -> None:
    loops = [noisy(i, unloading=2.0 if i < 3 else 2.4, unit="A" if i < 3 else "B") for i in range(6)]
    found = {each.name: each for each in compare(loops, by="unit", definition="regression").quantities}
    stiff = found["positive unloading stiffness"]
    assert stiff.groups == ("A", "B")
    assert stiff.counts == (3, 3)
    assert stiff.means == (pytest.approx(2.0, rel=0.05), pytest.approx(2.4, rel=0.05))
    assert stiff.significant
    assert stiff.spread == pytest.approx(np.std(stiff.means, ddof=1))
    assert "they differ" in str(stiff)
    assert not found["negative loading stiffness"].significant
    assert "no difference is shown" in str(found["negative loading stiffness"])


def test_single_loops_are_compared_by_their_stated_errors() -> None:
    loops = [noisy(0, 2.0, position=0.0), noisy(1, 2.6, position=1.0)]
    found = compare(loops, definition="regression")
    assert found.quantities[0].significant
    assert np.isnan(found.quantities[0].by_repeats)
    assert found.remarks == (
        "one specimen: the comparison does not show how far units of this design differ",
        "no position was tested twice: what differs may be what mounting and testing it again would change",
    )


def test_document_ts_positions_spread_by_a_factor() -> None:
    """Its high stiffnesses run from 3.59 to 5.08 N.m/rad (erratum E-T9)."""
    loops = [analyse(loop_of_table(position)) for position in TABLE]
    high = next(each for each in compare(loops).quantities if each.name == "negative unloading stiffness")
    assert max(high.means) / min(high.means) == pytest.approx(1.415, abs=1e-3)
    assert high.relative == pytest.approx(np.std([4.85, 3.59, 5.08], ddof=1) / np.mean([4.85, 3.59, 5.08]), rel=1e-3)


def test_whether_loops_differ_is_not_known_where_nothing_tells_their_errors() -> None:
    torque = [PEAK, 0.0, -PEAK, 0.0, PEAK]
    corners = {a: np.array([0.0, -a, -1.0, a - 1.0, 0.0]) for a in (0.1, 0.2)}
    loops = [analyse(Loop(each, torque, side="input", name="corners", position=a)) for a, each in corners.items()]
    high = compare(loops).quantities[0]
    assert high.significant is None
    assert "so whether they differ is not known" in str(high)


def test_mixtures_are_told() -> None:
    loops = [noisy(i, position=float(i % 2), unit="AB"[i // 2]) for i in range(4)]
    assert "loops of 2 units are mixed" in compare(loops).remarks[0]
    assert "loops of 2 positions are mixed" in compare(loops, by="unit").remarks[0]


def test_what_cannot_be_compared_is_refused() -> None:
    one = noisy(0)
    with pytest.raises(ValueError, match=r"2 loops of one position \(0°\) cannot be compared by position"):
        compare([one, one])
    with pytest.raises(ValueError, match=r'by = "colour" must be one of position, unit'):
        compare([one, one], by="colour")  # type: ignore[arg-type]
    loop = loop_of_table()
    other = analyse(Loop(loop.angle, loop.torque, side="output", name="output", position=1.0))
    with pytest.raises(ValueError, match="refer them to one side first"):
        compare([one, other])


def test_a_comparison_in_words_has_degrees_and_no_probability_of_zero() -> None:
    loops = [analyse(loop_of_table(position, angle_sigma=1e-5)) for position in TABLE]
    words = {each.name: str(each) for each in compare(loops).quantities}
    assert words["width at zero torque"].startswith("width at zero torque: 49.40 to 51.90 degrees, spread")
    assert not any("errors 0)" in each for each in words.values())
