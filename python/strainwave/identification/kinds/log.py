"""Logs of a drive in motion."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from strainwave.files.gear_set import GearSet
from strainwave.identification.candidates.motion import fit_motion
from strainwave.identification.candidates.motion_candidate import MotionCandidate
from strainwave.identification.fitting.covariance import correlation_length
from strainwave.identification.kinds.along_motion import fit_log
from strainwave.identification.kinds.kind import Kind, Ranked
from strainwave.identification.kinds.predicted_log import predict_log
from strainwave.identification.kinds.prepared_log import log_of
from strainwave.identification.reading.column import Column
from strainwave.identification.reading.kinds import ColumnRoles, log_roles
from strainwave.identification.reading.mapping import FileMapping
from strainwave.identification.reading.recognise import Recognised
from strainwave.identification.results.file_result import FileResult
from strainwave.identification.results.gear_so_far import GearSoFar
from strainwave.identification.results.prediction import Prediction


class Log(Kind):
    """Time, a motion, and what drove it: a current, torque, voltage or command."""

    time = "needed"

    def roles(self, columns: Sequence[Column], mapping: FileMapping) -> ColumnRoles:
        return log_roles(columns, mapping)

    def fit(self, file: Recognised, known: GearSoFar) -> tuple[FileResult, GearSoFar]:
        """Fit friction, inertia and gravity along the motion, and with two encoders what lies between them."""
        return fit_log(file, known)

    def rank(self, file: Recognised, known: GearSoFar) -> tuple[Ranked, ...]:
        """Return the laws of friction by their error on data held out."""
        found = log_of(file, known)
        unit = found.log.units[0]
        return tuple(_ranked(each, unit) for each in fit_motion([found.log], found.drive))

    def predict(self, file: Recognised, gear_set: GearSet) -> Prediction:
        """Compare the torque along the motion with that of a saved drive."""
        return predict_log(file, gear_set)


def _ranked(each: MotionCandidate, unit: str) -> Ranked:
    correlation = max(correlation_length(part.residuals[0]) for part in each.fit.parts)
    nuisances = sum(len(part.experiment.nuisances) for part in each.fit.parts)
    fitted = len(each.fit.estimates) - nuisances - len(each.model.ties)
    return Ranked(each.name, fitted, each.error, np.nan, unit, correlation)
