"""Maxwell-slip in parallel with a spring, on torsion loops measured by others.

Torque over deflection of printed cycloidal gears, output locked: JelmerV, Anti-Backlash-Cycloidal-Actuator (CC BY-SA 4.0),
digitised from its figures. No public loop of a strain wave gear is known to us. A quarter of each loop, in blocks, is kept
back and only predicted. Run with `-s` to read the numbers.
"""

from __future__ import annotations

import os
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
import strainwave as sw
from strainwave.identification.candidates.torsion import fit_loop, held_out_blocks
from strainwave.identification.candidates.torsion.ranking import rank_loop
from strainwave.identification.experiments.torsion_loop import TorsionLoop

from tests.support.samples import sample

FOLDER = Path(os.environ.get("STRAINWAVE_DATA", Path(__file__).parents[3] / "shared" / "data")) / "cycloidal-loops"
LOOPS = [
    "torque-displacement_of_Baseline_ax0_line0_d62728.csv",
    "torque-displacement_of_Baseline_ax1_line0_d62728.csv",
    "torque-displacement_of_Conic_Disk_ax0_line2_3b528b.csv",
    "torque-displacement_of_Conic_Disk_ax1_line1_440154.csv",
    "torque-displacement_of_Split_Pinwheel_ax0_line0_d62728.csv",
    "torque-displacement_of_Split_Pinwheel_ax1_line4_5ec962.csv",
]

pytestmark = pytest.mark.skipif(not FOLDER.is_dir(), reason=f"measured data not found: {FOLDER} (set STRAINWAVE_DATA)")


def measured(name: str) -> TorsionLoop:
    columns = {"twist": "deflection_deg", "torque": "motor_torque_output_side_Nm"}
    recording = sw.Recording.from_csv(FOLDER / name, columns=columns, units={"twist": "deg", "torque": "N.m"})
    return TorsionLoop.of(recording, sw.Gear())


@pytest.mark.slow("rig")
@pytest.mark.parametrize("name", LOOPS)
def test_a_measured_loop_is_predicted_where_it_was_held_out(name: str, record_property: Callable[[str, object], None]) -> None:
    loop = measured(name)
    span = float(np.ptp(loop.torque))
    best = fit_loop(loop, sw.Gear(), held_out_blocks(len(loop.twist)))[0]
    held_out, trained = best.error / span, best.fit.rms()[0] / span
    record_property("held_out", held_out)
    print(f"\n{name}: {best.name}, rms error {100 * trained:.2f} % of the span, {100 * held_out:.2f} % kept back")
    without = fit_without_hysteresis(loop) / span
    assert held_out < 0.05
    assert held_out < 0.4 * without  # the memory is what explains the loop


@pytest.mark.slow("rig")
@pytest.mark.parametrize("name", LOOPS[::2][: sample(1, 3)])  # one of each gear, if samples are whole
def test_all_models_are_ranked_on_a_measured_loop(name: str) -> None:
    """The friction of the motor is inside these loops; nothing of it is known, so all of it counts as hysteresis."""
    loop = measured(name)
    span = float(np.ptp(loop.torque))
    ranked = rank_loop(loop, sw.Gear())
    print(f"\n{name}")
    for each in ranked:
        told = f"{100 * each.error / span:.2f} ± {100 * each.standard_error / span:.2f} %, {each.parameters} numbers"
        print(f"{'*' if each.good else ' '} {each.name}: {told}, correlation {each.correlation:.1f}")
    best = ranked[0]
    assert best.good
    assert best.error / span < 0.03
    elastic = min(each.error for each in ranked if each.name.endswith("without hysteresis"))
    assert best.error < 0.4 * elastic


def fit_without_hysteresis(loop: TorsionLoop) -> float:
    """Error of the best cubic curve through the training samples, on the samples kept back [N.m]."""
    training, x = held_out_blocks(len(loop.twist)), loop.twist / np.ptp(loop.twist)
    curve = np.polynomial.Polynomial.fit(x[training], loop.torque[training], 3)
    return float(np.sqrt(np.mean((loop.torque - curve(x))[~training] ** 2)))
