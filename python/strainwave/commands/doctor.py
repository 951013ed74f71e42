"""The command `strainwave doctor`: what is installed, what is missing, and what for; and the kernels."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated

import typer

from strainwave.commands.help import Verbs
from strainwave.commands.options import Drive

if TYPE_CHECKING:
    from collections.abc import Iterator

    from packaging.requirements import Requirement

    from strainwave.native.folder import Record

LABEL_WIDTH = 16  # characters

# What each extra of the package adds; the extras and their packages are read from the metadata of the installation.
PURPOSES = {
    "bench": "benchmarks against other solvers",
    "compiler": "C++ compiler from the package index (zig)",
    "cuda": "ensembles on a GPU",
    "dask": "data sets on a Dask cluster",
    "fmu": "export of FMUs",
    "formats": "HDF5 and MAT 7.3 files",
    "learn": "classification of faults",
    "newton": "export of actuators of Newton",
    "predictive": "predictive control",
    "studio": "pages of the studio in a browser",
    "video": "videos of the torsion rig",
}
CORE_WORKS = ("simulation", "identification", "reports")


doctor = typer.Typer(cls=Verbs, invoke_without_command=True)


@doctor.callback()
def check(context: typer.Context) -> None:
    """Check the installation, and manage compiled kernels.

    Without a verb: what is installed and what is missing of the core, compilers, kernels, the GPU, documentation and extras.

    Examples:
        strainwave doctor
        strainwave doctor kernels
    """
    if context.invoked_subcommand is None:
        _show_installation()


def _show_installation() -> None:
    import platform
    from importlib.metadata import metadata, version
    from pathlib import Path

    import strainwave
    from strainwave import _core
    from strainwave.commands.docs import MISSING, documentation
    from strainwave.native.folder import reason_without_kernels

    works, fails = list(CORE_WORKS), list[str]()
    print(f"strainwave {version('strainwave')}, Python {platform.python_version()}, {platform.system()} {platform.machine()}")
    _show("package", str(Path(strainwave.__file__).parent))
    _show("core", f"loads; instruction set {_core.instruction_set()}")

    compiler = _compiler()
    _show("C++ compiler", compiler or "none: g++ 12, clang++ 14 or later, or pip install 'strainwave[compiler]'")
    reason = reason_without_kernels()
    (works if compiler and not reason else fails).append(f"kernels of any drive{f' ({reason})' if reason else ''}")
    for label, text in _kernels():
        _show(label, text)

    device = _gpu()
    _show("GPU", device or "none: no NVIDIA driver, or no device")
    found = documentation()
    _show("documentation", f"{found}; strainwave docs opens it" if found else MISSING)
    _show("completion", "strainwave --install-completion, once for a shell")

    print("\nextras")
    base = _problems("")
    for extra in metadata("strainwave").get_all("Provides-Extra") or []:
        problems, purpose = _problems(extra), PURPOSES.get(extra, extra)
        has_all = not problems and (extra != "cuda" or device)
        (works if has_all else fails).append(purpose)
        state = f"missing {', '.join(problems)}: pip install 'strainwave[{extra}]'" if problems else "installed"
        print(f"  {extra:{LABEL_WIDTH - 2}}{purpose}: {state}")
    if base:
        print(f"\nmissing {', '.join(base)}, without which nothing works: install strainwave again")
        works, fails = [], [*works, *fails]
    print(f"\nworks: {', '.join(works) or 'nothing'}")
    print(f"does not work: {', '.join(fails) or 'nothing'}")


def _show(label: str, text: str) -> None:
    print(f"{label:{LABEL_WIDTH}}{text}")


def _compiler() -> str:
    """Return the name and path of the compiler that kernels would be compiled by; empty if there is none."""
    from strainwave.native.compilers import NoCompilerError, find_compiler

    try:
        compiler = find_compiler()
    except NoCompilerError:
        return ""
    return f"{compiler.name}, {compiler.command[0]}"


def _kernels() -> Iterator[tuple[str, str]]:
    """Yield a label and a text for the kernels that the package contains, and for those of this user."""
    from strainwave.native.cache import listing
    from strainwave.native.folder import SHIPPED_KERNELS, cache_folder, reason_without_kernels

    shipped = [path.stat().st_size for path in SHIPPED_KERNELS.glob("*.so")]
    yield "shipped kernels", _counted(shipped, "in the package")
    try:
        folder, records = cache_folder(), listing()
    except (OSError, ValueError) as error:
        yield "cached kernels", f"not used: {error}"
        return
    if folder is None:
        yield "cached kernels", f"not used: {reason_without_kernels()}"
    else:
        yield "cached kernels", _counted([record.size for record in records], f"in {folder}")


def _counted(sizes: list[int], where: str) -> str:
    return f"{len(sizes)}, {sum(sizes) / 1e6:.1f} MB, {where}"


def _gpu() -> str:
    """Return the names of the devices of the NVIDIA driver; empty without a driver or a device."""
    import ctypes
    import sys

    try:
        driver = ctypes.CDLL("nvcuda.dll" if sys.platform == "win32" else "libcuda.so.1")
    except OSError:
        return ""
    count = ctypes.c_int()
    if driver.cuInit(0) or driver.cuDeviceGetCount(ctypes.byref(count)):
        return ""
    names = []
    for device in range(count.value):
        text = ctypes.create_string_buffer(256)
        driver.cuDeviceGetName(text, len(text), device)
        names.append(text.value.decode(errors="replace"))
    return ", ".join(names)


def _problems(extra: str) -> list[str]:
    """Return the packages of an extra, or of those that are always needed, that are missing or too old."""
    return [problem for requirement in _requirements(extra) if (problem := _problem(requirement))]


def _requirements(extra: str) -> list[Requirement]:
    """Return the requirements of an extra; without one, those that are always needed."""
    from importlib.metadata import requires

    from packaging.requirements import Requirement

    every = map(Requirement, requires("strainwave") or [])
    marked = [each for each in every if each.marker is None or each.marker.evaluate({"extra": extra})]
    return [each for each in marked if not extra or (each.marker is not None and not each.marker.evaluate({"extra": ""}))]


def _problem(requirement: Requirement) -> str:
    """Return the name of a package that is missing, with both versions if it is too old; empty if it meets the requirement."""
    from importlib.metadata import PackageNotFoundError, version

    try:
        installed = version(requirement.name)
    except PackageNotFoundError:
        return requirement.name
    if requirement.specifier.contains(installed, prereleases=True):
        return ""
    return f"{requirement.name} {requirement.specifier} ({installed} is installed)"


# ---- Kernels ---------------------------------------------------------------------------------------------------------


AGE_UNITS = {"d": 86_400.0, "h": 3_600.0, "min": 60.0, "s": 1.0}  # s


@doctor.command()
def kernels(
    clear: Annotated[bool, typer.Option("--clear", help="Remove all kernels; those needed again are compiled again.")] = False,
) -> None:
    """List the kernels: code compiled for one drive, which runs faster.

    A kernel gives the same numbers as the code for any drive. The cache contains at most 256 MB; the kernels used least
    recently are removed first. The environment variable STRAINWAVE_KERNELS names another folder for it, or is `off`: then no
    kernel is used. On Windows there are none.

    Examples:
        strainwave doctor kernels
        strainwave doctor kernels --clear
    """
    from strainwave.native import cache
    from strainwave.native.folder import cache_folder, reason_without_kernels
    from strainwave.presentation import counted

    folder = cache_folder()
    if folder is None:
        print(f"no kernel is used: {reason_without_kernels()}")
        return
    if clear:
        print(f"removed {counted(cache.clear(), 'kernel')} from {folder}")
        return
    records = cache.listing()
    print(*_table(records), sep="\n", end="\n\n" if records else "")
    print(f"{counted(len(records), 'kernel')}, {_megabytes(sum(record.size for record in records))}, in {folder}")


@doctor.command("compile")
def compile_command(
    drive: Drive,
    jobs: Annotated[
        list[str] | None,
        typer.Option("--job", metavar="JOB", help="A job of a kernel, as simulate_many; repeat as needed. All, if not given."),
    ] = None,
) -> None:
    """Compile the kernels of a drive ahead of its runs.

    They are compared with the code for any drive: the numbers are the same. Later runs of drives with the same laws use them.
    Long work compiles what it needs by itself.

    Examples:
        strainwave doctor compile robot-joint
        strainwave doctor compile robot-joint --job simulate_many
    """
    from strainwave.files.gear_set import GearSet
    from strainwave.native.compile import compile as compiled
    from strainwave.native.kernels import PUBLIC_JOBS

    print(compiled(GearSet.read(drive), jobs or PUBLIC_JOBS))


def _table(records: list[Record]) -> Iterator[str]:
    """Yield the lines of a table of kernels."""
    import time

    from strainwave.report.listing import aligned

    rows = [
        (each.drive, each.job, _megabytes(each.size), f"{each.seconds:.1f} s by {each.compiler}", _age(time.time() - each.made))
        for each in records
    ]
    return aligned([("drive", "job", "size", "compiled in", "age"), *rows], "<<><>") if rows else iter(())


def _megabytes(size: int) -> str:
    return f"{size / 1e6:.2f} MB"


def _age(seconds: float) -> str:
    """Return a time in the largest unit of which it has one."""
    unit = next((name for name, length in AGE_UNITS.items() if seconds >= length), "s")
    return f"{seconds / AGE_UNITS[unit]:.0f} {unit}"
