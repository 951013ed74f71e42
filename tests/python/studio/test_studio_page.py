"""A studio in a browser: a table becomes a gear, and a server that ends loses nothing."""

from __future__ import annotations

import re
import socket
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import pytest
from strainwave.workbench.page import is_installed

from tests.python.workbench.test_page import browser  # noqa: F401 - a fixture

pytest.importorskip("starlette")
pytestmark = [
    pytest.mark.slow("report"),
    pytest.mark.skipif(not is_installed(), reason="python3 dev.py workbench builds the page"),
]

TABLE = "speed [rad/s];torque [N.m]\n" + "".join(
    f"{speed};{0.05 + 3e-4 * speed + place % 2 * 1e-4:.6f}\n" for place, speed in enumerate((2, 5, 10, 20, 50, 100, 200))
)


@contextmanager
def served(folder: Path, port: int) -> Iterator[str]:
    """A server of a studio in a process of its own; gives its address."""
    words = (sys.executable, "-m", "strainwave", "studio", "--no-browser", "--port", str(port), "--out", "studio")
    with subprocess.Popen(words, cwd=folder, stderr=subprocess.PIPE, text=True) as process:
        assert process.stderr is not None
        try:
            address = re.search(r"http://\S+", process.stderr.readline())
            assert address
            yield address[0]
        finally:
            process.kill()


@pytest.fixture
def port() -> int:
    with socket.create_server(("127.0.0.1", 0)) as free:
        return int(free.getsockname()[1])


def test_a_table_becomes_a_gear_and_a_killed_server_loses_nothing(browser: Any, tmp_path: Path, port: int) -> None:  # noqa: F811
    table = tmp_path / "table.csv"
    table.write_text(TABLE)
    tab = browser.new_page(viewport={"width": 1400, "height": 1000})
    with served(tmp_path, port) as address:
        tab.goto(address)
        tab.locator("nav button", has_text="Identify").click()
        tab.locator(".sheet:visible input[type=file]").set_input_files(str(table))
        tab.locator(".reading:visible").wait_for(timeout=60_000)
        assert "a table of steady friction" in tab.locator(".reading").inner_text()
        menu = tab.get_by_label("what torque is")
        assert menu.input_value() == "torque"
        tab.locator("#Identify-gear").fill("hfuc-20-80")
        tab.locator("#Identify-gear").blur()
    tab.locator(".connection.bad").wait_for()
    assert "does not answer" in tab.locator(".connection").inner_text()
    with served(tmp_path, port):
        tab.locator(".connection.bad").wait_for(state="detached", timeout=60_000)
        assert tab.locator("#Identify-gear").input_value() == "hfuc-20-80"
        tab.locator(".begin:visible").click()
        tab.locator(".job.done").wait_for(timeout=60_000)
        tab.get_by_role("button", name="Open gear.toml in the pages Gear and Drive").click()
        tab.locator("#field-gear\\.friction_input\\.coulomb").wait_for()
        assert float(tab.locator("#field-gear\\.friction_input\\.coulomb").input_value()) == pytest.approx(0.05, rel=5e-3)
    tab.close()
