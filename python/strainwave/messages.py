"""Texts of input as messages show them: one line, short, and without characters that a terminal would obey.

All messages that repeat something from a file, a command line or an argument use these functions.
"""

from __future__ import annotations

import re
import reprlib
import shlex
from collections.abc import Iterable, Sequence
from difflib import get_close_matches

MAX_TEXT = 60  # characters of a text in quotes
MAX_LINE = 960  # characters of a whole message; with its options in both spellings a question has some 600
MAX_NAMES = 20  # of a list
_CONTROLS = re.compile("[\x00-\x08\x0b-\x1f\x7f-\x9f\u200e\u200f\u202a-\u202e\u2066-\u2069]")


def one_line(message: str) -> str:
    """Return a message on one line: what cannot be printed is written as in Python, and a very long one loses its middle.

    >>> print(one_line("no file \\x1b[31mred.csv"))
    no file \\x1b[31mred.csv
    """
    line = "".join(each if each.isprintable() else _escaped(each) for each in message)
    half = MAX_LINE // 2
    return line if len(line) <= MAX_LINE else f"{line[:half]} … {line[-half:]}"


def printable(text: str) -> str:
    """Return a text of several lines, in which control characters and those that turn the direction of writing are escaped.

    >>> print(printable("red \\x1b[31m\\nand \\u202e"))
    red \\x1b[31m
    and \\u202e
    """
    return _CONTROLS.sub(lambda found: _escaped(found[0]), text)


def quoted(text: str) -> str:
    """Return a text in quotes, on one line; of a long one the beginning.

    >>> print(quoted("N.m"), quoted(1000 * "x"))
    "N.m" "xxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxx…"
    """
    return f'"{unquoted(text)}"'


def unquoted(text: str) -> str:
    """Return a text as `quoted` shows it, without the quotes: a name in a list, or a path within a model."""
    line = one_line(text[: MAX_TEXT + 1])
    return line if len(line) <= MAX_TEXT else f"{line[:MAX_TEXT]}…"


def listed(names: Iterable[str]) -> str:
    """Return names separated by commas; of many the first ones.

    >>> listed(["speed", "torque"])
    'speed, torque'
    """
    names = list(names)
    more = f" and {len(names) - MAX_NAMES} more" if len(names) > MAX_NAMES else ""
    return ", ".join(unquoted(name) for name in names[:MAX_NAMES]) + more


def named(what: str, names: Sequence[str]) -> str:
    """Return names in a list after what they are, in the singular for one.

    >>> named("order", ["2"]), named("order", ["2", "4"])
    ('order 2', 'orders 2, 4')
    """
    return f"{what}{'s' * (len(names) != 1)} {listed(names)}"


def in_a_sentence(names: Sequence[str]) -> str:
    """Return names as a sentence lists them.

    >>> in_a_sentence(["speed"]), in_a_sentence(["speed", "torque", "angle"])
    ('speed', 'speed, torque and angle')
    """
    return " and ".join(filter(None, (", ".join(names[:-1]), names[-1])))


def without_name(reason: str, *names: str) -> str:
    """Return a reason without the name of the file with which it begins, once or more.

    >>> without_name("day/run.csv: run.csv: at rest", "day/run.csv", "run.csv")
    'at rest'
    """
    while begin := next((f"{name}: " for name in names if reason.startswith(f"{name}: ")), ""):
        reason = reason.removeprefix(begin)
    return reason


def shortened(value: object) -> str:
    """Return a value of any type as Python writes it, on one line; of a long one a part.

    >>> shortened(list(range(100)))
    '[0, 1, 2, 3, 4, 5, ...]'
    """
    try:
        written = one_line(reprlib.repr(value))
        return f"<{type(value).__name__}>" if written.endswith("…>") else written  # the line of a result, cut twice
    except ValueError:  # Python writes no whole number of more than some thousand digits
        return f"<{type(value).__name__} with too many digits>"


def nearest_of(name: str, what: str, known: Iterable[str]) -> str:
    """Return known names in a sentence, behind the one that is nearly this one.

    >>> nearest_of("curent", "channels", ["current", "torque"])
    'did you mean current? The channels are current, torque'
    """
    known = list(known)
    near = get_close_matches(name, known, 1)
    return f"{f'did you mean {unquoted(near[0])}? The' if near else 'the'} {what} are {', '.join(map(unquoted, known))}"


def as_option(option: str, name: str, value: str) -> str:
    """Return the option that names a column or its unit, on the command line and in Python.

    >>> print(as_option("column", "speed", "Motor Speed"))
    --column 'speed=Motor Speed' (in Python columns={"speed": "Motor Speed"})
    """
    command = shlex.quote(f"{unquoted(name)}={unquoted(value)}")
    return f"--{option} {command} (in Python {option}s={{{quoted(name)}: {quoted(value)}}})"


def with_options(message: str, *, names_columns: bool = True) -> str:
    """Return a message for the command line: with options and commands in place of arguments and functions of Python.

    Args:
        message: as Python has it
        names_columns: True if the verb has the options --column and --unit

    >>> print(with_options("name it like " + as_option("column", "speed", "v")))
    name it like --column speed=v
    >>> print(with_options('side = "middle" must be one of input, output'))
    --side middle must be one of input, output
    >>> print(with_options("speed_limit is needed for friction"))
    --speed-limit is needed for friction
    >>> print(with_options("rtol = 1.0 must lie in [1e-11, 0.01]"))
    --tolerance 1.0 must lie in [1e-11, 0.01]
    """
    if not names_columns:
        message = re.sub(r", or give it with --unit .*? \(in Python units=\{.*?\}\)", "", message)
    text = re.sub(r", or pick columns with columns=\{\.\.\.\}", "", message)
    text = re.sub(r" \(in Python (\w+=\{.*?\}|FileMapping\(.*?\))\)", "", text)
    text = re.sub(r'^(side) = "([^"]*)"', r"--\1 \2", text)
    text = re.sub(r"^rtol = ", "--tolerance ", text)
    options = r"^(speed_limit|lowest_speed|torque_limit|rated_torque|torque(?= is needed))\b"
    text = re.sub(options, lambda found: "--" + found[1].replace("_", "-"), text)
    listing = 'strainwave.catalogue() lists all gears, catalogue("drives") all drives'
    return text.replace(listing, "`strainwave list gears` lists all gears, `strainwave list drives` all drives")


def pairs(option: str, values: Sequence[str] | None, known: set[str]) -> dict[str, str]:
    """Return the values of options as --column name=value, by name.

    Raises:
        ValueError: one is not written so, or its name is none of the columns that are known

    >>> pairs("--column", ["torque=Moment"], {"speed", "torque"})
    {'torque': 'Moment'}
    """
    found = {}
    for value in values or []:
        name, equals, given = value.partition("=")
        if not (name and equals and given):
            raise ValueError(f"{option} {value}: write it as {option} name=value")
        if name not in known:
            what = "constant" if option == "--constant" else "column"
            fault = f"{option} {value}: {name} is no {what} of these measurements"
            raise ValueError(f"{fault}; {nearest_of(name, f'{what}s', sorted(known))}")
        found[name] = given
    return found


def _escaped(character: str) -> str:
    return character.encode("unicode_escape").decode()
