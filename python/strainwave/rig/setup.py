"""The rig itself: what turns masses into torque and carries the markers."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Literal

from strainwave.rig.loop import Side

STANDARD_GRAVITY = 9.80665  # m/s2: CGPM 1901


@dataclass(frozen=True)
class Value:
    """A number of the rig with its standard deviation.

    Attributes:
        value: the number, in SI units
        sigma: its standard deviation, in the same unit
        source: where it comes from; "assumed" first if nobody measured it
    """

    value: float
    sigma: float = 0.0
    source: str = ""


@dataclass(frozen=True)
class Masses:
    """Equal masses of a set.

    Attributes:
        mass: of each [kg]
        count: how many there are
        sigma: standard deviation of each [kg]
        source: where the numbers come from; "assumed" first if nobody measured them
    """

    mass: float
    count: int
    sigma: float = 0.0
    source: str = ""


@dataclass(frozen=True)
class Camera:
    """What the picture of a plane target does to lengths, so that it can be undone; the defaults undo nothing.

    Attributes:
        aspect: width of a pixel over its height [1]
        tilt: angle between the optical axis and the shaft [rad]
        tilt_direction: direction in the image towards which the target recedes [rad], from x towards the top of the image
        distance: from the camera to the target in pixels, as is the focal length [px]; no perspective where it is not known
        centre: of distortion and perspective [px], x and y; the middle of the image if None
        radial: k1, k2 of the lens [px^-2, px^-4]: a point at r from the centre is seen at r (1 + k1 r^2 + k2 r^4)
        sources: where each of these numbers comes from, by its name
    """

    aspect: float = 1.0
    tilt: float = 0.0
    tilt_direction: float = 0.0
    distance: float | None = None
    centre: tuple[float, float] | None = None
    radial: tuple[float, float] = (0.0, 0.0)
    sources: Mapping[str, str] = field(default_factory=dict, hash=False)


@dataclass(frozen=True)
class Rig:
    """A rig that loads one shaft of a gear by masses on two pairs of pans, the other shaft held.

    Attributes:
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
    """

    name: str
    side: Side
    disk_radius: Value
    gravity: Value = field(default_factory=lambda: Value(STANDARD_GRAVITY, 0.02, "standard; anywhere on Earth within 0.3 %"))
    masses: tuple[Masses, ...] = ()
    cord: Literal["wound", "fixed point"] = "wound"
    cord_tangent: Value = Value(0.0)
    pulley_torque: Value = Value(0.0)
    pulley_share: Value = Value(0.0)
    compliance: Value = Value(0.0)
    markers_diameter: Value | None = None
    markers_distance: Value | None = None
    camera: Camera = Camera()
    note: str = ""
