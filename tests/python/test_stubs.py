"""The build writes a type stub of each compiled module, with all that the module contains."""

from __future__ import annotations

import ast
import sys
from pathlib import Path
from types import ModuleType
from typing import Any

import pytest
import strainwave
from strainwave import _core

FAMILIES: tuple[dict[str, type[Any]], ...] = (*_core.families.values(), *_core.fault_families.values())
MODULES = sorted({model.__module__ for family in FAMILIES for model in family.values()})


def stub(module: ModuleType) -> ast.Module:
    """Return the stub where type checkers look for it: in the folder of the package."""
    path = Path(strainwave.__file__).with_name(f"{module.__name__.rpartition('.')[2]}.pyi")
    assert path.is_file(), f"{path} is missing; building the core writes it"
    return ast.parse(path.read_text())


def names(of: ast.Module | ast.ClassDef) -> set[str]:
    """Return what a module or a class of a stub defines."""
    nodes = {ast.FunctionDef: "name", ast.ClassDef: "name"}
    plain = {getattr(node, nodes[type(node)]) for node in of.body if type(node) in nodes}
    typed = {node.target.id for node in of.body if isinstance(node, ast.AnnAssign) and isinstance(node.target, ast.Name)}
    imported = {each.asname for node in of.body if isinstance(node, ast.ImportFrom) for each in node.names}
    return plain | typed | (imported - {None})


@pytest.mark.parametrize("name", ["strainwave._core", *MODULES])
def test_a_stub_defines_all_that_its_module_does(name: str) -> None:
    module = sys.modules[name]
    public = {each for each in vars(module) if not each.startswith("_")}
    assert public
    assert public - names(stub(module)) == set()


@pytest.mark.slow("physics")
@pytest.mark.parametrize("family", FAMILIES, ids=lambda family: next(iter(family.values())).__module__)
def test_a_stub_has_every_field_of_every_model(family: dict[str, type[Any]]) -> None:
    for model in family.values():
        classes = {node.name: node for node in stub(sys.modules[model.__module__]).body if isinstance(node, ast.ClassDef)}
        fields = {field["name"] for field in model.fields}
        assert fields - names(classes[model.__name__]) == set(), model.__name__
