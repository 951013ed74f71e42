"""A drive at constant speed under a load, in its own loop: what a kinematic error of an order makes of the motor current."""

from __future__ import annotations

from dataclasses import dataclass
from math import pi, sqrt, tau

import numpy as np
from numpy.typing import NDArray

from strainwave import Drive, arguments, kinematic_error
from strainwave.diagnose.actuator_ramp import ERROR, longest_step, noises
from strainwave.diagnose.motion import MAX_SAMPLES, motion_of
from strainwave.diagnose.regression import OrderRegression, regressions
from strainwave.files.recording import Recording
from strainwave.files.typical_gear import RAD_PER_ARCMIN
from strainwave.messages import listed
from strainwave.simulation.run import simulate
from strainwave.simulation.scenario import Scenario, constant, ramp
from strainwave.simulation.signals import outputs

Array = NDArray[np.float64]

MAX_CATALOGUE_AMPLITUDE = RAD_PER_ARCMIN  # rad: half of 2 arcmin peak to peak, the bound of the least accurate catalogue gears
RUN_IN_TURNS = 2.0  # revolutions of the input before the record
MIN_RUN_IN = 1.0  # s
MAX_DURATION = 3600.0  # s, of the record
MIN_TURNS = 3.0  # of the input, in the record
MIN_SPEED_SHARE = 0.9  # of the speed asked for [1], that a drive must reach
COLUMN = "current"


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
        """Return the run, with noise-free sensors.

        Raises:
            ValueError: a number is out of range, the drive records no current, or the record has too few samples or turns
        """
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
        if COLUMN not in (known := outputs(drive)):
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
        """Return the record of a run with an error of the order, after the run-in.

        Args:
            amplitude: of the error at the output [rad]
            phase: of it [rad], as of a sine

        Raises:
            ValueError: the drive does not reach the speed
        """
        law = kinematic_error.Fourier(order=[self.order], amplitude=[amplitude], phase=[phase])
        drive = self.drive.replace({ERROR: law})
        ratio = float(drive.gear.kinematics.ratio)
        output = self.speed / abs(ratio)
        length = self.run_in + self.duration
        start = {"output_speed": output, "input_speed": output * ratio}
        run = simulate(
            drive,
            self._command(output, length),
            min(longest_step(drive), 1.0 / self.sample_rate),
            sample=1.0 / self.sample_rate,
            load_torque=self.load_torque,
            initial=start,
            record=["input_angle", "output_angle", COLUMN],
        )
        record = run.between(self.run_in, length)
        self._check_speed(record)
        return record

    def gain(self, healthy: RecordedOrder, amplitude: float) -> complex:
        """Return amplitude and phase of the current per error at an amplitude of the error [A/rad].

        Args:
            healthy: the order in a run without error
            amplitude: of the error at the output [rad]: hysteresis and friction answer a small one otherwise than a large one
        """
        return (RecordedOrder.of(self.with_error(amplitude), self.order).wave - healthy.wave) / amplitude

    def _command(self, output: float, length: float) -> Scenario:
        """Return the command at which the output turns with the speed: a speed of a speed loop, else an angle."""
        held = getattr(self.drive.control, "law", self.drive.control)
        return constant(output, length) if held.name == "pi" else ramp(output, length)

    def _check_speed(self, record: Recording) -> None:
        """Raise ValueError if the input does not turn as far as the speed makes it, or against it."""
        angle = record["input_angle"]
        turned = float(angle[-1] - angle[0]) * float(np.sign(float(self.drive.gear.kinematics.ratio)))
        wanted = self.speed * self.duration
        if not MIN_SPEED_SHARE * wanted <= turned <= wanted / MIN_SPEED_SHARE:
            raise ValueError(
                f"the drive turns its input by {turned:.4g} rad in {self.duration:g} s, loaded with {self.load_torque:g} N.m; "
                f"speed = {self.speed:g} rad/s makes {wanted:.4g} rad. Take a lower speed or load, or a drive with a controller"
            )


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
        motion = motion_of(record, COLUMN, order)
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
