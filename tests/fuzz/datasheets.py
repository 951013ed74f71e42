"""Data sheets whose figures are not as they should be."""

from __future__ import annotations

from pathlib import Path

import strainwave as sw
from numpy.random import Generator

from tests.fuzz.laws import Case, described, finite
from tests.fuzz.mutation import encoded, mutated, picked

SHEETS = (
    """name = "Other"
[datasheet]
ratio = -80
size = 20
k1 = "0.47 kgf·m/arcmin"
k2 = "2.5 × 10^4 N·m/rad"
t1 = "7 N·m"
rated_torque = "44 N·m"
peak_torque = "96 N·m"
hysteresis_loss = "≤ 1 arcmin"
starting_torque = "3.4 cN·m"
no_load_running_torque = "0.16 N·m"
no_load_running_speed = "3500 rpm"
""",
    """[datasheet]
ratio = 100
fixed = "circular_spline"
efficiency = "75 %"
wave_generator_inertia = "0.4e-4 kg.m2"
lost_motion = "1 arc-min"
maximum_input_speed = { value = 3500, unit = "r/min", source = "a sheet" }
""",
)
WORDS = (
    "1e3 x 10^999", "1 x 10^-999", "5e-324 r/min", "1e300", "-1", "0", "[datasheet]", "[[datasheet]]", 'fixed = "flexspline"',
    'fixed = "x"',
    "ratio = 0", "ratio = 1e300", "size = 1e300", "size = 5e-324", 'k3 = "1 N.m/rad"', "spread = 2", "efficiency = 2",
    '"1e308 kgf·m/arcmin"', '"3.4 x 10^٣ N·m"', '"7 N·m ± 1"', '"٧ N·m"', "≤ 1 ≤ 2", "{}", "[]", "9" * 400,
)  # fmt: skip


def datasheets_case(random: Generator, folder: Path) -> Case:
    """A data sheet; what is accepted is a gear that transmits a torque, and the same once saved."""
    path = folder / "sheet.toml"
    data = encoded(mutated(picked(random, SHEETS), random, WORDS), random)
    path.write_bytes(data)

    def check(found: sw.GearSet) -> None:
        found.save(folder / "again.toml")
        assert sw.GearSet.read(folder / "again.toml") == found, "a file contains another set"
        assert finite(found.gear.stiffness.torque(1e-6)), "a gear without a torque"

    return Case(described(data, 2000), lambda: sw.GearSet.read(path), check)
