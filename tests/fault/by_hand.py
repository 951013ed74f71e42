"""What tests of faults share: facts of gears, and the motion of their members from the equation of the three speeds."""

from __future__ import annotations

from strainwave import fault

REVERSING = fault.Facts(flexspline_teeth=200, circular_spline_teeth=202, fixed="circular_spline", ratio=-100.0)
FOLLOWING = fault.Facts(flexspline_teeth=200, circular_spline_teeth=202, fixed="flexspline", ratio=101.0)


def speeds(facts: fault.Facts) -> dict[str, float]:
    """Speed of each spline at input speed 1, from z_c w_c - z_f w_f = (z_c - z_f) w_w."""
    z_f, z_c = facts.flexspline_teeth, facts.circular_spline_teeth
    if facts.fixed == "circular_spline":
        return {"circular_spline": 0.0, "flexspline": -(z_c - z_f) / z_f}
    return {"circular_spline": (z_c - z_f) / z_c, "flexspline": 0.0}


def waves(law: object, facts: fault.Facts, place: str) -> list[tuple[float, float, float]]:
    """Order, amplitude and phase of the waves that a fault adds at a place."""
    listed = law.changes(facts)  # type: ignore[attr-defined]
    return [(order, value, phase) for where, _, kind, value, _, _, phase, order in listed if (where, kind) == (place, "wave")]
