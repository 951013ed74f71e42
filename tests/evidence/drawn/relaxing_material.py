"""Torsion loops at four rates of drawn gears whose material relaxes, or does not: a Maxwell branch in closed form.

The gears are those of `loss_sources`. Under a sine of the amplitude a and the angular frequency omega a branch adds the torque
a (k' sin + k'' cos), and a cycle loses pi a² k''. The relaxation time lies between the fastest and the slowest rate.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from strainwave import Gear, kinematics
from strainwave.files.recording import Recording
from strainwave.identification.candidates.torsion.losses.fit import REVERSAL_SHARES
from strainwave.identification.candidates.torsion.losses.shares import loss_shares
from strainwave.identification.experiments.loss_loop import LossLoop

from tests.evidence.drawn.loss_sources import ROOM_TEMPERATURE, SOURCES, Truth, drawn, measured
from tests.evidence.drawn.outcome import Outcome, compared

Array = NDArray[np.float64]

PERIODS, LOADS = (240.0, 60.0, 15.0, 4.0), (1.0, 0.5, 0.25)  # s; of the largest
RELAXING = "flexspline, relaxing material"


def relaxing(
    truth: Truth, branch: tuple[float, float], random: np.random.Generator, at_input: bool, load: float, period: float
) -> tuple[Recording, Array]:
    """Return a loop with a branch of a stiffness [N.m/rad] and a relaxation time [s], and the work of each source [J]."""
    loop, work = measured(
        truth, random, at_input=at_input, load=load, period=period, temperature=ROOM_TEMPERATURE, triangle=False
    )
    (stiffness, relaxation_time), size, rate = branch, load * truth.reach / truth.stiffness, 2.0 * np.pi / period
    turned, phase = rate * relaxation_time, rate * loop.time
    viscous = stiffness * turned / (1.0 + turned**2)
    torque = size * viscous * (turned * np.sin(phase) + np.cos(phase))
    name, factor = ("input_torque", -float(truth.ratio)) if at_input else ("torque", 1.0)
    series = {each: loop[each] for each in loop.names} | {name: loop[name] + torque / factor}
    return Recording(series, {each: loop.unit(each) for each in series}), np.append(work, np.pi * size**2 * viscous)


def outcome(seed: int) -> Outcome:
    """Return whether every share that is stated is true, and none of a material that does not relax."""
    random = np.random.default_rng(seed)
    truth, peak = drawn(random), float(random.uniform(0.01, 0.05)) * bool(random.random() < 0.75)
    relaxation_time = float(np.exp(random.uniform(np.log(PERIODS[-1]), np.log(PERIODS[0])))) / (2.0 * np.pi)
    branch = 2.0 * peak * truth.stiffness, relaxation_time
    conditions = [(side, load, period) for side in (True, False) for load in LOADS for period in PERIODS]
    loops = [relaxing(truth, branch, random, *each) for each in conditions]
    teeth = 2 * truth.ratio
    wave = kinematics.StrainWave(flexspline_teeth=teeth, circular_spline_teeth=teeth + 2, fixed="circular_spline")
    gear = Gear().replace(kinematics=wave)
    result = loss_shares([loop for loop, _ in loops], gear)
    (work,) = (work for loop, work in loops if LossLoop.of(loop, gear).apart(REVERSAL_SHARES[1]).words == result.loop)
    true_shares = dict(zip((*SOURCES, RELAXING), (work / work.sum()).tolist(), strict=True))
    stated = [each for each in result.shares if each.is_separated]
    return compared((each.name, each.share, each.sigma, true_shares[each.name]) for each in stated)
