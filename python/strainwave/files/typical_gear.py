"""Assumptions for figures that the maker of a strain wave gear does not state: the rules of docs/reference/catalogue.md.

Two principles. A typical unit takes half of what the maker bounds. Similar gears of one lubricant have torque, stiffness and
viscous torque that grow with the cube of the size, and an inertia that grows with its fifth power. `size` is that of the
makers' names, as 25 in HFUC-25-100: about the pitch diameter in tenths of an inch.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import exp, log, pi, radians, sqrt
from typing import NamedTuple


def rounded(value: float, digits: int) -> float:
    """Return a number with so many significant digits: an assumed figure has few, so that its rule can be recomputed."""
    return float(f"{value:.{digits}g}")


RAD_PER_ARCMIN = radians(1.0 / 60.0)
UNITS_SPREAD = 0.3  # of individual gears about the catalogue's stiffness (Harmonic Drive AG)
# Stiffness of the Maxwell elements over k1: they slip at w/4, w/2 and w.
ELEMENT_SHARES = (2.0 / 3.0, 1.0 / 3.0, 1.0 / 6.0)
DAMPING_RATIO = 0.02
# N.m: times size³ over ratio; geometric mean of CSF-17-100, 3.4 N.cm, and CSF-25-50, 15 N.cm
EXACT_STARTING_TORQUE = sqrt(0.034 * 100.0 / 17.0**3 * 0.15 * 50.0 / 25.0**3)
STARTING_TORQUE = rounded(EXACT_STARTING_TORQUE, 4)
STARTING_SPREAD = 0.2  # what the rule misses its own two figures by
# N.m.s/rad: of size 20 at 20 degC; running torque of CPL-20-160, less a correction for the ratio and the starting torque
EXACT_VISCOUS_FRICTION = (0.16 - 0.003 - 0.029) / (3500.0 * pi / 30.0)
VISCOUS_FRICTION = rounded(EXACT_VISCOUS_FRICTION, 4)
VISCOUS_SPREAD = 0.5  # assumed: one gear alone was at hand
# The middle of the catalogue, and the standard deviation of log(size) over its nine sizes.
ANY_SIZE, ANY_SIZE_SPREAD = (25.0, 0.5)


class Law(NamedTuple):
    """A figure that grows with a power of the size: factor times size^exponent, and how far the catalogue's gears scatter."""

    factor: float
    exponent: float
    scatter: float

    def at(self, size: float) -> float:
        return float(self.factor * size**self.exponent)

    def size(self, value: float) -> float:
        return float((value / self.factor) ** (1.0 / self.exponent))


# Geometric means and standard deviations of the logarithm over the catalogue's CSG and HFUC sets, in SI units, by the makers'
# groups of ratios: 30, 50, and more.
LAWS: dict[str, tuple[Law, Law, Law]] = {
    "k1": (Law(0.6932, 3, 0.050), Law(1.565, 3, 0.093), Law(1.995, 3, 0.041)),
    "k2": (Law(0.8806, 3, 0.036), Law(2.165, 3, 0.095), Law(3.087, 3, 0.093)),
    "k3": (Law(1.361, 3, 0.067), Law(2.712, 3, 0.110), Law(3.509, 3, 0.084)),
    "t1": (Law(8.332e-4, 3, 0.089), Law(8.382e-4, 3, 0.066), Law(8.497e-4, 3, 0.051)),
    "t2": (Law(2.869e-3, 3, 0.136), Law(2.934e-3, 3, 0.104), Law(2.994e-3, 3, 0.086)),
    "rated_torque": (Law(1.694e-3, 3, 0.096), Law(2.409e-3, 3, 0.567), Law(5.212e-3, 3, 0.167)),
    "wave_generator_inertia": (Law(5.351e-12, 5, 0.153), Law(4.966e-12, 5, 0.154), Law(4.771e-12, 5, 0.148)),
}
SIZED_BY = (("k1", "k2", "k3", "t1", "t2"), ("rated_torque",), ("wave_generator_inertia",))  # the best first

HYSTERESIS_LOSS = (3.0 * RAD_PER_ARCMIN, 1.0 * RAD_PER_ARCMIN, 1.0 * RAD_PER_ARCMIN)  # bounds of the maker, by group of ratios
ACCURACY_BOUNDS = ((17.0, (2.0, 1.2, 1.0)), (32.0, (1.5, 1.0, 0.8)), (float("inf"), (1.5, 0.7, 0.5)))  # arcmin, up to a size


def law(name: str, ratio: float) -> Law:
    """Return the growth of a figure with the size, in the group of the ratio."""
    return LAWS[name][group(ratio)]


def group(ratio: float) -> int:
    """The makers' groups of ratios, 30, 50 and more, of which the nearest counts: 0, 1 or 2."""
    return 0 if ratio < sqrt(30.0 * 50.0) else 1 if ratio < sqrt(50.0 * 80.0) else 2


def hysteresis_loss(ratio: float) -> float:
    """The maker's bound on the width of the torsion loop at zero torque [rad]."""
    return HYSTERESIS_LOSS[group(ratio)]


def transmission_accuracy(size: float, ratio: float) -> float:
    """The maker's bound on the kinematic error, peak to peak [rad]."""
    return next(bounds for largest, bounds in ACCURACY_BOUNDS if size < largest + 1.0)[group(ratio)] * RAD_PER_ARCMIN


def starting_torque(size: float, ratio: float) -> float:
    """Torque that starts the wave generator [N.m]: at the output it grows like the torque capacity."""
    return STARTING_TORQUE * size**3 / ratio


def viscous(size: float) -> float:
    """Viscous friction of the wave generator [N.m.s/rad] at 20 degC."""
    return VISCOUS_FRICTION * (size / 20.0) ** 3


def damping(k1: float, ratio: float, inertia: float) -> float:
    """Damping of the twist [N.m.s/rad]: 2 % of critical for the wave generator that swings against a held output."""
    return 2.0 * DAMPING_RATIO * sqrt(k1 * ratio**2 * inertia)


@dataclass(frozen=True)
class Divided:
    """Figures of a whole gear, divided between its spring and its hysteresis.

    Attributes:
        k1: first slope of the spring [N.m/rad]
        t1, t2: its knees [N.m]
        stiffness: of the Maxwell elements [N.m/rad]
        breakaway: of each of them [N.m]
    """

    k1: float
    t1: float
    t2: float
    stiffness: tuple[float, ...]
    breakaway: tuple[float, ...]

    @classmethod
    def of(cls, k1: float, t1: float, t2: float, loss: float) -> Divided:
        """Divide secant K1 up to T1 and the bound on the hysteresis loss; docs/reference/catalogue.md derives it.

        The gear reaches T1 at the twist T1/K1 when it is loaded for the first time, and its loop is half as wide as the bound.

        >>> whole = Divided.of(31e3, 14.0, 48.0, 1.0 * RAD_PER_ARCMIN)  # HFUC-25-100
        >>> round(whole.k1, 1), round(whole.t1, 5), round(whole.breakaway[0], 5)
        (26700.5, 12.05829, 0.64724)
        """
        width = 0.5 * loss
        slope = t1 / (t1 / k1 + 0.5 * width)
        held = 0.5 * slope * width
        elements = len(ELEMENT_SHARES)
        return cls(slope, t1 - held, t2 - held, tuple(part * slope for part in ELEMENT_SHARES), (held / elements,) * elements)


def mean_size(values: dict[str, float], ratio: float) -> float:
    """Return the geometric mean of the sizes by each figure."""
    return exp(sum(log(law(name, ratio).size(value)) for name, value in values.items()) / len(values))
