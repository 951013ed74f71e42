"""The reference drive of the benchmarks: a position-controlled joint with every nonlinearity of a strain wave gear.

Besides, the same without hysteresis and with friction that is smooth, or that can stick.

Its numbers stand in benchmarks/reference_drive.py, whose folder is looked in wherever a test runs: processes of their own, too.
"""

import sys
from pathlib import Path

sys.path.append(str(Path(__file__).resolve().parents[2] / "benchmarks"))

import five_drives
import strainwave as sw
from peers.strainwave_drive import command, drive

DRIVE = drive()
NO_HYSTERESIS = sw.hysteresis.MaxwellSlip(stiffness=[], breakaway=[])
SMOOTH = DRIVE.replace(gear=DRIVE.gear.replace(hysteresis=NO_HYSTERESIS, friction_input=sw.friction.Viscous(viscous=1e-4)))
STICKING = SMOOTH.replace(gear=SMOOTH.gear.replace(friction_input=sw.friction.Coulomb(coulomb=0.03, breakaway=0.045)))

__all__ = ["DRIVE", "SMOOTH", "STICKING", "command", "five_drives"]
