"""Part of a torsion test's report: the rig, the photographs and the steps of the test."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from math import degrees
from typing import NamedTuple

import numpy as np

from strainwave.report.rig_figures import Pictures
from strainwave.rig.bench.setup import Camera, Rig, Value
from strainwave.rig.reading.evaluation import Evaluation
from strainwave.rig.vision.angle import Angles
from strainwave.rig.vision.marker import Frame
from strainwave.typeset import ARCSEC_PER_DEGREE, ZERO_CELSIUS, fixed, number, uncertain


class RigRow(NamedTuple):
    """A number of the rig, ready to print."""

    name: str
    value: str
    unit: str
    source: str


def rig_rows(rig: Rig) -> list[RigRow]:
    """Every number of a rig with its standard deviation and its source, in the units of the workshop."""
    return [*_loading(rig), *_masses(rig), *_target(rig), *_camera(rig.camera)]


def _row(name: str, given: Value, scale: float, unit: str) -> RigRow:
    value = uncertain(scale * given.value, scale * given.sigma) if given.sigma > 0.0 else number(scale * given.value)
    return RigRow(name, value, unit, given.source)


def _loading(rig: Rig) -> Iterator[RigRow]:
    yield RigRow("Loaded shaft", rig.side, "", "the other shaft and the circular spline are held")
    yield _row("Radius of the disk", rig.disk_radius, 1e3, "mm")
    yield _row("Gravity", rig.gravity, 1.0, "m/s²")
    if rig.cord == "wound":
        yield RigRow("Cords", "wound on the rim", "", "the arm is the disk's radius at every angle")
    else:
        yield RigRow(
            "Cords", "from a fixed point of the rim", "", "the arm is r cos(angle − angle at which the cord is tangent)"
        )
        yield _row("Angle at which the cord is tangent", rig.cord_tangent, degrees(1.0), "°")
    yield _row("Friction of the pulleys, whatever the load", rig.pulley_torque, 1e3, "mN·m at the disk")
    yield _row("Friction of the pulleys, share of the torque", rig.pulley_share, 1e2, "%")
    yield _row("Compliance of coupling and frame", rig.compliance, 1e3, "mrad/(N·m)")


def _masses(rig: Rig) -> Iterator[RigRow]:
    for masses in rig.masses:
        yield _row(f"{masses.count} masses of", Value(masses.mass, masses.sigma, masses.source), 1e3, "g each")


def _target(rig: Rig) -> Iterator[RigRow]:
    for name, given in (("Diameter of the markers", rig.markers_diameter), ("Distance of the markers", rig.markers_distance)):
        if given is not None:
            yield _row(name, given, 1e3, "mm")


def _camera(camera: Camera) -> Iterator[RigRow]:
    def source(*keys: str) -> str:
        return "; ".join(dict.fromkeys(camera.sources[key] for key in keys if key in camera.sources))

    if camera == Camera(sources=camera.sources):
        yield RigRow(
            "Camera",
            "not calibrated",
            "",
            "taken to look straight at the target, through a lens without distortion, at square pixels",
        )
        return
    yield RigRow("Width of a pixel over its height", number(camera.aspect), "", source("aspect"))
    yield RigRow("Tilt of the camera", number(degrees(camera.tilt), 4), "°", source("tilt"))
    if camera.tilt:
        yield RigRow(
            "Direction in which the target recedes", number(degrees(camera.tilt_direction), 4), "°", source("tilt_direction")
        )
    if camera.distance is not None:
        yield RigRow("Distance of the target", number(camera.distance, 5), "px", source("distance"))
    if camera.centre is not None:
        centre = ", ".join(number(each, 5) for each in camera.centre)
        yield RigRow("Centre of distortion and perspective", centre, "px", source("centre[0]", "centre[1]"))
    if any(camera.radial):
        radial = ", ".join(number(each, 4) for each in camera.radial)
        yield RigRow("Distortion of the lens, k₁, k₂", radial, "px⁻², px⁻⁴", source("radial[0]", "radial[1]"))


# ---- Photographs -----------------------------------------------------------------------------------------------------


def pictures(angles: Sequence[Angles]) -> Pictures:
    """The quality of all photographs of a test, in their order."""
    sigma, residual = [], []
    for each in angles:
        sigmas = dict(zip((frame.name for frame in each.useful), each.sigma, strict=True))
        for frame in each.frames:
            sigma.append(ARCSEC_PER_DEGREE * degrees(sigmas[frame.name]) if frame.name in sigmas else np.nan)
            residual.append([marker.residual for marker in frame.markers] if frame.markers else [np.nan, np.nan])
    return Pictures(np.array(sigma), np.reshape(np.array(residual), (-1, 2)))


class Photograph(NamedTuple):
    """A photograph as the table of them has it."""

    name: str
    angle: str
    sigma: str
    residual: str
    contrast: str
    blur: str
    arc: str
    remark: str
    sha256: str


def photographs(angles: Sequence[Angles]) -> list[Photograph]:
    """Return every photograph of a test with its angle and its warnings."""
    rows = []
    for each in angles:
        angle_of = {frame.name: (angle, sigma) for frame, angle, sigma in zip(each.useful, each.angle, each.sigma, strict=True)}
        rows += [_photograph(frame, angle_of.get(frame.name)) for frame in each.frames]
    return rows


def _photograph(frame: Frame, measured: tuple[float, float] | None) -> Photograph:
    remark = "; ".join([*([f"of no use: {frame.fault}"] if frame.fault else []), *frame.warnings])
    if measured is None or frame.markers is None:
        return Photograph(frame.name, "—", "—", "—", "—", "—", "—", remark, frame.sha256)
    pair = frame.markers
    return Photograph(
        frame.name,
        fixed(degrees(measured[0]), 4),
        fixed(ARCSEC_PER_DEGREE * degrees(measured[1]), 1),
        fixed(max(marker.residual for marker in pair), 3),
        fixed(min(marker.contrast for marker in pair), 2),
        fixed(max(marker.blur for marker in pair), 2),
        f"{fixed(100.0 * min(marker.arc for marker in pair), 0)} %",
        remark,
        frame.sha256,
    )


def centre_words(angles: Sequence[Angles]) -> list[str]:
    """About which point the disk turned, and whether the couple was pure."""
    words = []
    for each in angles:
        if each.centre is None:
            words.append(
                f"With {each.reference} at 0: the turn is too small to determine the point about which the disk turned."
            )
        else:
            x, y, rms = each.centre
            words.append(
                f"With {each.reference} at 0: the disk turned about ({fixed(x, 1)}, {fixed(y, 1)}) px; "
                f"the markers keep to circles about it within {fixed(rms, 3)} px rms."
            )
    return words


# ---- Steps -----------------------------------------------------------------------------------------------------------


def step_rows(found: Evaluation) -> Iterator[list[str]]:
    """Every step with its masses, time and temperature."""
    for step in found.steps:
        yield [
            str(step.number),
            f"{f'{step.unit}, ' if step.unit else ''}{degrees(step.position):.6g}°",
            fixed(1e3 * step.mass_positive, 1) if step.torque is None else "—",
            fixed(1e3 * step.mass_negative, 1) if step.torque is None else "—",
            "" if step.time is None else fixed(step.time, 0),
            "" if step.temperature is None else fixed(step.temperature - ZERO_CELSIUS, 1),
            step.image or "angle read otherwise",
        ]
