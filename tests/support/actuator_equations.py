"""Document A's strain wave gear, Eq. 1, written down twice, the inertias of motor and load outside, for SciPy to integrate.

The symbols are those of the document: angles theta_in, theta_WG, theta_out; the radial displacements x1 of the bearing's outer
race and x2 of the flexspline; the tangential displacements y1 of the flexspline, y2 of the circular spline; the forces F_b of
the bearing and F_m of the mesh; the torques T_WG on the wave generator and T_CS on the output shaft.

`corrected` is derived here from a Lagrangian: x1 = r_g tan(alpha_n) theta_WG, the energies

    T = 1/2 (J_in theta_in'^2 + J_WG theta_WG'^2 + m_x x2'^2 + J_FS (y1'/r_g)^2 + J_CS (y2'/r_g)^2 + J_out theta_out'^2)
    V = 1/2 sum of k d^2,   dissipation function 1/2 sum of c d'^2,   over five springs of the deformations d

    coupling          d = theta_in - theta_WG
    bearing           d = x1 + e_WG(theta_WG) - x2
    flexspline        d = y1/r_g,  with the circular spline fixed  y1/r_g + theta_out
    mesh              d = x2 sin(alpha_t) - (y1 + y2) cos(alpha_t)
    circular spline   d = y2/r_g - theta_out,  with the circular spline fixed  y2/r_g

and for each coordinate q:  m q'' = Q - sum of (k d + c d') dd/dq, less 1/2 d^2 dk/dq where a spring varies with an angle.
With the circular spline fixed the output turns backwards: theta_out = -y1/r_g.

`printed` is Eq. 1 line by line, with the terms of the errata E-A2, E-A3 and E-A5 to choose. What the document leaves unsaid
(E-A1), x1 and y2 over the angles, is common to both.
"""

# ruff: noqa: N803, N806, N815 - the document's symbols

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from math import atan, cos, sin, tan
from typing import Literal

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
COORDINATES = ("theta_in", "theta_WG", "x2", "y1", "y2", "theta_out")
SPRINGS = ("coupling", "bearing", "flexspline", "mesh", "circular_spline")
IN, WG, X2, Y1, Y2, OUT = range(6)


def aligned(_: float) -> tuple[float, float]:
    """No kinematic error."""
    return 0.0, 0.0


@dataclass(frozen=True)
class Spring:
    """k (1 + sum of a sin(h theta + phi)) and c, in N.m/rad and N.m.s/rad, or N/m and N.s/m; theta: theta_in or theta_WG."""

    k: float
    c: float = 0.0
    order: tuple[float, ...] = ()
    amplitude: tuple[float, ...] = ()
    phase: tuple[float, ...] = ()

    def factor(self, theta: float) -> tuple[float, float]:
        """That of k, and its slope over the angle."""
        factor, slope = 1.0, 0.0
        for h, a, phi in zip(self.order, self.amplitude, self.phase, strict=True):
            factor += a * sin(h * theta + phi)
            slope += a * h * cos(h * theta + phi)
        return factor, slope


@dataclass(frozen=True)
class Gear:
    """Document A's numbers; tau is positive in both orientations: theta_in / theta_out, without its sign.

    e_WG: theta_WG -> kinematic error as a radial displacement [m], and its slope over the angle [m/rad]; varies_with: the angle
    that each spring varies with.
    """

    K_WG: Spring
    K_b: Spring
    K_t: Spring
    K_m: Spring
    K_CS: Spring
    J_WG: float  # kg.m2
    J_FS: float  # kg.m2, of the tangential motion
    J_CS: float  # kg.m2
    radial_mass: float  # kg; the document has J_FS / r_g^2
    tau: float = 101.0
    r_g: float = 0.025  # m
    alpha_t: float = field(default=np.pi / 6.0)  # rad
    fixed: Literal["flexspline", "circular_spline"] = "flexspline"
    e_WG: Callable[[float], tuple[float, float]] = aligned
    varies_with: tuple[int, int, int, int, int] = (WG, WG, WG, WG, WG)

    @property
    def alpha_n(self) -> float:
        """Of the cam, that makes the ratio tau."""
        return atan(1.0 / (self.tau * tan(self.alpha_t)))

    @property
    def springs(self) -> tuple[Spring, ...]:
        return self.K_WG, self.K_b, self.K_t, self.K_m, self.K_CS


def masses(gear: Gear, J_in: float, J_out: float) -> Array:
    """Of the six coordinates, kg.m2 and kg."""
    r2 = gear.r_g**2
    return np.array([J_in, gear.J_WG, gear.radial_mass, gear.J_FS / r2, gear.J_CS / r2, J_out])


def gradients(gear: Gear) -> Array:
    """Of the deformations of the springs over the coordinates, aligned; shape (5, 6)."""
    r, s, c = gear.r_g, sin(gear.alpha_t), cos(gear.alpha_t)
    by_flexspline = 0.0 if gear.fixed == "flexspline" else 1.0
    rows = np.zeros((5, 6))
    rows[0, [IN, WG]] = 1.0, -1.0
    rows[1, [WG, X2]] = r * tan(gear.alpha_n), -1.0
    rows[2, [Y1, OUT]] = 1.0 / r, by_flexspline
    rows[3, [X2, Y1, Y2]] = s, -c, -c
    rows[4, [Y2, OUT]] = 1.0 / r, by_flexspline - 1.0
    return rows


@dataclass(frozen=True)
class Deformed:
    """The springs in a state: deformations, their gradients, elastic and damping forces, and energies; shapes (5,), (5, 6)."""

    deformation: Array
    rate: Array
    gradient: Array
    elastic: Array
    damping: Array
    over_angle: Array  # N.m, of the variation of each spring: 1/2 d^2 dk/dtheta

    @property
    def force(self) -> Array:
        return self.elastic + self.damping

    @property
    def stored(self) -> float:
        """Energy, J."""
        return 0.5 * float(self.elastic @ self.deformation)

    @property
    def lost(self) -> float:
        """Power that becomes heat, W; never negative."""
        return float(self.damping @ self.rate)


def deformed(gear: Gear, q: Array, v: Array) -> Deformed:
    e, slope = gear.e_WG(q[WG])
    gradient = gradients(gear)
    deformation = gradient @ q
    deformation[1] += e
    gradient[1, WG] += slope
    factors, slopes = np.array(
        [spring.factor(q[angle]) for spring, angle in zip(gear.springs, gear.varies_with, strict=True)]
    ).T
    k, c = np.array([spring.k for spring in gear.springs]), np.array([spring.c for spring in gear.springs])
    rate = gradient @ v
    return Deformed(
        deformation, rate, gradient, k * factors * deformation, c * rate, 0.5 * k * slopes * deformation * deformation
    )


def corrected(gear: Gear, q: Array, v: Array) -> Array:
    """Generalised forces of the gear on the six coordinates, by the Lagrangian."""
    state = deformed(gear, q, v)
    forces = -state.gradient.T @ state.force
    np.subtract.at(forces, list(gear.varies_with), state.over_angle)
    return forces


@dataclass(frozen=True)
class Form:
    """Three terms of Eq. 1.

    lever: of F_b on the wave generator over r_g, by alpha_n; mesh_rate: share of dx2/dt in the rate of the mesh, by alpha_t;
    reaction: that of the kinematic error, 1 or 0.
    """

    lever: Callable[[float], float]
    mesh_rate: Callable[[float], float]
    reaction: float


PRINTED = Form(lambda alpha_n: sin(alpha_n) * cos(alpha_n), lambda alpha_t: 1.0, 0.0)
RIGHT = Form(tan, sin, 1.0)


def printed(gear: Gear, q: Array, v: Array, form: Form = PRINTED) -> Array:
    """Generalised forces of the gear on the six coordinates, by Eq. 1 line by line; with the flexspline fixed, even springs."""
    r, s, c = gear.r_g, sin(gear.alpha_t), cos(gear.alpha_t)
    _, theta_WG, x2, y1, y2, _ = q
    _, dtheta_WG, dx2, dy1, dy2, _ = v
    x1, dx1 = r * tan(gear.alpha_n) * theta_WG, r * tan(gear.alpha_n) * dtheta_WG  # E-A1
    theta_CS, dtheta_CS = y2 / r, dy2 / r  # E-A1
    e, slope = gear.e_WG(theta_WG)
    T_WG = gear.K_WG.k * (q[IN] - theta_WG) + gear.K_WG.c * (v[IN] - dtheta_WG)
    F_b = gear.K_b.k * (e + x1 - x2) + gear.K_b.c * (slope * dtheta_WG + dx1 - dx2)
    F_m = gear.K_m.k * (x2 * s - (y1 + y2) * c) + gear.K_m.c * (form.mesh_rate(gear.alpha_t) * dx2 - (dy1 + dy2) * c)
    T_CS = gear.K_CS.k * (theta_CS - q[OUT]) + gear.K_CS.c * (dtheta_CS - v[OUT])
    T_FS_WG = F_b * (r * form.lever(gear.alpha_n) + form.reaction * slope)
    T_FS_CS = F_m * r * c
    held = (gear.K_t.k * y1 + gear.K_t.c * dy1) / r**2
    return np.array([-T_WG, T_WG - T_FS_WG, F_b - F_m * s, F_m * c - held, (T_FS_CS - T_CS) / r, T_CS])


Forces = Callable[[Gear, Array, Array], Array]
Outside = Callable[[float, float, float], float]  # time, angle, speed -> torque that drives the shaft forwards [N.m]


def rates(
    gear: Gear, J_in: float, J_out: float, motor: Outside, load: Outside, forces: Forces = corrected
) -> Callable[[float, Array], Array]:
    """Right-hand side for the state: six coordinates and their six rates."""
    m = masses(gear, J_in, J_out)

    def rates(time: float, y: Array) -> Array:
        q, v = y[:6], y[6:]
        acting = forces(gear, q, v)
        acting[IN] += motor(time, q[IN], v[IN])
        acting[OUT] += load(time, q[OUT], v[OUT])
        return np.concatenate([v, acting / m])

    return rates


def with_energies(
    gear: Gear, J_in: float, J_out: float, motor: Outside, load: Outside, forces: Forces = corrected
) -> Callable[[float, Array], Array]:
    """The same with two states more: the work of motor and load on the shafts, and what the dampers turn to heat by
    the dissipation function [J]."""
    inner = rates(gear, J_in, J_out, motor, load, forces)

    def outer(time: float, y: Array) -> Array:
        q, v = y[:6], y[6:12]
        work = motor(time, q[IN], v[IN]) * v[IN] + load(time, q[OUT], v[OUT]) * v[OUT]
        return np.append(inner(time, y[:12]), [work, deformed(gear, q, v).lost])

    return outer


def energy(gear: Gear, J_in: float, J_out: float, y: Array) -> float:
    """Kinetic and elastic, J."""
    q, v = y[:6], y[6:12]
    return 0.5 * float(masses(gear, J_in, J_out) @ v**2) + deformed(gear, q, v).stored


def outputs(gear: Gear, y: Array) -> dict[str, float]:
    """x1, x2, y1, y2 [m], F_b, F_m [N], and T_WG on the wave generator and T on the output shaft's coupling [N.m]."""
    q = y[:6]
    force = deformed(gear, q, y[6:12]).force
    on_output = -float(gradients(gear)[:, OUT] @ force)
    x1 = gear.r_g * tan(gear.alpha_n) * q[WG]
    return {
        "x1": x1,
        "x2": q[X2],
        "y1": q[Y1],
        "y2": q[Y2],
        "F_b": force[1],
        "F_m": force[3],
        "T_WG": force[0],
        "T": on_output,
    }


def stiffness_matrix(gear: Gear) -> Array:
    """Over the six coordinates, aligned and even, shape (6, 6)."""
    rows = gradients(gear)
    return rows.T @ (np.array([spring.k for spring in gear.springs])[:, None] * rows)


def damping_matrix(gear: Gear, form: Form = RIGHT) -> Array:
    """Over the six coordinates, aligned, shape (6, 6); where the mesh is damped as printed it is not symmetric."""
    rows = gradients(gear)
    damped = rows.copy()
    damped[3, X2] = form.mesh_rate(gear.alpha_t)
    return rows.T @ (np.array([spring.c for spring in gear.springs])[:, None] * damped)
