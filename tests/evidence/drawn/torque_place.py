"""Logs whose torque was measured at the motor, behind the motor or behind the gear, from five start sets."""

from __future__ import annotations

import numpy as np
from strainwave.files.recording import Recording
from strainwave.identification.identify import identify
from strainwave.identification.reading.mapping import FileMapping

from tests.evidence.drawn.joint import several_speeds, torque_of_input
from tests.evidence.drawn.outcome import Outcome, compared

STARTS = ("csg-14-100", "csg-17-100", "csg-20-100", "csg-25-100", "csg-32-100")
RATIO = 100.0  # of the gear
MAX_ERROR_RATIO = 1.1  # between the errors on held-out data from two start sets


def outcome(seed: int) -> Outcome:
    """Return the outcome of a record from the start set of its seed, and from the next larger one."""
    random = np.random.default_rng(seed)
    place = ("at the motor", "behind the motor", "behind the gear")[seed % 3]
    motion, level = several_speeds(random), float(np.exp(random.uniform(np.log(0.01), np.log(0.06))))
    fast = RATIO * float(np.abs(motion.speed).max())
    viscous = level * float(random.uniform(0.2, 1.0)) / fast
    of_motor, of_gear = float(random.uniform(0.5, 2.0)) * 1e-5, float(random.uniform(0.5, 1.5)) * 1.9e-5
    load = float(np.exp(random.uniform(np.log(0.02), np.log(2.0))))
    gravity = float(random.choice([0.0, random.uniform(1.0, 10.0)]))
    torque, carried = torque_of_input(
        motion, RATIO, (of_motor if place == "at the motor" else 0.0) + of_gear, load, gravity,
        lambda speed, transmitted: level * np.tanh(speed / (0.01 * fast)) + viscous * speed,
    )  # fmt: skip
    if place == "behind the gear":
        torque = carried
    torque = torque + float(random.uniform(0.01, 0.1)) * level * random.standard_normal(len(torque))
    name = "input_torque" if place != "behind the gear" else "joint_torque"
    columns = {
        "time": motion.time,
        "output_angle": motion.angle,
        name: torque * (RATIO if name == "joint_torque" else 1.0),
    }
    recording = Recording(columns, {"time": "s", "output_angle": "rad", name: "N.m"})
    constants = {"motor_inertia": of_motor} if place == "at the motor" else {}
    results = [
        identify(STARTS[(seed // 3 + more) % len(STARTS)], {"log": recording}, mapping=FileMapping(constants=constants))
        for more in (0, 1)
    ]
    files = [each.files[0] for each in results]
    errors = [each.held_out.error if each.held_out is not None else np.nan for each in files]
    if max(errors) > MAX_ERROR_RATIO * min(errors):
        return Outcome(
            "wrong", f"{place}: errors {errors[0]:.3g}, {errors[1]:.3g} from two start sets: {[f.model for f in files]}"
        )
    pairs = []
    truth = {"gear.friction_input.coulomb": level, "gear.friction_input.viscous": viscous}
    for file, result in zip(files, results, strict=True):
        if result.failed:
            continue
        for each in file.estimates:
            if each.path in truth and each.state == "identified" and place != "behind the gear":
                pairs.append((f"{place}: {each.path}", each.value, each.sigma, truth[each.path]))
            if each.path == "load.inertia" and each.state == "identified":
                wrong_rotor = (
                    abs(result.start_set.gear.input_inertia - of_gear) * RATIO**2 if place != "behind the gear" else 0.0
                )
                pairs.append((f"{place}: {each.path}", each.value, float(np.hypot(each.sigma, wrong_rotor)), load))
            if each.path.startswith("gear.friction_input") and each.state == "identified" and place == "behind the gear":
                return Outcome("wrong", f"{place}: {each.path} {each.value:.4g} identified from a torque without friction")
    if not pairs and any(result.failed for result in results):
        return Outcome("refused", "; ".join(each.message for each in results[0].failed))
    return compared(pairs, floor=0.01)
