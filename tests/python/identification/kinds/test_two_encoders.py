"""Orders of two encoders in the gear: as measured at some speeds, or as its own."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import strainwave as sw
from strainwave.files.gear_set import GearSet
from strainwave.identification.kinds.two_encoders import orders_of, with_error
from strainwave.identification.results.gear_so_far import GearSoFar

SPEEDS = "10 to 60 1/min of the input"
PATH = "gear.kinematic_error.amplitude[0]"


def error() -> sw.orders.TransmissionError:
    theta = 30.0 * np.sin(np.linspace(0.0, 6.0, 1000))
    output = theta / 100.0 - 3e-4 * np.sin(2 * theta) + np.random.default_rng(1).normal(0.0, 1e-5, len(theta))
    return sw.transmission_error(
        sw.Recording({"input_angle": theta, "output_angle": output}, {"input_angle": "rad", "output_angle": "rad"})
    )


def test_amplitudes_that_change_with_the_speed_are_not_those_of_the_gear_alone() -> None:
    found = replace(error(), speeds=SPEEDS, vibrates=True)
    states = {each.state for each in orders_of(found)}
    assert states == {"identified in combination"}
    known = with_error(GearSoFar(GearSet.read("csg-20-100")), found, "te.csv")
    assert known.gear_set.sources[PATH].source.startswith(
        f"identified in combination: amplitudes are those measured at {SPEEDS}"
    )
    assert "kinematic_error" not in known.determined


def test_amplitudes_at_one_speed_name_it_and_others_do_not() -> None:
    at_one = replace(error(), speeds="60 1/min of the input")
    for found, source in ((error(), "identified from te.csv"), (at_one, "identified from te.csv, at 60 1/min of the input")):
        assert {each.state for each in orders_of(found)} == {"identified"}
        known = with_error(GearSoFar(GearSet.read("csg-20-100")), found, "te.csv")
        assert known.gear_set.sources[PATH].source == source
        assert "kinematic_error" in known.determined
