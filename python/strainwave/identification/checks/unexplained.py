"""Check that a fit explains its measurement; if it does not, the likely mistakes in the recording that would."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from strainwave import Drive
from strainwave.files.recording import Recording
from strainwave.files.units import convert
from strainwave.identification.checks.sizes import MISTAKEN_UNITS
from strainwave.identification.experiments.drive_log import ENCODERS, DriveLog
from strainwave.identification.experiments.friction_table import FrictionTable
from strainwave.identification.fitting.fit import Fit
from strainwave.identification.results.file_result import Check, FileEstimate, error_in_words
from strainwave.identification.results.gear_so_far import geared
from strainwave.messages import as_option, listed
from strainwave.statistics.residuals import shape
from strainwave.statistics.scale import noise_sigma
from strainwave.typeset import quantity

Array = NDArray[np.float64]

# Share of the variation of a channel that a fit may leave unexplained in addition to noise. It is less for an angle, which sums
# up the motion before, than for a torque or a current, which contain every effect that a model lacks.
MAX_SHARE_OF_MOTION = 0.1
MAX_SHARE_OF_LOOP = 0.1
MAX_SHARE_OF_TORQUE = 0.3
MAX_SHARE_OF_PRESLIDING = 0.5  # on data held out
MIN_RATIO_ERROR = 0.03  # relative: the ratio of two encoders must differ by more from the gear's to be another one
SHAPE_OF_RESIDUALS = "shape of what is left"
MAX_CHANCE_OF_SHAPE = 1e-3  # of noise that repeats as well: of right models 1 in 1000 has a shape by chance
MAX_SHARE_OF_SHAPE = 0.25  # of what varies: models of real joints leave up to 16 %
OVER_OUTPUT, OVER_SPEED, OVER_TURN = "the angle of the output", "the speed", "the turn of the input"
OVER_LOOP, OVER_TWIST = "the loop", "the twist"
MISSING = {  # what a model lacks, whose residual has a shape over each of these, and what to do
    OVER_OUTPUT: (
        "a torque that changes with the angle of the output: of other joints that move, of a cable or of a second load",
        "move the joint alone, or give the torque of the other joints as --column rigid_torque=NAME",
    ),
    OVER_SPEED: (
        "a friction that changes otherwise with the speed: by the temperature, the load, or at low speed",
        "see with --rank which law of friction predicts best, and record all speeds several times, in both directions",
    ),
    OVER_TURN: (
        "a ripple over the turn of the input: a detent of the motor, or friction of the wave generator",
        "see its orders with strainwave orders, and record whole turns at several speeds",
    ),
    OVER_LOOP: (
        "a part of the spring or the hysteresis that its laws do not have, or a slip of the bench",
        "see with --rank which model predicts best, and whether the loops lie on each other",
    ),
}
MIN_SHARE_OF_SHAPE = 0.01  # of what varies: a smaller one is no remark


@dataclass(frozen=True)
class Cause:
    """A likely mistake in a recording, or in the known numbers of its drive.

    Attributes:
        what: the mistake in words
        remedy: to do about it
        recording: without the mistake
        drive: likewise
    """

    what: str
    remedy: str
    recording: Recording
    drive: Drive


def explained(found: Fit, source: str) -> Check:
    """Return the check that a fit explains its measurement."""
    of_table = isinstance(found.experiment, FrictionTable)
    sizes = np.sqrt(np.mean(found.experiment.measured**2, axis=1)) if of_table else np.std(found.experiment.measured, axis=1)
    numbers = (unexplained(found) * sizes, sizes, allowed(found))
    channels = zip(found.experiment.channels, found.experiment.units, *(each.tolist() for each in numbers), strict=True)
    return error_left({name: Left(error, size, unit, limit) for name, unit, error, size, limit in channels}, source)


class Left(NamedTuple):
    """An error that a model leaves of a channel, and what it may be.

    Attributes:
        error: root mean square, in addition to noise
        size: of the channel: how it varies, or the torque of a table, which may vary by its noise alone
        unit: of both
        limit: share of the size that may be left [1]
    """

    error: float
    size: float
    unit: str
    limit: float

    @property
    def over_limit(self) -> float:
        """The error over what it may be [1]."""
        return self.error / max(self.limit * self.size, 1e-300)


def error_left(channels: Mapping[str, Left], source: str) -> Check:
    """Return the check that a model explains a measurement, which every kind has: by `explained`, or by data held out.

    Args:
        channels: what is left of each
        source: name of the file
    """
    left = [
        f"{name.replace('_', ' ')} {quantity(each.error, each.unit)}, of a signal of {quantity(each.size, each.unit)}"
        for name, each in channels.items()
        if each.over_limit > 1.0
    ]
    worst = max(channels.values(), key=lambda each: each.over_limit)
    return Check(
        "error left unexplained", source, worst.error, worst.limit * worst.size, worst.unit, bool(left),
        f"the model does not explain it: RMS error of {', '.join(left)}. Nothing is identified from it" if left else "",
        "look at the plot; see whether signs, units, sides, ratio and zeros are right",
    )  # fmt: skip


def only_if_explained(estimates: Iterable[FileEstimate], check: Check) -> tuple[FileEstimate, ...]:
    """Return estimates of a file; not identified if the check that its model explains it failed."""
    why = f"the model does not explain {check.source}" if check.failed else ""
    return tuple(replace(each, why=each.why or why) for each in estimates)


def unexplained(found: Fit) -> Array:
    """Return the share of each channel's variation that a fit leaves unexplained, but for white noise, shape (channels,).

    >>> import numpy as np, strainwave as sw
    >>> speed = np.linspace(1.0, 50.0, 20)
    >>> table = sw.Recording({"speed": speed, "torque": 0.02 + 3e-4 * speed}, {"speed": "rad/s", "torque": "N.m"})
    >>> law = sw.friction.Coulomb(coulomb=0.05, breakaway=0.05, viscous=1e-4)
    >>> found = sw.fit(sw.Gear(friction_input=law), table, ["friction_input.coulomb", "friction_input.viscous"])
    >>> bool(unexplained(found)[0] < 1e-6)
    True
    """
    if isinstance(found.experiment, FrictionTable):  # a constant torque varies by nothing but its noise
        share: Array = found.rms() / np.sqrt(np.mean(found.experiment.measured**2, axis=1))
        return share
    return left(found.experiment.measured, found.predicted)


def left(measured: Array, predicted: Array) -> Array:
    """Return the same of any prediction, shape (channels, n) like the measurement."""
    residual = measured - predicted
    misfit = np.sqrt(np.maximum(np.mean(residual**2, axis=1) - [noise_sigma(row) ** 2 for row in measured], 0.0))
    variation = np.std(measured, axis=1)
    return np.where(variation > 0.0, misfit / np.where(variation > 0.0, variation, 1.0), 0.0)


def allowed(found: Fit) -> Array:
    """Return the largest share of each channel that a fit may leave unexplained, shape (channels,)."""
    if isinstance(found.experiment, FrictionTable):
        return np.array([MAX_SHARE_OF_TORQUE])
    if isinstance(found.experiment, DriveLog):
        moving = [name.endswith(("_angle", "_speed")) for name in found.experiment.channels]
        return np.where(moving, MAX_SHARE_OF_MOTION, MAX_SHARE_OF_TORQUE)
    return np.array([MAX_SHARE_OF_LOOP])


def causes(recording: Recording, drive: Drive, columns: Mapping[str, str]) -> list[Cause]:
    """Return likely mistakes in a run of a drive, those first that let the drive as it stands come nearest to the measurement.

    Signs, units, sides, and the ratio of the gear. The drive is run once for each, not fitted. `columns` are the names in the
    file, by channel.
    """
    scored = []
    for cause in _likely(recording, drive, columns):
        try:
            log = DriveLog.of(cause.recording, cause.drive)
            zeros = np.array([nuisance.start for nuisance in log.nuisances])
            predicted, _ = log.predict(cause.drive, [], zeros)
        except (ValueError, FloatingPointError):  # such a log could not be, or not be run
            continue
        middle = np.mean(log.measured - predicted, axis=1, keepdims=True)
        scored.append((float(np.max(left(log.measured, predicted + middle))), cause))
    return [cause for _, cause in sorted(scored, key=lambda pair: pair[0])]


def _likely(recording: Recording, drive: Drive, columns: Mapping[str, str]) -> Iterator[Cause]:
    units = {name: recording.unit(name) for name in recording.names}
    for name in [name for name in units if name != "time"]:
        turned = recording.with_column(name, -1.0 * recording[name], units[name])
        yield Cause(f'the sign of "{name}" is reversed', f'multiply the column "{name}" by -1', turned, drive)
    for name, unit in units.items():
        for other in MISTAKEN_UNITS.get(unit, ()):
            scaled = recording.with_column(name, convert(1.0, other, unit) * recording[name], unit)
            remedy = f"state its unit: {as_option('unit', name, other)}"
            yield Cause(f'"{name}" is in {other}, not in {unit}', remedy, scaled, drive)
    for moves in ("angle", "speed"):
        names = {f"input_{moves}": f"output_{moves}", f"output_{moves}": f"input_{moves}"}
        if present := [name for name in names if name in recording]:
            swapped = f"the columns of {moves} are swapped"
            what = f'"{present[0]}" was measured at the other side' if len(present) == 1 else swapped
            remedy = " ".join(as_option("column", names[name], columns.get(name, name)) for name in present)
            columns_renamed = {names.get(name, name): recording[name] for name in units}
            renamed = Recording(columns_renamed, {names.get(name, name): units[name] for name in units}, recording.title)
            yield Cause(what, f"name the columns the other way: {remedy}", renamed, drive)
    if set(ENCODERS) <= units.keys():
        angles = [recording.values(name, "rad") for name in ENCODERS]
        slope = abs(np.polyfit(angles[1], angles[0], 1)[0]) if np.ptp(angles[1]) > 0.0 else 0.0
        ratio = abs(drive.gear.kinematics.ratio)
        if slope >= 1.0 and abs(slope / ratio - 1.0) >= MIN_RATIO_ERROR:
            yield Cause(
                f"the ratio of the gear is about {slope:.3g}, not {ratio:g}",
                f"start from a gear of ratio {round(slope)}, or give --constant ratio={round(slope)}",
                recording, drive.replace(gear=geared(drive.gear, round(slope))),
            )  # fmt: skip


# ---- Shape of residuals ----------------------------------------------------------------------------------------------


def has_shape(check: Check) -> bool:
    """True for a check of a shape that is there, and does not fail."""
    least = MIN_SHARE_OF_SHAPE / MAX_SHARE_OF_SHAPE * check.limit
    return check.name == SHAPE_OF_RESIDUALS and least < check.value and not check.failed


class Judged(NamedTuple):
    """Check of the shape of residuals, none for too few samples, and a remark if the shape is significant and does not fail."""

    checks: tuple[Check, ...] = ()
    remarks: tuple[str, ...] = ()


def judged_shape(
    residual: Array,
    abscissae: Mapping[str, Array],
    varies: float,
    unit: str,
    source: str,
    *,
    ordered: bool = False,
    biased: Callable[[str], Sequence[str]] | None = None,
) -> Judged:
    """Return the check that what a model leaves has no large shape, and a remark on one that does not fail.

    Args:
        residual: measured less modelled, in the order of the samples, shape (n,)
        abscissae: over which it may repeat, by their names in words, each of shape (n,)
        varies: root mean square of the signal about its mean
        unit: of both
        source: name of the file
        ordered: True if the samples are in the order of their only abscissa
        biased: returns the paths of the numbers that a shape over an abscissa moves by more than their uncertainty: a large
            shape fails if there are any; without it every large one fails
    """
    sizes = _sizes(residual, abscissae, ordered=ordered)
    if not sizes:
        return Judged()
    name = max(sizes, key=lambda each: sizes[each])
    size, limit = sizes[name], MAX_SHARE_OF_SHAPE * varies
    words = f"the residual has a shape over {name}: RMS {error_in_words(size, unit, varies)}"
    large, (missing, remedy) = size > limit, MISSING[name]
    numbers = biased(name) if large and biased is not None else ()
    failed = large and (biased is None or bool(numbers))
    words += f"; the model lacks {missing}" if large else ""
    moved = f", which moves {listed(numbers)} by more than the uncertainty" if numbers else ""
    check = Check(SHAPE_OF_RESIDUALS, source, size, limit, unit, failed, f"{words}{moved}" if failed else "", remedy)
    remark = f"{words}. What it moves is part of ±: {remedy}" if large else words
    return Judged((check,), (remark,) if MIN_SHARE_OF_SHAPE * varies < size and not failed else ())


def largest_shape(residual: Array, abscissae: Mapping[str, Array], varies: float = 0.0) -> str:
    """Return the abscissa over which a residual has its largest shape; empty if that is not significant, or too small to count.

    Without `varies` none is too small.

    One over the speed counts only if it is large enough to fail: torques over the speed resemble friction, so that an
    arbitrary one would move it far, and how far other laws of friction lie apart is known.

    Args:
        residual, abscissae, varies: as `judged_shape`
    """
    sizes = _sizes(residual, abscissae)
    name = max(sizes, key=lambda each: sizes[each], default="")
    least = MAX_SHARE_OF_SHAPE if name == OVER_SPEED else MIN_SHARE_OF_SHAPE
    return name if name and sizes[name] > least * varies else ""


def _sizes(residual: Array, abscissae: Mapping[str, Array], *, ordered: bool = False) -> dict[str, float]:
    """Return the size of the shape over each abscissa, 0 if it is not significant; without those of too few samples."""
    tried = {name: shape(residual, over, ordered=ordered) for name, over in abscissae.items()}
    return {name: each.size if each.chance < MAX_CHANCE_OF_SHAPE else 0.0 for name, each in tried.items() if each is not None}
