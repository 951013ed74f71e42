"""Every kind of spring and hysteresis on loops whose truth is known: `python -m tests.evidence.loops --truths 50`.

Of each truth, drawn at random, a path with minor loops makes a torsion loop with noise of 1 % of the torque. A fit of the same
kinds, which knows nothing of the truth, must hold each number within two standard deviations in 90 % of the cases; scatter over
stated standard deviation must lie between 0.7 and 1.4.

Of two springs in series a loop tells the sum of their twists alone: for `MultiCompliance` the torque at a quarter, half, three
quarters and the whole of the twist stand in place of its numbers.
"""

from __future__ import annotations

import argparse
import sys
import warnings
from collections.abc import Callable
from typing import Any

import numpy as np
import strainwave as sw
from numpy.typing import NDArray
from strainwave.identification.candidates.torsion.candidate import candidate
from strainwave.identification.candidates.torsion.dissipation import (
    BoucWen,
    Dissipation,
    Elements,
    FadingMemory,
    FrictionalWindup,
    Preisach,
    Regimes,
    Without,
)
from strainwave.identification.candidates.torsion.springs import PLAIN_SPRINGS, Backlash, Negligible, SpringKind
from strainwave.identification.experiments.torsion_loop import TorsionLoop
from strainwave.identification.fitting.fit import Fit
from strainwave.parameters import every

Array = NDArray[np.float64]
HALF, TORQUE, RATIO = 1.5e-3, 40.0, 100.0  # rad, N.m, 1: of a gear of size 25
SAMPLES, NOISE = 1000, 0.01
COVERED, SCATTER = 0.90, (0.7, 1.4)
Draw = np.random.Generator


def path() -> Array:
    """Twist [rad] of a test with minor loops, which tell what large ones do not."""
    ends = HALF * np.array([0.0, 1.0, -1.0, 0.6, -0.3, 0.4, -0.6, 0.9, 0.5, 0.8, -1.0, -0.6, -0.85, 0.0])
    travelled = np.concatenate(([0.0], np.cumsum(np.abs(np.diff(ends)))))
    return np.interp(np.linspace(0.0, travelled[-1], SAMPLES), travelled, ends)


KINDS: tuple[SpringKind, ...] = (*PLAIN_SPRINGS, *(Backlash(kind) for kind in PLAIN_SPRINGS))


def spring(words: str, draw: Draw) -> Any:
    """A spring of that kind, of some 20 to 40 N.m at the end of the path."""
    k = TORQUE / HALF * draw.uniform(0.5, 1.0)
    st = sw.stiffness
    if words.endswith(" behind play"):
        law = spring(words.removesuffix(" behind play"), draw)
        return st.Backlash(law=law, clearance=HALF * draw.uniform(0.1, 0.5))
    if words == "linear spring":
        return st.Linear(k=k)
    if words == "cubic spring":
        return st.Cubic(a1=0.6 * k, a3=draw.uniform(0.2, 0.8) * k / HALF**2)
    if words == "piecewise spring":
        return st.Piecewise(k1=0.6 * k, k2=draw.uniform(0.4, 1.2) * k, knee=HALF * draw.uniform(0.25, 0.6))
    if words == "three-segment spring":
        k1, k2, k3 = 0.5 * k, draw.uniform(0.8, 1.0) * k, draw.uniform(1.3, 1.8) * k
        first, second = HALF * draw.uniform(0.15, 0.3), HALF * draw.uniform(0.5, 0.65)
        return st.ThreeSegment(k1=k1, k2=k2, k3=k3, t1=k1 * first, t2=k1 * first + k2 * (second - first))
    return compliance(draw)


def compliance(draw: Draw) -> sw.stiffness.MultiCompliance:
    share, level = draw.uniform(0.3, 0.7), 0.75 * TORQUE
    cf, cw = draw.uniform(1.0, 3.0), draw.uniform(0.5, 2.0)
    softness = 1.3 * HALF / level / ((1 - share) * np.arctan(cf) / cf + share * -np.expm1(-cw) / cw)
    return sw.stiffness.MultiCompliance(
        flexspline_stiffness=1.0 / ((1 - share) * softness),
        flexspline_hardening=cf / level,
        wave_generator_stiffness=1.0 / (share * softness * RATIO**2),
        wave_generator_hardening=cw / level * RATIO,
        reduction=RATIO,
    )


def elements(draw: Draw) -> object:
    slips = HALF * np.array([draw.uniform(0.05, 0.12), draw.uniform(0.3, 0.5)])
    torque = TORQUE * draw.uniform(0.04, 0.1, 2)
    return sw.hysteresis.MaxwellSlip(stiffness=(torque / slips).tolist(), breakaway=torque.tolist())


def fading(branches: int) -> Callable[[Draw], object]:
    def draw_law(draw: Draw) -> object:
        rates = np.array([draw.uniform(3.0, 6.0), draw.uniform(20.0, 40.0)])[:branches] / HALF
        torque = TORQUE * draw.uniform(0.06, 0.12, branches)
        return sw.hysteresis.FadingMemory(stiffness=(torque * rates).tolist(), forgetting=rates.tolist())

    return draw_law


def bouc_wen(draw: Draw) -> object:
    torque, reach = TORQUE * draw.uniform(0.1, 0.2), HALF * draw.uniform(0.1, 0.4)
    shape, sharpness = draw.uniform(0.6, 0.9), draw.uniform(1.3, 3.0)
    return sw.hysteresis.BoucWen(stiffness=torque / reach, saturation=torque, sharpness=sharpness, shape=shape)


def preisach(draw: Draw) -> object:
    density = sw.hysteresis.PowerDensity(
        limit=HALF * draw.uniform(0.5, 0.9), saturation=TORQUE * draw.uniform(0.15, 0.25), exponent=draw.uniform(2.0, 4.0)
    )
    return sw.hysteresis.Preisach(density=density)


def regimes(draw: Draw) -> object:
    k = TORQUE / HALF
    positive, negative, loading, reverse = draw.uniform([1.6, 1.6, 0.6, 0.6], [2.2, 2.2, 0.8, 0.8])
    return sw.hysteresis.Regimes(
        positive_unloading=positive * k,
        negative_unloading=negative * k,
        positive_loading=loading * k,
        negative_loading=reverse * k,
        onset=TORQUE * draw.uniform(0.03, 0.1),
        lost_motion=HALF * draw.uniform(0.3, 0.6),
    )


def windup(draw: Draw) -> object:
    return sw.hysteresis.FrictionalWindup(springs=compliance(draw), friction=TORQUE * draw.uniform(0.05, 0.15))


BESIDE: list[tuple[Dissipation, Callable[[Draw], object]]] = [
    (Without(), lambda draw: sw.hysteresis.MaxwellSlip(stiffness=[], breakaway=[])),
    (Elements(), elements),
    (FadingMemory(1), fading(1)),
    (FadingMemory(2), fading(2)),
    (BoucWen(), bouc_wen),
    (Preisach(), preisach),
]
WHOLE: list[tuple[Dissipation, Callable[[Draw], object]]] = [(Regimes(), regimes), (FrictionalWindup(), windup)]


def distances(kind: SpringKind, beside: Dissipation, law: Callable[[Draw], object], draw: Draw) -> dict[str, float] | None:
    """How many standard deviations each number of a fit lies off the truth; none where the fit is of fewer numbers."""
    elastic = sw.stiffness.Linear(k=1e-3) if isinstance(kind, Negligible) else spring(kind.words, draw)
    truth = sw.Gear(stiffness=elastic, hysteresis=law(draw))  # type: ignore[arg-type]
    twist = path()
    torque = truth.trace(twist)
    loop = TorsionLoop(twist, torque + NOISE * np.abs(torque).max() * draw.normal(size=SAMPLES), "virgin")
    with warnings.catch_warnings(action="ignore"):
        found = candidate(loop, sw.Gear(), np.ones(SAMPLES, bool), kind, beside).fit
    true, fitted = every(truth), {e.path: e for e in found.estimates}
    known = [path for path in fitted if "." in path]
    if len(true_of(truth, kind, beside)) != len(known):
        return None
    in_series = "multi-compliance" in kind.words
    told = [path for path in known if not (in_series and path.startswith("stiffness."))]
    of_numbers = {path: (fitted[path].value - true[path].value) / fitted[path].sigma for path in told}
    return of_numbers | (curve_distances(found, truth) if in_series else {})


def curve_distances(found: Fit, truth: sw.Gear) -> dict[str, float]:
    """The same of the torque of the spring at some twists, whose standard deviations the covariance of its numbers tells."""
    twists = HALF * np.array([0.25, 0.5, 0.75, 1.0])
    places = [i for i, e in enumerate(found.estimates) if e.path.startswith("stiffness.")]
    middle = np.asarray(found.gear.stiffness.torque(twists))
    slopes = []
    for i in places:
        estimate = found.estimates[i]
        step = 1e-6 * max(abs(estimate.value), 1e-3)
        moved = found.gear.replace({estimate.path: estimate.value + step})
        slopes.append((np.asarray(moved.stiffness.torque(twists)) - middle) / step)
    slope = np.array(slopes)
    sigma = np.sqrt(np.einsum("pt,pq,qt->t", slope, found.covariance[np.ix_(places, places)], slope))
    off = (middle - np.asarray(truth.stiffness.torque(twists))) / sigma
    return {f"torque at {twist:.2g} rad": float(value) for twist, value in zip(twists, off, strict=True)}


def true_of(truth: sw.Gear, kind: SpringKind, beside: Dissipation) -> list[str]:
    """Paths of the numbers that a fit of these kinds frees."""
    names = [*kind.free(truth), *beside.free(truth)]
    return [path for path in every(truth) if any(path == name or path.startswith(f"{name}[") for name in names)]


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--truths", type=int, default=50, help="of each pair of kinds (50)")
    parser.add_argument("--only", default="", help="pairs whose words hold this")
    wanted = parser.parse_args()
    pairs = [(kind, *beside) for kind in KINDS for beside in BESIDE] + [(Negligible(), *beside) for beside in WHOLE]
    failed = 0
    for kind, beside, law in pairs:
        name = f"{kind.words} {type(beside).__name__}{getattr(beside, 'branches', '')}"
        if wanted.only not in name:
            continue
        found = [distances(kind, beside, law, np.random.default_rng(seed)) for seed in range(wanted.truths)]
        told = [each for each in found if each is not None]
        values = np.array([value for each in told for value in each.values()])
        finite = values[np.isfinite(values)]
        within, scatter = float(np.mean(np.abs(finite) < 2.0)), float(finite.std())
        wrong = within < COVERED or not SCATTER[0] <= scatter <= SCATTER[1]
        failed += wrong
        words = f"{100.0 * within:5.1f} % within two standard deviations, scatter over stated {scatter:.2f}"
        fewer = f"; {len(found) - len(told)} of {len(found)} fits of other numbers" if len(told) < len(found) else ""
        print(f"{name:44} {words}{fewer}{'  FAILS' if wrong else ''}", flush=True)
    return int(failed > 0)


if __name__ == "__main__":
    sys.exit(main())
