"""Every public name of the package has one entry in the reference, every verb of the command one section."""

from __future__ import annotations

import re
from collections import Counter
from inspect import isroutine
from pathlib import Path
from typing import Any

import api
import cli_reference
import docstrings
import pytest
import strainwave as sw
from strainwave import _core


@pytest.fixture(scope="module")
def written(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("reference")
    api.write(folder / "api")
    cli_reference.write(folder)
    return folder


@pytest.fixture(scope="module")
def entries(written: Path) -> Counter[str]:
    """The names of all entries, and how often each comes."""
    pages = "\n".join(page.read_text(encoding="utf-8") for page in (written / "api").glob("*.rst"))
    names = re.findall(r"^ *\.\. (?:auto\w+|py:module):: ([\w.:]+)", pages, re.MULTILINE)
    return Counter(name.replace("::", ".") for name in names)


def test_every_public_name_has_one_entry(entries: Counter[str]) -> None:
    names = {f"strainwave.{name}" for name in sw.__all__}
    models = [model for family in (*_core.families.values(), *_core.fault_families.values()) for model in family.values()]
    names |= {f"{model.__module__}.{model.__name__}" for model in models}
    names |= {f"strainwave.{module}.{name}" for module in ("rig", "export") for name in getattr(sw, module).__all__}
    names |= {
        f"strainwave.scenario.{name}" for name in ("Scenario", "chirp", "constant", "pulse_train", "ramp", "sine", "step")
    }
    assert {name: entries[name] for name in names if entries[name] != 1} == {}
    assert [name for name, count in entries.items() if count > 1] == []


@pytest.mark.parametrize("model", [sw.friction.LuGre, sw.Gear, sw.hysteresis.MaxwellSlip, sw.compensation.Dither])
def test_the_methods_of_a_compiled_model_have_entries(model: type[Any], entries: Counter[str]) -> None:
    methods = [name for name in dir(model) if not name.startswith("_") and isroutine(getattr(model, name))]
    assert methods
    place = model.__module__.removesuffix("._core")
    assert [name for name in methods if entries[f"{place}.{model.__name__}.{name}"] != 1] == []


def test_a_signature_has_the_defaults_of_the_model(written: Path) -> None:
    page = (written / "api" / "friction.rst").read_text(encoding="utf-8")
    default = next(field["default"] for field in sw.friction.LuGre.fields if field["name"] == "viscous")
    (signature,) = re.findall(r"autoclass:: strainwave\.friction\.LuGre\((.*)\)", page)
    assert "coulomb: float | str, breakaway: float | str, " in signature  # both must be given
    assert f"viscous: float | str = {default}" in signature


def test_every_verb_has_a_section_with_its_options(written: Path) -> None:
    page = (written / "command-line.rst").read_text(encoding="utf-8")
    sections = re.split(r"^\.\. _strainwave-", page, flags=re.MULTILINE)[1:]
    verbs = {section.partition(":")[0] for section in sections}
    assert {"identify", "export-fmu", "rig-analyse", "diagnose-misalignment", "doctor-kernels"} <= verbs
    assert len(verbs) == len(sections)
    (simulate,) = (section for section in sections if section.startswith("simulate:"))
    assert ".. option:: drive <str>" in simulate
    assert ".. option:: -o, --out <path>" in simulate
    assert "[default: 0.001]" in simulate


def test_a_docstring_keeps_its_table_its_code_and_the_limits_of_its_parameters() -> None:
    table = docstrings.restructured(sw.check_ratings.__doc__)
    assert "   * - average_torque\n     - " in table
    assert "``input_speed``" in table
    model = docstrings.restructured(docstrings.model_text(sw.friction.LuGre), docstrings.SYMBOL)
    field = next(field for field in sw.friction.LuGre.fields if field["name"] == "stribeck_speed")
    assert rf"    stribeck_speed (float): {field['doc'].partition(' F_s')[0]}" in model
    assert "[rad/s], in (0, inf); required" in model
    assert "\\sigma_0 |v| z" in model  # a formula is not escaped
    assert "Attributes:" not in docstrings.model_text(sw.structure.Lumped)  # it has no parameters


def test_the_page_of_the_reference_lists_every_function_of_a_task() -> None:
    """A code host has no other list."""
    text = (Path(__file__).resolve().parents[2] / "docs" / "reference" / "index.md").read_text(encoding="utf-8")
    functions = [name for names in api.tasks().values() for name in names if name.rpartition(".")[2][0].islower()]
    assert len(functions) > 30
    assert [name for name in functions if f"`sw.{name.removeprefix('strainwave.')}`" not in text] == []
