"""Jobs of a studio: verbs of the command, each in a process of its own, with its progress, questions and results."""

from __future__ import annotations

import asyncio
import json
import sys
import time
from collections.abc import AsyncIterator, Callable, Mapping
from contextlib import suppress
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
        self._running = asyncio.Semaphore(MAX_RUNNING)
        self._tasks: dict[str, asyncio.Task[None]] = {}
        self._is_closing = False
        self.jobs = {job["id"]: job for job in _earlier(workspace.results)}
        for job in self.jobs.values():
            if job["state"] in ("waiting", "running"):
                self._tell(job, "interrupted")

    def start(self, verb: str, values: Mapping[str, Any]) -> str:
        """Start a verb with a form that was filled in. Return the name of the job.

        Raises:
            ValueError: the verb, or a field of the form, is not one that is taken; or too many jobs wait
        """
        if (form := self._forms.get(verb)) is None:
            raise ValueError(f"there is no form of {verb!r}"[:200])
        if len(self._tasks) >= MAX_WAITING:
            raise ValueError(f"{len(self._tasks)} jobs wait; cancel some")
        number = 1 + max((int(name.partition("-")[0]) for name in self.jobs), default=0)
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
        self._tell(job, "waiting")
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
        known = ("paths", "column", "unit", "constant", "side", "joint", "kind", "gear")
        form = self._forms["identify"]
        words = form.words_of(
            {"gear": "hfuc-20-80"} | {name: values[name] for name in known if name in values}, self._workspace.path_of, Path()
        )
        end = words.index("--")
        found: list[dict[str, Any]] = []
        async with self._running:
            async for event in self._events(["read", *words[1:end], "--", *words[end + 2 :]]):
                found = event.get("readings", found)
        return found

    async def _events(self, words: list[str]) -> AsyncIterator[dict[str, Any]]:
        """Yield what the process of a verb reports, files by their names on the page, and at last its exit code."""
        process = await asyncio.create_subprocess_exec(
            *(sys.executable, *RUNS_VERB, *words),
            stdin=asyncio.subprocess.PIPE,  # whose end tells the process that this server has ended
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
                kill_group(process.pid)
                await process.wait()

    async def _run(self, job: dict[str, Any], words: list[str]) -> None:
        begun, state = time.monotonic(), "failed"
        try:
            async with self._running:
                self._tell(job, "running")
                async for event in self._events(words):
                    if "code" in event:
                        state = "asked" if "question" in job else STATES.get(event["code"], "failed")
                    else:
                        self._take(job, event)
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
            self._tell(job, state)

    def _take(self, job: dict[str, Any], event: dict[str, Any]) -> None:
        """Take over what a process reports."""
        if "line" not in event:
            job |= {name: event[name] for name in ("stage", "share", "question") if name in event}
        elif len(job["lines"]) < MAX_LINES:
            job["lines"].append(str(event["line"]))
        self._tell(job)

    def _tell(self, job: dict[str, Any], state: str | None = None) -> None:
        """Report a job, and write it if its state is another one."""
        if state is not None:
            job["state"] = state
            with suppress(OSError), replacing(self._workspace.results / job["id"] / STATE_FILE) as file:
                file.write(json.dumps(job).encode())
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
    found = []
    for path in results.glob(f"*/{STATE_FILE}"):
        with suppress(OSError, ValueError):
            job = json.loads(path.read_text())
            if isinstance(job, dict) and job.get("id") == path.parent.name:
                found.append(job)
    return sorted(found, key=lambda job: int(job["id"].partition("-")[0]))[-MAX_KEPT:]
