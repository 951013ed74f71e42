"""Curves to be drawn: a measurement, the prediction of its model, and the uncertainty of both."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from strainwave import _core, arguments
from strainwave.files.recording import Recording
from strainwave.identification.candidates.elastic import transmitted_torque
from strainwave.identification.experiments.driven_log import DrivenLog
from strainwave.identification.experiments.experiment import Experiment
from strainwave.identification.experiments.friction_table import FrictionTable
from strainwave.identification.experiments.motion_log import MotionLog, per_torque
from strainwave.identification.experiments.torsion_loop import TorsionLoop
from strainwave.identification.fitting.fit import Fit, RecordFit
from strainwave.identification.results.file_result import Look, Picture
from strainwave.messages import listed, quoted
from strainwave.orders.two_encoders import TransmissionError

Array = NDArray[np.float64]
TURN_BINS = 72  # parts of a turn of the input: order 8 has nine of them
SPEED_BINS = 16  # of each direction of motion, with as many samples each


def curves_of(fit: Fit) -> Recording:
    """Return the first measurement of a fit and the prediction of its model.

    Returns:
        speed, twist or time; the first channel, under its name; `modelled`, the prediction; `held_out`, 1 where a sample took
        no part in the fit; and `sigma`, the standard deviation of `modelled` by that of the estimates, if the data determine
        all of them

    The standard deviation is that of a linear function of the estimates, the root of J C J^T, with J the derivatives of the
    prediction and C the covariance of the estimates (JCGM 100:2008, eq. 13).
    """
    return _curves(fit.parts[0], 0, _sigmas(fit)[0])


def pictures_of(fit: Fit, record: str | None = None) -> tuple[Picture, ...]:
    """Return a picture of each channel of a record, the first one if no name is given; curves as `curves_of` returns them.

    The standard deviation of the prediction is drawn if the fit is to one record.
    """
    part = part_named(fit, record)
    sigmas = _sigmas(fit) if len(fit.parts) == 1 else np.full(part.predicted.shape, np.inf)
    look: Look = {"speed": "table", "twist": "loop"}.get(_abscissa(part.experiment)[0], "series")  # type: ignore[assignment]
    return tuple(Picture(_curves(part, place, sigma), look) for place, sigma in enumerate(sigmas))


def part_named(fit: Fit, record: str | None) -> RecordFit:
    """Return the part of a fit by the name of its record, the first one if no name is given.

    Raises:
        ValueError: no record has that name
        TypeError: the name is no text
    """
    if record is None:
        return fit.parts[0]
    names = [part.name for part in fit.parts]
    if arguments.text("record", record) not in names:
        raise ValueError(f"no record {quoted(record)}; there are {listed(names)}")
    return fit.parts[names.index(record)]


def _curves(part: RecordFit, place: int, sigma: Array) -> Recording:
    """Return the curves of one channel; `sigma` is left out if it is not finite."""
    experiment, channel = part.experiment, part.experiment.channels[place]
    over, unit, x = _abscissa(experiment)
    columns = {over: x, channel: experiment.measured[place], "modelled": part.predicted[place]}
    units = {over: unit, channel: experiment.units[place], "modelled": experiment.units[place], "held_out": "1"}
    columns["held_out"] = (~part.training).astype(float)
    if np.isfinite(sigma).all():
        columns["sigma"], units["sigma"] = sigma, experiment.units[place]
    return Recording(columns, units)


def curves_of_orders(found: TransmissionError) -> Recording:
    """Return the transmission error and its significant orders.

    Returns:
        time, or the input angle if there is no time; `transmission_error`; `modelled`, its significant orders; `residual`,
        left by orders and loads; and `sigma`, the standard deviation of `modelled` by amplitudes and phases of the
        input's orders, taken as independent
    """
    curves = found.curves
    over = "time" if "time" in curves else "input_angle"
    error, angle = curves["transmission_error"], curves["input_angle"]
    variance = np.zeros_like(angle)
    for each in found.orders:
        if each.significant and each.shaft == "input":
            phase = each.order * angle + each.phase
            variance += (each.amplitude_sigma * np.sin(phase)) ** 2
            variance += (each.amplitude * each.phase_sigma * np.cos(phase)) ** 2
    columns = {over: curves[over], "transmission_error": error, "modelled": curves["kinematic_error"]}
    columns |= {"residual": curves["residual"], "sigma": np.sqrt(variance)}
    units = dict.fromkeys(columns, "rad") | {over: curves.unit(over)}
    return Recording(columns, units)


def picture_of_turn(found: TransmissionError) -> Picture:
    """Return the picture of the transmission error over a turn of the input, its mean in each part of the turn.

    Torque, direction and orders of the output are taken out, as far as the record determines them.
    """
    angle = np.mod(found.curves["input_angle"], 2.0 * np.pi)
    measured = sum(_waves(found, found.curves["input_angle"]), found.curves["residual"])
    place = (angle / (2.0 * np.pi) * TURN_BINS).astype(int) % TURN_BINS
    filled = np.unique(place)
    middle = (filled + 0.5) * 2.0 * np.pi / TURN_BINS
    means = np.array([measured[place == each].mean() for each in filled])
    columns = {
        "input_angle": middle,
        "transmission_error": means,
        "modelled": sum(_waves(found, middle), np.zeros_like(middle)),
    }
    orders = tuple((each.order, each.amplitude, each.amplitude_sigma) for each in found.orders if each.shaft == "input")
    title = "transmission error over a turn of the input"
    return Picture(Recording(columns, dict.fromkeys(columns, "rad")), "turn", "transmission error", title, "", orders)


def _waves(found: TransmissionError, angle: Array) -> list[Array]:
    """Return the significant orders of the input at an angle of it."""
    own = [each for each in found.orders if each.significant and each.shaft == "input"]
    return [each.amplitude * np.sin(each.order * angle + each.phase) for each in own]


def picture_of_friction(fit: Fit, unit: str) -> Picture:
    """Return the picture of friction over the speed of a log along its motion, means of what is left added to its law.

    Args:
        fit: of the log
        unit: of the friction, N.m, or A if the torque constant is not known
    """
    part = fit.parts[0]
    log, drive = part.experiment, part.model
    assert isinstance(log, MotionLog)
    rows = log.motion.rows
    speed, left = log.motion.speed[rows], part.residuals[0] / per_torque(drive, log.effort)
    load = np.abs(transmitted_torque(log, drive)[rows]) / abs(drive.gear.kinematics.ratio)
    bins = [
        each
        for way in (-1.0, 1.0)
        for each in np.array_split(np.flatnonzero(way * speed > 0.0)[np.argsort(speed[way * speed > 0.0])], SPEED_BINS)
        if len(each)
    ]
    means = np.array([[float(np.mean(series[each])) for series in (speed, left, load)] for each in bins]).reshape(-1, 3).T
    table = FrictionTable(np.abs(means[0]), np.zeros(len(bins)), load=means[2])
    friction = np.sign(means[0]) * table.predict(drive.gear, [], np.zeros(0))[0][0]
    columns = {"speed": means[0], "friction": friction + means[1], "modelled": friction}
    units = {"speed": "rad/s", "friction": unit, "modelled": unit}
    return Picture(Recording(columns, units), "table", "friction, at the input", "friction over speed")


def picture_of_twist(fit: Fit, unit: str) -> Picture:
    """Return the picture of the twist between both encoders of a log over the torque that the gear transmits.

    Args:
        fit: of the log
        unit: of the torque, N.m, or A if the torque constant is not known
    """
    part = fit.parts[0]
    log, gear = part.experiment, part.model.gear
    assert isinstance(log, DrivenLog)
    turned = log.angle / gear.kinematics.ratio - gear.kinematic_error.error(log.angle)
    measured, modelled = turned - log.measured[0], turned - part.predicted[0]
    columns = {
        "torque": log.gear_torque(part.model),
        "twist": measured - modelled.mean(),
        "modelled": modelled - modelled.mean(),
    }
    units = {"torque": unit, "twist": "rad", "modelled": "rad"}
    return Picture(Recording(columns, units), "loop", "twist, at the output", "twist over torque")


def curves_of_shafts(fit: Fit) -> Recording:
    """Return the angle between the shafts in a log and its prediction along the motion of the input.

    Returns:
        time; `transmission_error`, input over ratio less output, from a mean of zero; and `modelled`
    """
    part = fit.parts[0]
    log: Any = part.experiment
    turned = log.angle / part.model.gear.kinematics.ratio
    error, modelled = turned - log.measured[0], turned - part.predicted[0]
    columns = {"time": log.time, "transmission_error": error - error.mean(), "modelled": modelled - error.mean()}
    return Recording(columns, dict.fromkeys(columns, "rad") | {"time": "s"})


def pictures_of_channels(fit: Fit) -> tuple[Picture, ...]:
    """Return a picture over time of each channel of a run."""
    part = fit.parts[0]
    unknown = np.full(part.predicted.shape[1], np.inf)
    return tuple(
        Picture(_curves(part, place, unknown), title=channel.replace("_", " "))
        for place, channel in enumerate(part.experiment.channels)
    )


def _abscissa(experiment: Experiment) -> tuple[str, str, Array]:
    if isinstance(experiment, FrictionTable):
        return "speed", "rad/s", experiment.speed
    if isinstance(experiment, TorsionLoop):
        return "twist", "rad", experiment.twist
    log: Any = experiment
    return "time", "s", log.time


def _sigmas(fit: Fit) -> Array:
    """Return the standard deviation of the prediction of the first record, shape (channels, n)."""
    part, own = fit.parts[0], {each.path: place for place, each in enumerate(fit.estimates)}
    zeros = [each.name for each in part.experiment.nuisances]
    numbers = {path: number for number, (path, *_) in enumerate(_core.parameters(part.model))}
    known = [path for path in own if path in numbers and path not in zeros]
    nuisances = np.array([fit.estimates[own[name]].value for name in zeros])
    _, slopes = part.experiment.predict(part.model, [numbers[path] for path in known], nuisances)
    places = [own[path] for path in (*known, *zeros)]
    covariance = fit.covariance[np.ix_(places, places)]
    with np.errstate(invalid="ignore"):  # infinite where the data do not determine an estimate
        variance: Array = np.einsum("icn,ij,jcn->cn", slopes, covariance, slopes, optimize=True)
    return np.sqrt(np.clip(variance, 0.0, None))
