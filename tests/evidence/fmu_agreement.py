"""FMUs of five drives against the simulation over 10 s, by `python -m tests.evidence.fmu_agreement`.

Blocks for co-simulation follow a command with five reversals, under a load that rises, in both versions of FMI. All outputs are
compared at the communication instants. Blocks for model exchange follow a command of five pulses: FMPy, whose CVODE solves
them, holds other commands between the communication instants, which shows more than its tolerance.
"""

from __future__ import annotations

import warnings
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import fmpy
import numpy as np
import strainwave as sw
from numpy.typing import NDArray
from strainwave.export.fmu import build as comparison
from strainwave.export.fmu.source import recorded, variables
from strainwave.simulation.excitation import ROOM_TEMPERATURE

from tests.support.reference_drive import five_drives

COMMAND_KNOTS, LOAD_KNOTS = five_drives.COMMAND_KNOTS, five_drives.LOAD_KNOTS

Array = NDArray[np.float64]
COMMUNICATION_STEP = 2.0**-8  # s; its multiples are exact
SOLVER_TOLERANCES = (1e-4, 1e-6)  # of CVODE
SOLVED_OUTPUTS = ("output_angle", "torque")
PULSE_SIZE, PULSE_WIDTH, RUN_DURATION = 0.1, 1.0, 10.0  # rad or N.m, s, s


def inputs() -> tuple[Array, Array, Array, Array]:
    """Return the communication instants, and command, its rate and the load there, straight up to the next."""
    time = np.arange(0.0, COMMAND_KNOTS[0][-1] + COMMUNICATION_STEP / 2.0, COMMUNICATION_STEP)
    command, load = np.interp(time, *COMMAND_KNOTS), np.interp(time, *LOAD_KNOTS)
    return time, command, np.diff(command, append=command[-1]) / COMMUNICATION_STEP, load


def simulated(drive: sw.Drive, step: float) -> sw.Run:
    """Return the simulation."""
    return sw.simulate(
        drive,
        sw.scenario.table(*COMMAND_KNOTS),
        step,
        sample=COMMUNICATION_STEP,
        load_torque=sw.scenario.table(*LOAD_KNOTS),
        temperature=ROOM_TEMPERATURE,
    )


def difference_of_block(drive: sw.Drive, run: sw.Run, step: float, version: int) -> float:
    """Return the largest difference of a block for co-simulation."""
    content = sw.export.fmu(drive, version=version, platforms=None, step=step, name="block").files["block.fmu"]
    found = variables(drive, step)
    outputs = recorded(drive, found)
    time, command, rate, load = inputs()
    rise = np.diff(load, append=load[-1]) / COMMUNICATION_STEP
    rows = []
    with comparison.instance(content, found, version) as block:
        for k in range(len(time)):
            values = {"command": command[k], "command_rate": rate[k], "load_torque": load[k], "load_torque_rate": rise[k]}
            if k == 0:
                block.start(values | {"temperature": ROOM_TEMPERATURE})
            rows.append(block.get(list(outputs)))
            if k + 1 < len(time):
                block.set(values)
                block.step(time[k], COMMUNICATION_STEP)
    shares = []
    for output, column in zip(outputs.values(), np.array(rows).T, strict=True):
        largest = np.abs(run[output.name]).max()
        at_jumps = np.isin(time, COMMAND_KNOTS[0])  # an output may follow the rate of the command at once
        shares.append(np.abs(column - run[output.name])[~at_jumps].max() / max(largest, 1e-300))
    return float(max(shares))


def differences_of_solver(drive: sw.Drive, step: float, folder: Path) -> list[str]:
    """Return the largest difference of a block for model exchange, for each tolerance."""
    path = folder / "block.fmu"
    path.write_bytes(sw.export.fmu(drive, model_exchange=True, step=step, name="block").files["block.fmu"])
    run = sw.simulate(
        drive,
        sw.scenario.pulse_train(PULSE_SIZE, 2.0 * PULSE_WIDTH, PULSE_WIDTH, RUN_DURATION),
        step,
        sample=COMMUNICATION_STEP,
    )
    jumps = [
        (k * PULSE_WIDTH, PULSE_SIZE * float(after % 2 == 0))
        for k in range(int(RUN_DURATION / PULSE_WIDTH))
        for after in (k - 1, k)
    ]
    signals = np.array([*jumps[1:], (RUN_DURATION, 0.0)], [("time", float), ("command", float)])
    differences = []
    for tolerance in SOLVER_TOLERANCES:
        try:
            found: Any = fmpy.simulate_fmu(
                str(path), fmi_type="ModelExchange", solver="CVode", relative_tolerance=tolerance, stop_time=RUN_DURATION,
                output_interval=COMMUNICATION_STEP, input=signals, output=list(SOLVED_OUTPUTS), record_events=False,
            )  # fmt: skip
        except RuntimeError as error:  # of the solver
            differences.append(f"gave up: {str(error)[-60:]}")
            continue
        shares = [np.abs(found[name] - run[name]).max() / np.abs(run[name]).max() for name in SOLVED_OUTPUTS]
        differences.append(", ".join(f"{share:.1e}" for share in shares))
    return differences


def main() -> None:
    """Print the table."""
    warnings.simplefilter("ignore")
    print("largest difference over the largest value: co-simulation, all outputs; CVODE, output angle and torque")
    for name, drive in five_drives.drives().items():
        step = five_drives.PERIODS[name]
        run = simulated(drive, step)
        for version in (2, 3):
            print(
                f"{name:10}  co-simulation, FMI {version}.0  {difference_of_block(drive, run, step, version):.1e}", flush=True
            )
        with TemporaryDirectory() as folder:
            for tolerance, found in zip(SOLVER_TOLERANCES, differences_of_solver(drive, step, Path(folder)), strict=True):
                print(f"{name:10}  CVODE, {tolerance:.0e}          {found}", flush=True)


if __name__ == "__main__":
    main()
