"""A whole drive fitted: ten numbers to a log of 30 s at 500 Hz, beside SciPy's integrators with finite differences.

All know the command, simulate motor, controller, elastic gear, friction and load, and compare both encoders and the current.
`sw.fit` finds how much each channel weighs, and its friction sticks. The others are SciPy's `least_squares` with its own finite
differences; they are told the noise of each channel and begin at the same numbers. One of them simulates by strainwave, the
others by `solve_ivp` of a right-hand side in plain Python, as a person writes it, in which a hyperbolic tangent smooths
Coulomb's friction. These would take many minutes, and are not carried through: one run is timed, and they are taken to need as
many as the fit around strainwave's simulation does.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import Any, Literal

import numpy as np
import strainwave as sw
from measure import least
from numpy.typing import NDArray
from report import Column, print_table, save, three_digits
from rich.console import Console
from strainwave.identification.fitting.fit import Fit

Array = NDArray[np.float64]
Method = Literal["RK45", "LSODA", "Radau"]

DURATION, SAMPLE, DT = 30.0, 2e-3, 1e-3  # s; the step of strainwave's simulation
RATIO, BACK_EMF, INDUCTANCE, PROPORTIONAL, DERIVATIVE, LIMIT = 80.0, 0.0755, 1e-3, 1.0, 0.02, 48.0
TRUTH = {
    "motor.resistance": 0.42, "motor.inertia": 9.4e-5, "gear.friction_input.coulomb": 0.047,
    "gear.friction_input.viscous": 2.9e-4, "gear.stiffness.k": 1.42e4, "gear.damping": 20.0,
    "gear.friction_output.coulomb": 1.0, "gear.friction_output.viscous": 0.5, "load.inertia": 0.85, "load.gravity_torque": 11.0,
}  # fmt: skip
OFF = np.array([0.95, 1.2, 1.4, 0.7, 0.8, 1.6, 0.6, 1.5, 1.3, 0.8])  # where fits begin, over the truth
NOISE = {"input_angle": 1e-3, "output_angle": 1e-5, "current": 0.05}  # rad, rad, A
SMOOTHED = 0.5  # rad/s of the input: there the tangent of the others reaches 76 % of Coulomb's friction
METHODS: dict[Method, float] = {"RK45": 1e-6, "LSODA": 1e-6, "Radau": 1e-5}  # relative tolerances
DIFFERENCE = 1e-4  # of a number: a smaller one drowns in the error of the integrators
ROUNDS = 3
COLUMNS = (
    Column("drive fit", words=True, long=True),
    Column("runs of the model"),
    Column("off the truth [σ]"),
    Column("time of all cores [s]"),
    Column("ratio"),
    Column("time on the wall [s]"),
)


@dataclass(frozen=True)
class DriveFit:
    """A fit: runs of the model; largest distance from the truth in standard deviations of strainwave's, None of a fit that was
    not carried through; time of all cores and on the wall [s], then calculated from one run."""

    name: str
    runs: int
    off: float | None
    cpu_time: float
    wall_time: float


def drive(numbers: Array) -> sw.Drive:
    value = dict(zip(TRUTH, numbers.tolist(), strict=True))
    coulomb, at_output = value["gear.friction_input.coulomb"], value["gear.friction_output.coulomb"]
    return sw.Drive(
        gear=sw.Gear(
            kinematics=sw.kinematics.PlainRatio(reduction=RATIO),
            input_inertia=0.0,
            stiffness=sw.stiffness.Linear(k=value["gear.stiffness.k"]),
            damping=value["gear.damping"],
            friction_input=sw.friction.Coulomb(
                coulomb=coulomb, breakaway=coulomb, viscous=value["gear.friction_input.viscous"]
            ),
            friction_output=sw.friction.Coulomb(
                coulomb=at_output, breakaway=at_output, viscous=value["gear.friction_output.viscous"]
            ),
        ),
        motor=sw.motor.DC(
            resistance=value["motor.resistance"], inductance=INDUCTANCE, torque_constant=BACK_EMF, back_emf=BACK_EMF,
            inertia=value["motor.inertia"],
        ),
        control=sw.control.PID(proportional=PROPORTIONAL, derivative=DERIVATIVE, limit=LIMIT),
        load=sw.loads.Pendulum(inertia=value["load.inertia"], gravity_torque=value["load.gravity_torque"]),
    )  # fmt: skip


def times() -> Array:
    return np.asarray(SAMPLE * np.arange(round(DURATION / SAMPLE) + 1), np.float64)


def commanded() -> Array:
    """Output angle [rad] at the instants of the log: three sines that begin gently."""
    time = times()
    waves = 0.5 * np.sin(0.4 * np.pi * time) + 0.15 * np.sin(2.2 * np.pi * time) + 0.03 * np.sin(8.6 * np.pi * time)
    return np.asarray(np.minimum(time, 1.0) ** 2 * waves)


def measured() -> sw.Recording:
    """A run of the true drive at a tenth of the step, with noise."""
    command, random = commanded(), np.random.default_rng(7)
    run = sw.simulate(drive(truth()), sw.scenario.table(times(), command), DT / 10.0, sample=SAMPLE)
    columns = {name: run[name] + sigma * random.normal(size=len(run)) for name, sigma in NOISE.items()}
    units = {"time": "s", "command": "rad", "input_angle": "rad", "output_angle": "rad", "current": "A"}
    return sw.Recording({"time": run.time, "command": command, **columns}, units)


def truth() -> Array:
    return np.array(list(TRUTH.values()))


def start() -> Array:
    return OFF * truth()


def by_strainwave(log: sw.Recording) -> Fit:
    alike = {f"gear.friction_{side}.breakaway": f"gear.friction_{side}.coulomb" for side in ("input", "output")}
    return sw.fit(drive(start()), log, list(TRUTH), dt=DT, initial={"output_angle": 0.0}, ties=alike)


def rates(numbers: Array, command: Array) -> Callable[[Any, Any], list[float]]:
    """The right-hand side: states are input angle and speed, output angle and speed, and current."""
    resistance, rotor, coulomb, viscous, stiffness, damping, at_output, drag, inertia, gravity = numbers.tolist()
    level, slope = command.tolist(), (np.diff(command) / SAMPLE).tolist()
    last = len(slope) - 1

    def rate(t: Any, x: Any) -> list[float]:
        angle, speed, output, output_speed, current = x.tolist()
        k = min(int(t / SAMPLE), last)
        error = RATIO * (level[k] + slope[k] * (t - k * SAMPLE)) - angle
        voltage = PROPORTIONAL * error + DERIVATIVE * (RATIO * slope[k] - speed)
        voltage = min(max(voltage, -LIMIT), LIMIT)
        torque = stiffness * (angle / RATIO - output) + damping * (speed / RATIO - output_speed)
        friction = coulomb * math.tanh(speed / SMOOTHED) + viscous * speed
        seal = at_output * math.tanh(output_speed * RATIO / SMOOTHED) + drag * output_speed
        return [
            speed,
            (BACK_EMF * current - friction - torque / RATIO) / rotor,
            output_speed,
            (torque - seal - gravity * math.sin(output)) / inertia,
            (voltage - resistance * current - BACK_EMF * speed) / INDUCTANCE,
        ]

    return rate


def run_by(method: Method, numbers: Array, command: Array) -> Array:
    """Input angle, output angle and current at the instants of the log, shape (3, n)."""
    from scipy.integrate import solve_ivp

    found = solve_ivp(
        rates(numbers, command), (0.0, DURATION), np.zeros(5), method, times(), rtol=METHODS[method], atol=1e-8,
    )  # fmt: skip
    return np.asarray(found.y[[0, 2, 4]])


def run_by_strainwave(numbers: Array, command: Array) -> Array:
    """The same by strainwave."""
    run = sw.simulate(drive(numbers), sw.scenario.table(times(), command), DT, sample=SAMPLE)
    return np.array([run[name] for name in NOISE])


def by_scipy(log: sw.Recording, run: Callable[[Array, Array], Array]) -> tuple[Array, int]:
    """Numbers, and runs of the model."""
    from scipy.optimize import least_squares

    runs, known, command = 0, np.array([log[name] for name in NOISE]), commanded()
    sigma = np.array(list(NOISE.values()))[:, np.newaxis]

    def residuals(scaled: Array) -> Array:
        nonlocal runs
        runs += 1
        return np.asarray(((run(scaled * start(), command) - known) / sigma).ravel())

    found = least_squares(residuals, np.ones(len(TRUTH)), bounds=(0.0, np.inf), diff_step=np.full(len(TRUTH), DIFFERENCE))
    return np.asarray(found.x * start()), runs


def run(console: Console) -> None:
    """Prints, and writes the table."""
    log, command = measured(), commanded()
    fitted, *own_times = least(lambda: by_strainwave(log), ROUNDS)
    estimates = {each.path: each for each in fitted.estimates}
    sigma = np.array([estimates[path].sigma for path in TRUTH])

    def off(numbers: Array) -> float:
        return float(np.max(np.abs(numbers - truth()) / sigma))

    rows = [DriveFit("sw.fit", fitted.evaluations, off(np.array([estimates[path].value for path in TRUTH])), *own_times)]
    (numbers, runs), *times_around = least(lambda: by_scipy(log, run_by_strainwave), 1)
    rows.append(DriveFit("SciPy least_squares around sw.simulate", runs, off(numbers), *times_around))
    for method in METHODS:
        _, *times_of_one = least(partial(run_by, method, start(), command), 1)
        rows.append(
            DriveFit(f"SciPy least_squares around solve_ivp, {method}", runs, None, *(runs * each for each in times_of_one))
        )
    cells = [
        (
            row.name,
            str(row.runs),
            "–" if row.off is None else f"{row.off:.2f}",
            *map(three_digits, (row.cpu_time, row.cpu_time / rows[0].cpu_time, row.wall_time)),
        )
        for row in rows
    ]
    print_table(console, "A whole drive fitted", COLUMNS, cells)
    save("drive_fit", rows)


if __name__ == "__main__":
    run(Console())
