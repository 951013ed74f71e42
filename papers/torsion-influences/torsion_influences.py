"""Influences on a torsion loop: the torsion article's Table 3, row by row, by the models and by measured series.

python papers/torsion-influences/torsion_influences.py [GEAR] [--torque N.m] [--measured series.csv] [--out FOLDER]
"""

from __future__ import annotations

from argparse import ArgumentParser
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cache
from math import log
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import strainwave as sw
from numpy.typing import NDArray
from scipy.stats import linregress, t
from strainwave.rig import Cycle, Factors, Series, Trend, cycle, cycle_to

Array = NDArray[np.float64]

PEAK_TORQUE = 0.36  # N.m, at the input: of the article's loops
SHARES = (0.02, 0.04, 0.07, 0.1, 0.15, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 1.0)  # of the largest torque
LOWEST_SHARE = 0.2  # share of the peak torque at which the article's sweep of amplitudes begins (assumed) [1]
DRAWN = (0.2, 0.4, 0.6, 0.8, 1.0)  # shares whose loops are drawn
MAX_HALVINGS = 50  # of the interval in which a threshold of the torque lies: then it is as narrow as rounding
MIN_LOSSLESS = 1e-3  # of the largest torque: below, a loss that grows with the torque cannot be separated from rounding
NEGLIGIBLE_AREA = 1e-9  # share of the largest torque times the largest angle [1]: a smaller area is rounding
PRELOADS = (0.5, 0.7, 0.85, 1.0, 1.15, 1.3, 1.5, 2.0)  # of the friction at the input
MIN_TORQUE_RATIO = 1.5  # peak torque at the input over its friction from which the table's numbers can be computed [1]
MAX_FRICTION_SHARE = 0.98  # share of the peak torque [1]: with more friction there is no loop
MODULI = (0.8, 0.9, 1.0, 1.1, 1.2)
TEMPERATURE_LEVELS = tuple(273.15 + each for each in (-20.0, 0.0, 20.0, 40.0, 60.0))  # K
FAMILY = "hfuc"  # the only one with ratio 30
FIGURES = ("area", "width", "width_at_zero", "stiffness", "high_stiffness", "low_stiffness")

# ASME B31.3, Table C-6: modulus of carbon steel with 0.3 % carbon or less, 203.4 GPa at 21 degC, 198.6 GPa at 93 degC.
STEEL_SOFTENING_RATE = log(203.4 / 198.6) / 72.0  # 1/K
# Groups of ferritic steel at 21 degC in the same table: least and largest modulus, GPa.
STEELS = (191.7, 203.4)
# Friction current of joint 3 of a UR3 at work, 230 cycles from 32 to 43 degC (UCI 963, CC BY 4.0): 354 mA on average, less
# 8.27 mA per kelvin; 95 %: 2.7 to 13.8 mA.
JOINT_FRICTION_FALL_RATE = 8.27e-3 / 0.3535  # 1/K
LOSS_FACTOR = 1e-3  # of steel, order of magnitude


@dataclass(frozen=True)
class Sweep:
    """Loops over one thing that is varied.

    Args:
        levels: of what is varied, shape (n,)
        figures: of the loops by the names of `FIGURES`, each shape (n,)
        side: the loaded shaft
    """

    levels: Array
    figures: Mapping[str, Array]
    side: str

    @classmethod
    def of(cls, levels: Sequence[float], loops: Sequence[Cycle]) -> Sweep:
        """The figures of loops at levels."""
        figures = {name: np.array([getattr(loop, name) for loop in loops]) for name in FIGURES}
        nothing = np.array([NEGLIGIBLE_AREA * loop.peak * float(np.ptp(loop.angle)) for loop in loops])
        for name in ("area", "width", "width_at_zero"):
            figures[name] = np.where(figures["area"] > nothing, figures[name], 0.0)
        return cls(np.array(levels), figures, loops[0].side)

    def __getitem__(self, name: str) -> Array:
        return self.figures[name]

    def exponent(self, name: str, least: float = 0.0) -> Slope:
        """Power of the levels to which a figure is closest, from a level on, where the figure is not zero."""
        chosen = (self.levels >= least) & (self[name] > 0.0)
        return power(self.levels[chosen], self[name][chosen])

    def local_exponents(self, name: str) -> Array:
        """Power between neighbouring levels, shape (n - 1,); not a number where the figure is zero."""
        with np.errstate(divide="ignore", invalid="ignore"):
            found = np.diff(np.log(self[name])) / np.diff(np.log(self.levels))
        return np.where(np.isfinite(found), found, np.nan)


class Slope(NamedTuple):
    """An exponent and half the width of its 95 % interval."""

    value: float
    half_width: float


def power(x: Array, y: Array) -> Slope:
    """Return the exponent of y ~ x^exponent by regression of the logarithms; none of fewer than three points."""
    if len(x) < 3:
        return Slope(float("nan"), float("inf"))
    line: Any = linregress(np.log(x), np.log(y))
    return Slope(float(line.slope), float(t.ppf(0.975, len(x) - 2) * line.stderr))


@dataclass(frozen=True)
class TemperatureRates:
    """Relative falls per kelvin, each with where it comes from.

    Attributes:
        stiffness, hysteresis, friction: of the torques of spring, hysteresis and friction at the input [1/K]
        sources: in the same order
    """

    stiffness: float
    hysteresis: float
    friction: float
    sources: tuple[str, str, str]

    def factors(self, temperature: float, reference: float) -> Factors:
        """Return the factors of the torques at a temperature [K]."""
        falls = (self.stiffness, self.hysteresis, self.friction)
        return Factors(*(float(np.exp(-fall * (temperature - reference))) for fall in falls))


@dataclass(frozen=True)
class CatalogueRow:
    """Figures of a gear by its maker: K1, K2, K3 [N.m/rad] and T1 [N.m] at the output; half the bound on the loop [rad]."""

    size: int
    ratio: int
    k1: float
    k2: float
    k3: float
    t1: float
    width: float


@dataclass(frozen=True)
class Influence:
    """Test of the article's Table 3 by models and measurements.

    Attributes:
        gear_set: the gear
        torque: largest torque at the output [N.m]
        amplitude: loops over the torque at the output, and those of the article's gear at the input
        lossless: the torque up to which a loop loses nothing, of both gears [N.m]
        drawn: the loops that are drawn of both
        rows: what the catalogue states
        material: loops over the modulus, all springs made of it
        preload: loops at the input over the friction there, relative; None if the input has no friction that holds
        temperature: loops at the input over the temperature
        rates: by which the temperature acts
        friction: what friction at the input holds [N.m]
        shares: of the compliance of a staged gear by its parts: flexspline, bearing, mesh, circular spline
        series: what was measured
        trends: what it shows
    """

    gear_set: sw.GearSet
    torque: float
    amplitude: Mapping[str, Sweep]
    lossless: Mapping[str, float]
    drawn: Mapping[str, tuple[Cycle, ...]] = field(repr=False)
    rows: tuple[CatalogueRow, ...] = field(repr=False)
    material: Sweep
    preload: Sweep | None
    temperature: Sweep
    rates: TemperatureRates
    friction: float
    shares: Mapping[str, float]
    series: Series | None = None
    trends: tuple[Trend, ...] = ()

    @property
    def input_torque(self) -> float:
        """Largest torque at the input [N.m]: that at the output over the ratio."""
        return self.torque / abs(float(self.gear_set.gear.kinematics.ratio))


OWN, SPECIMEN = "gear", "article"


def influence(gear_set: sw.GearSet, torque: float | None = None, series: Series | None = None) -> Influence:
    """Vary the influences of the article's Table 3 with the models, and test a measured series for them.

    Args:
        gear_set: the gear, without stages
        torque: largest torque at the output [N.m]; the rated torque of the set if not given
        series: what was measured

    Raises:
        ValueError: the set has no rated torque and none is given; friction at the input holds all of the torque; or as
            `cycle` and `analyse_series`
    """
    gear = gear_set.gear
    torque = _rated(gear_set) if torque is None else torque
    if not 0.0 < torque < np.inf:
        raise ValueError(f"torque = {torque} N.m must be positive")
    peak, rates, held = torque / abs(float(gear.kinematics.ratio)), rates_of(gear), held_at_rest(gear)
    _check_turns(torque, peak, held)
    trends = tuple(sw.rig.analyse_series(series)) if series is not None else ()
    tested, loops = _specimen()
    amplitude = {OWN: over_torque(gear, torque), SPECIMEN: tested}
    drawn = {OWN: tuple(cycle_to(gear, share * torque) for share in DRAWN), SPECIMEN: loops}
    rows = catalogue_rows()
    warm = {t: rates.factors(t, _reference(gear)) for t in TEMPERATURE_LEVELS}
    return Influence(
        gear_set,
        torque,
        amplitude,
        {OWN: lossless_torque(gear, torque), SPECIMEN: _lossless_of_specimen()},
        drawn,
        rows,
        _over(MODULI, lambda e: cycle_to(gear, torque, factors=Factors(e, 1.0, 1.0))),
        _at_input(gear, peak, held, {f: Factors(friction=f) for f in PRELOADS}) if held > 0.0 else None,
        _at_input(gear, peak, held, warm),
        rates,
        held,
        compliance_shares(),
        series,
        trends,
    )


@cache
def _specimen() -> tuple[Sweep, tuple[Cycle, ...]]:
    """The loops of the article's gear at its input: over the torque, and those that are drawn."""
    tested = sw.rig.printed_gear(0)
    loops = tuple(cycle_to(tested, share * PEAK_TORQUE, side="input") for share in DRAWN)
    return over_torque(tested, PEAK_TORQUE, "input"), loops


@cache
def _lossless_of_specimen() -> float:
    """The torque at the input up to which a loop of the article's gear loses nothing [N.m]; it has no friction there."""
    tested = sw.rig.printed_gear(0)
    ratio = abs(float(tested.kinematics.ratio))
    return lossless_torque(tested, PEAK_TORQUE * ratio) / ratio


def lossless_torque(gear: sw.Gear, torque: float) -> float:
    """Return the largest torque at the output up to which a loop loses nothing [N.m], by bisection.

    Args:
        gear: the gear, without stages
        torque: the largest torque that is looked at [N.m]

    Returns:
        `torque` if no loop up to it loses anything, 0 if all but loops of less than a thousandth of it do.
    """

    def loses(amplitude: float) -> bool:
        loop = cycle(gear, amplitude)
        return loop.area > NEGLIGIBLE_AREA * loop.peak * float(np.ptp(loop.angle))

    low, high = 0.0, torque
    if not loses(high):
        return torque
    for _ in range(MAX_HALVINGS):
        middle = 0.5 * (low + high)
        low, high = (low, middle) if loses(middle) else (middle, high)
    return low if low > MIN_LOSSLESS * torque else 0.0


def over_torque(gear: sw.Gear, torque: float, side: Any = "output") -> Sweep:
    """Loops over the torque level, up to `torque` [N.m]."""
    levels = [share * torque for share in SHARES]
    return Sweep.of(levels, [cycle_to(gear, level, side=side) for level in levels])


def _over(levels: Sequence[float], loop: Callable[[float], Cycle]) -> Sweep:
    return Sweep.of(levels, [loop(level) for level in levels])


def _at_input(gear: sw.Gear, peak: float, held: float, factors: Mapping[float, Factors]) -> Sweep:
    """Loops at the input, but for levels at which friction holds the shaft."""
    turning = {level: each for level, each in factors.items() if each.friction * held < MAX_FRICTION_SHARE * peak}
    return Sweep.of(list(turning), [cycle_to(gear, peak, side="input", factors=each) for each in turning.values()])


def _check_turns(torque: float, peak: float, held: float) -> None:
    if MIN_TORQUE_RATIO * held >= MAX_FRICTION_SHARE * peak:
        raise ValueError(
            f"torque = {torque:g} N.m at the output is {peak:.4g} N.m at the input, where friction holds {held:.4g} N.m: "
            f"too little to vary the friction; take {torque * MIN_TORQUE_RATIO * held / (MAX_FRICTION_SHARE * peak):.3g} N.m "
            "or more"
        )


def _rated(gear_set: sw.GearSet) -> float:
    if "rated_torque" not in gear_set.ratings:
        raise ValueError(f"{gear_set.name} has no rated torque; give the torque [N.m] at the output up to which the loops go")
    return float(gear_set.ratings["rated_torque"].value)


def held_at_rest(gear: sw.Gear) -> float:
    """The torque that friction at the input holds at most [N.m], unloaded: half the width of its loop over a quiet turn."""
    path = np.concatenate((np.linspace(0.0, 1.0, 101), np.linspace(1.0, 0.0, 101)[1:]))
    found = np.asarray(gear.friction_input.quasistatic(path))
    return 0.5 * float(np.ptp(found[len(found) // 4 :]))


def _reference(gear: sw.Gear) -> float:
    return float(gear.softening.reference_temperature)


def rates_of(gear: sw.Gear) -> TemperatureRates:
    """Return the rates of change with temperature: by the gear's own laws, else of steel and of a measured joint's friction."""
    softening, reference = gear.softening, _reference(gear)
    levels = [
        np.asarray(gear.friction_input.quasistatic([0.0, 1.0], temperature=t)).max() for t in (reference, reference + 10.0)
    ]
    own = levels[0] > 0.0 and levels[1] != levels[0]
    return TemperatureRates(
        softening.stiffness_fall if softening.active else STEEL_SOFTENING_RATE,
        softening.hysteresis_fall,
        log(levels[0] / levels[1]) / 10.0 if own else JOINT_FRICTION_FALL_RATE,
        (
            "the gear's softening" if softening.active else "modulus of carbon steel, ASME B31.3, Table C-6",
            "the gear's softening" if softening.active else "assumed: none",
            "the gear's friction" if own else "friction current of a UR3's joint 3 over 230 cycles from 32 to 43 °C (UCI 963)",
        ),
    )


@cache
def catalogue_rows() -> tuple[CatalogueRow, ...]:
    """Return the catalogue's figures of all gears of the family with ratio 30, by size and ratio."""
    return tuple(_catalogue_row(name) for name in sw.catalogue() if name.startswith(f"{FAMILY}-"))


def _catalogue_row(name: str) -> CatalogueRow:
    """K1 and T1 as published are those of spring and hysteresis together, as the gear is loaded for the first time."""
    _, size, ratio = name.split("-")
    gear: Any = sw.GearSet.read(name).gear  # of this family all have a spring of three segments and Maxwell elements
    spring, held = gear.stiffness, float(sum(gear.hysteresis.breakaway))
    t1 = spring.t1 + held
    return CatalogueRow(int(size), int(ratio), spring.k1 * t1 / spring.t1, spring.k2, spring.k3, t1, 2.0 * held / spring.k1)


def compliance_shares(name: str = "tilt-actuator") -> dict[str, float]:
    """Shares of the compliance at the output, wave generator held, of a gear of stages (the actuator paper, Eq. 1 corrected).

    1/K_out = 1/K_t + tan² alpha_t / (K_b r_g²) + 1 / (K_m r_g² cos² alpha_t) + 1/K_CS
    """
    gear: Any = sw.GearSet.read(name).gear  # a linear spring within stages
    stages, radius = gear.structure, float(gear.structure.pitch_radius)
    slope = float(np.tan(stages.pressure_angle))
    parts = {
        "flexspline": 1.0 / gear.stiffness.k,
        "bearing": slope**2 / (stages.bearing_stiffness * radius**2),
        "mesh": (1.0 + slope**2) / (stages.mesh_stiffness * radius**2),
        "circular spline": 1.0 / stages.circular_spline_stiffness,
    }
    return {part: each / sum(parts.values()) for part, each in parts.items()}


def main() -> None:
    """Test the article's table of influences, write tables, figures and page.md into a folder, and print the results."""
    from influence_page import summary, tables, write_page

    options = ArgumentParser(description=main.__doc__)
    options.add_argument("gear", nargs="?", default="csg-25-100", help="a set by name, or a gear file")
    options.add_argument("--torque", type=float, help="largest torque at the output in N.m; by default the rated one")
    options.add_argument("--measured", type=Path, help="a series of loops, as `strainwave rig influence` reads it")
    options.add_argument("--out", type=Path, default=Path("out/torsion-influences"), help="folder of the results")
    given = options.parse_args()
    series = None if given.measured is None else sw.rig.read_series(given.measured)
    found = influence(sw.GearSet.read(given.gear), given.torque, series)
    given.out.mkdir(parents=True, exist_ok=True)
    for name, table in tables(found).items():
        table.to_csv(given.out / f"{name}.csv")
    write_page(found, given.out)
    print(summary(found))
    print(f"wrote {given.out / 'page.md'} and {len(tables(found))} tables beside it")


if __name__ == "__main__":
    main()
