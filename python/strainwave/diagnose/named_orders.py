"""Orders that a strain wave gear may have, with their causes: wave generator, splines, and the balls of a bearing."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from strainwave import fault
from strainwave.diagnose.refusals import WAVE_ORDER, JointRecording
from strainwave.messages import listed

MAX_HARMONIC = 12  # of an order, up to which a cause is named
TEETH = ("flexspline_teeth", "circular_spline_teeth")
ELEMENTS = {"outer_ring": "outer ring", "inner_ring": "inner ring", "ball": "ball", "cage": "cage"}


@dataclass(frozen=True)
class NamedOrder:
    """An order that a strain wave gear may have.

    Attributes:
        order: per revolution of the shaft
        per_input: per revolution of the input
        name: its cause, in words
        of_error: True if a kinematic error has it; a bearing changes friction or stiffness instead, and the cause of an order
            that was asked for is not known
    """

    order: float
    per_input: float
    name: str
    of_error: bool = True


def bearing_orders(bearings: Sequence[Any], kinematics: Any) -> dict[str, float]:
    """Return the orders per revolution of the input of damaged elements of bearings, by their names.

    Args:
        bearings: `sw.fault.WaveGeneratorBearing`, whose geometry counts
        kinematics: of the gear, whose teeth and fixed spline determine the speed of the outer ring

    Raises:
        ValueError: the gear has no teeth
    """
    if not bearings:
        return {}
    if not all(getattr(kinematics, name, 0) for name in TEETH):
        raise ValueError("the orders of a bearing need a gear with teeth: its outer ring turns with the flexspline")
    facts = fault.Facts(**{name: getattr(kinematics, name) for name in (*TEETH, "fixed", "ratio")})
    orders = {}
    for number, bearing in enumerate(bearings, 1):
        place = "bearing" if len(bearings) == 1 else f"bearing {number}"
        for element, name in ELEMENTS.items():
            (wave,) = bearing.replace(element=element, waves=1, friction_depth=1.0, stiffness_depth=0.0).changes(facts)
            orders[f"{place}, {name}"] = float(wave[-1])
    return orders


def named_orders(
    run: JointRecording, kinematics: Any, further: Sequence[float], bearings: Sequence[Any]
) -> tuple[NamedOrder, ...]:
    """Return the orders that a strain wave gear may have over the angle of a shaft; empty if its ratio is not known.

    Args:
        run: the recording
        kinematics: of the gear; None if it is not known
        further: orders per revolution of the input
        bearings: `sw.fault.WaveGeneratorBearing`, whose geometry counts
    """
    if not np.isfinite(run.per_input):
        return ()
    orders = {
        "wave generator": WAVE_ORDER,
        "eccentricity of the wave generator": 1.0,
        "wave generator, second harmonic": 2.0 * WAVE_ORDER,
    }
    flexible, circular = (getattr(kinematics, name, 0) for name in TEETH)
    if flexible and circular:
        passes = WAVE_ORDER * float(circular) / float(flexible)
        orders["wave generator against the other spline"] = passes
        # multiples of a crack; the first two differ too little from orders 2 and 4 to be separated in blocks of few turns
        orders |= {
            f"{name} against the other spline": k * passes for k, name in ((3.0, "third harmonic"), (4.0, "fourth harmonic"))
        }
    others = [*(("as asked", order) for order in further), *bearing_orders(bearings, kinematics).items()]
    return (
        *(NamedOrder(order * run.per_input, order, name) for name, order in orders.items()),
        *(NamedOrder(order * run.per_input, order, name, of_error=False) for name, order in others),
    )


def name_of(order: float, named: Sequence[NamedOrder], resolution: float) -> str:
    """Return the name of an order of a shaft; empty if it has none within the resolution."""
    near = min(named, key=lambda each: abs(each.order - order), default=None)
    return near.name if near is not None and abs(near.order - order) < resolution else ""


def causes(
    orders: Sequence[float], per_input: float, resolution: float, kinematics: Any, bearings: Sequence[Any]
) -> tuple[str, ...]:
    """Return what orders of a shaft repeat with in a strain wave gear, a sentence for each cause.

    Args:
        orders: per revolution of the shaft
        per_input: revolutions of the input per revolution of the shaft; nan if it is not known
        resolution: of the recording, in orders of the shaft
        kinematics: of the gear, whose teeth separate the splines; None if it is not known
        bearings: `sw.fault.WaveGeneratorBearing`, whose geometry counts
    """
    if not np.isfinite(per_input):
        return ()
    flexible, circular = (getattr(kinematics, name, 0) for name in TEETH)
    is_fixed = getattr(kinematics, "fixed", "") == "circular_spline"
    still, turning = ("circular spline", "flexspline") if is_fixed else ("flexspline", "circular spline")
    passes = (float(circular) / float(flexible)) ** (1.0 if is_fixed else -1.0) if circular and flexible else 0.0
    reach = resolution / per_input
    elements = bearing_orders(bearings, kinematics)
    by_cause = dict[str, list[str]]()
    for order in dict.fromkeys(orders):
        own = order / per_input
        whole = _is_multiple(own, 1.0, reach)
        other = _is_multiple(own, WAVE_ORDER * passes, reach)
        names = [name for name, base in elements.items() if _is_multiple(own, base, reach)]
        if whole and other:
            cause = "of either spline, which this record does not separate: turn the output further"
        elif other:
            cause = f"passes of the wave generator over one place of the {turning}: a crack, or damaged teeth there"
        elif whole:
            cause = f"whole multiples: misalignment or wear of the wave generator, or teeth of the {still}"
        else:
            cause = "" if names else "of none of both splines: a bearing, the motor, or a resonance"
        cause = "; or ".join([*([cause] if cause else []), *names])
        by_cause.setdefault(cause, []).append(f"{own:.4g}")
    return tuple(
        f"order{'s' if len(each) > 1 else ''} {listed(each)} of the input: {cause}" for cause, each in by_cause.items()
    )


def _is_multiple(order: float, base: float, reach: float) -> bool:
    """Return True if an order is one of the first multiples of another."""
    times = round(order / base) if base > 0.0 else 0
    return 1 <= times <= MAX_HARMONIC and abs(order - times * base) < reach
