"""Parts of a drive as firmware: a function that a microcontroller calls once in each period."""

from strainwave.export.firmware.build import FIRMWARE, FLAGS, Firmware, firmware

__all__ = ["FIRMWARE", "FLAGS", "Firmware", "firmware"]
