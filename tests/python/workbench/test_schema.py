"""Parameters in the page: taken apart as the compiled core takes them, written as files and Python that give the same drive."""

from __future__ import annotations

import json
import tomllib
from pathlib import Path
from random import Random
from time import perf_counter
from typing import Any
from xml.etree import ElementTree

import pytest
import strainwave as sw
from strainwave import _core
from strainwave.files.entries import Entry
from strainwave.files.gear_set import GearSet
from strainwave.files.identified_tables import Covariance
from strainwave.workbench.page import changed, drive_around, embedded, start_of
from strainwave.workbench.schema import model_of, schema, values_of

from tests.python.workbench.node import doubles, in_node, needs_node
from tests.python.workbench.test_core import random_drives

DRIVES = 60
SVG = "{http://www.w3.org/2000/svg}"


@pytest.fixture(scope="module")
def drives() -> list[sw.Drive]:
    """Whole drives of the catalogue, and random ones."""
    return [sw.load(name) for name in sw.catalogue("drives")] + random_drives(DRIVES)


def test_every_model_of_a_part_is_described_once_with_unit_and_text() -> None:
    models = schema()["models"]
    assert {f"{kind.__module__}.{kind.__name__}" for family in _core.families.values() for kind in family.values()} <= {
        f"strainwave.{name}" for name in models
    }
    for name, model in models.items():
        for field in model["fields"]:
            assert field["doc"], (name, field["name"])
            assert field["kind"] in ("part", "choice") or field["unit"], (name, field["name"])


@pytest.mark.slow("report")
def test_numbers_and_defaults_return_to_the_same_drive(drives: list[sw.Drive]) -> None:
    for drive in drives:
        assert model_of(sw.Drive, values_of(drive)) == drive


@needs_node
@pytest.mark.slow("report")
def test_the_page_takes_a_drive_apart_as_the_core_does(drives: list[sw.Drive]) -> None:
    flat = in_node("flatten", schema=schema(), drives=[changed(drive) for drive in drives])
    for drive, parts in zip(drives, flat, strict=True):
        laws, shape, numbers = _core.parts(drive)
        assert (parts["laws"], parts["shape"]) == (laws, shape)
        assert doubles(parts["numbers"]).tobytes() == numbers.tobytes()
        assert parts["paths"] == [path for path, *_ in _core.parameters(drive)]
        assert model_of(sw.Drive, parts["values"]) == drive


@needs_node
@pytest.mark.slow("report")
@pytest.mark.filterwarnings("ignore")
def test_python_and_file_of_the_page_give_the_same_drive(drives: list[sw.Drive], tmp_path: Path) -> None:
    for drive, parts in zip(
        drives, in_node("flatten", schema=schema(), drives=[values_of(each) for each in drives]), strict=True
    ):
        assert eval(parts["python"], {"sw": sw}) == drive
        (tmp_path / "gear.toml").write_text(parts["toml"])
        gear_set = GearSet.read(tmp_path / "gear.toml")
        assert gear_set.drive == drive
        assert {entry.source for entry in gear_set.sources.values()} <= {"a test", "not given"}


@needs_node
def test_the_mark_of_a_number_is_the_state_that_its_source_states() -> None:
    marks = {
        ("identified from a.csv", "0.2"): "identified ± 0.2",
        ("identified from a.csv", None): "identified",
        ("identified in combination: a.csv determines k1 + k2", "0.2"): "in combination",
        ("fitted but not identified: its wave is too small", "0.2"): "not determined",
        ("not determined by: a.csv", None): "not determined",
        ("assumed: none", None): "assumed",
        ("not given", None): "by default",
        ("maker's catalogue, torsional stiffness", None): "maker's catalogue",
        ("data sheet; K1", "0.2"): "data sheet",
        ("set in the workbench", None): "set in the workbench",
        ("weighed on the kitchen scale of the laboratory", None): "weighed on the kitchen scale …",
    }
    assert in_node("states", entries=list(marks)) == list(marks.values())


@needs_node
def test_the_units_of_a_controller_are_those_of_what_the_motor_takes() -> None:
    def of(unit: str, *controllers: str) -> list[dict[str, list[str]]]:
        found = in_node("units", schema=schema(), controllers=[f"control.{name}" for name in controllers], unit=unit)
        return [{name: rest for name, *rest in fields} for fields in found]

    pid, loop, cascade = of("N.m", "PID", "PositionSpeed", "Cascade")
    assert pid["integral"] == ["N.m/(rad.s)", "Torque per integral of the input angle error"]
    assert pid["limit"] == ["N.m", "Largest torque, of either sign"]
    assert loop["speed_integral"][0] == "N.m/rad"
    assert loop["position_gain"] == ["1/s", "Input speed per error of the input angle"]
    assert cascade["voltage_limit"][0] == "V"
    (feedback,) = of("A", "StateFeedback")
    assert feedback["current"] == ["A/A", "Current k_5 taken away per current"]
    (accelerated,) = of("rad/s2", "PI")
    assert accelerated["proportional"][0] == "rad.s-2.s/rad"
    (kept,) = of("V", "PID")
    assert kept["proportional"] == ["V/rad", "Voltage per input angle"]


@needs_node
def test_a_link_carries_data_alone() -> None:
    gear_set = GearSet.read("hfuc-25-100")
    data: dict[str, Any] = {"name": "é ′", "drive": changed(drive_around(gear_set)), "view": {"run": {"amplitude": 0.1}}}
    same, *faults = in_node("link", data=data, texts=["", "<script>", "A" * 60001, "_" * 100])
    assert same == data
    assert all(isinstance(fault, str) for fault in faults)


@needs_node
def test_what_is_no_drive_is_refused_with_its_place() -> None:
    wrong: list[tuple[Any, str]] = [
        (None, "Drive: parameters expected"),
        ([], "Drive: parameters expected"),
        ({"gear": {"damping": "1"}}, "Gear.damping: a finite number expected"),
        ({"gear": {"damping": -1.0}}, "Gear.damping must be at least 0"),
        ({"gear": {"stiffness": {"model": "none"}}}, "Gear.stiffness: no such law"),
        ({"gear": {"stiffness": {"model": "__proto__"}}}, "Gear.stiffness: no such law"),
        ({"gear": {"kinematics": {"model": "strain_wave", "flexspline_teeth": 200.5}}}, "whole number"),
        ({"gear": {"kinematics": {"model": "strain_wave", "fixed": "both"}}}, "one of circular_spline, flexspline"),
        ({"gear": {"hysteresis": {"model": "maxwell_slip", "stiffness": [1.0] * 1001}}}, "a list of numbers"),
    ]
    faults = in_node("refuse", schema=schema(), given=[given for given, _ in wrong])
    for fault, (given, expected) in zip(faults, wrong, strict=True):
        assert expected in fault, given


@needs_node
def test_a_view_of_a_link_has_no_text_but_those_of_its_menus() -> None:
    evil = "step(amplitude=1, duration=1); print('mine'); sw.scenario.step"
    wrong: list[Any] = [
        {"run": {"command": evil, "shown": evil, "duration": 0, "amplitude": None}, "travel": {"by": evil, "history": evil}},
        {
            "units": {"angle": evil, "torque": "__proto__"},
            "effect": "constructor",
            "run": {"shown": "toString", "duration": -1},
        },
        {"travel": {"history": "__proto__"}, "run": "command", "friction": {"maxSpeed": 0, "load": "1"}},
        None,
    ]
    short = {"gear": {"damping": 3.0}}
    good = {"run": {"command": "sine", "duration": 0.25}, "units": {"angle": "deg"}}
    *refused, (view, text) = in_node("views", schema=schema(), drive=short, given=[*wrong, good])
    assert refused == [refused[-1]] * len(wrong)
    assert "sw.scenario.step(amplitude=0.1, duration=0.5)" in refused[0][1]
    assert (view["run"]["command"], view["run"]["duration"], view["units"]["angle"]) == ("sine", 0.25, "deg")
    names: dict[str, Any] = {}
    exec(text, names)
    assert names["drive"].gear == sw.Gear(damping=3.0)


def exported(tmp_path: Path, gear_set: GearSet, key: Any, *drives: sw.Drive) -> list[GearSet]:
    """Return the gear files of drives that a page with a set writes; `key` names the gear that they come from."""
    start, entry = start_of(gear_set), start_of(GearSet.read("hfuc-25-100"))
    given = [changed(drive) for drive in drives]
    texts = in_node("export", schema=schema(), start=start, catalogue={"hfuc-25-100": entry}, key=key, drives=given)
    path = tmp_path / "gear.toml"
    return [GearSet.read(path) for text in texts if path.write_text(text)]


@needs_node
def test_a_sequence_keeps_its_source_only_if_all_of_it_is_unchanged(tmp_path: Path) -> None:
    gear_set = GearSet.read("csg-20-100")
    drive, path = drive_around(gear_set), "gear.hysteresis.breakaway[0]"
    values = gear_set.gear.hysteresis.breakaway
    second = drive.replace({"gear.hysteresis.breakaway": [values[0], 0.5, values[2]]})
    longer = drive.replace(
        {"gear.hysteresis.breakaway": [*values, 0.1], "gear.hysteresis.stiffness": [9.146e3, 4.573e3, 2.287e3, 1e3]}
    )
    limited = drive.replace({"control.limit": 3.0})
    same, one, more, control = exported(tmp_path, gear_set, gear_set.name, drive, second, longer, limited)
    assert same.sources[path] == gear_set.sources[path]
    assert same.control is None
    assert one.sources[path].source == more.sources[path].source == "set in the workbench"
    assert control.sources["control.limit"].source == "set in the workbench"
    assert control.sources["control.proportional"].source == "assumed by the workbench"


@needs_node
def test_untouched_numbers_keep_source_spread_deviation_and_covariance(tmp_path: Path) -> None:
    whole = GearSet.read("csg-20-100")
    names = ("gear.stiffness.k1", "gear.stiffness.k2", "gear.hysteresis.breakaway[1]")
    matrix = ((1e4, 2e3, 0.1), (2e3, 4e4, -0.1), (0.1, -0.1, 1e-4))
    identified = {path: Entry('identified from \\ "loop".csv', uncertainty=1e2) for path in names}
    gear_set = whole.replace(sources=dict(whole.sources) | identified, note="two\nlines", covariance=Covariance(names, matrix))
    drive = drive_around(gear_set)
    same, changed_one = exported(tmp_path, gear_set, gear_set.name, drive, drive.replace({"gear.stiffness.k2": 2e4}))
    assert same.replace(name=gear_set.name) == gear_set.replace(sources=same.sources)
    stated = {path: entry for path, entry in gear_set.sources.items() if entry.source != "not given"}
    assert {path: same.sources[path] for path in stated} == stated
    assert changed_one.sources["gear.stiffness.k2"] == Entry("set in the workbench")
    assert changed_one.sources["gear.stiffness.k1"] == gear_set.sources["gear.stiffness.k1"]
    assert changed_one.covariance == Covariance((names[0], names[2]), ((1e4, 0.1), (0.1, 1e-4)))
    assert changed_one.ratings == gear_set.ratings


@needs_node
@pytest.mark.parametrize("key", ["hfuc-25-100", "another", "__proto__", 3])
def test_another_gear_has_no_source_of_the_first(tmp_path: Path, key: Any) -> None:
    first, chosen = GearSet.read("csg-20-100"), GearSet.read("hfuc-25-100")
    (made,) = exported(tmp_path, first, key, drive_around(first))
    assert made.gear == first.gear
    mine = {entry.source for path, entry in first.sources.items() if entry not in chosen.sources.values()}
    assert not mine & {entry.source for entry in made.sources.values()}


@needs_node
def test_a_plot_as_svg_has_its_points_where_its_axes_have_them() -> None:
    axis = {"min": 0.0, "max": 4.0, "splits": [[0.0, "0"], [2.0, "2"]], "label": "</text> & "}
    curves = [
        {"x": [0.0, 1.0, "NaN", 4.0, 5.0], "y": [0.0, 2.0, "NaN", 4.0, 4.0], "colour": "#00f", "dash": True},
        {"x": [2.0], "y": [1.0], "colour": "#0f0", "mark": "point"},
        {"x": [2.0], "y": [1.0], "colour": "#f00", "mark": "bar"},
    ]
    frame = {"left": 60.0, "top": 10.0, "width": 400.0, "height": 200.0}
    colours = {"ink": "#000", "grid": "#eee", "paper": "#fff"}
    plot = {"title": "<script>", "width": 480, "height": 260, "frame": frame, "axes": [axis] * 2} | {
        "curves": curves,
        "colours": colours,
    }
    drawn = ElementTree.fromstring(in_node("svg", plot=plot))
    paths = {path.get("stroke", path.get("fill")): path.get("d") for path in drawn.iter(f"{SVG}path")}
    assert paths["#00f"] == "M60 210L160 110M460 10L560 10"
    assert paths["#0f0"] == "M259 159h2v2h-2z"
    assert paths["#f00"] == "M260 210V160"
    assert [text.get("x") for text in drawn.iter(f"{SVG}text") if text.text == "2"] == ["260", "54"]
    assert {each.tag.removeprefix(SVG) for each in drawn.iter()} == {"svg", "title", "rect", "path", "text"}


@needs_node
def test_a_link_has_measured_points_up_to_a_length() -> None:
    few, many = in_node("linked", counts=[3000, 3001])
    assert few["left"] == []
    assert 30_000 < len(few["fragment"]) <= 60_000
    assert many["left"] == ["the measured data"]
    assert len(many["fragment"]) < 1000


@needs_node
def test_measured_points_of_a_link_are_numbers_of_a_plot_that_takes_them() -> None:
    good = [[0, 1, 2.5], [3, 4, -5e-3]]
    given: list[Any] = [
        {"loop": good, "friction of mesh": good, "error": good, "__proto__": good},
        {"loop": [[0, 1], [1]]},
        {"loop": [[0, "1"], [1, 2]]},
        {"loop": [[0, None], [1, 2]]},
        {"loop": [[0] * 3001] * 2},
        {"loop": "text"},
        [good],
        None,
        3,
    ]
    found = in_node("points", given=given)
    assert found[0] == [["loop", *good], ["friction of mesh", *good]]
    assert found[1:] == [[]] * (len(given) - 1)


@needs_node
def test_columns_of_measurements_are_read() -> None:
    texts = {
        "a,b\n1,2\n3,-4e1\n": [[1, 3], [2, -40], 1],
        "1;2,5\n3;4,5": [[1, 3], [2.5, 4.5], 0],
        "1,5\t2,3\n2,5\t4": [[1.5, 2.5], [2.3, 4], 0],
        "1,5 2,3\n\n2.5 4 7\nend": [[1.5, 2.5], [2.3, 4], 1],
        "1, 2\n3 ,4": [[1, 3], [2, 4], 0],
        "1 2": "no two columns of numbers found",
        "\n".join(["1 2"] * 9): "more than 5 points",
    }
    assert dict(zip(texts, in_node("columns", texts=list(texts)), strict=True)) == texts


@needs_node
def test_a_fit_needs_a_point_for_each_number() -> None:
    assert "2 points do not determine 3 numbers" in in_node("refuse_fit", numbers=[1.0, 2.0, 3.0, 0.0], measured=[1.0, 2.0])
    assert "all numbers are zero" in in_node("refuse_fit", numbers=[0.0], measured=[1.0, 2.0])


def test_units_of_commands_are_those_of_the_drive() -> None:
    of = {name: model["command"] for name, model in schema()["models"].items() if model["command"]}
    assert (of["control.PID"], of["control.PI"], of["motor.TorqueSource"], of["motor.DC"]) == ("rad", "rad/s", "N.m", "V")
    assert "control.Sampled" not in of


def identified(**parts: Any) -> GearSet:
    """Return a gear set as from a log: of the drive, the parts given."""
    whole = GearSet.of(sw.Drive(gear=sw.load("csg-20-100"), **parts), name="joint", source="identified from log.csv")
    sources = {path: entry for path, entry in whole.sources.items() if path.partition(".")[0] in {"gear", *parts}}
    others = {"motor", "control", "load", "sensors", "thermal", "meter"} - parts.keys()
    return whole.replace(sources=sources, **dict.fromkeys(others))


def test_a_drive_has_the_parts_of_its_set_and_a_controller_that_holds_them() -> None:
    source, load = sw.motor.CurrentSource(torque_constant=0.1, inertia=0.0), sw.loads.Pendulum(inertia=1.0, gravity_torque=25.0)
    gear_set = identified(motor=source, load=load)
    drive = drive_around(gear_set)
    assert (drive.motor, drive.load, start_of(gear_set)["parts"]) == (source, load, ["motor", "load"])
    run = sw.simulate(drive, sw.scenario.step(amplitude=0.5, duration=8.0))
    assert run["output_angle"][-1] == pytest.approx(0.5, abs=0.01)


def test_a_motor_that_takes_a_voltage_is_replaced_and_its_sources_are_left_out() -> None:
    gear_set = identified(motor=sw.motor.DC(inertia=3e-5))
    start = start_of(gear_set)
    assert drive_around(gear_set).motor == sw.motor.TorqueSource(inertia=3e-5)
    assert "motor" not in start["parts"]
    assert not [path for path in start["sources"] if path.startswith(("motor.", "control."))]


@pytest.mark.parametrize("law", [sw.stiffness.Backlash(clearance=0.0025), sw.stiffness.Linear(k=1e-6)])
def test_a_gear_within_its_play_has_a_drive(law: Any) -> None:
    gear_set = GearSet.of(sw.Gear(stiffness=law), name="play", source="measured")
    assert drive_around(gear_set).control.limit > 0.0


def test_no_text_of_a_gear_ends_its_element() -> None:
    assert "<" not in embedded({"name": "</script><script>alert(1)"})
    assert json.loads(embedded({"name": "</script>"})) == {"name": "</script>"}


def read_in_page(texts: list[str]) -> list[Any]:
    found: list[Any] = in_node("read", schema=schema(), texts=texts)
    return found


def written(gear_set: GearSet, path: Path) -> str:
    gear_set.save(path)
    return path.read_text()


@needs_node
@pytest.mark.slow("report")
@pytest.mark.filterwarnings("ignore")
def test_the_page_reads_files_as_the_package_does(drives: list[sw.Drive], tmp_path: Path) -> None:
    sets = [GearSet.read(name) for name in sw.catalogue("drives")] + [GearSet.read(name) for name in sw.catalogue()[:5]]
    sets += [GearSet.of(drive, name="random", source="a test") for drive in drives[-20:]]
    names = ("gear.stiffness.k1", "gear.damping")
    covariance = Covariance(names, ((4.0, 1.0), (1.0, 2.0)))
    sets.append(GearSet.read("csg-20-100").replace(covariance=covariance))
    for gear_set, found in zip(sets, read_in_page([written(each, tmp_path / "gear.toml") for each in sets]), strict=True):
        assert not isinstance(found, str), found
        read = GearSet.read(tmp_path / "gear.toml") if gear_set is sets[-1] else gear_set
        drive = model_of(sw.Drive, found["drive"])
        assert (found["name"], found["maker"], found["note"], drive.gear) == (read.name, read.maker, read.note, read.gear)
        parts = {name: getattr(read, name) for name in found["parts"]}
        assert {name: getattr(drive, name) for name in parts} == parts
        assert {path: Entry(*entry) for path, entry in found["sources"].items()} == {
            path: entry for path, entry in read.sources.items() if path in found["sources"]
        }
        assert {path for path, entry in read.sources.items() if entry.source != "not given"} <= found["sources"].keys()
        ratings = {
            name: [each.value, each.unit, each.source, each.spread, each.uncertainty] for name, each in read.ratings.items()
        }
        assert found["ratings"] == ratings
    assert found["covariance"] == {"numbers": list(names), "matrix": [list(row) for row in covariance.matrix]}


SMALL = """name = "small"
[kinematics]
model = "plain_ratio"
reduction = { value = 20, source = "counted" }
[stiffness]
model = "linear"
k = { value = 12.5, unit = "N.m/deg", source = "loop", uncertainty = 0.4, spread = 0.1 }
[friction_input]
model = "thermal"
dry_fall = { value = 0.0, unit = "1/K", source = "assumed" }
viscous_fall = { value = 0.025, unit = "1/K", source = "runs" }
reference_temperature = { value = 20.0, unit = "degC", source = "thermometer" }
[friction_input.law]
model = "viscous"
viscous = { value = 2.0, unit = "mN.m.s/rad", source = "runs" }
[gear]
damping = { value = 0.05, unit = "N.m.s/rad", source = "assumed" }
input_inertia = { value = 21.0, unit = "g.cm2", source = "CAD" }
"""


@needs_node
def test_units_of_a_file_are_converted(tmp_path: Path) -> None:
    (tmp_path / "small.toml").write_text(SMALL)
    gear_set = GearSet.read(tmp_path / "small.toml")
    (found,) = read_in_page([SMALL])
    gear = model_of(sw.Gear, found["drive"]["gear"])
    for path, law in (
        ("stiffness.k", "stiffness"),
        ("input_inertia", ""),
        ("friction_input.law.viscous", "friction_input.law"),
    ):
        expected, own = gear_set.gear, gear
        for name in path.split("."):
            expected, own = getattr(expected, name), getattr(own, name)
        assert own == pytest.approx(expected, rel=1e-15), law
    assert gear.friction_input.reference_temperature == 293.15
    source, spread, sigma = found["sources"]["gear.stiffness.k"]
    assert (source, spread, sigma) == ("loop", 0.1, pytest.approx(gear_set.sources["gear.stiffness.k"].uncertainty, rel=1e-15))


@needs_node
def test_a_wrong_file_is_refused_with_its_place() -> None:
    number = '{ value = 12.5, unit = "N.m/deg", source = "loop", uncertainty = 0.4, spread = 0.1 }'
    wrong = {
        "": "name: missing",
        "\x00\x01": "line 1: a key expected",
        "[datasheet]\nratio = 100": "this is a data sheet",
        SMALL.replace('name = "small"', "name = 3"): "name: a text expected",
        SMALL.replace("[stiffness]", "[stifness]"): "stifness: no part of a gear file",
        SMALL.replace('model = "linear"', 'model = "liner"'): "[stiffness] model: one of linear, piecewise",
        SMALL.replace("k = {", "k1 = {"): "[stiffness] k1: no parameter of stiffness.Linear",
        SMALL.replace("N.m/deg", "N/deg"): "[stiffness] k: the unit N/deg does not measure what N.m/rad does",
        SMALL.replace("N.m/deg", "furlong"): "[stiffness] k: the unit furlong is not known to this page; write N.m/rad",
        SMALL.replace("N.m/deg", "constructor"): "[stiffness] k: the unit constructor is not known",
        SMALL.replace(', source = "loop"', ""): "[stiffness] k: source missing",
        SMALL.replace("uncertainty = 0.4", "uncertainty = -0.4"): "uncertainty must be a number of at least 0",
        SMALL.replace("uncertainty = 0.4", "sigma = 0.4"): "[stiffness] k: an entry has no sigma",
        SMALL.replace("value = 12.5", "value = -12.5"): "stiffness.Linear.k must be above 0",
        SMALL.replace("value = 12.5", 'value = "12.5"'): "[stiffness] k: value must be a number",
        SMALL.replace("value = 12.5", "value = 1e999"): "[stiffness] k: value must be a number",
        SMALL.replace(number, "12.5"): "[stiffness] k: a number is written as",
        SMALL.replace("[friction_input.law]", "[friction_input.lay]"): "[friction_input] lay: no parameter of friction.Thermal",
        SMALL.partition("[friction_input.law]")[0]: "[friction_input.law]: missing",
        SMALL.partition("[stiffness]")[0]: "[stiffness]: missing",
        SMALL.replace("damping =", "dampin ="): "[gear] dampin: no parameter of Gear",
        SMALL.replace("[gear]", "[gear.stiffness]"): "[gear] stiffness: a table of its own",
        SMALL + "[gear]": "[gear] comes twice",
        SMALL + "[[motor]]": "[motor]: a table expected",
        SMALL + "[__proto__]": "__proto__: no part of a gear file",
        SMALL + "[ratings]\nx = 1": "[ratings] x: a number is written as",
        SMALL + '[covariance]\nnumbers = ["gear.damping"]\nmatrix = [[1.0, 2.0]]': "[covariance]: numbers, and a matrix",
    }
    for found, (text, expected) in zip(read_in_page(list(wrong)), wrong.items(), strict=True):
        assert isinstance(found, str), (expected, text)
        assert expected in found


@needs_node
def test_a_text_is_read_or_refused_as_by_the_package() -> None:
    random = Random(3)
    pieces = [*"\"'\\\n[]{}=,.#1-", '"""', "'''", "\\u00e9", "e5", "true", "[[x]]"]
    lines = SMALL.splitlines(keepends=True)
    texts = []
    for _ in range(800):
        begin = random.randrange(len(lines))
        text = "".join(lines[begin : begin + random.randrange(1, 8)])
        for _ in range(random.randrange(4)):
            at = random.randrange(len(text) + 1)
            text = text[:at] + random.choice(pieces) + text[at + random.choice((0, 1, 5)) :]
        texts.append(text)
    equal = 0
    for text, found in zip(texts, in_node("toml", texts=texts), strict=True):
        try:
            expected: Any = [tomllib.loads(text)]
        except tomllib.TOMLDecodeError:
            expected = None
        assert (found if isinstance(found, list) else None) == expected, text
        equal += expected is not None
    assert 200 < equal < 600


@needs_node
def test_what_is_nested_or_long_is_refused_at_once() -> None:
    texts = [
        "a=" + "[" * 100_000,
        "a=" + "{b=" * 100_000,
        "a" + ".b" * 100_000 + "=1",
        "[" * 1_000_000,
        'a="' + "\\\\" * 300_000,
    ]
    begun = perf_counter()
    assert all(isinstance(found, str) for found in in_node("toml", texts=texts))
    assert perf_counter() - begun < 5.0


@needs_node
def test_an_origin_of_a_link_has_nothing_that_cannot_be_written(tmp_path: Path) -> None:
    drive = changed(drive_around(GearSet.read("csg-20-100")))
    entry = ["line\none\u00a0\ud800", -1.0, "text"]
    wrong = {
        "drive": drive,
        "maker": ["x"],
        "note": "a\u007f\u0000b\nc",
        "parts": ["motor", "gear", "__proto__", 3],
        "sources": {"gear.damping": entry, "gear.stiffness.k1": None, "__proto__": ["x"]},
        "ratings": {
            "rated_torque": [5.0, "kgf.m", "a"],
            'a"b': [1.0, "N.m", "a"],
            "b": ["1", "N.m", "a"],
            "c": [1.0, ["N.m"], "a"],
            "d": [1.0, "furlong", "a"],
        },
        "covariance": {"numbers": ['a"', "b"], "matrix": [[1.0, 0.0], [0.0, 1.0]]},
    }
    found, refused, none = in_node("origin", schema=schema(), given=[wrong, {"drive": {"gear": {"damping": "1"}}}, {}])
    assert refused == "Gear.damping: a finite number expected"
    assert none == "Drive: parameters expected"
    assert (found["maker"], found["note"], found["parts"], found["covariance"]) == ("", "a  b\nc", ["motor"], None)
    assert found["sources"]["gear.damping"] == ["line one \ufffd", None, None]
    assert found["sources"]["gear.stiffness.k1"] == ["not given", None, None]
    assert found["ratings"] == {"rated_torque": [5.0, "kgf.m", "a", None, None]}
    assert found["rated"] == pytest.approx(49.03325)
