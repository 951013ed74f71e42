"""Misalignment of a wave generator: ramps of an actuator with it, sweeps of its levels, and its estimate from a record.

What is here is what one calls for a misalignment, and what that returns. Diagnoses by orders are `sw.order_lines` and
`sw.detection_limit`; the command is `strainwave diagnose joint`.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from strainwave.diagnose.actuator_ramp import LOOPS, ActuatorRamp, in_series, wave_generator
    from strainwave.diagnose.inversion import COMBINE, MisalignmentEstimate, displaced
    from strainwave.diagnose.misalignment_sweep import (
        BOTH_LOOPS,
        LOBES,
        SWEEPS,
        SweepLevels,
        level_lines,
        sweep_misalignment,
        swing,
        table_number,
    )
    from strainwave.diagnose.recovery import RecoveryModel, corrected, recover, refined

# Imported at first use: the command reads constants of this folder before it knows its verb.
_LAZY = {
    "actuator_ramp": ("LOOPS", "ActuatorRamp", "in_series", "wave_generator"),
    "inversion": ("COMBINE", "MisalignmentEstimate", "displaced"),
    "misalignment_sweep": (
        *("BOTH_LOOPS", "LOBES", "SWEEPS", "SweepLevels"),
        *("level_lines", "sweep_misalignment", "swing", "table_number"),
    ),
    "recovery": ("RecoveryModel", "corrected", "recover", "refined"),
}

__all__ = [
    "BOTH_LOOPS",
    "COMBINE",
    "LOBES",
    "LOOPS",
    "SWEEPS",
    "ActuatorRamp",
    "MisalignmentEstimate",
    "RecoveryModel",
    "SweepLevels",
    "corrected",
    "displaced",
    "in_series",
    "level_lines",
    "recover",
    "refined",
    "sweep_misalignment",
    "swing",
    "table_number",
    "wave_generator",
]


def __getattr__(name: str) -> Any:
    for module, names in _LAZY.items():
        if name in names:
            return getattr(import_module(f"strainwave.diagnose.{module}"), name)
    raise AttributeError(f"module 'strainwave.diagnose' has no attribute {name!r}")
