"""The demonstration: two gears from published measurements.

The friction table is document P's, the torsion loop is document T's: two different gears of ratio 1:100, and so two results.
No publication known to us measures both on one gear.
"""

from __future__ import annotations

from pathlib import Path

from strainwave.files.recording import Recording
from strainwave.identification.identify import Identified, identify

PUBLISHED = Path(__file__).with_name("published")


def position_drive() -> Identified:
    """Return the gear of document P's drive from its Table 2, read as all friction (E-P7 has its other readings)."""
    title = "document P, Table 2 (measured), read as all friction; see E-P7 for its other readings"
    return identify("position-drive", {"friction": _titled("position-control-friction.csv", title)}, accept=True)


def torsion_rig() -> Identified:
    """Return the gear on document T's rig from its torsion loop."""
    loop = _titled("torsional-stiffness-loop.csv", "document T, Table 2, row 0° (points reconstructed, E-T4)")
    return identify(PUBLISHED / "torsional-stiffness.toml", {"torsion": loop}, accept=True)


def _titled(name: str, title: str) -> Recording:
    """Return a published table with the title by which results name it."""
    read = Recording.read(PUBLISHED / name)
    return Recording({each: read[each] for each in read.names}, read.units, title)
