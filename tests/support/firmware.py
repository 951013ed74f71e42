"""Parts of a drive as other programs meet them: written as firmware, compiled, loaded, and called from Python."""

from __future__ import annotations

import ctypes
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import strainwave as sw
from numpy.typing import NDArray
from strainwave.export.firmware import FLAGS, Firmware
from strainwave.native.static_type import Scalar
from strainwave.simulation.controller import Observation

from tests.support import cplusplus
from tests.support.cplusplus import compiler

Array = NDArray[np.float64]
BAD = (np.nan, np.inf, -np.inf, 3e38, -3e38)
STRICT = ("-Wall", "-Wextra", "-Wpedantic", "-Wconversion", "-Wsign-conversion", "-Wshadow", "-Werror")
NO_LIBRARY = ("-nostdinc++",)  # nor its headers
# A loop in C over many steps.
LOOP = """#include "{name}.h"
void {name}_run(const {name}_inputs* in, {name}_outputs* out, {name}_state* state, long count);
void {name}_run(const {name}_inputs* in, {name}_outputs* out, {name}_state* state, long count) {{
    long k;
    for (k = 0; k < count; ++k) out[k] = {name}_step(state, &in[k]);
}}
"""


def written(drive: Any, folder: Path, scalar: Scalar, name: str = "controller", **options: Any) -> Firmware:
    """Write a part of a drive as firmware, with a loop over its steps in C."""
    firmware = sw.export.firmware(drive, folder, name=name, scalar=scalar, **options)
    (folder / f"{name}_run.c").write_text(LOOP.format(name=name))
    return firmware


def compiled(folder: Path, firmware: Sequence[Firmware], *options: str) -> None:
    """Compile firmware to all.o, as C++20 without its standard library."""
    (folder / "all.cpp").write_text("".join(f'#include "{each.source.name}"\n' for each in firmware))
    command = [*compiler("g++"), *FLAGS.split(), *STRICT, *NO_LIBRARY, *options, "-c", "all.cpp"]
    assert cplusplus.compiled(folder, *command) == (0, "")


def library(folder: Path, firmware: Sequence[Firmware], *options: str) -> ctypes.CDLL:
    """Compile firmware with its loops, which are in C99, to a shared library, and load it."""
    compiled(folder, firmware, *options, "-fPIC")
    (folder / "loops.c").write_text("".join(f'#include "{each.source.stem}_run.c"\n' for each in firmware))
    c = [*compiler("gcc"), "-std=c99", "-pedantic", *STRICT, "-fPIC", "-c", "loops.c"]
    for command in (c, [*compiler("gcc"), "-shared", "-o", "all.so", "all.o", "loops.o", "-lm"]):
        assert cplusplus.compiled(folder, *command) == (0, "")
    return ctypes.CDLL(str(folder / "all.so"))


class Loaded:
    """Firmware in a library: called step by step with what a controller sees, or over all inputs of a run."""

    def __init__(self, firmware: Firmware, loaded: ctypes.CDLL) -> None:
        name = firmware.header.stem
        self.firmware = firmware
        self.number: Any = ctypes.c_double if firmware.scalar == "double" else ctypes.c_float
        outputs = type("Outputs", (ctypes.Structure,), {"_fields_": [(each, self.number) for each in firmware.outputs]})
        self._start, self._step, self._run = (getattr(loaded, f"{name}_{verb}") for verb in ("start", "step", "run"))
        self._step.restype = outputs
        self.memory = (self.number * len(firmware.state))()
        self.start()

    def start(self) -> None:
        self._start(self.memory)

    def __call__(self, seen: Observation) -> float:
        """Return the output of a controller."""
        out = self._step(self.memory, (self.number * len(self.firmware.inputs))(*seen[1:]))
        return float(getattr(out, self.firmware.outputs[0]))

    def run(self, **inputs: Any) -> dict[str, Array]:
        """Return the outputs of steps from the start; inputs that are left out are 0."""
        self.start()
        return self.go_on(**inputs)

    def go_on(self, **inputs: Any) -> dict[str, Array]:
        """Return the outputs of steps from the state of now."""
        count = max(np.size(each) for each in inputs.values())
        rows = np.zeros((count, len(self.firmware.inputs)), dtype := np.dtype(self.number))
        for name, values in inputs.items():
            rows[:, self.firmware.inputs.index(name)] = values
        out = np.empty((count, len(self.firmware.outputs)), dtype)
        places = (each.ctypes.data_as(ctypes.c_void_p) for each in (rows, out))
        self._run(*places, self.memory, ctypes.c_long(count))
        return {name: column.astype(float) for name, column in zip(self.firmware.outputs, out.T, strict=True)}

    @property
    def state(self) -> dict[str, float]:
        return dict(zip(self.firmware.state, self.memory, strict=True))


def run_with(controller: Any, drive: sw.Drive, command: Any) -> sw.Run:
    """A run of a drive with its sampled controller replaced by a function."""
    sampled = drive.control
    plant = drive.replace(control=sw.control.OpenLoop())
    return sw.simulate_controlled(plant, controller, command, period=sampled.period, delay=sampled.delay, sample=sampled.period)


def check_bad_samples(firmware: Loaded, inputs: dict[str, Array], limit: float = np.inf) -> None:
    """Check that a bad input is held and counted: every call returns what it returns for the last good value."""
    count, outputs = len(next(iter(inputs.values()))), dict[str, Array]()
    for place, (name, bad) in enumerate((name, bad) for name in inputs for bad in BAD):
        k = 1 + place % (count - 2)

        def with_sample(value: float, name: str = name, k: int = k) -> dict[str, Array]:
            return firmware.run(**inputs | {name: np.concatenate((inputs[name][:k], [value], inputs[name][k + 1 :]))})

        held = with_sample(inputs[name][k - 1])
        assert firmware.state["bad_samples"] == 0
        outputs = with_sample(bad)
        assert firmware.state["bad_samples"] == 1
        for output, values in outputs.items():
            assert np.array_equal(values, held[output]), (name, bad, output)
            assert np.abs(values).max() <= limit
    assert any(np.ptp(values) > 0.0 for values in outputs.values())
