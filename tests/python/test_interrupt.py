"""Ctrl-C ends whatever takes long."""

from __future__ import annotations

import subprocess
import sys

PROGRAM = """
import warnings
import numpy as np
import strainwave as sw
from tests.interrupts import ctrl_c
from tests.reference_drive import DRIVE, command

warnings.simplefilter("ignore")
long = sw.scenario.sine(0.1, 1.0, 600.0)
log = sw.simulate(DRIVE, command(20.0), sample=2e-3).select(["time", "command", "output_angle"])
free = ["gear.friction_input.coulomb", "gear.stiffness.a1", "gear.damping"]
verbs = {
    "simulate": lambda: sw.simulate(DRIVE, long, sample=1.0),
    "adaptively": lambda: sw.simulate_adaptively(DRIVE, long, 1e-10, sample=1.0),
    "many": lambda: sw.simulate_many(DRIVE, long, {"load.inertia": np.linspace(0.1, 0.5, 64)}, sample=1.0),
    "derivatives": lambda: sw.derivatives(DRIVE, long, free, sample=1.0),
    "fit": lambda: sw.fit(DRIVE, log, free),
    "frequency_response": lambda: sw.frequency_response(DRIVE, np.linspace(0.01, 0.02, 100), 0.01, tolerance=1e-300),
}
for name, verb in verbs.items():
    try:
        with ctrl_c():
            verb()
        print(name, "ended by itself")
    except KeyboardInterrupt:
        print(name, "was interrupted")
"""


def test_ctrl_c_ends_each_verb_on_its_way() -> None:
    run = subprocess.run([sys.executable, "-c", PROGRAM], capture_output=True, text=True, timeout=60.0)
    assert run.stderr == ""
    verbs = ["simulate", "adaptively", "many", "derivatives", "fit", "frequency_response"]
    assert run.stdout.splitlines() == [f"{verb} was interrupted" for verb in verbs]
