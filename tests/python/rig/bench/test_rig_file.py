"""Files of rigs: what is read, what is refused and in which words, what survives writing."""

from __future__ import annotations

import dataclasses
import math
import re
from pathlib import Path

import pytest
import strainwave as sw
from hypothesis import HealthCheck, given, settings, strategies as st
from strainwave.rig.bench.rig_file import load, rigs, write_rig
from strainwave.rig.bench.setup import Camera, Masses, Rig, Value

BASE = """
name = "bench"

[loading]
side = "input"
disk_radius = { value = 100.0, unit = "mm", source = "calliper", uncertainty = 0.05 }
gravity = { value = 9.81, unit = "m/s2", source = "map" }

[[masses]]
mass = { value = 25.0, unit = "g", source = "balance", uncertainty = 0.01 }
count = 16

[target]
markers_distance = { value = 15.0, unit = "cm", source = "ruler" }

[camera]
tilt = { value = 2.0, unit = "deg", source = "bubble level" }
centre = { value = [320.0, 240.0], unit = "px", source = "chessboard" }
radial = [
    { value = 1e-8, unit = "1/px2", source = "chessboard" },
    { value = 0.0, unit = "1/px4", source = "chessboard" },
]
"""


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """An empty folder, which is the current one."""
    monkeypatch.chdir(tmp_path)
    return tmp_path


def read(text: str) -> Rig:
    Path("rig.toml").write_text(text, encoding="utf-8")
    return load("rig.toml")


def test_numbers_are_converted_to_si_with_their_uncertainty(folder: Path) -> None:
    rig = read(BASE)
    assert rig.disk_radius == Value(0.1, 0.05e-3, "calliper")
    assert rig.masses == (Masses(0.025, 16, 0.01e-3, "balance"),)
    assert rig.markers_distance == Value(0.15, 0.0, "ruler")
    assert rig.camera.tilt == math.radians(2.0)
    assert rig.camera.centre == (320.0, 240.0)
    assert rig.camera.radial == (1e-8, 0.0)
    assert rig.camera.sources["radial[0]"] == "chessboard"


def test_what_a_file_leaves_out_is_not_given(folder: Path) -> None:
    rig = read(BASE)
    assert (rig.cord, rig.pulley_torque, rig.compliance.source) == ("wound", Value(0.0), "not given")
    assert rig.markers_diameter is None


def test_the_rig_of_document_t_has_the_numbers_of_its_table_1() -> None:
    rig = load("couple-rig")
    assert 2.0 * rig.disk_radius.value == 0.2
    assert [(masses.mass, masses.count) for masses in rig.masses] == [(0.1, 9), (0.025, 16)]
    assert sum(masses.count for masses in rig.masses) == 25
    assert rig.side == "input"


def test_what_document_t_does_not_give_says_so() -> None:
    rig = load("couple-rig")
    for number in (rig.gravity, rig.pulley_share, rig.compliance):
        assert number.source.startswith("assumed")
    for number in (rig.cord_tangent, rig.pulley_torque):
        assert number.source == "not given"
    assert rig.markers_distance is None
    assert rig.camera == Camera()


def test_rigs_are_no_gears() -> None:
    assert rigs() == ["couple-rig"]
    assert "couple-rig" not in (*sw.catalogue(), *sw.catalogue("drives"))


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ('name = "bench"', "", 'rig.toml name is missing; write name = "…"'),
        (
            "[target]",
            "[targets]",
            "rig.toml targets: not a part of a rig file; it has name, note, masses, loading,",
        ),
        (
            "gravity",
            "gravitation",
            "rig.toml [loading] gravitation: not a number of [loading]; it has side, cord, disk_radius, gravity, cord_tangent, "
            "pulley_torque, pulley_share, compliance",
        ),
        ('unit = "mm"', 'unit = "N"', 'rig.toml [loading] disk_radius: cannot convert "N" to "m"'),
        ("disk_radius = { value = 100.0", "disk_radius = { value = -100.0", "disk_radius = -0.1 m must lie in [1e-30, 1e+12]"),
        ("value = 100.0", "value = nan", "rig.toml [loading] disk_radius = nan must be finite"),
        ('"input"', '"left"', 'rig.toml [loading] side = "left" must be one of input, output'),
        (', source = "calliper"', "", "rig.toml [loading] disk_radius has no source; write disk_radius = { value = 100.0"),
        ("uncertainty = 0.05", "spread = 0.05", "rig.toml [loading] disk_radius: an entry has no spread"),
        (
            "uncertainty = 0.05",
            "uncertainty = -0.05",
            "rig.toml [loading] disk_radius: uncertainty = -0.05 must lie in [0, inf)",
        ),
        ("count = 16", "count = 1.5", "rig.toml [[masses]] 1 count = 1.5 must be a whole number; write count = …"),
        ("value = 100.0", "value = 1e300", "disk_radius: value = 1e+297 must lie in [-1e+12, 1e+12]"),
        ("value = 100.0", "value = 5e-324", "disk_radius = 0.0 m must lie in [1e-30, 1e+12]"),
        ("uncertainty = 0.05", "uncertainty = 1e300", "disk_radius: sigma = 1e+297 must lie in [0, 1e+12]"),
        ("count = 16", "count = 10001", "rig.toml [[masses]] 1 count = 10001 must be 10000 or less"),
        ("count = 16", "count = 0", "rig.toml [[masses]] 1 count = 0 must be 1 or more"),
        ("count = 16", "number = 16", "rig.toml [[masses]] 1 number: not a number of [[masses]]; it has mass, count"),
        ("value = 25.0", "value = -25.0", "rig.toml [[masses]] 1 mass = -0.025 kg must lie in [1e-30, 1e+12]"),
        ("[320.0, 240.0]", "[320.0]", "rig.toml [camera] centre has 1 numbers; write centre = [{ value = …"),
        ('"1/px4"', '"1/px2"', 'rig.toml [camera] radial[1]: cannot convert "1/px2" to "1/px4"'),
        ("value = 2.0", "value = 91.0", "must lie in (-1.5708, 1.5708)"),
        ('"ruler"', '"ru\\nler"', "markers_distance: source = "),
        ("[[masses]]", "[masses]", "rig.toml masses = {'count': 16, "),
    ],
)
def test_what_is_wrong_is_refused_in_one_line(folder: Path, old: str, new: str, message: str) -> None:
    assert old in BASE
    with pytest.raises(ValueError, match=re.escape(message)) as refused:
        read(BASE.replace(old, new, 1))
    assert str(refused.value).startswith("rig.toml ")
    assert "\n" not in str(refused.value)


@pytest.mark.parametrize(
    ("name", "message"),
    [
        (
            "couple",
            'no rig "couple" comes with the package; near it are couple-rig; there are couple-rig, and',
        ),
        ("none.toml", "none.toml cannot be read: No such file or directory"),
    ],
)
def test_a_rig_that_is_not_there_is_refused(folder: Path, name: str, message: str) -> None:
    with pytest.raises(ValueError, match=re.escape(message)):
        load(name)


def test_a_file_that_is_not_toml_is_not_written(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match=r"rig\.json: the file of a rig ends in \.toml"):
        write_rig(load("couple-rig"), tmp_path / "rig.json")
    assert not list(tmp_path.iterdir())


sizes = st.floats(1e-6, 1e6)
lines = st.text(st.characters(codec="utf-8", categories=("L", "N", "P", "S")), min_size=1, max_size=30)
values = st.builds(Value, sizes, st.one_of(st.just(0.0), sizes), lines)
cameras = st.builds(
    Camera,
    aspect=sizes,
    tilt=st.floats(-1.5, 1.5),
    distance=st.none() | sizes,
    centre=st.none() | st.tuples(sizes, sizes),
    radial=st.tuples(sizes, sizes),
    sources=st.dictionaries(st.sampled_from(["aspect", "tilt", "radial[0]"]), lines),
)
made = st.builds(
    Rig,
    lines,
    st.sampled_from(["input", "output"]),
    values,
    gravity=values,
    masses=st.lists(st.builds(Masses, sizes, st.integers(1, 99), sizes, lines), max_size=3).map(tuple),
    cord=st.sampled_from(["wound", "fixed point"]),
    cord_tangent=values,
    pulley_torque=values,
    pulley_share=st.builds(Value, st.floats(0.0, 0.99), sizes, lines),
    compliance=values,
    markers_diameter=st.none() | values,
    markers_distance=st.none() | values,
    camera=cameras,
    note=lines | st.just(""),
)


@pytest.mark.slow("rig")
@settings(deadline=None, max_examples=60, suppress_health_check=[HealthCheck.function_scoped_fixture, HealthCheck.too_slow])
@given(rig=made)
def test_what_is_written_is_read_back_bit_for_bit(tmp_path: Path, rig: Rig) -> None:
    write_rig(rig, tmp_path / "rig.toml")
    assert load(tmp_path / "rig.toml") == rig


def test_a_rig_made_by_hand_is_checked_too() -> None:
    rig = load("couple-rig")
    with pytest.raises(ValueError, match=re.escape("pulley_share = 1.0 must lie in [0, 1)")):
        dataclasses.replace(rig, pulley_share=Value(1.0))
    with pytest.raises(ValueError, match=re.escape('cord = "loose" must be one of wound, fixed point')):
        dataclasses.replace(rig, cord="loose")  # type: ignore[arg-type]
