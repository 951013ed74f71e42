"""A simulated torsion test: its folder as a real one leaves it, and the true values."""

from __future__ import annotations

import io
import json
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace
from itertools import groupby
from pathlib import Path
from typing import Any, Literal, get_args

import numpy as np
from numpy.typing import NDArray

from strainwave import arguments
from strainwave._core import Gear
from strainwave.equality import ComparedByFields
from strainwave.files.gear_set import save
from strainwave.files.writing import making, replacing
from strainwave.presentation import Presented
from strainwave.progress import Progress, by_count
from strainwave.rig.bench.rig_file import write_rig
from strainwave.rig.bench.setup import Rig
from strainwave.rig.bench.steps import Step, append_step
from strainwave.rig.virtual.loading import Loading, load_by_steps
from strainwave.rig.virtual.render import Scene, render, usual_scene

Array = NDArray[np.float64]
Fault = Literal["blurred", "over-exposed", "marker missing", "swapped", "skipped"]
FAULT_BLUR, FAULT_EXPOSURE = 25.0, 8.0  # px; times the exposure: no edge is left to find
SOURCE = "assumed: the truth of a virtual test"


COLUMNS = {
    "angle": "rad",
    "applied": "N.m",
    "shaft": "N.m",
    "elastic": "N.m",
    "twist": "rad",
    "mass_positive": "kg",
    "mass_negative": "kg",
}


@dataclass(frozen=True, eq=False)
class VirtualTest(ComparedByFields, Presented):
    """A virtual test and its truth: the recorded steps, and the true values of each, shape (n,).

    Attributes:
        folder: of the test
        steps: as recorded
        angle: of the disk as photographed, from the first step of its specimen [rad]
        applied: torque of the weights on the disk [N.m]
        shaft: torque on the shaft, what pulleys hold taken off [N.m]
        elastic: torque of the gear's springs at that shaft, what its friction holds taken off, too [N.m]
        twist: of the gear, at its output [rad]
        mass_positive, mass_negative: true totals on the pans [kg]

    >>> import tempfile
    >>> import strainwave as sw
    >>> bench = sw.rig.Rig("bench", "input", disk_radius=sw.rig.Value(0.1), pulley_torque=sw.rig.Value(0.01))
    >>> steps = [sw.rig.Step(1, mass_positive=0.35), sw.rig.Step(2, mass_positive=0.3)]
    >>> gear, scene = sw.Gear(stiffness=sw.stiffness.Linear(k=1e4)), sw.rig.Scene(size=(160, 120), radius=12.0, distance=70.0)
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     test = sw.rig.simulate_test(gear, bench, steps, folder=folder, scene=scene)
    >>> test.applied.round(4), test.shaft.round(4)  # the pulleys hold 0.01 N.m either way
    (array([0.3432, 0.2942]), array([0.3332, 0.3042]))
    """

    folder: Path
    steps: tuple[Step, ...]
    angle: Array
    applied: Array
    shaft: Array
    elastic: Array
    twist: Array
    mass_positive: Array
    mass_negative: Array


def simulate_test(
    gear: Gear | Callable[[Step], Gear],
    rig: Rig,
    steps: Sequence[Step],
    *,
    folder: str | Path,
    scene: Scene | None = None,
    seed: int = 0,
    stated: Rig | None = None,
    wait: float = 60.0,
    settling: float = 0.0,
    virgin: bool = False,
    mass_errors: bool = False,
    faults: Mapping[int, Fault] | None = None,
    progress: Progress = None,
) -> VirtualTest:
    """Run a torsion test on a virtual rig and write its folder as a real one leaves it.

    The folder holds `rig.toml`, a photograph `step-001.png` of each step, and `steps.csv`, to which each step is added once its
    photograph is there: who follows the folder sees a test being run. In addition, `truth.json` has the true angles, torques
    and masses, and `truth-1.toml` and so on the true gears. Every file is whole or not there, and none is left
    where the run is interrupted.

    Args:
        gear: which gear; or for each position and unit another one: a function of a step
        rig: the rig as it is; the values of its numbers are true
        steps: what is laid on the pans, as a plan has it; what they lack of times counts on from 0
        folder: where to write; it must not hold a test yet
        scene: what the camera sees; the usual one of the rig, with noise and light from one side, if not given
        seed: of all that is random
        stated: the rig that `rig.toml` describes; the true one if not given
        wait: between the change of the masses and the photograph [s]
        settling: time constant with which the disk comes to rest [s]; 0 if at once
        virgin: whether the gear was never loaded before; else it goes through all the steps once beforehand
        mass_errors: whether each mass of the set is off by an error of its standard deviation, or exactly as stated
        faults: what goes wrong, by the number of the step: a photograph "blurred", "over-exposed", with a "marker missing" or
            "swapped" with that of the next step; or a step that is made but "skipped" in the record
        progress: as of `sw.simulate`

    Returns:
        The test and its truth.

    Raises:
        ValueError: there are no steps, a fault is none or at no step, the folder holds a test, no equilibrium exists
        OSError: a file cannot be written

    >>> import tempfile
    >>> import strainwave as sw
    >>> bench = Rig("bench", "input", disk_radius=sw.rig.Value(0.1, 5e-5))
    >>> steps = [Step(1, mass_positive=0.35), Step(2, mass_positive=0.3)]
    >>> gear = sw.Gear(stiffness=sw.stiffness.Linear(k=1e4))
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     test = simulate_test(gear, bench, steps, folder=folder, scene=Scene(size=(160, 120), radius=12.0, distance=70.0))
    ...     sorted(path.name for path in Path(folder).iterdir())
    ['rig.toml', 'step-001.png', 'step-002.png', 'steps.csv', 'truth-1.toml', 'truth.json']
    >>> test.angle.round(6).tolist()
    [0.0, -0.049033]
    """
    arguments.whole("seed", seed, 0)
    faults = _checked(faults or {}, steps)
    folder, scene = Path(folder), scene or usual_scene(rig)
    recorded = [
        replace(step, image=f"step-{step.number:03}.png", time=wait * k if step.time is None else step.time)
        for k, step in enumerate(steps)
    ]
    weighed = _weighed(recorded, rig, np.random.default_rng([seed, 0])) if mass_errors else recorded
    gears, loadings = _loaded(gear, rig, weighed, {"wait": wait, "settling": settling, "virgin": virgin})
    if not loadings:
        raise ValueError("steps: a test needs one step or more")
    channels = ("seen", "applied", "shaft", "elastic", "twist")
    columns = [np.concatenate([getattr(each, name) for each in loadings]) for name in channels]
    columns += [np.array([getattr(step, name) for step in weighed]) for name in ("mass_positive", "mass_negative")]
    test = VirtualTest(folder, tuple(recorded), *columns)
    names = ["rig.toml", "steps.csv", "truth.json", *(f"truth-{number}.toml" for number in range(1, len(gears) + 1))]
    with making(folder):
        for name in ("rig.toml", "steps.csv", "truth.json"):
            if (folder / name).exists():
                raise ValueError(f"{folder} holds a test already ({name}); give another folder")
        with _whole(folder, [*names, *(str(step.image) for step in recorded)]):
            _write(test, recorded, gears, scene, seed, faults, stated or rig, progress)
    kept = [k for k, step in enumerate(recorded) if faults.get(step.number) != "skipped"]
    return VirtualTest(folder, tuple(recorded[k] for k in kept), *(column[kept] for column in columns))


@contextmanager
def _whole(folder: Path, names: Sequence[str]) -> Iterator[None]:
    """Take away again what was written under these names where the rest fails or is interrupted."""
    new = [folder / name for name in names if not (folder / name).exists()]
    try:
        yield
    except BaseException:
        for path in new:
            path.unlink(missing_ok=True)
        raise


def _write(
    test: VirtualTest,
    recorded: Sequence[Step],
    gears: Sequence[Gear],
    scene: Scene,
    seed: int,
    faults: Mapping[int, Fault],
    stated: Rig,
    progress: Progress,
) -> None:
    folder = test.folder
    write_rig(stated, folder / "rig.toml")
    for number, each in enumerate(gears, 1):
        save(each, folder / f"truth-{number}.toml", name=f"Gear {number} of a virtual test", source=SOURCE)
    _write_truth(test, scene, seed, faults)
    angles = test.angle.tolist()
    for k, step in enumerate(recorded):
        if faults.get(step.number) == "swapped":
            angles[k], angles[k + 1] = angles[k + 1], angles[k]
    scenes = {
        "blurred": replace(scene, blur=FAULT_BLUR),
        "over-exposed": replace(scene, exposure=FAULT_EXPOSURE * scene.exposure),
        "marker missing": replace(scene, markers=(scene.markers[0], scene.ground)),
    }
    with by_count(progress, "drawing pictures", len(recorded)) as report:
        for k, (step, angle) in enumerate(zip(recorded, angles, strict=True), 1):
            fault = faults.get(step.number, "")
            if fault != "skipped":
                noise = np.random.default_rng([seed, step.number])
                _write_picture(render(scenes.get(fault, scene), angle, noise), folder / str(step.image))
                append_step(step, folder)
            if report is not None:
                report(k)


def _checked(faults: Mapping[int, Fault], steps: Sequence[Step]) -> dict[int, Fault]:
    numbers = [step.number for step in steps]
    for number, fault in faults.items():
        arguments.one_of(f"faults[{number}]", fault, get_args(Fault))
        if number not in numbers:
            raise ValueError(f"faults: there is no step {number}")
        if fault == "swapped" and number == numbers[-1]:
            raise ValueError(f"faults[{number}]: the last step has no next one to be swapped with")
    return dict(faults)


# What is true


def _weighed(steps: Sequence[Step], rig: Rig, random: np.random.Generator) -> list[Step]:
    """The steps with the masses that truly lie on the pans: each mass of the set keeps its error through the test."""
    pieces = [
        (kind.mass, kind.mass + kind.sigma * random.standard_normal())
        for kind in sorted(rig.masses, key=lambda kind: -kind.mass)
        for _ in range(kind.count)
    ]
    weighed = []
    for step in steps:
        left = list(pieces)
        positive, negative = _weight(step.mass_positive, left), _weight(step.mass_negative, left)
        weighed.append(replace(step, mass_positive=positive, mass_negative=negative))
    return weighed


def _weight(stated: float, left: list[tuple[float, float]]) -> float:
    """Return the true mass for a stated one, made of the largest pieces that are left; a rest has no error."""
    true, rest = 0.0, stated
    for piece in list(left):
        if piece[0] <= rest + 1e-9:
            left.remove(piece)
            rest, true = rest - piece[0], true + piece[1]
    return true + max(rest, 0.0)


def _loaded(
    gear: Gear | Callable[[Step], Gear], rig: Rig, steps: Sequence[Step], given: Mapping[str, Any]
) -> tuple[list[Gear], list[Loading]]:
    """Return the gear and its loading for each position and unit in turn."""
    gears, loadings = [], []
    for _, group in groupby(steps, key=lambda step: step.place):
        own = list(group)
        gears.append(gear if isinstance(gear, Gear) else gear(own[0]))
        loadings.append(load_by_steps(gears[-1], rig, own, **given))
    return gears, loadings


def _write_truth(test: VirtualTest, scene: Scene, seed: int, faults: Mapping[int, Fault]) -> None:
    content = {
        "seed": seed,
        "units": COLUMNS,
        "steps": [
            {"number": step.number}
            | {name: float(getattr(test, name)[k]) for name in COLUMNS}
            | {"markers [px]": scene.centres(float(test.angle[k])).tolist()}
            | ({"fault": faults[step.number]} if step.number in faults else {})
            for k, step in enumerate(test.steps)
        ],
    }
    with replacing(test.folder / "truth.json") as file:
        file.write((json.dumps(content, indent=1) + "\n").encode())


# Photographs


def _write_picture(picture: NDArray[Any], path: Path) -> None:
    from PIL import Image

    content = io.BytesIO()
    Image.fromarray(picture).save(content, "png", compress_level=1)
    with replacing(path) as file:
        file.write(content.getvalue())


@dataclass
class Virtual:
    """A virtual rig: the scene of a target whose shaft comes to rest at the angle of a step.

    Args:
        scene: what is seen
        angles: of the shaft at rest, step by step [rad], shape (n,)
        random: gives the noise of the pictures
        settling: share of the way that is left from one picture to the next [1]
    """

    scene: Scene
    angles: Array
    random: np.random.Generator
    settling: float = 0.1
    step: int = 0
    angle: float = 0.0

    def load(self, number: int) -> None:
        """Lays on what a step asks for, by its number from 1."""
        self.angle = float(self.angles[number - 2]) if number > 1 else float(self.angles[0])
        self.step = number - 1

    def take(self, folder: Path) -> Path:
        """A picture of now; the shaft is nearer to rest with each."""
        path = folder / "picture.png"
        _write_picture(render(self.scene, self.angle, self.random), path)
        rest = float(self.angles[self.step])
        self.angle = rest + self.settling * (self.angle - rest)
        return path


def rehearsal(rig: Rig, steps: Sequence[Step], gear: Gear | Callable[[Step], Gear], seed: int | None = None) -> Virtual:
    """Pictures of a gear on a virtual rig, which comes to rest at each step of a plan.

    Args:
        rig: the rig as it is
        steps: the plan
        gear: which gear, or for each position and unit another one: a function of a step
        seed: of the noise; another one each time if None

    >>> from strainwave.rig import Step, load
    >>> from strainwave.rig.virtual.printed import gear_named
    >>> source = rehearsal(load("couple-rig"), [Step(1, 0.35), Step(2, 0.3)], gear_named("torsional-stiffness-article"))
    >>> source.angles.round(4).tolist()
    [0.0, -0.0109]
    """
    angles = np.concatenate([loading.angle for loading in _loaded(gear, rig, steps, {})[1]])
    return Virtual(usual_scene(rig), angles, np.random.default_rng(seed))
