"""JSON from strangers: integers of any length, keys without end and depth end in one line or in numbers."""

from __future__ import annotations

import json
import re
from pathlib import Path

import numpy as np
import pytest
from strainwave.files.json_table import open_json

HUGE = "1" + 400 * "0"
LONG = "1" + 5000 * "0"


def refused(path: Path, text: str, reason: str) -> None:
    path.write_text(text)
    with pytest.raises(ValueError, match=f"^{re.escape(str(path))}[^\n]*{reason}[^\n]*$"):
        open_json(path)


@pytest.mark.parametrize(
    ("text", "reason"),
    [
        (f'{{"t": [0, 1], "q": [1.0, {HUGE}]}}', "q has an integer beyond the largest number, 1.8e308"),
        (f'{{"arm": {{"q": [[1.0, -{HUGE}]]}}}}', "arm.q has an integer beyond"),
        (f"[1, {HUGE}]", "its list has an integer beyond"),
        (f'{{"t": {HUGE}}}', "t has an integer beyond"),
        (f'[{{"q": 1.0}}, {{"q": {HUGE}}}]', "q in row 1 is an integer of 401 digits"),
        (f'{{"q": [1.0,\n {LONG}]}}', "line 2 has an integer of more than 4300 digits"),
        (f'{{"q": 1}}\n{{"q": 2}}\n{{"q": {LONG}}}\n', "line 3 has an integer of more than 4300 digits"),
    ],
)
def test_integers_beyond_all_numbers(tmp_path: Path, text: str, reason: str) -> None:
    refused(tmp_path / "a.json", text, reason)


def test_a_key_for_each_row_is_refused_by_what_it_takes(tmp_path: Path) -> None:
    rows = [{f"k{row}": row} for row in range(20_000)]
    refused(tmp_path / "a.json", json.dumps(rows), "a column for each name in its rows expands the file to")


def test_names_that_a_long_key_makes(tmp_path: Path) -> None:
    key = "k" * 100_000
    rows = [{key: [0.0] * 10_000}] * 2
    refused(tmp_path / "a.json", json.dumps(rows), "expands the file to")


def test_rows_whose_keys_differ(tmp_path: Path) -> None:
    rows = [{"t": 0, "q": [1.5]}, {"t": 1, "mode": "run", "u": None}, {"q": [2.5, 3.5], "t": 2}, {"t": 3, "q_1": 4, "q": [5.0]}]
    (tmp_path / "a.json").write_text(json.dumps(rows))
    found = open_json(tmp_path / "a.json")
    nan = np.nan
    expected = {"t": [0, 1, 2, 3], "q_1": [1.5, nan, 2.5, 5.0], "u": [nan] * 4, "q_2": [nan, nan, 3.5, nan]}
    for label, values in zip(found.labels, found.columns, strict=True):
        assert np.array_equal(values, expected.pop(label.name), equal_nan=True)
    assert not expected


@pytest.mark.parametrize("depth", [900, 100_000])
@pytest.mark.parametrize("mark", ["[]", '{"a":}'])
def test_depth_ends_in_one_line(tmp_path: Path, depth: int, mark: str) -> None:
    text = mark[:-1] * depth + "1" + mark[-1] * depth
    for whole in (text, f'[{{"q": {text}}}, {{"q": {text}}}]'):
        refused(tmp_path / "a.json", whole, "")


@pytest.mark.parametrize("cell", ['"١٢"', '"0.1"', '"nan"', '"1_0"'])
def test_texts_are_no_numbers(tmp_path: Path, cell: str) -> None:
    refused(tmp_path / "a.json", f'{{"q": [{cell}, {cell}]}}', "holds no series of numbers")
    refused(tmp_path / "a.json", f'{{"q": [[{cell}, 1.0], [null, 2.0]]}}', "holds no series of numbers")


def test_a_long_text_among_numbers_takes_no_memory(tmp_path: Path) -> None:
    (tmp_path / "a.json").write_text(json.dumps({"t": [0.0] * 1000, "q": [0.0] * 1000 + ["x" * 1_000_000]}))
    assert [label.name for label in open_json(tmp_path / "a.json").labels] == ["t"]
