"""How large the samples of tests are: of examples drawn, of trials with noise."""

from __future__ import annotations

from hypothesis import settings


def sample(few: int, whole: int) -> int:
    """Returns the size of a sample: few in the suite, the whole with `dev.py test --hypothesis-profile=explore`."""
    return whole if settings.get_current_profile_name() == "explore" else few
