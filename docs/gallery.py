"""Writes the gallery: one picture an example, and a page for each with its words and its code."""

from __future__ import annotations

import ast
import re
from dataclasses import dataclass
from pathlib import Path

from prose import escaped, linked

EXAMPLES = Path(__file__).resolve().parent.parent / "examples"
PLACE = "<!-- the pictures of all examples, in place of this list -->"  # on the page gallery.md
PICTURE = re.compile(r'savefig\("(\w+\.png)"')
PAGES = {  # with more on an example, by its number
    "02": ("reference/catalogue.md",),
    "03": ("how-to/drives.md",),
    "04": ("how-to/drives.md", "reference/gear-files.md"),
    "05": ("how-to/orders.md", "how-to/plots.md"),
    "11": ("how-to/simulate.md",),
    "13": ("validation/misalignment.md",),
    "15": ("how-to/torsion-rig.md",),
    "16": ("how-to/predict.md",),
    "17": ("how-to/compensate.md",),
    "18": ("how-to/positioning.md",),
    "19": ("how-to/compensate.md",),
    "20": ("how-to/creeping.md",),
    "21": ("how-to/compensate.md",),
    "22": ("how-to/compensate.md",),
    "23": ("validation/fault-signatures.md",),
    "24": ("validation/fault-signatures.md#four-spectra",),
    "25": ("validation/detection-benchmark.md",),
}


@dataclass(frozen=True)
class Example:
    """An example.

    Attributes:
        name: of the script, without its ending
        line: first line of its docstring
        words: the rest of it
        code: the script without its docstring
        picture: name of the file that it draws
    """

    name: str
    line: str
    words: str
    code: str
    picture: str

    @property
    def title(self) -> str:
        """The first line up to a colon, without its stop."""
        return self.line.partition(":")[0].rstrip(".")


def examples() -> list[Example]:
    """Return all examples in their order."""
    return [example_of(path) for path in sorted(EXAMPLES.glob("*.py"))]


def example_of(path: Path) -> Example:
    text = path.read_text(encoding="utf-8")
    tree = ast.parse(text)
    line, _, words = (ast.get_docstring(tree) or "").partition("\n")
    code = "\n".join(text.splitlines()[tree.body[0].end_lineno :]).strip()
    (picture,) = PICTURE.findall(code)
    return Example(path.stem, line, words.strip(), code, picture)


def write(source: Path) -> None:
    """Write the page of each example, and put the pictures of all on the page of the gallery."""
    (source / "gallery").mkdir()
    for example in examples():
        (source / "gallery" / f"{example.name}.md").write_text(page(example), encoding="utf-8")
    gallery = source / "gallery.md"
    text = gallery.read_text(encoding="utf-8")
    if PLACE not in text:
        raise ValueError(f"{gallery} has no line {PLACE}, where the pictures go")
    gallery.write_text(text.partition(PLACE)[0] + cards(), encoding="utf-8")


def cards() -> str:
    """Return the picture of each example as a link to its page, and the list of these pages."""
    figures = (
        f"```{{figure}} drawn/{each.name}/{each.picture}\n:target: gallery/{each.name}.html\n:alt: {each.title}\n"
        f":figclass: card\n\n[{escaped(each.title)}](gallery/{each.name}.md)\n```"
        for each in examples()
    )
    pages = "\n".join(f"gallery/{each.name}" for each in examples())
    return "\n\n".join([*figures, f"```{{toctree}}\n:hidden:\n\n{pages}\n```"])


def page(example: Example) -> str:
    """Return the page of an example: its words, its picture, its code, and where more is said."""
    more = ", ".join(f"[](../{path})" for path in PAGES.get(example.name[:2], ()))
    beyond = example.line.partition(":")[2].strip()  # the title
    words = "\n\n".join(linked(each) for each in (beyond[:1].upper() + beyond[1:], example.words) if each)
    parts = [
        f"# {escaped(example.title)}", words,
        f"![{escaped(example.title)}](../drawn/{example.name}/{example.picture})",
        *([f"More: {more}."] if more else []),
        f"## The script\n\n`examples/{example.name}.py`:", f"```python\n{example.code}\n```",
    ]  # fmt: skip
    return "\n\n".join(parts) + "\n"
