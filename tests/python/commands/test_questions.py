"""Every command that a question prints works on that file: it gives a result, or asks one more and different question."""

from __future__ import annotations

import re
import shlex
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from strainwave.commands import cli
from strainwave.questions import Answer, QuestionError

from tests.python.command import Result, strainwave
from tests.support.answers import commands_in, outcomes, with_number

TIME = np.arange(0.0, 8.0, 0.005)
ANGLE = 0.8 * np.sin(2.0 * TIME) + 0.2 * np.sin(5.3 * TIME)
SPEED = 1.6 * np.cos(2.0 * TIME) + 1.06 * np.cos(5.3 * TIME)
ACCELERATION = -3.2 * np.sin(2.0 * TIME) - 5.618 * np.sin(5.3 * TIME)
RATIO = 100.0
NOISE = np.random.default_rng(5).standard_normal((4, len(TIME)))
TORQUE = 1.5 * ACCELERATION + 20.0 * np.sin(ANGLE) + 6.0 * np.sign(SPEED) + 4.0 * SPEED + 0.05 * NOISE[0]  # at the joint
OTHER_ANGLE, OTHER_SPEED = np.cos(1.7 * TIME), -1.7 * np.sin(1.7 * TIME)
OTHER_TORQUE = 15.0 * np.sin(OTHER_ANGLE) + 5.0 * np.sign(OTHER_SPEED) - 2.0 * OTHER_ANGLE + 0.05 * NOISE[1]
RPM = np.array([2.0, 5.0, 10.0, 20.0, 50.0, 100.0, 200.0])
FRICTION = np.array([50.6, 51.5, 53.1, 55.9, 65.2, 80.1, 109.7])
SWEEP = np.concatenate([np.linspace(0, 1, 60), np.linspace(1, -1, 120), np.linspace(-1, 0, 60)])


def written(path: Path, header: str, *columns: np.ndarray) -> str:
    np.savetxt(path, np.column_stack(columns), "%.9g", ",", header=header, comments="")
    return path.name


def loop(folder: Path, header: str = "angle [deg],torque [N.m]") -> str:
    angle = np.degrees(0.1 * SWEEP)
    return written(folder / "a.csv", header, angle, SWEEP + 0.2 * np.sign(np.gradient(SWEEP)))


def two_joints(folder: Path) -> str:
    header = "t [s],q1 [rad],q2 [rad],dq1 [rad/s],dq2 [rad/s],tau1 [Nm],tau2 [Nm]"
    return written(folder / "a.csv", header, TIME, ANGLE, OTHER_ANGLE, SPEED, OTHER_SPEED, TORQUE, OTHER_TORQUE)


def one_quantity(folder: Path) -> str:
    header, efforts = "t [s],arm_1_joint,arm_2_joint", "t [s],arm_1_joint_effort [Nm],arm_2_joint_effort [Nm]"
    written(folder / "run_velocity.csv", header, TIME, SPEED, OTHER_SPEED)
    written(folder / "run_effort.csv", efforts, TIME, TORQUE, OTHER_TORQUE)
    return written(folder / "run_position.csv", header, TIME, ANGLE, OTHER_ANGLE)


def of_two_joints(folder: Path) -> str:
    written(folder / "q7_run.csv", "t [s],position [rad],effort [Nm]", TIME, OTHER_ANGLE, OTHER_TORQUE)
    return f"{written(folder / 'q2_run.csv', 't [s],position [rad],effort [Nm]', TIME, ANGLE, TORQUE)} q7_run.csv"


def with_counters(folder: Path) -> str:
    rows = np.arange(len(TIME), dtype=float)
    header = "t [s],q [rad],seq,stamp,x1"
    return written(folder / "a.csv", header, TIME, ANGLE, rows, 1.7e9 + np.floor(TIME), TORQUE / 9.85)


def torque_and_numbers(folder: Path) -> str:
    return written(folder / "a.csv", "t [s],seq,x1,tau [Nm]", TIME, np.arange(len(TIME), dtype=float), ANGLE, TORQUE)


FILES: dict[str, Callable[[Path], str]] = {
    "joints": two_joints,
    "files of two joints": of_two_joints,
    "one quantity": one_quantity,
    "counters": with_counters,
    "torque and a column without a meaning": torque_and_numbers,
    "matrix": lambda folder: written(
        folder / "a.csv", "c1,c2,c3,c4,c5,c6,c7", TIME, ANGLE, OTHER_ANGLE, SPEED, OTHER_SPEED, TORQUE, OTHER_TORQUE
    ),
    "matrix without time": lambda folder: written(folder / "a.csv", "c1,c2,c3", ANGLE, SPEED, TORQUE),
    "permille": lambda folder: written(
        folder / "a.csv", "t [s],Position actual value [rad],Torque actual value", TIME, RATIO * ANGLE, np.round(TORQUE / 0.04)
    ),
    "counts": lambda folder: written(
        folder / "a.csv", "t [s],theta_m,i [A]", TIME, np.round(RATIO * ANGLE * 3e4) * 3.0 + 7.0, TORQUE / 10.0
    ),
    "speeds without unit": lambda folder: written(folder / "a.csv", "speed,torque [mN.m]", RPM, FRICTION),
    "loop without side": loop,
    "loop that is too wide": lambda folder: written(folder / "a.csv", "joint_angle_deg,torque", np.degrees(ANGLE), TORQUE),
    "to and fro without time": lambda folder: written(
        folder / "a.csv", "motor_angle_deg,motor_current", 90.0 * SWEEP, np.sign(np.gradient(SWEEP)) + 0.01 * SWEEP
    ),
    "speed and torque without time": lambda folder: written(
        folder / "a.csv", "q [rad],dq [rad/s],tau [Nm]", ANGLE, SPEED, TORQUE
    ),
    "rows as time": lambda folder: written(folder / "a.csv", "t,q [rad],tau [Nm]", np.arange(len(TIME)), ANGLE, TORQUE),
    "time that stands": lambda folder: written(folder / "a.csv", "t [s],q [rad],tau [Nm]", 0.0 * TIME, ANGLE, TORQUE),
    "effort without unit": lambda folder: written(
        folder / "a.csv", "time,joint_position,joint_velocity,joint_effort", TIME, ANGLE, SPEED, TORQUE / 9.85
    ),
    "sides": lambda folder: written(
        folder / "a.csv", "t [s],position [rad],current [A]", TIME, ANGLE, (TORQUE - 20.0 * np.sin(ANGLE)) / 10.0
    ),
    "side of a torque": lambda folder: written(
        folder / "a.csv", "t [s],motor_angle [rad],joint_angle [rad],moment [Nm]", TIME, RATIO * ANGLE, ANGLE, TORQUE / 10.0
    ),
    "side of a table": lambda folder: written(folder / "a.csv", "speed [rpm],torque [N.m]", 0.2 * RPM, FRICTION / 100.0),
    "side of a torque by its size": lambda folder: written(
        folder / "a.csv", "t [s],motor_angle,tau [Nm]", TIME, 30.0 * ANGLE, TORQUE / RATIO - 0.2 * np.sin(ANGLE)
    ),
    "unit and side of an angle": lambda folder: written(
        folder / "a.csv", "t [s],position,torque", TIME, 57.0 * ANGLE, TORQUE - 20.0 * np.sin(ANGLE)
    ),
    "torques": lambda folder: written(
        folder / "a.csv", "t [s],q [rad],tau_left [Nm],tau_right [Nm]", TIME, ANGLE, TORQUE, 0.9 * TORQUE
    ),
    "any input of a robot": lambda folder: written(folder / "a.csv", "t [s],q [rad],dq [rad/s],u", TIME, ANGLE, SPEED, TORQUE),
    "names without a meaning": lambda folder: written(folder / "a.csv", "foo,bar", RPM, FRICTION),
    "one series": lambda folder: written(folder / "a.csv", "foo", 1.0 + 0.1 * NOISE[0][:200]),
    "voltage": lambda folder: written(
        folder / "a.csv", "t [s],motor_angle [rad],voltage [V]", TIME, RATIO * ANGLE, TORQUE / 9.0
    ),
}  # fmt: skip


def first_command(name: str, folder: Path) -> list[str]:
    return ["identify", "csg-20-100", *FILES[name](folder).split()]


def led(command: list[str], folder: Path) -> None:
    """Every command that a command's question prints, and those of the next question, has a result."""
    found = outcomes(command, folder)
    assert found[0][0] != shlex.join(command), f"no question: {found}"
    for words, result in found:
        assert result.returncode in (0, 3) or "record" in result.stderr, f"{words}: {result.stderr}"
    assert any(result.returncode in (0, 3) for _, result in found)


@pytest.mark.slow("commands")
@pytest.mark.parametrize("name", FILES)
def test_every_command_of_a_question_works_on_that_file(tmp_path: Path, name: str) -> None:
    led(first_command(name, tmp_path), tmp_path)


IN_CURRENT = "t [s],q [rad],current [A]"


def predicted(folder: Path, header: str, *columns: np.ndarray) -> list[str]:
    """Predict a file by a gear of which the torque at the joint was recorded, so that no torque constant is known."""
    log = written(folder / "log.csv", "t [s],q [rad],joint_torque [Nm]", TIME, ANGLE, TORQUE)
    assert strainwave("identify", "csg-20-100", log, "--out", "saved", folder=folder).returncode == 0
    return ["predict", "saved/gear.toml", written(folder / "later.csv", header, *columns)]


OTHER_VERBS: dict[str, Callable[[Path], list[str]]] = {
    "predict a log in A": lambda folder: predicted(folder, IN_CURRENT, TIME, ANGLE, TORQUE / 9.85),
    "predict a table in A": lambda folder: predicted(folder, "speed [rpm],current [A]", RPM, FRICTION / 100.0),
    "rank a table in A": lambda folder: [
        "identify", "csg-20-100", written(folder / "a.csv", "speed [rpm],current [A]", RPM, FRICTION / 100.0), "--rank"
    ],
    "orders of a matrix": lambda folder: [
        "orders", written(folder / "a.csv", "c1,c2,c3", ANGLE, SPEED, TORQUE)
    ],
    "diagnose a matrix": lambda folder: [
        "diagnose", "joint", written(folder / "a.csv", "c1,c2,c3", ANGLE, SPEED, TORQUE)
    ],
    "orders of two joints": lambda folder: ["orders", two_joints(folder)],
    "diagnose two joints": lambda folder: ["diagnose", "joint", two_joints(folder)],
}  # fmt: skip


@pytest.mark.slow("commands")
@pytest.mark.parametrize("name", OTHER_VERBS)
def test_every_command_of_a_question_of_another_verb_works_on_that_file(tmp_path: Path, name: str) -> None:
    led(OTHER_VERBS[name](tmp_path), tmp_path)


def asked(name: str, folder: Path) -> Result:
    return strainwave(*first_command(name, folder), folder=folder)


def test_counters_and_stamps_are_no_columns_to_choose(tmp_path: Path) -> None:
    options = [word for command in commands_in(asked("counters", tmp_path)) for word in command]
    assert any("=x1" in word for word in options)
    assert not any("seq" in word or "stamp" in word for word in options)


def test_numbers_are_not_called_texts(tmp_path: Path) -> None:
    result = asked("torque and a column without a meaning", tmp_path)
    assert "text" not in result.stderr
    assert any("output_angle=x1" in command for command in commands_in(result))


def test_a_number_that_only_a_person_knows_is_no_example(tmp_path: Path) -> None:
    result = asked("permille", tmp_path)
    assert "'Torque actual value=permille of NUMBER N.m'" in result.stderr
    pasted = strainwave(*first_command("permille", tmp_path), "--unit", "torque=permille of NUMBER N.m", folder=tmp_path)
    assert pasted.returncode == 2
    assert "write the number in place of NUMBER" in pasted.stderr


def typing(monkeypatch: pytest.MonkeyPatch, *lines: str) -> None:
    """Let a person at a terminal type these lines."""
    rest = list(lines)
    monkeypatch.setattr(cli, "_is_terminal", lambda: True)
    monkeypatch.setattr(cli, "input", lambda prompt: rest.pop(0), raising=False)


def in_terminal(monkeypatch: pytest.MonkeyPatch, folder: Path, words: list[str]) -> int:
    monkeypatch.chdir(folder)
    monkeypatch.setattr(sys, "argv", ["strainwave", *words])
    with pytest.raises(SystemExit) as end:
        cli.main()
    return int(end.value.code or 0)


def test_a_terminal_asks_at_once(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    command = first_command("speeds without unit", tmp_path)
    second = commands_in(asked("speeds without unit", tmp_path))[1]
    typing(monkeypatch, "2")
    assert in_terminal(monkeypatch, tmp_path, command) == 0
    assert sys.argv[1:] == second
    assert (tmp_path / "out" / "identify" / "gear.toml").is_file()


@pytest.mark.parametrize("typed", ["", "9", "no"])
def test_a_terminal_without_an_answer_ends(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, typed: str) -> None:
    typing(monkeypatch, typed)
    assert in_terminal(monkeypatch, tmp_path, first_command("speeds without unit", tmp_path)) == 2


def test_a_question_that_an_answer_does_not_settle_ends_the_command(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def asks(*_: object, **__: object) -> None:
        raise QuestionError("which side?", [Answer("the motor", {"side": "input"})])

    monkeypatch.setattr(cli, "app", asks)
    typing(monkeypatch, "1", "1")
    monkeypatch.setattr(sys, "argv", ["strainwave", "identify"])
    with pytest.raises(SystemExit) as ended:
        cli.main()
    assert ended.value.code == 2
    assert capsys.readouterr().err.rstrip().endswith('FileMapping(side="input"))')


@pytest.mark.slow("commands")
def test_numbers_of_joints_in_one_column_are_converted_by_the_printed_command(tmp_path: Path) -> None:
    channels = {"q": (ANGLE, OTHER_ANGLE), "dq": (SPEED, OTHER_SPEED), "tau": (TORQUE, OTHER_TORQUE)}
    names = [f"{name}_run.txt" for name in channels]
    for name, columns in zip(names, channels.values(), strict=True):
        np.savetxt(tmp_path / name, np.stack(columns, axis=1).ravel(), fmt="%.7g")
    result = strainwave("identify", "csg-20-100", *names, folder=tmp_path)
    (code,) = re.findall(r'python -c "(.*)"', result.stderr)
    subprocess.run([sys.executable, "-c", code], cwd=tmp_path, check=True)
    command = ["identify", "csg-20-100", *(f"rows-{name}" for name in names), "--constant", "rate=200"]
    assert all(result.returncode in (0, 3) for _, result in outcomes(command, tmp_path))


REMARKS: dict[str, Callable[[Path], str]] = {
    "side": lambda folder: written(folder / "a.csv", "speed [rpm],torque [mN.m]", RPM / 2.0, FRICTION),
    "unit": lambda folder: written(
        folder / "a.csv", "t,motor_angle [rad],motor_torque [Nm]", TIME, RATIO * ANGLE, TORQUE / RATIO
    ),
    "motor": lambda folder: written(
        folder / "a.csv", "t [s],motor_angle [rad],current [A]", TIME, RATIO * ANGLE, TORQUE / RATIO
    ),
}  # fmt: skip


@pytest.mark.slow("commands")
@pytest.mark.parametrize("name", REMARKS)
def test_what_a_remark_adds_is_accepted(tmp_path: Path, name: str) -> None:
    command = ["identify", "csg-20-100", REMARKS[name](tmp_path)]
    result = strainwave(*command, folder=tmp_path)
    assert result.returncode in (0, 3), result.stderr
    added = re.findall(r"--(?:side|unit|constant) (?:'[^']*'|[^\s;,)]+)", result.stdout)
    assert added, result.stdout
    for options in dict.fromkeys(added):
        again = strainwave(*command, *map(with_number, shlex.split(options)), folder=tmp_path)
        assert again.returncode in (0, 3), f"{options}: {again.stderr}"


def test_a_question_counts_in_the_unit_of_each_answer(tmp_path: Path) -> None:
    written(tmp_path / "a.csv", "spd,i_avr", RPM, 3.0 * FRICTION)
    asked = strainwave("identify", "hfuc-25-100", "a.csv", folder=tmp_path).stderr
    in_milliamperes = [line for line in asked.splitlines() if "current of the motor in mA" in line]
    assert in_milliamperes
    assert all("current to 0.329 A" in line for line in in_milliamperes), asked


def test_a_misspelt_unit_is_answered_with_the_one_that_is_meant(tmp_path: Path) -> None:
    written(tmp_path / "a.csv", "speed [rmp],torque [mNm]", 10.0 * RPM, FRICTION)
    asked = strainwave("identify", "hfuc-25-100", "a.csv", folder=tmp_path)
    assert 'unit "rmp" of speed is not known; did you mean rpm?' in asked.stderr
    assert commands_in(asked) == [["identify", "hfuc-25-100", "a.csv", "--unit", "speed=rpm"]]
    assert strainwave(*commands_in(asked)[0], folder=tmp_path).returncode == 0


@pytest.mark.slow("commands")
def test_the_next_command_has_all_files_of_a_recording(tmp_path: Path) -> None:
    one_quantity(tmp_path)
    names = [f"run_{name}.csv" for name in ("position", "velocity", "effort")]
    done = strainwave("identify", "csg-20-100", *names, "--joint", 1, folder=tmp_path)
    assert done.returncode == 0, done.stderr
    (line,) = [line for line in done.stdout.splitlines() if line.startswith("  strainwave predict")]
    assert all(name in line for name in names)
    assert strainwave(*shlex.split(line)[1:], folder=tmp_path).returncode == 0


TABLE = "speed [rad/s],torque [N.m]\n" + "".join(f"{speed},{0.05 + 3e-4 * speed}\n" for speed in (5, 20, 80, 200))


@pytest.mark.slow("commands")
def test_a_folder_of_results_is_its_gear_and_other_files_of_it_name_that(tmp_path: Path) -> None:
    (tmp_path / "a.csv").write_text(TABLE)
    assert strainwave("identify", "hfuc-20-80", "a.csv", "--out", "saved", folder=tmp_path).returncode == 0
    assert strainwave("predict", "saved", "a.csv", folder=tmp_path).returncode == 0
    assert strainwave("predict", "./saved", "a.csv", folder=tmp_path).returncode == 0
    refused = strainwave("export", "joint", "saved/results.json", folder=tmp_path).stderr
    assert "its gear is saved/gear.toml beside it" in refused


def test_what_is_not_predicted_names_the_command_that_compares_it(tmp_path: Path) -> None:
    loop(tmp_path)
    refused = strainwave("predict", "hfuc-20-80", "a.csv", "--side", "output", folder=tmp_path).stderr
    assert refused.rstrip().endswith("strainwave identify hfuc-20-80 a.csv --side output"), refused
