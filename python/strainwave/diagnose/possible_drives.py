r"""Drives that a set of numbers with spreads may be, in one run: current per error of each, and its current without error.

A kinematic error e acts on the motor in two ways. The output must follow e, which takes torque for its inertia, and the loops
of the controller answer to the motion. The torque T through the gear also acts back on the wave generator with T e'. At order
n, with linear parts and the input held at the speed omega by the controller,

.. math:: i_n = T_c(\mathrm{j} n \omega) \left(\frac{H(n \omega)}{N} + \mathrm{j}\, n\, T\right) \frac{e_n}{K_t}

The first part does not depend on the load, the second is proportional to it. A regression over the load separates them, in a
model and in records. Both are phasors: their sizes do not add up to that of the current.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from strainwave import Drive, arguments
from strainwave.diagnose.actuator_ramp import ERROR_PATH, ActuatorRamp, wave_generator
from strainwave.diagnose.inversion import ERROR_ORDERS, answer_per_error, harmonics, phasors, runs_with_probe
from strainwave.files.gear_set import GearSet
from strainwave.files.recording import Recording
from strainwave.orders.order_spectrum import order_amplitudes
from strainwave.parameters import every
from strainwave.statistics.linear_fit import normal_inverse, order_waves, solved
from strainwave.tuning.drawn import drawn_gears

Array = NDArray[np.float64]
Complex = NDArray[np.complex128]

POSSIBLE_DRIVES = 64  # drawn: determines a standard deviation to 9 %
TREND_DEGREES = 2  # of the polynomial of the current over the angle, by which a record chooses among the drawn drives
MIN_RELATIVE_ORDER = 0.01  # of the largest order of a law [1]: smaller ones are those of rounding
ADDED_LOADS = (0.0, 0.5, 1.0)  # of the unit of load: loads at which the model is run
LOADS_PER_FIT = 2  # a line over the load has two numbers: fewer loads do not determine it


@dataclass(frozen=True)
class CurrentPerError:
    """Current that a kinematic error of each order makes in a run.

    Attributes:
        order: shape (n,)
        inertial: current per error at no torque through the gear: inertia of the output, and loops [A/rad], shape (n,)
        per_torque: current per error and torque through the gear, by the reaction of the error [A/(rad N.m)], shape (n,)
        torque: mean torque through the gear [N.m]
    """

    order: Array
    inertial: Complex
    per_torque: Complex
    torque: float

    @property
    def reaction(self) -> Complex:
        """Current per error by the reaction of the error [A/rad]."""
        return np.asarray(self.per_torque * self.torque)

    @property
    def total(self) -> Complex:
        """Current per error [A/rad]."""
        return np.asarray(self.inertial + self.reaction)

    def if_all_were_reaction(self, order: float) -> complex:
        """Return the error that a diagnosis without the inertial part would report, over the true error.

        Its size is the factor by which the amplitude is wrong, its angle is how far the phase is wrong [rad].
        """
        place = self._place(order)
        return complex(self.total[place] / self.reaction[place])

    def words(self, order: float, error: float) -> str:
        """Return both parts of the current of an error of some amplitude [rad] at an order, as a sentence."""
        place = self._place(order)
        total, inertial, reaction = (
            1e3 * error * abs(complex(part[place])) for part in (self.total, self.inertial, self.reaction)
        )
        wrong = self.if_all_were_reaction(order)
        apart = abs(np.degrees(np.angle(complex(self.inertial[place] / self.reaction[place]))))
        return (
            f"Order {order:g}: {total:.3g} mA, of which {reaction:.3g} mA come from the reaction at {self.torque:.3g} N.m and "
            f"{inertial:.3g} mA from inertia and loops, {apart:.0f} deg apart. Taken "
            f"for reaction alone, the amplitude of the error would be {abs(wrong):.2f} times the true one and its phase "
            f"{np.degrees(np.angle(wrong)):+.0f} deg off."
        )

    def _place(self, order: float) -> int:
        if order not in self.order:
            raise ValueError(f"order = {order:g} is not one of {', '.join(f'{each:g}' for each in self.order)}")
        return int(np.argmin(np.abs(self.order - order)))


@dataclass(frozen=True)
class PartsOverLoad:
    """Line of an order over the torque through the gear: `constant` + `per_torque` T.

    Attributes:
        constant: part that is not the reaction [unit of the lines]
        per_torque: part of the reaction [unit of the lines / N.m]
        sigma: standard deviation of the real and of the imaginary part of each
    """

    constant: complex
    per_torque: complex
    sigma: tuple[float, float]


def parts_over_load(lines: ArrayLike, torque: ArrayLike, sigma: ArrayLike) -> PartsOverLoad:
    """Return the part of an order line that is proportional to the load, and the part that is not.

    The part per torque divided by `CurrentPerError.per_torque` is the kinematic error, without a model of the inertia. All
    records need the same speed and the same zero of the input angle.

    Args:
        lines: amplitude and phase of one order in each record, as complex numbers, shape (records,)
        torque: mean torque through the gear in each [N.m], shape (records,)
        sigma: standard deviation of the real and of the imaginary part of each line, shape (records,)

    >>> parts = parts_over_load([0.02 + 0.01j, 0.02 + 0.11j], [0.0, 20.0], [1e-3, 1e-3])
    >>> round(parts.constant.real, 6), round(parts.per_torque.imag, 6)
    (0.02, 0.005)
    """
    values = np.asarray(lines, dtype=complex)
    loads, noise = arguments.numbers("torque", torque), arguments.numbers("sigma", sigma)
    if values.ndim != 1 or not values.shape == loads.shape == noise.shape:
        raise ValueError(
            f"lines, torque and sigma must be series of one length; shapes {values.shape}, {loads.shape}, {noise.shape}"
        )
    if len(np.unique(loads)) < LOADS_PER_FIT:
        raise ValueError("the records have one load; two different torques determine the part that is proportional to the load")
    design = np.column_stack([np.ones_like(loads), loads]) / noise[:, None]
    line, deviations = solved(design, values / noise), np.sqrt(np.diag(normal_inverse(design)))
    return PartsOverLoad(complex(line[0]), complex(line[1]), (float(deviations[0]), float(deviations[1])))


def current_per_error(ramp: ActuatorRamp) -> CurrentPerError:
    """Return the current that a drive has per kinematic error of each order, from runs of the drive at three loads."""
    load: Any = ramp.drive.load
    inertia = float(load.inertia)
    own = _gain_and_torque(ramp)
    unit = max(abs(own[1]), inertia * (2.0 * ramp.turning) ** 2 / abs(float(ramp.drive.gear.kinematics.ratio)))
    runs = [own] + [_gain_and_torque(ramp.loaded(ramp.load_torque + share * unit)) for share in ADDED_LOADS[1:]]
    gains, torque = np.array([gain for gain, _ in runs]), np.array([load for _, load in runs])
    fits = [parts_over_load(gains[:, place], torque, np.ones(len(runs))) for place in range(len(ERROR_ORDERS))]
    return CurrentPerError(
        np.array(ERROR_ORDERS), np.array([fit.constant for fit in fits]), np.array([fit.per_torque for fit in fits]), own[1]
    )


def _gain_and_torque(ramp: ActuatorRamp) -> tuple[Complex, float]:
    """Return current per error at each order [A/rad], and the mean torque through the gear [N.m]."""
    ((straight, probed),) = runs_with_probe(ramp, [{}], ["current", "torque"])
    return answer_per_error(straight, probed, "current"), order_amplitudes(straight, "torque", ERROR_ORDERS).mean


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
        run = quiet.settled(
            quiet.many([{f"{ERROR_PATH}.housing_eccentricity": law.housing_eccentricity}], ["current"]).member(0)
        )
        orders = harmonics(law)
        has = np.abs(orders) > MIN_RELATIVE_ORDER * np.abs(orders).max()
        answer = phasors(run, "current") - phasors(self.straight, "current")
        return np.where(has, answer / np.where(has, orders, 1.0) / self.nominal, 1.0 + 0.0j)


def _moved(design: Array, values: Complex) -> Complex:
    """Return values of drawn drives, moved to where all columns of the design but the first are zero.

    The residual of the regression is enlarged by the degrees of freedom that the regression took.
    """
    coefficients = solved(design, values)
    rest = values - design @ coefficients
    members, terms = design.shape
    return np.asarray(coefficients[0] + rest * np.sqrt((members - 1.0) / (members - terms)))


def drawn_changes(gear_set: GearSet | Drive, ramp: ActuatorRamp, members: int, seed: int) -> list[dict[str, float]]:
    """Return the numbers in which each drawn drive differs from the nominal one; kinematic errors are not drawn."""
    whole = GearSet.of(gear_set, name="drive", source="assumed") if isinstance(gear_set, Drive) else gear_set
    own = every(ramp.drive)
    draws = {
        path: values
        for path, values in drawn_gears(whole, members, seed).items()
        if not path.startswith(ERROR_PATH) and path in own
    }
    return [{path: float(values[member]) for path, values in draws.items()} for member in range(members)]


def trend(recording: Recording) -> tuple[Array, Array]:
    """Return the polynomial of the current over the angle, in Legendre's terms [A], and its standard deviations by noise.

    The orders are fitted with it, so that none changes the polynomial of a record that has no whole number of revolutions.
    """
    angle, current = recording.values("input_angle", "rad"), recording.values("current", "A")
    terms = np.polynomial.legendre.legvander(2.0 * (angle - angle.min()) / np.ptp(angle) - 1.0, TREND_DEGREES)
    design = np.column_stack([terms, order_waves(angle, ERROR_ORDERS)])
    coefficients = solved(design, current)
    white = float(np.std(np.diff(current - design @ coefficients)) / np.sqrt(2.0))
    covariance = normal_inverse(design)
    kept = TREND_DEGREES + 1
    return coefficients[:kept], white * np.sqrt(np.diag(covariance)[:kept])
