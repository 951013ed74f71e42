"""Files of a drawn joint whose names, units, counts and commands have traps: the reading is right, asked about, or wrong.

Angle, speed and effort are of the motor or of the joint, in a unit that the header states or does not. A commanded angle and a
commanded effort lie beside them, in any order of the columns. Only what a person knows of the file is given: ratio and torque
constant.
"""

from __future__ import annotations

import tempfile
from collections.abc import Mapping
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from strainwave.identification.identify import identify
from strainwave.identification.reading.mapping import FileMapping

from tests.evidence.drawn.joint import several_speeds, torque_of_input
from tests.evidence.drawn.outcome import Outcome, compared

Array = NDArray[np.float64]

STARTS = ("csg-14-50", "csg-14-100", "csg-17-100", "csg-20-100", "csg-25-100")
MAX_ERROR = 0.02  # relative, that counts as right: the quantisation of counts and the filter of a measured speed
ANGLES = {"rad": 1.0, "deg": np.pi / 180.0, "rev": 2.0 * np.pi}
SPEEDS = {"rad/s": 1.0, "deg/s": np.pi / 180.0, "rpm": np.pi / 30.0, "rev/s": 2.0 * np.pi}
SPEED_OF = {"rad": ("rad/s", "rpm"), "deg": ("deg/s", "rpm"), "rev": ("rev/s", "rpm")}  # usual beside each unit of an angle
ENDS = {"rad/s": "rad_s", "deg/s": "deg_s", "rpm": "rpm", "rev/s": "rps", "N.m": "Nm", "mN.m": "mNm"}  # of a name
TIMES = {"s": 1.0, "ms": 1e-3, "us": 1e-6}
WORDS = {  # by quantity: those of the motor, of the joint, and those without a side
    "angle": (("motor_position", "motor angle"), ("joint_position", "link_angle"), ("position", "pos", "angle")),
    "speed": (("motor_velocity", "motor speed"), ("joint_velocity", "link_speed"), ("velocity", "vel", "speed")),
    "torque": (("motor_torque",), ("joint_torque", "joint_effort"), ("torque", "tau_est", "effort")),
    "current": (("motor_current",), ("joint_current",), ("current", "iq", "effort")),
}
COMMANDS = {"angle": ("position_cmd", "target_position", "q_des"), "effort": ("tau_cal", "torque_setpoint", "effort_desired")}


def outcome(seed: int) -> Outcome:
    """Return the outcome of a file from the start set of its seed."""
    random = np.random.default_rng(seed)
    ratio, constant = float(random.choice([50.0, 80.0, 100.0, 101.0, 160.0])), float(random.uniform(0.03, 0.2))
    motion, level = several_speeds(random), float(np.exp(random.uniform(np.log(0.015), np.log(0.12))))
    fast = ratio * float(np.abs(motion.speed).max())
    viscous, gravity = level * float(random.uniform(0.3, 1.0)) / fast, float(random.uniform(5.0, 20.0))
    torque, _ = torque_of_input(
        motion, ratio, 3e-5, float(random.uniform(0.3, 1.5)), gravity, lambda w, load: level * np.sign(w) + viscous * w
    )
    torque += level * float(random.uniform(0.01, 0.05)) * random.standard_normal(len(torque))
    columns, what = _columns(random, motion.time, motion.angle, motion.speed, torque, ratio, constant)
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder, "log.csv")
        np.savetxt(path, np.stack(list(columns.values()), axis=1), "%.13g", ",", header=",".join(columns), comments="")
        try:
            found = identify(
                STARTS[seed % len(STARTS)],
                [path],
                mapping=FileMapping(constants={"ratio": ratio, "torque_constant": constant}),
            )
        except ValueError as asked:
            return Outcome("refused", f"{what}: {asked}")
    if found.failed:
        return Outcome("refused", f"{what}: {'; '.join(each.message for each in found.failed)}")
    truth = {
        "gear.friction_input.coulomb": level,
        "gear.friction_input.viscous": viscous,
        "load.gravity_torque": gravity,
    }
    known = [each for file in found.files for each in file.estimates if each.path in truth and each.state == "identified"]
    result = compared(((each.path, each.value, each.sigma, truth[each.path]) for each in known), floor=MAX_ERROR)
    return Outcome(result.verdict, f"{what}: {result.message}")


def _columns(
    random: np.random.Generator, time: Array, angle: Array, speed: Array, torque: Array, ratio: float, constant: float
) -> tuple[Mapping[str, Array], str]:
    """Return the columns of a file by their headers, in a random order but for the time, and what they are."""
    at_motor, is_current = bool(random.integers(2)), bool(random.integers(2))
    effort_at_motor = is_current or bool(random.integers(2))
    has_side, scale = random.random() < 0.5, ratio if at_motor else 1.0
    unit = str(random.choice(list(ANGLES)))
    noise = 1e-5 * random.standard_normal(len(time))
    own = [(_header(random, "angle", at_motor, has_side, unit), scale * (angle + noise) / ANGLES[unit])]
    if random.random() < 0.7:
        of_speed = str(random.choice(SPEED_OF[unit]))
        own.append((_header(random, "speed", at_motor, has_side, of_speed), scale * speed / SPEEDS[of_speed]))
    if is_current:
        of_effort = str(random.choice(["A", "mA"]))
        effort = torque / constant * (1.0 if of_effort == "A" else 1e3)
    else:
        of_effort = str(random.choice(["N.m", "mN.m"])) if effort_at_motor else "N.m"
        effort = torque * (1.0 if effort_at_motor else ratio) * (1.0 if of_effort == "N.m" else 1e3)
    quantity = "current" if is_current else "torque"
    own.append((_header(random, quantity, effort_at_motor, has_side, of_effort), effort))
    if random.random() < 0.5:
        own.append((str(random.choice(COMMANDS["angle"])), own[0][1] + 0.01 * float(np.ptp(own[0][1]))))
    if random.random() < 0.5 and not is_current:
        own.append((str(random.choice(COMMANDS["effort"])), 1.3 * effort))
    of_time = str(random.choice(list(TIMES)))
    start = 1.7e9 if random.random() < 0.2 and of_time == "s" else 0.0
    columns = {f"time [{of_time}]": start + time / TIMES[of_time]} if random.random() < 0.7 else {"time": time}
    columns |= {own[place][0]: own[place][1] for place in random.permutation(len(own))}
    return columns, f"{', '.join(columns)}; truth in {unit} at the {'motor' if at_motor else 'joint'}, {of_effort}"


def _header(random: np.random.Generator, quantity: str, at_motor: bool, has_side: bool, unit: str) -> str:
    """Return a name with its unit in brackets, at its end, or without one."""
    name = str(random.choice(WORDS[quantity][(0 if at_motor else 1) if has_side else 2]))
    form = random.integers(3)
    return f"{name} [{unit}]" if form == 0 else f"{name}_{ENDS.get(unit, unit)}" if form == 1 else name
