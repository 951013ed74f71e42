"""The page of the workbench in a browser: it draws, changes, links and exports."""

from __future__ import annotations

import json
import os
import re
import shutil
from collections.abc import Iterator
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import numpy as np
import pytest
import strainwave as sw
from strainwave.files.entries import Entry
from strainwave.files.gear_set import GearSet
from strainwave.workbench.page import FILE, MISSING, page

from tests.python.command import strainwave
from tests.python.workbench.node import needs_page

CHROMIUM = shutil.which("chromium") or shutil.which("chromium-browser") or shutil.which("google-chrome")
AXE = Path(__file__).parents[3] / "build" / "workbench" / "npm" / "node_modules" / "axe-core" / "axe.min.js"
SVG = "{http://www.w3.org/2000/svg}"
READINGS = """() => Object.fromEntries([...document.querySelectorAll(".plot")]
    .map(plot => [plot.id, plot.querySelector(".numbers").textContent]))"""
INKED = """canvas => {
    const { data } = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height);
    return data.filter((value, i) => i % 4 === 2 && value > data[i - 2] + 60).length; }"""  # pixels that are rather blue


@pytest.fixture(scope="module")
def browser() -> Iterator[Any]:
    playwright = pytest.importorskip("playwright.sync_api")
    if CHROMIUM is None:
        pytest.skip("Chromium is not installed")
    with playwright.sync_playwright() as started:
        opened = started.chromium.launch(executable_path=CHROMIUM, args=["--no-sandbox"] if os.getuid() == 0 else [])
        yield opened
        opened.close()


@pytest.fixture
def tab(browser: Any, tmp_path: Path) -> Iterator[Any]:
    """A tab with the page of a gear; whatever the page reports as an error fails the test."""
    file = tmp_path / "gear.html"
    file.write_text(page(GearSet.read("csg-20-100")))
    opened = browser.new_page(viewport={"width": 1400, "height": 1000}, accept_downloads=True)
    errors: list[str] = []
    opened.on("pageerror", lambda error: errors.append(str(error)))
    opened.on("console", lambda message: errors.append(message.text) if message.type in ("error", "warning") else None)
    opened.goto(file.as_uri())
    opened.locator(".numbers b").nth(10).wait_for()
    yield opened
    opened.close()
    assert errors == []


def number(readings: dict[str, str], plot: str) -> float:
    """Return the first number that a plot shows."""
    found = re.search(r"-?[\d.]+(e[+-]?\d+)?", readings[plot].partition("rpm")[2] or readings[plot])
    assert found
    return float(found[0])


def readings(tab: Any) -> dict[str, str]:
    tab.wait_for_timeout(600)  # until the hand rests and the run is drawn
    found: dict[str, str] = tab.evaluate(READINGS)
    return found


@needs_page
@pytest.mark.slow("report")
def test_every_plot_shows_what_the_package_computes(tab: Any) -> None:
    shown = readings(tab)
    assert len(shown) == 7
    gear = sw.load("csg-20-100")
    arcmin = 3.141592653589793 / 10800.0
    assert number(shown, "loop") == pytest.approx(0.5, rel=1e-3)  # the set was made with a loop of this width
    amplitude = gear.kinematic_error.amplitude[0] / arcmin
    assert number(shown, "error") == pytest.approx(2.0 * amplitude, rel=1e-3)
    assert number(shown, "orders") == pytest.approx(amplitude, rel=1e-3)
    assert number(shown, "friction") == pytest.approx(gear.friction_input.steady(52.4), rel=1e-3)
    assert [tab.locator("canvas").nth(i).evaluate(INKED) > 100 for i in range(7)] == [True] * 7


@needs_page
@pytest.mark.slow("report")
def test_a_dragged_slider_changes_the_loop_and_undo_brings_it_back(tab: Any) -> None:
    before = readings(tab)
    slider = tab.locator(".row", has=tab.locator("#field-gear\\.hysteresis\\.breakaway\\.0")).locator("input[type=range]")
    slider.scroll_into_view_if_needed()
    box = slider.bounding_box()
    middle = box["y"] + box["height"] / 2
    tab.mouse.move(box["x"] + box["width"] / 2, middle)
    tab.mouse.down()
    tab.mouse.move(box["x"] + 0.9 * box["width"], middle, steps=5)
    tab.mouse.up()
    assert number(readings(tab), "loop") > 1.2 * number(before, "loop")
    tab.locator("#undo").click()
    assert readings(tab) == before
    tab.locator("#redo").click()
    assert number(readings(tab), "loop") > 1.2 * number(before, "loop")


@needs_page
@pytest.mark.slow("report")
def test_a_link_opens_the_same_gear(tab: Any, browser: Any) -> None:
    field = tab.locator("#field-gear\\.stiffness\\.k1")
    field.fill("3")
    field.press("Enter")
    shown = readings(tab)
    other = browser.new_page(viewport={"width": 390, "height": 800})
    other.goto(tab.evaluate("location.href"))
    other.locator(".numbers b").nth(10).wait_for()
    assert readings(other) == shown
    assert other.evaluate("document.documentElement.scrollWidth") == 390
    other.locator("#catalogue").select_option("hfuc-25-100")
    assert other.locator("#name").input_value() == "HFUC-25-100"
    other.goto(f"{FILE.as_uri()}#no-gear")
    other.reload()
    other.locator("#status.bad").wait_for()
    assert "the link cannot be read" in other.locator("#status").text_content()
    other.close()


@needs_page
@pytest.mark.slow("report")
def test_exports_contain_the_gear_as_changed(tab: Any, tmp_path: Path) -> None:
    field = tab.locator("#field-gear\\.damping")
    field.fill("7.5")
    field.press("Enter")
    with tab.expect_download() as loaded:
        tab.locator("#toml").click()
    loaded.value.save_as(tmp_path / "gear.toml")
    gear_set = GearSet.read(tmp_path / "gear.toml")
    assert gear_set.gear == sw.load("csg-20-100").replace(damping=7.5)
    assert gear_set.sources["gear.damping"].source == "set in the workbench"
    assert gear_set.sources["gear.stiffness.k1"] != gear_set.sources["gear.damping"]
    tab.locator("#python").click()
    names: dict[str, Any] = {}
    exec(tab.locator("#text-content").input_value(), names)
    assert names["gear"] == gear_set.gear
    in_page = number(readings(tab), "run") * 3.141592653589793 / 10800.0
    assert in_page == pytest.approx(names["run"]["output_angle"][-1], rel=1e-3)
    tab.locator("#text-close").click()
    for name in ("CSV", "PNG", "SVG"):
        with tab.expect_download() as loaded:
            tab.locator("#loop").get_by_role("button", name=name).click()
        loaded.value.save_as(tmp_path / name)
    assert (tmp_path / "CSV").read_text().startswith("curve,twist [arcmin],torque [N·m]\nnow,0,0\n")
    assert (tmp_path / "PNG").read_bytes().startswith(b"\x89PNG")
    drawn = ElementTree.fromstring((tmp_path / "SVG").read_text())
    assert {text.text for text in drawn.iter(f"{SVG}text")} >= {"twist [arcmin]", "torque [N·m]", "0"}
    (curve,) = (path for path in drawn.iter(f"{SVG}path") if path.get("stroke-width") == "1.7")
    assert curve.get("d", "").count("L") == 480  # three stretches


@needs_page
@pytest.mark.slow("report")
def test_numbers_show_their_source_and_assumptions_are_named(tab: Any) -> None:
    row = tab.locator(".row", has=tab.locator("#field-gear\\.hysteresis\\.breakaway\\.0"))
    assert row.locator(".mark").text_content() == "assumed"
    assert "Source: assumed: k1 x 0.5 arcmin" in row.get_attribute("title")
    shown = readings(tab)
    assert "from assumed numbers" in shown["loop"]
    assert "motor, controller and load are assumed" in shown["run"]
    tab.locator("#catalogue").select_option("hfuc-25-100")
    stiffness = tab.locator(".row", has=tab.locator("#field-gear\\.stiffness\\.k1"))
    assert stiffness.locator(".mark").text_content() == "Harmonic Drive AG catalogue"
    entry = GearSet.read("hfuc-25-100").sources["gear.hysteresis.breakaway[0]"]
    assert row.get_attribute("title") == f"Source: {entry.source}"
    assert "single gears scatter by ± 30 %" in tab.locator(
        ".row", has=tab.locator("#field-gear\\.stiffness\\.k1")
    ).get_attribute("title")
    assert "rated torque not given" in tab.locator("#loop").text_content()
    tab.locator("#undo").click()
    assert "30 % of rated torque" in tab.locator("#loop").text_content()
    assert "Source: assumed: k1 x 0.5 arcmin" in row.get_attribute("title")


@needs_page
@pytest.mark.slow("report")
def test_fields_take_numbers_alone_and_show_them_whole(tab: Any) -> None:
    amplitude = tab.locator("#run .controls label", has_text="amplitude")
    assert amplitude.text_content().strip() == "amplitude  arcmin"
    assert "= 0.1 rad" in tab.locator("#run .controls").nth(1).text_content()
    amplitude.locator("input").fill("0.05 rad")
    amplitude.locator("input").press("Enter")
    assert tab.evaluate("workbench.then(each => each.view.run.amplitude)") == 0.05
    assert "grey dashes: command" in readings(tab)["run"]
    field = tab.locator("#field-gear\\.stiffness\\.k1")
    before = field.input_value()
    field.fill("")
    field.press("Enter")
    assert field.evaluate("each => each.validationMessage") == "must be a number"
    assert tab.evaluate("workbench.then(each => each.state.drive.gear.stiffness.k1)") == 13719.5
    tab.locator("#law-gear\\.friction_input").select_option("viscous")
    assert field.input_value() == before
    tab.evaluate("document.querySelectorAll('details').forEach(each => { each.open = true; })")
    for path, long in (
        ("input_inertia", "0.00012345678"),
        ("kinematic_error\\.phase\\.0", "-0.000012345678"),
        ("damping", "1234567891"),
    ):
        tab.locator(f"#field-gear\\.{path}").fill(long)
        tab.locator(f"#field-gear\\.{path}").press("Enter")
    assert tab.locator("#field-gear\\.input_inertia").input_value() == "1.234568e-4"
    cut = "inputs => inputs.filter(each => each.scrollWidth > each.clientWidth).map(each => each.id)"
    assert tab.locator("#fields input:not([type=range])").evaluate_all(cut) == []


@needs_page
@pytest.mark.slow("report")
def test_undo_works_from_a_slider_and_a_name_has_whole_characters(tab: Any) -> None:
    tab.evaluate(r"""() => {
        document.getElementById("name").value = "a\ud800\u2028b";
        document.getElementById("name").onchange();
    }""")
    assert tab.evaluate("workbench.then(each => each.state.name)") == "a\ufffd b"
    tab.locator("input[type=range]").first.focus()
    tab.keyboard.press("Control+z")
    assert tab.locator("#name").input_value() == "CSG-20-100"


@needs_page
@pytest.mark.slow("report")
def test_undo_in_a_field_is_that_of_the_page_unless_its_text_is_new(tab: Any) -> None:
    k1 = "workbench.then(each => each.state.drive.gear.stiffness.k1)"
    field = tab.locator("#field-gear\\.stiffness\\.k1")
    before = field.input_value()
    for undo, redo in (("Control+z", "Control+y"), ("Control+z", "Control+Shift+z")):
        field.click()
        tab.keyboard.press("Control+a")
        tab.keyboard.type("5")
        tab.keyboard.press("Enter")
        tab.keyboard.press(undo)
        assert (field.input_value(), tab.evaluate(k1)) == (before, 13719.5)
        assert tab.evaluate("document.activeElement.id") == "field-gear.stiffness.k1"
        tab.keyboard.press(redo)
        assert (field.input_value(), tab.evaluate(k1)) == ("5", pytest.approx(5.0 * 10800.0 / np.pi))
        tab.keyboard.type("7")  # not taken yet
        tab.keyboard.press("Control+z")
        assert (field.input_value(), tab.evaluate(k1)) == ("5", pytest.approx(5.0 * 10800.0 / np.pi))
        tab.keyboard.press("Control+z")
        assert (field.input_value(), tab.evaluate(k1)) == (before, 13719.5)
    tab.locator("#name").click()
    assert tab.evaluate(k1) == 13719.5
    amplitude = tab.locator("#run .controls label", has_text="amplitude").locator("input")
    shown = amplitude.input_value()
    amplitude.fill("7")
    amplitude.press("Enter")
    amplitude.press("Control+z")
    assert amplitude.input_value() == shown


@needs_page
@pytest.mark.slow("report")
def test_the_units_of_a_controller_are_those_of_its_motor(tab: Any) -> None:
    tab.evaluate("document.querySelectorAll('details').forEach(each => { each.open = true; })")
    limit = tab.locator(".row", has=tab.locator("#field-control\\.limit"))
    assert limit.locator("label small").first.text_content() == "N·m"
    assert limit.locator(".doc").first.text_content().startswith("Largest torque, of either sign [N·m]")
    proportional = tab.locator("#field-control\\.proportional")
    gain = tab.evaluate("workbench.then(each => each.state.drive.control.proportional)")
    proportional.fill(f"{2.0 * gain} N.m/rad")
    proportional.press("Enter")
    assert tab.evaluate("workbench.then(each => each.state.drive.control.proportional)") == pytest.approx(2.0 * gain)
    assert "motor and load are assumed; some numbers of the controller are assumed" in readings(tab)["run"]
    for motor, unit in (("dc", "V"), ("current_source", "A"), ("torque_source", "N·m")):
        tab.locator("#law-motor").select_option(motor)
        assert limit.locator("label small").first.text_content() == unit


@needs_page
@pytest.mark.slow("report")
def test_a_link_to_a_number_scrolls_the_form_alone_and_a_gear_opens_at_the_top(tab: Any) -> None:
    readings(tab)
    tab.evaluate("scrollTo(0, 40)")
    tab.locator("#loop .strongest button").first.evaluate("each => each.click()")
    top = "[document.activeElement.getBoundingClientRect().top, innerHeight]"
    place, height = tab.evaluate(top)
    assert tab.evaluate("document.activeElement.id") == "field-gear.hysteresis.breakaway.0"
    assert tab.evaluate("scrollY") == 40
    assert tab.evaluate("document.getElementById('form').scrollTop") > 0
    assert 0 < place < height
    tab.evaluate("scrollTo(0, 300)")
    tab.locator("#catalogue").select_option("hfuc-25-100")
    assert tab.evaluate("[scrollY, document.getElementById('form').scrollTop]") == [0, 0]


@needs_page
@pytest.mark.slow("report")
def test_the_pointer_reads_the_next_order(tab: Any) -> None:
    shown = readings(tab)["orders"]
    box = tab.locator("#orders .u-over").bounding_box()
    words = set()
    for share in np.linspace(0.02, 0.3, 40):
        tab.locator("#orders .u-over").hover(position={"x": share * box["width"], "y": 0.5 * box["height"]})
        words.add(tab.locator("#orders .at").text_content())
    amplitude = re.search(r"largest (.*) of order 2", shown)
    assert amplitude
    assert f"order 2: {amplitude[1]}" in words
    assert "order 1: " in " ".join(words)


@needs_page
@pytest.mark.slow("report")
def test_measured_data_are_drawn_and_compared(tab: Any) -> None:
    tab.locator("#friction").get_by_role("button", name="Data…").click()
    friction = sw.load("csg-20-100").friction_input
    rpm = 3.141592653589793 / 30.0
    lines = [f"{speed},{friction.steady(speed * rpm) + 0.01 * (-1) ** speed}" for speed in range(10, 1000, 10)]
    lines += [f"{speed + 1},{friction.steady((speed + 1) * rpm) - 0.01}" for speed in range(10, 1000, 10)]
    tab.locator("#text-content").fill("\n".join(lines))
    tab.locator("#text-use").click()
    assert tab.locator("#status").text_content() == "198 points read"
    assert "RMS residual 0.01 N·m of 198 points" in readings(tab)["friction"]
    field = tab.locator("#field-gear\\.friction_input\\.viscous")
    field.fill("0.01")
    field.press("Enter")
    assert "RMS residual 0.01 N·m" not in readings(tab)["friction"]
    tab.get_by_role("button", name="Fit").click()
    shown = readings(tab)
    assert "RMS residual 0.01 N·m of 198 points" in shown["friction"]
    tab.reload()
    tab.locator("#friction .measured").wait_for()
    assert readings(tab)["friction"] == shown["friction"]


@needs_page
@pytest.mark.slow("report")
def test_the_numbers_that_change_a_reading_most_stand_below_it(tab: Any) -> None:
    assert readings(tab)["loop"].startswith("loop width 0.5 arcmin")
    strongest = tab.locator("#loop .strongest")
    shown = strongest.text_content().replace("\u00a0", " ")
    assert shown.startswith("loop width grows with hysteresis breakaway 1 (+3.3 %), hysteresis breakaway 2 (+3.3 %), ")
    assert shown.endswith("; falls with stiffness k1 (−9.1 %), for 10 % more of each")
    strongest.get_by_role("button", name="hysteresis breakaway 1").click()
    assert tab.evaluate("document.activeElement.id") == "field-gear.hysteresis.breakaway.0"
    field = tab.locator("#field-gear\\.hysteresis\\.breakaway\\.0")
    field.fill(str(1.1 * float(field.input_value())))
    field.press("Enter")
    assert number(readings(tab), "loop") == pytest.approx(0.5 * 1.033, rel=1e-3)


@needs_page
@pytest.mark.slow("report")
def test_the_help_of_a_number_shows_what_twice_as_much_changes(tab: Any) -> None:
    shown = {
        "gear.hysteresis.breakaway.0": "torque over twist: solid now, dashed with twice as much",
        "gear.stiffness.k3": "torque over twist: the same with twice as much",  # beyond the travel
        "gear.friction_input.viscous": "friction over speed: solid now, dashed with twice as much",
        "gear.kinematic_error.order.0": "kinematic error over a turn: solid now, dashed with twice as much",
        "gear.damping": "output angle over time: solid now, dashed with twice as much",
    }
    for path, words in shown.items():
        field = tab.locator(f"#field-{path.replace('.', chr(92) + '.')}")
        field.focus()
        picture = tab.locator(".row:focus-within .picture")
        assert picture.locator("svg").get_attribute("aria-label").endswith(words)
        now, more = (path.get_attribute("d") for path in picture.locator("path").all())
        assert (now == more) == ("the same" in words)
    tab.locator("#field-gear\\.friction_input\\.viscous").focus()
    tab.locator(".row:focus-within .picture button").click()
    equation = tab.locator("fieldset", has=tab.locator("#law-gear\\.friction_input")).locator("details.help")
    assert equation.locator("math").first.is_visible()
    assert tab.locator(".row:focus-within .picture svg").is_visible()


@needs_page
@pytest.mark.slow("report")
def test_friction_of_another_place_is_drawn_compared_and_fitted(tab: Any) -> None:
    tab.evaluate("document.querySelectorAll('details').forEach(each => { each.open = true; })")
    tab.locator("#law-gear\\.friction_output").select_option("coulomb")
    tab.locator("#friction").get_by_label("place of the friction").select_option("output")
    for name, value in (("coulomb", "0.4"), ("viscous", "0.5")):
        tab.locator(f"#field-gear\\.friction_output\\.{name}").fill(value)
        tab.locator(f"#field-gear\\.friction_output\\.{name}").press("Enter")
    assert number(readings(tab), "friction") == pytest.approx(0.4 + 0.5 * 0.524, rel=1e-3)
    tab.locator("#friction").get_by_role("button", name="Data…").click()
    assert "friction of the output" in tab.locator("#text-title").text_content()
    rpm = 3.141592653589793 / 30.0
    tab.locator("#text-content").fill("\n".join(f"{speed},{0.6 + 0.3 * speed * rpm}" for speed in range(1, 20)))
    tab.locator("#text-use").click()
    tab.get_by_role("button", name="Fit").click()
    readings(tab)
    law = tab.evaluate("workbench.then(each => each.state.drive.gear.friction_output)")
    assert (law["coulomb"], law["viscous"]) == (pytest.approx(0.6, rel=1e-6), pytest.approx(0.3, rel=1e-6))
    tab.locator("#friction").get_by_label("place of the friction").select_option("sum at the input")
    assert "measured" not in readings(tab)["friction"]
    gear = sw.load("csg-20-100")
    expected = gear.friction_input.steady(52.4) + (0.6 + 0.3 * 0.524) / 100.0
    assert number(readings(tab), "friction") == pytest.approx(expected, rel=1e-3)
    tab.locator("#python").click()
    names: dict[str, Any] = {}
    exec(tab.locator("#text-content").input_value(), names)
    assert names["friction"][-1] == pytest.approx(gear.friction_input.steady(210.0) + (0.6 + 0.3 * 2.1) / 100.0)


@needs_page
@pytest.mark.slow("report")
def test_a_random_part_of_the_error_is_drawn_and_stated(tab: Any) -> None:
    tab.evaluate("document.querySelectorAll('details').forEach(each => { each.open = true; })")
    assert "random" not in readings(tab)["error"]
    tab.locator("#field-gear\\.kinematic_noise\\.amplitude").fill("0.1")
    tab.locator("#field-gear\\.kinematic_noise\\.amplitude").press("Enter")
    rms = float(re.search(r"RMS of this turn ([\d.]+)", readings(tab)["error"])[1])
    assert 0.03 < rms < 0.3
    assert number(readings(tab), "error") > 0.45
    assert "sensors" not in readings(tab)["error"]
    for angle, noise in (("output_angle", "3e-5"), ("input_angle", "4e-3")):
        tab.locator(f"#law-sensors\\.{angle}").select_option("noisy")
        tab.locator(f"#field-sensors\\.{angle}\\.amplitude").fill(noise)
        tab.locator(f"#field-sensors\\.{angle}\\.amplitude").press("Enter")
    found = float(re.search(r"noise of the angle sensors, RMS ([\d.]+)", readings(tab)["error"])[1])
    assert found == pytest.approx(5e-5 * 10800.0 / np.pi, rel=1e-3)  # 1:100, so 3e-5 and 4e-5 rad at the output


@needs_page
@pytest.mark.slow("report")
def test_a_gear_file_is_opened_with_its_sources_and_its_link_keeps_them(tab: Any, browser: Any, tmp_path: Path) -> None:
    known = GearSet.read("hfuc-25-100")
    measured = Entry("identified from loop.csv", uncertainty=300.0)
    load = sw.loads.Inertia(inertia=0.5)
    mine = known.replace(name="mine", sources=dict(known.sources) | {"gear.stiffness.k1": measured})
    mine.with_parts(load=load, source="weighed").save(tmp_path / "mine.toml")
    tab.locator("#file").set_input_files(tmp_path / "mine.toml")
    tab.locator("#status", has_text="mine.toml").wait_for()
    assert tab.locator("#status").text_content() == "mine.toml read; motor and controller as before, because the file has none"
    row = tab.locator(".row", has=tab.locator("#field-gear\\.stiffness\\.k1"))
    assert row.locator(".mark").text_content().startswith("identified ± ")
    assert "motor and controller are assumed" in readings(tab)["run"]
    other = browser.new_page()
    other.goto(tab.evaluate("location.href"))
    other.locator(".numbers b").nth(10).wait_for()
    readings(other)
    assert other.locator("#name").input_value() == "mine"
    with other.expect_download() as loaded:
        other.locator("#toml").click()
    loaded.value.save_as(tmp_path / "again.toml")
    again = GearSet.read(tmp_path / "again.toml")
    assert (again.gear, again.load, again.motor) == (known.gear, load, None)
    assert again.sources["gear.stiffness.k1"] == measured
    assert again.sources["gear.stiffness.k2"] == known.sources["gear.stiffness.k2"]
    other.close()
    tab.locator("#undo").click()
    assert tab.locator("#name").input_value() == "CSG-20-100"


@needs_page
@pytest.mark.slow("report")
def test_a_wrong_or_hostile_file_is_refused_in_a_sentence(tab: Any, tmp_path: Path) -> None:
    def status_of(content: bytes) -> str:
        (tmp_path / "wrong.toml").write_bytes(content)
        tab.locator("#status").evaluate("each => { each.textContent = ''; }")
        tab.locator("#file").set_input_files(tmp_path / "wrong.toml")
        tab.locator("#status", has_text="wrong.toml").wait_for()
        return str(tab.locator("#status").text_content())

    before = readings(tab)
    assert status_of(b"\x89PNG\xff\xfe\x00") == "wrong.toml cannot be read as a gear file: line 1: a key expected"
    assert "larger than a gear file" in status_of(b"#" * (2**21 + 1))
    good = Path(tmp_path / "good.toml")
    GearSet.read("csg-20-100").save(good)
    text = good.read_text()
    assert "k1: the unit furlong is not known" in status_of(text.replace("N.m/rad", "furlong", 1).encode())
    assert readings(tab) == before
    evil = "<img src=x onerror=alert(1)>"
    given = text.replace("CSG-20-100", evil).replace("Harmonic Drive AG catalogue", evil)
    assert status_of(given.encode()).startswith("wrong.toml read; ")
    assert tab.locator("#name").input_value() == evil
    assert tab.locator("main img").count() == 0


@needs_page
@pytest.mark.slow("report")
def test_a_dropped_file_is_a_gear_or_measured_data_of_a_plot(tab: Any) -> None:
    drop = """([where, name, content]) => {
        const data = new DataTransfer();
        data.items.add(new File([content], name));
        const event = new DragEvent("drop", { dataTransfer: data, bubbles: true, cancelable: true });
        document.querySelector(where).dispatchEvent(event);
    }"""
    tab.evaluate(drop, ["#loop canvas", "loop.csv", "0,0\n1,5\n2,11\n"])
    tab.locator("#loop .measured").wait_for()
    assert "of 3 points" in readings(tab)["loop"]
    tab.evaluate(drop, ["#loop canvas", "gear.toml", 'name = "x"\n[stiffnes]\n'])
    tab.locator("#status.bad").wait_for()
    assert tab.locator("#status").text_content() == "gear.toml cannot be read as a gear file: stiffnes: no part of a gear file"
    tab.evaluate(drop, ["#form", "loop.csv", "0,0\n1,5\n"])
    tab.locator("#status", has_text="loop.csv cannot be read as a gear file").wait_for()


@needs_page
@pytest.mark.slow("report")
def test_a_measured_loop_is_drawn_from_the_zeros_that_its_fit_finds(tab: Any) -> None:
    gear = sw.load("csg-20-100")
    twist = 1e-3 * np.concatenate([np.linspace(1.0, -1.0, 100), np.linspace(-1.0, 1.0, 100)])
    torque = gear.trace(np.concatenate([[0.0], twist, twist]))[-200:] + 0.02 * (-1.0) ** np.arange(200)
    arcmin = 10800.0 / np.pi
    tab.locator("#loop").get_by_role("button", name="Data…").click()
    points = zip((twist + 2e-4) * arcmin, torque + 1.0, strict=True)
    tab.locator("#text-content").fill("\n".join(f"{x} {y}" for x, y in points))
    tab.locator("#text-use").click()
    field = tab.locator("#field-gear\\.stiffness\\.k1")
    field.fill(str(1.1 * float(field.input_value())))
    field.press("Enter")
    assert float(re.search(r"RMS residual ([\d.]+)", readings(tab)["loop"])[1]) > 1.0
    tab.get_by_role("button", name="Fit").click()
    assert "numbers fitted in" in tab.locator("#status").text_content()
    shown = readings(tab)["loop"]
    assert "RMS residual 0.02" in shown
    assert float(re.search(r"zeros: torque ([\d.]+)", shown)[1]) == pytest.approx(1.0, abs=0.02)
    assert float(re.search(r"twist ([\d.]+) arcmin", shown)[1]) == pytest.approx(2e-4 * arcmin, abs=0.01)
    assert float(tab.locator("#loop .controls input").input_value()) == pytest.approx(1e-3 * arcmin, rel=1e-2)  # the travel
    tab.locator("#undo").click()
    assert "zeros" not in readings(tab)["loop"]


@needs_page
@pytest.mark.slow("report")
@pytest.mark.skipif(not AXE.is_file(), reason="axe-core is not installed: python3 dev.py workbench")
@pytest.mark.parametrize(("scheme", "width"), [("light", 1280), ("dark", 1280), ("light", 390)])
def test_axe_finds_no_barrier(browser: Any, tmp_path: Path, scheme: str, width: int) -> None:
    (tmp_path / "gear.html").write_text(page(GearSet.read("csg-20-100")))
    context = browser.new_context(bypass_csp=True, color_scheme=scheme, viewport={"width": width, "height": 800})
    tab = context.new_page()
    tab.goto((tmp_path / "gear.html").as_uri())
    tab.locator(".numbers b").nth(1).wait_for()
    tab.add_script_tag(path=AXE)

    def violations() -> list[str]:
        readings(tab)
        found = tab.evaluate("axe.run(document, { resultTypes: ['violations'] })")["violations"]
        return [f"{each['id']}: {each['nodes'][0]['html']}" for each in found]

    assert violations() == []
    tab.evaluate("document.querySelectorAll('details').forEach(each => { each.open = true; })")
    tab.locator("#keep").click()
    tab.locator("#field-gear\\.stiffness\\.k1").fill("3")
    tab.locator("#field-gear\\.stiffness\\.k1").press("Enter")  # help, another gear, and a source beside the first
    assert violations() == []
    tab.locator("#python").click()
    assert violations() == []
    context.close()


@needs_page
@pytest.mark.slow("report")
def test_a_kept_gear_is_drawn_beside_and_any_law_can_be_chosen(tab: Any) -> None:
    tab.locator("#keep").click()
    for law in tab.evaluate("[...document.getElementById('law-gear.stiffness').options].map(each => each.value)"):
        tab.locator("#law-gear\\.stiffness").select_option(law)
        assert "CSG-20-100" in readings(tab)["loop"]
    tab.locator("#law-gear\\.friction_input").select_option("thermal")
    tab.locator("#law-gear\\.friction_input\\.law").select_option("coulomb")
    tab.get_by_role("button", name="one more element of amplitude").first.click()
    assert tab.locator("#field-gear\\.kinematic_error\\.phase\\.1").count() == 1
    tab.locator("#swap").click()
    assert tab.locator("#law-gear\\.friction_input").input_value() == "coulomb"


@needs_page
def test_the_command_writes_the_page_of_a_gear(tmp_path: Path) -> None:
    done = strainwave("workbench", "hfuc-20-80", folder=tmp_path)
    assert done.stdout == f"wrote {Path('out/workbench.html')}; open it in a browser\n"
    content = re.search(r'id="gear">(.*?)</script>', (tmp_path / "out" / "workbench.html").read_text())
    assert content
    assert json.loads(content[1])["name"] == "HFUC-20-80"


def test_without_the_built_page_the_remedy_is_named(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setattr("strainwave.workbench.page.FILE", tmp_path / "workbench.html")
    with pytest.raises(FileNotFoundError, match=re.escape(MISSING)):
        page()
