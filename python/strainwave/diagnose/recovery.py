"""Recovery of a misalignment from a record of a known drive: by its answer to a small error, then by runs with the estimate."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from strainwave.diagnose.actuator_ramp import ERROR, ActuatorRamp
from strainwave.diagnose.inversion import (
    COMBINE,
    ORDERS,
    MisalignmentEstimate,
    answer_per_error,
    covariance_by,
    inverted,
    less_run,
    measured_orders,
    runs_with_probe,
    slopes,
    stacked,
    to_point,
)
from strainwave.files.recording import Recording
from strainwave.presentation import Presented

Complex = NDArray[np.complex128]

COLUMNS = ("input_angle", "transmission_error", "current")
CORRECTION_RUNS = 2  # with the estimate; each corrects it


@dataclass(frozen=True)
class RecoveryModel(Presented):
    """A drive with two runs that determine its response to a kinematic error, without noise of its sensors.

    Attributes:
        ramp: the run
        straight: recording without any error, after the run-in
        probed: the same with an error of every order

    >>> import numpy as np
    >>> import strainwave as sw
    >>> ramp = sw.diagnose.ActuatorRamp.of(sw.load("tilt-actuator-lumped"), stroke=np.radians(60.0), duration=3.0)
    >>> model = sw.diagnose.RecoveryModel.of(ramp)
    >>> [round(float(size)) for size in np.abs(model.gain("current"))]  # A/rad, at orders 1 to 4
    [173, 454, 857, 1299]
    """

    ramp: ActuatorRamp
    straight: Recording
    probed: Recording

    @classmethod
    def of(cls, ramp: ActuatorRamp) -> RecoveryModel:
        """Run a drive without error and with a small one of all orders."""
        ((straight, probed),) = runs_with_probe(ramp, [{}], COLUMNS)
        return cls(ramp.without_noise(), straight, probed)

    def gain(self, column: str) -> Complex:
        """Return the answer over the error at each order [unit of the column / rad], shape (4,)."""
        return answer_per_error(self.straight, self.probed, column)

    def run(self, points: Sequence[tuple[float, float]], law: Any) -> list[Recording]:
        """Return runs with the shaft at some places m [m], after the run-in."""
        changes = [
            {f"{ERROR}.housing_eccentricity": float(np.hypot(*m)), f"{ERROR}.housing_direction": float(np.arctan2(m[1], m[0]))}
            for m in points
        ]
        runs = self.ramp.with_error(law).many(changes, COLUMNS)
        return [self.ramp.settled(runs.member(place)) for place in range(len(points))]


def recover(recording: Recording, column: str, model: RecoveryModel, law: Any) -> dict[str, MisalignmentEstimate]:
    """Return the misalignment that a record determines, for each way in which the lobes may share.

    Args:
        recording: with input_angle and the column, after the run-in
        column: from which m is estimated
        model: of the drive
        law: `Misalignment`, whose dimensions are kept

    Returns:
        Estimates by `combine`.

    >>> import numpy as np
    >>> import strainwave as sw
    >>> ramp = sw.diagnose.ActuatorRamp.of(sw.load("tilt-actuator-lumped"), stroke=np.radians(60.0), duration=3.0)
    >>> law, _ = sw.diagnose.wave_generator(ramp.drive)
    >>> record = ramp.settled(ramp.with_error(law.replace(housing_eccentricity=14e-6)).run())
    >>> model = sw.diagnose.RecoveryModel.of(ramp)
    >>> found = sw.diagnose.recover(record, "current", model, law)
    >>> min(found, key=lambda combine: found[combine].misfit)  # the lobe further out carries
    'max'
    """
    error = measured_orders(less_run(recording, model.straight, column), column).over(model.gain(column))
    estimates = {}
    for combine in COMBINE:
        own = law.replace(combine=combine)
        point, misfit = inverted(error, own)
        covariance = covariance_by(to_point(error, own, point), error.noise)
        m = (float(point[0]), float(point[1]))
        estimates[combine] = MisalignmentEstimate(column, combine, m, covariance, error.degrees, misfit)
    return estimates


def refined(
    estimates: Sequence[MisalignmentEstimate], recordings: Sequence[Recording], model: RecoveryModel, law: Any
) -> list[MisalignmentEstimate]:
    """Return the estimates for a drive whose answer depends on the size of the error: each is run, and corrected by the rest.

    Hysteresis and friction answer a small error otherwise than a large one. The corrections shrink by how far the answer to the
    probe is from that to the error itself, some per cent. Between the orders noise alone is left.

    Args:
        estimates: of `recover`, with one `combine`
        recordings: that determined each
        model: of the drive
        law: `Misalignment` with that `combine`

    >>> import numpy as np
    >>> import strainwave as sw
    >>> ramp = sw.diagnose.ActuatorRamp.of(sw.load("tilt-actuator-lumped"), stroke=np.radians(60.0), duration=3.0)
    >>> law, _ = sw.diagnose.wave_generator(ramp.drive)
    >>> record = ramp.settled(ramp.with_error(law.replace(housing_eccentricity=14e-6)).run())
    >>> model = sw.diagnose.RecoveryModel.of(ramp)
    >>> found = sw.diagnose.recover(record, "current", model, law)
    >>> best, = sw.diagnose.refined([found["max"]], [record], model, law)
    >>> round(1e6 * best.size, 1), best.contains((14e-6, 0.0))  # um
    (14.0, True)
    """
    best = list(estimates)
    for _ in range(CORRECTION_RUNS):
        runs = model.run([each.m for each in best], law)
        best = [corrected(*each, model, law) for each in zip(best, recordings, runs, strict=True)]
    return best


def corrected(
    estimate: MisalignmentEstimate, recording: Recording, run: Recording, model: RecoveryModel, law: Any
) -> MisalignmentEstimate:
    """Return the estimate, corrected in one step by the difference of the record from a run with it.

    Args:
        estimate: to correct
        recording: that determined it, or another of the same misalignment
        run: of the model with the estimate
        model: of the drive
        law: `Misalignment` with the `combine` of the estimate

    >>> import numpy as np
    >>> import strainwave as sw
    >>> ramp = sw.diagnose.ActuatorRamp.of(sw.load("tilt-actuator-lumped"), stroke=np.radians(60.0), duration=3.0)
    >>> law, _ = sw.diagnose.wave_generator(ramp.drive)
    >>> record = ramp.settled(ramp.with_error(law.replace(housing_eccentricity=14e-6)).run())
    >>> model = sw.diagnose.RecoveryModel.of(ramp)
    >>> first = sw.diagnose.recover(record, "current", model, law)["max"]
    >>> (run,) = model.run([first.m], law)
    >>> round(1e6 * sw.diagnose.corrected(first, record, run, model, law).size, 1)  # um
    14.0
    """
    column, point = estimate.column, np.array(estimate.m)
    error = measured_orders(less_run(recording, run, column), column).over(model.gain(column))
    matrix = to_point(error, law, point)
    step = matrix @ stacked(error.values)
    rest = (stacked(error.values) - slopes(law, point) @ step) / np.tile(error.noise, 2)
    misfit = float(rest @ rest) / (2 * len(ORDERS) - 2)
    m = (float(point[0] + step[0]), float(point[1] + step[1]))
    covariance = covariance_by(matrix, error.noise)
    return MisalignmentEstimate(column, estimate.combine, m, covariance, error.degrees, misfit)
