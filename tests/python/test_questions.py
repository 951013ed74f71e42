"""Questions: their answers on the command line are those in Python, and commands are whole."""

from __future__ import annotations

import shlex
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import pytest
from strainwave.commands.file_options import FileOptions
from strainwave.identification.reading.mapping import FileMapping
from strainwave.messages import with_options
from strainwave.questions import Answer, QuestionError

GIVEN: list[dict[str, Any]] = [
    {"side": "input"},
    {"joint": "3", "kind": "log"},
    {"columns": {"joint_torque": "Torque of 'A'", "speed": "3"}},
    {"units": {"torque": "permille of 0.4 N.m", "angle": "counts/16384"}, "constants": {"rate": 500.0, "ratio": -100.0}},
]


def parsed(words: list[str]) -> FileMapping:
    """What a command line states of a file, as the verbs read it."""
    values: dict[str, Any] = {}
    for option, value in zip(words[::2], words[1::2], strict=True):
        name = option.removeprefix("--")
        if name in ("column", "unit", "constant"):
            values.setdefault(name, []).append(value)
        else:
            values[name] = value
    return FileOptions(**values).mapping_of([])(Path("none.csv"))


@pytest.mark.parametrize("given", GIVEN[:2])
def test_options_state_what_the_keyword_arguments_state(given: Mapping[str, Any]) -> None:
    assert parsed(Answer("an answer", given).options) == FileMapping(**given)


@pytest.mark.parametrize("given", GIVEN)
def test_the_arguments_in_python_are_the_statement(given: Mapping[str, Any]) -> None:
    assert eval(f"dict({Answer('an answer', given).arguments})") == given


def test_a_number_that_a_person_knows_is_left_open_in_both() -> None:
    answer = Answer("of the motor", GIVEN[3], {"torque": "rated torque", "rate": "rows per second"})
    assert answer.options[1] == "torque=permille of NUMBER N.m"
    assert answer.options[3] == "angle=counts/16384"
    assert answer.options[5:] == ["rate=NUMBER", "--constant", "ratio=-100"]
    assert '"rate": NUMBER' in answer.arguments


def test_a_command_is_pasted_as_it_was_meant() -> None:
    question = QuestionError("which?", [Answer("this", GIVEN[2])])
    words = ["strainwave", "identify", "csg-20-100", "my log.csv"]
    command = question.lines(words)[-1]
    assert shlex.split(command) == [*words, *question.answers[0].options]


@pytest.mark.parametrize("hostile", ["\x1b[31mred", "two\nlines", "\u202e"])
def test_no_name_of_a_file_reaches_a_terminal_as_it_is(hostile: str) -> None:
    question = QuestionError(f"which {hostile}?", [Answer(hostile, {"units": {hostile: "rad"}}, gives=hostile)])
    assert all(line.isprintable() for line in (str(question), *question.lines(["strainwave", hostile])))


def test_an_answer_after_another_one_states_both() -> None:
    both = Answer("in turns", {"units": {"angle": "rev"}}).after(
        Answer("of the joint", {"side": "output", "units": {"speed": "rpm"}})
    )
    assert both.given == {"side": "output", "units": {"speed": "rpm", "angle": "rev"}}


def test_the_command_line_has_no_words_of_python() -> None:
    question = QuestionError("which?", [Answer("this", GIVEN[0]), Answer("that", GIVEN[3])])
    assert "FileMapping" in str(question)
    assert "Python" not in with_options(str(question))


def test_options_go_before_the_end_of_options() -> None:
    """A file whose name begins with a hyphen stands behind `--`, where an option would be taken for a file."""
    question = QuestionError("which?", [Answer("at the motor", {"side": "input"}, files=("-q.csv",))])
    words = ["strainwave", "identify", "csg-20-100", "--", "-log.csv"]
    assert shlex.split(question.lines(words)[-1]) == [*words[:3], "--side", "input", *words[3:], "-q.csv"]
