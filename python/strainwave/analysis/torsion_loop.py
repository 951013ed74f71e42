"""Torsion loop of a gear by its spring and its hysteresis, with standard deviations: a curve to compare gears by.

Elements of hysteresis are not unique: several sets of them make nearly one loop, and an element more changes all others.
"""

from __future__ import annotations

from collections.abc import Callable
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray

from strainwave import Gear, ring, structure
from strainwave.files.gear_set import GearSet
from strainwave.files.units import convert
from strainwave.parameters import every

Array = NDArray[np.float64]

POINTS_PER_BRANCH = 400
SHARES_OF_TORQUE = (1.0, 0.5, 0.0, -0.5)  # of the largest torque, at which the branch of falling torque is compared
RATINGS_OF_TORQUE = ("peak_torque", "rated_torque")  # to which a gear is loaded that nobody measured, best first
STEP_SIGMA = 0.1  # standard deviations of a number, between two loops
MAX_STEP_SHARE = 1e-3  # of a number, between two loops
NO_CHANGE = 1e-9  # of the largest value of a curve: a number that changes it less has no effect
LAWS = ("gear.stiffness.", "gear.hysteresis.")


def series_compliance(gear: Gear) -> float:
    """Return the compliance at the output in series with the spring, the input shaft held [rad/(N.m)]; 0 without stages.

    The flight actuator paper's statics, corrected (its eq. (1) at rest, with errata 1 and 2 of the flight actuator paper):
    radial displacements times tan(alpha_t) / r_g and tangential ones over r_g are twists of the output, and all springs bear
    one torque,

        tan² alpha_t / (K_b r_g²) + (1 / K_m + sum_k 1 / (m_k omega_k²)) / (r_g² cos² alpha_t) + 1 / K_CS + 1 / (i² K_WG),

    with the modes of the ring as the wave generator stands.

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
    modes = zip(stages.ring.mass, stages.ring.natural_frequency, strict=True) if isinstance(stages.ring, ring.Modes) else ()
    along_mesh = 1.0 / stages.mesh_stiffness + sum(1.0 / (mass * frequency**2) for mass, frequency in modes)
    mesh = (1.0 + slope**2) * along_mesh / radius**2
    coupling = 1.0 / (stages.coupling_stiffness * gear.kinematics.ratio**2)
    return bearing + mesh + 1.0 / stages.circular_spline_stiffness + coupling


def measured_torque(gear_set: GearSet) -> float | None:
    """Return the largest torque at the output under which files of a gear determine its loop [N.m]; None without."""
    sources = [entry.source for path, entry in gear_set.sources.items() if path.startswith(LAWS)]
    ends = [
        np.abs(file.measured["output_torque"]).max()
        for file in gear_set.validation
        if "output_torque" in file.measured and (file.kind == "torsion" or any(file.file in source for source in sources))
    ]
    return float(max(ends)) if ends else None


def rated_torque(gear_set: GearSet) -> float | None:
    """Return the largest torque at the output that the ratings of a gear allow [N.m]; None without them."""
    ratings = (gear_set.ratings[name] for name in RATINGS_OF_TORQUE if name in gear_set.ratings)
    return next((convert(float(each.value), each.unit, "N.m") for each in ratings), None)


def torsion_loop(gear: Any, torque: float) -> Array:
    """Return the twist where the torque falls, at `SHARES_OF_TORQUE` of the largest, and the loss of a cycle.

    Args:
        gear: of which spring and hysteresis take part
        torque: largest torque of a loop about zero [N.m]

    Returns:
        twists [rad] and loss [J], shape (5,); 0 where they are less than what rounding leaves

    >>> import strainwave as sw
    >>> slip = sw.hysteresis.MaxwellSlip(stiffness=[1e3], breakaway=[1.0])
    >>> gear = sw.Gear(stiffness=sw.stiffness.Linear(k=1e4), hysteresis=slip)
    >>> torsion_loop(gear, 41.0).round(6).tolist()  # 40 N.m in the spring, 1 N.m in the element
    [0.004, 0.002136, 0.0001, -0.00195, 0.012]
    """
    from scipy.optimize import brentq

    def loop(reach: float) -> tuple[Array, Array]:
        corners = [0.0, reach, -reach, reach, -reach, reach]
        path = np.concatenate([*(np.linspace(a, b, POINTS_PER_BRANCH + 1)[:-1] for a, b in pairwise(corners)), [reach]])
        force = np.asarray(gear.stiffness.torque(path)) + np.asarray(gear.hysteresis.trace(path))
        return path[3 * POINTS_PER_BRANCH :], force[3 * POINTS_PER_BRANCH :]

    softest = float(gear.stiffness.twist(torque))
    reach = float(brentq(lambda twist: loop(twist)[1][0] - torque, 1e-9 * softest, softest, xtol=1e-12 * softest))
    twist, force = loop(reach)
    falling = slice(None, POINTS_PER_BRANCH + 1)
    points = np.interp(torque * np.array(SHARES_OF_TORQUE), force[falling][::-1], twist[falling][::-1])
    loss = abs(float(np.trapezoid(force, twist)))
    return np.append(
        np.where(np.abs(points) > NO_CHANGE * reach, points, 0.0), loss if loss > NO_CHANGE * torque * reach else 0.0
    )


def loop_sigma(gear_set: GearSet, torque: float) -> Array | None:
    """Return the standard deviations of `torsion_loop` by those of spring and hysteresis, shape (5,).

    None if that of a number is not stated.
    """
    return curve_sigma(gear_set, LAWS, lambda gear: torsion_loop(gear, torque))


def curve_sigma(gear_set: GearSet, laws: tuple[str, ...], curve: Callable[[Any], Array]) -> Array | None:
    """Return the standard deviations of a curve of a gear by those of the numbers of its laws, shape (n,).

    None if that of a number is not stated on which the curve depends.

    Args:
        gear_set: the gear, with standard deviations
        laws: beginnings of the paths of these numbers
        curve: of a gear, shape (n,)
    """
    gear: Any = gear_set.gear
    numbers = {path: each for name, each in every(gear).items() if (path := f"gear.{name}").startswith(laws)}
    values = {path: each.value for path, each in numbers.items()}
    if not values:
        return None
    here, sigma = curve(gear), np.zeros(len(values))
    slopes = np.zeros((len(here), len(values)))
    for place, (path, value) in enumerate(values.items()):
        stated = gear_set.sources[path].sigma(value) if path in gear_set.sources else None
        largest = MAX_STEP_SHARE * (abs(value) or 1.0)
        if step := largest if stated is None else min(STEP_SIGMA * stated, largest):
            step = -step if value + step > numbers[path].high else step
            slopes[:, place] = (curve(gear.replace({path.removeprefix("gear."): value + step})) - here) / step
        if stated is None and np.abs(step * slopes[:, place]).max() > NO_CHANGE * np.abs(here).max():
            return None
        sigma[place] = stated or 0.0
    covariance = np.diag(sigma**2)
    if (saved := gear_set.covariance) is not None and (own := saved.among(list(values))) is not None:
        places = [list(values).index(path) for path in own.paths]
        deviations = np.sqrt(np.diag(own.array))
        correlation = own.array / np.outer(deviations, deviations)
        covariance[np.ix_(places, places)] = correlation * np.outer(sigma[places], sigma[places])
    return np.asarray(np.sqrt(np.einsum("kp,pq,kq->k", slopes, covariance, slopes)))
