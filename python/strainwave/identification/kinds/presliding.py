"""Presliding loops: small motions to and fro at rest, before the shaft slides."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from strainwave.identification.candidates.presliding import fit_presliding
from strainwave.identification.experiments.presliding import PreslidingLoop
from strainwave.identification.fitting.covariance import correlation_length
from strainwave.identification.kinds import at_rest
from strainwave.identification.kinds.kind import Kind, Ranked
from strainwave.identification.reading.column import Column
from strainwave.identification.reading.kinds import ColumnRoles, at_rest_roles
from strainwave.identification.reading.mapping import FileMapping
from strainwave.identification.reading.recognise import Recognised
from strainwave.identification.results.file_result import FileResult
from strainwave.identification.results.gear_so_far import GearSoFar


class Presliding(Kind):
    """Angle and torque of a shaft that moves to and fro without sliding on."""

    def roles(self, columns: Sequence[Column], mapping: FileMapping) -> ColumnRoles:
        return at_rest_roles(columns, mapping, "presliding")

    def fit(self, file: Recognised, known: GearSoFar) -> tuple[FileResult, GearSoFar]:
        """Fit bristles or Maxwell elements."""
        return at_rest.presliding(file, known)

    def rank(self, file: Recognised, known: GearSoFar) -> tuple[Ranked, ...]:
        """Return a bristle and numbers of Maxwell elements by their error on data held out."""
        loop = PreslidingLoop.of(at_rest.at_input(file, known)[0])
        begun = np.arange(len(loop.angle)) >= loop.turns[0]
        return tuple(
            Ranked(
                each.name, len(each.estimates), each.error, np.nan, "N.m",
                correlation_length((loop.torque - each.predicted)[begun]),
            )
            for each in fit_presliding(loop)
        )  # fmt: skip
