"""Ctrl-C ends whatever takes long."""

from __future__ import annotations

import os
import re
import subprocess
import sys

import pytest

PROGRAM = '''
import contextlib
import functools
import warnings
import numpy as np
import strainwave as sw
from strainwave import _core
from strainwave.native import kernels
from strainwave.simulation import time_grid
from tests.support.interrupts import ctrl_c
from tests.support.reference_drive import DRIVE, command

warnings.simplefilter("ignore")
long = sw.scenario.sine(0.1, 1.0, 300.0)
log = sw.simulate(DRIVE, command(100.0), sample=2e-3).select(["time", "command", "output_angle"])
time_grid.STEPS_PER_CHUNK = 1_000_000  # steps at once, that one call of the core takes long enough
free = ["gear.friction_input.coulomb", "gear.stiffness.a1", "gear.damping"]
verbs = {
    "simulate": lambda: sw.simulate(DRIVE, long, sample=1.0),
    "adaptively": lambda: sw.simulate_adaptively(DRIVE, long, 1e-10, sample=1.0),
    "many": lambda: sw.simulate_many(DRIVE, long, {"load.inertia": np.linspace(0.1, 0.5, 64)}, sample=1.0),
    "derivatives": lambda: sw.analysis.derivatives(DRIVE, long, free, sample=1.0),
    "fit": lambda: sw.fit(DRIVE, log, free),
    "frequency_response": lambda: sw.analysis.frequency_response(DRIVE, np.linspace(0.01, 0.02, 100), 0.01, tolerance=1e-300),
}
def pressed(work):
    """The same work of the core; from its first call on, Ctrl-C is pressed until the verb ends."""
    @functools.wraps(work)
    def within(*arguments):
        global pressing
        if not pressing:
            pressing = True
            until_the_end.enter_context(ctrl_c())
        return work(*arguments)
    return within
jobs = ["simulate", "simulate_adaptively", "simulate_many", "differentiate"]
for job in jobs:
    kernels.load(DRIVE, job, compile_it=True)
    setattr(_core, job, pressed(getattr(_core, job)))
for name, verb in verbs.items():
    pressing = False
    try:
        with contextlib.ExitStack() as until_the_end:
            verb()
        print(name, "ended by itself")
    except KeyboardInterrupt:
        print(name, "was interrupted")
print(*(job for job in jobs if job in _core.loaded_jobs(DRIVE)))
'''


@pytest.mark.slow("physics")
@pytest.mark.parametrize("kernels", ["off", os.environ["STRAINWAVE_KERNELS"]], ids=["general drive", "kernels"])
def test_ctrl_c_ends_each_verb_on_its_way(kernels: str) -> None:
    variables = os.environ | {"STRAINWAVE_KERNELS": kernels}
    run = subprocess.run([sys.executable, "-c", PROGRAM], env=variables, capture_output=True, text=True, timeout=120.0)
    compiling = r"strainwave: compiling a kernel of this drive for \w+, once; it takes some seconds"
    told = [line for line in run.stderr.splitlines() if kernels == "off" or not re.fullmatch(compiling, line)]
    assert told == []
    verbs = ["simulate", "adaptively", "many", "derivatives", "fit", "frequency_response"]
    by_kernels = "" if kernels == "off" else "simulate simulate_adaptively simulate_many differentiate"
    assert run.stdout.splitlines() == [*(f"{verb} was interrupted" for verb in verbs), by_kernels]
