"""The verb `docs`: the documentation, and the guide for coding agents, without a network."""

from __future__ import annotations

import webbrowser
from pathlib import Path

import pytest
import strainwave as sw
from strainwave.commands import docs

from tests.python.command import refused, strainwave


@pytest.fixture
def opened(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """Put pages into the package, and return what the browser is asked to open."""
    for name in ("index.html", "search.html", "how-to/identify.html", "reference/identify.html"):
        page = tmp_path / "package" / "docs" / name
        page.parent.mkdir(parents=True, exist_ok=True)
        page.touch()
    addresses: list[str] = []
    monkeypatch.setattr(docs, "_package", lambda: tmp_path / "package")
    monkeypatch.setattr(webbrowser, "open", lambda address: addresses.append(address) is None)
    return addresses


@pytest.mark.parametrize(
    ("words", "address"),
    [
        ((), "index.html"),
        (("identify",), "how-to/identify.html"),
        (("how-to/identify.html",), "how-to/identify.html"),
        (("reference/identify",), "reference/identify.html"),
        (("lost motion*",), "search.html?q=lost%20motion%2A"),
    ],
)
def test_a_page_is_opened_or_a_word_searched_for(
    words: tuple[str, ...], address: str, opened: list[str], tmp_path: Path
) -> None:
    result = strainwave("docs", *words, folder=tmp_path)
    assert (result.returncode, result.stdout, result.stderr) == (0, "", "")
    assert opened == [f"{(tmp_path / 'package' / 'docs').as_uri()}/{address}"]


def test_the_path_of_a_page_is_printed(opened: list[str], tmp_path: Path) -> None:
    result = strainwave("docs", "--path", "identify", folder=tmp_path)
    assert result.stdout == f"{tmp_path}/package/docs/how-to/identify.html\n"
    assert opened == []


def test_without_a_browser_the_address_is_named(opened: list[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(webbrowser, "open", lambda address: False)
    refused(tmp_path, ["docs"], "there is no browser; open file://", "index.html")


def test_a_clone_has_what_it_built(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(docs, "_package", lambda: tmp_path / "python" / "strainwave")
    refused(tmp_path, ["docs"], "the documentation is not installed", "python3 dev.py docs")
    for page in (tmp_path / "docs" / "index.md", tmp_path / "out" / "docs" / "index.html"):
        page.parent.mkdir(parents=True)
        page.touch()
        assert strainwave("docs", "--path", folder=tmp_path).stdout == f"{page}\n"


def test_a_clone_that_built_nothing_has_the_sources_and_says_how_to_build(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(docs, "_package", lambda: tmp_path / "python" / "strainwave")
    (page := tmp_path / "docs" / "how-to" / "fit.md").parent.mkdir(parents=True)
    page.touch()
    (tmp_path / "docs" / "index.md").touch()
    shown = strainwave("docs", "--path", "fit", folder=tmp_path)
    assert (shown.stdout, "python3 dev.py docs" in shown.stderr) == (f"{page}\n", True)
    refused(tmp_path, ["docs", "friction"], 'no page of this clone is named "friction"', "python3 dev.py docs")


def test_the_guide_for_coding_agents_is_plain_text(tmp_path: Path) -> None:
    result = strainwave("docs", "--agents", folder=tmp_path)
    assert result.stdout == Path(sw.__file__).with_name("AGENTS.md").read_text()
    assert len(result.stdout.splitlines()) <= 120
