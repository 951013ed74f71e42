"""Files of the tutorials, from a joint of another program: `python -m tests.evidence.tutorial_joint examples/tutorials`.

The joint shares nothing with this package (STRAINWAVE_RIG is the folder of its program). Its current is recorded as the mean
over the period of the log, as a drive with an averaging current sensor gives it.
"""

from __future__ import annotations

import re
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from tests.evidence.rig import RIG
from tests.support.cplusplus import compiler

Array = NDArray[np.float64]
STEP = 5  # rows of the program, 2 ms each, in a row of a log
COUNT = 2.0 * np.pi / 2**19  # rad, of the link encoder
ANGLE_NOISE, SPEED_NOISE, CURRENT_NOISE = 1e-5, 0.02, 0.06  # rad, rad/s, A
WORN = {"Fc": 0.0611, "Fs": 0.0806}  # N.m, 1.3 times those of the program
TOOL = {"Jl": 1.1, "gravity": 16.0}  # kg.m2, N.m: 0.85 and 11 without the tool
TABLE_SPEEDS = np.array([5.0, 10.0, 20.0, 30.0, 50.0, 100.0, 200.0, 400.0, 800.0, 1200.0, 1800.0, 2500.0, 3000.0])  # 1/min


def simulated(folder: Path, words: dict[str, float]) -> Array:
    """Return the rows of the program, with the current as the mean since the row before."""
    source = (RIG / "joint.c").read_text()
    for pattern, text in (
        (r"for\(long k=0;k<n;k\+\+\)\{", "double mean=0; for(long k=0;k<n;k++){"),
        (r"if\(k%400==0\) printf\((.*),t,u,i,(.*);\n", r"mean+=i/400; if(k%400==0){ printf(\1,t,u,mean,\2; mean=0; }\n"),
    ):
        source, changed = re.subn(pattern, text, source)
        assert changed == 1, pattern
    (folder / "joint.c").write_text(source)
    subprocess.run([*compiler("gcc"), "-O2", "joint.c", "-lm", "-o", "joint"], cwd=folder, check=True)
    given = [f"{name}={value}" for name, value in words.items()]
    printed = subprocess.run([folder / "joint", *given], check=True, capture_output=True, text=True).stdout
    return np.loadtxt(printed.splitlines())


def write_log(path: Path, seed: int, start: float, duration: float = 30.0, **words: float) -> None:
    """Write a log of the joint from a time of the program on [s], as a controller of a robot records it at 100 Hz."""
    random = np.random.default_rng(seed)
    with tempfile.TemporaryDirectory() as name:
        time, _, current, _, _, angle, speed, _, _ = simulated(Path(name), words | {"end": start + duration}).T
    averaged = np.convolve(current, np.ones(STEP) / STEP)[: len(time)]
    rows = np.flatnonzero(time >= start - 1e-9)[::STEP]
    noise = random.standard_normal((3, len(rows)))
    columns = (
        time[rows] - start,
        np.round((angle[rows] + ANGLE_NOISE * noise[0]) / COUNT) * COUNT,
        speed[rows] + SPEED_NOISE * noise[1],
        -averaged[rows] + CURRENT_NOISE * noise[2],  # in the sense of the output
    )
    form = ["%.2f", "%.6f", "%.3f", "%.3f"]
    header = "t [s],q [rad],qd [rad/s],current [A]"
    np.savetxt(path, np.column_stack(columns), fmt=form, delimiter=",", header=header, comments="")


def write_table(path: Path, header: str, seed: int, coulomb: float, breakaway: float, viscous: float) -> None:
    """Write a table of the friction at the input in N.m over the speed in 1/min, in both directions."""
    random = np.random.default_rng(seed)
    speed = TABLE_SPEEDS * np.pi / 30.0
    torque = coulomb + (breakaway - coulomb) * np.exp(-((speed / 3.0) ** 2)) + viscous * speed
    both = np.concatenate((-torque[::-1], torque))
    both = both * (1.0 + 0.01 * random.standard_normal(len(both))) + 1e-3 * random.standard_normal(len(both))
    columns = np.column_stack((np.concatenate((-TABLE_SPEEDS[::-1], TABLE_SPEEDS)), both))
    np.savetxt(path, columns, fmt=["%.0f", "%.4f"], delimiter=",", header=header, comments="")


def main(folder: Path) -> None:
    write_log(folder / "robot_log.csv", 1, 1.3)
    write_log(folder / "robot_log_later.csv", 2, 5.0, duration=20.0, amplitude=0.6)
    write_log(folder / "robot_log_worn.csv", 3, 9.0, duration=20.0, **WORN)
    write_log(folder / "robot_log_tool.csv", 4, 9.0, duration=20.0, **TOOL)
    write_table(folder / "friction.csv", "speed [1/min],torque [N.m]", 5, 0.047, 0.062, 2.9e-4)
    write_table(folder / "friction_other_joint.csv", "speed [1/min],torque [N.m]", 6, 0.12, 0.155, 6e-4)


if __name__ == "__main__":
    main(Path(sys.argv[1]))
