"""FMUs of drives, run by FMPy, against the simulation of the drives."""

import ctypes
import re
import subprocess
import zipfile
from contextlib import ExitStack, contextmanager
from dataclasses import replace
from functools import cache
from importlib import resources
from io import BytesIO
from pathlib import Path

import numpy as np
import pytest
import strainwave as sw
from strainwave import parameters
from strainwave.export.fmu import build
from strainwave.export.fmu.source import STEP_NAME, recorded, variables
from strainwave.export.host import default_step
from strainwave.files.units import convert
from strainwave.native.compilers import NoCompilerError
from typer.testing import CliRunner

fmpy = pytest.importorskip("fmpy")
fmi1, fmi2, fmi3 = (pytest.importorskip(f"fmpy.fmi{version}") for version in (1, 2, 3))
validation = pytest.importorskip("fmpy.validation")
etree = pytest.importorskip("lxml.etree")
pytestmark = pytest.mark.usefixtures("kept_builds")

DRIVES = {2: "robot-joint", 3: "tilt-actuator-lumped"}  # one for each version of FMI: a compilation takes some seconds
STEP = 2e-4  # s
COMMUNICATION = 1e-3  # s
DURATION = 2.0  # s
CHAINED = 500  # communication steps of chained runs
ROUNDING_OF_TIME = 1e-11  # an instant of 2 s is rounded by 2e-16 s, which is 1e-12 of an internal step
TOLERANCES = (1e-4, 1e-5, 1e-6)  # of the solver
PRESCRIBED = sw.Drive(load=sw.loads.Prescribed())
BASE_UNITS = ("kg", "m", "s", "A", "K", "mol", "cd", "rad")


@cache
def drive_of(version):
    return sw.GearSet.read(DRIVES[version]).drive


@cache
def exported(version):
    return sw.export.fmu(sw.GearSet.read(DRIVES[version]), version=version, name="block")


def content_of(version):
    return exported(version).files["block.fmu"]


def opened(version, stack):
    """A new instance of the FMU of a version, and the outputs of its drive by name."""
    drive = drive_of(version)
    found = variables(drive, STEP)
    return stack.enter_context(build.instance(content_of(version), found, version)), recorded(drive, found)


@cache
def motion():
    """Knots of a command that follows a sine, and of a load that jumps at half time."""
    time = np.linspace(0.0, DURATION, round(DURATION / COMMUNICATION) + 1)
    return time, 0.2 * np.sin(2.0 * np.pi * 1.5 * time), np.where(time < 0.5 * DURATION, 0.0, 1.5)


def inputs_at(k):
    time, command, load = motion()
    rate = (command[k + 1] - command[k]) / (time[k + 1] - time[k])
    return {"command": command[k], "command_rate": rate, "load_torque": load[k]}


def driven(block, outputs, first, last):
    """Outputs at the ends of the communication steps from number `first` to `last`."""
    rows = []
    for k in range(first, last):
        block.set(inputs_at(k))
        block.step(k * COMMUNICATION, COMMUNICATION)
        rows.append(block.get(outputs))
    return np.array(rows)


@pytest.mark.whole_path("export")
@pytest.mark.parametrize("version", DRIVES)
def test_block_moves_as_simulation(version):
    """Chained runs count their time as the block does; the instants of one long run are rounded differently."""
    time, command, load = motion()
    knots = sw.scenario.table(time, command)
    jump = sw.scenario.step(1.5, DURATION, start=0.5 * DURATION)
    run = sw.simulate(drive_of(version), knots, STEP, sample=COMMUNICATION, load_torque=jump)
    with ExitStack() as stack:
        block, outputs = opened(version, stack)
        block.start(inputs_at(0))
        found = np.vstack([block.get(list(outputs)), driven(block, list(outputs), 0, len(time) - 1)])
    assert np.ptp(run["output_angle"]) > 0.3
    chained = {output.name: [run[output.name][0]] for output in outputs.values()}
    state = None
    for k in range(CHAINED):
        piece = sw.scenario.table([0.0, COMMUNICATION], command[k : k + 2])
        part = sw.simulate(drive_of(version), piece, STEP, sample=COMMUNICATION, load_torque=float(load[k]), initial=state)
        state = part.end
        for name, values in chained.items():
            values.append(part[name][-1])
    for (name, output), column in zip(outputs.items(), found.T, strict=True):
        for expected, tolerance in ((run[output.name], ROUNDING_OF_TIME), (np.array(chained[output.name]), 1e-12)):
            difference = np.abs(column[: len(expected)] - expected)
            assert difference.max() <= tolerance * np.abs(expected).max(), name


def test_fmpy_runs_it_by_default_settings(tmp_path):
    path = tmp_path / "block.fmu"
    path.write_bytes(content_of(3))
    result = fmpy.simulate_fmu(str(path), stop_time=0.5, start_values={"command": 0.1}, output=["output_angle"])
    run = sw.simulate(drive_of(3), sw.scenario.constant(0.1, 0.5), STEP)
    assert result["output_angle"][-1] == pytest.approx(run["output_angle"][-1], rel=1e-12)


def error_of_samples(communication):
    """Largest error of the output angle, over its range, of a block that gets samples of a sine and no rate."""
    steps = round(0.5 / communication)
    run = sw.simulate(drive_of(2), sw.scenario.sine(0.2, 1.5, 0.5), STEP, sample=communication)
    angles = [run["output_angle"][0]]
    with ExitStack() as stack:
        block, _ = opened(2, stack)
        block.start({"command": 0.0})
        for k in range(steps):
            block.set({"command": 0.2 * np.sin(2.0 * np.pi * 1.5 * k * communication)})
            block.step(k * communication, communication)
            angles += block.get(["output_angle"])
    return np.abs(np.array(angles) - run["output_angle"]).max() / np.ptp(run["output_angle"])


@pytest.mark.slow("export")
def test_error_of_a_command_without_rate_is_of_first_order_in_the_communication_step():
    """The cascade of this drive feeds the commanded speed forward: at a rate of 0 the error is 0.26 at every step."""
    errors = [error_of_samples(communication) for communication in (4e-3, 2e-3, 1e-3)]
    assert errors[0] < 0.03
    assert np.log2(errors[:-1]) - np.log2(errors[1:]) == pytest.approx([1.0, 1.0], abs=0.1)


@pytest.mark.parametrize("length", [-1e-3, 1e300, float("inf"), float("nan")])
def test_a_step_of_no_length_that_ends_is_an_error(length, capfd):
    with ExitStack() as stack:
        block, _ = opened(2, stack)
        block.start({"command": 0.1})
        with pytest.raises(fmi1.FMICallException):
            block.step(0.0, length)
    assert "must lie within [0, 20000] s" in capfd.readouterr().out


@cache
def exchanged(version, name=None):
    """The content of an FMU for model exchange."""
    found = sw.export.fmu(sw.GearSet.read(name or DRIVES[version]), version=version, model_exchange=True, name="block")
    return found.files["block.fmu"]


@contextmanager
def solved(version, folder):
    """An instance for model exchange after its initialisation, and the description of its FMU."""
    fmpy.extract(BytesIO(exchanged(version)), unzipdir=folder)
    about = fmpy.read_model_description(str(folder / "modelDescription.xml"))
    model = {2: fmi2.FMU2Model, 3: fmi3.FMU3Model}[version](
        guid=about.guid, unzipDirectory=str(folder), modelIdentifier=about.modelExchange.modelIdentifier, instanceName="block"
    )
    model.instantiate()
    if version == 2:
        model.setupExperiment(startTime=0.0)
    model.enterInitializationMode()
    model.exitInitializationMode()
    model.enterContinuousTimeMode()
    yield model, about
    model.terminate()
    model.freeInstance()


@pytest.mark.slow("export")
@pytest.mark.parametrize("version", DRIVES)
def test_directional_derivatives_are_those_of_differences(version, tmp_path):
    """At a state in motion, by states and inputs together, in random directions."""
    with solved(version, tmp_path) as (model, about):
        derivatives = [each.variable for each in about.derivatives]
        states = [each.derivative for each in derivatives]
        inputs = [each for each in about.modelVariables if each.causality == "input"]
        knowns = [each.valueReference for each in (*states, *inputs)]
        unknowns = [each.valueReference for each in (*derivatives, *(each.variable for each in about.outputs))]
        read = model.getReal if version == 2 else model.getFloat64
        write = model.setReal if version == 2 else model.setFloat64
        nominal = np.array([float(each.nominal or 1.0) for each in states])
        random = np.random.default_rng(0)
        begin = np.concatenate(
            [0.3 * nominal * random.standard_normal(len(states)), read([each.valueReference for each in inputs])]
        )

        def values(at):
            numbers = (ctypes.c_double * len(states))(*at[: len(states)])
            model.setContinuousStates(numbers, len(states))
            write([each.valueReference for each in inputs], list(at[len(states) :]))
            return np.array(read(unknowns))

        for _ in range(5):
            direction = np.concatenate([nominal * random.standard_normal(len(states)), random.standard_normal(len(inputs))])
            values(begin)
            found = np.array(model.getDirectionalDerivative(unknowns, knowns, list(direction)))
            step = 1e-6
            expected = (values(begin + step * direction) - values(begin - step * direction)) / (2.0 * step)
            assert np.abs(found - expected).max() <= 1e-6 * np.abs(expected).max()
            assert found == pytest.approx(expected, rel=1e-4, abs=1e-8 * np.abs(expected).max())


@pytest.mark.slow("export")
@pytest.mark.parametrize(("version", "name"), [*DRIVES.items(), (3, "robot-joint")])  # with Maxwell elements in both versions
def test_solver_of_a_tool_comes_closer_with_its_tolerance(version, name, tmp_path):
    drive, path = sw.GearSet.read(name).drive, tmp_path / "block.fmu"
    path.write_bytes(exchanged(version, name))
    assert validation.validate_fmu(str(path)) == []
    run = sw.simulate_adaptively(drive, sw.scenario.constant(0.1, 0.2), 1e-9, sample=1e-3)
    settings = {
        "fmi_type": "ModelExchange",
        "solver": "CVode",
        "stop_time": 0.2,
        "output_interval": 1e-3,
        "record_events": False,
    }
    names, errors = ["output_angle", "torque"], []
    for tolerance in TOLERANCES:
        found = fmpy.simulate_fmu(
            str(path), relative_tolerance=tolerance, start_values={"command": 0.1}, output=names, **settings
        )
        errors.append([np.abs(found[name] - run[name]).max() / np.abs(run[name]).max() for name in names])
    assert np.all(np.array(errors[1:]) < 0.5 * np.array(errors[:-1])), errors
    assert np.all(np.array(errors[-1]) < 1e-3), errors


@pytest.mark.parametrize("version", DRIVES)
def test_state_is_restored_to_the_bit(version):
    with ExitStack() as stack:
        block, outputs = opened(version, stack)
        block.start(inputs_at(0))
        driven(block, list(outputs), 0, 300)
        names = ("FMUstate", "SerializeFMUstate", "DeSerializeFMUstate") if version == 2 else (
            "FMUState", "SerializeFMUState", "DeserializeFMUState"
        )  # fmt: skip
        slave = block.slave
        state = getattr(slave, f"get{names[0]}")()
        data = slave.serializeFMUstate(state) if version == 2 else slave.serializeFMUState(state)
        expected = driven(block, list(outputs), 300, 500)
        getattr(slave, f"set{names[0]}")(state)
        assert np.array_equal(driven(block, list(outputs), 300, 500), expected)
        other, _ = opened(version, stack)
        other.start({"command": 0.3, STEP_NAME: 1e-4})
        restored = (other.slave.deSerializeFMUstate if version == 2 else other.slave.deserializeFMUState)(data)
        getattr(other.slave, f"set{names[0]}")(restored)
        assert np.array_equal(driven(other, list(outputs), 300, 500), expected)


@pytest.mark.parametrize("version", DRIVES)
def test_instances_are_independent(version):
    with ExitStack() as stack:
        alone, outputs = opened(version, stack)
        one, other = (opened(version, stack)[0] for _ in range(2))
        for block in (alone, one):
            block.start(inputs_at(0))
        other.start({"command": -0.4, "gear.damping": 2.0})
        expected, found = driven(alone, list(outputs), 0, 100), []
        for k in range(100):
            found.append(driven(one, list(outputs), k, k + 1)[0])
            other.step(k * COMMUNICATION, COMMUNICATION)
        assert np.array_equal(found, expected)


def test_instances_leave_no_memory_behind(tmp_path):
    def resident():
        return int(Path("/proc/self/statm").read_text().split()[1]) * 4096

    def run_once():
        slave = fmi2.FMU2Slave(guid=about.guid, unzipDirectory=str(tmp_path), modelIdentifier=identifier, instanceName="one")
        slave.instantiate()
        slave.setupExperiment(startTime=0.0)
        slave.enterInitializationMode()
        slave.exitInitializationMode()
        slave.doStep(0.0, COMMUNICATION)
        state = slave.getFMUstate()
        size = len(slave.serializeFMUstate(state))
        slave.freeFMUstate(state)
        slave.terminate()
        slave.freeInstance()
        return size

    fmpy.extract(BytesIO(content_of(2)), unzipdir=str(tmp_path))
    about = fmpy.read_model_description(str(tmp_path))
    identifier = about.coSimulation.modelIdentifier
    for _ in range(50):
        size = run_once()
    before = resident()
    for _ in range(200):
        run_once()
    assert resident() - before < 200 * size / 2  # an instance that is not freed takes more than its state


@pytest.mark.slow("export")
@pytest.mark.parametrize("version", DRIVES)
@pytest.mark.parametrize("content", [content_of, exchanged], ids=["co-simulation", "model exchange"])
def test_description_is_valid(content, version, tmp_path):
    path = tmp_path / "block.fmu"
    path.write_bytes(content(version))
    assert validation.validate_fmu(str(path)) == []
    schemas = resources.files("fmpy") / "schema" / f"fmi{version}"
    files = {"modelDescription.xml": f"fmi{version}ModelDescription.xsd"}
    if version == 3:
        files["sources/buildDescription.xml"] = "fmi3BuildDescription.xsd"
        files["terminalsAndIcons/terminalsAndIcons.xml"] = "fmi3TerminalsAndIcons.xsd"
    with zipfile.ZipFile(path) as archive:
        for name, schema in files.items():
            etree.XMLSchema(etree.parse(str(schemas / schema))).assertValid(etree.fromstring(archive.read(name)))
        about = etree.fromstring(archive.read("modelDescription.xml"))
    ability = "providesDirectionalDerivative" + "s" * (version == 3)
    assert [each.get(ability) for each in about.iter("ModelExchange")] == ["true"] * (content is exchanged)
    needs = ["true"] if version == 3 and content is exchanged else [None] * (content is exchanged)
    assert [each.get("needsCompletedIntegratorStep") for each in about.iter("ModelExchange")] == needs


def test_terminals_name_variables_of_the_description():
    found = zipfile.ZipFile(BytesIO(content_of(3)))
    root = etree.fromstring(found.read("terminalsAndIcons/terminalsAndIcons.xml"))
    members = [each.get("variableName") for each in root.iter("TerminalMemberVariable")]
    known = {each.name for each in fmpy.read_model_description(BytesIO(content_of(3))).modelVariables}
    assert {"input_angle", "output_angle", "load_torque", "current"} <= set(members) <= known


@pytest.mark.parametrize("version", DRIVES)
def test_units_have_the_exponents_of_their_names(version):
    about = fmpy.read_model_description(BytesIO(content_of(version)))
    assert {each.unit for each in about.modelVariables} <= {each.name for each in about.unitDefinitions}
    for unit in about.unitDefinitions:
        product = ".".join(f"{name}{getattr(unit.baseUnit, name)}" for name in BASE_UNITS if getattr(unit.baseUnit, name))
        assert convert(1.0, unit.name, product or "1") == pytest.approx(unit.baseUnit.factor or 1.0, rel=1e-15), unit.name
        for shown in unit.displayUnits:
            assert convert(2.0, unit.name, shown.name) == pytest.approx(shown.factor * 2.0 + (shown.offset or 0.0), rel=1e-12)


@pytest.mark.parametrize("version", DRIVES)
def test_binaries_are_where_the_standard_wants_them(version):
    about = fmpy.read_model_description(BytesIO(content_of(version)))
    assert fmpy.supported_platforms(BytesIO(content_of(version))) != []
    folder = {2: "linux64", 3: "x86_64-linux"}[version] if build.own_platform() == ["x86_64-linux"] else ""
    names = zipfile.ZipFile(BytesIO(content_of(version))).namelist()
    assert any(re.fullmatch(f"binaries/{folder}.*/{about.coSimulation.modelIdentifier}[.]so", name) for name in names)


def test_parameters_are_those_of_the_drive():
    drive = drive_of(2)
    about = {each.name: each for each in fmpy.read_model_description(BytesIO(content_of(2))).modelVariables}
    for path, number in parameters.every(drive).items():
        assert (float(about[path].start), about[path].unit) == (number.value, number.unit)
    changed = parameters.replaced(drive, {"gear.damping": 5.0, "load.inertia": 2.0, "control.period": 5e-4})
    run = sw.simulate(changed, sw.scenario.constant(0.1, 0.1), STEP)
    with ExitStack() as stack:
        block, _ = opened(2, stack)
        block.start({"command": 0.1, "gear.damping": 5.0, "load.inertia": 2.0, "control.period": 5e-4})
        block.step(0.0, 0.1)
        found = block.get(["output_angle", "torque"])
    assert found == pytest.approx([run["output_angle"][-1], run["torque"][-1]], rel=1e-12)


def test_block_begins_with_initial_quantities():
    run = sw.simulate(drive_of(3), sw.scenario.constant(0.1, 0.1), STEP, initial={"output_angle": 0.08, "output_speed": 0.02})
    with ExitStack() as stack:
        block, _ = opened(3, stack)
        block.start({"command": 0.1, "initial.output_angle": 0.08, "initial.output_speed": 0.02})
        first = block.get(["output_angle", "output_speed"])
        block.step(0.0, 0.1)
        last = block.get(["output_angle"])
    assert first == pytest.approx([0.08, 0.02], rel=1e-12)
    assert last == pytest.approx([run["output_angle"][-1]], rel=1e-12)


@pytest.mark.parametrize(
    ("values", "message"),
    [
        ({"gear.damping": -1.0}, r"gear\.damping = -1 N\.m\.s/rad must lie within"),
        ({STEP_NAME: 0.02}, r"internal_step = 0\.02 s is too coarse: .* set .* s or less"),
        ({"control.delay": 1.0}, r"delay must not exceed period"),
        ({"temperature": -5.0}, r"temperature = -5 K must be positive"),
    ],
)
def test_wrong_values_are_refused_with_a_message(values, message, capfd):
    with ExitStack() as stack:
        block, _ = opened(2, stack)
        with pytest.raises(fmi1.FMICallException):
            block.start(values)
        stack.pop_all()
    output = capfd.readouterr()
    assert re.search(message, output.out + output.err)


@pytest.mark.slow("export")
def test_source_fmu_compiles_by_a_plain_command(tmp_path):
    drive = drive_of(3)
    content = sw.export.fmu(drive, version=3, platforms=(), name="block").files["block.fmu"]
    with zipfile.ZipFile(BytesIO(content)) as archive:
        assert not [name for name in archive.namelist() if name.startswith("binaries")]
        archive.extractall(tmp_path)
    about = fmpy.read_model_description(BytesIO(content))
    library = tmp_path / f"binaries/x86_64-linux/{about.coSimulation.modelIdentifier}.so"
    library.parent.mkdir(parents=True)
    sources = tmp_path / "sources"
    command = [
        "c++",
        "-std=c++20",
        "-shared",
        "-fPIC",
        "-Wall",
        "-Wextra",
        "-Werror",
        f"-I{sources}",
        str(sources / "fmi3.cpp"),
    ]
    subprocess.run([*command, "-o", str(library)], check=True)
    identifier = about.coSimulation.modelIdentifier
    slave = fmi3.FMU3Slave(guid=about.guid, unzipDirectory=str(tmp_path), modelIdentifier=identifier, instanceName="one")
    slave.instantiate()
    slave.enterInitializationMode()
    slave.exitInitializationMode()
    slave.terminate()
    slave.freeInstance()


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"drive": "csg-20-100"}, r"CSG-20-100 has no \[motor\] and no \[load\]"),
        ({"drive": lambda seen: 0.0}, r"Drive"),
        ({"platforms": ["amiga"]}, r"the platform \"amiga\" is not known; give some of x86_64-linux, "),
        ({"version": 1}, r"version = 1 must be 2 or 3"),
        ({"step": 0.0}, r"step = 0\.0 s must lie in"),
        ({"step": 0.02}, r"step = 0\.02 s is too coarse: .* give .* s or less"),
        ({"drive": PRESCRIBED, "model_exchange": True}, r"model exchange needs an output shaft that torques move"),
        ({"name": "///"}, r"name = \"///\" must contain letters or digits"),
    ],
)
def test_wrong_arguments_are_refused_in_one_line(arguments, message):
    given = {"drive": DRIVES[2], "platforms": ()} | arguments
    drive = given.pop("drive")
    with pytest.raises((TypeError, ValueError), match=message) as caught:
        sw.export.fmu(sw.GearSet.read(drive) if isinstance(drive, str) else drive, **given)
    assert "\n" not in str(caught.value)


def test_without_compiler_the_source_fmu_is_named(monkeypatch):
    def none():
        raise NoCompilerError("there is no C++20 compiler")

    monkeypatch.setattr(build, "find_compiler", none)
    monkeypatch.setattr(build, "zig_program", lambda: None)
    monkeypatch.setattr(build, "_binary", build._binary.__wrapped__)  # one that was compiled before needs no compiler
    for platform in ("x86_64-linux", "x86_64-windows"):
        with pytest.raises(NoCompilerError, match="--platform source, or platforms=\\(\\)"):
            sw.export.fmu(drive_of(2), platforms=[platform])


def test_bristles_shorten_the_step():
    stiff = sw.friction.LuGre(
        coulomb=0.05, breakaway=0.07, stribeck_speed=2.0, bristle_stiffness=5e3, bristle_damping=5e-3, viscous=4e-4
    )
    drive = drive_of(3)
    step = default_step(drive.replace(gear=drive.gear.replace(friction_input=stiff)))
    assert step < STEP
    assert STEP / step == 2 ** round(np.log2(STEP / step))


def test_command_writes_a_source_fmu(tmp_path):
    from strainwave.commands.export import export

    result = CliRunner().invoke(export, ["fmu", DRIVES[3], "--version", "3", "--platform", "source", "--out", str(tmp_path)])
    assert result.exit_code == 0, result.output
    assert sorted(path.name for path in tmp_path.iterdir()) == ["Tilt-actuator-lumped-gear.fmu", "export.json"]
    assert "left out" in result.output


def test_losses_are_rounding():
    for version in DRIVES:
        assert exported(version).losses
        assert all(loss.rms_share < 1e-12 for loss in exported(version).losses)
        assert replace(exported(version), files={}).kind.endswith(f"FMI {version}.0")
