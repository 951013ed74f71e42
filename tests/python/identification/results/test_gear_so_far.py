"""The gear so far: what a file determines of it."""

from __future__ import annotations

import strainwave as sw
from strainwave.identification.results.file_result import FileEstimate
from strainwave.identification.results.gear_so_far import GearSoFar


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
