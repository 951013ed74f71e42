"""Draws the pictures of the README anew, from the demonstration.

Run it as: python docs/pictures/draw.py
"""

from __future__ import annotations

from pathlib import Path

from strainwave.demo import position_drive, torsion_rig
from strainwave.report.identify_figures import overview

(loop,), (table,) = torsion_rig().files[0].pictures, position_drive().files[0].pictures
Path(__file__).with_name("twin.svg").write_text(overview(loop, table), encoding="utf-8")
