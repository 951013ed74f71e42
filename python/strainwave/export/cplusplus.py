"""Parts of a drive as C++: their headers, and their numbers as literals."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping
from functools import cache
from importlib import resources
from typing import Any

from strainwave.native.kernel import INCLUDE_FOLDER
from strainwave.native.static_type import NAMESPACES, parameters

INCLUDING = re.compile(r'^#include (?:<(?P<found>[^>]+)>|"(?P<local>[^"]+)").*\n', re.MULTILINE)
SHARED = "contradictions.hpp", "mathematics.hpp", "stretches.hpp"  # texts of exports


def numbers(part: Any, path: str = "") -> Iterator[tuple[str, float]]:
    """Yield each number of a part with its path.

    >>> import strainwave as sw
    >>> list(numbers(sw.friction.Coulomb(coulomb=0.05), "friction"))
    [('friction.coulomb', 0.05), ('friction.breakaway', 0.05), ('friction.viscous', 0.0)]
    """
    for field in type(part).fields:
        value, own = getattr(part, field["name"]), f"{path}.{field['name']}".removeprefix(".")
        if field["kind"] == "part":
            yield from numbers(value, own)
        elif field["kind"] == "sequence":
            yield from ((f"{own}[{i}]", each) for i, each in enumerate(value))
        elif field["kind"] == "number":
            yield own, value


def assignments(part: Any, variable: str) -> Iterator[str]:
    """Yield statements of C++ that give a variable the numbers of a part, in scalars S; the double is written exactly.

    >>> import strainwave as sw
    >>> print(*assignments(sw.kinematic_error.Fourier(order=[2], amplitude=[1e-4], phase=[0.5]), "error"), sep="\\n")
    error.order = {{S(2.0)}, 1};  // 1
    error.amplitude = {{S(0.0001)}, 1};  // rad
    error.phase = {{S(0.5)}, 1};  // rad
    """
    for field in type(part).fields:
        value, member = getattr(part, field["name"]), f"{variable}.{field['name']}"
        match field["kind"]:
            case "part":
                yield from assignments(value, member)
            case "sequence":
                elements = ", ".join(f"S({each!r})" for each in value)
                yield f"{member} = {{{{{elements}}}, {len(value)}}};  // {field['unit']}"
            case "choice":
                yield f"{member} = decltype({member})({field['options'].index(value)});  // {value}"
            case "count":
                yield f"{member} = decltype({member})({value!r});"
            case _:
                yield f"{member} = S({value!r});  // {field['unit']}"


def headers_of(part: Any) -> list[str]:
    """Return the headers that define the models of a part, as they are included.

    >>> import strainwave as sw
    >>> headers_of(sw.friction.Thermal(law=sw.friction.Viscous(viscous=0.1)))
    ['strainwave/friction/thermal.hpp', 'strainwave/friction/viscous.hpp']
    """
    return sorted(set(_headers_of(part)))


def _headers_of(part: Any) -> Iterator[str]:
    yield _header_of(type(part))  # type: ignore[arg-type] # a type is hashable
    for name in parameters(type(part)):
        yield from _headers_of(getattr(part, name))


@cache
def _header_of(kind: type[Any]) -> str:
    """Return the header that defines a model, which lies in the folder of its family if it has one."""
    family = kind.__module__.rpartition(".")[2]
    folders = NAMESPACES.get(family, family), ".", "*"
    for path in (path for folder in folders for path in sorted(INCLUDE_FOLDER.glob(f"strainwave/{folder}/*.hpp"))):
        if re.search(rf"^struct {kind.__name__} ", path.read_text("utf-8"), re.MULTILINE):
            return path.relative_to(INCLUDE_FOLDER).as_posix()
    raise LookupError(f"no header in {INCLUDE_FOLDER} defines {kind.__name__}")


def headers(source: str) -> list[str]:
    """Return the headers of the package that a source includes."""
    return re.findall(r"^#include <(strainwave/[^>]+)>", source, re.MULTILINE)


def _headers_beside(name: str, source: str) -> list[str]:
    """Return the headers of its own folder that a header of this name includes."""
    folder = name.rpartition("/")[0]
    return [f"{folder}/{each}" for each in re.findall(r'^#include "([^"]+)"', source, re.MULTILINE)]


def closure(names: Iterable[str]) -> dict[str, str]:
    """Return the texts of headers by name, with those that they include."""
    texts: dict[str, str] = {}
    waiting = list(names)
    while waiting:
        if (name := waiting.pop()) not in texts:
            texts[name] = (INCLUDE_FOLDER / name).read_text("utf-8")
            waiting += headers(texts[name]) + _headers_beside(name, texts[name])
    return texts


def amalgamated(names: Iterable[str], own: Mapping[str, str] | None = None) -> str:
    """Return the texts of headers as one, with those that they include, each once and in the order of inclusion.

    Headers of the C++ standard library are left out: whoever includes the text gives what it uses of them.

    Args:
        names: of the headers, as they are included
        own: texts by name that are no headers of the package
    """
    done: set[str] = set()
    texts = {name: own_text(name) for name in SHARED} | dict(own or {})
    return "".join(_inlined(name, texts, done) for name in names)


def _inlined(name: str, own: Mapping[str, str], done: set[str]) -> str:
    """Return the text of a header with those that it includes and that are not done yet in the places of their includes."""
    is_of_package = name.startswith("strainwave/")
    if name in done or not (is_of_package or name in own):
        return ""
    done.add(name)
    text = (INCLUDE_FOLDER / name).read_text("utf-8") if is_of_package else own[name]
    folder = name.rpartition("/")[0]

    def included(match: re.Match[str]) -> str:
        local = match["local"]
        return _inlined(match["found"] or (f"{folder}/{local}" if folder else local), own, done)

    return INCLUDING.sub(included, text.replace("#pragma once\n", "", 1))


def own_text(name: str) -> str:
    """Return a C++ text that several exports share."""
    return resources.files("strainwave.export").joinpath(name).read_text("utf-8")


def macros(source: str) -> list[str]:
    """Return the names of the macros that a source defines."""
    return sorted(set(re.findall(r"^#define (\w+)", source, re.MULTILINE)))
