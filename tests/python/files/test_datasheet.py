"""Gears from the figures of a data sheet: the catalogue's from their own, others from what there is."""

from __future__ import annotations

from math import exp, log, pi, sqrt
from pathlib import Path
from statistics import mean, stdev
from typing import Any

import pytest
import strainwave as sw
from hypothesis import given, settings, strategies as st
from strainwave.files import typical_gear as typical
from strainwave.rig.analysis.catalogue_check import published

from tests.python.catalogue.makers import (
    ACCURACY,
    CPL_RATIO_CORRECTION,
    CPL_RUNNING,
    CPL_SPEED,
    CPL_STARTING,
    HYSTERESIS_LOSS,
    KNEES,
    ROUNDING,
    ROUNDING_K1,
    SETS,
    SLOPES,
    STARTING_TORQUE,
    column,
    identity,
)

PRINTED = [name for name in SETS if identity(name)[1] in SLOPES[column(name)] and not name.startswith("shg")]


def figures_of(name: str) -> dict[str, str]:
    """What the maker prints of a gear, in his units."""
    size = identity(name)[1]
    k1, k2, k3 = SLOPES[column(name)][size]
    t1, t2 = KNEES[size]
    inertia = sw.load(name).input_inertia
    return {
        "k1": f"{k1} 10^3 N·m/rad", "k2": f"{k2} × 10³ Nm/rad", "k3": f"{k3}e3 N.m/rad", "t1": f"{t1} N.m", "t2": f"{t2} N·m",
        "hysteresis_loss": f"≤ {HYSTERESIS_LOSS[column(name)]} arcmin",
        "transmission_accuracy": f"{ACCURACY[column(name)][size]} arcmin",
        "wave_generator_inertia": f"{inertia * 1e4} 10^-4 kg·m²",
    }  # fmt: skip


@pytest.mark.parametrize("name", PRINTED)
def test_a_gear_of_the_catalogue_follows_from_its_printed_figures(name: str) -> None:
    _, size, ratio = identity(name)
    made, own = sw.Gear.from_datasheet(ratio=-ratio, size=size, **figures_of(name)), sw.load(name)
    assert made.kinematics == own.kinematics
    for each in ("k1", "k2", "k3", "t1", "t2"):
        assert getattr(made.stiffness, each) == pytest.approx(getattr(own.stiffness, each), rel=2 * ROUNDING_K1)
    for part, members in {
        "hysteresis": ("stiffness", "breakaway"),
        "kinematic_error": ("order", "amplitude", "phase"),
        "friction_input": ("coulomb", "breakaway", "viscous"),
    }.items():
        for each in members:
            expected = getattr(getattr(own, part), each)
            assert getattr(getattr(made, part), each) == pytest.approx(expected, rel=ROUNDING), (part, each)
    assert (made.damping, made.input_inertia) == pytest.approx((own.damping, own.input_inertia), rel=ROUNDING)
    assert made.friction_mesh == own.friction_mesh


def test_the_laws_of_size_are_those_of_the_catalogue() -> None:
    told: dict[tuple[str, int], list[float]] = {}
    for name in SETS:
        series, size, ratio = identity(name)
        if series == "SHG":  # the stiffness of CSG again, the inertia of another wave generator
            continue
        gear_set = sw.GearSet.read(name)
        whole = published(gear_set, "output")
        assert whole is not None
        values = {key.lower(): value for key, value in whole.items()}
        values["wave_generator_inertia"] = gear_set.gear.input_inertia
        if "rated_torque" in gear_set.ratings:
            values["rated_torque"] = gear_set.ratings["rated_torque"].value
        for key, value in values.items():
            told.setdefault((key, typical.group(ratio)), []).append(log(value / size ** typical.law(key, ratio).exponent))
    assert {key for key, _ in told} == typical.LAWS.keys()
    for (key, group), logs in told.items():
        law = typical.LAWS[key][group]
        assert law.factor == pytest.approx(exp(mean(logs)), rel=5e-4), (key, group)
        assert law.scatter == pytest.approx(stdev(logs), abs=6e-4), (key, group)


def test_the_rules_of_friction_are_those_of_the_makers_figures() -> None:
    factors = [torque * ratio / size**3 for (size, ratio), torque in STARTING_TORQUE.items()]
    assert pytest.approx(sqrt(factors[0] * factors[1]), rel=ROUNDING) == typical.STARTING_TORQUE
    assert (
        pytest.approx((CPL_RUNNING - CPL_RATIO_CORRECTION - CPL_STARTING) / CPL_SPEED, rel=ROUNDING) == typical.VISCOUS_FRICTION
    )


@settings(max_examples=30, deadline=None)
@given(k1=st.floats(1e3, 1e6), twist=st.floats(4.5e-4, 1e-3), share=st.floats(1.2, 5.0), loss=st.floats(0.05, 3.0))
def test_the_first_loading_reaches_t1_at_its_printed_twist_and_the_loop_is_half_the_bound_wide(
    k1: float, twist: float, share: float, loss: float
) -> None:
    """Of the gear itself, loaded and unloaded by the package."""
    t1 = k1 * twist
    gear = sw.Gear.from_datasheet(
        ratio=-100, k1=k1, k2=2 * k1, k3=3 * k1, t1=t1, t2=share * t1, hysteresis_loss=f"{loss} arcmin"
    )
    width = 0.5 * loss * typical.RAD_PER_ARCMIN
    _, at_t1, _, at_zero = gear.twist([0.0, t1, 40.0 * t1, 0.0])
    assert at_t1 == pytest.approx(twist, rel=1e-6)
    assert at_zero == pytest.approx(0.5 * width, rel=1e-4)


@pytest.mark.parametrize(("loss", "told"), [("1 arcmin", False), ("3 arcmin", True)])
def test_a_loop_wider_than_the_twist_at_t1_is_told(loss: str, told: bool) -> None:
    """1.5 arcmin are 4.4e-4 rad."""
    figures = {"k1": 1e4, "k2": 2e4, "k3": 3e4, "t1": 3.0, "t2": 10.0}
    assert bool(sw.GearSet.from_datasheet(ratio=-100, hysteresis_loss=loss, **figures).note) is told


def test_what_is_not_given_is_assumed_and_says_so() -> None:
    found = sw.GearSet.from_datasheet(ratio=-80, rated_torque="44 N·m", starting_torque="3.4 cN·m", source="sheet of 2024")
    assert found.ratings["rated_torque"].source == "sheet of 2024"
    breakaway = found.sources["gear.friction_input.breakaway"]
    assert (found.gear.friction_input.breakaway, breakaway.source) == (pytest.approx(0.034), "sheet of 2024, starting torque")
    for path, entry in found.sources.items():
        if path.startswith("gear.stiffness."):
            assert entry.assumed
            assert entry.spread is not None
            assert entry.spread >= 0.3
    assert 16e3 / found.gear.stiffness.k2 == pytest.approx(16 / 25, rel=0.4)  # CSG-20-80 is rated 44 N.m, with K2 = 25e3


def test_less_is_known_of_a_gear_of_which_less_is_said() -> None:
    spreads = [
        sw.GearSet.from_datasheet(ratio=-100, **told).sources["gear.stiffness.k2"].spread
        for told in ({"k2": 5e4}, {"size": 25}, {"k1": 3.1e4}, {"rated_torque": 87.0}, {})
    ]
    assert spreads == sorted(spreads)
    assert spreads[0] == 0.3
    assert spreads[-1] is not None
    assert spreads[-1] > 1.0


@pytest.mark.parametrize("name", ["csg-14-50", "csg-25-100", "csg-40-160", "hfuc-32-30", "csg-58-80"])
def test_an_estimate_by_size_is_as_near_to_the_catalogue_as_its_spread_says(name: str) -> None:
    _, size, ratio = identity(name)
    own = sw.load(name)
    for told in ({"size": size}, {"k1": published(sw.GearSet.read(name), "output")["K1"]}):
        made = sw.GearSet.from_datasheet(ratio=-ratio, **told)
        for each in ("k2", "k3", "t2"):
            spread = made.sources[f"gear.stiffness.{each}"].spread
            assert spread is not None
            off = getattr(made.gear.stiffness, each) / getattr(own.stiffness, each)
            assert abs(log(off)) < 1.5 * spread


def test_running_torque_tells_the_viscous_friction() -> None:
    speed = 2000 * 2 * pi / 60
    told = {"starting_torque": 0.05, "no_load_running_torque": 0.15, "no_load_running_speed": "2000 rpm"}
    friction = sw.Gear.from_datasheet(ratio=-100, **told).friction_input
    assert friction.steady(speed) == pytest.approx(0.15, rel=1e-12)
    falling = sw.Gear.from_datasheet(ratio=-100, **told | {"no_load_running_torque": 0.03}).friction_input
    assert (falling.coulomb, falling.breakaway, falling.viscous) == (0.03, 0.05, 0.0)


def test_a_backdriving_torque_stands_for_the_starting_torque_and_one_that_contradicts_it_is_told() -> None:
    assert sw.Gear.from_datasheet(ratio=-100, backdriving_torque=3.3).friction_input.breakaway == pytest.approx(0.033)
    both = sw.GearSet.from_datasheet(ratio=-100, starting_torque=0.034, backdriving_torque=33.0)
    assert "33" in both.note
    assert not sw.GearSet.from_datasheet(ratio=-100, starting_torque=0.034, backdriving_torque=3.3).note


@pytest.mark.parametrize("share", [0.6, 0.75])
def test_a_drive_at_constant_speed_has_the_efficiency_of_the_sheet(share: float) -> None:
    """Power out over power in, of a simulated drive under load."""
    speed, torque = 200.0, 87.0
    gear = sw.Gear.from_datasheet(
        ratio=-100, size=25, rated_torque=torque, efficiency=share, efficiency_speed=speed, transmission_accuracy="1e-6 arcmin"
    )
    taken = gear.friction_input.steady(speed) + torque / 100 + gear.friction_mesh.steady(speed / 100, load=torque) / 100
    assert torque / 100 / taken == pytest.approx(share, rel=1e-9)


def test_an_efficiency_that_friction_without_load_exceeds_is_told() -> None:
    found = sw.GearSet.from_datasheet(ratio=-100, size=25, rated_torque=87.0, efficiency=0.99, efficiency_speed="2000 rpm")
    assert "0.99" in found.note
    assert found.gear.friction_mesh == sw.Gear().friction_mesh


def test_the_held_spline_is_the_sign_of_the_ratio() -> None:
    assert sw.Gear.from_datasheet(ratio=-100).kinematics.ratio == -100.0
    assert sw.Gear.from_datasheet(ratio=100, fixed="circular_spline").kinematics.ratio == -100.0
    assert sw.Gear.from_datasheet(ratio=100, fixed="flexspline").kinematics.ratio == 101.0


SHEET = """name = "LHT-20-80"
maker = "another maker"
source = "data sheet of 2024"

[datasheet]
ratio = -80
k1 = "0,47 kgf·m/arcmin"
rated_torque = "44 N.m"
efficiency = 0.7
efficiency_speed = "2000 rpm"
"""


def test_a_data_sheet_in_a_file_is_read_as_a_gear_set_and_saved_as_one(tmp_path: Path) -> None:
    file = tmp_path / "sheet.toml"
    file.write_text(SHEET, encoding="utf-8")
    found = sw.GearSet.read(file)
    assert (found.name, found.maker, found.ratings["rated_torque"].value) == ("LHT-20-80", "another maker", 44.0)
    assert published(found, "output")["K1"] == pytest.approx(0.47 * 9.80665 * 10800 / pi)
    assert sw.load(file) == found.gear
    found.save(tmp_path / "gear.toml")
    assert sw.GearSet.read(tmp_path / "gear.toml") == found


@pytest.mark.parametrize(
    ("figures", "message"),
    [
        ({"ratio": 100}, "leaves the fixed part open"),
        ({"ratio": -72.3}, "whole number"),
        ({"ratio": -1e308}, "whole number"),
        ({"ratio": -100, "k1": f"1 {10**6 * ' '}x"}, r"^k1 = .* has 1000003 characters; a figure has at most 200$"),
        ({"ratio": 0}, "does not say|whole number"),
        ({"ratio": float("nan")}, "ratio"),
        ({"ratio": -100, "fixed": "wave_generator"}, "must be one of"),
        ({"ratio": -100, "fixed": "flexspline"}, "without sign"),
        ({"ratio": -100, "k1": "31e3 N.m"}, 'k1: cannot convert "N.m" to "N.m/rad"'),
        ({"ratio": -100, "k1": "31e3"}, "has no unit"),
        ({"ratio": -100, "k1": "soft"}, "must be a number and its unit"),
        ({"ratio": -100, "k1": "31,000 N.m/rad"}, "the comma"),
        ({"ratio": -100, "k1": -3.0}, "must lie in"),
        ({"ratio": -100, "k1": 0.0}, "must lie in"),
        ({"ratio": -100, "t1": 48.0, "t2": 14.0}, "interchanged"),
        ({"ratio": -100, "size": 14, "t1": 48.0}, "give both"),
        ({"ratio": -100, "no_load_running_torque": 0.1}, "belong together"),
        ({"ratio": -100, "efficiency": 0.8}, "efficiency needs"),
        ({"ratio": -100, "efficiency": 80, "efficiency_speed": 200.0, "rated_torque": 87.0}, "0.8"),
        ({"ratio": -100, "size": -5}, "size"),
        ({"ratio": -100, "size": 1e300}, r"^size = 1e\+300 must lie in \[1, 1000\]$"),
        ({"ratio": -100, "spread": 1e300}, r"^spread = 1e\+300 must lie in \[0, 10\]$"),
        ({"ratio": -100, "k1": 1e300}, r"^k1 = 1e\+300 N.m/rad must lie in \[1e-06, 1e\+12\]$"),
        ({"ratio": -100, "k1": 10**400}, "^k1 = 1000.* is too large a number$"),
        ({"ratio": -100, "k1": "1e3 x 10^999 N.m/rad"}, "^k1 = .* must be finite$"),
        ({"ratio": -100, "k1": "\u0661\u0662 N.m/rad"}, "must be a number and its unit"),
        ({"ratio": -100, "maximum_input_speed": "5e-324 r/min"}, r"^maximum_input_speed = 0.0 rad/s must lie in"),
        ({"ratio": -100, "size": 25, "hysteresis_loss": "20 arcmin"}, "wider than"),
    ],
)
def test_what_no_gear_can_have_is_refused(figures: dict[str, Any], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        sw.GearSet.from_datasheet(**figures)


def test_an_unknown_figure_and_one_of_another_kind_are_refused() -> None:
    with pytest.raises(TypeError, match="stifness is no figure"):
        sw.Gear.from_datasheet(ratio=-100, stifness=3.0)
    with pytest.raises(TypeError, match="k1 must be a number"):
        sw.Gear.from_datasheet(ratio=-100, k1=[3.0])


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("ratio = -80\n", "", "ratio is missing"),
        ('"0,47 kgf·m/arcmin"', "31e3", 'k1 = 31000.0 has no unit; write k1 = "31000.0 N.m/rad"'),
        ("k1", "k9", "k9: not a figure"),
        ("maker", "owner", "only name, maker and source may stand outside"),
        ('"LHT-20-80"', "5", "name must be a text"),
    ],
)
def test_a_file_that_is_wrong_is_refused_with_the_place(tmp_path: Path, old: str, new: str, message: str) -> None:
    file = tmp_path / "sheet.toml"
    file.write_text(SHEET.replace(old, new), encoding="utf-8")
    with pytest.raises(ValueError, match=message) as refused:
        sw.GearSet.read(file)
    assert str(refused.value).startswith(str(file))
