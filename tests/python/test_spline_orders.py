"""Orders of the splines are those of the faults, whichever member is fixed."""

from __future__ import annotations

import pytest
import strainwave as sw
from strainwave.spline_orders import spline_orders, turning_spline_order

GEARS = {
    fixed: sw.kinematics.StrainWave(flexspline_teeth=200, circular_spline_teeth=202, fixed=fixed)
    for fixed in ("circular_spline", "flexspline")
}


def facts(fixed: str) -> sw.fault.Facts:
    return sw.fault.Facts(flexspline_teeth=200, circular_spline_teeth=202, fixed=fixed, ratio=GEARS[fixed].ratio)


@pytest.mark.parametrize(
    ("fixed", "orders"),
    [
        ("circular_spline", {"flexspline": 2.02, "circular spline": 2.0}),
        ("flexspline", {"flexspline": 2.0, "circular spline": 2.0 * 200.0 / 202.0}),
    ],
)
def test_the_turning_spline_has_the_order_that_the_relative_motion_gives(fixed: str, orders: dict[str, float]) -> None:
    assert spline_orders(GEARS[fixed]) == pytest.approx(orders, rel=1e-12)
    assert turning_spline_order(GEARS[fixed]) == pytest.approx(next(each for each in orders.values() if each != 2.0))
    crack = [change[-1] for change in sw.fault.FlexsplineCrack(waves=4).changes(facts(fixed))]
    assert crack == pytest.approx([k * orders["flexspline"] for k in range(5)])


def test_a_gear_without_teeth_has_no_orders_of_splines() -> None:
    for kinematics in (None, sw.kinematics.PlainRatio(reduction=100.0)):
        assert spline_orders(kinematics) == {}
        assert turning_spline_order(kinematics) is None
