"""The question that a file leaves open: the answers with which it can be read, and what it is with each."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import suppress
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from strainwave.files.units import convert
from strainwave.identification.kinds import kind_named
from strainwave.identification.reading.columns import USUAL_FIRST
from strainwave.identification.reading.joints import joints_of, spans_of_joints
from strainwave.identification.reading.mapping import FileMapping
from strainwave.identification.reading.names import CHANNELS
from strainwave.identification.reading.source import MeasurementFile
from strainwave.messages import listed, one_line
from strainwave.questions import ALL_JOINTS, Answer, QuestionError

if TYPE_CHECKING:
    from strainwave.identification.reading.recognise import Recognised

MAX_ANSWERS = 18  # of one question: two for each of eight joints, and for all
MAX_ANSWERS_OF_JOINTS = 9  # of a question about more than the joint; beyond, the answers of one joint are shown

Read = Callable[[FileMapping], "Recognised"]  # reads a file as a person states it; raises `QuestionError`


def in_usual_way(read: Read, stated: FileMapping) -> Recognised:
    """Return a file as it is read; of a question that a fit may decide, in the usual way, with the others as alternatives.

    Raises:
        QuestionError: no fit decides the question
    """
    try:
        return read(stated)
    except QuestionError as question:
        if question.by_fit:
            with suppress(ValueError):  # an answer leads to a further question, or works not at all
                return _with_alternatives(read, stated, question)
        raise


def _with_alternatives(read: Read, stated: FileMapping, question: QuestionError) -> Recognised:
    """Return a file in the usual way that answers a question, with the others as alternatives."""
    ways = list[Answer]()
    for answer in question.answers:
        file = read(stated.updated(FileMapping(**answer.given)))
        ways += [answer, *(alternative.after(answer) for alternative in file.alternatives)]
    first, *others = ways
    usual = read(stated.updated(FileMapping(**first.given)))
    other = next(way for way in ways if way.given["side"] != usual.side)
    assumed = f"no name or number determines the side: {usual.side} is taken; otherwise add --side {other.given['side']}"
    return replace(usual, alternatives=tuple(others), question=question, remarks=(assumed, *usual.remarks))


def with_answers_that_work(source: MeasurementFile, stated: FileMapping, question: QuestionError, read: Read) -> QuestionError:
    """Return a question with those of its answers with which the file can be read, each with what it is then.

    An answer that leads to a further question is replaced by the answers to both, so that one command answers all.
    """
    answers, why_not = list[Answer](), ""
    for answer in question.answers:
        try:
            answers += _ways_on(source, stated, answer, question, read)
        except ValueError as error:
            why_not = why_not or f"; not {answer.label}: {error}"
    words = question.question if answers else f"{question.question}{why_not}"
    groups = dict[str, list[Answer]]()
    for answer in answers:
        groups.setdefault(str({**answer.given, "joint": None}), []).append(answer)
    answers = [answer for group in groups.values() for answer in group]
    if len(answers) > MAX_ANSWERS_OF_JOINTS and 1 < len(groups) < len(answers):
        moved = spans_of_joints(source.table, stated)
        answers = [max(group, key=lambda way: moved.get(way.given.get("joint", ""), 0.0)) for group in groups.values()]
        words += f"; the joint that moves most is shown, and the others are {listed([*moved, ALL_JOINTS])}"
    words += f"; the first {MAX_ANSWERS} of {len(answers)} answers are" if len(answers) > MAX_ANSWERS else ""
    return QuestionError(one_line(words), answers[:MAX_ANSWERS]).of(source.table.file)


def _ways_on(
    source: MeasurementFile,
    stated: FileMapping,
    answer: Answer,
    question: QuestionError,
    read: Read,
    answered: frozenset[tuple[str, str]] = frozenset(),
) -> list[Answer]:
    """Return an answer with what a file is then; with each answer to the question that follows, if one does.

    Empty if it is an answer to what was `answered` before: units of a time that no unit makes right lead in a circle.
    """
    mapping = stated.updated(FileMapping(**answer.given))
    if answer.files or mapping == stated or not answer.stated.isdisjoint(answered):
        return [answer] if answer.files else []
    if mapping.joint == ALL_JOINTS:
        of_first = [Answer(answer.label, {**answer.given, "joint": joint}) for joint in joints_of(source, stated)[:1]]
        ways = [way for first in of_first for way in _ways_on(source, stated, first, question, read, answered)]
        return [replace(way, given={**way.given, "joint": ALL_JOINTS}, gives="") for way in ways]
    answered |= answer.stated
    try:
        return [replace(answer, gives=in_words(in_usual_way(read, mapping), answer=answer))]
    except QuestionError as following:
        if following.question == question.question:
            return []
        ways = [way for each in following.answers for way in _ways_on(source, mapping, each, following, read, answered)]
        return [way.after(answer) for way in ways]


def in_words(file: Recognised, stated: FileMapping | None = None, answer: Answer | None = None) -> str:
    """Return the kind of a file, and how large its motions and efforts are.

    Args:
        file: as it is read
        stated: channels and units of its columns, by their names in the file, in place of those that it is read with
        answer: that it is read with; sizes in a unit whose number only a person knows are in that unit
    """
    mapping, recording = stated or FileMapping(), file.recording
    channel_of = {column: channel for channel, column in mapping.columns.items()}
    sizes = []
    for name, column in file.columns.items():
        if CHANNELS[name].measured and CHANNELS[name].quantity not in USUAL_FIRST and name in recording:
            size, channel = float(np.abs(recording[name]).max()), channel_of.get(column, name)
            if answer is not None and column in answer.numbers:
                own = file.units[name]
                sizes.append(f"{channel} to {convert(size, recording.unit(name), own):.3g} {answer.written(column, own)}")
                continue
            if unit := mapping.units.get(column):
                size = convert(convert(size, recording.unit(name), file.units[name]), unit, CHANNELS[channel].unit)
            sizes.append(f"{channel} to {size:.3g} {CHANNELS[channel].unit if unit else recording.unit(name)}")
    return f"{kind_named(file.kind).title}; {listed(sizes)}"
