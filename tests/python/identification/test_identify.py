"""Any files to one gear: what is found in each, what counts, and what is kept apart."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import strainwave as sw
from hypothesis import given, strategies as st
from strainwave.identification.identify import Identified, identify, with_means
from strainwave.identification.reading.mapping import FileMapping
from strainwave.identification.results.combined_parameter import CombinedParameter, combine, distance, mean_of
from strainwave.identification.results.file_result import FileEstimate, FileResult
from strainwave.identification.results.gear_so_far import GearSoFar
from strainwave.questions import QuestionError

from tests.python.identification.candidates.test_motion import RATIO, SPEED as SWING, TRUTH, record
from tests.support.answers import options_of

SPEED = np.array([1.0, 2.0, 5.0, 10.0, 20.0, 50.0, 100.0, 200.0])
CONSTANT = 0.08  # N.m/A, of the motor of the logs


def table(path: Path, coulomb: float, noise: float, seed: int) -> Path:
    random = np.random.default_rng(seed)
    both = np.concatenate([SPEED, -SPEED])
    torque = np.sign(both) * (coulomb + 3e-4 * np.abs(both)) + noise * random.standard_normal(len(both))
    sw.Recording({"speed": both, "torque": torque}, {"speed": "rad/s", "torque": "N.m"}).to_csv(path)
    return path


def log(path: Path, seed: int, **changed: float) -> Path:
    path.parent.mkdir(exist_ok=True)
    record(TRUTH | changed, 0.05, seed).to_csv(path)
    return path


def measured_motor() -> sw.GearSet:
    """A set of which the motor is known well."""
    start = sw.GearSet.read("hfuc-20-80")
    motor = sw.motor.DC(resistance=0.4, torque_constant=CONSTANT, back_emf=CONSTANT, inertia=1e-4 - start.gear.input_inertia)
    sources = {f"motor.{each['name']}": sw.files.Entry("measured", uncertainty=0.0) for each in motor.fields}
    return start.replace(motor=motor, sources={**start.sources, **sources})


@pytest.fixture(scope="module")
def found(tmp_path_factory: pytest.TempPathFactory) -> Identified:
    folder = tmp_path_factory.mktemp("files")
    (folder / "text.csv").write_text("a,b\nx,y\n")
    files = [
        table(folder / "rough.csv", 0.05, 2e-3, 1), table(folder / "fine.csv", 0.05, 2e-4, 2), folder / "text.csv",
        log(folder / "light" / "run.csv", 3, inertia=0.4), log(folder / "heavy" / "run.csv", 4, inertia=1.6),
        log(folder / "again.csv", 3, inertia=0.4),
    ]  # fmt: skip
    return identify(measured_motor(), files)


@pytest.mark.slow("identification")
def test_each_file_is_told_what_it_is_and_none_stops_the_others(found: Identified) -> None:
    kinds = [each.recognised.kind if each.recognised is not None else "" for each in found.files]
    assert kinds == ["friction", "friction", "", "log", "log", "log"]
    assert [bool(each.refused) for each in found.files] == [False, False, True, False, False, False]


@pytest.mark.slow("identification")
def test_files_of_one_name_are_told_by_their_folders(found: Identified) -> None:
    names = [each.name for each in found.files]
    assert names[0] == "rough.csv"
    assert names[3].endswith("light/run.csv")
    assert len(set(names)) == len(names)


@pytest.mark.slow("identification")
def test_the_file_that_tells_a_number_best_gives_it_and_the_law(found: Identified) -> None:
    number = next(each for each in found.parameters if each.estimate.path == "gear.friction_input.coulomb")
    assert "fine.csv" in number.mean_of
    assert abs(number.estimate.value - 0.05) < 4.0 * number.estimate.sigma
    assert found.gear_set.gear.friction_input.coulomb == number.estimate.value
    assert "fine.csv" in found.gear_set.sources["gear.friction_input.coulomb"].source
    assert not number.contradicts


@pytest.mark.parametrize(("file", "coulomb"), [("fine.csv", 0.05), ("old_fine.csv", 0.06)])
def test_a_mean_replaces_only_what_one_of_its_files_has_told(file: str, coulomb: float) -> None:
    law, path = sw.friction.Coulomb(coulomb=0.06), "gear.friction_input.coulomb"
    known = GearSoFar(sw.GearSet.read("hfuc-20-80")).with_parts({"friction_input": law}, {path: 1e-4}, file)
    mean = CombinedParameter(FileEstimate(path, "N.m", 0.05, 1e-4, ""), "fine.csv", mean_of=("fine.csv", "coarse.csv"))
    assert with_means(known, [mean]).gear.friction_input.coulomb == coulomb


def test_amplitudes_of_several_recordings_are_written_as_their_mean() -> None:
    law, path = sw.kinematic_error.Fourier(order=[2.0, 4.0], amplitude=[1.2e-4, 4e-5], phase=[0.3, 0.0]), "gear.kinematic_error"
    sigmas = {f"{path}.amplitude[0]": 1e-6, f"{path}.amplitude[1]": 1e-6}
    known = GearSoFar(sw.GearSet.read("hfuc-20-80")).with_parts({"kinematic_error": law}, sigmas, "one.csv")
    estimate = FileEstimate(f"{path}.amplitude of order 4", "rad", 4.2e-5, 7e-7, "fourier")
    gear_set = with_means(known, [CombinedParameter(estimate, "one.csv", mean_of=("one.csv", "two.csv"))])
    assert gear_set.gear.kinematic_error.amplitude == (1.2e-4, 4.2e-5)
    assert gear_set.sources[f"{path}.amplitude[1]"].uncertainty == 7e-7


@pytest.mark.slow("identification")
def test_one_run_in_two_files_counts_once_and_other_loads_are_no_contradiction(found: Identified) -> None:
    assert found.files[5].same_as == found.files[3].name
    inertia = [each for each in found.parameters if each.estimate.path == "load.inertia"]
    assert len(inertia) == 2
    for number, truth in zip(inertia, (0.4, 1.6), strict=True):
        assert not number.contradicts
        assert number.estimate.value == pytest.approx(truth, abs=max(4.0 * number.estimate.sigma, 0.01 * truth))


def test_nothing_at_all_is_refused_with_the_reasons(tmp_path: Path) -> None:
    (tmp_path / "text.csv").write_text("a,b\nx,y\n")
    with pytest.raises(ValueError, match=r"no file can be used: text\.csv: "):
        identify("hfuc-20-80", [tmp_path / "text.csv"])
    with pytest.raises(ValueError, match="at least one file"):
        identify("hfuc-20-80", [])


@pytest.mark.slow("identification")
def test_links_in_a_folder_are_named_and_not_read(tmp_path: Path) -> None:
    (tmp_path / "folder").mkdir()
    table(tmp_path / "elsewhere.csv", 0.07, 2e-4, 2)
    link = tmp_path / "folder" / "link.csv"
    link.symlink_to("../elsewhere.csv")
    with pytest.raises(ValueError, match=r"no file can be used: link\.csv: it is a symbolic link in a folder, "):
        identify("hfuc-20-80", [tmp_path / "folder"])
    table(tmp_path / "folder" / "own.csv", 0.05, 2e-4, 1)
    found = identify("hfuc-20-80", [tmp_path / "folder"])
    assert [(each.name, bool(each.refused)) for each in found.files] == [("own.csv", False), ("link.csv", True)]
    named = identify("hfuc-20-80", [link, tmp_path / "folder"])
    assert [(each.name, bool(each.refused)) for each in named.files] == [("link.csv", False), ("own.csv", False)]


@pytest.mark.slow("identification")
def test_friction_that_vanished_in_a_file_is_not_the_start_of_the_next_one(tmp_path: Path) -> None:
    """A hand or another joint drives the first one; the friction of the second one is no multiple of what was left of that."""
    paths = [tmp_path / "driven.csv", tmp_path / "usual.csv"]
    for path, changed in zip(paths, ({"coulomb": -0.05, "viscous": 0.0}, {}), strict=True):
        rows = np.loadtxt(log(path, 1, **changed), delimiter=",", skiprows=1)[::2]
        np.savetxt(path, rows, delimiter=",", header="time [s],input_angle [rad],current [A]", comments="")
    found = identify(measured_motor(), paths)
    assert {check.source for check in found.failed} == {"driven.csv"}
    coulomb = next(each for each in found.parameters if each.estimate.path == "gear.friction_input.coulomb")
    assert coulomb.source == "usual.csv"
    assert coulomb.estimate.value == pytest.approx(0.05, rel=0.02)
    assert all(abs(each.estimate.value) > 1e-9 for each in found.parameters)


def finding(name: str, value: float, sigma: float, common: float = 0.0) -> FileResult:
    return FileResult(name, estimates=(FileEstimate("gear.friction_input.coulomb", "N.m", value, sigma, "", common=common),))


def test_two_files_far_apart_contradict_each_other_and_only_those_that_agree_are_averaged() -> None:
    (number,) = combine([finding("a", 0.05, 1e-3), finding("b", 0.06, 2e-3), finding("c", 0.051, 1e-2)])
    assert (number.source, number.contradicts, number.mean_of) == ("a", ("b",), ("a", "c"))
    assert number.estimate.value == pytest.approx((0.05 * 1e6 + 0.051 * 1e4) / (1e6 + 1e4))
    assert number.estimate.sigma == pytest.approx((1e6 + 1e4) ** -0.5)
    assert number.of_file("a").value == 0.05
    assert number.taken_from == "mean of a, c"


def test_files_that_scatter_more_than_they_say_widen_the_mean() -> None:
    near = [finding(name, value, 1e-3) for name, value in (("a", 0.05), ("b", 0.0519), ("c", 0.0481))]
    (number,) = combine(near)
    assert number.mean_of == ("a", "b", "c")
    assert number.widened == pytest.approx(1.9)
    assert number.estimate.sigma == pytest.approx(1.9e-3 / 3**0.5)


@given(
    own=st.lists(st.floats(1e-3, 1.0), min_size=2, max_size=5),
    common=st.floats(0.0, 1.0),
    value=st.floats(-10.0, 10.0),
)
def test_what_files_share_is_no_smaller_in_their_mean(own: list[float], common: float, value: float) -> None:
    told = [FileEstimate("load.inertia", "kg.m2", value, float(np.hypot(each, common)), "", common=common) for each in own]
    mean, widened = mean_of(told)
    assert mean.value == pytest.approx(value)
    assert widened == 1.0
    expected = np.hypot(np.sum(np.power(own, -2.0)) ** -0.5, common)  # independent parts, and the common one once
    assert mean.sigma == pytest.approx(expected, rel=1e-6)


def test_means_hold_the_truth_as_often_as_they_say() -> None:
    random, off = np.random.default_rng(4), []
    for _ in range(2000):
        shared = 0.02 * random.standard_normal()
        told = [
            FileEstimate("x", "N.m", 1.0 + shared + own * random.standard_normal(), float(np.hypot(own, 0.02)), "", common=0.02)
            for own in (0.01, 0.03)
        ]
        told.append(FileEstimate("x", "N.m", 1.0 + 0.02 * random.standard_normal(), 0.02, ""))
        mean, _ = mean_of(told)
        off.append((mean.value - 1.0) / mean.sigma)
    assert 0.85 < float(np.std(off)) < 1.05  # a little wide, as scatter can only widen


def test_phases_a_turn_apart_are_equal() -> None:
    one, other = (FileEstimate("load.gravity_phase", "rad", value, 0.1, "") for value in (3.1, 3.1 - 2.0 * np.pi))
    assert distance(one, other) == pytest.approx(0.0, abs=1e-9)


@pytest.mark.parametrize(
    ("files", "mapping", "said"),
    [
        (3, None, "files must be a path, a list of paths"),
        ([3], None, "files must be a path, a list of paths"),
        (sw.Recording({"speed": np.ones(3)}, {"speed": "rad/s"}), None, r'kind is needed, as in {"friction": table}'),
        (["table.csv"], 3, "mapping must be a FileMapping, or a function"),
    ],
)
def test_what_are_no_files_is_refused(files: Any, mapping: Any, said: str) -> None:
    with pytest.raises(TypeError, match=said):
        identify("hfuc-20-80", files, mapping=mapping)


def test_the_gear_comes_before_the_measurements() -> None:
    with pytest.raises(TypeError, match="the gear comes first"):
        identify({"friction": "table.csv"}, "hfuc-20-80")  # type: ignore[arg-type]


def test_one_path_is_one_file(tmp_path: Path) -> None:
    path = tmp_path / "table.csv"
    path.write_text("speed [rad/s],torque [N.m]\n" + "".join(f"{speed},{0.05 + 3e-4 * speed}\n" for speed in (5, 20, 80, 200)))
    assert [each.name for each in identify("hfuc-20-80", str(path)).files] == ["table.csv"]
    assert [each.name for each in sw.predict("hfuc-20-80", path)] == ["table.csv"]


def voltage_log(path: Path, sign: float = 1.0) -> Path:
    """A log of which only the voltage is known: R i + K omega of a motor of 0.4 Ohm."""
    there = record(TRUTH, 0.02, 5)
    voltage = sign * (0.4 * there["current"] + CONSTANT * RATIO * SWING)
    columns = {"time": there.time, "input_angle": there["input_angle"], "voltage": voltage}
    sw.Recording(columns, {"time": "s", "input_angle": "rad", "voltage": "V"}).to_csv(path)
    return path


@pytest.mark.slow("identification")
@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_a_voltage_tells_friction_without_what_the_motor_induces(tmp_path: Path, sign: float) -> None:
    found = identify(measured_motor(), [voltage_log(tmp_path / "log.csv", sign)])
    told = {each.estimate.path: each.estimate for each in found.parameters}
    for path, truth in (("gear.friction_input.coulomb", 0.05), ("gear.friction_input.viscous", 3e-4), ("load.inertia", 0.8)):
        assert abs(told[path].value - truth) < 4.0 * told[path].sigma
        assert told[path].sigma < 0.1 * truth
    assert CONSTANT**2 / 0.4 > 50.0 * 3e-4  # of the voltage what the motor induces is by far the most


@pytest.mark.slow("identification")
def test_numbers_by_a_voltage_are_as_uncertain_as_the_resistance(tmp_path: Path) -> None:
    start, path = measured_motor(), voltage_log(tmp_path / "log.csv")
    own = start.sources["motor.resistance"]
    told = [
        {each.path: each for each in identify(other, [path]).files[0].estimates}
        for other in (start, replace(start, sources={**start.sources, "motor.resistance": replace(own, spread=0.1)}))
    ]
    for name in ("gear.friction_input.coulomb", "load.gravity_torque"):
        one, other = (each[name] for each in told)
        assert np.sqrt(other.sigma**2 - one.sigma**2) == pytest.approx(0.1 * one.value)


@pytest.mark.slow("identification")
def test_a_torque_that_was_measured_is_as_sure_as_itself_whatever_the_torque_constant(tmp_path: Path) -> None:
    run = record(TRUTH, 0.05, 3)
    kept = run.select([name for name in run.names if name != "current"])
    log_of_torque = kept.with_column("input_torque", CONSTANT * run["current"], "N.m")
    files = {"torque.csv": log_of_torque, "current.csv": run}
    set_there = measured_motor()
    unsure = sw.files.Entry("data sheet", uncertainty=0.02 * CONSTANT)
    unsure_set = set_there.replace(sources={**set_there.sources, "motor.torque_constant": unsure})
    common = {}
    for name, recording in files.items():
        recording.to_csv(tmp_path / name)
        (finding,) = identify(unsure_set, [tmp_path / name]).files
        (common[name],) = (
            each.common / abs(each.value) for each in finding.estimates if each.path == "gear.friction_input.coulomb"
        )
    assert common == {"torque.csv": 0.0, "current.csv": pytest.approx(0.02)}


def test_a_voltage_of_an_unknown_motor_is_refused_with_what_to_say(tmp_path: Path) -> None:
    with pytest.raises(QuestionError) as asked:
        identify("hfuc-20-80", [voltage_log(tmp_path / "log.csv")])
    of_motor = "--constant resistance=NUMBER --constant torque_constant=NUMBER"
    assert options_of(asked.value) == [of_motor, "--column current=voltage --unit voltage=A"]


@pytest.mark.slow("identification")
def test_shares_of_regressors_are_found_beside_friction(tmp_path: Path) -> None:
    alone, shares = record(TRUTH, 0.02, 6), {"Y1": 0.6, "Y2": -1.4}
    time = alone.time
    beside = {"Y1": 5.0 * np.sin(1.7 * time + 1.0), "Y2": 4.0 * np.cos(0.9 * time) ** 3 + np.sin(4.0 * time)}
    current = alone["current"] + sum(shares[name] * each for name, each in beside.items()) / RATIO / CONSTANT
    header = "time [s],input_angle [rad],current [A],Y1 [kg],Y2"
    columns = np.column_stack([time, alone["input_angle"], current, *beside.values()])
    np.savetxt(tmp_path / "log.csv", columns, delimiter=",", header=header, comments="")
    said = FileMapping(columns={"regressors": "Y1, Y2"})
    found = identify(measured_motor(), [tmp_path / "log.csv"], mapping=lambda path: said).files[0]
    told = {each.path: each for each in found.estimates}
    for path, truth in (("gear.friction_input.coulomb", 0.05), ("gear.friction_input.viscous", 3e-4), ("load.inertia", 0.8)):
        assert abs(told[path].value - truth) < 4.0 * told[path].sigma
    remark = next(each for each in found.remarks if each.startswith("shares of the regressors"))
    parts = remark.rpartition(": ")[2].replace(" and ", ", ").split(", ")
    values = {name: (float(value), float(sigma)) for name, value, _, sigma in (part.split() for part in parts)}
    assert all(abs(values[name][0] - share) < 4.0 * values[name][1] < 0.1 for name, share in shares.items())
    assert not any("columns not used" in each for each in found.remarks)


@pytest.mark.slow("identification")
def test_a_load_is_as_uncertain_as_the_rotor_beside_it(tmp_path: Path) -> None:
    file = log(tmp_path / "log.csv", 7)
    known = measured_motor()
    of_gear = {"gear.input_inertia": sw.files.Entry("measured", uncertainty=2e-6)}
    inertia = [
        next(each.estimate for each in identify(start, [file]).parameters if each.estimate.path == "load.inertia")
        for start in (known.replace(sources={**known.sources, "gear.input_inertia": sw.files.Entry("x", uncertainty=0.0)}),
                      known.replace(sources={**known.sources, **of_gear}))
    ]  # fmt: skip
    assert inertia[1].value == inertia[0].value
    assert inertia[1].sigma == pytest.approx(np.hypot(inertia[0].sigma, 2e-6 * RATIO**2))
    assert inertia[1].common == pytest.approx(np.hypot(inertia[0].common, 2e-6 * RATIO**2))
