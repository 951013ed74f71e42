r"""Current that a kinematic error makes, separated into the part from the reaction of the error and the part from inertia.

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

from strainwave import arguments
from strainwave.diagnose.actuator_ramp import ActuatorRamp
from strainwave.diagnose.inversion import ORDERS, answer_per_error, runs_with_probe
from strainwave.orders.order_spectrum import order_amplitudes
from strainwave.statistics.linear_fit import normal_inverse, solved

Array = NDArray[np.float64]
Complex = NDArray[np.complex128]

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
        value: Complex = self.per_torque * self.torque
        return value

    @property
    def total(self) -> Complex:
        """Current per error [A/rad]."""
        value: Complex = self.inertial + self.reaction
        return value

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
        return (
            f"Order {order:g}: {total:.3g} mA, of which {reaction:.3g} mA come from the reaction at {self.torque:.3g} N.m and "
            f"{inertial:.3g} mA from inertia and loops, {abs(np.degrees(np.angle(self._ratio(place)))):.0f} deg apart. Taken "
            f"for reaction alone, the amplitude of the error would be {abs(wrong):.2f} times the true one and its phase "
            f"{np.degrees(np.angle(wrong)):+.0f} deg off."
        )

    def _ratio(self, place: int) -> complex:
        return complex(self.inertial[place] / self.reaction[place])

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

    Raises:
        ValueError: there are fewer than two different torques, or shapes differ

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
    found, deviations = solved(design, values / noise), np.sqrt(np.diag(normal_inverse(design)))
    return PartsOverLoad(complex(found[0]), complex(found[1]), (float(deviations[0]), float(deviations[1])))


def current_per_error(ramp: ActuatorRamp) -> CurrentPerError:
    """Return the current that a drive has per kinematic error of each order, from runs of the drive at three loads.

    Args:
        ramp: of the drive; its kinematic error is not used
    """
    load: Any = ramp.drive.load
    inertia = float(load.inertia)
    own = _gain_and_torque(ramp)
    unit = max(abs(own[1]), inertia * (2.0 * ramp.turning) ** 2 / abs(float(ramp.drive.gear.kinematics.ratio)))
    runs = [own] + [_gain_and_torque(ramp.loaded(ramp.load_torque + share * unit)) for share in ADDED_LOADS[1:]]
    gains, torque = np.array([gain for gain, _ in runs]), np.array([load for _, load in runs])
    fits = [parts_over_load(gains[:, place], torque, np.ones(len(runs))) for place in range(len(ORDERS))]
    return CurrentPerError(
        np.array(ORDERS), np.array([fit.constant for fit in fits]), np.array([fit.per_torque for fit in fits]), own[1]
    )


def _gain_and_torque(ramp: ActuatorRamp) -> tuple[Complex, float]:
    """Return current per error at each order [A/rad], and the mean torque through the gear [N.m]."""
    ((straight, probed),) = runs_with_probe(ramp, [{}], ["current", "torque"])
    return answer_per_error(straight, probed, "current"), order_amplitudes(straight, "torque", ORDERS).mean
