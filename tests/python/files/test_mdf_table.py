"""MDF files: conversions by their definitions, formulas never evaluated, and claims that a file does not keep refused."""

from __future__ import annotations

import re
import struct
import zlib
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from strainwave import Recording
from strainwave.files import budget
from strainwave.files.array_table import Grid, GridTable, grid_table
from strainwave.files.labels import ColumnSource
from strainwave.files.mdf_channels import RecordLayout, records_of
from strainwave.files.mdf_table import open_mdf
from strainwave.files.tables import open_table
from strainwave.identification.reading.mapping import FileMapping
from strainwave.identification.reading.recognise import recognise

asammdf = pytest.importorskip("asammdf")

TIME = np.arange(20) * 0.01
RAW = np.arange(20.0)


def columns(table: GridTable) -> dict[str, list[float]]:
    return {name: values.tolist() for grid in table.grids for name, values in grid.columns.items()}


def save(path: Path, version: str, conversions: dict[str, Any], raw: Any = RAW, compression: int = 0) -> None:
    with asammdf.MDF(version=version) as file:
        file.append([asammdf.Signal(raw, TIME, name=name, conversion=each) for name, each in conversions.items()])
        saved = file.save(path, overwrite=True, compression=compression)
    Path(saved).rename(path)  # asammdf appends the suffix of the version


def patched(path: Path, kind: bytes, place: int, value: bytes, number: int = 0) -> None:
    """Write bytes into the content of a block of version 4, behind its links."""
    whole = bytearray(path.read_bytes())
    start = [match.start() for match in re.finditer(re.escape(kind), bytes(whole))][number]
    (links,) = struct.unpack_from("<Q", whole, start + 16)
    begin = start + 24 + 8 * links + place
    whole[begin : begin + len(value)] = value
    path.write_bytes(whole)


def linked(path: Path, kind: bytes, link: int, address: int, number: int = 0) -> None:
    """Write a link of a block of version 4."""
    whole = bytearray(path.read_bytes())
    start = [match.start() for match in re.finditer(re.escape(kind), bytes(whole))][number]
    struct.pack_into("<Q", whole, start + 24 + 8 * link, address)
    path.write_bytes(whole)


# Conversions, with numbers worked out by hand from the definitions of ASAM MDF


TABLE = {f"{part}_{place}": value for part, values in {"raw": (0.0, 10.0, 14.0), "phys": (1.0, 3.0, -1.0)}.items()
         for place, value in enumerate(values)}  # fmt: skip


@pytest.mark.parametrize("version", ["3.30", "4.10"])
@pytest.mark.parametrize(
    ("conversion", "expected"),
    [
        (None, {0: 0.0, 7: 7.0}),
        ({"a": 2.0, "b": -1.0}, {0: -1.0, 7: 13.0}),
        ({"P1": 1.0, "P2": 2.0, "P3": 3.0, "P4": 0.0, "P5": 1.0, "P6": 4.0}, {0: 0.75, 2: 11.0 / 6.0}),
        (TABLE | {"interpolation": True}, {0: 1.0, 5: 2.0, 12: 1.0, 19: -1.0}),
        (TABLE | {"interpolation": False}, {0: 1.0, 5: 1.0, 6: 3.0, 12: 3.0, 13: -1.0, 19: -1.0}),
    ],
)
def test_conversions_follow_their_definition(tmp_path: Path, version: str, conversion: Any, expected: dict[int, float]) -> None:
    path = tmp_path / "a.mf4"
    save(path, version, {"q": conversion})
    values = columns(open_mdf(path))["q"]
    assert {row: values[row] for row in expected} == pytest.approx(expected)


@pytest.mark.parametrize(("raw", "at_ends"), [(RAW, -3.0), (RAW.astype(np.int16), 5.0)])
def test_ranges_have_a_closed_end_for_integers_alone(tmp_path: Path, raw: Any, at_ends: float) -> None:
    ranges = {"lower_0": 2.0, "upper_0": 4.0, "phys_0": 5.0, "lower_1": 10.0, "upper_1": 12.0, "phys_1": 5.0, "default": -3.0}
    save(tmp_path / "a.mf4", "4.10", {"q": ranges}, raw)
    values = columns(open_mdf(tmp_path / "a.mf4"))["q"]
    assert values[:6] == [-3.0, -3.0, 5.0, 5.0, at_ends, -3.0]
    assert values[10:14] == [5.0, 5.0, at_ends, -3.0]


def mdf3(path: Path, kind: int, parameters: list[float]) -> None:
    """A file of version 3 whose channel has a conversion of any type."""
    save(path, "3.30", {"q": {"a": 2.0, "b": 0.0}})
    whole = bytearray(path.read_bytes())
    starts = [
        match.start() for match in re.finditer(b"CC", bytes(whole)) if whole[match.start() + 42 : match.start() + 44] == b"\0\0"
    ]
    (start,) = [place for place in starts if struct.unpack_from("<2d", whole, place + 46) == (0.0, 2.0)]
    content = struct.pack("<2H", kind, len(parameters)) + struct.pack(f"<{len(parameters)}d", *parameters)
    block = b"CC" + struct.pack("<H", 42 + len(content)) + bytes(whole[start + 4 : start + 42]) + content
    whole = whole.replace(struct.pack("<I", start), struct.pack("<I", len(whole))) + block
    path.write_bytes(whole)


@pytest.mark.parametrize(
    ("kind", "parameters", "expected"),
    [
        (6, [0.0, 6.0, 2.0, 1.0, 0.0, 1.0], lambda x: (6.0 - (x - 1.0)) / (2.0 * (x - 1.0))),
        (7, [2.0, 4.0, 1.0, 0.0, 0.0, 1.0, 0.0], lambda x: np.exp((x - 1.0) / 2.0) / 4.0),
        (8, [2.0, 4.0, 1.0, 0.0, 0.0, 1.0, 0.0], lambda x: np.log((x - 1.0) / 2.0) / 4.0),
        (8, [0.0, 0.0, 8.0, 2.0, 3.0, 0.0, 0.0], lambda x: np.log(8.0 / x / 2.0) / 3.0),
    ],
)
def test_conversions_that_version_3_alone_has(tmp_path: Path, kind: int, parameters: list[float], expected: Any) -> None:
    mdf3(tmp_path / "a.mdf", kind, parameters)
    rows = slice(3, 9)
    assert columns(open_mdf(tmp_path / "a.mdf"))["q"][rows] == pytest.approx(expected(RAW[rows]))


# Formulas


PROBE = 'f\'{{open("{}", "w")}}\''


@pytest.mark.parametrize("name", ["a.mf4", "a.mdf", "a.dat"])
@pytest.mark.parametrize("version", ["3.30", "4.10"])
def test_a_formula_is_never_evaluated_and_its_channel_is_named(tmp_path: Path, version: str, name: str) -> None:
    formula = PROBE.format(tmp_path / "made")
    save(tmp_path / name, version, {"q": None, "tau": {"formula": formula}})
    table = open_table(tmp_path / name)
    assert [label.name for label in table.labels] == ["time", "q"]
    values, remarks = table.measured([ColumnSource(1, "q", "q", "1")])
    assert values["q"].tolist() == RAW.tolist()
    (remark,) = remarks
    assert remark.startswith('tau is left out: its conversion is a formula, "f')
    with pytest.raises(ValueError, match=r'has no column "tau"; it has time, q; tau is left out: its conversion is a formula'):
        Recording.read(tmp_path / name, {"torque": "tau"})
    assert not (tmp_path / "made").exists()


def test_a_file_that_is_no_measurement_without_its_formula_names_the_channel(tmp_path: Path) -> None:
    save(tmp_path / "a.mf4", "4.10", {"q": None, "tau": {"formula": "X1*2"}})
    with pytest.raises(ValueError, match=r"a\.mf4: it has time, q, .*; tau is left out: its conversion is a formula"):
        recognise(tmp_path / "a.mf4", FileMapping(units={"q": "rad"}))


def test_a_file_of_formulas_alone_is_refused_by_their_names(tmp_path: Path) -> None:
    save(tmp_path / "a.mf4", "4.10", {"tau": {"formula": "X1*2"}})
    reason = 'a.mf4 holds no series of numbers; tau is left out: its conversion is a formula, "X1*2", which is not evaluated'
    with pytest.raises(ValueError, match=re.escape(reason)):
        open_mdf(tmp_path / "a.mf4")


def test_conversions_in_a_table_of_texts_are_applied_and_formulas_in_it_refused(tmp_path: Path) -> None:
    path = tmp_path / "a.mf4"
    texts = {"val_0": 0.0, "text_0": b"off", "val_1": 1.0, "text_1": b"error", "default": b"none"}
    save(path, "4.10", {"a": {"a": 2.0, "b": 0.5}, "b": {"formula": "X1*2"}, "q": texts})
    assert set(columns(open_mdf(path))) == {"a"}  # texts are no numbers
    whole = path.read_bytes()
    linear_at, formula_at, table_at = (
        next(
            m.start()
            for m in re.finditer(b"##CC", whole)
            if whole[m.start() + 24 + 8 * struct.unpack_from("<Q", whole, m.start() + 16)[0]] == kind
        )
        for kind in (1, 3, 7)
    )
    number = [match.start() for match in re.finditer(b"##CC", whole)].index(table_at)
    linked(path, b"##CC", 6, linear_at, number)  # of all other values
    values = np.array(columns(open_mdf(path))["q"])
    assert np.array_equal(values, np.where(RAW < 2.0, np.nan, 2.0 * RAW + 0.5), equal_nan=True)
    linked(path, b"##CC", 4, formula_at, number)  # of the value 0
    assert [each.partition(",")[0] for each in open_mdf(path).left_out] == [
        "b is left out: its conversion is a formula",
        "q is left out: its conversion is a formula",
    ]


def test_a_time_that_is_a_formula_leaves_out_its_group(tmp_path: Path) -> None:
    path = tmp_path / "a.mf4"
    save(path, "4.10", {"b": {"formula": "X1*2"}, "q": None})
    whole = path.read_bytes()
    formula_at = next(
        m.start()
        for m in re.finditer(b"##CC", whole)
        if whole[m.start() + 24 + 8 * struct.unpack_from("<Q", whole, m.start() + 16)[0]] == 3
    )
    channels = [match.start() for match in re.finditer(b"##CN", whole)]
    (master,) = [
        place
        for place, start in enumerate(channels)
        if whole[start + 24 + 8 * struct.unpack_from("<Q", whole, start + 16)[0]] == 2
    ]
    linked(path, b"##CN", 4, formula_at, master)
    with pytest.raises(ValueError, match="channel group 0 is left out: its conversion is a formula"):
        open_mdf(path)


# Claims and loops


def refused(path: Path, reason: str) -> None:
    with pytest.raises(ValueError, match=f"^{re.escape(str(path))}[^\n]*{reason}[^\n]*$"):
        open_mdf(path)


def test_more_records_than_there_are(tmp_path: Path) -> None:
    save(tmp_path / "a.mf4", "4.10", {"q": None})
    patched(tmp_path / "a.mf4", b"##CG", 8, struct.pack("<Q", 10**12))
    refused(tmp_path / "a.mf4", "claims 1000000000000 records, but its data contain 20")
    save(tmp_path / "a.mdf", "3.30", {"q": None})
    whole = bytearray((tmp_path / "a.mdf").read_bytes())
    start = whole.index(b"CG\x1a") if b"CG\x1a" in whole else whole.index(b"CG\x1e")
    struct.pack_into("<I", whole, start + 22, 2**31)
    (tmp_path / "a.mdf").write_bytes(whole)
    refused(tmp_path / "a.mdf", "claims records up to byte")


@pytest.mark.parametrize("claim", [None, 2**40])
def test_a_packed_block_that_expands_to_gigabytes(tmp_path: Path, claim: int | None) -> None:
    path = tmp_path / "a.mf4"
    save(path, "4.10", {"q": None}, compression=1)
    bomb = zlib.compress(bytes(2**20))
    size = struct.pack("<2Q", claim or 320, len(bomb))
    data = b"DT" + bytes([0, 0]) + bytes(4) + size + bomb
    block = b"##DZ" + bytes(4) + struct.pack("<2Q", 24 + len(data), 0) + data
    whole = path.read_bytes()
    path.write_bytes(whole + bytes(-len(whole) % 8) + block)
    linked(path, b"##DG", 2, len(whole) + -len(whole) % 8)
    refused(path, "expands the file to 1099512 MB" if claim else "does not have the 320 bytes that it claims")


@pytest.mark.parametrize(("kind", "link"), [(b"##DG", 0), (b"##CG", 0), (b"##CN", 0), (b"##CN", 1)])
def test_blocks_that_refer_to_themselves(tmp_path: Path, kind: bytes, link: int) -> None:
    path = tmp_path / "a.mf4"
    save(path, "4.10", {"q": None})
    linked(path, kind, link, path.read_bytes().index(kind))
    refused(path, "refers twice to the block at byte")


def test_a_list_of_data_that_refers_to_itself(tmp_path: Path) -> None:
    path = tmp_path / "a.mf4"
    save(path, "4.10", {"q": None})
    whole = path.read_bytes()
    here = len(whole) + -len(whole) % 8
    path.write_bytes(
        whole.ljust(here, b"\0")
        + b"##DL"
        + bytes(4)
        + struct.pack("<2Q", 48, 2)
        + struct.pack("<2Q", here, whole.index(b"##DT"))
        + struct.pack("<2I", 0, 1)
    )
    linked(path, b"##DG", 2, here)
    refused(path, "refers twice to the block at byte")


def test_a_conversion_that_contains_itself(tmp_path: Path) -> None:
    path = tmp_path / "a.mf4"
    save(path, "4.10", {"q": {"val_0": 0.0, "text_0": b"off", "val_1": 1.0, "text_1": b"on", "default": b"none"}})
    start = path.read_bytes().index(b"##CC")
    for link in (4, 5, 6):
        linked(path, b"##CC", link, start)
    refused(path, "nests structures more than 64 deep")


def test_a_conversion_is_counted_for_each_channel_that_refers_to_it(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Each applies all of it: 4000 channels with one table of 1000 conversions took 40 s."""
    path = tmp_path / "a.mf4"
    pieces = {f"val_{place}": place for place in range(20)} | {f"text_{place}": {"a": 2.0, "b": 0.0} for place in range(20)}
    save(path, "4.10", {name: {**pieces, "default": b"none"} for name in ("q", "r")})
    whole = path.read_bytes()
    (first,) = {struct.unpack_from("<Q", whole, each.start() + 24 + 32)[0] for each in re.finditer(b"##CN", whole)} - {0}
    monkeypatch.setattr(budget, "MAX_NODES", 40)
    assert whole[first : first + 4] == b"##CC"
    refused(path, "has more than 40 variables")


def test_each_unsorted_record_is_counted(monkeypatch: pytest.MonkeyPatch) -> None:
    """Many groups may refer to the same data, and sort it anew."""
    layouts = {1: RecordLayout(1, 0), 2: RecordLayout(0, 0)}
    assert len(records_of(np.ones(100, np.uint8), layouts, 1, budget.ReadBudget(0))[1]) == 1
    monkeypatch.setattr(budget, "MIN_ALLOWED_BYTES", 1000)
    with pytest.raises(budget.RefusedFile, match="sorting its records expands the file"):
        records_of(np.ones(100, np.uint8), layouts, 1, budget.ReadBudget(0))


def test_a_name_without_end(tmp_path: Path) -> None:
    save(tmp_path / "a.mf4", "4.10", {1001 * "q": None})
    refused(tmp_path / "a.mf4", "has a column .* of 1001 characters; a name has at most 1000")


def test_names_that_come_again_carry_the_number_of_their_group(tmp_path: Path) -> None:
    path = tmp_path / "a.mf4"
    with asammdf.MDF(version="4.10") as file:
        for _ in range(2):
            file.append([asammdf.Signal(RAW, TIME, name="q") for _ in range(3)])
        file.save(path, overwrite=True)
    assert list(columns(open_mdf(path))) == ["q", "q.0", "q.0.1", "q.1", "q.1.1", "q.1.2"]


def test_a_channel_called_time_is_not_the_time(tmp_path: Path) -> None:
    save(tmp_path / "a.mf4", "4.10", {"time": None, "q": None})
    table = open_mdf(tmp_path / "a.mf4")
    assert [label.name for label in table.labels] == ["time", "time.0", "q"]
    found, _ = table.measured([ColumnSource(place, name, name, "1") for place, name in enumerate(("time", "clock", "q"))])
    assert {name: values.tolist() for name, values in found.items()} == {
        "time": TIME.tolist(), "clock": RAW.tolist(), "q": RAW.tolist(),
    }  # fmt: skip
    shared = grid_table("run.mcap", "", [Grid(TIME, {"time": RAW})], {})  # as of a topic /time
    assert shared.numbers([ColumnSource(0, "time", "time", "s")])["time"].tolist() == TIME.tolist()
    assert shared.numbers([ColumnSource(1, "time", "clock", "s")])["clock"].tolist() == RAW.tolist()


def test_a_channel_outside_of_its_record(tmp_path: Path) -> None:
    path = tmp_path / "a.mf4"
    save(path, "4.10", {"q": None})
    for number in range(2):
        patched(path, b"##CN", 4, struct.pack("<I", 2**31), number)
    refused(path, "lies outside its record of 16 bytes")


def test_a_file_that_is_still_recorded(tmp_path: Path) -> None:
    (tmp_path / "a.dat").write_bytes(b"UnFinMF 4.10    ".ljust(300, b"\0"))
    with pytest.raises(ValueError, match=r"was not closed by its recorder \(UnFinMF\)"):
        open_table(tmp_path / "a.dat")


# Layouts that asammdf does not write


def block(kind: bytes, links: list[int], content: bytes) -> bytes:
    return (
        b"##"
        + kind
        + bytes(4)
        + struct.pack(f"<2Q{len(links)}Q", 24 + 8 * len(links) + len(content), len(links), *links)
        + content
    )


def test_records_of_two_groups_in_turn_and_numbers_of_any_bits(tmp_path: Path) -> None:
    """Group 1: time as float64, then 12 bits signed from bit 3 on; group 2: time, then 24 bits with the highest byte first."""
    parts: list[bytes] = []
    place = 64 + 104

    def add(kind: bytes, links: list[int], content: bytes) -> int:
        nonlocal place
        made = block(kind, links, content)
        made += bytes(-len(made) % 8)
        parts.append(made)
        place += len(made)
        return place - len(made)

    def channel(following: int, name: str, kind: int, data_type: int, bit: int, byte: int, bits: int) -> int:
        text = add(b"TX", [], name.encode() + b"\0")
        content = struct.pack("<4B4I", kind, 1 if kind == 2 else 0, data_type, bit, byte, bits, 0, 0) + bytes(48)
        return add(b"CN", [following, 0, text, 0, 0, 0, 0, 0], content)

    first = channel(channel(0, "a", 0, 2, 3, 8, 12), "t", 2, 4, 0, 0, 64)
    second = channel(channel(0, "b", 0, 1, 0, 8, 24), "t", 2, 4, 0, 0, 64)
    small = [-2048, -1, 0, 5, 2047]
    large = [1, 2**24 - 1]
    records = b"".join(
        b"\1" + struct.pack("<dH", 0.1 * row, ((value & 0xFFF) << 3) | 0x8007) for row, value in enumerate(small)
    )
    others = b"".join(b"\2" + struct.pack("<d", 0.5 * row) + value.to_bytes(3, "big") for row, value in enumerate(large))
    data = add(b"DT", [], records[:22] + others[:12] + records[22:] + others[12:])
    group_2 = add(b"CG", [0, second, 0, 0, 0, 0], struct.pack("<2Q2H4x2I", 2, 2, 0, 0, 11, 0))
    group_1 = add(b"CG", [group_2, first, 0, 0, 0, 0], struct.pack("<2Q2H4x2I", 1, 5, 0, 0, 10, 0))
    root = add(b"DG", [0, group_1, data, 0], b"\1" + bytes(7))
    header = block(b"HD", [root, 0, 0, 0, 0, 0], bytes(32))
    begin = b"MDF     4.10    test    " + bytes(4) + struct.pack("<H", 410)
    (tmp_path / "a.mf4").write_bytes(begin.ljust(64, b"\0") + header + b"".join(parts))
    table = open_mdf(tmp_path / "a.mf4")
    assert columns(table) == {"a": small, "b": large}
    assert [grid.time.tolist() for grid in table.grids] == [[0.1 * row for row in range(5)], [0.0, 0.5]]
