"""Questions that a file leaves open, each with its answers: options of the command, and keyword arguments in Python."""

from __future__ import annotations

import re
import shlex
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from itertools import accumulate
from typing import Any

from strainwave.messages import printable

MAX_MESSAGE = 800  # characters of an error in Python; the command prints each answer on a line of its own
NUMBER = "NUMBER"  # stands in an answer for a number that only a person knows
ALL_JOINTS = "all"  # in place of the name of a joint
TABLES = {"columns": "--column", "units": "--unit", "constants": "--constant"}  # arguments with an option for each entry
SINGLE = {"joint": "--joint", "kind": "--kind", "side": "--side"}


@dataclass(frozen=True)
class Answer:
    """An answer to a question: what a person states of a file.

    Args:
        label: the answer in words
        given: the statement, as keyword arguments of `FileMapping`; numbers that only a person knows as an example
        numbers: these numbers in words, by the names of their constants or columns
        files: further words of the command, as paths of files to read with it
        gives: what the file is with this answer, in words
    """

    label: str
    given: Mapping[str, Any] = field(default_factory=dict)
    numbers: Mapping[str, str] = field(default_factory=dict)
    files: tuple[str, ...] = ()
    gives: str = ""

    @property
    def options(self) -> list[str]:
        """The options to add to a command line; `files` go behind them.

        >>> Answer("samples of a log", {"constants": {"rate": 500.0}}, numbers={"rate": "rows per second"}).options
        ['--constant', 'rate=NUMBER']
        """
        words = [word for name, option in SINGLE.items() if name in self.given for word in (option, str(self.given[name]))]
        for name, option in TABLES.items():
            for key, value in self.given.get(name, {}).items():
                words += [option, f"{key}={self.written(key, value)}"]
        return words

    @property
    def stated(self) -> frozenset[tuple[str, str]]:
        """What an answer states, by its argument and the name of its entry.

        >>> sorted(Answer("at the motor", {"side": "input", "units": {"v": "rpm"}}).stated)
        [('side', ''), ('units', 'v')]
        """
        entries = {(name, key) for name in TABLES for key in self.given.get(name, ())}
        return frozenset(entries | {(name, "") for name in SINGLE if name in self.given})

    @property
    def arguments(self) -> str:
        """The keyword arguments of `FileMapping`, as Python has them.

        >>> Answer("at the motor", {"side": "input", "units": {"v": "rpm"}}).arguments
        'side="input", units={"v": "rpm"}'
        """
        singles = [f'{name}="{self.given[name]}"' for name in SINGLE if name in self.given]
        tables = [
            f"{name}={{{', '.join(self._entry(key, value) for key, value in self.given[name].items())}}}"
            for name in TABLES
            if name in self.given
        ]
        return ", ".join([*singles, *tables])

    def after(self, first: Answer) -> Answer:
        """Return this and an answer that was given before, as one."""
        given = {**first.given, **self.given}
        given |= {name: {**first.given[name], **self.given[name]} for name in TABLES if {*first.given} & {*self.given} & {name}}
        label = ", ".join(filter(None, (first.label, self.label)))
        numbers, files = {**first.numbers, **self.numbers}, (*first.files, *self.files)
        return replace(self, label=label, given=given, numbers=numbers, files=files)

    def written(self, name: str, value: object) -> str:
        """Return a value of an option, with the word in place of a number that only a person knows."""
        text = f"{value:g}" if isinstance(value, float) else str(value)
        return re.sub(r"\d+(\.\d+)?(e[+-]?\d+)?", NUMBER, text, count=1) if name in self.numbers else text

    def _entry(self, name: str, value: object) -> str:
        text = self.written(name, value)
        return f'"{name}": "{text}"' if isinstance(value, str) else f'"{name}": {text}'


class QuestionError(ValueError):
    """A file leaves a question open.

    Args:
        question: in words
        answers: that are possible, the usual one first; none if only another record has one
        by_fit: True if a fit can decide between the answers

    >>> ways = [Answer("of the joint", {"side": "output"}), Answer("of the motor", {"side": "input"})]
    >>> print(QuestionError("q may be an angle of the joint or the motor", ways))
    q may be an angle of the joint or the motor: of the joint with --side output (in Python FileMapping(side="output")), or of \
the motor with --side input (in Python FileMapping(side="input"))
    """

    def __init__(self, question: str, answers: Sequence[Answer] = (), *, by_fit: bool = False) -> None:
        self.question, self.answers, self.by_fit = question, tuple(answers), by_fit
        in_python = [f" (in Python FileMapping({each.arguments}))" if each.given else "" for each in self.answers]
        ways = [
            f"{each.label} with {shlex.join([*each.options, *each.files])}{python}"
            for each, python in zip(self.answers, in_python, strict=True)
        ]
        ends = list(accumulate(map(len, ways), initial=len(question)))
        shown = [way for way, end in zip(ways, ends[1:], strict=True) if end <= MAX_MESSAGE] or ways[:1]
        more = f", or {len(ways) - len(shown)} more, of which `answers` has all" if len(shown) < len(ways) else ""
        super().__init__(_on_one_line(f"{question}{': ' * bool(ways)}{', or '.join(shown)}{more}"))

    def of(self, name: str) -> QuestionError:
        """Return the question with the name of its file in front."""
        return QuestionError(f"{name}: {self.question}", self.answers, by_fit=self.by_fit)

    def lines(self, words: Sequence[str]) -> list[str]:
        """Return the question, and for each answer a command line to paste.

        Args:
            words: the command line that led to the question; options go before a `--`

        >>> answer = Answer("the motor", {"side": "input"}, gives="a log")
        >>> print(*QuestionError("which side?", [answer]).lines(["x"]), sep="\\n")
        which side?
          1. the motor: a log
            x --side input
        """
        lines = [self.question]
        for number, answer in enumerate(self.answers, start=1):
            numbers = "".join(f"; {NUMBER}: {what}" for what in dict.fromkeys(answer.numbers.values()))
            lines += [
                f"  {number}. {answer.label}{': ' * bool(answer.gives)}{answer.gives}{numbers}",
                f"    {shlex.join(added_to(words, answer.options, answer.files))}",
            ]
        return [_on_one_line(line) for line in lines]


def added_to(words: Sequence[str], options: Sequence[str], files: Sequence[str] = ()) -> list[str]:
    """Return a command line with further options and files. Behind a `--` all words are files.

    >>> added_to(["identify", "csg-20-100", "--", "-log.csv"], ["--side", "input"])
    ['identify', 'csg-20-100', '--side', 'input', '--', '-log.csv']
    """
    end = words.index("--") if "--" in words else len(words)
    return [*words[:end], *options, *words[end:], *files]


def _on_one_line(text: str) -> str:
    """Return a text without the characters that a terminal obeys, at its full length: half a command is none."""
    return printable(text).replace("\n", "\\n")


OF_SIDES = [Answer("of the joint", {"side": "output"}), Answer("of the motor", {"side": "input"})]
TORQUE_CONSTANT = Answer("the motor is known", {"constants": {"torque_constant": 0.1}}, {"torque_constant": "N.m/A"})
LOG_AT_RATE = Answer("samples of a log", {"constants": {"rate": 500.0}}, {"rate": "rows per second [Hz]"})
