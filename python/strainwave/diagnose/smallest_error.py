r"""Detection limit: the smallest kinematic error that the motor current of a drive shows, computed before anything is recorded.

The drive is simulated twice in its own closed loop, with noise-free sensors: without error, and with an error of the order. The
difference of the waves of the current over the error is the gain G [A/rad]. Noise of standard deviation :math:`\sigma_i` in M
samples leaves :math:`\sigma = \sigma_i \sqrt{2 / M}` (RifeBoorstyn1974). The smallest signal to noise :math:`\sqrt{\lambda}`
that the test of `order_lines` detects follows from the non-central F distribution (Kay1998):

.. math:: A_{\min} = \frac{\sigma \sqrt{\lambda}}{|G|}
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import hypot, inf

from strainwave import Drive, arguments, typeset
from strainwave.diagnose.detection import DETECTION_PROBABILITY, FALSE_ALARM, needed_signal_to_noise
from strainwave.diagnose.steady_run import MAX_CATALOGUE_AMPLITUDE, RecordedOrder, SteadyRun
from strainwave.files.typical_gear import RAD_PER_ARCMIN
from strainwave.presentation import Presented

PROBE = RAD_PER_ARCMIN  # rad: error of the first run; later ones have the limit itself
PROBE_RUNS = 3  # runs with an error at most
MIN_PROBE_CHANGE = 1e-3  # relative change of the error [1], below which a further run would show the same gain
MAX_PROBE = 60.0 * RAD_PER_ARCMIN  # rad: error of any run
MIN_PROBE = 1e-3 * RAD_PER_ARCMIN  # rad


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
    healthy = RecordedOrder.of(run.with_error(0.0), order)
    sigma = healthy.sigma(hypot(noise, healthy.own_noise))
    needed = needed_signal_to_noise(probability, false_alarm, healthy.regression.freedom, tests)
    gain, limit, before = 0.0j, PROBE, inf
    for _ in range(PROBE_RUNS):
        probe = min(max(limit, MIN_PROBE), MAX_PROBE)
        if abs(probe - before) < MIN_PROBE_CHANGE * probe:
            break
        before, gain = probe, run.gain(healthy, probe)
        limit = sigma * needed / abs(gain) if abs(gain) > 0.0 else inf
    found = DetectionLimit(
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
    return replace(found, remarks=_remarks(found, noise, healthy.own_noise))


def _remarks(found: DetectionLimit, noise: float, own: float) -> tuple[str, ...]:
    remarks = []
    if found.insensitive:
        remarks.append(
            f"insensitive: an error of {found.accuracy / RAD_PER_ARCMIN:.3g} arcmin, which this gear may have, makes "
            f"{1e3 * abs(found.gain) * found.accuracy:.3g} mA, and {1e3 * found.current:.3g} mA are needed. No alarm means "
            "nothing: take more load, a longer record, or a sensor with less noise"
        )
    if own > noise:
        remarks.append(
            f"without any error the drive has {1e3 * own:.3g} mA around the order, more than the noise of {1e3 * noise:.3g} mA"
        )
    if found.offset > found.current:
        remarks.append(f"order {found.order:g} has {1e3 * found.offset:.3g} mA without any error; compare it with healthy runs")
    return tuple(remarks)
