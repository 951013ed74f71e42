"""What every model captures and what it costs: alone, and in a drive.

    python benchmarks/models.py                     a table of all models, in Markdown
    python benchmarks/models.py --family friction   those of one family
    python benchmarks/models.py --json table.json   the same numbers, to a file

All models that the package has are measured. *Law*: time of one evaluation along a path of 100 000 points, all in one call.
*Drive*: time of a step of 0.2 ms of a drive of which this is the only part that is not the simplest, run for one second of
ramp and reversals. *Ratio*: to the drive of the simplest parts. All are the shortest of many runs, in rounds over all models.
Set STRAINWAVE_KERNELS=off: else the drives that run longest compile a kernel, and are compared with others that have none.
*State*: what a step hands on to the next, as compiled for one gear in double precision.
"""

from __future__ import annotations

import argparse
import json
import os
import platform
import time
import warnings
from collections.abc import Callable, Iterator, Mapping
from dataclasses import asdict, dataclass
from importlib import metadata
from pathlib import Path
from typing import Any

import numpy as np
import strainwave as sw
from numpy.typing import NDArray
from strainwave import _core

Array = NDArray[np.float64]

POINTS = 100_000  # of the path that a law follows
STEP, DURATION = 2e-4, 1.0  # s, of the drive
ROUNDS = 8  # over all models: a busy minute of the machine spoils one of them only
LAW_RUNS, DRIVE_RUNS = 5, 15  # of each model in each round
DOUBLE = 8  # bytes

LUGRE = sw.friction.LuGre(
    coulomb=0.03, breakaway=0.045, stribeck_speed=2.0, bristle_stiffness=50.0, bristle_damping=5e-5, viscous=5e-5
)
SLIP = 5e-5 * 1.6 ** np.arange(16)  # twist at which each element slips [rad]


def elements(n: int) -> dict[str, Any]:
    """Maxwell elements that together are a quarter as stiff as the spring."""
    return {"stiffness": np.full(n, 3e3 / n), "breakaway": 3e3 / n * SLIP[:n]}


def harmonics(n: int) -> dict[str, Any]:
    """Harmonics that fall with their order."""
    order = np.arange(1, n + 1)
    return {"order": order, "amplitude": 2e-4 / order**2, "phase": np.zeros(n)}


def chart(n: int) -> dict[str, Any]:
    """Deviations of both splines that fall with their order."""
    amplitude, phase = 4e-6 / np.arange(1, n + 1), np.zeros(n)
    return {
        f"{spline}_{what}": numbers
        for spline in ("flexspline", "circular_spline")
        for what, numbers in (("amplitude", amplitude), ("phase", phase))
    }


# Numbers in the size of the drive, by the names of models, for those whose defaults do nothing or suit another gear; sequences
# also in several lengths.
SUITED: dict[str, list[dict[str, Any]]] = {
    "fourier": [harmonics(1), harmonics(4), harmonics(16)],
    "misalignment": [{"housing_eccentricity": 2e-5, "combine": "max"}],
    "tooth_errors": [chart(2), chart(16)],
    "stochastic": [{"amplitude": 2e-5}],
    "viscous": [{"viscous": 5e-5}],
    "coulomb": [{"coulomb": 0.03, "breakaway": 0.045, "viscous": 5e-5}],
    "position_dependent": [{"cosine": [5e-3, 2e-3], "sine": [1e-3, 1e-3], "outside": "clamp"}],
    "maxwell_slip_friction": [
        {"stiffness": np.full(n, 50.0 / n), "share": np.arange(1.0, n + 1.0), "breakaway": 0.045} for n in (1, 4, 8)
    ],
    "load_dependent": [{f"{way}_{sense}": 0.2 for way in ("driving", "backdriving") for sense in ("forward", "reverse")}],
    "cyclic": [{"law": LUGRE, "order": [1, 2], "amplitude": [0.2, 0.2], "phase": [0, 0]}],
    "thermal": [{"law": LUGRE, "dry_fall": 0.01, "viscous_fall": 0.02}],
    "asymmetric": [{"law": LUGRE, "dry_asymmetry": 0.1, "viscous_asymmetry": 0.1}],
    "angle_speed_map": [{"speed": np.geomspace(0.1, 100.0, 4), "level": np.full(48, 0.03)}],
    "linear": [{"k": 1.2e4}],
    "piecewise": [{"k1": 1.2e4, "k2": 6e3}],
    "three_segment": [{"k1": 1.2e4, "k2": 1.8e4, "k3": 2.1e4, "t1": 10.0, "t2": 40.0}],
    "cubic": [{"a1": 1.2e4, "a3": 1e9}],
    "backlash": [{"law": sw.stiffness.Cubic(a1=1.2e4, a3=1e9), "clearance": 1e-4}],
    "power_density": [{"limit": 2e-3, "saturation": 3.0, "exponent": 3.0}],
    "grid_density": [{"limit": 2e-3, "weight": np.full(n * (n + 1) // 2, 6.0 / (n * (n + 1)))} for n in (4, 10)],
    "maxwell_slip": [elements(4), elements(8), elements(16)],
    "fading_memory": [
        {"stiffness": np.full(n, 3e3 / n), "forgetting": np.geomspace(1e3, 1e4, n) if n > 1 else [2e3]} for n in (1, 4, 8)
    ],
    "bouc_wen": [{"stiffness": 3e3, "saturation": 1.5, "sharpness": n} for n in (1.0, 2.0, 3.5)],
    "preisach": [{"density": sw.hysteresis.PowerDensity(limit=2e-3, saturation=3.0, exponent=3.0)}],
    "regimes": [  # of document T, at the output of a gear of 1:100
        {
            "positive_unloading": 4.51e4,
            "negative_loading": 3.1e3,
            "negative_unloading": 4.85e4,
            "positive_loading": 3.0e3,
            "onset": 3.0,
            "lost_motion": 0.0088,
        }
    ],
    "mixed_lubrication": [{"coulomb": 0.02, "breakaway": 0.045, "stribeck_speed": 2.0, "viscosity_fall": 0.03}],
    "brushless_dc": [{"resistance": 0.5, "inductance": 5e-4, "torque_constant": 0.1, "inertia": 1e-4}],
    "pmsm": [{"flux_linkage": 0.0167, "inertia": 1e-4}],
    "torque_source": [{"inertia": 1e-4}],
    "acceleration_source": [{"inertia": 1e-4}],
    "current_source": [{"torque_constant": 0.1, "inertia": 1e-4}],
    "lead_lag": [{"gain": 2.0, "lead_numerator": 0.02, "lead_denominator": 0.002}],
    "state_feedback": [{"input_angle": 2.0, "input_speed": 0.05}],
    "state_space": [  # as many states as the regulator of a joint by its input encoder has
        {
            "A": [-20.0 if row == column else 1.0 for row in range(5) for column in range(5)],
            "B": [1.0] * 5,
            "C": [0.1] * 5,
            "D": [2.0],
            "tracking": [1.0] * 5,
        }
    ],
    "torsion_spring": [{"inertia": 0.5, "stiffness": 10.0}],
    "aerodynamic": [{"inertia": 0.5, "airspeed": 20.0}],
    "torque_table": [{"inertia": 0.5, "angle": [-1.0, 0.0, 1.0], "held_torque": [-1.0, 0.0, 2.0]}],
    "brake": [{"inertia": 0.5}],
    "delayed": [{"delay": 2e-3}],
    "noisy": [{"amplitude": 1e-5, "bandwidth": 500.0}],
    "quantised": [{"resolution": 1e-3}],
    "thermal_softening": [{"stiffness_fall": 3e-4}],
    "sampled": [{"law": sw.control.PID(proportional=2.0, derivative=0.05, limit=48.0)}],
    "periodic": [{"order": [2], "amplitude": [0.05], "phase": [0.0]}],
    "lost_motion_map": [{"angle": [0.0, 1.0], "forward": [1e-4, 2e-4], "backward": [-1e-4, -2e-4]}],
    "adaptive_fourier": [{"order": [1, 2]}],
    "twist_identification": [{"order": [1, 2]}],
}

SIMPLEST = sw.Drive(
    gear=sw.Gear(
        kinematics=sw.kinematics.StrainWave(),
        stiffness=sw.stiffness.Linear(k=1.2e4),
        damping=10.0,
        input_inertia=1e-5,
        friction_input=sw.friction.Viscous(viscous=5e-5),
        friction_output=sw.friction.Viscous(viscous=0.5),
    ),
    motor=sw.motor.DC(resistance=0.5, inductance=5e-4, torque_constant=0.1, back_emf=0.1, inertia=1e-4),
    control=sw.control.PID(proportional=2.0, derivative=0.05, limit=48.0),
    load=sw.loads.Inertia(inertia=0.5),
)
COMMAND = sw.scenario.ramp(0.3, DURATION) + sw.scenario.sine(0.2, 2.0, DURATION)


@dataclass(frozen=True)
class Cost:
    """A model, what it says or shows of itself, and what it costs; what it has not is None."""

    family: str
    model: str
    captures: tuple[str, ...]
    state: int  # bytes
    law: float | None  # s an evaluation
    drive: float  # s a step
    ratio: float  # to the drive of the simplest parts


# ---- The models ------------------------------------------------------------------------------------------------------


def models() -> Iterator[tuple[str, Any]]:
    """Family and model, of all that the package has, with numbers that make it do something."""
    for family, kinds in _core.families.items():
        for name, kind in kinds.items():
            for numbers in SUITED.get(name, [{}]):
                yield family, filled(usual(kind, numbers))


def usual(kind: type[Any], numbers: Mapping[str, Any]) -> Any:
    """A model of these numbers, the others of the order of magnitude that the package knows."""
    return kind(**({field["name"]: field["default"] for field in kind.fields} | dict(numbers)))


def filled(model: Any) -> Any:
    """The same; raises ValueError for one that lacks elements, whose cost would say nothing."""
    for field in model.fields:
        if field["kind"] == "sequence" and not getattr(model, field["name"]):
            raise ValueError(f"{model.name}.{field['name']} is empty; write numbers for it into SUITED")
    return model


def title(model: Any) -> str:
    """The class, and what distinguishes several of it."""
    sequences = [len(getattr(model, field["name"])) for field in model.fields if field["kind"] == "sequence"]
    if hasattr(model, "sharpness"):
        return f"{type(model).__name__}, sharpness {model.sharpness:g}"
    if hasattr(model, "law"):
        return f"{type(model).__name__} of {type(model.law).__name__}"
    several = len(SUITED.get(model.name, [])) > 1 and sequences
    return f"{type(model).__name__}, {max(sequences)}" if several else type(model).__name__


def placed(whole: Any, model: Any, within: tuple[type, ...] = ()) -> Any | None:
    """A drive, or a part of one, with the model at the first place that takes it; None if no place does."""
    fields = [field for field in whole.fields if field["kind"] == "part"]
    for field in fields:
        if type(model) in (field["options"] or {}).values():
            return whole.replace(**{field["name"]: model})
    for field in fields:
        kinds = [type(getattr(whole, field["name"]))] if not field["options"] else field["options"].values()
        for kind in kinds:
            if kind in within:
                continue
            part = getattr(whole, field["name"]) if not field["options"] else usual(kind, SUITED.get(kind.name, [{}])[0])
            found = placed(part, model, (*within, kind))
            if found is not None:
                return whole.replace(**{field["name"]: found})
    return None


def acting(drive: Any, model: Any) -> Any:
    """The part of a drive's gear that works with the model: the model itself, or what it is a part of."""
    for field in drive.gear.fields:
        part = getattr(drive.gear, field["name"])
        if part == model:
            return model
        if hasattr(part, "fields") and any(getattr(part, inner["name"]) == model for inner in part.fields):
            return part
    return model


# ---- What they capture -----------------------------------------------------------------------------------------------


def captures(model: Any) -> tuple[str, ...]:
    """What a model says of itself, and what it shows when it is asked."""
    return tuple(word for word, shown in PROBES.items() if shown(model))


def differs(verb: str, *arguments: float, **changed: float) -> Callable[[Any], bool]:
    """Whether a law that has the verb gives something else where one argument is another."""

    def shown(model: Any) -> bool:
        if not hasattr(model, verb):
            return False
        try:
            return bool(getattr(model, verb)(*arguments, **changed) != getattr(model, verb)(*arguments))
        except TypeError:  # it does not take that argument
            return False

    return shown


def under_load(**changed: float) -> Callable[[Any], bool]:
    """Whether friction changes, under a load of 10 N.m."""
    return lambda model: (
        hasattr(model, "steady") and bool(model.steady(1.0, **({"load": 10.0} | changed)) != model.steady(1.0, load=10.0))
    )


def falls(model: Any) -> bool:
    """Whether friction falls as sliding sets in."""
    return hasattr(model, "steady") and bool(model.steady(1e-6, load=10.0) > model.steady(1.0, load=10.0) > 0.0)


def slides_elastically(model: Any) -> bool:
    """Whether friction grows with the way rather than being there at once, at a speed too small for viscosity."""
    if not hasattr(model, "hold") or model.set_valued or not hasattr(model, "State"):
        return False
    start, long = model.trace([0.0, 1e-6, 2e3], [1e-6, 1e-6, 1e-6], load=10.0)[1:], model.steady(1e-6, load=10.0)
    return bool(abs(start[0]) < 0.5 * abs(long))


def slopes(model: Any) -> Array | None:
    """Stiffness over the twist up to 40 N.m."""
    return model.tangent(np.linspace(0.0, float(model.twist(40.0)), 4001)) if hasattr(model, "tangent") else None


def hardens(model: Any) -> bool:
    found = slopes(model)
    return found is not None and bool(found[-1] > found[0])


def hardens_smoothly(model: Any) -> bool:
    found = slopes(model)
    return found is not None and hardens(model) and bool(np.max(np.abs(np.diff(found))) < 0.01 * np.ptp(found))


def says(claim: str) -> Callable[[Any], bool]:
    return lambda model: bool(getattr(model, claim, False))


PROBES: dict[str, Callable[[Any], bool]] = {
    "rise with speed": lambda model: hasattr(model, "steady") and model.steady(20.0, load=10.0) > model.steady(10.0, load=10.0),
    "fall at low speed": falls,
    "angle": under_load(angle=1.0),
    "load": lambda model: under_load(load=20.0)(model) or differs("error", 0.3, torque=10.0)(model),
    "temperature": under_load(temperature=313.15),
    "sticks": lambda model: hasattr(model, "hold") and model.set_valued,
    "presliding": slides_elastically,
    "hardens": hardens,
    "smooth": hardens_smoothly,
    "minor loops close": says("return_point_memory"),
    "congruent": says("congruent"),
    "Masing": says("masing"),
    "asymmetric if so set": lambda model: hasattr(model, "masing") and not model.odd,
    "energy held": lambda model: hasattr(model, "stored"),
    "exact inverse": lambda model: hasattr(model, "inverse"),
}


# ---- What they cost --------------------------------------------------------------------------------------------------


def state(model: Any) -> int:
    """Bytes that a step hands on to the next."""
    if not hasattr(model, "State"):
        return 0
    held = model.State()
    return DOUBLE * sum(np.size(getattr(held, field["name"])) for field in held.fields)


def path() -> tuple[Array, Array]:
    """Time [s], and a signal of size 1 with reversals of many sizes."""
    times = np.linspace(0.0, 100.0, POINTS)
    return times, 0.6 * np.sin(times) + 0.4 * np.sin(np.sqrt(5.0) * np.pi * times)


def evaluation(model: Any) -> Callable[[], Array] | None:
    """One call of the law along the path, as its kind is asked."""
    times, signal = path()
    if hasattr(model, "steady"):
        return lambda: model.trace(times, 5.0 * signal, load=10.0)
    if hasattr(model, "work"):
        return lambda: model.trace(2e-3 * signal)
    if hasattr(model, "tangent"):
        return lambda: model.torque(2e-3 * signal)
    if hasattr(model, "error"):
        return lambda: model.error(100.0 * signal)
    return None


def seconds(call: Callable[[], object]) -> float:
    start = time.perf_counter()
    call()
    return time.perf_counter() - start


def shortest(call: Callable[[], object], runs: int) -> float:
    return min(seconds(call) for _ in range(runs))


def run(drive: Any) -> sw.Recording:
    return sw.simulate(drive, COMMAND, STEP, sample=1e-3)


@dataclass
class Subject:
    """A model in its place, and the shortest times of it so far [s]: of an evaluation, and of a step of the drive."""

    family: str
    model: Any
    drive: Any
    law: float = np.inf
    step: float = np.inf

    @classmethod
    def of(cls, family: str, model: Any) -> Subject:
        drive = placed(SIMPLEST, model)
        if drive is None:
            raise ValueError(f"no part of a drive takes {model!r}")
        return cls(family, model, drive)

    def measure(self) -> None:
        """One round more."""
        if call := evaluation(acting(self.drive, self.model)):
            self.law = min(self.law, shortest(call, LAW_RUNS) / POINTS)
        self.step = min(self.step, shortest(lambda: run(self.drive), DRIVE_RUNS) / round(DURATION / STEP))

    def cost(self, simplest: float) -> Cost:
        part = acting(self.drive, self.model)
        law = self.law if np.isfinite(self.law) else None
        return Cost(self.family, title(self.model), captures(part), state(part), law, self.step, self.step / simplest)


def measured(subjects: list[Subject]) -> list[Cost]:
    """The costs of all, in rounds."""
    simplest = Subject("", None, SIMPLEST)
    for _ in range(ROUNDS):
        for subject in (simplest, *subjects):
            subject.measure()
    return [subject.cost(simplest.step) for subject in subjects]


# ---- The table -------------------------------------------------------------------------------------------------------


def table(costs: list[Cost]) -> str:
    """All of it, in Markdown."""
    lines = [
        "| family | model | captures | state [B] | law [ns] | drive [µs/step] | ratio |",
        "|---|---|---|---:|---:|---:|---:|",
    ]
    for cost in costs:
        law = "—" if cost.law is None else f"{1e9 * cost.law:.1f}"
        what = ", ".join(cost.captures) or "—"
        cells = (cost.family, cost.model, what, str(cost.state), law, f"{1e6 * cost.drive:.2f}", f"{cost.ratio:.2f}")
        lines.append("| " + " | ".join(cells) + " |")
    return "\n".join(lines)


def machine() -> dict[str, Any]:
    """What the numbers depend on."""
    versions = {name: metadata.version(name) for name in ("strainwave", "numpy")}
    return {"architecture": platform.machine(), "cores": os.cpu_count(), "python": platform.python_version(), **versions}


def main() -> None:
    """The command line."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--family", choices=sorted(_core.families), help="measure one family")
    parser.add_argument("--json", type=Path, metavar="FILE", help="write the numbers to this file too")
    options = parser.parse_args()
    warnings.simplefilter("ignore", sw.PassivityWarning)  # of friction whose slip lags; it is measured as it is
    run(SIMPLEST)  # the first run imports what the later ones need
    costs = measured([Subject.of(family, model) for family, model in models() if options.family in (None, family)])
    print(table(costs))
    print("\n" + ", ".join(f"{name} {value}" for name, value in machine().items()))
    if options.json:
        options.json.write_text(json.dumps({"machine": machine(), "models": [asdict(cost) for cost in costs]}, indent=1))


if __name__ == "__main__":
    main()
