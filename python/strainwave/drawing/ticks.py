"""Numbers at an axis; in a module of its own because it needs matplotlib, which is imported only to draw."""

from __future__ import annotations

from collections.abc import Iterable

from matplotlib.axis import Axis
from matplotlib.ticker import Formatter

from strainwave import typeset


class Ticks(Formatter):
    """Numbers in a power of ten, all to the same digit if the axis is linear."""

    def __init__(self, axis: Axis, power: int) -> None:
        self.of, self.power = axis, power

    def __call__(self, value: float, _: int | None = None) -> str:
        return self.format_ticks([value])[0]

    def format_ticks(self, values: Iterable[float]) -> list[str]:
        """All at once, since how many digits one has depends on the others."""
        numbers = [float(value) / 10.0**self.power for value in values]
        texts = [typeset.number(number, 4) for number in numbers]
        if self.of.get_scale() != "linear" or any("×" in text for text in texts):
            return texts
        places = max((len(text.partition(".")[2]) for text in texts), default=0)
        return [typeset.fixed(number, places) for number in numbers]
