"""Names that users give to exports, and other programs must take."""

from __future__ import annotations

import re

from strainwave import arguments
from strainwave.messages import quoted

MAX_NAME_LENGTH = 40  # characters


def checked_name(name: object, program: str, *, hyphens: bool = False, reserved: frozenset[str] = frozenset()) -> str:
    """Return a name that another program takes.

    Args:
        name: given by the user
        program: or language, as a message names it
        hyphens: whether they may be in the name
        reserved: words of the language, which are no names

    Raises:
        TypeError, ValueError: it is none

    >>> checked_name("2 joints", "ROS")
    Traceback (most recent call last):
    ValueError: name = "2 joints" must be a name in ROS: letters, digits and underscores, 40 at most, the first a letter
    """
    text = arguments.text("name", name)
    pattern = r"[A-Za-z][A-Za-z0-9_-]*" if hyphens else r"[A-Za-z][A-Za-z0-9_]*"
    if re.fullmatch(pattern, text) and len(text) <= MAX_NAME_LENGTH and text not in reserved:
        return text
    letters = "letters, digits, underscores and hyphens" if hyphens else "letters, digits and underscores"
    words = ", and no word of the language" if reserved else ""
    raise ValueError(
        f"name = {quoted(text)} must be a name in {program}: {letters}, {MAX_NAME_LENGTH} at most, the first a letter{words}"
    )
