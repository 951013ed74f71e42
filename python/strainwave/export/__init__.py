"""Export parts of a drive to other programs: controllers as firmware.

>>> from pathlib import Path
>>> from tempfile import TemporaryDirectory
>>> import strainwave as sw
>>> with TemporaryDirectory() as folder:
...     written = sw.export.firmware(sw.Drive(control=sw.control.Sampled(law=sw.control.PID())), folder)
...     sorted(path.name for path in Path(folder).iterdir())
['controller.cpp', 'controller.h', 'include']
"""

from strainwave.export.firmware import Firmware, firmware

__all__ = ["Firmware", "firmware"]
