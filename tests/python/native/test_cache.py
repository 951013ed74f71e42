"""Kernels are compiled once and loaded again, and no fault of the cache does more harm than a warning."""

from __future__ import annotations

import ctypes
import errno
import json
import os
import signal
import stat
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from strainwave import _core
from strainwave.native import cache, compilers, folder
from strainwave.native.cache import KernelWarning, clear, find_kernel, kernel_file, listing, make_kernel, ship
from strainwave.native.compilers import CompileError
from strainwave.native.kernel import Kernel

from tests.python.native.conftest import Fake

ANSWER = 'extern "C" __attribute__((visibility("default"))) int answer() { return 42; }\n'
KERNEL = Kernel(ANSWER, "run", "load Pendulum")

RECORD = b'{"drive": "", "job": "", "compiler": "", "seconds": 1.0, "sha256": "", "size": %s, "made": %s}'

# Another process that asks for the kernel and prints its path. It finds the fake compiler by CXX.
ASKING = f"from strainwave.native.cache import *; print(kernel_file(Kernel({ANSWER!r}, 'run', 'load Pendulum')))"


def asking() -> subprocess.Popen[str]:
    return subprocess.Popen([sys.executable, "-c", ASKING], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)


def waited(condition: Callable[[], bool]) -> None:
    """Waits until something is so."""
    deadline = time.monotonic() + 60.0
    while not condition():
        assert time.monotonic() < deadline
        time.sleep(0.01)


def answers(path: Path | None) -> bool:
    """True if the kernel loads and answers."""
    assert path is not None
    return bool(ctypes.CDLL(str(path)).answer() == 42)


def mode(path: Path) -> int:
    return stat.S_IMODE(path.stat().st_mode)


def test_a_kernel_is_compiled_once_and_found_again(kernels: Path, fake: Fake, tmp_path: Path) -> None:
    fake(f"echo compiled >> {tmp_path}/log")
    assert find_kernel(KERNEL) is None
    made = kernel_file(KERNEL)
    assert answers(made)
    assert kernel_file(KERNEL) == find_kernel(KERNEL) == make_kernel(KERNEL) == made
    assert (tmp_path / "log").read_text() == "compiled\n"
    assert {each.suffix for each in kernels.iterdir()} == {".so", ".json"}


def test_the_cache_is_its_users_alone(kernels: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("STRAINWAVE_KERNELS", str(kernels / "a" / "b"))
    before = os.umask(0)
    try:
        made = kernel_file(KERNEL)
    finally:
        os.umask(before)
    assert made is not None
    assert [mode(each) for each in (kernels, kernels / "a", kernels / "a" / "b")] == [0o700] * 3
    assert {mode(each) for each in made.parent.iterdir()} == {0o600}


def test_the_cache_lies_where_the_platform_has_caches(kernels: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("STRAINWAVE_KERNELS", "")
    monkeypatch.setenv("XDG_CACHE_HOME", str(kernels))
    assert folder.cache_folder() == kernels / "strainwave" / "kernels"
    monkeypatch.setenv("XDG_CACHE_HOME", "relative")  # which the standard forbids
    monkeypatch.setenv("HOME", "/home/me")
    monkeypatch.setattr(sys, "platform", "linux")
    assert folder.cache_folder() == Path("/home/me/.cache/strainwave/kernels")
    monkeypatch.setattr(sys, "platform", "darwin")
    assert folder.cache_folder() == Path("/home/me/Library/Caches/strainwave/kernels")


def test_off_switches_kernels_off_without_a_word(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("STRAINWAVE_KERNELS", "off")
    assert kernel_file(KERNEL) is None
    assert find_kernel(KERNEL) is None
    assert (listing(), clear()) == ([], 0)
    with pytest.raises(OSError, match="no kernel is compiled: they are switched off by STRAINWAVE_KERNELS"):
        make_kernel(KERNEL)
    assert not list(tmp_path.iterdir())


def test_a_folder_must_be_absolute(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("STRAINWAVE_KERNELS", "of")
    with pytest.raises(ValueError, match='STRAINWAVE_KERNELS = "of" must be off or an absolute path'):
        kernel_file(KERNEL)


@pytest.mark.parametrize(
    ("target", "content"),
    [
        (".so", b""),
        (".so", b"\x7fELF"),
        (".json", b"{"),
        (".json", b"[]"),
        (".json", b"\xff"),
        (".json", b'{"sha256": ""}'),
        (".json", b"[" * 100_000),
        (".json", RECORD % (b"9" * 400, b"1.0")),
        (".json", RECORD % (b"1", b"NaN")),
    ],
    ids=["empty", "another", "unfinished", "no record", "no text", "incomplete", "deep", "a size of 400 digits", "no number"],
)
def test_a_damaged_kernel_is_not_used_and_made_anew(target: str, content: bytes) -> None:
    made = kernel_file(KERNEL)
    assert made is not None
    made.with_suffix(target).write_bytes(content)
    with pytest.warns(KernelWarning, match=r"damaged: .* not used") as warned:
        assert find_kernel(KERNEL) is None
    assert len(warned) == 1
    assert kernel_file(KERNEL) == made
    assert find_kernel(KERNEL) == made


def test_a_kernel_without_a_record_is_not_used(kernels: Path) -> None:
    """As one of a process that was killed between the two."""
    made = kernel_file(KERNEL)
    assert made is not None
    made.with_suffix(".json").unlink()
    assert find_kernel(KERNEL) is None  # without a warning, which would be an error: another process may be about to write it
    assert kernel_file(KERNEL) == made


@pytest.mark.parametrize("target", [".so", ".json"])
def test_what_another_user_owns_is_not_used_and_made_anew(target: str, given_away: Callable[[Path], None]) -> None:
    made = kernel_file(KERNEL)
    assert made is not None
    given_away(made.with_suffix(target))
    with pytest.warns(KernelWarning, match=r"belongs to another user \(\d+\)"):
        assert find_kernel(KERNEL) is None
    assert answers(kernel_file(KERNEL))


@pytest.mark.parametrize("target", [".so", ".json"])
def test_what_others_may_write_is_not_used_and_made_anew(target: str) -> None:
    made = kernel_file(KERNEL)
    assert made is not None
    made.with_suffix(target).chmod(0o1666)  # the sticky bit of a file protects nothing
    with pytest.warns(KernelWarning, match="other users may write to"):
        assert find_kernel(KERNEL) is None
    assert kernel_file(KERNEL) == made
    assert mode(made) == mode(made.with_suffix(".json")) == 0o600


def test_a_link_a_fifo_or_a_folder_is_no_kernel(tmp_path: Path) -> None:
    made = kernel_file(KERNEL)
    assert made is not None
    made.rename(tmp_path / "moved")
    moved = (tmp_path / "moved").read_bytes()
    for put, message in (
        (lambda: made.symlink_to(tmp_path / "moved"), "symbolic link"),
        (lambda: os.mkfifo(made), "no regular file"),
    ):
        put()
        with pytest.warns(KernelWarning, match=message):
            assert find_kernel(KERNEL) is None
        assert answers(kernel_file(KERNEL))
        assert stat.S_ISREG(made.lstat().st_mode)
        made.unlink()
    assert (tmp_path / "moved").read_bytes() == moved
    made.mkdir()
    with pytest.warns(KernelWarning):
        assert kernel_file(KERNEL) is None


def test_a_folder_of_another_user_is_not_used(kernels: Path, given_away: Callable[[Path], None]) -> None:
    kernel_file(KERNEL)
    given_away(kernels)
    with pytest.warns(KernelWarning, match="belongs to another user"):
        assert kernel_file(KERNEL) is None
    for action in (listing, clear):
        with pytest.raises(PermissionError, match="belongs to another user"):
            action()


@pytest.mark.parametrize("above", [False, True])
def test_a_folder_that_others_may_write_to_is_not_used(above: bool, kernels: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("STRAINWAVE_KERNELS", str(kernels / "inner"))
    made = kernel_file(KERNEL)
    open_folder = kernels if above else kernels / "inner"
    open_folder.chmod(0o777)
    with pytest.warns(KernelWarning, match=f"other users may write to {open_folder}"):
        assert kernel_file(KERNEL) is None
    cache._failed.clear()
    open_folder.chmod(0o1777)  # as /tmp: nobody can exchange what belongs to others
    assert kernel_file(KERNEL) == made


def test_nothing_is_made_below_a_folder_of_another_user(kernels: Path, given_away: Callable[[Path], None]) -> None:
    given_away(kernels.parent)
    with pytest.warns(KernelWarning, match=f"{kernels.parent} belongs to another user"):
        assert kernel_file(KERNEL) is None
    assert not kernels.exists()


def test_a_private_group_may_write(kernels: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Its number is that of the user; many systems let it write to all that the user makes."""
    made = kernel_file(KERNEL)
    assert made is not None
    kernels.chmod(0o770)
    assert kernels.stat().st_gid == kernels.stat().st_uid, "run as a user without a private group"
    assert find_kernel(KERNEL) == made


def test_a_linked_folder_is_not_used(kernels: Path, tmp_path: Path) -> None:
    (tmp_path / "real").mkdir()
    kernels.symlink_to(tmp_path / "real")
    with pytest.warns(KernelWarning, match="is a link; set STRAINWAVE_KERNELS to the folder itself"):
        assert kernel_file(KERNEL) is None
    assert not list((tmp_path / "real").iterdir())


def test_a_file_in_place_of_the_folder_is_left_alone(kernels: Path) -> None:
    kernels.write_text("mine")
    with pytest.warns(KernelWarning, match="no folder"):
        assert kernel_file(KERNEL) is None
    assert kernels.read_text() == "mine"


def fails(number: int) -> Callable[..., Any]:
    def failing(*_: object, **__: object) -> Any:
        raise OSError(number, os.strerror(number), "somewhere")

    return failing


def test_a_read_only_home_is_no_harm(kernels: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(Path, "mkdir", fails(errno.EROFS))
    with pytest.warns(KernelWarning, match="Read-only file system"):
        assert kernel_file(KERNEL) is None
    assert kernel_file(Kernel(ANSWER, "ensemble", "")) is None  # said once for each reason
    assert not kernels.exists()


def test_a_folder_that_became_read_only_is_still_read(kernels: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    made = kernel_file(KERNEL)
    opened = os.open

    def read_only(path: Any, flags: int, *rest: Any, **options: Any) -> int:
        return fails(errno.EROFS)() if flags & os.O_CREAT else opened(path, flags, *rest, **options)  # type: ignore[no-any-return]

    monkeypatch.setattr(os, "open", read_only)
    monkeypatch.setattr(os, "utime", fails(errno.EROFS))
    assert kernel_file(KERNEL) == made
    with pytest.warns(KernelWarning, match="Read-only file system"):
        assert kernel_file(Kernel(ANSWER + "\n", "run", "")) is None


def test_a_full_disk_is_no_harm(kernels: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(os, "fsync", fails(errno.ENOSPC))
    with pytest.warns(KernelWarning, match="No space left on device"):
        assert kernel_file(KERNEL) is None
    assert not list(kernels.iterdir())


def test_a_disk_that_is_full_for_the_compiler_is_no_harm(kernels: Path, fake: Fake) -> None:
    fake("echo 'kernel.cpp: fatal error: error writing to kernel.s: No space left on device'; exit 1")
    with pytest.warns(KernelWarning, match="no kernel: error writing to kernel.s: No space left on device"):
        assert kernel_file(KERNEL) is None
    assert not list(kernels.iterdir())


def test_a_source_that_fails_is_compiled_once_in_a_process(fake: Fake, tmp_path: Path) -> None:
    fake(f"echo compiled >> {tmp_path}/log")
    broken = Kernel("int f() { return x; }", "run", "")
    with pytest.warns(KernelWarning, match="because no kernel is used: fake-compiler compiled no kernel: 'x' was not declared"):
        assert kernel_file(broken) is None
    assert kernel_file(broken) is None
    assert (tmp_path / "log").read_text() == "compiled\n"
    with pytest.raises(CompileError) as failed:
        make_kernel(broken)
    assert "\n" not in str(failed.value)
    assert failed.value.output.count("\n") > 1


def test_without_a_compiler_it_is_said_once(empty_path: None, kernels: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(compilers, "find_spec", lambda name: None)
    with pytest.warns(KernelWarning, match=r"there is no C\+\+20 compiler .* install one, or `pip install"):
        assert kernel_file(KERNEL) is None
    assert kernel_file(Kernel(ANSWER, "ensemble", "")) is None
    assert not kernels.exists()


def test_the_package_ziglang_alone_makes_a_kernel_that_runs(empty_path: None) -> None:
    pytest.importorskip("ziglang")
    calls_memset = """
    #include <cmath>
    #include <cstring>
    extern "C" __attribute__((visibility("default"))) double of(double* x, int n) {
        std::memset(x, 0, sizeof(double) * n);
        return std::sin(x[0] + 1.0);
    }"""
    made = ctypes.CDLL(str(kernel_file(Kernel(calls_memset, "run", ""))))
    made.of.restype = ctypes.c_double
    numbers = (ctypes.c_double * 3)(1.0, 2.0, 3.0)
    assert made.of(numbers, 3) == pytest.approx(0.8414709848078965, rel=1e-15)
    assert list(numbers) == [0.0, 0.0, 0.0]


def test_a_shipped_kernel_needs_no_compiler(
    kernels: Path, monkeypatch: pytest.MonkeyPatch, given_away: Callable[[Path], None]
) -> None:
    folder.SHIPPED_KERNELS.mkdir()
    shipped = ship(KERNEL, folder.SHIPPED_KERNELS, _core.instruction_set())
    monkeypatch.setenv("PATH", "")
    monkeypatch.setattr(compilers, "find_spec", lambda name: None)
    assert kernel_file(KERNEL) == shipped
    assert answers(shipped)
    assert not kernels.exists()
    given_away(shipped)
    with pytest.warns(KernelWarning, match="belongs to another user"):
        assert find_kernel(KERNEL) is None


@pytest.mark.slow("native")
def test_two_processes_at_once_compile_once(fake: Fake, tmp_path: Path) -> None:
    """The compiler waits until both have asked for the kernel."""
    fake(f"echo compiled >> {tmp_path}/log; while [ ! -e {tmp_path}/go ]; do sleep 0.01; done")
    first, second = asking(), asking()
    waited((tmp_path / "log").exists)
    time.sleep(0.2)
    (tmp_path / "go").touch()
    said = {process.communicate() for process in (first, second)}
    assert said == {(f"{find_kernel(KERNEL)}\n", "")}
    assert (tmp_path / "log").read_text() == "compiled\n"


def test_one_that_waits_too_long_for_another_compiles_too(kernels: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    kernels.mkdir(mode=0o700)
    monkeypatch.setattr(cache, "MAX_COMPILE_SECONDS", 0.1)
    with folder.alone(kernels, KERNEL.key(compilers.find_compiler()), 0.0):
        assert answers(kernel_file(KERNEL))


def test_a_killed_process_leaves_nothing_that_is_used_or_stays(kernels: Path, fake: Fake, tmp_path: Path) -> None:
    fake(f"echo $$ > {tmp_path}/pid; touch {tmp_path}/log; sleep 60")
    killed = asking()
    waited((tmp_path / "log").exists)
    killed.kill()
    killed.communicate()
    os.killpg(os.getpgid(int((tmp_path / "pid").read_text())), signal.SIGKILL)  # the compiler, which would go on for a minute
    fake("true")
    left = list(kernels.iterdir())
    assert left
    assert answers(kernel_file(KERNEL))
    assert any(each.exists() for each in left)  # which may be those of a process that is still at it
    for each in left:
        if each.exists():
            os.utime(each, (0.0, 0.0))
    kernel_file(Kernel(ANSWER, "another", ""))
    kernel_file(Kernel(ANSWER + "\n", "run", ""))
    assert {each.suffix for each in kernels.iterdir()} == {".so", ".json"}


def test_the_cache_is_bounded_and_keeps_what_was_used_last(kernels: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    first, second, third = (Kernel(ANSWER + n * "\n", f"job {n}", "") for n in range(3))
    paths = [make_kernel(first), make_kernel(second)]
    for path in paths:
        os.utime(path, (0.0, 0.0))
    assert find_kernel(first) == paths[0]
    monkeypatch.setattr(folder, "MAX_CACHE_BYTES", int(2.5 * paths[0].stat().st_size))
    make_kernel(third)
    assert [each.job for each in listing()] == ["job 2", "job 0"]
    monkeypatch.setattr(folder, "MAX_CACHE_BYTES", 0)
    made = make_kernel(second)  # whatever its size, the new one stays
    assert [each.job for each in listing()] == ["job 1"]
    assert {each.stem for each in kernels.iterdir()} == {made.stem}


def test_files_of_others_in_the_folder_stay(kernels: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    kernels.mkdir(mode=0o700)
    of_others = {kernels / name for name in ("libmine.so", "0" * 64 + ".so", "0" * 64 + ".json", "mine.txt")}
    for path in of_others:
        path.write_bytes(b"mine")
    monkeypatch.setattr(folder, "MAX_CACHE_BYTES", 0)
    make_kernel(KERNEL)
    assert clear() == 1
    assert set(kernels.iterdir()) == of_others


def test_a_list_and_its_end(kernels: Path) -> None:
    before = time.time()
    made = make_kernel(KERNEL)
    (record,) = listing()
    assert (record.drive, record.job, record.compiler) == ("load Pendulum", "run", "c++")
    assert record.size == made.stat().st_size
    assert 0.0 < record.seconds < time.time() - before
    assert before <= record.made <= time.time()
    (kernels / ("strainwave-" + "0" * 64 + ".so")).touch()  # damaged, and not listed
    assert listing() == [record]
    assert clear() == 2
    assert not list(kernels.iterdir())
    assert (listing(), clear()) == ([], 0)


def test_the_record_is_plain_json(kernels: Path) -> None:
    assert set(json.loads(make_kernel(KERNEL).with_suffix(".json").read_text())) == {
        *("drive", "job", "compiler", "seconds", "made", "size", "sha256"),
    }
