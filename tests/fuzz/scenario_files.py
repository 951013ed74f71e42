"""Scenario files that are not as they should be."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import strainwave as sw
from numpy.random import Generator

from tests.fuzz.laws import Case, described
from tests.fuzz.mutation import encoded, mutated, picked
from tests.support.scenarios import RAMP_AND_SINE, TURNED

UNDER_CONTROL = sw.Drive(control=sw.control.PID(proportional=1.0), load=sw.loads.Inertia(inertia=0.05))
OPEN_LOOP = sw.Drive(load=sw.loads.Prescribed())
SCENARIOS = (
    (
        RAMP_AND_SINE.replace("2000", "20")
        + """[load_torque]
kind = "table"
time = [0.0, 0.01, 0.02]
value = { value = [0.0, 5.0, 5.0], unit = "N.m" }
"""
        + TURNED,
        UNDER_CONTROL,
    ),
    (
        """duration = 0.02
command = { value = 12.0, unit = "V" }
[[output_angle]]
kind = "pulse_train"
amplitude = 0.1
period = 0.01
width = 0.002
[[output_angle]]
kind = "chirp"
amplitude = 0.1
start_frequency = 1.0
stop_frequency = 50.0
""",
        OPEN_LOOP,
    ),
    (
        """duration = 0.02
[command]
kind = "pieces"
start = [0.0, 0.01]
level = [0.0, 1.0]
slope = [1.0, 0.0]
wave_amplitude = [0.1]
wave_frequency = [3.0]
wave_sweep = [1.0]
wave_phase = [0.5]
""",
        OPEN_LOOP,
    ),
)
WORDS = (
    "[command]", "[[command]]", "[initial]", "[load_torque]", "[[temperature]]", "command = 1.0", "command = []",
    'kind = "step"', 'kind = "table"', "kind = 5", "kind = []", "value = nan", "amplitude = 1e400", "amplitude = []",
    "amplitude = { value = 1.0 }", 'unit = "furlong"', 'unit = "V"', "unit = 1", "duration = 0", "duration = 1e-30",
    "start = -1", "period = 1e-30", "rate = 1e308", "frequency = 1e300", "input_angle = 1.0", "x = 1979-05-27T07:32:00Z",
    "note = '''", 'name = "a\\nb"', '{ value = 1.0, unit = "rad" }', "command = {}", "[" * 2000, "{a=" * 500,
)  # fmt: skip


def scenarios_case(random: Generator, folder: Path) -> Case:
    """A scenario read for a drive; what is accepted must be the same when it has been saved."""
    path = folder / "scenario.toml"
    text, drive = picked(random, SCENARIOS)
    data = encoded(mutated(text, random, WORDS), random)
    path.write_bytes(data)

    def check(given: sw.simulation.ScenarioFile) -> None:
        again = folder / "again.toml"
        given.save(again, drive)
        assert sw.simulation.ScenarioFile.read(again, drive) == given, "a file holds the scenario otherwise"
        assert np.isfinite(given.command.value([0.0, given.command.duration])).all(), "a command that is not finite"

    return Case(described(data, 2000), lambda: sw.simulation.ScenarioFile.read(path, drive), check)
