"""Drives of one shape, run as members of an ensemble."""

from __future__ import annotations

import warnings
from collections.abc import Sequence
from typing import Any

import numpy as np
import strainwave as sw
from strainwave import _core
from strainwave.simulation.signals import outputs


def side_by_side(drives: Sequence[sw.Drive], command: sw.scenario.Scenario, dt: float, **others: Any) -> sw.Ensemble:
    """All numbers of all drives, all outputs recorded."""
    paths = [path for path, *_ in _core.parameters(drives[0])]
    values = np.array([[value for _, value, *_ in _core.parameters(drive)] for drive in drives])
    record = list(outputs(drives[0]))
    parameters = dict(zip(paths, values.T, strict=True))
    with warnings.catch_warnings(action="ignore", category=sw.simulation.EnsembleWarning):  # of bristles too stiff for dt
        return sw.simulate_many(drives[0], command, parameters, dt, record=record, **others)
