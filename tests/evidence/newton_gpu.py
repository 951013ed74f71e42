"""The code that an actuator of Newton has for GPUs, on a GPU and without Warp.

    python -m tests.evidence.newton_gpu prepare FOLDER   export drives, and store what native code finds; needs no GPU
    python3 tests/evidence/newton_gpu.py run FOLDER      run them on this machine's GPU; needs Python, a driver and this file

Each drive follows the motion of `tests.evidence.newton_agreement`. The difference from native code is stated for each output,
over its largest value. Then many gears are stepped, with equal and with own numbers.
"""

from __future__ import annotations

import array
import ctypes
import json
import sys
import time
from pathlib import Path

THREADS = 128  # of a block
GEARS = (4096, 65536)
TIMED_STEPS = 50  # of Newton
COMPARED_STEPS = 2000  # of Newton, 2 s
JOINT_STEP = 1e-3  # s
MAX_ERROR = {"double": 1e-5, "float": 1e-3}  # relative: a GPU has other elementary functions, and they are coarser in float
DRIVES = {"catalogue joint": "joint", "reference": "reference"}
COMPARED = ("torque", "load_torque", "twist", "input_angle", "input_speed", "current")


def prepare(folder: Path) -> None:
    """Write each drive in each precision: package, joint, and outputs of native code."""
    from strainwave.export.newton import build
    from strainwave.native.static_type import SCALARS

    from tests import newton_agreement as agreement

    for name, short in DRIVES.items():
        for scalar in SCALARS:
            target = folder / f"{short}_{scalar}"
            target.mkdir(parents=True, exist_ok=True)
            follower, _ = agreement.follower(agreement.drives()[name], scalar, target)
            (target / "drive.ptx").write_text(build.ptx((target / "drive.hpp").read_text()))
            outputs = follower.by_compiler()
            joint = follower.joint[:COMPARED_STEPS]
            wanted = {key: values[:COMPARED_STEPS].tolist() for key, values in outputs.items() if key in COMPARED}
            (target / "case.json").write_text(json.dumps({"joint": joint.tolist(), "wanted": wanted}))
            print(f"wrote {target}", flush=True)


class Gpu:
    """The driver of the first GPU."""

    def __init__(self) -> None:
        self.driver = ctypes.CDLL("libcuda.so.1")
        self.call("cuInit", 0)
        device, context, name = ctypes.c_int(), ctypes.c_void_p(), ctypes.create_string_buffer(100)
        self.call("cuDeviceGet", ctypes.byref(device), 0)
        self.call("cuDeviceGetName", name, 100, device)
        self.name = name.value.decode()
        self.call("cuDevicePrimaryCtxRetain", ctypes.byref(context), device)
        self.call("cuCtxSetCurrent", context)

    def call(self, name: str, *arguments: object) -> None:
        if result := self.driver[name](*arguments):
            text = ctypes.c_char_p()
            self.driver.cuGetErrorString(result, ctypes.byref(text))
            raise RuntimeError(f"{name}: {(text.value or b'').decode()} ({result})")

    def load(self, code: bytes) -> ctypes.c_void_p:
        module = ctypes.c_void_p()
        self.call("cuModuleLoadData", ctypes.byref(module), code + b"\0")
        return module

    def kernel(self, module: ctypes.c_void_p, name: str) -> ctypes.c_void_p:
        found = ctypes.c_void_p()
        self.call("cuModuleGetFunction", ctypes.byref(found), module, name.encode())
        return found

    def allocate(self, size: int) -> ctypes.c_void_p:
        place = ctypes.c_void_p()
        self.call("cuMemAlloc_v2", ctypes.byref(place), ctypes.c_size_t(size))
        self.call("cuMemsetD8_v2", place, ctypes.c_ubyte(0), ctypes.c_size_t(size))
        return place

    def put(self, place: ctypes.c_void_p, values: array.array) -> None:
        self.call(
            "cuMemcpyHtoD_v2", place, ctypes.c_void_p(values.buffer_info()[0]), ctypes.c_size_t(len(values) * values.itemsize)
        )

    def get(self, place: ctypes.c_void_p, kind: str, count: int) -> array.array:
        values = array.array(kind, bytes(count * array.array(kind).itemsize))
        self.call("cuMemcpyDtoH_v2", ctypes.c_void_p(values.buffer_info()[0]), place, ctypes.c_size_t(count * values.itemsize))
        return values

    def launch(self, kernel: ctypes.c_void_p, count: int, *arguments: object) -> None:
        values = [ctypes.c_int(count), *arguments]
        pointers = (ctypes.c_void_p * len(values))(*(ctypes.cast(ctypes.byref(each), ctypes.c_void_p) for each in values))
        self.call("cuLaunchKernel", kernel, -(-count // THREADS), 1, 1, THREADS, 1, 1, 0, None, pointers, None)

    def wait(self) -> None:
        self.call("cuCtxSynchronize")


class Actuators:
    """Gears of a package on a GPU."""

    def __init__(self, gpu: Gpu, folder: Path, module: ctypes.c_void_p, count: int, spread: float) -> None:
        self.gpu, self.count = gpu, count
        self.about = json.loads((folder / "drive.json").read_text())
        kind = {"double": "d", "float": "f"}[self.about["scalar"]]
        self.advance = gpu.kernel(module, "strainwave_advance")
        words = gpu.allocate(4)
        gpu.launch(gpu.kernel(module, "strainwave_words"), 1, words)
        names = list(self.about["parameters"])
        row = [self.about["parameters"][name]["value"] for name in names]
        varied = next(k for k, name in enumerate(names) if name.startswith("gear.stiffness.") and row[k])
        self.made = count if spread else 1
        table = array.array(kind)
        for i in range(self.made):
            own = list(row)
            own[varied] *= 1.0 + spread * i / count
            table.extend(own)
        numbers, problems = gpu.allocate(len(table) * table.itemsize), gpu.allocate(4 * self.made)
        gpu.put(numbers, table)
        self.prepared = gpu.allocate(8 * self.made * gpu.get(words, "i", 1)[0])
        gpu.launch(gpu.kernel(module, "strainwave_prepare"), self.made, numbers, self.prepared, problems)
        assert not any(gpu.get(problems, "i", self.made))
        size = self.about["memory"] * count * table.itemsize
        self.memory = [gpu.allocate(size), gpu.allocate(size)]
        self.joint = [gpu.allocate(4 * count) for _ in range(5)]
        self.place = gpu.allocate(4 * count)
        gpu.put(self.place, array.array("I", range(count)))
        self.torque = gpu.allocate(4 * count)
        self.outputs = gpu.allocate(4 * count * len(self.about["outputs"]))

    def follow(self, row: list[float]) -> None:
        for place, value in zip(self.joint, row):  # noqa: B905 # Python 3.9 has no strict
            bits = int.from_bytes(array.array("f", [value]).tobytes(), sys.byteorder)
            self.gpu.call("cuMemsetD32_v2", place, ctypes.c_uint(bits), ctypes.c_size_t(self.count))

    def step(self) -> None:
        before, after = self.memory
        numbers = ctypes.c_double(JOINT_STEP), ctypes.c_double(self.about["step"])
        places = [self.place] * 4
        prepared = self.prepared, ctypes.c_int(self.made)
        memory = *prepared, before, after
        self.gpu.launch(self.advance, self.count, *memory, *self.joint, *places, *numbers, self.torque, self.outputs)
        self.memory.reverse()

    def shown(self) -> list[list[float]]:
        count = self.count
        values = self.gpu.get(self.outputs, "f", count * len(self.about["outputs"]))
        return [values[i * count : (i + 1) * count].tolist() for i in range(len(self.about["outputs"]))]


def run(folder: Path) -> int:
    """Run the drives of a folder; 1 if one differs too much from native code."""
    gpu, failed = Gpu(), False
    print(gpu.name)
    for each in sorted(path.parent for path in folder.glob("*/drive.ptx")):
        begin = time.perf_counter()
        module = gpu.load((each / "drive.ptx").read_bytes())
        seconds = time.perf_counter() - begin
        case = json.loads((each / "case.json").read_text())
        single = Actuators(gpu, each, module, 1, 0.0)
        names, rows = list(single.about["outputs"]), []
        for row in case["joint"]:
            single.follow(row)
            single.step()
            rows.append([column[0] for column in single.shown()])
        errors = []
        for name, wanted in case["wanted"].items():
            size = max(map(abs, wanted))
            found = [row[names.index(name)] for row in rows]
            if size > 0.0:
                errors.append((max(abs(a - b) for a, b in zip(found, wanted)) / size, name))  # noqa: B905
        error, name = max(errors)
        print(f"{each.name}: {error:.1e} to native code ({name}); PTX loaded in {seconds:.1f} s", flush=True)
        failed |= not error <= MAX_ERROR[single.about["scalar"]]
        for count in GEARS:
            for spread in (0.0, 0.1):
                many = Actuators(gpu, each, module, count, spread)
                for k, row in enumerate(case["joint"][: TIMED_STEPS + 2]):
                    if k == 2:
                        gpu.wait()
                        begin = time.perf_counter()
                    many.follow(row)
                    many.step()
                gpu.wait()
                seconds = time.perf_counter() - begin
                rate = count * TIMED_STEPS * JOINT_STEP / many.about["step"] / seconds
                equal = all(set(column) == {column[0]} for column in many.shown())
                print(
                    f"    {count} gears, {many.made} sets of numbers: {rate:.3g} gear steps a second; equal: {equal}",
                    flush=True,
                )
                failed |= equal == (spread > 0.0)
    return int(failed)


if __name__ == "__main__":
    if sys.argv[1] == "prepare":
        prepare(Path(sys.argv[2]))
    else:
        sys.exit(run(Path(sys.argv[2])))
