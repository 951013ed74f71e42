"""strainwave itself: its methods in C++, models chosen at run time, called from Python."""

from __future__ import annotations

import math
import os
import warnings
from collections.abc import Callable, Iterator, Mapping
from functools import partial
from typing import TYPE_CHECKING

import numpy as np
import reference_drive as reference
from reference_drive import Array
from strainwave import _core

from peers import Crowd, Peer

if TYPE_CHECKING:
    import strainwave as sw
    from strainwave.native.kernels import Job
    from strainwave.simulation.run import Method

    Task = Callable[[], tuple[sw.Drive, sw.scenario.Scenario]]


def friction() -> sw.friction.LuGre:
    """At the input; it could create energy, as its damping does not fade with speed, and warns of it."""
    import strainwave as sw

    with warnings.catch_warnings(action="ignore"):
        return sw.friction.LuGre(
            coulomb=reference.COULOMB,
            breakaway=reference.BREAKAWAY,
            stribeck_speed=reference.STRIBECK_SPEED,
            bristle_stiffness=reference.BRISTLE_STIFFNESS,
            bristle_damping=reference.BRISTLE_DAMPING,
            viscous=reference.VISCOUS_INPUT,
        )


def gear() -> sw.Gear:
    """The gear of the reference drive, by the public interface."""
    import strainwave as sw

    orders = range(1, len(reference.ERROR_AMPLITUDE) + 1)
    # The kinematic error counts positive where the output lags; the drive's twist adds where it leads.
    phase = [p + math.pi for p in reference.ERROR_PHASE]
    return sw.Gear(
        kinematics=sw.kinematics.PlainRatio(reduction=reference.RATIO),
        kinematic_error=sw.kinematic_error.Fourier(order=list(orders), amplitude=list(reference.ERROR_AMPLITUDE), phase=phase),
        stiffness=sw.stiffness.Cubic(a1=reference.STIFFNESS_LINEAR, a3=reference.STIFFNESS_CUBIC),
        hysteresis=sw.hysteresis.MaxwellSlip(
            stiffness=[reference.ELEMENT_STIFFNESS] * reference.ELEMENTS,
            breakaway=[reference.ELEMENT_STIFFNESS * limit for limit in reference.ELEMENT_LIMIT],
        ),
        damping=reference.DAMPING,
        friction_input=friction(),
        friction_output=sw.friction.Viscous(viscous=reference.VISCOUS_OUTPUT),
        input_inertia=0.0,
    )


def drive() -> sw.Drive:
    """The reference drive, by the public interface."""
    import strainwave as sw

    return sw.Drive(
        gear=gear(),
        motor=sw.motor.DC(
            resistance=reference.RESISTANCE,
            inductance=reference.INDUCTANCE,
            torque_constant=reference.MOTOR_CONSTANT,
            back_emf=reference.MOTOR_CONSTANT,
            inertia=reference.INPUT_INERTIA,
        ),
        control=sw.control.PID(
            proportional=reference.PROPORTIONAL, derivative=reference.DERIVATIVE, limit=reference.VOLTAGE_LIMIT
        ),
        load=sw.loads.Pendulum(inertia=reference.OUTPUT_INERTIA, gravity_torque=reference.GRAVITY_TORQUE),
    )


def command(duration: float = reference.DURATION) -> sw.scenario.Scenario:
    """The output angle that the reference drive is to follow."""
    import strainwave as sw

    rise = sw.scenario.ramp(reference.COMMAND_SLOPE, duration)
    return rise + sw.scenario.sine(reference.COMMAND_AMPLITUDE, reference.COMMAND_FREQUENCY, duration)


def repeated(simulate: Callable[[], sw.Recording]) -> Callable[[], Array]:
    """A run that gives output angle and torque."""

    def solve() -> Array:
        run = simulate()
        return np.column_stack([run["output_angle"], run["torque"]])

    solve()  # the first run imports what the later ones need
    return solve


def with_kernel(one: sw.Drive, job: Job) -> sw.Drive:
    """The drive, of which a kernel does this job from now on."""
    from strainwave.native import kernels

    kernels.load_or_raise(one, job)
    return one


def prepare_steps(task: Task, method: Method, step: float) -> Callable[[], Array]:
    """A run of a method with this step, through the public interface."""
    import strainwave as sw

    one, wanted = task()
    with_kernel(one, "simulate")
    return repeated(lambda: sw.simulate(one, wanted, step, sample=reference.SAMPLE, method=method))


def prepare_without_kernel(task: Task, method: Method, step: float) -> Callable[[], Array]:
    """The same by the general drive; in a process of its own, as all that is measured."""
    import strainwave as sw

    os.environ["STRAINWAVE_KERNELS"] = "off"
    one, wanted = task()
    return repeated(lambda: sw.simulate(one, wanted, step, sample=reference.SAMPLE, method=method))


def prepare_tolerance(task: Task, tolerance: float) -> Callable[[], Array]:
    """A run in steps that keep this tolerance."""
    import strainwave as sw

    one, wanted = task()
    with_kernel(one, "simulate_adaptively")
    return repeated(lambda: sw.simulate_adaptively(one, wanted, tolerance, sample=reference.SAMPLE))


def peers(task: Task, steps: Mapping[Method, tuple[float, ...]], tolerances: tuple[float, ...]) -> Iterator[Peer]:
    """One for each method, with steps [s] to try, and the adaptive one, with tolerances."""
    for method, ladder in steps.items():
        name = "strainwave" if method == "exponential" else f"strainwave, {method}"
        yield Peer(name, ("strainwave",), "step", ladder, partial(prepare_steps, task, method))
    general = partial(prepare_without_kernel, task, "exponential")
    yield Peer("strainwave, without kernel", ("strainwave",), "step", steps["exponential"], general)
    yield Peer("strainwave, adaptive", ("strainwave",), "rtol", tolerances, partial(prepare_tolerance, task))


def reference_task() -> tuple[sw.Drive, sw.scenario.Scenario]:
    return drive(), command()


def prepare_crowd(instruction_set: str, members: int, threads: int, step: float) -> Callable[[], Array]:
    """A run of many members side by side."""
    os.environ["STRAINWAVE_INSTRUCTION_SET"] = instruction_set
    import strainwave as sw

    one, wanted, inertias = drive(), command(), {"load.inertia": reference.output_inertias(members)}
    with_kernel(one, "simulate_many")
    outputs = ["output_angle", "torque"]

    def solve() -> Array:
        runs = sw.simulate_many(one, wanted, inertias, step, record=outputs, sample=reference.SAMPLE, threads=threads)
        return np.column_stack([runs[name][0] for name in outputs])

    solve()
    return solve


def prepare_loop(members: int, step: float) -> Callable[[], Array]:
    """The same members one after the other."""
    import strainwave as sw

    one, wanted = with_kernel(drive(), "simulate"), command()
    drives = [one.replace({"load.inertia": inertia}) for inertia in reference.output_inertias(members).tolist()]

    def solve() -> Array:
        first, *_ = [sw.simulate(each, wanted, dt=step, sample=reference.SAMPLE) for each in drives]
        return np.column_stack([first["output_angle"], first["torque"]])

    solve()
    return solve


PEERS = tuple(
    peers(
        reference_task,
        {
            "exponential": (1e-3, 5e-4, 2.5e-4, 2e-4, 1.25e-4, 1e-4, 5e-5, 2e-5),
            "moreau_jean": (2e-4, 1e-4, 5e-5, 2e-5),
            "rosenbrock": (5e-4, 2e-4, 1e-4, 5e-5),
        },
        (1e-3, 1e-4, 1e-6, 1e-8),
    )
)
MEMBERS, MEMBERS_OF_LOOP = 512, 32
CROWDS = (
    *(
        Crowd(
            Peer(
                f"strainwave, {instruction_set}",
                ("strainwave",),
                "step",
                (5e-4, 2e-4),
                partial(prepare_crowd, instruction_set, MEMBERS, threads),
            ),
            MEMBERS,
            threads,
        )
        for instruction_set in _core.instruction_sets()
        for threads in (1, 2)
    ),
    Crowd(
        Peer("strainwave, loop of simulate", ("strainwave",), "step", (5e-4, 2e-4), partial(prepare_loop, MEMBERS_OF_LOOP)),
        MEMBERS_OF_LOOP,
        1,
    ),
)
