"""Export a drive as an FMU, for Simulink, OpenModelica, Dymola and all that import FMI 2.0 or 3.0."""

from strainwave.export.fmu.build import FMU, PLATFORMS, fmu

__all__ = ["FMU", "PLATFORMS", "fmu"]
