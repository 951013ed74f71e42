"""Plans of data sets: what a TOML file may contain, each key checked with its limits before anything runs.

docs/how-to/datasets.md shows the format. A plan is data: it names one gear set, and nothing in it is run or opened otherwise.
"""

from __future__ import annotations

import json
import tomllib
from hashlib import sha256
from itertools import pairwise
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import BaseModel, BeforeValidator, ConfigDict, Field, ValidationError, field_validator, model_validator

from strainwave.dataset.profiles import PROFILE_LIMITS, PROFILES
from strainwave.dataset.sampling import grid_levels
from strainwave.files.gear_file import at, document
from strainwave.messages import listed, one_line, quoted, shortened

MAX_CONDITIONS = 100_000  # each has a command of its own, which is checked before the first run
MAX_MEMBERS = 10**12
MAX_SHARD_MEMBERS = 65_536  # in memory at once as a table, not as series
MAX_SAMPLES = 100_000  # of one member, in memory at once with those of its block
HEALTHY_LABEL = "healthy"  # of units without a fault
SHARE_TOLERANCE = 1e-9  # rounding of a sum of shares
MIN_TEMPERATURE, MAX_TEMPERATURE = 150.0, 500.0  # K

Finite = Annotated[float, Field(allow_inf_nan=False)]
Positive = Annotated[float, Field(gt=0.0, allow_inf_nan=False)]
Share = Annotated[float, Field(ge=0.0, le=1.0)]
Line = Annotated[str, Field(max_length=2000)]
Design = Literal["grid", "latin", "random", "sobol"]
Listed = BeforeValidator(lambda value: tuple(value) if isinstance(value, list) else value)  # a list of TOML as a tuple


class PlanTable(BaseModel):
    """A table of a plan: unknown keys and other types are refused."""

    model_config = ConfigDict(extra="forbid", strict=True, frozen=True)


class Range(PlanTable):
    """Numbers between two limits; equal limits are one number."""

    low: Finite
    high: Finite

    @model_validator(mode="after")
    def _ordered(self) -> Range:
        if self.low > self.high:
            raise ValueError(f"low = {self.low:g} is above high = {self.high:g}; exchange them")
        return self

    @property
    def varies(self) -> bool:
        return self.high > self.low


class Spread(PlanTable):
    """Spread of a number over the units: relative to its value in the gear set, or between two limits in SI units."""

    relative: Annotated[float, Field(ge=0.0, lt=1.0)] | None = None
    low: Finite | None = None
    high: Finite | None = None

    @model_validator(mode="after")
    def _one_kind(self) -> Spread:
        if (self.relative is None) == (self.low is None and self.high is None) or (self.low is None) != (self.high is None):
            raise ValueError("a spread is { relative = 0.1 }, or { low = 1.0, high = 2.0 } in SI units; give one of them")
        if self.low is not None and self.high is not None and self.low > self.high:
            raise ValueError(f"low = {self.low:g} is above high = {self.high:g}; exchange them")
        return self

    def around(self, value: float) -> Range:
        if self.relative is None:
            assert self.low is not None
            assert self.high is not None
            return Range(low=self.low, high=self.high)
        ends = sorted((value * (1.0 - self.relative), value * (1.0 + self.relative)))
        return Range(low=ends[0], high=ends[1])


Number = Finite | Range


def range_of(number: float | Range) -> Range:
    return number if isinstance(number, Range) else Range(low=number, high=number)


def _within(name: str, number: float | Range, low: float, high: float, unit: str) -> None:
    both = range_of(number)
    if not (low <= both.low and both.high <= high):
        shown = f"[{both.low:g}, {both.high:g}]" if both.varies else f"{both.low:g}"
        raise ValueError(f"{name} = {shown} must lie in [{low:g}, {high:g}]{f' {unit}' if unit else ''}")


class SimulationTable(PlanTable):
    """Steps and samples of each run."""

    duration: Annotated[float, Field(gt=0.0, le=3600.0)] = 1.0
    dt: Annotated[float, Field(gt=0.0, le=0.1)] = 5e-4
    sample: Annotated[float, Field(gt=0.0, le=1.0)] = 2e-3
    noise_in_loop: bool = False

    @model_validator(mode="after")
    def _steps_fit(self) -> SimulationTable:
        if self.sample > 0.1 * self.duration:
            raise ValueError(f"sample = {self.sample:g} s must be at most a tenth of duration = {self.duration:g} s")
        if self.dt > self.sample:
            raise ValueError(f"dt = {self.dt:g} s must be at most sample = {self.sample:g} s; take smaller steps")
        if self.duration / self.sample > MAX_SAMPLES:
            count = self.duration / self.sample
            raise ValueError(f"duration / sample = {count:.3g} samples; at most {MAX_SAMPLES} are allowed: sample less often")
        return self


class UnitsTable(PlanTable):
    """Units: single drives of one type, which differ by spread and fault."""

    number: Annotated[int, Field(ge=1, le=MAX_MEMBERS)]
    design: Design = "latin"
    spread: dict[str, Spread] = {}
    catalogue_spread: bool = False


class LifeTable(PlanTable):
    """Instants of the life of each unit at which it is run.

    The last of them is after a `usage` in the unit of the onsets, or after a number of `runs` like the member's own.
    """

    stages: Annotated[int, Field(ge=1, le=10_000)] = 1
    usage: Positive | None = None
    runs: Positive | None = None

    @model_validator(mode="after")
    def _one_measure(self) -> LifeTable:
        if self.usage is not None and self.runs is not None:
            raise ValueError("usage and runs are given; give one of them: runs have the usage of the member's own run")
        return self


class OnsetTable(PlanTable):
    """Development of the severity of a fault with usage: a law of `sw.onset` and its numbers."""

    law: str
    numbers: dict[str, Finite] = {}
    words: dict[str, str] = {}


class FaultTable(PlanTable):
    """A fault, the share of the units that have it, and its severity."""

    kind: str
    share: Share
    severity: Number = 1.0
    onset: OnsetTable | None = None
    numbers: dict[str, Number] = {}
    words: dict[str, str] = {}
    also: Annotated[tuple[str, ...], Listed] = ()

    @field_validator("severity")
    @classmethod
    def _severity(cls, value: float | Range) -> float | Range:
        _within("severity", value, 0.0, 1.0, "")
        return value

    @property
    def kinds(self) -> tuple[str, ...]:
        return (self.kind, *self.also)

    @property
    def label(self) -> str:
        return "+".join(self.kinds)


class ConditionTable(PlanTable):
    """Conditions of one profile: its numbers, temperature and external load."""

    profile: str
    number: Annotated[int, Field(ge=1, le=MAX_CONDITIONS)] = 1
    design: Design = "latin"
    numbers: dict[str, Number] = {}
    temperature: Number = 293.15
    load_torque: Number = 0.0

    @model_validator(mode="after")
    def _known_profile(self) -> ConditionTable:
        if self.profile not in PROFILES:
            raise ValueError(f"profile = {quoted(self.profile)} is not known; there are {listed(PROFILES)}")
        units = PROFILES[self.profile].units
        if set(self.numbers) != set(units):
            needed = ", ".join(f"{name} [{unit}]" for name, unit in units.items())
            raise ValueError(
                f"the profile {self.profile} needs the numbers {needed}; there are {listed(self.numbers) or 'none'}"
            )
        for name, (low, high) in PROFILE_LIMITS.items():
            if name in self.numbers:
                _within(name, self.numbers[name], low, high, units[name])
        _within("temperature", self.temperature, MIN_TEMPERATURE, MAX_TEMPERATURE, "K")
        return self

    @property
    def ranges(self) -> dict[str, Range]:
        """All that can vary, by name."""
        own = {name: range_of(number) for name, number in sorted(self.numbers.items())}
        return own | {"temperature": range_of(self.temperature), "load_torque": range_of(self.load_torque)}


class FeaturesTable(PlanTable):
    """Features of each run, and the noise of what they are computed from."""

    start: Annotated[float, Field(ge=0.0)] = 0.0
    orders: tuple[Annotated[float, Field(gt=0.0, le=1000.0)], ...] = (1.0, 2.0, 4.0)
    tooth_orders: bool = True
    noise: dict[Literal["current", "torque", "input_speed", "tracking_error"], Annotated[float, Field(ge=0.0)]] = {}

    @field_validator("orders", mode="before")
    @classmethod
    def _tuple(cls, value: Any) -> Any:
        return tuple(float(each) if type(each) is int else each for each in value) if isinstance(value, list) else value

    @field_validator("orders")
    @classmethod
    def _spaced(cls, value: tuple[float, ...]) -> tuple[float, ...]:
        if any(late - early < 0.5 for early, late in pairwise(value)):
            raise ValueError(f"orders = {list(value)} must increase by at least 0.5, so that a few turns separate them")
        return value


class SamplesTable(PlanTable):
    """Series to keep in addition to the features."""

    columns: Annotated[tuple[str, ...], Listed]
    every: Annotated[int, Field(ge=1)] = 1


class SplitsTable(PlanTable):
    """Shares of the units, and of the conditions, for each use."""

    train: Share = 0.7
    validation: Share = 0.15
    test: Share = 0.15

    @model_validator(mode="after")
    def _whole(self) -> SplitsTable:
        total = sum(self.shares.values())
        if abs(total - 1.0) > SHARE_TOLERANCE:
            raise ValueError(f"train + validation + test = {total:g} must be 1")
        return self

    @property
    def shares(self) -> dict[str, float]:
        return {"train": self.train, "validation": self.validation, "test": self.test}


class DatasetPlan(PlanTable):
    """A data set as a function of an index: members = conditions times units times stages, conditions first."""

    name: Annotated[str, Field(min_length=1, max_length=200)]
    drive: Annotated[str, Field(min_length=1, max_length=1000)]
    note: Line = ""
    licence: Line = "not stated"
    seed: Annotated[int, Field(ge=0, lt=2**63)] = 0
    shard_members: Annotated[int, Field(ge=1, le=MAX_SHARD_MEMBERS)] = 4096
    simulation: SimulationTable = SimulationTable()
    units: UnitsTable
    life: LifeTable = LifeTable()
    faults: Annotated[tuple[FaultTable, ...], Listed] = ()
    conditions: Annotated[tuple[ConditionTable, ...], Field(min_length=1), Listed]
    features: FeaturesTable = FeaturesTable()
    samples: SamplesTable | None = None
    splits: SplitsTable = SplitsTable()

    @model_validator(mode="after")
    def _sums(self) -> DatasetPlan:
        if self.condition_count > MAX_CONDITIONS:
            raise ValueError(f"the plan has {self.condition_count} conditions; at most {MAX_CONDITIONS} are allowed")
        if self.members > MAX_MEMBERS:
            raise ValueError(f"the plan has {self.members:.3g} members; at most {MAX_MEMBERS:.0e} are allowed")
        total = sum(fault.share for fault in self.faults)
        if total > 1.0 + SHARE_TOLERANCE:
            raise ValueError(f"the shares of the faults sum to {total:g}; they must sum to at most 1, the rest is healthy")
        labels = [fault.label for fault in self.faults]
        if len({*labels}) < len(labels) or HEALTHY_LABEL in labels:
            raise ValueError(f"the faults {listed(labels)} must have different kinds, none of them healthy")
        if self.features.start > 0.5 * self.simulation.duration:
            raise ValueError(
                f"features.start = {self.features.start:g} s must be at most half of simulation.duration = "
                f"{self.simulation.duration:g} s"
            )
        for table in self.conditions:
            check_grid(f"conditions of the profile {table.profile}", table.design, table.number, list(table.ranges.values()))
        return self

    @property
    def condition_count(self) -> int:
        return sum(table.number for table in self.conditions)

    @property
    def members_per_condition(self) -> int:
        return self.units.number * self.life.stages

    @property
    def members(self) -> int:
        return self.condition_count * self.members_per_condition

    @property
    def shards_per_condition(self) -> int:
        return -(-self.members_per_condition // self.shard_members)

    @property
    def shards(self) -> int:
        return self.condition_count * self.shards_per_condition

    @property
    def digest(self) -> str:
        """Hash of the content: equal for plans that differ only in comments, order or layout."""
        return sha256(json.dumps(self.model_dump(mode="json"), sort_keys=True).encode()).hexdigest()

    @staticmethod
    def read(path: str | Path) -> DatasetPlan:
        """Read a plan.

        Raises:
            ValueError: the file cannot be read, or what is wrong in it, with file, key, value and what is allowed
        """
        with at(f"{path}:"):
            return DatasetPlan.of(document(Path(path)))

    @staticmethod
    def parse(text: str) -> DatasetPlan:
        """Return the plan that a text in TOML contains."""
        return DatasetPlan.of(tomllib.loads(text))

    @staticmethod
    def of(content: dict[str, Any]) -> DatasetPlan:
        """Return the plan of tables."""
        try:
            return DatasetPlan.model_validate(_without_whole_numbers(content))
        except ValidationError as error:
            raise ValueError(_in_words(error, content)) from None


def check_grid(what: str, design: str, number: int, ranges: list[Range]) -> None:
    """Refuse a grid that is not full."""
    columns = sum(both.varies for both in ranges)
    if design != "grid" or columns == 0:
        return
    levels = grid_levels(number, columns)
    if levels**columns != number:
        raise ValueError(
            f"a grid of {columns} quantities needs levels^{columns} points; number = {number} is none of these: "
            f"take {levels**columns} or {(levels + 1) ** columns} for the {what}"
        )


WHOLE_KEYS = {"number", "seed", "shard_members", "stages", "every"}  # keys whose numbers are counted


def _without_whole_numbers(value: Any, key: str = "") -> Any:
    """Turn whole numbers into floats, where a float is meant: TOML distinguishes 1 from 1.0, and an engineer does not."""
    if isinstance(value, dict):
        return {name: _without_whole_numbers(each, name) for name, each in value.items()}
    if isinstance(value, list):
        return [_without_whole_numbers(each, key) for each in value]
    return float(value) if type(value) is int and key not in WHOLE_KEYS and abs(value) < 2**63 else value


def _in_words(error: ValidationError, content: dict[str, Any]) -> str:
    errors = error.errors(include_url=False)
    first = next((each for each in errors if not (each["type"] == "float_type" and isinstance(each["input"], dict))), errors[0])
    kinds = {"float", "Range", "function-after[_ordered(), Range]"}
    place = ".".join(f"{each}" for each in first["loc"] if f"{each}" not in kinds)
    reason = first["msg"].removeprefix("Value error, ")
    if first["type"] == "extra_forbidden":
        return one_line(f"{place} is no key of a plan; docs/how-to/datasets.md lists the keys")
    if first["type"] == "missing":
        return one_line(f"{place} is missing; give it")
    if first["type"] == "value_error":
        return one_line(f"{place}: {reason}" if place else reason)
    return one_line(f"{place} = {shortened(first['input'])}: {reason[:1].lower()}{reason[1:]}")
