"""Slots of other controllers: their numbers and losses against closed forms, and what a slot cannot be made of."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import strainwave as sw
from hypothesis import given, settings, strategies as st
from scipy.integrate import quad
from strainwave.export import Exported, ExportLoss
from strainwave.export.slots import MAX_OVER_COMPENSATED_SHARE, SLOTS
from strainwave.files.entries import Entry, Quantity
from strainwave.tuning.drawn import drawn_gears

from tests.python.command import refused, strainwave
from tests.support import strategies
from tests.support.samples import sample

RATIO = -100.0
KINEMATICS = sw.kinematics.StrainWave(flexspline_teeth=200, circular_spline_teeth=202, fixed="circular_spline")
PLAIN = sw.Gear(kinematics=KINEMATICS, friction_input=sw.friction.Coulomb(coulomb=0.05, breakaway=0.05, viscous=3e-4))
SPEED = 1.0  # rad/s of the output, 100 rad/s of the input
OF_FRICTION = ("viscous-coulomb-scale", "coulomb-viscous", "speed-table")


def value(found: Exported, name: str) -> float:
    return found.numbers[name][0]


def loss(found: Exported) -> ExportLoss:
    return found.losses[0]


def table(found: Exported) -> tuple[np.ndarray, np.ndarray]:
    assert found.table is not None
    first, second = found.table.columns.values()
    return first, second


def driven(gear: sw.Gear, motor: object, load: object | None = None) -> sw.Drive:
    return sw.Drive(gear=gear, motor=motor, load=load or sw.loads.Inertia(inertia=0.5))


def with_torque_constant(gear: sw.Gear) -> sw.Drive:
    return driven(gear, sw.motor.CurrentSource(torque_constant=0.05, inertia=1e-5))


@pytest.mark.parametrize("name", ["coulomb-viscous", "speed-table"])
@pytest.mark.parametrize(("side", "unit"), [("input", "N.m"), ("output", "N.m"), ("input", "A")])
def test_a_line_of_friction_is_lost_nothing_of(name: str, side: str, unit: str) -> None:
    found = sw.export.slot(with_torque_constant(PLAIN), name, side=side, unit=unit, speed=SPEED)
    scale = {"N.m": 100.0 if side == "output" else 1.0, "A": 1.0 / 0.05}[unit]
    assert loss(found).largest == pytest.approx(0.0, abs=1e-14 * scale)
    assert loss(found).rms_share < 1e-14
    if name == "coulomb-viscous":
        per_speed = scale * (100.0 if side == "output" else 1.0)
        for sense in ("plus", "minus"):
            assert value(found, f"coulomb_{sense}") == pytest.approx(0.05 * scale)
            assert value(found, f"viscous_{sense}") == pytest.approx(3e-4 * per_speed)
        assert value(found, "threshold") == pytest.approx(0.01 if side == "output" else 1.0)
        assert found.numbers["viscous_plus"][1] == f"{unit}.s/rad"


def test_a_stribeck_curve_is_lost_by_its_known_integral() -> None:
    """With the Coulomb and viscous friction fitted, both sums of squares are integrals over the speed."""
    law = sw.friction.Stribeck(coulomb=0.04, breakaway=0.08, stribeck_speed=15.0, viscous=4e-4)
    found = sw.export.slot(sw.Gear(kinematics=KINEMATICS, friction_input=law), "coulomb-viscous", speed=SPEED, threshold=0.02)
    low, top = 2.0, 100.0

    def extra(speed: float, power: int = 0) -> float:
        return 0.04 * np.exp(-((speed / 15.0) ** 2)) * speed**power

    moments = np.array([[quad(lambda v: v ** (i + k), low, top)[0] for k in (0, 1)] for i in (0, 1)])  # noqa: B023
    added = np.linalg.solve(moments, [quad(extra, low, top, args=(k,))[0] for k in (0, 1)])
    assert value(found, "coulomb_plus") == pytest.approx(0.04 + added[0], rel=1e-2)
    assert value(found, "viscous_minus") == pytest.approx(4e-4 + added[1], rel=1e-2)
    square, _ = quad(lambda v: (extra(v) - added[0] - added[1] * v) ** 2, low, top)
    assert loss(found).rms == pytest.approx(np.sqrt(square / (top - low)), rel=5e-3)
    assert loss(found).largest == pytest.approx(extra(low) - added[0] - added[1] * low, rel=5e-3)


def test_friction_over_the_angle_is_lost_by_its_root_mean_square() -> None:
    law = sw.friction.Cyclic(law=sw.friction.Coulomb(coulomb=0.05), order=[2.0], amplitude=[0.3], phase=[0.0])
    for name in ("coulomb-viscous", "speed-table"):
        found = sw.export.slot(sw.Gear(kinematics=KINEMATICS, friction_input=law), name, speed=SPEED)
        assert loss(found).rms == pytest.approx(0.05 * 0.3 / np.sqrt(2.0))
        assert loss(found).largest == pytest.approx(0.05 * 0.3, rel=1e-3)


def refuses_angles(law: Any) -> bool:
    return getattr(law, "outside", "") == "refuse" or (hasattr(law, "law") and refuses_angles(law.law))


def has_friction_at_every_angle(law: Any) -> bool:
    return not refuses_angles(law) and bool(np.any(law.steady(np.full(257, 1.0), np.arange(257.0))))


@pytest.mark.slow("export")
@settings(max_examples=sample(10, 30), deadline=None)
@given(law=strategies.models("friction", "steady").filter(has_friction_at_every_angle), count=st.integers(2, 20))
def test_a_table_is_the_friction_at_its_points(law: Any, count: int) -> None:
    gear = sw.Gear(kinematics=KINEMATICS, friction_input=law)
    found = sw.export.slot(gear, "speed-table", speed=SPEED, points=2 * count)
    speed, torque = table(found)
    angle = 2.0 * np.pi * 100.0 / 257 * np.arange(257)
    full = np.array([np.mean(gear.friction_input.steady(np.full(257, v), angle)) for v in speed])
    assert torque == pytest.approx(full, rel=1e-9, abs=1e-12 * np.abs(full).max())
    for other in (found, sw.export.slot(gear, "coulomb-viscous", speed=SPEED)):
        assert 0.0 <= loss(other).rms <= loss(other).largest * (1.0 + 1e-12)


def test_a_denser_table_loses_less() -> None:
    law = sw.friction.Stribeck(coulomb=0.04, breakaway=0.08, stribeck_speed=5.0)
    gear = sw.Gear(kinematics=KINEMATICS, friction_input=law)
    coarse, dense = (loss(sw.export.slot(gear, "speed-table", speed=SPEED, points=count)).rms for count in (16, 32))
    assert dense == pytest.approx(coarse / 4.0, rel=0.2)  # lines through a smooth curve


@pytest.mark.slow("export")
def test_scales_are_those_of_the_gear_of_little_friction() -> None:
    """All friction of a drawn gear is that of the stated one times one factor, so both scales are a factor."""
    stated = sw.GearSet.of(with_torque_constant(PLAIN), name="joint", source="measured")
    found = sw.export.slot(stated, "viscous-coulomb-scale", speed=SPEED, members=99, seed=1)
    factors = np.sort(drawn_gears(stated, 99, 1)["gear.friction_input.viscous"] / 3e-4)
    assert value(found, "viscous_scale") == pytest.approx(factors[4])  # of 100 equally likely places of a gear five lie below
    assert value(found, "coulomb_scale") == pytest.approx(factors[4])
    assert value(found, "over_compensated") == pytest.approx(4 / 99)
    friction = np.sqrt(np.mean((0.05 + 3e-4 * np.linspace(1.0, 100.0, 20001)) ** 2))
    assert loss(found).rms == pytest.approx((1.0 - factors[4]) * friction, rel=1e-6)


@pytest.mark.slow("export")
@pytest.mark.parametrize("name", ["csg-20-100", "space-pointing-joint", "position-drive-full-friction"])
def test_a_scale_over_compensates_few_gears(name: str) -> None:
    found = sw.export.slot(name, "viscous-coulomb-scale", members=40)
    assert value(found, "over_compensated") <= MAX_OVER_COMPENSATED_SHARE
    assert all(0.0 < value(found, f"{part}_scale") <= 1.0 for part in ("viscous", "coulomb"))


def test_a_gear_that_is_known_is_compensated_nearly_in_full() -> None:
    stated = sw.GearSet.of(PLAIN, name="joint", source="measured")
    known = stated.replace(sources=dict.fromkeys(stated.sources, Entry("measured", spread=1e-6)))
    found = sw.export.slot(known, "viscous-coulomb-scale", speed=SPEED, members=40)
    assert value(found, "coulomb_scale") == pytest.approx(1.0, abs=1e-5)
    assert not any("assumed" in remark for remark in found.remarks)


def test_the_reaction_of_the_kinematic_error_is_that_of_the_current_signature() -> None:
    """3e-4 rad at order 2 under 20 N.m take 240 mA at 0.05 N.m/A; 0.8e-4 and 0.5e-4 rad at orders 1 and 4 take 32 and 80 mA."""
    error = sw.kinematic_error.Fourier(order=[1.0, 2.0, 4.0], amplitude=[0.8e-4, 3e-4, 0.5e-4], phase=[0.0, 0.0, 0.0])
    gear = sw.Gear(kinematics=sw.kinematics.PlainRatio(reduction=100.0), kinematic_error=error)
    found = sw.export.slot(with_torque_constant(gear), "anticogging-map", unit="A", torque=20.0, points=128)
    angle, current = table(found)
    lines = {order: 2.0 / angle.size * np.sum(current * np.exp(-1j * order * angle)) for order in (1, 2, 4)}
    assert [lines[order].real for order in (1, 2, 4)] == pytest.approx([-0.032, -0.240, -0.080])
    assert loss(found).rms < 1e-3
    assert np.isnan(loss(found).rms_share)


def test_what_does_not_repeat_with_the_input_is_lost_from_a_map() -> None:
    error = sw.kinematic_error.Fourier(order=[2.0, 2.02], amplitude=[3e-4, 1e-4], phase=[0.3, 0.0])
    gear = PLAIN.replace(kinematic_error=error)
    found = sw.export.slot(gear, "anticogging-map", torque=20.0, points=256)
    assert value(found, "amplitude") == pytest.approx(20.0 * 3e-4 * 2.0, rel=1e-3)
    assert loss(found).rms == pytest.approx(20.0 * 1e-4 * 2.02 / np.sqrt(2.0), rel=1e-3)


def test_a_map_has_friction_of_its_sense_and_cogging() -> None:
    law = sw.friction.Cyclic(law=sw.friction.Coulomb(coulomb=0.05), order=[3.0], amplitude=[0.2], phase=[0.0])
    motor = sw.motor.PMSM(
        resistance=0.5, direct_inductance=1e-3, quadrature_inductance=1e-3, flux_linkage=0.01, pole_pairs=5, inertia=1e-4,
        supply_voltage=48.0, current_limit=10.0, cogging_torque=0.02, cogging_order=6.0,
    )  # fmt: skip
    drive = driven(sw.Gear(kinematics=KINEMATICS, friction_input=law), motor)
    there, back = (sw.export.slot(drive, "anticogging-map", torque=0.0, speed=speed) for speed in (0.002, -0.002))
    angle, forward = table(there)
    _, backward = table(back)
    assert forward - backward == pytest.approx(2.0 * 0.05 * 0.2 * _cyclic(law, angle), abs=1e-12)
    assert forward + backward == pytest.approx(-2.0 * 0.02 * np.sin(6.0 * angle), abs=1e-12)
    assert there.losses[1].rms == pytest.approx(2.0 * 0.05 * 0.2 / np.sqrt(2.0), rel=1e-3)  # in the other sense of motion
    assert any("cogging" in remark for remark in there.remarks)


def _cyclic(law: sw.friction.Cyclic, angle: np.ndarray) -> np.ndarray:
    """The share of the amplitude by which the friction differs from its mean."""
    steady = np.asarray(law.steady(np.full(angle.size, 1.0), angle))
    return (steady - steady.mean()) / (0.05 * 0.2)


def test_a_torque_offset_is_the_inertia_in_permille() -> None:
    """A sine takes its acceleration times the inertia; rounding loses 1/sqrt(12), holding a third of the change of a period."""
    gear = sw.Gear(kinematics=sw.kinematics.PlainRatio(reduction=100.0), stiffness=sw.stiffness.Linear(k=1e9))
    drive = driven(gear, sw.motor.TorqueSource(inertia=1e-4), sw.loads.Inertia(inertia=0.5))
    found = sw.export.slot(drive, "torque-offset", rated_torque=0.05, travel=1.0, speed=2.0, period=1e-4)
    time, permille = table(found)
    amplitude = 1e3 * 100.0 * (1e-4 + 0.5 / 100.0**2) * 0.5 * 4.0**2 / 0.05
    assert permille == pytest.approx(amplitude * np.cos(4.0 * time), abs=1.5)
    assert loss(found).rms ** 2 == pytest.approx(1.0 / 12.0 + (4.0 * 1e-4 * amplitude) ** 2 / 6.0, rel=0.05)
    assert (permille == np.rint(permille)).all()


def test_a_torque_offset_follows_a_motion_that_is_given_and_the_rating_of_the_set() -> None:
    rated = Quantity(value=900.0, unit="N.m", source="data sheet").to("N.m")
    stated = sw.GearSet.read("robot-joint")
    with_rating = stated.replace(ratings={**stated.ratings, "motor_rated_torque": rated})
    motion = sw.scenario.sine(0.1, 0.5, 2.0, phase=-np.pi / 2, offset=0.1)
    found = sw.export.slot(with_rating, "torque-offset", motion=motion)
    assert value(found, "rated_torque") == 900.0
    assert found.table is not None
    assert len(found.table["time"]) == 2001


@pytest.mark.slow("export")
def test_what_is_assumed_is_remarked() -> None:
    for name in OF_FRICTION:
        assert any("friction is assumed" in remark for remark in sw.export.slot("csg-20-100", name).remarks)
    found = sw.export.slot("robot-joint", "anticogging-map", torque=20.0, unit="A")
    assert any("both encoders" in remark for remark in found.remarks)
    assert any("amplitudes of the phases" in remark for remark in found.remarks)


@pytest.mark.parametrize(
    ("drive", "name", "changes", "words"),
    [
        ("csg-20-100", "friction", {}, "must be one of viscous-coulomb-scale"),
        (
            "csg-20-100",
            "speed-table",
            {"unit": "A"},
            r"torque constant of the motor, and CSG-20-100 has no \[motor\]",
        ),
        ("two-inertia-gear", "coulomb-viscous", {}, "has no friction.*a friction table or a log of motion determines it"),
        ("robot-joint", "torque-offset", {}, "rated_torque is needed.*0x6076.*no rating motor_rated_torque"),
        ("robot-joint", "torque-offset", {"rated_torque": 1e-4}, "is too small"),
        ("robot-joint", "torque-offset", {"rated_torque": 1.0, "unit": "A"}, "permille"),
        ("robot-joint", "torque-offset", {"rated_torque": 1.0, "period": 10.0}, "period = 10 s must divide the motion"),
        ("robot-joint", "torque-offset", {"rated_torque": 1.0, "period": 1e-7}, "into 1 to 1000000 parts"),
        ("robot-joint", "speed-table", {"speed": float("inf")}, "speed"),
        ("robot-joint", "anticogging-map", {"torque": 1.0, "points": 5000}, "points"),
        ("csg-20-100", "torque-offset", {"rated_torque": 1.0}, r"no \[motor\] and no \[load\]"),
        ("robot-joint", "anticogging-map", {}, "torque is needed"),
        ("csg-20-100", "anticogging-map", {"torque": 0.0}, "the map is zero"),
        ("robot-joint", "anticogging-map", {"torque": 1.0, "side": "output"}, "belongs to the input"),
        ("robot-joint", "speed-table", {"side": "output", "unit": "A"}, "belongs to the input"),
        ("robot-joint", "speed-table", {"points": 7}, "must be even"),
        ("robot-joint", "speed-table", {"points": 2}, "points"),
        ("robot-joint", "speed-table", {"speed": 0.5, "threshold": 0.6}, "below the largest speed, 0.5 rad/s"),
        ("robot-joint", "speed-table", {"speed": 0.01, "threshold": "0.3 rpm"}, r"threshold = 0\.0314\d* rad/s must be below"),
        ("robot-joint", "viscous-coulomb-scale", {"members": 18}, "members"),
        ("robot-joint", "speed-table", {"side": "motor"}, "side"),
        ("robot-joint", "speed-table", {"temperature": 0.0}, "temperature"),
        ("robot-joint", "torque-offset", {"motion": sw.scenario.step("1 A", 1.0)}, "^motion: the scenario is in A, and rad"),
    ],
)
def test_what_is_missing_is_stated(drive: str, name: str, changes: dict[str, object], words: str) -> None:
    with pytest.raises(ValueError, match=words):
        sw.export.slot(drive, name, **changes)  # type: ignore[arg-type]


def test_a_motion_that_is_none_is_refused() -> None:
    with pytest.raises(TypeError, match=r"motion must be a scenario.*not 3"):
        sw.export.slot("robot-joint", "torque-offset", rated_torque=1.0, motion=3)  # type: ignore[arg-type]
    with pytest.raises(TypeError, match="drive must be a gear, a drive, a set of one, a name or a path, not 3"):
        sw.export.slot(3, "speed-table")  # type: ignore[arg-type]


@pytest.mark.parametrize("side", ["input", "output"])
def test_side_and_sign_are_the_first_remarks(side: str) -> None:
    first, second, *_ = sw.export.slot("csg-20-100", "coulomb-viscous", side=side).remarks
    assert first == f"speeds and torques are those of the {side}"
    assert second.startswith("sign: ")


@pytest.mark.slow("export")
@pytest.mark.parametrize("name", SLOTS)
def test_the_command_writes_a_slot(name: str, tmp_path: Path) -> None:
    needs = {"torque-offset": {"rated_torque": 0.9}, "anticogging-map": {"torque": 20.0}}.get(name, {})
    options = [word for option, number in needs.items() for word in (f"--{option.replace('_', '-')}", number)]
    done = strainwave("export", "slot", "robot-joint", name, *options, "--out", "slot", folder=tmp_path)
    assert done.returncode == 0, done.stderr
    assert "loss against the gear:" in done.stdout
    written = json.loads((tmp_path / "slot" / "export.json").read_text())
    found = sw.export.slot("robot-joint", name, **needs)  # type: ignore[arg-type]
    assert written["kind"] == name
    assert written["numbers"] == {key: {"value": number, "unit": unit} for key, (number, unit) in found.numbers.items()}
    assert [each["rms"] for each in written["losses"]] == [each.rms for each in found.losses]
    assert (found.table is None) != (tmp_path / "slot" / f"{name}.csv").exists()
    if found.table is not None:
        assert sw.Recording.read(tmp_path / "slot" / f"{name}.csv") == found.table


def test_the_command_prints_twelve_rows_of_a_table_at_most(tmp_path: Path) -> None:
    for points, rows in ((8, 8), (64, 12)):
        done = strainwave("export", "slot", "csg-20-100", "speed-table", "--points", points, folder=tmp_path)
        lines = done.stdout.splitlines()
        first = next(k for k, line in enumerate(lines) if "speed [rad/s]" in line) + 1
        last = lines.index("loss against the gear:")
        assert len([line for line in lines[first:last] if len(line.split()) == 2]) == rows
        assert ("(12 of 64 rows)" in done.stdout) == (points == 64)


def test_a_loss_relative_to_friction_names_it(tmp_path: Path) -> None:
    for name, option in (("torque-offset", ("--rated-torque", 0.9)), ("anticogging-map", ("--torque", 20.0))):
        done = strainwave("export", "slot", "robot-joint", name, *option, "--out", name, folder=tmp_path)
        assert " % of the friction (" in done.stdout
        (first, *_) = json.loads((tmp_path / name / "export.json").read_text())["losses"]
        assert first["relative_to"] == "friction"
        assert first["largest_share"] == pytest.approx(first["largest"] / first["size"])


def test_the_command_names_its_options(tmp_path: Path) -> None:
    refused(tmp_path, ["export", "slot", "robot-joint", "anticogging-map"], "--torque is needed")
    refused(tmp_path, ["export", "slot", "robot-joint", "torque-offset"], "--rated-torque is needed")
    refused(tmp_path, ["export", "slot", "robot-joint", "speed-table", "--travel", "1"], "travel is not used by the slot")
    refused(tmp_path, ["export", "slot", "robot-joint", "speed-table", "--points", "8.5"], "--points")


@pytest.mark.parametrize(
    ("name", "options", "words"),
    [
        (
            "coulomb-viscous",
            {"points": 8},
            "points is not used by the slot coulomb-viscous, only by speed-table, anti",
        ),
        ("anticogging-map", {"torque": 1.0, "threshold": 0.1}, "threshold is not used by the slot anticogging-map"),
        ("torque-offset", {"torque": 1.0}, "torque is not used by the slot torque-offset"),
        ("torque-offset", {"motion": sw.scenario.ramp(1.0, 1.0), "travel": 1.0}, "travel is that of a motion to and fro"),
        ("speed-table", {"members": 40}, "members is not used by the slot speed-table, only by viscous-coulomb-scale"),
    ],
)
def test_an_option_that_a_slot_does_not_use_is_refused(name: str, options: dict[str, object], words: str) -> None:
    with pytest.raises(ValueError, match=words):
        sw.export.slot("robot-joint", name, **options)  # type: ignore[arg-type]
