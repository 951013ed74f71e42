"""How well each model describes what was measured: fitted here, judged where it was not fitted.

    python benchmarks/fidelity.py                      on what comes with the package
    python benchmarks/fidelity.py --data FOLDER        also on measurements of others, in the folders of FOLDER that exist

cycloidal-loops   torsion loops of printed cycloidal gears (JelmerV, Anti-Backlash-Cycloidal-Actuator, CC BY-SA 4.0)
emps              a ball-screw axis in closed loop (Janot, Gautier & Brunot 2019)
cobot-temperature joint currents and temperatures of a UR3 (UCI 963, CC BY 4.0)
erob-friction     friction laws of a joint module with a strain wave gear, as identified by others (Rhoban, BAM, Apache-2.0)

Of loops every fourth of twenty blocks is kept back and only predicted. The tables are Markdown. No measured loop of a strain
wave gear is public that we know of.
"""

from __future__ import annotations

import argparse
import csv
import json
import warnings
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from itertools import product
from pathlib import Path
from typing import Any

import numpy as np
import strainwave as sw
from inverse_dynamics import regression
from numpy.typing import NDArray
from strainwave.identification.candidates.torsion import fit_loop, held_out_blocks
from strainwave.identification.experiments.friction_table import FrictionTable
from strainwave.identification.experiments.torsion_loop import TorsionLoop

Array = NDArray[np.float64]

PUBLISHED = Path(sw.__file__).with_name("published")
LOOPS = (
    "Baseline_ax0_line0_d62728",
    "Baseline_ax1_line0_d62728",
    "Conic_Disk_ax0_line2_3b528b",
    "Conic_Disk_ax1_line1_440154",
    "Split_Pinwheel_ax0_line0_d62728",
    "Split_Pinwheel_ax1_line4_5ec962",
)
NONE = sw.hysteresis.MaxwellSlip()


@dataclass(frozen=True)
class Score:
    """A model on one measurement: how many numbers were fitted, and its rms errors relative to `of` of the measurement."""

    model: str
    numbers: int
    fitted: float
    held_out_blocks: float


# ---- Torsion loops ---------------------------------------------------------------------------------------------------


def torsion_scores(loop: TorsionLoop, spring: Any) -> list[Score]:
    """All kinds of hysteresis in parallel with one kind of spring; errors relative to the span of the torque."""
    training = held_out_blocks(len(loop.twist))
    half, span = 0.5 * float(np.ptp(loop.twist)), float(np.ptp(loop.torque))
    secant = 0.5 * span / half
    spring = spring.replace(**{spring.fields[0]["name"]: 0.5 * secant})
    scores = [best_fit(name, spring, starts, loop, training) for name, starts in hysteresis_starts(half, span, secant).items()]
    chosen = fit_loop(loop, sw.Gear(), training)[0]
    scores.append(Score(f"MaxwellSlip, chosen by identify: {chosen.name}", len(chosen.fit.estimates), *errors(chosen.fit)))
    scores += [grid_score(loop, spring, rows, training) for rows in (4, 7, 10)]
    return [Score(s.model, s.numbers, s.fitted / span, s.held_out_blocks / span) for s in scores]


def hysteresis_starts(half: float, span: float, secant: float) -> dict[str, list[Any]]:
    """Where fits start, by the name of what is fitted; half the span of the twist, span of the torque, their quotient."""
    h = sw.hysteresis
    rates = np.array([1.0, 4.0, 15.0, 60.0]) / half
    slips = {n: half * np.geomspace(0.02, 0.8, n) for n in (4, 8)}
    return {
        "none": [NONE],
        "FadingMemory, 1": [h.FadingMemory(stiffness=[secant], forgetting=[rate]) for rate in rates],
        "FadingMemory, 2": [
            h.FadingMemory(stiffness=[secant, secant], forgetting=[slow, fast])
            for i, slow in enumerate(rates)
            for fast in rates[i + 1 :]
        ],
        "BoucWen": [
            h.BoucWen(stiffness=k * secant, saturation=share * span, sharpness=sharpness, shape=0.7)
            for k in (1.0, 4.0)
            for share in (0.05, 0.2)
            for sharpness in (1.2, 3.0)
        ],
        "MaxwellSlip, 4": [h.MaxwellSlip(stiffness=4 * [secant / 4], breakaway=(secant / 4 * slips[4]).tolist())],
        "MaxwellSlip, 8": [h.MaxwellSlip(stiffness=8 * [secant / 8], breakaway=(secant / 8 * slips[8]).tolist())],
        "Preisach of PowerDensity": [
            h.Preisach(density=h.PowerDensity(limit=reach * half, saturation=0.3 * span, exponent=exponent))
            for reach in (0.6, 1.0, 3.0)
            for exponent in (2.0, 5.0)
        ],
        "Regimes, no other spring": [
            h.Regimes(
                positive_unloading=unloading * secant,
                negative_unloading=unloading * secant,
                positive_loading=loading * secant,
                negative_loading=loading * secant,
                onset=onset * span,
                lost_motion=width * half,
            )
            for unloading, loading, onset, width in product((2.0, 4.0, 8.0), (0.3, 0.7), (0.02, 0.1), (0.2, 0.8, 1.6))
        ],
    }


def best_fit(name: str, spring: Any, starts: Sequence[Any], loop: TorsionLoop, training: NDArray[np.bool_]) -> Score:
    """The best on the training samples of the fits that start from each."""
    fits = []
    for start in starts:
        whole = isinstance(start, sw.hysteresis.Regimes)
        gear = sw.Gear(stiffness=sw.stiffness.Linear(k=1e-6) if whole else spring, hysteresis=start)
        free = [] if whole else [f"stiffness.{field['name']}" for field in spring.fields]
        free += paths("hysteresis", start)
        fits.append(fit(gear, loop, free, training))
    numbers, fitted, kept = min(fits, key=lambda found: found[1])
    return Score(name, numbers, fitted, kept)


def spring_scores(loop: TorsionLoop) -> list[Score]:
    """All kinds of spring, in parallel with four Maxwell elements; errors relative to the span of the torque."""
    training = held_out_blocks(len(loop.twist))
    half, span = 0.5 * float(np.ptp(loop.twist)), float(np.ptp(loop.torque))
    secant = 0.5 * span / half
    st, soft = sw.stiffness, 0.5 * secant
    springs: dict[str, Any] = {
        "Linear": st.Linear(k=soft),
        "Piecewise": st.Piecewise(k1=soft, k2=soft, knee=0.5 * half),
        "ThreeSegment": st.ThreeSegment(k1=soft, k2=1.2 * soft, k3=1.5 * soft, t1=0.1 * span, t2=0.25 * span),
        "Cubic": st.Cubic(a1=soft, a3=soft / half**2),
        "MultiCompliance": st.MultiCompliance(
            flexspline_stiffness=2.0 * soft,
            flexspline_hardening=0.5 / span,
            wave_generator_stiffness=2.0 * soft,
            wave_generator_hardening=0.5 / span,
            reduction=1.0,
        ),
    }
    elements = hysteresis_starts(half, span, secant)["MaxwellSlip, 4"][0]
    scores = []
    for name, spring in springs.items():
        free = [path for path in paths("stiffness", spring) + paths("hysteresis", elements) if "reduction" not in path]
        numbers, fitted, kept = fit(sw.Gear(stiffness=spring, hysteresis=elements), loop, free, training)
        scores.append(Score(name, numbers, fitted / span, kept / span))
    return scores


def fit(gear: sw.Gear, loop: TorsionLoop, free: Sequence[str], training: NDArray[np.bool_]) -> tuple[int, float, float]:
    """How many numbers, and both errors."""
    found = sw.fit(gear, loop, free, training=training)
    return len(found.estimates), *errors(found)


def paths(place: str, part: Any) -> list[str]:
    """Of all numbers of a part."""
    found = []
    for field in part.fields:
        value = getattr(part, field["name"])
        if hasattr(value, "fields"):
            found += paths(f"{place}.{field['name']}", value)
        elif np.size(value):
            found.append(f"{place}.{field['name']}")
    return found


def errors(found: Any) -> tuple[float, float]:
    return float(found.rms()[0]), float(found.rms(held_out=True)[0])


def grid_score(loop: TorsionLoop, spring: Any, rows: int, training: NDArray[np.bool_]) -> Score:
    """Preisach's hysteresis with a density in cells: linear in its weights, so the best is found without a start."""
    from scipy.optimize import nnls

    path, half = loop.path(loop.middle), 0.5 * float(np.ptp(loop.twist))
    cells = np.eye(rows * (rows + 1) // 2)
    density = [sw.hysteresis.GridDensity(limit=half, weight=cell.tolist()) for cell in cells]
    plays = [sw.hysteresis.Preisach(density=each).trace(path)[-len(loop.twist) :] for each in density]
    x = (loop.twist - loop.middle) / half
    springs = [x, x**3] if isinstance(spring, sw.stiffness.Cubic) else [x]
    columns = np.column_stack([*plays, *springs, np.ones_like(x), -np.ones_like(x)])
    weights, _ = nnls(columns[training], loop.torque[training])
    residual = loop.torque - columns @ weights
    fitted, kept = (float(np.sqrt(np.mean(residual[chosen] ** 2))) for chosen in (training, ~training))
    return Score(f"Preisach of GridDensity, {rows} rows", len(cells) + len(springs) + 1, fitted, kept)


def published_loop() -> TorsionLoop:
    """Document T's loop, at the input of its gear of 1:100."""
    recording = sw.Recording.from_csv(PUBLISHED / "torsional-stiffness-loop.csv")
    return TorsionLoop(recording.values("input_angle", "rad").copy(), recording.values("input_torque", "N.m").copy())


def measured_loops(folder: Path) -> Iterator[TorsionLoop]:
    columns = {"twist": "deflection_deg", "torque": "motor_torque_output_side_Nm"}
    for name in LOOPS:
        file = folder / f"torque-displacement_of_{name}.csv"
        yield TorsionLoop.of(sw.Recording.from_csv(file, columns=columns, units={"twist": "deg", "torque": "N.m"}), sw.Gear())


# ---- Friction --------------------------------------------------------------------------------------------------------

Law = Callable[[Array], Any]  # numbers -> what predicts


def least_squares(
    predict: Callable[[Array], Array],
    measured: Array,
    starts: Sequence[Array],
    training: NDArray[np.bool_] | slice = slice(None),
) -> Array:
    """Non-negative numbers that predict the measured best, from the best of several starts; each scaled by its start."""
    from scipy.optimize import least_squares as solve

    def residual(x: Array, start: Array) -> Array:
        return (predict(x * start) - measured)[training]

    found = [solve(residual, np.ones_like(start), bounds=(0.0, np.inf), args=(start,)) for start in starts]
    best = min(range(len(starts)), key=lambda i: float(found[i].cost))
    return np.asarray(found[best].x * starts[best])


def listed(numbers: Array) -> str:
    return ", ".join(f"{number:.4g}" for number in numbers)


def rms(values: Array) -> float:
    return float(np.sqrt(np.mean(values**2)))


LAWS: dict[str, tuple[Law, list[list[float]]]] = {  # by friction at full speed and the speed: what is fitted, and its starts
    "Viscous": (lambda x: sw.friction.Viscous(viscous=x[0]), [[1.0]]),
    "Coulomb": (lambda x: sw.friction.Coulomb(coulomb=x[0], breakaway=x[0], viscous=x[1]), [[0.5, 0.5]]),
    "Stribeck": (
        lambda x: sw.friction.Stribeck(coulomb=x[0], breakaway=x[0] + x[2], stribeck_speed=x[3], viscous=x[1]),
        [[0.5, 0.5, 0.2, speed] for speed in (0.02, 0.1, 0.3)],
    ),
}


def table_scores(table: FrictionTable) -> list[Score]:
    """Laws of speed on a table of torques at constant speeds; what is kept back is one speed after the other."""
    top, fast = float(np.abs(table.torque).max()), float(np.abs(table.speed).max())
    scores = []
    for name, (law, starts) in LAWS.items():
        if len(starts[0]) >= len(table.speed) - 1:
            continue  # with one speed kept back nothing would be left to judge the fit by
        units = [top, top / fast, top, fast][: len(starts[0])] if name != "Viscous" else [top / fast]
        scaled = [np.array(start) * units for start in starts]

        def residual(part: NDArray[np.bool_], at: NDArray[np.bool_], law: Law = law, scaled: list[Array] = scaled) -> Array:
            x = least_squares(lambda numbers: law(numbers).steady(table.speed[part]), table.torque[part], scaled)
            return np.asarray(table.torque[at] - law(x).steady(table.speed[at]))

        every = np.ones(len(table.speed), bool)
        left_out = np.eye(len(table.speed), dtype=bool)
        kept = np.concatenate([residual(~one, one) for one in left_out])
        scores.append(Score(name, len(starts[0]), rms(residual(every, every)) / top, rms(kept) / top))
    return scores


def axis_scores(folder: Path) -> list[Score]:
    """Laws of speed and presliding beside the inertia of the ball-screw axis: fitted to the first record, tried on the second.

    Forces in N. The same filter acts on both sides; stops are left out, as the positions do not show what happens there.
    """
    from scipy.io import loadmat
    from scipy.signal import butter, sosfiltfilt

    records = []
    cutoff: float | None = None
    for file in ("DATA_EMPS.mat", "DATA_EMPS_PULSES.mat"):
        data = {key: np.asarray(value, float).ravel() for key, value in loadmat(folder / file).items() if key[0] != "_"}
        time, position, force = data["t"], data["qm"], data["gtau"][0] * data["vir"]
        rows = regression(position, force, time, cutoff=cutoff)
        cutoff = rows.cutoff
        smooth = sosfiltfilt(butter(4, cutoff, fs=1.0 / (time[1] - time[0]), output="sos"), position)
        records.append((time, position, np.gradient(smooth, time), rows))
    fast = float(np.abs(records[0][2]).max())

    def predict(law: Any, x: Array, record: Any) -> Array:
        time, position, speed, rows = record
        friction = regression(position, law.trace(time, speed), time, cutoff=cutoff).torque
        return np.asarray(x[0] * rows.matrix[:, 0] + friction - x[1])

    laws: dict[str, tuple[Law, list[list[float]]]] = {
        "Viscous": (lambda x: sw.friction.Viscous(viscous=x[0]), [[300.0]]),
        "Coulomb": (lambda x: sw.friction.Coulomb(coulomb=x[1], breakaway=x[1], viscous=x[0]), [[200.0, 20.0]]),
        "Stribeck": (
            lambda x: sw.friction.Stribeck(coulomb=x[1], breakaway=x[1] + x[2], stribeck_speed=x[3], viscous=x[0]),
            [[200.0, 20.0, 5.0, share * fast] for share in (0.03, 0.2)],
        ),
        "LuGre": (
            lambda x: sw.friction.LuGre(
                coulomb=x[1],
                breakaway=x[1] + x[2],
                stribeck_speed=x[3],
                bristle_stiffness=x[4],
                bristle_damping=0.0,
                viscous=x[0],
            ),
            [[200.0, 20.0, 5.0, 0.1 * fast, stiffness] for stiffness in (1e4, 1e5, 1e6)],
        ),
        "MaxwellSlipFriction, 2": (
            lambda x: sw.friction.MaxwellSlipFriction(
                stiffness=[x[2] + 1e-9, x[3] + 1e-9],
                share=[1.0, 1.0],
                coulomb=x[1],
                stribeck_speed=2.0,
                attraction=0.3,
                viscous=x[0],
            ),
            [[200.0, 20.0, 1e4, 1e5]],
        ),
    }
    scores = []
    for name, (law, starts) in laws.items():
        scaled = [np.array([95.0, 3.0, *start]) for start in starts]

        def first(n: Array, law: Law = law) -> Array:
            return predict(law(n[2:]), n, records[0])

        x = least_squares(first, records[0][3].torque, scaled)
        own, other = (
            float(np.linalg.norm(record[3].torque - predict(law(x[2:]), x, record)) / np.linalg.norm(record[3].torque))
            for record in records
        )
        scores.append(Score(f"{name}: {listed(x)}", len(x), own, other))
    return scores


def warming_scores(folder: Path) -> list[Score]:
    """Friction of a joint of the UR3 with its temperature, in A of motor current; every fourth of 20 blocks kept back.

    An offset stands for weight and inertia of the wrist, which the record does not tell. Only moving samples.
    """
    with next(folder.glob("*.csv")).open(newline="") as file:
        rows = list(csv.DictReader(file, delimiter=";"))

    def column(name: str) -> Array:
        return np.array([float(row[name].replace(",", ".") or "nan") for row in rows])

    current, speed, celsius = column("Current_J3"), column("Speed_J3"), column("Temperature_J3")
    moving = np.isfinite(current) & np.isfinite(celsius) & (np.abs(speed) > 0.05)
    current, speed, kelvin = current[moving], speed[moving], celsius[moving] + 273.15
    training = held_out_blocks(len(current))
    reference = float(kelvin.mean())
    spread = float(np.std(current[training]))
    laws: dict[str, tuple[Law, list[float]]] = {
        "Coulomb": (lambda x: sw.friction.Coulomb(coulomb=x[0], breakaway=x[0], viscous=x[1]), [0.4, 0.05]),
        "Thermal of Coulomb": (
            lambda x: sw.friction.Thermal(
                law=sw.friction.Coulomb(coulomb=x[0], breakaway=x[0], viscous=x[1]),
                dry_fall=x[2],
                reference_temperature=reference,
            ),
            [0.4, 0.05, 0.02],
        ),
    }
    scores = []
    for name, (law, start) in laws.items():

        def predict(x: Array, law: Law = law) -> Array:
            return np.asarray(law(x[2:]).steady(speed, temperature=kelvin) + x[0] - x[1])

        x = least_squares(predict, current, [np.array([0.5, 0.1, *start])], training)
        residual = current - predict(x)
        fitted, kept = rms(residual[training]), rms(residual[~training])
        scores.append(Score(f"{name}: {listed(x[2:])}", len(x) - 1, fitted / spread, kept / spread))
    return scores


def joint_friction(p: dict[str, Any], speed: Array, load: Array) -> Array:
    """Steady friction [N.m] at the joint by the law identified by others, under a load that resists a positive speed.

    Their law knows the motor's torque, which in steady motion is the load and the friction: found by iteration.
    """
    sense = np.sign(speed)
    fall = np.exp(-(np.abs(speed / p["dtheta_stribeck"]) ** p["alpha"]))
    friction = np.zeros_like(load)
    for _ in range(200):
        motor = load + sense * friction
        level = p["friction_base"] + fall * p["friction_stribeck"]
        level = level + np.abs(-load * p["load_friction_external"] - motor * p["load_friction_motor"])
        level = level + fall * np.abs(-load * p["load_friction_external_stribeck"] - motor * p["load_friction_motor_stribeck"])
        opposed = np.sign(-load) != np.sign(motor)
        driven = (np.abs(load) < np.abs(motor)) * p["load_friction_external_quad"] * load**2
        driving = (np.abs(load) > np.abs(motor)) * p["load_friction_motor_quad"] * motor**2
        friction = 0.5 * friction + 0.5 * (level + fall * opposed * (driven + driving))
    return np.asarray(sense * (friction + p["friction_viscous"] * np.abs(speed)))


def joint_scores(file: Path) -> list[Score]:
    """Laws of speed and load on the friction map of a joint; every fourth load kept back, relative to the greatest friction."""
    identified = json.loads(file.read_text())
    speeds = np.concatenate([s * np.geomspace(0.02, 4.0, 24) for s in (-1.0, 1.0)])
    loads = np.linspace(0.0, 30.0, 25)
    speed, load = (grid.ravel() for grid in np.meshgrid(speeds, loads))
    training = np.repeat(np.arange(len(loads)) % 4 != 3, len(speeds))
    truth = joint_friction(identified, speed, load)
    f = sw.friction

    def stribeck(x: Array) -> Any:
        return f.Stribeck(coulomb=x[0], breakaway=x[0] + x[2], stribeck_speed=x[3], viscous=x[1])

    def quadrants(x: Array) -> Any:
        return f.LoadDependent(driving_forward=x[0], backdriving_reverse=x[1])

    def efficiency(x: Array) -> Any:
        return f.TorqueEfficiency(average_loss=x[0] + abs(x[1] - 1.0), difference_loss=x[1] - 1.0, presliding=0.01)

    own, base = [5.0, 5.0], [4.0, 5.0, 3.0, 1.0]
    laws: dict[str, tuple[Callable[[Array], list[Any]], list[float]]] = {
        "Coulomb": (lambda x: [f.Coulomb(coulomb=x[0], breakaway=x[0], viscous=x[1])], own),
        "Stribeck": (lambda x: [stribeck(x)], base),
        "Coulomb + LoadDependent": (
            lambda x: [f.Coulomb(coulomb=x[0], breakaway=x[0], viscous=x[1]), quadrants(x[2:])],
            [*own, 0.1, 0.1],
        ),
        "Stribeck + LoadDependent": (lambda x: [stribeck(x), quadrants(x[4:])], [*base, 0.1, 0.1]),
        "Stribeck + TorqueEfficiency": (lambda x: [stribeck(x), efficiency(x[4:])], [*base, 0.1, 1.05]),
    }
    scores = []
    for name, (parts, start) in laws.items():

        def predict(x: Array, parts: Callable[[Array], list[Any]] = parts) -> Array:
            return np.sum([part.steady(speed, load=load) for part in parts(x)], axis=0)  # type: ignore[no-any-return]

        x = least_squares(predict, truth, [np.array(start)], training)
        residual, top = truth - predict(x), float(np.abs(truth).max())
        scores.append(Score(name, len(x), rms(residual[training]) / top, rms(residual[~training]) / top))
    return scores


# ---- The tables ------------------------------------------------------------------------------------------------------


def table(title: str, scores: Sequence[Score]) -> str:
    lines = [f"\n### {title}\n", "| model | numbers | fitted [%] | kept back [%] |", "|---|---:|---:|---:|"]
    lines += [f"| {s.model} | {s.numbers} | {100 * s.fitted:.2f} | {100 * s.held_out_blocks:.2f} |" for s in scores]
    return "\n".join(lines)


def loops_table(title: str, several: Sequence[Sequence[Score]]) -> str:
    """Error kept back on each loop, and the median of both errors."""
    heading = "| model | numbers | fitted, median [%] | kept back, median [%] | kept back, each [%] |"
    lines = [f"\n### {title}\n", heading, "|---|---:|---:|---:|---|"]
    for same in zip(*several, strict=True):
        fitted, kept = (100 * np.array([getattr(score, name) for score in same]) for name in ("fitted", "held_out_blocks"))
        name = same[0].model.partition(":")[0]
        numbers = sorted({score.numbers for score in same})
        count = f"{numbers[0]}" if len(numbers) == 1 else f"{numbers[0]} to {numbers[-1]}"
        each = ", ".join(f"{value:.2f}" for value in kept)
        lines.append(f"| {name} | {count} | {np.median(fitted):.2f} | {np.median(kept):.2f} | {each} |")
    return "\n".join(lines)


def main() -> None:
    """The command line."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--data", type=Path, metavar="FOLDER", help="folder of the measurements of others")
    options = parser.parse_args()
    warnings.simplefilter("ignore", sw.PassivityWarning)  # a fit tries what it likes
    print(table("Document T's loop, % of the span of the torque", torsion_scores(published_loop(), sw.stiffness.Linear(k=1e4))))
    friction = FrictionTable.of(sw.Recording.from_csv(PUBLISHED / "position-control-friction.csv"))
    print(table("Document P's Table 2, % of its greatest torque", table_scores(friction)))
    for folder, tell in OTHERS.items():
        if options.data is None or not (options.data / folder).is_dir():
            print(f"\n{folder}: not given, see --data")
        else:
            print(tell(options.data / folder))


def loops(folder: Path) -> str:
    measured = list(measured_loops(folder))
    title = "Six loops of printed cycloidal gears, % of the span of the torque"
    tables = (
        loops_table(
            f"{title}: hysteresis beside a cubic spring", [torsion_scores(one, sw.stiffness.Cubic(a1=1e4)) for one in measured]
        ),
        loops_table(f"{title}: springs beside MaxwellSlip, 4", [spring_scores(one) for one in measured]),
    )
    return "\n".join(tables)


def joints(folder: Path) -> str:
    title = "Friction map of {} as identified by others, % of the greatest friction"
    tables = (table(title.format(name), joint_scores(folder / f"{name}_m6.json")) for name in ("erob80_50", "erob80_100"))
    return "\n".join(tables)


OTHERS: dict[str, Callable[[Path], str]] = {
    "cycloidal-loops": loops,
    "emps": lambda folder: table("Ball-screw axis, % of the force; kept back is the second record", axis_scores(folder)),
    "cobot-temperature": lambda folder: table("Joint of a UR3, % of the spread of the current", warming_scores(folder)),
    "erob-friction": joints,
}


if __name__ == "__main__":
    main()
