"""The studio over its application: what it serves and refuses, files of strangers, jobs, and a later server."""

from __future__ import annotations

import asyncio
import json
import subprocess
import sys
from collections.abc import AsyncIterator, Iterator, Mapping
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import strainwave as sw
import typer
from strainwave.commands.cli import app
from strainwave.commands.studio import _verbs
from strainwave.operating_system import locked_folder
from strainwave.studio.forms import forms
from strainwave.studio.serve import serve
from strainwave.studio.workspace import Workspace
from strainwave.workbench.page import is_installed

pytest.importorskip("starlette")
pytest.importorskip("httpx2")
from starlette.testclient import TestClient
from starlette.websockets import WebSocketDisconnect
from strainwave.studio.server import Studio, application

HOST = "127.0.0.1:8765"
TOKEN = "a-token"
SOCKET = f"ws://{HOST}/{TOKEN}/live"
FORMS = forms(_verbs(typer.main.get_command(app)))
needs_page = pytest.mark.skipif(not is_installed(), reason="python3 dev.py workbench builds the page")
pytestmark = needs_page


class Page:
    """A browser's page of a studio."""

    def __init__(self, studio: Studio, client: TestClient) -> None:
        self.studio, self.client = studio, client
        self._socket: Any = None

    def __enter__(self) -> Page:
        self._socket = self.client.websocket_connect(SOCKET, headers={"origin": f"http://{HOST}", "host": HOST})
        self._socket.__enter__()
        return self

    def __exit__(self, *raised: Any) -> None:
        self._socket.__exit__(*raised)

    def ask(self, **message: Any) -> None:
        self._socket.send_text(json.dumps(message))

    def told(self, key: str) -> Any:
        """Return the next thing of a kind that the page is told."""
        while True:
            message = json.loads(self._socket.receive_text())
            if "problem" in message and key != "problem":
                raise ValueError(message["problem"])
            if key in message:
                return message[key]

    def run(self, verb: str, **values: Any) -> dict[str, Any]:
        """Return a job after its end."""
        self.ask(do="start", name=verb, values=values)
        name = self.told("started")
        while True:
            job: dict[str, Any] = self.told("job")
            if job["id"] == name and job["state"] not in ("waiting", "running"):
                return job

    def put(self, name: str, content: bytes, **headers: str) -> Any:
        return self.client.put(f"files/{name}", content=content, headers={"origin": f"http://{HOST}", **headers})


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    return tmp_path / "studio"


def opened(folder: Path, *paths: Path) -> Iterator[Page]:
    studio = Studio(Workspace(folder, paths), FORMS, None)
    inner = application(studio, TOKEN, frozenset({HOST}))
    with TestClient(inner, f"http://{HOST}/{TOKEN}/") as client, Page(studio, client) as page:
        yield page


@pytest.fixture
def page(folder: Path) -> Iterator[Page]:
    yield from opened(folder)


def friction_table(**columns: Any) -> bytes:
    speed = np.array([2.0, 5.0, 10.0, 20.0, 50.0, 100.0, 200.0])
    torque = 0.05 + 3e-4 * speed + 1e-4 * np.array([1, -1, 0, 1, -1, 1, 0])
    rows = [f"{a:g};{b:.6f}" for a, b in zip(speed, torque, strict=True)]
    return "\n".join(["Drehzahl [rad/s];Reibmoment [N.m]", *rows, ""]).encode()


# ---- Who is served ---------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("path", "headers"),
    [
        (f"/{TOKEN}x/", {}),
        ("/", {}),
        (f"/{TOKEN}/", {"host": "example.com"}),
        (f"/{TOKEN}/", {"host": "127.0.0.1"}),
        (f"/{TOKEN}/", {"origin": "http://example.com"}),
        (f"/{TOKEN}/results/1-identify/report.html", {"origin": "null"}),
    ],
)
def test_whoever_lacks_the_token_or_comes_from_elsewhere_is_refused(page: Page, path: str, headers: dict[str, str]) -> None:
    answer = page.client.get(f"http://{HOST}{path}", headers=headers)
    assert answer.status_code == 403
    assert "strainwave" in answer.text or "another page" in answer.text


@pytest.mark.parametrize(
    "headers", [{"origin": "http://example.com", "host": HOST}, {"host": HOST}, {"origin": f"http://{HOST}", "host": "evil"}]
)
def test_a_socket_of_another_page_is_refused(page: Page, headers: dict[str, str]) -> None:
    with pytest.raises(WebSocketDisconnect), page.client.websocket_connect(SOCKET, headers=headers):
        pass


def test_the_page_runs_scripts_of_the_server_alone(page: Page) -> None:
    answer = page.client.get("./")
    policy = answer.headers["content-security-policy"]
    assert "script-src 'self' 'wasm-unsafe-eval';" in policy
    assert "unsafe-inline" not in policy
    assert "<style>" not in answer.text
    assert [
        line for line in answer.text.split("<script")[1:] if not line.startswith((' src="asset/', ' type="application/json"'))
    ] == []
    assert page.client.get("asset/studio.js").headers["content-type"].startswith("text/javascript")


# ---- Files of strangers ----------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "name", ["..%2Ftoken", "%2Fetc%2Fpasswd", ".hidden", "a%2Fb.csv", "a%00b.csv", "x" * 200, "a%5Cb.csv", "%0Aa.csv"]
)
def test_a_name_that_is_none_of_a_file_is_refused(page: Page, folder: Path, name: str) -> None:
    assert page.put(name, b"1").status_code in (400, 404)
    assert list((folder / "uploads").iterdir()) == []


def test_a_file_that_is_too_large_leaves_nothing(page: Page, folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("strainwave.studio.workspace.MAX_UPLOAD", 1000)
    answer = page.put("large.csv", b"1\n" * 1000)
    assert answer.status_code == 400
    assert "too large" in answer.json()["problem"]
    assert list((folder / "uploads").iterdir()) == []


def test_a_second_file_of_a_name_gets_another(page: Page) -> None:
    assert [page.put("run.csv", b"1\n").json()["name"] for _ in range(2)] == ["run.csv", "run-2.csv"]


@pytest.mark.parametrize("path", ["../../token", "..%2f..%2ftoken", "/etc/passwd", "missing"])
def test_results_outside_a_job_are_not_served(page: Page, folder: Path, path: str) -> None:
    page.studio.workspace.token()
    (folder / "results" / "1-identify").mkdir()
    answer = page.client.get(f"results/1-identify/{path}")
    assert answer.status_code in (403, 404)
    assert page.studio.workspace.token() not in answer.text


@pytest.mark.parametrize(
    ("verb", "values"),
    [
        ("identify", {"gear": "/etc/passwd", "paths": ["table.csv"]}),
        ("identify", {"gear": "hfuc-20-80", "paths": ["/etc/passwd"]}),
        ("identify", {"gear": "hfuc-20-80", "paths": ["../token"]}),
        ("identify", {"gear": "hfuc-20-80", "paths": ["table.csv"], "out": "/tmp/elsewhere"}),
        ("identify", {"gear": "hfuc-20-80", "paths": ["table.csv"], "mapping": "/etc/passwd"}),
        ("identify", {"gear": "hfuc-20-80", "paths": ["table.csv"], "side": ["input", "output"]}),
        ("identify", {"gear": "hfuc-20-80", "paths": [{"path": "table.csv"}]}),
        ("identify", {"gear": "hfuc-20-80"}),
        ("export firmware", {"drive": "robot-joint"}),
        ("compare", {"first": "--help", "second": "hfuc-20-80"}),
        ("diagnose joint", {"paths": ["table.csv"], "gear": "../../gear.toml"}),
    ],
)
def test_a_form_names_files_of_the_studio_alone(page: Page, verb: str, values: dict[str, Any]) -> None:
    page.put("table.csv", friction_table())
    page.ask(do="start", name=verb, values=values)
    assert page.told("problem")
    assert page.studio.jobs.jobs == {}


def test_no_value_of_a_form_becomes_another_word_of_the_command_line() -> None:
    form = FORMS["identify"]
    words = form.words_of(
        {"gear": "hfuc-20-80", "paths": ["-a.csv"], "joint": "--accept", "column": ["-x=y", "b=c --out /tmp"]},
        Path,
        Path("out"),
    )
    assert words == [
        "identify",
        "--column=-x=y",
        "--column=b=c --out /tmp",
        "--joint=--accept",
        "--out=out",
        "--",
        "hfuc-20-80",
        "-a.csv",
    ]


@pytest.mark.parametrize("message", ["", "[]", "{}", '{"do": 3}', '{"do": "start", "values": []}', "9" * 5000])
def test_a_page_of_another_kind_loses_its_socket_and_no_other_does(page: Page, message: str) -> None:
    with Page(page.studio, page.client) as stranger:
        stranger._socket.send_text(message)
    page.ask(do="spectrum", values={"drive": "no such drive", "moved": {}, "record": {}, "combine": "mean"})
    assert "no such drive" in page.told("problem")


# ---- Jobs ------------------------------------------------------------------------------------------------------------


@pytest.mark.slow("report")
def test_a_dropped_table_becomes_a_gear_that_the_page_opens(page: Page) -> None:
    page.put("table.csv", friction_table())
    page.ask(do="read", values={"paths": ["table.csv"], "side": "input"})
    (reading,) = page.told("read")
    assert (reading["kind"], reading["side"], reading["rows"]) == ("a table of steady friction", "input", 7)
    assert [(each["column"], each["channel"], each["unit"]) for each in reading["columns"]] == [
        ("Drehzahl", "speed", "rad/s"),
        ("Reibmoment", "torque", "N.m"),
    ]
    job = page.run("identify", gear="hfuc-20-80", paths=["table.csv"], side="input")
    assert job["state"] == "done"
    assert "coulomb" in "\n".join(job["lines"])
    assert {"report.html", "gear.toml", "results.json"} <= {*job["files"]}
    report = page.client.get(f"results/{job['id']}/report.html")
    assert "sandbox" in report.headers["content-security-policy"]
    assert "script-src" not in report.headers["content-security-policy"]
    page.ask(do="gear", values={"name": f"{job['id']}/gear.toml"})
    gear = page.told("gear")
    assert gear["drive"]["gear"]["friction_input"]["coulomb"] == pytest.approx(0.05, rel=5e-3)
    assert gear["sources"]["gear.friction_input.coulomb"][2] > 0.0  # its standard deviation


@pytest.mark.slow("report")
def test_a_question_comes_with_answers_that_fill_the_form(page: Page) -> None:
    rows = [f"{np.sin(0.05 * row):.6f};{np.cos(0.05 * row):.6f}" for row in range(400)]
    page.put("log.csv", "\n".join(["motor position [rad];motor current [A]", *rows, ""]).encode())
    job = page.run("identify", gear="hfuc-20-80", paths=["log.csv"])
    assert job["state"] == "asked"
    assert "log.csv" in job["question"]["text"]
    answer = job["question"]["answers"][0]
    assert (answer["options"], list(answer["numbers"])) == ([["constant", "rate=NUMBER"]], ["rate"])


@pytest.mark.slow("report")
def test_a_job_is_cancelled_and_its_process_ends(page: Page) -> None:
    page.ask(do="start", name="compensate", values={"drive": "robot-joint", "members": "500"})
    name = page.told("started")
    while page.told("job")["state"] != "running":
        pass
    page.ask(do="cancel", name=name)
    while (job := page.told("job"))["state"] == "running":
        pass
    assert job["state"] == "cancelled"
    assert job["files"] == []


@pytest.mark.slow("report")
def test_a_job_that_the_end_of_a_server_interrupted_is_listed_by_the_next(folder: Path) -> None:
    for first in opened(folder):
        first.put("table.csv", friction_table())
        first.ask(do="start", name="identify", values={"gear": "hfuc-20-80", "paths": ["table.csv"], "side": "input"})
        name = first.told("started")
        token = first.studio.workspace.token()
    state = folder / "results" / name / "job.json"
    assert json.loads(state.read_text())["state"] == "interrupted"
    state.write_text(json.dumps(json.loads(state.read_text()) | {"state": "running"}))  # as a killed server leaves it
    for second in opened(folder):
        jobs = {job["id"]: job for job in second.told("jobs")}
        assert jobs[name]["state"] == "interrupted"
        assert jobs[name]["values"]["paths"] == ["table.csv"]
        assert second.studio.workspace.token() == token
        assert "table.csv" in second.studio.workspace.files


@pytest.mark.slow("report")
def test_a_job_ends_with_its_server_however_that_ends(tmp_path: Path) -> None:
    words = ("-m", "strainwave.commands.job", "compensate", "--members=500", f"--out={tmp_path}", "--", "robot-joint")
    with subprocess.Popen(
        (sys.executable, *words), stdin=subprocess.PIPE, stdout=subprocess.PIPE, start_new_session=True
    ) as process:
        assert process.stdout is not None
        assert process.stdout.readline()
        assert process.stdin is not None
        process.stdin.close()
        assert process.wait(60) != 0
    assert list(tmp_path.iterdir()) == []


def test_links_out_of_the_folder_are_not_followed(page: Page, folder: Path, tmp_path: Path) -> None:
    secret = tmp_path / "secret.csv"
    secret.write_text("of another folder\n")
    (folder / "uploads" / "link.csv").symlink_to(secret)
    (folder / "results" / "7-identify").symlink_to(tmp_path)
    assert page.studio.workspace.files == {}
    assert page.client.get("results/7-identify/secret.csv").status_code == 404


@pytest.mark.parametrize(
    "text",
    [
        '{"id": "7-identify"}',
        '{"id": "x"}',
        "[" * 100_000,
        '{"id": "7-identify", "verb": "x", "state": "done", "values": {}, "lines": [], "files": [], "begun": NaN}',
    ],
)
def test_a_state_that_no_server_wrote_is_not_listed(folder: Path, text: str) -> None:
    (folder / "results" / "7-identify").mkdir(parents=True)
    (folder / "results" / "7-identify" / "job.json").write_text(text)
    for page in opened(folder):
        assert page.told("jobs") == []


def test_an_empty_token_is_replaced_and_a_folder_has_one_studio(folder: Path) -> None:
    folder.mkdir()
    (folder / "token").write_text("")
    assert len(Workspace(folder).token()) == 32
    with locked_folder(folder, wait=False):
        arguments = {"folder": folder, "host": "127.0.0.1", "port": 0, "browser": False}
        with pytest.raises(BlockingIOError, match="another studio"):
            serve([], [], **arguments)


@pytest.mark.parametrize(("host", "port", "words"), [("0.0.0.0", 0, "stands for every"), ("127.0.0.1", 70000, "is no port")])
def test_what_cannot_be_served_is_refused(folder: Path, host: str, port: int, words: str) -> None:
    with pytest.raises(ValueError, match=words):
        serve([], [], folder=folder, host=host, port=port, browser=False)


def test_uploads_of_one_name_at_the_same_time_are_both_kept(folder: Path) -> None:
    workspace = Workspace(folder)

    async def content(text: bytes, begin: asyncio.Event, wait: asyncio.Event) -> AsyncIterator[bytes]:
        begin.set()
        await wait.wait()
        yield text

    async def both() -> list[str]:
        first, second = asyncio.Event(), asyncio.Event()
        one = workspace.upload("run.csv", content(b"one", first, second))
        other = workspace.upload("RUN.csv", content(b"other", second, first))
        return list(await asyncio.gather(one, other))

    names = asyncio.run(both())
    assert names == ["run.csv", "RUN-2.csv"]
    assert [(folder / "uploads" / name).read_bytes() for name in names] == [b"one", b"other"]


def test_a_page_removes_what_was_uploaded_and_nothing_else(folder: Path, tmp_path: Path) -> None:
    kept = tmp_path / "kept.csv"
    kept.write_bytes(friction_table())
    for page in opened(folder, kept):
        page.put("table.csv", friction_table())
        codes = [
            page.client.delete(f"files/{name}", headers={"origin": f"http://{HOST}"}).status_code
            for name in ("table.csv", "kept.csv", "missing.csv")
        ]
        assert codes == [204, 400, 400]
        assert list(page.studio.workspace.files) == ["kept.csv"]
    assert kept.exists()


def test_two_pages_see_the_same_files(page: Page) -> None:
    page.put("table.csv", friction_table())
    with Page(page.studio, page.client) as other:
        assert other.told("files") == ["table.csv"]
        page.put("more.csv", friction_table())
        assert other.told("files") == ["more.csv", "table.csv"]


# ---- Forms -----------------------------------------------------------------------------------------------------------


def test_every_field_is_one_of_its_verb_and_says_what_it_means() -> None:
    kinds = {(verb, field.name): field.kind for verb, form in FORMS.items() for field in form.fields}
    assert all(field.help for form in FORMS.values() for field in form.fields)
    assert kinds["identify", "paths"] == "files"
    assert kinds["identify", "gear"] == kinds["diagnose joint", "gear"] == kinds["compare", "second"] == "set"
    assert kinds["diagnose joint", "geometry"] == "flag"
    assert kinds["compensate", "period"] == "number"
    assert kinds["compensate", "members"] == "whole"
    assert kinds["identify", "column"] == "text"


def test_a_live_spectrum_is_that_of_the_package(page: Page) -> None:
    from strainwave.studio.fault_spectrum import fault_spectrum

    record: Mapping[str, float] = {"speed": 30.0, "load_torque": 0.0, "duration": 1.0, "rate": 500.0, "noise": 0.02}
    moved = {"housing_eccentricity": 2e-5}
    page.ask(do="spectrum", values={"drive": "tilt-actuator-lumped", "moved": moved, "record": record, "combine": "single"})
    assert page.told("spectrum") == fault_spectrum(sw.load("tilt-actuator-lumped"), moved, record, "single")
