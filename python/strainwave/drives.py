"""Drives by the documents that describe them."""

from strainwave._core import Drive as PositionDrive

__all__ = ["PositionDrive"]
