"""Drives whose output shaft another program moves."""

from strainwave.export.coupled.drive import MAX_STABLE_SHARE, SUFFIXES, CoupledDrive, losses, shared_library

__all__ = ["MAX_STABLE_SHARE", "SUFFIXES", "CoupledDrive", "losses", "shared_library"]
