"""Drives whose output shaft another program moves."""

from strainwave.export.coupled.drive import CoupledDrive
from strainwave.export.coupled.library import SUFFIXES, shared_library

__all__ = ["SUFFIXES", "CoupledDrive", "shared_library"]
