"""Parts of a drive as firmware: a function that a microcontroller calls once in each period."""

from strainwave.export.firmware.build import FLAGS, Firmware, firmware

__all__ = ["FLAGS", "Firmware", "firmware"]
