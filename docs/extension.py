"""Conversion of docstrings for Sphinx; `sw.name` on a page links to the entry of that name."""

from __future__ import annotations

import re
from dataclasses import is_dataclass
from typing import Any

import docstrings
from docutils import nodes
from sphinx.application import Sphinx
from sphinx.transforms.post_transforms import SphinxPostTransform
from sphinx.util.nodes import make_refnode

ESCAPE = "\\"
TYPED_ATTRIBUTE = r"^(\.\. attribute:: \S+)\n((?:\n|   .*\n)*?)   :type: (.*)\n"  # as Napoleon writes it


def process_docstring(app: Sphinx, what: str, name: str, documented: Any, options: Any, lines: list[str]) -> None:
    """Rewrite the lines of a docstring in place, before Napoleon reads its sections."""
    if docstrings.is_model(documented):
        text = docstrings.restructured(docstrings.model_text(documented), docstrings.SYMBOL)
    elif compiled := docstrings.overload(documented):
        text = docstrings.restructured(compiled[1] or "")
        if isinstance(documented, property):
            text += f"\n\n:type: {docstrings.returned(compiled[0])}"
    else:
        text = docstrings.restructured("\n".join(lines))
    if is_dataclass(documented):
        text = re.sub(r"^Args:$", "Attributes:", text, flags=re.MULTILINE)
    lines[:] = text.splitlines()


def process_sections(app: Sphinx, what: str, name: str, documented: Any, options: Any, lines: list[str]) -> None:
    """Put the type of an attribute into its line, after Napoleon has read the sections."""
    text = re.sub(TYPED_ATTRIBUTE, with_type, "\n".join(lines) + "\n", flags=re.MULTILINE)
    text = re.sub(r"^\.\. attribute:: \w+, .*$", lambda names: names[0].replace(", ", "\n   "), text, flags=re.MULTILINE)
    if what == "property" and not docstrings.overload(documented):  # Napoleon takes words before a colon for a type
        text = re.sub(r"\A((?:.*\n)*?):type: (.*)\n", r"\2: \1", text)
    lines[:] = text.splitlines()


def with_type(found: re.Match[str]) -> str:
    head, meaning, kind = found.groups()
    return f"{head}\n   :type: {docstrings.shorter(kind.replace(ESCAPE, ''))}\n{meaning}"  # an annotation needs no escapes


def process_signature(
    app: Sphinx, what: str, name: str, documented: Any, options: Any, arguments: str | None, result: str | None
) -> tuple[str, str | None] | None:
    """Return arguments and result as a reader needs them."""
    return (docstrings.shorter(arguments), result and docstrings.shorter(result)) if arguments is not None else None


class LinkNames(SphinxPostTransform):
    """Link an inline literal that is a public name, as `sw.simulate`, to its entry."""

    default_priority = 5

    def run(self, **_: Any) -> None:
        entries = self.env.domains.python_domain.objects
        for literal in list(self.document.findall(nodes.literal)):
            if isinstance(literal.parent, nodes.reference) or not (written := literal.astext()).startswith("sw."):
                continue
            name = f"strainwave.{written.removeprefix('sw.').partition('(')[0]}"
            if entry := entries.get(name):
                link = make_refnode(self.app.builder, self.env.docname, entry.docname, entry.node_id, literal.deepcopy(), name)
                literal.replace_self(link)


def setup(app: Sphinx) -> dict[str, bool]:
    app.connect("autodoc-process-docstring", process_docstring, priority=400)
    app.connect("autodoc-process-docstring", process_sections, priority=600)
    app.connect("autodoc-process-signature", process_signature)
    app.add_post_transform(LinkNames)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
