"""Writes the page that compares the figures of each set of the catalogue as simulated with those that its maker prints."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass
from math import pi
from pathlib import Path
from typing import Any

import numpy as np
import strainwave as sw
from strainwave.typeset import ARCMIN_PER_RADIAN

MIN_END = 1.5  # largest torque of a torsion test over T2, at least, so that K3 shows
LOST_MOTION_SHARE = 0.04  # of the rated torque, at which lost motion is measured
LOST_MOTION_BOUND = 1.0  # arcmin, in tables of the maker (CHA engineering data)
INPUT_SPEED, INPUT_TURNS = 10.0, 2.0  # rad/s of the input, and its revolutions, of the run that measures the kinematic error
SPRING_FREQUENCY = 1000.0  # rad/s: eigenfrequency of output and spring. At 20 rad/s the output follows the input
STARTING, BACKDRIVING, RUNNING = "starting torque", "backdriving torque", "running torque at 3500 rpm"
RUNNING_SPEED = 3500.0 * 2.0 * pi / 60.0  # rad/s
RAMP_DURATION, MAX_SHARE = 2.0, 2.0  # s, and largest torque over the printed one, of the run that finds a torque at the start
PRINTED = re.compile(r"\b(K1|T1|T2) = ([\d.e+-]+) N\.m")  # in the source of a number of the spring
BOUND = re.compile(r"\(< ([\d.]+) arcmin")  # in the source of a number that a bound determines
STIFFNESSES = ("K1", "K2", "K3")
BOUNDED = {
    "loss": "Hysteresis loss",
    "lost": "Lost motion",
    "accuracy": "Transmission accuracy",
}  # that the maker bounds, in words


@dataclass(frozen=True)
class Figure:
    """A figure of a set.

    Attributes:
        name: of the set
        printed: by the maker; a bound for hysteresis loss, lost motion and accuracy
        simulated: by the package
        assumed: True if the set takes the printed number from a similar gear
    """

    name: str
    printed: float
    simulated: float
    assumed: bool

    @property
    def deviation(self) -> float:
        """Difference over the printed number [1]."""
        return self.simulated / self.printed - 1.0


def printed_figures(gear_set: sw.GearSet) -> dict[str, float]:
    """Return K1, K2, K3 [N.m/rad], T1, T2 [N.m] and the bounds [arcmin] that the maker prints, from the sources of the set."""
    spring = "gear.stiffness."
    texts = " ".join(gear_set.sources[f"{spring}{name}"].source for name in ("k1", "t1", "t2"))
    found = {name: float(value) for name, value in PRINTED.findall(texts)}
    spring_law: Any = gear_set.gear.stiffness
    found |= {"K2": spring_law.k2, "K3": spring_law.k3, "lost": LOST_MOTION_BOUND}
    for name, path in (("loss", "gear.hysteresis.breakaway[0]"), ("accuracy", "gear.kinematic_error.amplitude[0]")):
        bound = BOUND.search(gear_set.sources[path].source)
        if bound is None:
            raise ValueError(f"{gear_set.name}: the source of {path} contains no bound of the maker")
        found[name] = float(bound[1])
    return found


def torsion_test(gear: Any, t1: float, t2: float, end: float) -> dict[str, float]:
    """Return K1, K2, K3 [N.m/rad] and the hysteresis loss [arcmin] of a slow torsion test with the input held.

    The gear, never loaded before, goes to the torque `end`, then through one cycle between both ends. The laws are exact over
    any monotone step, so the torques that count are enough.
    """
    _, first, second, last, *_, back, _, forth = gear.twist([0.0, t1, t2, end, -end, end, 0.0, -end, 0.0])
    return {
        "K1": t1 / first,
        "K2": (t2 - t1) / (second - first),
        "K3": (end - t2) / (last - second),
        "loss": arcmin(back - forth),
    }


def lost_motion(gear: Any, rated: float) -> float:
    """Return the turn between plus and minus 4 % of the rated torque [arcmin], in a cycle."""
    torque = LOST_MOTION_SHARE * rated
    *_, minus, plus = gear.twist([0.0, torque, -torque, torque, -torque, torque])
    return arcmin(plus - minus)


def kinematic_error(gear: Any) -> float:
    """Return the largest less the smallest error between the shafts [arcmin], of a run without load at constant speed."""
    drive = sw.Drive(gear=gear, motor=sw.motor.AccelerationSource(), control=sw.control.OpenLoop(), load=light_load(gear))
    still = sw.scenario.constant(0.0, 2.0 * pi * INPUT_TURNS / INPUT_SPEED)
    record = ["input_angle", "output_angle"]
    run = sw.simulate(drive, still, initial={"input_speed": INPUT_SPEED}, sample=1e-3, record=record)
    return arcmin(np.ptp(run["input_angle"] / gear.kinematics.ratio - run["output_angle"]))


def light_load(gear: Any) -> Any:
    """Return a load so light that its vibration on the spring of a gear is fast."""
    return sw.loads.Inertia(inertia=gear.stiffness.k1 / SPRING_FREQUENCY**2)


def arcmin(angle: float) -> float:
    return ARCMIN_PER_RADIAN * float(angle)


def figures_of(name: str) -> dict[str, Figure]:
    """Return the figures of a set, by K1, K2, K3, loss, lost and accuracy; no lost motion of a set without rated torque."""
    gear_set = sw.GearSet.read(name)
    gear, printed = gear_set.gear, printed_figures(gear_set)
    rated = gear_set.ratings["rated_torque"].to("N.m").value if "rated_torque" in gear_set.ratings else None
    simulated = torsion_test(gear, printed["T1"], printed["T2"], max(MIN_END * printed["T2"], rated or 0.0))
    simulated["accuracy"] = kinematic_error(gear)
    if rated is not None:
        simulated["lost"] = lost_motion(gear, rated)
    assumed = gear_set.sources["gear.stiffness.k1"].source.startswith("assumed")
    return {key: Figure(gear_set.name, printed[key], value, assumed) for key, value in simulated.items()}


def every_set() -> dict[str, dict[str, Figure]]:
    """Return the figures of all sets, by series, size and ratio."""
    names = sorted(sw.catalogue(), key=lambda name: (name.split("-")[0], *map(int, name.split("-")[1:])))
    return {name: figures_of(name) for name in names}


def write(path: Path) -> None:
    """Put the tables on the page."""
    found = every_set()
    text = path.read_text(encoding="utf-8")
    for place, lines in (("worst", worst(found)), ("sets", tables(found)), ("torques", [*TORQUES_TABLE, *torque_rows()])):
        mark = f"<!-- the {place} -->"
        if mark not in text:
            raise ValueError(f"{path} has no line {mark}, where they go")
        text = text.replace(mark, "\n".join(lines))
    path.write_text(text, encoding="utf-8")


def tables(found: dict[str, dict[str, Figure]]) -> Iterator[str]:
    """Yield the lines of a section with a table for each series."""
    for series in dict.fromkeys(name.split("-")[0] for name in found):
        yield from (f"## {series.upper()}", "", *TABLE)
        yield from (row(figures) for name, figures in found.items() if name.startswith(series))
        yield ""


TABLE = (
    "| set | K1 | K2 | K3 | largest deviation | hysteresis loss | lost motion | transmission accuracy |",
    "|---|--:|--:|--:|--:|--:|--:|--:|",
)
TORQUES_TABLE = ("| gear | printed for | figure | printed | simulated | deviation |", "|---|---|---|--:|--:|--:|")
# Set, gear that the figure is printed for, what is printed, and the figure [N.m].
TORQUES = (
    ("hfuc-17-100", "CSF-17-100", STARTING, 0.034), ("hfuc-25-50", "CSF-25-50", STARTING, 0.15),
    ("hfuc-20-160", "CPL-20-160", STARTING, 0.029), ("hfuc-17-100", "CSF-17-100", BACKDRIVING, 3.3),
    ("hfuc-25-50", "CSF-25-50", BACKDRIVING, 9.0), ("hfuc-20-160", "CPL-20-160", RUNNING, 0.16),
)  # fmt: skip


def torque_without_load(gear: Any, figure: str, printed: float) -> float:
    """Return a torque without load [N.m]: the first that turns the input in a slow run, or the steady friction at a speed."""
    if figure == RUNNING:
        return float(gear.friction_input.steady(RUNNING_SPEED))
    drive = sw.Drive(gear=gear, motor=sw.motor.TorqueSource(), control=sw.control.OpenLoop(), load=light_load(gear))
    still, ramp = sw.scenario.constant(0.0, RAMP_DURATION), sw.scenario.ramp(MAX_SHARE * printed / RAMP_DURATION, RAMP_DURATION)
    if figure == BACKDRIVING:
        run = sw.simulate(drive, still, load_torque=ramp, sample=1e-3)
        return float(run["load_torque"][run["input_angle"] != 0.0][0])
    run = sw.simulate(drive, ramp, sample=1e-3)
    return float(run["command"][run["input_angle"] != 0.0][0])


def torque_rows() -> list[str]:
    """Return the rows of torques without load, the worst first."""
    found = [
        Figure(f"`{name.upper()}` | {similar} | {figure}", printed, torque_without_load(sw.load(name), figure, printed), True)
        for name, similar, figure, printed in TORQUES
    ]
    return [
        f"| {each.name} | {each.printed:.3g} N·m | {each.simulated:.3g} N·m | {signed(100.0 * each.deviation, 0)} % |"
        for each in sorted(found, key=lambda each: -abs(each.deviation))
    ]


def worst(found: dict[str, dict[str, Figure]]) -> Iterator[str]:
    """Yield sentences that name the set that is furthest off."""
    each = max((worst_stiffness(figures) for figures in found.values()), key=lambda figure: abs(figure.deviation))
    yield f"* **Stiffness**: {each.name} deviates most, by {signed(1e6 * each.deviation, 1)} × 10⁻⁶."
    for key, words in BOUNDED.items():
        bounded = [figures[key] for figures in found.values() if key in figures]
        each = max(bounded, key=lambda figure: figure.deviation)
        yield f"* **{words}**: {each.name} comes nearest to its bound, with {each.simulated:.2f}′ of {each.printed:g}′."


def worst_stiffness(figures: dict[str, Figure]) -> Figure:
    """Return that of K1, K2 and K3 which deviates most."""
    return max((figures[key] for key in STIFFNESSES), key=lambda figure: abs(figure.deviation))


def row(figures: dict[str, Figure]) -> str:
    """Return the row of a set."""
    first = figures["K1"]
    stiffness = [f"{1e-3 * figures[key].printed:g}" for key in STIFFNESSES]
    deviation = signed(1e6 * worst_stiffness(figures).deviation, 1)
    bounded = [f"{figures[key].simulated:.2f} of {figures[key].printed:g}" if key in figures else "" for key in BOUNDED]
    return f"| {' | '.join([f'`{first.name}`' + ('*' if first.assumed else ''), *stiffness, deviation, *bounded])} |"


def signed(value: float, places: int) -> str:
    """Return a number with its sign; zero has none."""
    return f"{value:+.{places}f}".replace("-", "−") if round(value, places) else "0"
