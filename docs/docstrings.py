"""Docstrings of the package in reStructuredText, and the signatures of compiled models, which Python does not know."""

from __future__ import annotations

import inspect
import re
from typing import Any

import prose
import strainwave as sw

UP = "../.."  # from a page of the API reference to the root of the pages
COMPILED_SECTION = r"^(Parameters|Raises|Source)\n-+\n((?:.+\n?)*)"
# What stands in a signature, and what a reader needs of it; the models of one module are its name.
SHORTER = {
    r"^\(self(?:, )?": "(",
    r"collections\.abc\.Sequence\[float\] \| numpy\.typing\.NDArray\[numpy\.float64\]": "ArrayLike",
    r"strainwave\.(\w+)\.\w+(?: \| strainwave\.\1\.\w+){4,}": r"sw.\1",
    r"numpy\.typing\.NDArray\[numpy\.(\w+)\]": r"NDArray[\1]",
    r"~?(?:numpy\.)?ndarray\[tuple\[~?(?:typing\.)?Any, \.\.\.\], ~?(?:numpy\.)?dtype\[~?(?:numpy\.)?(\w+)\]\]": r"NDArray[\1]",
    r"\b(?:collections\.abc|typing)\.": "",
    r"<function (?:<\w+>|[^<>])*>|<factory>": "...",
    r"/, \*, .*\)": "/, **parameters)",
}
SYMBOL = rf"(?<!\n    )(?P<symbol>{prose.SYMBOL})|"  # not the name of a parameter
MARKED = (
    r"(?P<code>``.*?``|`[^`]+`)"
    rf"|(?P<target>{prose.CITED})|(?P<mark>[|*\\]|(?<=\w)_(?!\w))"
)


# ---- Text ------------------------------------------------------------------------------------------------------------


def restructured(text: str, symbols: str = "") -> str:
    """Return a docstring in reStructuredText, with its sections in the style of Google."""
    text = re.sub(r"^Source:\n +((?:.+\n?)*)", lambda found: source(found[1]), inspect.cleandoc(text), flags=re.MULTILINE)
    return "\n\n".join(block(each, symbols) for each in re.split(r"\n\n+", text))


def source(lines: str) -> str:
    return f":Source: {' '.join(lines.split())}\n"


def block(text: str, symbols: str = "") -> str:
    """Return a paragraph, a table, an example or a formula in reStructuredText."""
    if text.startswith(".. math::"):
        formulas = prose.lines(" ".join(text.removeprefix(".. math::").split()))
        return "\n\n".join(f".. math:: {formula}" for formula in formulas)
    if text.startswith("| "):
        rows = [row.strip("| ").split(" | ") for row in text.splitlines() if not row.startswith("|--")]
        lines = [f"   {'  ' if column else '* '}- {block(cell)}" for row in rows for column, cell in enumerate(row)]
        return "\n".join([".. list-table::", "   :header-rows: 1", "", *lines])
    return text if text.startswith(">>>") else re.sub(symbols + MARKED, markup, text)


def markup(found: re.Match[str]) -> str:
    """Return code as it is, a symbol as a formula, a work as a link, another character escaped."""
    if symbol := found.groupdict().get("symbol"):
        return rf"\ :math:`{prose.symbol(symbol)}`\ "
    if (target := found["target"]) in prose.TARGETS:
        page, _, anchor = prose.TARGETS[target].partition(".md")
        return f"`{target} <{UP}/{page}.html{anchor}>`__"
    if code := found["code"]:
        return code if code.startswith("``") or is_linked(code.strip("`")) else f"`{code}`"
    return target or f"\\{found['mark']}"


def is_linked(name: str) -> bool:
    """True for the name of a class, of a member, or of a public function; False for that of an argument."""
    return re.fullmatch(r"[A-Z]\w+|\w+(?:\.\w+)+", name) is not None or (name in sw.__all__ and name != "load")


def summary(documented: Any) -> str:
    """Return the first sentence of a docstring."""
    first = re.split(r"\n\n|(?<=[^.]\.)\s", inspect.cleandoc(documented.__doc__ or ""))[0]
    return block(" ".join(first.split()))


# ---- Compiled models -------------------------------------------------------------------------------------------------


def is_model(documented: Any) -> bool:
    return (
        isinstance(documented, type)
        and hasattr(documented, "fields")
        and overload(vars(documented).get("__init__")) is not None
    )


def overload(documented: Any) -> tuple[str, str] | None:
    """Return signature and docstring of a compiled function, method or property: of its overloads the one for arrays."""
    signatures = getattr(getattr(documented, "fget", documented), "__nb_signature__", None)
    return signatures[-1][:2] if signatures else None


def shorter(signature: str) -> str:
    for pattern, short in SHORTER.items():
        signature = re.sub(pattern, short, signature)
    return signature


def returned(signature: str) -> str:
    return shorter(signature.rpartition(" -> ")[2])


def arguments(signature: str) -> str:
    """Return what follows the name in a signature."""
    return shorter(signature[signature.index("(") :])


def member_arguments(model: type[Any], signature: str) -> str:
    """Return the arguments of a method, with the state of its model by its full name."""
    state = getattr(model, "State", None)
    return re.sub(r": State\b", f": {state.__module__}.{state.__qualname__}" if state else "", arguments(signature))


def model_text(model: type[Any]) -> str:
    """Return the docstring of a compiled model with its parameters, limits and defaults as attributes with types."""

    def section(found: re.Match[str]) -> str:
        head, lines = found.groups()
        if head == "Source":
            return source(lines)
        if not lines.strip():
            return ""
        if head == "Parameters":
            return "\n".join(["Attributes:", *(f"    {attribute(model, line)}" for line in lines.splitlines())]) + "\n"
        return "\n".join([f"{head}:", *(f"    {line}" for line in lines.splitlines())]) + "\n"

    return re.sub(COMPILED_SECTION, section, model.__doc__ or "", flags=re.MULTILINE)


def attribute(model: type[Any], line: str) -> str:
    name, _, meaning = line.partition(": ")
    declared, _ = overload(inspect.getattr_static(model, name)) or ("", "")
    meaning = meaning.replace("default ()", "default empty")
    meaning = re.sub(r"default ([A-Z]\w+)[(].*", r"default ``\1``", meaning)  # a part without its numbers
    return f"{name} ({returned(declared)}): {meaning}"


def model_signature(model: type[Any]) -> str:
    """Return the arguments of a compiled model, with defaults that are numbers or words."""
    declared, _ = overload(model.__init__) or ("()", "")
    defaults = {field["name"]: field["default"] for field in model.fields if not field["follows"]}

    def default(found: re.Match[str]) -> str:
        value = defaults.get(found[1])
        return f"{found[1]}: {found[2]} = {value!r}" if isinstance(value, float | int | str) else found[0]

    return re.sub(r"(\w+): ([^=,]+) = \.\.\.", default, arguments(declared.removesuffix(" -> None")))
