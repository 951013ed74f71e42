r"""Detection limit: the smallest kinematic error that the motor current of a drive shows, computed before anything is recorded.

The drive is simulated twice in its own closed loop, with noise-free sensors: without error, and with an error of the order. The
difference of the waves of the current over the error is the gain G [A/rad]. Noise of standard deviation :math:`\sigma_i` in M
samples leaves :math:`\sigma = \sigma_i \sqrt{2 / M}` (RifeBoorstyn1974). The smallest signal to noise :math:`\sqrt{\lambda}`
that the test of `order_lines` detects follows from the non-central F distribution (Kay1998):

.. math:: A_{\min} = \frac{\sigma \sqrt{\lambda}}{|G|}
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import hypot, inf, pi, sqrt, tau
from typing import Any

import numpy as np
from numpy.typing import NDArray

from strainwave import Drive, arguments, kinematic_error, typeset
from strainwave.diagnose.actuator_ramp import ERROR_PATH, longest_step, noises
from strainwave.diagnose.detection import DETECTION_PROBABILITY, FALSE_ALARM, needed_signal_to_noise
from strainwave.diagnose.regression import MAX_SAMPLES, OrderRegression, motion_of, regressions
from strainwave.files.recording import Recording
from strainwave.files.typical_gear import RAD_PER_ARCMIN
from strainwave.messages import listed
from strainwave.presentation import Presented
from strainwave.progress import Progress, in_turn
from strainwave.simulation.run import simulate
from strainwave.simulation.scenario import constant, ramp
from strainwave.simulation.signals import outputs

Array = NDArray[np.float64]

FIRST_PROBE = RAD_PER_ARCMIN  # rad: error of the first run; later ones have the limit itself
PROBE_RUNS = 3  # runs with an error at most
MIN_PROBE_CHANGE = 1e-3  # relative change of the error [1], below which a further run would show the same gain
MAX_PROBE = 60.0 * RAD_PER_ARCMIN  # rad: error of any run
MIN_PROBE = 1e-3 * RAD_PER_ARCMIN  # rad
MAX_CATALOGUE_AMPLITUDE = RAD_PER_ARCMIN  # rad: half of 2 arcmin peak to peak, the bound of the least accurate catalogue gears
RUN_IN_TURNS = 2.0  # revolutions of the input before the record
MIN_RUN_IN = 1.0  # s
MAX_DURATION = 3600.0  # s, of the record
MIN_TURNS = 3.0  # of the input, in the record
MIN_SPEED_SHARE = 0.9  # of the speed asked for [1], that a drive must reach
CURRENT_COLUMN = "current"


@dataclass(frozen=True)
class SteadyRun:
    """Motion at one speed under one load.

    Attributes:
        drive: with noise-free sensors, its own kinematic error replaced
        speed: of the input [rad/s], as a size
        load_torque: at the output [N.m]
        duration: of the record, after the run-in [s]
        sample_rate: of the current [Hz]
        order: of the error, periods per revolution of the input [1]
    """

    drive: Drive
    speed: float
    load_torque: float
    duration: float
    sample_rate: float
    order: float

    @classmethod
    def of(cls, drive: Drive, speed: float, load_torque: float, duration: float, sample_rate: float, order: float) -> SteadyRun:
        """Return the run, with noise-free sensors."""
        speed = arguments.number("speed", speed, "rad/s", low=0.0)
        load_torque = arguments.number("load_torque", load_torque, "N.m")
        duration = arguments.number("duration", duration, "s", "(]", 0.0, MAX_DURATION)
        sample_rate = arguments.number("sample_rate", sample_rate, "Hz", "(]", 0.0, MAX_SAMPLES / duration)
        order = arguments.number("order", order, low=0.0)
        if (turns := speed * duration / tau) * min(order, 1.0) < MIN_TURNS:
            needed = MIN_TURNS / min(order, 1.0) * tau / speed
            raise ValueError(
                f"duration = {duration:g} s is {turns:.3g} revolutions of the input; order {order:g} needs "
                f"{needed:.4g} s at this speed"
            )
        if order * speed / pi > 0.4 * sample_rate:
            raise ValueError(
                f"sample_rate = {sample_rate:g} Hz has less than 5 samples in a period of order {order:g}; take "
                f"{2.5 * order * speed / pi:.4g} Hz or more"
            )
        if CURRENT_COLUMN not in (known := outputs(drive)):
            raise ValueError(
                f"the drive records no current, only {listed(known)}; give it a motor that has one, as DC or CurrentSource"
            )
        quiet = drive.replace(dict.fromkeys(noises(drive, "amplitude"), 0.0))
        return cls(quiet, speed, load_torque, duration, sample_rate, order)

    @property
    def run_in(self) -> float:
        """Time before the record, whole samples [s]."""
        wanted = max(MIN_RUN_IN, RUN_IN_TURNS * tau / self.speed)
        return float(np.ceil(wanted * self.sample_rate)) / self.sample_rate

    def with_error(self, amplitude: float, phase: float = 0.0) -> Recording:
        """Return the record of a run with an error of the order, after the run-in: amplitude at the output, phase [rad]."""
        return self.with_law(kinematic_error.Fourier(order=[self.order], amplitude=[amplitude], phase=[phase]))

    def with_law(self, law: Any) -> Recording:
        """Return the record of a run with a law of the kinematic error in place of the drive's own, after the run-in."""
        drive = self.drive.replace({ERROR_PATH: law})
        ratio = float(drive.gear.kinematics.ratio)
        output = self.speed / abs(ratio)
        length = self.run_in + self.duration
        start = {"output_speed": output, "input_speed": output * ratio}
        is_speed_loop = getattr(self.drive.control, "law", self.drive.control).name == "pi"
        run = simulate(
            drive,
            constant(output, length) if is_speed_loop else ramp(output, length),
            min(longest_step(drive), 1.0 / self.sample_rate),
            sample=1.0 / self.sample_rate,
            load_torque=self.load_torque,
            initial=start,
            record=["input_angle", "output_angle", CURRENT_COLUMN],
        )
        record = run.between(self.run_in, length)
        angle, wanted = record["input_angle"], self.speed * self.duration
        turned = float(angle[-1] - angle[0]) * float(np.sign(ratio))
        if not MIN_SPEED_SHARE * wanted <= turned <= wanted / MIN_SPEED_SHARE:
            raise ValueError(
                f"the drive turns its input by {turned:.4g} rad in {self.duration:g} s, loaded with {self.load_torque:g} N.m; "
                f"speed = {self.speed:g} rad/s makes {wanted:.4g} rad. Take a lower speed or load, or a drive with a controller"
            )
        return record

    def gain(self, healthy: RecordedOrder, amplitude: float) -> complex:
        """Return amplitude and phase of the current per error at an amplitude of the error at the output [rad] [A/rad].

        Hysteresis and friction answer a small error otherwise than a large one.
        """
        return (RecordedOrder.of(self.with_error(amplitude), self.order).wave - healthy.wave) / amplitude


@dataclass(frozen=True, eq=False)
class RecordedOrder:
    """Regression of an order on the motion of a record, with the current of the record.

    Attributes:
        regression: of the order
        series: current in averaged rows [A], shape (n,)
        every: samples averaged in one row
        revolutions: of the input in the rows
    """

    regression: OrderRegression
    series: Array
    every: int
    revolutions: float

    @classmethod
    def of(cls, record: Recording, order: float) -> RecordedOrder:
        """Return the regression of an order on a record."""
        motion = motion_of(record, CURRENT_COLUMN, order)
        return cls(regressions(motion, [order])[0], motion.series, motion.every, motion.revolutions)

    @property
    def samples(self) -> int:
        """M, samples of the record that are used."""
        return len(self.series) * self.every

    @property
    def wave(self) -> complex:
        """Amplitude times exp(j phase) of the order [A], as of a sine."""
        sine, cosine = (self.regression.mean_estimator @ self.series).tolist()
        return complex(sine, cosine)

    @property
    def own_noise(self) -> float:
        """Standard deviation of a sample of white noise with the level that the current itself has around the order [A]."""
        return sqrt(self.every * float(self.regression.variance(self.series[:, None])[0]))

    def sigma(self, noise: float) -> float:
        """Return the standard deviation of an amplitude [A] under white noise of a sample [A]."""
        return noise * sqrt(0.5 * float(np.trace(self.regression.mean_factor)) / self.every)


@dataclass(frozen=True)
class DetectionLimit(Presented):
    """Smallest kinematic error of an order that the motor current shows.

    Attributes:
        order: periods per revolution of the input [1]
        amplitude: of the error at the output [rad]; inf if the current does not answer
        current: amplitude of the current that it makes [A]
        gain: amplitude and phase of the current over the error [A/rad]
        sigma: standard deviation of an amplitude of the current by the noise [A]
        signal_to_noise: amplitude over standard deviation that is needed [1]
        freedom: degrees of freedom of the level of the noise around the order
        samples: M of the record
        revolutions: of the input in the record that is used
        probability: with which such an error is detected
        false_alarm: probability of an alarm without error
        accuracy: error that is allowed for this gear [rad]
        offset: amplitude that the order has in the current without any error [A]
        remarks: what limits the limit, in words

    >>> import strainwave as sw
    >>> record = {"speed": 20.0, "duration": 2.0, "sample_rate": 500.0, "noise": 0.02}
    >>> limit = sw.diagnose.detection_limit(sw.load("tilt-actuator-lumped"), load_torque=20.0, order=2.0, **record)
    >>> round(limit.arcminutes, 3), round(1e3 * limit.current, 1), limit.insensitive  # arcmin at the output, mA
    (0.055, 12.5, False)
    """

    order: float
    amplitude: float
    current: float
    gain: complex
    sigma: float
    signal_to_noise: float
    freedom: int
    samples: int
    revolutions: float
    probability: float
    false_alarm: float
    accuracy: float
    offset: float
    remarks: tuple[str, ...] = ()

    @property
    def arcminutes(self) -> float:
        """Amplitude of the error at the output [arcmin]."""
        return self.amplitude / RAD_PER_ARCMIN

    @property
    def insensitive(self) -> bool:
        """True if an error as large as the gear may have is not detected: no alarm then means nothing."""
        return self.amplitude > self.accuracy

    def _headline(self) -> str:
        verdict = "an error that the gear may have is NOT detected" if self.insensitive else "errors of this gear are detected"
        limit = typeset.quantity(self.amplitude, "rad")
        return f"order {self.order:g} from {limit} on ({self.arcminutes:.3g} arcmin) at the output, {verdict}"


def detection_limit(
    drive: Drive,
    *,
    speed: float,
    load_torque: float,
    duration: float,
    sample_rate: float,
    noise: float,
    order: float,
    probability: float = DETECTION_PROBABILITY,
    false_alarm: float = FALSE_ALARM,
    accuracy: float = MAX_CATALOGUE_AMPLITUDE,
    tests: int = 1,
    progress: Progress = None,
) -> DetectionLimit:
    """Return the smallest kinematic error of an order that the motor current shows, for this drive and this record.

    Args:
        drive: with a controller that holds a speed or follows an angle, and a motor whose current is recorded. Noise of its
            sensors is left out, and its kinematic error is replaced
        speed: of the input [rad/s], positive
        load_torque: that holds the output back, besides the load's own [N.m]
        duration: of the record [s]
        sample_rate: of the current [Hz]
        noise: standard deviation of a sample of the recorded current [A], white up to half the rate. Noise of a bandwidth b
            below that counts more: noise times the root of sample_rate / (2 b)
        order: periods per revolution of the input [1]
        probability: with which the error is to be detected
        false_alarm: probability of an alarm without error, over all tests
        accuracy: amplitude of the error that this gear may have [rad]; beyond it the run is insensitive
        tests: number of orders that are looked for together
        progress: as of `sw.simulate`

    Returns:
        The limit and what it follows from.

    Raises:
        TypeError: an argument is not of its kind
        ValueError: an argument is out of range, the drive has no current or does not reach the speed, or the record has
            too few or too many samples
        FloatingPointError: the drive is not stable

    Valid for the drive as it is modelled: hysteresis and friction answer a small error otherwise than a large one, so the gain
    is taken at the limit itself. It does not see a line of the same order that has another cause; `offset` is its size in the
    model.

    >>> import strainwave as sw
    >>> drive = sw.Drive(
    ...     gear=sw.Gear(kinematics=sw.kinematics.StrainWave(), stiffness=sw.stiffness.Linear(k=8000.0), damping=2.0),
    ...     motor=sw.motor.CurrentSource(torque_constant=0.05, inertia=1.5e-4),
    ...     control=sw.control.PI(proportional=4.0, integral=100.0, limit=50.0),
    ...     load=sw.loads.Inertia(inertia=0.05),
    ... )
    >>> record = {"speed": 10.0, "duration": 20.0, "sample_rate": 500.0, "noise": 0.05, "order": 2.0}
    >>> loaded, unloaded = (detection_limit(drive, load_torque=load, **record) for load in (20.0, 0.0))
    >>> loaded.insensitive, unloaded.insensitive
    (False, True)
    """
    run = SteadyRun.of(arguments.drive(drive), speed, load_torque, duration, sample_rate, order)
    noise = arguments.number("noise", noise, "A", "[)", 0.0)
    probability = arguments.probability("probability", probability)
    false_alarm = arguments.probability("false_alarm", false_alarm)
    accuracy = arguments.number("accuracy", accuracy, "rad", low=0.0)
    tests = arguments.whole("tests", tests, 1)
    with in_turn(progress, PROBE_RUNS + 1) as turn:
        turn("without error")
        healthy = RecordedOrder.of(run.with_error(0.0), order)
        sigma = healthy.sigma(hypot(noise, healthy.own_noise))
        needed = needed_signal_to_noise(probability, false_alarm, healthy.regression.freedom, tests)
        gain, limit, before = 0.0j, FIRST_PROBE, inf
        for _ in range(PROBE_RUNS):
            probe = min(max(limit, MIN_PROBE), MAX_PROBE)
            if abs(probe - before) < MIN_PROBE_CHANGE * probe:
                break
            turn(f"with an error of {probe:.2g} rad")
            before, gain = probe, run.gain(healthy, probe)
            limit = sigma * needed / abs(gain) if abs(gain) > 0.0 else inf
    detected = DetectionLimit(
        order=order,
        amplitude=limit,
        current=sigma * needed,
        gain=gain,
        sigma=sigma,
        signal_to_noise=needed,
        freedom=healthy.regression.freedom,
        samples=healthy.samples,
        revolutions=healthy.revolutions,
        probability=probability,
        false_alarm=false_alarm,
        accuracy=accuracy,
        offset=abs(healthy.wave),
    )
    return replace(detected, remarks=_remarks(detected, noise, healthy.own_noise))


def _remarks(limit: DetectionLimit, noise: float, own: float) -> tuple[str, ...]:
    remarks = []
    if limit.insensitive:
        remarks.append(
            f"insensitive: an error of {limit.accuracy / RAD_PER_ARCMIN:.3g} arcmin, which this gear may have, makes "
            f"{1e3 * abs(limit.gain) * limit.accuracy:.3g} mA, and {1e3 * limit.current:.3g} mA are needed. No alarm means "
            "nothing: take more load, a longer record, or a sensor with less noise"
        )
    if own > noise:
        remarks.append(
            f"without any error the drive has {1e3 * own:.3g} mA around the order, more than the noise of {1e3 * noise:.3g} mA"
        )
    if limit.offset > limit.current:
        remarks.append(f"order {limit.order:g} has {1e3 * limit.offset:.3g} mA without any error; compare it with healthy runs")
    return tuple(remarks)
