"""Laws of a gear by a table of finite elements or of a tooth-contact analysis, and what of the table they leave out."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from math import nan
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from strainwave import Gear, arguments, kinematic_error, stiffness, typeset, variation
from strainwave.equality import ComparedByFields
from strainwave.files.gear_set import GearSet, gear_set_of
from strainwave.files.mesh_table import QUANTITY_UNITS, MeshTable, ModeTable
from strainwave.messages import listed, shortened
from strainwave.orders.mesh.application import applied
from strainwave.orders.mesh.error import ErrorFit, error_fit, of_waves, strongest, variation_of_column
from strainwave.orders.mesh.harmonics import MAX_LOAD_SPREAD, Harmonics, check_repeats, complete_loads, harmonics
from strainwave.orders.mesh.spring import NAMED_DISAGREEMENT, spring_by_tangents, transmission_error
from strainwave.presentation import Pictured, Row, counted

if TYPE_CHECKING:
    from matplotlib.figure import Figure

Array = NDArray[np.float64]
Complex = NDArray[np.complex128]

MAX_ERROR_ORDERS = 16  # capacity of kinematic_error.Fourier
MAX_REPEATS = 100_000
NAMED_MISFIT = 0.25  # of the amplitude of an order, by which its change with the load is missed


@dataclass(frozen=True)
class MeshOrder:
    """Order of the transmission error.

    Attributes:
        order: periods per turn of the wave generator [1]
        amplitude: without load or at the one load chosen, at the output [rad]
        sigma: standard deviation of it, by the noise of the solver and by what the laws leave of this order over the loads
            [rad]; 0 if the table determines none
        phase: of it [rad], as of a sine
        share: part of all squares of the varying transmission error that this order has, mean over the loads [1]
    """

    order: float
    amplitude: float
    sigma: float
    phase: float
    share: float


@dataclass(frozen=True, eq=False)
class MeshLaws(ComparedByFields, Pictured):
    """Laws of a gear by a table of its mesh. A law is None if the table does not determine it.

    Attributes:
        kinematic_error: of the gear, in a Scaled if it falls with the load
        stiffness: Linear or ThreeSegment, of the whole gear at its output
        stiffness_variation: relative variation of this stiffness
        mesh_stiffness: of all engaged teeth along the line of action, mean over angle and load [N/m]
        mesh_variation: relative variation of it
        orders: in the kinematic error, the strongest first
        sensitivity_sigma: standard deviation of the load sensitivity, likewise [1/(N.m)]
        residual: root mean square of the transmission error that the laws do not explain [rad]; 0 without it
        explained_share: of the squares of the varying transmission error [1]
        source: of the table
        remarks: what is not determined, and what is left out
    """

    kinematic_error: Any = None
    stiffness: stiffness.Linear | stiffness.ThreeSegment | None = None
    stiffness_variation: variation.Periodic | None = None
    mesh_stiffness: float | None = None
    mesh_variation: variation.Periodic | None = None
    orders: tuple[MeshOrder, ...] = ()
    sensitivity_sigma: float = 0.0
    residual: float = 0.0
    explained_share: float = 0.0
    source: str = ""
    remarks: tuple[str, ...] = ()

    def applied_to(self, gear: GearSet | Gear | str, *, stages: Any = None, modes: ModeTable | None = None) -> GearSet:
        """Return the set of a gear with these laws; it keeps its other numbers.

        With stages the springs of a gear are in series. Its `stiffness` then takes the rest of the whole compliance: that of
        the table, or that which the gear had, if the table does not determine it.

        Args:
            gear: a set, a gear, or the name of a set of the catalogue
            stages: a `structure.Staged` for a gear that has none; its numbers are those of a calculation or assumed
            modes: of the ring, for a gear with stages

        Raises:
            ValueError: the mesh stiffness or the modes need stages that the gear does not have, or the stages alone are softer
                than the gear
        """
        return applied(self, gear_set_of(gear), stages, modes)

    def _headline(self) -> str:
        if self.orders:
            share = typeset.percent(self.explained_share)
            of_error = f"{counted(len(self.orders), 'order')}, {share} of the transmission error explained"
        else:
            of_error = "no orders of the error"
        return f"{of_error}; {self.source}"

    def _rows(self) -> Iterator[Row]:
        for order in self.orders:
            note = f"phase {typeset.number(float(np.degrees(order.phase)), 4)}°, {typeset.percent(order.share)} of the squares"
            yield Row(f"order {order.order:g}", order.amplitude, "rad", order.sigma or nan, note)
        if isinstance(self.kinematic_error, kinematic_error.Scaled):
            yield Row("load sensitivity", self.kinematic_error.load_sensitivity, "1/(N.m)", self.sensitivity_sigma or nan)
        if self.stiffness is not None:
            for name, kind, unit in ((field["name"], field["kind"], field["unit"]) for field in self.stiffness.fields):
                yield Row(f"stiffness {name}", getattr(self.stiffness, name), unit, note="" if kind == "number" else kind)
        if self.mesh_stiffness is not None:
            yield Row("mesh stiffness", self.mesh_stiffness, "N/m")
        for name in ("stiffness_variation", "mesh_variation"):
            if (law := getattr(self, name)) is not None:
                for order, amplitude in zip(law.order, law.amplitude, strict=True):
                    yield Row(f"{name.replace('_', ' ')}, order {order:g}", amplitude, "1")
        if self.orders:
            yield Row("not explained", self.residual, "rad", note="rms")

    def plot(self) -> Figure:
        """Return a figure of the amplitudes of the error without load over the order."""
        from strainwave.drawing.simple import Series, stems_figure

        if not self.orders:
            raise ValueError("the table determines no order of the error; there is nothing to draw")
        order, amplitude = (np.array([getattr(line, name) for line in self.orders]) for name in ("order", "amplitude"))
        return stems_figure(
            "Kinematic error without load", Series("order", "1", order), Series("amplitude at the output", "rad", amplitude)
        )


def mesh_laws(table: MeshTable, *, load: float | None = None, repeats: int = 1, false_alarm: float = 0.01) -> MeshLaws:
    """Return the laws of a gear that a table of its mesh determines.

    The means over the angle at two loads or more determine the spring, their orders the kinematic error. How the orders change
    with the load determines the fall of the error and the variation of the stiffness, if they are separable: at three loads or
    more, of both signs, or with the column `stiffness`. Orders that noise of the solver makes are left out.

    Args:
        table: of at least two angles per period of an order
        load: one of the loads of the table [N.m], at which alone the orders are fitted: for a spectrum at this load
        repeats: number of times that all repeats in a turn of the wave generator, 2 of two lobes that are alike: then the table
            needs part of a turn alone, and orders that are no multiples are 0 by this statement
        false_alarm: probability that noise makes an order

    Raises:
        ValueError: the angles determine no order, or one that contradicts `repeats`; the table has no such load; the
            transmission error falls as the torque rises, or its slope and the stiffness contradict each other

    >>> import numpy as np
    >>> import strainwave as sw
    >>> angle, torque = (grid.ravel() for grid in np.meshgrid(np.radians(np.arange(0.0, 360.0, 5.0)), [-30.0, 0.0, 30.0]))
    >>> error = (3e-4 * np.sin(2 * angle + 0.5) + 4e-5 * np.sin(4 * angle)) / (1 + 0.02 * abs(torque)) ** 2
    >>> table = sw.files.MeshTable(angle, torque, transmission_error=error + torque / 20e3)
    >>> laws = sw.orders.mesh_laws(table)
    >>> laws.kinematic_error.law.order, round(laws.kinematic_error.load_sensitivity, 3), round(laws.stiffness.k, -2)
    ((2.0, 4.0), 0.02, 20000.0)
    """
    if not isinstance(table, MeshTable):
        raise TypeError(f"table must be a MeshTable, as sw.files.MeshTable.read(...) gives one, not {shortened(table)}")
    repeats = arguments.whole("repeats", repeats, 1, MAX_REPEATS)
    allowed = arguments.probability("false_alarm", false_alarm)
    table, incomplete = complete_loads(table, repeats)
    names = [name for name in QUANTITY_UNITS if name in table.quantities]
    check_repeats(table, names[0], repeats)
    columns = {name: harmonics(table, name, repeats) for name in names}
    error, column, of_mesh = (columns.get(name) for name in QUANTITY_UNITS)
    loads = slice(None) if load is None else _chosen(columns[names[0]].torque, load)
    given, of_teeth = (variation_of_column(name, columns.get(name), allowed) for name in ("stiffness", "mesh_stiffness"))
    over_loads = []
    if of_mesh is not None and np.ptp(of_mesh.mean) > NAMED_DISAGREEMENT * of_mesh.mean.min():
        low, high = (typeset.quantity(float(end), "N/m") for end in (of_mesh.mean.min(), of_mesh.mean.max()))
        over_loads = [f"over the loads the mesh stiffness is {low} to {high}: the mean is in the model"]
    laws = MeshLaws(
        stiffness=None if column is None else spring_by_tangents(column),
        stiffness_variation=given[0],
        mesh_stiffness=None if of_mesh is None else float(of_mesh.mean.mean()),
        mesh_variation=of_teeth[0],
        source=table.source,
        remarks=(*incomplete, *columns[names[0]].remarks, *given[1], *of_teeth[1], *over_loads),
    )
    if error is None:
        return laws
    return _with_error(laws, table, error, loads, error_fit(error, column, given[0], loads, allowed))


def _chosen(torque: Array, load: float) -> slice:
    """Return the place of a load."""
    wanted = arguments.number("load", load, "N.m")
    place = int(np.argmin(np.abs(torque - wanted)))
    if abs(torque[place] - wanted) > MAX_LOAD_SPREAD * float(np.abs(torque).max()):
        raise ValueError(f"load is {wanted:g} N.m; the table has {listed(f'{other:g}' for other in torque.tolist())} N.m")
    return slice(place, place + 1)


def _with_error(laws: MeshLaws, table: MeshTable, error: Harmonics, loads: slice, fit: ErrorFit) -> MeshLaws:
    """Return the laws with those of the transmission error."""
    (chosen, rest), sensitivity = strongest(fit.error, MAX_ERROR_ORDERS), fit.orders.sensitivity
    law: Any = kinematic_error.Fourier(**of_waves(error.orders, fit.error, chosen))
    of_error, factor = np.asarray(law.error(table.angle)), fit.factor(table.angle)
    load = np.searchsorted(0.5 * (error.torque[1:] + error.torque[:-1]), table.torque)
    measured = np.asarray(table.transmission_error)
    left = measured - transmission_error(fit.spring, of_error, sensitivity, factor, table.torque)
    left -= (np.bincount(load, left) / np.bincount(load))[load]
    rows = np.isin(load, np.arange(len(error.torque))[loads])
    squares, unexplained = (float(np.mean(of[rows] ** 2)) for of in (measured - error.mean[load], left))
    power = np.mean(np.abs(error.waves[loads]) ** 2, axis=0)
    columns = error.orders, np.abs(fit.error), fit.orders.sigma, np.angle(fit.error), power / max(power.sum(), 1e-300)
    return replace(
        laws,
        kinematic_error=kinematic_error.Scaled(law=law, load_sensitivity=sensitivity) if sensitivity else law,
        stiffness=fit.spring,
        stiffness_variation=fit.variation,
        orders=tuple(MeshOrder(*row) for row in np.transpose(columns)[chosen].tolist()),
        sensitivity_sigma=fit.orders.sigmas[0],
        residual=float(np.sqrt(unexplained)),
        explained_share=1.0 - unexplained / squares if squares > 0.0 else 0.0,
        remarks=(*laws.remarks, *fit.remarks, *fit.orders.remarks, *_of_orders(error, np.abs(fit.error), fit, rest)),
    )


def _of_orders(error: Harmonics, amplitude: Array, fit: ErrorFit, rest: NDArray[np.int_]) -> Iterator[str]:
    """Yield remarks on orders that change with the load by other laws, that noise hides, or that a law has no room for."""
    missed = error.orders[(amplitude > 0.0) & (fit.orders.misfit > NAMED_MISFIT * amplitude)].tolist()
    if missed:
        missing = f"it misses that of order {listed(f'{order:g}' for order in missed)} by a quarter of the amplitude or more"
        yield f"the fall is one number for all orders; {missing}: for a spectrum at one load choose it by load="
    if (hidden := int(np.sum(amplitude == 0.0))) and error.noise > 0.0:
        size = typeset.quantity(error.noise, "rad")
        within = f"{counted(hidden, 'order')} of {len(error.orders)} are within the noise of the solver"
        yield f"{within}, {size} of amplitude at a load, and left out"
    if len(rest):
        size = typeset.quantity(float(amplitude[rest].max()), "rad")
        yield f"a law has {MAX_ERROR_ORDERS} orders; {counted(len(rest), 'order')} of up to {size} left out"
