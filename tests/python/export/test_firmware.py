"""Exported controllers compile for firmware, and do the same as in the simulation: with the same bits in double precision."""

from __future__ import annotations

import re
import subprocess
from collections.abc import Iterable, Iterator, Sequence
from datetime import UTC, datetime, timedelta
from hashlib import sha256
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import strainwave as sw
from strainwave import _core
from strainwave.export.firmware import FLAGS, microcontroller
from strainwave.native.static_type import Scalar, parameters
from strainwave.simulation.controller import Observation

from tests.realtime.test_firmware import CORTEX, LIBM, printed, undefined
from tests.support.cplusplus import compiler, zig
from tests.support.firmware import STRICT, Loaded, check_bad_samples, compiled, library, run_with, written
from tests.support.strategies import made, suited

PERIOD = 1e-3  # s
COMMAND = sw.scenario.sine(amplitude=0.3, frequency=0.7, duration=2.0)
INERTIA = 8e-5  # kg.m2, at the input
LAW = sw.control.PositionSpeed(
    position_gain=30.0, speed_proportional=0.02, speed_integral=0.3, speed_feedforward=1.0, limit=2.0
)
FRICTION = sw.friction.LuGre(
    coulomb=0.03, breakaway=0.045, stribeck_speed=2.0, bristle_stiffness=50.0, bristle_damping=1e-3, viscous=1e-3
)
ERROR = sw.kinematic_error.Fourier(order=[1, 2, 2.5], amplitude=[1e-4, 3e-4, 1e-5], phase=[0.0, 0.5, 1.0])
GEAR = sw.load("csg-20-100").replace(friction_input=FRICTION, kinematic_error=ERROR)
LOAD = sw.loads.Pendulum(inertia=0.5, gravity_torque=10.0)
OBSERVER = sw.compensation.DisturbanceObserver(inertia=INERTIA, limit=0.5)
FEEDFORWARD = sw.compensation.ModelFeedforward(gear=GEAR, load=LOAD, motor_inertia=2e-5)


def drive(law: Any = LAW, delay: float = 0.0, motor: Any = None, **compensation: Any) -> sw.Drive:
    control = sw.control.Sampled(law=law, period=PERIOD, delay=delay, compensation=sw.Compensation(**compensation))
    return sw.Drive(gear=GEAR, load=LOAD, motor=motor or sw.motor.TorqueSource(inertia=2e-5), control=control)


JOINT = sw.Drive(gear=GEAR, load=LOAD, motor=sw.motor.TorqueSource(inertia=2e-5))
DC = sw.motor.DC(resistance=0.5, torque_constant=0.08, back_emf=0.08, inertia=2e-5)
DRIVES = {
    "model": drive(feedforward=FEEDFORWARD, observer=OBSERVER),
    "delay": drive(delay=3e-4, feedforward=FEEDFORWARD),
    "whole_period": drive(delay=PERIOD, observer=OBSERVER),
    "fourier": drive(learning=sw.compensation.AdaptiveFourier(order=[1, 2.5], max_frequency=300.0)),
    "table": drive(
        feedforward=FEEDFORWARD, learning=sw.compensation.Repetitive(), observer=made(sw.compensation.FrictionScale)
    ),
    "map": drive(feedforward=sw.compensation.LostMotionMap(angle=[0.0, 0.1], forward=[1e-4, 2e-4], backward=[-1e-4, 0.0])),
    "bristles": drive(
        feedforward=FEEDFORWARD,
        observer=sw.compensation.BristleObserver(friction=FRICTION, friction_share=0.9, bristle_gain=0.3, gain=2.0),
        dither=sw.compensation.Dither(amplitude=0.01, frequency=80.0),
    ),
    "passes": drive(learning=sw.compensation.IterativeLearning(low=-0.1, high=0.1, gain=20.0)),
    "twist": drive(feedforward=FEEDFORWARD, learning=sw.compensation.TwistIdentification(order=[1, 2])),
    "lags": drive(law=sw.control.LeadLag(gain=1.0, lead_numerator=0.03, lead_denominator=0.002, lag_denominator=2.0), motor=DC),
    "kalman": drive(law=sw.tuning.lqg(JOINT, error=1e-3, encoder="input")),
    "linearised": drive(
        law=sw.control.FeedbackLinearisation(gear=GEAR, load=LOAD, motor_inertia=2e-5, bandwidth=60.0, limit=2.0),
        observer=OBSERVER,
    ),
    "tracking": drive(
        law=sw.control.KinematicErrorTracking(gear=GEAR, load=LOAD, motor_inertia=2e-5, speed_gain=0.01, limit=2.0),
        observer=OBSERVER,
    ),
    "currents": drive(law=made(sw.control.Cascade), motor=DC.replace(inductance=5e-4)),
}


PLACES = ("feedforward", "learning", "observer", "dither")


def programs(folder: Path, scalar: Scalar, names: Iterable[str]) -> dict[str, Loaded]:
    """Return firmware of some drives, in one program."""
    firmware = {name: written(DRIVES[name], folder, scalar, name=f"own_{name}") for name in names}
    shared = library(folder, list(firmware.values()), "-O0", *(["-Wdouble-promotion"] if scalar == "float" else []))
    return {name: Loaded(each, shared) for name, each in firmware.items()}


@pytest.fixture(scope="module")
def doubled(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Loaded]:
    return programs(tmp_path_factory.mktemp("double"), "double", DRIVES)


@pytest.fixture(scope="module")
def single(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Loaded]:
    return programs(tmp_path_factory.mktemp("float"), "float", FLOAT_SHARES)


@pytest.mark.whole_path("export")
@pytest.mark.parametrize("name", DRIVES)
def test_a_run_with_the_firmware_has_the_bits_of_the_simulation(name: str, doubled: dict[str, Loaded]) -> None:
    firmware, simulated = doubled[name], sw.simulate(DRIVES[name], COMMAND, sample=PERIOD)
    firmware.start()
    run = run_with(firmware, DRIVES[name], COMMAND)
    assert [column for column in simulated.names if not np.array_equal(run[column], simulated[column])] == []


@pytest.mark.parametrize(("place", "model"), [(place, name) for place in PLACES for name in _core.families[place]])
def test_every_compensator_is_among_these_drives(place: str, model: str) -> None:
    """Each takes part: without it the run is another one."""
    kind, (absent, *_) = _core.families[place][model], _core.families[place].values()
    with_it = [each for each in DRIVES.values() if type(getattr(each.control.compensation, place)) is kind]  # type: ignore[union-attr]
    assert with_it
    if kind is not absent:
        runs = [sw.simulate(each, COMMAND, sample=PERIOD) for each in (with_it[0], without(with_it[0], place, absent()))]
        assert not np.array_equal(runs[0]["output_angle"], runs[1]["output_angle"])


def without(chosen: sw.Drive, place: str, absent: Any) -> sw.Drive:
    control: Any = chosen.control
    return chosen.replace(control=control.replace(compensation=control.compensation.replace(**{place: absent})))


# Error of single precision over the largest actuation, as the page on firmware states it.
FLOAT_SHARES = {
    "model": 1e-4,
    "fourier": 1e-4,
    "table": 1e-4,
    "bristles": 1e-4,
    "tracking": 1e-4,
    "linearised": 2e-4,
    "kalman": 3e-3,
}
LIMIT = 1.5  # of the amplifier, in the motor's unit
CLOSED_LOOP_ERROR = 1e-7  # rad of the output, between the runs under both


@pytest.mark.whole_path("export")
@pytest.mark.parametrize("name", FLOAT_SHARES)
def test_single_precision_is_as_accurate_as_stated(name: str, doubled: dict[str, Loaded], single: dict[str, Loaded]) -> None:
    chosen, exact, rounded = DRIVES[name], doubled[name], single[name]
    exact.start()
    rounded.start()
    errors = list[float]()

    def both(seen: Observation) -> float:
        given = exact(seen)
        errors.append(abs(given - rounded(seen)))
        return given

    by_double = run_with(both, chosen, COMMAND)
    assert max(errors) < FLOAT_SHARES[name] * chosen.control.law.limit  # type: ignore[union-attr]
    if chosen.control.law == LAW:  # type: ignore[union-attr]
        rounded.start()
        by_single = run_with(rounded, chosen, COMMAND)
        assert np.max(np.abs(by_single["output_angle"] - by_double["output_angle"])) < CLOSED_LOOP_ERROR


def moved(firmware: Loaded) -> dict[str, np.ndarray]:
    """Return inputs of a controller along a motion, of about the size of a joint's, with limits that are met."""
    time, ratio = PERIOD * np.arange(60), GEAR.kinematics.ratio
    scale = {"input_angle": 0.3 * ratio, "input_speed": 0.3 * ratio}
    inputs = {name: scale.get(name, 0.3) * np.sin(40.0 * time + 0.01 * i) for i, name in enumerate(firmware.firmware.inputs)}
    return inputs | {"low": np.full(60, -LIMIT), "high": np.full(60, LIMIT)}


@pytest.mark.whole_path("export")
@pytest.mark.parametrize("name", FLOAT_SHARES)
def test_a_bad_sample_is_held_and_counted(name: str, single: dict[str, Loaded]) -> None:
    check_bad_samples(single[name], moved(single[name]), LIMIT)


@pytest.mark.whole_path("export")
def test_limits_that_cross_are_held(single: dict[str, Loaded]) -> None:
    inputs = moved(single["model"])
    expected = single["model"].run(**inputs)["motor_torque"]
    inputs["low"][7], inputs["high"][9] = LIMIT + 1.0, -LIMIT - 1.0
    assert np.array_equal(single["model"].run(**inputs)["motor_torque"], expected)
    assert single["model"].state["bad_samples"] == 2


@pytest.mark.parametrize(
    "statement",
    [
        FLAGS,
        "less than 1e-4 of the limit",
        "less than 1e-7 rad",
        "2e-4 of the limit with `FeedbackLinearisation`",
        "3e-3 with the Kalman",
    ],
)
def test_the_page_states_these_numbers(statement: str) -> None:
    page = Path(__file__).parents[3] / "docs" / "how-to" / "firmware.md"
    assert statement in " ".join(page.read_text(encoding="utf-8").split())


def every_controller() -> Iterator[sw.Drive]:
    """Yield drives that hold every law, compensator and law of a compensated gear between them."""
    motor, model = DC.replace(inductance=1e-4), sw.compensation.ModelFeedforward
    loads = [each for each in models(model, "load") if each is not sw.loads.Prescribed]  # which needs no torque
    feedforwards = [each for each in models(sw.Compensation, "feedforward") if each is not model]
    for number in range(len(feedforwards) + max(map(len, _core.families.values()))):
        law = one_of(sw.control.Sampled, "law", number)
        if _core.command_unit(sw.Drive(control=sw.control.Sampled(law=law))) != "rad":
            yield drive(law, motor=motor)
            law = LAW
        gear = GEAR
        for ahead, place in enumerate(parameters(sw.Gear)):
            if place not in ("kinematics", "structure"):
                gear = gear.replace(**{place: suited(one_of(sw.Gear, place, number + ahead), gear.kinematics)})
        whole = model(gear=gear, load=made(loads[number % len(loads)]), rounds=0)
        feedforward = made(feedforwards[number]) if number < len(feedforwards) else whole
        others = {place: one_of(sw.Compensation, place, number) for place in ("learning", "observer", "dither")}
        yield drive(law, motor=motor, feedforward=feedforward, **others)


def models(kind: Any, place: str) -> list[Any]:
    """The models that may stand at a place."""
    (field,) = (field for field in kind.fields if field["name"] == place)
    return list(field["options"].values()) if field["options"] else [type(field["default"])]


def one_of(kind: Any, place: str, number: int) -> Any:
    """The model of this number that may stand at a place, round and round."""
    return made(models(kind, place)[number % len(models(kind, place))])


def compile_strictly(command: Sequence[str], folder: Path, source: str, *options: str) -> None:
    subprocess.run([*command, *options, *STRICT, "-c", source], cwd=folder, check=True)


@pytest.mark.slow("export")
def test_every_law_compiles_and_asks_for_mathematics_and_nothing_else(tmp_path: Path) -> None:
    """No heap, no exception, no initialisation; all numbers are constants, and no variable outlives a step."""
    firmware = [written(each, tmp_path, "float", name=f"c{number}") for number, each in enumerate(every_controller())]
    compiled(tmp_path, firmware, "-O0", "-Wdouble-promotion")
    assert undefined(tmp_path) <= LIBM
    assert not [line for line in printed("nm", *tmp_path.glob("*.o")) if line.split()[-2:-1] in (["b"], ["B"], ["d"], ["D"])]


@pytest.mark.slow("export")
def test_every_law_and_compensator_holds_bad_samples(tmp_path: Path) -> None:
    firmware = [written(each, tmp_path, "float", name=f"c{number}") for number, each in enumerate(every_controller())]
    shared = library(tmp_path, firmware, "-O0")
    for each in firmware:
        program = Loaded(each, shared)
        check_bad_samples(program, moved(program), LIMIT)


def test_a_microcontroller_computes_in_single_precision_throughout(tmp_path: Path) -> None:
    """Clang copies and clears a state by calling memcpy and memset, which every freestanding environment has to provide."""
    sw.export.firmware(DRIVES["model"], tmp_path)
    compile_strictly(zig(), tmp_path, "controller.cpp", *FLAGS.split(), *CORTEX, "-Wdouble-promotion")
    assert undefined(tmp_path) <= LIBM | {"memcpy", "memset"}


def test_every_file_states_the_gear_its_file_and_the_day(tmp_path: Path) -> None:
    joint = sw.GearSet.read("robot-joint")
    written = sw.export.firmware(joint, tmp_path / "firmware")
    joint.save(tmp_path / "gear.toml")
    digest = sha256((tmp_path / "gear.toml").read_bytes()).hexdigest()
    days = {f"{datetime.now(UTC) - timedelta(minutes=back):%Y-%m-%d}" for back in (0, 5)}
    for path in (written.header, written.declarations, written.source, written.example):
        first, second, *_ = path.read_text().splitlines()
        assert first.removeprefix("// Written on ")[:10] in days
        assert first.endswith("of Robot joint")
        assert second.endswith(f" {digest}")
    sw.export.firmware(DRIVES["model"], tmp_path / "other")
    assert (tmp_path / "other" / "controller.h").read_text().splitlines()[0].endswith("of a drive made in Python")


@pytest.mark.parametrize("part", ["control", "gear.friction_input"])
def test_the_example_is_in_c_and_calls_the_step_in_the_interrupt(part: str, tmp_path: Path) -> None:
    written = sw.export.firmware(DRIVES["model"], tmp_path, name="joint", part=part)
    compile_strictly(compiler("gcc"), tmp_path, written.example.name, "-std=c99")
    assert undefined(tmp_path) == {"joint_start", "joint_step"}


@pytest.mark.slow("export")
def test_a_report_counts_bytes_and_instructions() -> None:
    if missing := microcontroller.missing_programs():
        pytest.skip(f"{', '.join(missing)} is not installed")
    lines = list(microcontroller.report(sw.GearSet.read("csg-20-100"), "gear.stiffness", "float", None))
    sizes, counts = ([int(each) for each in re.findall(r"\b\d+\b", line)] for line in lines[:2])
    assert sizes[1] == 8  # two floats
    assert 100 < sizes[0] < 1000
    assert 30 < counts[0] <= counts[1] < 300


def test_a_report_without_its_programs_names_them(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(microcontroller.shutil, "which", lambda program: None)
    (line,) = microcontroller.report(DRIVES["model"], "control", "float", None)
    assert "not measured, as qemu-system-arm, arm-none-eabi-gcc" in line


def test_the_header_is_in_c(tmp_path: Path) -> None:
    sw.export.firmware(DRIVES["model"], tmp_path, name="joint")
    (tmp_path / "main.c").write_text(
        '#include "joint.h"\n'
        "int main(void) { joint_state x; joint_inputs in = {0}; joint_start(&x); "
        "return joint_step(&x, &in).motor_torque > 1; }\n"
    )
    compile_strictly(compiler("gcc"), tmp_path, "main.c", "-std=c99")
    header = (tmp_path / "joint.h").read_text()
    assert "    float compensation_feedforward_gear_hysteresis_torque[16];  /* N.m */\n" in header
    assert "    float motor_torque;  /* N.m; for the motor, within [low, high] */\n" in header


@pytest.mark.whole_path("export")
def test_the_state_has_the_names_and_numbers_of_the_simulated_controller(doubled: dict[str, Loaded]) -> None:
    chosen = DRIVES["model"]
    firmware, simulated = doubled["model"], sw.simulate(chosen, COMMAND, sample=PERIOD)
    firmware.start()
    run_with(firmware, chosen, COMMAND)
    numbers = dict(zip((name for name, *_ in _core.state(chosen)[0]), simulated.end.numbers, strict=True))
    of_control = [value for name, value in numbers.items() if name.startswith("control.")]
    numbers_in_c = list(firmware.state.values())
    assert numbers_in_c[: len(of_control) - 1] == of_control[:-1]  # the last is the time to the next sample


@pytest.mark.parametrize(
    ("changed", "error", "message"),
    [
        ({"drive": drive().replace(control=LAW)}, TypeError, "drive.control = <PositionSpeed"),
        ({"drive": LAW}, TypeError, "drive = <PositionSpeed> must be a drive"),
        ({"name": "2nd"}, ValueError, 'name = "2nd" must be a name in C'),
        ({"name": "float"}, ValueError, 'name = "float" must be a name in C'),
        ({"scalar": "half"}, ValueError, 'scalar = "half" must be one of double, float'),
        (
            {"drive": drive(LAW.replace(speed_limit=1e300))},
            ValueError,
            r"law.speed_limit = 1e\+300 is too large",
        ),
    ],
)
def test_a_wrong_argument_is_refused_in_one_line(
    changed: dict[str, Any], error: type[Exception], message: str, tmp_path: Path
) -> None:
    given = {"drive": DRIVES["model"], "folder": tmp_path / "new"} | changed
    with pytest.raises(error, match=message):
        sw.export.firmware(**given)
    assert not (tmp_path / "new").exists()
