"""What a person says of files in TOML."""

from __future__ import annotations

import re
from math import inf, nan
from pathlib import Path

import pytest
from hypothesis import given, strategies as st
from strainwave.identification.reading.mapping import CONSTANTS, FileMapping, MappingFile
from strainwave.identification.reading.names import CHANNELS

TEXT = """
side = "output"
[columns]
joint_torque = "Moment"
output_speed = 3
[units]
joint_torque = "mNm"
[sign]
joint_torque = -1
[constants]
rate = "0.5 kHz"
ratio = 80
["two_loads/*.csv"]
joint = 2
constants.load_inertia = 0.85
columns.joint_torque = "Last"
"""


def read_file(folder: Path, text: str) -> MappingFile:
    path = folder / "columns.toml"
    path.write_text(text)
    return MappingFile.read(path)


def test_a_mapping_holds_for_all_files_or_for_some(tmp_path: Path) -> None:
    file = read_file(tmp_path, TEXT.replace("0.5 kHz", "500 Hz"))
    general = FileMapping(
        columns={"joint_torque": "Moment", "output_speed": "3"},
        units={"joint_torque": "mNm"},
        sign={"joint_torque": -1},
        constants={"rate": 500.0, "ratio": 80.0},
        side="output",
    )
    assert file.of("log.csv") == general
    special = file.of(Path("/data/two_loads/heavy.csv"))
    assert special.columns == {"joint_torque": "Last", "output_speed": "3"}
    assert special.constants == {"rate": 500.0, "ratio": 80.0, "load_inertia": 0.85}
    assert (special.joint, special.side) == ("2", "output")


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("column.torque = 1", "column is not known; did you mean columns? The keys are columns, units, sign, "),
        ('columns.tork = "a"', "columns.tork is not known; did you mean torque? The channels are time, command, "),
        ("columns.torque = 1.5", "columns.torque = 1.5 must be a text"),
        ("columns = 3", "columns = 3 must be a table, with a line for each channel or constant"),
        ('units.torque = "furlong"', 'unit "furlong" is not known; write it like N.m, rad/s, deg'),
        ("sign.torque = 2", "sign of torque = 2 must be 1 or -1"),
        ("sign.torque = true", "sign of torque = True must be 1 or -1"),
        ("constants.ratoi = 80", "constants.ratoi is not known; did you mean ratio? The constants are rate, ratio, "),
        ('constants.rate = "fast"', 'constants.rate = "fast": it is no number in Hz'),
        ('constants.speed = "3 Nm"', 'constants.speed = "3 Nm": cannot convert "Nm" to "rad/s"'),
        ("constants.rate = true", "constants.rate = True must be a number in Hz, or a text with number and unit"),
        ("constants.rate = nan", "constants.rate = nan Hz must lie in [1e-06, 1e+09]"),
        ('side = "middle"', "side = 'middle' is not known; the sides are input, output"),
        ('kind = "torsoin"', "kind = 'torsoin' is not known; did you mean torsion? The kinds are "),
        ('["*.csv"]\ncolums.a = 1', '["*.csv"] colums is not known; did you mean columns? '),
        ('constants.rate = "-5"', 'constants.rate = "-5": constants.rate = -5.0 Hz must lie in [1e-06, 1e+09]'),
        ("constants.rate = inf", "constants.rate = inf Hz must lie in [1e-06, 1e+09]"),
        (f"constants.rate = 1{400 * '0'}", "constants.rate = 1000000"),
        ("constants.rate = 0x" + 4000 * "f", "constants.rate = <int with too many digits> is too large a number"),
        ("constants.ratio = 0", "constants.ratio = 0 must lie in [0.1, 10000] or [-10000, -0.1]"),
        ("constants.ratio = -20_000", "constants.ratio = -20000 must lie in [-10000, 10000]"),
        ("constants.torque_constant = 0", "constants.torque_constant = 0 N.m/A must lie in [1e-06, 1000]"),
        ("constants.temperature = 0.5", "constants.temperature = 0.5 K must lie in [1, 1000]"),
        ('constants.rate = "\u0661\u0662 Hz"', 'constants.rate = "\u0661\u0662 Hz": it is no number in Hz'),
        (f"constants.rate = {5000 * '9'}", "contains a whole number with too many digits"),
        (f"columns.speed = {5000 * '9'}", "contains a whole number with too many digits"),
        (f'columns.other_angles = "{",".join(101 * ["q"])}"', "columns.other_angles names 101 columns; at most 100 are taken"),
        ("".join(f'["*{place}"]\n' for place in range(1001)), "has 1001 patterns of file names; at most 1000 are read"),
        ("side = ", "is not valid TOML: Invalid value"),
        ("", "is empty"),
    ],
)  # fmt: skip
def test_what_is_not_known_is_refused_with_its_place(tmp_path: Path, text: str, message: str) -> None:
    separator = " " if message.startswith(("is ", "contains ")) else ": "
    begin = f"{tmp_path / 'columns.toml'}{separator}{message}"
    with pytest.raises(ValueError, match=f"^{re.escape(begin)}"):
        read_file(tmp_path, text)


@pytest.mark.parametrize("name", CONSTANTS)
@pytest.mark.parametrize("value", [inf, -inf, nan, 10**400, 1e300])
def test_a_constant_out_of_its_range_is_refused_however_it_is_given(name: str, value: float) -> None:
    with pytest.raises(ValueError, match=f"^--constant {name} = .* (must lie in|is too large a number)"):
        FileMapping(constants={name: value})


def test_other_digits_than_ascii_are_no_number() -> None:
    for text in ("\u0661\u0662", "1_0", "inf", "nan", "0x10", "1e400"):
        with pytest.raises(
            ValueError,
            match=r"^--constant rate = .* (it is no number in Hz, nor one with its unit, as '0.1 Hz'|is too large a number)$",
        ):
            FileMapping(constants={"rate": text})


def test_a_mapping_is_read_from_a_small_regular_file_alone(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match="/dev/zero is not a regular file"):
        MappingFile.read("/dev/zero")
    with pytest.raises(ValueError, match=r"columns\.toml has more than 2 MB"):
        read_file(tmp_path, "#" + 2**24 * " ")


def test_a_file_that_is_not_there_is_refused(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match=r"columns\.toml cannot be read: No such file or directory$"):
        MappingFile.read(tmp_path / "columns.toml")


names = st.dictionaries(st.sampled_from(sorted(CHANNELS)), st.text(min_size=1, max_size=5), max_size=3)
mappings = st.builds(FileMapping, columns=names, side=st.sampled_from([None, "input", "output"]))


@given(mappings, mappings, mappings)
def test_updates_are_associative_and_an_empty_one_changes_nothing(
    one: FileMapping, two: FileMapping, three: FileMapping
) -> None:
    assert one.updated(two).updated(three) == one.updated(two.updated(three))
    assert one.updated(FileMapping()) == one == FileMapping().updated(one)


def test_a_constant_is_a_number_or_a_text_with_its_unit() -> None:
    assert FileMapping(constants={"torque_constant": "75 mN.m/A"}).constants == {"torque_constant": 0.075}
    with pytest.raises(ValueError, match="torque_constant"):
        FileMapping(constants={"torque_constant": "75 N"})
