"""Two logs of one joint with a loss under load, which carry two loads: one number from two files, or in two ways from one.

By turns both are right; the inertia of the motor is given wrong; the torque constant of the second log has drifted; and nothing
is given of the motor. If all is right no check fails, and estimates lie within 2.5 standard deviations of the truth, or within
2 %; if a number is wrong, a check fails.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np
from strainwave.identification.identify import Identified

from tests.evidence.drawn.outcome import Outcome, compared
from tests.evidence.drawn.spring_and_loop import Joint, drawn, identified, run

CONSTANT, LOSS = 0.1, 0.04  # N.m/A; friction under load over the input torque
MAX_RELATIVE_BIAS = 0.02  # relative: the current of a rigid gear lacks what the spring makes of the motion
WRONG = ("", "wrong inertia", "drifted constant", "")


def outcome(seed: int) -> Outcome:
    """Return the outcome of one pair of logs."""
    random = np.random.default_rng(1000 + seed)
    joint = replace(drawn(random, "linear", 1, True), loss=LOSS, noise=1e-6)
    joint = replace(joint, stiffness=(2.5e4,), rotor=joint.inertia / joint.ratio**2 * float(random.uniform(0.4, 1.0)))
    heavy = replace(joint, gravity=1.8 * joint.gravity, inertia=1.6 * joint.inertia)
    wrong = WRONG[seed % len(WRONG)]
    drift = float(random.choice([0.85, 1.15])) if wrong == "drifted constant" else 1.0
    logs = [run(joint, 12.0, random, CONSTANT), run(heavy, 12.0, random, CONSTANT * drift)]
    given = {"torque_constant": CONSTANT, "ratio": float(joint.ratio)}
    if seed % len(WRONG) < len(WRONG) - 1:
        given["motor_inertia"] = joint.rotor * (float(random.choice([0.5, 2.0])) if wrong == "wrong inertia" else 1.0)
    found = identified(logs, [given, given])
    failed = "; ".join(f"{check.name}: {check.message}" for check in found.failed)
    if wrong:
        return Outcome("right", failed) if failed else Outcome("wrong", f"{wrong}, and no check fails")
    return Outcome("refused", failed) if failed else compared(_pairs(found, joint), MAX_RELATIVE_BIAS)


def _pairs(found: Identified, joint: Joint) -> Iterator[tuple[str, float, float, float]]:
    """Yield name, estimate, standard deviation and truth of what friction and rotor were identified as."""
    truth = {
        "gear.friction_input.coulomb": joint.coulomb, "gear.friction_mesh.driving_forward": LOSS,
        "motor.inertia": joint.rotor, "gear.stiffness.k": joint.stiffness[0],
    }  # fmt: skip
    for parameter in found.parameters:
        each = parameter.estimate
        if each.path in truth:
            yield each.path, each.value, each.sigma, truth[each.path]
