"""Jobs of a studio: verbs of the command, each in a process of its own, with its progress, questions and results."""

from __future__ import annotations

import asyncio
import json
import re
import sys
import time
from collections.abc import AsyncGenerator, Callable, Mapping
from contextlib import aclosing, suppress
from dataclasses import replace
from pathlib import Path
from typing import Any

from strainwave import exit_codes
from strainwave.files.writing import replacing
from strainwave.operating_system import kill_group
from strainwave.studio.forms import Form
from strainwave.studio.workspace import Workspace

MAX_RUNNING = 2  # jobs at once; further ones wait
MAX_WAITING = 20
MAX_KEPT = 200  # jobs that are listed
MAX_LINES = 1000  # of the output of a job
MAX_READING_TIME = 120.0  # s
TIME_TO_END = 3.0  # s that a process has to end by itself
REPORT_INTERVAL = 0.2  # s between two reports of a running job
MAX_EVENT = 2**22  # bytes of a line of a job
STATE_FILE = "job.json"
RUNS_VERB = ("-m", "strainwave.commands.job")
STATES = {0: "done", exit_codes.RESULT_CONTRADICTED: "contradicted", exit_codes.INPUT_REFUSED: "refused"}


class Jobs:
    """The jobs of a workspace, those of an earlier server too.

    Args:
        changed: called with a job that has changed, as data of the page
    """

    def __init__(self, workspace: Workspace, forms: Mapping[str, Form], changed: Callable[[dict[str, Any]], None]) -> None:
        self._workspace, self._forms, self._changed = workspace, forms, changed
        self._running, self._reading = asyncio.Semaphore(MAX_RUNNING), asyncio.Semaphore(1)
        self._tasks: dict[str, asyncio.Task[None]] = {}
        self._is_closing = False
        self._reported: dict[str, float] = {}  # when each running job was reported last, by its name
        self.jobs = {job["id"]: job for job in _earlier(workspace.results)}
        for job in self.jobs.values():
            if job["state"] in ("waiting", "running"):
                self._report_state(job, "interrupted")

    def start(self, verb: str, values: Mapping[str, Any]) -> str:
        """Start a verb with a form that was filled in. Return the name of the job.

        Raises:
            ValueError: the verb, or a field of the form, is not one that is taken; or too many jobs wait
        """
        if (form := self._forms.get(verb)) is None:
            raise ValueError(f"there is no form of {verb!r}"[:200])
        if len(self._tasks) >= MAX_WAITING:
            raise ValueError(f"{len(self._tasks)} jobs wait; cancel some")
        folders = (path.name.partition("-")[0] for path in self._workspace.results.iterdir())
        number = 1 + max((int(name) for name in folders if name.isdecimal()), default=0)
        name = f"{number}-{verb.replace(' ', '-')}"
        folder = self._workspace.results / name
        words = form.words_of(values, self._workspace.path_of, folder)
        folder.mkdir()
        job = {
            "id": name,
            "verb": verb,
            "values": dict(values),
            "state": "waiting",
            "lines": [],
            "files": [],
            "begun": time.time(),
        }
        self.jobs[name] = job
        self._report_state(job, "waiting")
        self._tasks[name] = asyncio.create_task(self._run(job, words))
        return name

    def cancel(self, name: str) -> None:
        """End a job, if it has not ended."""
        if name in self._tasks:
            self._tasks[name].cancel()

    async def close(self) -> None:
        """End all jobs, which the server's end interrupts."""
        self._is_closing = True
        tasks = list(self._tasks.values())
        for task in tasks:
            task.cancel()
        await asyncio.gather(*tasks, return_exceptions=True)

    async def readings(self, values: Mapping[str, Any]) -> list[dict[str, Any]]:
        """Return how files are read: tables of their columns, or what is asked or wrong.

        Raises:
            ValueError: a field is not one that is taken, or the files cannot be read in time
        """
        stated = {
            name: values[name] for name in ("paths", "column", "unit", "constant", "side", "joint", "kind") if name in values
        }
        form = replace(self._forms["identify"], verb="read", has_folder=False)
        form = replace(form, fields=tuple(field for field in form.fields if field.name != "gear"))
        words, last = form.words_of(stated, self._workspace.path_of, Path()), "the process ended"
        try:
            async with self._reading, asyncio.timeout(MAX_READING_TIME), aclosing(self._events(words)) as events:
                async for event in events:
                    if "readings" in event:
                        return list(event["readings"])
                    last = str(event.get("line", last))
        except TimeoutError:
            last = f"this takes longer than {MAX_READING_TIME:g} s"
        raise ValueError(f"the files could not be read: {last}")

    async def _events(self, words: list[str]) -> AsyncGenerator[dict[str, Any], None]:
        """Yield what the process of a verb reports, files by their names on the page, and at last its exit code."""
        process = await asyncio.create_subprocess_exec(
            *(sys.executable, *RUNS_VERB, *words),
            stdin=asyncio.subprocess.PIPE,  # its end ends the process together with this server
            stdout=asyncio.subprocess.PIPE,
            stderr=asyncio.subprocess.STDOUT,
            cwd=self._workspace.folder,
            limit=MAX_EVENT,
            start_new_session=True,
        )
        assert process.stdout is not None
        names = {json.dumps(str(path))[1:-1]: json.dumps(name)[1:-1] for name, path in self._workspace.files.items()}
        try:
            async for line in process.stdout:
                text = line.decode(errors="replace").rstrip()
                for path, name in names.items():
                    text = text.replace(path, name)
                yield _event(text)
            yield {"code": await process.wait()}
        finally:
            if process.returncode is None:
                process.terminate()  # so that it ends a compiler that it started
                with suppress(TimeoutError):
                    await asyncio.wait_for(process.wait(), TIME_TO_END)
            if process.returncode is None:
                kill_group(process.pid)
                await process.wait()

    async def _run(self, job: dict[str, Any], words: list[str]) -> None:
        begun, state = time.monotonic(), "failed"
        try:
            async with self._running, aclosing(self._events(words)) as events:
                self._report_state(job, "running")
                async for event in events:
                    if "code" in event:
                        state = "asked" if "question" in job else STATES.get(event["code"], "failed")
                        if event["code"] < 0:
                            job["lines"].append(
                                f"the process was ended by signal {-event['code']}: a run has limits of time and memory"
                            )
                    else:
                        self._apply(job, event)
        except asyncio.CancelledError:
            state = "interrupted" if self._is_closing else "cancelled"
        except (OSError, ValueError) as error:
            job["lines"].append(str(error))
            state = "refused"
        finally:
            self._tasks.pop(job["id"], None)
            folder = self._workspace.results / job["id"]
            names = sorted(path.relative_to(folder).as_posix() for path in folder.rglob("*") if path.is_file())
            job |= {"files": [name for name in names if name != STATE_FILE], "seconds": time.monotonic() - begun}
            self._report_state(job, state)

    def _apply(self, job: dict[str, Any], event: dict[str, Any]) -> None:
        """Take over what a process reports."""
        if "line" not in event:
            job |= {name: event[name] for name in ("stage", "share", "question") if name in event}
        elif len(job["lines"]) < MAX_LINES:
            job["lines"].append(str(event["line"]))
        if (now := time.monotonic()) - self._reported.get(job["id"], 0.0) > REPORT_INTERVAL:
            self._reported[job["id"]] = now
            self._report_state(job)

    def _report_state(self, job: dict[str, Any], state: str | None = None) -> None:
        """Report a job, and write it if its state is another one."""
        if state is not None:
            job["state"] = state
            try:
                with replacing(self._workspace.results / job["id"] / STATE_FILE) as file:
                    file.write(json.dumps(job, allow_nan=False).encode())
            except OSError as error:
                job["lines"].append(f"the state of this run could not be written: {error}")
        self._changed(job)


def _event(line: str) -> dict[str, Any]:
    """Return what a line of a process reports; one that it did not write as an event is a line of its output."""
    try:
        event = json.loads(line)
    except ValueError:
        event = None
    return event if isinstance(event, dict) else {"line": line}


def _earlier(results: Path) -> list[dict[str, Any]]:
    """Return the jobs that earlier servers wrote, the newest ones."""
    jobs = []
    for path in results.glob(f"*/{STATE_FILE}"):
        with suppress(OSError, ValueError, RecursionError):
            job = json.loads(path.read_text(), parse_constant=_refuse)
            if _is_job(job, path.parent.name):
                jobs.append(job)
    return sorted(jobs, key=lambda job: int(job["id"].partition("-")[0]))[-MAX_KEPT:]


def _refuse(name: str) -> None:
    """Raise ValueError for a number that JSON of a page does not have, as NaN."""
    raise ValueError(f"{name} is no number")


def _is_job(job: Any, name: str) -> bool:
    """True for the state of a job, as a server writes it into the folder of this name."""
    kinds = {"verb": str, "state": str, "values": dict, "lines": list, "files": list, "begun": float}
    is_of_folder = isinstance(job, dict) and job.get("id") == name and re.fullmatch(r"\d{1,6}-[a-z-]{1,40}", name)
    return bool(is_of_folder) and all(isinstance(job.get(key), kind) for key, kind in kinds.items())
