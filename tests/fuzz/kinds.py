"""The kinds of hostile input, and how often each is thrown."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from zlib import crc32

import numpy as np
from numpy.random import Generator

from tests.fuzz.calls import calls_case, scalars_case
from tests.fuzz.claims import claims_case
from tests.fuzz.datasheets import datasheets_case
from tests.fuzz.drives import drives_case
from tests.fuzz.formats import formats_case, pairs_case, recognised_case
from tests.fuzz.gear_files import name_case, toml_case
from tests.fuzz.images import images_case
from tests.fuzz.laws import Case
from tests.fuzz.mappings import mappings_case
from tests.fuzz.measurements import measurements_case
from tests.fuzz.rigs import rigs_case
from tests.fuzz.scenario_files import scenarios_case
from tests.fuzz.tables import csv_case, parquet_case
from tests.fuzz.unit_texts import units_case
from tests.fuzz.writers import files_case


@dataclass(frozen=True)
class Kind:
    """A kind of input.

    Args:
        make: draws a case, with files in the folder
        share: how many of it among all cases, relative to the others
        slowest: how long a case may take the processor [s]
        memory: how much address space a case may take [bytes]
    """

    make: Callable[[Generator, Path], Case]
    share: int
    slowest: float
    memory: int = 4 << 30


KINDS = {
    "csv": Kind(csv_case, 6, 2.0),
    "toml": Kind(toml_case, 5, 2.0),
    "scenarios": Kind(scenarios_case, 3, 2.0),
    "names": Kind(name_case, 1, 2.0),
    "parquet": Kind(parquet_case, 4, 2.0),
    "recognised": Kind(recognised_case, 5, 2.0),
    "pairs": Kind(pairs_case, 3, 2.0),
    "formats": Kind(formats_case, 2, 5.0),
    "claims": Kind(claims_case, 4, 10.0, 2 << 30),
    "images": Kind(images_case, 2, 5.0, 2 << 30),
    "mappings": Kind(mappings_case, 2, 2.0),
    "rigs": Kind(rigs_case, 2, 5.0, 2 << 30),
    "datasheets": Kind(datasheets_case, 2, 2.0),
    "units": Kind(units_case, 4, 0.5),
    "calls": Kind(calls_case, 12, 10.0),
    # The slowest of what runs drives is what all steps take that an adaptive run may take.
    "scalars": Kind(scalars_case, 12, 10.0),
    "drives": Kind(drives_case, 8, 10.0),
    "measurements": Kind(measurements_case, 1, 20.0),
    "files": Kind(files_case, 3, 2.0),
}

_CYCLE = [name for turn in range(max(kind.share for kind in KINDS.values())) for name in KINDS if turn < KINDS[name].share]


def kind_of(number: int) -> str:
    """The kind of a case, where all kinds are asked for."""
    return _CYCLE[number % len(_CYCLE)]


def drawn(kind: str, number: int, folder: Path) -> Case:
    """A case, the same on every machine."""
    return KINDS[kind].make(np.random.default_rng([number, crc32(kind.encode())]), folder)
