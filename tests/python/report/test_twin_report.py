"""The report of a twin: complete, honest about contradictions, self-contained, readable in both schemes, repeatable."""

from __future__ import annotations

import itertools
import re
from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from html.parser import HTMLParser
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pytest
import strainwave as sw
from strainwave.demo import position_drive, torsion_rig
from strainwave.gear_set import Entry, GearSet
from strainwave.identify.evidence import Doubt
from strainwave.identify.experiment import TorsionLoop
from strainwave.report import figures
from strainwave.report.experiment import Experiment, Figure
from strainwave.report.page import write
from strainwave.report.twin import Provenance, twin_report

from tests.strategies import made

HOSTILE = '<script>alert("x")</script> & <b>table</b>.csv'
SPEED = np.concatenate((-np.geomspace(0.5, 150.0, 15)[::-1], np.geomspace(0.5, 150.0, 15)))
LAW = sw.friction.LuGre(
    coulomb=0.06, breakaway=0.11, stribeck_speed=3.0, bristle_stiffness=90.0, bristle_damping=0.004, viscous=7e-4
)


# ---- Twins of synthetic measurements ---------------------------------------------------------------------------------


def friction_table() -> sw.Recording:
    torque = LAW.steady(SPEED) * (1.0 + 0.01 * np.random.default_rng(1).normal(size=len(SPEED)))
    return sw.Recording({"speed": SPEED, "torque": torque}, {"speed": "rad/s", "torque": "N.m"}, title="a < b")


def torsion_loop() -> sw.Recording:
    quarter = np.linspace(0.0, 1e-3, 60)
    path = np.concatenate((quarter[::-1], -quarter[1:], -quarter[-2::-1], quarter[1:]))
    elements = sw.hysteresis.MaxwellSlip(stiffness=[8e3, 4e3], breakaway=[0.8, 1.2])
    torque = elements.trace(np.concatenate((path, path)))[-len(path) :] + 3e4 * path
    torque += 0.01 * np.random.default_rng(2).normal(size=len(path))
    return sw.Recording({"twist": path, "torque": torque}, {"twist": "rad", "torque": "N.m"})


def input_loop(start: GearSet) -> sw.Recording:
    """The same gear, measured at the input with the output locked."""
    loop, ratio = torsion_loop(), start.gear.kinematics.ratio
    angle = ratio * loop["twist"]
    torque = loop["torque"] / ratio + 0.05 * np.sign(np.gradient(angle))
    return sw.Recording({"input_angle": angle, "input_torque": torque}, {"input_angle": "rad", "input_torque": "N.m"})


def with_drive(start: GearSet) -> GearSet:
    """The set with a small motor, a controller and a load, given by a maker."""
    rest = {
        "motor": sw.motor.DC(resistance=2.0, inductance=1e-3, torque_constant=0.05, back_emf=0.05, inertia=5e-5),
        "control": sw.control.PID(proportional=10.0, derivative=0.1, limit=24.0),
        "load": sw.loads.Inertia(inertia=0.2),
    }
    numbers = {
        f"{part}.{member['name']}": Entry("data sheet", uncertainty=0.0)
        for part, model in rest.items()
        for member in model.fields
    }
    return replace(start, sources={**start.sources, **numbers}, **rest)


def drive_log(start: GearSet) -> sw.Recording:
    command = sw.scenario.sine(amplitude=0.1, frequency=2.0, duration=0.6, phase=-np.pi / 2, offset=0.1)
    run, random = sw.simulate(start.drive, command, sample=5e-3), np.random.default_rng(3)
    noise = {"input_angle": 1e-4, "output_angle": 2e-6, "current": 5e-3}
    columns = {name: run[name] + sigma * random.normal(size=len(run)) for name, sigma in noise.items()}
    names = ("time", "command")
    units = {name: run.unit(name) for name in (*names, *noise)}
    return sw.Recording({name: run[name] for name in names} | columns, units)


def swing(samples: int, amplitude: float = 0.1) -> sw.Recording:
    time = np.linspace(0.0, 2.0, samples)
    command = amplitude * np.sin(2.0 * np.pi * time)
    columns = {"time": time, "command": command, "output_angle": 0.9 * command}
    return sw.Recording(columns, {"time": "s", "command": "rad", "output_angle": "rad"})


@pytest.fixture(scope="module")
def start() -> GearSet:
    return GearSet.read("hfuc-25-100")


@pytest.fixture(scope="module")
def from_friction(start: GearSet) -> sw.Twin:
    return sw.twin(start, friction=friction_table(), sources={"friction": HOSTILE})


@pytest.fixture(scope="module")
def from_torsion(start: GearSet) -> sw.Twin:
    return sw.twin(start, torsion=torsion_loop())


@pytest.fixture(scope="module")
def from_input(start: GearSet) -> sw.Twin:
    return sw.twin(start, torsion=input_loop(start))


@pytest.fixture(scope="module")
def from_log(start: GearSet) -> sw.Twin:
    full = with_drive(start)
    return sw.twin(full, log=drive_log(full))


@pytest.fixture(scope="module")
def contradicted(start: GearSet) -> sw.Twin:
    """A set whose friction was measured before, and now is another."""
    earlier = Entry("test report 7 <of 2019>", uncertainty=1e-3)
    sources = {**start.sources, "gear.friction_input.coulomb": earlier, "gear.friction_input.viscous": earlier}
    return sw.twin(replace(start, sources=sources), friction=friction_table(), sources={"friction": "table of today"})


@pytest.fixture(scope="module")
def complete(start: GearSet) -> sw.Twin:
    """A gear with every kind of part, models inside models too."""
    losses = sw.friction.LoadDependent(driving_forward=0.1, driving_reverse=0.1)
    gear = start.gear.replace(
        kinematic_noise=sw.kinematic_error.Stochastic(amplitude=1e-5, seed=7),
        hysteresis=sw.hysteresis.Preisach(density=sw.hysteresis.GridDensity(limit=1e-3, weight=[1.0, 2.0, 1.0])),
        friction_mesh=sw.friction.Thermal(law=sw.friction.Cyclic(law=losses, order=[2.0], amplitude=[0.1], phase=[0.0])),
        friction_output=made(sw.friction.PositionDependent, cosine=[1e-3, 2e-3]),
    )
    return sw.twin(GearSet.of(gear, name="complete", source="assumed"), friction=friction_table())


EACH = ["from_friction", "from_torsion", "from_input", "from_log", "contradicted", "complete"]


@pytest.fixture(scope="module", params=EACH)
def each(request: pytest.FixtureRequest) -> sw.Twin:
    found: sw.Twin = request.getfixturevalue(request.param)
    return found


@pytest.fixture(scope="module")
def html(each: sw.Twin) -> str:
    """The report of each twin, with two experiments of one name."""
    return twin_report(each, [Experiment("sine", (("twin", swing(50)),))] * 2)


# ---- Reading a page --------------------------------------------------------------------------------------------------


@dataclass
class Node:
    """An element of a page."""

    tag: str
    attributes: dict[str, str]
    children: list[Node | str] = field(default_factory=list)

    def walk(self) -> Iterator[Node]:
        yield self
        for child in self.children:
            if isinstance(child, Node):
                yield from child.walk()

    def find(self, tag: str, **attributes: str) -> list[Node]:
        return [n for n in self.walk() if n.tag == tag and attributes.items() <= n.attributes.items()]

    @property
    def text(self) -> str:
        parts = [child if isinstance(child, str) else child.text for child in self.children if child_is_read(child)]
        return " ".join("".join(parts).split())


def child_is_read(child: Node | str) -> bool:
    return isinstance(child, str) or child.tag not in ("style", "svg")


class Page(HTMLParser):
    """Builds the tree of a page and refuses one whose elements are not closed in order."""

    VOID = frozenset({"meta", "col", "br", "link", "img", "hr", "input", "wbr"})

    def __init__(self, html: str) -> None:
        super().__init__()
        self.open = [Node("page", {})]
        self.feed(html)
        self.close()
        assert len(self.open) == 1, f"<{self.open[-1].tag}> is not closed"

    @property
    def root(self) -> Node:
        return self.open[0]

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        node = Node(tag, {name: value or "" for name, value in attrs})
        self.open[-1].children.append(node)
        if tag not in self.VOID:
            self.open.append(node)

    def handle_startendtag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.open[-1].children.append(Node(tag, {name: value or "" for name, value in attrs}))

    def handle_endtag(self, tag: str) -> None:
        assert self.open[-1].tag == tag, f"</{tag}> closes <{self.open[-1].tag}>"
        self.open.pop()

    def handle_data(self, data: str) -> None:
        self.open[-1].children.append(data)


def section(html: str, name: str) -> Node:
    found = Page(html).root.find("section", id=name)
    assert len(found) == 1
    return found[0]


def printed(text: str) -> float:
    """A printed number without its uncertainty."""
    match = re.fullmatch(r"\(?(−?[\d.]+)(?: ± [^)]+)?\)?(?: × 10([⁻⁰¹²³⁴⁵⁶⁷⁸⁹]+))?", text.partition(" ± ∞")[0])
    assert match, text
    power = (match[2] or "⁰").translate(str.maketrans("⁻⁰¹²³⁴⁵⁶⁷⁸⁹", "-0123456789"))
    return float(f"{match[1].replace('−', '-')}e{power}")


# ---- What a report says ----------------------------------------------------------------------------------------------


def in_a_part_left_out(found: sw.Twin, path: str) -> bool:
    return path.rpartition(".")[0] in found.gear_set.left_out


def rows_of_parameters(html: str) -> dict[str, list[str]]:
    rows = [row for row in section(html, "parameters").find("tr") if row.find("code")]
    return {row.find("code")[0].text: [cell.text for cell in row.find("td")] for row in rows}


def test_every_parameter_of_the_twin_stands_in_the_table_with_its_value(each: sw.Twin, html: str) -> None:
    rows = rows_of_parameters(html)
    paths = each.gear_set.sources.keys() | {verdict.path for verdict in each.verdicts}
    assert rows.keys() >= {path for path in paths if not in_a_part_left_out(each, path)}
    for verdict in each.verdicts:
        if in_a_part_left_out(each, verdict.path):
            continue
        start, value, _, _, why = rows[verdict.path]
        rounding = max(0.0501 * verdict.sigma if np.isfinite(verdict.sigma) else 0.0, 5e-6 * abs(verdict.value))
        assert printed(value) == pytest.approx(verdict.value, rel=0.0, abs=rounding)
        assert (start == "") == np.isnan(verdict.start)
        assert why


def test_a_part_that_does_nothing_is_one_line(from_friction: sw.Twin) -> None:
    html = twin_report(from_friction)
    rows = rows_of_parameters(html)
    for part in ("gear.kinematic_noise", "gear.friction_mesh"):
        assert [path for path in rows if path.startswith(part)] == [part]
        assert rows[part][1] == "none"
    assert "not given" not in section(html, "parameters").text + section(html, "unknown").text + section(html, "sources").text
    assert "random" not in section(html, "sources").text.lower()


def test_a_part_that_does_nothing_but_was_fitted_is_shown_with_its_numbers(start: GearSet) -> None:
    sources = {**start.sources, "gear.friction_mesh.viscous": Entry("fitted to a drive log: none")}
    found = sw.twin(replace(start, sources=sources), friction=friction_table())
    assert rows_of_parameters(twin_report(found))["gear.friction_mesh.viscous"][1] == "0"


def test_the_state_of_every_parameter_is_the_verdict(each: sw.Twin, html: str) -> None:
    shown = {path: cells[3] for path, cells in rows_of_parameters(html).items()}
    for verdict in each.verdicts:
        moved = verdict.state == "kept" and verdict.value != verdict.start
        if not in_a_part_left_out(each, verdict.path):
            assert shown[verdict.path] == ("follows" if moved else verdict.state)


def test_whatever_is_not_identified_is_listed_with_its_reason(each: sw.Twin, html: str) -> None:
    page = section(html, "unknown").text
    for verdict in each.verdicts:
        if verdict.state != "identified" and not in_a_part_left_out(each, verdict.path):
            assert re.sub(r"\b(\w)_(\w)\b", r"\1\2", verdict.why) in page  # symbols are set with a subscript


def test_a_model_inside_a_model_has_its_own_rows_and_neither_is_absent(complete: sw.Twin) -> None:
    html = twin_report(complete)
    parts = [cell.text for cell in section(html, "parameters").find("th", **{"class": "part"})]
    for name in ("Friction mesh", "Friction mesh, law", "Friction mesh, law, law", "Hysteresis", "Hysteresis, density"):
        model: object = complete.gear_set.gear
        for part in name.lower().replace(" ", "_").split(",_"):
            model = getattr(model, part)
        law = (type(model).__doc__ or "").partition("\n")[0]
        assert f"{name} {law}" in parts
    assert "not in the model" not in section(html, "unknown").text


def test_a_part_that_the_model_lacks_is_said_to_be_absent() -> None:
    found = position_drive()
    assert not any("kinematic_error" in path for path in found.gear_set.sources)
    assert "Kinematic error" in section(twin_report(found), "summary").text
    assert "not in the model" in section(twin_report(found), "unknown").text


def test_the_error_on_data_held_out_stands_in_the_summary(from_torsion: sw.Twin) -> None:
    summary = section(twin_report(from_torsion), "summary")
    error = from_torsion.evidence[0].error[0]
    measured = from_torsion.evidence[0].fit.experiment.measured
    assert summary.find("p", **{"class": "headline"})[0].text == f"{1e3 * error:.3g} mN·m"
    assert f"{100.0 * error / np.ptp(measured):.2g} % of the range measured" in summary.text


def test_every_channel_of_a_log_has_its_error_and_its_figure(from_log: sw.Twin) -> None:
    html = twin_report(from_log)
    assert [term.text for term in section(html, "summary").find("dt")][:3] == [
        "Input angle", "Output angle", "Motor current",
    ]  # fmt: skip
    assert len(section(html, "log").find("figure")) == 3


def test_a_contradiction_shows_both_values_and_both_sources_and_no_average(contradicted: sw.Twin) -> None:
    html = twin_report(contradicted)
    assert {found.path for found in contradicted.contradictions} == {"gear.friction_input.coulomb"}
    measured = contradicted.contradictions[0].measured
    for name in ("summary", "contradictions"):
        page = section(html, name)
        assert page.find("div", **{"class": "box contradiction"})
        for text in ("0.0901 ± 0.0010", f"{measured:.5f} ± ", "test report 7 <of 2019>", "table of today"):
            assert text in page.text
        assert f"{0.5 * (measured + 0.09005):.3f}" not in page.text


def test_a_contradiction_of_friction_is_drawn_as_two_data_sets(contradicted: sw.Twin, from_friction: sw.Twin) -> None:
    assert len(section(twin_report(contradicted), "contradictions").find("svg")) == 1
    labels = [text.text for text in section(twin_report(contradicted), "contradictions").find("text")]
    assert {"starting set", "measured", "fitted to the table"} <= set(labels)
    assert 'id="contradictions"' not in twin_report(from_friction)
    assert "No contradiction found" in twin_report(from_friction)


def test_a_spring_of_another_kind_is_contradicted_by_its_first_stiffness(start: GearSet) -> None:
    known = Entry("torsion rig of 2019", uncertainty=10.0)
    found = sw.twin(replace(start, sources={**start.sources, "gear.stiffness.k1": known}), torsion=torsion_loop())
    (contradiction,) = [found for found in found.contradictions if "stiffness" in found.path]
    assert contradiction.path == "gear.stiffness.k"
    page = section(twin_report(found), "contradictions").text
    assert "26700 ± 10" in page
    assert "torsion rig of 2019" in page


def test_the_parameters_fitted_are_counted_by_what_is_known_of_them(each: sw.Twin, html: str) -> None:
    shown = re.search(r"Fitted parameters: ([^.]*)\.", Page(html).root.find("header")[0].text)
    assert shown
    counts = {state: int(count) for count, state in (part.split(" ", 1) for part in shown[1].split(", "))}
    fitted = [verdict.state for verdict in each.verdicts if verdict.state != "kept"]
    assert counts == {state: fitted.count(state) for state in set(fitted)}


def test_one_told_in_combination_is_not_counted_as_identified(from_input: sw.Twin) -> None:
    assert any(verdict.state == "identified in combination" for verdict in from_input.verdicts)
    assert "1 identified in combination" in Page(twin_report(from_input)).root.find("header")[0].text


def test_a_doubt_comes_before_all_else_and_marks_its_measurement(from_friction: sw.Twin) -> None:
    (evidence,) = from_friction.evidence
    doubt = Doubt(evidence.source, "it gives 70 times the torque", "turn it round")
    html = twin_report(replace(from_friction, evidence=(replace(evidence, doubts=(doubt,)),)))
    header = [node for node in Page(html).root.find("header")[0].children if isinstance(node, Node)]
    assert [node.tag for node in header[:3]] == ["div", "h1", "div"]
    assert header[2].attributes["role"] == "alert"
    for words in (HOSTILE, doubt.what, doubt.remedy):
        assert words in header[2].text
    for name in ("summary", "friction"):
        assert "This measurement is doubted" in section(html, name).text
    assert "doubted" not in Page(twin_report(from_friction)).root.text


def test_a_loop_from_the_input_is_said_to_be_referred_to_the_output(from_input: sw.Twin, from_torsion: sw.Twin) -> None:
    page = section(twin_report(from_input), "torsion")
    labels = [text.text for text in page.find("text")]
    assert {"torque referred to the output [N·m]", "twist referred to the output [mrad]", "model with friction"} <= set(labels)
    for words in ("angles divided by the ratio", "inside the model's curve", "just behind each reversal are left out"):
        assert words in page.find("figcaption")[0].text
    other = section(twin_report(from_torsion), "torsion").text
    assert "ratio" not in other
    assert "left out" not in other


def test_samples_that_were_not_compared_are_told(from_input: sw.Twin, from_torsion: sw.Twin) -> None:
    loop = from_input.evidence[0].fit.experiment
    assert isinstance(loop, TorsionLoop)
    assert len(loop.twist) < loop.samples
    told = f"{loop.samples} samples, compared in {len(loop.twist)} points"
    for name in ("summary", "torsion"):
        assert told in section(twin_report(from_input), name).text
        assert "compared in" not in section(twin_report(from_torsion), name).text


def test_points_that_are_means_are_told(from_torsion: sw.Twin) -> None:
    (evidence,) = from_torsion.evidence
    loop = evidence.fit.experiment
    assert isinstance(loop, TorsionLoop)
    thinned = replace(evidence, fit=replace(evidence.fit, experiment=replace(loop, samples=9_000)))
    told = "Each point is the mean of neighbouring samples"
    assert told in section(twin_report(replace(from_torsion, evidence=(thinned,))), "torsion").text
    assert told not in section(twin_report(from_torsion), "torsion").text


def test_a_single_branch_is_called_one(start: GearSet) -> None:
    loop = torsion_loop()
    up = np.argsort(loop["twist"][59:178])
    branch = {name: loop[name][59:178][up] - loop[name][59:178].min() for name in ("twist", "torque")}
    page = Page(twin_report(sw.twin(start, torsion=sw.Recording(branch, {"twist": "rad", "torque": "N.m"})))).root
    torsion = page.find("section", id="torsion")[0]
    assert torsion.find("h2")[0].text == "Torsion branch"
    assert "the measured branch" in torsion.find("figcaption")[0].text
    assert not any("loop" in figcaption.text for figcaption in torsion.find("figcaption"))


# ---- Experiments -----------------------------------------------------------------------------------------------------


def test_experiments_show_every_run_and_every_figure_beside_the_published_one(from_torsion: sw.Twin) -> None:
    error = Figure("largest error", "rad", (0.0123, 0.0456), published=0.0042)
    experiment = Experiment(
        "sine", (("_twin", swing(50)), (HOSTILE, swing(60))), (error,), remark="amplitude assumed", source="Table 4"
    )
    page = section(twin_report(from_torsion, [experiment]), "experiments")
    assert [cell.text for cell in page.find("tr")[1].children if isinstance(cell, Node)] == [
        "largest error", "0.0123", "0.0456", "0.0042", "rad",
    ]  # fmt: skip
    assert "compared, not reproduced" in page.text
    assert "amplitude assumed" in page.text
    labels = [text.text for text in page.find("text")]
    assert {"command", "_twin", " ".join(HOSTILE.split())} <= set(labels)


def test_an_open_loop_experiment_draws_the_command_by_itself() -> None:
    run = sw.Recording(
        {"time": [0.0, 1.0], "command": [0.0, 5.0], "output_angle": [0.0, 0.1]},
        {"time": "s", "command": "V", "output_angle": "rad"},
    )
    drawn = Page(figures.experiment(Experiment("step", (("twin", run),)), "e")).root
    labels = [text.text for text in drawn.find("text")]
    assert "command [V]" in labels
    assert not any("response" in label for label in labels)


def test_an_experiment_refuses_what_it_cannot_show() -> None:
    with pytest.raises(ValueError, match=r'^experiment "e" has no run$'):
        Experiment("e", ())
    with pytest.raises(ValueError, match=r'^experiment "e": run "a" has no column "torque"$'):
        Experiment("e", (("a", swing(9)),), response="torque")
    with pytest.raises(ValueError, match=r'^experiment "e": rms has 2 values for 1 runs$'):
        Experiment("e", (("a", swing(9)),), (Figure("rms", "rad", (1.0, 2.0)),))


# ---- Narrow pages ----------------------------------------------------------------------------------------------------


def test_a_cell_of_a_table_says_its_column_where_the_table_is_taken_apart(html: str) -> None:
    tables = [table for table in Page(html).root.find("table") if "rows" in table.attributes.get("class", "").split()]
    assert tables
    for table in tables:
        columns = [column.text for column in table.find("thead")[0].find("th")]
        for row in table.find("tbody")[0].find("tr"):
            cells = [cell for cell in row.children if isinstance(cell, Node)]
            for column, cell in zip(columns, cells, strict=False):
                assert cell.attributes.get("data-label", column) == column


def test_a_figure_is_as_wide_as_its_box(html: str) -> None:
    style = Page(html).root.find("style")[0]
    rules = re.findall(r"([^{}]*)\{([^{}]*)\}", "".join(child for child in style.children if isinstance(child, str)))
    of_figures = [rule for selector, rule in rules if selector.strip().endswith("svg")]
    assert of_figures
    assert all("width: 100%" in rule and "min-width" not in rule for rule in of_figures)
    assert not any({"width", "height"} & svg.attributes.keys() for svg in Page(html).root.find("svg"))


# ---- The page as a file ----------------------------------------------------------------------------------------------


def test_the_page_is_well_formed_and_no_name_stands_twice(html: str) -> None:
    names = [node.attributes["id"] for node in Page(html).root.walk() if "id" in node.attributes]
    assert len(names) == len(set(names))
    references = re.findall(r"(?:href=\"|url\()#([^\")]+)", html)
    assert references
    assert set(references) <= set(names)


def test_the_page_refers_to_nothing_outside_itself(html: str) -> None:
    assert not re.search(r"https?:|//\w|@import|<link|<img|<iframe|<script", html)
    for reference in re.findall(r"(?:href|src)=\"([^\"]*)|url\(([^)]*)", html):
        assert "".join(reference).startswith(("#", "data:"))


def test_markup_in_names_is_shown_and_not_obeyed(from_friction: sw.Twin) -> None:
    html = twin_report(from_friction, provenance=Provenance(command=HOSTILE, files={HOSTILE: "0" * 64}))
    assert "<script" not in html
    assert "<b>table" not in html
    page = Page(html).root
    assert HOSTILE in page.find("header")[0].text
    assert page.find("footer")[0].find("code")[0].text == HOSTILE
    assert any(HOSTILE in svg.attributes["aria-label"] for svg in page.find("svg"))
    assert "a < b" in section(html, "friction").text, "the title of the recording"


def test_the_same_twin_gives_the_same_bytes_and_the_date_is_the_one_given(from_friction: sw.Twin) -> None:
    provenance = Provenance("2026-01-01", "strainwave twin", {})
    assert twin_report(from_friction, (), provenance) == twin_report(from_friction, (), provenance)
    assert "2026-01-01" in twin_report(from_friction, (), provenance)
    assert not re.search(r"20\d\d-\d\d-\d\d", twin_report(from_friction))


def test_the_preferences_of_a_machine_do_not_change_the_report(from_friction: sw.Twin) -> None:
    import matplotlib as mpl

    expected = twin_report(from_friction)
    with mpl.rc_context({"font.size": 20.0, "axes.grid": False, "text.usetex": False, "lines.linewidth": 9.0}):
        assert twin_report(from_friction) == expected
        assert mpl.rcParams["font.size"] == 20.0


def test_drawing_leaves_no_figure_open(from_friction: sw.Twin) -> None:
    import sys

    twin_report(from_friction)
    assert "matplotlib.pyplot" not in sys.modules or not sys.modules["matplotlib.pyplot"].get_fignums()


def test_a_long_record_stays_small_and_keeps_its_peak() -> None:
    run = swing(400_000)
    noisy = run["output_angle"] + 1e-3 * np.random.default_rng(1).normal(size=len(run))
    noisy[123_456] = 0.4
    svg = figures.experiment(Experiment("long", (("twin", run.with_column("output_angle", noisy, "rad")),)), "long")
    assert len(svg) < 80_000
    lines = [points(path) for path in Page(svg).root.find("path") if "--model" in path.attributes.get("style", "")]
    response = next(line for line in lines if len(line) > 100)
    assert response[:, 1].min() < np.quantile(response[:, 1], 0.01) - 20.0, "the peak towers, upright is negative"
    assert np.argmin(response[:, 1]) / len(response) == pytest.approx(123_456 / 400_000, abs=0.02)


def test_provenance_holds_the_digest_of_each_file(tmp_path: Path) -> None:
    file = tmp_path / "loop.csv"
    file.write_bytes(b"abc")
    provenance = Provenance.of([file], command="strainwave twin", date="2026-01-01")
    # FIPS 180-2, appendix B.1
    assert provenance.files == {"loop.csv": "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad"}


def test_a_page_that_cannot_be_written_leaves_the_old_one(tmp_path: Path) -> None:
    write("old", tmp_path / "report.html")
    with pytest.raises(UnicodeEncodeError):
        write("\ud800", tmp_path / "report.html")
    assert [path.name for path in tmp_path.iterdir()] == ["report.html"]
    assert (tmp_path / "report.html").read_text() == "old"


# ---- Figures ---------------------------------------------------------------------------------------------------------


def points(path: Node) -> np.ndarray:
    numbers = [float(number) for number in re.findall(r"-?[\d.]+", path.attributes["d"])]
    return np.reshape(numbers, (-1, 2))


LONG = "what a run may be called when somebody wants to tell how it differs from the one before it"
Box = tuple[float, float, float, float]


def boxes(svg: Node) -> dict[str, Box]:
    """Left, top, right and bottom of every text of a drawing, in letters as wide as DejaVu Sans."""
    from matplotlib.textpath import TextPath

    found = {}
    for text in svg.find("text"):
        style = dict(re.findall(r"([\w-]+): ([^;]+)", text.attributes["style"]))
        size = float(style["font-size"].removesuffix("px"))
        width = TextPath((0.0, 0.0), text.text.replace("$", " "), size=size).get_extents().width
        x, y = (float(number) for number in re.findall(r"-?[\d.]+", text.attributes["transform"])[-2:])
        left = x - {"start": 0.0, "middle": 0.5, "end": 1.0}[style.get("text-anchor", "start")] * width
        found[f"{text.text} at {x:g}, {y:g}"] = (left, y - 0.7 * size, left + width, y)
    return found


def apart(one: Box, other: Box) -> bool:
    return one[2] < other[0] or other[2] < one[0] or one[3] < other[1] or other[3] < one[1]


def drawings(found: sw.Twin) -> list[Node]:
    long_names = Experiment("long names", ((LONG, swing(50)), (HOSTILE, swing(60))), response="output_angle")
    return Page(twin_report(found, [long_names])).root.find("svg")


def test_every_text_of_a_figure_is_inside_it_and_on_no_other(each: sw.Twin) -> None:
    for svg in drawings(each):
        _, _, width, height = (float(number) for number in svg.attributes["viewbox"].split())
        texts = boxes(svg)
        assert len(texts) > 10
        for name, (left, top, right, bottom) in texts.items():
            assert 0.0 <= left < right <= width, name
            assert 0.0 <= top < bottom <= height, name
        for (name, one), (other_name, other) in itertools.combinations(texts.items(), 2):
            assert apart(one, other), f"{name}; {other_name}"


def test_every_curve_has_its_name_in_the_legend(each: sw.Twin) -> None:
    wanted = {"friction": {"measured", "model"}, "torsion": {"measured", "held out"}, "log": {"measured", "model"}}
    for evidence in each.evidence:
        for svg in section(twin_report(each), evidence.kind).find("svg"):
            assert wanted[evidence.kind] <= {text.text for text in svg.find("text")}


def test_nothing_is_drawn_across_what_was_left_out(from_input: sw.Twin) -> None:
    evidence = from_input.evidence[0]
    loop = evidence.fit.experiment
    assert isinstance(loop, TorsionLoop)
    starts = figures.gaps(loop)
    assert starts
    assert all(abs(loop.twist[i] - loop.twist[i - 1]) > 0.015 * np.ptp(loop.twist) for i in starts)
    drawn = Page(figures.torsion_loop(evidence)).root
    curves = [path for path in drawn.find("path") if re.search(r"stroke: var\(--model", path.attributes.get("style", ""))]
    assert len([curve for curve in curves if len(points(curve)) > 10]) == len(starts) + 1


def test_a_loop_of_which_nothing_was_left_out_has_no_gap(from_input: sw.Twin, from_torsion: sw.Twin) -> None:
    loop, at_output = (found.evidence[0].fit.experiment for found in (from_input, from_torsion))
    assert isinstance(loop, TorsionLoop)
    assert isinstance(at_output, TorsionLoop)
    assert figures.gaps(replace(loop, samples=len(loop.twist))) == []
    assert figures.gaps(replace(at_output, samples=9_000)) == []


def test_points_are_drawn_where_they_were_measured() -> None:
    found = position_drive()
    drawn = Page(figures.friction_table(found.evidence[0])).root
    groups = [group for group in drawn.find("g") if "--measured" in group.attributes.get("style", "")]
    places = np.array([(float(use.attributes["x"]), float(use.attributes["y"])) for use in groups[0].find("use")])
    recording = found.evidence[0].recording
    for column, name in enumerate(("speed", "torque")):
        line = np.polynomial.Polynomial.fit(recording[name], places[:, column], 1)
        assert np.abs(line(recording[name]) - places[:, column]).max() < 0.01, "SVG is written to hundredths"


def test_residuals_are_drawn_over_their_samples(from_torsion: sw.Twin) -> None:
    evidence = from_torsion.evidence[0]
    drawn = Page(figures.torsion_loop(evidence)).root
    curves = [points(path) for path in drawn.find("path") if "--ink" in path.attributes.get("style", "")]
    across, upright = max(curves, key=len).T
    residual = evidence.fit.residuals[0]
    sample = np.rint((across - across[0]) / np.ptp(across) * (len(residual) - 1)).astype(int)
    assert len(np.unique(sample)) > 0.9 * len(residual), "points on a straight line may be left out"
    assert np.corrcoef(upright, residual[sample])[0, 1] == pytest.approx(-1.0, abs=1e-4)


@pytest.mark.parametrize("scheme", [figures.LIGHT, figures.DARK])
def test_every_colour_can_be_told_from_the_paper(scheme: dict[str, str], from_friction: sw.Twin) -> None:
    """Contrast by WCAG 2.2: 4.5 for text, 3 for graphics; the rules of the grid are meant to be faint."""
    paper = re.findall(r"--paper: (#\w{6})", twin_report(from_friction))[scheme is figures.DARK]
    for name, colour in scheme.items():
        assert contrast(colour, paper) > {"ink": 7.0, "rule": 1.2}.get(name, 4.5)


def contrast(one: str, other: str) -> float:
    light, dark = sorted((luminance(one), luminance(other)), reverse=True)
    return (light + 0.05) / (dark + 0.05)


def luminance(colour: str) -> float:
    channels = np.array([int(colour[i : i + 2], 16) for i in (1, 3, 5)]) / 255.0
    linear = np.where(channels <= 0.04045, channels / 12.92, ((channels + 0.055) / 1.055) ** 2.4)
    return float(linear @ (0.2126, 0.7152, 0.0722))


def test_no_colour_is_fixed_so_that_figures_follow_the_scheme(html: str) -> None:
    figures_of_page = Page(html).root.find("svg")
    assert figures_of_page
    for node in (node for svg in figures_of_page for node in svg.walk()):
        for value in node.attributes.values():
            assert not re.search(r"#[0-9a-f]{6}\b", re.sub(r"var\(--[\w-]+, #\w{6}\)", "", value))


def test_the_overview_stands_by_itself() -> None:
    picture = figures.overview(torsion_rig().evidence[0], position_drive().evidence[0])
    assert len(picture) < 60_000
    root = ElementTree.fromstring(picture)
    assert root.tag == "{http://www.w3.org/2000/svg}svg"
    style = root[0].text or ""
    for colours in (figures.LIGHT, figures.DARK):
        assert all(f"--{name}: {colour};" in style for name, colour in colours.items())


def test_limits_of_the_maker_that_were_exceeded_stand_in_the_summary() -> None:
    twist = np.linspace(0.0, 6e-3, 100)
    branch = sw.Recording({"twist": twist, "torque": 3e4 * twist}, {"twist": "rad", "torque": "N.m"})
    found = sw.twin("csg-20-100", torsion=branch)
    summary = section(twin_report(found), "summary").text
    (check,) = (check for check in found.ratings if check.name == "peak_torque")
    assert "Limits of the maker exceeded" in summary
    assert "peak torque: 180 N.m exceeds the limit of 107 N.m" in summary
    assert check.reached == pytest.approx(180.0)
    light = sw.Recording({"twist": twist / 3.0, "torque": 1e4 * twist}, {"twist": "rad", "torque": "N.m"})
    assert "exceeded" not in section(twin_report(sw.twin("csg-20-100", torsion=light)), "summary").text
