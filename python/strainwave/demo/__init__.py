"""The demonstration: a joint of a robot from its log, and two gears from published measurements.

The log is that of a joint simulated by a program that shares nothing with this package. The friction table is the position
control article's, the torsion loop is the torsional stiffness article's: two different gears of ratio 1:100. No publication
known to us measures both on one gear.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from strainwave.files.recording import Recording
from strainwave.identification.identify import Identified, identify
from strainwave.identification.reading.mapping import FileMapping

ROBOT_LOG = Path(__file__).with_name("robot_log.csv")
TORQUE_CONSTANT = 0.0755  # N.m/A, of the motor of the joint
PUBLISHED = Path(__file__).parents[1] / "published"


def robot_joint() -> Identified:
    """Return the joint of a robot from its log: time, angle, speed and motor current."""
    mapping = FileMapping(constants={"torque_constant": TORQUE_CONSTANT})
    return identify("hfuc-20-80", [ROBOT_LOG], mapping=mapping, name="joint of a robot")


def torsion_rig() -> Identified:
    """Return the gear of the torsional stiffness article from the loop of its Table 2 (its erratum 4)."""
    loop = _titled("torsional-stiffness-loop.csv", "torsional stiffness article, Table 2, at 0°")
    return identify(PUBLISHED / "torsional-stiffness.toml", {"torsion": loop}, accept=True)


def position_drive() -> Identified:
    """Return the gear of the position control article's drive from its Table 2, read as all friction (its erratum 7)."""
    table = _titled("position-control-friction.csv", "position control article, Table 2, as friction")
    return identify("position-drive", {"friction": table}, accept=True)


def _titled(name: str, title: str) -> Recording:
    """Return a published table with the title by which results name it."""
    read = Recording.read(PUBLISHED / name)
    return Recording({each: read[each] for each in read.names}, read.units, title)


@dataclass(frozen=True)
class Demonstration:
    """A gear that is identified to show how.

    Attributes:
        heading: what is measured, and where
        files: that the identification reads
        identified: returns the result
        remark: what a reader should know of it; empty if there is nothing
    """

    heading: str
    files: tuple[Path, ...]
    identified: Callable[[], Identified]
    remark: str = ""


DEMONSTRATIONS = {
    "robot-joint": Demonstration(
        "A joint of a robot, simulated by an independent program: 30 s of time, joint angle, speed and motor current",
        (ROBOT_LOG,),
        robot_joint,
    ),
    "torsion-rig": Demonstration(
        'A torsion loop, from the figures of "Harmonic Drive Torsional Stiffness: Measurement and Hysteresis Analysis"',
        (PUBLISHED / "torsional-stiffness.toml", PUBLISHED / "torsional-stiffness-loop.csv"),
        torsion_rig,
    ),
    "position-drive": Demonstration(
        'A friction table, from "Analysis of a Mathematical Model for Precise Position Control in Strain Wave Gears"',
        (PUBLISHED / "position-control-friction.csv",),
        position_drive,
        "The failed check is meant: this table contradicts the friction in the other tables of its article. Of your own "
        "measurements identify would write no gear.",
    ),
}
