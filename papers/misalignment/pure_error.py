"""The pure kinematic error over a turn against a measured curve, and `Misalignment` fitted to it: Figure 3.a of the paper."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import strainwave as sw
from numpy.typing import NDArray
from scipy.optimize import least_squares
from strainwave.diagnose import COMBINE, displaced

Array = NDArray[np.float64]

M_PER_MICRON = 1e-6  # m
FULL_TURN = 2.0 * np.pi  # rad
MIN_POINTS = 24  # of a measured curve over a turn
# The paper shows its measured curve as a picture alone. Assumed: the amplitudes that the page of errata derives, and phases.
ASSUMED_CURVE = sw.kinematic_error.Fourier(order=[1, 2, 4], amplitude=[0.8e-4, 3.0e-4, 0.5e-4], phase=[0.3, -0.8, 0.7])


@dataclass(frozen=True)
class ErrorFit:
    """`Misalignment` with one `combine`, fitted to a curve.

    Attributes:
        law: fitted; of its parameters only those in `determined` follow from the curve
        determined: parameters that the curve determines, by name: m_x and m_y [m], and c_x [m] if the lobe further out carries
        curve: the law at the angles of the measured curve, without mean [rad], shape (n,)
        rms: of what the law leaves unexplained [rad]
        explained: share of the variance of the measured curve that the law explains
    """

    law: Any
    determined: Mapping[str, float]
    curve: Array
    rms: float
    explained: float

    @property
    def size(self) -> float:
        """Return the size of m [m]."""
        return float(np.hypot(self.determined["m_x"], self.determined["m_y"]))

    @property
    def possible(self) -> bool:
        """True if m is less than half the difference of the wave generator's axes, by which the lobes stand out."""
        return self.size < 0.5 * float(self.law.major_radius - self.law.minor_radius)


@dataclass(frozen=True)
class PureError:
    """A measured curve, and the law fitted to it in each way in which the lobes may share.

    Attributes:
        angle: of the input [rad], shape (n,)
        curve: pure kinematic error without mean [rad], shape (n,)
        source: name of the file; empty where the curve is the assumed one
        fits: by `combine`
    """

    angle: Array
    curve: Array
    source: str
    fits: Mapping[str, ErrorFit]

    @property
    def best(self) -> str:
        """The `combine` that leaves least, among those whose m is less than the lobes stand out: more would part the teeth."""
        possible = [combine for combine, fit in self.fits.items() if fit.possible] or list(self.fits)
        return min(possible, key=lambda combine: self.fits[combine].rms)


def pure_error(measured: str | Path | None, law: Any) -> PureError:
    """Fit a law of misalignment to a curve over a turn.

    Args:
        measured: a file with the columns input_angle and kinematic_error, over a turn at least; None for the assumed curve
        law: `Misalignment`, whose dimensions are kept

    Raises:
        ValueError: the file cannot be read, lacks a column, or holds less than a turn
    """
    angle, curve, source = _assumed() if measured is None else _read(Path(measured))
    curve = curve - turn_mean(angle, curve)
    return PureError(angle, curve, source, {combine: fitted(angle, curve, law.replace(combine=combine)) for combine in COMBINE})


def fitted(angle: Array, curve: Array, law: Any) -> ErrorFit:
    """Fit the law to a curve of mean zero, by least squares from several starts.

    Only parameters that a curve can determine are free: m, and c_x if the lobe further out carries.
    """
    free = 3 if law.combine == "max" else 2
    far = 0.4 * law.minor_radius / M_PER_MICRON
    per_metre = float(np.tan(law.pressure_angle) / law.pitch_radius)
    unit = max(float(np.abs(curve).max()), 1e-12)

    def model(point: Array) -> Array:
        c_x = M_PER_MICRON * float(point[2]) if free == 3 else 0.0
        errors: Array = displaced(law, (M_PER_MICRON * float(point[0]), M_PER_MICRON * float(point[1])), c_x).error(angle)
        return errors - turn_mean(angle, errors)

    def gap(point: Array) -> Array:
        return (model(point) - curve) / unit

    size = unit / per_metre
    if law.combine == "mean":  # of second order: a m^2 / 4 b^2
        size = float(np.sqrt(4.0 * size / law.major_radius)) * law.minor_radius
    size = min(size / M_PER_MICRON, 0.9 * far)
    starts = [size * np.array([np.cos(way), np.sin(way), 0.1])[:free] for way in np.pi * np.arange(8) / 4.0]
    found = min(
        (least_squares(gap, start, bounds=(-far, far), x_scale=max(size, 1.0)) for start in starts),
        key=lambda result: float(result.cost),
    ).x
    rest = curve - model(found)
    variance = float(np.mean(curve**2))
    determined = dict(zip(("m_x", "m_y", "c_x"), (M_PER_MICRON * found).tolist(), strict=False))
    return ErrorFit(
        law=displaced(law, (determined["m_x"], determined["m_y"]), determined.get("c_x", 0.0)),
        determined=determined,
        curve=model(found),
        rms=float(np.sqrt(np.mean(rest**2))),
        explained=1.0 - float(np.mean(rest**2)) / variance if variance else 0.0,
    )


def turn_mean(angle: Array, values: Array) -> float:
    """The mean over the angle."""
    return float(np.trapezoid(values, angle) / (angle[-1] - angle[0]))


def _assumed() -> tuple[Array, Array, str]:
    angle = np.linspace(0.0, 2.0 * np.pi, 361)
    curve: Array = ASSUMED_CURVE.error(angle)
    return angle, curve, ""


def _read(path: Path) -> tuple[Array, Array, str]:
    """The first turn of a file, sorted by the angle."""
    names = ("input_angle", "kinematic_error")
    found = sw.Recording.read(path, columns={name: name for name in names})
    try:
        angle, curve = (found.values(name, "rad") for name in names)
    except ValueError as error:
        raise ValueError(f"{path} {error}; give the column as an angle") from None
    order = np.argsort(angle, kind="stable")
    angle, curve = angle[order], curve[order]
    kept = np.append(np.diff(angle) > 0.0, True) & (angle - angle[0] <= FULL_TURN * (1.0 + 1e-9))
    angle, curve = angle[kept], curve[kept]
    if len(angle) < MIN_POINTS or angle[-1] - angle[0] < FULL_TURN * (1.0 - 2.0 / MIN_POINTS):
        raise ValueError(
            f"{path}: {len(angle)} points over {np.degrees(np.ptp(angle)):.4g} deg of input_angle; a curve needs {MIN_POINTS} "
            "points or more over a whole turn, 360 deg"
        )
    return angle, curve, path.name
