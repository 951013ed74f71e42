"""Options for parts of a drive that a gear set lacks: motor, load and control, by name or from a file."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated, Any

import typer

from strainwave.commands.options import changed_number
from strainwave.messages import listed

if TYPE_CHECKING:
    from strainwave.files.gear_set import GearSet


@dataclass(frozen=True)
class DriveParts:
    """Parts that take the place of those of a gear set; None keeps its own."""

    motor: Annotated[
        str | None, typer.Option(help="Motor: that of a drive, as robot-joint or mine.toml, or a model, as DC,resistance=0.5.")
    ] = None
    load: Annotated[str | None, typer.Option(help="Load, likewise: robot-joint, mine.toml or Inertia,inertia=0.2.")] = None
    control: Annotated[str | None, typer.Option(help="Controller, likewise: robot-joint, mine.toml or PID,proportional=9.")] = (
        None
    )

    def on(self, gear_set: GearSet, whole: bool = False) -> GearSet:
        """Return a gear set with these parts.

        Args:
            gear_set: that gets them
            whole: it must be a drive then, with motor and load

        Raises:
            TypeError, ValueError: a text names no part, a number is none of its numbers, or a part is missing

        >>> import strainwave as sw
        >>> whole = DriveParts(motor="DC,resistance=0.5", load="robot-joint").on(sw.GearSet.read("csg-20-100"))
        >>> whole.drive.motor.resistance, whole.drive.load.name, whole.sources["load.inertia"].source
        (0.5, 'pendulum', 'load of robot-joint')
        """
        for family, text in vars(self).items():
            if text is not None:
                part, source = _part(family, text)
                gear_set = gear_set.with_parts(source=source, **{family: part})
        if whole:
            try:
                _ = gear_set.drive
            except ValueError as error:
                raise ValueError(f"{error}; or give --motor and --load, as --motor robot-joint --load Inertia") from None
        return gear_set


def _part(family: str, text: str) -> tuple[Any, str]:
    """Return a part of a drive, and where its numbers come from."""
    import strainwave as sw
    from strainwave.files.gear_set import GearSet

    name, *pairs = text.split(",")
    models = vars({"motor": sw.motor, "load": sw.loads, "control": sw.control}[family])
    if name in models and name[:1].isupper():
        part, source = models[name](), f"given as --{family} {text}"
    else:
        try:
            part, source = getattr(GearSet.read(name), family), f"{family} of {name}"
        except ValueError as error:
            known = listed(sorted(each for each in models if each[:1].isupper()))
            raise ValueError(f"--{family} {text} is no model ({known}), and no drive: {error}") from None
        if part is None:
            raise ValueError(f"--{family} {name}: that set has no [{family}]")
    number = next((field["name"] for field in part.fields if field["kind"] == "number"), "NUMBER")
    changes = [changed_number(f"--{family}", each, f"{name},{number}=1") for each in pairs]
    return part.replace(dict(changes)), source
