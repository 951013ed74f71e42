"""From the record of a torsion test to its loops: angles of photographs and torques of masses, less what the rig adds."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from math import degrees
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from strainwave.equality import ComparedByFields
from strainwave.files.folder import inside
from strainwave.messages import listed, one_line, quoted
from strainwave.presentation import Presented, Statement
from strainwave.progress import Progress, in_turn
from strainwave.rig.analysis.regimes import cycles
from strainwave.rig.bench.rig_file import load
from strainwave.rig.bench.setup import Camera, Rig
from strainwave.rig.bench.steps import Step, by_place, photograph_of, place_words, read_steps
from strainwave.rig.bench.torque import Torque, torque_of, without_compliance
from strainwave.rig.loop import Loop
from strainwave.rig.reading.recorded import scatter
from strainwave.rig.running.plan import check
from strainwave.rig.vision.angle import Angles, follow
from strainwave.rig.vision.camera import flat
from strainwave.rig.vision.marker import Frame, look
from strainwave.statistics.linear_fit import normal_inverse

Array = NDArray[np.float64]
RIG, PLAN = "rig.toml", "plan.csv"
Place = tuple[float, str]  # position of the flexspline [rad] and specimen
_BACKWARD_SIGMA = 5.0  # standard deviations that an angle must move against the torque before a remark reports it
MIN_SHIFT_SIGMA = 4.0  # standard deviations beyond which a shift is reported
MIN_PHOTOGRAPHS = 6  # three vectors are fitted


class AngleReading(NamedTuple):
    """The angle of a step as it was read.

    Attributes:
        angle: [rad]
        sigma: its standard deviation [rad]
    """

    angle: float
    sigma: float


@dataclass(frozen=True, eq=False, repr=False)
class TorsionTest(ComparedByFields, Presented):
    """A torsion test as read from its files.

    Attributes:
        folder: of the test
        rig: on which it was made
        steps: as recorded, all of them
        angles: of the photographs, of each position and unit
        loops: of each position, unit and cycle
        hashes: SHA-256 of each photograph, by its name
        remarks: what went wrong or was left out, in words
        deviations: where the record departs from the plan in the folder; None where there is no plan

    >>> import tempfile
    >>> import strainwave as sw
    >>> masses = [0.3, 0.0, -0.3, 0.0, 0.3]  # kg, on the positive pans or on the negative ones
    >>> steps = [sw.rig.Step(n, max(mass, 0.0), max(-mass, 0.0), angle=mass / 4.0) for n, mass in enumerate(masses, 1)]
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     sw.rig.write_rig(sw.rig.Rig("bench", "input", disk_radius=sw.rig.Value(0.1)), f"{folder}/rig.toml")
    ...     sw.rig.write_steps(steps, folder)
    ...     test = sw.rig.read_test(folder)
    >>> test.loops[0].torque.round(3), test.loops[0].angle
    (array([ 0.294,  0.   , -0.294,  0.   ,  0.294]), array([ 0.075,  0.   , -0.075,  0.   ,  0.075]))
    """

    folder: Path
    rig: Rig
    steps: tuple[Step, ...]
    angles: tuple[Angles, ...]
    loops: tuple[Loop, ...]
    hashes: Mapping[str, str]
    remarks: tuple[str, ...]
    deviations: tuple[str, ...] | None = None

    def _headline(self) -> str:
        return f"{self.folder}, {len(self.steps)} steps, {len(self.hashes)} photographs, {len(self.loops)} loops"


def read_test(
    folder: str | Path,
    *,
    rig: Rig | None = None,
    reference: str | None = None,
    camera: Camera | None = None,
    progress: Progress = None,
) -> TorsionTest:
    """Read the folder of a test: `rig.toml`, `steps.csv` and the photographs that it names.

    The angle of a position and unit is 0 at its first photograph at the positive peak, unless another one is chosen (erratum
    erratum 11 of the torsional stiffness article). The remarks list each photograph without an angle; the other steps remain.
    If the folder contains the planned steps, `plan.csv`, the record is compared with them.

    Args:
        folder: of the test
        rig: instead of `rig.toml`
        reference: name of the photograph whose angle is 0, for the position and unit that it belongs to
        camera: instead of that of the rig
        progress: as of `sw.simulate`

    Returns:
        The steps, the angles of the photographs [rad], and a loop for each position, unit and cycle.

    Raises:
        ValueError: rig or steps cannot be read, a photograph lies outside of the folder, the reference is none of the
            test, or no step has torque and angle

    >>> import tempfile
    >>> import strainwave as sw
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     sw.rig.write_rig(sw.rig.Rig("bench", "input", disk_radius=sw.rig.Value(0.1)), f"{folder}/rig.toml")
    ...     sw.rig.write_steps([sw.rig.Step(1, mass_positive=0.3, angle=0.075), sw.rig.Step(2, angle=0.0)], folder)
    ...     test = sw.rig.read_test(folder)
    >>> len(test.steps), test.loops[0].torque.round(3)
    (2, array([0.294, 0.   ]))
    """
    folder = Path(folder)
    rig = load(inside(folder, RIG)) if rig is None else rig
    rig = rig if camera is None else replace(rig, camera=camera)
    steps = read_steps(folder)
    _check_masses(folder, steps, rig)
    if reference is not None and reference not in [step.image for step in steps]:
        raise ValueError(one_line(f"{folder}: reference = {quoted(reference)} is no photograph of a step"))
    found: list[Angles] = []
    remarks: list[str] = []
    frames: list[Frame] = []
    for place, of_place in by_place(steps).items():
        named = [step for step in of_place if step.image is not None]
        with in_turn(progress, len(named)) as turn:
            frames_of_place = []
            for step in named:
                turn(str(step.image))
                frame = look(photograph_of(step, folder), camera=rig.camera)
                frames_of_place.append(replace(frame, name=str(step.image)))  # as the steps name it, folder and all
        useful = [step for step, frame in zip(named, frames_of_place, strict=True) if frame.markers is not None]
        if useful:
            loads = [step.mass_positive - step.mass_negative if step.torque is None else step.torque for step in useful]
            chosen = reference if reference in [step.image for step in useful] else useful[int(np.argmax(loads))].image
            found.append(follow(frames_of_place, camera=rig.camera, reference=chosen))
            frames_of_place = list(found[-1].frames)
            remarks += [f"{place_words(place)}: {each}" for each in found[-1].remarks]
        frames += frames_of_place
    remarks += [f"{frame.name}: {words}" for frame in frames for words in (frame.fault, *frame.warnings) if words]
    made = loops(steps, rig, found)
    if not made:
        raise ValueError(one_line(f"{folder}: no position has two steps with torque and angle; {listed(remarks)}"))
    hashes = {frame.name: frame.sha256 for frame in frames}
    planned = inside(folder, PLAN)
    deviations = tuple(map(str, check(steps, read_steps(planned)))) if planned.exists() else None
    remarks = list(dict.fromkeys(remarks))
    return TorsionTest(folder, rig, tuple(steps), tuple(found), tuple(made), hashes, tuple(remarks), deviations)


def _check_masses(folder: Path, steps: Sequence[Step], rig: Rig) -> None:
    """Refuse more mass than the rig has, as a number of grams in a column of kilograms is."""
    most = sum(masses.mass * masses.count for masses in rig.masses)
    for step in steps if rig.masses else ():
        if (total := step.mass_positive + step.mass_negative) > most * (1.0 + 1e-6):
            raise ValueError(
                f"{folder / 'steps.csv'} step {step.number}: {total:.6g} kg lie on the pans, and all masses of the rig are "
                f"{most:.6g} kg; state the unit in the header, as mass_positive [g], or give the rig its [[masses]]"
            )


def loops(steps: Sequence[Step], rig: Rig, angles: Angles | Iterable[Angles] = ()) -> list[Loop]:
    """Return the loops of a test: one for each position, unit and cycle.

    Args:
        steps: as made
        rig: what turns masses into torque, and yields itself
        angles: of the photographs; a step without one has its own angle, or is left out

    Returns:
        Loops in the order measured, each with its remarks. Steps before the first peak belong to no cycle.

    Raises:
        ValueError: a cord from a fixed point has been turned beyond its arm

    >>> from strainwave.rig import Rig, Step, Value
    >>> rig = Rig("bench", "input", Value(0.1), gravity=Value(10.0), compliance=Value(0.01))
    >>> masses = [0.3, 0.0, -0.3, 0.0, 0.3]
    >>> steps = [Step(n, max(m, 0.0), max(-m, 0.0), angle=m / 4.0) for n, m in enumerate(masses, 1)]
    >>> (loop,) = loops(steps, rig)
    >>> loop.torque.round(3).tolist(), loop.angle.round(4).tolist()
    ([0.3, 0.0, -0.3, 0.0, 0.3], [0.072, 0.0, -0.072, 0.0, 0.072])
    """
    pictures = [angles] if isinstance(angles, Angles) else list(angles)
    return [loop for place, of_place in by_place(steps).items() for loop in _loops_of(place, of_place, rig, pictures)]


def _loops_of(place: Place, steps: Sequence[Step], rig: Rig, pictures: Sequence[Angles]) -> list[Loop]:
    readings, zero = _readings(steps, pictures)
    angle = np.array([reading.angle for reading in readings])
    torque = torque_of(steps, rig, angle)
    rows = np.flatnonzero(np.isfinite(angle) & np.isfinite(torque.shaft)).tolist()
    if len(rows) < 2:
        return []
    own = without_compliance(angle, torque.shaft, rig.compliance)
    if zero is not None:
        own = own - own[zero]
    sigma = np.array([reading.sigma for reading in readings])[rows]
    named = {step.image for step in steps}
    angle_scale = max((each.scale for each in pictures if named & {frame.name for frame in each.useful}), default=0.0)
    times, temperatures = ([getattr(steps[row], name) for row in rows] for name in ("time", "temperature"))
    time, temperature = (None if None in values else values for values in (times, temperatures))
    whole = Loop(
        own[rows],
        torque.shaft[rows],
        side=rig.side,
        name=place_words(place),
        angle_sigma=sigma if np.any(sigma > 0.0) else scatter(own[rows], torque.shaft[rows]),
        torque_sigma=torque.sigma[rows],
        angle_scale=angle_scale,
        torque_scale=torque.scale,
        friction_sigma=torque.friction_sigma,
        compliance_sigma=rig.compliance.sigma,
        time=time,
        temperature=temperature,
        position=place[0],
        unit=place[1],
        remarks=tuple(_remarks(steps, readings, torque, pictures, rig)),
    )
    return _cycles(whole)


def _readings(steps: Sequence[Step], pictures: Sequence[Angles]) -> tuple[list[AngleReading], int | None]:
    """The angle of each step, not-a-number where there is none; and the step whose angle is 0 by choice."""
    seen = {
        frame.name: AngleReading(float(angle), float(sigma))
        for angles in pictures
        for frame, angle, sigma in zip(angles.useful, angles.angle, angles.sigma, strict=True)
    }
    nothing = AngleReading(np.nan, 0.0)
    found = [seen.get(step.image or "", nothing if step.angle is None else AngleReading(step.angle, 0.0)) for step in steps]
    references = {angles.reference for angles in pictures}
    return found, next((row for row, step in enumerate(steps) if step.image in references), None)


def _cycles(loop: Loop) -> list[Loop]:
    """Its cycles; the whole of it where it is not even one."""
    try:
        found = cycles(loop)
    except ValueError as reason:
        return [replace(loop, remarks=(*loop.remarks, str(reason)))]
    outside = len(loop) - sum(map(len, found)) + len(found) - 1  # a cycle begins with the last point of the one before
    words = f"{outside} of {len(loop)} points belong to no complete cycle and are left out"
    return [replace(each, remarks=(*each.remarks, words)) for each in found] if outside else found


def _remarks(
    steps: Sequence[Step], readings: Sequence[AngleReading], torque: Torque, pictures: Sequence[Angles], rig: Rig
) -> Iterator[str]:
    faults = {frame.name: frame.fault for angles in pictures for frame in angles.frames if frame.markers is None}
    for step, reading in zip(steps, readings, strict=True):
        if not np.isfinite(reading.angle):
            missing = "the photograph gives no angle" if step.image else "no angle and no photograph"
            reason = faults.get(step.image or "", missing)
            yield f"step {step.number} is left out: {f'{step.image}: ' if step.image else ''}{reason}"
        if step.mass_positive and step.mass_negative:
            yield f"step {step.number} has masses on both pairs of pans; their difference counts"
    if any(step.torque is not None for step in steps):
        yield "the torque was measured, and steps.csv contains no error of it: intervals leave out those of the sensor"
    for before, after in pairwise(steps):
        if after.number > before.number + 1:
            yield f"between steps {before.number} and {after.number} the numbers leave {after.number - before.number - 1} out"
    yield from _remarks_on_motion(steps, readings, torque)
    yield from (text for angles in pictures for text in remarks_on_couple(angles, steps, torque, rig))
    for name, values in (("time", [step.time for step in steps]), ("temperature", [step.temperature for step in steps])):
        if 0 < values.count(None) < len(values):
            yield f"{values.count(None)} of {len(values)} steps have no {name}; that of the others is left out"


def _remarks_on_motion(steps: Sequence[Step], readings: Sequence[AngleReading], torque: Torque) -> Iterator[str]:
    """Steps that the pulleys held, and steps that went against the torque."""

    def load(step: Step) -> tuple[float, float, float | None]:
        return step.mass_positive, step.mass_negative, step.torque

    held = [step.number for step, sense in zip(steps[1:], torque.sense[1:], strict=True) if sense == 0.0]
    changed = [after.number for before, after in pairwise(steps) if load(before) != load(after)]
    if stuck := [str(number) for number in held if number in changed]:
        yield (
            f"the pulleys hold more than the change of torque at step {listed(stuck)}: the torque on the shaft is less than "
            "that of the masses"
        )
    for (before, after), (one, other), sense in zip(pairwise(steps), pairwise(readings), torque.sense[1:], strict=True):
        turned = other.angle - one.angle
        if turned * sense < -_BACKWARD_SIGMA * np.hypot(one.sigma, other.sigma) < 0.0:
            words = f"from step {before.number} to {after.number} the shaft turned against the torque"
            yield f"{words}, by {degrees(abs(turned)):.3g} degrees"


@dataclass(frozen=True)
class Couple(Statement):
    """Shift of the centre of a turning shaft with the torque.

    Attributes:
        shift: of the centre per torque, right and up in the picture [px/(N.m)]
        sigma: standard deviation of each of both [px/(N.m)]
        rms: distance of the points from the fit [px]
        scale: size of a pixel at the target [m]; None where the distance of the markers is not known
        span: of the torque [N.m]
    """

    shift: tuple[float, float]
    sigma: float
    rms: float
    scale: float | None
    span: float

    @property
    def size(self) -> float:
        """Return the size of the shift [px/(N.m)]."""
        return float(np.hypot(*self.shift))

    @property
    def pure(self) -> bool:
        """True if the shift can be chance."""
        return self.size <= MIN_SHIFT_SIGMA * self.sigma

    def _headline(self) -> str:
        moved = f"{self.size * self.span:.3g} px"
        if self.scale is not None:
            moved += f" ({1e6 * self.size * self.span * self.scale:.3g} um)"
        least = f"± {self.sigma * self.span:.2g} px over the span of the torque"
        if self.pure:
            return f"the centre of rotation stays within {least}: nothing speaks against a pure couple"
        return f"the centre of rotation moves by {moved} {least}: the torque was no pure couple, or the shaft's bearing yields"


def couple(middle: Array, angle: Array, torque: Array, scale: float | None = None) -> Couple:
    """Fit the centre, the arm and the shift to the points midway between the markers.

    Args:
        middle: of each photograph, right and up [px], shape (n, 2), n >= 6
        angle: of the shaft [rad], shape (n,)
        torque: on the shaft [N.m], shape (n,)
        scale: size of a pixel at the target [m]

    Raises:
        ValueError: too few photographs, or torque and angle do not separate the three

    >>> angle, torque = np.array([0.0, -0.3, -0.9, -1.0, -0.6, -0.1]), np.array([0.3, 0.1, -0.2, -0.3, 0.0, 0.3])
    >>> arm = np.stack([30.0 * np.cos(angle), 30.0 * np.sin(angle)], axis=1)
    >>> found = couple(arm + [320.0, -240.0] + np.outer(torque, [2.0, 0.0]), angle, torque)
    >>> round(found.size, 6), found.pure
    (2.0, False)
    """
    n = len(angle)
    if n < MIN_PHOTOGRAPHS:
        raise ValueError(f"the centre of rotation needs {MIN_PHOTOGRAPHS} photographs or more, not {n}")
    one, zero, c, s = np.ones(n), np.zeros(n), np.cos(angle), np.sin(angle)
    right = np.stack([one, zero, c, -s, torque, zero], axis=1)
    up = np.stack([zero, one, s, c, zero, torque], axis=1)
    design, seen = np.concatenate([right, up]), np.concatenate([middle[:, 0], middle[:, 1]])
    fit, _, rank, _ = np.linalg.lstsq(design, seen)
    if rank < 6:
        raise ValueError("torque and angle change together: they do not separate a shift of the shaft from its turn")
    residual = seen - design @ fit
    variance = float(residual @ residual) / (2 * n - 6)
    sigma = float(np.sqrt(variance * normal_inverse(design)[4, 4]))
    return Couple((float(fit[4]), float(fit[5])), sigma, float(np.sqrt(np.mean(residual**2))), scale, float(np.ptp(torque)))


def remarks_on_couple(angles: Angles, steps: Sequence[Step], torque: Torque, rig: Rig) -> Iterator[str]:
    """Yield a remark if the centre of rotation contradicts a pure couple; none if the test does not determine it."""
    if not {frame.name for frame in angles.useful} & {step.image for step in steps}:
        return
    of_image = {step.image: float(each) for step, each in zip(steps, torque.shaft, strict=True)}
    rows = [row for row, frame in enumerate(angles.useful) if np.isfinite(of_image.get(frame.name, np.nan))]
    frames = [angles.useful[row] for row in rows]
    points = [np.array([[marker.x, marker.y] for marker in frame.markers or ()]) for frame in frames]
    centres = np.array(
        [flat(pair, rig.camera, (frame.size[1], frame.size[0])) for pair, frame in zip(points, frames, strict=True)]
    ).reshape(-1, 2, 2)
    apart = float(np.mean(np.hypot(*(centres[:, 1] - centres[:, 0]).T))) if rows else 0.0
    scale = rig.markers_distance.value / apart if rig.markers_distance is not None and apart > 0.0 else None
    middle, torques = centres.mean(axis=1) * [1.0, -1.0], np.array([of_image[frame.name] for frame in frames])
    try:
        found = couple(middle, angles.angle[rows], torques, scale)
    except ValueError:
        return
    if not found.pure:
        yield str(found)
