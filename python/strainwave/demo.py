"""The demonstration: gears from published measurements, and published experiments simulated with one of them.

The friction table and the drive are document P's, the torsion loop is document T's: two different gears of ratio 1:100, and so
two results. No publication known to us measures both on one gear.
"""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from strainwave import Drive, load
from strainwave.files.recording import Recording
from strainwave.friction import Coulomb
from strainwave.identification.identify import Identified, identify
from strainwave.report.experiment import Figure, SimulatedExperiment
from strainwave.simulation import scenario
from strainwave.simulation.run import simulate
from strainwave.simulation.scenario import Scenario
from strainwave.studies.position_control import TABLE_4

if TYPE_CHECKING:
    from strainwave.identification.candidates.position import TableReading

PUBLISHED = Path(__file__).with_name("published")

REMARK = (
    "Amplitudes, controller and the dry friction of the load are assumed, as document P gives none. The figures compare the "
    "response with the command; those of document P compare its simulation with measurements that were not published. They are "
    "shown to compare with, not as reproduced."
)
LABELS = ("Table 2 as all friction", "Table 2 as viscous part", "Table 2 as viscous part, output speeds")  # of the readings


def commands() -> dict[str, Scenario]:
    """The three experiments of document P: step, 1 Hz sine and pulse train of the output angle [rad]."""
    return {
        "step": scenario.step(amplitude=0.05, duration=2.0, start=0.1),
        "sine, 1 Hz": scenario.sine(amplitude=0.05, frequency=1.0, duration=3.0),
        "pulse train": scenario.pulse_train(amplitude=0.05, period=1.0, width=0.5, duration=3.0, start=0.1),
    }


def position_drive() -> Identified:
    """Return the gear of document P's drive from its Table 2, read as all friction (E-P7 has its other readings)."""
    title = "document P, Table 2 (measured), read as all friction; see E-P7 for its other readings"
    return identify("position-drive", {"friction": _titled("position-control-friction.csv", title)}, accept=True)


def torsion_rig() -> Identified:
    """Return the gear on document T's rig from its torsion loop."""
    loop = _titled("torsional-stiffness-loop.csv", "document T, Table 2, row 0° (points reconstructed, E-T4)")
    return identify(PUBLISHED / "torsional-stiffness.toml", {"torsion": loop}, accept=True)


def _titled(name: str, title: str) -> Recording:
    """Return a published table with the title by which results name it."""
    read = Recording.read(PUBLISHED / name)
    return Recording({each: read[each] for each in read.names}, read.units, title)


def experiments(found: Identified) -> list[SimulatedExperiment]:
    """Return document P's experiments with each reading of its Table 2, and with document P's own drive."""
    printed, ways = found.start.drive, dict(zip(LABELS, table_2(found), strict=True))
    drives = {
        label: printed.replace({"gear.friction_input": _law(way, printed.gear.friction_input)}) for label, way in ways.items()
    }
    drives["document P's drive, r = 1/100"] = printed
    contradicted = " ".join(
        f"{label} contradicts its other tables: {'; '.join(way.contradicts)}." for label, way in ways.items()
    )
    remark = f"{REMARK} Document P's Table 2 can be read in three ways (E-P6, E-P7). {contradicted}"
    pairs = zip(commands().items(), TABLE_4.values(), strict=True)
    return [_experiment(name, command, drives, published, remark) for (name, command), published in pairs]


def table_2(found: Identified) -> tuple[TableReading, ...]:
    """Return the three readings of document P's Table 2, compared with document P's average friction."""
    from strainwave.identification.candidates.position import readings
    from strainwave.identification.experiments.friction_table import FrictionTable

    fit = found.files[0].fit
    table = None if fit is None else fit.experiment
    assert isinstance(table, FrictionTable)
    law = load("position-drive-full-friction").gear.friction_input.replace(cosine=[], sine=[])
    return readings(table, law, reduction=abs(float(found.start.drive.gear.kinematics.ratio)))


def _law(way: TableReading, printed: Any) -> Coulomb:
    """Return the friction law of a reading; the excess of the static friction is document P's."""
    dry = way.coulomb.value + (printed.coulomb if way.part else 0.0)
    return Coulomb(coulomb=dry, breakaway=dry * printed.breakaway / printed.coulomb, viscous=way.viscous.value)


def _experiment(
    name: str, command: Scenario, drives: dict[str, Drive], table_4: tuple[float, float, float], remark: str
) -> SimulatedExperiment:
    runs = tuple((label, simulate(drive, command, sample=2e-3)) for label, drive in drives.items())
    figures = zip(*(_figures(run) for _, run in runs), strict=True)
    names = (("root mean square error", "rad"), ("largest error", "rad"), ("correlation coefficient", "1"))
    return SimulatedExperiment(
        name=name,
        remark=remark,
        runs=runs,
        figures=tuple(
            Figure(what, unit, values, published)
            for (what, unit), values, published in zip(names, figures, table_4, strict=True)
        ),
        source="document P, Table 4",
    )


def _figures(run: Recording) -> tuple[float, float, float]:
    error = run["output_angle"] - run["command"]
    correlation = np.corrcoef(run["output_angle"], run["command"])[0, 1]
    return float(np.sqrt(np.mean(error**2))), float(np.abs(error).max()), float(correlation)
