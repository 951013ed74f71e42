"""Scenario files: what they say is what runs, in any unit; what is wrong in them is refused with its place."""

from __future__ import annotations

import pickle
import re
from collections.abc import Callable
from math import radians
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import strainwave as sw
from hypothesis import given, strategies as st
from strainwave import scenario
from strainwave.simulation.scenario_file import SIGNAL_KINDS, ScenarioFile

from tests.support.scenarios import RAMP_AND_SINE, TURNED

DRIVE = sw.Drive(control=sw.control.PID(proportional=1.0), load=sw.loads.Inertia(inertia=0.05))
OPEN = DRIVE.replace(control=sw.control.OpenLoop())
HELD = OPEN.replace(load=sw.loads.Prescribed())
BRAKED = OPEN.replace(load=sw.loads.Brake(inertia=0.05))

FULL = (
    RAMP_AND_SINE
    + """[load_torque]
kind = "step"
amplitude = { value = 500.0, unit = "N.cm" }
start = 1.0
"""
    + TURNED
)


def beginning(message: str) -> str:
    return f"^{re.escape(message)}"


def read(folder: Path, text: str, drive: sw.Drive = DRIVE, name: str = "run.toml") -> ScenarioFile:
    path = folder / name
    path.write_text(text)
    return ScenarioFile.read(path, drive)


# What a file says


def test_a_file_with_units_is_the_scenario_in_si(tmp_path: Path) -> None:
    found = read(tmp_path, FULL)
    assert (found.name, found.note) == ("Ramp and push", "as on the rig")
    ramp, sine = scenario.ramp(radians(30.0), 2.0), scenario.sine(radians(2.0), 3.0, 2.0)
    time = np.linspace(0.0, 2.0, 101)
    assert found.command.value(time) == pytest.approx((ramp + sine).value(time), abs=1e-15)
    push = found.inputs["load_torque"]
    assert isinstance(push, scenario.Scenario)
    assert push.value([0.5, 1.5]).tolist() == [0.0, 5.0]
    assert found.inputs["temperature"] == pytest.approx(313.15)
    assert found.initial == {"output_angle": pytest.approx(radians(5.0))}


CONSTANT = {"value": 3.0}
ARGUMENTS: dict[str, dict[str, Any]] = {
    "constant": CONSTANT,
    "step": {"amplitude": 2.0, "start": 0.25},
    "ramp": {"rate": -1.5},
    "sine": {"amplitude": 0.1, "frequency": 2.0, "phase": 0.3, "offset": 1.0},
    "chirp": {"amplitude": 0.1, "start_frequency": 1.0, "stop_frequency": 3.0},
    "pulse_train": {"amplitude": 2.0, "period": 0.5, "width": 0.1, "start": 0.1},
    "table": {"time": [0.0, 0.5, 1.0], "value": [0.0, 2.0, 1.0]},
    "pieces": {"start": [0.0, 0.5], "level": [1.0, 2.0], "slope": [0.0, 3.0], "wave_amplitude": [1.0],
               "wave_frequency": [2.0], "wave_sweep": [0.5], "wave_phase": [0.25]},
}  # fmt: skip


@pytest.mark.parametrize("kind", SIGNAL_KINDS)
def test_each_kind_is_the_function_of_its_name(kind: str, tmp_path: Path) -> None:
    lines = "".join(f"{key} = {value}\n" for key, value in ARGUMENTS[kind].items())
    found = read(tmp_path, f'duration = 1.0\n[command]\nkind = "{kind}"\n{lines}')
    assert found.command == made(kind)


@pytest.mark.parametrize(
    ("drive", "unit", "name"),
    [(DRIVE, "rad", "load_torque"), (OPEN, "V", "load_torque"), (HELD, "V", "output_angle"), (BRAKED, "V", "brake_torque")],
)
def test_a_drive_tells_which_inputs_there_are_and_in_which_unit(drive: sw.Drive, unit: str, name: str, tmp_path: Path) -> None:
    written = f'duration = 1.0\n{name} = 0.5\ncommand = {{ value = 1500.0, unit = "m{unit}" }}'
    found = read(tmp_path, written, drive)
    assert found.command == scenario.constant(1.5, 1.0)
    assert found.inputs == {name: 0.5}


def test_columns_are_joined_by_straight_lines(tmp_path: Path) -> None:
    text = "# title: measured\ntime [ms],command [deg],temperature [degC]\n0,0,20\n500,90,20\n1000,90,40\n"
    found = read(tmp_path, text, name="run.csv")
    assert found.name == "measured"
    assert found.command.value([0.25, 0.75]) == pytest.approx([np.pi / 4.0, np.pi / 2.0])
    warm = found.inputs["temperature"]
    assert isinstance(warm, scenario.Scenario)
    assert float(warm.value(0.75)) == pytest.approx(303.15)
    points = sw.Recording({"time": [0.0, 1.0], "command": [0.0, 2.0]}, {"time": "s", "command": "rad"})
    points.to_parquet(tmp_path / "run.parquet")
    assert ScenarioFile.read(tmp_path / "run.parquet", DRIVE).command == scenario.ramp(2.0, 1.0)


# Running it


def test_it_runs_as_simulate_does_with_the_same_arguments(tmp_path: Path) -> None:
    found = read(tmp_path, FULL.replace("2000", "1100"))
    options: dict[str, Any] = {"inputs": found.inputs, "initial": found.initial, "sample": 1e-2}
    run = found.simulate(DRIVE, 5e-4, sample=1e-2)
    assert run == sw.simulate(DRIVE, found.command, 5e-4, **options)
    assert float(run["output_angle"][0]) == pytest.approx(radians(5.0))
    adaptive = found.simulate_adaptively(DRIVE, 1e-5, sample=1e-2, record=["torque"])
    assert adaptive == sw.simulate_adaptively(DRIVE, found.command, 1e-5, record=["torque"], **options)


def test_without_known_quantities_it_starts_at_rest() -> None:
    command = scenario.step(1.0, 0.05)
    assert ScenarioFile(command).simulate(OPEN) == sw.simulate(OPEN, command)


# Writing it


numbers = st.floats(-1e3, 1e3, allow_subnormal=False).map(lambda x: round(x, 6))
pieces = st.lists(st.tuples(st.floats(0.01, 0.99), numbers, numbers), max_size=3, unique_by=lambda piece: piece[0])
waves = st.lists(st.builds(scenario.Wave, numbers, numbers, st.sampled_from([0.0, 0.5]), numbers), max_size=2)


@st.composite
def signals(draw: Callable[..., Any]) -> scenario.Scenario:
    inner = sorted(draw(pieces))
    line = [(0.0, *draw(st.tuples(numbers, numbers))), *inner]
    start, level, slope = (np.array(column) for column in zip(*line, strict=True))
    return scenario.Scenario(1.0, start, level, slope, tuple(draw(waves)))


def made(kind: str) -> scenario.Scenario:
    return SIGNAL_KINDS[kind](**ARGUMENTS[kind], **({} if kind == "table" else {"duration": 1.0}))


KNOWN = signals() | st.sampled_from([made(kind) for kind in SIGNAL_KINDS])


@given(KNOWN, KNOWN | numbers, st.text(st.characters(categories=["L", "P"]), max_size=8))
def test_what_is_saved_is_read_back_equal(
    tmp_path_factory: pytest.TempPathFactory, command: scenario.Scenario, load: scenario.Scenario | float, name: str
) -> None:
    path = tmp_path_factory.mktemp("scenario") / "saved.toml"
    written = ScenarioFile(command, {"load_torque": load, "temperature": 310.0}, {"input_speed": 2.0}, name, note="two\nlines")
    written.save(path, DRIVE)
    assert ScenarioFile.read(path, DRIVE) == written


@pytest.mark.parametrize("kind", ["constant", "step", "ramp", "sine", "chirp"])
def test_what_a_kind_can_say_is_saved_as_this_kind(kind: str, tmp_path: Path) -> None:
    given = {key: value for key, value in ARGUMENTS[kind].items() if key != "offset"}
    ScenarioFile(SIGNAL_KINDS[kind](**given, duration=1.0)).save(tmp_path / "saved.toml", OPEN)
    text = (tmp_path / "saved.toml").read_text()
    assert f'kind = "{kind}"' in text
    assert "pieces" not in text
    assert 'unit = "V' in text


def test_a_file_saved_for_one_drive_is_refused_by_one_that_takes_something_else(tmp_path: Path) -> None:
    ScenarioFile(scenario.step(1.0, 1.0, start=0.5)).save(tmp_path / "saved.toml", OPEN)
    with pytest.raises(ValueError, match=r'command\.amplitude: cannot convert "V" to "rad"; this drive takes rad$'):
        ScenarioFile.read(tmp_path / "saved.toml", DRIVE)
    with pytest.raises(ValueError, match=beginning('"load_torque" is not known; there are output_angle, temperature')):
        ScenarioFile(scenario.step(1.0, 1.0), {"load_torque": 1.0}).save(tmp_path / "other.toml", HELD)
    with pytest.raises(ValueError, match=r"saved\.csv: a scenario is written to a file that ends in \.toml$"):
        ScenarioFile(scenario.step(1.0, 1.0)).save(tmp_path / "saved.csv", OPEN)
    assert [path.name for path in tmp_path.iterdir()] == ["saved.toml"]


def test_it_is_frozen_and_survives_pickling() -> None:
    one = ScenarioFile(scenario.step(1.0, 1.0), {"load_torque": 1.0}, {"twist": 0.0}, "a", "b")
    assert pickle.loads(pickle.dumps(one)) == one
    with pytest.raises(TypeError, match="does not support item assignment"):
        one.inputs["load_torque"] = 2.0  # type: ignore[index]


# What is refused

LASTING = "duration = 1.0\n"
STEP = LASTING + '[command]\nkind = "step"\n'
SUM = LASTING + 'command = 1.0\n[[temperature]]\nkind = "constant"\nvalue = { value = 20, unit = "degC" }\n[[temperature]]\n'


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "is empty"),
        ("duration", "is not valid TOML: Expected '=' after a key in a key/value pair (at end of document)"),
        ("command = 1", "duration is missing; write duration = 2.0, in s"),
        (LASTING, 'command is missing; write [command] with kind = "constant" or "step" or'),
        (LASTING + "comand = 1.0", '"comand" is not known; near it is command; there are name, note, duration, command,'),
        (LASTING + "command = 1.0\noutput_angle = 1.0", '"output_angle" is not known; there are name, note'),
        (LASTING + '[command]\nkind = "stp"', "command.kind = 'stp' is not known; near it is step; write kind = \"constant\""),
        (LASTING + "[command]\namplitude = 1.0", 'command.kind is missing; write kind = "constant" or'),
        (LASTING + "[command]\nkind = 3", "command.kind = 3 is not known; write kind ="),
        (STEP, "command.amplitude is missing; step needs amplitude"),
        (STEP + "amplitud = 3.0", 'command: step: "amplitud" is not known; near it is amplitude; there are amplitude, start'),
        (STEP + "amplitude = 1.0\nduration = 1.0", 'command: step: "duration" is not known; there are amplitude, start'),
        (STEP + "amplitude = [1.0, 2.0]", "command: step.amplitude must be a number, not [1.0, 2.0]"),
        (STEP + "amplitude = 1.0\nstart = 5.0", "command: step.start = 5.0 s must lie in [0, 1)"),
        (STEP + 'amplitude = { value = 1.0, unit = "V" }', 'command.amplitude: cannot convert "V" to "rad"; this drive'),
        (STEP + 'amplitude = { value = 1.0, unit = "dg" }', 'command.amplitude: unit "dg" is not known; write it like'),
        (STEP + "amplitude = { value = 1.0 }", 'command.amplitude.unit is missing; write { value = 5.0, unit = "deg" }'),
        (STEP + 'amplitude = { value = 1.0, unit = "rad", source = "x" }',
         'command.amplitude: "source" is not known; there are value, unit'),
        (STEP + 'amplitude = "high"', 'command.amplitude = "high" must be a number and its unit, as "1.2 rad"'),
        (STEP + 'amplitude = "5 V"',
         'command.amplitude: cannot convert "V" to "rad"; write a number and its unit, as "1.2 rad"'),
        (STEP + "amplitude = nan", "command.amplitude = nan rad must be finite"),
        (STEP + "amplitude = true", "command.amplitude must be a number, not True"),
        (LASTING + "command = []", 'command is empty; write [command] with kind = "constant"'),
        (LASTING + "command = [1.0]", 'command = 1.0 must be a table with kind = "constant"'),
        (LASTING + "command = 1979-05-27", "command must be a number, not datetime.date(1979, 5, 27)"),
        ("duration = -1\ncommand = 1.0", "duration = -1.0 s must lie in (0, inf)"),
        ("duration = { value = 1, unit = 'm' }\ncommand = 1.0", 'duration: cannot convert "m" to "s"'),
        (LASTING + "[command]\nkind = 'table'\ntime = [0, 2]\nvalue = [0, 1]", "command lasts 2 s, the scenario 1 s; both"),
        (LASTING + "[command]\nkind = 'table'\ntime = [0, 1]\nvalue = [0, 1, 2]", 'command: column "value" has 3 samples'),
        (LASTING + "[command]\nkind = 'pieces'\nstart = [0.0]\nlevel = [1.0]\nslope = [0.0]\nwave_phase = [1.0]",
         "command: wave_amplitude, wave_frequency, wave_sweep and wave_phase must be lists of equally many"),
        (LASTING + "command = 1.0\nload_torque = { value = 3.0, unit = 'N' }", 'load_torque: cannot convert "N" to "N.m"'),
        (LASTING + "command = 1.0\ninitial = 3", "initial = 3 must be a table; write [initial] with output_angle ="),
        (LASTING + "command = 1.0\n[initial]\ninput_angel = 1.0", 'initial: "input_angel" is not known; near it is'),
        (LASTING + "command = 1.0\n[initial]\ntwist = [1.0]", "initial.twist = [1.0] must be one number"),
        (LASTING + "command = 1.0\nname = 3", "name must be a text, not 3"),
        (LASTING + 'command = 1.0\nname = "two\\nlines"', "name = 'two\\nlines' must be one line of text"),
        (SUM + 'kind = "step"\namplitude = { value = 20, unit = "degC" }',
         "temperature[1].amplitude: what is added is a difference; degC has a zero of its own, so write K"),
        (LASTING + 'command = 1.0\n[temperature]\nkind = "step"\namplitude = { value = 20, unit = "degC" }',
         "temperature.amplitude: what is added is a difference; degC has a zero of its own, so write K"),
        (SUM + 'kind = "constant"\nvalue = { value = 20, unit = "degC" }', "temperature[1].value: what is added is a"),
        (LASTING + '"\\u001b[31mred" = 1', '"\\x1b[31mred" is not known'),
    ],
)  # fmt: skip
def test_what_is_wrong_in_a_file_is_refused_with_its_place(text: str, message: str, tmp_path: Path) -> None:
    with pytest.raises(ValueError, match=beginning(f"{tmp_path / 'run.toml'} {message}")) as error:
        read(tmp_path, text)
    assert str(error.value).isprintable()


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "is empty"),
        ("time [s],comand [rad]\n0,0\n1,1\n", "has no column command; it has time, comand"),
        ("t [s],command [rad]\n0,0\n1,1\n", "has no column time; it has t, command"),
        ("time [s],command [rad],torque [N.m]\n0,0,0\n1,1,0\n", 'column "torque" is not known; near it is load_torque;'),
        ("time [s],command [V]\n0,0\n1,1\n", 'column command: cannot convert "V" to "rad"; this drive takes rad'),
        ("time [s],command [rad]\n0.5,0\n1,1\n", "column command: table.time begins at 0.5 s; it must begin at 0 s"),
        ("time [s],command [rad]\n0,0\n", "column command: table.time holds 1 time; at least 2 are needed"),
        ("time [s],command [rad]\n0,0\n1,nan\n", 'line 3, column "command": nan is not finite'),
    ],
)  # fmt: skip
def test_what_is_wrong_in_a_table_is_refused_with_its_place(text: str, message: str, tmp_path: Path) -> None:
    with pytest.raises(ValueError, match=beginning(f"{tmp_path / 'run.csv'} {message}")):
        read(tmp_path, text, name="run.csv")


@pytest.mark.parametrize("name", ["none.toml", "none.csv", "none.xyz"])
def test_a_file_that_is_not_there_is_refused(name: str, tmp_path: Path) -> None:
    with pytest.raises((ValueError, OSError), match=name):
        ScenarioFile.read(tmp_path / name, DRIVE)


@pytest.mark.parametrize(
    ("attempt", "message"),
    [
        (lambda: ScenarioFile(1.0), "command = 1.0 must be a Scenario"),
        (lambda: ScenarioFile(scenario.step(1.0, 1.0), 3), "inputs must be a mapping"),
        (lambda: ScenarioFile(scenario.step(1.0, 1.0), {"load_torque": "x"}), "load_torque must be a number, not 'x'"),
        (lambda: ScenarioFile(scenario.step(1.0, 1.0), {"load_torque": scenario.step(1.0, 2.0)}), "load_torque lasts 2 s, the"),
        (lambda: ScenarioFile(scenario.step(1.0, 1.0), {}, {"x": 1.0}), 'the name of a quantity in initial = "x" must'),
        (lambda: ScenarioFile(scenario.step(1.0, 1.0), name="\n"), "name = '\\n' must be one line"),
        (lambda: ScenarioFile(scenario.step(1.0, 1.0), note=3), "note must be a text, not 3"),
        (lambda: ScenarioFile.read("x.toml", 3), "drive = 3 must be a drive"),
    ],
)  # fmt: skip
def test_what_is_no_scenario_is_refused(attempt: Callable[[], Any], message: str) -> None:
    with pytest.raises((ValueError, TypeError), match=beginning(message)):
        attempt()
