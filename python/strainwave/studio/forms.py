"""Forms of the verbs of the command: fields from the signatures of the verbs, and command lines from what a page fills in.

A page names files by their names in the workspace, and never by paths. `words_of` turns these names into paths.
"""

from __future__ import annotations

import unicodedata
from collections.abc import Callable, Iterable, Mapping
from dataclasses import asdict, dataclass
from inspect import Parameter, signature
from pathlib import Path
from typing import Any, get_args

import typer

from strainwave.messages import listed, quoted

PAGES = {  # of the studio, besides those of the workbench, with their verbs
    "Identify": ("identify", "predict", "orders", "plan"),
    "Compensate": ("compensate",),
    "Faults": ("diagnose joint", "diagnose limit", "diagnose wear", "diagnose misalignment"),
    "Compare": ("compare",),
}
SETS = ("gear", "drive", "start", "first", "second")  # parameters that take a set by name, or a file
MAX_VALUES = 200  # of a field that takes several
MAX_CHARACTERS = 1000  # of a value
OUT = "out"


@dataclass(frozen=True)
class Field:
    """A field of a form.

    Attributes:
        name: of the parameter
        kind: files or file, by their names in the workspace; set, by its name or that of a file; flag, number, whole, text
        several: True if it takes several values
        required: True if it must be filled in
        is_option: True if its name is written on the command line
        help: what it means
        default: text of the value that is taken if it is not filled in
    """

    name: str
    kind: str
    several: bool
    required: bool
    is_option: bool
    help: str
    default: str


@dataclass(frozen=True)
class Form:
    """A verb of the command as a form.

    Attributes:
        verb: as the command line has it
        summary: what it does
        fields: in the order of the command line
        has_folder: True if it writes its results into a folder
    """

    verb: str
    summary: str
    fields: tuple[Field, ...]
    has_folder: bool

    def words_of(self, values: Mapping[str, Any], path_of: Callable[[str], Path], out: Path) -> list[str]:
        """Return the command line of a form that was filled in.

        Args:
            values: texts, lists of texts or flags by the names of fields, from a stranger
            path_of: returns the path of a file by its name in the workspace; raises ValueError for any other name
            out: folder for the results

        Raises:
            ValueError: a field is not known, is missing, or has a value that it does not take
        """
        known = {field.name: field for field in self.fields}
        if unknown := [name for name in values if name not in known]:
            raise ValueError(f"{quoted(unknown[0])} is no field of {self.verb}; there are {listed(known)}")
        options, arguments = list[str](), list[str]()
        for field in self.fields:
            given = _texts(field, values.get(field.name))
            if field.required and not given:
                raise ValueError(f"{field.name.replace('_', ' ')} is missing: {field.help}")
            if field.kind in ("files", "file"):
                given = [str(path_of(text)) for text in given]
            elif field.kind == "set":
                given = [text if is_in_catalogue(text) else str(path_of(text)) for text in given]
            option = f"--{field.name.replace('_', '-')}"
            if field.kind == "flag":
                options += [option] if given else []
            elif field.is_option:
                options += [f"{option}={text}" for text in given]
            else:
                arguments += given
        folder = [f"--{OUT}={out}"] if self.has_folder else []
        return [*self.verb.split(), *options, *folder, "--", *arguments]


def forms(verbs: Iterable[tuple[str, Callable[..., None]]]) -> dict[str, Form]:
    """Return the forms of all pages, by verb, of the verbs of the command with their functions."""
    wanted = {verb for page in PAGES.values() for verb in page}
    return {verb: _form(verb, function) for verb, function in verbs if verb in wanted}


def described(made: Mapping[str, Form]) -> dict[str, Any]:
    """Return the forms of each page as data of the page."""
    return {page: [asdict(made[verb]) for verb in verbs] for page, verbs in PAGES.items()}


def _form(verb: str, function: Callable[..., None]) -> Form:
    parameters = signature(function, eval_str=True).parameters
    summary = (function.__doc__ or "").strip().partition("\n")[0]
    fields = tuple(_field(each) for name, each in parameters.items() if name != OUT)
    return Form(verb, summary, fields, OUT in parameters)


def _field(parameter: Parameter) -> Field:
    annotation, declared, *_ = get_args(parameter.annotation)
    kinds = {annotation, *get_args(annotation)} | {inner for each in get_args(annotation) for inner in get_args(each)}
    several = any(getattr(each, "__origin__", None) is list for each in kinds)
    is_required = parameter.default is Parameter.empty
    default = "" if is_required or parameter.default in (None, False) else str(parameter.default)
    return Field(
        parameter.name,
        _kind(parameter.name, kinds, several=several),
        several,
        is_required,
        isinstance(declared, type(typer.Option())),
        declared.help or "",
        default,
    )


def _kind(name: str, kinds: set[Any], *, several: bool) -> str:
    if Path in kinds:
        return "files" if several else "file"
    if name in SETS:
        return "set"
    of_types = {bool: "flag", float: "number", int: "whole", str: "text"}
    return next(kind for of, kind in of_types.items() if of in kinds)


def _texts(field: Field, value: Any) -> list[str]:
    """Return the values of a field; none if it is not filled in."""
    if value in (None, "", False, []):
        return []
    if field.kind == "flag":
        if value is not True:
            raise ValueError(f"{field.name} is true or false")
        return ["true"]
    texts = value if isinstance(value, list) else [value]
    if len(texts) > (MAX_VALUES if field.several else 1):
        raise ValueError(f"{field.name} has {len(texts)} values; it takes {MAX_VALUES if field.several else 1}")
    for text in texts:
        if (
            not isinstance(text, str)
            or len(text) > MAX_CHARACTERS
            or any(unicodedata.category(each) in ("Cc", "Cs") for each in text)
        ):
            raise ValueError(f"{field.name}: a line of at most {MAX_CHARACTERS} characters is expected")
    return texts


def is_in_catalogue(name: str) -> bool:
    """True if a set of the catalogue has this name."""
    from strainwave.files.gear_set import catalogue

    return name in catalogue() or name in catalogue("drives")
