"""The content of the catalogue's sets, and what the maker publishes of these gears, typed from his documents.

How a set is made of its content has its own tests.
"""

from __future__ import annotations

import os
from math import pi, radians
from pathlib import Path
from typing import Any

import pytest
from strainwave.files import harmonic_drive

from tests.support.each import each

ROOT = Path(__file__).resolve().parents[3]
TRANSCRIPTIONS = Path(os.environ.get("STRAINWAVE_DATA", ROOT.parent / "shared" / "data")) / "catalogue"
SETS: dict[str, dict[str, Any]] = {name: harmonic_drive.document(name) for name in sorted(harmonic_drive.gears())}
ARCMIN = radians(1.0 / 60.0)
EXACT = 1e-15  # decimal prefixes
ROUNDING = 5e-4  # assumed figures carry four significant digits
ROUNDING_K1 = 5e-6  # the spring's first slope carries six, so that the catalogue's K1 follows from it


def identity(name: str) -> tuple[str, int, int]:
    """Series, size and ratio that a file name stands for."""
    series, size, ratio = name.split("-")
    return series.upper(), int(size), int(ratio)


def figures(name: str, table: str, *keys: str) -> tuple[Any, ...]:
    return tuple(SETS[name][table][key]["value"] for key in keys)


def column(name: str) -> str:
    """Ratio, as the maker's tables group it."""
    ratio = identity(name)[2]
    return str(ratio) if ratio <= 50 else "> 50"


RATED = [name for name in SETS if "rated_torque" in SETS[name].get("ratings", {})]
every_set = each("name", SETS)
every_rated_set = each("name", RATED)
with_transcriptions = pytest.mark.skipif(
    not TRANSCRIPTIONS.is_dir(), reason=f"no catalogue transcriptions in {TRANSCRIPTIONS} (set STRAINWAVE_DATA)"
)

# --- the maker's tables, typed from his documents ---

# Harmonic Drive AG, engineering data CHA 1018854 (CHA, HFUC, CSG): T1, T2 in N.m; K1, K2, K3 in 1000 N.m/rad.
KNEES = {
    14: (2, 6.9), 17: (3.9, 12), 20: (7, 25), 25: (14, 48),
    32: (29, 108), 40: (54, 196), 50: (108, 382), 58: (168, 598),
}  # fmt: skip
SLOPES = {
    "30": {14: (1.9, 2.4, 3.4), 17: (3.4, 4.4, 6.7), 20: (5.7, 7.1, 11), 25: (10, 13, 21), 32: (24, 30, 49)},
    "50": {
        14: (3.4, 4.7, 5.7), 17: (8.1, 11, 13), 20: (13, 18, 23), 25: (25, 34, 44),
        32: (54, 78, 98), 40: (100, 140, 180), 50: (200, 280, 340), 58: (310, 440, 540),
    },
    "> 50": {
        14: (4.7, 6.1, 7.1), 17: (10, 14, 16), 20: (16, 25, 29), 25: (31, 50, 57),
        32: (67, 110, 120), 40: (130, 200, 230), 50: (250, 400, 440), 58: (400, 610, 710),
    },
}  # fmt: skip
# The same document, bounds in arcmin; 45 stands for itself between two sizes that share one bound.
ACCURACY = {
    "30": {14: 2.0, 17: 2.0, 20: 1.5, 25: 1.5, 32: 1.5},
    "50": {14: 1.2, 17: 1.2, 20: 1.0, 25: 1.0, 32: 1.0, 40: 0.7, 45: 0.7, 50: 0.7, 58: 0.7},
    "> 50": {14: 1.0, 17: 1.0, 20: 0.8, 25: 0.8, 32: 0.8, 40: 0.5, 45: 0.5, 50: 0.5, 58: 0.5},
}
HYSTERESIS_LOSS, LOST_MOTION = {"30": 3.0, "50": 1.0, "> 50": 1.0}, 1.0
# Harmonic Drive AG: rated, average, repeated peak, momentary peak torque at ratio 100; inertia in 1e-4 kg m2.
CSG_100 = {
    14: (10, 14, 36, 58), 17: (31, 51, 70, 109), 20: (52, 64, 107, 191), 25: (87, 140, 204, 369),
    32: (178, 281, 433, 841), 40: (345, 484, 738, 1400), 50: (611, 866, 1274, 2678), 58: (905, 1378, 2067, 4134),
}  # fmt: skip
INERTIA = {14: 0.033, 17: 0.079, 20: 0.193, 25: 0.413, 32: 1.69, 40: 4.50, 50: 12.5, 58: 27.3}
# Harmonic Drive LLC, rating table of SHG-LW: rated torque at the ratios each size has.
SHG_RATED = {
    14: {50: 7, 80: 10, 100: 10}, 17: {50: 21, 80: 29, 100: 31, 120: 31},
    20: {50: 33, 80: 44, 100: 52, 120: 52, 160: 52}, 25: {50: 51, 80: 82, 100: 87, 120: 87, 160: 87},
    32: {50: 99, 80: 153, 100: 178, 120: 178, 160: 178}, 40: {50: 178, 80: 268, 100: 345, 120: 382, 160: 382},
    45: {50: 229, 80: 407, 100: 459, 120: 523, 160: 523},
    50: {80: 484, 100: 611, 120: 688, 160: 688}, 58: {80: 714, 100: 905, 120: 969, 160: 969},
}  # fmt: skip
SIZES = tuple(SHG_RATED)
# Ratcheting torque of CSF at the ratios 50, 80 and 100, and buckling torque, in N.m.
RATCHETING = {14: (88, 110, 84), 17: (150, 200, 160), 20: (220, 350, 260), 25: (450, 680, 500), 32: (980, 1400, 1000)}
BUCKLING = {14: 190, 17: 330, 20: 560, 25: 1000, 32: 2200}
# No-load torques: CSF, in N.m; CPL-20-160 at 20 degC, in N.m and rad/s.
STARTING_TORQUE = {(17, 100): 0.034, (25, 50): 0.15}
BACKDRIVING_TORQUE = {(17, 100): 3.3, (25, 50): 9.0}
CPL_STARTING, CPL_RUNNING, CPL_RATIO_CORRECTION, CPL_SPEED = 0.029, 0.16, 0.003, 3500 * 2 * pi / 60
