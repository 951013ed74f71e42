"""Export of drives to Newton: an actuator for thousands of joints in one launch, on the CPU and on GPUs."""

from strainwave.export.newton.build import NEWTON, newton

__all__ = ["NEWTON", "newton"]
