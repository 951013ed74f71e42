"""Series of loops: read from tables and loop files, refused where they make no sense, and told what they were made as."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest
import strainwave as sw
from strainwave.rig.analysis.cycle import Factors, cycle_to
from strainwave.rig.influence.series import Series, analyse_series, read_series, series_of
from strainwave.rig.virtual.printed import printed_gear

UNCHANGED = Factors()


def element(friction: float = 0.0) -> sw.Gear:
    return sw.Gear(
        kinematics=sw.kinematics.PlainRatio(reduction=100.0),
        stiffness=sw.stiffness.Linear(k=3e4),
        hysteresis=sw.hysteresis.MaxwellSlip(stiffness=[1e4], breakaway=[3.0]),
        friction_input=sw.friction.Coulomb(coulomb=friction),
    )


def write_loop(path: Path, gear: sw.Gear, torque: float, factors: Factors = UNCHANGED) -> None:
    loop = cycle_to(gear, torque, factors=factors)
    points = slice(None, None, 20)
    columns = {"twist": loop.angle[points], "torque": loop.torque[points]}
    sw.Recording(columns, {"twist": "rad", "torque": "N.m"}).to_csv(path)


def test_a_table_gives_its_columns_in_their_units(tmp_path: Path) -> None:
    table = tmp_path / "series.csv"
    table.write_text(
        "unit;torque_max [mN.m];temperature [degC];hours [h];width [deg];note\nA;360;20;0;50,5;x\nB;180;40;100;20;y\n"
    )
    series = read_series(table)
    assert series.factors["torque_max"].tolist() == [0.36, 0.18]
    assert series.factors["temperature"] == pytest.approx([293.15, 313.15])
    assert series.factors["hours"].tolist() == [0.0, 100.0]
    assert np.degrees(series.quantities["width"]) == pytest.approx([50.5, 20.0])
    assert series.units == ("A", "B")


def test_loop_files_of_a_table_are_measured_by_the_analysis_of_loops(tmp_path: Path) -> None:
    """One element: width 2 F/k, area 4 F (x - F/k_1), secant T/x, of loops that a rig took in steps."""
    torques = [30.0, 45.0, 60.0]
    for torque in torques:
        write_loop(tmp_path / f"{torque:g}.csv", element(), torque)
    (tmp_path / "series.csv").write_text("torque_max [N.m],file\n30,30.csv\n45,45.csv\n60,60.csv\n")
    series = read_series(tmp_path / "series.csv")
    twist = (np.array(torques) - 3.0) / 3e4
    assert series.quantities["width"] == pytest.approx(2.0 * 3.0 / 3e4, rel=1e-6)
    assert series.quantities["area"] == pytest.approx(12.0 * (twist - 3e-4), rel=0.02)
    assert series.quantities["stiffness"] == pytest.approx(torques / twist, rel=1e-9)
    assert len(series.files) == 4


def test_loops_may_say_for_themselves_what_was_varied(tmp_path: Path) -> None:
    """The friction of a bearing over temperature, through files to the rate that was put in."""
    loops = []
    for celsius in (0.0, 10.0, 20.0, 30.0, 40.0):
        path = tmp_path / f"{celsius:g}.csv"
        factor = float(np.exp(-0.02 * (celsius - 20.0)))
        write_loop(path, element(), 40.0, Factors(hysteresis=factor))
        loops.append(f"{path}, temperature = {celsius:g} degC")
    trends = {trend.quantity: trend for trend in analyse_series(series_of(loops))}
    assert trends["width"].slope.value == pytest.approx(-0.02, rel=1e-3)
    assert trends["width"].significant


def test_document_t_rows_are_read_from_a_loop_at_the_input(tmp_path: Path) -> None:
    loop = cycle_to(printed_gear(0), 0.36, side="input")
    columns = {"input_angle": loop.angle[::10], "input_torque": loop.torque[::10]}
    sw.Recording(columns, {"input_angle": "rad", "input_torque": "N.m"}).to_csv(tmp_path / "t.csv")
    series = series_of([f"{tmp_path / 't.csv'},torque_max=0.36"])
    assert np.degrees(series.quantities["width"]) == pytest.approx(50.5, rel=1e-3)
    assert series.quantities["area"] == pytest.approx(0.3063483432, rel=2e-3)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("torque [N.m],area [J]\n1,2\n", 'has a column "torque", which no series has; there are torque_max'),
        ("torque_max [N.m],note\n1,x\n", "a series needs a column that was varied"),
        ("note\nx\n", "has no column of numbers"),
        ("torque_max [N.m],area [J]\n1,2\n0,2\n", "torque_max in row 2 is 0 N.m; it must be positive"),
        ("torque_max [s],area [J]\n1,2\n", 'cannot convert "s" to "N.m"'),
        ("torque_max [N.m],file\n1,none.csv\n", "none.csv"),
        ("torque_max [N.m],file\n1,../a.csv\n", '"../a.csv" does not lie in the folder'),
        ("torque_max [N.m],file\n1,/dev/zero\n", '"/dev/zero" does not lie in the folder'),
        (
            "torque_max [N.m],area [J]\n1,2\n1e300,2\n",
            "torque_max: the largest is 1e+300; it must be 0 or lie in [1e-30, 1e+12]",
        ),
    ],
)
def test_a_table_that_makes_no_sense_is_refused(tmp_path: Path, text: str, message: str) -> None:
    (tmp_path / "series.csv").write_text(text)
    with pytest.raises(ValueError, match=re.escape(message)) as refusal:
        read_series(tmp_path / "series.csv")
    assert "\n" not in str(refusal.value)


@pytest.mark.parametrize(
    ("said", "message"),
    [
        ("torque=2", '"torque=2" of the loop .*a.csv must be name=number, with one of torque_max'),
        ("torque_max=much", "must be name=number"),
        ("torque_max=\u0663", "must be name=number"),
        ("torque_max=1e999", "is too large a number"),
        ("temperature=20 N.m", 'cannot convert "N.m" to "K"'),
    ],
)
def test_a_loop_that_does_not_say_what_was_varied_is_refused(tmp_path: Path, said: str, message: str) -> None:
    write_loop(tmp_path / "a.csv", element(), 20.0)
    with pytest.raises(ValueError, match=message):
        series_of([f"{tmp_path / 'a.csv'},{said}"])


def test_loops_must_all_say_the_same_things(tmp_path: Path) -> None:
    write_loop(tmp_path / "a.csv", element(), 20.0)
    with pytest.raises(ValueError, match=r"a\.csv has no temperature, which other loops have"):
        series_of([f"{tmp_path / 'a.csv'},temperature=300", f"{tmp_path / 'a.csv'}"])


def test_a_series_in_which_nothing_was_varied_tells_nothing() -> None:
    series = Series({"torque_max": [1.0, 1.0, 1.0]}, {"area": [1.0, 2.0, 3.0]}, name="same.csv")
    with pytest.raises(ValueError, match=r"in same\.csv nothing was varied: torque_max stayed the same"):
        analyse_series(series)
