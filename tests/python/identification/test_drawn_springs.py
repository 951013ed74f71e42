"""Springs with loops and pairs of logs, drawn at random: a few of those of `python -m tests.evidence.drawn`."""

from __future__ import annotations

import pytest

from tests.evidence.drawn import several_files, spring_and_loop
from tests.support.samples import sample


@pytest.mark.slow("identification")
@pytest.mark.parametrize("seed", [26, 5, 17, 3, 22, 8][: sample(2, 6)])
def test_springs_and_elements_between_encoders_are_those_of_the_joint(seed: int) -> None:
    found = spring_and_loop.outcome(seed)
    assert found.verdict != "wrong", found.message


@pytest.mark.slow("identification")
@pytest.mark.parametrize("seed", range(sample(1, 4)))
def test_one_number_from_two_logs_is_right_or_fails_a_check(seed: int) -> None:
    found = several_files.outcome(seed)
    assert found.verdict == "right", found.message
