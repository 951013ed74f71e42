"""Text of docstrings as Markdown: formulas, symbols, and links to the works that they cite."""

from __future__ import annotations

import re
from pathlib import Path

ERRATA = Path(__file__).with_name("validation") / "errata.md"
WORKS = Path(__file__).with_name("theory") / "references.md"
KEY = r"[A-Z][A-Za-z]+(?:1[6-9]|20)\d\d"  # of a work: its authors and its year
GREEK = (
    "[Aa]lpha|[Bb]eta|[Gg]amma|[Dd]elta|[Ee]psilon|[Zz]eta|[Ee]ta|[Tt]heta|[Kk]appa|[Ll]ambda|[Mm]u|[Nn]u|[Xx]i|[Pp]i|[Rr]ho|"
    "[Ss]igma|[Tt]au|[Pp]hi|[Cc]hi|[Pp]si|[Oo]mega"
)
SYMBOL = rf"\b(?:(?:{GREEK}|[A-Za-z])_[A-Za-z0-9]+|(?:{GREEK}))(?:\^\d)?\b"  # of a formula, within words
MAX_FORMULA_LINE = 66  # characters of a formula that fit on a line
FORMULA_GAP = 5  # characters between its parts


def markdown(words: str) -> str:
    """Return a docstring's formulas, examples and paragraphs."""
    return "\n\n".join(block(text) for text in re.split(r"\n\n+", words))


def block(text: str) -> str:
    if text.startswith(".. math::"):
        return "\n\n".join(f"$$\n{line}\n$$" for line in lines(" ".join(text.removeprefix(".. math::").split())))
    if text.startswith(">>>"):
        return f"```pycon\n{text}\n```"
    return linked(text)


def lines(formula: str) -> list[str]:
    """Return the lines of a formula: broken where it is marked, and after commas where it is too wide."""
    return [line for part in re.split(r"\\\\\s+", uniform(formula)) for line in filled(part)]


def uniform(formula: str) -> str:
    """Return a formula in which subscripts that are words stand upright, and phi and epsilon have one form each."""
    words = re.sub(r"_\{(?!ij)([a-z]{2,})\}", r"_{\\mathrm{\1}}", formula)
    return words.replace(r"\phi", r"\varphi").replace(r"\varepsilon", r"\epsilon")


def filled(formula: str) -> list[str]:
    """Return lines with as many of its parts as fit."""
    rows: list[str] = []
    for part in re.split(r"(?<=,)\s*\\q?quad\s*", formula):
        if rows and width(rows[-1]) + FORMULA_GAP + width(part) <= MAX_FORMULA_LINE:
            rows[-1] += rf" \qquad {part}"
        else:
            rows.append(part)
    return rows


def width(formula: str) -> int:
    """Return about how many characters a formula is wide: a command is one, unless it only arranges others."""
    words = re.sub(r"\\(operatorname|mathrm|text|frac|sqrt|left|right|dot|;|,)", "", formula)
    return len(re.sub(r"[\s{}_^]", "", re.sub(r"\\[a-zA-Z]+", "x", words)))


def escaped(text: str) -> str:
    """Return plain words as Markdown: code in backticks stays, symbols become formulas, other characters are escaped.

    So is a plus sign that begins a line, which would begin a list.
    """
    return re.sub(rf"(``.*?``|`[^`]+`)|({SYMBOL})|([\\`*_\[\]<>#|$]|(?<=\n)\+(?= ))", markup, text)


def markup(match: re.Match[str]) -> str:
    code, written, character = match.groups()
    return code or (f"${symbol(written)}$" if written else f"\\{character}")


def symbol(written: str) -> str:
    """Return a symbol, as theta_in, in the language of formulas."""
    return uniform(re.sub(r"_(\w+)", r"_{\1}", re.sub(rf"^(?={GREEK})", r"\\", written)))


def linked(text: str) -> str:
    """Return the same with works and titles of documents as links; raises KeyError for a work that is not described."""
    return re.sub(CITED, lambda match: f"[{match[0]}](../{TARGETS[match[0]]})", escaped(text))


def references() -> dict[str, str]:
    """Return where each key of a source stands."""
    keys = re.findall(r"^### (\w+)$", WORKS.read_text(encoding="utf-8"), re.MULTILINE)
    return {key: f"theory/references.md#{key.lower()}" for key in keys}


def titles() -> list[str]:
    """Return the titles of the documents that several models follow, as the headers state them."""
    return re.findall(r'^\| \*\*[RPAT]\*\* \| "([^"]+)"', ERRATA.read_text(encoding="utf-8"), re.MULTILINE)


TARGETS = references() | dict.fromkeys(titles(), "validation/errata.md#the-four-documents")
CITED = rf"\b(?:{'|'.join(titles())}|{KEY})\b"
