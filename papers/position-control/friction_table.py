"""The three readings of the position control article's Table 2, and its experiments with each of them.

    python papers/position-control/friction_table.py [--out FOLDER]

By its title Table 2 is viscous friction: the part b v + B, which is added to Coulomb's. By its columns it is the whole
friction. Its speeds may be those of the motor or of the output. Each reading is fitted by a line, and contradicts document
the other tables; see the page of errata. Nothing is averaged.
"""

from __future__ import annotations

from argparse import ArgumentParser
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import strainwave as sw
from matplotlib.figure import Figure
from numpy.typing import ArrayLike
from position_control import TABLE_4
from strainwave.typeset import number

SPEED, FRICTION = (0.1, 0.5, 1.0, 2.0, 5.0), (0.012, 0.028, 0.045, 0.078, 0.165)  # rad/s, N.m: the article, Table 2, measured
CONTRADICTION_SIGMA = 3.0  # standard deviations: two numbers further apart contradict each other
PRINTED = "the article's drive, r = 1/100"
FIGURES = ("root mean square error [rad]", "largest error [rad]", "correlation coefficient [1]")


@dataclass(frozen=True)
class Reading:
    """One way to read a table of friction over speed together with a law over the angle.

    Attributes:
        name: total friction, or its viscous part, of speeds of the motor or of the output
        coulomb: its torque at speed 0 [N.m]: of the viscous part, that on top of Coulomb's
        viscous: its rise with the speed of the motor [N.m.s/rad]
        part: True if the table is the viscous part
        contradicts: contradictions to the law, in words; empty if it fits
        remark: meaning of the offset of a viscous part, in words; empty if there is none
    """

    name: str
    coulomb: float
    viscous: float
    part: bool
    contradicts: tuple[str, ...]
    remark: str


def average_law() -> sw.friction.PositionDependent:
    """Return the article's friction over the angle without its periodic part."""
    law: Any = sw.load("position-drive-full-friction").gear.friction_input
    average: sw.friction.PositionDependent = law.replace(cosine=[], sine=[])
    return average


def readings(speed: ArrayLike = SPEED, torque: ArrayLike = FRICTION, reduction: float = 100.0) -> tuple[Reading, ...]:
    """Return the readings of a table of friction over speed: all friction, its viscous part, the same over output speeds.

    Args:
        speed: of the motor, or of the output in the third reading, positive [rad/s], shape (n,)
        torque: friction [N.m], shape (n,)
        reduction: speed of the motor over that of the output
    """
    law, speed, torque = average_law(), np.asarray(speed, float), np.asarray(torque, float)
    (slope, offset), covariance = np.polyfit(speed, torque, 1, cov=True)
    sigma_slope, sigma_offset = np.sqrt(np.diag(covariance))
    least = float(law.replace(outside="clamp").steady(1e-300, angle=np.linspace(law.domain_start, law.domain_end, 4097)).min())
    slowest = int(np.argmin(speed))
    of_level: tuple[str, ...] = ()
    if torque[slowest] < least - CONTRADICTION_SIGMA * sigma_offset:
        of_level = (
            f"its {torque[slowest]:.3g} N·m in all at {speed[slowest]:.3g} rad/s are less than the {least:.3g} N·m that the "
            "law has at every angle",
        )
    remark = ""
    if offset > CONTRADICTION_SIGMA * sigma_offset:
        remark = (
            f"its offset of {offset:.3g} N·m is no viscous friction: one that reverses is Coulomb friction, and adds to "
            f"the law's {law.constant:.3g} N·m"
        )

    def of_slope(share: float) -> tuple[str, ...]:
        if abs(share * slope - law.viscous) <= CONTRADICTION_SIGMA * share * sigma_slope:
            return ()
        return (
            f"its slope of {share * slope:.3g} N·m·s/rad is {share * slope / law.viscous:.3g} times the law's {law.viscous:g}",
        )

    return (
        Reading("Table 2 as all friction", offset, slope, False, (*of_level, *of_slope(1.0)), ""),
        Reading("Table 2 as viscous part", offset, slope, True, of_slope(1.0), remark),
        Reading("Table 2 as viscous part, output speeds", offset, slope / reduction, True, of_slope(1.0 / reduction), remark),
    )


def commands() -> dict[str, sw.scenario.Scenario]:
    """Return the three experiments of the article: step, 1 Hz sine and pulse train of the output angle [rad], from zero."""
    return {
        "step": sw.scenario.step(amplitude=0.05, duration=2.0, start=0.1),
        "sine": sw.scenario.sine(amplitude=0.05, frequency=1.0, duration=3.0),
        "pulse-train": sw.scenario.pulse_train(amplitude=0.05, period=1.0, width=0.5, duration=3.0, start=0.1),
    }


def experiments() -> dict[str, dict[str, sw.Run]]:
    """Return runs of each experiment with each reading, and with the article's own drive, by their names."""
    printed = sw.load("position-drive")
    drives = {each.name: printed.replace({"gear.friction_input": _law(each, printed)}) for each in readings()}
    drives[PRINTED] = printed
    return {
        name: {label: sw.simulate(drive, command, sample=2e-3) for label, drive in drives.items()}
        for name, command in commands().items()
    }


def _law(reading: Reading, printed: sw.Drive) -> sw.friction.Coulomb:
    """Return the friction law of a reading; the excess of the static friction is the article's."""
    law: Any = printed.gear.friction_input
    dry = reading.coulomb + (law.coulomb if reading.part else 0.0)
    return sw.friction.Coulomb(coulomb=dry, breakaway=dry * law.breakaway / law.coulomb, viscous=reading.viscous)


def figures_of(run: sw.Recording) -> tuple[float, float, float]:
    """Return root mean square and largest error of the output angle against its command [rad], and their correlation."""
    error = run["output_angle"] - run["command"]
    correlation = np.corrcoef(run["output_angle"], run["command"])[0, 1]
    return float(np.sqrt(np.mean(error**2))), float(np.abs(error).max()), float(correlation)


def summary(found: dict[str, dict[str, sw.Run]]) -> Iterator[str]:
    """Yield the contradictions of each reading, and the figures of each experiment as Markdown tables."""
    for reading in readings():
        yield f"{reading.name} contradicts the other tables: {'; '.join(reading.contradicts)}."
    for name, runs in found.items():
        yield f"\n| {name} | {' | '.join(runs)} | article, Table 4 |\n|{'---|' * (len(runs) + 2)}"
        for what, values, published in zip(
            FIGURES, zip(*map(figures_of, runs.values()), strict=True), TABLE_4[name], strict=True
        ):
            yield f"| {what} | {' | '.join(number(value, 4) for value in values)} | {number(published, 4)} |"


def figure_of(runs: dict[str, sw.Run]) -> Figure:
    """Draw command, responses and their differences from it over time."""
    figure = Figure((7.0, 4.5), layout="constrained")
    response, error = figure.subplots(2, 1, sharex=True, height_ratios=(2.0, 1.0))
    for place, (label, run) in enumerate(runs.items()):
        if place == 0:
            response.plot(run.time, 1e3 * run["command"], color="black", linewidth=0.9, label="command")
        response.plot(run.time, 1e3 * run["output_angle"], color=f"C{place}", label=label)
        error.plot(run.time, 1e3 * (run["output_angle"] - run["command"]), color=f"C{place}")
    response.set_ylabel("output angle [mrad]")
    error.set(ylabel="response − command [mrad]", xlabel="time [s]")
    response.legend()
    return figure


def main() -> None:
    """Print the readings of Table 2 and the experiments with each, and draw them."""
    options = ArgumentParser(description=main.__doc__)
    options.add_argument("--out", type=Path, default=Path("out/friction-table"), help="folder of the figures")
    out = options.parse_args().out
    found = experiments()
    out.mkdir(parents=True, exist_ok=True)
    for name, runs in found.items():
        figure_of(runs).savefig(out / f"{name}.svg")
    print(*summary(found), sep="\n")


if __name__ == "__main__":
    main()
