"""Every example a reader can copy runs, and shows what the page says it shows."""

from __future__ import annotations

import doctest
import importlib
import os
import re
import shlex
import subprocess
import sys
from pathlib import Path
from types import ModuleType
from typing import NamedTuple

import drawn as pictures
import pytest
import strainwave as sw

from tests.python.command import strainwave

ROOT = Path(__file__).resolve().parents[2]
SOURCE = ROOT / "python"
MODULES = [path for path in sorted(SOURCE.rglob("*.py")) if ">>>" in path.read_text()]
SLOW_MODULES = {
    SOURCE / "strainwave" / name
    for name in (
        "tuning/compensate.py",
        "diagnose/inversion.py",
        "diagnose/misalignment_sweep.py",
        "diagnose/smallest_error.py",
        "orders/two_encoders.py",
    )
}  # their examples take 0.4 s and more, before a kernel of them is kept
FENCE = re.compile(r"^```(?:python\n|console\n(?=\$ (?:strainwave|python papers/)))(.*?)^```$", re.MULTILINE | re.DOTALL)
NAMED = re.compile(r"^```\w+\n(# (\S+\.\w+)\n.*?)^```$", re.MULTILINE | re.DOTALL)


class Example(NamedTuple):
    code: str
    line: int


# Of a kernel that is compiled now, or was in an earlier run of the tests.
ANNOUNCEMENT = re.compile(r"^strainwave: (?:compiling a kernel |\d+ of \d+ shards).*\n", re.MULTILINE)


def examples(page: Path) -> list[Example]:
    """The fenced blocks of Python, and of the command strainwave, on a page, and the line before each."""
    text = page.read_text()
    return [Example(block[1], text.count("\n", 0, block.start(1))) for block in FENCE.finditer(text)]


PAGES = [
    page
    for page in (
        *map(ROOT.joinpath, ("README.md", "CONTRIBUTING.md", "python/strainwave/AGENTS.md")),
        *sorted(page for folder in ("docs", "papers") for page in (ROOT / folder).rglob("*.md")),
    )
    if examples(page)
]


def tier(path: Path) -> list[pytest.MarkDecorator]:
    """Returns the mark of the examples of a page or a module: README is the whole path."""
    if path == ROOT / "README.md":
        return [pytest.mark.whole_path("docs")]
    return [pytest.mark.slow("docs")] if path.suffix == ".md" or path in SLOW_MODULES else []


def test_slow_modules_have_examples() -> None:
    assert set(MODULES) >= SLOW_MODULES


def write_files(page: Path, folder: Path) -> None:
    """A block whose first line is a comment with the name of a file is that file, there before the examples run."""
    for block in NAMED.finditer(page.read_text()):
        (folder / block[2]).write_text(block[1])


def run_session(example: Example, names: dict[str, object], page: Path) -> None:
    """Runs a block that shows a session, and compares what it prints."""
    session = doctest.DocTestParser().get_doctest(example.code, names, page.name, str(page), example.line)
    runner, said = doctest.DocTestRunner(optionflags=doctest.NORMALIZE_WHITESPACE), list[str]()
    result = runner.run(session, out=said.append, clear_globs=False)
    names.update(session.globs)
    assert result.failed == 0, "".join(said)


def run_program(example: Example, names: dict[str, object], page: Path) -> None:
    exec(compile("\n" * example.line + example.code, page, "exec"), names)


def run_commands(example: Example, page: Path) -> None:
    """Runs the commands of a console, and compares what they print."""
    for each in re.split(r"^\$ ", example.code, flags=re.MULTILINE)[1:]:
        command, shown = re.split(r"(?<!\\)\n", each, maxsplit=1)
        said = ANNOUNCEMENT.sub("", printed(command))
        alike = doctest.OutputChecker().check_output(shown, said, doctest.NORMALIZE_WHITESPACE)
        assert alike, f"{page.name}, line {example.line + 1}: {command}\n{said}"


def printed(command: str) -> str:
    """Returns what a command prints. This process has imported what most need, which takes longer than what they do."""
    own, pipe, filters = command.replace("\\\n", " ").partition("|")
    if not re.match(r"strainwave [^<>&;$`]*$", own):
        return in_shell(command)
    said = strainwave(*shlex.split(own)[1:], folder=Path.cwd())
    return (in_shell(filters, said.stdout) if pipe else said.stdout) + said.stderr


def in_shell(command: str, given: str = "") -> str:
    environment = os.environ | {"PATH": os.pathsep.join((str(Path(sys.executable).parent), os.environ["PATH"]))}
    said = subprocess.run(command, shell=True, env=environment, input=given, capture_output=True, text=True, check=False)
    return said.stdout + said.stderr


def run(example: Example, names: dict[str, object], page: Path) -> None:
    if example.code.startswith(">>>"):
        run_session(example, names, page)
    elif example.code.startswith("$ "):
        run_commands(example, page)
    else:
        run_program(example, names, page)


def draws_pictures(page: Path) -> bool:
    """True for a page of programs alone that draw its pictures: the run that drew them serves."""
    text = page.read_text(encoding="utf-8")
    programs_alone = all(not example.code.startswith((">>>", "$ ")) for example in examples(page))
    return programs_alone and page.stem in pictures.SHOWN.findall(text)


@pytest.mark.usefixtures("kept_builds")
@pytest.mark.parametrize(
    "page", [pytest.param(page, marks=tier(page)) for page in PAGES], ids=lambda page: str(page.relative_to(ROOT))
)
def test_the_examples_of_a_page_run_one_after_the_other(page: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    if draws_pictures(page):
        folder = pictures.drawn(page.stem, pictures.script_of(page.stem, {page: page.read_text(encoding="utf-8")}))
        assert (folder / pictures.WARNINGS).read_text(encoding="utf-8") == ""
        return
    monkeypatch.chdir(tmp_path)
    (tmp_path / "papers").symlink_to(ROOT / "papers")
    write_files(page, tmp_path)
    names: dict[str, object] = {"__name__": "__main__"}
    for example in examples(page):
        run(example, names, page)


@pytest.mark.parametrize(
    "path", [pytest.param(path, marks=tier(path)) for path in MODULES], ids=lambda path: str(path.relative_to(SOURCE))
)
def test_the_examples_in_docstrings_run(path: Path) -> None:
    module = importlib.import_module(".".join(path.relative_to(SOURCE).with_suffix("").parts).removesuffix(".__init__"))
    assert doctest.testmod(module).failed == 0


@pytest.mark.parametrize("room", [sw, sw.diagnose, sw.export, sw.rig], ids=lambda room: str(room.__name__))
def test_every_public_function_and_class_has_an_example(room: ModuleType) -> None:
    compiled = {"PassivityWarning"}  # an exception made in C++, which has a text alone
    public = [name for name in room.__all__ if callable(getattr(room, name)) and name not in compiled]
    assert public
    assert [name for name in public if ">>>" not in (getattr(room, name).__doc__ or "")] == []


def test_an_example_that_shows_something_else_fails(tmp_path: Path) -> None:
    page = tmp_path / "page.md"
    page.write_text("text\n\n```python\nx = 1\n```\n\n```python\n>>> x + 1\n3\n```\n")
    program, session = examples(page)
    names: dict[str, object] = {}
    run_program(program, names, page)
    with pytest.raises(AssertionError, match="line 8"):
        run_session(session, names, page)


def test_a_command_that_prints_something_else_fails(tmp_path: Path) -> None:
    page = tmp_path / "page.md"
    page.write_text(
        "```console\n$ python3 dev.py\n```\n\n```console\n$ strainwave list gears 14-30 \\\n  | cat\nhfuc-14-30\n```\n"
    )
    (commands,) = examples(page)
    run_commands(commands, page)
    with pytest.raises(AssertionError, match=r"page\.md, line 6: strainwave list gears"):
        run_commands(commands._replace(code=commands.code.replace("hfuc", "csg")), page)
