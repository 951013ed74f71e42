"""Compensation of the robot joint, which several files of tests look at and none changes."""

from __future__ import annotations

from functools import cache

import strainwave as sw


@cache
def robot_joint() -> sw.tuning.Compensated:
    """Return the compensation of the robot joint on three drawn gears, computed once in a process: it takes 40 ensembles."""
    return sw.compensate("robot-joint", members=3, travel=0.03)
