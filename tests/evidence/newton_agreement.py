"""Exported actuators of Newton against the simulation and native code, by `python -m tests.evidence.newton_agreement`.

The joints of five drives follow a motion of 10 s. Differences are the largest ones, over the largest value of each output:

- to `sw.simulate`, in double precision, but at instants where the rate of the command jumps: a current may jump there. Newton
  hands angles, speeds and commands on in single precision, which the simulation does not;
- to the same source compiled by the C++ compiler of this machine, which gets the same numbers, in both precisions.

Then 4096 gears are stepped in one launch: equal gears have equal outputs, and the speed is compared with `sw.simulate_many`.
"""

from __future__ import annotations

import argparse
import ctypes
import json
import sys
import time
import warnings
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
import strainwave as sw
from numpy.typing import NDArray
from strainwave.export.newton import build
from strainwave.native.compilers import FLAGS, find_compiler
from strainwave.native.static_type import SCALARS, Scalar
from strainwave.rig.virtual.printed import printed_gear

Array = NDArray[np.float64]
RUN_SECONDS = 10.0
JOINT_STEP = 1e-3  # s, of Newton
AMPLITUDE, FREQUENCY = 0.3, 0.5  # rad and Hz, of the joint
STEPS_BETWEEN_KNOTS = 20  # of the command, which is straight between them
PULSE, PULSE_PERIOD = 0.02, 1.0  # N.m and s, of a drive that takes a torque: Newton holds it through a step
DAMPING = 5.0  # N.m.s/rad, of T's gear, about 5 % of the critical damping; the document states none
COMPARED = ("torque", "load_torque", "twist", "input_angle", "input_speed", "current")
MAX_NATIVE_ERROR = 1e-5  # relative
GEARS = 4096
TIMED_STEPS = 20  # of Newton
MANY_RUN_SECONDS = 0.4  # s, of simulate_many
MANY = 512  # drives of simulate_many
LOOP = """
extern "C" __attribute__((visibility("default"))) void run(int steps, const actuator::S* numbers, const float* joint, double dt,
                                                           double max_step, float* outputs) {
    static double prepared[actuator::prepared_words];
    static actuator::S memory[2][actuator::memory_count];
    const unsigned first = 0;
    int problem;
    float torque;
    actuator::prepare(0, numbers, prepared, &problem);
    memory[0][0] = actuator::S(0.0);
    for (int k = 0; k < steps; ++k) {
        const float* at = joint + 5 * k;
        actuator::advance(0, 1, prepared, 1, memory[k % 2], memory[(k + 1) % 2], at, at + 1, at + 2, at + 3, at + 4,
                          &first, &first, &first, &first, dt, max_step, &torque, outputs + k * actuator::output_count);
    }
}
"""


@dataclass(frozen=True)
class Follower:
    """An exported drive whose joint follows a motion.

    Attributes:
        drive: with a load that prescribes the motion
        folder: of the exported package
        about: content of its drive.json
        joint: position, speed, target position, target speed and feedforward of each instant, in single precision
    """

    drive: sw.Drive
    folder: Path
    about: dict[str, Any]
    joint: NDArray[np.float32]

    def by_warp(self, device: str) -> dict[str, Array]:
        """Return its outputs in Newton."""
        import warp as wp
        from newton.actuators import Actuator

        package = build.loaded(self.folder)
        actuator = Actuator(indices=wp.zeros(1, dtype=wp.uint32, device=device), drive=package.DriveStrainWave())
        state, control = actuator.sim_state(), actuator.sim_control()
        given = [wp.zeros(1, dtype=wp.float32, device=device) for _ in range(5)]
        state.joint_q, state.joint_qd, control.joint_target_q, control.joint_target_qd, control.joint_act = given
        control.joint_f = wp.zeros(1, dtype=wp.float32, device=device)
        here, there = actuator.state(), actuator.state()
        rows = []
        for row in self.joint:
            for array, value in zip(given, row, strict=True):
                array.fill_(value)
            actuator.step(state, control, here, there, dt=JOINT_STEP)
            here, there = there, here
            rows.append(here.drive_state.outputs.numpy()[:, 0].astype(float))
        return dict(zip(package.OUTPUTS, np.array(rows).T, strict=True))

    def by_compiler(self) -> dict[str, Array]:
        """Return its outputs by the compiler of this machine."""
        with TemporaryDirectory() as folder:
            source = Path(folder, "drive.cpp")
            source.write_text((self.folder / "drive.hpp").read_text() + LOOP)
            library = ctypes.CDLL(str(find_compiler().build(source, FLAGS)))
        scalar = np.float64 if self.about["scalar"] == "double" else np.float32
        numbers = np.array([entry["value"] for entry in self.about["parameters"].values()], scalar)
        outputs = np.zeros((len(self.joint), len(self.about["outputs"])), np.float32)
        library.run(
            ctypes.c_int(len(self.joint)),
            *(each.ctypes.data_as(ctypes.c_void_p) for each in (numbers, self.joint)),
            ctypes.c_double(JOINT_STEP),
            ctypes.c_double(self.about["step"]),
            outputs.ctypes.data_as(ctypes.c_void_p),
        )
        return dict(zip(self.about["outputs"], outputs.T.astype(float), strict=True))


def drives() -> dict[str, sw.Drive]:
    """Return five drives by their names."""
    gear = printed_gear(0).replace(damping=DAMPING)
    named = {
        "reference": "position-drive",
        "catalogue joint": "robot-joint",
        "tilt actuator, lumped": "tilt-actuator-lumped",
        "tilt actuator, staged": "tilt-actuator",
    }
    return {name: sw.GearSet.read(found).drive for name, found in named.items()} | {
        "T's gear": sw.Drive(gear=gear, motor=sw.motor.TorqueSource(inertia=1e-5))
    }


def motion(about: dict[str, Any]) -> tuple[sw.Scenario, sw.Scenario]:
    """Return the joint's angle and the command of a drive: both begin at rest."""
    joint = sw.scenario.sine(AMPLITUDE, FREQUENCY, RUN_SECONDS, phase=-0.5 * np.pi, offset=AMPLITUDE)
    if about["command"] == "feedforward":
        return joint, sw.scenario.pulse_train(PULSE, PULSE_PERIOD, 0.5 * PULSE_PERIOD, RUN_SECONDS, start=0.1)
    knots = np.linspace(0.0, RUN_SECONDS, round(RUN_SECONDS / JOINT_STEP / STEPS_BETWEEN_KNOTS) + 1)
    angle = AMPLITUDE * (1.0 - np.cos(2.0 * np.pi * FREQUENCY * knots))
    angle[1] = 0.0  # so that the controller begins at rest
    return joint, sw.scenario.table(knots, 1.01 * angle)


def follower(drive: sw.Drive, scalar: Scalar, folder: Path) -> tuple[Follower, sw.Run]:
    """Export a drive, and return it with its simulation."""
    exported = build.newton(drive, scalar=scalar, gpu=False, compare=False)
    for path, content in exported.files.items():
        (folder / path).write_text(str(content))
    about = json.loads(str(exported.files["drive.json"]))
    drive = drive.replace(load=sw.loads.Prescribed(), meter=sw.meter.NoMeter())
    joint, command = motion(about)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        run = sw.simulate(drive, command, about["step"], sample=JOINT_STEP, inputs={"output_angle": joint})
    time_, none = run["time"], np.zeros(len(run))
    value, rate = command.value(time_), command.rate(time_)
    asked = [value, rate, none] if about["command"] == "position" else [none, none, value]
    given = np.array([joint.value(time_), joint.rate(time_), *asked]).T.astype(np.float32)
    return Follower(drive, folder, about, np.ascontiguousarray(given)), run


def largest_error(found: Any, wanted: Any, at: Any = slice(None)) -> tuple[float, str]:
    """Return the largest difference of an output over its largest value, and the name of the output."""
    names = [name for name in COMPARED if name in found and np.abs(wanted[name]).max() > 0.0]
    return max((float(np.abs(found[name] - wanted[name])[at].max() / np.abs(wanted[name]).max()), name) for name in names)


def speed(follower: Follower, count: int, device: str) -> tuple[float, bool]:
    """Return gears times internal steps a second in one launch, and whether equal gears have equal outputs."""
    import warp as wp
    from newton.actuators import Actuator

    package = build.loaded(follower.folder)
    indices = wp.array(np.arange(count), dtype=wp.uint32, device=device)
    actuator = Actuator(indices=indices, drive=package.DriveStrainWave())
    state, control = actuator.sim_state(), actuator.sim_control()
    given = [wp.zeros(count, dtype=wp.float32, device=device) for _ in range(5)]
    state.joint_q, state.joint_qd, control.joint_target_q, control.joint_target_qd, control.joint_act = given
    control.joint_f = wp.zeros(count, dtype=wp.float32, device=device)
    here, there = actuator.state(), actuator.state()
    begin = 0.0
    for k, row in enumerate(follower.joint[: TIMED_STEPS + 2]):
        for array, value in zip(given, row, strict=True):
            array.fill_(value)
        if k == 2:  # the code is loaded
            wp.synchronize()
            begin = time.perf_counter()
        actuator.step(state, control, here, there, dt=JOINT_STEP)
        here, there = there, here
    wp.synchronize()
    seconds = time.perf_counter() - begin
    outputs = here.drive_state.outputs.numpy()
    return count * TIMED_STEPS * JOINT_STEP / follower.about["step"] / seconds, bool((outputs == outputs[:, :1]).all())


def speed_of_ensemble(follower: Follower) -> float:
    """Return drives times steps a second of `sw.simulate_many`, with a compiled kernel."""
    joint = sw.scenario.sine(0.02, 2.5, MANY_RUN_SECONDS, phase=-0.5 * np.pi, offset=0.02)
    command = sw.scenario.table([0.0, 0.02, MANY_RUN_SECONDS], [0.0, 0.0, 0.02])
    numbers = {"gear.damping": np.full(MANY, follower.drive.gear.damping)}
    best = 0.0
    for _ in range(4):  # the first ones compile
        begin = time.perf_counter()
        sw.simulate_many(
            follower.drive, command, numbers, dt=follower.about["step"], inputs={"output_angle": joint}, record=["torque"]
        )
        best = max(best, MANY * MANY_RUN_SECONDS / follower.about["step"] / (time.perf_counter() - begin))
    return best


def main() -> int:
    """Print errors and speeds; 1 if an error against native code is too large."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--device", default="cpu", help="of Warp")
    parser.add_argument("--drive", help="a part of the name of one drive")
    parser.add_argument("--speed", action="store_true", help="measure speeds, too")
    options = parser.parse_args()
    import warp as wp

    wp.config.log_level = wp.LOG_WARNING
    failed = False
    for name, drive in drives().items():
        if options.drive and options.drive not in name:
            continue
        for scalar in SCALARS:
            with TemporaryDirectory() as folder:
                found, run = follower(drive, scalar, Path(folder))
                outputs = found.by_warp(options.device)
                native, of_native = largest_error(outputs, found.by_compiler())
                simulated, of_simulated = largest_error(outputs, run, np.arange(len(run)) % STEPS_BETWEEN_KNOTS != 0)
                print(
                    f"{name}, {scalar}: {native:.1e} to native code ({of_native}), "
                    f"{simulated:.1e} to the simulation ({of_simulated})",
                    flush=True,
                )
                failed |= not native <= MAX_NATIVE_ERROR
                if options.speed:
                    rate, is_equal = speed(found, GEARS, options.device)
                    print(
                        f"    {GEARS} gears: {rate:.3g} gear steps a second; {'equal' if is_equal else 'NOT EQUAL'}; "
                        f"simulate_many: {speed_of_ensemble(found):.3g}",
                        flush=True,
                    )
                    failed |= not is_equal
    return int(failed)


if __name__ == "__main__":
    sys.exit(main())
