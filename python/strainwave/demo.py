"""The demonstration: a twin from published measurements, and published experiments simulated with it.

The friction table and the drive are document P's, the torsion loop is document T's: two different gears of ratio 1:100. No
publication known to us measures both on one gear, so the result shows the way, not a gear that exists.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

from strainwave import scenario
from strainwave.gear_set import GearSet
from strainwave.identify.measurement import read_measurement
from strainwave.identify.twin import Twin, twin
from strainwave.report.experiment import Experiment, Figure
from strainwave.scenario import Scenario
from strainwave.simulation import simulate

PUBLISHED = Path(__file__).with_name("published")

# Document P, Table 4: figures to compare with. It prints neither its amplitudes nor its raw measurements.
TABLE_4 = {
    "step": (0.0021, 0.0050, 0.995),
    "sine, 1 Hz": (0.0018, 0.0042, 0.997),
    "pulse train": (0.0015, 0.0038, 0.998),
}
COMMANDS: dict[str, Scenario] = {
    "step": scenario.step(amplitude=0.05, duration=2.0, start=0.1),
    "sine, 1 Hz": scenario.sine(amplitude=0.05, frequency=1.0, duration=3.0),
    "pulse train": scenario.pulse_train(amplitude=0.05, period=1.0, width=0.5, duration=3.0, start=0.1),
}


def published_twin(progress: Callable[[str], None] = lambda stage: None) -> Twin:
    """The twin of document P's drive from document P's Table 2 and document T's torsion loop."""
    return twin(
        GearSet.read(PUBLISHED / "position-control.toml"),
        friction=read_measurement("friction", PUBLISHED / "position-control-friction.csv"),
        torsion=read_measurement("torsion", PUBLISHED / "torsional-stiffness-loop.csv"),
        sources={"friction": "document P, Table 2 (measured)", "torsion": "document T, Table 2, row 0°"},
        progress=progress,
    )
