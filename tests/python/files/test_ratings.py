"""Limits of a gear set beside what recordings show: closed forms, and what cannot be compared."""

from __future__ import annotations

import re
import warnings
from math import pi
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import strainwave as sw
from hypothesis import given, strategies as st
from strainwave.files.entries import Quantity
from strainwave.files.gear_set import GearSet

LIMITS = {
    "rated_torque": 10.0,
    "average_torque": 20.0,
    "peak_torque": 30.0,
    "momentary_torque": 60.0,
    "ratcheting_torque": 90.0,
    "buckling_torque": 120.0,
    "maximum_input_speed": 600.0,
    "average_input_speed": 300.0,
}


def rated(**limits: Quantity) -> GearSet:
    """A set with the limits above, or with these."""
    known = {
        name: Quantity(value=limit, unit="rpm" if name.endswith("speed") else "N.m", source=f"sheet, {name}")
        for name, limit in LIMITS.items()
    }
    return GearSet.of(sw.Gear(), name="gear", source="x").replace(ratings=limits or known)


def recorded(**columns: Any) -> sw.Recording:
    units = {"time": "s", "torque": "N.m", "input_speed": "rad/s", "speed": "rad/s", "twist": "rad", "output_speed": "rad/s"}
    return sw.Recording(columns, {name: units[name] for name in columns}, title="test")


def checks(gear_set: GearSet, *recordings: sw.Recording) -> dict[str, sw.files.RatingCheck]:
    return {check.name: check for check in sw.check_ratings(gear_set, *recordings)}


torques = st.lists(st.floats(-200.0, 200.0), min_size=1, max_size=20)


@given(torques)
def test_a_torque_is_exceeded_where_its_largest_size_is_beyond_and_when_it_is_first(torque: list[float]) -> None:
    time = 0.5 * np.arange(len(torque))
    found = checks(rated(), recorded(time=time, torque=torque))
    assert found.keys() == {"peak_torque", "momentary_torque", "ratcheting_torque", "buckling_torque"}
    for name, check in found.items():
        beyond = [t for t, size in zip(time, np.abs(torque), strict=True) if size > LIMITS[name]]
        assert check.reached == max(map(abs, torque))
        assert check.exceeded == bool(beyond)
        assert check.time == (beyond[0] if beyond else None)


@given(st.lists(st.tuples(st.floats(0.0, 100.0), st.floats(1.0, 100.0), st.floats(0.1, 5.0)), min_size=1, max_size=5))
def test_mean_torque_and_speed_of_a_duty_cycle_are_those_of_the_selection_procedure(
    stages: list[tuple[float, float, float]],
) -> None:
    """Stages of constant torque and speed: T_av^3 = sum(n |T|^3 t) / sum(n t), n_av = sum(n t) / sum(t)."""
    torque, speed, lasting = np.array(stages).T
    ends = np.concatenate([[0.0], np.cumsum(lasting)])
    time = np.column_stack([ends[:-1], ends[1:] - 1e-9]).ravel()  # a jump between stages takes a nanosecond
    found = checks(rated(), recorded(time=time, torque=np.repeat(-torque, 2), input_speed=np.repeat(speed, 2)))
    turned = np.sum(speed * lasting)
    assert found["average_torque"].reached == pytest.approx(np.cbrt(np.sum(speed * torque**3 * lasting) / turned), rel=1e-6)
    assert found["average_input_speed"].reached == pytest.approx(turned / lasting.sum() * 30.0 / pi, rel=1e-6)
    assert found["maximum_input_speed"].reached == pytest.approx(speed.max() * 30.0 / pi)
    assert found["average_torque"].time is found["average_input_speed"].time is None


def test_each_limit_is_told_in_its_unit_with_its_source() -> None:
    gear_set = rated(peak_torque=Quantity(value=3.0, unit="N.cm", source="sheet"))
    (check,) = sw.check_ratings(gear_set, recorded(time=[0.0, 2.0], torque=[0.0, -0.05]))
    assert (check.reached, check.time, check.limit.source) == (pytest.approx(5.0), 2.0, "sheet")
    assert str(check) == "peak torque: 5 N.cm exceeds the limit of 3 N.cm, first at t = 2 s (sheet)"
    (check,) = sw.check_ratings(gear_set, recorded(torque=[0.02]))
    assert str(check) == "peak torque: 2 N.cm keeps the limit of 3 N.cm (sheet)"


def test_a_limit_that_is_just_reached_is_kept() -> None:
    assert not checks(rated(), recorded(torque=[30.0]))["peak_torque"].exceeded


def test_a_torsion_loop_has_no_time_and_a_friction_table_no_output_torque() -> None:
    loop = checks(rated(), recorded(twist=[0.0, 1e-3], torque=[0.0, 40.0]))
    assert loop["peak_torque"].exceeded
    assert loop["peak_torque"].time is None
    table = checks(rated(), recorded(speed=[1.0, 100.0], torque=[40.0, 40.0]))
    assert table.keys() == {"maximum_input_speed"}
    assert table["maximum_input_speed"].exceeded


def test_what_does_not_turn_has_no_mean_torque() -> None:
    still = recorded(time=[0.0, 1.0], torque=[50.0, 50.0], input_speed=[0.0, 0.0])
    assert "average_torque" not in checks(rated(), still)
    assert checks(rated(), still)["average_input_speed"].reached == 0.0
    assert "average_torque" not in checks(rated(), recorded(time=[0.0], torque=[50.0], input_speed=[1.0]))


def test_recordings_are_compared_one_by_one_in_their_order() -> None:
    gear_set = rated(peak_torque=Quantity(value=30.0, unit="N.m", source="sheet"))
    found = sw.check_ratings(gear_set, recorded(torque=[40.0]), recorded(twist=[0.0]), recorded(torque=[20.0]))
    assert [(check.reached, check.recording) for check in found] == [(40.0, "test"), (20.0, "test")]
    assert sw.check_ratings(gear_set) == []


@pytest.mark.parametrize(
    ("gear_set", "recording", "error", "message"),
    [
        (
            sw.Gear(),
            recorded(torque=[1.0]),
            TypeError,
            "gear_set must be a GearSet, as sw.GearSet.read(...) gives it, not <Gear: ",
        ),
        (rated(), 3, TypeError, "recordings must hold a Recording each, not 3"),
        (
            rated(peak_torque=Quantity(value=1.0, unit="rpm", source="x")),
            recorded(torque=[1.0]),
            ValueError,
            'ratings.peak_torque: cannot convert "N.m" to "rpm"',
        ),
    ],
)
def test_what_cannot_be_compared_is_refused(gear_set: Any, recording: Any, error: type[Exception], message: str) -> None:
    with pytest.raises(error, match=f"^{re.escape(message)}"):
        sw.check_ratings(gear_set, recording)


# Simulations


def size_20() -> GearSet:
    """A gear of size 20 behind a strong motor."""
    return GearSet.read("csg-20-80").with_parts(
        motor=sw.motor.DC(resistance=0.5, torque_constant=0.1, back_emf=0.1, inertia=1e-4),
        control=sw.control.PID(proportional=50.0, derivative=0.1, limit=48.0),
        load=sw.loads.Inertia(inertia=0.5),
        source="x",
    )


@pytest.mark.parametrize("simulate", [sw.simulate, sw.simulate_adaptively])
def test_a_run_of_a_set_warns_of_every_limit_exceeded_and_is_that_of_its_drive(simulate: Any) -> None:
    gear_set, command = size_20(), sw.scenario.step(amplitude=0.2, duration=0.1)
    with pytest.warns(sw.files.RatingWarning) as warned:
        run = simulate(gear_set, command)
    exceeded = [check for check in sw.check_ratings(gear_set, run) if check.exceeded]
    assert {"peak_torque", "momentary_torque"} <= {check.name for check in exceeded}
    assert [str(warning.message) for warning in warned] == [f"CSG-20-80: {check}" for check in exceeded]
    assert {warning.filename for warning in warned} == {__file__}
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert simulate(gear_set.drive, command) == run


def test_adaptive_steps_that_stiff_bristles_ask_for_warn_once() -> None:
    gear_set = size_20()
    law = sw.friction.LuGre(
        coulomb=0.05, breakaway=0.05, bristle_stiffness=1e5, bristle_damping=1e-3, viscous=1e-3, stribeck_speed=2.0
    )
    stiff = GearSet.of(gear_set.drive.replace(gear=gear_set.gear.replace(friction_input=law)), name="stiff", source="x")
    stiff = stiff.replace(ratings={"peak_torque": gear_set.ratings["peak_torque"]})
    with pytest.warns(sw.files.RatingWarning) as warned:
        run = sw.simulate(stiff, sw.scenario.step(amplitude=0.2, duration=0.02))
    assert "adaptive" in run.method
    assert len(warned) == 1


SHEET = """name = "sheet"
[datasheet]
ratio = -100
size = 25
peak_torque = "74 N.m"
"""


def test_a_run_with_the_gear_of_a_data_sheet_warns_of_the_limits_of_the_sheet(tmp_path: Path) -> None:
    (tmp_path / "sheet.toml").write_text(SHEET)
    sheet = sw.GearSet.read(tmp_path / "sheet.toml")
    joint = sheet.with_parts(motor=sw.motor.BrushlessDC(), load=sw.loads.Inertia(inertia=1.0), source="x")
    held = sw.scenario.constant(0.0, 0.1)
    with pytest.warns(sw.files.RatingWarning, match=r"^sheet: peak torque: .* exceeds the limit of 74 N\.m"):
        sw.simulate(joint, held, load_torque=165.0)
    sw.simulate(joint, held, load_torque=1.0)  # a warning would be an error
    sw.simulate(joint.drive, held, load_torque=165.0)  # a drive has no ratings


def test_a_run_within_all_limits_warns_of_none() -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        sw.simulate(size_20(), sw.scenario.step(amplitude=1e-3, duration=0.1))
