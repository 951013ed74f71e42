"""The strain wave gear of tests/support/actuator_equations.py with modes of its flexspline's ring, for SciPy to integrate.

Each mode is a pair of coordinates (a, b) [m] in the frame of the flexspline, so that nothing here turns with the lobes. To the
energies there come, for each mode of n waves,

    T = 1/2 m (a'^2 + b'^2),   V = 1/2 m omega^2 (a^2 + b^2),   dissipation function 1/2 2 zeta omega m (a'^2 + b'^2)

and the mesh is deformed by less:  d = x2 sin(alpha_t) - (y1 + y2) cos(alpha_t) - u,  with u the sum of a cos(n theta) +
b sin(n theta), theta = theta_WG with the flexspline fixed, theta_WG (1 + 1/tau) with the circular spline fixed: the flexspline
turns backwards.
"""

# ruff: noqa: N803 - the document's symbols

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tests.support.actuator_equations import WG, Gear, Outside, deformed, gradients, masses

Array = NDArray[np.float64]
MESH = 3  # among the springs


@dataclass(frozen=True)
class Ring:
    """Modes; each array has the shape (modes,)."""

    omega: Array
    n: Array
    zeta: Array
    m: Array

    def gradient(self, gear: Gear, q: Array) -> Array:
        """Return the gradient of u over the six coordinates and the modes' a, then b; shape (6 + 2 modes,)."""
        per_angle = 1.0 if gear.fixed == "flexspline" else 1.0 + 1.0 / gear.tau
        count = len(self.n)
        phase = self.n * per_angle * q[WG]
        a, b = q[6 : 6 + count], q[6 + count :]
        found = np.zeros(6 + 2 * count)
        found[WG] = float((self.n * per_angle) @ (b * np.cos(phase) - a * np.sin(phase)))
        found[6 : 6 + count], found[6 + count :] = np.cos(phase), np.sin(phase)
        return found

    def displacement(self, gear: Gear, q: Array) -> float:
        return float(self.gradient(gear, q)[6:] @ q[6:])


def forces(gear: Gear, ring: Ring, q: Array, v: Array) -> tuple[Array, float]:
    """Return the generalised forces on all coordinates, and the force of the mesh [N]."""
    state = deformed(gear, q[:6], v[:6])
    of_ring = ring.gradient(gear, q)
    factor, slope = gear.K_m.factor(q[WG])
    deformation = state.deformation[MESH] - ring.displacement(gear, q)
    mesh = gear.K_m.k * factor * deformation + gear.K_m.c * (state.rate[MESH] - float(of_ring @ v))
    springs = state.force.copy()
    springs[MESH] = mesh
    over_angle = state.over_angle.copy()
    over_angle[MESH] = 0.5 * gear.K_m.k * slope * deformation**2
    found = of_ring * mesh
    found[:6] -= state.gradient.T @ springs
    np.subtract.at(found, list(gear.varies_with), over_angle)
    stiffness, damping = ring.m * ring.omega**2, 2.0 * ring.zeta * ring.omega * ring.m
    found[6:] -= np.tile(stiffness, 2) * q[6:] + np.tile(damping, 2) * v[6:]
    return found, mesh


def rates(gear: Gear, ring: Ring, J_in: float, J_out: float, motor: Outside, load: Outside):  # type: ignore[no-untyped-def]
    """Right-hand side for the state: coordinates, then their rates."""
    m = np.concatenate([masses(gear, J_in, J_out), np.tile(ring.m, 2)])
    count = len(m)

    def right(time: float, y: Array) -> Array:
        q, v = y[:count], y[count:]
        acting, _ = forces(gear, ring, q, v)
        acting[0] += motor(time, q[0], v[0])
        acting[5] += load(time, q[5], v[5])
        return np.concatenate([v, acting / m])

    return right


def stiffness_matrix(gear: Gear, ring: Ring) -> Array:
    """Over all coordinates at the angle 0, aligned and even."""
    rows = np.zeros((5, 6 + 2 * len(ring.n)))
    rows[:, :6] = gradients(gear)
    rows[MESH] -= ring.gradient(gear, np.zeros(rows.shape[1]))
    found = rows.T @ (np.array([spring.k for spring in gear.springs])[:, None] * rows)
    found[np.arange(6, len(found)), np.arange(6, len(found))] += np.tile(ring.m * ring.omega**2, 2)
    return np.asarray(found)
