"""What the report of a twin says: all of it, and honestly about contradictions and doubts."""

from __future__ import annotations

import re
from dataclasses import replace

import numpy as np
import pytest
import strainwave as sw
from strainwave.demo import position_drive
from strainwave.files.entries import Entry
from strainwave.files.gear_set import GearSet
from strainwave.identification.evidence.evidence import Doubt
from strainwave.identification.experiments.torsion_loop import TorsionLoop
from strainwave.report import figures
from strainwave.report.experiment import Figure, SimulatedExperiment
from strainwave.report.twin import twin_report

from tests.python.report.reading import Node, Page, printed, section
from tests.python.report.twins import HOSTILE, friction_table, swing, torsion_loop


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


def test_a_parameter_that_a_later_measurement_replaces_says_so(from_log_and_loop: sw.Twin) -> None:
    rows = {
        path.text: row.find("td", **{"data-label": "Verdict"})[0].text
        for row in section(twin_report(from_log_and_loop), "log").find("tr")
        for path in row.find("code")
    }
    assert "stiffness.k" in {estimate.path for estimate in from_log_and_loop.evidence[1].fit.estimates}
    assert rows["gear.stiffness.k1"] == "replaced by a later measurement"
    assert "replaced by a later measurement" not in (rows["gear.friction_input.coulomb"], rows["gear.kinematic_error.phase[0]"])


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
    assert {"initial model", "measured", "fitted to the table"} <= set(labels)
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
    (part,) = evidence.fit.parts
    thinned = replace(evidence, fit=replace(evidence.fit, parts=(replace(part, experiment=replace(loop, samples=9_000)),)))
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


# Experiments


def test_experiments_show_every_run_and_every_figure_beside_the_published_one(from_torsion: sw.Twin) -> None:
    error = Figure("largest error", "rad", (0.0123, 0.0456), published=0.0042)
    experiment = SimulatedExperiment(
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
    drawn = Page(figures.experiment(SimulatedExperiment("step", (("twin", run),)), "e")).root
    labels = [text.text for text in drawn.find("text")]
    assert "command [V]" in labels
    assert not any("response" in label for label in labels)


def test_an_experiment_refuses_what_it_cannot_show() -> None:
    with pytest.raises(ValueError, match=r'^experiment "e" has no run$'):
        SimulatedExperiment("e", ())
    with pytest.raises(ValueError, match=r'^experiment "e": run "a" has no column "torque"$'):
        SimulatedExperiment("e", (("a", swing(9)),), response="torque")
    with pytest.raises(ValueError, match=r'^experiment "e": rms has 2 values for 1 runs$'):
        SimulatedExperiment("e", (("a", swing(9)),), (Figure("rms", "rad", (1.0, 2.0)),))
