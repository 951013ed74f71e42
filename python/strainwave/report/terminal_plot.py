"""A loop drawn with the letters of a terminal, for work at the rig."""

from __future__ import annotations

from dataclasses import dataclass, field
from math import ceil, floor, log10

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

PLOT_ROWS = 16  # of the plot, its axis not counted
MIN_COLUMNS = 36  # columns of a terminal that a plot needs
BRAILLE_BLANK = 0x2800  # code point of the empty sign; its dots are bits, two columns of four
DOTS = ((0x01, 0x02, 0x04, 0x40), (0x08, 0x10, 0x20, 0x80))
SIGNS = "⣿·┤└─●°−"  # what a terminal must be able to show; plain letters take their place otherwise
ROUND = (1.0, 1.5, 2.0, 2.5, 3.0, 4.0, 5.0, 6.0, 8.0, 10.0)  # ends of axes, times a power of ten


def loop_lines(angle: Array, torque: Array, width: int, letters: str = "utf-8", rows: int = PLOT_ROWS) -> list[str]:
    """Return a loop as lines of text: torque upwards in N.m, angle to the right in degrees, the last point marked.

    Args:
        angle: how far the shaft has turned [rad], shape (n,), n >= 1
        torque: on the shaft [N.m], shape (n,)
        width: columns of the terminal; one that is too narrow gets no plot
        letters: encoding of the terminal; dots of braille where it has them
        rows: of the plot

    >>> for line in loop_lines(np.radians([0.0, -10.0, -50.0]), np.array([0.36, 0.0, -0.36]), 44, "ascii", rows=5):
    ...     print(line)
    torque [N.m]
       0.4 |                                 ..
           |                             ....
         0 |                    .........
           |     ...............
      -0.4 |*....
           +-----------------------------------
            -50                               0
                                    angle [deg]
    """
    if width < MIN_COLUMNS:
        return []
    plain = not _shows(SIGNS, letters)
    degrees = np.degrees(angle)
    across, up = _ends(degrees), _ends(torque)
    names = {rows - 1: _written(up[0], plain), 0: _written(up[1], plain)}
    if up[0] < 0.0 < up[1]:
        names[round((rows - 1) * up[1] / (up[1] - up[0]))] = "0"
    margin = max(map(len, names.values())) + 2
    columns = width - margin - 3
    canvas = _Canvas(columns, rows, plain)
    canvas.join((degrees - across[0]) / (across[1] - across[0]), (up[1] - torque) / (up[1] - up[0]))
    edge, corner, rule = (" |", " +", "-") if plain else (" ┤", " └", "─")
    low, high = (_written(value, plain) for value in across)
    return [
        "torque [N.m]" if plain else "torque [N·m]",
        *(f"{names.get(row, ''):>{margin}}{edge}{text}".rstrip() for row, text in enumerate(canvas.lines())),
        " " * margin + corner + rule * columns,
        " " * (margin + 2) + low + f"{high:>{columns - len(low)}}",
        f"{'angle [deg]' if plain else 'angle [°]':>{margin + 2 + columns}}",
    ]


def _shows(signs: str, letters: str) -> bool:
    try:
        signs.encode(letters)
    except (UnicodeEncodeError, LookupError):
        return False
    return True


def _written(value: float, plain: bool) -> str:
    text = f"{value:.6g}"
    return text if plain else text.replace("-", "−")


def _ends(values: Array) -> tuple[float, float]:
    """Round numbers around the values and zero, so that the axis stays while few points come in."""
    low, high = min(float(values.min()), 0.0), max(float(values.max()), 0.0)
    if low == high:
        return -1.0, 1.0
    return -_rounded_up(-low), _rounded_up(high)


def _rounded_up(value: float) -> float:
    if value <= 0.0:
        return 0.0
    decade = 10.0 ** floor(log10(value))
    return decade * next(each for each in ROUND if value <= each * decade * (1.0 + 1e-9))


@dataclass
class _Canvas:
    """Dots on a grid of letters: 2 by 4 to a letter of braille, one to a plain letter."""

    columns: int
    rows: int
    plain: bool
    dots: set[tuple[int, int]] = field(default_factory=set)
    last: tuple[int, int] = (0, 0)

    @property
    def size(self) -> tuple[int, int]:
        return (self.columns, self.rows) if self.plain else (2 * self.columns, 4 * self.rows)

    def join(self, x: Array, y: Array) -> None:
        """Straight lines between points, whose coordinates go from 0 to 1, rightwards and down."""
        wide, high = self.size
        place = np.column_stack([x * (wide - 1), y * (high - 1)])
        for start, stop in zip(place, place[1:] if len(place) > 1 else place, strict=False):
            count = ceil(float(np.abs(stop - start).max())) + 1
            line = np.rint(np.linspace(start, stop, count)).astype(int)
            self.dots |= {(int(column), int(row)) for column, row in line}
        self.last = (int(np.rint(place[-1, 0])), int(np.rint(place[-1, 1])))

    def lines(self) -> list[str]:
        if self.plain:
            grid = [["." if (column, row) in self.dots else " " for column in range(self.columns)] for row in range(self.rows)]
            grid[self.last[1]][self.last[0]] = "*"
        else:
            bits = np.zeros((self.rows, self.columns), int)
            for column, row in self.dots:
                bits[row // 4, column // 2] |= DOTS[column % 2][row % 4]
            grid = [[chr(BRAILLE_BLANK + bit) if bit else " " for bit in each] for each in bits.tolist()]
            grid[self.last[1] // 4][self.last[0] // 2] = "●"
        return ["".join(row) for row in grid]
