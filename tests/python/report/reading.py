"""Pages and drawings, taken apart again."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass, field
from html.parser import HTMLParser

import numpy as np


@dataclass
class Node:
    """An element of a page."""

    tag: str
    attributes: dict[str, str]
    children: list[Node | str] = field(default_factory=list)

    def walk(self) -> Iterator[Node]:
        yield self
        for child in self.children:
            if isinstance(child, Node):
                yield from child.walk()

    def find(self, tag: str, **attributes: str) -> list[Node]:
        return [n for n in self.walk() if n.tag == tag and attributes.items() <= n.attributes.items()]

    @property
    def text(self) -> str:
        parts = [child if isinstance(child, str) else child.text for child in self.children if child_is_read(child)]
        return " ".join("".join(parts).split())


def child_is_read(child: Node | str) -> bool:
    return isinstance(child, str) or child.tag not in ("style", "svg")


class Page(HTMLParser):
    """Builds the tree of a page and refuses one whose elements are not closed in order."""

    VOID = frozenset({"meta", "col", "br", "link", "img", "hr", "input", "wbr"})

    def __init__(self, html: str) -> None:
        super().__init__()
        self.open = [Node("page", {})]
        self.feed(html)
        self.close()
        assert len(self.open) == 1, f"<{self.open[-1].tag}> is not closed"

    @property
    def root(self) -> Node:
        return self.open[0]

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        node = Node(tag, {name: value or "" for name, value in attrs})
        self.open[-1].children.append(node)
        if tag not in self.VOID:
            self.open.append(node)

    def handle_startendtag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.open[-1].children.append(Node(tag, {name: value or "" for name, value in attrs}))

    def handle_endtag(self, tag: str) -> None:
        assert self.open[-1].tag == tag, f"</{tag}> closes <{self.open[-1].tag}>"
        self.open.pop()

    def handle_data(self, data: str) -> None:
        self.open[-1].children.append(data)


def section(html: str, name: str) -> Node:
    found = Page(html).root.find("section", id=name)
    assert len(found) == 1
    return found[0]


def printed(text: str) -> float:
    """A printed number without its uncertainty."""
    match = re.fullmatch(r"\(?(−?[\d.]+)(?: ± [^)]+)?\)?(?: × 10([⁻⁰¹²³⁴⁵⁶⁷⁸⁹]+))?", text.partition(" ± ∞")[0])
    assert match, text
    power = (match[2] or "⁰").translate(str.maketrans("⁻⁰¹²³⁴⁵⁶⁷⁸⁹", "-0123456789"))
    return float(f"{match[1].replace('−', '-')}e{power}")


def points(path: Node) -> np.ndarray:
    numbers = [float(number) for number in re.findall(r"-?[\d.]+", path.attributes["d"])]
    return np.reshape(numbers, (-1, 2))
