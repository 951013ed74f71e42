"""Headers and sources as they are, under two compilers with their warnings as errors."""

from __future__ import annotations

import re
import sysconfig
from collections import Counter
from pathlib import Path

import nanobind
import pytest
import strainwave as sw
from strainwave.native import kernel, kernels

from tests.support.cplusplus import (
    HEADERS,
    INCLUDE_FOLDER,
    ROOT,
    STRICT,
    checker,
    compilation,
    compiled_before,
    compiler,
    drives,
    zig,
)

both = pytest.mark.parametrize("name", ["g++", "clang++"])

SOURCES = {path.relative_to(ROOT).as_posix() for path in (ROOT / "src").rglob("*.cpp")}
GROUPS = [  # of sources, as the build compiles them together; any other by itself
    found[1].split() for found in re.finditer(r"^together\(\w+\s([^)]+)\)", (ROOT / "CMakeLists.txt").read_text(), re.MULTILINE)
]
APART = [[source] for source in sorted(SOURCES.difference(*GROUPS))]
# Headers of other projects, whose warnings are no errors here.
FOREIGN = (f"-isystem{nanobind.include_dir()}", f"-isystem{sysconfig.get_path('include')}")
INSTANTIATED = ("-Xclang", "-fpch-instantiate-templates")  # templates of what was compiled before: once, not in each source
SOURCE_HEADERS = """#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>
#include <strainwave/models.hpp>
"""
MATH = "strainwave/math.hpp"
SCALARS = ("double", "float", "strainwave::Dual<4>", "strainwave::Pack<8>")
SCALAR_HEADERS = "#include <strainwave/scalar/dual.hpp>\n#include <strainwave/scalar/pack.hpp>\n"


def stepped(scalar: str, drive: str) -> str:
    """Makes the compiler go through the step of a drive."""
    arguments = (
        f"const {drive}&, const {drive}::State&, const strainwave::Interval<strainwave::Input<{scalar}>>&, const {scalar}&"
    )
    return f"template {drive}::State strainwave::step<{scalar}>({arguments});\n"


def included(header: str) -> set[str]:
    """The headers of the package that a header includes, itself or through others."""
    named = set(re.findall(r"#include <(strainwave/\S+)>", (INCLUDE_FOLDER / header).read_text()))
    return named.union(*map(included, named))


@pytest.mark.slow("build")
@both
def test_every_header_stands_on_its_own(name: str, tmp_path: Path) -> None:
    """Most include MATH, and so <cmath>, which takes four times as long as the rest of them: they find it compiled.

    Nothing escapes by that: a header that forgets what it needs fails by itself, or what it includes does.
    """
    headers = {header.relative_to(INCLUDE_FOLDER).as_posix() for header in INCLUDE_FOLDER.rglob("*.hpp")}
    assert len(headers) > 25
    by_math = {header for header in headers if MATH in included(header)}
    assert 0 < len(by_math) < len(headers)
    command = compiler(name)
    assert compilation(command, tmp_path, alone(headers - by_math), *STRICT) == (0, "")
    before = compiled_before(command, tmp_path, f"#include <{MATH}>\n", *STRICT)
    assert compilation(command, tmp_path, alone(by_math), *STRICT, *before) == (0, "")


def alone(headers: set[str]) -> dict[str, str]:
    """A source that includes each header, and nothing else."""
    return {f"{header.replace('/', '.')}.cpp": f"#include <{header}>\n" for header in headers}


@pytest.mark.slow("build")
@both
def test_every_model_steps_in_a_drive_of_static_type(name: str, tmp_path: Path) -> None:
    steps = [stepped(scalar, drive) for scalar in SCALARS for drive in drives(scalar)]
    assert compilation(checker(name), tmp_path, {"static.cpp": SCALAR_HEADERS + HEADERS + "".join(steps)}) == (0, "")


@pytest.mark.whole_path("build")
@both
def test_a_kernel_compiles_without_a_warning(name: str, tmp_path: Path) -> None:
    """Users see none of its warnings."""
    source = {"kernel.cpp": kernels.source(sw.Drive(), kernels.JOBS)}
    assert compilation(checker(name), tmp_path, source, f"-I{kernel.INCLUDE_FOLDER}", "-Wno-unknown-pragmas") == (0, "")


@pytest.fixture(scope="module")
def read_before(tmp_path_factory: pytest.TempPathFactory) -> tuple[str, ...]:
    """What most sources include, read by clang once: it takes as long as the rest of a source."""
    command = tuple(word for word in checker("clang++") if word != "-fsyntax-only")
    folder = tmp_path_factory.mktemp("before")
    option, name = compiled_before(command, folder, SOURCE_HEADERS, *FOREIGN, *INSTANTIATED)
    return *INSTANTIATED, option, str(folder / name)


@pytest.mark.slow("build")
@pytest.mark.parametrize("sources", [*GROUPS, *APART], ids=lambda sources: sources[0])
def test_clang_compiles_every_source_of_the_extension(sources: list[str], read_before: tuple[str, ...], tmp_path: Path) -> None:
    """With the warnings with which g++ compiles them, from nothing, whenever the package is built for the tests."""
    including = {"source.cpp": "".join(f'#include "{ROOT / source}"\n' for source in sources)}
    assert compilation(checker("clang++"), tmp_path, including, *FOREIGN, *read_before) == (0, "")


@pytest.mark.slow("build")
def test_a_pack_steps_in_the_vector_registers_of_neon(tmp_path: Path) -> None:
    """Whose registers hold two doubles: `.2d`. It sums, multiplies, divides, compares and takes roots in them."""
    scalar = "strainwave::Pack<8>"
    source = "#include <strainwave/scalar/pack.hpp>\n" + HEADERS + stepped(scalar, drives(scalar)[0])
    options = (*STRICT, "-O1", "-ffp-contract=off", "-g0", "-S", "-Wno-unused-command-line-argument")
    command = (*zig(), "-target", "aarch64-linux-musl")
    assert compilation(command, tmp_path, {"neon.cpp": source}, *options) == (0, "")
    found = Counter(re.findall(r"^\s+(f\w+)\s+v\d+\.2d", (tmp_path / "neon.s").read_text("latin-1"), re.MULTILINE))
    assert {"fadd", "fsub", "fmul", "fdiv", "fcmgt", "fsqrt", "fabs", "fneg"} <= set(found)
    assert found["fmul"] > 100
    assert not {"fmla", "fmls"} & set(found)  # nothing contracted: the same numbers as everywhere


PAIR = """
#include "bind.hpp"
template <class S> struct Pair {{
    S first{{1.0}};
    S second{{2.0}};
    template <class Self, class Visit> static constexpr void fields(Self& m, Visit&& visit) {{
        visit(SW_FIELD(m, first, "1", "First"));
        {described}
    }}
}};
void bind(nanobind::module_& scope) {{ strainwave::host::bind<Pair<double>>(scope, "Pair", "pair"); }}
"""


@pytest.mark.slow("build")
@pytest.mark.parametrize(
    ("described", "complete"),
    [
        ('visit(SW_FIELD(m, second, "1", "Second"));', True),
        ("", False),
        ('visit(SW_FIELD(m, first, "1", "First"));', False),
    ],
    ids=["every member", "one forgotten", "one described twice in its stead"],
)
def test_a_model_compiles_just_if_every_member_is_described(described: str, complete: bool, tmp_path: Path) -> None:
    folders = (INCLUDE_FOLDER, ROOT / "src", nanobind.include_dir(), sysconfig.get_path("include"))
    options = ("-std=c++20", "-fsyntax-only", *(f"-I{folder}" for folder in folders))
    status, said = compilation(compiler("g++"), tmp_path, {"pair.cpp": PAIR.format(described=described)}, *options)
    assert (status == 0) == complete, said
    assert ("every member needs a Field" in said) != complete
