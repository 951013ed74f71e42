"""The page of the command: every verb with its usage, arguments, options, defaults and exit codes."""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path
from textwrap import dedent, indent
from typing import Any

import typer
from strainwave import exit_codes
from strainwave.commands import cli

ABOUT = f"""\
The command line
================

Every verb with its arguments and options; ``strainwave VERB --help`` prints the same. :doc:`/how-to/command-line` shows how
to use them.

.. list-table:: Exit codes
   :widths: 10 90
   :class: names

   * - 0
     - The verb has done its work.
   * - {exit_codes.INPUT_REFUSED}
     - The input cannot be used. One line states what is wrong, where, and what to do. Nothing is written.
   * - {exit_codes.RESULT_CONTRADICTED}
     - A check fails, a recording contradicts the saved gear, or a recording differs from the baseline: see the verb.
   * - 130
     - Ctrl-C has ended the verb. One line names the files that were written before."""


def write(folder: Path) -> None:
    """Write the page `command-line`."""
    app: Any = typer.main.get_command(cli.app)
    verbs = list(leaves(app, "strainwave"))
    rows = (
        f"   * - :ref:`{name.removeprefix('strainwave ')} <{label(name)}>`\n     - {plain(sentence(verb.help))}"
        for name, verb in verbs
    )
    table = "\n".join([".. list-table:: Verbs", "   :widths: 30 70", "   :class: names", "", *rows])
    text = [ABOUT, table, *(section(name, verb) for name, verb in verbs)]
    (folder / "command-line.rst").write_text("\n\n".join(text) + "\n", encoding="utf-8")


def leaves(command: Any, name: str) -> Iterator[tuple[str, Any]]:
    """Yield every verb below a command, with the words that call it."""
    if not hasattr(command, "list_commands"):
        yield name, command
        return
    context = command.context_class(command)
    for word in command.list_commands(context):
        yield from leaves(command.get_command(context, word), f"{name} {word}")


def section(name: str, verb: Any) -> str:
    """Return the section of a verb. Sphinx's `option` makes each of its options a target of the search."""
    context = verb.context_class(verb, info_name=name)
    usage = " ".join([name, *verb.collect_usage_pieces(context)])
    parameters = sorted(verb.get_params(context), key=lambda each: each.param_type_name)  # arguments first
    text = [f".. _{label(name)}:", f"{name}\n{'-' * len(name)}", f".. program:: {name}", f".. code-block:: text\n\n   {usage}"]
    help_text = re.sub(r"\s*\b\f.*", "", verb.help or "", flags=re.DOTALL)
    text += [plain(" ".join(paragraph.split())) for paragraph in help_text.split("\n\n")]
    records = [each.get_help_record(context) for each in parameters if each.name != "help"]
    text += [option(*record) for record in records if record]  # a hidden option has none
    if examples := (verb.epilog or "").partition("Examples:\n")[2]:
        lines = re.sub(r"^(?=strainwave)", "$ ", dedent(examples), flags=re.MULTILINE)
        text.append(f"Examples:\n\n.. code-block:: console\n\n{indent(lines, '   ')}")
    return "\n\n".join(text)


def option(written: str, meaning: str) -> str:
    return f".. option:: {written}\n\n   {plain(' '.join(meaning.split()))}"


def label(name: str) -> str:
    return name.replace(" ", "-")


def sentence(text: str) -> str:
    return re.split(r"\n\n|(?<=\.)\s", text)[0]


def plain(text: str) -> str:
    """Return words as reStructuredText that shows them as they are, options and code as literals."""
    return re.sub(r"`([^`]+)`|(?<![\w`])(--[\w-]+)|([\\*|]|(?<=\w)_(?!\w))", marked, text)


def marked(found: re.Match[str]) -> str:
    code, flag, mark = found.groups()
    return f"\\{mark}" if mark else f"``{code or flag}``"
