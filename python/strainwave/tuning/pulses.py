"""Pulse positioning: a joint that sticks is moved by a small angle, by pulses of torque of one size."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from strainwave import Drive, Gear, arguments, typeset
from strainwave.files.gear_set import GearSet, gear_set_of
from strainwave.messages import shortened
from strainwave.presentation import Pictured, Row, counted, rows_of_fields
from strainwave.simulation.run import simulate
from strainwave.simulation.scenario import Scenario, constant
from strainwave.simulation.state import State
from strainwave.tuning.approach import friction_at_rest, lost_motion
from strainwave.tuning.cascade import Plant, line_of_friction
from strainwave.tuning.drawn import drawn_gears
from strainwave.tuning.goals import UPPER_QUANTILE

if TYPE_CHECKING:
    from matplotlib.figure import Figure

Array = NDArray[np.float64]

DEFAULT_AMPLITUDE = 2.0  # torque of a pulse over breakaway
DEFAULT_MAX_PULSES = 20
SHARE_OF_FIRST = 0.5  # of what remains, at which the first pulse each way aims: with 30 % less friction it does not overshoot
MAX_RESTS = 20  # in a row, until a drive is refused as one that does not come to rest
MAX_DRIFT = 0.1  # of the tolerance, that a drive at rest moves in the last tenth of a rest
MAX_STEP = 2e-4  # s, of the simulation


def pulse_travel(torque: float, width: float, inertia: float, friction: float) -> float:
    r"""Return the angle [rad] by which one pulse of torque turns a rigid rotor with its load, from rest to rest.

    The pulse accelerates by (tau - F) / J for its width w, to the speed v = (tau - F) w / J; friction alone brakes by F / J:

    .. math:: x = \frac{v w}{2} + \frac{J v^2}{2 F} = \frac{(\tau - F)\,\tau\,w^2}{2 J F}

    Energy proves it: the pulse does the work tau v w / 2, and friction takes F x. Valid for a rigid drive without gravity or
    other load, a friction that is constant while it slides, and a torque beyond breakaway. Viscous friction b shortens the
    travel by about b v / F of it.

    Args:
        torque: tau, beyond the friction [N.m]
        width: w [s]
        inertia: J, of rotor, wave generator and load, at the input [kg.m2]
        friction: F while it slides, of all places, at the input [N.m]

    Raises:
        TypeError: an argument is no number
        ValueError: a number is out of its range

    Source:
        the position control article, "pulse" command of the experiments; own derivation

    >>> round(pulse_travel(torque=0.15, width=0.02, inertia=1.2e-3, friction=0.072), 6)
    0.027083
    """
    width = arguments.number("width", width, "s", "[)", 0.0)
    return _travel_per_square(torque, inertia, friction) * width**2


def pulse_width(torque: float, travel: float, inertia: float, friction: float) -> float:
    """Return the width [s] of the pulse that turns a rigid drive by an angle [rad]; the inverse of `pulse_travel`.

    Args:
        torque: beyond the friction [N.m]
        travel: 0 or more [rad]
        inertia: of rotor, wave generator and load, at the input [kg.m2]
        friction: while it slides, of all places, at the input [N.m]

    Raises:
        TypeError: an argument is no number
        ValueError: a number is out of its range

    Source:
        as `pulse_travel`

    >>> round(pulse_width(torque=0.15, travel=pulse_travel(0.15, 0.02, 1.2e-3, 0.072), inertia=1.2e-3, friction=0.072), 9)
    0.02
    """
    travel = arguments.number("travel", travel, "rad", "[)", 0.0)
    return float(np.sqrt(travel / _travel_per_square(torque, inertia, friction)))


def _travel_per_square(torque: float, inertia: float, friction: float) -> float:
    """Return the travel of a pulse over the square of its width [rad/s^2]."""
    friction = arguments.number("friction", friction, "N.m", low=0.0)
    torque = arguments.number("torque", torque, "N.m", low=friction)
    inertia = arguments.number("inertia", inertia, "kg.m2", low=0.0)
    return (torque - friction) * torque / (2.0 * inertia * friction)


@dataclass(frozen=True)
class PulsePlan(Pictured):
    """A train of equal pulses for a drive that sticks.

    Attributes:
        gear_set: the drive with the sources of its numbers
        drive: the same without a controller, its motor one that takes a current or a torque
        travel: of the output, that is asked for [rad]
        torque: of the pulses at the input, of the sign that moves the output by the travel [N.m]
        friction: of all places at the input while it slides, without its viscous part [N.m]
        inertia: of rotor, wave generator and load at the input [kg.m2]
        wind_up: twist between both senses of motion, which a reversal takes up [rad]
        widths: of the pulses [s], shape (n,)
        max_width: of a pulse [s]
        rest: after each pulse [s]
        actuation_per_torque: what the motor takes per torque: [A/(N.m)] or [1]

    >>> import strainwave as sw
    >>> plan = sw.tuning.plan_pulses("position-drive", 0.005)
    >>> [round(1e3 * width) for width in plan.widths], round(plan.torque, 3), round(plan.friction, 3)  # ms, N.m, N.m
    ([95], 0.153, 0.074)
    """

    gear_set: GearSet
    drive: Drive
    travel: float
    torque: float
    friction: float
    inertia: float
    wind_up: float
    widths: tuple[float, ...]
    max_width: float
    rest: float
    actuation_per_torque: float

    @property
    def command(self) -> Scenario:
        """The whole train, as `sw.simulate` takes it for `drive` [A or N.m]."""
        return self.pulses(self.widths)

    @property
    def travel_per_square(self) -> float:
        """Travel of the output by a pulse over the square of its width [rad/s^2]."""
        ratio = abs(float(self.drive.gear.kinematics.ratio))
        return pulse_travel(abs(self.torque), 1.0, self.inertia, self.friction) / ratio

    def pulses(self, widths: Sequence[float], sense: float = 1.0) -> Scenario:
        """Return a train of pulses of some widths [s], each followed by the rest; against the travel if `sense` is -1.

        Raises:
            ValueError: there is no width, or one is not positive
        """
        if len(widths) == 0 or not np.min(widths) > 0.0:
            raise ValueError(f"widths = {shortened(widths)} must be one or more positive numbers [s]")
        ends = np.cumsum([width + self.rest for width in widths])
        begins = np.append(0.0, ends[:-1])
        edges = np.column_stack((begins, begins + widths)).ravel()
        level = np.resize([sense * self.actuation_per_torque * self.torque, 0.0], edges.size)
        return Scenario(float(ends[-1]), edges, level, np.zeros(edges.size))

    def _headline(self) -> str:
        travel, torque = typeset.quantity(self.travel, "rad"), typeset.quantity(self.torque, "N.m")
        return f"{counted(len(self.widths), 'pulse')} of {torque} for {travel} of {self.gear_set.name}"

    def _rows(self) -> Iterator[Row]:
        return (row for row in rows_of_fields(self) if row.name not in ("gear set", "drive"))

    def plot(self) -> Figure:
        """Return a figure of the train of pulses over time."""
        return self.command.plot("command of the motor", "A" if "A/" in self._unit else "N.m")

    @property
    def _unit(self) -> str:
        return "A/(N.m)" if self.actuation_per_torque != 1.0 else "1"


def plan_pulses(
    drive: GearSet | Drive | str,
    travel: float,
    *,
    torque: float | None = None,
    max_width: float = 0.1,
    rest: float = 0.2,
) -> PulsePlan:
    """Return the train of equal pulses that moves a drive out of stick by an angle of its output, planned open loop.

    The pulses are as few as `max_width` allows. The plan supposes a gear that is not wound up at the begin, and adds half its
    lost motion to the travel; else it is as rigid as `pulse_travel` has it. `position_by_pulses` corrects it by measurement.

    Args:
        drive: a set, a drive, or the name or path of a file; its controller is left out, its current loop taken as ideal
        travel: of the output, of either sign, not 0 [rad]
        torque: of a pulse at the input, beyond breakaway [N.m]; twice the breakaway if not given
        max_width: of a pulse [s]
        rest: after each pulse [s]

    Returns:
        Torque at the input [N.m] and widths [s] of the pulses, shape (n,), and the numbers of the drive that they follow from.

    Raises:
        TypeError: an argument is not of its kind
        ValueError: a number is out of its range, the drive has no motor or no load, its motor takes neither a current, a torque
            nor a voltage, or its friction does not hold it at rest

    Source:
        the position control article, experiments (pulse control); own derivation

    >>> plan = plan_pulses("position-drive", 0.002)
    >>> len(plan.widths), round(1e3 * plan.widths[0])  # ms
    (1, 69)
    """
    gear_set = gear_set_of(drive)
    plant = Plant.of(gear_set, period=1e-3, delay=0.0)
    travel = arguments.sized("travel", travel, "rad", low=1e-12)
    max_width, rest = arguments.seconds("max_width", max_width), arguments.seconds("rest", rest)
    gear = plant.drive.gear
    friction, breakaway = line_of_friction(gear)[0], _breakaway(gear)
    if breakaway == 0.0:
        raise ValueError(
            "the gear has no dry friction, so it does not rest after a pulse; give it a friction that sticks, as "
            "friction_input=sw.friction.Coulomb(coulomb=...), or use a position controller"
        )
    size = DEFAULT_AMPLITUDE * breakaway if torque is None else arguments.number("torque", torque, "N.m", low=breakaway)
    wind_up = lost_motion(gear).extent if friction_at_rest(gear.friction_output) > 0.0 else 0.0
    whole = pulse_width(size, (abs(travel) + 0.5 * wind_up) * abs(plant.ratio), plant.total_inertia, friction)
    count = int(np.ceil((whole / max_width) ** 2))
    widths = (whole / float(np.sqrt(count)),) * count
    signed = float(np.copysign(size, travel * plant.ratio))
    return PulsePlan(gear_set, plant.drive, travel, signed, friction, plant.total_inertia, wind_up, widths, max_width, rest,
                     plant.actuation_per_torque)  # fmt: skip


def _breakaway(gear: Gear) -> float:
    """Return the friction of all places at rest, at the input without load [N.m]."""
    ratio = abs(float(gear.kinematics.ratio))
    return friction_at_rest(gear.friction_input) + sum(
        friction_at_rest(law) / ratio for law in (gear.friction_mesh, gear.friction_output)
    )


@dataclass(frozen=True)
class PulsedMove(Pictured):
    """A move by pulses.

    Attributes:
        travel: of the output, that was asked for [rad]
        tolerance: of the angle at rest [rad]
        widths: of the pulses, negative against the travel [s], shape (n,)
        angles: of the output at rest, from the begin, first 0, then after each pulse [rad], shape (n + 1,)
        end: state at the end, from which another move can start

    >>> import strainwave as sw
    >>> move = sw.tuning.position_by_pulses(sw.tuning.plan_pulses("position-drive", 0.005), tolerance=1e-4)
    >>> move.reached, (1e3 * move.angles).round(2)  # mrad of the output: at the start, and after each pulse
    (True, array([0.  , 2.55, 5.03]))
    """

    travel: float
    tolerance: float
    widths: Array
    angles: Array
    end: State

    @property
    def error(self) -> float:
        """The last angle at rest less the travel [rad]."""
        return float(self.angles[-1] - self.travel)

    @property
    def pulses(self) -> int:
        """Number of pulses."""
        return len(self.widths)

    @property
    def reached(self) -> bool:
        """True if the error is within the tolerance."""
        return abs(self.error) <= self.tolerance

    def _headline(self) -> str:
        verdict = "reached" if self.reached else "NOT reached"
        return f"{counted(self.pulses, 'pulse')}, {verdict}, error {typeset.quantity(self.error, 'rad')}"

    def _rows(self) -> Iterator[Row]:
        yield Row("travel asked for", self.travel, "rad")
        yield Row("error", self.error, "rad", note=f"tolerance {typeset.quantity(self.tolerance, 'rad')}")
        for number, (width, angle) in enumerate(zip(self.widths.tolist(), self.angles[1:].tolist(), strict=True), start=1):
            yield Row(f"angle after pulse {number}", angle, "rad", note=f"width {typeset.quantity(width, 's')}")

    def plot(self) -> Figure:
        """Return a figure of the angle at rest after each pulse, with the travel asked for."""
        from strainwave.drawing.simple import Series, points_figure

        pulse = np.arange(float(len(self.angles)))
        angle = Series("angle of the output", "rad", self.angles)
        return points_figure("Positioning by pulses", Series("pulse", "1", pulse), angle, {"travel asked for": self.travel})


def position_by_pulses(
    plan: PulsePlan,
    tolerance: float,
    *,
    measured: bool = True,
    max_pulses: int = DEFAULT_MAX_PULSES,
    initial: State | None = None,
    drive: Drive | None = None,
) -> PulsedMove:
    r"""Return the simulated move of a drive by pulses: the output measured at rest between them, or the train as planned.

    With measurement, of the angles of input and output at rest after each pulse, the width of the next one is

    .. math:: w = \sqrt{(r + u) / c}, \qquad c = \frac{m}{w_0^2}

    with r what remains, m the travel of the input over the ratio by the last pulse, w_0 its width, and u the wind-up that is
    still to be taken up: half the lost motion at the begin, all of it after a reversal, and none once the output has moved that
    way. The lost motion is that of the plan until a reversal has shown another. The first pulse each way aims at half of r, so
    that it does not overshoot if there is less friction than planned. A width is at most `max_width`.

    A load that breaks away from rest jumps: with spring K, by about 2 (F_s - F_c) / K of its friction at rest and in motion. A
    tolerance below half of this is reached by chance only.

    Args:
        plan: as `plan_pulses` returns it
        tolerance: of the output at rest [rad]
        measured: False for the train of the plan, without correction
        max_pulses: number of measured pulses after which the move ends, reached or not
        initial: where the drive begins, as `end` of another move; untwisted at rest if not given
        drive: that is moved in truth, with parts of the same models as `plan.drive`, which it is if not given

    Returns:
        Widths of the pulses [s], shape (n,), the angle of the output at rest after each [rad], and the state at the end.

    Raises:
        TypeError: an argument is not of its kind
        ValueError: a number is out of its range, or the drive does not come to rest after a pulse

    Source:
        the position control article, experiments (pulse control); the correction: own derivation

    >>> move = position_by_pulses(plan_pulses("position-drive", 0.005), tolerance=1e-4)
    >>> move.reached, move.pulses < 6
    (True, True)
    """
    tolerance = arguments.number("tolerance", tolerance, "rad", low=0.0)
    arguments.whole("max_pulses", max_pulses, 1)
    moved_drive = plan.drive if drive is None else arguments.drive(drive)
    rest = _Resting(plan, moved_drive, moved_drive.rest() if initial is None else initial, MAX_DRIFT * tolerance)
    widths = _corrected(plan, rest, tolerance, max_pulses) if measured else list(plan.widths)
    for width in () if measured else widths:
        rest.after(width, 1.0)
    return PulsedMove(plan.travel, tolerance, np.array(widths), np.array(rest.angles), rest.state)


def _corrected(plan: PulsePlan, rest: _Resting, tolerance: float, max_pulses: int) -> list[float]:
    """Move the drive until what remains is within the tolerance, and return the widths of the pulses [s]."""
    widths, per_square, lost, wind_up = list[float](), plan.travel_per_square, plan.wind_up, 0.5 * plan.wind_up
    sense, share, towards = 1.0, SHARE_OF_FIRST, float(np.sign(plan.travel))
    while abs(remaining := towards * plan.travel - towards * rest.angles[-1]) > tolerance and len(widths) < max_pulses:
        if sense * remaining < 0.0:
            sense, share, wind_up = -sense, SHARE_OF_FIRST, lost
        width = min(float(np.sqrt((share * abs(remaining) + wind_up) / per_square)), plan.max_width)
        at_input, at_output = (sense * towards * moved for moved in rest.after(width, sense))
        if at_input > 0.0:
            per_square, share = at_input / width**2, 1.0
        if at_output > rest.max_drift:
            shown = lost + at_input - at_output - wind_up if wind_up > 0.0 else lost
            lost, wind_up = max(shown, 0.0), 0.0
        wind_up = max(wind_up - at_input, 0.0)
        widths.append(sense * width)
    return widths


class _Resting:
    """A drive at rest between pulses: its state, and the angles of its output so far [rad]."""

    def __init__(self, plan: PulsePlan, drive: Drive, state: State, max_drift: float) -> None:
        self.plan, self.drive, self.state, self.max_drift = plan, drive, state, max_drift
        self.angles = [0.0]

    def after(self, width: float, sense: float) -> Array:
        """Give one pulse of a width [s], wait for rest, and return the travels of input, over the ratio, and output [rad]."""
        command, moved = self.plan.pulses([width], sense), np.zeros(2)
        for _ in range(MAX_RESTS):
            run = simulate(self.drive, command, MAX_STEP, sample=0.1 * self.plan.rest, initial=self.state,
                           record=["input_angle", "output_angle"])  # fmt: skip
            self.state = run.end
            angles = np.array([run["input_angle"] / self.drive.gear.kinematics.ratio, run["output_angle"]])
            moved += angles[:, -1] - angles[:, 0]
            drift = float(np.abs(angles[:, -1] - angles[:, -2]).max())
            if drift <= self.max_drift:
                self.angles.append(self.angles[-1] + float(moved[1]))
                return moved
            command = constant(0.0, self.plan.rest)
        raise ValueError(
            f"{MAX_RESTS} rests of {self.plan.rest:g} s after a pulse of {width:g} s the drive still moves by {drift:.2g} rad "
            f"in a tenth of a rest; {self.max_drift:.2g} rad are allowed: give it more friction at rest or damping, or take a "
            "longer rest or a wider tolerance"
        )


@dataclass(frozen=True)
class PulseRepeatability(Pictured):
    """Moves by pulses of drives with drawn friction.

    Attributes:
        errors: of the output at rest after the last pulse [rad], shape (members,)
        pulses: number of pulses, shape (members,)
        reached: share of the drives whose error is within the tolerance

    >>> import strainwave as sw
    >>> found = sw.tuning.pulse_repeatability(sw.tuning.plan_pulses("position-drive", 0.005), tolerance=1e-4, members=5)
    >>> found.pulses, (1e3 * found.errors).round(2)  # mrad of the output
    (array([2, 4, 2, 4, 2]), array([ 0.04,  0.1 , -0.06, -0.07,  0.03]))
    """

    errors: Array
    pulses: NDArray[np.int64]
    reached: float

    @property
    def median_error(self) -> float:
        """Median of the size of the error [rad]."""
        return float(np.median(np.abs(self.errors)))

    @property
    def upper_error(self) -> float:
        """Size of the error that 95 % of the drives stay within [rad]."""
        return float(np.quantile(np.abs(self.errors), UPPER_QUANTILE))

    @property
    def median_pulses(self) -> float:
        """Median of the number of pulses."""
        return float(np.median(self.pulses))

    @property
    def upper_pulses(self) -> float:
        """Number of pulses that is enough for 95 % of the drives."""
        return float(np.quantile(self.pulses, UPPER_QUANTILE, method="higher"))

    def _headline(self) -> str:
        share = typeset.number(100.0 * self.reached, 3)
        return f"{share} % of {len(self.errors)} drives within the tolerance, median {self.median_pulses:g} pulses"

    def _rows(self) -> Iterator[Row]:
        yield Row("share within the tolerance", self.reached, "1")
        yield Row("median error", self.median_error, "rad", note=f"95 %: {typeset.quantity(self.upper_error, 'rad')}")
        yield Row("median pulses", self.median_pulses, "1", note=f"95 %: {self.upper_pulses:g}")

    def plot(self) -> Figure:
        """Return a figure of the histogram of the errors."""
        from strainwave.drawing.simple import Series, histograms_figure

        return histograms_figure(f"Errors of {len(self.errors)} drives", [Series("error of the output", "rad", self.errors)])


def pulse_repeatability(
    plan: PulsePlan,
    tolerance: float,
    *,
    measured: bool = True,
    max_pulses: int = DEFAULT_MAX_PULSES,
    members: int = 100,
    seed: int = 0,
) -> PulseRepeatability:
    """Return the errors and numbers of pulses of one plan on drives with drawn friction.

    Frictions are drawn as `sw.compensate` draws gears: from the covariance of the set, or by its spread, 30 % either way if it
    states none; all numbers of one place by one factor.

    Args:
        plan: as `plan_pulses` returns it, with the friction of the set
        tolerance: of the output at rest [rad]
        measured: False for the train of the plan, without correction
        max_pulses: number of measured pulses after which a move ends
        members: number of drawn drives
        seed: of the draw

    Returns:
        Error of the output [rad] and number of pulses of each drive, shape (members,), and the share that reached the
        tolerance.

    Raises:
        TypeError, ValueError: as `position_by_pulses`

    >>> found = pulse_repeatability(plan_pulses("position-drive", 0.005), 1e-4, members=5)
    >>> found.reached, found.upper_error < 1e-4
    (1.0, True)
    """
    members = arguments.whole("members", members, 1)
    draws = {path: each for path, each in drawn_gears(plan.gear_set, members, seed).items() if path.startswith("gear.friction")}
    drives = (plan.drive.replace({path: float(each[k]) for path, each in draws.items()}) for k in range(members))
    moves = [position_by_pulses(plan, tolerance, measured=measured, max_pulses=max_pulses, drive=each) for each in drives]
    reached = float(np.mean([move.reached for move in moves]))
    return PulseRepeatability(np.array([move.error for move in moves]), np.array([move.pulses for move in moves]), reached)
