"""FMUs of drives, compiled on this machine, and their difference to the simulation."""

from __future__ import annotations

import io
import math
import platform as machine
import re
import time
import warnings
import zipfile
from collections.abc import Iterable, Iterator, Mapping
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from functools import lru_cache
from html import escape
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
from numpy.typing import NDArray

from strainwave import Drive, _core, arguments
from strainwave.export.exported import Exported, Form, stating_origins
from strainwave.export.fmu.description import Description, build_description, model_description, terminals
from strainwave.export.fmu.source import Variable, has_events, recorded, sources, state_variables, variables
from strainwave.export.host import Command, command_mode, internal_step
from strainwave.files.gear_set import GearSet
from strainwave.files.ratings import drive_of
from strainwave.messages import quoted
from strainwave.native.compilers import FLAGS, Compiler, NoCompilerError, find_compiler, zig_program
from strainwave.native.static_type import in_words
from strainwave.simulation import scenario, signals
from strainwave.simulation.run import Run, simulate
from strainwave.simulation.signals import load_input
from strainwave.tuning.loss import ExportLoss

Array = NDArray[np.float64]
COMMUNICATION_STEPS = 1000  # of the compared run
MIN_DURATION = 0.2  # s, of that run
COMMAND_SIZES = {"rad": 0.1, "rad/s": 1.0}  # size of the command by its unit
OTHER_COMMAND = 0.1  # in other units: V, A, N.m
MAX_COMMAND_FACTOR = 1000.0  # by which the command is raised until the drive moves
COMPARED = ("input_angle", "output_angle", "twist", "torque")
VERSIONS = (2, 3)
MAX_NAME_LENGTH = 60  # characters of a file name
EPOCH = (1980, 1, 1, 0, 0, 0)  # of all files, so that equal drives have equal FMUs
LIBRARIES = "-Wl,--as-needed", "-Wl,-z,defs", "-lm"  # no C++ library, and no symbol without a library
MAX_REMEMBERED = 8  # binaries, of 0.2 MB each


@dataclass(frozen=True)
class Platform:
    """A platform that FMUs have binaries for.

    Attributes:
        folder: of FMI 2.0; that of FMI 3.0 is its name
        suffix: of a shared library
        target: as zig names it
    """

    folder: str
    suffix: str
    target: str


PLATFORMS = {
    "x86_64-linux": Platform("linux64", ".so", "x86_64-linux-gnu.2.17"),
    "aarch64-linux": Platform("aarch64-linux", ".so", "aarch64-linux-gnu.2.17"),
    "x86_64-windows": Platform("win64", ".dll", "x86_64-windows-gnu"),
    "x86_64-darwin": Platform("darwin64", ".dylib", "x86_64-macos"),
    "aarch64-darwin": Platform("aarch64-darwin", ".dylib", "aarch64-macos"),
}
ALIASES = {found.folder: name for name, found in PLATFORMS.items()}


@stating_origins
def fmu(
    drive: Drive | GearSet,
    *,
    version: int = 2,
    platforms: Iterable[str] | None = None,
    model_exchange: bool = False,
    command: Command | None = None,
    step: float | None = None,
    name: str | None = None,
) -> Exported:
    """Return the FMU of a drive for co-simulation: motor, controller, sensors, gear and load as one block.

    The FMU steps the drive by the code that `sw.simulate` runs, with steps of a fixed length, into which it cuts communication
    steps. Inputs are the command, the input of the load and the temperature, each with its rate. Outputs are all outputs of a
    simulation, parameters all numbers of the drive. The FMU always contains its sources.

    Args:
        drive: a drive, or a gear set with one
        version: of FMI, 2 or 3
        platforms: for which it has binaries, of `PLATFORMS`; by default that of this machine; none makes a source FMU, which
            needs no compiler. Platforms other than this machine need the extra `compiler`
        model_exchange: the solver of the tool moves the drive. Co-simulation is recommended: it is faster, and has the steps of
            the simulation
        command: of co-simulation, as long as its rate is 0 or not connected: "held" within a communication step, as a
            staircase, or "followed": it goes on at the rate of the last step; by default followed if it is an angle or a speed
        step: internal step [s]; by default 0.2 ms, or shorter where the drive needs that
        name: of the model and the file; by default that of the gear set

    Returns:
        The file `<name>.fmu` as bytes, and the difference to `sw.simulate` if it could be computed.

    Raises:
        TypeError, ValueError: an argument is not of its kind, or no step follows the bristles of the drive
        ImportError: the package fmpy, which contains the headers of FMI, is not installed
        NoCompilerError: there is no compiler
        CompileError: the compiler reports an error

    >>> import strainwave as sw
    >>> found = sw.export.fmu(sw.GearSet.read("tilt-actuator-lumped"), platforms=())  # doctest: +SKIP
    >>> list(found.files)  # doctest: +SKIP
    ['tilt-actuator-lumped.fmu']
    """
    model, drive = drive, drive_of(drive)
    if version not in VERSIONS:
        raise ValueError(f"version = {version!r} must be 2 or 3, for FMI 2.0 or FMI 3.0")
    targets = own_platform() if platforms is None else [_platform(each) for each in platforms]
    step = internal_step(drive, step)
    name = _file_name(name, model)
    found, states = variables(drive, step), state_variables(drive) if model_exchange else []
    if model_exchange and load_input(drive) == "output_angle":
        raise ValueError("model exchange needs an output shaft that torques move; the load of this drive prescribes its motion")
    mode = command_mode(drive, command)
    files, token = sources(drive, found, version, model_exchange, mode == "followed" and not model_exchange)
    identifier = re.sub(r"\W", "_", f"sw_{name}", flags=re.ASCII)
    about = Description(name, identifier, token, in_words(drive), step, found, states, model_exchange and has_events(drive))
    binaries, seconds = {}, {}
    for each in dict.fromkeys(targets):
        began = time.perf_counter()
        binaries[each] = _binary(each, tuple(sorted(files.items())), version)
        seconds[each] = time.perf_counter() - began
    origins = model.origins if isinstance(model, GearSet) else []
    content = _archive(about, origins, files, binaries, version)
    losses = []
    if not model_exchange and set(own_platform()) <= set(binaries):
        losses = difference_to_simulation(content, drive, found, version, step)
    return Exported(
        f"FMU for {'model exchange' if model_exchange else 'co-simulation'}, FMI {version}.0",
        model.name if isinstance(model, GearSet) else name,
        {f"{name}.fmu": content},
        {"internal_step": (step, "s")},
        tuple(losses),
        tuple(_left_out(drive, model_exchange)),
        tuple(_remarks(about, mode, binaries, seconds, len(content))),
    )


def own_platform() -> list[str]:
    """Return the platform of this machine, or none if FMUs have no binaries for it."""
    name = f"{machine.machine().lower().replace('amd64', 'x86_64').replace('arm64', 'aarch64')}-{machine.system().lower()}"
    return [name] if name in PLATFORMS else []


def _platform(name: str) -> str:
    known = ALIASES.get(name, name) if isinstance(name, str) else name
    if known not in PLATFORMS:
        allowed = ", ".join(PLATFORMS)
        raise ValueError(f"the platform {quoted(str(name))} is not known; give some of {allowed}, or none for a source FMU")
    return known


def _file_name(name: str | None, model: Drive | GearSet) -> str:
    text = arguments.text("name", name) if name is not None else model.name if isinstance(model, GearSet) else "drive"
    found = re.sub(r"[^A-Za-z0-9_-]+", "-", text).strip("-")[:MAX_NAME_LENGTH]
    if not found:
        raise ValueError(f"name = {quoted(text)} must contain letters or digits")
    return found


def _left_out(drive: Drive, model_exchange: bool) -> Iterable[str]:
    if not model_exchange:
        yield "directional derivatives, which model exchange has"
    if _core.parts(drive)[1]:
        yield "counts and options of the models: they are constants of the FMU, as the models themselves are"


def _remarks(
    about: Description, mode: Command, binaries: dict[str, bytes], seconds: dict[str, float], size: int
) -> Iterable[str]:
    if about.states:
        yield "the solver of the tool integrates the rates of sw.simulate; its tolerance determines the error"
    else:
        yield "the FMU steps the drive by the C++ code of sw.simulate"
        yield f"the command is {mode} from step to step, unless command_rate is connected"
    yield f"{size / 1e3:.0f} kB; {_counted(about.variables)}"
    for each, content in binaries.items():
        yield f"binary for {each}: {len(content) / 1e3:.0f} kB, compiled in {seconds[each]:.1f} s"
    if not binaries:
        yield "a source FMU: the tool that imports it compiles its sources by a C++20 compiler"


def _counted(found: list[Variable]) -> str:
    kinds = [each.causality for each in found]
    return ", ".join(f"{kinds.count(kind)} {kind}s" for kind in ("input", "output", "parameter"))


@lru_cache(maxsize=MAX_REMEMBERED)
def _binary(name: str, files: tuple[tuple[str, str], ...], version: int) -> bytes:
    """Return the shared library for a platform; that of both kinds of an FMU is the same.

    Raises:
        NoCompilerError: there is no compiler for it
        CompileError: the compiler reports an error
    """
    compiler, flags, libraries = _compiler(name)
    with TemporaryDirectory() as folder:
        for path, text in files:
            target = Path(folder, path)
            target.parent.mkdir(parents=True, exist_ok=True)
            target.write_text(text, "utf-8")
        source, is_zig = Path(folder, f"fmi{version}.cpp"), compiler.name == "zig c++"
        return compiler.build(source, (*flags, f"-I{folder}"), libraries, keep_cache=is_zig).read_bytes()


def _compiler(name: str) -> tuple[Compiler, tuple[str, ...], tuple[str, ...]]:
    """Return the compiler for a platform with its flags and libraries."""
    instead = "or make a source FMU, which needs no compiler: --platform source, or platforms=() in Python"
    if name in own_platform():
        try:
            compiler = find_compiler()
        except NoCompilerError as error:
            raise NoCompilerError(f"{error}; {instead}") from None
        if compiler.name != "zig c++" and name.endswith("-linux"):
            return compiler, FLAGS, LIBRARIES
    zig = zig_program()
    if zig is None:
        raise NoCompilerError(f"a binary for {name} needs the package ziglang: `pip install 'strainwave[compiler]'`, {instead}")
    target = PLATFORMS[name].target
    compiler = Compiler("zig c++", (zig, "c++", "-target", target), (zig, "cc", "-shared", "-target", target, "-s"), zig)
    flags = tuple(each for each in FLAGS if not (each == "-fPIC" and name.endswith("-windows")))
    return compiler, flags, () if name.endswith("-windows") else ("-lm",)


def _archive(about: Description, origins: list[str], files: dict[str, str], binaries: dict[str, bytes], version: int) -> bytes:
    """Return the bytes of the FMU, a zip archive."""
    contents: dict[str, str | bytes] = {"modelDescription.xml": model_description(about, version)}
    if version == 3:
        contents["terminalsAndIcons/terminalsAndIcons.xml"] = terminals(about)
    contents["documentation/index.html"] = _documentation(about, origins)
    contents |= {f"sources/{path}": text for path, text in sorted(files.items())}
    contents["sources/buildDescription.xml"] = build_description(about, version)
    for name, content in binaries.items():
        found = PLATFORMS[name]
        contents[f"binaries/{found.folder if version == 2 else name}/{about.identifier}{found.suffix}"] = content
    archive = io.BytesIO()
    with zipfile.ZipFile(archive, "w", zipfile.ZIP_DEFLATED) as file:
        for path, text in contents.items():
            file.writestr(zipfile.ZipInfo(path, EPOCH), text, zipfile.ZIP_DEFLATED)
    return archive.getvalue()


def _documentation(about: Description, origins: list[str]) -> str:
    """Return the page that tools show of the FMU."""
    lines = "".join(
        f"<tr><td>{escape(each.name)}</td><td>{each.causality}</td><td>{escape(each.unit)}</td>"
        f"<td>{escape(each.description)}</td></tr>\n"
        for each in about.variables
    )
    stated = "<h2>Origin of the numbers</h2>\n<pre>" + escape("\n".join(origins)) + "</pre>\n" if origins else ""
    return f"""<!DOCTYPE html>
<html lang="en"><head><meta charset="utf-8"><title>{escape(about.name)}</title></head><body>
<h1>{escape(about.name)}</h1>
<p>A drive with strain wave gear, by strainwave: {escape(about.text)}.
Communication steps are cut into internal steps of at most {about.step!r} s.</p>
<table>
<tr><th>name</th><th>causality</th><th>unit</th><th>meaning</th></tr>
{lines}</table>
{stated}</body></html>
"""


def difference_to_simulation(
    content: bytes, drive: Drive, found: list[Variable], version: int, step: float
) -> list[ExportLoss]:
    """Return what an FMU loses against `sw.simulate` over a step of the command, in some of its outputs."""
    interval = max(1, math.ceil(MIN_DURATION / COMMUNICATION_STEPS / step)) * step
    duration = COMMUNICATION_STEPS * interval
    size, run = moving_run(drive, duration, step, interval)
    names = {output.name: name for name, output in recorded(drive, found).items()}
    chosen = [name for name in COMPARED if name in names]
    with instance(content, found, version) as block:
        block.start({"command": size})
        values = [block.get([names[each] for each in chosen])]
        for i in range(COMMUNICATION_STEPS):
            block.step(i * interval, interval)
            values.append(block.get([names[each] for each in chosen]))
    over = f"a step of the command by {size:g} {signals.command_unit(drive)}, {duration:.3g} s"
    losses = []
    for name, column in zip(chosen, np.array(values).T, strict=True):
        size = float(np.abs(run[name]).max())
        if size > 0.0 or column.any():  # an angle that the load holds at 0 compares nothing
            losses.append(ExportLoss.between(name, column - run[name], run.unit(name), size, over))
    return losses


def moving_run(drive: Drive, duration: float, step: float, interval: float) -> tuple[float, Run]:
    """Return the size of a constant command at which a drive moves, and its run; the largest tried if it does not move."""
    size = COMMAND_SIZES.get(signals.command_unit(drive), OTHER_COMMAND)
    largest = MAX_COMMAND_FACTOR * size
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        while True:
            run = simulate(drive, scenario.constant(size, duration), step, sample=interval)
            if run["input_angle"].any() or size >= largest:
                return size, run
            size *= 10.0


class Block:
    """An instance of an FMU in this process."""

    def __init__(self, slave: Any, references: Mapping[str, int], version: int) -> None:
        self.slave, self._references, self._version = slave, references, version

    def start(self, values: Mapping[str, float]) -> None:
        """Initialise with values of inputs and parameters."""
        if self._version == 2:
            self.slave.setupExperiment(startTime=0.0)
        self.set(values)
        self.slave.enterInitializationMode()
        self.slave.exitInitializationMode()

    def set(self, values: Mapping[str, float]) -> None:
        references = [self._references[name] for name in values]
        set_reals = self.slave.setReal if self._version == 2 else self.slave.setFloat64
        set_reals(references, list(values.values()))

    def get(self, names: list[str]) -> list[float]:
        get_reals = self.slave.getReal if self._version == 2 else self.slave.getFloat64
        found: list[float] = get_reals([self._references[name] for name in names])
        return found

    def step(self, time: float, length: float) -> None:
        self.slave.doStep(currentCommunicationPoint=time, communicationStepSize=length)


@contextmanager
def instance(content: bytes, found: list[Variable], version: int) -> Iterator[Block]:
    """Load an FMU, and free it in the end."""
    import fmpy
    from fmpy.fmi2 import FMU2Slave
    from fmpy.fmi3 import FMU3Slave

    with ExitStack() as stack:
        folder = stack.enter_context(TemporaryDirectory())
        fmpy.extract(io.BytesIO(content), unzipdir=folder)
        about = fmpy.read_model_description(Path(folder, "modelDescription.xml").as_posix())
        slave = (FMU2Slave if version == 2 else FMU3Slave)(
            guid=about.guid,
            unzipDirectory=folder,
            modelIdentifier=about.coSimulation.modelIdentifier,
            instanceName="comparison",
        )
        slave.instantiate()
        stack.callback(slave.freeInstance)
        yield Block(slave, {each.name: each.reference for each in found}, version)
        slave.terminate()


FMU = Form(fmu, "Simulink, Dymola, OpenModelica", "an FMU 2.0 or 3.0, or its sources", "fmu.md")
