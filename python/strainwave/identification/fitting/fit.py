"""Least squares on any free parameters of a model, with exact derivatives, and the uncertainty of each of them."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from strainwave import Drive, _core, arguments, typeset
from strainwave._core import Gear
from strainwave.equality import ComparedByFields
from strainwave.files.entries import Entry
from strainwave.files.recording import Recording
from strainwave.identification.experiments.drive_log import DriveLog, DrivenLog, driven
from strainwave.identification.experiments.experiment import Experiment
from strainwave.identification.experiments.friction_table import FrictionTable
from strainwave.identification.experiments.torsion_loop import TorsionLoop
from strainwave.identification.fitting.loss_functions import LOSSES, LossName, Squared
from strainwave.identification.fitting.problem import FitRecord, Problem, Weights
from strainwave.identification.fitting.unknowns import OF_RECORD, Estimate, FitParameters, Prior, plan
from strainwave.messages import in_a_sentence, listed, quoted, shortened
from strainwave.presentation import Pictured, Presented, Row, counted
from strainwave.progress import Progress, in_turn
from strainwave.simulation.resolution import warn_of_bristles
from strainwave.simulation.threads import one_thread_of_algebra
from strainwave.statistics.residuals import correlation_length

if TYPE_CHECKING:
    from matplotlib.figure import Figure

Array = NDArray[np.float64]
EXACT_TOLERANCE = 1e-10  # relative, of the cost and of the unknowns; Gauss-Newton steps on small residuals end far below it
HELD_OUT = ", held out"  # behind the name of an error
ROUGH_TOLERANCE = 1e-3  # likewise, of fits that are compared, and of passes that determine the weights of the channels
REFIT_TOLERANCE = 1e-6  # likewise, of fits to changed data or with a parameter held
MAX_ROUGH_PASSES = 4  # of one step each, after the first
MAX_EXACT_PASSES = 5  # exact ones
MAX_START_SIGMA = 3.0  # standard deviations of a prior: an unknown that ended farther off starts at the prior
MAX_WEIGHT_CHANGE = 0.2  # relative, of a pass after which no other one follows
MAX_SYMMETRIC_SIGMA = 0.2  # standard deviation over the distance to a limit; with a larger one the interval is not symmetric
OF_GEAR = (FrictionTable, TorsionLoop)  # experiments on a gear, also if the model is a drive
ABSCISSAE = ((FrictionTable, "speed", "rad/s"), (TorsionLoop, "twist", "rad"))  # of others time
OF_GEAR_COLUMNS = ({"speed", "torque"}, {"twist", "torque"}, {"input_angle", "input_torque"})


@dataclass(frozen=True, eq=False)
class RecordFit(ComparedByFields, Presented):
    """Result of a fit for one record.

    Attributes:
        name: of the record
        model: the model with the numbers that were fitted to this record
        experiment: the measurement
        predicted: prediction of the model, shape (channels, n)
        training: True for samples that took part, shape (n,)
    """

    name: str
    model: Any
    experiment: Experiment
    predicted: Array
    training: NDArray[np.bool_]

    @property
    def residuals(self) -> Array:
        """Measured less predicted, shape (channels, n)."""
        return self.experiment.measured - self.predicted

    def rms(self, *, held_out: bool = False) -> Array:
        """Return the root mean square residual of each channel over the samples that took part, or over those that did not."""
        residuals = self.residuals[:, ~self.training if held_out else self.training]
        return np.sqrt(np.mean(residuals**2, axis=1)) if residuals.size else np.full(len(residuals), np.nan)

    def curves(self, sigmas: Array | None = None) -> tuple[Recording, ...]:
        """Return the curves of each channel, as `Fit.curves`.

        Args:
            sigmas: standard deviation of the prediction, shape (channels, n); no `sigma` where it is not given or infinite
        """
        experiment: Any = self.experiment
        is_log = not isinstance(experiment, OF_GEAR)
        over, unit = (
            ("time", "s") if is_log else ("speed", "rad/s") if isinstance(experiment, FrictionTable) else ("twist", "rad")
        )
        every = []
        for place, (channel, channel_unit) in enumerate(zip(experiment.channels, experiment.units, strict=True)):
            columns = {over: getattr(experiment, over), channel: experiment.measured[place], "modelled": self.predicted[place]}
            units = {over: unit, channel: channel_unit, "modelled": channel_unit, "held_out": "1"}
            columns["held_out"] = (~self.training).astype(float)
            if sigmas is not None and np.isfinite(sigmas[place]).all():
                columns["sigma"], units["sigma"] = sigmas[place], channel_unit
            every.append(Recording(columns, units))
        return tuple(every)


@dataclass(frozen=True, eq=False)
class Fit(ComparedByFields, Pictured):
    """A model fitted to one record or several.

    Attributes:
        model: the model with the fitted numbers; of parameters that each record has for itself, those of the first
        estimates: the free parameters, those tied to them, then the unknowns of the measurements; the name of a record
            follows an @ if an estimate belongs to one record alone
        covariance: of the estimates, shape (p, p), infinite in directions that the data do not determine
        parts: of each record its experiment, model, prediction and residuals
        plan: the unknowns and their priors
        loss: name of the loss function
        evaluations: count of the runs of the model

    >>> import numpy as np
    >>> import strainwave as sw
    >>> speed = np.linspace(1.0, 50.0, 60)
    >>> torque = 0.02 + 3e-4 * speed + 1e-4 * np.random.default_rng(0).normal(size=60)
    >>> table = sw.Recording({"speed": speed, "torque": torque}, {"speed": "rad/s", "torque": "N.m"})
    >>> gear = sw.Gear(friction_input=sw.friction.Coulomb(coulomb=0.01, breakaway=0.01))
    >>> print(sw.fit(gear, table, ["friction_input.coulomb", "friction_input.viscous"]))
    Fit: 2 parameters, rms 88.3 µN·m
      friction_input.coulomb     0.019979 ± 0.000027  N·m        start 0.01
      friction_input.viscous  (301.12 ± 0.99) × 10⁻⁶  N·m·s/rad  start 0
      rms of torque                    88.299 × 10⁻⁶  N·m
    """

    model: Any
    estimates: tuple[Estimate, ...]
    covariance: Array
    parts: tuple[RecordFit, ...]
    plan: FitParameters
    loss: LossName
    evaluations: int

    @property
    def gear(self) -> Gear:
        """Fitted gear."""
        gear: Gear = self.model.gear if isinstance(self.model, Drive) else self.model
        return gear

    @cached_property
    def correlation(self) -> Array:
        """Correlation of the estimates, shape (p, p); not a number where the data do not determine it."""
        sigma = np.sqrt(np.diag(self.covariance))
        with np.errstate(invalid="ignore"):
            correlation: Array = self.covariance / np.outer(sigma, sigma)
        return correlation

    @property
    def experiment(self) -> Experiment:
        """Experiment of the only record."""
        return self._only.experiment

    @property
    def predicted(self) -> Array:
        """Prediction of the only record, shape (channels, n)."""
        return self._only.predicted

    @property
    def training(self) -> NDArray[np.bool_]:
        """True for samples of the only record that took part, shape (n,)."""
        return self._only.training

    @property
    def residuals(self) -> Array:
        """Measured less predicted of the only record, shape (channels, n)."""
        return self._only.residuals

    def rms(self, *, held_out: bool = False) -> Array:
        """Return the root mean square residual of each channel of the only record, in its unit, shape (channels,).

        Args:
            held_out: whether over the samples that took no part in the fit; not a number if there are none

        Raises:
            ValueError: the fit is to several records; each of its `parts` has its own
        """
        return self._only.rms(held_out=held_out)

    @property
    def _only(self) -> RecordFit:
        if len(self.parts) > 1:
            raise ValueError(f"the fit is to {len(self.parts)} records; take it from one of its parts, in their order")
        return self.parts[0]

    @property
    def doubts(self) -> tuple[str, ...]:
        """Doubts of the estimates or their standard deviations, in words, as far as this fit shows them.

        A fit that ended at the wrong one of several minima need not show it: `minima` looks for others.
        """
        return *self._asymmetric(), *self._correlated()

    def _asymmetric(self) -> Iterator[str]:
        """Yield parameters whose intervals come near a limit, where no cost is a parabola."""
        for unknown, estimate in zip(self.plan.unknowns, self.estimates, strict=False):
            limit = next((each for each in (unknown.low, unknown.high) if np.isfinite(each)), None)
            if limit is None or estimate.at_limit or not np.isfinite(estimate.sigma):
                continue
            share = estimate.sigma / abs(estimate.value - limit)
            if share > MAX_SYMMETRIC_SIGMA:
                yield (
                    f"{estimate.path} is known to {100.0 * share:.0f} % only: its interval is not symmetric; "
                    f'sw.identification.profile(fit, "{estimate.path}") gives it'
                )

    def _correlated(self) -> Iterator[str]:
        """Yield channels whose residuals are no white noise."""
        for part in self.parts:
            of = f"{OF_RECORD}{part.name}" if len(self.parts) > 1 else ""
            for name, left in zip(part.experiment.channels, part.residuals, strict=True):
                length = correlation_length(left[part.training])
                if length > 1.0:
                    yield (
                        f"the residuals of {name}{of} correlate over {length:.2g} samples: the sensor drifts, the model "
                        "lacks something, or the fit ended at the wrong minimum; look at the residuals, and "
                        "try sw.identification.minima(fit)"
                    )

    def part(self, record: str | None = None) -> RecordFit:
        """Return the part of a record by its name, the first one if no name is given.

        Raises:
            ValueError: no record has that name
            TypeError: the name is no text
        """
        if record is None:
            return self.parts[0]
        names = [part.name for part in self.parts]
        if arguments.text("record", record) not in names:
            raise ValueError(f"no record {quoted(record)}; there are {listed(names)}")
        return self.parts[names.index(record)]

    def curves(self, record: str | None = None) -> tuple[Recording, ...]:
        """Return measurement and prediction of each channel of a record, to be drawn.

        Args:
            record: its name, as in `parts`; the first one if not given

        Returns:
            Of each channel: speed, twist or time; the channel, under its name; `modelled`, the prediction; `held_out`, 1 where
            a sample took no part in the fit; and of a fit to one record `sigma`, the standard deviation of `modelled` by that
            of the estimates, if the data determine all of them

        The standard deviation is that of a linear function of the estimates, the root of J C J^T, with J the derivatives of the
        prediction and C the covariance of the estimates (JCGM 100:2008, eq. 13).

        Raises:
            ValueError: no record has that name
            TypeError: the name is no text
        """
        return self.part(record).curves(self._sigmas() if len(self.parts) == 1 else None)

    def _sigmas(self) -> Array:
        """Return the standard deviation of the prediction of the first record, shape (channels, n)."""
        part, own = self.parts[0], {each.path: place for place, each in enumerate(self.estimates)}
        zeros = [each.name for each in part.experiment.nuisances]
        numbers = {path: number for number, (path, *_) in enumerate(_core.parameters(part.model))}
        free = [path for path in own if path in numbers and path not in zeros]
        nuisances = np.array([self.estimates[own[name]].value for name in zeros])
        _, slopes = part.experiment.predict(part.model, [numbers[path] for path in free], nuisances)
        places = [own[path] for path in (*free, *zeros)]
        covariance = self.covariance[np.ix_(places, places)]
        with np.errstate(invalid="ignore"):  # infinite where the data do not determine an estimate
            variance: Array = np.einsum("icn,ij,jcn->cn", slopes, covariance, slopes, optimize=True)
        return np.sqrt(np.clip(variance, 0.0, None))

    def plot(self, record: str | None = None) -> Figure:
        """Return a figure of each channel of a record: measured and predicted, and the residual below.

        Samples that were held out are shaded. Dashed lines contain 95 % of the residuals; the band is the interval of 95 % of
        the prediction by the covariance of the estimates.

        Args:
            record: its name, as in `parts`; the first one if not given

        Raises:
            ValueError: no record has that name
            TypeError: the name is no text
        """
        from strainwave.identification.results.pictures import picture_of, pictures_figure

        part = self.part(record)
        channels = in_a_sentence([channel.replace("_", " ") for channel in part.experiment.channels])
        of = f", {part.name}" if len(self.parts) > 1 else ""
        return pictures_figure([picture_of(curves) for curves in self.curves(record)], f"Measured and predicted {channels}{of}")

    def plot_residual_spectrum(self, record: str | None = None) -> Figure:
        """Return a figure of the amplitude spectra of a log: of each channel measured, and of its residual.

        A line of the residual at a frequency shows what the model lacks there: a vibration, an order of the gear, mains. Uneven
        time is put on an even clock by interpolation.

        Args:
            record: its name, as in `parts`; the first one if not given

        Raises:
            ValueError: no record has that name, or the record has no time
            TypeError: the name is no text
        """
        from strainwave.identification.results.pictures import spectrum_figure

        part = self.part(record)
        title = f"Spectrum of the residual{f', {part.name}' if len(self.parts) > 1 else ''}"
        return spectrum_figure(part.experiment, part.residuals, title)

    def _headline(self) -> str:
        left = list(self._left())
        held_out = [row for row in left if row.name.endswith(HELD_OUT)]
        error = ", ".join(typeset.quantity(row.value, row.unit) for row in held_out or left if isinstance(row.value, float))
        where = HELD_OUT if held_out else ""
        open_ones = sum(not np.isfinite(each.sigma) for each in self.estimates)
        verdict = f", {open_ones} not determined" if open_ones else ""
        doubts = f", {counted(len(self.doubts), 'doubt')}" if self.doubts else ""
        return f"{counted(len(self.estimates), 'parameter')}{verdict}, rms {error}{where}{doubts}"

    def _rows(self) -> Iterator[Row]:
        for each in self.estimates:
            state = ", at its limit" if each.at_limit else "" if np.isfinite(each.sigma) else ", not determined by the data"
            yield Row(each.path, each.value, each.unit, each.sigma, f"start {typeset.number(each.start, 3)}{state}")
        yield from self._left()

    def _left(self) -> Iterator[Row]:
        """Yield the residual of each channel of each record, root mean square, fitted and held out."""
        for part in self.parts:
            of = f"{OF_RECORD}{part.name}" if len(self.parts) > 1 else ""
            for held_out, where in ((False, ""), (True, HELD_OUT)):
                for name, unit, rms in zip(
                    part.experiment.channels, part.experiment.units, part.rms(held_out=held_out).tolist(), strict=True
                ):
                    if np.isfinite(rms):
                        yield Row(f"rms of {name}{of}{where}", rms, unit)

    def _remarks(self) -> Iterator[str]:
        return iter(self.doubts)


Measured = Recording | Experiment
Mask = NDArray[np.bool_] | None


def fit(
    model: Gear | Drive,
    recordings: Measured | Sequence[Measured] | Mapping[str, Measured],
    free: Sequence[str],
    *,
    channels: Sequence[str] | None = None,
    dt: float | None = None,
    initial: Mapping[str, float] | None = None,
    training: Mask | Sequence[Mask] | Mapping[str, Mask] = None,
    loss: LossName = "linear",
    bounds: Mapping[str, tuple[float, float]] | None = None,
    priors: Mapping[str, tuple[float, float] | Entry] | None = None,
    ties: Mapping[str, str | tuple[str, float]] | None = None,
    fixed: Mapping[str, float] | None = None,
    per_record: Sequence[str] = (),
    progress: Progress = None,
) -> Fit:
    """Fit free parameters of a model to measurements by least squares.

    The Jacobian comes from dual numbers through the same code that simulates, so it is exact to rounding. Channels of all
    records are weighted by their residuals, found in a first pass. The covariance accounts for residuals that correlate in
    time.

    If several records are given, a key of `bounds`, `priors` and `fixed` may name one of them behind an @, as
    "load.inertia @ heavy". Records are called by the names that a mapping gives them, else "record 1", "record 2" and so on.

    Args:
        model: a drive, for a log over time; a gear or a drive, for a friction table or a torsion loop
        recordings: time, command and outputs (a drive log); time and input_angle without a command, and outputs, current,
            input_torque, joint_torque or voltage (a log along the motion of its input, `DrivenLog`); speed and torque (a
            friction table, input side); twist and torque, or input_angle and input_torque (a torsion loop); or an experiment
            made of one. Or several of them: a list, or a mapping from the names of the records
        free: paths of parameters, as "gear.friction_input.coulomb" of a drive or "friction_input.coulomb" of a gear;
            "hysteresis.stiffness[2]" is one element, "hysteresis.stiffness" all of them
        channels: columns of drive logs to compare; all that a simulation has too if not given
        dt: largest step of the simulation [s], shorter where the drive needs it; 0.2 ms if not given
        initial: of a drive log that does not begin at rest, what is known of its beginning, as for `simulate`; encoders then
            count from these angles
        training: which samples take part, shape (n,); all if not given. Of several records, one of these or None for each
        loss: "linear", or "soft_l1" where outliers are to be feared
        bounds: lowest and highest value of free parameters, by path, within what their laws allow
        priors: what is known of free or tied parameters without the measurement, by path: value and standard deviation of a
            normal distribution; or an `Entry` with spread or uncertainty, for the value that the model has
        ties: parameters that follow a free one, by path: its path, or its path and the factor that it is multiplied by
        fixed: values of parameters that are not free, by path; they take the place of those of the model
        per_record: free parameters of which each record has its own value, as the load or what the temperature changes
        progress: as of `sw.simulate`

    Returns:
        the fitted model with its uncertainty

    Raises:
        TypeError: an argument is not of its kind
        ValueError: an unknown path, or one that is free and fixed, or free and tied; a bound, a prior or a tie that makes no
            sense; too few samples; a recording without the columns needed; a model that is not valid over the measurement from
            the start
        FloatingPointError: at the start the model diverges, or its derivatives grow beyond all numbers

    Warns:
        RuntimeWarning: the bristles of the drive found are too stiff for `dt`; a parameter starts out of its bounds, and is
            moved to the nearest

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
    if not isinstance(model, Gear | Drive):
        raise TypeError(f"model must be a Gear or a drive, not {shortened(model)}")
    arguments.one_of("loss", loss, LOSSES)
    records = _records(recordings)
    if initial is not None and not (isinstance(model, Drive) and all(isinstance(each, Recording) for each in records.values())):
        raise TypeError("initial is the beginning of a drive log: give a drive and a recording, or leave it out")
    asked = plan(
        model, list(records), free, bounds=bounds, priors=priors, ties=ties, fixed=fixed, per_record=per_record
    )  # fmt: skip
    experiments = [
        experiment_of(own, each, channels, dt, initial) if isinstance(each, Recording) else each
        for own, each in zip(_models(model, asked), records.values(), strict=True)
    ]
    problem = problem_of(asked, model, experiments, _masks(training, list(records)), loss)
    with in_turn(progress) as problem.watch:
        for experiment, (predicted, _) in zip(experiments, problem.predict(problem.start()), strict=True):
            if isinstance(experiment, DriveLog) and experiment.stands_still(predicted):  # nothing changes with its parameters
                raise ValueError(
                    "the model does not move under this command, though the drive did: nothing can be fitted from there. "
                    "Start with less friction, as in drive.replace(gear=…) with a smaller coulomb and breakaway; or see "
                    "whether the unit of the command is right"
                )
        fitted = solved_from(problem, problem.start())
    for part in fitted.parts:
        if isinstance(part.experiment, DriveLog | DrivenLog):
            moved = part.model if isinstance(part.experiment, DriveLog) else driven(part.model)
            warn_of_bristles(moved, part.experiment.step(part.model))
    return fitted


def solved_problem(found: Fit, more: Sequence[Prior] = ()) -> tuple[Problem, Array]:
    """Return the least squares of a fit, with further priors if there are any, and the unknowns that solve it without them.

    Raises:
        TypeError: not a fit
    """
    if not isinstance(found, Fit):
        raise TypeError(f"found must be a Fit, which sw.fit returns, not {shortened(found)}")
    experiments, masks = [part.experiment for part in found.parts], [part.training for part in found.parts]
    asked = replace(found.plan, priors=(*found.plan.priors, *more))
    problem = problem_of(asked, found.parts[0].model, experiments, masks, found.loss)
    free, tied = len(found.plan.unknowns), len(found.plan.tied)
    values = [each.value for each in found.estimates]
    return problem, np.array(values[:free] + values[free + tied :])


def with_priors(found: Fit, priors: Mapping[str, tuple[float, float]]) -> Fit:
    """Return a fit with further priors of its unknowns: value and standard deviation, by path.

    It starts where the fit ended. An unknown that ended far from its prior starts there: of one near a limit no step returns.
    """
    places = {each.path: place for place, each in enumerate(found.plan.unknowns)}
    more = [Prior(places[path], 1.0, *prior) for path, prior in priors.items()]
    problem, x = solved_problem(found, more)
    for each in more:
        if abs(x[each.unknown] - each.value) > MAX_START_SIGMA * each.sigma:
            x[each.unknown] = each.value
    return solved_from(problem, x)


def problem_of(
    asked: FitParameters, model: Any, experiments: Sequence[Experiment], masks: Sequence[Mask], loss: LossName = "linear"
) -> Problem:
    """Return the least squares of unknowns on experiments, with the model before the fit and the samples that take part."""
    first, built = len(asked.unknowns), []
    for experiment, mask, own, links in zip(experiments, masks, _models(model, asked), asked.links, strict=True):
        wrong = [link.path for link in links if not link.path.removeprefix("gear.").startswith("stiffness.")]
        if wrong and isinstance(experiment, TorsionLoop) and experiment.single_branch:
            raise ValueError(
                f"the torsion loop has one branch only: its twist never turns back, so {wrong[0]} is not separated from "
                "stiffness; free parameters of the stiffness alone, or measure a loop that loads and unloads"
            )
        of_gear = isinstance(experiment, OF_GEAR) and isinstance(own, Drive)
        built.append(FitRecord(experiment, mask, own, links, of_gear, first))
        first = built[-1].nuisances.stop
    return Problem(asked, built, loss)


def _models(model: Any, asked: FitParameters) -> list[Any]:
    """Return the model of each record before a fit."""
    return [_core.with_numbers(model, list(numbers)) for numbers in asked.numbers]


@one_thread_of_algebra
def solved_from(problem: Problem, x: Array) -> Fit:
    """Return the fit from some unknowns, in passes: the residuals of each give the weights of the channels in the next."""
    weights = problem.first_weights()
    channels = sum(len(record.experiment.channels) for record in problem.records)
    alone = channels == 1 and not problem.plan.priors and isinstance(problem.loss, Squared)  # weights then change nothing
    if not alone:
        x = problem.solve(x, weights, ROUGH_TOLERANCE)
        for _ in range(MAX_ROUGH_PASSES):
            before, weights = weights, problem.weights(x, weights)
            if _change(before, weights) < MAX_WEIGHT_CHANGE:
                break
            x = problem.solve(x, weights, ROUGH_TOLERANCE, trials=2)  # where it stands, and one step
    for _ in range(1 if alone else MAX_EXACT_PASSES):
        before, x = weights, problem.solve(x, weights, EXACT_TOLERANCE)
        weights = problem.weights(x, before)
        if _change(before, weights) < MAX_WEIGHT_CHANGE:
            break
    return fit_of(problem, x, weights)


def fit_of(problem: Problem, x: Array, weights: Sequence[Weights]) -> Fit:
    """Return the fit that ended with these unknowns and weights."""
    estimates, covariance = problem.estimates(x, weights)
    parts = tuple(
        RecordFit(name, record.model(x), record.experiment, predicted, record.training)
        for name, record, (predicted, _) in zip(problem.plan.records, problem.records, problem.predict(x), strict=True)
    )
    return Fit(parts[0].model, estimates, covariance, parts, problem.plan, problem.loss_name, problem.evaluations)


def _change(before: Sequence[Weights], after: Sequence[Weights]) -> float:
    """Return the largest relative change of weights."""
    return max(float(np.abs(np.log(new.rows / old.rows)).max()) for old, new in zip(before, after, strict=True))


def _records(recordings: object) -> dict[str, Any]:
    """Return the measurements by the names of their records."""
    if isinstance(recordings, Recording) or hasattr(recordings, "predict"):
        return {"record 1": recordings}
    if isinstance(recordings, Mapping):
        named = dict(zip(arguments.names("names of recordings", recordings), recordings.values(), strict=True))
    elif isinstance(recordings, list | tuple):
        named = {f"record {place}": each for place, each in enumerate(recordings, 1)}
    else:
        named = {"": recordings}
    for each in named.values():
        if not (isinstance(each, Recording) or hasattr(each, "predict")):
            raise TypeError(f"recordings must be Recordings, or experiments made of them, not {shortened(each)}")
    if not named:
        raise ValueError("recordings is empty; give at least one")
    return named


def _masks(training: Any, names: list[str]) -> list[Mask]:
    """Return the samples of each record that take part."""
    if training is None:
        return [None for _ in names]
    if isinstance(training, Mapping):
        for name in training:
            if name not in names:
                raise ValueError(f"training names record {quoted(str(name))}; the records are {listed(names)}")
        return [training.get(name) for name in names]
    if len(names) == 1 and not (isinstance(training, list | tuple) and len(training) == 1):
        return [training]
    if not isinstance(training, list | tuple) or len(training) != len(names):
        raise ValueError(f"training must be a list with one mask or None for each of the {len(names)} records")
    return list(training)


def experiment_of(
    model: Gear | Drive,
    recording: Recording,
    channels: Sequence[str] | None = None,
    dt: float | None = None,
    initial: Mapping[str, float] | None = None,
) -> Experiment:
    """Return the experiment of a recording by its columns and the kind of model.

    Raises:
        ValueError: the columns fit no experiment
    """
    names = set(recording.names)
    if isinstance(model, Drive) and {"time", "input_angle"} <= names and "command" not in names:
        return DrivenLog.of(recording, model, channels, dt, initial)
    if isinstance(model, Drive) and (names & {"time", "command"} or not any(columns <= names for columns in OF_GEAR_COLUMNS)):
        return DriveLog.of(recording, model, channels, dt, initial)
    gear: Gear = model.gear if isinstance(model, Drive) else model
    if {"speed", "torque"} <= names:
        return FrictionTable.of(recording)
    if any(columns <= names for columns in OF_GEAR_COLUMNS):
        return TorsionLoop.of(recording, gear)
    raise ValueError(
        f"columns {', '.join(recording.names)} are no experiment on a gear; a friction table has speed and torque, "
        "a torsion loop twist and torque or input_angle and input_torque"
    )
