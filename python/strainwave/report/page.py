"""Pages: a template filled in, as one file."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cache
from importlib import metadata
from typing import TYPE_CHECKING, Any

from strainwave import typeset
from strainwave.drawing.style import DARK, LIGHT
from strainwave.messages import printable
from strainwave.report import figures
from strainwave.report.provenance import Provenance

if TYPE_CHECKING:
    from jinja2 import Environment


def render(
    template: str, content: Mapping[str, Any], provenance: Provenance | None = None, package: str = "strainwave.report"
) -> str:
    """Return the HTML of a template; whatever is put into it is escaped, control characters too.

    Args:
        template: name of the file in templates/ of the package, which extends those of this one
        content: what the template names
        provenance: command, date and files of the page, if they are to be shown
        package: that has the template

    Raises:
        jinja2.UndefinedError: the template names what `content` does not have
    """
    of_every_page = {
        "provenance": provenance or Provenance(),
        "version": metadata.version("strainwave"),
        "light": figures.variables(LIGHT),
        "dark": figures.variables(DARK),
    }
    return printable(_environment(package).get_template(template).render(of_every_page | dict(content)))


@cache
def _environment(package: str) -> Environment:
    """Return one environment for all pages of a package, since it keeps the templates that it has compiled."""
    from jinja2 import ChoiceLoader, Environment, PackageLoader, StrictUndefined

    environment = Environment(
        loader=ChoiceLoader([PackageLoader(each) for each in dict.fromkeys((package, "strainwave.report"))]),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    environment.filters |= {verb.__name__: verb for verb in (typeset.number, typeset.unit, typeset.symbols, typeset.breakable)}
    environment.globals["zip"] = zip
    return environment
