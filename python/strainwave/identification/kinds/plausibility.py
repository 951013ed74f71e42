"""What speaks against a file as it was taken, where the fit alone shows nothing of it: limits, levels, sizes, other formats."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from strainwave.files.recording import Recording

Array = NDArray[np.float64]

NONE = 1e-3  # of the friction of the set: a torque that shows less is none that the motor gives
APART = 10.0  # gears of one kind differ by less in friction
FLAT = 0.05  # of the path: a torque that stays at its end for longer is clipped
SAMPLES = 5  # of such an end, at least
FASTEST = 1600.0  # rad/s, 15 000 1/min: makers allow 14 000 1/min to the smallest gears, and less to others
EQUAL = 1e-9  # relative: torques that are one
BEGINNINGS = {
    b"\x89PNG": "a picture (PNG)", b"\xff\xd8\xff": "a picture (JPEG)", b"GIF8": "a picture (GIF)", b"BM": "a picture (BMP)",
    b"%PDF": "a PDF document", b"PK\x03\x04": "a ZIP archive, as spreadsheets are", b"\x1f\x8b": "packed (gzip)",
    b"\xd0\xcf\x11\xe0": "an old Excel or Word file", b"<!DOCTYPE": "a web page", b"<html": "a web page",
}  # fmt: skip
BEGIN = 2048  # letters that are looked at
TEXTS = (".csv", ".txt", ".tsv", ".log", ".dat")


def other_format(path: Path) -> str | None:
    """What a file that is called a table is by its first letters, and what to do; None where it may be a table."""
    if path.suffix.lower() not in TEXTS or not path.is_file():
        return None
    with path.open("rb") as file:
        begin = file.read(BEGIN)
    if separator := _other_separator(begin):
        return f'its columns are separated by "{separator}": separate them by commas, semicolons or tabs'
    found = next((what for letters, what in BEGINNINGS.items() if begin.startswith(letters)), None)
    what = f"its name says {path.suffix}, but it is {found}"
    return None if found is None else f"{what}: export the measurement as CSV with one header line"


def _other_separator(begin: bytes) -> str | None:
    """A separator of columns that tables are not read with, if two lines in a row have it equally often, and no other one."""
    lines = [line for line in begin.decode("utf-8", "ignore").splitlines() if line.strip() and not line.startswith("#")][:2]
    if len(lines) < 2 or any(each in line for line in lines for each in ",;\t"):
        return None
    return next((each for each in "|:^~" if lines[0].count(each) == lines[1].count(each) > 0), None)


def clipped_loop(recording: Recording) -> str | None:
    """That the torque of a loop stays at the end of its range while the twist goes on, and what to do; None if it does not."""
    angle, torque = ("twist", "torque") if "twist" in recording else ("input_angle", "input_torque")
    path, values = recording[angle], recording[torque]
    for end in (values.max(), values.min()):
        at_end = np.concatenate([[False], np.abs(values - end) <= EQUAL * abs(end), [False]])
        for first, last in np.flatnonzero(np.diff(at_end.astype(int))).reshape(-1, 2):
            if last - first >= SAMPLES and np.ptp(path[first:last]) > FLAT * np.ptp(path) > 0.0:
                return (
                    f"{torque} stays at {end:.4g} {recording.unit(torque)} for {last - first} samples while {angle} goes on by "
                    f"{100.0 * np.ptp(path[first:last]) / np.ptp(path):.0f} % of its range: the sensor or the amplifier is at "
                    "its limit. Record with a larger range, or twist less far"
                )
    return None


def of_levels(table: Recording) -> Iterator[str]:
    """What to know of the torques of a friction table."""
    speed, torque = table["speed"], np.abs(table["torque"])
    if len(torque) > 1 and np.ptp(torque) <= 1e-6 * torque.max():
        yield "all its torques are of one size: a limit or a set value is no measurement"
    if (speed > 0.0).all() or (speed < 0.0).all():
        yield "it holds one direction only: a zero error of the torque is counted as Coulomb friction; measure both"


def too_fast(speed: Array) -> str | None:
    """That an input seems to turn faster than any gear of this kind may; None if it does not."""
    fastest = float(np.quantile(np.abs(speed), 0.99))
    if fastest <= FASTEST:
        return None
    return (
        f"its input would turn at {fastest:.4g} rad/s, {fastest * 30.0 / np.pi:.0f} 1/min, faster than strain wave gears may: "
        "speeds may be in 1/min, not in rad/s, or angles in degrees; see whether units, side and ratio are right"
    )


def unlike_set(law: Any, known: Any, speeds: Array, effort: str) -> str | None:
    """That the friction of a log is of another size than that of the set it starts from; None where it is not.

    Args:
        law: friction found
        known: friction of the set
        speeds: of the input while it was measured [rad/s]
        effort: what told the torque
    """
    speed = float(np.median(np.abs(speeds[speeds != 0.0]))) if np.any(speeds != 0.0) else 0.0
    if speed <= 0.0:
        return None
    found, before = law.steady(speed), known.steady(speed)
    if before > 0.0 and effort == "joint_torque" and found < NONE * before:
        return (
            "its torque shows no friction, as that of a sensor behind the gear: friction is told by what the motor gives, its "
            "current with --column current=NAME, or its torque"
        )
    if before <= 0.0 or not found > 0.0 or 1.0 / APART < found / before < APART:
        return None
    factor = found / before
    unit = {"current": "mA and A", "voltage": "mV and V"}.get(effort, "mN·m and N·m")
    mistake = f"a factor of 1000 lies between {unit}; " if abs(abs(np.log(factor)) - np.log(1000.0)) < np.log(4.0) else ""
    return (
        f"its friction is {found:.3g} N·m at {speed:.3g} rad/s of the input, {factor:.3g} times that of the initial set "
        f"({before:.3g} N·m): {mistake}see whether units, side, ratio and torque constant are right, or start from a set like "
        "this gear"
    )
