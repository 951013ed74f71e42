"""A few of the random drives of tests/stress.py, which runs them by the thousand."""

from __future__ import annotations

import pytest

from tests.stress import outcome


@pytest.mark.parametrize("number", [*range(10), 64311])
def test_a_random_drive_ends_in_numbers_or_with_a_reason_and_is_in_a_pack_what_it_is_alone(number: int) -> None:
    """In 64311 the noise grows with the speed, so that a trial step goes further than an angle has digits."""
    found = outcome(number)
    assert not found.wrong, found.said
