"""Inverse dynamics: the inertia and friction of a rigid drive, from a log of its position and actuator torque.

    torque = inertia * acceleration + viscous * speed + coulomb * sign(speed) + offset

is linear in its four parameters, so that least squares on measured motion finds them (IDIM-LS: Gautier, "Dynamic
identification of robots with power model", ICRA 1997; Janot, Vandanjon & Gautier, "A generic instrumental variable
approach for industrial robot identification", IEEE Trans. Control Syst. Technol. 22 (2014) 132-145). What decides its
quality is the filtering:

* The position is low-passed without phase shift (Butterworth, order 4, forward and backward) at `cutoff`, and
  differentiated by central differences.
* Torque and all four regressors then pass one and the same zero-phase decimation filter, which keeps frequencies up to
  0.4 `cutoff`. A filter common to both sides of a linear equation does not bias it, so the pass band may be chosen
  freely; and within it the first filter changes the position by less than 0.1 %. The ratio 0.4 is the rule of the
  literature, "position at 5, decimation at 2 times the bandwidth of the motion" (scripts of the EMPS benchmark).
* Noise of the position pulls the inertia towards zero by its share in the power of the filtered acceleration, a share
  that grows with the fifth power of frequency. In a closed loop it also returns through the controller, correlated with
  the torque. The default cut-off is therefore the highest at which the share stays below 0.1 %, and at most a tenth of
  the sampling rate, where central differences still hold to about 1 % at the edge of the pass band.
* Coulomb friction has no definite value at rest. There both sides of the equation are set to zero before the decimation
  filter, so that no torque at rest reaches the fit. A stop shorter than 2 / `cutoff` passes for motion.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray
from strainwave import arguments
from strainwave.equality import ComparedByFields
from strainwave.identification.experiments.motion import near_rest, spectra, widest_cutoff

PARAMETERS = ("inertia", "viscous", "coulomb", "offset")

Array = NDArray[np.float64]

_JITTER = 0.01  # of a sampling step
_EDGE_ROWS = 5  # lost to the ends of the filters, each side
_LARGEST = 1e12  # in SI units; of a step, at least the reciprocal
_FEWEST_ROWS = 10  # in each direction of motion (assumed)


@dataclass(frozen=True, eq=False)
class RigidDrive(ComparedByFields):
    """A rigid drive with viscous and Coulomb friction, as identified.

    torque = inertia * acceleration + viscous * speed + coulomb * sign(speed) + offset

    Units are those of a rotary drive; for a linear one read kg, N.s/m, N, N, m/s, m/s2.

    Attributes:
        inertia: inertia that the actuator moves [kg.m2]
        viscous: viscous friction coefficient [N.m.s/rad]
        coulomb: kinetic friction torque [N.m]
        offset: constant torque: a load, or half the difference of the friction in the two directions [N.m]
        covariance: of (inertia, viscous, coulomb, offset), shape (4, 4)
        residual_rms: root mean square of measured minus modelled torque in the pass band [N.m]
        cutoff: of the filter on the position [Hz]; the pass band ends at 0.4 of it
        samples: decimated samples that the fit rests on
    """

    inertia: float
    viscous: float
    coulomb: float
    offset: float
    covariance: Array
    residual_rms: float
    cutoff: float
    samples: int

    @property
    def parameters(self) -> Array:
        """The four parameters in the order of `PARAMETERS`, shape (4,)."""
        return np.array([self.inertia, self.viscous, self.coulomb, self.offset])

    @property
    def standard_deviation(self) -> Array:
        """Standard deviation of each parameter, in its own unit, shape (4,)."""
        return np.sqrt(np.diag(self.covariance))

    @property
    def correlation(self) -> Array:
        """Correlation of the parameters; near ±1 the record does not separate the two, shape (4, 4)."""
        return self.covariance / np.outer(self.standard_deviation, self.standard_deviation)

    def torque(self, speed: ArrayLike, acceleration: ArrayLike) -> Array:
        """Torque that this motion needs [N.m]; at rest, where friction is indefinite, without the Coulomb part.

        Args:
            speed: of the drive [rad/s], shape (n,)
            acceleration: of the drive [rad/s2], shape (n,)
        """
        return _columns(np.asarray(speed, float), np.asarray(acceleration, float)) @ self.parameters


@dataclass(frozen=True, eq=False)
class Regression(ComparedByFields):
    """The rows of the inverse dynamic model of one record, filtered and decimated: matrix @ parameters = torque.

    Attributes:
        time: of each row [s], shape (n,)
        matrix: acceleration [rad/s2], speed [rad/s], sign of the speed, one, shape (n, 4)
        torque: [N.m], shape (n,)
        cutoff: of the filter on the position [Hz]
    """

    time: Array
    matrix: Array
    torque: Array
    cutoff: float


def rigid_drive(position: ArrayLike, torque: ArrayLike, time: ArrayLike, *, cutoff: float | None = None) -> RigidDrive:
    """Inertia, viscous and Coulomb friction and offset of a rigid drive, by inverse dynamics and least squares.

    The covariance is that of Newey and West, which allows for residuals that are correlated and of unequal size. The
    textbook s²(XᵀX)⁻¹ counts every decimated sample as independent. They are not: the decimation filter leaves 0.8 of
    their number, and what the model misses about friction lasts for many samples.

    Args:
        position: measured [rad], shape (n,)
        torque: of the actuator, at the same instants [N.m], shape (n,)
        time: uniform to 1 % of a step [s], shape (n,)
        cutoff: of the filter on the position [Hz]; by default the highest that the noise of the position and the
            sampling rate allow (see this module). Set it where the drive is not rigid: 0.4 `cutoff` must lie well
            below the first elastic mode.

    Raises:
        ValueError: arrays that are not finite, of unequal length or too short; time that does not rise uniformly; a
            cut-off with no period within the record, or above half the sampling rate; a position whose noise hides the
            motion; motion in one direction only, which leaves `coulomb` and `offset` one inseparable constant.

    Valid for a drive that is rigid in the pass band, with friction that depends on speed alone. What the four terms
    miss (position- or load-dependent friction, Stribeck effect) widens the covariance but can also bias the parameters.
    A torque recorded late by d adds inertia w sin(w d) to `viscous` for motion at w [rad/s]; a controller output that
    is held over the step is recorded half a step early. Standard deviations come out low where residuals stay
    correlated for long: by up to a third in trials with a correlation time of 1 % of the record.

    Source: see this module; covariance: Newey & West, Econometrica 55 (1987) 703-708, number of lags: Andrews,
    Econometrica 59 (1991) 817-858, section 6.

    Example:
        >>> import numpy as np
        >>> time = np.arange(0.0, 4.0, 1e-3)
        >>> position, speed, acceleration = np.sin(5.0 * time), 5.0 * np.cos(5.0 * time), -25.0 * np.sin(5.0 * time)
        >>> drive = rigid_drive(position, 0.5 * acceleration + 0.2 * speed + 0.3 * np.sign(speed) + 0.1, time)
        >>> [round(float(value), 2) for value in drive.parameters]
        [0.5, 0.2, 0.3, 0.1]
    """
    rows = regression(position, torque, time, cutoff=cutoff)
    inverse = np.asarray(np.linalg.pinv(rows.matrix), dtype=float)
    parameters = inverse @ rows.torque
    residual = rows.torque - rows.matrix @ parameters
    inertia, viscous, coulomb, offset = parameters.tolist()
    return RigidDrive(
        inertia=inertia,
        viscous=viscous,
        coulomb=coulomb,
        offset=offset,
        covariance=_covariance(inverse.T, residual),
        residual_rms=float(np.sqrt(np.mean(residual**2))),
        cutoff=rows.cutoff,
        samples=len(residual),
    )


def regression(position: ArrayLike, torque: ArrayLike, time: ArrayLike, *, cutoff: float | None = None) -> Regression:
    """The filtered and decimated rows from which `rigid_drive` identifies; arguments and errors are the same.

    On a second record, with the `cutoff` of the first, `rows.matrix @ drive.parameters` against `rows.torque` is the
    cross-validation of an identified drive.
    """
    from scipy import signal

    position, torque, time = _checked(position, torque, time)
    step = float(time[-1] - time[0]) / (len(time) - 1)
    frequency, acceleration, noise, position_noise = spectra(position, step)
    if cutoff is None:
        cutoff = widest_cutoff(frequency, acceleration, noise, 1 / step)
    # from one period within the record to half the sampling rate
    cutoff = arguments.number("cutoff", cutoff, "Hz", low=1.0 / float(time[-1] - time[0]), high=0.5 / step)
    every = round(1 / (step * cutoff))  # the filter of `decimate` ends at 0.8 of its Nyquist frequency: 0.4 cut-off

    smooth = signal.sosfiltfilt(signal.butter(4, cutoff, fs=1 / step, output="sos"), position)
    speed = (smooth[2:] - smooth[:-2]) / (2 * step)
    # Not the central difference of the speed: its error is four times larger.
    columns = _columns(speed, np.diff(smooth, 2) / step**2)
    # At rest and at the ends of the filters both sides of the equation are zeroed before the decimation filter, which
    # would otherwise carry their error into its neighbourhood.
    valid = ~near_rest(position, every, position_noise)[1:-1]
    valid[: _EDGE_ROWS * every] = valid[-_EDGE_ROWS * every :] = False
    rows = valid[::every]
    _require_both_directions(speed[::every][rows], cutoff)
    return Regression(
        time=time[1:-1:every][rows],
        matrix=signal.decimate(columns * valid[:, None], every, axis=0)[rows],
        torque=signal.decimate(torque[1:-1] * valid, every)[rows],
        cutoff=cutoff,
    )


def _columns(speed: Array, acceleration: Array) -> Array:
    return np.stack([acceleration, speed, np.sign(speed), np.ones_like(speed)], axis=-1)


def _covariance(weights: Array, residual: Array) -> Array:
    """Newey-West covariance of weights.T @ measurement with its four degrees of freedom, shape (4, 4)."""
    count, freedom = len(residual), len(residual) - weights.shape[1]
    scores = weights * residual[:, None]
    total = scores.T @ scores
    lags = _correlated_lags(residual)
    for lag in range(1, lags + 1):
        product = scores[lag:].T @ scores[:-lag]
        total += (1 - lag / (lags + 1)) * (product + product.T)
    covariance: Array = total * count / freedom
    return covariance


def _correlated_lags(residual: Array) -> int:
    """Andrews' number of lags for the Bartlett kernel, with the residual taken as a first-order autoregression."""
    power = float(residual @ residual) or 1.0
    correlation = float(residual[1:] @ residual[:-1]) / power
    strength = 4 * correlation**2 / (1 - correlation**2) ** 2
    return min(int(1.1447 * np.cbrt(strength * len(residual))), len(residual) // 4)


def _checked(position: ArrayLike, torque: ArrayLike, time: ArrayLike) -> tuple[Array, Array, Array]:
    given = {"position": position, "torque": torque, "time": time}
    arrays = {name: arguments.numbers(name, values) for name, values in given.items()}
    fewest = 2 * (_EDGE_ROWS + _FEWEST_ROWS)
    for name, values in arrays.items():
        if values.shape != (values.size,) or values.size != arrays["time"].size:
            raise ValueError(f"{name} has shape {values.shape}, time {arrays['time'].shape}; all must be equal, (n,)")
        if values.size < fewest:
            raise ValueError(f"{name} has {values.size} samples; at least {fewest} are needed")
        if not np.isfinite(values).all():
            place = int(np.flatnonzero(~np.isfinite(values))[0])
            raise ValueError(f"{name}[{place}] = {values[place]} must be finite")
        if not np.abs(values).max() < _LARGEST:
            raise ValueError(f"{name} goes up to {np.abs(values).max():g}; it must stay below {_LARGEST:g}")
    _require_uniform(arrays["time"])
    return arrays["position"], arrays["torque"], arrays["time"]


def _require_uniform(time: Array) -> None:
    falls = np.flatnonzero(np.diff(time) <= 0)
    if falls.size:
        place = int(falls[0])
        raise ValueError(f"time[{place + 1}] = {time[place + 1]:g} s must exceed time[{place}] = {time[place]:g} s")
    step = (time[-1] - time[0]) / (len(time) - 1)
    if step < 1.0 / _LARGEST:
        raise ValueError(f"time: its steps of {step:g} s must be longer than {1.0 / _LARGEST:g} s")
    jitter = np.abs(time - np.linspace(time[0], time[-1], len(time))) / step
    worst = int(np.argmax(jitter))
    if jitter[worst] > _JITTER:
        raise ValueError(
            f"time[{worst}] = {time[worst]:g} s lies {jitter[worst]:.2g} steps of {step:g} s off a uniform grid; "
            f"at most {_JITTER:g} is allowed, resample first"
        )


def _require_both_directions(speed: Array, cutoff: float) -> None:
    forward, backward = int(np.sum(speed > 0)), int(np.sum(speed < 0))
    if min(forward, backward) < _FEWEST_ROWS:
        raise ValueError(
            f"position moves forward in {forward} and backward in {backward} samples decimated at {cutoff:g} Hz; "
            f"at least {_FEWEST_ROWS} each are needed to separate coulomb from offset"
        )
