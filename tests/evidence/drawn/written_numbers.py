"""Records of every kind, of gears that lack a part of their law: no bound and no rounding is written, listed or exported.

A number of the record's law is 0, has the wrong sign or is too small to be seen, so that a fit ends at a limit. Records are
sums of elementary functions in numpy.
"""

from __future__ import annotations

import tempfile
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import strainwave as sw
from numpy.typing import NDArray
from strainwave.export.joint_numbers import joint
from strainwave.files.gear_set import GearSet
from strainwave.identification.reading.mapping import FileMapping
from strainwave.identification.results.gear_so_far import START_SPREAD
from strainwave.parameters import Parameter, every, plain

from tests.evidence.drawn.outcome import Outcome

Array = NDArray[np.float64]
START = "csg-20-100"
RATIO = 100.0  # of the start set
MIN_NUMBER = 1e-12  # SI; a smaller one that is not 0 is a limit or rounding
MIN_SIGMA = 1e-3  # standard deviations of a number: what is nearer to 0 is rounding
LIMIT_DISTANCE = 1e-6  # relative to a limit, within which a number is that limit
MAX_SPREADS = 2.0  # of the start set, within which a number stays that the record does not determine


@dataclass(frozen=True)
class Law:
    """The part of the law that a record lacks, and the numbers that it has.

    Attributes:
        coulomb, viscous: friction at the input [N.m, N.m.s/rad]
        stiffness: of the spring [N.m/rad]
        curvature: of the spring, cubic [N.m/rad3]
        element: breakaway of a Maxwell element [N.m]
        gravity, inertia: of the load [N.m, kg.m2]
        error: amplitude of the transmission error [rad]
        noise: relative
    """

    coulomb: float
    viscous: float
    stiffness: float
    curvature: float
    element: float
    gravity: float
    inertia: float
    error: float
    noise: float

    @classmethod
    def drawn(cls, random: np.random.Generator) -> Law:
        """Return numbers of which each is missing, of the wrong sign or too small by chance."""

        def some(low: float, high: float) -> float:
            size = float(np.exp(random.uniform(np.log(low), np.log(high))))
            return size * float(random.choice([1.0, 1.0, 1.0, 0.0, 1e-9, -0.1]))

        return cls(
            some(0.01, 0.1), some(1e-4, 1e-3), float(random.uniform(0.8e4, 3e4)), some(1e8, 1e10), some(0.1, 2.0),
            some(1.0, 10.0), some(0.05, 1.0), some(3e-5, 3e-4), float(random.choice([1e-3, 1e-2, 5e-2])),
        )  # fmt: skip

    def friction(self, speed: Array) -> Array:
        """Return the torque of friction at the input [N.m]."""
        return np.asarray(self.coulomb * np.sign(speed) + self.viscous * speed)

    def with_noise(self, values: Array, random: np.random.Generator) -> Array:
        """Return values with noise relative to their size."""
        size = float(np.sqrt(np.mean(values**2)))
        return np.asarray(values + self.noise * size * random.standard_normal(len(values)))


Record = tuple[dict[str, Array], dict[str, str]]


def friction_table(law: Law, random: np.random.Generator) -> Record:
    """Return torques over speeds, one way or both, over a narrow or a wide range."""
    speed = np.geomspace(*random.choice([[1.0, 200.0], [20.0, 60.0], [9.0, 11.0], [0.1, 2.0]]), int(random.integers(5, 20)))
    speed = np.concatenate([speed, -speed]) if random.random() < 0.6 else speed
    return {"speed": speed, "torque": law.with_noise(law.friction(speed), random)}, {"speed": "rad/s", "torque": "N.m"}


def one_speed(law: Law, random: np.random.Generator) -> Record:
    """Return the torque at one constant speed."""
    speed = float(random.uniform(2.0, 100.0)) * np.ones(2000)
    torque = law.friction(speed) + 0.02 * (law.noise + 0.01) * random.standard_normal(2000)
    return {"speed": speed, "torque": torque}, {"speed": "rad/s", "torque": "N.m"}


def _loop(law: Law, random: np.random.Generator, friction: float) -> tuple[Array, Array]:
    """Return twist and torque of a loop, or of its first branch."""
    turns = np.array([0.0, 1.0]) if random.random() < 0.2 else np.array([0.0, 1.0, -1.0, 1.0, -1.0, 1.0])
    twist = float(random.uniform(5e-4, 3e-3)) * np.interp(np.linspace(0.0, len(turns) - 1.0, 600), np.arange(len(turns)), turns)
    torque, slip, limit = law.stiffness * twist + law.curvature * twist**3, 0.0, law.element + friction
    for row, step in enumerate(np.diff(twist, prepend=0.0).tolist()):
        slip = float(np.clip(slip + 0.3 * law.stiffness * step, -abs(limit), abs(limit)))
        torque[row] += np.copysign(1.0, limit) * slip
    return twist, torque


def torsion_at_output(law: Law, random: np.random.Generator) -> Record:
    """Return a torsion loop at the output."""
    twist, torque = _loop(law, random, 0.0)
    return {"twist": twist, "torque": law.with_noise(torque, random)}, {"twist": "rad", "torque": "N.m"}


def torsion_at_input(law: Law, random: np.random.Generator) -> Record:
    """Return a torsion loop at the input, whose friction is inside."""
    twist, torque = _loop(law, random, RATIO * law.coulomb)
    columns = {"input_angle": RATIO * twist, "input_torque": law.with_noise(torque / RATIO, random)}
    return columns, {"input_angle": "rad", "input_torque": "N.m"}


def log(law: Law, random: np.random.Generator) -> Record:
    """Return a log along a motion to and fro or one way, at one speed or several."""
    time = np.arange(0.0, 12.0, 0.01)
    top, period = float(random.uniform(3.0, 60.0)), float(random.uniform(2.0, 5.0))
    several = sum(np.sin(2.0 * np.pi * f * time + random.uniform(0.0, 6.0)) for f in random.uniform(0.1, 0.6, 3))
    rate = (
        top * [np.tanh(30.0 * np.sin(2.0 * np.pi * time / period + 0.3)), several, 1.0 - np.exp(-time)][int(random.integers(3))]
    )
    angle = np.concatenate([[0.0], np.cumsum(0.005 * (rate[1:] + rate[:-1]))])
    torque = law.friction(rate) + law.gravity / RATIO * np.sin(angle / RATIO)
    torque += (2e-5 + law.inertia / RATIO**2) * np.gradient(rate, time)
    columns = {"time": time, "input_angle": angle, "input_torque": law.with_noise(torque, random)}
    return columns, {"time": "s", "input_angle": "rad", "input_torque": "N.m"}


def log_behind_the_gear(law: Law, random: np.random.Generator) -> Record:
    """Return a log of a joint whose torque is measured behind the gear, with an encoder on each side."""
    time = np.arange(0.0, 12.0, 0.01)
    angle = 0.5 * np.sin(1.1 * time) + 0.2 * np.sin(2.9 * time + 1.0)
    rise = -0.605 * np.sin(1.1 * time) - 1.682 * np.sin(2.9 * time + 1.0)
    torque = law.inertia * rise + law.gravity * np.sin(angle)
    twist = torque / law.stiffness
    columns = {
        "time": time, "output_angle": angle + 1e-6 * random.standard_normal(len(time)),
        "input_angle": RATIO * (angle + twist), "joint_torque": law.with_noise(torque, random),
    }  # fmt: skip
    return columns, {"time": "s", "output_angle": "rad", "input_angle": "rad", "joint_torque": "N.m"}


def two_encoders(law: Law, random: np.random.Generator) -> Record:
    """Return angles of both shafts along a turn of the output."""
    theta = np.linspace(0.0, 2.0 * np.pi * RATIO, 8000)
    time = theta / float(random.uniform(5.0, 50.0))
    output = theta / RATIO - law.error * np.sin(2.0 * theta + 0.3) + 1e-6 * random.standard_normal(len(theta))
    return {"time": time, "input_angle": theta, "output_angle": output}, dict.fromkeys(
        ("input_angle", "output_angle"), "rad"
    ) | {"time": "s"}


def presliding(law: Law, random: np.random.Generator) -> Record:
    """Return a small motion to and fro at rest against a bristle."""
    turns = np.array([0.0, 4.0, -4.0, 2.0, -2.0, 3.0, -4.0, 4.0, -3.0, 3.0])
    angle = float(random.choice([1e-4, 1e-3])) * np.interp(np.arange(0.0, 9.0, 0.02), np.arange(10), turns)
    torque, slip = np.zeros(len(angle)), 0.0
    for row, step in enumerate(np.diff(angle, prepend=0.0).tolist()):
        slip = float(np.clip(slip + 40.0 * step, -abs(law.coulomb), abs(law.coulomb)))
        torque[row] = slip
    return {"input_angle": angle, "input_torque": law.with_noise(torque, random)}, {"input_angle": "rad", "input_torque": "N.m"}


def breakaway(law: Law, random: np.random.Generator) -> Record:
    """Return ramps of torque until the shaft breaks away."""
    rising, columns = np.arange(0.0, 4.0, 0.01), {"time": [], "input_angle": [], "input_torque": []}
    place, clock, level = 0.0, 0.0, max(abs(law.coulomb), 1e-3)
    for ramp in range(8):
        way, size = (-1.0) ** ramp, 0.5 * level * rising
        free = np.maximum(rising - 2.0 * (1.0 + 0.01 * float(random.standard_normal())), 0.0)
        columns["time"] += [*(clock + rising), *(clock + 4.0 + np.arange(0.0, 1.0, 0.01))]
        columns["input_torque"] += [*(way * size), *np.zeros(100)]
        columns["input_angle"] += [
            *(place + way * (size / 300.0 + 2.0 * free**2)),
            *np.full(100, place + way * 2.0 * free[-1] ** 2),
        ]
        place, clock = columns["input_angle"][-1], clock + 5.0
    found = {name: np.array(values) for name, values in columns.items()}
    found["input_angle"] = found["input_angle"] + 1e-5 * random.standard_normal(len(found["time"]))
    return found, {"time": "s", "input_angle": "rad", "input_torque": "N.m"}


KINDS: Mapping[str, Callable[[Law, np.random.Generator], Record]] = {
    each.__name__: each
    for each in (
        friction_table, torsion_at_output, torsion_at_input, two_encoders, presliding, breakaway, one_speed, log,
        log_behind_the_gear,
    )
}  # fmt: skip


def outcome(seed: int) -> Outcome:
    """Return the outcome of one record; its kind is the remainder of the seed by their count."""
    return of_kind(tuple(KINDS)[seed % len(KINDS)], seed)


def of_kind(kind: str, seed: int) -> Outcome:
    """Return the outcome of a record of a kind."""
    random = np.random.default_rng(seed)
    columns, units = KINDS[kind](Law.drawn(random), random)
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder, f"{kind}.csv")
        sw.Recording(columns, units).to_csv(file)
        try:
            found = sw.identify(START, [file], accept=True, mapping=FileMapping(constants={"ratio": RATIO}))
        except ValueError as error:
            return Outcome("refused", f"{kind}: {error}")
        written = Path(folder, "gear.toml")
        found.gear_set.save(written)
        wrong = [*_of_gear(found, GearSet.read(written)), *_of_lists(found)]
        if not wrong and found.gear_set.load is not None and found.gear_set.motor is not None:
            wrong = [*_of_export(written)]
    return Outcome("wrong" if wrong else "right", f"{kind}: {'; '.join(wrong)}")


def _of_gear(found: sw.identification.Identified, saved: GearSet) -> Iterator[str]:
    """Yield the numbers of a written gear that are limits or rounding, or that are far from the start set without a reason.

    A number that is not identified is that of the start set within its spread, unless the record excludes that.
    """
    before = every(found.start_set.gear)
    estimates = {plain(each.path): each for file in found.files for each in file.estimates}
    for path, each in every(saved.gear).items():
        old = before[path].value if path in before else 0.0
        if old == each.value:
            continue
        size, estimate = abs(each.value), estimates.get(plain(f"gear.{path}"))
        sigma = 0.0 if estimate is None or not np.isfinite(estimate.sigma) else estimate.sigma
        if 0.0 < size < max(MIN_NUMBER, MIN_SIGMA * sigma) or _is_limit(each):
            yield f"{path} = {each.value:.3g} is a limit or rounding"
        elif estimate is not None and estimate.state == "not identified" and old:
            spread = START_SPREAD * abs(old)
            if abs(each.value - old) > MAX_SPREADS * spread and not estimate.sigma < spread:
                yield f"{path} = {each.value:.3g} is not identified ({estimate.why}), and the start set has {old:.3g}"


def _is_limit(each: Parameter) -> bool:
    """True if a number is a limit of its law other than 0."""
    ends = (end for end in (each.low, each.high) if np.isfinite(end) and abs(end) > 0.0)
    return any(abs(each.value - end) < LIMIT_DISTANCE * abs(end) for end in ends)


def _of_lists(found: sw.identification.Identified) -> Iterator[str]:
    """Yield the estimates that are rounding, and those that are listed as identified and are a limit of 0.

    One that is not identified, and that the set has no prior of, stays where its fit started: it is not written.
    """
    for each in (estimate for file in found.files for estimate in file.estimates if estimate.state != "not identified"):
        if 0.0 < abs(each.value) < MIN_NUMBER and not each.is_phase:
            yield f"{each.path} = {each.value:.3g} ± {each.sigma:.2g} is rounding"
    for each in (parameter.estimate for parameter in found.parameters):
        if each.value == 0.0 and not each.is_phase:
            yield f"{each.path} = 0 ± {each.sigma:.2g} is listed as identified"


def _of_export(written: Path) -> Iterator[str]:
    """Yield the numbers of an export that are rounding."""
    for name, (value, unit) in joint(written).numbers.items():
        if 0.0 < abs(value) < MIN_NUMBER:
            yield f"an export contains {name} = {value:.3g} {unit}"
