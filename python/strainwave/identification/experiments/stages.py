"""Compliance in series with the spring of a gear, of a structure with bodies between its shafts."""

from __future__ import annotations

import numpy as np

from strainwave import structure
from strainwave._core import Gear


def series_compliance(gear: Gear) -> float:
    """Return the compliance at the output in series with the spring, the input shaft held [rad/(N.m)]; 0 without stages.

    The flight actuator paper's statics, corrected (its eq. (1) at rest, with errata 1 and 2 of the flight actuator paper):
    radial displacements times tan(alpha_t) / r_g and tangential ones over r_g are twists of the output, and all springs bear
    one torque,

        tan² alpha_t / (K_b r_g²) + 1 / (K_m r_g² cos² alpha_t) + 1 / K_CS + 1 / (i² K_WG).

    >>> import strainwave as sw
    >>> gear = sw.GearSet.read("tilt-actuator").gear
    >>> round(1e6 * series_compliance(gear), 3), series_compliance(sw.Gear())
    (37.049, 0.0)
    """
    stages = gear.structure
    if not isinstance(stages, structure.Staged):
        return 0.0
    radius, slope = stages.pitch_radius, float(np.tan(stages.pressure_angle))
    bearing = slope**2 / (stages.bearing_stiffness * radius**2)
    mesh = (1.0 + slope**2) / (stages.mesh_stiffness * radius**2)
    coupling = 1.0 / (stages.coupling_stiffness * gear.kinematics.ratio**2)
    return bearing + mesh + 1.0 / stages.circular_spline_stiffness + coupling
