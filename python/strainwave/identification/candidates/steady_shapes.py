"""Shapes of steady friction over the speed, the load, the temperature and the angle, to which a table is fitted."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from itertools import product
from typing import Any

import numpy as np
from numpy.typing import NDArray

from strainwave import friction
from strainwave.identification.experiments.friction_table import FrictionTable, varies
from strainwave.statistics.linear_fit import amplitudes_of, order_waves, solved
from strainwave.statistics.residuals import chance_of_gain

Array = NDArray[np.float64]

STRIBECK_GRID = 16  # tried between the slowest and the fastest measured
EXPONENT_GRID = (0.3, 0.5, 0.7, 1.4, 2.0)  # of a curved viscous part, tried
MIN_SPEEDS_EACH_WAY = 3  # for numbers of its own for each direction
MIN_SPEED_SPAN = 3.0  # fastest over slowest: within less a curve looks straight
MIN_TEMPERATURE_SPAN = 2.0  # K
MAX_ORDER = 8  # of the turn
MAX_CHANCE_OF_HARMONIC = 1e-3  # probability that chance alone gives a harmonic, over all orders
MAX_WAVES = 4  # harmonics in a law
SPEED_TOLERANCE = 0.02  # relative: speeds that differ by less are one
MAX_MAP_SPEEDS, MAX_MAP_LEVELS = 8, 128  # of a map
QUADRANTS = ("driving_forward", "driving_reverse", "backdriving_forward", "backdriving_reverse")
MIN_LOAD = 0.1  # of the largest load: smaller loads determine no loss
MIN_ROWS_PER_QUADRANT = 3
MAX_CELLS = 12  # of a turn
MIN_SAMPLES_PER_CELL = 8  # on average


@dataclass(frozen=True)
class Shape:
    """A law to start from, and the numbers of it that a table shall determine.

    Attributes:
        name: what it describes
        law: the law at its start
        free: paths of its free numbers, the dry torque first
        mesh: the friction of the mesh at its start; None keeps that of the gear
        losses: names of the free ratios of `mesh`
        ties: names of ratios of `mesh` that follow a free one
    """

    name: str
    law: Any
    free: tuple[str, ...]
    mesh: Any = None
    losses: tuple[str, ...] = ()
    ties: Mapping[str, str] = field(default_factory=dict)

    @property
    def paths(self) -> list[str]:
        """Paths of the free numbers in a gear."""
        return [*(f"friction_input.{path}" for path in self.free), *(f"friction_mesh.{name}" for name in self.losses)]

    @property
    def followers(self) -> dict[str, str]:
        """Paths in a gear that follow a free one, and its path."""
        return {f"friction_mesh.{name}": f"friction_mesh.{other}" for name, other in self.ties.items()}

    def around(self, name: str, outer: type[Any], free: tuple[str, ...], **members: Any) -> Shape:
        """Return the shape, modulated by another law."""
        inner = tuple(f"law.{path}" for path in self.free)
        return replace(self, name=f"{self.name}, {name}", law=outer(law=self.law, **members), free=(*inner, *free))


def over_speed(table: FrictionTable) -> Iterator[Shape]:
    """Yield the shapes over the speed, simplest first, as far as a table has enough speeds to fit and to validate them."""
    speeds, span = len(np.unique(table.speed)), float(np.abs(table.speed).max() / np.abs(table.speed).min())
    both_ways = min(len(np.unique(table.speed[side])) for side in (table.speed < 0.0, table.speed > 0.0)) >= MIN_SPEEDS_EACH_WAY
    for curved, falls in product((False, True), (False, True)):
        shape = _started(table, curved=curved, falls=falls)
        simple = not (curved or falls)
        if curved and span < MIN_SPEED_SPAN:
            continue
        if simple or speeds > len(shape.free) + 2:
            yield shape
        if both_ways and speeds > len(shape.free) + 4:
            yield shape.around("asymmetric", friction.Asymmetric, ("dry_asymmetry", "viscous_asymmetry"))


def _started(table: FrictionTable, *, curved: bool, falls: bool) -> Shape:
    """Return a shape at the best of a grid of speeds and exponents, the rest by least squares (GolubPereyra1973)."""
    speed, torque = np.abs(table.speed), np.sign(table.speed) * table.torque
    fastest = float(speed.max())
    grid = list(
        product(np.geomspace(speed.min(), fastest, STRIBECK_GRID) if falls else (fastest,), EXPONENT_GRID if curved else (1.0,))
    )
    shapes = [
        np.stack([np.ones_like(speed), (speed / fastest) ** p, *([np.exp(-((speed / v_s) ** 2))] if falls else [])], axis=1)
        for v_s, p in grid
    ]
    coefficients = np.array([solved(columns, torque) for columns in shapes])
    left = np.array([np.sum((columns @ each - torque) ** 2) for columns, each in zip(shapes, coefficients, strict=True)])
    possible = np.all(coefficients >= 0.0, axis=1)
    best = int(np.argmin(np.where(possible, left, np.inf) if possible.any() else left))
    least = 1e-3 * float(np.abs(torque).max())
    coulomb, viscous, *excess = np.maximum(coefficients[best], 0.0).tolist()
    coulomb = max(coulomb, least)
    v_s, p = map(float, grid[best])
    higher = coulomb + max(excess[0], 0.1 * coulomb) if falls else 0.0  # which counts as coulomb
    fall = {"breakaway": higher} | ({"stribeck_speed": v_s} if falls else {})
    fell = ("breakaway", "stribeck_speed") if falls else ()
    if curved:
        law = friction.CurvedViscous(
            coulomb=coulomb, viscous_torque=max(viscous, least), exponent=p, reference_speed=fastest, **fall
        )
        name = "curved viscous, with a fall at low speed" if falls else "curved viscous"
        return Shape(name, law, ("coulomb", *fell, "viscous_torque", "exponent"))
    if falls:
        return Shape(
            "with a fall at low speed",
            friction.Stribeck(coulomb=coulomb, viscous=viscous / fastest, **fall),
            ("coulomb", *fell, "viscous"),
        )
    return Shape(
        "Coulomb and viscous", friction.Coulomb(coulomb=coulomb, viscous=viscous / fastest, **fall), ("coulomb", "viscous")
    )


def with_conditions(table: FrictionTable, shape: Shape, residual: Array) -> Iterator[Shape]:
    """Yield variations of a shape over the other quantities that a table has.

    Args:
        table: the measurement
        shape: the shape over the speed, its law as fitted
        residual: measured less fitted torque [N.m], shape (n,)
    """
    if table.temperature is not None and np.ptp(table.temperature) > MIN_TEMPERATURE_SPAN:
        middle = float(np.mean(table.temperature))
        yield shape.around("over the temperature", friction.Thermal, ("dry_fall", "viscous_fall"), reference_temperature=middle)
        yield from _lubricated(
            shape, table, "lubricated over the temperature", viscosity_fall=0.01, reference_temperature=middle
        )
    if is_loaded(table) and table.load is not None:
        without = replace(shape, name=shape.name.partition(", loss")[0], mesh=None, losses=(), ties={})
        yield from _lubricated(without, table, "over the load", load_sensitivity=0.1 / float(np.abs(table.load).max()))
    if table.angle is not None:
        if waves := harmonics_of(table, residual):
            order, amplitude, phase = map(list, zip(*waves, strict=True))
            free = tuple(f"{name}[{i}]" for name in ("amplitude", "phase") for i in range(len(order)))
            yield shape.around("over the angle", friction.Cyclic, free, order=order, amplitude=amplitude, phase=phase)
        yield from _map(table, table.angle)


def is_loaded(table: FrictionTable) -> bool:
    """True if the table has loads of different size."""
    return table.load is not None and varies(table.load)


def quadrants(table: FrictionTable, ratio: float) -> tuple[str, ...]:
    """Return the ratios of `friction.LoadDependent` at the mesh that the loads of a table determine.

    Args:
        table: speeds and loads of the input
        ratio: of the gear, negative if the output turns the other way
    """
    assert table.load is not None
    heavy = np.abs(table.load) > MIN_LOAD * np.abs(table.load).max()
    driving, forward = table.load * table.speed > 0.0, ratio * table.speed > 0.0
    rows = {
        f"{power}_{way}": int(np.sum(heavy & one & other))
        for power, one in (("driving", driving), ("backdriving", ~driving))
        for way, other in (("forward", forward), ("reverse", ~forward))
    }
    return tuple(name for name, count in rows.items() if count >= MIN_ROWS_PER_QUADRANT)


def alike(quadrant: str, measured: Sequence[str]) -> str:
    """Return the measured quadrant that is most like one: itself, else the other sense of the same flow of power, else any."""
    power = quadrant.partition("_")[0]
    return next((each for each in measured if each.startswith(power)), measured[0])


def under_load(table: FrictionTable, ratio: float) -> Iterator[Shape]:
    """Yield shapes over the speed with a loss in proportion to the load: one ratio, one each way of the power, one a quadrant.

    Quadrants without loads take no part.
    """
    measured = quadrants(table, ratio)
    if not measured or table.load is None:
        return
    way, size = np.sign(table.speed), np.abs(table.load)
    columns = np.stack([np.ones_like(size), np.abs(table.speed), size], axis=1)
    loss = float(np.clip(solved(columns, way * table.torque)[2], 1e-3, 1.0))
    alone = replace(table, torque=table.torque - way * loss * size)
    mesh = friction.LoadDependent(**dict.fromkeys(QUADRANTS, loss))
    tried = {
        "loss under load": dict.fromkeys(measured, measured[0]),
        "losses of driving and back-driving": {name: alike(name, measured) for name in measured},
        "losses of each quadrant": {name: name for name in measured},
    }
    before = list[dict[str, str]]()
    for name, leads in tried.items():
        if leads not in before:
            before.append(leads)
            ties = {each: lead for each, lead in leads.items() if each != lead}
            for shape in over_speed(alone):
                losses = tuple(dict.fromkeys(leads.values()))
                yield replace(shape, name=f"{shape.name}, {name}", mesh=mesh, losses=losses, ties=ties)


def _lubricated(shape: Shape, table: FrictionTable, name: str, **changed: float) -> Iterator[Shape]:
    """Yield the friction of a bearing on which load and viscosity act; the first number changed is free."""
    outer = shape.law if isinstance(shape.law, friction.Asymmetric) else None
    law = shape.law if outer is None else outer.law
    if isinstance(law, friction.Stribeck):
        fall = {"breakaway": law.breakaway, "stribeck_speed": law.stribeck_speed}
    elif isinstance(law, friction.Coulomb) and "viscosity_fall" in changed:  # without a fall a load acts as a loss of the mesh
        fall = {"breakaway": 0.0, "stribeck_speed": 1e-3 * float(np.abs(table.speed).min())}
    else:
        return
    mixed = friction.MixedLubrication(coulomb=law.coulomb, viscous=law.viscous, **(fall | changed))
    (free_number, *_), inner = changed, "" if outer is None else "law."
    law, free = mixed if outer is None else outer.replace(law=mixed), (*shape.free, inner + free_number)
    yield replace(shape, name=f"{shape.name}, {name}", law=law, free=free)


def _map(table: FrictionTable, angle: Array) -> Iterator[Shape]:
    """Yield a map over angle and speed, if few speeds were measured and many samples at each."""
    speed, level = np.abs(table.speed), np.sign(table.speed) * table.torque
    ordered = np.sort(speed)
    group = np.searchsorted(ordered[1:][np.diff(ordered) > SPEED_TOLERANCE * ordered[1:]], speed, "right")
    speeds = [float(speed[group == k].mean()) for k in range(group.max() + 1)]
    angles = min(MAX_CELLS, MAX_MAP_LEVELS // len(speeds), int(np.bincount(group).min()) // MIN_SAMPLES_PER_CELL)
    if len(speeds) > MAX_MAP_SPEEDS or angles < 3:
        return
    cell = np.rint(angle / (2.0 * np.pi) * angles).astype(int) % angles
    means = [float(level[group == k].mean()) for k in range(len(speeds))]
    levels = [
        max(float(level[here].mean()) if np.any(here := (group == k) & (cell == j)) else means[k], 0.0)
        for k in range(len(speeds))
        for j in range(angles)
    ]
    yield Shape("map over angle and speed", friction.AngleSpeedMap(speed=speeds, level=levels), ("level",))


def harmonics_of(table: FrictionTable, residual: Array) -> list[tuple[float, float, float]]:
    """Return orders, amplitudes relative to the mean, and phases [rad] of friction over the turn that chance does not explain.

    Whole orders are added one by one, each time the one that explains most of the rest, until chance explains as much (F test,
    its probability times the count of orders).
    """
    assert table.angle is not None
    mean = table.torque - residual
    pairs = {n: mean[:, np.newaxis] * order_waves(table.angle, [n]) for n in range(1, MAX_ORDER + 1)}
    orders: list[int] = []
    waves, left = np.zeros(0), float(np.sum(residual**2))
    while len(orders) < MAX_WAVES:
        tried = {n: _explained(residual, [pairs[each] for each in (*orders, n)]) for n in pairs if n not in orders}
        order, (coefficients, still) = min(tried.items(), key=lambda item: item[1][1])
        if MAX_ORDER * chance_of_gain(left, still, 2, len(residual) - len(coefficients)) > MAX_CHANCE_OF_HARMONIC:
            break
        orders, waves, left = [*orders, order], coefficients, still
    return sorted(zip(map(float, orders), *(each.tolist() for each in amplitudes_of(waves)), strict=True))


def _explained(residual: Array, pairs: list[Array]) -> tuple[Array, float]:
    """Return the factors of the columns of all pairs, and the sum of squares left."""
    columns = np.hstack(pairs)
    coefficients = solved(columns, residual)
    return coefficients, float(np.sum((residual - columns @ coefficients) ** 2))
