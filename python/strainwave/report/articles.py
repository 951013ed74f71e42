"""The four documents that the models follow, and their errata, in words: the core names them by a letter."""

from __future__ import annotations

import re

NAMES = {  # docs/validation/errata.md has their titles
    "R": "review of dynamic models",
    "P": "position control article",
    "A": "flight actuator paper",
    "T": "torsional stiffness article",
}
_ERRATA = re.compile(r"(?:errat(?:um|a) )?\bE-([RPAT])(\d+)((?:(?:, | and | to )E-\1\d+)*)")


def in_words(text: str) -> str:
    """Return a text with the names of documents and the numbers of their errata in words.

    >>> in_words("Document R; errata E-P3, E-P4")
    'the review of dynamic models; errata 3, 4 of the position control article'
    """
    text = _ERRATA.sub(_errata, text)
    return re.sub(r"\b[Dd]ocument ([RPAT])\b", lambda found: f"the {NAMES[found[1]]}", text)


def _errata(found: re.Match[str]) -> str:
    others = re.sub(r"E-[RPAT]", "", found[3])
    return f"{'errata' if others else 'erratum'} {found[2]}{others} of the {NAMES[found[1]]}"
