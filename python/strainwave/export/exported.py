"""Result of an export: files, the numbers in them, and what they lose against the gear; and how an export is listed."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import wraps
from inspect import signature
from pathlib import Path
from typing import Any, NamedTuple, ParamSpec, get_args

from strainwave.files.entries import OPPOSITE_SENSE
from strainwave.files.gear_file import ACCEPTED
from strainwave.files.gear_set import GearSet
from strainwave.files.recording import Recording
from strainwave.messages import listed
from strainwave.presentation import Presented
from strainwave.tuning.loss import ExportLoss

Args = ParamSpec("Args")
ORIGINS_FILE = "origins.txt"  # where no file of an export has comments
XML = "<!-- "
COMMENTS = {
    ".xml": XML,
    ".urdf": XML,
    ".xacro": XML,
    ".md": XML,
    ".yaml": "# ",
    ".py": "# ",
    ".mo": "// ",
    ".h": "// ",
    ".hpp": "// ",
}  # beginning of a comment by ending of the name
NOT_BY_ITSELF = ("fitted but not identified", "identified in combination")  # beginnings of sources of such numbers


@dataclass(frozen=True)
class Exported(Presented):
    """A gear in the form of another program.

    Attributes:
        kind: of the export, as the command names it
        gear: name of the gear
        files: their texts or bytes, by the path in the folder
        numbers: that were written, with their units
        losses: against the gear, computed
        left_out: laws of the gear that the form has no place for, in words
        remarks: what to do with the files and numbers, and what was assumed
        table: columns of numbers, written as <kind>.csv

    >>> import strainwave as sw
    >>> found = sw.export.joint(sw.GearSet.read("csg-20-100"))
    >>> value, unit = found.numbers["frictionloss"]
    >>> sorted(found.files), round(value, 2), unit
    (['joint.py', 'joint.urdf', 'joint.xml'], 4.61, 'N.m')
    >>> found.left_out[1]
    'torsion: 3.99 mrad at 107 N.m'
    """

    kind: str
    gear: str
    files: Mapping[str, str | bytes]
    numbers: Mapping[str, tuple[float, str]] = field(default_factory=dict)
    losses: tuple[ExportLoss, ...] = ()
    left_out: tuple[str, ...] = ()
    remarks: tuple[str, ...] = ()
    table: Recording | None = None


def stating_origins(write: Callable[Args, Exported]) -> Callable[Args, Exported]:
    """Return an export that states which numbers of a set were identified: in comments of its files, and in remarks."""

    @wraps(write)
    def exported(*args: Args.args, **kwargs: Args.kwargs) -> Exported:
        found, model = write(*args, **kwargs), (*args, *kwargs.values())[0]
        if isinstance(model, str | Path) and Path(model).suffix == ".toml":  # nothing of a catalogue was identified
            model = GearSet.read(model)
        return _with_origins(found, model) if isinstance(model, GearSet) else found

    return exported


def _with_origins(found: Exported, gear_set: GearSet) -> Exported:
    """Return an export with the origin of the numbers of its gear set, if one was identified.

    >>> import strainwave as sw
    >>> gear = sw.GearSet.read("csg-20-100")
    >>> why = sw.files.Entry("identified in combination: a.csv determines coulomb + 10 viscous = 0.064 ± 0.0001 N.m")
    >>> found = sw.export.joint(gear.replace(sources={**gear.sources, "gear.friction_input.viscous": why}))
    >>> found.remarks[-1]
    'gear.friction_input.viscous: identified in combination: a.csv determines coulomb + 10 viscous = 0.064 ± 0.0001 N.m'
    >>> print(found.files["joint.xml"][:67])
    <!-- numbers of CSG-20-100
    identified, with one standard deviation:
    """
    paths = dict[str, list[str]]()
    for path, entry in gear_set.sources.items():
        if entry.source.startswith(NOT_BY_ITSELF) or OPPOSITE_SENSE in entry.source:
            paths.setdefault(entry.source, []).append(path)
    remarks = (f"{listed(names)}: {source}" for source, names in paths.items())
    lines = [f"numbers of {gear_set.name}", *origins] if (origins := gear_set.origins) else []
    files = {path: _commented(path, content, lines) for path, content in found.files.items()}
    if lines and files == found.files:
        files[ORIGINS_FILE] = "\n".join(lines) + "\n"
    return replace(found, files=files, remarks=(*found.remarks, *remarks, *valid_ranges(gear_set)))


def valid_ranges(gear_set: GearSet) -> list[str]:
    """Return sentences about the ranges in which a gear was measured; none if nothing states where it was."""
    accepted = "; a check failed, as the note of the gear states" if ACCEPTED in gear_set.note else ""
    return [
        f"its identified numbers were measured by {measured_range}; nothing checks them beyond{accepted}"
        for measured_range in gear_set.measured_ranges
    ]


def _commented(path: str, content: str | bytes, lines: Sequence[str]) -> str | bytes:
    """Return a file with lines as a comment at its beginning; unchanged if its language has none."""
    ending = Path(path).suffix
    if isinstance(content, bytes) or not lines or ending not in COMMENTS:
        return content
    comment = comment_of(lines, COMMENTS[ending])
    declaration = re.match(r"<\?xml[^>]*\?>\n", content)
    first = "" if declaration is None else declaration.group()
    return f"{first}{comment}{content.removeprefix(first)}"


def comment_of(lines: Sequence[str], begin: str) -> str:
    """Return lines as a comment that begins with `begin`; empty for none.

    >>> print(comment_of(["a", "b"], "// "), end="")
    // a
    // b
    """
    if lines and begin == XML:
        return XML + "\n".join(lines).replace("--", "- -") + " -->\n"
    return "".join(f"{begin}{line}\n" for line in lines)


class Form(NamedTuple):
    """An export as the command and the documentation list it.

    Attributes:
        write: function that exports; its docstring describes the verb and its options, its name is that of the verb
        program: that takes the files, and for what, in Markdown
        files: what is written, in Markdown
        page: of the how-to guides, with its anchor if it describes several exports
        folder: for the files, unless another one is given; by default that of the verb's name
    """

    write: Callable[..., Any]
    program: str
    files: str
    page: str
    folder: str = ""

    @property
    def verb(self) -> str:
        """Word of the command."""
        return self.write.__name__.replace("_", "-")

    @property
    def model(self) -> str:
        """Return "gear" for a function that takes the name or path of a gear, too; else "drive"."""
        model, *_ = signature(self.write, eval_str=True).parameters.values()
        return "gear" if str in get_args(model.annotation) else "drive"
