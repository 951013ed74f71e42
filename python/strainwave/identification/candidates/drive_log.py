"""Drive logs: numbers of the gear from a run of the whole drive."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from operator import methodcaller
from typing import Any

import numpy as np
from numpy.typing import NDArray

from strainwave import Drive, _core, friction, kinematic_error
from strainwave._core import Gear
from strainwave.equality import ComparedByFields
from strainwave.identification.candidates.friction import innermost
from strainwave.identification.experiments.drive_log import DriveLog
from strainwave.identification.fitting.fit import Fit, fit
from strainwave.statistics.linear_fit import amplitudes_of, order_waves, solved

Array = NDArray[np.float64]

TRAINING_SHARE = 0.7  # of the record; the rest, later in time, validates
MAX_STEPS_AT_FIRST = 40_000  # of the simulation; the beginning of a longer log is fitted first, which saves time
MAX_BREAKAWAY_ROUNDS = 4  # of fits, in which breakaway follows Coulomb's torque
BREAKAWAY_TOLERANCE = 1e-3  # relative, between breakaway and the torque that it follows
MAX_HALVINGS = 12  # of a friction that the command does not overcome
MAX_SLOPE = 0.1  # of each harmonic over that of the rigid motion: no gear has a larger one (assumed)
TYPICAL_ORDERS = (1.0, 2.0, 4.0)  # of the input rotation, the harmonics found in every gear measured so far


@dataclass(frozen=True, eq=False)
class LogFit(ComparedByFields):
    """A drive fitted to a log.

    Attributes:
        fit: the fit to the first part of the record
        error: rms of each channel over the rest, in the channel's unit, shape (channels,)
    """

    fit: Fit
    error: Array


def fit_log(log: DriveLog, drive: Drive, free: list[str]) -> LogFit:
    """Fit parameters of a gear to a drive log, by simulating the drive under the command of the log.

    Args:
        log: command and measured outputs, starting at rest
        drive: motor, control and load as known, the gear to start from
        free: parameters of the gear to fit, as paths of the drive

    Returns:
        the fit to the first 70 % of the record, with its error on the rest

    Raises:
        ValueError: the log is too short for the parameters
    """
    training = log.time <= TRAINING_SHARE * log.time[-1]
    is_long = log.time[-1] > MAX_STEPS_AT_FIRST * log.dt
    near = fit(drive, log.beginning(MAX_STEPS_AT_FIRST / 2 * log.dt), free).model if is_long else drive
    log_fit = fit(near, log, free, training=training)
    for _ in range(MAX_BREAKAWAY_ROUNDS):
        law, wanted = log_fit.gear.friction_input, _breakaway(log_fit.gear, drive.gear)
        if wanted is None or abs(innermost(law).breakaway - wanted) <= BREAKAWAY_TOLERANCE * wanted:
            break
        follows = _changed(law, methodcaller("replace", breakaway=wanted))
        model = log_fit.model.replace(gear=log_fit.gear.replace(friction_input=follows))
        if not _moves(log, model):
            break
        log_fit = fit(model, log, free, training=training)
    log_fit = _within_a_turn(log_fit)
    return LogFit(log_fit, log_fit.rms(held_out=True))


def _within_a_turn(found: Fit) -> Fit:
    """Return the fit with phases of the kinematic error from -pi to pi."""
    error = found.gear.kinematic_error
    if not isinstance(error, kinematic_error.Fourier):
        return found
    phases = [float(np.remainder(phase + np.pi, 2.0 * np.pi) - np.pi) for phase in error.phase]
    model = found.model.replace(gear=found.gear.replace(kinematic_error=error.replace(phase=phases)))
    turned = {f"gear.kinematic_error.phase[{i}]": phase for i, phase in enumerate(phases)}
    estimates = tuple(replace(each, value=turned.get(each.path, each.value)) for each in found.estimates)
    return replace(found, model=model, estimates=estimates)


def _changed(law: Any, change: Callable[[Any], Any]) -> Any:
    """Return the law with its innermost one changed."""
    return law.replace(law=_changed(law.law, change)) if hasattr(law, "law") else change(law)


def _breakaway(gear: Gear, start: Gear) -> float | None:
    """Return the breakaway that follows from Coulomb's torque: by its ratio before in Coulomb's law, no less in others."""
    law, before = innermost(gear.friction_input), innermost(start.friction_input)
    if not hasattr(law, "breakaway"):
        return None
    if isinstance(law, friction.Coulomb) and before.coulomb > 0.0:
        return float(law.coulomb * max(before.breakaway / before.coulomb, 1.0))
    return float(max(law.breakaway, law.coulomb))


def free_parameters(log: DriveLog, drive: Drive, *, friction_known: bool, torsion_known: bool) -> list[str]:
    """Return the paths that a log determines and no better measurement does.

    Friction at the input from any log, also that of a law within `Cyclic` or `Thermal`; the first stiffness and the kinematic
    error only if both shafts have encoders.
    """
    paths = [path for path, *_ in _core.parameters(drive) if path.startswith("gear.friction_input.")]
    free = [] if friction_known else [path for path in paths if path.rpartition(".")[2] in ("coulomb", "viscous")]
    if {"input_angle", "output_angle"} <= set(log.channels):
        if not torsion_known:
            free.append(f"gear.stiffness.{drive.gear.stiffness.fields[0]['name']}")
        free += ["gear.kinematic_error.amplitude", "gear.kinematic_error.phase"]
    return free


def prepared(log: DriveLog, drive: Drive, *, friction_known: bool) -> Drive:
    """Return the drive with a gear whose laws have the parameters that the log can determine, started near the measurement."""
    gear = drive.gear.replace(friction_input=_changed(drive.gear.friction_input, _with_coulomb))
    if {"input_angle", "output_angle"} <= set(log.channels):
        gear = gear.replace(kinematic_error=_harmonics(log, gear.kinematics.ratio))
    drive = drive.replace(gear=gear)
    return drive if friction_known else _set_in_motion(log, drive)


def _set_in_motion(log: DriveLog, drive: Drive) -> Drive:
    """Return the drive with so little dry friction that it moves under the command of the log; the same if it never does."""
    tried = drive
    for _ in range(MAX_HALVINGS):
        if _moves(log, tried):
            return tried
        tried = tried.replace(gear=tried.gear.replace(friction_input=_changed(tried.gear.friction_input, _halved)))
    return drive


def _moves(log: DriveLog, drive: Drive) -> bool:
    """True if a drive moves under the command of the log; False if its simulation diverges."""
    zeros = np.array([nuisance.start for nuisance in log.nuisances])
    try:
        return not log.stands_still(log.predict(drive, [], zeros)[0])
    except (ValueError, FloatingPointError):
        return False


def _halved(law: Any) -> Any:
    """Return a law of friction with half its dry torque."""
    return law.replace(**{name: 0.5 * getattr(law, name) for name in ("coulomb", "breakaway") if hasattr(law, name)})


def _with_coulomb(law: Any) -> Any:
    """Return Coulomb's law in place of a purely viscous one."""
    return friction.Coulomb(coulomb=1e-3, viscous=law.viscous) if isinstance(law, friction.Viscous) else law


def _harmonics(log: DriveLog, ratio: float) -> kinematic_error.Fourier:
    """Return harmonics of the measured transmission error over the input angle, by linear least squares."""
    input_angle = log.measured[log.channels.index("input_angle")]
    output_angle = log.measured[log.channels.index("output_angle")]
    angle = input_angle - input_angle[0]
    error = angle / ratio - (output_angle - output_angle[0])
    columns = np.column_stack((np.ones_like(angle), angle, order_waves(angle, TYPICAL_ORDERS)))
    amplitude, phase = amplitudes_of(solved(columns, error)[2:])
    largest = MAX_SLOPE / (abs(ratio) * np.array(TYPICAL_ORDERS))
    amplitude = np.where(amplitude < largest, amplitude, 1e-3 * largest)  # no error of a gear: something else is wrong
    return kinematic_error.Fourier(order=TYPICAL_ORDERS, amplitude=amplitude.tolist(), phase=phase.tolist())
