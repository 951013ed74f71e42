"""The reference drive of the benchmarks: a position-controlled joint with every nonlinearity of a strain wave gear.

Its numbers stand in benchmarks/reference_drive.py; pytest finds that folder, see pyproject.toml.
"""

from peers.strainwave_drive import command, drive

DRIVE = drive()

__all__ = ["DRIVE", "command"]
