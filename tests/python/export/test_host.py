"""Internal steps of exports: too coarse ones are refused, and the step that the message states is taken."""

from __future__ import annotations

import pytest
import strainwave as sw
from strainwave.export.host import internal_step

STIFF = sw.friction.LuGre(
    coulomb=0.05, breakaway=0.07, stribeck_speed=2.0, bristle_stiffness=5e3, bristle_damping=5e-3, viscous=4e-4
)


@pytest.mark.parametrize("name", ["robot-joint", "tilt-actuator", "position-drive"])
@pytest.mark.parametrize("is_stiff", [False, True])
def test_the_step_that_a_refusal_states_is_taken(name: str, is_stiff: bool) -> None:
    drive = sw.GearSet.read(name).drive
    if is_stiff:
        drive = drive.replace(gear=drive.gear.replace(friction_input=STIFF))
    with pytest.raises(ValueError, match=r"step = 0\.1 s is too coarse") as caught:
        internal_step(drive, 0.1)
    assert ("bristles" in str(caught.value)) == is_stiff
    stated = float(str(caught.value).split()[-4])
    assert internal_step(drive, stated) == stated
    with pytest.raises(ValueError, match="is too coarse"):
        internal_step(drive, 1.2 * stated)
