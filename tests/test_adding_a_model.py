"""A new model is one header, one line of models.hpp, and its test: by counting who names each model, and by adding one."""

from __future__ import annotations

import re
import shutil
from pathlib import Path

import pytest
from strainwave import _core

from tests.cplusplus import INCLUDE, ROOT, STRICT, compilation, compiler

MODELS = [model for family in _core.families.values() for model in family.values()]
HEADERS = {path: path.read_text() for path in INCLUDE.rglob("*.hpp")}
SOURCES = {path: path.read_text() for path in (ROOT / "src").glob("*.?pp")}
PACKAGE = {path: path.read_text() for path in (ROOT / "python").rglob("*.py")}

# What may name a model besides its header and models.hpp, and why.
NAMED_ELSEWHERE = {
    "any.hpp": {"Cyclic", "Thermal", "Preisach"},  # hold any other law where they are chosen at run time
    "maxwell_slip.hpp": {"PrandtlIshlinskii"},  # its inverse
    "misalignment.hpp": {"Fourier"},  # what it gives in closed form
    "verbs.hpp": {"Fourier"},  # what the harmonics of any error are
}
# Laws that others begin with, and the defaults of templates.
BUILT_UPON = {"Stribeck", "Coulomb", "PowerDensity"}
# Identification fits these laws because their parameters are what the measurements show.
IDENTIFIED = {
    "Coulomb",
    "Viscous",
    "Stribeck",
    "LuGre",
    "MaxwellSlip",
    "ThreeSegment",
    "Cubic",
    "Linear",
    "Inertia",
    "Pendulum",
    "DC",
    "OpenLoop",
    "PID",
    "PlainRatio",
    "StrainWave",
    "Fourier",
}


def code(text: str) -> str:
    """Without comments, raw texts and quoted ones, which may speak of any model."""
    text = re.sub(r'R"\(.*?\)"', '""', text, flags=re.DOTALL)
    return re.sub(r'//[^\n]*|"(?:[^"\\\n]|\\.)*"', "", text)


def home(model: type) -> list[Path]:
    """The header that defines a model."""
    return [path for path, text in HEADERS.items() if re.search(rf"^struct {model.__name__} \{{", text, re.MULTILINE)]


def naming(model: type, texts: dict[Path, str]) -> set[str]:
    return {path.name for path, text in texts.items() if re.search(rf"\b{model.__name__}\b", code(text))}


@pytest.mark.parametrize("model", MODELS, ids=lambda model: model.name)
def test_a_model_is_named_in_its_header_and_once_in_the_list(model: type) -> None:
    (header,) = home(model)
    assert len(re.findall(rf"\b{model.__name__}\b", code(HEADERS[INCLUDE / "strainwave" / "models.hpp"]))) == 1
    elsewhere = naming(model, HEADERS | SOURCES) - {header.name, "models.hpp"}
    allowed = {name for name, models in NAMED_ELSEWHERE.items() if model.__name__ in models}
    if model.__name__ in BUILT_UPON:
        allowed |= {"lugre.hpp", "cyclic.hpp", "thermal.hpp", "preisach.hpp"}
    assert elsewhere <= allowed


@pytest.mark.parametrize("model", [model for model in MODELS if model.__name__ not in IDENTIFIED], ids=lambda model: model.name)
def test_the_package_does_not_name_a_model_that_it_does_not_identify(model: type) -> None:
    assert naming(model, PACKAGE) == set()


QUADRATIC = """#pragma once
#include <strainwave/friction/contact.hpp>

namespace strainwave::friction {

template <class S>
struct Quadratic {
    S drag{0.0};

    static constexpr auto name = "quadratic";
    static constexpr auto source = "made up";
    static constexpr auto doc = "Drag.";

    template <class Self, class Visit>
    static constexpr void fields(Self& m, Visit&& visit) {
        visit(SW_FIELD(m, drag, "N.m.s2/rad2", "Torque per speed squared", 0));
    }

    using State = Stateless<S>;

    constexpr S torque(const State&, const Contact<S>& contact) const { return drag * contact.speed * abs(contact.speed); }
};

}  // namespace strainwave::friction
"""
CHECK = """
#include <strainwave/any.hpp>
#include <strainwave/integrate.hpp>
#include <strainwave/scalar/pack.hpp>
using namespace strainwave;
static_assert(std::is_constructible_v<std::variant<friction::Quadratic<double>>, friction::Quadratic<double>>);
template <class S>
AnyPositionDrive<S> dragged() {
    AnyPositionDrive<S> drive{};
    drive.gear.friction_input.model = friction::Quadratic<S>{S(1e-3)};
    friction::Thermal<S, AnyOf<S, friction::Varying>> warm{};
    warm.law.model = friction::Quadratic<S>{S(1e-3)};
    drive.gear.friction_mesh.model = warm;
    return drive;
}
template <class S>
S speed_after_a_step() {
    const auto drive = dragged<S>().compile();
    return step<S>(drive, drive.rest(), {}, S(1e-4)).motion.input_speed;
}
double one() { return speed_after_a_step<double>(); }
double many() { return speed_after_a_step<Pack<8>>()[0]; }
"""


def test_a_new_friction_law_takes_its_header_and_one_line(tmp_path: Path) -> None:
    """In double and in packs, plain and modulated by another law."""
    include = tmp_path / "include"
    shutil.copytree(INCLUDE, include)
    (include / "strainwave/friction/quadratic.hpp").write_text(QUADRATIC)
    models = include / "strainwave/models.hpp"
    before = models.read_text()
    after = before.replace("using Plain = List<Viscous,", "using Plain = List<Viscous, Quadratic,")
    assert after != before
    models.write_text("#include <strainwave/friction/quadratic.hpp>\n" + after)
    options = [option for option in STRICT if not option.startswith("-I")]
    assert compilation(compiler("g++"), tmp_path, {"added.cpp": CHECK}, *options, f"-I{include}") == (0, "")
