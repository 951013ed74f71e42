"""Least squares on any free parameters of a model, with exact derivatives, and what the data say about each of them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from strainwave import Drive, arguments
from strainwave._core import Gear
from strainwave.equality import ComparedByFields
from strainwave.files.recording import Recording
from strainwave.identification.experiments.drive_log import DriveLog
from strainwave.identification.experiments.experiment import Experiment
from strainwave.identification.experiments.friction_table import FrictionTable
from strainwave.identification.experiments.torsion_loop import TorsionLoop
from strainwave.identification.fitting.estimate import Estimate
from strainwave.identification.fitting.problem import Problem
from strainwave.messages import shortened
from strainwave.parameters import Parameter, parameters
from strainwave.simulation.resolution import warn_of_bristles

Array = NDArray[np.float64]
TOLERANCE = 1e-10  # relative, of the cost and of the unknowns; Gauss-Newton steps end far below it where residuals are small
ROUGH = 1e-3  # the same of the pass that finds how the channels weigh


@dataclass(frozen=True, eq=False)
class Fit(ComparedByFields):
    """A model fitted to an experiment.

    Attributes:
        model: the model with the fitted numbers
        experiment: what it was fitted to
        estimates: the free parameters, then the unknowns of the measurement
        covariance: of the estimates, shape (p, p), infinite in directions that the data do not determine
        predicted: what the model predicts, shape (channels, n)
        training: which of the n samples took part, shape (n,)
        evaluations: how often the model was run
    """

    model: Any
    experiment: Experiment
    estimates: tuple[Estimate, ...]
    covariance: Array
    predicted: Array
    training: NDArray[np.bool_]
    evaluations: int

    @property
    def gear(self) -> Gear:
        """The fitted gear."""
        gear: Gear = self.model.gear if isinstance(self.model, Drive) else self.model
        return gear

    @cached_property
    def correlation(self) -> Array:
        """Correlation of the estimates, shape (p, p); not-a-number where the data do not tell."""
        sigma = np.sqrt(np.diag(self.covariance))
        with np.errstate(invalid="ignore"):
            correlation: Array = self.covariance / np.outer(sigma, sigma)
        return correlation

    @property
    def residuals(self) -> Array:
        """Measured less predicted, shape (channels, n)."""
        return self.experiment.measured - self.predicted

    def rms(self, *, held_out: bool = False) -> Array:
        """Root mean square residual of each channel over the samples that took part, or over those that did not."""
        chosen = ~self.training if held_out else self.training
        return (
            np.sqrt(np.mean(self.residuals[:, chosen] ** 2, axis=1)) if chosen.any() else np.full(len(self.residuals), np.nan)
        )

    def summary(self) -> str:
        """A table of the estimates and the residuals, to print."""
        lines = [f"{'parameter':44} {'start':>12} {'value':>14} {'sigma':>10}  unit"]
        for e in self.estimates:
            note = "  at its limit" if e.at_limit else "" if np.isfinite(e.sigma) else "  not determined by the data"
            lines.append(f"{e.path:44} {e.start:12.5g} {e.value:14.7g} {e.sigma:10.2g}  {e.unit}{note}")
        for name, unit, trained, held in zip(
            self.experiment.channels, self.experiment.units, self.rms(), self.rms(held_out=True), strict=True
        ):
            held_out = "" if np.isnan(held) else f", on data held out {held:.4g} {unit}"
            lines.append(f"residual of {name}: {trained:.4g} {unit} rms{held_out}")
        return "\n".join(lines)


def fit(
    model: Gear | Drive,
    recording: Recording | Experiment,
    free: Sequence[str],
    *,
    channels: Sequence[str] | None = None,
    dt: float | None = None,
    initial: Mapping[str, float] | None = None,
    training: NDArray[np.bool_] | None = None,
    loss: Literal["linear", "soft_l1"] = "linear",
) -> Fit:
    """Fits free parameters of a model to a measurement by least squares.

    The Jacobian comes from dual numbers through the same code that simulates, so it is exact to rounding. Channels are
    weighed by their residuals, found in a first pass. The covariance accounts for residuals that hang together in time.

    Args:
        model: a drive, for a log over time; a gear, for a friction table or a torsion loop
        recording: time, command and outputs (a drive log); speed and torque (a friction table, input side); twist and
            torque, or input_angle and input_torque (a torsion loop); or an experiment made of one
        free: paths of parameters, as "gear.friction_input.coulomb" of a drive or "friction_input.coulomb" of a gear;
            "hysteresis.stiffness[2]" is one element, "hysteresis.stiffness" all of them
        channels: columns of a drive log to compare; all that a simulation has too if not given
        dt: largest step of the simulation [s], shorter where the drive needs it; 0.2 ms if not given
        initial: of a drive log that does not begin at rest, what is known of its beginning, as for `simulate`; encoders then
            count from where they say
        training: which samples take part, shape (n,); all if not given
        loss: "linear", or "soft_l1" where outliers are to be feared

    Returns:
        the fitted model with its uncertainty

    Raises:
        TypeError: an argument is not of its kind
        ValueError: an unknown path, too few samples, a recording without the columns needed, a model that is not valid over
            the measurement from the start
        FloatingPointError: at the start the model diverges, or its derivatives grow beyond all numbers

    Warns:
        RuntimeWarning: the bristles of the drive found are too stiff for `dt`

    >>> import numpy as np, strainwave as sw
    >>> truth = sw.Gear(friction_input=sw.friction.Coulomb(coulomb=0.02, breakaway=0.02, viscous=3e-4))
    >>> speed = np.linspace(1.0, 50.0, 20)
    >>> table = sw.Recording({"speed": speed, "torque": truth.friction_input.steady(speed)},
    ...                      {"speed": "rad/s", "torque": "N.m"})
    >>> start = truth.replace(friction_input=truth.friction_input.replace(coulomb=0.05, viscous=1e-4))
    >>> found = sw.fit(start, table, ["friction_input.coulomb", "friction_input.viscous"])
    >>> round(found.gear.friction_input.coulomb, 9), round(found.gear.friction_input.viscous, 9)
    (0.02, 0.0003)
    """
    _check_kinds(model, recording, loss)
    if initial is not None and not (isinstance(model, Drive) and isinstance(recording, Recording)):
        raise TypeError("initial is the beginning of a drive log: give a drive and a recording, or leave it out")
    experiment = experiment_of(model, recording, channels, dt, initial) if isinstance(recording, Recording) else recording
    places = parameters("free", model, free)
    _check_branch(experiment, places)
    problem = Problem(model, experiment, places, training)
    start = problem.start()
    _check_motion(experiment, problem.predict(start)[0])
    weights = 1.0 / _scale(experiment.measured[:, problem.training])
    for tolerance in (TOLERANCE,) if len(experiment.channels) == 1 else (ROUGH, TOLERANCE):
        found = problem.solve(start, weights, loss, tolerance)
        residual = (experiment.measured - problem.predict(found)[0])[:, problem.training]
        weights = 1.0 / np.maximum(np.sqrt(np.mean(residual**2, axis=1, keepdims=True)), 1e-12 * _scale(experiment.measured))
        start = found
    estimates, covariance = problem.estimates(found, weights)
    predicted, _ = problem.predict(found)
    result = Fit(problem.model_with(found), experiment, estimates, covariance, predicted, problem.training, problem.evaluations)
    if isinstance(experiment, DriveLog):
        warn_of_bristles(result.model, experiment.step(result.model))
    return result


def _check_kinds(model: object, recording: object, loss: object) -> None:
    if not isinstance(model, Gear | Drive):
        raise TypeError(f"model must be a Gear or a drive, not {shortened(model)}")
    if not isinstance(recording, Recording) and not hasattr(recording, "predict"):
        raise TypeError(f"recording must be a Recording, or an experiment made of one, not {shortened(recording)}")
    arguments.one_of("loss", loss, ("linear", "soft_l1"))


def _check_branch(experiment: Experiment, places: Sequence[Parameter]) -> None:
    """Of a path that never turns back, a fit can take the whole for the spring, or for hysteresis."""
    wrong = [place.path for place in places if not place.path.startswith("stiffness.")]
    if wrong and isinstance(experiment, TorsionLoop) and experiment.single_branch:
        raise ValueError(
            f"the torsion loop has one branch only: its twist never turns back, so {wrong[0]} cannot be told from stiffness; "
            "free parameters of the stiffness alone, or measure a loop that loads and unloads"
        )


def _check_motion(experiment: Experiment, predicted: Array) -> None:
    """Where the model stands still, nothing changes with its parameters, and a fit would give its start back."""
    if isinstance(experiment, DriveLog) and experiment.stands_still(predicted):
        raise ValueError(
            "the model does not move under this command, though the drive did: nothing can be fitted from there. Start with "
            "less friction, as in drive.replace(gear=…) with a smaller coulomb and breakaway; or see whether the unit of the "
            "command is right"
        )


def experiment_of(
    model: Gear | Drive,
    recording: Recording,
    channels: Sequence[str] | None = None,
    dt: float | None = None,
    initial: Mapping[str, float] | None = None,
) -> Experiment:
    """The experiment that a recording holds, told by its columns and the kind of model.

    Raises:
        ValueError: the columns fit no experiment
    """
    if isinstance(model, Drive):
        return DriveLog.of(recording, model, channels, dt, initial)
    if {"speed", "torque"} <= set(recording.names):
        return FrictionTable.of(recording)
    if {"twist", "torque"} <= set(recording.names) or {"input_angle", "input_torque"} <= set(recording.names):
        return TorsionLoop.of(recording, model)
    raise ValueError(
        f"columns {', '.join(recording.names)} are no experiment on a gear; a friction table has speed and torque, "
        "a torsion loop twist and torque or input_angle and input_torque"
    )


def _scale(measured: Array) -> Array:
    """How large each channel is, shape (channels, 1)."""
    spread = np.std(measured, axis=1, keepdims=True)
    size = np.max(np.abs(measured), axis=1, keepdims=True)
    return np.where(spread > 0.0, spread, np.where(size > 0.0, size, 1.0))
