"""A virtual rig before which a test can be rehearsed, and the gears that are known by name on it."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from itertools import groupby
from math import degrees

import numpy as np

from strainwave._core import Gear
from strainwave.files.gear_set import GearSet
from strainwave.rig.bench.setup import Rig
from strainwave.rig.bench.steps import Step
from strainwave.rig.running.sources import Virtual
from strainwave.rig.virtual.loading import load_by_steps
from strainwave.rig.virtual.printed import TABLE_2, peak_needed, printed_gear
from strainwave.rig.virtual.render import usual_scene

ARTICLE = "torsional-stiffness-article"  # the gears whose loops are the rows of the torsional stiffness article's Table 2


def gear_named(name: str) -> Gear | Callable[[Step], Gear]:
    """The gear of a set or a gear file; or, of the torsional stiffness article, the gear for the position of each step.

    Raises:
        ValueError: there is no such gear
    """
    if name == ARTICLE:
        return lambda step: printed_gear(round(degrees(step.position)))
    return GearSet.read(name).gear


def narrower(positions: Sequence[float], peak: float) -> list[str]:
    """Return in words the rows of the article's Table 2 that do not reach their printed width under a peak torque [N.m].

    >>> narrower([0.0], 0.343)
    []
    >>> print(*narrower([np.radians(60.0)], 0.343))
    at 60 degrees the torsional stiffness article's loop has its 51.9 degrees from 0.353 N.m on; at 0.343 N.m it is narrower
    """
    return [
        f"at {place} degrees the torsional stiffness article's loop has its {TABLE_2[place][-1]:g} degrees from "
        f"{peak_needed(place):.3f} N.m on; at {peak:.3f} N.m it is narrower"
        for place in (round(degrees(position)) for position in positions)
        if peak_needed(place) > peak
    ]


def rehearsal(rig: Rig, steps: Sequence[Step], gear: Gear | Callable[[Step], Gear], seed: int | None = None) -> Virtual:
    """Pictures of a gear on a virtual rig, which comes to rest at each step of a plan.

    Args:
        rig: the rig as it is
        steps: the plan
        gear: which gear, or for each position and unit another one: a function of a step
        seed: of the noise; another one each time if None

    >>> from strainwave.rig import Step, load
    >>> source = rehearsal(load("couple-rig"), [Step(1, 0.35), Step(2, 0.3)], gear_named("torsional-stiffness-article"))
    >>> source.angles.round(4).tolist()
    [0.0, -0.0109]
    """
    angles = []
    for _, group in groupby(steps, key=lambda step: (step.position, step.unit)):
        own = list(group)
        angles.append(load_by_steps(gear if isinstance(gear, Gear) else gear(own[0]), rig, own).angle)
    return Virtual(usual_scene(rig), np.concatenate(angles), np.random.default_rng(seed))
