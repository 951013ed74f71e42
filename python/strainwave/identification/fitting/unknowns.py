"""Unknowns of a fit: free numbers of a model, shared by all records or one for each, their priors, and their estimates."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import isfinite
from typing import Any
from warnings import warn

import numpy as np

from strainwave import Drive, Gear, arguments, typeset
from strainwave.equality import ComparedByFields
from strainwave.files.entries import Entry, Quantity
from strainwave.messages import listed, quoted, shortened
from strainwave.parameters import Parameter, every, parameters, unknown
from strainwave.presentation import Presented
from strainwave.statistics.scale import ONE_SIGMA, student

LIMIT_TOLERANCE = 1e-6  # of the size of a parameter: within it of a limit, a fit ended there
MAX_DISTANCE = 0.1  # of the size of a parameter before the fit, from its limit: a fit that ended there moved it
OPEN_AT_ZERO = 2.0**-126  # lowest value of a number that must be greater than 0, see `_core.parameters`
OF_RECORD = " @ "  # between the path of a parameter and the name of the only record that has it


@dataclass(frozen=True)
class Unknown:
    """An unknown of a fit.

    Attributes:
        path: of the number in the model, with the record if the unknown is of one record
        unit: its unit
        before: its value in the model
        low, high: its limits
    """

    path: str
    unit: str
    before: float
    low: float
    high: float

    @property
    def start(self) -> float:
        """Initial value of a fit: that of the model, moved into the limits."""
        return min(max(self.before, self.low), self.high)

    def at_limit(self, value: float, resolution: float = 0.0) -> bool:
        """True if a fit ended at a limit: solvers stop short of it, by far less than the size of the parameter.

        Args:
            value: where it ended
            resolution: change of the value that the data do not show; of a value that stayed near its initial one, as no data
                show it, a part of that counts
        """
        near = min(resolution, MAX_DISTANCE * abs(self.before)) if self.before else resolution
        low, high = (
            max(LIMIT_TOLERANCE * max(abs(end), abs(self.before)), near) if isfinite(end) else 0.0
            for end in (self.low, self.high)
        )
        return value <= self.low + low or value >= self.high - high

    def ended(self, value: float, resolution: float = 0.0) -> float:
        """Return the value of a fit that ended here: at a limit that limit, or beside one that is no value.

        Arguments as of `at_limit`.
        """
        if not self.at_limit(value, resolution):
            return value
        if abs(value - self.low) > abs(value - self.high):
            return self.high
        return self.beside_limit(resolution) if self.low == OPEN_AT_ZERO else self.low

    def beside_limit(self, resolution: float) -> float:
        """Return the value in place of an excluded bound of 0: the resolution of the data, at most the initial value."""
        size = abs(self.before)
        return min(max(LIMIT_TOLERANCE * size, resolution), size)


@dataclass(frozen=True)
class ParameterLink:
    """A number of the model of a record that is a multiple of an unknown.

    Attributes:
        path: of the number
        number: its place among all numbers of the model
        unknown: place of the unknown
        factor: the number over the unknown
    """

    path: str
    number: int
    unknown: int
    factor: float


@dataclass(frozen=True)
class Tied:
    """A parameter that follows an unknown.

    Attributes:
        path: in the model, with the record if the unknown is of one record
        unit: its unit
        before: its value in the model
        unknown: place of the unknown
        factor: the parameter over the unknown
    """

    path: str
    unit: str
    before: float
    unknown: int
    factor: float


@dataclass(frozen=True)
class Prior:
    """Prior of a multiple of an unknown: factor * unknown = value ± sigma, normally distributed."""

    unknown: int
    factor: float
    value: float
    sigma: float


@dataclass(frozen=True)
class FitParameters:
    """The unknowns of a fit, and the numbers of the model of each record that are multiples of them.

    Attributes:
        records: names of the records
        unknowns: all of them
        numbers: of the model of each record, before the fit
        links: of the model of each record
        tied: parameters that follow an unknown
        priors: of the unknowns
    """

    records: tuple[str, ...]
    unknowns: tuple[Unknown, ...]
    numbers: tuple[tuple[float, ...], ...]
    links: tuple[tuple[ParameterLink, ...], ...]
    tied: tuple[Tied, ...]
    priors: tuple[Prior, ...]


def plan(
    model: Gear | Drive,
    records: Sequence[str],
    free: Sequence[str],
    *,
    bounds: Mapping[str, tuple[float, float]] | None = None,
    priors: Mapping[str, Any] | None = None,
    ties: Mapping[str, Any] | None = None,
    fixed: Mapping[str, float] | None = None,
    per_record: Sequence[str] = (),
) -> FitParameters:
    """Return the unknowns of a fit; arguments and errors are those of `fit`.

    >>> from strainwave import Drive
    >>> asked = plan(Drive(), ["light", "heavy"], ["motor.inertia", "load.inertia"], per_record=["load.inertia"])
    >>> [each.path for each in asked.unknowns]
    ['motor.inertia', 'load.inertia @ light', 'load.inertia @ heavy']
    """
    return _Parameters(model, records, free, per_record).plan(bounds or {}, priors or {}, ties or {}, fixed or {})


class _Parameters:
    """The parameters of a model that are free, and those of them that each record has for itself."""

    def __init__(self, model: Gear | Drive, records: Sequence[str], free: Sequence[str], per_record: Sequence[str]) -> None:
        self.model, self.records, self.known = model, list(records), every(model)
        self.free = {each.path: each for each in parameters("free", model, free)}
        self.own = {each.path for each in parameters("per_record", model, per_record)}
        for path in self.own:
            if path not in self.free:
                raise ValueError(f"per_record names {path}, which is not free; name it in free too")

    def plan(
        self, bounds: Mapping[str, Any], priors: Mapping[str, Any], ties: Mapping[str, Any], fixed: Mapping[str, Any]
    ) -> FitParameters:
        for name, value, example in (
            ("bounds", bounds, '{"load.inertia": (0.1, 0.9)}'),
            ("priors", priors, '{"load.inertia": (0.5, 0.02)}'),
            ("ties", ties, '{"motor.back_emf": "motor.torque_constant"}'),
            ("fixed", fixed, '{"motor.resistance": 0.5}'),
        ):
            arguments.mapping(name, value, example)
        numbers = self._numbers(fixed)
        leaders = self._leaders(ties, fixed)
        owners = [(path, record) for path in self.free for record in self._owners(path)]
        places = {owner: place for place, owner in enumerate(owners)}

        def linked(record: int) -> tuple[ParameterLink, ...]:
            of = {path: places[path, record if path in self.own else None] for path in self.free}
            own = [ParameterLink(path, each.number, of[path], 1.0) for path, each in self.free.items()]
            follow = [
                ParameterLink(path, self.known[path].number, of[leader], factor) for path, (leader, factor) in leaders.items()
            ]
            return (*own, *follow)

        links = tuple(linked(record) for record in range(len(self.records)))
        limits = self._limits(bounds, leaders)
        tied = tuple(
            Tied(self._named_of(path, record), self.known[path].unit, self.known[path].value, places[leader, record], factor)
            for path, (leader, factor) in leaders.items()
            for record in self._owners(leader)
        )
        unknowns = tuple(self._unknown(path, record, limits) for path, record in owners)
        return FitParameters(tuple(self.records), unknowns, numbers, links, tied, self._priors(priors, links))

    def _owners(self, path: str) -> Sequence[int | None]:
        """Return the records that have a value of a free parameter each; None for all together."""
        return range(len(self.records)) if path in self.own else (None,)

    def _named_of(self, path: str, record: int | None) -> str:
        return path if record is None else f"{path}{OF_RECORD}{self.records[record]}"

    def _numbers(self, fixed: Mapping[str, Any]) -> tuple[tuple[float, ...], ...]:
        """Return the numbers of the model of each record, with those that are given for it."""
        numbers = [[each.value for each in self.known.values()] for _ in self.records]
        for key, value in sorted(fixed.items(), key=lambda item: OF_RECORD in str(item[0])):  # one record last
            for each, records in self._named("fixed", key):
                if each.path in self.free:
                    raise ValueError(f"{each.path} is both free and fixed; take it out of one of the two")
                number = arguments.number(f"fixed[{quoted(key)}]", value, each.unit, "[]", each.low, each.high)
                for record in records:
                    numbers[record][each.number] = number
        return tuple(map(tuple, numbers))

    def _leaders(self, ties: Mapping[str, Any], fixed: Mapping[str, Any]) -> dict[str, tuple[str, float]]:
        """Return the free parameter that each tied one follows, and the factor."""
        leaders = {}
        for path, followed in ties.items():
            if path not in self.known:
                raise unknown(path, self.known)
            leader, factor = followed, 1.0
            if not isinstance(followed, str):
                if not (isinstance(followed, tuple | list) and len(followed) == 2 and isinstance(followed[0], str)):
                    raise TypeError(
                        f"ties[{quoted(path)}] must be a path, or a path and a factor as (path, 2.0), not {shortened(followed)}"
                    )
                leader, factor = followed[0], arguments.number(f"the factor of ties[{quoted(path)}]", followed[1])
                if factor == 0.0:
                    raise ValueError(f"the factor of ties[{quoted(path)}] is 0; to make {path} zero, name it in fixed")
            if leader not in self.known:
                raise unknown(leader, self.known)
            if path in self.free:
                raise ValueError(f"{path} is both free and tied to {leader}; take it out of one of the two")
            if any(path in (key, key.split("[")[0], key.split(OF_RECORD)[0]) for key in fixed):
                raise ValueError(f"{path} is both fixed and tied to {leader}; take it out of one of the two")
            if leader not in self.free:
                raise ValueError(f"{path} is tied to {leader}, which is not free; free it, or give {path} a value in fixed")
            leaders[path] = leader, factor
        return leaders

    def _limits(
        self, bounds: Mapping[str, Any], leaders: Mapping[str, tuple[str, float]]
    ) -> dict[tuple[str, int], tuple[float, float]]:
        """Return the limits of each free number by path and record: of its law, its bounds and the laws of its followers."""
        limits = {
            (path, record): (each.low, each.high) for path, each in self.free.items() for record in range(len(self.records))
        }

        def narrow(path: str, record: int, low: float, high: float, name: str, key: str) -> None:
            before = limits[path, record]
            limits[path, record] = (max(before[0], low), min(before[1], high))
            if limits[path, record][0] >= limits[path, record][1]:
                raise ValueError(
                    f"{name}[{quoted(key)}] leaves {path} no value: it must lie in [{before[0]:g}, {before[1]:g}] too"
                )

        for key, pair in bounds.items():
            if not (isinstance(pair, tuple | list) and len(pair) == 2):
                raise TypeError(f"bounds[{quoted(key)}] must be two numbers, as (low, high), not {shortened(pair)}")
            low, high = (arguments.number(f"bounds[{quoted(key)}]", end, brackets="[]") for end in pair)
            if not low < high:
                raise ValueError(f"bounds[{quoted(key)}] = ({low:g}, {high:g}) must have the lower end first")
            for each, records in self._named("bounds", key, self.free):
                for record in records:
                    narrow(each.path, record, low, high, "bounds", key)
        for path, (leader, factor) in leaders.items():
            low, high = sorted((self.known[path].low / factor, self.known[path].high / factor))
            for record in range(len(self.records)):
                narrow(leader, record, low, high, "ties", path)
        return limits

    def _unknown(self, path: str, record: int | None, limits: Mapping[tuple[str, int], tuple[float, float]]) -> Unknown:
        each = self.free[path]
        lows, highs = zip(
            *(limits[path, i] for i in ([record] if record is not None else range(len(self.records)))), strict=True
        )
        name = self._named_of(path, record)
        asked = Unknown(name, each.unit, each.value, max(lows), min(highs))
        if asked.start != each.value:
            warn(
                f"{name} starts at {asked.start:g} {each.unit}: its value {each.value:g} {each.unit} lies out of its bounds",
                RuntimeWarning,
                stacklevel=5,
            )
        return asked

    def _priors(self, priors: Mapping[str, Any], links: tuple[tuple[ParameterLink, ...], ...]) -> tuple[Prior, ...]:
        """Return the priors of the unknowns; those of one record go before those of all."""
        priors_of: dict[tuple[int, str], Prior] = {}
        linked = {link.path for link in links[0]}
        for key, given in sorted(priors.items(), key=lambda item: OF_RECORD in str(item[0])):
            for each, records in self._named("priors", key, linked):
                value, sigma = _prior(key, given, each)
                for record in records:
                    link = next(link for link in links[record] if link.path == each.path)
                    priors_of[link.unknown, each.path] = Prior(link.unknown, link.factor, value, sigma)
        return tuple(priors_of.values())

    def _named(self, name: str, key: object, among: Any = None) -> list[tuple[Parameter, Sequence[int]]]:
        """Return the parameters that a key names, and the records for which: all, or the one behind the @."""
        path, at, record = arguments.text(f"a key of {name}", key).partition(OF_RECORD)
        if at and record not in self.records:
            raise ValueError(f"{name} names record {quoted(record)}; the records are {listed(self.records)}")
        chosen = parameters(name, self.model, [path])
        for each in chosen:
            if among is not None and each.path not in among:
                raise ValueError(f"{name} names {each.path}, which is not free; name it in free, or leave it out of {name}")
            if at and among is not None and each.path in self.free and each.path not in self.own:
                raise ValueError(
                    f"{name} names {each.path} of record {quoted(record)}, but all share it; name it in per_record"
                )
        return [(each, [self.records.index(record)] if at else range(len(self.records))) for each in chosen]


def _prior(key: str, given: object, parameter: Parameter) -> tuple[float, float]:
    """Return value and standard deviation of a prior, in the unit of the parameter."""
    name = f"priors[{quoted(key)}]"
    if isinstance(given, Entry):
        if isinstance(given, Quantity):
            given = given.to(parameter.unit)
        value = given.value if isinstance(given, Quantity) else parameter.value
        if not (sigma := given.sigma(value)):
            raise ValueError(
                f"{name}: its source has neither uncertainty, nor spread of a value that is not 0; give (value, sigma)"
            )
        return value, sigma
    if not (isinstance(given, tuple | list) and len(given) == 2):
        raise TypeError(f"{name} must be (value, sigma), or an Entry with spread or uncertainty, not {shortened(given)}")
    value = arguments.number(f"the value of {name}", given[0], parameter.unit)
    sigma = arguments.bare_number(f"the sigma of {name}", given[1], parameter.unit, low=0.0)
    return value, sigma


@dataclass(frozen=True, eq=False)
class Estimate(ComparedByFields, Presented):
    """Estimate of one parameter.

    Attributes:
        path: of the parameter in the model
        unit: its unit
        start: value before the fit
        value: value after it
        sigma: half the width of the interval that contains the true value with 68 %, by Student's distribution: the standard
            deviation if samples are many; infinite if the data do not determine it
        at_limit: True if the fit ended at a limit of the parameter
        freedom: independent samples beyond the number of unknowns [1]

    >>> import numpy as np
    >>> import strainwave as sw
    >>> speed = np.linspace(1.0, 50.0, 60)
    >>> torque = 0.02 + 3e-4 * speed + 1e-4 * np.random.default_rng(0).normal(size=60)
    >>> table = sw.Recording({"speed": speed, "torque": torque}, {"speed": "rad/s", "torque": "N.m"})
    >>> gear = sw.Gear(friction_input=sw.friction.Coulomb(coulomb=0.01, breakaway=0.01, viscous=3e-4))
    >>> (estimate,) = sw.fit(gear, table, ["friction_input.coulomb"]).estimates
    >>> round(estimate.value, 5), [round(end, 5) for end in estimate.interval()], estimate.unit
    (0.02001, [0.01998, 0.02004], 'N.m')
    """

    path: str
    unit: str
    start: float
    value: float
    sigma: float
    at_limit: bool
    freedom: float = np.inf

    def interval(self, confidence: float = 0.95) -> tuple[float, float]:
        """Return the interval that contains the true value with this probability, if the model is right.

        >>> low, high = Estimate("friction_input.coulomb", "N.m", 0.1, 0.02, 0.001, False, freedom=4.0).interval()
        >>> round(low, 4), round(high, 4)
        (0.0176, 0.0224)
        """
        confidence = arguments.number("confidence", confidence, low=0.0, high=1.0)
        reach = self.sigma * student(confidence, self.freedom) / student(ONE_SIGMA, self.freedom)
        return self.value - reach, self.value + reach

    def _headline(self) -> str:
        limit = ", at its limit" if self.at_limit else ""
        return f"{self.path} = {typeset.uncertain_quantity(self.value, self.sigma, self.unit)}{limit}"
