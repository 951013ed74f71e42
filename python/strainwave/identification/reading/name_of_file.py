"""Joint and speed in the name of a file, as of one record of many at constant speed."""

from __future__ import annotations

import re
from pathlib import Path

from strainwave.files.units import convert

# How people write the units of a speed in names of files, which have neither slashes nor brackets.
SPEED_UNITS_OF_FILES = {
    **dict.fromkeys(("rpm", "upm", "umin", "1min", "min-1", "rev_min"), "rpm"),
    **dict.fromkeys(("dps", "degps", "deg_s", "degs", "deg-s", "deg_per_s", "grad_s"), "deg/s"),
    **dict.fromkeys(("radps", "rad_s", "rads", "rad-s", "rad_per_s"), "rad/s"),
}
_SPEED_IN_NAME = re.compile(
    r"(?<![\w.+-])(?P<sign>[+-]|(?:neg|minus|pos|plus)[ _]?)?(?P<number>[0-9]{1,6}(?:[.p][0-9]{1,9})?)[ _]?"
    rf"(?P<unit>{'|'.join(sorted(map(re.escape, SPEED_UNITS_OF_FILES), key=len, reverse=True))})(?![a-z0-9])"
)


_JOINT_IN_NAME = re.compile(r"(?<![a-z0-9])(?:joint|jnt|gelenk|axis|achse|j|q)[ _-]?0*(?P<number>[0-9]{1,2})(?![0-9a-z.])")


def joint_in(path: Path) -> str:
    """Return the joint in the name of a file; empty if it contains none, or two.

    >>> joint_in(Path("joint_3_trapez.csv")), joint_in(Path("q2_run_1.csv")), joint_in(Path("run_2.csv"))
    ('3', '2', '')
    """
    found = {match["number"] for match in _JOINT_IN_NAME.finditer(path.stem.casefold())}
    return found.pop() if len(found) == 1 else ""


def speed_in(path: Path) -> float | None:
    """Return the speed with its unit in the name of a file [rad/s]; None if it contains none, or two.

    A minus right behind a word may be a hyphen: a number behind it is not taken.

    >>> speed_in(Path("run_-20rpm.csv")), speed_in(Path("J2_0p5_rad_s.txt")), speed_in(Path("run_20.csv"))
    (-2.0943951023931953, 0.5, None)
    """
    found = list(_SPEED_IN_NAME.finditer(re.sub(r"_(?=[+-]?[0-9])|_(?=neg|minus|pos|plus)", " ", path.stem.casefold())))
    if len(found) != 1:
        return None
    (match,) = found
    sign = -1.0 if (match["sign"] or "").startswith(("-", "neg", "minus")) else 1.0
    return sign * convert(float(match["number"].replace("p", ".")), SPEED_UNITS_OF_FILES[match["unit"]], "rad/s")
