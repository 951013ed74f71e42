"""Ensembles on a GPU beside all cores of the processor: agreement, and steps of members a second.

Each drive runs with as many inertias of the load as there are members. Kernels are compiled before.
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Sequence
from typing import Any

import numpy as np
import strainwave as sw
from strainwave.native import device
from strainwave.simulation.threads import available_threads

SETS = ("position-drive", "robot-joint", "tilt-actuator-lumped", "tilt-actuator-staged", "torsion-rig")


def runs(drive: sw.Drive, members: int, seconds: float, backend: Any) -> tuple[sw.Ensemble, float]:
    """Return the runs of a drive, and the time that they took [s]."""
    inertia = drive.load.inertia * np.linspace(0.5, 2.0, members)
    began = time.perf_counter()
    found = sw.simulate_many(
        drive, COMMAND(seconds), {"load.inertia": inertia}, dt=2e-4, sample=1e-2, record=["output_angle", "torque"], backend=backend
    )
    return found, time.perf_counter() - began
