"""Files that name the columns of others, and options of the command line, not as they should be."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from numpy.random import Generator
from strainwave.commands.file_options import FileOptions
from strainwave.identification.reading.mapping import CONSTANTS
from strainwave.identification.reading.recognise import Recognised, recognise
from strainwave.identification.reading.source import measurement_files

from tests.fuzz.laws import Case, described, finite
from tests.fuzz.mutation import NUMBERS, encoded, mutated, picked

TEXT = """side = "output"
joint = "1"
[columns]
input_angle = "motor"
current = 3
[units]
input_angle = "rad"
current = "A"
[sign]
current = -1
[constants]
rate = "0.1 kHz"
ratio = 100.0
torque_constant = 0.1
motor_inertia = 1e-4
["*.csv"]
kind = "log"
constants.load_inertia = 0.85
"""
WORDS = (
    "[columns]", "[units]", "[sign]", "[constants]", '["[a"]', '["*"]', 'kind = "friction"', 'kind = "presliding"', "kind = 5",
    'side = "x"', "rate = inf", "rate = -5", "rate = 0", "ratio = 0", "ratio = 5e-324", "ratio = 1e308", "temperature = -300",
    "joint = 1", "joint = []", "columns = 5", "1e400", "9" * 400, "9" * 5000,
    '"٣"', '"a\\nb"', '"١٢ Hz"', '"5 furlong"', "[" * 2000,
)  # fmt: skip
VALUES = (*NUMBERS, "0", "-1", "1e300", "5e-324", "100", "0.1", "75 mN.m/A", "1 furlong", "1e-9")


def mappings_case(random: Generator, folder: Path) -> Case:
    """A log and what a person gives with it: a file, or options."""
    rows = np.column_stack([np.arange(40) * 0.01, np.sin(np.arange(40) * 0.3), np.cos(np.arange(40) * 0.3)])
    log, path = folder / "log.csv", folder / "columns.toml"
    log.write_text("time [s],motor,i\n" + "\n".join(",".join(f"{value:.6g}" for value in row) for row in rows))
    data = encoded(mutated(TEXT, random, WORDS), random)
    path.write_bytes(data)
    constants = [f"{picked(random, tuple(CONSTANTS))}={picked(random, VALUES)}"] if random.random() < 0.5 else []

    def attempt() -> Recognised:
        given = FileOptions(path, constant=constants).mapping_of(measurement_files([log]).files)
        return recognise(log, given(log))

    def check(found: Recognised) -> None:
        assert finite(found.recording), "a number that is not finite"
        assert finite(list(found.constants.values())), "a constant that is not finite"

    return Case(f"{constants} {described(data, 2000)}", attempt, check)
