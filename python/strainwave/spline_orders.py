"""Orders of the two splines of a strain wave gear, by the kinematics of its faults."""

from __future__ import annotations

from typing import Any

from strainwave import fault

TEETH = ("flexspline_teeth", "circular_spline_teeth")
WAVE_ORDER = 2.0  # passes of the two lobes over a fixed place, per revolution of the input
SPLINES = {"flexspline": "flexspline", "circular_spline": "circular spline"}  # name in the gear, and in words


def spline_orders(kinematics: Any) -> dict[str, float]:
    """Return the order per revolution of the input at which lobes pass one place of each spline; empty without teeth.

    It is 2 for the fixed spline. For the other one it is 2 z_c / z_f if the circular spline is fixed, 2 z_f / z_c if the
    flexspline is.

    Args:
        kinematics: of the gear; None if it is not known

    >>> from strainwave.kinematics import StrainWave
    >>> spline_orders(StrainWave(flexspline_teeth=200, circular_spline_teeth=202, fixed="circular_spline"))
    {'flexspline': 2.02, 'circular spline': 2.0}
    """
    facts = gear_facts(kinematics)
    if facts is None:
        return {}
    worn = {words: fault.ToothWear(spline=name).changes(facts) for name, words in SPLINES.items()}
    return {words: float(changes[-1][-1]) for words, changes in worn.items()}


def turning_spline_order(kinematics: Any) -> float | None:
    """Return the order of the spline that turns, per revolution of the input; None if the teeth are not known."""
    return next((order for order in spline_orders(kinematics).values() if order != WAVE_ORDER), None)


def gear_facts(kinematics: Any) -> fault.Facts | None:
    """Return the facts of a gear that its faults need; None if its teeth are not known."""
    if not all(getattr(kinematics, name, 0) for name in TEETH):
        return None
    return fault.Facts(**{name: getattr(kinematics, name) for name in (*TEETH, "fixed", "ratio")})
