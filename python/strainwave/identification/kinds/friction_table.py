"""Tables of steady friction over speed."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from strainwave.files.gear_set import GearSet
from strainwave.files.recording import Recording
from strainwave.files.units import convert
from strainwave.identification.candidates.friction import FrictionCandidate, cost_of, fit_friction, plain_error, written
from strainwave.identification.candidates.steady_shapes import is_loaded
from strainwave.identification.checks.sizes import (
    friction_of_table,
    hints_of_levels,
    input_speed,
    levels_of_table,
    opposes_motion,
)
from strainwave.identification.checks.unexplained import OVER_SPEED, explained, judged_shape
from strainwave.identification.experiments.friction_table import CONDITIONS, FrictionTable, with_load
from strainwave.identification.fitting.influence import influence
from strainwave.identification.kinds.kind import Kind, Ranked, exceeded, thinned, unused
from strainwave.identification.reading.mapping import FileMapping
from strainwave.identification.reading.motion import stretches
from strainwave.identification.reading.recognise import Recognised
from strainwave.identification.reading.roles import (
    Column,
    ColumnRoles,
    first,
    measured,
    needed,
    needed_effort,
    pair,
    side_of_table,
)
from strainwave.identification.results.file_result import FileEstimate, FileResult, HeldOut
from strainwave.identification.results.gear_so_far import GearSoFar, with_torque
from strainwave.identification.results.identifiability import JudgedFit, with_friction_at
from strainwave.identification.results.pictures import Picture
from strainwave.identification.results.prediction import (
    Prediction,
    changes_of,
    friction_directions,
    judged,
    model_error,
    slopes_by_numbers,
)
from strainwave.identification.results.steady_friction import (
    AT_SPEEDS,
    MIN_SPEEDS,
    best_known_friction,
    different_speeds,
    friction_at_speeds,
)
from strainwave.questions import LOG_AT_RATE, Answer, QuestionError
from strainwave.statistics.determined_sum import DeterminedSum
from strainwave.statistics.linear_fit import solved
from strainwave.statistics.residuals import correlation_length, rms
from strainwave.typeset import uncertain_quantity

Array = NDArray[np.float64]
MAX_ROWS = 500  # of a table that was measured point by point
MIN_STRETCHES = 4  # speeds of a table
MIN_INDEPENDENCE = 1e-3  # smallest singular value of terms of size 1 that are fitted together
SPEED_UNITS = ("rad/s", "rpm", "rev/s")  # of tables of friction
TABLE_UNITS = {"speed": "rad/s", "torque": "N.m"}
DRY_TORQUES = (".coulomb", ".breakaway")  # torques that a loss under a constant load adds to
MIN_FACTOR_BY_LAWS = 1.2  # standard deviation over that within one law, from which on other laws are worth a word


class SteadyFriction(Kind):
    """Speed and torque of steady motion, a row for each speed."""

    needs = "speed and torque"

    def recognises(self, columns: Sequence[Column], mapping: FileMapping) -> bool:
        """True for speeds and a torque or current.

        Raises:
            QuestionError: these may be samples of a log
        """
        if not (speeds := measured(columns, "speed")) or not measured(columns, "torque", "current"):
            return False
        if (rows := len(speeds[0].si)) > MAX_ROWS and len(stretches(speeds[0].si)) < MIN_STRETCHES:
            ways = [LOG_AT_RATE, Answer("a table of friction", {"kind": "friction"})]
            raise QuestionError(f"it has {rows} rows of speed and torque without time", ways)
        return True

    def roles(self, columns: Sequence[Column], mapping: FileMapping) -> ColumnRoles:
        speed = needed(columns, "speed", self.title)
        _check_speed_unit(speed)
        columns, load, loaded = _with_load(columns, speed)
        effort, torque = needed_effort(columns, self.title)
        side, why_side = side_of_table(speed, torque, mapping.side)
        by_channel = {"speed": speed, effort: torque, **load, **first(columns, "temperature")}
        rows, remarks = len(speed.si), tuple[str, ...]()
        order = f", {rows} rows in {'no order of time' if (np.diff(speed.si) < 0.0).any() else 'the order of speed'}"
        if rows > MAX_ROWS:
            if not (parts := stretches(speed.si)):
                none = f"none of its {rows} rows belongs to a stretch at one speed"
                raise QuestionError(f"{none}: give a row for each speed, or its time, as a log")
            steady = sum(part.stop - part.start for part in parts)
            remarks = (f"{steady} of its {rows} rows are steady; the means of {len(parts)} stretches at one speed are taken",)
            means = {name: np.array([column.si[part].mean() for part in parts]) for name, column in by_channel.items()}
            by_channel = {name: replace(column, si=means[name]) for name, column in by_channel.items()}
            order = " at one speed after another"
        why = f"its columns are {pair(speed, torque)}{order}: {self.title}"
        return ColumnRoles(self.name, by_channel, side, (why, why_side, *loaded), remarks)

    def fit(self, file: Recognised, known: GearSoFar) -> tuple[FileResult, GearSoFar]:
        """Fit the laws of steady friction that a table may show."""
        table, uncertain, remarks = _with_torque_and_load(file, known.gear_set)
        return fit_table(replace(file, remarks=(*file.remarks, *remarks)), table, uncertain, known)

    def predict(self, file: Recognised, gear_set: GearSet) -> Prediction:
        """Compare the torque at each speed with that of a saved gear."""
        recording, _, remarks = _with_torque_and_load(file, gear_set)
        table, gear = _table_of(recording, file.side, gear_set.gear), gear_set.gear
        left = table.torque - _at(table, gear)
        directions = list(friction_directions(gear, lambda other: _at(table, other)))
        slopes, covariance = slopes_by_numbers(gear_set, gear, lambda other: _at(table, other), "gear.friction_")
        changes, explained = changes_of(left, directions, slopes, covariance, model_error(gear_set, file.kind, "torque"))
        curves = {"speed": table.speed, "torque": table.torque, "predicted": table.torque - left, "residual": left}
        prediction = Prediction(
            file.path.name, gear_set.name, file.kind, "torque", "N.m", rms(left), float(np.std(table.torque)),
            samples=len(left), changes=changes, error_with_changes=rms(left - explained),
            curves=Recording(curves, dict.fromkeys(curves, "N.m") | {"speed": "rad/s"}), remarks=(*file.remarks, *remarks),
        )  # fmt: skip
        return judged(prediction, gear_set, float(np.mean(np.einsum("np,pq,nq->n", slopes, covariance, slopes))))

    def rank(self, file: Recognised, known: GearSoFar) -> tuple[Ranked, ...]:
        """Return the laws of friction by their error where each speed is predicted from the others."""
        recording, _ = with_torque(file, known.gear_set)
        table = _table_of(recording, file.side, known.gear_set.gear)
        candidates = fit_friction(table, known.gear_set.gear)
        order = np.argsort(table.speed, kind="stable")
        return tuple(
            Ranked(
                each.name, each.parameters, each.error, each.error_sigma, "N.m",
                correlation_length(each.fit.residuals[0][order]), cost_of(each.law),
            )
            for each in candidates
        )  # fmt: skip


# ---- Columns ----------------------------------------------------------------------------------------------------------


def _check_speed_unit(speed: Column) -> None:
    """Ask for the unit of the speeds of a table, which friction alone does not determine; robots have radians.

    Raises:
        QuestionError: no unit is stated
    """
    if speed.sure or speed.robot:
        return
    fastest = float(np.abs(speed.raw[np.isfinite(speed.raw)]).max(initial=0.0))
    ways = [
        Answer(f"{each}, {convert(fastest, each, 'rpm'):.0f} 1/min at most", {"units": {speed.label.name: each}})
        for each in SPEED_UNITS
    ]
    raise QuestionError(f"the unit of {speed.name} is not stated, and a table of friction does not determine it", ways)


def _with_load(columns: Sequence[Column], speed: Column) -> tuple[Sequence[Column], dict[str, Column], tuple[str, ...]]:
    """Return the columns without the torque that loads the gear, this torque by its name, and what determines it.

    It is `output_torque` if the other torque drives it too, as on a dynamometer, and `load_torque` with a torque that is
    friction alone.
    """
    named = [column for column in columns if column.channel.loading]
    torques = measured(columns, "torque")
    loads = named or [column for column in torques if column.channel.side == "output"]
    own = [column for column in torques if column not in loads]
    if len(loads) != 1 or len(own) != 1 or loads[0].by_user != own[0].by_user:
        return columns, {}, ()
    ((load,), (torque,)) = loads, own
    name = "load_torque" if named or not _drives(speed.si, torque, load) else "output_torque"
    what = "which loads the gear" if name == "load_torque" else f"which {torque.name} drives through the gear"
    return [column for column in columns if column is not load], {name: load}, (f"{load.name} is a torque {what}",)


@np.errstate(all="ignore")
def _drives(speed: Array, torque: Column, load: Column) -> bool:
    """True if a torque contains what drives a load, not only the friction under it."""
    way = np.sign(speed)
    terms = np.stack([way, speed, load.si, way * np.abs(load.si)], axis=1)
    sizes = np.linalg.norm(terms, axis=0)
    if not sizes.all() or np.linalg.matrix_rank(terms / sizes, tol=MIN_INDEPENDENCE) < len(sizes):
        return torque.channel.side == "input"
    _, _, driving, rubbing = solved(terms, torque.si)
    return bool(abs(driving) > abs(rubbing))


# ---- Fit --------------------------------------------------------------------------------------------------------------


def fit_table(file: Recognised, table: Recording, uncertain: float, known: GearSoFar) -> tuple[FileResult, GearSoFar]:
    """Fit a friction table; return its result, and the gear with it.

    Args:
        file: that it came from
        table: speed and torque, and what else friction may depend on
        uncertain: standard deviation of the torque constant or inertia that its torques rest on, over its value [1]
        known: before it
    """
    name, gear = file.path.name, known.gear_set.gear
    side = "output" if file.side == "output" else known.side  # a side that was only assumed is checked by the size
    experiment, speed = _table_of(table, side, gear), table.values("speed", "rad/s")
    if "load" not in table and different_speeds(speed) < MIN_SPEEDS:
        at_speeds, few = friction_at_speeds(speed, table.values("torque", "N.m"), side=file.side or "input")
        at_speeds = tuple(each.resting_on(uncertain) for each in at_speeds)
        opposing = tuple(opposes_motion(at_speeds, name))
        result = FileResult(name, file, AT_SPEEDS, at_speeds, remarks=(*file.remarks, *few), checks=opposing)
        return result, with_friction_at(known, speed, at_speeds, file.side or "input", name)
    best, *others = fit_friction(experiment, gear)
    speed_check = input_speed(experiment.speed, name)
    checks = [speed_check, levels_of_table(table, name), *friction_of_table(table, best.fit, known.initial.gear, side, name)]
    whole, order = explained(best.fit, name), np.argsort(experiment.speed, kind="stable")
    left, varies = best.fit.residuals[0][order], float(np.std(experiment.torque))
    shaped = judged_shape(left, {OVER_SPEED: np.arange(float(len(left)))}, varies, "N.m", name, ordered=True)
    fitted = JudgedFit(best.fit, name, influence(best.fit), not whole.failed, _shared(best, experiment))
    fit, estimates = fitted.with_set_before(known)
    if any(each.why for each in estimates) and not whole.failed:
        speeds = np.quantile(np.abs(experiment.speed), np.linspace(0.0, 1.0, 9)).tolist()
        paths = [each.path for each in best.fit.estimates]
        fit = written(replace(best, fit=fit), gear, experiment)
        estimates = (*estimates, best_known_friction(best.fit.gear, paths, best.fit.covariance, speeds))
    estimates = tuple(_beside_a_zero(each, estimates).resting_on(uncertain) for each in estimates)
    result = FileResult(
        name, file, best.name, estimates,
        (*file.remarks, *_remarks(table, best, experiment, known.initial), *hints_of_levels(table), *shaped.remarks),
        (*checks, *([] if any(check.failed for check in checks) else [whole, *shaped.checks])),
        pictures=(Picture(fit.curves()[0], "table", "friction torque, at the input"),),
        held_out=HeldOut(
            "each speed, predicted from the others", "torque", "N.m", best.error, float(np.std(experiment.torque)),
            plain_error(experiment, best.fit.training), samples=len(experiment.torque),
        ),
        candidates=tuple((each.name, each.error) for each in (best, *others)), fit=fit,
    )  # fmt: skip
    if whole.failed or known.knows_better("friction_input", estimates):
        return result, known
    parts = {"friction_input", "friction_mesh"} if is_loaded(experiment) else {"friction_input"}
    return result, known.with_fit(fit.gear, parts, estimates, name).judged("friction_input", estimates)


def _beside_a_zero(estimate: FileEstimate, estimates: Sequence[FileEstimate]) -> FileEstimate:
    """Return an asymmetry of dry friction, which is determined only together with a zero of the torque; others as they are."""
    if estimate.why or not estimate.path.endswith(".dry_asymmetry"):
        return estimate
    coulomb = next((each.value for each in estimates if each.path.endswith(".coulomb")), 0.0)
    constant = uncertain_quantity(coulomb * estimate.value, abs(coulomb) * estimate.sigma, "N.m")
    why = f"a zero of the torque looks the same: both make {constant} together; measure the torque at rest, unloaded"
    return replace(estimate, why=why, in_combination=True)


def _with_torque_and_load(file: Recognised, gear_set: GearSet) -> tuple[Recording, float, tuple[str, ...]]:
    """Return a table with torque and load of the input, the uncertainty of its torque constant, and what was assumed."""
    table, uncertain = with_torque(file, gear_set)
    ratio = abs(gear_set.gear.kinematics.ratio)
    table, remarks = with_load(_unloaded(table, file, gear_set), ratio, file.side)
    return table, uncertain, remarks


def _at(table: FrictionTable, gear: Any) -> Array:
    return np.asarray(table.predict(gear, [], np.zeros(0))[0][0])


def _table_of(recording: Recording, side: str | None, gear: Any) -> FrictionTable:
    return FrictionTable.of_output(recording, gear) if side == "output" else FrictionTable.of(recording)


def _unloaded(table: Recording, file: Recognised, gear_set: GearSet) -> Recording:
    """Return a table without the constant torque at the output, and at the temperature, that a person gave."""
    if load := file.constants.get("load_torque", 0.0):
        held = load if file.side == "output" else load / gear_set.gear.kinematics.ratio
        table = table.with_column("torque", table.values("torque", "N.m") - held, "N.m")
    if "temperature" in file.constants and "temperature" not in table:
        table = table.with_column("temperature", np.full(len(table), file.constants["temperature"]), "K")
    return table


def _shared(best: FrictionCandidate, table: FrictionTable) -> dict[str, str]:
    """Return the parameters that a table determines only together with a loss under load, by path, and how."""
    if table.load is None or is_loaded(table) or not table.load.any():
        return {}
    held, loss = float(np.abs(table.load).max()), "friction_mesh.driving_forward"
    kept = held * float(getattr(best.fit.gear.friction_mesh, "driving_forward", 0.0))
    sums = (
        DeterminedSum((each.path, loss), (1.0, held), each.value + kept, each.sigma, each.unit)
        for each in best.fit.estimates
        if each.path.endswith(DRY_TORQUES)
    )
    return {f"gear.{each.paths[0]}": each.with_others for each in sums}


def _remarks(recording: Recording, best: FrictionCandidate, table: FrictionTable, start: GearSet) -> Iterator[str]:
    low, high = float(np.abs(table.speed).min()), float(np.abs(table.speed).max())
    yield f"valid between {low:.4g} and {high:.4g} rad/s at the input; validated by leaving out speeds in turn"
    if best.name == "Coulomb and viscous":
        yield "no fall of torque towards low speed within this range: breakaway and Stribeck speed are not seen"
    within = np.sqrt(np.diag(best.fit.covariance)).tolist()
    unsure = [
        each.path.rpartition(".")[2]
        for each, sigma in zip(best.fit.estimates, within, strict=True)
        if each.sigma > MIN_FACTOR_BY_LAWS * sigma
    ]
    if unsure:
        yield f"other laws fit as well: ± includes how far their {', '.join(unsure)} differs"
    yield from thinned(table.samples, len(table.speed))
    yield from unused(recording, ("speed", "torque", "current", *CONDITIONS))
    if (left_out := int(np.sum(~best.fit.training))) > 0:
        yield f"{left_out} of {len(table.speed)} rows are outliers, and left out"
    yield from exceeded(start, Recording({"speed": table.speed, "torque": table.torque}, TABLE_UNITS))
