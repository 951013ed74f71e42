"""Result of an export: files, the numbers in them, and what they lose against the gear; and how an export is listed."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from inspect import signature
from typing import Any, NamedTuple, get_args

from strainwave.files.gear_set import GearSet
from strainwave.files.recording import Recording
from strainwave.messages import listed
from strainwave.tuning.loss import ExportLoss

NOT_BY_ITSELF = ("fitted but not identified", "identified in combination")  # beginnings of sources of such numbers


@dataclass(frozen=True)
class Exported:
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
    (['joint.urdf', 'joint.xml'], 4.61, 'N.m')
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


def with_sources(found: Exported, gear_set: GearSet) -> Exported:
    """Return an export with a remark on each number of its gear that measurements do not determine by itself, and why.

    >>> import strainwave as sw
    >>> gear = sw.GearSet.read("csg-20-100")
    >>> why = sw.Entry("identified in combination: a.csv determines 0.064 N.m at 10 rad/s of the input")
    >>> gear = gear.replace(sources={**gear.sources, "gear.friction_input.viscous": why})
    >>> with_sources(sw.export.joint(gear), gear).remarks[-1]
    'gear.friction_input.viscous: identified in combination: a.csv determines 0.064 N.m at 10 rad/s of the input'
    """
    paths = dict[str, list[str]]()
    for path, entry in gear_set.sources.items():
        if entry.source.startswith(NOT_BY_ITSELF):
            paths.setdefault(entry.source, []).append(path)
    remarks = (f"{listed(names)}: {source}" for source, names in paths.items())
    return replace(found, remarks=(*found.remarks, *remarks))


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
