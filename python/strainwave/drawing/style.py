"""One style of all drawings: colours of a light and of a dark page, sizes, and settings of matplotlib."""

from __future__ import annotations

LIGHT = {
    "ink": "#1c2127",
    "muted": "#59636e",
    "rule": "#d8dee4",
    "measured": "#2166ac",
    "model": "#c2410c",
    "held-out": "#7b3fa0",
    "earlier": "#80650a",
}
DARK = {
    "ink": "#e6e9ed",
    "muted": "#9aa5b1",
    "rule": "#38414b",
    "measured": "#7ab8ff",
    "model": "#ff9f6b",
    "held-out": "#d3a4ff",
    "earlier": "#e0c15c",
}
RUNS = (  # colours, lines and widths of curves, in turn
    ("model", "-", 2.0), ("measured", "--", 1.5), ("held-out", ":", 1.3), ("earlier", "-.", 1.3),
)  # fmt: skip
FIGURE_WIDTH = 4.4  # inches: its letters are as large as those of the page, on a telephone as well as on a desk
LETTERS_PER_LINE = 48  # that fit in this width
LETTERS_PER_TITLE_LINE = 50  # of a title
DOTS_PER_INCH = 160  # of a figure as pixels
LETTERS_PER_HANDLE = 5  # width of the line before a label

STYLE = {
    "axes.axisbelow": True,
    "axes.edgecolor": LIGHT["muted"],
    "axes.grid": True,
    "axes.labelcolor": LIGHT["ink"],
    "axes.spines.right": False,
    "axes.spines.top": False,
    "axes.titlelocation": "left",
    "axes.titlesize": "medium",
    "figure.constrained_layout.use": True,
    "font.family": ["DejaVu Sans"],
    "font.size": 9.0,
    "grid.color": LIGHT["rule"],
    "grid.linewidth": 0.6,
    "legend.frameon": False,
    "legend.handlelength": 1.6,
    "lines.linewidth": 1.3,
    "lines.markersize": 4.0,
    "svg.fonttype": "none",
    "text.color": LIGHT["ink"],
    "text.parse_math": False,
    "xtick.color": LIGHT["muted"],
    "ytick.color": LIGHT["muted"],
}
