"""Drives that a set of numbers with spreads may be, in one run: current per error of each, and its current without error."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from strainwave import Drive
from strainwave.diagnose.actuator_ramp import ERROR, ActuatorRamp, wave_generator
from strainwave.diagnose.inversion import ORDERS, answer_per_error, harmonics, phasors, runs_with_probe
from strainwave.diagnose.reaction import CurrentPerError, current_per_error
from strainwave.files.gear_set import GearSet
from strainwave.files.recording import Recording
from strainwave.parameters import every
from strainwave.statistics.linear_fit import normal_inverse, order_waves, solved
from strainwave.tuning.drawn import drawn_gears

Array = NDArray[np.float64]
Complex = NDArray[np.complex128]

POSSIBLE_DRIVES = 64  # drawn: determines a standard deviation to 9 %
TREND_DEGREES = 2  # of the polynomial of the current over the angle, by which a record chooses among the drawn drives
MIN_RELATIVE_ORDER = 0.01  # of the largest order of a law [1]: smaller ones are those of rounding


@dataclass(frozen=True)
class PossibleDrives:
    """Drives that a set may be, in one run: current per error, current without error, and trend of the current.

    Attributes:
        ramp: run, with the nominal drive
        straight: recording of the nominal drive without error, after the run-in
        nominal: current per error of the nominal drive [A/rad], shape (4,)
        gains: current per error of each drawn drive [A/rad], shape (members, 4)
        ripple: orders of the current of each drawn drive without error, less those of the nominal one [A], shape (members, 4)
        trends: polynomial of the current over the angle, of each drawn drive [A], shape (members, 3)
        parts: current per error of the nominal drive, separated
        law: `Misalignment` of the drive, straight
    """

    ramp: ActuatorRamp
    straight: Recording
    nominal: Complex
    gains: Complex
    ripple: Complex
    trends: Array
    parts: CurrentPerError
    law: Any

    @classmethod
    def of(cls, gear_set: GearSet | Drive, ramp: ActuatorRamp, members: int = POSSIBLE_DRIVES, seed: int = 0) -> PossibleDrives:
        """Run the nominal drive and drawn ones, each without error and with a small error of all orders.

        Args:
            gear_set: the drive with the sources and spreads of its numbers; those of a bare `Drive` count as assumed
            ramp: the run, of that drive
            members: number of drawn drives
            seed: of the draws
        """
        pairs = runs_with_probe(ramp, [{}, *drawn_changes(gear_set, ramp, members, seed)], ["current"])
        gains = np.array([answer_per_error(*pair, "current") for pair in pairs])
        ripple = np.array([phasors(straight, "current") for straight, _ in pairs])
        trends = np.array([trend(straight)[0] for straight, _ in pairs[1:]])
        law, _ = wave_generator(ramp.drive)
        return cls(ramp, pairs[0][0], gains[0], gains[1:], ripple[1:] - ripple[0], trends, current_per_error(ramp), law)

    def like(self, recording: Recording) -> tuple[Complex, Complex, Array]:
        """Return gains and ripple of the drives whose current has the trend of a record, and how far the trend is off.

        Gain and ripple of each drawn drive are moved along their regression over the trend, to the trend of the record.

        Returns:
            Gains, shape (members, 4); ripple, shape (members, 4); distance of the trend of the record from the mean of the
            drawn drives, in standard deviations, shape (3,).
        """
        here, sigma = trend(recording)
        chance = np.random.default_rng(0)
        measured = self.trends + sigma * chance.standard_normal(self.trends.shape)
        scale = np.maximum(measured.std(axis=0, ddof=1), 1e-9)
        off = (here - measured.mean(axis=0)) / scale
        design = np.column_stack([np.ones(len(measured)), (measured - here) / scale])
        gains = self.nominal * np.exp(_moved(design, np.log(self.gains / self.nominal)))
        return gains, _moved(design, self.ripple), off

    def gain_of_size(self, law: Any) -> Complex:
        """Return the current per error of the nominal drive with a misalignment, over that with a small error, shape (4,).

        The torque through the gear swings with the error, so that the reaction has a part with its square. Orders that the law
        does not have are not changed.
        """
        quiet = self.ramp.without_noise().with_error(law)
        run = quiet.settled(quiet.many([{f"{ERROR}.housing_eccentricity": law.housing_eccentricity}], ["current"]).member(0))
        orders = harmonics(law)
        has = np.abs(orders) > MIN_RELATIVE_ORDER * np.abs(orders).max()
        answer = phasors(run, "current") - phasors(self.straight, "current")
        return np.where(has, answer / np.where(has, orders, 1.0) / self.nominal, 1.0 + 0.0j)


def _moved(design: Array, values: Complex) -> Complex:
    """Return values of drawn drives, moved to where all columns of the design but the first are zero.

    The residual of the regression is enlarged by the degrees of freedom that the regression took.
    """
    found = solved(design, values)
    rest = values - design @ found
    members, terms = design.shape
    moved: Complex = found[0] + rest * np.sqrt((members - 1.0) / (members - terms))
    return moved


def drawn_changes(gear_set: GearSet | Drive, ramp: ActuatorRamp, members: int, seed: int) -> list[dict[str, float]]:
    """Return the numbers in which each drawn drive differs from the nominal one; kinematic errors are not drawn."""
    whole = GearSet.of(gear_set, name="drive", source="assumed") if isinstance(gear_set, Drive) else gear_set
    own = every(ramp.drive)
    draws = {
        path: values for path, values in drawn_gears(whole, members, seed).items() if not path.startswith(ERROR) and path in own
    }
    return [{path: float(values[member]) for path, values in draws.items()} for member in range(members)]


def trend(recording: Recording) -> tuple[Array, Array]:
    """Return the polynomial of the current over the angle, in Legendre's terms [A], and its standard deviations by noise.

    The orders are fitted with it, so that none changes the polynomial of a record that has no whole number of revolutions.
    """
    angle, current = recording.values("input_angle", "rad"), recording.values("current", "A")
    terms = np.polynomial.legendre.legvander(2.0 * (angle - angle.min()) / np.ptp(angle) - 1.0, TREND_DEGREES)
    design = np.column_stack([terms, order_waves(angle, ORDERS)])
    found = solved(design, current)
    white = float(np.std(np.diff(current - design @ found)) / np.sqrt(2.0))
    covariance = normal_inverse(design)
    kept = TREND_DEGREES + 1
    return found[:kept], white * np.sqrt(np.diag(covariance)[:kept])
