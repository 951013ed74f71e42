"""Logs of moving drives: inertia, gravity and friction that the torque along a measured motion tells, and which friction."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from strainwave import Drive, friction, loads
from strainwave.equality import ComparedByFields
from strainwave.identification.experiments.motion_log import FRICTIONLESS, MotionLog, inertia_of, per_torque
from strainwave.identification.experiments.stages import series_compliance
from strainwave.identification.fitting.fit import Fit, fit

Array = NDArray[np.float64]

BLOCKS = 10  # of a log, every second of which is held out while models are compared
QUADRANTS = ("driving_forward", "driving_reverse", "backdriving_forward", "backdriving_reverse")
LOSSES = tuple(f"gear.friction_mesh.{name}" for name in QUADRANTS)
COULOMB = ("gear.friction_input.coulomb", "gear.friction_input.viscous")
CURVED = ("gear.friction_input.coulomb", "gear.friction_input.viscous_torque", "gear.friction_input.exponent")
FALL = (*COULOMB, "gear.friction_input.breakaway", "gear.friction_input.stribeck_speed")
FOLLOWS = {"gear.friction_input.breakaway": "gear.friction_input.coulomb"}
CLEARLY = 0.98  # of an error held out: what is not smaller than that is chance
TOLD = 2.5  # standard deviations: what is nearer to nothing is left out
SMALL = 1e-3  # of the largest torque: a friction from which a fit can start


@dataclass(frozen=True, eq=False)
class MotionCandidate(ComparedByFields):
    """A model of the friction fitted to logs of one drive.

    Attributes:
        name: what it describes
        fit: the fit to the whole logs
        tied: paths of numbers that follow others
        error: rms of each log's effort, held out, over the rms of its effort about its mean, all logs together [1]
    """

    name: str
    fit: Fit
    tied: frozenset[str]
    error: float


@dataclass(frozen=True)
class Regression:
    """What linear regression finds in one log, from which fits start; referred to the input.

    Attributes:
        inertia: of everything that turns [kg.m2]
        viscous: [N.m.s/rad]
        coulomb: [N.m]
        offset: [N.m]
        gravity: amplitude at the output [N.m]
        phase: of the gravity [rad]
        shares: of other bodies in the torque of the output, as many as the log has regressors [1]
        share: of the variation of the torque that is explained
    """

    inertia: float
    viscous: float
    coulomb: float
    offset: float
    gravity: float
    phase: float
    shares: tuple[float, ...]
    share: float

    @property
    def reversed(self) -> bool:
        """Whether the torque is counted against the motion: then both inertia and friction come out negative."""
        return self.inertia < 0.0 and self.coulomb + self.viscous < 0.0


def regression(log: MotionLog, drive: Drive) -> Regression:
    """Inertia, friction and gravity by linear least squares, as though friction were Coulomb's and viscous.

    torque = J a + b v + c sgn v + o + (g_s sin q + g_c cos q) / i, in the pass band of the log
    """
    motion, ratio = log.motion, drive.gear.kinematics.ratio
    angle = motion.angle / ratio
    series = [motion.acceleration, motion.speed, np.sign(motion.speed), np.ones_like(angle)]
    series += [np.sin(angle) / ratio, np.cos(angle) / ratio, *(each / ratio for each in log.regressors.values())]
    columns = motion.filtered(np.stack(series)).T
    torque = (log.measured[0] - motion.filtered(log.induced(drive)[np.newaxis])[0]) / per_torque(drive, log.effort)
    torque = torque - motion.filtered(log.extra[np.newaxis] / ratio)[0]
    size = np.linalg.norm(columns, axis=0)
    weights = np.linalg.lstsq(columns / size, torque, rcond=1e-6)[0] / size
    left = torque - columns @ weights
    inertia, viscous, coulomb, offset = (float(each) for each in weights[:4])
    return Regression(
        inertia,
        viscous,
        coulomb,
        offset,
        float(np.hypot(*weights[4:6])),
        float(np.arctan2(weights[5], weights[4])),
        tuple(weights[6:].tolist()),
        1.0 - float(np.var(left) / np.var(torque)),
    )


def fit_motion(
    logs: Mapping[str, MotionLog],
    drive: Drive,
    *,
    inertia: str = "load.inertia",
    own_load: bool = False,
    kept: Sequence[str] = (),
    priors: Mapping[str, tuple[float, float]] | None = None,
) -> tuple[MotionCandidate, ...]:
    """Fits a rigid drive to logs of its motion by every friction that they can tell, and ranks them.

    Args:
        logs: by name
        drive: to start from, with a load of inertia or pendulum
        inertia: the inertia that is not known, as a path of the drive
        own_load: whether each log has a load of its own, inertia and gravity
        kept: paths that are not fitted, as friction that a better measurement has told
        priors: what is known of free parameters: value and standard deviation

    Returns:
        candidates, best first: the one with fewest parameters whose held-out error is within 2 % of the least

    Raises:
        ValueError: a log cannot be explained by any inertia and friction
    """
    found = {name: regression(log, drive) for name, log in logs.items()}
    start, free = _start(drive, found, inertia)
    load = [path for path in free if path.startswith("load.")] if own_load else []
    logs, found = _rigid(logs, drive, found)
    logs = {name: _with_delay(log, start, free, found[name]) for name, log in logs.items()}
    fastest = max(float(np.abs(log.motion.speed).max()) for log in logs.values())
    tried = [_candidate(each, logs, free, load, kept, priors or {}) for each in _frictions(start, fastest)]
    straight, falling, lossy, _ = tried
    if max(falling.error, lossy.error) < CLEARLY * straight.error:  # each tells something of its own; both may tell more
        tried.append(_candidate(_together(straight.fit.model), logs, free, load, kept, priors or {}))
    best = min(each.error for each in tried)
    return tuple(sorted(tried, key=lambda each: (each.error > best / CLEARLY, len(each.fit.estimates), each.error)))


def _start(drive: Drive, found: Mapping[str, Regression], inertia: str) -> tuple[Drive, list[str]]:
    """The drive near the measurement, and what is free of it."""
    middle = {
        name: float(np.median([getattr(each, name) for each in found.values()])) for name in ("inertia", "viscous", "coulomb")
    }
    heaviest = max(found.values(), key=lambda each: each.gravity)
    ratio, least = drive.gear.kinematics.ratio, SMALL * max(abs(middle["coulomb"]), 1e-6)
    law = friction.Coulomb(
        coulomb=max(middle["coulomb"], least), breakaway=max(middle["coulomb"], least), viscous=max(middle["viscous"], 0.0)
    )
    drive = drive.replace(gear=drive.gear.replace(friction_input=law, friction_mesh=FRICTIONLESS))  # what is sought anew
    total = max(middle["inertia"], 1e-9)
    if inertia == "load.inertia":
        carried = max(total - drive.motor.inertia - drive.gear.input_inertia, 0.02 * total) * ratio**2
        load: Any = loads.Pendulum(inertia=carried, gravity_torque=heaviest.gravity, gravity_phase=heaviest.phase)
        return drive.replace(load=load), [inertia, "load.gravity_torque", "load.gravity_phase"]
    rest = total - drive.gear.input_inertia - inertia_of(drive) / ratio**2
    return drive.replace(motor=drive.motor.replace(inertia=max(rest, 0.02 * total))), [inertia]


def natural_frequency(drive: Drive, carried: float) -> float:
    """Of an inertia on the spring of the gear, its input held [Hz]; infinite where nothing gives way, or it has play."""
    softness = 1.0 / stiffness if (stiffness := drive.gear.stiffness.tangent(0.0)) > 0.0 else 0.0
    softness += series_compliance(drive.gear)
    return float(1.0 / (2.0 * np.pi * np.sqrt(softness * carried))) if softness * carried > 0.0 else np.inf


def _rigid(
    logs: Mapping[str, MotionLog], drive: Drive, found: Mapping[str, Regression]
) -> tuple[dict[str, MotionLog], dict[str, Regression]]:
    """The logs where their drive is rigid: below what gear and load vibrate with, where less is left unexplained than in all.

    A spring that was taken from a catalogue may be none of this drive.
    """
    rigid, again = dict(logs), dict(found)
    rotor, ratio = drive.motor.inertia + drive.gear.input_inertia, drive.gear.kinematics.ratio
    for name, log in logs.items():
        frequency = natural_frequency(drive, max(found[name].inertia - rotor, 0.0) * ratio**2)
        try:
            below = log.below(frequency)
        except ValueError:  # it moves as fast as it vibrates
            continue
        if (there := regression(below, drive)).share > found[name].share:
            rigid[name], again[name] = below, there
    return rigid, again


def _with_delay(log: MotionLog, drive: Drive, free: Sequence[str], found: Regression) -> MotionLog:
    """The log, with a delay as an unknown if one is found, and where fits start with its unknowns."""
    zero = found.offset * per_torque(drive, log.effort)
    log = log.with_delay().starting((zero, 0.0, *found.shares))
    tried = fit(drive, log, [*free, *COULOMB]).estimates[-len(log.nuisances) :]
    zero_there, delay, *shares = tried
    if abs(delay.value) > TOLD * delay.sigma:
        return log.starting([each.value for each in tried])
    return log.without_delay().starting([each.value for each in (zero_there, *shares)])


@dataclass(frozen=True, eq=False)
class _Form(ComparedByFields):
    """A friction to be tried: its name, the drive that has it, what is free of it, and what follows."""

    name: str
    drive: Drive
    free: tuple[str, ...]
    ties: Mapping[str, str]


def _frictions(drive: Drive, fastest: float) -> list[_Form]:
    """Coulomb's friction alone, with a fall at low speed, with a loss under load, and with a viscous part that bends."""
    return [_Form("Coulomb and viscous", drive, COULOMB, FOLLOWS), _falling(drive), _lossy(drive), _curved(drive, fastest)]


def _falling(drive: Drive) -> _Form:
    law: Any = drive.gear.friction_input
    falling = friction.Stribeck(coulomb=law.coulomb, breakaway=1.3 * law.coulomb, stribeck_speed=3.0, viscous=law.viscous)
    return _Form("with a fall at low speed", drive.replace(gear=drive.gear.replace(friction_input=falling)), FALL, {})


def _lossy(drive: Drive) -> _Form:
    lossy = friction.LoadDependent(**dict.fromkeys(QUADRANTS, 0.02))
    alike = dict.fromkeys(LOSSES[1:], LOSSES[0])  # one for each quadrant cannot be told from inertia and gravity
    changed = drive.replace(gear=drive.gear.replace(friction_mesh=lossy))
    return _Form("with loss under load", changed, (*COULOMB, LOSSES[0]), FOLLOWS | alike)


def _curved(drive: Drive, fastest: float) -> _Form:
    law: Any = drive.gear.friction_input
    curved = friction.CurvedViscous(
        coulomb=law.coulomb, breakaway=law.coulomb, viscous_torque=max(law.viscous * fastest, 1e-3 * law.coulomb),
        exponent=0.9, reference_speed=fastest,
    )  # fmt: skip
    return _Form("with a curved viscous part", drive.replace(gear=drive.gear.replace(friction_input=curved)), CURVED, FOLLOWS)


def _together(drive: Drive) -> _Form:
    falling = _falling(drive)
    lossy = _lossy(falling.drive)
    ties = {path: other for path, other in lossy.ties.items() if path not in FOLLOWS}
    return _Form("with loss under load and a fall at low speed", lossy.drive, (*FALL, LOSSES[0]), ties)


def _candidate(
    form: _Form,
    logs: Mapping[str, MotionLog],
    free: Sequence[str],
    load: Sequence[str],
    kept: Sequence[str],
    priors: Mapping[str, tuple[float, float]],
) -> MotionCandidate:
    paths = [path for path in (*free, *form.free) if path not in kept]
    given: dict[str, Any] = {
        "ties": form.ties,
        "per_record": load if len(logs) > 1 else (),
        "priors": {path: prior for path, prior in priors.items() if path in paths},
    }
    masks = {name: training_blocks(log.time) for name, log in logs.items()}
    held = fit(form.drive, dict(logs), paths, training=masks, **given)
    left = sum(float(np.sum(part.residuals[:, ~part.training] ** 2) / np.var(part.experiment.measured)) for part in held.parts)
    count = sum(int(np.sum(~part.training)) for part in held.parts)
    found = fit(held.model, _from_there(logs, held), paths, **given)
    return MotionCandidate(form.name, found, frozenset(form.ties), float(np.sqrt(left / count)))


def _from_there(logs: Mapping[str, MotionLog], held: Fit) -> dict[str, MotionLog]:
    """The logs, whose unknowns start where a fit has ended."""
    counts = [len(log.nuisances) for log in logs.values()]
    values = [each.value for each in held.estimates[-sum(counts) :]]
    firsts = np.cumsum([0, *counts])
    return {
        name: log.starting(values[first : first + count])
        for (name, log), first, count in zip(logs.items(), firsts, counts, strict=False)
    }


def training_blocks(time: Array) -> NDArray[np.bool_]:
    """Every second of some blocks of time, over instants [s], shape (n,)."""
    block = np.minimum((BLOCKS * (time - time[0]) / (time[-1] - time[0])).astype(int), BLOCKS - 1)
    training: NDArray[np.bool_] = block % 2 == 0
    return training
