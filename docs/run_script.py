"""Runs a script, and keeps the values that it ends with: python docs/run_script.py SCRIPT VALUES."""

from __future__ import annotations

import pickle
import runpy
import sys
from contextlib import suppress
from pathlib import Path


def run(script: str, values: Path) -> None:
    """Run a script as a program, and write its global values that can be pickled, by name."""
    pickled: dict[str, bytes] = {}
    for name, value in runpy.run_path(script, run_name="__main__").items():
        with suppress(Exception):  # modules, functions and classes of the script cannot be pickled
            pickled[name] = pickle.dumps(value)
    values.write_bytes(pickle.dumps(pickled))


def read(values: Path) -> dict[str, object]:
    """Return the values that a script of this repository ended with, by name."""
    return {name: pickle.loads(value) for name, value in pickle.loads(values.read_bytes()).items()}


if __name__ == "__main__":
    run(sys.argv[1], Path(sys.argv[2]))
