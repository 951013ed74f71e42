"""Export a gear or a drive to other programs: MuJoCo, URDF, ROS 2, BAM, FMU, Modelica, Newton, firmware, slots of controllers.

>>> from pathlib import Path
>>> from tempfile import TemporaryDirectory
>>> import strainwave as sw
>>> with TemporaryDirectory() as folder:
...     written = sw.export.firmware(sw.Drive(control=sw.control.Sampled(law=sw.control.PID())), folder)
...     sorted(path.name for path in Path(folder).iterdir())
['controller.cpp', 'controller.h', 'controller.hpp', 'controller_main.c']
"""

from strainwave.export.bam_parameters import BAM, bam, read_bam
from strainwave.export.engine_plugin import MUJOCO_PLUGIN, mujoco_plugin
from strainwave.export.exported import Exported
from strainwave.export.firmware import FIRMWARE, Firmware, firmware
from strainwave.export.fmu import FMU, fmu
from strainwave.export.joint_numbers import JOINT, joint
from strainwave.export.modelica_package import MODELICA, modelica
from strainwave.export.mujoco import MJCF, mjcf
from strainwave.export.newton import NEWTON, newton
from strainwave.export.ros2 import ROS2, ros2
from strainwave.export.slots import SLOT, slot
from strainwave.tuning.loss import ExportLoss

__all__ = [
    "ExportLoss",
    "Exported",
    "Firmware",
    "bam",
    "firmware",
    "fmu",
    "joint",
    "mjcf",
    "modelica",
    "mujoco_plugin",
    "newton",
    "read_bam",
    "ros2",
    "slot",
]

# In the order of `strainwave export --help` and of the guide to exports.
FORMS = (JOINT, MJCF, MUJOCO_PLUGIN, NEWTON, BAM, FMU, MODELICA, ROS2, FIRMWARE, SLOT)


def __dir__() -> list[str]:
    return __all__
