"""The record of a test: what is read, what is refused and in which words, what survives writing and adding."""

from __future__ import annotations

import math
import re
from itertools import count
from pathlib import Path

import pytest
from hypothesis import HealthCheck, given, settings, strategies as st
from strainwave.rig.bench.steps import Step, append_step, read_steps, write_steps

TEXT = """number,mass_positive [g],mass_negative [g],image,time [min],temperature [degC],position [deg],unit
1,250,0,001.png,0,21.5,60,A
2,200,0,002.png,1.5,,60,A
"""


def read(text: str, folder: Path) -> list[Step]:
    (folder / "steps.csv").write_text(text, encoding="utf-8")
    return read_steps(folder / "steps.csv")


def test_numbers_are_converted_to_si(tmp_path: Path) -> None:
    first, second = read(TEXT, tmp_path)
    assert first == Step(1, 0.25, 0.0, "001.png", time=0.0, temperature=294.65, position=math.radians(60.0), unit="A")
    assert (second.time, second.temperature) == (90.0, None)


def test_a_table_with_semicolons_may_have_decimal_commas(tmp_path: Path) -> None:
    (step,) = read("number;torque [N.m];angle [deg]\n1;-0,36;2,5\n", tmp_path)
    assert (step.torque, step.angle) == (-0.36, math.radians(2.5))


def test_the_folder_of_a_test_stands_for_its_record(tmp_path: Path) -> None:
    assert read(TEXT, tmp_path) == read_steps(tmp_path)


def test_a_step_whose_torque_was_measured_needs_no_masses(tmp_path: Path) -> None:
    text = "number,mass_positive [kg],torque [N.m]\n1,,0.3\n2,0.2,\n"
    assert [(step.mass_positive, step.torque) for step in read(text, tmp_path)] == [(0.0, 0.3), (0.2, None)]


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("number,", "", "steps.csv has no column number, which counts the steps"),
        ("250", "", 'steps.csv line 2 column "mass_positive": is empty; write 0 where nothing lies on the pans'),
        ("250", "-250", "steps.csv line 2 mass_positive = -0.25 kg must lie in [0, 1e+12]"),
        ("250", "nan", 'steps.csv line 2 column "mass_positive": "nan" is no number; write digits with a decimal point'),
        ("250", "inf", 'steps.csv line 2 column "mass_positive": "inf" is no number'),
        ("250", "1e300", "steps.csv line 2 mass_positive = 1e+297 kg must lie in [0, 1e+12]"),
        ("250", "1e-320", "steps.csv line 2 mass_positive = "),
        ("21.5", "1e300", "steps.csv line 2 temperature = 1e+300 K must lie in [1e-30, 1e+12]"),
        ("250", "much", 'steps.csv line 2 column "mass_positive": "much" is no number'),
        ("250", "1e999", 'steps.csv line 2 column "mass_positive": "1e999" is too large a number'),
        ("250", "1_0", 'steps.csv line 2 column "mass_positive": "1_0" is no number'),
        ("250", "\u0662\u0665", 'steps.csv line 2 column "mass_positive": "\u0662\u0665" is no number'),
        ("2,200", "\u0662,200", 'steps.csv line 3 column "number": "\u0662" must be a whole number, from 1 to 999999999'),
        ("2,200", f"{'9' * 4400},200", f'steps.csv line 3 column "number": "{"9" * 60}…" must be a whole number'),
        ("2,200", "1,200", "steps.csv line 3 step 1 stands after step 1; numbers count the steps in the order made"),
        ("2,200", "2.5,200", 'steps.csv line 3 column "number": "2.5" must be a whole number, from 1'),
        ("2,200", "0,200", "steps.csv line 3 number = 0 must be 1 or more"),
        ("mass_positive [g]", "mass [g]", 'steps.csv has a column "mass"; the steps of a test have number, mass_positive, '),
        ("mass_negative [g]", "mass_positive [g]", 'steps.csv has two columns "mass_positive"; names must differ'),
        ("mass_positive [g]", "mass_positive", 'column "mass_positive" has no unit; write mass_positive [kg]'),
        ("mass_positive [g]", "mass_positive [N]", 'steps.csv column "mass_positive": cannot convert "N" to "kg"'),
        ("21.5", "-300", "steps.csv line 2 temperature = "),
        ("A\n2", "A,x\n2", "steps.csv line 2: the number of cells is 9; the header has 8"),
    ],
)
def test_what_is_wrong_is_refused_in_one_line(tmp_path: Path, old: str, new: str, message: str) -> None:
    assert old in TEXT
    with pytest.raises(ValueError, match=re.escape(message)) as refused:
        read(TEXT.replace(old, new, 1), tmp_path)
    assert "\n" not in str(refused.value)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (
            "number,image\n1,a.png\n",
            "steps.csv has no masses; write mass_positive [kg] and mass_negative [kg], or torque [N.m]",
        ),
        ("torque [N.m]\n1\n", "steps.csv has no column number, which counts the steps"),
        ("number,torque [N.m]\n1,\n", 'steps.csv line 2 column "torque": is empty, and there are no masses'),
    ],
)
def test_a_record_without_what_is_needed_is_refused(tmp_path: Path, text: str, message: str) -> None:
    with pytest.raises(ValueError, match=re.escape(message)):
        read(text, tmp_path)


numbers = st.floats(-1e6, 1e6)
masses = st.just(0.0) | st.floats(1e-30, 5.0)
names = st.none() | st.from_regex(r"[a-z][a-z ,\"]{0,8}\.png", fullmatch=True)
bodies = st.tuples(masses, masses, names, *[st.none() | numbers] * 3, st.none() | st.floats(200.0, 400.0))
records = st.lists(st.tuples(bodies, numbers, st.sampled_from(["", "A", "unit 2"])), min_size=1, max_size=8)


def steps_of(record: list[tuple[tuple[object, ...], float, str]]) -> list[Step]:
    return [Step(number, *body, position, unit) for number, (body, position, unit) in zip(count(1), record, strict=False)]  # type: ignore[arg-type]


def assert_alike(one: list[Step], other: list[Step]) -> None:
    """Equal, but for the last digit of a temperature and a position, which the file has in other units."""
    for first, second in zip(one, other, strict=True):
        assert (first.temperature is None) == (second.temperature is None)
        assert first.temperature is None or first.temperature == pytest.approx(second.temperature, rel=1e-15)
        assert first.position == pytest.approx(second.position, rel=1e-15)
        alike = {"temperature": None, "position": 0.0}
        assert {**vars(first), **alike} == {**vars(second), **alike}


untimed = settings(deadline=None, max_examples=40, suppress_health_check=[HealthCheck.function_scoped_fixture])


@pytest.mark.slow("rig")
@untimed
@given(record=records)
def test_what_is_written_is_read_back(tmp_path: Path, record: list[tuple[tuple[object, ...], float, str]]) -> None:
    steps = steps_of(record)
    write_steps(steps, tmp_path)
    assert_alike(read_steps(tmp_path), steps)


@pytest.mark.slow("rig")
@untimed
@given(record=records)
def test_steps_added_one_by_one_are_the_record(tmp_path: Path, record: list[tuple[tuple[object, ...], float, str]]) -> None:
    (tmp_path / "steps.csv").unlink(missing_ok=True)
    steps = steps_of(record)
    for step in steps:
        append_step(step, tmp_path)
    assert_alike(read_steps(tmp_path), steps)


@pytest.mark.parametrize("position", [0.0, 60.0, 120.0, 22.5])
def test_positions_are_written_in_degrees_as_one_says_them(tmp_path: Path, position: float) -> None:
    write_steps([Step(1, mass_positive=0.1, position=math.radians(position), temperature=293.15)], tmp_path)
    cells = (tmp_path / "steps.csv").read_text().splitlines()[1].split(",")
    assert cells[3:] == (["20", f"{position:g}"] if position else ["20"])


def test_a_step_is_added_in_the_units_of_the_record_and_leaves_the_rest_as_it_is(tmp_path: Path) -> None:
    text = "# made by hand\n" + TEXT.removesuffix("\n")
    read(text, tmp_path)
    append_step(Step(3, mass_positive=0.125, time=120.0, position=math.radians(60.0), unit="A"), tmp_path)
    assert (tmp_path / "steps.csv").read_text() == text + "\n3,125,0,,2,,60,A\n"


@pytest.mark.parametrize(
    ("step", "message"),
    [
        (Step(2, mass_positive=0.1), "step 2 stands after step 2"),
        (Step(3, torque=0.1), "has no column torque, which step 3 has; add torque [N.m] to its header"),
    ],
)
def test_a_step_that_does_not_fit_is_not_added(tmp_path: Path, step: Step, message: str) -> None:
    read(TEXT, tmp_path)
    with pytest.raises(ValueError, match=re.escape(message)):
        append_step(step, tmp_path)
    assert (tmp_path / "steps.csv").read_text() == TEXT


def test_no_steps_are_no_record(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match="there are no steps to write"):
        write_steps([], tmp_path)


@pytest.mark.parametrize(
    "members", [{"image": " 1.png"}, {"image": "1\n.png"}, {"unit": "A "}, {"unit": "a\nb"}, {"unit": 201 * "a"}]
)
def test_a_name_that_no_record_can_hold_is_refused(members: dict[str, str]) -> None:
    with pytest.raises(ValueError, match="must be one line of text without spaces around it"):
        Step(1, mass_positive=0.1, **members)  # type: ignore[arg-type]
