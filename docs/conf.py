"""Settings of Sphinx. `python3 dev.py docs` runs it on a copy of this folder, see build.py."""

from __future__ import annotations

from importlib import metadata

from docutils import nodes
from latex2mathml.converter import convert
from sphinx.application import Sphinx
from sphinx.util import logging
from sphinx.writers.html5 import HTML5Translator

project = "strainwave"
copyright = "the strainwave authors, Apache-2.0"
version = release = metadata.version("strainwave")

extensions = ["myst_parser"]
myst_enable_extensions = ["dollarmath"]
myst_heading_anchors = 4
html_theme = "furo"
html_static_path = ["_static"]
html_css_files = ["formulas.css", "layout.css", "tables.css"]
html_title = f"{project} {version}"
html_show_sourcelink = False
html_copy_source = False
html_math_renderer = "mathml"


def formula(writer: HTML5Translator, node: nodes.math | nodes.math_block) -> None:
    """Writes a formula as MathML, which browsers show by themselves, also offline."""
    source = node.astext().replace(
        r"\operatorname{atan2}", r"\mathrm{atan2}"
    )  # the converter sets a name with a digit in italics
    mathml = convert(source, display="block" if isinstance(node, nodes.math_block) else "inline")
    if "\\" in mathml:  # the converter passes over what it does not know
        logging.getLogger(__name__).warning("unknown command in the formula %s", node.astext(), location=node)
    writer.body.append(mathml)
    raise nodes.SkipNode


def setup(app: Sphinx) -> None:
    app.add_html_math_renderer("mathml", (formula, None), (formula, None))
