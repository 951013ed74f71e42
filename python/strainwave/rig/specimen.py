"""The gear that document T tested, as one reading of its Table 2 has it."""

from __future__ import annotations

from pathlib import Path

from strainwave import hysteresis
from strainwave.files.gear_set import GearSet

PUBLISHED = Path(__file__).parents[1] / "published" / "torsional-stiffness.toml"
PEAK = 0.36  # N.m at the input: document T, procedure, step 1
NEGLIGIBLE = 1e-6  # N.m/rad: the spring beside a law that is a whole spring


def specimen() -> GearSet:
    """The precision gear 1:100 of document T at 0 degrees of the flexspline, with the loop of its Table 2, row 0 degrees.

    The numbers of that row are those of the input. Behind the ratio i torques are i times as large and twists are i times as
    small, so that stiffnesses are i^2 times as large. The table does not describe a closed loop; the law is the simplest
    reading of it that does (E-T4).

    >>> gear = specimen().gear
    >>> round(gear.hysteresis.positive_unloading / gear.kinematics.ratio**2, 9)
    4.51
    """
    bare = GearSet.read(PUBLISHED)
    ratio = float(bare.gear.kinematics.ratio)
    law = hysteresis.Regimes(
        positive_unloading=4.51 * ratio**2,
        negative_loading=0.31 * ratio**2,
        negative_unloading=4.85 * ratio**2,
        positive_loading=0.30 * ratio**2,
        onset=0.03 * ratio,
        lost_motion=0.8813912722571364 / ratio,
    )
    gear = bare.gear.replace(hysteresis=law, stiffness=bare.gear.stiffness.replace(k=NEGLIGIBLE))
    source = "document T, Table 2, row 0 degrees, referred to the output of the gear 1:100; read as a closed loop (E-T4)"
    return GearSet.of(gear, name="Document T's gear", source=source).replace(note=bare.note)
