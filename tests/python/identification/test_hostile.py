"""Files as they should not be: each is used and it is said how, or refused with reason and remedy; none crashes."""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
import strainwave as sw
from strainwave.identification.identify import Identified, identify
from strainwave.identification.reading.mapping import FileMapping
from strainwave.identification.reading.recognise import recognise
from strainwave.identification.reading.several_files import same_as
from strainwave.questions import QuestionError
from strainwave.report.identify_files import identify_files, identify_summary

from tests.python.command import strainwave
from tests.python.identification.candidates.test_motion import TRUTH, record
from tests.python.identification.kinds.test_further_kinds import SPEEDS, table, write

CONSTANT = 0.08  # N.m/A
UNITS = {"speed": "rad/s", "torque": "N.m"}
SPEED = np.array([*SPEEDS, *(-each for each in SPEEDS)])
TORQUE = np.sign(SPEED) * (0.05 + 3e-4 * np.abs(SPEED))
LOG = record(TRUTH, 0.05, 3)
CURRENT, ANGLE = LOG["current"], LOG.values("input_angle", "rad")


def motor_of(start: sw.GearSet) -> sw.GearSet:
    motor = sw.motor.DC(resistance=0.4, torque_constant=CONSTANT, back_emf=CONSTANT, inertia=1e-4 - start.gear.input_inertia)
    sources = {f"motor.{each['name']}": sw.files.Entry("measured", uncertainty=0.0) for each in motor.fields}
    return start.replace(motor=motor, sources={**start.sources, **sources})


START = motor_of(sw.GearSet.read("hfuc-20-80"))
Make = Callable[[Path], Path]


def text(name: str, content: str | bytes) -> Make:
    def make(folder: Path) -> Path:
        (folder / name).write_bytes(content if isinstance(content, bytes) else content.encode())
        return folder / name

    return make


def log(**changed: np.ndarray) -> Make:
    def make(folder: Path) -> Path:
        recording = LOG
        for name, values in changed.items():
            recording = recording.with_column(name, values, LOG.unit(name))
        recording.to_csv(folder / "log.csv")
        return folder / "log.csv"

    return make


def friction(speed: object, torque: object) -> Make:
    return lambda folder: write(folder / "table.csv", {"speed": speed, "torque": torque}, UNITS)


def twisted(twist_factor: float = 1.0, torque_factor: float = 1.0, limit: float = np.inf) -> Make:
    twist = 1.5e-3 * np.interp(np.linspace(0.0, 5.0, 200), range(6), [0, 1, -1, 1, -1, 1])
    torque = np.clip(np.asarray(START.gear.trace(twist)), -limit, limit) * torque_factor
    columns = {"twist": twist * twist_factor, "torque": torque}
    return lambda folder: write(folder / "loop.csv", columns, {"twist": "rad", "torque": "N.m"})


def folder_of(*, empty: bool) -> Make:
    def make(folder: Path) -> Path:
        (folder / "bench").mkdir()
        (folder / "bench" / "notes.md").write_text("a note")
        if not empty:
            table(folder / "bench" / "table.csv")
        return folder / "bench"

    return make


def with_texts() -> str:
    rows = [
        f"{speed}{' 1/min' if place % 2 else ''},{torque}"
        for place, (speed, torque) in enumerate(zip(SPEED, TORQUE, strict=True))
    ]
    return "\n".join(["speed [rad/s],torque [N.m]", *rows])


REFUSED: dict[str, tuple[Make, str]] = {
    "a picture": (text("photo.csv", b"\x89PNG\r\n\x1a\n" + bytes(range(256))), r"it is a picture \(PNG\): export"),
    "a spreadsheet": (text("sheet.csv", b"PK\x03\x04" + bytes(60)), "a ZIP archive, as spreadsheets are: export"),
    "an empty file": (text("nothing.csv", ""), "nothing.csv: is empty"),
    "a header only": (text("head.csv", "speed [rad/s],torque [N.m]\n"), "has a header but no rows"),
    "three rows": (text("few.csv", "time [s],input_angle [rad],current [A]\n0,0,0\n1,1,1\n2,2,2\n"), "has 3 samples; at least"),
    "a wrong delimiter": (text("bars.csv", "speed|torque\n1|0.05\n2|0.06\n"), r"separated by .\|.: separate them by commas"),
    "no file": (lambda folder: folder / "none.csv", "cannot be read: No such file"),
    "an empty folder": (folder_of(empty=True), r"contains no file that may be a measurement, as \*\.csv"),
    "texts among numbers": (text("texts.csv", with_texts()), r"not used, as they contain texts: speed \[rad/s\]"),
    "torque alone": (text("torque.csv", "time [s],torque [N.m]\n" + "0,1\n1,2\n2,1\n" * 20), "--constant speed="),
    "a constant current": (log(current=np.full(len(CURRENT), 1.0)), "current never changes: a set value, a limit"),
    "a shaft that stands": (log(input_angle=np.full(len(ANGLE), 1.0)), "the angle never changes"),
    "degrees called radians": (log(input_angle=np.degrees(ANGLE)), "whether (columns, )?units"),
    "swapped columns of a log": (log(input_angle=CURRENT, current=ANGLE), "log.csv.*(both ways|units|unknowns)"),
    "swapped columns of a table": (friction(TORQUE, SPEED), "that of the start set.*see whether units"),
    "a table of mN.m called N.m": (friction(SPEED, 1e3 * TORQUE), "perhaps the torque is in mN.m, not in N.m"),
    "a table of 1/min called rad/s": (friction(30.0 / np.pi * SPEED, TORQUE), "speeds may be in 1/min"),
    "a reversed torque of a table": (friction(SPEED, -TORQUE), "the torque drives the motion.*give it the sign of the speed"),
    "rest in a table": (friction([*SPEED, 0.0], [*TORQUE, 0.0]), "sample 12 has speed 0.*leave it out"),
    "two speeds only": (friction([10.0, 100.0] * 3, [0.053, 0.08] * 3), "one number shows no scatter"),
    "a loop in degrees": (twisted(twist_factor=180.0 / np.pi), "perhaps the angle is in deg, not in rad"),
    "a loop reversed": (twisted(torque_factor=-1.0), "reverse the sign of one of the two columns"),
    "a clipped loop": (twisted(limit=15.0), "torque stays at 15 N.m for .* samples while twist goes on"),
}  # fmt: skip


@pytest.mark.slow("identification")
@pytest.mark.parametrize("name", REFUSED)
def test_what_cannot_be_used_is_refused_with_reason_and_remedy(tmp_path: Path, name: str) -> None:
    make, reason = REFUSED[name]
    try:
        found = identify(START, [make(tmp_path)])
    except QuestionError as question:
        said = str(question)
    except ValueError as error:
        said = str(error)
        assert said.startswith("no file can be used: ")
    else:
        said = "; ".join(f"{check.source}: {check.message}: {check.remedy}" for check in found.failed)
        assert said, "neither refused nor failed"
    assert re.search(f"(?s){reason}", said), said


def outlying() -> np.ndarray:
    random, values = np.random.default_rng(1), CURRENT.copy()
    hit = random.choice(len(values), len(values) // 50, replace=False)
    values[hit] += 20.0 * random.standard_normal(len(hit))
    return values


LIMIT = 0.6 * float(np.abs(CURRENT).max())
SAID: dict[str, tuple[Make, str]] = {
    "a reversed current": (
        log(current=-CURRENT),
        "current is counted in the sense of the output, which turns against the input",
    ),
    "outliers": (log(current=outlying()), r"clipped samples of current are left out: \d+, [\d.]+ % of all"),
    "a clipped current": (log(current=np.clip(CURRENT, -LIMIT, LIMIT)), "outliers or clipped samples of current are left out"),
}


@pytest.mark.slow("identification")
@pytest.mark.parametrize("name", SAID)
def test_a_spoilt_log_is_used_and_what_was_done_is_said(tmp_path: Path, name: str) -> None:
    make, told = SAID[name]
    found = identify(START, [make(tmp_path)])
    assert any(re.search(told, remark) for remark in found.files[0].remarks)
    number = next(each.estimate for each in found.parameters if each.estimate.path == "load.inertia")
    assert number.value == pytest.approx(TRUTH["inertia"], abs=max(4.0 * number.sigma, 0.02 * TRUTH["inertia"]))
    opposite = "in log.csv current is counted in the sense of the output, which turns against the input"
    of_motor = found.gear_set.sources["motor.torque_constant"].source
    assert (opposite in of_motor) == (name == "a reversed current")
    assert (opposite in "\n".join(found.gear_set.origins)) == (name == "a reversed current")
    assert of_motor.endswith("current of the log = -current of the model") == (name == "a reversed current")


@pytest.mark.slow("identification")
def test_milliamperes_called_amperes_fail_a_check(tmp_path: Path) -> None:
    found = identify(START, [log(current=1e3 * CURRENT)(tmp_path)])
    (check,) = found.failed
    assert "a factor of 1000 lies between mA and A" in check.remedy


@pytest.mark.parametrize(
    ("make", "told"),
    [
        (friction(SPEED[:6], TORQUE[:6]), "it has one direction only: a zero error of the torque"),
    ],
)
def test_what_a_table_cannot_tell_is_said(tmp_path: Path, make: Make, told: str) -> None:
    assert any(told in remark for remark in identify(START, [make(tmp_path)]).files[0].remarks)


def test_torques_of_one_size_are_no_measurement(tmp_path: Path) -> None:
    found = identify(START, [friction(SPEED, np.full(len(SPEED), 0.05))(tmp_path)])
    assert [check.name for check in found.failed] == ["torques of one size"]
    assert "100 % of its torques have the size 0.05 N·m" in found.failed[0].message


@pytest.mark.parametrize(("kind", "angle", "torque"), [("torsion", "twist", "torque"), ("presliding", "angle", "torque")])
def test_a_torque_that_never_changes_is_refused_with_its_causes(kind: str, angle: str, torque: str) -> None:
    time = np.linspace(0.0, 4.0, 401)
    columns = {"time": time, angle: 2e-3 * np.sin(2.0 * np.pi * time), torque: np.full(401, 0.02)}
    with pytest.raises(ValueError, match="torque never changes: a set value, a limit, or a channel that was not recorded"):
        identify(START, {kind: sw.Recording(columns, {"time": "s", angle: "rad", torque: "N.m"})})


@pytest.mark.parametrize(
    ("columns", "told"),
    [
        ({"speed": np.full(300, 0.5), "torque": np.full(300, 1e147)}, 'column "torque" goes up to 1e'),
        ({"speed": SPEED, "torque": TORQUE, "load_torque": 1e147 * np.abs(SPEED)}, '_torque" goes up to'),
        ({"speed": SPEED, "torque": TORQUE, "output_torque": 1e147 * SPEED}, '_torque" goes up to'),
    ],
)
def test_sizes_that_no_instrument_reads_are_refused(columns: dict[str, np.ndarray], told: str) -> None:
    units = UNITS | dict.fromkeys(("load_torque", "output_torque"), "N.m")
    kind = "effort" if len(columns["speed"]) > 100 else "friction"
    with pytest.raises(ValueError, match=re.escape(told)):
        identify(START, {kind: sw.Recording(columns, {name: units[name] for name in columns})})


def test_a_long_table_without_a_stretch_at_one_speed_is_refused_in_words() -> None:
    speed, torque = np.where(np.arange(2000) == 1000, 1e-3, 0.0), np.linspace(0.0, 1.0, 2000)
    with pytest.raises(ValueError, match="none of its 2000 rows belongs to a stretch at one speed"):
        identify(START, {"friction": sw.Recording({"speed": speed, "torque": torque}, UNITS)})


def test_a_torque_that_drives_a_constant_speed_is_no_friction() -> None:
    """-0.2 N.m at 0.5 rad/s were once written as a friction of 0.2 N.m."""
    torque = -0.2 + 0.01 * np.random.default_rng(0).standard_normal(300)
    columns = {"time": 0.01 * np.arange(300), "output_speed": np.full(300, 0.5), "joint_torque": torque}
    found = identify(START, {"log": sw.Recording(columns, {"time": "s", "output_speed": "rad/s", "joint_torque": "N.m"})})
    (check,) = found.failed
    assert check.name == "friction against the motion"
    assert "would be -0.2" in check.message


def test_gaps_are_named_where_they_leave_no_motion() -> None:
    kept = np.arange(len(LOG)) % 400 < 25
    names = LOG.names
    gappy = sw.Recording({name: LOG[name][kept] for name in names}, {name: LOG.unit(name) for name in names})
    with pytest.raises(ValueError, match=r"gaps fill .* s of its .* s, and what lies between them is too short"):
        identify(START, {"log": gappy})


def test_a_joint_at_rest_is_refused_in_words_of_its_file() -> None:
    random, time = np.random.default_rng(0), 0.01 * np.arange(1000)
    columns = {"time": time, "input_angle": 1e-6 * random.standard_normal(1000), "current": random.standard_normal(1000)}
    with pytest.raises(ValueError, match="the shaft does not move beyond the noise of its angle"):
        identify(START, {"log": sw.Recording(columns, {"time": "s", "input_angle": "rad", "current": "A"})})


def both(folder: Path) -> Identified:
    (folder / "again").mkdir()
    files = [table(folder / "one.csv"), table(folder / "again" / "one.csv")]
    return identify(START, files)


@pytest.mark.slow("identification")
def test_a_file_given_twice_counts_once(tmp_path: Path) -> None:
    found = both(tmp_path)
    assert found.files[1].same_as == found.files[0].name
    number = next(each for each in found.parameters if each.estimate.path.endswith("coulomb"))
    assert number.mean_of == (number.source,)


def test_a_run_that_rests_most_of_the_time_is_no_copy_of_another(tmp_path: Path) -> None:
    time = np.arange(0.0, 10.0, 0.01)
    for name, begin in (("one.csv", 2.0), ("other.csv", 6.0), ("again.csv", 2.0)):
        angle = np.clip(time - begin, 0.0, 1.5)
        torque = np.sign(angle) + 0.1 * angle
        write(tmp_path / name, {"time": time, "q": angle, "tau": torque}, {"time": "s", "q": "rad", "tau": "N.m"})
    read = [recognise(tmp_path / name) for name in ("one.csv", "other.csv", "again.csv")]
    with np.errstate(all="raise"):
        assert same_as(read) == {str(tmp_path / "again.csv"): str(tmp_path / "one.csv")}


def test_of_files_of_one_run_the_one_with_most_channels_counts(tmp_path: Path) -> None:
    time = np.arange(0.0, 10.0, 0.01)
    angle, units = np.sin(1.3 * time), {"time": "s", "q": "rad", "tau": "N.m", "motor_angle": "rad"}
    columns = {"time": time, "q": angle, "tau": np.sign(np.cos(1.3 * time)) + 0.1 * angle}
    for name, more in (("poor.csv", {}), ("rich.csv", {"motor_angle": -100.0 * angle}), ("again.csv", {})):
        write(tmp_path / name, columns | more, {each: units[each] for each in columns | more})
    read = [recognise(tmp_path / name) for name in ("poor.csv", "rich.csv", "again.csv")]
    assert same_as(read) == {str(tmp_path / name): str(tmp_path / "rich.csv") for name in ("poor.csv", "again.csv")}


def test_a_table_with_a_failed_check_is_used_if_it_is_accepted(tmp_path: Path) -> None:
    path = friction(SPEED, 1e3 * TORQUE)(tmp_path)
    found, refused = identify(START, [path], accept=True), identify(START, [path])
    assert [check.name for check in found.failed] == ["friction of the start set"]
    assert "867 times" in found.failed[0].message
    assert found.gear_set.gear.friction_input.coulomb == pytest.approx(50.0)
    assert "867 times" in found.accepted.note
    assert refused.gear_set.gear == START.gear
    state = next(each for each in refused.states if each.path == "gear.friction_input.coulomb")
    assert (state.state, state.why.partition(";")[0]) == ("kept", "a check of table.csv failed")
    assert next(each.estimate.value for each in found.parameters if "coulomb" in each.estimate.path) == pytest.approx(50.0)
    said = identify(START, [path], mapping=lambda _: FileMapping(side="input"))
    assert not said.failed


def test_a_folder_stands_for_the_measurements_in_it(tmp_path: Path) -> None:
    found = identify(START, [folder_of(empty=False)(tmp_path)])
    assert [each.name for each in found.files] == ["table.csv"]


@pytest.mark.slow("identification")
def test_one_bad_file_does_not_stop_the_command_and_only_bad_files_do(tmp_path: Path) -> None:
    good, bad = table(tmp_path / "good.csv"), text("photo.csv", b"\x89PNG\r\n\x1a\n")(tmp_path)
    done = strainwave("identify", "hfuc-20-80", good, bad, "--out", "out", folder=tmp_path)
    assert done.returncode == 0
    assert "NOT USED: its suffix is .csv, but it is a picture (PNG)" in done.stdout
    assert "\n\nNOT USED, 1 of 2 files, for the reasons above: photo.csv\n" in done.stdout
    done = strainwave("identify", "hfuc-20-80", bad, "--out", "out2", folder=tmp_path)
    assert done.returncode == 2
    assert "Traceback" not in done.stdout + done.stderr
    assert not (tmp_path / "out2").exists()


@pytest.mark.slow("identification")
def test_names_with_control_characters_are_escaped_on_the_terminal_and_in_the_report(tmp_path: Path) -> None:
    path = tmp_path / "a\x1b[31mb.csv"
    rows = np.column_stack([LOG.time, ANGLE, CURRENT])
    np.savetxt(path, rows, delimiter=",", header="time,q_motor\x1b[31m\u202e,current\x1b[0m", comments="", encoding="utf-8")
    found = identify(START, [path], mapping=FileMapping(side="input"))
    assert not found.files[0].refused
    shown = [*identify_summary(found), *identify_files(found).values()]
    assert not re.search("[\x1b\u202e]", "".join(shown))
    assert any("q_motor\\x1b[31m\\u202e in rad" in line for line in shown)
