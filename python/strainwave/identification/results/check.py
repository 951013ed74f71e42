"""A consistency check: two numbers that must agree, or a limit that a model must keep."""

from __future__ import annotations

from dataclasses import dataclass

from strainwave import typeset
from strainwave.presentation import Presented


@dataclass(frozen=True)
class Check(Presented):
    """A consistency check of a measurement, or of several together.

    Attributes:
        name: of the check, the same for every file, as `ratio of two encoders`
        source: the file, or the files, that it concerns
        value: the number that is checked
        limit: the threshold that it must not exceed
        unit: of both
        failed: True if the value exceeds the limit
        message: the numbers that disagree, and why they should not; one sentence
        remedy: what to check first, or the option that settles it
    """

    name: str
    source: str
    value: float
    limit: float
    unit: str
    failed: bool
    message: str = ""
    remedy: str = ""

    def _headline(self) -> str:
        return f"{self.name} of {self.source}: {typeset.quantity(self.value, self.unit)}, {self._verdict()}"

    def _verdict(self) -> str:
        return f"{'FAILED' if self.failed else 'passed'}, limit {typeset.quantity(self.limit, self.unit)}"
