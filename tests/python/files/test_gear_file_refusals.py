"""Gear files: what is refused, and in which words."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from strainwave.files.gear_set import GearSet, load

from tests.python.files.gear_file_texts import BASE, GRID, THERMAL, VISCOUS, with_line

SPRINGS = '"linear" or "piecewise" or "three_segment" or "cubic" or "multi_compliance" or "two_sided" or "backlash"'
STIFFNESS = f"write model = {SPRINGS}"
LAWS = (
    '"viscous" or "coulomb" or "stribeck" or "position_dependent" or "lugre" or "maxwell_slip_friction" or "load_dependent" '
    'or "mixed_lubrication" or "curved_viscous" or "angle_speed_map" or "torque_efficiency" or "asymmetric"'
)
PARTS = (
    "name, maker, note, ratings, covariance, validation, kinematics, kinematic_error, kinematic_noise, stiffness, hysteresis, "
    "friction_input, friction_mesh, friction_output, softening, stiffness_variation, structure, material, gear, motor, "
    "control, load, sensors, thermal, meter"
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

WHOLE = BASE.replace('model = "plain_ratio"\nreduction = { value = 20.0, source = "counted" }\n', TEETH)


def exactly(message: str) -> str:
    return f"^{re.escape(message)}$"


REFUSED = {
    # the file as a whole
    "": "my.toml is empty",
    "# nothing but a comment\n": "my.toml is empty",
    # names and tables
    with_line("name", ""): 'my.toml name is missing; write name = "…"',
    with_line("name", "name = ''"): "my.toml name = '' must be one line of text",
    with_line("name", "name = 'a'\nmaker = 3"): 'my.toml maker = 3 must be a text; write maker = "…"',
    with_line("name", "name = 'a'\nbase = 'mine.toml'"): (
        'my.toml base = "mine.toml" is no set of the catalogue, which `strainwave list` lists'
    ),
    with_line("name", "name = 'a'\nbase = 3"): "my.toml base must be a text, not 3",
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


COVARIANCE = {
    "numbers = ['gear.stiffness.a1']": "matrix is missing; write matrix = [[…], …]",
    "numbers = 'a'\nmatrix = [[1.0]]": "numbers = 'a' must be a list; write numbers = [\"load.inertia\", …]",
    "numbers = ['load.inertia']\nmatrix = [[1.0, 2.0]]": "matrix must have 1 rows of 1 numbers, one for each of the numbers",
    "numbers = ['a', 'a']\nmatrix = [[1.0]]": "numbers must be 1 to 200 different paths; there are 2, 1 different",
    "numbers = ['a', 'b']\nmatrix = [[1.0, 2.0], [2.0, 1.0]]": "matrix has a correlation beyond 1: it is no covariance",
    "numbers = ['a', 'b']\nmatrix = [[1.0, 0.5], [0.4, 1.0]]": "matrix must be symmetric",
    "numbers = ['a']\nmatrix = [[0.0]]": "matrix must have variances above 0 on its diagonal, and finite numbers",
    "numbers = ['a', 'b']\nmatrix = [[1e-300, 1e300], [1e300, 1e-300]]": (
        "matrix has a correlation beyond 1: it is no covariance"
    ),
    "numbers = []\nmatrix = []\nunit = 'N.m'": "unit: not a key of a covariance; it has numbers, matrix",
}
REFUSED |= {f"{BASE}\n[covariance]\n{text}": f"my.toml [covariance] {message}" for text, message in COVARIANCE.items()}
REFUSED[f"{BASE}\n[covariance]\nnumbers = ['load.inertia']\nmatrix = [[1.0]]"] = (
    "my.toml covariance names load.inertia, which is no number of the set"
)
VALIDATED = (
    "file = 'a'\nkind = 'friction'\nchannel = 'torque'\nunit = 'N.m'\nvaries = 1.0\nheld_out = 0.1\nheld_out_varies = 1.0\n"
)
REFUSED |= {
    f"{BASE}\n[[validation]]\n{VALIDATED}{text}": f"my.toml [[validation]] {message}"
    for text, message in {
        "": "error is missing; write error = …",
        "error = -1.0": "error = -1.0 N.m must lie in [0, inf)",
        "error = 'x'": "error = 'x' must be a number; write error = …",
    }.items()
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
    assert len(str(told.value)) < 1000


@pytest.mark.parametrize(("text", "message"), REFUSED.items(), ids=REFUSED.values())
def test_what_is_wrong_is_refused_in_one_line_with_its_place(folder: Path, text: str, message: str) -> None:
    Path("my.toml").write_text(text, encoding="utf-8")
    with pytest.raises(ValueError, match=exactly(message)):
        load("my.toml")


def test_what_cannot_be_read_is_refused(folder: Path) -> None:
    with pytest.raises(ValueError, match=exactly("my.toml cannot be read: No such file or directory")):
        load("my.toml")
    with pytest.raises(ValueError, match=exactly(f"{folder}/gear.toml cannot be read: No such file or directory")):
        load(folder)


@pytest.mark.parametrize("part", ["a", '"a.\\" b"', "'.'", '""'])
def test_a_key_of_many_parts_is_refused(folder: Path, part: str) -> None:
    """It takes memory that grows with the square of its parts: 4 GB for 200 000."""
    Path("my.toml").write_text(f"{' . '.join(65 * [part])} = 1")
    with pytest.raises(ValueError, match=exactly("my.toml contains a key of more than 64 parts")):
        load("my.toml")
    Path("my.toml").write_text(f"[{'.'.join(65 * [part])}]")
    with pytest.raises(ValueError, match=exactly("my.toml contains a key of more than 64 parts")):
        load("my.toml")
    Path("my.toml").write_text(f"{'.'.join(64 * [part])} = 1")
    with pytest.raises(ValueError, match=r"^my\.toml .* is missing|not a part of a gear file"):
        load("my.toml")


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


def test_a_long_list_is_refused_by_its_length(folder: Path) -> None:
    """Each of its elements would be checked, which takes half a minute for 300 000."""
    Path("my.toml").write_text(BASE + HYSTERESIS.replace("[300.0, 150.0]", f"[{', '.join(1001 * ['1.0'])}]") + "[]")
    with pytest.raises(ValueError, match=exactly("my.toml [hysteresis] stiffness has 1001 elements; at most 1000 are read")):
        load("my.toml")
