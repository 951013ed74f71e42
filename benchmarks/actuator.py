"""The tilt actuator's ramp of 90 degrees in 5 s, its gear in stages: accuracy and time, beside others on the same equations.

Errors are the largest over 5 s at 1 kHz, against the classical Runge-Kutta method at 0.5 us. The row of the lumped gear shows
what one spring in place of the stages loses and gains. Timed beside them are both sets as they come, with friction that sticks
and sensors that are noisy. The ensemble: many actuators that differ in the inertia of their load.
"""

from __future__ import annotations

import contextlib
import tempfile
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cache, partial
from typing import Any, Literal

import actuator_drive
import numpy as np
from measure import Effort, Failure, Result, measure_all
from peers import Crowd, Peer, casadi_cvodes, strainwave_drive
from reference_drive import DURATION, SAMPLE, Array, Maths, numba_maths
from report import Column, print_table, save, three_digits
from rich.console import Console
from single import ratio, shown

STEPS_PER_SAMPLE = 2000  # 0.5 us, of the reference
TOLERANCES = (1e-3, 1e-4, 1e-5, 1e-6)
MEMBERS, STEP = 16, 5e-4  # of the ensemble; s
THOROUGH = Effort(limit=120.0, runs=20, enough=5.0)
QUICK = Effort(limit=20.0, runs=1, enough=0.0)

SETS = (
    Column("solver", words=True),
    Column("setting", words=True),
    *(Column(heading) for heading in ("angle error [rad]", "torque error [N.m]", "wall [ms]", "times real time", "ratio")),
)
MANY = (
    Column("solver", words=True),
    Column("setting", words=True),
    *(Column(heading) for heading in ("threads", "members", "torque error [N.m]", "trajectories [1/s]", "times real time")),
)


# ---- The peers -------------------------------------------------------------------------------------------------------


@cache
def compiled() -> tuple[Callable[..., Any], Array]:
    """The right-hand side compiled by Numba, and the state at the start."""
    maths = numba_maths(error_model="numpy")
    return actuator_drive.right_hand_side(maths), actuator_drive.initial_state(maths)


def reference() -> Array:
    """Output angle and torque at the sample times, by the classical Runge-Kutta method; shape (5001, 2)."""
    maths, inertia = numba_maths(error_model="numpy"), actuator_drive.drive().load.inertia
    fill, start = compiled()

    @maths.compile
    def run(step: float, steps: int, count: int) -> Any:
        y, states = start.copy(), np.empty((start.size, count))
        k1, k2, k3, k4 = np.empty_like(y), np.empty_like(y), np.empty_like(y), np.empty_like(y)
        states[:, 0] = y
        for j in range(1, count):
            for i in range(steps):
                time = ((j - 1) * steps + i) * step
                fill(time, y, k1, inertia)
                fill(time + 0.5 * step, y + 0.5 * step * k1, k2, inertia)
                fill(time + 0.5 * step, y + 0.5 * step * k2, k3, inertia)
                fill(time + step, y + step * k3, k4, inertia)
                y = y + step / 6.0 * (k1 + 2.0 * (k2 + k3) + k4)
            states[:, j] = y
        return states

    count = len(actuator_drive.sample_times())
    return actuator_drive.output_and_torque(run(SAMPLE / STEPS_PER_SAMPLE, STEPS_PER_SAMPLE, count))


def by_cvode(tolerance: float) -> Callable[[], Array]:
    """CVODE through scikit-sundae, right-hand side by Numba."""
    from sksundae.cvode import CVODE

    fill, start = compiled()
    inertia = actuator_drive.drive().load.inertia
    fill(0.0, start, np.empty_like(start), inertia)

    def rates(time: float, state: Array, out: Array) -> None:
        fill(time, state, out, inertia)

    solver = CVODE(rates, rtol=tolerance, atol=tolerance * actuator_drive.state_scale(), max_num_steps=5_000_000)

    def solve() -> Array:
        solution = solver.solve(actuator_drive.sample_times(), start)
        if not solution.success:
            raise RuntimeError(f"CVODE: {solution.message}")
        return actuator_drive.output_and_torque(np.asarray(solution.y).T)

    return solve


def by_scipy(method: Literal["LSODA", "Radau"], tolerance: float) -> Callable[[], Array]:
    """`solve_ivp`, right-hand side by Numba."""
    from scipy.integrate import solve_ivp

    maths = numba_maths(error_model="numpy")
    fill, start = compiled()
    inertia = actuator_drive.drive().load.inertia

    @maths.compile
    def rates(time: float, state: Any) -> Any:
        out = np.empty(state.size)
        fill(time, state, out, inertia)
        return out

    rates(0.0, start)

    def solve() -> Array:
        times, scale = actuator_drive.sample_times(), actuator_drive.state_scale()
        solution = solve_ivp(rates, (0.0, DURATION), start, method, times, rtol=tolerance, atol=tolerance * scale)
        if not solution.success:
            raise RuntimeError(f"{method}: {solution.message}")
        return actuator_drive.output_and_torque(solution.y)

    return solve


def integrator(execution: dict[str, Any], tolerance: float) -> tuple[Any, Array]:
    """(start, load inertia) -> the states at all sample times but the first, by CVODES through CasADi; and that start."""
    import casadi

    maths = Maths(
        casadi.sin,
        casadi.cos,
        casadi.exp,
        casadi.fabs,
        casadi.fmin,
        casadi.fmax,
        casadi.if_else,
        lambda function: function,
    )
    start = np.array(actuator_drive.initial_state(maths), dtype=np.float64)
    time, state, inertia = casadi.SX.sym("time"), casadi.SX.sym("state", start.size), casadi.SX.sym("load_inertia")
    rates = casadi.SX.zeros(start.size)
    actuator_drive.right_hand_side(maths)(time, state, rates, inertia)
    # One absolute tolerance for all: the states in units of their sizes.
    scale = actuator_drive.state_scale()
    scaled = casadi.substitute(rates, state, scale * state) / scale
    equations = {"t": time, "x": state, "p": inertia, "ode": scaled}
    options = {"reltol": tolerance, "abstol": tolerance, "max_num_steps": 5_000_000, **execution}
    with tempfile.TemporaryDirectory() as folder, contextlib.chdir(folder):
        return casadi.integrator("actuator", "cvodes", equations, 0.0, list(actuator_drive.sample_times()[1:]), options), start


def by_casadi(execution: dict[str, Any], tolerance: float) -> Callable[[], Array]:
    integrate, start = integrator(execution, tolerance)
    scale, inertia = actuator_drive.state_scale(), actuator_drive.drive().load.inertia

    def solve() -> Array:
        states = scale[:, None] * np.array(integrate(x0=start / scale, p=inertia)["xf"])
        return actuator_drive.output_and_torque(np.column_stack([start, states]))

    return solve


def casadi_crowd(members: int, threads: int, tolerance: float) -> Callable[[], Array]:
    """CasADi's map over threads."""
    integrate, start = integrator(casadi_cvodes.COMPILED, tolerance)
    mapped, scale = integrate.map(members, "thread", threads), actuator_drive.state_scale()
    starts, inertias = np.tile((start / scale)[:, None], members), actuator_drive.load_inertias(members)[None, :]

    def solve() -> Array:
        states = np.array(mapped(x0=starts, p=inertias)["xf"])[:, : len(actuator_drive.sample_times()) - 1]
        return actuator_drive.output_and_torque(np.column_stack([start, scale[:, None] * states]))

    return solve


def task() -> tuple[Any, Any]:
    return actuator_drive.drive(), actuator_drive.command()


def lumped_task() -> tuple[Any, Any]:
    return actuator_drive.drive("tilt-actuator-lumped"), actuator_drive.command()


def strainwave_crowd(members: int, threads: int, step: float) -> Callable[[], Array]:
    """Packs."""
    import strainwave as sw

    one, wanted = task()
    strainwave_drive.with_kernel(one, "simulate_many")
    inertias, outputs = {"load.inertia": actuator_drive.load_inertias(members)}, ["output_angle", "torque"]

    def solve() -> Array:
        runs = sw.simulate_many(one, wanted, inertias, step, record=outputs, sample=SAMPLE, threads=threads)
        return np.column_stack([runs[name][0] for name in outputs])

    solve()
    return solve


PEERS = (
    *strainwave_drive.peers(
        task, {"exponential": (5e-4, 2e-4, 1e-4, 3.3e-5), "rosenbrock": (1e-3, 5e-4, 2e-4, 1e-4)}, TOLERANCES
    ),
    Peer(
        "lumped gear, strainwave",
        ("strainwave",),
        "step",
        (5e-4, 2e-4, 1e-4),
        partial(strainwave_drive.prepare_steps, lumped_task, "exponential"),
    ),
    Peer("CasADi CVODES", ("casadi",), "rtol", TOLERANCES, partial(by_casadi, casadi_cvodes.INTERPRETED)),
    Peer("CasADi CVODES, gcc", ("casadi",), "rtol", TOLERANCES, partial(by_casadi, casadi_cvodes.COMPILED)),
    Peer("CVODE, Numba", ("scikit-sundae", "numba"), "rtol", TOLERANCES, by_cvode),
    Peer("SciPy LSODA, Numba", ("scipy", "numba"), "rtol", (1e-3, 1e-4, 1e-5), partial(by_scipy, "LSODA")),
    Peer("SciPy Radau, Numba", ("scipy", "numba"), "rtol", (1e-3, 1e-4), partial(by_scipy, "Radau")),
)


def crowd(name: str, distribution: str, setting: str, value: float, members: int, threads: int, prepare: Any) -> Crowd:
    return Crowd(Peer(name, (distribution,), setting, (value,), partial(prepare, members, threads)), members, threads)


CROWDS = (
    *(crowd("strainwave, packs", "strainwave", "step", STEP, MEMBERS, threads, strainwave_crowd) for threads in (1, 2)),
    crowd("CasADi map, CVODES, gcc", "casadi", "rtol", 1e-4, 4, 2, casadi_crowd),
)


# ---- As it comes -----------------------------------------------------------------------------------------------------


def as_it_comes(name: str, step: float) -> Callable[[], Array]:
    """A set with its sticking friction and its noise."""
    import strainwave as sw

    one, wanted = strainwave_drive.with_kernel(sw.load(name), "simulate"), actuator_drive.command()
    return strainwave_drive.repeated(lambda: sw.simulate(one, wanted, step, sample=SAMPLE))


ITSELF = (
    Peer("gear in stages", ("strainwave",), "step", (STEP,), partial(as_it_comes, "tilt-actuator")),
    Peer("lumped gear", ("strainwave",), "step", (2e-4,), partial(as_it_comes, "tilt-actuator-lumped")),
)


# ---- The part --------------------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Rate:
    """Many actuators at one setting."""

    first: Result
    members: int
    threads: int

    @property
    def trajectories(self) -> float:
        """A second."""
        return self.members / self.first.wall_time


def run(console: Console, peers: Sequence[str], quick: bool) -> None:
    """Measures those peers whose name contains one of the words; prints, and writes the tables."""
    effort = QUICK if quick else THOROUGH
    with console.status("actuator: reference"):
        exact = reference()
    chosen = [peer for peer in PEERS if any(word in peer.name.lower() for word in peers)]
    outcomes = [outcome for _, outcome in measure_all(console, chosen, effort, exact)]
    results = [outcome for outcome in outcomes if isinstance(outcome, Result)]
    caption = "ratio: time over that of strainwave's cheapest setting with errors no larger"
    print_table(console, f"The tilt actuator, {DURATION:.0f} s", SETS, [row(each, results) for each in results], caption)
    told = {each.peer: each for each in CROWDS if any(word in each.peer.name.lower() for word in peers)}
    many = []
    for peer, outcome in measure_all(console, list(told), effort, exact):
        outcomes += [outcome] if isinstance(outcome, Failure) else []
        many += [Rate(outcome, told[peer].members, told[peer].threads)] if isinstance(outcome, Result) else []
    print_table(console, f"Many tilt actuators, {DURATION:.0f} s each", MANY, [rate_row(each) for each in many])
    alone = [outcome for _, outcome in measure_all(console, ITSELF, effort, exact)]
    for outcome in alone:
        if isinstance(outcome, Result):
            times = three_digits(DURATION / outcome.wall_time)
            said = f"{outcome.solver}, {outcome.setting}: {three_digits(1e3 * outcome.wall_time)} ms, {times} times real time"
            console.print(f"As the set comes, with stick and noise, {said}", markup=False)
    for outcome in (*outcomes, *alone):
        if isinstance(outcome, Failure):
            console.print(f"{outcome.solver}, {outcome.setting}: {outcome.reason}", markup=False)
    crowds = [{"first": vars(each.first), "members": each.members, "threads": each.threads} for each in many]
    itself = [vars(each) for each in alone]
    save("actuator", outcomes, quick=quick, peak_torque=float(np.abs(exact[:, 1]).max()), many=crowds, as_it_comes=itself)


def row(each: Result, results: Sequence[Result]) -> list[str]:
    return [
        each.solver,
        each.setting,
        f"{each.output_angle_error:.1e}",
        f"{each.torque_error:.1e}",
        three_digits(1e3 * each.wall_time),
        three_digits(DURATION / each.wall_time),
        shown(ratio(each, results, lambda other: other.wall_time)),
    ]


def rate_row(each: Rate) -> list[str]:
    return [
        each.first.solver,
        each.first.setting,
        str(each.threads),
        str(each.members),
        f"{each.first.torque_error:.1e}",
        three_digits(each.trajectories),
        three_digits(DURATION * each.trajectories),
    ]
