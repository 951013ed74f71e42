"""The kinds of measurement that files may be."""

from __future__ import annotations

from typing import Literal

Kind = Literal["friction", "torsion", "log", "encoders", "effort", "presliding", "breakaway"]

KINDS: dict[Kind, str] = {
    "friction": "a table of steady friction",
    "torsion": "a torsion loop or branch",
    "log": "a log of a drive",
    "encoders": "a record of two encoders",
    "effort": "torque or current without the motion that made it, or at one constant speed",
    "presliding": "a presliding loop: a small motion to and fro at rest",
    "breakaway": "ramps of torque until the shaft breaks away",
}
