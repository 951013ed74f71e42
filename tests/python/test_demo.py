"""The demonstration identifies a gear from document P's Table 2, and states what contradicts it."""

from __future__ import annotations

from strainwave.demo import position_drive
from strainwave.friction import Coulomb


def test_the_demonstration_names_its_reading_of_table_2_which_contradicts_the_others() -> None:
    found = position_drive()
    assert isinstance(found.gear_set.gear.friction_input, Coulomb)
    (check,) = found.failed
    assert "read as all friction" in found.files[0].name
    assert "gear.friction_input.viscous = 0.03084" in check.message
    assert "gear.friction_input.coulomb = 0.01255" in check.message
