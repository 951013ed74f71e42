"""A drive with strain wave gear as an actuator of Newton, written by strainwave. It needs the packages newton and warp-lang.

`PARAMETERS` lists the numbers of the drive, `OUTPUTS` the outputs of a state. README.md in this folder shows how to use it.
"""

# mypy: ignore-errors

from __future__ import annotations

import ctypes
import json
import math
import sys
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

try:
    import warp as wp
    from newton.actuators import DriveBase
except ImportError as error:
    raise ImportError(f"this actuator needs the packages newton (1.8) and warp-lang (1.19): {error}") from None

_FOLDER = Path(__file__).resolve().parent
_ABOUT: dict[str, Any] = json.loads((_FOLDER / "drive.json").read_text("utf-8"))
_SOURCE = (_FOLDER / "drive.hpp").read_text("utf-8")
_SCALAR = {"double": wp.float64, "float": wp.float32}[_ABOUT["scalar"]]
_NUMBER_TYPE = {"double": np.float64, "float": np.float32}[_ABOUT["scalar"]]
_MEMORY: int = _ABOUT["memory"]
_THREADS_PER_BLOCK = 128  # on a GPU

PARAMETERS: dict[str, dict[str, Any]] = _ABOUT["parameters"]
"""Value, unit and range of each number of the drive, by its path."""
OUTPUTS: tuple[str, ...] = tuple(_ABOUT["outputs"])
"""Names of the rows of `State.outputs`."""

wp.set_module_options(
    {
        "cpu_compiler_flags": "-std=c++20 -march=native",
        "extra_build_options": wp.ModuleBuildOptions(extra_cpu_preamble=_SOURCE),
        "fuse_fp": False,
        "enable_backward": False,
    }
)


@wp.func_native("actuator::measure(found.data);")
def _words_of(found: wp.array(dtype=wp.int32)): ...


@wp.func_native("actuator::prepare(i, numbers.data, prepared.data, problems.data);")
def _prepare_one(
    i: wp.int32,
    numbers: wp.array2d(dtype=_SCALAR),
    prepared: wp.array2d(dtype=wp.float64),
    problems: wp.array(dtype=wp.int32),
): ...


@wp.func_native(
    "actuator::advance(i, count, prepared.data, prepared_count, before.data, after.data, position.data, speed.data, "
    "target_position.data, target_speed.data, feedforward.data, position_place.data, speed_place.data, "
    "target_position_place.data, target_speed_place.data, dt, max_step, torque.data, outputs.data);"
)
def _advance_one(
    i: wp.int32,
    count: wp.int32,
    prepared: wp.array2d(dtype=wp.float64),
    prepared_count: wp.int32,
    before: wp.array2d(dtype=_SCALAR),
    after: wp.array2d(dtype=_SCALAR),
    position: wp.array(dtype=wp.float32),
    speed: wp.array(dtype=wp.float32),
    target_position: wp.array(dtype=wp.float32),
    target_speed: wp.array(dtype=wp.float32),
    feedforward: wp.array(dtype=wp.float32),
    position_place: wp.array(dtype=wp.uint32),
    speed_place: wp.array(dtype=wp.uint32),
    target_position_place: wp.array(dtype=wp.uint32),
    target_speed_place: wp.array(dtype=wp.uint32),
    dt: wp.float64,
    max_step: wp.float64,
    torque: wp.array(dtype=wp.float32),
    outputs: wp.array2d(dtype=wp.float32),
): ...


@wp.kernel(enable_backward=False)
def _words(count: wp.int32, found: wp.array(dtype=wp.int32)):
    _words_of(found)


@wp.kernel(enable_backward=False)
def _prepare(
    count: wp.int32,
    numbers: wp.array2d(dtype=_SCALAR),
    prepared: wp.array2d(dtype=wp.float64),
    problems: wp.array(dtype=wp.int32),
):
    _prepare_one(wp.tid(), numbers, prepared, problems)


@wp.kernel(enable_backward=False)
def _advance(
    count: wp.int32,
    prepared: wp.array2d(dtype=wp.float64),
    prepared_count: wp.int32,
    before: wp.array2d(dtype=_SCALAR),
    after: wp.array2d(dtype=_SCALAR),
    position: wp.array(dtype=wp.float32),
    speed: wp.array(dtype=wp.float32),
    target_position: wp.array(dtype=wp.float32),
    target_speed: wp.array(dtype=wp.float32),
    feedforward: wp.array(dtype=wp.float32),
    position_place: wp.array(dtype=wp.uint32),
    speed_place: wp.array(dtype=wp.uint32),
    target_position_place: wp.array(dtype=wp.uint32),
    target_speed_place: wp.array(dtype=wp.uint32),
    dt: wp.float64,
    max_step: wp.float64,
    torque: wp.array(dtype=wp.float32),
    outputs: wp.array2d(dtype=wp.float32),
):
    _advance_one(
        wp.tid(),
        count,
        prepared,
        prepared_count,
        before,
        after,
        position,
        speed,
        target_position,
        target_speed,
        feedforward,
        position_place,
        speed_place,
        target_position_place,
        target_speed_place,
        dt,
        max_step,
        torque,
        outputs,
    )


@wp.kernel(enable_backward=False)
def _forget(mask: wp.array(dtype=wp.bool), memory: wp.array2d(dtype=_SCALAR)):
    i = wp.tid()
    if mask[i]:
        memory[0, i] = _SCALAR(0.0)


class DriveStrainWave(DriveBase):
    """Controller, motor, sensors and gear of a drive behind a joint, which moves the output shaft and gets the gear's torque.

    A call of `compute` takes each drive from the joint's last instant to the present one, in steps of the simulation.
    """

    @dataclass
    class State(DriveBase.State):
        """Memory and outputs of each gear.

        Attributes:
            memory: numbers of the drives, shape (numbers, gears); a gear whose first number is 0 begins at its joint, untwisted
            outputs: row `OUTPUTS.index("current")` is the current of each gear, and so on, shape (outputs, gears)
        """

        memory: Any = None
        outputs: Any = None

        def reset(self, mask: Any = None) -> None:
            """Let all gears, or those of a mask, begin anew at the angle and the speed of their joints, without torque."""
            if mask is None:
                self.memory.zero_()
            else:
                wp.launch(_forget, dim=len(mask), inputs=[mask, self.memory], device=self.memory.device)

    @classmethod
    def resolve_arguments(cls, args: dict[str, Any]) -> dict[str, Any]:
        """Return the numbers of a gear: those given, by their paths, and the others of the drive.

        Raises:
            ValueError: a number is out of its range
        """
        for path, value in args.items():
            if path in PARAMETERS:
                _check(path, np.asarray(value))
        return {path: args.get(path, entry["value"]) for path, entry in PARAMETERS.items()}

    def __init__(self, **numbers: Any) -> None:
        """Make drives; `finalize` states how many.

        Args:
            numbers: numbers that differ from those of the drive, by path: one, or one for each gear
        """
        self._given = dict(numbers)
        self._next: DriveStrainWave.State | None = None

    def finalize(self, device: Any, num_actuators: int) -> None:
        """Make the drives of `num_actuators` joints on a device."""
        self._device, self._count = wp.get_device(device), num_actuators
        self._code = _Cuda(self._device) if self._device.is_cuda else _Warp(self._device)
        self._next = self.state(num_actuators, self._device)
        self._table = np.empty((num_actuators, len(PARAMETERS)), _NUMBER_TYPE)
        self._table[:] = [entry["value"] for entry in PARAMETERS.values()]
        self.set(self._given)

    def set(self, numbers: Mapping[str, Any]) -> None:
        """Set numbers of the drives, as between episodes; a gear keeps its state.

        Args:
            numbers: one for all gears, or one for each gear, by path

        Raises:
            ValueError: there is no such number, it is out of its range, or numbers of a gear contradict each other
        """
        table, places = self._table.copy(), {path: i for i, path in enumerate(PARAMETERS)}
        for path, given in numbers.items():
            if path not in places:
                raise ValueError(f"{path} is no number of this drive; PARAMETERS lists them")
            values = np.asarray(given.numpy() if isinstance(given, wp.array) else given, np.float64)
            if values.shape not in ((), (1,), (self._count,)):
                raise ValueError(
                    f"{path} has the shape {values.shape}; give one number, or one for each of {self._count} gears"
                )
            _check(path, values)
            exact = PARAMETERS[path]["value"]  # Newton hands numbers on as float32
            table[:, places[path]] = np.where(values.astype(np.float32) == np.float32(exact), exact, values)
        rows = table[:1] if (table == table[0]).all() else table
        prepared, problems = _prepared(self._code, np.ascontiguousarray(rows), self._device)
        if problems.any():
            raise ValueError(
                f"the numbers of gear {int(problems.argmax())} contradict each other; "
                "strainwave states which ones, if a drive gets them there"
            )
        self._table, self._prepared = table, prepared

    def is_stateful(self) -> bool:
        return True

    def is_graphable(self) -> bool:
        return True

    def state(self, num_actuators: int, device: Any) -> DriveStrainWave.State:
        """Return the state of drives that begin at their joints."""
        memory = wp.zeros((_MEMORY, num_actuators), dtype=_SCALAR, device=device)
        return DriveStrainWave.State(memory, wp.zeros((len(OUTPUTS), num_actuators), dtype=wp.float32, device=device))

    def compute(
        self,
        positions: Any,
        velocities: Any,
        target_pos: Any,
        target_vel: Any,
        feedforward: Any,
        pos_indices: Any,
        vel_indices: Any,
        target_pos_indices: Any,
        target_vel_indices: Any,
        forces: Any,
        state: DriveStrainWave.State,
        dt: float,
        device: Any = None,
        *,
        custom_inputs: dict[str, Any] | None = None,
    ) -> None:
        """Take the drives to the present instant of their joints, and write their torques to `forces`."""
        assert self._next is not None
        self._code.launch(
            "advance",
            self._count,
            [
                self._prepared,
                self._prepared.shape[0],
                state.memory,
                self._next.memory,
                positions,
                velocities,
                target_pos,
                target_vel,
                feedforward,
                pos_indices,
                vel_indices,
                target_pos_indices,
                target_vel_indices,
                float(dt),
                float(_ABOUT["step"]),
                forces,
                self._next.outputs,
            ],
        )

    def update_state(self, current_state: DriveBase.State, next_state: DriveStrainWave.State) -> None:
        """Write what `compute` found to the next state."""
        assert self._next is not None
        wp.copy(next_state.memory, self._next.memory)
        wp.copy(next_state.outputs, self._next.outputs)


def _check(path: str, values: np.ndarray) -> None:
    entry = PARAMETERS[path]
    low, high = (math.inf * sign if bound is None else bound for bound, sign in ((entry["low"], -1), (entry["high"], 1)))
    wrong = values[~((values >= low) & (values <= high))]
    if wrong.size:
        raise ValueError(f"{path} = {float(wrong.flat[0]):g} {entry['unit']} must lie within [{low:g}, {high:g}]")


class _Warp:
    """The code of the drive on a CPU, compiled by Warp."""

    def __init__(self, device: Any) -> None:
        self._device = device

    def launch(self, name: str, count: int, arguments: list[Any]) -> None:
        kernel = {"words": _words, "prepare": _prepare, "advance": _advance}[name]
        wp.launch(kernel, dim=count, inputs=[count, *arguments], device=self._device)


class _Cuda:
    """The code of the drive on a GPU: PTX, launched on the stream of Warp. Warp compiles C++17, and the drive is C++20."""

    _functions: dict[Any, dict[str, Any]] = {}  # noqa: RUF012 # of each context, in which the code stays loaded

    def __init__(self, device: Any) -> None:
        self._device = device
        if not (_FOLDER / "drive.ptx").exists():
            raise RuntimeError(
                "this actuator has no code for a GPU; export it where the package nvidia-cuda-nvrtc is installed"
            )
        self._driver = ctypes.CDLL("nvcuda.dll" if sys.platform == "win32" else "libcuda.so.1")
        key = (device.context, str(_FOLDER))
        if key not in self._functions:
            self._functions[key] = self._loaded()
        self._found = self._functions[key]

    def _loaded(self) -> dict[str, Any]:
        with wp.ScopedDevice(self._device):
            code, found = ctypes.c_void_p(), {}
            text = (_FOLDER / "drive.ptx").read_bytes() + b"\0"
            self._call("cuModuleLoadData", ctypes.byref(code), text)
            for name in ("words", "prepare", "advance"):
                found[name] = ctypes.c_void_p()
                self._call("cuModuleGetFunction", ctypes.byref(found[name]), code, f"strainwave_{name}".encode())
            return found

    def _call(self, name: str, *arguments: Any) -> None:
        result = self._driver[name](*arguments)
        if result:
            text = ctypes.c_char_p()
            self._driver.cuGetErrorString(result, ctypes.byref(text))
            raise RuntimeError(f"{name}: {(text.value or b'').decode()} ({result})")

    def launch(self, name: str, count: int, arguments: list[Any]) -> None:
        values = [_as_c(each) for each in [count, *arguments]]
        pointers = (ctypes.c_void_p * len(values))(*(ctypes.cast(ctypes.byref(each), ctypes.c_void_p) for each in values))
        with wp.ScopedDevice(self._device):
            stream = ctypes.c_void_p(self._device.stream.cuda_stream)
            blocks = -(-count // _THREADS_PER_BLOCK)
            self._call("cuLaunchKernel", self._found[name], blocks, 1, 1, _THREADS_PER_BLOCK, 1, 1, 0, stream, pointers, None)


def _as_c(argument: Any) -> Any:
    """Return an argument of a kernel as a C value: an array by its address."""
    if isinstance(argument, int):
        return ctypes.c_int(argument)
    if isinstance(argument, float):
        return ctypes.c_double(argument)
    return ctypes.c_void_p(None if argument is None else argument.ptr)


def _prepared(code: _Warp | _Cuda, numbers: np.ndarray, device: Any) -> tuple[Any, np.ndarray]:
    """Return gears made of their numbers, a row each, and 1 for each gear whose numbers contradict each other."""
    count = len(numbers)
    words = wp.zeros(1, dtype=wp.int32, device=device)
    code.launch("words", 1, [words])
    prepared = wp.zeros((count, int(words.numpy()[0])), dtype=wp.float64, device=device)
    problems = wp.zeros(count, dtype=wp.int32, device=device)
    code.launch("prepare", count, [wp.array(numbers, dtype=_SCALAR, device=device), prepared, problems])
    return prepared, problems.numpy()


__all__ = ["OUTPUTS", "PARAMETERS", "DriveStrainWave"]
