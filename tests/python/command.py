"""The command as tests give it: in this process, or in one of its own."""

from __future__ import annotations

import signal
import subprocess
import sys
from collections.abc import Sequence
from contextlib import chdir, redirect_stderr, redirect_stdout
from dataclasses import dataclass
from io import StringIO
from pathlib import Path
from typing import Any
from xml.etree.ElementTree import Element

import pytest
from strainwave.commands.cli import main
from strainwave.drawing import svg

GOOD_GEAR = """name = "mine"
[kinematics]
model = "plain_ratio"
reduction = { value = 100, unit = "1", source = "assumed: example" }
[stiffness]
model = "linear"
k = { value = 3e4, unit = "N.m/rad", source = "assumed: example" }
"""


@dataclass(frozen=True)
class Result:
    returncode: int
    stdout: str
    stderr: str


def strainwave(*arguments: object, folder: Path) -> Result:
    """The command, run in this process, as in `folder`. Its pages have empty pictures: rendering takes most of its time."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(svg, "element", lambda figure, name, title: Element("svg", {"role": "img", "aria-label": title}))
        return rendering_strainwave(*arguments, folder=folder)


def rendering_strainwave(*arguments: object, folder: Path) -> Result:
    """The same, for tests that look at the pictures."""
    stdout, stderr = StringIO(), StringIO()
    with chdir(folder), redirect_stdout(stdout), redirect_stderr(stderr), pytest.MonkeyPatch.context() as patch:
        patch.setattr(sys, "argv", ["strainwave", *map(str, arguments)])
        patch.setattr(sys.modules["__main__"], "__package__", None)  # else the command would be `python -m pytest`
        with pytest.raises(SystemExit) as end:
            main()
    return Result(int(end.value.code or 0), stdout.getvalue(), stderr.getvalue())


def refused(folder: Path, arguments: Sequence[object], *expected: str) -> None:
    """The run ends with code 2 and one line that contains what is expected, and leaves no file behind."""
    before = sorted(folder.rglob("*"))
    result = strainwave(*arguments, folder=folder)
    assert result.returncode == 2, result.stderr
    assert result.stdout == ""
    lines = result.stderr.strip().splitlines()
    assert len(lines) == 1, result.stderr
    for text in expected:
        assert text in lines[0], f"{text!r} is not in {lines[0]!r}"
    assert sorted(folder.rglob("*")) == before


def start(*arguments: object, **others: Any) -> subprocess.Popen[bytes]:
    return subprocess.Popen([sys.executable, "-m", "strainwave", *map(str, arguments)], stderr=subprocess.PIPE, **others)


def interrupted(process: subprocess.Popen[bytes], written: str = "nothing") -> None:
    """Presses Ctrl-C once the process says that it is there: one line, and exit code 130."""
    assert process.stdout is not None
    with process:
        assert process.stdout.readline() == b"here\n"
        process.send_signal(signal.SIGINT)
        try:
            _, wrong = process.communicate(timeout=60.0)
        finally:
            process.kill()
    assert wrong.decode() == f"strainwave: interrupted; {written} written\n"
    assert process.returncode == 130
