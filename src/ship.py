"""Kernels that a wheel carries, those of the drives of the catalogue: `python3 dev.py wheel` compiles them into a folder."""

from __future__ import annotations

import os
import platform
import sys
from concurrent.futures import ThreadPoolExecutor
from functools import partial
from pathlib import Path

import strainwave as sw
from strainwave.files.ratings import drive_of
from strainwave.native.cache import ship
from strainwave.native.compilers import FLAGS_OF_INSTRUCTION_SET
from strainwave.native.kernel import Kernel
from strainwave.native.kernels import PUBLIC_JOBS, kernel_of


def instruction_sets() -> list[str]:
    """Return those that machines of this kind may have."""
    return [*FLAGS_OF_INSTRUCTION_SET] if platform.machine() == "x86_64" else ["baseline"]


def kernels() -> list[Kernel]:
    """Return the kernels of all drives of the catalogue, one for drives with the same laws."""
    drives = [drive_of(sw.load(name)) for name in sw.catalogue("drives")]
    found = [kernel_of(drive, job) for drive in drives for job in PUBLIC_JOBS]
    return [*{kernel.source: kernel for kernel in found}.values()]


def main(folder: Path) -> None:
    folder.mkdir()
    with ThreadPoolExecutor(os.cpu_count()) as compilers:
        for name in instruction_sets():
            made = [*compilers.map(partial(ship, folder=folder, instruction_set=name), kernels())]
            print(f"{name}: {len(made)} kernels, {sum(path.stat().st_size for path in made) / 1e6:.1f} MB", flush=True)
    for path in folder.iterdir():
        path.chmod(0o644)  # whoever installs the wheel, all who import the package use them


if __name__ == "__main__":
    main(Path(sys.argv[1]))
