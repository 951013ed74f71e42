"""The rig itself: what turns masses into torque and carries the markers."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Literal, get_args

from strainwave import arguments
from strainwave.files.entries import NOT_GIVEN, check_line
from strainwave.rig.loop import COLUMNS, Side, not_negative, positive, signed

STANDARD_GRAVITY = 9.80665  # m/s2: CGPM 1901
Cord = Literal["wound", "fixed point"]
MAX_PIECES = 10_000  # masses of one size


@dataclass(frozen=True)
class Value:
    """A number of the rig with its standard deviation.

    Args:
        value: the number, in SI units
        sigma: its standard deviation, in the same unit
        source: where it comes from; "assumed" first if nobody measured it

    Raises:
        ValueError: a number is not finite, the deviation is negative, or the source is no line of text

    >>> import strainwave as sw
    >>> bench = sw.rig.Rig("bench", "input", disk_radius=sw.rig.Value(0.1, 5e-5, "calliper"))
    >>> print(sw.rig.torque_budget(bench, sw.rig.Step(1, mass_positive=0.35)))
    Budget: torque 0.34323 ± 0.00072 N·m (0.21 %)
      gravity                 0.0007  N·m  94 %, common
      radius of the disk  0.00017162  N·m  6 %, common
    """

    value: float
    sigma: float = 0.0
    source: str = NOT_GIVEN

    def __post_init__(self) -> None:
        signed("value", self.value)
        not_negative("sigma", self.sigma)
        check_line("source", self.source)


@dataclass(frozen=True)
class Masses:
    """Equal masses of a set.

    Args:
        mass: of each [kg]
        count: how many there are
        sigma: standard deviation of each [kg]
        source: where the numbers come from; "assumed" first if nobody measured them

    Raises:
        ValueError: the mass is not positive, or there is none of them

    >>> import strainwave as sw
    >>> plates = sw.rig.Masses(mass=0.05, count=8, sigma=1e-5, source="scale")
    >>> bench = sw.rig.Rig("bench", "input", disk_radius=sw.rig.Value(0.1), masses=(plates,))
    >>> round(sw.rig.plan(bench, peak=0.3, positions=[0.0]).peak, 4)  # N.m, by 300 g
    0.2942
    """

    mass: float
    count: int
    sigma: float = 0.0
    source: str = NOT_GIVEN

    def __post_init__(self) -> None:
        positive("mass", self.mass, "kg")
        arguments.whole("count", self.count, low=1, high=MAX_PIECES)
        not_negative("sigma", self.sigma, "kg")
        check_line("source", self.source)


@dataclass(frozen=True)
class Camera:
    """Distortion of lengths in the picture of a plane target; the defaults describe an undistorted picture.

    Args:
        aspect: width of a pixel over its height [1]
        tilt: angle between the optical axis and the shaft [rad]
        tilt_direction: direction in the image towards which the target recedes [rad], from x towards the top of the image
        distance: from the camera to the target in pixels, as is the focal length [px]; no perspective where it is not known
        centre: of distortion and perspective [px], x and y; the middle of the image if None
        radial: k1, k2 of the lens [px^-2, px^-4]: a point at r from the centre is seen at r (1 + k1 r^2 + k2 r^4)
        sources: where each of these numbers comes from, by its name

    Raises:
        ValueError: a number is out of its range

    >>> import numpy as np
    >>> import strainwave as sw
    >>> camera, random = sw.rig.Camera(tilt=0.2, tilt_direction=0.5), np.random.default_rng(1)
    >>> scene = sw.rig.Scene(size=(320, 240), radius=20.0, distance=150.0, camera=camera)
    >>> pictures = [sw.rig.as_image(f"{turn}.png", sw.rig.render(scene, np.radians(turn), random)) for turn in (0, 60)]
    >>> for each in (sw.rig.Camera(), camera):  # without and with the tilt, degrees
    ...     print(np.degrees(sw.rig.measure_angles(pictures, camera=each).angle[1]).round(1))
    61.0
    60.0
    """

    aspect: float = 1.0
    tilt: float = 0.0
    tilt_direction: float = 0.0
    distance: float | None = None
    centre: tuple[float, float] | None = None
    radial: tuple[float, float] = (0.0, 0.0)
    sources: Mapping[str, str] = field(default_factory=dict, hash=False)

    def __post_init__(self) -> None:
        positive("aspect", self.aspect)
        arguments.bare_number("tilt", self.tilt, "rad", low=-0.5 * math.pi, high=0.5 * math.pi)
        signed("tilt_direction", self.tilt_direction, "rad")
        if self.distance is not None:
            positive("distance", self.distance, "px")
        for name, values in (("centre", self.centre or ()), ("radial", self.radial)):
            for index, each in enumerate(values):
                signed(f"{name}[{index}]", each)


@dataclass(frozen=True)
class Rig:
    """A rig that loads one shaft of a gear by masses on two pairs of pans, the other shaft held.

    Args:
        name: what it is, one line
        side: the shaft that carries the disk
        disk_radius: at which the cords pull [m]
        gravity: at the place of the rig [m/s2]
        masses: what can be laid on the pans
        cord: wound on the rim, so that the arm stays the disk's radius; or from a fixed point of it, arm r cos(angle - tangent)
        cord_tangent: reading of the angle at which a cord from a fixed point is tangent [rad]
        pulley_torque: friction torque of the pulleys at the disk, whatever the load [N.m]
        pulley_share: friction torque of the pulleys per applied torque [1]
        compliance: of coupling and frame, in series with the gear [rad/(N.m)]
        markers_diameter, markers_distance: of the target [m]; the scale of the picture where both are known
        camera: what is known of it
        note: anything else

    Raises:
        ValueError: a number is out of its range, or a word is not known; the message names it, its range and its unit

    >>> rig = Rig("bench", "input", disk_radius=Value(0.1, 5e-5, "calliper"))
    >>> rig.compliance
    Value(value=0.0, sigma=0.0, source='not given')
    """

    name: str
    side: Side
    disk_radius: Value
    gravity: Value = field(default_factory=lambda: Value(STANDARD_GRAVITY, 0.02, "standard; anywhere on Earth within 0.3 %"))
    masses: tuple[Masses, ...] = ()
    cord: Cord = "wound"
    cord_tangent: Value = Value(0.0)
    pulley_torque: Value = Value(0.0)
    pulley_share: Value = Value(0.0)
    compliance: Value = Value(0.0)
    markers_diameter: Value | None = None
    markers_distance: Value | None = None
    camera: Camera = Camera()
    note: str = ""

    def __post_init__(self) -> None:
        check_line("name", self.name)
        arguments.one_of("side", self.side, COLUMNS)
        arguments.one_of("cord", self.cord, get_args(Cord))
        arguments.text("note", self.note)
        for name, unit in (("disk_radius", "m"), ("gravity", "m/s2"), ("markers_diameter", "m"), ("markers_distance", "m")):
            if (number := getattr(self, name)) is not None:
                positive(name, number.value, unit)
        for name, unit in (("pulley_torque", "N.m"), ("compliance", "rad/(N.m)")):
            not_negative(name, getattr(self, name).value, unit)
        arguments.bare_number("pulley_share", self.pulley_share.value, brackets="[)", low=0.0, high=1.0)
