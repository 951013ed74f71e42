"""Files that claim more than they contain, refer to themselves or to other files, or contain something that could be run.

A secret lies next to each such file, and a program that would leave a mark. No result contains the secret, and no mark is left.
"""

from __future__ import annotations

import io
import json
import os
import sqlite3
import zipfile
import zlib
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow
import pyarrow.parquet
from numpy.random import Generator
from numpy.typing import NDArray
from strainwave.files.labels import ColumnSource
from strainwave.files.table_format import OpenTable
from strainwave.files.tables import FORMATS, open_table
from strainwave.identification.reading.source import measurement_files

from tests.fuzz.laws import Case, within_memory
from tests.fuzz.mutation import mutated_bytes, picked

SECRET, MARK = 4242.4242, "MARK"
SIZES = (1, 50, 10**4, 10**6, 10**7, 10**8, 10**9, 10**12, 2**31, 2**32, 2**62)
MAX_READ = 5  # columns of a table
COUNTS = (1, 2, 50, 5000, 20_000)  # of what a case makes itself
TIME = np.arange(50) * 0.01


def claims_case(random: Generator, folder: Path) -> Case:
    """One file that must be read as far as it is honest, or be refused."""
    make = picked(random, MAKERS)
    (folder / "secret.bin").write_bytes(np.full(1000, SECRET).tobytes())
    (folder / "secret.csv").write_text("t,secret\n" + "".join(f"{t:g},{SECRET}\n" for t in TIME))
    place = folder / "given"
    place.mkdir()
    what, path = make(random, place)
    if path.is_file() and not path.is_symlink() and random.random() < 0.2:
        path.write_bytes(mutated_bytes(path.read_bytes(), random))
    return Case(
        f"{make.__name__.removeprefix('_')} {what}", within_memory(lambda: _read(path)), lambda read: _check(read, folder)
    )


Columns = dict[str, NDArray[np.float64]]


def _read(path: Path) -> list[tuple[OpenTable, Columns]]:
    """The tables of a file, or of the files of a folder, each with its first columns of numbers."""
    tables = [file.table for file in measurement_files([path]).files] if path.is_dir() else [open_table(path)]
    return [(table, _columns(table)) for table in tables]


def _columns(table: OpenTable) -> Columns:
    wanted = [place for place, content in enumerate(table.contents) if content == "numbers"][:MAX_READ]
    return (
        table.measured([ColumnSource(place, table.labels[place].name, str(place), "1") for place in wanted])[0]
        if wanted
        else {}
    )


def _check(read: list[tuple[OpenTable, Columns]], folder: Path) -> None:
    assert not list(folder.rglob(MARK)), "runs what a file contains"
    for _, columns in read:
        assert not any((each == SECRET).any() for each in columns.values()), "reads another file"


Made = tuple[str, Path]


def _hdf5(random: Generator, place: Path) -> Made:
    import h5py

    path, size, count = place / "log.h5", picked(random, SIZES), picked(random, COUNTS)
    kind = picked(
        random, ("huge", "chunked", "external", "link", "soft", "virtual", "references", "cycle", "deep", "many", "text")
    )
    with h5py.File(path, "w", libver=picked(random, ("earliest", "latest"))) as file:
        file["t"], file["q"] = TIME, np.sin(TIME)
        if kind == "huge":
            file.create_dataset("x", (size,), "f8", chunks=(min(size, 1024),), fillvalue=1.0)
        elif kind == "chunked":
            file.create_dataset("x", (min(size, 10**7),), "f8", data=np.zeros(min(size, 10**7)), compression="gzip")
        elif kind == "external":
            file.create_dataset("x", (50,), "f8", external=[(str(place.parent / "secret.bin"), 0, h5py.h5f.UNLIMITED)])
        elif kind == "link":
            file["x"] = h5py.ExternalLink("../secret.h5", "/t")
        elif kind == "soft":
            file["x"] = h5py.SoftLink("/nowhere")
        elif kind == "virtual":
            layout = h5py.VirtualLayout((50,), "f8")
            layout[:] = h5py.VirtualSource("../secret.h5", "t", (50,))
            file.create_virtual_dataset("x", layout)
        elif kind == "references":
            cells = file.create_dataset("x", (min(count, 200),), h5py.ref_dtype)
            for i in range(len(cells)):
                cells[i] = cells.ref
        elif kind == "cycle":
            file.create_group("a")["b"] = file["/"]
            file["a/c"] = file["a"]
        elif kind == "deep":
            file["/".join("g" for _ in range(min(count, 5000))) + "/x"] = TIME
        elif kind == "many":
            for i in range(min(count, 5000)):
                file[f"x{i}"] = TIME
        else:
            file["t"].attrs["MATLAB_class"] = "x" * min(size, 60_000)
            file.create_dataset("x", (count,), h5py.string_dtype())
    return f"{kind} {size} {count}", path


def _numpy(random: Generator, place: Path) -> Made:
    size, count = picked(random, SIZES), picked(random, COUNTS)
    kind = picked(random, ("claim", "zeros", "many", "fields", "objects"))
    if kind == "claim":
        path, buffer = place / "log.npy", io.BytesIO()
        header = {"descr": picked(random, ("<f8", "<f4", "|u1", "<f8")), "fortran_order": False, "shape": (size, count)}
        np.lib.format.write_array_header_1_0(buffer, header)
        path.write_bytes(buffer.getvalue() + bytes(800))
        return f"{kind} {size} {count}", path
    path = place / "log.npz"
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        length = min(size, 10**7)
        for i in range({"zeros": 4, "many": min(count, 5000)}.get(kind, 1)):
            array = np.zeros(length) if kind == "zeros" else TIME
            if kind == "fields":
                array = np.zeros(50, [(f"f{n}", "f8") for n in range(min(count, 5000))])
            elif kind == "objects":
                array = np.array([_Marks(place)], object)
            buffer = io.BytesIO()
            np.lib.format.write_array(buffer, array, allow_pickle=True)
            archive.writestr(f"x{i}.npy", buffer.getvalue())
    return f"{kind} {size} {count}", path


class _Marks:
    """Leaves a mark where it is loaded from a pickle."""

    def __init__(self, place: Path) -> None:
        self.place = place

    def __reduce__(self) -> Any:
        return os.mkdir, (str(self.place / MARK),)


def _element(kind: int, data: bytes) -> bytes:
    """An element of a MAT file of version 5."""
    return np.array([kind, len(data)], "<u4").tobytes() + data + bytes(-len(data) % 8)


def _matrix(name: bytes, of_class: int, parts: bytes, count: int = 1) -> bytes:
    head = _element(6, np.array([of_class, 0], "<u4").tobytes()) + _element(5, np.array([count, 1], "<i4").tobytes())
    return _element(14, head + _element(1, name) + parts)


def _matlab(random: Generator, place: Path) -> Made:
    path, depth, size = place / "log.mat", picked(random, COUNTS), picked(random, SIZES)
    kind = picked(random, ("cells", "structures", "zeros", "claim"))
    inner = _matrix(b"", 6, _element(9, TIME.tobytes()), 50)
    if kind == "cells":
        for _ in range(depth):
            inner = _matrix(b"", 1, inner)
    elif kind == "structures":
        for _ in range(depth):
            inner = _matrix(b"", 2, _element(5, b"\x08\0\0\0") + _element(1, b"a" + bytes(7)) + inner)
    elif kind == "zeros":
        length = min(size, 10**7)
        inner = _matrix(b"x", 6, _element(9, bytes(8 * length)), length)
    else:
        inner = _matrix(b"x", 6, _element(9, TIME.tobytes()), min(size, 2**31 - 1))
    named = inner if kind in ("zeros", "claim") else _matrix(b"x", 1, inner)
    if random.random() < 0.5:
        squeezed = zlib.compress(named, 1)
        named = np.array([15, len(squeezed)], "<u4").tobytes() + squeezed
    path.write_bytes(b"MATLAB 5.0 MAT-file".ljust(124) + b"\x00\x01IM" + named)
    return f"{kind} {depth} {size}", path


def _json(random: Generator, place: Path) -> Made:
    path, count = place / picked(random, ("log.json", "log.jsonl")), picked(random, COUNTS)
    kind = picked(random, ("keys", "integer", "digits", "deep", "wide"))
    rows: Any = [{"t": float(t), "q": float(t)} for t in TIME]
    if kind == "keys":
        text = json.dumps([{f"k{i}": i} for i in range(count)])
    elif kind in ("integer", "digits"):
        text = json.dumps(rows).replace("0.01", "9" * (400 if kind == "integer" else 5000), 1)
    elif kind == "deep":
        text = "[" * count + "]" * count
    else:
        text = json.dumps({f"k{i}": [0.0, 1.0] for i in range(count)})
    path.write_text(text)
    return f"{kind} {count}", path


def _parquet(random: Generator, place: Path) -> Made:
    path, size = place / "log.parquet", min(picked(random, SIZES), 10**8)
    block = pyarrow.table({"t": np.zeros(min(size, 10**6)), "q": np.zeros(min(size, 10**6))})
    with pyarrow.parquet.ParquetWriter(path, block.schema) as writer:
        for _ in range(max(size // 10**6, 1)):
            writer.write_table(block)
    return f"{size}", path


@cache
def _measured(formula: str, mark: str) -> bytes:
    """An MDF file one of whose channels is converted by a formula."""
    import tempfile

    from asammdf import MDF, Signal

    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder, "log.mf4")
        with MDF(version=mark) as file:
            plain = Signal(np.sin(TIME), TIME, name="q", unit="rad", conversion={"a": 2.0, "b": 1.0})
            file.append([plain, Signal(np.cos(TIME), TIME, name="x", conversion={"formula": formula})])
            file.save(path, overwrite=True)
        return next(Path(folder).glob("log.m*")).read_bytes()


def _mdf(random: Generator, place: Path) -> Made:
    formula = picked(random, ("X + 1", "X * 2 - 1", f"__import__('os').mkdir('{MARK}')", "X" + " + X" * 200))
    version = picked(random, ("4.10", "4.00", "3.30", "3.00"))
    path = place / picked(random, ("log.mf4", "log.mdf", "log.dat"))
    path.write_bytes(_measured(formula, version))
    return f"{version} {formula[:40]}", path


def _bag(random: Generator, place: Path) -> Made:
    """A database of ROS whose tables are views without end, or whose description names files outside."""
    path = place / "bag"
    path.mkdir()
    named = picked(random, ("log.db3", "../../secret.csv", "/dev/zero", "log.db3.zstd"))
    version, count = picked(random, (4, 5, 9)), picked(random, COUNTS)
    topic = "{topic_metadata: {name: /x, type: std_msgs/msg/Float64, serialization_format: cdr}, message_count: 1}"
    (path / "metadata.yaml").write_text(
        f"rosbag2_bagfile_information:\n  version: {version}\n  storage_identifier: sqlite3\n"
        f"  relative_file_paths: ['{named}']\n"
        f"  duration: {{nanoseconds: 1}}\n  starting_time: {{nanoseconds_since_epoch: 0}}\n  message_count: {count}\n"
        f"  compression_format: ''\n  compression_mode: ''\n  topics_with_message_count: [{topic}]\n"
    )
    with sqlite3.connect(path / "log.db3") as base:
        base.execute(
            "create table topics(id integer, name text, type text, serialization_format text, offered_qos_profiles text)"
        )
        base.execute("insert into topics values(1, '/x', 'std_msgs/msg/Float64', 'cdr', '')")
        endless = "with recursive n(i) as (select 1 union all select i + 1 from n) select i as id, 1 as topic_id"
        base.execute(
            f"create view messages as {endless}, i as timestamp, zeroblob({picked(random, (12, 10**9))}) as data from n"
        )
    base.close()
    return f"{named} {version} {count}", path


def _special(random: Generator, place: Path) -> Made:
    """A FIFO, a device or a link under the name of a table; or a folder that contains one."""
    suffix = picked(random, tuple(FORMATS))
    path = place / f"log{suffix}"
    kind = picked(random, ("fifo", "zero", "link", "loop", "folder"))
    if kind == "fifo":
        os.mkfifo(path)
    elif kind == "folder":
        path.mkdir()
    else:
        path.symlink_to({"zero": "/dev/zero", "link": "../secret.csv", "loop": path.name}[kind])
    inside = kind == "link" or random.random() < 0.3
    return f"{kind} {suffix} {'of a folder' if inside else ''}", place if inside else path


MAKERS: tuple[Callable[[Generator, Path], Made], ...] = (
    _hdf5, _hdf5, _numpy, _matlab, _json, _parquet, _mdf, _bag, _special,
)  # fmt: skip
