"""Least squares on any free parameters of a model, with exact derivatives, and what the data say about each of them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from strainwave import Drive, _core, arguments
from strainwave._core import Gear
from strainwave.equality import ComparedByFields
from strainwave.files.recording import Recording
from strainwave.identify.experiment import DriveLog, Experiment, FrictionTable, TorsionLoop
from strainwave.messages import shortened
from strainwave.parameters import Parameter, parameters
from strainwave.simulation.resolution import warn_of_bristles

Array = NDArray[np.float64]
ONE_SIGMA = 0.6826894921370859  # share of a normal distribution within one standard deviation
TOLERANCE = 1e-10  # relative, of the cost and of the unknowns; Gauss-Newton steps end far below it where residuals are small
ROUGH = 1e-3  # the same of the pass that finds how the channels weigh
TRIALS = 60  # steps that a fit may try; those that explain their data end after ten to forty
DEGENERATE = 1e-10  # singular values below this share of the largest carry no information


@dataclass(frozen=True, eq=False)
class Estimate(ComparedByFields):
    """One parameter as the data see it.

    Attributes:
        path: where it stands in the model
        unit: its unit
        start: value before the fit
        value: value after it
        sigma: half the width of the interval that holds the true value with 68 %, by Student's distribution: the standard
            deviation where samples are many; infinite where the data do not tell
        at_limit: whether the fit ended at a limit of the parameter
        freedom: independent samples beyond the number of unknowns [1]
    """

    path: str
    unit: str
    start: float
    value: float
    sigma: float
    at_limit: bool
    freedom: float = np.inf

    def interval(self, confidence: float = 0.95) -> tuple[float, float]:
        """The interval that holds the true value with this probability, if the model is right.

        >>> low, high = Estimate("friction_input.coulomb", "N.m", 0.1, 0.02, 0.001, False, freedom=4.0).interval()
        >>> round(low, 4), round(high, 4)
        (0.0176, 0.0224)
        """
        confidence = arguments.number("confidence", confidence, low=0.0, high=1.0)
        reach = self.sigma * student(confidence, self.freedom) / student(ONE_SIGMA, self.freedom)
        return self.value - reach, self.value + reach


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
    problem = _Problem(model, experiment, places, training)
    start = problem.start()
    _check_motion(experiment, problem.predict(start)[0])
    weights = 1.0 / _scale(experiment.measured[:, problem.training])
    for tolerance in (TOLERANCE,) if len(experiment.channels) == 1 else (ROUGH, TOLERANCE):
        found = problem.solve(start, weights, loss, tolerance)
        residual = (experiment.measured - problem.predict(found)[0])[:, problem.training]
        weights = 1.0 / np.maximum(np.sqrt(np.mean(residual**2, axis=1, keepdims=True)), 1e-12 * _scale(experiment.measured))
        start = found
    result = problem.fit(found, weights)
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


class _Problem:
    """Least squares in numbers scaled to their size."""

    def __init__(
        self,
        model: Gear | Drive,
        experiment: Experiment,
        places: list[Parameter],
        training: NDArray[np.bool_] | None,
    ) -> None:
        self.model, self.experiment, self.places = model, experiment, places
        n = experiment.measured.shape[1]
        self.training = np.ones(n, bool) if training is None else np.asarray(training)
        if self.training.dtype != bool:
            raise TypeError(f"training must hold True or False for each sample, not {self.training.dtype}")
        if self.training.shape != (n,):
            raise ValueError(f"training has shape {self.training.shape}, the measurement has {n} samples")
        unknowns = len(places) + len(experiment.nuisances)
        if unknowns == 0:
            raise ValueError("free must name at least one parameter: nothing else of this measurement is unknown")
        if self.training.sum() * len(experiment.channels) <= unknowns:
            raise ValueError(f"{self.training.sum()} samples cannot determine {unknowns} unknowns")
        self.evaluations = 0
        self._last: tuple[bytes, tuple[Array, Array]] | None = None

    def start(self) -> Array:
        """Where the fit starts, within the limits of its parameters."""
        inside = [min(max(p.value, p.low), p.high) for p in self.places]
        return np.array(inside + [nuisance.start for nuisance in self.experiment.nuisances])

    def model_with(self, x: Array) -> Any:
        numbers = [value for _, value, *_ in _core.parameters(self.model)]
        for place, value in zip(self.places, x, strict=False):
            numbers[place.number] = float(value)
        return _core.with_numbers(self.model, numbers)

    def predict(self, x: Array) -> tuple[Array, Array]:
        """Predictions and derivatives; the last ones are remembered, as solvers ask for them one after the other."""
        key = x.tobytes()
        if self._last is None or self._last[0] != key:
            self.evaluations += 1
            numbers = [place.number for place in self.places]
            nuisances = x[len(self.places) :]
            predicted, slopes = self.experiment.predict(self.model_with(x), numbers, nuisances)
            if not (np.isfinite(predicted).all() and np.isfinite(slopes).all()):
                raise FloatingPointError(
                    "what the model predicts, or its derivatives, grow beyond all numbers: look whether units and sides of the "
                    "measurement are right, and the numbers of the gear to start from"
                )
            self._last = key, (predicted, slopes)
        return self._last[1]

    def solve(self, start: Array, weights: Array, loss: Literal["linear", "soft_l1"], tolerance: float) -> Array:
        if len(start) == 0:
            return start
        from scipy.optimize import least_squares

        free_ends = [(-np.inf, np.inf)] * len(self.experiment.nuisances)
        low, high = np.array([(p.low, p.high) for p in self.places] + free_ends).reshape(-1, 2).T
        inside = np.clip(start, low, high)

        def residuals(x: Array) -> Array:
            try:
                predicted, _ = self.predict(x)
            except (ValueError, FloatingPointError):  # out of the domain, or diverged: SciPy takes a quarter of such a step
                predicted = np.full_like(self.experiment.measured, np.inf)
            return ((predicted - self.experiment.measured) * weights)[:, self.training].ravel()

        def jacobian(x: Array) -> Array:
            _, slopes = self.predict(x)
            return (slopes * weights)[:, :, self.training].reshape(len(x), -1).T

        with np.errstate(over="ignore"):  # SciPy takes a smaller step where its model of the residuals is infinite
            solution = least_squares(
                residuals,
                inside,
                jac=jacobian,
                bounds=(low, high),
                x_scale="jac",
                loss=loss,
                xtol=tolerance,
                ftol=tolerance,
                gtol=tolerance,
                max_nfev=TRIALS,
            )
        return np.asarray(solution.x)

    def fit(self, x: Array, weights: Array) -> Fit:
        predicted, slopes = self.predict(x)
        residual = (self.experiment.measured - predicted)[:, self.training] * weights
        jacobian = (slopes * weights)[:, :, self.training].reshape(len(x), -1).T
        covariance, freedom = _covariance(jacobian, residual)
        sigma = np.sqrt(np.diag(covariance))
        estimates = [
            Estimate(p.path, p.unit, p.value, float(v), float(s), bool(v <= p.low or v >= p.high), freedom)
            for p, v, s in zip(self.places, x, sigma, strict=False)
        ]
        estimates += [
            Estimate(nuisance.name, nuisance.unit, nuisance.start, float(v), float(s), False, freedom)
            for nuisance, v, s in zip(self.experiment.nuisances, x[len(self.places) :], sigma[len(self.places) :], strict=True)
        ]
        return Fit(
            self.model_with(x),
            self.experiment,
            tuple(estimates),
            covariance,
            predicted,
            self.training,
            self.evaluations,
        )


@np.errstate(over="ignore")  # a variance beyond all numbers is infinite
def _covariance(jacobian: Array, residual: Array) -> tuple[Array, float]:
    """Covariance of the unknowns, and the degrees of freedom it rests on.

    Variance of the residuals over degrees of freedom, times how many samples hang together: residuals that are no white
    noise tell less than their number. Each unknown's is that for residuals of equal size or that for unequal ones, HC3 of
    MacKinnon and White (1985), whichever is larger. Widened, where samples are few, so that one standard deviation holds the
    true value as often as that of a normal distribution (Student 1908). Infinite variance where some direction that an unknown
    takes part in leaves the residuals unchanged.
    """
    size = np.linalg.norm(jacobian, axis=0)
    size = np.where(size > 0.0, size, 1.0)
    left, singular, directions = np.linalg.svd(jacobian / size, full_matrices=False)
    dead = singular <= DEGENERATE * singular.max(initial=0.0)
    together = max(correlation_length(row) for row in residual)
    freedom = max(residual.size / together - len(size), 1.0)
    root = directions.T * np.where(dead, 0.0, 1.0 / np.where(dead, 1.0, singular))
    even = float(np.sum(residual**2)) / max(residual.size - len(size), 1)
    leverage = np.minimum(np.sum(left[:, ~dead] ** 2, axis=1), 1.0 - 1.0 / residual.size)
    uneven = np.sum((root @ (left.T * (residual.ravel() / (1.0 - leverage)))) ** 2, axis=1)
    covariance = even * (root @ root.T)
    wider = np.sqrt(np.maximum(uneven / np.where(uneven > 0.0, np.diag(covariance), 1.0), 1.0))
    covariance *= together * student(ONE_SIGMA, freedom) ** 2 * np.outer(wider / size, wider / size)
    undetermined = (np.abs(directions[dead]) > 1e-6).any(axis=0) | ~np.any(jacobian, axis=0)
    covariance[undetermined, undetermined] = np.inf
    return covariance, freedom


def student(confidence: float, freedom: float) -> float:
    """Half the width of the interval that holds Student's variable with this probability.

    >>> round(student(0.95, 4.0), 3)
    2.776
    """
    from scipy.special import stdtrit

    return float(stdtrit(freedom, 0.5 + 0.5 * confidence))


def correlation_length(residual: Array) -> float:
    """Integrated autocorrelation time in samples, summed over Sokal's window; 1 for white noise.

    Sokal, "Monte Carlo methods in statistical mechanics" (1997), section 3.
    """
    centred = residual - residual.mean()
    power = np.abs(np.fft.rfft(centred, 2 * len(centred))) ** 2
    if power.sum() == 0.0:
        return 1.0
    correlation = np.fft.irfft(power)[: len(centred)]
    time = 2.0 * np.cumsum(correlation / correlation[0]) - 1.0
    window = np.arange(len(time)) >= 5.0 * time
    return float(max(1.0, time[np.argmax(window)] if window.any() else time[-1]))
