"""Onsets: shares in closed form, and what each must obey."""

from __future__ import annotations

import numpy as np
import pytest
import strainwave as sw
from hypothesis import given, strategies as st
from strainwave import _core
from strainwave.dataset.faults import grown

USES = st.floats(0.0, 1e9)
laws = st.one_of(
    st.just(sw.onset.Constant()),
    st.builds(sw.onset.Step, at=USES),
    st.builds(sw.onset.Growing, begin=USES, scale=st.floats(1.0, 1e9), exponent=st.floats(0.1, 10.0)),
)


def test_every_onset_is_drawn_here() -> None:
    assert set(_core.fault_families["onset"]) == {"constant", "step", "growing"}


@given(laws, st.lists(USES, min_size=1, max_size=8))
def test_a_share_lies_between_0_and_1_and_never_falls(law: object, uses: list[float]) -> None:
    shares = law.share(sorted(uses))  # type: ignore[attr-defined]
    assert ((shares >= 0.0) & (shares <= 1.0)).all()
    assert (np.diff(shares) >= -1e-12).all()


@given(st.floats(1e-3, 1.0), st.floats(0.1, 10.0))
def test_growth_is_a_power_of_the_use(share: float, exponent: float) -> None:
    law = sw.onset.Growing(begin=50.0, scale=200.0, exponent=exponent)
    assert law.share(50.0 + 200.0 * share) == pytest.approx(share**exponent, rel=1e-9, abs=1e-12)
    assert law.share(49.0) == 0.0
    assert law.share(251.0) == 1.0


def test_a_step_is_there_from_its_use_on() -> None:
    assert list(sw.onset.Step(at=10.0).share([9.999, 10.0])) == [0.0, 1.0]


def test_a_fault_grows_with_the_use() -> None:
    fault = sw.fault.LinkagePlay(severity=0.8)
    assert grown(fault, sw.onset.Growing(scale=4.0, exponent=2.0), 2.0).severity == pytest.approx(0.2, rel=1e-12)
    assert grown(fault, sw.onset.Constant(), 0.0) == fault
