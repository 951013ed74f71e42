"""Torsion loops whose loss has drawn sources, by plain numpy: friction of bearing and mesh, dry and viscous, and material.

Springs are linear, cubic or of three segments. Bristles bend over up to 1 % of the travel before they slip, in one design up
to 30 %. The material has the ellipse of a loss factor, the lens of Rayleigh's law, or both. The kinematic error is inside loops
at the input. Sensors have noise, white or with memory, resolution, and a wrong zero. Other designs lack a side, a load, a rate
or the time. The truth is the work of each source over the last cycle of the largest loop, which a share that is stated must
agree with.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from strainwave import Gear, kinematics
from strainwave.files.recording import Recording
from strainwave.identification.candidates.torsion.losses.shares import LossShares, loss_shares

from tests.evidence.drawn.outcome import Outcome, compared

Array = NDArray[np.float64]

SOURCES = (
    "bearing, dry", "bearing, viscous", "gear, dry", "gear, viscous", "mesh, in proportion to the load", "flexspline, material",
)  # fmt: skip
DESIGNS = (
    "whole", "whole", "whole", "whole", "two temperatures", "output alone", "input alone", "one load", "one rate", "no time",
    "gradual slip",
)  # fmt: skip
CYCLES, SAMPLES = 2, 400  # of a loop; of a cycle
ROOM_TEMPERATURE = 295.0  # K


@dataclass(frozen=True)
class Truth:
    """A drawn gear: numbers of its spring, of its sources, and of the sensors."""

    ratio: int
    kind: str
    stiffness: float
    reach: float
    bearing: tuple[float, float]
    gear: tuple[float, float]
    mesh: float
    ellipse: float
    lens: float
    falls: tuple[float, float, float]
    bends: tuple[float, float, float]
    noise: float
    memory: float
    zero: float
    error: tuple[float, float]

    def spring(self, twist: Array) -> Array:
        """Return the torque of the spring [N.m]."""
        size, half = np.abs(twist), self.reach / self.stiffness
        if self.kind == "cubic":
            return self.stiffness * twist * (1.0 + 0.5 * (size / half) ** 2)
        if self.kind == "three segments":
            more = 0.5 * np.maximum(size - 0.3 * half, 0.0) + 0.3 * np.maximum(size - 0.7 * half, 0.0)
            return self.stiffness * np.sign(twist) * (size + more)
        return self.stiffness * twist


def drawn(random: np.random.Generator) -> Truth:
    """Return a gear some of whose sources are absent; together they lose some per cent of the work."""
    ratio, stiffness = int(random.choice([50, 80, 100, 120, 160])), float(random.uniform(5e3, 5e4))
    reach = stiffness * float(random.uniform(5e-4, 3e-3))
    here = random.random(7) < 0.75
    dry, gear_dry = (float(random.uniform(0.01, 0.05)) * reach for _ in range(2))
    rate = 2.0 * np.pi / 60.0 * reach / stiffness  # rad/s of twist at once a minute
    viscous, gear_viscous = (float(random.uniform(0.005, 0.03)) * reach / rate for _ in range(2))
    falls = tuple(random.uniform(0.0, 0.035, 3).tolist())
    return Truth(
        ratio, str(random.choice(["linear", "cubic", "three segments"])), stiffness, reach,
        (here[0] * dry / ratio, here[1] * viscous / ratio**2), (here[2] * gear_dry, here[3] * gear_viscous),
        here[4] * float(random.uniform(0.01, 0.06)), here[5] * float(random.uniform(0.01, 0.05)),
        here[6] * float(random.uniform(0.01, 0.05)), (falls[0], falls[1], falls[2]),
        (*random.uniform(2e-3, 1e-2, 3).tolist(),), float(random.choice([1e-3, 3e-3])), float(random.choice([0.0, 0.6])),
        float(random.uniform(-0.01, 0.01)), (float(random.uniform(0.0, 0.03)), float(random.uniform(0.0, 6.0))),
    )  # fmt: skip


def bristles(twist: Array, bend: float) -> Array:
    """Return the direction of a dry friction whose bristles bend over a way [rad] before they slip, shape (n,)."""
    turned = np.zeros(len(twist))
    for place, step in enumerate(np.diff(twist), 1):
        way = np.sign(step)
        turned[place] = way + (turned[place - 1] - way) * np.exp(-abs(step) / bend)
    return turned


def widths(truth: Truth, twist: Array, time: Array, *, at_input: bool, temperature: float) -> Array:
    """Return the torque of each source at the output [N.m], shape (sources, n)."""
    span = float(np.ptp(twist))
    bearing, mesh, gear = (bristles(twist, 0.5 * bend * span) for bend in truth.bends)
    torque, rate = truth.spring(twist), np.gradient(twist, time)
    colder = ROOM_TEMPERATURE - temperature
    of_bearing, of_mesh, of_oil = (np.exp(fall * colder) for fall in truth.falls)
    bow = 1.0 - (torque / np.abs(torque).max()) ** 2
    material = truth.ellipse * np.sqrt(np.clip(bow, 0.0, None)) + truth.lens * 3.0 * np.pi / 8.0 * bow
    ratio = truth.ratio if at_input else 0.0
    return np.stack([
        ratio * truth.bearing[0] * of_bearing * bearing, ratio**2 * truth.bearing[1] * of_oil * rate,
        truth.gear[0] * of_mesh * gear, truth.gear[1] * of_oil * rate, truth.mesh * of_mesh * np.abs(torque) * mesh,
        np.abs(torque).max() * material * np.sign(rate),
    ])  # fmt: skip


def measured(
    truth: Truth, random: np.random.Generator, *, at_input: bool, load: float, period: float, temperature: float, triangle: bool
) -> tuple[Recording, Array]:
    """Return a loop with its clock and temperature, and the work of each source over its last cycle [J], shape (sources,)."""
    time = np.linspace(0.0, CYCLES * period, CYCLES * SAMPLES + 1)
    turn = time / period
    wave = 1.0 - 4.0 * np.abs((turn + 0.25) % 1.0 - 0.5) if triangle else np.sin(2.0 * np.pi * turn)
    twist = load * truth.reach / truth.stiffness * wave
    of_sources = widths(truth, twist, time, at_input=at_input, temperature=temperature)
    size, phase = truth.error
    uneven = 1.0 + at_input * size * np.sin(2.0 * truth.ratio * twist + phase)
    torque = truth.spring(twist) * uneven + of_sources.sum(axis=0)
    last = slice(-SAMPLES - 1, None)
    work = np.trapezoid(of_sources[:, last], twist[last], axis=1)
    noise = random.normal(size=len(time))
    for place in range(1, len(noise)):
        noise[place] += truth.memory * noise[place - 1]
    torque = torque + truth.noise * truth.reach * noise + truth.zero * load * truth.reach
    step = 2e-4 * float(np.ptp(twist))
    twist = np.round((twist + 2e-4 * float(np.ptp(twist)) * random.normal(size=len(time))) / step) * step
    names = ("input_angle", "input_torque") if at_input else ("twist", "torque")
    factor = -float(truth.ratio) if at_input else 1.0
    series = {"time": time, names[0]: factor * twist, names[1]: torque / factor, "temperature": np.full(len(time), temperature)}
    return Recording(series, {"time": "s", names[0]: "rad", names[1]: "N.m", "temperature": "K"}), work


def loops_of(truth: Truth, design: str, random: np.random.Generator) -> Iterator[tuple[Recording, Array]]:
    """Yield the loops of a design, that of the largest load at the input, or at the output alone, first."""
    sides = (False,) if design == "output alone" else (True,) if design == "input alone" else (True, False)
    loads = (1.0,) if design == "one load" else (1.0, 0.5, 0.25)
    periods = (60.0,) if design == "one rate" else (60.0, 12.0)
    temperatures = (ROOM_TEMPERATURE, ROOM_TEMPERATURE + 20.0) if design == "two temperatures" else (ROOM_TEMPERATURE,)
    triangle = bool(random.random() < 0.5)
    for at_input in sides:
        for temperature in temperatures:
            for load in loads:
                for period in periods:
                    recording, work = measured(
                        truth, random, at_input=at_input, load=load, period=period, temperature=temperature, triangle=triangle
                    )
                    if design == "no time":
                        series = {name: recording[name] for name in recording.names if name != "time"}
                        recording = Recording(series, {name: recording.unit(name) for name in series})
                    yield recording, work


def split(seed: int) -> tuple[LossShares, dict[str, float]]:
    """Return the shares of drawn loops, and the true ones."""
    random = np.random.default_rng(seed)
    truth, design = drawn(random), DESIGNS[seed % len(DESIGNS)]
    if design == "no time":  # of slow loops, as of weights
        truth = replace(truth, bearing=(truth.bearing[0], 0.0), gear=(truth.gear[0], 0.0))
    if design == "gradual slip":
        truth = replace(truth, bends=(*(float(random.uniform(1.0, 30.0)) * np.array(truth.bends)).tolist(),))
    loops = list(loops_of(truth, design, random))
    gear = Gear().replace(kinematics=kinematics.StrainWave(
        flexspline_teeth=2 * truth.ratio, circular_spline_teeth=2 * truth.ratio + 2, fixed="circular_spline"
    ))  # fmt: skip
    result = loss_shares([recording for recording, _ in loops], gear)
    work = loops[0][1]
    return result, dict(zip(SOURCES, (work / work.sum()).tolist(), strict=True))


def outcome(seed: int) -> Outcome:
    """Return whether every share that is stated is true."""
    result, truth = split(seed)
    stated = [each for each in result.shares if each.is_separated]
    if not stated:
        return Outcome("refused", str(result))
    return compared((each.name, each.share, each.sigma, truth[each.name]) for each in stated)
