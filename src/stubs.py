"""Type stubs of the compiled modules, as the extension itself describes them: `python3 dev.py stubs` writes them."""

from __future__ import annotations

import os
import re
import sys
from pathlib import Path

import strainwave
from nanobind.stubgen import ReplacePattern, StubGen
from strainwave import _core

PACKAGE = Path(strainwave.__file__).parent

# Plain attributes carry no signature, and what Python adds is not the extension's own, so their types stand here.
ATTRIBUTES = {
    r"\.Gear\.from_datasheet$": "@staticmethod\ndef from_datasheet(ratio: float, **figures: Any) -> Gear: ...",
    r"\.fields$": "fields: tuple[dict[str, Any], ...]",
    r"\.quantities$": "quantities: tuple[tuple[str, str, str], ...]",
    r"\.families$": "families: dict[str, dict[str, type[Any]]]",
    r"\.fault_families$": "fault_families: dict[str, dict[str, type[Any]]]",
}


def stubs() -> dict[Path, str]:
    """The text of each stub, by its place in the package."""
    every = (*_core.families.values(), *_core.fault_families.values())
    of_models = {model.__module__ for family in every for model in family.values()}
    modules = ("strainwave._core", *sorted(of_models))
    return {PACKAGE / f"{module.rpartition('.')[2]}.pyi": stub(module) for module in modules}


def stub(module: str) -> str:
    generator = StubGen(sys.modules[module], patterns=[pattern(*attribute) for attribute in ATTRIBUTES.items()])
    generator.put(sys.modules[module])
    text: str = generator.get()
    return text


def pattern(name: str, declaration: str) -> ReplacePattern:
    return ReplacePattern(re.compile(name), [r"\from typing import Any", *declaration.splitlines(), ""], 0)


def main() -> None:
    for path, text in stubs().items():
        partial = path.with_suffix(".partial")
        partial.write_text(text)
        os.replace(partial, path)


if __name__ == "__main__":
    main()
