"""A gear by the command, and the command itself: results where asked for; bad input in one line, and nothing written."""

from __future__ import annotations

import errno
import json
import os
import signal
import subprocess
import sys
import tomllib
from contextlib import redirect_stdout, suppress
from io import BytesIO, TextIOWrapper
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import strainwave as sw
from strainwave import _core
from strainwave.commands.cli import main
from strainwave.files import gear_set
from strainwave.files.writing import write_folder
from strainwave.identification.kinds import KINDS

from tests.python.command import GOOD_GEAR, interrupted, refused, start, strainwave

GOOD_TABLE = "speed [rad/s],torque [N.m]\n1,0.021\n5,0.024\n10,0.026\n20,0.031\n50,0.046\n100,0.07\n"
GOOD_LOOP = "twist [mrad],torque [N.m]\n" + "".join(
    f"{np.cos(a):.6f},{35 * np.cos(a) - 2 * np.sin(a):.6f}\n" for a in np.linspace(0.0, 2.0 * np.pi, 80)
)


@pytest.mark.whole_path("commands")
def test_a_table_and_a_loop_become_a_gear_file_and_a_report(tmp_path: Path) -> None:
    (tmp_path / "table.csv").write_text(GOOD_TABLE)
    (tmp_path / "loop.csv").write_text(GOOD_LOOP)
    result = strainwave(
        "identify", "hfuc-25-100", "table.csv", "loop.csv", "--out", "mine", folder=tmp_path
    )  # fmt: skip
    assert result.returncode == 0, result.stdout + result.stderr
    written = {path.name for path in (tmp_path / "mine").iterdir()} - {"workbench.html"}  # only if it was built
    assert written == {"gear.toml", "numbers.csv", "report.html", "results.json"}
    assert "error on held-out data" in result.stdout
    gear = sw.load(tmp_path / "mine" / "gear.toml")
    assert gear.friction_input.coulomb == pytest.approx(0.0208, abs=5e-4)
    assert gear.friction_input.viscous == pytest.approx(4.95e-4, rel=0.03)


def test_crooked_columns_are_named_on_the_command_line(tmp_path: Path) -> None:
    (tmp_path / "table.csv").write_text(
        "Operator;Drehzahl (rpm);Moment\n" + "".join(f"A;{10 * i};{4.0 + 0.01 * i}\n".replace(".", ",") for i in range(1, 9))
    )
    result = strainwave(
        "identify", "hfuc-25-100", "table.csv", "--out", "mine",
        "--column", "speed=Drehzahl", "--column", "torque=Moment", "--unit", "torque=N.cm", folder=tmp_path,
    )  # fmt: skip
    assert result.returncode == 0, result.stderr
    gear = sw.load(tmp_path / "mine" / "gear.toml")
    assert gear.friction_input.coulomb == pytest.approx(0.04, rel=1e-6)
    assert gear.friction_input.viscous == pytest.approx(1e-4 / (10.0 * 2.0 * np.pi / 60.0), rel=1e-6)


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("", ("table.csv", "empty")),
        ("speed [rad/s],torque [N.m]\n", ("table.csv",)),
        ("speed [rad/s],torque [rad]\n1,2\n2,3\n3,4\n", ("table.csv", "columns not used")),
        ("speed [rad/s],torque [furlong]\n1,2\n2,3\n3,4\n", ("table.csv", "furlong")),
    ],
)  # fmt: skip
def test_a_bad_friction_table_is_refused(tmp_path: Path, text: str, expected: tuple[str, ...]) -> None:
    (tmp_path / "table.csv").write_text(text)
    refused(tmp_path, ["identify", "hfuc-25-100", "table.csv"], *expected)


@pytest.mark.parametrize("hostile", ["\x1b[31mred", "\x9b31m", "\u202e", 10_000 * "x", "two\x0blines"])
def test_what_a_file_holds_reaches_no_terminal_as_it_is(tmp_path: Path, hostile: str) -> None:
    hostile_name = tmp_path / f"{hostile[:20]}.csv"
    for text in (
        f"{hostile},torque\n1,2\n",
        f"speed [{hostile}],torque [N.m]\n1,2\n",
        f"speed [rpm],torque [N.m]\n1,{hostile}\n",
    ):
        hostile_name.write_text(text)
        result = strainwave("identify", "hfuc-25-100", hostile_name.name, folder=tmp_path)
        assert result.returncode == 2
        assert all(line.isprintable() for line in result.stderr.splitlines())
        assert len(result.stderr) < 2000
    refused(tmp_path, ["list", "models", hostile], "none of the models")


def test_a_truncated_parquet_file_is_refused(tmp_path: Path) -> None:
    speed = np.arange(1.0, 50.0)
    whole = sw.Recording({"speed": speed, "torque": 0.1 * speed}, {"speed": "rad/s", "torque": "N.m"})
    whole.to_parquet(tmp_path / "whole.parquet")
    data = (tmp_path / "whole.parquet").read_bytes()
    (tmp_path / "cut.parquet").write_bytes(data[: len(data) // 2])
    refused(tmp_path, ["identify", "hfuc-25-100", "cut.parquet"], "cut.parquet")


@pytest.mark.parametrize(
    ("change", "expected"),
    [
        (("3e4", "-3e4"), ("mine.toml", "k", "-30000", "N.m/rad", "(0, inf)")),
        (("3e4", "nan"), ("mine.toml", "k", "nan")),
        (("3e4", '"stiff"'), ("mine.toml", "k", "stiff")),
        (("k =", "kk ="), ("mine.toml", "kk")),
        (("[stiffness]", "[stifness]"), ("mine.toml", "stifness")),
        (('"linear"', '"quadratic"'), ("mine.toml", "quadratic", '"linear" or "piecewise" or "three_segment" or "cubic"')),
        ((', unit = "N.m/rad"', ""), ("mine.toml", "k", "unit")),
        (('"N.m/rad"', '"N.m"'), ("mine.toml", "k", "N.m/rad")),
        (("[stiffness]", "[stiffness"), ("mine.toml", "line 5")),
        ((GOOD_GEAR, ""), ("mine.toml",)),
    ],
)
def test_a_bad_gear_file_is_refused(tmp_path: Path, change: tuple[str, str], expected: tuple[str, ...]) -> None:
    (tmp_path / "mine.toml").write_text(GOOD_GEAR.replace(*change))
    (tmp_path / "table.csv").write_text(GOOD_TABLE)
    refused(tmp_path, ["identify", "mine.toml", "table.csv"], *expected)


@pytest.mark.parametrize(
    ("arguments", "expected"),
    [
        (["identify", "hfuc-25-101", "table.csv"], ("hfuc-25-101", "no ratio of 101, but 30, 50, 80, 100")),
        (["identify", "nowhere.toml", "table.csv"], ("nowhere.toml",)),
        (["identify", "hfuc-25-100", "nowhere.csv"], ("nowhere.csv",)),
        (["identify", "hfuc-25-100"], ("FILE",)),
        (
            ["identify", "hfuc-25-100", "table.csv", "--unit", "spee=rpm"],
            ("spee", "no column of these measurements", "did you mean speed?"),
        ),
        (["identify", "hfuc-25-100", "table.csv", "--column", "curent=torque"], ("did you mean current?",)),
        (
            ["identify", "hfuc-25-100", "table.csv", "--constant", "torqueconstant=.1"],
            ("did you mean torque_constant?", "The constants are load_inertia"),
        ),
        (
            ["identify", "hfuc-25-100", "table.csv", "--column", "speed"],
            ("--column speed", "name=value"),
        ),
        (
            ["identify", "hfuc-25-100", "table.csv", "--column", "torque=tork"],
            ("--column torque=tork", 'no file has a column "tork"', "there are speed, torque"),
        ),
    ],
)
def test_a_bad_command_line_is_refused(tmp_path: Path, arguments: list[str], expected: tuple[str, ...]) -> None:
    (tmp_path / "table.csv").write_text(GOOD_TABLE)
    refused(tmp_path, arguments, *expected)


def test_an_unwritable_folder_is_refused(tmp_path: Path) -> None:
    (tmp_path / "table.csv").write_text(GOOD_TABLE)
    (tmp_path / "out").write_text("in the way")
    refused(tmp_path, ["identify", "hfuc-25-100", "table.csv", "--out", "out"], "out")


def test_gears_lists_the_catalogue(tmp_path: Path) -> None:
    result = strainwave("list", "gears", "HFUC_25", folder=tmp_path)
    assert result.returncode == 0
    assert "hfuc-25-100" in result.stdout.split()


def test_gears_that_the_catalogue_does_not_have_are_refused_with_those_near(tmp_path: Path) -> None:
    none = 'none of the gears that come with the package has "hfuc-25-101" in its name'
    refused(tmp_path, ["list", "gears", "hfuc-25-101"], none, "hfuc-25-100")
    refused(tmp_path, ["list", "gears", "nonsense"], '"nonsense"', "`strainwave list gears` lists all")


def test_the_version_is_that_of_the_package(tmp_path: Path) -> None:
    version = tomllib.loads((Path(__file__).parents[3] / "pyproject.toml").read_text())["project"]["version"]
    result = strainwave("--version", folder=tmp_path)
    assert (result.returncode, result.stdout, result.stderr) == (0, f"strainwave {version}\n", "")


def test_a_terminal_that_lacks_letters_is_no_failure(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(gear_set, "catalogue", lambda of: ("größe-100",))
    monkeypatch.setattr(sys, "argv", ["strainwave", "list", "gears"])
    terminal = TextIOWrapper(BytesIO(), encoding="ascii")
    with redirect_stdout(terminal), pytest.raises(SystemExit) as end:
        main()
    assert (end.value.code or 0, terminal.buffer.getvalue()) == (0, b"gr??e-100\n")  # type: ignore[attr-defined]


# As a process


@pytest.mark.slow("commands")
def test_the_command_is_installed_and_its_exit_code_reaches_the_shell(tmp_path: Path) -> None:
    command = Path(sys.executable).with_name("strainwave")
    arguments = [command, "identify", "nowhere.toml", "table.csv"]
    result = subprocess.run(arguments, cwd=tmp_path, capture_output=True, text=True, timeout=60, check=False)
    assert (result.returncode, result.stdout) == (2, "")
    assert "nowhere.toml" in result.stderr


@pytest.mark.slow("commands")
@pytest.mark.parametrize("verb", ["show", "identify"])
def test_lines_of_a_terminal_end_between_words_and_commands_stay_whole(verb: str, tmp_path: Path) -> None:
    pty = pytest.importorskip("pty")
    (tmp_path / "friction.csv").write_text(GOOD_TABLE)
    words = {"show": ["show", "robot-joint"], "identify": ["identify", "hfuc-25-100", "friction.csv", "--out", "a-long-folder"]}
    shown, terminal = pty.openpty()
    process = subprocess.Popen(
        [sys.executable, "-m", "strainwave", *words[verb]],
        cwd=tmp_path, stdout=terminal, stderr=subprocess.DEVNULL, env={**os.environ, "COLUMNS": "80"},
    )  # fmt: skip
    os.close(terminal)
    text = b""
    with suppress(OSError):  # the end of a terminal
        while part := os.read(shown, 65536):
            text += part
    os.close(shown)
    assert process.wait(60) == 0
    lines = text.decode().splitlines()
    commands = [line for line in lines if line.startswith("  strainwave ")]
    assert [line for line in lines if len(line) > 80 and line not in commands] == []
    assert max(map(len, lines)) > 70
    assert bool(commands) == (verb == "identify")


@pytest.mark.slow("commands")
@pytest.mark.parametrize("verb", [("list", "gears"), ("list", "models"), ("--help",)])
def test_a_reader_that_has_seen_enough_is_no_failure(verb: tuple[str, ...]) -> None:
    reader, writer = os.pipe()
    os.close(reader)
    with os.fdopen(writer, "wb") as pipe:
        process = start(*verb, stdout=pipe)
    _, wrong = process.communicate(timeout=60)
    assert (process.returncode, wrong) == (0, b"")


@pytest.mark.slow("commands")
def test_output_that_is_lost_is_told_and_does_not_turn_success_into_failure() -> None:
    if not Path("/dev/full").exists():
        pytest.skip("this system has no /dev/full")
    with open("/dev/full", "wb") as full:
        process = start("list", "gears", stdout=full)
    _, wrong = process.communicate(timeout=60)
    assert (process.returncode, wrong) == (0, b"strainwave: the output cannot be printed: No space left on device\n")


@pytest.mark.slow("commands")
@pytest.mark.parametrize("phase", ["typer", "pydantic", "pyarrow", "scipy", "jinja2"])
def test_an_interrupt_ends_in_one_line_with_nothing_written(phase: str, tmp_path: Path) -> None:
    """In each phase a package is imported: for the command itself, to read gear and table, to fit, to report."""
    (tmp_path / "table.csv").write_text(GOOD_TABLE)
    (tmp_path / f"{phase}.py").write_text("import os, time\nos.write(1, b'here\\n')\ntime.sleep(30.0)")
    arguments = ["identify", "hfuc-25-100", "table.csv", "--out", "mine"]
    interrupted(start(*arguments, cwd=tmp_path, stdout=subprocess.PIPE, env=os.environ | {"PYTHONPATH": str(tmp_path)}))
    assert not (tmp_path / "mine").exists()


WROTE = """
from pathlib import Path
from strainwave import __main__
from strainwave.commands import cli
from strainwave.files.writing import write_folder
import time
def run():
    write_folder(Path("first"), {"gear.toml": "gear", "report.html": "report"})
    print("here", flush=True)
    time.sleep(30.0)
cli.main = run
__main__.main()
"""


def test_an_interrupt_says_what_was_written_before(tmp_path: Path) -> None:
    process = subprocess.Popen([sys.executable, "-c", WROTE], cwd=tmp_path, stdout=subprocess.PIPE, stderr=subprocess.PIPE)
    interrupted(process, "first")
    assert sorted(path.name for path in (tmp_path / "first").iterdir()) == ["gear.toml", "report.html"]


RUNNING = """
from strainwave import __main__
from strainwave.commands import cli
import strainwave as sw
def many(members):
    inertia = {"load.inertia": [0.01] * members}
    sw.simulate_many(sw.Drive(), sw.scenario.constant(1.0, 10.0), inertia, record=["torque"], sample=10.0)
def run():
    many(1)  # Python loses an interrupt that comes in a clean-up of an import, so all imports are done before
    print("here", flush=True)
    many(100_000)
cli.main = run
__main__.main()
"""


@pytest.mark.slow("commands")
def test_an_interrupt_ends_what_runs_in_the_core_too() -> None:
    interrupted(subprocess.Popen([sys.executable, "-c", RUNNING], stdout=subprocess.PIPE, stderr=subprocess.PIPE))


# Writing

CONTENTS = {"gear.toml": "gear", "report.html": "report"}


def test_an_interrupt_that_comes_while_files_are_written_comes_too_late(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    replace = os.replace

    def press(*arguments: Any) -> None:
        replace(*arguments)
        signal.raise_signal(signal.SIGINT)

    monkeypatch.setattr(os, "replace", press)
    write_folder(tmp_path / "mine", CONTENTS)
    assert sorted(path.name for path in (tmp_path / "mine").iterdir()) == ["gear.toml", "report.html"]
    with pytest.raises(KeyboardInterrupt):
        signal.raise_signal(signal.SIGINT)  # it is heeded again


@pytest.mark.parametrize("name", ["gear.toml", "report.html"])
def test_neither_file_is_written_where_one_cannot_be(name: str, tmp_path: Path) -> None:
    (tmp_path / "mine" / name).mkdir(parents=True)
    with pytest.raises(IsADirectoryError, match=rf"/mine/{name} cannot be written: it is a folder$"):
        write_folder(tmp_path / "mine", CONTENTS)
    assert [path.name for path in (tmp_path / "mine").iterdir()] == [name]


def test_a_full_disk_leaves_neither_files_nor_folders(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def full(descriptor: int) -> None:
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    monkeypatch.setattr(os, "fsync", full)
    with pytest.raises(OSError, match=r"/mine/new/gear\.toml cannot be written: No space left on device$"):
        write_folder(tmp_path / "mine" / "new", CONTENTS)
    assert list(tmp_path.iterdir()) == []


# Models


def test_every_model_is_listed_with_its_family_and_what_it_is(tmp_path: Path) -> None:
    families = strainwave("list", "models", folder=tmp_path).stdout.split("\n")
    for family, members in _core.families.items():
        start = families.index(family) + 1
        listed = [line.split(maxsplit=1) for line in families[start : start + len(members)]]
        assert [name for name, _ in listed] == list(members)
        assert all(
            said == kind.__doc__.strip().splitlines()[0] for (_, said), kind in zip(listed, members.values(), strict=True)
        )


def test_a_model_is_described_in_full(tmp_path: Path) -> None:
    said = strainwave("show", "lugre", folder=tmp_path).stdout
    for field in sw.friction.LuGre.fields:
        assert f"{field['name']}: {field['doc']}" in said


def test_a_model_that_does_not_exist_is_refused_with_those_that_do(tmp_path: Path) -> None:
    refused(tmp_path, ["show", "lugree"], 'no set "lugree"', "models near it: lugre")


@pytest.mark.slow("commands")
def test_a_failed_check_is_printed_first_and_no_gear_is_written_until_it_is_accepted(tmp_path: Path) -> None:
    speeds = np.geomspace(1.0, 300.0, 12) / 80.0
    rows = "".join(f"{speed},{80.0 * 0.05 + 6400.0 * 3e-4 * speed}\n" for speed in speeds)
    (tmp_path / "joint.csv").write_text(f"Motor speed [rad/s],Motor torque [N.m]\n{rows}")
    words = ["identify", "hfuc-20-80", "joint.csv", "--out", "mine"]
    failed = strainwave(*words, folder=tmp_path)
    assert failed.returncode == 3
    assert failed.stdout.startswith("FAILED: joint.csv: ")
    assert "--side output" in failed.stdout
    assert sorted(path.name for path in (tmp_path / "mine").iterdir()) == ["numbers.csv", "report.html", "results.json"]
    assert "Failed checks" in (tmp_path / "mine" / "report.html").read_text()
    assert json.loads((tmp_path / "mine" / "results.json").read_text())["failed"] == ["friction of the start set"]
    accepted = strainwave(*words, "--accept", folder=tmp_path)
    assert accepted.returncode == 0
    assert sw.load(tmp_path / "mine" / "gear.toml").friction_input.coulomb == pytest.approx(4.0, rel=0.02)
    assert "Accepted in spite of failed checks: joint.csv: its friction is" in (tmp_path / "mine" / "gear.toml").read_text()
    told = strainwave(*words, "--side", "output", folder=tmp_path)
    assert (told.returncode, "FAILED" in told.stdout) == (0, False)
    assert "gear.friction_input.coulomb" in told.stdout, "what was fitted is printed"
    assert sw.load(tmp_path / "mine" / "gear.toml").friction_input.coulomb == pytest.approx(0.05, rel=0.02)


def test_rank_prints_failed_checks_first_and_ends_in_3_as_identify_does(tmp_path: Path) -> None:
    rows = "".join(f"{speed},{817.0 * (0.05 + 3e-4 * speed)}\n" for speed in np.geomspace(1.0, 300.0, 12))
    (tmp_path / "table.csv").write_text(f"Speed [rad/s],Torque [N.m]\n{rows}")
    failed = strainwave("identify", "--rank", "hfuc-20-80", "table.csv", folder=tmp_path)
    assert failed.returncode == 3
    assert failed.stdout.startswith("FAILED: table.csv: its friction is ")
    assert "Coulomb and viscous" in failed.stdout, "the models are printed all the same"


def test_a_single_branch_gives_the_spring(tmp_path: Path) -> None:
    twist = np.linspace(0.0, 1e-3, 50)
    (tmp_path / "branch.csv").write_text(
        "twist [rad],torque [N.m],supply [V]\n" + "".join(f"{t},{2e4 * t},22\n" for t in twist)
    )
    result = strainwave("identify", "hfuc-20-80", "branch.csv", folder=tmp_path)
    assert result.returncode == 0, result.stderr
    assert "columns not used: supply" in result.stdout


@pytest.mark.parametrize("verb", ["identify", "predict", "orders"])
def test_the_help_of_a_kind_names_every_kind(verb: str, tmp_path: Path) -> None:
    shown = " ".join(strainwave(verb, "--help", folder=tmp_path).stdout.split())
    assert f"Kind of files that may be of two kinds: {', '.join(KINDS)}." in shown


def test_without_a_verb_help_is_shown(tmp_path: Path) -> None:
    result = strainwave(folder=tmp_path)
    assert (result.returncode, result.stdout) == (0, strainwave("--help", folder=tmp_path).stdout)
    for verb in ("identify", "demo", "simulate", "compare", "show", "list"):
        assert f"\n  {verb} " in result.stdout


def test_a_file_in_the_place_of_the_gear_is_named(tmp_path: Path) -> None:
    (tmp_path / "friction.csv").write_text("speed [rad/s],torque [N.m]\n1,2\n")
    refused(tmp_path, ["identify", "friction.csv"], "friction.csv is a file, where the gear is asked for", "list gears")


def test_a_name_that_is_too_long_is_refused_with_a_remedy(tmp_path: Path) -> None:
    refused(
        tmp_path,
        ("identify", "csg-20-100", "x" * 300 + ".csv"),
        "file name too long; a file may have 255 bytes in its name, not 304",
    )
