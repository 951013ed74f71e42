"""Positioning error of a gear, against figures of data sheets worked out by hand."""

from __future__ import annotations

import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import strainwave as sw
from strainwave.files.identified_tables import Covariance

from tests.python.command import strainwave

ARCSEC = np.pi / 180.0 / 3600.0


@pytest.mark.parametrize(
    ("name", "load", "accuracy", "loss", "segments"),
    [
        # The maker's figures: bounds in arc minutes, then K1, K2, K3 [N.m/rad], T1, T2 [N.m].
        ("csg-20-100", 52.0, 0.8, 1.0, (16e3, 25e3, 29e3, 7.0, 25.0)),
        ("csg-20-100", 20.0, 0.8, 1.0, (16e3, 25e3, 29e3, 7.0, 25.0)),
        ("csg-25-100", 30.0, 0.8, 1.0, (31e3, 50e3, 57e3, 14.0, 48.0)),
    ],
)
def test_it_is_that_of_the_data_sheet(
    name: str, load: float, accuracy: float, loss: float, segments: tuple[float, ...]
) -> None:
    k1, k2, k3, t1, t2 = segments
    twist = min(load, t1) / k1 + max(min(load, t2) - t1, 0.0) / k2 + max(load - t2, 0.0) / k3
    kinematic, wind_up, loop, lost = sw.analysis.positioning_error(name, load=load)
    assert kinematic.bound == pytest.approx(60.0 * accuracy * ARCSEC, rel=1e-3)
    assert loop.bound == pytest.approx(60.0 * loss * ARCSEC, rel=0.02)
    assert wind_up.typical == pytest.approx(twist, rel=0.01)
    assert wind_up.bound == pytest.approx(1.3 * twist, rel=0.01)
    assert lost.typical < lost.bound < loop.bound + 2.0 * wind_up.bound


def test_of_an_identified_gear_the_bound_is_three_standard_deviations_away() -> None:
    gear = sw.Gear(stiffness=sw.stiffness.Linear(k=1e4))
    covariance = Covariance(("gear.stiffness.k",), [[1e4]])
    identified = replace(sw.GearSet.of(gear, name="x", source="x"), covariance=covariance)
    kinematic, wind_up, loop = sw.analysis.positioning_error(identified, load=20.0)
    assert (kinematic.bound, loop.bound) == (0.0, 0.0)
    assert wind_up.typical == pytest.approx(2e-3)
    assert wind_up.bound == pytest.approx(1.03 * 2e-3)


def test_without_a_rated_torque_it_needs_a_load() -> None:
    with pytest.raises(ValueError, match=r"has no rating rated_torque; give a load"):
        sw.analysis.positioning_error(sw.Gear())


def test_the_command_prints_arc_seconds(tmp_path: Path) -> None:
    done = strainwave("show", "csg-20-100", "--torque", "52", folder=tmp_path)
    assert done.returncode == 0, done.stderr
    table = done.stdout.partition("positioning error at the output [arcsec]\n")[2].splitlines()
    assert [re.findall(r"  (\d+) +(\d+)  ", row) for row in table[1:3]] == [[("24", "48")], [("431", "560")]]
