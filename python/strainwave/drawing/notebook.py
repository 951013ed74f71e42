"""A result as HTML of a notebook, readable on a light and on a dark page, with its picture inline."""

from __future__ import annotations

from collections.abc import Sequence
from hashlib import sha256
from html import escape
from typing import TYPE_CHECKING
from xml.etree import ElementTree

from strainwave.drawing import svg
from strainwave.messages import one_line

if TYPE_CHECKING:
    from matplotlib.figure import Figure

# A result does not know whether its page is dark: letters have the colour of the page, curves one that is visible on both.
COLOURS = {
    "ink": "currentColor", "muted": "#808080", "rule": "rgba(128, 128, 128, 0.35)", "measured": "#3d85c6",
    "model": "#dd6b20", "held-out": "#a06cd5", "earlier": "#a88a1c",
}  # fmt: skip


def html(
    kind: str, headline: str, rows: Sequence[Sequence[str]], more: int, remarks: Sequence[str], figure: Figure | None
) -> str:
    """Return a result as HTML: headline, table, remarks and picture. All texts are escaped.

    Args:
        kind, headline: of the result
        rows: cells of the table: name, number, unit and note, or name and text
        more: count of rows that the table leaves out
        remarks: sentences below it
        figure: picture below them
    """
    style = "; ".join(f"--{name}: {colour}" for name, colour in COLOURS.items())
    parts = [
        f"<p><strong>{_text(kind)}</strong> {_text(headline)}</p>",
        f'<div style="overflow-x: auto"><table>{"".join(map(_row, rows))}</table></div>' if rows else "",
        f"<p>… and {more} more: <code>to_dict()</code> has all</p>" if more else "",
        *(f"<p><em>{_text(remark)}</em></p>" for remark in remarks),
        "" if figure is None else f'<div style="max-width: 36em">{_drawing(figure, f"{kind} {headline}")}</div>',
    ]
    return f'<div class="strainwave" style="{style}">{"".join(parts)}</div>'


def _row(cells: Sequence[str]) -> str:
    left = 'style="text-align: left"'
    last = 'style="text-align: left; width: 100%"'  # takes what a text is wider than the other columns
    name, value, *rest = map(_text, cells)
    if not rest:
        return f'<tr><th {left}>{name}</th><td colspan="3" {left}>{value}</td></tr>'
    number = f'<td style="text-align: right; white-space: nowrap">{value}</td>'
    return f"<tr><th {left}>{name}</th>{number}<td {left}>{rest[0]}</td><td {last}>{rest[1]}</td></tr>"


def _text(text: str) -> str:
    return escape(one_line(text))


def _drawing(figure: Figure, title: str) -> str:
    """Return a figure as SVG whose identifiers no other picture of the notebook has."""
    figure.set_facecolor("none")
    for axes in figure.axes:
        axes.set_facecolor("none")
    drawing = ElementTree.tostring(svg.element(figure, "NAME", title), encoding="unicode")
    return drawing.replace("NAME-", f"sw{sha256(drawing.encode()).hexdigest()[:10]}-")
