"""Arguments of functions: what is taken, what is refused, and in which words, by whatever function they go to."""

from __future__ import annotations

import re
from collections.abc import Callable
from fractions import Fraction
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import strainwave as sw
from strainwave import arguments
from strainwave.simulation.state import start_of

DRIVE = sw.Drive(load=sw.loads.Inertia(inertia=0.01))
COMMAND = sw.scenario.step(0.1, 0.01)
MEMBERS = {"load.inertia": [0.01, 0.02]}


def exactly(message: str) -> str:
    return f"^{re.escape(message)}$"


@pytest.mark.parametrize("value", [1, 1.0, np.float32(1.0), np.int64(1), Fraction(1)])
def test_a_number_of_any_kind_is_taken_as_a_float(value: Any) -> None:
    given = arguments.number("dt", value, "s", low=0.0)
    assert type(given) is float
    assert given == 1.0


def test_a_text_with_a_unit_is_a_number_and_one_without_or_with_another_is_refused() -> None:
    assert arguments.number("dt", "1 ms", "s", low=0.0) == 1e-3
    for text, wrong in (
        ("1", 'dt = "1" has no unit; write a number and its unit, as "1.2 s"'),
        ("soon", 'dt = "soon" must be a number and its unit, as "1.2 s"'),
        ("1 N.m", 'dt: cannot convert "N.m" to "s"; write a number and its unit, as "1.2 s"'),
        (
            "1 sec.",
            'dt = "1 sec.": unit "sec." is not known; write it like N.m, rad/s, deg; write a number and its unit, as "1.2 s"',
        ),
        ("-1 ms", "dt = -0.001 s must lie in (0, inf)"),
        ("≤ 1 ms", 'dt = "≤ 1 ms" must be a number and its unit, as "1.2 s"'),
    ):
        with pytest.raises(ValueError, match=exactly(wrong)):
            arguments.number("dt", text, "s", low=0.0)
    assert arguments.number("dt", ".5 ms", "s") == arguments.number("dt", "+.5 ms", "s") == 5e-4
    with pytest.raises(ValueError, match=r'^constant = "75 A/mN\.m": .*; write a number and its unit, as "1.2 N\.m/A"$'):
        arguments.number("constant", "75 A/mN.m", "N.m/A")
    for speed in ("60 rpm", "6.28 rad/s"):  # a sine of 60 rpm may be meant by its cycles or its angle
        with pytest.raises(ValueError, match=r'^rate: cannot convert ".*" to "Hz"; write a number and its unit, as "1.2 Hz"$'):
            arguments.number("rate", speed, "Hz")
    for take in (arguments.number, arguments.bare_number):
        with pytest.raises(TypeError, match=exactly("share must be a number, not '1'")):
            take("share", "1")
    with pytest.raises(TypeError, match=exactly("value must be a number, not '1 ms'")):
        arguments.bare_number("value", "1 ms", "s")


@pytest.mark.parametrize("value", [None, True, np.True_, 1j, [1.0], np.array(1.0), np.array([1.0])])
def test_what_is_no_number_is_refused(value: Any) -> None:
    with pytest.raises(TypeError, match=exactly(f"dt must be a number, not {value!r}")):
        arguments.number("dt", value, "s")


@pytest.mark.parametrize(
    ("brackets", "low", "high", "wrong", "interval"),
    [
        ("()", 0.0, 2.0, (0.0, 2.0, -1.0, np.nan), "lie in (0, 2)"),
        ("[)", 0.0, 2.0, (2.0, -1e-9, np.nan), "lie in [0, 2)"),
        ("(]", 0.0, 2.0, (0.0, 2.1, np.nan), "lie in (0, 2]"),
        ("[]", 0.0, 2.0, (-0.1, 2.1, np.nan), "lie in [0, 2]"),
        ("()", -np.inf, np.inf, (np.inf, -np.inf, np.nan), "be finite"),
    ],
)
def test_a_number_outside_its_interval_is_refused(
    brackets: str, low: float, high: float, wrong: tuple[float, ...], interval: str
) -> None:
    for value in wrong:
        with pytest.raises(ValueError, match=exactly(f"twist = {value} rad must {interval}")):
            arguments.number("twist", value, "rad", brackets, low, high)
    inside = {"(": [], "[": [low]}[brackets[0]] + {")": [], "]": [high]}[brackets[1]] + [1.0]
    assert [arguments.number("twist", value, "rad", brackets, low, high) for value in inside] == inside


def test_a_whole_number_is_no_other() -> None:
    assert arguments.whole("threads", np.int64(2), 1) == 2
    for value in (1.5, 2.0, "2", True, None):
        with pytest.raises(TypeError, match=exactly(f"threads must be a whole number, not {value!r}")):
            arguments.whole("threads", value, 1)
    with pytest.raises(ValueError, match=exactly("threads = 0 must be 1 or more")):
        arguments.whole("threads", 0, 1)


class Column:
    """As a table of another library hands out its columns."""

    def __array__(self, dtype: Any = None, copy: Any = None) -> np.ndarray[Any, Any]:
        return np.array([1, 2])


@pytest.mark.parametrize("values", [[1, 2], (1.0, 2.0), range(1, 3), np.float32([1.0, 2.0]), Column()])
def test_numbers_of_any_kind_are_taken_as_floats(values: Any) -> None:
    given = arguments.numbers("inertia", values)
    assert given.dtype == np.float64
    assert given.tolist() == [1.0, 2.0]


@pytest.mark.parametrize(
    ("values", "error", "message"),
    [
        (["1", "2"], TypeError, "inertia must hold numbers, not <U1"),
        ("5 Hz", TypeError, "inertia must hold numbers, not <U4"),
        ([True], TypeError, "inertia must hold numbers, not bool"),
        ([1.0, None], TypeError, "inertia must hold numbers, not object"),
        ({1.0}, TypeError, "inertia must hold numbers, not object"),
        (np.array(["2020-01-01"], "datetime64[D]"), TypeError, "inertia must hold numbers, not datetime64[D]"),
        ([1j], TypeError, "inertia must hold numbers, not complex128"),
        ([[1.0], [1.0, 2.0]], ValueError, "inertia must be one series of numbers"),
        (np.ma.masked_array([1.0, 2.0], [False, True]), ValueError, "inertia has masked values; every one must be a number"),
    ],
)
def test_what_holds_no_numbers_is_refused(values: Any, error: type[Exception], message: str) -> None:
    with pytest.raises(error, match=exactly(message)):
        arguments.numbers("inertia", values)


def test_names_are_taken_from_whatever_goes_through_them() -> None:
    for values in (["a", "b"], ("a", "b"), {"a": 1, "b": 2}, (name for name in "ab"), np.array(["a", "b"])):
        assert arguments.names("record", values) == ["a", "b"]
    assert arguments.names("record", []) == []
    for wrong in ("torque", 3, None, [3], [["a"]]):
        with pytest.raises(TypeError, match=exactly(f"record must be a list of names, not {wrong!r}")):
            arguments.names("record", wrong)


def test_one_of_a_few_words_is_taken_and_others_are_refused() -> None:
    assert arguments.one_of("side", "input", ("input", "output")) == "input"
    with pytest.raises(ValueError, match=exactly('side = "left" must be one of input, output')):
        arguments.one_of("side", "left", ("input", "output"))
    for wrong in (3, None, [["input"]]):
        with pytest.raises(TypeError, match=exactly(f"side must be a text, not {wrong!r}")):
            arguments.one_of("side", wrong, ("input", "output"))


def test_a_mapping_is_no_list() -> None:
    arguments.mapping("units", {}, '{"time": "s"}')
    for wrong in (["s"], "s", 3, None):
        with pytest.raises(TypeError, match=exactly(f'units must be a mapping, as in {{"time": "s"}}, not {wrong!r}')):
            arguments.mapping("units", wrong, '{"time": "s"}')


@pytest.mark.parametrize("digits", [10**5000, -(10**5000)], ids=["huge", "as negative"])
def test_a_whole_number_of_thousands_of_digits_is_refused_by_its_name(digits: int) -> None:
    for refuse in (lambda: arguments.number("dt", digits), lambda: arguments.whole("dt", digits, 0)):
        with pytest.raises(ValueError, match=r"^dt = <int with too many digits> (is too large|must be \d+ or)"):
            refuse()


def test_a_longer_float_may_become_infinite() -> None:
    assert arguments.numbers("inertia", np.array(["1e4000"], np.longdouble)).tolist() == [np.inf]


def test_what_is_shown_of_a_wrong_argument_is_short() -> None:
    drive = sw.Drive()
    for refuse in (arguments.drive, lambda value: arguments.number("dt", value), lambda value: start_of(drive, value)):
        with pytest.raises(TypeError) as told:
            refuse(1000 * "no drive ")
        assert len(str(told.value)) < 150


def functions(**given: Any) -> list[Callable[[], object]]:
    """Calls of every function that takes an argument of this name."""
    (name,) = given
    takes: dict[Callable[..., object], tuple[tuple[Any, ...], set[str]]] = {
        sw.simulate: ((DRIVE, COMMAND), {"dt", "sample"}),
        sw.simulate_adaptively: ((DRIVE, COMMAND), {"rtol", "atol", "sample"}),
        sw.simulate_many: ((DRIVE, COMMAND, MEMBERS), {"dt", "sample", "threads"}),
        sw.analysis.frequency_response: (
            (DRIVE, 20.0) + (() if name == "amplitude" else (0.01,)),
            {"amplitude", "command", "load_torque", "temperature", "dt", "tolerance", "max_periods", "initial"},
        ),
        sw.analysis.equilibrium: ((DRIVE,), {"command", "load_torque", "temperature", "initial"}),
        sw.linearise: ((DRIVE,), {"state", "command", "command_rate", "load_torque", "temperature"}),
    }
    return [lambda f=f, a=a: f(*a, **given) for f, (a, names) in takes.items() if name in names]


NUMBERS = ("dt", "sample", "rtol", "atol", "amplitude", "tolerance", "command", "command_rate", "load_torque", "temperature")


@pytest.mark.parametrize("value", [[1e-3], np.array([1e-3]), 1e-3 + 0j], ids=repr)
@pytest.mark.parametrize("name", NUMBERS)
def test_every_function_wants_numbers_where_it_takes_one(name: str, value: Any) -> None:
    for call in functions(**{name: value}):
        with pytest.raises(TypeError, match=exactly(f"{name} must be a number, not {value!r}")):
            call()


@pytest.mark.parametrize("name", NUMBERS)
def test_every_function_wants_numbers_that_are_some(name: str) -> None:
    for call in functions(**{name: float("nan")}):
        with pytest.raises(ValueError, match=rf"^{name} = nan( s| N.m| K)? must (be finite|lie in .*)$"):
            call()


@pytest.mark.parametrize(("name", "low"), [("threads", 1), ("max_periods", 2)])
def test_every_function_wants_whole_numbers_where_it_counts(name: str, low: int) -> None:
    for call in functions(**{name: 3.5}):
        with pytest.raises(TypeError, match=exactly(f"{name} must be a whole number, not 3.5")):
            call()
    for call in functions(**{name: low - 1}):
        with pytest.raises(ValueError, match=exactly(f"{name} = {low - 1} must be {low} or more")):
            call()


@pytest.mark.parametrize("name", ["initial", "state"])
def test_every_function_wants_a_state_where_it_starts_from_one(name: str) -> None:
    for call in functions(**{name: "rest"}):
        with pytest.raises(TypeError, match=f"^{name} = 'rest' must be a state of a drive, as "):
            call()


@pytest.mark.parametrize("command", [0.1, None, "step", [0.1, 0.2]], ids=repr)
def test_every_function_that_runs_a_drive_wants_a_scenario_as_command(command: Any, tmp_path: Path) -> None:
    calls: list[Callable[[], object]] = [
        lambda: sw.simulate(DRIVE, command),
        lambda: sw.simulate_adaptively(DRIVE, command),
        lambda: sw.simulate_many(DRIVE, command, MEMBERS),
        lambda: sw.simulation.simulate_to(tmp_path / "runs", DRIVE, command, MEMBERS),
        lambda: sw.analysis.derivatives(DRIVE, command, ["load.inertia"]),
    ]
    for call in calls:
        with pytest.raises(TypeError, match=f"^{re.escape(f'command = {command!r} must be a Scenario, as ')}"):
            call()


def test_steps_that_no_clock_could_tell_apart_are_refused() -> None:
    for what, advice in (("dt", r"take .*longer (steps|dt)"), ("sample", r"(sample less often|take .*longer steps)")):
        for call in functions(**{what: 1e-300}):
            with pytest.raises(ValueError, match=rf"^[\d.]+ s are more than 1e\+08 steps of 1e-300 s; {advice}"):
                call()


def test_a_number_of_either_sign_has_a_size_in_its_range() -> None:
    assert (arguments.ratio("ratio", -100), arguments.ratio("ratio", 0.1)) == (-100.0, 0.1)
    for wrong in (0.0, -0.05, 1e300, np.inf, np.nan):
        with pytest.raises(ValueError, match=rf"^ratio = {re.escape(str(wrong))} must lie in \[-?[0-9.]+, 10000\]"):
            arguments.ratio("ratio", wrong)


def test_a_whole_number_beyond_all_others_is_refused_by_its_name() -> None:
    with pytest.raises(ValueError, match=r"^dt = 1000.* is too large a number$"):
        sw.simulate(sw.Drive(), sw.scenario.constant(0.0, 0.1), 10**400)
