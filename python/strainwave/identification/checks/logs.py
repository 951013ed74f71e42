"""Checks of a log of a drive: its error on held-out data, and numbers that it determines in two ways."""

from __future__ import annotations

from collections.abc import Collection, Iterator

import numpy as np
from numpy.typing import NDArray

from strainwave import Drive
from strainwave.files.recording import Recording
from strainwave.files.units import convert, measures
from strainwave.identification.reading.names import words_of
from strainwave.identification.reading.recognise import Recognised
from strainwave.identification.reading.slopes import speed_per_slope
from strainwave.identification.results.check import Check
from strainwave.identification.results.held_out import MAX_UNEXPLAINED, HeldOut
from strainwave.messages import as_option, listed
from strainwave.orders.shaft_pair import Ratio
from strainwave.questions import NUMBER
from strainwave.statistics.linear_fit import solved

Array = NDArray[np.float64]

RATIO_OF_ENCODERS = "ratio of two encoders"  # names of checks
CONSTANT_BY_VOLTAGE = "torque constant by the voltage"
INERTIA_IN_TWO_WAYS = "inertia of the load in two ways"
FRICTION_BIAS = 0.02  # of an inertia by the torque of a motor: what a law of friction lacks goes into it (assumed)
MIN_RATIO_SIGMA = 3.0  # standard deviations beyond which a measured ratio is another one
MIN_RATIO_DIFFERENCE = 5e-3  # relative: orders of the gear move two encoders by less
MAX_CONSTANT_DIFFERENCE = 0.1  # relative, of a torque constant by the voltage: a resistance changes as much as a motor warms up
MAX_CONSTANT_SIGMA = 0.03  # relative: a voltage that determines the constant less well is no check of it
MAX_INERTIA_SIGMA = 3.0  # standard deviations between the inertias of a load by its winding up and by the torque of the motor
OBJECT_OF_CIA_402 = {"torque", "actual", "value"}  # words of the name of object 0x6077
MAX_SHARE_OF_WHOLE = 0.99  # of the rows of a torque that is measured in its unit
MAX_OFF_WHOLE = 1e-6  # difference from a whole number [1]
MAX_SPEED_FACTOR = 2.45  # between a speed and the slope of its angle: the nearest units, rpm and deg/s, lie a factor of 6 apart
MAX_FILTERED_FACTOR = 1.5  # likewise: filters and noise change it by less
USUAL_UNITS = {"speed": ("rad/s", "deg/s", "rpm", "rev/s"), "angle": ("rad", "deg", "rev")}
MAX_OFF_UNIT = 0.1  # relative: a unit that is nearer explains a factor
RECORD_BLOCKS = 10  # over which residuals of the voltage scatter


def held_out_error(held_out: HeldOut, source: str, joints: Collection[str] = ()) -> Iterator[Check]:
    """Yield the checks that a model predicts data held out, and no worse than plain least squares.

    Args:
        held_out: the error
        source: name of the file
        joints: names of other joints whose motion or torque is given
    """
    others = "other joints may move (give their angles as other_angles, or their torque as rigid_torque)"
    if joints:
        others = f"the motion of joints {listed(joints)} is known, but the record may be too short for the torque that they add"
    unit = held_out.unit
    yield Check(
        "unexplained on held-out data", source, held_out.error, MAX_UNEXPLAINED * held_out.zero, unit,
        held_out.relative > MAX_UNEXPLAINED,
        f"the RMS error of {held_out.channel} on the {held_out.stretch} is {held_out.words}: more than half is unexplained",
        f"{others}; the motion may be too small or at one speed only, or columns, units or sides are not what they are "
        "taken for",
    )  # fmt: skip
    if np.isfinite(held_out.plain):
        limit = held_out.max_share_of_plain
        yield Check(
            "plain least squares", source, held_out.error, limit * held_out.plain, unit, held_out.share_of_plain > limit,
            f"plain least squares leaves {held_out.plain:.3g} {unit} on the {held_out.stretch}, the model {held_out.error:.3g}",
            "record longer, or see whether columns, units and sides are right: what the model has beyond plain least squares "
            "does not predict this record",
        )  # fmt: skip


def unit_of_torque(file: Recognised) -> Iterator[Check]:
    """Yield the check that a torque whose unit a person gave is not what CiA 402 counts in thousandths of a rated value.

    Drives of this profile record objects named as `Torque actual value` in whole thousandths, without a unit. No other number
    of a record separates a unit of torque from another one: inertia, gravity and friction all grow with it.
    """
    for name in ("input_torque", "joint_torque"):
        unit = file.units.get(name, "")
        is_object = set(words_of(file.columns.get(name, ""))).issuperset(OBJECT_OF_CIA_402)
        if name not in file.units_given or not is_object or " of " in unit:  # a share of a rated value
            continue
        raw = file.recording.values(name, unit)
        share = float(np.mean(np.abs(raw - np.round(raw)) < MAX_OFF_WHOLE))
        yield Check(
            "unit of the torque", file.path.name, share, MAX_SHARE_OF_WHOLE, "1", share > MAX_SHARE_OF_WHOLE,
            f"{file.columns[name]} contains whole numbers and is the name of CiA 402 for thousandths of the rated torque, but "
            f"{unit} is taken",
            "give the rated torque of the motor, as " + as_option("unit", file.columns[name], f"permille of {NUMBER} N.m"),
        )  # fmt: skip


def speed_against_angle(file: Recognised) -> Iterator[Check]:
    """Yield the check that a speed is the slope of the angle of the same shaft, in the units that both are taken in."""
    for factor, speed, names in _speed_factors(file):
        sizes = {"speed": _own_size(file, speed) / factor, "angle": _own_size(file, speed.replace("speed", "angle")) * factor}
        fitting = [
            as_option("unit", name, unit)
            for quantity, name in zip(("angle", "speed"), names, strict=True)
            for unit in USUAL_UNITS[quantity]
            if abs(sizes[quantity] / convert(1.0, unit, USUAL_UNITS[quantity][0]) - 1.0) < MAX_OFF_UNIT
        ]
        off = max(factor, 1.0 / factor)
        yield Check(
            "speed against angle", file.path.name, off, MAX_SPEED_FACTOR, "1", off > MAX_SPEED_FACTOR,
            f"{names[1]} is {factor:.4g} times the slope of {names[0]}, in the units that they are taken in",
            f"one unit is wrong: {' or '.join(fitting) or 'no usual one makes this factor; see whether the time is right'}",
        )  # fmt: skip


def speed_of_another_clock(file: Recognised) -> Iterator[str]:
    """Yield a remark on a speed that is not the slope of its angle, by a factor that no unit makes."""
    for factor, _, names in _speed_factors(file):
        if MAX_FILTERED_FACTOR < max(factor, 1.0 / factor) <= MAX_SPEED_FACTOR:
            yield (
                f"{names[1]} is {factor:.4g} times the slope of {names[0]}, which no unit makes: the clock may be wrong by "
                "this factor, and with it viscous friction and inertia; see whether the time is right"
            )


def _speed_factors(file: Recognised) -> Iterator[tuple[float, str, list[str]]]:
    """Yield each speed over the slope of its angle, its channel, and the names of the columns of angle and speed."""
    record = file.recording
    for angle in set(record.names) & {"input_angle", "output_angle"}:
        speed = angle.replace("angle", "speed")
        if speed not in record.names or "time" not in record.names:
            continue
        if factor := abs(speed_per_slope(record[angle], record[speed], record.time)):
            names = [file.columns.get(each) or file.columns.get(f"reflected_{each[-5:]}", each) for each in (angle, speed)]
            yield factor, speed, names


def _own_size(file: Recognised, channel: str) -> float:
    """Return the size of the unit of an angle [rad] or a speed [rad/s]."""
    si = USUAL_UNITS[channel[-5:]][0]
    unit = file.units.get(channel) or file.units.get(f"reflected_{channel[-5:]}", si)
    return convert(1.0, unit, si) if measures(unit, si) else 1.0


def ratio_of_encoders(ratio: Ratio, drive: Drive, source: str) -> Iterator[Check]:
    """Yield the check that the ratio of two measured angles is that of the gear."""
    if ratio.in_joint_units:
        return
    expected = abs(drive.gear.kinematics.ratio)
    off, limit = abs(abs(ratio.value) - expected), max(MIN_RATIO_SIGMA * ratio.sigma, MIN_RATIO_DIFFERENCE * expected)
    yield Check(
        RATIO_OF_ENCODERS, source, off, limit, "1", off > limit,
        f"the angles of input and output have the ratio {abs(ratio.value):.5g} ± {ratio.sigma:.2g}, the gear {expected:.6g}",
        f"if the ratio of the gear is that of the angles, give --constant ratio={abs(ratio.used):.6g}; a belt or pulley before "
        "the gear is part of it; else see whether both angles are in the units they are taken for",
    )  # fmt: skip


def torque_constant_by_voltage(recording: Recording, speed: Array, constant: float, source: str) -> Iterator[Check]:
    """Yield the check that a torque constant agrees with the voltage that the motor induces: u = R i + K w + u_0.

    Args:
        recording: with voltage and current
        speed: of the motor at each row [rad/s], shape (n,)
        constant: torque constant [N.m/A], which is the voltage per speed of the same motor in SI units
        source: name of the file
    """
    if not {"voltage", "current"} <= set(recording.names):
        return
    columns = np.stack([recording["current"], speed, np.ones_like(speed)], axis=1)
    if not columns.any(axis=0).all():
        return
    found = solved(columns, recording["voltage"])
    left = recording["voltage"] - columns @ found
    scores = [float(np.mean(each)) for each in np.array_split(left * speed, RECORD_BLOCKS)]
    sigma = float(np.std(scores, ddof=1)) * len(left) / np.sqrt(RECORD_BLOCKS) / float(speed @ speed)
    induced = float(found[1])
    if not sigma < MAX_CONSTANT_SIGMA * abs(induced):
        return
    off = abs(abs(induced) / constant - 1.0)
    yield Check(
        CONSTANT_BY_VOLTAGE, source, off, MAX_CONSTANT_DIFFERENCE, "1", off > MAX_CONSTANT_DIFFERENCE,
        f"the motor induces {abs(induced):.4g} ± {sigma:.1g} V·s/rad, which is its torque constant in N·m/A, but "
        f"{constant:.4g} N·m/A is taken",
        f"give --constant torque_constant={abs(induced):.4g} if voltage and current are those of a DC motor or of one phase "
        "in the rotating frame; else see the data sheet",
    )  # fmt: skip


def inertias_of_load(by_spring: tuple[float, float], by_torque: tuple[float, float], unit: str, source: str) -> Check:
    """Return the check that a load has the same inertia by how it winds the gear up and by the torque of the motor.

    Args:
        by_spring, by_torque: the inertia and its standard deviation, in `unit`
        unit: of both
        source: name of the file
    """
    (one, of_one), (other, of_noise) = by_spring, by_torque
    of_other = float(np.hypot(of_noise, FRICTION_BIAS * other))
    apart = abs(one - other) / max(float(np.hypot(of_one, of_other)), 1e-300)
    return Check(
        INERTIA_IN_TWO_WAYS, source, apart, MAX_INERTIA_SIGMA, "1", apart > MAX_INERTIA_SIGMA,
        f"the load has an inertia of {one:.3g} ± {of_one:.1g} {unit} by how it winds the gear up, and {other:.3g} ± "
        f"{of_other:.1g} by the torque of the motor: {apart:.2g} standard deviations apart",
        "see whether torque constant, ratio, motor_inertia and the side of the torque are right",
    )  # fmt: skip
