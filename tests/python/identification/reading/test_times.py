"""Clocks whose truth is known: the time of their rows, and the remarks on it."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st
from numpy.typing import NDArray
from strainwave.identification.reading.times import Clock, clock, regular

untimed = settings(deadline=None, max_examples=60)


def same(count: int) -> NDArray[np.bool_]:
    return np.zeros(count, bool)


@pytest.mark.slow("identification")
@untimed
@given(
    st.integers(50, 3000),
    st.floats(1e-4, 1.0),
    st.floats(-100.0, 1e5),
    st.floats(0.0, 0.08),
    st.sets(st.integers(1, 40), max_size=10),
    st.integers(0, 2**32),
)
def test_a_regular_clock_is_found_under_jitter_and_gaps(
    count: int, step: float, begin: float, jitter: float, lost: set[int], seed: int
) -> None:
    """The regular time is nearer to the truth than the stamps are, and no row is lost."""
    ticks = np.delete(np.arange(count), sorted(lost))
    truth = begin + step * ticks
    stamps = truth + jitter * step * np.random.default_rng(seed).standard_normal(len(ticks))
    found = clock(stamps, same(len(ticks)))
    assert found.rows.tolist() == list(range(len(ticks)))
    assert (np.diff(found.time) > 0.0).all()
    wrong = found.time - truth
    assert np.ptp(wrong) <= np.ptp(stamps - truth) + 1e-9 * abs(begin) + 1e-12
    if lost:
        missing = len(lost) - sum(1 for each in range(count - 1, 0, -1) if set(range(each, count)) <= lost)
        assert any(f"{missing} row" in remark and "missing" in remark for remark in found.remarks) or missing == 0


@untimed
@given(st.integers(20, 500), st.sets(st.integers(1, 400), max_size=20), st.integers(0, 2**32))
def test_repeated_rows_are_left_out(count: int, again: set[int], seed: int) -> None:
    """A row that is written twice bears a stamp near the first, before or after it."""
    random = np.random.default_rng(seed)
    rows = np.sort(np.r_[np.arange(count), [each for each in again if each < count]])
    repeated = np.r_[False, np.diff(rows) == 0]
    stamps = 0.01 * rows + 5e-4 * random.standard_normal(len(rows)).clip(-3.0, 3.0)
    found = clock(stamps, repeated)
    assert len(found.time) == count
    assert found.time == pytest.approx(0.01 * np.arange(count), abs=2e-3)
    assert len(found.remarks) == 1 + bool(repeated.any())


def test_a_row_that_stands_still_is_no_repetition() -> None:
    found = clock(np.arange(100) * 0.01, np.r_[False, np.ones(99, bool)])
    assert len(found.time) == 100
    assert found.remarks == ()


def test_stamps_coarser_than_the_samples_are_those_of_a_regular_clock() -> None:
    truth = np.arange(2000) * 0.4e-3
    found = clock(np.floor(truth * 1e3) * 1e-3, same(2000))
    assert np.diff(found.time) == pytest.approx(0.4e-3, rel=1e-4)
    assert "about a clock of 2500 Hz" in found.remarks[0]


def test_a_clock_that_is_not_regular_keeps_its_stamps() -> None:
    random = np.random.default_rng(3)
    stamps = np.cumsum(random.exponential(0.01, 500))
    found = clock(stamps, same(500))
    assert found.time.tolist() == stamps.tolist()
    assert "its clock is not regular" in found.remarks[0]
    stamps[100] = stamps[98]
    assert len(clock(stamps, same(500)).time) == 499
    assert "1 row does not lie after the row before in time and is left out" in clock(stamps, same(500)).remarks


def test_a_clock_that_begins_anew_holds_several_recordings() -> None:
    stamps = np.r_[np.arange(30), np.arange(100), np.arange(50)] * 0.01
    found = clock(stamps, same(180))
    assert (found.rows[0], found.rows[-1]) == (30, 129)
    assert found.time.tolist() == (np.arange(100) * 0.01).tolist()
    assert found.remarks == (
        "its time begins anew at row 30, 130: 3 recordings in one file, of which the longest is taken, rows 30 to 129",
    )


def test_an_epoch_is_counted_from_the_first_row() -> None:
    found = clock(1.7e9 + np.arange(10) * 0.5, same(10))
    assert found.time.tolist() == (np.arange(10) * 0.5).tolist()
    assert found.remarks == ("its time is counted from its first row",)


def test_what_is_exact_is_kept_bit_by_bit() -> None:
    stamps = 0.1 + np.arange(1000) * 0.001
    assert clock(stamps) == Clock(stamps, np.arange(1000))


def test_a_clock_that_stands_still_is_refused() -> None:
    with pytest.raises(ValueError, match=r"^its time does not run forward: .* --constant rate=NUMBER"):
        clock(np.zeros(10))


@untimed
@given(st.lists(st.floats(-1e300, 1e300), min_size=1, max_size=30))
def test_any_stamps_end_in_times_that_increase_or_are_refused(stamps: list[float]) -> None:
    try:
        found = clock(np.array(stamps), same(len(stamps)))
    except ValueError:
        return
    assert np.isfinite(found.time).all()
    assert (np.diff(found.time) > 0.0).all()
    assert len(found.time) == len(found.rows) <= len(stamps)


@given(st.integers(1, 100), st.floats(0.1, 1e5))
def test_a_rate_alone_gives_the_time(rows: int, rate: float) -> None:
    assert regular(rows, rate).time == pytest.approx(np.arange(rows) / rate)


def test_a_rate_must_be_positive() -> None:
    with pytest.raises(ValueError, match=r"^rate = -1.0 Hz must lie in \(0, inf\)$"):
        regular(10, -1.0)


@pytest.mark.parametrize("samples", [True, False])
def test_an_angle_shows_that_its_samples_or_its_stamps_are_uneven(samples: bool) -> None:
    even = np.arange(0.0, 4.0, 0.002)
    uneven = even + np.random.default_rng(1).uniform(-2e-4, 2e-4, len(even))
    angle = np.round(np.sin(2.0 * (uneven if samples else even)) / 1e-5) * 1e-5
    found = clock(uneven, angle=angle)
    assert found.time == pytest.approx(uneven if samples else even, abs=2e-5)
    assert ("sampled at uneven instants" in found.remarks[0]) == samples
