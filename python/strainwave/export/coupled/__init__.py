"""Drives whose output shaft another program moves."""

from strainwave.export.coupled.drive import CoupledDrive

__all__ = ["CoupledDrive"]
