"""The headers of faults and onsets in every scalar, and where there are neither exceptions nor a heap."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from tests.support.cplusplus import ROOT, checker, compilation

PAGE = ROOT / "docs" / "contributing" / "add-a-fault.md"

USE = """
#include <strainwave/fault/models.hpp>
#include <strainwave/onset/models.hpp>
#include <strainwave/scalar/dual.hpp>
#include <strainwave/scalar/pack.hpp>

using namespace strainwave;

template <class S, template <class...> class... Fault>
S sum(List<Fault...>, const fault::Facts<S>& facts) {
    S total(0.0);
    (Fault<S>{}.changes(facts, [&](const fault::Change<S>& change) { total = total + change.value; }), ...);
    return total;
}
template <class S, template <class...> class... Onset>
S share(List<Onset...>, const S& usage) {
    S total(0.0);
    ((total = total + Onset<S>{}.share(usage)), ...);
    return total;
}
template <class S>
S both(const S& usage) {
    return sum(fault::Models{}, fault::Facts<S>{.flexspline_teeth = 200, .circular_spline_teeth = 202}) +
           share(onset::Models{}, usage);
}
"""


@pytest.mark.parametrize("scalar", ["double", "float", "Dual<2>", "Pack<4>"])
def test_faults_and_onsets_compile_in_every_scalar(scalar: str, tmp_path: Path) -> None:
    source = f"{USE}\n{scalar} of_this({scalar} usage) {{ return both<{scalar}>(usage); }}\n"
    assert compilation(checker("g++"), tmp_path, {"faults.cpp": source}, "-fno-exceptions", "-fno-rtti") == (0, "")


def test_the_fault_of_the_page_for_contributors_compiles(tmp_path: Path) -> None:
    (header,) = re.findall(r"^```cpp\n(.*?)^```$", PAGE.read_text(encoding="utf-8"), re.MULTILINE | re.DOTALL)
    use = "int count = 0;\nvoid changes() { StiffSeal<double>{}.changes({}, [](const Change<double>&) { ++count; }); }"
    source = f"{header}\nnamespace strainwave::fault {{\n{use}\n}}\n".replace("#pragma once\n", "")
    assert compilation(checker("g++"), tmp_path, {"fault.cpp": source}) == (0, "")
