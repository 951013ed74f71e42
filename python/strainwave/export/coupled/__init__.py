"""Drives whose output shaft another program moves."""

from strainwave.export.coupled.drive import (
    COMPARED_DURATION,
    COMPARED_SAMPLES,
    MAX_STABLE_SHARE,
    REFERENCE_STEP_SHARE,
    CoupledDrive,
)
from strainwave.export.coupled.library import SUFFIXES, shared_library

__all__ = [
    "COMPARED_DURATION",
    "COMPARED_SAMPLES",
    "MAX_STABLE_SHARE",
    "REFERENCE_STEP_SHARE",
    "SUFFIXES",
    "CoupledDrive",
    "shared_library",
]
