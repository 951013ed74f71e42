"""Files that are whole or not there at all: whatever stands in their place, whoever writes beside them, whatever fails."""

from __future__ import annotations

import os
import signal
import stat
import subprocess
import sys
import threading
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
import strainwave as sw
from hypothesis import given, strategies as st
from strainwave.files import writing
from strainwave.files.writing import claiming, making, remove_drafts, replacing, write_all

RECORDING = sw.Recording({"time": [0.0, 0.1], "torque": [1.0, 2.0]}, {"time": "s", "torque": "N.m"})
WRITERS: dict[str, Callable[[str | Path], None]] = {
    "csv": RECORDING.to_csv,
    "parquet": RECORDING.to_parquet,
    "toml": sw.GearSet.of(sw.Gear(), name="mine", source="assumed: example").save,
}
every_writer = pytest.mark.parametrize("kind", WRITERS)


def write(path: str | Path, content: bytes) -> None:
    with replacing(path) as file:
        file.write(content)


def python(code: str, **arguments: Any) -> subprocess.CompletedProcess[bytes]:
    """A process of its own, that has `files` imported."""
    imports = "import os, sys; from pathlib import Path; from strainwave.files.writing import *; import strainwave as sw\n"
    return subprocess.run([sys.executable, "-c", imports + code], capture_output=True, timeout=60, check=False, **arguments)


# What stands in the place


@every_writer
def test_a_link_stays_and_its_target_is_written(kind: str, tmp_path: Path) -> None:
    (tmp_path / "folder").mkdir()
    target, link = tmp_path / "folder" / f"target.{kind}", tmp_path / f"link.{kind}"
    link.symlink_to(Path("folder", target.name))
    for _ in ("target made anew", "target replaced"):
        WRITERS[kind](link)
        assert link.is_symlink()
        assert target.stat().st_size > 0
    assert [path.name for path in target.parent.iterdir()] == [target.name]


@every_writer
def test_a_fifo_stays_and_takes_the_bytes_of_the_file(kind: str, tmp_path: Path) -> None:
    fifo, plain, read = tmp_path / f"fifo.{kind}", tmp_path / f"plain.{kind}", list[bytes]()
    os.mkfifo(fifo)
    reader = threading.Thread(target=lambda: read.append(fifo.read_bytes()))
    reader.start()
    WRITERS[kind](fifo)
    reader.join(timeout=60.0)
    WRITERS[kind](plain)
    assert fifo.is_fifo()
    assert read == [plain.read_bytes()]


@pytest.mark.skipif(not hasattr(os, "geteuid") or os.geteuid() != 0, reason="only root can make a device")
@every_writer
def test_a_device_stays_a_device(kind: str, tmp_path: Path) -> None:
    null = tmp_path / f"null.{kind}"
    try:
        os.mknod(null, 0o666 | stat.S_IFCHR, os.makedev(1, 3))
        null.write_bytes(b"taken")
    except PermissionError:
        pytest.skip("devices cannot be made here")
    WRITERS[kind](null)
    assert stat.S_ISCHR(null.stat().st_mode)


@pytest.mark.slow("files")
@pytest.mark.parametrize("stdout", ["pipe", "file"])
def test_standard_output_is_written_to_as_it_stands(stdout: str, tmp_path: Path) -> None:
    code = "print('before', flush=True)\nsw.Recording({'x': [1.0]}, {'x': 'm'}).to_csv('/dev/stdout')\nprint('after')"
    if stdout == "pipe":
        said = python(code).stdout
    else:
        path = tmp_path / "said.txt"
        with path.open("wb") as file:
            imports = "import strainwave as sw\n"
            subprocess.run([sys.executable, "-c", imports + code], stdout=file, timeout=60, check=True)
        said = path.read_bytes()
    assert said == b'before\n"x [m]"\n1\nafter\n'


def test_what_is_neither_file_nor_stream_is_refused(tmp_path: Path) -> None:
    import socket

    with socket.socket(socket.AF_UNIX) as listening:
        listening.bind(str(tmp_path / "socket"))
        with pytest.raises(OSError, match=r"socket cannot be written: it is no regular file, no character device and no FIFO$"):
            write(tmp_path / "socket", b"text")
    assert stat.S_ISSOCK((tmp_path / "socket").stat().st_mode)


@given(mode=st.integers(0, 0o777).map(lambda mode: mode | 0o200), umask=st.integers(0, 0o777))
def test_the_mode_stays_and_that_of_a_new_file_is_the_umask_s(
    mode: int, umask: int, tmp_path_factory: pytest.TempPathFactory
) -> None:
    path = tmp_path_factory.mktemp("mode") / "file"
    before = os.umask(umask)
    try:
        write(path, b"new")
        assert stat.S_IMODE(path.stat().st_mode) == 0o666 & ~umask
        path.chmod(mode)
        write(path, b"replaced")
        assert stat.S_IMODE(path.stat().st_mode) == mode
    finally:
        os.umask(before)


@pytest.mark.skipif(not hasattr(os, "geteuid") or os.geteuid() != 0, reason="only root can give a file away")
def test_the_owner_stays(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("old")
    os.chown(tmp_path / "file", 1234, 2345)
    write(tmp_path / "file", b"new")
    found = (tmp_path / "file").stat()
    assert (found.st_uid, found.st_gid) == (1234, 2345)


def test_a_file_that_may_not_be_written_is_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "file").write_text("old")
    monkeypatch.setattr(os, "access", lambda path, mode: False)  # nothing is read-only for root
    with pytest.raises(PermissionError, match=r"/file cannot be written: it is read-only$"):
        write(tmp_path / "file", b"new")
    assert (tmp_path / "file").read_text() == "old"


@pytest.mark.parametrize("name", ["a" * 255, "ä" * 127, "a" * 250 + ".toml"])
def test_a_name_may_be_as_long_as_the_file_system_allows(name: str, tmp_path: Path) -> None:
    write(tmp_path / name, b"text")
    assert (tmp_path / name).read_bytes() == b"text"


def test_a_name_that_is_too_long_is_refused(tmp_path: Path) -> None:
    with pytest.raises(OSError, match=r"^\S*/a{256} cannot be written: File name too long$"):
        write(tmp_path / ("a" * 256), b"text")


@pytest.mark.parametrize(
    ("path", "words"),
    [
        ("folder", r"^folder cannot be written: it is a folder$"),
        ("missing/file", r"^missing/file cannot be written: there is no folder missing$"),
        ("lost", r"^lost cannot be written: there is no folder \S*/gone$"),
        ("loop", r"^loop cannot be written: Too many levels of symbolic links$"),
        ("plain/file", r"^plain/file cannot be written: Not a directory$"),
        ("missing/a\nb", r"^missing/a\\nb cannot be written: there is no folder missing$"),
        ("\ud800", r"^\\ud800 cannot be written: no file can have this name$"),
    ],
)
def test_what_cannot_be_written_is_named_with_the_reason(
    path: str, words: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("folder").mkdir()
    Path("plain").write_text("old")
    Path("lost").symlink_to("gone/file")
    Path("loop").symlink_to("loop")
    before = sorted(Path().rglob("*"))
    with pytest.raises(OSError, match=words):
        write(path, b"text")
    assert sorted(Path().rglob("*")) == before


# What fails

FULL = """
import resource, signal
signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
resource.setrlimit(resource.RLIMIT_FSIZE, (100_000, 100_000))
"""


@pytest.mark.slow("files")
@pytest.mark.parametrize("method", ["to_csv", "to_parquet"])
def test_a_disk_that_is_full_leaves_what_stood_there_and_no_draft(method: str, tmp_path: Path) -> None:
    (tmp_path / "run").write_text("old")
    code = f"""{FULL}
import numpy as np
noise = np.random.default_rng(1).normal(size=50_000)
try:
    sw.Recording({{"x": noise}}, {{"x": "m"}}).{method}("run")
except OSError as error:
    print(error, error.errno)
"""
    said = python(code, cwd=tmp_path)
    assert said.stdout.decode() == "run cannot be written: File too large 27\n", said.stderr
    assert [(path.name, path.read_text()) for path in tmp_path.iterdir()] == [("run", "old")]


def test_a_device_that_is_full_is_named() -> None:
    if not Path("/dev/full").exists():
        pytest.skip("this system has no /dev/full")
    with pytest.raises(OSError, match=r"^/dev/full cannot be written: No space left on device$"):
        write("/dev/full", b"text")


@pytest.mark.parametrize("failure", [OSError("broken"), KeyboardInterrupt(), ValueError("wrong")], ids=repr)
def test_whatever_stops_the_writing_leaves_the_old_file_and_no_draft(failure: BaseException, tmp_path: Path) -> None:
    (tmp_path / "file").write_text("old")

    def fail() -> None:
        with replacing(tmp_path / "file") as file:
            file.write(b"new")
            raise failure

    with pytest.raises(type(failure)):
        fail()
    assert [(path.name, path.read_text()) for path in tmp_path.iterdir()] == [("file", "old")]


def test_a_file_is_on_the_disk_before_it_takes_its_place_and_then_its_folder(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    done: list[tuple[str, bool]] = []

    def listening(name: str) -> None:
        real = getattr(os, name)

        def call(*arguments: Any) -> None:
            is_folder = name == "fsync" and stat.S_ISDIR(os.fstat(arguments[0]).st_mode)
            done.append((name, is_folder))
            real(*arguments)

        monkeypatch.setattr(os, name, call)

    listening("fsync")
    listening("replace")
    write(tmp_path / "file", b"text")
    assert done == [("fsync", False), ("replace", False), ("fsync", True)]


def test_a_process_that_is_killed_leaves_the_old_file_whole(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("old")
    code = "with replacing('file') as file:\n file.write(b'new'); file.flush(); os.kill(os.getpid(), 9)"
    assert python(code, cwd=tmp_path).returncode == -signal.SIGKILL
    assert (tmp_path / "file").read_text() == "old"


def test_many_writers_of_one_file_leave_what_one_of_them_wrote(tmp_path: Path) -> None:
    contents = [bytes([65 + number]) * 100_000 for number in range(8)]
    writers = [threading.Thread(target=write, args=(tmp_path / "file", content)) for content in contents]
    for writer in writers:
        writer.start()
    for writer in writers:
        writer.join()
    assert (tmp_path / "file").read_bytes() in contents
    assert [path.name for path in tmp_path.iterdir()] == ["file"]


# Several files


def test_either_all_files_are_written_or_none(tmp_path: Path) -> None:
    one, other = tmp_path / "one", tmp_path / "other"
    write_all({one: "1", other: b"2"})
    assert (one.read_text(), other.read_text()) == ("1", "2")
    other.unlink()
    other.mkdir()
    for contents in ({one: "new", other: "new"}, {other: "new", one: "new"}):
        with pytest.raises(IsADirectoryError, match=r"/other cannot be written: it is a folder$"):
            write_all(contents)
        assert one.read_text() == "1"
        assert sorted(path.name for path in tmp_path.iterdir()) == ["one", "other"]


def test_the_files_of_two_writers_are_not_mixed(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Each writer stops for a moment between its two files, in which the other one has its own ready."""
    put = writing._Draft.put

    def slowly(draft: writing._Draft) -> None:
        put(draft)
        time.sleep(0.02)

    monkeypatch.setattr(writing._Draft, "put", slowly)
    one, other = tmp_path / "one", tmp_path / "other"
    contents: list[dict[Path, str]] = [{one: "a", other: "a"}, {other: "b", one: "b"}]
    writers = [threading.Thread(target=write_all, args=(each,)) for each in contents for _ in range(3)]
    for writer in writers:
        writer.start()
    for writer in writers:
        writer.join()
    assert one.read_text() == other.read_text()


# Folders


def fail_in(folder: Path, *files: str) -> None:
    """Makes a folder and files of somebody else above it, and fails."""
    with making(folder):
        assert folder.is_dir()
        for name in files:
            (folder.parent / name).write_text("not mine")
        raise KeyboardInterrupt


def test_folders_made_for_what_fails_are_taken_away_again(tmp_path: Path) -> None:
    mine = tmp_path / "mine"
    mine.mkdir()
    for folder in (mine, mine / "a", mine / "a" / "b"):
        with pytest.raises(KeyboardInterrupt):
            fail_in(folder)
        assert list(tmp_path.rglob("*")) == [mine]
    with pytest.raises(KeyboardInterrupt):
        fail_in(mine / "a" / "b", "note")
    assert sorted(tmp_path.rglob("*")) == [mine, mine / "a", mine / "a" / "note"]


def test_a_folder_that_cannot_be_made_is_named(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("in the way")
    with (
        pytest.raises(FileExistsError, match=r"/file is a file where a folder is to be made; give another name"),
        making(tmp_path / "file"),
    ):
        pass
    with pytest.raises(OSError, match=r"/\\ud800 cannot be made: no file can have this name$"), making(tmp_path / "\ud800"):
        pass
    with pytest.raises(NotADirectoryError, match=r"/file/a/b cannot be made: Not a directory$"), making(tmp_path / "file/a/b"):
        pass


@pytest.mark.slow("files")
def test_a_claimed_folder_is_refused_to_others(tmp_path: Path) -> None:
    again = f"with claiming(Path({str(tmp_path)!r})): print('claimed')"
    with claiming(tmp_path):
        said = python(again).stderr.decode().splitlines()
        assert said[-1] == f"BlockingIOError: {tmp_path} is being written by another process; wait until it ends"
    assert python(again).stdout == b"claimed\n"


def test_drafts_that_a_killed_process_left_can_be_removed(tmp_path: Path) -> None:
    python("with replacing('file') as file:\n os.kill(os.getpid(), 9)", cwd=tmp_path)
    assert len(list(tmp_path.iterdir())) == 1
    (tmp_path / "file").write_text("mine")
    remove_drafts(tmp_path)
    assert [path.name for path in tmp_path.iterdir()] == ["file"]
