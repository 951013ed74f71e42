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
from strainwave.orders.mesh.error import (
    ErrorFit,
    StiffnessVariation,
    error_fit,
    spring_by_tangents,
    transmission_error,
    twists_of,
)
from strainwave.orders.mesh.harmonics import MAX_LOAD_SPREAD, Harmonics, check_repeats, complete_loads, harmonics
from strainwave.presentation import Pictured, Row, counted

if TYPE_CHECKING:
    from matplotlib.figure import Figure

Array = NDArray[np.float64]
Complex = NDArray[np.complex128]

MAX_ERROR_ORDERS = 16  # capacity of kinematic_error.Fourier
MAX_REPEATS = 100_000
NAMED_DISAGREEMENT = 0.02  # relative, from which a difference is stated
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
        for each in self.orders:
            note = f"phase {typeset.number(float(np.degrees(each.phase)), 4)}°, {typeset.percent(each.share)} of the squares"
            yield Row(f"order {each.order:g}", each.amplitude, "rad", each.sigma or nan, note)
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
        order, amplitude = (np.array([getattr(each, name) for each in self.orders]) for name in ("order", "amplitude"))
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
    >>> angle, torque = (each.ravel() for each in np.meshgrid(np.radians(np.arange(0.0, 360.0, 5.0)), [-30.0, 0.0, 30.0]))
    >>> error = (3e-4 * np.sin(2 * angle + 0.5) + 4e-5 * np.sin(4 * angle)) / (1 + 0.02 * abs(torque)) ** 2
    >>> table = sw.files.MeshTable(angle, torque, transmission_error=error + torque / 20e3)
    >>> found = sw.orders.mesh_laws(table)
    >>> found.kinematic_error.law.order, round(found.kinematic_error.load_sensitivity, 3), round(found.stiffness.k, -2)
    ((2.0, 4.0), 0.02, 20000.0)
    """
    if not isinstance(table, MeshTable):
        raise TypeError(f"table must be a MeshTable, as sw.files.MeshTable.read(...) gives one, not {shortened(table)}")
    repeats = arguments.whole("repeats", repeats, 1, MAX_REPEATS)
    allowed = arguments.probability("false_alarm", false_alarm)
    table, incomplete = _complete(table, repeats)
    quantity = next(getattr(table, name) for name in QUANTITY_UNITS if name in table.quantities)
    check_repeats(table.angle, table.torque, quantity, repeats)
    error, of_spring, of_mesh = (
        None if (values := getattr(table, name)) is None else harmonics(table.angle, table.torque, values, repeats)
        for name in ("transmission_error", "stiffness", "mesh_stiffness")
    )
    first = next(each for each in (error, of_spring, of_mesh) if each is not None)
    loads = slice(None) if load is None else _chosen(first.torque, load)
    given, of_teeth = (
        None if found is None else StiffnessVariation.of_column(name, found, allowed)
        for name, found in (("stiffness", of_spring), ("mesh_stiffness", of_mesh))
    )
    laws = MeshLaws(
        stiffness_variation=None if given is None else given.law,
        mesh_stiffness=None if of_mesh is None else float(of_mesh.mean.mean()),
        mesh_variation=None if of_teeth is None else of_teeth.law,
        source=table.source,
        remarks=(
            *incomplete,
            *first.remarks,
            *(remark for each in (given, of_teeth) if each is not None for remark in each.remarks),
            *_over_loads(of_mesh),
        ),
    )
    if error is None:
        return laws if of_spring is None else replace(laws, stiffness=spring_by_tangents(of_spring).law)
    fit = error_fit(error, of_spring, given, loads, allowed)
    return _with_error(laws, table, error, loads, fit, tuple(_remarks(fit, error, of_spring)))


def _complete(table: MeshTable, repeats: int) -> tuple[MeshTable, tuple[str, ...]]:
    """Return a table without loads of which angles are missing, and remarks on them."""
    rows, remarks = complete_loads(table.angle, table.torque, repeats)
    if rows.all():
        return table, ()
    return replace(table, **{name: getattr(table, name)[rows] for name in ("angle", "torque", *table.quantities)}), remarks


def _chosen(torque: Array, load: float) -> slice:
    """Return the place of a load."""
    wanted = arguments.number("load", load, "N.m")
    place = int(np.argmin(np.abs(torque - wanted)))
    if abs(torque[place] - wanted) > MAX_LOAD_SPREAD * float(np.abs(torque).max()):
        raise ValueError(f"load is {wanted:g} N.m; the table has {listed(f'{each:g}' for each in torque.tolist())} N.m")
    return slice(place, place + 1)


# ---- Laws and remarks ------------------------------------------------------------------------------------------------


def _with_error(
    laws: MeshLaws, table: MeshTable, error: Harmonics, loads: slice, fit: ErrorFit, remarks: tuple[str, ...]
) -> MeshLaws:
    """Return the laws with those of the transmission error."""
    orders, left_out = _orders(error, loads, fit)
    ordered = sorted(orders, key=lambda each: each.order)
    law: Any = kinematic_error.Fourier(
        order=[each.order for each in ordered],
        amplitude=[each.amplitude for each in ordered],
        phase=[each.phase for each in ordered],
    )
    load = np.searchsorted(0.5 * (error.torque[1:] + error.torque[:-1]), table.torque)
    rows = np.isin(load, np.arange(len(error.torque))[loads])
    varying = np.asarray(table.transmission_error) - error.mean[load]
    left = varying - _predicted(table, law, fit)
    left = left - (np.bincount(load, left) / np.bincount(load))[load]
    squares, rest = float(np.mean(varying[rows] ** 2)), float(np.mean(left[rows] ** 2))
    return replace(
        laws,
        kinematic_error=law
        if fit.orders.sensitivity == 0.0
        else kinematic_error.Scaled(law=law, load_sensitivity=fit.orders.sensitivity),
        stiffness=None if fit.spring is None else fit.spring.law,
        stiffness_variation=fit.variation.law,
        orders=orders,
        sensitivity_sigma=fit.orders.sensitivity_sigma,
        residual=float(np.sqrt(rest)),
        explained_share=1.0 - rest / squares if squares > 0.0 else 0.0,
        remarks=(*laws.remarks, *remarks, *left_out),
    )


def _orders(error: Harmonics, loads: slice, fit: ErrorFit) -> tuple[tuple[MeshOrder, ...], list[str]]:
    """Return the orders of the error, the strongest first, and what is left out."""
    power = np.mean(np.abs(error.waves[loads]) ** 2, axis=0)
    present = np.flatnonzero(fit.orders.error)
    strongest = present[np.argsort(-np.abs(fit.orders.error[present]), kind="stable")]
    orders = tuple(
        MeshOrder(
            float(error.orders[each]),
            float(abs(fit.orders.error[each])),
            float(fit.orders.sigma[each]),
            float(np.angle(fit.orders.error[each])),
            float(power[each] / power.sum()),
        )
        for each in strongest[:MAX_ERROR_ORDERS].tolist()
    )
    rest = np.sort(strongest[MAX_ERROR_ORDERS:])
    if not len(rest):
        return orders, []
    size = typeset.quantity(float(np.abs(fit.orders.error[rest]).max()), "rad")
    return orders, [f"a law has {MAX_ERROR_ORDERS} orders; {counted(len(rest), 'order')} of up to {size} left out"]


def _predicted(table: MeshTable, law: Any, fit: ErrorFit) -> Array:
    """Return the transmission error of the laws [rad], shape (n,)."""
    error = np.asarray(law.error(table.angle))
    if fit.spring is None:
        return np.asarray(error / (1.0 + fit.orders.sensitivity * np.abs(table.torque)) ** 2)
    factor = np.ones(len(error)) if fit.variation.law is None else np.asarray(fit.variation.law.factor(table.angle))
    return transmission_error(fit.spring.law, error, fit.orders.sensitivity, factor, table.torque)


def _over_loads(of_mesh: Harmonics | None) -> Iterator[str]:
    """Yield a remark on a stiffness of the mesh that the model has at its mean over the loads."""
    if of_mesh is None:
        return
    low, high = float(of_mesh.mean.min()), float(of_mesh.mean.max())
    if high - low > NAMED_DISAGREEMENT * low:
        ends = f"{typeset.quantity(low, 'N/m')} to {typeset.quantity(high, 'N/m')}"
        yield f"over the loads the mesh stiffness is {ends}: the mean is in the model"


def _remarks(fit: ErrorFit, error: Harmonics, of_spring: Harmonics | None) -> Iterator[str]:
    """Yield all remarks on the fit of the transmission error."""
    yield from _of_spring(fit, error)
    yield from _of_slope(fit, error, of_spring)
    yield from fit.orders.remarks
    yield from _of_orders(error, fit)
    yield from _of_noise(error, fit)


def _of_spring(fit: ErrorFit, error: Harmonics) -> Iterator[str]:
    """Yield remarks on the spring."""
    loads = len(error.torque)
    if fit.spring is None and loads == 1:
        yield "one load does not determine the stiffness"
    elif not fit.wound and loads > 1:
        whose = "not determined" if fit.spring is None else "that of its column"
        yield f"the mean transmission error does not change with the load: the twist is not in it, and the stiffness is {whose}"
    elif fit.wound and loads == 2:
        yield "two loads determine a straight spring alone: whether it bends is not tested"
    if fit.wound and fit.spring is not None:
        share = fit.spring.residual / float(np.ptp(fit.spring.law.twist(error.torque)))
        if share > NAMED_DISAGREEMENT:
            yield f"the spring leaves {typeset.percent(share)} of the twist unexplained, as if the two senses differed"


def _of_slope(fit: ErrorFit, error: Harmonics, of_spring: Harmonics | None) -> Iterator[str]:
    """Yield a remark if the column stiffness and the slope of the transmission error differ."""
    if of_spring is None or not fit.wound:
        return
    twist, by_column = np.diff(error.mean), twists_of(of_spring)
    worst = int(np.argmax(np.abs(twist / by_column - 1.0)))
    if abs(twist[worst] / by_column[worst] - 1.0) > NAMED_DISAGREEMENT:
        low, high = error.torque[worst : worst + 2].tolist()
        by_error, by_table = ((high - low) / each[worst] for each in (twist, by_column))
        where, of_column = f"from {low:g} to {high:g} N.m", f"the column stiffness {by_table:.4g} N.m/rad"
        yield f"{where} the transmission error gives {by_error:.4g} N.m/rad, {of_column}: the former is in the model"


def _of_orders(error: Harmonics, fit: ErrorFit) -> Iterator[str]:
    """Yield a remark on orders that change with the load in another way than all together."""
    missed = error.orders[(np.abs(fit.orders.error) > 0.0) & (fit.orders.misfit > NAMED_MISFIT * np.abs(fit.orders.error))]
    if len(missed):
        names = listed(f"{order:g}" for order in missed.tolist())
        missing = f"it misses that of order {names} by a quarter of the amplitude or more"
        yield f"the fall is one number for all orders; {missing}: for a spectrum at one load choose it by load="


def _of_noise(error: Harmonics, fit: ErrorFit) -> Iterator[str]:
    """Yield a remark on orders that the noise of the solver hides."""
    left = len(error.orders) - int(np.count_nonzero(fit.orders.error))
    if left and error.noise > 0.0:
        hidden = f"{counted(left, 'order')} of {len(error.orders)} are within the noise of the solver"
        yield f"{hidden}, {typeset.quantity(error.noise, 'rad')} of amplitude at a load, and left out"
