"""A gear file as its tests take it, and parts to put into it."""

from __future__ import annotations

BASE = """
name = "Printed 20:1"

[kinematics]
model = "plain_ratio"
reduction = { value = 20.0, source = "counted" }

[stiffness]
model = "cubic"
a1 = { value = 716.2, unit = "N.m/rad", source = "torsion loop" }
a3 = { value = 2e6, unit = "N.m/rad3", source = "torsion loop" }
"""

THERMAL = """
[friction_mesh]
model = "thermal"
dry_fall = { value = 0.0, unit = "1/K", source = "assumed" }
viscous_fall = { value = 25e-3, unit = "1/K", source = "two runs" }
reference_temperature = { value = 20.0, unit = "degC", source = "thermometer" }
"""

VISCOUS = """
[friction_mesh.law]
model = "viscous"
viscous = { value = 0.5, unit = "N.m.s/rad", source = "run" }
"""

GRID = """
[hysteresis]
model = "preisach"
[hysteresis.density]
model = "grid_density"
limit = { value = 3.0, unit = "arcmin", source = "loop" }
weight = { value = [1.0, 2.0, 1.0], unit = "N.m", source = "loop" }
"""


def with_line(old: str, new: str) -> str:
    """The base file with one line changed."""
    (line,) = [line for line in BASE.splitlines() if line.startswith(old)]
    return BASE.replace(line, new)
