"""The reference drive of the benchmarks: a position-controlled joint with every nonlinearity of a strain wave gear.

Its numbers stand in benchmarks/reference_drive.py, whose folder is looked in wherever a test runs: processes of their own, too.
"""

import sys
from pathlib import Path

sys.path.append(str(Path(__file__).resolve().parent.parent / "benchmarks"))

from peers.strainwave_drive import command, drive

DRIVE = drive()

__all__ = ["DRIVE", "command"]
