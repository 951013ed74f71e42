"""Figures of reports as SVG: drawn by matplotlib's objects, coloured by the page that shows them.

Colours are names (measured, model, …) that a page defines for its light and its dark scheme, so that one drawing serves
both. The same data give the same bytes, whatever style or locale the machine prefers.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING
from xml.etree import ElementTree

from strainwave.drawing import svg
from strainwave.drawing.style import DARK, LIGHT, STYLE

if TYPE_CHECKING:
    from markupsafe import Markup
    from matplotlib.figure import Figure

Draw = Callable[["Figure"], None]


def inline(draw: Draw, size: tuple[float, float], name: str, title: str) -> Markup:
    """Return SVG to stand in a page, whose colours and letters it takes."""
    from markupsafe import Markup

    return Markup(ElementTree.tostring(_svg(draw, size, name, title), encoding="unicode"))


def standalone(draw: Draw, size: tuple[float, float], name: str, title: str) -> str:
    """SVG to stand in a file, with the colours of the light and of the dark scheme."""
    drawing = _svg(draw, size, name, title)
    drawing.set("xmlns", "http://www.w3.org/2000/svg")
    style = ElementTree.Element("style")
    style.text = (
        f":root {{ font-family: system-ui, sans-serif; {variables(LIGHT)} }} "
        f"@media (prefers-color-scheme: dark) {{ :root {{ {variables(DARK)} }} }}"
    )
    drawing.insert(0, style)
    return ElementTree.tostring(drawing, encoding="unicode") + "\n"


def variables(colours: dict[str, str]) -> str:
    """Colours as a style sheet defines them."""
    return " ".join(f"--{name}: {colour};" for name, colour in colours.items())


def _svg(draw: Draw, size: tuple[float, float], name: str, title: str) -> ElementTree.Element:
    from matplotlib import style
    from matplotlib.figure import Figure

    with style.context(["default", STYLE | svg.CLEAR]):
        figure = Figure(figsize=size)
        draw(figure)
    return svg.element(figure, name, title)
