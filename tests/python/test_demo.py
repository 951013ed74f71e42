"""The demonstration shows each reading of document P's Table 2."""

from __future__ import annotations

import pytest
from strainwave.demo import LABELS, experiments, position_drive, table_2
from strainwave.friction import Coulomb


def test_the_experiments_run_with_each_reading_of_table_2_and_state_what_it_contradicts() -> None:
    """Errata E-P6 and E-P7: dry friction 0.0126 or 0.0720 + 0.0126 N.m, slope 0.0308 or 3.08e-4 N.m.s/rad."""
    found = position_drive()
    total, part, at_output = table_2(found)
    assert (total.part, part.part, at_output.part) == (False, True, True)
    assert at_output.viscous.value == pytest.approx(3.08404e-4, rel=1e-5)
    shown = experiments(found)
    for each in shown:
        assert [label for label, _ in each.runs] == [*LABELS, "document P's drive, r = 1/100"]
        assert len(set(each.figures[0].values)) == 4, "no two of the runs are the same"
    assert "0.0492 N·m that the law has at every angle" in shown[0].remark
    assert "0.771 times the law's 0.0004" in shown[0].remark


def test_the_demonstration_names_its_reading_of_table_2_which_contradicts_the_others() -> None:
    found = position_drive()
    assert isinstance(found.gear_set.gear.friction_input, Coulomb)
    (check,) = found.failed
    assert "read as all friction" in found.files[0].name
    assert "gear.friction_input.viscous = 0.03084" in check.message
    assert "gear.friction_input.coulomb = 0.01255" in check.message
