"""Orders that a strain wave gear may have, with their causes: wave generator, splines, and the balls of a bearing."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from strainwave.diagnose.refusals import JointRecording
from strainwave.messages import named
from strainwave.spline_orders import WAVE_ORDER, gear_facts, spline_orders, turning_spline_order

MAX_HARMONIC = 12  # of an order, up to which a cause is named
CRACK_MULTIPLES = {3.0: "third harmonic", 4.0: "fourth harmonic"}  # of a crack; the lower ones need long blocks to be separated
SPLINE_DAMAGE = {
    "flexspline": "a crack of the flexspline or its damaged teeth",
    "circular spline": "damaged teeth of the circular spline",
}
AGAINST_OTHER = "wave generator against the other spline"
BEARING_ELEMENTS = {"outer_ring": "outer ring", "inner_ring": "inner ring", "ball": "ball", "cage": "cage"}


@dataclass(frozen=True)
class NamedOrder:
    """An order that a strain wave gear may have.

    Attributes:
        order: per revolution of the shaft
        per_input: per revolution of the input
        name: its cause, in words
        of_error: True if a kinematic error has it; a bearing changes friction or stiffness instead, and the cause of an order
            that was asked for is not known
        is_multiple: True for a third or fourth multiple of a spline's order; a line that was found near it counts instead
    """

    order: float
    per_input: float
    name: str
    of_error: bool = True
    is_multiple: bool = False


def bearing_orders(bearings: Sequence[Any], kinematics: Any) -> dict[str, float]:
    """Return the orders per revolution of the input of damaged elements of bearings, by their names."""
    if not bearings:
        return {}
    facts = gear_facts(kinematics)
    if facts is None:
        raise ValueError("the orders of a bearing need a gear with teeth: its outer ring turns with the flexspline")
    orders = {}
    for number, bearing in enumerate(bearings, 1):
        place = "bearing" if len(bearings) == 1 else f"bearing {number}"
        for element, name in BEARING_ELEMENTS.items():
            (wave,) = bearing.replace(element=element, waves=1, friction_depth=1.0, stiffness_depth=0.0).changes(facts)
            orders[f"{place}, {name}"] = float(wave[-1])
    return orders


def named_orders(
    run: JointRecording, kinematics: Any, further: Sequence[float], bearings: Sequence[Any]
) -> tuple[NamedOrder, ...]:
    """Return the orders that a strain wave gear may have over the angle of a shaft; empty if its ratio is not known.

    Further orders are per revolution of the input; of bearings (`sw.fault.WaveGeneratorBearing`) the geometry counts.
    """
    if not np.isfinite(run.per_input):
        return ()
    orders = {
        "wave generator": WAVE_ORDER,
        "eccentricity of the wave generator": 1.0,
        "wave generator, second harmonic": 2.0 * WAVE_ORDER,
    }
    splines = spline_orders(kinematics)
    passes = turning_spline_order(kinematics)
    against = {} if passes is None else {AGAINST_OTHER: passes}
    # a crack has multiples of the order of the flexspline, which is that of the wave generator if the flexspline is fixed
    cracked = {"wave generator": WAVE_ORDER} if splines.get("flexspline") == WAVE_ORDER else {}
    multiples = {
        f"{name}, {harmonic}": times * order
        for name, order in (cracked | against).items()
        for times, harmonic in CRACK_MULTIPLES.items()
    }
    others = [*(("as asked", order) for order in further), *bearing_orders(bearings, kinematics).items()]
    return (
        *(NamedOrder(order * run.per_input, order, name) for name, order in (orders | against).items()),
        *(NamedOrder(order * run.per_input, order, name, of_error=False) for name, order in others),
        *(NamedOrder(order * run.per_input, order, name, is_multiple=True) for name, order in multiples.items()),
    )


def name_of(order: float, resolution: float, named: Sequence[NamedOrder]) -> str:
    """Return the names of an order of a shaft within the resolution, the nearest first; empty if it has none."""
    near = [each for each in named if abs(each.order - order) < resolution]
    return " or ".join(each.name for each in sorted(near, key=lambda each: abs(each.order - order)))


def causes(
    orders: Sequence[tuple[float, float]], per_input: float, kinematics: Any, bearings: Sequence[Any]
) -> tuple[str, ...]:
    """Return what orders of a shaft repeat with in a strain wave gear, a sentence for each cause.

    Each order per revolution of the shaft has the resolution with which it was found. `per_input` is the number of revolutions
    of the input per revolution of the shaft, nan if it is not known.
    """
    if not np.isfinite(per_input):
        return ()
    splines = spline_orders(kinematics)
    still = next((name for name, order in splines.items() if order == WAVE_ORDER), "")
    turning, passes = next(((name, order) for name, order in splines.items() if name != still), ("", 0.0))
    elements = bearing_orders(bearings, kinematics)
    by_cause = dict[str, list[str]]()
    for order, resolution in dict.fromkeys(orders):
        own, reach = order / per_input, resolution / per_input
        whole = _is_multiple(own, 1.0, reach)
        other = _is_multiple(own, passes, reach)
        names = [name for name, base in elements.items() if _is_multiple(own, base, reach)]
        if whole and other:
            cause = "of either spline, which this record does not separate: turn the output further"
        elif other:
            cause = f"passes of the wave generator over one place of the {turning}: {SPLINE_DAMAGE[turning]}"
        elif whole:
            damage = SPLINE_DAMAGE.get(still, "damage of the spline that does not turn")
            cause = f"whole multiples: misalignment or wear of the wave generator, {damage}"
        elif not splines:
            cause = "no whole multiples: the spline that turns, a bearing, the motor, or a resonance; give a gear with teeth"
        else:
            cause = "" if names else "of none of both splines: a bearing, the motor, or a resonance"
        cause = "; or ".join([*([cause] if cause else []), *names])
        by_cause.setdefault(cause, []).append(f"{own:.4g}")
    return tuple(f"{named('order', each)} of the input: {cause}" for cause, each in by_cause.items())


def _is_multiple(order: float, base: float, reach: float) -> bool:
    """Return True if an order is one of the first multiples of another."""
    times = round(order / base) if base > 0.0 else 0
    return 1 <= times <= MAX_HARMONIC and abs(order - times * base) < reach
