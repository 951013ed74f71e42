"""Settings of Sphinx. `python3 dev.py docs` runs it on a copy of this folder, see build.py."""

from __future__ import annotations

from functools import lru_cache
from importlib import metadata

from docutils import nodes
from latex2mathml.converter import convert
from sphinx.application import Sphinx
from sphinx.util import logging
from sphinx.writers.html5 import HTML5Translator

project = "strainwave"
copyright = "the strainwave authors, Apache-2.0"
version = release = metadata.version("strainwave")

extensions = ["myst_parser", "sphinx.ext.autodoc", "sphinx.ext.napoleon", "extension"]
myst_enable_extensions = ["dollarmath"]
myst_heading_anchors = 4

autodoc_docstring_signature = False  # docstrings.py reads that of compiled models
autodoc_typehints_format = "short"
autodoc_member_order = "bysource"
python_use_unqualified_type_names = True
python_maximum_signature_line_length = 100
toc_object_entries = False  # thousands, which every page would carry
default_role = "py:obj"

html_theme = "furo"
html_static_path = ["_static"]
html_css_files = ["formulas.css", "layout.css", "tables.css", "print.css"]
html_title = f"{project} {version}"
html_show_sourcelink = False
html_copy_source = False
html_math_renderer = "mathml"


converted = lru_cache(convert)  # most symbols come often


def formula(writer: HTML5Translator, node: nodes.math | nodes.math_block) -> None:
    """Writes a formula as MathML, which browsers show by themselves, also offline."""
    source = node.astext().replace(
        r"\operatorname{atan2}", r"\mathrm{atan2}"
    )  # the converter sets a name with a digit in italics
    mathml = converted(source, display="block" if isinstance(node, nodes.math_block) else "inline")
    if "\\" in mathml:  # the converter passes over what it does not know
        logging.getLogger(__name__).warning("unknown command in the formula %s", node.astext(), location=node)
    writer.body.append(mathml)
    raise nodes.SkipNode


def setup(app: Sphinx) -> None:
    app.add_html_math_renderer("mathml", (formula, None), (formula, None))
