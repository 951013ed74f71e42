"""A verb of the command in a process of its own, which writes its progress, output and question as lines of JSON.

The studio starts it with the words of a command line. With `read` in place of a verb it writes how files are read.
"""

from __future__ import annotations

import json
import os
import signal
import sys
import time
from collections.abc import Callable, Collection
from io import TextIOBase
from threading import Thread
from typing import Any

from strainwave.commands import cli
from strainwave.operating_system import kill_group, limit_process
from strainwave.progress import watched_by
from strainwave.questions import Answer, QuestionError

MAX_PROCESSOR_TIME = 3600  # s
TIME_TO_END = 2.0  # s that a process has to end those that it started
MAX_MEMORY = 16 * 2**30  # bytes of addresses
MIN_PROGRESS_INTERVAL = 0.05  # s between two reports of one stage
MAX_LINE = 10_000  # characters of a line of output
READ = "read"  # in place of a verb


class Lines(TextIOBase):
    """A text stream that hands over each line as it is completed."""

    def __init__(self, take: Callable[[str], None]) -> None:
        self._take, self._begun = take, ""

    def write(self, text: str) -> int:
        *whole, self._begun = (self._begun + text).split("\n")
        for line in whole:
            self._take(line[:MAX_LINE])
        return len(text)

    def end(self) -> None:
        """Hand over a last line that no newline ended."""
        if self._begun:
            self.write("\n")


def main(words: list[str]) -> int:
    """Run a verb. Return its exit code."""
    channel = sys.stdout

    def send(**event: Any) -> None:
        channel.write(json.dumps(event, allow_nan=False) + "\n")
        channel.flush()

    limit_process(MAX_PROCESSOR_TIME, MAX_MEMORY)
    lines = Lines(lambda line: send(line=line))
    sys.stdout = sys.stderr = lines
    sys.argv = ["strainwave", *words]
    with watched_by(_progress(send)):
        if words[:1] == [READ]:
            send(readings=_readings(words[1:]))
            return 0
        code, question = cli.run()
    lines.end()
    if question is not None:
        send(question=question_of(question))
    return code


def _end_with_server() -> None:
    """Wait for the end of the input, which the server holds open as long as it runs, and end this process and its own."""
    while os.read(0, 1):  # not by sys.stdin, whose lock would be held at the end
        pass
    os.kill(os.getpid(), signal.SIGTERM)
    time.sleep(TIME_TO_END)
    kill_group(os.getpid())


def _progress(send: Callable[..., None]) -> Callable[[str, float], None]:
    """Return the report of a stage and its share, which leaves out what nobody could see."""
    reported: tuple[str, float] = ("", 0.0)

    def report(stage: str, share: float) -> None:
        nonlocal reported
        now = time.monotonic()
        if stage != reported[0] or now - reported[1] > MIN_PROGRESS_INTERVAL:
            reported = (stage, now)
            send(stage=stage, share=share if share == share else None)

    return report


def question_of(question: QuestionError) -> dict[str, Any]:
    """Return a question with its answers as data of a page."""
    return {"text": question.question, "answers": [_answer(each) for each in question.answers]}


def _answer(answer: Answer) -> dict[str, Any]:
    words = answer.options
    return {
        "label": answer.label,
        "gives": answer.gives,
        "options": [[name.removeprefix("--"), value] for name, value in zip(words[::2], words[1::2], strict=True)],
        "numbers": dict(answer.numbers),
        "files": list(answer.files),
    }


def _readings(words: list[str]) -> list[dict[str, Any]]:
    """Return how the files of a command line are read, each with a table of its columns, or with what is asked or wrong."""
    from pathlib import Path

    from strainwave.commands.file_options import FileOptions
    from strainwave.identification.reading.source import distinct_names, measurement_files

    options: dict[str, Any] = {}
    end = words.index("--")
    for word in words[:end]:
        name, _, value = word.removeprefix("--").partition("=")
        if name in ("column", "unit", "constant"):
            options.setdefault(name, []).append(value)
        elif name in ("side", "joint", "kind"):
            options[name] = value
    opened = measurement_files([Path(word) for word in words[end + 1 :]])
    names = distinct_names(opened.files)
    try:
        mapping_of = FileOptions(**options).mapping_of(opened.files)
    except ValueError as error:
        return [{"name": "", "problem": str(error)}]
    return [_reading(names[file.path], file, mapping_of) for file in opened.files]


def _reading(name: str, file: Any, mapping_of: Callable[[Any], Any]) -> dict[str, Any]:
    from strainwave.identification.kinds import KINDS
    from strainwave.identification.reading.recognise import recognise

    try:
        read = recognise(file, mapping_of(file.path))
    except QuestionError as question:
        return {"name": name, "columns": _columns(file), "question": question_of(question)}
    except (ValueError, OSError, ImportError, MemoryError) as error:
        return {"name": name, "problem": str(error)}
    columns = [
        {"column": column, "channel": channel, "unit": read.units.get(channel, ""), "assumed": channel in read.units_assumed}
        | _range(read.recording, channel)
        for channel, column in read.columns.items()
    ]
    columns += _columns(file, {*read.columns.values()})
    reported = {
        "kind": KINDS[read.kind].title,
        "side": read.side,
        "joint": read.joint,
        "rows": len(read.recording[read.recording.names[0]]),
    }
    return {"name": name, "columns": columns, "why": [*read.why], "remarks": [*read.remarks]} | reported


def _columns(file: Any, used: Collection[str] = ()) -> list[dict[str, Any]]:
    """Return the columns of a file but those of these names."""
    others = [label for label in file.table.labels if not {label.name, label.text} & {*used}]
    return [{"column": label.text, "channel": "", "unit": label.unit or ""} for label in others]


def _range(recording: Any, channel: str) -> dict[str, Any]:
    """Return the smallest and the largest value of a channel in SI units; nothing if it is not used."""
    if channel not in recording.names:
        return {}
    values = recording[channel]
    return {"low": float(values.min()), "high": float(values.max()), "si": recording.unit(channel)}


if __name__ == "__main__":
    signal.signal(signal.SIGTERM, signal.default_int_handler)  # ends what an interrupt ends: a compiler, too
    Thread(target=_end_with_server, daemon=True).start()
    sys.exit(main(sys.argv[1:]))
