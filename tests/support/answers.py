"""Answers of questions that files leave open, as tests give them."""

from __future__ import annotations

import shlex
from pathlib import Path

from strainwave.identification.reading.mapping import FileMapping
from strainwave.questions import NUMBER, Answer, QuestionError

from tests.python.command import Result, strainwave

MAX_QUESTIONS = 2  # until a result
NUMBERS = {
    "rate": "200", "torque_constant": "0.1", "motor_inertia": "1e-5", "ratio": "100", "resistance": "1", "speed": "10",
    "counts": "65536", "permille": "0.4", "%": "0.4",
}  # fmt: skip


def options_of(question: BaseException | None) -> list[str]:
    """The options of each answer to a question, as a command line has them."""
    assert isinstance(question, QuestionError)
    return [shlex.join([*answer.options, *answer.files]) for answer in question.answers]


def mapping_of(answer: Answer, **further: object) -> FileMapping:
    """What a person states who gives an answer, and further things."""
    return FileMapping(**{**answer.given, **further})


def answer_with(question: BaseException | None, label: str) -> Answer:
    """The answer to a question with these words."""
    assert isinstance(question, QuestionError)
    return next(answer for answer in question.answers if label in answer.label)


def commands_in(result: Result) -> list[list[str]]:
    """The commands that a question offers, with numbers of an example drive, without the program's name."""
    lines = [line for line in result.stderr.splitlines() if line.startswith("    strainwave ")]
    return [[with_number(word) for word in shlex.split(line)[1:]] for line in lines]


def question_in(result: Result) -> str:
    """The question without its answers, and without the names of files."""
    return result.stderr.partition("\n")[0].rpartition(": ")[2]


def with_number(word: str) -> str:
    """A word of an option, with a number of an example drive where a person has to write one."""
    if NUMBER not in word:
        return word
    return word.replace(NUMBER, next(number for name, number in NUMBERS.items() if name in word))


def outcomes(words: list[str], folder: Path, most: int = 20, asked: tuple[str, ...] = ()) -> list[tuple[str, Result]]:
    """Each command that a command leads to, itself if it asks nothing, with its result; fails if one is led in circles.

    Of a question with many answers, as of the joints of an arm, the first `most`.
    """
    result = strainwave(*words, folder=folder)
    commands = commands_in(result)
    if not commands:
        return [(shlex.join(words), result)]
    question = result.stderr.partition("\n")[0]
    assert question not in asked, f"asked again: {shlex.join(words)}: {result.stderr}"
    assert len(asked) < MAX_QUESTIONS, f"a third question: {shlex.join(words)}: {result.stderr}"
    assert result.returncode == 2
    assert len({shlex.join(each) for each in commands}) == len(commands), result.stderr
    return [found for command in commands[:most] for found in outcomes(command, folder, most, (*asked, question))]
