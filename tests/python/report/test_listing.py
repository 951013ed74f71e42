"""Sets and comparisons in words: every number with unit and source, modes by closed form, ratings and what exceeded them."""

from __future__ import annotations

import re
from math import sqrt, tau
from typing import Any

import numpy as np
import pytest
import strainwave as sw
from hypothesis import given, settings
from strainwave import Recording
from strainwave.analysis import Agreement, Difference
from strainwave.files import Entry, Quantity
from strainwave.report.listing import agreement_table, aligned, difference_table, listing, range_table, stroke_table

from tests.support.samples import sample
from tests.support.strategies import drives

GEAR = sw.Gear(
    kinematics=sw.kinematics.PlainRatio(reduction=100.0),
    stiffness=sw.stiffness.Linear(k=8000.0),
    friction_input=sw.friction.Coulomb(coulomb=0.05),
)
DRIVE = sw.Drive(gear=GEAR, motor=sw.motor.TorqueSource(inertia=1.5e-4), load=sw.loads.Inertia(inertia=0.05))
SET = sw.GearSet.of(DRIVE, name="Bench", source="measured")
LIMIT = Quantity(value=20.0, unit="N.m", source="maker")
COGGING = ("motor.cogging_torque", "motor.cogging_order")
LOST_SETS = ("motor.open_share", "motor.shorted_share")
PHASES = ("motor.phase_resistance_excess", "motor.dead_time_voltage", "motor.dead_time_current")
# What a file may leave out of a motor, because it has no effect by default.
FAULT_NUMBERS: dict[Any, tuple[str, ...]] = {
    sw.motor.DC: COGGING,
    sw.motor.BrushlessDC: COGGING + LOST_SETS,
    sw.motor.PMSM: PHASES + LOST_SETS,
}


def line_of(text: str, name: str) -> str:
    (found,) = (line for line in text.splitlines() if re.match(rf"\s*{re.escape(name)}\s", line))
    return found


@pytest.mark.parametrize("name", ["csg-25-100", "hfuc-20-80", *sw.catalogue("drives")])
def test_every_number_is_shown_with_its_unit_and_source(name: str) -> None:
    gear_set = sw.GearSet.read(name)
    text = listing(gear_set)
    part, shown = "", {}
    for line in text.splitlines():
        if match := re.match(r"\[([\w.]+)\]", line):
            part = match[1]
        elif (cells := re.split(r"\s{2,}", line.strip())) and line.startswith("  "):
            shown[f"{part}.{cells[0]}"] = cells
    for path, entry in gear_set.sources.items():
        place = path.rpartition(".")[0]
        if entry.source == "not given" and path in FAULT_NUMBERS.get(type(gear_set.motor), ()):
            assert path not in shown
        elif place not in gear_set.left_out:
            assert entry.source in " ".join(shown[path]), path
    assert float(shown["gear.damping"][1]) == pytest.approx(gear_set.gear.damping, rel=1e-9)
    assert shown["gear.damping"][2] == "N.m.s/rad"


@pytest.mark.slow("report")
@settings(max_examples=sample(5, 15))
@given(drives)
def test_any_drive_can_be_shown(drive: sw.Drive) -> None:
    text = listing(sw.GearSet.of(drive, name="x", source="y"))
    assert all(line.isprintable() for line in text.splitlines())
    assert f"\n[motor] {drive.motor.name}\n" in text
    assert "\nmodes\n" in text
    assert "nan" not in text.split("\nmodes\n")[1]


def test_how_well_a_number_is_known_is_said_behind_its_source() -> None:
    known = SET.replace(sources={**SET.sources, "gear.stiffness.k": Entry("torsion loop", spread=0.3, uncertainty=12.0)})
    assert line_of(listing(known), "k").endswith("8000 ± 12  N.m/rad  torsion loop, spread 30 %")


def test_the_modes_are_those_of_the_closed_form() -> None:
    """Two inertias on a spring: sqrt(k (1 / J_out + 1 / (i^2 J_in))), with the input held sqrt(k / J_out) = 400 rad/s."""
    free = sqrt(8000.0 * (1.0 / 0.05 + 1.0 / (1e4 * 1.5e-4)))
    text = listing(SET)
    assert line_of(text, "free, undamped").split()[2:] == [f"{free:.6g}", "rad/s", f"({free / tau:.4g}", "Hz)"]
    assert line_of(text, "input held, undamped").split()[3:5] == ["400", "rad/s"]
    rest = line_of(text, "at rest, under its controller")
    assert re.split(r"\s{2,}", rest)[-2:] == ["400 rad/s (63.66 Hz)", "damping ratio 0; friction holds input"]


def test_damping_of_the_gear_shows_in_the_damping_ratio() -> None:
    damped = SET.replace(gear=GEAR.replace(damping=4.0))
    rest = line_of(listing(damped), "at rest, under its controller")
    assert rest.endswith(f"damping ratio {4.0 / (2.0 * sqrt(8000.0 * 0.05)):.3g}; friction holds input")


def test_a_drive_without_modes_says_why_and_a_gear_has_none() -> None:
    moved = sw.GearSet.of(DRIVE.replace(load=sw.loads.Prescribed()), name="x", source="y")
    assert "\nmodes\n  not determined: " in listing(moved)
    assert "modes" not in listing(sw.GearSet.of(GEAR, name="x", source="y"))


MOTOR = sw.motor.DC(resistance=1.0, torque_constant=0.1, back_emf=0.1, inertia=1e-4)


def test_a_sampled_controller_is_told_as_its_law_and_meter_and_heat_do_not_matter() -> None:
    law = sw.control.PID(proportional=1.0)
    plain = DRIVE.replace(motor=MOTOR, control=law)
    sampled = plain.replace(control=sw.control.Sampled(law=law, period=1e-3), meter=sw.meter.EnergyMeter())
    texts = [listing(sw.GearSet.of(each, name="x", source="y")) for each in (plain, sampled)]
    plainly, acting = (re.split(r"\s{2,}", line_of(text, "at rest, under its controller"))[2:] for text in texts)
    assert plainly[0].endswith("Hz)")
    assert acting == [
        plainly[0],
        f"{plainly[1]}; control: sampling every 0.001 s with a delay of 0 s is left out, as is a compensation",
    ]


def test_counts_of_a_sensor_are_left_out() -> None:
    counting = sw.Sensors(output_angle=sw.sensor.Encoder(counts=1000))
    texts = [listing(sw.GearSet.of(each, name="x", source="y")) for each in (DRIVE, DRIVE.replace(sensors=counting))]
    ideal, counted = (line_of(text, "at rest, under its controller") for text in texts)
    assert counted == f"{ideal}; sensors.output_angle: noise, steps and counts are left out"


def test_turning_freely_is_no_vibration() -> None:
    free = DRIVE.replace(gear=GEAR.replace(friction_input=sw.friction.Viscous(), kinematic_error=sw.kinematic_error.Fourier()))
    rest = line_of(listing(sw.GearSet.of(free, name="x", source="y")), "at rest, under its controller")
    shown = re.split(r"\s{2,}", rest.strip())
    assert shown[1:] == [
        f"{(rate := sqrt(8000.0 * (1.0 / 0.05 + 1.0 / 1.5))):.6g} rad/s ({rate / tau:.4g} Hz)",
        "damping ratio 0",
    ]


def test_what_a_run_reached_of_each_rating_is_told_with_how_far_and_when() -> None:
    rated = SET.replace(ratings={"peak_torque": LIMIT, "momentary_torque": Quantity(value=40.0, unit="N.m", source="maker")})
    run = Recording({"time": [0.0, 0.1, 0.2], "torque": [0.0, -25.0, 30.0]}, {"time": "s", "torque": "N.m"})
    text = listing(rated, {"run.csv": run, "rest.csv": Recording({"time": [0.0]}, {"time": "s"})})
    assert "\n  peak_torque       20  N.m  maker\n" in text
    after = text.split("\n\nrun.csv\n")[1]
    assert after.splitlines()[:2] == [
        "  peak_torque       30  N.m  exceeds the limit by 50 %, first at t = 0.1 s",
        "  momentary_torque  30  N.m  75 % of the limit",
    ]
    assert after.splitlines()[3] == "rest.csv"
    assert "cannot be compared" in after.splitlines()[4]


def test_a_limit_of_nothing_is_exceeded_without_bound() -> None:
    none = SET.replace(ratings={"peak_torque": Quantity(value=0.0, unit="N.m", source="maker")})
    run = Recording({"time": [0.0, 0.1], "torque": [0.0, 1.0]}, {"time": "s", "torque": "N.m"})
    assert "exceeds the limit by inf %, first at t = 0.1 s" in listing(none, {"run": run})


def test_nothing_that_a_file_holds_reaches_the_terminal_as_it_is() -> None:
    hostile = SET.replace(note="\x1b[31mred\x07\u202e", ratings={"\x1b[2J": LIMIT})
    text = listing(hostile, {"\x1b[31m.csv": Recording({"torque": [1.0]}, {"torque": "N.m"})})
    assert all(line.isprintable() for line in text.splitlines())
    assert "red" in text


def test_tables_are_aligned() -> None:
    rows = [("torque", "2"), ("mass", "10")]
    assert list(aligned(rows, "<>")) == ["torque   2", "mass    10"]
    assert list(aligned([], "<>")) == []
    agreements = [Agreement("torque", "N.m", 0.05, 0.1, 2.0, 0.99, 200), Agreement("a", "1", 0.0, 0.0, 0.0, None, 200)]
    assert agreement_table(agreements).splitlines() == [
        "        unit   rms  largest  at t [s]      correlation",
        "torque  N.m   0.05      0.1         2             0.99",
        "a       1        0        0         0  one is constant",
    ]
    differences = [Difference("gear.damping", 4.0, 5.0, "N.m.s/rad"), Difference("motor", None, "dc")]
    assert difference_table(differences).splitlines() == [
        "                first  second  unit       change",
        "gear.damping        4       5  N.m.s/rad   +25 %",
        "motor         nothing      dc",
    ]
    run = Recording({"time": [0.0, 1.0], "torque": [2.0, -np.pi]}, {"time": "s", "torque": "N.m"})
    assert range_table(run).splitlines()[1] == "torque  N.m    -3.1416        2     -3.1416"


def test_rounding_beside_a_large_value_is_none() -> None:
    values = {"time": [0.0, 1.0, 2.0], "a": [-1e-20, 0.5, 2e-19], "b": [-1e-20, 0.0, 2e-19]}
    table = range_table(Recording(values, {"time": "s", "a": "1", "b": "1"}))
    assert [line.split() for line in table.splitlines()[1:]] == [
        ["a", "1", "0", "0.5", "0"],
        ["b", "1", "-1e-20", "2e-19", "2e-19"],
    ]


@pytest.mark.parametrize(("correlation", "shown"), [(1.0, "1"), (-1.0, "-1"), (0.0, "0"), (0.5, "0.5"), (0.9999999, "1")])
def test_a_correlation_has_no_empty_digits(correlation: float, shown: str) -> None:
    assert agreement_table([Agreement("a", "1", 0.1, 0.1, 0.0, correlation, 2)]).endswith(f"  {shown}")


def test_a_tolerance_may_have_a_unit() -> None:
    drives = sw.load("position-drive-full-friction"), sw.load("position-drive")
    assert stroke_table(*drives, 100.0, "100 urad") == stroke_table(*drives, 100.0, 0.1)  # type: ignore[arg-type]
