"""Arms as people record them: what identify holds out is told better than by least squares of a specialist's script."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests import arms

FAST = {"rtde.csv": 20.0, "hand.mat": 20.0, "headerless_all.csv": 30.0}  # `python -m tests.arms` tries all


@pytest.mark.parametrize("sort", [sort for sort in arms.SORTS if sort.name in FAST], ids=lambda sort: sort.name)
def test_the_error_held_out_is_no_worse_than_that_of_least_squares(tmp_path: Path, sort: arms.Sort) -> None:
    ours, simple, with_model = arms.compared(sort, tmp_path, FAST[sort.name])
    print(f"\n{sort.name}: {ours:.2%}, least squares {simple:.2%}, with a model of the arm {with_model:.2%}")
    assert ours < min(simple, with_model)
