"""Result of an export: files, the numbers in them, and what they lose against the gear."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from strainwave.files.recording import Recording
from strainwave.tuning.loss import ExportLoss


@dataclass(frozen=True)
class Exported:
    """A gear in the form of another program.

    Attributes:
        kind: of the export, as the command names it
        gear: name of the gear
        files: their texts or bytes, by the path in the folder
        numbers: that were written, with their units
        losses: against the gear, computed
        left_out: laws of the gear that the form has no place for, in words
        remarks: what to do with the files and numbers, and what was assumed
        table: columns of numbers, written as <kind>.csv

    >>> import strainwave as sw
    >>> found = sw.export.joint(sw.GearSet.read("csg-20-100"))
    >>> value, unit = found.numbers["frictionloss"]
    >>> sorted(found.files), round(value, 2), unit
    (['joint.urdf', 'joint.xml'], 4.61, 'N.m')
    >>> found.left_out[1]
    'torsion: 3.99 mrad at 107 N.m'
    """

    kind: str
    gear: str
    files: Mapping[str, str | bytes]
    numbers: Mapping[str, tuple[float, str]] = field(default_factory=dict)
    losses: tuple[ExportLoss, ...] = ()
    left_out: tuple[str, ...] = ()
    remarks: tuple[str, ...] = ()
    table: Recording | None = None
