"""Every public function and method, called with what it is not made for."""

from __future__ import annotations

import ast
import inspect
import pickle
from collections.abc import Callable, Iterator, Mapping
from datetime import date
from decimal import Decimal
from fractions import Fraction
from functools import cache, partial
from importlib import import_module
from pathlib import Path
from types import ModuleType
from typing import Any, NamedTuple

import numpy as np
import strainwave as sw
from numpy.random import Generator
from strainwave.files.entries import Quantity
from strainwave.identification.experiments.drive_log import DriveLog
from strainwave.identification.experiments.friction_table import FrictionTable
from strainwave.identification.experiments.torsion_loop import TorsionLoop

from tests.fuzz.laws import Case, described, finite
from tests.fuzz.mutation import picked
from tests.support.strategies import made as usual_of

MODULES = (
    *("files.units", "files.gear_set", "files.entries", "files.recording", "parameters", "simulation.scenario"),
    *(f"identification.experiments.{name}" for name in ("experiment", "friction_table", "torsion_loop", "drive_log")),
)
LAWS = ("friction", "hysteresis", "kinematic_error", "stiffness")
METHODS = ("__getitem__", "__contains__", "__eq__", "__add__", "__sub__", "__mul__", "__rmul__")
# Results, which only the package makes; what it says to itself; and what has a kind of its own.
RESULTS = (
    "Agreement",
    "BearingOrders",
    "Bootstrap",
    "Combination",
    "Derivatives",
    "DetectionLimit",
    "Difference",
    "Ensemble",
    "ExperimentPlan",
    "Fit",
    "FrequencyResponse",
    "Identified",
    "Linearisation",
    "MeasuredCommand",
    "OrderLine",
    "Orders",
    "Profile",
    "RatingCheck",
    "Ripple",
    "Run",
    "Observation",
    "TransmissionError",
)
NOT_CALLED = {
    *(f"sw.{name}" for name in (*RESULTS, "EnsembleWarning", "PassivityWarning")),
    *(f"files.entries.{name}" for name in ("check_line", "quantity_of", "Form", "schema", "entry_schema")),
    *(f"files.entries.{name}" for name in ("elements", "checked", "inline", "origin_lines", "numbers_of")),
    "files.gear_set.spelled",
    "sw.compensate",  # compiles a kernel, and searches for minutes
    "analysis.torsion_loop.series_compliance",
    *(f"parameters.{name}" for name in ("unknown", "every", "parameters", "Parameter", "replaced", "plain")),
    *(f"identification.experiments.experiment.{name}" for name in ("Experiment", "Nuisance", "sensible", "changing")),
    *(f"identification.experiments.friction_table.{name}" for name in ("FrictionTable", "with_load")),
    *(f"identification.experiments.torsion_loop.{name}" for name in ("TorsionLoop", "at_input")),
    *(f"identification.experiments.drive_log.{name}" for name in ("DriveLog", "DrivenLog", "driven")),
    *(f"drive_log.DriveLog.{name}" for name in ("beginning", "stands_still")),
    *(f"{name}.predict" for name in ("drive_log.DriveLog", "friction_table.FrictionTable", "torsion_loop.TorsionLoop")),
    "torsion_loop.TorsionLoop.path",
    "fit.Fit.rms",
    "simulation.scenario.Wave",
    *("state.State.of", "state.State.get", "state.State.__getitem__"),  # which say of other names what any mapping says
    *(f"files.recording.{name}" for name in ("envelope", "check_recording")),
}

OF_NUMBERS_ALONE = ("typeset",)  # modules that write numbers as texts, for papers; they check nothing

SCALARS = (
    float("nan"), float("inf"), float("-inf"), 0.0, -0.0, -1.0, 5e-324, -5e-324, 1e-320, 1e-310, 1e-300, 1e-160, 1e-20, 1e16,
    1e22, 1e160, -1e160, 1e200, 1e300, -1e300, 1.7976931348623157e308, 0, -1, 2**31, 2**53 + 1, 2**63, 2**64, -(2**63) - 1,
    10**400, np.float64("nan"), np.float32(3e38), np.int64(-1), np.uint8(255), Fraction(1, 3), True,
)  # fmt: skip


class _Unknown:
    """In place of an argument that is right: none is known, but there is a default, or the argument is a field."""


UNKNOWN = _Unknown()


class _NoText:
    def __repr__(self) -> str:
        raise RuntimeError("no text")


def _junk() -> tuple[Any, ...]:
    """What is no argument of anything, or rarely."""
    drive = sw.Drive()
    return (
        *SCALARS, None, 1j, "", "x", "a\nb\x1b[31m", "\ud800", "ü" * 3000, b"bytes", [], [1.0], [float("nan")], ["a"],
        [[1.0, 2.0]], [[1.0], [2.0, 3.0]], [None], {}, {"a": 1}, {1: 2}, {"load.inertia": "x"}, (), (1.0, 2.0), object(), len,
        int, sw, iter([1.0]), range(3), {1.0}, {"a"}, slice(None), Ellipsis, NotImplemented, ValueError("x"), date(2020, 1, 1),
        Decimal("NaN"), Decimal("1"), np.array([]), np.array(1.0), np.zeros((2, 2)), np.zeros((100, 100)), np.array(["a"]),
        np.array([None]), np.array([1j]), np.array(["2020-01-01"], dtype="datetime64[D]"),
        np.ma.masked_array([1.0, 2.0], mask=[True, False]), np.array([1e300, -1e300]), np.array([np.nan]),
        np.zeros(3, dtype=bool), np.zeros(2, dtype=[("a", float)]), np.arange(5)[::-1], np.arange(4.0)[::2], Path("nothing"),
        Path("a\x00b"), "a" * 5000, _NoText(), drive, drive.gear, drive.rest(), sw.scenario.constant(1.0, 0.01),
        sw.scenario.constant(1.0, 1e-30), usual_of(sw.friction.LuGre, viscous=5e-5), sw.friction.LuGre,
        sw.Recording({"time": [0.0, 1.0]}, {"time": "s"}),
    )  # fmt: skip


@cache
def valid() -> Mapping[str, Any]:
    """An argument that is right, by the name of the argument or of function and argument."""
    drive = sw.Drive(load=sw.loads.Inertia(inertia=0.1))
    command = sw.scenario.constant(1.0, 0.01)
    recording = sw.Recording({"time": [0.0, 1.0], "speed": [1.0, 2.0]}, {"time": "s", "speed": "rad/s"})
    return {
        "drive": drive, "command": command, "parameters": ["load.inertia"], "dt": 1e-3, "sample": 2e-3, "load_torque": 0.1,
        "temperature": 300.0, "start": 0.0, "state": drive.rest(), "method": "exponential", "progress": False,
        "rtol": 1e-6, "atol": 1e-9, "max_steps": 500, "record": ["torque"], "threads": 1, "folder": "members",
        "frequency": 50.0, "amplitude": 0.1, "input": "command", "tolerance": 1e-2, "max_periods": 3, "command_rate": 0.0,
        "duration": 1.0, "value": 1.0, "rate": 1.0, "phase": 0.0, "offset": 0.0, "start_frequency": 1.0, "stop_frequency": 2.0,
        "period": 0.1, "width": 0.05, "time": [0.0, 0.5, 1.0], "unit": "s", "to": "min", "values": [1.0, 2.0], "name": "speed",
        "names": ["speed"], "stop": 1.0, "columns": {"time": [0.0, 1.0]}, "units": {"time": "s"}, "title": "run",
        "path": "file.toml", "name_or_path": "hfuc-25-100", "source": "assumed", "spread": 0.1, "uncertainty": 0.1,
        "model": drive.gear, "gear": drive.gear, "sources": {}, "number": 0, "ratings": {}, "motor": None, "control": None,
        "load": None, "maker": "", "note": "", "against": "time", "output": "torque", "recording": recording,
        "free": ["friction_input.viscous"], "channels": None, "training": None, "loss": "linear",
        "twist": [0.0, 1e-3, -1e-3], "speed": 1.0, "angle": [0.0, 1.0], "held_out": False, "x": [1.0, 2.0], "y": [1.0, 2.0],
        "stretches": 10, "changes": {}, "factor": 2.0, "other": command, "level": [0.0], "slope": [0.0], "waves": (),
        "sweep": 0.0, "which": ("torque", "load.inertia"), "sense": 1.0, "deflection": 0.0, "end": drive.rest(),
        "history": "cyclic", "torque_zero": 0.0, "twist_zero": 0.0, "nuisances": np.zeros(2), "numbers": [0],
        "measured": np.zeros((1, 3)), "failures": {}, "damping": 1.0, "step.start": 0.0, "ramp.start": 0.0,
        "pulse_train.start": 0.0, "between.start": 0.0,
        "Scenario.start": [0.0], "simulate_many.parameters": {"load.inertia": [0.1, 0.2]},
        "simulate_to.parameters": {"load.inertia": [0.1, 0.2]},
        "__getitem__.name": "time", "to_csv.path": "file.csv", "value.time": [0.5], "rate.time": 0.5,
        "value_before.time": [0.5], "to_parquet.path": "file.parquet",
        "fit.recording": friction_table(), "Quantity.unit": "N.m", "convert.unit": "s", "recording.unit": "V",
        "recording.dt": 0.1, "save.name": "mine", "of.name": "mine", "GearSet.name": "mine", "read.path": "nothing.csv",
        "of.recording": friction_table(), "with_column.values": [1.0, 2.0], "check.unit": "N.m",
        "Recording.units": {"time": "s"}, "frequency_response.amplitude": 0.5, "of.drive": drive,
        "predict.model": drive.gear, "linearise.state": None,
        "FrictionTable.speed": np.array([1.0, 2.0]), "FrictionTable.torque": np.array([1.0, 2.0]), "Scenario.duration": 1.0,
        "TorsionLoop.twist": np.array([0.0, 1e-3, -1e-3, 0.0]), "TorsionLoop.torque": np.array([0.0, 1.0, -1.0, 0.0]),
        "spring": 100.0, "highest": 3, "steady.load": 0.0, "steady.angle": 0.0, "hold.load": 0.0, "hold.angle": 0.0,
        "trace.angle": 0.0, "trace.load": 0.0, "trace.speed": [1.0, 2.0, 1.0], "trace.state": UNKNOWN,
        "advance.state": UNKNOWN, "work.state": UNKNOWN, "stored.state": UNKNOWN, "error.torque": 0.0, "slope.torque": 0.0,
        "step.command": 0.1, "step.load_torque": 0.0, "step.dt": 1e-4, "torque.twist": [0.0, 1e-3], "sine.frequency": 1.0,
        "Recording.columns": {"time": [0.0, 1.0]}, "frequency_response.initial": None, "compare.first": recording,
        "compare.second": recording, "inputs": {"load_torque": 0.1}, "initial": {"output_angle": 0.1},
        "read.drive": drive, "save.drive": drive, "ScenarioFile.save.path": "file.toml",
        "orders.recording": turning(), "order_spectrum.recording": turning(), "column": "torque", "order": [2.0],
        "orders.angle": "input_angle", "order_spectrum.angle": "input_angle", "balls": 9, "ball_diameter": 1.0,
        "pitch_diameter": 10.0, "contact_angle": 0.1, "outer_speed": 0.0, "found": fitted(), "confidence": 0.95, "draws": 20,
        "seed": 0, "max_relative_sigma": 0.1, "profile.path": "friction_input.viscous",
        "interval.path": "friction_input.viscous", "files": ["nothing.csv"], "ripple.recording": turning(), "ratio": 50.0,
        "order_lines.recording": turning(), "orders": [2.0], "load_column": None, "false_alarm": 1e-3,
        "detection_limit.order": 2.0, "detection_limit.speed": 20.0, "sample_rate": 500.0, "noise": 0.1,
    }  # fmt: skip


def friction_table() -> sw.Recording:
    speed = np.array([1.0, 2.0, 5.0, 10.0, 20.0, 50.0])
    return sw.Recording({"speed": speed, "torque": 0.02 + 3e-4 * speed}, {"speed": "rad/s", "torque": "N.m"})


def fitted() -> sw.identification.Fit:
    return sw.fit(sw.Gear(), friction_table(), ["friction_input.viscous"])


def turning() -> sw.Recording:
    angle = np.linspace(0.0, 100.0, 1000)
    return sw.Recording({"input_angle": angle, "torque": np.sin(2.0 * angle)}, {"input_angle": "rad", "torque": "N.m"})


@cache
def instances() -> tuple[Any, ...]:
    """A value of every public class, whose methods are then called."""
    drive, command, table = valid()["drive"], valid()["command"], friction_table()
    run = sw.simulate(drive, command, 1e-3)
    loop = TorsionLoop(np.array([0.0, 1e-3, -1e-3, 0.0]), np.array([0.0, 1.0, -1.0, 0.0]))
    models = [usual_of(kind) for family in families().values() for kind in family.values()]
    return (
        *models, drive, drive.gear, drive.rest(), command, run,
        valid()["recording"], sw.linearise(drive), sw.simulation.ScenarioFile(command), *sw.compare(run, run)[:1],
        sw.simulate_many(drive, command, {"load.inertia": [0.1, 0.2]}, 1e-3),
        sw.analysis.derivatives(drive, command, ["load.inertia"], 1e-3), sw.analysis.frequency_response(drive, 50.0, 0.5),
        fitted(), sw.identification.profile(fitted(), "friction_input.viscous"), sw.identification.bootstrap(fitted(), 20),
        *sw.identification.combinations(fitted()),
        sw.GearSet.read("hfuc-25-100"),
        Quantity(value=1.0, unit="N.m", source="assumed"), FrictionTable.of(table), loop,
        DriveLog.of(run.select(["time", "command", "output_angle"]), drive),
    )  # fmt: skip


def families() -> Mapping[str, Mapping[str, Any]]:
    from strainwave import _core

    return _core.families


class Target(NamedTuple):
    """Something to call, with the names of its arguments; those that need not be given have a default."""

    name: str
    call: Callable[..., Any]
    arguments: tuple[inspect.Parameter, ...]


@cache
def targets() -> tuple[Target, ...]:
    """All that users can call, in one order."""
    functions = {name: each for name, each in _public() if callable(each)}
    methods = {
        f"{type(one).__module__.rpartition('.')[2]}.{type(one).__name__}.{name}": getattr(one, name)
        for one in instances()
        for name in dir(one)
        if (not name.startswith("_") or name in METHODS) and callable(getattr(type(one), name, None))
    }
    found = (functions | methods).items()
    return tuple(Target(name, call, _arguments(call)) for name, call in sorted(found) if name not in NOT_CALLED)


def _public() -> Iterator[tuple[str, Any]]:
    for name in sw.__all__:
        each = getattr(sw, name)
        if isinstance(each, ModuleType):
            yield from () if name in OF_NUMBERS_ALONE else _own(name, each)
        else:
            yield f"sw.{name}", each
    for path in MODULES:
        yield from _own(path, import_module(f"strainwave.{path}"))


def _own(name: str, module: ModuleType) -> Iterator[tuple[str, Any]]:
    for public, each in vars(module).items():
        if not public.startswith("_") and getattr(each, "__module__", None) == module.__name__:
            yield f"{name}.{public}", each


def _arguments(call: Any) -> tuple[inspect.Parameter, ...]:
    """Those that may be junk: a progress bar is to be seen."""
    try:
        found = inspect.signature(call).parameters.values()
    except ValueError:
        found = _compiled_arguments(call)
    return tuple(each for each in found if each.name != "progress")


def _compiled_arguments(call: Any) -> Iterator[inspect.Parameter]:
    """Those of compiled code, which its signature in words tells."""
    fields = [field["name"] for field in getattr(call, "fields", ())] if isinstance(call, type) else []
    for field in fields:
        yield inspect.Parameter(field, inspect.Parameter.KEYWORD_ONLY, default=None)
    signature = getattr(call, "__nb_signature__", None)
    if fields or not signature:
        return
    function = ast.parse(f"{signature[-1][0]}: ...".replace("\\", "")).body[0]
    assert isinstance(function, ast.FunctionDef)
    given = function.args
    positional = given.posonlyargs + given.args
    defaults = [None] * (len(positional) - len(given.defaults)) + given.defaults
    for each, default in (*zip(positional, defaults, strict=True), *zip(given.kwonlyargs, given.kw_defaults, strict=True)):
        kind = inspect.Parameter.KEYWORD_ONLY if each in given.kwonlyargs else inspect.Parameter.POSITIONAL_OR_KEYWORD
        if each.arg != "self":
            yield inspect.Parameter(each.arg, kind, default=inspect.Parameter.empty if default is None else default)


def calls_case(random: Generator, folder: Path) -> Case:
    """One call with one or two arguments that are junk, rarely with all of them."""
    target = picked(random, targets())
    junk = _junk()
    wanted = len(target.arguments) if random.random() < 0.1 else int(random.integers(0, 3))
    return _called(target, random, {argument: picked(random, junk) for argument in _some(target, wanted, random)})


def scalars_case(random: Generator, folder: Path) -> Case:
    """One call with one or two numbers that are extreme or none."""
    target, numeric = picked(random, numeric_targets())
    chosen = {picked(random, numeric) for _ in range(random.integers(1, 3))}
    hostile = {name: _among(picked(random, SCALARS), _right(target, name), random) for name in sorted(chosen)}
    return _called(target, random, hostile)


@cache
def numeric_targets() -> tuple[tuple[Target, tuple[str, ...]], ...]:
    """What can be called with numbers, and the names of those."""
    found = ((one, tuple(each.name for each in one.arguments if _is_number(one, each))) for one in targets())
    return tuple((target, names) for target, names in found if names)


def _is_number(target: Target, argument: inspect.Parameter) -> bool:
    right = _right(target, argument.name)
    is_one = isinstance(right, float | int | np.ndarray) and not isinstance(right, bool)
    return right is UNKNOWN or is_one or _is_series(right)


def _is_series(right: Any) -> bool:
    return isinstance(right, list) and bool(right) and isinstance(right[0], float)


def _among(hostile: Any, right: Any, random: Generator) -> Any:
    """A number in place of one of a series, if that is what is asked for."""
    if not _is_series(right) and not (isinstance(right, np.ndarray) and right.size):
        return hostile
    values = list(np.ravel(right))
    values[int(random.integers(len(values)))] = hostile
    return values


def _right(target: Target, argument: str) -> Any:
    """What is right for an argument."""
    *_, owner, function = ("", *target.name.split("."))
    for key in (f"{function}.{argument}", f"{owner}.{argument}", argument):
        if key in valid():
            return valid()[key]
    return UNKNOWN


def _some(target: Target, count: int, random: Generator) -> list[str]:
    names = [each.name for each in target.arguments]
    return sorted(random.permutation(names)[:count].tolist()) if names else []


def _called(target: Target, random: Generator, odd: Mapping[str, Any]) -> Case:
    positional: list[Any] = []
    named: dict[str, Any] = {}
    for argument in target.arguments:
        given = odd.get(argument.name, _right(target, argument.name))
        needed = argument.default is inspect.Parameter.empty
        if given is UNKNOWN or (argument.name not in odd and not needed and random.random() < 0.7):
            continue
        match argument.kind:
            case inspect.Parameter.VAR_KEYWORD:
                named |= given if isinstance(given, dict) and all(isinstance(key, str) for key in given) else {"x": given}
            case inspect.Parameter.VAR_POSITIONAL:
                positional.append(given)
            case inspect.Parameter.KEYWORD_ONLY:
                named[argument.name] = given
            case _ if argument.kind is inspect.Parameter.POSITIONAL_ONLY or not named:
                positional.append(given)
            case _:
                named[argument.name] = given
    # what an operator stands for is never called with a name
    extra = {"unheard_of": 1} if random.random() < 0.02 and not target.name.endswith("__") else {}
    words = ", ".join([*map(described, positional), *(f"{name}={described(each)}" for name, each in named.items())])
    is_law = target.name.partition(".")[0] in LAWS
    return Case(f"{target.name}({words})", partial(target.call, *positional, **named, **extra), check_law if is_law else check)


def check_law(result: Any) -> None:
    """A law may answer with an infinity, where the true value is too large for a number."""
    if isinstance(result, float | np.ndarray):
        assert not np.isnan(result).any(), f"not-a-number: {described(result)}"
    else:
        check(result)


def check(result: Any) -> None:
    """What came back has text, finite numbers, and is the same when it has been pickled."""
    repr(result)
    assert finite(result), f"a result that is not finite: {described(result)}"
    if isinstance(result, sw.Recording | sw.scenario.Scenario | sw.GearSet | Quantity) or isinstance(
        getattr(result, "fields", None), tuple
    ):
        assert pickle.loads(pickle.dumps(result)) == result, "pickled, it comes back as another"
