"""Every public result is one line, a table, a notebook's HTML and plain data, with the same numbers in all of them."""

from __future__ import annotations

import inspect
import json
import re
import subprocess
import sys
import tempfile
from collections.abc import Iterator, Mapping
from functools import cache
from html.parser import HTMLParser
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np
import pytest
import strainwave as sw
from matplotlib.figure import Figure
from strainwave import _core, typeset
from strainwave.native.compile import Compilation, CompiledJob
from strainwave.presentation import MAX_PRINTED_ROWS, MAX_REPR, PAGE_WIDTH, Presented, Reported, Row, Statement, number_text
from strainwave.rig.reading.evaluation import evaluate
from strainwave.tuning.loss import ExportLoss

from tests.support.strategies import made

HOSTILE = "<script>alert(1)</script> & more"
ROOMS = (getattr(sw, name) for name in sw.__all__)
PUBLIC = (sw, *(room for room in ROOMS if isinstance(room, ModuleType) and hasattr(room, "__all__")))
TYPES = sorted(
    {
        kind.__name__
        for module in PUBLIC
        for kind in (getattr(module, name) for name in module.__all__)
        if inspect.isclass(kind) and (issubclass(kind, Presented) or hasattr(kind, "_headline"))
    }
)
GIVEN = {  # values that a person writes: they print as they are written
    "BearingOrders", "Camera", "Entry", "Factors", "FileMapping", "Masses", "Observation", "Quantity", "Rig", "Scene", "Step",
    "Value", "Wave",
}  # fmt: skip
OTHERS = {"PredictiveController"}  # a controller, which is called


def table() -> sw.Recording:
    """Return a table of steady friction, 1.2 times that of the catalogue."""
    speed = np.linspace(2.0, 200.0, 30)
    torque = 1.2 * sw.load("hfuc-25-100").friction_input.steady(speed)
    torque += np.random.default_rng(0).normal(0.0, 1e-3, 30)
    return sw.Recording({"speed": speed, "torque": torque}, {"speed": "rad/s", "torque": "N.m"}, HOSTILE)


def encoders() -> sw.Recording:
    """Return the angles of both shafts of a gear with an error of order 2."""
    theta = 30.0 * np.sin(np.linspace(0.0, 6.0, 1000))
    output = -theta / 100.0 - 3e-4 * np.sin(2.0 * theta) + np.random.default_rng(1).normal(0.0, 1e-5, 1000)
    return sw.Recording({"input_angle": theta, "output_angle": output}, {"input_angle": "rad", "output_angle": "rad"})


def run_up() -> sw.Recording:
    """Return a shaft that turns faster and faster, with a torque of order 2."""
    time = np.linspace(0.0, 10.0, 4000)
    angle = 2.0 * time**2
    torque = np.sin(2.0 * angle) + np.random.default_rng(2).normal(0.0, 0.1, len(time))
    columns = {"time": time, "input_angle": angle, "input_speed": 4.0 * time, "torque": torque}
    return sw.Recording(columns, {"time": "s", "input_angle": "rad", "input_speed": "rad/s", "torque": "N.m"})


def fitted() -> Iterator[Any]:
    """Yield a fit, and what is computed from it."""
    gear, free = sw.load("hfuc-25-100"), ["friction_input.coulomb", "friction_input.viscous"]
    fit = sw.fit(gear, table(), free)
    yield from (
        fit,
        *fit.estimates,
        *fit.parts,
        sw.identification.bootstrap(fit, 20),
        sw.identification.minima(fit, 3),
        sw.identification.profile(fit, free[0]),
    )
    drive = sw.Drive(load=sw.loads.Inertia(inertia=0.1))
    run = sw.simulate(drive, sw.scenario.sine(5.0, frequency=2.0, duration=0.5), sample=1e-2, record=["command", "input_angle"])
    noise = 1e-2 * np.random.default_rng(0).normal(size=len(run))
    log = run.with_column("input_angle", run["input_angle"] + noise, "rad")
    yield from sw.identification.combinations(sw.fit(drive, log, ["motor.inertia", "load.inertia"]))
    found = sw.identify("hfuc-25-100", {"friction": table()}, name=HOSTILE)
    yield from (found, *found.files, *found.parameters, *found.states, *found.checks, found.gear_set)
    yield from sw.predict(found.gear_set, {"friction": table()})
    wanted = ["gear.friction_input.coulomb"]
    yield sw.identification.plan_experiments(sw.GearSet.read("csg-20-100"), wanted, experiments=["friction"], time=300.0)


def simulated() -> Iterator[Any]:
    """Yield drives, runs, and what is computed of drives."""
    gear, load = sw.load("hfuc-25-100"), sw.loads.Inertia(inertia=0.01)
    drive = sw.Drive(load=load, control=sw.control.PID(proportional=2.0, derivative=0.05))
    command = sw.scenario.sine(amplitude=0.3, frequency=1.0, duration=0.5)
    run = sw.simulate(drive, command, sample=5e-3)
    yield from (gear, sw.load("robot-joint"), sw.Sensors(), sw.Compensation(), gear.stiffness, run, run.end, command)
    yield from (sw.simulation.ScenarioFile(command), sw.linearise(drive))
    yield sw.Recording({"time": [0.0, 1.0], "torque": [1.0, 2.0]}, {"time": "s", "torque": "N.m"}, HOSTILE)
    yield sw.analysis.MeasuredCommand(run)
    yield sw.simulate_many(drive, command, {"load.inertia": [0.01, 0.02]}, sample=1e-2)
    yield sw.analysis.derivatives(drive, command, ["load.inertia"], sample=1e-2)
    yield sw.analysis.frequency_response(drive, [1.0, 2.0], amplitude=0.01)
    yield from (*sw.compare(run, run)[:1], *sw.compare(gear, gear.replace(damping=5.0)))
    torques = sw.Recording({"time": [0.0, 0.1], "torque": [0.0, -129.0]}, {"time": "s", "torque": "N.m"})
    yield from sw.check_ratings(sw.GearSet.read("csg-20-100"), torques)


def tuned() -> Iterator[Any]:
    """Yield controllers, moves and what a gear can do."""
    law, joint = sw.cascade("robot-joint", period=1e-3), sw.load("robot-joint")
    yield sw.tuning.loop_margins(joint.replace(control=sw.control.Sampled(law=law, period=1e-3)))
    yield from sw.analysis.positioning_error("csg-20-100", load=20.0)
    yield sw.tuning.lost_motion(sw.rig.printed_gear(0), swing=36.0)
    yield sw.tuning.positioning_path([0.1, 0.2], 0.01, speed=0.5, acceleration=1.0)
    yield sw.analysis.output_torque("csg-20-100", -100.0 * np.linspace(0.0, 1e-3, 50), np.zeros(50))
    plan = sw.tuning.plan_pulses("position-drive", 0.005)
    yield from (
        plan,
        sw.tuning.position_by_pulses(plan, tolerance=1e-4),
        sw.tuning.pulse_repeatability(plan, tolerance=1e-4, members=3),
    )
    yield sw.compensate("robot-joint", members=3, travel=0.02)
    yield Compilation("control PID", (CompiledJob("simulate", 1.75, 6.4),))
    yield sw.export.joint(sw.GearSet.read("csg-20-100"))
    yield ExportLoss("torque", 0.1, 0.2, "N.m", 10.0, "a sine", "the largest")
    with tempfile.TemporaryDirectory() as folder:
        yield sw.export.firmware(joint, folder)


def of_orders() -> Iterator[Any]:
    """Yield orders, ripple and transmission error."""
    turned = run_up()
    yield from (sw.transmission_error(encoders()), sw.orders.ripple(turned, "torque", angle="input_angle", side="input"))
    yield from (sw.orders.order_amplitudes(turned, "torque", [1.0, 2.0]), sw.orders.campbell(turned, "torque"))
    yield from (sw.orders.ring_modes(turned, "torque", orders=[1.0, 2.0]), sw.orders.bearing_candidates([10.37], [0.01]))
    yield from (*sw.diagnose.order_lines(turned, "torque", [2.0]), sw.orders.order_tracks(turned, "torque", [2.0]))
    record = {"speed": 20.0, "duration": 2.0, "sample_rate": 500.0, "noise": 0.02, "order": 2.0}
    yield sw.diagnose.detection_limit(sw.load("tilt-actuator-lumped"), load_torque=20.0, **record)
    yield sw.diagnose.MisalignmentEstimate("current", "single", (3e-6, 4e-6), 1e-14 * np.eye(2), 40, 1.1)


def of_wear() -> Iterator[Any]:
    """Yield the life of a gear, its error over the temperature, and the loss of its loops by source."""
    yield sw.diagnose.wear_life([0.0, 1e6, 2e6, 3e6], {"play": [1.0e-4, 1.31e-4, 1.58e-4, 1.92e-4]}, {"play": 4e-4})
    yield sw.orders.error_over_temperature([sw.transmission_error(encoders())] * 3, [283.15, 293.15, 303.15])
    way, units, loops = np.sin(np.linspace(0.5, 4.5, 801) * np.pi), {"twist": "rad", "torque": "N.m"}, []
    for reach in (10.0, 40.0):
        torque = reach * way + (0.5 + 0.02 * np.abs(reach * way)) * np.sign(np.gradient(way))
        loops.append(sw.Recording({"twist": reach * way / 2e4, "torque": torque}, units))
    shares = sw.identification.loss_shares(loops, sw.load("hfuc-25-100"))
    yield from (shares, shares["gear, dry"])


def of_mesh() -> Iterator[Any]:
    """Yield tables of finite elements, and the laws of a gear by them."""
    angle, torque = (each.ravel() for each in np.meshgrid(np.radians(np.arange(0.0, 360.0, 10.0)), [-20.0, 0.0, 20.0]))
    error = 3e-4 * np.sin(2.0 * angle) / (1.0 + 0.02 * np.abs(torque)) + torque / 3e4
    table = sw.files.MeshTable(angle, torque, transmission_error=error, mesh_stiffness=4e8 + 1e7 * np.sin(2.0 * angle))
    yield from (table, sw.orders.mesh_laws(table))
    yield sw.files.ModeTable(frequency=[1800.0, 2100.0], waves=[0, 0], damping=[0.01, 0.01], mass=[0.5, 0.8])


def of_rig() -> Iterator[Any]:
    """Yield what the torsion rig measures and computes."""
    bench = sw.rig.load("couple-rig")
    angle = np.radians([0.0, -4.5, -59.0, -54.5, 0.0])
    loop = sw.rig.Loop(angle, [0.36, 0.0, -0.36, 0.0, 0.36], side="input", name=HOSTILE, angle_sigma=1e-4)
    analysis = sw.rig.analyse(loop)
    yield from (loop, analysis, *sw.rig.table([analysis]), analysis.area, sw.rig.cycle(sw.load("csg-25-100"), 87.0))
    yield evaluate([loop])
    plan = sw.rig.plan(bench, positions=[0.0])
    yield from (plan, *sw.rig.check([step for step in plan.steps if step.number != 4], plan))
    yield sw.rig.torque_budget(bench, sw.rig.Step(1, mass_positive=0.35))
    yield sw.rig.torque_of([sw.rig.Step(1, mass_positive=0.3), sw.rig.Step(2, mass_positive=0.2)], bench)
    series = sw.rig.Series({"torque_max": [0.1, 0.2, 0.3, 0.4]}, {"area": [1.0, 4.1, 8.8, 16.3]})
    yield from (series, *sw.rig.analyse_series(series))
    scene, random = sw.rig.Scene(size=(320, 240), radius=20.0, distance=150.0), np.random.default_rng(1)
    pictures = [sw.rig.as_image(f"{turn}.png", sw.rig.render(scene, np.radians(turn), random)) for turn in (0, 5)]
    yield from (*pictures, sw.rig.measure_angles(pictures), *sw.rig.find_markers(pictures[0].grey))
    yield sw.rig.geometric([1.01, 0.0, -1.0, 0.0], [0.0, 1.0, 0.0, -0.99])


@cache
def results() -> Mapping[str, Any]:
    """Return a result of each type, by the name of the type."""
    everything = (each for kind in (fitted, simulated, tuned, of_orders, of_wear, of_mesh, of_rig) for each in kind())
    return {type(each).__name__: each for each in everything}


NOT_MADE = {"ActuatorRamp", "Comparison", "RecoveryModel", "SweepLevels", "TorsionTest", "VirtualTest"}


class Page(HTMLParser):
    """The texts of a page, each tag of which must be closed."""

    def __init__(self, page: str) -> None:
        super().__init__()
        self.texts, self.tags, self.open = list[str](), list[str](), list[str]()
        self.feed(page)
        self.close()
        assert self.open == []

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.tags.append(tag)
        self.open.append(tag)

    def handle_startendtag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.tags.append(tag)

    def handle_endtag(self, tag: str) -> None:
        assert self.open.pop() == tag

    def handle_data(self, data: str) -> None:
        self.texts.append(data)


def entry_text(entry: Mapping[str, Any]) -> str:
    """Return the number of an entry of `to_dict` as a table shows it; not-a-number and infinity are None there."""
    value = tuple(entry["value"]) if isinstance(entry["value"], list) else entry["value"]
    return number_text(Row("", value, entry["unit"], float("nan") if entry["sigma"] is None else entry["sigma"]))


def test_every_public_class_is_a_result_or_a_value_that_a_person_writes() -> None:
    classes = {name for module in PUBLIC for name in module.__all__ if inspect.isclass(getattr(module, name))}
    warnings = {name for name in classes if name.endswith("Warning")}
    assert classes - set(TYPES) - warnings - GIVEN - OTHERS == set()


@pytest.mark.slow("report")
def test_a_result_of_each_public_type_is_made() -> None:
    assert set(TYPES) - results().keys() - NOT_MADE == set()


@pytest.mark.slow("report")
def test_a_result_is_one_line() -> None:
    for name, result in results().items():
        line = repr(result)
        assert len(line) <= MAX_REPR, name
        assert line.isprintable(), name
        assert re.match(rf"<{name}: .|{name}\(", line), line
        assert " object at " not in line
        assert "array(" not in line


@pytest.mark.slow("report")
def test_a_result_prints_as_a_table_of_a_page() -> None:
    for name, result in results().items():
        lines = str(result).splitlines()
        if not isinstance(result, Statement):
            assert max(map(len, lines)) <= PAGE_WIDTH, name
            assert lines[0].startswith(f"{getattr(result, '_title', name)}:"), name
            assert len(lines) > 1, name
        assert "object at 0x" not in str(result), name


@pytest.mark.slow("report")
def test_data_are_of_json_and_have_the_numbers_that_are_shown() -> None:
    for name, result in results().items():
        data = json.loads(json.dumps(result.to_dict(), allow_nan=False))
        assert data == result.to_dict(), name
        assert data["type"] == name
        rows, text = list(result._rows()), " ".join(str(result).split())
        assert len(data["rows"]) == len(rows), name
        for row, entry in zip(rows[:MAX_PRINTED_ROWS], data["rows"].values(), strict=False):
            finite = "∞" not in number_text(row) and "—" not in number_text(row)
            if not isinstance(row.value, str) and finite:
                assert entry_text(entry) == number_text(row), (name, row)
                assert isinstance(result, Statement) or number_text(row) in text, (name, row)


@pytest.mark.slow("report")
def test_html_has_the_same_numbers_and_no_text_that_is_not_escaped() -> None:
    for name, result in results().items():
        page = Page(result._repr_html_())
        assert not {"script", "style", "iframe"} & set(page.tags), name
        texts = " ".join(page.texts)
        for row in list(result._rows())[:MAX_PRINTED_ROWS]:
            assert isinstance(row.value, str) or number_text(row) in texts, (name, row)
            assert typeset.unit(row.unit) in texts, (name, row)


@pytest.mark.slow("report")
def test_names_of_strangers_are_shown_as_they_are() -> None:
    found = results()["Identified"]
    assert HOSTILE in " ".join(Page(found._repr_html_()).texts)
    assert "<script>" not in found._repr_html_()


@pytest.mark.slow("report")
def test_a_log_without_torque_constant_has_its_curves_in_a_notebook() -> None:
    """Its numbers are in A, so none can be compared with the start set."""
    log = Path(sw.__file__).parent / "demo" / "robot_log.csv"
    identified = sw.identify("hfuc-20-80", [log], progress=False)
    with pytest.raises(ValueError, match="nothing to compare"):
        identified.plot()
    assert "measured" in " ".join(Page(identified._repr_html_()).texts)


@pytest.mark.slow("report")
def test_a_result_has_a_picture_by_its_type() -> None:
    for name, result in results().items():
        if hasattr(result, "plot"):
            assert isinstance(result.plot(), Figure), name
            assert "<svg" in result._repr_html_(), name
        else:
            assert "<svg" not in result._repr_html_(), name


@pytest.mark.slow("report")
def test_pictures_of_one_page_share_no_identifier() -> None:
    pages = [result._repr_html_() for name, result in results().items() if name in ("Fit", "Profile", "Run", "Ripple")]
    of_pages = [set(re.findall(r' id="([^"]+)"', page)) for page in pages]
    assert all(of_pages)
    assert sum(map(len, of_pages)) == len(set.union(*of_pages))


@pytest.mark.slow("report")
def test_a_frame_has_every_row() -> None:
    pytest.importorskip("pandas")
    for name, result in results().items():
        if not isinstance(result, sw.Recording):
            frame = result.to_frame()
            assert list(frame.columns) == ["value", "sigma", "unit", "note"], name
            assert list(frame.index) == list(result.to_dict()["rows"]), name


@pytest.mark.slow("report")
def test_a_report_is_written_to_a_folder(tmp_path: Path) -> None:
    reported = {name: result for name, result in results().items() if isinstance(result, Reported)}
    assert {"Compensated", "Evaluation", "Identified", "Ripple", "TransmissionError"} <= reported.keys()
    for name, result in reported.items():
        page = result.report(tmp_path / name)
        assert page == tmp_path / name / "report.html"
        assert page.read_text(encoding="utf-8").startswith("<!doctype html>")


@pytest.mark.parametrize("model", [model for family in _core.families.values() for model in family.values()])
def test_a_law_is_one_line_and_a_table(model: type[Any]) -> None:
    law = made(model)
    assert len(repr(law)) <= MAX_REPR
    assert max(map(len, str(law).splitlines())) <= PAGE_WIDTH
    assert json.dumps(law.to_dict(), allow_nan=False)
    assert "<table>" in law._repr_html_() or not law.to_dict()["rows"]


def test_a_long_line_is_cut_between_numbers_and_between_columns() -> None:
    assert re.fullmatch(r"<DC: (\w+=[\d.e-]+, ){3,}…>", repr(sw.motor.DC(resistance=0.5)))
    run = sw.simulate(sw.load("position-drive"), sw.scenario.step(0.1, duration=0.01))
    assert len(repr(run)) <= MAX_REPR
    assert re.search(r"; (\w+ \[\S+\](, | and )){3,}\d+ more>$", repr(run))


def test_a_row_without_a_number_is_a_dash_in_print_and_none_in_data() -> None:
    class Unknown(Presented):
        def _rows(self) -> list[Row]:
            return [Row("width", None, "rad"), Row("width", float("inf"), "rad"), Row("way", True), Row("note", "", note="")]

    data = Unknown().to_dict()
    assert str(Unknown()).splitlines()[1:] == ["  width    —  rad", "  width    ∞  rad", "  way    yes", "  note   —"]
    assert [each["value"] for each in data["rows"].values()] == [None, None, True, ""]
    assert list(data["rows"]) == ["width", "width (2)", "way", "note"]


def test_an_import_needs_neither_numpy_nor_pandas_nor_matplotlib() -> None:
    heavy = "{'numpy', 'pandas', 'matplotlib', 'textwrap'}"
    code = f"import strainwave, sys; repr(strainwave.Gear()); print({heavy} & sys.modules.keys())"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "set()"


def test_a_drive_names_the_motor_that_it_assumes() -> None:
    assert repr(sw.Drive()) == "<Drive: ratio -100, motor DC by default>"
    assert "motor DC by default" in str(sw.Drive()).splitlines()[0]
    assert repr(sw.Drive(motor=sw.motor.DC(torque_constant="75 mN.m/A"))) == "<Drive: ratio -100, motor DC>"
