"""One trajectory in double, in a pack and in dual numbers; and its derivatives against differences."""

from __future__ import annotations

import numpy as np
import pytest
import strainwave as sw
from hypothesis import given, settings
from hypothesis import strategies as st
from strainwave import _core
from strainwave.simulation import derivatives

from tests.reference_drive import DRIVE, command

DURATION = 0.1  # s: one reversal of the command, and, with dry friction, some stick-slip events
DT, SAMPLE = 5e-4, 1e-3

dry_input = sw.friction.Stribeck(coulomb=0.03, breakaway=0.045, stribeck_speed=2.0, viscous=5e-5)
dry_output = sw.friction.Coulomb(coulomb=3.0, breakaway=4.0, viscous=0.5)
DRY_INPUT = DRIVE.replace(gear=DRIVE.gear.replace(friction_input=dry_input))
DRY_OUTPUT = DRIVE.replace(gear=DRIVE.gear.replace(friction_output=dry_output))
DRY_BOTH = DRIVE.replace(gear=DRIVE.gear.replace(friction_input=dry_input, friction_output=dry_output))
def runs(name, d, cmd, dt=5e-4, sample=1e-3):
    r = sw.simulate(d, cmd, dt=dt, sample=sample)
    print(name, 'stuck in', (r['input_speed']==0).mean(), 'out', (r['output_speed']==0).mean(), 'changes', np.abs(np.diff((r['input_speed']==0).astype(int))).sum(), np.abs(np.diff((r['output_speed']==0).astype(int))).sum(), len(r))
    return r
