"""Tasks of a developer, on a machine with Python 3.11 or later and its headers, git and a C++20 compiler.

    python3 dev.py demo         run the demonstration; its reports are out/demo/*/report.html
    python3 dev.py test         run the fast tests and a whole path of each room; what follows goes to pytest: test -k lugre
    python3 dev.py test --all   run all tests; `test -m slow` runs those that the fast tests leave out
    python3 dev.py times        print the processor time of each file compiled, and of the slowest tests of the last run
    python3 dev.py lint         check style, formatting and types
    python3 dev.py format       repair style and formatting
    python3 dev.py sanitize     run tests of the compiled core with addresses, undefined behaviour and threads checked
    python3 dev.py bench        compare with other solvers; what follows goes to benchmarks/run.py
    python3 dev.py workbench    build the page of `strainwave workbench`, kept unless its sources change
    python3 dev.py docs         build the documentation; it begins at out/docs/index.html
    python3 dev.py wheel        build a wheel for every machine of this kind into dist/, and try it where no compiler is
    python3 dev.py pin          write the exact versions of all dependencies anew, the newest that pyproject.toml allows

The first call of each makes .venv and installs what it needs into it, with uv. Later calls find this done.
"""

from __future__ import annotations

import hashlib
import os
import re
import shutil
import subprocess
import sys
import sysconfig
from collections.abc import Callable, Sequence
from pathlib import Path

ROOT = Path(__file__).resolve().parent
BUILD = ROOT / "build"
TOOLS = BUILD / "tools"
STAMPS = BUILD / "installed"
OUT = ROOT / "out"
BIN = ROOT / ".venv" / "bin"
PYTHON = BIN / "python"
PINS = ROOT / ".ci" / "requirements.txt"
TEST_TIMES = BUILD / "test-times.txt"
# Builds by the tools of .venv, which stay there, are kept in BUILD. Any other, as by `pip wheel .`, has a folder of its own.
KEPT = ("--no-build-isolation", "--config-setting", "build-dir=build/{wheel_tag}")
# What a configured build uses by its path.
USED = (
    "CMAKE_HOME_DIRECTORY",
    "CMAKE_COMMAND",
    "CMAKE_MAKE_PROGRAM",
    "CMAKE_CXX_COMPILER",
    "Python_EXECUTABLE",
    "nanobind_DIR",
)
MAX_SLOWEST = 20  # lines of a table of times


def main(arguments: Sequence[str]) -> int:
    if not arguments or arguments[0] not in VERBS:
        print(__doc__)
        return 0 if arguments and arguments[0] in ("-h", "--help") else 2
    name, *options = arguments
    return VERBS[name](options[1:] if options[:1] == ["--"] else options)


# ---- The environment -------------------------------------------------------------------------------------------------


def prepare(groups: Sequence[str] = (), extra: str = "") -> None:
    """Installs the package with dependency groups and an extra, unless that is done, and compiles what was edited."""
    remove_stale_builds()
    stamp, state = STAMPS / "-".join(("package", *groups, extra)).strip("-"), digest(ROOT / "pyproject.toml", PINS) + modules()
    is_compiled = (BIN / "cmake").exists() and any(BUILD.glob("cp*/CMakeCache.txt"))
    if not (is_compiled and stamp.exists() and stamp.read_text() == state):
        install(groups, extra)
        STAMPS.mkdir(parents=True, exist_ok=True)
        stamp.write_text(state)
    call(PYTHON, "-c", "import strainwave")


def remove_stale_builds() -> None:
    """Removes each build that can no longer run, because the clone or a tool of the build is elsewhere now."""
    for cache in sorted(BUILD.glob("*/CMakeCache.txt")):
        entries = dict(re.findall(r"^(\w+):\w+=(.*)$", cache.read_text(), re.MULTILINE))
        lost = [path for name in USED if (path := entries.get(name, "")).startswith("/") and not Path(path).exists()]
        if lost or entries["CMAKE_CACHEFILE_DIR"] != str(cache.parent):
            say(f"removing {cache.parent.relative_to(ROOT)}: it was built with {[*lost, entries['CMAKE_CACHEFILE_DIR']][0]}")
            shutil.rmtree(cache.parent)
            shutil.rmtree(STAMPS, ignore_errors=True)


def install_tools() -> tuple[str | Path, ...]:
    """Makes the environment with the tools of the build; returns the command that installs more into it."""
    check_machine()
    if not PYTHON.exists():
        call(uv(), "venv", "--quiet", "--seed", "--python", sys.executable, BIN.parent)  # with pip, which installs the extras
    pip_install = (uv(), "pip", "install", "--quiet", "--python", PYTHON, "--constraints", PINS)
    say("installing the tools of the build")
    call(*pip_install, "--group", "build")
    return pip_install


def install(groups: Sequence[str], extra: str) -> None:
    pip_install = install_tools()
    say("installing strainwave and its dependencies; compiling takes some minutes the first time")
    anew = [] if STAMPS.exists() else ["--reinstall-package", "strainwave"]
    wanted = [word for group in groups for word in ("--group", group)]
    rebuilt_when_imported = ("--config-setting", "editable.rebuild=true")
    call(*pip_install, *KEPT, *rebuilt_when_imported, *anew, "--editable", f".[{extra}]" if extra else ".", *wanted)


def check_machine() -> None:
    if sys.version_info < (3, 11):  # noqa: UP036 - whatever python3 is here
        sys.exit(f"dev.py: Python 3.11 or later is needed, this is {sys.version.split()[0]}")
    if not Path(sysconfig.get_path("include"), "Python.h").exists():
        sys.exit("dev.py: the headers of Python are missing; on Debian or Ubuntu: apt install python3-dev")
    if not (os.environ.get("CXX") or shutil.which("c++") or shutil.which("g++") or shutil.which("clang++")):
        sys.exit("dev.py: a C++20 compiler is missing; on Debian or Ubuntu: apt install g++")


def uv() -> Path:
    """The machine's uv, or one of this project's own."""
    if found := shutil.which("uv"):
        return Path(found)
    own = TOOLS / "bin" / "uv"
    if not own.exists():
        say("installing uv into build/tools")
        if subprocess.run([sys.executable, "-m", "venv", TOOLS], stdout=subprocess.DEVNULL).returncode:
            sys.exit("dev.py: install uv (https://docs.astral.sh/uv), or pip for Python: apt install python3-venv")
        call(TOOLS / "bin" / "python", "-m", "pip", "install", "--quiet", "uv>=0.7.1,<1")
    return own


def digest(*files: Path) -> str:
    return hashlib.sha256(b"\0".join(file.read_bytes() for file in files)).hexdigest()


def modules() -> str:
    """Which modules there are: an installation remembers where each of them was."""
    names = sorted(str(path.relative_to(ROOT)) for path in (ROOT / "python").rglob("*.py"))
    return hashlib.sha256("\0".join(names).encode()).hexdigest()


def environment() -> dict[str, str]:
    """The caller's, the tools of .venv found first, bytecode kept there, and the same certificates trusted by pip and uv."""
    found = dict(os.environ, VIRTUAL_ENV=str(BIN.parent), PATH=f"{BIN}{os.pathsep}{os.environ['PATH']}")
    found.pop("PYTHONDONTWRITEBYTECODE", None)  # with it, each process of the tests compiles what it imports, for seconds
    certificates = found.get("SSL_CERT_FILE") or found.get("PIP_CERT")
    return {"SSL_CERT_FILE": certificates, "PIP_CERT": certificates, **found} if certificates else found


def attempt(*command: str | Path, **variables: str) -> int:
    return subprocess.run([str(word) for word in command], cwd=ROOT, env=environment() | variables).returncode


def call(*command: str | Path) -> None:
    """Run a command and exit with its code if it fails."""
    if code := attempt(*command):
        sys.exit(code)


def say(message: str) -> None:
    print(f"dev.py: {message}", flush=True)


# ---- The verbs -------------------------------------------------------------------------------------------------------


def demo(options: Sequence[str]) -> int:
    prepare()
    call(BIN / "strainwave", "demo", "--out", OUT / "demo", *options)
    say(f"the reports are {OUT / 'demo' / '*' / 'report.html'}")
    return 0


def test(options: Sequence[str]) -> int:
    prepare(["test"])
    if "slow" not in options:  # those follow the fast ones, in the same table of times
        TEST_TIMES.unlink(missing_ok=True)
    parallel = ("--numprocesses", "auto", "--dist", "worksteal")
    tier, rest = ((), [word for word in options if word != "--all"]) if "--all" in options else (("-m", "not slow"), options)
    return attempt(PYTHON, "-m", "pytest", *parallel, *tier, *rest, STRAINWAVE_TEST_TIMES=str(TEST_TIMES))


def times(options: Sequence[str]) -> int:
    for path in sorted(BUILD.glob("*/times.txt")):
        ninja = (path.parent / "build.ninja").read_text()
        compiled = {name: seconds for name, seconds in read_times(path).items() if name in ninja}
        print_slowest(f"objects of {path.parent.name}", compiled)
    if TEST_TIMES.exists():
        tests = read_times(TEST_TIMES)
        print_slowest("tests", tests)
        print_slowest("files of tests", summed(tests, lambda name: name.partition("::")[0]))
        print_slowest("rooms of tests", summed(tests, room_of))
    return 0


def summed(seconds: dict[str, float], group_of: Callable[[str], str]) -> dict[str, float]:
    """Returns the sum of the times [s] in each group of names."""
    groups: dict[str, float] = {}
    for name, time in seconds.items():
        groups[group_of(name)] = groups.get(group_of(name), 0.0) + time
    return groups


def room_of(test: str) -> str:
    """Returns the folder of a test that has the name of a room: tests/python/orders, tests/friction, papers."""
    folders = test.partition("::")[0].split("/")[:-1]
    return "/".join(folders[: 3 if folders[1:2] == ["python"] else 2])


def read_times(path: Path) -> dict[str, float]:
    """Returns the processor time of each name in a file of times [s]. The last line of a name counts."""
    lines = (line.split("\t", 1) for line in path.read_text().splitlines())
    return {name: float(seconds) for seconds, name in lines}


def print_slowest(what: str, seconds: dict[str, float]) -> None:
    """Prints the sum and the largest of processor times [s]."""
    print(f"{sum(seconds.values()):8.1f} s  all {len(seconds)} {what}")
    for name in sorted(seconds, key=lambda name: -seconds[name])[:MAX_SLOWEST]:
        print(f"{seconds[name]:8.1f} s  {name}")


def lint(options: Sequence[str]) -> int:
    prepare(["lint", "test", "docs"])  # types of Sphinx, of which the pages' extension is a subclass
    checks: tuple[tuple[str | Path, ...], ...] = (
        (BIN / "ruff", "check", "."),
        (BIN / "ruff", "format", "--check", "."),
        (BIN / "mypy",),
        (BIN / "mypy", "--platform", "win32", "--cache-dir", ".mypy_cache/win32", "python/strainwave"),
        (BIN / "clang-format", "--dry-run", "--Werror", *cplusplus()),
    )
    return max(attempt(*check, *options) for check in checks)


def format(options: Sequence[str]) -> int:
    if not (BIN / "clang-format").exists():  # what is edited need not compile
        prepare(["lint"])
    repairs: tuple[tuple[str | Path, ...], ...] = (
        (BIN / "ruff", "check", "--fix", "."),
        (BIN / "ruff", "format", "."),
        (BIN / "clang-format", "-i", *cplusplus()),
    )
    return max(attempt(*repair, *options) for repair in repairs)


def cplusplus() -> list[Path]:
    """Returns the sources and headers in C++."""
    return [file for folder in ("include", "src", "tests") for file in sorted((ROOT / folder).rglob("*.[ch]pp"))]


# Of each check: the libraries of the compiler, environment variables, and the tests that are worth its time.
CHECKS: dict[str, tuple[Sequence[str], dict[str, str], Sequence[str]]] = {
    "address": (
        ["libasan.so", "libubsan.so"],
        {"ASAN_OPTIONS": "detect_leaks=0"},  # the interpreter's own
        [
            *("tests/laws", "tests/agreement", "tests/published"),
            *(f"tests/python/simulation/test_{of}.py" for of in ("methods", "tolerances", "sticking")),
            "tests/python/analysis",
            *("-k", "not compilers and not cuda and not chatter and not event_is_found"),  # not those that compile themselves
        ],
    ),
    "thread": (
        ["libtsan.so"],
        {"TSAN_OPTIONS": "ignore_noninstrumented_modules=1:halt_on_error=1"},  # interpreter and numpy are not compiled for it
        [
            "tests/python/simulation/test_ensemble.py",
            "-k",
            "not instruction_set and not stopped and not memory",
        ],  # those in this process
    ),
}


def sanitize(options: Sequence[str]) -> int:
    prepare(["test"])
    return max(sanitized(check, options) for check in CHECKS)


def sanitized(check: str, tests: Sequence[str]) -> int:
    """Compiles with a check, whose name is that of a CMake preset, and runs its tests or these."""
    call(BIN / "cmake", "--preset", check)
    call(BIN / "cmake", "--build", "--preset", check)
    site = BUILD / f"sanitize-{check}" / "site"
    shutil.copytree(ROOT / "python" / "strainwave", site / "strainwave", dirs_exist_ok=True)
    packages = next(BIN.parent.glob("lib/python*/site-packages"))
    libraries, variables, worthwhile = CHECKS[check]
    bare = PYTHON, "-S"  # else the interpreter, of each worker too, would find the editable package first
    return attempt(
        *(*bare, "-m", "pytest"),
        *("--dist", "worksteal", "--tx", f"{os.cpu_count()}*popen//python={' '.join(map(str, bare))}"),
        *(tests or worthwhile),
        LD_PRELOAD=":".join(library(name) for name in libraries),
        PYTHONPATH=f"{site}:{packages}",
        STRAINWAVE_IS_IN=str(site),
        STRAINWAVE_KERNELS="off",  # kernels are compiled without the check
        **variables,
    )


def library(name: str) -> str:
    """Path of a library that comes with the compiler."""
    compiler = os.environ.get("CXX", "c++")
    return subprocess.run([compiler, f"-print-file-name={name}"], capture_output=True, text=True).stdout.strip()


def bench(options: Sequence[str]) -> int:
    prepare(extra="bench")
    return attempt(PYTHON, "benchmarks/run.py", *options)


def workbench(options: Sequence[str]) -> int:
    prepare(["workbench"])
    call(PYTHON, "src/workbench.py", BUILD / "workbench", ROOT / "python" / "strainwave" / "workbench" / "workbench.html")
    return 0


def docs(options: Sequence[str]) -> int:
    workbench(())  # a page of the documentation
    prepare(["docs"])
    call(PYTHON, "docs/build.py", OUT / "docs", *options)
    say(f"the documentation begins at {OUT / 'docs' / 'index.html'}")
    return 0


def wheel(options: Sequence[str]) -> int:
    docs(())
    dist, clean = ROOT / "dist", BUILD / "clean"
    shutil.rmtree(dist, ignore_errors=True)
    say("compiling the package")
    call(uv(), "build", "--quiet", "--wheel", *KEPT, "--python", PYTHON, "--out-dir", dist, *options)
    (made,) = dist.glob("*.whl")
    install_into(clean, made)
    complete(made, clean / "bin" / "python")
    install_into(clean, made)
    say(f"trying {made.relative_to(ROOT)}, {made.stat().st_size / 1e6:.1f} MB, where no compiler is found")
    return attempt(clean / "bin" / "python", "-I", ROOT / "tests" / "evidence" / "wheel.py", PATH=str(clean / "bin"))


def install_into(clean: Path, made: Path) -> None:
    """Makes an environment with nothing but a wheel and what it needs."""
    call(uv(), "venv", "--quiet", "--clear", "--python", sys.executable, clean)
    call(uv(), "pip", "install", "--quiet", "--python", clean / "bin" / "python", "--constraints", PINS, made)


def complete(made: Path, python: Path) -> None:
    """Adds documentation and kernels to a wheel. A Python with its package compiles them: only that knows their sources."""
    say("compiling the kernels of the drives of the catalogue for all instruction sets; this takes some minutes")
    unpacked = BUILD / "wheel"
    shutil.rmtree(unpacked, ignore_errors=True)
    call(PYTHON, "-m", "wheel", "unpack", "--dest", unpacked, made)
    (package,) = unpacked.glob("*/strainwave")
    call(python, "-I", "src/ship.py", package / "kernels")
    shutil.copytree(OUT / "docs", package / "docs")
    call(PYTHON, "-m", "wheel", "pack", "--dest-dir", made.parent, package.parent)


def pin(options: Sequence[str]) -> int:
    groups = [word for group in ("build", "docs", "lint", "test", "workbench") for word in ("--group", group)]
    plain = ("--no-header", "--no-annotate", "--no-emit-index-url", "--no-emit-find-links")
    everything = ("--universal", "--upgrade", "--all-extras", *groups)
    return attempt(uv(), "pip", "compile", "--quiet", "pyproject.toml", *everything, *plain, "-o", PINS, *options)


VERBS: dict[str, Callable[[Sequence[str]], int]] = {
    verb.__name__: verb for verb in (demo, test, times, lint, format, sanitize, bench, workbench, docs, wheel, pin)
}


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
