"""Figures as SVG, coloured by the page that shows them: names of colours in place of the colours themselves."""

from __future__ import annotations

import io
import re
from typing import TYPE_CHECKING
from xml.etree import ElementTree

from strainwave.drawing.style import LIGHT, STYLE

if TYPE_CHECKING:
    from matplotlib.figure import Figure

Element = ElementTree.Element
CLEAR = {"figure.facecolor": "none", "axes.facecolor": "none"}


def element(figure: Figure, name: str, title: str) -> Element:
    """Return a figure as an element of SVG.

    Args:
        figure: with the colours of the style
        name: before each identifier of the drawing, which must be unique in a page
        title: read out in place of the drawing
    """
    from matplotlib import style
    from matplotlib.backends.backend_svg import FigureCanvasSVG

    file = io.StringIO()
    with style.context(["default", STYLE | CLEAR | {"svg.hashsalt": name}]):
        nothing = dict.fromkeys(("Creator", "Date", "Format", "Type"))
        FigureCanvasSVG(figure).print_svg(file, metadata=nothing)  # type: ignore[no-untyped-call]  # savefig draws twice
    return _tidied(ElementTree.fromstring(file.getvalue()), name, title)


def _tidied(drawn: Element, name: str, title: str) -> Element:
    """The drawing without what a page does not need: names of elements, digits beyond a hundredth of a point, fonts."""
    values = " ".join(value for element in drawn.iter() for value in element.attrib.values())
    references = set(re.findall(r"#(\w+)", values))
    for element in drawn.iter():
        element.tag = element.tag.partition("}")[2]
        element.attrib = {
            key.partition("}")[2] or key: _tidied_value(key, value, name)
            for key, value in element.attrib.items()
            if key != "id" or value in references
        }
        element.text, element.tail = (element.text or "").strip() if element.tag == "text" else None, None
    for element in drawn.iter():
        _style_once(element)
    svg = ElementTree.Element("svg", {"viewBox": drawn.attrib["viewBox"], "role": "img", "aria-label": title})
    svg.attrib |= {"stroke-linejoin": "round", "stroke-linecap": "butt"}
    svg.extend(child for child in drawn if child.find("style") is None)
    return svg


def _tidied_value(key: str, value: str, name: str) -> str:
    if key == "id":
        return f"{name}-{value}"
    if key == "d":
        return _path(value)
    if key == "style":
        value = re.sub(r"font-family: [^;]*;? ?", "", value)
        return re.sub(r"#\w{6}", lambda colour: _COLOURS.get(colour[0], colour[0]), value)
    value = re.sub(r"#(?=\w)", f"#{name}-", value) if key.endswith("href") or key == "clip-path" else value
    return re.sub(r"-?\d+\.\d+", _rounded, value) if key in ("x", "y", "width", "height", "transform") else value


_COLOURS = {colour: f"var(--{name}, {colour})" for name, colour in LIGHT.items()}


def _path(text: str) -> str:
    """A path in few letters: after M and L, further points need no letter of their own."""
    text = re.sub(r"-?\d+\.\d+", _rounded, " ".join(text.split()))
    return text.replace(" L ", " ") if set(re.findall("[A-Za-z]", text)) <= {"M", "L"} else text


def _rounded(number: re.Match[str]) -> str:
    return f"{float(number[0]):.2f}".rstrip("0").rstrip(".")


def _style_once(group: Element) -> None:
    """Moves a style that all markers of a group have up to the group."""
    styles = {child.get("style", "") for child in group}
    if len(group) > 1 and len(styles) == 1 and all(child.tag.endswith("use") for child in group):
        group.set("style", styles.pop())
        for child in group:
            del child.attrib["style"]
