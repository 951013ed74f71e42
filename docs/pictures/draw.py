"""Draws the pictures of the README anew, from the demonstration.

Run it as: python docs/pictures/draw.py
"""

from __future__ import annotations

from pathlib import Path

from strainwave.demo import position_drive, torsion_rig
from strainwave.report import figures
from strainwave.report.page import write

write(figures.overview(torsion_rig().evidence[0], position_drive().evidence[0]), Path(__file__).with_name("twin.svg"))
