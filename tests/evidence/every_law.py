"""Every law of a drive in logs whose truth is known: `python -m tests.evidence.every_law --truths 50`.

Of each truth, drawn at random, a run under a known voltage makes a log of the speed of the input, the current and the
transmission error, each with noise of 1 % of its range. A fit of the numbers of that law, which starts up to 15 % off, must
hold each within two standard deviations in 90 % of the cases; scatter over stated standard deviation must lie between 0.7 and
1.4. All else of the drive is known, as it would be from tables and loops.

Loops by themselves are `tests.evidence.loops`; tables of friction, presliding loops, breakaway and warm-ups are held to the
same in `tests/python/identification/candidates`.
"""

from __future__ import annotations

import argparse
import sys
import warnings
from collections.abc import Callable
from functools import partial

import numpy as np
import strainwave as sw
from numpy.typing import NDArray
from strainwave.parameters import every

from tests.evidence.loops import BESIDE, COVERED, NOISE, SCATTER, WHOLE, spring

Array = NDArray[np.float64]
Draw = np.random.Generator
DURATION, RATE = 2.0, 500.0  # s, 1/s
OFF = 0.15  # of a number, at most: where fits start
RATIO = 100.0
CHANNELS = ("input_speed", "current", "transmission_error")
DRY = {"coulomb": 0.03, "breakaway": 0.03}  # N.m
RISE = {"coulomb": 0.03, "breakaway": 0.02, "stribeck_speed": 3.0, "viscous": 3e-4}
FALL = {"coulomb": 0.03, "breakaway": 0.045, "stribeck_speed": 3.0, "viscous": 3e-4}


def base() -> sw.Drive:
    return sw.Drive(
        gear=sw.Gear(
            kinematics=sw.kinematics.PlainRatio(reduction=RATIO),
            stiffness=sw.stiffness.Linear(k=2e4),
            damping=20.0,
            friction_input=sw.friction.Coulomb(**DRY, viscous=3e-4),
        ),
        motor=sw.motor.DC(resistance=0.5, inductance=5e-4, torque_constant=0.1, back_emf=0.1, inertia=1e-4),
        load=sw.loads.Inertia(inertia=0.5),
    )


def input_friction(law: object) -> sw.Drive:
    return base().replace(gear=base().gear.replace(friction_input=law))  # type: ignore[arg-type]


def mesh_friction(law: object) -> sw.Drive:
    """On a drive that lifts a weight, as friction under load needs."""
    gear = base().gear.replace(friction_mesh=law)  # type: ignore[arg-type]
    return base().replace(gear=gear, load=sw.loads.Pendulum(inertia=0.5, gravity_torque=40.0))


def elastic(law: object, hysteresis: object = None) -> sw.Drive:
    gear = base().gear.replace(stiffness=law)  # type: ignore[arg-type]
    return base().replace(gear=gear if hysteresis is None else gear.replace(hysteresis=hysteresis))  # type: ignore[arg-type]


def erring(law: object) -> sw.Drive:
    return base().replace(gear=base().gear.replace(kinematic_error=law))  # type: ignore[arg-type]


def loaded(law: object) -> sw.Drive:
    return base().replace(load=law)  # type: ignore[arg-type]


FRICTION: dict[str, tuple[object, list[str]]] = {
    "viscous": (sw.friction.Viscous(viscous=1e-3), ["viscous"]),
    "coulomb": (sw.friction.Coulomb(**DRY, viscous=3e-4), ["coulomb", "viscous"]),
    "stribeck": (sw.friction.Stribeck(**FALL), [*FALL]),
    "curved viscous": (
        sw.friction.CurvedViscous(coulomb=0.03, breakaway=0.03, stribeck_speed=3.0, viscous_torque=0.04, exponent=0.6,
                                  reference_speed=60.0),
        ["coulomb", "viscous_torque", "exponent"],
    ),
    "asymmetric": (
        sw.friction.Asymmetric(law=sw.friction.Coulomb(**DRY, viscous=3e-4), dry_asymmetry=0.2, viscous_asymmetry=0.3),
        ["law.coulomb", "law.viscous", "dry_asymmetry", "viscous_asymmetry"],
    ),
    "cyclic": (
        sw.friction.Cyclic(law=sw.friction.Coulomb(**DRY, viscous=3e-4), order=[2.0], amplitude=[0.3], phase=[0.7]),
        ["law.coulomb", "amplitude", "phase"],
    ),
    "map over angle and speed": (
        sw.friction.AngleSpeedMap(speed=[2.0, 40.0], level=[0.03, 0.04, 0.035, 0.05, 0.06, 0.055]), ["level"],
    ),
    "position dependent": (
        sw.friction.PositionDependent(constant=0.03, linear=2e-4, cosine=[0.006], sine=[0.004], domain_start=-200.0,
                                      domain_end=200.0, viscous=3e-4),
        ["constant", "cosine", "sine", "viscous"],
    ),
    "LuGre": (
        sw.friction.LuGre(**FALL, bristle_stiffness=10.0, bristle_damping=5e-4), ["coulomb", "viscous", "bristle_stiffness"],
    ),
    "Maxwell slip": (
        sw.friction.MaxwellSlipFriction(**RISE, stiffness=[6.0, 2.0], share=[0.6, 0.4], attraction=50.0),
        ["coulomb", "viscous", "stiffness"],
    ),
}  # fmt: skip
MESH: dict[str, tuple[object, list[str]]] = {
    "load dependent": (
        sw.friction.LoadDependent(driving_forward=0.05, driving_reverse=0.05, backdriving_forward=0.04,
                                  backdriving_reverse=0.04),
        ["driving_forward", "driving_reverse", "backdriving_forward", "backdriving_reverse"],
    ),
    "efficiency": (sw.friction.TorqueEfficiency(average_loss=0.06, difference_loss=0.02, presliding=1e-4),
                   ["average_loss", "difference_loss"]),
    "lubricated under load": (
        sw.friction.MixedLubrication(coulomb=3.0, breakaway=3.0, stribeck_speed=0.03, viscous=3.0, load_sensitivity=0.02),
        ["coulomb", "viscous", "load_sensitivity"],
    ),
}  # fmt: skip
ERRORS: dict[str, tuple[object, list[str]]] = {
    "Fourier": (sw.kinematic_error.Fourier(order=[2.0, 4.0], amplitude=[2e-4, 8e-5], phase=[0.7, 1.9]), ["amplitude", "phase"]),
    "tooth errors": (
        sw.kinematic_error.ToothErrors(flexspline_teeth=200, circular_spline_teeth=202, pitch_radius=0.03, engaged_share=0.2,
                                       flexspline_amplitude=[0.0, 5e-6], flexspline_phase=[0.0, 0.3],
                                       circular_spline_amplitude=[0.0, 8e-6], circular_spline_phase=[0.0, 1.0]),
        ["flexspline_amplitude[1]", "circular_spline_amplitude[1]"],  # two engaged places opposite cancel the first
    ),
}  # fmt: skip
LOADS: dict[str, tuple[object, list[str]]] = {
    "inertia": (sw.loads.Inertia(inertia=0.5), ["inertia"]),
    "pendulum": (
        sw.loads.Pendulum(inertia=0.5, gravity_torque=30.0, gravity_phase=0.4), ["inertia", "gravity_torque", "gravity_phase"],
    ),
    "torsion spring": (
        sw.loads.TorsionSpring(inertia=0.5, stiffness=60.0, damping=4.0, rest_angle=0.05), ["inertia", "stiffness", "damping"],
    ),
    "aerodynamic": (
        sw.loads.Aerodynamic(inertia=0.5, area=0.5, chord=0.4, airspeed=30.0, moment_slope=0.5, drag_coefficient=1.0,
                             drag_radius=0.5),
        ["inertia", "moment_slope"],
    ),
    "torque table": (
        sw.loads.TorqueTable(inertia=0.5, angle=[-2.0, -0.3, 0.3, 2.0], held_torque=[-30.0, -8.0, 10.0, 35.0]),
        ["inertia", "held_torque"],
    ),
}  # fmt: skip


def varied(drive: sw.Drive, paths: list[str], draw: Draw, by: float) -> sw.Drive:
    """The drive with those numbers up to so much larger or smaller."""
    return drive.replace({path: every(drive)[path].value * draw.uniform(1.0 - by, 1.0 + by) for path in paths})


def numbers(drive: sw.Drive, free: list[str]) -> list[str]:
    """Paths of the numbers that are freed."""
    return [path for path in every(drive) if any(path == name or path.startswith(f"{name}[") for name in free)]


def fixed(drive: sw.Drive, free: list[str], draw: Draw) -> tuple[sw.Drive, list[str]]:
    return varied(drive, numbers(drive, free), draw, 0.3), free


def of_spring(kind: str, draw: Draw) -> tuple[sw.Drive, list[str]]:
    drive = elastic(spring(kind, draw))
    free = [path for path in every(drive) if path.startswith("gear.stiffness.") and not path.endswith("reduction")]
    return drive, free


def of_memory(law: Callable[[Draw], object], draw: Draw) -> tuple[sw.Drive, list[str]]:
    drive = elastic(sw.stiffness.Cubic(a1=1.2e4, a3=3e9), law(draw))
    free = [path for path in every(drive) if path.startswith("gear.hysteresis.") and not path.endswith("reduction")]
    return drive, free


Case = Callable[[Draw], tuple[sw.Drive, list[str]]]


def cases() -> dict[str, Case]:
    """Of each law a truth, drawn at random, and what is free."""
    found: dict[str, Case] = {}
    parts: list[tuple[str, Callable[[object], sw.Drive], str, dict[str, tuple[object, list[str]]]]] = [
        ("friction", input_friction, "gear.friction_input", FRICTION),
        ("friction of the mesh", mesh_friction, "gear.friction_mesh", MESH),
        ("kinematic error", erring, "gear.kinematic_error", ERRORS),
        ("load", loaded, "load", LOADS),
    ]
    for part, built, path, laws in parts:
        for name, (law, free) in laws.items():
            found[f"{part}: {name}"] = partial(fixed, built(law), [f"{path}.{each}" for each in free])
    found["damping"] = partial(fixed, base(), ["gear.damping", "gear.stiffness.k"])
    found["motor"] = partial(fixed, base(), ["motor.resistance", "motor.torque_constant", "motor.inertia"])
    for kind in ("linear spring", "cubic spring", "piecewise spring", "three-segment spring", "linear spring behind play"):
        found[f"spring: {kind}"] = partial(of_spring, kind)
    for beside, law in [*BESIDE[1:], *WHOLE]:
        found[f"hysteresis: {type(beside).__name__}{getattr(beside, 'branches', '')}"] = partial(of_memory, law)
    return found


def log(truth: sw.Drive, draw: Draw) -> sw.Recording:
    """A run with fast and slow motion, in which the drive turns round a hundred times."""
    time = np.linspace(0.0, DURATION, round(DURATION * RATE) + 1)
    sweep = 2.0 * np.pi * (0.5 * time + 0.5 * 7.5 / DURATION * time**2)
    command = 6.0 * np.sin(sweep) + 4.0 * np.sin(2.0 * np.pi * 1.3 * time)
    run = sw.simulate(truth, sw.scenario.table(time, command), sample=1.0 / RATE, record=["command", *CHANNELS])
    columns = {"time": run.time, "command": run["command"]}
    columns |= {name: run[name] + NOISE * np.ptp(run[name]) * draw.normal(size=len(run.time)) for name in CHANNELS}
    return sw.Recording(columns, {name: run.unit(name) for name in columns})


def distances(case: Case, draw: Draw) -> dict[str, float]:
    """How many standard deviations each number of a fit that the log tells lies off the truth."""
    truth, free = case(draw)
    with warnings.catch_warnings(action="ignore"):
        found = sw.fit(varied(truth, numbers(truth, free), draw, OFF), log(truth, draw), free)
    true = every(truth)
    told = [each for each in found.estimates if each.path in true and np.isfinite(each.sigma)]
    return {each.path: (each.value - true[each.path].value) / each.sigma for each in told}


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--truths", type=int, default=50, help="of each law (50)")
    parser.add_argument("--only", default="", help="laws whose words hold this")
    wanted = parser.parse_args()
    failed = 0
    for name, case in cases().items():
        if wanted.only not in name:
            continue
        found = [distances(case, np.random.default_rng(seed)) for seed in range(wanted.truths)]
        values = np.array([value for each in found for value in each.values()])
        within, scatter = float(np.mean(np.abs(values) < 2.0)), float(values.std())
        wrong = within < COVERED or not SCATTER[0] <= scatter <= SCATTER[1]
        failed += wrong
        words = f"{100.0 * within:5.1f} % within two standard deviations, scatter over stated {scatter:.2f}"
        print(f"{name:44} {words}{'  FAILS' if wrong else ''}", flush=True)
    return int(failed > 0)


if __name__ == "__main__":
    sys.exit(main())
