"""Ensembles on a GPU: the kernel of a drive, compiled by NVRTC for the device, and its launches, one member to a thread."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from contextlib import ExitStack
from typing import Any

import numpy as np
from numpy.typing import NDArray

from strainwave import Drive, _core
from strainwave.native.folder import cache_folder
from strainwave.native.kernel import INCLUDE_FOLDER, headers_digest
from strainwave.native.private import make_private
from strainwave.native.static_type import Scalar, static_type

Array = NDArray[np.float64]
ENTRY = "strainwave_members"
THREADS_PER_BLOCK = 64  # a member takes most of the registers of a thread
MEMORY_SHARE = 0.7  # of the free memory of the device, that a launch may fill
MAX_CACHE_BYTES = 256_000_000  # of all kernels of devices in the cache
TALLY_COUNT = 5  # numbers of a member, as `DeviceEnsemble` lists them
MISSING_PACKAGES = "a GPU needs the packages of the extra cuda: pip install 'strainwave[cuda]'"

Result = tuple[NDArray[np.bool_], Array, Array, Array, dict[int, str]]


def source(drive: Drive, scalar: Scalar) -> str:
    """Return the CUDA C++ of a kernel that runs members with the laws of a drive."""
    return f"""#include <strainwave/kernel/device.hpp>
#include <strainwave/models.hpp>

template <class S>
using Drive = {static_type(drive)};
using S = {scalar};

extern "C" __global__ void {ENTRY}(const int* shape, const S* numbers, int number_count, const S* starts, int start_count,
                                   const double* instants, const double* inputs, const std::uint8_t* keep,
                                   std::size_t steps, double max_rate, const int* recorded, int recorded_count,
                                   S* out, double* tally, int members) {{
    const strainwave::kernel::DeviceEnsemble<S> ensemble{{shape, numbers, number_count, starts, start_count,
                                                         {{instants, inputs, keep, steps}}, max_rate, recorded, recorded_count,
                                                         out, tally, members}};
    const int member = blockIdx.x * blockDim.x + threadIdx.x;
    if (member < members) strainwave::kernel::run_member<Drive>(ensemble, member);
}}
"""


def machine_code(drive: Drive, scalar: Scalar, architecture: str) -> Any:
    """Return the kernel of a drive for an architecture such as "sm_90", out of the user's cache or compiled now.

    No product is fused with a sum, so that double precision gives the numbers of the processor.

    Raises:
        ImportError: the packages for it are not installed
        RuntimeError: NVRTC reports an error
    """
    try:
        from cuda.core import ObjectCode, Program, ProgramOptions
        from cuda.core.utils import FileStreamProgramCache, make_program_cache_key
    except ImportError:
        raise ImportError(MISSING_PACKAGES) from None
    text = source(drive, scalar)
    options = ProgramOptions(
        std="c++20", arch=architecture, fma=False, device_as_default_execution_space=True, include_path=[str(INCLUDE_FOLDER)]
    )
    folder = cache_folder()
    if folder is None:
        return Program(text, "c++", options).compile("cubin")
    make_private(folder)
    key = make_program_cache_key(
        code=text, code_type="c++", options=options, target_type="cubin", extra_digest=headers_digest().encode()
    )
    with FileStreamProgramCache(folder / "device", max_size_bytes=MAX_CACHE_BYTES) as cache:
        if (found := cache.get(key)) is not None:
            return ObjectCode.from_cubin(found)
        made = Program(text, "c++", options).compile("cubin")
        cache[key] = made
        return made


def simulate_many(
    drive: Drive,
    numbers: Sequence[int],
    values: Array,
    initial: tuple[Sequence[int], Array] | None,
    instants: Array,
    inputs: Array,
    keep: NDArray[np.uint8],
    recorded: Sequence[int],
    max_rate: float,
    threads: int,
    out: Array,
    progress: Callable[[int], None] | None = None,
    *,
    scalar: Scalar,
) -> Result:
    """Run members as `_core.simulate_many` does, with the same arguments and results, on the first GPU that CUDA finds.

    Members that leave the range of a law run again on the processor, whose message states where.

    Raises:
        ImportError: the packages for it are not installed
        OSError: no GPU is found, or its driver reports an error
        ValueError: not even one member fits into the memory of the device
    """
    sets, states, refusals = _core.member_starts(drive, numbers, values, initial, inputs, threads)
    tally = np.zeros((TALLY_COUNT, len(sets)))
    out[:] = np.nan
    begin = np.array([member for member in range(len(sets)) if member not in refusals], np.intp)
    done = len(refusals) * (len(instants) - 1)
    with ExitStack() as stack:
        device = _Device(stack, drive, scalar)
        course = _Course(device, drive, instants, inputs, keep, max_rate, recorded)
        for members in _launches(begin, device.free_bytes(), course.bytes_of_member(sets.shape[1], states.shape[1])):
            tally[:, members], out[:, members] = course.run(sets[members], states[members])
            done += len(members) * (len(instants) - 1)
            if progress is not None:
                progress(done)
    left = np.flatnonzero(tally[-1])
    sound, twists, rates, bristles = tally[3] > 0.0, tally[0], tally[1], tally[2]
    if left.size:
        rows = np.empty((out.shape[0], left.size, out.shape[2]))
        known = None if initial is None else (initial[0], np.ascontiguousarray(initial[1][:, left]))
        part = np.ascontiguousarray(values[:, left])
        again = _core.simulate_many(
            drive, numbers, part, known, instants, inputs, keep, recorded, max_rate, threads, rows, None
        )
        sound[left], twists[left], rates[left], bristles[left] = again[:4]
        out[:, left] = rows
        refusals |= {int(left[member]): reason for member, reason in again[4].items()}
    return sound, twists, rates, bristles, refusals


def _launches(members: NDArray[np.intp], free: int, each: int) -> Iterator[NDArray[np.intp]]:
    """Yield members in parts whose arrays fit into the memory that is free, each taking so many bytes."""
    size = int(MEMORY_SHARE * free) // each
    if size == 0:
        raise ValueError(
            f"a member takes {each} bytes, and the GPU has {free} free; record fewer outputs, or sample less often"
        )
    yield from (members[first : first + size] for first in range(0, len(members), size))


class _Device:
    """The first GPU, the kernel of a drive on it, and the arrays that are there until a stack closes."""

    def __init__(self, stack: ExitStack, drive: Drive, scalar: Scalar) -> None:
        try:
            from cuda.core import Device
        except ImportError:
            raise ImportError(MISSING_PACKAGES) from None
        try:
            self.device: Any = Device()
            self.device.set_current()
        except Exception as error:  # of the loader, the driver or the runtime, which have no common type
            raise OSError(f'no GPU that CUDA can use was found ({error}); run on the processor by backend="cpu"') from None
        self.scalar = np.float32 if scalar == "float" else np.float64
        self.stack = stack
        self.kernel = machine_code(drive, scalar, f"sm_{self.device.arch}").get_kernel(ENTRY)

    def free_bytes(self) -> int:
        """Return the memory that is free."""
        from cuda.bindings import driver

        return int(_checked(driver.cuMemGetInfo())[0])

    def empty(self, stack: ExitStack, count: int, scalar: Any) -> Any:
        """Return an array of the device, whose memory is free again when a stack closes."""
        buffer = self.device.allocate(max(count, 1) * np.dtype(scalar).itemsize, stream=self.device.default_stream)
        stack.callback(buffer.close)
        return buffer

    def put(self, stack: ExitStack, values: Any, scalar: Any) -> Any:
        """Return an array of the device with these values."""
        from cuda.bindings import driver

        host = np.ascontiguousarray(values, scalar)
        buffer = self.empty(stack, host.size, scalar)
        if host.size:
            self.device.default_stream.sync()  # until the memory is there
            _checked(driver.cuMemcpyHtoD(int(buffer.handle), host.ctypes.data, host.nbytes))
        return buffer

    def get(self, buffer: Any, shape: tuple[int, ...], scalar: Any) -> NDArray[Any]:
        """Return the values of an array of the device."""
        from cuda.bindings import driver

        host = np.empty(shape, scalar)
        _checked(driver.cuMemcpyDtoH(host.ctypes.data, int(buffer.handle), host.nbytes))
        return host

    def launch(self, members: int, *arguments: Any) -> None:
        """Run the kernel, one thread a member, to its end."""
        from cuda.core import LaunchConfig, launch

        config = LaunchConfig(grid=-(-members // THREADS_PER_BLOCK), block=THREADS_PER_BLOCK)
        launch(self.device.default_stream, config, self.kernel, *arguments)
        self.device.default_stream.sync()


class _Course:
    """Inputs of all members on the device, and the outputs that are recorded of each."""

    def __init__(
        self, device: _Device, drive: Drive, instants: Array, inputs: Array, keep: Any, max_rate: float, recorded: Sequence[int]
    ) -> None:
        def put(values: Any, scalar: Any) -> Any:
            return device.put(device.stack, values, scalar)

        self.device, self.max_rate, self.recorded = device, max_rate, len(recorded)
        self.steps, self.samples = len(instants) - 1, 1 + int(np.count_nonzero(keep))
        self.shape, self.places = put(_core.parts(drive)[1], np.int32), put(recorded, np.int32)
        self.schedule = put(instants, np.float64), put(inputs, np.float64), put(keep, np.uint8)

    def bytes_of_member(self, numbers: int, states: int) -> int:
        """Return the memory that a member takes on the device."""
        size = np.dtype(self.device.scalar).itemsize
        return size * (self.samples * self.recorded + numbers + states) + TALLY_COUNT * np.dtype(np.float64).itemsize

    def run(self, sets: Array, states: Array) -> tuple[Array, Array]:
        """Return tallies, shape (5, members), and outputs, shape (recorded, members, samples), of members."""
        device, members = self.device, len(sets)
        with ExitStack() as stack:
            numbers, starts = device.put(stack, sets, device.scalar), device.put(stack, states, device.scalar)
            out = device.empty(stack, self.samples * self.recorded * members, device.scalar)
            tally = device.empty(stack, TALLY_COUNT * members, np.float64)
            device.launch(
                members, self.shape, numbers, np.int32(sets.shape[1]), starts, np.int32(states.shape[1]), *self.schedule,
                np.uint64(self.steps), np.float64(self.max_rate), self.places, np.int32(self.recorded), out, tally,
                np.int32(members),
            )  # fmt: skip
            tallies = device.get(tally, (TALLY_COUNT, members), np.float64)
            outputs = device.get(out, (self.samples, self.recorded, members), device.scalar)
        return tallies, outputs.transpose(1, 2, 0)


def _checked(result: tuple[Any, ...]) -> tuple[Any, ...]:
    """Return what a call of the driver returns besides its status.

    Raises:
        OSError: the status is an error
    """
    status, *found = result
    if int(status) != 0:
        raise OSError(f"the driver of the GPU reports {status.name}")
    return tuple(found)
