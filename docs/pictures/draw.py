"""Draws the pictures of the README anew, from the demonstration.

Run it as: python docs/pictures/draw.py
"""

from __future__ import annotations

from pathlib import Path

from strainwave.demo import published_twin
from strainwave.report import figures
from strainwave.report.page import write

write(figures.overview(published_twin()), Path(__file__).with_name("twin.svg"))
