"""Whole drives as firmware: in double precision they have the bits of the simulation, in single precision its first digits."""

from __future__ import annotations

import subprocess
import warnings
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import strainwave as sw
from five_drives import COMMAND_KNOTS, EXACT_STEP, LOAD_KNOTS, NAMES, PERIODS, drives, quiet
from strainwave.export.firmware import FLAGS
from strainwave.native.static_type import Scalar
from strainwave.simulation.excitation import ROOM_TEMPERATURE

from tests.support.cplusplus import checker
from tests.support.firmware import NO_LIBRARY, Array, Loaded, check_bad_samples, library, written

FLOAT_SHARE = 1e-4  # of the largest value of a signal
# A shaft that has just stopped holds what drives it, which falls fast: there an instant later shows.
FLOAT_SHARES = {("robot", "friction_input"): 2e-4}


def drive_of(name: str, scalar: Scalar) -> sw.Drive:
    drive = drives()[name]
    return drive if scalar == "double" else quiet(drive)


@pytest.fixture(scope="module", params=["double", "float"])
def programs(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> dict[str, Loaded]:
    """Firmware of all drives, in one program."""
    folder, scalar = tmp_path_factory.mktemp("drives"), request.param
    firmware = {
        name: written(drive_of(name, scalar), folder, scalar, name=f"own_{name}", part="drive", period=PERIODS[name])
        for name in NAMES
    }
    shared = library(folder, list(firmware.values()), "-O1", *(["-Wdouble-promotion"] if scalar == "float" else []))
    return {name: Loaded(each, shared) for name, each in firmware.items()}


@cache
def motion(period: float) -> dict[str, Array]:
    """Inputs of all steps, held at their rates within each."""
    time = period * np.arange(round(COMMAND_KNOTS[0][-1] / period) + 1)
    inputs: dict[str, Any] = {"temperature": ROOM_TEMPERATURE}
    for name, (knots, values) in {"command": COMMAND_KNOTS, "load_torque": LOAD_KNOTS}.items():
        rates = np.diff(values) / np.diff(knots)
        inputs[name] = np.interp(time, knots, values)
        inputs[f"{name}_rate"] = rates[np.clip(np.searchsorted(knots, time, side="right") - 1, 0, len(rates) - 1)]
    return inputs


@pytest.mark.slow("export")
@pytest.mark.parametrize("name", NAMES)
def test_firmware_moves_as_simulation(name: str, programs: dict[str, Loaded]) -> None:
    program, period = programs[name], PERIODS[name]
    drive, scalar = drive_of(name, program.firmware.scalar), program.firmware.scalar
    with warnings.catch_warnings(action="ignore"):
        run = sw.simulate(
            drive, sw.scenario.table(*COMMAND_KNOTS), period, sample=period, load_torque=sw.scenario.table(*LOAD_KNOTS)
        )  # fmt: skip
    found = program.run(**motion(period))
    assert set(found) == set(run.names) - {"time", "command"}
    smooth = ~np.isin(run.time, [*COMMAND_KNOTS[0], *LOAD_KNOTS[0]])  # where a rate jumps, the simulation shows what was before
    assert np.ptp(run["output_angle"]) > 0.4
    for output, values in found.items():
        difference = np.abs(values - run[output])[smooth]
        share = 0.0 if scalar == "double" else FLOAT_SHARES.get((name, output), FLOAT_SHARE)
        assert difference.max() <= share * np.abs(run[output]).max(), output


@pytest.mark.slow("export")
@pytest.mark.parametrize("name", NAMES)
def test_a_bad_sample_is_held_and_counted(name: str, programs: dict[str, Loaded]) -> None:
    inputs = {
        each: values[:40] if np.size(values) > 1 else np.full(40, values) for each, values in motion(PERIODS[name]).items()
    }
    check_bad_samples(programs[name], inputs | {"temperature_rate": np.zeros(40)})


@pytest.mark.slow("export")
@pytest.mark.parametrize("name", NAMES)
def test_a_state_that_grows_beyond_all_numbers_begins_anew(name: str, programs: dict[str, Loaded]) -> None:
    """Load torque and temperature of 1e9 count as good, and spoil the state of some drives."""
    program, zeros = programs[name], np.zeros(400)
    run = program.run(temperature=np.where(np.arange(400) == 9, 1e9, ROOM_TEMPERATURE), load_torque=1e9 * (np.arange(400) == 9))
    assert np.isfinite(list(program.state.values())).all()
    rest = program.run(temperature=ROOM_TEMPERATURE + zeros)
    if program.state["bad_samples"]:
        assert run["output_speed"][-1] == rest["output_speed"][-1]


@pytest.mark.slow("export")
def test_headers_of_drives_compile_in_clang(programs: dict[str, Loaded]) -> None:
    folder = next(iter(programs.values())).firmware.header.parent
    subprocess.run([*checker("clang++"), *FLAGS.split(), *NO_LIBRARY, "all.cpp"], cwd=folder, check=True)


@pytest.mark.slow("export")
def test_a_state_goes_on_where_a_copy_was_made(programs: dict[str, Loaded]) -> None:
    """The state in C is all that a drive remembers."""
    program, inputs = (
        programs["staged"],
        {name: np.resize(values, 400) for name, values in motion(EXACT_STEP).items()},
    )
    whole = program.run(**inputs)
    first = {name: values[:150] for name, values in inputs.items()}
    program.run(**first)
    copy = list(program.memory)
    program.run(**inputs)
    program.memory[:] = copy
    rest = program.go_on(**{name: values[150:] for name, values in inputs.items()})
    assert all(np.array_equal(rest[name], whole[name][150:]) for name in whole)


SAMPLED = sw.control.Sampled(law=sw.control.PID(), period=1e-3, delay=1e-4)


@pytest.mark.parametrize(
    ("control", "period", "expected"), [(sw.control.PID(), None, 2e-4), (SAMPLED, None, 1e-4), (SAMPLED, 5e-5, 5e-5)]
)
def test_steps_end_where_the_controller_acts(control: Any, period: float | None, expected: float, tmp_path: Path) -> None:
    firmware = sw.export.firmware(sw.Drive(control=control), tmp_path, part="drive", period=period)
    assert firmware.period == pytest.approx(expected, rel=1e-12)


@pytest.mark.parametrize(
    ("drive", "options", "message"),
    [
        (
            sw.Drive(control=SAMPLED),
            {"part": "drive", "period": 3e-4},
            r"period = 0.0003 s must divide period = 0.001 s and delay",
        ),
        (sw.Drive(control=SAMPLED), {"period": 3e-4}, r"period = 0.0003 s must be drive.control.period, 0.001 s: leave it out"),
        (sw.Drive(), {"part": "gear.structure"}, r'part = "gear.structure" must be one of control, drive, gear.friction_input'),
        (sw.Drive(), {"part": "drive", "period": 0.0}, r"period = 0.0 s must lie in"),
    ],
)
def test_what_has_no_firmware_is_refused_in_one_line(drive: Any, options: dict[str, Any], message: str, tmp_path: Path) -> None:
    with pytest.raises(ValueError, match=message) as refusal:
        sw.export.firmware(drive, tmp_path / "new", **options)
    assert "\n" not in str(refusal.value)
    assert not (tmp_path / "new").exists()


def test_a_controller_in_python_has_no_firmware(tmp_path: Path) -> None:
    with pytest.raises(TypeError, match=r"drive = .* must be a drive, as sw.Drive\(...\) makes one"):
        sw.export.firmware(lambda seen: 0.0, tmp_path, part="drive")  # type: ignore[arg-type]
