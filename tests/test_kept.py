"""What tests compiled is compiled again if anything changes that it depends on, and only then."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.support import kept


def test_a_compilation_is_repeated_if_a_word_or_a_file_changes(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(kept, "KEPT", tmp_path / "kept")
    made = []

    def compiled(number: int, word: str = "-O1", source: str = "int x;", sources: bytes = b"headers") -> str:
        monkeypatch.setattr(kept, "_sources", lambda: sources)
        folder = tmp_path / f"{number}"
        folder.mkdir()
        (folder / "a.cpp").write_text(source)

        def make() -> kept.Result:
            made.append(number)
            (folder / "a.o").write_text(f"{word} {source} {sources!r}")
            return 1, "a warning"

        assert kept.kept(folder, ["c++", word, f"-I{folder}"], make) == (1, "a warning")
        return (folder / "a.o").read_text()

    first = compiled(0)
    assert compiled(1) == first
    assert made == [0]
    assert compiled(2, word="-O2") != first
    assert compiled(3, source="int y;") != first
    assert compiled(4, sources=b"other headers") != first
    assert made == [0, 2, 3, 4]
