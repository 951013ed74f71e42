"""The verb `plan`: what it prints, and what it refuses."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest
import strainwave as sw

from tests.python.command import strainwave

FRICTION = ("--want", "gear.friction_input", "--experiment", "friction")


def test_the_plan_of_the_command_is_that_of_the_function(tmp_path: Path) -> None:
    said = strainwave(
        "plan", "csg-25-100", *FRICTION, "--noise", "friction=0.002", "--minutes", 8, "--speed-limit", "1000 rpm",
        folder=tmp_path,
    )  # fmt: skip
    plan = sw.identification.plan_experiments(
        sw.GearSet.read("csg-25-100"), ["gear.friction_input"], experiments=["friction"], noise={"friction": 2e-3}, time=480.0,
        speed_limit=1000.0 * 3.141592653589793 / 30.0,
    )  # fmt: skip
    assert said.stdout == f"{plan}\n"
    assert (said.returncode, said.stderr) == (0, "")
    assert list(tmp_path.iterdir()) == []


def test_a_data_sheet_is_planned_for_too(tmp_path: Path) -> None:
    (tmp_path / "sheet.toml").write_text('name = "x"\n[datasheet]\nratio = -80\nsize = 20\npeak_torque = "96 N.m"\n')
    said = strainwave("plan", "sheet.toml", "--want", "gear.stiffness", "--experiment", "torsion", folder=tmp_path)
    assert said.returncode == 0
    assert "± 96 N.m at the output" in said.stdout


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (("--want", "gear.x"), 'the model has no parameter "gear.x"'),
        (("--want", "rubbing"), "its parts are gear.kinematic_error, "),
        ((*FRICTION, "--noise", "friction"), "--noise friction: write it as --noise friction=0.002"),
        ((*FRICTION, "--noise", "voltag=1"), "noise: voltag is none of"),
        ((*FRICTION, "--resolution", "angle"), "--resolution angle: write it as --resolution angle=1e-5"),
        ((*FRICTION, "--resolution", "turn=1"), "resolution: turn is none of torque, angle, input_torque, input_angle"),
        (
            (*FRICTION, "--speed-limit", "2000"),
            '--speed-limit = "2000" has no unit; write a number and its unit, as "1.2 rad/s"',
        ),
        ((*FRICTION, "--speed-limit", "2000 N.m"), '--speed-limit: cannot convert "N.m" to "rad/s"'),
        ((*FRICTION, "--minutes", "-1"), "--minutes = -1.0 must lie in (0, inf)"),
        (
            ("--want", "gear.friction_input", "--experiment", "motion"),
            '--experiment = "motion" must be one of friction, torsion',
        ),
        ((*FRICTION, "--criterion", "E"), '--criterion = "E" must be one of A, D'),
        ((), "Missing option '--want'"),
        (("--want", "loss"), "--want loss plans by loops that were measured; give them, as --loop"),
    ],
)
def test_what_makes_no_plan_is_refused_in_words_of_the_command(tmp_path: Path, options: tuple[str, ...], message: str) -> None:
    said = strainwave("plan", "csg-25-100", *options, folder=tmp_path)
    assert (said.returncode, said.stdout) == (2, "")
    assert message in said.stderr
    assert said.stderr.count("\n") == 1


def test_a_time_that_is_enough_for_no_measurement_is_the_reason_for_none(tmp_path: Path) -> None:
    said = strainwave("plan", "csg-25-100", *FRICTION, "--minutes", 0.1, folder=tmp_path)
    assert said.stdout.startswith("Plan: no measurement fits in 0.1 min; the shortest takes 0.667 min")


def test_a_limit_that_no_rating_states_is_asked_for(tmp_path: Path) -> None:
    said = strainwave("plan", "hfuc-50-120", *FRICTION, folder=tmp_path)
    assert said.stderr.startswith("strainwave: --speed-limit is needed for friction")


def test_loops_that_were_measured_lead_to_those_that_separate_their_sources(tmp_path: Path) -> None:
    elastic = 40.0 * np.sin(np.linspace(0.5, 4.5, 801) * np.pi)
    torque = elastic + (1.2 + 0.04 * np.abs(elastic)) * np.sign(np.gradient(elastic))
    torque += 0.02 * np.random.default_rng(0).normal(size=801)
    columns = np.column_stack([100.0 * elastic / 3e4, torque / 100.0])
    header = "input_angle [rad],input_torque [N.m]"
    np.savetxt(tmp_path / "loop.csv", columns, delimiter=",", header=header, comments="")
    said = strainwave("plan", "hfuc-25-100", "--want", "loss", "--loop", "loop.csv", folder=tmp_path)
    assert "at the output with the input" in said.stdout
    assert re.search(r"bearing, dry +± 0\.0\d+, was ± 0\.7", said.stdout)  # and no value: the loop divides a sum in some way
    named = "\n".join(["Winkel Motor [rad];Moment Motor [Nm]", *(f"{a};{b}".replace(".", ",") for a, b in columns), ""])
    (tmp_path / "named.csv").write_text(named)
    in_german = strainwave("plan", "hfuc-25-100", "--want", "loss", "--loop", "named.csv", folder=tmp_path)
    assert in_german.stdout.splitlines()[:8] == said.stdout.splitlines()[:8]
    twice = strainwave("plan", "hfuc-25-100", "--want", "loss", "--loop", "loop.csv", "--loop", "named.csv", folder=tmp_path)
    assert "named.csv and loop.csv contain the same measurement" in twice.stderr
    (tmp_path / "bare.csv").write_text((tmp_path / "loop.csv").read_text().replace(" [N.m]", ""))
    bare = strainwave("plan", "hfuc-25-100", "--want", "loss", "--loop", "bare.csv", folder=tmp_path)
    assert "bare.csv: input_torque has no unit" in bare.stderr
    refused = strainwave("plan", "hfuc-25-100", "--want", "bearing", "--loop", "loop.csv", folder=tmp_path)
    assert '"bearing" is no source of these loops' in refused.stderr


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (("--criterion", "D"), "--loop plans by the loops that were measured, up to their torque; leave out --criterion"),
        (("--torque-limit", "50 N.m"), "leave out --torque-limit"),
        (("--speed-limit", "50 rpm"), "leave out --speed-limit"),
        (("--noise", "torsion=1"), "leave out --noise"),
        (("--experiment", "friction"), "--loop plans torsion loops; leave out other experiments"),
        ((), "none.csv: a torsion loop or branch needs one angle: "),
    ],
)
def test_what_a_plan_of_loops_does_not_use_is_refused(tmp_path: Path, options: tuple[str, ...], message: str) -> None:
    (tmp_path / "none.csv").write_text("speed [rad/s],torque [N.m]\n1,2\n2,3\n3,4\n4,5\n")
    said = strainwave("plan", "hfuc-25-100", "--want", "loss", "--loop", "none.csv", *options, folder=tmp_path)
    assert (said.returncode, said.stdout) == (2, "")
    assert message in said.stderr
