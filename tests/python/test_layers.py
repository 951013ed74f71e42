"""Which part of the package may import which, by the map for contributors: from the command down to the files."""

from __future__ import annotations

import ast
import subprocess
import sys
from collections.abc import Iterable, Iterator
from functools import cache
from graphlib import CycleError, TopologicalSorter
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest
import strainwave as sw

from tests.support.rooms import layers

PACKAGE = Path(sw.__file__).parent
LAYERS = layers()  # of the map for contributors
TOP = {"__main__"}


@cache
def imported(path: Path) -> frozenset[str]:
    """What a module imports from the package, within functions and for types too."""
    return names_imported(ast.walk(ast.parse(path.read_text())))


def names_imported(nodes: Iterable[ast.AST]) -> frozenset[str]:
    return frozenset(
        f"{node.module}.{each.name}".removeprefix("strainwave.")
        for node in nodes
        if isinstance(node, ast.ImportFrom) and node.module is not None and node.module.split(".")[0] == "strainwave"
        for each in node.names
    )


def run_nodes(node: ast.AST) -> Iterator[ast.AST]:
    """All that runs at one time or another: what is for types alone does not."""
    yield node
    for child in ast.iter_child_nodes(node):
        if not (isinstance(child, ast.If) and "TYPE_CHECKING" in ast.dump(child.test)):
            yield from run_nodes(child)


@pytest.mark.slow("physics")
def test_each_layer_imports_from_those_below_alone() -> None:
    known = {*LAYERS, *TOP}
    for layer, below in LAYERS.items():
        for path in sorted((PACKAGE / layer).rglob("*.py")):
            parts = {name.split(".")[0] for name in imported(path)} & known
            above = parts - below
            assert above == set(), f"{path.relative_to(PACKAGE)} imports {above}"


def test_nothing_imports_the_command_but_its_start_and_a_job() -> None:
    users = {path.stem for path in PACKAGE.rglob("*.py") if any(name.startswith("commands.cli") for name in imported(path))}
    assert users == {"__main__", "job"}


def test_a_person_who_never_opens_the_rig_can_forget_it() -> None:
    outside = [path for path in PACKAGE.rglob("*.py") if "rig" not in path.relative_to(PACKAGE).parts]
    assert [path.name for path in outside if any(name.startswith("rig") for name in imported(path))] == []


@pytest.mark.slow("physics")
def test_no_module_imports_itself_through_others() -> None:
    """Nor within functions: what two modules need of each other belongs into a third below both."""
    files = {path.relative_to(PACKAGE).with_suffix("").as_posix().replace("/", "."): path for path in PACKAGE.rglob("*.py")}
    modules = {name.removesuffix(".__init__"): path for name, path in files.items() if name != "__init__"}
    graph: dict[str, set[str]] = {}
    for name, path in modules.items():
        names = names_imported(run_nodes(ast.parse(path.read_text())))
        graph[name] = {each if each in modules else each.rpartition(".")[0] for each in names} & modules.keys()
    try:
        TopologicalSorter(graph).prepare()
    except CycleError as error:
        pytest.fail(" imports ".join(reversed(error.args[1])))


@pytest.mark.slow("physics")
def test_the_command_and_the_demonstration_begin_without_what_only_a_verb_needs() -> None:
    code = "import strainwave.{}, sys; print({} & sys.modules.keys())"
    for module, heavy in (
        ("commands.cli", {"numpy", "scipy", "pydantic", "jinja2"}),
        ("demo", {"scipy", "jinja2", "matplotlib"}),
    ):
        done = subprocess.run([sys.executable, "-c", code.format(module, heavy)], capture_output=True, text=True, check=True)
        assert done.stdout.strip() == "set()", module


@pytest.mark.slow("physics")
def test_a_log_is_identified_without_packages_that_take_long_to_import(tmp_path: Path) -> None:
    time = np.arange(0.0, 10.0, 0.005)
    angle, speed = 10.0 * np.sin(2.0 * time), 20.0 * np.cos(2.0 * time)
    current = 0.5 * np.sign(speed) + 0.01 * speed + 0.02 * np.random.default_rng(0).normal(size=len(time))
    table = np.column_stack([time, angle, current])
    header = "time [s],input_angle [rad],current [A]"
    np.savetxt(tmp_path / "log.csv", table, delimiter=",", header=header, comments="")
    words = ["strainwave", "identify", "csg-20-100", "log.csv", "--constant", "torque_constant=0.1"]
    command = [sys.executable, "-X", "importtime", "-m", *words]
    done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=False)
    assert "input.coulomb" in done.stdout
    modules = {line.rpartition("|")[2].strip() for line in done.stderr.splitlines()}
    assert "scipy.linalg" in modules
    assert not {"scipy.signal", "scipy.stats", "scipy.integrate", "strainwave.rig"} & modules


def test_papers_import_public_modules_alone() -> None:
    public = {f"strainwave.{name}" for name in sw.__all__ if isinstance(getattr(sw, name), ModuleType)}
    scripts = sorted((Path(__file__).parents[2] / "papers").rglob("*.py"))
    assert scripts
    for path in scripts:
        nodes = list(ast.walk(ast.parse(path.read_text())))
        of = {node.module for node in nodes if isinstance(node, ast.ImportFrom) and node.module}
        plain = {each.name for node in nodes if isinstance(node, ast.Import) for each in node.names}
        private = {name for name in of | plain if name.startswith("strainwave.")} - public
        assert not private, f"{path.parent.name}/{path.name} imports {private}"
