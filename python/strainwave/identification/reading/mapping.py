"""What a person says of a file: which column is which, in which unit, and what the file does not hold."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from strainwave.identification.reading.channels import Kind
from strainwave.identification.reading.names import Side


@dataclass(frozen=True)
class FileMapping:
    """What a person says of a file; what is not said is found out, or asked for.

    Args:
        columns: for each channel the name or the number of its column in the file
        units: unit of each channel whose header states none
        signs: 1 or -1 for each channel that counts the other way
        constants: numbers that belong to the recording: `rate` [Hz] of rows without time, `ratio`, `torque_constant` …
        kind: what the file is, where it cannot be told
        side: where a friction table was measured, or the channels of a log whose names say no side
        joint: number or name of the joint to take of several
    """

    columns: Mapping[str, str] = field(default_factory=dict)
    units: Mapping[str, str] = field(default_factory=dict)
    signs: Mapping[str, int] = field(default_factory=dict)
    constants: Mapping[str, float] = field(default_factory=dict)
    kind: Kind | None = None
    side: Side | None = None
    joint: str | None = None
