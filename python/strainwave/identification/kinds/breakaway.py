"""Ramps of torque until the shaft breaks away."""

from __future__ import annotations

from collections.abc import Sequence

from strainwave.identification.kinds import at_rest
from strainwave.identification.kinds.kind import Kind
from strainwave.identification.reading.column import Column
from strainwave.identification.reading.kinds import ColumnRoles, at_rest_roles
from strainwave.identification.reading.mapping import FileMapping
from strainwave.identification.reading.recognise import Recognised
from strainwave.identification.results.file_result import FileResult
from strainwave.identification.results.gear_so_far import GearSoFar


class Breakaway(Kind):
    """A torque that rises while the shaft rests, until it moves."""

    time = "needed"

    def roles(self, columns: Sequence[Column], mapping: FileMapping) -> ColumnRoles:
        return at_rest_roles(columns, mapping, "breakaway")

    def fit(self, file: Recognised, known: GearSoFar) -> tuple[FileResult, GearSoFar]:
        """Estimate the torque of breakaway in both directions."""
        return at_rest.breakaway(file, known)
