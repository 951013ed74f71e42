"""The command `strainwave export`: a gear in the form of another program, with what that form loses.

The verbs are made of the functions of `strainwave.export.FORMS`: each argument is an option, described as in the docstring.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Collection, Iterator
from inspect import Parameter, cleandoc, signature
from pathlib import Path
from types import NoneType
from typing import TYPE_CHECKING, Annotated, Any, Literal, NamedTuple, get_args, get_origin

import typer

from strainwave.commands.drive_parts import DriveParts
from strainwave.commands.help import Verbs
from strainwave.commands.options import Drive, folder, numeric, whole, with_groups

if TYPE_CHECKING:
    from strainwave.export.exported import Exported, Form


class Exports(Verbs):
    """The verbs of all exports, made at their first use: what they import takes longer than the help of others may take."""

    def list_commands(self, ctx: Any) -> list[str]:
        from strainwave.export import FORMS

        written_here = dict(self.commands)
        self.commands = {form.verb: written_here.pop(form.verb, None) or verb_of(form) for form in FORMS} | written_here
        return super().list_commands(ctx)

    def get_command(self, ctx: Any, cmd_name: str) -> Any:
        self.list_commands(ctx)
        return super().get_command(ctx, cmd_name)


export = typer.Typer(cls=Exports, help="Write a gear or drive for another program, with what it loses.")

Gear = Annotated[str, typer.Argument(help="A gear or drive: a set by name, or a file as identify writes it.")]
MODELS = {"gear": Gear, "drive": Drive}
Out = Annotated[Path, folder("Folder for the files written.")]


EXAMPLE_WORDS = {"name": "viscous-coulomb-scale"}  # of arguments without a default, in the examples of the help


class Conversion(NamedTuple):
    """An option whose value is another one than that of the argument, and the function that converts it."""

    annotation: Any
    argument: Callable[[Any], Any]


CONVERSIONS = {
    "into": Conversion(
        Annotated[Path | None, typer.Option(help="MJCF file of a robot that gets the gear.")], lambda path: path
    ),
    "platforms": Conversion(
        Annotated[
            list[str] | None,
            typer.Option(
                "--platform",
                help="Of a binary, as x86_64-windows; may be repeated. `source` makes no binary. Default: this machine.",
            ),
        ],
        lambda platforms: None if platforms is None else [each for each in platforms if each != "source"],
    ),
}


def verb_of(form: Form) -> Any:
    """Return the verb of an export, which writes the files into a folder and prints the losses."""
    from strainwave.files.gear_set import GearSet

    summary, meanings = described(form.write)
    first, *others = signature(form.write, eval_str=True).parameters.values()
    first = first.replace(name=form.model, annotation=MODELS[form.model])
    options = [option for each in others for option in option_of(each, meanings)]
    own = {each.name for each in options}
    parts = [each for each in signature(DriveParts, eval_str=True).parameters.values() if each.name not in own]
    out = Parameter("out", Parameter.KEYWORD_ONLY, default=Path("out", form.folder or form.verb), annotation=Out)

    def verb(**values: Any) -> None:
        given = {each.name: values.pop(each.name) for each in parts}
        gear, folder = DriveParts(**given).on(GearSet.read(values.pop(form.model)), form.model == "drive"), values.pop("out")
        for name in CONVERSIONS.keys() & values:
            values[name] = CONVERSIONS[name].argument(values[name])
        _write(form.write(gear, **values), folder)

    parameters = [first, *options, *(each.replace(kind=Parameter.KEYWORD_ONLY) for each in parts), out]
    verb.__signature__ = signature(verb).replace(parameters=parameters)  # type: ignore[attr-defined]
    verb.__annotations__ = {each.name: each.annotation for each in parameters}
    alone = typer.Typer(add_completion=False, rich_markup_mode=None)
    torque = " --max-torque 40" if "max_torque" in meanings else ""  # an identified gear may have no rating
    words = " ".join(["", *(EXAMPLE_WORDS[each.name] for each in options if each.default is Parameter.empty)])
    examples = [f"    strainwave export {form.verb} {model}{words}" for model in ("robot-joint", f"gear.toml{torque}")]
    alone.command(form.verb, help="\n".join([summary, "\nExamples:", *examples]))(verb)
    return typer.main.get_command(alone)


def option_of(parameter: Parameter, meanings: dict[str, str]) -> Iterator[Parameter]:
    """Yield the option of an argument; none if its value is none that a command line can have."""
    kinds = _kinds(parameter.annotation)
    if parameter.name in CONVERSIONS:
        yield parameter.replace(annotation=CONVERSIONS[parameter.name].annotation)
    elif scalars := kinds & {str, float, int, bool}:
        option = _option(parameter, scalars, meanings[parameter.name])
        (scalar,) = scalars if len(scalars) == 1 else (parameter.annotation,)
        typed = scalar | None if NoneType in kinds else scalar
        yield parameter.replace(annotation=Annotated[typed, option], kind=Parameter.KEYWORD_ONLY)


def _kinds(annotation: Any) -> set[Any]:
    """Return the types that an annotation allows; words that it lists are texts."""
    if get_origin(annotation) is Literal:
        return {str}
    return {kind for each in get_args(annotation) for kind in _kinds(each)} or {annotation}


def _option(parameter: Parameter, kinds: set[Any], meaning: str) -> Any:
    if parameter.default is Parameter.empty:
        return typer.Argument(help=meaning)
    if parameter.default is False:
        return typer.Option(f"--{parameter.name.replace('_', '-')}", help=meaning)  # without --no-…
    if float in kinds:
        return numeric(meaning)
    return whole(meaning) if int in kinds else typer.Option(help=meaning)


def described(function: Callable[..., Any]) -> tuple[str, dict[str, str]]:
    """Return what a function returns, by the first line of its docstring, and the meaning of each argument, as sentences."""
    text = cleandoc(function.__doc__ or "")
    summary, _, rest = text.partition("\n\n")
    (arguments,) = re.findall(r"^Args:\n((?: .*\n)+)", rest, re.MULTILINE)
    entries = re.findall(r"^    (\w+): (.*(?:\n {8}.*)*)", arguments, re.MULTILINE)
    return _sentence(summary.removeprefix("Return ").rstrip(".")), {name: _sentence(meaning) for name, meaning in entries}


def _sentence(words: str) -> str:
    text = " ".join(words.split())
    return f"{text[0].upper()}{text[1:]}."


@export.command("firmware")
@with_groups
def firmware(
    drive: Annotated[str, typer.Argument(help="A drive, by name or as a file; for a law of the gear, a gear alone will do.")],
    parts: DriveParts,
    part: Annotated[
        str,
        typer.Option(help="control, drive, or a law of the gear, as gear.friction_input."),
    ] = "control",
    scalar: Annotated[str, typer.Option(help="Type of all numbers: float or double.")] = "float",
    period: Annotated[float | None, numeric("Time between steps of a drive or a friction in s; 0.2 ms or shorter.")] = None,
    report: Annotated[
        bool, typer.Option("--report", help="Print size and instructions of a step on a Cortex-M4F, by GCC and QEMU.")
    ] = False,
    name: Annotated[
        str | None, typer.Option(help="Of the files, and prefix of all names in C; else the end of the part.")
    ] = None,
    out: Out = Path("out/firmware"),
) -> None:
    """A part of a drive for a microcontroller: a header of C++20 without includes, with an interface in C.

    Examples:
        strainwave export firmware robot-joint
        strainwave export firmware hfuc-20-80 --part gear.friction_input
    """
    from strainwave.export.exported import valid_ranges
    from strainwave.export.firmware import firmware as exported
    from strainwave.files.gear_set import GearSet

    found = parts.on(GearSet.read(drive), not part.startswith("gear."))
    written = exported(found, out, part=part, name=name, scalar=scalar, period=period)  # type: ignore[arg-type] # checked there
    for kind in ("inputs", "outputs"):
        print(f"{kind}: {', '.join(getattr(written, kind))}")
    print(f"size of the state: {len(written.state)}")
    print("".join(f"{each}\n" for each in valid_ranges(found)), end="")
    every = f", to be called every {written.period:g} s" if written.period else ""
    files = (written.header, written.declarations, written.source, written.example)
    if report:
        from strainwave.export.firmware.microcontroller import report as lines

        print(*lines(found, part, written.scalar, period), sep="\n")
    print(f"wrote {', '.join(each.name for each in files)} to {out}{every}")


@export.command("from-bam")
def from_bam(
    file: Annotated[Path, typer.Argument(help="Parameter file of BAM.")],
    ratio: Annotated[float, numeric("Ratio of the gear, which BAM does not state.")],
    out: Annotated[Path, typer.Option(help="Gear file to write.")] = Path("out/gear.toml"),
) -> None:
    """A gear file from parameters of BAM.

    Examples:
        strainwave export from-bam out/bam/bam.json --ratio 80
        strainwave export from-bam out/bam/bam.json --ratio 80 --out joint.toml
    """
    from strainwave.export.bam_parameters import read_bam

    found = read_bam(file, ratio)
    out.parent.mkdir(parents=True, exist_ok=True)
    found.save(out)
    print(f"{found.name}: {found.note}\nwrote {out}")


def _listing(files: Collection[str]) -> str:
    """Return names of files in one line; of those in a folder of sources their number."""
    names = [each for each in files if "/Source/" not in each]
    sources = len(files) - len(names)
    return ", ".join(names) + (f" and {sources} sources" if sources else "")


def _write(found: Exported, out: Path) -> None:
    """Write the files of an export, and print its summary."""
    from strainwave.files.writing import write_folder
    from strainwave.report.exported import export_files, export_summary

    files = export_files(found)
    write_folder(out, files)
    print(export_summary(found))
    print(f"\nwrote {_listing(files)} to {out}")
