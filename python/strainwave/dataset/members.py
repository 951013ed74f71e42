"""Members of a data set: unit, condition, stage, fault and all numbers of each, as a function of plan and index."""

from __future__ import annotations

import warnings
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from strainwave import Drive
from strainwave.dataset.features import FeatureSet
from strainwave.dataset.plan import HEALTHY_LABEL, DatasetPlan, OnsetTable, Range, check_grid, range_of
from strainwave.dataset.profiles import PROFILES, command_of, peak_speed
from strainwave.dataset.sampling import Indices, hashed, points, share_of
from strainwave.files.gear_set import GearSet
from strainwave.messages import listed, one_line, quoted
from strainwave.parameters import every, unknown
from strainwave.presentation import Presented
from strainwave.simulation.ensemble import simulate_many
from strainwave.simulation.resolution import check_resolution
from strainwave.simulation.scenario import Scenario
from strainwave.simulation.signals import command_unit, outputs
from strainwave.simulation.usage import revolutions_in, work_in
from strainwave.spline_orders import turning_spline_order

Array = NDArray[np.float64]

MAX_SIGNAL_FREQUENCY_SHARE = 0.4  # of the sample rate: the highest order at the highest speed
SPEED_OVERSHOOT = 1.2  # of the actual over the commanded speed
UNIT_DESIGN, CONDITION_DESIGN, PROFILE_SEED, NOISE_SEED = 0x11, 0x12, 0x13, 0x14  # columns of the hash of the plan's seed
USAGE_UNITS = {"output_revolutions": "rev", "load_cycles": "1", "transmitted_work": "J"}  # of each unit of `sw.onset`
MAX_BYTES_OF_RUNS = 16 << 20  # of series in memory at once, of runs whose usage is computed
FEATURE_SIGNALS = {"current": "A", "torque": "N.m", "input_speed": "rad/s", "tracking_error": "rad"}


class Condition(NamedTuple):
    """A condition: what all its members have in common."""

    number: int
    profile: str
    numbers: Mapping[str, float]
    temperature: float
    load_torque: float
    command: Scenario


@dataclass(frozen=True, eq=False)
class MemberTable(Presented):
    """Members of one condition, each array of shape (members,).

    Args:
        index, unit, stage: of each
        usage: of each, before its run, in the unit of the onsets
        fault: label of each unit
        severity: by the kind of fault, at this stage
        parameters: value of every varying number of the drive, by its path
        refusals: why a member cannot be run, by its place here
    """

    condition: Condition
    index: Indices
    unit: Indices
    stage: Indices
    usage: Array
    fault: NDArray[np.str_]
    severity: Mapping[str, Array]
    parameters: Mapping[str, Array]
    refusals: Mapping[int, str] = field(default_factory=dict)


@dataclass(frozen=True, eq=False)
class Population:
    """The members of a plan.

    Raises:
        ValueError: the gear set does not exist, the plan names what it does not have, steps are too coarse or samples too rare
    """

    plan: DatasetPlan

    def __post_init__(self) -> None:
        if command_unit(self.drive) != "rad":
            raise ValueError(
                one_line(
                    f"drive = {quoted(self.plan.drive)} is commanded in {command_unit(self.drive)}; the profiles are motions "
                    "of the output, so take a drive with a position controller"
                )
            )
        check_grid("units", self.plan.units.design, self.plan.units.number, list(self.unit_ranges.values()))

    def check(self) -> None:
        """Refuse steps that are too coarse and samples that alias, in any condition."""
        table = self.plan.simulation
        for number in range(self.plan.condition_count):
            condition = self.condition(number)
            check_resolution(self.drive, table.dt, 0.0, condition.temperature)
            self._check_aliasing(condition)
        available = {*outputs(self.drive), "tracking_error"}
        kept = self.plan.samples.columns if self.plan.samples else ()
        if wrong := [name for name in kept if name not in available]:
            raise ValueError(f"samples.columns: the drive has no output {quoted(wrong[0])}; there are {listed(available)}")
        assert self.paths  # of one fault of each table, which refuses names and numbers that it does not have
        assert self.usage_kind  # refuses onsets that it does not know, and usage in several units

    # The drive

    @cached_property
    def gear_set(self) -> GearSet:
        return GearSet.read(self.plan.drive)

    @cached_property
    def drive(self) -> Drive:
        """The drive of every member, but for numbers; faults are numbers of its parts."""
        drive = self.gear_set.drive
        if not self.plan.simulation.noise_in_loop:  # it is added to the features instead
            laws = {field["name"]: getattr(drive.sensors, field["name"]) for field in type(drive.sensors).fields}
            noisy = {name: law for name, law in laws.items() if hasattr(law, "seed") and hasattr(law, "law")}
            drive = drive.replace(sensors=drive.sensors.replace(**{name: law.law for name, law in noisy.items()}))
        if not self.plan.faults:
            return drive
        from strainwave.dataset.faults import prepared

        return prepared(drive, [each for table in range(len(self.plan.faults)) for each in self._fault_models(table, {}, 1.0)])

    @cached_property
    def nominal(self) -> dict[str, float]:
        return {path: parameter.value for path, parameter in every(self.drive).items()}

    @cached_property
    def parameter_units(self) -> dict[str, str]:
        """Unit of each number that varies, by its path."""
        return {path: every(self.drive)[path].unit for path in self.paths}

    @cached_property
    def paths(self) -> list[str]:
        """Numbers that vary between members, in the order of the drive."""
        varying = {*self.spread, *self._fault_paths}
        return [path for path in self.nominal if path in varying] or [next(iter(self.nominal))]

    @cached_property
    def recorded(self) -> list[str]:
        """Outputs that features and samples need."""
        available = outputs(self.drive)
        wanted = ["input_angle", "input_speed", "output_angle", *(each for each in FEATURE_SIGNALS if each in available)]
        kept = self.plan.samples.columns if self.plan.samples else ()
        return list(dict.fromkeys(name for name in (*wanted, *kept) if name != "tracking_error"))

    @cached_property
    def features(self) -> FeatureSet:
        available = {*outputs(self.drive), "tracking_error"}
        signals = {name: unit for name, unit in FEATURE_SIGNALS.items() if name in available}
        tooth = turning_spline_order(self.drive.gear.kinematics) if self.plan.features.tooth_orders else None
        return FeatureSet(signals, self.plan.features.orders, None if tooth is None else round(tooth, 6))

    # Units

    @cached_property
    def spread(self) -> dict[str, Range]:
        """Range of each number with a spread over the units, by its path in the drive."""
        stated = dict(self.plan.units.spread)
        for path in stated:
            if path not in self.nominal:
                raise unknown(path, self.nominal)
        ranges = {path: spread.around(self.nominal[path]) for path, spread in stated.items()}
        if self.plan.units.catalogue_spread:
            entries = self.gear_set.sources.items()
            stated_by_set = {path: entry.spread for path, entry in entries if entry.spread and path in self.nominal}
            if not stated_by_set:
                raise ValueError(
                    f"units.catalogue_spread: the gear set {quoted(self.plan.drive)} states no spread of a number; "
                    "give units.spread instead"
                )
            ends = {
                path: sorted(self.nominal[path] * (1.0 + sign * share) for sign in (-1, 1))
                for path, share in stated_by_set.items()
            }
            ranges = {path: Range(low=low, high=high) for path, (low, high) in ends.items()} | ranges
        limits = every(self.drive)
        for path, both in ranges.items():
            low, high = limits[path].low, limits[path].high
            if both.low < low or both.high > high:
                raise ValueError(
                    f"units.spread: {path} in [{both.low:g}, {both.high:g}] {limits[path].unit} must lie in [{low:g}, {high:g}]"
                )
        return {path: ranges[path] for path in self.nominal if path in ranges}

    @cached_property
    def unit_ranges(self) -> dict[tuple[str, str], Range]:
        """All that can vary between units: numbers of the drive, and severity and numbers of each fault."""
        ranges = {("spread", path): both for path, both in self.spread.items()}
        for table in self.plan.faults:
            ranges["severity", table.label] = range_of(table.severity)
            ranges |= {(table.label, name): range_of(number) for name, number in sorted(table.numbers.items())}
        return ranges

    def unit_values(self, first: int, last: int) -> dict[tuple[str, str], Array]:
        """Values of all unit quantities for units `first` up to `last`, not included."""
        plan = self.plan
        return _drawn(plan.units.design, self._seed(UNIT_DESIGN), plan.units.number, self.unit_ranges, first, last)

    def unit_faults(self, units: Indices) -> NDArray[np.str_]:
        """Label of the fault of each unit; the shares are met to within one unit."""
        shares = {table.label: table.share for table in self.plan.faults}
        return share_of(self.plan.seed, "fault", units, self.plan.units.number, shares, HEALTHY_LABEL)

    def unit_split(self, units: Indices) -> NDArray[np.str_]:
        return share_of(self.plan.seed, "unit", units, self.plan.units.number, self.plan.splits.shares, "test")

    def condition_split(self, conditions: Indices) -> NDArray[np.str_]:
        count = self.plan.condition_count
        return share_of(self.plan.seed, "condition", conditions, count, self.plan.splits.shares, "test")

    # Conditions

    def condition(self, number: int) -> Condition:
        local = number
        place = 0
        while local >= self.plan.conditions[place].number:
            local -= self.plan.conditions[place].number
            place += 1
        table = self.plan.conditions[place]
        seed = self._seed(CONDITION_DESIGN + 0x100 * place)
        values = _drawn(table.design, seed, table.number, table.ranges, local, local + 1)
        numbers = {name: float(value[0]) for name, value in values.items()}
        temperature, load_torque = numbers.pop("temperature"), numbers.pop("load_torque")
        profile_seed = int(hashed(self.plan.seed, PROFILE_SEED, np.array([number]))[0] >> np.uint64(1))
        command = command_of(table.profile, numbers, self.plan.simulation.duration, profile_seed)
        return Condition(number, table.profile, numbers, temperature, load_torque, command)

    @cached_property
    def condition_units(self) -> dict[str, str]:
        """Unit of each number of a condition, by its name."""
        return {name: unit for table in self.plan.conditions for name, unit in PROFILES[table.profile].units.items()}

    # Members

    def members(self, first: int, last: int) -> MemberTable:
        """Members `first` up to `last`, not included, all of one condition."""
        plan = self.plan
        index = np.arange(first, last)
        within = index % plan.members_per_condition
        unit, stage = within // plan.life.stages, within % plan.life.stages
        condition = self.condition(first // plan.members_per_condition)
        own = self.unit_values(int(unit[0]), int(unit[-1]) + 1)
        place = unit - unit[0]
        values = {name: column[place] for name, column in own.items()}
        share_of_life = stage / (plan.life.stages - 1.0) if plan.life.stages > 1 else np.ones(len(index))
        fault = self.unit_faults(unit)
        parameters = {path: np.full(len(index), self.nominal[path]) for path in self.paths}
        parameters |= {path: values["spread", path] for path in self.spread}
        if plan.life.runs is None:
            usage = (plan.life.usage or 1.0) * share_of_life
        else:
            first_rows = np.unique(unit, return_index=True)[1]
            healthy = {path: column[first_rows] for path, column in parameters.items()}
            usage = plan.life.runs * share_of_life * self._usage_of_run(condition, healthy)[place]
        severity = self._severities(values, fault, usage)
        refusals = self._put_faults(parameters, values, fault, severity)
        return MemberTable(condition, index, unit, stage, usage, fault, severity, parameters, refusals)

    @cached_property
    def usage_kind(self) -> str:
        """Unit of usage of the onsets of the plan."""
        kinds = {onset.unit for table in self.plan.faults if hasattr(onset := _onset(table.onset), "unit")}
        if len(kinds) > 1:
            raise ValueError(
                f"faults.onset.words.unit is {listed(sorted(kinds))}; all onsets of a plan count usage in one unit"
            )
        return next(iter(kinds), next(iter(USAGE_UNITS)))

    def _usage_of_run(self, condition: Condition, healthy: Mapping[str, Array]) -> Array:
        """Return the usage of one run of each unit without a fault, shape (units,).

        Raises:
            ValueError: the run of a healthy unit fails
        """
        count, table = len(next(iter(healthy.values()))), self.plan.simulation
        if self.usage_kind == "load_cycles":
            return np.ones(count)
        at_once = max(int(MAX_BYTES_OF_RUNS / (16.0 * (table.duration / table.sample + 1.0))), 1)
        usage = np.empty(count)
        for rows in (slice(first, min(first + at_once, count)) for first in range(0, count, at_once)):
            with warnings.catch_warnings():
                warnings.simplefilter("ignore")  # failed runs are refused below, and the plan was checked
                runs = simulate_many(
                    self.drive,
                    condition.command,
                    {path: values[rows] for path, values in healthy.items()},
                    table.dt,
                    record=("torque", "output_angle"),
                    sample=table.sample,
                    load_torque=condition.load_torque,
                    temperature=condition.temperature,
                    threads=1,
                )
            if runs.failures:
                reason = one_line(next(iter(runs.failures.values())))
                raise ValueError(f"life.runs: a healthy unit fails in condition {condition.number}: {reason}")
            angle = runs["output_angle"]
            is_work = self.usage_kind == "transmitted_work"
            usage[rows] = work_in(runs["torque"], angle) if is_work else revolutions_in(angle)
        return usage

    @property
    def noise_seed(self) -> int:
        return self._seed(NOISE_SEED)

    def _seed(self, column: int) -> int:
        return int(hashed(self.plan.seed, column, np.zeros(1, dtype=np.int64))[0] >> np.uint64(33))

    # Faults

    @property
    def fault_kinds(self) -> list[str]:
        return list(dict.fromkeys(kind for table in self.plan.faults for kind in table.kinds))

    def _severities(self, values: Mapping[tuple[str, str], Array], fault: NDArray[np.str_], usage: Array) -> dict[str, Array]:
        severity = {kind: np.zeros(len(usage)) for kind in self.fault_kinds}
        for table in self.plan.faults:
            rows = fault == table.label
            onset = np.ones(len(usage)) if (law := _onset(table.onset)) is None else np.asarray(law.share(usage))
            for kind in table.kinds:
                severity[kind][rows] = (values["severity", table.label] * onset)[rows]
        return severity

    def _put_faults(
        self,
        parameters: dict[str, Array],
        values: Mapping[tuple[str, str], Array],
        fault: NDArray[np.str_],
        severity: Mapping[str, Array],
    ) -> dict[int, str]:
        refusals: dict[int, str] = {}
        for place, table in enumerate(self.plan.faults):
            for row in np.flatnonzero(fault == table.label).tolist():
                numbers = {name: float(values[table.label, name][row]) for name in table.numbers}
                own = {path: float(parameters[path][row]) for path in self.spread}
                try:
                    changes = self._changes(place, own, numbers, float(severity[table.kind][row]))
                except ValueError as error:
                    refusals[row] = one_line(str(error))
                    continue
                for path, value in changes.items():
                    parameters[path][row] = value
        return refusals

    def _changes(self, table: int, own: Mapping[str, float], numbers: Mapping[str, float], severity: float) -> dict[str, float]:
        from strainwave.dataset.faults import changes

        drive = self.drive.replace(dict(own)) if own else self.drive
        return changes(drive, self._fault_models(table, numbers, severity))

    def _fault_models(self, table: int, numbers: Mapping[str, float], severity: float) -> list[Any]:
        """The faults of a table of the plan, with the middle of each range where no number is given."""
        stated = self.plan.faults[table]
        ranges = {name: range_of(number) for name, number in stated.numbers.items()}
        middle = {name: 0.5 * (both.low + both.high) for name, both in ranges.items()}
        first = _model(fault_kind(stated.kind), {**middle, **numbers, **stated.words, "severity": severity})
        return [first, *(fault_kind(kind)(severity=severity) for kind in stated.also)]

    @cached_property
    def _fault_paths(self) -> set[str]:
        tables = range(len(self.plan.faults))
        return {path for table in tables for severity in (0.5, 1.0) for path in self._changes(table, {}, {}, severity)}

    # Checks

    def _check_aliasing(self, condition: Condition) -> None:
        table = self.plan.simulation
        speed = SPEED_OVERSHOOT * abs(self.drive.gear.kinematics.ratio) * peak_speed(condition.command, table.sample)
        highest = max(self.features.orders, default=0.0)
        frequency = highest * speed / (2.0 * np.pi)
        if frequency * table.sample > MAX_SIGNAL_FREQUENCY_SHARE:
            needed = MAX_SIGNAL_FREQUENCY_SHARE / frequency
            raise ValueError(
                f"condition {condition.number} ({condition.profile}): order {highest:g} reaches {frequency:.4g} Hz; samples "
                f"{table.sample:g} s apart alias; take simulation.sample = {0.99 * needed:.3g} s or less, or lower orders"
            )


def fault_kind(name: str) -> Any:
    """Return the class of a fault by its name, as lubrication_loss."""
    from strainwave import _core

    kinds: Mapping[str, Any] = _core.fault_families["fault"]
    if name not in kinds:
        raise ValueError(f"faults.kind = {quoted(name)} is not known; there are {listed(kinds)}")
    return kinds[name]


def _onset(table: OnsetTable | None) -> Any:
    """Return the law of an onset; None if there is none."""
    from strainwave import _core

    if table is None:
        return None
    kinds: Mapping[str, Any] = _core.fault_families["onset"]
    if table.law not in kinds:
        raise ValueError(f"onset.law = {quoted(table.law)} is not known; there are {listed(kinds)}")
    return _model(kinds[table.law], table.numbers | table.words)


def _model(kind: Any, values: Mapping[str, Any]) -> Any:
    """A model with numbers, of which some are counted; refuse a name or a value that it does not take."""
    kinds = {each["name"]: each["kind"] for each in kind.fields}
    if wrong := [name for name in values if name not in kinds]:
        raise ValueError(f"{kind.name} has no {quoted(wrong[0])}; there are {listed(kinds)}")
    try:
        return kind(**{name: round(each) if kinds[name] == "count" else each for name, each in values.items()})
    except TypeError as error:
        raise ValueError(one_line(str(error))) from None


def _drawn(design: str, seed: int, count: int, ranges: Mapping[Any, Range], first: int, last: int) -> dict[Any, Array]:
    """Values of quantities at points of a design; those that do not vary take no dimension of it."""
    varying = [name for name, both in ranges.items() if both.varies]
    cube = points(design, seed, count, len(varying), first, last)
    place = {name: column for column, name in enumerate(varying)}
    return {
        name: both.low + (both.high - both.low) * cube[:, place[name]] if both.varies else np.full(last - first, both.low)
        for name, both in ranges.items()
    }
