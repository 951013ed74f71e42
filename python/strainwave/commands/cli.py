"""The command `strainwave`: it assembles the verbs, each a file of this package, and prints their output or the fault."""

from __future__ import annotations

import os
import sys
import warnings
from contextlib import redirect_stdout
from errno import ENAMETOOLONG
from io import StringIO, TextIOWrapper
from pathlib import Path
from shutil import get_terminal_size
from textwrap import wrap
from typing import Annotated, Any, TextIO

import typer

from strainwave import exit_codes
from strainwave.commands.compare import compare
from strainwave.commands.compensate import compensate
from strainwave.commands.dataset import dataset
from strainwave.commands.demo import demo
from strainwave.commands.diagnose import diagnose
from strainwave.commands.docs import docs
from strainwave.commands.doctor import doctor
from strainwave.commands.export import export
from strainwave.commands.help import Verbs, Wing
from strainwave.commands.identify import identify
from strainwave.commands.list import list_command
from strainwave.commands.orders import orders
from strainwave.commands.plan import plan
from strainwave.commands.predict import predict
from strainwave.commands.show import show
from strainwave.commands.simulate import simulate
from strainwave.commands.studio import studio
from strainwave.commands.workbench import workbench
from strainwave.messages import one_line, shortened, unquoted, with_options
from strainwave.questions import ALL_JOINTS, NUMBER, Answer, QuestionError, added_to

rig = typer.Typer(cls=Wing, help="Plan, make and analyse tests of torsional stiffness.")
# Verbs, and rooms of several verbs, under the headings of the help.
HEADINGS: dict[str, dict[str, Any]] = {
    "From measurements": {"identify": identify, "predict": predict, "orders": orders, "plan": plan, "rig": rig},
    "With a model": {"simulate": simulate, "compensate": compensate, "export": export, "compare": compare},
    "Faults": {"diagnose": diagnose, "dataset": dataset},
    "Look and check": {
        "demo": demo,
        "list": list_command,
        "show": show,
        "workbench": workbench,
        "studio": studio,
        "docs": docs,
        "doctor": doctor,
    },
}
WITH_COLUMNS = ("identify", "predict", "orders", "diagnose joint", "rig analyse")  # verbs with the options --column and --unit
WITH_ALL_JOINTS = ("identify", "diagnose joint")
ANSWERS_OF_RIG = {"--column", "--unit", "--side"}

MAX_NAME_BYTES = 255  # of a file, on the usual file systems
MISUSED: type[Exception] = typer.BadParameter.__mro__[1]  # what typer raises of a command line, by no name of its own


class Command(Verbs):
    """The whole command, whose verbs are in the order of their headings."""

    def list_commands(self, ctx: Any) -> list[str]:
        return [name for verbs in HEADINGS.values() for name in verbs]


app = typer.Typer(
    cls=Command,
    help="Strain wave gears: measurements in, a validated model of that gear out.",
    epilog="Exit codes, files and examples: `strainwave docs command-line`.",
    context_settings={"help_option_names": ["-h", "--help"]},
    rich_markup_mode=None,  # plain help: rich alone takes longer to import than the help may take to appear
    pretty_exceptions_enable=False,
)
for heading, verbs in HEADINGS.items():
    for name, verb in verbs.items():
        if isinstance(verb, typer.Typer):
            app.add_typer(verb, name=name, rich_help_panel=heading)
        else:
            app.command(name, rich_help_panel=heading)(verb)


def _show_version(wanted: bool) -> None:
    if wanted:
        from importlib.metadata import version

        print(f"strainwave {version('strainwave')}")
        raise typer.Exit


@app.callback()
def _options(
    version: Annotated[
        bool, typer.Option("--version", help="Show the version and end.", callback=_show_version, is_eager=True)
    ] = False,
) -> None:
    """Options before a verb."""


def _is_one_of(verbs: tuple[str, ...]) -> bool:
    """True if the command line names one of these verbs."""
    return " ".join(sys.argv[1:]).startswith(verbs)


def main() -> None:
    """Run the command; input that cannot be used ends in one line and exit code 2, with nothing written.

    If a file leaves a question open, it is printed with a command for each answer. In a terminal a person may choose one at
    once, and the command runs again with it.
    """
    asked = list[str]()
    while True:
        code, question = run()
        if question is None:
            sys.exit(code)
        if question.question in asked:
            _print(f"strainwave: {question}\n", sys.stderr)
            sys.exit(code)
        asked.append(question.question)
        if not (words := _answered(question)):
            sys.exit(code)
        sys.argv[1:] = words


def run() -> tuple[int, QuestionError | None]:
    """Run the command once and print its output. Return the exit code, and the question that a file leaves open."""
    output, question = StringIO(), None
    try:
        with redirect_stdout(output), warnings.catch_warnings():
            warnings.showwarning = _warn
            code = app(sys.argv[1:] or ["--help"], standalone_mode=False)
    except MISUSED as error:
        _print(f"strainwave: {one_line(_misuse(error))}\n", sys.stderr)
        code = exit_codes.INPUT_REFUSED
    except QuestionError as error:
        question = QuestionError(error.question, [each for each in error.answers if _is_accepted(each)])
        code = exit_codes.INPUT_REFUSED
    except (OverflowError, ZeroDivisionError) as error:
        _print(f"strainwave: a number is too large or too small to compute with: {one_line(str(error))}\n", sys.stderr)
        code = exit_codes.INPUT_REFUSED
    except (ValueError, TypeError, OSError, ImportError, FloatingPointError, MemoryError) as error:
        reason = _of_system(error) if isinstance(error, OSError) and error.strerror else str(error)
        reason = reason or "this takes more memory than there is"  # where Python itself raises a MemoryError
        _print(f"strainwave: {one_line(with_options(reason, names_columns=_is_one_of(WITH_COLUMNS)))}\n", sys.stderr)
        code = exit_codes.INPUT_REFUSED
    finally:
        _print(output.getvalue(), sys.stdout)
    return code, question


def _of_system(error: OSError) -> str:
    """Return an error of the system in words, with the name of the file and what to do about a name that is too long."""
    name = "" if error.filename is None else f"{shortened(str(error.filename))}: "
    length = len(Path(str(error.filename or "")).name.encode())
    remedy = (
        f"; a file may have {MAX_NAME_BYTES} bytes in its name, not {length}: rename it" if error.errno == ENAMETOOLONG else ""
    )
    return f"{name}{str(error.strerror).lower()}{remedy}"


def _is_accepted(answer: Answer) -> bool:
    """True if the verb has the options of an answer."""
    options = {word for word in answer.options if word.startswith("--")}
    if sys.argv[1:2] == ["rig"]:
        return options <= ANSWERS_OF_RIG and not answer.files
    return answer.given.get("joint") != ALL_JOINTS or _is_one_of(WITH_ALL_JOINTS)


def _answered(question: QuestionError) -> list[str]:
    """Print a question. Return the command line with the answer that a person at a terminal chooses; empty if none does."""
    first, *lines = question.lines(["strainwave", *sys.argv[1:]])
    _print("".join(f"{line}\n" for line in [f"strainwave: {first}", *lines]), sys.stderr)
    if not question.answers or not _is_terminal():
        return []
    try:
        chosen = input(f"answer, 1 to {len(question.answers)}, or Enter to end: ").strip()
        if chosen not in map(str, range(1, len(question.answers) + 1)):
            return []
        answer = question.answers[int(chosen) - 1]
        of_person = {f"{name}=" for name in answer.numbers}
        options = [
            word.replace(NUMBER, input(f"{NUMBER} in {word}: ").strip()) if word.startswith((*of_person,)) else word
            for word in answer.options
        ]
        return added_to(sys.argv[1:], options, answer.files)
    except EOFError:
        return []


def _is_terminal() -> bool:
    """True if a person reads the output and can type."""
    return all(stream is not None and stream.isatty() for stream in (sys.stdin, sys.stdout, sys.stderr))


def _misuse(error: Any) -> str:
    """Return the fault of a command line in one sentence, with where help is."""
    command, wrong = "strainwave" if error.ctx is None else error.ctx.command_path, error.format_message().rstrip(".")
    if wrong.startswith("Missing") and error.ctx is not None:
        wrong += f" of {' '.join([command, *error.ctx.command.collect_usage_pieces(error.ctx)])}"
        gear = str(error.ctx.params.get("gear"))
        if Path(gear).suffix != ".toml" and Path(gear).exists():
            wrong = f"{unquoted(gear)} is a file, where the gear is asked for: name it first (strainwave list gears)"
    room = error.ctx.command if error.ctx is not None and error.ctx.parent is not None else None
    verbs = room.list_commands(error.ctx) if isinstance(room, Verbs) else []
    if wrong.startswith("No such command"):
        wrong += f": {command} is followed by {' or '.join(verbs)}" if verbs else ""
    return f"{wrong}; see {command} --help"


def _warn(message: Warning | str, *_: object, **__: object) -> None:
    _print(f"strainwave: warning: {one_line(str(message))}\n", sys.stderr)


def _to_width(text: str, width: int) -> str:
    """Return a text whose long lines end between words, as a terminal ends them anywhere; commands stay, to be copied.

    >>> print(_to_width("  note: the output turns one way only", 24))
      note: the output turns
        one way only
    """
    lines = list[str]()
    for line in text.split("\n"):
        start = line[: len(line) - len(line.lstrip())]
        keep = len(line) <= width or line.lstrip().startswith("strainwave ")
        lines += [line] if keep else wrap(line, width, subsequent_indent=f"{start}  ", break_on_hyphens=False)
    return "\n".join(lines)


def _print(text: str, stream: TextIO) -> None:
    """Print the output of a verb. Its work is done, so that a missing terminal or a full disk behind a pipe is no failure."""
    if isinstance(stream, TextIOWrapper):
        stream.reconfigure(errors="replace")  # letters that the terminal lacks
    try:
        print(_to_width(text, get_terminal_size().columns) if stream.isatty() else text, end="", file=stream, flush=True)
    except OSError as error:
        os.dup2(os.open(os.devnull, os.O_WRONLY), stream.fileno())  # Python tries again at the exit
        if not isinstance(error, BrokenPipeError):  # whoever read the output has seen enough
            _print(f"strainwave: the output cannot be printed: {error.strerror}\n", sys.stderr)
