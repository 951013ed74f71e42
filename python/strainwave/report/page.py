"""Pages: a template filled in and written as one file."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cache
from importlib import metadata
from pathlib import Path
from typing import TYPE_CHECKING, Any

from strainwave import typeset
from strainwave.drawing.style import DARK, LIGHT
from strainwave.files import writing
from strainwave.files.recording import Recording
from strainwave.messages import printable
from strainwave.report import figures
from strainwave.report.provenance import Provenance

if TYPE_CHECKING:
    from jinja2 import Environment


def render(template: str, content: Mapping[str, Any], provenance: Provenance | None = None) -> str:
    """Return the HTML of a template of this folder; whatever is put into it is escaped, control characters too.

    Args:
        template: name of the file in templates/
        content: what the template names
        provenance: command, date and files of the page, if they are to be shown

    Raises:
        jinja2.UndefinedError: the template names what `content` does not have
    """
    of_every_page = {
        "provenance": provenance or Provenance(),
        "version": metadata.version("strainwave"),
        "light": figures.variables(LIGHT),
        "dark": figures.variables(DARK),
    }
    return printable(_environment().get_template(template).render(of_every_page | dict(content)))


@cache
def _environment() -> Environment:
    """Return one environment for all pages, since it keeps the templates that it has compiled."""
    from jinja2 import Environment, PackageLoader, StrictUndefined

    environment = Environment(
        loader=PackageLoader("strainwave.report"),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    environment.filters |= {verb.__name__: verb for verb in (typeset.number, typeset.unit, typeset.symbols, typeset.breakable)}
    environment.globals["zip"] = zip
    return environment


def write_results(
    folder: Path, html: str, *, runs: Mapping[str, Recording] | None = None, tables: Mapping[str, Recording] | None = None
) -> None:
    """Write the results of a study to a folder: recordings as Parquet, tables as CSV, and last the page as report.html.

    Args:
        folder: made if it is not there
        html: the page; what stood in its place stays until it is complete
        runs, tables: by the name of the file without its ending

    Raises:
        OSError: folder or file cannot be written; the message names it and the reason
    """
    with writing.making(folder):
        for name, run in (runs or {}).items():
            run.to_parquet(folder / f"{name}.parquet")
            writing.written.append(folder / f"{name}.parquet")
        for name, table in (tables or {}).items():
            table.to_csv(folder / f"{name}.csv")
            writing.written.append(folder / f"{name}.csv")
        write(html, folder / "report.html")
        writing.written.append(folder / "report.html")


def write(html: str, path: str | Path) -> None:
    """Write a page; what stood at `path` stays until the new page is complete.

    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     write("<!doctype html>", f"{folder}/report.html")
    ...     Path(f"{folder}/report.html").read_text()
    '<!doctype html>'
    """
    with writing.replacing(path) as file:
        file.write(html.encode())
