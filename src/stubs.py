"""Type stubs of the compiled modules, as the extension describes them. The build runs it after `_core` is linked.

python src/stubs.py EXTENSION FOLDER
"""

from __future__ import annotations

import os
import re
import sys
from importlib.util import module_from_spec, spec_from_file_location
from pathlib import Path
from types import ModuleType

from nanobind.stubgen import ReplacePattern, StubGen

CORE = "strainwave._core"

# Plain attributes carry no signature, and what Python adds is not the extension's own, so their types stand here.
FORMS = """def to_dict(self) -> dict[str, Any]: ...
def to_frame(self) -> Any: ...
def _repr_html_(self) -> str: ...
def _headline(self) -> str: ...
def _rows(self) -> Any: ..."""
PLOT = "def plot(self) -> Any: ..."
ATTRIBUTES = {
    r"\.Gear\.__suffix__$": f"@staticmethod\ndef from_datasheet(ratio: float, **figures: Any) -> Gear: ...\n{FORMS}\n{PLOT}",
    r"\.Drive\.__suffix__$": f"{FORMS}\n{PLOT}",
    r"\.(__str__|__repr__|to_dict|to_frame|plot)$": "",  # of the package, where the build can import it
    r"^strainwave\.[a-z]\w*\.[A-Z]\w*\.__suffix__$": FORMS,
    r"\.fields$": "fields: tuple[dict[str, Any], ...]",
    r"\.quantities$": "quantities: tuple[tuple[str, str, str], ...]",
    r"\.families$": "families: dict[str, dict[str, type[Any]]]",
    r"\.fault_families$": "fault_families: dict[str, dict[str, type[Any]]]",
}


def load(extension: str) -> ModuleType:
    """Return the core of a file, without the package, whose import would start the build again."""
    spec = spec_from_file_location(CORE, extension)
    assert spec is not None
    assert spec.loader is not None
    sys.modules[CORE] = core = module_from_spec(spec)
    spec.loader.exec_module(core)
    return core


def stubs(core: ModuleType) -> dict[str, str]:
    """Return the text of each stub by the name of its file."""
    every = (*core.families.values(), *core.fault_families.values())
    of_models = {model.__module__ for family in every for model in family.values()}
    return {f"{module.rpartition('.')[2]}.pyi": stub(module) for module in (CORE, *sorted(of_models))}


def stub(module: str) -> str:
    generator = StubGen(sys.modules[module], patterns=[pattern(*attribute) for attribute in ATTRIBUTES.items()])
    generator.put(sys.modules[module])
    text: str = generator.get()
    return text


def pattern(name: str, declaration: str) -> ReplacePattern:
    return ReplacePattern(re.compile(name), [r"\from typing import Any", *declaration.splitlines(), ""], 0)


def main(extension: str, folder: str) -> None:
    for name, text in stubs(load(extension)).items():
        partial = Path(folder, f"{name}.partial")
        partial.write_text(text, "utf-8")
        os.replace(partial, Path(folder, name))


if __name__ == "__main__":
    main(*sys.argv[1:])
