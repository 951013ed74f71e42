"""Origin of the numbers of a gear set in words: what was identified, with its standard deviation, and what was not.

Gear files and exports have these lines as comments.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from strainwave.files.described import parameters, parts
from strainwave.files.entries import NOT_GIVEN, OPPOSITE, Entry

IDENTIFIED = "identified"  # begins the source of a number that a measurement determines, alone or in combination
HEADINGS = {
    True: "identified, with one standard deviation:",
    False: "not identified, of the set before or assumed, with the spread or standard deviation that its source states:",
}


def origin_lines(models: Mapping[str, Any], sources: Mapping[str, Entry]) -> list[str]:
    """Return a line for each number of models by their names, those that were identified first; empty if none was.

    >>> import strainwave as sw
    >>> law = sw.friction.Coulomb(coulomb=0.05, breakaway=0.05)
    >>> sources = {"law.coulomb": Entry("identified from a.csv", uncertainty=3e-4), "law.breakaway": Entry("maker", spread=0.3)}
    >>> print("\\n".join(origin_lines({"law": law}, sources)))
    identified, with one standard deviation:
      law.coulomb = 0.05 ± 0.0003 N.m, identified from a.csv
    not identified, of the set before or assumed, with the spread or standard deviation that its source states:
      law.breakaway = 0.05 ± 0.015 N.m
    """
    groups: dict[bool, list[str]] = {True: [], False: []}
    for path, value, unit in (number for name, model in models.items() for number in _numbers(name, model)):
        entry = sources.get(path, Entry(NOT_GIVEN))
        if entry.source != NOT_GIVEN:
            identified, sigma = entry.source.startswith(IDENTIFIED), entry.sigma(value)
            within = "" if sigma is None else f" ± {sigma:.2g}"
            line = f"  {path} = {value:.6g}{within} {unit.removesuffix('1')}".rstrip()
            is_said = identified or OPPOSITE in entry.source
            groups[identified].append(f"{line}, {entry.source}" if is_said else line)
    return [line for each, lines in groups.items() for line in (HEADINGS[each], *lines) if lines] if groups[True] else []


def _numbers(path: str, model: Any) -> Iterator[tuple[str, float, str]]:
    """Yield path, value and unit of every number of a model and its parts."""
    for name, kind, unit in parameters(model):
        if kind == "sequence":
            yield from ((f"{path}.{name}[{i}]", value, unit) for i, value in enumerate(getattr(model, name)))
        elif kind != "choice":
            yield f"{path}.{name}", getattr(model, name), unit
    for part in parts(model):
        yield from _numbers(f"{path}.{part.name}", getattr(model, part.name))
