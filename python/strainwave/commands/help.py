"""Help of the command: verbs under headings, each with its whole summary, and examples at the end; rooms of verbs."""

from __future__ import annotations

from importlib import import_module
from textwrap import dedent, indent
from typing import Any

from typer.core import TyperGroup

WITHOUT_HEADING = "Verbs"


class Verbs(TyperGroup):
    """Verbs of the command or of one of its rooms. The examples of a verb are the section `Examples` of its docstring."""

    def get_command(self, ctx: Any, cmd_name: str) -> Any:
        command: Any = super().get_command(ctx, cmd_name)
        text, heading, examples = ((command and command.help) or "").partition("\nExamples:\n")
        if heading:
            command.help = text
            command.epilog = f"\b\nExamples:\n{indent(dedent(examples), '  ')}"  # \b: the lines stay as they are
        return command

    def format_commands(self, ctx: Any, formatter: Any) -> None:
        """Write every verb with its summary, where typer cuts summaries that are too long."""
        headings = dict[str, list[tuple[str, str]]]()
        names = self.list_commands(ctx)
        width = max(map(len, names))
        for name in names:
            command = self.get_command(ctx, name)
            rows = headings.setdefault(getattr(command, "rich_help_panel", None) or WITHOUT_HEADING, [])
            rows.append((name.ljust(width), summary(command)))
        for heading, rows in headings.items():
            with formatter.section(heading):
                formatter.write_dl(rows)


def summary(command: Any) -> str:
    """Return the first paragraph of the help of a verb."""
    return " ".join((command.help or "").split("\n\n")[0].split())


class Wing(Verbs):
    """Verbs of a wing of the package: `app` of its module `command`, which is imported once one of its verbs is called."""

    def list_commands(self, ctx: Any) -> list[str]:
        names: list[str] = self._verbs().list_commands(ctx)
        return names

    def get_command(self, ctx: Any, cmd_name: str) -> Any:
        return self._verbs().get_command(ctx, cmd_name)

    def _verbs(self) -> Any:
        from typer.main import get_command

        return get_command(import_module(f"strainwave.{self.name}.command").app)
