"""Renders the tutorials, scripts of cells in `examples/tutorials/`, as pages that show what each cell prints and draws.

python docs/tutorials.py SCRIPT FOLDER    runs one tutorial and writes its page and pictures into FOLDER
"""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
import tempfile
import traceback
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import matplotlib
from kept import COMPILED, MAX_PROCESSES, kept

SCRIPTS = Path(__file__).resolve().parents[1] / "examples" / "tutorials"
HEAD = re.compile(r"^# %%(?: \[(markdown|console)\])?$", re.MULTILINE)  # of a cell
COMMAND = re.compile(r"^\$ ((?:.*\\\n)*.*)$", re.MULTILINE)
MYST_COMMENT = re.compile(r"^ {0,3}%", re.MULTILINE)
DOTS_PER_INCH = 110


@dataclass(frozen=True)
class Cell:
    """A cell of a tutorial.

    Attributes:
        kind: markdown, console or code
        text: its lines; of Markdown and commands without the # of a comment
        line: of the script, before the first one of the text
    """

    kind: str
    text: str
    line: int


class TutorialError(Exception):
    """A cell ended with an error: the message names script, line and error."""


def write(folder: Path) -> None:
    """Write the page of every tutorial with its pictures and files; raise TutorialError if a cell fails."""
    scripts = sorted(SCRIPTS.glob("[0-9]*.py"))
    with ThreadPoolExecutor(MAX_PROCESSES) as threads:
        list(threads.map(lambda script: write_page(script, folder), scripts))


def write_page(script: Path, folder: Path) -> None:
    """Write the page of one tutorial, or copy that of an earlier build."""
    files = (Path(__file__), script, *supplied_with(script))
    made = kept(
        f"tutorial-{script.stem}", b"".join(path.read_bytes() for path in files), lambda folder: run_alone(script, folder)
    )
    shutil.copytree(made, folder, dirs_exist_ok=True)


def run_alone(script: Path, folder: Path) -> None:
    """Write the page of one tutorial, run by a process of its own; raise TutorialError if a cell fails."""
    done = subprocess.run([sys.executable, __file__, str(script), str(folder)], stderr=subprocess.PIPE, text=True, check=False)
    if done.returncode:
        raise TutorialError(done.stderr.strip())
    sys.stderr.write(COMPILED.sub("", done.stderr))


def supplied_with(script: Path) -> list[Path]:
    """Return the files in the folder of a tutorial that it names."""
    text = script.read_text(encoding="utf-8")
    return [path for path in sorted(script.parent.glob("*.*")) if path.suffix != ".py" and is_named(path.name, text)]


def run(script: Path, folder: Path) -> None:
    """Run the cells of a tutorial in a temporary folder, and write its page and pictures.

    Commands run in a copy of that folder: code that needs what a command wrote fails, as it would in the script alone.
    """
    matplotlib.use("agg")
    text = script.read_text(encoding="utf-8")
    supplied = supplied_with(script)
    folder.mkdir(parents=True, exist_ok=True)
    for path in (script, *supplied):
        shutil.copy(path, folder)
    names: dict[str, Any] = {"__name__": "__main__"}
    before = Path.cwd()
    with tempfile.TemporaryDirectory() as working:
        for path in supplied:
            shutil.copy(path, working)
        os.chdir(working)
        try:
            blocks = [block for cell in cells(text) for block in shown(cell, script, folder, names)]
        finally:
            os.chdir(before)
    title, _, rest = "\n\n".join(blocks).partition("\n")
    files = ", ".join(f"{{download}}`{path.name}`" for path in (script, *supplied))
    page = f"{title}\n\n*To try it yourself, put these files into an empty folder:* {files}\n{rest}\n"
    (folder / f"{script.stem}.md").write_text(page, encoding="utf-8")


def is_named(file: str, text: str) -> bool:
    """True if a text contains the name of a file, and not as the end of a longer one."""
    return re.search(rf"(?<![\w-]){re.escape(file)}\b", text) is not None


def cells(text: str) -> Iterator[Cell]:
    """Yield the cells of a script."""
    heads = list(HEAD.finditer(text))
    for head, end in zip(heads, [*(each.start() for each in heads[1:]), len(text)], strict=True):
        body, line = text[head.end() : end].strip("\n"), text.count("\n", 0, head.end()) + 1
        kind = head[1] or "code"
        yield Cell(kind, body if kind == "code" else re.sub(r"^# ?", "", body, flags=re.MULTILINE), line)


def shown(cell: Cell, script: Path, folder: Path, names: dict[str, Any]) -> Iterator[str]:
    """Yield the Markdown of a cell: its text, then what it prints and draws."""
    if cell.kind == "markdown":
        if comment := MYST_COMMENT.search(cell.text):
            line = cell.line + 1 + cell.text.count("\n", 0, comment.start())
            raise TutorialError(f"{script.name}, line {line}: begins with %, so that the page leaves it out: wrap it elsewhere")
        yield cell.text
    elif cell.kind == "console":
        with tempfile.TemporaryDirectory() as apart:
            shutil.copytree(Path.cwd(), apart, dirs_exist_ok=True)
            yield f"```console\n{''.join(ran(cell, script, Path(apart)))}```"
    else:
        yield f"```python\n{cell.text}\n```"
        printed = executed(cell, script, names)
        if printed:
            yield f"```{{code-block}} text\n:class: output\n\n{printed.rstrip()}\n```"
        yield from drawn(f"{script.stem}-{cell.line}", folder)


def ran(cell: Cell, script: Path, folder: Path) -> Iterator[str]:
    """Yield each command with its output, run in a folder. A command that may fail ends with `|| echo "exit code $?"`."""
    path = os.pathsep.join((str(Path(sys.executable).parent), os.environ["PATH"]))
    for command in COMMAND.finditer(cell.text):
        done = subprocess.run(
            ["bash", "-o", "pipefail", "-c", command[1]], env=os.environ | {"PATH": path, "COLUMNS": "100"},
            cwd=folder, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, check=False,
        )  # fmt: skip
        if done.returncode:
            line = cell.line + 1 + cell.text.count("\n", 0, command.start())
            raise TutorialError(f"{script.name}, line {line}: exit code {done.returncode} of {command[1]}\n{done.stdout}")
        yield f"$ {command[1]}\n{COMPILED.sub('', done.stdout)}"


def executed(cell: Cell, script: Path, names: dict[str, Any]) -> str:
    """Return what a cell prints, and what the programs print that it starts."""
    sys.stdout.flush()
    terminal = os.dup(1)
    with tempfile.TemporaryFile() as output:
        os.dup2(output.fileno(), 1)
        try:
            exec(compile("\n" * cell.line + cell.text, script, "exec"), names)
        except Exception as error:
            lines = [frame.lineno for frame in traceback.extract_tb(error.__traceback__) if frame.filename == str(script)]
            line = lines[-1] if lines else getattr(error, "lineno", cell.line)
            raise TutorialError(f"{script.name}, line {line}: {type(error).__name__}: {error}") from error
        finally:
            sys.stdout.flush()
            os.dup2(terminal, 1)
            os.close(terminal)
        output.seek(0)
        return output.read().decode()


def drawn(name: str, folder: Path) -> Iterator[str]:
    """Yield a picture of each figure that is open, and close it. Its alternative text is the title of the figure."""
    import matplotlib.pyplot as plt

    for number in plt.get_fignums():
        figure = plt.figure(number)
        titles = [figure.get_suptitle(), *(axes.get_title() for axes in figure.axes)]
        figure.savefig(folder / f"{name}-{number}.png", dpi=DOTS_PER_INCH)
        plt.close(figure)
        yield f"![{next(filter(None, titles), 'the figure that this code draws')}]({name}-{number}.png)"


if __name__ == "__main__":
    try:
        run(Path(sys.argv[1]).resolve(), Path(sys.argv[2]).resolve())
    except TutorialError as error:
        sys.exit(str(error))
