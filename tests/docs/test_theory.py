"""The section of every model on the theory pages can be generated; `dev.py docs` then makes the pages of them."""

from __future__ import annotations

import re
from typing import Any

import law_panels
import pytest
import strainwave as sw
import theory
from prose import ERRATA, escaped, linked, titles
from strainwave import _core

FAMILIES = _core.families | _core.fault_families
MODELS = [*(model for family in FAMILIES.values() for model in family.values()), sw.Gear, sw.Drive, sw.Sensors]


@pytest.mark.parametrize("model", MODELS, ids=lambda model: model.name)
def test_the_section_of_a_model_can_be_generated(model: Any) -> None:
    text, figure = theory.section(model)
    assert text.startswith(f"## {model.__name__}\n")
    assert (f"({model.name}.svg)" in text) == (figure is not None)


def test_every_model_is_on_one_page() -> None:
    shown = [model for _, models in theory.pages().values() for model in models]
    assert sorted(model.__name__ for model in shown) == sorted(model.__name__ for model in MODELS)
    pictured = [model for model in shown if theory.module_of(model) not in _core.fault_families]
    assert len({model.name for model in pictured}) == len(pictured)  # else one figure replaces another


def test_the_table_of_failure_modes_has_a_row_for_every_fault() -> None:
    faults = list(_core.fault_families["fault"].values())
    _, table = theory.failure_modes(faults)
    rows = table.splitlines()[2:]
    assert [row.split("|")[1].strip(" `") for row in rows] == [fault.__name__ for fault in faults]
    assert all(
        fault.mode in row and any(place in row for place in ("`gear.", "`sensors.", "`motor`"))
        for fault, row in zip(faults, rows, strict=True)
    )
    assert theory.failure_modes([sw.Gear]) == []


def test_an_error_under_load_is_that_of_the_model_divided_by_the_load() -> None:
    law = sw.kinematic_error.Fourier(order=[2], amplitude=[3e-4], phase=[0.0])
    loaded = law_panels.under_load(sw.kinematic_error.Scaled(law=law, load_sensitivity=0.1))
    assert loaded == pytest.approx(law.error(law_panels.TURN) / (1.0 + 0.1 * law_panels.LOAD_TORQUE), abs=1e-6)


def test_symbols_within_words_become_formulas_and_code_stays() -> None:
    words = escaped("theta_in of ``pitch_radius``, phi, k_i and bearing_stiffness")
    assert words == r"$\theta_{\mathrm{in}}$ of ``pitch_radius``, $\varphi$, $k_{i}$ and bearing\_stiffness"


def test_a_plus_sign_that_begins_a_line_begins_no_list() -> None:
    assert escaped("falls as 1\n+ cos x, a + b\n+1") == "falls as 1\n\\+ cos x, a + b\n+1"


def test_titles_of_documents_and_works_are_links() -> None:
    title = titles()[1]
    assert linked(f'"{title}", K_s; Dahl1968') == (
        f'"[{title}](../validation/errata.md#the-four-documents)", $K_{{s}}$; [Dahl1968](../theory/references.md#dahl1968)'
    )


def test_the_page_of_errata_has_the_titles_that_the_headers_state() -> None:
    header = (ERRATA.parents[2] / "include" / "strainwave" / "documents.hpp").read_text(encoding="utf-8")
    joined = re.sub(r'"\s*\\\n\s*"', "", header)
    assert sorted(re.findall(r'"\\"(.*?)\\""', joined)) == sorted(titles())
