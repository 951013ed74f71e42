"""The gear so far: what a file determines of it."""

from __future__ import annotations

import numpy as np
import pytest
import strainwave as sw
from strainwave.identification.reading.mapping import FileMapping
from strainwave.identification.results.file_result import FileEstimate
from strainwave.identification.results.gear_so_far import GearSoFar, geared


def test_an_estimate_that_is_no_number_of_the_gear_determines_none_of_it() -> None:
    """The amplitude of an order is compared between files; the gear has it as an element of a sequence."""
    before = sw.GearSet.read("csg-20-100")
    error = sw.kinematic_error.Fourier(order=[2.0], amplitude=[6e-5], phase=[0.1])
    of_order = FileEstimate("gear.kinematic_error.amplitude of order 2", "rad", 6e-5, 1e-6, "fourier")
    own = FileEstimate("gear.kinematic_error.amplitude[0]", "rad", 6e-5, 1e-6, "")
    gear = before.gear.replace(kinematic_error=error)
    known = GearSoFar(before).with_fit(gear, ["kinematic_error"], [of_order, own], "a.csv")
    assert known.determined_by == {"gear.kinematic_error.amplitude[0]": "a.csv"}
    assert known.determined == {"kinematic_error"}
    assert known.gear_set.sources["gear.kinematic_error.amplitude[0]"].uncertainty == 1e-6


def test_breakaway_that_follows_coulomb_is_assumed_and_as_uncertain_by_either_way() -> None:
    known = GearSoFar(sw.GearSet.read("hfuc-25-100"))
    law = sw.friction.Coulomb(coulomb=0.1, breakaway=0.12, viscous=3e-4)
    coulomb, breakaway = ("gear.friction_input.coulomb", "gear.friction_input.breakaway")
    estimates = [FileEstimate(coulomb, "N.m", 0.1, 1e-3, "")]
    by_fit = known.with_fit(known.gear_set.gear.replace(friction_input=law), ["friction_input"], estimates, "log.csv")
    by_parts = known.with_parts({"friction_input": law}, {coulomb: 1e-3}, "log.csv")
    assert by_fit.gear_set == by_parts.gear_set
    assert by_fit.determined_by == by_parts.determined_by == {coulomb: "log.csv"}
    assert by_fit.gear_set.sources[breakaway].source.startswith("assumed: ")
    assert by_fit.gear_set.sources[breakaway].uncertainty == 1e-3


@pytest.mark.parametrize(
    ("ratio", "teeth", "fixed"),
    [(101.0, 200, "flexspline"), (-101.0, 202, "circular_spline"), (80.0, 160, "circular_spline")],
)
def test_teeth_that_give_a_stated_ratio_with_the_other_spline_fixed_stay(ratio: float, teeth: int, fixed: str) -> None:
    law = geared(sw.load("csg-14-100"), ratio).kinematics
    assert (law.flexspline_teeth, law.circular_spline_teeth, law.fixed) == (teeth, teeth + 2, fixed)


def test_it_is_remarked_that_the_other_spline_is_fixed() -> None:
    speed = np.geomspace(2.0, 200.0, 8)
    table = sw.Recording({"speed": speed, "torque": 0.05 + 3e-4 * speed}, {"speed": "rad/s", "torque": "N.m"})
    own, given = (
        sw.identify("csg-14-100", {"friction": table}, mapping=FileMapping(constants=constants))
        for constants in ({}, {"ratio": 101.0})
    )
    remark = "ratio given with the files: that of the same teeth with the other spline fixed, the flexspline"
    assert remark in given.files[0].remarks
    assert given.gear_set.sources["gear.kinematics.flexspline_teeth"].source == remark
    assert remark not in own.files[0].remarks


def test_a_phase_of_a_wave_of_unknown_size_determines_nothing_of_the_gear() -> None:
    before = sw.GearSet.read("csg-20-100")
    size, phase = (
        FileEstimate(f"gear.kinematic_error.{name}[0]", unit, 0.1, 1e-3, "", why)
        for name, unit, why in (("amplitude", "rad", "standard deviation exceeds half the value"), ("phase", "rad", ""))
    )
    known = GearSoFar(before).with_fit(before.gear, ["kinematic_error"], [size, phase], "a.csv")
    assert known.determined_by == {}
