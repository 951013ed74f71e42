"""Gear files: what is read, what is refused and in which words, what survives writing."""

from __future__ import annotations

import math
import re
import subprocess
import sys
import tomllib
from collections.abc import Iterator
from operator import attrgetter
from pathlib import Path
from typing import Any

import pytest
import strainwave as sw
import tomlkit
from hypothesis import HealthCheck, assume, given, settings
from hypothesis import strategies as st
from strainwave import _core
from strainwave.files.entries import Entry, Quantity
from strainwave.files.gear_set import GearSet, load, save

from tests.strategies import drives, fitting, gears, made, models

ROOT = Path(__file__).resolve().parents[3]
DOCUMENT = (ROOT / "docs" / "gear-files.md").read_text(encoding="utf-8")

BASE = """
name = "Printed 20:1"

[kinematics]
model = "plain_ratio"
reduction = { value = 20.0, source = "counted" }

[stiffness]
model = "cubic"
a1 = { value = 716.2, unit = "N.m/rad", source = "torsion loop" }
a3 = { value = 2e6, unit = "N.m/rad3", source = "torsion loop" }
"""

# Examples may share one folder; the first of them pays for the imports.
untimed = settings(max_examples=40, suppress_health_check=[HealthCheck.function_scoped_fixture, HealthCheck.too_slow])


def exactly(message: str) -> str:
    return f"^{re.escape(message)}$"


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """An empty folder, which is the current one."""
    monkeypatch.chdir(tmp_path)
    return tmp_path


def with_line(old: str, new: str) -> str:
    """The base file with one line changed."""
    (line,) = [line for line in BASE.splitlines() if line.startswith(old)]
    return BASE.replace(line, new)


# What is read


def test_numbers_in_other_units_are_converted_to_si(folder: Path) -> None:
    text = with_line("a1", 'a1 = { value = 12.5, unit = "N.m/deg", uncertainty = 0.4, source = "x" }')
    text = text.replace("2e6", "2e3").replace("N.m/rad3", "kN.m/rad3")
    text += """
[kinematic_error]
model = "fourier"
order = { value = [2.0], source = "x" }
amplitude = { value = [3.0], unit = "arcmin", source = "x", spread = 0.5 }
phase = { value = [90.0], unit = "°", source = "x" }
[friction_input]
model = "stribeck"
coulomb = { value = 20.0, unit = "mN.m", source = "x" }
breakaway = { value = 3.0, unit = "Ncm", source = "x" }
stribeck_speed = { value = 10.0, unit = "rpm", source = "x" }
viscous = { value = 0.1, unit = "mN.m.s/rad", source = "x" }
[gear]
damping = { value = 1, unit = "N.m.s/rad", source = "x" }
input_inertia = { value = 21.0, unit = "g.cm2", source = "x" }
"""
    Path("my.toml").write_text(text, encoding="utf-8")
    gear_set = GearSet.read("my.toml")
    gear = gear_set.gear
    assert gear.stiffness.a1 == pytest.approx(12.5 * 180 / math.pi, rel=1e-15)
    assert gear.stiffness.a3 == 2e6
    assert gear.kinematic_error.amplitude[0] == pytest.approx(3 * math.pi / 10_800, rel=1e-15)
    assert gear.kinematic_error.phase[0] == pytest.approx(math.pi / 2, rel=1e-15)
    assert gear.friction_input.coulomb == pytest.approx(0.02, rel=1e-15)
    assert gear.friction_input.breakaway == pytest.approx(0.03, rel=1e-15)
    assert gear.friction_input.stribeck_speed == pytest.approx(math.pi / 3, rel=1e-15)
    assert gear.friction_input.viscous == pytest.approx(1e-4, rel=1e-15)
    assert gear.damping == 1.0
    assert gear.input_inertia == pytest.approx(2.1e-6, rel=1e-15)
    uncertainty = gear_set.sources["gear.stiffness.a1"].uncertainty
    assert uncertainty == pytest.approx(0.4 * 180 / math.pi, rel=1e-15)
    assert gear_set.sources["gear.kinematic_error.amplitude[0]"].spread == 0.5  # relative: the same in every unit


def test_a_table_left_out_does_nothing_and_says_so(folder: Path) -> None:
    Path("my.toml").write_text(BASE)
    gear_set = GearSet.read("my.toml")
    gear = gear_set.gear
    assert gear.kinematics == sw.kinematics.PlainRatio(reduction=20.0)
    assert gear.kinematic_error.error(1.0) == 0.0
    assert gear.friction_input.steady(3.0) == gear.friction_output.steady(3.0) == 0.0
    assert not gear.hysteresis.trace([0.0, 1e-3]).any()
    assert gear.damping == gear.input_inertia == 0.0
    not_given = {path for path, entry in gear_set.sources.items() if entry == Entry("not given")}
    noise = {f"gear.kinematic_noise.{field['name']}" for field in gear.kinematic_noise.fields}
    friction = {f"gear.friction_{place}.viscous" for place in ("input", "mesh", "output")}
    softening = {f"gear.softening.{field['name']}" for field in gear.softening.fields}
    assert not_given == noise | friction | softening | {"gear.damping", "gear.input_inertia"}
    gear_set.save("again.toml")
    assert GearSet.read("again.toml") == gear_set


def test_each_number_of_a_sequence_can_have_its_own_source(folder: Path) -> None:
    Path("my.toml").write_text(
        BASE
        + """
[hysteresis]
model = "maxwell_slip"
stiffness = { value = [300, 150.0], unit = "N.m/rad", source = "loop" }
breakaway = [
    { value = 200.0, unit = "mN.m", source = "loop", uncertainty = 30.0 },
    { value = 0.4, unit = "N.m", source = "assumed" },
]
"""
    )
    gear_set = GearSet.read("my.toml")
    assert gear_set.gear.hysteresis == sw.hysteresis.MaxwellSlip(stiffness=[300.0, 150.0], breakaway=[0.2, 0.4])
    sources = {path: entry for path, entry in gear_set.sources.items() if path.startswith("gear.hysteresis.")}
    assert sources == {
        "gear.hysteresis.stiffness[0]": Entry("loop"),
        "gear.hysteresis.stiffness[1]": Entry("loop"),
        "gear.hysteresis.breakaway[0]": Entry("loop", uncertainty=0.03),
        "gear.hysteresis.breakaway[1]": Entry("assumed"),
    }
    gear_set.save("again.toml")
    assert GearSet.read("again.toml") == gear_set


def test_a_byte_order_mark_and_windows_line_ends_are_no_matter(folder: Path) -> None:
    Path("my.toml").write_text(BASE)
    Path("windows.toml").write_bytes(b"\xef\xbb\xbf" + BASE.replace("\n", "\r\n").encode())
    assert GearSet.read("windows.toml") == GearSet.read("my.toml")


# What is refused

SPRINGS = '"linear" or "piecewise" or "three_segment" or "cubic" or "multi_compliance" or "backlash"'
STIFFNESS = f"write model = {SPRINGS}"
LAWS = (
    '"viscous" or "coulomb" or "stribeck" or "position_dependent" or "lugre" or "maxwell_slip_friction" or "load_dependent" '
    'or "mixed_lubrication" or "curved_viscous" or "angle_speed_map" or "torque_efficiency" or "asymmetric"'
)
PARTS = (
    "name, maker, note, ratings, kinematics, kinematic_error, kinematic_noise, stiffness, hysteresis, friction_input, "
    "friction_mesh, friction_output, softening, stiffness_variation, structure, gear, motor, control, load, sensors, "
    "thermal, meter"
)
HYSTERESIS = """
[hysteresis]
model = "maxwell_slip"
stiffness = { value = [300.0, 150.0], unit = "N.m/rad", source = "loop" }
breakaway = """
TEETH = """model = "strain_wave"
flexspline_teeth = { value = 40, source = "counted" }
circular_spline_teeth = { value = 42, source = "counted" }
fixed = "circular_spline"
"""
THERMAL = """
[friction_mesh]
model = "thermal"
dry_fall = { value = 0.0, unit = "1/K", source = "assumed" }
viscous_fall = { value = 25e-3, unit = "1/K", source = "two runs" }
reference_temperature = { value = 20.0, unit = "degC", source = "thermometer" }
"""
VISCOUS = """
[friction_mesh.law]
model = "viscous"
viscous = { value = 0.5, unit = "N.m.s/rad", source = "run" }
"""
GRID = """
[hysteresis]
model = "preisach"
[hysteresis.density]
model = "grid_density"
limit = { value = 3.0, unit = "arcmin", source = "loop" }
weight = { value = [1.0, 2.0, 1.0], unit = "N.m", source = "loop" }
"""
WHOLE = BASE.replace('model = "plain_ratio"\nreduction = { value = 20.0, source = "counted" }\n', TEETH)

REFUSED = {
    # the file as a whole
    "": "my.toml is empty",
    "# nothing but a comment\n": "my.toml is empty",
    # names and tables
    with_line("name", ""): 'my.toml name is missing; write name = "…"',
    with_line("name", "name = ''"): "my.toml name = '' must be one line of text",
    with_line("name", "name = 'a'\nmaker = 3"): 'my.toml maker = 3 must be a text; write maker = "…"',
    with_line("name", "name = 'a'\ncolour = 3"): f"my.toml colour: not a part of a gear file; it has {PARTS}",
    with_line("[stiffness]", "[stifness]"): f"my.toml stifness: not a part of a gear file; it has {PARTS}",
    with_line("name", "name = 'a'\nload = 3"): (
        'my.toml load = 3 must be a table; write [load] with model = "inertia" or "pendulum" or "torsion_spring" or '
        '"aerodynamic" or "torque_table" or "brake" or "prescribed"'
    ),
    BASE[: BASE.index("[stiffness]")]: (
        f"my.toml stiffness is missing; write [stiffness] with model = {SPRINGS}"
    ),
    # models
    with_line('model = "cubic"', ""): f"my.toml [stiffness] has no model; {STIFFNESS}",
    with_line('model = "cubic"', 'model = "quartic"'): (
        f'my.toml [stiffness] model = "quartic" is not known; {STIFFNESS}'
    ),
    with_line('model = "cubic"', "model = 3"): f'my.toml [stiffness] model = "3" is not known; {STIFFNESS}',
    with_line('model = "cubic"', 'model = ["cubic"]'): (
        f"my.toml [stiffness] model = \"['cubic']\" is not known; {STIFFNESS}"
    ),
    # parameters
    with_line("a1", "k9 = 1.0"): "my.toml [stiffness] k9: not a parameter of cubic; it has a1, a3",
    with_line("a3", ""): (
        'my.toml [stiffness] a3 is missing; write a3 = { value = …, unit = "N.m/rad3", source = "…" }'
    ),
    BASE + "[gear]\ndamping = { value = 1, unit = 'N.m.s/rad', source = 'x' }\n": (
        'my.toml [gear] input_inertia is missing; write input_inertia = { value = …, unit = "kg.m2", source = "…" }'
    ),
    BASE + "[gear]\nmodel = 'x'\n": "my.toml [gear] model: not a parameter of gear; it has damping, input_inertia",
    # numbers; the common tail shows how the entry is written
    with_line("a1", "a1 = 716.2"): "my.toml [stiffness] a1 = 716.2 must be a table; " + (
        'write a1 = { value = 716.2, unit = "N.m/rad", source = "…" }'
    ),
    with_line("a1", "a1 = { value = 716.2 }"): (
        'my.toml [stiffness] a1 has no unit; write a1 = { value = 716.2, unit = "N.m/rad", source = "…" }'
    ),
    with_line("a1", 'a1 = { value = 716.2, unit = "N.m/rad" }'): (
        'my.toml [stiffness] a1 has no source; write a1 = { value = 716.2, unit = "N.m/rad", source = "…" }'
    ),
    WHOLE.replace("value = 40, ", ""): (
        'my.toml [kinematics] flexspline_teeth has no value; write flexspline_teeth = { value = …, source = "…" }'
    ),
    with_line("a1", "a1 = { value = 1.0, unit = 'N.m/rad', source = '' }"): (
        "my.toml [stiffness] a1: source = '' must be one line of text"
    ),
    with_line("a1", "a1 = { value = 1.0, unit = 'N.m/rad', source = 'x', spread = -0.3 }"): (
        "my.toml [stiffness] a1: spread = -0.3 must lie in [0, inf)"
    ),
    with_line("a1", "a1 = { value = 1.0, unit = 'N.m', source = 'x' }"): (
        'my.toml [stiffness] a1: cannot convert "N.m" to "N.m/rad"'
    ),
    with_line("a1", "a1 = { value = 1.0, unit = 'N.m/rd', source = 'x' }"): (
        'my.toml [stiffness] a1: unit "N.m/rd" is not known; write it like N.m, rad/s, deg'
    ),
    with_line("a1", "a1 = { value = -716.2, unit = 'N.m/rad', source = 'x' }"): (
        "my.toml [stiffness] cubic.a1 = -716.2 N.m/rad must lie in (0, inf)"
    ),
    with_line("a1", "a1 = { value = 1e308, unit = 'kN.m/rad', source = 'x' }"): (
        "my.toml [stiffness] a1: 1e+308 kN.m/rad is too large a number in N.m/rad"
    ),
    # choices and counts
    WHOLE.replace('"circular_spline"', '"wave"'): (
        "my.toml [kinematics] strain_wave.fixed must be 'circular_spline' or 'flexspline', not 'wave'"
    ),
    WHOLE.replace('"circular_spline"', "1"): (
        'my.toml [kinematics] fixed = 1 must be a text; write fixed = "circular_spline"'
    ),
    WHOLE.replace("40", "40.5"): (
        "my.toml [kinematics] strain_wave.flexspline_teeth must be a whole number, not 40.5"
    ),
    WHOLE.replace("40", "42"): (
        "my.toml [kinematics] strain_wave: circular_spline_teeth must exceed flexspline_teeth"
    ),
    WHOLE.replace("40, ", "40, unit = 'rad', "): (
        'my.toml [kinematics] flexspline_teeth: cannot convert "rad" to "1"'
    ),
    # sequences
    BASE + HYSTERESIS + "{ value = [0.2], unit = 'N.m', source = 'x' }": (
        "my.toml [hysteresis] maxwell_slip: stiffness and breakaway must have equally many elements"
    ),
    BASE + HYSTERESIS + "{ value = [0.2, -1.0], unit = 'N.m', source = 'x' }": (
        "my.toml [hysteresis] maxwell_slip.breakaway[1] = -1 N.m must lie in [0, inf)"
    ),
    BASE + HYSTERESIS + "{ value = [], unit = 'N.m', source = 'x' }": (
        "my.toml [hysteresis] breakaway = {'source': 'x', 'unit': 'N.m', 'value': []} must be a list; "
        'write breakaway = { value = […], unit = "N.m", source = "…" }, or [] for none'
    ),
    BASE + HYSTERESIS + "[0.2, 0.4]": (
        "my.toml [hysteresis] breakaway[0] = 0.2 must be a table; "
        'write breakaway = { value = […], unit = "N.m", source = "…" }, or [] for none'
    ),
    BASE + HYSTERESIS + "{ value = [0.2, 'x'], unit = 'N.m', source = 'x' }": (
        "my.toml [hysteresis] breakaway[1] = 'x' must be a number; "
        'write breakaway = { value = […], unit = "N.m", source = "…" }, or [] for none'
    ),
    BASE + HYSTERESIS + "[{ value = 0.2, unit = 'N.m', source = 'x' }, { value = 0.2, unit = 'rad', source = 'x' }]": (
        'my.toml [hysteresis] breakaway: cannot convert "rad" to "N.m"'
    ),
    # models inside models
    BASE + "[hysteresis]\nmodel = 'frictional_windup'\nfriction = { value = 1.0, unit = 'N.m', source = 'x' }\n": (
        "my.toml [hysteresis] springs is missing; write [hysteresis.springs]"
    ),
    BASE + THERMAL: (
        f'my.toml [friction_mesh] law is missing; write [friction_mesh.law] with model = {LAWS} or "cyclic"'
    ),
    BASE + THERMAL + "law = 3.0\n": (
        f'my.toml [friction_mesh] law = 3.0 must be a table; write [friction_mesh.law] with model = {LAWS} or "cyclic"'
    ),
    BASE + THERMAL + VISCOUS.replace('model = "viscous"', ""): (
        f'my.toml [friction_mesh.law] has no model; write model = {LAWS} or "cyclic"'
    ),
    BASE + THERMAL + VISCOUS.replace('"viscous"', '"thermal"'): (
        f'my.toml [friction_mesh.law] model = "thermal" is not known; write model = {LAWS} or "cyclic"'
    ),
    BASE + THERMAL + VISCOUS.replace("viscous =", "viscosity ="): (
        "my.toml [friction_mesh.law] viscosity: not a parameter of viscous; it has viscous"
    ),
    BASE + THERMAL + VISCOUS.replace("unit = ", "units = "): (
        "my.toml [friction_mesh.law] viscous: an entry has no units; "
        'write viscous = { value = …, unit = "N.m.s/rad", source = "…" }'
    ),
    BASE + THERMAL + VISCOUS.replace("N.m.s/rad", "N.m"): (
        'my.toml [friction_mesh.law] viscous: cannot convert "N.m" to "N.m.s/rad"'
    ),
    BASE + THERMAL + VISCOUS.replace("0.5", "-0.5"): (
        "my.toml [friction_mesh.law] viscous.viscous = -0.5 N.m.s/rad must lie in [0, inf)"
    ),
    BASE + THERMAL.replace("20.0", "-273.15") + VISCOUS: (
        "my.toml [friction_mesh] thermal.reference_temperature = 0 K must lie in (0, inf)"
    ),
    BASE + THERMAL + "[friction_mesh.law]\nmodel = 'cyclic'\norder = { value = [2.0], source = 'x' }\n": (
        "my.toml [friction_mesh.law] amplitude is missing; "
        'write amplitude = { value = […], source = "…" }, or [] for none'
    ),
    BASE + GRID.replace("density]", "densities]"): (
        "my.toml [hysteresis] densities: not a parameter of preisach; it has density"
    ),
    BASE + GRID.replace("2.0, ", ""): (
        "my.toml [hysteresis.density] grid_density: weight must have 1, 3, 6, 10, ... elements, n (n + 1) / 2"
    ),
    BASE + GRID.replace("2.0", "-2.0"): (
        "my.toml [hysteresis.density] grid_density.weight[1] = -2 N.m must lie in [0, inf)"
    ),
    BASE + GRID.replace('"grid_density"', '"grid"'): (
        'my.toml [hysteresis.density] model = "grid" is not known; write model = "power_density" or "grid_density"'
    ),
    # ratings
    BASE + "[ratings]\npeak_torque = 4.0": (
        "my.toml [ratings] peak_torque = 4.0 must be a table; "
        'write peak_torque = { value = 4.0, unit = "…", source = "…" }'
    ),
    BASE + "[ratings]\npeak_torque = { value = 4.0, unit = 'N.n', source = 'x' }": (
        'my.toml [ratings] peak_torque: unit "N.n" is not known; write it like N.m, rad/s, deg'
    ),
}  # fmt: skip

ENTRY = {
    "nan": "a1 = nan must be finite",
    "-inf": "a1 = -inf must be finite",
    "'soft'": "a1 = 'soft' must be a number",
    "true": "a1 = True must be a number",
    "[716.2]": "a1 = [716.2] must be a number",
    "{}": "a1 = {} must be a number",
    "1" + 400 * "0": "a1 = 100000000000000000...0000000000000000000 must be a number",
    "1.0, sprad = 0.3": "a1: an entry has no sprad",
    "1.0, spread = nan": "a1.spread = nan must be finite",
    "1.0, uncertainty = 'big'": "a1.uncertainty = 'big' must be a number",
}
REFUSED |= {
    with_line("a1", f"a1 = {{ value = {value}, unit = 'N.m/rad', source = 'x' }}"): (
        f'my.toml [stiffness] {words}; write a1 = {{ value = …, unit = "N.m/rad", source = "…" }}'
    )
    for value, words in ENTRY.items()
}


@pytest.mark.parametrize("key", [r"\u001b[31m\n", r"\u202e", 10_000 * "x"], ids=["escape", "from right to left", "long"])
@pytest.mark.parametrize(
    "text",
    [
        'name = "a"\n"{}" = 1',
        'name = "a"\n[stiffness]\nmodel = "{}"',
        'name = "a"\n[ratings]\n"{}" = 1',
        '"{0}" = 1\n"{0}" = 2',
    ],
)
def test_what_a_file_holds_is_told_in_one_short_line(folder: Path, text: str, key: str) -> None:
    Path("my.toml").write_text(text.format(key), encoding="utf-8")
    with pytest.raises(ValueError, match=r"^my\.toml ") as told:
        GearSet.read("my.toml")
    assert str(told.value).isprintable()
    assert len(str(told.value)) < 500


@pytest.mark.parametrize(("text", "message"), REFUSED.items(), ids=REFUSED.values())
def test_what_is_wrong_is_refused_in_one_line_with_its_place(folder: Path, text: str, message: str) -> None:
    Path("my.toml").write_text(text, encoding="utf-8")
    with pytest.raises(ValueError, match=exactly(message)):
        load("my.toml")


def test_what_cannot_be_read_is_refused(folder: Path) -> None:
    with pytest.raises(ValueError, match=exactly("my.toml cannot be read: No such file or directory")):
        load("my.toml")
    with pytest.raises(ValueError, match=exactly(f"{folder} cannot be read: Is a directory")):
        load(folder)


@pytest.mark.parametrize(
    ("content", "reason"),
    [
        (b"name = 'a'\nname = 'b'\n", r"Cannot overwrite a value \(at line 2, column 11\)"),
        (b"\n\n[stiffness\n", r"Expected '\]' at the end of a table declaration \(at line 3, column 11\)"),
        (b"a1\n", r"Expected '=' after a key in a key/value pair \(at line 1, column 3\)"),
        (b"name = '\xff'", "'utf-8' codec can't decode byte 0xff"),
        (b"x = " + 9_999 * b"[", ""),
    ],
)
def test_what_is_no_toml_is_refused_with_the_line(folder: Path, content: bytes, reason: str) -> None:
    Path("my.toml").write_bytes(content)
    with pytest.raises(ValueError, match=rf"^my\.toml is not valid TOML: {reason}"):
        load("my.toml")


TABLES = ("kinematics", "kinematic_error", "kinematic_noise", "stiffness", "hysteresis", "motor", "control")
PLACES = ("friction_input", "friction_mesh", "friction_output")


def filled(model: Any) -> Any:
    """A model in which no sequence is empty: one without numbers might do nothing, and need no table."""
    if hasattr(model, "law"):
        return made(model)
    return made(model, **{field["name"]: [fitting(field)] for field in model.fields if field["kind"] == "sequence"})


def with_law(**parts: Any) -> sw.Drive:
    """A drive with these parts, of its gear or its own."""
    drive = sw.Drive(motor=sw.motor.BrushlessDC())  # whose current any controller may act on
    of_gear = {name: parts.pop(name) for name in list(parts) if hasattr(drive.gear, name)}
    return drive.replace(gear=drive.gear.replace(**of_gear), **parts)


def every_model() -> Iterator[tuple[tuple[str, ...], Any, dict[str, Any]]]:
    """Every model in every table: the keys to it, its class, and the part of a drive that holds it."""
    families = _core.families
    for table in TABLES:
        yield from (((table,), model, {table: filled(model)}) for model in families[table].values())
    for place in PLACES:
        for model in families["friction"].values():
            yield (place,), model, {place: filled(model)}
            if model is not sw.friction.Thermal:
                yield (place, "law"), model, {place: sw.friction.Thermal(law=filled(model))}
                if model is not sw.friction.Cyclic:
                    cyclic = sw.friction.Cyclic(law=filled(model), order=[2.0], amplitude=[0.5], phase=[1.0])
                    yield (place, "law", "law"), model, {place: sw.friction.Thermal(law=cyclic)}
    for model in families["density"].values():
        yield ("hysteresis", "density"), model, {"hysteresis": sw.hysteresis.Preisach(density=filled(model))}


MODELS = [pytest.param(keys, model, part, id=f"{'.'.join(keys)}-{model.name}") for keys, model, part in every_model()]


@pytest.mark.parametrize(("keys", "model", "part"), MODELS)
def test_no_parameter_of_any_model_may_be_left_out(
    folder: Path, keys: tuple[str, ...], model: Any, part: dict[str, Any]
) -> None:
    whole = GearSet.of(with_law(**part), name="x", source="x")
    whole.replace(sources=dict.fromkeys(whole.sources, Entry("x"))).save("whole.toml")
    for parameter in model.fields:
        document = tomlkit.parse(Path("whole.toml").read_text(encoding="utf-8"))
        table: Any = document
        for key in keys:
            table = table[key]
        if parameter["kind"] == "part" and parameter["name"] not in table:
            continue  # a part that does nothing has no table
        del table[parameter["name"]]
        Path("my.toml").write_text(tomlkit.dumps(document), encoding="utf-8")
        header = re.escape(f"[{'.'.join(keys)}]")
        with pytest.raises(ValueError, match=rf"^my\.toml {header} {parameter['name']} is missing; write "):
            load("my.toml")


@pytest.mark.parametrize(("keys", "model", "part"), MODELS)
def test_every_model_is_written_and_read_in_every_table(
    folder: Path, keys: tuple[str, ...], model: Any, part: dict[str, Any]
) -> None:
    """Each number with a source of its own, so that none is taken for another."""
    drive = with_law(**part)
    one = GearSet.of(drive, name="x", source="x")
    gear_set = one.replace(sources={path: Entry(path, uncertainty=float(i)) for i, path in enumerate(one.sources)})
    gear_set.save("my.toml")
    table: Any = tomllib.loads(Path("my.toml").read_text(encoding="utf-8"))
    for key in keys:
        table = table[key]
    assert table["model"] == model.name
    again = GearSet.read("my.toml")
    assert again == gear_set
    assert repr(again.drive) == repr(drive)


def test_models_inside_models_are_read_with_units_and_sources(folder: Path) -> None:
    Path("my.toml").write_text(BASE + THERMAL + VISCOUS + GRID, encoding="utf-8")
    gear_set = GearSet.read("my.toml")
    law = sw.friction.Thermal(law=sw.friction.Viscous(viscous=0.5), viscous_fall=0.025, reference_temperature=293.15)
    assert gear_set.gear.friction_mesh == law
    assert gear_set.gear.hysteresis.density.limit == pytest.approx(math.radians(0.05), rel=1e-15)
    assert gear_set.gear.hysteresis.density.weight == (1.0, 2.0, 1.0)
    assert gear_set.sources["gear.friction_mesh.law.viscous"] == Entry("run")
    assert gear_set.sources["gear.friction_mesh.viscous_fall"] == Entry("two runs")
    assert gear_set.sources["gear.hysteresis.density.weight[2]"] == Entry("loop")


def test_an_idle_part_that_is_given_is_written_and_one_not_given_is_not(folder: Path) -> None:
    Path("my.toml").write_text(BASE)
    gear_set = GearSet.read("my.toml")
    gear_set.save("again.toml")
    assert tomllib.loads(Path("again.toml").read_text()).keys() == {"name", "kinematics", "stiffness"}
    source = {"gear.friction_mesh.viscous": Entry("assumed: none")}
    gear_set.replace(sources={**gear_set.sources, **source}).save("again.toml")
    assert tomllib.loads(Path("again.toml").read_text()).keys() == {"name", "kinematics", "stiffness", "friction_mesh"}


# What survives writing

printable = st.just(" ") | st.characters(exclude_categories=["C", "Z"])
lines = st.text(printable, min_size=1, max_size=8).filter(lambda text: text.strip() != "")
positive = st.floats(0.0, 1e300)
entries = st.builds(Entry, lines, st.none() | positive, st.none() | positive)
units = st.sampled_from(["1", "rad", "rpm", "N.m", "arcmin", "degC", "Nm/(rad/s)"])
ratings = st.builds(
    Quantity, lines, st.none() | positive, st.none() | positive,
    value=st.floats(allow_nan=False, allow_infinity=False), unit=units,
)  # fmt: skip


def innermost(law: Any) -> Any:
    return innermost(law.law) if hasattr(law, "law") else law


@st.composite
def gear_sets(draw: st.DrawFn) -> GearSet:
    """A set with any models, with or without the rest of a drive, each number with a source of its own."""
    families = {"motor": "motor", "control": "control", "load": "loads"}
    chosen = {part: draw(st.none() | models(family)) for part, family in families.items()}
    gear = draw(gears)
    motor, control = chosen["motor"], chosen["control"]
    fits = not isinstance(innermost(control), sw.control.Cascade | sw.control.StateFeedback)
    assume(fits or motor is None or isinstance(motor, sw.motor.BrushlessDC | sw.motor.PMSM))
    turns = gear.input_inertia > 0.0 and isinstance(gear.structure, sw.structure.Lumped)
    assume(turns or motor is None or motor.inertia > 0.0)  # something must turn at the input
    whole = {part: model for part, model in chosen.items() if model is not None}
    turned = whole if "motor" in whole else whole | {"motor": sw.motor.BrushlessDC()}
    paths = GearSet.of(sw.Drive(gear=gear, **turned), name="x", source="x").sources
    absent = tuple(f"{part}." for part in chosen.keys() - whole.keys())
    shared, own = draw(entries), draw(st.booleans())
    return GearSet(
        name=draw(lines),
        maker=draw(st.just("") | lines),
        note=draw(st.text(st.characters(exclude_categories=["Cs"]), max_size=20)),
        gear=gear,
        sources={path: draw(entries) if own else shared for path in paths if not path.startswith(absent)},
        ratings=draw(st.dictionaries(lines, ratings, max_size=3)),
        **chosen,
    )


@untimed
@given(gear_sets())
def test_a_set_written_and_read_is_equal_bit_for_bit(tmp_path: Path, gear_set: GearSet) -> None:
    gear_set.save(tmp_path / "set.toml")
    again = GearSet.read(tmp_path / "set.toml")
    assert again == gear_set
    assert repr(again) == repr(gear_set)  # tells -0.0 from 0.0
    assert repr(again.ratings) == repr(gear_set.ratings)


@untimed
@given(gear_sets())
def test_every_number_is_written_with_unit_and_source(tmp_path: Path, gear_set: GearSet) -> None:
    gear_set.save(tmp_path / "set.toml")
    document = tomllib.loads((tmp_path / "set.toml").read_text(encoding="utf-8"))
    document.pop("ratings", None)
    found = dict(entries_of(document))
    for path in gear_set.sources:
        whole = path.split("[")[0]
        part, _, key = whole.rpartition(".")
        (unit,) = [field["unit"] for field in attrgetter(part)(gear_set).fields if field["name"] == key]
        entry = found[whole.removeprefix("gear.") if whole.count(".") > 1 else whole]
        assert entry.keys() >= {"value", "unit", "source"}
        assert entry["unit"] == unit


def entries_of(content: Any, path: str = "") -> Iterator[tuple[str, dict[str, Any]]]:
    """Every entry of a document by its path, those of a list by that of the list."""
    if isinstance(content, list):
        for one in content:
            yield from entries_of(one, path)
    elif isinstance(content, dict) and "value" in content:
        yield path, content
    elif isinstance(content, dict):
        for key, inner in content.items():
            yield from entries_of(inner, f"{path}.{key}".removeprefix("."))


@untimed
@given(drives)
def test_a_drive_that_was_saved_is_loaded_and_so_is_its_gear(tmp_path: Path, drive: sw.Drive) -> None:
    for model in (drive, drive.gear):
        save(model, tmp_path / "model.toml", name="x", source="x")
        again = load(tmp_path / "model.toml")
        assert again == model
        assert repr(again) == repr(model)  # tells -0.0 from 0.0


def test_writing_that_fails_leaves_the_old_file_and_no_other(folder: Path) -> None:
    gear_set = GearSet.of(sw.Gear(), name="x", source="x")
    gear_set.save("my.toml")
    before = Path("my.toml").read_bytes()
    with pytest.raises(UnicodeEncodeError):
        gear_set.replace(note="\ud800").save("my.toml")
    assert [file.name for file in folder.iterdir()] == ["my.toml"]
    assert Path("my.toml").read_bytes() == before


# The module and its page


def test_importing_the_module_imports_no_heavy_one() -> None:
    code = "import strainwave.files.gear_file, sys; print({'pydantic', 'pint', 'tomlkit'} & sys.modules.keys())"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "set()"


def blocks(language: str) -> list[str]:
    return re.findall(rf"```{language}\n(.*?)```", DOCUMENT, re.DOTALL)


def write_examples() -> None:
    """The files of the page, each under the name its first line gives."""
    for example in blocks("toml"):
        Path(example.partition("\n")[0].removeprefix("# ")).write_text(example, encoding="utf-8")


def test_the_examples_of_the_page_are_read_as_they_are_meant(folder: Path) -> None:
    write_examples()
    gear_set = GearSet.read("mine.toml")
    assert gear_set.gear.kinematics.ratio == -20.0
    assert gear_set.gear.stiffness.a1 == pytest.approx(12.5 * 180 / math.pi, rel=1e-15)
    assert gear_set.gear.friction_input.breakaway == pytest.approx(0.025, rel=1e-15)
    assert gear_set.motor.inertia == pytest.approx(5e-6, rel=1e-15)
    run = sw.simulate(gear_set.drive, sw.scenario.step(amplitude=3.0, duration=0.1))
    assert run["input_angle"][-1] > 1.0
    assert load("mine.toml") == gear_set.drive
    varying = load("varying.toml")
    law = sw.friction.Coulomb(coulomb=0.02, breakaway=0.025, viscous=1e-4)
    assert varying.friction_input.law.law == law
    assert varying.friction_input.steady(1.0, angle=math.pi / 4) == pytest.approx(1.1 * law.steady(1.0), rel=1e-12)
    assert varying.friction_mesh.steady(1.0, load=5.0) == pytest.approx(1.0, rel=1e-12)
    assert varying.kinematic_noise.amplitude == pytest.approx(math.radians(0.1 / 60.0), rel=1e-14)
    assert varying.hysteresis.trace([0.0, math.radians(0.1)])[-1] == pytest.approx(0.2, rel=1e-12)


def test_the_gear_of_stages_of_the_page_is_read_as_it_is_meant(folder: Path) -> None:
    write_examples()
    gear = load("staged.toml")
    assert gear.structure.mesh_stiffness == pytest.approx(1e8, rel=1e-15)
    assert gear.structure.radial_mass == pytest.approx(gear.structure.flexspline_inertia / gear.structure.pitch_radius**2)
    assert gear.structure.bearing_variation == sw.variation.Periodic(order=[10], amplitude=[0.02], phase=[0.0])
    assert gear.structure.mesh_variation == sw.variation.Constant()
    assert gear.stiffness_variation.amplitude == (0.05,)
    gear_set = GearSet.read("staged.toml")
    gear_set.save("copy.toml")
    assert GearSet.read("copy.toml") == gear_set


def test_the_whole_drive_of_the_page_is_read_and_runs(folder: Path) -> None:
    write_examples()
    gear_set = GearSet.read("joint.toml")
    assert gear_set.control.period == pytest.approx(1e-3, rel=1e-15)
    assert gear_set.gear.friction_input.stribeck_speed == pytest.approx(math.pi, rel=1e-15)
    assert gear_set.thermal.initial_temperature == pytest.approx(293.15, rel=1e-15)
    run = sw.simulate(gear_set, sw.scenario.step(amplitude=0.2, duration=1.0))
    assert run["output_angle"][-1] == pytest.approx(0.2, rel=0.05)
    supplied, lost = run["energy_supplied"][-1], sum(run[name][-1] for name in run.names if name.startswith("energy_friction"))
    assert supplied > lost > 0.0
    gear_set.save("copy.toml")
    assert GearSet.read("copy.toml") == gear_set


def test_the_code_of_the_page_runs(folder: Path) -> None:
    write_examples()
    names: dict[str, Any] = {}
    for code in blocks("python"):
        exec(code, names)
    assert load("new.toml") == load("mine.toml")
    assert load("gear.toml") == load("mine.toml").gear
    assert GearSet.read("copy.toml") == GearSet.read("mine.toml")
    assert load("changed.toml").gear.friction_input.coulomb == 0.0213
    assert names["varying"].sources["gear.friction_input.law.amplitude[0]"] == Entry("slow run, one turn")


def test_the_errors_of_the_page_are_those_one_sees() -> None:
    (shown,) = blocks("text")
    seen = set(REFUSED.values()) | {"my.toml cannot be read: No such file or directory"}
    assert {line for line in shown.splitlines() if "valid TOML" not in line} <= seen
