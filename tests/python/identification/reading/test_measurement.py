"""Measurements as files hold them: which columns are taken, in which units, and what is said where one is missing."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from strainwave.identification.reading.measurement import (
    COLUMNS,
    NEEDED,
    Kind,
    read_measurement,
    read_measurements,
    unused_columns,
)

FOLDER = settings(deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])


def exactly(message: str) -> str:
    return f"^{re.escape(message)}$"


def table(folder: Path, header: str, rows: str = "", name: str = "table.csv") -> Path:
    """A file with this header and two rows of numbers."""
    path = folder / name
    separator = ";" if ";" in header else ","
    count = header.count(separator) + 1
    path.write_text(header + "\n" + (rows or "".join(separator.join(count * [str(row)]) + "\n" for row in (1, 2))))
    return path


def needed(kind: Kind) -> list[str]:
    """Columns that make a measurement of this kind, with units."""
    return [f"{name} [{COLUMNS[kind][name][0]}]" for name in NEEDED[kind][0]]


kinds = st.sampled_from(sorted(COLUMNS))


@FOLDER
@given(kinds, st.data())
def test_a_column_is_known_by_its_name_in_other_letters(tmp_path: Path, kind: Kind, data: st.DataObject) -> None:
    names = data.draw(st.lists(st.sampled_from(list(COLUMNS[kind])), unique=True).map(lambda some: {*NEEDED[kind][0], *some}))
    names -= {"position"}
    change = data.draw(st.sampled_from([str.upper, str.title, lambda name: name.replace("_", " "), lambda name: name]))
    path = table(tmp_path, ",".join(f"{change(name)} [{COLUMNS[kind][name][0]}]" for name in names))
    assert set(read_measurement(kind, path).names) == names
    assert unused_columns(kind, path) == ()


def test_the_exact_name_is_taken_before_one_alike(tmp_path: Path) -> None:
    path = table(tmp_path, "Speed [rpm],speed [rad/s],torque [N.m],tau [N.m]")
    assert read_measurement("friction", path).unit("speed") == "rad/s"
    assert unused_columns("friction", path) == ("Speed", "tau")


def test_names_alike_are_refused_where_none_is_exact(tmp_path: Path) -> None:
    path = table(tmp_path, "TIME [s],Time [s],command [V]")
    hint = '--column time=TIME (in Python columns={"time": "TIME"})'
    with pytest.raises(ValueError, match=exactly(f"{path}: each of TIME, Time may be the time; say which, as with {hint}")):
        read_measurement("log", path)
    assert read_measurement("log", path, {"time": "Time"}).names == ("time", "command")


@pytest.mark.parametrize(
    ("kind", "header", "names"),
    [
        ("log", "t [s],command [V]", ("time", "command")),
        ("friction", "omega [rad/s],tau [N.m]", ("speed", "torque")),
        ("log", "time [s],command [V],position [deg]", ("time", "command", "input_angle")),
        ("log", "time [s],command [V],input_angle [deg],position [deg]", ("time", "command", "input_angle")),
        ("friction", "speed [rad/s],torque [N.m],temperature [degC]", ("speed", "torque", "temperature")),
    ],
)
def test_symbols_aliases_and_what_is_carried_along(tmp_path: Path, kind: Kind, header: str, names: tuple[str, ...]) -> None:
    assert read_measurement(kind, table(tmp_path, header)).names == names


@FOLDER
@given(kinds, st.lists(st.sampled_from(["Operator", "room [degC]", "x [m]", "Note"]), unique=True))
def test_columns_that_no_fit_uses_are_told(tmp_path: Path, kind: Kind, others: list[str]) -> None:
    path = table(tmp_path, ",".join([*others, *needed(kind)]))
    read_measurement(kind, path)
    assert unused_columns(kind, path) == tuple(other.split(" [")[0] for other in others)


@pytest.mark.parametrize(("kind", "header", "unused"), [
    ("friction", "speed [rpm],torque [N.m],temperature [K],room", ("room",)),
    ("log", "time [s],command [V],input_angle [deg],position [deg]", ("position",)),
    ("log", "Zeit [s],command [V],time", ("time",)),
])  # fmt: skip
def test_what_no_fit_uses_is_unused(tmp_path: Path, kind: Kind, header: str, unused: tuple[str, ...]) -> None:
    columns = {"time": "Zeit"} if "Zeit" in header else None
    assert unused_columns(kind, table(tmp_path, header), columns) == unused


@pytest.mark.parametrize("unit", ["1/min", "min-1", "U/min", "RPM", "rev/min"])
def test_speeds_in_the_units_of_data_sheets(tmp_path: Path, unit: str) -> None:
    recording = read_measurement("friction", table(tmp_path, f"speed [{unit}],torque [NM]"))
    assert recording.values("speed", "rpm").tolist() == [1.0, 2.0]
    assert recording.unit("torque") == "N.m"


CORRECT = 'correct its unit, or name another column with --column {0}=NAME (in Python columns={{"{0}": "NAME"}})'


@pytest.mark.parametrize(
    ("kind", "header", "message"),
    [
        (
            "friction",
            "n [1/s],torque [N.m]",
            ' column "n" cannot be the speed of a friction measurement: cannot convert "1/s" to "rad/s": '
            "it may count revolutions or radians; write rev/s or rad/s; " + CORRECT.format("speed"),
        ),
        (
            "log",
            "time [s],command [N.m]",
            ' column "command" cannot be the command of a log measurement: cannot convert "N.m" to "V" or "rad"; '
            + CORRECT.format("command"),
        ),
        (
            "torsion",
            "twist [m],torque [N.m]",
            ' column "twist" cannot be the twist of a torsion measurement: cannot convert "m" to "rad"; '
            + CORRECT.format("twist"),
        ),
    ],
)
def test_a_column_that_measures_something_else_is_refused(tmp_path: Path, kind: Kind, header: str, message: str) -> None:
    path = table(tmp_path, header)
    with pytest.raises(ValueError, match=exactly(f"{path}{message}")):
        read_measurement(kind, path, {"speed": "n"} if header.startswith("n ") else None)


@pytest.mark.parametrize(
    ("kind", "header", "message"),
    [
        (
            "log",
            "time [s],Spannung [V],Strom [A]",
            "a log measurement needs columns time and command; this file has time, Spannung, Strom. "
            'Name yours like --column command=Spannung (in Python columns={"command": "Spannung"})',
        ),
        (
            "friction",
            "rpm,torque [N.m],note",
            "a friction measurement needs columns speed and torque; this file has rpm, torque, note. "
            'Name yours like --column speed=rpm (in Python columns={"speed": "rpm"}) '
            '--unit speed=rpm (in Python units={"speed": "rpm"})',
        ),
        (
            "friction",
            "note,motor_speed_rpm,moment_Nm",
            "a friction measurement needs columns speed and torque; this file has note, motor_speed_rpm, moment_Nm. "
            'Name yours like --column speed=motor_speed_rpm (in Python columns={"speed": "motor_speed_rpm"}) '
            '--unit speed=rpm (in Python units={"speed": "rpm"}) '
            '--column torque=moment_Nm (in Python columns={"torque": "moment_Nm"}) '
            '--unit torque=Nm (in Python units={"torque": "Nm"})',
        ),
        (
            "log",
            "time [s],motor_angle [deg],reference [deg]",
            "a log measurement needs columns time and command; this file has time, motor_angle, reference. "
            'Name yours like --column command=reference (in Python columns={"command": "reference"})',
        ),
        (
            "torsion",
            "input_angle [rad],Shaft Torque [N.m]",
            "a torsion measurement needs columns twist and torque or input_angle and input_torque; "
            "this file has input_angle, Shaft Torque. Name yours like --column 'input_torque=Shaft Torque' "
            '(in Python columns={"input_torque": "Shaft Torque"})',
        ),
        (
            "friction",
            "torque [N.m]",
            "a friction measurement needs columns speed and torque; this file has torque. "
            'Name yours like --column speed=NAME (in Python columns={"speed": "NAME"})',
        ),
    ],
)
def test_the_column_that_is_missing_is_advised_with_a_candidate(tmp_path: Path, kind: Kind, header: str, message: str) -> None:
    path = table(tmp_path, header)
    with pytest.raises(ValueError, match=exactly(f"{path}: {message}")):
        read_measurement(kind, path)


@pytest.mark.parametrize(
    ("columns", "units", "message"),
    [
        ({"torqe": "torque"}, {}, 'a friction measurement has no column "torqe"; it has speed, torque, temperature'),
        ({"torque": "Moment"}, {}, '{path} has no column "Moment" to be the torque; it has speed, torque'),
        ({}, {"current": "A"}, '{path}: a unit is given for "current", which is not read; read are speed, torque'),
    ],
)
def test_names_and_units_of_what_is_not_there_are_refused(
    tmp_path: Path, columns: dict[str, str], units: dict[str, str], message: str
) -> None:
    path = table(tmp_path, "speed [rpm],torque [N.m]")
    with pytest.raises(ValueError, match=exactly(message.replace("{path}", str(path)))):
        read_measurement("friction", path, columns, units)


def test_a_name_applies_to_the_files_that_have_it(tmp_path: Path) -> None:
    friction = table(tmp_path, "speed [rpm],Moment", name="friction.csv")
    torsion = table(tmp_path, "twist [deg],torque [N.m]", name="torsion.csv")
    files: dict[Kind, Path] = {"friction": friction, "torsion": torsion}
    with pytest.raises(ValueError, match="needs columns speed and torque"):
        read_measurements(files)
    with pytest.raises(
        ValueError, match=exactly(f'{torsion} column "torque" is in "N.m", but the unit given for it is "N.cm"')
    ):
        read_measurements(files, {"torque": "Moment"}, {"torque": "N.cm"})
    read = read_measurements(files, {"torque": "Moment"}, {"torque": "Nm"})
    assert {kind: recording.names for kind, recording in read.items()} == {
        "friction": ("speed", "torque"),
        "torsion": ("twist", "torque"),
    }
    with pytest.raises(
        ValueError, match=exactly('no file has a column "Drehmoment" that can be the "torque" of a measurement')
    ):
        read_measurements(files, {"torque": "Drehmoment"})
    with pytest.raises(ValueError, match=exactly('a unit is given for "temperature", but no file has this column')):
        read_measurements(files, {"torque": "Moment"}, {"torque": "Nm", "temperature": "degC"})


def test_what_a_file_holds_is_told_in_one_short_line(tmp_path: Path) -> None:
    path = table(tmp_path, ",".join(f"\x1b[31m{number}{100 * 'x'}" for number in range(1000)))
    with pytest.raises(ValueError, match="this file has ") as told:
        read_measurement("friction", path)
    assert str(told.value).isprintable()
    assert len(str(told.value)) < 500


def test_columns_of_a_table_without_a_header_are_named_by_their_numbers(tmp_path: Path) -> None:
    path = tmp_path / "table.txt"
    path.write_text("7 10 0.1\n7 20 0.2\n")
    columns, units = {"speed": "2", "torque": "3"}, {"speed": "rpm", "torque": "N.m"}
    recording = read_measurement("friction", path, columns, units)
    assert (recording["speed"].tolist(), recording["torque"].tolist()) == ([10.0, 20.0], [0.1, 0.2])
    assert unused_columns("friction", path, columns) == ("column_1",)
    assert read_measurements({"friction": path}, columns, units)["friction"] == recording
    with pytest.raises(ValueError, match=r'has no column "4" to be the torque; it has column_1, column_2, column_3$'):
        read_measurement("friction", path, {"speed": "2", "torque": "4"}, units)
