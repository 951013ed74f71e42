"""`strainwave diagnose wear`: what it prints and writes of tables and of gears, and what it refuses."""

from __future__ import annotations

import json
import shlex
from pathlib import Path

import numpy as np
import pytest
import strainwave as sw
from strainwave.diagnose.wear_tests import read_wear_tests
from strainwave.files.entries import Entry
from strainwave.files.gear_set import GearSet

from tests.python.command import refused, strainwave

PAGE = Path(__file__).parents[3] / "docs" / "how-to" / "faults.md"
WORK = (0.0, 1e6, 2e6, 4e6)  # J
TABLE = "work [J],play [rad],friction [N.m]\n" + "".join(f"{w},{1e-4 + 3e-11 * w},{2.0 + 1e-7 * w}\n" for w in WORK)


def worn(work: float, folder: Path, source: str = "identified from loop.csv") -> Path:
    """A gear file as identify writes it: stiffness, friction and order 2 of the error were measured, order 4 was not."""
    gear = sw.Gear(
        stiffness=sw.stiffness.Linear(k=2e4 - 5e-4 * work),
        friction_input=sw.friction.Coulomb(coulomb=0.05 + 1e-8 * work, breakaway=0.06 + 1e-8 * work),
        kinematic_error=sw.kinematic_error.Fourier(order=[4.0, 2.0], amplitude=[1e-5, 1e-4 + 1e-11 * work], phase=[0.0, 0.0]),
    )
    measured = {
        "gear.stiffness.k": Entry(source, uncertainty=10.0),
        "gear.friction_input.coulomb": Entry("identified from friction.csv", uncertainty=1e-4),
        "gear.kinematic_error.amplitude[1]": Entry("identified from encoders.csv", uncertainty=1e-6),
    }
    gear_set = GearSet.of(gear, name="joint", source="catalogue")
    path = folder / f"{work:g}.toml"
    gear_set.replace(sources={**gear_set.sources, **measured}).save(path)
    return path


def test_the_example_of_the_page_prints_what_the_page_has(tmp_path: Path) -> None:
    section = PAGE.read_text().partition("### Wear from files")[2]
    (tmp_path / "wear.csv").write_text(section.partition("```text\n")[2].partition("```")[0])
    command, _, printed = section.partition("```console\n$ ")[2].partition("```")[0].partition("\n")
    done = strainwave(*shlex.split(command)[1:], folder=tmp_path)
    assert done.returncode == 0, done.stderr
    assert done.stdout.startswith(printed.strip())
    written = json.loads((tmp_path / "out" / "diagnose" / "results.json").read_text())
    assert written["life"]["limited_by"] == "play"
    assert written["life"]["low"] < written["life"]["remaining"] < written["life"]["high"]
    page = (tmp_path / "out" / "diagnose" / "report.html").read_text()
    assert "<svg" in page


def test_numbers_that_files_determined_in_all_gears_are_the_tests(tmp_path: Path) -> None:
    files = [worn(work, tmp_path) for work in WORK]
    tests = read_wear_tests(files, ["stiffness", "friction", "amplitude"], "0,1e6,2e6,4e6")
    assert tests.work == WORK
    assert tests.values["stiffness"] == pytest.approx([2e4 - 5e-4 * work for work in WORK])
    assert tests.names == {
        "stiffness": "gear.stiffness.k",
        "friction": "gear.friction_input.coulomb",
        "amplitude": "amplitude of order 2",
    }
    life = sw.diagnose.wear_life(tests.work, tests.values, {"stiffness": 16e3, "friction": 1.0, "amplitude": 1.0})
    assert (life.limited_by, life.remaining) == ("stiffness", pytest.approx(4e6))


def test_hours_stand_for_the_work_of_a_duty(tmp_path: Path) -> None:
    path = tmp_path / "hours.csv"
    path.write_text("time [h],play [rad]\n0,1e-4\n100,1.3e-4\n200,1.6e-4\n")
    tests = read_wear_tests([path], ["play"], work_per_hour=1e4)
    assert tests.work == pytest.approx([0.0, 1e6, 2e6])
    assert np.ptp(tests.values["play"]) == pytest.approx(6e-5)


def test_the_noise_of_gears_is_at_least_their_standard_deviation(tmp_path: Path) -> None:
    """Three gears on a line by chance, whose stiffness is known to ± 10 N·m/rad."""
    files = [worn(work, tmp_path) for work in WORK[:3]]
    tests = read_wear_tests(files, ["stiffness"], "0,1e6,2e6")
    assert tests.sigma == {"stiffness": pytest.approx(10.0)}
    for sigma, rate_sigma in ((tests.sigma, 10.0 / np.sqrt(2e12)), ({}, 0.0)):
        life = sw.diagnose.wear_life(tests.work, tests.values, {"stiffness": 15e3}, resolution={"stiffness": 0.0}, sigma=sigma)
        assert life.trends[0].rate_sigma == pytest.approx(rate_sigma, abs=1e-9)
        assert (life.high - life.low > 1e5) is bool(sigma)
    with pytest.raises(ValueError, match="is given twice; give the gear file of each test once"):
        read_wear_tests([*files[:2], files[0]], ["stiffness"], "0,1e6,2e6")


def test_a_table_in_the_unit_of_the_report_has_the_resolution_that_was_written(tmp_path: Path) -> None:
    path = tmp_path / "table.csv"
    path.write_text("work [MJ],play [mrad]\n0,0.10\n1,0.13\n2,0.16\n")
    tests = read_wear_tests([path], ["play"])
    assert (tests.work, tests.resolution) == ((0.0, 1e6, 2e6), {"play": pytest.approx(1e-5)})


def test_work_may_be_repeated(tmp_path: Path) -> None:
    (tmp_path / "idle.csv").write_text("play [rad]\n1e-4\n1.3e-4\n1.6e-4\n")
    work = ("--work", 0, "--work", 1e6, "--work", 2e6)
    done = strainwave("diagnose", "wear", "idle.csv", "--limit", "play=1e-3", *work, folder=tmp_path)
    assert "3 tests over 2 MJ" in done.stdout, done.stderr


@pytest.mark.parametrize(
    ("words", "why"),
    [
        (("table.csv", "--limit", "wobble=3"), "--limit wobble=3: write NAME=VALUE, as play=4e-4; names are play, amplitude"),
        (("table.csv", "--limit", "play"), "--limit play: write NAME=VALUE"),
        (("table.csv", "--limit", "play=3 N.m"), 'cannot convert "N.m" to "rad"'),
        (("table.csv", "--limit", "play=-1"), "--limit play = -1.0 rad must lie in (0, inf)"),
        (("table.csv", "--limit", "stiffness=1e4"), 'table.csv has no column "stiffness"; it has "work", "play", "friction"'),
        (("table.csv", "--limit", "play=1", "--limit", "play=2"), "--limit play is given twice; give one"),
        (("table.csv", "--limit", "play=1", "--work", "0,1,2,3"), "table.csv has a column work, and --work is given, too"),
        (("table.csv", "--limit", "friction=1"), "the first test is past the limit of the friction: 2 N·m, limit 1 N·m"),
        (("table.csv", "idle.csv", "--limit", "play=1"), "table.csv is a table, and one of 2 files; give one table"),
        (("idle.csv", "--limit", "play=1", "--work", "1,2"), "--work has 2 numbers for 3 tests"),
        (("idle.csv", "--limit", "play=1", "--work", "1,2,x"), '"x" is no number'),
        (("idle.csv", "--limit", "play=1"), "idle.csv has no column work [J]; give --work-per-hour of the duty"),
        (("0.toml", "1e+06.toml", "2e+06.toml", "--limit", "stiffness=1e4"), "gear files do not contain the work of the gear"),
        (("0.toml", "1e+06.toml", "2e+06.toml", "--work", "0,1,2", "--limit", "play=1"), "no number is the play of all gears"),
        (("0.toml", "kept/5.toml", "--work", "0,1", "--limit", "stiffness=1"), "kept/5.toml identified none"),
        (("missing.csv", "--limit", "play=1"), "No such file"),
    ],
)
def test_what_determines_no_wear_is_refused(words: tuple[str, ...], why: str, tmp_path: Path) -> None:
    (tmp_path / "table.csv").write_text(TABLE)
    (tmp_path / "idle.csv").write_text("time [h],play [rad]\n0,1e-4\n100,1.3e-4\n200,1.6e-4\n")
    (tmp_path / "kept").mkdir()
    for work in WORK:
        worn(work, tmp_path)
    worn(5.0, tmp_path / "kept", "catalogue")
    refused(tmp_path, ("diagnose", "wear", *words), why)
