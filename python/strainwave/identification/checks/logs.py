"""Checks of a log of a drive: its error on data held out, numbers that it determines in two ways, and the motion itself."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping

import numpy as np
from numpy.typing import NDArray

from strainwave import Drive
from strainwave.files.recording import Recording
from strainwave.files.units import convert, measures
from strainwave.identification.candidates.motion_candidate import MotionCandidate
from strainwave.identification.candidates.plain import fit_plain, moving
from strainwave.identification.checks.comparisons import repeatability
from strainwave.identification.checks.sizes import MISTAKEN_UNITS
from strainwave.identification.experiments.motion_log import MotionLog, late, per_torque
from strainwave.identification.fitting.unknowns import Estimate
from strainwave.identification.reading.motion import MIN_EXPLAINED, speed_per_slope
from strainwave.identification.reading.names import words_of
from strainwave.identification.reading.recognise import Recognised
from strainwave.identification.reading.units import MAX_JOINT_ANGLE
from strainwave.identification.results.combined_parameter import MAX_DISTANCE
from strainwave.identification.results.file_result import MAX_RELATIVE_SIGMA, MAX_UNEXPLAINED, Check, HeldOut, is_uncertain
from strainwave.messages import as_option, listed
from strainwave.orders.comb import STRAIN_WAVE_RATIOS
from strainwave.orders.shaft_pair import Ratio
from strainwave.orders.torque_ripple import ripple
from strainwave.questions import NUMBER
from strainwave.statistics.linear_fit import solved
from strainwave.statistics.scale import MIN_READING_GAIN_SIGMA, sigmas_of_gain

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
MAX_RATIO_FACTOR = (
    1.15  # between a ratio by motions of both shafts and that of the gear without a remark: catalogues step by 1.2
)
MAX_SWING_ON_SPRING = 2.0  # of a load over that of its motor, at .7 of its antiresonance; a larger factor is no swing
USUAL_UNITS = {"speed": ("rad/s", "deg/s", "rpm", "rev/s"), "angle": ("rad", "deg", "rev")}
MAX_OFF_UNIT = 0.1  # relative: a unit that is nearer explains a factor
VOLTAGE_BLOCKS = 10  # over which residuals of the voltage scatter
RATIO_BY_ORDERS = "ratio by orders"  # name of the check
STANDARD_GRAVITY = 9.81  # m/s2
MAX_OF_ANOTHER_UNIT = 1.5  # times what the fit leaves with the angle in another unit or of the other side
MAX_RATIO_DIFFERENCE = 0.15  # of its logarithm, by gravity: the ratios of a family of gears, as 100 and 120, differ by more
RATIOS_TRIED = np.linspace(-np.log(2.0), np.log(2.0), 31)  # logarithms of the true angle over the one taken
RIPPLE_COLUMNS = ("current", "motor_torque", "torque")  # in which the ripple of the wave generator is looked for
MAX_ROWS_OF_RIPPLE = 2**14
MIN_ROWS_PER_PERIOD = 4.0  # of the main line of a gear of the largest ratio
MIN_GRAVITY_SIGMA = 2.0  # standard deviations, beyond which gravity is determined
MOTION_BLOCKS = 10  # of the motion
MOVED_BY_OTHERS = ("load.", "gear.friction_mesh.")  # numbers of a load, and of a loss under it, which other joints change
MIN_ROWS_PER_BLOCK = 5
# A body that is wider than a centimetre has a pendulum length above 2 cm, twice its radius of gyration. Arms have some metres;
# counterweights and rotors make it longer. A wrong unit of time, as minutes or milliseconds, is a factor of 3600 or 1e6.
MIN_PENDULUM_LENGTH, MAX_PENDULUM_LENGTH = 0.02, 200.0  # m
MIN_LENGTH_SIGMA = 3.0  # standard deviations of its logarithm
MAX_NEGATIVE_PART = 1.0  # of the held-out error of plain least squares: a larger part of the effort is there, with its sign


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
    for angle in ("input_angle", "output_angle"):
        speed = angle.replace("angle", "speed")
        if not {angle, speed, "time"} <= set(record.names):
            continue
        if factor := abs(speed_per_slope(record[angle], record[speed], record.time)):
            names = [file.columns.get(each) or file.columns.get(f"reflected_{each[-5:]}", each) for each in (angle, speed)]
            yield factor, speed, names


def motions_of_both_shafts(file: Recognised, ratio: float) -> Iterator[Check]:
    """Yield the check that a motion of the input is the ratio of the gear times as large as one of the output.

    It compares the angle of one shaft with the speed of the other, or the two speeds. Two angles have a check of their own.

    Args:
        file: the log, as it is fitted
        ratio: of the gear
    """
    for times, names, limit, remedy in _motions_compared(file, ratio):
        off = _factor_between(times, ratio)
        yield Check(
            "motions of both shafts", file.path.name, off, limit, "1", off > limit,
            f"by {names[0]} and {names[1]} the input turns {times:.4g} times as far as the output, the gear has a ratio of "
            f"{abs(ratio):.6g}",
            f"one of these is wrong: {remedy}",
        )  # fmt: skip


def another_ratio_of_shafts(file: Recognised, ratio: float) -> Iterator[str]:
    """Yield a remark on motions of both shafts by another ratio than that of the gear, but not so far off that they fail."""
    for times, names, limit, remedy in _motions_compared(file, ratio):
        if MAX_RATIO_FACTOR < _factor_between(times, ratio) <= limit:
            yield (
                f"by {names[0]} and {names[1]} the input turns {times:.4g} times as far as the output, the gear has a ratio of "
                f"{abs(ratio):.6g}: either the load swings on the spring of the gear, or one of these is wrong: {remedy}"
            )


def _factor_between(times: float, ratio: float) -> float:
    return max(times / abs(ratio), abs(ratio) / times)


def _motions_compared(file: Recognised, ratio: float) -> Iterator[tuple[float, list[str], float, str]]:
    """Yield how many times as far the input turns as the output, the two columns, the limit of its factor, and the remedy."""
    record = file.recording
    pairs = [
        (of_input, of_output)
        for of_input, of_output in (
            ("input_angle", "output_speed"), ("input_speed", "output_angle"), ("input_speed", "output_speed"),
        )
        if {of_input, of_output, "time"} <= set(record.names)
    ]  # fmt: skip
    if not pairs or {"input_angle", "output_angle"} <= set(record.names):
        return
    names = [file.columns.get(each) or file.columns.get(f"reflected_{each[-5:]}", each) for each in pairs[0]]
    times, correlation = _times_as_far(record, *pairs[0])
    if not times:
        return
    factor, is_reflected = times / abs(ratio), f"reflected_{pairs[0][0][-5:]}" in file.columns
    units = [
        as_option("unit", name, unit)
        for channel, name, too_large in zip(pairs[0], names, (factor, 1.0 / factor), strict=True)
        for unit in USUAL_UNITS[channel[-5:]]
        if abs(_own_size(file, channel) / too_large / convert(1.0, unit, USUAL_UNITS[channel[-5:]][0]) - 1.0) < MAX_OFF_UNIT
    ]
    ways = [f"the unit: {' or '.join(units)}"] if units else []
    if not is_reflected and abs(times - 1.0) < MAX_OFF_UNIT:
        ways.append(f"{names[0]} is already divided by the ratio: --column reflected_{pairs[0][0][-5:]}={names[0]}")
    elif not is_reflected:
        ways.append(f"the ratio of the gear, with a belt or pulley before it: --constant ratio={times:.4g}")
    yield times, names, MAX_SWING_ON_SPRING / correlation, "; ".join([*ways, "the side of one of them, or the time"])


def _times_as_far(record: Recording, of_input: str, of_output: str) -> tuple[float, float]:
    """Return how many times as far the input turns as the output, and the correlation of their motions; 0 and 0 if none.

    Angles, and integrals of speeds, are compared without their straight lines: so a biased gyro and a load that swings on
    the spring, the more the faster the motion, count least.
    """
    far, near = (_displacement(record, name) for name in (of_input, of_output))
    squares = float(far @ far), float(near @ near)
    if min(squares) == 0.0 or (explained := float(far @ near) ** 2 / (squares[0] * squares[1])) <= MIN_EXPLAINED:
        return 0.0, 0.0
    return float(np.sqrt(squares[0] / squares[1])), float(np.sqrt(explained))


def _displacement(record: Recording, name: str) -> Array:
    """Return an angle, or the integral of a speed, without its straight line over the time [rad]."""
    time, series = record.time, record[name]
    if name.endswith("speed"):
        series = np.concatenate([[0.0], np.cumsum(0.5 * (series[1:] + series[:-1]) * np.diff(time))])
    line = np.stack([np.ones_like(time), time - time.mean()], axis=1)
    left: Array = series - line @ np.linalg.lstsq(line, series, rcond=None)[0]
    return left


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
    coefficients = solved(columns, recording["voltage"])
    left = recording["voltage"] - columns @ coefficients
    scores = [float(np.mean(each)) for each in np.array_split(left * speed, VOLTAGE_BLOCKS)]
    sigma = float(np.std(scores, ddof=1)) * len(left) / np.sqrt(VOLTAGE_BLOCKS) / float(speed @ speed)
    induced = float(coefficients[1])
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


# ---- Gravity, ratio and halves of the motion -------------------------------------------------------------------------


def checks_of_motion(
    best: MotionCandidate, drive: Drive, recording: Recording, held_out: HeldOut, file: Recognised
) -> Iterator[Check]:
    """Yield the checks of a log by its own motion.

    Args:
        best: the model fitted
        drive: as far as it was known before
        recording: of the log, with its angle in the unit of the file
        held_out: its error on data held out, and that of plain least squares
        file: that contains the log
    """
    source, joints = file.path.name, file.neighbours
    alone = not best.log.regressors
    if alone and not np.any(best.log.extra):
        yield from (by_ratio := list(ratio_by_gravity(best, drive, recording, source)))
        if not any(check.failed for check in by_ratio) and _has_gravity(best):
            yield from angle_in_gravity(best, drive, recording, file)
    yield from ratio_by_orders(drive, recording, source)
    if alone:
        yield from pendulum_length(best.fit.estimates, source)
    yield from negative_parts(best.log, drive, held_out.plain if np.isfinite(held_out.plain) else held_out.error, source)
    yield from halves(best, source, MOVED_BY_OTHERS if joints or best.log.regressors else ())


# ---- Gravity ---------------------------------------------------------------------------------------------------------


def angle_in_gravity(best: MotionCandidate, drive: Drive, recording: Recording, file: Recognised) -> Iterator[Check]:
    """Yield the check that gravity goes with the sine of the angle in the unit and of the side that are taken for it.

    A wrong unit or side of an angle scales inertia and friction, which absorb it. Gravity of a joint that moves far enough
    shows the angle itself. The pass band is compared, by least squares together with inertia and friction of any curve.
    """
    log, ratio = best.log, abs(drive.gear.kinematics.ratio)
    delay = _delay(best)
    if len(log.motion.rows) < MOTION_BLOCKS * MIN_ROWS_PER_BLOCK:
        return
    usual = _squares(log, drive, _best_scale(best, drive), delay)  # a ratio near the one taken may be the simpler mistake
    share, mistake, remedy = 1.0, "", ""
    for what, factor, option in _mistakes(recording, ratio, file.columns):
        if np.ptp(log.motion.angle) * factor / ratio > MAX_JOINT_ANGLE:
            continue
        other = _squares(log, drive, factor, delay)
        gain = float(np.sqrt(usual.sum() / max(other.sum(), 1e-300)))
        if gain > share and _is_less(other, usual):
            share, mistake, remedy = gain, what, option
    wrong = f"gravity does not go with the sine of its angle: the fit leaves {share:.3g} times what it leaves if {mistake}"
    yield Check(
        "angle in the sine of gravity", file.path.name, share, MAX_OF_ANOTHER_UNIT, "1", share > MAX_OF_ANOTHER_UNIT,
        wrong if mistake else "gravity goes with the sine of its angle: no other unit or side of it leaves less",
        f"see whether it is so, and state it: {remedy}" if mistake else "",
    )  # fmt: skip


def _has_gravity(best: MotionCandidate) -> bool:
    """True if the fit determines gravity: without, nothing goes with the sine of the angle."""
    gravity = next((each for each in best.fit.estimates if each.path == "load.gravity_torque"), None)
    return gravity is not None and abs(gravity.value) > MIN_GRAVITY_SIGMA * gravity.sigma


def ratio_by_gravity(best: MotionCandidate, drive: Drive, recording: Recording, source: str) -> Iterator[Check]:
    """Yield the check that gravity goes with the sine of the motor's angle over the ratio of the gear.

    With both encoders their ratio is measured; an angle of the output needs none.
    """
    log, delay = best.log, _delay(best)
    few = len(log.motion.rows) < MOTION_BLOCKS * MIN_ROWS_PER_BLOCK
    if few or "output_angle" in recording or "input_angle" not in recording:
        return
    scale = _best_scale(best, drive)
    off = float(np.log(scale))
    ratio = abs(drive.gear.kinematics.ratio)
    inside = abs(off) < float(RATIOS_TRIED[-2])  # at the end of the range nothing but a straight line is left of a sine
    is_sure = inside and _is_less(_squares(log, drive, scale, delay), _squares(log, drive, 1.0, delay))
    yield Check(
        "ratio by gravity", source, abs(off), MAX_RATIO_DIFFERENCE, "1", is_sure and abs(off) > MAX_RATIO_DIFFERENCE,
        f"gravity goes with the sine of the motor's angle over about {ratio / scale:.3g}, the ratio of the gear is "
        f"{ratio:.6g}",
        "see whether the start set is that of this gear, or give the ratio on its plate, if it is near this one: "
        f"--constant ratio={ratio / scale:.3g}",
    )  # fmt: skip


def _best_scale(best: MotionCandidate, drive: Drive) -> float:
    """Return the true angle over the one taken, as gravity has it, if the ratio taken is wrong by up to a factor of two."""
    from scipy.optimize import minimize_scalar

    log, delay = best.log, _delay(best)

    def left(logarithm: float) -> float:
        return float(_squares(log, drive, float(np.exp(logarithm)), delay).sum())

    nearest = float(min(RATIOS_TRIED, key=left))
    step = float(RATIOS_TRIED[1] - RATIOS_TRIED[0])
    low, high = max(nearest - step, float(RATIOS_TRIED[0])), min(nearest + step, float(RATIOS_TRIED[-1]))
    return float(np.exp(minimize_scalar(left, bounds=(low, high), method="bounded", options={"xatol": 1e-3}).x))


def _is_less(squares: Array, usual: Array) -> bool:
    """True if squares are smaller than the usual ones all over the motion, beyond chance."""
    gains = np.array([block.sum() for block in np.array_split(usual - squares, MOTION_BLOCKS)])
    return sigmas_of_gain(gains) > MIN_READING_GAIN_SIGMA


def _delay(best: MotionCandidate) -> float:
    """Return the delay of the effort that was fitted [s]."""
    return next((each.value for each in best.fit.estimates if each.path == "delay"), 0.0)


def ratio_by_orders(drive: Drive, recording: Recording, source: str) -> Iterator[Check]:
    """Yield the check that the ripple over the output's angle is that of a wave generator with the ratio of the gear.

    Without an angle of the input nothing else shows the ratio.
    """
    column = next((name for name in RIPPLE_COLUMNS if name in recording), None)
    if column is None or "output_angle" not in recording or "input_angle" in recording:
        return
    try:
        concluded = ripple(_coarser(recording, column), column, angle="output_angle", side="output").concluded
    except ValueError:  # too short, too slow or at rest: there is nothing to compare
        return
    if not concluded:
        return
    ratio = abs(float(drive.gear.kinematics.ratio))
    off = min(abs(each - ratio) for each in concluded)
    ratios = " or ".join(map(str, concluded))
    options = " or ".join(f"--constant ratio={each}" for each in concluded)
    yield Check(
        RATIO_BY_ORDERS, source, off, 1.0, "1", off > 1.0,
        f"the ripple of the {column.replace('_', ' ')} over the angle of the output is that of a ratio of {ratios}, the ratio "
        f"of the gear is {ratio:.6g}",
        f"see whether the start set is that of this gear, or give its ratio: {options}",
    )  # fmt: skip


def _coarser(recording: Recording, column: str) -> Recording:
    """Return the means of neighbouring rows, so many that a line of the largest ratio remains; the first ones of a long record.

    A ratio is concluded from some ten thousand rows as from more, in less time.
    """
    angle = np.unwrap(recording.values("output_angle", "rad"))
    step = np.abs(np.diff(angle))
    usual = float(np.median(step[step > 0.0])) if np.any(step > 0.0) else np.inf
    period = np.pi / (STRAIN_WAVE_RATIOS[-1] * usual)  # of the main line, in rows
    every = max(1, min(int(period / MIN_ROWS_PER_PERIOD), len(angle) // MAX_ROWS_OF_RIPPLE))
    rows = min(len(angle) // every, MAX_ROWS_OF_RIPPLE) * every
    names = [name for name in ("time", "output_angle", column) if name in recording]
    means = {
        name: (angle if name == "output_angle" else recording[name])[:rows].reshape(-1, every).mean(axis=1) for name in names
    }
    return Recording(means, {name: "rad" if name == "output_angle" else recording.unit(name) for name in names})


def _mistakes(recording: Recording, ratio: float, columns: Mapping[str, str]) -> Iterator[tuple[str, float, str]]:
    """Yield likely mistakes of the angle: in words, the true angle over the one that is taken, and the option that mends it."""
    name, other, factor = ("input_angle", "output_angle", ratio)
    if name not in recording:
        name, other, factor = other, name, 1.0 / ratio
    unit, column = recording.unit(name), columns.get(name, name)
    for right in MISTAKEN_UNITS.get(unit, ()):
        yield f"the angle is in {right}, not in {unit}", convert(1.0, right, unit), as_option("unit", column, right)
    yield f"it is that of the {other.removesuffix('_angle')}", factor, as_option("column", other, column)


def _squares(log: MotionLog, drive: Drive, factor: float, delay: float) -> Array:
    """Return the squares that least squares leaves in the pass band with the angle times a factor, shape (n,)."""
    motion = log.motion
    speed, angle = motion.speed, factor * motion.output_angle(drive.gear.kinematics.ratio)
    sign = np.sign(speed)
    friction = (speed, sign, np.ones_like(speed), speed * np.abs(speed), sign * np.sqrt(np.abs(speed)))
    series = np.stack([motion.acceleration, *friction, np.sin(angle), np.cos(angle)])
    columns = motion.filtered(late(series, delay, motion.step)[0] if delay else series).T
    measured = log.measured[0]
    return np.asarray((measured - columns @ solved(columns, measured)) ** 2)


def pendulum_length(estimates: tuple[Estimate, ...], source: str) -> Iterator[Check]:
    """Yield the check that inertia and gravity of a load are those of a body: J g / G is the length of a pendulum."""
    by_path = {each.path: each for each in estimates}
    inertia, gravity = by_path.get("load.inertia"), by_path.get("load.gravity_torque")
    if inertia is None or gravity is None or min(inertia.value, gravity.value) <= 0.0:
        return
    relative = float(np.hypot(inertia.sigma / inertia.value, gravity.sigma / gravity.value))
    if relative > MAX_RELATIVE_SIGMA:
        return
    length = STANDARD_GRAVITY * inertia.value / gravity.value
    off = max(float(np.log(MIN_PENDULUM_LENGTH / length)), float(np.log(length / MAX_PENDULUM_LENGTH)))
    yield Check(
        "gravity against inertia", source, length, MIN_PENDULUM_LENGTH if length < 1.0 else MAX_PENDULUM_LENGTH, "m",
        off > MIN_LENGTH_SIGMA * relative,
        f"inertia and gravity of the load are those of a pendulum of {length:.3g} m; joints have {MIN_PENDULUM_LENGTH:g} to "
        f"{MAX_PENDULUM_LENGTH:g} m",
        "see whether the unit of time, or the rate of the rows, is right",
    )  # fmt: skip


# ---- Signs and halves ------------------------------------------------------------------------------------------------


def negative_parts(log: MotionLog, drive: Drive, error: float, source: str) -> Iterator[Check]:
    """Yield the check that inertia and Coulomb friction are not clearly negative by plain least squares.

    A model has neither: its fit ends at the bound, and its other numbers make up for what is missing. `error` is what plain
    least squares leaves on data held out: it knows its parts no better.
    """
    plain, rows = fit_plain(log, drive), moving(log)
    scale = abs(per_torque(drive, log.effort))
    rotor = drive.motor.inertia + drive.gear.input_inertia
    parts = {
        "inertia of the load": (plain.inertia - rotor, float(np.std(log.motion.acceleration[rows])), "kg·m²"),
        "Coulomb friction": (plain.coulomb, 1.0, "N·m"),
    }
    made = {name: -scale * value * unit for name, (value, unit, _) in parts.items()}
    name = max(made, key=lambda each: made[each])
    share = max(made[name], 0.0) / max(error, 1e-300)
    value, _, unit = parts[name]
    effort = log.units[0]
    yield Check(
        "estimates at bounds", source, share, MAX_NEGATIVE_PART, "1", share > MAX_NEGATIVE_PART,
        f"plain least squares has a negative {name} of {value:.3g} {unit} at the input: it makes {made[name]:.3g} {effort}, "
        f"more than the {error:.3g} {effort} that it leaves on data held out",
        "see whether the signs of angle and effort fit each other, whether the effort comes with a delay, and whether another "
        "drive or a hand moves the joint",
    )  # fmt: skip


def halves(best: MotionCandidate, source: str, left_out: tuple[str, ...]) -> Iterator[Check]:
    """Yield the check that both halves of the motion determine the same numbers, as runs of one gear do.

    `left_out` are beginnings of paths that are not compared.
    """
    count = len(best.log.motion.rows)
    first = np.arange(count) < count // 2
    try:
        pair = [_determined(best, rows) for rows in (first, ~first)]
    except (ValueError, FloatingPointError):  # a half that does not move both ways, or not enough
        return
    apart, words = 0.0, ""
    compared = pair[0].keys() & pair[1].keys()
    for path in (each for each in compared if not each.startswith(left_out)):
        one, other = (each[path] for each in pair)
        spread = repeatability(path) * max(abs(one.value), abs(other.value))
        distance = abs(one.value - other.value) / float(np.linalg.norm([spread, one.sigma, other.sigma]))
        if distance > apart:
            apart = distance
            words = f"{path} = {one.value:.4g} ± {one.sigma:.2g} against {other.value:.4g} ± {other.sigma:.2g}"
    yield Check(
        "halves of the record", source, apart, MAX_DISTANCE, "1", apart > MAX_DISTANCE,
        f"the halves of the motion have {words}: {apart:.2g} times what runs of one gear and chance differ by",
        "see whether load, temperature or controller changed on the way, or an encoder slipped; give the parts as files of "
        "their own",
    )  # fmt: skip


def _determined(best: MotionCandidate, rows: NDArray[np.bool_]) -> Mapping[str, Estimate]:
    """Return the numbers of the drive that some of the samples determine, by path."""
    half_fit = best.fitted_to(rows)
    nuisances = {nuisance.name for part in half_fit.parts for nuisance in part.experiment.nuisances}
    return {
        each.path: each
        for each in half_fit.estimates
        if each.path not in nuisances and each.path not in best.model.ties and "phase" not in each.path
        and not is_uncertain(each.value, each.sigma)
    }  # fmt: skip
