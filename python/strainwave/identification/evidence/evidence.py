"""One measurement, the model fitted to it, and what speaks for and against both."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from strainwave.equality import ComparedByFields
from strainwave.files.recording import Recording
from strainwave.identification.evidence.influence import Influence
from strainwave.identification.fitting.estimate import Estimate
from strainwave.identification.fitting.fit import Fit
from strainwave.identification.reading.measurement import Kind

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Doubt:
    """What speaks against a measurement as it was taken: it is to be confirmed or mended before the twin is used.

    Attributes:
        source: the measurement
        what: what is wrong with it
        remedy: what to do about it
    """

    source: str
    what: str
    remedy: str


@dataclass(frozen=True, eq=False)
class Evidence(ComparedByFields):
    """One measurement and what became of it.

    Attributes:
        kind: friction, torsion or log
        source: where the measurement came from
        recording: the measurement
        fit: the model fitted to it
        held_out: measured less predicted where the data were held out, shape (channels, m)
        error: rms of `held_out`, shape (channels,), in the units of `fit.experiment`
        candidates: name and held-out error of every model tried, best first
        influence: how the estimates move with the parameters kept
        unexplained: channels of which the model leaves too much unexplained, and the share of each
        doubts: what speaks against it
        shared: parameters that this measurement tells only together with others, by path, and how
        remarks: what the reader must know
    """

    kind: Kind
    source: str
    recording: Recording
    fit: Fit
    held_out: Array
    error: Array
    candidates: tuple[tuple[str, float], ...]
    influence: Influence
    unexplained: Mapping[str, float] = field(default_factory=dict)
    doubts: tuple[Doubt, ...] = ()
    shared: Mapping[str, str] = field(default_factory=dict)
    remarks: tuple[str, ...] = ()

    @property
    def prefix(self) -> str:
        """What stands before a path of the fit to make it one of a gear set; fits of a gear alone leave the first word out."""
        return "" if self.kind == "log" else "gear."

    def path(self, estimate: Estimate) -> str:
        """Where an estimate stands in a gear set."""
        return self.prefix + estimate.path
